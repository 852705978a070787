"""The page docs/probe.md: what to do, and what every reading means. Its numbers are simulated."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.machines import Axes
from wedmcam.probe.answers import MEANS, axes_of
from wedmcam.probe.behaviour import Behaviour, stops
from wedmcam.probe.records import PARTS, Section, blocks, extents

HOW = """# What controller is this?

Written by `make docs`; do not edit. The numbers come from simulated controllers: step loops with
both line tables, and one that recomputes the ends of arcs.

Old controllers differ in what no program states: by which table they step a line, whether an arc
stops after J steps or where J and G say, what they make of blank fields, of records with X = Y = 0,
of D, DD and E. `wedmcam profile probe -o probe.3b` writes four small programs in 3B that ask, and a
sheet `probe.txt` to fill in. ISO and the ZD-065 need no probe: an ISO block states its end, and the
table and the counting of the ZD-065 are published.

1. Take the wire off and leave the generator off. The table must be free to move as told below; a
   pen or a dial indicator on the part side shows how far it goes.
2. Load `probe.3b`, set the display to 0 and start. Each time the machine stands still write down X
   and Y of the display, then let it go on, until that does nothing any more. Do not set the display
   to 0 in between.
3. Between the first stop and the second the wire goes two different ways along X and Y: measure
   them on the machine itself, and write them down as `moved`.
4. Do the same with the three others. Each ends with what the controller may refuse; if it does,
   also when the file is loaded, write `alarm` behind the place where it stands.
5. `wedmcam profile probe --read probe.txt` prints the keys of a profile. Or read the tables here.

The programs take the layout and the control words of `--profile` (b3-compact): a controller with
other words for D, DD and E needs a profile with these first.
"""


#: What a table alone would not say.
NOTES = {
    "main": [
        "Two stops about the table and two about arcs: both must say the same. No other way is",
        "known; a controller that goes one is of another kind, and `--read` says at which stop.",
    ],
    "blanks": [
        "A controller that deletes or refuses X = Y = 0 (`zeros`) does the same at `two blanks`,",
        "whatever it makes of blank fields: believe `one blank`.",
    ],
}


def way_text(way: tuple[int, int]) -> str:
    """Return a way for a table, mm.

    >>> way_text((-1000, 950))
    '-1.000 +0.950'
    """
    x, y = way
    return f"{x / 1000 + 0.0:+.3f} {y / 1000 + 0.0:+.3f}"


def ways(part: str, controller: Behaviour) -> list[tuple[str, str]]:
    """Return (section, way from the stop before) of every stop; an alarm says so."""
    out, x, y = [], 0, 0
    for s in stops(part, controller):
        way = way_text((s.x - x, s.y - y)) + (" alarm" if s.alarm else "")
        out.append((s.section, way))
        x, y = s.x, s.y
    return out


def rows(part: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield (stop, way from the stop before, what it means, what to set) of a program."""
    fields = set()
    for section in PARTS[part]:
        field = section.field
        if not field:
            yield section.name, dict(ways(part, Behaviour()))[section.name], "see `moved`", ""
        elif field in ("pause", "stop", "end"):
            if field not in fields:
                yield from _word_rows(part, section)
            fields.add(field)
        else:
            by_way: dict[str, list[str]] = {}
            for value in MEANS[field]:
                of = dict(ways(part, Behaviour(**{field: value})))  # type: ignore[arg-type]
                if section.name in of:
                    by_way.setdefault(of[section.name], []).append(value)
            for way, values in by_way.items():
                keys = dict.fromkeys(f"`{k}`" for v in values if (k := MEANS[field][v][1]))
                means = "; or: ".join(MEANS[field][v][0] for v in values)
                yield section.name, way, means, " or ".join(keys) if len(values) == 1 else ""


def _word_rows(part: str, section: Section) -> Iterator[tuple[str, str, str, str]]:
    """Yield what a control word may do: it shows in which stops there are."""
    names = [s.name for s in PARTS[part]]
    for value, (means, _) in MEANS[section.field].items():
        of = ways(part, Behaviour(**{section.field: value}))  # type: ignore[arg-type]
        here = [w for name, w in of if names.index(name) >= names.index(section.name)]
        if section.field == "pause" and value == "waits":
            here = here[:1]
        if section.field == "pause" and value == "nothing":
            yield section.name, "it goes on to the stop word", means, ""
            continue
        only = ", and no more" if value == "ends" else ""
        yield section.name, ", then ".join(here) + only, means, ""


def page() -> str:
    """Return docs/probe.md."""
    lines = [HOW, "| program | records | steps | goes, around its start, mm |", "|---|---|---|---|"]
    for part in PARTS:
        b = blocks(part)
        x0, y0, x1, y1 = (v / 1000 for v in extents(part))
        steps = int(np.maximum(MIRROR.run(b).steps, 0).sum())
        lines.append(f"| `{part}` | {len(b)} | {steps} | x {x0:g} to {x1:g}, y {y0:g} to {y1:g} |")
    lines += [
        "",
        "A mm around the programmed path is in these, for controllers that go beside it. They are",
        "mm of the display: where a pulse moves the machine by 10 um it goes ten times as far.",
        "",
        "## What the readings mean",
        "",
        "A way is X and Y from the stop before, in mm of the display: one reading less the last.",
    ]
    for part in PARTS:
        lines += ["", f"### `{part}`", "", "| stop | way | means | set |", "|---|---|---|---|"]
        lines += [f"| {' | '.join(row)} |" for row in rows(part)]
        lines += ["", *NOTES[part]] if part in NOTES else []
    lines += [
        "",
        "### `moved`",
        "",
        "Where the wire goes on the part, as the drawing is to lie on the machine, while the",
        "display goes by +2.000 +1.000. Twice as far both ways: `step_um = 2`, and so on.",
        "",
        "| way | set in `[axes]` |",
        "|---|---|",
    ]
    for (long, short), x, y in product(((2000, 1000), (1000, 2000)), (1, -1), (1, -1)):
        way = long * x, short * y
        axes = axes_of(way)
        assert axes is not None
        lines.append(f"| {way_text(way)} | {_set(axes)} |")
    return "\n".join(lines) + "\n"


def _set(axes: Axes) -> str:
    on = [name for name in ("exchange", "mirror_x", "mirror_y") if getattr(axes, name)]
    return ", ".join(f"`{name} = true`" for name in on) or "nothing"

"""From what a shop read at its machine back to the controller, and to the keys of a profile."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.machines import Axes
from wedmcam.probe.behaviour import ASKED, Behaviour, Stop, behaviours, stops
from wedmcam.probe.records import PARTS

#: A reading may be off by this much, steps: dials are read to a hundredth of a mm. The least that
#: two controllers differ by at one stop is twice as much and more.
ROOM = 15

#: Field -> value -> what it means, and the lines of a profile; empty where there is nothing to set.
MEANS: dict[str, dict[str, tuple[str, str]]] = {
    "table": {
        "rotate": ("lines are stepped by the table that is turned", 'line_table = "rotate"'),
        "mirror": ("lines are stepped by the table that is mirrored", 'line_table = "mirror"'),
        "stated": (
            "lines end where X and Y say, whatever G and J: either table will do",
            'line_table = "rotate"',
        ),
    },
    "arcs": {
        "counted": ("arcs stop after J steps on G", 'count = "exact"'),
        "own axis": (
            "arcs stop after J steps on an axis that the controller chooses: G is not obeyed, and "
            "arcs that end near 45 degrees may end beside: look at them in a dry run",
            'count = "exact"',
        ),
        "recomputed": ("arcs end where J and G say", 'count = "textbook"'),
    },
    "zeros": {
        "run": ("X = Y = 0 is run", ""),
        "deleted": (
            "X = Y = 0 is deleted in silence: old programs that hold such records cut less; "
            "wedmcam writes none",
            "",
        ),
        "refused": ("X = Y = 0 is refused; wedmcam writes none", ""),
    },
    "blanks": {
        "taken": ("blank fields are taken as 0", ""),
        "deleted": ("records with a blank field are deleted in silence; wedmcam writes none", ""),
        "refused": ("blank fields are refused; wedmcam writes none", ""),
    },
    "pause": {
        "waits": ("the pause word makes it wait", ""),
        "ends": (
            "the pause word ends the program: set words.pause to the word that makes it wait, and "
            "write the probe again with that profile",
            "",
        ),
        "nothing": (
            "the pause word does nothing: set words.pause to the word that makes it wait, and "
            "write the probe again with that profile",
            "",
        ),
    },
    "stop": {
        "ends": ("the stop word ends the program", ""),
        "waits": ("the stop word makes it wait and go on: a pause for it", ""),
        "nothing": (
            "the stop word does nothing: set words.stop to the word that ends a program",
            "",
        ),
    },
    "end": {
        "ends": ("the end word ends the program", ""),
        "waits": ("the end word makes it wait and go on: a pause for it", ""),
        "nothing": ("the end word does nothing", ""),
    },
}


class Answer(NamedTuple):
    """What one program says about one field of `Behaviour`; all values that fit the readings."""

    field: str
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Readings:
    """A sheet that was filled in.

    Attributes:
        stops: program -> stops as read, in order; their section is not known: "".
        lines: program -> line of the sheet of each stop.
        moved: how far the wire went between the first two stops, (x, y) as the drawing lies on the
            machine, um; None where it was not measured.
    """

    stops: Mapping[str, Sequence[Stop]]
    lines: Mapping[str, Sequence[int]]
    moved: tuple[float, float] | None = None


def sheet(names: Mapping[str, str]) -> str:
    """Return a sheet to fill in at the machine.

    Args:
        names: program -> the file it is in.
    """
    rows = [
        "# Readings of the probe: see docs/probe.md.",
        "# Generator and wire off. Set the display to 0 before each program, and not in between.",
        "# Each time the machine stands still: its name here, X and Y of the display in mm, and",
        "# 'alarm' behind them if it refuses to go on. Then let it go on, until that does nothing.",
        "# Where it never stood, delete the line.",
    ]
    for part, sections in PARTS.items():
        rows += ["", f"# {names.get(part, part)}"]
        rows += [f"{part:8}____  ____   # {s.name}: {s.asks}" for s in sections]
        if part == "main":
            rows += [
                "# How far the wire went on the part from the first stop to the second, by a dial,",
                "# as the drawing lies on the machine: +x to the right, +y away from you.",
                "moved   ____  ____",
            ]
    return "\n".join(rows) + "\n"


def read_sheet(text: str, file: str) -> tuple[Readings, list[Diagnostic]]:
    """Return what is filled in, and an error for each line that cannot be read.

    >>> read_sheet("end 0.5 0", "s.txt")[0].stops["end"]
    [Stop(section='', x=500, y=0, alarm=False)]
    """
    findings: list[Diagnostic] = []
    read: dict[str, list[Stop]] = {}
    lines: dict[str, list[int]] = {}
    moved = None
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].replace(",", ".").split()
        if not words or any(re.fullmatch("_+", t) for t in words):
            continue
        numbers = [t for t in words[1:3] if re.fullmatch(r"[-+]?\d{1,6}(\.\d*)?|[-+]?\.\d+", t)]
        known = words[0] in PARTS or words[0] == "moved"
        if not known or len(numbers) < 2 or words[3:] not in ([], ["alarm"]):
            findings.append(
                error(
                    "probe-reading",
                    "'{line}' is no reading",
                    TextSpan(file, number, 1),
                    hint="a line is {programs} or moved, X and Y in mm, and 'alarm' or nothing",
                    line=line.strip()[:40],
                    programs=", ".join(PARTS),
                )
            )
            continue
        x, y = (1000.0 * float(v) for v in numbers)
        if words[0] == "moved":
            moved = x, y
            continue
        read.setdefault(words[0], []).append(Stop("", round(x), round(y), bool(words[3:])))
        lines.setdefault(words[0], []).append(number)
    return Readings(read, lines, moved), findings


def answers(readings: Readings, file: str) -> tuple[list[Answer], list[Diagnostic]]:
    """Return what the readings say, and an error for each program that no known controller runs so.

    A reading counts by its way from the one before.
    """
    out: list[Answer] = []
    findings: list[Diagnostic] = []
    fits: dict[str, set[str]] = {}
    for part in [p for p in PARTS if p in readings.stops]:
        read = readings.stops[part]
        if fits.get("pause", {"waits"}) != {"waits"}:
            break  # the others wait at the same word
        candidates = list(_kinds(part))
        good = [c for c in candidates if _agree(stops(part, c), read) == len(read)]
        if not good and len(read) > 1 and read[-1] == read[-2]:
            # Told to go on once more, where the program had ended.
            good = [c for c in candidates if _agree(stops(part, c), read[:-1]) == len(read) - 1]
        if not good:
            most = max(_agree(stops(part, c), read, partly=True) for c in candidates)
            last = min(most, len(read) - 1)
            x, y = read[last][1:3]
            findings.append(
                error(
                    "probe-reading",
                    "stop {stop} of {program}, at {x_mm:.3f}, {y_mm:.3f}, fits no controller that "
                    "is known"
                    if most < len(read)
                    else "the {stops} stops of {program} fit, but controllers stop elsewhere too",
                    TextSpan(file, readings.lines[part][last], 1),
                    hint="read it again; was the display at 0 at the start, and is a line for each "
                    "stop?",
                    stop=most + 1,
                    stops=len(read),
                    program=part,
                    x_mm=x / 1000,
                    y_mm=y / 1000,
                )
            )
            continue
        for field in ASKED[part]:
            values = {str(getattr(c, field)) for c in good}
            if any(c.pause != "waits" for c in good) and field != "pause":
                continue
            fits[field] = values & fits.get(field, values)
    for field in MEANS:
        if field in fits and len(fits[field]) < len(MEANS[field]):
            out.append(Answer(field, tuple(v for v in MEANS[field] if v in fits[field])))
    return out, findings


def _kinds(part: str) -> Iterable[Behaviour]:
    """Yield controllers that differ in what a program asks."""
    seen = set()
    for b in (*behaviours(), *(behaviours(pauses=False) if part == "main" else ())):
        key = tuple(getattr(b, field) for field in ASKED[part])
        if key not in seen:
            seen.add(key)
            yield b


def _agree(wanted: Sequence[Stop], read: Sequence[Stop], partly: bool = False) -> int:
    """Return how many readings in a row agree; -1 where there are more or fewer stops."""
    if len(wanted) != len(read) and not partly:
        return -1
    n, before, was = 0, (0, 0), (0, 0)
    for w, r in zip(wanted, read, strict=False):
        dx, dy = (w.x - before[0]) - (r.x - was[0]), (w.y - before[1]) - (r.y - was[1])
        if max(abs(dx), abs(dy)) > ROOM or w.alarm != r.alarm:
            break
        n, before, was = n + 1, (w.x, w.y), (r.x, r.y)
    return n


def axes_of(moved: tuple[float, float]) -> Axes | None:
    """Return how the axes lie, from where 2000 pulses of X and 1000 of Y moved the wire, um.

    None where that is not two ways, one twice the other.

    >>> axes_of((-2000, 1000)).text, axes_of((5000, 10000)).text
    ('x mirrored', 'x and y exchanged; steps of 5 um')
    """
    x, y = moved
    long, short = max(abs(x), abs(y)), min(abs(x), abs(y))
    if not long or abs(short / long - 0.5) > 0.05:
        return None
    step = (long + short) / 3000
    near = next((s for s in (0.5, 1.0, 2.0, 2.5, 4.0, 5.0, 10.0) if abs(step / s - 1) < 0.03), None)
    return Axes(abs(x) < abs(y), x < 0, y < 0, near or round(step, 3))


def toml(words: Sequence[Answer], moved: tuple[float, float] | None = None) -> str:
    """Return the keys of a profile that follow, and the rest as comments."""
    keys, notes = [], []
    for answer in words:
        for value in answer.values:
            meaning, key = MEANS[answer.field][value]
            may = "" if len(answer.values) == 1 else "perhaps: "
            notes.append(f"# {may}{meaning}")
            if key and len(answer.values) == 1:
                keys.append(key)
    lines = [*notes, *dict.fromkeys(keys)]
    if moved is not None:
        axes = axes_of(moved)
        if axes is None:
            lines.append("# moved: not two ways, one twice the other; measure again")
        else:
            flags = (("exchange", axes.exchange), ("mirror_x", axes.mirror_x),
                     ("mirror_y", axes.mirror_y))  # fmt: skip
            lines += ["[axes]", *(f"{k} = {'true' if on else 'false'}" for k, on in flags)]
            lines.append(f"step_um = {axes.step_um:g}")
    return "\n".join(lines) + "\n"

"""The sheet that goes to the machine with a program: ``--setup-sheet FILE``.

Which start holes to drill and where, where the machine's zero is, what to do each time it stops,
what comes loose when, and how long it takes. Places and times are those of the decoded program, as
the controller will run it; what the contours are is what was understood of the source.
"""

from __future__ import annotations

from base64 import b64encode
from collections import Counter
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from wedmcam.diag import visible
from wedmcam.ir.program import Kind
from wedmcam.ir.understanding import HEADINGS, place
from wedmcam.programs.loose import loose
from wedmcam.programs.places import block_ends

if TYPE_CHECKING:
    from wedmcam.compiler.results import Compilation
    from wedmcam.machines import Machine

CUTTING = (Kind.LINE, Kind.ARC)
Table = tuple[tuple[str, ...], list[tuple[str, ...]]]
#: A larger picture is not put into a text, characters.
LARGEST_PICTURE = 1_000_000


@dataclass(frozen=True, slots=True)
class Picture:
    """The picture of the program, and the file it stands in, if any."""

    svg: str
    file: str = ""


def sheet(
    compilation: Compilation,
    name: str,
    feed_um: float | None = None,
    *,
    wire_um: float | None = None,
    gap_um: float | None = None,
    picture: str = "",
) -> list[tuple[str, Any]]:
    """Return the sheet as (heading, text or table or picture) pairs.

    Args:
        compilation: one that is ok.
        name: of the program.
        feed_um: cutting speed, um a minute; None for no times.
        wire_um: diameter of the wire; None where only an offset was stated.
        gap_um: spark gap, likewise.
        picture: file of the picture that is written with the sheet; empty for none.
    """
    from wedmcam.reports.plot import plot

    assert compilation.program is not None
    assert compilation.understood is not None
    known, zero = compilation.understood, compilation.program.origin_um
    facts = [
        ("program", visible(name)),
        *_facts(
            compilation, feed_um, _wire(wire_um, gap_um, compilation.options.cutting.clearance_um)
        ),
    ]
    return [
        ("Setup sheet", (("what", "value"), facts)),
        (
            "Zero",
            f"The program starts at the first start hole, {place(zero)} mm in the drawing. Set the "
            "machine to zero there; places 'from zero' are counted from it, places 'in the "
            "drawing' are those of the drawing.",
        ),
        (
            "Start holes",
            (("hole", "x in the drawing", "y in the drawing", "x from zero", "y from zero",
              "blocks", "offset mm", "path with leads mm", "time", "placed by"),
             _holes(compilation, zero, feed_um)),
        ),
        ("Who placed them", ". ".join(known.threads) + "."),
        ("Contours", (HEADINGS, [(f"{r.number} ({r.thread.name})", *r.cells[1:])
                                 for r in known.rows])),
        ("What comes loose", _loose(compilation, zero)),
        (
            "Where the machine stops",
            (("block", "in the drawing mm", "what to do", "from zero mm"),
             _stops(compilation, zero)),
        ),
        ("Picture", Picture(plot(compilation, name), picture)),
    ]  # fmt: skip


def _facts(compilation: Compilation, feed_um: float | None, wire: str) -> list[tuple[str, str]]:
    """Return what the sheet says of the whole program; ``wire`` says how wide it cuts."""
    assert compilation.program is not None
    assert compilation.verdict is not None
    assert compilation.plan is not None
    assert compilation.understood is not None
    v, m, known, zero = (
        compilation.verdict,
        compilation.machine,
        compilation.understood,
        compilation.program.origin_um,
    )
    entered = compilation.entries.lines() if compilation.entries else []
    turned = compilation.entries.turn_lines() if compilation.entries else []
    ways = Counter(row.direction for row in known.rows)
    return [
        ("made of", visible(str(compilation.summary["input"]))),
        ("controller", visible(f"{m.title} ({m.name})")),
        ("cuts", known.counts),
        ("axes", _axes(m)),
        ("program's SHA-256", compilation.summary["sha256"]["output"]),
        ("blocks, steps", f"{v.blocks}, {v.steps}"),
        ("wire path", f"{v.path_mm:.3f} mm" + _time(v.path_mm, feed_um)),
        ("wire, gap", wire),
        ("offset, side", f"{compilation.plan.offsets_text}, {v.side}"),
        *((f"offset {d}, to be entered", um) for d, um in entered),
        *((f"{name}, to be entered", value) for name, value in turned),
        ("direction", ", ".join(f"{n} {way}" for way, n in ways.items())),
        ("extents", "({:.3f}, {:.3f}) to ({:.3f}, {:.3f}) mm in the drawing".format(
            *(e / 1000 for e in v.extents_um))),
        ("extents from zero", "({:.3f}, {:.3f}) to ({:.3f}, {:.3f}) mm".format(
            *((e - o) / 1000 for e, o in zip(v.extents_um, (*zero, *zero), strict=True)))),
        ("proof", f"deviation {v.max_deviation_um:.2f} um, gouge "
                  f"{'-' if v.gouge_um is None else f'{v.gouge_um:.2f} um'}, closure "
                  f"{'-' if v.closure_um is None else f'{v.closure_um:.0f} um'}"),
    ]  # fmt: skip


def _holes(
    compilation: Compilation, zero: tuple[float, float], feed_um: float | None
) -> list[tuple[str, ...]]:
    """Return a row for each start hole."""
    assert compilation.verdict is not None
    assert compilation.understood is not None
    holes: list[tuple[str, ...]] = []
    for cut, row in zip(compilation.verdict.cuts, compilation.understood.rows, strict=True):
        tx, ty = _start(compilation, cut.first_block - 1)
        holes.append(
            (row.thread.name,
             *(f"{c / 1000 + 0.0:.3f}" for c in (tx, ty, tx - zero[0], ty - zero[1])),
             f"{cut.first_block} to {cut.last_block}", f"{row.offset_um / 1000:.3f}",
             f"{cut.length_mm:.3f}",
             _time(cut.length_mm, feed_um).strip(" ()"), row.thread.origin)
        )  # fmt: skip
    return holes


def _wire(wire_um: float | None, gap_um: float | None, clearance_um: float) -> str:
    if wire_um is None or gap_um is None:
        return "not stated; the offset holds half the wire and the gap"
    wire, gap = wire_um / 1000, gap_um / 1000
    return (
        f"wire {wire:.3f} mm, gap {gap:.3f} mm: offset {wire / 2 + gap:.3f} mm = wire / 2 + gap"
        + (f", less the clearance {clearance_um / 1000:.3f} mm" if clearance_um else "")
    )


def _loose(compilation: Compilation, zero: tuple[float, float]) -> Table | str:
    """Return which cut frees what, and where the wire is then."""
    assert compilation.understood is not None
    assert compilation.program is not None
    assert compilation.lowered is not None
    rows: list[tuple[str, ...]] = []
    for one in loose(
        compilation.understood, compilation.lowered, compilation.program, compilation.machine
    ):
        contour = compilation.understood.rows[one.number - 1]
        what = f"the {one.what} of contour {one.number} ({contour.role_text}, {contour.size_text})"
        stop = f"{contour.stop_um / 1000:.3f} mm before"
        wait = f"; the machine waits {stop}" if contour.stop_um else "; the machine does not wait"
        there = (one.at[0] - zero[0], one.at[1] - zero[1])
        done = f"{one.along_um / 1000:.3f}"
        rows.append((str(one.block), done, place(one.at), place(there), f"{what} is loose{wait}"))
    heads = ("end of block", "after mm of its cut", "in the drawing mm", "from zero mm", "what")
    return (heads, rows) if rows else "Nothing: no contour is cut through."


def _axes(machine: Machine) -> str:
    """Return how the drawing lies on the machine: which way its axes run there."""
    a = machine.axes
    if not a.text:
        return "as in the drawing"
    step = f"steps of {a.step_um:g} um" if a.step_um != 1 else ""
    if a.plain:
        return f"as in the drawing; {step}"
    names = ("Y", "X") if a.exchange else ("X", "Y")
    runs = [
        f"+{own} of the drawing is {'-' if mirrored else '+'}{name} of the machine"
        for own, mirrored, name in zip("xy", (a.mirror_x, a.mirror_y), names, strict=True)
    ]
    return f"{', '.join(runs)}{f'; {step}' if step else ''}; all places here are the drawing's"


def _time(path_mm: float, feed_um: float | None) -> str:
    return "" if feed_um is None else f" ({1000 * path_mm / feed_um:.1f} min)"


def _ends(compilation: Compilation) -> Any:
    assert compilation.program is not None
    return block_ends(compilation.program, compilation.machine)[1]


def _start(compilation: Compilation, row: int) -> tuple[float, float]:
    assert compilation.program is not None
    if row == 0:
        return compilation.program.origin_um
    x, y = _ends(compilation)[row - 1]
    return float(x), float(y)


def _stops(compilation: Compilation, zero: tuple[float, float]) -> list[tuple[str, ...]]:
    """Return what to do at every record at which the machine waits."""
    assert compilation.program is not None
    kinds = compilation.program.blocks["kind"]
    ends = _ends(compilation)

    def stop(when: str, at: Any, what: str) -> tuple[str, ...]:
        return (when, place(at), what, place((at[0] - zero[0], at[1] - zero[1])))

    out = [stop("before 1", zero, "thread the wire through T1; generator on")]
    thread = 1
    for row, kind in enumerate(kinds.tolist()):
        if kind not in (Kind.PAUSE, Kind.STOP, Kind.END, Kind.THREAD):
            continue
        before = kinds[row - 1] if row else None
        after = kinds[row + 1] if row + 1 < len(kinds) else None
        if kind in (Kind.STOP, Kind.END):
            what = "the end: cut the wire, take the part"
        elif kind == Kind.THREAD:
            what = "a thread point: the wire can be threaded and cut here"
        elif after == Kind.MOVE:
            what = f"cut the wire, generator off; go on: the machine moves to T{thread + 1}"
        elif before == Kind.MOVE:
            thread += 1
            what = f"thread the wire through T{thread}; generator on; go on"
        elif after in CUTTING and before in CUTTING:
            what = "hold the piece so that it cannot fall or jam; go on"
        else:
            thread += 1
            what = f"the same hole again: T{thread} stands where T{thread - 1} does; go on"
        out.append(stop(str(row + 1), ends[row], what))
    return out


def markdown(parts: list[tuple[str, Any]], inline: bool = True) -> str:
    """Return a sheet as Markdown, which reads as plain text too.

    ``inline``: a picture without a file of its own stands in the last line, as data.
    """
    lines, data = [], ""
    for level, (heading, body) in enumerate(parts):
        lines += [f"{'#' if level == 0 else '##'} {heading}", ""]
        if isinstance(body, Picture):
            if body.file:
                lines += [f"![{body.file}]({body.file})", ""]
            elif inline and len(body.svg) <= LARGEST_PICTURE:
                lines += ["![the program][picture]", ""]
                data = (
                    "[picture]: data:image/svg+xml;base64," + b64encode(body.svg.encode()).decode()
                )
            else:
                lines += ["--plot FILE.svg draws it beside, a sheet FILE.html holds it.", ""]
            continue
        if isinstance(body, str):
            lines += [body, ""]
            continue
        head, rows = body
        width = [max(len(r[k]) for r in [head, *rows]) for k in range(len(head))]
        for row in (head, tuple("-" * w for w in width), *rows):
            lines.append(
                "| " + " | ".join(c.ljust(w) for c, w in zip(row, width, strict=True)) + " |"
            )
        lines.append("")
    return "\n".join([*lines, data, ""] if data else lines)


def html(parts: list[tuple[str, Any]]) -> str:
    """Return a sheet as a page to print."""
    out = ['<!doctype html><meta charset="utf-8"><title>Setup sheet</title>',
           "<style>body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}"
           "td,th{border:1px solid #999;padding:.3em .6em;text-align:left}"
           "svg{max-width:100%;height:auto}</style>"]  # fmt: skip
    for level, (heading, body) in enumerate(parts):
        tag = "h1" if level == 0 else "h2"
        out.append(f"<{tag}>{escape(heading)}</{tag}>")
        if isinstance(body, Picture):
            out.append(body.svg[body.svg.index("<svg") :])
            continue
        if isinstance(body, str):
            out.append(f"<p>{escape(body)}</p>")
            continue
        head, rows = body
        out.append("<table><tr>" + "".join(f"<th>{escape(c)}</th>" for c in head) + "</tr>")
        out += ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in r) + "</tr>" for r in rows]
        out.append("</table>")
    return "\n".join(out) + "\n"


def write_sheet(
    compilation: Compilation, name: str, file: str, feed_um: float | None = None, **more: Any
) -> bytes:
    """Return the sheet in the form that its file's name tells: .html, .txt, else Markdown.

    ``more``: as of `sheet`.
    """
    parts = sheet(compilation, name, feed_um, **more)
    ending = file.lower().rpartition(".")[2]
    if ending in ("html", "htm"):
        return html(parts).encode("utf-8")
    return markdown(parts, inline=ending != "txt").encode("utf-8")


__all__ = ["Picture", "html", "markdown", "sheet", "write_sheet"]

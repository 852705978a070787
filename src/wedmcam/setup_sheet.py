"""The sheet that goes to the machine with a program: ``--setup-sheet FILE``.

Which start holes to drill and where, where the machine's zero is, what to do each time it stops,
and how long it takes. Everything is told of the decoded program, as the controller will run it, and
not of the drawing.
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

from wedmcam.diag import visible
from wedmcam.ir.program import Kind
from wedmcam.programs.places import block_ends

if TYPE_CHECKING:
    from wedmcam.api import Compilation
    from wedmcam.machines import Machine

CUTTING = (Kind.LINE, Kind.ARC)
Table = tuple[tuple[str, ...], list[tuple[str, ...]]]


def sheet(made: Compilation, name: str, feed_um: float | None = None) -> list[tuple[str, Any]]:
    """Return the sheet as (heading, text or table) pairs.

    Args:
        made: a compile that is ok.
        name: of the program.
        feed_um: cutting speed, um a minute; None for no times.
    """
    assert made.program is not None
    assert made.verdict is not None
    assert made.plan is not None
    v, m, program = made.verdict, made.machine, made.program
    x0, y0 = program.origin_um
    entered = made.entries.lines() if made.entries else []
    facts = [
        ("program", visible(name)),
        ("made of", visible(str(made.summary["input"]))),
        ("controller", visible(f"{m.title} ({m.name})")),
        ("axes", _axes(m)),
        ("program's SHA-256", made.summary["sha256"]["output"]),
        ("blocks, steps", f"{v.blocks}, {v.steps}"),
        ("wire path", f"{v.path_mm:.3f} mm" + _time(v.path_mm, feed_um)),
        ("offset, side", f"{made.plan.offsets_text}, {v.side}"),
        *((f"offset {d}, to be entered", um) for d, um in entered),
        ("extents", "({:.3f}, {:.3f}) to ({:.3f}, {:.3f}) mm".format(
            *(e / 1000 for e in v.extents_um))),
        ("proof", f"deviation {v.max_deviation_um:.2f} um, gouge "
                  f"{'-' if v.gouge_um is None else f'{v.gouge_um:.2f} um'}, closure "
                  f"{'-' if v.closure_um is None else f'{v.closure_um:.0f} um'}"),
    ]  # fmt: skip
    holes, own = [], [cut.offset_um for cut in made.plan.cuts]
    for n, cut in enumerate(v.cuts, 1):
        tx, ty = _start(made, cut.first_block - 1)
        holes.append(
            (f"T{n}", *(f"{c / 1000:.3f}" for c in (tx, ty, tx - x0, ty - y0)),
             f"{cut.first_block} to {cut.last_block}", f"{own[n - 1] / 1000:.3f}",
             f"{cut.length_mm:.3f}",
             _time(cut.length_mm, feed_um).strip(" ()"))
        )  # fmt: skip
    return [
        ("Setup sheet", (("what", "value"), facts)),
        (
            "Zero",
            f"The program starts at the first start hole, ({x0 / 1000:.3f}, {y0 / 1000:.3f}) mm in "
            "the drawing. Set the machine to zero there; all else is counted from it.",
        ),
        (
            "Start holes",
            (("hole", "x drawing", "y drawing", "x from zero", "y from zero", "blocks",
              "offset mm", "path mm", "time"), holes),
        ),
        ("Where the machine stops", (("block", "place mm", "what to do"), _stops(made))),
    ]  # fmt: skip


def _axes(machine: Machine) -> str:
    """Return how the drawing lies on the machine: which way its axes run there."""
    a = machine.axes
    if not a.said:
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


def _ends(made: Compilation) -> Any:
    assert made.program is not None
    return block_ends(made.program, made.machine)[1]


def _start(made: Compilation, row: int) -> tuple[float, float]:
    assert made.program is not None
    if row == 0:
        return made.program.origin_um
    x, y = _ends(made)[row - 1]
    return float(x), float(y)


def _stops(made: Compilation) -> list[tuple[str, ...]]:
    """Return what to do at every record at which the machine waits."""
    assert made.program is not None
    kinds = made.program.blocks["kind"]
    ends = _ends(made)
    out: list[tuple[str, ...]] = [
        ("before 1", _mm(made.program.origin_um), "thread the wire through T1; generator on")
    ]
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
        out.append((str(row + 1), _mm(ends[row]), what))
    return out


def _mm(place: Any) -> str:
    return f"({place[0] / 1000:.3f}, {place[1] / 1000:.3f})"


def markdown(parts: list[tuple[str, Any]]) -> str:
    """Return a sheet as Markdown, which reads as plain text too."""
    lines = []
    for level, (heading, body) in enumerate(parts):
        lines += [f"{'#' if level == 0 else '##'} {heading}", ""]
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
    return "\n".join(lines)


def html(parts: list[tuple[str, Any]]) -> str:
    """Return a sheet as a page to print."""
    out = ['<!doctype html><meta charset="utf-8"><title>Setup sheet</title>',
           "<style>body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}"
           "td,th{border:1px solid #999;padding:.3em .6em;text-align:left}</style>"]  # fmt: skip
    for level, (heading, body) in enumerate(parts):
        tag = "h1" if level == 0 else "h2"
        out.append(f"<{tag}>{escape(heading)}</{tag}>")
        if isinstance(body, str):
            out.append(f"<p>{escape(body)}</p>")
            continue
        head, rows = body
        out.append("<table><tr>" + "".join(f"<th>{escape(c)}</th>" for c in head) + "</tr>")
        out += ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in r) + "</tr>" for r in rows]
        out.append("</table>")
    return "\n".join(out) + "\n"


def written(made: Compilation, name: str, file: str, feed_um: float | None) -> bytes:
    """Return the sheet in the form that its file's name tells: .html, else Markdown."""
    parts = sheet(made, name, feed_um)
    page = file.lower().endswith((".html", ".htm"))
    return (html(parts) if page else markdown(parts)).encode("utf-8")


__all__ = ["html", "markdown", "sheet", "written"]

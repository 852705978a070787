"""Write 3B in the layout of a profile: full values, never blank, the same bytes every time.

Lines are written with G and J by rule, arcs with those of the block. A move stands between two
pauses; the pauses it lacks are added. A program that has no stop behind its last cut gets one. What
does not fit is refused, and nothing is returned then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, ends, over_memory, travel
from wedmcam.diag import Diagnostic, Severity
from wedmcam.formats import b3, lines, quadrants
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.machines import Layout, Machine

#: Records formatted at a time.
_PIECE = 1 << 16


def encode(
    program: Program,
    machine: Machine,
    positions: NDArray[np.int64] | None = None,
    *,
    fourth: Sequence[tuple[int, str]] | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the 3B file of a program, and what was found.

    Args:
        program: blocks as lowering or a decoder made them. `Kind.THREAD` becomes a pause.
        machine: a 3B profile.
        positions: where the machine stands after each block, drawing um, shape (blocks, 2); for
            end coordinates. Left out, the controller is run when they are needed.
        fourth: for each block a number and letters that stand before G: a 4B file.

    Returns:
        The bytes, empty when there is an error.
    """
    checks = Checks(program)
    blocks = program.blocks
    f = _fields(checks, machine)
    order = _order(checks)
    kinds = np.where(order < 0, np.uint8(Kind.PAUSE), blocks["kind"][order])
    kinds[kinds == Kind.THREAD] = Kind.PAUSE
    lone = b3.moves(kinds) & (kinds == Kind.LINE)
    mask = np.zeros(len(blocks), dtype=bool)
    mask[order[lone]] = True
    checks.tell(
        Severity.ERROR,
        "lone-line",
        mask,
        "block {block}: a single line between two pauses would be read as a move",
        hint="write the line as two blocks",
    )
    named = dict(program.words)
    controls = _controls(machine)
    mask = blocks["kind"] == Kind.WORD
    for i in np.flatnonzero(mask).tolist():
        mask[i] = not b3.is_word(named[i]) or named[i] in controls.values()
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        mask,
        "block {block}: '{word}' would not be read as a control word of its own",
        lambda i: {"word": named[i]},
    )
    if not checks.failed:
        checks.findings += travel(program, machine)
    last_cut = np.flatnonzero(kinds <= Kind.MOVE)[-1:]
    stops = np.flatnonzero((kinds == Kind.STOP) | (kinds == Kind.END))
    if not len(stops) or (len(last_cut) and stops[-1] < last_cut[0]):
        order, kinds = np.append(order, -1), np.append(kinds, np.uint8(Kind.STOP))
    checks.findings += over_memory(len(order), machine)
    if checks.failed:
        return b"", checks.findings

    layout = machine.layout
    if layout.end_coordinates and positions is None:
        positions = ends(program, machine)
    code = b3.instruction(blocks["turn"], quadrants.quadrant(f.x, f.y, blocks["turn"]))
    fields = (abs(f.x), abs(f.y), f.count, f.axis, code)
    parts = [b"".join(line.encode(layout.encoding) + _eol(layout) for line in layout.header)]
    for low in range(0, len(order), _PIECE):
        piece = slice(low, low + _PIECE)
        words = {int(i): named[int(i)] for i in order[piece] if int(i) in named}
        texts = _records(
            kinds[piece], order[piece], fields, positions, layout, controls, words, fourth
        )
        if layout.number_width:
            numbering = f"N%{layout.number_width}d{layout.after_number}%s"
            texts = [numbering % pair for pair in enumerate(texts, low + 1)]
        parts.append("".join(t + layout.eol for t in texts).encode("ascii"))
    parts += [line.encode(layout.encoding) + _eol(layout) for line in layout.footer]
    return b"".join(parts), checks.findings


def _eol(layout: Layout) -> bytes:
    return layout.eol.encode("ascii")


def _controls(machine: Machine) -> dict[int, str]:
    words = machine.words
    return {Kind.PAUSE: words.pause, Kind.STOP: words.stop, Kind.END: words.end}


def _order(checks: Checks) -> NDArray[np.int64]:
    """Return the block behind each record to write; -1 for a pause that a move lacks."""
    kinds = checks.program.blocks["kind"]
    move = kinds == Kind.MOVE
    pause = (kinds == Kind.PAUSE) | (kinds == Kind.THREAD)
    before, after = move.copy(), move.copy()
    before[1:] &= ~(pause | move)[:-1]  # a move before adds the pause behind it
    after[:-1] &= ~pause[1:]
    checks.tell(
        Severity.NOTE,
        "pause-added",
        before | after,
        "block {block}: a move needs a pause before and after it; added",
    )
    at = np.arange(len(kinds))
    places = np.concatenate([at[before], at[after] + 1])
    return np.insert(at, np.sort(places), -1)


@dataclass(slots=True, eq=False)
class _Fields:
    """Numbers of the records to write, one entry a block, steps; 0 where it is no motion.

    Attributes:
        x, y: signed.
        axis: on which J counts.
        count: J.
        arc, line: which blocks are arcs; lines and moves.
    """

    x: NDArray[np.int64]
    y: NDArray[np.int64]
    axis: NDArray[np.uint8]
    count: NDArray[np.int64]
    arc: NDArray[np.bool_]
    line: NDArray[np.bool_]


def _fields(checks: Checks, machine: Machine) -> _Fields:
    """Return the numbers to write, lines in full and by rule, and report what does not fit."""
    blocks = checks.program.blocks
    x, y, count, axis = (blocks[k].copy() for k in ("x", "y", "count", "axis"))
    arc = blocks["kind"] == Kind.ARC
    line = (blocks["kind"] == Kind.LINE) | (blocks["kind"] == Kind.MOVE)
    assert ((blocks["turn"] != 0) == arc).all()
    for values in (x, y, count):
        values[~(arc | line)] = 0
    f = _Fields(x, y, axis, count, arc, line)
    _refuse_too_large(checks, machine, f)
    _refuse_endless(checks, machine, f)
    exact = _write_full(checks, machine, f)
    _count_by_rule(checks, machine, f, exact)
    return f


def _refuse_too_large(checks: Checks, machine: Machine, f: _Fields) -> None:
    """Report numbers that a field does not hold; they are 1 from there, so that none overflows."""
    per_mm, limits = 1000.0 / machine.axes.step_um, machine.limits
    long = f.count > limits.count_um
    checks.tell(
        Severity.ERROR,
        "over-limit",
        long,
        "block {block}: J is {count_mm:.3f} mm; the largest of {machine} is {most_mm:.3f} mm",
        lambda i: {
            "count_mm": int(f.count[i]) / per_mm,
            "machine": machine.name,
            "most_mm": limits.count_um / per_mm,
        },
    )
    wide = _too_wide(checks, machine, f, f.arc | f.line)
    checks.tell(
        Severity.ERROR, "zero-count", (f.arc | f.line) & (f.count <= 0), "block {block}: J is 0"
    )
    refused = wide | long | (f.count < 0)
    f.x[refused], f.y[refused], f.count[refused] = 1, 1, 1


def _too_wide(
    checks: Checks, machine: Machine, f: _Fields, some: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Report and return the blocks, of ``some``, whose x or y are over a limit."""
    per_mm, limits = 1000.0 / machine.axes.step_um, machine.limits
    largest = np.where(f.arc, limits.arc_um, limits.line_um)
    wide: NDArray[np.bool_] = some & ((np.abs(f.x) > largest) | (np.abs(f.y) > largest))
    checks.tell(
        Severity.ERROR,
        "over-limit",
        wide,
        "block {block}: X, Y are {x_mm:.3f} mm, {y_mm:.3f} mm; the largest of {machine} is "
        "{most_mm:.3f} mm",
        lambda i: {
            "x_mm": abs(int(f.x[i])) / per_mm,
            "y_mm": abs(int(f.y[i])) / per_mm,
            "machine": machine.name,
            "most_mm": int(largest[i]) / per_mm,
        },
    )
    return wide


def _refuse_endless(checks: Checks, machine: Machine, f: _Fields) -> None:
    """Report blocks that a controller would not end, or would count otherwise."""
    per_mm = 1000.0 / machine.axes.step_um
    checks.tell(
        Severity.ERROR,
        "arc-too-small",
        f.arc & (f.x * f.x + f.y * f.y < 2),
        "block {block}: the arc starts {radius_mm:.3f} mm from its centre and never ends",
        lambda i: {"radius_mm": abs(int(f.x[i] + f.y[i])) / per_mm},
    )
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        f.arc & (f.axis == Axis.SQUARE),
        "block {block}: an arc counted on the inscribed square; 3B counts on X or on Y",
        hint="convert the program with lowering",
    )
    checks.tell(
        Severity.ERROR,
        "endless-block",
        f.line & (lines.along_axis(f.x, f.y, f.axis) == 0),
        "block {block}: the line has no length on its count axis and never ends",
    )


def _write_full(checks: Checks, machine: Machine, f: _Fields) -> NDArray[np.bool_]:
    """State lines in full that are a ratio, and return which lines are full now."""
    per_mm = 1000.0 / machine.axes.step_um
    fx, fy, exact = lines.full(f.x, f.y, f.axis, f.count)
    exact &= f.line
    f.x, f.y = np.where(exact, fx, f.x), np.where(exact, fy, f.y)
    _too_wide(checks, machine, f, exact)
    checks.tell(
        Severity.NOTE,
        "ratio-line",
        f.line & ~exact,
        "block {block}: X and Y are a ratio that J {count_mm:.3f} mm does not make whole; written "
        "as it is",
        lambda i: {"count_mm": int(f.count[i]) / per_mm},
    )
    return exact


def _count_by_rule(checks: Checks, machine: Machine, f: _Fields, exact: NDArray[np.bool_]) -> None:
    """Give full lines the G and J that the machine's line table asks for."""
    wanted = machine.own_stepping.line_count(f.x, f.y)[0]
    other = exact & (f.axis != Axis.SQUARE) & (wanted != f.axis)
    tie = abs(f.x) == abs(f.y)
    checks.tell(
        Severity.WARNING,
        "count-axis",
        other & ~tie,
        "block {block}: the line was counted on its shorter axis; written with the longer one, "
        "its end may move",
    )
    checks.tell(
        Severity.NOTE,
        "count-axis",
        other & tie,
        "block {block}: a 45 degree line; written with G{axis}, on which the {line_table} line "
        "table ends exactly",
        lambda i: {"axis": "XY"[int(wanted[i])], "line_table": machine.line_table},
    )
    f.axis = np.where(exact, wanted, f.axis)
    f.count = np.where(exact, lines.along_axis(f.x, f.y, f.axis), f.count)


def _records(
    kinds: NDArray[np.uint8],
    order: NDArray[np.int64],
    fields: tuple[NDArray[np.int64] | NDArray[np.uint8], ...],
    positions: NDArray[np.int64] | None,
    layout: Layout,
    controls: dict[int, str],
    words: dict[int, str],
    fourth: Sequence[tuple[int, str]] | None = None,
) -> list[str]:
    """Return the text of each record, without number and line end."""
    gap = layout.between
    number = f"B{layout.after_b}%{layout.width}d"
    digits = f"0{layout.count_digits}" if layout.count_digits > 1 else f"{layout.width}"
    more = f"{gap}{number}{gap}%s" if fourth is not None else ""
    form = f"{number}{gap}{number}{gap}B{layout.after_b}%{digits}d{more}{gap}G%s{gap}%s"
    cutting = kinds <= Kind.MOVE
    rows = order[cutting]
    x, y, count, axis, code = (f[rows].tolist() for f in fields)
    z = [b3.INSTRUCTIONS[c] for c in code]
    g = ["XY"[a] for a in axis]
    columns: list[Sequence[Any]] = [x, y, count]
    if fourth is not None:
        columns += [[fourth[i][k] for i in rows.tolist()] for k in (0, 1)]
    columns += [g, z]
    if layout.end_coordinates:
        assert positions is not None
        form += f"{gap};{gap}%.3f{gap},{gap}%.3f"
        ex, ey = (positions[rows] / 1000).T.tolist()
        columns += [ex, ey]
    lines = [form % row for row in zip(*columns, strict=True)]
    if cutting.all():
        return lines
    texts = iter(lines)
    return [
        next(texts) if kind <= Kind.MOVE else words[i] if kind == Kind.WORD else controls[kind]
        for kind, i in zip(kinds.tolist(), order.tolist(), strict=True)
    ]

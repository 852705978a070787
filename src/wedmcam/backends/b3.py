"""Write 3B in the layout of a profile: full values, never blank, the same bytes every time.

Lines are written with G and J by rule, arcs with those of the block. A move stands between two
pauses; the pauses it lacks are added. A program that has no stop behind its last cut gets one. What
does not fit is refused, and nothing is returned then.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, ends, travel
from wedmcam.diag import Diagnostic, Severity, warning
from wedmcam.formats import b3, lines, quadrants
from wedmcam.formats.lengths import mm_of
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
    x, y, axis, count = _fields(checks, machine)
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
        lambda i: "a single line between two pauses would be read as a move",
        "write the line as two blocks",
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
        lambda i: f"'{named[i]}' would not be read as a control word of its own",
    )
    if not checks.failed:
        checks.found += travel(program, machine)
    last_cut = np.flatnonzero(kinds <= Kind.MOVE)[-1:]
    stops = np.flatnonzero((kinds == Kind.STOP) | (kinds == Kind.END))
    if not len(stops) or (len(last_cut) and stops[-1] < last_cut[0]):
        order, kinds = np.append(order, -1), np.append(kinds, np.uint8(Kind.STOP))
    most = machine.limits.blocks
    if most and len(order) > most:
        text = f"{len(order)} records; {machine.name} holds {most}: {-(-len(order) // most)} loads"
        checks.found.append(warning("over-memory", text))
    if checks.failed:
        return b"", checks.found

    layout = machine.layout
    if layout.end_coordinates and positions is None:
        positions = ends(program, machine)
    code = b3.instruction(blocks["turn"], quadrants.quadrant(x, y, blocks["turn"]))
    fields = (abs(x), abs(y), count, axis, code)
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
    return b"".join(parts), checks.found


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
        lambda i: "a move needs a pause before and after it; added",
    )
    at = np.arange(len(kinds))
    places = np.concatenate([at[before], at[after] + 1])
    return np.insert(at, np.sort(places), -1)


def _fields(
    checks: Checks, machine: Machine
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.uint8], NDArray[np.int64]]:
    """Return x, y (signed), axis and J to write, and report what does not fit."""
    mm = mm_of(machine.axes.step_um)
    blocks, limits = checks.program.blocks, machine.limits
    x, y, count, axis = (blocks[k].copy() for k in ("x", "y", "count", "axis"))
    arc = blocks["kind"] == Kind.ARC
    line = (blocks["kind"] == Kind.LINE) | (blocks["kind"] == Kind.MOVE)
    assert ((blocks["turn"] != 0) == arc).all()
    for values in (x, y, count):
        values[~(arc | line)] = 0
    err, warn, note = Severity.ERROR, Severity.WARNING, Severity.NOTE

    largest = np.where(arc, limits.arc_um, limits.line_um)

    def too_large(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.bool_]:
        return (np.abs(x) > largest) | (np.abs(y) > largest)

    def tell_large(mask: NDArray[np.bool_]) -> None:
        checks.tell(
            err,
            "over-limit",
            mask,
            lambda i: (
                f"X, Y are {mm(abs(int(x[i])))}, {mm(abs(int(y[i])))}; "
                f"the largest of {machine.name} is {mm(int(largest[i]))}"
            ),
        )

    checks.tell(
        err,
        "over-limit",
        count > limits.count_um,
        lambda i: (
            f"J is {mm(int(count[i]))}; the largest of {machine.name} is {mm(limits.count_um)}"
        ),
    )
    wide = too_large(x, y)
    tell_large(wide)
    checks.tell(err, "zero-count", (arc | line) & (count <= 0), lambda i: "J is 0")
    # What was refused must not overflow below.
    refused = wide | (count > limits.count_um) | (count < 0)
    x[refused], y[refused], count[refused] = 1, 1, 1
    checks.tell(
        err,
        "arc-too-small",
        arc & (x * x + y * y < 2),
        lambda i: f"the arc starts {mm(abs(int(x[i] + y[i])))} from its centre and never ends",
    )
    checks.tell(
        err,
        "not-in-format",
        arc & (axis == Axis.SQUARE),
        lambda i: "an arc counted on the inscribed square; 3B counts on X or on Y",
        "convert the program with lowering",
    )
    checks.tell(
        err,
        "endless-block",
        line & (lines.along_axis(x, y, axis) == 0),
        lambda i: "the line has no length on its count axis and never ends",
    )

    fx, fy, exact = lines.full(x, y, axis, count)
    exact &= line
    x, y = np.where(exact, fx, x), np.where(exact, fy, y)
    tell_large(exact & too_large(x, y))
    checks.tell(
        note,
        "ratio-line",
        line & ~exact,
        lambda i: (
            f"X and Y are a ratio that J {mm(int(count[i]))} does not make whole; written as it is"
        ),
    )
    wanted = machine.own_stepping.line_count(x, y)[0]
    other = exact & (axis != Axis.SQUARE) & (wanted != axis)
    tie = abs(x) == abs(y)
    checks.tell(
        warn,
        "count-axis",
        other & ~tie,
        lambda i: (
            "the line was counted on its shorter axis; written with the longer one, its end "
            "may move"
        ),
    )
    checks.tell(
        note,
        "count-axis",
        other & tie,
        lambda i: (
            f"a 45 degree line; written with G{'XY'[int(wanted[i])]}, on which the "
            f"{machine.line_table} line table ends exactly"
        ),
    )
    axis = np.where(exact, wanted, axis)
    count = np.where(exact, lines.along_axis(x, y, axis), count)
    return x, y, axis, count


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
    made = [form % row for row in zip(*columns, strict=True)]
    if cutting.all():
        return made
    texts = iter(made)
    return [
        next(texts) if kind <= Kind.MOVE else words[i] if kind == Kind.WORD else controls[kind]
        for kind, i in zip(kinds.tolist(), order.tolist(), strict=True)
    ]

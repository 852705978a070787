"""Write the compact cutting format of the ZD-065.

Lines hold no J and no block a count axis: only what the controller derives by itself can be
written. A pause directly behind a move is the thread point of that move, 0x30, where the return
after a wire break ends; every other pause is 0x31. The final stop is the end byte 0x00, which is
always written; nothing can follow it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, travel
from wedmcam.backends.zd065.memory import Memory
from wedmcam.diag import Diagnostic, Severity
from wedmcam.formats import compact, lines
from wedmcam.formats.lengths import mm_of
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.machines import Machine


def encode(
    program: Program, machine: Machine, positions: NDArray[np.int64] | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return the compact data of a program, and what was found.

    Args:
        program: blocks as lowering or a decoder made them; arcs counted on `Axis.SQUARE`.
        machine: a compact profile.
        positions: not needed; writers are called alike.

    Returns:
        The bytes, empty when there is an error.
    """
    checks = Checks(program)
    kinds = program.blocks["kind"]
    arc = kinds == Kind.ARC
    move = kinds == Kind.MOVE
    straight = move | (kinds == Kind.LINE)
    turn = program.blocks["turn"]
    assert ((turn != 0) == arc).all()
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        kinds == Kind.WORD,
        lambda i: f"the control word '{dict(program.words)[i]}' has no instruction",
    )
    end = (kinds == Kind.STOP) | (kinds == Kind.END)
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        ~end & (np.cumsum(end) > 0),
        lambda i: "stands after the stop; the end byte 0x00 ends the data",
        "write the programs into files of their own",
    )
    x, y, count = _fields(checks, machine, arc, straight)
    if not checks.failed:
        checks.found += travel(program, machine)
    if checks.failed:
        return b"", checks.found

    memory = Memory(kinds, turn, x, y, compact.LENGTH)
    memory.put(arc, 1, 4, x)
    memory.put(arc, 5, 4, y)
    memory.put(arc, 9, 3, count)
    memory.put(straight, 1, 3, x)
    memory.put(straight, 4, 3, y)
    checks.found += memory.too_large(machine)
    return memory.data.tobytes(), checks.found


def _fields(
    checks: Checks, machine: Machine, arc: NDArray[np.bool_], straight: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return x, y (signed) and J to write, and report what does not fit."""
    mm = mm_of(machine.axes.step_um)
    blocks, limits = checks.program.blocks, machine.limits
    x, y, count = (np.where(arc | straight, blocks[k], 0) for k in ("x", "y", "count"))
    axis = blocks["axis"]
    err = Severity.ERROR
    # Before any product: what is refused here must not overflow below.
    huge = np.where(arc, limits.arc_um, limits.line_um)
    wide = (np.abs(x) > huge) | (np.abs(y) > huge)
    checks.tell(
        err,
        "over-limit",
        wide,
        lambda i: (
            f"X, Y are {mm(abs(int(x[i])))}, {mm(abs(int(y[i])))}; "
            f"the largest of {machine.name} is {mm(int(huge[i]))}"
        ),
    )
    most = np.where(arc, limits.count_um, limits.line_um)
    checks.tell(
        err,
        "over-limit",
        count > most,
        lambda i: (
            f"{'J' if arc[i] else 'the length'} is {mm(int(count[i]))}; "
            f"the largest of {machine.name} is {mm(int(most[i]))}"
        ),
    )
    checks.tell(
        err,
        "zero-count",
        (arc | straight) & (count <= 0),
        lambda i: "J is 0",
    )
    refused = wide | (count > most) | (count < 0)
    x[refused], y[refused], count[refused] = 1, 1, 1
    r2 = x * x + y * y
    checks.tell(
        err,
        "over-limit",
        arc & (r2 > limits.arc_um**2),
        lambda i: (
            f"the radius is {mm(float(np.sqrt(r2[i])))}; the largest of {machine.name} is "
            f"{mm(limits.arc_um)}"
        ),
    )
    checks.tell(
        err,
        "arc-too-small",
        arc & (r2 < 2),
        lambda i: f"the arc starts {mm(abs(int(x[i] + y[i])))} from its centre and never ends",
    )
    checks.tell(
        err,
        "not-in-format",
        arc & (axis != Axis.SQUARE),
        lambda i: (
            f"an arc counted on {'XY'[int(axis[i])]}; {machine.name} counts on the inscribed square"
        ),
        "convert the program with lowering",
    )
    checks.tell(
        err,
        "endless-block",
        straight & (lines.along_axis(x, y, axis) == 0),
        lambda i: "the line has no length on its count axis and never ends",
    )
    fx, fy, exact = lines.full(x, y, axis, count)
    checks.tell(
        err,
        "not-in-format",
        straight & ~exact,
        lambda i: (
            f"a line whose X and Y are a ratio that J {mm(int(count[i]))} does not make whole"
        ),
        "convert the program with lowering",
    )
    scaled = straight & exact
    x, y = np.where(scaled, fx, x), np.where(scaled, fy, y)
    derived, longer = compact.line_count(x, y)
    over = scaled & (longer > limits.line_um)
    checks.tell(
        err,
        "over-limit",
        over,
        lambda i: (
            f"the length is {mm(int(longer[i]))}; the largest of {machine.name} is "
            f"{mm(limits.line_um)}"
        ),
    )
    other = scaled & (axis != Axis.SQUARE) & (axis != derived)
    tie = abs(x) == abs(y)
    checks.tell(
        Severity.WARNING,
        "count-axis",
        other & ~tie,
        lambda i: (
            "the line was counted on its shorter axis; this controller counts the longer "
            "one, its end may move"
        ),
    )
    checks.tell(
        Severity.NOTE,
        "count-axis",
        other & tie,
        lambda i: "a 45 degree line; this controller counts it on Y, which ends exactly",
    )
    return x, y, count

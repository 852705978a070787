"""Write the compact cutting format of the ZD-065.

Lines hold no J and no block a count axis: only what the controller derives by itself can be
written. A pause directly behind a move is the thread point of that move, 0x30, where the return
after a wire break ends; every other pause is 0x31. The final stop is the end byte 0x00, which is
always written; nothing can follow it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, travel
from wedmcam.backends.zd065.memory import Memory
from wedmcam.diag import Diagnostic, Severity
from wedmcam.formats import compact, lines
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
        "block {block}: the control word '{word}' has no instruction",
        lambda i: {"word": dict(program.words)[i]},
    )
    end = (kinds == Kind.STOP) | (kinds == Kind.END)
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        ~end & (np.cumsum(end) > 0),
        "block {block}: stands after the stop; the end byte 0x00 ends the data",
        hint="write the programs into files of their own",
    )
    f = _fields(checks, machine, arc, straight)
    if not checks.failed:
        checks.findings += travel(program, machine)
    if checks.failed:
        return b"", checks.findings

    memory = Memory(kinds, turn, f.x, f.y, compact.LENGTH)
    memory.put(arc, 1, 4, f.x)
    memory.put(arc, 5, 4, f.y)
    memory.put(arc, 9, 3, f.count)
    memory.put(straight, 1, 3, f.x)
    memory.put(straight, 4, 3, f.y)
    checks.findings += memory.too_large(machine)
    return memory.data.tobytes(), checks.findings


@dataclass(slots=True, eq=False)
class _Fields:
    """Numbers of the blocks to write, steps; 0 where a block is no motion.

    Attributes:
        x, y: signed.
        axis: on which the block was counted.
        count: J.
        arc, straight: which blocks are arcs; lines and moves.
    """

    x: NDArray[np.int64]
    y: NDArray[np.int64]
    axis: NDArray[np.uint8]
    count: NDArray[np.int64]
    arc: NDArray[np.bool_]
    straight: NDArray[np.bool_]


def _fields(
    checks: Checks, machine: Machine, arc: NDArray[np.bool_], straight: NDArray[np.bool_]
) -> _Fields:
    """Return the numbers to write, lines in full, and report what does not fit."""
    blocks = checks.program.blocks
    x, y, count = (np.where(arc | straight, blocks[k], 0) for k in ("x", "y", "count"))
    f = _Fields(x, y, blocks["axis"], count, arc, straight)
    _refuse_too_large(checks, machine, f)
    _refuse_arcs(checks, machine, f)
    _write_full(checks, machine, f)
    return f


def _refuse_too_large(checks: Checks, machine: Machine, f: _Fields) -> None:
    """Report numbers that a field does not hold; they are 1 from there, so that none overflows."""
    per_mm, limits = 1000.0 / machine.axes.step_um, machine.limits
    huge = np.where(f.arc, limits.arc_um, limits.line_um)
    wide = (np.abs(f.x) > huge) | (np.abs(f.y) > huge)
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
            "most_mm": int(huge[i]) / per_mm,
        },
    )
    most = np.where(f.arc, limits.count_um, limits.line_um)
    checks.tell(
        Severity.ERROR,
        "over-limit",
        f.count > most,
        "block {block}: {number} is {count_mm:.3f} mm; the largest of {machine} is "
        "{most_mm:.3f} mm",
        lambda i: {
            "number": "J" if f.arc[i] else "the length",
            "count_mm": int(f.count[i]) / per_mm,
            "machine": machine.name,
            "most_mm": int(most[i]) / per_mm,
        },
    )
    checks.tell(
        Severity.ERROR, "zero-count", (f.arc | f.straight) & (f.count <= 0), "block {block}: J is 0"
    )
    refused = wide | (f.count > most) | (f.count < 0)
    f.x[refused], f.y[refused], f.count[refused] = 1, 1, 1


def _refuse_arcs(checks: Checks, machine: Machine, f: _Fields) -> None:
    """Report arcs that the controller does not run, and lines that it would not end."""
    per_mm, limits = 1000.0 / machine.axes.step_um, machine.limits
    r2 = f.x * f.x + f.y * f.y
    checks.tell(
        Severity.ERROR,
        "over-limit",
        f.arc & (r2 > limits.arc_um**2),
        "block {block}: the radius is {radius_mm:.3f} mm; the largest of {machine} is "
        "{most_mm:.3f} mm",
        lambda i: {
            "radius_mm": float(np.sqrt(r2[i])) / per_mm,
            "machine": machine.name,
            "most_mm": limits.arc_um / per_mm,
        },
    )
    checks.tell(
        Severity.ERROR,
        "arc-too-small",
        f.arc & (r2 < 2),
        "block {block}: the arc starts {radius_mm:.3f} mm from its centre and never ends",
        lambda i: {"radius_mm": abs(int(f.x[i] + f.y[i])) / per_mm},
    )
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        f.arc & (f.axis != Axis.SQUARE),
        "block {block}: an arc counted on {axis}; {machine} counts on the inscribed square",
        lambda i: {"axis": "XY"[int(f.axis[i])], "machine": machine.name},
        hint="convert the program with lowering",
    )
    checks.tell(
        Severity.ERROR,
        "endless-block",
        f.straight & (lines.along_axis(f.x, f.y, f.axis) == 0),
        "block {block}: the line has no length on its count axis and never ends",
    )


def _write_full(checks: Checks, machine: Machine, f: _Fields) -> None:
    """State lines in full that are a ratio, as far as the controller counts them so."""
    per_mm, limits = 1000.0 / machine.axes.step_um, machine.limits
    fx, fy, exact = lines.full(f.x, f.y, f.axis, f.count)
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        f.straight & ~exact,
        "block {block}: a line whose X and Y are a ratio that J {count_mm:.3f} mm does not make "
        "whole",
        lambda i: {"count_mm": int(f.count[i]) / per_mm},
        hint="convert the program with lowering",
    )
    scaled = f.straight & exact
    f.x, f.y = np.where(scaled, fx, f.x), np.where(scaled, fy, f.y)
    derived, longer = compact.line_count(f.x, f.y)
    checks.tell(
        Severity.ERROR,
        "over-limit",
        scaled & (longer > limits.line_um),
        "block {block}: the length is {length_mm:.3f} mm; the largest of {machine} is "
        "{most_mm:.3f} mm",
        lambda i: {
            "length_mm": int(longer[i]) / per_mm,
            "machine": machine.name,
            "most_mm": limits.line_um / per_mm,
        },
    )
    other = scaled & (f.axis != Axis.SQUARE) & (f.axis != derived)
    tie = abs(f.x) == abs(f.y)
    checks.tell(
        Severity.WARNING,
        "count-axis",
        other & ~tie,
        "block {block}: the line was counted on its shorter axis; this controller counts the "
        "longer one, its end may move",
    )
    checks.tell(
        Severity.NOTE,
        "count-axis",
        other & tie,
        "block {block}: a 45 degree line; this controller counts it on Y, which ends exactly",
    )

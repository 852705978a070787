"""Write a tape of the NBY-15: leader, ``%``, a block a line with even parity, leader.

A program that keeps its tape is written as that; of any other the blocks have to be lines: which
whole degrees an arc is made of is decided by lowering, and not here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, travel
from wedmcam.controllers.nby15.data import TAPE, TapeProgram, lines_of
from wedmcam.diag import Diagnostic, Severity, error
from wedmcam.formats import nby15, tape
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

_WORDS = {Kind.PAUSE: "M00", Kind.STOP: "M02"}


def encode(
    program: Program, machine: Machine, positions: NDArray[np.int64] | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return the tape of a program.

    Args:
        program: a `TapeProgram`, or one of lines.
        machine: a profile of the NBY-15.
        positions: not used: the tape is incremental.

    Returns:
        The rows, empty when there is an error.
    """
    del positions
    checks = Checks(program)
    blocks, mm = program.blocks, machine.axes.step_um / 1000
    kinds = blocks["kind"]
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        (kinds == Kind.ARC) | (kinds >= Kind.END),
        "block {block}: the tape holds lines and arcs of whole degrees",
        hint="compile the drawing for it",
    )
    reach = np.maximum(np.abs(blocks["x"]), np.abs(blocks["y"]))
    checks.tell(
        Severity.ERROR,
        "over-limit",
        (kinds <= Kind.MOVE) & (reach > machine.limits.line_um),
        "block {block}: the line goes {length_mm:.3f} mm along an axis, the format holds "
        "{most_mm:.3f} mm",
        lambda i: {
            "length_mm": int(reach[i]) * mm,
            "most_mm": machine.limits.line_um * mm,
        },
    )
    if checks.failed:
        return b"", checks.findings
    checks.findings += travel(program, machine)
    table = _tape_of(program)
    if len(table) > nby15.MOST_NUMBER:
        checks.findings.append(
            error(
                "over-limit",
                "{blocks} blocks; N counts {most}",
                blocks=len(table),
                most=nby15.MOST_NUMBER,
            )
        )
    if checks.failed:
        return b"", checks.findings
    return tape.punched("".join(_lines(table))), checks.findings


def _tape_of(program: Program) -> NDArray[np.void]:
    """Return the tape that a program keeps, if it is still that of its blocks; else its lines."""
    if isinstance(program, TapeProgram) and program.tape is not None:
        made, _ = lines_of(program.tape)
        same = len(made) == len(program.blocks) and all(
            (made[name] == program.blocks[name]).all() for name in ("kind", "x", "y")
        )
        if same:
            return program.tape
    table = np.zeros(len(program.blocks), TAPE)
    for name in ("kind", "x", "y"):
        table[name] = program.blocks[name]
    return table


def _lines(table: NDArray[np.void]) -> list[str]:
    out = []
    for n, b in enumerate(table, 1):
        kind = Kind(int(b["kind"]))
        if kind in _WORDS:
            out.append(f"N{n}{_WORDS[kind]}\n")
        elif kind == Kind.ARC:
            code = "G03" if b["turn"] > 0 else "G02"
            out.append(f"N{n}{code}A{b['start']}B{b['degrees']}R{b['radius']}\n")
        else:
            code = "G01" if kind == Kind.LINE else "G00"
            out.append(f"N{n}{code}X{b['x']:+d}Y{b['y']:+d}\n")
    return out

"""Blocks that no controller could run, whatever they are for: endless, empty, over a limit."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from wedmcam.diag import Diagnostic, error
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.segments import Bools, Ints
from wedmcam.judge.stretches import per_mm, span_of

#: So many blocks of a sort are listed one by one.
EACH = 5


class Limits(Protocol):
    """What the judge asks of a machine's limits, steps, inclusive."""

    @property
    def count_um(self) -> int:
        """Largest count length J."""

    @property
    def line_um(self) -> int:
        """Largest |x| and |y| of a line or move."""

    @property
    def arc_um(self) -> int:
        """Largest |x| and |y| of an arc's start from its centre."""


def check_blocks(
    program: Program, limits: Limits | None, steps: Ints, free_moves: bool = False
) -> list[Diagnostic]:
    """Report blocks that no controller could run; the first `EACH` of a sort, then their number.

    Args:
        program: as decoded.
        limits: of the machine; None for none.
        steps: of each block; -1 where it never ends.
        free_moves: moves between cuts have no limit (G00).
    """
    b = program.blocks
    per = per_mm(program)
    motion = b["kind"] <= Kind.MOVE
    findings: list[Diagnostic] = []

    empty = motion & ((b["count"] <= 0) | ((b["x"] == 0) & (b["y"] == 0)))
    for row, more in _first(empty):
        d = error(
            "empty-block",
            "block {block}: count length J is {length_mm:.3f} mm",
            span_of(program, row),
            block=row + 1,
            length_mm=int(b["count"][row]) / per,
        )
        findings.append(_with_rest(d, more))
    if limits is not None:
        bound = motion & (b["kind"] != Kind.MOVE) if free_moves else motion
        findings += _over_limits(program, limits, bound)
    for row, more in _first(steps < 0):
        d = error(
            "endless-block",
            "block {block} never ends: x {x_um} y {y_um} um, J {count_um} um",
            span_of(program, row),
            block=row + 1,
            x_um=int(b["x"][row]),
            y_um=int(b["y"][row]),
            count_um=int(b["count"][row]),
        )
        findings.append(_with_rest(d, more))
    return findings


def _over_limits(program: Program, limits: Limits, bound: Bools) -> list[Diagnostic]:
    """Return an error for the blocks over a limit, of those that have limits (``bound``)."""
    b = program.blocks
    per = per_mm(program)
    size = np.maximum(np.abs(b["x"]), np.abs(b["y"]))
    arc = b["kind"] == Kind.ARC
    findings = []
    for row, more in _first(bound & (b["count"] > limits.count_um)):
        d = error(
            "block-limit",
            "block {block}: count length J is {length_mm:.3f} mm, the limit is {limit_mm:.3f} mm",
            span_of(program, row),
            block=row + 1,
            length_mm=int(b["count"][row]) / per,
            limit_mm=limits.count_um / per,
        )
        findings.append(_with_rest(d, more))
    for row, more in _first(bound & ~arc & (size > limits.line_um)):
        d = error(
            "block-limit",
            "block {block}: x or y is {length_mm:.3f} mm, the limit is {limit_mm:.3f} mm",
            span_of(program, row),
            block=row + 1,
            length_mm=int(size[row]) / per,
            limit_mm=limits.line_um / per,
        )
        findings.append(_with_rest(d, more))
    for row, more in _first(arc & (size > limits.arc_um)):
        d = error(
            "block-limit",
            "block {block}: start from centre is {length_mm:.3f} mm, the limit is "
            "{limit_mm:.3f} mm",
            span_of(program, row),
            block=row + 1,
            length_mm=int(size[row]) / per,
            limit_mm=limits.arc_um / per,
        )
        findings.append(_with_rest(d, more))
    return findings


def _first(mask: Bools) -> list[tuple[int, int]]:
    """Return the first rows of a mask, each with how many it stands for that are not listed."""
    rows = np.flatnonzero(mask)
    shown: list[int] = rows[:EACH].tolist()
    rest = len(rows) - len(shown)
    return [(row, rest if row == shown[-1] else 0) for row in shown]


def _with_rest(d: Diagnostic, more: int) -> Diagnostic:
    """Return the last finding of a sort with how many of it are not listed."""
    return d.extended(" (and {others} more)", others=more) if more else d

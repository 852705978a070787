"""Blocks that no controller could run, whatever they are for: endless, empty, over a limit."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from wedmcam.diag import Diagnostic, error
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.runs import per_mm, span_of
from wedmcam.judge.segments import Bools, Ints


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
    """Report blocks that no controller could run; the first five of a sort, then their number.

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

    def report(code: str, mask: Bools, what: str, value: Ints, most: int | None) -> None:
        rows = np.flatnonzero(mask)
        for row in rows[:5].tolist():
            over = "" if most is None else f", the limit is {most / per:.3f} mm"
            more = f" (and {len(rows) - 5} more)" if row == rows[min(4, len(rows) - 1)] else ""
            findings.append(
                error(
                    code,
                    f"block {row + 1}: {what} is {int(value[row]) / per:.3f} mm{over}"
                    + (more if len(rows) > 5 else ""),
                    span_of(program, row),
                )
            )

    empty = motion & ((b["count"] <= 0) | ((b["x"] == 0) & (b["y"] == 0)))
    report("empty-block", empty, "count length J", b["count"], None)
    if limits is not None:
        size = np.maximum(np.abs(b["x"]), np.abs(b["y"]))
        arc = b["kind"] == Kind.ARC
        bound = motion & (b["kind"] != Kind.MOVE) if free_moves else motion
        report(
            "block-limit",
            bound & (b["count"] > limits.count_um),
            "count length J",
            b["count"],
            limits.count_um,
        )
        report(
            "block-limit", bound & ~arc & (size > limits.line_um), "x or y", size, limits.line_um
        )
        report(
            "block-limit", arc & (size > limits.arc_um), "start from centre", size, limits.arc_um
        )
    bad = np.flatnonzero(steps < 0)
    for row in bad[:5].tolist():
        more = f" (and {len(bad) - 5} more)" if len(bad) > 5 and row == bad[4] else ""
        findings.append(
            error(
                "endless-block",
                f"block {row + 1} never ends: x {int(b['x'][row])} y {int(b['y'][row])} um, "
                f"J {int(b['count'][row])} um{more}",
                span_of(program, row),
            )
        )
    return findings

"""Write 4B: the outline in the layout of a 3B profile, with R and D or DD before G.

The controller scales X, Y and J of each arc and rounds. So for each arc of the offset path numbers
are sought that come out as the arc that was proven (`backends.scaled`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends import b3
from wedmcam.backends.checks import Checks
from wedmcam.backends.scaled import outline_of
from wedmcam.diag import Diagnostic
from wedmcam.formats import b4
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine


def encode(
    program: Program,
    machine: Machine,
    positions: NDArray[np.int64] | None = None,
    *,
    gap_um: int = 0,
    outwards: bool = True,
    grown: NDArray[np.integer[Any]] | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the 4B file that the controller makes this program of.

    Args:
        program: the offset path, blocks as for 3B.
        machine: a 4B profile.
        positions: for end coordinates, as in `b3.encode`; they are those of the path.
        gap_um: that the operator will enter, whole um.
        outwards: that the operator will choose: True for a punch, False for a die.
        grown: for each block +1 where the offset made the arc's radius larger, -1 smaller; None for
            a gap of 0.

    Returns:
        The bytes, empty when there is an error.
    """
    checks = Checks(program)
    figure = outline_of(program, machine, checks, gap_um, outwards, grown, b4.MOST_GAP_UM, "3b")
    if figure is None:
        return b"", checks.findings
    blocks = program.blocks
    arc = blocks["kind"] == Kind.ARC
    drawn = blocks.copy()
    moved = figure["kind"] <= Kind.MOVE
    straight = moved & ~arc
    for name in ("x", "y"):
        drawn[name][moved] = figure[name][moved]
    drawn["count"][arc] = figure["count"][arc]
    longer = np.maximum(np.abs(drawn["x"]), np.abs(drawn["y"]))
    changed = straight & ((drawn["x"] != blocks["x"]) | (drawn["y"] != blocks["y"]))
    drawn["count"][changed] = longer[changed]
    wide = np.abs(drawn["x"]) > np.abs(drawn["y"])
    drawn["axis"][changed] = np.where(wide, 0, 1)[changed]
    letters = np.where(figure["grows"] > 0, b4.GROWS, b4.SHRINKS)
    fourth = [
        (r, d if a else "")
        for r, d, a in zip(
            np.where(arc, figure["radius"], 0).tolist(), letters.tolist(), arc.tolist(), strict=True
        )
    ]
    other = Program(drawn, program.origin, program.sources, program.spans, program.words)
    data, more = b3.encode(other, machine, positions, fourth=fourth)
    return data, [*checks.findings, *more]

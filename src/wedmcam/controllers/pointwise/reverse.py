"""How often each axis turns back: where backlash has to be taken up.

A path reverses on an axis where a step along it goes against the last one; within a line never, on
an arc at the apexes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise.circle import Bools, Floats, Ints, apex, frame, quadrant
from wedmcam.controllers.pointwise.closed import position, run
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.ir.program import Kind


def reversals(
    blocks: NDArray[np.void],
    table: LineTable = LineTable.MIRROR,
    last: tuple[int, int] = (1, 1),
) -> tuple[Ints, Ints]:
    """Return how many steps of each block go against the step before on x, and on y; int64.

    Args:
        blocks: dtype ``BLOCK``; a reversal at a joint belongs to the later block.
        table: of the lines.
        last: sign of the last approach before the first block, on x and y.

    >>> from wedmcam.ir.program import BLOCK, Axis
    >>> b = np.zeros(1, BLOCK)
    >>> b["kind"], b["turn"], b["axis"], b["count"], b["x"] = Kind.ARC, 1, Axis.Y, 20, 5
    >>> [n.tolist() for n in reversals(b)]  # a full circle from (5, 0)
    [[2], [2]]
    """
    steps = np.maximum(run(blocks, table).steps, 0)
    is_arc = blocks["kind"] == Kind.ARC
    rows = np.flatnonzero((steps > 0) & is_arc)
    moves = position(blocks, steps, table)
    out = []
    for along, name in enumerate("xy"):
        # Sign of the first and the last step on this axis (0: none), and the turns in between.
        first = np.where(is_arc, 0, np.sign(moves[along]))
        end, inner = first.copy(), np.zeros(len(blocks), np.int64)
        if len(rows):
            first[rows], end[rows], inner[rows] = _arcs(blocks[rows], steps[rows], name)
        # The sign before each block: the latest that is not 0.
        signs = np.concatenate([[last[along]], end])
        latest = np.maximum.accumulate(np.where(signs != 0, np.arange(len(signs)), 0))
        before = signs[latest[:-1]]
        out.append(inner + (first * before < 0))
    return out[0], out[1]


def _arcs(part: NDArray[np.void], steps: Ints, name: str) -> tuple[Ints, Ints, Ints]:
    """Return first sign, last sign and inner reversals on axis ``name`` of arcs that step."""
    x, y, turn = (part[k].astype(np.float64) for k in ("x", "y", "turn"))
    a = apex(x * x + y * y)
    f = frame(x, y, turn)
    q = quadrant(f)
    begin = a - f.u + f.v
    passed = np.floor((begin + steps - 1.0) / (2.0 * a))
    # The place at the end, in the frame of its quadrant.
    dx, dy = position(part, steps)
    odd = (q + passed) % 2 == 1
    u = np.where(odd, np.abs(y + dy), np.abs(x + dx))
    v = np.where(odd, np.abs(x + dx), np.abs(y + dy))
    # Whether the first and the last quadrant step this axis at all; those between step both.
    along_u: Bools = f.odd == (name == "y")
    along_u_end: Bools = odd == (name == "y")
    none = passed == 0
    starts = np.where(along_u, f.u - np.where(none, u, 0.0), np.where(none, v, a) - f.v) > 0
    stops = np.where(along_u_end, np.where(none, f.u, a) - u, v - np.where(none, f.v, 0.0)) > 0
    lo = q + np.where(starts, 0.0, 1.0)
    hi = q + passed - np.where(stops, 0.0, 1.0)
    steps_here = lo <= hi

    # Counter-clockwise x falls in quadrants 0, 1 and rises in 2, 3; y rises in 3, 0, falls in 1, 2.
    shift = 0.0 if name == "x" else 1.0

    def half_turns(k: Floats) -> Floats:
        return np.floor((k + shift) / 2.0)

    def sign(k: Floats) -> Ints:
        rises = half_turns(k) % 2 == 1
        if name == "y":
            rises = rises == (turn < 0)
        return np.where(steps_here, np.where(rises, 1, -1), 0).astype(np.int64)

    inner = np.where(steps_here, half_turns(hi) - half_turns(lo), 0.0).astype(np.int64)
    return sign(lo), sign(hi), inner

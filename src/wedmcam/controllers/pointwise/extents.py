"""The box of all places that blocks step to, without looking at them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise.circle import Floats, Ints, apex, frame, quadrant
from wedmcam.ir.program import Kind


def extents(blocks: NDArray[np.void], steps: Ints, start: Ints, end: Ints) -> Floats:
    """Return x low, y low, x high, y high of all places of blocks that stand somewhere, exact.

    A line is within the box of its ends; an arc reaches A beyond it on each axis it passes.
    """
    both = np.concatenate([start, end]).astype(np.float64)
    box = np.concatenate([both.min(axis=0), both.max(axis=0)])
    rows = np.flatnonzero((blocks["kind"] == Kind.ARC) & (steps > 0))
    if not len(rows):
        return box
    b = blocks[rows]
    x, y, turn = (b[name].astype(np.float64) for name in ("x", "y", "turn"))
    a = apex(x * x + y * y)
    f = frame(x, y, turn)
    begin = a - f.u + f.v
    passed = np.floor((begin + steps[rows] - 1.0) / (2.0 * a))
    q = quadrant(f)
    cx, cy = start[rows, 0] - x, start[rows, 1] - y
    for nth in range(1, 5):  # the apexes at which quadrant q + nth begins
        axis = np.mod(q + nth, 4.0)
        hit = passed >= nth
        for value, reached, low, high in (
            (cx + a, axis == 0, 0, 2),
            (cy + a * turn, axis == 1, 1, 3),
            (cx - a, axis == 2, 0, 2),
            (cy - a * turn, axis == 3, 1, 3),
        ):
            some = value[hit & reached]
            if len(some):
                box[low] = min(box[low], some.min())
                box[high] = max(box[high], some.max())
    return box

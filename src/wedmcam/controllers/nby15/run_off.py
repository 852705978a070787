"""Where the machine runs into a limit switch.

Where the table stands when a program starts is not known: in the middle of its travel [R].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import Kind


class RunOff(NamedTuple):
    """A limit switch that opened.

    Attributes:
        row: of the block that was run, from 0.
        axis: "X" or "Y"; sign: +1 or -1: the switch.
        x, y: where the wire is then, um from the start.
        steps: until then.
    """

    row: int
    axis: str
    sign: int
    x: int
    y: int
    steps: int


def run_off(blocks: NDArray[np.void], travel_um: tuple[int, int]) -> RunOff | None:
    """Return where lines lead out of the travel, None where they stay within.

    >>> from wedmcam.ir.program import BLOCK
    >>> b = np.zeros(2, BLOCK)
    >>> b["x"] = 300
    >>> run_off(b, (1000, 1000))
    RunOff(row=1, axis='X', sign=1, x=500, y=0, steps=500)
    """
    moves = np.where(blocks["kind"][:, None] <= Kind.MOVE, 1, 0)
    ways = np.column_stack([blocks["x"], blocks["y"]]) * moves
    ends = np.cumsum(ways, axis=0)
    half = np.array(travel_um) // 2
    out = np.flatnonzero((np.abs(ends) > half).any(axis=1))
    if not len(out):
        return None
    row = int(out[0])
    line = blocks[row : row + 1].copy()
    line["axis"], line["count"] = MIRROR.line_count(line["x"], line["y"])
    places, _ = MIRROR.trace(line)
    at = ends[row] - ways[row] + places
    first = int(np.flatnonzero((np.abs(at) >= half).any(axis=1))[0])
    x, y = at[first].tolist()
    axis = 0 if abs(x) >= half[0] else 1
    steps = int(np.abs(ways[:row]).sum()) + first
    return RunOff(row, "XY"[axis], 1 if (x, y)[axis] > 0 else -1, x, y, steps)

"""What a file states for a controller that offsets the path itself: outlines, sides, D numbers.

Between the blocks that are stepped as they stand lie *runs* in compensation (G41, G42): a lead-in,
the blocks of the outline, a lead-out. Where the wire goes there depends on what the operator enters
for D; here the outline stands as it is programmed, exact, and how far the wire is to run beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Program

#: One row per motion of a run, um, floats. role: `Role` (LEAD_IN, CONTOUR, LEAD_OUT). (x0, y0) to
#: (x1, y1) as programmed, about (cx, cy) where turn is not 0; start = end with a turn: a full
#: circle. shift: how far the wire runs to the left of it (negative: right), um; d: the number of
#: the offset; run: number of the run, from 0 on.
PROGRAMMED = np.dtype(
    [
        ("role", "u1"),
        ("turn", "i1"),
        ("x0", "f8"),
        ("y0", "f8"),
        ("x1", "f8"),
        ("y1", "f8"),
        ("cx", "f8"),
        ("cy", "f8"),
        ("shift", "f8"),
        ("d", "i4"),
        ("run", "i4"),
    ]
)


@dataclass(frozen=True, slots=True, eq=False)
class Programmed:
    """A program in which some motions are in compensation.

    Attributes:
        program: all blocks in the order of the file. Those of runs only keep the place: where they
            go is not in the file.
        mark: for each block the row of ``motions`` that it stands for; -1 for one that is stepped.
        motions: dtype `PROGRAMMED`, in the order of the file.
    """

    program: Program
    mark: NDArray[np.int64]
    motions: NDArray[np.void]

    def __post_init__(self) -> None:
        assert self.motions.dtype == PROGRAMMED
        assert len(self.mark) == len(self.program.blocks)

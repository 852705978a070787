"""Program: what a controller executes, in integers, format-neutral and exactly as a file states it.

A line is its direction and a count; an arc is its start relative to the centre, a sense, an axis on
which steps are counted, and the count J. Neither holds its end: the end is where the controller's
interpolator stops (``wedmcam.controllers``), and that is the point.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Span


class Kind(enum.IntEnum):
    """What a block is. CUT kinds step with the generator on, MOVE with it off."""

    LINE = 0
    ARC = 1
    MOVE = 2  # a line from thread point to thread point, wire off
    PAUSE = 3  # D: the machine waits for the operator
    STOP = 4  # DD: end of cutting
    END = 5  # E: end of the program
    THREAD = 6  # a thread point of the compact format
    WORD = 7  # an unknown bare word, kept; its text is in ``Program.words``


class Axis(enum.IntEnum):
    """On which axis steps count towards J."""

    X = 0
    Y = 1
    SQUARE = 2  # the inscribed square: y while |x| > |y|, x while |x| < |y|, y at a tie
    SQUARE_X = 3  # the same with x at a tie: how SQUARE looks with x and y exchanged


#: One row per block. x, y, count are steps of the machine, um where a step is 1 um. LINE, MOVE:
#: (x, y) is the direction, and usually the whole way, signed; ARC: (x, y) is the start relative to
#: the centre, signed. turn: +1 counter-clockwise, -1 clockwise, 0 not an arc. axis: `Axis`. count:
#: J. source: index into ``Program.sources`` or -1. cut: 1-based number of the contour the block
#: belongs to, 0 where unknown. role: `Role`.
BLOCK = np.dtype(
    [
        ("kind", "u1"),
        ("turn", "i1"),
        ("axis", "u1"),
        ("role", "u1"),
        ("x", "i8"),
        ("y", "i8"),
        ("count", "i8"),
        ("source", "i4"),
        ("cut", "i4"),
    ]
)


class Role(enum.IntEnum):
    """Why a cutting block is there. A decoded program knows no roles: all CONTOUR."""

    CONTOUR = 0
    LEAD_IN = 1
    LEAD_OUT = 2
    OVERCUT = 3


def in_um(steps: NDArray[Any], step_um: float) -> NDArray[Any]:
    """Return lengths in um of lengths in steps; whole numbers stay whole where a step is.

    >>> in_um(np.array([3, 4]), 2.0).tolist(), in_um(np.array([3, 4]), 0.5).tolist()
    ([6, 8], [1.5, 2.0])
    """
    if step_um == 1:
        return steps
    return steps * (int(step_um) if step_um == int(step_um) else step_um)


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """Blocks from ``origin`` on; ``origin`` is where the first block starts in the drawing.

    A program that was read from a file has origin (0, 0) until somebody knows better, and
    ``spans[i]`` points to block i. All its numbers, ``origin`` among them, are steps: one of them
    moves the machine by ``step_um``. Whoever tells lengths multiplies.
    """

    blocks: NDArray[np.void]
    origin: tuple[int, int] = (0, 0)
    sources: tuple[Span, ...] = ()
    spans: Sequence[Span] = ()
    words: tuple[tuple[int, str], ...] = ()
    step_um: float = 1.0

    @property
    def origin_um(self) -> tuple[float, float]:
        """Where the first block starts, drawing um."""
        x, y = in_um(np.array(self.origin), self.step_um).tolist()
        return x, y

    def __post_init__(self) -> None:
        assert self.blocks.dtype == BLOCK
        assert self.blocks.ndim == 1
        self.blocks.flags.writeable = False

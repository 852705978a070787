"""The family as a value: a line table, and everything that follows from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from wedmcam.controllers.pointwise import closed, deviate, ends, path, reverse, steps
from wedmcam.controllers.pointwise.extents import extents
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.controllers.stepping import (
    ArcEnd,
    Blocks,
    Bools,
    Floats,
    Ints,
    Motion,
    Step,
    Stepping,
)
from wedmcam.ir.program import Axis


@dataclass(frozen=True, slots=True)
class Pointwise:
    """A controller that compares point by point; see `Stepping` for the methods.

    >>> from wedmcam.ir.program import BLOCK
    >>> b = np.zeros(1, BLOCK)
    >>> b["x"], b["y"], b["axis"], b["count"] = 2, 1, Axis.X, 2
    >>> Pointwise(LineTable.MIRROR).trace(b)[0].tolist()
    [[0, 0], [1, 0], [1, 1], [2, 1]]
    """

    table: LineTable

    @property
    def steady(self) -> bool:
        """F decides between two axes, each with one sign in a quadrant."""
        return True

    def run(self, blocks: Blocks) -> Motion:
        """See `closed.run`."""
        return closed.run(blocks, self.table)

    def position(self, blocks: Blocks, n: Ints) -> tuple[Ints, Ints]:
        """See `closed.position`."""
        return closed.position(blocks, n, self.table)

    def places(
        self,
        blocks: Blocks,
        moves: Motion,
        x: Floats,
        y: Floats,
        window: tuple[int, int] | None = None,
    ) -> tuple[Floats, Floats]:
        """See `path.places`."""
        return path.places(blocks, moves, x, y, self.table, window)

    def trace(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """See `path.trace`."""
        return path.trace(blocks, self.table)

    def steps(self, block: np.void) -> Iterator[Step]:
        """See `steps.block_steps`."""
        return steps.block_steps(block, self.table)

    def deviation(self, blocks: Blocks) -> tuple[Floats, Floats]:
        """See `deviate.deviation`."""
        return deviate.deviation(blocks, self.table)

    def extents(self, blocks: Blocks, steps: Ints, start: Ints, end: Ints) -> Floats:
        """See `extents.extents`."""
        return extents(blocks, steps, start, end)

    def reversals(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """See `reverse.reversals`."""
        return reverse.reversals(blocks, self.table)

    def turn_steps(self, radius: Floats) -> Floats:
        """A turn takes 8 R steps: two an axis and um of it, in every quadrant."""
        return 8.0 * radius

    def line_count(self, x: Ints, y: Ints) -> tuple[Ints, Ints]:
        """See `LineTable.line_count`."""
        return self.table.line_count(x, y)

    def same_lines(self, other: Stepping, x: Ints, y: Ints) -> Bools:
        """Lines are the same where both tables step the same axis at F >= 0."""
        if not isinstance(other, Pointwise):
            return np.zeros(np.shape(x), np.bool_)
        on_axis = (np.asarray(x) == 0) | (np.asarray(y) == 0)
        same: Bools = on_axis | (self.table.x_first(x, y) == other.table.x_first(x, y))
        return same

    def arc_end(
        self,
        x: ArrayLike,
        y: ArrayLike,
        turn: ArrayLike,
        ex: ArrayLike,
        ey: ArrayLike,
        square: Axis = Axis.SQUARE,
    ) -> ArcEnd:
        """See `ends.arc_end`: arcs do not depend on the table."""
        return ends.arc_end(x, y, turn, ex, ey, square)


@cache
def of_table(table: str) -> Pointwise:
    """Return the interpolator with a line table, by its name.

    >>> of_table("rotate")
    Pointwise(table=<LineTable.ROTATE: 'rotate'>)
    """
    return Pointwise(LineTable(table))


#: The ZD-065's own, in which its data processing computes.
MIRROR = of_table("mirror")

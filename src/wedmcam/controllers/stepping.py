"""What a controller's interpolator does with blocks: the protocol that everything else uses.

Lowering, the judge and all reports take a `Stepping` and never ask which controller it is. A new
interpolator is a class with these methods, and a line in `wedmcam.controllers.STEPPINGS`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.ir.program import Axis

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Bools: TypeAlias = NDArray[np.bool_]
Blocks: TypeAlias = NDArray[np.void]


class Motion(NamedTuple):
    """What blocks do, one entry a block, int64.

    Attributes:
        dx: end minus start, steps.
        dy: likewise.
        steps: how many steps the block makes; 0 for a control block, -1 for a block that is
            invalid (dx = dy = 0) because the interpolator would never end it.
    """

    dx: Ints
    dy: Ints
    steps: Ints


class ArcEnd(NamedTuple):
    """How arcs arrive at wanted ends; every array has the shape that the inputs broadcast to.

    Where ``landed`` is False, ``steps`` is -1 and all else is 0 or False. A J stops the arc there
    only if the arriving step counts: ``count_x`` only where ``last_axis`` is `Axis.X`, ``count_y``
    only where it is `Axis.Y`, ``count_square`` only where ``square_counts``.

    Attributes:
        landed: the stepped path stands exactly on the end, within one turn.
        steps: how many steps it takes to get there (it comes by once a turn).
        last_axis: int64 `Axis` of the arriving step.
        count_x: steps along x until then.
        count_y: steps along y until then.
        count_square: steps until then that count on the inscribed square.
        square_counts: whether the arriving step is one of them.
    """

    landed: Bools
    steps: Ints
    last_axis: Ints
    count_x: Ints
    count_y: Ints
    count_square: Ints
    square_counts: Bools


class Step(NamedTuple):
    """One motor step.

    Attributes:
        axis: `Axis.X` or `Axis.Y`.
        sign: +1 or -1.
        f: the deviation F after the step.
        x: where the machine stands after it, um: from the start of a line, from the centre of an
            arc.
        y: likewise.
    """

    axis: Axis
    sign: int
    f: int
    x: int
    y: int


class Stepping(Protocol):
    """An interpolator as it looks from the drawing (or, for readers and writers, in its own frame).

    Blocks are of dtype ``BLOCK``; lengths are steps. Everything is for whole arrays at once.
    """

    @property
    def steady(self) -> bool:
        """Whether a stepped line never steps back on an axis, and a stepped arc about its centre.

        The judge bounds the blocks of such a controller without looking at their places; of others
        it measures every block.
        """
        ...

    def run(self, blocks: Blocks) -> Motion:
        """Return where each block ends, from its start, and in how many steps."""
        ...

    def position(self, blocks: Blocks, n: Ints) -> tuple[Ints, Ints]:
        """Return (dx, dy): where each block stands after ``n`` of its steps, from its start."""
        ...

    def places(
        self,
        blocks: Blocks,
        moves: Motion,
        x: Floats,
        y: Floats,
        window: tuple[int, int] | None = None,
    ) -> tuple[Floats, Floats]:
        """Return where the machine stands after every step of blocks that start at (x, y).

        Args:
            blocks: any choice of those of a program.
            moves: of ``run``, for these blocks.
            x: where each block starts.
            y: likewise.
            window: only places from the first of these numbers up to before the second; None for
                all.
        """
        ...

    def trace(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """Return every position of the path, shape (steps + 1, 2), and where each block starts."""
        ...

    def steps(self, block: np.void) -> Iterator[Step]:
        """Yield the steps of one block, places seen from its start; controls none.

        Raises:
            ValueError: the block would never end.
        """
        ...

    def deviation(self, blocks: Blocks) -> tuple[Floats, Floats]:
        """Return (low, high): the extreme signed deviations of each path from its line or circle.

        Over all places and the start, so low <= 0 <= high; positive to the left.
        """
        ...

    def extents(self, blocks: Blocks, steps: Ints, start: Ints, end: Ints) -> Floats:
        """Return x low, y low, x high, y high of all places of blocks that stand somewhere, exact.

        Args:
            blocks: dtype ``BLOCK``.
            steps: how many steps each makes.
            start: where each starts, shape (n, 2).
            end: where each ends.
        """
        ...

    def reversals(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """Return how many steps of each block go against the step before on x, and on y."""
        ...

    def turn_steps(self, radius: Floats) -> Floats:
        """Return about how many steps a whole turn takes."""
        ...

    def line_count(self, x: Ints, y: Ints) -> tuple[Ints, Ints]:
        """Return the `Axis` and the J with which a whole line along (x, y) ends exactly there."""
        ...

    def same_lines(self, other: Stepping, x: Ints, y: Ints) -> Bools:
        """Return whether lines along (x, y) take the same steps here and there."""
        ...

    def arc_end(
        self,
        x: ArrayLike,
        y: ArrayLike,
        turn: ArrayLike,
        ex: ArrayLike,
        ey: ArrayLike,
        square: Axis = Axis.SQUARE,
    ) -> ArcEnd:
        """Return how the arc from (x, y), relative to its centre, arrives at (ex, ey).

        ``square`` is by which tie rule ``count_square`` counts, `Axis` SQUARE or SQUARE_X.
        """
        ...

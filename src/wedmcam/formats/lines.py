"""Lines stated as a ratio, and the same lines stated in full.

To an interpolator X and Y of a line are a ratio: F grows by both in turn, so multiples of them step
alike. Writers state full values: (X, Y) is the whole way, and J its projection on the count axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Axis

Ints = NDArray[np.int64]


def full(
    x: Ints, y: Ints, axis: NDArray[np.uint8], count: Ints
) -> tuple[Ints, Ints, NDArray[np.bool_]]:
    """Return the lines (x, y) scaled so that the projection on ``axis`` is ``count``.

    Args:
        x: um, signed; at most 2**31 in size, ``count`` likewise.
        y: likewise.
        axis: `Axis`; SQUARE is the longer one.
        count: J, at least 0.

    Returns:
        x, y and whether they are now full. Where no whole numbers would do, or the line has no
        length on its count axis, x and y stay as they were.

    >>> x, y, ok = full(np.array([17, 17]), np.array([-5, 5]), np.array([0, 0], np.uint8),
    ...                 np.array([17000, 100]))
    >>> x.tolist(), y.tolist(), ok.tolist()
    ([17000, 17], [-5000, 5], [True, False])
    """
    along = along_axis(x, y, axis)
    divisor = np.where(along == 0, 1, along)
    exact = (along > 0) & (x * count % divisor == 0) & (y * count % divisor == 0)
    factor = np.where(exact, count, divisor)
    return x * factor // divisor, y * factor // divisor, exact


def along_axis(x: Ints, y: Ints, axis: NDArray[np.uint8]) -> Ints:
    """Return the length of lines along their count axis; SQUARE is the longer one."""
    ax, ay = abs(x), abs(y)
    along: Ints = np.select([axis == Axis.X, axis == Axis.Y], [ax, ay], np.maximum(ax, ay))
    return along

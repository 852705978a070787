"""The quadrant in an instruction: L1..L4, NR1..NR4, SR1..SR4 say the signs of X and Y.

3B and the compact format store magnitudes and put the signs into the instruction. On an axis two
quadrants would do; the one that the block enters is right (+X, +Y, -X, -Y are L1 to L4, NR1 to NR4,
and SR4, SR1, SR2, SR3), and the neighbour, which has the same sign there, can be repaired.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Signs of x and y in quadrants 0 (unused) to 4.
SIGN_X = np.array([0, 1, -1, -1, 1], dtype=np.int64)
SIGN_Y = np.array([0, 1, 1, -1, -1], dtype=np.int64)


def quadrant(x: ArrayLike, y: ArrayLike, turn: ArrayLike) -> NDArray[np.int64]:
    """Return the quadrant, 1 to 4, that an instruction names.

    Args:
        x: um; of a line its direction, of an arc the start relative to the centre.
        y: likewise.
        turn: +1 counter-clockwise arc, -1 clockwise, 0 line.

    Returns:
        The quadrant of (x, y), on an axis the one entered: a line enters like a counter-clockwise
        arc. 0 where x = y = 0.

    >>> axes = [9, 0, -9, 0], [0, 9, 0, -9]
    >>> quadrant(*axes, 1).tolist(), quadrant(*axes, 0).tolist(), quadrant(*axes, -1).tolist()
    ([1, 2, 3, 4], [1, 2, 3, 4], [4, 1, 2, 3])
    """
    x, y, turn = np.broadcast_arrays(np.asarray(x), np.asarray(y), np.asarray(turn))
    # Half-open sectors: counter-clockwise they hold their first axis, clockwise their second.
    ccw = np.select(
        [(x > 0) & (y >= 0), (x <= 0) & (y > 0), (x < 0) & (y <= 0), y < 0], [1, 2, 3, 4]
    )
    cw = np.select(
        [(x >= 0) & (y > 0), (x < 0) & (y >= 0), (x <= 0) & (y < 0), x > 0], [1, 2, 3, 4]
    )
    return np.where(turn < 0, cw, ccw).astype(np.int64)


def signed(
    x: NDArray[np.int64], y: NDArray[np.int64], named: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return magnitudes ``x``, ``y`` with the signs of the quadrants ``named``.

    On an axis either neighbour gives the same answer: NR4 and NR1 with y = 0 both start on +X.
    """
    return x * SIGN_X[named], y * SIGN_Y[named]

"""J by geometry, and the end that a controller computes from it ('textbook').

Some controllers do not count steps but recompute the end of an arc from J and G: the coordinate on
the G axis by unwinding J over the monotone pieces, with R rounded to whole um, and the other one
from the radius. Text books give J so. See ``steps`` for the controllers that count.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.ir.program import Axis

Ints = NDArray[np.int64]


class _View(NamedTuple):
    """An arc turned and mirrored so that it runs counter-clockwise and g is its first coordinate.

    In the upper half (h > 0) g falls from +R to -R, in the lower half it rises again.
    """

    g: Ints
    h: Ints


def _view(x: Ints, y: Ints, turn: Ints, axis: Ints) -> _View:
    """Clockwise: mirrored in the x axis. Axis Y: turned by -90 degrees."""
    y = np.where(turn > 0, y, -y)
    on_x = axis == Axis.X
    return _View(np.where(on_x, x, y), np.where(on_x, y, -x))


def _unview(g: Ints, h: Ints, turn: Ints, axis: Ints) -> tuple[Ints, Ints]:
    on_x = axis == Axis.X
    x, y = np.where(on_x, g, -h), np.where(on_x, h, g)
    return x, np.where(turn > 0, y, -y)


def _enters_upper(v: _View) -> NDArray[np.bool_]:
    result: NDArray[np.bool_] = (v.h > 0) | ((v.h == 0) & (v.g > 0))
    return result


def _round(a: NDArray[np.float64]) -> Ints:
    return np.floor(a + 0.5).astype(np.int64)


def nominal_count(
    x: ArrayLike, y: ArrayLike, turn: ArrayLike, ex: ArrayLike, ey: ArrayLike, axis: ArrayLike
) -> Ints:
    """Return J of arcs from (x, y) to (ex, ey), relative to the centre, um: the sum of projections.

    start == end is the full circle. R is |start| rounded to whole um; ``axis`` is `Axis` X or Y.

    A circle of R 9900 counted on Y, and an arc from 12 o'clock to just past 6 counted on X
    (published programs):

    >>> nominal_count([9900, 0], [0, 40100], [1, 1], [9900, -100], [0, -40100], [1, 0]).tolist()
    [39600, 80100]
    """
    x, y, turn, ex, ey, axis = (
        np.asarray(a, dtype=np.int64) for a in np.broadcast_arrays(x, y, turn, ex, ey, axis)
    )
    r = _round(np.hypot(x.astype(float), y.astype(float)))
    s, e = _view(x, y, turn, axis), _view(ex, ey, turn, axis)
    upper = _enters_upper(s)
    sign = np.where(upper, 1, -1)
    # Seen from the half that the arc starts in, g falls first.
    g0, g1 = sign * s.g, sign * e.g
    h1 = sign * e.h
    in_first_half = (h1 > 0) | ((h1 == 0) & (g1 < 0))
    ahead = in_first_half & (g1 < g0)
    count = np.where(
        ahead, g0 - g1, np.where(in_first_half, (r + g0) + 2 * r + (r - g1), (r + g0) + (r + g1))
    )
    return count.astype(np.int64)


def nominal_end(
    x: ArrayLike, y: ArrayLike, turn: ArrayLike, axis: ArrayLike, count: ArrayLike
) -> tuple[Ints, Ints]:
    """Return where arcs from (x, y) end when the controller computes it from J, centre-relative um.

    The coordinate on ``axis`` comes from unwinding J with R rounded, the other one is the nearest
    whole um to sqrt(R^2 - g^2) with R = |start|.

    >>> [v.tolist() for v in nominal_end([0], [40100], [1], [0], [80100])]
    [[-100], [-40100]]
    """
    x, y, turn, axis, count = (
        np.asarray(a, dtype=np.int64) for a in np.broadcast_arrays(x, y, turn, axis, count)
    )
    square = x.astype(float) ** 2 + y.astype(float) ** 2
    r = np.maximum(_round(np.sqrt(square)), 1)
    s = _view(x, y, turn, axis)
    upper = _enters_upper(s)
    sign = np.where(upper, 1, -1)
    g0 = sign * s.g
    rest = count - (r + g0)
    turns = np.where(rest > 0, (rest + 2 * r - 1) // (2 * r), 0)
    part = rest - (turns - 1) * 2 * r
    first = turns == 0
    odd = turns % 2 == 1
    g = np.where(first, g0 - count, np.where(odd, -r + part, r - part))
    h = _round(np.sqrt(np.maximum(square - g.astype(float) ** 2, 0.0)))
    h = np.where(odd & ~first, -h, h)
    return _unview(sign * g, sign * h, turn, axis)

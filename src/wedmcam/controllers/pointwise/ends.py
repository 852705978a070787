"""Whether and when an arc stands on a wanted point, and the J that stops it there.

Lowering asks this of many neighbouring centres at once; no square root is needed but the apex's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.controllers.pointwise.circle import (
    Floats,
    Frame,
    apex,
    frame,
    quadrant,
    tie,
)
from wedmcam.controllers.pointwise.closed import PIECE, arc_valid
from wedmcam.controllers.stepping import ArcEnd
from wedmcam.ir.program import Axis


def arc_end(
    x: ArrayLike,
    y: ArrayLike,
    turn: ArrayLike,
    ex: ArrayLike,
    ey: ArrayLike,
    square: Axis = Axis.SQUARE,
) -> ArcEnd:
    """Return how the arc from (x, y), relative to its centre, arrives at (ex, ey).

    ``turn`` is +1 counter-clockwise, -1 clockwise. start == end means one full turn, else the end
    lies less than a turn ahead. Whole um; inputs broadcast. An invalid arc (R^2 < 2, R over 23 m)
    lands nowhere. ``square`` is by which tie rule ``count_square`` counts, `Axis` SQUARE or
    SQUARE_X.

    >>> e = arc_end(-2000, 9000, 1, 9000, -2000)
    >>> bool(e.landed), Axis(int(e.last_axis)).name, int(e.count_y)
    (True, 'Y', 25440)
    """
    if square == Axis.SQUARE_X:
        # With x and y exchanged an arc turns the other way, and its square is that with y at a tie.
        e = arc_end(y, x, -np.asarray(turn), ey, ex)
        along = np.where(e.landed, int(Axis.X) + int(Axis.Y) - e.last_axis, 0)
        return e._replace(last_axis=along, count_x=e.count_y, count_y=e.count_x)
    arrays = np.broadcast_arrays(x, y, turn, ex, ey)
    shape = arrays[0].shape
    flat = [np.ascontiguousarray(v).reshape(-1) for v in arrays]
    total = len(flat[0])
    landed, square_counts = np.empty(total, bool), np.empty(total, bool)
    steps, last_axis, count_x, count_y, count_square = np.empty((5, total), np.int64)
    outs = (landed, steps, last_axis, count_x, count_y, count_square, square_counts)
    for first in range(0, total, PIECE):
        rows = slice(first, first + PIECE)
        x_, y_, turn_, ex_, ey_ = (v[rows].astype(np.float64) for v in flat)
        for out, value in zip(outs, _piece(x_, y_, turn_, ex_, ey_), strict=True):
            out[rows] = value
    return ArcEnd(
        landed.reshape(shape),
        steps.reshape(shape),
        last_axis.reshape(shape),
        count_x.reshape(shape),
        count_y.reshape(shape),
        count_square.reshape(shape),
        square_counts.reshape(shape),
    )


def _square_index(f: Frame, h: Floats, even_all: Floats) -> Floats:
    """Count square steps from the start of the last even quadrant."""
    here = np.where(f.odd, 2.0 * h, even_all)
    return np.where(f.v <= f.u, f.v, here - f.u) + np.where(f.odd, even_all, 0.0)


def _piece(x: Floats, y: Floats, turn: Floats, ex: Floats, ey: Floats) -> tuple[NDArray[Any], ...]:
    """Do one piece of `arc_end`."""
    ok = arc_valid(x, y) & (np.abs(turn) == 1)
    if not ok.all():
        x, y, turn = np.where(ok, x, 2.0), np.where(ok, y, 0.0), np.where(ok, turn, 1.0)
    r2 = x * x + y * y
    a = apex(r2)
    s, t = frame(x, y, turn), frame(ex, ey, turn)
    u, v = t.u, t.v
    # On the path: F(u, v-1) < 0 <= F(u+1, v), or the apex itself. See ``circle``.
    f = u * u + v * v - r2
    at_apex = (v == 0) & (u == a)
    landed = ok & (((f - 2.0 * v + 1.0 < 0) & (f + 2.0 * u + 1.0 >= 0)) | at_apex)

    # Places: steps, counts along u + v of a whole turn, and of the square.
    ahead = quadrant(t) - quadrant(s)
    steps = 2.0 * a * ahead + (s.u - s.v) - (u - v)
    back = steps <= 0
    quadrants = ahead + 4.0 * back
    steps += 8.0 * a * back
    # Steps along x: in even quadrants along u (A - u of them so far), in odd ones along v.
    count_x = a * quadrants + np.where(t.odd, v, a - u) - np.where(s.odd, s.v, a - s.u)
    count_y = steps - count_x
    h, outwards = tie(r2)
    even_all = 2.0 * h + 2.0 * outwards - 1.0
    halves = (quadrants + s.odd - t.odd) * 0.5
    square = halves * (even_all + 2.0 * h)
    square += _square_index(t, h, even_all) - _square_index(s, h, even_all)

    # The arriving step: v if the path stood on (u, v-1) before. At an apex it is the u step of the
    # quadrant before, whose u is our v.
    by_v = (f + 2.0 * u - 2.0 * v + 2.0 >= 0) & ((v >= 1) | at_apex)
    on_y = by_v != t.odd
    # v - u before it: of a v step < 0, of a u step > 0 counts, of neither the y step.
    before = np.where(at_apex, 1.0 - a, v - u - 1.0)
    square_counts = landed & np.where(before == 0, on_y, by_v == (before < 0))
    return (
        landed,
        np.where(landed, steps, -1.0),
        np.where(landed, np.where(on_y, float(Axis.Y), float(Axis.X)), 0.0),
        np.where(landed, count_x, 0.0),
        np.where(landed, count_y, 0.0),
        np.where(landed, square, 0.0),
        square_counts,
    )

"""Which whole centre an arc takes between two places of the grid, and how far its steps stray.

An interpolator is told a start relative to a whole centre; where it ends follows. So centres near
the true one are tried, one after the other, and those count that arrive on the wanted place.

How far steps stray from their own curve is known: the rule keeps F = |p|^2 - R^2 between -2 and +2
of the coordinate that steps, so the staircase of an arc lies between -cos t and +sin t of its
circle, t being the angle since the axis that was crossed last; that of a line along (dx, dy)
between -|dy| / L and |dx| / L where it rises (quadrants 1 and 3), the other way round where it
falls. To that comes how far the circle that is stepped is off the true one, at `SAMPLES` angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.stepping import Stepping
from wedmcam.ir.program import Axis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: How far steps may stray from the exact path: to the side of the outline, and to the other, um.
TO_OUTLINE_UM = 1.59
AWAY_UM = 1.6
#: Angles at which the stepped circle is compared with the true one.
SAMPLES = 33
#: Centres that are compared: those nearest to the true one from which the arc arrives.
COMPARED = 6
#: Centres beside the nearest whole one.
BESIDE = [(i, j) for i in (0, -1, 1) for j in (0, -1, 1)]
#: And, for arcs up to `NARROW` (radians), so far along the bisector of the chord: there start and
#: end have one radius, and a short arc hardly changes; um.
ALONG = [-12, -9, -7, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 7, 9, 12]
NARROW = float(np.radians(100.0))
#: Of two centres that stray alike, the one nearer to the true one: so much of the budget a um.
NEARER = 1e-3
#: Arcs that are tried together: so much memory.
AT_ONCE = 4096


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Exact lines and arcs that are to be stepped, as columns, um.

    Attributes:
        x0, y0, x1, y1: start and end. cx, cy, radius, turn: of an arc; turn 0 for a line.
        left: the outline is to the left of the path (1) or to the right (-1).
    """

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    radius: Floats
    turn: Ints
    left: Ints

    def take(self, index: Ints | Bools | slice) -> Curves:
        """Return the chosen ones."""
        return Curves(*(getattr(self, name)[index] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Whole places from where to where each is stepped, um."""

    x0: Ints
    y0: Ints
    x1: Ints
    y1: Ints

    def take(self, index: Ints | Bools | slice) -> Places:
        """Return the chosen ones."""
        return Places(*(getattr(self, name)[index] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """The best steps of each arc.

    Attributes:
        stray: of the best, in parts of what is allowed; inf where none arrives.
        cx, cy: its whole centre.
        axis, count: on which its steps are counted, and how many they are: J.
    """

    stray: Floats
    cx: Ints
    cy: Ints
    axis: Ints
    count: Ints


def arcs(exact: Curves, at: Places, stepping: Stepping, arc_um: int, count_um: int) -> Arcs:
    """Return for each exact arc the best that is stepped from place to place.

    Args:
        exact: arcs.
        at: where they are to start and end; one place for both is a full turn.
        stepping: the interpolator.
        arc_um: largest coordinate of a start from its centre.
        count_um: largest J.
    """
    parts = [
        _arcs(exact.take(rows), at.take(rows), stepping, arc_um, count_um)
        for first in range(0, len(exact.x0), AT_ONCE)
        for rows in [slice(first, first + AT_ONCE)]
    ]
    return Arcs(*(np.concatenate([getattr(p, name) for p in parts]) for name in Arcs.__slots__))


def _arcs(exact: Curves, at: Places, stepping: Stepping, arc_um: int, count_um: int) -> Arcs:
    cx, cy, tried = _centres(exact, at)
    x, y = at.x0[:, None] - cx, at.y0[:, None] - cy
    ex, ey = at.x1[:, None] - cx, at.y1[:, None] - cy
    tried &= (np.abs(x) <= arc_um) & (np.abs(y) <= arc_um) & (x * x + y * y >= 2)
    x, y = np.where(tried, x, 2), np.where(tried, y, 0)
    turn = np.broadcast_to(exact.turn[:, None], x.shape)
    end = stepping.arc_end(x, y, turn, ex, ey, Axis.SQUARE)
    count = np.where(end.last_axis == Axis.X, end.count_x, end.count_y)
    # In every format: whether J counts on an axis or on the inscribed square.
    tried &= end.landed & end.square_counts
    tried &= (count <= count_um) & (end.count_square <= count_um)
    off = np.hypot(cx - exact.cx[:, None], cy - exact.cy[:, None])
    nearest = np.argsort(np.where(tried, off, np.inf), axis=1, kind="stable")[:, :COMPARED]
    stray = np.full(x.shape, np.inf)
    for column in nearest.T:
        rows = np.flatnonzero(np.take_along_axis(tried, column[:, None], axis=1)[:, 0])
        k = column[rows]
        centre = cx[rows, k], cy[rows, k]
        stray[rows, k] = _stray_of_arcs(exact.take(rows), at.take(rows), *centre)
    best = np.argmin(stray + NEARER * off, axis=1)
    k = np.arange(len(best)), best
    return Arcs(stray[k], cx[k], cy[k], end.last_axis[k], count[k])


def _centres(exact: Curves, at: Places) -> tuple[Ints, Ints, Bools]:
    """Return the centres that are tried for each arc, and which of them are."""
    beside = np.array(BESIDE)
    x = np.rint(exact.cx)[:, None] + beside[:, 0]
    y = np.rint(exact.cy)[:, None] + beside[:, 1]
    dx, dy = (at.x1 - at.x0).astype(float), (at.y1 - at.y0).astype(float)
    chord = np.hypot(dx, dy)
    chord = np.where(chord > 0, chord, 1.0)
    nx, ny = -dy / chord, dx / chord
    mx, my = 0.5 * (at.x0 + at.x1), 0.5 * (at.y0 + at.y1)
    height = (exact.cx - mx) * nx + (exact.cy - my) * ny
    far = height[:, None] + np.array(ALONG)
    x = np.hstack([x, np.rint(mx[:, None] + far * nx[:, None])])
    y = np.hstack([y, np.rint(my[:, None] + far * ny[:, None])])
    tried = np.ones(x.shape, bool)
    tried[:, len(BESIDE) :] = (_sweeps(exact) <= NARROW)[:, None]
    return x.astype(np.int64), y.astype(np.int64), tried


def _sweeps(exact: Curves) -> Floats:
    """Return by how much each arc turns, radians; a full turn where it ends at its start."""
    start = np.arctan2(exact.y0 - exact.cy, exact.x0 - exact.cx)
    end = np.arctan2(exact.y1 - exact.cy, exact.x1 - exact.cx)
    full = (exact.x0 == exact.x1) & (exact.y0 == exact.y1)
    return np.where(full, 2 * np.pi, np.mod((end - start) * exact.turn, 2 * np.pi))


def _stray_of_arcs(exact: Curves, at: Places, cx: Ints, cy: Ints) -> Floats:
    """Return how far arcs about whole centres stray at most, in parts of what is allowed."""
    x, y = (at.x0 - cx).astype(float), (at.y0 - cy).astype(float)
    start, end = np.arctan2(y, x), np.arctan2(at.y1 - cy, at.x1 - cx)
    full = (at.x0 == at.x1) & (at.y0 == at.y1)
    sweep = np.where(full, 2 * np.pi, np.mod((end - start) * exact.turn, 2 * np.pi))
    angle = start[:, None] + (exact.turn * sweep)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    radius = np.hypot(x, y)[:, None]
    px = (cx - exact.cx)[:, None] + radius * np.cos(angle)
    py = (cy - exact.cy)[:, None] + radius * np.sin(angle)
    off = np.hypot(px, py) - exact.radius[:, None]
    # The staircase may be at its worst between two samples: look half a sample on and back, and
    # over an axis, where it is a whole step inside and then one outside.
    since = np.mod(angle * exact.turn[:, None], np.pi / 2)
    half = np.minimum(0.5 * sweep / (SAMPLES - 1), np.pi / 4)[:, None]
    outside = off + np.sin(np.minimum(since + half, np.pi / 2))
    outside = np.where(since <= half, np.maximum(outside, off + 1.0), outside)
    inside = off - np.cos(np.maximum(since - half, 0.0))
    inside = np.where(since + half >= np.pi / 2, np.minimum(inside, off - 1.0), inside)
    most, least = outside.max(axis=1), inside.min(axis=1)
    # The inside of a counter-clockwise arc is on its left.
    ccw = exact.turn > 0
    return _parts(exact, np.where(ccw, -most, least), np.where(ccw, -least, most))


def lines(exact: Curves, at: Places) -> Floats:
    """Return how far lines from place to place stray at most, in parts of what is allowed.

    From the exact line, or from the chord of an exact arc.
    """
    dx, dy = exact.x1 - exact.x0, exact.y1 - exact.y0
    length = np.hypot(dx, dy)
    length = np.where(length > 0, length, 1.0)
    ux, uy = dx / length, dy / length
    left0 = (at.y0 - exact.y0) * ux - (at.x0 - exact.x0) * uy
    left1 = (at.y1 - exact.y0) * ux - (at.x1 - exact.x0) * uy
    sx, sy = (at.x1 - at.x0).astype(float), (at.y1 - at.y0).astype(float)
    size = np.hypot(sx, sy)
    size = np.where(size > 0, size, 1.0)
    a, b = np.abs(sx) / size, np.abs(sy) / size
    stairs, rises = (sx != 0) & (sy != 0), (sx > 0) == (sy > 0)
    up = np.where(stairs, np.where(rises, a, b), 0.0)
    down = np.where(stairs, np.where(rises, b, a), 0.0)
    aside = _parts(exact, np.minimum(left0, left1) - down, np.maximum(left0, left1) + up)
    # Nor may it begin or end before or behind the ends of the exact one.
    ends = np.maximum(
        np.abs((at.x0 - exact.x0) * ux + (at.y0 - exact.y0) * uy),
        np.abs((at.x1 - exact.x1) * ux + (at.y1 - exact.y1) * uy),
    )
    result: Floats = np.maximum(aside, ends / AWAY_UM)
    return result


def chords(exact: Curves, at: Places) -> Floats:
    """Return how far lines from place to place stray from exact arcs, as `lines` does."""
    half = 0.5 * np.hypot(exact.x1 - exact.x0, exact.y1 - exact.y0)
    share = np.minimum(half / np.maximum(exact.radius, 1e-9), 1.0)
    height = exact.radius * (1.0 - np.sqrt(1.0 - share * share))
    start = np.arctan2(exact.y0 - exact.cy, exact.x0 - exact.cx)
    end = np.arctan2(exact.y1 - exact.cy, exact.x1 - exact.cx)
    wide = np.mod((end - start) * exact.turn, 2 * np.pi) > np.pi
    height = np.where(wide, 2 * exact.radius - height, height)
    return lines(exact, at) + height / min(TO_OUTLINE_UM, AWAY_UM)


def _parts(exact: Curves, low: Floats, high: Floats) -> Floats:
    """Return strays between ``low`` and ``high`` (left positive, um) in parts of the allowed."""
    left = np.where(exact.left > 0, TO_OUTLINE_UM, AWAY_UM)
    right = np.where(exact.left < 0, TO_OUTLINE_UM, AWAY_UM)
    result: Floats = np.maximum(high / left, -low / right)
    return result

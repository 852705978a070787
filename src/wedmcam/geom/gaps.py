"""How near lines and arcs come to each other, and where.

The least distance of two segments that do not cross is at an end of one of them, or, with an arc,
on the line through its centre at right angles to the other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wedmcam.geom import pairs
from wedmcam.geom.segments import Floats, Segments, boxes, distances, points_at, position_of

#: How much longer than the gap beside it a contour is, at least, that lies beside another.
LONG = 20.0
#: Places along each segment that are held against another contour, as shares of its length.
SHARES = (0.0, 0.25, 0.5, 0.75)


class Gaps(NamedTuple):
    """One entry a pair of segments.

    Attributes:
        size: least distance of the two, um. Where they cross it may be more than 0.
        x, y: the middle between the two places at which they are so near, um.
    """

    size: Floats
    x: Floats
    y: Floats


def gaps(a: Segments, b: Segments) -> Gaps:
    """Return how near segment a[i] comes to b[i]."""
    best = Gaps(np.full(len(a), np.inf), np.zeros(len(a)), np.zeros(len(a)))
    for one, other in ((a, b), (b, a)):
        for x, y in _places(one, other):
            size = distances(other, x, y)
            better = size < best.size
            u, v = _foot(other, x, y)
            best.size[better] = size[better]
            best.x[better] = 0.5 * (x + u)[better]
            best.y[better] = 0.5 * (y + v)[better]
    return best


def _places(s: Segments, other: Segments) -> list[tuple[Floats, Floats]]:
    """Return the places of segments at which they may be nearest to the others."""
    places = [(s.x0, s.y0), (s.x1, s.y1)]
    arc = s.turn != 0
    if arc.any():
        # Towards and away from the other's centre, or at right angles to a line.
        round_ = other.turn != 0
        dx = np.where(round_, other.cx - s.cx, -other.uy)
        dy = np.where(round_, other.cy - s.cy, other.ux)
        far = np.hypot(dx, dy)
        far = np.where(far > 0, far, 1.0)
        for way in (1.0, -1.0):
            x, y = s.cx + way * s.radius * dx / far, s.cy + way * s.radius * dy / far
            on = arc & (distances(s, x, y) <= 1e-6)
            places.append((np.where(on, x, s.x0), np.where(on, y, s.y0)))
    return places


def _foot(s: Segments, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return the point of segment i that is nearest to point i."""
    u, v = points_at(s, np.clip(position_of(s, x, y), 0.0, s.length))
    # The nearest end of an arc is not always the one that is nearer by angle.
    for ex, ey in ((s.x0, s.y0), (s.x1, s.y1)):
        nearer = np.hypot(ex - x, ey - y) < np.hypot(u - x, v - y)
        u, v = np.where(nearer, ex, u), np.where(nearer, ey, v)
    return u, v


def beside(a: Segments, b: Segments, within_um: float) -> tuple[float, float]:
    """Return for what share of either of two contours the other is at most so far away, um.

    And how far at most, of what is within. Asked at four places a segment. What is short is beside
    everything that is near, so ``within_um`` is at most one `LONG`-th of the shorter one.
    """
    within_um = min(within_um, float(min(a.length.sum(), b.length.sum())) / LONG)
    one, far = _share(a, b, within_um)
    other, farther = _share(b, a, within_um)
    return min(one, other), max(far, farther)


def _share(a: Segments, b: Segments, within_um: float) -> tuple[float, float]:
    n = len(SHARES)
    at = np.repeat(SHARES, len(a)) * np.tile(a.length, n)
    x, y = points_at(a.take(np.tile(np.arange(len(a)), n)), at)
    i, j = pairs.overlapping(pairs.grow((x, y, x, y), within_um), boxes(b))
    off = pairs.least(distances(b.take(j), x[i], y[i]), i, len(x))
    near = off <= within_um
    share = float((near * np.tile(a.length, n)).sum() / (n * a.length.sum()))
    return share, float(off[near].max(initial=0.0))

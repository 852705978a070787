"""What is to be kept, and whether the wire stays out of it and reaches all of its outline.

Kept is decided from the outlines alone, never from the wire path: a point is inside the part where
an odd number of closed outlines encloses it; ``part`` keeps that, ``die`` keeps all the rest, the
infinite outside included. A wrong side, a wrong sense, a mirrored arc and a diameter taken for a
radius all show here, even if the plan itself is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wedmcam.ir.plan import Material, Side
from wedmcam.ir.program import Role
from wedmcam.judge.route import Route, of_contours
from wedmcam.judge.segments import (
    Bools,
    Floats,
    Ints,
    Segments,
    boxes,
    inside_parity,
    near_pairs,
    nearest,
    normals_at,
    point_distance,
    points_at,
    segment_distance,
    shifted,
)

#: Places deviate by up to this from their route where bounds on the gouge are used, um; beyond it
#: the weaker bound holds.
WIDTH = 2.0

#: What is no deeper than this needs no closer bound, um: the stair alone reaches it on most parts.
SHALLOW = 1.2

#: Fractions of a segment at which the wire has to reach it.
FRACTIONS = np.array([0.02, 0.25, 0.5, 0.75, 0.98])


class Kept(NamedTuple):
    """The kept material beside a route.

    Attributes:
        outlines: all closed outlines.
        offset: radius of the wire with its gap, um.
        part: whether the inside is kept.
        here: offset minus the distance of each segment of the route from the outlines, um: how far
            the exact route is too near. -inf where the segment is not judged (an open contour).
        sides: offset + WIDTH minus the distance of the segment moved `WIDTH` to its left, and to
            its right, shape (2, segments): 0 where that is away from all outlines, 2 WIDTH where
            it is towards them. NaN until it is needed (`_fill`).
        first: for each segment of the route, where its outlines begin in ``near``.
        near: outlines beside the segments of the route.
        route: the segments of the route.
    """

    outlines: Segments
    offset: float
    part: bool
    here: Floats
    sides: Floats
    first: Ints
    near: Ints
    route: Segments

    def _fill(self, segment: Ints) -> None:
        """Fill ``sides`` of segments of the route."""
        new = np.flatnonzero(np.bincount(segment, minlength=len(self.here)))
        new = new[np.isnan(self.sides[0, new])]
        if not len(new):
            return
        count = self.first[new + 1] - self.first[new]
        head = np.cumsum(count) - count
        pair = np.arange(count.sum()) + np.repeat(self.first[new] - head, count)
        rows = np.repeat(new, count)
        least = np.full((2, len(new)), np.inf)
        if len(pair):
            # Both sides in one call: calls cost as much as pairs.
            both = shifted(self.route.take(np.tile(rows, 2)), np.repeat([WIDTH, -WIDTH], len(rows)))
            d = segment_distance(both, self.outlines.take(np.tile(self.near[pair], 2)))
            held = count > 0
            for side in (0, 1):
                part = d[side * len(rows) : (side + 1) * len(rows)]
                least[side, held] = np.minimum.reduceat(part, head[held])
        self.sides[:, new] = self.offset + WIDTH - np.minimum(least, _reach(self.offset))

    def bound_piece(self, segment: Ints, low: Floats, high: Floats) -> Floats:
        """Return how deep places may be that lie from ``low`` (right) to ``high`` (left), um."""
        here = self.here[segment]
        left, right = np.maximum(high, 0.0), np.maximum(-low, 0.0)
        grow = here + np.maximum(left, right)
        deep = np.flatnonzero(grow > SHALLOW)
        if not len(deep):
            return grow
        self._fill(segment[deep])
        out = np.full(len(deep), -np.inf)
        for away, side in ((left[deep], self.sides[0]), (right[deep], self.sides[1])):
            most = here[deep] + away
            top = (here[deep] + side[segment[deep]]) / 2.0
            out = np.maximum(out, np.where(away <= WIDTH, np.minimum(most, top), most))
        grow[deep] = np.where(np.isneginf(here[deep]), -np.inf, out)
        return grow

    def bound(self, segment: Ints, v: Floats) -> Floats:
        """Return how deep places may be that lie ``v`` to the left of their segment, um."""
        self._fill(segment)
        away = np.abs(v)
        side = self.sides[(v <= 0).astype(np.int64), segment]
        grow = self.here[segment] + away
        shrink = np.where(away <= WIDTH, side - away, np.inf)
        return np.asarray(np.minimum(grow, shrink))

    def depth(self, segment: Ints, x: Floats, y: Floats) -> Floats:
        """Return how deep the wire at (x, y) is in the kept material, exact, um; negative: clear.

        ``segment`` is the segment of the route that each place is at most a few um from. Places
        farther from all outlines than ``offset`` and some um say -1.
        """
        n = self.first[segment + 1] - self.first[segment]
        out = np.full(len(x), -1.0)
        some = np.flatnonzero(n > 0)
        if not len(some):
            return out
        n = n[some]
        head = np.cumsum(n) - n
        j = self.near[np.arange(n.sum()) + np.repeat(self.first[segment[some]] - head, n)]
        d = point_distance(self.outlines.take(j), np.repeat(x[some], n), np.repeat(y[some], n))
        out[some] = self.offset - np.minimum.reduceat(d, head)
        # Where the route runs on the outline itself the sign is not known.
        doubt = some[self.here[segment[some]] >= self.offset - WIDTH]
        if len(doubt):
            within = self.keeps(x[doubt], y[doubt])
            out[doubt[within]] = 2.0 * self.offset - out[doubt[within]]
        return out

    def keeps(self, x: Floats, y: Floats) -> np.ndarray:
        """Return whether points lie in the kept material."""
        inside = inside_parity(self.outlines, x, y)
        return inside if self.part else ~inside


def _reach(offset: float) -> float:
    """How far from the route outlines matter, um."""
    return offset + 2.0 * WIDTH + 1.0


def kept_material(material: Material, route: Route, judged: np.ndarray) -> Kept:
    """Return the kept material beside a route.

    Args:
        material: what is kept, and the offset.
        route: of the wire.
        judged: for each cut of the route, whether it has to stay out of the kept material.
    """
    outlines, _ = of_contours([c for c in material.outlines if c.closed])
    s = route.segments
    reach = _reach(material.offset_um)
    i, j = near_pairs(boxes(s, reach), boxes(outlines))
    use = judged[route.cut[i]]
    i, j = i[use], j[use]
    first = np.searchsorted(i, np.arange(len(s) + 1))
    least = np.full(len(s), reach)
    if len(i):
        held = np.flatnonzero(np.diff(first) > 0)
        d = segment_distance(s.take(i), outlines.take(j))
        least[held] = np.minimum(np.minimum.reduceat(d, first[held]), reach)
    here = material.offset_um - least
    here[~judged[route.cut]] = -np.inf
    sides = np.full((2, len(s)), np.nan)
    return Kept(outlines, material.offset_um, material.side is Side.PART, here, sides, first, j, s)


def wrong_side(
    kept: Kept, route: Route, judged: np.ndarray
) -> list[tuple[int, float, float, float]]:
    """Return (cut, x, y, um) of routes that run inside the kept material, one place a cut.

    A route that keeps away from every outline never changes sides, so one point of it tells; of
    others the start and middle of all their segments are tried. ``um`` is the depth of the wire.
    """
    s = route.segments
    clear = kept.here < kept.offset - WIDTH
    cuts = np.arange(len(route.closed))
    all_clear = np.bincount(route.cut[~clear], minlength=len(cuts)) == 0
    # One point of each cut: the middle of its first segment of the wire path.
    one = np.searchsorted(route.at, route.path_low, "right") - 1
    rows = np.concatenate([one[judged], np.flatnonzero(~all_clear[route.cut] & judged[route.cut])])
    if not len(rows):
        return []
    rows = np.flatnonzero(np.bincount(rows))
    held = s.take(rows)
    x, y = points_at(held, held.length / 2.0)
    x, y = np.concatenate([x, held.ax]), np.concatenate([y, held.ay])
    cut = np.concatenate([route.cut[rows]] * 2)
    at = np.concatenate([route.at[rows] + held.length / 2.0, route.at[rows]])
    bad = np.flatnonzero(kept.keeps(x, y))
    places = []
    for c in np.flatnonzero(np.bincount(cut[bad])):
        mine = bad[cut[bad] == c]
        # On the outline parity says nothing; deepest first, then first along the route.
        span = 4.0 * kept.offset + 4.0 * WIDTH
        d, _ = nearest(kept.outlines, x[mine], y[mine], span)
        d = np.minimum(d, span)
        k = mine[np.lexsort((at[mine], -d))[0]]
        if d.max() > 1e-3:
            places.append((int(c), float(x[k]), float(y[k]), float(d.max()) + kept.offset))
    return places


class Coverage(NamedTuple):
    """Which outlines the wire reaches.

    Attributes:
        uncut_um: the farthest that a point of an outline which no wire of this radius can reach
            stays from being cut (inner corners), um; 0 when all is cut.
        uncut_at: (x, y) of that point, um.
        missing: (outline, share, x, y, um): 0-based outline, the share of its segments that could
            be reached and are not, the first such place, and how far the wire stays from it beyond
            the offset (inf: nothing near).
    """

    uncut_um: float
    uncut_at: tuple[float, float]
    missing: tuple[tuple[int, float, float, float, float], ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Outlines:
    """Closed outlines, and the wire paths beside them.

    Attributes:
        contours: which outlines of the material are closed, 0-based.
        outlines: their segments.
        owner: for each segment, the entry of ``contours``.
        wanted: whether the wire is to reach the segment.
        sign: +1 where scrap is to the left of the segment, -1 to its right.
        path: wire paths and overcuts of the route.
        near, beside: pairs of a segment of ``path`` and a row of ``outlines`` that lie beside each
            other, by the second.
        some: rows of ``outlines`` with a path beside them.
        first: where the pairs of each of these begin.
        offset: radius of the wire with its gap.
        tolerance: how far from its place beside the outline the wire may be.
    """

    contours: list[int]
    outlines: Segments
    owner: Ints
    wanted: Bools
    sign: Floats
    path: Segments
    near: Segments
    beside: Ints
    some: Ints
    first: Ints
    offset: float
    tolerance: float

    @property
    def span(self) -> float:
        """How far the nearest wire path is looked for where none lies beside."""
        return 20.0 * self.offset + 100.0

    def least(self, x: Floats, y: Floats) -> Floats:
        """Return how far points, one a segment of the outlines, are from the paths beside it."""
        out = np.full(len(self.outlines), np.inf)
        if len(self.near):
            d = point_distance(self.near, x[self.beside], y[self.beside])
            out[self.some] = np.minimum.reduceat(d, self.first)
        return out


class _Missed(NamedTuple):
    """Places of outlines that could be reached and are not: segment, place, and how far along."""

    segment: Ints
    x: Floats
    y: Floats
    t: Floats


def coverage(material: Material, route: Route, tolerance: float = 2.0) -> Coverage:
    """Return what of the closed outlines the route leaves.

    A point of an outline is cut where the wire's centre, set beside it at right angles on the
    scrap side, is within ``tolerance`` of the route. Where it is not although no outline would be
    nearer to the wire than the offset, a piece is missing; where an outline would be, no wire of
    this radius gets there. Each segment is tried at five points, and at its start for the figure.
    """
    a = _outlines(material, route, tolerance)
    if not len(a.outlines):  # no closed one, or one of segments without a length
        return Coverage(0.0, (0.0, 0.0), ())
    corner_far = _corner_distance(a)
    missed: list[_Missed] = []
    uncut, uncut_at = 0.0, (0.0, 0.0)
    for fraction in FRACTIONS.tolist():
        left, far, at = _left_at(a, fraction)
        if left is not None:
            missed.append(left)
        if far > uncut:
            uncut, uncut_at = far, at
    not_cut = np.zeros(len(a.outlines), bool)
    for one in missed:
        not_cut[one.segment] = True
    corner = corner_far - a.offset
    corner[not_cut | ~a.wanted | ~np.isfinite(corner_far)] = -np.inf
    k = int(np.argmax(corner))
    if corner[k] > max(uncut, 1e-3):
        uncut, uncut_at = float(corner[k]), (float(a.outlines.ax[k]), float(a.outlines.ay[k]))
    return Coverage(uncut, uncut_at, _missing(a, missed) if missed else ())


def _outlines(material: Material, route: Route, tolerance: float) -> _Outlines:
    """Return the closed outlines of a material with the wire paths beside them."""
    closed = [k for k, c in enumerate(material.outlines) if c.closed]
    outlines, owner = of_contours([material.outlines[k] for k in closed])
    offset = material.offset_um
    path = route.segments.take(
        np.flatnonzero((route.role == Role.CONTOUR) | (route.role == Role.OVERCUT))
    )
    # Left of a counter-clockwise outline is its inside. Scrap is outside of what is kept.
    twice = outlines.ax * outlines.by - outlines.bx * outlines.ay
    chord_caps = (
        outlines.turn * outlines.radius**2 * (2.0 * outlines.half - np.sin(2.0 * outlines.half))
    )
    area = np.bincount(owner, twice + chord_caps, minlength=len(closed))
    even = np.array([material.depths[k] % 2 == 0 for k in closed], bool)
    to_left = (area > 0) != (even == (material.side is Side.PART))
    near, beside = near_pairs(boxes(path, offset + 2.0 * tolerance + 1.0), boxes(outlines))
    order = np.lexsort((near, beside))
    near, beside = near[order], beside[order]
    first = np.searchsorted(beside, np.arange(len(outlines) + 1))
    some = np.flatnonzero(np.diff(first) > 0)
    return _Outlines(
        contours=closed,
        outlines=outlines,
        owner=owner,
        wanted=np.isin(np.array(closed, np.int64), np.array(material.reached, np.int64))[owner],
        sign=np.where(to_left, 1.0, -1.0)[owner],
        path=path,
        near=path.take(near),
        beside=beside,
        some=some,
        first=first[some],
        offset=offset,
        tolerance=tolerance,
    )


def _corner_distance(a: _Outlines) -> Floats:
    """Return how far the start of each segment is from the wire paths.

    An inner corner stays farthest from the wire there.
    """
    distance = a.least(a.outlines.ax, a.outlines.ay)
    far = np.flatnonzero(distance > a.offset + a.tolerance)
    if len(far):
        distance[far], _ = nearest(a.path, a.outlines.ax[far], a.outlines.ay[far], a.span)
        distance[far] = np.minimum(distance[far], a.span)
    return distance


def _left_at(a: _Outlines, fraction: float) -> tuple[_Missed | None, float, tuple[float, float]]:
    """Return what the route leaves of the points at a fraction of each segment.

    Returns:
        The points that could be reached and are not, None where there is none; and how
        far the point stays from being cut which no wire of this radius reaches, and where it is;
        0 where all are cut.
    """
    t = a.outlines.length * fraction
    x, y = points_at(a.outlines, t)
    nx, ny = normals_at(a.outlines, t)
    wx, wy = x + nx * a.sign * a.offset, y + ny * a.sign * a.offset
    off = np.flatnonzero(a.wanted & (a.least(wx, wy) > a.tolerance))
    if not len(off):
        return None, 0.0, (0.0, 0.0)
    room, _ = nearest(a.outlines, wx[off], wy[off], a.offset + 1.0)
    free = room >= a.offset - 0.05
    missed = _Missed(off[free], x[off[free]], y[off[free]], t[off[free]])
    blocked = off[~free]
    if not len(blocked):
        return missed, 0.0, (0.0, 0.0)
    d, _ = nearest(a.path, x[blocked], y[blocked], a.span)
    d = np.where(np.isfinite(d), d - a.offset, -np.inf)
    k = int(np.argmax(d))
    return missed, float(d[k]), (float(x[blocked[k]]), float(y[blocked[k]]))


def _missing(
    a: _Outlines, missed: list[_Missed]
) -> tuple[tuple[int, float, float, float, float], ...]:
    """Return what `Coverage.missing` holds of the places that are missed."""
    segment, x, y, t = (np.concatenate(column) for column in zip(*missed, strict=True))
    missing = []
    for c in np.flatnonzero(np.bincount(a.owner[segment])).tolist():
        mine = np.flatnonzero(a.owner[segment] == c)
        mine = mine[np.lexsort((t[mine], segment[mine]))]
        d, _ = nearest(a.path, x[mine[:1]], y[mine[:1]], a.span)
        share = np.count_nonzero(np.bincount(segment[mine])) / int((a.owner == c).sum())
        here = mine[0]
        beyond = float(d[0]) - a.offset
        missing.append((a.contours[c], share, float(x[here]), float(y[here]), beyond))
    return tuple(missing)

"""What is to be kept, and whether the wire stays out of it and reaches all of its outline.

Kept is decided from the outlines alone, never from the wire path: a point is inside the part where
an odd number of closed outlines encloses it; ``part`` keeps that, ``die`` keeps all the rest, the
infinite outside included. A wrong side, a wrong sense, a mirrored arc and a diameter taken for a
radius all show here, even if the plan itself is wrong.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wedmcam.ir.plan import Material, Side
from wedmcam.ir.program import Role
from wedmcam.judge.route import Route, of_contours
from wedmcam.judge.segments import (
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

#: Fractions of a segment at which it is asked whether the wire reaches it.
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
            it is towards them. NaN where nobody has asked yet.
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

    def _ask(self, segment: Ints) -> None:
        """Fill ``sides`` of segments of the route."""
        asked = np.flatnonzero(np.bincount(segment, minlength=len(self.here)))
        asked = asked[np.isnan(self.sides[0, asked])]
        if not len(asked):
            return
        count = self.first[asked + 1] - self.first[asked]
        head = np.cumsum(count) - count
        pair = np.arange(count.sum()) + np.repeat(self.first[asked] - head, count)
        rows = np.repeat(asked, count)
        least = np.full((2, len(asked)), np.inf)
        if len(pair):
            # Both sides in one call: calls cost as much as pairs.
            both = shifted(self.route.take(np.tile(rows, 2)), np.repeat([WIDTH, -WIDTH], len(rows)))
            d = segment_distance(both, self.outlines.take(np.tile(self.near[pair], 2)))
            held = count > 0
            for side in (0, 1):
                part = d[side * len(rows) : (side + 1) * len(rows)]
                least[side, held] = np.minimum.reduceat(part, head[held])
        self.sides[:, asked] = self.offset + WIDTH - np.minimum(least, _reach(self.offset))

    def bound_piece(self, segment: Ints, low: Floats, high: Floats) -> Floats:
        """Return how deep places may be that lie from ``low`` (right) to ``high`` (left), um."""
        here = self.here[segment]
        left, right = np.maximum(high, 0.0), np.maximum(-low, 0.0)
        grow = here + np.maximum(left, right)
        deep = np.flatnonzero(grow > SHALLOW)
        if not len(deep):
            return grow
        self._ask(segment[deep])
        out = np.full(len(deep), -np.inf)
        for away, side in ((left[deep], self.sides[0]), (right[deep], self.sides[1])):
            most = here[deep] + away
            top = (here[deep] + side[segment[deep]]) / 2.0
            out = np.maximum(out, np.where(away <= WIDTH, np.minimum(most, top), most))
        grow[deep] = np.where(np.isneginf(here[deep]), -np.inf, out)
        return grow

    def bound(self, segment: Ints, v: Floats) -> Floats:
        """Return how deep places may be that lie ``v`` to the left of their segment, um."""
        self._ask(segment)
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
    found = []
    for c in np.flatnonzero(np.bincount(cut[bad])):
        mine = bad[cut[bad] == c]
        # On the outline parity says nothing; deepest first, then first along the route.
        span = 4.0 * kept.offset + 4.0 * WIDTH
        d, _ = nearest(kept.outlines, x[mine], y[mine], span)
        d = np.minimum(d, span)
        k = mine[np.lexsort((at[mine], -d))[0]]
        if d.max() > 1e-3:
            found.append((int(c), float(x[k]), float(y[k]), float(d.max()) + kept.offset))
    return found


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


def coverage(material: Material, route: Route, tolerance: float = 2.0) -> Coverage:
    """Return what of the closed outlines the route leaves.

    A point of an outline is cut where the wire's centre, set beside it at right angles on the
    scrap side, is within ``tolerance`` of the route. Where it is not although no outline would be
    nearer to the wire than the offset, a piece is missing; where an outline would be, no wire of
    this radius gets there. Each segment is asked at five points, and at its start for the figure.
    """
    contours = [c for c in material.outlines if c.closed]
    depths = [d for c, d in zip(material.outlines, material.depths, strict=True) if c.closed]
    which_outline = [k for k, c in enumerate(material.outlines) if c.closed]
    outlines, owner = of_contours(contours)
    if not len(outlines):
        return Coverage(0.0, (0.0, 0.0), ())
    path_rows = np.flatnonzero((route.role == Role.CONTOUR) | (route.role == Role.OVERCUT))
    path = route.segments.take(path_rows)
    offset = material.offset_um
    # Left of a counter-clockwise outline is its inside. Scrap is outside of what is kept.
    twice = outlines.ax * outlines.by - outlines.bx * outlines.ay
    chord_caps = (
        outlines.turn * outlines.radius**2 * (2.0 * outlines.half - np.sin(2.0 * outlines.half))
    )
    area = np.bincount(owner, twice + chord_caps, minlength=len(contours))
    even = np.array([d % 2 == 0 for d in depths])
    to_left = (area > 0) != (even == (material.side is Side.PART))
    sign = np.where(to_left, 1.0, -1.0)[owner]
    wanted = np.isin(np.array(which_outline), np.array(material.reached, np.int64))[owner]

    reach = offset + 2.0 * tolerance + 1.0
    k, j = near_pairs(boxes(path, reach), boxes(outlines))
    order = np.lexsort((k, j))
    j, k = j[order], k[order]
    first = np.searchsorted(j, np.arange(len(outlines) + 1))
    held = np.flatnonzero(np.diff(first) > 0)
    theirs = path.take(k)

    def least(x: Floats, y: Floats) -> Floats:
        out = np.full(len(outlines), np.inf)
        if len(k):
            out[held] = np.minimum.reduceat(point_distance(theirs, x[j], y[j]), first[held])
        return out

    # At the start of each segment: an inner corner stays farthest from the wire there.
    start_far = least(outlines.ax, outlines.ay)
    far = np.flatnonzero(start_far > offset + tolerance)
    if len(far):
        span = 20.0 * offset + 100.0
        start_far[far], _ = nearest(path, outlines.ax[far], outlines.ay[far], span)
        start_far[far] = np.minimum(start_far[far], span)
    missed: list[tuple[Ints, Floats, Floats, Floats]] = []
    asked = np.zeros(len(outlines), np.int64)
    uncut, uncut_at = 0.0, (0.0, 0.0)
    for fraction in FRACTIONS.tolist():
        t = outlines.length * fraction
        x, y = points_at(outlines, t)
        nx, ny = normals_at(outlines, t)
        wx, wy = x + nx * sign * offset, y + ny * sign * offset
        off = np.flatnonzero(wanted & (least(wx, wy) > tolerance))
        if not len(off):
            continue
        room, _ = nearest(outlines, wx[off], wy[off], offset + 1.0)
        free = room >= offset - 0.05
        missed.append((off[free], x[off[free]], y[off[free]], t[off[free]]))
        asked[off[free]] += 1
        blocked = off[~free]
        if len(blocked):
            d, _ = nearest(path, x[blocked], y[blocked], 20.0 * offset + 100.0)
            d = np.where(np.isfinite(d), d - offset, -np.inf)
            b = int(np.argmax(d))
            if d[b] > uncut:
                uncut, uncut_at = float(d[b]), (float(x[blocked[b]]), float(y[blocked[b]]))
    missing = []
    if missed:
        segment = np.concatenate([m[0] for m in missed])
        x, y, t = (np.concatenate([m[n] for m in missed]) for n in (1, 2, 3))
        for c in np.flatnonzero(np.bincount(owner[segment])):
            mine = np.flatnonzero(owner[segment] == c)
            mine = mine[np.lexsort((t[mine], segment[mine]))]
            d, _ = nearest(path, x[mine[:1]], y[mine[:1]], 20.0 * offset + 100.0)
            share = np.count_nonzero(np.bincount(segment[mine])) / int((owner == c).sum())
            here = mine[0]
            more = float(d[0]) - offset
            missing.append((which_outline[c], share, float(x[here]), float(y[here]), more))
    skip = np.isin(np.arange(len(outlines)), np.flatnonzero(asked))
    corner = np.where(skip | ~wanted | ~np.isfinite(start_far), -np.inf, start_far - offset)
    b = int(np.argmax(corner))
    if corner[b] > max(uncut, 1e-3):
        uncut, uncut_at = float(corner[b]), (float(outlines.ax[b]), float(outlines.ay[b]))
    return Coverage(uncut, uncut_at, tuple(missing))

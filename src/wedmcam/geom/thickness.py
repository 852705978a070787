"""How thick the material between two stretches of contour is, where it is thinnest.

Between two walls the distance has a *least* somewhere: a neck, the middle of a fin, the place where
two holes come nearest. At a tip it has none: it falls until the walls meet, or to the chamfer or
fillet that cuts the tip off. So a place counts where, from both of its ends, no way along the
contour leads nearer to the other one. That is a matter of directions: it holds for every way in
which a contour is cut into segments.

Walls of a fin need not be parallel to the last digit: within `PARALLEL` they are taken as such, if
they do not meet ahead.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import pairs
from wedmcam.geom.gaps import gaps
from wedmcam.geom.segments import (
    Floats,
    Ints,
    Segments,
    boxes,
    end_tangents,
    make,
    points_at,
    position_of,
    start_tangents,
    tangents_at,
)

Bools = NDArray[np.bool_]

#: Arcs are looked at in pieces of at most this, radians: two of them have one least distance.
PIECE = 0.5 * np.pi
#: Walls of one contour whose directions differ by less are parallel (sine; half a degree).
PARALLEL = 0.0087
#: Between two contours a least distance is exact: nothing is cut off there (sine).
EXACT = 1e-5
#: The way round from one side of a wall to the other is this many times its thickness at least:
#: what is shorter than it is thick is a step.
AROUND = 3.0
#: Nearer to its end than this, um, a place on a segment is the vertex.
AT_END_UM = 1e-3


class Walls(NamedTuple):
    """Places where the distance of two stretches is least; one entry each.

    Attributes:
        i, j: the segments, i < j.
        size: their distance there, um.
        x, y: the middle between the two sides, um.
    """

    i: Ints
    j: Ints
    size: Floats
    x: Floats
    y: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Segments of closed contours, long arcs cut into pieces.

    Attributes:
        s: pieces, in the order of travel.
        of: the segment of each.
        first: the first piece of each segment.
        before, after: the neighbours of each piece in its contour.
        start: where each begins, um along its contour.
        around: length of its contour, um.
        owner: its contour.
    """

    s: Segments
    of: Ints
    first: Ints
    before: Ints
    after: Ints
    start: Floats
    around: Floats
    owner: Ints


def walls(s: Segments, owner: Ints, below_um: float) -> Walls:
    """Return the places at which two stretches of closed contours are less than ``below_um`` apart.

    Args:
        s: segments of all contours, contour by contour in the order of travel.
        owner: of each; equal numbers stand together.
        below_um: > 0. Contours that touch there are no wall.

    What lies between, material or scrap, is not looked at.
    """
    i, j = pairs.self_overlapping(pairs.grow(boxes(s), 0.5 * below_um))
    near = _may_be_near(s, i, j, below_um)
    i, j = i[near], j[near]
    p = _pieces(s, owner)
    i, j = _pairs_of_pieces(p, i, j, below_um)
    if not len(i):
        none = np.empty(0, np.int64)
        return Walls(none, none, np.empty(0), np.empty(0), np.empty(0))
    a, b = p.s.take(i), p.s.take(j)
    g = gaps(a, b)
    least = g.size < below_um
    at_a = np.clip(position_of(a, g.x, g.y), 0.0, a.length)
    at_b = np.clip(position_of(b, g.x, g.y), 0.0, b.length)
    beside, along = _beside(a, b)
    at_c = np.clip(position_of(b, *points_at(a, beside)), 0.0, b.length)
    k = np.concatenate([np.flatnonzero(least), np.flatnonzero(along > AT_END_UM)])
    n = int(least.sum())
    i, j = i[k], j[k]
    at_i = np.concatenate([at_a[k[:n]], beside[k[n:]]])
    at_j = np.concatenate([at_b[k[:n]], at_c[k[n:]]])
    shared = np.maximum(along[k], 0.0)
    nearest = _least(p, i, j, at_i, at_j, shared, below_um)
    k = nearest.k
    return Walls(p.of[i[k]], p.of[j[k]], nearest.size, nearest.x, nearest.y)


def _may_be_near(s: Segments, i: Ints, j: Ints, below: float) -> Bools:
    """Return which pairs may be that near, by what takes no time: circles and lines, not ends."""
    near = np.ones(len(i), np.bool_)
    arc_i, arc_j = s.turn[i] != 0, s.turn[j] != 0
    both = np.flatnonzero(arc_i & arc_j)
    a, b = i[both], j[both]
    apart = np.hypot(s.cx[a] - s.cx[b], s.cy[a] - s.cy[b])
    r, q = s.radius[a], s.radius[b]
    near[both] = np.maximum(apart - r - q, np.abs(r - q) - apart) < below
    for line, other, mask in ((i, j, ~arc_i), (j, i, ~arc_j)):
        rows = np.flatnonzero(mask)
        a, b = line[rows], other[rows]
        off = [
            (y[b] - s.y0[a]) * s.ux[a] - (x[b] - s.x0[a]) * s.uy[a]
            for x, y in ((s.x0, s.y0), (s.x1, s.y1), (s.cx, s.cy))
        ]
        arc = s.turn[b] != 0
        low = np.where(arc, off[2] - s.radius[b], np.minimum(off[0], off[1]))
        high = np.where(arc, off[2] + s.radius[b], np.maximum(off[0], off[1]))
        near[rows] &= (low < below) & (high > -below)
    return near


def _pieces(s: Segments, owner: Ints) -> _Pieces:
    """Return the segments with long arcs cut into pieces."""
    count = np.maximum(1, np.ceil(s.sweep / PIECE - 1e-9)).astype(np.int64)
    first = np.cumsum(count) - count
    of = np.repeat(np.arange(len(s)), count)
    own = owner[of]
    if int(count.max(initial=1)) > 1:
        k = np.arange(len(of)) - first[of]
        share0, share1 = k / count[of], (k + 1) / count[of]
        whole = s.take(of)
        x0, y0 = points_at(whole, share0 * whole.length)
        x1, y1 = points_at(whole, share1 * whole.length)
        begins, ends = k == 0, k == count[of] - 1
        s = make(
            np.where(begins, whole.x0, x0),
            np.where(begins, whole.y0, y0),
            np.where(ends, whole.x1, x1),
            np.where(ends, whole.y1, y1),
            whole.cx,
            whole.cy,
            whole.turn,
            whole.radius,
            whole.sweep / count[of],
        )
    n = len(of)
    head = np.flatnonzero(np.diff(own, prepend=-1))
    tail = np.append(head[1:], n) - 1
    size = tail - head + 1
    before, after = np.arange(-1, n - 1), np.arange(1, n + 1)
    before[head], after[tail] = tail, head
    total = np.cumsum(s.length)
    begin = total - s.length
    start = begin - np.repeat(begin[head], size)
    around = np.repeat(total[tail] - begin[head], size)
    return _Pieces(s, of, first, before, after, start, around, own)


def _pairs_of_pieces(p: _Pieces, i: Ints, j: Ints, below: float) -> tuple[Ints, Ints]:
    """Return the pairs of pieces of pairs of segments that may bound a wall."""
    count = np.bincount(p.of, minlength=len(p.first))
    each = count[i] * count[j]
    pair = np.repeat(np.arange(len(i)), each)
    k = np.arange(len(pair)) - (np.cumsum(each) - each)[pair]
    many = count[j][pair]
    a, b = p.first[i][pair] + k // many, p.first[j][pair] + k % many
    s = p.s
    # The way round between them is longer than the wall is thick: not so of near neighbours.
    one = p.owner[a] == p.owner[b]
    half_a, half_b = 0.5 * s.length[a], 0.5 * s.length[b]
    middle = np.abs(p.start[b] + half_b - p.start[a] - half_a)
    way = np.minimum(middle, p.around[a] - middle)
    x, y = points_at(s, 0.5 * s.length)
    least = np.maximum(0.0, np.hypot(x[a] - x[b], y[a] - y[b]) - half_a - half_b)
    keep = ~one | (way + half_a + half_b >= AROUND * least)
    keep &= (p.after[a] != b) & (p.before[a] != b)
    keep &= least < below
    a, b = a[keep], b[keep]
    if len(s) > len(p.first):
        box = pairs.grow(boxes(s), 0.5 * below)
        meet = (box[0][a] <= box[2][b]) & (box[0][b] <= box[2][a])
        meet &= (box[1][a] <= box[3][b]) & (box[1][b] <= box[3][a])
        a, b = a[meet], b[meet]
    return a, b


def _beside(a: Segments, b: Segments) -> tuple[Floats, Floats]:
    """Return the middle of the stretch of a[i] that b[i] lies beside, and its length, um."""
    t0, t1 = position_of(a, b.x0, b.y0), position_of(a, b.x1, b.y1)
    low = np.clip(np.minimum(t0, t1), 0.0, a.length)
    high = np.clip(np.maximum(t0, t1), 0.0, a.length)
    return 0.5 * (low + high), high - low


class _Found(NamedTuple):
    k: Ints
    size: Floats
    x: Floats
    y: Floats


def _least(
    p: _Pieces, i: Ints, j: Ints, at_i: Floats, at_j: Floats, shared: Floats, below: float
) -> _Found:
    """Return which places, at_i on piece i and at_j on piece j, are those of a wall.

    Args:
        p: all pieces.
        i, j: of the places.
        at_i, at_j: where on them, um.
        shared: how long the two run beside each other, um.
        below: the least thickness that is none, um.
    """
    s = p.s
    x, y = points_at(s.take(i), at_i)
    u, v = points_at(s.take(j), at_j)
    size = np.hypot(u - x, v - y)
    k = np.flatnonzero((size < below) & (size > 0))
    i, j, at_i, at_j, shared = i[k], j[k], at_i[k], at_j[k], shared[k]
    x, y, u, v, size = x[k], y[k], u[k], v[k], size[k]
    dx, dy = (u - x) / size, (v - y) / size
    ahead_i, back_i = _arms(p, i, at_i, dx, dy)
    ahead_j, back_j = _arms(p, j, at_j, -dx, -dy)
    one = p.owner[i] == p.owner[j]
    bound = np.where(one, PARALLEL, EXACT)
    keep = np.maximum(np.maximum(ahead_i, back_i), np.maximum(ahead_j, back_j)) <= bound
    # The way along the contour from the one place to the other, ahead and back.
    total = p.around[i]
    ahead = np.mod(p.start[j] + at_j - p.start[i] - at_i, total)
    way = np.minimum(ahead, total - ahead) + shared
    keep &= ~one | (way >= AROUND * size)
    # Walls that meet ahead, or would if the tip were not cut off by less than is left of it.
    for nearing, length in ((ahead_i + back_j, ahead), (back_i + ahead_j, total - ahead)):
        meet = size / np.where(nearing > 1e-9, nearing, 1e-9)
        keep &= ~(one & (nearing > 1e-9) & (length >= meet) & (length <= 2.5 * meet + size))
    m = np.flatnonzero(keep)
    return _Found(k[m], size[m], 0.5 * (x + u)[m], 0.5 * (y + v)[m])


def _arms(p: _Pieces, k: Ints, at: Floats, dx: Floats, dy: Floats) -> tuple[Floats, Floats]:
    """Return how fast the ways ahead and back from a place lead into a direction (-1 to 1).

    At a vertex they are those of two segments.
    """
    s = p.s
    tx, ty = tangents_at(s.take(k), at)
    ahead, back = tx * dx + ty * dy, -(tx * dx + ty * dy)
    end = np.flatnonzero(at >= s.length[k] - AT_END_UM)
    tx, ty = start_tangents(s.take(p.after[k[end]]))
    ahead[end] = tx * dx[end] + ty * dy[end]
    start = np.flatnonzero(at <= AT_END_UM)
    tx, ty = end_tangents(s.take(p.before[k[start]]))
    back[start] = -(tx * dx[start] + ty * dy[start])
    return ahead, back

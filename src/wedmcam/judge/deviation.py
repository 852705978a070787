"""The proof: every place of the wire against the exact route, and the route against the places.

For each block its stretch of the route is known (``track``). Cut at the route's vertices, a stretch
is a piece: a run of places beside one line or arc. In a piece

- the signed distance of every place is exact (beside the ends of the piece, to the neighbouring
  segments too), so the greatest deviation of the places from the route is exact;
- the progress of the places never falls back more than `SLOP`, starts within `SLOP` of the piece's
  start, ends within `SLOP` of its end, and stays within `SLOP` of it: so every piece is run once,
  in its sense and in its turn;
- the wire moves in steps of 1 um, so progress is continuous and every point of the piece that it
  passes lies no farther from the path of the wire than the places beside it. The vertices, where it
  may jump, are measured one by one. That is the deviation the other way round, by which a missing
  piece is seen; between a vertex and the foot of the place nearest to it (at most `SLOP` um) it is
  bounded by the two ends of that stretch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from wedmcam.judge.material import Kept
from wedmcam.judge.route import Route
from wedmcam.judge.segments import Bools, Floats, Ints, point_distance
from wedmcam.judge.walk import Walk

#: How far progress may fall back, or a block end miss its vertex along the route, um: a vertex is
#: met within 2 um from either side.
SLOP = 5.0

#: Places worked on at a time: a dozen arrays of this length stay in the cache.
CHUNK = 1 << 15

#: Arcs below this radius are shorter-sighted than the tolerances: angles about their centre mean
#: nothing, um.
TINY = 4.0


class Measured:
    """What was measured, one entry a cutting block that was tracked.

    Attributes:
        low: greatest distance to the right of the route, um, as a number <= 0.
        high: to the left, >= 0.
        gap: greatest distance of a vertex of the route from the wire; 0 where the block has none.
        stray: how far progress fell back, overran or fell short, um; over `SLOP` is no such run.
        extents: x low, y low, x high, y high of all places.
        gouge: how deep the wire enters the kept material, um; -inf where nothing is kept.
        gouge_at: (x, y) of the deepest place.
        gouge_block: position of its block among the blocks tracked.
    """

    __slots__ = ("extents", "gap", "gouge", "gouge_at", "gouge_block", "high", "low", "stray")

    def __init__(self, n: int) -> None:
        self.low, self.high, self.gap, self.stray = (np.zeros(n) for _ in range(4))
        self.extents = np.array([np.inf, np.inf, -np.inf, -np.inf])
        self.gouge, self.gouge_at, self.gouge_block = -np.inf, (0.0, 0.0), -1

    @property
    def deviation(self) -> Floats:
        """Greatest deviation of each block, both ways, um."""
        return np.maximum(np.maximum(-self.low, self.high), self.gap)


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """Places of a chunk parted at the route's vertices; pieces may be empty."""

    segment: Ints
    block: Ints
    count: Ints
    low: Floats
    high: Floats


def measure(
    walk: Walk,
    index: Ints,
    low: Floats,
    high: Floats,
    route: Route,
    kept: Kept | None,
    before: Floats | None = None,
) -> Measured:
    """Measure blocks ``index`` of the walk on their stretches of progress from low to high.

    Every block of ``index`` makes at least one step. Blocks may be left out; ``before`` then says
    which progress may have been reached before each block, -inf where none was left out.
    """
    out = Measured(len(index))
    reached = -np.inf
    for rows in chunks(np.maximum(walk.steps[index], 1)):
        x, y, steps = walk.points(index[rows])
        pieces, vertex, place = _part(walk, index[rows], x, y, steps, low[rows], high[rows], route)
        v, t, exact = _foot(x, y, pieces, route)
        first = np.cumsum(steps) - steps
        ends = first + steps - 1
        _near_ends(x, y, v, t, exact, pieces, route)
        out.low[rows] = np.minimum(np.minimum.reduceat(v, first), 0.0)
        out.high[rows] = np.maximum(np.maximum.reduceat(v, first), 0.0)
        floor = None if before is None else before[rows]
        out.stray[rows], reached = _stray(t, reached, first, pieces, floor)
        _gaps(out.gap[rows], x, y, vertex, place, ends, high[rows], route, pieces)
        e = out.extents
        e[:] = min(e[0], x.min()), min(e[1], y.min()), max(e[2], x.max()), max(e[3], y.max())
        if kept is not None:
            gouge_of(out, kept, x, y, v, pieces, rows.start)
    return out


def chunks(steps: Ints) -> Iterator[slice]:
    """Yield slices of blocks of about `CHUNK` places; at least one block each."""
    total = np.cumsum(steps)
    low = 0
    while low < len(steps):
        done = int(total[low - 1]) if low else 0
        high = max(low + 1, int(np.searchsorted(total, done + CHUNK, "right")))
        yield slice(low, high)
        low = high


def _part(
    walk: Walk,
    index: Ints,
    x: Floats,
    y: Floats,
    steps: Ints,
    low: Floats,
    high: Floats,
    route: Route,
) -> tuple[Pieces, Ints, Ints]:
    """Part blocks at vertices; also return inner vertices (ending a segment) and their places."""
    s0 = np.searchsorted(route.at, low, "right") - 1
    s1 = np.maximum(np.searchsorted(route.at, high, "left") - 1, s0)
    none = np.zeros(0, np.int64)
    blocks = np.arange(len(index))
    if (s0 == s1).all():
        return Pieces(s0, blocks, steps, low, high), none, none
    n = s1 - s0 + 1
    block = np.repeat(blocks, n)
    head = np.cumsum(n) - n
    segment = np.arange(n.sum()) - np.repeat(head - s0, n)
    piece_low = np.maximum(route.at[segment], low[block])
    piece_high = np.minimum(route.to[segment], high[block])
    count = np.repeat(steps, n)
    vertices: list[Ints] = []
    places: list[Ints] = []
    first = np.cumsum(steps) - steps
    for b in np.flatnonzero(n > 1):
        inner = np.arange(s0[b], s1[b])
        rows = slice(int(first[b]), int(first[b] + steps[b]))
        at = _pass(
            walk, int(index[b]), x[rows], y[rows], inner, route, float(low[b]), float(high[b])
        )
        count[head[b] : head[b] + n[b]] = np.diff(np.concatenate([[0], at, [steps[b]]]))
        vertices.append(inner)
        places.append(np.clip(first[b] + at - 1, 0, len(x) - 1))
    return (
        Pieces(segment, block, count, piece_low, piece_high),
        np.concatenate(vertices),
        np.concatenate(places),
    )


def _pass(
    walk: Walk,
    block: int,
    x: Floats,
    y: Floats,
    inner: Ints,
    route: Route,
    low: float,
    high: float,
) -> Ints:
    """Return after how many steps the block has passed the ends of the segments ``inner``."""
    vx, vy = route.segments.bx[inner], route.segments.by[inner]
    b, start = walk.blocks[block], walk.start[block]
    if b["turn"] == 0:
        dx, dy = float(x[-1] - start[0]), float(y[-1] - start[1])
        own = (x - start[0]) * dx + (y - start[1]) * dy
        theirs = (vx - start[0]) * dx + (vy - start[1]) * dy
    else:
        cx, cy = float(start[0] - b["x"]), float(start[1] - b["y"])
        a0 = np.arctan2(float(b["y"]), float(b["x"]))
        angle = np.concatenate([[a0], np.arctan2(y - cy, x - cx)])
        own = (np.unwrap(angle)[1:] - a0) * b["turn"]
        theirs = np.mod((np.arctan2(vy - cy, vx - cx) - a0) * b["turn"], 2.0 * np.pi)
        # Which turn, where the block is about as long as one: by the share of its stretch run.
        meant = (route.to[inner] - low) / max(high - low, 1e-9) * own[-1]
        theirs += 2.0 * np.pi * np.round((meant - theirs) / (2.0 * np.pi))
    own = np.maximum.accumulate(own)
    at = np.searchsorted(own, np.maximum.accumulate(theirs), "right")
    return np.asarray(np.clip(at, 0, len(x)))


def _foot(x: Floats, y: Floats, p: Pieces, route: Route) -> tuple[Floats, Floats, Bools]:
    """Return signed distance (left > 0) to the carrier, progress, and pieces to do exactly."""
    s = route.segments.take(p.segment)
    arc = s.turn != 0
    exact = arc & (s.radius < TINY)
    at = route.at[p.segment]
    if not arc.any():
        v, t = _lines(x, y, s.mx, s.my, s.ax, s.ay, at, p.count)
        return v, t, exact
    if arc.all():
        v, t = _arcs(x, y, s, at, p)
        return v, t, exact
    v, t = np.empty(len(x)), np.empty(len(x))
    on_arc = np.repeat(arc, p.count)
    rows = np.flatnonzero(~on_arc)
    line = ~arc
    v[rows], t[rows] = _lines(
        x[rows], y[rows], s.mx[line], s.my[line], s.ax[line], s.ay[line], at[line], p.count[line]
    )
    rows = np.flatnonzero(on_arc)
    part = Pieces(p.segment[arc], p.block[arc], p.count[arc], p.low[arc], p.high[arc])
    v[rows], t[rows] = _arcs(x[rows], y[rows], s.take(arc), at[arc], part)
    return v, t, exact


def _lines(
    x: Floats,
    y: Floats,
    mx: Floats,
    my: Floats,
    ax: Floats,
    ay: Floats,
    at: Floats,
    count: Ints,
) -> tuple[Floats, Floats]:
    """Return signed distance and progress beside lines."""
    qx = x - np.repeat(ax, count)
    qy = y - np.repeat(ay, count)
    ux, uy = np.repeat(mx, count), np.repeat(my, count)
    v = ux * qy
    v -= uy * qx
    qx *= ux
    qy *= uy
    qx += qy
    qx += np.repeat(at, count)
    return v, qx


def _arcs(x: Floats, y: Floats, s, at: Floats, p: Pieces) -> tuple[Floats, Floats]:  # type: ignore[no-untyped-def]
    """Return signed distance and progress beside arcs, unwound where an arc is over 230 degrees."""
    qx = x - np.repeat(s.cx, p.count)
    qy = y - np.repeat(s.cy, p.count)
    ux, uy = np.repeat(s.mx, p.count), np.repeat(s.my, p.count)
    angle = np.arctan2(ux * qy - uy * qx, ux * qx + uy * qy)
    qx *= qx
    qy *= qy
    qx += qy
    v = np.repeat(s.radius, p.count)
    v -= np.sqrt(qx)
    v *= np.repeat(s.turn, p.count)
    wide = (s.half > 2.0) & (p.count > 0)
    if wide.any():
        first = np.cumsum(p.count) - p.count
        jump = np.diff(angle)
        wraps = np.concatenate([[0.0], np.cumsum((jump < -np.pi) * 1.0 - (jump > np.pi) * 1.0)])
        head = first[wide]
        meant = ((p.low[wide] - at[wide]) / s.radius[wide] - s.half[wide]) * s.turn[wide]
        offset = np.zeros(len(p.count))
        offset[wide] = np.round((meant - angle[head]) / (2.0 * np.pi)) - wraps[head]
        turns = wraps + np.repeat(offset, p.count)
        turns *= np.repeat(wide, p.count)
        angle += 2.0 * np.pi * turns
    angle *= np.repeat(s.turn * s.radius, p.count)
    angle += np.repeat(s.half * s.radius + at, p.count)
    return v, angle


def _near_ends(
    x: Floats, y: Floats, v: Floats, t: Floats, exact: Bools, p: Pieces, route: Route
) -> None:
    """Correct ``v`` where places lie beside the ends of their piece; tiny arcs throughout."""
    low, high = np.repeat(p.low, p.count), np.repeat(p.high, p.count)
    beyond = (t < low) | (t > high)
    if exact.any():
        tiny = np.repeat(exact, p.count)
        beyond |= tiny
        np.clip(t, low, high, out=t, where=tiny)
    rows = np.flatnonzero(beyond)
    if not len(rows):
        return
    segment = np.repeat(p.segment, p.count)[rows]
    cut = route.cut[segment]
    best = np.full(len(rows), np.inf)
    for step in (-2, -1, 0, 1, 2):
        near = np.clip(segment + step, route.first[cut], route.first[cut + 1] - 1)
        d = point_distance(route.segments.take(near), x[rows], y[rows])
        best = np.minimum(best, d)
    v[rows] = np.where(v[rows] < 0, -best, best)


def _stray(
    t: Floats, reached: float, first: Ints, p: Pieces, before: Floats | None
) -> tuple[Floats, float]:
    """Return how far each block strays from a run through its pieces, and the progress reached."""
    if before is None:
        run = np.maximum.accumulate(t)
    else:
        run = t.copy()
        run[first] = np.maximum(run[first], before)
        np.maximum.accumulate(run, out=run)
    if reached > run[0]:
        run = np.maximum(run, reached)
    out = np.maximum.reduceat(run - t, first)
    some = np.flatnonzero(p.count > 0)
    head = np.cumsum(p.count)[some] - p.count[some]
    tail = head + p.count[some] - 1
    piece = np.maximum(np.maximum.reduceat(t, head) - p.high[some], t[head] - p.low[some] - 1.0)
    piece = np.maximum(piece, p.high[some] - t[tail])
    piece = np.maximum(piece, p.low[some] - np.minimum.reduceat(t, head))
    np.maximum.at(out, p.block[some], piece)
    empty = np.flatnonzero(p.count == 0)
    if len(empty):
        np.maximum.at(out, p.block[empty], p.high[empty] - p.low[empty])
    return out, float(run[-1])


def _gaps(
    gap: Floats,
    x: Floats,
    y: Floats,
    vertex: Ints,
    place: Ints,
    ends: Ints,
    high: Floats,
    route: Route,
    p: Pieces,
) -> None:
    """Fill ``gap``: vertices at block ends, and vertices that a block passes."""
    last = np.flatnonzero(np.diff(p.block, append=-1))
    segment = p.segment[last]
    on = np.flatnonzero(route.to[segment] == high)
    owners = np.concatenate([on, p.block[np.flatnonzero(np.diff(p.block) == 0)]])
    vertex = np.concatenate([segment[on], vertex])
    place = np.concatenate([ends[on], place])
    near = np.clip(place[:, None] + np.arange(-4, 5), 0, len(x) - 1)
    dx = x[near] - route.segments.bx[vertex][:, None]
    dy = y[near] - route.segments.by[vertex][:, None]
    np.maximum.at(gap, owners, np.sqrt((dx * dx + dy * dy).min(axis=1)))


def gouge_of(
    out: Measured, kept: Kept, x: Floats, y: Floats, v: Floats, p: Pieces, base: int
) -> None:
    """Find the deepest place, trying exactly only those that may be deeper than the best known."""
    some = np.flatnonzero(p.count > 0)
    head = np.cumsum(p.count)[some] - p.count[some]
    most = np.maximum.reduceat(v, head)
    least = np.minimum.reduceat(v, head)
    bound = kept.bound_piece(p.segment[some], least, most)
    if not (bound > out.gouge).any():
        return
    # The most promising piece first: after it few others are left.
    held = some[np.argsort(-bound, kind="stable")]
    start = np.cumsum(p.count) - p.count
    by_piece = np.empty(len(p.count))
    by_piece[some] = bound
    _try_places(out, kept, x, y, v, p, base, start, held[:1])
    held = held[1:][by_piece[held[1:]] > out.gouge]
    if len(held):
        _try_places(out, kept, x, y, v, p, base, start, held)


def _try_places(
    out: Measured,
    kept: Kept,
    x: Floats,
    y: Floats,
    v: Floats,
    p: Pieces,
    base: int,
    start: Ints,
    held: Ints,
) -> None:
    """Try the places of the pieces ``held``, the most promising first."""
    n = p.count[held]
    rows = np.arange(n.sum()) + np.repeat(start[held] - (np.cumsum(n) - n), n)
    segment, block = np.repeat(p.segment[held], n), np.repeat(p.block[held], n)
    bound = kept.bound(segment, v[rows])
    take = 16
    while True:
        some = np.flatnonzero(bound > out.gouge)
        if not len(some):
            return
        if len(some) > take:
            some = some[np.argpartition(-bound[some], take)[:take]]
        depth = kept.depth(segment[some], x[rows[some]], y[rows[some]])
        k = int(np.argmax(depth))
        if depth[k] > out.gouge:
            out.gouge = float(depth[k])
            out.gouge_at = (float(x[rows[some[k]]]), float(y[rows[some[k]]]))
            out.gouge_block = base + int(block[some[k]])
        bound[some] = -np.inf
        take = min(take * 8, 1 << 15)

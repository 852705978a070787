"""Which stretch of the route each block runs.

Only a guess is made here: a progress for the end of every block. ``deviation`` proves it, point by
point; a bad guess can refuse a good program, never pass a bad one. Most block ends stand beside a
vertex of the route, and all these are found at once; a cut where that leaves a doubt is followed
block by block.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wedmcam.judge.route import Route
from wedmcam.judge.segments import Floats, Ints, Segments, point_distance

#: A block end this near to a vertex of the route is taken to be meant for it, um: vertices are
#: rounded to the micron (0.71) and an arc may end one off.
NEAR = 2.0

#: A block end farther than this from the route is lost, um.
LOST = 8.0


class Track(NamedTuple):
    """Progress of blocks, one entry a cutting block.

    Attributes:
        low: progress at the start of each block, um; NaN where lost.
        high: at its end.
        lost: (block, um): for each cut that was lost, the first block that ends off the route and
            how far from all of the cut's route its end is.
    """

    low: Floats
    high: Floats
    lost: tuple[tuple[int, float], ...]


def progress(s: Segments, x: Floats, y: Floats) -> Floats:
    """Return how far along segment i the foot of point i lies, um; may be beyond the ends.

    On an arc from -(pi - half) to pi + half times the radius.
    """
    qx, qy = x - s.cx, y - s.cy
    line = s.turn == 0
    along = (x - s.ax) * s.mx + (y - s.ay) * s.my
    angle = np.arctan2(s.mx * qy - s.my * qx, s.mx * qx + s.my * qy)
    return np.where(line, along, (angle * s.turn + s.half) * s.radius)


def track(route: Route, x: Floats, y: Floats, length: Floats, cut: Ints) -> Track:
    """Give every block its stretch.

    Args:
        route: of the plan.
        x: places of the wire, um: for each cut its start, then the end of each of its blocks.
        y: likewise.
        length: along each block, um; 0 for the start of a cut. Same shape.
        cut: 0-based, of each place; sorted.
    """
    cuts = len(route.closed)
    first = np.searchsorted(cut, np.arange(cuts + 1))
    at = _anchored(route, x, y, length, cut, first)
    lost: list[tuple[int, float]] = []
    undone = np.isnan(at)
    for c in np.flatnonzero(np.bincount(cut[undone])):
        low, high = int(first[c]), int(first[c + 1])
        lost.extend(_follow(route, int(c), x, y, length, at, low, high))
    is_end = np.ones(len(x), bool)
    is_end[first[:-1][first[:-1] < first[1:]]] = False
    ends = np.flatnonzero(is_end)
    # Places are blocks and one start a cut: place p ends block p - (cut + 1).
    return Track(at[ends - 1], at[ends], tuple((p - int(cut[p]) - 1, d) for p, d in lost))


def _vertices(route: Route) -> tuple[Floats, Floats, Floats, Ints]:
    """Return (x, y, progress, cut) of all vertices, in order."""
    s, cuts = route.segments, np.arange(len(route.closed))
    last = route.first[1:] - 1
    where = np.arange(len(s)) + route.cut
    x, y, at = (np.empty(len(s) + len(cuts)) for _ in range(3))
    cut = np.empty(len(x), np.int64)
    x[where], y[where], at[where], cut[where] = s.ax, s.ay, route.at, route.cut
    end = last + cuts + 1
    x[end], y[end], at[end], cut[end] = s.bx[last], s.by[last], route.to[last], cuts
    return x, y, at, cut


def _anchored(route: Route, x: Floats, y: Floats, length: Floats, cut: Ints, first: Ints) -> Floats:
    """Return the progress of all places of the cuts where anchors settle it; NaN elsewhere."""
    vx, vy, v_at, v_cut = _vertices(route)
    out = np.full(len(x), np.nan)
    cuts = len(route.closed)
    if not len(x):
        return out
    # Expected progress: length run so far, in proportion.
    run = np.cumsum(length)
    starts = np.minimum(first[:-1], len(x) - 1)
    run -= run[starts][cut]
    total = np.maximum.reduceat(run, starts) if len(starts) else run
    whole = route.high - route.low
    expected = route.low[cut] + run * (whole / np.maximum(total, 1.0))[cut]
    room = 50.0 + 0.02 * whole

    p, v = _beside(x, y, vx, vy)
    off = np.abs(v_at[v] - expected[p])
    good = (cut[p] == v_cut[v]) & (off <= room[cut[p]])
    p, v, off = p[good], v[good], off[good]
    for key in (p, v):  # the best vertex for a place, then the best place for a vertex
        order = np.lexsort((off, key))
        sorted_key = key[order]
        best = order[np.flatnonzero(np.diff(sorted_key, prepend=-1))]
        if key is p:
            p0, v0, off0 = p[best], v[best], off[best]
    p, v, off = p0, v0, off0
    order = np.lexsort((off, v))
    best = order[np.flatnonzero(np.diff(v[order], prepend=-1))]
    p, v = p[best], v[best]
    order = np.argsort(p)
    p, v = p[order], v[order]
    out[p] = v_at[v]

    # A cut is settled if its anchors grow, begin and end it, and leave no doubt between them.
    bad = np.zeros(cuts, bool)
    v_first = route.first[:-1] + np.arange(cuts)
    v_last = route.first[1:] + np.arange(cuts)
    bad |= first[:-1] >= first[1:]
    bad |= out[starts] != v_at[v_first]
    bad |= out[np.maximum(first[1:] - 1, 0)] != v_at[v_last]
    same = cut[p[1:]] == cut[p[:-1]]
    step_p, step_v = np.diff(p), np.diff(v)
    doubt = same & ((step_v <= 0) | ((step_p > 1) & (step_v > 1)))
    bad[cut[p[1:][doubt]]] = True
    # Blocks that part one segment: their ends by their feet on it.
    inner = np.flatnonzero(np.isnan(out))
    inner = inner[~bad[cut[inner]]]
    if len(inner):
        before = np.searchsorted(p, inner) - 1
        segment = v[before] - v_cut[v[before]]
        held = route.segments.take(segment)
        t = progress(held, x[inner], y[inner])
        bad_t = (t <= 0) | (t >= held.length)
        bad_t |= point_distance(held, x[inner], y[inner]) > LOST
        out[inner] = route.at[segment] + t
        bad[cut[inner[bad_t]]] = True
    back = (np.diff(out) <= 0) & (cut[1:] == cut[:-1])
    bad[cut[1:][back]] = True
    out[bad[cut]] = np.nan
    return out


def _beside(x: Floats, y: Floats, vx: Floats, vy: Floats) -> tuple[Ints, Ints]:
    """Return the pairs (place, vertex) at most `NEAR` apart, by a grid of cells of 2 NEAR."""
    cell = 2.0 * NEAR
    x_low, y_low = vx.min() - 2 * cell, vy.min() - 2 * cell
    wide = np.floor((vx.max() - x_low) / cell) + 4.0

    def key(px: Floats, py: Floats) -> Floats:
        return np.asarray(np.floor((px - x_low) / cell) + np.floor((py - y_low) / cell) * wide)

    of_vertex = key(vx, vy)
    order = np.argsort(of_vertex, kind="stable")
    ordered = of_vertex[order]
    ps, vs = [], []
    for dx in (-NEAR, NEAR):
        for dy in (-NEAR, NEAR):
            wanted = key(x + dx, y + dy)
            low, high = np.searchsorted(ordered, wanted), np.searchsorted(ordered, wanted, "right")
            n = high - low
            place = np.repeat(np.arange(len(x)), n)
            ps.append(place)
            vs.append(order[np.arange(n.sum()) - np.repeat(np.cumsum(n) - n - low, n)])
    p, v = np.concatenate(ps), np.concatenate(vs)
    near = np.hypot(x[p] - vx[v], y[p] - vy[v]) <= NEAR
    return p[near], v[near]


def _follow(
    route: Route,
    c: int,
    x: Floats,
    y: Floats,
    length: Floats,
    at: Floats,
    low: int,
    high: int,
) -> list[tuple[int, float]]:
    """Follow one cut block by block; fill ``at``, return where it was lost."""
    first, last = int(route.first[c]), int(route.first[c + 1])
    starts, ends = route.at[first:last], route.to[first:last]
    here = float(starts[0])
    at[low] = here
    for p in range(low + 1, high):
        wanted = here + float(length[p])
        room = 4.0 + 0.02 * float(length[p])
        k0 = int(np.searchsorted(ends, here - 4.0))
        k1 = int(np.searchsorted(starts, wanted + room, "right"))
        k0, k1 = min(k0, len(starts) - 1), max(min(k1, len(starts)), min(k0, len(starts) - 1) + 1)
        held = route.segments.take(slice(first + k0, first + k1))
        px, py = np.full(k1 - k0, x[p]), np.full(k1 - k0, y[p])
        d = point_distance(held, px, py)
        t = progress(held, px, py)
        # The start of a long arc lies beyond its end as well: the turn nearest to what is expected.
        turn = 2.0 * np.pi * held.radius
        turns = np.round((wanted - starts[k0:k1] - t) / np.where(turn > 0, turn, 1.0))
        other = t + turns * turn
        fits = (other >= -NEAR) & (other <= held.length + NEAR)
        t = np.clip(np.where(fits, other, t), 0.0, held.length) + starts[k0:k1]
        nearest = float(d.min())
        if nearest > LOST:
            everything = route.segments.take(slice(first, last))
            off = point_distance(everything, np.full(1, x[p]), np.full(1, y[p]))
            at[p:high] = np.nan
            return [(p, float(off.min()))]
        cost = np.where(d <= LOST, d + 0.5 * np.abs(t - wanted), np.inf)
        best = int(np.argmin(cost))
        here = float(t[best])
        # On a vertex: its progress exactly, so that pieces begin and end with segments.
        k = k0 + best
        for vertex, vx, vy in (
            (float(starts[k]), held.ax[best], held.ay[best]),
            (float(ends[k]), held.bx[best], held.by[best]),
        ):
            if abs(vertex - here) <= 2 * NEAR and np.hypot(vx - x[p], vy - y[p]) <= NEAR:
                here = vertex
                break
        at[p] = here
    return []

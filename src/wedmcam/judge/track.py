"""Which stretch of the route each block runs.

Only a guess is made here: a progress for the end of every block. ``deviation`` proves it, point by
point; a bad guess can refuse a good program, never pass a bad one. Most block ends stand beside a
vertex of the route, and all these are found at once; a cut where that leaves a doubt is followed
block by block.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.judge.route import Route
from wedmcam.judge.segments import Floats, Ints, Segments, point_distance

#: A block end this near to a vertex of the route is taken to be meant for it, um: vertices are
#: rounded to the micron (0.71) and an arc may end one off.
NEAR = 2.0

#: A block end farther than this from the route is lost, um.
LOST = 8.0

#: A way through candidates that costs this much more than the best one is given up, um.
HOPELESS = 20.0


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
    # Runs of places that are not settled, each from the settled one before to the one behind.
    goes_on = np.append(False, undone[:-1] & (cut[1:] == cut[:-1]))[: len(x)]
    begins = np.flatnonzero(undone & ~goes_on)
    gone = -1
    for low in begins.tolist():
        c = int(cut[low])
        if c == gone:
            at[low : first[c + 1]] = np.nan
            continue
        high = low + 1
        while high < first[c + 1] and undone[high]:
            high += 1
        if low == first[c]:
            at[low] = route.low[c]
        low = max(low - 1, int(first[c]))
        ends_cut = high == first[c + 1]
        high = high if ends_cut else high + 1
        lost_here = _follow(route, c, x, y, length, at, low, high, ends_cut)
        if lost_here:
            gone = c
            at[lost_here[0][0] : first[c + 1]] = np.nan
            lost += lost_here
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
    unsure = _unsure(p, off, len(x))
    unsure[first[:-1]] = unsure[first[1:] - 1] = False  # a cut begins and ends its route
    p, v, off = p[~unsure[p]], v[~unsure[p]], off[~unsure[p]]
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
    count = np.cumsum(unsure)
    sure = count[p[1:]] == count[p[:-1]]
    doubt = same & ((step_v <= 0) | ((step_p > 1) & (step_v > 1) & sure))
    bad[cut[p[1:][doubt]]] = True
    # Blocks that part one segment: their ends by their feet on it.
    inner = np.flatnonzero(np.isnan(out))
    inner = inner[~bad[cut[inner]]]
    if len(inner):
        before = np.searchsorted(p, inner) - 1
        settled = sure[before]
        inner, before = inner[settled], before[settled]
        segment = v[before] - v_cut[v[before]]
        held = route.segments.take(segment)
        t = progress(held, x[inner], y[inner])
        bad_t = (t <= 0) | (t >= held.length)
        bad_t |= point_distance(held, x[inner], y[inner]) > LOST
        out[inner] = route.at[segment] + t
        bad[cut[inner[bad_t]]] = True
    with np.errstate(invalid="ignore"):
        back = (np.diff(out) <= 0) & (cut[1:] == cut[:-1])
    bad[cut[1:][back]] = True
    out[bad[cut]] = np.nan
    return out


def _unsure(p: Ints, off: Floats, places: int) -> NDArray[np.bool_]:
    """Return which places have two vertices that are as likely: segments of a step or two."""
    order = np.lexsort((off, p))
    p, off = p[order], off[order]
    result = np.zeros(places, bool)
    first = np.diff(p, prepend=-1) != 0
    second = np.append(False, first[:-1]) & ~first
    k = np.flatnonzero(second)
    result[p[k[off[k] - off[k - 1] < 4.0 * NEAR]]] = True
    return result


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
    ends_cut: bool,
) -> list[tuple[int, float]]:
    """Follow places low to high - 1 of one cut; fill ``at``, return where it was lost.

    ``at[low]`` is known; so is the last one, but where the places end their cut. Of all ways
    through the places' candidates the one is taken that lies nearest to them and is as long as
    their blocks: where segments are as short as what rounding moves their ends, only the whole
    tells which vertex is meant.
    """
    first, last = int(route.first[c]), int(route.first[c + 1])
    starts, ends = route.at[first:last], route.to[first:last]
    final = high - 1 if ends_cut else -1
    seen = [np.array([at[low]])]
    came: list[Ints] = [np.zeros(1, np.int64)]
    cost = np.zeros(1)
    lost: list[tuple[int, float]] = []
    for p in range(low + 1, high):
        here, step = seen[-1], float(length[p])
        if p == high - 1 and not ends_cut:
            there, off = at[p : p + 1], np.zeros(1)
        else:
            k0 = min(int(np.searchsorted(ends, here.min() - 4.0)), len(starts) - 1)
            reach = here.max() + step + 4.0 + 0.02 * step
            k1 = max(int(np.searchsorted(starts, reach, "right")), k0 + 1)
            held = route.segments.take(slice(first + k0, first + k1))
            there, off = _candidates(held, starts[k0:k1], ends[k0:k1], x[p], y[p])
            if p == final and len(there) and there.max() == ends[-1]:
                there, off = there[there == ends[-1]][:1], np.zeros(1)  # it ends its route
        if not len(there):
            off = point_distance(
                route.segments.take(slice(first, last)), x[p : p + 1], y[p : p + 1]
            )
            lost.append((p, float(off.min())))
            high = p
            break
        ways = cost[None, :] + 0.5 * np.abs(there[:, None] - here[None, :] - step)
        best = np.argmin(ways, axis=1)
        cost = ways[np.arange(len(there)), best] + off
        kept = np.flatnonzero(cost <= cost.min() + HOPELESS)
        seen.append(there[kept])
        came.append(best[kept])
        cost = cost[kept]
    k = int(np.argmin(cost))
    for p in range(high - 1, low, -1):
        at[p] = seen[p - low][k]
        k = int(came[p - low][k])
    return lost


def _candidates(
    held: Segments, starts: Floats, ends: Floats, x: float, y: float
) -> tuple[Floats, Floats]:
    """Return where on segments a place may be, as progress, and how far off it is then, um.

    On a vertex: its progress exactly, so that pieces begin and end with segments.
    """
    n = len(starts)
    px, py = np.full(n, x), np.full(n, y)
    d = point_distance(held, px, py)
    near = np.flatnonzero(d <= LOST)
    if not len(near):
        return np.zeros(0), np.zeros(0)
    held, d, px, py = held.take(near), d[near], px[near], py[near]
    starts, ends = starts[near], ends[near]
    t = progress(held, px, py)
    # The start of a long arc lies beyond its end as well.
    turn = 2.0 * np.pi * held.radius
    every = [t] if not (turn > 0).any() else [t, t + turn, t - turn]
    # Of a tiny arc most is near its ends, and all the same elsewhere.
    beside = np.where(held.turn != 0, np.minimum(0.1 * held.length, 2 * NEAR), 2 * NEAR)
    places, offs, rooms = [], [], []
    for k, one in enumerate(every):
        fits = (one >= -NEAR) & (one <= held.length + NEAR) if k else np.ones(len(one), bool)
        places.append((np.clip(one, 0.0, held.length) + starts)[fits])
        offs.append(d[fits])
        rooms.append(beside[fits])
    tx, t_off = [], []
    for vertex, vx, vy in ((starts, held.ax, held.ay), (ends, held.bx, held.by)):
        away = np.hypot(vx - px, vy - py)
        tx.append(vertex[away <= NEAR])
        t_off.append(away[away <= NEAR])
    vertices = np.concatenate(tx)
    feet, off = np.concatenate(places), np.concatenate(offs)
    if len(vertices):  # feet beside a vertex are that vertex
        free = np.abs(feet[:, None] - vertices).min(axis=1) > np.concatenate(rooms)
        feet, off = feet[free], off[free]
    return np.concatenate([feet, vertices]), np.concatenate([off, *t_off])

"""Repair of drawings that cross themselves within a micron or two.

A step or an arc of some hundredths of a micron at a corner may run back over the segment before it.
No drawing shows that, but its offset turns round the wrong way there. The tiny loop is run through
the other way round: the same points of the drawing, but now the contour touches itself at the
crossing and has one side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import crossings
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints
from wedmcam.transforms.compensate.raw import Source

#: Loops longer than this are the drawing's, not its noise; um.
LOOP_UM = 3.0
#: Longer ones are noise too when they are thinner than this (two arcs at a cusp); um.
THIN_UM = 0.05
THIN_LENGTH_UM = 500.0
#: Segments looked at after each.
AHEAD = 6
#: Nearer to their common vertex than this, neighbours do not cross, they meet; um.
SHARED_VERTEX_UM = 1e-6


def untangle(source: Source) -> Source | None:
    """Return the source without loops of less than LOOP_UM; None if there are none."""
    s = source.segments
    pairs = _near_pairs(source)
    c = crossings.between(s, pairs[0], pairs[1])
    t1x, t1y = seg.end_tangents(s)
    t0x, t0y = (column[source.following] for column in seg.start_tangents(s))
    # Angle between the way back along a segment and the next one; curvature, 1/um.
    back = np.abs(np.arctan2(t1y * t0x - t1x * t0y, -t1x * t0x - t1y * t0y))
    curvature = np.where(s.radius > 0, 1.0 / np.where(s.radius > 0, s.radius, 1.0), 0.0)
    best: dict[int, tuple[float, int, float, float]] = {}
    between = dict(zip(zip(*(p.tolist() for p in pairs[:2]), strict=True), pairs[2], strict=True))
    for k in range(len(c.i)):
        i, j = int(c.i[k]), int(c.j[k])
        tail, head = float(s.length[i] - c.at_i[k]), float(c.at_j[k])
        loop = tail + head + float(between[i, j])
        if max(tail, head) < SHARED_VERTEX_UM:
            continue
        if source.following[i] == j:
            # Neighbours that cross again share a chord from their vertex to there, and bend to it
            # by half of what they turn on the way; what does not is noise.
            bend = 0.5 * (tail * curvature[i] + head * curvature[j])
            if back[i] > 1.1 * bend or max(tail, head) > 3.0 * min(tail, head):
                continue
        if loop > LOOP_UM and not (loop < THIN_LENGTH_UM and _thin(s, i, j, tail, head)):
            continue
        if i not in best or loop > best[i][0]:
            best[i] = (loop, j, float(c.x[k]), float(c.y[k]))
    if not best:
        return None
    rows: list[_Row] = []
    used = np.zeros(len(s), bool)
    x0, y0, x1, y1 = s.x0.copy(), s.y0.copy(), s.x1.copy(), s.y1.copy()
    part = np.ones(len(s))
    for i, (_, j, x, y) in sorted(best.items()):
        chain = [i]
        while chain[-1] != j:
            chain.append(int(source.following[chain[-1]]))
        if used[chain].any():
            continue
        used[chain] = True
        ends = [(float(s.x1[k]), float(s.y1[k])) for k in chain[:-1]]
        ends = [(x, y), *ends[::-1], (x, y)]
        for m, k in enumerate(chain[::-1]):
            rows.append(_Row(i + (m + 1) / (len(chain) + 1), k, *ends[m], *ends[m + 1]))
        x1[i], y1[i], x0[j], y0[j] = x, y, x, y
        part[chain[1:-1]] = 0.0
    return _rebuilt(source, rows, (x0, y0, x1, y1), np.flatnonzero(part))


def _thin(s: seg.Segments, i: int, j: int, tail: float, head: float) -> bool:
    """Return whether the last ``tail`` um of i and the first ``head`` um of j lie on each other."""
    of, other = np.array([i, j]), np.array([j, i])
    middle = np.array([float(s.length[i]) - 0.5 * tail, 0.5 * head])
    x, y = seg.points_at(s.take(of), middle)
    return bool((seg.distances(s.take(other), x, y) < THIN_UM).all())


class _Row(NamedTuple):
    """A piece of segment k, run backwards; ``key`` says where it goes."""

    key: float
    k: int
    x0: float
    y0: float
    x1: float
    y1: float


def _rebuilt(source: Source, rows: list[_Row], ends: tuple[Floats, ...], stay: Ints) -> Source:
    """Return the source with new ends of segments and with the reversed pieces put in."""
    s = source.segments
    of = np.concatenate([stay, np.array([r.k for r in rows], np.int64)])
    key = np.concatenate([stay.astype(float), [r.key for r in rows]])
    order = np.argsort(key, kind="stable")
    of = of[order]
    x0, y0, x1, y1 = (
        np.concatenate([ends[m][stay], [r[m + 2] for r in rows]])[order] for m in range(4)
    )
    turn = np.concatenate([s.turn[stay], [-s.turn[r.k] for r in rows]])[order].astype(np.int8)
    # Whole arcs about as long as before; pieces of arcs run less than half round.
    near = np.where((x0 == s.x0[of]) & (x1 == s.x1[of]), s.sweep[of], 0.0)
    a0, a1 = np.arctan2(y0 - s.cy[of], x0 - s.cx[of]), np.arctan2(y1 - s.cy[of], x1 - s.cx[of])
    cut = np.mod((a1 - a0) * turn, seg.TAU)
    near = np.where(near > 0, near, np.where(cut > s.sweep[of] + 1e-3, 0.0, cut))
    segments = seg.make(x0, y0, x1, y1, s.cx[of], s.cy[of], turn, s.radius[of], near)
    contour = source.contour[of]
    following = np.arange(1, len(of) + 1)
    last = np.flatnonzero(np.append(contour[1:] != contour[:-1], True))
    first = np.append(0, last[:-1] + 1)
    is_open = np.unique(source.contour[source.following < 0])
    following[last] = np.where(np.isin(contour[last], is_open), -1, first)
    return Source(segments, contour, source.row[of], following, source.shift[of], source.origin)


def _near_pairs(source: Source) -> tuple[Ints, Ints, Floats]:
    """Return (i, j, length between) for segments j soon after i, across less than LOOP_UM."""
    n = len(source.following)
    i = np.arange(n)
    j, between = i.copy(), np.zeros(n)
    near: list[tuple[Ints, Ints, Floats]] = []
    for step in range(AHEAD):
        if step:
            between = between + source.segments.length[j]
        j = source.following[j]
        going = (j >= 0) & (j != i) & (between < LOOP_UM)
        i, j, between = i[going], j[going], between[going]
        near.append((i, j, between))
    return (
        np.concatenate([f[0] for f in near]),
        np.concatenate([f[1] for f in near]),
        np.concatenate([f[2] for f in near]),
    )


def on_free_side(source: Source, contour: int, x: Floats, y: Floats) -> NDArray[np.bool_]:
    """Return which points lie on the side of a closed contour to which the wire was shifted.

    By the winding number of the contour about each point, which curls of less than a micron do not
    change some offset away. True for all points beside an open contour.
    """
    rows = np.flatnonzero(source.contour == contour)
    if not len(rows) or (source.following[rows] < 0).any():
        return np.ones(len(x), bool)
    s = source.segments.take(rows)
    result = np.zeros(len(x), bool)
    area = _area(s)
    inside_is_left = area > 0
    for k in range(len(x)):
        ax, ay, bx, by = s.x0 - x[k], s.y0 - y[k], s.x1 - x[k], s.y1 - y[k]
        angle = np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
        # Between the chord and its arc a point is passed on the arc's side: a turn more.
        cut = _between_chord_and_arc(s, float(x[k]), float(y[k]))
        winding = float(np.sum(angle) / (2 * np.pi)) + float(np.sum(cut * s.turn))
        inside = round(abs(winding)) != 0
        left = inside == inside_is_left
        result[k] = left == bool(source.shift[rows[0]] > 0)
    return result


def _between_chord_and_arc(s: seg.Segments, x: float, y: float) -> NDArray[np.bool_]:
    """Return which arcs enclose the point together with their chord."""
    dx, dy = s.x1 - s.x0, s.y1 - s.y0
    beyond = (dx * (y - s.y0) - dy * (x - s.x0)) * s.turn < 0
    inside = np.hypot(x - s.cx, y - s.cy) < s.radius
    full = (dx == 0) & (dy == 0)
    result: NDArray[np.bool_] = (s.turn != 0) & inside & (beyond | full)
    return result


def _area(s: seg.Segments) -> float:
    x, y = s.x0 - s.x0[0], s.y0 - s.y0[0]
    u, v = s.x1 - s.x0[0], s.y1 - s.y0[0]
    bow = s.radius**2 * (s.sweep - np.sin(s.sweep)) * s.turn
    return float(0.5 * np.sum(x * v - y * u + bow))

"""Exact lines and arcs as columns, and distances to them, written for the judge alone.

The compiler has kernels of its own; a wrong formula there must not vouch for itself here. All is
float64 um in drawing coordinates. An arc is its centre, its radius |start - centre| and the angle
from start to end; its own end may miss the circle by the rounding of the drawing.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.contour import Contour

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Bools: TypeAlias = NDArray[np.bool_]


class Segments:
    """Lines and arcs, one entry a segment.

    Attributes:
        ax: start, um.
        ay: likewise.
        bx: end, um.
        by: likewise.
        cx: centre of an arc; the start of a line.
        cy: likewise.
        turn: +1 counter-clockwise, -1 clockwise, 0 line.
        radius: of an arc; 0 for a line.
        half: half the angle swept, 0 < half <= pi; 0 for a line.
        mx: unit vector: of a line its heading, of an arc from the centre to its middle.
        my: likewise.
        length: um along the segment.
    """

    __slots__ = (
        *("ax", "ay", "bx", "by", "cx", "cy"),
        *("turn", "radius", "half", "mx", "my", "length"),
    )

    def __init__(
        self,
        ax: Floats,
        ay: Floats,
        bx: Floats,
        by: Floats,
        cx: Floats,
        cy: Floats,
        turn: Floats,
        radius: Floats,
        half: Floats,
        mx: Floats,
        my: Floats,
        length: Floats,
    ) -> None:
        self.ax, self.ay, self.bx, self.by, self.cx, self.cy = ax, ay, bx, by, cx, cy
        self.turn, self.radius, self.half = turn, radius, half
        self.mx, self.my, self.length = mx, my, length

    def columns(self) -> tuple[Floats, ...]:
        """Return all columns, in the order of the constructor."""
        return (
            *(self.ax, self.ay, self.bx, self.by, self.cx, self.cy),
            *(self.turn, self.radius, self.half, self.mx, self.my, self.length),
        )

    def __len__(self) -> int:
        """How many segments there are."""
        return len(self.ax)

    def take(self, index: Ints | Bools | slice) -> Segments:
        """Return the segments ``index`` picks, in its order."""
        return Segments(*(column[index] for column in self.columns()))


def segments(
    ax: Floats, ay: Floats, bx: Floats, by: Floats, cx: Floats, cy: Floats, turn: Floats
) -> Segments:
    """Return segments from ends, centres and senses; start == end with a turn is a full circle.

    >>> one = np.ones(1)
    >>> s = segments(10 * one, 0 * one, 10 * one, 0 * one, 0 * one, 0 * one, one)
    >>> round(float(s.length[0]), 3), float(s.mx[0])
    (62.832, -1.0)
    """
    arc = turn != 0
    cx, cy = np.where(arc, cx, ax), np.where(arc, cy, ay)
    radius = np.where(arc, np.hypot(ax - cx, ay - cy), 0.0)
    a0 = np.arctan2(ay - cy, ax - cx)
    a1 = np.arctan2(by - cy, bx - cx)
    sweep = np.mod((a1 - a0) * turn, 2.0 * np.pi)
    full = (ax == bx) & (ay == by)
    sweep = np.where(arc, np.where(full, 2.0 * np.pi, sweep), 0.0)
    middle = a0 + turn * sweep / 2.0
    chord = np.hypot(bx - ax, by - ay)
    safe = np.where(chord > 0, chord, 1.0)
    return Segments(
        ax,
        ay,
        bx,
        by,
        cx,
        cy,
        turn,
        radius,
        sweep / 2.0,
        np.where(arc, np.cos(middle), (bx - ax) / safe),
        np.where(arc, np.sin(middle), (by - ay) / safe),
        np.where(arc, radius * sweep, chord),
    )


def of_contour(contour: Contour) -> Segments:
    """Return the segments of a contour, in its order."""
    a, b = contour.starts, contour.ends
    columns = (a["x"], a["y"], b["x"], b["y"], a["cx"], a["cy"], a["turn"])
    return segments(*(np.ascontiguousarray(c, np.float64) for c in columns))


def polyline(x: Floats, y: Floats) -> Segments:
    """Return the lines between consecutive points."""
    zero = np.zeros(max(len(x) - 1, 0))
    return segments(x[:-1], y[:-1], x[1:], y[1:], zero, zero, zero)


def join(parts: Iterable[Segments]) -> Segments:
    """Return all segments of ``parts``, one after the other."""
    held = list(parts)
    if not held:
        return Segments(*([np.zeros(0)] * 12))
    if len(held) == 1:
        return held[0]
    every = zip(*(p.columns() for p in held), strict=True)
    return Segments(*(np.concatenate(column) for column in every))


def points_at(s: Segments, t: Floats) -> tuple[Floats, Floats]:
    """Return points of the segments at ``t`` um from each start; beyond the ends too."""
    radius = np.where(s.turn != 0, s.radius, 1.0)
    angle = np.where(s.turn != 0, (t / np.maximum(radius, 1e-300) - s.half) * s.turn, 0.0)
    ca, sa = np.cos(angle), np.sin(angle)
    arc_x = s.cx + s.radius * (s.mx * ca - s.my * sa)
    arc_y = s.cy + s.radius * (s.my * ca + s.mx * sa)
    line = s.turn == 0
    return np.where(line, s.ax + s.mx * t, arc_x), np.where(line, s.ay + s.my * t, arc_y)


def normals_at(s: Segments, t: Floats) -> tuple[Floats, Floats]:
    """Return unit vectors to the left of the heading at ``t`` um from each start."""
    x, y = points_at(s, t)
    line = s.turn == 0
    radius = np.where(line, 1.0, np.maximum(s.radius, 1e-300))
    # Left of a counter-clockwise arc is its centre.
    left_x = np.where(line, -s.my, (s.cx - x) / radius * s.turn)
    left_y = np.where(line, s.mx, (s.cy - y) / radius * s.turn)
    return left_x, left_y


def sub_segments(s: Segments, start: Floats, end: Floats) -> Segments:
    """Return the pieces of the segments from ``start`` to ``end`` um; 0 and length keep vertices.

    A piece of an arc that is shorter than the arc is never taken for a full circle.
    """
    ax, ay = points_at(s, start)
    bx, by = points_at(s, end)
    first, last = start <= 0, end >= s.length
    ax, ay = np.where(first, s.ax, ax), np.where(first, s.ay, ay)
    bx, by = np.where(last, s.bx, bx), np.where(last, s.by, by)
    start, end = np.maximum(start, 0.0), np.minimum(end, s.length)
    line = s.turn == 0
    radius = np.where(line, 1.0, np.maximum(s.radius, 1e-300))
    half = np.where(line, 0.0, (end - start) / radius / 2.0)
    middle = np.where(line, 0.0, ((start + end) / 2.0 / radius - s.half) * s.turn)
    ca, sa = np.cos(middle), np.sin(middle)
    return Segments(
        ax,
        ay,
        bx,
        by,
        np.where(line, ax, s.cx),
        np.where(line, ay, s.cy),
        s.turn,
        s.radius,
        half,
        np.where(line, s.mx, s.mx * ca - s.my * sa),
        np.where(line, s.my, s.my * ca + s.mx * sa),
        end - start,
    )


def reverse(s: Segments) -> Segments:
    """Return the segments run backwards, last first."""
    line = s.turn == 0
    r = Segments(
        s.bx,
        s.by,
        s.ax,
        s.ay,
        np.where(line, s.bx, s.cx),
        np.where(line, s.by, s.cy),
        -s.turn,
        s.radius,
        s.half,
        np.where(line, -s.mx, s.mx),
        np.where(line, -s.my, s.my),
        s.length,
    )
    return r.take(slice(None, None, -1))


def shifted(s: Segments, left_um: float | Floats) -> Segments:
    """Return each segment moved ``left_um`` to its left; an arc's radius never falls below 0.

    The pieces of a contour do not meet any more afterwards; only each for itself is meant.
    """
    line = s.turn == 0
    radius = np.where(line, 0.0, np.maximum(s.radius - left_um * s.turn, 0.0))
    scale = np.where(line, 1.0, radius / np.where(line, 1.0, np.maximum(s.radius, 1e-300)))
    dx, dy = np.where(line, -s.my * left_um, 0.0), np.where(line, s.mx * left_um, 0.0)
    ax, ay = s.cx + (s.ax - s.cx) * scale, s.cy + (s.ay - s.cy) * scale
    bx, by = s.cx + (s.bx - s.cx) * scale, s.cy + (s.by - s.cy) * scale
    return Segments(
        np.where(line, s.ax, ax) + dx,
        np.where(line, s.ay, ay) + dy,
        np.where(line, s.bx, bx) + dx,
        np.where(line, s.by, by) + dy,
        s.cx + dx,
        s.cy + dy,
        s.turn,
        radius,
        s.half,
        s.mx,
        s.my,
        np.where(line, s.length, radius * 2.0 * s.half),
    )


def point_distance(s: Segments, x: Floats, y: Floats) -> Floats:
    """Return the distance of point i to segment i, exact; inputs broadcast.

    >>> o = np.zeros(1)
    >>> float(point_distance(segments(o, o, o + 4, o, o, o, o), o + 7, o + 4)[0])
    5.0
    """
    line = s.turn == 0
    ux, uy = x - s.ax, y - s.ay
    along = np.clip(ux * s.mx + uy * s.my, 0.0, s.length)
    to_line = np.sqrt((ux - along * s.mx) ** 2 + (uy - along * s.my) ** 2)
    if line.all():
        return np.asarray(to_line)
    qx, qy = x - s.cx, y - s.cy
    rho = np.sqrt(qx * qx + qy * qy)
    inside = (qx * s.mx + qy * s.my >= rho * np.cos(s.half)) | (s.half >= np.pi)
    to_end = np.minimum(np.hypot(ux, uy), np.hypot(x - s.bx, y - s.by))
    to_arc = np.where(inside, np.minimum(np.abs(rho - s.radius), to_end), to_end)
    return np.where(line, to_line, to_arc)


def boxes(s: Segments, margin: float = 0.0) -> Floats:
    """Return the bounding boxes, shape (n, 4): x low, y low, x high, y high, grown by margin."""
    out = np.empty((len(s), 4))
    out[:, 0], out[:, 2] = np.minimum(s.ax, s.bx), np.maximum(s.ax, s.bx)
    out[:, 1], out[:, 3] = np.minimum(s.ay, s.by), np.maximum(s.ay, s.by)
    arc = np.flatnonzero(s.turn != 0)
    if len(arc):
        a = s.take(arc)
        cos_half = np.where(a.half >= np.pi, -2.0, np.cos(a.half))
        for dx, dy, column in ((-1, 0, 0), (0, -1, 1), (1, 0, 2), (0, 1, 3)):
            reached = arc[dx * a.mx + dy * a.my >= cos_half]
            centre = s.cx if dx else s.cy
            out[reached, column] = centre[reached] + (dx + dy) * s.radius[reached]
    out[:, :2] -= margin
    out[:, 2:] += margin
    return out


#: Boxes under one box of the next level of a tree, and pairs of boxes compared at a time.
FAN, AT_ONCE = 8, 1 << 20


def near_pairs(a: Floats, b: Floats) -> tuple[Ints, Ints]:
    """Return the index pairs (i, j) whose boxes ``a[i]`` and ``b[j]`` touch, sorted by i, then j.

    Consecutive entries of each should lie near each other, as those of a contour do: over `FAN` of
    them stands one box, and so on up to a single one, and two trees are descended side by side.
    """
    if not len(a) or not len(b):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    levels = [(np.ascontiguousarray(a.T), np.ascontiguousarray(b.T))]
    while max(len(levels[-1][0][0]), len(levels[-1][1][0])) > 1:
        levels.append((_over(levels[-1][0]), _over(levels[-1][1])))
    i = j = np.zeros(1, np.int64)
    each = AT_ONCE // FAN**2
    for of_a, of_b in levels[-2::-1]:
        parts = [
            _children(of_a, of_b, i[k : k + each], j[k : k + each]) for k in range(0, len(i), each)
        ]
        i, j = (np.concatenate(p) for p in zip(*parts, strict=True))
        if not len(i):
            break
    if len(levels) == 1:
        i, j = _touching(*levels[0], i, j)
    order = np.argsort(i * len(b) + j, kind="stable")
    return i[order], j[order]


def _over(columns: Floats) -> Floats:
    """Return the boxes over each `FAN` boxes; columns x low, y low, x high, y high."""
    first = np.arange(0, columns.shape[1], FAN)
    return np.concatenate(
        [
            np.minimum.reduceat(columns[:2], first, axis=1),
            np.maximum.reduceat(columns[2:], first, axis=1),
        ]
    )


def _children(a: Floats, b: Floats, i: Ints, j: Ints) -> tuple[Ints, Ints]:
    """Return the pairs of boxes under the pairs (i, j) that touch."""
    ramp = np.arange(FAN)
    under_i = np.repeat((i[:, None] * FAN + ramp)[:, :, None], FAN, axis=2).ravel()
    under_j = np.repeat((j[:, None] * FAN + ramp)[:, None, :], FAN, axis=1).ravel()
    there = (under_i < a.shape[1]) & (under_j < b.shape[1])
    if not there.all():
        under_i, under_j = under_i[there], under_j[there]
    return _touching(a, b, under_i, under_j)


def _touching(a: Floats, b: Floats, i: Ints, j: Ints) -> tuple[Ints, Ints]:
    """Return those of the pairs whose boxes touch."""
    some = np.flatnonzero((a[0][i] <= b[2][j]) & (b[0][j] <= a[2][i]))
    i, j = i[some], j[some]
    some = np.flatnonzero((a[1][i] <= b[3][j]) & (b[1][j] <= a[3][i]))
    return i[some], j[some]


def _on(s: Segments, x: Floats, y: Floats) -> Bools:
    """Return whether points of the carrier lie within the segment, ends included."""
    along = (x - s.ax) * s.mx + (y - s.ay) * s.my
    on_line = (along >= -1e-9) & (along <= s.length + 1e-9)
    qx, qy = x - s.cx, y - s.cy
    on_arc = (s.half >= np.pi) | (qx * s.mx + qy * s.my >= np.hypot(qx, qy) * np.cos(s.half) - 1e-9)
    return np.where(s.turn == 0, on_line, on_arc)


def segment_distance(a: Segments, b: Segments) -> Floats:
    """Return the least distance of segment a[i] to b[i], exact to float64; 0 where they cross.

    The least distance of two lines or arcs is at an end of one of them, at the foot of a centre on
    the other (the line through both centres for two arcs), or at a crossing.
    """
    least = np.minimum(point_distance(b, a.ax, a.ay), point_distance(b, a.bx, a.by))
    least = np.minimum(least, point_distance(a, b.ax, b.ay))
    least = np.minimum(least, point_distance(a, b.bx, b.by))
    a_line, b_line = a.turn == 0, b.turn == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        both = np.flatnonzero(a_line & b_line)
        if len(both):
            p, q = a.take(both), b.take(both)
            cross = p.mx * q.my - p.my * q.mx
            wx, wy = q.ax - p.ax, q.ay - p.ay
            t = (wx * q.my - wy * q.mx) / cross
            u = (wx * p.my - wy * p.mx) / cross
            hit = (t >= 0) & (t <= p.length) & (u >= 0) & (u <= q.length)
            least[both[hit]] = 0.0
        for line, arc, rows in (
            (a, b, np.flatnonzero(a_line & ~b_line)),
            (b, a, np.flatnonzero(~a_line & b_line)),
        ):
            if len(rows):
                p, q = line.take(rows), arc.take(rows)
                foot = (q.cx - p.ax) * p.mx + (q.cy - p.ay) * p.my
                fx, fy = p.ax + foot * p.mx, p.ay + foot * p.my
                d = np.where(_on(p, fx, fy), point_distance(q, fx, fy), np.inf)
                h = np.hypot(fx - q.cx, fy - q.cy)
                reach = np.sqrt(q.radius**2 - h**2)
                for sign in (-1.0, 1.0):
                    x, y = fx + sign * reach * p.mx, fy + sign * reach * p.my
                    d = np.where((h <= q.radius) & _on(p, x, y) & _on(q, x, y), 0.0, d)
                least[rows] = np.minimum(least[rows], d)
        arcs = np.flatnonzero(~a_line & ~b_line)
        if len(arcs):
            p, q = a.take(arcs), b.take(arcs)
            dx, dy = q.cx - p.cx, q.cy - p.cy
            gap = np.hypot(dx, dy)
            ux, uy = np.where(gap > 0, dx / gap, p.mx), np.where(gap > 0, dy / gap, p.my)
            d = least[arcs]
            for sign in (-1.0, 1.0):
                x, y = p.cx + sign * p.radius * ux, p.cy + sign * p.radius * uy
                d = np.minimum(d, np.where(_on(p, x, y), point_distance(q, x, y), np.inf))
            # Concentric arcs that face each other are |R - r| apart along any common ray; one of
            # the ends, tried above, is on such a ray, or both are full circles.
            along = (gap * gap + p.radius**2 - q.radius**2) / (2.0 * gap)
            high = np.sqrt(p.radius**2 - along**2)
            for sign in (-1.0, 1.0):
                x = p.cx + along * ux - sign * high * uy
                y = p.cy + along * uy + sign * high * ux
                hit = np.isfinite(x) & _on(p, x, y) & _on(q, x, y)
                d = np.where(hit, 0.0, d)
            least[arcs] = d
    return np.asarray(least)


def nearest(s: Segments, x: Floats, y: Floats, reach: float) -> tuple[Floats, Ints]:
    """Return, for each point, its distance to the nearest segment and which one.

    Points farther than ``reach`` from all have distance inf and index -1. Consecutive points
    should lie near each other.
    """
    best, index = np.full(len(x), np.inf), np.full(len(x), -1, np.int64)
    all_boxes = boxes(s)
    for low in range(0, len(x), 65536):
        px, py = x[low : low + 65536], y[low : low + 65536]
        at = np.column_stack([px - reach, py - reach, px + reach, py + reach])
        i, j = near_pairs(at, all_boxes)
        for k in range(0, len(i), 1 << 20):
            rows, which = i[k : k + (1 << 20)], j[k : k + (1 << 20)]
            d = point_distance(s.take(which), px[rows], py[rows])
            order = np.lexsort((which, d, rows))
            rows, which, d = rows[order], which[order], d[order]
            first = np.flatnonzero(np.diff(rows, prepend=-1))
            rows, which, d = rows[first], which[first], d[first]
            better = (d <= reach) & (d < best[low + rows])
            best[low + rows[better]] = d[better]
            index[low + rows[better]] = which[better]
    return best, index


def inside_parity(s: Segments, x: Floats, y: Floats) -> Bools:
    """Return whether an odd number of the closed contours of ``s`` encloses each point.

    A ray runs to +x; a vertex on the ray counts with the half-open rule (low end in, high end
    out), an arc as its chord plus whether the point lies in the segment of circle between arc and
    chord. Points on the outline itself may answer either way.
    """
    count = np.zeros(len(x), np.int64)
    ray = np.column_stack([x, y, np.full(len(x), np.inf), y])
    i, j = near_pairs(ray, boxes(s))
    if not len(i):
        return count > 0
    px, py, e = x[i], y[i], s.take(j)
    dx, dy = e.bx - e.ax, e.by - e.ay
    # Which hand of the chord: > 0 left. On the chord as if a trifle to +x, or +y where it is level.
    hand = dx * (py - e.ay) - dy * (px - e.ax)
    hand = np.where(hand != 0, hand, np.where(dy != 0, -dy, dx))
    spans = (np.minimum(e.ay, e.by) <= py) & (py < np.maximum(e.ay, e.by))
    hit = spans & ((hand > 0) == (dy > 0))
    count += np.bincount(i[hit], minlength=len(x))
    # Between arc and chord: in the disc, on the arc's hand of the chord (a full circle: both).
    in_disc = (px - e.cx) ** 2 + (py - e.cy) ** 2 < e.radius**2
    cap = (e.turn != 0) & in_disc & ((hand * e.turn < 0) | (e.half >= np.pi))
    count += np.bincount(i[cap], minlength=len(x))
    return np.asarray(count % 2 == 1)

"""The fast case: smooth closed contours whose shifted segments neither vanish nor cross.

Most of a drawing is like that, and splines always are: thousands of short tangent arcs. Every joint
then meets by itself, so shifting each vertex is the whole work; what takes time is to make sure.
Anything else (a corner, a crossing, a speck, an open contour) is left to ``raw`` and ``resolve``,
which give the same path in such a case too.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.geom import crossings, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.compensate.coordinates import joints, rounded
from wedmcam.transforms.compensate.raw import SAME_END_UM, SPECK_UM
from wedmcam.transforms.compensate.resolve import SLIVER_UM

Column = TypeVar("Column", Floats, Ints)

#: Below this offset a corner's gap is too small to be told from a tangent joint; um.
LEAST_OFFSET_UM = 5.0
#: Radii below this after the shift are looked at more closely; um.
RADIUS_UM = 0.1
#: Below so many segments there is nothing to gain.
LEAST_SEGMENTS = 8


def regular_paths(
    outlines: Sequence[Contour], shifts: Sequence[float], ar: Arithmetic = FLOAT64
) -> list[Contour] | None:
    """Return one path for each outline, or None where that is not the whole story.

    Whether it is, is decided in float64; the vertices are computed in ``ar``.
    """
    count = np.array([len(c.vertices) for c in outlines])
    if count.sum() < LEAST_SEGMENTS or count.min() < 3:
        return None
    if not all(c.closed for c in outlines) or min(abs(s) for s in shifts) < LEAST_OFFSET_UM:
        return None
    v = (
        outlines[0].vertices
        if len(outlines) == 1
        else np.concatenate([c.vertices for c in outlines])
    )
    shift: float | Floats = shifts[0] if len(outlines) == 1 else np.repeat(shifts, count)
    last = np.cumsum(count) - 1
    first = last - count + 1
    ox, oy = (float(np.round(0.5 * (v[k].min() + v[k].max()))) for k in ("x", "y"))
    x0, y0 = v["x"] - ox, v["y"] - oy
    x1, y1 = _next(x0, first, last), _next(y0, first, last)
    turn = v["turn"]
    is_arc = turn != 0
    cx, cy = np.where(is_arc, v["cx"] - ox, x0), np.where(is_arc, v["cy"] - oy, y0)
    dx, dy = x1 - x0, y1 - y0
    chord = np.hypot(dx, dy)
    if chord.min() < SPECK_UM:
        return None
    # Left normals at both ends of each segment.
    sx, sy, ex, ey = x0 - cx, y0 - cy, x1 - cx, y1 - cy
    radius = np.hypot(sx, sy)
    ends = np.hypot(ex, ey)
    if np.abs((ends - radius)[is_arc]).max(initial=0.0) > 0.5 * SAME_END_UM:
        return None
    moved = radius - shift * turn
    if moved[is_arc].min(initial=np.inf) < RADIUS_UM:
        return None
    by = np.where(is_arc, -turn / np.where(is_arc, radius, 1.0), 1.0 / chord) * shift
    ax = x0 + by * np.where(is_arc, sx, -dy)
    ay = y0 + by * np.where(is_arc, sy, dx)
    bx = x1 + by * np.where(is_arc, ex, -dy)
    by_ = y1 + by * np.where(is_arc, ey, dx)
    gx, gy = _next(ax, first, last) - bx, _next(ay, first, last) - by_
    if max(np.abs(gx).max(), np.abs(gy).max()) > 0.7 * SAME_END_UM:
        return None
    # The vertices lie in the middle of what gap there is.
    ax -= 0.5 * _before(gx, first, last)
    ay -= 0.5 * _before(gy, first, last)
    bx, by_ = _next(ax, first, last), _next(ay, first, last)

    chord = np.hypot(bx - ax, by_ - ay)
    side = (dx * (cy - y0) - dy * (cx - x0)) * turn
    if np.any(is_arc & (side < 0) & (chord < 0.5 * moved)) or chord.min() < SPECK_UM:
        return None
    height = np.sqrt(np.maximum(moved * moved - 0.25 * chord * chord, 0.0))
    bow = np.where(is_arc, moved - np.where(side >= 0, height, -height), 0.0)
    # Boxes that hold the arcs, not the smallest ones; an arc beyond half a circle bulges sideways.
    out = np.where(side < 0, np.maximum(bow, moved), bow) * is_arc + crossings.REACH
    boxes = (
        np.minimum(ax, bx) - out,
        np.minimum(ay, by_) - out,
        np.maximum(ax, bx) + out,
        np.maximum(ay, by_) + out,
    )
    if not _wide(ax, ay, bx, by_, chord, bow * turn, first):
        return None
    if _cross(boxes, ax, ay, bx, by_, cx, cy, turn, moved, first, last):
        return None
    if len(outlines) > 1 and not _clear(
        ax[first], ay[first], np.abs(np.array(shifts)), (x0, y0, x1, y1, cx, cy, turn)
    ):
        return None
    rows = np.empty(len(v), VERTEX)
    if ar is not FLOAT64:  # float64 is what they were computed in
        drawn = seg.make(x0, y0, x1, y1, cx, cy, turn)
        following = _next(np.arange(len(v)), first, last)
        ax, ay = joints(ar, drawn, np.broadcast_to(shift, len(v)), following)
        cx, cy = rounded(ar, cx), rounded(ar, cy)
    rows["x"], rows["y"] = ax + ox, ay + oy
    rows["cx"], rows["cy"] = np.where(is_arc, cx + ox, v["cx"]), np.where(is_arc, cy + oy, v["cy"])
    rows["turn"], rows["source"] = turn, v["source"]
    return [
        Contour(rows[a : b + 1], True, c.sources)
        for a, b, c in zip(first.tolist(), last.tolist(), outlines, strict=True)
    ]


def _next(values: Column, first: Ints, last: Ints) -> Column:
    """Return for each segment the value of the next one of its contour."""
    result = np.empty_like(values)
    result[:-1] = values[1:]
    result[last] = values[first]
    return result


def _before(values: Floats, first: Ints, last: Ints) -> Floats:
    """Return for each segment the value of the one before it in its contour."""
    result = np.empty_like(values)
    result[1:] = values[:-1]
    result[first] = values[last]
    return result


def _wide(
    ax: Floats, ay: Floats, bx: Floats, by: Floats, chord: Floats, bow: Floats, first: Ints
) -> bool:
    """Return whether every loop is far from a sliver (area by chords and parabolas)."""
    area = 0.5 * np.add.reduceat(ax * by - ay * bx + 4.0 / 3.0 * chord * bow, first)
    length = np.add.reduceat(chord + np.abs(bow), first)
    return bool((np.abs(area) > 100.0 * SLIVER_UM * length).all())


def _cross(
    boxes: pairs.Boxes,
    ax: Floats,
    ay: Floats,
    bx: Floats,
    by: Floats,
    cx: Floats,
    cy: Floats,
    turn: NDArray[np.int8],
    radius: Floats,
    first: Ints,
    last: Ints,
) -> bool:
    """Return whether shifted segments that are not neighbours cross or touch."""
    i, j = pairs.self_overlapping(boxes)
    closing = np.zeros(len(ax), np.int64)
    closing[first] = last
    far = (j != i + 1) & (closing[i] != j)
    # The last segment of a contour and the first of the next are no neighbours.
    ends = np.zeros(len(ax), bool)
    ends[last] = True
    far |= ends[i] & (j == i + 1)
    i, j = i[far], j[far]
    if not len(i):
        return False
    used = np.concatenate([i, j])
    s = seg.make(
        ax[used], ay[used], bx[used], by[used], cx[used], cy[used], turn[used], radius[used]
    )
    n = len(i)
    return len(crossings.between(s, np.arange(n), np.arange(n, 2 * n)).i) > 0


def _clear(px: Floats, py: Floats, offset: Floats, drawn: tuple[Floats, ...]) -> bool:
    """Return whether a point of each path keeps its distance from all outlines.

    Paths that do not cross are clear of the other outlines as a whole or not at all.
    """
    x0, y0, x1, y1, cx, cy, turn = drawn
    s = seg.make(x0, y0, x1, y1, cx, cy, turn.astype(np.int8))
    reach = float(offset.max())
    i, j = pairs.overlapping((px, py, px, py), pairs.grow(seg.boxes(s), reach))
    d = seg.distances(s.take(j), px[i], py[i])
    return bool((pairs.least(d, i, len(px)) >= offset - SAME_END_UM).all())

"""How long, how large, where: the measures of a contour of lines and arcs, arcs exact.

Every stage that needs an area, a length, extents, a point along a contour or 'is it inside' takes
it from here. Functions take the rows of a contour (dtype of `wedmcam.ir.contour.VERTEX`, um) and
whether it is closed. All are array operations over the rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom.segments import (
    TAU,
    Floats,
    Ints,
    Segments,
    boxes,
    following,
    of_rows,
    points_at,
)

Rows = NDArray[np.void]
Box = tuple[float, float, float, float]

#: Below this sweep (radians) ``sweep - sin(sweep)`` loses digits and its series is used instead;
#: three terms leave a relative error of sweep^6 / 60480 < 2e-13.
SERIES_BELOW = 0.05


def segments_of(rows: Rows, closed: bool) -> Segments:
    """Return the segments of a contour as columns, in its order."""
    if closed:
        return of_rows(rows, following(rows))
    return of_rows(rows[:-1], rows[1:])


def segments_of_all(
    contours: Sequence[tuple[Rows, bool]],
) -> tuple[Segments, NDArray[np.intp]]:
    """Return the segments of several contours as columns, and where those of each begin.

    Args:
        contours: rows, and whether they are closed; each has a segment or more.
    """
    rows = np.concatenate([rows for rows, _ in contours])
    closed = np.array([closed for _, closed in contours])
    length = np.array([len(rows) for rows, _ in contours])
    first = np.cumsum(length) - length
    ends = np.arange(1, len(rows) + 1)
    ends[first + length - 1] = first  # round, where a contour is closed
    opens = np.ones(len(rows), np.bool_)
    opens[(first + length - 1)[~closed]] = False
    count = length - ~closed
    assert count.all(), "a contour without a segment"
    return of_rows(rows[opens], rows[ends[opens]]), np.cumsum(count) - count


def segment_areas(s: Segments, origin: tuple[Floats | float, Floats | float]) -> Floats:
    """Return the signed area between each segment and the rays from ``origin`` to its ends, um^2.

    The sum over a closed contour is its area, > 0 where it runs counter-clockwise. An origin near
    the contour keeps the digits.
    """
    ox, oy = origin
    chord = 0.5 * ((s.x0 - ox) * (s.y1 - oy) - (s.x1 - ox) * (s.y0 - oy))
    w = s.sweep
    w2 = w * w
    series = w * w2 / 6.0 * (1.0 - w2 / 20.0 * (1.0 - w2 / 42.0))
    bow = np.where(w < SERIES_BELOW, series, w - np.sin(w))
    area: Floats = chord + 0.5 * s.turn * s.radius * s.radius * bow
    return area


def area(rows: Rows) -> float:
    """Return the signed area of a closed contour, um^2: > 0 counter-clockwise.

    >>> from wedmcam.ir.contour import vertices
    >>> round(area(vertices([(10.0, 0.0, 0.0, 0.0, 1, 0)])), 3)  # pi * 10^2
    314.159
    """
    s = segments_of(rows, True)
    origin = (float(rows["x"][0]), float(rows["y"][0]))
    return float(np.sum(segment_areas(s, origin)))


def length(rows: Rows, closed: bool) -> float:
    """Return the length along a contour, um."""
    return float(np.sum(segments_of(rows, closed).length))


def extents(rows: Rows, closed: bool) -> Box:
    """Return (xmin, ymin, xmax, ymax) of a contour, um; the bellies of arcs count."""
    xmin, ymin, xmax, ymax = boxes(segments_of(rows, closed))
    return float(xmin.min()), float(ymin.min()), float(xmax.max()), float(ymax.max())


def extents_of_all(contours: Sequence[tuple[Rows, bool]]) -> Floats:
    """Return xmin, ymin, xmax, ymax of each contour, um, shape (n, 4)."""
    segments, starts = segments_of_all(contours)
    xmin, ymin, xmax, ymax = boxes(segments)
    lows = [np.minimum.reduceat(v, starts) for v in (xmin, ymin)]
    return np.column_stack([*lows, *(np.maximum.reduceat(v, starts) for v in (xmax, ymax))])


def sizes_of_all(contours: Sequence[tuple[Rows, bool]]) -> tuple[Floats, Floats]:
    """Return length (um) and signed area (um^2; says nothing of an open one) of each contour."""
    segments, starts = segments_of_all(contours)
    count = np.diff([*starts.tolist(), len(segments)])
    x, y = (np.repeat([float(rows[k][0]) for rows, _ in contours], count) for k in ("x", "y"))
    areas = segment_areas(segments, (x, y))
    return np.add.reduceat(segments.length, starts), np.add.reduceat(areas, starts)


def point_at(rows: Rows, closed: bool, at_um: float) -> tuple[float, float, int]:
    """Return the point ``at_um`` along a contour from its first vertex, and the row it lies on.

    Args:
        rows: the contour.
        closed: whether it is; then ``at_um`` counts on round and round, and may be negative.
        at_um: distance along the contour; clamped to its ends where it is open.

    Returns:
        x, y in um, and the row that opens the segment. A vertex belongs to the segment it opens.
    """
    s = segments_of(rows, closed)
    ends = np.cumsum(s.length)
    at = at_um % float(ends[-1]) if closed else min(max(at_um, 0.0), float(ends[-1]))
    row = min(int(np.searchsorted(ends, at, side="right")), len(s) - 1)
    within = at - (float(ends[row - 1]) if row else 0.0)
    x, y = points_at(s.take(np.array([row])), np.array([within]))
    return float(x[0]), float(y[0]), row


def middles(s: Segments) -> tuple[Floats, Floats]:
    """Return the point half-way along each segment."""
    return points_at(s, 0.5 * s.length)


class Inside:
    """Answers 'is this point inside' for closed contours and many points.

    Takes their segments, in any order and direction; a point is inside where it is inside an odd
    number of contours. Segments are cut into pieces that rise or fall in y; an odd number of them
    lies to the right of a point inside. A piece owns its lower end and not its upper one, so that a
    vertex level with the point counts once. Points on a contour may fall on either side.
    """

    def __init__(self, s: Segments) -> None:
        line = s.turn == 0
        arcs = s.take(np.flatnonzero(~line))
        # Cut arcs where they pass their top or bottom: at most three pieces an arc.
        quarter = np.pi / 2
        to_top = np.mod((quarter - arcs.a0) * arcs.turn, TAU)
        to_low = np.mod((-quarter - arcs.a0) * arcs.turn, TAU)
        at_top, at_low = arcs.cy + arcs.radius, arcs.cy - arcs.radius
        top_first = to_top < to_low
        first = np.where(top_first, to_top, to_low)
        second = np.where(top_first, to_low, to_top)
        y_first = np.where(top_first, at_top, at_low)
        y_second = np.where(top_first, at_low, at_top)
        y1 = np.where(first < arcs.sweep, y_first, arcs.y1)
        y2 = np.where(second < arcs.sweep, y_second, arcs.y1)
        starts = np.concatenate([arcs.y0, y1, y2])
        ends = np.concatenate([y1, y2, arcs.y1])
        three = [np.concatenate([c, c, c]) for c in (arcs.cx, arcs.cy, arcs.radius)]
        # A counter-clockwise piece that rises is on the right half of its circle.
        half = np.where((ends > starts) == (np.tile(arcs.turn, 3) > 0), 1.0, -1.0)
        none = np.zeros(int(line.sum()))
        self._ya = np.concatenate([s.y0[line], starts])
        self._yb = np.concatenate([s.y1[line], ends])
        self._half = np.concatenate([none, half])
        self._x = np.concatenate([s.x0[line], three[0]])
        self._x1 = np.concatenate([s.x1[line], three[0]])
        self._cy = np.concatenate([none, three[1]])
        self._r = np.concatenate([none, three[2]])
        keep = self._ya != self._yb
        for name in ("_ya", "_yb", "_half", "_x", "_x1", "_cy", "_r"):
            setattr(self, name, getattr(self, name)[keep])

    def __call__(self, x: Floats, y: Floats) -> NDArray[np.bool_]:
        """Return for each point (x, y), um, whether it is inside."""
        order = np.argsort(y, kind="stable")
        level = y[order]
        # Rows of `level` with low <= y < high of each piece.
        low = np.searchsorted(level, np.minimum(self._ya, self._yb), side="left")
        high = np.searchsorted(level, np.maximum(self._ya, self._yb), side="left")
        piece, row = _ranges(low, high)
        py = level[row]
        ya, yb = self._ya[piece], self._yb[piece]
        t = (py - ya) / (yb - ya)
        on_line = self._x[piece] + t * (self._x1[piece] - self._x[piece])
        up = py - self._cy[piece]
        across = np.sqrt(np.maximum(self._r[piece] ** 2 - up * up, 0.0))
        half = self._half[piece]
        at = np.where(half == 0, on_line, self._x[piece] + half * across)
        right = at > x[order][row]
        hits = np.bincount(row[right], minlength=len(y))
        answer = np.empty(len(y), np.bool_)
        answer[order] = hits % 2 == 1
        return answer


def _ranges(low: Ints, high: Ints) -> tuple[Ints, Ints]:
    """Return (item, value) for every value in low[item] .. high[item] - 1."""
    count = np.maximum(high - low, 0)
    item = np.repeat(np.arange(len(low)), count)
    value = np.arange(len(item)) - np.repeat(np.cumsum(count) - count, count) + low[item]
    return item, value


def contains(rows: Rows, x: Floats, y: Floats) -> NDArray[np.bool_]:
    """Return for each point whether a closed contour encloses it (see `Inside`).

    >>> from wedmcam.ir.contour import vertices
    >>> ring = vertices([(10.0, 0.0, 0.0, 0.0, 1, 0)])
    >>> contains(ring, np.array([9.9, 10.1, -9.9]), np.zeros(3)).tolist()
    [True, False, True]
    """
    return Inside(segments_of(rows, True))(np.asarray(x, float), np.asarray(y, float))

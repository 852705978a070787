"""Where a shifted segment certainly runs too near to its neighbours in the drawing.

At an inner corner the shifted neighbours overlap, and behind their crossing both are nearer to the
drawing than the offset. Of a hole of many sides near its radius nearly all of every shifted side
lies there, and every side crosses every other one. No such crossing is on the wire path, so none
has to be found: what is left of the sides hardly meets.
"""

from __future__ import annotations

import numpy as np

from wedmcam.geom import pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.transforms.compensate.raw import Raw, Source

#: Where so many elements lose most of themselves to their neighbours, farther ones are looked at.
MANY = 16


def left_over(source: Source, raw: Raw, certain_um: float) -> tuple[Floats, Floats]:
    """Return from where to where of each element something may be left, as arc lengths.

    From and to are exchanged where nothing is. Only lines beside lines are shortened.

    Args:
        source: the drawing.
        raw: its offset.
        certain_um: nearer than the offset by this much, and by how far joints were moved, is too
            near for certain.
    """
    e = raw.elements
    rows = np.flatnonzero((e.turn == 0) & ~raw.transition)
    of = raw.source[rows]
    low, high = np.zeros(len(rows)), e.length[rows].copy()
    lines = e.take(rows)
    radius = np.abs(source.shift[of]) - certain_um - 2.0 * raw.slack[rows]
    steps = _steps(source)
    count = len(of)
    while True:
        for step in steps:
            there = step[of]
            near = np.flatnonzero((there >= 0) & (there != of) & (radius > 0) & (low < high))
            near = near[source.segments.turn[there[near]] == 0]
            a, b = _too_near(lines.take(near), source.segments.take(there[near]), radius[near])
            begin, end = a <= low[near], b >= high[near]
            low[near] = np.where(begin, np.maximum(low[near], b), low[near])
            high[near] = np.where(end, np.minimum(high[near], a), high[near])
        if count < 2 or np.sum(high - low < 0.5 * lines.length) < MANY:
            break
        steps = _twice(steps)  # until that is once round
        count //= 2
    every_low, every_high = np.zeros(len(e)), e.length.copy()
    every_low[rows], every_high[rows] = low, high
    return every_low, every_high


def boxes(e: Segments, low: Floats, high: Floats) -> tuple[Ints, pairs.Boxes]:
    """Return the elements that are left, whole or in part, and boxes of that."""
    whole = seg.boxes(e)
    k = np.flatnonzero((low > 0) | (high < e.length))
    if not len(k):
        return np.arange(len(e)), whole
    x0, y0, ux, uy, a, b = e.x0[k], e.y0[k], e.ux[k], e.uy[k], low[k], high[k]
    ax, ay, bx, by = x0 + a * ux, y0 + a * uy, x0 + b * ux, y0 + b * uy
    sides = (np.minimum(ax, bx), np.minimum(ay, by), np.maximum(ax, bx), np.maximum(ay, by))
    for side, values in zip(whole, sides, strict=True):
        side[k] = values
    kept = np.flatnonzero(low < high)
    return kept, (whole[0][kept], whole[1][kept], whole[2][kept], whole[3][kept])


def near_family(source: Source, of: Ints, x: Floats, y: Floats) -> Floats:
    """Return how near points are at least to the drawing: to segments before and behind theirs.

    Where many crowd, these are enough to tell that a point is too near. ``of``: the segments that
    the points were shifted from.
    """
    result = np.full(len(of), np.inf)
    steps = _steps(source)
    count = len(source.following)
    while count > 1:
        for step in steps:
            there = np.where(step[of] >= 0, step[of], of)
            d = seg.distances(source.segments.take(there), x, y)
            result = np.minimum(result, d)
        steps = _twice(steps)
        count //= 2
    return result


def _steps(source: Source) -> list[Ints]:
    """Return the segment behind each segment, and the one before; -1 for none."""
    before = np.full(len(source.following), -1)
    has = np.flatnonzero(source.following >= 0)
    before[source.following[has]] = has
    return [source.following, before]


def _twice(steps: list[Ints]) -> list[Ints]:
    """Return steps that lead twice as far along a contour."""
    return [np.where(step >= 0, step[np.maximum(step, 0)], -1) for step in steps]


def _too_near(s: Segments, other: Segments, radius: Floats) -> tuple[Floats, Floats]:
    """Return from where to where line i passes within ``radius`` of line i of the others.

    As arc lengths of s, which may be beyond its ends; (inf, -inf) where it does not. The distance
    from a line is a convex function, so it is one stretch.
    """
    low, high = np.full(len(radius), np.inf), np.full(len(radius), -np.inf)
    for px, py in ((other.x0, other.y0), (other.x1, other.y1)):
        dx, dy = px - s.x0, py - s.y0
        along, across = dx * s.ux + dy * s.uy, dx * s.uy - dy * s.ux
        reach = radius * radius - across * across
        half = np.sqrt(np.maximum(reach, 0.0))
        low = np.where(reach > 0, np.minimum(low, along - half), low)
        high = np.where(reach > 0, np.maximum(high, along + half), high)
    # Between the ends of the other line: its distance, and the foot on it.
    dx, dy = s.x0 - other.x0, s.y0 - other.y0
    off, turn = other.ux * dy - other.uy * dx, other.ux * s.uy - other.uy * s.ux
    foot, run = other.ux * dx + other.uy * dy, other.ux * s.ux + other.uy * s.uy
    a0, a1 = _between(off, turn, -radius, radius)
    b0, b1 = _between(foot, run, np.zeros(len(radius)), other.length)
    a, b = np.maximum(a0, b0), np.minimum(a1, b1)
    low = np.where(a < b, np.minimum(low, a), low)
    high = np.where(a < b, np.maximum(high, b), high)
    return low, high


def _between(at: Floats, rate: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Return from where to where at + rate * t lies between low and high."""
    level = np.abs(rate) < 1e-12
    safe = np.where(level, 1.0, rate)
    a, b = (low - at) / safe, (high - at) / safe
    inside = (at > low) & (at < high)
    first = np.where(level, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    last = np.where(level, np.where(inside, np.inf, -np.inf), np.maximum(a, b))
    return first, last

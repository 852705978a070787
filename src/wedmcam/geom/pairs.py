"""Which boxes overlap: the sweep that keeps crossings and distances near-linear.

Boxes are put into horizontal strips, sorted by strip and left edge, and swept along x within each
strip. An R-tree (shapely.STRtree) was measured and buys nothing over this.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom.segments import Floats, Ints

Boxes = tuple[Floats, Floats, Floats, Floats]

#: Pairs that are looked at together where no number is given: as many as there are.
ALL = 2**62


def _strips(low: Floats, high: Floats, bottom: float, height: float) -> tuple[Ints, Ints, Ints]:
    """Return (item, strip) for each strip that [low, high] of an item touches, and first ones."""
    first = ((low - bottom) / height).astype(np.int64)
    count = ((high - bottom) / height).astype(np.int64) - first + 1
    item = np.repeat(np.arange(len(low)), count)
    strip = np.arange(len(item)) - np.repeat(np.cumsum(count) - count, count) + first[item]
    return item, strip, first


def expand(low: Ints, high: Ints) -> tuple[Ints, Ints]:
    """Return (row, k) for each k in low[row] .. high[row] - 1."""
    count = np.maximum(high - low, 0)
    row = np.repeat(np.arange(len(low)), count)
    return row, np.arange(len(row)) + np.repeat(low - (np.cumsum(count) - count), count)


def _parts(count: Ints, most: int) -> Iterator[tuple[int, int]]:
    """Yield first and last + 1 of rows, together at most about ``most`` (one row may be more)."""
    total = np.cumsum(count)
    first = 0
    while first < len(count):
        done = int(total[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(total, done + most, "right")))
        yield first, last
        first = last


def _height(bottom: float, top: float, heights: Floats) -> float:
    """Return the height of strips: two boxes, but more where long boxes would fill memory."""
    count = len(heights)
    least = (top - bottom) / (4.0 * np.sqrt(count) + 16.0)
    return max(2.0 * float(heights.mean()), float(least), 1e-9)


def overlapping(a: Boxes, b: Boxes) -> tuple[Ints, Ints]:
    """Return index pairs (i, j) of boxes a[i] and b[j] that overlap or touch, sorted by i, j."""
    return _sorted(list(overlapping_parts(a, b)), len(b[0]))


def self_overlapping(a: Boxes) -> tuple[Ints, Ints]:
    """Return index pairs i < j of boxes that overlap or touch, sorted."""
    return _sorted(list(self_overlapping_parts(a)), len(a[0]))


def _sorted(parts: list[tuple[Ints, Ints]], count: int) -> tuple[Ints, Ints]:
    if not parts:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    code = np.sort(np.concatenate([i * np.int64(count) + j for i, j in parts]))
    return code // count, code % count


def overlapping_parts(a: Boxes, b: Boxes, most: int = ALL) -> Iterator[tuple[Ints, Ints]]:
    """Yield the pairs of `overlapping`, from about ``most`` candidates at a time, each part sorted.

    Boxes that all lie over each other are a pair with each other: who holds them all at once needs
    memory for the square of their number.
    """
    ax0, ay0, ax1, ay1 = a
    bx0, by0, bx1, by1 = b
    if not len(ax0) or not len(bx0):
        return
    bottom = float(min(ay0.min(), by0.min()))
    top = float(max(ay1.max(), by1.max()))
    height = _height(bottom, top, np.concatenate([ay1 - ay0, by1 - by0]))
    ia, sa, first_a = _strips(ay0, ay1, bottom, height)
    ib, sb, first_b = _strips(by0, by1, bottom, height)
    # One sorted key per strip: strip * width + x, with a width no x range can bridge.
    left = float(min(ax0.min(), bx0.min()))
    width = 2.0 * (float(max(ax1.max(), bx1.max())) - left) + 1.0
    key_a, key_b = sa * width + (ax0[ia] - left), sb * width + (bx0[ib] - left)
    blur = 1e-15 * width * (float(max(sa.max(), sb.max())) + 2.0)
    last_a = key_a + (ax1 - ax0)[ia] + blur
    last_b = key_b + (bx1 - bx0)[ib] + blur

    def kept(i: Ints, j: Ints, strip: Ints) -> tuple[Ints, Ints]:
        # Boxes that share several strips are a pair in the first of them only.
        keep = strip == np.maximum(first_a[i], first_b[j])
        keep &= (ay0[i] <= by1[j]) & (by0[j] <= ay1[i])
        keep &= (ax0[i] <= bx1[j]) & (bx0[j] <= ax1[i])
        return _sorted([(i[keep], j[keep])], len(bx0))

    # A pair starts either inside a (b begins within a's x range) or inside b, never both.
    order = np.argsort(key_b)
    keys = key_b[order]
    low, high = np.searchsorted(keys, key_a), np.searchsorted(keys, last_a, "right")
    for first, last in _parts(high - low, most):
        row, k = expand(low[first:last], high[first:last])
        row += first
        yield kept(ia[row], ib[order[k]], sa[row])
    order = np.argsort(key_a)
    keys = key_a[order]
    low, high = np.searchsorted(keys, key_b, "right"), np.searchsorted(keys, last_b, "right")
    for first, last in _parts(high - low, most):
        row, k = expand(low[first:last], high[first:last])
        row += first
        yield kept(ia[order[k]], ib[row], sb[row])


def self_overlapping_parts(a: Boxes, most: int = ALL) -> Iterator[tuple[Ints, Ints]]:
    """Yield the pairs of `self_overlapping` as `overlapping_parts` does."""
    x0, y0, x1, y1 = a
    if len(x0) < 2:
        return
    bottom, left = float(y0.min()), float(x0.min())
    height = _height(bottom, float(y1.max()), y1 - y0)
    item, strip, first = _strips(y0, y1, bottom, height)
    width = 2.0 * (float(x1.max()) - left) + 1.0
    key = strip * width + (x0[item] - left)
    order = np.argsort(key)
    keys, item, strip = key[order], item[order], strip[order]
    blur = 1e-15 * width * (float(strip[-1]) + 2.0)
    last = keys + (x1 - x0)[item] + blur
    low, high = np.arange(1, len(keys) + 1), np.searchsorted(keys, last, "right")
    for begin, end in _parts(np.maximum(high - low, 0), most):
        row, k = expand(low[begin:end], high[begin:end])
        row += begin
        i, j = item[row], item[k]
        keep = strip[row] == np.maximum(first[i], first[j])
        keep &= (y0[i] <= y1[j]) & (y0[j] <= y1[i]) & (x0[j] <= x1[i]) & (x0[i] <= x1[j])
        i, j = i[keep], j[keep]
        yield _sorted([(np.minimum(i, j), np.maximum(i, j))], len(x0))


def least(values: Floats, of: Ints, count: int) -> Floats:
    """Return the least of ``values`` of each of ``count`` items (``of``, sorted); inf for none."""
    result = np.full(count, np.inf)
    if len(of):
        begin = np.flatnonzero(_changes(of))
        result[of[begin]] = np.minimum.reduceat(values, begin)
    return result


def _changes(of: Ints) -> NDArray[np.bool_]:
    """Return where a sorted array begins a new value."""
    change = np.ones(len(of), bool)
    np.not_equal(of[1:], of[:-1], out=change[1:])
    return change


def grow(a: Boxes, by: float) -> Boxes:
    """Return the boxes grown by ``by`` um on every side."""
    return a[0] - by, a[1] - by, a[2] + by, a[3] + by

"""Which boxes overlap: the sweep that keeps crossings and distances near-linear.

Boxes are put into horizontal strips, sorted by strip and left edge, and swept along x within each
strip. An R-tree (shapely.STRtree) was measured and buys nothing over this.
"""

from __future__ import annotations

import numpy as np

from wedmcam.geom.segments import Floats, Ints

Boxes = tuple[Floats, Floats, Floats, Floats]


def _strips(y0: Floats, height: float, low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Return (item, strip) for each strip that [low, high] of an item touches."""
    first = np.floor((low - y0) / height).astype(np.int64)
    last = np.floor((high - y0) / height).astype(np.int64)
    count = last - first + 1
    item = np.repeat(np.arange(len(low)), count)
    strip = np.arange(len(item)) - np.repeat(np.cumsum(count) - count, count) + first[item]
    return item, strip


def overlapping(a: Boxes, b: Boxes) -> tuple[Ints, Ints]:
    """Return index pairs (i, j) of boxes a[i] and b[j] that overlap or touch, sorted by i, j."""
    ax0, ay0, ax1, ay1 = a
    bx0, by0, bx1, by1 = b
    if not len(ax0) or not len(bx0):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    bottom = min(ay0.min(), by0.min())
    top = max(ay1.max(), by1.max())
    # A strip a few boxes high, and never so many strips that long boxes fill memory.
    mean = 0.5 * (float(np.mean(ay1 - ay0)) + float(np.mean(by1 - by0)))
    height = max(2.0 * mean, (top - bottom) / (4.0 * np.sqrt(len(ax0) + len(bx0)) + 16.0), 1e-9)
    origin = np.float64(bottom)
    ia, sa = _strips(origin, height, ay0, ay1)
    ib, sb = _strips(origin, height, by0, by1)
    # One sorted key per strip: strip * width + x, with a width no x range can bridge.
    left = min(ax0.min(), bx0.min())
    width = 2.0 * (max(ax1.max(), bx1.max()) - left) + 1.0
    first_a, first_b = sa * width + (ax0[ia] - left), sb * width + (bx0[ib] - left)
    last_a, last_b = sa * width + (ax1[ia] - left), sb * width + (bx1[ib] - left)
    # A pair starts either inside a (b begins within a's x range) or inside b, never both.
    i1, j1 = _sweep(ia, first_a, last_a, ib, first_b, sa, sb, "left")
    j2, i2 = _sweep(ib, first_b, last_b, ia, first_a, sb, sa, "right")
    i, j = np.concatenate([i1, i2]), np.concatenate([j1, j2])
    keep = (ay0[i] <= by1[j]) & (by0[j] <= ay1[i])
    code = np.unique(i[keep] * np.int64(len(bx0)) + j[keep])
    return code // len(bx0), code % len(bx0)


def _sweep(
    item: Ints,
    first: Floats,
    last: Floats,
    other: Ints,
    other_first: Floats,
    strip: Ints,
    other_strip: Ints,
    side: str,
) -> tuple[Ints, Ints]:
    """Return pairs (item, other) in which other begins within [first, last] of item."""
    order = np.argsort(other_first, kind="stable")
    keys = other_first[order]
    low = np.searchsorted(keys, first, side="left" if side == "left" else "right")
    high = np.searchsorted(keys, last, side="right")
    count = np.maximum(high - low, 0)
    rows = np.repeat(np.arange(len(item)), count)
    at = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count) + low[rows]
    partner = order[at]
    same = strip[rows] == other_strip[partner]
    return item[rows[same]], other[partner[same]]


def self_overlapping(a: Boxes) -> tuple[Ints, Ints]:
    """Return index pairs i < j of boxes that overlap or touch, sorted."""
    i, j = overlapping(a, a)
    keep = i < j
    return i[keep], j[keep]


def grown(a: Boxes, by: float) -> Boxes:
    """Return the boxes grown by ``by`` um on every side."""
    return a[0] - by, a[1] - by, a[2] + by, a[3] + by

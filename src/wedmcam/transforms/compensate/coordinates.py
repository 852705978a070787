"""Coordinates of the wire path's vertices, computed by the formulas over an `Arithmetic`.

What meets what was decided in float64 (``resolve``); here each vertex is computed once, from the
drawn figures, by the formula of its kind: the shifted end of a segment, the middle of two that
nearly meet, or the crossing of two shifted segments. All are measured from an end of the segment
and never from its centre, which may lie far away.
"""

from __future__ import annotations

import numpy as np

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.geom import formulas
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.transforms.compensate.raw import Raw, Source
from wedmcam.transforms.compensate.resolve import Loops
from wedmcam.transforms.shifted import Shifted

#: A crossing this far from the float64 one is not told from its neighbours by the arithmetic
#: (curves that all but touch): the float64 one stands, um.
UNSURE_UM = 1.0


def rounded(ar: Arithmetic, values: Floats) -> Floats:
    """Return values as the arithmetic holds them."""
    return values if ar is FLOAT64 else ar.to_float(ar.array(values))


def joints(
    ar: Arithmetic, segments: Segments, shift: Floats, following: Ints
) -> tuple[Floats, Floats]:
    """Return where each shifted segment starts: the middle of its start and the end before it.

    Args:
        ar: the arithmetic.
        segments: of closed contours.
        shift: to the left of each segment, um.
        following: the segment after each.
    """
    s = Shifted(ar, segments, shift)
    (ax, ay), (bx, by) = s.ends(np.arange(len(shift)), "01")
    x, y = np.empty(len(shift)), np.empty(len(shift))
    x[following], y[following] = bx, by
    return 0.5 * (x + ax), 0.5 * (y + ay)


def node_points(
    ar: Arithmetic, source: Source, raw: Raw, loops: Loops, nodes: Ints
) -> tuple[Floats, Floats]:
    """Return (x, y) of ``nodes`` (sorted, unique), um relative to the origin of ``source``."""
    n = len(raw.elements)
    s = Shifted(ar, source.segments, source.shift)
    x, y = loops.node_x[nodes].copy(), loops.node_y[nodes].copy()
    i, j = loops.node_i[nodes].copy(), loops.node_j[nodes].copy()

    # Ends of elements: a joint with the following one, or a loose end.
    ends = np.flatnonzero((i < 0) & (nodes < n))
    e = nodes[ends]
    f = raw.following[e]
    has_next = raw.joined[e]
    before = np.where(raw.transition[e], -1, raw.source[e])
    after = np.where(has_next & ~raw.transition[f], raw.source[f], -1)
    ax, ay = _ends(s, before, "1")
    bx, by = _ends(s, after, "0")
    both = (before >= 0) & (after >= 0)
    px = np.where(both, 0.5 * (ax + bx), np.where(before >= 0, ax, bx))
    py = np.where(both, 0.5 * (ay + by), np.where(before >= 0, ay, by))
    mitre = both & raw.prolonged[e]
    i[ends[mitre]], j[ends[mitre]] = e[mitre], f[mitre]
    plain = ~mitre & ((before >= 0) | (after >= 0))
    x[ends[plain]], y[ends[plain]] = px[plain], py[plain]

    loose = np.flatnonzero((i < 0) & (nodes >= n) & (nodes < 2 * n))
    of = nodes[loose] - n
    drawn = ~raw.transition[of]
    sx, sy = _ends(s, np.where(drawn, raw.source[of], -1), "0")
    x[loose[drawn]], y[loose[drawn]] = sx[drawn], sy[drawn]

    rows = np.flatnonzero(i >= 0)
    if len(rows):
        x[rows], y[rows] = _cross(s, raw, i[rows], j[rows], x[rows], y[rows])
    return x, y


def _ends(s: Shifted, rows: Ints, which: str) -> tuple[Floats, Floats]:
    x, y = np.zeros(len(rows)), np.zeros(len(rows))
    k = np.flatnonzero(rows >= 0)
    if len(k):
        ((x[k], y[k]),) = s.ends(rows[k], which)
    return x, y


def _cross(
    s: Shifted, raw: Raw, i: Ints, j: Ints, near_x: Floats, near_y: Floats
) -> tuple[Floats, Floats]:
    """Return the crossings of elements i and j that lie near (near_x, near_y)."""
    kind_i, kind_j = _kinds(s, raw, i, near_x, near_y), _kinds(s, raw, j, near_x, near_y)
    x, y = near_x.copy(), near_y.copy()
    kinds = kind_i * _KINDS + kind_j
    for kind in np.flatnonzero(np.bincount(kinds)).tolist():
        k = np.flatnonzero(kinds == kind)
        one = s.curves(raw.source[i[k]], *_SEEN[kind // _KINDS])
        two = s.curves(raw.source[j[k]], *_SEEN[kind % _KINDS])
        nx, ny = near_x[k], near_y[k]
        best = np.full(len(k), UNSURE_UM)
        for px, py in formulas.meeting(s.ar, one, two):
            fx, fy = s.ar.to_float(px), s.ar.to_float(py)
            off = np.hypot(fx - nx, fy - ny)
            nearer = off < best
            best[nearer] = off[nearer]
            nx[nearer], ny[nearer] = fx[nearer], fy[nearer]
        x[k], y[k] = nx, ny
    return x, y


#: How a curve is seen: (an arc was drawn, a transition arc after the segment, from which end).
_SEEN = [(arc, corner, end) for arc in (False, True) for corner in (False, True) for end in "01"]
_KINDS = len(_SEEN)


def _kinds(s: Shifted, raw: Raw, e: Ints, x: Floats, y: Floats) -> Ints:
    """Return the row of `_SEEN` for elements, seen from the end that is nearer to (x, y)."""
    rows, corner, d = raw.source[e], raw.transition[e], s.segments
    to_end = np.hypot(x - d.x1[rows], y - d.y1[rows])
    from_end = corner | (to_end < np.hypot(x - d.x0[rows], y - d.y0[rows]))
    return np.asarray(4 * (d.turn[rows] != 0) + 2 * corner + from_end, np.int64)

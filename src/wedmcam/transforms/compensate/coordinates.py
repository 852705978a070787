"""Coordinates of the wire path's vertices, computed by the formulas over an `Arithmetic`.

What meets what was decided in float64 (``resolve``); here each vertex is computed once, from the
drawn figures, by the formula of its kind: the shifted end of a segment, the middle of two that
nearly meet, or the crossing of two shifted segments.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import Arithmetic
from wedmcam.geom import formulas
from wedmcam.geom.segments import Floats, Ints
from wedmcam.transforms.compensate.raw import SNAP_UM, Raw, Source
from wedmcam.transforms.compensate.resolve import Loops

Pair = tuple[Any, Any]


class _Shifted:
    """The drawn segments and their shifts in an arithmetic; asked for rows, gives points."""

    def __init__(self, ar: Arithmetic, source: Source) -> None:
        self.ar = ar
        self.source = source

    def columns(self, rows: Ints, *names: str) -> list[Any]:
        return [self.ar.array(getattr(self.source.segments, name)[rows]) for name in names]

    def shift(self, rows: Ints) -> Any:
        return self.ar.array(self.source.shift[rows])

    def direction(self, rows: Ints) -> Pair:
        """Unit direction of drawn lines."""
        x0, y0, x1, y1 = self.columns(rows, "x0", "y0", "x1", "y1")
        return formulas.unit(self.ar, x1 - x0, y1 - y0)

    def radius(self, rows: Ints) -> Any:
        """Radius of shifted arcs."""
        r = self.ar.array(self.source.segments.radius[rows])
        turn = self.ar.array(self.source.segments.turn[rows].astype(float))
        return r - self.shift(rows) * turn

    def end(self, rows: Ints, which: str) -> tuple[Floats, Floats]:
        """Shifted start ("0") or end ("1") of drawn segments."""
        ar, s = self.ar, self.source.segments
        x, y = np.empty(len(rows)), np.empty(len(rows))
        for arc in (False, True):
            k = np.flatnonzero((s.turn[rows] != 0) == arc)
            if not len(k):
                continue
            of = rows[k]
            vx, vy = self.columns(of, "x" + which, "y" + which)
            if arc:
                cx, cy = self.columns(of, "cx", "cy")
                px, py = formulas.on_circle(ar, (cx, cy), (vx, vy), self.radius(of))
            else:
                ux, uy = self.direction(of)
                px, py = formulas.shifted(ar, (vx, vy), (-uy, ux), self.shift(of))
            x[k], y[k] = ar.to_float(px), ar.to_float(py)
        return x, y


def node_points(
    ar: Arithmetic, source: Source, raw: Raw, found: Loops, nodes: Ints
) -> tuple[Floats, Floats]:
    """Return (x, y) of ``nodes`` (sorted, unique), um relative to the origin of ``source``."""
    n = len(raw.elements)
    s = _Shifted(ar, source)
    x, y = found.node_x[nodes].copy(), found.node_y[nodes].copy()
    i, j = found.node_i[nodes].copy(), found.node_j[nodes].copy()

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
    # A prolonged corner is a crossing of the two, far from either end.
    mitre = both & (np.hypot(px - x[ends], py - y[ends]) > SNAP_UM)
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


def _ends(s: _Shifted, rows: Ints, which: str) -> tuple[Floats, Floats]:
    x, y = np.zeros(len(rows)), np.zeros(len(rows))
    k = np.flatnonzero(rows >= 0)
    if len(k):
        x[k], y[k] = s.end(rows[k], which)
    return x, y


def _cross(
    s: _Shifted, raw: Raw, i: Ints, j: Ints, near_x: Floats, near_y: Floats
) -> tuple[Floats, Floats]:
    """Return the crossings of elements i and j that lie near (near_x, near_y)."""
    ar = s.ar
    arc_i, arc_j = raw.elements.turn[i] != 0, raw.elements.turn[j] != 0
    swap = arc_i & ~arc_j  # the line first
    i, j = np.where(swap, j, i), np.where(swap, i, j)
    arc_i, arc_j = arc_i & ~swap, arc_j | swap
    x, y = near_x.copy(), near_y.copy()
    for first, second in ((False, False), (False, True), (True, True)):
        k = np.flatnonzero((arc_i == first) & (arc_j == second))
        if not len(k):
            continue
        a, b = i[k], j[k]
        if not first:
            p, u = _line(s, raw, a)
            if not second:
                q, v = _line(s, raw, b)
                px, py = formulas.line_line(ar, p, u, q, v)
            else:
                c, r = _circle(s, raw, b)
                along = (near_x[k] - raw.elements.cx[b]) * raw.elements.ux[a]
                along += (near_y[k] - raw.elements.cy[b]) * raw.elements.uy[a]
                root = ar.array(np.where(along >= 0, 1.0, -1.0))
                px, py = formulas.line_circle(ar, p, u, c, r, root)
        else:
            c, r = _circle(s, raw, a)
            d, t = _circle(s, raw, b)
            e = raw.elements
            left = (e.cx[b] - e.cx[a]) * (near_y[k] - e.cy[a])
            left -= (e.cy[b] - e.cy[a]) * (near_x[k] - e.cx[a])
            root = ar.array(np.where(left >= 0, 1.0, -1.0))
            px, py = formulas.circle_circle(ar, c, r, d, t, root)
        x[k], y[k] = ar.to_float(px), ar.to_float(py)
    return x, y


def _line(s: _Shifted, raw: Raw, e: Ints) -> tuple[Pair, Pair]:
    """A point and the unit direction of shifted lines."""
    rows = raw.source[e]
    u = s.direction(rows)
    x0, y0 = s.columns(rows, "x0", "y0")
    return formulas.shifted(s.ar, (x0, y0), (-u[1], u[0]), s.shift(rows)), u


def _circle(s: _Shifted, raw: Raw, e: Ints) -> tuple[Pair, Any]:
    """Centre and radius of shifted or transition arcs."""
    ar, rows = s.ar, raw.source[e]
    transition: NDArray[np.bool_] = raw.transition[e]
    src = s.source.segments
    cx = ar.array(np.where(transition, src.x1[rows], src.cx[rows]))
    cy = ar.array(np.where(transition, src.y1[rows], src.cy[rows]))
    r = ar.where(transition, ar.array(np.abs(s.source.shift[rows])), s.radius(rows))
    return (cx, cy), r

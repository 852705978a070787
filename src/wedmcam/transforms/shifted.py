"""Drawn segments shifted sideways, computed in an `Arithmetic`: ends, normals, curves.

Compensation shifts by the offset, rounding a corner by the radius of its arc. All is measured from
an end of the segment and never from its centre: of a centre 10 m away 8 digits keep 1 um.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.geom import formulas
from wedmcam.geom.segments import Floats, Ints, Segments

Pair = tuple[Any, Any]


class Shifted:
    """The drawn segments and their shifts in an arithmetic; asked for rows, gives points."""

    def __init__(self, ar: Arithmetic, segments: Segments, shift: Floats) -> None:
        self.ar = ar
        self.segments = segments
        self.shift = shift

    def columns(self, rows: Ints, *names: str) -> list[Any]:
        """Return columns of drawn segments in the arithmetic."""
        return [self.ar.array(getattr(self.segments, name)[rows]) for name in names]

    def normals(self, rows: Ints, arc: bool, ends: str) -> list[tuple[Pair, Pair]]:
        """Return (end, left normal there) for each of ``ends``, of segments all arcs or lines."""
        ar, s = self.ar, self.segments
        places = [tuple(self.columns(rows, "x" + which, "y" + which)) for which in ends]
        # Differences are rounded, not taken of rounded ends: a segment of a micron has a direction.
        if not arc:
            dx, dy = s.x1[rows] - s.x0[rows], s.y1[rows] - s.y0[rows]
            ux, uy = formulas.unit(ar, ar.array(dx), ar.array(dy))
            return [((x, y), (-uy, ux)) for x, y in places]
        turn = ar.array(s.turn[rows].astype(float))
        out = []
        for which, place in zip(ends, places, strict=True):
            dx = s.cx[rows] - getattr(s, "x" + which)[rows]
            dy = s.cy[rows] - getattr(s, "y" + which)[rows]
            nx, ny = formulas.unit(ar, ar.array(dx), ar.array(dy))
            out.append((place, (nx * turn, ny * turn)))
        return out

    def ends(self, rows: Ints, which: str) -> list[tuple[Floats, Floats]]:
        """Return the shifted starts ("0"), ends ("1") or both ("01") of drawn segments."""
        out = [(np.empty(len(rows)), np.empty(len(rows))) for _ in which]
        is_arc = self.segments.turn[rows] != 0
        for arc in (False, True):
            k = np.flatnonzero(is_arc == arc)
            if not len(k):
                continue
            by = self.ar.array(self.shift[rows[k]])
            for (x, y), (p, n) in zip(out, self.normals(rows[k], arc, which), strict=True):
                px, py = formulas.shifted(self.ar, p, n, by)
                x[k], y[k] = self.ar.to_float(px), self.ar.to_float(py)
        return out

    def curves(self, rows: Ints, arc: bool, corner: bool, which: str) -> formulas.Curve:
        """Return shifted segments, or the transition arcs after them, as seen from one end."""
        ar = self.ar
        ((p, n),) = self.normals(rows, arc, which)
        by = ar.array(self.shift[rows])
        if corner:
            curvature = -1 / by
        elif arc:
            (radius,) = self.columns(rows, "radius")
            turn = ar.array(self.segments.turn[rows].astype(float))
            curvature = turn / (radius - by * turn)
        else:
            curvature = by - by
        return formulas.Curve(formulas.shifted(ar, p, n, by), n, curvature)

    def feet(self, rows: Ints, arc: bool, shifted: Pair) -> Pair:
        """Return the points of drawn segments that lie beside points of the shifted ones."""
        ar = self.ar
        if arc:
            cx, cy = self.columns(rows, "cx", "cy")
            turn = ar.array(self.segments.turn[rows].astype(float))
            nx, ny = formulas.unit(ar, cx - shifted[0], cy - shifted[1])
            n = nx * turn, ny * turn
        else:
            ((_, n),) = self.normals(rows, arc, "0")
        return formulas.shifted(ar, shifted, n, -ar.array(self.shift[rows]))

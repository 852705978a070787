"""Neighbouring arcs of one circle become one arc, and a circle drawn in pieces one circle.

CAD programs cut circles into halves and quarters; the machine takes them whole.
"""

from __future__ import annotations

import numpy as np

from wedmcam.geom import segments as seg
from wedmcam.ir.contour import VERTEX, Contour

#: Two arcs lie on one circle when centres and radii agree this well; um.
SAME_CIRCLE_UM = 1e-3


def merge_arcs(contour: Contour) -> Contour:
    """Return the contour with neighbouring arcs of one circle merged.

    The direction is kept, and the first vertex unless it lies inside a merged arc. A whole circle
    starts at its right-most point. A merged arc has the source of its first piece.
    """
    v = contour.starts
    n = len(v)
    s = seg.of_rows(contour.starts, contour.ends)
    k = np.roll(np.arange(n), -1)
    same = (
        (s.turn != 0)
        & (s.turn == s.turn[k])
        & (np.hypot(s.cx - s.cx[k], s.cy - s.cy[k]) < SAME_CIRCLE_UM)
        & (np.abs(s.radius - s.radius[k]) < SAME_CIRCLE_UM)
    )
    if not contour.closed:
        same[-1] = False
    if n == 1 or not same.any():
        return contour
    if contour.closed and same.all():
        row = np.zeros(1, VERTEX)
        row[0] = v[0]
        row["x"], row["y"] = s.cx[0] + s.radius[0], s.cy[0]
        return Contour(row, True, contour.sources)
    # A vertex goes where the segment before it and the one it opens are one.
    keep = ~np.roll(same, 1)
    rows = contour.vertices
    if contour.closed:
        return Contour(rows[keep].copy(), True, contour.sources)
    return Contour(rows[np.append(keep, True)].copy(), False, contour.sources)

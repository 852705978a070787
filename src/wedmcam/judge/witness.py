"""A second opinion by another library: the swept wire against the kept material, in polygons.

shapely knows no arcs, so both sides are chords fine enough to cost 0.05 um. It is slow, and asked
where an answer independent of the formulas in ``segments`` is worth that: in tests and on request.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan, Side
from wedmcam.judge.segments import Floats, of_contour, points_at

#: Largest distance between an arc and its chords, um.
SAGITTA = 0.05


def ring(contour: Contour) -> Floats:
    """Return the vertices of a contour with arcs as chords, shape (n, 2), um."""
    s = of_contour(contour)
    count = np.ones(len(s), np.int64)
    arc = s.turn != 0
    step = 2.0 * np.arccos(np.clip(1.0 - SAGITTA / np.maximum(s.radius[arc], SAGITTA), -1.0, 1.0))
    count[arc] = np.maximum(np.ceil(2.0 * s.half[arc] / step), 4)
    which = np.repeat(np.arange(len(s)), count)
    part = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    x, y = points_at(s.take(which), s.length[which] * part / count[which])
    return np.column_stack([x, y])


def kept_polygon(plan: Plan) -> Any:
    """Return the kept material as a shapely geometry; of a die a frame of ten offsets round it."""
    import shapely

    inside: Any = shapely.Polygon()
    for contour in plan.outlines:
        if contour.closed:
            inside = inside.symmetric_difference(shapely.Polygon(ring(contour)))
    if plan.side is Side.PART:
        return inside
    x0, y0, x1, y1 = inside.bounds
    rim = 10.0 * plan.offset_um + 1000.0
    return shapely.box(x0 - rim, y0 - rim, x1 + rim, y1 + rim).difference(inside)


def swept_gouge(plan: Plan, places: Floats) -> float:
    """Return how deep a wire at ``places``, shape (n, 2) um, enters the kept material; 0 if not.

    Within 0.1 um of the exact figure.
    """
    import shapely

    kept = kept_polygon(plan)
    points = shapely.points(places)
    shapely.prepare(kept)
    d = shapely.distance(points, kept)
    within = shapely.contains(kept, points)
    deep = np.where(within, shapely.distance(points, shapely.boundary(kept)), -d)
    return float(max(0.0, (deep + plan.offset_um).max()))

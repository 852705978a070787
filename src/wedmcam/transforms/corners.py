"""``--corner``: rounding the part's own sharp corners, so that punch and die of one outline fit.

The wire cannot cut a sharp inner corner. Where the outline itself is rounded by at least the
offset, punch and die have the same corners.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, error
from wedmcam.geom import formulas
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Segments
from wedmcam.ir.contour import VERTEX, Contour

#: A turn below this is a tangent joint: 1 um over 1 mm (radians).
TANGENT = 1e-3


def round_corners(
    contours: Sequence[Contour], radius_um: float, arithmetic: Arithmetic = FLOAT64
) -> tuple[list[Contour], list[Diagnostic]]:
    """Return the contours with every sharp corner replaced by a tangent arc of ``radius_um``.

    Inner and outer corners alike; tangent joints stay. The arc takes the source of the segment
    before it. A corner whose neighbours are too short for the arc is an error that names it.
    """
    result, found = [], []
    for contour in contours:
        rounded, problems = _round(contour, radius_um, arithmetic)
        result.append(rounded)
        found += problems
    return result, found


def _round(contour: Contour, radius: float, ar: Arithmetic) -> tuple[Contour, list[Diagnostic]]:
    s = seg.of_rows(contour.starts, contour.ends)
    n = len(s)
    nxt = np.roll(np.arange(n), -1)
    t1x, t1y = seg.end_tangents(s)
    t0x, t0y = seg.start_tangents(s)
    cross = t1x * t0y[nxt] - t1y * t0x[nxt]
    dot = t1x * t0x[nxt] + t1y * t0y[nxt]
    sharp = np.abs(np.arctan2(cross, dot)) > TANGENT
    if not contour.closed:
        sharp[-1] = False
    if not sharp.any():
        return contour, []
    found: list[Diagnostic] = []
    begin, end = np.zeros(n), s.length.copy()
    arcs: dict[int, tuple[float, float, int]] = {}
    for i in np.flatnonzero(sharp).tolist():
        k = int(nxt[i])
        side = 1.0 if cross[i] > 0 else -1.0
        centre = _centre(s, i, k, side * radius, ar)
        if centre is not None:
            at_i = _foot(s, i, centre)
            at_k = _foot(s, k, centre)
            if 0.0 <= at_i < s.length[i] and 0.0 < at_k <= s.length[k]:
                end[i], begin[k] = at_i, at_k
                arcs[i] = (centre[0], centre[1], int(side))
                continue
        found.append(_too_large(contour, s, i, radius))
    for i in np.flatnonzero(begin > end + 1e-6).tolist():
        found.append(_too_large(contour, s, i, radius))
    if found:
        return contour, found
    rows = []
    x0, y0 = seg.points_at(s, begin)
    x1, y1 = seg.points_at(s, end)
    v = contour.vertices
    for i in range(n):
        source = int(v["source"][i])
        start = (s.x0[i], s.y0[i]) if begin[i] == 0.0 else (x0[i], y0[i])
        if end[i] - begin[i] > 1e-6:
            rows.append((*start, s.cx[i], s.cy[i], int(s.turn[i]), source))
        if i in arcs:
            cx, cy, turn = arcs[i]
            rows.append((x1[i], y1[i], cx, cy, turn, source))
    if not contour.closed:
        rows.append((s.x1[-1], s.y1[-1], 0.0, 0.0, 0, -1))
    return Contour(np.array(rows, VERTEX), contour.closed, contour.sources), []


def _centre(
    s: Segments, i: int, k: int, shift: float, ar: Arithmetic
) -> tuple[float, float] | None:
    """Return the centre of the arc tangent to segments i and k, on the inner side of the corner.

    It lies where the two, shifted by the radius, cross; of two crossings the one nearest to the
    corner counts.
    """
    vx, vy = float(s.x1[i]), float(s.y1[i])

    def column(value: float) -> object:
        return ar.array(np.array([value]))

    def line(m: int) -> tuple[object, ...]:
        ux, uy = float(s.ux[m]), float(s.uy[m])
        px, py = float(s.x0[m]) - vx - shift * uy, float(s.y0[m]) - vy + shift * ux
        return (column(px), column(py)), (column(ux), column(uy))

    def circle(m: int) -> tuple[tuple[object, object], float]:
        centre = (column(float(s.cx[m]) - vx), column(float(s.cy[m]) - vy))
        return centre, float(s.radius[m] - shift * s.turn[m])

    arc_i, arc_k = s.turn[i] != 0, s.turn[k] != 0
    points = []
    if not arc_i and not arc_k:
        p, u = line(i)
        q, w = line(k)
        points.append(formulas.line_line(ar, p, u, q, w))  # type: ignore[arg-type]
    elif arc_i != arc_k:
        p, u = line(k if arc_i else i)
        c, r = circle(i if arc_i else k)
        if r <= 0:
            return None
        for root in (1.0, -1.0):
            points.append(
                formulas.line_circle(ar, p, u, c, column(r), column(root))  # type: ignore[arg-type]
            )
    else:
        c, r = circle(i)
        d, t = circle(k)
        if r <= 0 or t <= 0:
            return None
        for root in (1.0, -1.0):
            points.append(formulas.circle_circle(ar, c, column(r), d, column(t), column(root)))
    found = [(float(ar.to_float(x)[0]), float(ar.to_float(y)[0])) for x, y in points]
    x, y = min(found, key=lambda p: (p[0] ** 2 + p[1] ** 2, p))
    x, y = x + vx, y + vy
    # The centre must really be at the radius from both (a miss gives the nearest point instead).
    for m in (i, k):
        if s.turn[m] != 0:
            off = abs(np.hypot(x - s.cx[m], y - s.cy[m]) - (s.radius[m] - shift * s.turn[m]))
        else:
            across = (y - s.y0[m]) * s.ux[m] - (x - s.x0[m]) * s.uy[m]
            off = abs(across - shift)
        if not off < 1e-3:
            return None
    return x, y


def _foot(s: Segments, m: int, centre: tuple[float, float]) -> float:
    one = s.take(np.array([m]))
    return float(seg.position_of(one, np.array([centre[0]]), np.array([centre[1]]))[0])


def _too_large(contour: Contour, s: Segments, i: int, radius: float) -> Diagnostic:
    x, y = float(s.x1[i]) / 1000, float(s.y1[i]) / 1000
    return error(
        "corner-too-large",
        f"the corner at ({x:.3f}, {y:.3f}) mm cannot be rounded with {radius / 1000:.3f} mm: its "
        f"neighbours are too short ({s.length[i] / 1000:.3f} mm)",
        contour.source_of(i),
        points_mm=((x, y),),
        hint="a smaller --corner",
    )

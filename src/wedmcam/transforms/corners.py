"""``--corner``: rounding the part's own sharp corners, so that punch and die of one outline fit.

The wire cannot cut a sharp inner corner. Where the outline itself is rounded by at least the
offset, punch and die have the same corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, Place, error
from wedmcam.geom import formulas
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.shifted import Shifted

#: A centre farther than this from where it belongs is none: 8 digits of 10 m are 1 um.
MISS_UM = 1.0


def round_corners(
    contours: Sequence[Contour], radius_um: float, arithmetic: Arithmetic = FLOAT64
) -> tuple[list[Contour], list[Diagnostic]]:
    """Return the contours with every sharp corner replaced by a tangent arc of ``radius_um``.

    Inner and outer corners alike; tangent joints stay. The arc takes the source of the segment
    before it. A corner whose neighbours are too short for the arc is an error that names it.
    """
    result, findings = [], []
    for contour in contours:
        rounded, problems = _round(contour, radius_um, arithmetic)
        result.append(rounded)
        findings += problems
    return result, findings


def _round(contour: Contour, radius: float, ar: Arithmetic) -> tuple[Contour, list[Diagnostic]]:
    v = contour.vertices
    ox, oy = (float(np.round(0.5 * (v[k].min() + v[k].max()))) for k in ("x", "y"))
    a, b = contour.starts, contour.ends
    s = seg.make(a["x"] - ox, a["y"] - oy, b["x"] - ox, b["y"] - oy, a["cx"] - ox, a["cy"] - oy,
                 a["turn"].copy())  # fmt: skip
    n = len(s)
    nxt = np.roll(np.arange(n), -1)
    t1x, t1y = seg.end_tangents(s)
    t0x, t0y = seg.start_tangents(s)
    cross = t1x * t0y[nxt] - t1y * t0x[nxt]
    dot = t1x * t0x[nxt] + t1y * t0y[nxt]
    # At a full reversal the sign comes from the bends.
    bend = s.turn / np.where(s.turn != 0, s.radius, 1.0)
    back = (dot < 0) & (np.abs(cross) < 1e-6)
    cross = np.where(back, -(bend + bend[nxt]), cross)
    sharp = (np.abs(np.arctan2(cross, dot)) > seg.TANGENT) | back
    if not contour.closed:
        sharp[-1] = False
    i = np.flatnonzero(sharp)
    if not len(i):
        return contour, []
    k = nxt[i]
    side = np.where(cross[i] > 0, 1.0, -1.0)
    arcs = _arcs(s, i, k, side * radius, ar)
    at_i = seg.position_of(s.take(i), arcs.x0, arcs.y0)
    at_k = seg.position_of(s.take(k), arcs.x1, arcs.y1)
    fits = arcs.good & (at_i >= 0.0) & (at_i < s.length[i])
    fits &= (at_k > 0.0) & (at_k <= s.length[k])
    begin, end = np.zeros(n), s.length.copy()
    end[i[fits]], begin[k[fits]] = at_i[fits], at_k[fits]
    wrong = [*i[~fits].tolist(), *np.flatnonzero(begin > end + 1e-6).tolist()]
    if wrong:
        return contour, [_too_large(contour, s, m, radius, (ox, oy)) for m in wrong]
    # Each segment from where the arc before leaves it, then the arc after it; what was not touched
    # stays to the digit.
    rows = np.zeros((n, 2), VERTEX)
    rows[:, 0] = a
    rows["source"][:, 1] = a["source"]
    rows["x"][k, 0], rows["y"][k, 0] = arcs.x1 + ox, arcs.y1 + oy
    rows["x"][i, 1], rows["y"][i, 1] = arcs.x0 + ox, arcs.y0 + oy
    rows["cx"][i, 1], rows["cy"][i, 1] = arcs.cx + ox, arcs.cy + oy
    rows["turn"][i, 1] = side
    rounded = rows[np.stack([end - begin > 1e-6, sharp], axis=1)]
    if not contour.closed:
        rounded = np.concatenate([rounded, v[-1:]])
    return Contour(rounded, contour.closed, contour.sources), []


@dataclass(frozen=True, slots=True, eq=False)
class _Arcs:
    """Arcs of the corners: start, end, centre, and whether it touches both neighbours."""

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    good: NDArray[np.bool_]


def _arcs(s: Segments, i: Ints, k: Ints, shift: Floats, ar: Arithmetic) -> _Arcs:
    """Return the arcs tangent to segments i and k, on the inner side of their corner.

    The centre lies where the two, shifted by the radius, cross.
    """
    x0, y0, x1, y1, cx, cy = np.zeros((6, len(i)))
    out = _Arcs(x0, y0, x1, y1, cx, cy, np.zeros(len(i), bool))
    before, after = s.take(i), s.take(k)
    one, two = Shifted(ar, before, shift), Shifted(ar, after, shift)
    left = [(m.turn == 0) | (m.radius > shift * m.turn) for m in (before, after)]
    tangents = zip(seg.start_tangents(after), seg.end_tangents(before), strict=True)
    into = [leaving - arriving for leaving, arriving in tangents]
    for first, second in ((False, False), (False, True), (True, False), (True, True)):
        m = np.flatnonzero(((before.turn != 0) == first) & ((after.turn != 0) == second))
        m = m[left[0][m] & left[1][m]]
        if not len(m):
            continue
        near, far = formulas.meeting(
            ar, one.curves(m, first, False, "1"), two.curves(m, second, False, "0")
        )
        # On the side of the corner to which the path turns back, and there the nearest.
        bx, by = into[0][m], into[1][m]
        away = []
        for x, y in (near, far):
            px, py = ar.to_float(x) - before.x1[m], ar.to_float(y) - before.y1[m]
            away.append(np.hypot(px, py) + np.where(px * bx + py * by < 0, 1e9, 0.0))
        nearer = away[0] <= away[1]
        centre = ar.where(nearer, near[0], far[0]), ar.where(nearer, near[1], far[1])
        for (x, y), at in (
            ((out.cx, out.cy), centre),
            ((out.x0, out.y0), one.feet(m, first, centre)),
            ((out.x1, out.y1), two.feet(m, second, centre)),
        ):
            x[m], y[m] = ar.to_float(at[0]), ar.to_float(at[1])
    # The centre must really be at the radius from both (a miss gives the nearest point instead).
    out.good[:] = left[0] & left[1]
    for drawn in (before, after):
        out.good[:] &= _off(drawn, shift, out.cx, out.cy) < MISS_UM
    return out


def _off(s: Segments, shift: Floats, x: Floats, y: Floats) -> Floats:
    """Return how far points are from segments that were shifted and prolonged."""
    to_arc = np.hypot(x - s.cx, y - s.cy) - (s.radius - shift * s.turn)
    to_line = (y - s.y0) * s.ux - (x - s.x0) * s.uy - shift
    return np.abs(np.where(s.turn != 0, to_arc, to_line))


def _too_large(
    contour: Contour, s: Segments, i: int, radius: float, origin: tuple[float, float]
) -> Diagnostic:
    corner = Place.of_um(s.x1[i] + origin[0], s.y1[i] + origin[1])
    return error(
        "corner-too-large",
        "the corner at {corner} cannot be rounded with {radius_mm:.3f} mm: its neighbours are too "
        "short ({length_mm:.3f} mm)",
        contour.source_of(i),
        points_mm=(corner,),
        hint="a smaller --corner",
        corner=corner,
        radius_mm=radius / 1000,
        length_mm=float(s.length[i]) / 1000,
    )

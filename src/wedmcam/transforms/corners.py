"""``--corner``: rounding the part's own sharp corners, so that punch and die of one outline fit.

The wire cannot cut a sharp inner corner. Where the outline itself is rounded by at least the
offset, punch and die have the same corners. ``--corners paper`` does so as the ZD-065's gap
compensation does: arcs where a line meets a line or an arc, none between arcs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, Place, error, note, warning
from wedmcam.geom import formulas
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.shifted import Shifted

#: A centre farther than this from where it belongs is none: 8 digits of 10 m are 1 um.
MISS_UM = 1.0
#: A corner has no transition arc where the radius times its turn is less than this, um: its
#: neighbours are joined where they meet.
JOINED_UM = 2.0
#: Below this interior angle, degrees, arcs of the offsets f and f - z leave less than 0 of the
#: clearance z, which is z (2 - 1 / sin(angle / 2)) there.
ACUTE_DEG = 60.0
#: Corners that are listed one by one.
LISTED_CORNERS = 10
#: Halvings of the interval in which the largest radius is looked for.
LARGEST_ROUNDS = 40


def round_corners(
    contours: Sequence[Contour], radius_um: float, arithmetic: Arithmetic = FLOAT64
) -> tuple[list[Contour], list[Diagnostic]]:
    """Return the contours with every sharp corner replaced by a tangent arc of ``radius_um``.

    Inner and outer corners alike; tangent joints stay. The arc takes the source of the segment
    before it. A corner whose neighbours are too short for the arc is an error that names it.
    """
    result, findings = [], []
    for contour in contours:
        corners = _Corners.of(contour)
        rounded, problems = _round(corners, corners.sharp, radius_um, arithmetic)
        result.append(rounded)
        findings += problems
    return result, findings


def transition_arcs(
    contours: Sequence[Contour],
    radius_um: float,
    arithmetic: Arithmetic = FLOAT64,
    *,
    acute: bool = False,
) -> tuple[list[Contour], list[Diagnostic]]:
    """Return the contours with an arc at each corner where a line meets a line or an arc.

    The rule of the ZD-065's gap compensation (过渡圆), for punch and die alike. Corners between
    arcs stay, and so do those at which the path turns by less than `JOINED_UM` / radius.

    Args:
        contours: um.
        radius_um: of the arcs, > 0: at least the largest offset of punch and die.
        arithmetic: in which the arcs are computed.
        acute: warn of corners at which punch and die part where the radius of each is its offset.

    Returns:
        The contours, a note of what became of the corners, and an error for each one that cannot
        have its arc, with the largest radius that it can have.

    Source: the ZD-065 paper, gap compensation [S]; one radius for the pair is our reading [R].
    """
    result, findings = [], []
    count = np.zeros(3, np.int64)
    acutes: list[tuple[float, Contour, int]] = []
    for contour in contours:
        corners = _Corners.of(contour)
        joined = corners.sharp & (radius_um * corners.turning < JOINED_UM)
        between = corners.sharp & ~joined & corners.between_arcs
        rows = corners.sharp & ~joined & ~between
        rounded, problems = _round(corners, rows, radius_um, arithmetic)
        result.append(rounded)
        findings += problems
        count += [np.count_nonzero(m) for m in (rows, joined, between)]
        angle = 180.0 - np.degrees(corners.turning)
        sharpest = np.flatnonzero(rows & (angle < ACUTE_DEG)).tolist()
        acutes += [(float(angle[k]), contour, k) for k in sharpest]
    if findings:
        return result, findings
    if acute and acutes:
        findings.append(_acute(acutes, radius_um))
    if count.any():
        findings.append(_arcs_made(count.tolist(), radius_um))
    return result, findings


def _arcs_made(count: Sequence[int], radius: float) -> Diagnostic:
    arcs, joined, between = count
    finding = note(
        "transition-arcs",
        "1 corner of the outline has an arc of {radius_mm:.3f} mm"
        if arcs == 1
        else "{arcs} corners of the outline have an arc of {radius_mm:.3f} mm",
        hint="cut punch and die with the same --corner: both then have these arcs",
        arcs=arcs,
        radius_mm=radius / 1000,
    )
    if between:
        finding = finding.extended(
            "; between arcs, where the offset arcs are intersected: {between}", between=between
        )
    if joined:
        finding = finding.extended("; nearly tangent, and joined: {joined}", joined=joined)
    return finding


def _acute(acutes: Sequence[tuple[float, Contour, int]], radius: float) -> Diagnostic:
    angle, contour, k = min(acutes, key=lambda item: item[0])
    end = contour.ends[k]
    corner = Place.of_um(end["x"], end["y"])
    return warning(
        "acute-corner",
        "the corner of {angle_deg:.1f} degrees at {corner} has an arc of {radius_mm:.3f} mm, the "
        "offset: cut so with another offset, the die is too narrow or too wide for the punch there"
        if len(acutes) == 1
        else "{count} corners below {least_deg:.0f} degrees, the sharpest of {angle_deg:.1f} at "
        "{corner}, have arcs of {radius_mm:.3f} mm, the offset: cut so with another offset, the "
        "die is too narrow or too wide for the punch there",
        contour.source_of(k),
        points_mm=(corner,),
        hint="--corner {radius_mm:.3f}mm for punch and die alike, or more: the larger of their two "
        "offsets at least",
        count=len(acutes),
        least_deg=ACUTE_DEG,
        angle_deg=angle,
        corner=corner,
        radius_mm=radius / 1000,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Corners:
    """Where a contour turns: between each segment and the next.

    Attributes:
        contour: as drawn.
        segments: its segments, um relative to ``origin``.
        origin: a whole-um point near them.
        following: the next segment of each.
        cross: left turns > 0, right ones < 0; with the sign of the bends where it turns back.
        turning: by how much, radians >= 0.
        sharp: whether it is a corner at all.
        between_arcs: whether both are arcs.
    """

    contour: Contour
    segments: Segments
    origin: tuple[float, float]
    following: Ints
    cross: Floats
    turning: Floats
    sharp: NDArray[np.bool_]
    between_arcs: NDArray[np.bool_]

    @classmethod
    def of(cls, contour: Contour) -> _Corners:
        """Return the corners of a contour."""
        v = contour.vertices
        ox, oy = (float(np.round(0.5 * (v[k].min() + v[k].max()))) for k in ("x", "y"))
        a, b = contour.starts, contour.ends
        s = seg.make(a["x"] - ox, a["y"] - oy, b["x"] - ox, b["y"] - oy, a["cx"] - ox,
                     a["cy"] - oy, a["turn"].copy())  # fmt: skip
        nxt = np.roll(np.arange(len(s)), -1)
        t1x, t1y = seg.end_tangents(s)
        t0x, t0y = seg.start_tangents(s)
        cross = t1x * t0y[nxt] - t1y * t0x[nxt]
        dot = t1x * t0x[nxt] + t1y * t0y[nxt]
        # At a full reversal the sign comes from the bends.
        bend = s.turn / np.where(s.turn != 0, s.radius, 1.0)
        back = (dot < 0) & (np.abs(cross) < 1e-6)
        cross = np.where(back, -(bend + bend[nxt]), cross)
        turning = np.where(back, np.pi, np.abs(np.arctan2(cross, dot)))
        sharp = turning > seg.TANGENT
        if not contour.closed:
            sharp[-1] = False
        arc = s.turn != 0
        return cls(contour, s, (ox, oy), nxt, cross, turning, sharp, arc & arc[nxt])

    def fit(self, rows: NDArray[np.bool_], radius: float, ar: Arithmetic) -> _Fitted:
        """Return arcs of a radius at some corners, and what of the segments they leave."""
        s, n = self.segments, len(self.segments)
        i = np.flatnonzero(rows)
        k = self.following[i]
        side = np.where(self.cross[i] > 0, 1.0, -1.0)
        arcs = _arcs(s, i, k, side * radius, ar)
        at_i = seg.position_of(s.take(i), arcs.x0, arcs.y0)
        at_k = seg.position_of(s.take(k), arcs.x1, arcs.y1)
        fits = arcs.good & (at_i >= 0.0) & (at_i < s.length[i])
        fits &= (at_k > 0.0) & (at_k <= s.length[k])
        begin, end = np.zeros(n), s.length.copy()
        end[i[fits]], begin[k[fits]] = at_i[fits], at_k[fits]
        # Where a segment is too short for its two arcs, neither of its corners has one.
        short = np.flatnonzero(begin > end + 1e-6)
        return _Fitted(arcs, i, k, side, begin, end, i[~fits], short)

    def largest(self, corner: int, rows: NDArray[np.bool_], radius: float) -> float:
        """Return the largest radius below one that a corner can have, um; 0 for none."""
        behind = int(self.following[corner])
        near = np.zeros(len(rows), bool)  # arcs of other corners take nothing from its segments
        around = [corner - 1, corner, behind]
        near[around] = rows[around]
        low, high = 0.0, radius
        for _ in range(LARGEST_ROUNDS):
            middle = 0.5 * (low + high)
            fitted = self.fit(near, middle, FLOAT64)
            if corner in fitted.missing or np.isin([corner, behind], fitted.short).any():
                high = middle
            else:
                low = middle
        return low


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    """Arcs of corners, and from where to where their segments are left.

    Attributes:
        arcs: of the corners, in the order of ``i``.
        i: segment before each corner.
        k: segment behind it.
        side: 1.0 for a left turn, -1.0 for a right one.
        begin: where each segment begins now, um along it.
        end: where it ends.
        missing: corners that cannot have an arc.
        short: segments that are too short for their two.
    """

    arcs: _Arcs
    i: Ints
    k: Ints
    side: Floats
    begin: Floats
    end: Floats
    missing: Ints
    short: Ints


def _round(
    corners: _Corners, rows: NDArray[np.bool_], radius: float, ar: Arithmetic
) -> tuple[Contour, list[Diagnostic]]:
    """Return a contour with arcs at some of its corners."""
    contour = corners.contour
    if not rows.any():
        return contour, []
    fitted = corners.fit(rows, radius, ar)
    wrong = [*fitted.missing.tolist(), *fitted.short.tolist()]
    if wrong:
        findings = [_too_large(corners, m, rows, radius) for m in wrong[:LISTED_CORNERS]]
        if len(wrong) > LISTED_CORNERS:
            more = len(wrong) - LISTED_CORNERS
            findings.append(error("corner-too-large", "{count} further corners", count=more))
        return contour, findings
    arcs, i, k, (ox, oy) = fitted.arcs, fitted.i, fitted.k, corners.origin
    # Each segment from where the arc before leaves it, then the arc after it; what was not touched
    # stays to the digit.
    pairs = np.zeros((len(rows), 2), VERTEX)
    pairs[:, 0] = contour.starts
    pairs["source"][:, 1] = contour.starts["source"]
    pairs["x"][k, 0], pairs["y"][k, 0] = arcs.x1 + ox, arcs.y1 + oy
    pairs["x"][i, 1], pairs["y"][i, 1] = arcs.x0 + ox, arcs.y0 + oy
    pairs["cx"][i, 1], pairs["cy"][i, 1] = arcs.cx + ox, arcs.cy + oy
    pairs["turn"][i, 1] = fitted.side
    rounded = pairs[np.stack([fitted.end - fitted.begin > 1e-6, rows], axis=1)]
    if not contour.closed:
        rounded = np.concatenate([rounded, contour.vertices[-1:]])
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
    left = [(m.turn == 0) | (m.radius > shift * m.turn + MISS_UM) for m in (before, after)]
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


def _too_large(corners: _Corners, i: int, rows: NDArray[np.bool_], radius: float) -> Diagnostic:
    s, contour = corners.segments, corners.contour
    corner = Place.of_um(s.x1[i] + corners.origin[0], s.y1[i] + corners.origin[1])
    most = np.floor(corners.largest(i, rows, radius)) / 1000
    return error(
        "corner-too-large",
        "the corner at {corner} cannot be rounded with {radius_mm:.3f} mm: its neighbours are too "
        "short ({length_mm:.3f} mm)",
        contour.source_of(i),
        points_mm=(corner,),
        hint="at most {most_mm:.3f} mm fits this corner"
        if most > 0
        else "no arc fits this corner, where the outline turns back",
        corner=corner,
        radius_mm=radius / 1000,
        length_mm=float(s.length[i]) / 1000,
        most_mm=most,
    )

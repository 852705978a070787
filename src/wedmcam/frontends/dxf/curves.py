"""SPLINE and ELLIPSE become tangent arcs, and circles under unequal scales do.

An entity becomes a curve in the frame of its block once; how finely it is fitted follows from the
scale at which the block is inserted, so that the tolerance holds in the part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.frontends.dxf.turns import Turn, turn_of
from wedmcam.geom.circles import EXACT_UM, MEET_UM, Rounds, circle, rounds, sweep_about
from wedmcam.geom.curves import STRAIGHT_UM, Beziers, Ellipse, Ellipses, bezier_pieces
from wedmcam.geom.departure import certify
from wedmcam.ir.sketch import SEGMENT

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Rows = NDArray[np.void]
Linear = tuple[float, float, float, float]

#: Half axes that differ by less than this, um, are those of a circle.
ROUND_UM = 1e-3
#: An ellipse with a half axis below this, um, is a line there and back.
FLAT_UM = 1.0
#: Coordinates beyond this, um (1000 km), are no part.
FARTHEST_UM = 1e12
#: Parameters of an ellipse that differ by less are the same; a turn that is whole but for less, as
#: 2 pi is with 6 decimals, is not worth a word. Radians.
SAME_RAD, FULL_RAD = 1e-9, 1e-6
#: Weights of a spline that are smaller than this share of its largest make it jump.
LIGHT = 1e-9
#: A fit may miss its tolerance by this share, for rounding; beyond it, it is said.
SLACK = 1e-6
#: Ends of pieces of a curve that differ by less are the same place, um.
SAME_PIECE_END_UM = 1e-3


class CurveError(Exception):
    """An entity is no curve; ``code`` and text of the finding."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


@dataclass(frozen=True, slots=True, eq=False)
class Spline:
    """Bezier pieces (m, p + 1, 3), homogeneous, about (x, y); whether each starts at a corner."""

    pieces: Floats
    corner: NDArray[np.bool_]
    x: float
    y: float

    def transformed(self, m: Linear) -> Spline:
        """Return the image under x' = a x + c y, y' = b x + d y."""
        a, b, c, d = m
        pieces = self.pieces.copy()
        px, py = self.pieces[:, :, 0], self.pieces[:, :, 1]
        pieces[:, :, 0], pieces[:, :, 1] = a * px + c * py, b * px + d * py
        return replace(self, pieces=pieces, x=a * self.x + c * self.y, y=b * self.x + d * self.y)


Curve = Spline | Ellipse


#: Stands for a curve that is left out.
NOWHERE = Ellipse(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def image(curve: Curve, m: Linear) -> Curve:
    """Return the image of a curve under a linear transform."""
    if isinstance(curve, Spline):
        return curve.transformed(m)
    a, b, c, d = m
    e = curve
    cx, ux, vx = (a * x + c * y for x, y in ((e.cx, e.cy), (e.ux, e.uy), (e.vx, e.vy)))
    cy, uy, vy = (b * x + d * y for x, y in ((e.cx, e.cy), (e.ux, e.uy), (e.vx, e.vy)))
    return Ellipse(cx, cy, ux, uy, vx, vy, e.start, e.sweep)


def ellipses_of(rows: Rows) -> list[Ellipse]:
    """Return the arcs of segments as ellipses, run in the same sense."""
    out = []
    for row in rows:
        x0, y0, x1, y1, cx, cy, turn = row.item()[:7]
        r = float(np.hypot(x0 - cx, y0 - cy))
        a, b = np.arctan2(y0 - cy, x0 - cx), np.arctan2(y1 - cy, x1 - cx)
        whole = x0 == x1 and y0 == y1
        sweep = 2.0 * np.pi if whole else float(np.mod((b - a) * turn, 2.0 * np.pi))
        out.append(Ellipse(cx, cy, r, 0.0, 0.0, r * turn, float(a) * turn, sweep))
    return out


# --- from entities --------------------------------------------------------------------------


def of_ellipse(dxf: Any, scale: float, mirrored: bool) -> tuple[Ellipse, Turn]:
    """Return an ELLIPSE in um, and what its parameters say.

    Centre and axis are world coordinates; the minor axis is extrusion x major axis, so it points
    the other way where the extrusion is (0, 0, -1).
    """
    cx, cy, _ = dxf.center
    ax, ay, _ = dxf.major_axis
    side = -abs(dxf.ratio) if mirrored else abs(dxf.ratio)
    start, end = float(dxf.start_param), float(dxf.end_param)
    numbers = (cx, cy, ax, ay, side, start, end)
    if not np.isfinite(numbers).all():
        raise CurveError("bad-number", "")
    full, k = 2.0 * np.pi, scale
    turn = turn_of(start, end, float(np.hypot(ax, ay)) * k, SAME_RAD)
    if turn is Turn.ROUNDED and abs(abs(end - start) - full) < FULL_RAD:
        turn = Turn.FULL
    whole = turn in (Turn.FULL, Turn.ROUNDED, Turn.EQUAL)
    sweep = full if whole else float(np.mod(end - start, full))
    curve = Ellipse(
        cx * k, cy * k, ax * k, ay * k, -ay * k * side, ax * k * side, start % full, sweep
    )
    return curve, turn


def of_spline(entity: Any, scale: float) -> tuple[Spline | None, list[str]]:
    """Return a SPLINE in um, and what is odd about it: "fit-points", "open-spline".

    None where it has no length. Control points win over fit points, as in CAD programs.

    Raises:
        CurveError: its numbers do not fit together.
    """
    points = np.array(entity.control_points, float).reshape(-1, 3) * scale
    fitted = np.array(entity.fit_points, float).reshape(-1, 3) * scale
    closed = bool(entity.closed)
    odd: list[str] = []
    if len(points):
        knots = np.array(entity.knots, float)
        weights = np.array(entity.weights, float)
        degree = int(entity.dxf.degree)
    elif len(fitted) > 1:
        if not np.isfinite(fitted).all():
            raise CurveError("bad-number", "")
        points, knots, degree = _through(entity, fitted, closed)
        weights = np.zeros(0)
        odd.append("fit-points")
    else:
        raise CurveError("damaged-drawing", "a spline without control points")
    if not (np.isfinite(points).all() and np.isfinite(knots).all() and np.isfinite(weights).all()):
        raise CurveError("bad-number", "")
    _check(degree, points, knots, weights)
    rise = float(np.ptp(points[:, 2]))
    if rise > 1.0:
        raise CurveError("not-flat", "")
    x, y = np.round(points[0, :2]).tolist()
    w = weights if len(weights) else np.ones(len(points))
    homogeneous = np.stack([(points[:, 0] - x) * w, (points[:, 1] - y) * w, w], axis=1)
    pieces, corner = bezier_pieces(degree, knots, homogeneous)
    xy = pieces[:, :, :2] / pieces[:, :, 2:]
    if not len(pieces) or not np.ptp(xy.reshape(-1, 2), axis=0).any():
        return None, odd
    gap = float(np.hypot(*(xy[-1, -1] - xy[0, 0])))
    if closed and gap > MEET_UM:
        odd.append("open-spline")
    return Spline(pieces, corner, x, y), odd


def _check(degree: int, points: Floats, knots: Floats, weights: Floats) -> None:
    """Raise where the numbers of a spline do not fit together."""
    n = len(points)
    if not 1 <= degree <= 25:
        raise CurveError("damaged-drawing", f"a spline of degree {degree}")
    if n <= degree:
        raise CurveError("damaged-drawing", f"{n} control points, degree {degree} needs more")
    if len(knots) != n + degree + 1:
        text = f"{len(knots)} knots where {n + degree + 1} belong to {n} control points"
        raise CurveError("damaged-drawing", text)
    if (np.diff(knots) < 0).any():
        raise CurveError("damaged-drawing", "knots that do not ascend")
    if len(weights) and len(weights) != n:
        raise CurveError("damaged-drawing", f"{len(weights)} weights for {n} control points")
    if (weights <= 0).any():
        raise CurveError("damaged-drawing", "weights that are not positive")


def _through(entity: Any, fitted: Floats, closed: bool) -> tuple[Floats, Floats, int]:
    """Return control points, knots and degree of the cubic through fit points."""
    from ezdxf.math import fit_points_to_cad_cv

    keep = np.r_[True, (np.diff(fitted, axis=0) != 0).any(axis=1)]
    fitted = fitted[keep]
    if len(fitted) < 2:
        raise CurveError("damaged-drawing", "a spline through one point")
    if closed and len(fitted) > 2:
        return _ring(fitted)
    tangents = [
        entity.dxf.get(name)
        for name in ("start_tangent", "end_tangent")
        if entity.dxf.hasattr(name)
    ]
    given = tangents if len(tangents) == 2 and all(t.magnitude > 0 for t in tangents) else None
    if len(fitted) == 2 and given is None:
        return fitted, np.array([0.0, 0.0, 1.0, 1.0]), 1
    spline = fit_points_to_cad_cv(fitted.tolist(), tangents=given)
    points = np.array([tuple(p) for p in spline.control_points], float)
    return points, np.array(spline.knots(), float), spline.order - 1


def _ring(fitted: Floats) -> tuple[Floats, Floats, int]:
    """Return the periodic cubic through points, parameters by chord length, as Bezier pieces."""
    if (np.abs(fitted[0] - fitted[-1]) <= SAME_PIECE_END_UM).all():
        fitted = fitted[:-1]
    n = len(fitted)
    after = np.roll(fitted, -1, axis=0)
    h = np.linalg.norm(after - fitted, axis=1)
    slope = (after - fitted) / h[:, None]
    before = np.roll(h, 1)
    matrix = np.zeros((n, n))
    row = np.arange(n)
    np.add.at(matrix, (row, (row - 1) % n), h)
    np.add.at(matrix, (row, row), 2.0 * (h + before))
    np.add.at(matrix, (row, (row + 1) % n), before)
    right = 3.0 * (h[:, None] * np.roll(slope, 1, axis=0) + before[:, None] * slope)
    d = np.linalg.solve(matrix, right)
    third = h[:, None] / 3.0
    inner = [fitted, fitted + d * third, after - np.roll(d, -1, axis=0) * third]
    points = np.concatenate([np.stack(inner, axis=1).reshape(-1, 3), fitted[:1]])
    at = np.r_[0.0, np.cumsum(h)]
    knots = np.r_[at[0], np.repeat(at, 3), at[-1]]
    return points, knots, 3


# --- to arcs --------------------------------------------------------------------------------


@dataclass(slots=True)
class Fitted:
    """Segments of curves.

    Attributes:
        rows: in order of curve; ``source`` is the curve's index.
        error: how far each curve is from its segments at most, um, certified.
        circles: curves that are circles, or make one together.
        exact: curves that are circles, arcs or lines but for nothing.
        flat: ellipses without width.
        nothing: curves without length.
        absurd: curves with numbers beyond all parts, or none.
        missed: curves whose fit is worse than the tolerance.
    """

    rows: Rows
    error: Floats
    circles: list[int] = field(default_factory=list)
    exact: set[int] = field(default_factory=set)
    flat: list[int] = field(default_factory=list)
    nothing: list[int] = field(default_factory=list)
    absurd: list[int] = field(default_factory=list)
    missed: list[int] = field(default_factory=list)


def segments(curves: Sequence[Curve], tolerances: Sequence[float], frames: Sequence[int]) -> Fitted:
    """Return lines and arcs near to curves.

    Args:
        curves: of any number of frames; all are fitted at once, which is much faster.
        tolerances: of each curve, um.
        frames: to which frame each belongs: curves of different ones have nothing in common.
    """
    tolerance = np.array(tolerances, float)
    absurd = [k for k, c in enumerate(curves) if not _sound(c)]
    if absurd:
        gone = set(absurd)
        curves = [NOWHERE if k in gone else c for k, c in enumerate(curves)]
    out = Fitted(np.zeros(0, SEGMENT), np.zeros(len(curves)))
    parts: list[Rows] = []
    splines = [k for k, c in enumerate(curves) if isinstance(c, Spline)]
    by_degree: dict[int, list[int]] = {}
    for k in splines:
        by_degree.setdefault(curves[k].pieces.shape[1], []).append(k)  # type: ignore[union-attr]
    sets = []
    for members in by_degree.values():
        chosen = [c for k in members if isinstance(c := curves[k], Spline)]
        beziers = Beziers(
            np.concatenate([c.pieces for c in chosen]),
            np.repeat(np.arange(len(members)), [len(c.pieces) for c in chosen]),
            np.concatenate([c.corner for c in chosen]),
        )
        sets.append((np.array(members), beziers, rounds(beziers, len(members))))
    parts.append(_rounded(curves, sets, tolerance, frames, out))
    done = set(out.exact)
    for which, beziers, _ in sets:
        parts.append(_of_splines(curves, which, beziers, tolerance, done, out))
    parts.append(_of_ellipses(curves, tolerance, out))
    if absurd:
        out.absurd = absurd
        out.nothing = [k for k in out.nothing if k not in gone]
    rows = np.concatenate(parts)
    out.rows = rows[np.argsort(rows["source"], kind="stable")]
    out.missed = np.flatnonzero(out.error > tolerance * (1.0 + SLACK)).tolist()
    return out


def _sound(curve: Curve) -> bool:
    """Return whether a curve's numbers can be computed with."""
    if isinstance(curve, Ellipse):
        e = curve
        numbers = np.array([e.cx, e.cy, e.ux, e.uy, e.vx, e.vy, e.start, e.sweep])
        return bool((np.abs(numbers) <= FARTHEST_UM).all())
    w = curve.pieces[:, :, 2]
    if not (np.isfinite(w).all() and w.min() > LIGHT * w.max()):
        return False
    with np.errstate(all="ignore"):
        xy = curve.pieces[:, :, :2] / w[:, :, None]
    far = max(abs(curve.x), abs(curve.y), float(np.abs(xy).max()))
    return bool(np.isfinite(xy).all()) and far <= FARTHEST_UM


def _row(
    x0: float, y0: float, x1: float, y1: float, cx: float, cy: float, turn: int, source: int
) -> Rows:
    return np.array([(x0, y0, x1, y1, cx, cy, turn, source)], SEGMENT)


def _ring_row(cx: float, cy: float, r: float, source: int) -> Rows:
    return _row(cx + r, cy, cx + r, cy, cx, cy, 1, source)


def _arc_row(
    x0: float, y0: float, x1: float, y1: float, cx: float, cy: float, turn: int, source: int
) -> Rows:
    """Return an arc whose centre is moved to be as far from its end as from its start."""
    mx, my, wx, wy = 0.5 * (x0 + x1), 0.5 * (y0 + y1), x1 - x0, y1 - y0
    square = wx * wx + wy * wy
    along = ((cx - mx) * wx + (cy - my) * wy) / square if square else 0.0
    return _row(x0, y0, x1, y1, cx - along * wx, cy - along * wy, turn, source)


# --- circles and arcs that were written as splines ------------------------------------------


def _rounded(
    curves: Sequence[Curve],
    sets: list[tuple[Ints, Beziers, Rounds]],
    tolerance: Floats,
    frames: Sequence[int],
    out: Fitted,
) -> Rows:
    """Take curves that are circles or arcs, and chains of such that make a circle."""
    known: dict[int, tuple[Floats, Floats, float, float, float, float]] = {}
    for which, _, seen in sets:
        for at, k in enumerate(which.tolist()):
            if seen.error[at] <= min(tolerance[k], MEET_UM):
                curve = curves[k]
                assert isinstance(curve, Spline)
                x, y = seen.places[at]
                centre = float(seen.cx[at]) + curve.x, float(seen.cy[at]) + curve.y
                numbers = float(seen.sweep[at]), float(seen.error[at])
                known[k] = (x + curve.x, y + curve.y, *centre, *numbers)
    parts = [np.zeros(0, SEGMENT)]
    order = sorted(known)
    at = 0
    while at < len(order):
        group = _group(order, at, known, frames)
        x = np.concatenate([known[k][0] for k in group])
        y = np.concatenate([known[k][1] for k in group])
        cx, cy, r, error = circle(x, y)
        limit = min(float(tolerance[group].min()), MEET_UM)
        meets = np.hypot(x[-1] - x[0], y[-1] - y[0]) <= MEET_UM
        sweep = abs(sweep_about(x, y, cx, cy)) if meets and error <= limit else 0.0
        if abs(sweep - 2.0 * np.pi) <= 2.0 * MEET_UM / max(r, 1.0):
            parts.append(_ring_row(cx, cy, r, group[0]))
            out.circles += group
            out.exact.update(group)
            out.error[group] = error * 1.02 + 1e-6
            at += len(group)
            continue
        k = order[at]
        px, py, cx, cy, sweep, error = known[k]
        if error <= EXACT_UM and abs(sweep) < 6.0:
            ends = float(px[0]), float(py[0]), float(px[-1]), float(py[-1])
            parts.append(_arc_row(*ends, cx, cy, 1 if sweep > 0 else -1, k))
            out.exact.add(k)
            out.error[k] = 2.0 * error
        at += 1
    return np.concatenate(parts)


def _group(
    order: list[int],
    at: int,
    known: dict[int, tuple[Floats, Floats, float, float, float, float]],
    frames: Sequence[int],
) -> list[int]:
    """Return the curves from ``order[at]`` on, each going on where the last ended, up to a turn."""
    group = [order[at]]
    sweep = known[order[at]][4]
    while abs(sweep) < 2.0 * np.pi - 0.01 and at + len(group) < len(order):
        k = order[at + len(group)]
        x, y = known[group[-1]][0][-1], known[group[-1]][1][-1]
        nx, ny = known[k][0][0], known[k][1][0]
        follows = k == group[-1] + 1 and np.hypot(nx - x, ny - y) <= MEET_UM
        follows = follows and frames[k] == frames[group[-1]]
        if not follows or (known[k][4] > 0) != (sweep > 0):
            break
        group.append(k)
        sweep += known[k][4]
    return group


# --- splines --------------------------------------------------------------------------------


def _of_splines(
    curves: Sequence[Curve],
    which: Ints,
    beziers: Beziers,
    tolerance: Floats,
    done: set[int],
    out: Fitted,
) -> Rows:
    """Return the segments of the splines of one degree that are not ``done``."""
    arcs, off = certify(beziers, tolerance[which[beziers.curve[beziers.first]]])
    owner = beziers.curve[beziers.first[arcs.of]]
    worst = np.zeros(len(which))
    np.maximum.at(worst, owner, off)
    n = len(arcs.x0)
    lines = _straights(beziers)
    rows = np.zeros(n + len(lines), SEGMENT)
    for name in ("x0", "y0", "x1", "y1", "cx", "cy", "turn"):
        rows[name][:n] = getattr(arcs, name)
    at = np.zeros(len(rows))
    at[:n] = arcs.lo[arcs.piece]
    local = np.zeros(len(rows), np.int64)
    local[:n] = owner[arcs.piece]
    for k, (a, b) in enumerate(lines, start=n):
        rows["x0"][k], rows["y0"][k] = beziers.x0[a], beziers.y0[a]
        rows["x1"][k], rows["y1"][k] = beziers.x1[b], beziers.y1[b]
        at[k], local[k] = a, beziers.curve[a]
        worst[local[k]] = max(worst[local[k]], STRAIGHT_UM)
    order = np.lexsort((np.arange(len(rows)), at, local))
    rows, local = rows[order], local[order]
    fresh = np.array([k not in done for k in which.tolist()], np.bool_)
    out.error[which[fresh]] = worst[fresh]
    has = np.zeros(len(which), np.bool_)
    has[local] = True
    out.nothing += which[~has & fresh].tolist()
    rows, local = rows[fresh[local]], local[fresh[local]]
    _meet(rows, local)
    shift = np.array([(c.x, c.y) for k in which if isinstance(c := curves[k], Spline)])
    for name in ("x0", "x1", "cx"):
        rows[name] += shift[local, 0]
    for name in ("y0", "y1", "cy"):
        rows[name] += shift[local, 1]
    line = rows["turn"] == 0
    rows["cx"][line] = rows["cy"][line] = 0.0
    only = np.ones(len(which), np.bool_)
    only[local[~line]] = False
    out.exact.update(which[only & has & fresh].tolist())
    rows["source"] = which[local]
    return rows


def _straights(beziers: Beziers) -> list[tuple[int, int]]:
    """Return first and last piece of each run of pieces that make one line."""
    runs: list[tuple[int, int]] = []
    for k in np.flatnonzero(beziers.straight).tolist():
        if runs and runs[-1][1] == k - 1 and beziers.joint[k]:
            a = runs[-1][0]
            wx, wy = beziers.x1[k] - beziers.x0[a], beziers.y1[k] - beziers.y0[a]
            size = float(np.hypot(wx, wy))
            x, y = (
                beziers.x0[a + 1 : k + 1] - beziers.x0[a],
                beziers.y0[a + 1 : k + 1] - beziers.y0[a],
            )
            if size > 0 and float(np.abs(x * wy - y * wx).max()) <= STRAIGHT_UM * size:
                runs[-1] = (a, k)
                continue
        runs.append((k, k))
    return runs


def _meet(rows: Rows, of: Ints) -> None:
    """Let segments of a curve start exactly where the one before them ends."""
    if not len(rows):
        return
    first = np.r_[True, of[1:] != of[:-1]]
    last = np.r_[first[1:], True]
    before = np.arange(len(rows)) - 1
    before[first] = np.flatnonzero(last)  # a closed curve starts where it ends
    gap = np.hypot(rows["x0"] - rows["x1"][before], rows["y0"] - rows["y1"][before])
    near = gap <= SAME_PIECE_END_UM
    if len(rows) > 1:
        near &= ~(first & last)
    else:
        near[:] = False
    rows["x0"][near], rows["y0"][near] = rows["x1"][before][near], rows["y1"][before][near]


# --- ellipses -------------------------------------------------------------------------------


def _of_ellipses(curves: Sequence[Curve], tolerance: Floats, out: Fitted) -> Rows:
    """Return the segments of the ellipses."""
    parts = [np.zeros(0, SEGMENT)]
    which, chosen = [], []
    for k, curve in enumerate(curves):
        if not isinstance(curve, Ellipse):
            continue
        e = curve.principal()
        a, b = e.axes
        if a == 0:
            out.nothing.append(k)
        elif b < FLAT_UM:
            out.flat.append(k)
        elif abs(a - b) <= ROUND_UM:
            out.exact.add(k)
            if e.whole:
                parts.append(_ring_row(e.cx, e.cy, 0.5 * (a + b), k))
            else:
                ends = (*e.at(e.start), *e.at(e.start + e.sweep))
                parts.append(_arc_row(*ends, e.cx, e.cy, e.turn, k))
        else:
            which.append(k)
            x, y = float(np.round(e.cx)), float(np.round(e.cy))
            chosen.append((x, y, replace(e, cx=e.cx - x, cy=e.cy - y)))
    ellipses = Ellipses([e for _, _, e in chosen])
    names = np.array(which, np.int64)
    arcs, off = certify(ellipses, tolerance[names[ellipses.curve]])
    owner = ellipses.curve[arcs.section]
    np.maximum.at(out.error, names[ellipses.curve[arcs.of]], off)
    rows = np.zeros(len(arcs.x0), SEGMENT)
    for name in ("x0", "y0", "x1", "y1", "cx", "cy", "turn"):
        rows[name] = getattr(arcs, name)
    _meet(rows, owner)
    shift = np.array([(x, y) for x, y, _ in chosen]).reshape(-1, 2)
    for name in ("x0", "x1", "cx"):
        rows[name] += shift[owner, 0]
    for name in ("y0", "y1", "cy"):
        rows[name] += shift[owner, 1]
    line = rows["turn"] == 0
    rows["cx"][line] = rows["cy"][line] = 0.0
    rows["source"] = names[owner]
    parts.append(rows)
    return np.concatenate(parts)

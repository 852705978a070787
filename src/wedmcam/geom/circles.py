"""Curves that are circles or arcs already, written as splines: they are better taken as such.

Many programs export every path as cubic pieces, a circle as four of them, which is within 0.03 % of
its radius: a machine that knows arcs should cut the arc that was meant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wedmcam.geom.curves import Beziers, Bools, Floats

#: Places on each piece.
PLACES = 12
#: An open curve is one arc if it lies this near to it, um: rational splines do, approximations
#: keep their own shape.
EXACT_UM = 0.01
#: Ends this near to each other meet, um.
MEET_UM = 1.0
#: Arcs flatter than this are left to the fit: their centre would be noise. Radians.
LEAST_SWEEP = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Rounds:
    """The circle that lies nearest to each curve, shape (curves,) each; um.

    Attributes:
        places: x and y of places on each curve.
        sweep: about that circle, signed, radians; 0 where the curve is none.
        cx, cy, r: the circle.
        error: largest distance of the places from it; inf where there is none.
    """

    places: tuple[tuple[Floats, Floats], ...]
    sweep: Floats
    cx: Floats
    cy: Floats
    r: Floats
    error: Floats


def circle(x: Floats, y: Floats) -> tuple[float, float, float, float]:
    """Return centre, radius and largest distance of the circle through places (Kasa 1976).

    >>> a = np.linspace(0.0, 3.0, 9)
    >>> [round(v, 6) for v in circle(5 + 2 * np.cos(a), 7 + 2 * np.sin(a))]
    [5.0, 7.0, 2.0, 0.0]
    """
    mx, my = float(x.mean()), float(y.mean())
    u, v = x - mx, y - my
    suu, suv, svv = float(u @ u), float(u @ v), float(v @ v)
    z = u * u + v * v
    p, q = 0.5 * float(u @ z), 0.5 * float(v @ z)
    det = suu * svv - suv * suv
    if det <= 1e-12 * (suu + svv) ** 2:
        return 0.0, 0.0, 0.0, float("inf")
    a, b = (p * svv - q * suv) / det, (q * suu - p * suv) / det
    r = np.hypot(u - a, v - b)
    radius = 0.5 * float(r.max() + r.min())
    return a + mx, b + my, radius, float(np.abs(r - radius).max())


def sweep_about(x: Floats, y: Floats, cx: float, cy: float) -> float:
    """Return the angle that places run through about a centre, signed; 0 if they turn back."""
    u, v = x - cx, y - cy
    step = np.arctan2(u[:-1] * v[1:] - v[:-1] * u[1:], u[:-1] * u[1:] + v[:-1] * v[1:])
    step = step[np.abs(step) > 1e-12]
    if not len(step) or not ((step > 0).all() or (step < 0).all()):
        return 0.0
    return float(step.sum())


def rounds(beziers: Beziers, curves: int) -> Rounds:
    """Return the nearest circle of each of the curves 0 to ``curves`` - 1."""
    x, y = beziers.sample(PLACES)
    bounds = np.searchsorted(beziers.curve, np.arange(curves + 1))
    corner = ~beziers.joint
    places = []
    out = np.zeros((5, curves))
    out[4] = np.inf
    for k, (a, b) in enumerate(zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True)):
        px, py = x[a:b].ravel(), y[a:b].ravel()
        places.append((px, py))
        if a == b or beziers.straight[a:b].any() or (corner[a + 1 : b] & _gap(beziers, a, b)).any():
            continue
        cx, cy, r, error = circle(px, py)
        if error > MEET_UM:
            continue
        sweep = sweep_about(px, py, cx, cy)
        if LEAST_SWEEP <= abs(sweep) <= 2.0 * np.pi + 1e-3:
            out[:, k] = sweep, cx, cy, r, error
    return Rounds(tuple(places), *out)


def _gap(beziers: Beziers, a: int, b: int) -> Bools:
    """Return whether pieces do not begin where the one before them ends."""
    gap = np.hypot(
        beziers.x0[a + 1 : b] - beziers.x1[a : b - 1], beziers.y0[a + 1 : b] - beziers.y1[a : b - 1]
    )
    out: Bools = gap > MEET_UM
    return out

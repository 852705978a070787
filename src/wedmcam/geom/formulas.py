"""The formulas of compensation, written once over an `Arithmetic`.

Each takes and returns arrays of that arithmetic, in um relative to an origin near the part, and
decides nothing: which root is meant, and whether there is one, is known to the caller.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from wedmcam.arithmetic import Arithmetic

Array = Any
Pair = tuple[Array, Array]


def unit(ar: Arithmetic, x: Array, y: Array) -> Pair:
    """Return (x, y) divided by its length, which must not be 0."""
    length = ar.sqrt(x * x + y * y)
    return x / length, y / length


def line_line(ar: Arithmetic, p: Pair, u: Pair, q: Pair, v: Pair) -> Pair:
    """Return where the line through p along u meets the line through q along v.

    u and v are unit vectors that are not parallel.
    """
    cross = u[0] * v[1] - u[1] * v[0]
    along = ((q[0] - p[0]) * v[1] - (q[1] - p[1]) * v[0]) / cross
    return p[0] + u[0] * along, p[1] + u[1] * along


def line_circle(ar: Arithmetic, p: Pair, u: Pair, c: Pair, r: Array, root: Array) -> Pair:
    """Return where the line through p along the unit vector u meets the circle (c, r).

    root: +1 the crossing further along u, -1 the other. A line that misses gives the point of the
    line nearest to the centre.
    """
    along = (c[0] - p[0]) * u[0] + (c[1] - p[1]) * u[1]
    across = (c[0] - p[0]) * u[1] - (c[1] - p[1]) * u[0]
    square = (r - across) * (r + across)
    half = ar.sqrt(ar.where(square > 0, square, square - square))
    at = along + root * half
    return p[0] + u[0] * at, p[1] + u[1] * at


def circle_circle(ar: Arithmetic, c: Pair, r: Array, d: Pair, s: Array, root: Array) -> Pair:
    """Return where the circles (c, r) and (d, s) meet; their centres differ.

    root: +1 the crossing to the left of the way from c to d, -1 the other. Circles that miss give
    the point of (c, r) on the line of centres.
    """
    dx, dy = d[0] - c[0], d[1] - c[1]
    apart = ar.sqrt(dx * dx + dy * dy)
    along = ((r - s) * (r + s) / apart + apart) / 2
    square = (r - along) * (r + along)
    half = ar.sqrt(ar.where(square > 0, square, square - square)) * root
    ux, uy = dx / apart, dy / apart
    return c[0] + ux * along - uy * half, c[1] + uy * along + ux * half


def shifted(ar: Arithmetic, p: Pair, n: Pair, by: Array) -> Pair:
    """Return p moved by ``by`` along the unit vector n."""
    return p[0] + n[0] * by, p[1] + n[1] * by


class Curve(NamedTuple):
    """A line or a circle, as a point on it, the left normal there, and its curvature.

    A line has curvature 0; a circle 1 / r, above 0 where it bends to the left. With its centre a
    flat arc would lose all digits (8 of them are 1 um for a centre 10 m away); as a curve it loses
    none, for everything is measured from the point.
    """

    at: Pair
    normal: Pair
    curvature: Array


def meeting(ar: Arithmetic, one: Curve, two: Curve) -> tuple[Pair, Pair]:
    """Return where two curves meet: both crossings, the same one twice for two lines.

    Curves that miss each other give the place where they come nearest. The two are not parallel
    where both are lines, and not concentric.

    With d from the point of a curve, the curve is where d . n = curvature |d|^2 / 2. The difference
    of two such equations, taken so that |d|^2 falls out, is the line on which the crossings lie.
    """
    swap = one.curvature * one.curvature > two.curvature * two.curvature
    one, two = _chosen(ar, swap, two, one), _chosen(ar, swap, one, two)  # the straighter first
    (nx, ny), (mx, my) = one.normal, two.normal
    ex, ey = two.at[0] - one.at[0], two.at[1] - one.at[1]
    bent = two.curvature != 0
    divisor = ar.where(bent, two.curvature, ar.array(np.ones(len(bent))))
    ratio = one.curvature / divisor
    wx, wy = nx - ratio * mx - one.curvature * ex, ny - ratio * my - one.curvature * ey
    # The foot of the line w . d = h: seen from the point of one, and then from that of two.
    h = -(ratio * (ex * mx + ey * my)) - one.curvature * (ex * ex + ey * ey) / 2
    size = wx * wx + wy * wy
    fx, fy = wx * h / size, wy * h / size
    root = ar.sqrt(size)
    ux, uy = wy / root, -wx / root
    gx, gy = fx - ex, fy - ey
    # From there t along u to curve two: curvature t^2 / 2 - b t - c = 0.
    b = ux * mx + uy * my - two.curvature * (gx * ux + gy * uy)
    c = gx * mx + gy * my - two.curvature * (gx * gx + gy * gy) / 2
    square = b * b + two.curvature * c * 2
    meet = square > 0
    half = ar.sqrt(ar.where(meet, square, square - square))
    far = b + ar.where(b < 0, -half, half)
    once = -(c * 2) / ar.where(meet, far, ar.array(np.ones(len(bent))))
    far_t = ar.where(bent, far / divisor, once)
    near_t = ar.where(meet, once, far_t)
    x, y = one.at[0] + fx, one.at[1] + fy
    return (x + ux * near_t, y + uy * near_t), (x + ux * far_t, y + uy * far_t)


def _chosen(ar: Arithmetic, condition: Any, a: Curve, b: Curve) -> Curve:
    """Return a where the condition holds, else b."""
    at = [ar.where(condition, p, q) for p, q in zip(a.at, b.at, strict=True)]
    normal = [ar.where(condition, p, q) for p, q in zip(a.normal, b.normal, strict=True)]
    return Curve(
        (at[0], at[1]), (normal[0], normal[1]), ar.where(condition, a.curvature, b.curvature)
    )

"""The formulas of compensation, written once over an `Arithmetic`.

Each takes and returns arrays of that arithmetic, in um relative to an origin near the part, and
decides nothing: which root is meant, and whether there is one, is known to the caller.
"""

from __future__ import annotations

from typing import Any

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


def on_circle(ar: Arithmetic, c: Pair, through: Pair, r: Array) -> Pair:
    """Return the point of the circle (c, r) in the direction of ``through`` seen from c."""
    u = unit(ar, through[0] - c[0], through[1] - c[1])
    return c[0] + u[0] * r, c[1] + u[1] * r

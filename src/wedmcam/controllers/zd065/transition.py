"""Corners of an outline that the ZD-065 offsets: transition arcs (过渡圆), crossings, joined ends.

Everything is measured from the corner, V: lengths are those of the gap and of the arc and not those
of the table, so 8 digits are far below the micron, also where an arc has a radius of 10 m. A curve
is its left normal at V and its curvature, above 0 where it bends to the left (0: a line). Formulas
take arrays of `Decimal8Array`, or of float64 where only a limit is looked for.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = Any
Bools = NDArray[np.bool_]


class Pair(NamedTuple):
    """x and y of vectors."""

    x: Array
    y: Array

    def __add__(self, other: Any) -> Pair:
        return Pair(self.x + other.x, self.y + other.y)

    def __sub__(self, other: Pair) -> Pair:
        return Pair(self.x - other.x, self.y - other.y)

    def times(self, factor: Array) -> Pair:
        """Return the vectors, each as many times as long."""
        return Pair(self.x * factor, self.y * factor)

    def dot(self, other: Pair) -> Array:
        """Return the scalar products."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: Pair) -> Array:
        """Return the cross products: the sine of the angle from one to the other, of units."""
        return self.x * other.y - self.y * other.x

    def at(self, rows: Any) -> Pair:
        """Return the vectors of some rows."""
        return Pair(self.x[rows], self.y[rows])

    def along(self) -> Pair:
        """Return the directions that have these left normals."""
        return Pair(self.y, -self.x)


class Transition(NamedTuple):
    """Arcs that round the corner between a line and the curve behind it, seen from the corner.

    Attributes:
        exists: whether a circle of that radius touches both, before and behind the corner; the rest
            means nothing where not.
        back: from the corner back along the line to where the arc starts, um.
        centre: of the arc.
        normal: left normal of the curve where the arc ends on it.
    """

    exists: Bools
    back: Array
    centre: Pair
    normal: Pair


def transition(line: Pair, curve: Pair, curvature: Array, side: Array, radius: Array) -> Transition:
    """Return the arcs of a radius that touch a line that ends, and a curve that starts, in V.

    Args:
        line: left normals of the lines.
        curve: left normals of the curves at the corner.
        curvature: of the curves.
        side: +1 where the corner turns left, -1 right; the arc lies on that side.
        radius: of the arcs, um.

    The centre lies at ``radius`` from the line, a = ``back`` behind the corner, and at ``radius``
    from the curve, which is the nearer root of
    side curvature a^2 / 2 - |sin turn| a + radius (1 - cos turn) = 0: for a line r tan(turn / 2).

    >>> one = np.ones(1)
    >>> left, up = Pair(0 * one, one), Pair(-one, 0 * one)  # normals of +x and of +y
    >>> t = transition(left, up, 0 * one, one, 100 * one)
    >>> t.back.tolist(), t.centre.x.tolist(), t.centre.y.tolist()
    ([100.0], [-100.0], [100.0])
    """
    sine, cosine = abs(line.cross(curve)), line.dot(curve)
    blunt = cosine > 0
    # 1 - cos, of small turns by the sine, which keeps its digits.
    depth = radius * np.where(
        blunt, sine * sine / np.where(blunt, cosine + 1, 1 + abs(cosine)), 1 - cosine
    )
    inner = sine * sine - side * curvature * depth * 2
    reach = 1 - side * curvature * radius
    exists = np.asarray((inner >= 0) & (sine > 0) & (reach > 0))
    root = np.sqrt(np.where(exists, inner, inner - inner))
    back = depth * 2 / np.where(exists, sine + root, radius)
    to_corner = line.along().times(back) - line.times(side * radius)
    share = 1 / np.where(exists, reach, 1 + abs(reach))
    normal = (curve + to_corner.times(curvature)).times(share)
    return Transition(exists, back, Pair(-to_corner.x, -to_corner.y), normal)


def joined(first: Pair, second: Pair, shift: Array) -> Pair:
    """Return where two lines meet that are shifted to the left: joints that are nearly tangent."""
    share = shift / (first.dot(second) + 1)
    return (first + second).times(share)


class Crossing(NamedTuple):
    """Where two curves that met in V meet after a shift; the place means nothing where not."""

    exists: Bools
    place: Pair


def crossing(
    first: Pair, curvature: Array, second: Pair, other_curvature: Array, shift: Array
) -> Crossing:
    """Return where two curves meet, nearest to V, that are shifted to the left.

    Args:
        first: left normals of the curves that end in V.
        curvature: theirs.
        second: left normals of the curves that start in V.
        other_curvature: theirs.
        shift: to the left, um.

    A place w is on both where w . n = h + k e with e = (w^2 - h^2) / 2, n its normal and k its
    curvature: w is linear in e, and e the nearer root of a square equation.

    >>> one = np.ones(1)
    >>> up, left = Pair(0 * one, one), Pair(-one, 0 * one)
    >>> c = crossing(up, 0 * one, left, 0 * one, -10 * one)
    >>> bool(c.exists[0]), c.place.x.tolist(), c.place.y.tolist()
    (True, [10.0], [-10.0])
    """
    sine, cosine = first.cross(second), first.dot(second)
    apart = np.asarray((abs(sine) > 1e-6) & (cosine > -1 + 1e-6))
    divisor = np.where(apart, sine, abs(sine) + 1)
    base = (first + second).times(shift / np.where(apart, cosine + 1, abs(cosine) + 1))
    slope = Pair(
        (second.y * curvature - first.y * other_curvature) / divisor,
        (first.x * other_curvature - second.x * curvature) / divisor,
    )
    a, b = slope.dot(slope), 1 - base.dot(slope)
    c = base.dot(base) - shift * shift
    inner = b * b - a * c
    exists = apart & np.asarray((inner >= 0) & (b > 0))
    root = np.sqrt(np.where(exists, inner, inner - inner))
    e = c / np.where(exists, b + root, abs(b) + 1)
    return Crossing(exists, base + slope.times(e))

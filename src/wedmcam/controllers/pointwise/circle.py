"""The one staircase that every arc of a radius walks, in closed form.

Turn and mirror an arc so that it runs counter-clockwise and its quadrant becomes the first, with u
shrinking and v growing (both >= 0). The steps of the printed rule then depend on R^2 alone:

- the path leaves column u at v = Y(u), the least v with u^2 + v^2 >= R^2, so every start (where
  F = 0) stands on the same staircase from (A, 0) to (0, A), and so does every later quadrant;
- A, the reach at each apex, is Y(1) = ceil(sqrt(R^2 - 1)); a quadrant is 2 A steps, a turn 8 A, and
  after a turn the path stands on its start again;
- after m steps of a quadrant, v - u = m - A, and (u, v) is the point of this diagonal with
  F(u, v-1) < 0 <= F(u+1, v).

A place on the path is therefore the number k of steps from the apex of the starting quadrant. All
of it is computed in float64, which holds these integers exactly: square roots round correctly, and
below 2^52 floor(sqrt(n)) is isqrt(n), ceil likewise.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Bools: TypeAlias = NDArray[np.bool_]

#: R^2 of the arcs that end: below 2 the path steps onto its centre; above 2^49 um^2 (R = 23.7 m,
#: the machines stop at 10 m) sums of a square root and an integer are no longer exact in float64.
R2_MIN = 2.0
R2_MAX = 2.0**49

#: Count lengths above this are refused, so that step numbers stay exact in float64.
COUNT_MAX = 2**40


class Frame(NamedTuple):
    """Points of arcs in their own quadrant: u shrinks, v grows.

    Attributes:
        odd: the quadrant is the second or fourth of the counter-clockwise image: u lies along y.
        half: it is the third or fourth.
        u: magnitude that shrinks, > 0 except at the centre.
        v: magnitude that grows, >= 0.
    """

    odd: Bools
    half: Bools
    u: Floats
    v: Floats


def frame(x: Floats, y: Floats, turn: Floats) -> Frame:
    """Return the frames of points (x, y) about the centre; one on an axis is in the one entered.

    A clockwise arc (``turn`` < 0) is mirrored in the x axis first.
    """
    yy = y * turn
    odd = (x * yy < 0) | (x == 0)
    half = (yy < 0) | ((yy == 0) & (x < 0))
    ax, ay = np.abs(x), np.abs(y)
    return Frame(odd, half, np.where(odd, ay, ax), np.where(odd, ax, ay))


def quadrant(f: Frame) -> Floats:
    """Return the quadrant of the counter-clockwise image, 0 to 3."""
    return 2.0 * f.half.astype(np.float64) + f.odd.astype(np.float64)


def unframe(q: Floats, u: Floats, v: Floats, turn: Floats) -> tuple[Floats, Floats]:
    """Return (x, y) of (u, v) in quadrant ``q`` (any whole number >= 0; four make a turn)."""
    turned = q - 4.0 * np.floor(0.25 * q)
    odd = (turned == 1) | (turned == 3)
    sign = np.where(turned >= 2, -1.0, 1.0)
    return np.where(odd, -v, u) * sign, np.where(odd, u, v) * (sign * turn)


def apex(r2: Floats) -> Floats:
    """Return A, how far the path reaches on the axes.

    >>> apex(np.array([25.0, 26.0, 27.0]))
    array([5., 5., 6.])
    """
    root: Floats = np.sqrt(r2 - 1.0)
    return np.ceil(root, out=root)


def place(r2: Floats, a: Floats, m: Floats) -> tuple[Floats, Floats]:
    """Return (u, v) after ``m`` steps of a quadrant, 1 <= m <= 2 A (0 is 2 A of the one before).

    >>> place(np.array([16.0] * 8), np.array([4.0] * 8), np.arange(1.0, 9.0))[1]
    array([0., 1., 2., 3., 3., 4., 4., 4.])
    """
    e = m - a - 1.0
    u = np.floor(0.5 * (np.sqrt(2.0 * r2 - 1.0 - e * e) - e))
    return u, u + e + 1.0


def tie(r2: Floats) -> tuple[Floats, Bools]:
    """Return (h, outwards): the path stands on (h, h), and whether it leaves by a v step."""
    h = np.floor(0.5 * (np.sqrt(2.0 * r2 - 2.0) + 1.0))
    return h, 2.0 * h * h < r2

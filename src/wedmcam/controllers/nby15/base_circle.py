"""The base circle: how far the machine goes in one degree of a circle of 2^18 um.

A plate of diodes holds dX and dY of the degrees 0 to 44 [S]; the others are exchanged and negated.
The source says that the values were optimised by trials; ours are differences of rounded
coordinates [R]: they telescope, so that a quadrant sums to exactly 2^18 and every circle closes.
Marks: [S] states the source (the maker's history of the NBY-15, in French), [R] is our ruling.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]

#: Radius of the base circle, um, as a power of two [S]; the division by it is a shift.
SHIFT = 18
RADIUS = 1 << SHIFT
#: What a residue starts from: one half, so that places are rounded and not cut off [R].
HALF = RADIUS // 2


def _diodes() -> Ints:
    """Return |dX|, |dY| of the degrees 0 to 44, shape (45, 2)."""
    angle = np.radians(np.arange(46))
    x, y = (np.rint(RADIUS * f(angle)).astype(np.int64) for f in (np.cos, np.sin))
    return np.column_stack([x[:-1] - x[1:], np.diff(y)])


#: The diode memory.
DIODES = _diodes()


def _every_degree() -> Ints:
    """Return (dX, dY) of the degrees 0 to 359, counter-clockwise, shape (360, 2)."""
    octant = DIODES
    # 45 to 89: mirrored about 45 degrees, so dX and dY change places.
    quadrant = np.vstack([octant, octant[::-1, ::-1]]) * np.array([-1, 1])
    turned = [quadrant]
    for _ in range(3):
        last = turned[-1]
        turned.append(np.column_stack([-last[:, 1], last[:, 0]]))
    return np.vstack(turned)


#: Movement along the base circle from degree k to k + 1.
DEGREES = _every_degree()
#: Places on the base circle at degree 0 to 359, about its centre.
PLACES = np.vstack([[0, 0], np.cumsum(DEGREES, axis=0)])[:-1] + np.array([RADIUS, 0])


def movements(start: Ints, turn: Ints) -> Ints:
    """Return the movement along the base circle of one degree each, shape (n, 2).

    Args:
        start: degree at which each begins; any whole number.
        turn: +1 counter-clockwise, -1 clockwise.

    >>> movements(np.array([18, 19, 90]), np.array([1, -1, 1])).tolist()
    [[-1452, 4339], [1452, -4339], [-4575, -40]]
    """
    row = np.mod(np.where(turn > 0, start, start - 1), 360)
    return np.asarray(DEGREES[row] * np.asarray(turn)[:, None])


def along(start: int, turn: int, degrees: int) -> Ints:
    """Return where an arc of the base circle is after 0 to ``degrees`` degrees, from its start."""
    at = PLACES[np.mod(start + turn * np.arange(degrees + 1), 360)]
    return np.asarray(at - at[0])


def sagitta_um(radius: Any) -> Any:
    """Return how far the chord of one degree lies inside a circle, um.

    >>> round(float(sagitta_um(26_263.0)), 3)
    1.0
    """
    return radius * (1.0 - np.cos(np.radians(0.5)))


#: Beyond this radius places on the circle are rounded by more: the table has whole um too.
FINE_UM = 60_000.0


def arc_limit_um(radius: Any) -> Any:
    """Return what the path of an arc is held to, um: its sagitta + 1.5, beyond R 60 mm + 2.

    >>> [round(float(arc_limit_um(r)), 2) for r in (1000.0, 60_000.0, 300_000.0)]
    [1.54, 3.78, 13.42]
    """
    return sagitta_um(radius) + np.where(radius <= FINE_UM, 1.5, 2.0)


def steps_of(way: Ints, residue: Ints) -> tuple[Ints, Ints]:
    """Return whole um of movements one after the other, and the residues behind the last one.

    Args:
        way: radius times the movement of the base circle, shape (n, 2): um in units of 2^-18.
        residue: x and y as left by what came before; `HALF` at the start of a program.

    A residue is what a division by 2^18 leaves; it is added in the next calculation [S].

    >>> steps_of(np.array([[HALF, HALF - 1], [HALF, 1]]), np.array([0, 0]))[0].tolist()
    [[0, 0], [1, 0]]
    """
    sums = np.vstack([residue[None, :], residue + np.cumsum(way, axis=0)])
    return np.diff(sums >> SHIFT, axis=0), sums[-1] & (RADIUS - 1)

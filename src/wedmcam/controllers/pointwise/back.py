"""The inverse of one step: how a controller goes back along its path without a memory of it.

The state after a step tells which axis that step was on [M], so who goes back undoes steps, one
after the other, and stands exactly where the path was. The opposite sense would not: it leaves the
cut pixels by up to 1 um. Lengths are um, one step is 1 um. Places are relative to the centre of an
arc.
"""

from __future__ import annotations

from wedmcam.controllers.pointwise.steps import ARC_TABLE, arc_quadrant
from wedmcam.ir.program import Axis


def line_back(x: int, y: int, f: int) -> tuple[Axis, int, int]:
    """Return axis and sign of the last step of a line along (x, y), and F before it.

    Before a step along x F was 0 to |x| - 1, before one along y -|y| to -1; so behind a step along
    y F is at least |x| - |y|, behind one along x less. With the line table MIRROR.

    >>> line_back(6, 4, -4)  # behind the first step, along x at F = 0
    (<Axis.X: 0>, 1, 0)
    """
    ax, ay = abs(x), abs(y)
    if ay == 0 or (ax > 0 and f < ax - ay):
        return Axis.X, 1 if x > 0 else -1, f + ay
    return Axis.Y, 1 if y > 0 else -1, f - ax


def arc_back(x: int, y: int, f: int, turn: int) -> tuple[Axis, int, int]:
    """Return axis and sign of the last step of an arc that stands at (x, y), and F before it.

    On NR1, where x shrinks and y grows: the last step was along y if and only if
    F >= 2 y - 2 x - 2 [M]; the other quadrants and clockwise arcs by symmetry. At y = 0 the
    quadrant begins: with F >= -1 the last step came in from the quadrant before, with less it was
    the first one of this quadrant, inwards.

    Args:
        x, y: where it stands, from the centre; at least one step behind its start.
        f: the deviation there.
        turn: +1 counter-clockwise, -1 clockwise.

    >>> arc_back(3, 0, -7, 1), arc_back(3, 1, -6, 1)  # the first two steps of NR1 from (4, 0)
    ((<Axis.X: 0>, -1, 0), (<Axis.Y: 1>, 1, -7))
    """
    quadrant = arc_quadrant(x, y, turn)
    if (x == 0 or y == 0) and f >= -1:
        # An axis that is reached: its quadrant is the next one, the step belongs to the last one.
        quadrant = (quadrant - 1 - turn) % 4 + 1
    inwards, outwards = ARC_TABLE[turn, quadrant]
    u, v = (abs(x), abs(y)) if inwards[0] == Axis.X else (abs(y), abs(x))
    along, sign = outwards if v > 0 and u > 0 and f >= 2 * v - 2 * u - 2 else inwards
    value = x if along == Axis.X else y
    return along, sign, f - 2 * sign * value + 1

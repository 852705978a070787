"""The step loop of point-by-point comparison (逐点比较法), as the paper prints it.

This is the meaning of a block: slow, plain and obviously right. Everything fast in this package is
a closed form that tests prove equal to it. After each step the controller looks at the sign of the
deviation F alone: F >= 0 steps one way, F < 0 the other. Lengths are um, one step is 1 um.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.controllers.stepping import Step
from wedmcam.ir.program import Axis, Kind


def _sign(value: int) -> int:
    return (value > 0) - (value < 0)


def line_axis(x: int, y: int, square: Axis = Axis.SQUARE) -> Axis:
    """Return the axis that the ZD-065 counts on for a line along (x, y): the longer, y at a tie.

    With ``Axis.SQUARE_X`` x at a tie.

    >>> line_axis(17, 5).name, line_axis(3, 3).name, line_axis(3, 3, Axis.SQUARE_X).name
    ('X', 'Y', 'X')
    """
    if abs(x) == abs(y):
        return Axis.X if square == Axis.SQUARE_X else Axis.Y
    return Axis.X if abs(x) > abs(y) else Axis.Y


def _x_first(x: int, y: int, table: LineTable) -> bool:
    """Return whether F >= 0 steps a sloping line along x; see `LineTable`."""
    return {
        LineTable.MIRROR: True,
        LineTable.MIRROR_EXCHANGED: False,
        LineTable.ROTATE: x * y > 0,
        LineTable.ROTATE_EXCHANGED: x * y < 0,
    }[table]


def line_steps(
    x: int, y: int, axis: Axis, count: int, table: LineTable = LineTable.MIRROR
) -> Iterator[Step]:
    """Step along the line with direction (x, y) until ``count`` steps on ``axis`` are made.

    (x, y) is a ratio: only its quadrant and the rule of F use it. F = 0 at the start. F >= 0: a
    step along x, F' = F - |y|; F < 0: a step along y, F' = F + |x|. Where the `LineTable` steps y
    at F >= 0, x and y change places in this. An axis on which the line has no length is never
    stepped. ``Axis.SQUARE`` and ``SQUARE_X`` count on `line_axis`.

    Raises:
        ValueError: the line would never end, or ``count`` is negative.

    >>> "".join(s.axis.name for s in line_steps(6, 4, Axis.X, 6))
    'XYXYXXYXYX'
    >>> [s.f for s in line_steps(6, 4, Axis.X, 6)]
    [-4, 2, -2, 4, 0, -4, 2, -2, 4, 0]
    """
    if axis in (Axis.SQUARE, Axis.SQUARE_X):
        axis = line_axis(x, y, axis)
    if count < 0 or (count > 0 and (x if axis == Axis.X else y) == 0):
        raise ValueError(f"line ({x}, {y}) never ends on {count} steps along {Axis(axis).name}")
    swapped = not _x_first(x, y, table)
    f = px = py = 0
    while count > 0:
        along_x = y == 0 if x * y == 0 else (f >= 0) != swapped
        if x * y == 0:
            pass  # F stays 0 on an axis
        elif f >= 0:
            f -= abs(x) if swapped else abs(y)
        else:
            f += abs(y) if swapped else abs(x)
        if along_x:
            px += _sign(x)
            step = Step(Axis.X, _sign(x), f, px, py)
        else:
            py += _sign(y)
            step = Step(Axis.Y, _sign(y), f, px, py)
        count -= step.axis == axis
        yield step


def counts(axis: Axis, along: Axis, x: int, y: int) -> bool:
    """Return whether a step along ``along`` counts towards J.

    Args:
        axis: of the block; for a line that counts on the square its `line_axis`.
        along: of the step.
        x, y: where the step begins, from the centre of an arc; a line does not look at them.

    >>> [counts(Axis.SQUARE, Axis.Y, x, 4) for x in (3, 4, 5)]
    [False, True, True]
    """
    if axis == Axis.SQUARE:
        return along == (Axis.X if abs(x) < abs(y) else Axis.Y)
    if axis == Axis.SQUARE_X:
        return along == (Axis.X if abs(x) <= abs(y) else Axis.Y)
    return along == axis


#: (turn, quadrant) -> the step at F >= 0 (inwards) and at F < 0 (outwards), each as (axis, sign).
ARC_TABLE: dict[tuple[int, int], tuple[tuple[Axis, int], tuple[Axis, int]]] = {
    (+1, 1): ((Axis.X, -1), (Axis.Y, +1)),  # NR1
    (+1, 2): ((Axis.Y, -1), (Axis.X, -1)),
    (+1, 3): ((Axis.X, +1), (Axis.Y, -1)),
    (+1, 4): ((Axis.Y, +1), (Axis.X, +1)),
    (-1, 1): ((Axis.Y, -1), (Axis.X, +1)),  # SR1
    (-1, 2): ((Axis.X, +1), (Axis.Y, +1)),
    (-1, 3): ((Axis.Y, +1), (Axis.X, -1)),
    (-1, 4): ((Axis.X, -1), (Axis.Y, -1)),
}


def arc_quadrant(x: int, y: int, turn: int) -> int:
    """Return the quadrant, 1 to 4, of (x, y) about the centre; on an axis the one entered.

    >>> [arc_quadrant(*p, 1) for p in ((5, 0), (0, 5), (-5, 0), (0, -5))]
    [1, 2, 3, 4]
    >>> [arc_quadrant(*p, -1) for p in ((5, 0), (0, 5), (-5, 0), (0, -5))]
    [4, 1, 2, 3]
    """
    assert turn in (1, -1), turn
    assert x or y
    if turn > 0:
        if x > 0 and y >= 0:
            return 1
        if x <= 0 and y > 0:
            return 2
        return 3 if x < 0 else 4
    if x >= 0 and y > 0:
        return 1
    if x < 0 and y >= 0:
        return 2
    return 3 if y < 0 and x <= 0 else 4


def arc_steps(x: int, y: int, turn: int, axis: Axis, count: int) -> Iterator[Step]:
    """Step along the arc that starts at (x, y) from its centre until ``count`` steps counted.

    F = x^2 + y^2 - R0^2 is 0 at the start. F >= 0: inwards, along the axis whose magnitude shrinks
    in this quadrant and sense; F < 0: outwards along the other. On an axis the quadrant changes
    and F carries on. ``turn`` is +1 counter-clockwise (NR), -1 clockwise (SR). With
    ``Axis.SQUARE`` a y step counts where |x| > |y| before it, an x step where |x| < |y|, and a y
    step at a tie; with ``Axis.SQUARE_X`` an x step at a tie.

    Raises:
        ValueError: R0^2 < 2 (the path would step onto its centre), or ``count`` is negative.

    >>> "".join(s.axis.name for s in arc_steps(4, 0, +1, Axis.Y, 4))
    'XYYYXY'
    >>> [s.f for s in arc_steps(4, 0, +1, Axis.X, 4)]
    [-7, -6, -3, 2, -3, 4, 1, 0]
    """
    if x * x + y * y < 2 or count < 0:
        raise ValueError(f"arc from ({x}, {y}) never ends on {count} steps")
    f = 0
    while count > 0:
        inwards, outwards = ARC_TABLE[turn, arc_quadrant(x, y, turn)]
        along, sign = inwards if f >= 0 else outwards
        counted = counts(axis, along, x, y)
        if along == Axis.X:
            f += 2 * sign * x + 1
            x += sign
        else:
            f += 2 * sign * y + 1
            y += sign
        count -= counted
        yield Step(along, sign, f, x, y)


def block_steps(block: np.void, table: LineTable = LineTable.MIRROR) -> Iterator[Step]:
    """Yield the steps of one row of dtype ``BLOCK``, places seen from its start; controls none.

    Raises:
        ValueError: the block would never end.
    """
    x, y, axis, count = int(block["x"]), int(block["y"]), Axis(int(block["axis"])), block["count"]
    if block["kind"] == Kind.ARC:
        for s in arc_steps(x, y, int(block["turn"]), axis, int(count)):
            yield Step(s.axis, s.sign, s.f, s.x - x, s.y - y)
    elif block["kind"] in (Kind.LINE, Kind.MOVE):
        yield from line_steps(x, y, axis, int(count), table)

"""Where blocks end and in how many steps, for whole arrays at once and without stepping.

Equal to the loop in ``steps`` for every block (tests prove it); see ``circle`` for the arcs. Work
goes in pieces that stay in the cache.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise.circle import (
    COUNT_MAX,
    R2_MAX,
    R2_MIN,
    Bools,
    Floats,
    Ints,
    apex,
    frame,
    place,
    quadrant,
    tie,
    unframe,
)
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.controllers.stepping import Motion
from wedmcam.ir.program import Axis, Kind

# As plain numbers: comparing an array with a member of an enumeration costs 7 us more.
_X, _Y, _SQUARE, _SQUARE_X = (int(axis) for axis in Axis)

#: Blocks computed at a time: about twenty arrays of this length fit the second-level cache.
PIECE = 8192

#: Quotients of integers below this keep floor and ceil when rounded to float64.
EXACT = 2**52

#: Largest component of a line's direction, and largest count: their products fit int64.
LINE_MAX = 2**30


# --- lines ------------------------------------------------------------------------------------


class LineFrame(NamedTuple):
    """Lines as the table sees them.

    Attributes:
        p: length along the axis that is stepped at F >= 0.
        q: along the other one.
        p_is_x: whether p lies along x.
    """

    p: Ints
    q: Ints
    p_is_x: Bools


def line_frame(x: Ints, y: Ints, table: LineTable) -> LineFrame:
    """Return the lengths along the first and the second axis of the table."""
    ax, ay = np.abs(x), np.abs(y)
    if table == LineTable.MIRROR:
        return LineFrame(ax, ay, np.ones(x.shape, bool))
    if table == LineTable.MIRROR_EXCHANGED:
        return LineFrame(ay, ax, np.zeros(x.shape, bool))
    p_is_x = table.x_first(x, y)
    p_is_x |= (x == 0) | (y == 0)
    return LineFrame(np.where(p_is_x, ax, ay), np.where(p_is_x, ay, ax), p_is_x)


def _lines(x: Ints, y: Ints, axis: NDArray[np.uint8], count: Ints, table: LineTable) -> Motion:
    """Run lines. The i-th p step comes after ceil((i-1) q / p) q steps; see ``steps``."""
    ax, ay = np.abs(x), np.abs(y)
    on_x = (axis == _X) | ((axis == _SQUARE) & (ax > ay))
    if int(axis.max(initial=0)) == _SQUARE_X:
        on_x |= (axis == _SQUARE_X) & (ax >= ay)
    off = np.where(on_x, ay, ax)
    on = ax + ay - off  # length along the counted axis
    ok = (on > 0) & (on <= LINE_MAX) & (off <= LINE_MAX) & (count <= LINE_MAX) & (count > 0)
    if not ok.all():
        moves = _lines(np.where(ok, x, 1), np.where(ok, y, 1), axis, np.where(ok, count, 1), table)
        bad = ~ok
        moves.dx[bad] = 0
        moves.dy[bad] = 0
        moves.steps[bad] = np.where(count[bad] == 0, 0, -1)
        return moves
    on_p = on_x
    if table == LineTable.MIRROR_EXCHANGED:
        on_p = ~on_x | (off == 0)
    elif table == LineTable.ROTATE:
        on_p = on_x ^ (((x ^ y) < 0) & (off > 0))
    elif table == LineTable.ROTATE_EXCHANGED:
        on_p = on_x ^ (((x ^ y) >= 0) & (off > 0))
    # Counting on p: others = ceil((J-1) off / on). On q: one more than the floor, none if off = 0.
    product = (count - 1) * off
    if product.max() < EXACT:
        quotient = product / on  # rounds correctly, so floor and ceil are exact
        whole = np.floor(quotient)
        others = (whole + np.where(on_p, quotient > whole, off > 0)).astype(np.int64)
    else:
        others = (product + (on - 1) * on_p) // on
        others += ~on_p & (off > 0)
    steps = count + others
    along_x = np.where(on_x, count, others)
    return Motion(along_x * np.sign(x), (steps - along_x) * np.sign(y), steps)


def _line_place(x: Ints, y: Ints, n: Ints, table: LineTable) -> tuple[Ints, Ints]:
    """Return where lines stand after n >= 0 steps."""
    f = line_frame(x, y, table)
    p = np.where((f.p > LINE_MAX) | (f.q > LINE_MAX), 0, f.p)
    q = np.where((f.p > LINE_MAX) | (f.q > LINE_MAX), 0, f.q)
    total = np.maximum(p + q, 1)
    along_q = np.where(p > 0, -((-q * np.maximum(n - 1, 0)) // total), np.where(q > 0, n, 0))
    along_p = np.where(p > 0, n - along_q, 0)
    return (
        np.where(f.p_is_x, along_p, along_q) * np.sign(x),
        np.where(f.p_is_x, along_q, along_p) * np.sign(y),
    )


# --- arcs -------------------------------------------------------------------------------------


def arc_valid(x: Floats, y: Floats) -> Bools:
    """Return which starts (relative to the centre) make an arc that ends."""
    r2 = x * x + y * y
    return (r2 >= R2_MIN) & (r2 <= R2_MAX)


class _Stand(NamedTuple):
    """Where arcs stand: at (u, v) of the quadrant ``passed`` quadrants after that of the start."""

    passed: Floats
    u: Floats
    v: Floats


def _counted(r2: Floats, a: Floats, passed: Floats, by_u: Bools, r: Floats) -> _Stand:
    """Stand after the r-th step (1 <= r <= A) along u, or else v, of a quadrant."""
    z = np.where(by_u, a - r + 1.0, r - 1.0)
    left = r2 - 1.0 - z * z
    s = np.floor(np.sqrt(np.maximum(left, 0.0)))
    s[left < 0] = -1.0
    return _Stand(passed, np.where(by_u, a - r, s), np.where(by_u, s + 1.0, r))


def _stand_on_axis(
    r2: Floats, a: Floats, u: Floats, v: Floats, odd: Bools, on_y: Bools, count: Floats
) -> _Stand:
    """Count on x or y: each quadrant counts A steps, along u and v by turns."""
    by_u = on_y == odd  # in the quadrant of the start
    done = np.where(by_u, a - u, v) + (count - 1.0)
    passed = np.floor(done / a)
    r = done - passed * a + 1.0
    return _counted(r2, a, passed, by_u ^ (np.floor(0.5 * passed) * 2.0 != passed), r)


def _stand_on_square(
    r2: Floats, a: Floats, u: Floats, v: Floats, odd: Bools, count: Floats
) -> _Stand:
    """Count on the square: v steps before the tie (h, h), u steps after it, at it the y step.

    Even quadrants have v along y, so they count 2 h + 2 w - 1 steps, w = 1 where the tie is left
    by a v step; odd ones count 2 h.
    """
    h, outwards = tie(r2)
    w = outwards.astype(np.float64)
    even_all = 2.0 * h + 2.0 * w - 1.0
    start_all = np.where(odd, 2.0 * h, even_all)
    done = np.where(v <= u, v, start_all - u) + np.where(odd, even_all, 0.0) + (count - 1.0)
    period = even_all + 2.0 * h
    halves = np.floor(done / period)
    done -= halves * period
    in_odd = done >= even_all
    c = done - np.where(in_odd, even_all, 0.0) + 1.0
    by_u = c > h + np.where(in_odd, 0.0, w)
    r = np.where(by_u, a - np.where(in_odd, 2.0 * h, even_all) + c, c)
    return _counted(r2, a, 2.0 * halves + in_odd - odd, by_u, r)


def _arcs(x: Ints, y: Ints, turn: Floats, axis: NDArray[np.uint8], count: Ints) -> Motion:
    """Run arcs."""
    if int(axis.max(initial=0)) == _SQUARE_X:
        other = axis == _SQUARE_X
        # With x and y exchanged an arc turns the other way, and its square is that with y at a tie.
        moves = _arcs(
            np.where(other, y, x),
            np.where(other, x, y),
            np.where(other, -turn, turn),
            np.where(other, np.uint8(Axis.SQUARE), axis),
            count,
        )
        return Motion(
            np.where(other, moves.dy, moves.dx), np.where(other, moves.dx, moves.dy), moves.steps
        )
    fx, fy, fj = x.astype(np.float64), y.astype(np.float64), count.astype(np.float64)
    ok = arc_valid(fx, fy) & (fj > 0) & (fj <= COUNT_MAX) & (np.abs(turn) == 1)
    if not ok.all():
        bad = ~ok
        moves = _arcs(
            np.where(ok, x, 2),
            np.where(ok, y, 0),
            np.where(ok, turn, 1.0),
            axis,
            np.where(ok, count, 1),
        )
        moves.dx[bad] = 0
        moves.dy[bad] = 0
        idle = arc_valid(fx, fy) & (fj == 0)
        moves.steps[bad] = np.where(idle[bad], 0, -1)
        return moves
    r2 = fx * fx + fy * fy
    a = apex(r2)
    f = frame(fx, fy, turn)
    square = axis == _SQUARE
    if not square.any():
        end = _stand_on_axis(r2, a, f.u, f.v, f.odd, axis == _Y, fj)
    elif square.all():
        end = _stand_on_square(r2, a, f.u, f.v, f.odd, fj)
    else:
        one = _stand_on_axis(r2, a, f.u, f.v, f.odd, axis == _Y, fj)
        two = _stand_on_square(r2, a, f.u, f.v, f.odd, fj)
        end = _Stand(*(np.where(square, s, t) for s, t in zip(two, one, strict=True)))
    steps = 2.0 * a * end.passed + (f.u - f.v) - (end.u - end.v)
    ex, ey = unframe(quadrant(f) + end.passed, end.u, end.v, turn)
    return Motion((ex - fx).astype(np.int64), (ey - fy).astype(np.int64), steps.astype(np.int64))


def _arc_place(x: Ints, y: Ints, turn: Floats, n: Ints) -> tuple[Ints, Ints]:
    """Return where arcs stand after n >= 0 steps, from their start."""
    fx, fy = x.astype(np.float64), y.astype(np.float64)
    ok = arc_valid(fx, fy) & (np.abs(turn) == 1) & (n > 0)
    fx, fy, turn = np.where(ok, fx, 2.0), np.where(ok, fy, 0.0), np.where(ok, turn, 1.0)
    r2 = fx * fx + fy * fy
    a = apex(r2)
    f = frame(fx, fy, turn)
    k = np.where(ok, n, 1) + (a - f.u + f.v)
    passed = np.floor((k - 1.0) / (2.0 * a))
    u, v = place(r2, a, k - 2.0 * a * passed)
    ex, ey = unframe(quadrant(f) + passed, u, v, turn)
    return (
        np.where(ok, ex - fx, 0.0).astype(np.int64),
        np.where(ok, ey - fy, 0.0).astype(np.int64),
    )


# --- blocks -----------------------------------------------------------------------------------


def run(blocks: NDArray[np.void], table: LineTable = LineTable.MIRROR) -> Motion:
    """Return where each block of dtype ``BLOCK`` ends, from its start, and in how many steps.

    A MOVE steps like a line, control blocks do nothing, invalid blocks have steps -1 (`Motion`).
    A count of 0 makes no step.

    >>> from wedmcam.ir.program import BLOCK
    >>> b = np.zeros(1, BLOCK)
    >>> b["kind"], b["turn"], b["axis"], b["count"] = Kind.ARC, 1, Axis.Y, 25440
    >>> b["x"], b["y"] = -2000, 9000  # B2000B9000B25440GYNR2, to (9000, -2000)
    >>> m = run(b)
    >>> int(m.dx[0]), int(m.dy[0])
    (11000, -11000)
    """
    total = len(blocks)
    out = Motion(np.zeros(total, np.int64), np.zeros(total, np.int64), np.zeros(total, np.int64))
    for first in range(0, total, PIECE):
        rows = slice(first, first + PIECE)
        part = blocks[rows]
        kind = part["kind"]
        x, y, count, axis = (np.ascontiguousarray(part[k]) for k in ("x", "y", "count", "axis"))
        is_arc = kind == Kind.ARC
        is_line = (kind == Kind.LINE) | (kind == Kind.MOVE)
        for mask in (is_line, is_arc):
            if not mask.any():
                continue
            pick = None if mask.all() else np.flatnonzero(mask)
            values = (x, y, axis, count)
            if pick is not None:
                values = (x[pick], y[pick], axis[pick], count[pick])
            if mask is is_line:
                moves = _lines(*values, table)
            else:
                turn = (part["turn"] if pick is None else part["turn"][pick]).astype(np.float64)
                moves = _arcs(values[0], values[1], turn, values[2], values[3])
            for target, value in zip(out, moves, strict=True):
                if pick is None:
                    target[rows] = value
                else:
                    target[rows][pick] = value
    return out


def position(
    blocks: NDArray[np.void], n: Ints, table: LineTable = LineTable.MIRROR
) -> tuple[Ints, Ints]:
    """Return (dx, dy): where each block stands after ``n`` of its steps, from its start, um.

    For pausing and retreat. The count of the block is not looked at: past its end the line or arc
    goes on (compare with ``run(blocks).steps``), up to n = 2 `LINE_MAX`. n <= 0 is the start.
    Control blocks and blocks that cannot step stay at (0, 0).
    """
    dx, dy = np.zeros(len(blocks), np.int64), np.zeros(len(blocks), np.int64)
    n = np.clip(np.asarray(n, np.int64), 0, 2 * LINE_MAX)  # so that products fit int64
    for first in range(0, len(blocks), PIECE):
        rows = slice(first, first + PIECE)
        part = blocks[rows]
        kind = part["kind"]
        x, y = np.ascontiguousarray(part["x"]), np.ascontiguousarray(part["y"])
        pick = np.flatnonzero((kind == Kind.LINE) | (kind == Kind.MOVE))
        if len(pick):
            dx[rows][pick], dy[rows][pick] = _line_place(x[pick], y[pick], n[rows][pick], table)
        pick = np.flatnonzero(kind == Kind.ARC)
        if len(pick):
            turn = part["turn"][pick].astype(np.float64)
            dx[rows][pick], dy[rows][pick] = _arc_place(x[pick], y[pick], turn, n[rows][pick])
    return dx, dy

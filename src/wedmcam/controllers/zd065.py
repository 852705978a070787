"""The ZD-065's own data processing (数据处理): rotation and gap compensation, in 8-digit decimals.

A file in the rotation or the compensation format is no cutting program: the controller makes one of
it, with the copies and the gap that the operator enters. This is what the target does, so it stands
beside the interpolators: writers aim at it and the judge judges what comes out. The precision is
the paper's [S]; the order of the operations is ours [R].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.decimal8 import Decimal8Array
from wedmcam.ir.program import BLOCK, Axis, Kind

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

#: One row per block of the rotation format. start, sweep: degrees of 8 digits (the float64 nearest
#: to them); size: R of an arc or length of a line, um. Controls have no angle and no size.
POLAR = np.dtype([("kind", "u1"), ("turn", "i1"), ("start", "f8"), ("size", "i8"), ("sweep", "f8")])

#: One row per block of the compensation format. grows: +1 where the radius grows when the path is
#: offset outwards (type 0x01), -1 where it shrinks (0x02), 0 for what is no arc. axis: on which J
#: of an arc is counted. um.
OUTLINE = np.dtype(
    [
        ("kind", "u1"),
        ("turn", "i1"),
        ("grows", "i1"),
        ("axis", "u1"),
        ("radius", "i8"),
        ("x", "i8"),
        ("y", "i8"),
        ("count", "i8"),
    ]
)


def _number(values: ArrayLike) -> Decimal8Array:
    return Decimal8Array.from_values(np.asarray(values, dtype=np.float64))


def _whole(a: Any) -> Ints:
    """Nearest whole um, halves away from zero."""
    return np.asarray(a.rint().to_int(), dtype=np.int64)


def _blocks(kind: NDArray[Any], turn: NDArray[Any], x: Ints, y: Ints, arc_count: Ints) -> Any:
    """Return cutting blocks; a line's J and axis are what the controller derives."""
    out = np.zeros(len(kind), dtype=BLOCK)
    out["source"] = -1
    arc = kind == Kind.ARC
    line = (kind == Kind.LINE) | (kind == Kind.MOVE)
    out["kind"], out["turn"] = kind, np.where(arc, turn, 0)
    out["x"], out["y"] = np.where(arc | line, x, 0), np.where(arc | line, y, 0)
    ax, ay = abs(out["x"]), abs(out["y"])
    out["axis"] = np.where(arc, Axis.SQUARE, np.where(line & (ax <= ay), Axis.Y, Axis.X))
    out["count"] = np.where(arc, arc_count, np.where(line, np.maximum(ax, ay), 0))
    return out


def rotate(figure: NDArray[np.void], copies: int = 0, step: float = 0.0) -> NDArray[np.void]:
    """Return the cutting blocks of a figure in rotation format and of its copies.

    Args:
        figure: dtype `POLAR`.
        copies: 0 to 99; copy k follows copy k - 1 and is turned by k times ``step`` from the
            figure itself.
        step: degrees, counter-clockwise.

    Returns:
        dtype `BLOCK`; each number within 1 um of the exact one for radii up to 1 m.

    >>> f = np.zeros(1, POLAR)
    >>> f[0] = (Kind.LINE, 0, 30.0, 20_000, 0.0)
    >>> [rotate(f, 2, 60.0)[k].tolist() for k in ("x", "y")]
    [[17321, 0, -17321], [10000, 20000, 10000]]
    """
    assert 0 <= copies <= 99, copies
    n = len(figure)
    rows = np.tile(figure, copies + 1)
    number = np.repeat(np.arange(copies + 1), n)
    start = rows["start"]
    if copies:
        turned = _number(start) + _number(number) * _number(np.full(len(rows), step))
        start = turned.to_float() % 360.0
    angle, size = _number(start), _number(rows["size"])
    x, y = _whole(size * angle.cos(degrees=True)), _whole(size * angle.sin(degrees=True))
    count = np.zeros(len(rows), dtype=np.int64)
    arc = np.flatnonzero(rows["kind"] == Kind.ARC)
    if len(arc):
        sweep = rows["sweep"][arc] * rows["turn"][arc]
        end = (_number(start[arc]) + _number(sweep)).to_float()
        count[arc] = square_count(start[arc], end, rows["size"][arc])
    return np.asarray(_blocks(rows["kind"], rows["turn"], x, y, count))


def square_count(start: Floats, end: Floats, radius: Ints) -> Ints:
    """Return J of arcs along the sides of the inscribed square, by geometry, in 8-digit decimals.

    Args:
        start: polar angle, degrees, about the centre.
        end: likewise; end - start is the signed sweep.
        radius: um.

    >>> square_count(np.array([0.0]), np.array([360.0]), np.array([10_000])).tolist()
    [56569]
    """
    sides = []
    for a in (start, end):
        n = np.floor(a / 90.0 + 0.5)
        # From the side's middle at 90 n degrees: R sin; a whole side is R sqrt(2).
        sides.append((n, _number(a - 90.0 * n).sin(degrees=True)))
    (n0, s0), (n1, s1) = sides
    root = _number(np.full(len(start), 2.0)).sqrt()
    return abs(_whole(_number(radius) * (_number(n1 - n0) * root + (s1 - s0))))


def compensate(figure: NDArray[np.void], gap_um: int, outwards: bool = True) -> NDArray[np.void]:
    """Return the cutting blocks of a figure in compensation format, offset by the gap.

    Lines stay as they are; x, y and J of an arc are scaled by (R + gap) / R or (R - gap) / R. That
    is the offset path where all joints are tangent.

    Args:
        figure: dtype `OUTLINE`; R - gap > 0 for every arc that shrinks.
        gap_um: whole um, 0 to 7999 on the machine [S].
        outwards: True for a punch (凸模), False for a die (凹模).

    Returns:
        dtype `BLOCK`.

    >>> f = np.zeros(1, OUTLINE)
    >>> f[0] = (Kind.ARC, 1, 1, Axis.SQUARE, 5_000, 3_000, 4_000, 7_071)
    >>> [compensate(f, 100)[k].tolist() for k in ("x", "y", "count")]
    [[3060], [4080], [7212]]
    """
    x, y, count = (figure[k].astype(np.int64).copy() for k in ("x", "y", "count"))
    arc = np.flatnonzero(figure["kind"] == Kind.ARC)
    if len(arc) and gap_um:
        sign = figure["grows"][arc].astype(np.int64) * (1 if outwards else -1)
        radius = figure["radius"][arc]
        assert (radius + sign * gap_um > 0).all()
        factor = _number(radius + sign * gap_um) / _number(radius)
        for column in (x, y, count):
            column[arc] = _whole(_number(column[arc]) * factor)
    blocks = np.asarray(_blocks(figure["kind"], figure["turn"], x, y, count))
    blocks["axis"][arc] = figure["axis"][arc]
    return blocks

"""The data that the ZD-065 processes: blocks of its two other formats, and numbers of 8 digits.

What a block holds is the paper's [S]. Lengths are um, angles degrees.
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

#: One row per motion of a path that starts at (0, 0), before it is stated in any format. x, y: its
#: end; radius of an arc, um. sweep: of an arc, degrees, up to 360. start: polar angle of the start
#: of a full circle about its centre, degrees: its end does not tell where it lies.
WAY = np.dtype(
    [
        ("kind", "u1"),
        ("turn", "i1"),
        ("x", "f8"),
        ("y", "f8"),
        ("radius", "f8"),
        ("sweep", "f8"),
        ("start", "f8"),
    ]
)


def decimals(values: ArrayLike) -> Decimal8Array:
    """Return values rounded to 8 digits."""
    return Decimal8Array.from_values(np.asarray(values, dtype=np.float64))


def whole(a: Any) -> Ints:
    """Nearest whole um, halves away from zero."""
    return np.asarray(a.rint().to_int(), dtype=np.int64)


def cutting_blocks(
    kind: NDArray[Any], turn: NDArray[Any], x: Ints, y: Ints, arc_count: Ints
) -> Any:
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


def displacements(figure: NDArray[np.void]) -> NDArray[np.complex128]:
    """Return the way that each polar block (dtype `POLAR`) makes, um, exactly as stated.

    >>> row = np.zeros(1, POLAR)
    >>> row[0] = (Kind.ARC, 1, 0.0, 1000, 90.0)
    >>> displacements(row).round(6).tolist()
    [(-1000+1000j)]
    """
    arc = figure["kind"] == Kind.ARC
    half = np.radians(figure["sweep"]) / 2
    turn = figure["turn"].astype(np.float64)
    heading = np.radians(figure["start"]) + np.where(arc, turn * (half + np.pi / 2), 0.0)
    length = np.where(arc, 2 * figure["size"] * np.sin(half), figure["size"])
    return np.asarray(length * np.exp(1j * heading))

"""Rotation (旋转): a figure of polar blocks, and its copies, as cutting data.

The precision is the paper's [S]; the order of the operations is ours [R]. `rotate` is the literal
processing, each block by itself; `rotate_closed` computes where every vertex is, and makes blocks
that arrive there. So that 8 digits last for R of 10 m and a hundred copies, an angle is whole
degrees and a rest, and so is a length whole um and a rest of 8 digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import Floats, Ints, cutting_blocks, decimals, whole
from wedmcam.controllers.zd065.loop import EXACT, Followed, follow
from wedmcam.decimal8 import Decimal8Array
from wedmcam.ir.program import Kind

#: Units of the rest of a length: 8 digits behind the point.
_REST = 100_000_000


def rotate(figure: NDArray[np.void], copies: int = 0, step: float = 0.0) -> NDArray[np.void]:
    """Return the cutting blocks of a figure in rotation format and of its copies.

    Args:
        figure: dtype `POLAR`.
        copies: 0 to 99; copy k follows copy k - 1 and is turned by k times ``step`` from the
            figure itself.
        step: degrees, counter-clockwise.

    Returns:
        dtype `BLOCK`; each number within 1 um of the exact one for radii up to 1 m.

    >>> from wedmcam.controllers.zd065.data import POLAR
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
        turned = decimals(start) + decimals(number) * decimals(np.full(len(rows), step))
        start = turned.to_float() % 360.0
    angle, size = decimals(start), decimals(rows["size"])
    x, y = whole(size * angle.cos(degrees=True)), whole(size * angle.sin(degrees=True))
    count = np.zeros(len(rows), dtype=np.int64)
    arc = np.flatnonzero(rows["kind"] == Kind.ARC)
    if len(arc):
        sweep = rows["sweep"][arc] * rows["turn"][arc]
        end = (decimals(start[arc]) + decimals(sweep)).to_float()
        count[arc] = square_count(start[arc], end, rows["size"][arc])
    return np.asarray(cutting_blocks(rows["kind"], rows["turn"], x, y, count))


def rotate_closed(figure: NDArray[np.void], copies: int = 0, step: float = 0.0) -> Followed:
    """Return cutting data of a figure and its copies whose vertices are within 1 um.

    So it is for paths that stay within 10 m of their start: of what lies farther off 8 digits are
    too few.

    Args:
        figure: dtype `POLAR`.
        copies: 0 to 99.
        step: degrees, counter-clockwise.

    Returns:
        From (0, 0) on; its rows are those of the figure, copy after copy.

    >>> from wedmcam.controllers.zd065.data import POLAR
    >>> f = np.zeros(1, POLAR)
    >>> f[0] = (Kind.LINE, 0, 5.0, 8_716, 0.0)
    >>> made = rotate_closed(f, 35, 10.0)
    >>> made.ends[-1].tolist(), bool(made.miss.max() < 0.71)
    ([0, 0], True)
    """
    return follow(exact_path(figure, copies, step))


def exact_path(figure: NDArray[np.void], copies: int = 0, step: float = 0.0) -> NDArray[np.void]:
    """Return where every vertex of a figure and its copies is, in 8-digit arithmetic.

    Args:
        figure: dtype `POLAR`.
        copies: 0 to 99.
        step: degrees, counter-clockwise.

    Returns:
        dtype `EXACT`, from (0, 0) on; ``source`` is the row of the figure.
    """
    assert 0 <= copies <= 99, copies
    rows = np.tile(figure, copies + 1)
    number = np.repeat(np.arange(copies + 1), len(figure))
    arc = rows["kind"] == Kind.ARC
    turn = np.where(arc, rows["turn"], 0).astype(np.int64)
    # The heading of a line, or of the chord: that needs no centre, which at R 10 m loses 2 um.
    degree, rest = _degrees(rows["start"])
    by, by_rest = _degrees(np.full(len(rows), step))
    degree, rest = degree + number * by, rest + by_rest * decimals(number)
    start = (degree + rest.to_float()) % 360.0
    half, half_rest = _degrees(rows["sweep"] / 2.0)
    degree, rest = degree + turn * (90 + half), rest + half_rest * decimals(turn)
    quarters = np.floor((degree + rest.to_float()) / 90.0 + 0.5).astype(np.int64)
    small = decimals(degree - 90 * quarters) + rest
    # The chord is 2 R sin(sweep / 2).
    sine = (decimals(half) + half_rest).sin(degrees=True)
    length, length_rest = _times(2 * rows["size"], decimals(np.zeros(len(rows))), sine)
    length = np.where(arc, length, rows["size"])
    length_rest = length_rest * decimals(arc.astype(np.int64))
    along = _fixed(*_times(length, length_rest, small.cos(degrees=True)))
    across = _fixed(*_times(length, length_rest, small.sin(degrees=True)))
    quarter, minus = quarters % 4, np.where(quarters % 4 >= 2, -1, 1)
    odd = quarter % 2 == 1
    x, y = minus * np.where(odd, -across, along), minus * np.where(odd, along, across)
    path = np.zeros(len(rows), EXACT)
    path["kind"], path["turn"], path["start"] = rows["kind"], turn, start
    path["x"], path["y"] = np.cumsum(x) / _REST, np.cumsum(y) / _REST
    path["radius"], path["sweep"] = np.where(arc, rows["size"], 0), np.where(arc, rows["sweep"], 0)
    path["source"] = np.tile(np.arange(len(figure)), copies + 1)
    return path


def _degrees(angle: Floats) -> tuple[Ints, Decimal8Array]:
    """Return whole degrees and the rest, which has all digits of its own."""
    degree = np.floor(angle)
    return degree.astype(np.int64), decimals(np.round(angle - degree, 8))


def _times(um: Ints, rest: Decimal8Array, factor: Decimal8Array) -> tuple[Ints, Decimal8Array]:
    """Return a length times a factor of -1 to 1, as whole um and a rest, um.

    The first 4 digits of each give whole um; what is left is small enough for 8 digits.
    """
    ten = 10_000
    head, high = whole(factor * ten), um // ten
    tail = factor - decimals(head) / ten
    return high * head, decimals(high * ten) * tail + (decimals(um % ten) + rest) * factor


def _fixed(um: Ints, rest: Decimal8Array) -> Ints:
    """Return a length of whole um and a rest in units of 1e-8 um, of which sums are exact."""
    carry = whole(rest)
    return (um + carry) * _REST + whole((rest - decimals(carry)) * _REST)


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
        sides.append((n, decimals(a - 90.0 * n).sin(degrees=True)))
    (n0, s0), (n1, s1) = sides
    root = decimals(np.full(len(start), 2.0)).sqrt()
    return abs(whole(decimals(radius) * (decimals(n1 - n0) * root + (s1 - s0))))

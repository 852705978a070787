"""Rotation (旋转): a figure of polar blocks, and its copies, as cutting data.

The precision is the paper's [S]; the order of the operations is ours [R]. `rotate` is the literal
processing, each block by itself; `rotate_closed` computes where every vertex is, and makes blocks
that arrive there. So that 8 digits last for R of 10 m and a hundred copies, angles, sines and
lengths are whole units and a rest of 8 digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.controllers.zd065.data import Floats, Ints, cutting_blocks, decimals, whole
from wedmcam.controllers.zd065.loop import EXACT, Followed, follow
from wedmcam.decimal8 import Decimal8Array
from wedmcam.ir.program import Kind

#: A number of more than 8 digits: whole units, and a rest that has 8 digits of its own.
Split = tuple[Ints, Decimal8Array]
#: Units in a um of the rest of a length: 8 digits behind the point; and in a degree, with the half.
_REST, _DEGREE = 100_000_000, 200_000_000
#: Units in 1 of a sine, and um in a unit of a long length: 4 digits, so products are exact.
_HEAD = 10_000
#: Sines of whole degrees; of each the units and 8 digits of the rest are used.
_TABLE = np.sin(np.radians(np.arange(360)))


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
    start = (_angle(rows["start"]) + number * _angle(step)) % (360 * _DEGREE)
    half = _angle(rows["sweep"]) // 2
    # The heading of a line, or of the chord: that needs no centre, which at R 10 m loses 2 um.
    cosine, sine = _turn(start + turn * (90 * _DEGREE + half))
    um, rest = _times((2 * rows["size"], decimals(np.zeros(len(rows)))), _turn(half)[1])
    chord = np.where(arc, um, rows["size"]), rest * decimals(arc.astype(np.int64))
    path = np.zeros(len(rows), EXACT)
    for name, factor in (("x", cosine), ("y", sine)):
        path[name] = np.cumsum(_fixed(*_times(chord, factor))) / _REST
    path["kind"], path["turn"], path["start"] = rows["kind"], turn, start / _DEGREE
    path["radius"], path["sweep"] = np.where(arc, rows["size"], 0), np.where(arc, rows["sweep"], 0)
    path["source"] = np.tile(np.arange(len(figure)), copies + 1)
    return path


def _angle(degrees: ArrayLike) -> Ints:
    """Return angles in units of `_DEGREE`, in which sums are exact."""
    return np.rint(np.asarray(degrees, np.float64) * _DEGREE).astype(np.int64)


def _turn(angle: Ints) -> tuple[Split, Split]:
    """Return cosine and sine, each as units of 1e-4 and a rest.

    A table holds those of whole degrees; the part of a degree that is left changes them so little
    that 8 digits of the change are 1e-10.
    """
    degree = (angle + _DEGREE // 2) // _DEGREE
    part = decimals((angle - degree * _DEGREE) / _DEGREE)
    sine, fall = part.sin(degrees=True), (part / 2).sin(degrees=True) ** 2 * 2
    c, s = (_TABLE[(degree + shift) % 360] for shift in (90, 0))
    changes = -(decimals(c) * fall) - decimals(s) * sine, decimals(c) * sine - decimals(s) * fall
    return _split(c, changes[0]), _split(s, changes[1])


def _split(value: Floats, change: Decimal8Array) -> Split:
    """Return a number of the table and a small change of it as units and a rest."""
    head = np.rint((value + change.to_float()) * _HEAD).astype(np.int64)
    return head, decimals(value - head / _HEAD) + change


def _times(length: Split, factor: Split) -> Split:
    """Return a length (um and rest) times a factor, as whole um and a rest.

    The 4 digits in front of both give whole um; what is left is small enough for 8 digits.
    """
    (um, rest), (head, tail) = length, factor
    high, low = um // _HEAD, decimals(um % _HEAD) + rest
    return high * head, decimals(high * _HEAD) * tail + low * (decimals(head) / _HEAD + tail)


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

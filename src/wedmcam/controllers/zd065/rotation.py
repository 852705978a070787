"""Rotation (旋转): a figure of polar blocks, and its copies, as cutting data.

The precision is the paper's [S]; the order of the operations is ours [R].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import Floats, Ints, cutting_blocks, decimals, whole
from wedmcam.ir.program import Kind


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

"""What the 8085 computes for one vector: POSCAL and the routines that it calls, for whole arrays.

A displacement (dx, dy) and a cutting speed become a speed of each axis. Positions are unsigned
16-bit numbers, speeds 7-bit ones of 262.5 nm/s. Names are those of the report (section 5.2):
SUBSGN, REDUC, SQUARE, VERM, DIVIDE, VELOCM, POSCAL. Where the report leaves something open, the
ruling is beside it. `sine_speeds` is what its author would try next (section 6.3): sine and cosine
from a table.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Largest 16-bit number, largest speed (7 bits).
WORD, FASTEST = 0xFFFF, 127
#: One unit of speed, um a second: 15.75 um a minute, and 2.0 mm a minute for the largest. (The text
#: prints 252.6 nm/s, which gives neither.)
SPEED_UM_PER_S = 0.2625
#: Entries of the table of sines, over a quarter wave, and its largest value (8 bits).
ENTRIES, FULL = 255, 255


class Speeds(NamedTuple):
    """How fast each axis runs, one entry a vector; a step of an axis takes a time of 1 / speed.

    Attributes:
        x, y: magnitudes, in units of ``SPEED_UM_PER_S / scale``.
        scale: how many of them make a unit of speed.
    """

    x: Ints
    y: Ints
    scale: int


def subsgn(a: ArrayLike, b: ArrayLike) -> tuple[Ints, Ints]:
    """SUBSGN: return |a - b| and the sign of a - b; the sign of 0 is positive.

    Args:
        a, b: 16-bit numbers.

    >>> [v.tolist() for v in subsgn([5, 3, 4], [3, 5, 4])]
    [[2, 2, 0], [1, -1, 1]]
    """
    d = np.subtract(a, b, dtype=np.int64)
    return np.abs(d), np.where(d < 0, -1, 1)


def reduc(a: Ints, b: Ints) -> tuple[Ints, Ints]:
    """REDUC: return two numbers halved together, the rest dropped, until a^2 + b^2 fits 16 bits.

    Together: else their ratio would be lost. That they are halved until the squares fit, and not
    until they are bytes, is a ruling: SQUARE and the root are of 16 bits.

    Args:
        a, b: 16-bit numbers.

    >>> reduc(np.array([65535, 255, 181]), np.array([255, 255, 181]))
    (array([255, 127, 181]), array([  0, 127, 181]))
    """
    a, b = np.array(a, np.int64), np.array(b, np.int64)
    while (large := a * a + b * b > WORD).any():
        a, b = a >> large, b >> large
    return a, b


@cache
def _roots() -> Ints:
    """Return the root of every 16-bit number, by the iteration of `root`, all at once."""
    n = np.arange(WORD + 1, dtype=np.int64)
    x, new = n.copy(), (n + 1) // 2
    while (left := np.flatnonzero(x != new)).size:
        x[left] = new[left]
        new[left] = (n[left] // x[left] + x[left] + 1) // 2
    x.flags.writeable = False
    return x


def root(n: ArrayLike) -> Ints:
    """Return the square root of 16-bit numbers by Newton's iteration exactly as printed.

    ``x := n; xnew := (n + 1) / 2; while x <> xnew: x := xnew; xnew := (n / x + x + 1) / 2``. Sums
    are computed as if they had room: in 16 bits n = 65535 alone would give 0, and that is no sum of
    two squares.

    >>> root(range(9)).tolist()
    [0, 1, 2, 2, 2, 2, 3, 3, 3]
    """
    return np.asarray(_roots()[np.asarray(n)])


def divide(a: Ints, b: Ints) -> Ints:
    """DIVIDE: return whole quotients; 0 where either number is 0, 1 where a < b.

    The text prints the last case the other way round ('denominator smaller than numerator'), which
    would make every quotient 1: a ruling.

    >>> divide(np.array([7, 0, 7, 2]), np.array([2, 3, 0, 7])).tolist()
    [3, 0, 0, 1]
    """
    whole = a // np.maximum(b, 1)
    return np.where((a == 0) | (b == 0), 0, np.maximum(whole, 1))


def poscal(dx: Ints, dy: Ints, speed: Ints) -> Speeds:
    """POSCAL: return the speeds of both axes along vectors, by the root of their length.

    VELOCM multiplies first and divides then. Speeds are 7-bit numbers; the direction bits are the
    signs of dx and dy.

    Args:
        dx, dy: displacements in the positions' unit, magnitudes up to 65535.
        speed: 1 to 127.

    >>> poscal(np.array([100, 100, 3]), np.array([-100, 1, 4]), np.array([127, 1, 10]))[:2]
    (array([90,  1,  6]), array([90,  1,  8]))
    """
    a, b = reduc(np.abs(dx), np.abs(dy))
    length = root(a * a + b * b)
    return Speeds(divide(a * speed, length), divide(b * speed, length), 1)


@cache
def sines() -> Ints:
    """Return the table: 255 values of 8 bits, the sine over a quarter wave, both ends included.

    The cosine is the same table read backwards.

    >>> sines()[[0, 1, 127, 254]].tolist()
    [0, 2, 180, 255]
    """
    table = np.floor(FULL * np.sin(np.linspace(0.0, np.pi / 2, ENTRIES)) + 0.5).astype(np.int64)
    table.flags.writeable = False
    return table


def entry(a: Ints, b: Ints) -> Ints:
    """Return the entry of the table whose direction is nearest to (a, b), numbers not below 0.

    Found by halving, with products of 16 and 9 bits: the direction between two entries is the sum
    of both.

    >>> entry(np.array([1, 1, 0]), np.array([0, 1, 5])).tolist()
    [0, 127, 254]
    """
    s = sines()
    c = s[::-1]
    low = np.zeros(np.shape(a), np.int64)
    high = np.full(np.shape(a), ENTRIES - 1)
    for _ in range(8):  # 255 entries
        middle = (low + high) // 2
        after = np.minimum(middle + 1, ENTRIES - 1)
        above = b * (c[middle] + c[after]) > a * (s[middle] + s[after])
        above &= middle < high
        low, high = np.where(above, middle + 1, low), np.where(above, high, middle)
    return low


def sine_speeds(dx: Ints, dy: Ints, speed: Ints) -> Speeds:
    """Return the speeds of both axes along vectors, by sine and cosine from the table.

    The report has this as advice alone. Rulings: the entry is that of the nearest direction, and
    the products of VERM are not divided, so a timer counts in 255ths of a unit of speed: divided,
    low speeds would lose the direction again.

    >>> sine_speeds(np.array([100]), np.array([-100]), np.array([1]))
    Speeds(x=array([180]), y=array([180]), scale=255)
    """
    at = entry(np.abs(dx), np.abs(dy))
    s = sines()
    return Speeds(speed * s[ENTRIES - 1 - at], speed * s[at], FULL)

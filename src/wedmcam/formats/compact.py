"""The compact cutting format (切割格式) of the ZD-065: instruction codes and packed BCD.

One block after the other, no gaps::

    arc   instruction 1 . x 4 . y 4 . J 3      12 bytes
    line  instruction 1 . x 3 . y 3             7 bytes, moves likewise
    30    thread point, 31 pause                1 byte
    00    end of the data

Numbers are packed BCD, most significant digit first, magnitudes in um; the quadrant is in the
instruction. x, y of an arc are its start relative to its centre, of a line its end relative to its
start. No block states a count direction, and a line no J: the controller derives them. Widths are
the paper's [S]; the codes are reconstructed [R], as the paper does not print them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Axis

LINE, CW, CCW, MOVE = 0x00, 0x10, 0x20, 0x40  # [R]; add the quadrant 1..4
THREAD, PAUSE, END = 0x30, 0x31, 0x00  # [R]; END [D]: unused memory is cleared to 0
ARC_BYTES, LINE_BYTES, WORD_BYTES = 12, 7, 1


def _lengths() -> bytes:
    table = bytearray(256)
    for quadrant in range(1, 5):
        table[LINE + quadrant] = table[MOVE + quadrant] = LINE_BYTES
        table[CW + quadrant] = table[CCW + quadrant] = ARC_BYTES
    table[THREAD] = table[PAUSE] = WORD_BYTES
    return bytes(table)


#: Bytes of the block that an instruction opens; 0 where no block has it (END included).
LENGTH = _lengths()

#: Value of a byte of packed BCD, -1 where a half byte is no digit.
_VALUE = np.array(
    [10 * (b >> 4) + (b & 15) if b >> 4 < 10 and b & 15 < 10 else -1 for b in range(256)],
    dtype=np.int64,
)
_BYTE = np.array([(v // 10 << 4) | v % 10 for v in range(100)], dtype=np.uint8)


def to_bcd(value: int, size: int) -> bytes:
    """Return ``value`` in ``size`` bytes of packed BCD.

    Raises:
        ValueError: negative, or more than 2 * ``size`` digits.

    >>> to_bcd(39600, 3).hex(), to_bcd(10_000_000, 4).hex()
    ('039600', '10000000')
    """
    if not 0 <= value < 100**size:
        raise ValueError(f"{value} does not fit {2 * size} digits")
    return bytes.fromhex(f"{value:0{2 * size}d}")


def from_bcd(data: bytes) -> int:
    """Return the number that packed BCD holds.

    Raises:
        ValueError: a half byte is larger than 9.

    >>> from_bcd(bytes.fromhex("999999"))
    999999
    """
    if not data.hex().isdecimal():
        raise ValueError(f"no packed BCD: {data.hex()}")
    return int(data.hex())


def column_to_bcd(values: NDArray[np.int64], size: int) -> NDArray[np.uint8]:
    """Return the packed BCD of each value, shape (n, size); values must fit.

    >>> column_to_bcd(np.array([39600, 7]), 3).tobytes().hex()
    '039600000007'
    """
    assert not len(values) or (values.min() >= 0 and values.max() < 100**size)
    places = 100 ** np.arange(size - 1, -1, -1, dtype=np.int64)
    packed: NDArray[np.uint8] = _BYTE[values[:, None] // places % 100]
    return packed


def column_from_bcd(raw: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the value of each row of bytes, shape (n,), and the first byte that is no BCD.

    Returns:
        The values, and for each row the index of its first bad byte, or -1.
    """
    pairs = _VALUE[raw]
    bad = pairs < 0
    places = 100 ** np.arange(raw.shape[1] - 1, -1, -1, dtype=np.int64)
    return (np.where(bad, 0, pairs) * places).sum(axis=1), np.where(
        bad.any(axis=1), bad.argmax(axis=1), -1
    )


def line_count(
    x: NDArray[np.int64], y: NDArray[np.int64]
) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """Return axis and J that the controller derives for a line: max(|x|, |y|), y at a tie [D].

    >>> [v.tolist() for v in line_count(np.array([17, 3]), np.array([-5, 3]))]
    [[0, 1], [17, 3]]
    """
    x, y = abs(x), abs(y)
    return np.where(x > y, np.uint8(Axis.X), np.uint8(Axis.Y)), np.maximum(x, y)


def largest_turn(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return a bound on J of one full circle that starts at (x, y) from its centre.

    The sides of the inscribed square: 4 sqrt(2) R; a step more may count at each of the four
    corners and four apexes of a radius that is no whole number.
    """
    return np.ceil(np.hypot(x, y) * 4 * 2**0.5).astype(np.int64) + 8


def loads(sizes: NDArray[np.int64], memory: int) -> int:
    """Return in how many loads blocks of these sizes fit a memory of ``memory`` bytes.

    Each load holds whole blocks and an end byte. ``memory`` must hold the largest block.

    >>> loads(np.full(585, LINE_BYTES), 4096), loads(np.full(586, LINE_BYTES), 4096)
    (1, 2)
    """
    ends = np.cumsum(sizes)
    count, done, at = 0, 0, 0
    while at < len(ends):
        at = int(np.searchsorted(ends, done + memory - 1, side="right"))
        done = int(ends[at - 1])
        count += 1
    return max(count, 1)

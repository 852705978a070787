"""The auxiliary software of the ZD-065 that works on bytes of its memory: display, and data move.

Functions of bytes: an address here is the place in them, from 0. What the paper says is [S].
"""

from __future__ import annotations

#: Memory for data, bytes [S].
SIZE = 4_096
#: The largest address of the machine [S].
LAST_ADDRESS = 0xFFFF
#: Six digits show so many bytes at a time [S].
SHOWN = 3


def display(data: bytes, first: int, last: int) -> list[tuple[int, bytes]]:
    """Return what the six digits show of a range, one group after the other: address and bytes.

    Args:
        data: the memory.
        first, last: addresses, both inclusive. The last group may have one or two bytes [R].

    >>> [(at, group.hex()) for at, group in display(bytes.fromhex("0101700000500030"), 0, 7)]
    [(0, '010170'), (3, '000050'), (6, '0030')]
    """
    return [(at, data[at : min(at + SHOWN, last + 1)]) for at in range(first, last + 1, SHOWN)]


def moved(data: bytes, first: int, last: int, to: int) -> bytes:
    """Return memory in which a range stands elsewhere; where it was is cleared to 0 [S].

    Args:
        data: the memory.
        first, last: addresses of the range, both inclusive.
        to: address of its first byte afterwards; all of it fits the memory.

    Where both ranges overlap, only what is not overwritten is cleared [R].

    >>> moved(bytes([1, 2, 3, 9, 9]), 0, 2, 1).hex()
    '0001020309'
    """
    count = last + 1 - first
    assert 0 <= first <= last < len(data)
    assert 0 <= to <= len(data) - count
    out = bytearray(data)
    out[first : last + 1] = bytes(count)
    out[to : to + count] = data[first : last + 1]
    return bytes(out)

"""Punched tape: 8 channels, 1 inch wide, ISO 840: characters of ISO 646 with even parity.

A row is one character: channels 1 to 7 hold its bits, channel 8 a hole more where their number is
odd [S]. So blank tape (no hole) and rub-out (all eight) are even too, and one hole more or less in
any row, the leader's among them, is found. Rows lie 2.54 mm apart; a small sprocket hole lies
between channels 3 and 4. Marks: [S] states the standard, [R] is our decision.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Rows without a hole before the first character and behind the last one: ten inches [R].
LEADER = 100
#: A row that was punched out: readers pass over it.
RUB_OUT = 0xFF
BLANK = 0x00
#: The reader begins here, and a tape that is rewound stops here.
REWIND_STOP = "%"
ROW_MM = 2.54

_HOLES = np.array([bin(b).count("1") for b in range(256)])


def with_parity(text: str) -> bytes:
    """Return characters of ISO 646 as rows.

    >>> with_parity("%A1").hex()
    'a541b1'
    """
    raw = np.frombuffer(text.encode("ascii"), np.uint8)
    odd = _HOLES[raw] % 2 == 1
    return np.where(odd, raw | 0x80, raw).astype(np.uint8).tobytes()


def punched(text: str) -> bytes:
    """Return a tape: leader, ``%`` and a line end, the lines of a text, leader."""
    blank = bytes(LEADER)
    return blank + with_parity(f"{REWIND_STOP}\n{text}") + blank


def odd_rows(data: bytes) -> NDArray[np.int64]:
    """Return the rows whose parity is wrong, from 0."""
    return np.flatnonzero(_HOLES[np.frombuffer(data, np.uint8)] % 2 == 1)


def before_error(data: bytes) -> bytes:
    r"""Return the whole lines in front of the first row whose parity is wrong.

    >>> before_error(with_parity("%\nM00\nM0") + b"\x01").endswith(with_parity("M00\n"))
    True
    """
    odd = odd_rows(data)
    return data if not len(odd) else data[: data.rfind(b"\n", 0, int(odd[0])) + 1]


def without_parity(data: bytes) -> bytes:
    """Return the characters of rows, blank and rubbed-out rows among them as NUL and DEL."""
    return (np.frombuffer(data, np.uint8) & 0x7F).astype(np.uint8).tobytes()


def readable(data: bytes) -> bytes:
    """Return the characters of rows without blank and rubbed-out ones."""
    return without_parity(bytes(b for b in data if b not in (BLANK, RUB_OUT)))


def name_of(row: int) -> str:
    """Return what a row says, for people.

    >>> [name_of(b) for b in (0x00, 0xFF, 0x0A, 0xA5)]
    ['blank', 'rub-out', 'LF', '%']
    """
    if row in (BLANK, RUB_OUT):
        return "blank" if row == BLANK else "rub-out"
    character = chr(row & 0x7F)
    return {"\n": "LF", "\r": "CR", "\t": "HT", " ": "SP"}.get(character, character)


def rows_text(data: bytes, first: int = 0, last: int | None = None) -> str:
    """Return a picture of a tape in text: a line a row, channel 8 at the left.

    Args:
        data: rows. first: from 0. last: one past the last; None for all.

    Blank rows one after the other are one line.

    >>> print(rows_text(with_parity("%1")))
        row  8 7 6 5 4 . 3 2 1
          1  o . o . . . o . o  %
          2  o . o o . . . . o  1
    """
    out = ["    row  8 7 6 5 4 . 3 2 1"]
    rows = data[first:last]
    at = 0
    while at < len(rows):
        b = rows[at]
        run = 1
        while b == BLANK and at + run < len(rows) and rows[at + run] == BLANK:
            run += 1
        holes = ["o" if b >> k & 1 else "." for k in range(7, -1, -1)]
        marks = " ".join([*holes[:5], ".", *holes[5:]])
        wrong = "  parity" if _HOLES[b] % 2 else ""
        more = f", {run} rows" if run > 1 else ""
        out.append(f"{first + at + 1:7}  {marks}  {name_of(b)}{more}{wrong}")
        at += run
    return "\n".join(out)

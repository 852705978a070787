"""Find 3B records in a text, all at once.

A record is ``B X B Y B J G Z`` on one line, blanks anywhere but inside a number, numbers blank or
of any length. Everything else that a file may hold lies in the gaps between records. The search is
array arithmetic on a window of the text at a time: a file of a million records takes about a
second, and memory for the window.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Characters searched at once: some ten arrays of this length live at the same time.
WINDOW = 1 << 21

_RECORD_END = re.compile(rb"G *+[XY] *+(?:L|[SN] *+R) *+[1-4](?=\D)")
_TOO_LARGE = 10**12


@dataclass(frozen=True, slots=True)
class Records:
    """Records in their order, one element of each array a record.

    Attributes:
        start: offset of the first B.
        end: offset behind the last digit.
        x: magnitude, um; blank is 0, more than 12 digits are 10**12.
        y: likewise.
        count: J, likewise.
        axis: 0 for GX, 1 for GY.
        code: index into ``formats.b3.INSTRUCTIONS``.
        inked: whether the gap before record i, and last the one behind all records, holds anything
            but blanks and line ends; shape (records + 1,).
    """

    start: NDArray[np.int64]
    end: NDArray[np.int64]
    x: NDArray[np.int64]
    y: NDArray[np.int64]
    count: NDArray[np.int64]
    axis: NDArray[np.uint8]
    code: NDArray[np.int64]
    inked: NDArray[np.bool_]


def _number(
    c: NDArray[np.uint8], low: NDArray[np.intp], high: NDArray[np.intp]
) -> NDArray[np.int64]:
    """Return the numbers with the digits ``c[low:high]``."""
    digits = high - low
    value = np.zeros(len(low), dtype=np.int64)
    for place in range(min(int(digits.max(initial=0)), 12)):
        digit = c[np.maximum(high - 1 - place, 0)].astype(np.int64) - 48
        value += np.where(digits > place, digit, 0) * 10**place
    value[digits > 12] = _TOO_LARGE
    return value


def _in_window(window: bytes) -> tuple[list[NDArray[np.int64]], NDArray[np.bool_]]:
    """Return the fields of `Records` of one window, offsets from its start, and ``inked``."""
    raw = np.frombuffer(window, dtype=np.uint8)
    at = np.flatnonzero(raw != 0x20)
    # Behind the end stand six characters that match nothing, so that no index needs a check.
    c = np.concatenate([raw[at], np.zeros(6, dtype=np.uint8)])
    at = np.concatenate([at, len(raw) + 8 * np.arange(1, 7)])
    digit = (c >= 0x30) & (c <= 0x39)
    others = np.concatenate([[0], np.cumsum(~digit, dtype=np.int32)])  # not digits in c[:k]
    ink = np.concatenate([[0], np.cumsum((c != 10) & (c != 0), dtype=np.int32)])

    b = np.flatnonzero(c == ord("B"))
    g = np.flatnonzero(c[:-5] == ord("G"))
    rank = np.searchsorted(b, g)
    g, rank = g[rank >= 3], rank[rank >= 3]
    b1, b2, b3 = b[rank - 3], b[rank - 2], b[rank - 1]
    line = c[g + 2] == ord("L")
    arc = ((c[g + 2] == ord("S")) | (c[g + 2] == ord("N"))) & (c[g + 3] == ord("R"))
    q = g + np.where(arc, 4, 3)
    good = (
        (line | arc)
        & ((c[g + 1] == ord("X")) | (c[g + 1] == ord("Y")))
        & (c[q] >= ord("1"))
        & (c[q] <= ord("4"))
        & ~(digit[q + 1] & (at[q + 1] == at[q] + 1))
    )
    for low, high in ((b1, b2), (b2, b3), (b3, g)):
        good &= others[high] - others[low] == 1  # nothing but digits from one to the next
        # ... and no blank among them
        good &= (high - low == 1) | (at[high - 1] - at[np.minimum(low + 1, high)] == high - low - 2)
    # A fourth B directly before: 4B, whose last three fields are no record.
    b0 = b[np.maximum(rank - 4, 0)]
    good &= ~((rank >= 4) & (others[b1] - others[b0] == 1))

    g, b1, b2, b3, q, arc = (v[good] for v in (g, b1, b2, b3, q, arc))
    code = np.where(arc, np.where(c[g + 2] == ord("N"), 4, 8), 0) + c[q].astype(np.int64) - 49
    edges = np.concatenate([[0], q + 1]), np.concatenate([b1, [len(c) - 6]])
    fields = [
        at[b1],
        at[q] + 1,
        _number(c, b1 + 1, b2),
        _number(c, b2 + 1, b3),
        _number(c, b3 + 1, g),
        (c[g + 1] == ord("Y")).astype(np.int64),
        code,
    ]
    return fields, ink[edges[1]] > ink[edges[0]]


def _cut(codes: bytes, low: int) -> int:
    """Return the end of the window that starts at ``low``: behind a line or a record."""
    high = low + WINDOW
    if high >= len(codes):
        return len(codes)
    if (line := codes.rfind(b"\n", low, high)) >= 0:
        return line + 1
    tail = max(low, high - 4096)
    if ends := [tail + m.end() for m in _RECORD_END.finditer(codes[tail : high + 1])]:
        return ends[-1]
    line = codes.find(b"\n", high)
    return len(codes) if line < 0 else line + 1


def find_records(codes: bytes) -> Records:
    """Return all records in a text of ``frontends.plain``."""
    windows: list[list[NDArray[np.int64]]] = []
    inked: list[NDArray[np.bool_]] = []
    low, tail = 0, False
    while True:
        high = _cut(codes, low)
        fields, ink = _in_window(codes[low:high])
        fields[0] += low
        fields[1] += low
        ink[0] |= tail
        tail = bool(ink[-1])
        windows.append(fields)
        inked.append(ink[:-1])
        if high >= len(codes):
            break
        low = high
    start, end, x, y, count, axis, code = (
        np.concatenate([w[k] for w in windows]) for k in range(7)
    )
    return Records(
        start=start,
        end=end,
        x=x,
        y=y,
        count=count,
        axis=axis.astype(np.uint8),
        code=code,
        inked=np.concatenate([*inked, [tail]]),
    )

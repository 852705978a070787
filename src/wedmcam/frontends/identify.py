"""Say what a file is, by content alone (数据类型的智能识别): format, blocks, last address.

Nothing is ever cleared: the ZD-065 answers random data by clearing its memory; a user's file stays
as it is. Text comes first, because letters and digits of ASCII are valid packed BCD.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.formats import compact
from wedmcam.frontends.compact import addresses
from wedmcam.frontends.plain import plain
from wedmcam.frontends.records import find_records


@dataclass(frozen=True, slots=True)
class Identification:
    """What a file seems to be.

    Attributes:
        format: a key of ``frontends.DECODERS``, or ``empty`` or ``unknown``.
        blocks: complete blocks found; control records of a text are not counted.
        last_address: address of the last byte that belongs to a block or is the end byte; of a text
            the last character of the last record; None where there is none.
        bad_address: address of the first byte that does not fit, or None.
        certain: whether nothing else would do.
        reason: one sentence for people.
    """

    format: str
    blocks: int
    last_address: int | None
    bad_address: int | None
    certain: bool
    reason: str


def identify(data: bytes) -> Identification:
    """Return which format ``data`` has; never raises.

    >>> identify(b"B9900B0B39600GYNR1").format
    '3b'
    >>> identify(bytes.fromhex("01 017000 005000 00")).reason
    'compact cutting format: 1 block, lines alone: the compensation format has the same bytes'
    """
    if not data.rstrip(b"\0"):
        size = len(data)
        return Identification("empty", 0, None, None, True, f"empty: {size} bytes, all 0")
    records = find_records(plain(data).codes)
    if count := len(records.start):
        words = "record" if count == 1 else "records"
        return Identification(
            "3b", count, int(records.end[-1]) - 1, None, True, f"3B text: {count} {words}"
        )
    return _binary(data)


def _binary(data: bytes) -> Identification:
    starts, end = addresses(data)
    bad = _first_bad_digit(data, starts)
    if bad is not None:
        starts = starts[starts + _lengths(data, starts) <= bad]
        end = int(starts[-1] + _lengths(data, starts)[-1]) if len(starts) else 0
    count = len(starts)
    ended = bad is None and end < len(data) and data[end] == compact.END
    if bad is None and not ended:
        bad = end
    words = "block" if count == 1 else "blocks"
    # A number is what random bytes do not make: one digit pair in 2.6 is BCD, and one instruction
    # in 18 is one. A text has no byte 0, a compact program nearly always.
    numbers = int((_lengths(data, starts) > 1).sum())
    text = all(0x20 <= b < 0x7F or b in b"\t\r\n" for b in data[:4096])
    if not numbers or text or (numbers < 2 and not ended):
        where = 0 if bad is None else bad
        kind = "text without a 3B record" if text else "random data or a format not known here"
        reason = f"{kind}; as compact data byte {where:#06x} would be the first that does not fit"
        return Identification("unknown", 0, None, where, False, reason)
    if ended:
        rest = data[end + 1 :]
        if rest.strip(b"\0"):
            bad = end + 1 + next(i for i, b in enumerate(rest) if b)
        codes = np.frombuffer(data, dtype=np.uint8)[starts]
        arcs = (codes & 0xF0 == compact.CW) | (codes & 0xF0 == compact.CCW)
        reason = f"compact cutting format: {count} {words}" + (
            "" if arcs.any() else ", lines alone: the compensation format has the same bytes"
        )
        if bad is not None:
            reason += f"; then other data from {bad:#06x} on"
        return Identification("compact", count, end, bad, bool(arcs.any()), reason)
    reason = f"compact cutting format: {count} {words}, " + (
        "then the data stop without an end byte"
        if bad is None or bad >= len(data)
        else f"damaged at {bad:#06x}"
    )
    fits = None if bad is not None and bad >= len(data) else bad
    return Identification("compact", count, end - 1, fits, False, reason)


def _lengths(data: bytes, starts: NDArray[np.int64]) -> NDArray[np.int64]:
    codes = np.frombuffer(data, dtype=np.uint8)[starts]
    table = np.frombuffer(compact.LENGTH, dtype=np.uint8).astype(np.int64)
    lengths: NDArray[np.int64] = table[codes]
    return lengths


def _first_bad_digit(data: bytes, starts: NDArray[np.int64]) -> int | None:
    """Return the address of the first byte of a number that is no packed BCD, or None."""
    raw = np.frombuffer(data, dtype=np.uint8)
    number = np.zeros(len(raw), dtype=np.int8)
    lengths = _lengths(data, starts)
    number[: int(starts[-1] + lengths[-1]) if len(starts) else 0] = 1
    number[starts] = 0  # instructions
    wrong = np.flatnonzero((number == 1) & ((raw >> 4 > 9) | (raw & 15 > 9)))
    return int(wrong[0]) if len(wrong) else None

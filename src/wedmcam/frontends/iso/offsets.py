"""Tables of offsets and conditions that stand in an ISO program itself: ``H001 = 0.14``.

They are no words: a letter and a number are named there, and set. So they are taken out of the text
before the words are read, and an offset is looked up where G41 or G42 names its number. Sodick
writes ``H001 = +0.14`` and conditions as ``C001 = ...``, Mitsubishi ``H1 = .0085 + H175``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal

_TERM = rb"(?:\d{1,12}(?:\.\d{0,9})?|\.\d{1,9}|H *\d{1,4})"
_SET = rb"H *\d{1,4} *= *[-+]? *" + _TERM + rb"(?: *[-+] *" + _TERM + rb")*"
_LINE = re.compile(
    rb"^[ %]*(?:N *\d+ +)?(" + _SET + rb"(?: *" + _SET + rb")*) *(?=$|[;(])", re.MULTILINE
)
_ONE = re.compile(rb"H *(\d{1,4}) *= *((?:(?!H *\d{1,4} *=).)*)")
_PART = re.compile(rb"([-+]?) *(H *)?(\d+\.?\d*|\.\d+)")
_CONDITION = re.compile(rb"^[ %]*(?:N *\d+ +)?(C *\d{1,4} *=[^\n;(]*)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Entry:
    """One offset of the table of a file.

    Attributes:
        number: of the offset.
        at, end: where it stands in the text.
        pointed, whole: the sums of its numbers with a point and without one.
        refers: (sign, number) of other offsets in its sum.
    """

    number: int
    at: int
    end: int
    pointed: Decimal
    whole: Decimal
    refers: tuple[tuple[int, int], ...]


def tables_of(codes: bytes) -> tuple[bytes, list[Entry], list[tuple[int, int]]]:
    r"""Return a text of ``frontends.plain`` with blanks for its tables, and what they hold.

    Returns:
        The text, as long as it was; the offsets in their order; where lines of conditions stand.

    >>> text, offsets, _ = tables_of(b"H1 = .0085 + H175 H2=1\nG41 H1")
    >>> text.split(), [(e.number, float(e.pointed), e.refers) for e in offsets]
    ([b'G41', b'H1'], [(1, 0.0085, ((1, 175),)), (2, 0.0, ())])
    """
    if b"=" not in codes:
        return codes, [], []
    entries: list[Entry] = []
    for line in _LINE.finditer(codes):
        for one in _ONE.finditer(codes, *line.span(1)):
            entries.append(_entry(one))
    conditions = [m.span(1) for m in _CONDITION.finditer(codes)]
    out = bytearray(codes)
    for a, b in [*((e.at, e.end) for e in entries), *conditions]:
        out[a:b] = b" " * (b - a)
    return bytes(out), entries, conditions


def _entry(one: re.Match[bytes]) -> Entry:
    pointed = whole = Decimal(0)
    refers = []
    for part in _PART.finditer(one[2]):
        sign = -1 if part[1] == b"-" else 1
        if part[2]:
            refers.append((sign, int(part[3])))
        elif b"." in part[3]:
            pointed += sign * Decimal(part[3].decode())
        else:
            whole += sign * Decimal(part[3].decode())
    return Entry(int(one[1]), one.start(), one.end(), pointed, whole, tuple(refers))

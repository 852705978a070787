"""Which words of ISO a controller knows, and what they do: three classes, from its profile.

A dialect is a white list: a word that no table of its profile names is not known there, whatever
other controllers do by it. A word is named by itself (``M20``), in a range (``C000-C999``) or with
all numbers of its letter (``T``); the most exact key counts.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.formats import iso
from wedmcam.formats.iso import IDLE, LEADING, PER_CODE

Ints = NDArray[np.int64]


class Known(IntEnum):
    """What a profile says of a word."""

    NOT = 0
    HARMLESS = 1
    REFUSED = 2
    PATH = 3


#: Classes as a profile names them.
CLASSES = {"harmless": Known.HARMLESS, "refused": Known.REFUSED, "path": Known.PATH}
#: A number that no code has: negative, or with more digits behind its point.
NO_CODE = -1
#: Letter and number of a word are one key, ``ord(letter) * PER_LETTER + tenths``: no number of a
#: word is larger.
PER_LETTER = 10**13
_KEY = re.compile(r"([A-Z])(?:(\d{1,6})(?:\.(\d)|-\1?(\d{1,6}))?)?")
TAKES = 'a word ("M20", "G91.1"), a range ("C000-C999") or a letter ("T")'

#: Words that every controller knows: pauses and ends.
OWN = tuple(("M", n * PER_CODE) for n in iso.PAUSES + iso.ENDS)
#: M codes of subprograms, in tenths.
CALLS = frozenset(PER_CODE * n for n in iso.SUBPROGRAMS)
#: Letters of words that the reader runs, whatever their number.
LETTERS = frozenset("XYIJRNDHFLOP")
#: Letters whose words are never harmless: places, radii, and the upper guide of a taper.
_PLACES = frozenset("XYIJRUV")


@dataclass(frozen=True)  # without slots: what follows from the words is computed once
class Vocabulary:
    """What the words of a dialect do, by class. A profile with a word here is a white list.

    A key is a word (M20), all numbers of a letter (T) or a range (C000-C999, M80-M85); its value
    says in plain words what the word does. Of several keys the most exact one counts. M00, M01,
    M02 and M30 are known anyway.

    Attributes:
        harmless: words that are left out with one note: nothing of the path changes by them.
        refused: words that are an error where they stand in a program, with the text.
        path: words that the reader runs itself, of those that it can run. A profile that names G
            codes here refuses the G codes that it does not name.
    """

    harmless: tuple[tuple[str, str], ...] = ()
    refused: tuple[tuple[str, str], ...] = ()
    path: tuple[tuple[str, str], ...] = ()

    def __bool__(self) -> bool:
        """Return whether a word is named."""
        return bool(self.harmless or self.refused or self.path)

    @property
    def lists_codes(self) -> bool:
        """Whether it names the G codes that the path may have."""
        return any(key[0] == "G" for key, _ in self.path)

    def entries_of(self, letters: NDArray[np.uint8], tenths: Ints) -> Ints:
        """Return for each word the entry that counts, of `classes` and `texts`; 0 for none.

        Args:
            letters: ASCII codes.
            tenths: numbers times ten; `NO_CODE` for one that no code has.

        >>> words = Vocabulary((("T", "tank"), ("M80-M85", "pump")), (("M84", "?"),))
        >>> letters = np.frombuffer(b"TMMMX", np.uint8)
        >>> [words.texts[k] for k in words.entries_of(letters, np.array([5, 800, 840, 845, 0]))]
        ['tank', 'pump', '?', '', '']
        """
        starts, entry, ranged, letter_entry = self._segments
        at = letters.astype(np.int64) * PER_LETTER
        rows = entry[np.searchsorted(starts, at + tenths, "right") - 1]
        dotted = ranged[rows] & (tenths % PER_CODE != 0)
        if dotted.any():  # a range is of whole numbers
            rows = np.where(dotted, letter_entry[letters], rows)
        return rows

    @cached_property
    def classes(self) -> NDArray[np.int8]:
        """Class of each entry (`Known`), the first for no entry."""
        sizes = [1, len(self.harmless), len(self.refused), len(self.path)]
        return np.repeat(np.array(list(Known), np.int8), sizes)

    @cached_property
    def texts(self) -> tuple[str, ...]:
        """What each entry says that its word does, the first for no entry."""
        return ("", *(text for _, text in (*self.harmless, *self.refused, *self.path)))

    def class_of(self, letter: str, tenths: int) -> Known:
        """Return the class of one word.

        >>> Vocabulary(path=(("G91.1", "centres from the start"),)).class_of("G", 911).name
        'PATH'
        """
        one = self.entries_of(np.array([ord(letter)], np.uint8), np.array([tenths]))
        return Known(int(self.classes[one[0]]))

    @cached_property
    def _segments(self) -> tuple[Ints, Ints, NDArray[np.bool_], Ints]:
        """Return where the entry that counts changes, and which it is from there.

        And of each entry whether it is a range, and the entry of each letter alone.
        """
        keys = [key for key, _ in (*self.harmless, *self.refused, *self.path)]
        spans = []
        letters = np.zeros(128, np.int64)
        ranged = np.zeros(len(keys) + 1, bool)
        for number, key in enumerate(keys, 1):
            letter, first, last = span_of(key) or ("?", 0, 0)
            base = ord(letter) * PER_LETTER
            spans.append((last - first, base + first, base + last, number))
            ranged[number] = "-" in key
            if len(key) == 1:
                letters[ord(letter)] = number
        edges = sorted({-1, *(a for _, a, _, _ in spans), *(b + 1 for _, _, b, _ in spans)})
        entry = np.zeros(len(edges), np.int64)
        starts = np.array(edges, np.int64)
        for _, first, last, number in sorted(spans, reverse=True):  # the widest first
            entry[(starts >= first) & (starts <= last)] = number
        return starts, entry, ranged, letters


def span_of(key: str) -> tuple[str, int, int] | None:
    """Return the letter of a key and its first and last number in tenths; None where it is no key.

    >>> span_of("M8"), span_of("C000-C999"), span_of("G91.1"), span_of("T"), span_of("MOVE")
    (('M', 80, 80), ('C', 0, 9990), ('G', 911, 911), ('T', -1, 9999999999999), None)
    """
    m = _KEY.fullmatch(key)
    if m is None:
        return None
    if m[2] is None:
        return m[1], NO_CODE, PER_LETTER - 1
    first = int(m[2]) * PER_CODE
    if m[3]:
        first += int(m[3])
    return m[1], first, int(m[4]) * PER_CODE if m[4] else first


def calls_in(key: str) -> bool:
    """Return whether a key names a word that calls or ends a subprogram.

    >>> calls_in("M098"), calls_in("M97-M99"), calls_in("M80")
    (True, True, False)
    """
    span = span_of(key)
    return bool(span and span[0] == "M" and any(span[1] <= n <= span[2] for n in CALLS))


def wrong_words(tables: dict[str, dict[str, Any]]) -> list[tuple[str, str, str]]:
    """Return what is wrong with the words of a profile: class, key, and what it is.

    >>> wrong_words({"harmless": {"M02": "end"}, "path": {"M8O": "?"}})[0]
    ('harmless', 'M02', 'M00, M01, M02 and M30 are known to every controller')
    """
    wrong = []
    seen: list[tuple[tuple[str, int, int], str, str]] = []
    for name, table in tables.items():
        for key, text in table.items():
            span = span_of(key)
            if span is None:
                wrong.append((name, key, f"is no key: it takes {TAKES}"))
                continue
            if not isinstance(text, str) or not text.strip() or not text.isprintable():
                wrong.append((name, key, "takes what the word does, in plain words of one line"))
            what = _unfit(Known(CLASSES[name]), key, span)
            what = what or next(
                (w for other in seen if (w := _both(span, name, other)) is not None), None
            )
            if what is not None:
                wrong.append((name, key, what))
            seen.append((span, name, key))
    return wrong


def _unfit(known: Known, key: str, span: tuple[str, int, int]) -> str | None:
    """Return why a key cannot be of a class."""
    letter, first, last = span
    if first > last:
        return "runs backwards: a range is from the lower number to the higher"
    if letter in "MG" and len(key) == 1:
        return f"is every {letter} word: they are named one by one, or in ranges"
    if known is not Known.PATH and any(k == letter and first <= n <= last for k, n in OWN):
        return "M00, M01, M02 and M30 are known to every controller"
    if known is Known.HARMLESS:
        if letter in _PLACES:
            return f"is a place: a word with {letter} is never left out"
        runs = {"G": LEADING, "M": CALLS}.get(letter, frozenset())
        held = sorted(
            n for n in runs if first <= n <= last and (n % PER_CODE == 0 or first == last)
        )
        if held:
            code = f"{letter}{held[0] / PER_CODE:g}"
            return f"holds {code}, which the reader runs: it may stand under 'path', or 'refused'"
    if known is Known.PATH and letter in "MG":
        runs = LEADING | IDLE if letter == "G" else CALLS | {n for _, n in OWN}
        missing = [n for n in range(first, min(last, 99_990) + 1, PER_CODE) if n not in runs]
        if missing:
            code = f"{letter}{missing[0] / PER_CODE:g}"
            return f"holds {code}, which the reader cannot run: only words that it runs stand here"
    elif known is Known.PATH and letter not in LETTERS:
        return f"holds {letter}, which the reader cannot run: only words that it runs stand here"
    return None


def _both(
    span: tuple[str, int, int], name: str, other: tuple[tuple[str, int, int], str, str]
) -> str | None:
    """Return how a key contradicts one before it: no word is in two classes."""
    (letter, first, last), ((k, a, b), of, key) = span, other
    if letter != k or last < a or b < first:
        return None
    if (a, b) == (first, last):
        return f"is named twice: it is '{key}' under '{of}'"
    inside = (a <= first and last <= b) or (first <= a and b <= last)
    if not inside and name != of:
        return f"overlaps '{key}' under '{of}': a word is of one class"
    return None

"""ISO words (a letter and a number) of a whole text at once, as columns.

Blanks mean nothing between letter and number, so they go first; then a word is what stands from a
letter to the next letter or line end. Comments are taken out before.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Text: in parentheses, and behind a semicolon that ends no block.
COMMENT = re.compile(rb"\([^)\n]*\)?|;[^\n]*")
_BRACKETS = re.compile(rb"\([^)\n]*\)?")
_COLON = re.compile(rb"^([ %/]*):(?= *\d)", re.MULTILINE)
#: Letters of coordinates.
_PLACES = np.frombuffer(b"XYIJRUVZ", dtype=np.uint8)
#: What `Words` holds of each word.
_COLUMNS = ("letter", "start", "end", "line", "whole", "decimals", "pointed", "good")
#: Digits of a number that are read; more do not fit 64 bits.
DIGITS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """All words of a text, in order.

    Attributes:
        letter: ASCII code.
        start, end: characters in the text; a number may hold blanks.
        line: 0-based line of each.
        whole: the digits as one number, signed.
        decimals: digits behind the point.
        pointed: whether it has a point.
        good: whether the number can be read.
        stray: characters that belong to no word, in the text.
        comments: first and past the last character of each comment.
        line_start, line_end: of every line.
        skipped: lines that open with a slash.
        percents: percent signs, in the text; none of them is in a comment.
    """

    letter: NDArray[np.uint8]
    start: Ints
    end: Ints
    line: Ints
    whole: Ints
    decimals: Ints
    pointed: Bools
    good: Bools
    stray: Ints
    comments: list[tuple[int, int]]
    line_start: Ints
    line_end: Ints
    skipped: Ints
    percents: Ints

    def titles(self) -> Ints:
        """Return the lines that are text: letters that no number follows, before any other word.

        A line in which a single letter has lost its number holds a wrong word, and is no text.
        """
        alone = ~self.good & (self.end - self.start == 1)
        if not alone.any():
            return np.zeros(0, np.int64)
        of = self.line[alone]
        lines, many = np.unique(of, return_counts=True)
        numbered = self.letter != ord("N")
        opens = np.zeros(len(self.line), bool)
        rows = np.flatnonzero(numbered | alone)
        opens[rows[np.unique(self.line[rows], return_index=True)[1]]] = True
        first = np.isin(lines, self.line[opens & alone])
        found: Ints = lines[(many >= 4) | ((many >= 2) & first)]
        return found

    def lines_at(self, chars: Ints) -> Ints:
        """Return the line of each of some characters."""
        return np.searchsorted(self.line_end, chars)

    def without(self, lines: Ints) -> Words:
        """Return the words, and what belongs to none, of all lines but these."""
        gone = np.zeros(len(self.line_start), bool)
        gone[lines] = True
        stray = self.stray[~gone[self.lines_at(self.stray)]]
        return replace(self.without_words(gone[self.line]), stray=stray)

    def without_words(self, gone: Bools) -> Words:
        """Return all words but some."""
        return replace(self, **{name: getattr(self, name)[~gone] for name in _COLUMNS})

    def in_order(self, lines: Ints) -> Words:
        """Return the words of some lines, in that order; a line may be there often, or not at all.

        What belongs to no word (``stray``, ``comments``, ``skipped``) is that of the text still.
        """
        low = np.searchsorted(self.line, np.arange(len(self.line_start)))
        many = np.diff(np.append(low, len(self.line)))[lines]
        line = np.repeat(np.arange(len(lines)), many)
        rows = np.arange(len(line)) + np.repeat(low[lines] - (np.cumsum(many) - many), many)
        columns = {name: getattr(self, name)[rows] for name in _COLUMNS if name != "line"}
        start, end = self.line_start[lines], self.line_end[lines]
        return replace(self, line=line, line_start=start, line_end=end, **columns)


def with_numbers(codes: bytes) -> bytes:
    r"""Return a text of ``frontends.plain`` with O for a colon that opens a line.

    Fanuc's manuals: O numbers a program in EIA code, the colon does in ISO code.

    >>> with_numbers(b"%\n:12\nG01:5")
    b'%\nO12\nG01:5'
    """
    return _COLON.sub(rb"\1O", codes) if b":" in codes else codes


def words_of(codes: bytes, semicolon_ends: bool = False) -> Words:
    """Return the words of a text of ``frontends.plain``.

    ``semicolon_ends``: a semicolon ends a line, and no comment begins behind it.
    """
    comments: list[tuple[int, int]] = []
    if b"(" in codes or b";" in codes:
        comment = _BRACKETS if semicolon_ends else COMMENT
        comments = [m.span() for m in comment.finditer(codes)]
        codes = comment.sub(lambda m: b" " * len(m[0]), codes)
        if semicolon_ends:
            codes = codes.replace(b";", b"\n")
    every = np.frombuffer(codes, dtype=np.uint8)
    ends = np.append(np.flatnonzero(every == 10), len(every))
    # Percent signs open and end tapes; they are no part of any word.
    at = np.flatnonzero((every != 32) & (every != 37))
    c = every[at]
    capital = (c >= 65) & (c <= 90)
    first = np.flatnonzero(capital)
    feeds = np.flatnonzero(c == 10)
    # Of each line: where it begins and stops, and its words.
    begins, stops = np.append(0, feeds + 1), np.append(feeds, len(c))
    opens, closes = np.searchsorted(first, begins), np.searchsorted(first, stops)
    line = np.repeat(np.arange(len(begins)), closes - opens)
    past = np.minimum(np.append(first, len(c))[1:], stops[line])
    size = past - first - 1

    whole, decimals, seen = (np.zeros(len(first), np.int64) for _ in range(3))
    pointed, good = np.zeros(len(first), bool), size > 0
    minus = np.zeros(len(first), bool)
    padded = np.append(c, np.zeros(DIGITS + 4, np.uint8))
    for k in range(min(int(size.max(initial=0)), DIGITS + 2)):
        here = size > k
        char = padded[first + 1 + k]
        digit = here & (char >= 48) & (char <= 57)
        point = here & (char == 46)
        sign = here & ((char == 43) | (char == 45)) & (k == 0)
        whole = np.where(digit, whole * 10 + (char.astype(np.int64) - 48), whole)
        seen += digit
        decimals += digit & pointed
        good &= ~here | digit | sign | (point & ~pointed)
        pointed |= point
        minus |= sign & (char == 45)
    good &= (seen > 0) & (size <= DIGITS + 2) & (seen <= DIGITS)

    # What is before the first word of a line belongs to none: a slash, or rubbish.
    lead = np.minimum(np.append(first, len(c))[opens], stops) - begins
    some = np.flatnonzero(lead)
    skipped = some[c[begins[some]] == 47]
    lead[skipped] -= 1
    begins[skipped] += 1
    before = np.cumsum(lead[some]) - lead[some]
    loose = np.repeat(begins[some] - before, lead[some]) + np.arange(int(lead[some].sum()))
    stray = at[loose]
    last = at[past - 1] if len(first) else np.zeros(0, np.int64)
    letter, start, end = c[first], at[first], last + 1
    # X1.5E-3 may be an exponent, or a condition behind a coordinate: no number to move by.
    power = np.zeros(len(first), bool)
    power[:-1] = (letter[1:] == ord("E")) & (start[1:] == end[:-1]) & np.isin(letter[:-1], _PLACES)
    good &= ~power
    end[power] = end[1:][power[:-1]]
    return Words(
        letter=letter,
        start=start,
        end=end,
        line=line,
        whole=np.where(minus, -whole, whole),
        decimals=decimals,
        pointed=pointed,
        good=good,
        stray=stray,
        comments=comments,
        line_start=np.concatenate([[0], ends[:-1] + 1]),
        line_end=ends,
        skipped=skipped,
        percents=np.flatnonzero(every == 37) if b"%" in codes else np.zeros(0, np.int64),
    )

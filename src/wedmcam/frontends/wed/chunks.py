"""A text in pieces that are read one by one, so that one mistake does not hide the next.

Statements, and the blocks of a contour, begin with words that can be no names; so a text falls
apart at them without being understood. A piece that cannot be parsed is reported, and the next one
is read as if nothing had been.
"""

from __future__ import annotations

import bisect
import re
from dataclasses import dataclass, field

from wedmcam.diag import TextSpan

STATEMENTS = ("part", "units", "let", "contour", "cut")
COMMANDS = ("from", "line", "arc", "circle", "close")
#: Words that begin something, and so can be no names.
RESERVED = (*STATEMENTS, *COMMANDS)
#: After these a name stands, or what is meant to be one.
_NAMED = ("let", "contour", "cut")
_TOKEN = re.compile(r'#[^\n]*|"[^"\n]*"?|[A-Za-z_]\w*|[{}()]')


@dataclass(frozen=True, slots=True)
class Source:
    """A text and its name; tells line and column of a place."""

    text: str
    file: str
    lines: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.lines.append(0)
        self.lines.extend(m.end() for m in re.finditer("\n", self.text))

    def span(self, start: int, end: int) -> TextSpan:
        r"""Return the place of characters ``start`` up to ``end``, on the line of the first.

        >>> str(Source("let a = 1\nlet b = a", "x.wed").span(14, 15))
        'x.wed:2:5'
        """
        line = bisect.bisect_right(self.lines, start) - 1
        first = self.lines[line]
        last = self.lines[line + 1] - 1 if line + 1 < len(self.lines) else len(self.text)
        return TextSpan(
            self.file, line + 1, start - first + 1, max(1, min(end, max(last, start)) - start)
        )


@dataclass(frozen=True, slots=True)
class Piece:
    """Characters ``start`` up to ``end``: a statement, the heading of a contour, or a block of one.

    Attributes:
        entry: where the grammar is entered: statement, heading, command; "brace" is a closing
            bracket that ends a contour, "open" a contour that nothing ends.
        start: first character.
        end: behind the last one, without white space.
    """

    entry: str
    start: int
    end: int


def pieces(text: str) -> list[Piece]:
    """Return the pieces of a text; together they hold all of it but comments and white space.

    >>> [(p.entry, p.start) for p in pieces("contour a { from (0, 0) close } cut a on")]
    [('heading', 0), ('command', 12), ('command', 24), ('brace', 30), ('statement', 32)]
    """
    marks: list[tuple[str, int]] = [("statement", 0)]
    inside, head, depth, before = False, False, 0, ""
    for m in _TOKEN.finditer(text):
        word, at = m[0], m.start()
        if word[0] in '#"':
            continue
        named, before = before in _NAMED, word
        if word == "(":
            depth += 1
        elif word == ")":
            depth = max(0, depth - 1)
        elif word == "{" and head:
            inside, head, depth = True, False, 0
            marks.append(("command", m.end()))
        elif word == "}" and inside:
            inside, depth = False, 0
            marks += [("brace", at), ("statement", m.end())]
        elif word in STATEMENTS and not named:
            if inside:
                marks.append(("open", at))
            inside, depth = False, 0
            head = word == "contour"
            marks.append(("heading" if head else "statement", at))
        elif inside and word in COMMANDS:
            depth = 0
            marks.append(("command", at))
    if inside:
        marks.append(("open", len(text)))
    out = []
    for k, (entry, start) in enumerate(marks):
        end = marks[k + 1][1] if k + 1 < len(marks) else len(text)
        first, last = _trimmed(text, start, end)
        if first < last or entry == "open":
            out.append(Piece(entry, first, max(first, last)))
    return out


_BLANK = re.compile(r"(?:\s+|#[^\n]*)*")
_LAST = re.compile(r'"[^"\n]*"?|#[^\n]*|\s+|[^\s#"]+')


def _trimmed(text: str, start: int, end: int) -> tuple[int, int]:
    """Return a stretch without white space and comments at its ends."""
    found = _BLANK.match(text, start, end)
    first = found.end() if found else start
    if "#" not in (piece := text[first:end]):
        return first, first + len(piece.rstrip())
    last = first
    for m in _LAST.finditer(text, first, end):
        if not (m[0][0] == "#" or m[0].isspace()):
            last = m.end()
    return first, last

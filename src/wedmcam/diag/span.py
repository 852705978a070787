"""Where a finding points: a line of text, a DXF entity, bytes of a program, or a whole file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TextSpan:
    """Characters of one line of a text source; line and column count from 1.

    ``copies``: which copies of transforms it was drawn by, outermost first.

    >>> str(TextSpan("part.3b", 2, 10))
    'part.3b:2:10'
    """

    file: str
    line: int
    column: int
    length: int = 1
    copies: tuple[int, ...] = ()

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class EntityRef:
    """A DXF entity by handle (group code 5); ``via`` lists INSERT handles, outermost first.

    ``linetype``: that it is drawn with; empty for a plain line.

    >>> str(EntityRef("part.dxf", "2F", "ARC", "CUT", via=("1A",)))
    'part.dxf:#1A/2F layer CUT'
    """

    file: str
    handle: str
    dxftype: str
    layer: str
    via: tuple[str, ...] = ()
    linetype: str = ""

    def __str__(self) -> str:
        drawn = f" linetype {self.linetype}" if self.linetype else ""
        return f"{self.file}:#{'/'.join((*self.via, self.handle))} layer {self.layer}{drawn}"


@dataclass(frozen=True, slots=True)
class ByteSpan:
    """Bytes ``start`` up to, not including, ``end`` of a binary program.

    >>> str(ByteSpan("part.zd", 18, 30))
    'part.zd@0x0012'
    """

    file: str
    start: int
    end: int

    def __str__(self) -> str:
        return f"{self.file}@{self.start:#06x}"


@dataclass(frozen=True, slots=True)
class FileSpan:
    """A file as a whole."""

    file: str

    def __str__(self) -> str:
        return self.file


Span = TextSpan | EntityRef | ByteSpan | FileSpan


def option_texts(option: str, texts: Sequence[str]) -> dict[str, str]:
    """Return name -> text of what an option that may be repeated says: places name it by that.

    >>> option_texts("-D", ["a=1", "b=2"])
    {'-D 1': 'a=1', '-D 2': 'b=2'}
    """
    if len(texts) == 1:
        return {option: texts[0]}
    return {f"{option} {k}": text for k, text in enumerate(texts, 1)}

"""A program text from anywhere, as one byte a character: capitals, blanks, line feeds.

Shop-floor files come in ASCII, UTF-8, UTF-16, GBK or Latin letters, with or without a byte order
mark, with full-width letters, and with the line ends and the end-of-file mark of DOS. After this
module the searches need to know one spelling only, and positions still count characters.
"""

from __future__ import annotations

import codecs
from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Span, TextSpan

# U+FF01..U+FF5E are the full-width forms of '!'..'~'; U+3000 is the full-width blank.
_FULL_WIDTH = {0xFF01 + i: 0x21 + i for i in range(94)} | {0x3000: 0x20}
# NUL pads old files, 0x1A ends them in DOS; tabs, feeds and the hard blank are blanks.
_BLANKS = b"\t\0\x1a\x0b\x0c\xa0"
_PLAIN = bytes(0x20 if b in _BLANKS else b for b in range(256)).upper()
_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


@dataclass(frozen=True, slots=True)
class Plain:
    """One text in two spellings; offsets count characters in both, a byte order mark left out.

    Attributes:
        codes: ASCII capitals, a blank for every kind of blank, a line feed for every line end
            (CRLF: blank and line feed), '?' for what is not Latin. One byte a character.
        text: as it was written.
    """

    codes: bytes
    text: str | bytes

    def excerpt(self, start: int, end: int, most: int = 40) -> str:
        """Return what was written from ``start`` to ``end``, stripped and cut to ``most``."""
        part = self.text[start : min(end, start + 4 * most)]
        text = (part if isinstance(part, str) else part.decode("latin-1")).strip()
        printable = "".join(c if c.isprintable() else " " for c in text)
        return printable if len(printable) <= most else printable[: most - 3] + "..."


def plain(data: bytes) -> Plain:
    """Return any bytes as `Plain` text; never fails.

    Without a mark the encoding is ASCII, else UTF-8, else GBK (GB 18030), else Latin-1: the first
    that fits.
    """
    text: str | bytes = data
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            text = data[len(mark) :].decode(encoding, "replace")
            break
    else:
        if not data.isascii():
            for encoding in ("utf-8", "gb18030", "latin-1"):
                try:
                    text = data.decode(encoding)
                    break
                except UnicodeDecodeError:
                    continue
    if isinstance(text, str):
        codes = text.translate(_FULL_WIDTH).encode("latin-1", "replace")
    else:
        codes = text
    codes = codes.translate(_PLAIN).replace(b"\r\n", b" \n").replace(b"\r", b"\n")
    return Plain(codes, text)


class TextSpans(Sequence[Span]):
    """Where each block stands in a text: twelve bytes a block, a `TextSpan` when asked for."""

    def __init__(
        self,
        file: str,
        codes: bytes,
        starts: NDArray[np.int64],
        lengths: NDArray[np.int32],
    ) -> None:
        self._file = file
        self._starts = starts
        self._lengths = lengths
        self._line_ends = np.flatnonzero(np.frombuffer(codes, dtype=np.uint8) == 10)

    def __len__(self) -> int:
        return len(self._starts)

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where each block starts, in the text of `plain`."""
        return self._starts

    def at(self, offset: int, length: int = 1) -> TextSpan:
        """Return the span of any characters."""
        line = int(np.searchsorted(self._line_ends, offset))
        before = int(self._line_ends[line - 1]) if line else -1
        return TextSpan(self._file, line + 1, offset - before, max(length, 1))

    @overload
    def __getitem__(self, index: int) -> Span: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Span, ...]: ...
    def __getitem__(self, index: int | slice) -> Span | tuple[Span, ...]:
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        return self.at(int(self._starts[index]), int(self._lengths[index]))

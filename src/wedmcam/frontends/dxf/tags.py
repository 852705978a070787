"""The tags of a file as columns: what stands in it, before any reader makes something of it.

ezdxf takes the last of two values, puts two blocks of one name together, and stops at the end mark.
What it passes over so can only be seen in the tags. They are read once, with the group codes in one
array, so that a look at all of them is a few array operations; values are only read where needed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import ByteSpan, Span, TextSpan

Ints = NDArray[np.int64]

BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"
#: A group code that is no whole number, or that no DXF has.
NO_CODE = -1
#: Group codes are below this: 1071 is the largest in use.
CODES = 1100
#: From here on an entity holds data of other programs: extended data, an embedded object.
FOREIGN = (1001, 101)
#: What fills files up behind their end: blanks, NUL and Ctrl-Z of CP/M and DOS, a byte order mark.
PADDING = " \t\r\n\0\x1a\ufeff"


class _Codes(dict[str, int]):
    """The number that a line states; a file has few different ones."""

    def __missing__(self, line: str) -> int:
        try:
            code = int(line)
        except ValueError:
            code = NO_CODE
        self[line] = code = code if 0 <= code < CODES else NO_CODE
        return code


class _Numbers(dict[str, int]):
    """A number for each different word, in order of appearance."""

    def __missing__(self, word: str) -> int:
        self[word] = number = len(self)
        return number


@dataclass(frozen=True, slots=True)
class Behind:
    """Data behind the end mark.

    Attributes:
        span: its first place.
        size: how much it is: lines of a text file, bytes of a binary one.
        second: where a second drawing begins, if that is what it is.
    """

    span: Span
    size: int
    second: Span | None


@dataclass(frozen=True, slots=True, eq=False)
class Tags:
    """The tags of a DXF file up to its end mark.

    Attributes:
        file: its name.
        codes: the group code of each tag, `NO_CODE` where there is none.
        marks: the tags with code 0: one opens each section, table, block, entity.
        kinds: what each mark opens: a number of `names`.
        names: LINE, SECTION, ... -> its number in ``kinds``.
        sections: name, first mark behind its head, and mark of its end, of each section.
        end: the tag of the end mark; None where there is none.
        behind: the data behind the end mark; None where there is none.
    """

    file: str
    codes: Ints
    marks: Ints
    kinds: Ints
    names: dict[str, int]
    end: int | None
    behind: Behind | None
    sections: tuple[tuple[str, int, int], ...] = field(init=False)
    _lines: Sequence[str] = ()
    _data: bytes = b""
    _offsets: Sequence[int] = ()
    _encoding: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "sections", tuple(self._sections()))

    def _sections(self) -> Iterator[tuple[str, int, int]]:
        ends = np.flatnonzero(self.kinds == self.names.get("ENDSEC", -1))
        for mark in np.flatnonzero(self.kinds == self.names.get("SECTION", -1)).tolist():
            at = int(self.marks[mark]) + 1
            name = self.value(at).strip() if self.code(at) == 2 else ""
            after = np.searchsorted(ends, mark)
            yield name, mark + 1, int(ends[after]) if after < len(ends) else len(self.marks)

    @property
    def is_binary(self) -> bool:
        """Whether the file is of the binary kind."""
        return bool(self._data)

    @property
    def lines(self) -> list[str]:
        """The lines of a text file; none of a binary one."""
        return list(self._lines)

    def code(self, at: int) -> int:
        """Return a tag's group code; `NO_CODE` behind the last."""
        return int(self.codes[at]) if at < len(self.codes) else NO_CODE

    def value(self, at: int) -> str:
        """Return a tag's value as text."""
        if self._lines:
            return self._lines[2 * at + 1]
        return _binary_value(self._data, self._offsets[at], self.code(at), self._encoding)

    def texts(self, places: Sequence[int]) -> list[str]:
        """Return the values of many tags whose values are text; faster than one by one."""
        if self._lines or not places:
            return [self._lines[2 * at + 1] for at in places]
        data, offsets, find = self._data, self._offsets, self._data.index
        joined = b"\n".join([data[offsets[at] : find(b"\0", offsets[at])] for at in places])
        out = joined.decode(self._encoding, "replace").split("\n")
        if len(out) != len(places):  # a value holds a line end
            return [self.value(at) for at in places]
        return out

    def span(self, at: int) -> Span:
        """Return the place of a tag's value in the file."""
        if self._lines:
            return TextSpan(self.file, 2 * at + 2, 1, max(1, len(self.value(at))))
        after = self._offsets[at + 1] if at + 1 < len(self._offsets) else len(self._data)
        return ByteSpan(self.file, self._offsets[at], after)

    def place(self, at: int) -> str:
        """Return the place of a tag in words: "line 31", "byte 0x01f4"."""
        if self._lines:
            return f"line {2 * at + 2}"
        return f"byte {self._offsets[at]:#06x}"

    def text(self) -> str:
        """Return a text file up to its end mark, which it has."""
        assert self.end is not None
        return "\n".join(self._lines[: 2 * self.end + 2]) + "\n"

    def data(self) -> bytes:
        """Return a binary file up to its end mark."""
        return self._data if self.end is None else self._data[: self._offsets[self.end] + 4]

    def last(self, mark: int) -> int:
        """Return the tag behind the last one of what a mark opens."""
        return int(self.marks[mark + 1]) if mark + 1 < len(self.marks) else len(self.codes)

    def own(self, mark: int) -> Iterator[tuple[int, int]]:
        """Yield the tags, and their codes, that an entity has of its own.

        Not those in groups of applications (102), in extended data or in an embedded object.
        """
        inside = False
        for at in range(int(self.marks[mark]) + 1, self.last(mark)):
            code = int(self.codes[at])
            if code in FOREIGN:
                return
            if code == 102:
                inside = self.value(at).strip().startswith("{")
            elif not inside:
                yield at, code

    def first(self, mark: int, code: int) -> str | None:
        """Return the first value of a code that an entity has of its own, without blanks around."""
        for at, other in self.own(mark):
            if other == code:
                return self.value(at).strip()
        return None


def tags_of_text(text: str, file: str) -> Tags:
    """Return the tags of a text file, with newlines as line ends."""
    lines = text.split("\n")
    count = len(lines) // 2
    codes = np.fromiter(map(_Codes().__getitem__, lines[0 : 2 * count : 2]), np.int64, count)
    marks = np.flatnonzero(codes == 0)
    kinds = [lines[2 * at + 1].strip() for at in marks.tolist()]
    end = behind = None
    if "EOF" in kinds:
        end = int(marks[kinds.index("EOF")])
        behind = _lines_behind(lines, 2 * end + 2, file)
    return _tags(file, codes, marks, kinds, end, behind, _lines=lines)


def tags_of_binary(data: bytes, file: str, encoding: str = "utf-8") -> Tags:
    """Return the tags of a binary file as far as it can be read."""
    codes, offsets, kinds, whole = _walk(data)
    array = np.array(codes, np.int64)
    array[array >= CODES] = NO_CODE
    end = behind = None
    if whole:
        end = len(codes) - 1
        behind = _bytes_behind(data, offsets[end] + 4, file)
    marks = np.flatnonzero(array == 0)
    more = {"_data": data, "_offsets": offsets, "_encoding": encoding}
    return _tags(file, array, marks, kinds, end, behind, **more)


def _tags(
    file: str,
    codes: Ints,
    marks: Ints,
    kinds: list[str],
    end: int | None,
    behind: Behind | None,
    **source: object,
) -> Tags:
    if end is not None:
        codes = codes[: end + 1]
        marks = marks[: int(np.searchsorted(marks, end)) + 1]
        kinds = kinds[: len(marks)]
    names = _Numbers()
    numbers = np.fromiter(map(names.__getitem__, kinds), np.int64, len(kinds))
    return Tags(file, codes, marks, numbers, dict(names), end, behind, **source)  # type: ignore[arg-type]


def _lines_behind(lines: list[str], first: int, file: str) -> Behind | None:
    """Return the data behind the end mark of a text file."""
    full = [at for at in range(first, len(lines)) if lines[at].strip(PADDING)]
    if {lines[at].strip() for at in full} <= {"0", "EOF"}:  # the mark again is nothing, too
        return None
    second = next(
        (
            TextSpan(file, at + 1, 1)
            for at in full
            if (lines[at].strip() == "0" and lines[at + 1 : at + 2] and _opens(lines[at + 1]))
            or lines[at].startswith(BINARY[:18].decode())
        ),
        None,
    )
    return Behind(TextSpan(file, full[0] + 1, 1), len(full), second)


def _opens(line: str) -> bool:
    return line.strip() == "SECTION"


def _bytes_behind(data: bytes, first: int, file: str) -> Behind | None:
    """Return the same of a binary file."""
    padding = PADDING[:-1].encode()
    rest = data[first:].rstrip(padding)
    start = first + len(rest) - len(rest.lstrip(padding))
    if start >= first + len(rest):
        return None
    # Without the padding at its start the second drawing's first code may be gone: the name counts.
    found = [at for mark in (BINARY[:18], b"SECTION") if (at := data.find(mark, first)) >= 0]
    second = ByteSpan(file, min(found), min(found) + 7) if found else None
    last = first + len(rest)
    return Behind(ByteSpan(file, start, last), last - start, second)


# --- binary files -----------------------------------------------------------------------------


def _walk(data: bytes) -> tuple[list[int], list[int], list[str], bool]:
    """Return codes, offsets of the values, the values of code 0, and whether the end was met.

    Group codes have one byte up to R12 (255 stands before those of extended data), two after.
    """
    sizes = _sizes_by_code()
    old = _is_old(data)
    codes: list[int] = []
    offsets: list[int] = []
    kinds: list[str] = []
    add_code, add_offset = codes.append, offsets.append
    at, last = len(BINARY), len(data)
    try:
        while at < last:
            code = data[at]
            if not old:
                code |= data[at + 1] << 8
                at += 2
            elif code == 255:
                code = data[at + 1] | data[at + 2] << 8
                at += 3
            else:
                at += 1
            size = sizes[code]
            after = at + size
            if size == 0:
                after = data.index(b"\0", at) + 1
            elif size < 0:
                after = at + 1 + data[at]
            add_code(code)
            add_offset(at)
            if code == 0:
                kinds.append(data[at : after - 1].decode("latin-1").strip())
                if kinds[-1] == "EOF":
                    return codes, offsets, kinds, True
            at = after
    except (IndexError, ValueError):  # cut off: the reader says so
        pass
    return codes, offsets, kinds, False


def _is_old(data: bytes) -> bool:
    """Return whether a binary file is of R12 or before, as its ``$ACADVER`` says."""
    at = data.find(b"$ACADVER", 0, 1024)
    if at < 0:
        return True
    at += 10 if data[at + 10 : at + 11] == b"A" else 11
    return data[at : at + 6] <= b"AC1009"


def encoding_of_binary(data: bytes) -> str:
    """Return the encoding of a binary file's text: UTF-8 from R2007 on, else its code page."""
    from ezdxf.tools.codepage import toencoding

    head = data[:1024]
    version = re.search(rb"\$ACADVER\0\x01\x00?(AC\d{4})", head)
    if version is not None and version[1] >= b"AC1021":
        return "utf-8"
    page = re.search(rb"\$DWGCODEPAGE\0\x03\x00?([\w-]+)\0", head)
    return str(toencoding(page[1].decode())) if page is not None else "cp1252"


@cache
def _sizes() -> dict[int, int]:
    """Return the bytes of a value, by group code; -1: a length and as many; others end with NUL."""
    from ezdxf.lldxf.types import BINARY_DATA, BYTES, DOUBLE, INT16, INT32, INT64

    out: dict[int, int] = {}
    for size, codes in ((1, BYTES), (8, INT64), (4, INT32), (8, DOUBLE), (2, INT16)):
        out.update(dict.fromkeys(codes, size))
    out.update(dict.fromkeys(BINARY_DATA, -1))
    return out


@cache
def _sizes_by_code() -> list[int]:
    """Return the same as a list: a look into it is faster, and there is one for every tag."""
    sizes = _sizes()
    return [sizes.get(code, 0) for code in range(1 << 16)]


def _binary_value(data: bytes, at: int, code: int, encoding: str) -> str:
    """Return a value of a binary file as text; numbers as Python writes them."""
    from ezdxf.lldxf.types import DOUBLE

    size = _sizes().get(code, 0)
    if size < 0:
        return data[at + 1 : at + 1 + data[at]].hex()
    if size == 0:
        return data[at : data.index(b"\0", at)].decode(encoding, "replace")
    raw = data[at : at + size]
    if code in DOUBLE:
        return repr(float(np.frombuffer(raw, "<f8")[0]))
    return str(int.from_bytes(raw, "little", signed=size > 1))

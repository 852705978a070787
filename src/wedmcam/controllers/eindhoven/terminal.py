"""The routines of the command line: LINE takes it in, the others read it from a buffer.

The report names them and says what each does (section 5.1.2); its flowcharts are lost but for their
titles. What it states is marked [S], our rulings are [R].

A buffer holds characters and ends with 00H; the pointer is on the next one. The routines return the
buffer with its pointer moved, as the 8085's leave the pointer in memory.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

#: Characters of a line [S].
LONGEST = 64
#: What ends the input in a buffer, and what GNUMCI gives for it [S].
END, BLANK = 0x00, 0x20
#: Blanks and separators, over which SKIP goes [S]; which they are [R].
SEPARATORS = b" ,"
#: The largest number of 16 bits.
WORD = 0xFFFF

BEL, BACKSPACE, LINE_FEED, RETURN = 0x07, 0x08, 0x0A, 0x0D
RETYPE, CANCEL, DELETE = 0x12, 0x15, 0x7F
#: The 4 characters that correct a line, and the 2 that end it [S]; which they are [R].
CORRECTIONS = (BACKSPACE, DELETE, CANCEL, RETYPE)
TERMINATORS = (RETURN, LINE_FEED)

_NEW_LINE = bytes((RETURN, LINE_FEED))
#: Takes a character from the screen.
_RUB_OUT = b"\b \b"


class Lost(IntEnum):
    """Why a character was not taken."""

    NONE = 0
    LENGTH = 1  # the line has 64
    STRANGE = 2  # no character of the terminal that prints


# --- LINE ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Line:
    """A line that is being typed.

    Attributes:
        data: what it holds.
        before: the line before, which RETYPE brings back as long as nothing is typed.
        lost: whether a character was not taken since the last correction, and why.
        lost_at: how many characters stood before it.
        closed: a terminator was typed.
    """

    data: bytes = b""
    before: bytes = b""
    lost: Lost = Lost.NONE
    lost_at: int = 0
    closed: bool = False

    def next(self) -> Line:
        """Return the empty line that is typed after this one."""
        return Line(before=self.data or self.before)


def take(line: Line, code: int) -> tuple[Line, bytes]:
    r"""Take a character of the terminal (LINE); return the line, and what is sent back.

    BACKSPACE (08H) and DELETE (7FH) take the last character away; CANCEL (15H, control U) all of
    them; RETYPE (12H, control R) shows the line again, and brings the line before back where
    nothing is typed yet. CR (0DH) and LF (0AH) end the line. A correction at the beginning of the
    line, the 65th character, and every other control character or byte above 7EH only ring the
    bell; of the latter two the line remembers that they are missing, until a correction [R].

    >>> line = Line()
    >>> for code in b"G1\b 2\r":
    ...     line, echo = take(line, code)
    >>> line.data, line.closed, echo
    (b'G 2', True, b'\r\n')
    """
    if code in TERMINATORS:
        return replace(line, closed=True), _NEW_LINE
    if code in CORRECTIONS:
        return _corrected(replace(line, lost=Lost.NONE, lost_at=0), code)
    if len(line.data) >= LONGEST or not BLANK <= code < DELETE:
        if line.lost is Lost.NONE:
            why = Lost.STRANGE if not BLANK <= code < DELETE else Lost.LENGTH
            line = replace(line, lost=why, lost_at=len(line.data))
        return line, bytes((BEL,))
    return replace(line, data=line.data + bytes((code,))), bytes((code,))


def _corrected(line: Line, code: int) -> tuple[Line, bytes]:
    """Return a line after a correction character, and what is sent back."""
    if code == RETYPE:
        line = replace(line, data=line.data or line.before)
        return line, b"^R" + _NEW_LINE + line.data
    if not line.data:
        return line, bytes((BEL,))
    if code == CANCEL:
        return replace(line, data=b""), b"^U" + _NEW_LINE
    return replace(line, data=line.data[:-1]), _RUB_OUT


def screen(echo: bytes) -> list[str]:
    r"""Return the lines that a terminal shows of what is sent to it; the bell as ``<BEL>``.

    >>> screen(b"40" + _RUB_OUT + b"^U" + _NEW_LINE + b"50\x07")
    ['4^U', '50<BEL>']
    """
    lines: list[list[str]] = [[]]
    for code in echo.replace(_RUB_OUT, b"\b"):
        if code == BACKSPACE:
            # The bell leaves no character on the screen.
            shown = [i for i, one in enumerate(lines[-1]) if len(one) == 1]
            del lines[-1][shown[-1]]
        elif code == LINE_FEED:
            lines.append([])
        elif code != RETURN:
            lines[-1].append("<BEL>" if code == BEL else chr(code))
    return ["".join(line) for line in lines]


# --- the buffer ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Buffer:
    """Characters with a pointer.

    Attributes:
        data: the characters before the end.
        pointer: 0 to their number: there the end of the input stands.
    """

    data: bytes
    pointer: int = 0

    @property
    def here(self) -> int:
        """The character at the pointer; `END` behind the last one."""
        return self.data[self.pointer] if self.pointer < len(self.data) else END


def normal(data: bytes) -> bytes:
    """Return a line in capitals (NORMAL): a to z, and nothing else, become A to Z.

    >>> normal(b"go {1}")
    b'GO {1}'
    """
    return bytes(code - 0x20 if 0x61 <= code <= 0x7A else code for code in data)


def gnumci(buffer: Buffer) -> tuple[int, Buffer]:
    """Return the next character, and the buffer with its pointer behind it (GNUMCI).

    At the end of the input the character is a blank [S], and the pointer stays [R].

    >>> gnumci(Buffer(b"7"))[0], gnumci(Buffer(b"7", 1))
    (55, (32, Buffer(data=b'7', pointer=1)))
    """
    code = buffer.here
    if code == END:
        return BLANK, buffer
    return code, replace(buffer, pointer=buffer.pointer + 1)


def skip(buffer: Buffer) -> tuple[int, Buffer]:
    """Go over blanks and separators (SKIP); return the carry, 0 at the end of the input.

    >>> skip(Buffer(b"1 , 2", 1)), skip(Buffer(b"1 ", 1))
    ((1, Buffer(data=b'1 , 2', pointer=4)), (0, Buffer(data=b'1 ', pointer=2)))
    """
    while buffer.here in SEPARATORS:
        buffer = replace(buffer, pointer=buffer.pointer + 1)
    return int(buffer.here != END), buffer


@dataclass(frozen=True, slots=True)
class Number:
    """A number as GETDEC and GETHX give it.

    Attributes:
        value: its lowest 16 bits: what the register pair holds.
        digits: how many it has; 0 where there is none.
        overflows: it has more than 16 bits.
    """

    value: int
    digits: int
    overflows: bool


def getnum(buffer: Buffer) -> tuple[Number, Buffer]:
    """Return the decimal number at the pointer (GETNUM), which then is on what follows it [S].

    >>> getnum(Buffer(b"5250,8"))
    (Number(value=5250, digits=4, overflows=False), Buffer(data=b'5250,8', pointer=4))
    """
    return _number(buffer, b"0123456789")


def gnumhx(buffer: Buffer) -> tuple[Number, Buffer]:
    """Return the hexadecimal number at the pointer (GNUMHX); else as `getnum`.

    >>> gnumhx(Buffer(b"14020 "))[0]
    Number(value=16416, digits=5, overflows=True)
    """
    return _number(buffer, b"0123456789ABCDEF")


def _number(buffer: Buffer, digits: bytes) -> tuple[Number, Buffer]:
    """Read digits with GNUMCI, as the monitor's GETDEC and GETHX do, up to another character."""
    value, count, overflows = 0, 0, False
    while True:
        code, behind = gnumci(buffer)
        digit = digits.find(code)
        if digit < 0:
            # What ends the number is read again: the pointer stays on it.
            return Number(value, count, overflows), buffer
        value = value * len(digits) + digit
        overflows |= value > WORD
        value &= WORD
        count, buffer = count + 1, behind

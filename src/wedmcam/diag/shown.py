r"""Text of files as people may see it: nothing in it can drive a terminal or turn a line around.

Layer, block and file names, texts of programs and T labels are whatever was written into a
file: control characters that clear a screen, marks that make the rest of a line run from right to
left, bytes of a file name that are no UTF-8. They are shown as escapes: ``\x1b``, ``\u202e``.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable
from typing import Any
from unicodedata import category

#: A text of a finding that is longer than this is cut in its middle, characters.
LONGEST = 2000
#: Characters that are shown although Python prints them as escapes: blanks of all widths, and the
#: joiners without which Persian and Indic names are misspelt.
_SEEN = ("\u200c", "\u200d")
_PLAIN = re.compile(r"[ -~]*")
_RAW_BYTES = range(0xDC80, 0xDD00)


def _escaped(character: str) -> str:
    code = ord(character)
    if character.isprintable() or category(character) == "Zs" or character in _SEEN:
        return character
    if code in _RAW_BYTES:  # a byte of a name that is no UTF-8 (PEP 383)
        return f"\\x{code - 0xDC00:02x}"
    if code < 0x80:
        return {"\n": "\\n", "\r": "\\r", "\t": "\\t"}.get(character, f"\\x{code:02x}")
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def visible(text: str, keep: str = "") -> str:
    r"""Return a text with everything escaped that is no visible character.

    Args:
        text: of a file, or a message that quotes one.
        keep: control characters that stay: line ends of what is several lines, tabs of an excerpt.

    >>> print(visible("a\x1b[31m\u202eb\udcff"))
    a\x1b[31m\u202eb\xff
    """
    if _PLAIN.fullmatch(text) or text.isprintable():
        return text
    return "".join(c if c in keep else _escaped(c) for c in text)


def shortened(text: str, most: int = LONGEST) -> str:
    """Return a text of at most about ``most`` characters: what is longer lacks its middle.

    >>> shortened("a" * 50, 10)
    'aaaaaaa ... (40 characters) ... aaa'
    """
    if len(text) <= most:
        return text
    head, tail = most - most // 3, most // 3
    return f"{text[:head]} ... ({len(text) - head - tail} characters) ... {text[-tail:]}"


def json_text(data: Any, indent: int | None = None) -> str:
    r"""Return data as JSON that is valid UTF-8 and shows no invisible character.

    Readers get the very text: JSON has escapes of its own for it.

    >>> json_text({"a": "b\u202e\udcff\x07"})
    '{"a": "b\\u202e\\udcff\\u0007"}'
    """
    text = json.dumps(data, indent=indent, ensure_ascii=False)
    return _INVISIBLE.sub(_json_escape, text)


#: JSON itself escapes what is below; of the rest each is looked at.
_INVISIBLE = re.compile(r"[^\x00-\x7e]")


def _json_escape(match: re.Match[str]) -> str:
    character = match[0]
    if _escaped(character) == character:
        return character
    return json.dumps(character)[1:-1]


def counted(names: Iterable[str]) -> str:
    """Return every different name once, in their order, with how often it is there.

    >>> counted(["M20", "M80", "M20"])
    'M20 (2 times), M80'
    """
    many = Counter(names)
    return ", ".join(name if n == 1 else f"{name} ({n} times)" for name, n in many.items())

"""Colours of drawings by number and by name, as filters and findings call them.

A colour is text: an AutoCAD colour index "1" to "255", or "#rrggbb". The pure colours are one,
whichever way a drawing states them (DXF reference, group codes 62 and 420).
"""

from __future__ import annotations

import re

#: Names of the first indices, as CAD programs show them.
NAMES = {
    "red": 1,
    "yellow": 2,
    "green": 3,
    "cyan": 4,
    "blue": 5,
    "magenta": 6,
    "white": 7,
    "black": 7,
    "grey": 8,
    "gray": 8,
}
#: True colours that are those of an index.
_PURE = {
    0xFF0000: 1,
    0xFFFF00: 2,
    0x00FF00: 3,
    0x00FFFF: 4,
    0x0000FF: 5,
    0xFF00FF: 6,
    0xFFFFFF: 7,
    0x000000: 7,
}


def colour_of(text: str) -> str:
    """Return a colour that somebody wrote.

    >>> colour_of("red"), colour_of("12"), colour_of("#FF8000"), colour_of("#ff0000")
    ('1', '12', '#ff8000', '1')

    Raises:
        ValueError: it is none.
    """
    word = text.strip().lower()
    if word in NAMES:
        return str(NAMES[word])
    if word.isdecimal() and 1 <= int(word) <= 255:
        return str(int(word))
    if re.fullmatch(r"#[0-9a-f]{6}", word):
        return of_rgb(int(word[1:], 16))
    raise ValueError(f"'{text}' is no colour: red to white, 1 to 255, or #rrggbb")


def of_rgb(rgb: int) -> str:
    """Return a true colour: that of an index where it is pure.

    >>> of_rgb(0x0000FF), of_rgb(0x123456)
    ('5', '#123456')
    """
    index = _PURE.get(rgb)
    return f"#{rgb & 0xFFFFFF:06x}" if index is None else str(index)


def shown(colour: str) -> str:
    """Return a colour as people call it.

    >>> shown("1"), shown("12"), shown("#123456")
    ('red', '12', '#123456')
    """
    names = {str(index): name for name, index in reversed(NAMES.items())}
    return names.get(colour, colour)

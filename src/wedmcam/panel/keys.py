"""The keys of the ZD-065: 16 hexadecimal digits, and eight whose meaning is software [S]."""

from __future__ import annotations

import re

DIGITS = tuple("0123456789ABCDEF")
FUNCTIONS = tuple(f"U{k}" for k in range(8))
KEYS = (*DIGITS, *FUNCTIONS)

_WORD = re.compile(r"[uU][0-7]|[0-9a-fA-F]+")


def keys_in(text: str) -> list[str] | None:
    """Return the keys that a line names; None where it names others.

    >>> keys_in("U5 0 0012 0015")
    ['U5', '0', '0', '0', '1', '2', '0', '0', '1', '5']
    >>> keys_in("U9"), keys_in("run")
    (None, None)
    """
    keys: list[str] = []
    for word in text.split():
        if not _WORD.fullmatch(word):
            return None
        upper = word.upper()
        keys += [upper] if upper[0] == "U" else list(upper)
    return keys or None

"""Names that a user gives of what is in a drawing: literal before they are wildcards."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable

#: Characters of wildcards.
WILD = frozenset("*?[")


class Names:
    """Names that were asked for: each is a name that there is, or else a wildcard.

    Attributes:
        unmatched: those that match nothing there is.
    """

    def __init__(self, names: Iterable[str], there: Iterable[str]) -> None:
        known = {name.casefold() for name in there}
        self._literal: set[str] = set()
        self._wild: list[str] = []
        self.unmatched: list[str] = []
        for name in names:
            word = name.casefold()
            self._literal.add(word)
            if word in known:
                continue
            if WILD & set(word):
                self._wild.append(word)
                if any(fnmatch.fnmatchcase(other, word) for other in known):
                    continue
            self.unmatched.append(name)

    def __bool__(self) -> bool:
        return bool(self._literal)

    def __contains__(self, name: str) -> bool:
        word = name.casefold()
        return word in self._literal or any(fnmatch.fnmatchcase(word, p) for p in self._wild)

"""Lists as values of findings that are printed otherwise than with commas.

JSON has them as lists (see `diag.data`); the sentence says "CUT, HOLES and 3 more", or "5 and 7".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


class Listing(list[Any]):
    """Things of a list, and how they are printed.

    Attributes:
        between: what is printed between two of them.
        end: what is printed between the last two.
        unnamed: how many more there are that are not in the list.
    """

    def __init__(
        self, things: Iterable[Any], between: str = ", ", end: str | None = None, unnamed: int = 0
    ) -> None:
        super().__init__(things)
        self.between, self.end, self.unnamed = between, end, unnamed

    def __str__(self) -> str:
        words = [str(thing) for thing in self]
        if self.end is not None and len(words) > 1:
            words[-2:] = [f"{words[-2]}{self.end}{words[-1]}"]
        return self.between.join(words) + (f" and {self.unnamed} more" if self.unnamed else "")


def first_of(things: Sequence[Any], most: int) -> Listing:
    """Return the first things; how many more there are is printed.

    >>> print(first_of(["a", "b", "c"], 2))
    a, b and 1 more
    """
    return Listing(things[:most], unnamed=max(0, len(things) - most))


def all_of(things: Iterable[Any]) -> Listing:
    """Return things with "and" before the last.

    >>> print(all_of([1, 2, 3]))
    1, 2 and 3
    """
    return Listing(things, end=" and ")

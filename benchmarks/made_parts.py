"""Parts of a page of docs/ that are made from the program, between two comments.

A page says where a table goes, ``<!-- made: NAME -->`` to ``<!-- end -->``; who makes the tables
gives them by name. ``benchmarks/pages.py`` writes the pages, tests compare them.
"""

import re
from collections.abc import Callable, Iterator, Mapping

_PART = re.compile(r"^<!-- made: ([a-z0-9-]+) -->\n.*?^<!-- end -->$", re.M | re.S)


def parts_of(page: str) -> Iterator[str]:
    """Yield the names of the parts of a page that are made."""
    for found in _PART.finditer(page):
        yield found.group(1)


def filled(page: str, parts: Mapping[str, Callable[[], str]]) -> str:
    """Return a page with its parts written anew."""
    return _PART.sub(
        lambda found: f"<!-- made: {found.group(1)} -->\n{parts[found.group(1)]()}\n<!-- end -->",
        page,
    )

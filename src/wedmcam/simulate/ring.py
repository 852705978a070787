"""The ring distributor in software (环形分配器): which phases of a step motor carry current.

Three phases and six steps, A, AB, B, BC, C, CA, forwards and backwards [S: three-phase; R: six].
"""

from __future__ import annotations

#: Steps after which the pattern repeats.
TURN = 6
#: Phases that carry current after 0, 1, ... steps forwards.
PATTERNS = ("A", "AB", "B", "BC", "C", "CA")


def pattern(motor: int) -> str:
    """Return the phases that carry current when a motor has made so many steps, net.

    >>> [pattern(k) for k in (0, 1, 2, -1)]
    ['A', 'AB', 'B', 'CA']
    """
    return PATTERNS[motor % TURN]

"""The steps of a short block drawn as text: a stair on the grid, each place with its number.

Who teaches or learns the method compares it with a step table on paper.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

#: Most steps, and most steps across, of what is drawn.
MOST_STEPS = 48
MOST_ACROSS = 16

_WIDTH = 5


def fits(places: Sequence[tuple[int, int]]) -> bool:
    """Return whether a path is a stair, each step along one axis, and short enough to be drawn."""
    ways = (abs(c - a) + abs(d - b) for (a, b), (c, d) in pairwise(places))
    across = (max(p[k] for p in places) - min(p[k] for p in places) for k in range(2))
    return len(places) <= MOST_STEPS + 1 and max(across) <= MOST_ACROSS and set(ways) <= {1}


def stair(places: Sequence[tuple[int, int]]) -> list[str]:
    """Return the lines of a drawing, y upwards on the left, x below.

    Args:
        places: behind 0, 1, ... steps, each 1 beside the one before; whole.

    Where the path comes to a place once more, that has the first of its numbers.

    >>> print(*stair([(0, 0), (1, 0), (1, 1), (2, 1)]), sep=chr(10))
         y
         1       2----3
                 |
         0  0----1
    <BLANKLINE>
         x  0    1    2
    """
    left, low = (min(p[k] for p in places) for k in range(2))
    right, high = (max(p[k] for p in places) for k in range(2))
    rows = [[" "] * (_WIDTH * (right - left + 1)) for _ in range(2 * (high - low) + 1)]

    def cell(place: tuple[int, int]) -> tuple[int, int]:
        return 2 * (high - place[1]), _WIDTH * (place[0] - left)

    for a, b in pairwise(places):
        row, column = cell(min(a, b))
        if a[1] == b[1]:
            rows[row][column : column + _WIDTH] = "-" * _WIDTH
        else:
            rows[row - 1][column] = "|"
    for n in range(len(places) - 1, -1, -1):
        row, column = cell(places[n])
        number = str(n)
        rows[row][column : column + 2] = number.ljust(2, rows[row][column + 1])
    lines = ["     y"]
    for k, row_text in enumerate(rows):
        y = f"{high - k // 2:6d}  " if k % 2 == 0 else " " * 8
        lines.append((y + "".join(row_text)).rstrip())
    scale = "".join(f"{x:<{_WIDTH}d}" for x in range(left, right + 1))
    return [*lines, "", f"     x  {scale}".rstrip()]

"""The 3B record ``B X B Y B J G Z``: field rules that reader and writer share.

Text format of fast-wire controllers. All numbers are magnitudes in um of at most six digits; each
record starts where the last one stopped. A record holds no end point: the end is where J steps on
the axis G have been counted. Marks: [S] published rule, [M] measured, [R] our decision.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Kind

#: Six digits a field [S].
LARGEST = 999_999

#: Order of instruction codes: code = 4 * (0 line, 1 NR, 2 SR) + quadrant - 1.
INSTRUCTIONS = tuple(f"{kind}{q}" for kind in ("L", "NR", "SR") for q in (1, 2, 3, 4))

#: turn of a block -> 0 line, 1 NR, 2 SR.
_KIND_OF_TURN = np.array([0, 1, 2], dtype=np.int64)  # indexed by turn: 0, 1, -1


def instruction(turn: NDArray[np.integer], quadrant: NDArray[np.integer]) -> NDArray[np.int64]:
    """Return the index into `INSTRUCTIONS`; ``turn`` 0 for lines and moves.

    >>> INSTRUCTIONS[instruction(np.array([1]), np.array([1]))[0]]
    'NR1'
    """
    code: NDArray[np.int64] = 4 * _KIND_OF_TURN[turn] + np.asarray(quadrant, dtype=np.int64) - 1
    return code


def moves(kinds: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Return which blocks are lines or moves alone between two pauses.

    3B has no record for a move: a line block alone between two D is one, and nothing else is [R].
    """
    result = np.zeros(len(kinds), dtype=bool)
    if len(kinds) > 2:
        straight = (kinds == Kind.LINE) | (kinds == Kind.MOVE)
        pause = kinds == Kind.PAUSE
        result[1:-1] = straight[1:-1] & pause[:-2] & pause[2:]
    return result


def is_word(text: str) -> bool:
    """Return whether a bare word can stand on a line and be read as that word.

    >>> is_word("M02"), is_word("N12"), is_word("B5"), is_word("GO ON")
    (True, False, False, False)
    """
    return bool(
        re.fullmatch("[A-Z][A-Z0-9]{0,15}", text)
        and not re.match(r"N\d", text)  # an N number
        and not re.search(r"B\d*B|G[XY](?:L|[SN]R)\d", text)  # part of a record
        and not re.fullmatch(r"B\d*", text)
    )


def largest_turn(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the largest J of one full circle that starts at (x, y) from its centre.

    A full circle counts 4R [S]; where R is no whole number the interpolator reaches ceil(R) at
    each apex [M].
    """
    return 4 * np.ceil(np.hypot(x, y)).astype(np.int64)

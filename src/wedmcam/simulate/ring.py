"""The ring distributor in software (环形分配器): which phases of a step motor carry current.

Three phases and six steps, A, AB, B, BC, C, CA, forwards and backwards [S: three-phase; R: six].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Steps after which the pattern repeats.
TURN = 6
#: Phases that carry current after 0, 1, ... steps forwards.
PATTERNS = ("A", "AB", "B", "BC", "C", "CA")
#: The same as bits of a port: A is bit 0, B bit 1, C bit 2.
BITS = np.array([0b001, 0b011, 0b010, 0b110, 0b100, 0b101], dtype=np.uint8)


def pattern(motor: int) -> str:
    """Return the phases that carry current when a motor has made so many steps, net.

    >>> [pattern(k) for k in (0, 1, 2, -1)]
    ['A', 'AB', 'B', 'CA']
    """
    return PATTERNS[motor % TURN]


def port(motor_x: NDArray[np.int64], motor_y: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return the byte at the port of the motors: x in the bits 0 to 2, y in the bits 3 to 5.

    >>> port(np.array([0, 1]), np.array([0, -1])).tolist()
    [9, 43]
    """
    return BITS[motor_x % TURN] | BITS[motor_y % TURN] << np.uint8(3)

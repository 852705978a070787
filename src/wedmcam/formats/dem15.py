"""Job records of the DEM-15 with Eindhoven's microcomputer: a vector a line.

The main program takes in place, new place, t(i), t(p) and cutting speed (the report, section 5.1).
How they stand in a file is a ruling: numbers as GETNUM reads them, parted by blanks, at most the 64
characters of the terminal's line:

    UM                              what positions count: UM, or STEPS
    0 10000 5000 10000 100 200 64   x y, new x y, t(i), t(p), speed
    P                               the machine waits for the operator
    E                               end

A record whose t(i) and t(p) are 0 is run with the generator off: a move. A place and the new place
of the record before are the same, so that a lost line is seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Fields of a record, in their order.
FIELDS = ("x", "y", "new x", "new y", "t(i)", "t(p)", "speed")
#: Characters of the terminal's command line (routine LINE).
LINE = 64
#: Largest position (16 bits), control word (8 bits) and speed (7 bits).
PLACE, CONTROL, FASTEST = 0xFFFF, 0xFF, 127
MOST = np.array([PLACE, PLACE, PLACE, PLACE, CONTROL, CONTROL, FASTEST])
#: What a profile calls the unit of positions -> the word for it, and how many make a step.
UNITS = {"um": ("UM", 2), "steps": ("STEPS", 1)}
PAUSE, END = "P", "E"
#: How far a step moves either axis, um.
STEP_UM = 2
#: One unit of speed, um a minute.
SPEED_UM = 15.75

#: Volts of the control words at 255.
VOLTS_T_I, VOLTS_T_P = 5.0, 15.0
#: Below 7 V the pulse generator cuts out: the least word of t(p).
LEAST_T_P = 119
#: What the supply gives, A.
MOST_A = 2.0


def current(t_i: ArrayLike, t_p: ArrayLike) -> NDArray[np.float64]:
    """Return the mean current of the generator, A.

    Graph 4-3 of the report, which shows the words that give 2 A, is lost. A ruling: the current
    goes with the duration of a pulse over the period of pulses, both go with their voltages, and
    pulses of full duration (5 V) draw 2 A with a period of 10 V. So it is 4 A times V(t(i)) over
    V(t(p)), and 2 A are drawn where t(i) is one and a half times t(p).

    >>> current([255, 100, 178], [170, 200, 119]).round(3).tolist()
    [2.0, 0.667, 1.994]
    """
    volts = np.asarray(t_i) * (VOLTS_T_I / CONTROL), np.asarray(t_p) * (VOLTS_T_P / CONTROL)
    return np.asarray(4.0 * volts[0] / np.maximum(volts[1], 1e-9))


def too_much(t_i: ArrayLike, t_p: ArrayLike) -> NDArray[np.bool_]:
    """Return where control words would draw more than 2 A, in whole numbers: exact.

    >>> too_much([178, 179, 255], [119, 119, 170]).tolist()
    [False, True, False]
    """
    return np.asarray(2 * np.asarray(t_i) > 3 * np.asarray(t_p))


def reach(travel_um: tuple[int, int] | None, positions: str) -> tuple[int, int]:
    """Return how many steps the table and 16 bits have room for, along x and y of the machine.

    Args:
        travel_um: of the table; None for no limit.
        positions: a key of `UNITS`.

    >>> reach((65_000, 65_000), "um"), reach(None, "um"), reach(None, "steps")
    ((32500, 32500), (32767, 32767), (65535, 65535))
    """
    most = PLACE // UNITS[positions][1]
    x, y = (int(um // STEP_UM) for um in travel_um or (10**9, 10**9))
    return min(x, most), min(y, most)


def speed_of(feed_um: float) -> int:
    """Return the largest speed that is not above a feed, um a minute; 0 where none is so low.

    >>> speed_of(1000.0), speed_of(2000.25), speed_of(15.0), speed_of(9999.0)
    (63, 127, 0, 634)
    """
    return int(np.floor(feed_um / SPEED_UM + 1e-9))

"""The ports through which the microcomputer drives the machine (table 5-2 of the report) [S].

Two control voltages for the pulse generator, one port for the generator's switch and the motors,
two ports from which the pulse counters are read. Which bit of 4022 is which line is a ruling.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntFlag

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Addresses [S].
T_I, T_P, DRIVE = 0x4020, 0x4021, 0x4022
SHORTS, OPENS, HANDSHAKE = 0x4030, 0x4031, 0x4032


class Drive(IntFlag):
    """Lines of port 4022 [S]; their bits [R]."""

    OEV = 1  # 1 stops the pulse generator, 0 runs it [S]
    X_DIR = 2  # 1 is the positive direction [S]
    X_PULSE = 4  # a rising edge is a step [S]
    Y_DIR = 8
    Y_PULSE = 16


@dataclass(frozen=True, slots=True)
class Outputs:
    """What stands at the output ports.

    Attributes:
        t_i, t_p: words of the control voltages.
        drive: of port 4022.

    >>> SAFE.words
    {'4020': 0, '4021': 0, '4022': 1}
    """

    t_i: int = 0
    t_p: int = 0
    drive: Drive = Drive.OEV

    @property
    def words(self) -> dict[str, int]:
        """Address -> word."""
        return {f"{T_I:04x}": self.t_i, f"{T_P:04x}": self.t_p, f"{DRIVE:04x}": int(self.drive)}


#: After the initialisation, which is the emergency routine too: voltages 0, generator off [S].
SAFE = Outputs()


def drive_words(axis: ArrayLike, sign: ArrayLike, cutting: ArrayLike) -> NDArray[np.int64]:
    """Return port 4022 at the rising edge of each step.

    Args:
        axis: 0 for x, 1 for y.
        sign: of the step, +1 or -1.
        cutting: whether the generator is on.

    >>> drive_words([0, 1], [1, -1], [True, False]).tolist()
    [6, 17]
    """
    on_x, up = np.asarray(axis) == 0, np.asarray(sign) > 0
    pulse = np.where(on_x, int(Drive.X_PULSE), int(Drive.Y_PULSE))
    direction = np.where(up, np.where(on_x, int(Drive.X_DIR), int(Drive.Y_DIR)), 0)
    switch = np.where(cutting, 0, int(Drive.OEV))
    # Each is a line of its own, so that their sum is their union.
    return np.asarray(pulse + direction + switch, np.int64)

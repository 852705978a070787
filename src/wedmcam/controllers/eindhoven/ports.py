"""The ports through which the microcomputer drives the machine (table 5-2 of the report) [S].

Two control voltages for the pulse generator, one port for the generator's switch and the motors,
two ports from which the pulse counters are read. Which bit of 4022 is which line is a ruling.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntFlag

from wedmcam.formats.dem15 import CONTROL, VOLTS_T_I, VOLTS_T_P

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

    @property
    def volts(self) -> tuple[float, float]:
        """V(t(i)) and V(t(p))."""
        return self.t_i * VOLTS_T_I / CONTROL, self.t_p * VOLTS_T_P / CONTROL


#: After the initialisation, which is the emergency routine too: voltages 0, generator off [S].
SAFE = Outputs()


def drive_word(axis: int, sign: int, cutting: bool) -> Drive:
    """Return port 4022 at the rising edge of a step.

    Args:
        axis: 0 for x, 1 for y.
        sign: of the step.
        cutting: the generator is on.

    >>> int(drive_word(0, 1, True)), int(drive_word(1, -1, False))
    (6, 17)
    """
    lines = (Drive.X_DIR, Drive.X_PULSE) if axis == 0 else (Drive.Y_DIR, Drive.Y_PULSE)
    word = lines[1] | (lines[0] if sign > 0 else Drive(0))
    return word if cutting else word | Drive.OEV

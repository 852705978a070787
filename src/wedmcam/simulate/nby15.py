"""The controller of the NBY-15: what it does about faults.

Short circuit [S]: back along the last 256 steps, generator off; when it is free, forward with a
reference current alone up to where it was (SERVO-FEED), then on; at the end of the memory it stops
(MEMORY BLACKOUT). The tape is read three blocks ahead [S], and does not go back [S]: after a wire
break the machine stands, and the operator threads the wire there [R].
"""

from __future__ import annotations

from wedmcam.controllers import Stepping
from wedmcam.controllers.nby15.data import TapeProgram
from wedmcam.ir.program import Program
from wedmcam.simulate.controller import EVERYWHERE, Answers, Controller
from wedmcam.simulate.route import Route, lay
from wedmcam.simulate.scenario import Trouble


def lay_tape(program: Program, stepping: Stepping) -> Route:
    """Return the route of a tape: its records are the blocks of the tape, each of many degrees."""
    of = program.of if isinstance(program, TapeProgram) else None
    return lay(program, stepping, of)


NBY15 = Controller(
    name="nby15",
    title="NBY-15",
    format="nby15",
    programs="its punched tapes",
    suffix=".n15",
    answers=Answers(
        retreat=256,
        remembers=True,
        returns=False,
        servo_feed=True,
        troubles=EVERYWHERE | {Trouble.STOP, Trouble.LIMIT, Trouble.TAPE},
        ahead=3,
    ),
    lay=lay_tape,
)

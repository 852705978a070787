"""The controller of the NBY-15: what it does about faults, and what its panel shows.

Short circuit [S]: back along the last 256 steps, generator off; when it is free, forward with a
reference current alone up to where it was (SERVO-FEED), then on; at the end of the memory it stops
(MEMORY BLACKOUT). The memory is filled as the wire comes to new places; at the start of a program,
and behind a thread point, it holds less [R]. The tape is read three blocks ahead [S], and does not
go back [S]: after a wire break the machine stands, and the operator threads the wire there [R].
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from wedmcam.controllers import Stepping
from wedmcam.controllers.nby15.data import TapeProgram
from wedmcam.formats.tape import before_error
from wedmcam.ir.program import Program
from wedmcam.simulate.controller import EVERYWHERE, Answers, Controller
from wedmcam.simulate.process import Mode, Stand
from wedmcam.simulate.route import Route, lay
from wedmcam.simulate.scenario import Trouble


class Lamp(StrEnum):
    """The lamps of the front panel [S], and what the source says that they mean."""

    READY = "READY"  # the machine can be started
    START = "PROGRAMME START"  # the program runs
    STOP = "PROGRAMME STOP"  # it is interrupted
    FORWARD = "FORWARD"  # in the programmed direction
    RETURN = "RETURN"  # back in the memory, from a short circuit
    SERVO_FEED = "SERVO-FEED"  # forward out of the memory, with a reference current
    BLACKOUT = "MEMORY BLACKOUT"  # the end of the memory is reached
    TAPE = "TAPE"  # a reading error, or no tape in the reader
    OFF = "OFF"  # the machine is stopped


#: What is lit while the machine goes, by the way it goes [R: which of them together].
GOES: Mapping[str, tuple[Lamp, ...]] = {
    "forward": (Lamp.START, Lamp.FORWARD),
    "servo-feed": (Lamp.START, Lamp.SERVO_FEED),
    "return": (Lamp.START, Lamp.RETURN),
}
#: What is lit while it stands, by the event behind which it does [R]: interrupted, it is ready
#: again as soon as nothing is wrong; stopped for good, it is off.
STANDS: Mapping[str, tuple[Lamp, ...]] = {
    "pause": (Lamp.READY, Lamp.STOP),
    "thread-point": (Lamp.READY, Lamp.STOP),
    "alarm": (Lamp.STOP, Lamp.BLACKOUT),
    "break": (Lamp.STOP,),
    "no-tape": (Lamp.STOP,),
    "stop": (Lamp.OFF,),
    "limit": (Lamp.OFF,),
    "end": (Lamp.OFF,),
    "power-cut": (),
}


def lamps(kind: str, stand: Stand) -> tuple[str, ...]:
    """Return which lamps are lit behind an event.

    Args:
        kind: of the event; see `process.Incident`.
        stand: of the process then.

    >>> lamps("short", Stand(step=500, front=500))
    ('PROGRAMME START', 'RETURN')
    >>> lamps("clear", Stand(step=440, front=500, unread=7))
    ('PROGRAMME START', 'SERVO-FEED', 'TAPE')
    """
    if kind == "resume" and stand.mode is Mode.ALARM:
        kind = "alarm" if stand.short else "limit"
    if kind in STANDS:
        lit = STANDS[kind]
    elif kind == "short" or stand.mode is Mode.RETREAT:
        lit = GOES["return"]
    else:
        lit = GOES["servo-feed" if stand.step < stand.front else "forward"]
    if stand.unread and kind != "power-cut":
        lit = (*lit, Lamp.TAPE)
    return tuple(str(lamp) for lamp in lit)


#: What happened, in the words of this machine.
SENTENCES = {
    "pause": "M00: the machine waits",
    "short": "short circuit: RETURN along the memory; {length} um back it is free",
    "clear": "{gone}the short circuit is gone: SERVO-FEED",
    "front": "where the short circuit was: FORWARD",
    "alarm": "MEMORY BLACKOUT: still shorted{still}, nothing is left of the memory; it stops",
    "clear-alarm": "the operator has seen to it, and starts the machine",
    "break": "the wire is broken: the machine stands, and it is threaded there",
    "stop": "emergency stop",
    "start": "the operator has seen to it, and starts the machine",
    "limit": "a limit switch opens{switch}",
    "tape": "TAPE: no more of the tape is read; {ahead}",
    "no-tape": "nothing is left of what was read ahead: it stops, and the tape is put in",
}


def lay_tape(program: Program, stepping: Stepping) -> Route:
    """Return the route of a tape: its blocks are those of the tape, each of many degrees."""
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
    readable=before_error,
    lamps=lamps,
    sentences=SENTENCES,
)

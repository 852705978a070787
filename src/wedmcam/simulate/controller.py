"""What one simulated controller does otherwise than another, as values.

The machinery of a run (`run`, `process`, `motion`) knows no controller by name; `controllers` lists
them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.ir.program import Program
from wedmcam.simulate.route import Route, lay
from wedmcam.simulate.scenario import Trouble

if TYPE_CHECKING:
    from wedmcam.simulate.process import Stand

#: What goes wrong at every machine.
EVERYWHERE = frozenset({Trouble.SHORT, Trouble.BREAK, Trouble.POWER})


@dataclass(frozen=True, slots=True)
class Answers:
    """What a controller does about faults.

    Attributes:
        retreat: so many steps it goes back from a short circuit at most.
        remembers: the way back is kept in a memory of so many steps: it ends there, behind the
            farthest place that the wire has come to. Who goes forward by it sees no program: no
            pause is made twice. Else the controller computes it from the program.
        returns: after a wire break it returns to a thread point or a block; else it stops on the
            spot, and the operator threads the wire there.
        shortest: with one thread point it returns to it straight.
        servo_feed: over the path that is cut already it goes forward with a reference current.
        troubles: what goes wrong with this machine.
        ahead: so many blocks of the program are read ahead of the one in work; 0 where the whole
            program is in memory.
    """

    retreat: int
    remembers: bool = False
    returns: bool = True
    shortest: bool = False
    servo_feed: bool = False
    troubles: frozenset[Trouble] = field(default=EVERYWHERE)
    ahead: int = 0


@dataclass(frozen=True, slots=True)
class Controller:
    """A controller that can be simulated.

    Attributes:
        name: on the command line, in states and in reports.
        title: as people call it.
        format: of the programs that it runs.
        programs: what people call them.
        suffix: of their files.
        answers: what it does about faults.
        takes_up_play: the backlash of both axes is entered, and it takes it up.
        takes_feed: the feed comes from outside; else the program states its speeds.
        runs_dry: it has a dry run.
        lay: how the route of a program is laid.
        readable: of bytes with an error, those in front of it, where the machine runs them: a tape
            is read while it runs. None where the whole program is read first.
        lamps: of its panel, those that are lit behind an event of a kind (`process.Incident`).
        sentences: kind of an event -> what people read of it, where its own words differ.
        outputs: kind of an event -> address and word of its ports then, where they are known.
        drive: address of the port that drives the motors, and its words, of axis, sign, and whether
            the generator is on; None where a ring distributor drives them.
    """

    name: str
    title: str
    format: str
    programs: str
    suffix: str
    answers: Answers
    takes_up_play: bool = False
    takes_feed: bool = True
    runs_dry: bool = True
    lay: Callable[[Program, Stepping], Route] = lay
    readable: Callable[[bytes], bytes] | None = None
    lamps: Callable[[str, Stand], tuple[str, ...]] | None = None
    sentences: Mapping[str, str] = field(default_factory=dict)
    outputs: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    drive: tuple[str, Callable[[Any, Any, Any], NDArray[np.int64]]] | None = None

"""The microcomputer of Eindhoven at a DEM-15: what it does about faults.

Limit switches, emergency stop and wire break are one interrupt, above those of the timers: the
outputs go to safe values, positions are kept [S], and the operator has to step in [S]. From a short
circuit the machine goes back; where that does not free the wire it stops [S: of the DEM-15 as
Agie built it]. How far is not in the source: the report's controller has no way back yet. Ours
keeps the last 255 steps, a byte counts them [R].
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.controllers.eindhoven.interrupts import EMERGENCIES
from wedmcam.controllers.eindhoven.ports import DRIVE, SAFE, drive_words
from wedmcam.controllers.eindhoven.vectors import Vectors
from wedmcam.ir.program import Program
from wedmcam.simulate.controller import EVERYWHERE, Answers, Controller
from wedmcam.simulate.route import Route, lay
from wedmcam.simulate.scenario import Trouble


def lay_vectors(program: Program, stepping: Stepping) -> Route:
    """Return the route of vectors: each states its speed, and J counts its steps down."""
    assert isinstance(stepping, Vectors)
    route = lay(program, stepping)
    seconds = stepping.step_seconds(route.program.blocks)
    waits = np.diff(seconds, prepend=0.0)
    waits[route.first[route.lengths > 0]] = seconds[route.first[route.lengths > 0]]
    return replace(route, by_steps=True, seconds=waits)


#: What stops the machine: all of it one interrupt, and the end of a way back.
STOPS = (*EMERGENCIES, "alarm")
_SAFE = ", ".join(f"{address} {word}" for address, word in SAFE.words.items())
#: What happened, in the words of this machine.
SENTENCES = {
    "short": "short circuit: the generator is off; {length} um back it is free",
    "clear": "{gone}the short circuit is gone: cut on",
    "alarm": f"still shorted{{still}}: the machine stops; ports {_SAFE}",
    "break": f"wire break: the emergency interrupt; ports {_SAFE}, positions kept",
    "stop": f"emergency stop: the emergency interrupt; ports {_SAFE}, positions kept",
    "limit": f"a limit switch: the emergency interrupt; ports {_SAFE}, positions kept",
    "start": "the operator has seen to it, and starts the machine",
    "clear-alarm": "the operator has seen to it, and starts the machine",
}

EINDHOVEN = Controller(
    name="eindhoven",
    title="DEM-15 of Eindhoven",
    format="dem15",
    programs="its job records",
    suffix=".d15",
    answers=Answers(
        retreat=255,
        remembers=True,
        returns=False,
        troubles=EVERYWHERE | {Trouble.STOP, Trouble.LIMIT},
    ),
    takes_feed=False,
    runs_dry=False,
    lay=lay_vectors,
    sentences=SENTENCES,
    outputs=dict.fromkeys((*STOPS, "end"), SAFE.words),
    drive=(f"{DRIVE:04x}", drive_words),
)

"""The controller of the ZD-065: what it does about faults.

Short circuit [S]: 100 um back along the path, through earlier blocks where needed, on again when
the feed signal is back, else stop and alarm. Wire break [S]: to the thread point, with one thread
point the shortest way, with several along the path to the last one passed, or to the start of a
block by its number. Power cut [S]: the state is saved, and cutting goes on from it. 100 um are 100
steps of the path [R].
"""

from __future__ import annotations

from wedmcam.simulate.controller import Answers, Controller

ZD065 = Controller(
    name="zd065",
    title="ZD-065",
    format="compact",
    programs="programs in its cutting format",
    suffix=".zd",
    answers=Answers(retreat=100, shortest=True),
    takes_up_play=True,
)

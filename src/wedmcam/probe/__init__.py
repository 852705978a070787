"""What controller is this? Small programs whose dry run tells, and what their readings mean.

A shop cannot look into an old controller, but it can read its display each time the machine waits.
``records`` has the programs, ``behaviour`` what each kind of controller makes of them, ``answers``
goes the way back from readings to a profile. What the page docs/probe.md says is made from these.
"""

from wedmcam.probe.answers import MEANS, Answer, answers, axes_of, read_sheet, sheet, toml
from wedmcam.probe.behaviour import Behaviour, Stop, behaviours, stops
from wedmcam.probe.records import PARTS, Record, Section, extents, text

__all__ = [
    "MEANS",
    "PARTS",
    "Answer",
    "Behaviour",
    "Record",
    "Section",
    "Stop",
    "answers",
    "axes_of",
    "behaviours",
    "extents",
    "read_sheet",
    "sheet",
    "stops",
    "text",
    "toml",
]

"""What the user of a drawing, and of a part program, calls what a planner speaks of.

The two are planned alike; only where something is stated differs: an option, or a clause of a cut.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

_ON_LINE = "the wire runs on the line, without an offset"
_ENTERED = "every contour is entered from a thread point or from the centre of its circle"
_OPEN = "it is for closed contours, and all are open"


@dataclass(frozen=True, slots=True, eq=False)
class Wording:
    """Words of one kind of source.

    Attributes:
        corner: what rounds corners.
        thread_point: how a thread point is given.
        of_part: the source is a part program.
        idle: code of what was stated and has no effect.
        idle_reasons: field of the options -> why it had no effect, where none was taken up; fields
            that are not named have one always.
        stated: fields that a cut may state by itself: then an option of 0 is a wish, too.
    """

    corner: str
    thread_point: str
    of_part: bool
    idle: str
    idle_reasons: Mapping[str, str]
    stated: frozenset[str]


OF_DRAWING = Wording(
    corner="--corner",
    thread_point="--start X,Y; a POINT on layer START",
    of_part=False,
    idle="idle-option",
    idle_reasons={
        "paper": _ON_LINE,
        "sharp": _ON_LINE,
        "trim": _ON_LINE,
        "lead_um": _ENTERED,
        "stop_um": _OPEN,
        "overcut_um": _OPEN,
    },
    stated=frozenset(),
)

OF_PART = Wording(
    corner="'corner'",
    thread_point="'start' of the cut",
    of_part=True,
    idle="wed-option",
    idle_reasons={
        "offset_um": "each cut names its offset, or runs on its line",
        "corner_um": "each cut names its corner",
        "paper": "each cut names its corners, or runs on its line",
        "sharp": _ON_LINE,
        "trim": _ON_LINE,
        "lead_um": "each cut names its lead, or is entered from its start or the centre of its "
        "circle",
        "stop_um": "each cut names its stop, or is open",
        "overcut_um": "each cut names its overcut, or is open",
    },
    stated=frozenset({"offset_um", "corner_um", "lead_um", "stop_um", "overcut_um"}),
)

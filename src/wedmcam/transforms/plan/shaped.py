"""What is asked of one cut, with its figure.

A part program has many; a drawing is one of all its contours, or one for each side and offset that
the options state for its layers (`drawing`).
"""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.ir.contour import Contour
from wedmcam.ir.part import CutItem
from wedmcam.ir.plan import Order
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.nest import Nesting


@dataclass(frozen=True, slots=True, eq=False)
class ShapedCut:
    """A cut whose figure has been through its transforms.

    Attributes:
        item: as written; what it leaves open the options say.
        figure: its contours.
        starts: thread points, each for one of its contours; moved by ``--transform``.
        enter: where the lead arrives, likewise moved.
        clockwise: for each contour whether the program states that it is run clockwise; it counts
            where the side is inside or outside. Empty where none is.
        order: in which order its contours are cut.
        nesting: how its contours lie in each other, where that is known: then the closed ones run
            counter-clockwise, they meet nowhere, and are one part. None where it is to be found.
        plate: cuts of different plates never make one part, and their leads do not meet.
        of_drawing: it is one of several cuts of a drawing, which states neither their order nor
            whose the thread points are.
    """

    item: CutItem
    figure: tuple[Contour, ...]
    starts: tuple[ThreadPoint, ...] = ()
    enter: ThreadPoint | None = None
    clockwise: tuple[bool, ...] = ()
    order: Order = Order.INNER_FIRST
    nesting: Nesting | None = None
    plate: int = 0
    of_drawing: bool = False

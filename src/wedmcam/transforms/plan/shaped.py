"""What is asked of one cut, with its figure: what a part program says of each."""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.ir.contour import Contour
from wedmcam.ir.part import CutItem
from wedmcam.ir.sketch import ThreadPoint


@dataclass(frozen=True, slots=True, eq=False)
class ShapedCut:
    """A cut whose figure has been through its transforms.

    Attributes:
        item: as written.
        figure: its contours.
        start: the thread point, moved by ``--transform``.
        enter: likewise.
        clockwise: for each contour whether the program states that it is run clockwise; it counts
            where the side is inside or outside.
    """

    item: CutItem
    figure: tuple[Contour, ...]
    start: ThreadPoint | None
    enter: ThreadPoint | None = None
    clockwise: tuple[bool, ...] = ()

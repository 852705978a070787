"""Plan: what the wire will do, in order, before the grid of the machine enters.

One `Cut` per contour: the outline as drawn, the wire path (exact, float um, starting where the lead
meets it), the thread point and the leads. Frames: drawing coordinates in um.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from wedmcam.ir.contour import Contour


class Side(enum.StrEnum):
    """Where the wire runs. PART keeps the material inside outer contours, DIE the reverse."""

    PART = "part"
    DIE = "die"
    LEFT = "left"
    RIGHT = "right"
    ON = "on"


class Order(enum.StrEnum):
    """In which order contours are cut. GIVEN: as drawn, whatever lies in what."""

    GIVEN = "given"
    INNER_FIRST = "inner-first"
    NEAREST = "nearest"


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """One contour to cut.

    Attributes:
        outline: the contour as drawn, in cutting direction; None where nobody drew it.
        path: where the centre of the wire goes: exact, in cutting direction; a closed path starts
            at the point where the lead arrives.
        thread: where the wire is threaded, whole um.
        depth: how many contours of the drawing enclose this one.
        keeps_left: the kept material lies to the left (True) or right (False) of the path; None
            for ``on``.
        stop_um: distance along the path before its end at which the machine pauses; 0 for none.
        overcut_um: how far a closed path is cut past its start.
        number: which of the plan's ``outlines`` it is of, 1-based. Never told: whatever is printed
            counts cuts as they are cut.
    """

    outline: Contour | None
    path: Contour
    thread: tuple[int, int]
    depth: int = 0
    keeps_left: bool | None = None
    stop_um: float = 0.0
    overcut_um: float = 0.0
    number: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Cuts in their order, and what they are to leave.

    Attributes:
        cuts: in cutting order.
        outlines: every contour of the part, whether cut or not: what bounds the kept material.
        depths: for each of ``outlines``, how many others enclose it.
        side: as asked for.
        offset_um: distance from the drawn outline to the wire's centre; 0 for ``on``.
        partial: other programs cut what these cuts leave: outlines that no closed path of them
            runs along need not be cut.
        parts: where cuts have sides and offsets of their own: for each kind the cuts (of
            ``cuts``), the outlines that they keep clear of, and their side and offset. Empty where
            one side and offset hold for all; then those above are only what is told.
        reached: numbers (from 0) of the outlines that ``cuts`` are to reach; None for all.
        before: how many outlines of the whole plan come before those of this part.
    """

    cuts: tuple[Cut, ...]
    outlines: tuple[Contour, ...]
    depths: tuple[int, ...]
    side: Side
    offset_um: float
    partial: bool = False
    parts: tuple[Plan, ...] = ()
    reached: tuple[int, ...] | None = None
    before: int = 0

    @property
    def kinds(self) -> tuple[Plan, ...]:
        """The plan itself, or its parts: each with one side and one offset."""
        return self.parts or (self,)

"""Part: what a program of the part language says, before any figure is moved or any wire runs.

The front end knows names, numbers and blocks; what a transform makes of a figure is for the stages
to say, which share their formulas with ``--transform``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from wedmcam.diag import TextSpan
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Transform


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A figure: chains of blocks as written, um, and the transforms that follow, in order."""

    chains: tuple[Contour, ...]
    stages: tuple[tuple[Transform, TextSpan], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class CutItem:
    """One ``cut``: what, on which side, and how. Lengths in um; None where it is not stated.

    Attributes:
        name: of the figure, for messages.
        shape: what is cut.
        side: inside, outside, left, right or on.
        span: of the statement; None where a drawing asks for it.
        offset: outline to wire centre.
        corner: radius rounded onto the part's own corners.
        paper: corners with a line have an arc, those between arcs none; None for as the options
            say.
        start: thread point (x, y), and where it is written.
        stop: how far before the end the machine pauses.
        lead: length of a lead where there is no thread point.
        enter: the lead arrives at the point of the wire path nearest to this (x, y), and where that
            is written.
        overcut: how far the path is cut past its start.
        clearance: by how much less than its offset the wire keeps from the outline.
    """

    name: str
    shape: Shape
    side: str
    span: TextSpan | None
    offset: float | None = None
    corner: float | None = None
    paper: bool | None = None
    start: tuple[float, float, TextSpan] | None = None
    stop: float | None = None
    lead: float | None = None
    enter: tuple[float, float, TextSpan] | None = None
    overcut: float | None = None
    clearance: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A whole program: its cuts in their order."""

    name: str = ""
    units: str = "mm"
    cuts: tuple[CutItem, ...] = ()
    blocks: dict[str, int] = field(default_factory=dict)

"""Sketch: the loose segments that a reader found, before anything is joined.

A drawing is a heap of lines and arcs in any order and direction. The reader turns each entity into
segments, scales them to micrometres and says where each came from; it joins nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import EntityRef, Span

#: One row per segment, um: start (x0, y0), end (x1, y1), centre (cx, cy) where turn is not 0.
#: turn: +1 counter-clockwise arc, -1 clockwise, 0 line. start == end with a turn: a full circle.
#: source: index into ``Sketch.sources``.
SEGMENT = np.dtype(
    [
        ("x0", "f8"),
        ("y0", "f8"),
        ("x1", "f8"),
        ("y1", "f8"),
        ("cx", "f8"),
        ("cy", "f8"),
        ("turn", "i1"),
        ("source", "i4"),
    ]
)


@dataclass(frozen=True, slots=True)
class ThreadPoint:
    """A start hole: (x, y) in um, drawing coordinates, and where it was stated.

    ``option``: the option that states it, such as "--start 1"; empty for one of the source.
    """

    x: float
    y: float
    span: Span | None = None
    option: str = ""


@dataclass(frozen=True, slots=True)
class SketchInfo:
    """What the reader saw besides geometry, for ``inspect`` and the summary.

    Attributes:
        units: "mm", "um" or "inch": the unit the numbers were taken in.
        units_from: "--units", "$INSUNITS 4", ...
        entities: entity type -> layer -> how many were read as geometry.
        ignored: entity type -> layer -> how many were not cut.
        version: e.g. "AC1015"; empty where there is none.
        extra: further facts, printed as they are.
    """

    units: str = "mm"
    units_from: str = ""
    entities: dict[str, dict[str, int]] = field(default_factory=dict)
    ignored: dict[str, dict[str, int]] = field(default_factory=dict)
    version: str = ""
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Unread:
    """Boundaries of what is drawn and was not read: fills, wide lines, faces. None is cut.

    Attributes:
        segments: um; those of one source are one boundary, in any order and direction.
        sources: the entity that each boundary is of; one with several boundaries is there often.
        within_um: how far ``segments`` may be from what was drawn.
    """

    segments: NDArray[np.void] = field(default_factory=lambda: np.zeros(0, SEGMENT))
    sources: tuple[EntityRef, ...] = ()
    within_um: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """Loose segments in um, thread points, and their sources. Takes ``segments`` over.

    ``unread``: what bounds the rest of the drawing. ``texts``: where it writes something, um, shape
    (texts, 2).
    """

    segments: NDArray[np.void]
    sources: tuple[Span, ...] = ()
    thread_points: tuple[ThreadPoint, ...] = ()
    info: SketchInfo = field(default_factory=SketchInfo)
    unread: Unread = field(default_factory=Unread)
    texts: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        s = self.segments
        assert s.dtype == SEGMENT, s.dtype
        assert s.ndim == 1
        assert not len(s) or (s["source"].min() >= -1 and s["source"].max() < len(self.sources))
        s.flags.writeable = False

"""What was understood of a source, a row a contour: the same values in every output.

A proof is about the drawing as it was understood. Whoever reads these rows sees which contour was
taken for a hole, which hole is T1 and which way the wire goes, before the part is cut. Outputs
(screen, JSON, setup sheet, picture, certificate) print these values and derive none by themselves.
Frames: drawing coordinates, um.
"""

from __future__ import annotations

import enum
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from wedmcam.diag import EntityRef
from wedmcam.ir.sketch import ThreadPoint

Point = tuple[float, float]
Box = tuple[float, float, float, float]

#: At most so many layers, entities and lines that drew one contour are named.
NAMED = 8


class Role(enum.StrEnum):
    """What a contour is by how contours lie in each other."""

    OUTER = "outer contour"
    HOLE = "hole"
    ISLAND = "island"
    OPEN = "open contour"

    @classmethod
    def of(cls, closed: bool, depth: int) -> Role:
        """Return the role of a contour that ``depth`` closed ones enclose.

        >>> [str(Role.of(True, depth)) for depth in (0, 1, 2)]
        ['outer contour', 'hole', 'island']
        """
        if not closed:
            return cls.OPEN
        if depth % 2:
            return cls.HOLE
        return cls.ISLAND if depth else cls.OUTER


#: One of each, and several.
_COUNTED = {
    Role.OUTER: ("outer", "outer"),
    Role.HOLE: ("hole", "holes"),
    Role.ISLAND: ("island", "islands"),
    Role.OPEN: ("open contour", "open contours"),
}


def counted(roles: Iterable[Role]) -> str:
    """Return how many contours have which role.

    >>> counted([Role.HOLE, Role.OUTER, Role.HOLE])
    '1 outer, 2 holes'
    """
    n = Counter(roles)
    names = ((n[role], one if n[role] == 1 else more) for role, (one, more) in _COUNTED.items())
    return ", ".join(f"{count} {name}" for count, name in names if count)


@dataclass(frozen=True, slots=True)
class Thread:
    """The thread point of a contour.

    Attributes:
        number: of its contour: T1 is that of contour 1.
        at: whole um.
        stated: as it was stated; None where wedmcam placed it.
    """

    number: int
    at: tuple[int, int]
    stated: ThreadPoint | None = None

    @property
    def name(self) -> str:
        """T1, T2, ..."""
        return f"T{self.number}"

    @property
    def placed_by(self) -> str:
        """Who placed it: "wedmcam", "drawing", "option" or "part program"."""
        if self.stated is None:
            return "wedmcam"
        if self.stated.option:
            return "option"
        return "drawing" if isinstance(self.stated.span, EntityRef) else "part program"

    @property
    def origin(self) -> str:
        """Where it comes from, in words behind its name.

        >>> Thread(1, (0, 0), ThreadPoint(0, 0, EntityRef("a.dxf", "2A", "POINT", "START"))).origin
        'the POINT #2A on layer START'
        """
        if self.stated is None:
            return "placed by wedmcam"
        if self.stated.option:
            return self.stated.option
        span = self.stated.span
        if isinstance(span, EntityRef):
            return f"the {span.dxftype} {_handle(span)} on layer {span.layer}"
        line = getattr(span, "line", None)
        return "stated in the source" if line is None else f"'start' at line {line}"

    def as_data(self) -> dict[str, Any]:
        """Return it as plain data."""
        span = None if self.stated is None else self.stated.span
        where: dict[str, Any] | None = None
        if isinstance(span, EntityRef):
            where = {"type": span.dxftype, "handle": _handle(span)[1:], "layer": span.layer}
        elif (line := getattr(span, "line", None)) is not None:
            where = {"line": line}
        elif self.stated is not None:
            where = {"option": self.stated.option}
        return {
            "name": self.name,
            "at_um": list(self.at),
            "placed_by": self.placed_by,
            "where": where,
            "said": self.origin,
        }


def _handle(ref: EntityRef) -> str:
    return "#" + "/".join((*ref.via, ref.handle))


@dataclass(frozen=True, slots=True)
class DrawnBy:
    """What a contour was drawn by; at most `NAMED` of each are there, in the order of the contour.

    Attributes:
        layers: names.
        handles: of entities, behind those of the INSERTs they came by.
        lines: of a part program.
        more: how many entities, or lines, are not named.
        file: of the part program; no part of the data, for it says nothing of the part.
    """

    layers: tuple[str, ...] = ()
    handles: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()
    more: int = 0
    file: str = ""

    @property
    def text(self) -> str:
        """In words: 'layer CUT #2A, #2B and 12 more', 'part.wed:8, 9'."""
        parts = []
        if self.layers:
            parts.append(f"layer{'s' * (len(self.layers) > 1)} {', '.join(self.layers)}")
        if self.handles:
            parts.append(", ".join(f"#{h}" for h in self.handles))
        if self.lines:
            parts.append(f"{self.file}:{', '.join(map(str, self.lines))}")
        if self.more:
            parts.append(f"and {self.more} more")
        return " ".join(parts) or "no entity"

    def as_data(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "layers": list(self.layers),
            "handles": list(self.handles),
            "lines": list(self.lines),
            "more": self.more,
        }


@dataclass(frozen=True, slots=True)
class Row:
    """A contour as it was understood, and how it is cut.

    Attributes:
        number: in the order of cutting, from 1; blocks, T and findings of the plan have the same.
        thread: its thread point.
        role: what it is.
        depth: how many closed contours of its part enclose it.
        kept: "inside" or "outside" of it is the material that stays; None where no side was asked
            for (``on``), and for open contours.
        side: as asked for: part, die, left, right, on.
        offset_um: from the contour to the wire's centre; below 0 behind it (`Cut.offset_um`).
        clearance_um: how far behind the contour the kept material begins.
        way: on which side of the contour the wire runs: "inside", "outside"; of an open one
            "left" or "right", as it is cut; None on the line itself.
        direction: "ccw", "cw"; of what is open from where to where.
        lead_um: length of the straight lead.
        enters: where the lead arrives.
        stop_um: how far before its end the machine waits; 0 for no stop.
        overcut_um: how far past its start it is cut.
        length_um: of the wire's path along the contour, without leads and overcut.
        extents: of the contour as drawn: x low, y low, x high, y high.
        frees: what comes loose when it is cut through: "part", "slug" or "piece"; None for nothing.
        drawn_by: layers, entities or lines.
    """

    number: int
    thread: Thread
    role: Role
    depth: int
    kept: str | None
    side: str
    offset_um: float
    clearance_um: float
    way: str | None
    direction: str
    lead_um: float
    enters: Point
    stop_um: float
    overcut_um: float
    length_um: float
    extents: Box
    frees: str | None
    drawn_by: DrawnBy

    @property
    def role_text(self) -> str:
        """The role; where contours lie deeper than a hole, the depth too."""
        deep = self.depth > 1 and self.role is not Role.OPEN
        return f"{self.role}, {self.depth + 1} deep" if deep else str(self.role)

    @property
    def kept_text(self) -> str:
        """Which material stays, in words."""
        return "no side kept" if self.kept is None else f"keeps the {self.kept}"

    @property
    def offset_text(self) -> str:
        """By how much the wire runs beside the contour, and which way."""
        takes = f", clearance {_mm(self.clearance_um)} mm" if self.clearance_um else ""
        if self.way is None:
            return "wire on the line" + takes
        return f"wire {_mm(abs(self.offset_um))} mm {self.way}{takes}"

    @property
    def size_text(self) -> str:
        """Width and height of the contour, mm."""
        x0, y0, x1, y1 = self.extents
        return f"{_mm(x1 - x0)} x {_mm(y1 - y0)} mm"

    @property
    def stop_text(self) -> str:
        """Where the machine waits before the contour is through."""
        return f"stop {_mm(self.stop_um)} mm before its end" if self.stop_um else "no stop"

    @property
    def overcut_text(self) -> str:
        """How far it is cut past its start."""
        return f"overcut {_mm(self.overcut_um)} mm" if self.overcut_um else "no overcut"

    @property
    def cells(self) -> tuple[str, ...]:
        """Everything in words, one text for each of `HEADINGS`."""
        return (
            self.thread.name,
            place(self.thread.at),
            self.role_text,
            self.size_text,
            self.kept_text,
            self.offset_text,
            self.direction,
            f"lead {_mm(self.lead_um)} mm",
            self.stop_text,
            self.overcut_text,
            f"length {_mm(self.length_um)} mm",
            self.drawn_by.text,
        )

    @property
    def text(self) -> str:
        """All of it in one line."""
        name, at, *rest = self.cells
        return f"{name} {at}: " + ", ".join(rest)

    def as_data(self) -> dict[str, Any]:
        """Return the row as plain data; rounded to nanometres."""
        return {
            "number": self.number,
            "thread": self.thread.as_data(),
            "role": str(self.role),
            "depth": self.depth,
            "kept": self.kept,
            "side": self.side,
            "offset_um": _nm(self.offset_um),
            "clearance_um": _nm(self.clearance_um),
            "way": self.way,
            "direction": self.direction,
            "lead_um": _nm(self.lead_um),
            "enters_um": [_nm(v) for v in self.enters],
            "stop_um": _nm(self.stop_um),
            "overcut_um": _nm(self.overcut_um),
            "length_um": _nm(self.length_um),
            "extents_um": [_nm(v) for v in self.extents],
            "frees": self.frees,
            "drawn_by": self.drawn_by.as_data(),
        }


@dataclass(frozen=True, slots=True)
class Understanding:
    """All contours that are cut, in their order."""

    rows: tuple[Row, ...]

    @property
    def counts(self) -> str:
        """How many contours are what: '1 outer, 2 holes'."""
        return counted(row.role for row in self.rows)

    @property
    def threads(self) -> tuple[str, ...]:
        """Sentences that say who placed each thread point, and what would choose it."""
        sentences = []
        own = [row for row in self.rows if row.thread.stated is None]
        for part in (False, True):
            of = [row for row in own if bool(row.drawn_by.lines) == part]
            if of:
                sentences.append(f"{_names(of)} placed by wedmcam {self._cure(part, len(of))}")
        stated = [row for row in self.rows if row.thread.stated is not None]
        sentences += [f"{row.thread.name} is {row.thread.origin}" for row in stated[:NAMED]]
        if len(stated) > NAMED:
            sentences.append(f"and {len(stated) - NAMED} more that were stated")
        return tuple(sentences)

    def _cure(self, part: bool, count: int) -> str:
        """Return why wedmcam placed thread points, and what would choose them."""
        them = "it" if count == 1 else "them"
        if part:
            return f"(no 'start' in the cut): 'start (x, y)' in the cut chooses {them}"
        drawn = any(row.thread.placed_by == "drawing" for row in self.rows)
        why = "no POINT on layer START serves " + them if drawn else "no POINT on layer START"
        return f"({why}): POINTs on layer START or --start choose {them}"

    def as_data(self) -> list[dict[str, Any]]:
        """Return the rows as plain data."""
        return [row.as_data() for row in self.rows]


def _names(rows: Sequence[Row]) -> str:
    """Return the names of thread points, neighbours together: 'T1 to T4, T7'."""
    runs: list[list[int]] = []
    for number in (row.number for row in rows):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    names = [f"T{r[0]}" + (f" to T{r[-1]}" if len(r) > 1 else "") for r in runs]
    more = len(names) - NAMED
    return ", ".join(names[:NAMED]) + (f" and {more} more runs" if more > 0 else "")


def place(at: Sequence[float]) -> str:
    """Return a place for people, mm.

    >>> place((1500, -0.2))
    '(1.500, 0.000)'
    """
    return f"({_mm(at[0])}, {_mm(at[1])})"


def _mm(um: float) -> str:
    return f"{round(um / 1000, 3) + 0.0:.3f}"


def _nm(um: float) -> float:
    return round(float(um), 3) + 0.0


#: What the `Row.cells` of a table are.
HEADINGS = (
    "contour",
    "threaded at mm",
    "is a",
    "size",
    "material",
    "offset",
    "direction",
    "lead",
    "stop",
    "overcut",
    "wire path",
    "drawn by",
)

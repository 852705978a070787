"""The probe as 3B: what asks, in which order, and its text in the layout of a profile.

Each section asks one thing and ends where the machine waits, so that an answer is the way from the
stop before. What a controller may refuse, or end the program at, is the last thing in a program of
its own: it cannot hide another answer. The writer of 3B cannot write this, and rightly: fields are
left blank, 45 degree lines are counted on the wrong axis, J is too short.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from wedmcam.controllers.pointwise import LineTable, trace
from wedmcam.formats import quadrants
from wedmcam.ir.program import BLOCK, Axis, Kind
from wedmcam.machines import Layout, Machine


@dataclass(frozen=True, slots=True)
class Record:
    """A 3B record as it is written; x and y are magnitudes, None for a field left blank.

    >>> Record(None, None, 500, "Y", "L2").text(Layout())
    'BBB500GYL2'
    """

    x: int | None
    y: int | None
    count: int
    axis: str
    z: str

    def text(self, layout: Layout) -> str:
        """Return the record in a layout."""
        gap, b = layout.between, f"B{layout.after_b}"
        digits = layout.count_digits
        count = f"{self.count:0{digits}d}" if digits > 1 else f"{self.count:{layout.width}d}"
        x, y = (("" if v is None else str(v)).rjust(layout.width) for v in (self.x, self.y))
        if layout.width == 1:
            x, y = x.strip(), y.strip()
        return f"{b}{x}{gap}{b}{y}{gap}{b}{count}{gap}G{self.axis}{gap}{self.z}"

    @property
    def block(self) -> np.void:
        """The record as a controller that takes it runs it; X = Y = 0 along the count axis."""
        block = np.zeros(1, BLOCK)
        kind, quadrant = self.z[:-1], int(self.z[-1])
        axis = Axis.X if self.axis == "X" else Axis.Y
        x, y = self.x or 0, self.y or 0
        if x == y == 0:
            x, y = (self.count, 0) if axis == Axis.X else (0, self.count)
        signed = quadrants.signed(np.array([x]), np.array([y]), np.array([quadrant]))
        block["kind"] = Kind.LINE if kind == "L" else Kind.ARC
        block["turn"] = {"L": 0, "NR": 1, "SR": -1}[kind]
        block["x"], block["y"] = signed
        block["axis"], block["count"] = axis, self.count
        one: np.void = block[0]
        return one


#: A step of a section: a record, or a control word by what it is called in a profile.
Step = Record | str


@dataclass(frozen=True, slots=True)
class Section:
    """What asks one thing.

    Attributes:
        name: in the sheet of readings.
        asks: what it answers.
        field: of `behaviour.Behaviour` that its way depends on; empty for none.
        steps: records and control words ("pause", "stop", "end"); the last one is a word.
    """

    name: str
    asks: str
    field: str
    steps: tuple[Step, ...]


def _line(x: int, y: int, z: str, axis: str | None = None) -> Record:
    axis = axis or ("X" if x > y else "Y")
    return Record(x, y, x if axis == "X" else y, axis, z)


#: 45 degree lines in quadrants 2 and 4, each counted on one axis: 1 um a record where it is wrong.
SHORT, TIMES = 20, 50
#: A circle of R 500.213 um whose text-book J, 4 R of the rounded R, is 4 steps short of a turn.
CIRCLE = (498, 47, 2000)

PARTS: dict[str, tuple[Section, ...]] = {
    "main": (
        Section(
            "pause",
            "whether the pause word makes the machine wait",
            "pause",
            (_line(1000, 0, "L1"), "pause"),
        ),
        Section(
            "axes",
            "which axes move, which way and how far",
            "",
            (_line(2000, 0, "L1"), _line(0, 1000, "L2"), "pause"),
        ),
        Section(
            "quadrant 2",
            "the line table",
            "table",
            (*(_line(SHORT, SHORT, "L2", "X"),) * TIMES, "pause"),
        ),
        Section(
            "quadrant 4",
            "the line table again, from the other side",
            "table",
            (*(_line(SHORT, SHORT, "L4", "Y"),) * TIMES, "pause"),
        ),
        Section(
            "circles GY",
            "whether arcs stop after J steps or where J and G say",
            "arcs",
            (*(Record(*CIRCLE, "Y", "NR1"),) * 10, "pause"),
        ),
        Section(
            "circles GX",
            "the same, ten times as sharp, and whether G is obeyed",
            "arcs",
            (*(Record(*CIRCLE, "X", "NR1"),) * 3, "pause"),
        ),
        Section(
            "stop",
            "what the stop word does",
            "stop",
            (_line(500, 0, "L1"), "stop"),
        ),
        Section(
            "behind stop",
            "the same",
            "stop",
            (_line(0, 500, "L2"), "pause", "stop"),
        ),
    ),
    "zeros": (
        Section(
            "zeros",
            "whether a record with X = Y = 0 is run",
            "zeros",
            (_line(1000, 0, "L1"), Record(0, 0, 500, "Y", "L2"), "pause", "stop"),
        ),
    ),
    "blanks": (
        Section(
            "one blank",
            "whether a field may be left blank",
            "blanks",
            (Record(1000, None, 1000, "X", "L1"), "pause"),
        ),
        Section(
            "two blanks",
            "whether BBB is a record",
            "blanks",
            (Record(None, None, 500, "Y", "L2"), "pause", "stop"),
        ),
    ),
    "end": (
        Section("end", "what the end word does", "end", (_line(500, 0, "L1"), "end")),
        Section("behind end", "the same", "end", (_line(0, 500, "L2"), "pause", "stop")),
    ),
}


def text(part: str, machine: Machine) -> bytes:
    """Return one of the programs in the layout and with the words of a 3B profile.

    >>> from wedmcam.machines import default
    >>> text("blanks", default("3b")).decode().split()
    ['B1000BB1000GXL1', 'D', 'BBB500GYL2', 'D', 'DD']
    """
    layout, words = machine.layout, machine.words
    lines: list[str] = []
    for step in _steps(PARTS[part]):
        record = step.text(layout) if isinstance(step, Record) else str(getattr(words, step))
        number = f"N{len(lines) + 1:{layout.number_width}d}{layout.after_number}"
        lines.append((number if layout.number_width else "") + record)
    every = [*layout.header, *lines, *layout.footer]
    return "".join(line + layout.eol for line in every).encode(layout.encoding)


def _steps(sections: Iterable[Section]) -> list[Step]:
    return [step for section in sections for step in section.steps]


def blocks(part: str) -> np.ndarray:
    """Return the records of a program as blocks, dtype `BLOCK`, control words left out."""
    rows = [step.block for step in _steps(PARTS[part]) if isinstance(step, Record)]
    return np.array(rows, dtype=BLOCK)


def extents(part: str) -> tuple[int, int, int, int]:
    """Return the box of every place on the way, steps, with a mm around it for any controller."""
    boxes = []
    for table in (LineTable.MIRROR, LineTable.ROTATE):
        at, _ = trace(blocks(part), table)
        boxes.append([*at.min(axis=0), *at.max(axis=0)])
    low, high = np.min(boxes, axis=0)[:2] - 1000, np.max(boxes, axis=0)[2:] + 1000
    return int(low[0]), int(low[1]), int(high[0]), int(high[1])

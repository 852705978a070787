"""Step tables of point-by-point comparison, for docs/zd065.md, section Interpolation.

All numbers come from the step loop and the readers of the project, so the page shows what they do.
``benchmarks/pages.py`` writes the parts between ``<!-- made: NAME -->`` and ``<!-- end -->`` and
the pictures of ``step_figures.py``; ``tests/unit/test_step_tables.py`` compares page and pictures
with what is made.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wedmcam import machines
from wedmcam.controllers.pointwise import (
    arc_quadrant,
    arc_steps,
    counts,
    line_axis,
    line_steps,
    trace,
)
from wedmcam.controllers.pointwise.back import arc_back, line_back
from wedmcam.controllers.pointwise.steps import ARC_TABLE
from wedmcam.diag import Severity
from wedmcam.frontends import decoder
from wedmcam.ir.program import BLOCK, Axis, Kind
from wedmcam.panel.machine import ERRORS
from wedmcam.panel.zd065 import FUNCTIONS, Mode
from wedmcam.reports.stair import stair

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "zd065.md"

Place = tuple[int, int]

#: Instructions by group and quadrant.
GROUPS = {"L": 0x00, "SR": 0x10, "NR": 0x20}


def _step(axis: int, sign: int) -> str:
    return f"{'xy'[axis]} {'+' if sign > 0 else '-'} 1"


class Row(NamedTuple):
    """One step of a block: the controller before it and behind it."""

    n: int
    name: str  # of the instruction in force: L1, NR2
    before: int  # F
    axis: Axis
    sign: int
    way: int  # what is added to F
    after: int
    place: Place
    counted: bool
    left: int  # J

    @property
    def step(self) -> str:
        return _step(self.axis, self.sign)


class Block(NamedTuple):
    """A line along (x, y), or an arc from (x, y) about (0, 0)."""

    x: int
    y: int
    turn: int  # 0 of a line
    count: int

    @property
    def start(self) -> Place:
        return (self.x, self.y) if self.turn else (0, 0)

    def rows(self) -> list[Row]:
        """Return its steps, counted as the ZD-065 counts."""
        if self.turn:
            axis = Axis.SQUARE
            steps = arc_steps(self.x, self.y, self.turn, axis, self.count)
        else:
            axis = line_axis(self.x, self.y)
            steps = line_steps(self.x, self.y, axis, self.count)
        out: list[Row] = []
        f, place, left = 0, self.start, self.count
        for n, s in enumerate(steps, 1):
            counted = counts(axis, s.axis, *place)
            left -= counted
            out.append(Row(n, self.name(place), f, s.axis, s.sign, s.f - f, s.f, (s.x, s.y),
                           counted, left))  # fmt: skip
            f, place = s.f, (s.x, s.y)
        return out

    def name(self, place: Place) -> str:
        """Return the instruction in force at a place."""
        if not self.turn:
            return f"L{arc_quadrant(self.x, self.y, 1)}"
        return f"{'NR' if self.turn > 0 else 'SR'}{arc_quadrant(*place, self.turn)}"

    def places(self) -> list[Place]:
        return [self.start, *(r.place for r in self.rows())]

    def f_at(self, place: Place) -> int:
        """Return F at a place, from the equation of its circle or line alone."""
        if self.turn:
            return place[0] ** 2 + place[1] ** 2 - self.x**2 - self.y**2
        return abs(self.x * place[1]) - abs(self.y * place[0])


#: The blocks of the page.
LINE = Block(6, 4, 0, 6)
ARC = Block(4, 0, +1, 11)
BESIDE = Block(5, -1, +1, 8)
RETURN = Block(9, 1, +1, 12)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def text(lines: Sequence[str]) -> str:
    return "\n".join(["```text", *lines, "```"])


def _sum(row: Row) -> str:
    return f"{row.before} {'+' if row.way >= 0 else '-'} {abs(row.way)} = {row.after}"


# --- step tables ----------------------------------------------------------------------------------


def line_table(block: Block = LINE) -> str:
    rows = [
        (r.n, r.before, f"F {'>=' if r.before >= 0 else '<'} 0: {r.step}", _sum(r), r.place, r.left)
        for r in block.rows()
    ]
    head = ("step", "F before", "decision", "F behind", "stands at", "J left")
    return f"{table(head, rows)}\n\n{text(stair(block.places()))}"


def arc_table(block: Block) -> str:
    rows = [
        (
            r.n,
            r.name,
            r.before,
            f"F {'>=' if r.before >= 0 else '<'} 0: {'in' if r.before >= 0 else 'out'}, {r.step}",
            _sum(r),
            r.place,
            "yes" if r.counted else "",
            r.left,
        )
        for r in block.rows()
    ]
    head = ("step", "as", "F before", "decision", "F behind", "stands at", "counts", "J left")
    return f"{table(head, rows)}\n\n{text(stair(block.places()))}"


def rules_table() -> str:
    """Return the eight cases of the arc rule."""
    rows = []
    for name, turn in (("NR", +1), ("SR", -1)):
        for quadrant in range(1, 5):
            (along, sign), (across, back) = ARC_TABLE[turn, quadrant]
            rows.append((f"{name}{quadrant}", _step(along, sign), _step(across, back)))
    return table(("instruction", "F >= 0: in", "F < 0: out"), rows)


def tie_table() -> str:
    """Return where lines at 45 degrees end, counted on x and on y."""
    rows = []
    for x, y in ((3, 3), (-3, 3), (-3, -3), (3, -3)):
        ends = [list(line_steps(x, y, axis, 3)) for axis in (Axis.X, Axis.Y)]
        rows.append((f"({x}, {y})", *(f"({e[-1].x}, {e[-1].y}) in {len(e)} steps" for e in ends)))
    return table(("line to", "counted on x it ends at", "counted on y"), rows)


# --- the square -----------------------------------------------------------------------------------


def circle_steps(radius: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of a full circle from (radius, 0), and whether each step is along y."""
    block = np.zeros(1, BLOCK)
    block["kind"], block["turn"], block["axis"] = Kind.ARC, 1, Axis.X
    block["x"], block["count"] = radius, 4 * radius + 4
    way, _ = trace(block)
    places = way + np.array([radius, 0])
    back = 8 * radius  # of a circle that starts on an axis, as long as the square around it
    assert tuple(places[back]) == (radius, 0)
    return places[: back + 1], np.diff(places[: back + 1, 1]) != 0


OCTANTS = (
    ("0 to 45", "y"), ("45 to 90", "x"), ("90 to 135", "x"), ("135 to 180", "y"),
    ("180 to 225", "y"), ("225 to 270", "x"), ("270 to 315", "x"), ("315 to 360", "y"),
)  # fmt: skip


def octant_counts(radius: int) -> list[tuple[int, int]]:
    """Return for each octant how many steps run along x and along y."""
    places, along_y = circle_steps(radius)
    x, y = places[:-1].T
    angle = np.degrees(np.arctan2(y, x)) % 360
    octant = np.minimum(angle // 45, 7).astype(int)
    return [(int((~along_y[octant == k]).sum()), int(along_y[octant == k].sum()))
            for k in range(8)]  # fmt: skip


def octant_table(radius: int = 10_000) -> str:
    found = octant_counts(radius)
    rows = []
    for (where, axis), steps in zip(OCTANTS, found, strict=True):
        cells = (f"**{n}**" if a == axis else n for a, n in zip("xy", steps, strict=True))
        rows.append((where, f"{axis} steps", *cells))
    head = ("degrees", "J counts", f"x steps at R = {radius} um", "y steps")
    return table(head, rows)


def full_circle(radius: int) -> tuple[int, int, int]:
    """Return J of a full circle where at |x| = |y| steps along y count, along x, and either."""
    places, along_y = circle_steps(radius)
    x, y = abs(places[:-1]).T
    strict = np.where(along_y, x > y, x < y).sum()
    tie = x == y
    return (int(strict + (tie & along_y).sum()), int(strict + (tie & ~along_y).sum()),
            int(strict + tie.sum()))  # fmt: skip


def circle_table(largest: int = 1_000) -> str:
    """Return how J of full circles differs from four sides of the square."""
    off = np.array([full_circle(r) for r in range(2, largest + 1)], dtype=float)
    off -= (4 * math.sqrt(2) * np.arange(2, largest + 1))[:, None]
    names = ("a y step counts (ours)", "an x step counts", "either counts")
    rows = [
        (name, f"{o.min():+.2f}", f"{o.mean():+.2f}", f"{o.max():+.2f}")
        for name, o in zip(names, off.T, strict=True)
    ]
    return table(("at 45 degrees", "least", "mean", f"largest of R = 2 to {largest} um"), rows)


# --- repair ---------------------------------------------------------------------------------------


def _read(name: str, data: bytes, profile: str) -> str:
    """Return as which instruction one block is read: bold where it was repaired."""
    machine = machines.builtin(profile)
    program, found = decoder(machine.format)(data + b"\0", machine, "block")
    for d in found:
        if d.code == "quadrant-repaired":
            return f"**{name}{d.values['repaired'] & 0xF}**"
        if d.severity == Severity.ERROR:
            return "refused"
    assert len(program.blocks) == 2, found
    return f"{name}{data[0] & 0xF}"


def bcd(value: int, size: int) -> bytes:
    return bytes.fromhex(f"{value:0{2 * size}d}")


def cutting(name: str, quadrant: int, x: int, y: int) -> bytes:
    """Return a block of the cutting format."""
    code = bytes([GROUPS[name] + quadrant])
    if name == "L":
        return code + bcd(x, 3) + bcd(y, 3)
    return code + bcd(x, 4) + bcd(y, 4) + bcd(3, 3)


def rotation(name: str, quadrant: int, degrees: int) -> bytes:
    """Return a block of the rotation format: 0.8 mm long, or R 10 mm over 20 degrees."""
    code = bytes([GROUPS[name] + quadrant])
    exponent = len(str(degrees)) if degrees else 0
    angle = bcd(exponent, 1) + bcd(degrees * 10 ** (8 - exponent), 4)
    if name == "L":
        return code + angle + bcd(800, 3)
    return code + angle + bcd(10_000, 4) + bcd(2, 1) + bcd(20_000_000, 4)


def repair_table() -> str:
    """Return what the cutting format's instructions are read as, by running the reader."""
    rows = []
    for name in GROUPS:
        for where, x, y in (("x, 0", 500, 0), ("0, y", 0, 500), ("x, y", 300, 400)):
            blocks = [cutting(name, q, x, y) for q in range(1, 5)]
            rows.append((name, where, *(_read(name, b, "zd065") for b in blocks)))
    return table(("", "numbers of the block", "quadrant written: 1", "2", "3", "4"), rows)


def angle_table() -> str:
    """Return the same of the rotation format, whose angles say the quadrant by themselves."""
    rows = []
    for name in GROUPS:
        for degrees in (0, 30, 90, 120):
            blocks = [rotation(name, q, degrees) for q in range(1, 5)]
            rows.append((name, degrees, *(_read(name, b, "zd065-rotation") for b in blocks)))
    return table(("", "angle, degrees", "quadrant written: 1", "2", "3", "4"), rows)


# --- back -----------------------------------------------------------------------------------------


class Undone(NamedTuple):
    """Where the controller stands on its way back, and the step that `back` says was the last."""

    place: Place
    f: int
    left: int
    axis: Axis
    sign: int  # 0 at the start


def undo(block: Block, place: Place, left: int = 0) -> list[Undone]:
    """Return the way back of a block from a place, with J left there, to its start.

    It takes place, F and J alone, and ends at the start where F is 0 and J whole again.
    """
    f = block.f_at(place)
    axis = Axis.SQUARE if block.turn else line_axis(block.x, block.y)
    out = []
    while place != block.start or f or left != block.count:
        if block.turn:
            along, sign, before = arc_back(*place, f, block.turn)
        else:
            along, sign, before = line_back(block.x, block.y, f)
        out.append(Undone(place, f, left, along, sign))
        x, y = place
        place = (x - sign, y) if along == Axis.X else (x, y - sign)
        f, left = before, left + counts(axis, along, *place)
    return [*out, Undone(place, f, left, Axis.X, 0)]


def opposite(path: Sequence[Place], turn: int) -> list[Place]:
    """Return the way of an arc from the end of a path back in the opposite sense, with F kept.

    As many steps as the path has. F at a place is x^2 + y^2 - R0^2, so it is kept by itself.
    """
    (x0, y0), (x, y) = path[0], path[-1]
    out = [(x, y)]
    for _ in range(len(path) - 1):
        inwards, outwards = ARC_TABLE[-turn, arc_quadrant(x, y, -turn)]
        along, sign = inwards if x * x + y * y >= x0 * x0 + y0 * y0 else outwards
        x, y = (x + sign, y) if along == Axis.X else (x, y + sign)
        out.append((x, y))
    return out


def back_table(block: Block = RETURN) -> str:
    """Return a step table forwards and, beside it, what the inverse and the opposite sense do."""
    rows, other = block.rows(), opposite(block.places(), block.turn)
    cut = set(block.places())
    undone = undo(block, rows[-1].place)
    lines = []
    for n in range(len(rows), -1, -1):
        (x, y), f, left, along, sign = undone[len(rows) - n]
        border = 2 * y - 2 * x - 2
        test = f"{f} {'>=' if f >= border else '<'} {border}" if n else "start"
        there = other[len(rows) - n]
        mark = "" if there in cut else " **not cut**"
        back = _step(along, -sign) if n else ""
        lines.append((n, (x, y), f, left, test, back, f"{there}{mark}"))
    head = ("stands behind step", "at", "F", "J left", "F against 2 y - 2 x - 2", "step back",
            "the opposite sense stands at")  # fmt: skip
    return table(head, lines)


# --- the page -------------------------------------------------------------------------------------


def key_table() -> str:
    """Return which function of the panel is locked in which mode."""
    modes = list(Mode)
    rows = [
        [
            f"{key} {digit}",
            function.name,
            " ".join(str(field.digits) for field in function.fields) or "-",
            *("yes" if mode in function.modes else "" for mode in modes),
        ]
        for key, group in FUNCTIONS.items()
        for digit, function in group.items()
    ]
    return table(["keys", "what", "digits", *(str(mode) for mode in modes)], rows)


def error_table() -> str:
    """Return the numbers of the panel's errors."""
    return table(["digits", "error"], [[f"E   {n:02d}", what] for n, what in ERRORS.items()])


#: Name of a part of the page -> what writes it.
PARTS: dict[str, Callable[[], str]] = {
    "rules": rules_table,
    "line": line_table,
    "arc": lambda: arc_table(ARC),
    "arc-beside-axis": lambda: arc_table(BESIDE),
    "tie": tie_table,
    "octants": octant_table,
    "circles": circle_table,
    "repair": repair_table,
    "angles": angle_table,
    "back": back_table,
    "keys": key_table,
    "errors": error_table,
}

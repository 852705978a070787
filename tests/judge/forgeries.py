"""Forgeries: mutants of golden programs, and what has to become of each.

A mutant is known by how far its step path is from the golden one (`judge.difference`, held against
a plain step-by-step comparison in the tests): the same steps in other blocks, at most 2 um away, or
beyond. Those beyond must be refused, in strict order and in `verify --against`, and the block named
where the forgery is in one block.

Two um is not a line between good and bad: the golden path may itself be up to 2 um from the exact
one, so a mutant within 2 um of it may well be right. But every mutant that leaves a contour open is
refused, however little it moved.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from same_steps import same_steps

from wedmcam import api
from wedmcam.controllers.pointwise import LineTable, Pointwise
from wedmcam.diag import Severity
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge.difference import difference
from wedmcam.judge.judge import judge
from wedmcam.judge.walk import walk

GOLDEN = Path(__file__).parents[1] / "golden"
SAMPLES = Path(__file__).parents[2] / "samples"

#: Golden programs, and what they were compiled with.
PROGRAMS = {
    "key-punch.3b": {},
    "key-punch.zd": {},
    "key-punch.die.3b": {"side": "die", "corner": 0.15, "ignore_layers": ["START"]},
    "bracket-inch.3b": {},
    "bracket-inch.zd": {},
    "plate.3b": {},
    "plate.zd": {},
    "gear-24.3b": {},
    "gear-24.zd": {},
    "stator-36.3b": {},
    "stator-36.zd": {},
}

#: How far a forgery has to be off to have to be refused, um.
FAR = 2.0

SORTS = (
    "sense swapped",
    "J +1",
    "J -1",
    "J +5",
    "J -5",
    "block dropped",
    "block doubled",
    "block moved on",
    "G flipped",
    "x quadrant changed",
    "y quadrant changed",
    "vertex moved 3 um",
    "mirrored arc",
    "line in two",
    "ratio doubled",
)


@dataclass(frozen=True, eq=False)
class Golden:
    """A golden program with its plan."""

    name: str
    program: Program
    plan: object
    stepping: Pointwise
    limits: object


@dataclass(frozen=True, eq=False)
class Mutant:
    """A forged program.

    ``row`` is the block that was forged (0-based, of the mutant); None where that is no one block.
    ``last`` is the last block by which it must have been noticed.
    """

    sort: str
    program: Program
    row: int | None
    last: int


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of a mutant."""

    mutant: Mutant
    apart_um: float
    same: bool
    refused: bool
    named: bool
    codes: frozenset[str]


def golden(name: str) -> Golden:
    """Read a golden program, and plan its sample anew."""
    drawing = SAMPLES / f"{name.split('.')[0]}.dxf"
    to = "compact" if name.endswith(".zd") else "3b"
    made = api.compile(drawing, to=to, offset=0.1, **PROGRAMS[name])
    assert made.ok
    program, machine, _ = api.read_program(GOLDEN / name)
    assert program is not None
    program = replace(program, origin=made.program.origin)
    return Golden(name, program, made.plan, machine.own_stepping, machine.limits)


def mutants(g: Golden, rows: np.ndarray | None = None) -> Iterator[Mutant]:
    """Yield all forgeries of single blocks ``rows`` (0-based; None for all)."""
    blocks = g.program.blocks
    kind = blocks["kind"]
    cutting = np.flatnonzero(kind <= Kind.ARC)
    way = walk(g.program, g.stepping)
    for row in cutting if rows is None else np.intersect1d(cutting, rows):
        r = int(row)
        for sort in SORTS:
            made = _mutant(sort, g, way, r)
            if made is not None:
                yield made


def _mutant(sort: str, g: Golden, way: object, r: int) -> Mutant | None:
    b = g.program.blocks
    is_arc = b["kind"][r] == Kind.ARC
    new = b.copy()
    last = r
    if sort == "sense swapped":
        if not is_arc:
            return None
        new["turn"][r] = -new["turn"][r]
    elif sort.startswith("J"):
        new["count"][r] += int(sort[2:])
        if new["count"][r] <= 0:
            return None
    elif sort == "block dropped":
        new = np.delete(new, r)
    elif sort == "block doubled":
        new = np.insert(new, r, b[r])
        last = r + 1
    elif sort == "block moved on":
        if r + 1 >= len(b) or b["kind"][r + 1] > Kind.ARC:
            return None
        new[[r, r + 1]] = b[[r + 1, r]]
        last = r + 1
    elif sort == "G flipped":
        if b["axis"][r] == Axis.SQUARE:
            return None
        new["axis"][r] = 1 - new["axis"][r]
    elif sort in ("x quadrant changed", "y quadrant changed"):
        if new[sort[0]][r] == 0:
            return None
        new[sort[0]][r] *= -1
    elif sort == "vertex moved 3 um":
        if is_arc or r + 1 >= len(b) or b["kind"][r + 1] > Kind.ARC:
            return None
        # The end of a line, 3 um to its left; a line behind it ends where it did, an arc follows.
        dx, dy = (int(v) for v in way.end[r] - way.start[r])
        ex, ey = (int(v) for v in way.end[r + 1] - way.start[r + 1])
        mx, my = (0, 3 if dx > 0 else -3) if abs(dx) >= abs(dy) else (-3 if dy > 0 else 3, 0)
        for row, x, y in ((r, dx + mx, dy + my), (r + 1, ex - mx, ey - my)):
            if b["kind"][row] == Kind.LINE and not _set_line(new, row, x, y, g.stepping):
                return None
        last = r + 1
    elif sort == "mirrored arc":
        if not is_arc:
            return None
        # In its chord: the same ends, the other sense, the centre on the other side.
        start, end = way.start[r].astype(float), way.end[r].astype(float)
        chord = end - start
        if not chord.any():
            return None
        centre = start - (float(b["x"][r]), float(b["y"][r]))
        foot = start + chord * np.dot(centre - start, chord) / np.dot(chord, chord)
        x, y = np.round(start - (2 * foot - centre)).astype(int)
        if x * x + y * y < 2:
            return None
        new["x"][r], new["y"][r], new["turn"][r] = x, y, -b["turn"][r]
    elif sort == "line in two":
        if is_arc or (b["x"][r] and b["y"][r]) or b["count"][r] < 2 or b["kind"][r] != Kind.LINE:
            return None
        new = np.insert(new, r, b[r])
        half = int(b["count"][r]) // 2
        for row, count in ((r, half), (r + 1, int(b["count"][r]) - half)):
            new["x"][row], new["y"][row] = np.sign(b["x"][r]) * count, np.sign(b["y"][r]) * count
            new["count"][row] = count
        last = r + 1
    elif sort == "ratio doubled":
        if is_arc or max(abs(b["x"][r]), abs(b["y"][r])) > 499_999:
            return None
        new["x"][r], new["y"][r] = 2 * b["x"][r], 2 * b["y"][r]
    else:
        raise AssertionError(sort)
    spans = ()  # blocks are named by number
    return Mutant(sort, replace(g.program, blocks=new, spans=spans), r, last)


def _set_line(blocks: np.ndarray, row: int, x: int, y: int, stepping: Pointwise) -> bool:
    if abs(x) + abs(y) == 0:
        return False
    axis = Axis.X if abs(x) > abs(y) else Axis.Y
    if abs(x) == abs(y) and stepping.table == LineTable.ROTATE and x * y < 0:
        axis = Axis.X
    blocks["x"][row], blocks["y"][row] = x, y
    blocks["count"][row], blocks["axis"][row] = max(abs(x), abs(y)), axis
    return True


def of_the_whole(g: Golden) -> Iterator[Mutant]:
    """Yield forgeries that are not of one block: the wrong side, a diameter, a hole not cut."""
    stem = g.name.split(".")[0]
    to = "compact" if g.name.endswith(".zd") else "3b"
    asked = {"offset": 0.1, **PROGRAMS[g.name]}
    drawing = SAMPLES / f"{stem}.dxf"
    other = "part" if asked.get("side") == "die" else "die"
    for sort, change in (
        ("wrong side", {"side": other}),
        ("wire diameter for radius", {"offset": 0.2}),
        ("offset forgotten", {"offset": 0.001}),
    ):
        forged = {**asked, **change}
        if "corner" in forged:  # no rounding below the offset
            forged["corner"] = max(forged["corner"], forged["offset"])
        made = api.compile(drawing, to=to, **forged)
        if made.ok:
            yield Mutant(sort, replace(made.program, spans=()), None, 0)
    # Each cut left out: its blocks between controls and moves, the wire moved on to the next.
    b = g.program.blocks
    way = walk(g.program, g.stepping)
    group = np.cumsum(b["kind"] == Kind.MOVE)
    if group[-1] == 0:
        return
    for k in range(int(group[-1]) + 1):
        rows = np.flatnonzero((group == k) & (b["kind"] <= Kind.ARC))
        if len(rows) and (way.start[rows[0]] == way.end[rows[-1]]).all():
            forged = replace(g.program, blocks=np.delete(b, rows), spans=())
            yield Mutant("contour not cut", forged, None, 0)


def judged(g: Golden, mutant: Mutant) -> Outcome:
    """Judge a mutant in strict order."""
    apart = distance(g, mutant)
    verdict, found = judge(mutant.program, g.plan, stepping=g.stepping, limits=g.limits)
    errors = [d for d in found if d.severity is Severity.ERROR]
    texts = " | ".join(d.message for d in errors)
    numbers = [int(n) for n in re.findall(r"blocks? (\d+)", texts)]
    # The block itself (1-based: row + 1), one beside it, or the last that was touched.
    named = mutant.row is None or any(mutant.row <= n <= mutant.last + 2 for n in numbers)
    return Outcome(
        mutant,
        apart,
        apart <= FAR and same_steps(g.program, mutant.program, g.stepping),
        not verdict.ok,
        named,
        frozenset(d.code for d in errors),
    )


def distance(g: Golden, mutant: Mutant) -> float:
    """Return how far the mutant's path leaves the golden one, um; inf where it ends or never does.

    Only whether it is over `FAR` is exact above it: the comparison stops there.
    """
    d = difference(g.program, mutant.program, g.stepping, g.stepping, FAR)
    return d.largest_um if d.equal else max(d.distance_um, np.nextafter(FAR, 9.0))

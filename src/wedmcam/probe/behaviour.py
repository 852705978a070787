"""What kinds of controllers there are, and where each of them waits in the probe.

Lines and arcs are run by our own models of controllers: the step loop's closed forms with both line
tables, and ends recomputed from J and G. The rest is what shops report of old machines.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Literal, NamedTuple, get_args

import numpy as np

from wedmcam.controllers.pointwise import of_table
from wedmcam.controllers.pointwise.nominal import nominal_end
from wedmcam.ir.program import Kind
from wedmcam.probe.records import PARTS, Record

#: How lines end: stepped by a table until J is counted, or at the X and Y that are stated.
Table = Literal["mirror", "rotate", "stated"]
#: How arcs end: J steps counted on G; on the axis that the controller chooses; where J and G say.
Arcs = Literal["counted", "own axis", "recomputed"]
#: What a record with X = Y = 0 is.
Zeros = Literal["run", "deleted", "refused"]
#: What a record with a blank field is.
Blanks = Literal["taken", "deleted", "refused"]
#: What a control word does: the machine waits and goes on when told to; ends; or runs past it.
Word = Literal["waits", "ends", "nothing"]


@dataclass(frozen=True, slots=True)
class Behaviour:
    """One kind of controller. The default is what the default profile of 3B supposes."""

    table: Table = "rotate"
    arcs: Arcs = "counted"
    zeros: Zeros = "run"
    blanks: Blanks = "taken"
    pause: Word = "waits"
    stop: Word = "ends"
    end: Word = "ends"


#: What the answers of each program depend on.
ASKED: dict[str, tuple[str, ...]] = {
    "main": ("table", "arcs", "pause", "stop"),
    "zeros": ("zeros",),
    "blanks": ("blanks", "zeros"),
    "end": ("end",),
}
_VALUES: dict[str, tuple[str, ...]] = {
    "table": get_args(Table),
    "arcs": get_args(Arcs),
    "zeros": get_args(Zeros),
    "blanks": get_args(Blanks),
    "pause": ("waits",),
    "stop": get_args(Word),
    "end": get_args(Word),
}


def behaviours(pauses: bool = True) -> Iterator[Behaviour]:
    """Yield all kinds of controllers that wait at the pause word, or (``pauses`` off) do not.

    A controller that ends lines where X and Y say has nowhere to go with X = Y = 0: to it such a
    record is deleted or refused. One that does not wait at the pause word answers nothing else.
    """
    if not pauses:
        yield from (Behaviour(pause="ends"), Behaviour(pause="nothing"))
        return
    for values in product(*_VALUES.values()):
        behaviour = Behaviour(**dict(zip(_VALUES, values, strict=True)))  # type: ignore[arg-type]
        if not (behaviour.table == "stated" and behaviour.zeros == "run"):
            yield behaviour


class Stop(NamedTuple):
    """Where the machine stands still, steps from where the program started, and why.

    Attributes:
        section: the last one that was begun.
        x: as the display counts.
        y: likewise.
        alarm: it refuses to go on.
    """

    section: str
    x: int
    y: int
    alarm: bool = False


def stops(part: str, controller: Behaviour) -> tuple[Stop, ...]:
    """Return where a controller waits in a program, until telling it to go on does nothing.

    >>> [(s.x, s.y) for s in stops("end", Behaviour(end="nothing"))]
    [(500, 500)]
    """
    x = y = 0
    out: list[Stop] = []
    name = ""
    for section in PARTS[part]:
        name = section.name
        for step in section.steps:
            if isinstance(step, Record):
                way = _way(step, controller)
                if way is None:
                    return (*out, Stop(name, x, y, alarm=True))
                x, y = x + way[0], y + way[1]
                continue
            does = getattr(controller, step)
            if does != "nothing" and (not out or out[-1] != Stop(name, x, y)):
                out.append(Stop(name, x, y))
            if does == "ends":
                return tuple(out)
    if not out or out[-1][1:3] != (x, y):
        out.append(Stop(name, x, y))  # there is no more program
    return tuple(out)


def _way(record: Record, c: Behaviour) -> tuple[int, int] | None:
    """Return how far a record moves the machine; None where it is refused."""
    manner = "run"
    if None in (record.x, record.y):
        manner = c.blanks
    if manner in ("run", "taken") and not (record.x or record.y):
        manner = c.zeros
    if manner in ("deleted", "refused"):
        return None if manner == "refused" else (0, 0)
    return _ran(record, c.table, c.arcs)


@cache
def _ran(record: Record, table: Table, arcs: Arcs) -> tuple[int, int]:
    block = np.array([record.block])
    x, y = int(block["x"][0]), int(block["y"][0])
    if block["kind"][0] == Kind.LINE and table == "stated":
        return x, y
    if block["kind"][0] == Kind.ARC and arcs == "recomputed":
        fields = (block[name] for name in ("x", "y", "turn", "axis", "count"))
        ex, ey = nominal_end(*fields)
        return int(ex[0]) - x, int(ey[0]) - y
    if block["kind"][0] == Kind.ARC and arcs == "own axis":
        # By the end, which is the start of a whole circle: nearer the x axis on y.
        block["axis"] = 1 if abs(x) > abs(y) else 0
    moved = of_table("mirror" if table == "stated" else table).run(block)
    return int(moved.dx[0]), int(moved.dy[0])

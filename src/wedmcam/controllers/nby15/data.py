"""What a tape of the NBY-15 says, and the lines that its controller makes of it.

Each degree of an arc is one straight move, so a program that is run is lines alone; `TapeProgram`
keeps the blocks of the tape beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.nby15.base_circle import HALF, RADIUS, movements, steps_of
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK, Kind, Program

Ints = NDArray[np.int64]

#: One row a block of the tape. kind: `Kind`: LINE and MOVE go (x, y), um, signed; ARC turns from
#: the whole degree ``start`` (0 to 359, of the place on the circle, seen from its centre) over
#: ``degrees`` of them about a radius, um. role, source, cut: as in `BLOCK`.
TAPE = np.dtype(
    [
        ("kind", "u1"),
        ("turn", "i1"),
        ("role", "u1"),
        ("x", "i8"),
        ("y", "i8"),
        ("radius", "i8"),
        ("start", "i8"),
        ("degrees", "i8"),
        ("source", "i4"),
        ("cut", "i4"),
    ]
)

#: A radius has six digits [R]: what is below 0 comes out of the adder as a huge one.
WRAP_UM = 1_000_000
#: Positions of the scale switch [R]: the source says several steps.
SCALES = (1, 2, 5, 10)


@dataclass(frozen=True, slots=True)
class Switches:
    """What is set at the back and at the front of the controller.

    Attributes:
        correct_um: the radius corrector, -999 to 999 um [S]; above 0 the path moves to the right
            of its direction [R]: arcs that turn counter-clockwise grow.
        scale: all lengths times this; one of `SCALES`.
        mirror_x, mirror_y: the axis runs the other way [S].
    """

    correct_um: int = 0
    scale: int = 1
    mirror_x: bool = False
    mirror_y: bool = False

    @property
    def plain(self) -> bool:
        """Whether none is set."""
        return self == Switches()


@dataclass(frozen=True, slots=True, eq=False)
class TapeProgram(Program):
    """A program with the tape that it was made of.

    Attributes:
        tape: dtype `TAPE`.
        of: for each block, the row of the tape.
    """

    tape: NDArray[np.void] = None  # type: ignore[assignment]
    of: Ints = None  # type: ignore[assignment]


def radii(tape: NDArray[np.void], switches: Switches = Switches()) -> Ints:
    """Return the radius that each arc is turned about, um: corrected, wrapped, scaled."""
    corrected = tape["radius"] + tape["turn"].astype(np.int64) * switches.correct_um
    return np.where(tape["kind"] == Kind.ARC, np.mod(corrected, WRAP_UM), 0) * switches.scale


def lines_of(
    tape: NDArray[np.void],
    switches: Switches = Switches(),
) -> tuple[NDArray[np.void], Ints]:
    """Return the lines that the controller makes of a tape, and the row of the tape of each.

    Degrees in which the machine does not move make no line.

    Returns:
        dtype `BLOCK`, the controls among them.

    >>> tape = np.zeros(1, TAPE)
    >>> tape[0] = (Kind.ARC, 1, 0, 0, 0, 10_000, 0, 2, -1, 0)
    >>> lines_of(tape)[0][["x", "y"]].tolist()
    [(-2, 175), (-4, 174)]
    """
    arc = tape["kind"] == Kind.ARC
    many = np.where(arc, tape["degrees"], 1)
    of = np.repeat(np.arange(len(tape)), many)
    number = np.arange(len(of)) - np.repeat(np.cumsum(many) - many, many)
    t, on_arc = tape[of], arc[of]
    turn = t["turn"].astype(np.int64)
    degree = movements(t["start"] + turn * number, np.where(turn == 0, 1, turn))
    # A line adds whole um and leaves the residues as they are.
    whole = np.column_stack([t["x"], t["y"]]) * switches.scale * RADIUS
    way = np.where(on_arc[:, None], degree * radii(tape, switches)[of][:, None], whole)
    moving = t["kind"] <= Kind.MOVE
    way[~moving] = 0
    steps, _ = steps_of(way, np.array([HALF, HALF]))
    steps *= np.array([-1 if switches.mirror_x else 1, -1 if switches.mirror_y else 1])
    blocks = np.zeros(len(of), BLOCK)
    blocks["kind"] = np.where(on_arc, int(Kind.LINE), t["kind"])
    blocks["x"], blocks["y"] = steps[:, 0], steps[:, 1]
    axis, count = MIRROR.line_count(steps[:, 0], steps[:, 1])
    blocks["axis"], blocks["count"] = np.where(moving, axis, 0), np.where(moving, count, 0)
    for name in ("role", "source", "cut"):
        blocks[name] = t[name]
    kept = ~moving | (steps != 0).any(axis=1)
    return blocks[kept], of[kept]


def program_of(
    tape: NDArray[np.void],
    origin: tuple[int, int] = (0, 0),
    sources: tuple[Any, ...] = (),
    spans: Sequence[Any] = (),
    switches: Switches = Switches(),
) -> TapeProgram:
    """Return the program that a tape is, with the tape.

    Args:
        tape: dtype `TAPE`.
        origin: where the first block starts.
        sources: that the tape cites.
        spans: where each block of the tape stands; empty for nowhere.
        switches: as set at the controller.
    """
    blocks, of = lines_of(tape, switches)
    here = [spans[i] for i in of.tolist()] if len(spans) else ()
    return TapeProgram(blocks, origin, sources, here, (), 1.0, tape, of)

"""The steps of a program in the order of its path: what a simulated controller goes along.

A step has a number: step k leads to place k, and place 0 is the start. All a controller knows at a
place (block, F, J) follows from its number, so going back along the path is counting down. The
controller of the machine has no such table: it undoes steps (`controllers.pointwise.back`); tests
prove both equal.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.ir.program import Axis, Kind, Program

Ints = NDArray[np.int64]

#: Blocks behind which nothing is run.
_ENDS = (Kind.STOP, Kind.END)


class Halt(NamedTuple):
    """A place on the path at which the machine stops.

    Attributes:
        step: number of the place.
        block: of the program, 1-based.
        kind: pause, thread-point; no-tape: from this block on nothing is read.
    """

    step: int
    block: int
    kind: str

    @property
    def thread(self) -> bool:
        """Whether a wire is threaded there."""
        return self.kind == "thread-point"


class Reading(NamedTuple):
    """What the controller holds and shows at a place.

    Attributes:
        block: of the program as it is written, 1-based: that of the last step; at the start, of the
            first block that steps.
        x, y: steps, from the start of a line, from the centre of an arc.
        f: the deviation F.
        j: the count that is left.
    """

    block: int
    x: int
    y: int
    f: int
    j: int


@dataclass(frozen=True, eq=False)
class Route:
    """Every step of a program.

    Attributes:
        program: what the interpolator runs, up to its end: blocks behind a stop are never run.
        place: of the steps 0 to n, shape (n + 1, 2), steps from the start of the program.
        first: of each block, the number of the place at which it begins.
        axis: of the steps 1 to n, `Axis`; entry k - 1 is step k.
        sign: likewise, +1 or -1.
        halts: pauses and thread points, in their order.
        records: of each block that is run, which block of the program as it is written it was
            made of, from 0, ascending: a block of a tape is many lines. People see these.
        blocks: how many blocks of the program as it is written are run; the next one ends it.
        by_steps: J counts the steps that are left of a block, whatever its count says.
        seconds: of the steps 1 to n, how long each takes where the program says so, s.
    """

    program: Program
    place: Ints
    first: Ints
    axis: NDArray[np.uint8]
    sign: NDArray[np.int8]
    halts: tuple[Halt, ...]
    records: Ints
    blocks: int
    by_steps: bool = False
    seconds: NDArray[np.float64] | None = None

    @property
    def step_um(self) -> int:
        """How far a step goes, um."""
        return int(self.program.step_um)

    @property
    def steps(self) -> int:
        """How many steps the program makes, moves included."""
        return len(self.axis)

    @cached_property
    def lengths(self) -> Ints:
        """How many steps each block makes."""
        return np.diff(self.first, append=self.steps)

    @cached_property
    def digest(self) -> str:
        """What tells one program from another: of the blocks that are run, whatever the file."""
        sha = hashlib.sha256()
        for name in ("kind", "turn", "axis", "x", "y", "count"):
            sha.update(self.program.blocks[name].tobytes())
        return sha.hexdigest()

    @cached_property
    def threads(self) -> Ints:
        """Places of thread points, ascending; the start counts as one [R]."""
        return np.array([0, *(h.step for h in self.halts if h.thread)], dtype=np.int64)

    @cached_property
    def moves(self) -> NDArray[np.bool_]:
        """Of the steps 1 to n: whether the generator is off."""
        return np.repeat(self.program.blocks["kind"] == Kind.MOVE, self.lengths)

    @cached_property
    def switches(self) -> list[int]:
        """Places at which the generator is switched on or off, and the end; ascending."""
        return [*(1 + np.flatnonzero(np.diff(self.moves))).tolist(), self.steps]

    @cached_property
    def counted(self) -> Ints:
        """How many steps up to each place counted towards the J of their blocks."""
        blocks, lengths = self.program.blocks, self.lengths
        x, y = self._relative(np.arange(self.steps), np.repeat(np.arange(len(blocks)), lengths))
        on_y = np.repeat(blocks["axis"] == Axis.Y, lengths)
        square = np.repeat(blocks["axis"] == Axis.SQUARE, lengths)
        on_y = np.where(square, abs(x) >= abs(y), on_y)
        out = np.zeros(self.steps + 1, np.int64)
        np.cumsum((self.axis == Axis.Y) == on_y, out=out[1:])
        return out

    def _relative(self, steps: Ints, rows: Ints) -> tuple[Ints, Ints]:
        """Return places within blocks: from the start of a line, from the centre of an arc."""
        blocks = self.program.blocks[rows]
        way = self.place[steps] - self.place[self.first[rows]]
        arc = blocks["kind"] == Kind.ARC
        return (
            way[:, 0] + np.where(arc, blocks["x"], 0),
            way[:, 1] + np.where(arc, blocks["y"], 0),
        )

    def rows(self, steps: Ints) -> Ints:
        """Return the rows of the blocks that the controller is in at places.

        At the end of a block it is still in that one, with J = 0.
        """
        stepping = np.flatnonzero(self.lengths > 0)
        at = np.searchsorted(self.first[stepping], steps, side="left") - 1
        return stepping[np.maximum(at, 0)]

    def readings(self, steps: Ints) -> tuple[Ints, Ints, Ints, Ints, Ints]:
        """Return block (1-based), x, y, F and J at places; see `Reading`."""
        rows = self.rows(steps)
        blocks = self.program.blocks[rows]
        x, y = self._relative(steps, rows)
        arc = blocks["kind"] == Kind.ARC
        along, up = abs(blocks["x"]), abs(blocks["y"])
        of_line = np.where((along > 0) & (up > 0), along * abs(y) - up * abs(x), 0)
        of_arc = x * x + y * y - blocks["x"] ** 2 - blocks["y"] ** 2
        if self.by_steps:
            j = self.lengths[rows] - (steps - self.first[rows])
        else:
            j = blocks["count"] - (self.counted[steps] - self.counted[self.first[rows]])
        return self.records[rows] + 1, x, y, np.where(arc, of_arc, of_line), j

    def reading(self, step: int) -> Reading:
        """Return what the controller holds at one place."""
        return Reading(*(int(column[0]) for column in self.readings(np.array([step]))))

    def unread(self, step: int, ahead: int) -> Halt | None:
        """Return where the machine stops if from a place on no more of the program is read.

        Args:
            step: number of the place; at the end of a block the next one is in work already.
            ahead: how many blocks, as written, are read ahead of the one in work; the one that
                ends the program is one of them.

        Returns:
            None where the rest was read already.
        """
        if step == self.steps:
            return None
        row = int(self.rows(np.array([step + 1]))[0])
        first = int(self.records[row]) + ahead + 1
        return None if first > self.blocks else self.no_tape(first + 1)

    def no_tape(self, block: int) -> Halt:
        """Return where the machine stops if nothing is read from a block, 1-based, on."""
        return Halt(self.start_of(block), block, "no-tape")

    def start_of(self, block: int) -> int:
        """Return the number of the place at which a block of the program, 1-based, begins."""
        row = int(np.searchsorted(self.records, block - 1, side="left"))
        return self.steps if row == len(self.first) else int(self.first[row])


def lay(program: Program, stepping: Stepping, records: Ints | None = None) -> Route:
    """Return the route of a program: all its steps up to its end.

    Args:
        program: in the frame of the controller. A pause behind a move is a thread point, as the
            readers of the compact format say.
        stepping: of the controller.
        records: of each block, which one as written it was made of, from 0; None where these are
            those that are written.
    """
    kinds = program.blocks["kind"]
    ends = np.flatnonzero(np.isin(kinds, _ENDS))
    blocks = program.blocks[: int(ends[0])] if len(ends) else program.blocks
    place, first = stepping.trace(blocks)
    step = np.diff(place, axis=0)
    axis = (step[:, 0] == 0).astype(np.uint8)
    kinds = blocks["kind"]
    behind_move = np.concatenate([[False], kinds[:-1] == Kind.MOVE])
    thread = (kinds == Kind.THREAD) | ((kinds == Kind.PAUSE) & behind_move)
    rows = np.flatnonzero(thread | (kinds == Kind.PAUSE))
    kinds_of = {True: "thread-point", False: "pause"}
    every = np.arange(len(program.blocks)) if records is None else records
    records = every[: len(blocks)]
    last = int(every[-1]) + 1 if len(every) else 0
    halts = tuple(
        Halt(int(first[i]), int(records[i]) + 1, kinds_of[bool(thread[i])]) for i in rows.tolist()
    )
    whole = Program(
        blocks.copy(),
        program.origin,
        program.sources,
        program.spans[: len(blocks)],
        step_um=program.step_um,
    )
    sign = step.sum(axis=1).astype(np.int8)
    run = int(every[ends[0]]) if len(ends) else last
    return Route(whole, place, first, axis, sign, halts, records, run)

"""What the controller steps for vectors: POSCAL, a timer for each axis, POSITI.

The main program has POSCAL compute a speed of each axis, and the interrupts of two timers make the
steps: an axis of speed v steps at the times 1/v, 2/v, ... The end of a vector is not in the source.
Rulings: an axis stops at its target; POSCAL then runs again for the rest, at which the other axis
goes on alone (or begins, where its speed was 0). Where both timers are due, x steps first: its
interrupt is the higher one.

A vector is a block LINE or MOVE: x and y in steps, the cutting speed (1 to 127) in ``count``. There
are no arcs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from wedmcam.controllers.eindhoven import arithmetic
from wedmcam.controllers.eindhoven.arithmetic import FASTEST, SPEED_UM_PER_S, Speeds
from wedmcam.controllers.stepping import (
    ArcEnd,
    Blocks,
    Bools,
    Floats,
    Ints,
    Motion,
    Step,
    Stepping,
)
from wedmcam.ir.program import Axis, Kind

#: A step of either axis, um.
STEP_UM = 2
#: Places computed at a time: few enough for the cache.
CHUNK = 1 << 16
#: How directions are computed -> the routine; what a position counts -> its units in a step.
DIRECTIONS = {"root": arithmetic.poscal, "sines": arithmetic.sine_speeds}
POSITIONS = {"um": STEP_UM, "steps": 1}


@dataclass(frozen=True, slots=True)
class Vectors:
    """The controller as a `Stepping`; ``f`` of a step is |dx| j - |dy| i, of i and j steps made.

    Attributes:
        direction: a key of `DIRECTIONS`.
        positions: a key of `POSITIONS`: what POSCAL sees of a vector.
        y_first: y steps first where both timers are due: how it looks with x and y exchanged.
        speed: of lines that are made for it (`line_count`).

    >>> from wedmcam.ir.program import BLOCK
    >>> b = np.zeros(1, BLOCK)
    >>> b["x"], b["y"], b["count"] = 2, 1, 127
    >>> Vectors().trace(b)[0].tolist()
    [[0, 0], [1, 0], [2, 0], [2, 1]]
    """

    direction: str = "root"
    positions: str = "um"
    y_first: bool = False
    speed: int = FASTEST

    @property
    def steady(self) -> bool:
        """Each axis has one sign in a vector."""
        return True

    def speeds(self, blocks: Blocks) -> Speeds:
        """Return the speeds of both axes at the start of each block (POSCAL)."""
        per_step = POSITIONS[self.positions]
        moving = blocks["kind"] <= Kind.MOVE
        x, y = (np.where(moving, blocks[name] * per_step, 0) for name in ("x", "y"))
        return DIRECTIONS[self.direction](x, y, blocks["count"])

    def run(self, blocks: Blocks) -> Motion:
        """Return the ways of blocks: a vector ends on its target."""
        moving = blocks["kind"] <= Kind.MOVE
        dx, dy = np.where(moving, blocks["x"], 0), np.where(moving, blocks["y"], 0)
        steps = np.abs(dx) + np.abs(dy)
        stuck = moving & ((steps == 0) | (blocks["count"] < 1) | (blocks["kind"] == Kind.ARC))
        still = stuck | ~moving
        return Motion(
            np.where(still, 0, dx),
            np.where(still, 0, dy),
            np.where(stuck, -1, np.where(moving, steps, 0)),
        )

    def position(self, blocks: Blocks, n: Ints) -> tuple[Ints, Ints]:
        """See `Stepping`; closed: steps of both axes are sorted by their times."""
        moves = self.run(blocks)
        n = np.clip(n, 0, np.maximum(moves.steps, 0))
        speeds = self.speeds(blocks)
        i, j = self._made(n, np.abs(moves.dx), np.abs(moves.dy), speeds.x, speeds.y)
        return i * np.sign(moves.dx), j * np.sign(moves.dy)

    def _made(self, n: Ints, a: Ints, b: Ints, p: Ints, q: Ints) -> tuple[Ints, Ints]:
        """Return how many of the first ``n`` steps are x's and y's, of ``a`` and ``b`` in all.

        Step k of x is due at k / p, step j of y at j / q. The one of x stands in front of those of
        y that are due with it or later, so k is among the first n if k q / p <= n + 1 - k, or if
        all b of y are. An axis of speed 0 steps when the other one has arrived.
        """
        if self.y_first:
            a, b, p, q = b, a, q, p
        i = np.maximum((n + 1) * p // np.maximum(p + q, 1), n - b)
        i = np.minimum(np.minimum(i, n), a)
        return (n - i, i) if self.y_first else (i, n - i)

    def _ways(self, blocks: Blocks, moves: Motion, low: int, high: int) -> tuple[Ints, Ints, Ints]:
        """Return block, x and y of the places low to high - 1 of all blocks, from their starts."""
        steps = np.maximum(moves.steps, 0)
        last = np.cumsum(steps)
        first = last - steps
        rows = np.flatnonzero((last > low) & (first < high) & (steps > 0))
        begin = np.maximum(low - first[rows], 0)
        count = np.minimum(high, last[rows]) - np.maximum(low, first[rows])
        block = np.repeat(rows, count)
        n = np.arange(len(block)) - np.repeat(np.cumsum(count) - count - begin, count) + 1
        speeds = self.speeds(blocks[rows])
        dx, dy = moves.dx[rows], moves.dy[rows]
        i, j = self._made(
            n, *(np.repeat(v, count) for v in (np.abs(dx), np.abs(dy), speeds.x, speeds.y))
        )
        return block, i * np.repeat(np.sign(dx), count), j * np.repeat(np.sign(dy), count)

    def places(
        self,
        blocks: Blocks,
        moves: Motion,
        x: Floats,
        y: Floats,
        window: tuple[int, int] | None = None,
    ) -> tuple[Floats, Floats]:
        """See `Stepping`."""
        total = int(np.maximum(moves.steps, 0).sum())
        low, high = (0, total) if window is None else (window[0], min(window[1], total))
        out_x, out_y = np.empty(max(high - low, 0)), np.empty(max(high - low, 0))
        for at in range(low, high, CHUNK):
            end = min(at + CHUNK, high)
            block, i, j = self._ways(blocks, moves, at, end)
            out_x[at - low : end - low] = x[block] + i
            out_y[at - low : end - low] = y[block] + j
        return out_x, out_y

    def trace(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """See `Stepping`."""
        moves = self.run(blocks)
        x, y = np.cumsum(moves.dx) - moves.dx, np.cumsum(moves.dy) - moves.dy
        at = np.column_stack(self.places(blocks, moves, x.astype(float), y.astype(float)))
        steps = np.maximum(moves.steps, 0)
        return np.vstack([[[0, 0]], at.astype(np.int64)]), np.cumsum(steps) - steps

    def steps(self, block: np.void) -> Iterator[Step]:
        """Yield the steps of one block as the controller makes them, timer by timer.

        Raises:
            ValueError: it would never end: no way, no speed, or an arc.
        """
        from fractions import Fraction

        if block["kind"] > Kind.MOVE:
            return
        target = int(block["x"]), int(block["y"])
        if block["kind"] == Kind.ARC or target == (0, 0) or block["count"] < 1:
            raise ValueError("the block never ends")
        at, order = [0, 0], (1, 0) if self.y_first else (0, 1)
        clock = Fraction(0)
        rest = block.copy()
        while at != list(target):
            rest["x"], rest["y"] = target[0] - at[0], target[1] - at[1]
            speeds = self.speeds(np.array([rest]))
            period = [Fraction(1, int(v[0])) if v[0] else None for v in speeds[:2]]
            due = [None if p is None else clock + p for p in period]
            arrived = False
            while not arrived:
                clock, axis = min((t, order.index(k)) for k, t in enumerate(due) if t is not None)
                axis = order[axis]
                sign = 1 if target[axis] > at[axis] else -1
                at[axis] += sign  # POSITI
                due[axis] = clock + (period[axis] or 0)
                arrived = at[axis] == target[axis]
                f = abs(target[0] * at[1]) - abs(target[1] * at[0])
                yield Step(Axis(axis), sign, f, at[0], at[1])

    def deviation(self, blocks: Blocks) -> tuple[Floats, Floats]:
        """See `Stepping`; every place of vectors that are oblique is looked at."""
        low, high = np.zeros(len(blocks)), np.zeros(len(blocks))
        moves = self.run(blocks)
        rows = np.flatnonzero((moves.dx != 0) & (moves.dy != 0))
        held = Motion(moves.dx[rows], moves.dy[rows], moves.steps[rows])
        total = int(held.steps.sum())
        length = np.hypot(held.dx, held.dy)
        for at in range(0, total, CHUNK):
            block, i, j = self._ways(blocks[rows], held, at, min(at + CHUNK, total))
            beside = held.dx[block] * j - held.dy[block] * i
            head = np.flatnonzero(np.diff(block, prepend=-1))
            of = block[head]
            most, least = (f.reduceat(beside, head) for f in (np.maximum, np.minimum))
            high[rows[of]] = np.maximum(high[rows[of]], most / length[of])
            low[rows[of]] = np.minimum(low[rows[of]], least / length[of])
        return low, high

    def sideways(self, blocks: Blocks) -> Floats:
        """Return how far each vector leads beside its line, steps, without the stair of its steps.

        That is where the first axis arrives, if both ran evenly: the rest is along an axis.
        """
        moves, speeds = self.run(blocks), self.speeds(blocks)
        a, b = np.abs(moves.dx).astype(float), np.abs(moves.dy).astype(float)
        p, q = np.maximum(speeds.x, 1e-9), np.maximum(speeds.y, 1e-9)
        time = np.minimum(a / p, b / q)
        zero = np.where(speeds.x == 0, b, a)  # one axis runs all its way, then the other
        share = np.where(
            (speeds.x == 0) | (speeds.y == 0),
            np.where(speeds.x == 0, a, b) * zero,
            np.abs(a * q - b * p) * time,
        )
        out: Floats = share / np.maximum(np.hypot(a, b), 1.0)
        return out

    def _arrival(self, moves: Motion, speeds: Speeds) -> tuple[Bools, Ints, Floats]:
        """Return whether x arrives first, how many steps the other axis has made then, and when, s.

        A step that is due at the same time is served before POSCAL runs: timers are interrupts.
        """
        a, b = np.abs(moves.dx), np.abs(moves.dy)
        p, q = speeds.x.astype(np.int64), speeds.y.astype(np.int64)
        first_x: Bools = (p > 0) & ((q == 0) | (a * q <= b * p))
        made = np.where(first_x, a * q // np.maximum(p, 1), b * p // np.maximum(q, 1))
        way, speed = np.where(first_x, a, b), np.where(first_x, p, q)
        unit = SPEED_UM_PER_S / STEP_UM / speeds.scale  # steps a second
        return first_x, made, way / (np.maximum(speed, 1) * unit)

    def _alone_s(self, blocks: Blocks) -> Floats:
        """Return how long a step takes of an axis that runs alone, s."""
        out: Floats = STEP_UM / SPEED_UM_PER_S / np.maximum(blocks["count"], 1)
        return out

    def seconds(self, blocks: Blocks) -> Floats:
        """Return how long each block takes: both axes until one arrives, then the other alone."""
        moves, speeds = self.run(blocks), self.speeds(blocks)
        first_x, made, arrives = self._arrival(moves, speeds)
        left = np.abs(np.where(first_x, moves.dy, moves.dx)) - made
        out: Floats = np.where(moves.steps > 0, arrives + left * self._alone_s(blocks), 0.0)
        return out

    def step_seconds(self, blocks: Blocks) -> Floats:
        """Return when each step of each block is made, s from the start of its block.

        Until an axis arrives, step k of an axis of speed v is due at k / v; behind that the other
        one goes on alone with the whole speed.
        """
        moves, speeds = self.run(blocks), self.speeds(blocks)
        first_x, alone, arrives = self._arrival(moves, speeds)
        steps = np.maximum(moves.steps, 0)
        of = np.repeat(np.arange(len(blocks)), steps)
        n = np.arange(len(of)) - np.repeat(np.cumsum(steps) - steps, steps) + 1
        columns = np.abs(moves.dx), np.abs(moves.dy), speeds.x, speeds.y
        ways = [column[of].astype(np.int64) for column in columns]
        i, j = self._made(n, *ways)
        on_x = i > self._made(n - 1, *ways)[0]
        made = np.where(on_x, i, j)
        unit = SPEED_UM_PER_S / STEP_UM / speeds.scale
        own = made / (np.maximum(np.where(on_x, ways[2], ways[3]), 1) * unit)
        late = (on_x != first_x[of]) & (made > alone[of])
        rest = (made - alone[of]) * self._alone_s(blocks)[of]
        out: Floats = np.where(late, arrives[of] + rest, own)
        return out

    def extents(self, blocks: Blocks, steps: Ints, start: Ints, end: Ints) -> Floats:
        """See `Stepping`; no axis goes beyond its ends."""
        every = np.concatenate([start, end]).astype(float)
        return np.concatenate([every.min(axis=0), every.max(axis=0)])

    def reversals(self, blocks: Blocks) -> tuple[Ints, Ints]:
        """No axis steps back in a vector."""
        return np.zeros(len(blocks), np.int64), np.zeros(len(blocks), np.int64)

    def turn_steps(self, radius: Floats) -> Floats:
        """As many as a circle's box has: both axes step its diameter twice."""
        return 8.0 * np.asarray(radius, float)

    def line_count(self, x: Ints, y: Ints) -> tuple[Ints, Ints]:
        """Every vector ends on its target; its count is the speed."""
        return np.zeros(np.shape(x), np.int64), np.full(np.shape(x), self.speed, np.int64)

    def same_lines(self, other: Stepping, x: Ints, y: Ints) -> Bools:
        """Return whether lines are the same: along an axis, or with the same arithmetic."""
        on_axis: Bools = (np.asarray(x) == 0) | (np.asarray(y) == 0)
        mine = (self.direction, self.positions, self.y_first, self.speed)
        alike = isinstance(other, Vectors) and mine == (
            *(other.direction, other.positions, other.y_first, other.speed),
        )
        return on_axis | alike

    def arc_end(
        self,
        x: ArrayLike,
        y: ArrayLike,
        turn: ArrayLike,
        ex: ArrayLike,
        ey: ArrayLike,
        square: Axis = Axis.SQUARE,
    ) -> ArcEnd:
        """No arc lands anywhere."""
        shape = np.broadcast_shapes(*(np.shape(v) for v in (x, y, turn, ex, ey)))
        zero = np.zeros(shape, np.int64)
        no = np.zeros(shape, bool)
        return ArcEnd(no, np.full(shape, -1), zero, zero, zero, zero, no)


@cache
def of_table(table: str) -> Vectors:
    """Return the controller by the name that a profile gives its vectors.

    >>> of_table("root-um"), of_table("sines-steps-exchanged").y_first
    (Vectors(direction='root', positions='um', y_first=False, speed=127), True)
    """
    direction, positions, *exchanged = table.split("-")
    return Vectors(direction, positions, bool(exchanged))

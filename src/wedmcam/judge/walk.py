"""The wire's centre on its way: what the decoded blocks do, from a known place on.

Two machines: one that counts steps (the interpolator, step by step), and one that recomputes the
end of each arc from J and G and then follows the arc (``textbook``). The judge sees only places.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Motion, Stepping
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.segments import Bools, Floats, Ints
from wedmcam.judge.textbook import recomputed_ends


class Walk(NamedTuple):
    """A program run from its origin.

    Attributes:
        blocks: all blocks of the program.
        start: where each block starts, drawing um, shape (n, 2).
        end: where it ends.
        steps: steps of each block, 0 for control records, -1 for a block that never ends.
        textbook: arcs end where J and G say, and are followed as circles.
        sweep: of each arc in ``textbook`` mode, radians; NaN where counted by steps.
        stepping: the interpolator.
    """

    blocks: NDArray[np.void]
    start: Ints
    end: Ints
    steps: Ints
    textbook: bool
    sweep: Floats
    stepping: Stepping

    @property
    def cutting(self) -> Bools:
        """Which blocks step with the generator on."""
        kind = self.blocks["kind"]
        return np.asarray((kind == Kind.LINE) | (kind == Kind.ARC))

    def lengths(self) -> Floats:
        """Return how long each block is along its own line or arc, um, from its ends and steps."""
        d = self.end - self.start
        out: Floats = np.hypot(d[:, 0].astype(float), d[:, 1].astype(float))
        rows = np.flatnonzero((self.blocks["kind"] == Kind.ARC) & (self.steps > 0))
        if len(rows):
            b = self.blocks[rows]
            x, y = b["x"].astype(float), b["y"].astype(float)
            radius = np.hypot(x, y)
            a0, a1 = np.arctan2(y, x), np.arctan2(y + d[rows, 1], x + d[rows, 0])
            angle = np.mod((a1 - a0) * b["turn"], 2.0 * np.pi)
            whole = np.maximum(self.stepping.turn_steps(radius), 1.0)
            guess = 2.0 * np.pi * self.steps[rows] / whole
            turns = np.round((guess - angle) / (2.0 * np.pi))
            angle = np.maximum(angle + 2.0 * np.pi * turns, 0.0)
            stated = self.sweep[rows]
            if self.textbook:
                angle = np.where(np.isnan(stated), angle, stated)
            out[rows] = radius * angle
        return np.asarray(out)

    def places(self, index: Ints, first: int, last: int) -> tuple[Floats, Floats]:
        """Return (x, y) after the steps first to last - 1, from 0, of the blocks ``index``.

        Always stepped places. What is not asked for of a long block costs nothing.
        """
        start, moved = self.start[index], self.end[index] - self.start[index]
        moves = Motion(moved[:, 0], moved[:, 1], self.steps[index])
        x, y = start[:, 0].astype(float), start[:, 1].astype(float)
        return self.stepping.places(self.blocks[index], moves, x, y, (first, last))

    def points(self, index: Ints) -> tuple[Floats, Floats, Ints]:
        """Return (x, y) of every place after a step of the blocks ``index``, and counts a block.

        The start of each block is left out: it is the end of the one before.
        """
        blocks = self.blocks[index]
        if self.textbook:
            return self._textbook_points(index)
        start, moved = self.start[index], self.end[index] - self.start[index]
        moves = Motion(moved[:, 0], moved[:, 1], self.steps[index])
        x, y = self.stepping.places(
            blocks, moves, start[:, 0].astype(float), start[:, 1].astype(float)
        )
        return x, y, np.maximum(self.steps[index], 0)

    def _textbook_points(self, index: Ints) -> tuple[Floats, Floats, Ints]:
        """Points of arcs about 1 um apart on the circle, of all else the stepped places."""
        blocks = self.blocks[index]
        round_ = (blocks["kind"] == Kind.ARC) & ~np.isnan(self.sweep[index])
        radius = np.hypot(blocks["x"].astype(float), blocks["y"].astype(float))
        sweep = np.where(round_, self.sweep[index], 0.0)
        stepped = np.where(round_, 0, np.maximum(self.steps[index], 0))
        count = np.where(round_, np.maximum(np.ceil(radius * sweep), 1), stepped).astype(np.int64)
        first = np.cumsum(count) - count
        x, y = np.empty(int(count.sum())), np.empty(int(count.sum()))
        which = np.flatnonzero(~round_ & (stepped > 0))
        if len(which):
            at, at_first = self.stepping.trace(blocks[which])
            shift = self.start[index[which]] - at[at_first]
            n = stepped[which]
            to = np.repeat(first[which] - (np.cumsum(n) - n), n) + np.arange(n.sum())
            x[to] = at[1:, 0] + np.repeat(shift[:, 0], n)
            y[to] = at[1:, 1] + np.repeat(shift[:, 1], n)
        for k in np.flatnonzero(round_):
            b, total = blocks[k], int(count[k])
            cx, cy = self.start[index[k]] - (int(b["x"]), int(b["y"]))
            part = np.arange(1, total + 1) / total
            angle = np.arctan2(float(b["y"]), float(b["x"])) + b["turn"] * sweep[k] * part
            end = self.end[index[k]]
            r = radius[k] + part * (np.hypot(end[0] - cx, end[1] - cy) - radius[k])
            rows = slice(int(first[k]), int(first[k]) + total)
            x[rows], y[rows] = cx + r * np.cos(angle), cy + r * np.sin(angle)
            x[rows.stop - 1], y[rows.stop - 1] = end
        return x, y, count


def walk(program: Program, stepping: Stepping, *, textbook: bool = False) -> Walk:
    """Run all blocks from ``program.origin``; blocks that never end stand still (steps -1)."""
    blocks = program.blocks
    motion = stepping.run(blocks)
    dx, dy, steps = motion.dx.copy(), motion.dy.copy(), motion.steps.copy()
    sweep = np.full(len(blocks), np.nan)
    if textbook:
        ends = recomputed_ends(blocks)
        arc = (blocks["kind"] == Kind.ARC) & (steps > 0) & ~np.isnan(ends.sweep)
        dx[arc], dy[arc] = ends.dx[arc], ends.dy[arc]
        sweep[arc] = ends.sweep[arc]
    end = np.empty((len(blocks), 2), np.int64)
    end[:, 0] = np.cumsum(dx) + program.origin[0]
    end[:, 1] = np.cumsum(dy) + program.origin[1]
    start = end - np.column_stack([dx, dy])
    return Walk(blocks, start, end, steps, textbook, sweep, stepping)

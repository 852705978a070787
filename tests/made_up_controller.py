"""A controller that does not exist, as one module: what a new one has to bring.

It rounds the exact line or circle to the grid step by step, so its steps may be diagonal, and its
programs are lines of text: ``L x y count``, ``A turn x y count``, ``M x y count``, ``P``, ``S``.
Whoever adds a real controller parts this over formats/, frontends/, backends/, controllers/ and
targets/, with a line in the registry of each.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from wedmcam.controllers import ArcEnd, Motion, Step
from wedmcam.diag import TextSpan, error
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.machines import Limits, Machine
from wedmcam.targets.stated import Stated

#: J of an arc counts this many parts of a um along it.
PARTS = 64
MACHINE = Machine(
    name="made-up",
    title="A controller that does not exist",
    format="made-up",
    line_table="mirror",
    count="exact",
    limits=Limits(count_um=10**9, line_um=10**6, arc_um=10**6),
)


class Rounding:
    """The interpolator: place n of a block is the n-th of equal parts of it, rounded."""

    steady = False

    def _pieces(self, b):
        """Return how many steps a block makes, and a function of the share run to (dx, dy)."""
        x, y, turn, count = (int(b[name]) for name in ("x", "y", "turn", "count"))
        if b["kind"] in (Kind.LINE, Kind.MOVE):
            steps = max(abs(x), abs(y))
            return steps, lambda share: (x * share, y * share)
        if b["kind"] != Kind.ARC:
            return 0, None
        radius, sweep = np.hypot(x, y), count / PARTS / np.hypot(x, y)
        start = np.arctan2(y, x)

        def place(share):
            angle = start + turn * sweep * share
            return radius * np.cos(angle) - x, radius * np.sin(angle) - y

        return max(1, int(np.ceil(radius * sweep))), place

    def _way(self, b):
        """Return the places of a block after each of its steps, from its start."""
        steps, place = self._pieces(b)
        if not steps:
            return np.zeros((0, 2), np.int64)
        share = np.arange(1, steps + 1) / steps
        return np.floor(np.column_stack(place(share)) + 0.5).astype(np.int64)

    def run(self, blocks):
        ways = [self._way(b) for b in blocks]
        ends = np.array([w[-1] if len(w) else (0, 0) for w in ways], np.int64).reshape(-1, 2)
        return Motion(ends[:, 0], ends[:, 1], np.array([len(w) for w in ways], np.int64))

    def position(self, blocks, n):
        ways = [np.vstack([[0, 0], self._way(b)]) for b in blocks]
        at = np.array([w[min(max(int(k), 0), len(w) - 1)] for w, k in zip(ways, n, strict=True)])
        return at[:, 0], at[:, 1]

    def places(self, blocks, moves, x, y, window=None):
        ways = [self._way(b) + np.array([sx, sy]) for b, sx, sy in zip(blocks, x, y, strict=True)]
        every = np.concatenate([np.zeros((0, 2)), *ways])
        every = every[slice(*window)] if window else every
        return every[:, 0], every[:, 1]

    def trace(self, blocks):
        motion = self.run(blocks)
        x, y = np.cumsum(motion.dx) - motion.dx, np.cumsum(motion.dy) - motion.dy
        at = np.column_stack(self.places(blocks, motion, x, y)).astype(np.int64)
        return np.vstack([[0, 0], at]), np.cumsum(motion.steps) - motion.steps

    def steps(self, block):
        before = np.zeros(2, np.int64)
        for place in self._way(block):
            dx, dy = place - before
            axis, sign = (Axis.X, dx) if dx else (Axis.Y, dy)
            yield Step(axis, int(sign), 0, int(place[0]), int(place[1]))
            before = place

    def deviation(self, blocks):
        return np.full(len(blocks), -0.71), np.full(len(blocks), 0.71)

    def extents(self, blocks, steps, start, end):
        x, y = self.places(blocks, None, start[:, 0], start[:, 1])
        every = np.vstack([start, end, np.column_stack([x, y])]).astype(float)
        return np.concatenate([every.min(axis=0), every.max(axis=0)])

    def reversals(self, blocks):
        at, first = self.trace(blocks)
        edges = [*first, len(at) - 1]
        out = []
        for axis in (0, 1):
            d = np.diff(at[:, axis])
            back = np.concatenate([[0], d[1:] * d[:-1] < 0])
            out.append(np.array([int(back[a:b].sum()) for a, b in pairwise(edges)]))
        return out[0], out[1]

    def turn_steps(self, radius):
        return 2 * np.pi * radius

    def line_count(self, x, y):
        return np.zeros(np.shape(x), np.int64), np.maximum(np.abs(x), np.abs(y))

    def same_lines(self, other, x, y):
        return np.full(np.shape(x), isinstance(other, Rounding))

    def arc_end(self, x, y, turn, ex, ey, square=Axis.SQUARE):
        x, y, turn, ex, ey = np.broadcast_arrays(x, y, turn, ex, ey)
        radius, start = np.hypot(x, y), np.arctan2(y, x)
        sweep = np.mod((np.arctan2(ey, ex) - start) * turn, 2 * np.pi)
        sweep = np.where((x == ex) & (y == ey), 2 * np.pi, sweep)
        count = np.floor(radius * sweep * PARTS + 0.5).astype(np.int64)
        angle = start + turn * count / PARTS / np.maximum(radius, 1)
        there = np.floor(radius * np.cos(angle) + 0.5) == ex
        there &= np.floor(radius * np.sin(angle) + 0.5) == ey
        there &= (radius > 1) & (count > 0)
        steps = np.where(there, np.ceil(radius * sweep).astype(np.int64), -1)
        count, axis = np.where(there, count, 0), np.zeros(np.shape(x), np.int64)
        return ArcEnd(there, steps, axis, count, count, count, there)


def stepping(table):
    return Rounding()


class MadeUp(Stated):
    """Its target: it states paths, and counts nothing by geometry."""

    @property
    def stop_word(self):
        return "S"


LETTERS = {Kind.LINE: "L", Kind.ARC: "A", Kind.MOVE: "M", Kind.PAUSE: "P", Kind.STOP: "S"}


def encode(program, machine, positions=None):
    lines = []
    for b in program.blocks:
        kind = Kind(int(b["kind"]))
        numbers = [b["turn"]] if kind == Kind.ARC else []
        numbers += [b["x"], b["y"], b["count"]] if kind <= Kind.MOVE else []
        lines.append(" ".join([LETTERS[kind], *(str(int(n)) for n in numbers)]))
    return ("\n".join(lines) + "\n").encode("ascii"), []


def decode(data, machine, file):
    kinds = {letter: kind for kind, letter in LETTERS.items()}
    rows, spans, found = [], [], []
    for number, line in enumerate(data.decode("ascii", "replace").splitlines(), 1):
        letter, *numbers = line.split() or [""]
        span = TextSpan(file, number, 1, len(line))
        if letter not in kinds:
            found.append(error("unknown-word", f"{line[:20]!r} is no block", span))
            continue
        b = np.zeros(1, BLOCK)
        b["kind"], b["source"] = kinds[letter], -1
        if letter == "A":
            b["turn"] = int(numbers.pop(0))
        if letter in "LAM":
            b["x"], b["y"], b["count"] = (int(n) for n in numbers)
        rows.append(b)
        spans.append(span)
    blocks = np.concatenate(rows) if rows else np.zeros(0, BLOCK)
    return Program(blocks, (0, 0), (), tuple(spans)), found

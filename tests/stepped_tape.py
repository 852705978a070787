"""The controller of the NBY-15 step by step, as the text tells it: an oracle for ``simulate``.

A table of degrees and residues, a reader that fills a buffer of three blocks, a ring of 256 steps.
It has no path in memory: going back reads the ring, and forward reads it again up to where the wire
has been. It shares with ``wedmcam.simulate`` only the loop of one line (`pointwise.line_steps`).
"""

import math
from collections import deque

from wedmcam.controllers.pointwise import line_axis, line_steps
from wedmcam.ir.program import Axis

RING = 256
AHEAD = 3
SCALE = 2**18


class TapeMachine:
    """One tape in the reader, and the machine that runs it.

    Blocks: ("line", x, y), ("move", x, y), ("arc", turn, start, degrees, radius), ("pause",).
    """

    def __init__(self, tape):
        self.tape = deque([*enumerate(tape, 1), (len(tape) + 1, ("end",))])
        self.lost = False
        self.buffer = deque()
        self.number, self.work = 0, deque()  # steps of the block in work: (axis, sign, kind)
        self.ended = self.moved = False
        self.residue = [SCALE // 2, SCALE // 2]
        self.cells = [None] * RING
        self.head = self.count = self.behind = 0
        self.n, self.at, self.log, self.events = 0, [0, 0], [], []
        self.fill()
        self.next_block()

    # --- the reader -----------------------------------------------------------------------------

    def fill(self):
        while not self.lost and self.tape and len(self.buffer) < AHEAD:
            self.buffer.append(self.tape.popleft())

    def next_block(self):
        """Take blocks into work until one has a step."""
        while not self.work and not self.ended:
            if not self.buffer:
                if self.number:
                    self.events.append(("no-tape", self.n))
                    self.lost = False
                self.fill()
            self.number, block = self.buffer.popleft()
            self.fill()
            kind, *words = block
            if kind == "end":
                self.ended = True
            elif kind == "pause":
                self.events.append(("thread-point" if self.moved else "pause", self.n))
                if self.moved:  # a wire is threaded: what lies behind is not gone back over
                    self.count = 0
            else:
                self.work.extend(self.steps(kind, *words))
            self.moved = kind == "move"

    # --- the interpolator -----------------------------------------------------------------------

    def steps(self, kind, *words):
        if kind != "arc":
            yield from self.line(*words, kind)
            return
        turn, start, degrees, radius = words
        for k in range(degrees):
            a, b = (math.radians(start + turn * (k + more)) for more in (0, 1))
            way = [round(SCALE * f(b)) - round(SCALE * f(a)) for f in (math.cos, math.sin)]
            whole = []
            for axis in range(2):
                total = way[axis] * radius + self.residue[axis]
                whole.append(total // SCALE)
                self.residue[axis] = total % SCALE
            yield from self.line(*whole, "line")

    def line(self, x, y, kind):
        if x or y:
            axis = line_axis(x, y)
            count = abs(x if axis == Axis.X else y)
            for step in line_steps(x, y, axis, count):
                yield int(step.axis), step.sign, kind

    # --- one step forward, one step back --------------------------------------------------------

    def forward(self):
        """Make a step: out of the ring where the wire has been, else of the block in work."""
        if self.behind:
            cell = self.cells[(self.head - self.behind) % RING]
            self.behind -= 1
            way = "move" if cell[2] == "move" else "servo-feed"
        elif self.ended:
            return False
        else:
            cell = self.work.popleft()
            self.cells[self.head % RING] = cell
            self.head += 1
            self.count = min(self.count + 1, RING)
            way = "move" if cell[2] == "move" else "cut"
        self.go(cell[0], cell[1], way)
        self.n += 1
        if not self.behind:
            self.next_block()
        return True

    def back(self):
        """Undo a step out of the ring; False where nothing is left in it."""
        if self.behind == self.count:
            return False
        self.behind += 1
        axis, sign, _ = self.cells[(self.head - self.behind) % RING]
        self.go(axis, -sign, "retreat")
        self.n -= 1
        return True

    def go(self, axis, sign, way):
        self.at[axis] += sign
        self.log.append((axis, sign, way))

    # --- what goes wrong ------------------------------------------------------------------------

    def come_to(self, step):
        while self.n < step:
            assert self.forward()

    def short(self, length):
        """Go back until it is free, or the memory is at its end."""
        self.events.append(("short", self.n))
        free = all(self.back() for _ in range(length))
        self.events.append(("clear" if free else "alarm", self.n))

    def tear(self):
        self.lost = True

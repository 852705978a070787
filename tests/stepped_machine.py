"""The ZD-065's controller step by step, as the paper tells it: an oracle for ``wedmcam.simulate``.

It shares with it only the rules of one step, forwards and back. It has no path in memory: going
back undoes one step after the other, from block to block, and each axis compares its direction with
the last one. It runs one program with faults and notes every pulse of its motors.
"""

from dataclasses import dataclass

from wedmcam.controllers.pointwise import arc_quadrant, arc_steps, line_axis, line_steps
from wedmcam.controllers.pointwise.back import arc_back, line_back
from wedmcam.controllers.pointwise.steps import ARC_TABLE
from wedmcam.ir.program import Axis, Kind

STEPPING = (Kind.LINE, Kind.ARC, Kind.MOVE)


@dataclass
class Screw:
    """A motor, a table with play, and the direction that the controller remembers."""

    backlash: int
    play: int
    direction: int
    true: int
    motor: int = 0
    table: float = 0

    def __post_init__(self):
        # The table lies between the motor and the play above it.
        self.low = 0 if self.true > 0 else -self.play

    def pulse(self, sign):
        self.motor += sign
        low = self.low + self.motor
        self.table = min(max(self.table, low), low + self.play)

    def step(self, sign):
        """Take up the play if the axis reverses, then step; return the number of take-ups."""
        ups = self.backlash if sign != self.direction else 0
        for _ in range(ups + 1):
            self.pulse(sign)
        self.direction = sign
        return ups


class Machine:
    """One program in the memory, and where the controller is in it."""

    def __init__(self, blocks, backlash, play, approach=(1, 1), true=(1, 1)):
        self.blocks = list(blocks)
        kinds = [int(b["kind"]) for b in blocks]
        if Kind.STOP in kinds:
            self.blocks = self.blocks[: kinds.index(Kind.STOP)]
        self.screws = [Screw(backlash[k], play[k], approach[k], true[k]) for k in range(2)]
        self.n = 0  # steps of the path that are made
        self.block = -1
        self.x = self.y = self.f = self.j = 0
        self.at = [0, 0]
        self.log = []  # (axis, sign, take-ups, step)
        self.worst = 0
        self.next_block()

    # --- the interpolator -----------------------------------------------------------------------

    def next_block(self):
        """Decode the next block that steps; False at the end of the data."""
        row = self.block + 1
        while row < len(self.blocks) and int(self.blocks[row]["kind"]) not in STEPPING:
            row += 1
        if row == len(self.blocks):
            return False
        self.begin(row)
        return True

    def begin(self, row):
        b = self.blocks[row]
        self.block, self.f, self.j = row, 0, int(b["count"])
        arc = int(b["kind"]) == Kind.ARC
        self.x, self.y = (int(b["x"]), int(b["y"])) if arc else (0, 0)

    def is_arc(self):
        return int(self.blocks[self.block]["kind"]) == Kind.ARC

    def counts(self, axis, x, y):
        """Whether a step on an axis from (x, y) counts towards J."""
        b = self.blocks[self.block]
        if not self.is_arc():
            return axis == line_axis(int(b["x"]), int(b["y"]))
        return axis == (Axis.X if abs(x) < abs(y) else Axis.Y)

    def ahead(self):
        """Return axis, sign and F of the next step of this block."""
        b = self.blocks[self.block]
        if self.is_arc():
            turn = int(b["turn"])
            inwards, outwards = ARC_TABLE[turn, arc_quadrant(self.x, self.y, turn)]
            axis, sign = inwards if self.f >= 0 else outwards
            value = self.x if axis == Axis.X else self.y
            return axis, sign, self.f + 2 * sign * value + 1
        xe, ye = int(b["x"]), int(b["y"])
        if ye == 0 or (xe != 0 and self.f >= 0):
            return Axis.X, 1 if xe > 0 else -1, self.f - abs(ye)
        return Axis.Y, 1 if ye > 0 else -1, self.f + abs(xe)

    # --- one step forward, one step back --------------------------------------------------------

    def forward(self):
        """Make the next step of the path; return False at the end of the program."""
        if self.j == 0 and not self.next_block():
            return False
        axis, sign, f = self.ahead()
        counted = self.counts(axis, self.x, self.y)
        self.move(axis, sign)
        self.f = f
        self.j -= counted
        self.n += 1
        self.drive(axis, sign)
        return True

    def back(self):
        """Undo the last step of the path."""
        b = self.blocks[self.block]
        start = (int(b["x"]), int(b["y"])) if self.is_arc() else (0, 0)
        if (self.x, self.y) == start and self.j == int(b["count"]):
            self.block_before()
            b = self.blocks[self.block]
        if self.is_arc():
            axis, sign, f = arc_back(self.x, self.y, self.f, int(b["turn"]))
        else:
            axis, sign, f = line_back(int(b["x"]), int(b["y"]), self.f)
        self.move(axis, -sign)
        self.f = f
        self.j += self.counts(axis, self.x, self.y)
        self.n -= 1
        self.drive(axis, -sign)

    def block_before(self):
        """Take the block before, at its end: F and the place there follow from stepping it."""
        row = self.block - 1
        while int(self.blocks[row]["kind"]) not in STEPPING:
            row -= 1
        b = self.blocks[row]
        self.block, self.j = row, 0
        x, y, count = int(b["x"]), int(b["y"]), int(b["count"])
        if self.is_arc():
            *_, last = arc_steps(x, y, int(b["turn"]), Axis.SQUARE, count)
        else:
            *_, last = line_steps(x, y, Axis.SQUARE, count)
        self.x, self.y, self.f = last.x, last.y, last.f

    def move(self, axis, sign):
        if axis == Axis.X:
            self.x += sign
        else:
            self.y += sign

    def drive(self, axis, sign):
        self.at[axis] += sign
        ups = self.screws[axis].step(sign)
        self.log.append((int(axis), sign, ups, self.n))
        off = max(abs(self.screws[k].table - self.at[k]) for k in range(2))
        self.worst = max(self.worst, off)

    # --- what goes wrong ------------------------------------------------------------------------

    def short(self, length, thread):
        """Go back until the wire is free, 100 steps or the thread point; True if it is free."""
        back = 0
        while back < min(length, 100) and self.n > thread:
            self.back()
            back += 1
        return back == length

    def straight_to_start(self):
        """Go to the start of the program by the shortest way, and begin it again."""
        x, y = -self.at[0], -self.at[1]
        for s in line_steps(x, y, Axis.SQUARE, max(abs(x), abs(y))) if x or y else ():
            self.drive(s.axis, s.sign)
        self.n, self.block = 0, -1
        self.next_block()

    def back_to(self, n):
        while self.n > n:
            self.back()

    def shown(self):
        """Return block, x, y, F and J."""
        return self.block + 1, self.x, self.y, self.f, self.j

    def whole(self):
        """Return everything that must come back after a fault."""
        turned = tuple((s.direction, s.motor, s.motor % 6, s.table) for s in self.screws)
        return self.n, self.shown(), turned

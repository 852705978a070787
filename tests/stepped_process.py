"""A controller under faults, step by step: an oracle for ``wedmcam.simulate.process``.

It shares the steps of the path and the values of `Answers` with it, and no code: one step a turn, a
tape that is read block by block, a memory that forgets its oldest step, and a machine that is
copied where the power fails. What it does is a list of (way, axis, sign, place) and one of (what
happened, steps made before, place).
"""

from collections import deque
from copy import deepcopy

from wedmcam.controllers.pointwise import line_steps
from wedmcam.ir.program import Axis, Kind
from wedmcam.simulate.scenario import Trouble


class Tape:
    """The records of a program: so many are read ahead of the one that is run."""

    def __init__(self, route, ahead):
        self.records = route.records.tolist()
        self.lengths = route.lengths.tolist()
        self.first = route.first.tolist()
        self.ahead, self.blocks, self.end = ahead, route.blocks, route.steps

    def ends_at(self, n):
        """Return place and row of the first block that is not read if the tape tears at a place.

        The record that is run is the one of the next step; what ends the program is one too. None:
        all is read.
        """
        for row, length in enumerate(self.lengths):
            if self.first[row] <= n < self.first[row] + length:
                held = self.records[row] + self.ahead
                if held >= self.blocks:
                    return None
                later = [k for k, record in enumerate(self.records) if record > held]
                return (self.first[later[0]], later[0]) if later else (self.end, len(self.records))
        return None


class Process:
    """One program, and where the machine is in it."""

    def __init__(self, route, answers):
        self.answers = answers
        self.steps = list(zip(route.axis.tolist(), route.sign.tolist(), strict=True))
        self.end = len(self.steps)
        self.tape = Tape(route, answers.ahead)
        first, length = route.first.tolist(), route.lengths.tolist()
        kinds = [int(block["kind"]) for block in route.program.blocks]
        self.off = set()
        for kind, at, count in zip(kinds, first, length, strict=True):
            if kind == Kind.MOVE:
                self.off |= set(range(at + 1, at + count + 1))
        self.halts = []  # of every block
        for k, (kind, at) in enumerate(zip(kinds, first, strict=True)):
            behind_move = k > 0 and kinds[k - 1] == Kind.MOVE
            if kind == Kind.THREAD or (kind == Kind.PAUSE and behind_move):
                self.halts.append((at, "thread-point"))
            else:
                self.halts.append((at, "pause" if kind == Kind.PAUSE else ""))
        self.threads = [0, *(at for at, kind in self.halts if kind == "thread-point")]
        self.starts = first
        self.n = 0
        self.front = 0
        self.memory = deque(maxlen=answers.retreat)
        self.torn = None
        self.log, self.events = [], []

    # --- what it does ---------------------------------------------------------------------------

    def say(self, kind):
        self.events.append((kind, len(self.log), self.n))

    def arrive(self):
        """Stop where the program says so, or where nothing of it is read any more."""
        for row, (at, kind) in enumerate([*self.halts, (self.end, "")]):
            if self.torn == (self.n, row):
                self.say("no-tape")
                self.torn = None
                self.say("start")
            if at == self.n and kind:
                self.say(kind)

    def forward(self):
        axis, sign = self.steps[self.n]
        again = self.n < self.front
        self.n += 1
        way = "move" if self.n in self.off else "cut"
        if again and way == "cut" and self.answers.servo_feed:
            way = "servo-feed"
        self.log.append((way, axis, sign, self.n))
        if self.n == self.front and way == "servo-feed":
            self.say("front")
        self.front = max(self.front, self.n)
        self.memory.append(self.n)
        # Who goes forward by its memory sees steps, and no program.
        if not (again and self.answers.remembers):
            self.arrive()

    def back(self, way):
        axis, sign = self.steps[self.n - 1]
        self.n -= 1
        self.log.append((way, axis, -sign, self.n))
        if self.memory:
            self.memory.pop()

    def thread(self):
        return max(at for at in self.threads if at <= self.n)

    def cut(self):
        """Fail: what goes on is a copy of what was saved."""
        self.say("power-cut")
        self.say("resume")
        self.halts, self.memory = deepcopy(self.halts), deepcopy(self.memory)

    # --- what goes wrong ------------------------------------------------------------------------

    def short(self, fault, um):
        """Go back step by step until the wire is free; False: the machine stands with an alarm."""
        self.say("short")
        thread, made = self.thread(), 0
        while True:
            if fault.cut_after == made:
                self.cut()
            if made * um >= fault.length:
                self.say("clear")
                return True
            if self.n == thread or (
                not self.memory if self.answers.remembers else made == self.answers.retreat
            ):
                self.say("alarm")
                if fault.goes_on:
                    self.say("clear-alarm")
                return fault.goes_on
            self.back("retreat")
            made += 1

    def broken(self, fault, route):
        self.say("break")
        if not self.answers.returns:
            self.say("start")
            return
        made = 0
        if fault.block is None and self.answers.shortest and set(self.threads) == {0}:
            x, y = (-int(v) for v in route.place[self.n])
            way = line_steps(x, y, Axis.SQUARE, max(abs(x), abs(y))) if x or y else ()
            for step in way:
                if fault.cut_after == made:
                    self.cut()
                self.log.append(("shortest", int(step.axis), step.sign, self.n))
                made += 1
            if fault.cut_after == made:
                self.cut()
            self.n = 0
        else:
            goal = self.thread()
            if fault.block is not None:  # as it is written: of many rows maybe
                rows = enumerate(self.tape.records)
                goal = self.starts[next(k for k, one in rows if one >= fault.block - 1)]
            while True:
                if fault.cut_after == made:
                    self.cut()
                if self.n == goal:
                    break
                self.back("return")
                made += 1
        self.say("back")

    def meet(self, fault, route):
        """Let one thing go wrong; False: the machine stands."""
        trouble = fault.trouble
        if trouble is Trouble.POWER:
            self.cut()
        elif trouble is Trouble.SHORT:
            return self.short(fault, route.step_um)
        elif trouble is Trouble.BREAK:
            self.broken(fault, route)
        elif trouble is Trouble.STOP:
            self.say("stop")
            self.say("start")
        elif trouble is Trouble.LIMIT:
            self.say("limit")
            if fault.goes_on:
                self.say("clear-alarm")
            return fault.goes_on
        elif trouble is Trouble.TAPE:
            self.say("tape")
            if self.torn is None:
                # A tape was read on from where the wire has come to, not from where it is.
                at = self.front if self.answers.remembers else self.n
                self.torn = self.tape.ends_at(at)
        return True

    def run(self, route, faults):
        """Run the program; True: to its end."""
        self.arrive()
        return self.go_on(route, faults)

    def go_on(self, route, faults):
        """Run the rest of it."""
        for fault in faults:
            while self.n < fault.step:
                self.forward()
            if not self.meet(fault, route):
                return False
        while self.n < self.end:
            self.forward()
        self.say("end")
        return True

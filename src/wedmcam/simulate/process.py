"""What the machine does next: forward, back, stopped, off. The path of a run as legs over a route.

Nothing here knows motors or time: a leg counts steps of the route up or down, or goes straight to a
thread point. What one controller answers to a fault stands in `Answers`.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from wedmcam.simulate.controller import Answers
from wedmcam.simulate.route import Halt, Route
from wedmcam.simulate.scenario import Fault, Scenario, Trouble, last_thread


class Way(StrEnum):
    """What kind of leg it is."""

    CUT = "cut"  # forward, the generator on (in a dry run: the pen)
    MOVE = "move"  # forward on a positioning move, the generator off
    RETREAT = "retreat"  # back along the path from a short circuit
    RETURN = "return"  # back along the path after a wire break
    SHORTEST = "shortest"  # straight to the thread point
    SERVO_FEED = "servo-feed"  # forward over what is cut, with a reference current


#: All kinds of ways; arrays hold a way as its index here.
WAYS = tuple(Way)


class Mode(StrEnum):
    """What the controller is about: the state of its state machine."""

    FORWARD = "forward"
    RETREAT = "retreat"
    RETURN = "return"
    SHORTEST = "shortest"
    ALARM = "alarm"
    END = "end"


@dataclass(frozen=True, slots=True)
class Stand:
    """Where a process stands between two steps.

    Attributes:
        mode: what it is about.
        step: number of its place on the route; while it goes straight to a thread point, of the
            place where it left the path.
        target: number of the place at which a way back ends.
        made: steps of the straight way that are made.
        short: after a retreat the short circuit is still there.
        goes_on: the operator clears an alarm, and cuts on.
        front: number of the farthest place that the wire has come to.
        unread: from which block, 1-based, on nothing is read; 0 where the program is read.
    """

    mode: Mode = Mode.FORWARD
    step: int = 0
    target: int = 0
    made: int = 0
    short: bool = False
    goes_on: bool = False
    front: int = 0
    unread: int = 0

    @property
    def place(self) -> int:
        """Number of the place from which the machine goes forward again."""
        back = self.mode in (Mode.RETREAT, Mode.RETURN, Mode.SHORTEST)
        return self.target if back else self.step

    def ahead(self, step: int) -> Stand:
        """Return it on its way forward from a place."""
        return Stand(Mode.FORWARD, step, front=self.front, unread=self.unread)


@dataclass(frozen=True, slots=True)
class Leg:
    """Steps of one kind, one after the other.

    Attributes:
        way: its kind.
        first, last: numbers of the places between which it goes; a straight one leaves the path at
            ``first`` and goes to the place ``last``.
        made, count: of a straight one: how many of its steps were made before, and are now.
        seconds: how long each step takes, where a servo says so.
    """

    way: Way
    first: int
    last: int
    made: int = 0
    count: int = 0
    seconds: NDArray[np.float64] | None = field(default=None, compare=False)

    @property
    def steps(self) -> int:
        """How many steps it makes."""
        return self.count if self.way is Way.SHORTEST else abs(self.last - self.first)

    def part(self, first: int, last: int) -> Leg:
        """Return the part of a leg along the path that lies between two of its places."""
        if self.seconds is None:
            return replace(self, first=first, last=last)
        rows = sorted((abs(first - self.first), abs(last - self.first)))
        return replace(self, first=first, last=last, seconds=self.seconds[slice(*rows)])

    def pieces(self, most: int) -> Iterator[Leg]:
        """Yield the leg in pieces of so many steps at most."""
        if self.steps <= most:
            yield self
        elif self.way is Way.SHORTEST:
            for made in range(0, self.count, most):
                count = min(most, self.count - made)
                yield replace(self, made=self.made + made, count=count)
        else:
            up = 1 if self.last > self.first else -1
            for first in range(self.first, self.last, up * most):
                yield self.part(first, first + up * min(most, abs(self.last - first)))


@dataclass(frozen=True, slots=True)
class Incident:
    """Something that happened between two steps.

    Attributes:
        kind: pause, thread-point, short, clear, front, alarm, clear-alarm, break, back, power-cut,
            resume, stop, start, limit, tape, no-tape, end.
        walked: how many steps were made before it, back and forth, in this run.
        stand: of the process.
        more: what else there is to say of it.
    """

    kind: str
    walked: int
    stand: Stand
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def step(self) -> int:
        """Number of the place."""
        return self.stand.step


@dataclass(frozen=True, slots=True)
class Walk:
    """The path of a run.

    Attributes:
        legs: in their order.
        incidents: in their order.
        stand: at its end.
        cut: the power cut that ended it; None where none did.
        faults: those that were still to come.
    """

    legs: tuple[Leg, ...]
    incidents: tuple[Incident, ...]
    stand: Stand
    cut: Fault | None
    faults: tuple[Fault, ...]


class Turn(NamedTuple):
    """What a servo makes of a way forward.

    Attributes:
        legs: forward and back.
        step: number of the place at their end.
        back: steps behind the farthest place at which it stopped with an alarm; None where it has
            arrived.
    """

    legs: tuple[Leg, ...]
    step: int
    back: int | None


class Feeder(Protocol):
    """A servo as the process sees it: see `feeding.Feeding`."""

    attended: bool

    def forward(self, step: int, goal: int, floor: int, retreat: int) -> Turn:
        """Go to the first arrival at a place, or to an alarm."""
        ...

    def clear(self) -> None:
        """Go on behind an alarm whose cause is gone."""
        ...


def way_back(route: Route, answers: Answers, fault: Fault, front: int = 0) -> Stand:
    """Return how a controller starts back from a short circuit or a wire break.

    Args:
        route: of the program.
        answers: of the controller.
        fault: the short circuit, or the wire break.
        front: number of the farthest place that the wire has come to, where that lies ahead.
    """
    step = fault.step
    thread = last_thread(route, step)
    begin = Stand(Mode.RETURN, step, thread, goes_on=fault.goes_on, front=step)
    if fault.trouble is Trouble.SHORT:
        # A retreat ends at the last thread point [R]: behind it lies a move without a wire.
        length = -(-fault.length // route.step_um)
        back = min(length, step - farthest_back(answers, step, front), step - thread)
        return replace(begin, mode=Mode.RETREAT, target=step - back, short=length > back)
    if fault.block is not None:
        return replace(begin, target=route.start_of(fault.block))
    if answers.shortest and not route.threads.any():
        return replace(begin, mode=Mode.SHORTEST, target=0)
    return begin


def farthest_back(answers: Answers, step: int, front: int) -> int:
    """Return the number of the place to which a controller can go back; below 0 for any.

    A memory of steps is filled as the wire comes to new places, and a servo feed reads it again: on
    its way the machine is as far back as it is behind the front.
    """
    return (max(step, front) if answers.servo_feed else step) - answers.retreat


def steps_back(route: Route, stand: Stand) -> int:
    """Return how many steps a way back has."""
    if stand.mode is Mode.SHORTEST:
        return int(abs(route.place[stand.target] - route.place[stand.step]).sum())
    return stand.step - stand.target


def walk(
    route: Route,
    scenario: Scenario,
    stand: Stand,
    answers: Answers,
    feeder: Feeder | None = None,
    *,
    begun: bool = False,
) -> Walk:
    """Return the path of a run, up to the end of the program, an alarm, or a power cut.

    Args:
        route: of the program.
        scenario: its faults are checked, and lie at or behind ``stand``.
        stand: where it begins.
        answers: of the controller.
        feeder: a servo that feeds the wire; without one it goes forward as the scenario says.
        begun: the machine was at this place before; else the program begins.
    """
    return _Process(route, answers, stand, scenario.faults, feeder).run(begun)


class _Process:
    """The state machine: each method of a mode goes on until the mode changes, or power fails."""

    def __init__(
        self,
        route: Route,
        answers: Answers,
        stand: Stand,
        faults: tuple[Fault, ...],
        feeder: Feeder | None,
    ) -> None:
        self.route, self.answers, self.stand, self.feeder = route, answers, stand, feeder
        self.faults, self.next = faults, 0
        self.legs: list[Leg] = []
        self.incidents: list[Incident] = []
        self.walked = 0
        self.cut: Fault | None = None
        self._halts: list[Halt] = []

    def run(self, begun: bool) -> Walk:
        # A halt at the very start is still to come; elsewhere the machine was there before.
        self._halts = self._halts_to_come() if begun else self._halts_behind(-1)
        if self.stand.mode is Mode.ALARM:
            # Who begins a run at an alarm has seen to its cause.
            self._clear_alarm()
        while self.cut is None and self.stand.mode not in (Mode.ALARM, Mode.END):
            if self.stand.mode is Mode.FORWARD:
                self._go_forward()
            else:
                self._go_back()
        rest = self.faults[self.next :]
        return Walk(tuple(self.legs), tuple(self.incidents), self.stand, self.cut, rest)

    # --- forward ------------------------------------------------------------------------------

    def _go_forward(self) -> None:
        """Cut up to the next fault, or the end, and stop at thread points and pauses."""
        fault = self.faults[self.next] if self.next < len(self.faults) else None
        goal = self.route.steps if fault is None else fault.step
        while self._halts and self._halts[-1].step <= goal:
            if not self._forward_to(self._halts[-1].step):
                return
            halt = self._halts.pop()
            self._log(halt.kind, halt_block=halt.block)
            if halt.kind == "no-tape":
                self.stand = replace(self.stand, unread=0)
                self._log("start")
        if not self._forward_to(goal):
            return
        if fault is None:
            self.stand = replace(self.stand, mode=Mode.END)
            self._log("end")
            return
        self.next += 1
        if fault.trouble is Trouble.POWER:
            self._cut_power(fault)
            return
        if fault.trouble is Trouble.TAPE:
            self._lose_tape()
            return
        more: dict[str, Any] = {}
        if fault.trouble is Trouble.SHORT:
            more["length"] = fault.length
        elif fault.switch:
            more["switch"] = fault.switch
        self._log(str(fault.trouble), **more)
        if fault.trouble in (Trouble.STOP, Trouble.LIMIT) or (
            fault.trouble is Trouble.BREAK and not self.answers.returns
        ):
            self._stop(fault)
        else:
            front = max(self.stand.front, fault.step)
            back = way_back(self.route, self.answers, fault, front)
            self.stand = replace(back, front=front, unread=self.stand.unread)
            self._go_back(fault)

    def _forward_to(self, goal: int) -> bool:
        """Go to a place; return whether the machine has come there without an alarm."""
        for way, last in self._ways(self.stand.step, goal):
            if way is Way.CUT and self.feeder is not None:
                if not self._feed(self.feeder, last):
                    return False
            else:
                self._advance(Leg(way, self.stand.step, last))
        return True

    def _advance(self, leg: Leg) -> None:
        """Go forward; over what is cut with the servo feed, where the controller has one."""
        front = self.stand.front
        if self.answers.servo_feed and leg.way is Way.CUT and leg.first < front:
            again = min(front, leg.last)
            self._add(replace(leg.part(leg.first, again), way=Way.SERVO_FEED))
            self.stand = replace(self.stand, step=again)
            if again == front:
                self._log("front")
            leg = leg.part(again, leg.last)
        self._add(leg)
        self.stand = replace(self.stand, step=leg.last, front=max(front, leg.last))

    def _stop(self, fault: Fault) -> None:
        """Stop on the spot; but for a limit switch the operator starts the machine again."""
        if fault.trouble is Trouble.LIMIT:
            self.stand = replace(self.stand, mode=Mode.ALARM)
            if fault.goes_on:
                self._clear_alarm()
            return
        if self.feeder is not None:
            self.feeder.clear()
        self._log("start")

    def _lose_tape(self) -> None:
        """Read no more: what is read ahead is run, then the operator puts the tape in again.

        Where the reader stands already, it goes on standing.
        """
        halt = self.route.unread(max(self.stand.step, self.stand.front), self.answers.ahead)
        if halt is not None and not self.stand.unread:
            self.stand = replace(self.stand, unread=halt.block)
            self._halts = self._halts_to_come()
        unread = self.stand.unread
        self._log("tape", **({"until": self.route.start_of(unread)} if unread else {}))

    def _feed(self, feeder: Feeder, goal: int) -> bool:
        """Let a servo go to a place of a stretch on which the generator is on."""
        switches = self.route.switches
        before = bisect_right(switches, self.stand.step)
        begun = switches[before - 1] if before else 0
        cleared = False
        while True:
            step = self.stand.step
            # It goes back no farther than a retreat, and not onto a positioning move [R].
            behind = farthest_back(self.answers, step, self.stand.front)
            floor = max(last_thread(self.route, step), begun, behind)
            turn = feeder.forward(step, goal, floor, self.answers.retreat)
            for leg in turn.legs:
                back = leg.way is Way.RETREAT
                if back:
                    self._log("short", length=leg.steps)
                    self._add(leg)
                    self.stand = replace(self.stand, step=leg.last)
                else:
                    self._advance(leg)
                if back and (turn.back is None or leg is not turn.legs[-1]):
                    self._log("clear")
            if turn.back is None:
                return True
            self.stand = replace(
                self.stand, mode=Mode.ALARM, step=turn.step, target=turn.step, short=True
            )
            self._log("alarm", back=turn.back)
            if not feeder.attended or (cleared and not turn.legs):
                return False
            # Who clears an alarm at which nothing moves will not clear it again.
            cleared = True
            self._clear_alarm()

    def _ways(self, step: int, goal: int) -> Iterator[tuple[Way, int]]:
        """Yield the ends of stretches with the generator on, and off."""
        switches = self.route.switches
        while step < goal:
            way = Way.MOVE if self.route.moves[step] else Way.CUT
            step = min(switches[bisect_right(switches, step)], goal)
            yield way, step

    # --- ways back ----------------------------------------------------------------------------

    def _go_back(self, fault: Fault | None = None) -> None:
        """Go back to the target, along the path or straight; the power may fail on the way."""
        stand = self.stand
        steps = steps_back(self.route, stand) - stand.made
        if fault is not None and fault.cut_after is not None:
            steps = fault.cut_after
        if stand.mode is Mode.SHORTEST:
            self._add(Leg(Way.SHORTEST, stand.step, stand.target, stand.made, steps))
            self.stand = replace(stand, made=stand.made + steps)
        else:
            way = Way.RETREAT if stand.mode is Mode.RETREAT else Way.RETURN
            self._add(Leg(way, stand.step, stand.step - steps))
            self.stand = replace(stand, step=stand.step - steps)
        if fault is not None and fault.cut_after is not None:
            self._cut_power(fault)
        else:
            self._arrive()

    def _arrive(self) -> None:
        """End a way back: cut on, or stop with an alarm."""
        stand = self.stand
        if stand.mode is not Mode.RETREAT:
            self.stand = stand.ahead(stand.target)
            thread = stand.target in self.route.threads
            row = int(self.route.rows(np.array([stand.target + 1]))[0])
            block = int(self.route.records[row]) + 1
            self._log("back", where="the thread point" if thread else f"the start of block {block}")
        elif stand.short:
            self.stand = replace(stand, mode=Mode.ALARM)
            self._log("alarm")
            if stand.goes_on:
                self._clear_alarm()
        else:
            self.stand = stand.ahead(stand.step)
            self._log("clear")
        self._halts = self._halts_to_come()

    def _clear_alarm(self) -> None:
        if self.feeder is not None:
            self.feeder.clear()
        self.stand = self.stand.ahead(self.stand.step)
        self._log("clear-alarm")

    # --- all modes ----------------------------------------------------------------------------

    def _cut_power(self, fault: Fault) -> None:
        self.cut = fault
        more = {"pulses": fault.pulses} if fault.pulses else {}
        self._log("power-cut", **more)

    def _halts_to_come(self) -> list[Halt]:
        """Return the halts that are still to come, the next one last.

        Who goes back over blocks comes to their halts again; a memory of steps holds none.
        """
        stand = self.stand
        return self._halts_behind(stand.front if self.answers.servo_feed else stand.step)

    def _halts_behind(self, step: int) -> list[Halt]:
        """Return the halts behind a place, the next one last."""
        every = list(self.route.halts)
        if self.stand.unread:
            # Put in front of what the block itself says: sorting keeps their order.
            every.insert(0, self.route.no_tape(self.stand.unread))
        every = sorted(every, key=lambda halt: (halt.step, halt.block))
        return [halt for halt in reversed(every) if halt.step > step]

    def _add(self, leg: Leg) -> None:
        if leg.steps:
            self.legs.append(leg)
            self.walked += leg.steps

    def _log(self, kind: str, **more: Any) -> None:
        self.incidents.append(Incident(kind, self.walked, self.stand, more))

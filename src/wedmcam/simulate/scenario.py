"""What happens to a simulated machine, and when: as data, checked before anything runs.

A scenario is text of anybody: on the command line (``short@500:60``), as a TOML file, or drawn from
a seed. A fault that cannot happen is an error with its place, never left out.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from wedmcam.diag import Span
from wedmcam.simulate.route import Route

#: What a fault may be, as it is written on the command line.
FAULT = re.compile(
    r"(?P<kind>[a-z]+)@(?P<step>[0-9]{1,9})"
    r"(?:(?P<sign>[:+])(?P<value>[0-9]{1,9}|thread))?"
)
HOW = (
    "write short@STEP:LENGTH_UM, break@STEP, break@STEP:BLOCK, power@STEP, power@STEP+PULSES, "
    "stop@STEP, limit@STEP or tape@STEP"
)
#: The longest short circuit that a seed draws, um.
RANDOM_LENGTH = 100


class Trouble(StrEnum):
    """What goes wrong."""

    SHORT = "short"
    BREAK = "break"
    POWER = "power"
    STOP = "stop"  # an emergency stop; the operator starts the machine again
    LIMIT = "limit"  # a limit switch opens: an alarm
    TAPE = "tape"  # no more of the tape is read: it is torn, or at its end


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that goes wrong when the machine first comes to a step.

    Attributes:
        trouble: what.
        step: number of the step of the path after which it happens, 0 for the start.
        length: of a short circuit: how far the wire has to go back until it is free, um.
        block: of a wire break: to the start of which block, 1-based, the operator returns; None
            for the thread point.
        pulses: of a power cut: how many steps of the take-up before the next step are made.
        cut_after: steps of the way back after which the power fails too; None where it does not.
        goes_on: after an alarm the operator clears the fault and cuts on.
        switch: of a limit switch, which one, as in "-X"; empty where it is not stated.
        span: where it was stated.
    """

    trouble: Trouble
    step: int
    length: int = 0
    block: int | None = None
    pulses: int = 0
    cut_after: int | None = None
    goes_on: bool = False
    switch: str = ""
    span: Span | None = None

    def __str__(self) -> str:
        more = ""
        if self.trouble is Trouble.SHORT:
            more = f":{self.length}"
        elif self.block is not None:
            more = f":{self.block}"
        elif self.pulses:
            more = f"+{self.pulses}"
        return f"{self.trouble}@{self.step}{more}"


def fault_of(text: str) -> Fault | None:
    """Return the fault that a text of the command line states; None where it states none.

    >>> str(fault_of("short@500:60")), str(fault_of("power@7+3")), fault_of("short@500")
    ('short@500:60', 'power@7+3', None)
    """
    match = FAULT.fullmatch(text.strip())
    if match is None:
        return None
    if match["kind"] not in set(Trouble):
        return None
    trouble, step = Trouble(match["kind"]), int(match["step"])
    sign, value = match["sign"], match["value"]
    if trouble is Trouble.SHORT:
        good = sign == ":" and value != "thread" and int(value) > 0
        return Fault(trouble, step, length=int(value)) if good else None
    if trouble is Trouble.BREAK:
        if sign == "+" or value == "0":
            return None
        block = None if value in (None, "thread") else int(value)
        return Fault(trouble, step, block=block)
    if sign == ":" or value == "thread" or (sign and trouble is not Trouble.POWER):
        return None
    return Fault(trouble, step, pulses=int(value or 0))


@dataclass(frozen=True, slots=True)
class Scenario:
    """What happens in one run.

    Attributes:
        faults: in the order of their steps; of one step in the order in which they were stated.
        feeds: (step, feed in steps a second) from which step on the generator's feed signal has
            another frequency, ascending.
    """

    faults: tuple[Fault, ...] = ()
    feeds: tuple[tuple[int, float], ...] = ()


def scenario_of(faults: Iterable[Fault], feeds: Iterable[tuple[int, float]] = ()) -> Scenario:
    """Return a scenario of faults and feeds in any order."""
    return Scenario(
        tuple(sorted(faults, key=lambda fault: fault.step)),
        tuple(sorted(feeds)),
    )


def drawn(
    seed: int,
    count: int,
    route: Route,
    troubles: Collection[Trouble] = (Trouble.SHORT, Trouble.BREAK, Trouble.POWER),
) -> tuple[Fault, ...]:
    """Return random faults; short circuits are free within the way back.

    The same seed, count, program and troubles give the same faults. All fall on steps that are
    cut, shorts where the wire can go back as far as they ask for; an operator clears alarms.
    """
    rng = np.random.default_rng(seed)
    cut = np.setdiff1d(1 + np.flatnonzero(~route.moves), route.threads)
    every = [one for one in Trouble if one in troubles]
    out = []
    for _ in range(count if len(cut) else 0):
        trouble = Trouble(str(rng.choice(every)))
        step = int(rng.choice(cut))
        length = int(rng.integers(1, RANDOM_LENGTH + 1))
        if trouble is Trouble.SHORT:
            free = step - last_thread(route, step)
            out.append(Fault(trouble, step, length=min(length, free)))
        else:
            out.append(Fault(trouble, step, goes_on=trouble is Trouble.LIMIT))
    return tuple(out)


def last_thread(route: Route, step: int) -> int:
    """Return the place of the last thread point that a path has passed at a step."""
    return int(route.threads[np.searchsorted(route.threads, step, side="right") - 1])

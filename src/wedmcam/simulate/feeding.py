"""A servo on a path: where the wire goes forward and back between two places, as legs with times.

The law of the servo owns its ways back. The controller's own retreat (100 steps of the ZD-065, 256
of the NBY-15) is their end: so far behind the place that the wire had come to, at the last thread
point, or where the generator was switched on, it stops with an alarm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from wedmcam.diag.run import WrongUse
from wedmcam.simulate.gap import Gap, Workpiece
from wedmcam.simulate.laws import LAWS, Law
from wedmcam.simulate.process import Leg, Turn, Way
from wedmcam.simulate.runs import AtOnce, Draw
from wedmcam.simulate.servo import Pulse

#: Power pulses a second where none are stated [R].
PULSES_HZ = 100_000.0
#: The patent goes to near 1 MHz [S], the DEM-15 to 500 kHz [S].
MOST_HZ = 1_000_000.0


@dataclass(slots=True)
class Tally:
    """What a servo did, over a whole run.

    Attributes:
        retreats: ways back, one after another without a step between them being one.
        back: steps of them.
        longest: of them, steps.
        alarms: how often there was no room left.
        seconds: with the generator on, ways back included.
    """

    retreats: int = 0
    back: int = 0
    longest: int = 0
    alarms: int = 0
    seconds: float = 0.0


class Feeding:
    """A law, its gap, and where both are on the path.

    Attributes:
        gap: of the run.
        law: of the servo.
        tally: of the run.
    """

    def __init__(self, law: Law, gap: Gap, step_um: float = 1.0, *, attended: bool = False) -> None:
        """Begin before a program.

        Args:
            law: of the servo.
            gap: of the run.
            step_um: by how much a step of the path closes the gap.
            attended: an operator clears alarms, and cutting goes on.
        """
        self.law, self.gap, self.step_um, self.attended = law, gap, step_um, attended
        self.tally = Tally()
        self._at = self._front = self._farthest = -1
        self._waited = 0.0

    @property
    def figures(self) -> dict[str, Any]:
        """What the servo did so far, for JSON; see `Tally` and `Gap`."""
        gap, tally = self.gap, self.tally
        pulses = max(gap.pulses, 1)
        return {
            "servo": self.law.name,
            "seconds": round(tally.seconds, 6),
            "pulses": gap.pulses,
            "open_percent": round(100 * gap.counted[Pulse.OPEN] / pulses, 4),
            "short_percent": round(100 * gap.counted[Pulse.SHORT] / pulses, 4),
            "retreats": tally.retreats,
            "back_steps": tally.back,
            "longest": tally.longest,
            "alarms": tally.alarms,
            "gap_um": round(gap.mean_um, 4),
            "spread_um": round(gap.spread_um, 4),
        }

    def clear(self) -> None:
        """An operator has seen to an alarm: no chip bridges the gap any more."""
        self.gap.clear_chip()
        self.law.begin()
        self._front = self._at

    def forward(self, step: int, goal: int, floor: int, retreat: int) -> Turn:
        """Go from a place to the first arrival at another, or to an alarm.

        Args:
            step: number of the place where the wire is.
            goal: number of the place to come to.
            floor: number of the place behind which it may not go back.
            retreat: most steps back from the farthest place.
        """
        self._arrive(step)
        legs: list[Leg] = []
        growing = _Leg(Way.CUT, step)
        while step < goal:
            room = min(retreat - (self._front - step), step - floor)
            act = self.law.act(self.gap, room)
            self.tally.seconds += sum(act.seconds)
            if act.steps > 0:
                if growing.way is Way.RETREAT:
                    legs.append(growing.leg())
                    growing = _Leg(Way.CUT, step)
                step += 1
                self.gap.step(self.step_um)
                self._front = max(self._front, step)
            elif act.steps < 0:
                if growing.way is Way.CUT:
                    legs.append(growing.leg())
                    growing = _Leg(Way.RETREAT, step)
                    self.tally.retreats += 1
                step += act.steps
                for _ in range(-act.steps):
                    self.gap.step(-self.step_um)
                self.tally.back -= act.steps
                self.tally.longest = max(self.tally.longest, self._front - step)
            else:
                self.tally.alarms += 1
                self._waited += act.seconds[0]
                break
            growing.take(act.seconds, self._waited)
            self._waited = 0.0
        legs.append(growing.leg())
        self._at = step
        self._farthest = max(self._farthest, self._front)
        back = None if step == goal else self._front - step
        return Turn(tuple(leg for leg in legs if leg.steps), step, back)

    def _arrive(self, step: int) -> None:
        """Take over where the process has brought the wire since the last leg."""
        if step == self._at:
            return
        if step > self._farthest:
            self.gap.renew()
        else:
            # The slot is cut up to where it was: from here on it is so much wider.
            self.gap.step((step - self._at) * self.step_um)
        self.law.begin()
        self._at = self._front = step


class _Leg:
    """A leg that grows."""

    def __init__(self, way: Way, first: int) -> None:
        self.way, self.first = way, first
        self.seconds: list[float] = []

    def take(self, seconds: tuple[float, ...], waited: float) -> None:
        """Add steps; the first one is later by what was waited before an alarm."""
        self.seconds += (seconds[0] + waited, *seconds[1:])

    def leg(self) -> Leg:
        """Return it as it is."""
        count = len(self.seconds)
        last = self.first + (count if self.way is Way.CUT else -count)
        return Leg(self.way, self.first, last, seconds=np.array(self.seconds))


def feeding_of(
    servo: str,
    seed: int = 0,
    *,
    hz: float = PULSES_HZ,
    step_um: float = 1.0,
    piece: Workpiece | None = None,
    draw: Draw | None = None,
    attended: bool = True,
) -> Feeding:
    """Return a servo before a program.

    Args:
        servo: which law, one of `LAWS`.
        seed: of all its chance: the same one gives the same run.
        hz: power pulses a second.
        step_um: one step of the path.
        piece: the gap model; None for the usual one.
        draw: how pulses are drawn; None for many at once.
        attended: an operator clears alarms, and cutting goes on.

    Raises:
        WrongUse: no law has this name, or there are no pulses.
    """
    if servo not in LAWS:
        raise WrongUse(f"no servo is called '{servo}': {', '.join(LAWS)}")
    if not 0 < hz <= MOST_HZ:
        raise WrongUse(f"{hz:g} power pulses a second: above 0 and up to {MOST_HZ:g}")
    gap = Gap(piece or Workpiece(), np.random.default_rng(seed))
    return Feeding(LAWS[servo](draw or AtOnce(), hz, step_um), gap, step_um, attended=attended)

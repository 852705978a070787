"""Three laws by which a wire is fed, each against the same gap: what it reads, and what it does.

* `PatentLaw`: the circuit of `servo`: a step forward, or N back, by counted pulses.
* `EindhovenLaw`: the microcomputer of the DEM-15 reads from its counters how many of 255 pulses
  were short circuits and how many open [S], so it is late by 255 t(p) [S]; it adapts the cutting
  speed so that both become few [S]. The loop was left to be written: ours is an integrating
  controller with limits and a proportional part, without which it swings, as the gap integrates
  too [R].
* `FeedLaw`: the generator of a ZD-065 gives a signal for each step, the faster the higher the mean
  voltage of the gap; short-circuited it gives none, and the controller goes back, at most 100 um,
  until the signal returns [S]. Voltages, frequencies and the generator's smoothing are [R].

A law says what the motors do next, and how long it takes; it knows nothing of the path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.eindhoven.counters import CYCLE, PulseCounters
from wedmcam.simulate.gap import Counts, Gap
from wedmcam.simulate.runs import Draw
from wedmcam.simulate.servo import Counters, Settings, retract_times

Floats = NDArray[np.float64]

#: One unit of its speed, um/s, and the largest of its 7 bits [D].
SPEED_UNIT_UM = 0.2625
FASTEST_UNITS = 127


class Act(NamedTuple):
    """What the motors do next.

    Attributes:
        steps: of the path, forward or back; 0 where the law wants back and there is no room.
        seconds: how long each of them takes, the wait before it included.
    """

    steps: int
    seconds: tuple[float, ...]


class Law(Protocol):
    """How a wire is fed.

    Attributes:
        name: as it is written on the command line.
    """

    name: str

    def begin(self) -> None:
        """Begin anew: a wire was threaded, or an alarm cleared."""
        ...

    def act(self, gap: Gap, room: int) -> Act:
        """Let pulses pass until the motors do something.

        Args:
            gap: of the run; it is told of pulses, and of steps by the caller.
            room: steps that it may go back.
        """
        ...


class PatentLaw:
    """Counters and retract ramp; the drive makes one step in ``step_s`` at most [R]."""

    name = "patent"

    def __init__(
        self, draw: Draw, hz: float, settings: Settings | None = None, step_s: float = 0.001
    ) -> None:
        """Set the servo.

        Args:
            draw: how pulses are drawn.
            hz: power pulses a second.
            settings: of the counters and the ramp.
            step_s: shortest time of a step, s; pulses go on meanwhile, and are not counted.
        """
        self.draw, self.hz = draw, hz
        self.settings = settings or Settings()
        self.counters = Counters(self.settings)
        self._blind = round(step_s * hz)
        self._stepped = False

    def begin(self) -> None:
        """Set the counters to 0."""
        self.counters.clear()
        self._stepped = False

    def act(self, gap: Gap, room: int) -> Act:
        """Count pulses up to a signal."""
        before = gap.pulses
        if self._stepped and self._blind:
            self.draw.exactly(gap, self._blind)
        signal = self.draw.until_signal(gap, self.counters)
        self._stepped = signal > 0
        wait = (gap.pulses - before) / self.hz
        if signal > 0:
            return Act(1, (wait,))
        steps = min(self.settings.steps, room)
        if not steps:
            return Act(0, (wait,))
        times = retract_times(self.settings, steps)
        gap.idle(float(times[-1]) * self.hz)
        seconds = np.diff(times, prepend=0.0)
        seconds[0] += wait
        return Act(-steps, tuple(seconds.tolist()))


class _WindowLaw:
    """A law that sees pulses by the window: each gives a speed, steps a second; below 0 it is back.

    Steps fall on the ends of windows; what is left of a step goes on into the next window.
    """

    def __init__(self, draw: Draw, hz: float, window: int) -> None:
        self.draw, self.hz, self.window = draw, hz, window
        self._part = 0.0

    def speed(self, counts: Counts) -> float:
        """Return the speed behind a window, steps a second."""
        raise NotImplementedError

    def begin(self) -> None:
        """Forget what is left of a step."""
        self._part = 0.0

    def act(self, gap: Gap, room: int) -> Act:
        """Watch windows until a step is due."""
        seconds, each = 0.0, self.window / self.hz
        while True:
            speed = self.speed(self.draw.exactly(gap, self.window))
            seconds += each
            if speed < 0 < self._part or speed > 0 > self._part:
                self._part = 0.0
            self._part += speed * each
            if self._part >= 1:
                self._part -= 1
                return Act(1, (seconds,))
            if self._part <= -1:
                self._part += 1
                return Act(-1 if room else 0, (seconds,))


@dataclass(frozen=True, slots=True)
class EindhovenSettings:
    """How the loop is set, all [R].

    Attributes:
        gain: um/s for a share of 1 more open pulses than shorts.
        integral: um/s, likewise, each second.
        first: speed at the beginning, units.
        short_share: of a window: from there on the wire is short-circuited and goes back.
        back: steps a second of a way back.
        step_um: one step of the path.
    """

    gain: float = 60.0
    integral: float = 20.0
    first: int = 40
    short_share: float = 0.5
    back: float = 200.0
    step_um: float = 1.0


class EindhovenLaw(_WindowLaw):
    """255 pulses at a time, as much as the speed asks for in whole units, 1 to 127."""

    name = "eindhoven"

    def __init__(self, draw: Draw, hz: float, settings: EindhovenSettings | None = None) -> None:
        """Set the loop.

        Args:
            draw: how pulses are drawn.
            hz: power pulses a second.
            settings: of the loop.
        """
        super().__init__(draw, hz, CYCLE)
        self.settings = settings or EindhovenSettings()
        self.counters = PulseCounters()
        self._held = self.settings.first * SPEED_UNIT_UM

    def begin(self) -> None:
        """Go on with the first speed."""
        super().begin()
        self._held = self.settings.first * SPEED_UNIT_UM

    def speed(self, counts: Counts) -> float:
        """Return the speed that the controller sets after it read both counters."""
        s = self.settings
        full = self.counters.counted(CYCLE, counts.short, counts.open)
        read, shorts = full.read_sc()
        self.counters, opens = read.read_op()
        if shorts >= s.short_share * self.window:
            return -s.back
        error = (opens - shorts) / self.window
        most = FASTEST_UNITS * SPEED_UNIT_UM
        self._held += s.integral * error * self.window / self.hz
        self._held = min(max(self._held, SPEED_UNIT_UM), most)
        units = round((self._held + s.gain * error) / SPEED_UNIT_UM)
        return min(max(units, 1), FASTEST_UNITS) * SPEED_UNIT_UM / s.step_um


@dataclass(frozen=True, slots=True)
class FeedSettings:
    """The generator's feed signal, all [R]; voltages are shares of that of an open gap.

    Attributes:
        window: pulses over which the voltage is taken at a time.
        smooth: share of a window in the mean voltage.
        burning: voltage of a discharge.
        late: of a delayed one: it is high before it ignites.
        begins: mean voltage from which on there is a signal.
        slope: um/s for a voltage of 1 more.
        none: mean voltage below which the signal has failed: a short circuit.
        back: steps a second of a way back.
        step_um: one step of the path.
    """

    window: int = 250
    smooth: float = 0.2
    burning: float = 0.25
    late: float = 0.6
    begins: float = 0.25
    slope: float = 120.0
    none: float = 0.12
    back: float = 200.0
    step_um: float = 1.0


class FeedLaw(_WindowLaw):
    """A mean voltage and an oscillator."""

    name = "feed"

    def __init__(self, draw: Draw, hz: float, settings: FeedSettings | None = None) -> None:
        """Set the generator.

        Args:
            draw: how pulses are drawn.
            hz: power pulses a second.
            settings: of the signal.
        """
        self.settings = settings or FeedSettings()
        super().__init__(draw, hz, self.settings.window)
        self._voltage = 1.0

    def begin(self) -> None:
        """Begin with an open gap."""
        super().begin()
        self._voltage = 1.0

    def speed(self, counts: Counts) -> float:
        """Return the frequency of the feed signal; where there is none, that of the way back."""
        s = self.settings
        sum_ = counts.open + s.burning * counts.discharge + s.late * counts.delayed
        self._voltage += s.smooth * (sum_ / self.window - self._voltage)
        if self._voltage < s.none:
            return -s.back
        return max(self._voltage - s.begins, 0.0) * s.slope / s.step_um


#: What `--servo` takes: a law for a way to draw pulses, pulses a second, and um a step.
LAWS: dict[str, Callable[[Draw, float, float], Law]] = {
    PatentLaw.name: lambda draw, hz, step_um: PatentLaw(draw, hz),
    EindhovenLaw.name: lambda draw, hz, step_um: EindhovenLaw(
        draw, hz, EindhovenSettings(step_um=step_um)
    ),
    FeedLaw.name: lambda draw, hz, step_um: FeedLaw(draw, hz, FeedSettings(step_um=step_um)),
}

"""The digital gap servo of DE 2243742 A1 (US 3694599), part by part: it reads the gap by pulses.

Two detectors watch every power pulse, one its voltage, one its current. Counter A counts pulses
without current (the gap is open), counter B pulses without voltage (a short circuit). A at its
setting is one advance step; B at its setting switches the pulses off and retracts by N steps on a
ramp [S]. So a gap that corrects itself within a few pulses is left alone.

In its figure 4 a discharge resets both counters, and a delayed discharge is seen by both detectors
one after the other: A counts it and is reset by its late current, which leaves B at 1; the gates of
the text let only pulses of one detector alone reset: the figure wins [D]. So by itself a delayed
discharge never corrects, but it counts: one and B - 1 shorts retract, A - 1 opens and one advance
[D]. A counter starts again at 0 after it fired [R].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: A counter set to 1 would fire on one delayed discharge. Typical settings are 3 to 8 for the
#: advance and 3 to 10 for the retract; 4 to 6 for either, near 1 MHz 8 to 10 [S].
LEAST_SETTING = 2


class Pulse(IntEnum):
    """What became of a power pulse."""

    OPEN = 0  # voltage, and no current
    DISCHARGE = 1  # both
    DELAYED = 2  # voltage first, the current later in the pulse
    SHORT = 3  # current, and no voltage


@dataclass(frozen=True, slots=True)
class Wave:
    """One pulse at the gap, as the two curves of the figure show it.

    Attributes:
        voltage: V across the gap, at equal times of the pulse.
        current: A through it, at the same times.
    """

    voltage: tuple[float, ...]
    current: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Detectors:
    """The comparators: from which level on a voltage or a current is one.

    Attributes:
        volts, amperes: the levels; the patent leaves both to a potentiometer.
    """

    volts: float = 10.0
    amperes: float = 1.0

    def edges(self, wave: Wave) -> tuple[tuple[bool, bool], ...]:
        """Return the detector pulses (voltage, current) that a power pulse raises, in their order.

        A detector gives one short pulse when its comparator switches over. A voltage that comes
        with the current, or breaks down to the burning voltage, is one discharge: both at once.
        """
        volts = _first(wave.voltage, self.volts)
        amperes = _first(wave.current, self.amperes)
        if volts is not None and amperes is not None and amperes > volts:
            return ((True, False), (False, True))
        return ((volts is not None, amperes is not None),)

    def see(self, wave: Wave) -> Pulse | None:
        """Return what became of a pulse; None where there was none: the pulses are off."""
        seen = self.edges(wave)
        if len(seen) == 2:
            return Pulse.DELAYED
        return _SEEN[seen[0]]


_SEEN = {
    (True, False): Pulse.OPEN,
    (True, True): Pulse.DISCHARGE,
    (False, True): Pulse.SHORT,
    (False, False): None,
}


def _first(curve: tuple[float, ...], level: float) -> int | None:
    """Return when a curve comes to a level."""
    return next((k for k, value in enumerate(curve) if value >= level), None)


@dataclass(frozen=True, slots=True)
class Settings:
    """How the servo is set.

    Attributes:
        advance: pulses without current in a row for one step forward.
        retract: pulses without voltage in a row for a retract.
        steps: of a retract, N: even.
        slope: of the ramp, steps a second each second: as steep as the drive allows.
        lowest: frequency at which the ramp begins and ends, steps a second.
    """

    advance: int = 4
    retract: int = 4
    steps: int = 20
    slope: float = 20_000.0
    lowest: float = 50.0

    def __post_init__(self) -> None:
        """Refuse what would correct a single delayed discharge, or lose a step.

        Raises:
            ValueError: a setting below 2, an odd N, or a ramp that does not begin.
        """
        if min(self.advance, self.retract) < LEAST_SETTING:
            raise ValueError("a counter set to 1 would act on one delayed discharge")
        if self.steps < 2 or self.steps % 2:
            raise ValueError("a retract has an even number of steps: it brakes as it speeds up")
        if not (self.slope > 0 and self.lowest > 0):
            raise ValueError("slope and lowest frequency of the ramp are above 0")


class Counters:
    """Counters A and B with their settings and resets."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.a = 0
        self.b = 0

    def clear(self) -> None:
        """Begin anew."""
        self.a = self.b = 0

    def take(self, pulse: Pulse) -> int:
        """Count a pulse; return +1 for the advance signal, -1 for the retract signal, else 0."""
        if pulse is Pulse.OPEN:
            return self.detect(True, False)
        if pulse is Pulse.SHORT:
            return self.detect(False, True)
        if pulse is Pulse.DISCHARGE:
            return self.detect(True, True)
        # Its voltage may be the last pulse that A waits for; the late current comes all the same.
        signal = self.detect(True, False)
        return self.detect(False, True) or signal

    def detect(self, voltage: bool, current: bool) -> int:
        """Take the pulses of the detectors that come at one time."""
        if voltage and current:
            self.clear()
        elif voltage:
            self.a, self.b = self.a + 1, 0
        elif current:
            self.a, self.b = 0, self.b + 1
        if self.a == self.settings.advance:
            self.a = 0
            return 1
        if self.b == self.settings.retract:
            self.b = 0
            return -1
        return 0


class Control:
    """The servo behind its counters: direction flip-flop, retract ramp, and the pulses' switch.

    Attributes:
        forward: the direction flip-flop: it holds until the other signal comes.
        powered: whether the pulses are on; off while it retracts.
        place: steps, net.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.counters = Counters(settings)
        self.forward = True
        self.powered = True
        self.place = 0
        self._times = retract_times(settings)
        self._made = 0

    def pulse(self, pulse: Pulse) -> int:
        """Take a power pulse; return the signal, +1 advance, -1 retract, or 0.

        While it retracts there are no pulses: one that comes all the same is a fault of the caller.
        """
        assert self.powered, "the pulses are off"
        signal = self.counters.take(pulse)
        if signal > 0:
            self.forward = True
            self.place += 1
        elif signal < 0:
            self.forward, self.powered, self._made = False, False, 0
        return signal

    def wait(self, seconds: float) -> int:
        """Let time pass from the retract signal on; return the steps that were made by then."""
        if self.powered:
            return 0
        made = int(np.searchsorted(self._times, seconds, side="right"))
        self.place -= made - self._made
        self._made = made
        if made == self.settings.steps:
            self.powered = True
        return made


def retract_times(settings: Settings, steps: int | None = None) -> Floats:
    """Return when the steps of a retract are made, s from its signal.

    The oscillator follows the integrator: its frequency grows from the lowest one by the slope up
    to step N / 2, and falls by the same slope to step N [S]. The phase is the integral of the
    frequency, and a step is made whenever it is a whole number.

    Args:
        settings: of the servo.
        steps: fewer than N, where the path behind is shorter; an odd one has its middle step at the
            top of the ramp.
    """
    n = settings.steps if steps is None else steps
    low, slope = settings.lowest, settings.slope

    def rise(phase: Floats | float) -> Floats:
        root = np.sqrt(low * low + 2 * slope * np.asarray(phase, dtype=np.float64))
        out: Floats = (root - low) / slope
        return out

    k = np.arange(1, n + 1, dtype=np.float64)
    whole = 2 * float(rise(n / 2))
    return np.where(k <= n / 2, rise(np.minimum(k, n / 2)), whole - rise(np.maximum(n - k, 0)))


def ramp_in_ticks(
    n: int, slope: float, lowest: float, tick: float, most: float = 10.0
) -> list[float]:
    """Return when the steps of a retract are made by an integrator and an oscillator in ticks, s.

    The literal circuit, of which `retract_times` is the closed form. With a lowest frequency of 0,
    or an odd N, it stops before step N: the frequency is 0 before the last step is made.

    Args:
        n: steps of the retract.
        slope: of the ramp, steps a second each second.
        lowest: frequency below which it does not fall, steps a second.
        tick: s.
        most: s after which it is given up.
    """
    times: list[float] = []
    frequency, phase = lowest, 0.0
    for k in range(1, math.ceil(most / tick)):
        up = len(times) < n // 2
        frequency += slope * tick if up else -slope * tick
        frequency = max(frequency, lowest)
        if frequency <= 0:
            break
        phase += frequency * tick
        while phase >= 1.0 and len(times) < n:
            phase -= 1.0
            times.append(k * tick)
        if len(times) == n:
            break
    return times

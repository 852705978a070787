"""Many pulses drawn at once, with the distribution of pulses drawn one by one.

While the chances hold, pulses are independent. Every discharge sets the counters of the servo to a
known state: A to 0, B to 0, or to 1 if it was a delayed one. So the pulses fall into stretches of
opens and shorts that begin with one of two states and end with a discharge, or with a signal.
Which kind of discharge ends a stretch does not depend on the stretch, so the pairs (discharge,
stretch behind it) are independent of each other: the number of the first pair that something
follows from is geometric, and the pairs before it are one multinomial draw over all stretches there
can be. Something follows from a signal, and from a ripe stretch, one at whose end A waits for one
pulse more: there a delayed discharge advances. Stretches of less than 1e-15 are left out.

`one_by_one` of `gap` is the reference; tests prove both equal.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wedmcam.simulate.gap import Chances, Counts, Gap, one_by_one
from wedmcam.simulate.servo import Counters, Pulse

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Chance of what tables leave out.
LEFT_OUT = 1e-15
#: What ends a stretch besides a signal: a discharge that advances if it is a delayed one.
RIPE = 2
#: Where more than this share of pulses is open or short, stretches are long and a signal is near:
#: pulses are drawn one by one.
MOST_IDLE = 0.5


#: Chance, counts by kind of pulse, and what follows.
_Row = tuple[float, tuple[int, int, int, int], int]


class Draw(Protocol):
    """A way to draw pulses: `AtOnce` or `OneByOne`."""

    def until_signal(self, gap: Gap, counters: Counters) -> int:
        """Draw pulses up to a signal of the counters: +1 advance, -1 retract."""
        ...

    def exactly(self, gap: Gap, pulses: int) -> Counts:
        """Draw so many pulses."""
        ...


class OneByOne:
    """The reference: pulse by pulse, through the circuit."""

    def until_signal(self, gap: Gap, counters: Counters) -> int:
        """Draw pulses up to a signal of the counters: +1 advance, -1 retract."""
        for pulse in one_by_one(gap):
            signal = counters.take(pulse)
            if signal:
                return signal
        raise AssertionError

    def exactly(self, gap: Gap, pulses: int) -> Counts:
        """Draw so many pulses."""
        counts = [0, 0, 0, 0]
        for _, pulse in zip(range(pulses), one_by_one(gap), strict=False):
            counts[pulse] += 1
        return Counts(*counts)


class AtOnce:
    """Hundreds of pulses with a few draws."""

    def until_signal(self, gap: Gap, counters: Counters) -> int:
        """Draw pulses up to a signal of the counters: +1 advance, -1 retract.

        Args:
            gap: of the run.
            counters: as a signal or a discharge left them.
        """
        settings = counters.settings
        signal = 0
        while not signal:
            chances = gap.chances
            if chances.open + chances.short > MOST_IDLE or counters.a or counters.b > 1:
                signal = _one_stretch(gap, counters)
            else:
                table = table_of(chances, settings.advance, settings.retract)
                signal = _stretch(gap, counters, table)
        return signal

    def exactly(self, gap: Gap, pulses: int) -> Counts:
        """Draw so many pulses."""
        counts = _part(gap, pulses)
        gap.take(counts)
        left = pulses - sum(counts)
        while left:
            more = _part(gap, left)
            gap.take(more)
            _add(counts, more)
            left -= sum(more)
        return Counts(*counts)


def _part(gap: Gap, most: int) -> list[int]:
    """Return counts of pulses up to the next change of the chances, or of as many as wanted."""
    rng, chances, left = gap.rng, gap.chances, gap.left
    if most < left:
        counts: list[int] = rng.multinomial(most, chances).tolist()
        return counts
    spark = chances.discharge + chances.delayed
    until = left + int(rng.negative_binomial(left, spark)) if spark > 0 else most + 1
    if until <= most:
        sparks = left
    else:
        # Fewer discharges than are left fell among them: drawn again until it is so, which on
        # average, over all calls, is once.
        until = most
        sparks = int(rng.binomial(most, spark))
        while sparks >= left:
            sparks = int(rng.binomial(most, spark))
    delayed = int(rng.binomial(sparks, chances.delayed / spark)) if sparks else 0
    idle = until - sparks
    opened = int(rng.binomial(idle, chances.open / (chances.open + chances.short))) if idle else 0
    return [opened, sparks - delayed, delayed, idle - opened]


@dataclass(frozen=True, slots=True, eq=False)
class _Sums:
    """What one of several things may be: opens, discharges, delayed and shorts of each.

    Attributes:
        chance: of each, the likeliest first.
        below: of each, the chance of it and those before it.
        counts: of each, shape (n, 4).
        kinds: of each, the signal with which it ends, 0, or `RIPE`.
    """

    chance: Floats
    below: list[float]
    counts: Ints
    kinds: list[int]

    def one(self, rng: np.random.Generator) -> tuple[list[int], int]:
        """Draw one; return its counts and its signal."""
        k = min(bisect_left(self.below, rng.random()), len(self.kinds) - 1)
        return self.counts[k].tolist(), self.kinds[k]

    def many(self, rng: np.random.Generator, n: int) -> list[int]:
        """Draw n; return their counts together."""
        out: list[int] = (rng.multinomial(n, self.chance) @ self.counts).tolist()
        return out


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """What may follow while chances hold; see the module.

    Attributes:
        signals: chance that a stretch ends with a signal, or ripe, by the counter B with which it
            begins.
        quiet: stretches that do not, likewise.
        loud: those that do, likewise.
        pair_signals: the same chance of the stretch behind a discharge.
        quiet_pairs, loud_pairs: discharges with the stretch behind them.
        delayed: chance that a discharge is a delayed one.
    """

    signals: tuple[float, float]
    quiet: tuple[_Sums, _Sums]
    loud: tuple[_Sums, _Sums]
    pair_signals: float
    quiet_pairs: _Sums
    loud_pairs: _Sums
    delayed: float


def _stretch(gap: Gap, counters: Counters, table: Table) -> int:
    """Draw pulses up to a signal, or to a discharge behind which all begins anew."""
    rng, start, left = gap.rng, counters.b, gap.left
    kind = 0
    if rng.random() < table.signals[start]:
        counts, kind = table.loud[start].one(rng)
    else:
        counts, _ = table.quiet[start].one(rng)
        first = _geometric(rng.random(), table.pair_signals)
        pairs = int(min(first, left)) - 1
        if pairs:
            _add(counts, table.quiet_pairs.many(rng, pairs))
        if first < left:
            last, kind = table.loud_pairs.one(rng)
            _add(counts, last)
    counters.clear()
    if kind in (0, RIPE):
        delayed = rng.random() < table.delayed
        counts[Pulse.DELAYED if delayed else Pulse.DISCHARGE] += 1
        counters.b = int(delayed)
        kind = int(kind == RIPE and delayed)
    gap.take(counts)
    return kind


def _add(counts: list[int], more: list[int]) -> None:
    for k, count in enumerate(more):
        counts[k] += count


def _one_stretch(gap: Gap, counters: Counters) -> int:
    """Draw pulses one by one up to a signal, or a discharge."""
    for pulse in one_by_one(gap):
        signal = counters.take(pulse)
        if signal or pulse in (Pulse.DISCHARGE, Pulse.DELAYED):
            return signal
    raise AssertionError


def _geometric(draw: float, chance: float) -> float:
    """Return the number, from 1 on, of the first of many that has something of a chance."""
    if chance <= 0:
        return math.inf
    if chance >= 1:
        return 1
    return 1 + math.floor(math.log1p(-draw) / math.log1p(-chance))


@lru_cache(maxsize=20_000)
def table_of(chances: Chances, advance: int, retract: int) -> Table:
    """Return what may follow while chances hold.

    Args:
        chances: of a pulse; opens and shorts together are at most `MOST_IDLE`.
        advance, retract: settings of the counters.
    """
    spark = chances.discharge + chances.delayed
    late = chances.delayed / spark
    share = (1 - late, late)
    quiet: list[list[_Row]] = [[], []]
    loud: list[list[_Row]] = [[], []]
    for begin, opens, shorts, chance, kind in _stretches(chances, advance, retract):
        rows = loud if kind else quiet
        ends = spark if kind in (0, RIPE) else 1.0
        rows[begin].append((chance * ends, (opens, 0, 0, shorts), kind))
    quiet_pairs, loud_pairs = (
        [
            (share[b] * chance, (opened, 1 - b, b, short), kind)
            for b in range(2)
            for chance, (opened, _, _, short), kind in rows[b]
        ]
        for rows in (quiet, loud)
    )
    signals = [sum(chance for chance, _, _ in rows) for rows in loud]
    return Table(
        signals=(signals[0], signals[1]),
        quiet=(_sums(quiet[0]), _sums(quiet[1])),
        loud=(_sums(loud[0]), _sums(loud[1])),
        pair_signals=share[0] * signals[0] + share[1] * signals[1],
        quiet_pairs=_sums(quiet_pairs),
        loud_pairs=_sums(loud_pairs),
        delayed=late,
    )


def _stretches(
    chances: Chances, advance: int, retract: int
) -> Iterator[tuple[int, int, int, float, int]]:
    """Yield (B at the beginning, opens, shorts, chance, kind) of every stretch there can be.

    Those without a signal may go on: their chance is that they come so far.
    """
    # Counter states: 0 is both at 0, then A = 1, 2, ..., then B = 1, 2, ...
    first_b = advance
    states = advance + retract - 1
    length = 1
    idle = chances.open + chances.short
    if idle > 0:
        length += math.ceil(math.log(LEFT_OUT) / math.log(idle))
    for begin in range(2):
        # Rows are states, columns the number of opens so far.
        at = np.zeros((states, length + 2))
        at[first_b if begin else 0, 0] = 1.0
        for made in range(length + 1):
            for opens in np.flatnonzero(at.sum(axis=0)).tolist():
                ripe = float(at[first_b - 1, opens])
                yield begin, opens, made - opens, max(float(at[:, opens].sum()) - ripe, 0.0), 0
                yield begin, opens, made - opens, ripe, RIPE
            behind = np.zeros_like(at)
            opened, shorted = at * chances.open, at * chances.short
            behind[2:first_b, 1:] = opened[1 : first_b - 1, :-1]
            behind[1, 1:] = opened[0, :-1] + opened[first_b:, :-1].sum(axis=0)
            behind[first_b] = shorted[:first_b].sum(axis=0)
            behind[first_b + 1 :] = shorted[first_b:-1]
            for signal, row in ((1, opened[first_b - 1]), (-1, shorted[-1])):
                for k in np.flatnonzero(row).tolist():
                    opens = k + (signal > 0)
                    yield begin, opens, made + 1 - opens, float(row[k]), signal
            at = behind


def _sums(rows: list[_Row]) -> _Sums:
    """Return things with their chances, the likeliest first, scaled to 1."""
    rows = sorted(rows, key=lambda row: -row[0])
    chance = np.array([row[0] for row in rows], dtype=np.float64)
    total = float(chance.sum())
    if total <= 0:
        return _Sums(np.ones(1), [1.0], np.zeros((1, 4), np.int64), [0])
    below = np.cumsum(chance / total)
    keep = int(np.searchsorted(below, 1 - LEFT_OUT)) + 1
    rows, chance = rows[:keep], chance[:keep]
    chance = chance / chance.sum()
    counts = np.array([row[1] for row in rows], dtype=np.int64)
    return _Sums(chance, np.cumsum(chance).tolist(), counts, [row[2] for row in rows])

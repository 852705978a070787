"""Pulses drawn at once have the distribution of pulses drawn one by one, by the circuit."""

import itertools
from collections import defaultdict

import numpy as np
import pytest

from wedmcam.simulate.gap import Chances, Gap, Workpiece, chances, one_by_one
from wedmcam.simulate.laws import LAWS, PatentLaw
from wedmcam.simulate.runs import RIPE, AtOnce, OneByOne, _stretches, table_of
from wedmcam.simulate.servo import Control, Counters, Pulse, Settings, retract_times

CHANCES = [
    Chances(0.2, 0.3, 0.4, 0.1),
    Chances(0.05, 0.9, 0.05, 0.0),
    Chances(0.0, 0.6, 0.1, 0.3),
    Chances(0.3, 0.0, 0.6, 0.1),
]


def stretches_by_hand(p, settings, begin, longest):
    """Return (opens, shorts, kind) -> chance of every stretch, by trying each row of pulses."""
    out = defaultdict(float)
    for length in range(longest + 1):
        for row in itertools.product((Pulse.OPEN, Pulse.SHORT), repeat=length):
            counters = Counters(settings)
            counters.b = begin
            signals = [counters.take(pulse) for pulse in row]
            if any(signals[:-1]):
                continue
            chance = float(np.prod([p[pulse] for pulse in row]))
            opens = sum(pulse is Pulse.OPEN for pulse in row)
            kind = signals[-1] if signals else 0
            if not kind and counters.a == settings.advance - 1:
                kind = RIPE
            out[opens, length - opens, kind] += chance
    return out


@pytest.mark.parametrize("p", CHANCES)
@pytest.mark.parametrize("settings", [Settings(2, 2), Settings(4, 4), Settings(3, 5)])
def test_stretches_have_the_chances_of_all_rows_of_pulses(p, settings):
    for begin in range(2):
        by_hand = stretches_by_hand(p, settings, begin, 8)
        seen = defaultdict(float)
        for start, opens, shorts, chance, kind in _stretches(p, settings.advance, settings.retract):
            if start == begin and opens + shorts <= 8:
                seen[opens, shorts, kind] += chance
        for key in {*by_hand, *seen}:
            assert seen[key] == pytest.approx(by_hand[key], abs=1e-15)


def mean_by_hand(p, settings):
    """Return the mean number of pulses up to a signal, and the chance that it is an advance.

    By the linear equations of the chain whose states are those of the counters.
    """
    states = [(a, 0) for a in range(settings.advance)]
    states += [(0, b) for b in range(1, settings.retract)]
    number = {state: k for k, state in enumerate(states)}
    matrix, advance = np.eye(len(states)), np.zeros(len(states))
    for (a, b), k in number.items():
        for pulse in Pulse:
            counters = Counters(settings)
            counters.a, counters.b = a, b
            signal = counters.take(pulse)
            if signal:
                advance[k] += p[pulse] * (signal > 0)
            else:
                matrix[k, number[counters.a, counters.b]] -= p[pulse]
    return np.linalg.solve(matrix, np.ones(len(states)))[0], np.linalg.solve(matrix, advance)[0]


class Steady(Gap):
    """A gap whose chances never change; with a short hold they are looked up often all the same."""

    def __init__(self, p, hold, rng):
        self.steady = p
        super().__init__(Workpiece(hold=hold, chip=0.0), rng)

    def _look_up(self):
        super()._look_up()
        self.chances = self.steady


@pytest.mark.parametrize("p", CHANCES)
@pytest.mark.parametrize("settings", [Settings(2, 2), Settings(4, 4), Settings(3, 5)])
@pytest.mark.parametrize("hold", [10**9, 7])
def test_the_mean_way_to_a_signal_is_that_of_the_chain(p, settings, hold):
    """With 7 discharges to a draw too: drawing in parts changes nothing."""
    mean, ahead = mean_by_hand(p, settings)
    gap = Steady(p, hold, np.random.default_rng(5))
    counts, signals = [], []
    for _ in range(2000 if mean < 1000 or hold > 100 else 5):
        counters, before = Counters(settings), gap.pulses
        signals.append(AtOnce().until_signal(gap, counters))
        counts.append(gap.pulses - before)
    counts, signals = np.array(counts), np.array(signals)
    assert abs(counts.mean() - mean) < 4 * counts.std() / np.sqrt(len(counts))
    most = 4 * np.sqrt(max(ahead * (1 - ahead), 0.0) / len(signals))
    assert np.mean(signals > 0) == pytest.approx(ahead, abs=most + 1e-9)


def apart(a, b):
    """Return the two-sample statistic of Kolmogorov and Smirnov; 1.95 is one in a thousand."""
    a, b = np.sort(a), np.sort(b)
    every = np.concatenate([a, b])
    below = [np.searchsorted(x, every, side="right") / len(x) for x in (a, b)]
    return np.abs(below[0] - below[1]).max() * np.sqrt(len(a) * len(b) / (len(a) + len(b)))


#: A gap on which everything changes fast: chips, dirt, cells of the gap.
LIVELY = Workpiece(
    start_um=12.0, unit_um=1 / 60, hold=8, chip=1 / 400, memory=100.0, open_um=14.0, late_um=12.0
)


def run_of(draw, law, seed, steps):
    """Return what is left of a gap behind some acts of a law."""
    gap = Gap(LIVELY, np.random.default_rng(seed))
    servo = LAWS[law](draw, 1e5, 1.0)
    back = 0
    for _ in range(steps):
        act = servo.act(gap, 100)
        back += act.steps < 0
        for _ in range(abs(act.steps)):
            gap.step(np.sign(act.steps))
    return [gap.um, gap.pulses, *gap.counted, gap.debris, back]


@pytest.mark.parametrize(("law", "steps", "runs"), [("patent", 8, 150), ("feed", 3, 150)])
def test_a_lively_gap_runs_alike_at_once_and_one_by_one(law, steps, runs):
    at_once = np.array([run_of(AtOnce(), law, seed, steps) for seed in range(4 * runs)])
    single = np.array([run_of(OneByOne(), law, 10_000 + seed, steps) for seed in range(runs)])
    for k in range(at_once.shape[1]):
        assert apart(at_once[:, k], single[:, k]) < 1.95, k


def test_the_law_of_the_patent_is_its_circuit():
    """Pulse for pulse with the same chance: counters, flip-flop, ramp, and pulses off meanwhile."""
    setting = Settings(advance=3, retract=3, steps=6)
    gap, twin = (Gap(LIVELY, np.random.default_rng(4)) for _ in range(2))
    law, control = PatentLaw(OneByOne(), 1e5, setting, step_s=0.0), Control(setting)
    whole = float(retract_times(setting)[-1])
    place = 0
    for _ in range(300):
        act = law.act(gap, 100)
        place += act.steps
        for _ in range(abs(act.steps)):
            gap.step(np.sign(act.steps))
        pulses = one_by_one(twin)
        while not (signal := control.pulse(next(pulses))):
            pass
        assert control.forward == (signal > 0) == (act.steps > 0)
        if signal < 0:
            assert not control.powered
            twin.idle(whole * 1e5)
            assert control.wait(whole) == setting.steps
        for _ in range(abs(act.steps)):
            twin.step(signal)
        assert control.place == place
        assert (twin.um, twin.pulses, twin.counted) == (gap.um, gap.pulses, gap.counted)
        assert sum(act.seconds) >= whole * (signal < 0)


def test_so_many_pulses_at_once_are_those_one_by_one():
    rows = []
    for draw, first, runs in ((AtOnce(), 0, 3000), (OneByOne(), 10_000, 600)):
        rows.append([])
        for seed in range(runs):
            gap = Gap(LIVELY, np.random.default_rng(first + seed))
            counts = draw.exactly(gap, 137)
            assert sum(counts) == 137 == gap.pulses
            rows[-1].append([gap.um, *counts, gap.debris])
    at_once, single = map(np.array, rows)
    for k in range(at_once.shape[1]):
        assert apart(at_once[:, k], single[:, k]) < 1.95, k


def test_a_pulse_has_eroded_when_the_next_one_is_drawn():
    gap = Gap(Workpiece(start_um=10.0, chip=0.0), np.random.default_rng(1))
    sparks = 0
    for _, pulse in zip(range(5000), one_by_one(gap), strict=False):
        sparks += {Pulse.DISCHARGE: 2, Pulse.DELAYED: 1}.get(pulse, 0)
        assert gap.um == pytest.approx(10.0 + sparks / 6000)


def test_chances_are_chances_at_every_gap():
    piece = Workpiece()
    for cell in range(-300, 800, 7):
        for level in range(0, 17, 4):
            p = chances(piece, cell, level, False)
            assert sum(p) == pytest.approx(1.0)
            assert min(p) >= 0
    wide = [chances(piece, cell, 8, False) for cell in range(0, 400, 10)]
    assert all(b.open >= a.open and b.short <= a.short for a, b in itertools.pairwise(wide))
    dirty = [chances(piece, 60, level, False) for level in range(17)]
    assert all(b.short > a.short for a, b in itertools.pairwise(dirty))


def test_tables_of_the_model_add_up():
    for cell in range(20, 200, 6):
        p = chances(Workpiece(), cell, 12, False)
        if p.open + p.short > 0.5:
            continue
        table = table_of(p, 4, 4)
        for sums in (*table.quiet, *table.loud, table.quiet_pairs, table.loud_pairs):
            assert sums.chance.sum() == pytest.approx(1.0, abs=1e-12)
            assert np.all(sums.counts >= 0)
        assert 0 <= table.pair_signals < 1

"""The servo of DE 2243742 A1: its figure 4, its resets, its ramp."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from page_commands import ROOT

sys.path.insert(0, str(ROOT / "benchmarks"))

from servo_figures import DISCHARGE, FIGURES, LATE, OPEN, SHORT, figure_4_rows

from wedmcam.simulate.servo import (
    Control,
    Counters,
    Detectors,
    Pulse,
    Settings,
    Wave,
    ramp_in_ticks,
    retract_times,
)


def test_figure_4_state_by_state():
    assert figure_4_rows() == [
        (146, True, False, 1, 0, 0),  # open: A counts
        (148, True, True, 0, 0, 0),  # a discharge resets it
        (150, True, False, 1, 0, 0),  # a delayed one: the voltage first,
        (150, False, True, 0, 1, 0),  # its late current resets A and is counted by B,
        (152, True, True, 0, 0, 0),  # which a discharge resets
        (154, False, True, 0, 1, 0),
        (156, False, True, 0, 2, 0),
        (158, False, True, 0, 3, 0),
        (160, False, True, 0, 0, -1),  # the fourth short: retract; B begins anew
    ]


def test_figure_4_stands_in_the_docs():
    page = (ROOT / "docs" / "servo.md").read_text("utf-8")
    kinds = {146: "open", 148: "discharge", 150: "delayed", 152: "discharge"}
    marks = {(True, False): "voltage", (True, True): "both", (False, True): "current"}
    words = {0: "", 1: "advance", -1: "retract"}
    for number, voltage, current, a, b, signal in figure_4_rows():
        cells = (number, kinds.get(number, "short"), marks[voltage, current], a, b, words[signal])
        assert "| " + " | ".join(map(str, cells)).rstrip() + " |" in page.replace("  |", " |")


@pytest.mark.parametrize("name", FIGURES)
def test_pictures_of_the_page_are_up_to_date(name):
    assert (ROOT / "docs" / "figures" / name).read_text("utf-8") == FIGURES[name]()
    assert f"](figures/{name})" in (ROOT / "docs" / "servo.md").read_text("utf-8")


def test_detectors_tell_the_pulses_apart():
    see = Detectors().see
    assert [see(w) for w in (OPEN, DISCHARGE, LATE, SHORT)] == list(Pulse)
    assert see(Wave((0, 0), (0, 0))) is None


PULSES = st.lists(st.sampled_from(list(Pulse)), max_size=60)
SETTINGS = st.builds(Settings, advance=st.integers(2, 10), retract=st.integers(2, 10))


@given(PULSES, SETTINGS)
def test_counters_count_what_comes_in_a_row(pulses, settings):
    """A second reading of the rule: look back at the detectors' pulses."""
    counters, seen = Counters(settings), []
    for pulse in pulses:
        edges = {
            Pulse.OPEN: "v",
            Pulse.DISCHARGE: "x",
            Pulse.DELAYED: "vc",
            Pulse.SHORT: "c",
        }[pulse]
        signal = 0
        for edge in edges:
            seen.append(edge)
            for mark, most, sign in (("v", settings.advance, 1), ("c", settings.retract, -1)):
                if seen[-most:] == [mark] * most:
                    signal, seen = sign, []
        assert counters.take(pulse) == signal
        tail = "".join(seen)
        assert counters.a == len(tail) - len(tail.rstrip("v"))
        assert counters.b == len(tail) - len(tail.rstrip("c"))


@given(SETTINGS, st.integers(1, 200))
def test_delayed_discharges_alone_never_correct(settings, many):
    counters = Counters(settings)
    assert not any(counters.take(Pulse.DELAYED) for _ in range(many))


@given(SETTINGS)
def test_a_delayed_discharge_counts_with_its_neighbours(settings):
    """A delayed one and B - 1 shorts retract; A - 1 opens and a delayed one advance."""
    counters = Counters(settings)
    row = [Pulse.DELAYED] + [Pulse.SHORT] * (settings.retract - 1)
    assert [counters.take(p) for p in row] == [0] * (len(row) - 1) + [-1]
    row = [Pulse.OPEN] * (settings.advance - 1) + [Pulse.DELAYED]
    assert [counters.take(p) for p in row] == [0] * (len(row) - 1) + [1]
    assert (counters.a, counters.b) == (0, 1)


@given(PULSES, SETTINGS)
def test_a_discharge_resets_both(pulses, settings):
    counters = Counters(settings)
    for pulse in pulses:
        counters.take(pulse)
    assert counters.take(Pulse.DISCHARGE) == 0
    assert (counters.a, counters.b) == (0, 0)


@given(st.integers(1, 60), st.floats(1e3, 1e6), st.floats(1, 500))
def test_a_retract_makes_exactly_n_steps_and_then_the_pulses_come_again(half, slope, lowest):
    settings = Settings(steps=2 * half, slope=slope, lowest=lowest)
    control = Control(settings)
    for _ in range(settings.retract - 1):
        assert control.pulse(Pulse.SHORT) == 0
    assert control.pulse(Pulse.SHORT) == -1
    assert not control.powered
    assert not control.forward
    times = retract_times(settings)
    for k, time in enumerate(times.tolist(), 1):
        assert control.wait(time * (1 - 1e-9)) == k - 1
        assert not control.powered
        assert control.wait(time) == k
    assert control.place == -settings.steps
    assert control.powered
    assert [control.pulse(Pulse.OPEN) for _ in range(settings.advance)][-1] == 1
    assert control.forward
    assert control.place == 1 - settings.steps


@given(st.integers(1, 100), st.floats(1e3, 1e6), st.floats(1, 500))
def test_the_ramp_is_linear_up_and_down(half, slope, lowest):
    """The frequency at each step is linear in time, and the way down mirrors the way up."""
    n = 2 * half
    times = retract_times(Settings(steps=n, slope=slope, lowest=lowest))
    assert len(times) == n
    up = times[:half]
    assert np.allclose(lowest * up + slope * up**2 / 2, np.arange(1, half + 1))
    waits = np.diff(times, prepend=0.0)
    assert np.all(waits > 0)
    assert np.allclose(waits, waits[::-1])


def test_the_ramp_is_that_of_an_integrator_and_an_oscillator():
    settings = Settings(steps=20, slope=20_000.0, lowest=50.0)
    ticks = ramp_in_ticks(20, 20_000.0, 50.0, 1e-6)
    assert len(ticks) == 20
    assert np.allclose(ticks, retract_times(settings), atol=2e-4)


def test_without_a_lowest_frequency_the_last_step_is_lost():
    assert len(ramp_in_ticks(20, 20_000.0, 0.0, 1e-5)) == 19
    assert len(ramp_in_ticks(20, 20_000.0, 50.0, 1e-5)) == 20


@pytest.mark.parametrize(
    "wrong", [{"steps": 7}, {"steps": 0}, {"advance": 1}, {"retract": 1}, {"lowest": 0.0}]
)
def test_settings_that_cannot_be_are_refused(wrong):
    with pytest.raises(ValueError, match=r"even|delayed|above 0"):
        replace(Settings(), **wrong)

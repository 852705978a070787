"""Timers, interrupts, ports and pulse counters of Eindhoven's microcomputer."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wedmcam.controllers.eindhoven.arithmetic import SPEED_UM_PER_S
from wedmcam.controllers.eindhoven.counters import CYCLE, PulseCounters
from wedmcam.controllers.eindhoven.interrupts import EMERGENCIES, Interrupts, Request
from wedmcam.controllers.eindhoven.ports import SAFE, Drive, Outputs, drive_words
from wedmcam.controllers.eindhoven.vectors import STEP_UM, Vectors
from wedmcam.ir.program import BLOCK


def by_hand(block, stepping):
    """When each step is made: both timers run, and POSCAL again when an axis has arrived."""
    unit = Fraction(SPEED_UM_PER_S).limit_denominator(10**6) / STEP_UM
    target = [int(block["x"]), int(block["y"])]
    at, clock, out = [0, 0], Fraction(0), []
    order = (1, 0) if stepping.y_first else (0, 1)
    while at != target:
        rest = block.copy()
        rest["x"], rest["y"] = target[0] - at[0], target[1] - at[1]
        speeds = stepping.speeds(np.array([rest]))
        rates = [Fraction(int(v[0])) * unit / int(speeds.scale) for v in (speeds.x, speeds.y)]
        due = [None if not rate else clock + 1 / rate for rate in rates]
        while True:
            clock, _, axis = min((t, order.index(k), k) for k, t in enumerate(due) if t is not None)
            at[axis] += 1 if target[axis] > at[axis] else -1
            out.append(float(clock))
            due[axis] = clock + 1 / rates[axis]
            if at[axis] == target[axis]:
                other = 1 - axis
                if due[other] == clock and at[other] != target[other]:
                    at[other] += 1 if target[other] > at[other] else -1
                    out.append(float(clock))  # its interrupt waits already
                break
    return np.array(out)


@given(
    st.tuples(st.integers(-70, 70), st.integers(-70, 70)).filter(any),
    st.integers(1, 127),
    st.sampled_from(["root", "sines"]),
    st.booleans(),
)
def test_steps_are_made_when_their_timers_say(way, speed, direction, y_first):
    block = np.zeros(1, BLOCK)
    block["x"], block["y"] = way
    block["count"] = speed
    stepping = Vectors(direction, "um", y_first)
    made = stepping.step_seconds(block)
    assert made == pytest.approx(by_hand(block[0], stepping), rel=1e-9)
    assert (np.diff(made) >= -1e-12).all()
    assert made[-1] == pytest.approx(float(stepping.seconds(block)[0]), rel=1e-9)


# --- interrupts ---------------------------------------------------------------------------------


@pytest.mark.parametrize("requests", list(itertools.permutations(Request)))
def test_the_most_urgent_is_served_first(requests):
    state, order = Interrupts(), []
    for one in requests:
        state = state.requested([one])
    while True:
        state, one = state.served()
        if one is None:
            break
        order.append(one)
        state = state.ended()
    assert order == sorted(Request)


def test_an_emergency_breaks_into_a_timer_and_no_step_follows_it():
    assert EMERGENCIES == ("stop", "limit", "break")  # one interrupt for all of them
    state, one = Interrupts().requested([Request.TIMER_Y]).served()
    assert one is Request.TIMER_Y
    state, one = state.requested([Request.TIMER_X, Request.EMERGENCY]).served()
    assert one is Request.EMERGENCY
    state = state.disabled().ended().ended()
    assert state.served() == (state, None)
    assert state.pending == {Request.TIMER_X}


def test_a_key_waits_for_the_timers():
    state, one = Interrupts().requested([Request.TIMER_X]).served()
    assert state.requested([Request.KEYBOARD]).served()[1] is None
    assert state.requested([Request.KEYBOARD]).ended().served()[1] is Request.KEYBOARD
    assert one is Request.TIMER_X


# --- ports --------------------------------------------------------------------------------------


def test_words_of_the_ports():
    assert Outputs(0, 0, Drive.OEV) == SAFE
    words = {
        (axis, sign, on): int(drive_words(axis, sign, on))
        for axis, sign, on in itertools.product((0, 1), (1, -1), (True, False))
    }
    assert len(set(words.values())) == 8
    for (axis, sign, on), word in words.items():
        assert bool(word & 1) == (not on)
        assert word & (4, 16)[axis]
        assert not word & (4, 16)[1 - axis]
        assert bool(word & (2, 8)[axis]) == (sign > 0)


# --- pulse counters -----------------------------------------------------------------------------

WINDOWS = st.lists(
    st.tuples(st.integers(0, CYCLE), st.integers(0, CYCLE)).filter(lambda w: sum(w) <= CYCLE),
    min_size=1,
    max_size=20,
)


@given(WINDOWS, st.integers(1, CYCLE))
def test_what_is_read_is_what_was_counted_and_no_cycle_is_lost(windows, piece):
    counters, read = PulseCounters(), []
    for shorts, opens in windows:
        kinds = np.repeat([0, 1, 2], [shorts, opens, CYCLE - shorts - opens])
        for k in range(0, CYCLE, piece):
            part = kinds[k : k + piece]
            counters = counters.counted(len(part), int((part == 0).sum()), int((part == 1).sum()))
        assert counters.sc_full
        assert counters.op_full
        assert (counters.pulses, counters.shorts, counters.opens) == (0, 0, 0)
        counters, sc = counters.read_sc()
        counters, op = counters.read_op()
        read.append((sc, op))
    assert read == windows


def test_a_port_that_is_not_read_holds_the_counters():
    counters = PulseCounters().counted(CYCLE, 7, 9).counted(CYCLE, 50, 60)
    assert counters.waits
    assert (counters.sc, counters.op) == (7, 9)
    with pytest.raises(ValueError, match="left of the cycle"):
        counters.counted(1, 0, 0)
    counters, sc = counters.read_sc()
    assert counters.waits, "both have to be read"
    counters, op = counters.read_op()
    assert (sc, op) == (7, 9)
    assert not counters.waits
    assert (counters.sc, counters.op) == (50, 60)
    with pytest.raises(ValueError, match="neither"):
        counters.counted(3, 2, 2)

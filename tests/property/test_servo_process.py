"""A program cut with a servo: whatever the gap does, the path cut is that without faults."""

import functools
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam import api
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.simulate.feeding import Feeding
from wedmcam.simulate.gap import Gap, Workpiece
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Leg, Mode, Turn, Way
from wedmcam.simulate.route import lay
from wedmcam.simulate.run import run
from wedmcam.simulate.runs import AtOnce, OneByOne
from wedmcam.simulate.scenario import Fault, Trouble, drawn, scenario_of
from wedmcam.simulate.zd065 import ZD065

GOLDEN = Path(__file__).parents[1] / "golden"
EXACT = Setup(backlash=(12, 15), play=(12, 15))
FORWARD = [list(Way).index(way) for way in (Way.CUT, Way.MOVE)]
#: A gap with a chip every few steps, in which shorts are frequent.
DIRTY = Workpiece(chip=1 / 8000, chip_um=12.0)
#: Steps cost a tenth of the pulses, for tests of the path.
COARSE = Workpiece(unit_um=1 / 600, hold=100, chip=1 / 2000, chip_um=12.0)


def feeding(law, seed, piece=COARSE, draw=None, attended=True):
    gap = Gap(piece, np.random.default_rng(seed))
    return Feeding(LAWS[law](draw or AtOnce(), 1e5, 1.0), gap, attended=attended)


@functools.cache
def two_squares(side=150):
    """Two square holes, each threaded, with a pause in one of them."""
    rows = [(Kind.LINE, side, 0), (Kind.LINE, 0, side), (Kind.PAUSE, 0, 0), (Kind.LINE, -side, 0)]
    rows += [(Kind.LINE, 0, -side), (Kind.MOVE, 700, -130), (Kind.THREAD, 0, 0)]
    rows += [(Kind.LINE, side, 31), (Kind.LINE, -side, -31), (Kind.STOP, 0, 0)]
    blocks = np.zeros(len(rows), BLOCK)
    for block, (kind, x, y) in zip(blocks, rows, strict=True):
        block["kind"], block["x"], block["y"] = kind, x, y
        if kind in (Kind.LINE, Kind.MOVE):
            axis, count = MIRROR.line_count(np.array([x]), np.array([y]))
            block["axis"], block["count"] = Axis(int(axis[0])), count[0]
    return lay(Program(blocks), MIRROR)


@functools.cache
def route_of(name):
    program, machine, _ = api.read_program(GOLDEN / f"{name}.zd")
    return lay(program, machine.stepping)


def assert_cut_as_without_faults(record):
    """Hold a record to the law, step by step.

    Every step is between two neighbours of the path; each place is reached for the first time in
    its order; a way back never goes behind a thread point; the table is on the path throughout.
    """
    route = record.route
    parts = list(record.motions())
    step = np.concatenate([part.step for part in parts])
    ways = np.concatenate([part.ways for part in parts])
    table = np.concatenate([part.table for part in parts])
    straight = ways == list(Way).index(Way.SHORTEST)
    jumps = np.abs(np.diff(step, prepend=0))
    assert (jumps[~straight & ~np.roll(straight, 1)] == 1).all()
    assert (table[~straight] == route.place[step[~straight]]).all()
    ahead = np.isin(ways, FORWARD)
    first = np.unique(step[ahead], return_index=True)
    assert first[0].tolist() == list(range(1, route.steps + 1))
    assert (np.diff(first[1]) > 0).all()
    assert record.finished
    assert record.final_um == tuple(route.place[-1].tolist())
    assert record.off_um == (0, 0)
    for event in record.events:
        if event.kind in ("pause", "thread-point"):
            assert event.step in [halt.step for halt in route.halts]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("seed", range(4))
def test_the_path_cut_is_that_without_faults(law, seed):
    servo = feeding(law, seed)
    record, wrong = run(ZD065, two_squares(), scenario_of([]), EXACT, feeder=servo)
    assert not wrong
    assert_cut_as_without_faults(record)
    kinds = Counter(event.kind for event in record.events)
    assert kinds["short"] == servo.tally.retreats > 0
    assert servo.tally.longest <= ZD065.answers.retreat
    undisturbed, _ = run(ZD065, two_squares(), scenario_of([]), EXACT)
    assert replace(record.state, time_s=0.0) == replace(undisturbed.state, time_s=0.0)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 5))
def test_with_wire_breaks_shorts_and_power_cuts_too(law, seed, many):
    route = two_squares()
    faults = drawn(seed, many, route)
    record, wrong = run(ZD065, route, scenario_of(faults), EXACT, feeder=feeding(law, seed))
    assert not wrong
    assert_cut_as_without_faults(record)


@pytest.mark.parametrize("law", LAWS)
def test_20000_steps_of_a_sample(law):
    """With the gap as it is: 80 million pulses."""
    route = route_of("cam")
    stop = Fault(Trouble.POWER, 20_000)
    servo = feeding(law, 3, Workpiece())
    record, wrong = run(ZD065, route, scenario_of([stop]), EXACT, feeder=servo, stop_at_power=True)
    assert not wrong
    assert record.state.stand.step == 20_000
    assert record.off_um == (0, 0)
    assert record.final_um == tuple(route.place[20_000].tolist())
    assert servo.gap.pulses > 50_000_000
    assert servo.tally.retreats > 50
    shorts = servo.gap.counted[3] / servo.gap.pulses
    opens = servo.gap.counted[0] / servo.gap.pulses
    assert shorts < 0.08
    assert opens < 0.15
    assert servo.gap.spread_um < 2.0


def test_a_retract_has_n_steps_or_as_many_as_there_are():
    servo = feeding("patent", 1)
    route = two_squares()
    record, _ = run(ZD065, route, scenario_of([]), EXACT, feeder=servo)
    n = servo.law.settings.steps
    room = [e.step - route.threads[route.threads <= e.step].max() for e in record.events]
    for event, most in zip(record.events, room, strict=True):
        if event.kind == "short":
            assert event.more["length"] % n == 0 or event.more["length"] in (most, 100)


@pytest.mark.parametrize("law", LAWS)
def test_a_short_that_stays_is_an_alarm_at_the_end_of_the_controllers_retreat(law):
    """The wire went 300 um far and touches whatever it does: 100 steps back it stops."""
    route = two_squares()
    servo = feeding(law, 1, replace(COARSE, chip=0.0), attended=False)
    turn = servo.forward(0, 140, 0, 100)
    assert turn.step == 140
    servo.gap.piece = replace(COARSE, short_um=1e6)
    servo.gap.step(0.0)
    turn = servo.forward(140, 300, 0, 100)
    assert (turn.step, turn.back) == (40, 100)
    assert [leg.way for leg in turn.legs] == [Way.RETREAT]
    bridged = feeding(law, 1, replace(COARSE, short_um=1e6))
    record, _ = run(ZD065, route, scenario_of([]), EXACT, feeder=bridged)
    assert [event.kind for event in record.events] == ["alarm", "clear-alarm", "alarm"]
    assert record.state.stand.mode is Mode.ALARM
    assert [d.code for d in record.findings] == ["alarm"]


def test_an_operator_takes_the_chip_out_and_cutting_goes_on():
    """Some of the alarms lie behind a pause that was passed: it is passed once."""
    route = two_squares()
    servo = feeding("feed", 8, replace(COARSE, chip_um=400.0))
    record, _ = run(ZD065, route, scenario_of([]), EXACT, feeder=servo)
    pause = next(halt.step for halt in route.halts if not halt.thread)
    assert any(
        e.kind == "alarm" and e.step < pause < e.step + e.more["back"] for e in record.events
    )
    kinds = Counter(event.kind for event in record.events)
    assert kinds["alarm"] == kinds["clear-alarm"] == servo.tally.alarms > 0
    assert kinds["pause"] == 1
    assert_cut_as_without_faults(record)


def test_times_are_those_of_the_servo():
    route = two_squares()
    servo = feeding("eindhoven", 1)
    plain = Setup(backlash=(0, 0), play=(0, 0))
    record, _ = run(ZD065, route, scenario_of([]), plain, feeder=servo)
    moved = int(route.moves.sum()) * plain.return_ms / 1000
    assert record.state.time_s == pytest.approx(servo.tally.seconds + moved)
    assert servo.tally.seconds >= servo.gap.pulses / 1e5 * (1 - 1e-9)


def test_the_same_seed_gives_the_same_run_and_the_literal_loop_a_like_one():
    route = two_squares(40)
    runs = [run(ZD065, route, scenario_of([]), EXACT, feeder=feeding("patent", 7))[0] for _ in "ab"]
    assert runs[0].state == runs[1].state
    legs = [[leg for one in run.sessions for leg in one.legs] for run in runs]
    assert legs[0] == legs[1]
    assert all(
        (a.seconds == b.seconds).all() for a, b in zip(*legs, strict=True) if a.way != "move"
    )
    literal = feeding("patent", 7, draw=OneByOne())
    record, _ = run(ZD065, route, scenario_of([]), EXACT, feeder=literal)
    assert_cut_as_without_faults(record)


def test_a_dry_run_has_no_gap():
    route = two_squares()
    dry = replace(EXACT, dry_ms=20)
    servo = feeding("patent", 1)
    record, _ = run(ZD065, route, scenario_of([]), dry, feeder=servo)
    assert servo.gap.pulses == 0
    assert record.finished


class Scripted:
    """A servo that goes 20 steps beyond a place once, and 40 back, where it stops."""

    attended = True

    def __init__(self, place):
        self.place, self.cleared = place, 0

    def forward(self, step, goal, floor, retreat):
        if step != self.place or self.cleared:
            return Turn((Leg(Way.CUT, step, goal),), goal, None)
        legs = Leg(Way.CUT, step, step + 20), Leg(Way.RETREAT, step + 20, step - 20)
        return Turn(legs, step - 20, 40)

    def clear(self):
        self.cleared += 1


def test_a_pause_that_was_passed_before_an_alarm_is_passed_once():
    route = two_squares()
    record, _ = run(ZD065, route, scenario_of([]), EXACT, feeder=Scripted(300))
    assert [(event.kind, event.step) for event in record.events] == [
        ("pause", 300),
        ("short", 320),
        ("alarm", 280),
        ("clear-alarm", 280),
        ("thread-point", 1430),
        ("end", route.steps),
    ]

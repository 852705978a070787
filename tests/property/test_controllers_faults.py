"""Every controller under faults, and fed by every servo: the path cut is that without faults."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from fault_runs import (
    assert_cut_as_without_faults,
    borders,
    random_faults,
    route_of,
    setup_of,
    undisturbed,
)
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.feeding import Feeding
from wedmcam.simulate.gap import Gap, Workpiece
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.run import initial, run
from wedmcam.simulate.runs import AtOnce
from wedmcam.simulate.scenario import Fault, Trouble, drawn, scenario_of
from wedmcam.simulate.state import check_state, read_state, state_bytes

#: Random scenarios a controller here; `benchmarks/measure_faults.py` runs 10,000.
SCENARIOS = {"zd065": 900, "nby15": 1300, "eindhoven": 1600}
#: A dirty gap whose steps cost a tenth of the pulses.
COARSE = Workpiece(unit_um=1 / 600, hold=100, chip=1 / 2000, chip_um=12.0)


def run_on(name, faults, **how):
    record, wrong = run(
        CONTROLLERS[name], route_of(name), scenario_of(faults), setup_of(name), **how
    )
    assert not wrong
    return record


@pytest.mark.parametrize("part", range(3))
@pytest.mark.parametrize("name", CONTROLLERS)
def test_random_faults_leave_no_trace(name, part):
    rng = np.random.default_rng([part, len(name)])
    happened = Counter()
    for _ in range(SCENARIOS[name] // 3):
        faults = random_faults(name, rng)
        record = run_on(name, faults)
        assert_cut_as_without_faults(name, record, faults)
        happened.update(event.kind for event in record.events)
    for trouble in CONTROLLERS[name].answers.troubles - {Trouble.POWER}:
        assert happened[trouble] > 50
    assert min(happened["alarm"], happened["clear"], happened["power-cut"]) > 50
    assert (happened["front"] > 50) == CONTROLLERS[name].answers.servo_feed
    assert (happened["no-tape"] > 10) == (Trouble.TAPE in CONTROLLERS[name].answers.troubles)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_each_fault_at_each_border_leaves_no_trace(name):
    """At the start, the end, thread points and borders of blocks; all of one kind in one run."""
    route, answers = route_of(name), CONTROLLERS[name].answers
    at = borders(name).tolist()
    at = at if len(at) < 150 else at[:75] + at[-75:]
    wired = [k for k in at if k == 0 or not route.moves[k - 1]]
    for trouble in sorted(answers.troubles):
        places = wired if trouble in (Trouble.SHORT, Trouble.BREAK) else at
        many = places if trouble is not Trouble.BREAK or not answers.returns else places[::5]
        for length in (1, answers.retreat * route.step_um, 10**6):
            faults = [Fault(trouble, k, length=length, goes_on=True) for k in many]
            assert_cut_as_without_faults(name, run_on(name, faults), faults)
            if trouble is not Trouble.SHORT:
                break


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_state_is_the_same_behind_its_file_and_none_that_the_program_contradicts(name):
    rng = np.random.default_rng(5)
    seen = Counter()
    for _ in range(120):
        record = run_on(name, random_faults(name, rng))
        for session in record.sessions[1:]:
            written = state_bytes(session.began)
            state, findings = read_state(written, "a.state")
            assert (state, findings) == (session.began, [])
            assert not check_state(state, name, record.route, written.decode(), "a.state")
            seen[state.stand.mode] += 1
    assert seen["forward"] > 20
    assert seen["retreat"] > 3


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_state_before_the_run_goes_through_its_file(name):
    begin = initial(CONTROLLERS[name], route_of(name), setup_of(name))
    state, findings = read_state(state_bytes(begin), "a.state")
    assert (state, findings) == (begin, [])
    assert not check_state(state, name, route_of(name), "", "a.state")


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_run_of_many_days_is_one_run(name):
    """Each power cut ends a day, and each alarm; the next one goes on from its state."""
    route, setup = route_of(name), setup_of(name)
    rng = np.random.default_rng(11)
    for _ in range(40):
        faults = random_faults(name, rng)
        whole = run_on(name, faults)
        rest, state, steps, kinds = faults, None, [], []
        while True:
            record, wrong = run(
                CONTROLLERS[name], route, scenario_of(rest), setup, state, stop_at_power=True
            )
            assert not wrong
            steps += [part.step for part in record.motions()]
            kinds += [(event.kind, event.step, event.j) for event in record.events]
            if record.finished:
                break
            state, _ = read_state(state_bytes(record.state), "a.state")
            cut = next(f for f in rest if f.trouble is Trouble.POWER or f.cut_after is not None)
            rest = rest[rest.index(cut) + 1 :]
        assert kinds == [(event.kind, event.step, event.j) for event in whole.events]
        assert (np.concatenate(steps) == np.concatenate([p.step for p in whole.motions()])).all()
        assert record.state.axes == whole.state.axes
        assert record.final_um == undisturbed(name)[0].final_um


@pytest.mark.parametrize("name", CONTROLLERS)
def test_faults_drawn_from_a_seed_can_happen_and_are_the_same_each_time(name):
    route, troubles = route_of(name), CONTROLLERS[name].answers.troubles
    kinds = Counter()
    for seed in range(100):
        faults = drawn(seed, 6, route, troubles)
        assert faults == drawn(seed, 6, route, troubles)
        assert faults != drawn(seed + 1, 6, route, troubles)
        kinds.update(fault.trouble for fault in faults)
        record = run_on(name, faults)
        assert record.finished
        assert record.off_um == (0, 0)
        assert record.final_um == undisturbed(name)[0].final_um
    assert set(kinds) == troubles


# --- fed by a servo ---------------------------------------------------------------------------


def servo_of(law, name, seed):
    gap = Gap(COARSE, np.random.default_rng(seed))
    step_um = float(route_of(name).step_um)
    return Feeding(LAWS[law](AtOnce(), 1e5, step_um), gap, step_um, attended=True)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_servo_cuts_the_path_without_faults(name, law):
    """Over all controllers and servos some 28,000 steps of path."""
    retreats = 0
    for seed in range(2):
        servo = servo_of(law, name, seed)
        record = run_on(name, [], feeder=servo)
        assert_cut_as_without_faults(name, record, [], fed=True)
        assert servo.tally.longest <= CONTROLLERS[name].answers.retreat
        kinds = Counter(event.kind for event in record.events)
        assert kinds["short"] == servo.tally.retreats
        assert kinds["alarm"] == servo.tally.alarms
        retreats += servo.tally.retreats
    assert retreats > 5


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_servo_and_faults_too(name, law):
    rng = np.random.default_rng(3)
    for seed in range(3):
        faults = random_faults(name, rng)
        record = run_on(name, faults, feeder=servo_of(law, name, seed))
        assert_cut_as_without_faults(name, record, faults, fed=True)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", CONTROLLERS)
def test_an_attended_servo_goes_on_from_alarms_at_the_end_of_the_way_back(name, law):
    """Chips that no retreat gets away from: an operator takes each out."""
    servo = servo_of(law, name, 4)
    servo.gap.piece = replace(COARSE, chip=1 / 6000, chip_um=900.0)
    record = run_on(name, [], feeder=servo)
    assert_cut_as_without_faults(name, record, [], fed=True)
    alarms = [event for event in record.events if event.kind == "alarm"]
    assert len(alarms) == servo.tally.alarms > 0
    for event in alarms:
        assert event.more["back"] <= CONTROLLERS[name].answers.retreat

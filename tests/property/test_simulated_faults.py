"""A simulated ZD-065 against a machine that is stepped by hand, and its laws under faults."""

import functools
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepped_machine import Machine
from wedmcam import api
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.simulate.checks import take_up_behind
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Stand, Way, steps_back, way_back
from wedmcam.simulate.ring import pattern
from wedmcam.simulate.route import lay
from wedmcam.simulate.run import run as run_machine
from wedmcam.simulate.scenario import Fault, Trouble, drawn, fault_of, last_thread, scenario_of
from wedmcam.simulate.state import check_state, read_state, state_bytes
from wedmcam.simulate.zd065 import ZD065

GOLDEN = Path(__file__).parents[1] / "golden"
FORWARD = [list(Way).index(way) for way in (Way.CUT, Way.MOVE)]
EXACT = Setup(backlash=(12, 15), play=(12, 15))


@functools.cache
def route_of(name):
    program, machine, _ = api.read_program(GOLDEN / f"{name}.zd")
    return lay(program, machine.stepping)


def program_of(rows):
    """Return a program of (kind, turn, x, y, count) rows; lines count as the ZD-065 does."""
    blocks = np.zeros(len(rows), BLOCK)
    for block, (kind, turn, x, y, count) in zip(blocks, rows, strict=True):
        block["kind"], block["turn"], block["x"], block["y"] = kind, turn, x, y
        block["axis"], block["count"] = (Axis.SQUARE if kind == Kind.ARC else 0), count
        if kind in (Kind.LINE, Kind.MOVE):
            axis, length = MIRROR.line_count(np.array([x]), np.array([y]))
            block["axis"], block["count"] = axis[0], length[0]
    return Program(blocks)


@functools.cache
def two_holes():
    """A round hole and a square one, each threaded, of some 4,400 steps."""
    turn = MIRROR.arc_end(200, 0, 1, 200, 0)
    hole = [(Kind.LINE, 0, 200, 0, 0), (Kind.ARC, 1, 200, 0, int(turn.count_square))]
    way = [(Kind.PAUSE, 0, 0, 0, 0), (Kind.MOVE, 0, 700, -130, 0), (Kind.THREAD, 0, 0, 0, 0)]
    square = [(0, 150), (-150, 0), (0, -300), (300, 0), (0, 300), (-150, 0), (0, -150)]
    lines = [(Kind.LINE, 0, x, y, 0) for x, y in square]
    back = [(Kind.LINE, 0, -200, 0, 0)]
    return lay(program_of([*hole, *back, *way, *lines, (Kind.STOP, 0, 0, 0, 0)]), MIRROR)


SMALL = st.integers(-40, 40)
LINES = st.tuples(st.just(Kind.LINE), st.just(0), SMALL, SMALL, st.just(0)).filter(
    lambda row: row[2] or row[3]
)
ARCS = st.tuples(
    st.just(Kind.ARC), st.sampled_from([1, -1]), SMALL, SMALL, st.integers(1, 150)
).filter(lambda row: row[2] ** 2 + row[3] ** 2 >= 2)
THREADS = st.just((Kind.THREAD, 0, 0, 0, 0))
PAUSES = st.just((Kind.PAUSE, 0, 0, 0, 0))
MOVES = st.tuples(st.just(Kind.MOVE), st.just(0), SMALL, SMALL, st.just(0)).filter(
    lambda row: row[2] or row[3]
)
PROGRAMS = st.lists(
    st.one_of(LINES, LINES, ARCS, ARCS, THREADS, PAUSES, MOVES), min_size=1, max_size=8
)
SIGNS = st.tuples(st.sampled_from([1, -1]), st.sampled_from([1, -1]))
PLAYS = st.tuples(st.integers(0, 9), st.integers(0, 9))


@st.composite
def runs(draw):
    """Return a route with steps, a setup, and faults that can happen on it."""
    route = lay(program_of(draw(PROGRAMS)), MIRROR)
    setup = Setup(draw(PLAYS), draw(PLAYS), draw(SIGNS), draw(SIGNS))
    faults = []
    for step in sorted(draw(st.lists(st.integers(0, route.steps), max_size=4))):
        kinds = ["power"]
        if step == 0 or not route.moves[step - 1]:
            kinds += ["short", "break", "block"]
        kind = draw(st.sampled_from(kinds))
        if kind == "short":
            length = draw(st.integers(1, 130))
            faults.append(Fault(Trouble.SHORT, step, length=length, goes_on=True))
        elif kind == "block":
            block = draw(st.integers(1, route.reading(step).block)) if route.steps else 1
            faults.append(Fault(Trouble.BREAK, step, block=block))
        else:
            faults.append(Fault(Trouble(kind), step))
    return route, setup, faults


def by_hand(route, setup, faults):
    """Run a program with faults on the machine that is stepped by hand."""
    machine = Machine(
        route.program.blocks, setup.backlash, setup.play, setup.approach, setup.true_approach
    )
    for fault in faults:
        while machine.n < fault.step:
            assert machine.forward()
        thread = last_thread(route, fault.step)
        if fault.trouble is Trouble.SHORT:
            machine.short(fault.length, thread)
        elif fault.trouble is Trouble.BREAK:
            if fault.block is not None:
                machine.back_to(route.start_of(fault.block))
            elif not route.threads.any():
                machine.straight_to_start()
            else:
                machine.back_to(thread)
    while machine.forward():
        pass
    return machine


@settings(max_examples=150)
@given(runs())
def test_every_pulse_is_that_of_a_machine_stepped_by_hand(run):
    route, setup, faults = run
    if not route.steps:
        return
    record, wrong = run_machine(ZD065, route, scenario_of(faults), setup)
    assert not wrong
    machine = by_hand(route, setup, faults)
    steps = [
        row
        for part in record.motions()
        for row in zip(part.axis.tolist(), part.sign.tolist(), part.ups.tolist(), strict=True)
    ]
    assert steps == [row[:3] for row in machine.log]
    assert record.final_um == tuple(screw.table for screw in machine.screws)
    assert [axis.motor for axis in record.state.axes] == [s.motor for s in machine.screws]
    assert max(record.off_um) == machine.worst
    assert record.finished


@pytest.mark.parametrize("name", ["key-punch", "cam", "bracket-inch"])
def test_f_and_j_are_those_of_the_controller_at_every_step(name):
    route = route_of(name)
    machine = Machine(route.program.blocks, (0, 0), (0, 0))
    last = min(route.steps, 60_000)
    columns = [column.tolist() for column in route.readings(np.arange(1, last + 1))]
    for row in zip(*columns, strict=True):
        machine.forward()
        assert row == machine.shown()
    for row in zip(*(reversed(column[:-1]) for column in columns), strict=True):
        machine.back()
        # At the end of a block the machine still shows it, or, on its way back, the next one.
        assert row == machine.shown() or (machine.j and row[-1] == 0)


def visits(record):
    """Return step, motors and directions of all steps forward, as columns."""
    columns = []
    last = np.array(record.setup.approach)
    for part in record.motions():
        direction = np.empty((len(part.axis), 2), np.int64)
        for k in range(2):
            rows = np.flatnonzero(part.axis == k)
            signs = np.concatenate([[last[k]], part.sign[rows]])
            direction[:, k] = signs[np.cumsum(part.axis == k)]
            last[k] = signs[-1]
        ahead = np.isin(part.ways, FORWARD)
        columns.append(
            np.column_stack([part.step, part.motor, direction, part.table, part.commanded])[ahead]
        )
    return np.concatenate(columns)


def assert_all_came_back(record, faults):
    """Motors (so phases), directions and table are the same before and after each fault.

    And the same as in a run without faults. (On the way back to the place of the fault an axis may
    not have turned yet: there the motors differ by the play, and the table is exact.)
    """
    seen = visits(record)
    seen = seen[np.argsort(seen[:, 0], kind="stable")]
    steps = np.array([fault.step for fault in faults])
    first = np.searchsorted(seen[:, 0], steps)
    undisturbed = visits(run_machine(ZD065, record.route, scenario_of([]), record.setup)[0])
    assert (seen[first] == undisturbed[steps - 1]).all()
    again = first + 1
    assert (seen[again, 0] == steps).all()
    assert (seen[again] == seen[first]).all()
    assert record.off_um == (0, 0)
    assert record.finished
    assert record.final_um == tuple(record.route.place[-1].tolist())


@pytest.mark.parametrize(("name", "first", "last"), [("cam", 1, 20_000), ("cover", 61_700, 63_700)])
def test_a_short_circuit_at_each_step_leaves_no_trace(name, first, last):
    """The second sample has a thread point among these steps: no retreat goes behind it."""
    route = route_of(name)
    faults = [
        Fault(Trouble.SHORT, k, length=min(1 + k * 7 % 100, k - last_thread(route, k)))
        for k in range(first, last + 1)
        if k > last_thread(route, k) and not route.moves[k - 1]
    ]
    assert len(faults) > 0.9 * (last - first)
    record, wrong = run_machine(ZD065, route, scenario_of(faults), EXACT)
    assert not wrong
    assert Counter(event.kind for event in record.events)["clear"] == len(faults)
    assert_all_came_back(record, faults)


def test_a_wire_break_at_each_of_20000_steps_leaves_no_trace():
    """Each returns to the start of its block; every 400th to the only thread point, straight."""
    route = route_of("key-punch")
    rows = route.rows(np.arange(route.steps + 1)) + 1
    faults = [
        Fault(Trouble.BREAK, k, block=None if k % 400 == 0 else int(rows[k]))
        for k in range(1, 20_001)
        if k % 400 == 0 or k - route.start_of(int(rows[k])) < 300
    ]
    record, wrong = run_machine(ZD065, route, scenario_of(faults), EXACT)
    assert not wrong
    assert_all_came_back(record, faults)


def test_a_power_cut_leaves_no_trace():
    """At each of 1,500 steps, then at every 20th up to 20,000: each state goes through a file."""
    route = route_of("cam")
    faults = [Fault(Trouble.POWER, k) for k in (*range(1, 1501), *range(1520, 20_001, 20))]
    record, wrong = run_machine(ZD065, route, scenario_of(faults), EXACT)
    assert not wrong
    undisturbed = visits(run_machine(ZD065, route, scenario_of([]), EXACT)[0])
    assert (visits(record) == undisturbed).all()
    assert record.off_um == (0, 0)
    assert Counter(event.kind for event in record.events)["resume"] == len(faults)


@settings(max_examples=40)
@given(runs(), st.data())
def test_a_power_cut_within_a_take_up_or_on_a_way_back_leaves_no_trace(run, data):
    """Every pulse is made once: with the cut the same ones in the same order as without."""
    route, setup, faults = run
    if not route.steps:
        return
    whole, _ = run_machine(ZD065, route, scenario_of(faults), setup)
    cuts = []
    for fault in faults:
        if fault.trouble is not Trouble.POWER:
            back = steps_back(route, way_back(route, ZD065.answers, fault, Stand()))
            fault = replace(fault, cut_after=data.draw(st.integers(0, back)))
        cuts.append(fault)
    step = data.draw(st.integers(0, route.steps))
    most = take_up_behind(route, step, setup)
    cuts.append(Fault(Trouble.POWER, step, pulses=data.draw(st.integers(0, most))))
    record, wrong = run_machine(ZD065, route, scenario_of(cuts), setup)
    assert not wrong
    assert record.state == replace(whole.state, time_s=record.state.time_s)
    assert (record.walked, record.pulses) == (whole.walked, whole.pulses)
    assert record.off_um == whole.off_um
    assert record.state.time_s == pytest.approx(whole.state.time_s)


@settings(max_examples=60)
@given(runs(), st.data())
def test_a_state_goes_through_its_file_and_stops_where_the_power_failed(run, data):
    route, setup, _ = run
    if not route.steps:
        return
    step = data.draw(st.integers(0, route.steps))
    pulses = data.draw(st.integers(0, take_up_behind(route, step, setup)))
    cut = Fault(Trouble.POWER, step, pulses=pulses)
    record, _ = run_machine(ZD065, route, scenario_of([cut]), setup, stop_at_power=True)
    written = state_bytes(record.state)
    state, findings = read_state(written, "a.state")
    assert state == record.state
    assert not findings
    assert not check_state(state, "zd065", route, written.decode(), "a.state")
    assert state.stand.step == step
    rest, _ = run_machine(ZD065, route, scenario_of([]), setup, state)
    whole, _ = run_machine(ZD065, route, scenario_of([]), setup)
    assert rest.final_um == whole.final_um
    assert rest.pulses + record.pulses == whole.pulses
    assert rest.state.axes == whole.state.axes


def test_500_runs_end_in_the_same_place():
    route = two_holes()
    undisturbed, _ = run_machine(ZD065, route, scenario_of([]), EXACT)
    for seed in range(500):
        record, wrong = run_machine(ZD065, route, scenario_of(drawn(seed, 6, route)), EXACT)
        assert not wrong
        assert record.finished
        assert record.off_um == (0, 0)
        assert replace(record.state, time_s=0.0) == replace(undisturbed.state, time_s=0.0)
    assert undisturbed.final_um == tuple(route.place[-1].tolist())


@settings(max_examples=60)
@given(runs())
def test_backlash_and_play_apart_are_off_by_their_difference_and_no_more(run):
    route, setup, faults = run
    if not route.steps:
        return
    true = replace(setup, true_approach=setup.approach)
    record, _ = run_machine(ZD065, route, scenario_of(faults), true)
    most = [abs(b - p) for b, p in zip(true.backlash, true.play, strict=True)]
    assert record.off_um[0] <= most[0]
    assert record.off_um[1] <= most[1]


@settings(max_examples=60)
@given(runs())
def test_a_wrong_approach_costs_the_whole_play_for_good(run):
    """The table has not moved with the first steps: it stays behind by the play from there on."""
    route, setup, _ = run
    exact = replace(setup, play=setup.backlash, approach=(1, 1), true_approach=(-1, -1))
    if not route.steps:
        return
    record, _ = run_machine(ZD065, route, scenario_of([]), exact)
    for k in range(2):
        rows = np.flatnonzero(route.axis == k)
        if not len(rows):
            continue
        play = exact.play[k]
        off = record.final_um[k] - int(route.place[-1, k])
        if route.sign[rows[0]] > 0:
            # Nothing was taken up, and the play was open: unless the way is shorter than it.
            assert off <= 0
            assert abs(off) <= play
            assert abs(off) == play or np.abs(route.place[:, k]).max() < play
        else:
            # The play is taken up though it was closed: the table moves by it with no command.
            assert off == -play


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        ("short@999999:5", "the program makes"),
        ("break@20:9", "in block 1 there"),
        ("power@3+1", "0 steps of play are taken up there"),
    ],
)
def test_a_fault_that_cannot_happen_is_an_error(fault, why):
    route = two_holes()
    record, findings = run_machine(ZD065, route, scenario_of([fault_of(fault)]), EXACT)
    assert record is None
    assert [d.code for d in findings] == ["bad-fault"]
    assert why in findings[0].message


def test_an_alarm_stops_the_machine_and_its_state_goes_on():
    route = two_holes()
    record, _ = run_machine(ZD065, route, scenario_of([fault_of("short@800:101")]), EXACT)
    assert [event.kind for event in record.events] == ["short", "alarm"]
    assert record.state.stand.step == 700
    assert [d.code for d in record.findings] == ["alarm"]
    rest, _ = run_machine(ZD065, route, scenario_of([]), EXACT, record.state)
    assert rest.finished
    assert [event.kind for event in rest.events][:2] == ["resume", "clear-alarm"]
    assert rest.final_um == tuple(route.place[-1].tolist())


def test_the_dry_run_takes_its_delay_a_step_and_knows_no_shorts():
    route = two_holes()
    dry = replace(EXACT, dry_ms=20)
    record, _ = run_machine(ZD065, route, scenario_of([]), dry)
    assert record.state.time_s == pytest.approx(0.02 * record.pulses)
    _, findings = run_machine(ZD065, route, scenario_of([fault_of("short@800:5")]), dry)
    assert "in a dry run the generator is off" in findings[0].message


def test_the_ring_has_three_phases_and_six_steps():
    assert [pattern(k) for k in range(-1, 7)] == ["CA", "A", "AB", "B", "BC", "C", "CA", "A"]


def test_the_feed_signal_changes_on_the_way():
    route = two_holes()
    slow = replace(EXACT, feed=10.0, backlash=(0, 0), play=(0, 0))
    record, _ = run_machine(ZD065, route, scenario_of([], [(100, 50.0), (300, 10.0)]), slow)
    moved = int(route.moves.sum())
    cut = route.steps - moved - 200
    assert record.state.time_s == pytest.approx(cut / 10 + 200 / 50 + moved * 0.005)


def test_who_goes_on_from_a_way_back_meets_faults_behind_its_end():
    """The power failed on the way to the thread point: the program begins again there."""
    route = route_of("key-punch")
    broken = replace(fault_of("break@9000"), cut_after=700)
    record, _ = run_machine(ZD065, route, scenario_of([broken]), EXACT, stop_at_power=True)
    later = [fault_of("short@50:5"), fault_of("power@8000")]
    rest, wrong = run_machine(ZD065, route, scenario_of(later), EXACT, record.state)
    assert not wrong
    kinds = [event.kind for event in rest.events]
    assert kinds == ["resume", "back", "short", "clear", "power-cut", "resume", "end"]
    assert rest.off_um == (0, 0)

"""What a controller does under faults, against one that is stepped by hand.

Controllers of every kind that `Answers` can say, on short random programs: memories of a few steps,
records of several blocks, and faults of all kinds at any step, many of them at one.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_simulated_faults import EXACT, PROGRAMS, program_of

from stepped_process import Process
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import Kind
from wedmcam.simulate.controller import Answers, Controller
from wedmcam.simulate.process import Stand, Way, steps_back, way_back
from wedmcam.simulate.route import lay
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, fault_of, scenario_of

BY_PROGRAM = st.builds(Answers, st.integers(1, 40), returns=st.booleans(), shortest=st.booleans())
BY_MEMORY = st.builds(
    Answers, st.integers(1, 40), st.just(True), st.just(False), servo_feed=st.booleans()
)
EVERY = frozenset(Trouble)


def made_up(answers):
    return Controller("made", "Made-up", "made", "its programs", ".made", answers)


@st.composite
def controllers(draw):
    answers = draw(st.one_of(BY_PROGRAM, BY_MEMORY))
    values = {name: getattr(answers, name) for name in Answers.__slots__}
    values |= {"troubles": EVERY, "ahead": draw(st.integers(0, 3))}
    return made_up(Answers(**values))


@st.composite
def routes(draw):
    """A route whose blocks were made of records, some of several blocks."""
    program = program_of(draw(PROGRAMS))
    count = len(program.blocks)
    new = draw(st.lists(st.booleans(), min_size=count, max_size=count))
    return lay(program, MIRROR, np.cumsum(new))


@st.composite
def faults_on(draw, route, answers, stand):
    """Faults that can happen behind a stand, several at a step; an operator clears each."""
    steps = st.integers(stand.place, route.steps)
    places = draw(st.lists(steps, min_size=1, max_size=3))
    faults = []
    for step in sorted(draw(st.lists(st.sampled_from(places), max_size=6))):
        kinds = ["power", "stop", "limit", "tape", "tape"]
        if step == 0 or not route.moves[step - 1]:
            kinds += ["short", "short", "short", "break"]
        trouble = Trouble(draw(st.sampled_from(kinds)))
        fault = Fault(trouble, step, goes_on=True)
        if trouble is Trouble.SHORT:
            fault = Fault(trouble, step, length=draw(st.integers(1, 50)), goes_on=True)
        elif trouble is Trouble.BREAK and answers.returns:
            reached = route.reading(step).block
            block = draw(st.one_of(st.none(), st.integers(1, reached)))
            fault = Fault(trouble, step, block=block)
        if trouble is Trouble.SHORT or (trouble is Trouble.BREAK and answers.returns):
            back = steps_back(route, way_back(route, answers, fault, stand))
            after = draw(st.one_of(st.none(), st.integers(0, back)))
            fault = Fault(trouble, step, fault.length, fault.block, 0, after, fault.goes_on)
        faults.append(fault)
    return faults


def steps_of(record):
    """Return (way, axis, sign, place) of every step that a machine made."""
    return [
        (str(list(Way)[way]), axis, sign, step)
        for part in record.motions()
        for way, axis, sign, step in zip(
            part.ways.tolist(),
            part.axis.tolist(),
            part.sign.tolist(),
            part.step.tolist(),
            strict=True,
        )
    ]


@settings(max_examples=400, deadline=None)
@given(st.data())
def test_every_step_and_event_is_that_of_a_machine_stepped_by_hand(data):
    controller, route = data.draw(controllers()), data.draw(routes())
    if not route.steps:
        return
    faults = data.draw(faults_on(route, controller.answers, Stand()))
    record, wrong = run(controller, route, scenario_of(faults), EXACT)
    assert not wrong
    machine = Process(route, controller.answers)
    assert machine.run(route, faults)
    assert steps_of(record) == machine.log
    assert [(e.kind, e.walked, e.step) for e in record.events] == machine.events
    assert record.finished


@settings(max_examples=400, deadline=None)
@given(st.data())
def test_what_happens_on_the_way_back_to_the_front_is_that_of_a_machine_stepped_by_hand(data):
    """The machine stands with an alarm, or its power failed, behind the front: faults there too."""
    controller, route = data.draw(controllers()), data.draw(routes())
    cut = [k for k in range(1, route.steps + 1) if not route.moves[k - 1]]
    if not cut:
        return
    answers = controller.answers
    step = data.draw(st.sampled_from(cut))
    before = [Fault(Trouble.TAPE, step)] if data.draw(st.booleans()) else []
    short = Fault(Trouble.SHORT, step, length=60)
    first, wrong = run(controller, route, scenario_of([*before, short]), EXACT)
    assert not wrong
    machine = Process(route, answers)
    assert not machine.run(route, [*before, short])
    stand = first.state.stand
    faults = data.draw(faults_on(route, answers, stand))
    record, wrong = run(controller, route, scenario_of(faults), EXACT, first.state)
    assert not wrong
    log, events = len(machine.log), len(machine.events)
    machine.say("resume")
    machine.say("clear-alarm")
    assert machine.go_on(route, faults)
    assert steps_of(record) == machine.log[log:]
    assert [(e.kind, e.walked + log, e.step) for e in record.events] == machine.events[events:]


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_who_goes_on_from_an_alarm_or_a_saved_state_does_what_one_run_does(data):
    """Each power cut ends a run, and the next one goes on from its state: all as in one."""
    controller, route = data.draw(controllers()), data.draw(routes())
    if not route.steps:
        return
    faults = data.draw(faults_on(route, controller.answers, Stand()))
    whole, _ = run(controller, route, scenario_of(faults), EXACT)
    rest, state, steps, events = list(faults), None, [], []
    while True:
        record, wrong = run(controller, route, scenario_of(rest), EXACT, state, stop_at_power=True)
        assert not wrong
        steps += steps_of(record)
        events += [(e.kind, e.step, e.time_s) for e in record.events]
        if record.finished:
            break
        state = record.state
        cut = [f for f in rest if f.trouble is Trouble.POWER or f.cut_after is not None]
        del rest[: rest.index(cut[0]) + 1]
    assert steps == steps_of(whole)
    assert events == [(e.kind, e.step, e.time_s) for e in whole.events]
    assert record.state == whole.state


@pytest.mark.parametrize(
    ("faults", "ends"),
    [
        (["tape@5"], [20]),
        (["tape@5", "tape@15"], [20]),
        (["tape@5", "tape@20"], [20, 40]),
        (["tape@5", "power@15"], [20]),
        (["tape@45"], [60]),  # what ends the program is not read
        (["tape@55"], []),
        (["tape@60"], []),
    ],
)
def test_a_machine_without_tape_runs_what_it_has_read(faults, ends):
    """Six lines of ten steps: the one that is run, and the next one, are in the machine."""
    route = lay(program_of([(Kind.LINE, 0, 10, 0, 0)] * 6), MIRROR)
    machine = made_up(Answers(30, True, False, servo_feed=True, ahead=1, troubles=EVERY))
    record, _ = run(machine, route, scenario_of(map(fault_of, faults)), EXACT)
    assert [e.step for e in record.events if e.kind == "no-tape"] == ends


def test_a_tape_is_read_on_from_where_the_wire_has_come_to():
    """The wire stands 30 steps behind it; the block that is read next is not the next one there."""
    route = lay(program_of([(Kind.LINE, 0, 10, 0, 0)] * 6), MIRROR)
    machine = made_up(Answers(30, True, False, servo_feed=True, ahead=1, troubles=EVERY))
    first, _ = run(machine, route, scenario_of([fault_of("short@35:99")]), EXACT)
    assert first.state.stand.place == 5
    record, _ = run(machine, route, scenario_of([fault_of("tape@6")]), EXACT, first.state)
    assert [e.step for e in record.events if e.kind == "no-tape"] == [50]

"""A simulated NBY-15 against a machine that is stepped by hand: its ring of 256, its reader."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepped_tape import RING, TapeMachine
from wedmcam.controllers.nby15.data import TAPE, program_of
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import Kind
from wedmcam.simulate.feeding import Feeding
from wedmcam.simulate.gap import Gap, Workpiece
from wedmcam.simulate.laws import Act
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.nby15 import NBY15
from wedmcam.simulate.process import WAYS, Mode
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, last_thread, scenario_of

SETUP = Setup((0, 0), (0, 0))
KINDS = {"line": Kind.LINE, "move": Kind.MOVE, "arc": Kind.ARC, "pause": Kind.PAUSE}


def route_of(blocks):
    """Return the route of a tape; an M02 ends it."""
    tape = np.zeros(len(blocks) + 1, TAPE)
    for row, (kind, *words) in zip(tape, blocks, strict=False):
        row["kind"] = KINDS[kind]
        names = ("turn", "start", "degrees", "radius") if kind == "arc" else ("x", "y")
        for name, word in zip(names, words, strict=False):
            row[name] = word
    tape["kind"][-1] = Kind.STOP
    return NBY15.lay(program_of(tape), MIRROR)


WAY = st.integers(-150, 150)
LINES = st.tuples(st.just("line"), WAY, WAY)
#: Many of these degrees make no step at all.
ARCS = st.tuples(
    st.just("arc"),
    st.sampled_from([1, -1]),
    st.integers(0, 359),
    st.integers(1, 60),
    st.integers(1, 400),
)
#: Wire out, to the next thread point, where the machine waits.
MOVES = (
    st.tuples(st.just("move"), WAY, WAY)
    .filter(lambda move: move[1] or move[2])
    .map(lambda move: [move, ("pause",)])
)
BLOCKS = st.one_of(
    LINES.map(lambda one: [one]),
    ARCS.map(lambda one: [one]),
    st.just([("pause",)]),
    MOVES,
)
#: Tapes without a step are refused before they are run.
TAPES = (
    st.lists(BLOCKS, min_size=1, max_size=8)
    .map(lambda parts: [block for part in parts for block in part])
    .filter(lambda tape: route_of(tape).steps)
)


@st.composite
def runs(draw):
    """Return a tape, its route, and faults that can happen on it."""
    tape = draw(TAPES)
    route = route_of(tape)
    faults = []
    for step in sorted(draw(st.lists(st.integers(0, route.steps), max_size=5))):
        kinds = ["tape", "power", "stop"]
        if step == 0 or not route.moves[step - 1]:
            kinds += ["short", "short", "short", "break"]
        kind = draw(st.sampled_from(kinds))
        length = draw(st.integers(1, RING + 40)) if kind == "short" else 0
        faults.append(Fault(Trouble(kind), step, length=length, goes_on=kind == "short"))
    return tape, route, faults


def steps_of(record):
    return [
        (axis, sign, str(WAYS[way]))
        for part in record.motions()
        for axis, sign, way in zip(
            part.axis.tolist(), part.sign.tolist(), part.ways.tolist(), strict=True
        )
    ]


@settings(max_examples=120, deadline=None)
@given(runs())
def test_every_step_is_that_of_a_machine_stepped_by_hand(case):
    tape, route, faults = case
    record, wrong = run(NBY15, route, scenario_of(faults), SETUP)
    assert not wrong
    machine = TapeMachine(tape)
    for fault in faults:
        machine.come_to(fault.step)
        if fault.trouble is Trouble.SHORT:
            machine.short(fault.length)
            machine.come_to(fault.step)
        elif fault.trouble is Trouble.TAPE:
            machine.tear()
    while machine.forward():
        pass
    assert steps_of(record) == machine.log
    assert record.final_um == tuple(machine.at) == tuple(route.place[-1].tolist())
    kinds = {kind for kind, _ in machine.events}
    seen = [(event.kind, event.step) for event in record.events if event.kind in kinds]
    assert seen == machine.events
    assert record.finished


class Whim:
    """A law that goes forward and back as a seed says, at times into an alarm."""

    name = "whim"

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)
        self.ahead, self.stuck = 1, False

    def begin(self):
        self.stuck = False

    def act(self, gap, room):
        if self.ahead and not self.stuck:
            self.ahead -= 1
            return Act(1, (0.01,))
        self.ahead = int(self.rng.choice([1, 40, 150, 400]))
        # Who is stuck goes back until there is no room.
        self.stuck = self.stuck or self.rng.random() < 0.3
        steps = room if self.stuck else min(room, int(self.rng.choice([1, 20, 100])))
        return Act(-steps, (0.01,) * max(steps, 1))


@settings(max_examples=40, deadline=None)
@given(st.one_of(TAPES, st.just([("arc", 1, 7, 80, 3000), ("line", 500, 90)])), st.integers(0, 999))
def test_with_a_servo_it_goes_back_over_what_the_ring_holds_and_no_farther(tape, seed):
    """Shorts come on SERVO-FEED too, and behind an alarm that an operator clears."""
    route = route_of(tape)
    servo = Feeding(Whim(seed), Gap(Workpiece(), np.random.default_rng(seed)), attended=True)
    record, wrong = run(NBY15, route, scenario_of([]), SETUP, feeder=servo)
    assert not wrong
    machine = TapeMachine(tape)
    made = steps_of(record)
    for _, _, way in made:
        assert machine.back() if way == "retreat" else machine.forward()
    assert machine.log == made
    # Its alarms are where nothing is left in the ring, and it is never farther back.
    at, walked = TapeMachine(tape), 0
    for event in record.events:
        for _, _, way in made[walked : event.walked]:
            at.back() if way == "retreat" else at.forward()
        walked = event.walked
        if event.kind == "alarm":
            assert at.behind == at.count
    if record.finished:
        assert record.final_um == tuple(route.place[-1].tolist())
    else:  # an operator clears no alarm at which nothing moves a second time
        assert record.state.stand.mode is Mode.ALARM


def test_a_second_short_circuit_finds_what_is_left_of_the_memory():
    """It comes on SERVO-FEED, 100 steps behind the farthest place: 156 are left."""
    route = route_of([("line", 3000, 0)])
    first, _ = run(NBY15, route, scenario_of([Fault(Trouble.SHORT, 1000, length=300)]), SETUP)
    assert first.state.stand.mode is Mode.ALARM
    again = scenario_of([Fault(Trouble.SHORT, 900, length=200)])
    second, wrong = run(NBY15, route, again, SETUP, first.state)
    assert not wrong
    assert [(e.kind, e.step) for e in second.events] == [
        ("resume", 744),
        ("clear-alarm", 744),
        ("short", 900),
        ("alarm", 744),
    ]
    assert second.state.stand.front == 1000
    within = scenario_of([Fault(Trouble.SHORT, 900, length=156)])
    third, _ = run(NBY15, route, within, SETUP, first.state)
    assert [(e.kind, e.step) for e in third.events][2:] == [
        ("short", 900),
        ("clear", 744),
        ("front", 1000),
        ("end", 3000),
    ]


@pytest.mark.parametrize(
    ("step", "length", "held"), [(40, 41, 40), (2170, 71, 70), (600, 257, 256)]
)
def test_the_memory_holds_less_at_the_start_and_behind_a_thread_point(step, length, held):
    route = route_of([("line", 1000, 0), ("move", 600, 500), ("pause",), ("line", 900, 0)])
    assert last_thread(route, 2170) == 2100
    for long, end in ((held + 1, "alarm"), (held, "clear")):
        record, _ = run(NBY15, route, scenario_of([Fault(Trouble.SHORT, step, length=long)]), SETUP)
        event = next(e for e in record.events if e.kind == end)
        assert event.step == step - held


TAPE_OF_SIX = [("line", 100 * k, 0) for k in range(1, 7)]


@pytest.mark.parametrize(
    ("step", "until"),
    [
        (0, 1000),  # block 1 in work, 2 to 4 read
        (99, 1000),
        (100, 1500),  # block 2 is in work
        (299, 1500),
        (300, 2100),  # blocks 3 to 6: the M02 is not read
        (599, 2100),
        (600, None),  # the M02 is read
        (2099, None),
        (2100, None),
    ],
)
def test_three_blocks_are_read_ahead(step, until):
    route = route_of(TAPE_OF_SIX)
    record, wrong = run(NBY15, route, scenario_of([Fault(Trouble.TAPE, step)]), SETUP)
    assert not wrong
    kinds = [(event.kind, event.step) for event in record.events]
    stops = [] if until is None else [("no-tape", until), ("start", until)]
    assert kinds == [("tape", step), *stops, ("end", 2100)]
    assert record.events[0].more.get("until") == until
    assert ("TAPE" in record.events[0].lamps) == (until is not None)
    if until is not None:
        assert record.events[1].lamps == ("PROGRAMME STOP", "TAPE")
        assert record.events[2].lamps == ("PROGRAMME START", "FORWARD")


def test_a_reader_that_stands_goes_on_standing():
    """A second tear reads nothing more; a power cut between both is saved with it."""
    route = route_of(TAPE_OF_SIX)
    faults = [Fault(Trouble.TAPE, 50), Fault(Trouble.POWER, 200), Fault(Trouble.TAPE, 400)]
    record, _ = run(NBY15, route, scenario_of(faults), SETUP)
    assert [(e.kind, e.step) for e in record.events if e.kind != "power-cut"] == [
        ("tape", 50),
        ("resume", 200),
        ("tape", 400),
        ("no-tape", 1000),
        ("start", 1000),
        ("end", 2100),
    ]
    after, _ = run(NBY15, route, scenario_of([*faults, Fault(Trouble.TAPE, 1000)]), SETUP)
    # In work is block 5; blocks 6 and the M02 are read.
    assert Counter(e.kind for e in after.events)["no-tape"] == 1


def test_a_pause_is_made_where_it_is_read():
    """In front of the end of what was read, or behind the stop there."""
    four = [("line", 100, 0)] * 4
    for tape, expected in (
        ([*four[:3], ("pause",), *four], ["tape", "pause", "no-tape", "start", "end"]),
        ([*four, ("pause",), *four], ["tape", "no-tape", "start", "pause", "end"]),
    ):
        record, _ = run(NBY15, route_of(tape), scenario_of([Fault(Trouble.TAPE, 10)]), SETUP)
        assert [event.kind for event in record.events] == expected


def test_a_pause_that_was_passed_is_not_made_again_out_of_the_memory():
    """Neither behind a short circuit at its place, nor behind a power cut on the way back."""
    route = route_of([("pause",), ("line", 100, 0), ("pause",), ("line", 100, 0)])
    short = Fault(Trouble.SHORT, 100, length=50)
    for fault in (short, replace(short, cut_after=20)):
        record, _ = run(NBY15, route, scenario_of([Fault(Trouble.POWER, 0), fault]), SETUP)
        kinds = Counter(event.kind for event in record.events)
        assert kinds["pause"] == 2
        assert kinds["front"] == 1
        assert record.finished

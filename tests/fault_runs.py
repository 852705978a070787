"""Runs of all controllers under random faults, and the law that every one of them is held to.

Whatever happens on the way, the path cut equals the path without faults, step by step. Used by
tests and by `benchmarks/measure_faults.py`.
"""

from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np

from wedmcam import api
from wedmcam.simulate.checks import take_up_behind
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import WAYS, Stand, Way, steps_back, way_back
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of

#: A round hole and a slot, each threaded, of some 2,000 um.
PART = """units um
contour hole { circle center (500, 500) radius 120 }
contour slot {
  from (850, 400)  line to (1100, 400)  line to (1100, 520)
  arc ccw center (975, 520) sweep 180  close
}
cut hole inside offset 40 start (500, 500)
cut slot inside offset 40 start (970, 500)
"""
FORWARD = [WAYS.index(way) for way in (Way.CUT, Way.MOVE)]
RETREAT, SHORTEST = (WAYS.index(way) for way in (Way.RETREAT, Way.SHORTEST))


@cache
def route_of(name, part=PART):
    """Return the route of a part program on a controller, as its file is read."""
    controller = CONTROLLERS[name]
    made = api.compile(part.encode(), name="part.wed", to=controller.format)
    program, machine, _ = api.read_program(made.data, name=f"part{controller.suffix}")
    return controller.lay(program, machine.stepping)


def setup_of(name):
    """Return the machine: play and backlash are the same, where the controller takes it up."""
    play = (12, 15) if CONTROLLERS[name].takes_up_play else (0, 0)
    return Setup(play, play)


@cache
def undisturbed(name):
    """Return the record of a run without faults, and its motors at each place."""
    record, _ = run(CONTROLLERS[name], route_of(name), scenario_of([]), setup_of(name))
    motors = np.concatenate([part.motor for part in record.motions()])
    return record, np.vstack([[[0, 0]], motors])


@cache
def take_ups(name):
    """Return how much play is taken up behind each place."""
    route, setup = route_of(name), setup_of(name)
    return [take_up_behind(route, k, setup) for k in range(route.steps + 1)]


@cache
def borders(name):
    """Return places of interest: start, end, borders of blocks, thread points; and one beside."""
    route = route_of(name)
    at = np.array([0, route.steps, *route.threads, *route.first])
    return np.unique(np.clip(np.concatenate([at - 1, at, at + 1]), 0, route.steps))


def random_faults(name, rng, most=6):
    """Return faults of every kind that a controller knows; an operator clears each alarm."""
    controller, route = CONTROLLERS[name], route_of(name)
    answers, every = controller.answers, sorted(controller.answers.troubles)
    at = borders(name)
    count = int(rng.integers(1, most + 1))
    steps = np.where(
        rng.random(count) < 0.4, rng.choice(at, count), rng.integers(0, route.steps + 1, count)
    )
    # Half of them share a place with another one.
    steps = np.where(rng.random(count) < 0.5, rng.choice(steps, count), steps)
    faults, left = [], dict.fromkeys(steps.tolist(), None)
    for step in sorted(steps.tolist()):
        trouble = Trouble(str(rng.choice(every)))
        wired = step == 0 or not route.moves[step - 1]
        if trouble in (Trouble.SHORT, Trouble.BREAK) and not wired:
            trouble = Trouble.POWER
        fault = Fault(trouble, step, goes_on=True)
        if trouble is Trouble.POWER:
            held = take_ups(name)[step] if left[step] is None else left[step]
            pulses = int(rng.integers(0, held + 1))
            left[step] = held - pulses
            fault = Fault(trouble, step, pulses=pulses)
        elif trouble is Trouble.SHORT:
            length = int(rng.integers(1, (answers.retreat + 60) * route.step_um))
            fault = replace(fault, length=length)
        elif trouble is Trouble.BREAK and answers.returns and rng.random() < 0.5:
            fault = replace(fault, block=int(rng.integers(1, route.reading(step).block + 1)))
        goes_back = trouble is Trouble.SHORT or (trouble is Trouble.BREAK and answers.returns)
        if goes_back and rng.random() < 0.3:
            back = steps_back(route, way_back(route, answers, fault, Stand()))
            fault = replace(fault, cut_after=int(rng.integers(0, back + 1)))
        if goes_back:
            # On the way out and back an axis turns twice: its play is taken up anew.
            left[step] = None if left[step] is None else 0
        faults.append(fault)
    return faults


def assert_cut_as_without_faults(name, record, faults, fed=False):
    """Hold a record to the law, step by step.

    Args:
        name: of the controller.
        record: of the run.
        faults: that should happen, and all cleared.
        fed: by a servo, which has shorts and alarms of its own.
    """
    route, answers = record.route, CONTROLLERS[name].answers
    plain, motors = undisturbed(name)
    parts = list(record.motions())
    step, ways, table, motor, axis, sign = (
        np.concatenate([getattr(part, column) for part in parts])
        for column in ("step", "ways", "table", "motor", "axis", "sign")
    )
    # Each step that is new is the next one of the path, cut (or moved) as without faults.
    front = np.maximum.accumulate(step)
    new = np.flatnonzero(np.diff(front, prepend=0))
    assert (step[new] == np.arange(1, route.steps + 1)).all()
    assert np.isin(ways[new], FORWARD).all()
    assert (axis[new] == route.axis).all()
    assert (sign[new] == route.sign).all()
    assert (motor[new] == motors[1:]).all()
    # Everywhere else, back and forth, the table is on the path, and goes along it.
    straight = ways == SHORTEST
    jumps = np.abs(np.diff(step, prepend=0))
    assert (jumps[~straight & ~np.roll(straight, 1)] == 1).all()
    assert (table[~straight] == route.place[step[~straight]]).all()
    if answers.remembers:
        assert (front - step <= answers.retreat).all()
    # Who goes back from a short circuit goes back so far at most.
    back = np.flatnonzero(ways == RETREAT)
    if not answers.remembers and len(back):
        begins = back[np.diff(back, prepend=-2) > 1]
        ends = back[np.diff(back, append=len(ways) + 2) > 1]
        assert (step[begins] + 1 - step[ends] <= answers.retreat).all()
    # All is as it was without faults.
    assert record.finished
    assert record.off_um == (0, 0)
    assert record.final_um == plain.final_um
    assert replace(record.state, time_s=0.0) == replace(plain.state, time_s=0.0)
    _assert_all_happened(record, faults, fed)


def _assert_all_happened(record, faults, fed):
    """Each fault happened once, each power cut was gone on from as it was, and all was cleared."""
    kinds = Counter(event.kind for event in record.events)
    wanted = Counter(fault.trouble for fault in faults)
    for trouble in Trouble:
        if trouble is Trouble.POWER:
            cuts = wanted[trouble] + sum(fault.cut_after is not None for fault in faults)
            assert kinds["power-cut"] == kinds["resume"] == cuts
        elif not (fed and trouble is Trouble.SHORT):
            assert kinds[str(trouble)] == wanted[trouble]
    for before, after in zip(record.events, record.events[1:], strict=False):
        if before.kind == "power-cut":
            assert after.kind == "resume"
            assert replace(after, kind="", more={}, lamps=()) == replace(
                before, kind="", more={}, lamps=()
            )
    assert kinds["alarm"] + kinds["limit"] == kinds["clear-alarm"]
    # An alarm of a servo that cannot go back has no short circuit before it.
    assert fed or kinds["short"] == kinds["clear"] + kinds["alarm"]
    assert kinds["stop"] + (kinds["break"] - kinds["back"]) + kinds["no-tape"] == kinds["start"]
    halts = [halt.step for halt in record.route.halts]
    assert {e.step for e in record.events if e.kind in ("pause", "thread-point")} == set(halts)
    if record.controller.answers.remembers:
        assert kinds["pause"] + kinds["thread-point"] == len(halts)

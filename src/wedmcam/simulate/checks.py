"""Whether a scenario can happen on a route: each fault that cannot is an error with its place."""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic, error
from wedmcam.simulate.controller import Answers, Controller
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Stand, steps_back, way_back
from wedmcam.simulate.route import Route
from wedmcam.simulate.scenario import Fault, Scenario, Trouble
from wedmcam.simulate.state import State


def check_scenario(
    scenario: Scenario, route: Route, controller: Controller, setup: Setup, begin: State
) -> list[Diagnostic]:
    """Return an error for each fault and feed that cannot happen.

    Args:
        scenario: of a run.
        route: of its program.
        controller: of the machine.
        setup: of the machine.
        begin: of the run.
    """
    # Play that is taken up before one power cut is not taken up again before the next one there.
    taken: dict[int, int] = {}
    out = []
    for fault in scenario.faults:
        out += (
            _unknown(fault, controller)
            or _outside(fault, route, begin.stand)
            or _generator_off(fault, route, setup)
            or _not_reached(fault, route)
            or _take_up(fault, route, setup, begin, taken.get(fault.step, 0))
            or _way_back(fault, route, controller.answers, begin.stand)
        )
        if fault.pulses:
            taken[fault.step] = taken.get(fault.step, 0) + fault.pulses
    return out


def _unknown(fault: Fault, controller: Controller) -> list[Diagnostic]:
    answers, title = controller.answers, controller.title
    if fault.trouble not in answers.troubles:
        text = "{fault}: the {title} knows no such fault"
        known = sorted(answers.troubles)
        return [
            error(
                "bad-fault",
                text,
                fault.span,
                hint="it knows {troubles}",
                fault=str(fault),
                title=title,
                troubles=[str(one) for one in known],
            )
        ]
    if fault.block is not None and not answers.returns:
        spot = "{fault}: the {title} returns to no block: the wire is threaded where it broke"
        return [error("bad-fault", spot, fault.span, fault=str(fault), title=title)]
    return []


def _outside(fault: Fault, route: Route, begin: Stand) -> list[Diagnostic]:
    if fault.step > route.steps:
        text = "{fault}: the program makes {steps} steps"
        return [error("bad-fault", text, fault.span, fault=str(fault), steps=route.steps)]
    if fault.step < begin.place:
        late = "{fault}: the run begins at step {begin}"
        hint = "leave out what happened before the state was saved"
        return [
            error("bad-fault", late, fault.span, hint=hint, fault=str(fault), begin=begin.place)
        ]
    return []


def _generator_off(fault: Fault, route: Route, setup: Setup) -> list[Diagnostic]:
    dry = setup.dry_ms is not None
    off = fault.step > 0 and bool(route.moves[fault.step - 1])
    if fault.trouble not in (Trouble.SHORT, Trouble.BREAK) or not (dry or off):
        return []
    where = "in a dry run" if dry else "on a positioning move"
    text = "{fault}: {where} the generator is off; wires neither short nor break"
    return [error("bad-fault", text, fault.span, fault=str(fault), where=where)]


def _not_reached(fault: Fault, route: Route) -> list[Diagnostic]:
    if fault.block is None:
        return []
    reached = route.reading(fault.step).block
    if fault.block <= reached:
        return []
    text = (
        "{fault}: the machine is in block {reached} there; it returns only to the start of a block "
        "that it has reached"
    )
    return [error("bad-fault", text, fault.span, fault=str(fault), reached=reached)]


def _take_up(
    fault: Fault, route: Route, setup: Setup, begin: State, taken: int
) -> list[Diagnostic]:
    if not fault.pulses:
        return []
    most = _left(route, fault.step, setup, begin) - taken
    if fault.pulses <= most:
        return []
    text = "{fault}: {most} steps of play are taken up there"
    return [error("bad-fault", text, fault.span, fault=str(fault), most=most)]


def _left(route: Route, step: int, setup: Setup, begin: State) -> int:
    """Return how much play is still to be taken up behind a step when the run comes to it."""
    if step == begin.stand.step and step < route.steps:
        axis = begin.axes[int(route.axis[step])]
        if axis.left and axis.direction == route.sign[step]:
            return axis.left
    return take_up_behind(route, step, setup)


def _way_back(fault: Fault, route: Route, answers: Answers, begin: Stand) -> list[Diagnostic]:
    after = fault.cut_after
    if after is not None and fault.trouble in (Trouble.SHORT, Trouble.BREAK):
        back = steps_back(route, way_back(route, answers, fault, begin))
        if after > back:
            far = "{fault}: the way back has {back} steps, and the power fails behind {after}"
            return [error("bad-fault", far, fault.span, fault=str(fault), back=back, after=after)]
    return []


def take_up_behind(route: Route, step: int, setup: Setup) -> int:
    """Return how many steps of play are taken up between a step of the path and the next one."""
    if step >= route.steps:
        return 0
    axis = int(route.axis[step])
    before = np.flatnonzero(route.axis[:step] == axis)
    last = int(route.sign[before[-1]]) if len(before) else setup.approach[axis]
    return setup.backlash[axis] if last != route.sign[step] else 0

"""A run of a program on a simulated controller, with everything that a scenario says goes wrong.

The process says which way the machine goes, motion drives its motors along it, and a power cut
takes the state through its file. What one controller does otherwise than another are its answers.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.diag import Diagnostic, Place, error, warning
from wedmcam.simulate.axis import AxisState, part_taken
from wedmcam.simulate.checks import check_scenario
from wedmcam.simulate.controller import Controller
from wedmcam.simulate.motion import Setup, batches
from wedmcam.simulate.process import Feeder, Incident, Mode, Stand, Walk, Way, walk
from wedmcam.simulate.record import Event, Record, Session, in_um, table_of
from wedmcam.simulate.route import Reading, Route
from wedmcam.simulate.scenario import Scenario
from wedmcam.simulate.state import State, read_state, state_bytes


def initial(controller: Controller, route: Route, setup: Setup) -> State:
    """Return the state of a machine in which the program is entered, and nothing is run yet."""
    return State(
        controller=controller.name,
        program=route.digest,
        stand=Stand(),
        reading=route.reading(0),
        axes=setup.at_start(),
        backlash=setup.backlash,
        play=setup.play,
        approach=setup.approach,
        true_approach=setup.true_approach,
        dry_ms=setup.dry_ms,
        time_s=0.0,
    )


def run(
    controller: Controller,
    route: Route,
    scenario: Scenario,
    setup: Setup,
    state: State | None = None,
    *,
    stop_at_power: bool = False,
    feeder: Feeder | None = None,
) -> tuple[Record | None, list[Diagnostic]]:
    """Run a program with everything that a scenario says goes wrong.

    Args:
        controller: of the machine.
        route: of the program.
        scenario: what happens when.
        setup: of the machine.
        state: to go on from, checked; None to begin the program.
        stop_at_power: a power cut ends the run; else the state is saved, read, and the run goes on.
        feeder: a servo that feeds the wire; not in a dry run, where the pen has no gap.

    Returns:
        None, and why, where a fault cannot happen.
    """
    begin, answers = state or initial(controller, route, setup), controller.answers
    feeder = feeder if setup.dry_ms is None else None
    wrong = check_scenario(scenario, route, controller, setup, begin)
    if wrong:
        return None, wrong
    tally = _Tally(controller, route, setup)
    if state is not None:
        tally.resume(state)
    sessions: list[Session] = []
    faults = scenario.faults
    while True:
        happens = replace(scenario, faults=faults)
        path = walk(route, happens, begin.stand, answers, feeder)
        sessions.append(Session(path.legs, begin))
        axes, seconds = tally.watch(path, begin, scenario.feeds)
        end = _state_behind(path, begin, axes, begin.time_s + seconds, route, setup)
        tally.take(path, end)
        if path.cut is None or stop_at_power:
            break
        begin, faults = _through_a_file(end), path.faults
        tally.resume(begin)
    record = Record(
        controller=controller,
        route=route,
        setup=setup,
        feeds=scenario.feeds,
        sessions=tuple(sessions),
        events=tuple(tally.events),
        state=end,
        walked=tally.walked,
        pulses=tally.pulses,
        off_um=in_um(route, tally.off),
        seconds=dict(zip(Way, tally.seconds.tolist(), strict=True)),
    )
    return replace(record, findings=tuple(_findings(record))), []


class _Tally:
    """Counts what the machine does, and turns incidents into events: with time, table and J."""

    def __init__(self, controller: Controller, route: Route, setup: Setup) -> None:
        self.controller, self.route, self.setup = controller, route, setup
        self.events: list[Event] = []
        self.walked = self.pulses = 0
        self.off = (0, 0)
        self.seconds = np.zeros(len(Way))
        self._seen: list[tuple[float, tuple[int, int]]] = []

    def watch(
        self, path: Walk, begin: State, feeds: tuple[tuple[int, float], ...]
    ) -> tuple[tuple[AxisState, AxisState], float]:
        """Drive the motors along a walk; return the axes at its end, and how long it takes, s."""
        axes, seconds, walked = begin.axes, 0.0, 0
        at = np.array([one.walked for one in path.incidents], dtype=np.int64)
        self._seen = [(begin.time_s, table_of(begin.axes, self.setup))] * int((at == 0).sum())
        for part in batches(self.route, path.legs, axes, self.setup, feeds):
            off = abs(part.table - part.commanded).max(axis=0).tolist()
            self.off = (max(self.off[0], off[0]), max(self.off[1], off[1]))
            here = at[(at > walked) & (at <= walked + len(part.step))] - walked - 1
            times = (begin.time_s + part.time[here]).tolist()
            self._seen += zip(times, map(tuple, part.table[here].tolist()), strict=True)
            self.pulses += len(part.step) + int(part.ups.sum())
            durations = np.diff(part.time, prepend=seconds)
            self.seconds += np.bincount(part.ways, durations, len(Way))
            axes, seconds, walked = part.axes, float(part.time[-1]), walked + len(part.step)
        return axes, seconds

    def take(self, path: Walk, end: State) -> None:
        """Take the incidents of a walk over; a power cut shows the state at its end."""
        held = [end.reading] if path.cut is not None else []
        before = path.incidents[: len(path.incidents) - len(held)]
        if before:
            columns = self.route.readings(np.array([one.step for one in before], dtype=np.int64))
            held = [
                *map(Reading._make, zip(*(column.tolist() for column in columns), strict=True)),
                *held,
            ]
        for one, reading, (time, table) in zip(path.incidents, held, self._seen, strict=True):
            if one.kind == "power-cut":
                time, table = end.time_s, table_of(end.axes, self.setup)
            self._add(one, reading, time, table)
        self.walked += sum(leg.steps for leg in path.legs)
        self.pulses += path.cut.pulses if path.cut is not None else 0

    def resume(self, state: State) -> None:
        """Take over that the machine goes on from a state."""
        again = Incident("resume", 0, state.stand)
        self._add(again, state.reading, state.time_s, table_of(state.axes, self.setup))

    def _add(self, one: Incident, reading: Reading, time_s: float, table: tuple[int, int]) -> None:
        walked, lamps = self.walked + one.walked, self.controller.lamps
        self.events.append(
            Event(
                one.kind,
                one.step,
                reading.block,
                reading.j,
                time_s,
                walked,
                in_um(self.route, table),
                () if lamps is None else lamps(one.kind, one.stand),
                one.more,
            )
        )


def _state_behind(
    path: Walk,
    begin: State,
    axes: tuple[AxisState, AxisState],
    time_s: float,
    route: Route,
    setup: Setup,
) -> State:
    """Return the state at the end of a walk; a power cut may fall into a take-up of play."""
    cut, step = path.cut, path.stand.step
    if cut is not None and cut.pulses:
        k, sign = int(route.axis[step]), int(route.sign[step])
        part = part_taken(axes[k], sign, cut.pulses, setup.backlash[k], setup.play[k])
        axes = (part, axes[1]) if k == 0 else (axes[0], part)
        time_s += cut.pulses * setup.take_up_s
    return replace(begin, stand=path.stand, reading=route.reading(step), axes=axes, time_s=time_s)


def _through_a_file(state: State) -> State:
    """Return a state as it comes back from its file: nothing else may go on."""
    data = state_bytes(state)
    read, findings = read_state(data, "state")
    assert read is not None, findings
    return read


def _findings(record: Record) -> list[Diagnostic]:
    """Return what is to know of a run: whether it came to its end, and how exact the table was."""
    findings = _alarm(record) if record.state.stand.mode is Mode.ALARM else []
    x, y = record.off_um
    if x or y:
        off = (
            "the table was off the path by up to {x} um on x and {y} um on y: backlash and play, "
            "or the entered and the true direction of approach, differ"
        )
        findings.append(warning("table-off", off, None, x=x, y=y))
    return findings


def _alarm(record: Record) -> list[Diagnostic]:
    """Return why a run ended with an alarm."""
    stand, block = record.state.stand, record.state.reading.block
    if not stand.short:
        where = Place.of_um(*record.final_um)
        # What the program itself leads into, it leads into again.
        own = record.events[-1].more.get("switch")
        hint = "set the switches so that the program keeps within the travel of the table"
        return [
            error(
                "alarm",
                "a limit switch stopped the machine at step {step}, block {block}, at {place} from "
                "the start",
                None,
                hint=hint if own else "see to the machine; then it goes on from its state",
                step=stand.step,
                block=block,
                place=where,
            )
        ]
    text = (
        "the machine stopped with an alarm at step {step}, block {block}: the short circuit is "
        "still there{back}"
    )
    # Who goes on from a state of the way back does not know where that began.
    back = record.events[-1].more.get("back")
    short = next((one for one in reversed(record.events) if one.kind == "short"), None)
    if back is None and short is not None:
        back = short.step - stand.step
    return [
        error(
            "alarm",
            text,
            None,
            hint="look at the generator and the wire; then the machine goes on from its state",
            step=stand.step,
            block=block,
            back="" if back is None else f", {back} steps back",
        )
    ]

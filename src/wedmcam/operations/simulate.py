"""Simulate a machine: a program runs with everything that a scenario says goes wrong.

The program is read as the controller reads it, in its own frame; then `simulate` runs it. What is
entered comes from the caller, from a scenario file and, where a run goes on, from its state.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from wedmcam.controllers.nby15.data import Switches
from wedmcam.diag import Diagnostic, FileSpan, TextSpan, error, has_errors, note
from wedmcam.diag.run import Refused, Run, WrongUse
from wedmcam.files import Source, bytes_of
from wedmcam.judge.certificate import finding_data
from wedmcam.machines import Machine, is_builtin
from wedmcam.operations.profiles import reader_machine
from wedmcam.simulate.conditions import Conditions, setup_of
from wedmcam.simulate.controller import Controller
from wedmcam.simulate.controllers import ALIASES, CONTROLLERS, controller_of
from wedmcam.simulate.feeding import Feeding, feeding_of
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Mode
from wedmcam.simulate.read import read_scenario
from wedmcam.simulate.record import Record, in_um
from wedmcam.simulate.route import Route
from wedmcam.simulate.run import run as run_machine
from wedmcam.simulate.scenario import (
    HOW,
    Fault,
    Scenario,
    Trouble,
    drawn,
    fault_of,
    scenario_of,
)
from wedmcam.simulate.state import State, check_state, read_state, state_bytes
from wedmcam.simulate.zd065 import ZD065
from wedmcam.targets import Entries, target_of

#: A name and bytes.
Named = tuple[str, bytes]


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """What came of a run.

    Attributes:
        input: name of the program.
        controller: of the machine.
        sha256: of the program's bytes.
        record: what the machine did; None where it ran nothing.
        findings: in order.
        cut_short: a power cut ended the run on purpose: its state is there to go on from.
        servo: what the servo that fed the wire did; None without one.
    """

    input: str
    controller: str
    sha256: str
    record: Record | None
    findings: tuple[Diagnostic, ...]
    cut_short: bool = False
    servo: Mapping[str, Any] | None = None

    @property
    def ok(self) -> bool:
        """Whether the program was run to its end, or to the power cut that should end it."""
        return (
            self.record is not None
            and not has_errors(self.findings)
            and (self.record.finished or self.cut_short)
        )

    @property
    def status(self) -> int:
        """Exit status: 0, or 1 where the input has errors or the machine stopped with an alarm."""
        return int(not self.ok)

    @property
    def state(self) -> bytes | None:
        """The file from which the run goes on; None where it is at its end, or nothing was run."""
        if self.record is None or self.record.finished:
            return None
        return state_bytes(self.record.state)

    @property
    def summary(self) -> dict[str, Any]:
        """Everything in numbers, as ``--json`` prints it."""
        facts: dict[str, Any] = {
            "input": self.input,
            "sha256": self.sha256,
            "controller": self.controller,
            "ok": self.ok,
        }
        if self.record is not None:
            facts |= _figures(self.record)
        if self.servo is not None:
            facts["servo"] = dict(self.servo)
        facts["diagnostics"] = [finding_data(d) for d in self.findings]
        return facts


def simulate_program(
    source: Source,
    *,
    controller: str = "zd065",
    scenario: Source | Named | None = None,
    resume: Source | Named | None = None,
    faults: Sequence[str | Fault] = (),
    stop_at_power: bool = False,
    strict: bool = False,
    name: str | None = None,
    **stated: Any,
) -> Simulation:
    """Run a program on a simulated controller, with faults.

    Args:
        source: a program that the controller reads: for the ZD-065 its cutting format, a tape of
            the NBY-15, job records of the DEM-15.
        controller: "zd065", "nby15", or "eindhoven" (or "dem15").
        scenario: a TOML file, its bytes, or its name and bytes: what happens.
        resume: a state, likewise: go on from there.
        faults: more faults, ``short@STEP:LENGTH_UM``, ``break@STEP[:BLOCK]``,
            ``power@STEP[+PULSES]``, of other machines than the ZD-065 ``stop@STEP``,
            ``limit@STEP``, ``tape@STEP``; or `Fault` values.
        stop_at_power: a power cut ends the run, and its state is returned; else the state is saved,
            read, and the run goes on.
        strict: warnings are errors.
        name: of the program, in findings.
        **stated: other fields of `Conditions`: ``backlash=(12, 15)`` (um; without it the machine
            refuses to cut), ``play``, ``approach``, ``true_approach``, ``feed`` (steps a second),
            ``return_ms``, ``dry_ms``, ``random=(count, seed)``, ``servo=("patent", seed)`` (or
            "eindhoven", "feed": it feeds the wire; its alarm ends the run), ``profile`` (a built-in
            one of the format), ``switches`` of an NBY-15. They win over the scenario.

    Raises:
        WrongUse: an unknown controller, a text that is no fault, or other figures than those of the
            state.
        OSError: a path cannot be read.
    """
    machine = controller_of(controller)
    if machine is None:
        raise WrongUse(
            f"no controller is called '{controller}': {', '.join([*CONTROLLERS, *ALIASES])}"
        )
    data, name = bytes_of(source, name)
    sha256 = hashlib.sha256(data).hexdigest()
    conditions = Conditions(faults=tuple(map(_fault, faults)), **stated)
    servo = conditions.servo
    feeding: Feeding | None = None
    if servo is not None and servo[0] not in LAWS:
        raise WrongUse(f"no servo is called '{servo[0]}': {', '.join(LAWS)}")
    run = Run(strict)
    record: Record | None = None
    try:
        route, opens = run("read", _read_route(data, name, machine, conditions))
        if scenario is not None:
            stated_there = run("scenario", stated_in(*_named(scenario, "scenario")))
            conditions = conditions.over(stated_there)
        state = (
            None
            if resume is None
            else run("state", _resumed(*_named(resume, "state"), machine, route))
        )
        setup = run("enter", _entered(conditions, machine, route, state, name))
        happens = run("enter", _scenario_of(conditions, machine, route, state, opens))
        feeding = (
            None if servo is None else feeding_of(*servo, step_um=route.step_um, attended=False)
        )
        ran = run_machine(
            machine, route, happens, setup, state, stop_at_power=stop_at_power, feeder=feeding
        )
        record = run("run", ran)
        came_there = opens is not None and record.state.stand.step == opens.values["steps"]
        run.add("run", [*([opens] if came_there and opens else []), *record.findings])
    except Refused:
        pass
    cut = stop_at_power and record is not None and _ended_by_power(record)
    figures = None if feeding is None or record is None else feeding.figures
    return Simulation(name, machine.name, sha256, record, tuple(run.findings), cut, figures)


def _ended_by_power(record: Record) -> bool:
    mode = record.state.stand.mode
    return not record.finished and mode is not Mode.ALARM


def _fault(text: str | Fault) -> Fault:
    if isinstance(text, Fault):
        return text
    fault = fault_of(text)
    if fault is None:
        raise WrongUse(f"'{text}' is no fault: {HOW}")
    return fault


def _read_route(
    data: bytes, name: str, controller: Controller, c: Conditions
) -> tuple[tuple[Route, Diagnostic | None] | None, list[Diagnostic]]:
    """Return the route of a program as the controller reads it: of another format only why not.

    With the route comes the limit switch into which it leads, where it does.

    Raises:
        WrongUse: a profile that is not built in, or of another format; entries of another machine.
    """
    entries = Entries(switches=c.switches or Switches(), run_off=bool(c.run_off))
    entries.check(controller.format, controller.format)
    machine = reader_machine(data, name, None, c.profile)
    if not machine.is_of(controller.format):
        return None, [_other_format(machine, controller, name)]
    # Built-in profiles: the frame of the controller, whose axes nothing exchanges.
    if not is_builtin(machine):
        raise WrongUse(f"the profile '{machine.name}' is not built in")
    program, found = target_of(machine).read(data, name, entries)
    opens = next((d for d in found if d.code == "limit-switch"), None)
    findings = [d for d in found if d is not opens]
    if has_errors(findings):
        return None, [*findings, *_comes_to(data, name, controller, machine, entries)]
    route = controller.lay(program, machine.stepping)
    if not route.steps:
        empty = error("empty-program", "the program makes no step", FileSpan(name))
        return None, [*findings, empty]
    return (route, opens), findings


def _comes_to(
    data: bytes, name: str, controller: Controller, machine: Machine, entries: Entries
) -> list[Diagnostic]:
    """Return how far a machine comes that reads its program while it runs, up to an error."""
    part = data if controller.readable is None else controller.readable(data)
    if part == data:
        return []
    program, findings = target_of(machine).read(part, name, entries)
    if has_errors(findings):
        return []
    route = controller.lay(program, machine.stepping)
    return [
        note(
            "tape-parity",
            "the {title} reads {ahead} blocks ahead: it would run {blocks} blocks, and stop at "
            "step {step} with TAPE",
            FileSpan(name),
            title=controller.title,
            ahead=controller.answers.ahead,
            blocks=route.blocks,
            step=route.steps,
        )
    ]


def _other_format(machine: Machine, controller: Controller, name: str) -> Diagnostic:
    text = "the {title} runs {programs}; this one is in the format {format}"
    if controller is not ZD065:
        return error(
            "other-format",
            text,
            FileSpan(name),
            hint="wedmcam compile DRAWING -o NAME{suffix} makes one of its drawing",
            title=controller.title,
            programs=controller.programs,
            format=machine.format,
            suffix=controller.suffix,
        )
    target = target_of(machine)
    entered = ""
    if target.makes_path:
        turns = " --copies N --angle DEGREES"
        entered = " --gap LENGTH --side die" if target.takes_gap else turns
    return error(
        "other-format",
        text,
        FileSpan(name),
        hint="wedmcam convert {file} -o NAME.zd{entered} makes one of it",
        title=controller.title,
        programs=controller.programs,
        format=machine.format,
        file=name,
        entered=entered,
    )


def _named(source: Source | Named, usual: str) -> Named:
    """Return the name and the bytes of a source."""
    if isinstance(source, tuple):
        return source
    data, name = bytes_of(source, usual if isinstance(source, bytes) else None)
    return name, data


def stated_in(name: str, data: bytes) -> tuple[Conditions | None, list[Diagnostic]]:
    """Return what a scenario file states, or what is wrong with it.

    Args:
        name: of the file, for the spans.
        data: any bytes; never raises.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as wrong:
        line = data.count(b"\n", 0, wrong.start) + 1
        span = TextSpan(name, line, wrong.start - data.rfind(b"\n", 0, wrong.start))
        return None, [error("bad-scenario", "the file is no text in UTF-8", span)]
    return read_scenario(text, name)


def _resumed(
    name: str, data: bytes, controller: Controller, route: Route
) -> tuple[State | None, list[Diagnostic]]:
    """Return the state of a file, which has to be one of this program."""
    state, findings = read_state(data, name)
    if state is None:
        return None, findings
    wrong = check_state(state, controller.name, route, data.decode("ascii"), name)
    return (None, wrong) if wrong else (state, [])


def _entered(
    c: Conditions, controller: Controller, route: Route, state: State | None, name: str
) -> tuple[Setup | None, list[Diagnostic]]:
    """Return the machine of a run: without backlash figures a ZD-065 refuses to cut.

    Raises:
        WrongUse: other figures than those of the state, or some that the machine does not take.
    """
    title = controller.title
    if c.backlash is not None and not controller.takes_up_play:
        raise WrongUse(
            f"the {title} takes up no play: leave --backlash out; --play X,Y is that of its screws"
        )
    if (c.feed is not None or c.feeds) and not controller.takes_feed:
        raise WrongUse(f"the program of the {title} states its speeds: leave --feed out")
    if c.dry_ms is not None and not controller.runs_dry:
        raise WrongUse(f"the {title} has no dry run")
    if state is not None:
        c = _as_saved(c, state, route)
    if c.backlash is not None:
        return setup_of(c, c.backlash, route.step_um), []
    if c.dry_ms is not None or not controller.takes_up_play:
        # No play is entered for the pen, and it is given none.
        return setup_of(c, (0, 0), route.step_um), []
    text = "the backlash of x and y is not entered: the controller refuses to cut"
    hint = "--backlash X,Y in um, as measured at the machine; 0,0 for one without play"
    return None, [error("no-backlash", text, FileSpan(name), hint=hint)]


def _as_saved(c: Conditions, state: State, route: Route) -> Conditions:
    """Return conditions with the figures of a state, which may be stated, but not otherwise."""
    saved: dict[str, Any] = {
        "backlash": in_um(route, state.backlash),
        "play": in_um(route, state.play),
        "approach": state.approach,
        "true_approach": state.true_approach,
        "dry_ms": state.dry_ms,
    }
    for field, value in saved.items():
        mine = getattr(c, field)
        if mine is not None and mine != value:
            raise WrongUse(
                f"{field.replace('_', ' ')} is {_shown(mine)} here and {_shown(value)} in the "
                "state: the machine goes on as it was"
            )
    return replace(c, **saved)


def _shown(value: Any) -> str:
    if value is None:
        return "none"
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _scenario_of(
    c: Conditions,
    controller: Controller,
    route: Route,
    state: State | None,
    opens: Diagnostic | None,
) -> tuple[Scenario, list[Diagnostic]]:
    """Return what happens, and what to say of random faults.

    Where the program leads into a limit switch, ``opens``, that is a fault of its own. A run that
    goes on from a power cut draws what the one before drew, and has had the first ones.
    """
    random: tuple[Fault, ...] = ()
    if c.random is not None:
        random = drawn(c.random[1], c.random[0], route, controller.answers.troubles)
    findings = []
    if c.random is not None and not random:
        text = "nothing of this program is cut: no random fault can happen"
        findings = [error("bad-fault", text)]
    if state is not None and random:
        begin = state.stand.front
        count = len(random)
        random = tuple(fault for fault in random if fault.step > begin)
        if passed := count - len(random):
            gone = "{passed} of {drawn} random faults happened up to step {begin}, before this run"
            findings = [note("fault-passed", gone, None, passed=passed, drawn=count, begin=begin)]
    own: tuple[Fault, ...] = ()
    if opens is not None:
        where = opens.values
        own = (Fault(Trouble.LIMIT, where["steps"], switch=where["axis"], span=opens.span),)
    return scenario_of((*c.faults, *random, *own), c.feeds), findings


def _figures(record: Record) -> dict[str, Any]:
    """Return the figures of a run."""
    x, y = record.state.axes
    setup, route = record.setup, record.route
    pair: Callable[[Any], list[int]] = list
    outputs = record.controller.outputs
    return {
        "finished": record.finished,
        "blocks": route.blocks,
        "steps": route.steps,
        "walked": record.walked,
        "pulses": record.pulses,
        "take_up_pulses": record.pulses - record.walked,
        "final_um": pair(record.final_um),
        "motor_um": pair(in_um(route, (x.motor, y.motor))),
        "commanded_um": pair(record.commanded_um),
        "off_um": pair(record.off_um),
        "time_s": round(record.state.time_s, 6),
        "seconds": {kind: round(value, 6) for kind, value in record.spent.items()},
        "backlash_um": pair(in_um(route, setup.backlash)),
        "play_um": pair(in_um(route, setup.play)),
        "approach": pair(setup.approach),
        "true_approach": pair(setup.true_approach),
        "dry_ms": setup.dry_ms,
        "thread_points": route.threads.tolist(),
        "stopped_at": None if record.finished else record.state.stand.step,
        "events": [
            {
                "event": event.kind,
                "step": event.step,
                "block": event.block,
                "j": event.j,
                "time_s": round(event.time_s, 6),
                "walked": event.walked,
                "table_um": pair(event.table_um),
                **({} if record.controller.lamps is None else {"lamps": list(event.lamps)}),
                **({"ports": dict(ports)} if (ports := outputs.get(event.kind)) else {}),
                **event.more,
            }
            for event in record.events
        ],
    }

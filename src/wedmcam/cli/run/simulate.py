"""``wedmcam simulate``: a program on a simulated controller, with everything that goes wrong."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli import simulated
from wedmcam.cli.files import read_input, read_program, shown_name, write_outputs
from wedmcam.cli.options import switches_in
from wedmcam.cli.outputs import check_names, check_picture, picture_bytes
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import typed
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.operations.simulate import Simulation, stated_in


def run_simulate(
    program: str,
    controller: str,
    scenario: str | None,
    state: str | None,
    resume: str | None,
    pulses: str | None,
    plot: str | None,
    **params: Any,
) -> int:
    """Run ``wedmcam simulate``; return the exit status."""
    inputs = [program, *(name for name in (scenario, resume) if name is not None)]
    if inputs.count("-") > 1:
        raise click.UsageError("only one input can be standard input")
    # A state may be gone on from and replaced by the next one.
    outputs = [name for name in (pulses, plot, None if state == resume else state) if name]
    check_names(inputs, outputs)
    check_picture(plot)
    if params["json_"] and "-" in outputs:
        raise click.UsageError("--json takes standard output: give --pulses and --plot a file")
    data = read_program(program)
    texts = {name: read_input(name) for name in inputs[1:]}
    with waiting(f"simulating {shown_name(program)}"):
        simulation = api.simulate_program(
            data,
            controller=controller,
            scenario=None if scenario is None else (scenario, texts[scenario]),
            resume=None if resume is None else (resume, texts[resume]),
            faults=params["faults"],
            stop_at_power=state is not None,
            strict=params["strict"],
            name=shown_name(program),
            **_stated(params, texts.get(scenario or "")),
        )
    print_findings(simulation.findings, shown_name(program), params["quiet"], texts)
    saved = _write(simulation, program, state, pulses, plot)
    if params["json_"]:
        print_json({**simulation.summary, "state": saved})
    elif not params["quiet"]:
        simulated.print_simulation(simulation, params["verbose"], saved)
        if state is not None and saved is None:
            _print_no_state(simulation, state)
    return simulation.status


def _stated(params: dict[str, Any], scenario: bytes | None) -> dict[str, Any]:
    """Return the conditions that were stated, by the names of their fields.

    Args:
        params: of the command.
        scenario: the file; its feed wins over the one of a shop's settings.

    Raises:
        UsageError: a seed without something to draw, a servo without a gap or with another feed.
    """
    count, seed = params["random_count"], params["seed"]
    if count is None and params["servo"] is None and seed is not None:
        raise click.UsageError("--seed draws faults, or a gap: give --random N or --servo LAW")
    if params["servo"] is not None and params["feed_um"] is not None:
        raise click.UsageError("--servo feeds the wire by itself: leave --feed out")
    if params["servo"] is not None and params["dry_ms"] is not None:
        raise click.UsageError("--servo needs the generator, which is off in a dry run")
    stated = {
        name: params[name]
        for name in ("backlash", "play", "approach", "true_approach", "dry_ms", "return_ms")
    }
    switches, run_off = switches_in(params)
    return {
        **stated,
        "profile": params["profile"],
        "switches": switches,
        "run_off": run_off,
        # A step is 1 um.
        "feed": None if (feed := _feed(params["feed_um"], scenario)) is None else feed / 60,
        "random": None if count is None else (count, seed or 0),
        "servo": None if params["servo"] is None else (params["servo"], seed or 0),
    }


def _feed(feed_um: float | None, scenario: bytes | None) -> float | None:
    """Return the feed of the options, um a minute, where it wins over the scenario's."""
    if feed_um is None or scenario is None or "feed_um" in typed(click.get_current_context()):
        return feed_um
    stated, _ = stated_in("", scenario)
    return feed_um if stated is None or stated.feed is None else None


def _write(
    simulation: Simulation, program: str, state: str | None, pulses: str | None, plot: str | None
) -> str | None:
    """Write what was asked for; return the name of the state, where one is written."""
    files: list[tuple[str, bytes | Iterable[bytes]]] = []
    saved = None
    if state is not None and simulation.state is not None:
        files.append((state, simulation.state))
        saved = state
    if simulation.record is not None:
        if pulses is not None:
            lines = api.pulse_lines(simulation.record)
            files.append((pulses, (piece.encode("ascii") for piece in lines)))
        if plot is not None:
            of = simulation.record, Path(program).name
            image = picture_bytes(plot, lambda: api.plot_run(*of), lambda: api.plot_run_html(*of))
            files.append((plot, image))
    write_outputs(files)
    for name in (pulses, plot):
        if name is not None and simulation.record is None:
            print_text(f"{name} was not written: nothing was run", err=True)
    return saved


def _print_no_state(simulation: Simulation, state: str) -> None:
    """Say that there is nothing to go on from, and that a state of another run may lie there."""
    why = "nothing was run" if simulation.record is None else "the program is at its end"
    left = f"; {state} is as it was, of another run" if Path(state).exists() else ""
    print_text(f"{state} was not written: {why}{left}", err=True)

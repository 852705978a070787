"""``wedmcam simulate``: a program on a simulated controller, with everything that goes wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli import simulated
from wedmcam.cli.files import read_input, read_program, shown_name, write_outputs
from wedmcam.cli.outputs import check_names, check_picture
from wedmcam.cli.progress import waiting
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.operations.simulate import Simulation


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
            **_stated(params),
        )
    print_findings(simulation.findings, shown_name(program), params["quiet"], texts)
    saved = _write(simulation, program, state, pulses, plot)
    if params["json_"]:
        print_json({**simulation.summary, "state": saved})
    elif not params["quiet"]:
        simulated.print_simulation(simulation, params["verbose"], saved)
    return simulation.status


def _stated(params: dict[str, Any]) -> dict[str, Any]:
    """Return the conditions that were stated, by the names of their fields.

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
    return {
        **stated,
        # A step is 1 um.
        "feed": None if params["feed_um"] is None else params["feed_um"] / 60,
        "random": None if count is None else (count, seed or 0),
        "servo": None if params["servo"] is None else (params["servo"], seed or 0),
    }


def _write(
    simulation: Simulation, program: str, state: str | None, pulses: str | None, plot: str | None
) -> str | None:
    """Write what was asked for; return the name of the state, where one is written."""
    files: list[tuple[str, bytes]] = []
    saved = None
    if state is not None and simulation.state is not None:
        files.append((state, simulation.state))
        saved = state
    if simulation.record is not None:
        if pulses is not None:
            files.append((pulses, "".join(api.pulse_lines(simulation.record)).encode("ascii")))
        if plot is not None:
            files.append((plot, _picture(simulation, Path(program).name, plot)))
    write_outputs(files)
    for name in (pulses, plot):
        if name is not None and simulation.record is None:
            print_text(f"{name} was not written: nothing was run", err=True)
    return saved


def _picture(simulation: Simulation, title: str, name: str) -> bytes:
    """Return the picture of a run as the bytes of the format that its name tells."""
    assert simulation.record is not None
    suffix = Path(name).suffix.lower()
    if suffix == ".html":
        return api.plot_run_html(simulation.record, title).encode("utf-8")
    svg = api.plot_run(simulation.record, title)
    if suffix != ".png":
        return svg.encode("utf-8")
    import resvg_py  # a large library, for PNG alone

    return bytes(resvg_py.svg_to_bytes(svg_string=svg, zoom=2))

"""``wedmcam plot``: a picture of a drawing or of a program."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name, write_outputs
from wedmcam.cli.outputs import check_names, check_picture, picture, picture_bytes, write_refused
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import typed
from wedmcam.cli.source import Source
from wedmcam.cli.terminal import print_findings
from wedmcam.compiler.results import Compilation, Inspection, Proof
from wedmcam.formats.names import FORMAT_OF_SUFFIX, PROGRAM_FORMATS
from wedmcam.machines import Machine


def run_plot(input_: str, output: str, contours: bool, tape: bool, **params: Any) -> int:
    """Run ``wedmcam plot``; return the exit status."""
    check_names([input_], [output])
    # A picture shows the program; a drawing is one to cut by.
    shown = Path(output).suffix.lower() != ".dxf"
    if shown:
        check_picture(output)
    data, name = read_input(input_), shown_name(input_)
    if tape:
        return _plot_tape(data, name, output)
    result: Compilation | Inspection | Proof
    if Path(input_).suffix.lower() in FORMAT_OF_SUFFIX or _is_program(data):
        machine = _machine_of_program(name, params)
        options = ask.options_to_read(params)
        texts: dict[str, str | bytes] = {}
        with waiting(f"drawing {name}"):
            result = api.verify(data, profile=machine, name=name, options=options, shown=shown)
    else:
        if contours:
            ask.warn_of_idle({*ask.PATH_NAMES, "feed_um"}, "with --contours nothing is compiled")
        named = params["profile"]
        machine = ask.machine_of(named, None) if named else None
        if contours:
            source = Source(name, data, ask.options_to_inspect(params))
        else:
            source = Source(name, data, ask.options_of(params, answers=False))
        texts = source.texts
        result = _draw_source(source, machine, contours)
    print_findings(result.findings, name, params["quiet"], texts)
    return _write(result, name, output, shown)


def _plot_tape(data: bytes, name: str, output: str) -> int:
    """Write the picture of a punched tape; return the exit status."""
    if not _is_tape(data):
        raise click.UsageError(f"{name} is no punched tape: --tape is for those of the NBY-15")
    title = Path(name).name
    if Path(output).suffix.lower() in (".html", ".dxf"):
        raise click.UsageError("the picture of a tape is .svg or .png")
    image = picture_bytes(output, lambda: api.plot_tape(data, title))
    write_outputs([(output, image)])
    return 0


def _is_tape(data: bytes) -> bool:
    from wedmcam.frontends.identify import identify

    seen = identify(data)
    return seen.format == "nby15"


def _is_program(data: bytes) -> bool:
    from wedmcam.frontends.identify import identify

    seen = identify(data)
    return seen.format in PROGRAM_FORMATS


def _machine_of_program(name: str, params: dict[str, Any]) -> Machine | None:
    """Return the machine to read a program with; warn of options of drawings."""
    named = ask.profile_in(params, typed(click.get_current_context()))
    idle = {*ask.DRAWING_NAMES, *ask.PATH_NAMES, "feed_um"}
    ask.warn_of_idle(idle, f"{name} is a program as it stands")
    return ask.machine_of(named, None) if named else None


def _draw_source(
    source: Source, machine: Machine | None, contours: bool
) -> Compilation | Inspection:
    """Look at a source, or compile it."""
    with waiting(f"drawing {source.name}"):
        if contours:
            return api.inspect(source.data, name=source.name, options=source.options)
        return api.compile(source.data, profile=machine, name=source.name, options=source.options)


def _write(result: Compilation | Inspection | Proof, name: str, output: str, shown: bool) -> int:
    """Write the picture, or the path as a drawing; return the exit status."""
    title = Path(name).name
    if result.status:
        if shown:
            write_refused(result, title, output, name)
    elif shown:
        write_outputs([(output, picture(result, title, output))])
    elif not isinstance(result, Inspection) and result.program is not None:
        write_outputs([(output, api.path_drawing(result.program, result.machine))])
    else:
        raise click.UsageError(f"{output}: a DXF holds the path of a good program, there is none")
    return int(result.status)

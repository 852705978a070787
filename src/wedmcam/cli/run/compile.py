"""``wedmcam compile``: source to program, the main job.

One program is compiled here, or its path as a drawing; programs in several formats in
`wedmcam.cli.together`, programs that do not fit the memory in `wedmcam.cli.split`.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import write_outputs
from wedmcam.cli.outputs import (
    Outputs,
    check_names,
    check_picture,
    check_terminal,
    print_nothing_written,
    program_files,
    write_refused,
)
from wedmcam.cli.source import compile_source, measure_arithmetics, read_source
from wedmcam.cli.terminal import print_json
from wedmcam.compiler.results import Compilation
from wedmcam.machines import Machine
from wedmcam.programs.places import with_time


def run_compile(
    input_: str, to: str | None, split: bool, dump_after: tuple[str, ...], **params: Any
) -> int:
    """Run ``wedmcam compile``; return the exit status."""
    names = [params.pop(name) for name in ("output", "certificate", "plot_", "map_", "sheet")]
    outputs = Outputs(*names)
    output, plot_ = outputs.program, outputs.plot
    formats = to if to is not None and "," in to else None
    _check_one_program(outputs, dump_after, split or formats is not None, params)
    if formats is not None:
        if split:
            raise click.UsageError("--split takes one format: formats part at other places")
        check_picture(plot_)
        from wedmcam.cli.together import compile_together  # compares programs: with all readers

        return compile_together(input_, outputs, formats, params)
    as_drawing = to == "dxf" or (to is None and Path(output).suffix.lower() == ".dxf")
    machine = _machine(output, to, as_drawing, params["profile"])
    check_names([input_], outputs.names)
    if output == "-" and params["json_"]:
        raise click.UsageError("--json and the program cannot both be standard output")
    check_picture(plot_)
    if split:
        _check_split(output, as_drawing, params)
        from wedmcam.cli.split import compile_split

        return compile_split(input_, machine, outputs, params)
    return _compile_one(input_, machine, outputs, as_drawing, dump_after, params)


def _check_one_program(
    outputs: Outputs, stages: tuple[str, ...], several: bool, params: dict[str, Any]
) -> None:
    """Refuse for several programs what one alone can have."""
    if stages and (outputs.program == "-" or params["json_"] or several):
        raise click.UsageError(
            "--dump-after takes standard output, of one program: not with -o -, --json, --split or "
            "many formats"
        )
    if outputs.sheet is not None and several:
        raise click.UsageError("--setup-sheet is for one program: not with --split or many formats")


def _check_split(output: str, as_drawing: bool, params: dict[str, Any]) -> None:
    """Refuse with ``--split`` what is no whole program in a file."""
    if as_drawing or output == "-":
        raise click.UsageError("--split writes several programs: give -o NAME of a program")
    if params["from_block"]:
        raise click.UsageError("--split parts a whole program: not what --from-block leaves")
    if params["blocks"]:
        raise click.UsageError("--split parts a whole program: --blocks is one of its loads")


def _machine(output: str, to: str | None, as_drawing: bool, profile: str | None) -> Machine:
    """Return the machine of the profile and of the format that ``--to`` or the name tells."""
    named = ask.machine_of(profile, None) if profile else None
    machine = ask.machine_of(profile, None if as_drawing else ask.format_of(output, to, named))
    if not as_drawing:
        ask.warn_of_name(output, machine.format)
    return machine


def _compile_one(
    input_: str,
    machine: Machine,
    outputs: Outputs,
    as_drawing: bool,
    stages: tuple[str, ...],
    params: dict[str, Any],
) -> int:
    """Compile to one program, or to its path as a drawing; write it and report."""
    source = read_source(input_, params)
    compilation = compile_source(source, machine, outputs.program, params, stages)
    if not compilation.ok:
        return _report_refused(compilation, outputs, source.name, params["json_"])
    arithmetics = measure_arithmetics(compilation, source, params)
    if not as_drawing:
        check_terminal(outputs.program, machine)
    assert compilation.data is not None
    assert compilation.program is not None
    data = api.path_drawing(compilation.program, machine) if as_drawing else compilation.data
    files = program_files(compilation, outputs, data)
    if outputs.sheet is not None:
        files.append((outputs.sheet, _sheet(compilation, outputs, outputs.sheet, params)))
    write_outputs(files)
    feed = ask.feed_of(params)
    if not params["quiet"]:
        report.print_report(compilation, outputs.program, params["verbose"])
        report.print_arithmetic(arithmetics)
        report.print_time(compilation.summary, feed)
    if params["json_"]:
        print_json({**with_time(compilation.summary, feed), **arithmetics})
    return 0


def _report_refused(compilation: Compilation, outputs: Outputs, source: str, json_: bool) -> int:
    """Draw what is refused, where a picture is asked for; say that no program was written."""
    if json_:
        print_json(compilation.summary)
    drawn = outputs.plot is not None and write_refused(
        compilation, Path(source).name, outputs.plot, source
    )
    print_nothing_written(outputs.program, "no program" if drawn else "nothing")
    return int(compilation.status)


def _sheet(compilation: Compilation, outputs: Outputs, name: str, params: dict[str, Any]) -> bytes:
    """Return the setup sheet; it shows the picture that is written with it."""
    plot = outputs.plot
    from wedmcam.reports.setup_sheet import write_sheet

    return write_sheet(
        compilation,
        Path(outputs.program).name,
        name,
        ask.feed_of(params),
        wire_um=params["wire_um"],
        gap_um=params["gap_um"],
        picture="" if plot is None else os.path.relpath(plot, Path(name).parent),
    )

"""``wedmcam compile --to 3b,compact``: several programs of one source, all written or none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import write_outputs
from wedmcam.cli.outputs import Outputs, check_names, program_files, write_refused
from wedmcam.cli.progress import waiting
from wedmcam.cli.source import Source, read_source
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.machines import Machine
from wedmcam.operations import together
from wedmcam.programs.places import with_time


def compile_together(input_: str, outputs: Outputs, to: str, params: dict[str, Any]) -> int:
    """Compile for each format of ``to``; names are the program's with the ending of each.

    Certificates and maps are one a program: ``FILE.json`` becomes ``FILE.3b.json``. The picture is
    of the first.
    """
    if outputs.program == "-":
        raise click.UsageError("several programs do not fit standard output: give -o NAME")
    formats = together.formats_of(to)
    machines = _machines(formats, params["profile"])
    each = _outputs_of_each(outputs, together.names_of(outputs.program, formats))
    check_names([input_], [name for one in each for name in one.names])
    source = read_source(input_, params)
    programs = _compile(source, machines, each, params["profile"])
    print_findings(programs.findings, source.name, params["quiet"], source.texts)
    if not programs.ok:
        if outputs.plot is not None:
            refused = next(
                (one for one in programs.compilations if not one.ok), programs.compilations[0]
            )
            write_refused(refused, Path(source.name).name, outputs.plot, source.name)
        print_text("no program was written", err=True)
        return programs.status
    files = []
    for one, names in zip(programs.compilations, each, strict=True):
        assert one.data is not None
        files += program_files(one, names, one.data)
    write_outputs(files)
    feed = ask.feed_of(params)
    if not params["quiet"]:
        _print_reports(programs, each, params["verbose"])
        report.print_time(programs.compilations[0].summary, feed)
    if params["json_"]:
        print_json([with_time(one.summary, feed) for one in programs.compilations])
    return 0


def _compile(
    source: Source, machines: list[Machine], each: list[Outputs], profile: str | None
) -> together.Several:
    named = [ask.machine_of(profile, None).format] if profile else []
    with waiting(f"compiling {source.name}"):
        return together.compile_several(
            source.data,
            machines,
            name=source.name,
            output_names=[one.program for one in each],
            options=source.options,
            named=named,
        )


def _print_reports(programs: together.Several, each: list[Outputs], verbose: bool) -> None:
    for k, (one, names) in enumerate(zip(programs.compilations, each, strict=True)):
        report.print_report(one, names.program, verbose, rows=k == 0)  # one plan serves all
    print_text(
        f"the same path in {len(each)} formats: at most {max(programs.apart_um):.2f} um apart",
        err=True,
    )


def _machines(formats: list[str], profile: str | None) -> list[Machine]:
    """Return a machine a format; ``--profile`` is for the one of its format."""
    if profile is None:
        return [ask.machine_of(None, format_) for format_ in formats]
    named = ask.machine_of(profile, None)
    if not any(named.is_of(f) for f in formats):
        raise click.UsageError(
            f"the profile '{named.name}' is for {named.format}, not for {', '.join(formats)}"
        )
    return [named if named.is_of(f) else ask.machine_of(None, f) for f in formats]


def _outputs_of_each(outputs: Outputs, programs: list[str]) -> list[Outputs]:
    """Return the outputs of each program; the picture is of the first."""
    each = []
    for k, program in enumerate(programs):
        certificate, map_ = _beside(outputs.certificate, program), _beside(outputs.map, program)
        plot = outputs.plot if k == 0 else None
        each.append(replace(outputs, program=program, certificate=certificate, plot=plot, map=map_))
    return each


def _beside(name: str | None, program: str) -> str | None:
    """Return the name of what goes with one of several programs.

    >>> _beside("plate.json", "out/plate.3b")
    'plate.3b.json'
    """
    if name is None:
        return None
    path = Path(name)
    return str(path.with_suffix(Path(program).suffix + path.suffix))

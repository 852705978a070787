"""``wedmcam check``: everything but writing a program."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import write_outputs
from wedmcam.cli.outputs import check_names, check_picture, picture, write_refused
from wedmcam.cli.source import compile_source, measure_arithmetics, read_source
from wedmcam.cli.terminal import print_json
from wedmcam.compiler.results import Compilation
from wedmcam.programs.places import with_time


def run_check(
    input_: str, to: str | None, plot_: str | None, dump_after: tuple[str, ...], **params: Any
) -> int:
    """Run ``wedmcam check``; return the exit status."""
    if dump_after and params["json_"]:
        raise click.UsageError("--dump-after takes standard output: not with --json")
    machine = ask.machine_of(params["profile"], to)
    if plot_ is not None:
        check_names([input_], [plot_])
        check_picture(plot_)
    source = read_source(input_, params)
    compilation = compile_source(source, machine, "", params, dump_after)
    arithmetics = measure_arithmetics(compilation, source, params) if compilation.ok else {}
    if plot_ is not None:
        _write_picture(compilation, plot_, source.name)
    feed = ask.feed_of(params)
    if compilation.ok and not params["quiet"]:
        report.print_report(compilation, "(not written)", params["verbose"])
        report.print_arithmetic(arithmetics)
        report.print_time(compilation.summary, feed)
    if params["json_"]:
        print_json({**with_time(compilation.summary, feed), **arithmetics})
    return int(compilation.status)


def _write_picture(compilation: Compilation, plot: str, source: str) -> None:
    title = Path(source).name
    if compilation.ok:
        write_outputs([(plot, picture(compilation, title, plot))])
    else:
        write_refused(compilation, title, plot, source)

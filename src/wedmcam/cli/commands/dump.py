"""``wedmcam dump``: the blocks of a program, with their addresses and where they end."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import ReadsPrograms


@click.command("dump", cls=ReadsPrograms)
@click.argument("file")
@click.option(
    "--format",
    "format_",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b, nby15, dem15; else by name, content.",
)
@ask.machine_options
@ask.d_option
@ask.reading_options
@click.option(
    "--tape",
    is_flag=True,
    help="The tape itself, a line a row of holes (nby15; a picture: wedmcam plot --tape).",
)
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
def dump_command(**params: Any) -> int:
    """The blocks of a program, with their addresses and where they end."""
    from wedmcam.cli.run.dump import run_dump

    return run_dump(**params)

"""``wedmcam diff``: two programs, any formats, compared as step paths."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.lengths import length
from wedmcam.cli.settings import ReadsPrograms


@click.command("diff", cls=ReadsPrograms)
@click.argument("a")
@click.argument("b")
@click.option(
    "--within", "within_um", type=length("within_um"), default="1um", help="As far apart is equal."
)
@click.option("--profile", metavar="NAME|FILE", help="Of the first; by name and content else.")
@click.option("--profile-b", metavar="NAME|FILE", help="Of the second.")
@ask.d_option
@ask.reading_options
@ask.reading_options_b
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Only the exit status.")
def diff_command(**params: Any) -> int:
    """Two programs, any formats, compared as step paths.

    Exit status: 0 equal, 1 different, 2 one cannot be read. Blocks need not match; leads and moves
    count. Where the programs start does not.
    """
    from wedmcam.cli.run.diff import run_diff

    return run_diff(**params)

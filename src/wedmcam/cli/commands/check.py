"""``wedmcam check``: everything but writing a program."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import Configured


@click.command("check", cls=Configured)
@click.argument("input_", metavar="INPUT")
@click.option(
    "--to",
    metavar="FORMAT",
    help="3b (default), compact, rotation, compensation, iso, 4b, nby15 or dem15.",
)
@click.option(
    "--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the verified program there."
)
@ask.compile_options
@ask.feed_option
@ask.dump_option
@ask.said_options
def check_command(**params: Any) -> int:
    """Everything but writing a program."""
    from wedmcam.cli.run.check import run_check

    return run_check(**params)

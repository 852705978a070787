"""``wedmcam verify``: prove a program against its drawing."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.lengths import POINT
from wedmcam.cli.settings import Configured


@click.command("verify", cls=Configured)
@click.argument("program")
@click.option("--against", metavar="INPUT", help="The drawing that the program is to cut.")
@click.option(
    "--format",
    "format_",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b, nby15, dem15; else by name, content.",
)
@click.option("--origin", type=POINT, help="Where the program starts in the drawing, X,Y in mm.")
@click.option(
    "--fit-origin",
    is_flag=True,
    help="Find where it starts by fitting, also where thread points are given.",
)
@ask.turning_options
@click.option(
    "--certificate",
    metavar="FILE.json",
    help="Re-check this certificate where it exists (options and origin come from it); else write "
    "it there.",
)
@click.option("--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the program there.")
@click.option(
    "--metamorphic",
    is_flag=True,
    help="Also compile the drawing rotated, mirrored, reversed, threaded elsewhere: its programs "
    "must be images of each other.",
)
@ask.d_option
@ask.reading_options
@ask.compile_options
@ask.feed_option
@ask.said_options
def verify_command(**params: Any) -> int:
    """Decode a program, run it on the controller's interpolator, compare it with the drawing."""
    from wedmcam.cli.run.verify import run_verify

    return run_verify(**params)

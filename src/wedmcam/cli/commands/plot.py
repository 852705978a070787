"""``wedmcam plot``: a picture of a drawing or of a program."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import Configured


@click.command("plot", cls=Configured)
@click.argument("input_", metavar="INPUT|PROGRAM")
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILE",
    help="FILE.svg, FILE.png, FILE.html or FILE.dxf; - for SVG to stdout.",
)
@click.option("--contours", is_flag=True, help="Only what was drawn; nothing is compiled.")
@click.option("--tape", is_flag=True, help="The punched tape of a program (nby15).")
@ask.d_option
@ask.reading_options
@ask.compile_options
@ask.feed_option
@ask.said_options
def plot_command(**params: Any) -> int:
    """A picture: part, kept material, wire path, thread points, block numbers.

    The wire path of a drawing is that of the verified program. A drawing that is refused is drawn
    with the places marked.
    """
    from wedmcam.cli.run.plot import run_plot

    return run_plot(**params)

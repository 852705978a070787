"""``wedmcam compile``: source to program, the main job.

One program is compiled here, or its path as a drawing; programs in several formats in
`wedmcam.cli.together`, programs that do not fit the memory in `wedmcam.cli.split`.
"""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import Configured


@click.command("compile", cls=Configured)
@click.argument("input_", metavar="INPUT")
@click.option(
    "-o", "--output", required=True, metavar="FILE", help="Where the program goes; - for stdout."
)
@click.option(
    "--to",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b, nby15, dem15, or dxf (the stepped path); "
    "by default from the output's name. Several (3b,iso): NAME with the ending of each.",
)
@ask.compile_options
@click.option(
    "--split",
    is_flag=True,
    help="Over the memory: several files NAME-1, NAME-2, ..., cut at thread points, in the "
    "kerf where one contour is longer.",
)
@click.option("--certificate", metavar="FILE.json", help="Write the certificate there.")
@click.option(
    "--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the verified program there."
)
@click.option(
    "--map", "map_", metavar="FILE.json", help="Write there which block was drawn by what."
)
@click.option(
    "--setup-sheet",
    "sheet",
    metavar="FILE.md|txt|html",
    help="Write there what the machine needs: start holes, zero, what to do at each stop.",
)
@ask.feed_option
@ask.dump_option
@ask.said_options
def compile_command(**params: Any) -> int:
    """Source to program: the main job.

    Nothing is written that was not decoded again, stepped on the controller and compared with the
    drawing.
    """
    from wedmcam.cli.run.compile import run_compile

    return run_compile(**params)

"""``wedmcam batch``: many drawings, folders and patterns into a mirrored tree of proven programs.

`wedmcam.batch` finds and does the work; here outcomes are shown as they come, and how a drawing is
compiled is taken from the settings of its own folder.
"""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import Configured


@click.command("batch", cls=Configured)
@click.argument("inputs", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="DIR", help="Folder of the programs.")
@click.option(
    "--to",
    metavar="FORMAT",
    help="3b (default), compact, rotation, compensation, iso, 4b, nby15 or dem15.",
)
@click.option("--jobs", type=click.IntRange(0, 256), default=0, help="Processes; 0: one a core.")
@click.option("--force-units", is_flag=True, help="--units overrides what drawings say.")
@ask.compile_options
@ask.feed_option
@ask.said_options
def batch_command(**params: Any) -> int:
    """The same for many files, folders and patterns, into a mirrored tree.

    --json prints one line an item. One bad file never stops the others; the exit status is the
    largest of the items'. Each drawing is made as the wedmcam.toml of its own folder says.
    """
    from wedmcam.cli.run.batch import run_batch

    return run_batch(**params)

"""``wedmcam inspect``: what is in a drawing."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import Configured


@click.command("inspect", cls=Configured)
@click.argument("input_", metavar="INPUT")
@ask.drawing_options
@ask.side_option
@ask.layer_side_option
@ask.said_options
def inspect_command(**params: Any) -> int:
    """What the reader saw: units, size, entities, contours, gaps, the largest offset that fits."""
    from wedmcam.cli.run.inspect import run_inspect

    return run_inspect(**params)

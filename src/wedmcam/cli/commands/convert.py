"""``wedmcam convert``: one program format into another, proven equal before it is written."""

from __future__ import annotations

from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.lengths import length
from wedmcam.cli.settings import ReadsPrograms


@click.command("convert", cls=ReadsPrograms)
@click.argument("program")
@click.option("-o", "--output", required=True, help="Where the other program goes; - for stdout.")
@click.option("--to", metavar="FORMAT", help="Of the output; by default from its name.")
@click.option("--format", "format_", metavar="FORMAT", help="Of PROGRAM; else by name, content.")
@click.option("--profile", metavar="NAME|FILE", help="Profile of the output.")
@ask.turning_options
@click.option("--gap", "gap_um", type=length("gap_um"), help="Of a compensation or 4B file.")
@click.option(
    "--side",
    type=click.Choice(["part", "die"]),
    default="part",
    help="Of such a file: part outwards, die inwards.",
)
@click.option(
    "--corner",
    "corner_um",
    type=length("corner_um"),
    help="Radius of the arcs at corners of a compensation file; the gap where it is left out.",
)
@click.option(
    "--transform",
    "transforms",
    multiple=True,
    metavar="TEXT",
    help="Write images of the program, which starts at (0, 0): such as 'translate (10, 0) copies "
    "5', 'with symmetry x', 'rotate 10 copies 35 about (0, 0)', lengths in mm; repeat, in order.",
)
@ask.d_option
@ask.reading_options
@ask.feed_option
@click.option("--json", "json_", is_flag=True, help="Summary as JSON on standard output.")
@click.option("--strict", is_flag=True, help="Warnings are errors: nothing may get lost.")
@click.option("-q", "--quiet", is_flag=True, help="Errors only.")
def convert_command(**params: Any) -> int:
    """One program format into another, from the path that its controller steps.

    The result is decoded again and must be the same path within 1 um (rotation: 2 um), else nothing
    is written. With --transform it is that of the images, each of whose vertices is stepped within
    1 um of the exact one; an image that starts elsewhere is reached with the generator off, between
    pauses. Exit status: 0 done, 1 the program cannot be read or the other format cannot state it, 3
    the paths differ.
    """
    from wedmcam.cli.run.convert import run_convert

    return run_convert(**params)

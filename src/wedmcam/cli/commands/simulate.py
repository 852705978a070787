"""``wedmcam simulate``: a program on a simulated controller, with everything that goes wrong."""

from __future__ import annotations

import re
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.lengths import length_um
from wedmcam.cli.settings import Configured


class Um(click.ParamType):  # type: ignore[type-arg]
    """Two lengths of whole um, of x and y: 12,15 or 12um,15um or 0.012mm,0.015mm."""

    name = "x,y"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        """Return both, um; a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        lengths = [_whole_um(text) for text in str(value).split(",")]
        if len(lengths) != 2 or None in lengths:
            self.fail(f"'{value}': write whole um of x and y, 0 to 9999, as in 12,15", param, ctx)
        x, y = (length or 0 for length in lengths)
        return x, y


def _whole_um(text: str) -> int | None:
    """Return a length of whole um; None where it is none. A bare number is um here.

    >>> [_whole_um(t) for t in ("12", "12um", "0.012mm", "12.5", "-1", "10000")]
    [12, 12, 12, None, None, None]
    """
    if text.strip().isdecimal():
        um = float(text)
    elif re.search(r"[a-zµ\"]\s*$", text):  # without a unit 0.012 may be meant as mm
        try:
            um = length_um(text)
        except ValueError:
            return None
    else:
        return None
    return int(um) if um == int(um) and 0 <= um <= 9999 else None


class Signs(click.ParamType):  # type: ignore[type-arg]
    """Two directions, of x and y: +,-."""

    name = "x,y"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        """Return +1 or -1 for both; a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        match = re.fullmatch(r"\s*([+-])\s*,\s*([+-])\s*", str(value))
        if match is None:
            self.fail(f"'{value}': write the directions of x and y, as in +,-", param, ctx)
        return int(f"{match[1]}1"), int(f"{match[2]}1")


_DELAY = click.IntRange(1, 9999)


@click.command("simulate", cls=Configured)
@click.argument("program")
@click.option(
    "--controller",
    type=click.Choice(["zd065", "nby15", "eindhoven", "dem15"]),
    default="zd065",
    show_default=True,
    help="Which machine; eindhoven is the microcomputer of a DEM-15.",
)
@click.option(
    "--profile", metavar="NAME", help="A built-in one, where the format has several: dem15-steps."
)
@ask.switch_options
@click.option(
    "--backlash", type=Um(), metavar="X,Y", help="As entered, um. Without it nothing is cut."
)
@click.option("--play", type=Um(), metavar="X,Y", help="Of the screws, um; as the backlash if not.")
@click.option("--approach", type=Signs(), help="Last directions as entered; +,+ if not.")
@click.option("--true-approach", type=Signs(), help="As they were; as entered if not.")
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="FAULT",
    help="short@STEP:LENGTH_UM, break@STEP[:BLOCK], power@STEP[+PULSES]; of the others stop@STEP, "
    "limit@STEP, tape@STEP; repeat.",
)
@click.option("--scenario", metavar="FILE.toml", help="What happens, as a file.")
@click.option(
    "--random",
    "random_count",
    type=click.IntRange(1, 9999),
    metavar="N",
    help="N random faults, of --seed.",
)
@click.option(
    "--servo",
    type=click.Choice(["patent", "eindhoven", "feed"]),
    help="A servo feeds the wire, pulse by pulse, in a gap of --seed; docs/servo.md.",
)
@click.option("--seed", type=click.IntRange(0, 999_999_999), metavar="N", help="0 if not given.")
@click.option(
    "--dry-run",
    "dry_ms",
    type=_DELAY,
    metavar="MS",
    help="Draw with the pen, generator off, MS a step.",
)
@ask.feed_option
@click.option(
    "--return-delay",
    "return_ms",
    type=_DELAY,
    metavar="MS",
    help="Of a step on ways back, moves and take-up; 5 if not given.",
)
@click.option("--state", metavar="FILE", help="Where a power cut ends the run, its state goes.")
@click.option("--resume", metavar="FILE", help="Go on from a state.")
@click.option("--pulses", metavar="FILE.csv", help="Every step of the motors; - for stdout.")
@click.option("--plot", metavar="FILE", help="FILE.svg, .png or .html: the path, and J over time.")
@click.option("--json", "json_", is_flag=True, help="The result as JSON on standard output.")
@click.option("--strict", is_flag=True, help="Warnings are errors.")
@click.option("-q", "--quiet", is_flag=True, help="Findings alone.")
@click.option("-v", "--verbose", is_flag=True, help="Every event.")
def simulate_command(**params: Any) -> int:
    """A program on a simulated controller, with play, short circuits, wire breaks, power cuts.

    PROGRAM is one that the controller runs (.zd, .n15, .d15). STEP counts the steps of its path.
    A power cut ends the run where there is --state, which --resume goes on from; else the state is
    saved, and cutting goes on from it. The feed signal is that of --feed, 2.4 mm a minute if none
    is given.
    docs/zd065.md, nby15.md and dem15.md have examples.
    """
    from wedmcam.cli.run.simulate import run_simulate

    return run_simulate(**params)

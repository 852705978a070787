"""``wedmcam panel``: the front panel of a simulated controller as text."""

from __future__ import annotations

from typing import Any

import click


@click.command("panel")
@click.argument("controller", type=click.Choice(["zd065"]))
@click.argument("image", required=False)
@click.option("--script", metavar="FILE", help="Lines of keys; - for standard input.")
@click.option("-o", "--output", metavar="FILE", help="Where the memory goes at the end.")
@click.option("--json", "json_", is_flag=True, help="The transcript as JSON on standard output.")
def panel_command(**params: Any) -> int:
    """The front panel of a simulated controller: six digits, keys 0 to F and U0 to U7.

    IMAGE is what the memory holds at first, such as a program in .zd; else it is cleared. Lines are
    keys (U5 0 0012 0015), or what happens around the machine: run, run 500, run to block 7,
    short 60, break, power off, power on, wait 5s. Time is virtual. docs/zd065.md has the keys.
    """
    from wedmcam.cli.run.panel import run_panel

    return run_panel(**params)

"""``wedmcam panel``: the panel of a simulated controller as text."""

from __future__ import annotations

from typing import Any

import click


@click.command("panel")
@click.argument("controller", type=click.Choice(["zd065", "dem15", "eindhoven"]))
@click.argument("image", required=False)
@click.option("--script", metavar="FILE", help="Lines of keys, or as typed; - for standard input.")
@click.option("-o", "--output", metavar="FILE", help="Where the memory goes at the end.")
@click.option("--json", "json_", is_flag=True, help="The transcript as JSON on standard output.")
def panel_command(**params: Any) -> int:
    """The panel of a simulated controller: zd065, or the terminal of dem15 (eindhoven).

    IMAGE is what the memory holds at first, such as a program in .zd, or in .d15; else it is
    empty. Lines are keys (U5 0 0012 0015), or what is typed at the terminal, or what happens around
    the machine: run, run 500, run to block 7, short 60, break, power off, power on, wait 5s; of the
    dem15 run to record 7, stop and limit too. Time is virtual. docs/zd065.md has the keys,
    docs/dem15.md the commands.
    """
    from wedmcam.cli.run.panel import run_panel

    return run_panel(**params)

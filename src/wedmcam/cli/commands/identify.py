"""``wedmcam identify``: which format a file is in."""

from __future__ import annotations

import click


@click.command("identify")
@click.argument("file")
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
def identify_command(file: str, json_: bool) -> int:
    """Which format a file is in."""
    from wedmcam.cli.run.identify import run_identify

    return run_identify(file, json_)

"""``wedmcam explain FILE --block N``: one block of a program, at length."""

from __future__ import annotations

import click

from wedmcam import api
from wedmcam.cli.files import read_program, shown_name
from wedmcam.cli.settings.profiles import machine_for
from wedmcam.cli.terminal import print_findings, print_text
from wedmcam.frontends.iso.dialect import QUESTIONS
from wedmcam.reports.block import explain_block
from wedmcam.targets import Entries


def print_block(
    file: str,
    number: int,
    profile: str | None,
    d: tuple[tuple[int, float], ...],
    reading: dict[str, str],
) -> int:
    """Print what a block of a program does; return the exit status."""
    machine = machine_for(file, profile)
    data = read_program(file)
    program, machine_read, findings = api.read_program(
        data, profile=machine, name=shown_name(file), entered=Entries(d=d), shown=True, **reading
    )
    if program is None:
        print_findings(findings, shown_name(file))
        return 1
    codes = QUESTIONS | {"no-gap", "iso-stated"}
    print_findings([d for d in findings if d.code in codes], shown_name(file))
    if number > len(program.blocks):
        raise click.UsageError(f"{file} has {len(program.blocks)} blocks, there is no {number}")
    for line in explain_block(program, machine_read, data, number):
        print_text(line)
    return 0

"""``wedmcam diff``: two programs, any formats, compared as step paths."""

from __future__ import annotations

from typing import Any

import click

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import Failed, Unreadable, read_program, shown_name
from wedmcam.cli.lengths import length
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import ReadsPrograms
from wedmcam.cli.settings.profiles import format_of_program, machine_for
from wedmcam.cli.terminal import print_findings, print_json
from wedmcam.diag.run import WrongUse
from wedmcam.formats.names import PROGRAM_FORMATS
from wedmcam.machines import Machine


@click.command("diff", cls=ReadsPrograms)
@click.argument("a")
@click.argument("b")
@click.option(
    "--within", "within_um", type=length("within_um"), default="1um", help="As far apart is equal."
)
@click.option("--profile", metavar="NAME|FILE", help="Of the first; by name and content else.")
@click.option("--profile-b", metavar="NAME|FILE", help="Of the second.")
@ask.d_option
@ask.reading_options
@ask.reading_options_b
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Only the exit status.")
def diff_command(
    a: str,
    b: str,
    within_um: float,
    profile: str | None,
    profile_b: str | None,
    profile_in: str | None,
    d: tuple[tuple[int, float], ...],
    json_: bool,
    quiet: bool,
    **params: Any,
) -> int:
    """Two programs, any formats, compared as step paths.

    Exit status: 0 equal, 1 different, 2 one cannot be read. Blocks need not match; leads and moves
    count. Where the programs start does not.
    """
    machines = (
        _machine_of_either(a, profile, profile_in, "--profile"),
        _machine_of_either(b, profile_b, profile_in, "--profile-b"),
    )
    try:
        one, two = read_program(a), read_program(b)
    except Failed as why:
        raise Unreadable(why.message) from why
    with waiting(f"comparing {shown_name(a)} and {shown_name(b)}"):
        difference, findings = api.diff(
            one,
            two,
            within_mm=within_um / 1000,
            names=(shown_name(a), shown_name(b)),
            profiles=machines,
            d=d,
            **ask.answers_of(params),
        )
    if difference is None:
        print_findings(findings, a)
        return 2
    if not quiet:
        print_findings([f for f in findings if f.code in ("no-gap", "iso-stated")], a)
    if json_:
        print_json(api.difference_data(difference, a, b))
    elif not quiet:
        report.print_difference(difference, a, b)
    return 0 if difference.equal else 1


def _machine_of_either(
    program: str, profile: str | None, either: str | None, option: str
) -> Machine | None:
    """Return the machine of one of two programs; None for what its name and content say.

    Args:
        program: its file.
        profile: as typed for it.
        either: as typed for both: it is taken for those of its format.
        option: how ``profile`` is typed.

    Raises:
        WrongUse: the profile is of another format than the program.
    """
    format_ = format_of_program(program)
    for named in (profile, either):
        if named is None:
            continue
        machine = machine_for(program, named)
        if machine is None or format_ not in PROGRAM_FORMATS or machine.is_of(str(format_)):
            return machine
        if named is profile:
            raise WrongUse(
                f"{option} {profile} is for {machine.format}, and {program} is {format_}"
            )
    return machine_for(program, None)

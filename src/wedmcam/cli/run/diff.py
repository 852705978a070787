"""``wedmcam diff``: two programs, any formats, compared as step paths."""

from __future__ import annotations

from typing import Any

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import Failed, Unreadable, read_program, shown_name
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings.profiles import format_of_program, machine_for
from wedmcam.cli.terminal import print_findings, print_json
from wedmcam.diag.run import WrongUse
from wedmcam.formats.names import PROGRAM_FORMATS
from wedmcam.machines import Machine


def run_diff(a: str, b: str, json_: bool, quiet: bool, **params: Any) -> int:
    """Run ``wedmcam diff``; return the exit status."""
    either = params["profile_in"]
    machines = (
        _machine_of_either(a, params["profile"], either, "--profile"),
        _machine_of_either(b, params["profile_b"], either, "--profile-b"),
    )
    try:
        one, two = read_program(a), read_program(b)
    except Failed as why:
        raise Unreadable(why.message) from why
    with waiting(f"comparing {shown_name(a)} and {shown_name(b)}"):
        difference, findings = api.diff(
            one,
            two,
            within_mm=params["within_um"] / 1000,
            names=(shown_name(a), shown_name(b)),
            profiles=machines,
            d=params["d"],
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

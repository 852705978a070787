"""``wedmcam profile``: the controllers and dialects that are known, and whether one is good."""

from __future__ import annotations

import click

JSON = click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")


@click.group("profile")
def profile_group() -> None:
    """Controllers and dialects."""


@profile_group.command("list")
@JSON
def profile_list(json_: bool) -> int:
    """The built-in profiles."""
    from wedmcam.cli.run.profile import run_list

    return run_list(json_)


@profile_group.command("show", short_help="Every value of a profile, with its meaning.")
@click.argument("name", metavar="NAME|FILE.toml")
@JSON
def profile_show(name: str, json_: bool) -> int:
    """A profile as TOML: every value in force, with its meaning; to start one of your own from."""
    from wedmcam.cli.run.profile import run_show

    return run_show(name, json_)


@profile_group.command("check", short_help="Whether a profile can be used.")
@click.argument("file", metavar="FILE.toml|NAME")
@JSON
def profile_check(file: str, json_: bool) -> int:
    """Whether a profile can be used; everything that is wrong with it at once."""
    from wedmcam.cli.run.profile import run_check

    return run_check(file, json_)


@profile_group.command("probe", short_help="What controller is this? Programs that tell.")
@click.option(
    "-o", "--output", metavar="FILE.3b", help="Write the programs and a sheet to fill in."
)
@click.option("--profile", metavar="NAME|FILE", default="b3-compact", show_default=True,
              help="Layout and control words of the programs.")  # fmt: skip
@click.option("--read", "read_", metavar="SHEET", help="Tell what a sheet that was filled in says.")
def profile_probe(output: str | None, profile: str, read_: str | None) -> int:
    """Small programs to run without a wire, and what their readings say of the controller.

    -o NAME.3b writes NAME.3b, NAME-zeros.3b, NAME-blanks.3b and NAME-end.3b, and the sheet
    NAME.txt. --read NAME.txt prints the keys of a profile that follow. The page docs/probe.md tells
    what to do and what the readings mean.
    """
    from wedmcam.cli.run.profile import run_probe

    return run_probe(output, profile, read_)

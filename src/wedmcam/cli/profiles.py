"""``wedmcam profile``: the controllers and dialects that are known, and whether one is good."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from wedmcam.diag import Diagnostic
    from wedmcam.machines import Machine

JSON = click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")


@click.group("profile")
def profile_group() -> None:
    """Controllers and dialects."""


@profile_group.command("list")
@JSON
def profile_list(json_: bool) -> int:
    """The built-in profiles."""
    from wedmcam import machines
    from wedmcam.cli import say

    rows = [
        {
            "name": name,
            "format": machine.format,
            "title": machine.title,
            "default": machines.DEFAULTS.get(machine.format) == name,
        }
        for name in machines.names()
        for machine in (machines.builtin(name),)
    ]
    if json_:
        say.say_json(rows)
        return 0
    for row in rows:
        mark = " (default)" if row["default"] else ""
        click.echo(f"{row['name']:18}  {row['format']:12}  {row['title']}{mark}")
    return 0


@profile_group.command("show", short_help="Every value of a profile, with its meaning.")
@click.argument("name", metavar="NAME|FILE.toml")
@JSON
def profile_show(name: str, json_: bool) -> int:
    """A profile as TOML: every value in force, with its meaning; to start one of your own from."""
    from wedmcam.cli import say
    from wedmcam.machines.printed import as_toml, entries

    machine, found, text = _read(name)
    say.say_findings(found, name, text=text)
    if machine is None:
        return 2
    if not json_:
        click.echo(as_toml(machine), nl=False)
        return 0
    tables: dict[str, dict[str, Any]] = {}
    for entry in entries(machine):
        tables.setdefault(entry.section, {})[entry.key] = entry.value
    say.say_json({"name": machine.name, **tables.pop("", {}), **tables})
    return 0


@profile_group.command("check", short_help="Whether a profile can be used.")
@click.argument("file", metavar="FILE.toml|NAME")
@JSON
def profile_check(file: str, json_: bool) -> int:
    """Whether a profile can be used; everything that is wrong with it at once."""
    from wedmcam.cli import say

    machine, found, text = _read(file)
    say.say_findings(found, file, text=text)
    if json_:
        from wedmcam.judge.certificate import finding_data

        told = {"file": file, "ok": machine is not None, "name": machine.name if machine else None}
        say.say_json({**told, "diagnostics": [finding_data(d) for d in found]})
    elif machine is not None:
        click.echo(f"{file}: {machine.format}, {machine.title}")
    return 0 if machine is not None else 2


def _read(name: str) -> tuple[Machine | None, list[Diagnostic], str | None]:
    """Return a profile by name or of a file, what is wrong with it, and the file's text."""
    from wedmcam import machines
    from wedmcam.cli.files import read_input

    looks_like_a_file = name == "-" or Path(name).suffix.lower() == ".toml" or Path(name).exists()
    if name in machines.names() or not looks_like_a_file:
        machine, found = machines.find(name)
        return machine, found, None
    try:
        text = read_input(name).decode("utf-8")
    except UnicodeDecodeError:
        from wedmcam.diag import FileSpan, error

        return None, [error("profile-syntax", "not UTF-8", FileSpan(name))], None
    machine, found = machines.of_file(text, "stdin" if name == "-" else name)
    return machine, found, text

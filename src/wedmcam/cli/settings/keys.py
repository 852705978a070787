"""The keys that can stand in a settings file: the long names of the options themselves."""

from __future__ import annotations

import click

NAME = "wedmcam.toml"
#: Commands whose options can stand in the file.
COMMANDS = ("compile", "check", "batch", "verify", "inspect", "plot")
#: Keys that name profiles.
PROFILES = ("profile", "profile-in")
#: Options that each say how far the wire is from the outline: the nearest level decides.
OFFSETS = frozenset({"offset", "wire", "gap"})


def key_of(option: click.Parameter) -> str | None:
    """Return the key of an option: its long name without dashes; None where it has none."""
    if not isinstance(option, click.Option):
        return None
    names = [n[2:] for n in option.opts if n.startswith("--")]
    return names[0] if names else None


def of_one_run(option: click.Option) -> bool:
    """Return whether an option names a file of one run: no default for others."""
    return option.required or (option.metavar or "").startswith(("FILE", "INPUT"))


def options_of_command(command: click.Command) -> dict[str, click.Option]:
    """Return key -> option of a command, in its order."""
    return {
        key: option
        for option in command.params
        if (key := key_of(option)) and isinstance(option, click.Option) and option.expose_value
    }


def known_options(group: click.Group) -> dict[str, click.Option]:
    """Return key -> option of all commands that take settings, in their order.

    This imports these commands: it is asked for where there is a file to read, or to list keys.
    """
    known: dict[str, click.Option] = {}
    context = click.Context(group)
    for name in COMMANDS:
        command = group.get_command(context, name)
        assert command is not None
        for key, option in options_of_command(command).items():
            known.setdefault(key, option)
    return known

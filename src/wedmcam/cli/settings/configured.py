"""Commands of click whose options have their defaults from settings files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from wedmcam.cli.settings.find import folder_of
from wedmcam.cli.settings.keys import NAME, PROFILES, options_of_command
from wedmcam.cli.settings.state import InForce, state_of
from wedmcam.option_table import Panel, rows_of

#: Keys that say how programs are read, whatever their format, and F of one that is written.
OF_PROGRAMS = {
    row.option.removeprefix("--") for row in (*rows_of(Panel.PROGRAM), *rows_of(Panel.OPERATOR))
}


class Configured(click.Command):
    """A command whose options have their defaults from settings files.

    The command itself sees no difference: its arguments are complete when it starts.
    """

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self.params.append(
            click.Option(
                ["--no-config"],
                is_flag=True,
                expose_value=False,
                help=f"Take no settings from a {NAME} (see wedmcam config).",
                callback=lambda ctx, _, value: setattr(state_of(ctx), "off", value),
            )
        )

    def invoke(self, ctx: click.Context) -> Any:
        """Complete the arguments and run."""
        from wedmcam.cli.settings.in_force import locate
        from wedmcam.diag.run import WrongUse

        force = self.in_force(ctx, folder_of(_input(ctx.params)))
        state_of(ctx).in_force = force
        ctx.params = force.params
        try:
            return super().invoke(ctx)
        except WrongUse as why:
            raise locate(why, force) or why from why

    def setting_options(self) -> dict[str, click.Option]:
        """Return key -> option of those that take settings."""
        return options_of_command(self)

    def in_force(self, ctx: click.Context, folder: Path) -> InForce:
        """Return what is in force for inputs of a folder.

        Raises:
            BadSettings: a settings file is wrong.
        """
        from wedmcam.cli.settings.in_force import in_force

        certificate = ctx.params.get("certificate")
        repeats = "program" in ctx.params and certificate and Path(certificate).exists()
        # A certificate says how its program was made: today's defaults of the shop do not apply.
        files = not (repeats or state_of(ctx).off)
        return in_force(self.setting_options(), ctx, folder, typed(ctx), files=files)


class ReadsPrograms(Configured):
    """A command that reads programs and compiles none.

    Of the settings it takes ``d`` and the answers about programs that are read; the profile is
    asked for each program (`profile_for`), as a shop has machines of several formats. A command
    that is given no program takes none.
    """

    def setting_options(self) -> dict[str, click.Option]:
        """Return key -> option of those that take settings."""
        options = super().setting_options()
        return {key: option for key, option in options.items() if key in OF_PROGRAMS}

    def in_force(self, ctx: click.Context, folder: Path) -> InForce:
        """Return what is in force for programs of a folder."""
        if "block" in ctx.params and ctx.params["block"] is None:  # explain CODE
            return InForce(params=dict(ctx.params))
        return super().in_force(ctx, folder)


def is_typed(ctx: click.Context, option: click.Parameter) -> bool:
    """Return whether an option was given on the command line."""
    return ctx.get_parameter_source(str(option.name)) not in (ParameterSource.DEFAULT, None)


def typed(ctx: click.Context) -> set[str]:
    """Return the names of the parameters that were given on the command line."""
    return {str(o.name) for o in ctx.command.params if is_typed(ctx, o)}


def also_read(ctx: click.Context) -> list[str]:
    """Return the files beside its inputs that a command reads: no output may overwrite them."""
    force = state_of(ctx).in_force
    named = [force.params.get(key.replace("-", "_")) for key in PROFILES]
    profiles = [name for name in named if name and Path(name).suffix.lower() == ".toml"]
    return [file.name for file in force.files] + profiles


def _input(params: Mapping[str, Any]) -> str | None:
    names = ("input_", "against", "program", "file", "a", "what")
    name = next((params[k] for k in names if params.get(k)), None)
    return name if isinstance(name, str) else None

"""The command line: a table of commands, each imported when it is asked for.

``--help`` and the name of the program need none of them, so they answer at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import click

from wedmcam import __version__

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

EPILOG = """Exit status: 0 done, 1 the input has errors, 2 wrong use, 3 verification failed,
70 internal error, 130 interrupted. Lengths take a unit (0.1mm, 100um, 0.004in); bare numbers
are mm. Defaults of a shop stand in a wedmcam.toml (see wedmcam config)."""

#: Command -> the attribute of ``wedmcam.cli.commands`` that it is, and what the help says of it.
COMMANDS = {
    "batch": ("batch:batch_command", "Many drawings and folders to programs."),
    "check": ("check:check_command", "Everything but writing."),
    "compile": ("compile:compile_command", "Source to program, proven."),
    "config": ("config:config_command", "The settings in force, and where each comes from."),
    "convert": (
        "convert:convert_command",
        "One program format into another, from the path that its controller steps.",
    ),
    "diff": ("diff:diff_command", "Compare two programs as step paths."),
    "dump": ("dump:dump_command", "The blocks of a program."),
    "explain": ("explain:explain_command", "What a diagnostic or a block means."),
    "identify": ("identify:identify_command", "Which format a file is in."),
    "inspect": ("inspect:inspect_command", "What is in a drawing."),
    "panel": ("panel:panel_command", "The panel of a simulated controller, as text."),
    "plot": ("plot:plot_command", "A picture of a drawing or a program."),
    "profile": ("profile:profile_group", "Controllers and dialects."),
    "simulate": ("simulate:simulate_command", "A program on a simulated controller, with faults."),
    "verify": ("verify:verify_command", "Prove a program against its drawing."),
    "zd065": ("zd065:zd065_group", "The memory of the ZD-065: show, find, move, identify."),
}


class LazyGroup(click.Group):
    """A group that imports a command when it is asked for (click's documentation: lazy loading).

    Until then a command with the same name and help stands for it, which is enough for the help of
    the group, and for the names that are near a wrong one.
    """

    def __init__(self, *arguments: Any, table: Mapping[str, tuple[str, str]], **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._places = {name: place for name, (place, _) in table.items()}
        self._named = {name: click.Command(name, help=text) for name, (_, text) in table.items()}
        self.commands.update(self._named)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, imported."""
        place = self._places.pop(cmd_name, None)
        if place is not None:
            module, _, attribute = place.partition(":")
            self.commands[cmd_name] = getattr(
                import_module(f"wedmcam.cli.commands.{module}"), attribute
            )
        return super().get_command(ctx, cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the table of commands, without importing any."""
        click.Group(commands=self._named).format_commands(ctx, formatter)


@click.group(cls=LazyGroup, table=COMMANDS, context_settings=CONTEXT, epilog=EPILOG)
@click.version_option(__version__, prog_name="wedmcam")
def cli() -> None:
    """Compile drawings to wire-EDM programs, and prove every program that is written."""

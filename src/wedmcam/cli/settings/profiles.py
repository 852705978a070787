"""For which program a profile of a settings file is: a shop has machines of several formats."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings.keys import PROFILES
from wedmcam.cli.settings.state import state_of
from wedmcam.formats.names import FORMAT_OF_SUFFIX

if TYPE_CHECKING:
    from wedmcam.cli.settings.read import Setting
    from wedmcam.machines import Machine


def profile_for(format_: str | None, keys: Iterable[str] = ("profile",)) -> Setting | None:
    """Return the nearest setting of a profile that is for a format; for any where it is None."""
    files = state_of(click.get_current_context()).in_force.files
    for setting in (file.settings.get(key) for file in files for key in keys):
        if setting and format_ in (None, ask.machine_of(setting.value, None).format):
            return setting
    return None


def machine_for(program: str, profile: str | None, format_: str | None = None) -> Machine | None:
    """Return the machine to read a program with: as typed, else as set for its format, else None.

    Raises:
        WrongUse: no such profile, or one of another format.
    """
    if profile:
        return ask.machine_of(profile, format_)
    wanted = format_ or format_of_program(program) or "none"
    setting = profile_for(wanted, reversed(PROFILES))
    return ask.machine_of(setting.value, None) if setting else None


def unfit_profile(setting: Setting, nearer: Mapping[str, Any], params: Mapping[str, Any]) -> str:
    """Return why a profile is not for this run; empty if it is.

    Args:
        setting: of the profile.
        nearer: key -> value of what is typed or nearer.
        params: of the command.
    """
    wanted = nearer.get("to") or nearer.get("format") or format_of_name(params)
    if setting.key == "profile-in":
        wanted = nearer.get("format")
    if wanted is None:
        wanted = _format_read(params)
    if wanted is None:
        return ""
    format_ = ask.machine_of(setting.value, None).format
    if format_ in (w.strip() for w in wanted.split(",")):  # --to 3b,iso: for the one it is for
        return ""
    return f"'{setting.written}' is for {format_}, not for {wanted}"


def format_of_name(params: Mapping[str, Any]) -> str | None:
    """Return the format that the name of an output tells."""
    output = params.get("output")
    return FORMAT_OF_SUFFIX.get(Path(output).suffix.lower()) if output else None


def format_of_program(program: str) -> str | None:
    """Return the format of a program by its name or content; None where neither tells."""
    return _format_read({"program": program})


def _format_read(params: Mapping[str, Any]) -> str | None:
    """Return the format of a program that is read (verify, plot); None where none is."""
    name = params.get("program") or ("output" in params and params.get("input_"))
    if not name:
        return None
    suffix = Path(name).suffix.lower()
    if suffix in FORMAT_OF_SUFFIX:
        return FORMAT_OF_SUFFIX[suffix]
    if suffix in (".dxf", ".wed") or not Path(name).is_file():
        return None if "program" not in params else "a program from standard input"
    from wedmcam.cli.files import read_input
    from wedmcam.frontends.identify import identify  # reads ISO: not for every program

    seen = identify(read_input(name)).format
    return seen if seen in FORMAT_OF_SUFFIX.values() else None

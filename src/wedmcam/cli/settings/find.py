"""Where settings files are: beside an input, in the folders above it, and the user's own."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wedmcam.cli.settings.keys import NAME
from wedmcam.cli.settings.state import state_of

if TYPE_CHECKING:
    from wedmcam.cli.settings.read import File


def user_folder() -> Path:
    """Return the user's configuration folder of this program."""
    home = os.environ.get("XDG_CONFIG_HOME")
    return Path(home) / "wedmcam" if home else Path(click.get_app_dir("wedmcam"))


def places(folder: Path) -> list[Path]:
    """Return where a settings file may be for inputs of ``folder``, nearest first."""
    return [*(f / NAME for f in (folder, *folder.parents)), user_folder() / NAME]


def folder_of(name: str | None) -> Path:
    """Return the folder of an input; the current one for standard input and for none.

    What is a folder itself (of ``batch``, ``config``) is its own.
    """
    if name is None or name == "-":
        return Path.cwd()
    path = Path(os.path.abspath(name))
    return path if path.is_dir() else path.parent


def files_for(folder: Path, ctx: click.Context) -> tuple[File, ...]:
    """Return the settings files for inputs of a folder, nearest first; each is read once a run.

    Raises:
        BadSettings: with all errors of all of them.
    """
    known = state_of(ctx).files
    there = [place for place in places(folder) if place in known or place.is_file()]
    if not there:
        return ()
    from wedmcam.cli.settings.read import BadSettings, load  # most shops have no such file

    for place in there:
        if place not in known:
            known[place] = load(place, ctx)
    files = tuple(known[place] for place in there)
    bad = [(d, f.text) for f in files for d in f.findings]
    if bad:
        raise BadSettings(bad)
    return files

"""Where settings files are: beside an input, in the folders above it, and the user's own."""

from __future__ import annotations

import os
from pathlib import Path

import click

from wedmcam.cli.settings.keys import NAME, known_options
from wedmcam.cli.settings.read import BadSettings, File, read_text
from wedmcam.cli.settings.state import state_of
from wedmcam.diag import TextSpan, error


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
    for place in places(folder):
        if place not in known:
            known[place] = _load(place, ctx)
    files = tuple(f for p in places(folder) if (f := known[p]) is not None)
    bad = [(d, f.text) for f in files for d in f.findings]
    if bad:
        raise BadSettings(bad)
    return files


def _load(path: Path, ctx: click.Context) -> File | None:
    """Return a settings file as read; None where there is none."""
    if not path.is_file():
        return None
    name = _shown(path)
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as why:
        wrong = error(
            "settings-syntax", "cannot be read: {why}", TextSpan(name, 1, 1), why=why.strerror
        )
    except UnicodeDecodeError:
        wrong = error("settings-syntax", "not UTF-8", TextSpan(name, 1, 1))
    else:
        group = ctx.find_root().command
        assert isinstance(group, click.Group)
        return read_text(text, name, path.parent, known_options(group))
    return File(name, {}, (wrong,), "")


def _shown(path: Path) -> str:
    """Return a path as people know it: from here, where it is below here."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)

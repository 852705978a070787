"""Opening and writing: the only part of the project that touches files.

Outputs appear whole or not at all: written beside their place, then renamed; all outputs of a run
are renamed only when all were written.
"""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import click

#: No drawing and no program is larger; a device may have no end.
MOST_BYTES = 256 * 10**6


def read_input(name: str) -> bytes:
    """Return the bytes of a file, or of standard input for ``-``.

    Raises:
        click.ClickException: it cannot be read, or does not end; exit status 1.
    """
    try:
        if name == "-":
            data = sys.stdin.buffer.read(MOST_BYTES + 1)
        else:
            with open(name, "rb") as file:
                data = file.read(MOST_BYTES + 1)
    except OSError as why:
        raise Failed(f"{name}: cannot be read: {why.strerror or why}") from why
    if len(data) > MOST_BYTES:
        raise Failed(f"{name}: is larger than {MOST_BYTES // 10**6} MB, or a device without an end")
    return data


def read_program(name: str) -> bytes:
    """Return the bytes of a program.

    Raises:
        click.ClickException: it cannot be read; exit status 1.
        WrongUse: it is a drawing.
    """
    from wedmcam.frontends.identify import is_drawing
    from wedmcam.options import WrongUse

    data = read_input(name)
    if is_drawing(data):
        raise WrongUse(f"{name} is a drawing, not a program: see wedmcam inspect and compile")
    return data


class Failed(click.ClickException):
    """Something outside the program failed: exit status 1, one line on standard error."""

    exit_code = 1

    def show(self, file: object = None) -> None:
        """Print the message."""
        from wedmcam.cli.terminal import print_error

        print_error(self.message)


class Unreadable(Failed):
    """One of two files to compare cannot be read: exit status 2 (`diff`)."""

    exit_code = 2


def check_outputs(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Refuse outputs that are inputs, or each other.

    Raises:
        click.UsageError: exit status 2.
    """
    taken = {os.path.realpath(i) for i in inputs if i != "-"}
    for name in outputs:
        if name == "-":
            continue
        place = os.path.realpath(name)
        if place in taken:
            raise click.UsageError(f"the output {name} would overwrite an input or another output")
        if os.path.isdir(place):
            raise click.UsageError(f"the output {name} is a folder")
        if not os.path.isdir(folder := os.path.dirname(place)):
            raise click.UsageError(f"there is no folder {folder} for the output {name}")
        try:
            os.stat(name)
        except FileNotFoundError:
            pass
        except OSError as why:  # links in a circle, a name that is too long
            raise click.UsageError(f"the output {name} cannot be written: {why.strerror}") from why
        taken.add(place)
    if list(outputs).count("-") > 1:
        raise click.UsageError("only one output can be standard output")


#: Files that are being written beside their places.
UNFINISHED: set[str] = set()


def remove_unfinished() -> None:
    """Remove what was being written: a run was interrupted, or a file could not be replaced."""
    while UNFINISHED:
        with suppress(OSError):
            os.unlink(UNFINISHED.pop())


def write_outputs(outputs: Sequence[tuple[str, bytes]]) -> None:
    """Write all files beside their places, then rename them; ``-`` is standard output.

    Raises:
        Failed: nothing was replaced.
    """
    made: list[tuple[str, str, str]] = []
    name = ""
    try:
        for name, data in outputs:
            if name == "-":
                continue
            if _is_device(name):
                continue
            place = Path(os.path.realpath(name))
            beside = str(place.parent / f".{place.name[:50]}.{secrets.token_hex(4)}")
            made.append((beside, str(place), name))
            UNFINISHED.add(beside)
            with open(beside, "xb") as file:
                file.write(data)
            os.chmod(beside, _mode(place))
        for beside, place_name, name in made:  # noqa: B007 - named where it fails
            os.replace(beside, place_name)
    except OSError as why:
        raise Failed(f"{name}: cannot be written: {why.strerror}") from why
    finally:
        remove_unfinished()
    for name, data in outputs:
        try:
            if name == "-":
                sys.stdout.buffer.write(data)
                sys.stdout.buffer.flush()
            elif _is_device(name):
                with open(name, "wb") as device:
                    device.write(data)
        except BrokenPipeError:
            raise
        except OSError as why:
            raise Failed(f"{name}: cannot be written: {why.strerror}") from why


def _is_device(name: str) -> bool:
    """Return whether an output is there and no regular file: it is written to, never replaced."""
    return Path(name).exists() and not Path(name).is_file()


def _mode(place: Path) -> int:
    """Return the permissions of the file that is replaced, or what a new file would get."""
    with suppress(OSError):
        return place.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask

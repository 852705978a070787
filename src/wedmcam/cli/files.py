"""Files of a command: `wedmcam.files` with what the command line says where one fails."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

import click

from wedmcam import files
from wedmcam.cli.terminal import print_error


class Failed(click.ClickException):
    """Something outside the program failed: exit status 1, one line on standard error."""

    exit_code = 1

    def show(self, file: object = None) -> None:
        """Print the message."""
        print_error(self.message)


class Unreadable(Failed):
    """One of two files to compare cannot be read: exit status 2 (`diff`)."""

    exit_code = 2


def shown_name(path: str) -> str:
    """Return the name of an input as it stands in messages."""
    return "stdin" if path == "-" else path


def read_input(name: str) -> bytes:
    """Return the bytes of a file, or of standard input for ``-``.

    Raises:
        Failed: it cannot be read, or does not end.
    """
    try:
        return files.read_file(name)
    except files.FileError as why:
        raise Failed(str(why)) from why


def read_program(name: str) -> bytes:
    """Return the bytes of a program.

    Raises:
        Failed: it cannot be read.
        WrongUse: it is a drawing.
    """
    from wedmcam.diag.run import WrongUse
    from wedmcam.frontends.identify import is_drawing

    data = read_input(name)
    if is_drawing(data):
        raise WrongUse(f"{name} is a drawing, not a program: see wedmcam inspect and compile")
    return data


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


def write_outputs(outputs: Sequence[tuple[str, bytes | Iterable[bytes]]]) -> None:
    """Write all files or none; ``-`` is standard output.

    Raises:
        Failed: nothing was replaced.
    """
    try:
        files.write_files(outputs)
    except files.FileError as why:
        raise Failed(str(why)) from why

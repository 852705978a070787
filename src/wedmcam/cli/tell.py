"""The only way from here to a terminal: a line is printed without anything that could drive it."""

from __future__ import annotations

import click


def tell(text: str, *, err: bool = False, nl: bool = True) -> None:
    """Print lines on standard output, or on standard error; what is not visible is escaped.

    Names of files and layers go through here. Text that is coloured on purpose does not.
    """
    if not text.isprintable():
        from wedmcam.diag.shown import visible

        text = visible(text, keep="\n")
    click.echo(text, err=err, nl=nl)

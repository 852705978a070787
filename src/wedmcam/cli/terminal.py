"""The only way from here to a terminal: what is printed holds nothing that could drive it.

Names of files and layers come from anywhere; what is not visible of them is escaped. Messages are
on standard error, what a command was asked for is on standard output.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Mapping
from typing import Any

import click

from wedmcam.diag import Diagnostic, Severity, TextSpan, json_text
from wedmcam.diag.render import merged, render
from wedmcam.diag.shown import shortened, visible


def coloured() -> bool:
    """Return whether standard error takes colours."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stderr.isatty() and not plain


def print_text(text: str, *, err: bool = False, nl: bool = True) -> None:
    """Print lines on standard output, or on standard error; what is not visible is escaped.

    Text that is coloured on purpose does not go through here.
    """
    if not text.isprintable():
        text = visible(text, keep="\n")
    click.echo(text, err=err, nl=nl)


def print_findings(
    findings: Collection[Diagnostic],
    file: str = "",
    quiet: bool = False,
    texts: Mapping[str, str | bytes | None] | None = None,
) -> None:
    """Print findings on standard error.

    Args:
        findings: what to print.
        file: stands where a finding has no place of its own.
        quiet: leave notes out.
        texts: name -> text of what was read: the lines that findings point to are shown.
    """
    shown: dict[str, str] = {}
    for d in merged(findings):
        if quiet and d.severity is Severity.NOTE:
            continue
        name = d.span.file if isinstance(d.span, TextSpan) else ""
        text = texts.get(name) if texts and name not in shown else None
        if text is not None:
            shown[name] = text if isinstance(text, str) else text.decode("utf-8-sig", "replace")
        click.echo(render(d, file, coloured(), shown.get(name)), err=True)


def print_error(message: str, hint: str = "") -> None:
    """Print an error that is about no place: wrong use, a file that cannot be read."""
    head = "\x1b[31;1merror\x1b[0m" if coloured() else "error"
    text = visible(shortened(message), keep="\n")
    click.echo(f"{head}: {text}" + (f"\n  hint: {visible(hint)}" if hint else ""), err=True)


def print_json(data: Any) -> None:
    """Print data as JSON on standard output."""
    print_text(json_text(data, 2))

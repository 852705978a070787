"""``wedmcam explain``: what a code means, with an example that was run."""

from __future__ import annotations

import difflib
import json
import textwrap
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.settings import ReadsPrograms
from wedmcam.cli.terminal import print_text
from wedmcam.diag import CODES

WIDTH = 96


@click.command("explain", cls=ReadsPrograms)
@click.argument("what", metavar="CODE|FILE", required=False)
@click.option("--list", "list_", is_flag=True, help="All codes, one a line.")
@click.option("--block", type=click.IntRange(1), metavar="N", help="Explain this block of FILE.")
@ask.machine_options
@ask.d_option
@ask.reading_options
def explain_command(
    what: str | None,
    list_: bool,
    block: int | None,
    profile: str | None,
    profile_in: str | None,
    d: tuple[tuple[int, float], ...],
    **params: Any,
) -> int:
    """A diagnostic; or one block of a program: geometry, quadrant, count axis, J, steps, stair."""
    if list_:
        print_text(list_codes())
        return 0
    if what is None:
        raise click.UsageError("give a CODE, FILE --block N, or --list")
    if block is not None:
        from wedmcam.cli.run.explain import print_block

        return print_block(what, block, profile_in or profile, d, ask.answers_of(params))
    text = explain_code(what)
    if text is None:
        raise click.UsageError(_describe_unknown(what))
    print_text(text)
    return 0


@cache
def examples() -> dict[str, dict[str, str]]:
    """Return code -> its example: ``run`` and ``said``, or ``cannot``; made by ``make docs``."""
    text = files("wedmcam.diag").joinpath("examples.json").read_text("utf-8")
    by_code: dict[str, dict[str, str]] = json.loads(text)
    return by_code


def explain_code(code: str) -> str | None:
    """Return what a code means; None where there is none of this name."""
    if code not in CODES:
        return None
    entry = CODES[code]
    parts = [code, *(_part(n, getattr(entry, n)) for n in ("what", "why", "cure"))]
    example: dict[str, Any] = examples().get(code, {})
    if "run" in example:
        shown = textwrap.indent(f"$ {example['run']}\n{example['said']}", "    ")
        parts.append(f"  for example\n{shown}")
    return "\n".join(parts)


def _part(name: str, text: str) -> str:
    head = f"  {name:6} "
    return textwrap.fill(text, WIDTH, initial_indent=head, subsequent_indent=" " * len(head))


def list_codes() -> str:
    """Return all codes with what they mean in a line each."""
    width = max(map(len, CODES))
    return "\n".join(f"{code:{width}}  {CODES[code].what}" for code in sorted(CODES))


def _describe_unknown(name: str) -> str:
    """Return why a name is no code, and what it may be meant for."""
    if Path(name).is_file():
        return f"{name} is a file: to explain a block of a program give --block N"
    near = difflib.get_close_matches(name.lower(), CODES, 3, 0.6)
    hint = f"did you mean {', '.join(near)}?" if near else "wedmcam explain --list tells all"
    return f"there is no diagnostic '{name}'; {hint}"

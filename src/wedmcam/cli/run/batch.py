"""``wedmcam batch``: many drawings, folders and patterns into a mirrored tree of proven programs.

`wedmcam.batch` finds and does the work; here outcomes are shown as they come, and how a drawing is
compiled is taken from the settings of its own folder.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import click

from wedmcam.batch.items import Item, Recipe, WrongInputs, find_items
from wedmcam.batch.pool import compile_items
from wedmcam.batch.work import Outcome, compile_item
from wedmcam.cli import options as ask
from wedmcam.cli.progress import Bar
from wedmcam.cli.settings import Configured
from wedmcam.cli.settings.find import folder_of
from wedmcam.cli.settings.in_force import locate
from wedmcam.cli.settings.read import BadSettings
from wedmcam.cli.settings.state import InForce
from wedmcam.cli.terminal import coloured, print_text
from wedmcam.diag import Severity, json_text
from wedmcam.diag.render import merged, render
from wedmcam.diag.run import WrongUse


def run_batch(
    inputs: tuple[str, ...],
    output: str,
    to: str | None,
    jobs: int,
    force_units: bool,
    **params: Any,
) -> int:
    """Run ``wedmcam batch``; return the exit status."""
    if Path(output).exists() and not Path(output).is_dir():
        raise click.UsageError(f"{output} is a file: -o takes a folder")
    try:
        items = find_items(inputs, output, _recipes(click.get_current_context()))
    except WrongInputs as why:
        raise click.UsageError(str(why)) from why
    work = partial(compile_item, force_units=force_units)
    return _report(items, work, jobs, params["json_"], params["quiet"])


def _recipes(ctx: click.Context) -> Callable[[str], Recipe]:
    """Return a function that says how a drawing is compiled: as the settings of its folder say.

    What is wrong without any settings is wrong use at once; what a settings file makes wrong is
    the matter of its folder alone.
    """
    by_folder: dict[Path, Recipe] = {}

    def recipe_of(name: str) -> Recipe:
        folder = folder_of(name)
        if folder not in by_folder:
            by_folder[folder] = _recipe(ctx, folder)
        return by_folder[folder]

    return recipe_of


def _recipe(ctx: click.Context, folder: Path) -> Recipe:
    command = ctx.command
    assert isinstance(command, Configured)
    force: InForce | None = None
    try:
        force = command.in_force(ctx, folder)
        params = force.params
        machine = ask.machine_of(params["profile"], params["to"])
        return Recipe(machine, ask.options_of(params), bool(params["profile"]))
    except BadSettings as why:
        return Recipe(wrong=why.message)
    except WrongUse as why:
        wrong = locate(why, force) if force else None
        if wrong is None:
            raise
        return Recipe(wrong=wrong.message)


def _report(
    items: list[Item], work: Callable[[Item], Outcome], jobs: int, json_: bool, quiet: bool
) -> int:
    """Do all items; print findings, one JSON line an item if asked, and a summary.

    Returns the largest exit status of the items.
    """
    counts: Counter[int] = Counter()
    codes: Counter[tuple[str, str]] = Counter()
    failed = []
    bar = Bar("batch", len(items))
    with closing(compile_items(items, jobs, work)) as outcomes:
        try:
            for outcome in outcomes:
                counts[outcome.status] += 1
                for finding in outcome.record.get("diagnostics", ()):
                    codes[finding["severity"], finding["code"]] += 1
                if outcome.status:
                    failed.append(outcome.item.source)
                _print_outcome(outcome, bar, json_, quiet)
                bar.step()
        finally:
            bar.clear()
    for (severity, code), count in sorted(codes.items()):
        print_text(f"  {count:6d} {severity}[{code}]", err=True)
    print_text(f"batch: {counts[0]} ok, {len(failed)} failed", err=True)
    for name in failed:
        print_text(f"  failed: {name}", err=True)
    return max(counts, default=0)


def _print_outcome(outcome: Outcome, bar: Bar, json_: bool, quiet: bool) -> None:
    """Print what came of a drawing; the bar makes room for it."""
    text = _text(outcome, quiet)
    if text or json_:
        bar.clear()
    if text:
        click.echo(text, err=True)
    if json_:
        print_text(json_text(outcome.record))


def _text(outcome: Outcome, quiet: bool) -> str:
    """Return findings and a line of figures; of a program that was written warnings, if quiet."""
    if outcome.failure:
        return outcome.failure
    brief = quiet and outcome.status == 0
    least = Severity.WARNING if brief else Severity.NOTE
    source = outcome.item.source
    lines = [render(d, source, coloured()) for d in merged(outcome.findings) if d.severity >= least]
    figures = outcome.figures
    if figures is not None and not brief:
        lines.append(
            f"{source}: cuts {figures.counts}; {outcome.item.output}  {figures.blocks} blocks, "
            f"deviation {figures.deviation_um:.2f} um"
        )
    return "\n".join(lines)

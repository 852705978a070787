"""Compile many drawings: what the library calls; the command line has recipes of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from wedmcam.batch.items import Recipe, find_items
from wedmcam.batch.pool import compile_items
from wedmcam.batch.work import Outcome, compile_item
from wedmcam.machines import Machine
from wedmcam.operations.profiles import machine_for
from wedmcam.options import Options, take_options


def compile_all(
    inputs: str | Path | Sequence[str | Path],
    folder: str | Path,
    *,
    to: str | None = None,
    profile: Machine | str | None = None,
    options: Options | None = None,
    jobs: int = 0,
    force_units: bool = False,
    **mm: Any,
) -> Iterator[Outcome]:
    """Compile drawings, folders and patterns into a mirrored tree of proven programs.

    One bad file never stops the others, and what is written does not depend on ``jobs``. Nothing is
    compiled before the first outcome is asked for.

    Args:
        inputs: a file, a folder or a pattern, or several.
        folder: of the programs; it is made.
        to: format of the programs, "3b" by default.
        profile: a machine, or the name of a built-in one; None for the format's default.
        options: everything else, in um.
        jobs: processes; 0 for one a core. Where processes are spawned (not Linux), the script of
            the caller needs its ``if __name__ == "__main__"``.
        force_units: ``units`` overrides what drawings say; else it holds where they say nothing.
        **mm: instead of ``options``, its fields in mm: offset=0.1, side="die".

    Yields:
        The outcome of each drawing, in the order of their names.

    Raises:
        WrongUse: options that do not fit together, inputs that name no drawing, or two drawings
            that would have one output.

    Example::

        for outcome in wedmcam.compile_all("drawings", "programs", offset=0.1):
            print(outcome.item.source, outcome.status, *outcome.findings)
    """
    several = [inputs] if isinstance(inputs, str | Path) else inputs
    options = take_options(options, mm)
    recipe = Recipe(machine_for(to, profile), options, profile is not None)
    items = find_items([str(name) for name in several], str(folder), lambda _: recipe)
    return compile_items(items, jobs, partial(compile_item, force_units=force_units))

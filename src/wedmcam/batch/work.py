"""One drawing of a batch as a task: plain data in, plain data out, whatever happens.

An outcome crosses borders of processes, so it holds values that can be pickled: findings, a record
for programs, figures for people. How they look is the matter of who shows them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wedmcam.batch.items import Item
from wedmcam.compiler.results import Compilation
from wedmcam.diag import Diagnostic, visible
from wedmcam.diag.run import WrongUse
from wedmcam.files import FileError, read_file, write_files
from wedmcam.machines import Machine
from wedmcam.operations.compile import compile
from wedmcam.options import Options
from wedmcam.programs.places import with_time

INTERNAL = 70


@dataclass(frozen=True, slots=True)
class Figures:
    """What a program that was written is, in a few figures.

    Attributes:
        counts: how many contours are cut as what.
        blocks: of the program.
        deviation_um: the largest, of the stepped path from the plan.
    """

    counts: str
    blocks: int
    deviation_um: float


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of an item.

    Attributes:
        item: what was to be done.
        status: exit status: 0 written, 1 the input has errors, 2 wrong use, 3 the proof failed, 70
            internal error.
        record: the summary of the compile, as ``--json`` prints it, with ``input``, ``output``,
            ``status``, ``ok``, and ``error`` where there was no compile.
        findings: of the compile, in order.
        failure: why there was no compile, as a line with the name of the drawing; empty else.
        figures: of the program; None where none was written.
    """

    item: Item
    status: int
    record: dict[str, Any]
    findings: tuple[Diagnostic, ...] = ()
    failure: str = ""
    figures: Figures | None = None


def compile_item(item: Item, force_units: bool = False) -> Outcome:
    """Compile one drawing and write its program; never raise for what is in the drawing.

    Args:
        item: the drawing, with the place of its program, whose folder is made.
        force_units: ``units`` of the options overrides what the drawing says; else it holds where
            the drawing says nothing.
    """
    recipe, source = item.recipe, item.source
    if item.unreadable:
        return failed(item, 1, f"{source}: {item.unreadable}")
    if recipe.wrong:
        return _failed_as_shown(item, 2, f"{visible(source)}: {recipe.wrong}")
    assert recipe.machine is not None
    assert recipe.options is not None
    try:
        data = read_file(source)
    except FileError as why:
        return failed(item, 1, str(why))
    options = recipe.options.with_values(fill_in_units=not force_units)
    try:
        return _compile_data(data, item, recipe.machine, options)
    except WrongUse as why:
        return failed(item, 2, f"{source}: error: {why}", str(why))
    except (FileError, OSError) as why:
        return failed(item, 1, f"{source}: {why}", str(why))
    except Exception as why:  # a bug of ours must not stop the others
        return failed(item, INTERNAL, f"{source}: internal error: {type(why).__name__}: {why}")


def failed(item: Item, status: int, failure: str, error: str = "") -> Outcome:
    """Return the outcome of an item that was not compiled.

    Args:
        item: the item.
        status: exit status.
        failure: why, as a line with the name of the drawing.
        error: why, for the record; by default the same.
    """
    return _failed_as_shown(item, status, visible(failure), error)


def _failed_as_shown(item: Item, status: int, failure: str, error: str = "") -> Outcome:
    record = _record(item, status, {}) | {"error": error or failure}
    return Outcome(item, status, record, failure=failure)


def _compile_data(data: bytes, item: Item, machine: Machine, options: Options) -> Outcome:
    """Compile what was read, and write the program where it is proven."""
    compilation = compile(
        data,
        to=machine.format,
        profile=machine if item.recipe.named else None,
        name=item.source,
        output_name=item.output,
        options=options,
    )
    if compilation.ok:
        assert compilation.data is not None
        Path(item.output).parent.mkdir(parents=True, exist_ok=True)
        write_files([(item.output, compilation.data)])
    summary = with_time(compilation.summary, options.operator.feed_um)
    return Outcome(
        item,
        compilation.status,
        _record(item, compilation.status, summary),
        compilation.findings,
        figures=_figures(compilation),
    )


def _figures(compilation: Compilation) -> Figures | None:
    if not compilation.ok:
        return None
    assert compilation.understood is not None
    assert compilation.verdict is not None
    v = compilation.verdict
    return Figures(compilation.understood.counts, v.blocks, v.max_deviation_um)


def _record(item: Item, status: int, summary: dict[str, Any]) -> dict[str, Any]:
    return {
        **summary,
        "input": item.source,
        "status": status,
        "ok": status == 0,
        "output": item.output if status == 0 else None,
    }

"""``batch``: many drawings, folders and patterns into a mirrored tree of proven programs.

One bad file never stops the others; what is written does not depend on the number of processes; and
no item counts as done without a program.
"""

from __future__ import annotations

import glob
import itertools
import multiprocessing
import os
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wedmcam.cli.files import Failed, read_input, write_outputs
from wedmcam.cli.progress import Bar
from wedmcam.cli.terminal import print_text
from wedmcam.diag import json_text, visible
from wedmcam.files import remove_unfinished
from wedmcam.options import SUFFIX_OF_FORMAT, WrongUse

if TYPE_CHECKING:
    from wedmcam.api import Compilation
    from wedmcam.machines import Machine
    from wedmcam.options import Options

#: Endings of files that a folder is searched for.
SOURCES = (".dxf", ".wed")


@dataclass(frozen=True, slots=True)
class How:
    """How the drawings of one folder are compiled: as its settings file says.

    Attributes:
        machine: the profile; None where ``wrong``.
        options: everything else.
        named: the profile was named, and is not just the default of the format.
        wrong: why nothing of this folder can be compiled (exit status 2).
    """

    machine: Machine | None = None
    options: Options | None = None
    named: bool = True
    wrong: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One drawing, where its program goes, and how it is made; or why it cannot be read."""

    source: str
    output: str
    how: How
    unreadable: str = ""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of an item: plain data, so that it can cross a process border.

    ``warnings`` is ``text`` without the notes.
    """

    item: Item
    status: int
    text: str
    record: dict[str, Any]
    warnings: str = ""


def find(inputs: Sequence[str], folder: str, how: Callable[[str], How]) -> list[Item]:
    """Return the drawings that files, folders and patterns name, sorted, with their outputs.

    ``how`` says how the drawing of a name is compiled.

    A folder is searched below itself and mirrored; a file or what a pattern matches lies directly
    in the output folder, below the part of the pattern that has no wildcard.

    Raises:
        click.UsageError: nothing matched, or two drawings would have one output.
    """
    found: dict[str, Path] = {}
    unreadable: dict[str, str] = {}
    for name in inputs:
        place = Path(name)
        if place.is_dir():
            base = place
            searched = _searched(place)
            files = sorted(searched)
            unreadable |= {str(file): why for file, why in searched.items() if why}
        elif place.exists():
            base, files = place.parent, [place]
        else:
            plain = itertools.takewhile(lambda part: not glob.has_magic(part), place.parts[:-1])
            base = Path(*plain)
            files = sorted(Path(p) for p in glob.glob(name, recursive=True) if Path(p).is_file())
        if not files:
            raise click.UsageError(f"{name}: no drawing ({', '.join(SOURCES)}) is there")
        for file in files:
            found.setdefault(str(file), file.relative_to(base))
    items = []
    taken: dict[str, str] = {}
    sources = {os.path.realpath(source) for source in found}
    for source in sorted(found):
        asked = how(source)
        ending = SUFFIX_OF_FORMAT[asked.machine.format] if asked.machine else ".3b"
        output = str(Path(folder) / found[source].with_suffix(ending))
        if output in taken:
            raise click.UsageError(
                f"{source} and {taken[output]} would both become {output}: give their folder"
            )
        taken[output] = source
        if os.path.realpath(output) in sources:
            raise click.UsageError(f"the output {output} would overwrite an input")
        items.append(Item(source, output, asked, unreadable.get(source, "")))
    return items


def _searched(base: Path) -> dict[Path, str]:
    """Return the drawings below a folder, each with why it cannot be read, empty if it can.

    What is hidden is passed over. A link that leads nowhere or a pipe with the name of a drawing is
    one that cannot be read; so is a folder that may not be listed.
    """
    found: dict[Path, str] = {}

    def closed(why: OSError) -> None:
        found[Path(why.filename)] = f"cannot be searched: {why.strerror}"

    for folder, folders, names in os.walk(base, onerror=closed):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in names:
            file = Path(folder, name)
            if name.startswith(".") or file.suffix.lower() not in SOURCES:
                continue
            if file.is_file():
                found[file] = ""
            elif file.exists():
                found[file] = "cannot be read: no regular file"
            else:
                found[file] = "cannot be read: a link that leads nowhere"
    return found


def how(asked: dict[str, Any]) -> How:
    """Return how drawings are compiled from what was asked for.

    Raises:
        WrongUse: options that do not fit together.
    """
    from wedmcam.cli import asked as ask

    named = bool(asked["profile"])
    return How(ask.machine_of(asked["profile"], asked["to"]), ask.options_of(asked), named)


def make(item: Item, force_units: bool) -> Outcome:
    """Compile one drawing and write its program; never raises for what is in the drawing."""
    from wedmcam import api
    from wedmcam.cli.report import with_time
    from wedmcam.cli.terminal import coloured
    from wedmcam.diag import Severity
    from wedmcam.diag.render import merged, render

    if item.unreadable:
        text = visible(f"{item.source}: {item.unreadable}")
        return Outcome(item, 1, text, _record(item, 1, error=text))
    if item.how.wrong:
        text = f"{visible(item.source)}: {item.how.wrong}"
        return Outcome(item, 2, text, _record(item, 2, error=text))
    machine, options = item.how.machine, item.how.options
    assert machine is not None
    assert options is not None
    try:
        data = read_input(item.source)
    except Failed as why:
        text = visible(why.message)
        return Outcome(item, 1, text, _record(item, 1, error=text))
    try:
        made = api.compile(
            data,
            to=machine.format,
            profile=machine if item.how.named else None,
            name=item.source,
            output_name=item.output,
            options=replace(options, fill_in_units=not force_units),
        )
        found = merged(made.findings)
        text, warnings = (
            "\n".join(render(d, item.source, coloured()) for d in found if d.severity >= least)
            for least in (Severity.NOTE, Severity.WARNING)
        )
        if made.ok:
            assert made.data is not None
            Path(item.output).parent.mkdir(parents=True, exist_ok=True)
            write_outputs([(item.output, made.data)])
            text = "\n".join(filter(None, (text, _line(item, made))))
        record = _record(item, made.status, with_time(made.summary, options.feed_um))
        return Outcome(item, made.status, text, record, warnings)
    except WrongUse as why:
        text = visible(f"{item.source}: error: {why}")
        return Outcome(item, 2, text, _record(item, 2, error=str(why)))
    except (Failed, OSError) as why:
        text = visible(f"{item.source}: {why}")
        return Outcome(item, 1, text, _record(item, 1, error=str(why)))
    except Exception as why:  # a bug of ours must not stop the others
        text = visible(f"{item.source}: internal error: {type(why).__name__}: {why}")
        return Outcome(item, 70, text, _record(item, 70, error=text))


def _line(item: Item, made: Compilation) -> str:
    """Return what was understood of a drawing and what became of it, in one line."""
    assert made.understood is not None
    assert made.verdict is not None
    v = made.verdict
    return (
        f"{item.source}: cuts {made.understood.counts}; {item.output}  {v.blocks} blocks, "
        f"deviation {v.max_deviation_um:.2f} um"
    )


def _record(
    item: Item, status: int, summary: dict[str, Any] | None = None, error: str = ""
) -> dict[str, Any]:
    record = {**(summary or {}), "input": item.source, "status": status, "ok": status == 0}
    record["output"] = item.output if status == 0 else None
    if error:
        record["error"] = error
    return record


def outcomes(items: Sequence[Item], force_units: bool, jobs: int) -> Iterator[Outcome]:
    """Yield the outcomes in the order of the items, whatever the number of processes."""
    if jobs == 1 or len(items) < 2:
        for item in items:
            yield make(item, force_units)
        return
    pool = ProcessPoolExecutor(min(jobs, len(items)), initializer=_of_a_batch)
    waiting: dict[Future[Outcome], int] = {}
    done: dict[int, Outcome] = {}
    upcoming = iter(enumerate(items))
    following = 0
    try:
        while following < len(items):
            while len(waiting) < 4 * jobs:
                step = next(upcoming, None)
                if step is None:
                    break
                number, item = step
                waiting[pool.submit(make, item, force_units)] = number
            if following not in done:
                finished, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in finished:
                    number = waiting.pop(future)
                    done[number] = _result(future, items[number])
            while following in done:
                yield done.pop(following)
                following += 1
    except BaseException:
        _abandon(pool)
        raise
    pool.shutdown()


#: Pools whose workers were ended: Python must not wait for them when it ends itself.
ABANDONED: list[ProcessPoolExecutor] = []


def _abandon(pool: ProcessPoolExecutor) -> None:
    """End the workers of an interrupted batch: nobody waits for what is under way."""
    ABANDONED.append(pool)
    workers = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for worker in workers:
        worker.terminate()
    for worker in workers:
        worker.join(10)
        worker.kill()


def _of_a_batch() -> None:
    """Leave Ctrl-C to the process that started this one; end when it says so, or is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _ended)
    threading.Thread(target=_watch, daemon=True).start()


def _watch() -> None:
    """End with the process that started this one: killed, it has said nothing."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        _ended(signal.SIGHUP, None)


def _ended(number: int, _: Any) -> None:
    # No exception: the pool would take it for the outcome of an item, and go on.
    remove_unfinished()
    os._exit(128 + number)


def _result(future: Future[Outcome], item: Item) -> Outcome:
    """Return the outcome; a process that died is an internal error of its item."""
    try:
        return future.result()
    except Exception as why:
        text = visible(f"{item.source}: internal error: the process ended: {why}")
        return Outcome(item, 70, text, _record(item, 70, error=text))


def run(
    items: Sequence[Item],
    *,
    force_units: bool,
    jobs: int,
    json_: bool,
    quiet: bool,
) -> int:
    """Make all items; print findings, one JSON line an item if asked, and a summary.

    Returns the largest exit status of the items.
    """
    counts: Counter[int] = Counter()
    codes: Counter[tuple[str, str]] = Counter()
    failed = []
    bar = Bar("batch", len(items))
    try:
        for outcome in outcomes(items, force_units, jobs or os.cpu_count() or 1):
            counts[outcome.status] += 1
            for finding in outcome.record.get("diagnostics", ()):
                codes[finding["severity"], finding["code"]] += 1
            if outcome.status:
                failed.append(outcome.item.source)
            text = outcome.warnings if quiet and outcome.status == 0 else outcome.text
            if text or json_:
                bar.clear()
            if text:
                click.echo(text, err=True)
            if json_:
                print_text(json_text(outcome.record))
            bar.step()
    finally:
        bar.clear()
    for (severity, code), count in sorted(codes.items()):
        print_text(f"  {count:6d} {severity}[{code}]", err=True)
    print_text(f"batch: {counts[0]} ok, {len(failed)} failed", err=True)
    for name in failed:
        print_text(f"  failed: {name}", err=True)
    return max(counts, default=0)

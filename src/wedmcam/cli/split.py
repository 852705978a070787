"""``compile --split``: a program that does not fit the memory, written as several that do."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import check_outputs, write_outputs
from wedmcam.cli.outputs import Outputs, program_files, write_refused
from wedmcam.cli.progress import waiting
from wedmcam.cli.source import Source, read_source
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.compiler.results import Compilation
from wedmcam.diag import has_errors
from wedmcam.machines import Machine
from wedmcam.operations.split import Together, compile_loads, moves, numbered, proven_together
from wedmcam.programs.places import with_time
from wedmcam.targets import target_of


def compile_split(input_: str, machine: Machine, outputs: Outputs, params: dict[str, Any]) -> int:
    """Compile, and write one file a load; all are written or none.

    Certificates, pictures and maps are numbered like the programs. --json prints a line a load.
    """
    source = read_source(input_, params)
    with waiting(f"compiling {source.name}"):
        loads = compile_loads(
            source.data,
            profile=machine,
            name=source.name,
            output_name=outputs.program,
            options=source.options,
            named=bool(params["profile"]),
        )
    each = [outputs]
    if len(loads) > 1:
        each = [outputs.renamed(partial(numbered, number=k + 1)) for k in range(len(loads))]
    files = []
    for load, names in zip(loads, each, strict=True):
        print_findings(load.findings, source.name, params["quiet"], source.texts)
        if not load.ok:
            return _report_refused(load, outputs, source, params["json_"])
        assert load.data is not None
        files += program_files(load, names, load.data)
    together = proven_together(loads)
    for one in together:
        print_findings(one.findings, source.name, params["quiet"])
    if any(has_errors(one.findings) for one in together):
        print_text("no program was written", err=True)
        return 3
    check_outputs([input_], [name for name, _ in files])
    write_outputs(files)
    _report_loads(loads, each, together, params)
    return 0


def _report_refused(load: Compilation, outputs: Outputs, source: Source, json_: bool) -> int:
    """Draw the load that is refused, where a picture is asked for; say that nothing was written."""
    if outputs.plot is not None:
        write_refused(load, Path(source.name).name, outputs.plot, source.name)
    print_text("no program was written", err=True)
    if json_:
        print_json(load.summary)
    return int(load.status)


def _report_loads(
    loads: tuple[Compilation, ...],
    each: list[Outputs],
    together: list[Together],
    params: dict[str, Any],
) -> None:
    """Print what each load is, and how the table is moved to it."""
    feed = ask.feed_of(params)
    between = [None, *moves(loads)]
    for k, (load, names, move) in enumerate(zip(loads, each, between, strict=True), 1):
        one = next((t for t in together if t.loads[0] <= k <= t.loads[1]), None)
        if not params["quiet"]:
            if move is not None:
                _print_move(move, k)
            report.print_report(load, names.program, params["verbose"])
            report.print_time(load.summary, feed)
            _print_too_large(load, k)
            if one is not None and k == one.loads[1]:
                _print_together(one)
        if params["json_"]:
            more = {} if move is None else {"move_um": move["move_um"], "kerf": move["kerf"]}
            if one is not None:
                more["together"] = {
                    "loads": list(one.loads),
                    "blocks": one.verdict.blocks,
                    "closure_um": one.verdict.closure_um,
                    "max_deviation_um": round(one.verdict.max_deviation_um, 3),
                }
            print_json({**with_time(load.summary, feed), "load": k, **more})


def _print_move(move: dict[str, Any], load: int) -> None:
    dx, dy = (v / 1000 for v in move["move_um"])
    x, y = (v / 1000 for v in move["start_um"])
    if move["kerf"]:
        print_text(
            f"in kerf    the machine waits at ({x:.3f}, {y:.3f}) mm, generator off, wire threaded: "
            f"load {load} starts there",
            err=True,
        )
        return
    print_text(
        f"move       wire cut, from the end of load {load - 1} by ({dx:.3f}, {dy:.3f}) mm "
        f"to the thread point ({x:.3f}, {y:.3f}) mm of load {load}",
        err=True,
    )


def _print_too_large(load: Compilation, number: int) -> None:
    """Print that a load does not fit the memory, and why it is not cut in the kerf."""
    if any(d.code == "over-memory" for d in load.findings):
        why = target_of(load.machine).whole_contours
        text = f"load       {number} does not fit the memory" + (f": {why}" if why else "")
        print_text(text, err=True)


def _print_together(one: Together) -> None:
    verdict = one.verdict
    closure = "" if verdict.closure_um is None else f", closure {verdict.closure_um:g} um"
    print_text(
        f"together   loads {one.loads[0]} to {one.loads[1]} run one after the other: "
        f"{verdict.blocks} blocks, deviation {verdict.max_deviation_um:.2f} um{closure}",
        err=True,
    )

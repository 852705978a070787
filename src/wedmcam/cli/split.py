"""``compile --split``: a program that does not fit the memory, written as several that do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from wedmcam.cli import asked as ask
from wedmcam.cli.files import check_outputs, read_input, write_outputs
from wedmcam.cli.pictures import picture, write_refused
from wedmcam.cli.progress import waiting
from wedmcam.cli.terminal import print_text
from wedmcam.machines import Machine


def compile_split(
    input_: str,
    machine: Machine,
    output: str,
    certificate: str | None,
    plot: str | None,
    map_: str | None,
    feed: float | None,
    asked: dict[str, Any],
) -> int:
    """Compile, and write one file a load; all are written or none.

    Certificates, pictures and maps are numbered like the programs. --json prints a line a load.
    """
    from wedmcam import api
    from wedmcam.cli import report, terminal
    from wedmcam.operations.split import compile_loads, moves, numbered

    ask.check_source(input_, asked["from_"])
    options = ask.options_of(asked)
    data = read_input(input_)
    name = "stdin" if input_ == "-" else input_
    with waiting(f"compiling {name}"):
        loads = compile_loads(
            data,
            profile=machine,
            name=name,
            output_name=output,
            options=options,
            named=bool(asked["profile"]),
        )
    several = len(loads) > 1
    files: list[tuple[str, bytes]] = []
    for k, made in enumerate(loads, 1):
        terminal.print_findings(made.findings, name, asked["quiet"], {name: data, **options.texts})
        if not made.ok:
            if plot is not None:
                write_refused(made, Path(name).name, plot, name)
            print_text("no program was written", err=True)
            if asked["json_"]:
                terminal.print_json(made.summary)
            return int(made.status)
        assert made.data is not None

        def place(of: str, k: int = k) -> str:
            return numbered(of, k) if several else of

        files.append((place(output), made.data))
        if certificate is not None:
            files.append((place(certificate), report.certificate_bytes(made.summary)))
        if plot is not None:
            drawn = picture(made, Path(place(output)).name, plot)
            files.append((place(plot), drawn))
        if map_ is not None:
            files.append((place(map_), report.map_bytes(api.source_map(made))))
    check_outputs([input_], [file for file, _ in files])
    write_outputs(files)
    between = [None, *moves(loads)]
    for k, (made, moved) in enumerate(zip(loads, between, strict=True), 1):
        where = numbered(output, k) if several else output
        if not asked["quiet"]:
            if moved is not None:
                dx, dy = (v / 1000 for v in moved["move_um"])
                x, y = (v / 1000 for v in moved["start_um"])
                print_text(
                    f"move       wire cut, from the end of load {k - 1} by ({dx:.3f}, {dy:.3f}) mm "
                    f"to the thread point ({x:.3f}, {y:.3f}) mm of load {k}",
                    err=True,
                )
            report.print_report(made, where, asked["verbose"])
            report.print_time(made.summary, feed)
        if asked["json_"]:
            more = {} if moved is None else {"move_um": moved["move_um"]}
            terminal.print_json({**report.with_time(made.summary, feed), "load": k, **more})
    return 0

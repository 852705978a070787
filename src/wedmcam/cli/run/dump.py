"""``wedmcam dump``: the blocks of a program, with their addresses and where they end."""

from __future__ import annotations

from typing import Any

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli.files import read_program, shown_name
from wedmcam.cli.settings.profiles import machine_for
from wedmcam.cli.tables import dump_lines, dump_rows
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import has_errors
from wedmcam.frontends import describe_blocks
from wedmcam.targets import Entries


def run_dump(file: str, format_: str | None, json_: bool, tape: bool, **params: Any) -> int:
    """Run ``wedmcam dump``; return the exit status."""
    machine = machine_for(file, params["profile_in"] or params["profile"], format_)
    data = read_program(file)
    if tape:
        return _dump_tape(data)
    program, machine_read, findings = api.read_program(
        data,
        profile=machine,
        format=format_,
        name=shown_name(file),
        entered=Entries(d=params["d"]),
        shown=True,
        **ask.answers_of(params),
    )
    print_findings(findings, shown_name(file))
    if program is None:
        return 1
    texts = describe_blocks(data, machine_read)
    if json_:
        rows = dump_rows(program, machine_read)
        print_json([{**r, "stated": texts[r["where"]]} if r["where"] in texts else r for r in rows])
    else:
        for line in dump_lines(program, machine_read):
            more = texts.get((line[7:].split() or [""])[0], "")
            print_text(f"{line}   {more}" if more else line)
    return 1 if has_errors(findings) else 0


def _dump_tape(data: bytes) -> int:
    """Print the rows of a tape; return the exit status: 1 where a row has a wrong parity."""
    from wedmcam.formats.tape import odd_rows, rows_text

    print_text(rows_text(data))
    return 1 if len(odd_rows(data)) else 0

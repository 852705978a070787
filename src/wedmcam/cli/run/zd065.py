"""``wedmcam zd065``: what its commands do with the file of a memory."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import click

from wedmcam import api
from wedmcam.cli.files import check_outputs, read_input, shown_name, write_outputs
from wedmcam.cli.outputs import print_nothing_written
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.judge.certificate import finding_data
from wedmcam.operations.memory import Block, Image, Move, Recognition


def run_show(
    image: str, first: int | None, last: int | None, time_s: float, base: int, json_: bool
) -> int:
    """Run ``wedmcam zd065 show``; return the exit status."""
    held, findings = _read(image, base)
    groups = [] if held is None else api.show_memory(held, first, last)
    print_findings(findings, shown_name(image))
    rows = [
        {"address": at, "digits": group.hex().upper(), "shown_at_s": round(k * time_s, 6)}
        for k, (at, group) in enumerate(groups)
    ]
    whole = round(len(rows) * time_s, 6)
    if json_:
        print_json({**_facts(image, findings), "time_s": time_s, "seconds": whole, "groups": rows})
    elif rows:
        for row in rows:
            text = f"{row['address']:#06x}  {row['digits']:6}  at {row['shown_at_s']:g} s"
            print_text(text)
        count = "1 group" if len(rows) == 1 else f"{len(rows)} groups"
        print_text(f"{count} of three bytes, {time_s:g} s each: {whole:g} s", err=True)
    return int(held is None)


def run_find(
    image: str, number: int, base: int, at: int | None, format_: str | None, json_: bool
) -> int:
    """Run ``wedmcam zd065 find``; return the exit status."""
    held, findings = _read(image, base)
    block = None
    if held is not None:
        block, more = api.find_block(held, number, at, format_)
        findings += more
    print_findings(findings, shown_name(image))
    if json_:
        print_json({**_facts(image, findings), "block": None if block is None else _block(block)})
    elif block is not None:
        print_text(
            f"block {block.number}: {block.address:#06x} to {block.last:#06x}, "
            f"{block.instruction}: {block.data.hex(' ').upper()}"
        )
    return int(has_errors(findings))


def run_move(
    image: str, first: int, last: int, to: int, output: str | None, json_: bool, **params: Any
) -> int:
    """Run ``wedmcam zd065 move``; return the exit status."""
    in_place = params["in_place"]
    if (output is None) != in_place:
        raise click.UsageError("give -o FILE, or --in-place to write IMAGE itself")
    if in_place and image == "-":
        raise click.UsageError("--in-place writes IMAGE itself: standard input is no file")
    where = image if in_place else str(output)
    _check_output(image, None if in_place else where, json_)
    held, findings = _read(image, params["base"])
    move = None
    if held is not None:
        move, more = api.move_memory(held, first, last, to, params["format_"])
        findings += more
    strict = params["strict"] and any(d.severity > Severity.NOTE for d in findings)
    refused = move is None or strict
    print_findings(findings, shown_name(image))
    if move is not None and not refused:
        write_outputs([(where, move.image.data)])
    else:
        print_nothing_written(where)
    if json_:
        facts = {**_facts(image, findings), "ok": not refused}
        print_json({**facts, "output": None if refused else where, **_moved(move)})
    elif move is not None and not refused:
        _print_move(move, where == "-")
    return int(refused)


def run_identify(
    image: str,
    base: int,
    at: int | None,
    format_: str | None,
    clear: bool,
    output: str | None,
    json_: bool,
) -> int:
    """Run ``wedmcam zd065 identify``; return the exit status."""
    if clear != (output is not None):
        raise click.UsageError("--clear goes with -o FILE: where the cleared memory is written")
    _check_output(image, output, json_)
    held, findings = _read(image, base)
    seen = None
    if held is not None:
        seen, more = api.recognise_memory(held, at, format_)
        if clear:
            cleared, more = api.clear_memory(held, at)
            if cleared is not None:
                write_outputs([(str(output), cleared.data)])
        findings += more
    print_findings(findings, shown_name(image))
    done = clear and not has_errors(findings)
    if json_:
        print_json({**_facts(image, findings), **_seen(seen), "output": output if done else None})
    elif seen is not None:
        print_text(f"{image}: {_told(seen)}", err=output == "-")
        if done:
            print_text(
                f"{output}: a cleared memory, {len(held.data) if held else 0} bytes", err=True
            )
    if clear and not done:
        print_nothing_written(str(output))
    return int(has_errors(findings) or (seen is not None and not seen.known and not done))


def _read(image: str, base: int) -> tuple[Image | None, list[Diagnostic]]:
    return api.read_memory(read_input(image), base, shown_name(image))


def _check_output(image: str, output: str | None, json_: bool) -> None:
    """Refuse an output that is the image, and bytes for a terminal or among JSON.

    Raises:
        UsageError: exit status 2.
    """
    if output is None:
        return
    check_outputs([image], [output])
    if output == "-" and json_:
        raise click.UsageError("--json and the memory cannot both be standard output")
    if output == "-" and sys.stdout.isatty():
        raise click.UsageError("a memory is not for a terminal: give -o FILE")


def _facts(image: str, findings: Sequence[Diagnostic]) -> dict[str, Any]:
    return {
        "file": image,
        "ok": not has_errors(findings),
        "diagnostics": [finding_data(d) for d in findings],
    }


def _block(block: Block) -> dict[str, Any]:
    return {
        "number": block.number,
        "address": block.address,
        "last_address": block.last,
        "bytes": len(block.data),
        "data": block.data.hex().upper(),
        "instruction": block.instruction,
        "format": block.format,
    }


def _seen(seen: Recognition | None) -> dict[str, Any]:
    """Return what was recognised as plain data."""
    if seen is None:
        return {"format": None}
    return {
        "format": seen.format,
        "blocks": seen.blocks,
        "first_address": seen.first,
        "last_address": seen.last,
        "bad_address": seen.bad,
        "certain": seen.certain,
        "reason": seen.reason,
    }


def _told(seen: Recognition) -> str:
    """Return what was recognised as a line."""
    if seen.first is None or seen.last is None:
        return seen.reason
    places = f"{seen.reason}; {seen.first:#06x} to last address {seen.last:#06x}"
    return places if seen.bad is None else f"{places}; {seen.bad:#06x} does not fit"


def _moved(move: Move | None) -> dict[str, Any]:
    """Return a move as plain data."""
    if move is None:
        return {}
    count = move.last + 1 - move.first
    return {
        "from_address": move.first,
        "to_address": move.last,
        "bytes": count,
        "moved_to": {"from_address": move.to, "to_address": move.to + count - 1},
        "cleared": [{"from_address": a, "to_address": b} for a, b in move.cleared],
        "there": _seen(move.there),
    }


def _print_move(move: Move, err: bool) -> None:
    count = move.last + 1 - move.first
    end = move.to + count - 1
    lines = [
        f"moved    {move.first:#06x} to {move.last:#06x}, {count} bytes, to {move.to:#06x} to "
        f"{end:#06x}",
        "cleared  "
        + (", ".join(f"{a:#06x} to {b:#06x}" for a, b in move.cleared) or "nothing: all is used"),
        f"there    {_told(move.there)}",
    ]
    for line in lines:
        print_text(line, err=err)

"""Read a tape of the NBY-15: rows, characters, blocks, and the lines that the controller makes.

A row with a hole too many or too few is an error whatever it says, in the leader and behind the end
too: the reader of the machine stops there with TAPE. Findings name the row, counted from the first
one of the file, and the line and the column of the text behind the leader's ``%``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.nby15.data import TAPE, Switches, program_of
from wedmcam.diag import Diagnostic, FileSpan, Severity, TextSpan, error, warning
from wedmcam.formats import nby15, tape
from wedmcam.formats.lengths import mm_of
from wedmcam.formats.listing import listed
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

_KINDS = {"0": Kind.MOVE, "1": Kind.LINE}
_CONTROLS = {"0": Kind.PAUSE, "2": Kind.STOP}


@dataclass(slots=True)
class _Blocks:
    """Blocks of the tape, and where each stands."""

    rows: list[tuple[int, ...]] = field(default_factory=list)
    spans: list[TextSpan] = field(default_factory=list)
    tape_rows: list[int] = field(default_factory=list)

    def table(self) -> NDArray[np.void]:
        out = np.zeros(len(self.rows), TAPE)
        for k, name in enumerate(("kind", "turn", "x", "y", "start", "degrees", "radius")):
            out[name] = [row[k] for row in self.rows]
        out["source"] = -1
        return out


def decode(
    data: bytes, machine: Machine, file: str, switches: Switches | None = None
) -> tuple[Program, list[Diagnostic]]:
    """Return the lines that the controller makes of a tape (`TapeProgram`), and findings.

    Args:
        data: any bytes; never raises.
        machine: its limits.
        file: name for the spans.
        switches: as set at the controller; None for none.
    """
    blocks, findings = _read(data, machine, file)
    table = blocks.table()
    return program_of(table, spans=blocks.spans, switches=switches or Switches()), findings


def _read(data: bytes, machine: Machine, file: str) -> tuple[_Blocks, list[Diagnostic]]:
    findings = _parity(data, file)
    raw = np.frombuffer(data, np.uint8)
    # Blank rows and rub-outs say nothing wherever they stand.
    at = np.flatnonzero((raw != tape.BLANK) & (raw != tape.RUB_OUT))
    text = tape.without_parity(raw[at].tobytes()).decode("ascii")
    first = text.find(tape.REWIND_STOP)
    if first < 0:
        findings.append(
            error(
                "tape-start",
                "the tape has no % in its {rows} rows: the reader never begins",
                FileSpan(file),
                hint="punch it again, or look whether its beginning was cut off",
                rows=len(raw),
            )
        )
        return _Blocks(), findings
    before = sum(not c.isspace() for c in text[:first])
    if before:
        findings.append(
            warning(
                "tape-start",
                "{characters} characters in front of the % are not read, from row {row} on",
                FileSpan(file),
                characters=before,
                row=int(at[0]) + 1,
            )
        )
    blocks = _Blocks()
    start, number, ended, last_n = first + 1, 0, 0, 0
    late: list[tuple[int, TextSpan]] = []
    for line in text[first + 1 :].split("\n"):
        number += 1
        low, start = start, start + len(line) + 1
        bare = "".join(line.split())
        if not bare:
            continue
        low += len(line) - len(line.lstrip())
        row = int(at[low]) + 1
        span = TextSpan(file, number, 1, len(line))
        if ended:
            late.append((row, span))
            continue
        found = nby15.BLOCK.fullmatch(bare)
        if found is None:
            shown = bare[:40]
            findings.append(
                error(
                    "tape-block",
                    "row {row}: {text} is no block",
                    span,
                    hint="G01 X Y, G02 or G03 A B R, G00 X Y, M00, M02, each on a line of its own",
                    row=row,
                    text=shown,
                )
            )
            continue
        if found["n"] is not None:
            n = int(found["n"])
            if n != last_n + 1:
                findings.append(
                    error(
                        "tape-sequence",
                        "row {row}: block N{number} follows N{before}: "
                        "blocks between them are missing, or stand elsewhere",
                        span,
                        hint="compile again; pieces of tape may be joined in a wrong order",
                        row=row,
                        number=n,
                        before=last_n,
                    )
                )
            last_n = n
        else:
            last_n += 1
        fields = _fields(found)
        blocks.rows.append(fields)
        blocks.spans.append(span)
        blocks.tape_rows.append(row)
        ended = fields[0] == Kind.STOP
    if late:
        findings.append(
            warning(
                "after-end",
                "{blocks} blocks behind M02, from row {row} on: not run",
                late[0][1],
                hint="one program a tape",
                blocks=len(late),
                row=late[0][0],
            )
        )
    findings += _limits(blocks, machine)
    return blocks, findings


def _parity(data: bytes, file: str) -> list[Diagnostic]:
    """Return an error for each row whose number of holes is odd."""
    odd = tape.odd_rows(data)
    if not len(odd):
        return []
    many = len(odd) > len(data) // 4
    return [
        d
        for _, d in listed(
            Severity.ERROR,
            "tape-parity",
            odd,
            lambda i: FileSpan(file),
            "row {row} has an odd number of holes ({holes}): {text} was misread or mispunched",
            lambda i: {
                "row": i + 1,
                "holes": bin(data[i]).count("1"),
                "text": tape.name_of(data[i]),
            },
            "a text without parity is no tape: was the file changed in an editor?"
            if many
            else "punch the tape again",
        )
    ]


def _fields(found: re.Match[str]) -> tuple[int, ...]:
    """Return kind, turn, x, y, start, degrees and radius of a block."""
    word = found.__getitem__
    if word("m") is not None:
        return (_CONTROLS[word("m")[-1]], 0, 0, 0, 0, 0, 0)
    if word("line") is not None:
        kind = _KINDS[word("line")[-1]]
        return (kind, 0, int(word("x") or 0), int(word("y") or 0), 0, 0, 0)
    turn = -1 if word("arc")[-1] == "2" else 1
    return (Kind.ARC, turn, 0, 0, int(word("a")), int(word("b")), int(word("r")))


def _limits(blocks: _Blocks, machine: Machine) -> list[Diagnostic]:
    """Return errors on angles that are none, radii that are too large, and lines without a way."""
    t = blocks.table()
    findings: list[Diagnostic] = []
    arc, most = t["kind"] == Kind.ARC, machine.limits.arc_um
    line = (t["kind"] == Kind.LINE) | (t["kind"] == Kind.MOVE)
    mm = mm_of(machine.axes.step_um)

    def tell(
        severity: Severity,
        code: str,
        mask: NDArray[np.bool_],
        template: str,
        values: Callable[[int], dict[str, Any]],
    ) -> None:
        findings.extend(
            d
            for _, d in listed(
                severity,
                code,
                np.flatnonzero(mask),
                blocks.spans.__getitem__,
                template,
                values,
            )
        )

    wrong = arc & ((t["start"] >= 360) | (t["degrees"] < 1) | (t["degrees"] > 360))
    tell(
        Severity.ERROR,
        "bad-angle",
        wrong,
        "row {row}, block {block}: A{start} B{degrees}: arcs begin at degree 0 to 359 and turn "
        "over 1 to 360",
        lambda i: {
            "row": blocks.tape_rows[i],
            "block": i + 1,
            "start": int(t["start"][i]),
            "degrees": int(t["degrees"][i]),
        },
    )
    over = arc & (t["radius"] > most)
    tell(
        Severity.ERROR,
        "over-limit",
        over,
        "row {row}, block {block}: the radius is {radius}, the largest is {most}",
        lambda i: {
            "row": blocks.tape_rows[i],
            "block": i + 1,
            "radius": mm(int(t["radius"][i])),
            "most": mm(most),
        },
    )
    still = (arc & (t["radius"] == 0)) | (line & (t["x"] == 0) & (t["y"] == 0))
    tell(
        Severity.WARNING,
        "empty-block",
        still,
        "row {row}, block {block}: it makes no step",
        lambda i: {"row": blocks.tape_rows[i], "block": i + 1},
    )
    return findings


def describe_blocks(data: bytes, machine: Machine) -> dict[str, str]:
    r"""Return what each arc of the tape states, for people, by line:column.

    >>> from wedmcam.formats.tape import punched
    >>> from wedmcam.machines import default
    >>> describe_blocks(punched("G03A0B360R10000\nM02\n"), default("nby15"))
    {'2:1': 'counter-clockwise from degree 0 over 360, R 10.000 mm'}
    """
    blocks, _ = _read(data, machine, "")
    mm = mm_of(machine.axes.step_um)
    return {
        f"{span.line}:{span.column}": f"{'counter-clockwise' if row[1] > 0 else 'clockwise'} from "
        f"degree {row[4]} over {row[5]}, R {mm(row[6])}"
        for row, span in zip(blocks.rows, blocks.spans, strict=True)
        if row[0] == Kind.ARC
    }

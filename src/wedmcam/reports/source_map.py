"""The map from blocks to what was drawn: ``--map FILE.json``, described in docs/map.md.

A machinist sees block 57 stop and wants the line of the drawing; a CAD add-on wants the block of a
line. Blocks are those of the file, decoded, with the numbers of ``dump`` and ``plot``; where each
came from is what lowering carried along. Most formats hold the very blocks that were lowered; a
controller that makes its own (compensation) is followed by geometry.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import EntityRef, Span, TextSpan
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.machines import Machine
from wedmcam.programs.places import block_ends, match_blocks
from wedmcam.programs.rows import where_of

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

VERSION = 1


def source_map(
    lowered: Program, program: Program, machine: Machine, *, summary: dict[str, Any]
) -> dict[str, Any]:
    """Return the map as plain data, ready for ``json.dumps``.

    Args:
        lowered: with roles, cuts and sources.
        program: decoded from the bytes of the output; its blocks are numbered.
        machine: both are of this profile.
        summary: the certificate: names and fingerprints of input and output.
    """
    starts, ends = block_ends(program, machine)
    like = match_blocks(lowered, program, machine)
    source = _lent(lowered)
    words = dict(program.words)
    spans = [span_data(s) for s in lowered.sources]
    rows = []
    b, low = program.blocks, lowered.blocks
    for i in range(len(b)):
        kind, j = Kind(b["kind"][i]), int(like[i])
        row: dict[str, Any] = {
            "block": i + 1,
            "where": where_of(program, i),
            "kind": words.get(i, kind.name.lower()),
            "role": "control",
            "cut": None,
            "start_um": starts[i].tolist(),
            "end_um": ends[i].tolist(),
            "source": None,
        }
        if kind == Kind.MOVE:
            row["role"] = "move"
        elif kind < Kind.MOVE:
            row["role"] = Role(low["role"][j]).name.lower().replace("_", "-")
            row["cut"] = int(low["cut"][j])
            row["source"] = spans[source[j]] if source[j] >= 0 else None
        rows.append(row)
    return {
        "map": VERSION,
        **{key: summary[key] for key in ("input", "output", "format", "profile")},
        "sha256": {key: summary["sha256"][key] for key in ("input", "output")},
        "origin_um": list(program.origin_um),
        "blocks": rows,
    }


def span_data(span: Span) -> dict[str, Any]:
    """Return where something was drawn as plain data.

    >>> span_data(EntityRef("a.dxf", "2F", "ARC", "CUT", ("copy 3", "1A")))["copies"]
    [3]
    """
    if isinstance(span, EntityRef):
        copies: list[int] = []
        via = list(span.via)
        while via and (copy := re.fullmatch(r"copy (\d+)", via[0])):
            copies.append(int(copy[1]))
            del via[0]
        return {
            "file": span.file,
            "handle": span.handle,
            "type": span.dxftype,
            "layer": span.layer,
            "via": via,
            "copies": copies,
        }
    if isinstance(span, TextSpan):
        place = {"file": span.file, "line": span.line, "column": span.column}
        return {**place, "length": span.length, "copies": list(span.copies)}
    return {"file": str(span), "copies": []}


def _lent(lowered: Program) -> Ints:
    """Return the source of each block; leads have that of where they meet the contour."""
    b = lowered.blocks
    source = b["source"].astype(np.int64)
    cutting = b["kind"] < Kind.MOVE
    for role, step in ((Role.LEAD_IN, -1), (Role.LEAD_OUT, 1)):
        last = -1
        last_cut = -1
        for i in range(len(b))[::step]:
            if not cutting[i]:
                continue
            cut = int(b["cut"][i])
            if b["role"][i] == role:
                if source[i] < 0 and cut == last_cut:
                    source[i] = last
            elif b["role"][i] in (Role.CONTOUR, Role.OVERCUT):
                last, last_cut = int(source[i]), cut
    return source

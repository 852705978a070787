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
from wedmcam.frontends.dump import where_of
from wedmcam.geom import measure
from wedmcam.geom import segments as seg
from wedmcam.ir.program import Kind, Program, Role, in_um
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

VERSION = 1
#: Nearer than this two blocks are as good, and the one in its turn is taken, um: leads go back the
#: way they came, and an overcut repeats the start.
SAME_UM = 5.0
#: How many blocks before and after its turn a block is looked for among.
WINDOW = 64


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
    like = matched(lowered, program, machine)
    source = _lent(lowered)
    words = dict(program.words)
    said = [span_data(s) for s in lowered.sources]
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
            row["source"] = said[source[j]] if source[j] >= 0 else None
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


def block_ends(program: Program, machine: Machine) -> tuple[Ints, Ints]:
    """Return where each block starts and ends, shape (blocks, 2), um, drawing coordinates."""
    motion = machine.stepping.run(program.blocks)
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)]) + np.array(program.origin)
    starts = ends - np.column_stack([motion.dx, motion.dy])
    return in_um(starts, program.step_um), in_um(ends, program.step_um)


def matched(lowered: Program, program: Program, machine: Machine) -> Ints:
    """Return the lowered block of each block of the file; -1 for control records."""
    low = np.flatnonzero(lowered.blocks["kind"] <= Kind.MOVE)
    here = np.flatnonzero(program.blocks["kind"] <= Kind.MOVE)
    out = np.full(len(program.blocks), -1, np.int64)
    one, two = lowered.blocks[low], program.blocks[here]
    same = len(one) == len(two) and all(
        (one[f] == two[f]).all() for f in ("kind", "turn", "x", "y", "count")
    )
    out[here] = (
        low
        if same
        else low[_nearest(_drawn(lowered, machine, low), _drawn(program, machine, here))]
    )
    return out


def _drawn(program: Program, machine: Machine, rows: Ints) -> seg.Segments:
    """Return the stepped blocks as segments, drawing um."""
    starts, ends = (p[rows].astype(float) for p in block_ends(program, machine))
    b = program.blocks[rows]
    turn = b["turn"].astype(np.int8)
    cx = starts[:, 0] - b["x"] * program.step_um
    cy = starts[:, 1] - b["y"] * program.step_um
    return seg.make(
        *(starts[:, 0].copy(), starts[:, 1].copy(), ends[:, 0].copy(), ends[:, 1].copy()),
        *(np.where(turn != 0, cx, 0.0), np.where(turn != 0, cy, 0.0), turn),
    )


def _nearest(low: seg.Segments, here: seg.Segments) -> Ints:
    """Return, for each segment of ``here``, the one of ``low`` that runs where its middle is."""
    x, y = measure.middles(here)
    # In its turn: the same share of the whole way, which differs by little.
    begin = np.cumsum(low.length) - low.length
    middle = np.cumsum(here.length) - here.length / 2
    middle *= low.length.sum() / max(float(here.length.sum()), 1.0)
    turn = np.clip(np.searchsorted(begin, middle, "right") - 1, 0, len(low) - 1)
    tried = np.clip(turn[:, None] + np.arange(-WINDOW, WINDOW + 1), 0, len(low) - 1)
    flat = tried.ravel()
    times = tried.shape[1]
    off = seg.distances(low.take(flat), np.repeat(x, times), np.repeat(y, times))
    away = np.abs(begin[flat] + low.length[flat] / 2 - np.repeat(middle, times))
    rank = np.floor(off / SAME_UM) * 1e9 + away
    best = np.argmin(rank.reshape(tried.shape), axis=1)
    chosen: Ints = tried[np.arange(len(x)), best]
    return chosen

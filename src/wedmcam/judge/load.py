"""What the verdict on a program says of one load of it, which begins or ends in the kerf.

A load alone closes no contour: it is judged between the blocks that other loads run. What it does
by itself (blocks, steps, lengths) is counted of it alone; deviation, closure and gouge are those of
the whole program, and hold for each of its loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic, note
from wedmcam.ir.program import Kind, Program, in_um
from wedmcam.judge.segments import Ints
from wedmcam.judge.stretches import per_mm, place
from wedmcam.judge.verdict import BlockTable, CutVerdict, Verdict
from wedmcam.judge.walk import Walk, walk


def verdict_of_load(
    verdict: Verdict,
    findings: Sequence[Diagnostic],
    load: Program,
    whole: Program,
    before: int,
    stepping: Stepping,
) -> tuple[Verdict, list[Diagnostic]]:
    """Return the verdict on a load of a program, and the findings with its numbers told.

    Args:
        verdict, findings: on the whole program.
        load: as decoded.
        whole: the program that was judged.
        before: how many of its blocks ran in earlier loads.
        stepping: of the controller.
    """
    way = walk(whole, stepping, textbook=verdict.count == "textbook")
    # What ends a load is no block of the whole program.
    kinds = load.blocks["kind"]
    last = before + int(((kinds != Kind.STOP) & (kinds != Kind.END)).sum())
    rows = np.arange(before, last)
    own = rows[way.cutting[rows]]
    x, y = load.origin_um
    low, high = _extents(way, own, whole.step_um)
    of_load = replace(
        verdict,
        contours=len({c.number for c in verdict.cuts if _overlaps(c, before, last)}),
        blocks=len(own),
        steps=int(np.maximum(way.steps[own], 0).sum()),
        moves=int((kinds == Kind.MOVE).sum()),
        controls=int((kinds >= Kind.PAUSE).sum()),
        path_mm=float(way.lengths()[own].sum()) / per_mm(whole),
        extents_um=(*low, *high),
        origin_um=(x, y),
        cuts=tuple(
            _cut(c, way, before, last, per_mm(whole))
            for c in verdict.cuts
            if _overlaps(c, before, last)
        ),
        make_table=lambda: _table(verdict.table, before, last),
    )
    told = [_numbered(d, before, last) for d in findings]
    return of_load, [*told, _places(way, whole, load, before, last)]


def _places(way: Walk, whole: Program, load: Program, before: int, last: int) -> Diagnostic:
    """Return the note that says which blocks a load has, and where it begins and ends in the kerf.

    Args:
        way: of the whole program.
        whole: that program.
        load: as decoded.
        before: how many blocks ran in earlier loads.
        last: number of the last block of the load.
    """
    after = bool((whole.blocks["kind"][last:] < Kind.PAUSE).any())
    x, y = way.start[before].tolist()
    start = place(x, y, per_mm(whole))
    x, y = way.end[last - 1].tolist()
    end = place(x, y, per_mm(whole))
    found = note(
        "kerf-load",
        "this load has blocks {first} to {last} of its program",
        points_mm=tuple(p for p, there in ((start, before), (end, after)) if there),
        first=before + 1,
        last=last if after else before + len(load.blocks),
    )
    if before:
        found = found.extended(
            "; it starts in the kerf at {start}, where the load before it ends", start=start
        )
    if after:
        found = found.extended(
            "; it ends in the kerf at {end}: the machine waits there, generator off", end=end
        )
    return found.extended("; deviation, closure and gouge are those of all loads together")


def _overlaps(cut: CutVerdict, before: int, last: int) -> bool:
    return cut.first_block <= last and cut.last_block > before


def _cut(cut: CutVerdict, way: Walk, before: int, last: int, per: float) -> CutVerdict:
    """Return the figures of the blocks that a cut has in a load."""
    rows = np.arange(max(cut.first_block - 1, before), min(cut.last_block, last))
    own = rows[way.cutting[rows] & (way.steps[rows] > 0)]
    return cut._replace(
        first_block=int(rows[0]) + 1 - before,
        last_block=int(rows[-1]) + 1 - before,
        blocks=len(own),
        steps=int(way.steps[own].sum()),
        length_mm=float(way.lengths()[own].sum()) / per,
    )


def _extents(
    way: Walk, own: Ints, step_um: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the box of all places of some blocks, um."""
    e = way.stepping.extents(way.blocks[own], way.steps[own], way.start[own], way.end[own])
    x0, y0, x1, y1 = in_um(np.array([int(v) for v in e]), step_um).tolist()
    return (float(x0), float(y0)), (float(x1), float(y1))


def _table(table: BlockTable, before: int, last: int) -> BlockTable:
    """Return the rows of a load, its blocks numbered from 1."""
    own = (table.block > before) & (table.block <= last)
    return BlockTable(
        block=table.block[own] - before,
        cut=table.cut[own],
        nominal=table.nominal[own],
        stepped=table.stepped[own],
        error=table.error[own],
        low=table.low[own],
        high=table.high[own],
    )


def _numbered(d: Diagnostic, before: int, last: int) -> Diagnostic:
    """Return a finding that says of which program its blocks are counted."""
    if "block" not in d.values:
        return d
    return d.extended(
        "; counted are blocks of the whole program: this load has {load_first} to {load_last}",
        load_first=before + 1,
        load_last=last,
    )

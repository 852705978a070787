"""The verdict on a program, from its record and from what the measures say."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.deviation import measure
from wedmcam.judge.followed import Followed, Terms, places
from wedmcam.judge.segments import Floats, Ints
from wedmcam.judge.stretches import per_mm
from wedmcam.judge.verdict import BlockTable, Count, CutVerdict, Verdict
from wedmcam.judge.walk import Walk


def verdict_of(
    f: Followed, closures: list[float | None], gouge: float | None, uncut: float | None, ok: bool
) -> Verdict:
    """Return the figures of a program, in steps.

    Args:
        f: the program along its plan.
        closures, gouge, uncut: see `Measured`.
        ok: no error was found.
    """
    rows = _rows(f, closures)
    closed = [c for c in closures if c is not None]
    return Verdict(
        ok=ok,
        count=f.count,
        closure_um=max(closed) if closed else None,
        max_deviation_um=max((r.max_deviation_um for r in rows), default=0.0),
        lead_deviation_um=max((r.lead_deviation_um for r in rows), default=0.0),
        gouge_um=gouge,
        uncut_um=uncut,
        contours=len({a.cut for a in f.assigned}),
        extents_um=_extents(f.survey.extents, f.way.end[f.index]),
        cuts=rows,
        make_table=cache(lambda: _table(f)),
        **_totals(f.program, f.plan, replace(f.terms, path_limit_um=f.widest), f.way),
    )


def verdict_of_nothing(
    program: Program, plan: Plan, terms: Terms, way: Walk, count: Count, ok: bool
) -> Verdict:
    """Return the verdict on a program in which nothing belongs to the plan."""
    x, y = program.origin
    return Verdict(
        ok=ok,
        count=count,
        closure_um=None,
        max_deviation_um=0.0,
        lead_deviation_um=0.0,
        gouge_um=None,
        uncut_um=None,
        contours=0,
        extents_um=(x, y, x, y),
        cuts=(),
        make_table=_no_table,
        **_totals(program, plan, terms, way),
    )


def _rows(f: Followed, closures: list[float | None]) -> tuple[CutVerdict, ...]:
    """Return the figures of each cut."""
    lengths = f.way.lengths()
    steps = f.way.steps[f.index]
    on_path = np.where(f.lead | ~f.done, 0.0, f.deviation)
    on_lead = np.where(f.lead & f.done, f.deviation, 0.0)
    lost = dict(f.track.lost)
    on_path[list(lost)] = list(lost.values())
    sums = [np.add.reduceat(v, f.first[:-1]) for v in (steps, lengths[f.index])]
    most = [np.maximum.reduceat(v, f.first[:-1]) for v in (on_path, on_lead)]
    return tuple(
        CutVerdict(
            number=a.cut + 1,
            first_block=int(a.index[0]) + 1,
            last_block=int(a.index[-1]) + 1,
            blocks=len(a.index),
            steps=int(sums[0][k]),
            closed=bool(f.route.closed[k]),
            closure_um=closures[k],
            max_deviation_um=float(most[0][k]),
            lead_deviation_um=float(most[1][k]),
            length_mm=float(sums[1][k]) / f.per,
            backwards=f.backwards[k],
        )
        for k, a in enumerate(f.assigned)
    )


def _table(f: Followed) -> BlockTable:
    """Return every block, measured."""
    done, index = f.done, f.index
    low, high = np.full(len(index), np.nan), np.full(len(index), np.nan)
    every = measure(f.way, index[done], f.track.low[done], f.track.high[done], f.route, None)
    low[done], high[done] = every.low, every.high
    nominal = np.full((len(index), 2), np.nan)
    nominal[done] = places(f.route, f.track.high[done])
    stepped = f.way.end[index]
    error_um = np.hypot(stepped[:, 0] - nominal[:, 0], stepped[:, 1] - nominal[:, 1])
    cut = np.array([a.cut + 1 for a in f.assigned])[f.cut_of]
    return BlockTable(index + 1, cut, nominal, stepped, error_um, low, high)


def _totals(program: Program, plan: Plan, terms: Terms, way: Walk) -> dict[str, Any]:
    """Return the figures that need no route."""
    kind = way.blocks["kind"]
    kept = {s.keeps for s in plan.scenes} - {None}
    return {
        "blocks": int(way.cutting.sum()),
        "steps": int(np.maximum(way.steps[way.cutting], 0).sum()),
        "moves": int((kind == Kind.MOVE).sum()),
        "controls": int((kind >= Kind.PAUSE).sum()),
        "path_mm": float(way.lengths()[way.cutting].sum()) / per_mm(program),
        "origin_um": program.origin,
        "offset_um": plan.offset_um,
        "side": str(plan.side) if len(kept) < 2 else "mixed",
        "path_limit_um": terms.path_limit_um,
        "gouge_limit_um": terms.gouge_limit_um,
    }


def _no_table() -> BlockTable:
    """Return the table of no block."""
    none, count, places = np.zeros(0), np.zeros(0, np.int64), np.zeros((0, 2))
    return BlockTable(count, count, places, places.astype(np.int64), none, none, none)


def _extents(e: Floats, stepped: Ints) -> tuple[float, float, float, float]:
    """Return the box of all places, block ends that were not measured included."""
    return (
        float(min(e[0], stepped[:, 0].min())),
        float(min(e[1], stepped[:, 1].min())),
        float(max(e[2], stepped[:, 0].max())),
        float(max(e[3], stepped[:, 1].max())),
    )

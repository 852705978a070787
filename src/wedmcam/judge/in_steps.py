"""A plan in the steps of a machine, and figures in um.

The judge measures in steps: one of them is the unit of every bound that it knows, and where a step
is 1 um there is nothing to do. Lowering scales the plan by itself; here it is done once more.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan, Scene
from wedmcam.judge.verdict import BlockTable, CutVerdict, Verdict


def in_steps(plan: Plan, step_um: float) -> Plan:
    """Return a plan with all lengths in steps; thread points on the nearest whole one.

    Halves go away from zero.
    """
    if step_um == 1:
        return plan

    def contour(c: Contour) -> Contour:
        v = c.vertices.copy()
        for name in ("x", "y", "cx", "cy"):
            v[name] = v[name] / step_um
        return Contour(v, c.closed, c.sources)

    def whole(um: float) -> int:
        return math.floor(abs(um) / step_um + 0.5 + 1e-7) * (1 if um > 0 else -1)

    def cut(c: Cut) -> Cut:
        x, y = c.thread
        return replace(
            c,
            outline=None if c.outline is None else contour(c.outline),
            path=contour(c.path),
            thread=(whole(x), whole(y)),
            stop_um=c.stop_um / step_um,
            overcut_um=c.overcut_um / step_um,
            offset_um=c.offset_um / step_um,
            clearance_um=c.clearance_um / step_um,
        )

    def scene(s: Scene) -> Scene:
        outlines = tuple(contour(c) for c in s.outlines)
        return replace(
            s,
            outlines=outlines,
            offsets=tuple(o / step_um for o in s.offsets),
            clearances=tuple(c / step_um for c in s.clearances),
        )

    return replace(
        plan,
        cuts=tuple(cut(c) for c in plan.cuts),
        scenes=tuple(scene(s) for s in plan.scenes),
    )


def verdict_in_um(v: Verdict, step_um: float) -> Verdict:
    """Return a verdict whose lengths are in um and not in steps; mm are mm already."""
    if step_um == 1:
        return v

    def um(value: float | None) -> float | None:
        return None if value is None else value * step_um

    def cut(c: CutVerdict) -> CutVerdict:
        return c._replace(
            closure_um=um(c.closure_um),
            max_deviation_um=c.max_deviation_um * step_um,
            lead_deviation_um=c.lead_deviation_um * step_um,
        )

    def table() -> BlockTable:
        t = v.table
        return t._replace(
            nominal=t.nominal * step_um,
            stepped=np.asarray(t.stepped * step_um, np.float64),
            error=t.error * step_um,
            low=t.low * step_um,
            high=t.high * step_um,
        )

    x, y = v.origin_um
    x0, y0, x1, y1 = (e * step_um for e in v.extents_um)
    return replace(
        v,
        closure_um=um(v.closure_um),
        max_deviation_um=v.max_deviation_um * step_um,
        lead_deviation_um=v.lead_deviation_um * step_um,
        gouge_um=um(v.gouge_um),
        uncut_um=um(v.uncut_um),
        extents_um=(x0, y0, x1, y1),
        origin_um=(_plain(x * step_um), _plain(y * step_um)),
        offset_um=v.offset_um * step_um,
        path_limit_um=v.path_limit_um * step_um,
        gouge_limit_um=v.gouge_limit_um * step_um,
        cuts=tuple(cut(c) for c in v.cuts),
        make_table=table,
    )


def _plain(value: float) -> float:
    """Return a whole number as one."""
    return int(value) if value == int(value) else value

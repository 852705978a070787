"""The judge's figures against slow and obvious ones: step loop, dense samples, brute force."""

from __future__ import annotations

import numpy as np
import pytest
from judge_cases import (
    hole_plan,
    lower,
    part_with_hole,
    skew_plan,
    square_plan,
)

from wedmcam.controllers.pointwise import LineTable, block_steps, of_table
from wedmcam.ir.plan import Side
from wedmcam.ir.program import Kind
from wedmcam.judge.judge import judge
from wedmcam.judge.witness import swept_gouge


def stepped(program, table):
    """All places while cutting, one list a run, by the step loop."""
    at = np.array(program.origin)
    runs, held = [], [at]
    for b in program.blocks:
        if b["kind"] > Kind.MOVE:
            if len(held) > 1:
                runs.append(np.array(held))
            held = [at]
            continue
        start = at
        for s in block_steps(b, table):
            at = start + np.array([s.x, s.y])
            if b["kind"] != Kind.MOVE:
                held.append(at)
        if b["kind"] == Kind.MOVE:
            held = [at]
    return runs


def dense(cut, step):
    """Points of the whole route of a cut, about ``step`` um apart."""
    t = np.array(cut.thread, float)
    v = cut.path.starts
    v0 = np.array([v["x"][0], v["y"][0]])

    def line(a, b):
        n = max(2, int(np.hypot(*(b - a)) / step) + 1)
        return a + np.linspace(0, 1, n)[:, None] * (b - a)

    parts = [line(t, v0)]
    for a, b in zip(v, cut.path.ends, strict=True):
        p, q = np.array([a["x"], a["y"]]), np.array([b["x"], b["y"]])
        if not a["turn"]:
            parts.append(line(p, q))
            continue
        c = np.array([a["cx"], a["cy"]])
        r = np.hypot(*(p - c))
        a0, a1 = (np.arctan2(*(w - c)[::-1]) for w in (p, q))
        sweep = np.mod((a1 - a0) * a["turn"], 2 * np.pi) or 2 * np.pi
        angle = a0 + a["turn"] * np.linspace(0, sweep, max(2, int(r * sweep / step) + 1))
        parts.append(c + r * np.column_stack([np.cos(angle), np.sin(angle)]))
    parts.append(line(v0, t))
    return np.concatenate(parts)


def farthest(a, b):
    """The largest distance of a point of a from all points of b."""
    worst = 0.0
    for part in np.array_split(a, max(1, len(a) * len(b) // 4_000_000)):
        d = np.hypot(part[:, None, 0] - b[:, 0], part[:, None, 1] - b[:, 1])
        worst = max(worst, float(d.min(axis=1).max()))
    return worst


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize("size", [333.0, 700.0])
@pytest.mark.parametrize("turn", [0.3, 1.9, -2.5])
def test_deviation_is_that_of_brute_force(turn, size, table):
    plan = skew_plan(turn, size, 33.3)
    program = lower(plan, table)
    verdict, _ = judge(program, plan, stepping=of_table(table))
    (places,) = stepped(program, table)
    route = dense(plan.cuts[0], 0.4)
    # Leads are counted apart, and overlap each other: of the two figures the larger.
    figure = max(verdict.max_deviation_um, verdict.lead_deviation_um)
    there = farthest(places[::5], route)
    back = farthest(route[::19], places)
    assert there <= figure + 0.03
    assert back <= figure + 0.2
    assert figure <= max(there, back) + 0.6  # a place in five; vertices count whole
    assert verdict.steps == len(places) - 1
    low, high = places.min(axis=0), places.max(axis=0)
    assert verdict.extents_um == (low[0], low[1], high[0], high[1])


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize(
    "plan",
    [
        hole_plan(Side.DIE),
        square_plan(4000),
        square_plan(4000, Side.DIE),
        part_with_hole(),
        skew_plan(0.7, 5000.0),
    ],
    ids=["hole", "punch", "die", "part with hole", "skew"],
)
def test_gouge_is_that_of_the_witness(plan, table):
    program = lower(plan, table)
    verdict, findings = judge(program, plan, stepping=of_table(table))
    assert verdict.ok, findings
    places = np.concatenate(stepped(program, table))
    assert verdict.gouge_um == pytest.approx(swept_gouge(plan, places), abs=0.1)
    assert verdict.closure_um == 0
    assert verdict.contours == len(plan.cuts)


def test_published_hole_closes_and_is_within_a_micron():
    program = lower(hole_plan(Side.DIE))
    assert program.blocks["count"].tolist()[:3] == [9900, 39600, 9900]
    verdict, findings = judge(program, hole_plan(Side.DIE), stepping=of_table(LineTable.ROTATE))
    assert verdict.ok
    assert not findings
    assert (verdict.closure_um, verdict.blocks, verdict.controls) == (0.0, 3, 1)
    assert verdict.max_deviation_um == 1.0
    assert verdict.steps == 9900 + 8 * 9900 + 9900
    assert verdict.path_mm == pytest.approx(2 * 9.9 + 2 * np.pi * 9.9)


def test_inner_corners_of_a_die_are_told():
    plan = square_plan(side=Side.DIE)
    verdict, findings = judge(lower(plan), plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.uncut_um == pytest.approx(100 * (np.sqrt(2) - 1))
    assert [f.code for f in findings] == ["uncut-corner"]


def test_table_names_every_block():
    plan = part_with_hole()
    program = lower(plan)
    verdict, _ = judge(program, plan, stepping=of_table(LineTable.ROTATE))
    t = verdict.table
    cutting = np.flatnonzero(program.blocks["kind"] <= Kind.ARC)
    assert t.block.tolist() == (cutting + 1).tolist()
    assert t.cut.tolist() == [1] * 3 + [2] * (len(cutting) - 3)
    assert t.error.max() == pytest.approx(0, abs=1e-9)
    assert (t.low <= 0).all()
    assert (t.high >= 0).all()
    assert np.maximum(-t.low, t.high).max() <= verdict.max_deviation_um
    assert [c.first_block for c in verdict.cuts] == [1, 7]
    assert [c.last_block for c in verdict.cuts] == [3, len(program.blocks) - 1]

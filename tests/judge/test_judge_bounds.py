"""What is told of blocks without their places holds for their places; few have to be looked at."""

from __future__ import annotations

import numpy as np
import pytest
from judge_cases import circle, edited, hole_plan, lower, part_with_hole, skew_plan, square_plan

from plans import one_scene
from wedmcam.controllers.pointwise import LineTable, of_table
from wedmcam.ir.plan import Cut, Side
from wedmcam.judge import survey as survey_module
from wedmcam.judge.bounds import bound
from wedmcam.judge.deviation import measure
from wedmcam.judge.followed import track_cuts
from wedmcam.judge.judge import judge
from wedmcam.judge.route import plan_route
from wedmcam.judge.stretches import assign, stretches
from wedmcam.judge.walk import walk

PLANS = {
    "hole": hole_plan(Side.DIE),
    "square": square_plan(),
    "die": square_plan(side=Side.DIE),
    "part with hole": part_with_hole(),
    **{f"skew {t} {s:.0f}": skew_plan(t, s) for t in (0.3, 1.1, -2.2) for s in (900.0, 7000.0)},
    "crooked circle": one_scene(
        (Cut(circle(0.3, -0.4, 5000.7), circle(0.3, -0.4, 4900.7), (0, 0)),),
        (circle(0.3, -0.4, 5000.7),),
        (0,),
        Side.DIE,
        100.0,
    ),
}


def tracked(plan, program, table):
    way = walk(program, of_table(table))
    assigned, _ = assign(program, stretches(way), plan.cuts)
    cuts = [plan.cuts[a.cut] for a in assigned]
    route = plan_route(cuts)
    index = np.concatenate([a.index for a in assigned])
    t = track_cuts(way, route, assigned)
    done = ~np.isnan(t.high)
    return way, index[done], t.low[done], t.high[done], route


def boxed(way, index):
    rows = (way.blocks[index], way.steps[index], way.start[index], way.end[index])
    return way.stepping.extents(*rows)


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize("name", PLANS)
def test_bounds_hold(name, table):
    plan = PLANS[name]
    program = lower(plan, table)
    for change in (None, 1, -1, 3):
        forged = program
        if change is not None:

            def longer(b, change=change):
                b["count"][1] += change

            forged = edited(program, longer)
        case = tracked(plan, forged, table)
        b, m = bound(*case), measure(*case, None)
        k = b.known
        assert (b.low[k] <= m.low[k] + 1e-9).all()
        assert (b.high[k] >= m.high[k] - 1e-9).all()
        assert (b.gap[k] >= m.gap[k] - 1e-9).all()
        assert (b.least[k] <= m.deviation[k] + 1e-9).all()
        stray = np.maximum.reduce([b.back, b.over, b.under, b.short])
        before = np.concatenate([[0.0], np.where(k, b.over, m.stray)[:-1]])
        assert (stray[k] + before[k] >= m.stray[k] - 1e-6).all()
        start = case[0].start[case[1]]  # what is measured are the places after steps
        low, high = np.minimum(m.extents[:2], start.min(0)), np.maximum(m.extents[2:], start.max(0))
        assert boxed(case[0], case[1]).tolist() == [*low, *high]
        if change is None:
            assert k.all() or "skew" in name  # small corners are measured
            slack = b.deviation[k] - m.deviation[k]
            assert np.median(slack) < 0.5


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize("name", PLANS)
def test_figures_are_those_of_measuring_everything(name, table, monkeypatch):
    plan = PLANS[name]
    program = lower(plan, table)
    few, found_few = judge(program, plan, stepping=of_table(table))
    whole = survey_module.everything
    monkeypatch.setattr(
        "wedmcam.judge.followed.survey",
        lambda way, index, low, high, lead, route, kept, a, b: whole(
            way, index, low, high, route, kept
        ),
    )
    every, found = judge(program, plan, stepping=of_table(table))
    assert few.ok == every.ok
    assert [f.message for f in found_few] == [f.message for f in found]
    for figure in ("max_deviation_um", "lead_deviation_um", "gouge_um", "extents_um", "closure_um"):
        assert getattr(few, figure) == pytest.approx(getattr(every, figure), abs=1e-6), figure
    for one, other in zip(few.cuts, every.cuts, strict=True):
        assert one.max_deviation_um >= other.max_deviation_um - 1e-6
        assert one.max_deviation_um <= few.max_deviation_um + 1e-6
        assert one._replace(max_deviation_um=0, lead_deviation_um=0) == other._replace(
            max_deviation_um=0, lead_deviation_um=0
        )
    assert np.array_equal(few.table.low, every.table.low)


def test_most_blocks_are_not_stepped(monkeypatch):
    """A lattice of holes: a few of them tell the figures of all."""
    cuts, outlines = [], []
    for k in range(64):
        x, y = 3000 * (k % 8), 3000 * (k // 8)
        outlines.append(circle(x, y, 1000))
        cuts.append(Cut(outlines[-1], circle(x, y, 900), (x, y), number=k + 1))
    plan = one_scene(tuple(cuts), tuple(outlines), (0,) * 64, Side.DIE, 100.0)
    program = lower(plan)
    stepped = []

    def counted(way, index, *more):
        stepped.append(len(index))
        return measure(way, index, *more)

    monkeypatch.setattr(survey_module, "measure", counted)
    verdict, findings = judge(program, plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok, findings
    assert verdict.max_deviation_um == pytest.approx(1.0, abs=1e-6)
    assert sum(stepped) < verdict.blocks / 4

"""What is measured of proven runs with less work is what measuring every place finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from judge_cases import edited, lower, polygon, square_plan
from test_judge_bounds import PLANS, tracked

import parts
from wedmcam.compiler import sources
from wedmcam.controllers.pointwise import LineTable
from wedmcam.diag.run import Run
from wedmcam.judge.bounds import bound
from wedmcam.judge.deviation import measure
from wedmcam.judge.extremes import extremes
from wedmcam.judge.material import Coverage, coverage, kept_material
from wedmcam.judge.route import plan_route
from wedmcam.judge.survey import SHARE
from wedmcam.options import Options


def agree(plan, case):
    way, index, low, high, route = case
    b = bound(*case)
    runs = b.known & (b.over <= SHARE) & (b.under + b.back <= SHARE) & (b.short <= SHARE)
    k = np.flatnonzero(runs)
    if not len(k):
        return 0
    kept = kept_material(plan.materials[0], route, np.ones(len(route.closed), bool))
    one = extremes(way, index[k], low[k], high[k], route, kept)
    every = measure(way, index, low, high, route, kept)
    # A place beyond the end may be nearer to a vertex than those of this block alone.
    assert np.abs(one.low - every.low[k]).max() < 1e-6
    assert np.abs(one.high - every.high[k]).max() < 1e-6
    assert (one.gap >= every.gap[k] - 1e-9).all()
    assert (one.gap <= b.gap[k] + 1e-9).all()
    if len(k) == len(index):
        assert one.gouge == pytest.approx(every.gouge, abs=1e-6)
    return len(k)


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize("name", PLANS)
def test_the_same_as_measuring(name, table):
    plan = PLANS[name]
    program = lower(plan, table)
    for change in (0, 1, -1):

        def longer(b, change=change):
            b["count"][1] += change

        agree(plan, tracked(plan, edited(program, longer), table))
    assert agree(plan, tracked(plan, program, table))


@pytest.mark.parametrize("seed", range(6))
def test_random_parts(seed):
    options, run = Options.of(offset_um=100.0), Run()
    drawn = sources.read(parts.dxf_bytes(parts.random_part(seed)), "part", options, run)
    plan = sources.where_the_wire_goes(drawn, options, run)
    program = lower(plan, LineTable.ROTATE)
    assert agree(plan, tracked(plan, program, LineTable.ROTATE)) > 10


def test_a_closed_outline_without_a_length_has_nothing_to_reach():
    plan = square_plan()
    nothing = replace(
        plan.materials[0], outlines=(polygon((5, 5), (5, 5)),), depths=(0,), reached=(0,)
    )
    assert coverage(nothing, plan_route(plan.cuts)) == Coverage(0.0, (0.0, 0.0), ())

"""What a program does by itself, against the step loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from judge_cases import arc, control, line, lower, move, part_with_hole, skew_plan

from wedmcam import api, machines
from wedmcam.controllers.pointwise import LineTable, block_steps, of_table
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge.totals import figures

LIMITS = machines.default("3b").limits


def by_steps(program, table):
    at, low, high, total = np.zeros(2, int), np.zeros(2, int), np.zeros(2, int), 0
    last, turns = [1, 1], [0, 0]
    for b in program.blocks:
        start = at
        for s in block_steps(b, table):
            at = start + np.array([s.x, s.y])
            low, high = np.minimum(low, at), np.maximum(high, at)
            turns[s.axis] += s.sign != last[s.axis]
            last[s.axis] = s.sign
            total += b["kind"] != Kind.MOVE
    return [*low.tolist(), *high.tolist()], total, turns, at.tolist()


@pytest.mark.parametrize("table", LineTable)
def test_figures_are_those_of_the_step_loop(table, monkeypatch):
    monkeypatch.setattr("wedmcam.judge.totals.PIECE", 3)
    for plan in (part_with_hole(), skew_plan(2.2, 900.0)):
        program = replace(lower(plan, table), origin=(0, 0))
        f, found = figures(program, of_table(table), LIMITS)
        box, total, turns, end = by_steps(program, table)
        assert not found
        assert f["extents_um"] == box
        assert f["steps"] == total
        assert [f["reversals"]["x"], f["reversals"]["y"]] == turns
        assert f["end_um"] == end
        assert f["closure_um"] == 0
        assert f["contours"] == len(plan.cuts)


def test_published_hole():
    rows = [line(9900, 0), arc(9900, 0, 1, Axis.Y, 39600), line(-9900, 0), control(Kind.STOP)]
    program = Program(np.concatenate(rows))
    f, _ = figures(program, of_table(LineTable.ROTATE), LIMITS)
    assert f["path_mm"] == pytest.approx(2 * 9.9 + 2 * np.pi * 9.9, abs=0.001)
    assert f["steps"] == 9900 + 79200 + 9900
    assert f["reversals"] == {"x": 3, "y": 2}
    assert f["limits"]["count_um"] == {
        "largest": 39600,
        "limit": 999_999,
        "margin": 960_399,
        "block": 2,
    }
    assert api.minutes(f["path_mm"], 1000.0) == pytest.approx(82.0)


def test_what_cannot_run_is_found():
    forged = np.concatenate([line(50, 0), line(50, 0), arc(1, 0, 1, Axis.Y, 9), line(9, 0)])
    forged["axis"][1] = Axis.Y
    forged["count"][3] = 1_000_000
    _, found = figures(Program(forged), of_table(LineTable.ROTATE), LIMITS)
    said = {(d.code, d.message.split()[1].rstrip(":")) for d in found}
    assert {("endless-block", "2"), ("endless-block", "3"), ("block-limit", "4")} <= said


def test_closure_is_of_each_cut():
    rows = [line(500, 0), line(-499, 0), move(0, 700), line(20, 0), line(-20, 0)]
    f, _ = figures(Program(np.concatenate(rows)), of_table(LineTable.ROTATE), LIMITS)
    assert (f["contours"], f["closure_um"], f["moves"]) == (2, 1.0, 1)
    f, _ = figures(Program(line(500, 0)), of_table(LineTable.ROTATE), LIMITS)
    assert f["closure_um"] is None
    f, _ = figures(Program(control(Kind.END)), of_table(LineTable.ROTATE), LIMITS)
    assert (f["contours"], f["steps"], f["extents_um"]) == (0, 0, [0, 0, 0, 0])

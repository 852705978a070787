"""Programs compared as step paths, against places from the step loop."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from judge_cases import arc, control, edited, line, lower, move, part_with_hole, skew_plan

from wedmcam import api
from wedmcam.controllers.pointwise import block_steps, of_table
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge import difference as module
from wedmcam.judge.difference import difference

GOLDEN = Path(__file__).parents[1] / "golden"
ROTATE, MIRROR = of_table("rotate"), of_table("mirror")


def places(program, table):
    at, out = np.zeros(2, int), [np.zeros(2, int)]
    for b in program.blocks:
        start = at
        for s in block_steps(b, table):
            at = start + np.array([s.x, s.y])
            out.append(at)
    return np.array(out, float)


def apart(p, q):
    d = np.hypot(p[:, None, 0] - q[:, 0], p[:, None, 1] - q[:, 1])
    return max(d.min(axis=0).max(), d.min(axis=1).max())


def test_a_program_is_itself_wherever_it_starts():
    program = lower(part_with_hole())
    found = difference(program, replace(program, origin=(7, -9)), ROTATE, ROTATE, 0.0)
    assert found.equal
    assert found.largest_um == 0


@pytest.mark.parametrize("within", [0.5, 1.0, 2.5])
@pytest.mark.parametrize("size", [300.0, 450.0])
@pytest.mark.parametrize("turn", [0.3, 1.2, -2.0])
def test_tables_differ_by_what_the_step_loop_says(turn, size, within, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 61)
    program = lower(skew_plan(turn, size, 33.3), ROTATE.table)
    found = difference(program, program, ROTATE, MIRROR, within)
    truth = apart(places(program, ROTATE.table), places(program, MIRROR.table))
    assert found.equal == (truth <= within)
    if found.equal:
        assert found.largest_um == pytest.approx(truth)


def test_blocks_need_not_match():
    whole = Program(np.concatenate([line(100, 0), line(0, 70), control(Kind.STOP)]))
    parts = [line(30, 0), line(70, 0), line(0, 20), line(0, 50)]
    assert difference(whole, Program(np.concatenate(parts)), ROTATE, ROTATE, 0.0).equal
    # A line as its double, a circle from quadrants (its radius is whole, so they meet).
    assert difference(
        whole, edited(whole, lambda b: b["x"].__setitem__(0, 200)), ROTATE, ROTATE, 0.0
    ).equal
    circle = Program(arc(500, 0, 1, Axis.Y, 2000))
    corners = ((500, 0, Axis.X), (0, 500, Axis.Y), (-500, 0, Axis.X), (0, -500, Axis.Y))
    quarters = [arc(x, y, 1, axis, 500) for x, y, axis in corners]
    assert difference(circle, Program(np.concatenate(quarters)), ROTATE, ROTATE, 0.0).equal


def test_the_first_difference_is_named():
    program = lower(skew_plan())
    for row in (0, 3, 8):
        forged = edited(
            program, lambda b, row=row: b["count"].__setitem__(row, b["count"][row] + 9)
        )
        found = difference(program, forged, ROTATE, ROTATE, 2.0)
        assert not found.equal
        # Along a smooth path it shows where the next curve begins.
        assert row + 1 <= found.block_a <= row + 3
        assert row + 1 <= found.block_b <= row + 3
        assert 2.0 < found.distance_um < 10.0
        assert difference(program, forged, ROTATE, ROTATE, 50.0).equal


def test_a_vertex_moved_by_three_microns_is_equal_within_three():
    one = Program(np.concatenate([line(1000, 0), line(0, 1000)]))
    two = Program(np.concatenate([line(1000, 3), line(0, 997)]))
    assert difference(one, two, ROTATE, ROTATE, 3.0).equal
    found = difference(one, two, ROTATE, ROTATE, 2.0)
    assert (found.equal, found.block_a, found.block_b) == (False, 1, 1)
    assert found.distance_um == pytest.approx(5**0.5)  # where it first is more than two


def test_generator_and_length_count():
    cut = Program(np.concatenate([line(100, 0), line(50, 0)]))
    moved = Program(np.concatenate([line(100, 0), move(50, 0)]))
    found = difference(cut, moved, ROTATE, ROTATE)
    assert not found.equal
    short = Program(line(100, 0))
    found = difference(cut, short, ROTATE, ROTATE)
    assert not found.equal
    assert found.block_a == 2
    assert difference(short, cut, ROTATE, ROTATE).block_b == 2
    longer = Program(np.concatenate([line(100, 0), move(9, 0), line(100, 0)]))
    assert difference(short, longer, ROTATE, ROTATE).block_b == 2
    endless = edited(short, lambda b: b["axis"].__setitem__(0, Axis.Y))
    assert difference(endless, cut, ROTATE, ROTATE).what == "the block never ends"


def test_a_retraced_line_is_no_line():
    """The same places in another order: back and forth is not once."""
    once = Program(line(400, 0))
    thrice = Program(np.concatenate([line(400, 0), line(-400, 0), line(400, 0)]))
    assert not difference(once, thrice, ROTATE, ROTATE, 3.0).equal
    assert not difference(thrice, once, ROTATE, ROTATE, 3.0).equal


@pytest.mark.parametrize("name", ["key-punch", "gear-24", "plate"])
def test_formats_describe_one_path(name):
    found, said = api.diff(GOLDEN / f"{name}.3b", GOLDEN / f"{name}.zd")
    assert found is not None
    assert found.equal, (found, said)
    found, _ = api.diff(GOLDEN / f"{name}.3b", GOLDEN / "bracket-inch.3b")
    assert found is not None
    assert not found.equal
    data = api.difference_data(found)
    assert data["block_a"] >= 1
    assert not data["equal"]
    assert api.diff(GOLDEN / f"{name}.3b", b"nothing")[0] is None

"""Forged programs and plans, each of which the judge must refuse with its code and its block."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from judge_cases import (
    OFFSET,
    arc_to,
    circle,
    control,
    edited,
    hole_plan,
    line,
    lower,
    move,
    part_with_hole,
    skew_plan,
    square,
    square_inside,
    square_outside,
    square_plan,
)
from same_steps import same_steps

from plans import one_scene
from wedmcam.controllers.pointwise import LineTable, of_table
from wedmcam.diag import Severity, TextSpan
from wedmcam.ir.plan import Cut, Side
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge.followed import Terms
from wedmcam.judge.judge import judge

TABLES = list(LineTable)

#: A program from elsewhere has an order and leads of its own; a plan may leave out what is narrow.
FOREIGN, TRIMMED = Terms(strict_order=False), Terms(trimmed=True)


def refuse(program, plan, table=LineTable.ROTATE, **more):
    """Judge, demand a refusal, return {code: message} of the errors."""
    verdict, findings = judge(program, plan, stepping=of_table(table), **more)
    errors = [f for f in findings if f.severity is Severity.ERROR]
    assert not verdict.ok
    assert errors
    return {f.code: f.message for f in reversed(errors)}


def change(program, row, **fields):
    def do(b):
        for name, value in fields.items():
            b[name][row] = value

    return edited(program, do)


def first_arc(program):
    return int(np.flatnonzero(program.blocks["kind"] == Kind.ARC)[0])


# --- one block ---------------------------------------------------------------------------------


@pytest.mark.parametrize("table", TABLES)
@pytest.mark.parametrize("nth", range(4))
def test_sense_swapped(table, nth):
    plan = skew_plan()
    program = lower(plan, table)
    row = int(np.flatnonzero(program.blocks["kind"] == Kind.ARC)[nth])
    errors = refuse(change(program, row, turn=-program.blocks["turn"][row]), plan, table)
    assert f"block {row + 1} " in errors["path-deviation"]


def test_full_circle_the_wrong_way_round_leaves_no_place_but_is_refused():
    plan = hole_plan(Side.DIE)
    program = change(lower(plan), 1, turn=-1)
    errors = refuse(program, plan)
    assert errors.keys() == {"wrong-order"}
    assert errors["wrong-order"].startswith("block 2 ")


def test_full_circle_twice_in_one_block():
    plan = hole_plan(Side.DIE)
    program = lower(plan)
    errors = refuse(change(program, 1, count=2 * program.blocks["count"][1]), plan)
    assert errors["wrong-order"].startswith("block 2 ")


@pytest.mark.parametrize("table", TABLES)
@pytest.mark.parametrize("more", [1, -1, 5, -5])
@pytest.mark.parametrize("row", range(10))
def test_count_length_off(row, more, table):
    plan = skew_plan()
    program = lower(plan, table)
    program = change(program, row, count=program.blocks["count"][row] + more)
    errors = refuse(program, plan, table)
    if row in (0, 9):
        assert "thread-point" in errors
    else:
        assert "not-closed" in errors
        assert errors["not-closed"].startswith("block 9 ")
    if abs(more) == 5 and row < 9:
        named = errors.get("path-deviation", errors.get("wrong-order"))
        # The block itself, or, where it only came too far along a smooth path, a later one.
        assert int(named.split()[1]) > row


def test_count_length_of_a_circle_off_by_one():
    plan = hole_plan(Side.DIE)
    for more in (1, -1):
        program = lower(plan)
        errors = refuse(change(program, 1, count=39600 + more), plan)
        assert errors["not-closed"].startswith("block 2 ")


@pytest.mark.parametrize("table", TABLES)
@pytest.mark.parametrize("row", range(10))
def test_block_dropped_doubled_or_swapped(row, table):
    plan = skew_plan()
    program = lower(plan, table)
    errors = refuse(edited(program, lambda b: np.delete(b, row)), plan, table)
    if row < 9:
        assert errors["path-deviation"].startswith(f"block {row + 1} ")
    else:
        assert errors["missing-piece"].startswith("block 9 ")
    errors = refuse(edited(program, lambda b: np.insert(b, row, b[row])), plan, table)
    assert errors["path-deviation"].startswith(f"block {row + 2} ")
    if row < 9:
        order = list(range(len(program.blocks)))
        order[row], order[row + 1] = order[row + 1], order[row]
        errors = refuse(edited(program, lambda b: b[order]), plan, table)
        assert errors["path-deviation"].startswith(f"block {row + 1} ")


@pytest.mark.parametrize("row", range(10))
def test_count_axis_flipped(row):
    plan = skew_plan()
    program = lower(plan)
    errors = refuse(change(program, row, axis=1 - program.blocks["axis"][row]), plan)
    assert errors["path-deviation"].startswith(f"block {row + 1} ")


@pytest.mark.parametrize("name", ["x", "y"])
@pytest.mark.parametrize("row", range(10))
def test_quadrant_changed(row, name):
    plan = skew_plan()
    program = lower(plan)
    errors = refuse(change(program, row, **{name: -program.blocks[name][row]}), plan)
    assert any(m.startswith(f"block {row + 1} ") for m in errors.values())


def test_vertex_moved_by_three_microns():
    plan = square_plan()
    program = lower(plan)
    # Lines 5 and 7 run up the right side and along the top: the vertex between them moves out.
    rows = np.flatnonzero(program.blocks["kind"] == Kind.LINE)
    up = next(r for r in rows if program.blocks["y"][r] == 10000)

    def out(b):
        b["x"][up] += 3
        b["x"][up + 1] += 3  # the arc's centre stays, so it runs 3 um outside

    errors = refuse(edited(program, out), plan)
    assert f"block {up + 1} " in errors["path-deviation"]


def test_mirrored_arc():
    """The corner arc bulges inwards: same ends, same steps, the other side of the chord."""
    plan = square_plan()
    program = lower(plan)
    row = first_arc(program)
    b = program.blocks[row]
    # From (0, -100) counter-clockwise to (100, 0): mirrored in the chord it is clockwise.
    assert (int(b["x"]), int(b["y"])) == (0, -100)
    mirrored = change(program, row, x=-100, y=0, turn=-1, axis=1 - b["axis"])
    errors = refuse(mirrored, plan)
    assert errors["path-deviation"].startswith(f"block {row + 1} ")
    assert "gouge" in errors


def test_endless_and_empty_blocks():
    plan = square_plan()
    program = lower(plan)
    assert refuse(change(program, 0, axis=Axis.X), plan)["endless-block"].startswith("block 1 ")
    assert refuse(change(program, 1, count=0), plan)["empty-block"].startswith("block 2:")


def test_limits():
    @dataclass(frozen=True)
    class Small:
        count_um: int = 9999
        line_um: int = 9999
        arc_um: int = 99

    plan = square_plan()
    program = lower(plan)
    _, findings = judge(program, plan, stepping=of_table(LineTable.ROTATE), limits=Small())
    said = [f.message.split(":")[0] for f in findings if f.code == "block-limit"]
    # Three long sides by J and again by x or y; four corner arcs of radius 100.
    rows = program.blocks
    long = [f"block {n + 1}" for n in np.flatnonzero(rows["count"] == 10000)]
    arcs = [f"block {n + 1}" for n in np.flatnonzero(rows["kind"] == Kind.ARC)]
    assert len(long) == 3
    assert len(arcs) == 4
    assert sorted(said) == sorted(long * 2 + arcs)
    assert {f.code for f in findings} == {"block-limit"}


def test_findings_point_to_the_source():
    plan = skew_plan()
    program = lower(plan)
    spans = tuple(TextSpan("part.3b", n + 1, 1) for n in range(len(program.blocks)))
    program = replace(change(program, 3, turn=-1), spans=spans)
    _, findings = judge(program, plan, stepping=of_table(LineTable.ROTATE))
    assert str(findings[0].span) == "part.3b:4:1"
    assert findings[0].points_mm


# --- side, offset, what is cut -------------------------------------------------------------------


@pytest.mark.parametrize("table", TABLES)
def test_die_for_part_even_where_the_plan_itself_is_wrong(table):
    d = OFFSET
    for path, thread, side in (
        (square_inside(10000, d), (5000, 5000), Side.PART),
        (square_outside(10000, d), (5000, -1000), Side.DIE),
    ):
        plan = one_scene((Cut(square(10000), path, thread),), (square(10000),), (0,), side, d)
        errors = refuse(lower(plan, table), plan, table)
        assert "the wire is 0.200 mm deep" in errors["gouge"]
        verdict, _ = judge(lower(plan, table), plan, stepping=of_table(table))
        assert verdict.gouge_um >= 2 * d - 1e-9
        assert "missing-piece" in errors


def test_program_of_the_other_side_against_a_right_plan():
    die, part = square_plan(side=Side.DIE), square_plan()
    program = replace(lower(die), origin=part.cuts[0].thread)
    assert "path-deviation" in refuse(program, part)
    errors = refuse(lower(die), part)
    assert errors["thread-point"].startswith("block 1 ")


@pytest.mark.parametrize("inside", [False, True])
def test_diameter_taken_for_a_radius(inside):
    make = square_inside if inside else square_outside
    thread, side = ((5000, 5000), Side.DIE) if inside else ((5000, -1000), Side.PART)
    plan = one_scene(
        (Cut(square(10000), make(10000, 2 * OFFSET), thread),), (square(10000),), (0,), side, OFFSET
    )
    errors = refuse(lower(plan), plan)
    assert "the outline of cut 1 is not cut" in errors["missing-piece"]
    assert "stays 0.100 mm off" in errors["missing-piece"]


def test_offset_too_small_gouges():
    plan = one_scene(
        (Cut(square(10000), square_outside(10000, 50.0), (5000, -1000)),),
        (square(10000),),
        (0,),
        Side.PART,
        OFFSET,
    )
    errors = refuse(lower(plan), plan)
    assert "enters the kept material by 0.051" in errors["gouge"]


def test_hole_of_the_plan_not_cut():
    plan = part_with_hole()
    only = replace(plan, cuts=plan.cuts[1:])
    errors = refuse(lower(only), only)
    assert "an outline is not cut, first at" in errors["missing-piece"]


def test_hole_not_in_the_program():
    plan = part_with_hole()
    only = replace(plan, cuts=plan.cuts[1:])
    errors = refuse(lower(only), plan)
    assert errors["missing-cut"].startswith("cut 1 (threaded at")
    only = replace(plan, cuts=plan.cuts[:1])
    errors = refuse(lower(only), plan)
    assert errors["missing-cut"].startswith("cut 2 (threaded at")


def test_a_side_of_the_outline_left_out_of_the_plan():
    """A wire path that cuts off the corner: it keeps its distance, but leaves material."""
    plan = square_plan()
    v = plan.cuts[0].path.vertices.copy()
    v["x"][1:5] += 500.0
    v["cx"][1] += 500.0
    v["cx"][3] += 500.0
    wide = replace(plan, cuts=(replace(plan.cuts[0], path=type(plan.cuts[0].path)(v, True)),))
    errors = refuse(lower(wide), wide)
    assert "% of its segments" in errors["missing-piece"]
    verdict, findings = judge(lower(wide), wide, stepping=of_table(LineTable.ROTATE), terms=TRIMMED)
    assert verdict.ok
    assert {f.code for f in findings} == {"missing-piece"}


def test_contour_cut_twice():
    plan = part_with_hole()
    program = lower(plan)
    blocks = program.blocks
    # The hole's three blocks again, as a cut of its own from the same thread point.
    again = np.concatenate([blocks[:3], control(Kind.PAUSE), blocks])
    errors = refuse(replace(program, blocks=again), plan)
    assert errors["extra-cut"].startswith("blocks 5 to 7 ")
    # And in one run: the circle doubled.
    errors = refuse(edited(program, lambda b: np.insert(b, 1, b[1])), plan)
    assert errors["wrong-order"].startswith("block 3 ")


def test_something_cut_after_the_part():
    plan = square_plan()
    program = lower(plan)
    more = np.concatenate([program.blocks, line(500, 0), line(-500, 0), control(Kind.END)])
    errors = refuse(replace(program, blocks=more), plan)
    assert errors["extra-cut"].startswith("blocks 13 to 14 ")


def test_a_move_behind_the_last_cut():
    plan = square_plan()
    program = lower(plan)
    more = np.concatenate(
        [program.blocks[:-1], control(Kind.PAUSE), move(0, -500), control(Kind.END)]
    )
    errors = refuse(replace(program, blocks=more), plan)
    assert "does not end where the plan ends" in errors["thread-point"]
    verdict, findings = judge(
        replace(program, blocks=more),
        plan,
        stepping=of_table(LineTable.ROTATE),
        terms=FOREIGN,
    )
    assert verdict.ok, findings


def test_lead_across_another_cut():
    """On the line nothing is kept, but a lead may not meet another cut."""
    two = circle(0, 0, 1000), circle(5000, 0, 1000)
    cuts = (Cut(two[0], two[0], (2000, 0)), Cut(two[1], two[1], (-3000, 0), number=2))
    plan = one_scene(cuts, two, (0, 0), Side.ON, 0.0)
    errors = refuse(lower(plan), plan)
    assert errors["lead-hits"].startswith("a lead of cut 2 meets cut 1 at (-1.000, 0.000)")
    verdict, _ = judge(lower(plan), plan, stepping=of_table(LineTable.ROTATE), terms=FOREIGN)
    assert not verdict.ok


def test_cuts_in_another_order():
    plan = part_with_hole()
    other = replace(plan, cuts=plan.cuts[::-1])
    assert refuse(lower(other), plan).keys() & {"thread-point", "missing-cut", "extra-cut"}


def test_lead_through_the_part():
    plan = square_plan()
    far = replace(plan, cuts=(replace(plan.cuts[0], thread=(5000, 11000)),))
    errors = refuse(lower(far), far)
    assert "gouge" in errors
    inside = replace(plan, cuts=(replace(plan.cuts[0], thread=(5000, 5000)),))
    assert "gouge" in refuse(lower(inside), inside)


def test_thread_point_wrong():
    plan = square_plan()
    program = lower(plan)
    moved = replace(program, origin=(program.origin[0] + 1, program.origin[1]))
    assert refuse(moved, plan)["thread-point"].startswith("block 1 ")
    hole = part_with_hole()
    program = lower(hole)
    row = int(np.flatnonzero(program.blocks["kind"] == Kind.MOVE)[0])
    errors = refuse(change(program, row, count=program.blocks["count"][row] + 1), hole)
    assert errors["thread-point"].startswith(f"block {row + 3} ")


def test_path_beside_the_grid_of_the_plan():
    """A program shifted by 3 um everywhere, thread point included: path and gouge."""
    plan = square_plan()
    near = replace(
        plan,
        cuts=(replace(plan.cuts[0], thread=(5000, -997), path=square_outside(10000, OFFSET)),),
    )
    v = near.cuts[0].path.vertices.copy()
    v["y"] += 3
    v["cy"] += 3
    shifted = replace(near, cuts=(replace(near.cuts[0], path=type(near.cuts[0].path)(v, True)),))
    errors = refuse(lower(shifted), near)
    assert "by 0.00300 mm" in errors["path-deviation"]
    assert "gouge" in errors
    # Judged by the shifted plan, the path is as planned, and the outline alone refuses it.
    errors = refuse(lower(shifted), shifted)
    assert "path-deviation" not in errors
    assert "gouge" in errors


# --- pauses, overcut -----------------------------------------------------------------------------


def stopping(plan, stop):
    return replace(plan, cuts=tuple(replace(c, stop_um=stop) for c in plan.cuts))


def paused(program, row, at):
    """Part the line ``row`` after ``at`` um with a pause between."""
    b = program.blocks[row]
    sx, sy = np.sign(int(b["x"])), np.sign(int(b["y"]))
    rest = int(b["count"]) - at
    parts = [line(sx * at, sy * at), control(Kind.PAUSE), line(sx * rest, sy * rest)]
    return replace(
        program,
        blocks=np.concatenate([program.blocks[:row], *parts, program.blocks[row + 1 :]]),
    )


def test_stop_is_asked_for_and_at_its_place():
    plan = stopping(square_plan(), 2000.0)
    program = lower(plan)
    last = len(program.blocks) - 3  # half of the lower side, 5 mm long, then out, then DD
    assert program.blocks["count"][last] == 5000
    good = paused(program, last, 3000)
    verdict, findings = judge(good, plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok, findings
    assert verdict.closure_um == 0
    assert "has 0 pauses" in refuse(program, plan)["stop-point"]
    assert refuse(good, square_plan())["stop-point"].startswith(f"block {last + 1} ")
    assert "stop-point" in refuse(paused(program, last, 2900), plan)


def test_overcut_and_back_in_its_kerf():
    base = square_plan()
    plan = replace(base, cuts=(replace(base.cuts[0], overcut_um=1000.0),))
    program = lower(base)
    body = program.blocks[:-2]
    out = np.concatenate([body, line(1000, 0), line(-1000, -900), control(Kind.STOP)])
    back = np.concatenate([body, line(1000, 0), line(-1000, 0), line(0, -900), control(Kind.STOP)])
    verdict, findings = judge(
        replace(program, blocks=back), plan, stepping=of_table(LineTable.ROTATE)
    )
    assert verdict.ok, findings
    assert verdict.closure_um == 0
    assert refuse(program, plan)
    assert refuse(replace(program, blocks=back), base)
    # Straight out is not the plan's lead, though a program from elsewhere may have it.
    straight = replace(program, blocks=out)
    assert refuse(straight, plan)
    verdict, findings = judge(straight, plan, stepping=of_table(LineTable.ROTATE), terms=FOREIGN)
    assert verdict.ok, findings


# --- nothing changed -----------------------------------------------------------------------------


def test_programs_of_the_same_steps():
    plan = part_with_hole()
    program = lower(plan)
    circle_row = 1
    b = program.blocks[circle_row]
    quarter = int(b["x"])
    assert same_steps(program, program)
    assert same_steps(program, replace(program, origin=(1, 2)))
    # A full circle in one block or two halves, where the first half lands on the axis.
    halves = np.concatenate(
        [
            arc_to((quarter, 0), (-quarter, 0), (0, 0), 1),
            arc_to((-quarter, 0), (quarter, 0), (0, 0), 1),
        ]
    )
    split = edited(program, lambda x: np.concatenate([x[:1], halves, x[2:]]))
    assert same_steps(program, split)
    verdict, _ = judge(split, plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok
    assert not same_steps(program, change(program, 1, turn=-1))
    assert not same_steps(program, change(program, 1, count=b["count"] + 1))
    # A line's ratio doubled: the same steps, so the same verdict.
    ratio = change(program, 0, x=2 * program.blocks["x"][0])
    assert same_steps(program, ratio)
    # A pause more, a move for a cut: other machines' doings.
    assert not same_steps(program, edited(program, lambda x: np.insert(x, 3, x[3])))
    assert not same_steps(program, change(program, 0, kind=Kind.MOVE))


def test_arcs_may_be_split_anywhere_and_lines_too():
    plan = part_with_hole()
    program = lower(plan)
    rows = [r for r in range(len(program.blocks)) if program.blocks["kind"][r] == Kind.LINE]
    for row in rows:
        n = int(program.blocks["count"][row])
        b = program.blocks[row]
        sx, sy = int(np.sign(b["x"])), int(np.sign(b["y"]))
        parts = np.concatenate([line(sx * k, sy * k) for k in (1, n // 2, n - n // 2 - 1) if k])
        split = edited(program, lambda x, r=row, p=parts: np.concatenate([x[:r], p, x[r + 1 :]]))
        assert same_steps(program, split)
        verdict, findings = judge(split, plan, stepping=of_table(LineTable.ROTATE))
        assert verdict.ok, findings


def test_collinear_segments_may_run_as_one_block():
    """A wire path with a vertex in the middle of each side, and arcs in halves."""
    plan = square_plan()
    v = plan.cuts[0].path.vertices
    more = np.insert(v, [3, 5], v[[2, 4]])
    more[3]["y"], more[6]["x"] = 4321.0, 2222.0
    c = np.sqrt(0.5) * OFFSET
    half = np.insert(more, 2, more[1])
    half[2]["x"], half[2]["y"] = 10000 + c, -c
    fine = replace(plan, cuts=(replace(plan.cuts[0], path=type(plan.cuts[0].path)(half, True)),))
    verdict, findings = judge(lower(plan), fine, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok, findings
    assert verdict.max_deviation_um <= 1.0 + 1e-9


def test_nothing_in_the_program():
    plan = square_plan()
    empty = Program(control(Kind.END), plan.cuts[0].thread)
    assert refuse(empty, plan).keys() == {"missing-cut"}
    only_move = Program(move(100, 0), plan.cuts[0].thread)
    assert refuse(only_move, plan).keys() == {"missing-cut"}


def test_open_contour_on_the_line():
    from wedmcam.ir.contour import Contour, vertices

    path = Contour(
        vertices([(0, 0, 0, 0, 0, -1), (5000, 0, 5000, 1000, 1, -1), (6000, 1000, 0, 0, 0, -1)]),
        False,
    )
    plan = one_scene((Cut(path, path, (0, 0)),), (path,), (0,), Side.ON, 0.0)
    program = lower(plan)
    verdict, findings = judge(program, plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok, findings
    assert (verdict.closure_um, verdict.gouge_um, verdict.uncut_um) == (None, None, None)
    short = edited(program, lambda b: np.delete(b, 1))
    assert refuse(short, plan)["missing-piece"].startswith("block 1 ")


def test_hundred_holes():
    cuts, outlines = [], []
    for k in range(100):
        x, y = 3000 * (k % 10), 3000 * (k // 10)
        outlines.append(circle(x, y, 1000))
        cuts.append(Cut(outlines[-1], circle(x, y, 900), (x, y), number=k + 1))
    plan = one_scene(tuple(cuts), tuple(outlines), (0,) * 100, Side.DIE, OFFSET)
    program = lower(plan)
    verdict, findings = judge(program, plan, stepping=of_table(LineTable.ROTATE))
    assert verdict.ok, findings
    assert verdict.contours == 100
    row = int(np.flatnonzero(program.blocks["kind"] == Kind.ARC)[57])
    errors = refuse(change(program, row, turn=-1), plan)
    assert errors["wrong-order"].startswith(f"block {row + 1} ")
    assert "cut 58" in errors["wrong-order"]

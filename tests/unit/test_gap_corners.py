"""The ZD-065's gap compensation: transition arcs, its accuracy, punch and die of one outline."""

import itertools

import numpy as np
import pytest

from outlines import arc, contour, figure, line, random_contour
from wedmcam import machines
from wedmcam.backends.zd065.compensation import _memory_of
from wedmcam.controllers.zd065.compensation import HARMLESS, compensate, wire_path
from wedmcam.diag import Severity
from wedmcam.frontends.zd065.compensation import decode
from wedmcam.ir.program import Kind
from written import ends_of, off_clearance, path_of

M = machines.builtin("zd065-compensation")
SQUARE = figure(
    line(0, -2000),
    line(3000, 0),
    line(0, 6000),
    line(-6000, 0),
    line(0, -6000),
    line(3000, 0),
    line(0, 2000),
)


def data_of(outline):
    return _memory_of(outline).data.tobytes() + b"\0"


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


def refused(problems):
    return [p.what for p in problems if p.what not in HARMLESS]


@pytest.mark.parametrize(
    ("gap", "outwards", "corner", "radius"),
    [(100, True, None, 200), (100, True, 150, 250), (100, False, 150, 50), (100, False, None, 0)],
)
def test_a_square_is_rounded_alike_in_punch_and_die(gap, outwards, corner, radius):
    made, problems = compensate(SQUARE, gap, outwards, corner)
    # Lines alone: taken for an outer contour; its lead comes from inside.
    assert [p.what for p in problems] == ["nesting", *["lead", "lead"] * outwards]
    blocks = made.blocks
    side = 3000 + (gap if outwards else -gap)
    ends = ends_of(blocks)
    assert ends[-1].tolist() == [0, 0]
    assert ends[0].tolist() == [0, -2000 + 3000 - side]
    assert ends[:-1, 0].max() == side
    arcs = blocks[blocks["kind"] == Kind.ARC]
    assert np.hypot(arcs["x"], arcs["y"]).tolist() == [radius] * (4 if radius else 0)
    assert made.miss.max() == 0


def test_an_arc_of_less_than_2_um_is_a_turn_on_the_spot():
    made, _ = compensate(SQUARE, 100, False, 101)
    assert not (made.blocks["kind"] == Kind.ARC).any()
    assert len(made.blocks) == 7 + 4


def test_a_start_in_a_corner_is_behind_its_arc():
    outline = figure(line(4000, 0), line(0, 4000), line(-4000, 0), line(0, -4000))
    made, _ = compensate(outline, 100)
    assert made.blocks["kind"].tolist() == [Kind.LINE, Kind.ARC] * 4
    assert made.blocks["x"].tolist()[:2] == [3800, 0]
    assert ends_of(made.blocks)[-1].tolist() == [0, 0]


def test_a_radius_of_10_m_and_the_largest_gap():
    end = 600_000
    sagitta = [(j, arc((0, 0), (end, 0), (end // 2, j), -1, -1)) for j in range(-9995520, -9995420)]
    _, bow = next((j, row) for j, row in sagitta if row is not None)
    outline = figure(bow, line(0, -300_000), line(-end, 0), line(0, 300_000))
    outline["grows"][0] = 1
    made, problems = compensate(outline, 7999, outwards=True)
    assert not refused(problems)
    assert made.miss.max() <= 1.0
    assert 9_990_000 < made.path["radius"].max() < 10_010_000


def pair(outline, gap, z, corner):
    punch, a = compensate(outline, gap, True, corner)
    die, b = compensate(outline, gap - z, False, corner)
    return None if refused(a + b) else (punch, die)


def off(outline, punch, die, intended):
    """Return how far the clearance is from the intended one: the contours without their leads."""
    n = len(outline)
    one, other = (path_of(m.blocks, (m.stated >= 1) & (m.stated <= n - 2)) for m in (punch, die))
    return off_clearance(one, other, intended)


@pytest.mark.parametrize("beta", [20, 35, 60, 90, 145, 200, 270, 300, 340])
@pytest.mark.parametrize("curved", [0.0, 0.15, -0.15])
def test_punch_and_die_of_one_outline_have_their_clearance(beta, curved):
    """One r, gaps f and f - z: paths lie 2 f - z apart, within 1.6 um, at all corners."""
    f, side = 150, np.radians(beta)
    legs = 6000
    tip = (round(legs * np.cos(side)), round(legs * np.sin(side)))
    # A corner of interior angle beta in (0, 0); the contour is closed on the far side.
    if beta < 180:
        points = [(legs // 2, 0), (legs, 0), tip, (0, 0)]
        bulges = [0.0, 0.0, curved, 0.0]
    else:
        far = [(legs, 0), (legs, legs + 3000), (-legs - 3000, legs + 3000)]
        far += [(-legs - 3000, -legs - 3000), (legs // 2, -legs - 3000)]
        points = [(legs // 2, 0), (legs, 0), *far[1:4]]
        if tip[1] < -3000:
            points += [(tip[0], -legs - 3000)]
        points += [tip, (0, 0)]
        bulges = [0.0] * (len(points) - 2) + [curved, 0.0]
    outline = contour(points, bulges, (legs // 2, -1000))
    for z in (0, 5, 20):
        both = pair(outline, f, z, f)
        assert both is not None
        assert off(outline, *both, 2 * f - z) <= 1.6


def test_punch_and_die_of_random_outlines():
    rng = np.random.default_rng(11)
    done = 0
    for z in itertools.islice(itertools.cycle((0, 5, 20)), 24):
        outline = random_contour(rng, 10 ** rng.uniform(3.7, 4.2), arcs=0.8, apart=True)
        both = pair(outline, 120, z, 120)
        if both is None:
            continue
        done += 1
        assert off(outline, *both, 240 - z) <= 1.6
    assert done >= 15


def test_corners_without_room_are_refused_with_the_largest_radius():
    _, problems = wire_path(SQUARE, 100, True, 3100)
    assert {p.what for p in problems if p.what not in HARMLESS} == {"leg"}
    assert {p.values["largest_um"] for p in problems if p.what == "leg"} == {3000.0}
    for largest, ok in ((3000, True), (3001, False)):
        assert (not refused(wire_path(SQUARE, 100, True, largest)[1])) is ok
    _, found = decode(data_of(SQUARE), M, "a.zdc", 100, True, 3100)
    assert set(errors(found)) == {"corner-too-large"}
    first = next(d for d in found if d.severity is Severity.ERROR)
    assert "3.000 mm" in first.hint
    assert "(0.000, -2.000) mm" in first.message


def test_a_line_and_an_arc_that_no_circle_touches():
    """Inside an arc of R the arc between line and arc has at most R (1 + cos turn) / 2."""
    bow = arc((2000, 0), (-2000, 0), (0, 0), 1, 1)
    outline = figure(line(2000, 0), bow, line(2000, 0))
    assert not refused(wire_path(outline, 100, True, 900)[1])
    _, problems = wire_path(outline, 100, True, 1100)
    assert set(refused(problems)) == {"touch"}
    assert {p.values["largest_um"] for p in problems if p.what == "touch"} == {999.0}


def test_arcs_that_do_not_meet():
    lens = figure(
        arc((0, 0), (8000, 0), (4000, 12_000), 1, 1), arc((8000, 0), (0, 0), (4000, -12_000), 1, 1)
    )
    made, problems = compensate(lens, 100)
    assert not refused(problems)
    assert made.blocks["kind"].tolist() == [Kind.ARC] * 2
    ends = ends_of(made.blocks)
    assert ends[-1].tolist() == [0, 0]
    assert ends[0, 1] == 0
    half = np.sqrt((np.hypot(4000, 12_000) + 100) ** 2 - 12_000**2)
    assert abs(ends[0, 0] - 2 * half) <= 1
    _, problems = compensate(lens, 4000)
    assert not refused(problems)
    _, problems = compensate(lens, 4000, outwards=False)
    assert set(refused(problems)) <= {"meet", "vanishes"}
    assert refused(problems)


@pytest.mark.parametrize(
    ("outline", "gap", "corner", "what"),
    [
        (SQUARE, 100, 99, {"below"}),
        (figure(line(3000, 0), line(0, 3000)), 100, None, {"unknown"}),
        (
            figure(
                line(1000, 0),
                arc((0, 0), (500, 500), (0, 500), 1, 1),
                line(0, 1000),
                arc((0, 0), (-500, 500), (-500, 0), 1, -1),
            ),
            100,
            None,
            {"sides"},
        ),
    ],
)
def test_outlines_that_are_refused(outline, gap, corner, what):
    _, problems = compensate(outline, gap, True, corner)
    assert set(refused(problems)) == what


def test_a_hole_of_lines_in_a_contour_of_lines_is_on_the_other_side():
    hole = figure(line(0, -500), line(500, 0), line(0, 1000), line(-1000, 0), line(0, -1000),
                  line(500, 0), line(0, 500))  # fmt: skip
    move = np.zeros(1, hole.dtype)
    move["kind"], move["y"] = Kind.MOVE, 3000
    # The outer contour starts from a thread point outside it; the hole lies in its middle.
    outer = figure(line(0, 1000), *SQUARE[1:-1].tolist(), line(0, -1000))
    both = np.concatenate([outer, move, hole])
    move_to_middle = both["kind"] == Kind.MOVE
    both["y"][move_to_middle] = 4000
    made, problems = compensate(both, 100)
    assert not refused(problems)
    assert [p.values["hole"] for p in problems if p.what == "nesting"] == [False, True]
    ends = ends_of(made.blocks)
    assert np.abs(ends[:, 0]).max() == 3100
    inner = ends[made.stated > 7]
    assert np.abs(inner[:, 0]).max() == 400  # into the hole
    assert np.abs(ends_of(compensate(both, 100, False)[0].blocks)[:, 0]).max() == 2900


def test_a_pause_in_a_contour_parts_nothing():
    pause = np.zeros(1, SQUARE.dtype)
    pause["kind"] = Kind.PAUSE
    with_pause = np.concatenate([SQUARE[:3], pause, SQUARE[3:]])
    made, _ = compensate(with_pause, 100)
    plain, _ = compensate(SQUARE, 100)
    kept = made.blocks[made.blocks["kind"] != Kind.PAUSE]
    assert kept["x"].tolist() == plain.blocks["x"].tolist()
    assert len(made.blocks) == len(plain.blocks) + 1


def test_spans_are_those_of_the_stated_blocks():
    data = data_of(SQUARE)
    program, found = decode(data, M, "a.zdc", 100)
    assert {d.code for d in found} == {"compensation-lead", "outline-side"}
    assert len(program.spans) == len(program.blocks) == 7 + 4 + 1
    assert (program.spans[1].start, program.spans[2].start) == (7, 7)
    assert program.blocks["kind"][-1] == Kind.STOP


def test_a_full_circle_grows_and_shrinks():
    circle = figure(line(5000, 0), arc((5000, 0), (5000, 0), (0, 0), 1, 1), line(-5000, 0))
    for outwards, radius in ((True, 5100), (False, 4900)):
        made, problems = compensate(circle, 100, outwards)
        assert [p.what for p in problems] == ["lead", "lead"] * outwards
        assert made.blocks["x"].tolist() == [radius, radius, -radius]
        assert ends_of(made.blocks).tolist() == [[radius, 0], [radius, 0], [0, 0]]

"""The model of a controller that offsets outlines: answers that were worked out by hand."""

from itertools import pairwise
from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest
from mpmath import mp, mpf
from mpmath import sqrt as exact_sqrt

from wedmcam.controllers.offsetting import BlockLimits
from wedmcam.controllers.offsetting.clearance import (
    _near_boxes,
    columns,
    comes_near,
    gaps,
    runs_back,
)
from wedmcam.controllers.offsetting.microns import NoSteps, line_blocks, on_grid, stepped
from wedmcam.controllers.offsetting.path import Lost, path_beside
from wedmcam.controllers.offsetting.segment import arc, crossings, line
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

LIMITS = BlockLimits(builtin("iso-um").own_stepping, 999_999, 999_999, 999_999)


def lines(*places):
    return [line(a, b) for a, b in pairwise(places)]


def path(outline, shift, shifts=None):
    """Return the path as (start, end, turn, centre) of each element, and whether it closes."""
    result = path_beside(outline, shifts or [shift] * len(outline), shift)
    assert not isinstance(result, Lost), result
    elements, closed = result
    for a, b in pairwise(elements):
        assert a.segment.end == b.segment.start
    return elements, closed


def corners(outline, shift):
    elements, _ = path(outline, shift)
    return [pytest.approx(e.segment.start) for e in elements] + [
        pytest.approx(elements[-1].segment.end)
    ]


#: 20 by 20 mm about the origin, counter-clockwise from the middle of its right side, um.
SQUARE = lines((10e3, 0.0), (10e3, 10e3), (-10e3, 10e3), (-10e3, -10e3), (10e3, -10e3), (10e3, 0.0))


def test_inside_a_square_is_a_smaller_square():
    elements, closed = path(SQUARE, 100.0)
    assert closed
    assert [e.segment.start for e in elements] == [
        (9900.0, 0.0), (9900.0, 9900.0), (-9900.0, 9900.0), (-9900.0, -9900.0), (9900.0, -9900.0)
    ]  # fmt: skip
    assert not any(e.corner for e in elements)


def test_outside_a_square_arcs_about_its_corners_join_the_sides():
    elements, closed = path(SQUARE, -100.0)
    assert closed
    assert [e.corner for e in elements] == [False, True] * 4 + [False]
    first = elements[1].segment
    assert first.start == (10100.0, 10000.0)
    assert first.end == pytest.approx((10000.0, 10100.0))
    assert (first.cx, first.cy, first.turn, first.radius) == (10000.0, 10000.0, 1, 100.0)
    assert first.sweep == pytest.approx(pi / 2)


@pytest.mark.parametrize(
    ("turn", "shift", "radius"), [(1, 100, 4900), (1, -100, 5100), (-1, 100, 5100)]
)
def test_a_circle_keeps_its_centre(turn, shift, radius):
    elements, closed = path([arc((5e3, 0.0), (5e3, 0.0), (0.0, 0.0), turn)], shift)
    assert closed
    (one,) = elements
    assert (one.segment.radius, one.segment.x0) == (radius, radius)
    assert one.segment.sweep == 2 * pi


def test_tangent_blocks_meet_on_their_normal():
    # A line, a quarter of a circle, a line: no corner anywhere.
    outline = [
        line((0.0, 0.0), (3000.0, 0.0)),
        arc((3000.0, 0.0), (4000.0, 1000.0), (3000.0, 1000.0), 1),
        line((4000.0, 1000.0), (4000.0, 5000.0)),
    ]
    assert corners(outline, 300.0) == [(0, 300), (3000, 300), (3700, 1000), (3700, 5000)]
    assert corners(outline, -300.0) == [(0, -300), (3000, -300), (4300, 1000), (4300, 5000)]


@pytest.mark.parametrize("degrees", [10.0, 45.0, 90.0, 135.0, 170.0])
def test_corners_of_lines(degrees):
    """Inside: offset * tan(half the turn) before the corner. Outside: an arc of the whole turn."""
    a = np.radians(degrees)
    outline = lines((-9e4, 0.0), (0.0, 0.0), (9e4 * cos(a), 9e4 * sin(a)))
    inner = corners(outline, 200.0)
    assert inner[1] == (-200 * np.tan(a / 2), 200.0)
    elements, _ = path(outline, -200.0)
    assert elements[1].segment.sweep == pytest.approx(a)
    assert elements[1].segment.end == pytest.approx((200 * sin(a), -200 * cos(a)))


def test_straight_back_it_goes_round_the_end():
    elements, _ = path(lines((0.0, 0.0), (900.0, 0.0), (0.0, 0.0)), 100.0)
    assert elements[1].segment.start == (900.0, 100.0)
    assert elements[1].segment.end == pytest.approx((900.0, -100.0))
    assert elements[1].segment.sweep == pytest.approx(pi)


def test_an_inner_corner_of_a_line_and_an_arc():
    # To the left, then on a circle about (0, 3000) that turns left there, away from its top.
    x, y = 3000 * sin(0.7), 3000 - 3000 * cos(0.7)
    outline = [
        line((x + 5000.0, y), (x, y)),
        arc((x, y), (-3000.0, 3000.0), (0.0, 3000.0), -1),
    ]
    elements, _ = path(outline, 150.0)
    # Where y - 150 meets a circle of 3150 about (0, 3000).
    wanted = sqrt(3150**2 - (3000 - y + 150) ** 2)
    assert elements[0].segment.end == pytest.approx((wanted, y - 150))


def test_crossings_are_as_exact_as_is_said():
    """Against 40 digits: joints of inner corners lie the offset away from both, to 1e-6 um."""
    mp.dps = 40
    rng = np.random.default_rng(7)
    checked = 0
    for _ in range(400):
        a, b, c = (tuple(float(v) for v in rng.integers(-400_000, 400_000, 2)) for _ in range(3))
        outline = lines(a, b, c)
        if rng.random() < 0.6:
            # An arc to c: its centre on the bisector of the chord, by so many chords.
            h = float(rng.uniform(-1.5, 1.5))
            centre = (
                0.5 * (b[0] + c[0]) - h * (c[1] - b[1]), 0.5 * (b[1] + c[1]) + h * (c[0] - b[0]),
            )  # fmt: skip
            outline[1] = arc(b, c, centre, int(rng.choice([1, -1])))
        shift = float(rng.choice([-150.0, 150.0]))
        result = path_beside(outline, [shift, shift], shift)
        if isinstance(result, Lost) or len(result[0]) != 2:
            continue
        x, y = (mpf(v) for v in result[0][0].segment.end)
        for s in outline:
            if s.turn:
                off = abs(exact_sqrt((x - s.cx) ** 2 + (y - s.cy) ** 2) - exact_sqrt(
                    (mpf(s.x0) - s.cx) ** 2 + (mpf(s.y0) - s.cy) ** 2))  # fmt: skip
            else:
                dx, dy = mpf(s.x1) - s.x0, mpf(s.y1) - s.y0
                off = abs((y - s.y0) * dx - (x - s.x0) * dy) / exact_sqrt(dx * dx + dy * dy)
            assert abs(off - 150) < 1e-6
        checked += 1
    assert checked > 60


def test_an_overlap_is_the_first_part_again():
    over = [*SQUARE[:4], line((10e3, -10e3), (10e3, 500.0))]
    elements, closed = path(over, 140.0)
    assert not closed
    assert elements[0].segment.start == (9860.0, 0.0)
    assert elements[-1].segment.end == pytest.approx((9860.0, 500.0))
    assert comes_near(elements, over, [140.0] * 5, 140.0) is None
    assert runs_back(over) is None


def test_a_block_from_one_offset_to_another_is_askew():
    outline = lines((0.0, 0.0), (9000.0, 0.0), (9000.0, 9000.0), (0.0, 9000.0))
    elements, _ = path(outline, 100.0, [100.0, 50.0, 50.0])
    assert [e.segment.start for e in elements] == [(0.0, 100.0), (8900.0, 100.0), (8950.0, 8950.0)]


@pytest.mark.parametrize(
    ("outline", "kind", "block"),
    [
        # An inside radius of 50 um.
        ([line((0, 0), (0, 500)), arc((0, 500), (-50, 550), (-50, 500), 1)], "radius", 1),
        # A step lower than the offset in an inner corner; a slot narrower than two offsets.
        (lines((0, 0), (0, 500), (-50, 500), (-50, 550), (-100, 550), (-100, 999)), "nothing", 1),
        (lines((0, 0), (0, 500), (-150, 500), (-150, 0)), "nothing", 1),
    ],
)
def test_what_one_block_of_look_ahead_loses(outline, kind, block):
    lost = path_beside(outline, [100.0] * len(outline), 100.0)
    assert isinstance(lost, Lost)
    assert (lost.kind, lost.block) == (kind, block)


def test_an_inside_radius_of_the_offset_is_a_point():
    outline = [
        line((0.0, 0.0), (3000.0, 0.0)),
        arc((3000.0, 0.0), (3100.0, 100.0), (3000.0, 100.0), 1),
        line((3100.0, 100.0), (3100.0, 5000.0)),
    ]
    assert corners(outline, 100.0) == [(0, 100), (3000, 100), (3000, 5000)]


def test_back_on_itself():
    back = lines((0.0, 0.0), (9e3, 0.0), (9e3, 5e3), (8e3, 5e3), (8e3, 0.0), (1e3, 0.0))
    lost = runs_back(back)
    assert lost is not None
    assert (lost.kind, lost.block, lost.other) == ("back", 4, 0)


@pytest.mark.parametrize(("width", "is_lost"), [(201.0, False), (199.0, False), (196.0, True)])
def test_nearer_than_the_offset_to_a_block_farther_on(width, is_lost):
    """A mouth: neighbours leave room, its two sides do not. 1.5 um less than the offset passes."""
    h = width / 2
    bulb = lines(
        (0.0, -9e3), (0.0, -h), (2e3, -h), (2e3, -3e3), (9e3, -3e3), (9e3, 3e3), (2e3, 3e3),
        (2e3, h), (0.0, h), (0.0, 9e3),
    )  # fmt: skip
    elements, _ = path(bulb, 100.0)
    lost = comes_near(elements, bulb, [100.0] * len(bulb), 100.0)
    assert (lost is not None) == is_lost
    if lost is not None:
        # The lower side, or one of its ends.
        assert (lost.block, lost.other in (0, 1, 2)) == (7, True)
        assert lost.gap_um == pytest.approx(width - 100)


def test_crossings_of_all_kinds():
    a, b = line((0.0, 0.0), (10.0, 0.0)), line((5.0, -5.0), (5.0, 5.0))
    ((place, on_a, on_b),) = crossings(a, b)
    assert (place, on_a, on_b) == ((5.0, 0.0), 5.0, 5.0)
    half = arc((5.0, 0.0), (-5.0, 0.0), (0.0, 0.0), 1)
    assert [c[0] for c in crossings(line((3.0, 0.0), (3.0, 9.0)), half)] == [(3.0, 4.0)]
    assert [c[0] for c in crossings(half, line((3.0, 9.0), (3.0, -9.0)))] == [(3.0, 4.0)]
    other = arc((11.0, 0.0), (1.0, 0.0), (6.0, 0.0), 1)
    assert [c[0] for c in crossings(half, other)] == [pytest.approx((3.0, 4.0))]
    assert crossings(a, line((0.0, 1.0), (10.0, 1.0))) == []
    assert crossings(half, arc((6.0, 0.0), (-6.0, 0.0), (0.0, 0.0), 1)) == []
    # Tangent from outside and from inside.
    assert len(crossings(half, arc((1.0, 6.0), (1.0, 6.0), (0.0, 6.0), 1))) == 1
    assert len(crossings(half, arc((1.0, 4.0), (1.0, 4.0), (0.0, 4.0), 1))) == 1


def test_gaps_are_those_of_many_places():
    """Against 2,000 places of each: lines and arcs that cross, and that do not."""
    rng = np.random.default_rng(11)
    pairs = []
    for _ in range(300):
        one = []
        for _ in range(2):
            a, b, c = (tuple(rng.uniform(-100, 100, 2)) for _ in range(3))
            if rng.random() < 0.5:
                one.append(line(a, b))
            else:
                r, t = hypot(a[0] - c[0], a[1] - c[1]), rng.uniform(0.2, 6.2)
                end = c[0] + r * cos(t), c[1] + r * sin(t)
                one.append(arc(a, end, c, int(rng.choice([1, -1]))))
        pairs.append(one)
    a, b = (columns([p[k] for p in pairs]) for k in (0, 1))
    gap, x, y = gaps(a, b)
    for k, (one, other) in enumerate(pairs):
        p, q = (
            np.array([s.point(t) for t in np.linspace(0, s.length, 2000)]) for s in (one, other)
        )
        near = np.hypot(p[:, None, 0] - q[None, ::7, 0], p[:, None, 1] - q[None, ::7, 1]).min()
        step = one.length / 2000 + other.length / 280
        assert gap[k] <= near + 1e-9
        assert near <= gap[k] + step
        places = columns([one]), columns([other])
        for s in places:
            assert s.distance(np.array([x[k]]), np.array([y[k]]))[0] <= gap[k] / 2 + 1e-5


def test_boxes_that_are_near_are_all_found():
    rng = np.random.default_rng(3)
    for within in (0.0, 40.0):
        boxes = []
        for n in (300, 400):
            corner = rng.uniform(-5000, 5000, (2, n))
            size = 10 ** rng.uniform(-2, 3.5, (2, n)) * rng.integers(0, 2, (2, n))
            boxes.append((*corner, *(corner + size)))
        a, b = boxes
        found = {
            (i, j)
            for part in _near_boxes(a, b, within)
            for i, j in zip(*(v.tolist() for v in part), strict=True)
        }
        near = (a[0][:, None] - within <= b[2]) & (b[0] <= a[2][:, None] + within)
        near &= (a[1][:, None] - within <= b[3]) & (b[1] <= a[3][:, None] + within)
        assert found == {(i, j) for i, j in np.argwhere(near).tolist()}


def test_the_grid():
    assert on_grid([0.5, -0.5, 1.4999999999, -2.6]).tolist() == [1, -1, 2, -3]
    blocks = line_blocks(2_500_000, -10, LIMITS)
    assert (blocks["x"].sum(), blocks["y"].sum()) == (2_500_000, -10)
    assert len(blocks) == 3
    assert len(line_blocks(0, 0, LIMITS)) == 0


@pytest.mark.parametrize("seed", range(6))
def test_steps_end_on_every_joint_and_stay_beside_the_path(seed):
    """Stepped to the end, place by place: on each joint within 1.05 um, off the path by 1.6."""
    rng = np.random.default_rng(seed)
    turn = np.sort(rng.uniform(0, 2 * pi, 9))
    radius = rng.integers(700, 2500, 9)
    places = [
        (float(round(r * cos(t))), float(round(r * sin(t))))
        for r, t in zip(radius, turn, strict=True)
    ]
    outline = lines(*places)
    elements, closed = path(outline, -50.0 if seed % 2 else -77.3)
    thread = (int(elements[0].segment.x0) - 500, int(elements[0].segment.y0))
    result = stepped(elements, closed, thread, True, LIMITS)
    assert not isinstance(result, NoSteps)
    blocks, of = result
    x, y = LIMITS.stepping.trace(blocks)[0].T + np.array(thread)[:, None]
    end = elements[-1].segment.end
    assert (x[-1], y[-1]) == tuple(on_grid(end).tolist())
    many = columns([e.segment for e in elements])
    first = int(np.argmin(np.hypot(x - elements[0].segment.x0, y - elements[0].segment.y0)))
    n = len(elements)
    for px, py in zip(x[first:].tolist(), y[first:].tolist(), strict=True):
        assert many.distance(np.full(n, px), np.full(n, py)).min() <= 1.6
    assert set(of.tolist()) >= set(range(len(outline)))
    assert (blocks["kind"] <= Kind.ARC).all()


def test_a_line_alone_is_two_blocks():
    """A line that stands alone between two pauses would be a move."""
    elements, closed = path(lines((0.0, 0.0), (901.0, 0.0)), 100.0)
    blocks, of = stepped(elements, closed, (0, 100), False, LIMITS)
    assert blocks["x"].tolist() == [451, 450]
    assert of.tolist() == [0, 0]


def test_what_is_too_large_for_a_block_is_parted():
    small = BlockLimits(LIMITS.stepping, 2000, 2000, 2000)
    half = [line((-9e3, 5e3), (0.0, 5e3)), arc((0.0, 5e3), (0.0, -5e3), (0.0, 0.0), -1)]
    elements, closed = path(half, 100.0)
    blocks, _ = stepped(elements, closed, (-9000, 5600), False, small)
    assert max(abs(blocks["x"]).max(), abs(blocks["y"]).max()) <= 2000
    assert (blocks["kind"] == Kind.LINE).all()
    x, y = small.stepping.trace(blocks)[0].T + np.array([[-9000], [5600]])
    assert (x[-1], y[-1]) == (0, -5100)
    right = x > 0
    # Chords of 0.3 um, joints on the grid, a staircase.
    assert abs(np.hypot(x[right], y[right]) - 5100).max() <= 0.3 + 0.71 + 1.0
    assert atan2(y[-1], x[-1]) == pytest.approx(-pi / 2)

"""Thread points, leads and order (rulings 3, 5, 6)."""

import numpy as np
import pytest

import parts
import wedmcam
from wedmcam.ir.plan import Order
from wedmcam.transforms.plan.order import order


def compiled(contours, **mm):
    return wedmcam.compile(parts.dxf_bytes(contours), **{"offset": 0.1, **mm})


def threads(made):
    return [c.thread for c in made.plan.cuts]


def codes(made):
    return [d.code for d in made.findings if d.severity == 2]


def test_default_leads():
    """A hole from its centre; else beside the middle of the longest segment, lowest first."""
    square, hole = parts.rectangle(20_000, 10_000), parts.circle(5_000, 5_000, 2_000)
    made = compiled((square, hole))
    assert threads(made) == [(5_000, 5_000), (10_000, -1_100)]
    started = made.plan.cuts[1].path.vertices[0]
    assert (started["x"], started["y"]) == (10_000, -100)
    assert made.plan.cuts[0].path.vertices["x"][0] == 5_000 + 1_900


def test_a_punch_circle_starts_towards_plus_x():
    made = compiled((parts.circle(0, 0, 5_000),))
    assert threads(made) == [(6_100, 0)]


def test_lead_is_half_the_free_distance():
    left, right = parts.rectangle(5_000, 20_000), parts.rectangle(5_000, 20_000, 6_000, 0)
    made = compiled((left, right), lead=3.0)
    # Longest segments are vertical, ties: lowest, then leftmost; 1 mm between the two outlines.
    assert made.ok, codes(made)
    assert threads(made)[0][0] in (-3_100, 5_100 + 400)


def test_thread_point_serves_the_nearest_contour_of_its_scrap():
    square, hole = parts.rectangle(20_000, 10_000), parts.circle(5_000, 5_000, 2_000)
    made = compiled((square, hole), starts=[(4.5, 5.5), (-3, 2)])
    assert made.ok
    assert threads(made) == [(4_500, 5_500), (-3_000, 2_000)]
    v = made.plan.cuts[1].path.vertices[0]
    assert (v["x"], v["y"]) == (-100, 2_000)  # nearest point of the path


@pytest.mark.parametrize(
    ("start", "code"),
    [
        ((10, 5), "thread-point-unused"),  # in kept material
        ((-0.05, 5), "thread-point-unused"),  # nearer than the offset
        ((5, 3.02), "thread-point-unused"),  # in the hole, nearer than the offset
    ],
)
def test_thread_points_that_serve_none(start, code):
    contours = (parts.rectangle(20_000, 10_000), parts.circle(5_000, 5_000, 2_000))
    assert codes(compiled(contours, starts=[start])) == [code]


def test_a_second_thread_point_is_an_error():
    made = compiled((parts.rectangle(20_000, 10_000),), starts=[(-3, 2), (23, 2)])
    assert codes(made) == ["thread-point-twice"]


def test_thread_point_on_the_path_needs_no_lead():
    made = compiled((parts.rectangle(20_000, 10_000),), starts=[(-0.1, 5)])
    assert made.ok
    assert made.verdict.blocks == made.plan.cuts[0].path.vertices.shape[0]


def test_lead_through_another_contour_is_refused():
    a, b = parts.rectangle(5_000, 5_000), parts.rectangle(2_000, 20_000, 8_000, -8_000)
    # 20 mm away, b stands between: the nearest path is b's own side.
    made = compiled((a, b), starts=[(20, 2.5), (30, 2.5)])
    assert codes(made) in (["thread-point-twice"], ["lead-hits"])


def test_open_contours_start_at_the_nearer_end():
    bar = parts.contour_of_bulges(
        np.array([[0.0, 0.0], [10_000.0, 0.0], [10_000.0, 5_000.0]]), np.zeros(3), closed=False
    )
    made = compiled((bar,), side="left", starts=[(10, 8)])
    assert made.ok, codes(made)
    v = made.plan.cuts[0].path.vertices
    assert v["y"][0] == 5_000


def test_orders():
    parents = [-1, 0, 1, -1]
    at = [(0, 0), (10, 0), (20, 0), (5, 0)]
    assert order(parents, at, [3, 2, 1, 0], Order.INNER_FIRST) == [2, 1, 0, 3]
    assert order(parents, at, [3, 2, 1, 0], Order.GIVEN) == [3, 2, 1, 0]
    nearest = order(parents, at, [0, 1, 2, 3], Order.NEAREST)
    assert nearest.index(2) < nearest.index(1) < nearest.index(0)
    assert nearest[0] == 3


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("side", ["part", "die"])
def test_side_truth_table(side, reverse):
    """C-01: the wire is outside a punch and inside a die, whatever the direction."""
    made = compiled((parts.rectangle(20_000, 10_000),), side=side, reverse=reverse)
    assert made.ok
    x, y, wide, high = (
        *(made.plan.cuts[0].path.vertices[k].min() for k in "xy"),
        *(made.plan.cuts[0].path.vertices[k].max() for k in "xy"),
    )
    grow = 100 if side == "part" else -100
    assert (x, y, wide, high) == (-grow, -grow, 20_000 + grow, 10_000 + grow)
    turn = made.plan.cuts[0].path
    from wedmcam.geom.measure import area

    assert (area(turn.vertices) > 0) == (not reverse)


SQUARE = "contour sq { from (0, 0) line to (20, 0) line to (20, 20) line to (0, 20) close }\n"


@pytest.mark.parametrize(
    ("cut", "thread"),
    [
        ("inside offset 0.1 enter (20, 0)", (19_193, 807)),
        ("on enter (0, 0)", (-707, -707)),
    ],
)
@pytest.mark.parametrize("profile", ["b3-compact", "iso-g41"])
def test_a_lead_to_a_corner_halves_its_angle(cut, thread, profile):
    made = wedmcam.compile((SQUARE + "cut sq " + cut).encode(), name="sq.wed", profile=profile)
    assert made.ok, codes(made)
    assert threads(made) == [thread]


def test_a_corner_too_acute_is_refused_at_enter():
    text = "contour a { from (0, 0) line to (20, 0) line to (20, 5) close }\n"
    made = wedmcam.compile((text + "cut a inside offset 0.1 enter (0, 0)").encode(), name="a.wed")
    assert codes(made) == ["lead-along-wall"]
    (finding,) = (d for d in made.findings if d.severity == 2)
    assert (finding.span.line, finding.span.column) == (2, 31)
    assert "'enter'" in finding.hint


def test_a_lead_that_hits_names_what_was_stated():
    text = SQUARE + "cut sq outside offset 0.1 enter (20, 20) start (-5, 10)"
    made = wedmcam.compile(text.encode(), name="sq.wed")
    (finding,) = (d for d in made.findings if d.severity == 2)
    assert finding.code == "lead-hits"
    assert finding.hint == "move the thread point, or 'enter'"

"""One planner: a drawing is a part program of one cut, and a cut keeps its side and offset."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import parts
from wedmcam import api
from wedmcam.arithmetic import FLOAT64
from wedmcam.diag import TextSpan
from wedmcam.ir.part import CutItem, Shape
from wedmcam.ir.plan import Scene, Side
from wedmcam.options import Options
from wedmcam.transforms.layers import Group, rule_of
from wedmcam.transforms.nest import nest
from wedmcam.transforms.plan.drawing import cuts_of_drawing
from wedmcam.transforms.plan.planner import plan_cuts
from wedmcam.transforms.plan.portion import only_cuts
from wedmcam.transforms.plan.shaped import ShapedCut
from wedmcam.transforms.plan.wording import OF_DRAWING, OF_PART

SPAN = TextSpan("part.wed", 3, 1)
RING = (parts.rectangle(20_000, 20_000), parts.circle(10_000, 10_000, 6_000))
PUNCH_AND_DIE = """part "both"
contour plate { from (0, 0) line to (30, 0) line to (30, 20) line to (0, 20) close }
contour edge { from (40, 0) line to (40, 20) }
cut plate outside offset 0.1
cut plate inside offset 0.09 start (15, 10)
cut edge left offset 0.05004
cut edge on
"""


def cuts_asked(figure, options):
    groups = [Group(rule_of("", options.cutting), tuple(figure))]
    return cuts_of_drawing(groups, nest(figure), (), options.cutting, options.leading, 10.0)


def planned_cuts(cuts, options, words):
    return plan_cuts(cuts, options.cutting, options.leading, FLOAT64, words, options.wished)


def planned(figure, side, **options):
    """Return the plan of the contours of a drawing, and that of one cut that names the same."""
    options = Options.of(offset_um=None if side is Side.ON else 100.0, side=side, **options)
    asked, found = cuts_of_drawing(
        [Group(rule_of("", options.cutting), tuple(figure))],
        nest(figure),
        (),
        options.cutting,
        options.leading,
        10.0,
    )
    assert not found
    drawing = planned_cuts(asked, options, OF_DRAWING)
    item = CutItem("part", Shape(()), asked[0].item.side, SPAN)
    return drawing, planned_cuts([ShapedCut(item, tuple(figure))], options, OF_PART)


def same(a, b):
    return a.closed == b.closed and np.array_equal(a.vertices, b.vertices)


@pytest.mark.parametrize("side", [Side.PART, Side.DIE])
@given(seed=st.integers(0, 10_000))
def test_a_drawing_is_a_part_program_of_one_cut(side, seed):
    (drawing, found), (program, more) = planned(parts.random_part(seed), side)
    assert [(d.code, d.points_mm) for d in found] == [(d.code, d.points_mm) for d in more]
    assert (drawing is None) == (program is None)
    for a, b in zip(drawing.cuts, program.cuts, strict=True) if drawing else ():
        assert same(a.path, b.path)
        assert same(a.outline, b.outline)
        fields = ("thread", "depth", "keeps_left", "number", "side", "offset_um", "scene")
        assert [getattr(a, f) for f in fields] == [getattr(b, f) for f in fields]


def test_contours_on_the_line_are_one_scene_of_a_drawing():
    """Its leads are held against all of them, and inner ones come first."""
    (drawing, _), (program, _) = planned(RING, Side.ON)
    assert [len(s.outlines) for s in drawing.scenes] == [2]
    assert [len(s.outlines) for s in program.scenes] == [1, 1]
    assert [c.number for c in drawing.cuts] == [2, 1]
    assert drawing.scenes[0].keeps is None
    assert not drawing.materials


def test_sides_that_contradict_each_other_are_refused():
    """Both run counter-clockwise: left of both keeps the ring's hole and what lies around it."""
    item = CutItem("ring", Shape(()), "left", SPAN, offset=100.0)
    plan, found = planned_cuts([ShapedCut(item, RING)], Options(), OF_PART)
    assert plan is None
    (wrong,) = found
    assert wrong.code == "closed-left-right"
    assert "(16.000, 10.000) mm keeps what the one at (0.000, 0.000) mm" in wrong.message
    other_way = (RING[0], RING[1].reversed())
    plan, found = planned_cuts([ShapedCut(item, other_way)], Options(), OF_PART)
    assert plan is not None, found
    assert [s.keeps for s in plan.scenes] == [Side.DIE]


def test_a_cut_keeps_its_side_offset_and_scene():
    made = api.compile(PUNCH_AND_DIE.encode(), name="part.wed")
    assert made.ok, made.findings
    of = [(str(c.side), c.offset_um, c.scene) for c in made.plan.cuts]
    assert of == [("part", 100.0, 0), ("die", 90.0, 1), ("left", 50.04, 2), ("on", 0.0, 3)]
    assert [s.keeps for s in made.plan.scenes] == [Side.PART, Side.DIE, None, None]
    assert [(m.scene, m.side, m.offset_um) for m in made.plan.materials] == [
        (0, Side.PART, 100.0),
        (1, Side.DIE, 90.0),
    ]
    assert made.verdict.side == "mixed"


def test_a_part_of_a_plan_tells_the_side_and_offset_of_the_whole():
    whole = api.compile(PUNCH_AND_DIE.encode(), name="part.wed").plan
    part = only_cuts(whole, 4, 4)
    assert (part.side, part.offset_um, part.partial) == (whole.side, whole.offset_um, True)
    assert (part.side, part.offset_um) == (Side.PART, 100.0)
    assert part.outlines == whole.outlines


@pytest.mark.parametrize(
    ("sides", "keeps", "side"),
    [
        (["part"], "part", "part"),
        (["left"], "part", "left"),  # closed contours cut left keep something all the same
        (["part", "left"], "part", "part"),
        (["on", "left"], None, "left"),
        (["on", "right"], None, "right"),
        (["on"], None, "on"),
    ],
)
def test_the_side_of_a_plan_is_that_of_its_scenes(sides, keeps, side):
    (plan, _), _ = planned(RING, Side.PART)
    outline = plan.outlines[0]
    many = len(sides)
    scene = Scene(
        (outline,) * many,
        (0,) * many,
        (1.0,) * many,
        tuple(map(Side, sides)),
        keeps and Side(keeps),
    )
    assert replace(plan, scenes=(scene,)).side == side


def test_open_contours_of_one_figure_that_run_the_other_way_are_one_warning():
    """Each is run from the end that is nearer to its thread point, whatever --reverse says."""
    figure = [parts.contour_of_bulges([[x, 0], [x, 5000]], [0, 0], closed=False) for x in (0, 9000)]
    options = Options.of(offset_um=100.0, side=Side.LEFT, reverse=True)
    options = options.with_values(starts_um=((-100.0, -500.0), (8900.0, -500.0)))
    asked, _ = cuts_of_drawing(
        [Group(rule_of("", options.cutting), tuple(figure))],
        nest(figure),
        (),
        options.cutting,
        options.leading,
        10.0,
    )
    _, found = planned_cuts(asked, options, OF_DRAWING)
    assert [(d.code, d.count) for d in found] == [("idle-option", 2)]


PASSES = """
contour c { from (0, 0) line to (20, 0) line to (20, 10) line to (0, 10) close }
cut c outside offset 0.2 start (-1, 5)
cut c outside offset 0.1 start (-1, 5)
"""


def test_a_finishing_pass_crosses_the_path_of_the_rough_one():
    compilation = api.compile(PASSES.encode(), name="passes.wed")
    assert compilation.ok, [d.message for d in compilation.findings]
    against = {"against": PASSES.encode(), "against_name": "passes.wed", "name": "a.3b"}
    assert api.verify(compilation.data, certificate=compilation.summary, **against).ok


def test_outlines_are_one_if_their_arcs_are_too():
    from wedmcam.ir.contour import Contour, vertices
    from wedmcam.ir.plan import Cut, outline_numbers

    def cut(x, radius):
        circle = Contour(vertices([(x + radius, 0, x, 0, 1, -1)]), True)
        return Cut(circle, circle, (0, 0))

    # The second has the seam of the first, and another centre; nobody drew the last.
    cuts = [cut(0, 10e3), cut(5e3, 5e3), cut(0, 10e3), Cut(None, cut(0, 1e3).path, (0, 0))]
    assert outline_numbers(cuts) == [0, 1, 0, 3]

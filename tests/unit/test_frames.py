"""Drawing frames and contours 3 deep are said; ordinary plates are not doubted."""

from __future__ import annotations

import pytest

import wedmcam
from drawings import VERSIONS, drawing
from wedmcam.diag import Severity

CODES = ("drawing-frame", "deep-nesting")


def rect(space, x0, y0, x1, y1, layer="0"):
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line(a, b, dxfattribs={"layer": layer})


def doubts(draw, version="R2010", binary=False, **options):
    data = drawing(draw, version=version, binary=binary)
    made = wedmcam.compile(data, name="f.dxf", **({"offset": 0.1} | options))
    seen = wedmcam.inspect(data, name="f.dxf", **({"offset": 0.1} | options))
    found = [d for d in made.findings if d.code in CODES]
    assert [d.code for d in seen.findings if d.code in CODES] == [d.code for d in found]
    assert all(d.severity is Severity.WARNING and d.points_mm and d.span for d in found)
    return found


def framed(doc, space, layer="FRAME"):
    """A4 with a part of one hole in the middle."""
    rect(space, 10, 10, 287, 200, layer)
    rect(space, 60, 60, 160, 140, "CUT")
    space.add_circle((110, 100), 20, dxfattribs={"layer": "CUT"})


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("binary", [False, True])
def test_a_part_with_a_hole_in_a_frame(version, binary):
    more = {"units": "mm"} if version == "R12" else {}  # it states none
    (found,) = doubts(framed, version, binary, **more)
    assert found.code == "drawing-frame"
    assert "the rectangle of 277.000 x 190.000 mm at (10.000, 10.000) mm" in found.message
    assert found.hint.startswith("--ignore-layer FRAME leaves out")
    assert "--layer CUT" in found.hint
    assert doubts(framed, ignore_layers=("FRAME",)) == []


def test_all_on_one_layer_the_cure_is_a_layer():
    (found,) = doubts(lambda doc, space: framed(doc, space, "CUT"))
    assert "on a layer of its own" in found.hint


def titled(doc, space):
    """A part without holes, and a title block written in."""
    rect(space, 0, 0, 297, 210)
    rect(space, 60, 60, 160, 140)
    rect(space, 200, 5, 290, 40)
    space.add_text("BRACKET", height=5).set_placement((210, 20))


def inserted(doc, space):
    block = doc.blocks.new("TITLE", base_point=(1, 1))
    block.add_text("BRACKET", height=5).set_placement((11, 16))
    rect(block, 1, 1, 91, 36)
    rect(space, 0, 0, 297, 210)
    rect(space, 60, 60, 160, 140)
    space.add_blockref("TITLE", (200, 5))


def with_attributes(doc, space):
    rect(space, 0, 0, 297, 210)
    rect(space, 60, 60, 160, 140)
    rect(space, 200, 5, 290, 40)
    doc.blocks.new("LOGO").add_circle((0, 0), 1)
    mark = space.add_blockref("LOGO", (230, 20))
    mark.add_attrib("NAME", "BRACKET", (235, 25))


@pytest.mark.parametrize("draw", [titled, inserted, with_attributes])
def test_a_title_block_makes_a_frame(draw):
    (found,) = doubts(draw)
    assert found.code == "drawing-frame"
    if draw is not with_attributes:  # there the logo in the title block says it
        assert "the one at (200.000, 5.000) mm is a title block" in found.message


def test_double_borders_with_parts_inside():
    def draw(doc, space):
        rect(space, 0, 0, 297, 210)
        framed(doc, space)

    assert [d.code for d in doubts(draw)] == ["drawing-frame"]


def plain_plate(doc, space):
    rect(space, 0, 0, 100, 60)
    for x in (20, 50, 80):
        space.add_circle((x, 30), 8)
    rect(space, 10, 5, 20, 12)
    space.add_text("PLATE", height=3).set_placement((40, 5))


def windowed(doc, space):
    """A note in a window in the middle is no title block."""
    rect(space, 0, 0, 100, 60)
    rect(space, 30, 20, 70, 40)
    space.add_text("4 x", height=3).set_placement((40, 30))


def side_by_side(doc, space):
    for x in (0, 200, 400):
        rect(space, x, 0, x + 100, 60)
        space.add_circle((x + 50, 30), 8)


@pytest.mark.parametrize("draw", [plain_plate, windowed, side_by_side])
def test_ordinary_parts_are_not_doubted(draw):
    assert doubts(draw) == []


def test_bores_of_a_plate_are_deep_and_no_frame():
    def draw(doc, space):
        rect(space, 0, 0, 100, 60)
        for x in (20, 80):
            space.add_circle((x, 30), 8)
            space.add_circle((x, 30), 4)

    (found,) = doubts(draw)
    assert found.code == "deep-nesting"
    assert "lies 3 deep (outer contour, hole, island); 2 islands lie so" in found.message


def test_rings_in_rings():
    def draw(doc, space):
        for r in (50, 40, 30, 20):
            space.add_circle((0, 0), r, dxfattribs={"layer": f"R{r}"})

    (found,) = doubts(draw)
    assert "lies 4 deep (outer contour, hole, island, hole); 1 hole, 1 island lie so" in (
        found.message
    )
    assert "--ignore-layer R20 --ignore-layer R30" in found.hint


def test_copies_of_a_transform_are_nested_as_they_are_cut():
    def draw(doc, space):
        rect(space, 0, 0, 100, 60)
        rect(space, 10, 10, 20, 20)

    assert doubts(draw, transforms=("translate (0, 100) copies 2",)) == []


def test_many_frames_are_counted():
    def draw(doc, space):
        for x in range(0, 26 * 50, 50):
            rect(space, x, 0, x + 40, 40)
            rect(space, x + 5, 5, x + 35, 35)
            rect(space, x + 10, 10, x + 20, 20)

    made = wedmcam.compile(drawing(draw), name="f.dxf", offset=0.1)
    found = [d for d in made.findings if d.code == "drawing-frame"]
    assert len(found) == 11
    assert found[-1].message == "16 further rectangles like these"

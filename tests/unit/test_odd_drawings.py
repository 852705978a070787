"""Drawings that are not what they seem: wide lines, debris, blocks that nothing shows."""

from __future__ import annotations

import pytest

from drawings import codes, drawing, got, sketch
from wedmcam import api
from wedmcam.transforms.chain import chain, open_contour_findings


def test_field_donut_width():
    def draw(doc, msp):
        points = [(-5, 0, 10, 10, 1), (5, 0, 10, 10, 1)]
        msp.add_lwpolyline(points, "xyseb", close=True)

    (said,) = [d for d in got(drawing(draw))[1] if d.code == "polyline-width"]
    assert str(said.severity) == "warning"
    assert "a disc of 20.000 mm, what is cut is its centre line of 10.000 mm" in said.message


@pytest.mark.parametrize("nested", [1, 2])
@pytest.mark.parametrize("old", [False, True])
def test_wide_polylines_say_how_large_they_are(nested, old):
    def draw(doc, msp):
        to = doc.blocks.new("B") if nested == 2 else msp
        points = [(0, 0), (20, 0), (20, 10)]
        if old:
            line = to.add_polyline2d(points, close=True)
            line.dxf.default_start_width = line.dxf.default_end_width = 2
        else:
            to.add_lwpolyline(points, close=True, dxfattribs={"const_width": 2})
        if nested == 2:
            msp.add_blockref("B", (0, 0), dxfattribs={"xscale": 2, "yscale": 2, "zscale": 2})

    (said,) = [d for d in got(drawing(draw))[1] if d.code == "polyline-width"]
    k = nested
    assert f"{2 * k:.3f} mm wide, {22 * k:.3f} x {12 * k:.3f} mm" in said.message
    assert f"its centre line, {20 * k:.3f} x {10 * k:.3f} mm" in said.message


def test_field_block_never_inserted():
    def draw(doc, msp):
        block = doc.blocks.new("PART")
        for k in range(5):
            block.add_line((k, 0), (k, 9))
        doc.blocks.new("INNER").add_circle((0, 0), 3)
        block.add_blockref("INNER", (0, 0))
        msp.add_text("x")

    found = got(drawing(draw))[1]
    (said,) = [d for d in found if d.code == "empty-drawing"]
    assert "block PART (6 entities) is inserted nowhere" in said.message


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ((20_000, 10_000, 20_003, 10_000), "a loose line of 0.003 mm at (20.000, 10.000)"),
        ((40_000, 5_000, 40_500, 5_500), "a loose line of 0.707 mm at (40.000, 5.000)"),
        ((0, 90_000, 0, 70_000), "a loose line of 20.000 mm from"),
        ((50_000, 0, 50_200, 200, 50_000, 200, 1), "a loose arc of 0.314 mm"),
    ],
)
def test_field_loose_pieces(row, words):
    square = [(0, 0, 9e3, 0), (9e3, 0, 9e3, 9e3), (9e3, 9e3, 0, 9e3), (0, 9e3, 0, 0)]
    contours, _, _ = chain(sketch([*square, row]))
    (said,) = open_contour_findings(contours)
    assert said.code == "open-contour"
    assert words in said.message
    assert "--join" not in said.hint
    assert "delete it" in said.hint


def test_a_gap_that_a_join_closes_is_still_said_so():
    rows = [(0, 0, 9e3, 0), (9e3, 0, 9e3, 9e3), (9e3, 9e3, 100, 100)]
    (said,) = open_contour_findings(chain(sketch(rows))[0])
    assert "--join 0.142 would close the gap" in said.hint
    two = [(0, 0, 9e3, 0), (9_050, 0, 9_050, 9e3)]
    for said in open_contour_findings(chain(sketch(two))[0]):
        assert "loose" not in said.message


def test_field_closed_flag_on_open_run():
    def draw(doc, msp):
        points = [(30, 20), (0, 20), (0, 0), (30, 0)]
        msp.add_lwpolyline(points, close=True)
        msp.add_arc((30, 10), 10, -90, 90)

    made = api.compile(drawing(draw), offset=0.1)
    (one, _) = [d for d in made.findings if d.code == "branch"]
    assert "3 segments meet" in one.message
    assert "closing segment of LWPOLYLINE #" in one.message
    assert "closed flag" in one.hint


def test_a_slit_is_not_dropped_in_silence():
    def draw(doc, msp):
        msp.add_lwpolyline([(0, 0), (30, 0), (30, 0.0005), (0, 0.0005)], close=True)

    found = chain(got(drawing(draw))[0])[2]
    assert "duplicate" in [d.code for d in found if str(d.severity) == "warning"]

    def there_and_back(doc, msp):
        msp.add_lwpolyline([(0, 0), (30, 0)], close=True)

    found = chain(got(drawing(there_and_back))[0])[2]
    assert [str(d.severity) for d in found] == ["note"]
    assert codes(found) == ["duplicate"]

"""Ten traps of real drawings, and the robustness list for reading (D) and chaining (G), by ids.

Cases that have a file of tests to themselves (curves, units, chaining) are here only by one small
drawing each, so that every id is found by its name.
"""

import math
from pathlib import Path

import numpy as np
import pytest

import wedmcam.frontends.dxf
from drawings import SQUARE, bare, codes, drawing, got, polygon, rows, sketch
from wedmcam.diag import Severity
from wedmcam.frontends.dxf import read
from wedmcam.transforms.chain import chain, open_contour_findings

LINE = "0 LINE 5 2F 8 0 10 0 20 0 11 80 21 40"
LWPOLYLINE = (
    "0 LWPOLYLINE 5 2F 100 AcDbEntity 8 CUT 100 AcDbPolyline 90 3 70 1 "
    "10 0 20 0 10 9 20 0 10 9 20 9"
)
SPLINE = (
    "0 SPLINE 5 {handle} 8 CUT 70 8 71 3 72 8 73 4 74 0 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 "
    "10 {x} 20 0 10 {x} 20 5 10 9 20 {x} 10 9 20 9"
)


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


# --- the ten traps --------------------------------------------------------------------------


def test_trap_01_repeated_handles_lose_nothing():
    vertices = " ".join(f"0 VERTEX 5 2A 8 0 10 {x} 20 {y}" for x, y in ((0, 0), (9, 0), (9, 9)))
    polyline = f"0 POLYLINE 5 29 8 0 66 1 10 0 20 0 70 1 {vertices} 0 SEQEND 5 2B 8 0"
    splines = [SPLINE.format(handle="43", x=20 + k) for k in range(7)]
    sketch, found = got(bare(polyline, *splines))
    assert sketch.info.entities == {"POLYLINE": {"0": 1}, "SPLINE": {"CUT": 7}}
    assert len({int(k) for k in sketch.segments["source"]}) == 8
    assert errors(found) == []


def test_trap_01_a_loss_in_reading_is_an_error(monkeypatch):
    from ezdxf.layouts import Modelspace

    data = drawing(lambda doc, msp: [msp.add_line((0, k), (9, k)) for k in range(3)])
    real = Modelspace.__iter__
    monkeypatch.setattr("ezdxf.layouts.blocklayout.BlockLayout.__iter__", lambda self: iter(()))
    assert real is not None
    _, found = read(data, "part.dxf")
    assert "damaged-drawing" in errors(found)
    assert any("3 LINE" in d.message for d in found)


def test_trap_02_decimal_commas_are_refused():
    data = bare("0 LINE 8 0 10 2,5 20 0 11 80 21 40")
    _, found = read(data, "part.dxf")
    assert errors(found) == ["damaged-drawing"]
    assert "comma" in found[0].message


def test_trap_03_no_version_keeps_layer_and_closed_flag():
    data = bare(LWPOLYLINE).decode().replace("  9\n$ACADVER\n  1\nAC1009\n", "")
    drawn, found = got(data.encode())
    assert drawn.info.entities == {"LWPOLYLINE": {"CUT": 1}}
    assert [c.closed for c in chain(drawn)[0]] == [True]
    assert codes(found) == ["repaired-drawing"]


def test_trap_04_no_header_means_no_units_and_not_metres():
    data = bare(LINE).decode()
    data = data[data.index("  0\nSECTION\n  2\nENTITIES") :]
    drawn, found = read(data.encode(), "part.dxf")
    assert drawn is None
    assert errors(found) == ["no-units"]
    assert "80.000 x 40.000" in found[0].message


def test_trap_05_units_that_are_unlikely_are_said_and_overridden():
    data = drawing(lambda doc, msp: msp.add_circle((0, 0), 150), units=1)
    assert "unlikely-units" in codes(got(data)[1])
    drawn, found = got(data, units="mm")
    assert codes(found) == ["units-overridden"]
    assert drawn.segments["x0"][0] == 150_000


def test_trap_06_no_subclass_markers():
    spline = SPLINE.format(handle="30", x=0)
    unmarked = "0 LWPOLYLINE 5 2F 8 CUT 90 3 70 1 10 0 20 0 10 9 20 0 10 9 20 9"
    for version in ("AC1015", "AC1006"):
        data = bare(unmarked, spline).decode().replace("AC1009", version)
        drawn, found = got(data.encode())
        assert drawn.info.entities == {"LWPOLYLINE": {"CUT": 1}, "SPLINE": {"CUT": 1}}
        assert errors(found) == []
        assert codes(found).count("repaired-drawing") == 1 + (version == "AC1006")


@pytest.mark.parametrize("z", [0.0, 1e-300])
def test_trap_07_insert_with_z_scale_0(z):
    def draw(doc, msp):
        doc.blocks.new("B").add_circle((1, 1), 5)
        msp.add_blockref("B", (10, 20), dxfattribs={"xscale": 2, "yscale": 2, "zscale": z})

    assert rows(got(drawing(draw))[0]) == [(22_000, 22_000, 22_000, 22_000, 12_000, 22_000, 1)]


def test_trap_08_paper_space_only_is_said():
    drawn, found = got(drawing(lambda doc, msp: doc.layout("Layout1").add_circle((0, 0), 5)))
    assert errors(found) == ["empty-drawing"]
    assert "paper space" in found[-1].message
    assert len(drawn.segments) == 0


def test_trap_09_merge_conflict_is_refused_with_its_line():
    text = bare(LINE).decode().replace("11\n80", "<<<<<<< HEAD\n11\n80\n=======\n11\n9\n>>>>>>> b")
    _, found = read(text.encode(), "part.dxf")
    assert errors(found) == ["merge-conflict"]
    assert text.split("\n")[found[0].span.line - 1] == "<<<<<<< HEAD"


def test_trap_10_no_helper_of_ezdxf_decides_what_is_flat():
    """``edgesmith.filter_2d_entities`` is inverted in 1.4.5: the reader decides on its own."""
    folder = Path(wedmcam.frontends.dxf.__file__).parent
    text = "".join(p.read_text("utf-8") for p in folder.glob("*.py"))
    assert "edgesmith" not in text
    flat = drawing(lambda doc, msp: msp.add_line((0, 0, 3), (9, 0, 3)))
    steep = drawing(lambda doc, msp: msp.add_line((0, 0, 3), (9, 0, 5)))
    assert errors(got(flat)[1]) == []
    assert errors(got(steep)[1]) == ["not-flat"]


# --- damaged files --------------------------------------------------------------------------


def section(name, body):
    return f"  0\nSECTION\n  2\n{name}\n" + "\n".join(body.split()) + "\n  0\nENDSEC\n"


def test_a_broken_table_is_read_without_it():
    data = bare(LINE, "0 CIRCLE 5 30 8 CUT 10 5 20 5 40 2").decode()
    broken = section("OBJECTS", "0 DICTIONARY 5 1 100 AcDbDictionary 3 A 350 2 0 ACDBX 5 1")
    tables = section(
        "TABLES", "0 VPORT 2 X 0 TABLE 2 LAYER 70 1 0 LAYER 2 CUT 70 1 62 7 6 X 0 ENDTAB"
    )
    data = data.replace(
        "  0\nSECTION\n  2\nENT", tables + broken + "  0\nENDSEC\n  0\nSECTION\n  2\nENT"
    )
    drawn, found = got(data.encode())
    assert rows(drawn) == [(0, 0, 80_000, 40_000, 0, 0, 0)]
    assert drawn.info.ignored == {"CIRCLE": {"CUT": 1}}  # layer states survive: CUT is frozen
    assert codes(found) == ["repaired-drawing", "hidden-not-cut"]
    assert found[0].severity is Severity.WARNING


def test_coordinates_in_another_order():
    data = bare(
        "0 LINE 8 0 10 1.5 11 2 20 -1 21 3 30 0 31 0", "0 ARC 8 0 20 1 10 2 40 5 50 0 51 90"
    )
    drawn, found = got(data)
    assert rows(drawn) == [
        (1_500, -1_000, 2_000, 3_000, 0, 0, 0),
        (7_000, 1_000, 2_000, 6_000, 2_000, 1_000, 1),
    ]
    assert codes(found) == ["repaired-drawing"]
    assert "coordinates of 2 entities put in order" in found[0].message


def test_a_colour_that_is_no_number_is_left_out_and_said():
    drawn, found = got(bare(LINE.replace("8 0", "8 0 62 256QSW")))
    assert len(drawn.segments) == 1
    assert "colours" in found[0].message


def test_a_count_that_is_no_number_is_refused():
    data = bare(LWPOLYLINE.replace("70 1", "70 1x")).decode().replace("AC1009", "AC1015")
    _, found = read(data.encode(), "part.dxf")
    assert errors(found) == ["damaged-drawing"]


def test_groups_outside_of_sections():
    data = bare(LINE).decode()
    data = data.replace(
        "  0\nSECTION\n  2\nENT", "  9\n$EXTMIN\n 10\n1.0\n  0\nENDSEC\n  0\nSECTION\n  2\nENT"
    )
    drawn, found = got(data.encode())
    assert len(drawn.segments) == 1
    assert errors(found) == []
    assert codes(found) in ([], ["repaired-drawing"])


# --- D: reading -----------------------------------------------------------------------------


def test_d01_bulge_over_one():
    drawn, _ = got(drawing(lambda d, m: m.add_lwpolyline([(0, 0, 2), (10, 0, 0)], "xyb")))
    assert rows(drawn) == [(0, 0, 10_000, 0, 5_000, -3_750, 1)]


def test_d02_circle_of_two_vertices():
    data = drawing(lambda d, m: m.add_lwpolyline([(0, 0, 1), (9, 0, 1)], "xyb", close=True))
    (contour,), _, _ = chain(got(data)[0])
    assert contour.closed
    assert set(contour.vertices["turn"]) == {1}


@pytest.mark.parametrize(
    ("bulge", "code"), [(1e-9, []), (-1e-12, []), (1e6, ["bad-bulge"]), (-1e6, ["bad-bulge"])]
)
def test_d03_bulges_of_nothing_and_of_everything(bulge, code):
    drawn, found = got(drawing(lambda d, m: m.add_lwpolyline([(0, 0, bulge), (9, 0, 0)], "xyb")))
    assert codes(found) == code
    assert all(np.isfinite(drawn.segments[n]).all() for n in ("x0", "cx", "cy"))


@pytest.mark.parametrize(("a", "b", "sweep"), [(350, 10, 20), (10, 370, 360), (-90, 90, 180)])
def test_d04_arc_angles(a, b, sweep):
    drawn, _ = got(drawing(lambda d, m: m.add_arc((0, 0), 10, a, b)))
    from wedmcam.transforms.doubles import columns

    assert math.degrees(columns(drawn.segments).sweep[0]) == pytest.approx(sweep)


def test_d05_extrusion_down_mirrors():
    down = {"extrusion": (0, 0, -1)}
    drawn, _ = got(drawing(lambda d, m: m.add_arc((5, 0), 2, 0, 90, dxfattribs=down)))
    assert rows(drawn) == [(-7_000, 0, -5_000, 2_000, -5_000, 0, -1)]


def test_d06_tilted_is_refused_with_its_name():
    tilt = {"extrusion": (0.3, 0, 0.95)}
    _, found = got(drawing(lambda d, m: m.add_circle((5, 0), 2, dxfattribs=tilt)))
    assert errors(found)[0] == "tilted"
    assert "CIRCLE" in found[0].message


def test_d07_insert_is_the_block_moved_turned_mirrored():
    def draw(doc, msp):
        doc.blocks.new("B", base_point=(1, 0)).add_arc((1, 0), 2, 0, 90)
        msp.add_blockref("B", (10, 0), dxfattribs={"xscale": -1, "rotation": 90})

    assert rows(got(drawing(draw))[0]) == [(10_000, -2_000, 8_000, 0, 10_000, 0, -1)]


def test_d08_unequal_scale_is_approximated_and_said():
    def draw(doc, msp):
        doc.blocks.new("B").add_circle((0, 0), 5)
        msp.add_blockref("B", (0, 0), dxfattribs={"xscale": 2})

    drawn, found = got(drawing(draw))
    assert codes(found) == ["approximated"]
    assert drawn.segments["x0"].max() == pytest.approx(10_000, abs=1e-6)
    assert drawn.segments["y0"].max() == pytest.approx(5_000, abs=1e-6)


def test_d09_blocks_missing_or_in_themselves():
    def draw(doc, msp):
        doc.blocks.new("A").add_blockref("A", (0, 0))
        msp.add_blockref("A", (0, 0))
        msp.add_blockref("NOWHERE", (0, 0))

    _, found = got(drawing(draw))
    assert errors(found)[:2] == ["missing-block", "block-cycle"]


def test_d13_units_missing_or_contradicting():
    assert errors(read(bare(LINE, header=""), "x")[1]) == ["no-units"]
    both = "  9\n$INSUNITS\n 70\n1\n  9\n$MEASUREMENT\n 70\n1\n"
    assert "units-contradict" in codes(got(bare(LINE, header=both))[1])


def test_d15_what_is_hidden_is_counted():
    def draw(doc, msp):
        doc.layers.add("OFF").off()
        doc.layers.add("ICE").freeze()
        for layer in ("OFF", "ICE", "DEFPOINTS", "0"):
            msp.add_line((0, 0), (9, 0), dxfattribs={"layer": layer})
        msp.add_line((0, 1), (9, 1), dxfattribs={"invisible": 1})

    drawn, found = got(drawing(draw))
    assert len(drawn.segments) == 1
    assert [(d.code, d.count) for d in found] == [("hidden-not-cut", 4)]


def test_d16_entities_only_and_a_layer_that_is_in_no_table():
    data = bare("0 LINE 8 NOWHERE 10 0 20 0 11 80 21 40").decode()
    data = data[data.index("  0\nSECTION\n  2\nENTITIES") :]
    drawn, _ = got(data.encode(), units="mm")
    assert drawn.info.entities == {"LINE": {"NOWHERE": 1}}


@pytest.mark.parametrize("number", ["20.", ".2e2", "2e+01", " 20", "+20", "2.0E1"])
def test_d17_numbers_as_they_come(number):
    data = bare(LINE).replace(b"\n40\n", f"\n{number}\n".encode())
    assert rows(got(data)[0]) == [(0, 0, 80_000, 20_000, 0, 0, 0)]


@pytest.mark.parametrize("number", ["2.E 1", "1.E", "E 20", "", "2O"])
def test_d17_numbers_that_are_none_are_refused_with_their_line(number):
    data = bare(LINE).replace(b"\n40\n", f"\n{number}\n".encode())
    _, found = read(data, "part.dxf")
    assert errors(found) == ["damaged-drawing"]
    assert data.decode().split("\n")[found[-1].span.line - 1] == number


@pytest.mark.parametrize(
    ("page", "encoding", "layer"),
    [
        ("ANSI_936", "gbk", "线切割"),
        ("GB2312", "gb2312", "轮廓"),
        ("ANSI_950", "big5", "輪廓"),
        ("BIG5", "big5", "線切割"),
        ("ANSI_932", "shift_jis", "輪郭ソ"),
        ("SHIFT_JIS", "shift_jis", "加工線"),
        ("ANSI_1252", "cp1252", "Fräsen"),
        ("ANSI_1251", "cp1251", "Контур"),
        ("dos850", "cp850", "Fräsen"),
    ],
)
def test_d18_code_pages(page, encoding, layer):
    header = f"  9\n$DWGCODEPAGE\n  3\n{page}\n  9\n$INSUNITS\n 70\n     4\n"
    text = bare(LINE.replace("8 0", "8 LAYER"), header=header).decode().replace("LAYER", layer)
    for version in ("AC1009", "AC1015", "AC1021"):  # some write their code page into new files
        drawn, found = got(text.replace("AC1009", version).encode(encoding))
        assert drawn.info.entities == {"LINE": {layer: 1}}
        assert errors(found) == []


def test_d18_utf8_with_mark_and_escapes():
    text = bare(LINE.replace("8 0", "8 Fr\\U+00E4sen")).decode()
    for data in (text.encode(), b"\xef\xbb\xbf" + text.encode()):
        assert got(data)[0].info.entities == {"LINE": {"Fräsen": 1}}


@pytest.mark.parametrize("version", ["R12", "R2000", "R2010", "R2018"])
def test_d19_binary_is_text(version):
    def draw(doc, msp):
        msp.add_open_spline([(0, 0), (9, 9), (20, -5), (30, 0)]) if version != "R12" else None
        msp.add_circle((0, 0), 5)

    text, binary = (drawing(draw, version, binary=b) for b in (False, True))
    units = {"units": "mm"}
    assert rows(got(text, **units)[0]) == rows(got(binary, **units)[0])


@pytest.mark.parametrize("data", [b"", b"AC1032\0\0", b"\x89PNG\r\n\x1a\n", b"PK\x03\x04"])
def test_d19_what_is_no_drawing_is_named(data):
    drawn, found = read(data, "x.dxf")
    assert drawn is None
    assert errors(found) == ["not-dxf"]


def test_d20_taper_and_bodies_are_refused_by_name():
    def taper(doc, msp):
        msp.add_circle((0, 0, 0), 10)
        msp.add_circle((0, 0, 40), 8)

    _, found = got(drawing(taper))
    assert errors(found) == ["taper"]
    assert "0.000 to 40.000 mm" in found[0].message

    def body(doc, msp):
        msp.add_3dface([(0, 0, 0), (1, 0, 5), (1, 1, 5)])
        msp.add_polymesh((3, 3))

    _, found = got(drawing(body))
    assert errors(found) == ["empty-drawing"]
    assert "but 3DFACE, POLYLINE (mesh)" in found[-1].message

    def level(doc, msp):
        msp.add_circle((0, 0, 40), 8)
        msp.add_lwpolyline([(0, 0), (1, 0)], dxfattribs={"elevation": 40})

    assert errors(got(drawing(level))[1]) == []


def test_d21_pieces_of_nothing():
    points = [(0, 0, 0), (10, 0, 1), (10, 10, 0.5), (10, 10, 0), (0, 10, 0)]

    def draw(doc, msp):
        msp.add_lwpolyline(points, "xyb", close=True)
        msp.add_line((50, 50), (50, 50))

    drawn, found = got(drawing(draw))
    assert [r[6] for r in rows(drawn)] == [0, 1, 0, 0]
    assert codes(found) == ["zero-length"]


def test_d22_far_away_is_the_same():
    near, _ = got(drawing(lambda d, m: m.add_arc((0, 0), 5, 10, 100)))
    far, _ = got(drawing(lambda d, m: m.add_arc((1e7, 1e7), 5, 10, 100)))
    assert far.segments["x1"] - 1e10 == pytest.approx(near.segments["x1"], abs=1e-5)


@pytest.mark.parametrize("number", ["nan", "1e400", "-inf"])
def test_d23_numbers_without_end(number):
    _, found = got(bare(LINE.replace("40", number)))
    assert errors(found)[0] == "bad-number"


# --- G: chaining ----------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "closed"), [(0.5, 1), (1, 1), (2, 1), (9, 1), (11, 0), (400, 0)])
def test_g01_gaps(gap, closed):
    (first, *rest) = SQUARE
    x0, y0, x1, y1 = first
    contours, _, _ = chain(sketch([(x0 + gap, y0, x1, y1), *rest]))
    assert sum(c.closed for c in contours) == closed
    assert bool(open_contour_findings(contours)) == (not closed)


def test_g02_a_row_of_near_points_does_not_collapse():
    contours, _, _ = chain(sketch(polygon(*((8.0 * k, 0.0) for k in range(10)), closed=False)))
    assert contours[0].vertices["x"].max() == 72


def test_g03_cell_borders():
    lines = [(0, 0, 9_999.9999, 0), (10_000.0001, 0, 10_000, 5_000), (0, 0, 10_000, 5_000)]
    assert [c.closed for c in chain(sketch(lines))[0]] == [True]


@pytest.mark.parametrize("scale", [0.01, 1, 100])
def test_g04_the_tolerance_is_absolute(scale):
    lines = [tuple(scale * v for v in s) for s in SQUARE]
    x0, y0, x1, y1 = lines[0]
    contours, _, _ = chain(sketch([(x0 + 20.0, y0, x1, y1), *lines[1:]]))
    assert not contours[0].closed


def test_g05_copies_and_overlaps():
    _, report, found = chain(sketch([*SQUARE, SQUARE[0], SQUARE[1][2:] + SQUARE[1][:2]]))
    assert report.duplicates == 2
    assert errors(found) == []
    assert "overlap" in errors(chain(sketch([*SQUARE, (2_000, 0, 5_000, 0)]))[2])


def test_g06_branches_and_touching_loops():
    assert "branch" in errors(chain(sketch([*SQUARE, (0, 0, 10_000, 10_000)]))[2])
    eight = [*SQUARE, *polygon((10_000, 10_000), (20_000, 10_000), (20_000, 20_000))]
    assert [c.closed for c in chain(sketch(eight))[0]] == [True, True]


def test_g07_open_paths_are_said():
    contours, _, _ = chain(sketch(SQUARE[:3]))
    assert errors(open_contour_findings(contours)) == ["open-contour"]


def test_g08_self_crossing():
    tie = polygon((0, 0), (10_000, 10_000), (10_000, 0), (0, 10_000))
    (finding,) = (d for d in chain(sketch(tie))[2] if d.severity is Severity.ERROR)
    assert finding.code == "self-crossing"
    assert finding.points_mm[0] == pytest.approx((5.0, 5.0))


def test_g09_nested_four_deep():
    from wedmcam.transforms.nest import nest

    squares = [
        s
        for k in range(4)
        for s in polygon(*((a * (9 - 2 * k), b * (9 - 2 * k)) for a, b in CORNERS))
    ]
    contours, _, _ = chain(sketch(squares))
    assert sorted(nest(contours).depths) == [0, 1, 2, 3]


CORNERS = ((-1000.0, -1000.0), (1000.0, -1000.0), (1000.0, 1000.0), (-1000.0, 1000.0))


def test_g10_many_segments():
    ring = [(1e6 * math.cos(a), 1e6 * math.sin(a)) for a in np.linspace(0, 2 * np.pi, 20_001)[:-1]]
    contours, _, _ = chain(sketch(polygon(*ring)))
    assert [len(c) for c in contours] == [20_000]


def test_g11_a_circle_and_two_halves():
    from wedmcam.geom.measure import segment_areas
    from wedmcam.transforms.doubles import columns

    halves = [(5e3, 0, -5e3, 0, 0, 0, 1), (-5e3, 0, 5e3, 0, 0, 0, 1)]
    for given in ([(5e3, 0, 5e3, 0, 0, 0, -1)], halves):
        (contour,), _, _ = chain(sketch(given))
        assert contour.closed
        assert set(contour.vertices["turn"]) == {1}
    assert segment_areas(columns(sketch(halves).segments), (0.0, 0.0)).sum() == pytest.approx(
        math.pi * 25e6
    )


def test_g12_order_does_not_matter():
    one, _, _ = chain(sketch(SQUARE))
    two, _, _ = chain(sketch([s[2:] + s[:2] for s in reversed(SQUARE)]))
    for name in ("x", "y", "turn"):
        assert (one[0].vertices[name] == two[0].vertices[name]).all()

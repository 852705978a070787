import math

import ezdxf
import numpy as np
import pytest

from drawings import VERSIONS, bare, codes, drawing, got, rows
from wedmcam.diag import Severity
from wedmcam.frontends.dxf import read
from wedmcam.frontends.options import DrawingReading
from wedmcam.geom.segments import make


def sweep_deg(row):
    one = [np.array([v]) for v in row[:6]]
    return math.degrees(make(*one, np.array([row[6]])).sweep[0])


# --- entities -------------------------------------------------------------------------------


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("version", VERSIONS)
def test_versions(version, binary):
    def draw(doc, msp):
        msp.add_line((0, 0), (10, 0))
        msp.add_arc((10, 5), 5, -90, 90)
        msp.add_circle((5, 5), 2)

    data = drawing(draw, version, binary=binary)
    options = {"units": "mm"} if version == "R12" and b"$INSUNITS" not in data else {}
    sketch, found = got(data, **options)
    assert rows(sketch) == [
        (0, 0, 10_000, 0, 0, 0, 0),
        (10_000, 0, 10_000, 10_000, 10_000, 5_000, 1),
        (7_000, 5_000, 7_000, 5_000, 5_000, 5_000, 1),
    ]
    assert not [d for d in found if d.severity is Severity.ERROR]
    assert sketch.info.entities == {"ARC": {"0": 1}, "CIRCLE": {"0": 1}, "LINE": {"0": 1}}
    assert sketch.info.extra.get("binary", False) is binary


def test_sources_are_handles():
    handles = []

    def draw(doc, msp):
        doc.layers.add("CUT")
        handles.append(msp.add_line((0, 0), (1, 0), dxfattribs={"layer": "CUT"}).dxf.handle)
        handles.append(msp.add_lwpolyline([(0, 0), (1, 1), (2, 0)]).dxf.handle)

    sketch, _ = got(drawing(draw))
    spans = [sketch.sources[k] for k in sketch.segments["source"]]
    assert [s.handle for s in spans] == [handles[0], handles[1], handles[1]]
    assert [str(s) for s in spans][:1] == [f"part.dxf:#{handles[0]} layer CUT"]


@pytest.mark.parametrize(
    ("start", "end", "sweep", "code"),
    [
        (350, 10, 20, []),
        (10, 370, 360, []),
        (-90, 90, 180, []),
        (0, 360, 360, []),
        (0, 360 + 1e-12, 360, []),
        (30, 30, 360, ["full-arc"]),
        (0, 359.99, 359.99, []),  # a gap: joined or refused by its width in the part
        (0, 359.9999, 360, ["rounded-turn"]),
    ],
)
def test_arc_angles(start, end, sweep, code):
    sketch, found = got(drawing(lambda doc, msp: msp.add_arc((1, 2), 10, start, end)))
    (row,) = rows(sketch)
    assert sweep_deg(row) == pytest.approx(sweep, abs=1e-6)
    assert codes(found) == code


def test_quadrants_are_exact():
    def draw(doc, msp):
        for k in range(4):
            msp.add_arc((0, 0), 10, 90 * k, 90 * k + 90)

    sketch, _ = got(drawing(draw))
    s = sketch.segments
    want = [(10_000, 0), (0, 10_000), (-10_000, 0), (0, -10_000)]
    assert [(r["x0"], r["y0"]) for r in s] == want
    assert [(r["x1"], r["y1"]) for r in s] == [*want[1:], want[0]]


def test_bulge_over_one():
    # Bulge 2 over a chord of 10: centre (5, -3.75), radius 6.25, 253.74 degrees.
    sketch, _ = got(drawing(lambda doc, msp: msp.add_lwpolyline([(0, 0, 2), (10, 0, 0)], "xyb")))
    (row,) = rows(sketch)
    assert row == (0, 0, 10_000, 0, 5_000, -3_750, 1)
    assert sweep_deg(row) == pytest.approx(253.7397953, abs=1e-6)


def draw_ring(doc, msp):
    msp.add_lwpolyline([(0, 0, 1), (10, 0, 1)], "xyb", close=True)


def draw_old_ring(doc, msp):
    msp.add_polyline2d([(0, 0, 1), (10, 0, 1)], format="xyb", close=True)


@pytest.mark.parametrize("draw", [draw_ring, draw_old_ring])
def test_closing_bulge(draw):
    sketch, _ = got(drawing(draw))
    assert rows(sketch) == [
        (0, 0, 10_000, 0, 5_000, 0, 1),
        (10_000, 0, 0, 0, 5_000, 0, 1),
    ]


@pytest.mark.parametrize("bulge", [1e-9, -1e-9, 1e-12, 0.0])
def test_tiny_bulge_is_a_line(bulge):
    sketch, found = got(
        drawing(lambda doc, msp: msp.add_lwpolyline([(0, 0, bulge), (1000, 0, 0)], "xyb"))
    )
    assert rows(sketch) == [(0, 0, 1_000_000, 0, 0, 0, 0)]
    assert not found


@pytest.mark.parametrize("bulge", [1e6, -1e6])
def test_absurd_bulge(bulge):
    _, found = got(drawing(lambda doc, msp: msp.add_lwpolyline([(0, 0, bulge), (9, 0, 0)], "xyb")))
    assert codes(found) == ["bad-bulge"]


def test_repeated_vertices_keep_their_neighbours_bulges():
    points = [(0, 0, 0), (10, 0, 1), (10, 10, 0.5), (10, 10, 0), (0, 10, 0), (0, 0, 0.3)]
    sketch, found = got(drawing(lambda doc, msp: msp.add_lwpolyline(points, "xyb", close=True)))
    assert rows(sketch) == [
        (0, 0, 10_000, 0, 0, 0, 0),
        (10_000, 0, 10_000, 10_000, 10_000, 5_000, 1),
        (10_000, 10_000, 0, 10_000, 0, 0, 0),
        (0, 10_000, 0, 0, 0, 0, 0),
    ]
    assert codes(found) == ["zero-length"]


def test_nothing_is_dropped_with_a_note():
    def draw(doc, msp):
        msp.add_line((1, 1), (1, 1))
        msp.add_circle((0, 0), 0)
        msp.add_arc((0, 0), 0, 0, 90)
        msp.add_lwpolyline([(3, 3)])
        msp.add_line((0, 0), (9, 0))

    sketch, found = got(drawing(draw))
    assert len(sketch.segments) == 1
    (finding,) = found
    assert (finding.code, finding.count) == ("zero-length", 4)


def test_polyline_width_is_said():
    def draw(doc, msp):
        msp.add_lwpolyline([(0, 0), (9, 0)], dxfattribs={"const_width": 1})

    assert codes(got(drawing(draw))[1]) == ["polyline-width"]


def test_polyline_3d():
    def flat(doc, msp):
        msp.add_polyline3d([(0, 0, 5), (9, 0, 5), (9, 9, 5)])

    def steep(doc, msp):
        msp.add_polyline3d([(0, 0, 5), (9, 0, 6)])
        msp.add_line((0, 0, 0), (1, 0, 1))

    assert len(got(drawing(flat))[0].segments) == 2
    _, found = got(drawing(steep))
    assert codes(found) == ["not-flat", "not-flat"]


def test_constant_height_is_accepted():
    sketch, found = got(drawing(lambda doc, msp: msp.add_line((0, 0, 7), (9, 0, 7))))
    assert len(sketch.segments) == 1
    assert not found


def test_mirrored_extrusion_is_the_mirrored_drawing():
    up, down = {}, {"extrusion": (0, 0, -1)}

    def draw(attribs, sign):
        def inner(doc, msp):
            msp.add_circle((sign * 20, 1), 2, dxfattribs=attribs)
            if sign > 0:  # as stored, in its own frame
                msp.add_arc((5, 5), 5, 10, 100, dxfattribs=attribs)
                msp.add_lwpolyline([(0, 0, 0.5), (9, 3, 0)], "xyb", dxfattribs=attribs)
            else:  # mirrored by hand
                msp.add_arc((-5, 5), 5, 80, 170, dxfattribs=attribs)
                msp.add_lwpolyline([(0, 0, -0.5), (-9, 3, 0)], "xyb", dxfattribs=attribs)

        return inner

    stored = rows(got(drawing(draw(down, 1)))[0])
    mirrored = rows(got(drawing(draw(up, -1)))[0])
    # The arc is run the other way round; everything else is equal row by row.
    x0, y0, x1, y1, cx, cy, turn = mirrored[1]
    assert stored == [mirrored[0], (x1, y1, x0, y0, cx, cy, -turn), mirrored[2]]


def test_tilted_is_refused_by_name():
    def draw(doc, msp):
        msp.add_circle((0, 0), 2, dxfattribs={"extrusion": (0.3, 0, 0.95)})
        msp.add_line((0, 0), (1, 0))

    _, found = got(drawing(draw))
    assert codes(found) == ["tilted"]
    assert found[0].span.dxftype == "CIRCLE"
    assert found[0].message.startswith("1 CIRCLE")


def test_unsupported_is_refused_with_handles():
    def draw(doc, msp):
        for k in range(7):
            msp.new_entity("HELIX", {"layer": f"A{k}"})
        msp.add_line((0, 0), (9, 0))

    _, found = got(drawing(draw))
    assert codes(found) == ["unsupported-entity"]
    assert found[0].message.startswith("7 HELIX")
    assert found[0].message.endswith("and 2 more)")
    assert found[0].count == 7


@pytest.mark.parametrize("number", ["nan", "1e400", "-inf"])
def test_number_that_is_none(number):
    entity = f"0 LINE 5 2F 8 CUT 10 0 20 {number} 11 5 21 5"
    _, found = got(bare(entity, "0 LINE 5 30 8 CUT 10 0 20 0 11 5 21 5"))
    assert codes(found) == ["bad-number"]
    assert found[0].span.handle == "2F"


def test_far_from_the_origin():
    # 10 km away the numbers still carry a nanometre.
    near, _ = got(drawing(lambda doc, msp: msp.add_arc((0, 0), 5, 10, 100)))
    far, _ = got(drawing(lambda doc, msp: msp.add_arc((1e7, 1e7), 5, 10, 100)))
    for name in ("x0", "y0", "x1", "y1"):
        assert far.segments[name] - 1e10 == pytest.approx(near.segments[name], abs=1e-5)


# --- blocks ---------------------------------------------------------------------------------


def block(doc, name="B", base=(0, 0)):
    made = doc.blocks.new(name, base_point=base)
    made.add_line((0, 0), (10, 0))
    made.add_arc((10, 5), 5, -90, 90)
    return made


@pytest.mark.parametrize(
    "attribs",
    [
        {},
        {"rotation": 30},
        {"rotation": 90, "xscale": 2, "yscale": 2},
        {"xscale": -1},
        {"yscale": -1, "rotation": 45},
        {"xscale": -2, "yscale": -2, "rotation": 270},
        {"extrusion": (0, 0, -1), "rotation": 30},
        {"zscale": -3},
    ],
)
def test_insert_is_the_exploded_block(attribs):
    where = (7, -3)

    def inserted(doc, msp):
        block(doc, base=(1, 2))
        msp.add_blockref("B", where, dxfattribs=attribs)

    def exploded(doc, msp):
        block(doc, base=(1, 2))
        msp.add_blockref("B", where, dxfattribs=attribs).explode()

    got_rows = rows(got(drawing(inserted))[0])
    want_rows = rows(got(drawing(exploded))[0])
    for mine, theirs in zip(got_rows, want_rows, strict=True):
        x0, y0, x1, y1, cx, cy, turn = theirs
        back = (x1, y1, x0, y0, cx, cy, -turn)  # ezdxf writes mirrored arcs the other way round
        assert mine == pytest.approx(theirs, abs=1e-5) or mine == pytest.approx(back, abs=1e-5)


def test_insert_nested_three_deep():
    def draw(doc, msp):
        block(doc)
        doc.blocks.new("C").add_blockref("B", (100, 0), dxfattribs={"rotation": 90})
        doc.blocks.new("D").add_blockref("C", (0, 50), dxfattribs={"xscale": 2, "yscale": 2})
        msp.add_blockref("D", (1, 1))

    sketch, _ = got(drawing(draw))
    # (0, 0) -> (100, 0) -> (200, 50) -> (201, 51); along +y, twice as long.
    assert rows(sketch)[0] == (201_000, 51_000, 201_000, 71_000, 0, 0, 0)
    assert len(sketch.sources[0].via) == 3


@pytest.mark.parametrize("scale", [1, 3])
def test_insert_array(scale):
    def draw(doc, msp):
        doc.blocks.new("B").add_circle((0, 0), 1)
        msp.add_blockref(
            "B",
            (5, 5),
            dxfattribs={
                "rotation": 90,
                "xscale": scale,
                "yscale": scale,
                "column_count": 3,
                "row_count": 2,
                "column_spacing": 10,
                "row_spacing": 20,
            },
        )

    sketch, _ = got(drawing(draw))
    centres = {(round(r["cx"]), round(r["cy"])) for r in sketch.segments}
    # The grid turns with the INSERT, and is not scaled: columns along +y, rows along -x.
    assert centres == {(5_000 - 20_000 * r, 5_000 + 10_000 * c) for r in (0, 1) for c in (0, 1, 2)}
    assert {round(r["x0"] - r["cx"]) for r in sketch.segments} == {1_000 * scale}
    assert sketch.info.entities == {"CIRCLE": {"0": 6}}


def test_insert_without_z_scale():
    # z scale 0 divides by zero in other readers.
    entity = "0 INSERT 5 2F 8 0 2 B 10 1 20 2 43 0"
    body = "0 BLOCK 8 0 2 B 70 0 10 0 20 0 3 B 0 LINE 8 0 10 0 20 0 11 5 21 0 0 ENDBLK 8 0"
    blocks = "0\nSECTION\n2\nBLOCKS\n" + "\n".join(body.split()) + "\n0\nENDSEC\n"
    data = (
        bare(entity).decode().replace("  0\nSECTION\n  2\nENT", blocks + "  0\nSECTION\n  2\nENT")
    )
    assert rows(got(data.encode())[0]) == [(1_000, 2_000, 6_000, 2_000, 0, 0, 0)]


def test_unequal_scale_of_lines():
    def lines(doc, msp):
        doc.blocks.new("B").add_line((1, 1), (2, 3))
        msp.add_blockref("B", (0, 0), dxfattribs={"xscale": 2, "yscale": 1})

    sketch, found = got(drawing(lines))
    assert rows(sketch) == [(2_000, 1_000, 4_000, 3_000, 0, 0, 0)]
    assert not found


def test_blocks_missing_and_within_themselves():
    def draw(doc, msp):
        a, b = doc.blocks.new("A"), doc.blocks.new("B")
        a.add_blockref("B", (0, 0))
        b.add_blockref("A", (0, 0))
        msp.add_blockref("A", (0, 0))
        msp.add_blockref("NOWHERE", (0, 0))
        msp.add_line((0, 0), (1, 0))

    _, found = got(drawing(draw))
    assert codes(found) == ["missing-block", "block-cycle"]
    assert "NOWHERE" in found[0].message
    assert "A in b in a" in found[1].message


def test_blocks_that_explode(monkeypatch):
    monkeypatch.setattr("wedmcam.frontends.dxf.place.MOST_COPIES", 2_000)

    def draw(doc, msp):
        doc.blocks.new("B0").add_line((0, 0), (1, 0))
        for k in range(8):
            doc.blocks.new(f"B{k + 1}").add_blockref(
                f"B{k}", (0, 0), dxfattribs={"column_count": 100, "column_spacing": 3}
            )
        msp.add_blockref("B8", (0, 0))

    assert codes(got(drawing(draw))[1]) == ["too-large"]


def test_layer_of_a_block():
    # Layer 0 in a block is the layer of the INSERT; other layers keep their own state.
    def draw(doc, msp):
        doc.layers.add("OFF").off()
        doc.layers.add("CUT")
        made = doc.blocks.new("B")
        made.add_line((0, 0), (1, 0))
        made.add_line((0, 0), (2, 0), dxfattribs={"layer": "CUT"})
        msp.add_blockref("B", (0, 0), dxfattribs={"layer": "OFF"})

    sketch, found = got(drawing(draw))
    assert rows(sketch) == [(0, 0, 2_000, 0, 0, 0, 0)]
    assert sketch.info.ignored == {"LINE": {"OFF": 1}}
    assert codes(found) == ["hidden-not-cut"]


# --- layers, what is not cut ----------------------------------------------------------------


def draw_layers(doc, msp):
    doc.layers.add("OFF").off()
    doc.layers.add("ICE").freeze()
    for k, layer in enumerate(("CUT-A", "cut-b", "OFF", "ICE", "DEFPOINTS", "NOTE")):
        msp.add_line((k, 0), (k, 9), dxfattribs={"layer": layer})
    msp.add_line((8, 0), (8, 9), dxfattribs={"invisible": 1})


def test_hidden_layers_are_counted():
    sketch, found = got(drawing(draw_layers))
    assert [r[0] for r in rows(sketch)] == [0, 1_000, 5_000]
    assert codes(found) == ["hidden-not-cut"]
    assert found[0].count == 4
    assert sketch.info.ignored == {"LINE": {"0": 1, "DEFPOINTS": 1, "ICE": 1, "OFF": 1}}


@pytest.mark.parametrize(
    ("options", "x"),
    [
        ({"layers": ("CUT*",)}, [0, 1_000]),
        ({"layers": ("cut-?",), "ignore_layers": ("*B",)}, [0]),
        ({"ignore_layers": ("CUT*",)}, [5_000]),
    ],
)
def test_layer_filters(options, x):
    sketch, found = got(drawing(draw_layers), **options)
    assert [r[0] for r in rows(sketch)] == x
    assert codes(found) == ["hidden-not-cut", "layer-left-out"]


def test_what_is_not_cut_is_counted():
    def draw(doc, msp):
        msp.add_line((0, 0), (9, 0))
        msp.add_text("hello", dxfattribs={"layer": "TXT"})
        msp.add_text("again", dxfattribs={"layer": "TXT"})
        msp.add_mtext("hello")
        msp.add_hatch()
        msp.add_point((1, 1))
        msp.add_3dface([(0, 0), (1, 0), (1, 1)])

    sketch, found = got(drawing(draw))
    (finding,) = found
    assert finding.code == "not-cut"
    assert finding.message == (
        "6 entities not cut: 2 TEXT, 1 3DFACE, 1 HATCH, 1 MTEXT, 1 POINT (layers 0, TXT)"
    )
    assert sketch.info.ignored["TEXT"] == {"TXT": 2}


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda doc, msp: None, "model space is empty"),
        (lambda doc, msp: msp.add_text("x"), "no lines, arcs"),
        (lambda doc, msp: doc.layout("Layout1").add_line((0, 0), (1, 0)), "paper space"),
        (
            lambda doc, msp: msp.add_line((0, 0), (1, 0), dxfattribs={"layer": "DEFPOINTS"}),
            "hidden",
        ),
    ],
)
def test_nothing_to_cut(draw, words):
    _, found = got(drawing(draw))
    assert found[-1].code == "empty-drawing"
    assert words in found[-1].message


# --- thread points --------------------------------------------------------------------------


@pytest.mark.parametrize("layer", ["START", "start", "Start"])
def test_thread_points(layer):
    def draw(doc, msp):
        on = {"layer": layer}
        msp.add_line((0, 0), (9, 0))
        msp.add_point((1, 2), dxfattribs=on)
        msp.add_circle((3, 4), 1.5, dxfattribs=on)
        msp.add_circle((30, 40), 5, dxfattribs=on)
        doc.blocks.new("B").add_point((1, 1), dxfattribs=on)
        msp.add_blockref("B", (10, 10), dxfattribs={"rotation": 90})

    sketch, found = got(drawing(draw))
    points = {(round(p.x, 6), round(p.y, 6)) for p in sketch.thread_points}
    assert points == {(1_000, 2_000), (3_000, 4_000), (9_000, 11_000)}
    assert len(sketch.segments) == 1
    assert codes(found) == ["start-layer"]


def test_thread_points_survive_a_layer_filter():
    def draw(doc, msp):
        msp.add_line((0, 0), (9, 0), dxfattribs={"layer": "CUT"})
        msp.add_point((1, 2), dxfattribs={"layer": "START"})

    data = drawing(draw)
    assert len(got(data, layers=("CUT",))[0].thread_points) == 1
    assert len(got(data, ignore_layers=("START",))[0].thread_points) == 0


# --- never raises, never speaks -------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"", "not-dxf"),
        (b"  \n ", "not-dxf"),
        (b"AC1015\0\0\0\0\0\0", "not-dxf"),
        (b"\x89PNG\r\n\x1a\n\0\0", "not-dxf"),
        (b"%PDF-1.4", "not-dxf"),
        (b"hello, world\n", "not-dxf"),
        (bytes(range(255, 0, -3)) + b"\0", "not-dxf"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "damaged-drawing"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(range(200)), "damaged-drawing"),
        (b"0\nSECTION\n2\nENTITIES\n0\nLINE\n", "damaged-drawing"),
    ],
)
def test_no_drawing(data, code, capfd):
    sketch, found = read(data, "part.dxf")
    assert sketch is None
    assert found[-1].code == code
    assert found[-1].severity is Severity.ERROR
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("cut", range(0, 100, 7))
def test_cut_off_anywhere(cut, capfd):
    data = drawing(draw_layers)
    sketch, found = read(data[: len(data) * cut // 100], "part.dxf")
    assert sketch is None
    assert any(d.severity is Severity.ERROR for d in found)
    assert capfd.readouterr() == ("", "")


def test_layer_names_in_any_encoding():
    def draw(doc, msp):
        doc.encoding = "cp1252"
        msp.add_line((0, 0), (9, 0), dxfattribs={"layer": "Fräsen"})

    for version in ("R2000", "R2010"):
        sketch, _ = got(drawing(draw, version))
        assert sketch.info.entities == {"LINE": {"Fräsen": 1}}
    broken = drawing(draw, "R2010").replace("Fräsen".encode(), b"Fr\xffsen")
    sketch, _ = got(broken)
    (layer,) = sketch.info.entities["LINE"]
    layer.encode()  # can be printed


def test_line_ends_and_byte_order_mark():
    data = drawing(draw_layers)
    want = rows(got(data)[0])
    text = data.replace(b"\r\n", b"\n")
    for other in (
        text.replace(b"\n", b"\r\n"),
        text.replace(b"\n", b"\r"),
        b"\xef\xbb\xbf" + text,
        text + b"rubbish after the end\n",
    ):
        assert rows(got(other)[0]) == want


def test_options_reach_the_reader():
    assert read(drawing(draw_layers), "x.dxf", DrawingReading())[0] is not None
    assert ezdxf.__version__

"""A part whose outline is held by something that is not read is refused, and decoration is not."""

from __future__ import annotations

import math

import ezdxf.render
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawings import VERSIONS, bare, drawing
from wedmcam import api
from wedmcam.diag import Severity

CORNERS = [(0, 0), (40, 0), (40, 20), (0, 20)]
ROUND = "0 CIRCLE 8 0 10 {} 20 10 30 0 40 3"


def holes(layout):
    layout.add_circle((10, 10), 3)
    layout.add_circle((30, 10), 3)


def plate(layout, at=0.0):
    layout.add_lwpolyline([(x + at, y) for x, y in CORNERS], close=True)


def compiled(data, **options):
    return api.compile(data, name="part.dxf", **({"offset": 0.1} | options))


def codes(made, severity=Severity.ERROR):
    return sorted(d.code for d in made.findings if d.severity is severity)


def refused(data, *words, **options):
    """Check that a drawing is refused for one unread outline, and return the finding."""
    made = compiled(data, **options)
    assert codes(made) == ["unsupported-entity"], made.findings
    assert made.status == 1
    assert made.data is None
    (finding,) = [d for d in made.findings if d.severity is Severity.ERROR]
    for word in words:
        assert word in finding.message, finding.message
    return finding


def accepted(data, **options):
    made = compiled(data, **options)
    assert made.ok, made.findings
    return made


def of(draw, *, outline=False, version="R2010", **more):
    """Return a drawing of two holes, what ``draw`` adds, and the outline."""

    def both(doc, msp):
        holes(msp)
        if outline:
            plate(msp)
        draw(msp)

    return drawing(both, version, **more)


# --- what can hold an outline: each by itself, beside the outline, and inside -------------------


def solid(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    points = [(x, y), (x + w, y), (x, y + h), (x + w, y + h)]
    return msp.add_solid(points, dxfattribs=attribs)


def trace(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    points = [(x, y), (x + w, y), (x, y + h), (x + w, y + h)]
    return msp.add_trace(points, dxfattribs=attribs)


def corners(x, y, w, h):
    return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]


def face(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    return msp.add_3dface(corners(x, y, w, h), dxfattribs=attribs)


def fill(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    hatch = msp.add_hatch(dxfattribs=attribs)
    hatch.paths.add_polyline_path(corners(x, y, w, h))
    return hatch


def pattern(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    hatch = msp.add_hatch(dxfattribs=attribs)
    hatch.set_pattern_fill("ANSI31")
    path = hatch.paths.add_edge_path()
    points = corners(x, y, w, h)
    for a, b in zip(points, points[1:] + points[:1], strict=True):
        path.add_line(a, b)
    return hatch


def mpolygon(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    polygon = msp.add_mpolygon(dxfattribs=attribs)
    polygon.paths.add_polyline_path(corners(x, y, w, h))
    return polygon


def wipeout(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    made = msp.add_wipeout(corners(x, y, w, h))
    made.update_dxf_attribs(attribs)
    return made


def mline(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    attribs |= {"scale_factor": 0.05, "justification": 1}
    return msp.add_mline(corners(x, y, w, h), close=True, dxfattribs=attribs)


def mesh(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    made = ezdxf.render.MeshBuilder()
    made.add_face([(*c, 0) for c in corners(x, y, w, h)])
    return made.render_mesh(msp, dxfattribs=attribs)


def polyface(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    made = ezdxf.render.MeshBuilder()
    made.add_face([(*c, 0) for c in corners(x, y, w, h)])
    return made.render_polyface(msp, dxfattribs=attribs)


def polymesh(msp, x=0.0, y=0.0, w=40.0, h=20.0, **attribs):
    net = msp.add_polymesh((3, 2), dxfattribs=attribs)
    for m in range(3):
        for n in range(2):
            net.set_mesh_vertex((m, n), (x + m * w / 2, y + n * h, 0))
    return net


HOLDERS = [
    *(solid, trace, face, fill, pattern, mpolygon, wipeout, mline, mesh, polyface, polymesh),
]
each = pytest.mark.parametrize("hold", HOLDERS, ids=lambda f: f.__name__)


@each
def test_an_outline_that_is_held_by_it_is_refused(hold):
    refused(
        of(hold), "around the contour at", "at (0.000, 0.000)" if hold is not mline else "MLINE"
    )


@each
@pytest.mark.parametrize("version", [VERSIONS[0], VERSIONS[1], VERSIONS[-1]])
def test_in_every_version(hold, version):
    if version == "R12" and hold not in (solid, trace, face, polyface, polymesh):
        pytest.skip("came later")
    refused(of(hold, version=version), units="mm")


@each
def test_in_a_binary_drawing(hold):
    refused(of(hold, binary=True))


@each
def test_it_is_decoration_where_lines_draw_its_boundary(hold):
    if hold is mline:
        pytest.skip("two lines, neither of them on the outline")
    made = accepted(of(hold, outline=True))
    assert "not-cut" in codes(made, Severity.WARNING)


@each
def test_it_could_be_a_hole_where_it_lies_in_a_contour(hold):
    data = of(lambda msp: hold(msp, 18, 8, 4, 4), outline=True)
    refused(data, "it lies in the contour at (0.000, 0.000)")
    accepted(data, offset=2.1)  # no hole that the wire could cut


@each
def test_it_is_no_outline_beside_the_part(hold):
    accepted(of(lambda msp: hold(msp, 50, 0, 4, 4), outline=True))


@each
def test_where_nothing_is_closed_it_is_the_outline(hold):
    def draw(_, msp):
        msp.add_line((60, 0), (70, 0))
        hold(msp)

    refused(drawing(draw), "no contour is closed", side="on", offset=None)


@each
def test_the_ways_out(hold):
    data = of(lambda msp: hold(msp, layer="FILL"))
    kind = hold(ezdxf.new().modelspace()).dxftype()
    made = accepted(data, ignore_types=(f"{kind.lower()}*",))
    assert [d.count for d in made.findings if d.code == "type-left-out"] == [1]
    assert accepted(data, ignore_layers=("FILL",))
    assert accepted(data, layers=("0",))


@each
def test_a_layer_that_is_off_or_frozen_holds_nothing(hold):
    for state in ("off", "freeze"):

        def draw(doc, msp, state=state):
            holes(msp)
            hold(msp, layer="FILL")
            getattr(doc.layers.add("FILL"), state)()

        accepted(drawing(draw))


@each
def test_in_paper_space_and_in_blocks_that_are_not_inserted_it_holds_nothing(hold):
    def draw(doc, msp):
        holes(msp)
        hold(doc.paperspace())
        hold(doc.blocks.new("UNUSED"))

    accepted(drawing(draw))


@each
def test_in_a_block_it_lies_where_the_block_is_inserted(hold):
    def draw(doc, msp, at=(0, 0), **attribs):
        inner = doc.blocks.new("INNER")
        hold(inner, 0, 0, 20, 40)
        doc.blocks.new("OUTER").add_blockref("INNER", (5, 0))
        msp.add_blockref("OUTER", at, dxfattribs=attribs)
        msp.add_circle((100, 100), 3)
        msp.add_lwpolyline([(90, 90), (110, 90), (110, 110), (90, 110)], close=True)

    accepted(drawing(draw))
    refused(drawing(lambda d, m: draw(d, m, (80, 80))))  # reaches up to (105, 120)
    turned = {"rotation": 90, "xscale": -2, "yscale": 2}
    refused(drawing(lambda d, m: draw(d, m, (140, 125), **turned)))
    grid = {"column_count": 4, "column_spacing": 25, "row_count": 3, "row_spacing": 45}
    refused(drawing(lambda d, m: draw(d, m, (0, 0), **grid)))


@each
def test_in_the_picture_of_a_dimension_it_is_no_outline(hold):
    def draw(doc, msp, name):
        holes(msp)
        hold(doc.blocks.new(name))
        msp.add_blockref(name, (0, 0))

    for name in ("*D1", "_ARCHTICK", "_Open30"):
        accepted(drawing(lambda doc, msp, name=name: draw(doc, msp, name)))
    refused(drawing(lambda doc, msp: draw(doc, msp, "*U1")))


@each
def test_it_is_decided_before_a_transform(hold):
    data = of(hold, outline=True)
    if hold is not mline:
        accepted(data, transforms=("translate (100, 0)", "rotate 30"))
    refused(of(hold), transforms=("translate (100, 0)",))


@each
def test_inspect_tells_and_shows_what_was_read(hold):
    seen = api.inspect(of(hold), name="part.dxf")
    assert seen.status == 1
    assert "unsupported-entity" in [d.code for d in seen.findings]
    assert seen.facts["contours"] == 2


# --- the field's cases, small -------------------------------------------------------------------


def test_field_outline_mline():
    """An MLINE without a style: where its lines are is not known."""
    mline = (
        "0 MLINE 5 A1 100 AcDbEntity 8 0 100 AcDbMline 2 STANDARD 40 1.0 70 0 71 3 72 4 73 2 "
        "10 0 20 0 30 0 210 0 220 0 230 1 " + " ".join(f"11 {x} 21 {y} 31 0" for x, y in CORNERS)
    )
    data = bare(mline, ROUND.format(10), ROUND.format(30)).replace(b"AC1009", b"AC1015")
    refused(data, "1 MLINE cannot be read yet", "its style is not in the drawing", "#A1")


def test_field_outline_solid():
    solid = "0 SOLID 8 0 10 0 20 0 30 0 11 40 21 0 31 0 12 0 22 20 32 0 13 40 23 20 33 0"
    refused(bare(solid, ROUND.format(10), ROUND.format(30)), "SOLID", "40.000 x 20.000 mm")


def test_field_outline_hatch():
    text = refused(of(lambda msp: fill(msp, layer="CUT"))).message
    assert " on layer CUT, 40.000 x 20.000 mm at (0.000, 0.000) mm: its boundary is drawn" in text


def test_field_outline_unknown():
    unknown = "0 XCAD_PROFILE 5 A1 8 EDGE 10 0 20 0 30 0"
    data = bare(unknown, ROUND.format(10), ROUND.format(30))
    finding = refused(data, "1 XCAD_PROFILE cannot be read yet (#A1)")
    assert finding.span.layer == "EDGE"
    accepted(data, ignore_types=("xcad_profile",))
    accepted(data, ignore_layers=("edge",))
    accepted(data.replace(b"\n0\n30\n0\n0\nCIRCLE", b"\n0\n30\n0\n67\n1\n0\nCIRCLE", 1))


@pytest.mark.parametrize(
    "kind", ["REGION", "BODY", "3DSOLID", "SURFACE", "PLANESURFACE", "ACAD_PROXY_ENTITY", "NEW"]
)
def test_what_has_no_extents_is_refused_wherever_it_is(kind):
    entity = f"0 {kind} 5 A1 100 AcDbEntity 8 CUT 100 AcDbSomething 70 1"
    square = " ".join(f"10 {x} 20 {y}" for x, y in CORNERS)
    square = f"0 LWPOLYLINE 5 A2 100 AcDbEntity 8 0 100 AcDbPolyline 90 4 70 1 {square}"
    data = bare(entity, square, ROUND.format(10)).replace(b"AC1009", b"AC1015")
    refused(data, kind)
    accepted(data, ignore_types=(kind,))
    accepted(data, ignore_layers=("CUT",))


def test_annotation_is_never_an_outline():
    def draw(doc, msp):
        holes(msp)
        plate(msp)
        msp.add_text("plate", height=30).set_placement((0, 0))
        msp.add_mtext("plate")
        msp.add_point((5, 5))
        msp.add_xline((0, 0), (1, 1))
        msp.add_ray((0, 0), (1, 1))
        msp.add_leader([(0, 0), (50, 50)])
        msp.add_attdef("TAG", (0, 0), "x")
        msp.add_linear_dim((0, 30), (0, 0), (40, 0)).render()
        image = doc.add_image_def("plate.png", (100, 100))
        msp.add_image(image, (-10, -10), (90, 90))

    accepted(drawing(draw))


# --- how exactly a boundary must be drawn -------------------------------------------------------


@pytest.mark.parametrize("off", [0.0, 0.007, 0.012, 0.05, -0.05])
def test_a_boundary_is_drawn_within_the_join(off):
    data = of(lambda msp: fill(msp, -off, -off, 40 + 2 * off, 20 + 2 * off), outline=True)
    if abs(off) <= 0.01:
        accepted(data)
    else:
        refused(data)
        accepted(data, join=0.1)


def test_a_boundary_that_lines_draw_in_part_says_where_not():
    def draw(msp):
        points = [(0, 0), (40, 0), (40, 20), (21, 20), (21, 19), (19, 19), (19, 20), (0, 20)]
        msp.add_hatch().paths.add_polyline_path(points)

    refused(of(draw, outline=True), "is not drawn by what is read at (21.000, 19.750)", "around")


def test_edges_of_every_kind_are_compared_with_the_curves():
    """Arcs of both senses, elliptic and spline edges: on what is read, and 0.05 mm beside it."""

    def draw(msp, off=0.0):
        msp.add_lwpolyline([(0, 0), (40, 0), (40, 20, 0, 0, 1), (0, 20, 0, 0, 0)], close=True)
        holes(msp)
        msp.add_ellipse((80, 0), (20, 5), 0.4)
        spline = msp.add_open_spline([(0, -40), (10, -20), (30, -20), (40, -40)])
        msp.add_line((40, -40), (0, -40))
        hatch = msp.add_hatch()
        path = hatch.paths.add_edge_path()
        path.add_line((0, 0), (40, 0))
        path.add_line((40, 0), (40, 20))
        path.add_arc((20, 20), 20 + off, 0, 180)
        path.add_line((0, 20), (0, 0))
        hatch.paths.add_polyline_path([(0, 0), (40, 0), (40, 20, 1), (0, 20)])
        round_ = hatch.paths.add_edge_path()
        round_.add_ellipse((80, 0), (20, 5), 0.4, 0, 360)
        for ccw in (True, False):
            ring = hatch.paths.add_edge_path()
            ring.add_arc((10, 10), 3 + off, 0, 360, ccw=ccw)
            half = hatch.paths.add_edge_path()
            half.add_arc((30, 10), 3, 90, 270, ccw=ccw)
            half.add_arc((30, 10), 3, 270, 90, ccw=ccw)
        wave = hatch.paths.add_edge_path()
        wave.add_spline(
            control_points=[p[:2] for p in spline.control_points],
            knot_values=list(spline.knots),
            degree=3,
        )
        wave.add_line((40, -40), (0, -40))

    accepted(drawing(lambda doc, msp: draw(msp)))
    refused(drawing(lambda doc, msp: draw(msp, 0.05)))


def test_a_mirrored_entity_lies_in_its_mirrored_frame():
    down = {"extrusion": (0, 0, -1)}

    def draw(msp, x):
        for hold in (solid, fill):
            hold(msp, x, **down)

    accepted(of(lambda msp: draw(msp, -40), outline=True))
    refused(of(lambda msp: draw(msp, -40)))
    accepted(of(lambda msp: draw(msp, 10), outline=True))


def test_each_path_of_a_hatch_is_judged_by_itself():
    def draw(msp, inner=True):
        hatch = fill(msp)
        for x in (10, 30):
            hatch.paths.add_edge_path().add_arc((x, 10), 3, 0, 360)
        if inner:
            hatch.paths.add_polyline_path(corners(18, 8, 4, 4), flags=16)

    accepted(of(lambda msp: draw(msp, False), outline=True))
    refused(of(draw, outline=True), "4.000 x 4.000 mm at (18.000, 8.000)")


def test_the_room_for_a_text_in_a_hatch_is_no_hole():
    def draw(msp):
        hatch = fill(msp)
        hatch.paths.add_polyline_path(corners(18, 8, 4, 4), flags=8 + 16)

    accepted(of(draw, outline=True))


def test_wide_lines_that_touch_make_an_outline_together():
    def draw(msp, gap=0.0):
        solid(msp, 0, 0, 40, 0.5)
        solid(msp, 0, 19.5, 40, 0.5)
        trace(msp, 0, 0.5, 0.5, 19)
        trace(msp, 39.5 + gap, 0.5, 0.5, 19)

    refused(of(draw), "(with 3 more that touch it)", "40.000 x 20.000 mm")


def test_a_plate_of_faces_with_its_holes_left_open_is_an_outline():
    """No face lies around a hole, and no face has one in it: together they do."""

    def draw(msp, kind):
        made = ezdxf.render.MeshBuilder()
        inner = [(8, 8), (12, 8), (12, 12), (8, 12)]
        outer = [(0, 0), (20, 0), (20, 20), (0, 20)]
        for k in range(4):
            n = (k + 1) % 4
            points = [(*p, 0) for p in (outer[k], outer[n], inner[n], inner[k])]
            made.add_face(points)
            if kind == "3dface":
                msp.add_3dface(points)
        if kind == "mesh":
            made.render_mesh(msp)
        if kind == "polyface":
            made.render_polyface(msp)
        msp.add_circle((10, 10), 1)

    for kind in ("3dface", "mesh", "polyface"):
        data = drawing(lambda doc, msp, kind=kind: draw(msp, kind))
        refused(data, "around the contour at (9.000, 9.000)")


def test_what_lies_across_a_contour_could_be_a_notch():
    refused(of(lambda msp: solid(msp, 38, 8, 4, 4), outline=True), "across the contour")


def test_many_are_said_in_one_finding():
    def draw(msp):
        for k in range(30):
            solid(msp, 1 + 1.2 * k, 16, 0.5, 0.5)

    finding = refused(of(draw, outline=True), "likewise 29 more", "and 24 more")
    assert finding.count == 30


# --- --ignore-type ------------------------------------------------------------------------------


def test_types_that_are_read_can_be_left_out():
    def draw(doc, msp):
        plate(msp)
        msp.add_circle((20, 10), 3)
        msp.add_line((0, 30), (10, 30))
        msp.add_point((-5, -5), dxfattribs={"layer": "START"})

    made = accepted(drawing(draw), ignore_types=("Line", "circle"))
    assert len(made.drawn.contours) == 1
    assert "2 entities of types left out: 1 CIRCLE, 1 LINE (layer 0)" in [
        d.message for d in made.findings
    ]
    assert len(made.drawn.sketch.thread_points) == 1
    assert made.summary["options"]["ignore_types"] == ("Line", "circle")
    made = compiled(drawing(draw), ignore_types=("*",))
    assert codes(made) == ["empty-drawing"]


def test_a_certificate_repeats_the_types_left_out():
    data = of(fill, outline=False)
    made = accepted(data, ignore_types=("HATCH",))
    options = api.options_in_mm(**{"offset": 0.1, "ignore_types": ["HATCH"]})
    assert made.options == options
    proof = api.verify(made.data, against=data, against_name="part.dxf", options=options)
    assert proof.ok, proof.findings
    proof = api.verify(made.data, against=data, against_name="part.dxf", offset=0.1)
    assert proof.status == 1
    assert "unsupported-entity" in [d.code for d in proof.findings]


def test_every_command_takes_the_types_to_leave_out(tmp_path):
    from click.testing import CliRunner

    from wedmcam.cli.main import cli

    drawn, program = tmp_path / "part.dxf", tmp_path / "part.3b"
    drawn.write_bytes(of(fill))
    certificate = ["--certificate", str(tmp_path / "part.json")]

    def status(*line, more=("--offset", "0.1")):
        done = CliRunner().invoke(cli, [*map(str, line), *more], standalone_mode=False)
        return done.return_value

    lines = [
        ("compile", drawn, "-o", program, *certificate),
        ("check", drawn),
        ("plot", drawn, "-o", tmp_path / "part.svg"),
        ("batch", tmp_path, "-o", tmp_path / "out"),
        ("compile", drawn, "-o", tmp_path / "both", "--to", "3b,iso"),
    ]
    for line in lines:
        assert status(*line) == 1, line
        assert status(*line, "--ignore-type", "hatch") == 0, line
    assert status("inspect", drawn, more=()) == 1
    assert status("inspect", drawn, "--ignore-type", "hatch", more=()) == 0
    assert status("verify", program, "--against", drawn) == 1
    assert status("verify", program, "--against", drawn, *certificate, more=()) == 0
    (tmp_path / "wedmcam.toml").write_text('ignore-type = ["HATCH"]\n')
    assert status("check", drawn) == 0


# --- a law --------------------------------------------------------------------------------------


@given(
    x=st.floats(-100, 100),
    y=st.floats(-100, 100),
    turn=st.floats(0, 360),
    size=st.floats(0.2, 20),
    mirrored=st.booleans(),
    drawn=st.booleans(),
)
@settings(max_examples=25, deadline=None)
def test_wherever_a_block_is_put_the_answer_is_the_same(x, y, turn, size, mirrored, drawn):
    """A block of two holes, a hatch and perhaps its outline, inserted in any way of one scale."""

    def draw(doc, msp):
        block = doc.blocks.new("PLATE")
        holes(block)
        fill(block)
        if drawn:
            plate(block)
        scales = {"xscale": -size if mirrored else size, "yscale": size, "rotation": turn}
        msp.add_blockref("PLATE", (x, y), dxfattribs=scales)

    made = compiled(drawing(draw), offset=0.01)
    assert ("unsupported-entity" in codes(made)) is not drawn
    if drawn:
        assert math.isclose(made.summary["contours"], 3)

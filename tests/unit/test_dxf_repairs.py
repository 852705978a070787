"""Damaged drawings: what is not cut stops nothing, and what is refused has a name and a line."""

from __future__ import annotations

import itertools

import pytest

from drawings import as_binary, bare, codes, drawing, got, rows
from wedmcam.diag import Severity, has_errors
from wedmcam.frontends.dxf import read
from wedmcam.frontends.options import DrawingReading

ORDERS = list(itertools.product((-1, 0, 1), repeat=3))
MARKS = list(itertools.product(("", "100 AcDbEntity", "100 AcDbX"), repeat=2))
FRAME = "0 LINE 5 20 8 CUT 10 0 20 0 11 40 21 0 0 LINE 5 21 8 CUT 10 40 20 0 11 0 21 20"
POLYLINE = "5 A1 | 8 CUT 62 3 | 90 3 70 1 10 0 20 0 10 9 20 0 10 9 20 9"
HATCH = (
    "5 A1 | 8 CUT 62 3 | 10 0 20 0 30 0 210 0 220 0 230 1 2 SOLID 70 1 71 0 91 1 92 1 93 3 "
    "72 1 10 0 20 0 11 9 21 0 72 1 10 9 20 0 11 9 21 9 72 1 10 9 20 9 11 0 21 0 97 1 330 2F "
    "75 1 76 1 98 0"
)
TRIANGLE = [
    (0, 0, 9_000, 0, 0, 0, 0),
    (9_000, 0, 9_000, 9_000, 0, 0, 0),
    (9_000, 9_000, 0, 0, 0, 0, 0),
]


def modern(*entities: str) -> bytes:
    return bare(*entities).replace(b"AC1009", b"AC1015")


def said(data: bytes, **options: object) -> list[str]:
    return [f"{d.severity}[{d.code}]" for d in read(data, "part.dxf", DrawingReading(**options))[1]]


# --- subclass markers -------------------------------------------------------------------------


def marked(kind: str, own: str, parts: str, order: tuple[int, ...]) -> str:
    """Return an entity of base, common and own data with markers: 0 AcDbEntity, 1 its own.

    ``order``: at the start of common, at the start of own data, and behind all.
    """
    base, common, data = parts.split("|")
    names = ("100 AcDbEntity", f"100 {own}")
    at = ["", "", ""]
    for place, name in enumerate(order):
        if name >= 0:
            at[place] += names[name] + " "
    return f"0 {kind} {base} {at[0]} {common} {at[1]} {data} {at[2]}"


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("binary", [False, True])
def test_field_lwpolyline_own_marker(order, binary):
    data = modern(marked("LWPOLYLINE", "AcDbPolyline", POLYLINE, order))
    sketch, found = got(as_binary(data) if binary else data)
    assert rows(sketch) == TRIANGLE
    assert sketch.info.entities == {"LWPOLYLINE": {"CUT": 1}}
    right = order == (0, 1, -1)
    assert codes(found) == ([] if right else ["repaired-drawing"])
    assert right or "1 LWPOLYLINE" in found[0].message


@pytest.mark.parametrize("order", ORDERS)
def test_field_hatch_without_markers(order):
    data = modern(FRAME, marked("HATCH", "AcDbHatch", HATCH, order))
    sketch, found = got(data)
    assert len(sketch.segments) == 2
    assert len(sketch.unread.segments) == 3  # its boundary is known
    assert {"not-cut"} <= set(codes(found)) <= {"not-cut", "repaired-drawing"}


def test_vertices_before_their_marker_are_read():
    # ezdxf takes what stands behind the second marker for the vertices.
    entity = (
        "0 LWPOLYLINE 5 A1 100 AcDbEntity 8 CUT 90 3 70 1 10 0 20 0 100 AcDbPolyline "
        "10 9 20 0 10 9 20 9"
    )
    sketch, found = got(modern(entity))
    assert rows(sketch) == TRIANGLE
    assert codes(found) == ["repaired-drawing"]


def test_markers_in_a_block_and_extended_data():
    inner = marked("LWPOLYLINE", "AcDbPolyline", POLYLINE, (1, -1, -1)) + " 1001 ACAD 1000 100"
    blocks = (
        "0 SECTION 2 BLOCKS 0 BLOCK 8 0 2 B 70 0 10 0 20 0 30 0 "
        f"{inner} 0 ENDBLK 8 0 0 ENDSEC 0 SECTION 2 ENTITIES"
    )
    text = modern("0 INSERT 5 B1 8 0 2 B 10 0 20 0").decode()
    head = "  0\nSECTION\n  2\nENTITIES\n"
    data = text.replace(head, "\n".join(blocks.split()) + "\n").encode()
    sketch, found = got(data)
    assert rows(sketch) == TRIANGLE
    assert codes(found) == ["repaired-drawing"]


@pytest.mark.parametrize(
    "entity",
    [
        "0 LINE 5 A1 {} 8 CUT {} 10 0 20 0 11 9 21 0",
        "0 CIRCLE 5 A1 {} 8 CUT {} 10 0 20 0 40 3",
        "0 ARC 5 A1 {} 8 CUT {} 10 0 20 0 40 3 50 0 51 90",
        "0 ELLIPSE 5 A1 {} 8 CUT {} 10 0 20 0 30 0 11 9 21 0 31 0 40 0.5 41 0 42 6.283185307",
        "0 SPLINE 5 A {} 8 CUT {} 70 8 71 1 72 4 73 2 40 0 40 0 40 1 40 1 10 0 20 0 10 9 20 9",
    ],
)
@pytest.mark.parametrize("marks", MARKS)
def test_no_marker_changes_what_is_read(entity, marks):
    kind = entity.split()[1]
    right = {"SPLINE": "AcDbSpline", "LINE": "AcDbLine", "CIRCLE": "AcDbCircle"}.get(kind, "AcDbX")
    want, _ = got(modern(entity.format("100 AcDbEntity", f"100 {right}")))
    sketch, found = got(modern(entity.format(*marks)))
    assert rows(sketch) == rows(want)
    assert sketch.info.entities == {kind: {"CUT": 1}}
    assert not has_errors(found)


# --- handles ----------------------------------------------------------------------------------


@pytest.mark.parametrize("handle", ["0", "00", "XYZ", "-1"])
@pytest.mark.parametrize("binary", [False, True])
def test_field_handle_0(handle, binary):
    entities = [f"0 CIRCLE 5 {handle} 8 0 10 {x} 20 0 40 1" for x in (0, 10, 20)]
    data = modern(*entities)
    sketch, found = got(as_binary(data) if binary else data)
    assert len(sketch.segments) == 3
    assert codes(found) == ["repaired-drawing"]
    assert found[0].severity is Severity.NOTE
    assert handle in found[0].message


# --- what is not cut stops nothing ------------------------------------------------------------

NOT_CUT = {
    "text": "0 TEXT 5 A1 8 NOTES 10 1 20 2 40 x 1 A",
    "mtext": "0 MTEXT 5 A1 8 NOTES 10 1 11 3 40 2 1 A",
    "dimension": "0 DIMENSION 5 A1 8 NOTES 2 *D1 10 x 20 2 70 0",
    "image": "0 IMAGE 5 A1 100 AcDbEntity 8 NOTES 100 AcDbRasterImage 10 x 20 0",
}


@pytest.mark.parametrize("entity", NOT_CUT.values(), ids=NOT_CUT)
@pytest.mark.parametrize("version", [b"AC1009", b"AC1015"])
def test_what_is_not_cut_never_stops_the_reading(entity, version):
    data = bare(FRAME, entity).replace(b"AC1009", version)
    sketch, found = got(data)
    assert len(sketch.segments) == 2
    assert not has_errors(found)
    kind = entity.split()[1]
    assert any(d.code == "not-cut" and kind in d.message for d in found), found
    (repaired,) = [d for d in found if d.severity is Severity.WARNING and "damaged" in d.message]
    assert f"{kind} #A1" in repaired.message
    assert data.decode().split("\n")[repaired.span.line - 1].strip()


def test_a_boundary_that_is_damaged_could_be_an_outline():
    _, found = read(modern(FRAME, "0 HATCH 5 A1 8 CUT 91 x"), "part.dxf")
    (wrong,) = [d for d in found if d.severity is Severity.ERROR]
    assert wrong.code == "unsupported-entity"
    assert "its boundary is not known" in wrong.message
    assert said(modern(FRAME, "0 HATCH 5 A1 8 CUT 91 x"), ignore_types=("HATCH",))[-1] == (
        "note[type-left-out]"
    )
    assert not has_errors(
        read(modern(FRAME, "0 HATCH 5 A1 8 NO 91 x"), "x", DrawingReading(ignore_layers=("NO",)))[1]
    )


@pytest.mark.parametrize(
    ("entity", "word"),
    [
        ("0 LINE 5 A1 8 CUT 10 2,5 20 0 11 80 21 40", "comma"),
        ("0 CIRCLE 5 A1 8 CUT 10 2 20 0 40 1O", "1O"),
        ("0 LWPOLYLINE 5 A1 100 AcDbEntity 8 CUT 100 AcDbPolyline 90 1 70 y 10 0 20 0", "whole"),
        ("0 ARC 5 A1 8 CUT 10 0 40 1 50 0 51 90", "y coordinate"),
        (
            "0 POLYLINE 5 A1 8 CUT 66 1 70 1 0 VERTEX 5 A2 8 CUT 10 0 20 x "
            "0 VERTEX 5 A3 8 CUT 10 9 20 0 0 SEQEND 5 A4 8 CUT",
            '"x"',
        ),
    ],
)
def test_what_would_be_cut_is_refused_by_name_and_line(entity, word):
    data = modern(FRAME, entity)
    sketch, found = got(data)
    assert len(sketch.segments) == 2  # the rest can be looked at
    (wrong,) = [d for d in found if d.code == "damaged-drawing"]
    assert f"{entity.split()[1]} on layer CUT (#A1)" in wrong.message
    assert word in wrong.message
    assert wrong.span.line > data.decode().split("\n").index("ENTITIES")
    # On a layer that is left out it is no matter.
    assert not has_errors(
        read(
            data.replace(b"\nCUT\n", b"\nNO\n", 99).replace(b"\nNO\n", b"\nCUT\n", 2),
            "x",
            DrawingReading(ignore_layers=("NO",)),
        )[1]
    )


OBJECTS = {
    "a dictionary": "0 DICTIONARY 5 C 100 AcDbDictionary 3 A 350",
    "no pairs": "0 DICTIONARY 5",
    "a number": "0 XRECORD 5 1F 40 abc",
    "nothing known": "0 ACDBX 5 0 330",
}


@pytest.mark.parametrize("objects", OBJECTS.values(), ids=OBJECTS)
def test_damaged_objects_stop_nothing(objects):
    section = "  0\nSECTION\n  2\nOBJECTS\n" + "\n".join(objects.split()) + "\n  0\nENDSEC\n"
    text = modern(FRAME).decode()
    for data in (
        text.replace("  0\nEOF\n", section + "  0\nEOF\n"),
        text.replace("  0\nEOF\n", section + "  0\nEOF\n\x1a"),
        text.replace("  0\nSECTION\n  2\nENTITIES", section + "  0\nSECTION\n  2\nENTITIES"),
    ):
        sketch, found = got(data.encode())
        assert len(sketch.segments) == 2
        assert not has_errors(found)


def test_nothing_is_lost_where_a_head_or_an_end_is_missing():
    whole = modern(FRAME, "0 TEXT 5 A1 8 CUT 10 1 20 2 40 2 1 A", FRAME.replace("5 2", "5 3"))
    lines = whole.decode().split("\n")
    begin = lines.index("ENTITIES") - 1
    want = rows(got(whole)[0])
    for k in range(begin - 1, len(lines) - 5, 2):
        pair = [w.strip() for w in lines[k : k + 2]]
        if pair[0] not in ("0", "2"):
            continue
        cut = "\n".join(lines[:k] + lines[k + 2 :]).encode()
        sketch, found = read(cut, "part.dxf")
        same = sketch is not None and rows(sketch) == want
        assert same or has_errors(found), (k, pair)


def test_a_layer_whose_state_is_damaged_is_no_guess():
    table = "0 TABLE 2 LAYER 70 1 0 LAYER 2 CUT 70 x 62 7 6 X 0 ENDTAB"
    section = "  0\nSECTION\n  2\nTABLES\n" + "\n".join(table.split()) + "\n  0\nENDSEC\n"
    data = (
        modern(FRAME).decode().replace("  0\nSECTION\n  2\nENT", section + "  0\nSECTION\n  2\nENT")
    )
    sketch, found = read(data.encode(), "part.dxf")
    assert sketch is None
    assert "layer's state" in found[-1].message


@pytest.mark.parametrize("tail", [b"\0", b"\0abc", b"junk\n", b"\x1a\0\0"])
def test_nul_and_junk_behind_the_end_are_no_reason_to_refuse(tail):
    sketch, found = got(modern(FRAME) + tail)
    assert len(sketch.segments) == 2
    assert all(d.severity is Severity.NOTE for d in found)


def test_one_nul_in_a_text_is_no_reason_to_refuse():
    data = modern(FRAME, "0 TEXT 5 A1 8 NOTES 10 1 20 2 40 2 1 A-B").replace(b"A-B", b"A\0B")
    assert len(got(data)[0].segments) == 2


def test_a_bulge_before_the_first_vertex_is_said():
    entity = POLYLINE.replace("|", "").replace("70 1", "70 1 42 0.5")
    _, found = got(
        modern(f"0 LWPOLYLINE 100 AcDbEntity {entity[:14]} 100 AcDbPolyline {entity[14:]}")
    )
    assert "misplaced-group" in codes(found)


@pytest.mark.parametrize("version", ["R2000", "R2018"])
def test_a_good_drawing_says_nothing(version):
    def draw(doc, msp):
        msp.add_lwpolyline([(0, 0), (9, 0), (9, 9)], close=True)
        msp.add_hatch().paths.add_polyline_path([(0, 0), (9, 0), (9, 9)])
        msp.add_mtext("x")
        msp.add_spline([(0, 0), (1, 2), (3, 0)])

    for binary in (False, True):
        assert "repaired-drawing" not in codes(got(drawing(draw, version, binary=binary))[1])

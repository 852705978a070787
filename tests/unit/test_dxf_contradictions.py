"""What a drawing says twice, counts wrongly, or says behind its end: an error or a warning."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawings import as_binary, bare, codes, drawing, got
from wedmcam.diag import ByteSpan, Severity, TextSpan
from wedmcam.frontends.dxf import read
from wedmcam.frontends.dxf.contradictions import AT_POINT, SINGLE
from wedmcam.frontends.dxf.tags import tags_of_binary, tags_of_text
from wedmcam.frontends.options import DrawingReading

RING = "0 CIRCLE 8 0 10 20 20 10 40 5"
OUTLINE = (
    "0 LINE 8 0 10 0 20 0 11 40 21 0 0 LINE 8 0 10 40 20 0 11 40 21 20 "
    "0 LINE 8 0 10 40 20 20 11 0 21 20 0 LINE 8 0 10 0 20 20 11 0 21 0"
)
SQUARE = (
    "0 LWPOLYLINE 5 2F 100 AcDbEntity 8 CUT 100 AcDbPolyline 90 {count} 70 1 "
    "10 0 20 0 10 9 20 0 10 9 20 9 10 0 20 9"
)
SPLINE = (
    "0 SPLINE 100 AcDbEntity 8 CUT 100 AcDbSpline 70 8 71 3 72 8 73 4 74 0 "
    "40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 10 0 20 5 10 9 20 0 10 9 20 9"
)


def lines(text: str) -> str:
    return "\n".join(text.split()) + "\n"


def with_blocks(blocks: str, *entities: str, version: str = "AC1009") -> bytes:
    """Return a drawing with a BLOCKS section."""
    data = bare(*entities).decode().replace("AC1009", version)
    section = f"  0\nSECTION\n  2\nBLOCKS\n{lines(blocks)}  0\nENDSEC\n"
    return data.replace(
        "  0\nSECTION\n  2\nENTITIES", section + "  0\nSECTION\n  2\nENTITIES"
    ).encode()


def block(name: str, entities: str = RING) -> str:
    return f"0 BLOCK 8 0 2 {name} 70 0 10 0 20 0 {entities} 0 ENDBLK 8 0"


def insert(name: str, more: str = "") -> str:
    return f"0 INSERT 8 0 2 {name} 10 0 20 0 {more}"


def said(data: bytes, **options) -> list[str]:
    found = read(data, "part.dxf", DrawingReading(**{"units": "mm", **options}))[1]
    skip = ("repaired-drawing", "units-overridden", "approximated")
    return [f"{d.severity}[{d.code}]" for d in found if d.code not in skip]


def line_of(data: bytes, finding) -> str:
    """Return the line that a finding points at."""
    assert isinstance(finding.span, TextSpan)
    return data.decode().split("\n")[finding.span.line - 1].strip()


# --- a value twice ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "entity",
    [
        "0 CIRCLE 8 0 10 0 20 0 40 5 40 7",
        "0 CIRCLE 8 0 10 0 20 0 10 1 20 0 40 7",
        "0 LINE 8 0 10 0 20 0 11 4 21 0 11 7 21 0",
        "0 ARC 8 0 10 0 20 0 40 5 50 0 51 90 51 180",
        "0 ELLIPSE 8 0 10 0 20 0 11 5 21 0 40 0.5 40 0.7 41 0 42 6.283185307",
        "0 POINT 8 START 10 0 20 0 10 1 20 1",
        "0 LWPOLYLINE 100 AcDbEntity 8 0 100 AcDbPolyline 90 2 70 0 70 1 10 0 20 0 10 9 20 0",
        "0 LWPOLYLINE 100 AcDbEntity 8 0 100 AcDbPolyline 90 2 70 0 10 0 20 0 42 1 42 0 10 9 20 0",
        "0 POLYLINE 8 0 66 1 70 0 70 1 0 VERTEX 8 0 10 0 20 0 0 VERTEX 8 0 10 9 20 0 0 SEQEND 8 0",
        "0 POLYLINE 8 0 66 1 0 VERTEX 8 0 10 0 20 0 42 1 42 2 0 VERTEX 8 0 10 9 20 0 0 SEQEND 8 0",
        SPLINE.replace("71 3", "71 3 71 2"),
        "0 CIRCLE 8 0 10 0 20 0 40 5 210 0 220 0 230 1 210 0 220 0 230 -1",
    ],
)
@pytest.mark.parametrize("binary", [False, True])
def test_field_dup_group(entity, binary):
    data = bare(OUTLINE, entity).replace(b"AC1009", b"AC1015")
    found = read(as_binary(data) if binary else data, "part.dxf")[1]
    (finding,) = [d for d in found if d.code == "stated-twice"]
    assert finding.severity is Severity.ERROR
    assert entity.split()[1] in finding.message or "VERTEX" in finding.message
    assert isinstance(finding.span, ByteSpan if binary else TextSpan)


def test_field_dup_group_names_both_values_and_the_line():
    data = bare(OUTLINE, "0 CIRCLE 8 0 10 0 20 0 40 5 40 7")
    (finding,) = read(data, "part.dxf")[1]
    assert "1 CIRCLE with group 40 twice: 5 and 7" in finding.message
    assert line_of(data, finding) == "7"


def test_the_same_value_twice_is_a_note():
    assert said(bare("0 CIRCLE 8 0 10 0 20 0 40 5 40 5.000")) == ["note[stated-twice]"]
    assert said(bare("0 CIRCLE 8 cut 8 CUT 10 0 20 0 40 5")) == ["note[stated-twice]"]


@pytest.mark.parametrize(
    "entity",
    [
        "0 LWPOLYLINE 100 AcDbEntity 8 0 100 AcDbPolyline 90 3 70 1 "
        "10 0 20 0 40 0 41 0 42 1 10 9 20 0 40 0 41 0 42 1 10 9 20 9",
        SPLINE,
        SPLINE.replace("74 0", "74 2") + " 11 0 21 0 11 9 21 9 12 1 22 0 13 0 23 1",
        RING + " 1001 ACAD 1040 5 1040 7 1070 1",
        RING + " 1001 ACAD 1040 5 40 7",
        RING + " 102 {OTHER 40 7 8 X 102 }",
        RING + " 101 Embedded_Object 40 7 10 1 20 1",
        RING + " 62 1 62 2",
        "0 TEXT 8 0 10 0 20 0 40 5 1 A 40 7 " + RING,
    ],
)
def test_what_may_be_there_twice(entity):
    data = bare(entity).replace(b"AC1009", b"AC1015")
    assert "stated-twice" not in codes(read(data, "part.dxf")[1])
    assert "stated-twice" not in codes(read(as_binary(data), "part.dxf")[1])


def test_what_is_not_read_is_a_warning():
    twice = "0 CIRCLE 8 {} 10 90 20 0 40 5 40 7"
    assert said(bare(RING, twice.format("NOTES")), ignore_layers=("NOTES",)) == [
        "warning[stated-twice]",
        "note[layer-left-out]",
    ]
    assert said(bare(RING, twice.format("0") + " 67 1"))[0] == "warning[stated-twice]"
    unused = with_blocks(block("A", twice.format("0")), RING)
    assert said(unused) == ["warning[stated-twice]"]
    used = with_blocks(block("A", twice.format("0")), RING, insert("a"))
    assert said(used) == ["error[stated-twice]"]


def test_what_a_type_that_is_left_out_says_twice_is_a_warning():
    _, found = got(bare(f"{RING} 40 7", OUTLINE), ignore_types=("circle",))
    assert [d.severity for d in found if d.code == "stated-twice"] == [Severity.WARNING]


def test_many_are_one_finding_with_the_first_places():
    twice = ["0 CIRCLE 8 0 10 0 20 0 40 5 40 7"] * 9
    (finding,) = [d for d in read(bare(*twice), "part.dxf")[1] if d.code == "stated-twice"]
    assert finding.count == 9
    assert finding.message.endswith("and 4 more)")


@pytest.mark.parametrize("binary", [False, True])
def test_units_twice_in_the_header(binary):
    def data(*values):
        header = "".join(f"  9\n$INSUNITS\n 70\n{v}\n" for v in values)
        made = bare(RING, header=header)
        return as_binary(made) if binary else made

    assert said(data(4, 1), units=None)[0] == "error[stated-twice]"
    assert said(data(4, 1), units="mm") == ["warning[stated-twice]"]
    assert said(data(4, 1), units="mm", fill_in_units=True)[0] == "error[stated-twice]"
    assert said(data(4, 4), units=None) == ["note[stated-twice]"]


def test_units_with_two_values():
    data = bare(RING, header="  9\n$INSUNITS\n 70\n4\n999\nmm\n 70\n1\n")
    assert said(data, units=None)[0] == "error[stated-twice]"


def test_a_layer_twice_matters_where_one_of_them_is_not_read():
    data = bare("0 CIRCLE 8 A 8 B 10 20 20 10 40 5")
    assert said(data) == ["warning[stated-twice]"]
    assert "error[stated-twice]" in said(data, layers=("A",))


@pytest.mark.parametrize(("first", "second", "bad"), [(7, -7, True), (7, 3, False)])
def test_a_layer_that_is_hidden_by_one_of_two_entries(first, second, bad):
    layer = "0 LAYER 2 {} 70 0 62 {} 6 CONTINUOUS"
    table = f"0 TABLE 2 LAYER 70 2 {layer.format('CUT', first)} {layer.format('Cut', second)}"
    section = f"  0\nSECTION\n  2\nTABLES\n{lines(table)}  0\nENDTAB\n  0\nENDSEC\n"
    data = bare(RING.replace("8 0", "8 CUT")).decode()
    data = data.replace("  0\nSECTION\n  2\nENTITIES", section + "  0\nSECTION\n  2\nENTITIES")
    assert ("error[stated-twice]" in said(data.encode())) is bad


def test_two_drawings_in_one_file_without_an_end_between():
    one = bare(RING).decode()
    body = one[: one.index("  0\nEOF")]
    data = (body + body + "  0\nEOF\n").encode()
    assert "error[stated-twice]" in said(data)
    assert any("section ENTITIES is there twice" in d.message for d in read(data, "part.dxf")[1])


# --- counts -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("count", "bad"), [(9, True), (4, False), (3, True), (0, True)])
@pytest.mark.parametrize("binary", [False, True])
def test_field_lw_count_more(count, bad, binary):
    data = bare(SQUARE.format(count=count)).replace(b"AC1009", b"AC1015")
    if binary:
        data = as_binary(data)
    assert said(data) == ["error[stated-count]"] * bad


def test_field_lw_count_more_says_both_counts_and_the_line():
    data = bare(SQUARE.format(count=9)).replace(b"AC1009", b"AC1015")
    (finding,) = [d for d in read(data, "part.dxf")[1] if d.code == "stated-count"]
    assert (
        "1 LWPOLYLINE with another number of vertices than stated: 9 stated, 4 there"
        in finding.message
    )
    assert "#2F" in finding.message
    assert line_of(data, finding) == "9"


@pytest.mark.parametrize(
    ("old", "new", "bad"),
    [
        ("72 8", "72 9", True),
        ("73 4", "73 5", True),
        ("73 4", "73 3", True),
        ("74 0", "74 2", True),
        ("72 8 73 4 74 0", "", False),
        ("74 0", "", False),
    ],
)
def test_counts_of_a_spline(old, new, bad):
    data = bare(SPLINE.replace(old, new)).replace(b"AC1009", b"AC1015")
    assert ("error[stated-count]" in said(data)) is bad


def test_a_missing_count_is_no_disagreement():
    entity = SQUARE.format(count=4).replace("90 4 ", "")
    assert said(bare(entity).replace(b"AC1009", b"AC1015")) == []


# --- blocks -----------------------------------------------------------------------------------


@pytest.mark.parametrize("second", ["PIECE", "Piece"])
@pytest.mark.parametrize("version", ["AC1009", "AC1015"])
@pytest.mark.parametrize("binary", [False, True])
def test_field_block_name_twice(second, version, binary):
    data = with_blocks(
        block("PIECE", OUTLINE) + " " + block(second), insert("piece"), version=version
    )
    found = read(as_binary(data) if binary else data, "part.dxf")[1]
    (finding,) = [d for d in found if d.severity is Severity.ERROR]
    assert finding.code == "block-twice"
    assert "block PIECE is defined twice" in finding.message
    assert ("case" in finding.message) is (second != "PIECE")


def test_a_block_twice_matters_where_something_of_it_is_cut():
    twice = block("A") + " " + block("A", OUTLINE)
    nested = twice + " " + block("B", insert("a"))
    assert said(with_blocks(twice, RING)) == ["warning[block-twice]"]
    assert said(with_blocks(nested, RING)) == ["warning[block-twice]"]
    assert said(with_blocks(nested, RING, insert("B"))) == ["error[block-twice]"]
    left_out = with_blocks(twice, RING, insert("A").replace("8 0", "8 NOTES"))
    assert said(left_out, ignore_layers=("NOTES",))[0] == "warning[block-twice]"


def test_case_makes_no_difference_in_names_of_blocks():
    sketch, found = got(with_blocks(block("PIECE"), insert("Piece")))
    assert len(sketch.segments) == 1
    assert not found


# --- behind the end ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "tail", ["  0\nEOF\n", "", "\n", "\n\n \n", "\x1a", "\0\0\0\0", "\n\x1a\0\0\n"]
)
@pytest.mark.parametrize("binary", [False, True])
def test_padding_behind_the_end_is_nothing(tail, binary):
    if binary and "EOF" in tail:
        return
    data = as_binary(bare(RING)) if binary else bare(RING)
    assert said(data + tail.encode()) == []


@pytest.mark.parametrize("binary", [False, True])
def test_data_behind_the_end(binary):
    data = as_binary(bare(RING)) if binary else bare(RING)
    found = read(data + b"\nhello\nthere\n", "part.dxf")[1]
    (finding,) = found
    assert f"{finding.severity}[{finding.code}]" == "note[behind-end]"
    assert ("12 bytes" if binary else "2 lines") in finding.message or binary


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("gap", [b"", b"\x1a", b"\n"])
def test_a_second_drawing_behind_the_end(binary, gap):
    first, second = bare(RING), bare(OUTLINE)
    if binary:
        first, second = as_binary(first), as_binary(second)
    sketch, (finding,) = got(first + gap + second)
    assert sketch.info.entities == {"CIRCLE": {"0": 1}}
    assert f"{finding.severity}[{finding.code}]" == "warning[behind-end]"
    assert "a second drawing" in finding.message
    if not binary and not gap.strip():
        assert finding.span.line == first.count(b"\n") + 1 + len(gap)


def test_an_end_mark_with_blanks_is_one():
    data = bare(RING).replace(b"EOF", b" EOF ") + bare(OUTLINE)
    sketch, found = got(data)
    assert sketch.info.entities == {"CIRCLE": {"0": 1}}
    assert codes(found) == ["behind-end"]


# --- columns and rows, scale ------------------------------------------------------------------


@pytest.mark.parametrize("counts", ["70 0", "70 0 44 5", "71 0 45 5", "70 0 71 0 44 5 45 5"])
@pytest.mark.parametrize("nested", [False, True])
def test_field_insert_columns_0(counts, nested):
    blocks = block("A") + " " + block("B", insert("A", counts))
    entity = insert("B") if nested else insert("A", counts)
    sketch, found = got(with_blocks(blocks, OUTLINE, entity))
    assert len(sketch.segments) == 5
    assert not found


@pytest.mark.parametrize("counts", ["70 -5 71 -5 44 3 45 3", "70 -1", "71 -2 45 3"])
@pytest.mark.parametrize("nested", [False, True])
def test_field_m_neg_plus(counts, nested):
    blocks = block("A") + " " + block("B", insert("A", counts))
    entity = insert("B") if nested else insert("A", counts)
    data = with_blocks(blocks, OUTLINE, entity)
    assert said(data) == ["error[insert-count]"]
    assert "1 INSERT of block A with " in read(data, "part.dxf")[1][-1].message
    assert said(with_blocks(blocks, entity)) == ["error[insert-count]"]


def test_a_negative_count_of_what_is_left_out():
    data = with_blocks(block("A"), OUTLINE, insert("A", "70 -5").replace("8 0", "8 NOTES", 1))
    assert said(data, ignore_layers=("NOTES",)) == []


@pytest.mark.parametrize("scale", ["41 0", "42 0", "41 0 42 0 43 0", "41 1e-300 42 1", "42 -0.0"])
@pytest.mark.parametrize("nested", [False, True])
def test_field_insert_scale0_only(scale, nested):
    blocks = block("A") + " " + block("B", insert("A"))
    data = with_blocks(blocks, OUTLINE, insert("B" if nested else "A", scale))
    sketch, found = got(data)
    assert len(sketch.segments) == 4
    assert [f"{d.severity}[{d.code}]" for d in found] == ["warning[scale-zero]"]
    assert "what is in the block is not cut" in found[0].message
    found = got(with_blocks(blocks, insert("B" if nested else "A", scale)))[1]
    assert codes(found) == ["scale-zero", "empty-drawing"]
    assert "scale of 0" in found[1].message


# --- the look itself --------------------------------------------------------------------------


def test_drawings_of_all_kinds_say_nothing_twice():
    def draw(doc, msp):
        inner = doc.blocks.new("B")
        inner.add_circle((1, 1), 5)
        msp.add_blockref("B", (10, 20)).add_attrib("NAME", "x")
        msp.add_blockref("B", (10, 20), dxfattribs={"column_count": 2, "column_spacing": 30})
        msp.add_lwpolyline([(0, 0, 0, 0, 1), (9, 0, 1, 1, 0), (9, 9, 0, 0, 0)], close=True)
        msp.add_spline([(0, 0), (5, 5), (9, 0)])
        msp.add_open_spline([(0, 0), (5, 5), (9, 0), (10, 9)])
        msp.add_ellipse((0, 0), (9, 0), 0.5)
        msp.add_polyline2d([(0, 0), (9, 0), (9, 9)])
        msp.add_text("hello")
        msp.add_hatch().paths.add_polyline_path([(0, 0), (9, 0), (9, 9)])

    for version in ("R2000", "R2010", "R2018"):
        for binary in (False, True):
            found = got(drawing(draw, version, binary=binary))[1]
            ours = {"stated-twice", "stated-count", "block-twice", "behind-end"}
            assert ours.isdisjoint(codes(found)), found


@given(st.binary(max_size=400))
def test_tags_of_any_bytes(data):
    tags_of_binary(b"AutoCAD Binary DXF\r\n\x1a\x00" + data, "a")
    tags_of_text(data.decode("latin-1"), "a")


KINDS = sorted(set(SINGLE) - {"BLOCK", "VERTEX", "INSERT"})


@given(st.data())
def test_a_value_twice_is_found_wherever_it_stands(data):
    """Whatever the entity, a code that may stand once and stands twice is found."""
    kind = data.draw(st.sampled_from(KINDS))
    tags = [(8, "0")]
    for code in SINGLE[kind]:
        tags.append((code, "1"))
    if kind in AT_POINT:
        tags += [(10, "0"), (20, "0"), (10, "1"), (20, "1")]
    code = data.draw(st.sampled_from([8, *SINGLE[kind], *AT_POINT.get(kind, ())[:1]]))
    at = next(k for k, tag in enumerate(tags) if tag[0] == code)
    tags.insert(at + 1, (code, "2"))
    text = "0\nSECTION\n2\nENTITIES\n0\n" + kind + "\n"
    text += "".join(f"{c}\n{v}\n" for c, v in tags) + "0\nENDSEC\n0\nEOF\n"
    from wedmcam.frontends.dxf.contradictions import Reading, contradictions

    reading = Reading((), lambda layer: True, lambda kind, layer: False, True)
    found = contradictions(tags_of_text(text, "a"), reading)
    twice = [d for d in found if d.code == "stated-twice"]
    assert [d.message.split(" twice")[0] for d in twice] == [f"1 {kind} with group {code}"]


def test_many_with_other_figures_are_one_finding():
    entities = [f"0 CIRCLE 8 0 10 0 20 0 40 5 40 {k}" for k in range(6, 60)]
    (finding,) = [d for d in read(bare(*entities), "part.dxf")[1] if d.code == "stated-twice"]
    assert finding.message.startswith("54 CIRCLE with group 40 twice: 5 and 6 in the first (line")


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize(
    ("entity", "missing"),
    [
        ("0 CIRCLE 8 0 10 0 20 0", "40"),
        ("0 CIRCLE 8 0 40 5", "10 and 20"),
        ("0 ARC 8 0 10 0 20 0 40 5 50 0", "51"),
        ("0 LINE 8 0 10 1 20 1", "11 and 21"),
        ("0 ELLIPSE 8 0 10 0 20 0 11 5 21 0 41 0 42 3", "40"),
        ("0 ELLIPSE 8 0 10 0 20 0 11 5 21 0 40 0.5 41 0", "42"),
    ],
)
def test_a_value_that_an_entity_cannot_be_without(entity, missing, binary):
    data = bare(entity, OUTLINE).replace(b"AC1009", b"AC1015")
    _, found = read(as_binary(data) if binary else data, "part.dxf")
    (one,) = [d for d in found if d.code == "not-stated"]
    assert one.severity is Severity.ERROR
    assert f"without group {missing}:" in one.message


def test_defaults_of_the_format_stay():
    ellipse = "0 ELLIPSE 8 0 10 20 20 10 30 0 11 5 21 0 31 0 40 0.5"
    data = bare(ellipse, OUTLINE).replace(b"AC1009", b"AC1015")
    assert "not-stated" not in codes(read(data, "part.dxf")[1])


def test_a_vertex_of_no_spline_is_no_control_point():
    points = "".join(
        f"0 VERTEX 8 0 10 {x} 20 {y} 70 {flag} "
        for x, y, flag in ((0, 0, 0), (9, 0, 16), (9, 9, 0), (0, 9, 0))
    )
    sketch, _ = got(bare(f"0 POLYLINE 8 0 66 1 70 1 {points} 0 SEQEND 8 0"))
    assert len(sketch.segments) == 4

"""The traps of the file itself: each was met in real drawings."""

import pytest

from drawings import bare, codes, drawing, got, rows
from wedmcam.frontends.dxf import read

LWPOLYLINE = (
    "0 LWPOLYLINE 5 2F 100 AcDbEntity 8 CUT 100 AcDbPolyline 90 3 70 1 "
    "10 0 20 0 10 9 20 0 10 9 20 9"
)
UNMARKED = "0 LWPOLYLINE 5 2F 8 CUT 90 3 70 1 10 0 20 0 10 9 20 0 10 9 20 9"
TRIANGLE = [
    (0, 0, 9_000, 0, 0, 0, 0),
    (9_000, 0, 9_000, 9_000, 0, 0, 0),
    (9_000, 9_000, 0, 0, 0, 0, 0),
]


@pytest.mark.parametrize("entity", [LWPOLYLINE, UNMARKED])
@pytest.mark.parametrize("header", ["none", "no version", "old version", "new version"])
def test_no_version_and_no_markers(header, entity):
    # Taken for R12 the polyline would lose its layer and its closed flag.
    data = bare(entity).decode()
    version = "  9\n$ACADVER\n  1\nAC1009\n"
    assert version in data
    if header == "none":
        data = data[data.index("  0\nSECTION\n  2\nENTITIES") :]
    elif header == "no version":
        data = data.replace(version, "")
    elif header == "new version":
        data = data.replace("AC1009", "AC1015")
    sketch, found = got(data.encode(), units="mm")
    assert rows(sketch) == TRIANGLE
    assert sketch.info.entities == {"LWPOLYLINE": {"CUT": 1}}
    repairs = (header != "new version") + (entity is UNMARKED)
    assert codes(found) == ["repaired-drawing"] * repairs


def test_units_come_from_the_raw_header():
    # Without a HEADER the reader would report metres.
    data = bare("0 LINE 8 0 10 0 20 0 11 80 21 40").decode()
    data = data[data.index("  0\nSECTION\n  2\nENTITIES") :]
    sketch, found = read(data.encode(), "part.dxf")
    assert sketch is None
    assert codes(found) == ["no-units"]
    assert "80.000 x 40.000 drawing units" in found[0].message


def test_one_handle_for_all():
    # An old export gives every entity the same handle; none of them may vanish.
    entities = [f"0 LINE 5 1 8 0 10 {k} 20 0 11 {k} 21 9" for k in range(7)]
    sketch, found = got(bare(*entities))
    assert len(sketch.segments) == 7
    (said,) = found
    assert said.code == "repaired-drawing"
    assert "handle 1 is there 7 times" in said.message


def test_polyline_that_repeats_a_vertex_handle():
    vertices = " ".join(f"0 VERTEX 5 2A 8 0 10 {x} 20 {y}" for x, y in ((0, 0), (9, 0), (9, 9)))
    polyline = f"0 POLYLINE 5 29 8 0 66 1 10 0 20 0 70 1 {vertices} 0 SEQEND 5 2B 8 0"
    assert rows(got(bare(polyline))[0]) == TRIANGLE


def test_decimal_commas_are_refused_with_their_line():
    data = bare("0 LINE 8 0 10 2,5 20 0 11 80 21 40")
    _, found = read(data, "part.dxf")
    finding = found[-1]
    assert finding.code == "damaged-drawing"
    assert data.decode().split("\n")[finding.span.line - 1] == "2,5"
    assert "comma" in finding.message


def test_merge_conflict():
    data = bare("0 LINE 8 0 10 0 20 0 11 80 21 40").decode()
    data = data.replace("11\n80", "<<<<<<< HEAD\n11\n80\n=======\n11\n90\n>>>>>>> other")
    _, found = read(data.encode(), "part.dxf")
    assert codes(found) == ["merge-conflict"]
    assert data.split("\n")[found[0].span.line - 1] == "<<<<<<< HEAD"


def test_shifted_pairs_are_refused_with_their_line():
    data = bare("0 LINE 8 0 10 0 20 0 11 80 21 40").decode().replace("11\n80", "11\n\n80")
    _, found = read(data.encode(), "part.dxf")
    assert codes(found) == ["damaged-drawing"]
    assert found[0].span.line > 10


def test_missing_end_mark():
    data = bare("0 LINE 8 0 10 0 20 0 11 80 21 40").replace(b"  0\nEOF\n", b"")
    _, found = read(data, "part.dxf")
    assert codes(found) == ["damaged-drawing"]
    assert "cut off" in found[0].message


def test_collector_is_left_as_it_was():
    import gc

    data = drawing(lambda doc, msp: msp.add_line((0, 0), (9, 0)))
    for state in (True, False):
        (gc.enable if state else gc.disable)()
        try:
            got(data)
            assert gc.isenabled() is state
        finally:
            gc.enable()

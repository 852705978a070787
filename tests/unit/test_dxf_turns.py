"""Arcs and ellipses that turn a hair over or under a full turn."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawings import as_binary, bare, codes, got, rows
from wedmcam.diag import Severity
from wedmcam.frontends.dxf.turns import Turn, turn_of


def arc(start, end, radius=3, more=""):
    return f"0 ARC 8 0 10 20 20 10 40 {radius} 50 {start} 51 {end} {more}"


def ellipse(start, end, more=""):
    return f"0 ELLIPSE 8 0 10 20 20 10 30 0 11 6 21 0 31 0 40 0.5 41 {start} 42 {end} {more}"


def area(sketch) -> float:
    """Return the area within segments that close, mm2."""
    total = 0.0
    for x0, y0, x1, y1, cx, cy, turn in rows(sketch):
        total += 0.5 * (x0 * y1 - x1 * y0)
        if turn:
            r = math.hypot(x0 - cx, y0 - cy)
            sweep = math.atan2(y1 - cy, x1 - cx) - math.atan2(y0 - cy, x0 - cx)
            sweep = 2 * math.pi if (x0, y0) == (x1, y1) else (sweep * turn) % (2 * math.pi)
            total += 0.5 * turn * r * r * (sweep - math.sin(sweep))
    return abs(total) / 1e6


ANGLES = [
    (12.345678, 372.345679),
    (12.345678, 372.345677),
    (12.3457, 372.346),  # 6 digits
    (0, 359.9999),
    (0, 360.0001),
    (0, 360.02),
    (10.00001, 10),
    (-30, 330.00001),
    (-180, 180.0001),
    (400, 760.000001),
    (0, 720.000001),
    (372.345679, 12.345680),  # written clockwise
    (0.00057295779513, 360.0005),
]


@pytest.mark.parametrize(("start", "end"), ANGLES)
@pytest.mark.parametrize("extrusion", ["", "210 0 220 0 230 -1"])
@pytest.mark.parametrize("binary", [False, True])
def test_field_arc_hair_over_360(start, end, extrusion, binary):
    data = bare(arc(start, end, more=extrusion))
    sketch, found = got(as_binary(data) if binary else data)
    assert len(sketch.segments) == 1
    assert area(sketch) == pytest.approx(math.pi * 9, rel=1e-9)
    assert [f"{d.severity}[{d.code}]" for d in found] == ["note[rounded-turn]"]


@pytest.mark.parametrize(
    ("start", "end"),
    [(0, 6.28319), (0, 6.2832), (0, 6.283), (0, 6.28318), (-3.14159, 3.1416), (1, 7.28319)],
)
def test_field_ellipse_2pi_6_digits(start, end):
    data = bare(ellipse(start, end)).replace(b"AC1009", b"AC1015")
    sketch, found = got(data)
    if end == 6.283:  # short by 1 um: closed as a gap
        assert codes(found) == ["approximated"]
        return
    assert codes(found) == ["rounded-turn", "approximated"]
    assert area(sketch) == pytest.approx(math.pi * 18, abs=0.05)


def test_an_ellipse_of_2_pi_with_6_decimals_is_not_worth_a_word():
    data = bare(ellipse(0, 6.283185)).replace(b"AC1009", b"AC1015")
    assert codes(got(data)[1]) == ["approximated"]


@pytest.mark.parametrize("start", [(10, 10.0001), (359.9999, 0.0001), (359.9999, 360.0001)])
@pytest.mark.parametrize("radius", [1, 30, 10_000])
def test_a_tiny_arc_stays_one(start, radius):
    sketch, found = got(bare(arc(*start, radius=radius)))
    (row,) = rows(sketch)
    assert math.hypot(row[2] - row[0], row[3] - row[1]) < 40_000
    assert (row[0], row[1]) != (row[2], row[3])
    assert not found


def test_an_arc_of_no_length_is_told():
    sketch, found = got(bare(arc(90, 90.00000002)))
    assert codes(found)[0] == "no-arc"
    assert found[0].severity is Severity.WARNING
    assert len(sketch.segments) <= 1


@pytest.mark.parametrize(("start", "end", "sweep"), [(0, 365, 5), (-30, 345, 15), (10, 800, 70)])
def test_more_than_a_turn_is_told(start, end, sweep):
    sketch, found = got(bare(arc(start, end)))
    (row,) = rows(sketch)
    length = 2 * 3_000 * math.sin(math.radians(sweep) / 2)
    assert math.hypot(row[2] - row[0], row[3] - row[1]) == pytest.approx(length)
    assert codes(found)[0] == "over-turn"


@pytest.mark.parametrize("end", [372.345679, 12.345678 + 359.9999])
def test_in_a_block_and_mirrored(end):
    block = f"0 BLOCK 8 0 2 A 70 0 10 0 20 0 {arc(12.345678, end)} 0 ENDBLK 8 0"
    section = "  0\nSECTION\n  2\nBLOCKS\n" + "\n".join(block.split()) + "\n  0\nENDSEC\n"
    data = bare("0 INSERT 8 0 2 A 10 0 20 0 41 -2 42 2").decode()
    data = data.replace("  0\nSECTION\n  2\nENTITIES", section + "  0\nSECTION\n  2\nENTITIES")
    sketch, found = got(data.encode())
    assert area(sketch) == pytest.approx(math.pi * 36)
    assert codes(found) == ["rounded-turn"]


@pytest.mark.parametrize("kind", ["CIRCLE", "ARC"])
def test_a_negative_radius_is_positive_and_told(kind):
    entity = f"0 {kind} 8 0 10 20 20 10 40 -3" + (" 50 0 51 90" if kind == "ARC" else "")
    plain = entity.replace("-3", "3")
    sketch, found = got(bare(entity))
    assert rows(sketch) == rows(got(bare(plain))[0])
    assert [f"{d.severity}[{d.code}]" for d in found] == ["warning[negative-radius]"]


@given(
    st.floats(-720, 720),
    st.sampled_from([360, 720]),
    st.integers(4, 9),
    st.floats(0.01, 1_000),
)
def test_a_full_turn_stays_one_however_it_is_rounded(start, turn, decimals, radius):
    """Both angles rounded to some decimals: a full turn, as far as the radius bears it."""
    a, b = round(start, decimals), round(start + turn, decimals)
    seen = turn_of(math.radians(a), math.radians(b), radius * 1e3, 1.7e-11)
    assert seen in (Turn.FULL, Turn.ROUNDED)


@given(st.floats(0, 359.9), st.floats(1e-3, 359.9), st.floats(1, 1_000))
def test_an_ordinary_arc_stays_one(start, sweep, radius):
    for end in (start + sweep, (start + sweep) % 360.0):
        seen = turn_of(math.radians(start), math.radians(end), radius * 1e3, 1.7e-11)
        assert seen is Turn.ARC

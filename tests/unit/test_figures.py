"""Figure transforms: published numbers, exact cases, copies, joins, limits."""

import math
from fractions import Fraction

import numpy as np
import pytest

from wedmcam.arithmetic import FLOAT64
from wedmcam.decimal8 import DECIMAL8
from wedmcam.diag import EntityRef, Severity, TextSpan
from wedmcam.frontends.wed import parse_transform
from wedmcam.geom.measure import area, extents
from wedmcam.ir.contour import Contour, vertices
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms import figures
from wedmcam.transforms.figures import (
    Mirror,
    Reverse,
    Rotate,
    Sequence,
    Symmetry,
    Translate,
    With,
    transformed,
)

ARITHMETICS = pytest.mark.parametrize("ar", [FLOAT64, DECIMAL8], ids=lambda a: a.name)


def done(contours, text, ar=FLOAT64, threads=()):
    transform, found = parse_transform(text)
    assert transform is not None, found
    made, found = transformed(contours, transform, ar, threads)
    assert made is not None, found
    return made[0], found


def polar(r, degrees):
    return r * math.cos(math.radians(degrees)), r * math.sin(math.radians(degrees))


def slot(r=50_000.0, step=10.0, depth=5_000.0, first=0.0):
    """An open slot outline that covers ``step`` degrees: an arc, in, an arc, out."""
    a = polar(r, first)
    b, c = polar(r, first + 0.6 * step), polar(r - depth, first + 0.6 * step)
    d, e = polar(r - depth, first + step), polar(r, first + step)
    source = (EntityRef("slot.dxf", "1A", "LINE", "CUT"),)
    rows = [(*a, 0, 0, 1, 0), (*b, 0, 0, 0, 0), (*c, 0, 0, 1, 0), (*d, 0, 0, 0, 0)]
    return Contour(vertices([*rows, (*e, 0, 0, 0, -1)]), False, source)


def box(x0, y0, x1, y1):
    rows = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return Contour(vertices([(x, y, 0, 0, 0, 0) for x, y in rows]), True)


KEY = Contour(  # a quarter of a circle on a stem, all arcs of known centres
    vertices(
        [
            (3000, 1000, 0, 0, 0, 0),
            (9000, 1000, 9000, 4000, 1, 0),
            (12000, 4000, 0, 0, 0, 0),
            (12000, 7000, 11000, 7000, -1, 0),
            (10000, 7000, 0, 0, 0, 0),
            (3000, 7000, 0, 0, 0, 0),
        ]
    ),
    True,
)


def same_rows(a, b):
    return len(a.vertices) == len(b.vertices) and bool((a.vertices == b.vertices).all())


@ARITHMETICS
@pytest.mark.parametrize(
    ("text", "x", "y"),
    [
        ("symmetry x", 3000, -1000),  # y -> -y
        ("symmetry y", -3000, 1000),  # x -> -x
        ("mirror 45", 1000, 3000),
        ("mirror 135", -1000, -3000),
        ("rotate 90", -1000, 3000),
        ("rotate 180", -3000, -1000),
        ("rotate 270", 1000, -3000),
        ("rotate -90", 1000, -3000),
        ("rotate 360", 3000, 1000),
        ("rotate 90 about (1, 1)", 1000, 3000),
        ("translate (12, -0.5)", 15000, 500),
        ("reverse", 3000, 1000),
    ],
)
def test_where_a_point_goes_exactly(ar, text, x, y):
    (image,), found = done((KEY,), text, ar)
    assert not found
    assert (image.vertices["x"][0], image.vertices["y"][0]) == (x, y)
    arcs = image.starts["turn"] != 0
    s, e = image.starts[arcs], image.ends[arcs]
    start = np.hypot(s["x"] - s["cx"], s["y"] - s["cy"])
    assert (start == np.hypot(e["x"] - s["cx"], e["y"] - s["cy"])).all()
    assert sorted(start.tolist()) == [1000, 3000]
    assert abs(abs(area(image.vertices)) - abs(area(KEY.vertices))) < 1e-3


@ARITHMETICS
@pytest.mark.parametrize("text", ["symmetry x", "symmetry y", "mirror 45", "mirror 135", "reverse"])
def test_twice_is_nothing_to_the_digit(ar, text):
    figure = (slot(), KEY)
    (a, b), _ = done(figure, f"{text} | {text}", ar)
    assert same_rows(a, figure[0])
    assert same_rows(b, figure[1])
    assert not np.signbit(a.vertices["x"][a.vertices["x"] == 0]).any()


@ARITHMETICS
def test_four_quarters_are_nothing_to_the_digit(ar):
    (a,), _ = done((slot(),), "rotate 90 | rotate 90 | rotate 90 | rotate 90", ar)
    assert same_rows(a, slot())


def test_reflected_arcs_turn_over_and_keep_their_sweep():
    (a,), _ = done((slot(),), "mirror 45")
    assert a.vertices["turn"].tolist() == [-1, 0, -1, 0, 0]
    (b,), _ = done((slot(),), "rotate 33")
    assert b.vertices["turn"].tolist() == [1, 0, 1, 0, 0]


@ARITHMETICS
def test_36_slots_are_one_closed_contour(ar):
    (ring,), found = done((slot(),), "rotate 10 copies 35 about (0, 0)", ar)
    assert ring.closed
    assert len(ring) == 144
    expected = 36 * area_of_sector(50_000, 6) + 36 * area_of_sector(45_000, 4)
    assert area(ring.vertices) == pytest.approx(expected, abs=50_000 * 2 * math.pi * 0.02)
    assert [(d.code, d.severity) for d in found] == [("figure-join", Severity.NOTE)]
    assert "36 chains became 1 closed contour" in found[0].message
    assert str(ring.source_of(0)) == "slot.dxf:#1A layer CUT"
    assert str(ring.source_of(143)) == "slot.dxf:#copy 35/1A layer CUT"


def area_of_sector(r, degrees):
    return r * r * math.radians(degrees) / 2


def test_seven_of_360_sevenths_close():
    (ring,), found = done((slot(step=360 / 7),), "rotate 360/7 copies 6")
    assert ring.closed
    assert "largest closing defect 0.000 um" in found[0].message


def test_a_closing_defect_is_spread():
    # 35 turns of 9.999999 degrees leave 0.031 um at R 50 mm.
    (ring,), found = done((slot(),), "rotate 9.999999 copies 35")
    assert ring.closed
    assert "largest closing defect 0.031 um, spread over 36 joints" in found[0].message
    radii = np.hypot(ring.vertices["x"], ring.vertices["y"])
    assert np.minimum(abs(radii - 50_000), abs(radii - 45_000)).max() < 0.04


def test_a_defect_above_a_micron_stays_open():
    (chain,), _ = done((slot(),), "rotate 9.9999 copies 35")
    assert not chain.closed


def test_rounded_slots_close_where_they_are():
    """Gaps that turn with the copies cancel: no piece moves farther than half of its gap."""
    v = slot().vertices.copy()
    for k in ("x", "y"):
        v[k] = np.round(v[k])
    rounded = Contour(v, False)
    (ring,), _ = done((rounded,), "rotate 10 copies 35")
    assert ring.closed
    moved = np.hypot(ring.vertices["x"][1:4] - v["x"][1:4], ring.vertices["y"][1:4] - v["y"][1:4])
    assert moved.max() == 0


def test_copies_keep_direction_and_order():
    line = Contour(vertices([(0, 0, 0, 0, 0, 0), (10_000, 0, 0, 0, 0, -1)]), False)
    (chain,), _ = done((line,), "translate (10, 0) copies 4")
    assert chain.vertices["x"].tolist() == [0, 10_000, 20_000, 30_000, 40_000, 50_000]
    row, _ = done((line,), "translate (12, 0) copies 4")
    assert [c.vertices["x"][0] for c in row] == [0, 12_000, 24_000, 36_000, 48_000]


def test_no_drift_over_a_thousand_copies():
    row, _ = done((box(0, 0, 100, 100),), "translate (0.1234567, 0) copies 1000")
    assert row[1000].vertices["x"][0] == pytest.approx(123_456.7, abs=1e-9)


def test_with_symmetry_completes_a_quarter():
    quarter = Contour(
        vertices([(-9000, 0, 0, 0, 0, 0), (-9000, 4000, -5000, 4000, -1, 0),
                  (-5000, 8000, 0, 0, 0, 0),
                  (0, 8000, 0, 0, 0, -1)]), False)  # fmt: skip
    (half,), _ = done((quarter,), "with symmetry y")
    assert half.vertices["x"].tolist() == [-9000, -9000, -5000, 0, 5000, 9000, 9000]
    assert half.vertices["turn"].tolist() == [0, -1, 0, 0, -1, 0, 0]
    (whole,), _ = done((quarter,), "with symmetry y | with symmetry x")
    assert whole.closed
    assert extents(whole.vertices, True) == (-9000, -8000, 9000, 8000)
    assert area(whole.vertices) == pytest.approx(-(18 * 16 - (4 - math.pi) * 16) * 1e6)


def test_an_image_on_the_figure_is_left_out():
    figure, found = done((box(-5, -5, 5, 5),), "with symmetry y | with symmetry x")
    assert len(figure) == 1
    assert [d.code for d in found] == ["duplicate"] * 2
    figure, found = done((box(5000, -5, 6000, 5),), "rotate 10 copies 36")
    assert len(figure) == 36
    assert found[0].message.startswith("copies: 1 image lies on what is there already")


def test_more_than_two_ends_join_nowhere():
    spoke = Contour(vertices([(0, 0, 0, 0, 0, 0), (9000, 0, 0, 0, 0, -1)]), False)
    figure, found = done((spoke,), "rotate 90 copies 3")
    assert len(figure) == 4
    assert [d.code for d in found] == ["figure-branch"]


def test_threads_follow_and_do_not_double():
    t, _ = parse_transform("with symmetry x")
    made, _ = transformed((box(0, 1, 9, 9),), t, FLOAT64, (ThreadPoint(4, 5), ThreadPoint(7, 0)))
    assert made is not None
    assert [(p.x, p.y) for p in made[1]] == [(4, 5), (7, 0), (4, -5)]


def test_words_as_values():
    assert parse_transform("translate (12, -0.25) copies 4")[0] == Translate(12_000, -250, 4)
    assert parse_transform("rotate 360/7 about (1,2) copies 6")[0] == Rotate(
        Fraction(360, 7), 6, (1000.0, 2000.0)
    )
    assert parse_transform("with symmetry y | mirror 135 | reverse")[0] == Sequence(
        (With(Symmetry("y")), Mirror(135), Reverse())
    )
    assert parse_transform("rotate -2^2*(1+.5)")[0] == Rotate(Fraction(-6))
    assert parse_transform("mirror 90/2")[0] == Mirror(45)


@pytest.mark.parametrize(
    ("text", "code", "column", "length", "hint"),
    [
        ("rotat 10", "wed-syntax", 1, 5, "did you mean 'rotate'?"),
        ("rotate 10 copies 0", "wed-value", 18, 1, "the figure itself"),
        ("rotate 10 copies 100", "wed-value", 18, 3, "the figure itself"),
        ("rotate 10 copies 1.5", "wed-value", 18, 3, "the figure itself"),
        ("rotate 10 copies -3", "wed-value", 18, 2, "the figure itself"),
        ("rotate 10 copys 3", "wed-syntax", 11, 5, "did you mean 'copies'?"),
        ("rotate 10 copies 3 copies 4", "wed-syntax", 20, 8, ""),
        ("rotate", "wed-syntax", 6, 1, ""),
        ("translate 12, 0", "wed-syntax", 13, 1, ""),
        ("translate (12mm, 0)", "wed-syntax", 14, 2, "numbers stand alone"),
        ("translate (1/0, 0)", "wed-value", 12, 3, ""),
        ("translate (1e9, 0)", "wed-value", 11, 8, ""),
        ("symmetry z", "wed-value", 10, 1, ""),
        ("mirror 90", "wed-value", 8, 2, "any other line"),
        ("with", "wed-syntax", 4, 1, ""),
        ("reverse 3", "wed-syntax", 9, 1, ""),
        ("  § rotate 3", "wed-syntax", 3, 1, ""),
        ("", "wed-syntax", 1, 1, ""),
        ("rotate " + "(" * 5000, "wed-syntax", 108, 1, ""),
        ("rotate 9^64^64", "wed-value", 10, 5, ""),
        ("rotate 10 copies " + "*".join(["9^64"] * 9), "wed-value", 18, 4, ""),
    ],
)
def test_what_cannot_be_read(text, code, column, length, hint):
    transform, found = parse_transform(text)
    assert transform is None
    span = found[0].span
    assert isinstance(span, TextSpan)
    assert (found[0].code, span.column, span.length) == (code, column, length)
    assert (found[0].hint or "").startswith(hint)


def test_all_errors_of_a_pipeline():
    _, found = parse_transform("rotat 1 | rotate 10 copies 0 | mirror 30 | translate (1, 2")
    assert [d.span.column for d in found if isinstance(d.span, TextSpan)] == [1, 28, 39, 58]


def test_values_from_elsewhere_have_limits_too():
    for t in (Rotate(Fraction(1), 100), Rotate(Fraction(1), -1), Translate(1, 0, 10_000)):
        made, found = transformed((KEY,), t, FLOAT64)
        assert made is None
        assert found[0].code == "wed-value"


def test_closed_contours_of_a_drawing_run_counter_clockwise():
    (image,), _ = done((box(0, 0, 9, 5),), "symmetry x")
    assert area(image.vertices) < 0
    (turned,) = figures.counter_clockwise((image,))
    assert area(turned.vertices) == 45

"""SPLINE and ELLIPSE as arcs: D-08, D-10, D-11, D-12 and D-14 of the robustness list."""

import math
from itertools import pairwise

import numpy as np
import pytest
from ezdxf.math import BSpline

from drawings import bare, codes, drawing, got, rows
from wedmcam.diag import Severity
from wedmcam.geom.segments import make
from wedmcam.transforms.chain import chain


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


def distance(sketch, x, y):
    """Largest distance of places (um) from the nearest segment of a sketch."""
    best = np.full(len(x), np.inf)
    for s in sketch.segments:
        ends = np.minimum(np.hypot(x - s["x0"], y - s["y0"]), np.hypot(x - s["x1"], y - s["y1"]))
        if s["turn"] == 0:
            w = np.array([s["x1"] - s["x0"], s["y1"] - s["y0"]])
            foot = np.clip(((x - s["x0"]) * w[0] + (y - s["y0"]) * w[1]) / (w @ w), 0, 1)
            d = np.hypot(x - s["x0"] - foot * w[0], y - s["y0"] - foot * w[1])
        else:
            r = math.hypot(s["x0"] - s["cx"], s["y0"] - s["cy"])
            a = math.atan2(s["y0"] - s["cy"], s["x0"] - s["cx"])
            b = math.atan2(s["y1"] - s["cy"], s["x1"] - s["cx"])
            whole = s["x0"] == s["x1"] and s["y0"] == s["y1"]
            sweep = 2 * math.pi if whole else (b - a) * s["turn"] % (2 * math.pi)
            at = (np.arctan2(y - s["cy"], x - s["cx"]) - a) * s["turn"] % (2 * np.pi)
            d = np.where(at <= sweep, np.abs(np.hypot(x - s["cx"], y - s["cy"]) - r), ends)
        best = np.minimum(best, d)
    return best.max()


def length(sketch):
    s = sketch.segments
    return make(*(s[n] for n in ("x0", "y0", "x1", "y1", "cx", "cy", "turn"))).length.sum()


# --- D-10 ellipses --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "end", "sweep"),
    [
        (0, 2 * math.pi, 360),
        (0, math.pi / 2, 90),
        (math.pi / 2, 0, 270),  # reversed: counter-clockwise from start to end all the same
        (2.5 * math.pi, 3 * math.pi, 90),  # more than a turn
        (-math.pi / 2, math.pi / 2, 180),
        (1.0, 1.0 + 2 * math.pi, 360),
    ],
)
@pytest.mark.parametrize("ratio", [0.5, 1.0])
@pytest.mark.parametrize("down", [False, True])
def test_d10_ellipse(start, end, sweep, ratio, down):
    def draw(doc, msp):
        extrusion = {"extrusion": (0, 0, -1)} if down else {}
        msp.add_ellipse((3, 4), (8, 6), ratio, start, end, dxfattribs=extrusion)

    sketch, found = got(drawing(draw))
    assert errors(found) == []
    t = np.linspace(start, start + math.radians(sweep), 400)
    side = -ratio if down else ratio
    x = 3 + 8 * np.cos(t) - 6 * side * np.sin(t)
    y = 4 + 6 * np.cos(t) + 8 * side * np.sin(t)
    assert distance(sketch, 1000 * x, 1000 * y) <= 1.0
    chords = np.hypot(np.diff(x), np.diff(y)).sum() * 1000
    assert length(sketch) == pytest.approx(chords, rel=1e-4)
    if ratio == 1.0:
        assert len(sketch.segments) == 1
        assert codes(found) == []
    else:
        assert codes(found) == ["approximated"]
        assert 0.5 < sketch.info.extra["spline_um"] <= 1.0
    contours, _, _ = chain(sketch)
    assert [c.closed for c in contours] == [sweep == 360]


def test_d10_ellipse_without_width():
    _, found = got(drawing(lambda doc, msp: msp.add_ellipse((0, 0), (5, 0), 1e-6)))
    assert errors(found) == ["flat-ellipse"]


def test_d10_ellipse_of_equal_parameters_is_whole_with_a_warning():
    sketch, found = got(drawing(lambda doc, msp: msp.add_ellipse((0, 0), (5, 0), 0.5, 1, 1)))
    assert codes(found) == ["full-arc", "approximated"]
    assert chain(sketch)[0][0].closed


@pytest.mark.parametrize("tilt", [{"extrusion": (0.3, 0, 0.95)}, {"major_axis": (5, 0, 1)}])
def test_tilted_ellipse_is_refused(tilt):
    def draw(doc, msp):
        msp.add_ellipse((0, 0), (5, 0), 0.5).dxf.update(tilt)

    assert "tilted" in codes(got(drawing(draw))[1])


# --- D-11 splines ---------------------------------------------------------------------------

POINTS = [(0, 0), (10, 20), (25, -5), (40, 18), (55, 2), (60, 30), (30, 45), (5, 30)]


def check_spline(data, made, tolerance=1.0, **options):
    sketch, found = got(data, **options)
    assert errors(found) == []
    t = np.linspace(made.knots()[made.degree], made.knots()[-made.degree - 1] - 1e-9, 900)
    places = np.array([tuple(p)[:2] for p in made.points(t.tolist())]) * 1000
    assert distance(sketch, *places.T) <= tolerance + 1e-6
    chords = np.hypot(*np.diff(places, axis=0).T).sum()
    assert length(sketch) == pytest.approx(chords, rel=4e-3)
    return sketch, found


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 7])
@pytest.mark.parametrize("weights", [None, [1, 2, 1, 0.5, 1, 1, 3, 1]])
@pytest.mark.parametrize("tolerance", [1.0, 5.0])
def test_d11_clamped(degree, weights, tolerance):
    def draw(doc, msp):
        if weights:
            msp.add_rational_spline(POINTS, weights, degree)
        else:
            msp.add_open_spline(POINTS, degree)

    made = BSpline(POINTS, degree + 1, weights=weights)
    sketch, _ = check_spline(drawing(draw), made, tolerance, tolerance_um=tolerance)
    if degree == 1:
        assert rows(sketch) == [
            (1e3 * a, 1e3 * b, 1e3 * c, 1e3 * d, 0, 0, 0) for (a, b), (c, d) in pairwise(POINTS)
        ]


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_d11_periodic_and_unclamped(degree):
    around = [*POINTS, *POINTS[:degree]]
    knots = list(range(len(around) + degree + 1))

    def draw(doc, msp):
        made = msp.add_spline(degree=degree)
        made.control_points, made.knots = [(x, y, 0) for x, y in around], knots
        made.dxf.flags = 3

    made = BSpline(around, degree + 1, knots)
    sketch, found = check_spline(drawing(draw), made)
    assert codes(found) == ["approximated"]
    assert chain(sketch)[0][0].closed
    assert len(chain(sketch)[0]) == 1


def test_d11_closed_flag_with_clamped_knots():
    def draw(doc, msp):
        msp.add_open_spline([*POINTS, POINTS[0]]).closed = True

    sketch, found = got(drawing(draw))
    assert codes(found) == ["approximated"]
    assert [c.closed for c in chain(sketch)[0]] == [True]


def test_d11_closed_flag_on_an_open_curve_is_said():
    def draw(doc, msp):
        msp.add_open_spline(POINTS).closed = True

    sketch, found = got(drawing(draw))
    assert codes(found) == ["open-spline", "approximated"]
    assert [c.closed for c in chain(sketch)[0]] == [False]


def test_d11_corner_is_kept():
    """A knot of multiplicity 3 in a cubic: two straight legs and a sharp corner between."""
    points = [(0, 0), (3, 0), (6, 0), (9, 0), (9, 3), (9, 6), (9, 9)]

    def draw(doc, msp):
        made = msp.add_spline(degree=3)
        made.control_points = [(x, y, 0) for x, y in points]
        made.knots = [0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2]

    sketch, found = got(drawing(draw))
    assert rows(sketch) == [(0, 0, 9_000, 0, 0, 0, 0), (9_000, 0, 9_000, 9_000, 0, 0, 0)]
    assert codes(found) == []


def test_d11_only_fit_points():
    def draw(doc, msp):
        msp.add_spline(POINTS)

    sketch, found = got(drawing(draw))
    assert codes(found) == ["fit-points", "approximated"]
    x, y = np.array(POINTS, float).T * 1000
    assert distance(sketch, x, y) <= 1.0


def test_d11_only_fit_points_closed():
    a = np.linspace(0, 2 * np.pi, 13)[:-1]

    def draw(doc, msp):
        msp.add_spline([(20 * math.cos(b), 10 * math.sin(b)) for b in a]).closed = True

    sketch, found = got(drawing(draw))
    assert codes(found) == ["fit-points", "approximated"]
    assert [c.closed for c in chain(sketch)[0]] == [True]
    assert distance(sketch, 20_000 * np.cos(a), 10_000 * np.sin(a)) <= 1.0


@pytest.mark.parametrize(
    ("knots", "points", "words"),
    [
        ([0, 0, 0, 1, 1, 1, 1], 4, "7 knots where 8"),
        ([0, 0, 0, 0, 2, 1, 1, 1, 1], 5, "ascend"),
        ([0, 0, 0, 1, 1, 1], 3, "needs more"),
    ],
)
def test_splines_that_do_not_fit_together(knots, points, words):
    def draw(doc, msp):
        made = msp.add_spline(degree=3)
        made.control_points = [(k, k * k, 0) for k in range(points)]
        made.knots = knots

    _, found = got(drawing(draw))
    assert errors(found) == ["damaged-drawing"]
    assert words in found[0].message


def test_spline_out_of_its_plane_is_refused_by_name():
    data = drawing(
        lambda doc, msp: msp.add_open_spline([(0, 0, 0), (1, 2, 0), (3, 1, 5), (4, 4, 0)])
    )
    _, found = got(data)
    assert errors(found) == ["not-flat"]
    assert "SPLINE" in found[0].message


def test_spline_in_one_line_is_one_line():
    data = drawing(lambda doc, msp: msp.add_open_spline([(k, 2 * k) for k in (0, 1, 3, 4, 8, 9)]))
    sketch, found = got(data)
    assert rows(sketch) == [(0, 0, 9_000, 18_000, 0, 0, 0)]
    assert codes(found) == []


def test_spline_without_length_is_dropped_and_said():
    def draw(doc, msp):
        msp.add_open_spline([(1, 1)] * 4)
        msp.add_line((0, 0), (1, 0))

    sketch, found = got(drawing(draw))
    assert len(sketch.segments) == 1
    assert codes(found) == ["zero-length"]


def test_doubled_control_points_at_an_end():
    """Bezier pieces whose handle has no length: the tangent is the next leg's."""
    points = [(0, 0), (0, 0), (0, 10), (10, 10)]
    sketch, _ = check_spline(drawing(lambda doc, msp: msp.add_open_spline(points)), BSpline(points))
    s = sketch.segments[0]
    out = -(s["y0"] - s["cy"]) * s["turn"], (s["x0"] - s["cx"]) * s["turn"]
    assert abs(out[0]) < 0.02 * out[1]


def test_looping_spline_is_followed():
    points = [(0, 0), (40, 40), (-20, 40), (20, 0)]
    check_spline(drawing(lambda doc, msp: msp.add_open_spline(points)), BSpline(points))


def test_far_from_the_origin():
    near = [(x, y) for x, y in POINTS]
    far = [(x + 1e6, y - 2e6) for x, y in POINTS]
    one, _ = got(drawing(lambda doc, msp: msp.add_open_spline(near)))
    two, _ = got(drawing(lambda doc, msp: msp.add_open_spline(far)))
    assert len(one.segments) == len(two.segments)
    assert two.segments["x1"] - 1e9 == pytest.approx(one.segments["x1"], abs=0.02)


# --- D-12 circles ---------------------------------------------------------------------------

K = 4 / 3 * (math.sqrt(2) - 1)


def quarters(r, cx=0.0, cy=0.0):
    out = []
    for k in range(4):
        c, s = round(math.cos(k * math.pi / 2)), round(math.sin(k * math.pi / 2))
        out.append(
            [
                (cx + r * (c * x - s * y), cy + r * (s * x + c * y))
                for x, y in ((1, 0), (1, K), (K, 1), (0, 1))
            ]
        )
    return out


@pytest.mark.parametrize("separate", [True, False])
@pytest.mark.parametrize(("r", "whole"), [(3, True), (20, False)])
def test_d12_circle_as_cubic_pieces(separate, r, whole):
    def draw(doc, msp):
        if separate:
            for points in quarters(r, 5, 7):
                msp.add_open_spline(points)
        else:
            made = msp.add_spline(degree=3)
            flat = [p for q in quarters(r, 5, 7) for p in q[:3]] + [(5 + r, 7)]
            made.control_points = [(x, y, 0) for x, y in flat]
            made.knots = [0] * 4 + [1] * 3 + [2] * 3 + [3] * 3 + [4] * 4

    sketch, found = got(drawing(draw))
    if whole:  # 0.027 % of 3 mm is 0.8 um, shared between inside and outside
        ((x0, y0, x1, y1, cx, cy, turn),) = rows(sketch)
        assert (cx, cy, turn) == pytest.approx((5_000, 7_000, 1), abs=0.01)
        assert (x0, y0) == (x1, y1)
        assert x0 - cx == pytest.approx(1000 * r, abs=0.5)
        assert codes(found) == ["spline-circle"]
        assert found[0].count == (4 if separate else 1)
    else:
        assert codes(found) == ["approximated"]
    assert [c.closed for c in chain(sketch)[0]] == [True]


def test_d12_rational_circle_is_exact():
    c = math.sqrt(0.5)
    points = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]

    def draw(doc, msp):
        made = msp.add_spline(degree=2)
        made.control_points = [(50 * x, 50 * y, 0) for x, y in points]
        made.weights = [1, c, 1, c, 1, c, 1, c, 1]
        made.knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
        half = msp.add_spline(degree=2)
        half.control_points = [(100 + 50 * x, 50 * y, 0) for x, y in points[:3]]
        half.weights = [1, c, 1]
        half.knots = [0, 0, 0, 1, 1, 1]

    sketch, found = got(drawing(draw))
    assert len(sketch.segments) == 2
    assert sketch.segments["x0"][0] == pytest.approx(50_000, abs=1e-3)
    assert rows(sketch)[1] == pytest.approx((150_000, 0, 100_000, 50_000, 100_000, 0, 1), abs=1e-3)
    assert codes(found) == ["spline-circle"]
    assert sketch.info.extra["spline_um"] <= 0.002


# --- D-08, D-14: scales ---------------------------------------------------------------------


def test_d08_arcs_under_unequal_scale_are_ellipses():
    def draw(doc, msp):
        made = doc.blocks.new("B")
        made.add_circle((0, 0), 10)
        made.add_arc((30, 0), 5, 350, 100)
        made.add_lwpolyline(
            [(50, 0, 0.5), (60, 0, 0), (60, 10, -0.3), (50, 10, 0)], "xyb", close=True
        )
        msp.add_blockref("B", (7, 9), dxfattribs={"xscale": 2, "yscale": -1, "rotation": 30})

    sketch, found = got(drawing(draw))
    assert codes(found) == ["approximated"]
    assert "different scales" in found[0].message
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))

    def placed(x, y):
        x, y = 2 * x, -y
        return 1000 * (7 + c * x - s * y), 1000 * (9 + s * x + c * y)

    t = np.linspace(0, 2 * np.pi, 300)
    assert distance(sketch, *placed(10 * np.cos(t), 10 * np.sin(t))) <= 1.0
    t = np.radians(np.linspace(-10, 100, 200))
    assert distance(sketch, *placed(30 + 5 * np.cos(t), 5 * np.sin(t))) <= 1.0
    # Bulge 0.5 over a chord of 10: centre (55, 3.75), radius 6.25.
    a = math.atan2(-3.75, -5), math.atan2(-3.75, 5)
    t = np.linspace(a[0], a[1], 100)
    assert distance(sketch, *placed(55 + 6.25 * np.cos(t), 3.75 + 6.25 * np.sin(t))) <= 1.0
    assert sorted(c.closed for c in chain(sketch)[0]) == [False, True, True]
    handles = [r.dxftype for r in sketch.sources]
    assert handles == ["CIRCLE", "ARC", "LWPOLYLINE"]


def test_d08_splines_and_ellipses_in_scaled_blocks():
    """The tolerance holds in the part, whatever the scale of the block."""

    def draw(doc, msp):
        made = doc.blocks.new("B")
        made.add_open_spline(POINTS)
        made.add_ellipse((0, 100), (20, 0), 0.4)
        for k, (sx, sy) in enumerate(((1, 1), (10, 10), (-0.1, 0.1), (3, 1))):
            msp.add_blockref("B", (10000 * k, 0), dxfattribs={"xscale": sx, "yscale": sy})

    sketch, found = got(drawing(draw))
    assert codes(found) == ["approximated"]
    assert found[0].count == 8
    made = BSpline(POINTS)
    x, y = np.array([tuple(p)[:2] for p in made.approximate(500)]).T * 1000
    per = []
    for k, (sx, sy) in enumerate(((1, 1), (10, 10), (-0.1, 0.1), (3, 1))):
        assert distance(sketch, 1e7 * k + sx * x, sy * y) <= 1.0
        near = np.abs(sketch.segments["x0"] - 1e7 * k) < 8e5
        per.append(int(near.sum()))
    assert per[2] < per[0] < per[1]
    assert sketch.info.extra["spline_um"] <= 1.0


def test_d14_tolerance_is_in_the_part_not_in_drawing_units():
    def draw(doc, msp):
        msp.add_ellipse((0, 0), (2, 0), 0.5)

    inch, _ = got(drawing(draw, units=1))
    mm, _ = got(drawing(draw, units=4))
    fine, _ = got(drawing(draw, units=4), tolerance_um=0.1)
    assert len(mm.segments) < len(inch.segments)
    assert len(mm.segments) < len(fine.segments)
    t = np.linspace(0, 2 * np.pi, 700)
    assert distance(inch, 50_800 * np.cos(t), 25_400 * np.sin(t)) <= 1.0
    assert distance(fine, 2_000 * np.cos(t), 1_000 * np.sin(t)) <= 0.1


def test_hidden_splines_are_counted_not_fitted():
    def draw(doc, msp):
        doc.layers.add("OFF").off()
        msp.add_open_spline(POINTS, dxfattribs={"layer": "OFF"})
        msp.add_line((0, 0), (9, 0))

    sketch, found = got(drawing(draw))
    assert codes(found) == ["hidden-not-cut"]
    assert "spline_um" not in sketch.info.extra


def test_segments_follow_the_order_of_entities():
    def draw(doc, msp):
        msp.add_open_spline(POINTS)
        msp.add_line((0, 0), (9, 0))
        msp.add_ellipse((0, 0), (5, 0), 0.5)
        msp.add_arc((0, 0), 5, 0, 90)

    sketch, _ = got(drawing(draw))
    assert (np.diff(sketch.segments["source"]) >= 0).all()
    assert [s.dxftype for s in sketch.sources] == ["SPLINE", "LINE", "ELLIPSE", "ARC"]


def test_spline_with_a_number_that_is_none():
    spline = "0 SPLINE 5 2F 100 AcDbEntity 8 0 100 AcDbSpline 70 8 71 3 72 8 73 4 74 0"
    knots = " 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1"
    points = " 10 0 20 0 10 1 20 nan 10 2 20 1 10 3 20 0"
    _, found = got(bare(spline + knots + points).replace(b"AC1009", b"AC1015"))
    assert errors(found)[0] == "bad-number"

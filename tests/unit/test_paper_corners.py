"""``--corners paper``: the transition arcs of the ZD-065, the same in the punch and in the die."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import parts
import wedmcam
from drawings import drawing
from wedmcam.options import Options, WrongUse

HALF_MM = 20.0
#: So near to the corner of a figure the clearance is looked at.
NEAR_UM = 15_000.0


def wedge(degrees, reach=HALF_MM):
    """Return a part program with a corner of so many degrees at (0, 0), of two lines."""
    a = math.radians(degrees / 2)
    x, y = reach * math.cos(a), reach * math.sin(a)
    # The edges end on an arc about the corner (a small one for corners above 180 degrees).
    back = math.hypot(x, y)
    large = degrees > 180
    way = f"arc ccw to ({x:.9f}, {y:.9f}) center (0, 0)"
    return _contour(f"from ({x:.9f}, {-y:.9f}) {way} line to (0, 0) close", back, large)


def _contour(body, *_):
    return f"units mm\ncontour c {{ {body} }}\n"


def pie(degrees, reach=HALF_MM):
    """Return the same with a leg that is an arc: a line meets an arc at (0, 0)."""
    a = math.radians(degrees)
    x, y = reach * math.cos(a), reach * math.sin(a)
    # The second leg leaves the corner at the angle, bent by a radius of 60 mm.
    h = a + math.asin(reach / 2 / 60.0)
    ex, ey = reach * math.cos(h), reach * math.sin(h)
    del x, y
    return _contour(
        f"from (0, 0) line to ({reach}, 0) arc ccw to ({ex:.9f}, {ey:.9f}) center (0, 0) "
        "arc cw to (0, 0) radius 60"
    )


def made(figure, side, offset, corner, to="compact"):
    text = f"{figure}cut c {side} offset {offset} corners paper"
    text += f" corner {corner}\n" if corner else "\n"
    result = wedmcam.compile(text.encode(), name="pair.wed", to=to)
    assert result.ok, [str(d) for d in result.findings]
    return result


def line_of(result):
    path = result.plan.cuts[0].path
    return parts.polygon(path, 0.001).exterior


def apart(one, other):
    """Return the distances of places of one line from another, um; at its corner more of them."""
    at = np.arange(0.0, one.length, 20.0)
    corner = shapely.line_locate_point(one, shapely.Point(0, 0))
    at = np.concatenate([at, np.arange(corner - 800.0, corner + 800.0)])
    places = shapely.line_interpolate_point(one, at)
    near = shapely.distance(places, shapely.Point(0, 0)) < NEAR_UM  # far away two arcs meet
    return shapely.distance(places[near], other)


def clearance(figure, offset_um, z_um, corner_mm):
    """Return how far the clearance of punch and die is from what was meant, um, at most."""
    punch = line_of(made(figure, "outside", offset_um / 1000, corner_mm))
    die = line_of(made(figure, "inside", (offset_um - z_um) / 1000, corner_mm))
    meant = 2 * offset_um - z_um
    return max(np.abs(apart(a, b) - meant).max() for a, b in ((punch, die), (die, punch)))


@pytest.mark.parametrize("figure", [wedge, pie])
@pytest.mark.parametrize(
    ("degrees", "z"),
    [(20, 0), (20, 5), (20, 20), (45, 20), (60, 5), (90, 0), (150, 20), (179, 5), (200, 20),
     (270, 5), (315, 20), (340, 0), (340, 5), (340, 20)],
)  # fmt: skip
def test_punch_and_die_have_their_clearance(figure, degrees, z):
    assert clearance(figure(degrees), 100, z, 0.1) < 0.3


@pytest.mark.parametrize("degrees", [60, 120, 300])
def test_with_radii_of_their_own_corners_of_60_degrees_and_more_fit(degrees):
    """The clearance at the worst is z (2 - 1 / sin(beta / 2)), between 0 and z."""
    beta = math.radians(min(degrees, 360 - degrees))
    z = 1.0
    punch = line_of(made(wedge(degrees), "outside", 0.1, None))
    die = line_of(made(wedge(degrees), "inside", 0.1 - z / 1000, None))
    least = apart(punch, die).min()
    assert least >= 200 - z + z * (1 - 1 / math.sin(beta / 2)) - 0.3


def test_default_radii_part_by_the_formula():
    """20 degrees, offsets 100 and 80 um: the punch is 75 um too near, as the formula says."""
    punch = line_of(made(wedge(20), "outside", 0.1, None))
    die = line_of(made(wedge(20), "inside", 0.08, None))
    change = 180 - min(apart(punch, die).min(), apart(die, punch).min())
    worst = 20 - 20 * (2 - 1 / math.sin(math.radians(10)))
    assert 0 < change <= worst + 0.5


def codes(result):
    return [d.code for d in result.findings]


def square(_, m):
    m.add_lwpolyline([(0, 0), (20, 0), (20, 10), (0, 10)], close=True)


def acute(_, m):
    m.add_lwpolyline([(0, 0), (20, 0), (20, 5)], close=True)


def test_arcs_of_the_wire_are_r_and_the_offset():
    for side, radius in (("part", 300.0), ("die", 100.0)):
        result = wedmcam.compile(
            drawing(square), name="a.dxf", offset=0.1, side=side, corner=0.2, paper=True
        )
        v = result.plan.cuts[0].path.vertices
        arcs = v[v["turn"] != 0]
        found = np.hypot(arcs["x"] - arcs["cx"], arcs["y"] - arcs["cy"])
        assert found == pytest.approx([radius] * 4)
        assert result.plan.cuts[0].corner_um == 200.0
        assert "transition-arcs" in codes(result)


def test_the_radius_is_the_offset():
    result = wedmcam.compile(drawing(square), name="a.dxf", offset=0.1, side="die", paper=True)
    v = result.plan.cuts[0].path.vertices  # r - offset is 0: the wire turns on the spot
    assert result.ok
    assert not (v["turn"] != 0).any()
    assert result.plan.cuts[0].corner_um == 100.0
    assert len(result.plan.cuts[0].cornered.vertices) == 4


def test_outer_is_as_without():
    as_usual = wedmcam.compile(drawing(square), name="a.dxf", offset=0.1)
    asked = wedmcam.compile(drawing(square), name="a.dxf", offset=0.1, paper=False)
    assert as_usual.data == asked.data
    assert as_usual.plan.cuts[0].cornered is None


def test_acute_corners_are_warned_of_and_the_radius_named():
    result = wedmcam.compile(drawing(acute), name="a.dxf", offset=0.1, paper=True)
    (warned,) = (d for d in result.findings if d.code == "acute-corner")
    assert "14.0 degrees at (0.000, 0.000)" in warned.message
    assert "--corner 0.100mm" in warned.hint
    stated = wedmcam.compile(drawing(acute), name="a.dxf", offset=0.1, corner=0.1, paper=True)
    assert stated.ok
    assert "acute-corner" not in codes(stated)
    assert stated.data == result.data


def pair(_, m):
    for layer, x in (("PUNCH", 0), ("DIE", 40)):
        points = [(x, 0), (x + 20, 0), (x + 20, 5)]
        m.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})


def test_a_pair_in_one_run_has_one_radius():
    """The larger of both offsets, stated or by the clearance; and no warning is needed."""
    sides = {"PUNCH": "part", "DIE": "die"}
    for options in (
        {"offset": 0.1, "layer_offsets": {"DIE": 0.08}},
        {"offset": 0.08, "layer_offsets": {"PUNCH": 0.1}},
        {"offset": 0.1, "clearance": 0.02},
    ):
        result = wedmcam.compile(
            drawing(pair), name="a.dxf", layer_sides=sides, paper=True, **options
        )
        assert result.ok, codes(result)
        assert {c.corner_um for c in result.plan.cuts} == {100.0}
        assert sorted(c.offset_um for c in result.plan.cuts) == [80.0, 100.0]
        assert "acute-corner" not in codes(result)


def test_too_large_names_the_largest():
    result = wedmcam.compile(drawing(square), name="a.dxf", offset=0.1, corner=6, paper=True)
    (first, *_) = (d for d in result.findings if d.code == "corner-too-large")
    assert "at most 5.000 mm fits this corner" in first.hint
    assert codes(result).count("corner-too-large") == 2
    ok = wedmcam.compile(drawing(square), name="a.dxf", offset=0.1, corner=4.999, paper=True)
    assert ok.ok, [str(d) for d in ok.findings]


@given(st.floats(20.0, 160.0), st.floats(2.0, 18.0), st.sampled_from([0, 60]))
@settings(max_examples=40, deadline=None)
def test_the_largest_is_the_largest(degrees, leg, bend):
    """Law: r tan(turn / 2) is what a leg of a line holds; the largest fits, 1 % more does not."""
    from wedmcam.ir.contour import Contour, vertices
    from wedmcam.transforms.corners import transition_arcs

    a = math.radians(degrees)
    end = (1000 * leg * math.cos(a), 1000 * leg * math.sin(a))
    rows = [(20_000.0, 0, 0, 0, 0, -1), (0, 0, 0, 0, 0, -1), (*end, 0, 0, 0, -1)]
    if bend:  # the second leg is an arc of a radius of 60 mm
        m = (end[0] / 2, end[1] / 2)
        h = math.sqrt(60_000.0**2 - (500 * leg) ** 2)
        c = (m[0] - h * math.sin(a), m[1] + h * math.cos(a))
        rows[1] = (0, 0, *c, 1, -1)
    contour = Contour(vertices(rows), False)
    _, found = transition_arcs([contour], 1e6)
    (most,) = (float(d.values["most_mm"]) for d in found if d.code == "corner-too-large")
    if not bend:
        length = min(20.0, leg)
        assert most == pytest.approx(length / math.tan((math.pi - a) / 2), abs=0.0011)
    assert not [
        d for d in transition_arcs([contour], 1000 * most)[1] if d.code != "transition-arcs"
    ]
    assert transition_arcs([contour], 1010 * most + 2)[1][0].code == "corner-too-large"


LENS = "from (-3, 0) arc ccw to (3, 0) radius {r} arc ccw to (-3, 0) radius {r} "


def test_between_arcs_the_offset_arcs_are_intersected():
    """A lens: the wire's path has its two arcs alone, and no third at a corner."""
    for side in ("outside", "inside"):
        result = made(_contour(LENS.format(r=4)), side, 0.1, None)
        v = result.plan.cuts[0].path.vertices
        assert len(v) == 3  # two, and the start
        radii = np.hypot(v["x"] - v["cx"], v["y"] - v["cy"])
        assert radii == pytest.approx([4100.0 if side == "outside" else 3900.0] * 3)
        assert any("between arcs" in d.message for d in result.findings)


@pytest.mark.parametrize("side", ["outside", "inside"])
def test_between_arcs_that_do_not_meet_is_an_error(side):
    """A lens as sharp as 17 degrees: beyond four offsets."""
    text = _contour(LENS.format(r=20)) + f"cut c {side} offset 0.1 corners paper\n"
    result = wedmcam.compile(text.encode(), name="a.wed")
    assert not result.ok
    found = [d for d in result.findings if d.code == "arcs-not-met"]
    assert [str(d.points_mm[0]) for d in found] == ["(3.000, 0.000) mm", "(-3.000, 0.000) mm"]


def test_nearly_tangent_corners_are_joined():
    """A turn of 1 degree: 0.1 mm x 0.0175 is 1.7 um, 0.2 mm more than 2."""
    body = (
        "from (0, 0) line to (10, 0) line to (20, 0.17455) line to (20, 10) line to (0, 10) close"
    )
    for corner, arcs in ((0.1, 4), (0.2, 5)):
        result = made(_contour(body), "outside", 0.1, corner)
        v = result.plan.cuts[0].path.vertices
        assert np.count_nonzero(v["turn"]) == arcs
        (said,) = (d for d in result.findings if d.code == "transition-arcs")
        assert said.values["arcs"] == arcs
        assert ("joined" in said.message) == (arcs == 4)


def test_words():
    assert Options.of(offset_um=100.0, paper=True).as_data()["paper"] is True
    with pytest.raises(WrongUse, match="--convex sharp"):
        Options.of(offset_um=100.0, paper=True, sharp=True)
    result = wedmcam.compile(drawing(square), name="a.dxf", side="on", paper=True)
    assert "idle-option" in codes(result)


def test_a_part_program_has_one_radius_for_all_its_passes():
    """Rough and finishing cut of one outline: the largest offset, or the fine one parts."""
    text = _contour("from (0, 0) line to (20, 0) line to (20, 10) line to (0, 10) close")
    text += "cut c outside offset 0.2\ncut c outside offset 0.1\n"
    result = wedmcam.compile(text.encode(), name="a.wed", paper=True)
    assert result.ok
    assert [c.corner_um for c in result.plan.cuts] == [200.0, 200.0]
    one = text.replace("cut c outside offset 0.1", "").replace("0.2", "0.2 corners outer")
    result = wedmcam.compile(one.encode(), name="a.wed", paper=True)
    assert [c.corner_um for c in result.plan.cuts] == [0.0]

"""Kept material too thin or too small to be meant: fins and necks of one contour, walls, specks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import parts
from drawings import drawing
from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.geom import measure
from wedmcam.geom.thickness import walls
from wedmcam.transforms.thickness import thin_walls

LIMIT = 50.0
BASE = [(0, 0), (10e3, 0), (10e3, 5e3)]
TOP = [(0, 5e3)]


def polygon(points, bulges=None):
    points = np.array(points, float)
    return parts.contour_of_bulges(points, np.zeros(len(points)) if bulges is None else bulges)


def moved(points, turned, mirrored, begin, at=(0.0, 0.0)):
    """The points of a polygon turned, mirrored, and begun at another one."""
    points = np.array(points, float)
    if mirrored:
        points = points[::-1] * [-1.0, 1.0]
    c, s = np.cos(turned), np.sin(turned)
    return np.roll(points @ np.array([[c, s], [-s, c]]) + at, begin, axis=0)


def split(points, shares):
    """Each side of a polygon cut at shares of its length."""
    out = []
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        out += [a, *(a + t * (b - a) for t in sorted(shares))]
    return np.array(out)


def told(*contours, below=LIMIT, part=True):
    return thin_walls(contours, part, below, range(len(contours)), set())


def sizes(*contours, below=LIMIT):
    s, first = measure.segments_of_all([(c.vertices, True) for c in contours])
    owner = np.repeat(np.arange(len(contours)), np.diff(first, append=len(s)))
    return np.sort(walls(s, owner, below).size)


def fin(thick, long, out=True):
    """A block with a fin on top (or a slot in it)."""
    y = 5e3 + long if out else 5e3 - long
    return [*BASE, (5e3 + thick, 5e3), (5e3 + thick, y), (5e3, y), (5e3, 5e3), *TOP]


images = st.tuples(st.floats(0, 6.3), st.booleans(), st.integers(0, 7))
shares = st.lists(st.floats(0.05, 0.95), max_size=3, unique_by=lambda v: round(v, 2))


@given(st.floats(2, 120), st.floats(1.2, 40), images, shares)
def test_a_fin_is_told_where_it_is_thinner_than_the_limit(thick, slender, image, cuts):
    if abs(thick - LIMIT) < 0.01:
        return
    contour = polygon(split(moved(fin(thick, slender * thick), *image), cuts))
    found = told(contour)
    assert len(found) == (thick < LIMIT)
    for d in found:
        assert d.severity is Severity.WARNING
        assert f"{thick:.4g} um" in d.message


@given(st.floats(2, 120), st.floats(1.2, 40), images)
def test_a_slot_is_no_wall(thick, slender, image):
    contour = polygon(moved(fin(thick, min(slender * thick, 4e3), out=False), *image))
    assert not told(contour)
    # And the block round a hole of that form is.
    assert len(told(contour, part=False)) == (thick < LIMIT)


@given(st.floats(0.1, 170), st.floats(0.2, 4.0), images, shares)
def test_a_tip_is_no_wall(angle, long, image, cuts):
    half = 1e3 * long * np.tan(np.radians(angle) / 2)
    tip = [*BASE, (5e3 + half, 5e3), (5e3, 5e3 + 1e3 * long), (5e3 - half, 5e3), *TOP]
    if half > 4.9e3:
        return
    assert not told(polygon(split(moved(tip, *image), cuts)))


@given(st.floats(1.2, 150), st.floats(0.5, 45), st.floats(-0.7, 0.7), images, shares)
def test_a_tip_that_is_cut_off_is_no_wall(angle, flat, slope, image, cuts):
    """By a chamfer of up to the limit, as oblique as may be."""
    t = np.tan(np.radians(angle) / 2)
    long = 4e3 if angle < 30 else 400.0
    half = 0.5 * flat + long * t
    if half > 4.9e3 or abs(slope) * t > 0.5:
        return
    left, right = 5e3 - 0.5 * flat, 5e3 + 0.5 * flat
    up, down = 5e3 + long, 5e3 + long - abs(slope) * flat
    tops = [(right + (up - down) * t, down), (left, up)]
    if slope < 0:
        tops = [(right, up), (left - (up - down) * t, down)]
    points = [*BASE, (5e3 + half, 5e3), *tops, (5e3 - half, 5e3), *TOP]
    assert not told(polygon(split(moved(points, *image), cuts)))


@pytest.mark.parametrize("angle", [2, 10, 45, 90, 130])
@pytest.mark.parametrize("radius", [1, 5, 20])
def test_a_tip_that_is_rounded_is_no_wall(angle, radius):
    b = np.radians(angle)
    long = 4e3 if angle < 30 else 300.0
    half = radius * np.cos(b / 2) + long * np.tan(b / 2)
    x, y = radius * np.cos(b / 2), 5e3 + long
    points = [*BASE, (5e3 + half, 5e3), (5e3 + x, y), (5e3 - x, y), (5e3 - half, 5e3), *TOP]
    bulges = np.zeros(len(points))
    bulges[4] = np.tan((np.pi - b) / 4)
    assert not told(polygon(points, bulges))


@given(st.floats(5, 100), st.floats(10, 3000), st.floats(10, 3000), images)
def test_a_neck_between_arcs_is_told(thick, r, q, image):
    """A bar that two round notches leave a neck of."""
    if abs(thick - LIMIT) < 0.01:
        return
    low, high = 0.0, thick
    points = [(-9e3, low - 4e3), (-r, low - r), (0, low - r), (r, low - r), (9e3, low - 4e3)]
    points += [(9e3, high + 4e3), (q, high + q), (-q, high + q), (-9e3, high + 4e3)]
    bulges = np.zeros(len(points))
    points[1:4] = [(-r, low - r), (r, low - r)]
    bulges = np.zeros(len(points))
    bulges[1], bulges[5] = -1.0, -1.0
    c, s = np.cos(image[0]), np.sin(image[0])
    turned = np.array(points) @ np.array([[c, s], [-s, c]])
    found = told(polygon(np.roll(turned, image[2], axis=0), np.roll(bulges, image[2])))
    assert len(found) == (thick < LIMIT)


@given(st.floats(5, 100), st.floats(100, 3000), st.floats(100, 3000), st.floats(0, 6.3))
def test_a_wall_between_holes_is_told(thick, r, q, turned):
    if abs(thick - LIMIT) < 0.01:
        return
    d = r + q + thick
    frame = parts.rectangle(40e3, 40e3, -20e3, -20e3)
    holes = [parts.circle(0, 0, r), parts.circle(d * np.cos(turned), d * np.sin(turned), q)]
    assert len(told(frame, *holes)) == (thick < LIMIT)
    assert len(told(*holes[::-1], frame)) == (thick < LIMIT)
    assert not told(*holes)  # two discs: scrap lies between


def test_a_curved_wall_in_lines_or_arcs_is_one():
    turns = np.linspace(0.2, 2.9, 60)
    for count in (60, 7):
        some = turns[:: 60 // count]
        rim = np.column_stack([np.cos(some), np.sin(some)])
        found = told(polygon(np.concatenate([2030 * rim, 2000 * rim[::-1]])))
        assert len(found) == 1
    ends = np.array([(np.cos(a), np.sin(a)) for a in (0.2, 2.9)])
    bulge = np.tan(2.7 / 4)
    contour = polygon([*(2030 * ends), *(2000 * ends[::-1])], np.array([bulge, 0, -bulge, 0]))
    (found,) = told(contour)
    assert "30 um" in found.message


def test_steps_and_noise_are_no_walls():
    x, y = np.arange(0, 5e3, 7.0), np.zeros(715)
    noise = np.random.default_rng(3).uniform(-1.5, 1.5, len(x))
    edge = np.column_stack([x, y + noise])
    assert not told(polygon([*edge, (5e3, 4e3), (0, 4e3)]))
    stairs = [(k // 2 * 20.0, -((k + 1) // 2) * 20.0) for k in range(100)]
    assert not told(polygon([*stairs, (2e3, 4e3), (0, 4e3)]))
    assert not told(polygon(fin(30, 12)))  # lower than it is wide


def test_a_fin_is_as_thin_as_its_walls_are_near_to_parallel():
    """Coordinates in whole um put walls of 0.2 mm off by a quarter of a degree."""
    assert (
        len(told(polygon([*BASE, (5030, 5e3), (5029, 5200), (5e3, 5200), (5e3, 5e3), *TOP]))) == 1
    )


def test_order_and_start_change_nothing():
    comb = [*BASE]
    for k in range(6):
        x = 9e3 - k * 1e3
        comb += [(x, 5e3), (x, 6e3), (x - 20 - k, 6e3), (x - 20 - k, 5e3)]
    comb += TOP
    texts = {tuple(sorted(d.message for d in told(polygon(np.roll(comb, k, 0))))) for k in range(9)}
    assert len(texts) == 1
    assert len(texts.pop()) == 6


def test_nothing_below_0_and_nothing_of_touching_places():
    assert not told(polygon(fin(30, 1e3)), below=0.0)
    assert not told(
        parts.rectangle(9e3, 9e3), parts.circle(4e3, 4e3, 1e3), parts.circle(6e3, 4e3, 1e3)
    )
    assert len(sizes(polygon(fin(30, 1e3)))) > 0


# --- commands --------------------------------------------------------------------------------


def lines(space, points):
    for a, b in zip(points, points[1:] + points[:1], strict=True):
        space.add_line(a, b)


def said(draw, code, **options):
    made = api.compile(drawing(lambda _, m: draw(m)), **{"offset": 0.1, **options})
    return made, [d for d in made.findings if d.code == code]


FIN = [(0, 0), (40, 0), (40, 20), (30, 20), (30, 30), (29.97, 30), (29.97, 20), (0, 20)]


@pytest.mark.parametrize("side", ["part", "on"])
def test_a_fin_of_an_outline(side):
    options = {"side": side} if side == "part" else {"side": "on", "offset": None}
    made, found = said(lambda m: lines(m, FIN), "thin-wall", **options)
    assert made.status == 0
    (d,) = found
    assert d.severity is Severity.WARNING
    assert "0.03 mm (30 um)" in d.message
    assert d.span is not None
    assert d.notes[0][1] is not None
    assert d.span != d.notes[0][1]
    x, y = d.points_mm[0]
    assert x == pytest.approx(29.985)
    assert 20 <= y <= 30
    for limit, count in ((0.03, 0), (0.031, 1), (0.0, 0), (0.02, 0)):
        assert (
            len(said(lambda m: lines(m, FIN), "thin-wall", thin_wall=limit, **options)[1]) == count
        )
    assert not said(lambda m: lines(m, FIN), "thin-wall", side="die")[1]


def test_copies_in_a_transform_and_inches():
    def draw(m):
        lines(m, [(x / 25.4, y / 25.4) for x, y in FIN])

    data = drawing(lambda _, m: draw(m), units=1)
    made = api.compile(data, offset=0.1, transforms=["rotate 180 copies 1 about (60, 40)"])
    assert [d.code for d in made.findings if d.severity is Severity.WARNING] == ["thin-wall"] * 2


def test_a_part_program():
    text = (
        "contour a { from (0, 0) line to (9, 0) line to (9, 4) line to (5.03, 4) line to (5.03, 6)"
        " line to (5, 6) line to (5, 4) line to (0, 4) close }\n"
        "contour b { circle center (2, 2) radius 1 }\n"
        "contour c { circle center (4.02, 2) radius 1 }\n"
        "cut b inside\ncut c inside\ncut a outside\n"
    )
    made = api.compile(text.encode(), name="x.wed", offset=0.1)
    assert [d.code for d in made.findings if d.severity > Severity.NOTE] == ["thin-wall"] * 2
    assert made.status == 0
    seen = api.inspect(text.encode(), name="x.wed", options=api.options_in_mm())
    assert [d.code for d in seen.findings if d.severity > Severity.NOTE][:1] == ["thin-wall"]


def test_inspect():
    data = drawing(lambda _, m: lines(m, FIN))
    seen = api.inspect(data, name="a.dxf", options=api.options_in_mm())
    assert [d.code for d in seen.findings] == ["thin-wall"]
    seen = api.inspect(data, name="a.dxf", options=api.options_in_mm(side="die", offset=0.1))
    assert [d.code for d in seen.findings] == []


def test_field_speck_closed_outside():
    def draw(m):
        m.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True)
        m.add_circle((60, 10), 0.001)

    made, found = said(draw, "speck")
    assert made.status == 0
    (d,) = found
    assert d.severity is Severity.WARNING
    assert "(60.000, 10.000) mm is 0.002 mm (2 um) large, smaller" in d.message
    assert d.span is not None


@pytest.mark.parametrize("form", ["circle", "square", "triangle", "ellipse"])
@pytest.mark.parametrize("where", ["outside", "hole", "slug"])
def test_specks_of_any_form_anywhere(form, where):
    def draw(m):
        m.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True)
        m.add_circle((30, 10), 5)
        x = {"outside": 60, "hole": 10, "slug": 30}[where]
        if form == "circle":
            m.add_circle((x, 10), 0.02)
        elif form == "ellipse":
            m.add_ellipse((x, 10), (0.02, 0), 0.6)
        else:
            square = [(x, 10), (x + 0.02, 10), (x + 0.02, 10.02), (x, 10.02)]
            m.add_lwpolyline(square[: 3 if form == "triangle" else 4], close=True)

    made, found = said(draw, "speck")
    assert len(found) == 1
    assert made.status == (1 if where == "hole" else 0)
    assert not [d for d in made.findings if d.code == "thin-wall"]
    made, found = said(draw, "speck", side="on", offset=None)
    assert len(found) == 1


def test_what_is_smaller_than_its_own_cut_is_a_speck():
    def draw(m, radius):
        m.add_circle((0, 0), 5)
        m.add_circle((10, 0), radius)

    assert len(said(lambda m: draw(m, 0.09), "speck")[1]) == 1
    assert not said(lambda m: draw(m, 0.11), "speck")[1]
    assert not said(lambda m: draw(m, 0.09), "speck", offset=0.05)[1]


def test_many_are_listed_in_short():
    def draw(m):
        m.add_circle((0, 0), 5)
        for k in range(50):
            m.add_circle((10 + k, 0), 0.002)

    found = said(draw, "speck")[1]
    assert len(found) == 21
    assert found[-1].count == 30

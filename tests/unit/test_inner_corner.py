"""What counts as one inner corner (cut with the wire's radius) and what as interference."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import parts
from drawings import drawing
from oracle import lengths
from wedmcam import api
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.largest import Largest, largest_offset


def offset_of(points, offset=100.0):
    contour = parts.contour_of_bulges(np.array(points, float), np.zeros(len(points)))
    made, found = compensate([contour], [-offset])  # counter-clockwise, wire outside
    assert not found
    return made


def kinds(points, offset=100.0):
    return [i.kind for i in offset_of(points, offset).interference]


BASE = [(0, 0), (10_000, 0), (10_000, 5_000)]
TOP = [(0, 5_000)]


@pytest.mark.parametrize(
    ("notch", "expected"),
    [
        ([(6_000, 5_000), (6_000, 4_000), (5_000, 4_000), (5_000, 5_000)], []),  # wide groove
        ([(6_000, 4_960), (3_000, 4_960), (3_000, 5_000)], []),  # a leg of 40 um: one corner
        ([(6_000, 5_000), (5_950, 4_800), (5_900, 5_000)], ["passage"]),  # V notch, 100 um wide
        ([(6_000, 5_000), (6_000, 4_000), (5_850, 4_000), (5_850, 5_000)], ["passage"]),  # slot
        (
            [(6_000, 5_000), (6_000, 4_050), (5_970, 4_000), (4_000, 4_000), (4_000, 5_000)],
            [],
        ),  # chamfer
        ([(6_000, 4_960), (3_010, 4_960), (3_000, 4_970), (3_000, 5_000)], []),  # and a short leg
        ([(6_000, 4_960), (3_050, 4_960), (3_020, 4_960), (3_000, 4_960), (3_000, 4_990)], []),
        # Walls 2 degrees off parallel, the bottom narrower than the wire.
        ([(6_060, 5_000), (6_025, 4_000), (5_875, 4_000), (5_840, 5_000)], ["passage"]),
        ([(6_160, 5_000), (6_020, 1_000), (5_980, 1_000), (5_840, 5_000)], []),  # a blunt tip
    ],
    ids=[
        "groove",
        "short leg",
        "notch",
        "slot",
        "chamfer",
        "chamfer, leg",
        "split",
        "taper",
        "tip",
    ],
)
def test_corner_or_interference(notch, expected):
    assert kinds([*BASE, *notch, *TOP]) == expected


def wedge(angle, *tip, turned=0.0, reach=5_000.0):
    """A disc with a wedge taken out: its walls at 0 and ``angle`` degrees, its tip as given.

    ``tip``: pairs (along the one wall, along the other), um; each is a vertex.
    """
    b = np.radians(angle)
    u, v = np.array([1.0, 0.0]), np.array([np.cos(b), np.sin(b)])
    points = [reach * u, *(p * u + q * v for p, q in tip), reach * v]
    points += [2 * reach * np.array([np.cos(a), np.sin(a)]) for a in np.linspace(b, 2 * np.pi, 9)]
    c, s = np.cos(turned), np.sin(turned)
    return np.array(points) @ np.array([[c, s], [-s, c]])


def path_of(points, offset, hole=False):
    if hole:
        frame = parts.rectangle(30e3, 30e3, -15e3, -15e3)
        contour = parts.contour_of_bulges(points[::-1].copy(), np.zeros(len(points)))
        made, found = compensate([frame, contour], [-offset, offset])
        mine = [p.path for p in made.paths if p.outline == 1]
    else:
        contour = parts.contour_of_bulges(points, np.zeros(len(points)))
        area = np.sum(points[:, 0] * np.roll(points[:, 1], -1))
        area -= np.sum(points[:, 1] * np.roll(points[:, 0], -1))
        made, found = compensate([contour], [-offset if area > 0 else offset])
        mine = [p.path for p in made.paths]
    assert not found
    return made, mine


@given(
    st.floats(30.5, 175),
    st.floats(0.02, 0.95),
    st.floats(0.02, 0.95),
    st.sampled_from([50.0, 100.0, 250.0]),
    st.floats(0, 6.2),
    st.booleans(),
)
def test_a_chamfer_is_judged_as_its_corner(angle, p, q, offset, turned, split):
    """Whatever angle and legs; where the wire does not reach it the path is the corner's."""
    foot = offset / np.tan(np.radians(angle) / 2)
    legs = p * foot, q * foot
    tip = [(legs[0], 0), (0, legs[1])]
    if split:
        tip = [(legs[0] + 3, 0), tip[0], (0.5 * legs[0], 0.5 * legs[1]), tip[1], (0, legs[1] + 2)]
    made, mine = path_of(wedge(angle, *tip, turned=turned), offset)
    assert not made.interference
    _, sharp = path_of(wedge(angle, (0, 0), turned=turned), offset)
    room = np.hypot(*(foot, offset))  # from the tip to the wire's centre
    # How far the chamfer is from the wire's centre in the sharp corner.
    b = np.radians(angle)
    normal = np.array([legs[1] * np.sin(b), legs[0] - legs[1] * np.cos(b)])
    normal /= np.hypot(*normal)
    centre = room * np.array([np.cos(b / 2), np.sin(b / 2)])
    if normal @ centre - normal[0] * legs[0] > offset + 1:
        assert lengths(mine[0]).sum() == pytest.approx(lengths(sharp[0]).sum(), abs=0.05)
        assert made.inner_corners == 1


@pytest.mark.parametrize("hole", [False, True])
def test_corners_of_facets_and_fillets(hole):
    def found(angle, tip, offset=100.0):
        return [i.kind for i in path_of(wedge(angle, *tip), offset, hole)[0].interference]

    def facets(radius, count, angle=90):
        """A fillet in so many lines."""
        b = np.radians(angle)
        middle = radius / np.sin(b / 2)
        cx, cy = middle * np.cos(b / 2), middle * np.sin(b / 2)
        turns = np.linspace(-np.pi / 2, b + np.pi / 2 - 2 * np.pi, count + 1)
        x, y = cx + radius * np.cos(turns), cy + radius * np.sin(turns)
        v = y / np.sin(b)
        return list(zip(x - v * np.cos(b), v, strict=True))

    assert found(90, facets(60, 1)) == []
    assert found(90, facets(60, 3)) == []
    assert found(90, facets(60, 12)) == ["passage"]
    assert found(90, facets(30, 12)) == []  # within 0.05 mm
    assert found(150, facets(60, 2, 150)) == []
    assert found(40, [(15, 0), (0, 60)]) == []
    assert found(20, [(50, 0), (0, 50)]) == []
    assert found(20, [(400, 0), (0, 400)]) == ["passage"]  # a slot 0.139 mm wide


def test_a_fillet_stays_interference_however_small():
    square = np.array([(0, 0), (10e3, 0), (10e3, 10e3), (0, 10e3)], float)
    for radius in (5.0, 30.0, 90.0):
        contour = parts.contour_of_bulges(*parts.rounded(square, radius))
        made, _ = compensate([contour], [100.0])
        assert [i.kind for i in made.interference] == ["radius"] * 4


def test_the_largest_offset_takes_the_same_for_a_corner():
    def largest(*tip):
        points = wedge(90, *tip)
        contour = parts.contour_of_bulges(points, np.zeros(len(points)))
        return largest_offset([contour], [1.0 if _clockwise(points) else -1.0], 800.0)

    assert largest((0, 0)) == Largest(800.0, None)
    assert largest((20, 0), (0, 20)) == Largest(800.0, None)
    assert largest((200, 0), (0, 120)) == Largest(800.0, None)


def _clockwise(points):
    x, y = points[:, 0], points[:, 1]
    return np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0


def chamfered(space, size=1.0, layer="0"):
    """The outline of the plate as lines: an inner corner at (20, 20) with a chamfer of 0.02."""
    points = [(0, 0), (40, 0), (40, 20), (20.02, 20), (20, 20.02), (20, 40), (0, 40)]
    points = [(size * x, size * y) for x, y in points]
    for a, b in zip(points, points[1:] + points[:1], strict=True):
        space.add_line(a, b, dxfattribs={"layer": layer})


@pytest.mark.parametrize("units", [4, 1])
def test_field_inner_corner_chamfer(units):
    size = 1.0 if units == 4 else 1 / 25.4
    for more in ({}, {"transforms": ["rotate 33 about (0, 0)"]}, {"transforms": ["mirror 45"]}):
        made = api.compile(
            drawing(lambda _, m: chamfered(m, size), units=units), offset=0.1, **more
        )
        assert made.status == 0, made.findings
        said = {d.code: d.message for d in made.findings}
        assert set(said) == {"inner-corners", "uncut-corner"}
        assert said["inner-corners"].startswith("1 sharp inner corner")
        assert "up to 0.028 mm" in said["uncut-corner"]


def test_field_inner_corner_chamfer_of_a_hole():
    def draw(_, space):
        chamfered(space)
        space.add_lwpolyline([(-5, -5), (45, -5), (45, 45), (-5, 45)], close=True)

    for data, side in (
        (drawing(draw), "die"),
        (drawing(lambda _, m: chamfered(m)), "part"),
    ):
        made = api.compile(data, offset=0.1, side=side)
        assert made.status == 0, made.findings
        assert "uncut-corner" in {d.code for d in made.findings}

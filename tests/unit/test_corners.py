"""--corner: rounding the part's own corners."""

import numpy as np
import pytest

import parts
import wedmcam
from wedmcam.geom.measure import area, length
from wedmcam.ir.contour import Contour, vertices
from wedmcam.transforms.corners import round_corners


def test_rectangle_by_elementary_geometry():
    (c,), found = round_corners([parts.rectangle(20_000, 10_000)], 1_000)
    assert not found
    assert area(c.vertices) == pytest.approx(200e6 - (4 - np.pi) * 1e6)
    assert length(c.vertices, True) == pytest.approx(60_000 - 8_000 + 2 * np.pi * 1_000)


def test_line_meets_arc_and_arc_meets_arc():
    """A lens of two arcs, and a half disc: every joint becomes tangent."""
    half = Contour(vertices([(5_000, 0, 0, 0, 1, -1), (-5_000, 0, 0, 0, 0, -1)]), True)
    lens = Contour(vertices([(0, -4_000, -3_000, 0, 1, -1), (0, 4_000, 3_000, 0, 1, -1)]), True)
    for contour in (half, lens):
        (c,), found = round_corners([contour], 300)
        assert not found
        (again,), found = round_corners([c], 300)
        assert not found
        assert len(again.vertices) == len(c.vertices)  # nothing sharp is left
        assert 0 < abs(area(contour.vertices)) - abs(area(c.vertices)) < 2e5


def test_inner_corners_too():
    ell = Contour(
        vertices(
            [
                (x, y, 0, 0, 0, -1)
                for x, y in ((0, 0), (9e3, 0), (9e3, 4e3), (4e3, 4e3), (4e3, 9e3), (0, 9e3))
            ]
        ),
        True,
    )
    (c,), found = round_corners([ell], 500)
    assert not found
    assert sorted(c.vertices["turn"][c.vertices["turn"] != 0].tolist()) == [-1, 1, 1, 1, 1, 1]


def test_too_large_is_an_error_with_the_place():
    _, found = round_corners([parts.rectangle(20_000, 10_000)], 5_500)
    assert {d.code for d in found} == {"corner-too-large"}
    assert all("mm" in d.message for d in found)


def test_punch_and_die_of_one_outline_have_the_same_corners():
    outline = (parts.rectangle(20_000, 10_000),)
    for side in ("part", "die"):
        made = wedmcam.compile(parts.dxf_bytes(outline), offset=0.1, side=side, corner=0.2)
        assert made.ok
        radii = made.plan.cuts[0].path.vertices
        arcs = radii[radii["turn"] != 0]
        r = np.hypot(arcs["x"] - arcs["cx"], arcs["y"] - arcs["cy"])
        assert r == pytest.approx(300.0 if side == "part" else 100.0)

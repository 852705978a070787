import math

import numpy as np
import pytest

from parts import random_part
from wedmcam.geom import measure
from wedmcam.ir.contour import Contour, vertices

# A slot: 20 x 10 between two half circles of radius 5, the left one bulging out.
SLOT = vertices(
    [
        (0.0, 0.0, 0, 0, 0, 0),
        (20.0, 0.0, 20.0, 5.0, 1, 0),
        (20.0, 10.0, 0, 0, 0, 0),
        (0.0, 10.0, 0.0, 5.0, 1, 0),
    ]
)
CIRCLE = vertices([(13.0, 4.0, 3.0, 4.0, 1, 0)])
#: A square of 10 with a bite of radius 5 out of its right side.
BITTEN = vertices(
    [
        (0.0, 0.0, 0, 0, 0, 0),
        (10.0, 0.0, 10.0, 5.0, -1, 0),
        (10.0, 10.0, 0, 0, 0, 0),
        (0.0, 10.0, 0, 0, 0, 0),
    ]
)


@pytest.mark.parametrize(
    ("rows", "area", "length", "extents"),
    [
        (SLOT, 200 + 25 * math.pi, 40 + 10 * math.pi, (-5, 0, 25, 10)),
        (CIRCLE, 100 * math.pi, 20 * math.pi, (-7, -6, 13, 14)),
        (BITTEN, 100 - 12.5 * math.pi, 30 + 5 * math.pi, (0, 0, 10, 10)),
    ],
)
def test_known_shapes(rows, area, length, extents):
    assert measure.area(rows) == pytest.approx(area, rel=1e-14)
    assert measure.length(rows, True) == pytest.approx(length, rel=1e-14)
    assert measure.extents(rows, True) == pytest.approx(extents, abs=1e-12)
    back = Contour(rows.copy(), True).reversed().vertices
    assert measure.area(back) == pytest.approx(-area, rel=1e-14)
    assert measure.extents(back, True) == pytest.approx(extents, abs=1e-12)


def test_area_far_from_the_origin():
    far = SLOT.copy()
    for name in ("x", "y", "cx", "cy"):
        far[name] += 1e9
    assert measure.area(far) == pytest.approx(200 + 25 * math.pi, rel=1e-6)


def test_area_of_a_flat_arc():
    # Sagitta 1 um over a chord of 100 mm; the series against the exact segment area.
    radius = (1e5**2 / 4 + 1) / 2
    rows = vertices([(0, 0, 5e4, radius - 1, 1, 0), (1e5, 0, 0, 0, 0, 0)])
    assert measure.area(rows) == pytest.approx(2 / 3 * 1e5, rel=1e-9)


def test_open_contour():
    rows = SLOT[:3].copy()
    rows["turn"][-1] = 0
    assert measure.length(rows, False) == pytest.approx(20 + 5 * math.pi)
    assert measure.extents(rows, False) == pytest.approx((0, 0, 25, 10))


@pytest.mark.parametrize(
    ("at", "want"),
    [
        (0, (0, 0, 0)),
        (5, (5, 0, 0)),
        (20, (20, 0, 1)),
        (20 + 2.5 * math.pi, (25, 5, 1)),
        (40 + 10 * math.pi, (0, 0, 0)),
        (-2.5 * math.pi, (-5, 5, 3)),
    ],
)
def test_point_at(at, want):
    x, y, row = measure.point_at(SLOT, True, at)
    assert (x, y) == pytest.approx(want[:2], abs=1e-12)
    assert row == want[2] or at > 60


def test_point_at_is_clamped_on_open_contours():
    rows = SLOT[:2].copy()
    rows["turn"][-1] = 0
    assert measure.point_at(rows, False, -3)[:2] == (0, 0)
    assert measure.point_at(rows, False, 99)[:2] == (20, 0)


@pytest.mark.parametrize("turn", [1, -1])
def test_contains_level_with_vertices_and_apexes(turn):
    rows = SLOT if turn > 0 else Contour(SLOT.copy(), True).reversed().vertices
    points = [(10, 5, 1), (-4.9, 5, 1), (-5.1, 5, 0), (24.9, 5, 1), (25.1, 5, 0), (-10, 0, 0)]
    points += [
        (-10, 10, 0),
        (30, 0, 0),
        (-3, 1, 1),
        (-4.9, 0.1, 0),
        (10, 0.001, 1),
        (10, -0.001, 0),
    ]
    x, y, want = (np.array(c, float) for c in zip(*points, strict=True))
    assert measure.contains(rows, x, y).tolist() == want.astype(bool).tolist()


def test_contains_a_concave_arc():
    got = measure.contains(BITTEN, np.array([4.0, 6.0, 9.9, 9.0]), np.array([5.0, 5.0, 5.0, 0.05]))
    assert got.tolist() == [True, False, False, True]


def test_extents_of_many_are_those_of_each():
    some = [c for seed in range(40) for c in random_part(seed)]
    some += [Contour(BITTEN, False), Contour(BITTEN[2:], False)]
    each = [measure.extents(c.vertices, c.closed) for c in some]
    both = [(c.vertices, c.closed) for c in some]
    assert measure.extents_of_all(both).tolist() == [list(e) for e in each]
    segments, starts = measure.segments_of_all(both)
    assert np.diff(starts, append=len(segments)).tolist() == [len(c) for c in some]

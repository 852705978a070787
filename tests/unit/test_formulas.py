"""Where two curves meet: every kind of pair, near and far centres, against 50 digits."""

import math

import mpmath
import numpy as np
import pytest

from wedmcam.arithmetic import FLOAT64
from wedmcam.decimal8 import DECIMAL8
from wedmcam.geom.formulas import Curve, meeting

#: Radii, um; 0 is a line.
RADII = [0.0, 300.0, 20_000.0, 1e6, 1e7, 3e8]


def curve(ar, through, heading, curvature):
    """A curve through a point, its tangent at ``heading`` radians there."""
    normal = -math.sin(heading), math.cos(heading)
    column = [ar.array(np.array([v])) for v in (*through, *normal, curvature)]
    return Curve((column[0], column[1]), (column[2], column[3]), column[4])


def seen_from(point, heading, curvature, away):
    """The point of a curve ``away`` um from another along it, and the heading there."""
    with mpmath.workdps(50):
        h, k = mpmath.mpf(heading), mpmath.mpf(curvature)
        x, y = mpmath.mpf(point[0]), mpmath.mpf(point[1])
        if not k:
            return float(x + away * mpmath.cos(h)), float(y + away * mpmath.sin(h)), heading
        to = h + k * away
        x += (mpmath.sin(to) - mpmath.sin(h)) / k
        y += (mpmath.cos(h) - mpmath.cos(to)) / k
        return float(x), float(y), float(to)


@pytest.mark.parametrize("ar", [FLOAT64, DECIMAL8], ids=lambda a: a.name)
@pytest.mark.parametrize("one", RADII)
@pytest.mark.parametrize("two", RADII)
def test_curves_through_one_point_meet_there(ar, one, two):
    rng = np.random.default_rng(int(one + 7 * two) % 2**31)
    for _ in range(20):
        at = rng.uniform(-50_000, 50_000, 2)
        first, cut = rng.uniform(0, 7), rng.uniform(0.3, 2.8)
        curves = []
        for radius, heading in ((one, first), (two, first + cut)):
            k = 0.0 if not radius else rng.choice([-1, 1]) / radius
            away = rng.uniform(-1, 1) * min(radius or 400.0, 400.0)
            x, y, h = seen_from(at, heading, k, away)
            curves.append(curve(ar, (x, y), h, k))
        found = [(ar.to_float(x)[0], ar.to_float(y)[0]) for x, y in meeting(ar, *curves)]
        off = min(math.hypot(x - at[0], y - at[1]) for x, y in found)
        assert off < (0.03 if ar is DECIMAL8 else 1e-6)


@pytest.mark.parametrize("ar", [FLOAT64, DECIMAL8], ids=lambda a: a.name)
def test_known_crossings(ar):
    """x^2 + y^2 = 25 with y = 3, and with the circle of radius 5 about (8, 0)."""
    circle = curve(ar, (5, 0), math.pi / 2, 0.2)
    line = curve(ar, (0, 3), 0.0, 0.0)
    other = curve(ar, (3, 0), math.pi / 2, -0.2)
    for pair, want in (((circle, line), [(-4, 3), (4, 3)]), ((circle, other), [(4, -3), (4, 3)])):
        for order in (pair, pair[::-1]):
            found = [(ar.to_float(x)[0], ar.to_float(y)[0]) for x, y in meeting(ar, *order)]
            assert sorted((round(x, 6), round(y, 6)) for x, y in found) == want


def test_curves_that_miss_give_the_nearest_place():
    circle, line = curve(FLOAT64, (5, 0), math.pi / 2, 0.2), curve(FLOAT64, (0, 5.001), 0.0, 0.0)
    for x, y in meeting(FLOAT64, circle, line):
        assert math.hypot(x[0], y[0] - 5.001) < 1e-9

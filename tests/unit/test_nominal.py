"""J by geometry against a fine sum over the arc, and the end computed from it."""

import numpy as np

from wedmcam.controllers.pointwise.nominal import nominal_count, nominal_end
from wedmcam.ir.program import Axis


def test_known_programs():
    assert nominal_count(-2000, 9000, 1, 9000, -2000, Axis.Y) == 25440
    assert nominal_count(9000, -2000, -1, -2000, 9000, Axis.X) == 25440


def test_sum_of_projections_by_brute_force():
    rng = np.random.default_rng(3)
    for _ in range(400):
        r = 10 ** rng.uniform(1.5, 4)
        a, sweep = rng.uniform(0, 2 * np.pi), rng.uniform(0.05, 2 * np.pi - 0.05)
        turn, axis = rng.choice([-1, 1]), rng.choice([0, 1])
        x, y = np.rint(r * np.cos(a)), np.rint(r * np.sin(a))
        ex, ey = np.rint(r * np.cos(a + turn * sweep)), np.rint(r * np.sin(a + turn * sweep))
        if (x, y) == (ex, ey):
            continue
        a0 = np.arctan2(y, x)
        whole = np.mod((np.arctan2(ey, ex) - a0) * turn, 2 * np.pi)
        t = a0 + turn * np.linspace(0, whole, 20_001)
        g = np.hypot(x, y) * (np.cos(t) if axis == 0 else np.sin(t))
        expected = np.abs(np.diff(g)).sum()
        # R is rounded (half a micron for each of up to 4 legs), the end lies off its circle.
        assert abs(nominal_count(x, y, turn, ex, ey, axis) - expected) < 4.5


def test_the_end_comes_back_from_j():
    rng = np.random.default_rng(4)
    n = 2000
    r, a = 10 ** rng.uniform(2, 5, n), rng.uniform(0, 2 * np.pi, n)
    sweep, turn = rng.uniform(0.01, 2 * np.pi - 0.01, n), rng.choice([-1, 1], n)
    x, y = np.rint(r * np.cos(a)), np.rint(r * np.sin(a))
    radius = np.hypot(x, y)
    end = np.arctan2(y, x) + turn * sweep
    ex, ey = np.rint(radius * np.cos(end)), np.rint(radius * np.sin(end))
    axis = np.where(np.abs(ex) >= np.abs(ey), int(Axis.Y), int(Axis.X))
    count = nominal_count(x, y, turn, ex, ey, axis)
    gx, gy = nominal_end(x, y, turn, axis, count)
    assert np.abs(gx - ex).max() <= 1
    assert np.abs(gy - ey).max() <= 1
    # The coordinate on the counting axis is exact.
    assert (np.where(axis == Axis.X, gx - ex, gy - ey) == 0).all()


def test_full_circles():
    for x, y in ((9900, 0), (0, 9900), (-9900, 0), (0, -9900), (3000, 4000)):
        for turn in (1, -1):
            for axis in (0, 1):
                j = nominal_count(x, y, turn, x, y, axis)
                assert j == 4 * round(np.hypot(x, y))
                gx, gy = nominal_end(x, y, turn, axis, j)
                assert (int(gx), int(gy)) == (x, y)

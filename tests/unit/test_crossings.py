"""Crossings of lines and arcs, near tangency and at ends."""

import numpy as np
import pytest

from wedmcam.geom import crossings
from wedmcam.geom import segments as seg


def made(*rows):
    """Segments from (x0, y0, x1, y1, cx, cy, turn)."""
    c = np.array(rows, float).T
    return seg.make(*c[:6], c[6].astype(np.int8))


def line(x0, y0, x1, y1):
    return (x0, y0, x1, y1, 0.0, 0.0, 0)


def arc(cx, cy, r, start, end, turn=1):
    """Arc by its angles in degrees."""
    a, b = np.radians(start), np.radians(end)
    full = (end - start) % 360 == 0
    x0, y0 = cx + r * np.cos(a), cy + r * np.sin(a)
    x1, y1 = (x0, y0) if full else (cx + r * np.cos(b), cy + r * np.sin(b))
    return (x0, y0, x1, y1, cx, cy, turn)


def crossing(a, b):
    """Points, sorted, the same whichever of the two comes first."""
    found = []
    for s in (made(a, b), made(b, a)):
        c = crossings.between(s, np.array([0]), np.array([1]))
        points = sorted(zip(c.x.tolist(), c.y.tolist(), strict=True))
        for k in range(len(c.i)):
            for which, at in ((c.i, c.at_i), (c.j, c.at_j)):
                x, y = seg.points_at(s.take(which[k : k + 1]), at[k : k + 1])
                assert np.hypot(x[0] - c.x[k], y[0] - c.y[k]) < 2e-5
        found.append(points)
    assert np.allclose(found[0], found[1], rtol=0, atol=1e-9)
    return found[0]


@pytest.mark.parametrize(
    ("a", "b", "points"),
    [
        (line(0, 0, 10, 10), line(0, 10, 10, 0), [(5, 5)]),
        (line(0, 0, 10, 0), line(5, 0, 5, 5), [(5, 0)]),  # ends on it
        (line(0, 0, 10, 0), line(10, 0, 20, 7), [(10, 0)]),  # common end
        (line(0, 0, 10, 0), line(5, 0.001, 5, 5), []),  # ends short of it
        (line(0, 0, 10, 0), line(2, 0, 20, 0), []),  # collinear: none by definition
        (line(0, 0, 10, 0), line(0, 1, 10, 1), []),
        (line(-10, 3, 10, 3), arc(0, 0, 5, 0, 360), [(-4, 3), (4, 3)]),
        (line(-10, 3, 10, 3), arc(0, 0, 5, 0, 90), [(4, 3)]),
        (line(-10, 3, 10, 3), arc(0, 0, 5, 90, 0, -1), [(4, 3)]),
        (line(-10, 3, 0, 3), arc(0, 0, 5, 0, 90), []),
        (line(-10, 5, 10, 5), arc(0, 0, 5, 0, 180), [(0, 5)]),  # tangent, once
        (line(-10, 5.001, 10, 5.001), arc(0, 0, 5, 0, 180), []),
        (line(5, 0, 5, 9), arc(0, 0, 5, 0, 90), [(5, 0)]),  # tangent at a common end
        (line(0, 0, 9, 0), arc(0, 0, 5, 350, 10), [(5, 0)]),  # across the wrap of the angle
        (line(0, 0, -9, 0), arc(0, 0, 5, 170, 190), [(-5, 0)]),
        (arc(0, 0, 5, 0, 360), arc(6, 0, 5, 0, 360), [(3, -4), (3, 4)]),
        (arc(0, 0, 5, 0, 180), arc(6, 0, 5, 0, 180), [(3, 4)]),
        (arc(0, 0, 5, 0, 360), arc(10, 0, 5, 0, 360), [(5, 0)]),  # tangent outside, once
        (arc(0, 0, 5, 0, 360), arc(3, 0, 2, 0, 360), [(5, 0)]),  # tangent inside, once
        (arc(0, 0, 5, 0, 360), arc(10.001, 0, 5, 0, 360), []),
        (arc(0, 0, 5, 0, 360), arc(1, 0, 2, 0, 360), []),  # one in the other
        (arc(0, 0, 5, 0, 90), arc(0, 0, 5, 45, 135), []),  # one circle: none by definition
        (arc(0, 0, 5, 0, 90), arc(0, 0, 4, 0, 90), []),
    ],
)
def test_crossings(a, b, points):
    assert np.allclose(crossing(a, b), points, rtol=0, atol=1e-6) if points else not crossing(a, b)


@pytest.mark.parametrize("depth", [1e-1, 1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("radius", [1e2, 1e4, 1e6])
def test_near_tangent_roots_stay_two(depth, radius):
    """A line that cuts a circle by ``depth`` has roots 2 sqrt(2 R depth) apart."""
    reach = radius
    found = crossing(line(-reach, radius - depth, reach, radius - depth), arc(0, 0, radius, 0, 180))
    assert len(found) == 2
    apart = found[1][0] - found[0][0]
    expected = 2 * np.sqrt(2 * radius * depth - depth * depth)
    # The depth itself is known to the rounding of the radius.
    assert apart == pytest.approx(expected, rel=4 * np.finfo(float).eps * radius / depth + 1e-9)


def test_many_pairs_at_once_are_the_single_ones():
    rng = np.random.default_rng(5)
    rows = [line(*rng.uniform(-9, 9, 4)) for _ in range(20)]
    rows += [
        arc(*rng.uniform(-5, 5, 2), rng.uniform(1, 9), *rng.uniform(0, 360, 2), rng.choice([-1, 1]))
        for _ in range(20)
    ]
    s = made(*rows)
    i, j = np.triu_indices(len(rows), 1)
    c = crossings.between(s, i, j)
    single = sum(len(crossing(rows[a], rows[b])) for a, b in zip(i, j, strict=True))
    assert len(c.i) == single > 100

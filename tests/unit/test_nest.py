import numpy as np
import pytest

from drawings import polygon, sketch
from wedmcam.transforms.chain import chain
from wedmcam.transforms.nest import nest


def square(x, y, size):
    return polygon((x, y), (x + size, y), (x + size, y + size), (x, y + size))


def ring(x, y, r):
    return [(x + r, y, x + r, y, x, y, 1)]


def nested(*shapes):
    contours, _, _ = chain(sketch([row for shape in shapes for row in shape]))
    return nest(contours)


def test_nothing():
    assert nest(()).depths == ()


def test_four_deep_and_two_outers():
    n = nested(
        square(0, 0, 1000),
        ring(500, 500, 400),
        square(300, 300, 400),
        ring(500, 500, 100),
        square(2000, 0, 1000),
    )
    by_size = sorted(zip(n.depths, n.parents, strict=True))
    assert [d for d, _ in by_size] == [0, 0, 1, 2, 3]
    for index, (depth, parent) in enumerate(zip(n.depths, n.parents, strict=True)):
        assert parent == -1 if depth == 0 else n.depths[parent] == depth - 1, index
    assert len(n.outer) == 3
    assert len(n.holes) == 2


def test_smaller_is_not_inside():
    # In the box of the ring's belly, outside the ring: size and boxes say nothing.
    n = nested(ring(0, 0, 1000), square(750, 750, 200))
    assert n.depths == (0, 0)


def test_larger_contour_inside():
    # A comb has a longer outline than the plate around it.
    comb = []
    points = [(0, 0)]
    for k in range(50):
        points += [(10 * k, 900), (10 * k + 5, 900), (10 * k + 5, 10), (10 * k + 10, 10)]
    points += [(500, 0)]
    comb = polygon(*points)
    n = nested(square(-100, -100, 1200), comb)
    assert n.depths == (0, 1)
    assert n.parents == (-1, 0)


@pytest.mark.parametrize(
    "inner",
    [
        polygon((0, 0), (300, 100), (100, 300)),  # touches in a vertex
        polygon((0, 500), (300, 400), (300, 600)),  # a vertex on a side
        ring(200, 500, 200),  # tangent to a side
    ],
)
def test_inner_touches_outer(inner):
    n = nested(square(0, 0, 1000), inner)
    assert sorted(n.depths) == [0, 1]


def test_open_contours_have_a_depth_and_enclose_nothing():
    n = nested(square(0, 0, 1000), [(100, 100, 900, 900)], ring(500, 200, 50))
    assert n.depths == (0, 1, 1)
    assert n.parents == (-1, 0, 0)


def test_many():
    rings = [ring(100 * (k % 40), 100 * (k // 40), 30) for k in range(1600)]
    n = nested(square(-200, -200, 5000), *rings)
    assert n.depths[0] == 0
    assert np.all(np.array(n.depths[1:]) == 1)
    assert set(n.parents[1:]) == {0}

"""Box pairs against the obvious comparison of all with all."""

import numpy as np
import pytest

from wedmcam.geom import pairs


def boxes(rng, n, size):
    x, y = np.round(rng.uniform(-50, 50, (2, n)))
    return x, y, x + np.round(rng.uniform(0, size, n)), y + np.round(rng.uniform(0, size, n))


def all_with_all(a, b):
    ax0, ay0, ax1, ay1 = (c[:, None] for c in a)
    bx0, by0, bx1, by1 = b
    return np.nonzero((ax0 <= bx1) & (bx0 <= ax1) & (ay0 <= by1) & (by0 <= ay1))


@pytest.mark.parametrize("seed", range(60))
def test_overlapping_is_all_with_all(seed):
    rng = np.random.default_rng(seed)
    a = boxes(rng, int(rng.integers(1, 40)), rng.choice([0, 1, 10, 80]))
    b = boxes(rng, int(rng.integers(1, 40)), rng.choice([0, 1, 10, 80]))
    i, j = pairs.overlapping(a, b)
    expected = all_with_all(a, b)
    assert (i.tolist(), j.tolist()) == (expected[0].tolist(), expected[1].tolist())
    i, j = pairs.self_overlapping(a)
    k, m = all_with_all(a, a)
    assert (i.tolist(), j.tolist()) == (k[k < m].tolist(), m[k < m].tolist())


def test_boxes_that_touch_far_out_are_a_pair():
    """At 10 m, and many strips away from the first."""
    x = np.array([0.0, 1e7, 1e7 + 1.0])
    y = np.array([0.0, 1e7, 1e7 + 1.0])
    i, j = pairs.self_overlapping((x, y, x + 1.0, y + 1.0))
    assert (i.tolist(), j.tolist()) == ([1], [2])


def test_nothing_with_nothing():
    none = np.empty(0)
    empty = (none, none, none, none)
    assert len(pairs.overlapping(empty, empty)[0]) == 0
    assert len(pairs.self_overlapping(empty)[0]) == 0


def test_least_of_each():
    values, of = np.array([3.0, 1.0, 2.0]), np.array([0, 0, 2])
    assert pairs.least(values, of, 4).tolist() == [1.0, np.inf, 2.0, np.inf]
    assert pairs.least(np.empty(0), np.empty(0, np.int64), 2).tolist() == [np.inf, np.inf]


def test_expand():
    row, k = pairs.expand(np.array([2, 5, 1]), np.array([4, 5, 2]))
    assert (row.tolist(), k.tolist()) == ([0, 0, 2], [2, 3, 1])

"""The judge's own geometry, against published or obvious figures and against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.ir.contour import Contour, vertices
from wedmcam.judge import segments as sg

finite = st.integers(-2000, 2000).map(float)


def one(ax, ay, bx, by, cx=0.0, cy=0.0, turn=0):
    return sg.segments(*(np.array([float(v)]) for v in (ax, ay, bx, by, cx, cy, turn)))


@st.composite
def any_segment(draw):
    turn = draw(st.sampled_from([0, 1, -1]))
    if turn == 0:
        a, b = draw(st.tuples(finite, finite)), draw(st.tuples(finite, finite))
        if a == b:
            b = (a[0] + 1, a[1])
        return one(*a, *b)
    c, r = draw(st.tuples(finite, finite)), draw(st.integers(5, 1500))
    a0, sweep = draw(st.floats(-3, 3)), draw(st.floats(0.01, 6.2))
    a1 = a0 + turn * sweep
    return one(
        c[0] + r * np.cos(a0),
        c[1] + r * np.sin(a0),
        c[0] + r * np.cos(a1),
        c[1] + r * np.sin(a1),
        *c,
        turn,
    )


def chords(s, n=1500):
    t = np.linspace(0, float(s.length[0]), n if s.turn[0] else 2)
    many = s.take(np.zeros(len(t), int))
    return shapely.LineString(np.column_stack(sg.points_at(many, t)))


@settings(max_examples=150, deadline=None)
@given(any_segment(), finite, finite)
def test_point_distance(s, x, y):
    d = sg.point_distance(s, np.array([x]), np.array([y]))[0]
    assert d == pytest.approx(shapely.distance(chords(s), shapely.Point(x, y)), abs=5e-3)


@settings(max_examples=250, deadline=None)
@given(any_segment(), any_segment())
def test_segment_distance(a, b):
    d = sg.segment_distance(a, b)[0]
    near = chords(a).distance(chords(b))
    # Chords of two arcs may cross where the arcs just miss each other: half a square root of tol.
    assert d == pytest.approx(near, abs=5e-3) or (min(d, near) == 0 and max(d, near) < 2e-2)
    assert sg.segment_distance(b, a)[0] == pytest.approx(d, abs=1e-6)


@pytest.mark.parametrize(
    ("a", "b", "wanted"),
    [
        (one(0, 0, 10, 0), one(5, -5, 5, 5), 0.0),
        (one(0, 0, 10, 0), one(0, 3, 10, 3), 3.0),
        (one(10, 0, 10, 0, 0, 0, 1), one(-50, 12, 50, 12), 2.0),
        (one(10, 0, 10, 0, 0, 0, 1), one(-50, 5, 50, 5), 0.0),
        (one(10, 0, 10, 0, 0, 0, 1), one(4, 0, 4, 0, 0, 0, 1), 6.0),
        (one(10, 0, 10, 0, 0, 0, 1), one(40, 0, 40, 0, 30, 0, -1), 10.0),
        (one(10, 0, 10, 0, 0, 0, 1), one(22, 0, 22, 0, 12, 0, -1), 0.0),
        (one(10, 0, 0, 10, 0, 0, 1), one(9, 9, 20, 20), np.hypot(9, 9) - 10),
    ],
)
def test_segment_distance_by_hand(a, b, wanted):
    assert sg.segment_distance(a, b)[0] == pytest.approx(wanted, abs=1e-9)


@settings(max_examples=100, deadline=None)
@given(any_segment())
def test_boxes_hold_their_segments_closely(s):
    low_x, low_y, high_x, high_y = sg.boxes(s)[0]
    assert (low_x, low_y, high_x, high_y) == pytest.approx(chords(s).bounds, abs=5e-3)


@settings(max_examples=100, deadline=None)
@given(any_segment(), st.floats(0.05, 0.9), st.floats(0.01, 0.1))
def test_sub_segments_reverse_and_shift(s, start, length):
    a, b = s.length * start, s.length * (start + length)
    piece = sg.sub_segments(s, a, b)
    assert piece.length[0] == pytest.approx(float(b[0] - a[0]), abs=1e-6)
    for part in (0.0, 0.5, 1.0):
        x, y = sg.points_at(piece, piece.length * part)
        wx, wy = sg.points_at(s, a + piece.length * part)
        assert (x[0], y[0]) == pytest.approx((wx[0], wy[0]), abs=1e-6)
    back = sg.reverse(s)
    x, y = sg.points_at(back, back.length - a)
    wx, wy = sg.points_at(s, a)
    assert (x[0], y[0]) == pytest.approx((wx[0], wy[0]), abs=1e-6)
    moved = sg.shifted(s, 2.0)
    share = moved.length * start
    x, y = sg.points_at(moved, share)
    nx, ny = sg.normals_at(s, a)
    assert (x[0], y[0]) == pytest.approx((wx[0] + 2 * nx[0], wy[0] + 2 * ny[0]), abs=1e-6)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_near_pairs_are_all_and_only_those_that_touch(seed):
    rng = np.random.default_rng(seed)

    def some(n):
        low = rng.uniform(0, 1000, (n, 2))
        return np.hstack([low, low + rng.uniform(0, 60, (n, 2))])

    a, b = some(rng.integers(1, 200)), some(rng.integers(1, 200))
    touch = (a[:, None, :2] <= b[None, :, 2:]).all(axis=2)
    touch &= (a[:, None, 2:] >= b[None, :, :2]).all(axis=2)
    i, j = sg.near_pairs(a, b)
    assert np.column_stack([i, j]).tolist() == np.argwhere(touch).tolist()


def test_near_pairs_of_none():
    i, j = sg.near_pairs(np.zeros((0, 4)), np.zeros((3, 4)))
    assert len(i) == len(j) == 0


def test_parity_with_arcs():
    """A slot of two half circles, a full circle in it, and an arc that bulges inwards."""
    slot = Contour(
        vertices(
            [
                (0, -10, 0, 0, 0, -1),
                (40, -10, 40, 0, 1, -1),
                (40, 10, 0, 0, 0, -1),
                (0, 10, 0, 0, 1, -1),
            ]
        ),
        True,
    )
    ring = Contour(vertices([(45, 0, 40, 0, -1, -1)]), True)
    bite = Contour(
        vertices(
            [
                (100, 0, 0, 0, 0, -1),
                (140, 0, 0, 0, 0, -1),
                (140, 20, 0, 0, 0, -1),
                (130, 20, 120, 20, -1, -1),
                (110, 20, 0, 0, 0, -1),
                (100, 20, 0, 0, 0, -1),
            ]
        ),
        True,
    )
    s = sg.join(sg.of_contour(c) for c in (slot, ring, bite))
    points = {
        (20, 0): True,
        (-9, 0): True,
        (-11, 0): False,
        (49, 0): True,
        (51, 0): False,
        (40, 0): False,
        (36, 0): False,
        (34, 0): True,
        (0, 10.5): False,
        (0, -9.5): True,
        (120, 25): True,  # the arc runs clockwise from (130, 20): below the chord
        (105, 10): True,
    }
    x, y = np.array(list(points), float).T
    inside = sg.inside_parity(s, x, y)
    wanted = np.array(list(points.values()))
    polygon = shapely.Polygon()
    from wedmcam.judge.witness import ring as chords_of

    for c in (slot, ring, bite):
        polygon = polygon.symmetric_difference(shapely.Polygon(chords_of(c)))
    by_shapely = shapely.contains_xy(polygon, x, y)
    assert inside.tolist() == by_shapely.tolist()
    assert inside[:-2].tolist() == wanted[:-2].tolist()


def test_nearest_is_brute_force():
    rng = np.random.default_rng(5)
    s = sg.polyline(np.cumsum(rng.normal(0, 30, 200)), np.cumsum(rng.normal(0, 30, 200)))
    x, y = s.ax[::3] + rng.normal(0, 40, 67), s.ay[::3] + rng.normal(0, 40, 67)
    d, k = sg.nearest(s, x, y, 25.0)
    every = np.array(
        [sg.point_distance(s, np.full(1, a), np.full(1, b)) for a, b in zip(x, y, strict=True)]
    )
    least = every.min(axis=1)
    assert np.where(least <= 25.0, least, np.inf).tolist() == d.tolist()
    assert (k[np.isinf(d)] == -1).all()

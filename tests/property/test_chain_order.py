"""Chaining depends on the geometry alone: not on order, direction or place of entities."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from drawings import polygon, sketch
from wedmcam.geom import measure
from wedmcam.ir.sketch import Sketch
from wedmcam.transforms.chain import chain
from wedmcam.transforms.nest import nest


def gear(teeth: int, radius: float, x: float, y: float) -> list[tuple[float, ...]]:
    """Return arcs and lines around a centre."""
    rows: list[tuple[float, ...]] = []
    step = 2 * math.pi / teeth
    for k in range(teeth):
        r = (radius, radius, 1.2 * radius, 1.2 * radius, radius)
        a = (k * step + part * step for part in (0, 0.4, 0.5, 0.9, 1.0))
        p = [(x + s * math.cos(t), y + s * math.sin(t)) for s, t in zip(r, a, strict=True)]
        rows += [(*p[0], *p[1], x, y, 1), (*p[1], *p[2]), (*p[2], *p[3], x, y, 1), (*p[3], *p[4])]
    return rows


shapes = st.tuples(
    st.sampled_from(["gear", "star", "ring", "open"]),
    st.integers(3, 9),
    st.floats(100, 900),
)


heaps = st.lists(shapes, min_size=1, max_size=5)
seeds = st.integers(0, 2**32)


def heap(kinds) -> list[tuple[float, ...]]:
    rows: list[tuple[float, ...]] = []
    for k, (kind, n, size) in enumerate(kinds):
        x, y = 3000.0 * (k % 3), 3000.0 * (k // 3)
        if kind == "gear":
            rows += gear(n, size, x, y)
        elif kind == "ring":
            rows.append((x + size, y, x + size, y, x, y, 1))
        else:
            around = [
                (
                    x + size * (1 + k % 2) * math.cos(2 * math.pi * k / 2 / n),
                    y + size * (1 + k % 2) * math.sin(2 * math.pi * k / 2 / n),
                )
                for k in range(2 * n)
            ]
            rows += polygon(*around, closed=kind == "star")
    return rows


def shaken(given_sketch: Sketch, seed: int, noise: float) -> tuple[Sketch, Sketch]:
    """Return the sketch with noise on its ends, and that one shuffled and partly reversed."""
    rng = np.random.default_rng(seed)
    rows = given_sketch.segments.copy()
    ends = ("x0", "y0", "x1", "y1")
    full = (rows["turn"] != 0) & (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
    for name in ends:
        rows[name] += np.where(full, 0.0, rng.uniform(-noise, noise, len(rows)))
    other = rows[rng.permutation(len(rows))].copy()
    back = rng.random(len(rows)) < 0.5
    for a, b in (("x0", "x1"), ("y0", "y1")):
        other[a], other[b] = np.where(back, other[b], other[a]), np.where(back, other[a], other[b])
    other["turn"] = np.where(back, -other["turn"], other["turn"])
    return Sketch(rows, given_sketch.sources), Sketch(other, given_sketch.sources)


def image(contours) -> list[tuple[bool, bytes]]:
    names = ["x", "y", "cx", "cy", "turn"]
    return [(c.closed, b"".join(c.vertices[n].tobytes() for n in names)) for c in contours]


@given(heaps, seeds, st.sampled_from([0, 1e-5, 2]))
def test_order_and_direction_do_not_matter(kinds, seed, noise):
    one, other = shaken(sketch(heap(kinds)), seed, noise)
    a, report_a, found_a = chain(one)
    b, report_b, found_b = chain(other)
    assert image(a) == image(b)
    assert report_a == report_b
    assert [(d.code, d.message) for d in found_a] == [(d.code, d.message) for d in found_b]
    assert nest(a).depths == nest(b).depths


@given(heaps, seeds)
def test_drawing_twice_changes_nothing(kinds, seed):
    once = sketch(heap(kinds))
    _, other = shaken(once, seed, 0.0)
    twice = Sketch(np.concatenate([once.segments, other.segments]), once.sources)
    a, _, _ = chain(once)
    b, report, _ = chain(twice)
    assert image(a) == image(b)
    assert report.duplicates == len(once.segments)


@given(heaps, seeds, st.floats(0, 4))
def test_small_gaps_change_little(kinds, seed, noise):
    drawn = sketch(heap(kinds))
    a, _, _ = chain(drawn)
    b, report, _ = chain(shaken(drawn, seed, noise / 2)[1], join_um=10.0)
    assert [c.closed for c in a] == [c.closed for c in b]
    length = sum(measure.length(c.vertices, c.closed) for c in a)
    assert abs(sum(measure.length(c.vertices, c.closed) for c in b) - length) <= (
        8 * (noise + 1e-6) * len(drawn.segments)
    )
    assert report.max_shift_um <= 20


@given(st.lists(shapes, min_size=1, max_size=4))
def test_closed_contours_are_counter_clockwise_and_connected(kinds):
    for contour in chain(sketch(heap(kinds)))[0]:
        if contour.closed:
            assert measure.area(contour.vertices) > 0
            v = contour.vertices
            first = min(zip(v["y"].tolist(), v["x"].tolist(), strict=True))
            assert len(v) == 1 or first == (v["y"][0], v["x"][0])
        s = measure.segments_of(contour.vertices, contour.closed)
        miss = np.hypot(s.x1 - s.cx, s.y1 - s.cy) - s.radius
        assert np.all(np.abs(miss[s.turn != 0]) < 1e-6)

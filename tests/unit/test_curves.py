"""Curves of pictures: few places, none of them far from what they stand for."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wedmcam
from wedmcam.reports.picture.curves import MOST, Samples, Trail
from wedmcam.reports.picture.simulation import plot_run

KEY = Path(__file__).parents[1] / "golden" / "key-punch.zd"


def distance(places, line):
    """Return the largest distance of places from a polyline."""
    a, b = line[:-1], line[1:]
    way = b - a
    length = np.maximum((way**2).sum(axis=1), 1e-18)
    out = 0.0
    for place in places:
        part = np.clip(((place - a) * way).sum(axis=1) / length, 0, 1)
        out = max(out, float(np.hypot(*(a + part[:, None] * way - place).T).min()))
    return out


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3000))
def test_a_trail_keeps_its_shape(seed, count):
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.2, count) + (rng.random(count) < 0.01) * 2)
    places = np.cumsum(np.column_stack([np.cos(heading), np.sin(heading)]), axis=0)
    trail = Trail(3.0)
    trail.add(places)
    kept, runs = trail.places()
    assert len(kept) == len(runs)
    assert not runs.any()
    assert (kept[0] == places[0]).all()
    assert (kept[-1] == places[-1]).all()
    # Places of a cell are one (3 x sqrt 2), and thirteen passes leave out what is nearer than 3/8.
    if count > 1:
        assert distance(places[:: max(1, count // 200)], kept) < 3 * 2**0.5 + 13 * 3 / 8


def test_a_long_trail_is_short():
    t = np.linspace(0, 2000 * np.pi, 1_000_000)
    trail = Trail(1e-3)
    trail.add(np.column_stack([t / 100 + np.cos(t), np.sin(t)]))
    assert len(trail.places()[0]) <= MOST
    trail = Trail(1e-3)
    trail.add(np.column_stack([t, 2 * t]))
    assert len(trail.places()[0]) < 400  # a straight line


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 50_000), st.integers(1, 5))
def test_samples_keep_extremes(seed, count, parts):
    rng = np.random.default_rng(seed)
    time, value = np.cumsum(rng.random(count)), rng.integers(0, 1000, count)
    samples = Samples(float(time[0]), float(time[-1]))
    run = np.zeros(count, np.int64)
    for rows in np.array_split(np.arange(count), parts):
        samples.add(time[rows], value[rows], run[rows])
    points, runs = samples.points()
    assert len(points) == len(runs) <= 4 * (Samples.SLOTS + parts)
    assert (points[:, 1].min(), points[:, 1].max()) == (value.min(), value.max())
    assert (np.diff(points[:, 0]) >= 0).all()
    assert {tuple(p) for p in points.tolist()} <= set(zip(time, value, strict=True))


@pytest.mark.parametrize("count", [0, 200])
def test_a_picture_of_a_long_run_has_the_path_of_a_short_one(count):
    """It goes back to the start some 60 times; no line of the picture cuts a corner of the part."""
    pictures = []
    for more in ({}, {"random": (count, 3)} if count else {"faults": ["break@112599"]}):
        run = wedmcam.simulate_program(KEY, backlash=(12, 15), **more)
        text = plot_run(run.record, "key")
        assert len(text) < 400_000
        path = next(line for line in text.splitlines() if '"#c1121f" stroke-width="1.5"' in line)
        first = path.split('"')[1].removeprefix("M")
        places = [p.removesuffix("h0").split() for p in first.replace("M", "L").split("L")]
        pictures.append(np.array([[float(x), float(y)] for x, y in places]))
    for one, other in (pictures, pictures[::-1]):
        assert distance(one, other) < 0.7  # sheet units, of which the line is 1.5 wide

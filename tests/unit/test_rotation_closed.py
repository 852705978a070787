"""Rotation in a closed loop: vertices as stepped against the figure in 50 digits."""

import numpy as np
import pytest

from polar_figures import figure_of, random_figure, vertices
from wedmcam.controllers.pointwise import run
from wedmcam.controllers.zd065.rotation import exact_path, rotate, rotate_closed
from wedmcam.ir.program import Kind

SIZES = (30, 3_000, 100_000, 999_999)


def misses(figure, copies, step):
    """Return how far vertices are as stepped, and as computed, from the stated ones, um."""
    stated = vertices(figure, copies, step)
    made = rotate_closed(figure, copies, step)
    moves = run(made.blocks)
    assert (moves.steps >= 0).all()
    ends = np.cumsum(moves.dx + 1j * moves.dy)
    last = np.searchsorted(made.blocks["source"], np.arange(len(stated)), side="right")
    path = exact_path(figure, copies, step)
    stands = np.append(0, ends)[last]
    return np.abs(stands - stated), np.abs(path["x"] + 1j * path["y"] - stated)


@pytest.mark.parametrize("largest", SIZES)
@pytest.mark.parametrize("step", [3.6363636, 45.1234, 359.99999, 123.45678])
def test_99_copies_stay_within_a_um(largest, step):
    random = np.random.default_rng(largest + int(step))
    stepped, computed = misses(random_figure(random, 4, largest), 99, step)
    assert stepped.max() <= 0.9
    assert computed.max() <= 0.2


@pytest.mark.parametrize("sweep", [0.001, 1.0, 5.7, 90.0])
def test_a_radius_of_10_m_stays_within_a_um(sweep):
    figure = figure_of(
        (Kind.ARC, 1, 12.345678, 10_000_000, sweep), (Kind.ARC, -1, 200.0, 10_000_000, sweep)
    )
    stepped, _ = misses(figure, 7, 45.0)
    assert stepped.max() <= 1.0
    blocks = rotate_closed(figure).blocks
    arc = blocks["kind"] == Kind.ARC
    assert (np.hypot(blocks["x"], blocks["y"])[arc] <= 10_000_000).all()
    assert blocks["count"].max() <= 999_999


def test_a_ring_of_10_m_in_100_copies_closes():
    stepped, computed = misses(figure_of((Kind.ARC, 1, 0.0, 10_000_000, 3.6)), 99, 3.6)
    assert stepped.max() <= 0.9
    assert computed.max() <= 0.1
    assert not rotate_closed(figure_of((Kind.ARC, 1, 0.0, 10_000_000, 3.6)), 99, 3.6).ends[-1].any()


@pytest.mark.parametrize("radius", [2, 100, 176_000, 3_000_000])
def test_full_circles_inside_a_figure_close(radius):
    figure = figure_of(
        (Kind.LINE, 0, 10.0, 5_000, 0.0),
        (Kind.ARC, 1, 33.0, radius, 360.0),
        (Kind.ARC, -1, 233.0, radius, 360.0),
    )
    stepped, _ = misses(figure, 11, 30.0)
    assert stepped.max() <= 1.0
    ends = rotate_closed(figure)
    behind = [ends.ends[ends.blocks["source"] == k][-1].tolist() for k in range(3)]
    assert behind[0] == behind[1] == behind[2]


def test_controls_and_moves_are_turned_with_the_figure():
    figure = figure_of(
        (Kind.THREAD, 0, 0.0, 0, 0.0),
        (Kind.LINE, 0, 0.0, 1_000, 0.0),
        (Kind.PAUSE, 0, 0.0, 0, 0.0),
        (Kind.MOVE, 0, 90.0, 500, 0.0),
    )
    made = rotate_closed(figure, 3, 90.0)
    assert made.blocks["kind"].tolist() == figure["kind"].tolist() * 4
    assert made.ends[-1].tolist() == [0, 0]
    assert not len(made.dropped)


def test_closed_loop_holds_where_the_literal_processing_drifts():
    random = np.random.default_rng(17)
    figure = random_figure(random, 4, 60_000)
    step = 3.6
    stated = vertices(figure, 99, step)
    moves = run(rotate(figure, 99, step))
    drift = np.abs(np.cumsum(moves.dx + 1j * moves.dy) - stated).max()
    stepped, _ = misses(figure, 99, step)
    assert stepped.max() <= 1.0 < 2.0 < drift

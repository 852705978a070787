"""The claims of the paper, measured small: the script that writes docs/claims.md measures them."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import measure_claims as claims


@pytest.mark.parametrize("radius", claims.RADII)
def test_in_the_papers_case_x_and_the_square_end_within_some_um_and_y_within_some_30(radius):
    on_x, on_y, square = claims.near_x_axis(radius, 1000)
    assert max(on_x, square) < 5
    assert 15 < on_y < 40


@pytest.mark.parametrize("radius", claims.RADII)
def test_a_radial_end_costs_hundreds_and_the_square_nothing(radius):
    (on_y, on_x, square), (one, three) = claims.radial_end(radius)
    assert one < on_y < 1.1 * three
    assert max(on_x, square) < 5


def test_random_arcs_end_as_the_specification_measured():
    """Square: median 0.7, 99 % within 2.0; 3B's rule: 0.6 and 2.6."""
    off = claims.random_arcs(4_000, np.pi / 2)
    square, by_end = off["inscribed square"], off["3B: the axis by the end"]
    assert np.median(square) == pytest.approx(0.7, abs=0.05)
    assert np.quantile(square, 0.99) == pytest.approx(2.0, abs=0.2)
    assert np.median(by_end) == pytest.approx(0.6, abs=0.05)
    assert np.quantile(by_end, 0.99) == pytest.approx(2.6, abs=0.2)


@pytest.mark.parametrize("gap", [100, 7_999])
def test_compensation_holds_in_the_closed_loop(gap):
    stepped, exact, vertices = claims.closed_compensation(200_000, gap, 6)
    assert (stepped <= 1.0, exact < 0.05, vertices > 12) == (True, True, True)


def test_rotation_holds_per_block():
    assert claims.machine_rotation(999_999, 20) < 1
    worst = claims.our_rotation(1_000_000, 30)
    assert worst["float64"] < 1e-8 < worst["decimal8"] < 0.1


def test_compensation_by_scaling_does_not_hold_for_large_gaps():
    assert claims.machine_compensation(200, 1_000, 200)[0] > 2
    assert claims.our_compensation(1, 2)[1]["decimal8"] < 0.01


def test_errors_add_up_in_the_open_loop_only():
    assert claims.accumulated(64, 8, False)[0] > 2
    assert claims.accumulated(64, 8, True)[1] < 2.5


@pytest.mark.parametrize("copies", [7, 8, 36])
def test_even_numbers_of_copies_cancel(copies):
    median, largest = claims.rotated_copies(copies)
    assert (largest == 0) == (copies % 2 == 0)
    assert median < 10


@pytest.mark.parametrize("signs", [*claims.circles(30), *claims.random_steps(20_000)])
@pytest.mark.parametrize(
    ("taken_up", "approach", "error"),
    [(0, 1, 15), (15, 1, 0), (10, 1, 5), (20, 1, 5), (15, -1, 15)],
)
def test_play_is_the_most_that_backlash_costs_and_it_does_not_grow(
    signs, taken_up, approach, error
):
    assert claims.with_play(signs, 15, taken_up, approach) == (error, error)


def test_going_back():
    """The opposite sense runs beside the cut, and does not always end on the start."""
    back = claims.going_back(200)
    assert (back.apart, back.exact) == (2**0.5, 200)
    assert 0.35 < back.not_cut / back.steps < 0.45
    assert 180 < back.returned < 200

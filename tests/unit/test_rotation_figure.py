"""A path as polar blocks: whole lengths, headings of 8 digits, and the figure closes."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.backends.zd065.figure import divided, eight, state
from wedmcam.controllers.zd065.data import POLAR, WAY
from wedmcam.ir.program import Kind


def way(*rows):
    """Rows (x, y) of lines and (x, y, radius, sweep, turn) of arcs, ends um from the start."""
    path = np.zeros(len(rows), WAY)
    for k, row in enumerate(rows):
        x, y, radius, sweep, turn = (*row, 0, 0, 0)[:5] if len(row) == 2 else row
        path[k] = (Kind.ARC if turn else Kind.LINE, turn, x, y, radius, sweep, 0.0)
    return path


def exact_end(figure):
    """The sum of all displacements as the bytes state them, 40 digits."""
    with mpmath.workdps(40):
        at = mpmath.mpc(0)
        for kind, turn, start, size, sweep in figure.tolist():
            # The float nearest to a decimal of 8 digits is that decimal.
            a, s = (mpmath.radians(mpmath.mpf(f"{v:.8g}")) for v in (start, sweep))
            if kind == Kind.ARC:
                at += size * (mpmath.expj(a + turn * s) - mpmath.expj(a))
            else:
                at += size * mpmath.expj(a)
        return complex(at)


def test_a_path_of_whole_lengths_stays_as_it_is():
    made = state(way((3000, 4000), (3000, 0), (0, 0)))
    assert made.figure["size"].tolist() == [5000, 4000, 3000]
    assert made.figure["start"].tolist() == [eight(np.array([math.degrees(math.atan2(4, 3))]))[0],
                                             270.0, 180.0]  # fmt: skip
    assert made.closes
    assert made.drift_um < 1e-3


def test_lengths_that_are_not_whole_move_vertices_together():
    """A triangle with sides of 10 sqrt 2: the whole lengths are met, and it closes."""
    made = state(way((7071.07, 7071.07), (-2588.19, 9659.26), (0, 0)))
    assert made.closes
    assert made.drift_um < 1e-3
    assert made.off_um < 0.5


def test_one_line_of_no_whole_length_cannot_close():
    made = state(way((1000.4, 0)))
    assert not made.closes
    assert made.drift_um == pytest.approx(0.4)


@pytest.mark.parametrize(("radius", "arcs", "off_um"), [(2100.2, 1, 0.5), (2100.4, 2, 0.5)])
def test_half_a_turn_of_no_whole_radius(radius, arcs, off_um):
    """R rules the chord of half a turn: two blocks where it is far from whole."""
    top = 2 * radius
    slot = way((8000, 0), (8000, top, radius, 180.0, 1), (0, top), (0, 0, radius, 180.0, 1))
    made = state(slot)
    assert (made.figure["size"] == 2100).sum() == 2 * arcs
    assert made.closes
    assert made.drift_um < 1e-3
    assert made.off_um < off_um


def test_wide_arcs_are_two_blocks_and_a_circle_is_one():
    wide = way((0, -1000, 500.0, 270.0, 1))
    rows, of = divided(wide)
    assert of.tolist() == [0, 0]
    assert rows["sweep"].tolist() == [135.0, 135.0]
    ring = way((0, 0, 500.0, 360.0, -1))
    ring["start"] = 30.0
    made = state(ring)
    assert made.figure.tolist() == [(Kind.ARC, -1, 30.0, 500, 360.0)]
    assert made.drift_um == pytest.approx(0.0, abs=1e-9)


def test_specks_are_left_out():
    made = state(way((1000, 0), (1000.2, 0.1), (1000, 1000), (0, 0)))
    assert made.of.tolist() == [0, 2, 3]
    assert made.closes


def test_long_lines_are_several():
    made = state(way((2_500_000.0, 0.0), (2_500_000.0, 3.0), (0.0, 0.0)))
    assert made.figure["size"].max() <= 999_999
    assert len(made.figure) == 7


def test_a_path_of_many_short_lines_closes():
    """A polyline round a circle: its lines are nearly parallel, and the lengths must add up."""
    a = np.linspace(0, 2 * np.pi, 241)[1:]
    made = state(way(*np.column_stack([7000 * np.sin(a), 7000 - 7000 * np.cos(a)]).tolist()))
    assert made.closes
    assert made.drift_um < 1e-3
    assert made.off_um < 0.75


corner = st.tuples(st.floats(2000, 80_000), st.floats(-80, 80), st.booleans(), st.floats(5, 120))


@settings(max_examples=60, deadline=None)
@given(st.integers(2, 100), st.lists(corner, min_size=1, max_size=8), st.floats(0, 6.28))
def test_figures_close_within_their_share(order, corners, turned):
    """Law: N figures come back to their start within 0.3 um, by 40 digits, wherever it is told."""
    rows, at = [], 0j
    heading = turned
    for length, turn, arc, sweep in corners:
        heading += math.radians(turn)
        step = length * np.exp(1j * heading)
        at += step
        radius = length / 2 / math.sin(math.radians(sweep) / 2)
        rows.append((at.real, at.imag, radius, sweep, 1) if arc else (at.real, at.imag))
    made = state(way(*rows))
    end = exact_end(made.figure)
    assert abs(end - at) == pytest.approx(made.drift_um, abs=1e-4)
    if made.closes and len(made.figure) >= 2:
        step = float(eight(np.array([360.0 / order]))[0])
        with mpmath.workdps(40):
            turns = sum(mpmath.expjpi(mpmath.mpf(f"{step:.8g}") * k / 180) for k in range(order))
        assert abs((end - at) * complex(turns)) <= 0.3
    assert made.off_um <= 1.2 or not made.closes


def test_angles_have_8_digits():
    rng = np.random.default_rng(8)
    points = np.cumsum(rng.normal(0, 9000, (40, 2)), axis=0)
    figure = state(way(*points.tolist(), (0, 0))).figure
    assert figure.dtype == POLAR
    assert (figure["start"] == eight(figure["start"])).all()
    assert ((figure["start"] >= 0) & (figure["start"] < 360)).all()

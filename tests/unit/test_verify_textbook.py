"""Arc ends recomputed from J and G: published blocks, and the sum of the projections inverted."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, ceil, floor, hypot, pi, tau

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wedmcam.ir.program import BLOCK, Axis, Kind
from wedmcam.judge.textbook import recomputed_ends


def ends(*rows):
    b = np.zeros(len(rows), BLOCK)
    for k, (x, y, turn, axis, count) in enumerate(rows):
        b[k] = (Kind.ARC, turn, axis, 0, x, y, count, -1, 0)
    return recomputed_ends(b)


def nominal(start, end, turn, axis):
    """J by the textbook: the sum of the projections of the monotone pieces."""
    if turn < 0:
        start, end = (start[0], -start[1]), (end[0], -end[1])
    r = hypot(*start)
    a0, a1 = atan2(start[1], start[0]), atan2(end[1], end[0])
    if a1 <= a0:
        a1 += tau
    i, first = (0, 0.0) if axis == Axis.X else (1, pi / 2)
    at = [start[i]]
    for k in range(ceil((a0 - first) / pi), floor((a1 - first) / pi) + 1):
        at.append(r if k % 2 == 0 else -r)
    at.append(end[i])
    return floor(sum(abs(q - p) for p, q in pairwise(at)) + 0.5)


@pytest.mark.parametrize(
    ("x", "y", "turn", "axis", "count", "end"),
    [
        (9900, 0, 1, Axis.Y, 39600, (9900, 0)),
        (0, 40100, 1, Axis.X, 80100, (-100, -40100)),
        (-2000, 9000, 1, Axis.Y, 25440, (9000, -2000)),
        (9000, -2000, -1, Axis.X, 25440, (-2000, 9000)),
        (4, 0, 1, Axis.X, 4, (0, 4)),
        (0, 6, -1, Axis.Y, 6, (6, 0)),
    ],
)
def test_known_blocks(x, y, turn, axis, count, end):
    r = ends((x, y, turn, axis, count))
    assert abs(x + r.dx[0] - end[0]) <= 1
    assert abs(y + r.dy[0] - end[1]) <= 1


def test_full_circle_of_every_start_axis_and_sense():
    for x, y in ((500, 0), (0, 500), (-500, 0), (0, -500), (300, 400), (-400, 300), (300, -400)):
        for turn in (1, -1):
            for axis in (Axis.X, Axis.Y):
                r = ends((x, y, turn, axis, 2000))
                assert (r.dx[0], r.dy[0]) == (0, 0)
                assert r.sweep[0] == pytest.approx(tau)


@given(
    st.integers(200, 50000),
    st.floats(-3.1, 3.1),
    st.floats(0.05, 6.2),
    st.sampled_from([1, -1]),
)
def test_inverts_the_sum_of_projections(radius, a0, sweep, turn):
    start = (round(radius * np.cos(a0)), round(radius * np.sin(a0)))
    r = hypot(*start)
    a1 = atan2(start[1], start[0]) + turn * sweep
    end = (r * np.cos(a1), r * np.sin(a1))
    axis = Axis.Y if abs(end[0]) >= abs(end[1]) else Axis.X
    got = ends((*start, turn, axis, nominal(start, end, turn, axis)))
    dx, dy = got.dx[0] + start[0] - end[0], got.dy[0] + start[1] - end[1]
    # R is rounded to um: half a micron at each turning point passed, two a pass, and the end's.
    assert hypot(dx, dy) <= 6
    assert got.sweep[0] == pytest.approx(sweep, abs=12 / radius)


def test_arcs_counted_on_the_square_and_other_blocks_have_no_such_end():
    b = np.zeros(3, BLOCK)
    b[0] = (Kind.ARC, 1, Axis.SQUARE, 0, 500, 0, 100, -1, 0)
    b[1] = (Kind.LINE, 0, Axis.X, 0, 500, 0, 500, -1, 0)
    b[2] = (Kind.PAUSE, 0, 0, 0, 0, 0, 0, -1, 0)
    r = recomputed_ends(b)
    assert r.dx.tolist() == [0, 0, 0]
    assert np.isnan(r.sweep[0])
    assert r.sweep[1:].tolist() == [0, 0]

"""What a path repeats about a centre: found however it is drawn, and not where it is not there."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.program import Kind
from wedmcam.transforms.repeat import find_repeat


def slotted(order, centre=(3000.0, -2000.0), shift=0, rounding=None, clockwise=False):
    """A wheel of ``order`` teeth: an arc on the rim, a flank, an arc in the root, a flank."""
    c = complex(*centre)
    rows = []
    for k in range(order):
        a = 2 * np.pi * k / order
        p = [
            radius * np.exp(1j * (a + share * 2 * np.pi / order))
            for radius, share in ((9000.0, 0.0), (9000.0, 0.4), (7000.0, 0.55), (7000.0, 0.85))
        ]
        for place, turn in zip(p, (1, 0, 1, 0), strict=True):
            place += c
            if rounding:
                x, y = (round(v / rounding) * rounding for v in (place.real, place.imag))
                place = complex(x, y)
            rows.append((place.real, place.imag, c.real, c.imag, turn, -1))
    v = np.array(rows, dtype=VERTEX)
    contour = Contour(np.roll(v, shift), True)
    return contour.reversed() if clockwise else contour


@pytest.mark.parametrize("order", [2, 3, 7, 36, 100, 101, 120])
@pytest.mark.parametrize("clockwise", [False, True])
def test_a_wheel_is_found(order, clockwise):
    found = find_repeat(slotted(order, shift=3, clockwise=clockwise))
    assert (found.order, found.per) == (order, 4)
    sense = -1 if clockwise and order > 2 else 1
    assert abs(found.turn) == pytest.approx(360 / order)
    assert order == 2 or np.sign(found.turn) == sense
    assert found.centre == pytest.approx((3000, -2000), abs=1e-6)
    assert found.off_um < 1e-6


def test_copies_are_up_to_99():
    assert find_repeat(slotted(120)).orders(100)[0] == 60
    assert find_repeat(slotted(101)).orders(100) == []
    assert find_repeat(slotted(100)).orders(100)[0] == 100


def test_joints_within_a_line_or_a_circle_are_none():
    """One tooth drawn with a flank and an arc in two pieces is a tooth like the others."""
    v = slotted(9).vertices
    flank = v[1:2].copy()  # middle of the first flank
    flank["x"], flank["y"] = (v["x"][1] + v["x"][2]) / 2, (v["y"][1] + v["y"][2]) / 2
    rim = v[0:1].copy()  # a point of the first arc
    a = 0.1 * 2 * np.pi / 9
    rim["x"], rim["y"] = 3000 + 9000 * np.cos(a), -2000 + 9000 * np.sin(a)
    rows = np.concatenate([v[:1], rim, v[1:2], flank, v[2:]])
    for shift in (0, -1, -3):  # the path starts at a joint, and within a segment
        found = find_repeat(Contour(np.roll(rows, shift), True))
        assert (found.order, found.per) == (9, 4)
        start = complex(*np.roll(rows, shift)[["x", "y"]][0].tolist())
        figure = found.figure(9, start, found.turn)
        assert len(figure) == 4 + (shift != 0)


def test_the_figure_ends_where_the_next_begins():
    contour = slotted(12, shift=2)
    found = find_repeat(contour)
    start = complex(contour.vertices["x"][0], contour.vertices["y"][0])
    for order in found.orders(100):
        turn = 360.0 / order
        figure = found.figure(order, start, turn)
        assert len(figure) == 4 * 12 // order
        c = complex(*found.centre)
        end = c + (start - c) * np.exp(1j * np.radians(turn))
        assert abs(start + complex(figure["x"][-1], figure["y"][-1]) - end) < 1e-6
        assert set(figure["kind"].tolist()) == {Kind.ARC, Kind.LINE}


def test_a_drawing_of_whole_um_is_averaged():
    """A coordinate is off by up to 0.15 um, the mean of 36 copies by less."""
    found = find_repeat(slotted(36, rounding=0.3))
    assert (found.order, found.repeats) == (36, True)
    assert 0.1 < found.off_um < 0.3
    exact = find_repeat(slotted(36)).vertices
    assert abs(found.vertices - exact).max() < 0.1
    assert find_repeat(slotted(35, rounding=1.0)).order == 35  # said, and not taken
    assert not find_repeat(slotted(35, rounding=1.0)).repeats


def test_what_repeats_nothing():
    circle = np.array([(0, 0, 500, 0, 1, -1)], dtype=VERTEX)
    assert find_repeat(Contour(circle, True)) is None
    v = slotted(6).vertices.copy()
    v["x"][5] += 100
    assert find_repeat(Contour(v, True)) is None
    line = np.array([(0, 0, 0, 0, 0, -1), (9, 0, 0, 0, 0, -1), (18, 0, 0, 0, 0, -1)], dtype=VERTEX)
    assert find_repeat(Contour(line, False)) is None  # a translation


def test_nearly_the_same_is_said_and_not_taken():
    v = slotted(6).vertices.copy()
    v["x"][5] += 2.0
    found = find_repeat(Contour(v, True))
    assert found.order == 6
    assert not found.repeats


@pytest.mark.parametrize(("copies", "turn"), [(4, 40.0), (2, -75.0), (1, 12.5), (98, 3.0)])
def test_an_open_chain_of_copies(copies, turn):
    """Two lines and an arc, each copy turned by as much as the one before."""
    rows, at, heading = [], 0j, 0.3
    for k in range(copies + 1):
        z = np.exp(1j * (heading + np.radians(turn) * k))
        for way, turns in ((3000, 0), (2000j, 0), (1500 + 1500j, 1)):
            centre = at + (way / 2 + 0.7j * way) * z
            rows.append((at.real, at.imag, centre.real, centre.imag, turns, -1))
            at += way * z
    rows.append((at.real, at.imag, 0, 0, 0, -1))
    found = find_repeat(Contour(np.array(rows, dtype=VERTEX), False))
    assert (found.order, found.per, found.closed) == (copies + 1, 3, False)
    assert found.turn == pytest.approx(turn)
    figure = found.figure(copies + 1, 0j, turn)
    ends = np.cumsum([3000, 2000j, 1500 + 1500j]) * np.exp(0.3j)
    assert np.allclose(figure["x"] + 1j * figure["y"], ends, atol=1e-5)


@settings(max_examples=50, deadline=None)
@given(st.integers(2, 60), st.floats(0, 6.3), st.floats(-1e6, 1e6), st.integers(0, 239))
def test_it_is_found_wherever_it_lies(order, turned, away, shift):
    """Law: turned, moved and begun elsewhere, a wheel repeats as often."""
    v = slotted(order, shift=shift % (4 * order)).vertices.copy()
    z = np.exp(1j * turned)
    for x, y in (("x", "y"), ("cx", "cy")):
        place = (v[x] + 1j * v[y]) * z + away
        v[x], v[y] = place.real, place.imag
    found = find_repeat(Contour(v, True))
    assert (found.order, found.per) == (order, 4)
    assert found.off_um < 1e-3

"""The judges themselves: known areas and distances, and complaints about planted errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import oracle
import parts
from wedmcam.ir.contour import VERTEX, Contour

PI = np.pi


def grown_rectangle(width: float, height: float, d: float) -> Contour:
    """Rectangle offset outwards by d with arcs of radius d: by hand, 8 segments."""
    p = np.array([(0, -d), (width, -d), (width + d, 0), (width + d, height)], float)
    p = np.vstack([p, [(width, height + d), (0, height + d), (-d, height), (-d, 0)]])
    return parts.contour_of_bulges(p, np.tile([0, np.tan(PI / 8)], 4))


# Values of elementary geometry: 20 x 10, d = 2 in units of mm, here um.
def test_area_and_length_of_known_figures() -> None:
    grown = grown_rectangle(20e3, 10e3, 2e3)
    assert oracle.signed_area(grown) == pytest.approx(332.5663706e6, rel=1e-9)
    assert oracle.lengths(grown).sum() == pytest.approx(72.5663706e3, rel=1e-9)
    assert oracle.signed_area(parts.circle(7, 9, 5)) == pytest.approx(25 * PI)
    assert oracle.signed_area(parts.circle(7, 9, 5).reversed()) == pytest.approx(-25 * PI)
    obround = parts.slot(1e4, -2e4, 3e3, 1e3, 0.7)
    assert oracle.signed_area(obround) == pytest.approx(3e6 + PI * 250e3)
    assert oracle.lengths(obround).sum() == pytest.approx(6e3 + PI * 1e3)


def test_area_of_a_flat_arc_is_kept() -> None:
    # Sagitta s on chord c: the segment's area is 2/3 c s for a flat arc.
    bulge = 2 * 0.01 / 1000.0
    cap = parts.contour_of_bulges(np.array([(0.0, 0), (1000, 0)]), np.array([bulge, 0]))
    assert oracle.signed_area(cap) == pytest.approx(2 / 3 * 1000 * 0.01, rel=1e-6)


@pytest.mark.parametrize(
    ("point", "distance"),
    [((5, 2), 2), ((-3, 4), 0), ((13, -4), 5), ((5, 5), 5), ((10, 14), 4), ((5, 0), 0)],
)
def test_distance_to_a_rectangle(point: tuple[float, float], distance: float) -> None:
    shape = parts.contour_of_bulges(np.array([(0.0, 0), (10, 0), (10, 10), (0, 10)]), np.zeros(4))
    if point == (-3, 4):
        distance = 3
    assert oracle.distance_to_contour(np.array([point]), shape) == pytest.approx([distance])


def test_distance_to_arcs() -> None:
    half = parts.contour_of_bulges(np.array([(10.0, 0), (-10, 0)]), np.array([1.0, 0]), False)
    points = np.array([(0, 12), (0, 3), (3, 4), (10, -5), (0, -5), (-13, -4)])
    known = [2, 7, 5, 5, np.hypot(10, 5), 5]
    assert oracle.distance_to_contour(points, half) == pytest.approx(known)
    assert oracle.distance_to_contour(points, half.reversed()) == pytest.approx(known)
    ring = parts.circle(0, 0, 10)
    assert oracle.distance_to_contour(points, ring) == pytest.approx(
        np.abs(np.hypot(*points.T) - 10)
    )


def test_chords_keep_their_sagitta_and_vertices() -> None:
    shape = grown_rectangle(20e3, 10e3, 2e3)
    ring = oracle.chords(shape, 0.5)
    middles = (ring + np.roll(ring, -1, axis=0)) / 2
    sagitta = oracle.distance_to_contour(middles, shape)
    assert 0.3 < sagitta.max() <= 0.5
    assert oracle.distance_to_contour(ring, shape).max() < 1e-9
    vertices = set(zip(shape.vertices["x"], shape.vertices["y"], strict=True))
    assert vertices <= set(map(tuple, ring))


def test_samples_touch_every_segment() -> None:
    points = np.array([(0.0, 0), (1e4, 0), (1e4, 1e-3), (0, 5e3)])
    shape = parts.contour_of_bulges(points, np.array([0, 0.0, 0.1, 0]))
    samples = oracle.sample_contour(shape, 100)
    assert oracle.distance_to_contour(samples, shape).max() < 1e-9
    inside = (samples[:, 0] == 1e4) & (samples[:, 1] > 0) & (samples[:, 1] < 1e-3)
    assert inside.any()


def test_clipper_on_a_rectangle_and_a_circle() -> None:
    area, loops = oracle.clipper_offset_area(parts.rectangle(20e3, 10e3), 2e3)
    assert area == pytest.approx(332.5663706e6, abs=0.01 * 72.6e3)
    assert len(loops) == 1
    assert oracle.clipper_offset_area(parts.rectangle(20e3, 10e3), -2e3)[0] == pytest.approx(96e6)
    assert oracle.clipper_offset_area(parts.rectangle(120e3, 40e3), -30e3) == (0, [])
    area, _ = oracle.clipper_offset_area(parts.circle(3e5, -2e5, 5e3), -3e3)
    assert area == pytest.approx(PI * 4e6, abs=0.01 * (2 * PI * 7e3))


@pytest.mark.parametrize("make", [parts.gear, parts.biarc], ids=["gear", "biarc"])
@pytest.mark.parametrize("d", [130.0, -130.0])
def test_clipper_on_tangent_continuous_contours(make, d: float) -> None:  # type: ignore[no-untyped-def]
    contour = make(96)
    length = oracle.lengths(contour).sum()
    exact = oracle.signed_area(contour) + length * d + PI * d * d
    area, loops = oracle.clipper_offset_area(contour, d)
    assert len(loops) == 1
    assert abs(area - exact) < 0.01 * 2 * length


def test_a_pinched_stator_falls_apart() -> None:
    _, loops = oracle.clipper_offset_area(parts.pinch(96), -130)
    assert len(loops) == 13


# --- check_offset ------------------------------------------------------------------------------

SHAPE = parts.rectangle(20e3, 10e3)
GOOD = grown_rectangle(20e3, 10e3, 2e3)


def shifted(contour: Contour, row: int, dx: float) -> Contour:
    v = contour.vertices.copy()
    v["x"][row] += dx
    return replace(contour, vertices=v)


@pytest.mark.parametrize("flip", [False, True], ids=["ccw", "cw"])
def test_a_right_offset_passes(flip: bool) -> None:
    inside = parts.rectangle(16e3, 6e3, 2e3, 2e3)
    for d, result in ((2e3, [GOOD]), (-2e3, [inside]), (-6e3, [])):
        if flip:
            made = [loop.reversed() for loop in result]
            assert oracle.check_offset(SHAPE.reversed(), d, made) == []
        else:
            assert oracle.check_offset(SHAPE, d, result) == []


def test_a_hole_of_an_offset_passes_and_must_run_backwards() -> None:
    # A C whose mouth, 1 mm, is closed by an offset of 0.6 mm: an outer loop and a hole.
    w, m = 10e3, 500.0
    p = [(0, 0), (w, 0), (w, 5e3 - m), (9e3, 5e3 - m), (9e3, 1e3), (1e3, 1e3), (1e3, 9e3)]
    p += [(9e3, 9e3), (9e3, 5e3 + m), (w, 5e3 + m), (w, w), (0, w)]
    c_shape = parts.contour_of_bulges(np.array(p), np.zeros(12))
    d = 600.0
    g = np.sqrt(d * d - m * m)  # the transition arcs of the mouth meet at (10, 5) mm + (g, 0)
    t = float(np.tan(PI / 8))
    u = float(np.tan(np.arctan2(m, g) / 4))
    outer = [(0, -d, 0), (w, -d, t), (w + d, 0, 0), (w + d, 5e3 - m, u), (w + g, 5e3, u)]
    outer += [(w + d, 5e3 + m, 0), (w + d, w, t), (w, w + d, 0), (0, w + d, t), (-d, w, 0)]
    outer += [(-d, 0, t)]
    inner = [(1e3 + d, 1e3 + d), (1e3 + d, 9e3 - d), (9e3 - d, 9e3 - d), (9e3 - d, 5e3 + m)]
    inner += [(9e3 - g, 5e3), (9e3 - d, 5e3 - m), (9e3 - d, 1e3 + d)]
    rows = np.array(outer)
    rim = parts.contour_of_bulges(rows[:, :2], rows[:, 2])
    hole = parts.contour_of_bulges(np.array(inner), np.array([0, 0, 0, u, u, 0, 0]))
    assert oracle.check_offset(c_shape, d, [rim, hole]) == []
    assert any("inner loops" in c for c in oracle.check_offset(c_shape, d, [rim, hole.reversed()]))
    assert any("inner loops" in c for c in oracle.check_offset(c_shape, d, [rim]))


@pytest.mark.parametrize(
    ("signed_offset", "result", "says"),
    [
        pytest.param(2e3, [], "outer loops", id="lost"),
        pytest.param(2e3, [], "area", id="lost-area"),
        pytest.param(2e3, [GOOD, GOOD], "outer loops", id="doubled"),
        pytest.param(2e3, [GOOD.reversed()], "area", id="backwards"),
        pytest.param(-2e3, [GOOD], "area", id="wrong-side"),
        pytest.param(2.0001e3, [GOOD], "off the offset", id="a-tenth-of-a-um"),
        pytest.param(2e3, [shifted(GOOD, 3, 0.02)], "off the offset", id="vertex-moved"),
        pytest.param(2e3, [shifted(GOOD, 2, 0.02)], "misses its end", id="arc-misses-its-end"),
        pytest.param(2e3, [parts.rectangle(24e3, 14e3, -2e3, -2e3)], "off the offset", id="miter"),
        pytest.param(
            2e3, [Contour(np.append(GOOD.vertices, GOOD.vertices[:1]), False)], "open", id="open"
        ),
    ],
)
def test_planted_errors_are_found(signed_offset: float, result: list[Contour], says: str) -> None:
    complaints = oracle.check_offset(SHAPE, signed_offset, result)
    assert any(says in c for c in complaints), complaints


def test_a_slot_as_wide_as_the_wire_may_split_or_not() -> None:
    # Two rooms 10 x 10 mm and a bridge 1 mm wide between them, offset inwards by 0.5 mm.
    p = [(0, 0), (10, 0), (10, 4), (14, 4), (14, 0), (24, 0), (24, 10), (14, 10), (14, 5), (10, 5)]
    p += [(10, 10), (0, 10)]
    dumbbell = parts.contour_of_bulges(np.array(p) * 1e3, np.zeros(12))
    u = float(np.tan(PI / 8))
    left = [(0.5, 0.5, 0), (9.5, 0.5, 0), (9.5, 4, -u), (10, 4.5, -u), (9.5, 5, 0), (9.5, 9.5, 0)]
    rows = np.array([*left, (0.5, 9.5, 0)]) * (1e3, 1e3, 1)
    room = parts.contour_of_bulges(rows[:, :2], rows[:, 2])
    v = room.vertices.copy()
    v["x"], v["cx"], v["turn"] = 24e3 - v["x"], 24e3 - v["cx"], -v["turn"]
    other = Contour(v, True).reversed()
    assert oracle.check_offset(dumbbell, -500, [room, other]) == []
    # One loop that crosses the bridge there and back on a line of no width is as right.
    far = np.column_stack([other.vertices["x"], other.vertices["y"]])
    bulge = np.where(other.vertices["turn"] != 0, -u, 0.0)
    k = int(np.flatnonzero((far == (14e3, 4.5e3)).all(axis=1))[0])
    turned = np.roll(np.column_stack([far, bulge]), -k, axis=0)
    bridge = np.array([(10e3, 4.5e3, 0.0)])
    whole = np.vstack([rows[:3], bridge, turned, [(14e3, 4.5e3, 0.0)], rows[3:]])
    joined = parts.contour_of_bulges(whole[:, :2], whole[:, 2])
    assert oracle.check_offset(dumbbell, -500, [joined]) == []
    assert any("area" in c for c in oracle.check_offset(dumbbell, -500, [room]))
    # A real bridge, 2 um wider, must not be split.
    assert any("outer loops" in c for c in oracle.check_offset(dumbbell, -499, [room, other]))


def test_a_full_circle_row_is_judged() -> None:
    contour = parts.circle(1e4, 0, 1e3)
    assert oracle.check_offset(contour, -900, [parts.circle(1e4, 0, 100)]) == []
    assert oracle.check_offset(contour, -1100, []) == []
    assert oracle.check_offset(contour, -900, [parts.circle(1e4, 0.1, 100)])
    assert contour.vertices.dtype == VERTEX

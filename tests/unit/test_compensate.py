"""Compensation of figures whose offset elementary geometry gives."""

import numpy as np
import pytest

from oracle import distance_to_contour, lengths, sample_contour, signed_area
from parts import circle, contour_of_bulges, gear, pinch, rectangle, rounded, slot, stator
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.largest import Largest, largest_offset

PI = np.pi


def polygon(*points):
    return contour_of_bulges(np.array(points, float), np.zeros(len(points)))


def opened(*points):
    return contour_of_bulges(np.array(points, float), np.zeros(len(points)), closed=False)


def paths_of(contours, shifts, **options):
    result, problems = compensate(contours, shifts, **options)
    assert not problems
    return [p.path for p in result.paths]


def area(paths):
    return sum(map(signed_area, paths))


def length(paths):
    return float(sum(lengths(p).sum() for p in paths))


def images(contour, shift):
    """The contour from every start vertex, both ways round, with the shift that goes with it."""
    for k in range(len(contour.vertices)):
        turned = Contour(np.roll(contour.vertices, -k), True, contour.sources)
        yield turned, shift, 1
        yield turned.reversed(), -shift, -1


RECT, DIAMOND = rectangle(20e3, 10e3), polygon((10e3, 0), (0, -10e3), (-10e3, 0), (0, 10e3))
#: Two rooms of 4 x 4 mm joined by a bar of 2 x 0.2 mm.
DUMBBELL = polygon(
    *[(0, 0), (4e3, 0), (4e3, 1e3), (6e3, 1e3), (6e3, 0), (10e3, 0), (10e3, 4e3), (6e3, 4e3)],
    *[(6e3, 1.2e3), (4e3, 1.2e3), (4e3, 4e3), (0, 4e3)],
)


@pytest.mark.parametrize(
    ("contour", "shift", "loops", "vertices", "enclosed", "long"),
    [
        # 20 x 10 mm by 2 mm: 16 x 6, and 200 + 120 + 4 pi mm^2 of 4 lines and 4 arcs.
        (RECT, 2e3, 1, 4, 96e6, 44e3),
        (RECT, -2e3, 1, 8, 320e6 + 4e6 * PI, 60e3 + 4e3 * PI),
        (RECT, 5e3, 0, 0, 0, 0),
        (RECT, 6e3, 0, 0, 0, 0),
        (rectangle(120e3, 40e3), 30e3, 0, 0, 0, 0),
        (rectangle(10e3, 10e3), 5e3, 0, 0, 0, 0),
        # Half diagonal 10 mm, by 5 mm: 10 - 5 sqrt 2, clockwise.
        (DIAMOND, -5e3, 1, 4, -2 * (10e3 - 5e3 * 2**0.5) ** 2, 4 * (10e3 * 2**0.5 - 10e3)),
        (DIAMOND, 5e3, 1, 8, -(200e6 + 200e6 * 2**0.5 + 25e6 * PI), 40e3 * 2**0.5 + 10e3 * PI),
        (circle(0, 0, 5e3), 3e3, 1, 1, 4e6 * PI, 4e3 * PI),
        (circle(0, 0, 5e3), -3e3, 1, 1, 64e6 * PI, 16e3 * PI),
        (circle(0, 0, 1e3), 1e3, 0, 0, 0, 0),
        (circle(0, 0, 1e3), 2e3, 0, 0, 0, 0),
        # C-02: circle R 10 mm by 0.1 mm.
        (circle(0, 0, 10e3), -100.0, 1, 1, PI * 10.1e3**2, 2 * PI * 10.1e3),
        (circle(0, 0, 10e3), 100.0, 1, 1, PI * 9.9e3**2, 2 * PI * 9.9e3),
        (slot(0, 0, 2e3, 2e3), -1e3, 1, 4, 8e6 + 4e6 * PI, 4e3 + 4e3 * PI),
        # The bar is far too narrow: two squares of 0.8 mm are left of the rooms.
        (DUMBBELL, 1600.0, 2, 8, 2 * 0.8e3**2, 2 * 3.2e3),
        (polygon((0, 0), (6e3, 0), (0, 8e3)), 2e3, 0, 0, 0, 0),
        # Right triangle 6-8-10 has an inradius of 2: by 1 mm it is halved.
        (polygon((0, 0), (6e3, 0), (0, 8e3)), 1e3, 1, 3, 6e6, 12e3),
    ],
)
def test_offset_of_simple_figures(contour, shift, loops, vertices, enclosed, long):
    for image, by, sense in images(contour, shift):
        made = paths_of([image], [by])
        assert len(made) == loops
        assert sum(len(p) for p in made) == vertices
        assert area(made) == pytest.approx(sense * enclosed, rel=1e-12, abs=0.05)
        assert length(made) == pytest.approx(long, rel=1e-12)


def test_circle_keeps_centre_and_sense():
    for contour in (circle(3e3, 4e3, 10e3), circle(3e3, 4e3, 10e3).reversed()):
        (path,) = paths_of([contour], [-100.0])
        row, drawn = path.vertices[0], contour.vertices[0]
        assert (row["cx"], row["cy"], row["turn"]) == (3e3, 4e3, drawn["turn"])


def semicircles(distance):
    """Two half circles of r = 75 mm with their middles ``distance`` apart, joined by lines."""
    r, a = 75e3, distance / 2
    points = np.array([(-a, -r), (a, -r), (a, r), (-a, r)])
    return contour_of_bulges(points, np.array([0.0, 1.0, 0.0, 1.0]))


@pytest.mark.parametrize("shift", [71e3, 73e3, 74.9e3])
def test_semicircles_shrink_with_their_centres(shift):
    (path,) = paths_of([semicircles(50e3)], [shift])
    r = 75e3 - shift
    assert signed_area(path) == pytest.approx(50e3 * 2 * r + PI * r * r, rel=1e-12)
    assert path.vertices["cx"][path.vertices["turn"] != 0].tolist() == [25e3, -25e3]
    result, _ = compensate([semicircles(50e3)], [77e3])
    assert [i.kind for i in result.interference] == ["vanished"]


@pytest.mark.parametrize("excess", [0.0, 1e-9, -1e-9, 1e-6, -1e-6, 1e-4, -1e-4, -0.4])
def test_fillet_as_wide_as_the_wire_is_an_exact_corner(excess):
    """C-03: radius = offset leaves a corner and nothing else, whatever the last digits."""
    square = np.array([(0, 0), (10e3, 0), (10e3, 10e3), (0, 10e3)], float)
    contour = contour_of_bulges(*rounded(square, 100.0 + excess))
    result, problems = compensate([contour], [100.0])
    assert not problems
    assert not result.interference
    (path,) = (p.path for p in result.paths)
    assert len(path) == 4
    assert (path.vertices["turn"] == 0).all()
    assert signed_area(path) == pytest.approx(9.8e3**2, abs=60.0)
    (path,) = paths_of([contour_of_bulges(*rounded(square, 102.0))], [100.0])
    assert np.sum(path.vertices["turn"]) == 4


@pytest.mark.parametrize("angle", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("bend", [-1, 1])
@pytest.mark.parametrize("shift", [-100.0, 100.0])
def test_nearly_tangent_joints_have_no_spike_and_no_micro_arc(angle, bend, shift):
    """C-05: line to arc, the tangents off by ``angle`` to either side."""
    r = 2e3
    turned = bend * angle
    c, s = np.cos(turned), np.sin(turned)
    ends = np.array([(0, 0), (5e3, 0), (5e3 + r * c, r * (1 + s)), (5e3, 5e3), (0, 5e3)])
    contour = contour_of_bulges(ends, np.array([0, np.tan(PI / 8 - turned / 2), 0, 0, 0]))
    (path,) = paths_of([contour], [shift])
    assert lengths(path).min() > 20.0
    error = np.abs(distance_to_contour(sample_contour(path, 400), contour) - 100.0)
    assert error.max() < 0.01


@pytest.mark.parametrize("slip", [0.0, 1e-9, -1e-9, 1e-4, -1e-4])
def test_tangent_arcs_meet_whatever_the_last_digits(slip):
    """C-06: two arcs tangent inside and outside, their joint slipped along the arc."""
    a = np.array([(0, 0), (4e3, 0), (6e3, 2e3 + slip), (8e3, 4e3), (8e3, 9e3), (0, 9e3)])
    b = np.array([0, np.tan(PI / 8), -np.tan(PI / 8), 0, 0, 0])
    contour = contour_of_bulges(a, b)
    for shift in (130.0, -130.0):
        made = paths_of([contour], [shift])
        assert len(made) == 1
        error = np.abs(distance_to_contour(sample_contour(made[0], 400), contour) - 130.0)
        assert error.max() < 0.01


def test_out_and_in_again_gives_the_outline():
    """C-08: no corner is lost when the offset is taken back."""
    for contour in (RECT, DIAMOND, gear(48), slot(0, 0, 3e3, 1e3)):
        sense = np.sign(signed_area(contour))
        (out,) = paths_of([contour], [-sense * 150.0])
        (back,) = paths_of([out], [sense * 150.0])
        assert signed_area(back) == pytest.approx(signed_area(contour), rel=1e-9)
        assert distance_to_contour(sample_contour(contour, 300), back).max() < 0.01


def test_result_can_be_offset_again():
    made = [stator(48)]
    for _ in range(5):
        made = paths_of(made, [-50.0] * len(made))
        assert len(made) == 1
    whole = paths_of([stator(48)], [-250.0])
    assert area(made) == pytest.approx(area(whole), rel=1e-9)


def test_open_contours_have_squared_ends():
    """C-10 and C-11: one open path, never nothing; left and right are mirror images."""
    line = opened((0, 0), (10e3, 0))
    (path,) = paths_of([line], [100.0])
    assert not path.closed
    assert [tuple(v)[:2] for v in path.vertices] == [(0, 100.0), (10e3, 100.0)]
    bent = opened((0, 0), (10e3, 0), (10e3, 5e3))
    (left,), (right,) = paths_of([bent], [100.0]), paths_of([bent], [-100.0])
    assert [tuple(v)[:2] for v in left.vertices] == [(0, 100), (9.9e3, 100), (9.9e3, 5e3)]
    assert length([right]) == pytest.approx(15e3 + 50 * PI)
    (mirrored,) = paths_of([bent.reversed()], [-100.0])
    assert [tuple(v)[:2] for v in mirrored.vertices] == [tuple(v)[:2] for v in left.vertices][::-1]


def test_open_contour_whose_start_no_wire_reaches_is_interference():
    hook = opened((0, 0), (10e3, 0), (10e3, 5e3), (0, 5e3), (0, 150))
    result, problems = compensate([hook], [200.0])
    assert not problems
    assert [(i.kind, i.at) for i in result.interference] == [("passage", (0.0, 0.0))]


def test_sharp_prolongs_up_to_four_offsets():
    (path,) = paths_of([RECT], [-2e3], sharp=True)
    assert len(path) == 4
    assert signed_area(path) == pytest.approx(24e3 * 14e3)
    # 1 : 10 triangle: the tip of 5.7 degrees would reach 20 offsets; it keeps its arc.
    thin = polygon((0, 0), (10e3, 0), (0, 1e3))
    (path,) = paths_of([thin], [-100.0], sharp=True)
    assert (path.vertices["turn"] != 0).sum() == 1


def test_zero_shift_returns_the_outline():
    (path,) = paths_of([RECT], [0.0])
    assert signed_area(path) == signed_area(RECT)
    assert len(path) == 4


def test_sources_follow_the_segments():
    v = RECT.vertices.copy()
    v["source"] = [3, 1, 4, 1]
    (path,) = paths_of([Contour(v, True)], [-100.0])
    assert set(path.vertices["source"].tolist()) == {1, 3, 4}
    lines = path.vertices[path.vertices["turn"] == 0]
    assert lines["source"].tolist() == [3, 1, 4, 1]


def test_pinched_stator_falls_into_its_slots():
    result, problems = compensate([pinch(96)], [130.0])
    assert not problems
    assert len(result.paths) == 13
    assert len(result.interference) == 12
    assert {len(i.rows) for i in result.interference} == {2}  # the two walls of each neck


def test_drawing_that_crosses_itself_within_a_micron():
    """A step of 0.3 um that runs back over the line before it."""
    points = [(0, 0), (10e3, 0), (10e3, 0.2), (10e3 - 0.3, -0.1), (10e3 + 5e3, 8e3), (0, 8e3)]
    contour = polygon(*points)
    plain = polygon((0, 0), (10e3, 0), (15e3, 8e3), (0, 8e3))
    for shift in (-100.0, 100.0):
        (path,), (same,) = paths_of([contour], [shift]), paths_of([plain], [shift])
        assert signed_area(path) == pytest.approx(signed_area(same), abs=0.5 * length([same]))


@pytest.mark.parametrize("far", [0.0, 9e6])
def test_far_from_the_origin(far):
    """10 m out nothing changes: figures are relative to a point near the part."""
    c = contour_of_bulges(*rounded(np.array([(0, 0), (9e3, 0), (9e3, 7e3), (0, 7e3)]) + far, 300.0))
    (path,) = paths_of([c], [100.0])
    assert signed_area(path) == pytest.approx(8.8e3 * 6.8e3 - (4 - PI) * 200**2, rel=1e-9)


class TestLargestOffset:
    @pytest.mark.parametrize(
        ("contours", "signs", "truth"),
        [
            ([slot(0, 0, 3e3, 500)], [1], 250),
            ([slot(0, 0, 3e3, 500, 0.3)], [1], 250),
            ([circle(5e3, 0, 777)], [1], 777),
            ([RECT], [1], 5e3),
            ([DUMBBELL], [1], 100),
            ([rectangle(5e3, 5e3), rectangle(5e3, 5e3, 5150)], [-1, -1], 75),
            ([stator(48)], [1], 300),
            ([pinch(48)], [1], 100),
            ([gear(96)], [1], 500),
        ],
    )
    def test_is_the_truth_to_the_um(self, contours, signs, truth):
        found = largest_offset(contours, signs)
        assert truth - 1.0 <= found.offset_um <= truth + 1e-9
        assert found.nearest_um == truth
        assert found.limit is not None

    def test_nothing_limits_the_outside_of_a_rectangle(self):
        assert largest_offset([RECT], [-1.0]) == Largest(8000.0, None)

    def test_fillet_is_named(self):
        square = np.array([(0, 0), (10e3, 0), (10e3, 10e3), (0, 10e3)], float)
        contour = contour_of_bulges(*rounded(square, np.array([400.0, 321.0, 400.0, 400.0])))
        found = largest_offset([contour], [1.0])
        assert found.offset_um == pytest.approx(321.0, abs=0.05)
        limit = found.limit
        assert (limit.kind, limit.row, limit.size) == ("radius", 2, pytest.approx(321.0))

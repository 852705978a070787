"""Where the wire does not fit: kind, place, rows and size, and where it does."""

import numpy as np
import pytest

import wedmcam
from drawings import drawing
from oracle import lengths, signed_area
from parts import circle, contour_of_bulges, rectangle, rounded
from wedmcam.transforms.compensate import compensate

SQUARE = np.array([(0, 0), (10e3, 0), (10e3, 10e3), (0, 10e3)], float)


def polygon(*points):
    return contour_of_bulges(np.array(points, float), np.zeros(len(points)))


def notched(width):
    """Square of 10 mm with a slot from the top, 5 mm deep; rows 3, 4, 5 are the slot."""
    a = 5e3 + width
    top = [(10e3, 10e3), (a, 10e3), (a, 5e3), (5e3, 5e3), (5e3, 10e3)]
    return polygon((0, 0), (10e3, 0), *top, (0, 10e3))


def bar(width):
    """Two rooms of 4 x 4 mm joined by a bar 2 mm long; rows 2 and 8 are its walls."""
    y = 1e3 + width
    return polygon(
        *[(0, 0), (4e3, 0), (4e3, 1e3), (6e3, 1e3), (6e3, 0), (10e3, 0), (10e3, 4e3), (6e3, 4e3)],
        *[(6e3, y), (4e3, y), (4e3, 4e3), (0, 4e3)],
    )


def pocketed(mouth):
    """Square of 10 mm with a pocket of 4 x 4 mm behind a mouth 1 mm deep; rows 3 to 9."""
    a = 5e3 + mouth
    return polygon(
        *[(0, 0), (10e3, 0), (10e3, 10e3), (a, 10e3), (a, 9e3), (7e3, 9e3), (7e3, 5e3)],
        *[(3e3, 5e3), (3e3, 9e3), (5e3, 9e3), (5e3, 10e3), (0, 10e3)],
    )


def places(contours, shifts):
    result, problems = compensate(contours, shifts)
    assert not problems
    return result


@pytest.mark.parametrize("radius", [20.0, 50.0, 99.0, 99.49])
def test_fillet_below_the_offset(radius):
    contour = contour_of_bulges(*rounded(SQUARE, np.array([300.0, radius, 300.0, 300.0])))
    for image, shift in ((contour, 100.0), (contour.reversed(), -100.0)):
        (found,) = places([image], [shift]).interference
        assert found.kind == "radius"
        assert found.at == pytest.approx((9900.0, 100.0), abs=1e-6)
        assert found.rows == (found.row,)
        assert image.vertices["turn"][found.row] != 0
        assert found.size == pytest.approx(radius)


@pytest.mark.parametrize("radius", [99.51, 99.9999, 100.0, 100.4, 101.0, 250.0])
def test_fillet_within_half_a_step_of_the_offset_fits(radius):
    contour = contour_of_bulges(*rounded(SQUARE, radius))
    assert not places([contour], [100.0]).interference


def test_each_fillet_is_one_finding():
    contour = contour_of_bulges(*rounded(SQUARE, 60.0))
    found = places([contour], [100.0]).interference
    assert [i.row for i in found] == [0, 2, 4, 6]


def test_sharp_inner_corners_are_none():
    result = places([rectangle(10e3, 5e3)], [100.0])
    assert not result.interference
    assert result.inner_corners == 4
    assert places([rectangle(10e3, 5e3)], [-100.0]).inner_corners == 0


def test_outer_fillets_below_the_offset_are_none():
    contour = contour_of_bulges(*rounded(SQUARE, 30.0))
    assert not places([contour], [-100.0]).interference


@pytest.mark.parametrize("width", [50.0, 150.0, 199.0, 199.99, 200.0])
def test_slot_narrower_than_the_wire(width):
    contour = notched(width)
    result = places([contour], [-100.0])
    (found,) = result.interference
    assert (found.kind, found.row, found.rows) == ("passage", 3, (3, 4, 5))
    assert found.at[0] == pytest.approx(5e3 + width / 2)
    # The wire hangs into the mouth, at the offset from its two corners.
    above = np.sqrt(100.0**2 - (width / 2) ** 2)
    assert found.at[1] == pytest.approx(10e3 + above, abs=1e-5)
    assert found.size == pytest.approx(10e3 + width)
    assert len(result.paths) == 1


@pytest.mark.parametrize("width", [200.1, 201.0, 400.0])
def test_slot_wider_than_the_wire(width):
    result = places([notched(width)], [-100.0])
    assert not result.interference
    assert lengths(result.paths[0].path).sum() == pytest.approx(50e3 - 200 + 200 + 542.4778, abs=1)


@pytest.mark.parametrize("width", [50.0, 150.0, 199.0, 200.0])
def test_neck_is_one_finding_and_both_rooms_are_cut(width):
    result = places([bar(width)], [100.0])
    (found,) = result.interference
    assert (found.kind, found.rows, found.size) == ("passage", (2, 8), pytest.approx(4e3))
    assert found.at[1] == pytest.approx(1e3 + width / 2)
    assert len(result.paths) == 2
    assert not result.pockets
    assert len(places([bar(201.0)], [100.0]).paths) == 1
    assert not places([bar(201.0)], [100.0]).interference


def test_pocket_behind_a_narrow_mouth_is_not_cut():
    """From outside no wire gets in, and the pocket's content leaves with the scrap around it."""
    contour = pocketed(150.0)
    for image, shift in ((contour, -100.0), (contour.reversed(), 100.0)):
        result = places([image], [shift])
        assert len(result.paths) == len(result.pockets) == 1
        path, pocket = result.paths[0].path, result.pockets[0].path
        assert signed_area(path) * signed_area(image) > 0
        assert signed_area(pocket) * signed_area(image) < 0
        assert abs(signed_area(pocket)) == pytest.approx(3.8e3**2, rel=1e-3)
        (found,) = result.interference
        assert (found.kind, len(found.rows)) == ("passage", 7)
    assert not places([pocketed(201.0)], [-100.0]).interference


def test_hole_smaller_than_the_wire_has_no_path():
    plate, hole = rectangle(10e3, 10e3), circle(5e3, 4e3, 90)
    result = places([plate, hole], [-100.0, 100.0])
    assert [p.outline for p in result.paths] == [0]
    (found,) = result.interference
    assert (found.kind, found.outline, found.rows) == ("vanished", 1, (0,))
    assert found.at == pytest.approx((5e3, 4e3))
    assert found.size == pytest.approx(180 * np.pi)


@pytest.mark.parametrize("gap", [50.0, 150.0, 199.9, 200.0])
def test_parts_nearer_than_the_wire(gap):
    """Equal signs: one path round both, and a finding for each."""
    both = [rectangle(5e3, 5e3), rectangle(5e3, 5e3, 5e3 + gap)]
    result = places(both, [-100.0, -100.0])
    assert [p.outlines for p in result.paths] == [(0, 1)]
    found = result.interference
    assert [(i.kind, i.outline, i.rows) for i in found] == [
        ("neighbour", 0, (1,)),
        ("neighbour", 1, (3,)),
    ]
    assert found[0].at[0] == pytest.approx(5e3 + gap / 2)


def test_parts_farther_than_the_wire():
    both = [rectangle(5e3, 5e3), rectangle(5e3, 5e3, 5201.0)]
    result = places(both, [-100.0, -100.0])
    assert len(result.paths) == 2
    assert not result.interference


def test_wire_that_would_run_into_what_another_contour_keeps():
    """Opposite signs: the outside of one, nearer than the wire to the edge of the other."""
    both = [rectangle(5e3, 5e3), rectangle(5e3, 5e3, 5150.0)]
    result = places(both, [-100.0, 100.0])
    assert [p.outline for p in result.paths] == [1]
    (found,) = result.interference
    assert (found.kind, found.outline, found.rows) == ("neighbour", 0, (0, 1, 2, 3))


def test_contours_inside_each_other_nearer_than_the_wire():
    both = [rectangle(10e3, 10e3), rectangle(9.85e3, 9.85e3, 75, 75)]
    result = places(both, [100.0, -100.0])
    assert not result.paths
    assert [(i.kind, i.outline) for i in result.interference] == [("vanished", 0), ("vanished", 1)]


def test_smooth_contours_inside_each_other_nearer_than_the_wire():
    """No path crosses the other, and still there is none."""
    ring = contour_of_bulges(*rounded(SQUARE, 2000.0))
    inner = contour_of_bulges(*rounded(75 + SQUARE * 0.985, 1950.0))
    result = places([ring, inner], [100.0, -100.0])
    assert not result.paths
    assert {i.kind for i in result.interference} == {"vanished"}


def test_step_lower_than_the_wire_is_left_out():
    """A riser of 30 um between two fillets of a spline is no corner: it is reported."""
    contour = polygon(
        (0, 0), (5e3, 0), (5e3, 50), (5.03e3, 50), (5.03e3, 0), (10e3, 0), (10e3, 5e3), (0, 5e3)
    )
    found = places([contour], [-100.0]).interference
    assert [i.kind for i in found] == ["passage"]
    assert 2 in found[0].rows


def test_circles_in_each_other_are_too_near_and_not_too_small():
    """Of concentric circles the paths change places and cross nowhere."""

    def draw(_, m):
        for r in (50, 40, 30):
            m.add_circle((0, 0), r)

    made = wedmcam.compile(drawing(draw), name="rings.dxf", offset=5.001)
    said = [str(d) for d in made.findings if d.code == "interference"]
    assert len(said) == 2
    assert all("meets another contour at" in text for text in said), said

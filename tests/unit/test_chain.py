import math

import numpy as np
import pytest

from drawings import SQUARE, codes, polygon, sketch
from wedmcam.geom import measure
from wedmcam.transforms.chain import chain, open_contour_findings
from wedmcam.transforms.meetings import contour_meetings


def points(contour):
    v = contour.vertices
    return list(zip(v["x"].tolist(), v["y"].tolist(), strict=True))


def test_square_from_its_lowest_left_vertex_counter_clockwise():
    contours, report, found = chain(sketch([SQUARE[2], SQUARE[0], SQUARE[3], SQUARE[1]]))
    (contour,) = contours
    assert contour.closed
    assert points(contour) == [(0, 0), (10_000, 0), (10_000, 10_000), (0, 10_000)]
    assert [contour.source_of(k).handle for k in range(4)] == ["1", "3", "0", "2"]
    assert (report.closed, report.open, report.joins, found) == (1, 0, 0, ())


def test_nothing():
    contours, report, found = chain(sketch([]))
    assert (contours, report.closed, found) == ((), 0, ())


@pytest.mark.parametrize("turn", [1, -1])
def test_circle(turn):
    contours, _, _ = chain(sketch([(3, -5, 3, -5, 3, 0, turn)]))
    (contour,) = contours
    v = contour.vertices[0]
    assert (v["x"], v["y"], v["cx"], v["cy"], v["turn"]) == (8, 0, 3, 0, 1)


def test_circle_of_two_halves():
    (contour,), _, _ = chain(sketch([(5, 0, -5, 0, 0, 0, 1), (5, 0, -5, 0, 0, 0, -1)]))
    assert measure.area(contour.vertices) == pytest.approx(25 * math.pi)


# --- joining --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("gap", "joined", "listed"),
    [(0.5, True, 0), (1, True, 1), (2, True, 1), (9, True, 1), (11, False, 0), (400, False, 0)],
)
def test_gaps(gap, joined, listed):
    contours, report, found = chain(sketch([*SQUARE[:3], (0, 10_000, 0, gap)]))
    assert contours[0].closed is joined
    assert report.joins == joined
    assert report.max_shift_um == (gap / 2 if joined else 0)
    assert codes(found) == ["join"] * joined
    if joined:
        assert len(found[0].notes) == listed
        assert (0, gap / 2) in points(contours[0])
    (open_finding,) = open_contour_findings(contours) if not joined else [None]
    if open_finding:
        assert f"are {gap / 1000:.3f} mm apart" in open_finding.message
        assert open_finding.hint == f"--join {gap / 1000:.3f} would close the gap"
        assert open_finding.points_mm == ((0, 0), (0, gap / 1000))


def test_tolerance_does_not_grow_with_the_drawing():
    for scale in (0.01, 1, 100):
        rows = [tuple(v * scale for v in row) for row in SQUARE[:3]]
        rows.append((0, 10_000 * scale, 0, 9))
        assert chain(sketch(rows))[0][0].closed
        rows[-1] = (0, 10_000 * scale, 0, 11)
        assert not chain(sketch(rows))[0][0].closed


def test_ends_on_either_side_of_a_rounding_border():
    for cell in (0.5, 1.0, 10.0, 1000.0):
        for nudge in (1e-9, 1e-4, 0.4):
            last = (0, 10_000, cell - nudge, cell - nudge)
            rows = [(cell + nudge, cell + nudge, 10_000, 0), *SQUARE[1:3], last]
            assert chain(sketch(rows))[0][0].closed, (cell, nudge)


def test_a_row_of_ends_does_not_collapse():
    # Ten ends, each 8 um from the next, tolerance 10: pairs, never one place.
    rows = [(x, 0.0, x, 5000.0 + 500 * k) for k, x in enumerate(range(0, 80, 8))]
    contours, report, _ = chain(sketch(rows))
    assert report.joins == 5
    assert len(contours) == 5
    assert report.max_shift_um == 4


def test_a_chain_of_short_segments_keeps_its_vertices():
    rows = polygon(*((float(x), 0.0) for x in range(0, 80, 8)), closed=False)
    (contour,), report, _ = chain(sketch(rows))
    assert points(contour) == [(x, 0) for x in range(0, 80, 8)]
    assert report.joins == 0


def test_the_nearest_pair_goes_first():
    # 6 um to the left, 3 um to the right: the right one.
    rows = [(-1000, 0, -6, 0), (0, 0, 0, 1000), (3, 0, 1000, 0)]
    contours, report, _ = chain(sketch(rows))
    assert report.joins == 1
    assert sorted(len(c) for c in contours) == [1, 2]


def test_a_short_segment_does_not_close_upon_itself():
    (contour,), report, _ = chain(sketch([(0, 0, 5, 0)]))
    assert not contour.closed
    assert report.joins == 0


def test_an_almost_full_arc_closes_upon_itself():
    end = (1000 * math.cos(-0.004), 1000 * math.sin(-0.004))
    (contour,), report, _ = chain(sketch([(1000, 0, *end, 0, 0, 1)]))
    assert contour.closed
    assert len(contour) == 1
    assert report.joins == 1


def test_float_noise_is_no_join_and_lines_win():
    noise = 1e-7
    rows = [(0, 0, 1000, 0), (1000 + noise, 0, 0, noise, 500, 0, 1)]
    (contour,), report, found = chain(sketch(rows))
    assert points(contour) == [(0, 0), (1000, 0)]
    assert (report.joins, found) == (0, ())
    assert contour.vertices["cx"][1] == 500


def test_a_join_keeps_the_radius_of_an_arc():
    # A quarter of radius 1000 that ends 4 um short, in both directions of drawing.
    end = (4.0, math.sqrt(1000**2 - 4**2))
    images = []
    for arc in ((1000, 0, *end, 0, 0, 1), (*end, 1000, 0, 0, 0, -1)):
        (contour,), report, _ = chain(sketch([arc, (0, 1000, 0, 0), (0, 0, 1000, 0)]))
        s = measure.segments_of(contour.vertices, True)
        (at,) = np.flatnonzero(s.turn)
        assert s.radius[at] == pytest.approx(1000, abs=1e-9)
        miss = math.hypot(s.x1[at] - s.cx[at], s.y1[at] - s.cy[at]) - s.radius[at]
        assert abs(miss) < 1e-9
        assert 0 < math.hypot(s.cx[at], s.cy[at]) < 4
        assert report.max_shift_um < 5
        images.append([contour.vertices[k].tobytes() for k in ("x", "y", "cx", "cy")])
    assert images[0] == images[1]


def test_a_join_does_not_swing_a_half_circle():
    # Keeping the radius would lift the belly by 63 um.
    rows = [
        (0, 0, 10_000, 0),
        (10_000, 4, 10_000, 2000, 10_000, 1002, 1),
        (10_000, 2000, 0, 2000),
        (0, 2000, 0, 0, 0, 1000, 1),
    ]
    (contour,), report, found = chain(sketch(rows))
    assert codes(found) == ["join"]
    assert report.max_shift_um <= 4
    assert measure.extents(contour.vertices, True)[2] == pytest.approx(11_000, abs=5)


def test_a_join_that_would_swing_an_arc_is_an_error():
    # An arc of 359.9 degrees: a gap of 18 um, its ends 9 um off the line that closes it.
    end = (10_000 * math.cos(-0.003), 10_000 * math.sin(-0.003))
    rows = [(10_000, 0, *end, 0, 0, 1), (10_009, 0, end[0] - 9, end[1])]
    _, _, found = chain(sketch(rows))
    assert "join-moves-arc" in codes(found)


# --- copies and pieces ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "copy",
    [
        (0, 0, 10_000, 0),
        (10_000, 0, 0, 0),
        (0.4, 0.4, 10_000.3, -0.4),
        (10_000, 0.4, 0, 0.4),
    ],
)
def test_copies_of_a_line(copy):
    contours, report, found = chain(sketch([*SQUARE, copy, copy]))
    assert [c.closed for c in contours] == [True]
    assert (report.duplicates, codes(found)) == (2, ["duplicate"])


def test_copies_of_an_arc_and_of_a_circle():
    rows = [
        (10, 0, -10, 0, 0, 0, 1),
        (-10, 0, 10, 0, 0, 0, -1),
        (-10, 0, 10, 0, 0, 0, 1),
        (105, 0, 105, 0, 100, 0, 1),
        (95, 0, 95, 0, 100, 0, -1),
    ]
    contours, report, _ = chain(sketch(rows))
    assert [len(c) for c in contours] == [2, 1]
    assert report.duplicates == 2


def test_short_neighbours_are_no_copies():
    # Twelve segments of about half a micrometre.
    around = [(math.cos(k * math.pi / 6), math.sin(k * math.pi / 6)) for k in range(12)]
    (contour,), report, _ = chain(sketch(polygon(*around)))
    assert len(contour) == 12
    assert report.duplicates == 0


def test_pieces_without_length():
    rows = [*SQUARE, (0, 0, 1e-5, 0), (5, 5, 5, 5), (7, 7, 7 + 1e-9, 7, 6, 7, 1)]
    _, report, found = chain(sketch(rows))
    assert report.zero_length >= 2
    assert "zero-length" in codes(found)


# --- branches and touching loops ------------------------------------------------------------


def test_branch_names_the_place():
    contours, report, found = chain(sketch([*SQUARE, (0, 0, 5000, 5000)]))
    assert (contours, report.branches, codes(found)) == ((), 1, ["branch"])
    assert found[0].points_mm == ((0.0, 0.0),)
    assert {s.handle for _, s in found[0].notes} == {"0", "3", "4"}


def test_loops_that_touch_in_a_vertex_are_two():
    rows = [*polygon((0, 0), (900, 0), (0, 900)), *polygon((0, 0), (-900, 0), (0, -900))]
    contours, _, found = chain(sketch(rows))
    assert [(c.closed, len(c)) for c in contours] == [(True, 3), (True, 3)]
    assert codes(found) == ["contours-touch"]


def test_a_wreath_of_loops():
    # Loops in a ring share one vertex each with the next: a big inner loop as well: ambiguous.
    rows = []
    for k in range(6):
        a, b = (2 * math.pi * (k + d) / 6 for d in (0, 1))
        p = (1000 * math.cos(a), 1000 * math.sin(a))
        q = (1000 * math.cos(b), 1000 * math.sin(b))
        m = (1500 * math.cos((a + b) / 2), 1500 * math.sin((a + b) / 2))
        rows += [(*p, *q), (*p, *m), (*m, *q)]
    _, report, found = chain(sketch(rows))
    assert report.branches == 6
    assert set(codes(found)) == {"branch"}


def test_a_string_of_loops():
    rows = []
    for k in range(50):
        x = 1000 * k
        rows += polygon((x, 0), (x + 500, -300), (x + 1000, 0), (x + 500, 300))
    contours, _, _ = chain(sketch(rows))
    assert [len(c) for c in contours] == [4] * 50


def test_a_loop_on_an_open_chain():
    rows = [(-500, 0, 0, 0), *SQUARE, (0, 0, 0, -500)]
    contours, _, _ = chain(sketch(rows))
    assert [(c.closed, len(c)) for c in contours] == [(True, 4), (False, 2)]


def test_a_cross_of_open_lines_is_a_branch():
    rows = [(0, 0, 9, 0), (0, 0, -9, 0), (0, 0, 0, 9), (0, 0, 0, -9)]
    assert codes(chain(sketch(rows))[2]) == ["branch"]


# --- overlaps and crossings -----------------------------------------------------------------


def box(x, y, w, h):
    return polygon((x, y), (x + w, y), (x + w, y + h), (x, y + h))


@pytest.mark.parametrize(
    ("rows", "code", "place"),
    [
        (box(10_000, 2000, 5000, 3000), "overlap", (10, 3.5)),
        (box(5000, 2000, 15_000, 3000), "crossing-contours", (10, 2)),
        # Through a vertex on a side: only the sides of the vertex tell.
        (
            polygon((5000, 5000), (10_000, 3000), (15_000, 5000), (10_000, 7000)),
            "crossing-contours",
            (10, 3),
        ),
        (polygon((15_000, 5000), (10_000, 3000), (15_000, 1000)), "contours-touch", (10, 3)),
        ([(11_000, 5000, 11_000, 5000, 10_500, 5000, 1)], "contours-touch", (10, 5)),
        ([(11_000, 5000, 11_000, 5000, 10_300, 5000, 1)], "crossing-contours", None),
    ],
)
def test_contours_that_meet(rows, code, place):
    contours, _, found = chain(sketch([*SQUARE, *rows]))
    assert code in codes(found)
    first = next(d for d in found if d.code == code)
    if place:
        assert first.points_mm[0] == pytest.approx(place, abs=1e-9)
    assert {d.handle for d in [first.span, first.notes[0][1]]} & {"0", "1", "2", "3"}
    # The same from finished contours.
    again = contour_meetings(contours)
    kinds = {c for c in codes(found) if c != "contours-touch"}
    assert {c for c in codes(again) if c != "contours-touch"} == kinds


def test_self_crossing():
    _, _, found = chain(sketch(polygon((0, 0), (9000, 9000), (9000, 0), (0, 9000))))
    assert codes(found) == ["self-crossing"]
    assert found[0].points_mm[0] == pytest.approx((4.5, 4.5))


def test_open_spiral_that_crosses_itself():
    rows = polygon((0, 0), (9000, 0), (9000, 9000), (5000, -5000), closed=False)
    _, _, found = chain(sketch(rows))
    assert codes(found) == ["self-crossing"]


def test_neighbours_that_cross_away_from_their_vertex():
    # The arc leaves the line at (10, 0) and meets it again at (2, 0); the line from its end meets
    # it again at (3, -1).
    rows = [(0, 0, 10_000, 0), (10_000, 0, 6000, -2000, 6000, 3000, 1), (6000, -2000, 0, 0)]
    _, _, found = chain(sketch(rows))
    assert codes(found) == ["self-crossing"]
    first, second = found[0].points_mm
    assert first == pytest.approx((3, -1))
    assert second == pytest.approx((2, 0))


def test_overlap_on_a_circle():
    ring = (1000, 0, 1000, 0, 0, 0, 1)
    half = (0, 1000, 0, -1000, 0, 0, 1)
    assert "overlap" in codes(chain(sketch([ring, half]))[2])
    touching = [(1000, 0, 0, 1000, 0, 0, 1), (0, 1000, 1000, 0, 0, 0, 1)]
    assert chain(sketch(touching))[2] == ()


def test_tangent_fillets_do_not_cross_their_lines():
    # A rounded plate, rounded to 1 um: arcs miss their lines by that much.
    r, size = 1234.567, 20_000
    rows = []
    for k in range(4):
        c, s = round(math.cos(k * math.pi / 2)), round(math.sin(k * math.pi / 2))

        def turn(x, y, c=c, s=s):
            return (round(c * x - s * y), round(s * x + c * y))

        h = size / 2
        rows.append((*turn(-h + r, -h), *turn(h - r, -h)))
        rows.append((*turn(h - r, -h), *turn(h, -h + r), *turn(h - r, -h + r), 1))
    contours, _, found = chain(sketch(rows))
    assert [c.closed for c in contours] == [True]
    assert found == ()


def test_many_findings_are_cut_short():
    rows = []
    for k in range(60):
        rows.append((0, 100 * k, 50, 100 * k))
    contours, _, _ = chain(sketch(rows))
    found = open_contour_findings(contours)
    assert len(found) == 21
    assert found[-1].count == 40


def test_open_contour_names_the_nearest_end():
    rows = [(0, 0, 1000, 0), (1000.0, 52, 0, 52)]
    contours, _, _ = chain(sketch(rows))
    found = open_contour_findings(contours)
    assert codes(found) == ["open-contour"] * 2
    assert "0.052 mm away" in found[0].notes[0][0]
    assert found[0].notes[0][1].handle == "1"
    assert found[0].hint == "--join 0.052 would close the gap"

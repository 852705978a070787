"""The step loop against the published step tables and programs."""

import pytest

from wedmcam.controllers.pointwise import (
    LineTable,
    arc_quadrant,
    arc_steps,
    block_steps,
    line_axis,
    line_steps,
)
from wedmcam.ir.program import BLOCK, Axis, Kind

X, Y, SQUARE = Axis.X, Axis.Y, Axis.SQUARE


def table(steps):
    steps = list(steps)
    return "".join(s.axis.name for s in steps), [s.f for s in steps], (steps[-1].x, steps[-1].y)


@pytest.mark.parametrize("line_table", [LineTable.MIRROR, LineTable.ROTATE])
def test_published_line(line_table):
    assert table(line_steps(6, 4, X, 6, line_table)) == (
        "XYXYXXYXYX",
        [-4, 2, -2, 4, 0, -4, 2, -2, 4, 0],
        (6, 4),
    )


# The square counts the y steps of the first octant and the x steps of the second.
@pytest.mark.parametrize(("axis", "count"), [(X, 4), (SQUARE, 5)])
def test_published_arc_counter_clockwise(axis, count):
    assert table(arc_steps(4, 0, +1, axis, count)) == (
        "XYYYXYXX",
        [-7, -6, -3, 2, -3, 4, 1, 0],
        (0, 4),
    )


@pytest.mark.parametrize(("axis", "count"), [(Y, 6), (SQUARE, 8)])
def test_published_arc_clockwise(axis, count):
    assert table(arc_steps(0, 6, -1, axis, count)) == (
        "YXXXXYXYXYYY",
        [-11, -10, -7, -2, 5, -4, 5, -2, 9, 4, 1, 0],
        (6, 0),
    )


def test_published_hole_closes():
    assert list(line_steps(9900, 0, X, 9900))[-1][3:] == (9900, 0)
    assert list(arc_steps(9900, 0, +1, Y, 39600))[-1][3:] == (9900, 0)
    assert list(line_steps(-9900, 0, X, 9900))[-1][3:] == (-9900, 0)


def test_published_arc_and_back():
    assert list(arc_steps(-2000, 9000, +1, Y, 25440))[-1][3:] == (9000, -2000)
    assert list(arc_steps(9000, -2000, -1, X, 25440))[-1][3:] == (-2000, 9000)


def test_line_of_a_ratio_goes_on_past_it():
    assert list(line_steps(17, 5, X, 17000))[-1][3:] == (17000, 5000)
    assert list(line_steps(0, 1, Y, 50000))[-1][3:] == (0, 50000)


@pytest.mark.parametrize(("sx", "sy"), [(1, 1), (-1, 1), (-1, -1), (1, -1)])
def test_tie_ends_exactly_only_on_the_axis_of_its_table(sx, sy):
    def end(axis, line_table):
        return list(line_steps(3 * sx, 3 * sy, axis, 3, line_table))[-1][3:]

    assert end(Y, LineTable.MIRROR) == (3 * sx, 3 * sy)
    assert end(X, LineTable.MIRROR) == (3 * sx, 2 * sy)
    assert end(X, LineTable.MIRROR_EXCHANGED) == (3 * sx, 3 * sy)
    assert end(Y, LineTable.MIRROR_EXCHANGED) == (2 * sx, 3 * sy)
    right, wrong = (Y, X) if sx * sy > 0 else (X, Y)  # the 3B tie rule
    assert end(wrong, LineTable.ROTATE_EXCHANGED) == (3 * sx, 3 * sy)
    assert end(right, LineTable.ROTATE_EXCHANGED) != (3 * sx, 3 * sy)
    assert end(right, LineTable.ROTATE) == (3 * sx, 3 * sy)
    assert end(wrong, LineTable.ROTATE) != (3 * sx, 3 * sy)


def test_rotated_table_is_the_first_quadrant_turned():
    first = [(s.f, s.x, s.y) for s in line_steps(7, 3, X, 7, LineTable.ROTATE)]
    turned = [(s.f, s.y, -s.x) for s in line_steps(-3, 7, Y, 7, LineTable.ROTATE)]
    assert turned == first


def test_axis_of_a_line():
    assert [line_axis(5, -3), line_axis(-3, 5), line_axis(-4, 4)] == [X, Y, Y]
    assert len(list(line_steps(5, -3, SQUARE, 5))) == 8


@pytest.mark.parametrize("line_table", LineTable)
@pytest.mark.parametrize(("x", "y"), [(5, 0), (-5, 0), (0, 5), (0, -5)])
def test_axis_line_steps_one_axis(x, y, line_table):
    steps = list(line_steps(x, y, SQUARE, 5, line_table))
    assert len(steps) == 5
    assert steps[-1][2:] == (0, x, y)


def test_what_never_ends_is_refused():
    for x, y, axis, count in ((0, 5, X, 1), (5, 0, Y, 1), (0, 0, SQUARE, 1), (5, 5, X, -1)):
        with pytest.raises(ValueError, match="never ends"):
            next(line_steps(x, y, axis, count))
    for x, y, count in ((0, 0, 1), (1, 0, 1), (0, -1, 1), (5, 5, -1)):
        with pytest.raises(ValueError, match="never ends"):
            next(arc_steps(x, y, 1, X, count))


def test_smallest_arc_turns():
    assert [s[3:] for s in arc_steps(1, 1, 1, X, 4)] == [
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
    ]


def test_quadrants():
    points = [(3, 2), (-3, 2), (-3, -2), (3, -2)]
    for turn in (1, -1):
        assert [arc_quadrant(*p, turn) for p in points] == [1, 2, 3, 4]


def test_blocks_are_seen_from_their_start():
    import numpy as np

    blocks = np.zeros(3, BLOCK)
    blocks["kind"] = Kind.ARC, Kind.MOVE, Kind.PAUSE
    blocks["turn"], blocks["axis"], blocks["x"], blocks["y"] = (1, 0, 0), X, (4, 6, 0), (0, 4, 0)
    blocks["count"] = 4, 6, 0
    ends = [[s[3:] for s in block_steps(b)][-1:] for b in blocks]
    assert ends == [[(-4, 4)], [(6, 4)], []]

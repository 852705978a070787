"""The closed forms: published programs, limits, invalid blocks, shapes."""

import math

import numpy as np
import pytest

from wedmcam.controllers.pointwise import (
    LineTable,
    arc_end,
    block_steps,
    deviation,
    path,
    position,
    reversals,
    run,
    trace,
)
from wedmcam.ir.program import BLOCK, Axis, Kind

X, Y, SQUARE = Axis.X, Axis.Y, Axis.SQUARE
LINE, ARC = Kind.LINE, Kind.ARC


def blocks(*rows):
    """Rows (kind, turn, axis, x, y, count)."""
    out = np.zeros(len(rows), BLOCK)
    for name, column in zip(
        ("kind", "turn", "axis", "x", "y", "count"), zip(*rows, strict=True), strict=True
    ):
        out[name] = column
    return out


HOLE = blocks(
    (LINE, 0, X, 9900, 0, 9900), (ARC, 1, Y, 9900, 0, 39600), (LINE, 0, X, -9900, 0, 9900)
)
SLIT = blocks((ARC, 1, Y, -2000, 9000, 25440), (ARC, -1, X, 9000, -2000, 25440))


def test_published_programs():
    moves = run(HOLE)
    assert moves.dx.tolist() == [9900, 0, -9900]
    assert moves.dy.tolist() == [0, 0, 0]
    assert moves.steps.tolist() == [9900, 8 * 9900, 9900]
    assert run(SLIT).dx.tolist() == [11000, -11000]
    assert run(SLIT).dy.tolist() == [-11000, 11000]


def test_full_circle_in_one_block_up_to_the_square_limit():
    # 4 sqrt(2) R is below 999,999 up to R = 176,776 um, the published limit of one block.
    e = arc_end(176_776, 0, 1, 176_776, 0)
    assert int(e.count_square) <= 999_999
    assert abs(int(e.count_square) - 4 * math.sqrt(2) * 176_776) < 4
    assert int(arc_end(176_778, 0, 1, 176_778, 0).count_square) > 999_999
    moves = run(blocks((ARC, 1, SQUARE, 176_776, 0, int(e.count_square))))
    # On the square the last counted step of the turn is the arriving one.
    assert bool(e.square_counts)
    assert (int(moves.dx[0]), int(moves.dy[0]), int(moves.steps[0])) == (0, 0, int(e.steps))


def test_ten_metres():
    r = 10_000_000
    for turn in (1, -1):
        e = arc_end(r, 0, turn, 0, turn * r)
        assert bool(e.landed)
        assert (int(e.count_x), int(e.count_y), int(e.steps)) == (r, r, 2 * r)
        moves = run(blocks((ARC, turn, X, r, 0, r), (LINE, 0, X, r, turn * (r - 1), r)))
        assert moves.dx.tolist() == [-r, r]
        assert moves.dy.tolist() == [turn * r, turn * (r - 1)]
        assert moves.steps.tolist() == [2 * r, 2 * r - 1]


def test_invalid_blocks_are_marked_and_do_nothing():
    b = blocks(
        (ARC, 1, X, 0, 0, 5),
        (ARC, 1, X, 1, 0, 5),
        (ARC, 1, SQUARE, 0, -1, 5),
        (ARC, 1, Y, 10, 10, -1),
        (ARC, 0, Y, 10, 10, 7),
        (ARC, 1, Y, 30_000_000, 0, 7),
        (ARC, 1, Y, 10, 10, 2**50),
        (LINE, 0, X, 0, 5, 5),
        (LINE, 0, Y, 5, 0, 5),
        (LINE, 0, SQUARE, 0, 0, 5),
        (LINE, 0, X, 5, 5, -1),
        (LINE, 0, X, 2**40, 5, 5),
        (LINE, 0, X, 5, 5, 2**40),
        (Kind.MOVE, 0, X, 0, 5, 5),
    )
    for table in LineTable:
        moves = run(b, table)
        assert moves.steps.tolist() == [-1] * len(b)
        assert not moves.dx.any()
        assert not moves.dy.any()
        positions, first = trace(b, table)
        assert positions.tolist() == [[0, 0]]
        assert first.tolist() == [0] * len(b)
        for values in deviation(b, table) + reversals(b, table):
            assert not values.any()


def test_controls_and_empty_counts_do_nothing():
    b = blocks(
        (Kind.PAUSE, 0, 0, 0, 0, 0),
        (Kind.STOP, 0, 0, 3, 4, 5),
        (Kind.THREAD, 0, 0, 0, 0, 0),
        (ARC, 1, X, 5, 5, 0),
        (LINE, 0, X, 0, 0, 0),
        (LINE, 0, X, 0, 7, 0),
    )
    assert [v.tolist() for v in run(b)] == [[0] * 6] * 3
    assert run(b[:0]).steps.shape == (0,)
    assert trace(b[:0])[0].tolist() == [[0, 0]]
    assert deviation(b[:0])[0].shape == (0,)


def test_invalid_among_valid_does_not_disturb():
    good = [(ARC, 1, Y, -2000, 9000, 25440), (LINE, 0, X, 17, 5, 17000)]
    bad = [(ARC, 1, X, 1, 0, 5), (LINE, 0, X, 0, 5, 5)]
    moves = run(blocks(good[0], bad[0], good[1], bad[1], good[0]))
    assert moves.dx.tolist() == [11000, 0, 17000, 0, 11000]
    assert moves.dy.tolist() == [-11000, 0, 5000, 0, -11000]


def test_ratio_whose_products_pass_float64():
    # (J - 1) y is about 2^59: the quotient needs int64.
    x, y, j = 2**29 + 1, 2**29 - 7, 2**30
    for table in LineTable:
        moves = run(blocks((LINE, 0, X, x, -y, j), (LINE, 0, Y, x, -y, j)), table)
        floor_x, floor_y = (j - 1) * y // x, (j - 1) * x // y
        exact_x = (j - 1) * y % x == 0
        f_along_x = table in (LineTable.MIRROR, LineTable.ROTATE_EXCHANGED)  # in quadrant 4
        other = (floor_x + (not exact_x)) if f_along_x else floor_x + 1
        assert (int(moves.dx[0]), -int(moves.dy[0])) == (j, other)
        exact_y = (j - 1) * x % y == 0
        other = floor_y + 1 if f_along_x else floor_y + (not exact_y)
        assert (int(moves.dx[1]), -int(moves.dy[1])) == (other, j)


def test_trace_of_a_ratio_whose_products_pass_float64():
    b = blocks((LINE, 0, X, 2**30 - 1, 2**30 - 35, 2_500_000))
    positions, _ = trace(b)
    n = np.concatenate([np.arange(1000), np.arange(len(positions) - 1000, len(positions))])
    assert np.array_equal(np.stack(position(np.repeat(b, len(n)), n), axis=1), positions[n])


@pytest.mark.parametrize("turn", [1, -1])
def test_arc_end_keeps_the_shape(turn):
    ex, ey = np.meshgrid(np.arange(-4, 5), np.arange(-4, 5))
    e = arc_end(4, 0, turn, ex, ey)
    assert all(v.shape == (9, 9) for v in e)
    assert int(e.landed.sum()) == 32  # 8 R steps a turn, each on a place of its own
    assert sorted(e.steps[e.landed].tolist()) == list(range(1, 33))
    assert (e.steps[~e.landed] == -1).all()
    assert arc_end(4, 0, turn, 0, 4).landed.shape == ()


def test_arc_end_of_an_invalid_arc_lands_nowhere():
    e = arc_end([0, 1, 30_000_000], 0, 1, [0, 1, 30_000_000], 0)
    assert not e.landed.any()
    assert not e.square_counts.any()


def test_whole_circle_of_a_start_off_the_axes():
    e = arc_end(-2000, 9000, -1, -2000, 9000)
    reach = math.ceil(math.sqrt(2000**2 + 9000**2 - 1))
    assert bool(e.landed)
    assert int(e.steps) == 8 * reach
    assert int(e.count_x) == int(e.count_y) == 4 * reach


def test_position_goes_on_past_the_count():
    b = blocks((LINE, 0, X, 6, 4, 2), (ARC, 1, X, 4, 0, 1), (Kind.PAUSE, 0, 0, 0, 0, 0))
    dx, dy = position(b, np.array([10, 8, 3]))
    assert dx.tolist() == [6, -4, 0]
    assert dy.tolist() == [4, 4, 0]
    assert position(b, np.array([-5, 0, 0]))[0].tolist() == [0, 0, 0]


def test_trace_of_a_long_mixed_program():
    # Long and short runs, lines and arcs, controls and an invalid block, against the loop.
    b = blocks(
        (LINE, 0, X, 40_000, -17_000, 40_000),
        (ARC, -1, X, 300, 0, 500),
        (LINE, 0, Y, -3, 8, 20),
        (Kind.PAUSE, 0, 0, 0, 0, 0),
        (ARC, 1, Y, 9900, 120, 39_600),
        (ARC, 1, X, 1, 0, 5),
        (LINE, 0, Y, 0, -1, 3000),
        (ARC, 1, SQUARE, 1, 1, 9),
        (LINE, 0, X, -5, 0, 5),
    )
    for table in LineTable:
        positions, first = trace(b, table)
        want, starts, x, y = [(0, 0)], [], 0, 0
        for block in b:
            starts.append(len(want) - 1)
            if block["kind"] == ARC and block["x"] ** 2 + block["y"] ** 2 < 2:
                continue
            want += [(x + s.x, y + s.y) for s in block_steps(block, table)]
            x, y = want[-1]
        assert np.array_equal(positions, want)
        assert first.tolist() == starts


def test_deviation_of_known_blocks():
    # F of the published tables: line -4 .. 4, arcs -7 .. 4 and -11 .. 9.
    b = blocks((LINE, 0, X, 6, 4, 6), (ARC, 1, X, 4, 0, 4), (ARC, -1, Y, 0, 6, 6))
    low, high = deviation(b)
    assert low.tolist() == pytest.approx([-4 / math.sqrt(52), 3 - 4, 5 - 6], abs=1e-12)
    assert high.tolist() == pytest.approx(
        [4 / math.sqrt(52), math.sqrt(20) - 4, math.sqrt(45) - 6], abs=1e-12
    )


def test_deviation_is_positive_to_the_left():
    # Counted short on x, the first step leaves a steep line to its right.
    b = blocks((LINE, 0, X, 1, 5, 1), (LINE, 0, X, -1, 5, 1))
    low, high = deviation(b, LineTable.MIRROR)
    assert low[0] < 0 == high[0]
    assert low[1] == 0 < high[1]


def test_deviation_stays_below_one_step():
    rng = np.random.default_rng(1)
    b = np.zeros(400, BLOCK)
    b["kind"] = np.arange(400) % 2
    b["turn"] = np.where(b["kind"] == ARC, 1, 0)
    b["axis"], b["count"] = SQUARE, 200_000
    b["x"], b["y"] = rng.integers(-(10**6), 10**6, (2, 400))
    low, high = deviation(b)
    assert low.min() >= -1
    assert high.max() <= 1
    assert (high - low).min() > 0.5


def test_reversals_of_a_hole():
    rx, ry = reversals(HOLE)
    # In from the centre: +x. The circle begins with -x, turns at -x and at the two y apexes.
    assert rx.tolist() == [0, 2, 1]
    assert ry.tolist() == [0, 2, 0]
    assert reversals(HOLE, last=(-1, -1))[0].tolist() == [1, 2, 1]


def test_a_window_at_the_end_of_a_long_line_is_the_end_of_its_path():
    # A short piece of a line whose whole is long; pieces of short lines and arcs beside it.
    b = blocks(
        (LINE, 0, X, 1876, 0, 1876), (LINE, 0, X, 1200, -700, 1200), (ARC, 1, X, 250, 0, 400)
    )
    for table in LineTable:
        moves = run(b, table)
        zero = np.zeros(len(b))
        whole = np.column_stack(path.places(b, moves, zero, zero, table))
        for first in (723, 1400, 1499, 1875, 1876, 3000):
            for last in (first + 1, 1876, len(whole)):
                part = path.places(b, moves, zero, zero, table, (first, last))
                assert np.array_equal(np.column_stack(part), whole[first:last])


@pytest.mark.parametrize("length", [path.LONG - 1, path.LONG, path.LONG + 1])
@pytest.mark.parametrize(("dx", "dy"), [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_a_line_about_as_long_as_a_long_one_is_the_same_in_every_window(length, dx, dy):
    b = blocks(
        (LINE, 0, X if dx else Y, dx * length, dy * length, length), (ARC, 1, X, 250, 0, 400)
    )
    for table in LineTable:
        moves = run(b, table)
        zero = np.zeros(len(b))
        whole = np.column_stack(path.places(b, moves, zero, zero, table))
        assert np.array_equal(whole[length - 1], (dx * length, dy * length))
        for first in (0, 1, 2, 700, length - 1, length):
            for last in (length, length + 1, len(whole)):
                part = path.places(b, moves, zero, zero, table, (first, last))
                assert np.array_equal(np.column_stack(part), whole[first : max(first, last)])

"""The inverse of a step: exact at every step of small blocks, at far steps of large ones, in whole
programs; and what going back in the opposite sense does instead.

Forwards is the step loop as printed (small blocks, programs) and the closed forms (large ones).
"""

import sys
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from step_tables import opposite

from wedmcam import api
from wedmcam.controllers.pointwise import arc_steps, counts, line_axis, line_steps, position, run
from wedmcam.controllers.pointwise.back import arc_back, line_back
from wedmcam.ir.program import BLOCK, Axis, Kind

GOLDEN = Path(__file__).parents[1] / "golden"
SMALL = [(x, y) for x in range(-12, 13) for y in range(-12, 13)]
#: Largest radius, um.
R = 10_000_000


def test_every_step_of_small_arcs_is_undone():
    """All starts up to 12 um on x and y, both senses, 150 steps: several turns of most."""
    steps = 0
    for x, y in SMALL:
        if x * x + y * y < 2:
            continue
        for turn in (1, -1):
            before = 0
            for s in islice(arc_steps(x, y, turn, Axis.X, 150), 150):
                assert arc_back(s.x, s.y, s.f, turn) == (s.axis, s.sign, before), (x, y, turn, s)
                before = s.f
                steps += 1
    assert steps == (25 * 25 - 5) * 2 * 150


def test_every_step_of_small_lines_is_undone():
    """All directions up to 12 um, twice as far as they point: F has come by all its values."""
    for x, y in SMALL:
        if (x, y) == (0, 0):
            continue
        axis, before = line_axis(x, y), 0
        for s in line_steps(x, y, axis, 2 * max(abs(x), abs(y))):
            assert line_back(x, y, s.f) == (s.axis, s.sign, before), (x, y, s)
            before = s.f


def block(kind, x, y, turn=0):
    out = np.zeros(1, BLOCK)
    out["kind"], out["x"], out["y"], out["turn"] = kind, x, y, turn
    out["axis"], out["count"] = Axis.SQUARE, 1
    return out


def two_places(one, n):
    """Return where a block stands behind n - 1 and n steps, by the closed form."""
    rows = np.repeat(one, 2)
    dx, dy = position(rows, np.array([n - 1, n]))
    return list(zip(dx.tolist(), dy.tolist(), strict=True))


def step_between(a, b):
    along = Axis.X if a[1] == b[1] else Axis.Y
    return along, b[along] - a[along]


near_axis = st.one_of(st.integers(-3, 3), st.integers(-R, R))


@given(near_axis, near_axis, st.sampled_from([1, -1]), st.integers(1, 16 * R), st.booleans())
@example(R, 0, 1, 1, False)
@example(0, -R, -1, 8 * R, False)
@example(4_194_304, 0, 1, 5_931_642, False)
def test_any_step_of_large_arcs_is_undone(x, y, turn, n, exchanged):
    """Starts anywhere, on the axes and beside them too, R up to 10 m, up to two turns on."""
    assume(2 <= x * x + y * y <= R * R)
    x, y = (y, x) if exchanged else (x, y)
    a, b = ((x + p, y + q) for p, q in two_places(block(Kind.ARC, x, y, turn), n))
    f_before, f = (p * p + q * q - x * x - y * y for p, q in (a, b))
    assert arc_back(*b, f, turn) == (*step_between(a, b), f_before)


@given(near_axis, near_axis, st.integers(1, 2 * R))
def test_any_step_of_large_lines_is_undone(x, y, n):
    assume((x, y) != (0, 0))
    n = min(n, abs(x) + abs(y))
    a, b = two_places(block(Kind.LINE, x, y), n)
    f_before, f = (abs(x * q) - abs(y * p) for p, q in (a, b))
    assert line_back(x, y, f) == (*step_between(a, b), f_before)


def forwards(blocks):
    """Yield row, x, y, F and J at every place of every block, its start among them."""
    for row, b in enumerate(blocks):
        x, y, left, turn = (int(b[k]) for k in ("x", "y", "count", "turn"))
        if b["kind"] == Kind.ARC:
            axis, place = Axis.SQUARE, (x, y)
            steps = arc_steps(x, y, turn, axis, left)
        elif b["kind"] in (Kind.LINE, Kind.MOVE):
            axis, place = line_axis(x, y), (0, 0)
            steps = line_steps(x, y, axis, left)
        else:
            continue
        yield row, *place, 0, left
        for s in steps:
            left -= counts(axis, s.axis, *place)
            place = s.x, s.y
            yield row, *place, s.f, left


def backwards(blocks, row, x, y, f, left):
    """Yield the same from a place back to the start, by `line_back`, `arc_back` and J alone.

    At the start of a block its J is whole and F is 0 at its first place. Where the block before
    ends is what the closed form says.
    """
    while True:
        b = blocks[row]
        is_arc = b["kind"] == Kind.ARC
        bx, by, turn = (int(b[k]) for k in ("x", "y", "turn"))
        axis = Axis.SQUARE if is_arc else line_axis(bx, by)
        start = (bx, by) if is_arc else (0, 0)
        yield row, x, y, f, left
        while ((x, y), f, left) != (start, 0, int(b["count"])):
            back = arc_back(x, y, f, turn) if is_arc else line_back(bx, by, f)
            along, sign, f = back
            x, y = (x - sign, y) if along == Axis.X else (x, y - sign)
            left += counts(axis, along, x, y)
            yield row, x, y, f, left
        row -= 1
        while row >= 0 and blocks["kind"][row] > Kind.MOVE:
            row -= 1
        if row < 0:
            return
        x, y, f = end_of(blocks[row : row + 1])
        left = 0


def end_of(one):
    moves, b = run(one), one[0]
    x, y = int(moves.dx[0]), int(moves.dy[0])
    bx, by = int(b["x"]), int(b["y"])
    if b["kind"] == Kind.ARC:
        x, y = x + bx, y + by
        return x, y, x * x + y * y - bx * bx - by * by
    return x, y, (abs(bx * y) - abs(by * x) if bx * by else 0)


@pytest.mark.parametrize("name", ["key-punch", "cam"])
def test_a_program_is_walked_back_to_its_start(name):
    """Every state of the way there, block, place, F and J, comes again in reverse."""
    program, _, findings = api.read_program((GOLDEN / f"{name}.zd").read_bytes(), name=f"{name}.zd")
    assert program is not None, findings
    there = list(forwards(program.blocks))
    assert len(there) > 100_000
    back = backwards(program.blocks, *there[-1])
    for state in reversed(there):
        assert next(back) == state
    assert next(back, None) is None


def test_the_opposite_sense_leaves_the_path_and_may_miss_the_start():
    """What `back` is for. NR1 from (9, 1), 17 steps: 6 of the places on the way back were never
    cut. NR1 from (4, 0), 9 steps: the way back ends beside the start."""
    path = [(9, 1), *((s.x, s.y) for s in islice(arc_steps(9, 1, 1, Axis.X, 99), 17))]
    other = opposite(path, 1)
    beside = [p for p in other if p not in path]
    assert beside == [(1, 8), (2, 8), (3, 8), (9, 4), (9, 3), (9, 2)]
    assert other[-1] == (9, 1)
    path = [(4, 0), *((s.x, s.y) for s in islice(arc_steps(4, 0, 1, Axis.X, 99), 9))]
    assert opposite(path, 1)[-1] == (3, -1)


def test_the_opposite_sense_is_never_further_than_1_um_on_an_axis():
    """All starts up to 12 um, both senses, from each of 60 steps back."""
    places = beside = missed = ways = 0
    for x, y in SMALL:
        if x * x + y * y < 2:
            continue
        for turn in (1, -1):
            path = [(x, y), *((s.x, s.y) for s in islice(arc_steps(x, y, turn, Axis.X, 99), 60))]
            for n in range(1, 61):
                cut = set(path[: n + 1])
                other = opposite(path[: n + 1], turn)
                off = [p for p in other if p not in cut]
                for p, q in off:
                    assert cut & {(p + i, q + k) for i in (-1, 0, 1) for k in (-1, 0, 1)}
                places, beside = places + len(other), beside + len(off)
                if other[-1] != path[0]:
                    # Only from the first step behind an axis, which runs along that axis.
                    assert 0 in path[n]
                    assert 0 in path[n - 1]
                    missed += 1
                ways += 1
    assert ways == 74_400
    assert 0.2 < beside / places < 0.4
    assert 0 < missed < 0.1 * ways

"""The closed forms equal the step loop, for every block that was tried.

Two oracles: ``controller.steps``, and a loop that steps many blocks at once, which is itself held
against ``controller.steps``.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.controllers import stepping_of
from wedmcam.controllers.pointwise import (
    LineTable,
    arc_end,
    block_steps,
    deviation,
    position,
    reversals,
    run,
    trace,
)
from wedmcam.ir.program import BLOCK, Axis, Kind

AXES = tuple(Axis)


class Lockstep:
    """Steps many blocks together by the printed rules; ``step`` makes one step of each."""

    def __init__(self, blocks, table):
        self.arc = blocks["kind"] == Kind.ARC
        self.turn = blocks["turn"].astype(np.int64)
        self.x0, self.y0 = blocks["x"].copy(), blocks["y"].copy()
        self.x, self.y = np.where(self.arc, self.x0, 0), np.where(self.arc, self.y0, 0)
        self.f = np.zeros(len(blocks), np.int64)
        odd = self.x0 * self.y0 < 0
        self.swapped = {
            LineTable.MIRROR: odd & False,
            LineTable.MIRROR_EXCHANGED: odd | True,
            LineTable.ROTATE: odd,
            LineTable.ROTATE_EXCHANGED: ~odd,
        }[table]

    def step(self):
        """Return whether the step is along x, and whether it counts on the square: y or x ties."""
        x, y, t = self.x, self.y, self.turn
        ax, ay = np.abs(x), np.abs(y)
        # Arc: on x, inwards is towards the y axis; the sense decides which axis shrinks.
        xt = np.where(t > 0, x, -x)
        shrinks_x = np.where(y == 0, True, (xt * y > 0) & (x != 0))
        inwards = self.f >= 0
        arc_on_x = shrinks_x == inwards
        on_line = np.where((self.x0 == 0) | (self.y0 == 0), self.y0 == 0, inwards != self.swapped)
        on_x = np.where(self.arc, arc_on_x, on_line)
        # Direction: the tangent of the sense is (-y, x) t; at its zero the radial step is inwards.
        tx, ty = np.sign(-y * t), np.sign(x * t)
        sx = np.where(self.arc, np.where(tx != 0, tx, -np.sign(x)), np.sign(self.x0))
        sy = np.where(self.arc, np.where(ty != 0, ty, -np.sign(y)), np.sign(self.y0))
        axis_line = (self.x0 == 0) | (self.y0 == 0)
        line_f = np.where(on_x, np.abs(self.y0), np.abs(self.x0)) * np.where(inwards, -1, 1)
        change = np.where(on_x, 2 * sx * x, 2 * sy * y) + 1
        self.f += np.where(self.arc, change, np.where(axis_line, 0, line_f))
        square = np.where(self.arc, on_x == (ax < ay), on_x == (abs(self.x0) > abs(self.y0)))
        square_x = np.where(self.arc, on_x == (ax <= ay), on_x == (abs(self.x0) >= abs(self.y0)))
        self.x, self.y = x + np.where(on_x, sx, 0), y + np.where(on_x, 0, sy)
        return on_x, square, square_x


def random_blocks(rng, n, r, longest):
    b = np.zeros(n, BLOCK)
    b["kind"] = rng.choice([Kind.LINE, Kind.ARC, Kind.MOVE], n, p=[0.3, 0.6, 0.1])
    b["turn"] = np.where(b["kind"] == Kind.ARC, rng.choice([-1, 1], n), 0)
    b["axis"] = rng.integers(0, len(AXES), n)
    b["x"], b["y"] = rng.integers(-r, r + 1, (2, n))
    special = rng.random(n)
    b["x"][special < 0.1] = 0
    b["y"][(special > 0.1) & (special < 0.2)] = 0
    same = (special > 0.2) & (special < 0.3)
    b["y"][same] = b["x"][same]
    b["count"] = rng.integers(0, longest + 1, n)
    return b


def loop(block, table):
    """Return [(x, y), ...] from the start on, or None where the block is refused."""
    try:
        return [(0, 0)] + [(s.x, s.y) for s in block_steps(block, table)]
    except ValueError:
        return None


def extremes(block, path):
    """Return (low, high) of deviation() from the positions, in exact integers until the end."""
    x, y = int(block["x"]), int(block["y"])
    r2 = x * x + y * y
    if block["kind"] == Kind.ARC:
        f = [(x + p) ** 2 + (y + q) ** 2 - r2 for p, q in path]
        return tuple(e / (math.sqrt(r2 + e) + math.sqrt(r2)) for e in (min(f), max(f)))
    f = [x * q - y * p for p, q in path]
    return min(f) / math.sqrt(r2), max(f) / math.sqrt(r2)


@pytest.mark.parametrize("table", LineTable)
def test_against_the_step_loop(table):
    rng = np.random.default_rng(7)
    b = np.concatenate([random_blocks(rng, 3000, 9, 60), random_blocks(rng, 60, 2000, 3000)])
    moves, (positions, first), dev = run(b, table), trace(b, table), deviation(b, table)
    at = np.zeros(2, np.int64)
    ask, where, want_at = [], [], []
    for i, block in enumerate(b):
        path = loop(block, table)
        assert (path is None) == (moves.steps[i] == -1), block
        if path is None:
            continue
        assert (moves.dx[i], moves.dy[i], moves.steps[i]) == (*path[-1], len(path) - 1), block
        got = positions[first[i] : first[i] + len(path)]
        assert np.array_equal(got, at + path), block
        if len(path) > 1:
            assert (dev[0][i], dev[1][i]) == extremes(block, path), block
        at = got[-1]
        for n in {0, 1, len(path) // 2, len(path) - 1} & set(range(len(path))):
            ask.append(i)
            where.append(n)
            want_at.append(path[n])
    assert np.array_equal(np.stack(position(b[ask], np.array(where), table), axis=1), want_at)


@pytest.mark.parametrize("table", LineTable)
def test_lockstep_is_the_step_loop(table):
    rng = np.random.default_rng(8)
    b = random_blocks(rng, 2000, 12, 40)
    keep = [i for i in range(len(b)) if loop(b[i], table) is not None and b["count"][i] > 0]
    b = b[keep]
    paths = [loop(block, table) for block in b]
    lock = Lockstep(b, table)
    x0, y0 = lock.x.copy(), lock.y.copy()
    for n in range(1, max(map(len, paths))):
        lock.step()
        dx, dy = lock.x - x0, lock.y - y0
        for i, path in enumerate(paths):
            if n < len(path):
                assert (dx[i], dy[i]) == path[n], b[i]


def test_every_small_start_every_count_two_turns():
    """Every start to 25, both senses, all four counts, every J to two turns: 4 million blocks."""
    g = np.arange(-25, 26)
    x, y, turn = (v.ravel() for v in np.meshgrid(g, g, [1, -1]))
    keep = x * x + y * y >= 2
    b = np.zeros(int(keep.sum()), BLOCK)
    b["kind"], b["x"], b["y"], b["turn"] = Kind.ARC, x[keep], y[keep], turn[keep]
    turns = 16 * np.ceil(np.sqrt(b["x"] ** 2 + b["y"] ** 2 - 1.0)).astype(np.int64)
    lock = Lockstep(b, LineTable.MIRROR)
    counts = np.zeros((4, len(b)), np.int64)
    low, high = np.zeros(len(b), np.int64), np.zeros(len(b), np.int64)
    checked = 0
    for n in range(1, int(turns.max()) + 1):
        on_x, square, square_x = lock.step()
        counted = np.stack([on_x, ~on_x, square, square_x])
        counts += counted
        low, high = np.minimum(low, lock.f), np.maximum(high, lock.f)
        live = n <= turns
        dx, dy = lock.x - b["x"], lock.y - b["y"]
        # Closed form of n, and of J on each axis on which this step counts.
        got = position(b[live], np.full(int(live.sum()), n))
        assert np.array_equal(got[0], dx[live])
        assert np.array_equal(got[1], dy[live])
        asked = []
        for axis in AXES:
            rows = np.flatnonzero(live & counted[axis])
            ask = b[rows]
            ask["axis"], ask["count"] = axis, counts[axis][rows]
            asked.append((ask, rows))
        ask, rows = np.concatenate([a for a, _ in asked]), np.concatenate([r for _, r in asked])
        moves = run(ask)
        assert np.array_equal(moves.dx, dx[rows])
        assert np.array_equal(moves.dy, dy[rows])
        assert (moves.steps == n).all()
        checked += len(ask)
        if n % 7 == 1 and n < 200:
            r = np.sqrt((b["x"] ** 2 + b["y"] ** 2).astype(np.float64))
            got_low, got_high = deviation(ask)
            f0, f1, r = low[rows], high[rows], r[rows]
            assert np.allclose(got_low, f0 / (np.sqrt(r * r + f0) + r), rtol=1e-13, atol=0)
            assert np.allclose(got_high, f1 / (np.sqrt(r * r + f1) + r), rtol=1e-13, atol=0)
        first_turn = 2 * n <= turns
        rows = np.flatnonzero(first_turn)
        e = arc_end(b["x"][rows], b["y"][rows], b["turn"][rows], lock.x[rows], lock.y[rows])
        assert e.landed.all()
        assert (e.steps == n).all()
        assert np.array_equal(e.last_axis, np.where(on_x[rows], Axis.X, Axis.Y))
        assert np.array_equal(e.count_x, counts[0][rows])
        assert np.array_equal(e.count_y, counts[1][rows])
        assert np.array_equal(e.count_square, counts[2][rows])
        assert np.array_equal(e.square_counts, square[rows])
        if n % 3:
            continue
        ways = (b[k][rows] for k in ("x", "y", "turn"))
        e = arc_end(*ways, lock.x[rows], lock.y[rows], Axis.SQUARE_X)
        assert np.array_equal(e.last_axis, np.where(on_x[rows], Axis.X, Axis.Y))
        assert np.array_equal(e.count_x, counts[0][rows])
        assert np.array_equal(e.count_y, counts[1][rows])
        assert np.array_equal(e.count_square, counts[3][rows])
        assert np.array_equal(e.square_counts, square_x[rows])
    assert checked > 3_300_000


def test_arc_end_lands_on_the_path_only():
    ex, ey = np.meshgrid(np.arange(-12, 13), np.arange(-12, 13))
    for x in range(-8, 9):
        for y in range(-8, 9):
            if x * x + y * y < 2:
                continue
            for turn in (1, -1):
                e = arc_end(x, y, turn, ex, ey)
                b = np.zeros(1, BLOCK)
                b["kind"], b["turn"], b["x"], b["y"] = Kind.ARC, turn, x, y
                around = int(8 * math.ceil(math.sqrt(x * x + y * y - 1)))
                dx, dy = position(np.repeat(b, around), np.arange(1, around + 1))
                want = set(zip((x + dx).tolist(), (y + dy).tolist(), strict=True))
                assert set(zip(ex[e.landed].tolist(), ey[e.landed].tolist(), strict=True)) == want


@pytest.mark.parametrize("table", LineTable)
def test_a_hundred_thousand_random_blocks(table):
    rng = np.random.default_rng(9)
    b = random_blocks(rng, 110_000, 25, 40)
    moves = run(b, table)
    b, moves = b[moves.steps > 0], type(moves)(*(v[moves.steps > 0] for v in moves))
    assert len(b) > 90_000
    lock = Lockstep(b, table)
    x0, y0 = lock.x.copy(), lock.y.copy()
    left, n = b["count"].copy(), 0
    dx, dy, steps = (np.zeros(len(b), np.int64) for _ in range(3))
    rows = np.arange(len(b))
    while len(rows):
        on_x, *squares = lock.step()
        n += 1
        left -= np.choose(b["axis"][rows], [on_x, ~on_x, *squares])
        done = left == 0
        dx[rows[done]], dy[rows[done]] = (lock.x - x0)[done], (lock.y - y0)[done]
        steps[rows[done]] = n
        if done.any():
            rows, left, x0, y0 = (v[~done] for v in (rows, left, x0, y0))
            for name, value in vars(lock).items():
                setattr(lock, name, value[~done])
    assert np.array_equal(moves.dx, dx)
    assert np.array_equal(moves.dy, dy)
    assert np.array_equal(moves.steps, steps)
    # The trace ends where run says, moves by single steps, and reverses where reversals() says.
    positions, first = trace(b, table)
    at = np.cumsum(np.stack([dx, dy], axis=1), axis=0)
    assert np.array_equal(positions[np.append(first[1:], len(positions) - 1)], at)
    d = np.diff(positions, axis=0)
    assert (np.abs(d).sum(axis=1) == 1).all()
    for axis, got in enumerate(reversals(b, table, last=(1, -1))):
        moved = np.flatnonzero(d[:, axis])
        signs = np.append([1, -1][axis], d[moved, axis])
        owner = np.searchsorted(first, moved[np.diff(signs) != 0], side="right") - 1
        assert np.array_equal(got, np.bincount(owner, minlength=len(b)))


@given(
    kind=st.sampled_from([Kind.LINE, Kind.ARC]),
    x=st.integers(-1_000_000, 1_000_000),
    y=st.integers(-1_000_000, 1_000_000),
    turn=st.sampled_from([1, -1]),
    axis=st.sampled_from(AXES),
    count=st.integers(0, 300),
    table=st.sampled_from(list(LineTable)),
)
@settings(max_examples=150, deadline=None)
def test_any_block(kind, x, y, turn, axis, count, table):
    # A count on the slow axis may need any number of steps: keep it to what a loop can do.
    if kind == Kind.ARC and axis < Axis.SQUARE:
        count %= 30
    b = np.zeros(1, BLOCK)
    b["kind"], b["x"], b["y"], b["axis"], b["count"] = kind, x, y, axis, count
    b["turn"] = turn if kind == Kind.ARC else 0
    moves = run(b, table)
    if moves.steps[0] > 100_000:
        return
    path = loop(b[0], table)
    if path is None:
        assert moves.steps[0] == -1
        return
    assert (moves.dx[0], moves.dy[0], moves.steps[0]) == (*path[-1], len(path) - 1)
    assert np.array_equal(trace(b, table)[0], path)
    if len(path) > 1:
        assert (deviation(b, table)[0][0], deviation(b, table)[1][0]) == extremes(b[0], path)


def test_big_arcs_to_ten_metres():
    """Against exact integers: the place of any step, and run() against arc_end()."""
    rng = np.random.default_rng(10)
    n = 4000
    size = 10.0 ** rng.uniform(1, 7, n)
    angle = rng.uniform(0, 2 * math.pi, n)
    b = np.zeros(n, BLOCK)
    b["kind"], b["turn"] = Kind.ARC, rng.choice([-1, 1], n)
    b["x"], b["y"] = np.rint(size * np.cos(angle)), np.rint(size * np.sin(angle))
    b["x"][:50], b["y"][:50] = 10_000_000, 0
    b["x"][50:100] = b["y"][50:100] = 7_071_067
    b["axis"] = rng.integers(0, len(AXES), n)
    b["count"] = 1 + rng.integers(0, np.maximum(4 * size, 1)).astype(np.int64)
    b["count"][:100] = 1 + np.arange(100) * 250_000
    moves = run(b)
    assert (moves.steps > 0).all()
    ex, ey = b["x"] + moves.dx, b["y"] + moves.dy
    # Same place by step number; one step less is one step back, on the axis that counts.
    assert all(map(np.array_equal, position(b, moves.steps), (moves.dx, moves.dy)))
    bx, by = position(b, moves.steps - 1)
    along_x = bx != moves.dx
    assert (np.abs(bx - moves.dx) + np.abs(by - moves.dy) == 1).all()
    single = b["axis"] < Axis.SQUARE
    assert np.array_equal(along_x[single], b["axis"][single] == Axis.X)
    # On the staircase, in Python integers: F(u, v-1) < 0 <= F(u+1, v).
    for i in range(0, n, 4):
        x, y, px, py = (int(v[i]) for v in (b["x"], b["y"], ex, ey))
        r2 = x * x + y * y
        py *= int(b["turn"][i])
        if px == 0 or py == 0:
            continue
        u, v = (abs(px), abs(py)) if px * py > 0 else (abs(py), abs(px))
        assert u * u + (v - 1) ** 2 < r2 <= (u + 1) ** 2 + v * v
    # The J that arc_end() finds is J, and the step numbers agree, up to whole turns.
    ways = b["x"], b["y"], b["turn"]
    e = arc_end(*ways, ex, ey)
    assert e.landed.all()
    assert np.array_equal(e.last_axis == Axis.X, along_x)
    around = arc_end(*ways, b["x"], b["y"])
    ties = arc_end(*ways, ex, ey, Axis.SQUARE_X), arc_end(*ways, b["x"], b["y"], Axis.SQUARE_X)
    turns = (moves.steps - e.steps) // around.steps
    assert np.array_equal(moves.steps, e.steps + turns * around.steps)
    for axis in AXES:
        rows = b["axis"] == axis
        name = ("count_x", "count_y", "count_square", "count_square")[axis]
        here, turn = ties if axis == Axis.SQUARE_X else (e, around)
        got = getattr(here, name) + turns * getattr(turn, name)
        assert np.array_equal(got[rows], b["count"][rows])
    assert e.square_counts[b["axis"] == Axis.SQUARE].all()
    assert ties[0].square_counts[b["axis"] == Axis.SQUARE_X].all()


def test_long_arcs_and_lines_against_the_loop():
    rng = np.random.default_rng(11)
    b = np.zeros(12, BLOCK)
    b["kind"] = np.arange(12) % 2
    b["turn"] = np.where(b["kind"] == Kind.ARC, rng.choice([-1, 1], 12), 0)
    b["x"], b["y"] = rng.integers(-(10**7), 10**7, (2, 12))
    b["axis"], b["count"] = Axis.SQUARE, 10_000
    low, high = deviation(b)
    positions, first = trace(b)
    for i, block in enumerate(b):
        path = loop(block, LineTable.MIRROR)
        got = positions[first[i] : first[i] + len(path)]
        assert np.array_equal(got - got[0], path)
        assert (low[i], high[i]) == extremes(block, path)


@pytest.mark.parametrize("table", LineTable)
@pytest.mark.parametrize("count", [5, 1499, 1500, 70_000])
def test_runs_of_any_length_along_axes_diagonals_and_quadrants(table, count):
    """One by one and together: every direction, as long and as short runs are computed."""
    b = np.zeros(16, BLOCK)
    ways = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
    b["x"], b["y"] = 20_000 * np.array(ways + ways).T
    b["kind"][8:], b["turn"][8:] = Kind.ARC, [1, -1] * 4
    b["axis"], b["count"] = Axis.SQUARE, count
    for some in (b, *(b[i : i + 1] for i in range(16))):
        steps = run(some, table).steps
        positions, first = trace(some, table)
        of = np.repeat(np.arange(len(some)), steps)
        nth = np.arange(len(of)) - np.repeat(first, steps) + 1
        want = np.stack(position(some[of], nth, table), axis=1)
        assert np.array_equal(positions[1:] - positions[first[of]], want)


@pytest.mark.parametrize("table", LineTable)
def test_short_pieces_of_the_longest_lines_and_arcs_side_by_side(table):
    """Thousands of runs share a floor: lines whose ratio has 2^31 below are the closest to it."""
    rng = np.random.default_rng(12)
    n = 3000
    b = random_blocks(rng, n, 1000, 1)
    b["kind"] = rng.choice([Kind.LINE, Kind.ARC], n, p=[0.7, 0.3])
    arc = b["kind"] == Kind.ARC
    b["turn"] = np.where(arc, rng.choice([-1, 1], n), 0)
    long = ~arc & (rng.random(n) < 0.8)
    near = 2**30 - rng.integers(0, 50, (2, n))
    b["x"][long], b["y"][long] = (near * rng.choice([-1, 1], (2, n)))[:, long]
    b["x"][long & (rng.random(n) < 0.3)] = 1
    b["axis"], b["count"] = Axis.SQUARE, rng.integers(1, 700, n)
    b = b[(arc & (b["x"] ** 2 + b["y"] ** 2 >= 2)) | (~arc & ((b["x"] != 0) | (b["y"] != 0)))]
    for some in (b, b[b["kind"] == Kind.LINE], b[b["kind"] == Kind.ARC]):
        steps = run(some, table).steps
        assert (steps > 0).all()
        positions, first = trace(some, table)
        of = np.repeat(np.arange(len(some)), steps)
        nth = np.arange(len(of)) - np.repeat(first, steps) + 1
        want = np.stack(position(some[of], nth, table), axis=1)
        assert np.array_equal(positions[1:] - positions[first[of]], want)


def test_deviation_of_whole_circles_to_a_metre():
    """The few rows that the search looks at give the extremes of all steps."""
    for x, y in ((30_000, 0), (12_345, 6_789), (707, 707), (99_999, -5), (400_001, 3)):
        e = arc_end(x, y, 1, x, y)
        b = np.zeros(1, BLOCK)
        b["kind"], b["turn"], b["x"], b["y"] = Kind.ARC, 1, x, y
        on_x = int(e.last_axis) == Axis.X
        b["axis"], b["count"] = e.last_axis, e.count_x if on_x else e.count_y
        positions, _ = trace(b)
        f = (positions[:, 0] + x) ** 2 + (positions[:, 1] + y) ** 2 - (x * x + y * y)
        r2 = float(x * x + y * y)
        want = [float(v) / (math.sqrt(r2 + float(v)) + math.sqrt(r2)) for v in (f.min(), f.max())]
        assert [float(d[0]) for d in deviation(b)] == want


@given(st.lists(st.sampled_from(range(8)), min_size=1, max_size=4), st.data())
def test_a_part_of_the_places_is_that_part(which, data):
    choice = np.zeros(8, BLOCK)
    choice["x"] = [40, -7, 0, 30, -20, 9, 9, 100]
    choice["y"] = [3, 12, -25, 0, 15, -40, 9, -1]
    choice["turn"] = [0, 0, 0, 1, -1, 1, 0, 0]
    choice["kind"] = np.where(choice["turn"] != 0, Kind.ARC, Kind.LINE)
    choice["axis"] = [Axis.X, Axis.Y, Axis.Y, Axis.X, Axis.Y, Axis.X, Axis.X, Axis.X]
    choice["count"] = [40, 12, 25, 70, 33, 90, 9, 100]
    stepping = stepping_of("3b", "mirror")
    blocks = choice[which]
    moves = stepping.run(blocks)
    x, y = np.cumsum(moves.dx) - moves.dx + 5.0, np.cumsum(moves.dy) - moves.dy - 3.0
    every = np.array(stepping.places(blocks, moves, x, y))
    first = data.draw(st.integers(0, every.shape[1]))
    last = data.draw(st.integers(first, every.shape[1]))
    part = np.array(stepping.places(blocks, moves, x, y, (first, last)))
    assert np.array_equal(part, every[:, first:last])

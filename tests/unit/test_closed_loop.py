"""The closed loop of the ZD-065's data processing: ends as stepped near the exact vertices."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.controllers.pointwise import run
from wedmcam.controllers.zd065.loop import EXACT, follow
from wedmcam.ir.program import Kind

MOST_UM = 999_999


def chain(rows):
    """Return an exact path of (kind, heading, size, turn, sweep), each from where one ended."""
    path = np.zeros(len(rows), EXACT)
    x = y = 0.0
    for k, (kind, heading, size, turn, sweep) in enumerate(rows):
        a = np.radians(heading)
        path["kind"][k], path["source"][k] = kind, k
        if kind == Kind.ARC:
            cx, cy = x - size * np.cos(a), y - size * np.sin(a)
            b = a + turn * np.radians(sweep)
            x, y = cx + size * np.cos(b), cy + size * np.sin(b)
            for name, value in (("turn", turn), ("radius", size)):
                path[name][k] = value
            path["sweep"][k], path["start"][k] = sweep, heading
        elif kind <= Kind.MOVE:
            x, y = x + size * np.cos(a), y + size * np.sin(a)
        path["x"][k], path["y"][k] = x, y
    return path


def check(path):
    done = follow(path)
    moves = run(done.blocks)
    ends = np.cumsum(np.column_stack([moves.dx, moves.dy]), axis=0)
    assert np.array_equal(ends, done.ends)
    assert done.miss.max() <= 1.0
    assert (moves.steps >= 0).all()
    assert done.blocks["count"].max() <= MOST_UM
    return done


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**9), st.sampled_from([30, 3_000, 200_000, 10_000_000]))
def test_every_end_is_within_a_um(seed, largest):
    random = np.random.default_rng(seed)
    rows = []
    for _ in range(40):
        size = float(np.exp(random.uniform(0.0, np.log(largest))))
        if random.random() < 0.4:
            rows.append((Kind.LINE, random.uniform(0, 360), min(size, 900_000.0), 0, 0.0))
        else:
            most = min(359.9, np.degrees(900_000 / size))
            rows.append((Kind.ARC, random.uniform(0, 360), size, random.choice([-1, 1]),
                         random.uniform(0.01, most)))  # fmt: skip
    check(chain(rows))


@pytest.mark.parametrize("radius", [2, 5, 1_000, 176_776, 176_777, 1_000_000])
@pytest.mark.parametrize("heading", [0.0, 17.3, 45.0, 200.1])
def test_full_circles_close(radius, heading):
    path = chain([(Kind.ARC, heading, radius, 1, 360.0), (Kind.ARC, heading, radius, -1, 360.0)])
    done = check(path)
    assert not done.ends[-1].any()
    assert len(done.blocks) == (2 if radius < 176_770 else len(done.blocks))
    assert not len(done.dropped)


def test_controls_stand_where_the_machine_stands():
    path = chain([(Kind.LINE, 10, 500, 0, 0), (Kind.PAUSE, 0, 0, 0, 0), (Kind.MOVE, 50, 70, 0, 0)])
    done = check(path)
    assert done.blocks["kind"].tolist() == [Kind.LINE, Kind.PAUSE, Kind.MOVE]
    assert done.ends[1].tolist() == done.ends[0].tolist()


def test_what_makes_no_step_is_dropped():
    done = check(chain([(Kind.LINE, 0, 100, 0, 0), (Kind.LINE, 0, 0.3, 0, 0)]))
    assert (done.dropped.tolist(), len(done.blocks)) == ([1], 1)

"""The two timers: closed forms against the loop, and how long vectors may be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.controllers import stepping_of
from wedmcam.controllers.eindhoven.arithmetic import poscal
from wedmcam.controllers.eindhoven.vectors import Vectors
from wedmcam.ir.program import BLOCK, Axis, Kind
from wedmcam.machines import builtin

KINDS = [Vectors(d, p, f) for d in ("root", "sines") for p in ("um", "steps") for f in (0, 1)]


def vectors(x, y, speed, kind=Kind.LINE):
    x, y, speed = np.broadcast_arrays(x, y, speed)
    b = np.zeros(x.size, BLOCK)
    b["kind"], b["x"], b["y"], b["count"] = kind, x.ravel(), y.ravel(), speed.ravel()
    return b


def way(stepping, block):
    return np.array([(s.x, s.y) for s in stepping.steps(block)]).reshape(-1, 2)


ways = st.tuples(st.integers(-90, 90), st.integers(-90, 90)).filter(any)


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.tuples(ways, st.integers(1, 127)), min_size=1, max_size=4), st.sampled_from(KINDS)
)
def test_closed_forms_are_the_loop(rows, stepping):
    b = vectors([r[0][0] for r in rows], [r[0][1] for r in rows], [r[1] for r in rows])
    at, first = stepping.trace(b)
    moves = stepping.run(b)
    low, high = stepping.deviation(b)
    for k, block in enumerate(b):
        loop = way(stepping, block)
        n = int(moves.steps[k])
        assert len(loop) == n
        assert (at[first[k] + 1 : first[k] + 1 + n] - at[first[k]] == loop).all()
        ramp = np.arange(n + 1)
        x, y = stepping.position(np.repeat(b[k : k + 1], n + 1), ramp)
        assert (np.column_stack([x, y])[1:] == loop).all()
        assert (x[0], y[0]) == (0, 0)
        assert tuple(loop[-1]) == (block["x"], block["y"])
        beside = (block["x"] * loop[:, 1] - block["y"] * loop[:, 0]) / np.hypot(*block[["x", "y"]])
        assert high[k] == pytest.approx(max(beside.max(), 0), abs=1e-9)
        assert low[k] == pytest.approx(min(beside.min(), 0), abs=1e-9)
        assert (np.diff(loop, axis=0) * np.sign(loop[-1]) >= 0).all()


@settings(max_examples=60, deadline=None)
@given(ways, st.integers(1, 127), st.data())
def test_windows_are_parts_of_all_places(xy, speed, data):
    stepping = Vectors()
    b = vectors([xy[0], 5, xy[1]], [xy[1], 3, -xy[0]], speed)
    moves = stepping.run(b)
    x, y = np.array([10.0, 20.0, 30.0]), np.array([-1.0, -2.0, -3.0])
    every = np.column_stack(stepping.places(b, moves, x, y))
    low = data.draw(st.integers(0, len(every)))
    high = data.draw(st.integers(low, len(every)))
    assert (np.column_stack(stepping.places(b, moves, x, y, (low, high))) == every[low:high]).all()


@settings(max_examples=100, deadline=None)
@given(ways, st.integers(1, 127), st.sampled_from(KINDS))
def test_mirrors_and_an_exchange_step_the_image(xy, speed, stepping):
    (x, y) = xy
    loop = way(stepping, vectors(x, y, speed)[0])
    assert (way(stepping, vectors(-x, y, speed)[0]) == loop * [-1, 1]).all()
    assert (way(stepping, vectors(x, -y, speed)[0]) == loop * [1, -1]).all()
    other = Vectors(stepping.direction, stepping.positions, not stepping.y_first)
    assert (way(other, vectors(y, x, speed)[0]) == loop[:, ::-1]).all()


def test_an_axis_stops_at_its_target_and_the_other_goes_on():
    """At v = 1 every oblique vector starts at 45 degrees; a dropped component waits."""
    assert way(Vectors(), vectors(2, 5, 1)[0]).tolist() == [
        [1, 0], [1, 1], [2, 1], [2, 2], [2, 3], [2, 4], [2, 5],
    ]  # fmt: skip
    lost = way(Vectors(positions="steps"), vectors(65_535, 255, 127)[0])
    assert lost[65_534].tolist() == [65_535, 0]  # REDUC dropped y: it is run behind x


def test_where_both_are_due_x_steps_first():
    assert way(Vectors(), vectors(2, 2, 127)[0]).tolist() == [[1, 0], [1, 1], [2, 1], [2, 2]]
    assert way(Vectors(y_first=True), vectors(1, 1, 127)[0]).tolist() == [[0, 1], [1, 1]]


def test_what_has_no_end_is_told():
    s = Vectors()
    b = vectors([0, 5, 5, 5], [0, 0, 0, 0], [9, 0, 9, 9])
    b["kind"][2], b["kind"][3] = Kind.ARC, Kind.PAUSE
    assert s.run(b).steps.tolist() == [-1, -1, -1, 0]
    for k in range(3):
        with pytest.raises(ValueError, match="never ends"):
            list(s.steps(b[k]))
    assert list(s.steps(b[3])) == []
    assert not s.arc_end([5], [0], [1], [0], [5]).landed.any()


def test_steps_tell_the_axis_and_how_far_beside():
    first, *_, last = Vectors().steps(vectors(3, -1, 127)[0])
    assert (first.axis, first.sign, first.f, last.f) == (Axis.X, 1, -1, 0)


def plane(most):
    g = np.arange(-most, most + 1)
    x, y = (v.ravel() for v in np.meshgrid(g, g))
    some = (x != 0) | (y != 0)
    return x[some], y[some]


@pytest.mark.parametrize(
    ("speed", "by_direction", "first_over"),
    [(127, 255, 270.1), (64, 129, 140.1), (32, 65, 73.8), (10, 21, 27.2), (1, 3, 10.8)],
)
def test_the_longest_vector_for_2_um_sideways(speed, by_direction, first_over):
    """um: by the worst direction, and as the controller runs them, since an axis stops."""
    s = Vectors()
    x, y = plane(150)
    b = vectors(x, y, speed)
    u, w = (v.ravel() for v in np.meshgrid(np.arange(256), np.arange(256)))
    fits = (u * u + w * w <= 65_535) & (u + w > 0)
    u, w = u[fits], w[fits]
    got = poscal(u, w, np.full(len(u), speed))
    worst = np.abs(np.arctan2(got.y, got.x) - np.arctan2(w, u)).max()
    assert round(2.0 / np.sin(worst)) == by_direction
    length, beside = 2.0 * np.hypot(x, y), 2.0 * s.sideways(b)
    over = length[beside > 2.0 + 1e-9].min()
    assert over == pytest.approx(first_over, abs=0.06)
    assert over > by_direction


def test_sideways_is_where_the_first_axis_arrives():
    """Without the stair: the corner of the path that even speeds would run."""
    s = Vectors()
    x, y = plane(25)
    b = vectors(x, y, 10)
    v, beside = s.speeds(b), s.sideways(b)
    for k in range(0, len(b), 37):
        a, c, p, q = abs(int(x[k])), abs(int(y[k])), int(v.x[k]), int(v.y[k])
        time = min(*(d / w for d, w in ((a, p), (c, q)) if w), np.inf)
        at = min(p * time, a), min(q * time, c)
        assert beside[k] == pytest.approx(abs(a * at[1] - c * at[0]) / np.hypot(a, c), abs=1e-9)
    low, high = s.deviation(b)
    stair = np.maximum(-low, high) - beside
    assert stair.max() <= 1.0 + 1e-9  # steps lie a step beside that at most


def test_times_are_those_of_the_timers():
    s = Vectors()
    assert s.seconds(vectors(625, 0, 127))[0] == pytest.approx(1250 / (127 * 0.2625))
    assert s.seconds(vectors([3], [4], [10]))[0] == pytest.approx(4 * 2 / (8 * 0.2625))
    assert s.seconds(vectors(1, 0, 1, Kind.PAUSE))[0] == 0


def test_profiles_name_their_arithmetic():
    assert builtin("dem15").stepping == Vectors()
    assert builtin("dem15-steps").stepping == Vectors(positions="steps")
    assert builtin("dem15-sines").stepping == Vectors("sines")
    assert stepping_of("dem15", "root-um-exchanged").y_first


def test_alike_lines_are_known():
    x, y = np.array([3, 0, 3]), np.array([4, 4, 0])
    assert Vectors().same_lines(Vectors("sines"), x, y).tolist() == [False, True, True]
    assert Vectors().same_lines(Vectors(), x, y).all()
    assert not Vectors().same_lines(stepping_of("3b", "mirror"), x[:1], y[:1]).any()
    assert Vectors(speed=9).line_count(x, y)[1].tolist() == [9, 9, 9]

"""Stops and overcuts of a step or two: proven, or refused where the grid leaves none of them."""

import numpy as np
import pytest

from wedmcam import api
from wedmcam.judge.ends import meeting

PHASES = [(x, y) for x in (-0.4, 0.0, 0.4) for y in (-0.4, 0.0, 0.4)]


def diamond(x, y, more):
    """A diamond whose start lies (x, y) um beside a step, cut on the line from (12, 0)."""
    text = (
        f"contour d {{ from ({10 + x / 1e3}, {y / 1e3}) line to (0, 10) line to (-10, 0) "
        f"line to (0, -10) close }}\n"
        f"cut d on start (12, 0) enter ({10 + x / 1e3}, {y / 1e3}) {more}\n"
    )
    return api.compile(text.encode(), name="d.wed", profile="iso-um")


@pytest.mark.parametrize("name", ["stop", "overcut"])
def test_one_of_a_step_is_proven_or_refused(name):
    said = set()
    for x, y in PHASES:
        made = diamond(x, y, f"{name} 0.001")
        said.add("proven" if made.ok else made.findings[-1].code)
        assert made.status in (0, 1)
    assert said == {"proven", f"{name}-too-short"}


@pytest.mark.parametrize("name", ["stop", "overcut"])
def test_one_of_two_steps_is_always_proven(name):
    for x, y in PHASES:
        made = diamond(x, y, f"{name} 0.002")
        assert made.ok
        assert made.verdict.closure_um == 0


def test_a_stop_on_the_thread_point_is_refused():
    """Circles of a few um, threaded at their centre: the pause would end the cut."""
    said = set()
    for radius in np.arange(0.1242, 0.1270, 0.0001):
        text = f"contour c {{ circle center (0, 0) radius {radius:.4f} }}\n"
        text += "cut c inside offset 0.1234 start (0, 0) stop 0.001\n"
        made = api.compile(text.encode(), name="c.wed")
        said.add("proven" if made.ok else made.findings[-1].code)
        assert made.status in (0, 1), [d.message for d in made.findings]
    assert {"proven", "stop-too-short"} <= said


def test_where_a_contour_meets_its_start():
    """A place that is passed twice counts before one that is nearer; another contour does not."""
    at = np.array([-50.0, 0.3, 500.0, 999.2, 1000.4, 1050.0])
    closed = np.array([(0, 50), (0, 0), (300, 0), (0, -1), (0, 0), (0, 50)])
    assert meeting(closed, at, 0.0, 1000.0, 2.0) == (1, 4)
    at[3], at[4] = 999.9, 1001.5
    assert meeting(closed, at, 0.0, 1000.0, 2.0) == (1, 4)
    open_ = closed.copy()
    open_[4] = (1, 0)
    assert meeting(open_, at, 0.0, 1000.0, 2.0) == (1, 3)
    at[4] = 1003.0  # too far from the end of the path to be where it closes
    assert meeting(closed, at, 0.0, 1000.0, 2.0) == (1, 3)


def test_a_tiny_path_is_not_closed_by_its_own_start():
    at = np.array([-50.0, 0.2, 3.0, 53.0])
    places = np.array([(0, 50), (0, 0), (1, 0), (0, 50)])
    assert meeting(places, at, 0.0, 3.0, 2.0) == (1, 2)

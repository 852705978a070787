"""An outline that runs on over its start is the outline, and then its first part again."""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon

from wedmcam.judge.walk import walk
from wedmcam.machines import builtin
from wedmcam.targets import Entries, g41

UM = builtin("iso-um")
#: A slanting line in one block and in two takes some steps in another order, and a corner that is
#: rounded takes a few more or less; um.
STEPS = 10


@st.composite
def outlines(draw):
    """Return corners, um, and for each side how far an arc bows to the left, in parts of it."""
    n = draw(st.integers(3, 9))
    turn = np.sort(draw(st.lists(st.integers(0, 359), min_size=n, max_size=n, unique=True)))
    radius = np.array(draw(st.lists(st.integers(4000, 15000), min_size=n, max_size=n)))
    places = np.rint(
        np.column_stack([np.cos(np.radians(turn)), np.sin(np.radians(turn))]) * radius[:, None]
    )
    bows = draw(st.lists(st.sampled_from([0, 0, 0, 0.2, -0.2]), min_size=n, max_size=n))
    if draw(st.booleans()):
        places, bows = places[::-1], bows[::-1]
    assume(Polygon(places).is_valid)
    assume(np.hypot(*(places - np.roll(places, 1, axis=0)).T).min() > 2000)
    return places, bows


def motion(a, b, bow):
    """Return a line of G-code from a to b, incremental."""
    dx, dy = (int(v) for v in b - a)
    if not bow:
        return f"G01 X{dx} Y{dy}"
    # The centre on the normal in the middle, (1 / 4 - bow^2) / (2 bow) chords to the right of it.
    far = (0.25 - bow * bow) / (2 * bow)
    i, j = dx / 2 + far * dy, dy / 2 - far * dx
    return f"G0{2 if bow > 0 else 3} X{dx} Y{dy} I{i / 1000:.6f} J{j / 1000:.6f}"


def program(places, bows, side, overlap):
    """Return a program that starts in the middle of the first side, a line, and runs past it.

    ``overlap``: sides, and the part of the next one, behind the start.
    """
    n = len(places)
    start = np.rint((places[0] + places[1]) / 2)
    x, y = (places[1] - places[0]) / np.hypot(*(places[1] - places[0]))
    thread = np.rint(start + (600 * np.array([-y, x]) if side == 41 else 600 * np.array([y, -x])))
    lines = ["G91 G21", f"G{side} D1 G01 X{int((start - thread)[0])} Y{int((start - thread)[1])}"]
    here = start
    ends = [(places[(k + 1) % n], bows[k % n]) for k in range(n + 1 + overlap)]
    ends[0] = places[1], 0
    # The last one ends in the middle of a side, the first one again with no overlap.
    a, (b, bow) = ends[-2][0], ends[-1]
    ends[-1] = (start if overlap == 0 else np.rint((a + b) / 2), 0)
    assume(not bow)
    for there, bow in ends:
        lines.append(motion(here, there, bow))
        here = there
    lines += ["G40", "M02"]
    return "\n".join(lines)


def read(text, offset):
    made, found = g41.decode(text.encode(), UM, "x.nc", Entries(d=((1, offset),)).offset_of())
    return made, [d for d in found if d.severity.name == "ERROR"]


def places_of(made):
    way = walk(made, UM.own_stepping)
    x, y, count = way.points(np.flatnonzero(way.cutting & (way.steps > 0)))
    return np.column_stack([x, y]), count


@settings(max_examples=30)
@given(outlines(), st.sampled_from([41, 42]), st.integers(0, 12), st.integers(50, 300))
def test_the_path_of_an_overlap_is_the_path_and_its_first_part_again(shape, side, more, offset):
    places, bows = shape
    bows = [0, *bows[1:]]
    more = more % (len(places) + 1)
    once, wrong = read(program(places, bows, side, 0), offset)
    assume(not wrong)
    again, wrong = read(program(places, bows, side, more), offset)
    assert not wrong, wrong
    first, count = places_of(once)
    over = places_of(again)[0]
    track, lead = LineString(first), int(count[0])
    off = [track.distance(Point(p)) for p in over[:: max(len(over) // 400, 1)]]
    assert max(off) <= 3.0
    # Once round, step by step, and then along the first part.
    whole = len(first) - lead
    same = min(len(over), len(first)) - lead
    if not any(bows):
        assert np.abs(over[lead : lead + same] - first[lead : lead + same]).max() <= STEPS
        rest = over[lead + whole :][:whole]
        assert np.abs(rest - first[lead : lead + len(rest)]).max(initial=0) <= STEPS
    length = LineString(over[lead:]).length
    assert length >= LineString(first[lead:]).length - 10
    assert (length <= LineString(first[lead:]).length + 10) == (more == 0)

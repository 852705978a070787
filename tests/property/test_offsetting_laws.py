"""The path that a controller makes of an outline is the edge of what its wire sweeps.

The oracle is shapely: outlines as chords, grown or shrunk by the offset. A path that the model
accepts is that edge, all of it and nothing else.
"""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon

from wedmcam.controllers.offsetting.clearance import comes_near, runs_back
from wedmcam.controllers.offsetting.path import Lost, path_beside
from wedmcam.controllers.offsetting.segment import arc, line

#: Height of the chords that stand for arcs, um.
SAG = 0.01
#: A wire may come so much nearer to a block than the offset, um (`clearance.NEARER_UM`).
NEARER = 1.5


def chords(s):
    """Return places along a segment, without its end."""
    n = 1
    if s.turn:
        n = max(2, int(np.ceil(s.sweep / (2 * np.arccos(1 - SAG / max(s.radius, 1.0))))))
    return [s.point(t) for t in np.linspace(0.0, s.length, n, endpoint=False)]


@st.composite
def outlines(draw):
    """Return a closed outline without crossings, from the middle of its first side, a line."""
    n = draw(st.integers(3, 9))
    turn = np.sort(draw(st.lists(st.integers(0, 359), min_size=n, max_size=n, unique=True)))
    radius = np.array(draw(st.lists(st.integers(600, 9000), min_size=n, max_size=n)))
    places = np.column_stack([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    places = np.rint(places * radius[:, None])
    if draw(st.booleans()):
        places = places[::-1]
    bows = draw(st.lists(st.sampled_from([0, 0, 0.2, -0.2, 0.5, -0.45]), min_size=n, max_size=n))
    corners = [tuple(map(float, p)) for p in places]
    assume(min(np.hypot(*(places - np.roll(places, 1, axis=0)).T)) > 20)
    middle = tuple(0.5 * (places[0] + places[1]))
    outline = [line(middle, corners[1])]
    for k in range(1, n):
        outline.append(side(corners[k], corners[(k + 1) % n], bows[k]))
    outline.append(line(corners[0], middle))
    assume(Polygon([p for s in outline for p in chords(s)]).is_valid)
    return outline


def side(a, b, bow):
    """Return a line, or an arc that bows by so many chords to the left."""
    if not bow:
        return line(a, b)
    (ax, ay), (bx, by) = a, b
    far = (0.25 - bow * bow) / (2 * bow)
    dx, dy = bx - ax, by - ay
    return arc(a, b, (ax + dx / 2 + far * dy, ay + dy / 2 - far * dx), -1 if bow > 0 else 1)


def made(outline, shift):
    """Return the elements of the path, or what is lost."""
    shifts = [shift] * len(outline)
    back = runs_back(outline)
    if back is not None:
        return back
    result = path_beside(outline, shifts, shift)
    if isinstance(result, Lost):
        return result
    return comes_near(result[0], outline, shifts, shift) or result[0]


def swept(outline, shift):
    """Return the edge of what the wire sweeps beside a closed outline, on its side."""
    shape = Polygon([p for s in outline for p in chords(s)])
    inside = (shift > 0) == shape.exterior.is_ccw
    return shape.buffer(-abs(shift) if inside else abs(shift), quad_segs=200)


@settings(max_examples=120)
@given(outlines(), st.sampled_from([1, -1]), st.integers(20, 1500))
def test_the_path_is_the_edge_of_what_the_wire_sweeps(outline, side, offset):
    result = made(outline, float(side * offset))
    if isinstance(result, Lost):
        is_lost(result, outline, offset)
        return
    track = LineString([p for s in outline for p in chords(s)] + [outline[-1].end])
    places = [p for e in result for p in chords(e.segment)]
    off = np.array([track.distance(Point(p)) for p in places])
    assert off.max() <= offset + 2 * SAG
    assert off.min() >= offset - NEARER - 2 * SAG
    # Between these places too, a um at a time.
    path = LineString([*places, places[0]]).segmentize(1.0)
    off = np.array([track.distance(Point(p)) for p in path.coords])
    assert off.max() <= offset + NEARER + 0.2
    assert off.min() >= offset - NEARER - 0.2
    # One piece, without a hole: a path beside it leaves nothing out. Its corners are not compared:
    # where two branches meet at a shallow angle they move by more than the wire is off.
    edge = swept(outline, side * offset)
    assert edge.geom_type == "Polygon"
    assert len(edge.interiors) == 0


def is_lost(lost, outline, offset):
    """The wire is where it is said to be, as near as is said to the block that is named."""
    block = outline[lost.block]
    if lost.kind == "radius":
        assert block.radius < offset
    if lost.kind == "near":
        ends = [LineString([*chords(s), s.end]) for s in (block, outline[lost.other])]
        assert lost.gap_um < offset - NEARER
        assert min(e.distance(Point(lost.at)) for e in ends) <= lost.gap_um / 2 + 2 * SAG

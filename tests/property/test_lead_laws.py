"""Leads that nobody stated keep clear of every finished wall, or are refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import oracle
import parts
import wedmcam

SAMPLES = Path(__file__).parents[2] / "samples"

#: A thread point is at least this share of its lead from every path.
CLEAR = 0.25
#: Whole microns of the thread point.
GRID_UM = 1.0


def crowding(made):
    """Return for each closed cut the length of its lead, and how near its hole is to any path."""
    cuts = made.plan.cuts
    for cut in (c for c in cuts if c.path.closed):
        at = np.array([cut.thread], float)
        v = cut.path.vertices[0]
        length = float(np.hypot(v["x"] - at[0, 0], v["y"] - at[0, 1]))
        yield cut, length, min(float(oracle.distance_to_contour(at, o.path)[0]) for o in cuts)


def assert_clear(made, name):
    for cut, length, room in crowding(made):
        assert room >= CLEAR * length - GRID_UM, (name, cut.number, length, room)


@pytest.mark.parametrize("file", sorted(SAMPLES.glob("*.dxf")), ids=lambda f: f.name)
def test_samples(file):
    if file.name == "damaged.dxf":
        pytest.skip("it has no units and is not compiled")
    made = wedmcam.compile(file, offset=0.1)
    assert_clear(made, file.name)


@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 100_000),
    st.sampled_from(["part", "die"]),
    st.sampled_from([0.2, 1.0, 5.0]),
)
def test_leads_of_random_parts(seed, side, lead):
    drawing = parts.dxf_bytes(parts.random_part(seed))
    made = wedmcam.compile(drawing, offset=0.1, side=side, lead=lead)
    assert made.ok, [d.message for d in made.findings if d.severity == 2]
    assert_clear(made, seed)


@st.composite
def corners(draw):
    """A polygon that is a star about (0, 0), the index of a corner, and where the wire runs."""
    n = draw(st.integers(3, 9))
    share = [draw(st.floats(0.3, 1.0)) for _ in range(n)]
    turns = np.cumsum(share) / sum(share) * 2 * np.pi
    radius = [draw(st.integers(3, 30)) for _ in range(n)]
    points = [
        (round(float(r * np.cos(a)), 3), round(float(r * np.sin(a)), 3))
        for r, a in zip(radius, turns.tolist(), strict=True)
    ]
    side = draw(st.sampled_from(["inside", "outside", "on"]))
    if not parts.is_simple(parts.contour_of_bulges(np.array(points) * 1000, np.zeros(n))):
        points, n = [(0, 0), (20, 0), (20, 5)], 3
    return points, draw(st.integers(0, n - 1)), side


@settings(max_examples=150, deadline=None)
@given(corners(), st.sampled_from([0.3, 1, 4]))
def test_enter_at_a_corner(case, lead):
    points, k, side = case
    x, y = points[k]
    text = f"contour star {{ from {points[0]} "
    text += " ".join(f"line to {p}" for p in points[1:])
    offset = "" if side == "on" else "offset 0.1 "
    text += f" close }}\ncut star {side} {offset}enter ({x}, {y}) lead {lead}\n"
    made = wedmcam.compile(text.encode(), name="part.wed")
    codes = {d.code for d in made.findings if d.severity == 2}
    assert codes <= {"lead-along-wall", "interference"}, (text, codes)
    if made.ok:
        assert_clear(made, text)
        # The path is entered where that was asked for.
        v = made.plan.cuts[0].path.vertices[0]
        ends = made.plan.cuts[0].path.vertices
        near = np.hypot(ends["x"] - 1000 * x, ends["y"] - 1000 * y).min()
        assert np.hypot(v["x"] - 1000 * x, v["y"] - 1000 * y) <= near + GRID_UM

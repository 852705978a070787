"""An arc of a program is drawn where the controller steps it, whatever its angle: SVG, DXF, box."""

from __future__ import annotations

import io
import math
import re

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from wedmcam import api


def sampled(path: str, spacing: float) -> np.ndarray:
    """Return points of an SVG path (M, L, A, absolute) as the SVG standard draws it (F.6.5)."""
    words = re.findall(r"[MLA]|-?[\d.]+", path)
    out, here, i = [], (0.0, 0.0), 0
    while i < len(words):
        command, count = words[i], {"M": 2, "L": 2, "A": 7}[words[i]]
        a = [float(w) for w in words[i + 1 : i + 1 + count]]
        i += 1 + count
        x, y = a[-2:]
        if command == "A" and (x, y) != here:
            u, v = (here[0] - x) / 2, (here[1] - y) / 2
            r = max(a[0], math.hypot(u, v))
            k = math.sqrt(max(0.0, r * r / (u * u + v * v) - 1)) * (1 if a[3] != a[4] else -1)
            cx, cy = k * v + (here[0] + x) / 2, -k * u + (here[1] + y) / 2
            first = math.atan2(here[1] - cy, here[0] - cx)
            sweep = (math.atan2(y - cy, x - cx) - first) % math.tau - (0 if a[4] else math.tau)
            t = first + sweep * np.linspace(0, 1, 2 + int(abs(sweep) * r / spacing))
            out.append(np.column_stack([cx + r * np.cos(t), cy + r * np.sin(t)]))
        else:
            out.append(np.array([[x, y]] if command == "M" else [here, (x, y)]))
        here = (x, y)
    return np.concatenate(out)


def off(some: np.ndarray, line: np.ndarray) -> float:
    """Return how far the farthest of at most 300 of ``some`` lies from the points of ``line``."""
    tree = shapely.STRtree(shapely.points(line))
    few = shapely.points(some[:: max(1, len(some) // 300)])
    return float(tree.query_nearest(few, return_distance=True, all_matches=False)[1].max())


def drawn(data: bytes) -> np.ndarray:
    """Return points of the arcs of a DXF, mm."""
    out = []
    for e in ezdxf.read(io.StringIO(data.decode("cp1252"))).modelspace():
        if e.dxftype() not in ("ARC", "CIRCLE"):
            continue
        a, span = 0.0, 360.0
        if e.dxftype() == "ARC":
            a, span = e.dxf.start_angle, (e.dxf.end_angle - e.dxf.start_angle) % 360
        t = np.radians(a + span * np.linspace(0, 1, 2000))
        circle = np.column_stack([np.cos(t), np.sin(t)])
        out.append(np.array([e.dxf.center.x, e.dxf.center.y]) + e.dxf.radius * circle)
    return np.concatenate(out)


def program(x: int, y: int, turn: int, axis: str, count: int) -> bytes:
    """Return an arc in 3B; its quadrant is the one that it enters."""
    a = math.atan2(y, x) + turn * 1e-9
    quadrant = int(a % math.tau // (math.pi / 2)) + 1
    word = "NR" if turn > 0 else "SR"
    return f"B{abs(x)}B{abs(y)}B{count}G{axis}{word}{quadrant}\nDD\n".encode()


def counted(x: int, y: int, turn: int, axis: str, degrees: float) -> int:
    """Return the J after which an arc has turned by an angle, found by stepping."""
    radius = math.hypot(x, y)
    long, machine, _ = api.read_program(program(x, y, turn, axis, int(12 * radius)), name="a.3b")
    assert long is not None
    at, _ = machine.stepping.trace(long.blocks)
    angle = np.unwrap(np.arctan2(at[:, 1] + y, at[:, 0] + x)) * turn
    last = int(np.searchsorted(angle - angle[0], math.radians(degrees)))
    return int(np.abs(np.diff(at[: last + 1, 0 if axis == "X" else 1])).sum())


def assert_whole(data: bytes) -> None:
    """Assert that picture, figures and drawing of an arc are where it is stepped."""
    proof = api.verify(data, name="a.3b")
    assert proof.program is not None
    at, _ = proof.machine.stepping.trace(proof.program.blocks)
    if len(at) < 20:
        return
    svg = api.plot(proof, "a")
    path = re.search(r'<path d="(M[^"]*)"><title>block 1:', svg)
    assert path
    picture = 1000 * sampled(path[1], 0.001)
    assert off(picture, at) < 2.1
    assert off(at, picture) < 2.1
    low, high = at.min(axis=0), at.max(axis=0)
    told = [float(v) for v in re.findall(r'font-size="11"[^>]*>([\d.]+)</text>', svg)]
    assert told == pytest.approx([float(v) / 1000 for v in high - low if v], abs=0.0021)
    assert proof.summary["extents_um"] == [*low.tolist(), *high.tolist()]
    again = 1000 * drawn(api.path_drawing(proof.program, proof.machine))
    assert off(again, at) < 2.5
    assert off(at, again) < 5  # 2000 points a turn


@pytest.mark.parametrize("degrees", [1, 90, 179, 180, 181, 270, 359, 360, 361, 540])
@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("start", [0, 45, 91, 135, 180, 250, 270, 315])
def test_field_arcs_of_every_angle_are_drawn_whole(start, turn, degrees):
    x, y = (round(900 * f(math.radians(start))) for f in (math.cos, math.sin))
    for axis in "XY" if degrees >= 359 else "XY"[turn > 0]:
        if count := counted(x, y, turn, axis, degrees):
            assert_whole(program(x, y, turn, axis, count))


@given(
    st.integers(-1800, 1800),
    st.integers(-1800, 1800),
    st.sampled_from([1, -1]),
    st.sampled_from("XY"),
    st.floats(1, 700),
    st.integers(-2, 3),
)
@example(1500, 0, 1, "X", 360, 1)  # one step past its start it is 55 um past it: a sliver once
@example(1061, 1061, -1, "X", 359.9, 0)  # in the DXF once a circle through both ends
def test_an_arc_whose_count_is_a_little_off_is_drawn_whole(x, y, turn, axis, degrees, off):
    if math.hypot(x, y) < 100:
        return
    assert_whole(program(x, y, turn, axis, max(1, counted(x, y, turn, axis, degrees) + off)))

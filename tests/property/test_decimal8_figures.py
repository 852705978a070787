"""Figures in 8-digit decimals against the same formulas in 50 digits: compensation and corners."""

import mpmath
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from exact_arithmetic import DIGITS, EXACT
from oracle import distance_to_contour
from parts import FAMILIES, family_case, random_part
from wedmcam.arithmetic import FLOAT64
from wedmcam.decimal8 import DECIMAL8
from wedmcam.ir.contour import Contour, vertices
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.corners import round_corners

quick = settings(max_examples=25, deadline=None)


def enlarged(part, factor):
    """A part in another size, in whole um."""
    out = []
    for c in part:
        v = c.vertices.copy()
        for name in ("x", "y", "cx", "cy"):
            v[name] = v[name] * factor
        out.append(Contour(v, c.closed))
    return out


def size_of(part):
    return max(
        float(np.abs(c.vertices[k] - part[0].vertices[k][0]).max()) for c in part for k in "xy"
    )


def apart(one, two):
    """The largest distance between vertices of the same number."""
    worst = 0.0
    for a, b in zip(one, two, strict=True):
        assert a.vertices["turn"].tolist() == b.vertices["turn"].tolist()
        off = [a.vertices[k] - b.vertices[k] for k in "xy"]
        worst = max(worst, float(np.hypot(*off).max()))
    return worst


def off_path(one, two):
    """The largest distance of the vertices of each from the path of the other."""
    pairs = [*zip(one, two, strict=True), *zip(two, one, strict=True)]
    return max(
        float(distance_to_contour(np.column_stack([a.vertices["x"], a.vertices["y"]]), b).max())
        for a, b in pairs
    )


def paths(part, offset, ar, sharp=False):
    signs = [-1.0] + [1.0] * (len(part) - 1)
    with mpmath.workdps(DIGITS):
        made, problems = compensate(part, [offset * s for s in signs], arithmetic=ar, sharp=sharp)
    assert not problems
    return [p.path for p in made.paths]


@quick
@given(
    st.integers(0, 10**6),
    st.sampled_from([1, 10, 100]),
    st.integers(50, 7_999),
    st.booleans(),
)
@example(4096, 1, 65, False)  # vertices of nearly tangent blocks: 0.035 um along the path
@example(710090, 10, 1000, False)  # 0.87 um along it
@example(657933, 10, 1000, True)  # 350 units of the eighth digit along it
def test_compensation_to_10_m(seed, factor, offset, sharp):
    """The path lies within units of the eighth digit; vertices within 1 um, to 1 m far less.

    Where two blocks are nearly tangent their intersection is free to move along both, and does:
    of 7,000 random parts 0.1 % by more than 50 units. Off the path none moved by 1.3 units.
    """
    part = enlarged(random_part(seed), factor)
    offset = min(offset, 100 * factor)
    made = paths(part, offset, DECIMAL8, sharp)
    true = paths(part, offset, EXACT, sharp)
    unit = 10.0 ** (np.ceil(np.log10(size_of(part))) - 8)
    assert off_path(made, true) <= 3 * unit
    assert apart(made, true) <= (0.25 if factor == 1 else 2.0)
    assert apart(paths(part, offset, FLOAT64, sharp), true) < 1e-3


@quick
@given(st.integers(0, 10**6), st.integers(50, 300))
@example(239, 50)  # blocks that are nearly tangent: the arc between them moves along, 0.117 um
def test_corners(seed, radius):
    """Far within 1 um; where both blocks are nearly tangent the arc is free to move along them."""
    part = random_part(seed)
    made, found = round_corners(part, radius, DECIMAL8)
    with mpmath.workdps(DIGITS):
        true, _ = round_corners(part, radius, EXACT)
    if not found:
        assert apart(made, true) < 0.25


@pytest.mark.parametrize("ar", [FLOAT64, DECIMAL8, EXACT], ids=lambda a: a.name)
@pytest.mark.parametrize("radius", [1e6, 1e7, 1e9])
def test_flat_arcs_lose_nothing(ar, radius):
    """A lens of two arcs whose centres lie far away, offset by 100 um: 0.001 um, not 1 um."""
    half = 10_000.0
    sag = radius - np.sqrt(radius**2 - half**2)
    v = vertices([(-half, 0, 0, radius - sag, 1, -1), (half, 0, 0, sag - radius, 1, -1)])
    with mpmath.workdps(DIGITS):
        ((path),) = [
            p.path for p in compensate([Contour(v, True)], [-100.0], arithmetic=ar)[0].paths
        ]
    lean = half / radius
    want = sorted([(s * (half + 100 * lean), t * 100 * np.sqrt(1 - lean**2))
                   for s in (-1, 1) for t in (-1, 1)])  # fmt: skip
    have = sorted(zip(path.vertices["x"].tolist(), path.vertices["y"].tolist(), strict=True))
    assert np.abs(np.array(have) - np.array(want)).max() < 0.01


@pytest.mark.parametrize("family", FAMILIES)
def test_hard_families_stay_where_float64_puts_them(family):
    """Segments of a micron, near tangents, cusps: 'tiny' 3 was once 3 um off, by a direction."""
    for seed in range(12):
        contour, offset, outward = family_case(family, seed)
        shift = -offset if outward else offset
        made, problems = compensate([contour], [shift], arithmetic=DECIMAL8)
        floats, _ = compensate([contour], [shift])
        assert not problems
        for a, b in zip(made.paths, floats.paths, strict=True):
            assert apart([a.path], [b.path]) < 0.2

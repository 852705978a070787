"""Laws of the ZD-065's gap compensation, against geometry in 50 digits (``outlines.py``)."""

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from outlines import exact_joints, random_contour
from wedmcam.controllers.zd065.compensation import HARMLESS, compensate
from written import ends_of


def misses(outline, gap, outwards, corner):
    """Return how far vertices as stepped are from the exact ones, two a joint, and the radii, um.

    None where a corner cannot have its arc. The stated outline is that of the machine with a gap of
    0; its exact vertices are those of the oracle, to which the path of the machine is held too.
    """
    made, problems = compensate(outline, gap, outwards, corner)
    if any(p.what not in HARMLESS for p in problems):
        return None
    ends = ends_of(made.blocks)
    assert ends[-1].tolist() == [0, 0]
    found, largest = [], 0.0
    for k, exact in enumerate(exact_joints(outline, -gap if outwards else gap, corner), 1):
        of = np.flatnonzero(made.stated == k)
        rows = made.path[made.path["source"] == k]
        out, into = (np.array([float(v) for v in place]) for place in (exact.out, exact.into))
        for row, place in ((rows[0], out), (rows[-1], into)):
            assert math.hypot(row["x"] - place[0], row["y"] - place[1]) < 0.03
        found.append(float(np.hypot(*(ends[of] - out).T).min()))
        found.append(float(np.hypot(*(ends[of[-1]] - into))))
        largest = max(largest, float(made.path["radius"].max()))
    assert made.miss.max() <= 1.0
    return found, largest


@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.floats(3.5, 5.6),
    bend=st.floats(-2.2, -0.2),
    gap=st.one_of(st.integers(1, 7999), st.sampled_from([1, 2, 100, 7999])),
    outwards=st.booleans(),
    share=st.sampled_from([1.0, 1.0, 1.1, 1.4]),
)
@settings(max_examples=40, deadline=None)
def test_vertices_as_stepped_are_within_a_um_of_the_exact_ones(
    seed, size, bend, gap, outwards, share
):
    """Contours of 3 to 400 mm, arcs up to 10 m and more, gaps to 7,999 um, corners of all kinds."""
    outline = random_contour(np.random.default_rng(seed), 10**size, bulge=10**bend)
    result = misses(outline, gap, outwards, gap * share)
    assume(result is not None)
    assert max(result[0]) <= 1.0

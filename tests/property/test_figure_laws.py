"""Laws of the transforms, on random figures up to 1 m, against 50-digit arithmetic."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.arithmetic import FLOAT64
from wedmcam.decimal8 import DECIMAL8
from wedmcam.frontends.wed import parse_transform
from wedmcam.geom.measure import length
from wedmcam.ir.contour import Contour, vertices
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.figures import Motion, moved, transformed

um = st.integers(-500_000, 500_000)
quick = settings(max_examples=40, deadline=None)


@st.composite
def chains(draw):
    n = draw(st.integers(2, 6))
    rows = []
    for k in range(n):
        x, y, cx, cy = (draw(um) + draw(st.sampled_from([0, 0.25, 0.37])) for _ in range(4))
        turn = draw(st.sampled_from([-1, 0, 1])) if k < n - 1 else 0
        rows.append((x, y, cx, cy, turn, -1))
    return Contour(vertices(rows), False)


@quick
@given(chains(), st.fractions(-720, 720, max_denominator=1000), um, um)
def test_rotation_is_within_a_micron_of_the_truth(figure, degrees, ax, ay):
    with mpmath.workdps(50):
        a = mpmath.radians(mpmath.mpf(degrees.numerator) / degrees.denominator)
        c, s = mpmath.cos(a), mpmath.sin(a)
        true = []
        for x, y in zip(figure.vertices["x"].tolist(), figure.vertices["y"].tolist(), strict=True):
            u, v = mpmath.mpf(x) - ax, mpmath.mpf(y) - ay
            true.append((float(ax + c * u - s * v), float(ay + s * u + c * v)))
    for ar, bound in ((FLOAT64, 1e-8), (DECIMAL8, 0.1)):
        (image,) = moved((figure,), Motion(degrees, about=(ax, ay)), ar)
        off = np.hypot(image.vertices["x"] - [p[0] for p in true],
                       image.vertices["y"] - [p[1] for p in true])  # fmt: skip
        assert off.max() < bound


@quick
@given(
    chains(),
    st.sampled_from(["symmetry x", "symmetry y", "mirror 45", "mirror 135", "rotate 90",
                     "rotate 180", "rotate 270", "translate (1, 2)", "reverse"]),
    st.sampled_from([FLOAT64, DECIMAL8]),
)  # fmt: skip
def test_length_is_kept_and_the_inverse_undoes(figure, text, ar):
    back = {"rotate 90": "rotate 270", "rotate 270": "rotate 90"}
    back |= {"translate (1, 2)": "translate (-1, -2)"}
    t, _ = parse_transform(f"{text} | {back.get(text, text)}")
    made, _ = transformed((figure,), t, ar)
    assert made is not None
    for k in ("x", "y"):
        assert np.abs(made[0][0].vertices[k] - figure.vertices[k]).max() <= (
            0.011 if "translate" in text else 0
        )
    once, _ = transformed((figure,), parse_transform(text)[0], ar)
    arcs = figure.vertices["turn"] != 0
    if not arcs.any():
        assert length(once[0][0].vertices, False) == pytest.approx(
            length(figure.vertices, False), abs=0.1
        )


@quick
@given(
    st.integers(3_000, 90_000),
    st.integers(2_000, 60_000),
    st.integers(100, 900),
    st.sampled_from(["symmetry x", "mirror 135", "rotate 90", "rotate 37", "translate (3, 4)"]),
)
def test_offset_commutes(width, height, offset, text):
    """The offset of the image is the image of the offset: sides turn over with the contour."""
    box = Contour(
        vertices([(0, 0, 0, 0, 0, 0), (width, 0, 0, 0, 0, 0), (width, height, 0, 0, 0, 0),
                  (0, height, 0, 0, 0, 0)]), True)  # fmt: skip
    t, _ = parse_transform(text)
    over = text.startswith(("symmetry", "mirror"))
    (image,), _ = transformed((box,), t, FLOAT64)[0]
    ways = [
        compensate([image], [float(offset if over else -offset)], arithmetic=FLOAT64)[0].paths,
        compensate([box], [float(-offset)], arithmetic=FLOAT64)[0].paths,
    ]
    (then,), _ = transformed((ways[1][0].path,), t, FLOAT64)[0]
    first = ways[0][0].path

    def points(c):
        return np.array(
            sorted(zip(c.vertices["x"].round(3), c.vertices["y"].round(3), strict=True))
        )

    assert np.abs(points(first) - points(then)).max() < 0.002

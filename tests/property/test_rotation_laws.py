"""Laws of the rotation format: vertices as stepped, figures that close, and bytes of any kind."""

import mpmath
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.backends.zd065.figure import state
from wedmcam.controllers.pointwise import run
from wedmcam.controllers.zd065.data import POLAR, WAY
from wedmcam.controllers.zd065.rotation import rotate_closed
from wedmcam.frontends.zd065.rotation import decode
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

M = builtin("zd065-rotation")
degrees = st.floats(0.01, 359.9).map(lambda v: float(f"{v:.8g}"))


@st.composite
def figures(draw):
    """Lines to 1 m and arcs to R 10 m, with chords that 99 copies keep within 10 m."""
    n = draw(st.integers(1, 4))
    out = np.zeros(n, POLAR)
    for k in range(n):
        start, turn = draw(degrees), draw(st.sampled_from([-1, 0, 1]))
        if not turn:
            out[k] = (Kind.LINE, 0, start, draw(st.integers(1, 999_999)), 0.0)
            continue
        size = draw(st.one_of(st.integers(2, 1_000_000), st.just(10_000_000)))
        most = min(200.0, np.degrees(1_000_000 / size))
        sweep = float(f"{draw(st.floats(max(50 / size, most / 100), most)):.8g}")
        out[k] = (Kind.ARC, turn, start, size, sweep)
    return out


@settings(max_examples=25, deadline=None)
@given(figures(), st.integers(2, 100))
def test_vertices_as_stepped_are_within_a_um_of_the_stated_figure(figure, order):
    copies, step = order - 1, float(f"{360 / order:.8g}")
    made = rotate_closed(figure, copies, step)
    moves = run(made.blocks)
    ends = np.append(0, np.cumsum(moves.dx + 1j * moves.dy))
    n = len(figure) * order
    stands = ends[np.searchsorted(made.blocks["source"], np.arange(n), side="right")]
    with mpmath.workdps(40):
        ways = []
        for row in figure:
            here = int(row["size"]) * mpmath.expjpi(mpmath.mpf(repr(float(row["start"]))) / 180)
            sweep = int(row["turn"]) * mpmath.mpf(repr(float(row["sweep"])))
            arc = row["kind"] == Kind.ARC
            ways.append(here * (mpmath.expjpi(sweep / 180) - 1) if arc else here)
        at, true = mpmath.mpc(0), []
        for k in range(order):
            turned = mpmath.expjpi(k * mpmath.mpf(repr(step)) / 180)
            for way in ways:
                at += way * turned
                true.append(complex(at))
    assert abs(stands - np.array(true)).max() <= 1.0


@settings(max_examples=40, deadline=None)
@given(
    st.integers(3, 100),
    st.integers(10_000, 90_000),
    st.lists(st.tuples(st.floats(0.1, 0.9), st.floats(-0.4, 0.4)), min_size=2, max_size=5),
)
def test_figures_that_are_said_to_close_do(order, radius, inner):
    """Within 0.3 sin(pi / N) um, as 40 digits add up what is written."""
    pitch = 2 * np.pi / order
    end = radius * (np.exp(1j * pitch) - 1)
    points = np.array([end * (t + 1j * h) for t, h in sorted(inner)] + [end])
    path = np.zeros(len(points), WAY)
    path["kind"], path["x"], path["y"] = Kind.LINE, points.real, points.imag
    stated = state(path)
    limit = 0.3 * np.sin(np.pi / order)
    if not stated.closes or stated.drift_um > limit:
        return  # told; nothing is written
    with mpmath.workdps(40):
        total = mpmath.mpc(0)
        for row in stated.figure:
            angle = mpmath.mpf(repr(float(row["start"])))
            total += int(row["size"]) * mpmath.expjpi(angle / 180)
        turn = mpmath.expjpi(mpmath.mpf(2) / order)
        assert abs(total - radius * (turn - 1)) <= limit + 1e-6


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damaged_data_are_findings_with_a_place(data):
    good = bytes.fromhex(
        "11028831176800000100028828274604032699994700080721023000000010000000015000000000"
    )
    bad = bytearray(good)
    for at in data.draw(st.lists(st.integers(0, len(good) - 1), max_size=4)):
        bad[at] = data.draw(st.integers(0, 255))
    bad = bytes(bad)[: data.draw(st.integers(0, len(good)))]
    copies = data.draw(st.sampled_from([0, 1, 35]))
    _, findings = decode(bad, M, "a.zdr", copies, 10.0 if copies else 0.0)
    assert all(d.span is not None for d in findings)

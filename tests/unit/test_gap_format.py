"""The gap-compensation format: its bytes, what the controller makes of them, what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam import machines
from wedmcam.backends.scaled import outline
from wedmcam.backends.zd065.compensation import encode
from wedmcam.controllers.scaling import scale
from wedmcam.diag import Severity
from wedmcam.frontends.identify import identify
from wedmcam.frontends.zd065.compensation import decode, read
from wedmcam.ir.program import BLOCK, Axis, Kind, Program

M = machines.builtin("zd065-compensation")
# A rounded square: lines of 6 mm, corners of 2 mm; it starts on its lower side, counter-clockwise.
ROUND = bytes.fromhex(
    "01 006000 000000  24 01 00002000 00000000 00002000 002828"
    "02 000000 006000  21 01 00002000 00002000 00000000 002828"
    "03 006000 000000  22 01 00002000 00000000 00002000 002828"
    "04 000000 006000  23 01 00002000 00002000 00000000 002828 00"
)


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


def test_bytes_are_what_the_widths_say():
    assert len(ROUND) == 4 * 7 + 4 * 17 + 1
    figure, found = read(ROUND, M, "a.zdc")
    assert not found
    assert figure["radius"].tolist() == [0, 2000] * 4
    assert figure["grows"].tolist() == [0, 1] * 4
    seen = identify(ROUND)
    assert (seen.format, seen.blocks, seen.last_address) == ("compensation", 8, len(ROUND) - 1)
    assert seen.reason == "gap-compensation format: 8 blocks"


@pytest.mark.parametrize(
    ("gap", "outwards", "radius", "count"), [(100, True, 2100, 2969), (100, False, 1900, 2687)]
)
def test_open_loop_arcs_are_scaled_and_lines_are_kept(gap, outwards, radius, count):
    made, found = decode(ROUND, M, "a.zdc", gap, outwards, open_loop=True)
    assert not found
    arcs = made.blocks[made.blocks["kind"] == Kind.ARC]
    assert np.hypot(arcs["x"], arcs["y"]).tolist() == [radius] * 4
    assert arcs["count"].tolist() == [count] * 4  # 2828 x 1.05 = 2969.4; x 0.95 = 2686.6
    straight = made.blocks[made.blocks["kind"] == Kind.LINE]
    assert straight["count"].tolist() == [6000] * 4


def test_a_gap_of_0_is_the_outline():
    made, found = decode(ROUND, M, "a.zdc")
    assert not found
    data, found = encode(made, M)
    assert not found
    assert data == ROUND


@pytest.mark.parametrize("gap", [2000, 8000, 0.5, -1])
def test_gaps_that_are_refused(gap):
    _, found = decode(ROUND, M, "a.zdc", gap, outwards=False)
    assert set(errors(found)) == {"gap-value"}


def test_open_loop_a_corner_is_refused_and_leads_are_not():
    corner = bytes.fromhex("01006000000000 02000000006000 03006000000000 04000000006000 00")
    _, found = decode(corner, M, "a.zdc", 100, open_loop=True)
    assert errors(found) == ["not-tangent"]  # the first and the last line may be leads
    assert not errors(decode(corner, M, "a.zdc", 0)[1])


def test_lines_alone_are_the_bytes_of_the_cutting_format():
    seen = identify(bytes.fromhex("01006000000000 02000000006000 00"))
    assert seen.format == "compact"
    assert not seen.certain
    assert "lines alone: the compensation format has the same bytes" in seen.reason


@pytest.mark.parametrize(
    ("data", "code"),
    [
        ("24 03 00002000 00000000 00002000 002828 00", "bad-type"),
        ("24 01 00000000 00000000 00002000 002828 00", "radius-contradicts"),
        ("24 01 0000200A 00000000 00002000 002828 00", "bad-digit"),
        ("24 01 00002000 00000000 00002000 000000 00", "zero-count"),
        ("24 01 00002000 00000000 00002000 0028", "truncated"),
        ("77", "bad-instruction"),
    ],
)
def test_what_is_refused(data, code):
    assert code in errors(decode(bytes.fromhex(data), M, "a.zdc")[1])


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=80), st.integers(0, 8000), st.booleans())
def test_any_bytes_are_taken(data, gap, outwards):
    made, _ = decode(data, M, "a.zdc", gap, outwards)
    assert len(made.blocks) == len(made.spans)


@pytest.mark.parametrize(("sign", "least"), [(-1, 1.0), (1, 0.8)])
def test_how_many_arcs_come_out_exactly(sign, least):
    """All that shrink; of those that grow nearly all at R of some mm, by the choice of R."""
    rng = np.random.default_rng(4)
    n = 1000
    r, a = rng.uniform(2_000, 60_000, n), rng.uniform(0, 2 * np.pi, n)
    blocks = np.zeros(n, BLOCK)
    blocks["kind"], blocks["axis"], blocks["turn"] = Kind.ARC, Axis.SQUARE, 1
    blocks["x"], blocks["y"] = np.round(r * np.cos(a)), np.round(r * np.sin(a))
    blocks["count"] = rng.uniform(0.3, 5, n) * r
    grown = np.full(n, sign, np.int64)
    made = scale(outline(blocks, 100, True, grown), 100, True)
    same = np.ones(n, bool)
    for name in ("x", "y", "count"):
        same &= made[name] == blocks[name]
    assert same.mean() >= least
    assert np.hypot(made["x"] - blocks["x"], made["y"] - blocks["y"]).max() <= 1.5


def test_memory():
    blocks = np.zeros(586, BLOCK)
    blocks["kind"], blocks["x"], blocks["count"] = Kind.LINE, 100, 100
    for n, over in ((585, False), (586, True)):
        _, found = encode(Program(blocks[:n].copy()), M)
        assert ("over-memory" in [d.code for d in found]) is over


def test_records_of_a_plate_state_its_outline_whatever_is_cut_first():
    """A hole shrinks and an outer corner grows, also where the hole is cut before the outside."""
    import parts
    import wedmcam

    plate = parts.contour_of_bulges(
        *parts.rounded(np.array([(0.0, 0), (30_000, 0), (30_000, 20_000), (0, 20_000)]), 2000.0)
    )
    drawing = parts.dxf_bytes((plate, parts.circle(15_000, 10_000, 5000)))
    made = wedmcam.compile(drawing, to="4b", offset=0.1)
    assert made.ok
    records = [r for r in made.data.decode().split() if "R" in r]
    assert {r.split("G")[0].split("B")[-1] for r in records} == {"5000DD", "2000D"}

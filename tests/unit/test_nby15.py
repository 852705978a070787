"""The NBY-15: the table of degrees as published, circles that close, tapes, the corrector."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawings import drawing
from wedmcam import api
from wedmcam.controllers.nby15.base_circle import (
    DEGREES,
    DIODES,
    HALF,
    PLACES,
    RADIUS,
    SHIFT,
    along,
    arc_limit_um,
    movements,
    sagitta_um,
    steps_of,
)
from wedmcam.controllers.nby15.corrector import correction
from wedmcam.controllers.nby15.data import TAPE, Switches, lines_of, radii
from wedmcam.formats.tape import LEADER, odd_rows, punched, rows_text
from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.ir.program import Kind
from wedmcam.machines import default

SAMPLES = Path(__file__).parents[2] / "samples"
NBY15 = default("nby15")
PART = "N1G01X+3000Y+0\nN2G03A0B90R500\nN3G02A180B45R1200\nN4G00X+5Y-7\nN5M00\nN6M02\n"


def decoded(data):
    return decoder("nby15")(data, NBY15, "a.n15")


def codes(data):
    return [d.code for d in decoded(data)[1]]


def tape_of(*rows):
    out = np.zeros(len(rows), TAPE)
    for k, row in enumerate(rows):
        for name, value in row.items():
            out[name][k] = value
    return out


def arc(radius, start, degrees, turn=1):
    return {"kind": Kind.ARC, "turn": turn, "radius": radius, "start": start, "degrees": degrees}


def line(x, y):
    return {"kind": Kind.LINE, "x": x, "y": y}


def test_the_diodes_are_those_of_the_source():
    assert DIODES[:4].tolist() == [[40, 4575], [120, 4574], [199, 4571], [280, 4566]]
    assert DIODES[18].tolist() == [1452, 4339]
    assert DIODES[22].tolist() == [1751, 4227]


def test_a_quadrant_sums_to_the_radius_of_the_base_circle():
    assert DEGREES[:90].sum(axis=0).tolist() == [-RADIUS, RADIUS]
    assert not DEGREES.sum(axis=0).any()
    angle = np.radians(np.arange(360))
    true = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    assert np.abs(PLACES - true).max() <= 0.5 + 1e-6


@pytest.mark.parametrize("start", [0, 18])
def test_every_circle_closes_with_its_residues(start):
    """All radii at once, degree by degree, with the residues carried on as the machine does."""
    radius = np.arange(1, 300_001)
    residue = np.full((2, len(radius)), HALF)
    at = np.zeros((2, len(radius)), np.int64)
    angle = np.radians(start)
    first = np.array([np.cos(angle), np.sin(angle)])[:, None] * radius
    worst = {1_000: 0.0, 60_000: 0.0, 300_000: 0.0}
    for degree, move in enumerate(movements(start + np.arange(360), np.ones(360, np.int64)), 1):
        residue += move[:, None] * radius
        at += residue >> SHIFT
        residue &= RADIUS - 1
        angle = np.radians(start + degree)
        true = np.array([np.cos(angle), np.sin(angle)])[:, None] * radius - first
        off = np.hypot(*(at - true))
        for most in worst:
            worst[most] = max(worst[most], float(off[:most].max()))
    assert not at.any()
    assert (residue == HALF).all()
    assert worst[1_000] <= 0.715
    assert worst[60_000] <= 1.0
    assert worst[300_000] <= 1.695


@given(
    st.lists(
        st.tuples(
            st.integers(1, 300_000),
            st.integers(0, 359),
            st.integers(1, 360),
            st.sampled_from([1, -1]),
        ),
        max_size=8,
    )
)
def test_the_closed_form_is_the_machine_degree_by_degree(arcs):
    tape = tape_of(*(arc(*a) for a in arcs))
    residue, at, made = np.array([HALF, HALF]), np.zeros(2, np.int64), []
    for radius, start, degrees, turn in arcs:
        for k in range(degrees):
            row = (start + turn * k) % 360 if turn > 0 else (start - k - 1) % 360
            total = turn * DEGREES[row] * radius + residue
            made.append(total // RADIUS)
            residue = total % RADIUS
            at = at + made[-1]
    blocks, _ = lines_of(tape)
    expected = [m.tolist() for m in made if m.any()]
    assert [[int(b["x"]), int(b["y"])] for b in blocks] == expected


def test_an_arc_back_over_its_degrees_comes_back():
    tape = tape_of(arc(123_457, 33, 200), arc(123_457, 233, 200, -1))
    blocks, _ = lines_of(tape)
    assert (blocks["x"].sum(), blocks["y"].sum()) == (0, 0)


def test_limits_of_an_arc():
    assert sagitta_um(26_263) == pytest.approx(1.0, abs=1e-3)
    assert float(arc_limit_um(np.array(52_500.0))) == pytest.approx(3.5, abs=0.01)
    assert along(0, 1, 90)[-1].tolist() == [-RADIUS, RADIUS]
    assert steps_of(np.zeros((0, 2), np.int64), np.array([5, 6]))[1].tolist() == [5, 6]


# --- tape ----------------------------------------------------------------------------------------


def test_a_tape_is_read_as_it_was_written():
    program, findings = decoded(punched(PART))
    assert findings == []
    assert program.tape["kind"].tolist() == [Kind.LINE, Kind.ARC, Kind.ARC, Kind.MOVE, 3, 4]
    assert identify(punched(PART)).format == "nby15"


def test_every_single_hole_is_found():
    """One hole more or less in any row, the leader's and the trailer's too."""
    data = punched(PART)
    for row in range(len(data)):
        for channel in range(8):
            bad = bytearray(data)
            bad[row] ^= 1 << channel
            assert odd_rows(bytes(bad)).tolist() == [row]
    for row in (0, LEADER, LEADER + 7, len(data) - 1):
        bad = bytearray(data)
        bad[row] ^= 4
        found = [d for d in decoded(bytes(bad))[1] if d.code == "tape-parity"]
        assert [d.values["row"] for d in found] == [row + 1]


def test_rub_outs_and_blanks_say_nothing():
    data = punched(PART)
    at = data.index(b"G") if b"G" in data else LEADER + 6
    marked = data[:at] + b"\xff\xff\x00" + data[at:]
    assert decoded(marked)[1] == []
    assert (decoded(marked)[0].blocks == decoded(data)[0].blocks).all()


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("N1G01X+5\nN3M02\n", "tape-sequence"),
        ("N1G05X+5\nN2M02\n", "tape-block"),
        ("N1G03A0B90R300001\nN2M02\n", "over-limit"),
        ("N1G03A360B90R10\nN2M02\n", "bad-angle"),
        ("N1G03A0B361R10\nN2M02\n", "bad-angle"),
        ("N1G01X+1234567\nN2M02\n", "tape-block"),
        ("N1M02\nN2G01X+5\n", "after-end"),
        ("N1G01X+0Y+0\nN2M02\n", "empty-block"),
    ],
)
def test_bad_tapes(text, code):
    found = [d for d in decoded(punched(text))[1] if d.code == code]
    assert len(found) == 1
    assert "row" in found[0].message


def test_a_tape_without_its_beginning():
    assert codes(bytes(50)) == ["tape-start"]
    assert codes(punched(PART)[LEADER + 2 :]) == ["tape-start"]


@given(st.binary(max_size=300))
def test_any_bytes_are_answered(data):
    decoded(data)
    identify(data)
    rows_text(data)


# --- corrector -----------------------------------------------------------------------------------

STADIUM = tape_of(line(5000, 0), arc(400, 270, 180), line(-5000, 0), arc(400, 90, 180))


def test_a_tangent_profile_is_corrected_up_to_its_smallest_radius():
    lead = tape_of(line(0, -1000))
    whole = np.concatenate([lead, STADIUM, tape_of(line(0, 1000))])
    c = correction(whole)
    assert (c.most_um, c.why) == (400, "radius")
    for correct in (-400, -123, 0, 250, 400):
        blocks, _ = lines_of(STADIUM, Switches(correct))
        assert (blocks["x"].sum(), blocks["y"].sum()) == (0, 0)
        assert int(np.abs(blocks["y"]).sum()) == 4 * (400 + correct)


def test_what_may_not_be_corrected():
    corner = tape_of(line(9, 9), line(5000, 0), line(0, 5000), arc(300, 0, 90), line(9, 9))
    assert correction(corner).why == "corner"
    fraction = tape_of(line(9, 9), arc(9000, 0, 89), line(-78, 1), line(-5000, 0), line(9, 9))
    assert correction(fraction).most_um == 0
    assert correction(tape_of(line(5, 5))).why == "no-arc"
    torn = tape_of(line(0, 9), arc(900, 0, 90), line(-16, 0), arc(900, 91, 90), line(0, 9))
    assert correction(torn).why == "fraction"


def test_beyond_the_smallest_radius_it_wraps():
    assert radii(tape_of(arc(400, 0, 90)), Switches(-401)).tolist() == [999_999]
    assert radii(tape_of(arc(400, 0, 90, -1)), Switches(-401)).tolist() == [801]


def test_switches_of_scale_and_direction():
    blocks, _ = lines_of(tape_of(line(7, 3), arc(400, 0, 90)), Switches(0, 5, True, False))
    assert (int(blocks["x"].sum()), int(blocks["y"].sum())) == (-35 + 2000, 15 + 2000)


# --- compile and prove ---------------------------------------------------------------------------


def test_a_compile_says_what_may_be_corrected_and_it_is_so():
    part = SAMPLES / "key-punch.dxf"
    made = api.compile(part, to="nby15", offset=0.1)
    assert made.ok
    told = {d.code: d for d in made.findings}
    assert told["radius-corrector"].values["most_um"] == 100
    assert "degree-polygons" in told
    from wedmcam.targets import Entries

    entered = Entries(switches=Switches(50))
    proof = api.verify(
        made.data, format="nby15", against=part, entered=entered, offset=0.15, fit_origin=True
    )
    assert proof.ok, proof.findings
    assert proof.verdict.max_deviation_um <= 1.62
    refused = api.verify(made.data, format="nby15", entered=Entries(switches=Switches(-101)))
    assert not refused.ok
    assert [d.code for d in refused.findings if d.severity.name == "ERROR"] == ["radius-corrector"]
    run = api.verify(
        made.data, format="nby15", entered=Entries(switches=Switches(-300), run_off=True)
    )
    assert "limit-switch" in [d.code for d in run.findings]


@pytest.mark.parametrize("radius", [0.3, 5.0, 26.0, 59.9, 80.0, 140.0])
def test_arcs_are_proven_within_their_limit(radius):
    data = drawing(lambda doc, space: space.add_circle((0, 0), radius))
    made = api.compile(data, name="a.dxf", to="nby15", offset=0.1)
    assert made.ok, [d.message for d in made.findings]
    limit = float(arc_limit_um(1000 * radius + 100))
    assert made.verdict.max_deviation_um <= limit
    assert made.verdict.closure_um == 0
    assert made.verdict.path_limit_um == pytest.approx(max(2.0, limit))

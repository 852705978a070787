"""compile --to rotation and --to compensation: what the controller makes of the file is proven."""

import math
from pathlib import Path

import numpy as np
import pytest

import parts
import wedmcam
from drawings import drawing
from wedmcam import api
from wedmcam.options import Options, WrongUse

SAMPLES = Path(__file__).parents[2] / "samples"


def rounded(degrees):
    bulge = math.tan(math.pi / 8)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    corners = [(2, 0, 0), (18, 0, bulge), (20, 2, 0), (20, 8, bulge), (18, 10, 0), (2, 10, bulge),
               (0, 8, 0), (0, 2, bulge)]  # fmt: skip
    rows = [(c * x - s * y, s * x + c * y, b) for x, y, b in corners]

    def draw(doc, msp):
        msp.add_lwpolyline(rows, format="xyb", close=True)

    return drawing(draw)


@pytest.mark.parametrize("name", ["gear-24", "key-punch", "plate"])
def test_rotation_steps_onto_the_vertices_of_the_cutting_format(name):
    made = [
        wedmcam.compile(SAMPLES / f"{name}.dxf", to=to, offset=0.1)
        for to in ("compact", "rotation")
    ]
    assert all(m.ok for m in made), made[1].findings
    a, b = (
        np.array([complex(x, y) for x, y in api.positions(m.program, m.machine)[1].tolist()])
        for m in made
    )
    # The vertices of the path rounded; the cutting format ends arcs up to a um beside them.
    assert abs(a[:, None] - b).min(axis=1).max() < 1.5
    proof = api.verify(made[1].data, against=SAMPLES / f"{name}.dxf", name="a.zdr", offset=0.1)
    assert proof.ok, proof.findings


@pytest.mark.parametrize("degrees", [0, 23.7, 61])
@pytest.mark.parametrize("side", ["part", "die"])
@pytest.mark.parametrize("offset", [0.1, 0.3])
def test_compensation_of_a_tangent_outline(degrees, side, offset):
    made = wedmcam.compile(
        rounded(degrees), to="compensation", name="a.dxf", offset=offset, side=side
    )
    assert made.ok, made.findings
    assert made.summary["closure_um"] == 0
    assert made.summary["max_deviation_um"] <= 2
    proof = api.verify(made.data, against=rounded(degrees), name="a.zdc", offset=offset, side=side)
    assert proof.ok, proof.findings
    # The outline is stated, so the same file is right for another gap; the writer sees to the
    # limits of 1.6 and 2 um for the gap that it is compiled for.
    proof = api.verify(
        made.data, against=rounded(degrees), name="a.zdc", offset=offset + 0.05, side=side
    )
    errors = [d for d in proof.findings if d.severity == 2]
    assert {d.code for d in errors} <= {"gouge"}
    assert all(d.values["depth_mm"] <= 0.002 for d in errors)


def test_corners_are_refused_unless_rounded():
    square = parts.dxf_bytes((parts.rectangle(20_000, 10_000),))
    made = wedmcam.compile(square, to="compensation", offset=0.1)
    assert (made.ok, made.stage) == (False, "encode")
    assert [d.code for d in made.findings if d.severity == 2] == ["not-tangent"] * 4
    assert wedmcam.compile(square, to="compensation", offset=0.1, corner=0.5).ok


def test_a_fraction_of_a_um_is_wrong_use():
    with pytest.raises(WrongUse, match="whole um"):
        wedmcam.compile(rounded(0), to="compensation", options=Options.of(offset_um=100.5))


def test_random_rounded_parts_are_proven_or_refused():
    """Nothing is written that failed; most do not."""
    done = []
    for seed in range(12):
        made = wedmcam.compile(
            parts.dxf_bytes(parts.random_part(seed)), to="compensation", offset=0.1, corner=0.3
        )
        assert made.ok == (made.data is not None)
        assert made.ok or made.stage in ("encode", "verify"), made.findings
        done.append(made.ok)
    assert np.mean(done) > 0.4


def test_identify_tells_the_last_address_and_the_memory(tmp_path):
    from click.testing import CliRunner

    from wedmcam.cli.main import cli

    program = tmp_path / "stator.bin"
    made = wedmcam.compile(SAMPLES / "stator-36.dxf", to="compact", offset=0.1)
    assert [d.code for d in made.findings].count("over-memory") == 1
    program.write_bytes(made.data)
    told = CliRunner().invoke(cli, ["identify", str(program)], standalone_mode=False).output
    used = len(made.data)
    assert f"last address {used - 1:#06x}, {used} of 4096 bytes" in told

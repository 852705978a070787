"""Outlines for controllers that offset them: written, decoded, applied and proven."""

import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from wedmcam import api
from wedmcam.judge.difference import difference
from wedmcam.machines import builtin
from wedmcam.machines.machine import Axes
from wedmcam.operations import convert
from wedmcam.options import WrongUse
from wedmcam.targets import Entries

SAMPLES = Path(__file__).parents[2] / "samples"
DRAWINGS = sorted(p.name for p in SAMPLES.glob("*.dxf"))
PARTS = sorted(p.name for p in SAMPLES.glob("*.wed"))


def compiled(name, profile="iso-g41", **more):
    if name.endswith("dxf"):
        more = {"offset": 0.1, **more}
    if name.startswith("damaged"):
        more["units"] = "mm"
    return api.compile((SAMPLES / name).read_bytes(), name=name, profile=profile, **more)


@pytest.mark.parametrize("profile", ["iso-g41", "iso-g41-mm"])
@pytest.mark.parametrize("name", [*DRAWINGS, *PARTS])
def test_every_sample_is_proven(name, profile):
    made = compiled(name, profile)
    assert made.ok, [d.message for d in made.findings]
    assert made.verdict.max_deviation_um <= 2.0
    assert (made.verdict.gouge_um or 0.0) <= 1.6
    assert made.verdict.closure_um == 0
    assert made.summary["d_um"] == {"1": 100.0}
    assert re.search(rb"G4[12] D1 G01 X", made.data)


@pytest.mark.parametrize("name", ["plate.dxf", "key-punch.dxf", "cam.wed", "row.wed", "washer.wed"])
def test_the_controllers_path_is_that_of_3b(name):
    """Where paths start at one place they are one path; the others are held to the plan alone."""
    made = compiled(name, "iso-g41-mm")
    other = compiled(name, "b3-compact")
    table = made.machine.stepping
    assert difference(other.program, made.program, table, table, 1.0).equal
    back = convert.convert(
        made.data, to="3b", name="x.nc", profile_in="iso-g41-mm", entered=Entries(d=made.entries.d)
    )
    assert back.ok
    assert back.difference.largest_um == 0


def test_sides():
    """Kept inside: counter-clockwise G42, clockwise G41; kept outside the reverse."""
    for options, outer, hole in (
        ({}, "G42", "G41"),
        ({"reverse": True}, "G41", "G42"),
        ({"side": "die"}, "G41", "G42"),
        ({"side": "die", "reverse": True}, "G42", "G41"),
    ):
        text = compiled("plate.dxf", ignore_layers=["START"], **options).data.decode()
        sides = re.findall("G4[12]", text)
        assert (sides[-1], sides[0]) == (outer, hole)


@pytest.mark.parametrize("axes", list(product((False, True), repeat=3)))
def test_axes(axes):
    machine = replace(builtin("iso-g41"), axes=Axes(*axes))
    assert compiled("key-punch.dxf", machine).ok


SQUARE = "contour s { from (0, 0) line to (20, 0) line to (20, 10) line to (0, 10) close }\n"


def part(text, profile="iso-g41", **more):
    return api.compile(SQUARE.encode() + text.encode(), name="s.wed", profile=profile, **more)


def test_a_start_at_a_corner_moves_beside_a_segment():
    made = part("cut s outside offset 0.1 start (-1, -1)")
    assert made.ok
    first = made.data.decode().splitlines()[2]
    assert first in ("G42 D1 G01 X1300 Y1000", "G42 D1 G01 X1000 Y1300")


def test_offsets_of_their_own_have_numbers_of_their_own():
    made = part(
        "contour t { from (40, 0) line to (60, 0) line to (60, 10) close }\n"
        "cut s outside offset 0.1 start (-2, 5)\ncut t outside offset 0.15 start (50, -2)\n"
    )
    assert made.ok, [d.message for d in made.findings]
    assert made.summary["d_um"] == {"1": 100.0, "2": 150.0}
    assert re.findall("D[0-9]", made.data.decode()) == ["D1", "D2"]


def test_cuts_on_the_line_stay_in_g40():
    made = part(
        "contour t { from (40, 0) line to (60, 0) line to (60, 10) close }\n"
        "cut t on start (50, -2)\ncut s outside offset 0.1 start (-2, 5)\n"
    )
    assert made.ok, [d.message for d in made.findings]
    assert made.data.decode().count("D1") == 1


def test_open_contours_end_with_g40_alone():
    made = part(
        "contour o { from (0, 0) line to (20, 0) line to (20, 10) }\ncut o left offset 0.1\n"
        "cut o right offset 0.1\n"
    )
    assert made.ok, [d.message for d in made.findings]
    lines = made.data.decode().splitlines()
    assert lines.count("G40") == 2
    assert lines[2].startswith("G41")


def test_a_pause_on_the_way():
    made = compiled("plate.dxf", stop=2.0)
    assert made.ok
    assert made.data.decode().count("M00") == 2 * 9 + 10


def test_a_wire_threaded_on_its_path_has_a_lead_in_the_outline_alone():
    """As long as the offset: it is no block of the path, which closes all the same."""
    for profile in ("iso-g41", "iso-g41-mm"):
        made = part("cut s outside offset 0.1 start (10, -0.1)", profile)
        assert made.ok, [d.message for d in made.findings]
        assert made.verdict.closure_um == 0


def test_a_pause_that_no_controller_takes_is_refused():
    made = part("cut s outside offset 0.1 start (-1, 5) stop 5.08")
    errors = [d for d in made.findings if d.severity.name == "ERROR"]
    assert errors[0].code == "compensation-place"
    assert "arc round a corner" in errors[0].message
    assert errors[0].hint


def test_what_has_no_words_is_wrong_use():
    with pytest.raises(WrongUse, match="step_um"):
        compiled("plate.dxf", replace(builtin("iso-g41"), axes=Axes(step_um=2)))
    with pytest.raises(WrongUse, match="--overcut"):
        compiled("plate.dxf", overcut=1.0)
    with pytest.raises(WrongUse, match="--convex"):
        compiled("plate.dxf", sharp=True)


def test_a_path_that_is_only_part_of_its_outline_is_refused():
    made = compiled("plate.dxf", from_block=4)
    assert [d.code for d in made.findings][-1:] != []
    assert made.ok or "compensation-lost" in {d.code for d in made.findings}


def test_programs_hold_no_outlines():
    made = convert.convert(b"B17000B5000B17000GXL1 DD", profile="iso-g41", name="x.3b")
    assert not made.ok
    assert made.findings[-1].code == "not-in-format"
    assert "iso-um" in made.findings[-1].hint


def verified(data):
    return api.verify(
        data, against=SAMPLES / "key-punch.dxf", name="x.nc", offset=0.1, profile="iso-g41"
    )


def test_the_program_itself_is_proven_and_forgeries_are_not():
    text = compiled("key-punch.dxf").data.decode()
    assert verified(text.encode()).ok
    lines = text.splitlines()
    lead = next(i for i, line in enumerate(lines) if "D1" in line)
    side = "G41" if "G41" in text else "G42"
    other = {"G41": "G42", "G42": "G41"}[side]
    for name, forged in {
        "sides": text.replace(side, other),
        "no D": text.replace(" D1", ""),
        "no compensation": text.replace(f"{side} D1 ", ""),
        "off too early": text.replace(lines[lead + 4], "G40 " + lines[lead + 4]),
        "another D": text.replace("D1", "D2", 1).replace("G40", "D1 G40", 1),
    }.items():
        if name == "another D":
            proof = api.verify(
                forged.encode(), against=SAMPLES / "key-punch.dxf", name="x.nc",
                offset=0.1, profile="iso-g41", d=((2, 110.0), (1, 100.0)),
            )  # fmt: skip
        else:
            proof = verified(forged.encode())
        assert not proof.ok, name


def test_a_coordinate_off_by_10_um_is_refused():
    lines = compiled("key-punch.dxf").data.decode().splitlines()
    tried = 0
    for i, line in enumerate(lines):
        found = re.fullmatch(r"(G0[123] X)(-?\d+)( .*)", line)
        if found and i % 5 == 0:
            forged = [*lines]
            forged[i] = f"{found[1]}{int(found[2]) + 10}{found[3]}"
            assert not verified("\n".join(forged).encode()).ok, line
            tried += 1
    assert tried > 5


def test_a_lead_below_the_offset_is_refused():
    lines = compiled("key-punch.dxf").data.decode().splitlines()
    lead = next(i for i, line in enumerate(lines) if "D1" in line)
    x, y = (int(v) for v in re.search(r"X(-?\d+) Y(-?\d+)", lines[lead]).groups())
    far = (x * x + y * y) ** 0.5
    near = [round(v * 90 / far) for v in (x, y)]
    forged = [*lines]
    forged[lead] = re.sub(r"X-?\d+ Y-?\d+", f"X{x - near[0]} Y{y - near[1]}", lines[lead])
    forged[lead] = re.sub(r"X-?\d+ Y-?\d+", f"X{near[0]} Y{near[1]}", lines[lead])
    forged.insert(lead, f"G01 X{x - near[0]} Y{y - near[1]}")
    proof = verified("\n".join(forged).encode())
    assert [d.code for d in proof.findings if d.severity.name == "ERROR"] == ["compensation-lead"]


def test_certificates_hold_what_is_entered(tmp_path):
    made = compiled("plate.dxf")
    proof = api.verify(
        made.data,
        against=SAMPLES / "plate.dxf",
        name="x.nc",
        certificate=made.summary,
        options=made.options,
        profile="iso-g41",
    )
    assert proof.ok
    assert proof.summary["d_um"] == {"1": 100.0}
    assert made.entries.lines() == [("D1", "0.1000 mm")]


def test_a_part_program_says_by_how_much_the_controller_offsets():
    """Neither --d nor a certificate: the offsets of the cuts are the table."""
    one = b"contour a { circle center (0, 0) radius 5 }\ncut a inside offset 0.1 start (0, 0)\n"
    two = one + (
        b"contour b { circle center (0, 0) radius 9 }\ncut b outside offset 0.15 start (11, 0)\n"
    )
    for source in (one, two):
        made = api.compile(source, name="a.wed", profile="iso-g41-mm")
        assert made.ok
        proof = api.verify(
            made.data, against=source, against_name="a.wed", name="a.nc", profile="iso-g41-mm"
        )
        assert proof.status == 0, [d.message for d in proof.findings]
        (said,) = [d for d in proof.findings if d.code == "iso-compensation"]
        assert "0.1000 mm" in said.message
        other = source.replace(b"radius 5", b"radius 5.01")
        proof = api.verify(
            made.data, against=other, against_name="a.wed", name="a.nc", profile="iso-g41-mm"
        )
        assert proof.status == 3


def test_a_drawing_without_an_offset_says_nothing_of_it():
    drawing = (SAMPLES / "cam.dxf").read_bytes()
    made = api.compile(drawing, offset=0.1, profile="iso-g41-mm")
    assert made.ok
    proof = api.verify(made.data, against=drawing, name="a.nc", profile="iso-g41-mm")
    assert proof.status == 1
    assert "iso-compensation" in {d.code for d in proof.findings}

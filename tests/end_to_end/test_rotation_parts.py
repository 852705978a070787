"""compile --to rotation: one figure and a number, proven with what the operator enters."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from test_cli_programs import run, status

import wedmcam
from drawings import drawing
from wedmcam import api
from wedmcam.controllers.zd065.data import displacements
from wedmcam.frontends.zd065.rotation import read
from wedmcam.machines import builtin
from wedmcam.targets.entries import Entries

SAMPLES = Path(__file__).parents[2] / "samples"
GEAR = (SAMPLES / "gear.wed").read_text().replace("cut bore inside offset 0.1\n", "")
M = builtin("zd065-rotation")


def polygon(corners, radius=10.0, turned=0.3, more=""):
    """A .wed program of a regular polygon."""
    places = [
        (
            radius * math.cos(2 * math.pi * k / corners + turned),
            radius * math.sin(2 * math.pi * k / corners + turned),
        )
        for k in range(corners)
    ]
    first, *rest = (f"({x:.9f}, {y:.9f})" for x, y in places)
    lines = " ".join(f"line to {place}" for place in rest)
    return f"contour p {{ from {first} {lines} close }}\ncut p outside offset 0.1 {more}\n".encode()


def rotor(order, radius=20.0, deep=4.0, half=1.2, units=4):
    """A drawing of ``order`` slots with round bottoms in a rim, as one LWPOLYLINE."""
    rows = []
    out = math.sqrt(radius**2 - half**2)
    rim = math.tan((2 * math.pi / order - 2 * math.asin(half / radius)) / 4)
    for k in range(order):
        z = complex(math.cos(2 * math.pi * k / order), math.sin(2 * math.pi * k / order))
        slot = (
            (complex(out, -half), 0),
            (complex(out - deep, -half), -1.0),
            (complex(out - deep, half), 0),
            (complex(out, half), rim),
        )
        for place, bulge in slot:
            rows.append(((place * z).real, (place * z).imag, bulge))

    def draw(doc, msp):
        msp.add_lwpolyline(rows, format="xyb", close=True)

    return drawing(draw, units=units)


def closing_um(data, entered):
    """Where the last copy ends from where the first begins, as the bytes state it."""
    figure, _ = read(data, M, "a.zdr")
    turns = np.exp(1j * np.radians(entered["angle_deg"] * np.arange(entered["copies"] + 1)))
    return abs(displacements(figure).sum() * turns.sum())


def said(made, code):
    return [d for d in made.findings if d.code == code]


def test_a_gear_is_one_tooth():
    made = wedmcam.compile(GEAR.encode(), to="rotation", name="gear.wed")
    assert made.ok, made.findings
    figure, _ = read(made.data, M, "a.zdr")
    assert len(figure) == 7
    assert len(made.data) < 100
    entered = made.summary["entered"]
    assert (entered["copies"], entered["angle_deg"]) == (23, 15.0)
    assert entered["lead_in_um"] == [0, -2900]
    assert entered["lead_out_um"] == [0, 2900]
    assert closing_um(made.data, entered) <= 0.3
    assert made.summary["closure_um"] == 0
    (told,) = said(made, "figure-repeated")
    assert told.values["off_um"] < 0.5
    assert told.values["drift_um"] <= told.values["limit_um"]


@pytest.mark.parametrize("order", [2, 3, 5, 7, 24, 36, 48])
def test_a_rotor_of_any_number_of_slots(order):
    part = rotor(order, 20.0 if order <= 36 else 60.0)
    made = wedmcam.compile(part, to="rotation", name="rotor.dxf", offset=0.1)
    assert made.ok, made.findings
    entered = made.summary["entered"]
    assert entered["copies"] == order - 1
    assert entered["angle_deg"] == pytest.approx(360 / order, abs=1e-5) or order == 2
    assert closing_um(made.data, entered) <= 0.3
    proof = api.verify(
        made.data, against=part, name="a.zdr", against_name="rotor.dxf", offset=0.1,
        entered=Entries.from_data(entered),
    )  # fmt: skip
    assert proof.ok, proof.findings


@pytest.mark.parametrize("corners", [3, 4, 5, 6, 7, 9, 36, 97])
def test_regular_polygons_whose_sides_are_no_whole_um(corners):
    """Nothing is written that does not come back; what is written is proven."""
    made = wedmcam.compile(polygon(corners), to="rotation", name="p.wed")
    assert made.ok, made.findings
    assert made.summary["closure_um"] == 0
    if made.summary.get("entered"):
        assert closing_um(made.data, made.summary["entered"]) <= 0.3


def test_more_figures_than_copies_are_figures_of_several():
    made = wedmcam.compile(polygon(120), to="rotation", name="p.wed")
    assert made.ok
    assert made.summary["entered"]["copies"] == 59
    (told,) = said(made, "figure-repeated")
    assert "a figure is 2 of them: the controller makes 99 copies" in told.message


def test_what_the_copies_take_in_memory_is_said():
    """One of 36 slots is 175 bytes; the cutting data of all are more than the memory."""
    made = wedmcam.compile(SAMPLES / "stator-36.dxf", to="rotation", cuts=(1, 1), offset=0.1)
    assert made.ok
    assert len(made.data) < 200
    (told,) = said(made, "over-memory")
    assert told.values["bytes"] > 4096
    assert told.values["loads"] == 2


def test_a_prime_number_of_them_is_said():
    made = wedmcam.compile(polygon(101), to="rotation", name="p.wed")
    assert made.ok
    assert "entered" not in made.summary
    (told,) = said(made, "not-repeated")
    assert "repeats 101 times" in told.message
    assert "up to 99 copies" in told.message


def test_of_several_cuts_it_is_said_which_repeats():
    made = wedmcam.compile(SAMPLES / "gear.wed", to="rotation")
    assert made.ok
    (told,) = said(made, "not-repeated")
    assert "cut 2 repeats 24 times" in told.message
    assert told.hint == "--cuts 2 makes a file of this cut alone"
    alone = wedmcam.compile(SAMPLES / "gear.wed", to="rotation", cuts=(2, 2))
    assert alone.ok
    assert alone.summary["entered"]["copies"] == 23


@pytest.mark.parametrize("more", ["stop 1", "overcut 0.5"])
def test_what_stands_in_the_last_copy_alone(more):
    made = wedmcam.compile(polygon(6, more=more), to="rotation", name="p.wed")
    assert made.ok, made.findings
    assert "entered" not in made.summary
    assert "in the last copy alone" in said(made, "not-repeated")[0].message


def test_a_plain_part_is_one_figure_as_before():
    made = wedmcam.compile(SAMPLES / "key-punch.dxf", to="rotation", offset=0.1)
    assert made.ok, made.findings
    assert "entered" not in made.summary
    assert not said(made, "not-repeated")
    proof = api.verify(made.data, against=SAMPLES / "key-punch.dxf", name="a.zdr", offset=0.1)
    assert proof.ok, proof.findings


@pytest.mark.parametrize("units", [1, 4])
def test_a_drawing_in_inches(units):
    part = rotor(9, 1.0, 0.2, 0.06, 1) if units == 1 else rotor(9, 25.4, 5.08, 1.524)
    made = wedmcam.compile(part, to="rotation", name="rotor.dxf", offset=0.1)
    assert made.ok, made.findings
    assert made.summary["entered"]["copies"] == 8


def test_an_open_chain_of_copies():
    """Five steps of a stair that winds about a centre: no contour, a figure and its copies."""
    rows, at = [0j], 0j
    for k in range(5):
        z = complex(math.cos(math.radians(30 * k)), math.sin(math.radians(30 * k)))
        for way in (3, 2j):
            at += way * z
            rows.append(at)
    part = drawing(lambda doc, msp: msp.add_lwpolyline([(p.real, p.imag) for p in rows]))
    made = wedmcam.compile(part, to="rotation", name="a.dxf", side="on")
    assert made.ok, made.findings
    assert made.summary["entered"]["copies"] == 4
    assert made.summary["entered"]["angle_deg"] in (30, -30)  # from either end
    assert made.summary["entered"]["lead_out_um"] is None


# --- command line ---------------------------------------------------------------------------------


@pytest.fixture
def gear(tmp_path):
    part = tmp_path / "gear.wed"
    part.write_text(GEAR)
    done = run("compile", part, "-o", tmp_path / "gear.zdr", "--certificate", tmp_path / "g.json",
               "--setup-sheet", tmp_path / "sheet.txt")  # fmt: skip
    assert status(done) == 0, done.output
    return tmp_path, done


ENTERED = ["--copies", "23", "--angle", "15", "--lead-in", "0,-2.9", "--lead-out", "0,2.9"]


def test_what_is_entered_is_told(gear):
    folder, done = gear
    line = "copies 23, angle 15 deg, lead-in X 0.000 Y -2.900 mm, lead-out X 0.000 Y 2.900 mm"
    assert f"enter      {line}, at the controller" in done.stderr
    sheet = (folder / "sheet.txt").read_text()
    for name in ("copies", "angle", "lead-in", "lead-out"):
        assert f"{name}, to be entered" in sheet
    told = json.loads((folder / "g.json").read_text())["entered"]
    assert told == {"copies": 23, "angle_deg": 15.0, "lead_in_um": [0, -2900],
                    "lead_out_um": [0, 2900]}  # fmt: skip


def test_convert_makes_the_cutting_data(gear):
    folder, _ = gear
    out = folder / "gear.zd"
    assert status(run("convert", folder / "gear.zdr", "-o", out, *ENTERED)) == 0
    proof = run("verify", out, "--against", folder / "gear.wed")
    assert status(proof) == 0, proof.output


def test_verify_with_what_is_entered(gear):
    folder, _ = gear
    against = ["--against", folder / "gear.wed"]
    done = run("verify", folder / "gear.zdr", *ENTERED, *against)
    assert status(done) == 0, done.output
    assert "no-leads" not in done.stderr
    by_certificate = run(
        "verify", folder / "gear.zdr", "--certificate", folder / "g.json", *against
    )
    assert status(by_certificate) == 0, by_certificate.output


def test_verify_without_leads_says_so(gear):
    folder, _ = gear
    done = run("verify", folder / "gear.zdr", *ENTERED[:4], "--against", folder / "gear.wed")
    assert status(done) == 0, done.output
    assert "note[no-leads]" in done.stderr
    assert "starts on the contour at (0.000, 13.100) mm" in done.stderr


@pytest.mark.parametrize(
    "wrong",
    [
        ["--copies", "22", "--angle", "15", "--lead-in", "0,-2.9", "--lead-out", "0,2.9"],
        ["--copies", "23", "--angle", "-15", "--lead-in", "0,-2.9", "--lead-out", "0,2.9"],
        ["--copies", "23", "--angle", "15.01", "--lead-in", "0,-2.9", "--lead-out", "0,2.9"],
        ["--copies", "23", "--angle", "15", "--lead-in", "0,-3.1", "--lead-out", "0,2.9"],
        ["--copies", "23", "--angle", "15", "--lead-in", "0.5,-2.9", "--lead-out", "0,2.9"],
        [],
    ],
)
def test_verify_with_other_entries_fails(gear, wrong):
    folder, _ = gear
    done = run("verify", folder / "gear.zdr", *wrong, "--against", folder / "gear.wed")
    assert status(done) == 3, done.output


@pytest.mark.parametrize(
    ("more", "text"),
    [
        (["--copies", "100", "--angle", "3.6"], "the controller makes 0 to 99"),
        (["--copies", "3"], "go together"),
        (["--angle", "3"], "go together"),
        (["--copies", "3", "--angle", "0"], "without an angle"),
        (["--copies", "-1", "--angle", "3"], "the controller makes 0 to 99"),
        (["--lead-in", "0.00005,1"], "--lead-in is whole um"),
        (["--lead-out", "1200,0"], "999.999 mm"),
    ],
)
@pytest.mark.parametrize("command", ["convert", "verify"])
def test_entries_that_are_none(gear, command, more, text):
    folder, _ = gear
    out = ["-o", folder / "b.zd"] if command == "convert" else []
    done = run(command, folder / "gear.zdr", *out, *more)
    assert status(done) == 2
    assert text in str(done.exception)


def test_entries_of_a_format_that_takes_none(gear):
    folder, _ = gear
    (folder / "a.3b").write_text("B1000B0B1000GXL1\nDD\n")
    for more in (["--lead-in", "0,1"], ["--copies", "3", "--angle", "9"]):
        done = run("verify", folder / "a.3b", *more)
        assert status(done) == 2
        assert "in rotation format, not" in str(done.exception)


def test_a_certificate_that_was_changed(gear):
    folder, _ = gear
    told = json.loads((folder / "g.json").read_text())
    told["entered"]["copies"] = 22
    (folder / "g.json").write_text(json.dumps(told))
    done = run("verify", folder / "gear.zdr", "--certificate", folder / "g.json",
               "--against", folder / "gear.wed")  # fmt: skip
    assert status(done) == 3


def test_a_figure_that_does_not_close_is_said(tmp_path):
    """A side of a hexagon of 5 mm, 60.01 degrees from copy to copy."""
    figure = tmp_path / "a.zdr"
    figure.write_bytes(bytes.fromhex("01 02 30000000 005000 00"))
    good = run("verify", figure, "--copies", "5", "--angle", "60")
    assert "figure-drift" not in good.stderr
    done = run("convert", figure, "-o", tmp_path / "a.zd", "--copies", "5", "--angle", "60.01")
    assert "warning[figure-drift]: 6 figures of 60.01 degrees come round" in done.stderr


def test_several_formats_at_once(tmp_path):
    part = tmp_path / "gear.wed"
    part.write_text(GEAR)
    done = run("compile", part, "--to", "compact,rotation", "-o", tmp_path / "gear")
    assert status(done) == 0, done.output
    assert (tmp_path / "gear.zdr").exists()


def test_an_arc_of_10_m_is_converted(tmp_path):
    """R 10 m over 5 degrees takes more than 999,999 steps, and its J is 735,765."""
    figure = tmp_path / "a.zdr"
    figure.write_bytes(
        bytes.fromhex("21 02 30000000 10000000 01 50000000 02 03 12000000 001000 00")
    )
    done = run("convert", figure, "-o", tmp_path / "a.zd", "--copies", "3", "--angle", "90")
    assert status(done) == 0, done.output
    figure.write_bytes(bytes.fromhex("21 02 30000000 10000001 01 50000000 00"))
    done = run("verify", figure)
    assert "block 1: the radius is 10000.001 mm, the largest is 10000.000 mm" in done.stderr


def test_no_copies_are_a_figure_as_it_is(gear):
    folder, _ = gear
    done = run("verify", folder / "gear.zdr", "--copies", "0", "--angle", "15")
    assert status(done) == 0, done.output


@pytest.mark.parametrize(("order", "side", "offset"), [(97, "die", 0.05), (97, "part", 0.05)])
def test_small_fillets_that_no_figure_holds_are_written_without_copies(order, side, offset):
    """Slots of 97 with fillets of 0.1 mm: what the cutting format holds, this holds too."""
    made = wedmcam.compile(
        filleted(order), to="rotation", name="r.dxf", offset=offset, side=side, cuts=(1, 1)
    )
    assert made.ok, made.findings
    assert made.summary["closure_um"] == 0


def filleted(order, radius=60.0, deep=3.0, half=0.8, fillet=0.1):
    """A drawing of a ring of slots; all their corners are rounded."""
    out = math.sqrt(radius**2 - half**2)
    slot = [complex(out, -half), complex(out - deep, -half), complex(out - deep, half),
            complex(out, half)]  # fmt: skip
    turns = np.exp(2j * np.pi * np.arange(order) / order)
    corners = np.concatenate([np.array(slot) * z for z in turns])
    rows = []
    for a, b, c in zip(np.roll(corners, 1), corners, np.roll(corners, -1), strict=True):
        u, v = (a - b) / abs(a - b), (c - b) / abs(c - b)
        between = math.acos((u * v.conjugate()).real)
        cut = fillet / math.tan(between / 2)
        bulge = math.tan((math.pi - between) / 4) * np.sign(((b - a).conjugate() * (c - b)).imag)
        rows += [((b + u * cut).real, (b + u * cut).imag, bulge)]
        rows += [((b + v * cut).real, (b + v * cut).imag, 0)]
    return drawing(lambda doc, msp: msp.add_lwpolyline(rows, format="xyb", close=True))

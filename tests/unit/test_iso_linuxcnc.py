"""Profiles `linuxcnc` and `grbl`: what is written runs unedited, and is read as it is run."""

import math
import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

import wedmcam
from wedmcam import api, machines
from wedmcam.diag import Severity
from wedmcam.judge.difference import difference
from wedmcam.operations import convert

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "samples"
NAMES = sorted(p.name for p in SAMPLES.iterdir() if p.suffix in (".dxf", ".wed"))
HEADER = ["G21 G17 G40 G80 G61 G91.1 G94", "G90"]
#: LinuxCNC's own interpreter; a path in WEDMCAM_RS274 serves where it is not installed.
RS274 = os.environ.get("WEDMCAM_RS274") or shutil.which("rs274")


@cache
def made(name, profile="linuxcnc", **more):
    options = {"units": "mm"} if name == "damaged.dxf" else {}
    if name.endswith(".dxf"):
        options["offset"] = 0.1
    one = wedmcam.compile(SAMPLES / name, profile=profile, **options, **more)
    assert one.ok, [d.message for d in one.findings]
    return one


def lines(name, profile="linuxcnc", **more):
    return made(name, profile, **more).data.decode().splitlines()


def codes(found, least=Severity.WARNING):
    return [d.code for d in found if d.severity >= least]


def read(text, profile="linuxcnc", **said):
    program, _, found = api.read_program(text.encode(), profile=profile, name="a.nc", **said)
    return program, found


@pytest.mark.parametrize("profile", ["linuxcnc", "grbl"])
def test_the_opening_states_every_mode_and_sets_no_offset(profile):
    text = lines("plate.dxf", profile, feed=2.5)
    assert text[:4] == [*HEADER, "F2.5", "G00 X10.000 Y10.000"]
    assert text[-1] == "M02"
    assert not [t for t in text if "G92 " in t or "%" in t or "G41" in t]


def test_a_feed_that_was_not_given_is_said():
    assert codes(made("plate.dxf").findings) == ["not-cut", "feed-assumed"]
    assert lines("plate.dxf")[2] == "F1.0"
    assert "feed-assumed" not in codes(made("plate.dxf", feed=0.0001).findings)
    assert lines("plate.dxf", feed=0.0001)[2] == "F0.0001"
    assert made("plate.dxf", feed=2.5).options.as_data()["feed_um"] == 2500.0


def test_f_counts_pulses_as_places_do():
    text = machines.text("linuxcnc") + "[axes]\nstep_um = 2\n"
    machine, found = machines.parse(text, "p")
    assert found == []
    one = wedmcam.compile(SAMPLES / "plate.dxf", profile=machine, offset=0.1, feed=3.0)
    assert one.data.decode().splitlines()[2:4] == ["F1.5", "G00 X5.000 Y5.000"]


@pytest.mark.parametrize("name", NAMES)
def test_samples_are_read_as_they_are_written(name):
    """Stepped, and converted to 3B, it is the path of the 3B program of the same source."""
    one, other = made(name), made(name, "b3-compact")
    program, found = read(one.data.decode())
    assert codes(found) == []
    assert difference(program, one.program, *[one.machine.stepping] * 2).equal
    done = convert.convert(one.data, to="3b", profile_in="linuxcnc", name="a.nc")
    assert done.ok, [d.message for d in done.findings]
    ways = done.machine.stepping, other.machine.stepping
    assert difference(done.program_out, other.program, *ways, 2.0).equal


@pytest.mark.parametrize("name", NAMES)
def test_arcs_are_inside_the_tolerance_of_both(name):
    """Radii at start and end: an error from 0.005 mm and 0.1 % on, in LinuxCNC and in GRBL."""
    x = y = 0.0
    for line in lines(name)[3:]:
        at = {k: float(v) for k, v in re.findall(r"([XYIJ])([-\d.]+)", line)}
        if not at:
            continue
        if "I" in at:
            cx, cy = x + at["I"], y + at["J"]
            radius, end = math.hypot(at["I"], at["J"]), math.hypot(at["X"] - cx, at["Y"] - cy)
            assert abs(radius - end) < 0.0025
            assert radius > 0.00127  # LinuxCNC: RADIUS_TOLERANCE_MM
            assert (at["X"], at["Y"]) != (x, y)
        x, y = at["X"], at["Y"]


@pytest.mark.skipif(
    RS274 is None,
    reason="LinuxCNC's interpreter rs274 is not here: apt install linuxcnc-uspace (Debian), or "
    "unpack that package and name its rs274 in WEDMCAM_RS274",
)
@pytest.mark.parametrize("name", NAMES)
def test_linuxcnc_takes_all_samples(name, tmp_path):
    program = tmp_path / "a.ngc"
    program.write_bytes(made(name, feed=2.0).data)
    (tmp_path / "tool.tbl").write_text("")
    (tmp_path / "a.var").write_text("")
    run = [RS274, "-t", "tool.tbl", "-v", "a.var", "-g", program.name]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[-500:]
    assert "PROGRAM_END" in done.stdout
    motion = r"(?:STRAIGHT_TRAVERSE|STRAIGHT_FEED|ARC_FEED)\((-?[\d.]+), (-?[\d.]+)"
    goes = [(float(x), float(y)) for x, y in re.findall(motion, done.stdout)]
    stated = [re.search(r"X([-\d.]+) Y([-\d.]+)", t) for t in lines(name)]
    assert goes == [(float(m[1]), float(m[2])) for m in stated if m]


@pytest.mark.parametrize("name", NAMES)
def test_grbl_knows_every_word(name):
    text = lines(name, "grbl")
    known = {"G00", "G01", "G02", "G03", "M00", "M02", *" ".join(HEADER).split()}
    for line in text:
        assert len(line) <= 60  # LINE_BUFFER_SIZE is 80
        assert {w for w in line.split() if w[0] not in "XYIJF"} <= known


def test_the_first_g00_is_the_start_and_the_second_a_move():
    text = "G21 G90 G80\nG00 X5. Y7.\nG01 X6. Y7.\nG01 X6. Y9.\nM00\nG00 X1. Y1.\nM02\n"
    program, found = read(text)
    assert codes(found) == []
    assert program.blocks["x"].tolist()[:2] == [1000, 0]
    assert program.blocks["x"].tolist()[3] == -5000
    other, _ = read(text, "iso-mm")
    assert other.blocks["x"].tolist()[0] == 5000  # that profile starts at its G92, or at zero


def test_a_program_that_begins_with_a_cut_starts_at_zero():
    program, _ = read("G21 G90 F2.\nG01 X6. Y7.\nG01 X6. Y9.\nM02\n")
    assert program.blocks["x"].tolist()[0] == 6000


def test_g91_1_says_what_i_and_j_are():
    text = "G21 G90 G91.1\nG00 X5. Y0.\nG03 X5. Y0. I-5. J0.\nM02\n"
    _, found = read(text)
    assert codes(found) == []
    program, found = read(text, centres_in="absolute")
    assert codes(found) == ["iso-stated"]
    assert program.blocks["x"].tolist()[0] == 5000
    program, found = read(text.replace("G91.1", "G90.1").replace("I-5. J0.", "I0. J0."))
    assert codes(found) == []
    assert program.blocks["x"].tolist()[0] == 5000


BASE = 'title = "t"\nformat = "{}"\nline_table = "rotate"\n[limits]\ncount_um = 999999\n'
BASE += "line_um = 999999\narc_um = 999999\n"


@pytest.mark.parametrize(
    ("format_", "more", "what"),
    [
        ("iso", '[iso]\nstart = "move"\n', "coordinates"),
        ("iso", "[iso]\nfeed_um = 5\n", 'unit = "mm"'),
        ("3b", '[layout]\nheader = ["G21"]\n', "semicolon"),
        ("3b", "[iso]\nfeed_um = 5\n", "feed_um"),
        ("iso", '[layout]\nheader = ["G21\\nG01 X5"]\n', "lines"),
    ],
)
def test_what_a_profile_cannot_say(format_, more, what):
    machine, found = machines.parse(BASE.format(format_) + more, "p")
    assert machine is None
    assert what in found[0].message


def test_header_and_footer_of_iso_are_free_and_proven():
    more = '[layout]\nheader = ["%", "(PLATE)", "G21 G40"]\nfooter = ["%"]\n'
    machine, found = machines.parse(BASE.format("iso") + more, "p")
    assert found == []
    one = wedmcam.compile(SAMPLES / "plate.dxf", profile=machine, offset=0.1)
    assert one.ok
    assert one.data.decode().splitlines()[:3] == ["%", "(PLATE)", "G21 G40"]
    moved, _ = machines.parse(BASE.format("iso") + '[layout]\nheader = ["G91 G01 X50"]\n', "p")
    assert not wedmcam.compile(SAMPLES / "plate.dxf", profile=moved, offset=0.1).ok


@pytest.mark.parametrize("profile", ["linuxcnc", "grbl"])
def test_the_example_of_the_page_is_read(profile):
    page = (ROOT / "docs" / f"iso-{profile}.md").read_text("utf-8")
    text = re.search(r"```gcode\n(.*?)```", page, re.S)[1]
    program, found = read(text, profile)
    assert codes(found) == []
    assert len(program.blocks) > 5


def test_an_arc_that_linuxcnc_takes_for_none_is_a_line():
    """Rounding leaves 1.0 um at the end of an arc of 1.4 um: its limit is 1.27 um."""
    part = (
        b"units mm contour q { from (0, 0) line to (10, 0) line to (13, 7) line to (4, 9.5) "
        b"close } cut q outside offset 0.0005 start (-2, 3)"
    )
    made = api.compile(part, name="q.wed", profile="linuxcnc", feed=2.0)
    assert made.ok
    assert b"G03" not in made.data
    assert b"G03" in api.compile(part, name="q.wed", profile="grbl", feed=2.0).data

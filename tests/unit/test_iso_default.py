"""What `.nc` is written as where no profile is named: mm with a point, and the file says so."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam import api, machines
from wedmcam.cli.main import cli
from wedmcam.diag import Severity
from wedmcam.judge.difference import difference
from wedmcam.operations import convert
from wedmcam.options import WrongUse

SAMPLES = Path(__file__).parents[2] / "samples"
NAMES = sorted(p.name for p in SAMPLES.iterdir() if p.suffix in (".dxf", ".wed"))
PUNCH = str(SAMPLES / "key-punch.dxf")
NOTE = "profile iso-mm (before: iso-um)"


def options(name):
    more = {"units": "mm"} if name == "damaged.dxf" else {}
    return more | ({"offset": 0.1} if name.endswith(".dxf") else {})


def run(*line):
    done = CliRunner().invoke(cli, [*map(str, line)], standalone_mode=False)
    return done.return_value or 0, done.stdout, done.stderr


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_is_read_back_without_a_question(name):
    made = wedmcam.compile(SAMPLES / name, to="iso", **options(name))
    assert made.ok
    text = made.data.decode()
    assert text.startswith("G21\r\nG92 X")
    assert text.splitlines()[2] == "G90"
    done = convert.convert(made.data, to="3b", name="part.nc")
    assert done.ok, [d.message for d in done.findings]
    assert not [d for d in done.findings if d.severity > Severity.NOTE]
    ways = made.machine.stepping, done.machine.stepping
    assert difference(made.program, done.program_out, *ways, 1.0).equal


def test_outlines_state_their_unit_too():
    made = wedmcam.compile(PUNCH, profile="iso-g41-mm", offset=0.1)
    assert made.data.startswith(b"G21\r\n")
    proof = api.verify(made.data, name="a.nc", against=PUNCH, offset=0.1)
    assert proof.ok, [d.message for d in proof.findings]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (("compile", PUNCH, "-o", "a.nc"), True),
        (("compile", PUNCH, "-o", "a", "--to", "3b,iso"), True),
        (("compile", PUNCH, "-o", "a.nc", "--split"), True),
        (("check", PUNCH, "--to", "iso"), True),
        (("batch", PUNCH, "-o", "out", "--to", "iso"), True),
        (("compile", PUNCH, "-o", "a.nc", "--profile", "iso-mm"), False),
        (("compile", PUNCH, "-o", "a.nc", "--profile", "iso-um"), False),
        (("compile", PUNCH, "-o", "a", "--to", "3b,iso", "--profile", "linuxcnc"), False),
        (("compile", PUNCH, "-o", "a", "--to", "3b,iso", "--profile", "b3-columns"), True),
        (("compile", PUNCH, "-o", "a.3b"), False),
        (("compile", PUNCH, "-o", "a.dxf"), False),
    ],
)
def test_who_names_no_profile_is_told_once(here, line, said):
    status, out, err = run(*line, "--offset", "0.1", "--json")
    assert status == 0, err
    assert err.count(NOTE) == said
    assert ("--profile iso-um" in err) is said
    assert ("default-profile" in out) is said


def test_what_is_refused_was_not_written_with_any_profile(here):
    status, _, err = run("compile", PUNCH, "-o", "a.nc", "--offset", "3")
    assert status == 1
    assert NOTE not in err


def test_convert_says_it_and_settings_name_a_profile(here):
    assert run("compile", PUNCH, "-o", "a.3b", "--offset", "0.1")[0] == 0
    status, out, err = run("convert", "a.3b", "-o", "a.nc", "--json")
    assert (status, err.count(NOTE), out.count("default-profile")) == (0, 1, 1)
    assert NOTE not in run("convert", "a.3b", "-o", "b.nc", "--profile", "iso-mm")[2]
    Path("wedmcam.toml").write_text('profile = "iso-mm"\n')
    Path("part.dxf").write_bytes(Path(PUNCH).read_bytes())
    for line in (
        ("convert", "a.3b", "-o", "c.nc"),
        ("compile", "part.dxf", "-o", "d.nc", "--offset", "0.1"),
        ("batch", "part.dxf", "-o", "out", "--to", "iso", "--offset", "0.1"),
    ):
        status, _, err = run(*line)
        assert status == 0, err
        assert NOTE not in err, line


def test_a_certificate_of_the_default_names_its_profile(here):
    line = ("compile", PUNCH, "-o", "a.nc", "--offset", "0.1", "--certificate", "a.json")
    assert run(*line)[0] == 0
    issued = json.loads(Path("a.json").read_text())
    assert issued["profile"] == "iso-mm"
    status, _, err = run("verify", "a.nc", "--certificate", "a.json", "--against", PUNCH)
    assert status == 0, err
    assert "certificate-differs" not in err


def test_programs_of_before_are_read_with_their_certificate(here):
    """Of iso-um nothing changed; iso-mm had no G21, and its certificate was of another profile."""
    um = wedmcam.compile(PUNCH, profile="iso-um", offset=0.1)
    proof = api.verify(um.data, name="a.nc", against=PUNCH, certificate=um.summary)
    assert proof.ok
    assert not [d for d in proof.findings if d.code == "certificate-differs"]
    assert not api.verify(um.data, name="a.nc", against=PUNCH, offset=0.1).ok  # asked
    mm = machines.builtin("iso-mm")
    old = replace(mm, iso=replace(mm.iso, modes=""))
    made = wedmcam.compile(PUNCH, profile=old, offset=0.1)
    assert made.data.startswith(b"G92 ")
    issued = {k: v for k, v in made.summary.items() if k != "profile_toml"}
    proof = api.verify(made.data, name="a.nc", against=PUNCH, certificate=issued)
    assert proof.ok, [d.message for d in proof.findings]


def test_what_is_assumed_of_a_program_that_is_shown_stays():
    text = b"G01 X5000 Y0\nM02\n"
    program, machine, found = api.read_program(text, name="a.nc", shown=True)
    assert machine.name == "iso-um"
    assert program.blocks["x"][0] == 5000
    assert [d.message.split(".")[0] for d in found if d.severity is Severity.WARNING] == [
        "assumed: incremental (G91)",
        "assumed: whole numbers are um",
    ]


@pytest.mark.parametrize("ending", ["nc", "ngc", "gcode", "iso", "eia", "NC", "Ngc", "EIA"])
def test_endings_of_g_code_are_known_everywhere(here, ending):
    name = f"a.{ending}"
    assert run("compile", PUNCH, "-o", name, "--offset", "0.1")[0] == 0
    assert Path(name).read_text().startswith("G21\n")
    for line in (
        ("verify", name),
        ("dump", name),
        ("plot", name, "-o", "a.svg"),
        ("explain", name, "--block", "2"),
        ("convert", name, "-o", "a.3b"),
        ("convert", "a.3b", "-o", f"b.{ending}"),
        ("compile", PUNCH, "-o", f"c.{ending}", "--offset", "0.1", "--to", "3b,iso"),
    ):
        status, _, err = run(*line)
        assert status == 0, err
    assert Path(f"b.{ending}").read_text().startswith("G21\n")
    assert Path(f"c.{ending}").read_bytes() == Path(name).read_bytes()
    assert Path("c.3b").exists()
    # A shop's profile of ISO is for all of them, and is no profile of 3B.
    Path("wedmcam.toml").write_text('profile = "linuxcnc"\n')
    Path("part.dxf").write_bytes(Path(PUNCH).read_bytes())
    line = ("compile", "part.dxf", "--offset", "0.1", "--feed", "2")
    assert run(*line, "-o", f"d.{ending}")[0] == 0
    assert "G91.1" in Path(f"d.{ending}").read_text()
    assert run(*line, "-o", "d.3b")[0] == 0
    with pytest.raises(WrongUse, match="is a program"):
        raise CliRunner().invoke(cli, ["check", name], standalone_mode=False).exception


def test_the_ending_that_is_written_by_itself_is_nc(here):
    Path("a.dxf").write_bytes(Path(PUNCH).read_bytes())
    assert run("batch", "a.dxf", "-o", "out", "--to", "iso", "--offset", "0.1")[0] == 0
    assert [p.name for p in Path("out").iterdir()] == ["a.nc"]
    assert run("compile", "a.dxf", "-o", "b", "--to", "3b,iso", "--offset", "0.1")[0] == 0
    assert Path("b.nc").exists()
    status, _, err = run("compile", "a.dxf", "-o", "b.ngc", "--to", "3b", "--offset", "0.1")
    assert (status, "says iso, but 3b is written" in err) == (0, True)

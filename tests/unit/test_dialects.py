"""Profiles of wire machines: a program in the style of each is read as its machine means it."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam import api, conversion, machines
from wedmcam.cli.main import cli
from wedmcam.diag import Severity

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "samples"

BASE = 'title = "t"\nformat = "iso"\nline_table = "rotate"\n{}[limits]\ncount_um = 999999\n'
BASE += "line_um = 999999\narc_um = 999999\n"


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


# --- profiles that only read ----------------------------------------------------------------------


@pytest.fixture
def reader(tmp_path):
    path = tmp_path / "reader.toml"
    path.write_text(BASE.format("writes = false\n"))
    return path


@pytest.mark.parametrize(
    "command",
    [
        "compile {}/key.wed -o a.nc --profile reader.toml",
        "compile {}/key.wed --to 3b,iso -o a --profile reader.toml",
        "check {}/key.wed --profile reader.toml",
        "batch {}/key.wed -o out --profile reader.toml",
        "convert a.3b -o a.nc --profile reader.toml",
    ],
)
def test_a_profile_that_only_reads_writes_nothing(reader, monkeypatch, command):
    monkeypatch.chdir(reader.parent)
    Path("a.3b").write_text("B17000B5000B17000GXL1\nB17000B5000B17000GXL3\nDD\n")
    done = CliRunner().invoke(cli, command.format(SAMPLES).split(), standalone_mode=False)
    assert done.return_value == 1, done.output
    assert "error[reads-only]: profile reader reads programs only" in done.output
    assert not [p for p in Path().rglob("*") if p.suffix in (".nc", ".iso")]


def test_a_profile_that_only_reads_reads(reader):
    machine, found = machines.of_file(reader.read_text(), "reader.toml")
    assert found == []
    assert not machine.writes
    text = b"G91\nG01 X5000\nG01 Y5000\nG01 X-5000 Y-5000\nM02\n"
    program, _, found = api.read_program(text, profile=machine, name="a.nc")
    assert errors(found) == []
    for to in ("3b", "wed", "dxf", "svg"):
        done = conversion.convert(text, to=to, profile_in=machine, name="a.nc")
        assert done.ok, [d.message for d in done.findings]
    assert api.verify(text, profile=machine, name="a.nc").ok
    assert len(program.blocks) == 4


def test_only_iso_is_read_alone():
    machine, found = machines.parse(BASE.format("writes = false\n").replace("iso", "3b"), "p")
    assert machine is None
    assert "writes" in found[0].message
    assert all(machines.builtin(name).writes for name in machines.DEFAULTS.values())
    assert wedmcam.compile(SAMPLES / "key.wed", profile="iso-um").ok

"""One program format into another: the same path or nothing."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from wedmcam import machines
from wedmcam.cli.main import cli
from wedmcam.ir.program import Kind
from wedmcam.operations import convert
from wedmcam.targets import target_of
from wedmcam.targets.entries import Entries

GOLDEN = Path(__file__).parents[1] / "golden"


#: Programs that cannot state their unit.
WHOLE_UM = {"plate.um.nc": "iso-um", "plate.fixed.nc": "iso-fixed"}


def codes(made):
    return [d.code for d in made.findings]


@pytest.mark.parametrize("to", ["3b", "compact", "rotation", "compensation", "iso"])
@pytest.mark.parametrize(
    "name",
    [
        *("plate.3b", "gear-24.zd", "cover.nc", "plate.columns.3b"),
        *("plate.um.nc", "plate.fixed.nc"),
    ],
)
def test_golden_programs_become_every_format(name, to):
    made = convert.convert(GOLDEN / name, to=to, profile_in=WHOLE_UM.get(name))
    assert made.ok, codes(made)
    # Between the vertices that a figure states the controller finds the arcs itself.
    assert made.difference.largest_um <= (2 if to == "rotation" else 1)
    assert made.machine.format == to


@pytest.mark.parametrize("name", ["gear-24", "plate", "cover"])
def test_both_compiled_programs_become_each_other(name):
    # One lowering serves both, so nothing is lost on the way.
    text, memory = (GOLDEN / f"{name}.3b").read_bytes(), (GOLDEN / f"{name}.zd").read_bytes()
    assert convert.convert(memory, to="3b", format="compact").data == text
    assert convert.convert(text, to="compact", format="3b").data == memory


def test_an_arc_whose_last_step_does_not_count_on_the_square_ends_in_a_line():
    # Counted on X, the arc from (0, 100) stops at a step along x; y leads there on the square.
    made = convert.convert(b"B100B0B95GYNR1 DD", to="compact")
    assert made.ok, codes(made)
    made = [
        convert.convert(f"B{x}B{y}B{j}G{g}NR1 DD".encode(), to="compact")
        for x, y in ((100, 0), (71, 70), (997, 76))
        for j in range(3, 60, 7)
        for g in "XY"
    ]
    assert all(m.ok for m in made)
    assert any((m.program_out.blocks["kind"] == Kind.LINE).any() for m in made)


@pytest.mark.parametrize("record", ["B9900B0B100000GYNR1", "B71B70B900GXSR1", "B2100B0B8402GYNR1"])
def test_more_than_a_turn_stays_one_arc(record):
    made = convert.convert(f"{record} DD".encode(), to="compact")
    assert made.ok, codes(made)
    assert (made.program_out.blocks["kind"] == Kind.ARC).sum() == 1
    assert convert.convert(made.data, to="3b").difference.largest_um == 0


def test_long_blocks_are_parted():
    wide = convert.convert(b"B900000B900000B900000GYL1 DD", to="rotation")
    assert wide.ok, codes(wide)


def test_what_is_lost_is_said():
    made = convert.convert(b"B17000B5000B17000GXL1\nQUENCH\nDD\nE\n", to="compact")
    assert made.ok
    assert "not-carried" in codes(made)
    assert not convert.convert(b"B17000B5000B17000GXL1\nQUENCH\nDD\n", to="compact", strict=True).ok
    kept = convert.convert(b"B17000B5000B17000GXL1\nQUENCH\nDD\nE\n", to="3b")
    assert b"QUENCH\nDD\nE\n" in kept.data


def test_another_path_is_refused(monkeypatch):
    from wedmcam.backends import b3

    honest = b3.encode

    def forged(program, machine):
        data, found = honest(program, machine)
        return data.replace(b"B17000B5000", b"B17000B5100"), found

    monkeypatch.setattr(b3, "encode", forged)
    made = convert.convert(bytes.fromhex("01 017000 005000 00"), to="3b", format="compact")
    assert not made.ok
    assert made.status == 3
    assert codes(made)[-1] == "conversion-differs"


def test_moves_and_pauses_stay():
    text = (GOLDEN / "plate.3b").read_bytes()
    made = convert.convert(text, to="compact")
    for kind in (Kind.MOVE, Kind.PAUSE):
        count = int(np.sum(made.program.blocks["kind"] == kind))
        assert count
        assert int(np.sum(made.program_out.blocks["kind"] == kind)) == count


def test_a_target_can_be_registered(monkeypatch):
    def as_count(program, machine, name):
        return str(len(program.blocks)).encode(), []

    monkeypatch.setitem(convert.OUTPUTS, "count", "tests_target:f")
    monkeypatch.setattr(convert, "import_module", lambda m: type("M", (), {"f": as_count}))
    made = convert.convert(b"B17000B5000B17000GXL1 DD", to="count")
    assert made.data == b"2"


def test_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.3b").write_bytes(b"B17000B5000B17000GXL1\nDD\n")
    run = CliRunner().invoke
    done = run(cli, ["convert", "a.3b", "-o", "a.zd", "--json"], standalone_mode=False)
    assert done.return_value == 0
    assert '"largest_um": 1.0' in done.stdout or '"largest_um": 0.0' in done.stdout
    assert Path("a.zd").read_bytes().hex() == "0101700000500000"
    assert run(cli, ["convert", "a.3b", "-o", "a.svg"], standalone_mode=False).return_value == 0
    assert Path("a.svg").read_text().startswith("<")
    Path("no.3b").write_bytes(b"nothing")
    assert run(cli, ["convert", "no.3b", "-o", "b.zd"], standalone_mode=False).return_value == 1
    assert not Path("b.zd").exists()
    assert not target_of(machines.default("compact")).is_text


HOLE = "B900B0B900GXL1\nB1900B0B7600GYNR1\nB900B0B900GXL3\n"


def part_of(text, format="3b"):
    data = text if isinstance(text, bytes) else f"{text}DD\n".encode()
    return convert.convert(data, to="wed", format=format)


def test_a_part_program_keeps_the_defaults_of_a_shop_out():
    from wedmcam import api

    made = part_of(HOLE)
    assert b"cut path1 on start (0, 0) enter (0.9, 0) stop 0 overcut 0 corner 0" in made.data
    plain = api.compile(made.data, name="a.wed")
    asked = api.compile(made.data, name="a.wed", stop=1.0, overcut=0.5, corner=0.3)
    assert plain.data == asked.data
    bent = part_of("B2000B0B2000GXL1\nB0B2000B2000GYL2\n")
    assert api.compile(bent.data, name="a.wed", corner=0.3).data == bent_path()


def bent_path():
    return b"B2000B0B2000GXL1\nB0B2000B2000GYL2\nDD\n"


@pytest.mark.parametrize(
    ("text", "said", "line"),
    [
        (f"D\nB5000B0B5000GXL1\nD\n{HOLE}", "begins with a move", 2),
        (f"{HOLE}D\nB5000B0B5000GXL1\nD\n", "ends with a move", 5),
    ],
)
def test_moves_outside_the_cuts_are_left_out_of_a_part_program(text, said, line):
    made = part_of(text)
    assert made.ok, [d.message for d in made.findings]
    assert codes(made) == ["not-carried"]
    assert said in made.findings[0].message
    assert made.findings[0].span.line == line


def test_what_a_part_program_has_no_words_for_is_named():
    twice = part_of("B900B0B900GXL1\nB1900B0B7600GYNR1\nB1900B0B7600GYNR1\nB900B0B900GXL3\n")
    assert codes(twice) == ["not-in-format"]
    assert "block 3 goes on without a pause" in twice.findings[0].message


NO_GAP = Entries(gap_um=0.0)
M_WORDS = """\
G90
G92 X0.0 Y0.0
M20
M80
T84
G01 X5.0 Y0.0
M20
G01 X5.0 Y5.0
M81
M02
"""


@pytest.mark.parametrize("to", ["3b", "4b", "compact", "rotation", "compensation", "wed", "dxf"])
def test_field_m_words(to):
    # A bare M20 in a 3B file is a word that no 3B controller knows.
    made = convert.convert(M_WORDS.encode(), to=to, units_in="mm", entered=NO_GAP)
    assert made.ok, [str(d) for d in made.findings]
    lost = [d for d in made.findings if d.code == "not-carried"]
    assert [d.count for d in lost] == [4]
    assert "M20 (2 times), M80, M81" in lost[0].message
    assert lost[0].span.line == 3
    if to in ("3b", "4b"):
        assert b"M" not in made.data
    strict = convert.convert(M_WORDS.encode(), to=to, units_in="mm", entered=NO_GAP, strict=True)
    assert not strict.ok


def test_words_stay_where_both_formats_have_them():
    iso = convert.convert(M_WORDS.encode(), to="iso", units_in="mm")
    assert b"M20\r\nM80\r\n" in iso.data
    assert "not-carried" not in codes(iso)
    four = convert.convert(b"B17000B5000B17000GXL1\nQUENCH\nDD\nE\n", to="4b", entered=NO_GAP)
    assert b"QUENCH" in four.data


@pytest.mark.parametrize("to", ["compact", "rotation", "compensation", "iso", "wed", "dxf"])
@pytest.mark.parametrize("format_", ["3b", "4b"])
def test_words_of_3b_and_4b_are_named_with_their_count(format_, to):
    text = b"B5000B0B5000GXL1\nQUENCH\nB0B5000B5000GYL2\nWASH\nQUENCH\nDD\nE\n"
    made = convert.convert(text, to=to, format=format_, entered=NO_GAP)
    assert made.ok, codes(made)
    lost = [d for d in made.findings if d.code == "not-carried"]
    assert [d.count for d in lost] == [3]
    assert "QUENCH (2 times), WASH" in lost[0].message
    strict = convert.convert(text, to=to, format=format_, entered=NO_GAP, strict=True)
    assert not strict.ok


@pytest.mark.parametrize("profile", ["linuxcnc", "grbl", "sodick", "makino"])
def test_a_machine_that_names_its_words_gets_none_of_another(profile):
    # M20 threads the wire at one machine and drills at the next.
    text = M_WORDS.replace("M81", "M81\nM08\nM99999\nM50")
    made = convert.convert(text.encode(), profile=profile, units_in="mm", feed_um=2000.0)
    assert made.ok, codes(made)
    own = convert.convert(made.data, to="3b", profile_in=profile)
    assert "unknown-word" not in codes(own)
    assert not [t for t in made.data.decode().splitlines() if t.strip("N0123456789 ") == "M20"]
    lost = [d for d in made.findings if d.code == "not-carried"]
    assert [d.count for d in lost] == [7]
    assert "M20 (2 times), M80, M81, M08, M99999, M50" in lost[0].message

"""What an ISO program leaves open: asked by what writes or proves, said first by what shows."""

import json
import re
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from wedmcam import api
from wedmcam.api import positions
from wedmcam.cli.main import cli
from wedmcam.diag import Severity, has_errors
from wedmcam.frontends.answers import ANSWERS
from wedmcam.frontends.iso.dialect import QUESTIONS, reads_as_words
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin
from wedmcam.operations import convert
from wedmcam.options import WrongUse

SAMPLES = Path(__file__).parents[2] / "samples"

#: As a field program leaves G90 and the unit out: in from the left, round a square of 10 mm, out.
NO_G90 = (
    "%\n(SQUARE)\nG00 X-10.0 Y5.0\nG01 X-5.0 Y5.0\nG01 X-5.0 Y-5.0\nG01 X5.0 Y-5.0\n"
    "G01 X5.0 Y5.0\nG01 X-5.0 Y5.0\nG01 X-10.0 Y5.0\nM30\n%\n"
)
CALL = (
    "G21\nG90\nG92 X0.0 Y0.0\nG01 X5.0 Y0.0\nM98 P0001\nG01 X0.0 Y0.0\nM199\nN0001\n"
    "X5.0 Y5.0\nX10.0\nY-5.0\nX5.0\nY0.0\nM99\n"
)
#: A semicolon ends a block.
BLOCKS = (
    "G21 G90;\nG92 X0.0 Y0.0;\nG01 X5.0 Y0.0; G01 X5.0 Y5.0; G01 X0.0 Y5.0;\nG01 X0.0 Y0.0;\nM02;\n"
)
INCH = "G90\nG92 X0.0 Y0.0\nG01 X.125 Y.0\nG01 X.625\nG01 Y.5\nG01 X.125\nG01 Y.0\nG01 X0.0\nM02\n"
WHOLE = "G21\nG90\nG92 X0 Y0\nG01 X10 Y0\nG02 X20 Y10 I0 J10\nG01 X0 Y0\nM02\n"
#: A full circle of R 5 about (10, 10), where I and J are its place.
PLACE = (
    "G21 G90\nG92 X0.0 Y0.0\nG00 X10.0 Y10.0\nG01 X15.0 Y10.0\nG03 X15.0 Y10.0 I10.0 J10.0\n"
    "G01 X10.0 Y10.0\nM02\n"
)


def read(text, **said):
    program, _, found = api.read_program(text.encode(), name="a.nc", **said)
    return program, found


def asked(text, **said):
    """The codes of the questions that stop a reading, in their order."""
    program, found = read(text, **said)
    errors = [d for d in found if d.severity is Severity.ERROR]
    assert (program is None) == bool(errors)
    return [d.code for d in errors]


def ends(program):
    moving = program.blocks["kind"] <= Kind.MOVE
    return np.round(positions(program, builtin("iso-um"))[1][moving] / 1000, 3).tolist()


def box(program):
    at = np.array(ends(program))
    return (at.max(axis=0) - at.min(axis=0)).tolist()


# --- the field ------------------------------------------------------------------------------------


def test_field_no_g90():
    assert asked(NO_G90) == ["iso-coordinates", "iso-units"]
    program, found = read(NO_G90, coordinates_in="absolute", units_in="mm", whole_in="mm")
    assert [d.code for d in found] == ["text-skipped"]
    assert ends(program)[1:6] == [[-5, 5], [-5, -5], [5, -5], [5, 5], [-5, 5]]
    assert asked(NO_G90, profile="iso-mm") == []


def test_field_subprogram():
    assert asked(CALL) == ["subprogram"]
    _, found = read(CALL)
    assert "subprogram" in found[0].message
    assert found[0].span.line == 5
    assert asked(CALL, profile="iso-mm") == ["subprogram"]


def test_field_semicolon_ends_a_block():
    assert asked(BLOCKS) == ["iso-semicolon"]
    program, found = read(BLOCKS, semicolon_in="block")
    assert not found
    assert ends(program) == [[5, 0], [5, 5], [0, 5], [0, 0]]
    assert [(s.line, s.column) for s in program.spans][1:3] == [(3, 15), (3, 30)]
    assert ends(read(BLOCKS, semicolon_in="comment")[0]) == [[5, 0], [0, 0]]
    # No profile says what stands behind a semicolon.
    assert asked(BLOCKS, profile="iso-mm") == ["iso-semicolon"]


def test_field_inch_unsaid():
    assert asked(INCH) == ["iso-units"]
    program, found = read(INCH, units_in="inch")
    assert not found
    assert ends(program)[:4] == [[3.175, 0], [15.875, 0], [15.875, 12.7], [3.175, 12.7]]


def test_field_whole_numbers_under_g21():
    assert asked(WHOLE) == ["iso-units"]
    program, found = read(WHOLE, whole_in="mm")
    assert not found
    assert ends(program) == [[10, 0], [20, 10], [0, 0]]
    assert box(read(WHOLE, whole_in="um")[0]) == [0.02, 0.01]
    assert box(read(WHOLE, whole_in="10um")[0]) == [0.2, 0.1]
    assert box(read(WHOLE, whole_in="0.0001in")[0]) == [0.051, 0.025]


def test_field_full_circle_of_absolute_centre():
    assert asked(PLACE) == ["iso-centres"]
    program, found = read(PLACE, centres_in="absolute")
    assert not found
    arc = program.blocks[program.blocks["turn"] != 0]
    assert arc[["x", "y"]].tolist() == [(5000, 0)]
    arc = read(PLACE, centres_in="start")[0].blocks[2]
    assert (arc["x"], arc["y"]) == (-10000, -10000)


FIELD = [NO_G90, CALL, BLOCKS, INCH, WHOLE, PLACE]


@pytest.mark.parametrize("text", FIELD)
def test_whatever_writes_or_proves_refuses_and_whatever_shows_says_it_first(
    text, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("a.nc").write_text(text)
    Path("b.3b").write_text("B5000B0B5000GXL1\nDD\n")

    def run(*line):
        done = CliRunner().invoke(cli, list(line), standalone_mode=False)
        if done.exception:
            raise done.exception
        return done.return_value, done.stderr

    for line in (
        ("verify", "a.nc"),
        ("convert", "a.nc", "-o", "x.3b"),
        ("convert", "a.nc", "-o", "x.nc"),
        ("convert", "a.nc", "-o", "x.zd"),
        ("convert", "a.nc", "-o", "x.wed"),
        ("convert", "a.nc", "-o", "x.dxf"),
        ("convert", "a.nc", "-o", "x.svg"),
        ("convert", "a.nc", "-o", "x.3b", "--format", "iso"),
        ("plot", "a.nc", "-o", "x.dxf"),
    ):
        status, said = run(*line)
        assert status == 1, line
        assert re.search("error.(iso-coordinates|iso-units|iso-centres|iso-semicolon|sub)", said)
        assert not list(Path().glob("x.*"))
    assert run("diff", "a.nc", "b.3b")[0] == 2
    assert run("diff", "b.3b", "a.nc")[0] == 2
    for line in (
        ("dump", "a.nc"),
        ("identify", "a.nc"),
        ("explain", "a.nc", "--block", "1"),
        ("plot", "a.nc", "-o", "x.svg"),
    ):
        status, said = run(*line)
        assert status == 0, line
        first = said.splitlines()[0]
        assert "warning[" in first, line
        assert "assumed: " in first


def test_library_functions_refuse_too():
    assert not api.verify(WHOLE.encode(), name="a.nc").ok
    assert api.verify(WHOLE.encode(), name="a.nc", whole_in="mm").ok
    assert not convert.convert(WHOLE.encode(), to="3b", name="a.nc").ok
    made = convert.convert(WHOLE.encode(), to="3b", name="a.nc", whole_in="mm")
    assert made.ok
    assert made.difference.largest_um == 0
    one = WHOLE.encode()
    assert api.diff(one, made.data, names=("a.nc", "b.3b"))[0] is None
    assert api.diff(one, made.data, names=("a.nc", "b.3b"), whole_in="mm")[0].equal
    told, _ = api.diff(one, one, names=("a.nc", "b.nc"), whole_in="mm", whole_in_b="um")
    assert not told.equal
    for wrong in ({"units_in": "cm"}, {"whole_in": "0.0001"}, {"whole": "mm"}):
        with pytest.raises(WrongUse):
            read(WHOLE, **wrong)
    with pytest.raises(WrongUse, match="read, not compiled"):
        api.compile(SAMPLES / "plate.dxf", offset=0.1, units_in="mm")


# --- more of the kind -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        # G90 comes after the first motion; both stand in one file; modal, in a line, lower case.
        ("G21 G01 X5.0\nG90\nG01 X0.0\nM02", ["iso-coordinates"]),
        ("G21 G90 G01 X5.0\nG91\nG01 X1.0\nG90 X0.0\nM02", []),
        ("g21g90g1x5.y1.\nx1.y2.\nm2", []),
        ("G21\nG01 G91 X5.0\nM02", []),
        # A circle by I and J alone ends where it starts, in G90 and G91.
        ("G21\nG92 X0.0 Y0.0\nG03 I5.0\nM02", []),
        # G20 comes after a motion; a file in inch; whole numbers in inch.
        ("G90 G01 X5.0\nG20\nX1.0\nM02", ["iso-units"]),
        ("G20 G90 G01 X.5\nM02", []),
        ("G70 G90 G01 X5\nM02", ["iso-units"]),
        # 0 is 0 in any unit, pointed or not.
        ("G90 G92 X0 Y0\nG21 G01 X5.0 Y0\nX0\nM02", []),
        ("G90 G92 X0.0 Y0.\nG21 G01 X5.0 Y0\nX0\nM02", []),
        # F, N, D, S, E, T and M are no coordinates; I, J, R and G92 are.
        ("N10 G21 G90 F120 S3 E5 T84\nN20 G01 X5.0\nM50\nM02", []),
        ("G21 G91\nG01 X5.0\nG02 X1.0 Y1.0 R1\nM02", ["iso-units"]),
        ("G21 G91\nG01 X5.0\nG02 X1.0 Y1.0 I1 J0\nM02", ["iso-units"]),
        ("G21 G90\nG92 X5 Y0\nG01 X1.0\nM02", ["iso-units"]),
        # Both a point and none, and nothing said: two questions.
        ("G91 G01 X5.0\nX5\nM02", ["iso-units", "iso-units"]),
        # What is behind the end is not run.
        ("G21 G91 G01 X5.0\nM02\nG01 X5\nM99\n", []),
        ("G21 G90 G01 X5.0\nM30\nO2\nN1 X5\nM98 P1\n", []),
        # Subprograms by other words.
        ("G21 G91 G01 X5.0\nM99\n", ["subprogram"]),
        ("G21 G91 G01 X5.0\nM97 P100\nM02\n", ["subprogram"]),
        ("G21 G91 G01 X5.0\nm98p1l3\nM02\nn1 x1.\nm99", ["subprogram"]),
        ("G21 G91 G01 X5.0\nL2\nM02\n", ["subprogram"]),
        ("G21 G91 G01 X5.0 L5\nM02\n", ["subprogram"]),
        ("G21 G91 G01 X5.0\nG65 P9010\nM02\n", ["subprogram", "iso-code"]),
        # Semicolons: at each line end, with a comment, with words.
        ("G21 G91;\nG01 X5.0 ;\nM02;;\n", []),
        ("; PLATE 5 MM, WIRE 0.2\nG21 G91 G01 X5.0 ; BACK\nM02\n", []),
        ("G21 G91 G01 X5.0 ; MOVE TO X5\nM02\n", ["iso-semicolon"]),
        ("G21 G91 G01 X5.0 ;y 5.\nM02\n", ["iso-semicolon"]),
        ("G21 G91 G01 X5.0;M02\n", ["iso-semicolon"]),
        ("G21 G91 G01 X5.0 (A; G01 X5.0)\nM02\n", []),
        ("G21 G91 G01 X5.0 (A) ; G01 X5.0\nM02\n", ["iso-semicolon"]),
    ],
)
def test_what_is_asked(text, codes):
    assert asked(text) == codes
    shown = read(text, shown=True)[1]
    questions = [c for c in codes if c in QUESTIONS]
    assert sorted(d.code for d in shown if d.code in QUESTIONS) == sorted(questions)
    assert all("assumed: " in d.message for d in shown[: len(questions)])
    for d in read(text)[1]:
        assert d.hint or d.code not in QUESTIONS


@pytest.mark.parametrize(
    ("arcs", "codes"),
    [
        # Every arc that is no full circle proves the rule, whichever comes first.
        ("G03 X15.0 Y10.0 I-5.0 J0.0", ["iso-centres"]),
        ("G03 X5.0 Y10.0 I-5.0 J0.0\nG03 X15.0 Y10.0 I5.0 J0.0", []),
        ("G03 X15.0 Y10.0 I-5.0 J0.0\nG01 X20.0\nG02 X25.0 Y5.0 I0.0 J-5.0", []),
        # Radii prove nothing; and a file of them asks nothing.
        ("G02 X20.0 Y5.0 R5.0", []),
        ("G02 X20.0 Y5.0 R5.0\nG03 X20.0 Y5.0 I-3.0 J0.0", ["iso-centres"]),
        # In G91 I and J lead from the start.
        ("G91\nG03 X0.0 Y0.0 I-5.0 J0.0", []),
        # Where both rules have one centre there is nothing to ask.
        ("G01 X0.0 Y0.0\nG03 X0.0 Y0.0 I-5.0 J0.0", []),
    ],
)
def test_which_arcs_prove_the_rule_of_centres(arcs, codes):
    text = f"G21 G90\nG92 X0.0 Y0.0\nG01 X15.0 Y10.0\n{arcs}\nM02\n"
    assert asked(text) == codes


def test_arcs_of_the_other_rule_are_refused_and_it_is_named():
    half = PLACE.replace("G03 X15.0 Y10.0", "G03 X5.0 Y10.0").replace("G01 X10.0", "G01 X1.0", 1)
    text = PLACE.replace("G03 X15.0", "G03 X5.0")
    assert asked(text) == ["iso-arc"]
    assert "--centres-in absolute" in read(text)[1][0].hint
    assert not has_errors(read(text, centres_in="absolute")[1])
    assert asked(half, centres_in="start") == ["iso-arc"]
    relative = text.replace("I10.0 J10.0", "I-5.0 J0.0")
    assert asked(relative) == []
    assert asked(relative, centres_in="absolute") == ["iso-arc"]
    assert "--centres-in start" in read(relative, centres_in="absolute")[1][0].hint
    alone = PLACE.replace(" J10.0", "")
    assert asked(alone, centres_in="absolute") == ["iso-arc"]


def test_centres_are_in_the_coordinates_that_g92_sets():
    text = PLACE.replace("X10.0 Y10.0\nG01", "X10.0 Y10.0\nG92 X110.0 Y10.0\nG01", 1)
    for old, new in (("X15.0", "X115.0"), ("I10.0", "I110.0"), ("G01 X10.0", "G01 X110.0")):
        text = text.replace(old, new)
    plain = read(PLACE, centres_in="absolute")[0]
    assert (read(text, centres_in="absolute")[0].blocks == plain.blocks).all()


def test_a_circle_in_compensation_takes_the_rule_too():
    text = PLACE.replace("G01 X15.0", "G41 D1 G01 X15.0").replace(
        "G01 X10.0 Y10.0\nM", "G40 G01 X10.0\nM"
    )
    from wedmcam.targets import Entries

    table = Entries(d=((1, 100.0),))
    assert asked(text, entered=table) == ["iso-centres"]
    program, _ = read(text, entered=table, centres_in="absolute")
    arc = program.blocks[program.blocks["turn"] != 0]
    assert arc["x"].tolist() == [4900]


@pytest.mark.parametrize(
    ("text", "said", "heard"),
    [
        ("G20 G90 G00 X.5\nM02", {"units_in": "mm"}, ["iso-stated"]),
        ("G21 G90 G00 X.5\nM02", {"units_in": "mm"}, []),
        ("G21 G91 G01 X.5\nM02", {"coordinates_in": "absolute"}, ["iso-stated"]),
        ("G21 G91 G01 X.5\nM02", {"coordinates_in": "incremental"}, []),
        ("G21 G91 G01 X.5\nG90 X0\nM02", {"coordinates_in": "absolute"}, []),
    ],
)
def test_the_file_wins_over_an_option_and_that_is_said(text, said, heard):
    program, found = read(text, **said)
    assert [d.code for d in found] == heard
    assert (program.blocks == read(text)[0].blocks).all()


def test_a_named_profile_says_what_it_has_keys_for():
    text = "G01 X10 Y5\nX20 Y0\nM02\n"
    assert asked(text) == ["iso-coordinates", "iso-units"]
    assert ends(read(text, profile="iso-um")[0])[-1] == [0.03, 0.005]
    assert ends(read(text, profile="iso-g41-mm")[0])[-1] == [20, 0]
    # What is said beside it wins over it.
    assert ends(read(text, profile="iso-um", whole_in="mm")[0])[-1] == [30, 5]
    assert asked("G20 G91 G01 X5\nM02", profile="iso-mm") == ["iso-units"]
    assert ends(read("G20 G91 G01 X5\nM02", profile="iso-mm", whole_in="inch")[0]) == [[127, 0]]


def test_own_programs_are_read_with_a_certificate_or_their_profile(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    drawing = str(SAMPLES / "key-punch.dxf")
    run = CliRunner().invoke
    against = ["--against", drawing, "--offset", "0.1"]
    for name in ("iso-um", "iso-mm", "iso-fixed", "iso-g41", "iso-g41-mm"):
        line = ["compile", drawing, "-o", "a.nc", "--profile", name, "--offset", "0.1"]
        assert run(cli, [*line, "--certificate", f"{name}.json"]).return_value in (None, 0)
        alone = run(cli, ["verify", "a.nc", *against], standalone_mode=False)
        if name.endswith("-mm"):  # the file says all that it can say
            assert alone.return_value == 0, alone.stderr
        else:
            assert alone.return_value == 1, name
            assert "--profile-in" in alone.stderr
        for more in (["--profile-in", name], ["--profile", name]):
            done = run(cli, ["verify", "a.nc", *against, *more], standalone_mode=False)
            assert done.return_value == 0, done.stderr
        done = run(cli, ["verify", "a.nc", "--certificate", f"{name}.json"], standalone_mode=False)
        assert done.return_value == 0, done.stderr
        issued = json.loads(Path(f"{name}.json").read_text())
        made = api.compile(drawing, profile=name, offset=0.1)
        assert api.verify(made.data, against=drawing, certificate=issued, options=made.options).ok
    two = ["verify", "a.nc", *against, "--profile", "iso-um", "--profile-in", "iso-mm"]
    with pytest.raises(WrongUse, match="two profiles"):
        raise run(cli, two, standalone_mode=False).exception


def test_a_certificate_of_a_foreign_program_keeps_what_was_said(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "G21 G90\nG92 X0 Y0\nG01 X10\nY10\nX0\nY0\nM02\n"
    Path("a.nc").write_text(text)
    run = CliRunner().invoke
    made = convert.convert(text.encode(), to="dxf", name="a.nc", whole_in="mm")
    Path("a.dxf").write_bytes(made.data)
    line = ["verify", "a.nc", "--against", "a.dxf", "--layer", "CUT", "--certificate", "c.json"]
    done = run(cli, [*line, "--whole-in", "mm"], standalone_mode=False)
    assert done.return_value == 0, done.stderr
    again = run(cli, ["verify", "a.nc", "--certificate", "c.json"], standalone_mode=False)
    assert again.return_value == 0, again.stderr


def test_what_a_profile_writes_behind_semicolons_is_a_comment():
    from dataclasses import replace

    mm = builtin("iso-mm")
    machine = replace(mm, layout=replace(mm.layout, header=("; G90 MACHINE X5",)))
    made = api.compile(SAMPLES / "key-punch.dxf", profile=machine, offset=0.1)
    assert made.ok, made.findings
    assert api.verify(made.data, profile=machine, name="a.nc").ok
    assert not api.verify(made.data, profile=mm, name="a.nc").ok


def test_a_call_is_not_written_either():
    made = convert.convert(b"B5000B0B5000GXL1\nM98\nDD\n", to="iso", format="3b")
    assert [d.code for d in made.findings if d.severity is Severity.ERROR] == ["not-in-format"]


def test_options_of_the_command_line_are_those_of_the_library():
    for command in ("convert", "verify", "diff", "plot", "dump", "explain"):
        taken = {p.name: p for p in cli.get_command(click.Context(cli), command).params}
        assert {*ANSWERS, "profile_in"} <= set(taken), command
        for name, answers in ANSWERS.items():
            if name != "whole_in":
                assert tuple(taken[name].type.choices) == answers


def test_settings_say_it_for_every_command_that_reads(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.nc").write_text("G01 X5 Y5\nX5.0 Y0.0; Y2.0\nM02\n")
    Path("wedmcam.toml").write_text(
        'units-in = "mm"\nwhole-in = "10um"\ncoordinates-in = "absolute"\n'
        'centres-in = "start"\nsemicolon-in = "block"\n'
    )
    run = CliRunner().invoke
    for line in (
        ("verify", "a.nc"),
        ("convert", "a.nc", "-o", "a.3b"),
        ("plot", "a.nc", "-o", "b.dxf"),
        ("diff", "a.nc", "a.3b"),
        ("dump", "a.nc"),
        ("explain", "a.nc", "--block", "1"),
    ):
        done = run(cli, list(line), standalone_mode=False)
        assert done.return_value == 0, (line, done.stderr, done.exception)
        assert "assumed" not in done.stderr
    Path("wedmcam.toml").write_text('profile-in = "iso-mm"\nsemicolon-in = "block"\n')
    assert run(cli, ["verify", "a.nc"], standalone_mode=False).return_value == 0
    assert run(cli, ["convert", "a.nc", "-o", "c.3b"], standalone_mode=False).return_value == 0
    # It is for ISO programs: others keep their own.
    assert run(cli, ["verify", "c.3b"], standalone_mode=False).return_value == 0
    assert run(cli, ["dump", "c.3b"], standalone_mode=False).return_value == 0
    Path("wedmcam.toml").write_text('whole-in = "cm"\n')
    done = run(cli, ["dump", "a.nc"])
    assert done.exit_code == 2
    assert "takes um, mm, inch" in done.stderr


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("g01 x5.0", True),
        ("G01X5.0Y5.0(A)", True),
        ("(A) N10 G01 X5.0", True),
        ("N10:G01 X5.0", True),
        ("/X5.", True),
        ("M00", True),
        ("N10 M98 P1", True),
        ("back to X-5, then stop", True),
        ("G01X5.0Y", True),
        ("X 5", True),
        ("", False),
        ("(G01 X5.0)", False),
        ("PLATE 5 MM", False),
        ("wire 0.25, offset 0.14", False),
        ("X5MM PLATE", False),
        ("R2D2UNIT, REV.R2, PART-R2", False),
        ("-0.100 , 0.000", False),
        ("DATE 2024-05-01 10:11", False),
        ("3:1 error[iso-arc]", False),
        ("M5 screws", False),
    ],
)
def test_what_reads_as_words(text, words):
    assert reads_as_words(f"; {text}".upper().encode()) == words


@given(st.text("GXYIJRMN0123456789.-+ ;()ABC", max_size=30))
def test_text_behind_semicolons_is_judged_whatever_it_is(text):
    reads_as_words(text.upper().encode())


@given(
    x=st.integers(-9000, 9000).filter(bool),
    unit=st.sampled_from(["um", "mm", "inch", "10um"]),
    g=st.sampled_from(["", "G20", "G21"]),
)
def test_a_whole_number_is_what_was_said(x, unit, g):
    nm = {"um": 1000, "mm": 10**6, "inch": 25_400_000, "10um": 10_000}[unit]
    text = f"{g}\nG91 G01 X{x}\nX0 Y0\nM02\n"
    assert "iso-units" in asked(text)
    program, _ = read(text, whole_in=unit)
    wide = 0 if program is None else int(program.blocks["x"][0])
    assert wide == np.floor(x * nm / 1000 + 0.5)


def said(text, code):
    return [d for d in read(text, shown=True)[1] if d.code == code]


TITLES = [
    "BRACKET LEFT",
    " PART 12 B",
    "N10 PLATE X5",
    "MADE BY HAND 5.5",
    "12 PLATES",
    "X5.0 OF PLATE",
]


@pytest.mark.parametrize("title", TITLES)
@pytest.mark.parametrize("line", [1, 4])
def test_field_title_line(title, line):
    lines = ["G90 G21", "G92 X0.0 Y0.0", "G01 X5.0 Y0.0", "G01 X5.0 Y5.0", "M02"]
    lines.insert(line - 1, title)
    found = said("\n".join(lines) + "\n", "iso-word")
    assert len(found) == 1, [d.message for d in found]
    assert found[0].message.startswith(f"line {line} is text, no ISO words: {title.strip()}")
    assert found[0].severity is Severity.ERROR
    assert found[0].span.line == line


@pytest.mark.parametrize("line", ["G01 X Y5.0", "G01 X1.2.3 Y1.2.3", "X Y5.0", "G01 X5.0 Y"])
def test_a_word_without_its_number_is_no_text(line):
    found = said(f"G90 G21\nG01 X1.0\n{line}\nM02\n", "iso-word")
    assert found
    assert not any("is text" in d.message for d in found)


def test_field_cond_c():
    text = "G90 G21\nG92 X0.0 Y0.0\nT84\nC001\nG01 X5.0 Y0.0\nC001\nG01 X5.0 Y5.0\nM02\n"
    assert asked(text) == []
    (found,) = said(text, "iso-ignored")
    assert found.message.startswith("T84, C001 (2 times): ")
    assert found.count == 3


@pytest.mark.parametrize(
    "line", ["G01 X1.0 C001", "C90", "C90.", "C-001", "G00 C180", "A001", "Y5.0C002"]
)
def test_an_axis_is_no_condition(line):
    assert "iso-code" in asked(f"G90 G21\nG01 X2.0\n{line}\nM02\n")


def test_every_word_is_named_with_its_count():
    lines = "".join(f"X{k}.0 F{k % 3}\n" for k in range(1, 10))
    (found,) = said(f"G90 G21 G01\n{lines}S1\nF1.5\nM02\n", "iso-ignored")
    assert found.message.startswith("F1 (3 times), F2 (3 times), F0 (3 times), S1, F1.5: ")
    many = "".join(f"X{k}.0 F{k}\n" for k in range(1, 101))
    (found,) = said(f"G90 G21 G01\n{many}M02\n", "iso-ignored")
    assert "F24 and 76 more: " in found.message
    (found,) = said("G90 G21 G01 X5.0\nX5.0\nX5.0\nM02\n", "iso-ignored")
    assert found.message.endswith("(2 lines)")


FRAME = "G90 G21 {0}\nG92 X0.0 Y0.0\nG01 X5.0 Y0.0\n{1}\nG01 X5.0 Y5.0\nM02\n"


@pytest.mark.parametrize(
    ("before", "between"),
    [
        ("G54", "G04 X2.0"),
        ("G59", "G59"),
        ("G54", "G04 P500"),
        ("G17", "G04 F2 N5"),
        ("G80", "G04 U0.5\nG04X1."),
        ("G91.1 G17.1", "G53"),
    ],
)
def test_field_g54_g04(before, between):
    text = FRAME.format(before, between)
    assert asked(text) == []
    plain, _ = read(FRAME.format("", ""))
    program, found = read(text)
    assert (program.blocks == plain.blocks).all()
    assert {(d.code, str(d.severity)) for d in found} == {("iso-ignored", "note")}
    codes = re.findall(r"G\d+(?:\.\d)?", f"{before} {between}")
    assert all(c in found[0].message for c in codes)
    assert found[0].count == len(codes)


@pytest.mark.parametrize(
    ("before", "between"),
    [
        ("G54", "G55"),
        ("G54 G55", ""),
        ("", "G54"),
        ("", "G92 G54 X1.0"),
        ("", "G53 X1.0"),
        ("", "G53 G00 Y1.0"),
        ("", "G04 X1.0 Y2.0"),
        ("", "G04 Y2.0"),
        ("", "G01 G04 X2.0"),
        ("G17.1", "G03 X6.0 Y1.0 I0.0 J1.0"),
        ("G91.2", ""),
        ("G54.1", ""),
        ("G18", ""),
    ],
)
def test_codes_that_may_change_the_path(before, between):
    assert asked(FRAME.format(before, between))


def test_centres_as_places_contradict_g91_1():
    """What a file says itself is in force, as with G20, G21, G90 and G91."""
    _, found = read(FRAME.format("G91.1", ""), centres_in="absolute")
    assert "iso-stated" in [d.code for d in found]
    assert asked(FRAME.format("G91.1", ""), centres_in="absolute") == []


@pytest.mark.parametrize("word", ["M60", "M70", "m75", "M79"])
def test_m_words_that_may_change_the_path(word):
    text = f"G90 G21\nG92 X0.0 Y0.0\n{word}\nG01 X5.0 Y0.0\nM02\n"
    assert asked(text) == ["iso-code"]
    assert asked(text.replace(word, "") + word) == []  # behind the end
    made = convert.convert(f"{word.upper()}\nB5000B0B5000GXL1\nDD\n".encode(), to="iso")
    assert [d.code for d in made.findings if d.severity is Severity.ERROR] == ["not-in-format"]

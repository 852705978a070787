"""Which words of an ISO program its profile knows, what of a file is run, and what is said."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wedmcam import api, machines
from wedmcam.api import positions
from wedmcam.diag import Severity
from wedmcam.formats.iso import IDLE, LEADING
from wedmcam.frontends.identify import identify
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

SAMPLES = Path(__file__).parents[2] / "samples"
BASE = (
    'title = "t"\nformat = "iso"\nline_table = "rotate"\n[limits]\ncount_um = 999999\n'
    'line_um = 999999\narc_um = 999999\n[iso]\ncoordinates = "absolute"\nintegers = "mm"\n'
)
WORDS = (
    '[iso.words.harmless]\nM20 = "threads the wire"\nT = "pumps and tank"\nM80-M85 = "feeds"\n'
    'C000-C999 = "conditions"\nG28 = "goes to the reference, cut"\n'
    '[iso.words.refused]\nM60 = "turns the part"\nM84 = "cuts without a generator"\nG51 = "taper"\n'
)
FRAME = "G21 G90\nG92 X0.0 Y0.0\n{}\nG01 X5.0 Y0.0\nX5.0 Y5.0\nM02\n"


def profile(more=WORDS, keys=""):
    machine, found = machines.parse(BASE + keys + more, "shop")
    assert found == []
    return machine


def read(text, **said):
    program, _, found = api.read_program(text.encode(), name="a.nc", **said)
    return program, found


def told(text, **said):
    return [(str(d.severity), d.code, d.message) for d in read(text, **said)[1]]


def wrong(text, **said):
    return [d.code for d in read(text, **said)[1] if d.severity is Severity.ERROR]


def ends(program):
    moving = program.blocks["kind"] <= Kind.MOVE
    return np.round(positions(program, builtin("iso-um"))[1][moving] / 1000, 3).tolist()


# --- words of a profile ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "line", ["M20 M80\nT84\nM20\nC001", "m20m80t84\nM020 c1", "Ｍ２０M80T84 C7 M20"]
)
def test_harmless_words_are_one_note_with_what_they_do(line):
    (one,) = told(FRAME.format(line), profile=profile())
    assert one[:2] == ("note", "iso-harmless")
    for text in ("threads the wire", "feeds", "pumps and tank", "conditions", "shop"):
        assert text in one[2]
    assert "(2 times)" in one[2] or "M20, M020" in one[2] or "Ｍ２０ (2 times)" in one[2]
    program, _ = read(FRAME.format(line), profile=profile())
    assert not program.words
    assert ends(program) == [[5, 0], [5, 5]]


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("M60", "turns the part"),
        ("M84", "without a generator"),
        ("g51 a0", "taper"),
        ("M060", "turns"),
    ],
)
def test_refused_words_are_errors_in_the_words_of_the_profile(line, text):
    found = [t for t in told(FRAME.format(line), profile=profile()) if t[0] == "error"]
    assert [t[1] for t in found] == ["iso-code"]
    assert text in found[0][2]


def test_a_dialect_is_a_white_list():
    program, found = read(FRAME.format("M50 S3\nT5 Q1"), profile=profile())
    assert sorted((str(d.severity), d.code) for d in found) == [
        ("note", "iso-harmless"),
        ("warning", "unknown-word"),
        ("warning", "unknown-word"),
    ]
    assert program.words == ((0, "M50"),)
    text = " ".join(d.message for d in found)
    assert "S3, Q1: no word of the profile shop" in text
    assert "M50: no M word of the profile shop" in text
    # Words of the reader stay refused where no table names them.
    assert wrong(FRAME.format("M70"), profile=profile()) == ["iso-code"]
    assert wrong(FRAME.format("M98 P1"), profile=profile()) == ["subprogram"]
    assert wrong(FRAME.format("C5"), profile=profile("")) == ["iso-code"]


def test_g_codes_of_a_dialect_that_lists_them():
    listed = WORDS + '[iso.words.path]\nG00-G03 = "motion"\nG90-G92 = "places"\nG21 = "mm"\n'
    assert wrong(FRAME.format("G28"), profile=profile(listed)) == []
    assert wrong(FRAME.format(""), profile=profile(listed)) == []
    for code in ("G20", "G17", "G54", "G91.1", "G17.1", "G05", "G40"):
        found = [t for t in told(FRAME.format(code), profile=profile(listed)) if t[0] == "error"]
        assert found[0][1] == "iso-code", code
        assert "profile shop does not name" in found[0][2]
    # A profile that lists none runs what the reader runs.
    assert wrong(FRAME.format("G17 G91.1"), profile=profile()) == []


@pytest.mark.parametrize(
    ("line", "good"),
    [
        ("G28 X1.0", False),
        ("G28\nX1.0", False),  # before any motion
        ("G28", True),
        ("G01 G28 X1.0", True),
        ("G28 M20 T1", True),
        ("G01 X1.0\nG28 Y2.0", False),
        ("G01 X1.0\nG28\nY2.0", True),
    ],
)
def test_places_of_a_code_that_is_left_out_are_no_motion(line, good):
    assert set(wrong(FRAME.format(line), profile=profile())) == (set() if good else {"iso-code"})


@pytest.mark.parametrize("tenths", sorted(LEADING | IDLE))
def test_the_reader_runs_every_code_that_a_profile_may_list(tenths):
    code = f"G{tenths // 10:02d}" + (f".{tenths % 10}" if tenths % 10 else "")
    more = "X1.0" if tenths == 920 else "D1" if tenths in (410, 420) else ""
    for text in (f"G21 G90\nG92 X0.0\n{code} {more}\nG00 X5.0\nM02\n", f"{code} {more}\nM02\n"):
        said = " ".join(m for _, _, m in told(text, whole_in="mm"))
        assert "not known here" not in said
        assert "whole number" not in said


def test_only_a_profile_that_was_named_says_it():
    shipped = profile()
    _, found = read(FRAME.format("M20"), profile=shipped)
    assert [d.code for d in found] == ["iso-harmless"]
    assert [d.code for d in read(FRAME.format("M20"))[1]] == ["unknown-word"]


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("M20 M21", "mitsubishi (M20, M21); makino (M20)"),
        ("M60", "linuxcnc (M60); makino (M60); robofil (M60)"),
        ("M50", "linuxcnc (M50); robofil (M50)"),
        ("G29", "sodick (G29)"),
        ("T84", "sodick (T84)"),
    ],
)
def test_hints_name_the_profiles_that_know_a_word(line, names):
    _, found = read(FRAME.format(line))
    hint = f"profiles that know the word: {names}; --profile-in NAME takes it as that machine does"
    assert found[0].hint == hint


def test_a_word_that_no_profile_knows_has_a_hint_of_its_own(monkeypatch):
    from wedmcam.frontends.iso import known

    monkeypatch.setattr(known, "knowing", lambda letter, n: ())
    _, found = read(FRAME.format("M71"))
    assert "no profile knows" in found[0].hint


def test_every_different_word_is_named_with_its_count():
    (one,) = told(FRAME.format("M80 M81\nM80\nM81 M82"))
    assert one[2].startswith("M80 (2 times), M81 (2 times), M82: ")
    (one,) = told(FRAME.format("T84 S1\nE5 T84"))
    assert one[2].startswith("T84 (2 times), S1, E5: ")


@pytest.mark.parametrize("word", ["M0", "M00", "m1", "M001", "M01"])
def test_pauses_stand_behind_the_motion_of_their_line(word):
    program, found = read(f"G21 G91 G01\nX5.0 {word}\nY5.0\nX1.0M008M80\nM2\n")
    assert [Kind(k).name for k in program.blocks["kind"]] == (
        "LINE PAUSE LINE LINE WORD WORD STOP".split()
    )
    assert [w for _, w in program.words] == ["M08", "M80"]
    # M01 stops where the operator has switched it on: a pause is another program, and said.
    optional = ["iso-skip"] if "1" in word else []
    assert [d.code for d in found] == [*optional, "unknown-word"]


def test_n_without_a_number_is_an_error():
    assert wrong("G21 G91\nN G01 X5.0\nM02\n") == ["iso-word"]


# --- modes ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "good"),
    [
        ("G80 G01 X5.0\nY1.0", True),
        ("G01 X5.0\nG80\nG01 Y1.0", True),
        ("G80\nG01 X5.0\nY1.0", True),
        ("G01 X5.0\nG80\nY1.0", False),
        ("G01 X5.0\nG80 Y1.0", False),
        ("G01 G80 X5.0\nY1.0", True),
    ],
)
def test_g80_ends_the_motion_before(text, good):
    text = f"G21 G91\n{text}\nM02\n"
    assert wrong(text) == ([] if good else ["iso-code"])
    # To a controller of which its profile says so it is nothing.
    free = profile('[iso.words.harmless]\nG80 = "ends a cycle"\n')
    assert wrong(text, profile=free) == []


@pytest.mark.parametrize("code", ["G17", "G61", "G61.1", "G64 P0.01", "G64 P.05 Q.01", "G94"])
def test_modes_that_change_no_path(code):
    program, found = read(FRAME.format(code))
    assert {(str(d.severity), d.code) for d in found} == {("note", "iso-ignored")}
    assert ends(program) == [[5, 0], [5, 5]]


def test_a_machine_that_may_round_corners_is_warned_of():
    """LinuxCNC's handbook: G64 without P rounds as far as the speed asks for."""
    program, found = read(FRAME.format("G64"))
    assert [(str(d.severity), d.code) for d in found] == [("warning", "iso-ignored")]
    assert "may round corners" in found[0].message
    assert ends(program) == [[5, 0], [5, 5]]


@pytest.mark.parametrize("code", ["G64 P1", "G64 P0.06", "G64 P.01 Q2.0", "G64 P0.01 (IN)"])
def test_a_path_that_is_rounded_far_is_another(code):
    text = FRAME.format(code)
    if "IN" in code:
        text = text.replace("G21", "G20").replace("5.0", "0.5")
    assert wrong(text) == ["iso-code"]


@pytest.mark.parametrize(
    "code",
    ["G18", "G19", "G93", "G28", "G29", "G30", "G48", "G49", "G50", "G51", "G52 A1", "G60", "G100"],
)
def test_codes_that_nothing_is_known_of_are_named(code):
    found = [t for t in told(FRAME.format(code)) if t[0] == "error"]
    assert found[0][1] == "iso-code"
    assert found[0][2].startswith(code.split()[0] + ": ")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("G90\nG01 X5.0", True),
        ("G90\nG02 X5.0 Y5.0 R5.0", True),
        ("G90\nG92 X0.0 Y0.0\nG01 X5.0", False),
        ("G90\nG00 X5.0\nG01 X6.0", False),
        ("G91\nG01 X5.0", False),
        ("G91\nG01 X5.0\nG90\nX6.0", False),
    ],
)
def test_a_first_cut_from_nowhere_is_said(text, said):
    found = [d for d in read(f"G21\n{text}\nM02\n")[1] if d.code == "iso-start"]
    assert len(found) == said
    assert all(d.severity is Severity.NOTE and "X0 Y0" in d.message for d in found)


# --- centres --------------------------------------------------------------------------------------

#: A quarter, a half and a full circle of R 5 about (10, 10), by four rules.
ARCS = (
    "G21 G90 {code}\nG92 X0.0 Y0.0\nG01 X15.0 Y10.0\nG03 X10.0 Y15.0 {0}\nG03 X10.0 Y5.0 {1}\n"
    "G03 X10.0 Y5.0 {2}\nM02\n"
)
START = ARCS.format("I-5.0 J0.0", "I0.0 J-5.0", "I0.0 J5.0", code="{code}")
PLACES = ARCS.format(*["I10.0 J10.0"] * 3, code="{code}")
TO_START = ARCS.format("I5.0 J0.0", "I0.0 J5.0", "I0.0 J-5.0", code="{code}")


@pytest.mark.parametrize(
    ("text", "answer"), [(START, "start"), (PLACES, "absolute"), (TO_START, "to-start")]
)
def test_centres_by_every_rule(text, answer):
    plain, _ = read(START.format(code=""))
    program, found = read(text.format(code=""), centres_in=answer)
    assert not found
    assert (program.blocks == plain.blocks).all()
    machine = profile("", f'ij = "{answer}"\n')
    program, found = read(text.format(code=""), profile=machine)
    assert not found
    assert (program.blocks == plain.blocks).all()
    for other in {"start", "absolute", "to-start"} - {answer}:
        _, found = read(text.format(code=""), centres_in=other)
        assert found[0].code == "iso-arc"
        assert f"--centres-in {answer}" in found[0].hint
    if answer != "start":
        _, found = read(text.format(code=""))
        assert f"--centres-in {answer}" in found[0].hint


@pytest.mark.parametrize("name", ["iso-um", "iso-mm", "iso-fixed", "iso-g41", "iso-g41-mm"])
@pytest.mark.parametrize("circle", ["halves", "one"])
@pytest.mark.parametrize("rule", ["start", "absolute", "to-start"])
def test_centres_are_written_as_they_are_read(name, circle, rule):
    iso = replace(builtin(name).iso, ij=rule, full_circle=circle)
    machine = replace(builtin(name), iso=iso)
    for part in ("plate.dxf", "cam.wed"):
        offset = {"offset": 0.1} if part.endswith("dxf") else {}
        made = api.compile(SAMPLES / part, profile=machine, **offset)
        assert made.ok, [d.message for d in made.findings]
        usual = api.compile(
            SAMPLES / part, profile=replace(machine, iso=replace(iso, ij="start")), **offset
        )
        same = rule == "start" or (rule == "absolute" and iso.coordinates == "incremental")
        assert (made.data == usual.data) == same
        assert (made.program.blocks == usual.program.blocks).all()


def test_g90_1_and_g91_1_say_it_from_their_line_on():
    plain, _ = read(START.format(code=""))
    program, found = read(PLACES.format(code="G90.1"))
    assert [d.code for d in found] == ["iso-ignored"]
    assert "place of the centre" in found[0].message
    assert (program.blocks == plain.blocks).all()
    # In the middle of a file, and under G91.
    half = START.format(code="").replace(
        "G03 X10.0 Y5.0 I0.0 J-5.0", "G90.1 G03 X10.0 Y5.0 I10.0 J10.0"
    )
    half = half.replace("G03 X10.0 Y5.0 I0.0 J5.0", "G91.1\nG03 X10.0 Y5.0 I0.0 J5.0")
    assert (read(half)[0].blocks == plain.blocks).all()
    ways = PLACES.format(code="G90.1").replace("G03 X10.0 Y15.0", "G91 G03 X-5.0 Y5.0")
    ways = ways.replace("G03 X10.0 Y5.0", "G03 X0.0 Y-10.0", 1).replace("X10.0 Y5.0", "X0.0 Y0.0")
    assert (read(ways)[0].blocks == plain.blocks).all()
    # Both must stand there.
    assert wrong(PLACES.format(code="G90.1").replace(" J10.0", "")) == ["iso-arc"] * 3
    # What is said beside it does not count.
    _, found = read(PLACES.format(code="G90.1"), centres_in="start")
    assert "iso-stated" in [d.code for d in found]
    # Arcs in front of the code are asked for.
    late = "G21 G90\nG92 X0.0 Y0.0\nG01 X15.0 Y10.0\nG03 X15.0 Y10.0 I-5.0 J0.0\nG91.1\nM02\n"
    assert wrong(late) == ["iso-centres"]


# --- units ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("keys", "text", "mm"),
    [
        ('points = "inch"', "G91 G01 X.5", 12.7),
        ('points = "inch"', "G21 G91 G01 X.5", 0.5),
        ('points = "inch"', "G20 G91 G01 X.5", 12.7),
        ('points = "inch"', "G91 G01 X.5\nG21 X.0", 12.7),
        ("", "G91 G01 X.5", 0.5),
        ("", "G70 G91 G01 X.5", 12.7),
    ],
)
def test_what_a_point_is(keys, text, mm):
    program, found = read(text + "\nM02\n", profile=profile("", keys + "\n"))
    assert not [d for d in found if d.severity is Severity.ERROR]
    assert ends(program)[0][0] == pytest.approx(mm)


@pytest.mark.parametrize(
    ("integers", "words", "code", "mm"),
    [
        ("um", "", "", 5.0),
        ("mm", "", "", 5000.0),
        ("inch", "", "", 127_000.0),
        ("0.0001in", "", "", 12.7),
        ("um", "", "G20", None),
        ("mm", "", "G70", None),
        ("inch", "", "G21", None),
        ("0.0001in", "", "G21", None),
        ("0.0001in", "", "G20", 12.7),
        ("um", "G20", "G20", 12.7),
        ("um", "G70", "G70", 12.7),
        ("mm", "G20", "G20", 127_000.0),
        ("inch", "G21", "G21", 5000.0),
        ("0.0001in", "G21", "G21", 5.0),
    ],
)
def test_what_a_whole_number_is(integers, words, code, mm):
    path = f'[iso.words.path]\nG00-G03 = "a"\nG90-G91 = "b"\n{words} = "c"\n' if words else ""
    machine, found = machines.parse(BASE.replace('"mm"', f'"{integers}"') + path, "shop")
    assert found == []
    program, found = read(f"{code} G91 G01 X5000\nM02\n", profile=machine)
    if mm is None:
        assert [d.code for d in found] == ["iso-units"]
        assert "--whole-in" in found[0].hint
    else:
        assert not [d for d in found if d.severity is Severity.ERROR]
        assert ends(program)[0][0] == pytest.approx(mm)


def test_a_profile_says_what_stands_behind_semicolons():
    text = "G21 G91;\nG01 X5.0; G01 Y5.0; X-5.0\nM02;\n"
    for said, size in (("block", 3), ("comment", 1)):
        machine = profile("", f'semicolon = "{said}"\n')
        program, found = read(text, profile=machine)
        assert not [d for d in found if d.severity is Severity.ERROR]
        assert len(ends(program)) == size
        other = "comment" if said == "block" else "block"
        assert len(ends(read(text, profile=machine, semicolon_in=other)[0])) == 4 - size
    assert wrong(text, profile=profile("")) == ["iso-semicolon"]


# --- what of a file is run ------------------------------------------------------------------------

MAIN = "G21 G91\nG01 X5.0\nY5.0\n"


@pytest.mark.parametrize(
    ("text", "many", "by"),
    [
        (f"%\n{MAIN}%\nX7.0\nY7.0\nM02\n", "2 blocks", "(%)"),
        (f"%\n{MAIN}M30\n%\nX7.0\n", "a block", "(M30)"),
        (f"{MAIN}%\nG01 X7.0\n", "a block", "(%)"),
        (f"% (A)\n(50% SPEED)\n{MAIN}%G01 X7.0\n", "a block", "(%)"),
        (f"%\n%\n{MAIN}%\n%\nX7.0\n", "a block", "(%)"),
        (f"{MAIN}M2\nX7.0\nX8.0\nM60\nG05 X--1\nTHE END 5\n", "3 blocks", "(M2)"),
    ],
)
def test_blocks_behind_the_end_are_not_run_and_said(text, many, by):
    program, found = read(text)
    (one,) = [d for d in found if d.code == "after-end"]
    assert not [d for d in found if d.severity is Severity.ERROR]
    assert many in one.message
    assert by in one.message
    assert ends(program) == [[5, 0], [5, 5]]


def test_nothing_behind_the_end_is_nothing_to_say():
    for text in (f"%\n{MAIN}M02\n%\n", f"%{MAIN}M02%\n\n", f"%\n{MAIN}%\nM02\n\x1a\0\0"):
        assert not [d for d in read(text)[1] if d.code == "after-end"]


def test_a_percent_sign_in_a_number_is_no_digit():
    assert wrong("G21 G91\nG01 X5%6\nM02\n", whole_in="mm") == ["iso-word"]


@pytest.mark.parametrize("number", ["O1234", "o0001 (PLATE)", ":1234", "L002", "O1 G21", "L2(A)"])
@pytest.mark.parametrize("before", ["", "%\n", "(A)\n%\n\n"])
def test_the_number_of_a_program_is_no_call(number, before):
    program, found = read(f"{before}{number}\n{MAIN}M02\n".replace("G21 G21", "G21"))
    said = [d for d in found if d.code == "iso-ignored"]
    assert [str(d.severity) for d in said] == ["note"]
    assert said[0].message.startswith(re.match(r"\S+?(?=[( ]|$)", number)[0] + ": the number")
    assert not [d for d in found if d.severity > Severity.NOTE]
    assert len(ends(program)) == 2


@pytest.mark.parametrize("text", [f"{MAIN}L002\nM02\n", f"L2 X5.0\n{MAIN}M02\n", f"P1\n{MAIN}"])
def test_other_numbers_are_calls(text):
    assert "subprogram" in wrong(text)


def test_short_files_are_identified():
    for text in (
        " BRACKET LEFT\nG90\nG92 X0.0 Y0.0\nG01 X5.0 Y0.0\nM02\n",
        "PLATE\nG90\nG01 X5.0 Y0.0\nG01 X0.0\nM02\n",
        ":1234\nG90 G01 X5.0\nM02\n",
        "%\nO1\n(A)\nTITLE 5\nG90\nG01X5.\nY5.\nM30\n%\n",
    ):
        assert identify(text.encode()).format == "iso", text
    for text in ("PLATE\nTHE END\nG01 X5.0\n", "HELLO X5\nG01\nWORLD\n", "A\nB\nC\n"):
        seen = identify(text.encode())
        assert seen is None or seen.format != "iso", text


def test_a_bracket_that_is_open_is_an_error():
    """Some controllers read on to the next bracket, and leave out the lines between."""
    text = "G90 G21\nG92 X0.0 Y0.0\nG01 X5.0 (CUT Y3.0\nY5.0\nM02\n"
    assert wrong(text) == ["iso-word"]
    assert wrong(text.replace("Y3.0", "Y3.0)")) == []

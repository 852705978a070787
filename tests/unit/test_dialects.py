"""Profiles of wire machines: a program in the style of each is read as its machine means it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam import api, machines
from wedmcam.cli.main import cli
from wedmcam.diag import Severity
from wedmcam.frontends.identify import identify
from wedmcam.frontends.iso.dialect import QUESTIONS
from wedmcam.frontends.iso.style import style_of
from wedmcam.ir.program import Kind
from wedmcam.judge.difference import difference
from wedmcam.operations import convert
from wedmcam.targets import Entries

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
        done = convert.convert(text, to=to, profile_in=machine, name="a.nc")
        assert done.ok, [d.message for d in done.findings]
    assert api.verify(text, profile=machine, name="a.nc").ok
    assert len(program.blocks) == 4


def test_only_iso_is_read_alone():
    machine, found = machines.parse(BASE.format("writes = false\n").replace("iso", "3b"), "p")
    assert machine is None
    assert "writes" in found[0].message
    assert all(machines.builtin(name).writes for name in machines.DEFAULTS.values())
    assert wedmcam.compile(SAMPLES / "key.wed", profile="iso-um").ok


# --- a program in the style of each machine -------------------------------------------------------

#: What is entered at the controller for the programs without a table of their own, um.
ENTERED = {"makino": ((1, 120.0),), "robofil": ((0, 150.0),), "fanuc": ((1, 150.0),)}
DIALECTS = ("sodick", "makino", "robofil", "mitsubishi", "fanuc")


def text_of(name):
    return (ROOT / "tests" / "dialects" / f"{name}.nc").read_bytes()


def read(name, data=None, **said):
    entered = Entries(d=ENTERED.get(name, ()))
    given = {"entered": entered, "profile": name, "name": f"{name}.nc"} | said
    return api.read_program(text_of(name) if data is None else data, **given)


def quarter(radius):
    return math.pi / 2 * radius


def sodick():
    """Four passes about a plate of 20 x 10 with one corner of R 2; the fourth runs twice."""
    legs = []
    for d, back in ((210, 0), (150, 1), (140, 0), (130, 1), (130, 1)):
        ring = [  # where each block ends, and its length: counter-clockwise from the left side
            ((-d, 0), 5000),
            ((0, -d), quarter(d)),
            ((20000, -d), 20000),
            ((20000 + d, 0), quarter(d)),
            ((20000 + d, 8000), 8000),
            ((18000, 10000 + d), quarter(2000 + d)),
            ((0, 10000 + d), 18000),
            ((-d, 10000), quarter(d)),
            ((-d, 5000), 5000),
        ]
        if back:
            ends = [place for place, _ in ring]
            ring = list(zip([*ends[-2::-1], ends[-1]], [n for _, n in ring[::-1]], strict=True))
        lead = 3000 - d
        legs += [((-d, 5000), lead), *ring, ((-3000, 5000), lead)]
    return (-3000, 5000), legs


def makino():
    """An opening of 10 x 10 with one corner of R 2, a move, and a hole of R 3."""
    d = 120
    legs = [
        ((15000 - d, 10000), 5000 - d),
        ((15000 - d, 15000 - d), 5000 - d),
        ((7000, 15000 - d), 8000 - d),
        ((5000 + d, 13000), quarter(2000 - d)),
        ((5000 + d, 5000 + d), 8000 - d),
        ((15000 - d, 5000 + d), 10000 - 2 * d),
        ((15000 - d, 10000), 5000 - d),
        ((10000, 10000), 5000 - d),
        ((40000, 10000), None),  # a move
        ((43000 - d, 10000), 3000 - d),
        ((37000 + d, 10000), math.pi * (3000 - d)),
        ((43000 - d, 10000), math.pi * (3000 - d)),
        ((40000, 10000), 3000 - d),
    ]
    return (10000, 10000), legs


def opening(d, corner=1):
    """An opening of 12 x 8 from its middle, R 2 at the upper right or the lower left."""
    if corner == 1:
        legs = [
            ((6000 - d, 2000), 2000),
            ((4000, 4000 - d), quarter(2000 - d)),
            ((-6000 + d, 4000 - d), 10000 - d),
            ((-6000 + d, -4000 + d), 8000 - 2 * d),
            ((6000 - d, -4000 + d), 12000 - 2 * d),
            ((6000 - d, 0), 4000 - d),
        ]
    else:
        legs = [
            ((6000 - d, 4000 - d), 4000 - d),
            ((-6000 + d, 4000 - d), 12000 - 2 * d),
            ((-6000 + d, -2000), 6000 - d),
            ((-4000, -4000 + d), quarter(2000 - d)),
            ((6000 - d, -4000 + d), 10000 - d),
            ((6000 - d, 0), 4000 - d),
        ]
    return legs


def led(d, legs):
    return [((6000 - d, 0), 6000 - d), *legs, ((0, 0), 6000 - d)]


def robofil():
    return (0, 0), led(150, opening(150))


def mitsubishi():
    there, back = opening(190, 3), opening(150, 3)
    ends = [place for place, _ in back]
    back = list(zip([*ends[-2::-1], ends[-1]], [n for _, n in back[::-1]], strict=True))
    return (0, 0), [*led(190, there), *led(150, back)]


def fanuc():
    d = 150
    one = [
        ((4000 - d, 0), 4000 - d),
        ((4000 - d, 4000 - d), 4000 - d),
        ((-2000, 4000 - d), 6000 - d),
        ((-4000 + d, 2000), quarter(2000 - d)),
        ((-4000 + d, -4000 + d), 6000 - d),
        ((4000 - d, -4000 + d), 8000 - 2 * d),
        ((4000 - d, 0), 4000 - d),
        ((0, 0), 4000 - d),
    ]
    other = [((x + 15000, y), n) for (x, y), n in one]
    return (0, 0), [*one, ((15000, 0), None), *other]


EXPECTED = {f.__name__: f for f in (sodick, makino, robofil, mitsubishi, fanuc)}


@pytest.mark.parametrize("name", DIALECTS)
def test_a_program_of_each_dialect_is_stepped_as_its_machine_cuts(name):
    program, machine, found = read(name)
    assert errors(found) == []
    assert not {d.code for d in found} & (QUESTIONS | {"unknown-word"})
    start, legs = EXPECTED[name]()
    cuts = program.blocks["kind"] <= Kind.MOVE
    _, ends = api.positions(program, machine)
    assert (ends[cuts] + start).tolist() == [list(place) for place, _ in legs]
    moved = (program.blocks["kind"] == Kind.MOVE)[cuts]
    assert moved.tolist() == [length is None for _, length in legs]
    told = api.figures(program, machine)
    assert told["blocks"] == sum(length is not None for _, length in legs)
    assert told["closure_um"] == 0
    path = sum(length or 0 for _, length in legs) / 1000
    assert told["path_mm"] == pytest.approx(path, abs=0.001 * len(legs))


@pytest.mark.parametrize("name", DIALECTS)
def test_it_becomes_3b_and_comes_back(name):
    entered = Entries(d=ENTERED.get(name, ()))
    there = convert.convert(
        text_of(name), to="3b", profile_in=name, name=f"{name}.nc", entered=entered
    )
    assert there.ok, [d.message for d in there.findings]
    assert there.difference.distance_um == 0
    profile = name if machines.builtin(name).writes else "iso-mm"
    back = convert.convert(there.data, to="iso", profile=profile, name="a.3b")
    assert back.ok, [d.message for d in back.findings]
    again, machine, found = api.read_program(back.data, profile=profile, name="b.nc")
    assert errors(found) == []
    first, one, _ = read(name)
    apart = difference(again, first, machine.stepping, one.stepping)
    assert apart.equal
    assert apart.distance_um == 0


@pytest.mark.parametrize("name", DIALECTS)
def test_without_its_profile_it_is_asked_and_its_words_are_named(name):
    _, _, found = read(name, profile=None, format="iso")
    codes = {d.code for d in found if d.severity is Severity.ERROR}
    assert codes, "a program of a machine without a name was read"
    said = "\n".join(f"{d.message} {d.hint}" for d in found)
    asked = {
        "sodick": ["iso-units", "T84", "M98"],
        "makino": ["iso-units", "M06", "E1056"],
        "robofil": ["M60", "robofil"],
        "mitsubishi": ["L007", "M20"],
        "fanuc": ["M98"],
    }
    for what in asked[name]:
        assert what in said or what in codes, (what, said)


@pytest.mark.parametrize(
    ("name", "old", "new", "what"),
    [
        ("makino", "M18", "M60", "turns the part"),
        ("makino", "M18", "M63", "turns the part"),
        ("makino", "M18", "M98 P2", "calls a subprogram"),
        ("sodick", "T85", "Q0002", "calls up another file"),
        ("sodick", "T85", "C777", "checks whether the wire is vertical"),
        ("sodick", "T85", "G29", "no source states what it does"),
        ("robofil", "S101", "G38", "takes compensation up"),
        ("robofil", "S101", "M70", "goes back on the path"),
        ("mitsubishi", "M58", "M102", "moves the upper guide"),
        ("fanuc", "M00", "M60", "M60"),
    ],
)
def test_a_word_that_is_refused_says_why(name, old, new, what):
    data = text_of(name).replace(old.encode(), new.encode(), 1)
    assert data != text_of(name)
    _, _, found = read(name, data)
    wrong = [d for d in found if d.severity is Severity.ERROR]
    assert any(what in d.message for d in wrong), [d.message for d in found]


def test_another_h_inside_compensation_is_read_as_somebody_says():
    """Sodick programs take the lead with H000, then change; no source says more."""
    old = b"G42 H001 G01 X0.0 Y5.0; C001;"
    data = text_of("sodick").replace(old, b"G42 H000 G01 X0.0 Y5.0;\nH001 C001;")
    assert data != text_of("sodick")
    _, _, found = read("sodick", data)
    assert errors(found) == ["compensation-place"]
    own = machines.text("sodick").replace("[iso]\n", '[iso]\noffset_change = "skewed"\n')
    machine, wrong = machines.parse(own, "sodick")
    assert wrong == []
    program, machine, found = read("sodick", data, profile=machine)
    assert errors(found) == []
    _, ends = api.positions(program, machine)
    # The first block of the outline runs from the one offset to the other.
    start = np.array([-3000, 5000])
    assert (ends[:3] + start).tolist() == [[-10, 5000], [-210, 0], [0, -210]]
    nothing = data.replace(b"H000   = +000000.0100", b"H000   = +000000.0000")
    assert errors(read("sodick", nothing)[2]) == []


def test_a_word_that_a_dialect_does_not_name_is_said():
    data = text_of("mitsubishi").replace(b"M58", b"M59")
    _, _, found = read("mitsubishi", data)
    assert errors(found) == []
    assert any(d.code == "unknown-word" and "M59" in d.message for d in found)


@pytest.mark.parametrize(
    ("name", "old", "new", "code"),
    [
        ("makino", "X10.0 Y10.0", "X10000 Y10000", "iso-units"),
        ("robofil", "G71 ", "", "iso-units"),
        ("robofil", "G90 ", "", "iso-coordinates"),
        ("mitsubishi", "G71 ", "", "iso-units"),
        ("mitsubishi", "X6.0 Y0.", "X6000 Y0.", "iso-units"),
        ("fanuc", "G21 ", "", "iso-units"),
    ],
)
def test_what_a_source_does_not_state_is_asked(name, old, new, code):
    data = text_of(name).replace(old.encode(), new.encode(), 1)
    assert data != text_of(name)
    _, _, found = read(name, data)
    assert code in errors(found)


@pytest.mark.parametrize("name", ["makino", "robofil", "mitsubishi"])
def test_full_circles_do_not_tell_from_where_i_and_j_count(name):
    data = b"G90 G21\nG92 X0.0 Y0.0\nG01 X3.0 Y0.0\nG03 X3.0 Y0.0 I-3.0 J0.0\nG01 X0.0\nM02\n"
    _, _, found = read(name, data)
    assert "iso-centres" in errors(found)
    program, _, found = read(name, data, centres_in="start")
    assert errors(found) == []
    assert len(program.blocks) == 4


@pytest.mark.parametrize("name", DIALECTS)
def test_the_example_of_its_page_is_read(name):
    page = (ROOT / "docs" / f"iso-{name}.md").read_text("utf-8")
    text = re.search(r"```gcode\n(.*?)```", page, re.S)[1]
    said = {"units_in": "mm"} if name == "makino" else {}
    program, machine, found = read(name, text.encode(), **said)
    assert errors(found) == []
    assert not {d.code for d in found} & (QUESTIONS | {"unknown-word"})
    assert len(program.blocks) > 5
    assert api.figures(program, machine)["closure_um"] == 0


def words_of_page(page):
    """Return the words of the table of a page, with the source of each row; ranges as they are."""
    rows = page.split("## Words\n")[1].split("\n## ")[0].splitlines()
    cells = [[c.strip() for c in row.strip("|").split("|")] for row in rows if row.startswith("|")]
    assert [row[0] for row in cells[:2]] == ["word", "---"]
    found = {}
    for words, _, _, source in cells[2:]:
        for word in re.split(r", | and ", words):
            found[word.replace(" to ", "-")] = source
    return found


def source_of(key, page):
    """Return the source of a word, or of the row that has its range; None where none has it."""
    if key in page:
        return page[key]
    letter, *numbers = re.split(r"(\d+)", key)[:2]
    for word, source in page.items():
        ends = re.fullmatch(rf"{letter}(\d+)-{letter}(\d+)", word)
        if ends and numbers and int(ends[1]) <= int(numbers[0]) <= int(ends[2]):
            return source
    return None


#: Words of which it is known that no source states them: they are refused as such.
UNSTATED = {"sodick": {"G48", "G49"}, "mitsubishi": {"M98", "M99"}}


@pytest.mark.parametrize("name", [*DIALECTS, "linuxcnc", "grbl"])
def test_a_page_has_every_word_of_its_profile_with_a_source(name):
    text = (ROOT / "docs" / f"iso-{name}.md").read_text("utf-8")
    page = words_of_page(text)
    words = machines.builtin(name).iso.words
    refused = {key for key, _ in words.refused}
    keys = {key for key, _ in (*words.harmless, *words.refused, *words.path)}
    missing = {key for key in keys if source_of(key, page) is None}
    assert missing == set()
    without = {key for key in keys if not source_of(key, page)}
    assert without == UNSTATED.get(name, set())
    assert without <= refused
    if "| mark | source |" in text:
        marks = set(re.findall(r"^\| (\w+) \|", text.split("## Rules")[0], re.M))
        assert {m for source in page.values() for m in source.split(", ") if m} <= marks
        assert "## To the machine" in text
    assert re.search("^## Sources?$", text, re.M)


# --- writing --------------------------------------------------------------------------------------

WRITTEN = ("sodick", "makino")
NAMES = sorted(p.name for p in SAMPLES.iterdir() if p.suffix in (".dxf", ".wed"))


@pytest.mark.parametrize("profile", WRITTEN)
@pytest.mark.parametrize("name", NAMES)
def test_samples_are_written_in_words_of_the_dialect_and_read_back(name, profile):
    options = {"units": "mm"} if name == "damaged.dxf" else {}
    if name.endswith(".dxf"):
        options["offset"] = 0.1
    one = wedmcam.compile(SAMPLES / name, profile=profile, **options)
    assert one.ok, [d.message for d in one.findings]
    text = one.data.decode()
    rapid = {"G00"} if profile == "makino" else set()
    known = {"G40", "G90", "G92", "G01", "G02", "G03", "M00", "M02", *rapid}
    assert {w for w in text.split() if w[0] not in "XYIJ"} <= known
    assert all("." in w for w in text.split() if w[0] in "XYIJ")
    program, machine, found = api.read_program(one.data, profile=profile, name="a.nc")
    assert [d.code for d in found if d.severity > Severity.NOTE] == []
    apart = difference(program, one.program, machine.stepping, one.machine.stepping)
    assert apart.equal
    there = convert.convert(one.data, to="3b", profile_in=profile, name="a.nc")
    assert there.ok, [d.message for d in there.findings]
    back = convert.convert(there.data, to="iso", profile=profile, name="a.3b")
    assert back.ok, [d.message for d in back.findings]
    assert back.difference.distance_um == there.difference.distance_um == 0


@pytest.mark.parametrize("profile", WRITTEN)
def test_m_words_of_another_machine_are_no_words_of_a_dialect(profile):
    """M17 is machining on at Makino; what it is at a Fanuc machine no source states."""
    data = text_of("fanuc").replace(b"M00;", b"M17;\nM00;")
    done = convert.convert(
        data,
        to="iso",
        profile=profile,
        profile_in="fanuc",
        name="a.nc",
        entered=Entries(d=ENTERED["fanuc"]),
    )
    assert done.ok, [d.message for d in done.findings]
    assert b"M17" not in done.data
    assert any(d.code == "not-carried" and "M17" in d.message for d in done.findings)


# --- identify -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DIALECTS)
def test_identify_names_the_profile_that_knows_the_words(name):
    assert f"profile that knows its words: {name} (" in identify(text_of(name)).reason


@pytest.mark.parametrize(
    "text",
    [
        b"G90 G21\nG01 X5.0 Y0.0\nG01 X5.0 Y5.0\nM02\n",
        b"G90\nM06\nG01 X5.0 Y0.0\nG01 X5.0 Y5.0\nM30\n",  # one word is no style
        b"G90\nM98 P7\nG01 X5.0 Y0.0\nM02\n",  # a call of what is not there
    ],
)
def test_identify_names_no_profile_where_words_do_not_tell(text):
    seen = identify(text)
    assert seen.format == "iso"
    assert "profile" not in seen.reason


def test_identify_counts_at_most_a_thousand_different_words():
    lines = "".join(f"S{n} G01 X{n}.0\n" for n in range(20_000))
    calls = "".join(f"M98 P{n}\n" for n in range(4_000)) + "M98 " * 20_000
    for text, said in ((lines, "robofil (S0, S1, S2, S3 and 996 more)"), (calls, "")):
        assert style_of(text.encode()).endswith(said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"M98 P1\nM02\nN0001\nM99\nT84\n", "sodick (M98, M99, T84)"),
        (b"M98 P1 (NO LABEL)\nM02\nX1 N0001\nM99\nT84\nC1\n", "sodick (C1, M99, T84)"),
        (b"M98 P0100;\nM30;\nO100;\nM99;\n", "fanuc (M98, M99)"),
    ],
)
def test_words_are_shown_as_the_file_has_them(text, said):
    assert style_of(text, ended=b";" in text) == f"profile that knows its words: {said}"


def test_words_that_a_conversion_loses_are_named_as_lost():
    """Where a program is shown a note is enough; of a conversion it is a loss, and a warning."""
    text = b"G90;\nG92 X0.0 Y0.0;\nT84;\nC001;\nG01 X5.0 Y0.0;\nG01 Y5.0;\nT85;\nT84;\nM02;\n"
    _, _, found = api.read_program(text, name="a.nc", profile="sodick", shown=True)
    assert [(str(d.severity), d.code) for d in found] == [("note", "iso-harmless")]
    done = convert.convert(text, to="3b", name="a.nc", profile_in="sodick")
    (lost,) = [d for d in done.findings if d.code == "not-carried"]
    assert lost.severity is Severity.WARNING
    assert "T84 (2 times): pump on" in lost.message
    for word in ("C001", "T85"):
        assert word in lost.message
    assert not convert.convert(text, to="3b", name="a.nc", profile_in="sodick", strict=True).ok


def test_identify_knows_programs_that_are_written_for_linuxcnc_and_grbl():
    for name in ("linuxcnc", "grbl"):
        one = wedmcam.compile(SAMPLES / "key-punch.dxf", profile=name, offset=0.1, feed=2.0)
        assert identify(one.data).reason.endswith("open programs so: grbl and linuxcnc")


@pytest.mark.parametrize("name", ["linuxcnc", "grbl"])
def test_what_linuxcnc_and_grbl_say_is_asked_of_no_program(name):
    """Comments stand behind semicolons there, and a start that is said in two lines is said so."""
    text = b"G21 G90\nG00 X0 Y0 ; G01 X9\nG01 X5 F1\nM02\n"
    program, _, found = api.read_program(text, name="a.nc", profile=name)
    assert program is not None
    assert not errors(found)
    halves = b"G21 G90\nG00 X5\nG00 Y3\nG01 X10 F1\nM02\n"
    assert "iso-start" in [d.code for d in api.read_program(halves, name="a.nc", profile=name)[2]]
    whole = b"G20 G90\nG00 X1.0 Y1.0\nG01 X2 F1\nM02\n"
    (asked,) = [d for d in api.read_program(whole, name="a.nc", profile=name)[2] if d.severity > 1]
    assert "--whole-in inch" in asked.hint

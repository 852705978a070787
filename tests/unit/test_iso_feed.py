"""F wherever a program with one is written, and what GRBL makes of F and of a line."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam.cli.main import cli
from wedmcam.machines import builtin
from wedmcam.operations import convert

SAMPLES = Path(__file__).parents[2] / "samples"
PLATE = str(SAMPLES / "plate.dxf")
WORDS = [f"M{n}" for n in range(31, 55)]
ASKED = ("--offset", "0.1", "--profile", "linuxcnc")


def run(*line):
    done = CliRunner().invoke(cli, [*map(str, line)], standalone_mode=False)
    if done.exception:
        raise done.exception
    return done.return_value or 0, done.stdout, done.stderr


def feeds(name):
    return [t for t in Path(name).read_text().splitlines() if t.startswith("F")]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("line", "file"),
    [
        (("compile", PLATE, "-o", "a.ngc", *ASKED), "a.ngc"),
        (("compile", PLATE, "-o", "a", "--to", "3b,iso", *ASKED), "a.nc"),
        (("compile", PLATE, "-o", "a.ngc", "--split", *ASKED), "a.ngc"),
        (("compile", PLATE, "-o", "a.ngc", "--from-block", "9", *ASKED), "a.ngc"),
        (("compile", PLATE, "-o", "a.ngc", "--from-block", "9", "--backwards", *ASKED), "a.ngc"),
        (("compile", PLATE, "-o", "a.ngc", "--cuts", "2-3", *ASKED), "a.ngc"),
        (("batch", PLATE, "-o", "out", *ASKED), "out/plate.nc"),
        (("check", PLATE, *ASKED), None),
        (("plot", PLATE, "-o", "a.svg", *ASKED), None),
    ],
)
def test_feed_is_taken_by_all_that_write_or_check(here, line, file):
    for feed, said in (("2.5mm", "F2.5"), (None, "F1.0")):
        more = ("--feed", feed) if feed else ()
        status, _, err = run(*line, *more)
        assert status == 0, err
        assert ("feed-assumed" in err) is (feed is None)
        if file:
            assert feeds(file) == [said]


def test_loads_have_their_f(here):
    small = Path("small.toml")
    shown = run("profile", "show", "linuxcnc")[1]
    small.write_text(shown.replace("# blocks is not set", "blocks = 30"))
    line = ("compile", PLATE, "-o", "a.ngc", "--split", "--profile", "small.toml")
    assert run(*line, "--offset", "0.1", "--feed", "2")[0] == 0
    assert [feeds(f"a-{n}.ngc") for n in (1, 2, 3)] == [["F2.0"]] * 3


def test_convert_writes_f_and_says_where_there_is_none(here):
    assert run("compile", PLATE, "-o", "a.3b", "--offset", "0.1")[0] == 0
    status, out, err = run("convert", "a.3b", "-o", "a.ngc", "--profile", "grbl", "--json")
    assert status == 0
    assert "feed-assumed" in err
    assert "feed-assumed" in out
    line = ("convert", "a.3b", "-o", "b.ngc", "--profile", "grbl", "--feed", "2500um")
    status, _, err = run(*line, "--strict")
    assert status == 0
    assert "feed-assumed" not in err
    assert feeds("b.ngc") == ["F2.5"]
    for output in ("c.nc", "c.zd", "c.svg"):
        _, _, err = run("convert", "a.3b", "-o", output, "--feed", "2")
        assert "warning: --feed has no effect" in err
    made = convert.convert("a.3b", profile="linuxcnc", feed_um=3000.0)
    assert b"\nF3.0\n" in made.data


def test_verify_repeats_the_feed_of_a_certificate(here):
    line = ("compile", PLATE, "-o", "a.ngc", *ASKED, "--feed", "2.5", "--certificate", "a.json")
    assert run(*line)[0] == 0
    assert json.loads(Path("a.json").read_text())["options"]["feed_um"] == 2500.0
    status, _, err = run("verify", "a.ngc", "--certificate", "a.json", "--against", PLATE)
    assert status == 0
    assert "certificate-differs" not in err
    text = Path("a.ngc").read_text().replace("F2.5", "F9.0")
    Path("a.ngc").write_text(text)
    _, _, err = run("verify", "a.ngc", "--certificate", "a.json", "--against", PLATE)
    assert "certificate-differs" in err


def test_time_and_feed_of_check_and_batch(here):
    _, out, err = run("check", PLATE, *ASKED, "--feed", "2.5", "--json")
    assert json.loads(out)["feed_mm_per_min"] == 2.5
    assert "min" in err
    _, out, _ = run("batch", PLATE, "-o", "out", *ASKED, "--feed", "2.5", "--json")
    assert json.loads(out)["minutes"] > 0


def test_a_shop_says_its_feed_once(here):
    Path("wedmcam.toml").write_text('feed = "2.5mm"\nprofile = "linuxcnc"\noffset = 0.1\n')
    Path("part.dxf").write_bytes(Path(PLATE).read_bytes())
    assert run("compile", "part.dxf", "-o", "a.ngc")[0] == 0
    assert run("batch", "part.dxf", "-o", "out")[0] == 0
    assert run("compile", "part.dxf", "-o", "a.3b", "--profile", "b3-compact")[0] == 0
    assert run("convert", "a.3b", "-o", "b.ngc")[0] == 0
    assert [feeds(f) for f in ("a.ngc", "out/part.nc", "b.ngc")] == [["F2.5"]] * 3


@pytest.mark.parametrize(("feed", "raised"), [(0.999, 1), (1.0, 0), (0.01, 1), (2.0, 0)])
def test_grbl_goes_no_slower_than_1_mm_a_minute(feed, raised):
    made = wedmcam.compile(PLATE, profile="grbl", offset=0.1, feed=feed)
    assert made.ok
    said = [d for d in made.findings if d.code == "feed-raised"]
    assert len(said) == raised
    assert all("1 mm a minute" in d.message for d in said)
    other = wedmcam.compile(PLATE, profile="linuxcnc", offset=0.1, feed=feed)
    assert "feed-raised" not in [d.code for d in other.findings]


@pytest.mark.parametrize(
    ("line", "long"),
    [
        ("G21" + " " * 200, False),
        ("G21 (" + "A LONG WORD " * 20 + ")", False),
        ("G21 ;" + "A LONG WORD " * 20, False),
        (" ".join(["G17", *WORDS[:24], "M103"]), False),
        (" ".join(["G17", *WORDS[:23], "M103", "M104"]), True),
        (" ".join(["(" + "A" * 90 + ") G17", *WORDS[:23], "M103", "M104"]), True),
    ],
)
def test_a_line_that_is_too_long_for_grbl(line, long):
    grbl = builtin("grbl")
    for layout in (
        replace(grbl.layout, header=(*grbl.layout.header, line)),
        replace(grbl.layout, footer=(line,)),
    ):
        made = wedmcam.compile(PLATE, profile=replace(grbl, layout=layout), offset=0.1, feed=2.0)
        assert made.ok, [d.message for d in made.findings]
        said = [d for d in made.findings if d.code == "over-line"]
        assert len(said) == long
        if long:
            number = made.data.decode().splitlines().index(line) + 1
            assert f"line {number} has 80 characters, grbl takes 79" in said[0].message


def test_the_lines_of_a_program_are_counted_too():
    grbl = builtin("grbl")
    wide = replace(grbl, iso=replace(grbl.iso, width=12, decimals=5, sign="always"))
    tight = replace(wide, limits=replace(wide.limits, line_chars=40))
    found = [d for d in wedmcam.compile(PLATE, profile=tight, offset=0.1, feed=2.0).findings
             if d.code == "over-line"]  # fmt: skip
    assert len(found) == 1
    assert found[0].count > 1
    free = replace(wide, limits=replace(wide.limits, line_chars=0))
    made = wedmcam.compile(PLATE, profile=free, offset=0.1, feed=2.0)
    assert "over-line" not in [d.code for d in made.findings]

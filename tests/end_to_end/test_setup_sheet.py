"""--setup-sheet: holes, zero and stops are those of the program that is written."""

import math
from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.reports.setup_sheet import sheet

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.parametrize("to", ["3b", "compact", "iso"])
def test_every_hole_and_every_stop(to):
    made = wedmcam.compile(SAMPLES / "plate.dxf", to=to, offset=0.1, stop=0.5)
    assert made.ok
    told = dict(sheet(made, "plate", 2500.0))
    holes = told["Start holes"][1]
    want = [(c.thread[0] / 1000, c.thread[1] / 1000) for c in made.plan.cuts]
    assert [(float(h[1]), float(h[2])) for h in holes] == want
    x0, y0 = want[0]
    assert [(float(h[3]), float(h[4])) for h in holes] == [
        (pytest.approx(x - x0, abs=1e-6), pytest.approx(y - y0, abs=1e-6)) for x, y in want
    ]
    does = [row[2] for row in told["Where the machine stops"][1]]
    n = len(want)
    assert sum("thread the wire" in d for d in does) == n
    assert sum("hold the piece" in d for d in does) == n
    assert sum("cut the wire, generator off" in d for d in does) == n - 1
    assert does[-1].startswith("the end")
    minutes = sum(float(h[8].split()[0]) for h in holes)
    assert minutes == pytest.approx(made.verdict.path_mm / 2.5, abs=0.1 * n)


@pytest.mark.parametrize("ending", ["md", "txt", "html"])
def test_it_is_written_with_the_program(tmp_path, ending):
    line = ["compile", str(SAMPLES / "punch-die.wed"), "-o", str(tmp_path / "a.3b")]
    done = CliRunner().invoke(cli, [*line, "--setup-sheet", str(tmp_path / f"a.{ending}"), "-q"])
    assert done.exit_code == 0, done.output
    text = (tmp_path / f"a.{ending}").read_text("utf-8")
    assert "T2" in text
    assert text.startswith("<!doctype html>") == (ending == "html")
    assert CliRunner().invoke(cli, [*line, "--setup-sheet", "s.md", "--split"]).exit_code == 2


def test_it_says_what_was_understood_and_when_what_comes_loose():
    made = wedmcam.compile(SAMPLES / "plate.dxf", offset=0.1)
    told = dict(sheet(made, "plate.3b", wire_um=180.0, gap_um=10.0))
    facts = dict(told["Setup sheet"][1])
    assert facts["cuts"] == "1 outer, 9 holes"
    assert facts["wire, gap"].startswith("wire 0.180 mm, gap 0.010 mm: offset 0.100 mm")
    assert facts["direction"] == "10 ccw"
    rows = told["Contours"][1]
    assert [r[0] for r in rows] == [f"{n} (T{n})" for n in range(1, 11)]
    assert [r[1:] for r in rows] == [r.cells[1:] for r in made.understood.rows]
    free = told["What comes loose"][1]
    assert len(free) == 10
    # The first hole, R 3 about (10, 10): through where the path is back at (12.9, 10).
    block, along, there, zero, what = free[0]
    assert (there, zero) == ("(12.900, 10.000)", "(2.900, 0.000)")
    assert float(along) == pytest.approx(2.9 * (1 + 2 * math.pi), abs=1e-3)
    assert what == (
        "the slug of contour 1 (hole, 6.000 x 6.000 mm) is loose; the machine does not wait"
    )
    ends = api.positions(made.program, made.machine)[1]
    assert ends[int(block) - 1].tolist() == [12900, 10000]
    assert "the part of contour 10 (outer contour" in free[-1][-1]


def test_what_the_offset_is_of_is_asked_for_and_not_guessed():
    made = wedmcam.compile(SAMPLES / "cam.dxf", offset=0.1)
    facts = dict(dict(sheet(made, "cam"))["Setup sheet"][1])
    assert facts["wire, gap"].startswith("not stated")


@pytest.mark.parametrize("profile", ["iso-g41", "b4-compact", "zd065-compensation"])
def test_slugs_are_found_where_the_controller_makes_the_path(profile):
    made = wedmcam.compile(SAMPLES / "plate.dxf", offset=0.1, profile=profile)
    assert made.ok, made.findings
    free = dict(sheet(made, "plate"))["What comes loose"][1]
    assert len(free) == 10


def test_a_picture_stands_in_it(tmp_path):
    line = ["compile", str(SAMPLES / "cam.dxf"), "-o", str(tmp_path / "a.3b"), "--offset", "0.1"]
    for ending, want in (
        ("html", "<svg"),
        ("md", "[picture]: data:image/svg+xml"),
        ("txt", "--plot"),
    ):
        done = CliRunner().invoke(cli, [*line, "--setup-sheet", str(tmp_path / f"s.{ending}")])
        assert done.exit_code == 0, done.output
        assert want in (tmp_path / f"s.{ending}").read_text("utf-8")
    more = ["--setup-sheet", str(tmp_path / "s.md"), "--plot", str(tmp_path / "pictures.svg")]
    assert CliRunner().invoke(cli, [*line, *more]).exit_code == 0
    assert "![pictures.svg](pictures.svg)" in (tmp_path / "s.md").read_text("utf-8")


def test_each_contour_has_its_own_offset(tmp_path):
    """Once only the largest of all was told."""
    part = tmp_path / "two.wed"
    part.write_text(
        "contour sq { from (0, 0) line to (20, 0) line to (20, 20) line to (0, 20) close }\n"
        "contour h { circle center (10, 10) radius 3 }\n"
        "contour s { circle center (5, 5) radius 1 }\n"
        "cut s on\ncut h inside offset 0.2\ncut sq outside offset 0.1\n"
    )
    line = ["compile", str(part), "-o", str(tmp_path / "two.3b")]
    done = CliRunner().invoke(cli, [*line, "--setup-sheet", str(tmp_path / "two.md")])
    assert done.exit_code == 0, done.output
    assert "3 cut, offset 0.000, 0.100, 0.200 mm" in done.output
    rows = [r.split("|") for r in (tmp_path / "two.md").read_text().splitlines() if "| T" in r]
    assert [row[7].strip() for row in rows] == ["0.000", "0.200", "0.100"]

"""--setup-sheet: holes, zero and stops are those of the program that is written."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam.cli.main import cli
from wedmcam.setup_sheet import sheet

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

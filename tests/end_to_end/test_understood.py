"""Screen, JSON, certificate, sheet, page, picture and batch say the same of every contour."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam.cli.main import cli

SAMPLES = Path(__file__).parents[2] / "samples"


def run(*words):
    done = CliRunner().invoke(cli, list(map(str, words)))
    assert done.exit_code == 0, done.output
    return done


@pytest.mark.parametrize(
    ("name", "options", "counts"),
    [
        ("plate.dxf", ["--offset", "0.1"], "1 outer, 9 holes"),
        ("gear.wed", [], "1 outer, 1 hole"),
        ("cam.dxf", ["--offset", "0.1", "--reverse", "--stop", "0.5"], "1 outer, 1 hole"),
    ],
)
def test_every_output_has_the_same_rows(tmp_path, name, options, counts):
    out = {k: tmp_path / f"p.{k}" for k in ("3b", "json", "html", "svg")}
    sheet = tmp_path / "sheet.html"
    line = ["compile", SAMPLES / name, "-o", out["3b"], "--certificate", out["json"], *options]
    done = run(*line, "--plot", out["svg"], "--setup-sheet", sheet, "--json", "-v")
    run("plot", SAMPLES / name, "-o", out["html"], *options, "-q")
    summary = json.loads(done.stdout)
    rows = json.loads(out["json"].read_text("utf-8"))["understood"]
    assert summary["understood"] == rows
    mm = {"offset": 0.1} if "--offset" in options else {}
    more = {"reverse": True, "stop": 0.5} if "--stop" in options else {}
    known = wedmcam.compile(SAMPLES / name, **mm, **more).understood
    assert rows == known.as_data()
    assert f"understood cuts {counts}\nverified " in done.stderr
    shown = [re.split(r"  +", text.strip()) for text in done.stderr.splitlines() if " T" in text]
    assert [s[1:] for s in shown if re.fullmatch(r"T\d+", s[0])] == [
        list(row.cells[1:]) for row in known.rows
    ]
    page, paper, picture = (
        html.unescape(file.read_text("utf-8")) for file in (out["html"], sheet, out["svg"])
    )
    assert f"cuts {counts}" in page
    assert counts in paper
    assert counts in picture
    for row in known.rows:
        for cell in row.cells[1:]:
            assert cell in page
            assert cell in paper
        assert row.text.partition(": ")[2] in picture
    for said in known.threads:
        assert said in done.stderr
        assert said in page
        assert said in paper


def test_batch_and_verify_and_check_say_it_and_quiet_does_not(tmp_path):
    line = [SAMPLES / "plate.dxf", "--offset", "0.1"]
    many = run("batch", *line, "-o", tmp_path, "--jobs", "1")
    assert "plate.dxf: cuts 1 outer, 9 holes; " in many.stderr
    record = run("batch", *line, "-o", tmp_path, "--jobs", "1", "--json", "-q")
    assert "cuts 1 outer" not in record.stderr
    assert len(json.loads(record.stdout)["understood"]) == 10
    assert "understood cuts 1 outer, 9 holes" in run("check", *line).stderr
    against = ["--against", SAMPLES / "plate.dxf", "--offset", "0.1"]
    assert (
        "understood cuts 1 outer, 9 holes" in run("verify", tmp_path / "plate.3b", *against).stderr
    )
    assert "contours     1 outer, 9 holes; " in run("inspect", SAMPLES / "plate.dxf").stdout
    quiet = run("compile", *line, "-o", tmp_path / "q.3b", "-q")
    assert "cuts 1 outer" not in quiet.output


def test_several_formats_list_the_contours_once(tmp_path):
    done = run("compile", SAMPLES / "gear.wed", "--to", "3b,iso", "-o", tmp_path / "g")
    assert len(re.findall(r"^ +T1 ", done.stderr, re.M)) == 1
    assert done.stderr.count("understood cuts 1 outer, 1 hole") == 2

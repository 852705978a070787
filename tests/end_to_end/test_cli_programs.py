"""The commands on programs: diff, explain --block, verify by itself, --feed, --metamorphic."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pytest
from click.testing import CliRunner

from wedmcam.cli.main import cli
from wedmcam.options import WrongUse

ROOT = Path(__file__).parents[2]
GOLDEN, SAMPLES = ROOT / "tests" / "golden", ROOT / "samples"


def run(*arguments):
    return CliRunner().invoke(cli, [str(a) for a in arguments], standalone_mode=False)


def status(result):
    """What is returned; wrong use is raised, and is 2."""
    if result.exception is None:
        return result.return_value
    return getattr(result.exception, "exit_code", 2 * isinstance(result.exception, WrongUse))


def test_diff_status():
    one, same, other = GOLDEN / "plate.3b", GOLDEN / "plate.zd", GOLDEN / "gear-24.3b"
    result = run("diff", one, same)
    assert (status(result), result.stdout) == (0, "equal: at most 1.00 um apart\n")
    assert status(run("diff", one, same, "--within", "0.5um")) == 1
    result = run("diff", one, other)
    assert status(result) == 1
    assert result.stdout.startswith("different: ")
    assert "block 2 of " in result.stdout
    result = run("diff", one, other, "--json")
    assert json.loads(result.stdout)["block_a"] == 2
    assert run("diff", one, other, "-q").stdout == ""


def test_diff_of_what_cannot_be_read(tmp_path):
    bad = tmp_path / "bad.3b"
    bad.write_bytes(b"hello\n")
    assert status(run("diff", GOLDEN / "plate.3b", bad)) == 2
    assert status(run("diff", bad, GOLDEN / "plate.3b")) == 2
    assert status(run("diff", GOLDEN / "plate.3b", tmp_path / "none.3b")) == 2


@pytest.mark.parametrize(
    ("file", "block", "said"),
    [
        ("gear-24.3b", 2, ["counter-clockwise arc, radius 7.900000", "NR1: on an axis", "GXNR1"]),
        ("gear-24.zd", 3, ["clockwise arc", "SR3: where the start lies", "inscribed square"]),
        ("key-punch.3b", 1, ["line along (2.900, 0.000)", "counted on x: x is the longer", "+x"]),
        ("plate.3b", 4, ["record     D", "pause; nothing moves"]),
    ],
)
def test_explain_a_block(file, block, said):
    result = run("explain", GOLDEN / file, "--block", block)
    assert status(result) == 0
    for text in said:
        assert text in result.stdout


def test_explain_a_published_step_table(tmp_path):
    """Line to (6, 4): axes X Y X Y X X Y X Y X, F = -4 2 -2 4 0 -4 2 -2 4 0."""
    program = tmp_path / "line.3b"
    program.write_bytes(b"B6B4B6GXL1\n")
    lines = run("explain", program, "--block", 1).stdout.splitlines()
    head = next(k for k, text in enumerate(lines) if text.split()[:2] == ["n", "step"])
    rows = [text.split() for text in lines[head + 1 : head + 11]]
    assert [r[1] for r in rows] == ["+" + a for a in "xyxyxxyxyx"]
    assert [int(r[4]) for r in rows] == [-4, 2, -2, 4, 0, -4, 2, -2, 4, 0]


def test_explain_tells_j_and_draws_a_short_block(tmp_path):
    """NR4 from (5, -1): a table of all its steps, J to 0, and the stair with their numbers."""
    program = tmp_path / "arc.zd"
    program.write_bytes(bytes.fromhex("24 00000005 00000001 000008 01 000300 000400 00"))
    said = run("explain", program, "--block", 1).stdout.splitlines()
    head = next(k for k, text in enumerate(said) if text.split()[:2] == ["n", "step"])
    rows = [text.split() for text in said[head + 1 : head + 12]]
    assert said[head].split() == ["n", "step", "x", "y", "F", "J"]
    assert [int(r[5]) for r in rows] == [7, 6, 6, 5, 4, 3, 3, 3, 2, 1, 0]
    assert "".join(r[1][1] for r in rows) == "yyxyyyxyxxx"
    stair = next(k for k, text in enumerate(said) if text.startswith("stair"))
    assert [text.strip() for text in said[stair + 1 : stair + 6]] == [
        "y", "6  11---10---9----8", "|", "5                 7----6", "|",
    ]  # fmt: skip
    # A long one has its first steps, and no stair.
    said = run("explain", program, "--block", 2).stdout
    assert "steps      700; the first 12" in said
    assert "stair" not in said


@pytest.mark.parametrize(
    "record",
    ["B6B4B6GXL1", "B3B3B3GYL3", "B3B3B3GXL2", "B0B5B5GYL4", "B5B0B8GXNR1", "B3B4B9GYSR3"],
)
def test_explain_counts_j_down_to_0(tmp_path, record):
    """On the axis that the record says, whatever the line table; the last place is the last one of
    the stair."""
    program = tmp_path / "one.3b"
    program.write_text(f"{record}\n")
    said = run("explain", program, "--block", 1).stdout.splitlines()
    head, stair = (
        next(k for k, text in enumerate(said) if text.split()[:1] == [word])
        for word in ("n", "stair")
    )
    rows = [text.split() for text in said[head + 1 : stair]]
    left = [int(record.split("B")[3].split("G")[0]), *(int(r[5]) for r in rows)]
    axis = record.split("G")[1][0].lower()
    assert [a - b for a, b in pairwise(left)] == [r[1][1] == axis for r in rows]
    assert left[-1] == 0
    assert any(str(len(rows)) in text for text in said[stair + 1 :])


def test_explain_wrong_use():
    assert status(run("explain", GOLDEN / "plate.3b", "--block", 999)) == 2
    assert "give --block N" in str(run("explain", GOLDEN / "plate.3b").exception.message)
    assert status(run("explain", "gouge")) == 0


def test_verify_without_a_drawing_tells_figures():
    result = run("verify", GOLDEN / "plate.3b", "--json", "--feed", "2.5mm")
    told = json.loads(result.stdout)
    assert told["blocks"] == 70
    assert told["closure_um"] == 0
    assert told["minutes"] == pytest.approx(told["path_mm"] / 2.5, abs=0.01)
    assert told["limits"]["count_um"]["margin"] == 999_999 - told["limits"]["count_um"]["largest"]
    assert told["reversals"]["x"] > 0
    text = run("verify", GOLDEN / "plate.3b", "--feed", "2.5mm").stderr
    assert "3 h 22 min" in text
    assert status(run("verify", GOLDEN / "plate.3b", "--feed", "0")) == 2


def test_compile_tells_the_time(tmp_path):
    out = tmp_path / "p.3b"
    asked = ["compile", SAMPLES / "key-punch.dxf", "-o", out, "--offset", "0.1", "--feed", "1mm"]
    result = run(*asked, "--json")
    told = json.loads(result.stdout)
    assert told["minutes"] == pytest.approx(told["path_mm"], abs=0.01)
    assert "of cutting at 1.000 mm/min" in run(*asked).stderr


def test_verify_metamorphic():
    drawing = SAMPLES / "key-punch.dxf"
    asked = ["verify", GOLDEN / "key-punch.3b", "--against", drawing, "--offset", "0.1"]
    result = run(*asked, "--metamorphic", "--json")
    assert status(result) == 0
    images = json.loads(result.stdout)["metamorphic"]
    assert len(images) == 7
    assert all(i["ok"] for i in images)
    assert "image      rotated by 90 degrees" in run(*asked, "--metamorphic").stderr
    assert status(run("verify", GOLDEN / "key-punch.3b", "--metamorphic")) == 2


def test_diff_takes_a_profile_for_the_programs_of_its_format(tmp_path):
    path = tmp_path / "p.nc"
    drawing = str(SAMPLES / "plate.dxf")
    line = ["compile", drawing, "-o", str(path), "--offset", "0.1", "--profile", "iso-mm", "-q"]
    assert status(run(*line)) == 0
    old = GOLDEN / "plate.3b"
    for one, two in ((old, path), (path, old)):
        assert status(run("diff", one, two, "--profile-in", "iso-mm")) == 0
    assert status(run("diff", old, path, "--profile-b", "iso-mm")) == 0
    result = run("diff", old, path, "--profile", "iso-mm")
    assert status(result) == 2
    assert "--profile iso-mm is for iso, and" in str(result.exception)

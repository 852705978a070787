"""``convert`` with what the operator of a ZD-065 enters: copies and angle, gap and side."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_cli_programs import run, status

from wedmcam import api

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests" / "golden"


def test_copies_of_a_figure(tmp_path):
    """A line of 20 mm, heading 30 degrees, and two copies."""
    figure, out = tmp_path / "a.zdr", tmp_path / "a.3b"
    figure.write_bytes(bytes.fromhex("01 02 30000000 020000 00"))
    assert status(run("convert", figure, "-o", out, "--copies", "2", "--angle", "60")) == 0
    assert out.read_text() == (
        "B17321B10000B17321GXL1\nB0B20000B20000GYL2\nB17321B10000B17321GXL2\nDD\n"
    )


@pytest.mark.parametrize(("side", "x", "steps"), [("part", 2100, 16800), ("die", 1900, 15200)])
def test_a_gap(tmp_path, side, x, steps):
    """A circle of R 2 mm in the compensation format, cut as a punch and as a die."""
    outline, out = tmp_path / "a.zdc", tmp_path / "a.3b"
    outline.write_bytes(bytes.fromhex("21 01 00002000 00002000 00000000 011314 00"))
    assert status(run("convert", outline, "-o", out, "--gap", "0.1", "--side", side)) == 0
    program, machine, _ = api.read_program(out)
    assert program.blocks["x"][0] == x
    # The controller scales J too, and rounds: a step more or less than the circle has.
    assert abs(api.figures(program, machine)["steps"] - steps) <= 3


def test_a_path_becomes_an_outline_and_its_gap(tmp_path):
    made = api.compile(ROOT / "samples" / "cam.dxf", offset=0.1, corner=0.3)
    path, outline, back = (tmp_path / name for name in ("a.3b", "a.4b", "b.3b"))
    path.write_bytes(made.data)
    assert status(run("convert", path, "-o", outline, "--gap", "0.1")) == 0
    assert status(run("convert", outline, "-o", back, "--gap", "0.1")) == 0
    assert status(run("diff", path, back)) == 0
    assert status(run("convert", outline, "-o", back)) == 1
    assert status(run("convert", outline, "-o", back, "--gap", "0")) == 0  # the outline itself
    assert status(run("diff", path, back)) == 1


def test_compile_says_what_to_enter(tmp_path):
    cam = [ROOT / "samples" / "cam.dxf", "--offset", "0.1", "--corner", "0.3", "--side", "die"]
    cam += ["--ignore-layer", "START"]
    done = run("compile", *cam, "-o", tmp_path / "a.4b")
    assert status(done) == 0
    assert "enter      gap 0.100 mm, die (inwards)" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["b.zd", "--copies", "3", "--angle", "9"], "in rotation format, not 3b"),
        (["b.zd", "--gap", "0.1"], "for the compensation format"),
        (["b.zdc", "--gap", "0.0005"], "a whole number of um"),
    ],
)
def test_wrong_use(arguments, said, tmp_path):
    output, *more = arguments
    result = run("convert", GOLDEN / "plate.3b", "-o", tmp_path / output, *more)
    assert status(result) == 2
    assert said in str(result.exception)


def test_copies_go_with_an_angle(tmp_path):
    figure = tmp_path / "a.zdr"
    figure.write_bytes(bytes.fromhex("01 02 30000000 020000 00"))
    for more, said in (
        (["--copies", "2"], "go together"),
        (["--copies", "100", "--angle", "1"], "0 to 99"),
    ):
        result = run("convert", figure, "-o", tmp_path / "a.3b", *more)
        assert status(result) == 2
        assert said in str(result.exception)

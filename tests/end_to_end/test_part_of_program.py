"""A program as a part program: compiled again it is the same step path, or it is refused."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from parts import dxf_bytes, random_part
from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.diag import Severity
from wedmcam.judge.difference import difference
from wedmcam.operations import convert
from wedmcam.options import Options
from wedmcam.targets import Entries

ROOT = Path(__file__).parents[2]
GOLDEN = sorted(p.name for p in (ROOT / "tests/golden").iterdir() if p.suffix != ".py")
GOLDEN = [n for n in GOLDEN if n.endswith((".3b", ".zd", ".nc", ".4b"))]

#: Profiles of golden ISO programs that do not state their unit; the others need none.
READ_AS = {
    "plate.fixed.nc": "iso-fixed",
    "plate.g41.nc": "iso-g41",
    "plate.um.nc": "iso-um",
}


def again(data: bytes, name: str, **more):
    """Return the text, and the two programs compared within 1 um by their own formats."""
    made = convert.convert(data, to="wed", name=name, **more)
    assert made.ok, [str(d) for d in made.findings]
    compiled = api.compile(made.data, name="again.wed")
    assert compiled.ok, [str(d) for d in compiled.findings]
    told, _ = api.diff(data, compiled.data, names=(name, "again.3b"))
    return made.data.decode(), told


@pytest.mark.parametrize("name", GOLDEN)
def test_golden_programs_come_back(name: str) -> None:
    data = (ROOT / "tests/golden" / name).read_bytes()
    given = None  # what the operator enters where the file is an outline
    if ".g41" in name:
        given = Entries(d=((1, 100.0),))
    elif name.endswith(".4b"):
        given = Entries(gap_um=100, outwards=".die" not in name)
    machine = READ_AS.get(name)
    made = convert.convert(data, to="wed", name=name, entered=given, profile_in=machine)
    assert made.ok, [str(d) for d in made.findings]
    compiled = api.compile(made.data, profile=made.machine_in, name="again.wed")
    assert compiled.ok, [str(d) for d in compiled.findings]
    table = made.machine_in.stepping
    told = difference(made.program, compiled.program, table, table)
    assert told.equal, told


HOLE = b"B9900B0B9900GXL1\nB9900B0B39600GYNR1\nB9900B0B9900GXL3\nDD\n"


def test_the_published_hole() -> None:
    text, told = again(HOLE, "hole.3b")
    assert told.largest_um == 0
    assert text.splitlines()[2:] == [
        'part "hole"',
        "",
        "contour path1 {",
        "  circle center (0, 0) radius 9.9",
        "}",
        "",
        "cut path1 on start (0, 0) enter (9.9, 0) stop 0 overcut 0 corner 0",
    ]


def test_equal_contours_are_one_moved() -> None:
    text, told = again((ROOT / "tests/golden/plate.3b").read_bytes(), "plate.3b")
    assert text.count("contour path") == 5
    assert "let path2 = path1 | translate (30, 0)" in text
    assert told.equal


def test_an_open_path_and_ratio_lines() -> None:
    data = b"BBB50000GYL2 B17B5B17000GXL1 B2000B9000B25440GYNR2 DD"
    text, told = again(data, "open.3b", format="3b")
    assert told.largest_um == 0
    assert "  line to (17, 55)\n  arc ccw to (28, 44) center (19, 46)\n}" in text


def test_stop_and_overcut_and_several_contours() -> None:
    options = Options.of(offset_um=100, stop_um=2000, overcut_um=700)
    made = api.compile(ROOT / "samples/plate.dxf", options=options)
    text, told = again(made.data, "plate.3b")
    assert told.largest_um <= 1.0
    assert text.count(" stop ") == text.count(" overcut ") == text.count("cut path") == 10
    decoded = api.read_program(api.compile(text.encode(), name="a.wed").data, name="a.3b")[0]
    kinds = [made.program.blocks["kind"], decoded.blocks["kind"]]
    assert [int((k == 3).sum()) for k in kinds] == [28, 28]  # 9 moves with two each, 10 stops


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("D\nB2696B484B10956GXNR3\nDD", [1]),
        ("B2696B484B10956GXNR3\nD\nDD", [2]),
        ("{hole}\nD\nD\nB9000B0B9000GXL1\nD\n{hole}\nDD", [4]),
        ("{hole}\nD\nB9000B0B9000GXL1\nD\nD\n{hole}\nDD", [7]),
        ("{hole}\nD\nD\n{hole}\nDD", [4]),
        ("{hole}\nD\nB9000B0B9000GXL1\nD\n{hole}\nDD", []),
    ],
)
def test_a_pause_that_no_cut_makes_is_said(text: str, lines: list[int]) -> None:
    hole = "B900B0B900GXL1\nB900B0B3600GYNR1\nB900B0B900GXL3"
    data = text.format(hole=hole).encode()
    made = convert.convert(data, to="wed", name="a.3b", format="3b")
    assert made.ok
    assert [d.span.line for d in made.findings if d.code == "not-carried"] == lines


def test_contours_of_one_thread_point_are_told_apart() -> None:
    """A move of length 0 leaves one pause: no stop of one contour, but the start of another."""
    square = b"B1000B0B1000GXL1 B0B500B500GYL2 B500B0B500GXL1 B0B500B500GYL4 B500B0B500GXL3 "
    data = square + b"B1000B0B1000GXL3 D B0B2000B2000GYL2 B300B0B1200GYNR1 B0B2000B2000GYL4 DD"
    text, told = again(data, "two.3b", format="3b")
    assert text.count("contour path") == 2
    assert text.count(" stop 0 ") == 2
    assert told.largest_um <= 1.0


def test_what_has_no_place_is_said() -> None:
    data = b"B0B500B500GYL2 D B500B0B500GXL1 B0B500B500GYL4\nM7\nDD"
    made = convert.convert(data, to="wed", name="a.3b", format="3b")
    lost = [d for d in made.findings if d.code == "not-carried"]
    assert [(d.span.line, d.span.column) for d in lost] == [(1, 1), (2, 1)]
    assert "pause" in lost[0].message
    assert "M7" in lost[1].message
    assert made.ok
    assert not convert.convert(data, to="wed", name="a.3b", format="3b", strict=True).ok


@pytest.mark.parametrize("seed", range(0, 60, 4))
def test_random_parts_come_back(seed: int) -> None:
    made = api.compile(dxf_bytes(random_part(seed)), options=Options.of(offset_um=100))
    assert made.ok
    _, told = again(made.data, "part.3b")
    assert told.equal


record = st.one_of(
    st.builds(
        lambda x, y, z: f"B{x}B{y}B{max(x, y)}G{'XY'[x < y]}L{z}",
        st.integers(1, 9000), st.integers(0, 9000), st.integers(1, 4),
    ),
    st.builds(
        lambda x, y, j, g, z: f"B{x}B{y}B{1 + int(j * 4 * np.hypot(x, y))}G{g}{z}",
        st.integers(50, 9000), st.integers(50, 9000), st.floats(0.001, 1.2),
        st.sampled_from("XY"), st.sampled_from(["NR1", "NR2", "NR3", "NR4", "SR1", "SR3"]),
    ),
    st.sampled_from(["D", "M5"]),
)  # fmt: skip


@given(st.lists(record, min_size=1, max_size=9))
@settings(max_examples=60, deadline=None)
def test_any_program_comes_back_or_is_refused(records: list[str]) -> None:
    data = "\n".join([*records, "DD"]).encode()
    made = convert.convert(data, to="wed", name="a.3b", format="3b")
    if made.ok:
        told = api.diff(data, api.compile(made.data, name="a.wed").data, names=("a.3b", "b.3b"))[0]
        # Moves before the first cut and behind the last are left out, and that is said.
        moves = [d for d in made.findings if d.code == "not-carried" and "move" in d.message]
        assert told.equal or moves
    else:
        assert any(d.severity is Severity.ERROR for d in made.findings)


def test_from_the_command_line(tmp_path: Path) -> None:
    hole, text = tmp_path / "hole.3b", tmp_path / "hole.wed"
    hole.write_bytes(HOLE)
    done = CliRunner().invoke(cli, ["convert", str(hole), "-o", str(text)])
    assert done.exit_code == 0, done.output
    done = CliRunner().invoke(cli, ["compile", str(text), "-o", str(tmp_path / "b.3b")])
    assert done.exit_code == 0, done.output
    assert CliRunner().invoke(cli, ["diff", str(hole), str(tmp_path / "b.3b")]).exit_code == 0

"""Leads of a compensation file: right for one of punch and die, and lines that replace them."""

import json
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from click.testing import CliRunner

from drawings import drawing
from outlines import figure, line, random_contour
from wedmcam.cli.main import cli
from wedmcam.controllers.zd065.compensation import HARMLESS, compensate
from wedmcam.controllers.zd065.leads import entered_leads
from wedmcam.options import WrongUse

POINTS = [(0, 0, 0), (20, 0, 0.2), (26, 12, 0), (12, 18, 0), (10, 9, 0), (-3, 11, 0)]
DIE = ["--gap", "0.08", "--side", "die", "--corner", "0.1"]
LEADS = ["--lead-in", "0,-3", "--lead-out", "0,3"]


def outline(doc, msp):
    msp.add_lwpolyline(POINTS, format="xyb", close=True)


class Ran(NamedTuple):
    """What a command returned or raised, and what it said, in one line."""

    exit_code: int
    output: str


def run(*arguments):
    result = CliRunner().invoke(cli, [str(a) for a in arguments], standalone_mode=False)
    why = result.exception
    status = result.return_value if why is None else 2 * isinstance(why, WrongUse)
    return Ran(status, " ".join(f"{result.output} {why or ''}".split()))


@pytest.fixture
def zdc(tmp_path, monkeypatch):
    """The file of a punch, threaded 3 mm below its lower edge."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.dxf").write_bytes(drawing(outline))
    made = run("compile", "p.dxf", "-o", "p.zdc", "--offset", "0.1", "--corners", "paper",
               "--start", "10,-3", "-q")  # fmt: skip
    assert made.exit_code == 0, made.output
    return tmp_path / "p.zdc"


def test_the_lead_of_the_punch_cuts_the_die_and_that_is_said(zdc):
    told = run("convert", zdc, "-o", "die.zd", *DIE)
    assert told.exit_code == 0
    assert "warning[compensation-lead]: block 1" in told.output
    assert "3.080 mm outside the path of the wire" in told.output
    assert "inside the contour to the start of the outline, (0.000, 3.000) mm" in told.output
    assert run("convert", zdc, "-o", "die.zd", "--strict", *DIE).exit_code == 1
    said = run("convert", zdc, "-o", "punch.zd", "--gap", "0.1", "--strict")
    assert (said.exit_code, "compensation-lead" in said.output) == (0, False)


def test_a_die_of_the_punch_file_is_proven_with_its_own_leads(zdc):
    against = ["--against", "p.dxf", "--start", "10,3"]
    assert run("convert", zdc, "-o", "die.zd", "--strict", *DIE, *LEADS).exit_code == 0
    proof = run("verify", zdc, *DIE, *LEADS, *against, "--certificate", "die.json")
    assert proof.exit_code == 0, proof.output
    assert json.loads((zdc.parent / "die.json").read_text())["entered"]["lead_in_um"] == [0, -3000]
    again = run("verify", zdc, "--certificate", "die.json")
    assert again.exit_code == 0, again.output
    of_die = ["--offset", "0.08", "--side", "die", "--corner", "0.1", "--corners", "paper"]
    assert run("verify", "die.zd", *of_die, *against).exit_code == 0
    for wrong in ([], LEADS[:2], LEADS[2:], ["--lead-in", "0,-3", "--lead-out", "0.1,3"]):
        assert run("verify", zdc, *DIE, *wrong, *against).exit_code == 3


@pytest.mark.parametrize(
    ("leads", "said"),
    [
        (["--lead-in", "0,0"], "a line of no length is none"),
        (["--lead-in", "0,1000"], "up to 999.999 mm"),
        (["--lead-out", "0.0001,1"], "whole um"),
    ],
)
def test_lines_that_are_no_leads(zdc, leads, said):
    told = run("convert", zdc, "-o", "die.zd", *DIE, *leads)
    assert told.exit_code in (1, 2)
    assert said in told.output


def test_leads_of_several_contours_or_none_are_not_replaced():
    ring = [line(9, 0), line(0, 9), line(-9, 0), line(0, -9)]
    open_ = [line(0, 50), line(90, 0), line(0, 90)]
    for rows, why in ((ring, "leads"), (open_, "leads"), ([], "contours")):
        assert entered_leads(figure(*rows), (0, 5), None)[1] == why


def test_lines_alone_need_their_gap(tmp_path):
    """The machine offsets lines as well: without a gap the outline would be cut for the path."""
    data = bytes.fromhex("02000000003000 01003000000000 02000000006000 03006000000000"
                         "04000000006000 01003000000000 04000000003000 00")  # fmt: skip
    (tmp_path / "a.zdc").write_bytes(data)
    for more, status, code in (([], 1, True), (["--gap", "0"], 0, False)):
        told = run("convert", tmp_path / "a.zdc", "-o", tmp_path / "a.3b", *more)
        assert (told.exit_code, "no-gap" in told.output) == (status, code), told.output
    told = run("verify", tmp_path / "a.zdc")
    assert "note[no-gap]" in told.output
    (tmp_path / "b.zd").write_bytes(data)
    told = run("convert", tmp_path / "b.zd", "-o", tmp_path / "b.zdc")
    assert (told.exit_code, "note[no-gap]" in told.output) == (0, True)
    assert (tmp_path / "b.zdc").read_bytes() == data


def test_leads_belong_to_formats_without_them(tmp_path):
    (tmp_path / "a.zd").write_bytes(bytes.fromhex("01 01 70 00 00 50 00 00"))
    told = run("convert", tmp_path / "a.zd", "-o", tmp_path / "a.3b", "--lead-in", "0,1")
    assert told.exit_code == 2
    assert "in rotation format, not to compact" in told.output


def told(rows, gap, outwards):
    _, problems = compensate(rows, gap, outwards)
    assert not [p for p in problems if p.what not in HARMLESS]
    return [p.block for p in problems if p.what == "lead"]


@pytest.mark.parametrize("seed", range(10))
def test_leads_from_one_side_are_for_that_side(seed):
    """Contours of lines and arcs, threaded outside: right for a punch, both wrong for a die."""
    rng = np.random.default_rng(seed)
    rows = random_contour(rng, 30_000, bulge=0.3)
    inner = rows.copy()
    for row in (0, -1):
        inner["x"][row], inner["y"][row] = -rows["x"][row] // 8, -rows["y"][row] // 8
    assert told(rows, 20, True) == []
    assert told(rows, 20, False) == [0, len(rows) - 1]
    assert told(inner, 20, False) == []
    assert told(inner, 20, True) == [0, len(rows) - 1]
    assert told(rows, 0, False) == []


def test_a_lead_through_a_leg_of_the_part_is_seen():
    """A thread point on the right side, and a lead that crosses a leg on its way."""
    u = [(0, 0), (30_000, 0), (30_000, 20_000), (20_000, 20_000), (20_000, 10_000),
         (10_000, 10_000), (10_000, 20_000), (0, 20_000)]  # fmt: skip
    start = (10_000, 15_000)  # inside the slot, on its left wall
    corners = [*u[6:], *u[:6]]
    places = [start, *corners, start]
    body = [line(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(places)]
    through = figure(line(-25_000, 0), *body, line(0 + 4_000, 0))
    assert told(through, 100, True) == [0]
    assert told(figure(line(-4_000, 0), *body, line(4_000, 0)), 100, True) == []

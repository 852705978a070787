"""Machines whose pulse is not 1 um: the part comes out right, and all that is told is true um.

Distances are measured here with shapely, from the raw numbers of the file times the step.
"""

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from test_axes import L

import fork_server
import parts
import wedmcam
from drawings import drawing
from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.frontends import decoder
from wedmcam.ir.program import Kind, Role
from wedmcam.judge.certificate import fingerprint
from wedmcam.machines import Axes, builtin
from wedmcam.operations import convert
from wedmcam.reports import setup_sheet
from wedmcam.reports.block import explain_block

STEPS = [0.5, 1.0, 2.0, 10.0]
SAMPLES = Path(__file__).parents[2] / "samples"
SHOP = """title = "ours"
format = "3b"
line_table = "rotate"
[limits]
count_um = 999999
line_um = 999999
arc_um = 999999
"""


def stepping(name, step_um, **axes):
    # Circles whole, so that records and lowered blocks are one to one.
    whole = replace(builtin(name).iso, full_circle="one")
    return replace(builtin(name), axes=Axes(step_um=step_um, **axes), iso=whole)


def places(made, step_um):
    """Where the wire goes on contours, um: from the bytes, by who knows nothing of steps."""
    plain = replace(made.machine, axes=Axes())
    raw, _ = decoder(plain.format)(made.data, plain, "raw")
    at, first = plain.own_stepping.trace(raw.blocks)
    roles = np.where(made.lowered.blocks["kind"] < Kind.MOVE, made.lowered.blocks["role"], 99)
    assert len(roles) == len(raw.blocks)
    of = np.repeat(np.arange(len(first)), np.diff([*first, len(at) - 1]))
    return at[1:][roles[of] == Role.CONTOUR] * step_um + np.array(made.lowered.origin) * step_um


def run(*arguments):
    return fork_server.wedmcam(*arguments)


@pytest.mark.parametrize("name", ["b3-compact", "iso-um", "iso-mm", "zd065"])
@pytest.mark.parametrize("step_um", STEPS)
def test_the_part_comes_out_within_the_bound(name, step_um):
    made = wedmcam.compile(L, offset=0.1, profile=stepping(name, step_um))
    assert made.ok, made.findings
    at = places(made, step_um)
    outlines = sorted((parts.polygon(c) for c in made.plan.outlines), key=lambda p: -p.area)
    rings = outlines[0].buffer(100, 256).exterior, outlines[1].buffer(-100, 256).exterior
    wanted = shapely.union_all(rings)
    off = shapely.distance(wanted, shapely.points(at))
    assert off.max() <= 2 * step_um + 0.2
    # And back: no part of the planned path is farther from where the wire goes.
    dense = np.concatenate([shapely.line_interpolate_point(r, np.arange(0, r.length, 50))
                            for r in rings])  # fmt: skip
    tree = shapely.STRtree(shapely.points(at))
    _, away = tree.query_nearest(dense, return_distance=True)
    assert away.max() <= 3 * step_um + 0.2
    v = made.verdict
    assert off.max() - 0.2 <= v.max_deviation_um <= v.path_limit_um == 2 * step_um
    assert v.gouge_um <= v.gouge_limit_um == 1.6 * step_um
    assert v.closure_um == 0
    assert v.path_mm == pytest.approx(119.125, abs=0.02)
    assert v.extents_um == pytest.approx((-1100, -100, 21_000, 33_100), abs=step_um + 2)
    assert made.summary["step_um"] == step_um
    assert made.summary["limits"]["path_um"] == 2 * step_um


@pytest.mark.parametrize("step_um", STEPS)
@pytest.mark.parametrize("sample", ["cam", "plate", "cover", "gear-24"])
def test_samples(sample, step_um):
    made = wedmcam.compile(SAMPLES / f"{sample}.dxf", offset=0.1,
                           profile=stepping("b3-compact", step_um))  # fmt: skip
    assert made.ok, made.findings
    plain = wedmcam.compile(SAMPLES / f"{sample}.dxf", offset=0.1)
    assert made.verdict.path_mm == pytest.approx(plain.verdict.path_mm, rel=1e-3, abs=0.05)
    assert made.verdict.contours == plain.verdict.contours
    assert made.verdict.closure_um in (0, None)


@pytest.mark.parametrize("step_um", STEPS)
def test_another_step_is_refused(step_um):
    made = wedmcam.compile(L, offset=0.1, profile=stepping("b3-compact", step_um))
    for other in STEPS:
        proof = api.verify(made.data, against=L, offset=0.1, profile=stepping("b3-compact", other))
        assert proof.ok == (other == step_um)
        assert proof.status == (0 if proof.ok else 3)


def test_the_certificate_brings_the_step_along(tmp_path):
    drawn, profile = tmp_path / "l.dxf", tmp_path / "coarse.toml"
    drawn.write_bytes(L)
    profile.write_text(SHOP + "[axes]\nstep_um = 2.5\nmirror_x = true\n")
    program, issued = tmp_path / "l.3b", tmp_path / "l.json"
    done = run("compile", str(drawn), "-o", str(program), "--offset", "0.1", "--profile",
                     str(profile), "--certificate", str(issued))  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = json.loads(issued.read_text())
    assert told["step_um"] == 2.5
    assert told["limits"] == {"path_um": 5.0, "gouge_um": 4.0}
    assert told["sha256"]["output"] == fingerprint(program.read_bytes())
    profile.unlink()
    args = ["verify", str(program), "--against", str(drawn), "--certificate", str(issued)]
    done = run(*args)
    assert done.returncode == 0, done.stderr
    done = run(*args, "--profile", "b3-compact")
    assert done.returncode == 3


def test_everything_tells_true_lengths():
    made = wedmcam.compile(L, offset=0.1, profile=stepping("b3-compact", 10.0))
    plain = wedmcam.compile(L, offset=0.1)
    figures = [api.figures(m.program, m.machine) for m in (made, plain)]
    assert figures[0]["extents_um"] == pytest.approx(figures[1]["extents_um"], abs=15)
    assert figures[0]["path_mm"] == pytest.approx(figures[1]["path_mm"], abs=0.02)
    assert figures[0]["limits"]["count_um"]["limit"] == 9_999_990
    told = [api.source_map(m)["blocks"] for m in (made, plain)]
    ends = [np.array([b["end_um"] for b in t if b["role"] == "contour"]) for t in told]
    assert ends[0].max(axis=0) == pytest.approx(ends[1].max(axis=0), abs=15)
    sheets = [setup_sheet.markdown(setup_sheet.sheet(m, "l")) for m in (made, plain)]
    holes = [s.split("## Start holes")[1].split("## Where")[0].count("12.250") for s in sheets]
    assert holes[0] == holes[1] > 0
    assert "as in the drawing; steps of 10 um" in sheets[0]
    box = [ezdxf_box(api.path_drawing(m.program, m.machine)) for m in (made, plain)]
    assert box[0] == pytest.approx(box[1], abs=0.015)
    pictures = [re.findall(r'viewBox="([^"]+)"', api.plot(m))[0] for m in (made, plain)]
    numbers = [[float(v) for v in p.split()] for p in pictures]
    assert numbers[0] == pytest.approx(numbers[1], abs=0.05)
    line = next(i for i, b in enumerate(made.program.blocks) if b["kind"] == Kind.LINE)
    said = "\n".join(explain_block(made.program, made.machine, made.data, line + 1))
    count = int(made.program.blocks["count"][line])
    assert f"J          {count / 100:.3f} mm = {count} steps" in said
    assert "steps of 10 um" in said


def ezdxf_box(data):
    space = ezdxf.read(io.StringIO(data.decode("cp1252"))).modelspace()
    points = [p for e in space.query("LINE") for p in (e.dxf.start, e.dxf.end)]
    return [f(p[k] for p in points) for k in (0, 1) for f in (min, max)]


def test_diff_compares_true_lengths():
    fine, coarse = stepping("b3-compact", 1.0), stepping("zd065", 2.0, mirror_y=True)
    one = wedmcam.compile(L, offset=0.1, profile=fine)
    two = wedmcam.compile(L, offset=0.1, profile=coarse)
    for a, b, profiles in ((one, two, (fine, coarse)), (two, one, (coarse, fine))):
        apart, _ = api.diff(a.data, b.data, within_mm=0.006, profiles=profiles)
        assert apart.equal
        assert 1 < apart.largest_um < 6
        apart, _ = api.diff(a.data, b.data, within_mm=0.001, profiles=profiles)
        assert not apart.equal
    wrong = stepping("zd065", 1.0, mirror_y=True)
    apart, _ = api.diff(one.data, two.data, within_mm=0.006, profiles=(fine, wrong))
    assert not apart.equal
    # A pocket that only one of them has.
    less = wedmcam.compile(L, offset=0.15, profile=coarse)
    apart, _ = api.diff(one.data, less.data, within_mm=0.006, profiles=(fine, coarse))
    assert not apart.equal


def test_convert_keeps_the_step_and_refuses_another():
    coarse = stepping("b3-compact", 5.0)
    made = wedmcam.compile(L, offset=0.1, profile=coarse)
    same = convert.convert(made.data, profile=stepping("iso-mm", 5.0), profile_in=coarse)
    assert same.ok, same.findings
    square = convert.convert(made.data, profile=stepping("zd065", 5.0), profile_in=coarse)
    assert square.ok, square.findings
    other = convert.convert(made.data, to="iso", profile_in=coarse)
    assert not other.ok
    assert other.status == 1
    assert [d.code for d in other.findings if d.severity is Severity.ERROR] == ["other-step"]
    # The cure: the path as a drawing, compiled again.
    path = convert.convert(made.data, to="dxf", profile_in=coarse)
    again = wedmcam.compile(path.data, side="on", layers=("CUT",))
    assert again.ok, again.findings
    sizes = [np.subtract(v.extents_um[2:], v.extents_um[:2]) for v in (again.verdict, made.verdict)]
    assert sizes[0] == pytest.approx(sizes[1], abs=6)  # it starts where the program does


@pytest.mark.parametrize("step_um", [0.5, 5.0])
def test_a_part_program_made_of_a_program_is_in_true_mm(step_um):
    machine = stepping("b3-compact", step_um, mirror_x=True)
    made = wedmcam.compile(L, offset=0.1, profile=machine)
    text = convert.convert(made.data, to="wed", profile_in=machine)
    assert text.ok, text.findings
    assert b"from (" in text.data
    again = wedmcam.compile(text.data, name="l.wed")  # for a machine of 1 um
    assert again.ok, again.findings
    assert again.verdict.path_mm == pytest.approx(made.verdict.path_mm, abs=0.02)


def test_limits_count_steps():
    """1.2 m in one record of 5 um, and 0.6 m in two of 0.5 um; and no farther than the table."""

    def draw(doc, msp):
        msp.add_lwpolyline([(0, 0), (1200, 0), (1200, 600), (0, 600)], close=True)

    data = drawing(draw)
    blocks = {}
    for step in (0.5, 5.0):
        made = wedmcam.compile(data, offset=0.1, profile=stepping("b3-compact", step))
        assert made.ok, made.findings
        blocks[step] = made.program.blocks["count"]
        assert blocks[step].max() <= 999_999
    assert blocks[5.0].max() == 240_000  # corners are rounded
    assert (blocks[0.5] > 300_000).sum() > 4
    limits = replace(builtin("b3-compact").limits, travel_um=(1_300_000, 700_000))
    fits = replace(stepping("b3-compact", 5.0), limits=limits)
    assert wedmcam.compile(data, offset=0.1, profile=fits).ok
    small = replace(fits, limits=replace(limits, travel_um=(1_100_000, 700_000)))
    made = wedmcam.compile(data, offset=0.1, profile=small)
    assert "1200.200" in next(d.message for d in made.findings if d.code == "over-travel")


def test_the_rest_after_a_broken_wire():
    machine = stepping("b3-compact", 10.0)
    whole = wedmcam.compile(SAMPLES / "cam.dxf", offset=0.1, profile=machine)
    middle = len(whole.program.blocks) // 2
    rest = wedmcam.compile(SAMPLES / "cam.dxf", offset=0.1, profile=machine, from_block=middle)
    assert rest.ok, rest.findings
    assert 0.3 < rest.verdict.path_mm / whole.verdict.path_mm < 0.7


@pytest.mark.parametrize("value", ["0", "-1", "200", "true", '"1"', "[1, 1]", "nan"])
def test_wrong_steps_are_refused(value):
    from wedmcam.machines import parse

    machine, found = parse(SHOP + f"[axes]\nstep_um = {value}\n", "t.toml")
    assert machine is None
    assert [d.code for d in found] == ["profile-value"]


def test_formats_that_compute_in_um_know_no_step():
    from wedmcam.machines import parse, text

    for name in ("zd065-rotation", "zd065-compensation", "b4-compact"):
        machine, found = parse(text(name) + "[axes]\nstep_um = 2\n", "t.toml")
        assert machine is None
        assert [d.code for d in found] == ["profile-key"]
    machine, _ = parse(SHOP + "[axes]\nstep_um = 2\n", "t.toml")
    assert machine.axes.step_um == 2.0


def test_dump_says_what_its_numbers_are():
    from wedmcam.cli.tables import dump_lines

    machine = stepping("b3-compact", 0.5)
    made = wedmcam.compile(L, offset=0.1, profile=machine)
    lines = list(dump_lines(made.program, machine))
    assert lines[0] == "X, Y and J are steps of 0.5 um, ends are um"
    assert lines[1].startswith("block")
    _, ends = api.positions(made.program, machine)
    assert [float(v) for v in lines[2].split()[-2:]] == ends[0].tolist()

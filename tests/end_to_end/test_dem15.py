"""Drawings as vectors of the DEM-15: proven at every speed, refused beyond its limits."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawings import drawing
from fork_server import wedmcam
from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

SAMPLES = Path(__file__).parents[2] / "samples"
#: Samples that are not larger than the table of 65 x 65 mm; all others fit the one in steps.
FIT = {
    *("key-punch.dxf", "gear-24.dxf", "damaged.dxf", "cam.wed", "gear.wed", "key.wed"),
    *("quarter.wed", "row.wed", "washer.wed"),
}
#: And one is too large for both: 135.8 mm.
LARGE = "stator-90.wed"
ALL = sorted(p.name for p in [*SAMPLES.glob("*.dxf"), *SAMPLES.glob("*.wed")])
OPTIONS = {"damaged.dxf": {"units": "mm"}}


def compiled(name, feed=1.0, profile=None, **more):
    of_drawing = {"offset": 0.1} if name.endswith(".dxf") else {}
    options = of_drawing | OPTIONS.get(name, {}) | more
    data = (SAMPLES / name).read_bytes()
    return api.compile(data, to="dem15", name=name, feed=feed, profile=profile, **options)


def codes(made, least=Severity.ERROR):
    return {d.code for d in made.findings if d.severity >= least}


def sideways(made):
    """How far vectors lead beside their own lines, um."""
    lines = made.program.blocks[made.program.blocks["kind"] == Kind.LINE]
    return 2.0 * made.machine.stepping.sideways(lines)


@pytest.mark.parametrize("name", ALL)
def test_samples_are_proven_on_the_table_that_they_fit(name):
    made = compiled(name)
    if not made.ok:
        assert codes(made) == {"over-travel"}
        (d,) = (d for d in made.findings if d.code == "over-travel")
        assert re.search(
            r"goes \d+\.\d{3} mm along [xy] of the drawing, up to \(.*\) mm; .* 65\.000", d.message
        )
        made = compiled(name, profile="dem15-steps")
    if name == LARGE:
        assert codes(made) == {"over-travel"}
        return
    assert made.ok, [d.message for d in made.findings if d.severity is Severity.ERROR]
    assert made.verdict.path_limit_um == 4.0
    assert made.verdict.gouge_limit_um == 3.2
    # A vector that ends within two steps of a corner counts as meant for it, and the next as on
    # its way from there.
    assert made.verdict.max_deviation_um <= 3.5
    assert (made.verdict.gouge_um or 0.0) <= 2.4
    assert made.verdict.closure_um == 0
    assert sideways(made).max() <= 2.0


def test_small_samples_fit_the_table_of_65_mm():
    assert {n for n in ALL if compiled(n).ok} == FIT


@pytest.mark.parametrize("feed", [0.01575, 0.0315, 0.05, 0.16, 0.5, 2.0])
@pytest.mark.parametrize("profile", ["dem15", "dem15-steps", "dem15-sines"])
def test_paths_are_within_2_um_sideways_at_every_speed(feed, profile):
    made = compiled("key-punch.dxf", feed, profile)
    assert made.ok, [d.message for d in made.findings]
    assert sideways(made).max() <= 2.0
    speeds = made.program.blocks["count"][made.program.blocks["kind"] == Kind.LINE]
    assert set(speeds.tolist()) == {int(feed * 1000 / 15.75 + 1e-9)}


def test_the_slower_the_more_vectors_and_a_table_of_sines_needs_few():
    n = {feed: len(compiled("gear-24.dxf", feed).program.blocks) for feed in (0.1, 0.5, 2.0)}
    assert n[0.1] > 2 * n[0.5] > 2 * n[2.0]
    assert len(compiled("gear-24.dxf", 0.1, "dem15-sines").program.blocks) < n[2.0]


@pytest.mark.parametrize(("feed", "ok"), [(0.0157, 0), (0.01575, 1), (2.0, 1), (2.1, 0), (50.0, 0)])
def test_feeds_that_it_has_no_speed_for_are_refused(feed, ok):
    made = compiled("key-punch.dxf", feed)
    assert made.ok is bool(ok)
    if not ok:
        (d,) = (d for d in made.findings if d.severity is Severity.ERROR)
        assert d.code == "speed-range"
        assert f"{feed:g} mm a minute" in d.message


def test_what_is_far_larger_than_the_table_is_refused_at_once():
    def draw(doc, space):
        space.add_circle((0, 0), 90_000.0)
        space.add_lwpolyline([(0, 0), (60_000, 1), (5, 50_000)], close=True)

    for profile in ("dem15", "dem15-steps", "dem15-sines"):
        for side in ("part", "die"):
            made = api.compile(
                drawing(draw), to="dem15", offset=0.1, feed=0.016, profile=profile, side=side
            )
            assert codes(made) == {"over-travel"}


def test_the_speed_that_is_run_is_told():
    made = compiled("key-punch.dxf", None)
    (d,) = (d for d in made.findings if d.code == "vector-speed")
    assert "1.00800 mm a minute (64)" in d.message
    assert "the profile's speed" in d.message
    assert "no --feed" not in str([x.message for x in compiled("key-punch.dxf", 1.0).findings])


def test_a_program_at_another_speed_is_not_proven():
    """The vectors are cut for a speed: at a lower one they lead too far beside their lines."""
    made = compiled("gear-24.dxf", 2.0)
    slow = re.sub(rb" 126$", b" 3", made.data, flags=re.M)
    assert slow != made.data
    data = (SAMPLES / "gear-24.dxf").read_bytes()
    proof = api.verify(slow, against=data, format="dem15", name="slow.d15", offset=0.1)
    assert not proof.ok
    assert {d.code for d in proof.findings if d.severity is Severity.ERROR} & {
        "path-deviation",
        "gouge",
    }


@pytest.mark.parametrize(
    "axes", [{"exchange": True}, {"mirror_x": True}, {"exchange": True, "mirror_y": True}]
)
def test_turned_axes_step_the_image(axes):
    machine = builtin("dem15")
    machine = replace(machine, axes=replace(machine.axes, **axes))
    made = compiled("key-punch.dxf", 0.1, machine)
    assert made.ok, [d.message for d in made.findings if d.severity is Severity.ERROR]


def test_moves_run_at_the_largest_speed_and_the_generator_is_off():
    def draw(doc, space):
        for x in (0, 20):
            space.add_lwpolyline([(x, 0), (x + 10, 0), (x + 10, 8), (x, 8)], close=True)

    data = drawing(draw)
    made = api.compile(data, to="dem15", name="two.dxf", offset=0.1, feed=0.5)
    assert made.ok
    records = [r.split() for r in made.data.decode().splitlines() if " " in r]
    moves = [r for r in records if r[4] == "0"]
    assert len(moves) == 1
    assert moves[0][4:] == ["0", "0", "127"]
    assert {tuple(r[4:]) for r in records if r not in moves} == {("100", "200", "31")}


def run(folder, *words, status=0):
    ran = wedmcam(*words, cwd=folder)
    assert ran.returncode == status, ran.stderr
    return (ran.stdout + ran.stderr).decode()


def test_the_commands_take_such_programs(tmp_path):
    (tmp_path / "key.dxf").write_bytes((SAMPLES / "key-punch.dxf").read_bytes())
    said = run(tmp_path, "compile", "key.dxf", "-o", "key.d15", "--offset", "0.1", "--json")
    certificate = json.loads(said[said.index("{") : said.rindex("}") + 1])
    assert (certificate["format"], certificate["step_um"]) == ("dem15", 2)
    assert certificate["limits"] == {"path_um": 4.0, "gouge_um": 3.2}
    assert "job records of the DEM-15" in run(tmp_path, "identify", "key.d15")
    assert "verified" in run(
        tmp_path, "verify", "key.d15", "--against", "key.dxf", "--offset", "0.1"
    )
    figures = run(tmp_path, "verify", "key.d15")
    assert "largest J" not in figures
    assert "longest way is 36.700 of 65.534 mm" in figures
    table = run(tmp_path, "dump", "key.d15")
    assert "X and Y are steps of 2 um, J is the speed" in table
    assert "speed 64: 1.008 mm a minute" in table
    told = run(tmp_path, "explain", "key.d15", "--block", "3")
    assert "POSCAL: x 2, y -64" in told
    for ending in ("svg", "dxf", "wed"):
        run(tmp_path, "convert", "key.d15", "-o", f"path.{ending}")
    run(tmp_path, "plot", "key.d15", "-o", "plot.svg")
    run(tmp_path, "compile", "path.wed", "--to", "dem15", "-o", "again.d15")
    assert "other-step" in run(tmp_path, "convert", "key.d15", "-o", "key.3b", status=1)
    run(tmp_path, "compile", "key.dxf", "-o", "key.3b", "--offset", "0.1")
    assert "chosen for the cutting speed" in run(
        tmp_path, "convert", "key.3b", "-o", "other.d15", status=1
    )
    words = ("compile", "key.dxf", "--to", "3b,dem15", "-o", "both", "--offset", "0.1")
    assert "the same path in 2 formats" in run(tmp_path, *words)  # each held to the plan


def test_many_drawings_at_once(tmp_path):
    for name in ("key-punch", "gear-24"):
        (tmp_path / f"{name}.dxf").write_bytes((SAMPLES / f"{name}.dxf").read_bytes())
    run(tmp_path, "batch", ".", "-o", "out", "--to", "dem15", "--offset", "0.1", "--jobs", "1")
    assert len(list(tmp_path.rglob("*.d15"))) == 2


def test_a_lost_record_is_seen_and_a_changed_place_too():
    made = compiled("key-punch.dxf")
    lines = made.data.decode().splitlines()
    for broken in (lines[:8] + lines[9:], [*lines[:8], "0 0 2 2 100 200 63", *lines[8:]]):
        proof = api.verify("\n".join(broken).encode(), format="dem15", name="x.d15")
        assert "place-jump" in {d.code for d in proof.findings}


def test_no_step_is_lost_between_file_and_path():
    made = compiled("gear-24.dxf")
    records = [r.split() for r in made.data.decode().splitlines() if " " in r]
    ends = np.array([[int(v) for v in r[2:4]] for r in records])
    at, _ = made.machine.stepping.trace(made.program.blocks)
    first = np.array([int(v) for v in records[0][:2]])
    blocks = made.program.blocks[made.program.blocks["kind"] <= Kind.MOVE]
    here = np.cumsum(np.column_stack([blocks["x"], blocks["y"]]), axis=0)
    assert (first + 2 * here == ends).all()
    assert (at[-1] == here[-1]).all()

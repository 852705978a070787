"""``.zdc`` written by a compile: the outline with its corners, and what the machine makes of it."""

import numpy as np
import pytest
import shapely
from click.testing import CliRunner

import parts
import wedmcam
from drawings import drawing
from wedmcam import machines
from wedmcam.cli.main import cli
from wedmcam.frontends.zd065.compensation import decode, read
from wedmcam.ir.program import Kind
from wedmcam.operations.convert import convert
from wedmcam.options import WrongUse
from wedmcam.programs.places import block_ends
from wedmcam.targets import Entries

M = machines.builtin("zd065-compensation")


def ell(_, m):
    m.add_lwpolyline([(0, 0), (20, 0), (20, 5), (12, 5), (12, 10), (0, 10)], close=True)


def bowed(_, m):
    """A plate with an arc in its upper side, with corners, and a hole."""
    m.add_lwpolyline([(0, 0, 0), (20, 0, 0), (20, 8, 0.3), (0, 8, 0)], format="xyb", close=True)
    m.add_circle((8, 5), 2)


def compiled(draw, to, **options):
    made = wedmcam.compile(
        drawing(draw), name="a.dxf", to=to, **{"offset": 0.1, "paper": True, **options}
    )
    assert made.ok, [str(d) for d in made.findings]
    return made


def codes(made):
    return [d.code for d in made.findings]


def test_the_bytes_are_the_outline_with_its_corners():
    made = compiled(ell, "compensation")
    figure, found = read(made.data, M, "a.zdc")
    assert not found
    # The lead, six sides (the first of them in two), the lead out; no arc is stated.
    assert len(figure) == 9
    assert not (figure["kind"] == Kind.ARC).any()
    sides = sorted(zip(figure["x"][1:-1].tolist(), figure["y"][1:-1].tolist(), strict=True))
    assert {(abs(x), abs(y)) for x, y in sides} >= {(0, 5000), (8000, 0), (12000, 0), (0, 10000)}
    assert figure["y"][0] == 1100
    assert figure["y"][-1] == -1100
    assert made.entries == Entries(gap_um=100, outwards=True, corner_um=100.0)


def test_types_follow_the_material():
    """The arc of the plate grows outwards; the hole's shrinks, for the punch and for the die."""
    for side in ("part", "die"):
        made = compiled(bowed, "compensation", side=side)
        figure, _ = read(made.data, M, "a.zdc")
        arcs = figure[figure["kind"] == Kind.ARC]
        grows = {int(abs(r)): int(g) for r, g in zip(arcs["radius"], arcs["grows"], strict=True)}
        assert grows.pop(2000) == -1
        assert set(grows.values()) == {1}


@pytest.mark.parametrize("side", ["part", "die"])
@pytest.mark.parametrize("draw", [ell, bowed])
@pytest.mark.parametrize("corner", [None, 0.3])
def test_zd_and_zdc_are_one_path(draw, side, corner):
    """Law: the compiler's own arcs and the machine's, within 2 um."""
    options = {"side": side} | ({"corner": corner} if corner else {})
    lines = []
    for to in ("compact", "compensation"):
        made = compiled(draw, to, **options)
        _, ends = block_ends(made.program, machines.default("compact"))
        assert made.verdict.max_deviation_um <= 2.0
        lines.append(shapely.MultiPoint(ends))
    # Vertices of one lie on the planned path of the other.
    plan = compiled(draw, "compact", **options).plan
    for cut in plan.cuts:
        rim = parts.polygon(cut.path, 0.01).exterior
        for each in lines:
            near = shapely.distance(shapely.get_parts(each), rim)
            assert (near[near < 5] <= 2.0).all()
            assert np.count_nonzero(near < 5) >= len(cut.path.vertices) - 1


def test_one_file_makes_punch_and_die():
    """One outline, two gaps: the clearance is 2 f - z between the wires, nowhere 2 um off."""
    made = compiled(ell, "compensation")
    rings = []
    for gap, outwards in ((100, True), (80, False)):
        program, found = decode(made.data, M, "a.zdc", gap, outwards, 100.0)
        assert not [d for d in found if d.severity >= 2]
        _, ends = block_ends(program, machines.default("compact"))
        rings.append(ends[:-1])
    plans = [
        compiled(ell, "compact", side=side, offset=um / 1000, corner=0.1).plan.cuts[0].path
        for side, um in (("part", 100), ("die", 80))
    ]
    for ends, path in zip(rings, plans, strict=True):
        rim = parts.polygon(path, 0.01).exterior
        origin = np.array(made.plan.cuts[0].thread)
        near = shapely.distance(shapely.points(ends + origin), rim)
        assert len(near[near < 500]) >= len(path.vertices)  # all but the ends of the lead
        assert near[near < 500].max() <= 1.6


def test_refusals():
    plain = wedmcam.compile(drawing(ell), name="a.dxf", to="compensation", offset=0.1)
    (first, *_) = (d for d in plain.findings if d.code == "not-tangent")
    assert "--corners paper" in first.hint
    assert "--corner" in first.hint
    wide = wedmcam.compile(
        drawing(lambda _, m: m.add_circle((0, 0), 30)), name="a.dxf", to="compensation", offset=8.0
    )
    assert "gap-value" in codes(wide)
    free = wedmcam.compile(
        drawing(lambda _, m: m.add_circle((0, 0), 30)), name="a.dxf", to="compact", offset=8.0
    )
    assert free.ok  # the limit is the machine's
    largest = compiled(lambda _, m: m.add_circle((0, 0), 30), "compensation", offset=7.999)
    assert largest.entries.gap_um == 7999
    opened = wedmcam.compile(
        drawing(lambda _, m: m.add_lwpolyline([(0, 0), (5, 0), (5, 5)])),
        name="a.dxf", to="compensation", offset=0.1, side="left", paper=True,
    )  # fmt: skip
    assert "compensation-lost" in codes(opened)
    two = "".join(
        f"contour {n} {{ from ({x},0) line to ({x + 9},0) line to ({x},9) close }}\n"
        f"cut {n} outside offset 0.1 corners paper corner {r}\n"
        for n, x, r in (("a", 0, 0.1), ("b", 40, 0.2))
    )
    assert wedmcam.compile(two.encode(), name="a.wed", to="compact").ok
    with pytest.raises(WrongUse, match=r"one radius .* 0.1 mm, 0.2 mm"):
        wedmcam.compile(two.encode(), name="a.wed", to="compensation")


def run(*args):
    result = CliRunner().invoke(cli, [str(a) for a in args], standalone_mode=False)
    wrong_use = result.exception is not None
    return 2 if wrong_use else result.return_value, result.output


def test_the_command_line(tmp_path):
    dxf, zdc, zd = (tmp_path / f"a.{e}" for e in ("dxf", "zdc", "zd"))
    dxf.write_bytes(drawing(ell))
    assert run("compile", dxf, "-o", zdc, "--offset", "0.1", "--corners", "paper")[0] == 0
    status, said = run("verify", zdc, "--gap", "0.1", "--side", "part", "--against", dxf)
    assert status == 0, said
    status, said = run("verify", zdc, "--gap", "0.08", "--corner", "0.1", "--against", dxf)
    assert status == 0, said
    assert run("verify", zdc, "--gap", "0.1")[0] == 0
    assert run("verify", zdc, "--gap", "0.1", "--corner", "0.05")[0] == 2
    status, said = run("convert", zdc, "-o", zd, "--gap", "0.08", "--corner", "0.1")
    assert status == 0, said
    status, said = run(
        "verify", zd, "--offset", "0.08", "--corner", "0.1", "--corners", "paper", "--against", dxf
    )
    assert status == 0, said
    assert run("convert", zd, "-o", zdc, "--gap", "0.08")[0] == 1


def test_a_path_with_corners_is_no_outline_for_a_gap():
    path = compiled(ell, "compact", paper=False)
    made = convert(path.data, to="compensation", format="compact", entered=Entries(gap_um=100))
    assert not made.ok
    assert {d.code for d in made.findings} == {"not-in-format"}
    as_it_is = convert(path.data, to="compensation", format="compact", entered=Entries(gap_um=0))
    assert as_it_is.ok

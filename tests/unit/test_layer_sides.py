"""Punch and die from one drawing: the side, the offset and the clearance of a layer."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import wedmcam
from drawings import drawing
from wedmcam.cli.main import cli
from wedmcam.compiler.pipeline import judge_program
from wedmcam.ir.plan import Side
from wedmcam.options import Options, WrongUse
from wedmcam.targets import target_of

WIRE, GAP = 0.2, 0.01  # offset 0.11 mm


def rectangle(m, layer, x, y, w=20.0, h=10.0):
    corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
    m.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})


def both(at=40.0, hole=True):
    """Return a punch with a hole, and its die beside it."""

    def draw(_, m):
        rectangle(m, "PUNCH", 0, 0)
        rectangle(m, "DIE", at, 0)
        if hole:
            m.add_circle((10, 5), 2, dxfattribs={"layer": "PUNCH"})

    return drawing(draw)


def compiled(data, **options):
    made = wedmcam.compile(data, name="both.dxf", **{"offset": 0.11, **options})
    assert made.ok, [str(d) for d in made.findings]
    return made


def widths(made):
    """Return the width of the wire path of each cut, mm, by the lowest x of its outline."""
    found = {}
    for cut in made.plan.cuts:
        x = cut.path.vertices["x"]
        low = round(float(cut.outline.vertices["x"].min()) / 1000)
        found[low, cut.side] = round(float(x.max() - x.min()) / 1000, 4)
    return found


def test_side_by_layer():
    made = compiled(both(hole=False), layer_sides={"DIE": "die"})
    assert widths(made) == {(0, Side.PART): 20.22, (40, Side.DIE): 19.78}


@pytest.mark.parametrize(("clearance", "die"), [(0.02, 19.82), (0.11, 20.0), (0.15, 20.08)])
def test_the_die_takes_the_clearance(clearance, die):
    made = compiled(both(hole=False), layer_sides={"DIE": "die"}, clearance=clearance)
    assert widths(made) == {(0, Side.PART): 20.22, (40, Side.DIE): die}
    behind = [d for d in made.findings if d.code == "behind-the-line"]
    assert len(behind) == (clearance >= 0.11)
    assert made.verdict.gouge_um < 1.6  # of the wire, 0.11 mm, in what is kept behind the clearance


def test_or_the_punch_with_its_holes():
    made = compiled(both(), layer_sides={"DIE": "die"}, clearance=0.15, clearance_on="punch")
    found = widths(made)
    assert found[0, Side.PART] == 19.92
    assert found[40, Side.DIE] == 19.78
    # The hole of the punch grows: R 2 + 0.15, cut by a wire of 0.11.
    hole = next(c for c in made.plan.cuts if len(c.path.vertices) == 1)
    radius = abs(hole.path.vertices["x"][0] - hole.path.vertices["cx"][0]) / 1000
    assert radius == pytest.approx(2.04)


def test_a_layer_has_an_offset_of_its_own():
    made = compiled(both(hole=False), layer_sides={"DIE": "die"}, layer_offsets={"DIE": 0.2})
    assert widths(made) == {(0, Side.PART): 20.22, (40, Side.DIE): 19.6}


def test_the_start_of_a_lead_stays_in_scrap_behind_the_line():
    def draw(_, m):
        rectangle(m, "DIE", 0, 0)
        m.add_point((10, 5), dxfattribs={"layer": "START"})

    made = compiled(drawing(draw), side="die", clearance=0.15)
    assert made.plan.cuts[0].thread == (10_000, 5_000)
    made = compiled(drawing(draw), side="die", clearance=0.11)
    assert made.plan.cuts[0].thread == (10_000, 5_000)


def test_holes_on_a_layer_of_their_own_are_cut_before_their_plate():
    def draw(_, m):
        rectangle(m, "OUTER", 0, 0)
        m.add_circle((5, 5), 2, dxfattribs={"layer": "HOLES"})
        m.add_line((10, 8), (18, 8), dxfattribs={"layer": "MARK"})

    made = compiled(drawing(draw), layer_sides={"HOLES": "die", "MARK": "on"})
    assert [c.side for c in made.plan.cuts] == [Side.ON, Side.PART, Side.PART]
    assert [len(c.path.vertices) for c in made.plan.cuts][1] == 1
    # One piece of material: the hole and the outline know each other.
    assert made.plan.cuts[1].scene == made.plan.cuts[2].scene


@pytest.mark.parametrize(
    "said",
    [
        {"layer_offsets": {"HOLES": 0.12}},
        {"layer_offsets": {"OUTER": 0.12}},
        {"layer_sides": {"HOLES": "part"}},
        {"layer_sides": {"OUTER": "on"}},
    ],
)
def test_a_hole_is_a_hole_whatever_is_said_of_its_layer(said):
    def draw(_, m):
        rectangle(m, "OUTER", 0, 0)
        m.add_circle((5, 5), 2, dxfattribs={"layer": "HOLES"})

    made = compiled(drawing(draw), **said)
    hole = next(c for c in made.plan.cuts if len(c.path.vertices) == 1)
    radius = abs(hole.path.vertices["x"][0] - hole.path.vertices["cx"][0]) / 1000
    offset = said.get("layer_offsets", {}).get("HOLES", 0.11)
    assert radius == pytest.approx(2 - offset)
    assert {row["kept"] for row in made.summary["understood"]} <= {"outside", "inside", None}
    assert made.summary["understood"][0]["kept"] == "outside"


@pytest.mark.parametrize("to", ["on", "part"])
def test_one_outline_on_two_layers_is_no_hole_in_itself(to):
    def draw(_, m):
        rectangle(m, "A", 0, 0)
        rectangle(m, "B", 0, 0)

    made = compiled(drawing(draw), layer_sides={"B": to}, layer_offsets={"A": 0.15})
    kept = sorted(str(row["kept"]) for row in made.summary["understood"])
    assert kept == (["None", "inside"] if to == "on" else ["inside", "inside"])


@pytest.mark.parametrize("smaller", [0.0, 0.02, 1.0])
def test_a_punch_drawn_in_its_die_is_another_plate(smaller):
    def draw(_, m):
        rectangle(m, "PLATE", -20, -20, 60, 50)
        rectangle(m, "DIE", 0, 0)
        rectangle(m, "PUNCH", smaller, smaller, 20 - 2 * smaller, 10 - 2 * smaller)

    made = compiled(drawing(draw), layer_sides={"DIE": "die"})
    assert [c.side for c in made.plan.cuts] == [Side.PART] * 3  # the opening is a hole of its plate
    assert made.plan.plates == (0, 0, 1)
    assert [d.code for d in made.findings if d.severity.name != "NOTE"] == ["two-plates"]


def test_wildcards_and_names():
    def draw(_, m):
        rectangle(m, "DIE-1", 0, 0)
        rectangle(m, "DIE-2", 40, 0)
        rectangle(m, "DIE[12]", 80, 0)

    sides = [("DIE-*", "die"), ("die[12]", "part")]
    made = compiled(drawing(draw), layer_sides=sides)
    assert widths(made) == {(0, Side.DIE): 19.78, (40, Side.DIE): 19.78, (80, Side.PART): 20.22}


def test_what_names_a_layer_is_no_wildcard_for_others():
    def draw(_, m):
        rectangle(m, "D1", 0, 0)
        rectangle(m, "DX", 40, 0)

    data = drawing(draw).replace(b"\nD1\n", b"\nD*\n")
    made = compiled(data, layer_sides={"D*": "die"})
    assert widths(made) == {(0, Side.DIE): 19.78, (40, Side.PART): 20.22}


@pytest.mark.parametrize(("sides", "said"), [({"DIE": "die"}, 0), ({"*": "die"}, 1)])
def test_a_clearance_that_nothing_takes_is_said(sides, said):
    made = compiled(both(hole=False), layer_sides=sides, clearance=0.02, clearance_on="punch")
    assert [d.code for d in made.findings].count("clearance-untaken") == said


def test_a_layer_that_is_not_there():
    made = wedmcam.compile(both(), name="b.dxf", offset=0.11, layer_sides={"DYE": "die"})
    assert [d.code for d in made.findings] == ["no-such-layer"]
    assert "DIE, PUNCH" in made.findings[0].hint


@pytest.mark.parametrize(
    "said",
    [
        {"layer_sides": {"DIE": "die"}},
        {"layer_sides": {"DIE": "upside"}, "offset": 0.1},
        {"layer_sides": [("DIE", "die"), ("die", "part")], "offset": 0.1},
        {"layer_sides": {"DIE": "on"}, "layer_offsets": {"DIE": 0.1}},
        {"layer_offsets": {"DIE": -0.1}},
        {"offset": 0.1, "clearance": -0.1, "side": "die"},
        {"offset": 0.1, "clearance": 0.1},
        {"clearance": 0.1, "side": "on"},
        {"offset": 0.1, "clearance": 0.1, "side": "die", "clearance_on": "punch"},
        {"offset": 0.1, "clearance": 0.1, "side": "die", "clearance_on": "both"},
    ],
)
def test_wrong_use(said):
    with pytest.raises(WrongUse):
        wedmcam.compile(both(), name="b.dxf", **said)


@pytest.mark.parametrize(
    "said",
    [
        {"side": "die"},
        {"side": "part", "clearance_on": "punch"},
        {"layer_sides": {"DIE": "die"}},
        {"side": "on", "layer_sides": {"DIE": "die"}},
    ],
)
def test_a_clearance_beside_a_side_without_an_offset(said):
    """What is missing is the offset; the side is there."""
    with pytest.raises(WrongUse, match=r"-side .* needs an offset"):
        wedmcam.compile(both(), name="b.dxf", clearance=0.01, **said)


def test_options_are_the_same_again_from_a_certificate():
    options = Options.of(
        offset_um=110.0,
        layer_sides=(("DIE", Side.DIE),),
        layer_offsets=(("DIE", 120.0),),
        clearance_um=20.0,
    )
    assert Options.from_data(json.loads(json.dumps(options.as_data()))) == options


FORGED = {
    # What the plan says -> the code of what the judge finds. The wire is 0.11, the clearance 0.05.
    "none was taken": ({"clearances": (0.0,), "offsets": (110.0,)}, "gouge"),
    "it was taken twice": ({"clearances": (100.0,), "offsets": (10.0,)}, "missing-piece"),
}


@pytest.mark.parametrize("case", FORGED)
def test_the_judge_finds_a_wrong_clearance(case):
    data = drawing(lambda _, m: rectangle(m, "DIE", 0, 0))
    made = compiled(data, side="die", clearance=0.05)
    said, code = FORGED[case]
    scene = replace(made.plan.scenes[0], **said)
    cut = replace(made.plan.cuts[0], offset_um=scene.offsets[0], clearance_um=scene.clearances[0])
    plan = replace(made.plan, cuts=(cut,), scenes=(scene,))
    target = target_of(made.machine)
    _, found = judge_program(made.program, made.plan, target, made.options)
    assert not [d for d in found if d.severity.name == "ERROR"]
    _, found = judge_program(made.program, plan, target, made.options)
    assert code in {d.code for d in found if d.severity.name == "ERROR"}


def test_a_wire_on_the_wrong_side_of_the_line_is_a_gouge():
    """Behind the line by 0.04 mm is right; so far before it the wire would leave a rim."""
    data = drawing(lambda _, m: rectangle(m, "DIE", 0, 0))
    made = compiled(data, side="die", clearance=0.15)
    right = compiled(data, side="die", clearance=0.07)
    target = target_of(made.machine)
    cut = replace(right.plan.cuts[0], offset_um=-40.0, clearance_um=150.0)
    plan = replace(right.plan, cuts=(cut,), scenes=made.plan.scenes)
    _, found = judge_program(right.program, plan, target, made.options)
    assert "missing-piece" in {d.code for d in found}


@pytest.mark.parametrize("to", ["4b", "compensation"])
def test_no_gap_of_a_controller_is_below_0(to):
    def draw(_, m):
        m.add_circle((0, 0), 5)

    with pytest.raises(WrongUse, match="no gap below 0"):
        wedmcam.compile(drawing(draw), name="c.dxf", to=to, offset=0.1, side="die", clearance=0.12)
    made = wedmcam.compile(
        drawing(draw), name="c.dxf", profile="iso-g41-mm", offset=0.1, side="die", clearance=0.12
    )
    assert [d.code for d in made.findings if d.severity.name == "ERROR"] == ["not-reachable"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "both.dxf").write_bytes(both())
    return tmp_path


def run(*words):
    return CliRunner().invoke(cli, list(words))


def test_tables_of_layers_in_the_settings(folder):
    (folder / "wedmcam.toml").write_text(
        'wire = 0.2\ngap = 0.01\nclearance = "20um"\n[layers.DIE]\nside = "die"\noffset = 0.12\n'
    )
    done = run("compile", "both.dxf", "-o", "both.3b", "--certificate", "c.json")
    assert done.exit_code == 0, done.output
    assert "offset 0.100, 0.110 mm" in done.output
    done = run("verify", "both.3b", "--certificate", "c.json", "--against", "both.dxf")
    assert done.exit_code == 0, done.output
    # A shop's layers and clearance are for all its drawings: one without them is no fault.
    (folder / "plain.dxf").write_bytes(drawing(lambda _, m: m.add_circle((0, 0), 5)))
    done = run("compile", "plain.dxf", "-o", "plain.3b")
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ('[layers.DIE]\nside = "dye"\n', 2),
        ('[layers.DIE]\nsides = "die"\n', 2),
        ("[layers.DIE]\nside = true\n", 2),
        ("layers = 3\n", 1),
        ("[layers]\nDIE = 3\n", 1),
        ('[layers."A B"]\nside = "part"\n\n[layers.DIE]\noffset = "x"\n', 5),
    ],
)
def test_wrong_tables(folder, text, line):
    (folder / "wedmcam.toml").write_text(text)
    done = run("check", "both.dxf", "--offset", "0.1")
    assert done.exit_code == 2
    assert f"wedmcam.toml:{line}:" in done.output


def test_every_clearance_keeps_the_wire_from_what_is_kept():
    """The gap between punch and die is the clearance wherever the wire is nearer than at a corner.

    Measured between the two kept boundaries, along a straight side: 2 x 0.11 of kerf less what the
    offsets take.
    """
    for clearance in np.linspace(0.005, 0.3, 7):
        made = compiled(both(hole=False), layer_sides={"DIE": "die"}, clearance=float(clearance))
        found = widths(made)
        punch = found[0, Side.PART] - 2 * 0.11
        die = found[40, Side.DIE] + 2 * 0.11
        assert (die - punch) / 2 == pytest.approx(clearance, abs=1e-4)


@pytest.mark.parametrize(
    ("wall", "severity"), [(0.03, "ERROR"), (0.06, "ERROR"), (0.09, "WARNING"), (0.3, None)]
)
def test_a_wall_that_the_clearance_takes(wall, severity):
    def draw(_, m):
        rectangle(m, "DIE", 0, 0)
        rectangle(m, "DIE", 20 + wall, 0)

    made = wedmcam.compile(drawing(draw), name="w.dxf", offset=0.11, side="die", clearance=0.03)
    found = {(d.code, d.severity.name) for d in made.findings if d.severity.name != "NOTE"}
    assert found == ({("thin-wall", severity)} if severity else set())
    assert made.ok == (severity != "ERROR")


def test_a_fin_that_the_clearance_takes():
    def draw(_, m):
        fin = [(0, 0), (10, 0), (10, 5), (10.05, 5), (10.05, 0), (20, 0), (20, 10), (0, 10)]
        m.add_lwpolyline(fin, close=True)

    made = wedmcam.compile(drawing(draw), name="f.dxf", offset=0.11, side="die", clearance=0.03)
    assert ("thin-wall", "ERROR") in {(d.code, d.severity.name) for d in made.findings}


def test_what_was_understood_of_a_wire_behind_its_line():
    data = drawing(lambda _, m: rectangle(m, "DIE", 0, 0))
    row = compiled(data, side="die", clearance=0.15).understood.rows[0]
    assert row.kept_text == "keeps the outside"
    assert row.offset_text == "wire 0.040 mm outside, clearance 0.150 mm"
    row = compiled(data, side="die", clearance=0.11).understood.rows[0]
    assert row.offset_text == "wire on the line, clearance 0.110 mm"


def test_parts_of_one_plate_keep_out_of_each_other(monkeypatch):
    def draw(_, m):
        rectangle(m, "PUNCH", 0, 0)
        rectangle(m, "DIE", 20.05, 0)

    data = drawing(draw)
    asked = {"offset": 0.11, "layer_sides": {"DIE": "die"}, "clearance": 0.2}
    made = wedmcam.compile(data, name="n.dxf", **asked)
    found = [d for d in made.findings if d.severity.name == "ERROR"]
    assert [d.code for d in found] == ["interference"] * 2
    assert "enters what is kept of another one" in found[0].message
    # And the judge finds it by itself.
    monkeypatch.setattr("wedmcam.transforms.plan.planner.beside", lambda *_: [])
    made = wedmcam.compile(data, name="n.dxf", **asked)
    found = [d for d in made.findings if d.severity.name == "ERROR"]
    assert [d.code for d in found] == ["gouge"]
    assert made.status == 3


def test_a_round_die_takes_its_clearance():
    data = drawing(lambda _, m: m.add_circle((5, 5), 3, dxfattribs={"layer": "DIE"}))
    for clearance, radius in ((0.02, 2.91), (0.11, 3.0), (0.3, 3.19)):
        made = compiled(data, side="die", clearance=clearance)
        path = made.plan.cuts[0].path.vertices
        assert abs(path["x"][0] - path["cx"][0]) / 1000 == pytest.approx(radius)
        assert made.verdict.gouge_um < 1.6

"""Offsets at the edge of what fits: a proven program, or a refusal that names the place.

That the judge has to stop a program of ours is a fault of the compiler.
"""

import numpy as np
import pytest

import parts
import wedmcam
from wedmcam import machines
from wedmcam.compiler import pipeline
from wedmcam.compiler.sources import Drawn
from wedmcam.diag import Severity
from wedmcam.diag.run import Refused, Run
from wedmcam.ir.plan import Side
from wedmcam.ir.sketch import SEGMENT, Sketch
from wedmcam.options import Options
from wedmcam.targets import target_of
from wedmcam.transforms.chain import ChainReport
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.largest import largest_offset
from wedmcam.transforms.layers import Group, rule_of
from wedmcam.transforms.nest import nest

PROFILES = ("b3-compact", "iso-um", "zd065", "iso-mm", "zd065-rotation", "b3-columns")


def regular(sides, apothem, phase=0.0, digits=3):
    a = phase + 2 * np.pi * np.arange(sides) / sides
    radius = apothem / np.cos(np.pi / sides)
    points = np.column_stack([radius * np.cos(a), radius * np.sin(a)])
    return parts.contour_of_bulges(np.round(points, digits), np.zeros(sides))


def bite(radius, mouth):
    """Return a block with a bite of more than half a turn in its upper edge."""
    height = np.sqrt(radius**2 - mouth**2 / 4)
    bulge = -np.tan((2 * np.pi - 2 * np.arcsin(mouth / 2 / radius)) / 4)
    y = 5000 + height
    points = [(-9e3, -9e3), (9e3, -9e3), (9e3, y), (mouth / 2, y), (-mouth / 2, y), (-9e3, y)]
    return parts.contour_of_bulges(np.array(points), np.array([0, 0, 0, bulge, 0, 0]))


def notch(width, depth):
    w = width / 2
    points = [(-9e3, -9e3), (9e3, -9e3), (9e3, 9e3), (w, 9e3), (w, 9e3 - depth),
              (-w, 9e3 - depth), (-w, 9e3), (-9e3, 9e3)]  # fmt: skip
    return parts.contour_of_bulges(np.array(points), np.zeros(8))


def outcome(contours, profile="b3-compact", **options):
    """Return the stage at which a compile stopped, empty where it did not, and the findings."""
    sketch = Sketch(np.zeros(0, SEGMENT))
    target, run = target_of(machines.builtin(profile)), Run()
    asked = Options.of(**options)
    groups = (Group(rule_of("", asked.cutting), tuple(contours)),)
    report = ChainReport(len(contours), 0)
    drawn = Drawn(sketch, tuple(contours), report, nest(contours), False, groups=groups)
    try:
        plan = pipeline.plan_of(drawn, asked, [target], run)
        pipeline.write_and_prove(plan, target, asked, run)
    except Refused as why:
        return why.stage, [d for d in run.findings if d.severity is Severity.ERROR]
    return "", []


def sound(contours, profile="b3-compact", **options):
    stage, errors = outcome(contours, profile, **options)
    if stage:
        assert stage == "plan", (stage, errors)
        assert all(d.code == "interference" and d.points_mm for d in errors), errors
    return not stage


def case(seed):
    rng = np.random.default_rng(seed)
    offset = float(rng.choice([50.0, 100.0, 123.4, 300.0]))
    near = float(rng.choice([rng.uniform(0.05, 3), rng.uniform(0.05, 12), rng.integers(0, 5)]))
    side, kind = Side.DIE, seed % 6
    if kind == 0:
        contour = parts.circle(0, 0, offset + near)
    elif kind == 1:
        contour = regular(int(rng.integers(3, 400)), offset + near, rng.uniform(0, 6))
    elif kind == 2:
        contour = parts.slot(0, 0, rng.uniform(1, 3000), 2 * offset + near, rng.uniform(0, 6))
    elif kind == 3:
        contour = parts.rectangle(2 * offset + near, rng.uniform(1, 10) * offset)
    elif kind == 4:
        radius = max(offset + rng.uniform(-3, 3), 1) if seed % 4 else offset
        contour, side = bite(radius, radius * rng.uniform(0.5, 1.9)), Side.PART
    else:
        contour = notch(2 * offset + rng.uniform(-3, 3), rng.uniform(1, 3000))
        side = Side.PART
    if seed % 2:
        contour = parts.moved(contour, *rng.uniform(-1e4, 1e4, 2))
    return (contour,), offset, side


@pytest.mark.parametrize("first", range(0, 120, 20))
def test_hunted(first):
    for seed in range(first, first + 20):
        contours, offset, side = case(seed)
        sound(contours, PROFILES[seed // 6 % len(PROFILES)], offset_um=offset, side=side)


@pytest.mark.parametrize("more", [0.9, 1.0, 1.5, 2.0, 2.5, 3.5, 4.5])
@pytest.mark.parametrize("profile", PROFILES)
def test_field_hole_r0_102(more, profile):
    for x, y in ((0, 0), (0.5, 0.5), (13.27, -4.61)):
        assert sound((parts.circle(x, y, 100 + more),), profile, offset_um=100.0, side=Side.DIE)


@pytest.mark.parametrize("offset", [4000.0, 4900.0, 4990.0, 4997.0, 4998.0])
def test_field_hole_200_sides(offset):
    assert sound((regular(200, 4999.383),), offset_um=offset, side=Side.DIE)


@pytest.mark.parametrize(("sides", "apothem"), [(200, 4999.383), (360, 6999.733), (31, 700.0)])
def test_inspect_and_compile_agree_on_many_sides(sides, apothem):
    hole = (regular(sides, apothem),)
    told = largest_offset(hole, [1.0]).nearest_um
    assert apothem - 1.5 < told < apothem + 1
    assert sound(hole, offset_um=told - 1.0, side=Side.DIE)
    assert not sound(hole, offset_um=told + 1.0, side=Side.DIE)


@pytest.mark.parametrize("offset", [601.0, 650.0, 790.0, 799.5, 800.0, 800.4, 805.0])
def test_field_bite_sharp(offset):
    part = (bite(800.0, 1200.0),)
    assert largest_offset(part, [-1.0]).nearest_um == 600
    assert sound(part, offset_um=599.0, side=Side.PART)
    assert not sound(part, offset_um=offset, side=Side.PART)


@pytest.mark.parametrize("seed", range(60))
def test_hints_are_true(seed):
    """What fits according to the hint of an interference compiles; 2 um more does not."""
    contours, offset, side = case(seed)
    stage, errors = outcome(contours, offset_um=offset * 1.02 + 1, side=side)
    if stage != "plan" or len(contours) > 1:
        return
    words = errors[0].hint.split(" mm fits")[0]
    told = round(1000 * float(words.split()[-1]))
    fits = told if words.startswith("at most") else told - 1
    if fits < 1:
        return
    assert sound(contours, offset_um=float(fits), side=side)
    assert not sound(contours, offset_um=told + 2.0, side=side)


def test_field_radius_equals_offset():
    made = wedmcam.compile(
        parts.dxf_bytes((parts.rectangle(40e3, 20e3), parts.circle(20e3, 10e3, 100.0))), offset=0.1
    )
    (error,) = [d for d in made.findings if d.severity is Severity.ERROR]
    assert error.code == "interference"
    assert error.hint.startswith("less than 0.100 mm fits")


def test_field_iso_arc_no_radius():
    """An arc of the wire path of a step or two is one that readers take."""
    for radius in (1001.4, 1001.9, 1002.4, 1003.1):
        for turn in (0.0, 0.3, 0.7):
            c = bite(radius, 2 * radius * 0.99999)
            v = c.vertices.copy()
            for x, y in (("x", "y"), ("cx", "cy")):
                a, b = v[x].copy(), v[y].copy()
                v[x], v[y] = (
                    a * np.cos(turn) - b * np.sin(turn),
                    a * np.sin(turn) + b * np.cos(turn),
                )
            for profile in ("iso-um", "iso-mm"):
                sound((type(c)(v, True),), profile, offset_um=1000.0, side=Side.PART)


def test_left_out_sides_of_a_polygon_are_no_interference():
    """Sides that are nanometres farther from the centre than their neighbours are not reached."""
    result, problems = compensate([regular(200, 4999.383, digits=2)], [4997.5])
    assert not problems
    assert not result.interference
    assert len(result.paths[0].path.vertices) < 200

"""--transform: a slot becomes a proven stator; thread points follow, --start does not."""

import math
from pathlib import Path

import numpy as np
import pytest
from test_cli import wedmcam as wedmcam_command

import wedmcam
from drawings import drawing
from wedmcam.options import Options

SAMPLES = Path(__file__).parents[2] / "samples"


def polar(r, degrees):
    return r * math.cos(math.radians(degrees)), r * math.sin(math.radians(degrees))


def slot(doc, msp):
    """Ten degrees of a stator's outline: an arc at R 20, in, an arc at R 17, out."""
    msp.add_arc((0, 0), 20, 0, 6)
    msp.add_line(polar(20, 6), polar(17, 6))
    msp.add_arc((0, 0), 17, 6, 10)
    msp.add_line(polar(17, 10), polar(20, 10))


def key(doc, msp):
    msp.add_lwpolyline([(1, 1), (9, 1, 0.4), (9, 5), (1, 7)], format="xyb", close=True)
    msp.add_point((0, 0), dxfattribs={"layer": "START"})


def compiled(draw, *transforms, to="compact", **more):
    options = Options.of(transforms=transforms, **more)
    return wedmcam.compile(drawing(draw), to=to, name="a.dxf", options=options)


@pytest.mark.parametrize("to", ["3b", "compact"])
def test_a_stator_from_one_slot(to):
    made = compiled(slot, "rotate 10 copies 35 about (0, 0)", to=to, offset_um=100.0)
    assert made.ok, made.findings
    assert made.summary["contours"] == 1
    assert made.summary["closure_um"] == 0
    assert made.summary["max_deviation_um"] < 2
    assert made.summary["gouge_um"] < 1.6
    assert made.summary["options"]["transforms"] == ("rotate 10 copies 35 about (0, 0)",)


def test_the_options_of_a_certificate_are_read_back():
    options = Options.of(transforms=("mirror 45", "rotate 3"))
    assert Options.from_data({"transforms": ["mirror 45", "rotate 3"]}) == options


@pytest.mark.parametrize(
    "word", ["symmetry x", "symmetry y", "mirror 45", "mirror 135", "rotate 90"]
)
def test_a_mirrored_part_keeps_its_side_and_thread_point(word):
    plain = compiled(key, offset_um=100.0)
    made = compiled(key, word, offset_um=100.0)
    assert plain.ok
    assert made.ok, made.findings
    assert made.summary["origin_um"] == [0, 0]
    lengths = [m.verdict.path_mm for m in (plain, made)]
    assert lengths[0] == pytest.approx(lengths[1], abs=0.01)


def test_start_stays_where_it_was_said():
    made = compiled(key, "translate (20, 0)", offset_um=100.0)
    assert made.summary["origin_um"] == [20_000, 0]

    def without_point(doc, msp):
        msp.add_circle((5, 0), 3)

    made = compiled(
        without_point, "translate (20, 0)", offset_um=100.0, starts_um=((21_000.0, 0.0),)
    )
    assert made.ok, made.findings
    assert made.summary["origin_um"] == [21_000, 0]


def test_copies_that_cross_are_refused():
    made = compiled(key, "translate (3, 0) copies 2", offset_um=100.0)
    assert made.stage == "transform"
    assert {d.code for d in made.findings} == {"crossing-contours", "overlap"}


def test_a_misspelt_transform_is_an_error_with_its_column():
    made = compiled(key, "mirror 45", "rotat 10", offset_um=100.0)
    assert made.status == 1
    assert str(made.findings[-1].span) == "--transform 2:1:1"


@pytest.mark.parametrize("name", ["cover", "gear-24", "plate"])
def test_by_how_much_the_arithmetics_differ(name):
    """8 digits are 0.001 um at the size of the samples; some digits are lost on the way."""
    source = SAMPLES / f"{name}.dxf"
    ten = wedmcam.compile(source, offset=0.1, transforms=("rotate 17",))
    floats = wedmcam.compile(source, offset=0.1, transforms=("rotate 17",), arithmetic="float64")
    assert (ten.summary["arithmetic"], floats.summary["arithmetic"]) == ("decimal8", "float64")
    apart = wedmcam.arithmetic_difference(ten, source)
    assert 0 < apart < 0.01
    assert wedmcam.arithmetic_difference(floats, source) == apart
    # And about what the vertices of the two plans are; they may slide along, and arcs bulge.
    far = [
        np.hypot(*(a.path.vertices[k] - b.path.vertices[k] for k in ("x", "y"))).max()
        for a, b in zip(ten.plan.cuts, floats.plan.cuts, strict=True)
    ]
    assert abs(apart - max(far)) < 0.002


def test_paths_of_other_segments_are_compared_by_distance():
    from wedmcam.ir.contour import Contour, vertices
    from wedmcam.operations.arithmetics import _apart

    def box(*corners):
        return Contour(vertices([(x, y, 0, 0, 0, -1) for x, y in corners]), True)

    plain = box((0, 0), (9_000, 0), (9_000, 5_000), (0, 5_000))
    more = box((0, 0), (4_000, 0.5), (9_000, 0), (9_000, 5_000), (0, 5_000))
    assert _apart([plain], [more]) == pytest.approx(0.5)
    assert _apart([plain], [plain]) == 0


def test_findings_of_a_transform_show_what_was_typed():
    """Once the first line of the drawing stood there, with a mark under it."""
    part = str(SAMPLES / "washer.wed")
    said = wedmcam_command("check", part, "-D", "bore=b", "-D", "size=12").stderr.decode()
    assert "-D 1:1:6: error[unknown-name]" in said
    assert "    1 | bore=b\n      |      ^" in said
    more = ("--transform", "translate (1, 2)", "--transform", "mirror 46")
    said = wedmcam_command("check", part, *more).stderr.decode()
    assert "--transform 2:1:8: error[wed-value]" in said
    assert "    1 | mirror 46\n      |        ^~" in said

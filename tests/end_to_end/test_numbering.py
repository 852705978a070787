"""Thread points have one number each in every output: that of their cut, as they are cut."""

from __future__ import annotations

import re

import pytest

import wedmcam
from drawings import drawing
from wedmcam import api
from wedmcam.cli.report import print_report
from wedmcam.options import Options
from wedmcam.reports.setup_sheet import sheet

PART = """
contour plate { from (0, 0) line to (60, 0) line to (60, 20) line to (0, 20) close }
contour a { circle center (50, 10) radius 3 }
contour b { circle cw center (10, 10) radius 4 }
contour c { circle center (30, 10) radius 2 }
cut c inside offset 0.1 start (30, 10.5)
cut a inside offset 0.1
cut b inside offset 0.1 start (11, 10)
cut plate | reverse outside offset 0.1 start (-3, 10)
"""
#: Punch and die from one hole: no move lies between the cuts.
SAME_HOLE = """
contour key { circle center (0, 0) radius 5 }
contour slot { circle center (12, 0) radius 4 }
cut key outside offset 0.1 start (6.5, 0)
cut slot outside offset 0.1 start (6.5, 0)
"""


def four(doc, space):
    """Contours are drawn in another order than they are cut, and thread points in a third."""
    doc.layers.add("START")
    space.add_circle((50, 10), 3)
    space.add_lwpolyline([(0, 0), (60, 0), (60, 20), (0, 20)], close=True)
    space.add_circle((10, 10), 4)
    space.add_circle((30, 10), 2)
    for place in ((-3, 10), (30, 10.5), (11, 10), (50, 11)):
        space.add_point(place, dxfattribs={"layer": "START"})


FOUR = drawing(four)


def of_picture(svg: str) -> list[tuple[str, float, float]]:
    found = re.findall(r"<title>thread point of cut (\d+) at \((\S+), (\S+)\) mm", svg)
    labels = re.findall(r">T(\d+)</text>", svg)
    assert sorted(labels) == sorted(n for n, _, _ in found)
    return sorted((n, float(x), float(y)) for n, x, y in found)


@pytest.mark.parametrize("to", ["3b", "compact", "iso"])
@pytest.mark.parametrize(
    ("source", "options"),
    [
        (FOUR, {}),
        (FOUR, {"order": "given"}),
        (FOUR, {"order": "nearest"}),
        (FOUR, {"reverse": True, "stop_um": 1000.0}),
        (FOUR, {"cuts": (2, 3)}),
        (FOUR, {"from_block": 8}),
        (PART.encode(), {}),
        (PART.encode(), {"reverse": True}),
        (SAME_HOLE.encode(), {}),
    ],
)
def test_picture_sheet_and_screen_number_alike(source, options, to, capsys):
    asked = Options.from_data({"offset_um": 100.0, **options})
    name = "x.dxf" if source is FOUR else "x.wed"
    made = api.compile(source, to=to, name=name, options=asked)
    assert made.ok, made.findings
    want = [
        (str(n), cut.thread[0] / 1000, cut.thread[1] / 1000)
        for n, cut in enumerate(made.plan.cuts, 1)
    ]
    assert of_picture(wedmcam.plot(made, "x")) == want
    holes = dict(sheet(made, "x"))["Start holes"][1]
    assert [(h[0][1:], float(h[1]), float(h[2])) for h in holes] == want
    print_report(made, "x", verbose=True)
    rows = re.findall(r"^ +(\d+) +\d+-\d+ +(\S+) +(\S+)", capsys.readouterr().err, re.M)
    assert [(n, float(x), float(y)) for n, x, y in rows] == want
    first = {}
    for row in api.source_map(made)["blocks"]:
        if row["cut"]:
            first.setdefault(row["cut"], [str(row["cut"]), *(v / 1000 for v in row["start_um"])])
    assert [tuple(v) for v in first.values()] == want
    # The program alone, without the drawing: counted from where it starts.
    alone = api.verify(made.data, profile=made.machine, name="x")
    x0, y0 = want[0][1:]
    there = [(n, pytest.approx(x - x0), pytest.approx(y - y0)) for n, x, y in want]
    assert of_picture(wedmcam.plot(alone, "x")) == there


def test_a_program_in_another_order_has_the_numbers_of_its_findings():
    given = api.compile(FOUR, name="x.dxf", options=Options.from_data({"offset_um": 1e2}))
    other = api.compile(
        FOUR, name="x.dxf", options=Options.from_data({"offset_um": 1e2, "order": "nearest"})
    )
    proof = api.verify(other.data, against=FOUR, against_name="x.dxf", name="x.3b", offset=0.1)
    assert proof.ok
    want = [(str(n), *(v / 1000 for v in c.thread)) for n, c in enumerate(given.plan.cuts, 1)]
    assert of_picture(wedmcam.plot(proof, "x")) == want


def test_before_anything_is_planned_thread_points_have_a_place_and_no_number():
    svg = wedmcam.plot(wedmcam.inspect(FOUR, name="x.dxf"), "x")
    assert not re.search(r">T\d", svg)
    assert len(re.findall(r">T</text>", svg)) == 4
    assert re.search(r"<title>thread point at \(-3.000, 10.000\) mm; x.dxf:#\w+ layer START", svg)

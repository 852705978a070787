"""What was understood: one row a contour, by hand, and the same in every output."""

from __future__ import annotations

import json
import math

import pytest

import wedmcam
from drawings import drawing
from wedmcam import api
from wedmcam.ir.plan import Side
from wedmcam.ir.understanding import Role, counted
from wedmcam.options import Options

PI = math.pi


def plate(doc, space):
    """60 x 40 with two holes; one start hole is drawn, the other and the outside are not."""
    doc.layers.add("START")
    doc.layers.add("CUT")
    on = {"layer": "CUT"}
    space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True, dxfattribs=on)
    space.add_circle((15, 20), 5, dxfattribs=on)
    space.add_circle((45, 20), 8, dxfattribs=on)
    space.add_point((45, 25), dxfattribs={"layer": "START"})


PLATE = drawing(plate)


def compiled(data=PLATE, name="plate.dxf", **mm):
    made = wedmcam.compile(data, name=name, **({"offset": 0.1} | mm))
    assert made.ok, made.findings
    return made


def rows(**mm):
    known = compiled(**mm).understood
    assert known is not None
    return known.rows


def test_a_plate_by_hand():
    known = compiled(stop=0.5, overcut=0.2).understood
    assert known.counts == "1 outer, 2 holes"
    two, one, outer = known.rows
    assert [r.number for r in known.rows] == [1, 2, 3]
    assert [r.role for r in known.rows] == [Role.HOLE, Role.HOLE, Role.OUTER]
    assert [r.depth for r in known.rows] == [1, 1, 0]
    assert [r.kept for r in known.rows] == ["outside", "outside", "inside"]
    assert [r.way for r in known.rows] == ["inside", "inside", "outside"]
    assert [r.frees for r in known.rows] == ["slug", "slug", "part"]
    assert {r.direction for r in known.rows} == {"ccw"}
    assert {(r.offset_um, r.stop_um, r.overcut_um, r.side) for r in known.rows} == {
        (100.0, 500.0, 200.0, "part")
    }
    assert one.thread.at == (15000, 20000)
    assert one.lead_um == pytest.approx(4900)
    assert one.length_um == pytest.approx(2 * PI * 4900)
    assert one.extents == pytest.approx((10e3, 15e3, 20e3, 25e3))
    assert two.thread.at == (45000, 25000)
    assert two.enters == pytest.approx((45000, 27900))
    assert two.lead_um == pytest.approx(2900)
    assert outer.length_um == pytest.approx(2 * (60e3 + 40e3) + 2 * PI * 100)
    assert outer.drawn_by.layers == ("CUT",)
    assert len(outer.drawn_by.handles) == 1
    assert outer.text.startswith(f"{outer.thread.name} (")
    assert "outer contour, 60.000 x 40.000 mm, keeps the inside, wire 0.100 mm outside" in (
        outer.text
    )


def test_a_die_keeps_the_other_side_and_clockwise_is_said():
    got = rows(side=Side.DIE, reverse=True, starts=[(15, 20.5)], data=ROUND)
    assert [(r.role, r.kept, r.way, r.direction) for r in got] == [
        (Role.OUTER, "outside", "inside", "cw")
    ]
    (on,) = rows(data=ROUND, offset=None, side=Side.ON)
    assert (on.kept, on.way, on.offset_um, on.frees) == (None, None, 0.0, "piece")
    assert "no side kept, wire on the line" in on.text


ROUND = drawing(lambda doc, space: space.add_circle((15, 20), 5))


def test_who_placed_a_thread_point_is_said():
    known = compiled(starts=[(-4, 20)]).understood
    by = [r.thread.placed_by for r in known.rows]
    assert by == ["drawing", "wedmcam", "option"]
    handle = known.rows[0].thread.as_data()["where"]["handle"]
    assert known.threads == (
        "T2 placed by wedmcam (no POINT on layer START serves it): POINTs on layer START or "
        "--start choose it",
        f"T1 is the POINT #{handle} on layer START",
        "T3 is --start 1",
    )
    alone = compiled(data=ROUND).understood
    assert alone.threads == (
        "T1 placed by wedmcam (no POINT on layer START): POINTs on layer START or --start "
        "choose it",
    )


PART = b"""contour sq { from (0, 0) line to (20, 0) line to (20, 20) line to (0, 20) close }
contour h { circle center (10, 10) radius 3 }
cut h inside offset 0.1
cut sq outside offset 0.2 start (-2, 10)
"""


def test_a_part_program_says_its_lines():
    known = compiled(PART, "p.wed", offset=None).understood
    assert known.threads == (
        "T1 placed by wedmcam (no 'start' in the cut): 'start (x, y)' in the cut chooses it",
        "T2 is 'start' at line 4",
    )
    assert [r.drawn_by.lines for r in known.rows] == [(2,), (1,)]
    assert known.rows[1].drawn_by.text == "p.wed:1"
    assert [r.offset_um for r in known.rows] == [100.0, 200.0]


def test_contours_on_the_line_of_a_part_program_are_nested_too():
    both = PART.replace(b"inside offset 0.1", b"on").replace(b"outside offset 0.2", b"on")
    assert compiled(both, "p.wed", offset=None).understood.counts == "1 outer, 1 hole"


@pytest.mark.parametrize(("side", "way"), [("left", "left"), ("right", "right")])
def test_an_open_contour_says_its_side_as_it_is_cut(side, way):
    text = f"contour l {{ from (0, 0) line to (20, 0) }}\ncut l {side} offset 0.1\n".encode()
    (row,) = rows(data=text, name="l.wed", offset=None)
    assert (row.role, row.kept, row.way, row.frees) == (Role.OPEN, None, way, None)
    y = "0.100" if way == "left" else "-0.100"
    assert row.direction == f"from (0.000, {y}) to (20.000, {y})"


def test_what_is_left_of_a_contour_lies_as_the_whole():
    whole = compiled()
    last = max(c.last_block for c in whole.verdict.cuts)
    for back in (False, True):
        made = api.compile(
            PLATE,
            name="p.dxf",
            options=Options.of(offset_um=100.0, from_block=last - 2, backwards=back),
        )
        assert made.ok, made.findings
        (row,) = made.understood.rows
        assert (row.role, row.kept, row.way) == (Role.OUTER, "inside", "outside")
        assert row.direction == ("cw" if back else "ccw")
        assert row.thread.placed_by == ("wedmcam" if back else "option")


def test_islands_and_open_contours_are_counted():
    roles = [Role.of(True, d) for d in (0, 1, 2, 3, 4)] + [Role.OPEN]
    assert counted(roles) == "1 outer, 2 holes, 2 islands, 1 open contour"
    assert counted([Role.OPEN] * 2) == "2 open contours"
    assert counted([]) == ""


def test_the_certificate_and_the_proof_have_the_same_rows():
    made = compiled(stop=0.5)
    data = json.loads(json.dumps(made.summary))
    assert data["understood"] == made.understood.as_data()
    proof = api.verify(made.data, against=PLATE, against_name="x/plate.dxf", certificate=data,
                       options=made.options, name="p.3b")  # fmt: skip
    assert proof.ok, proof.findings
    assert proof.summary["understood"] == data["understood"]


def test_a_second_pass_frees_nothing():
    two = PART + b"cut sq outside offset 0.1 start (-2, 10)\n"
    assert [r.frees for r in rows(data=two, name="p.wed", offset=None)] == ["slug", "part", None]

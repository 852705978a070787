"""Programs from elsewhere: origin unknown, another order, sense, start or leads; other machines."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from judge_cases import (
    arc_to,
    control,
    edited,
    hole_plan,
    line,
    lower,
    move,
    part_with_hole,
    skew_plan,
    square_plan,
)

from plans import one_scene
from wedmcam.controllers.pointwise import of_table
from wedmcam.diag import Severity
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Side
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge.certificate import CertifiedProgram, CertifiedSource, certificate
from wedmcam.judge.followed import Terms
from wedmcam.judge.judge import judge
from wedmcam.judge.origin import fit

#: A program from elsewhere has an order and leads of its own.
FOREIGN = Terms(strict_order=False)
T = of_table("rotate")


def codes(findings):
    return {f.code for f in findings if f.severity is Severity.ERROR}


@pytest.mark.parametrize(
    "plan",
    [part_with_hole(), skew_plan(), square_plan(), hole_plan(Side.DIE)],
    ids=["hole", "skew", "square", "die"],
)
def test_origin_is_fitted_to_the_micron(plan):
    program = lower(plan)
    lost = replace(program, origin=(0, 0))
    fitted, findings = fit(lost, plan, stepping=T)
    assert fitted is not None
    assert fitted.origin == program.origin
    assert [f.code for f in findings] == ["origin-fitted"]
    verdict, found = judge(fitted, plan, stepping=T, terms=FOREIGN)
    assert verdict.ok, found


def test_nothing_to_fit():
    program = lower(hole_plan(Side.DIE))
    fitted, findings = fit(program, square_plan(), stepping=T)
    assert fitted is None
    assert codes(findings) == {"no-fit"}
    assert "19.800 x 19.800" in findings[0].message
    empty = Program(control(Kind.END))
    assert fit(empty, square_plan(), stepping=T)[0] is None


def other_way_round():
    """The square and its hole as an old program may have them.

    First the square, clockwise, from its upper left corner, threaded beside it; then the hole from
    its lowest point.
    """
    d = 100
    at = (-1000, 10000)
    rows, p = [], at

    def to(x, y, centre=None):
        nonlocal p
        if centre is None:
            rows.append(line(x - p[0], y - p[1]))
        else:
            rows.append(arc_to(p, (x, y), centre, -1))
        p = (x, y)

    to(-d, 10000)
    to(0, 10000 + d, (0, 10000))
    to(10000, 10000 + d)
    to(10000 + d, 10000, (10000, 10000))
    to(10000 + d, 0)
    to(10000, -d, (10000, 0))
    to(0, -d)
    to(-d, 0, (0, 0))
    to(-d, 10000)
    to(-1000, 10000)
    rows += [control(Kind.PAUSE), move(6000, -5000 - 1000), control(Kind.PAUSE)]
    p = (5000, 4000)
    to(5000, 3100)
    to(5000, 6900, (5000, 5000))
    to(5000, 3100, (5000, 5000))
    to(5000, 4000)
    rows.append(control(Kind.STOP))
    return Program(np.concatenate(rows), at)


def test_other_order_sense_start_and_leads_are_notes():
    plan, program = part_with_hole(), other_way_round()
    verdict, findings = judge(program, plan, stepping=T, terms=FOREIGN)
    assert verdict.ok, findings
    assert {f.code for f in findings} == {"other-order", "other-leads"}
    assert {f.severity for f in findings} == {Severity.NOTE}
    assert verdict.max_deviation_um == pytest.approx(1.0)
    assert verdict.closure_um == 0
    assert [c.number for c in verdict.cuts] == [2, 1]
    assert [c.backwards for c in verdict.cuts] == [True, True]
    said = " ".join(f.message for f in findings)
    assert "in the order 2, 1" in said
    assert "threaded at (-1.000, 10.000)" in said
    strict, _ = judge(program, plan, stepping=T)
    assert not strict.ok
    fitted, _ = fit(replace(program, origin=(7, 7)), plan, stepping=T)
    assert fitted is not None
    assert fitted.origin == program.origin


@pytest.mark.parametrize("row", [1, 3, 5, 7])
def test_forgeries_are_refused_there_too(row):
    plan, program = part_with_hole(), other_way_round()

    def turned(b):
        b["turn"][row] = -b["turn"][row]

    def longer(b):
        b["count"][row] += 5

    def missing(b):
        return np.delete(b, row)

    for change in (turned, longer, missing):
        verdict, findings = judge(edited(program, change), plan, stepping=T, terms=FOREIGN)
        assert not verdict.ok
        assert codes(findings)


def test_overcut_and_the_way_back_on_it_are_leads():
    plan = square_plan()
    body = lower(plan).blocks[:-2]
    back = np.concatenate([body, line(1000, 0), line(-1000, 0), line(0, -900), control(Kind.STOP)])
    verdict, findings = judge(Program(back, plan.cuts[0].thread), plan, stepping=T, terms=FOREIGN)
    assert verdict.ok, findings
    # From the start of a corner arc: over the arc and back on it.
    v = np.roll(plan.cuts[0].path.vertices[:-1], -1)
    v[-1]["x"], v[-1]["turn"] = 0.0, 0
    round_ = replace(
        plan,
        cuts=(replace(plan.cuts[0], path=Contour(v, True), thread=(10000, -1000)),),
    )
    rows = lower(round_).blocks
    over = [arc_to((10000, -100), (10100, 0), (10000, 0), 1)]
    over.append(arc_to((10100, 0), (10000, -100), (10000, 0), -1))
    program = Program(np.concatenate([rows[:-2], *over, rows[-2:]]), (10000, -1000))
    for asked in (round_, plan):
        verdict, findings = judge(program, asked, stepping=T, terms=FOREIGN)
        assert verdict.ok, findings
        assert verdict.closure_um == 0


def test_lead_through_the_part_and_missing_hole_are_refused_there_too():
    plan, program = part_with_hole(), other_way_round()
    # Threaded inside the part, 1 mm to the right of the upper left corner.
    inner = edited(program, lambda b: b)
    blocks = inner.blocks.copy()
    blocks["x"][0], blocks["x"][9] = -1100, 1100
    blocks["count"][0] = blocks["count"][9] = 1100
    blocks["x"][11] -= 2000
    blocks["count"][11] = max(abs(blocks["x"][11]), abs(blocks["y"][11]))
    blocks["axis"][11] = Axis.Y
    forged = Program(blocks, (1000, 10000))
    verdict, findings = judge(forged, plan, stepping=T, terms=FOREIGN)
    assert "gouge" in codes(findings)
    only = Program(program.blocks[:10].copy(), program.origin)
    verdict, findings = judge(only, plan, stepping=T, terms=FOREIGN)
    assert {"missing-cut", "missing-piece"} <= codes(findings)
    assert verdict.contours == 1


def test_textbook_count_tells_both_machines():
    """J by geometry for an arc of odd radius: right where ends are recomputed, off in steps."""
    plan = skew_plan(0.3, 20000.0)
    program = lower(plan)
    exact, _ = judge(program, plan, stepping=T)
    assert exact.ok
    assert exact.stepped_closure_um is None
    # The published hole: both machines close it.
    hole = hole_plan(Side.DIE)
    verdict, findings = judge(lower(hole), hole, stepping=T, count="textbook")
    assert verdict.ok
    assert not findings
    assert (verdict.closure_um, verdict.stepped_closure_um) == (0.0, 0.0)
    assert verdict.max_deviation_um <= 1.0
    assert verdict.stepped_max_deviation_um == 1.0
    assert verdict.count == "textbook"
    # A circle that starts off the axes: textbook J is 4 R with R rounded, the stepped one is not.
    from judge_cases import circle

    from wedmcam.ir.contour import vertices
    from wedmcam.ir.plan import Cut

    path = Contour(vertices([(7001, 5002, 0, 0, 1, -1)]), True)
    r = float(np.hypot(7001, 5002))
    odd = one_scene(
        (Cut(circle(0, 0, r + 100), path, (0, 0)),), (circle(0, 0, r + 100),), (0,), Side.DIE, 100.0
    )
    rows = lower(odd).blocks.copy()
    rows["count"][1] = 4 * round(r)
    rows["axis"][1] = Axis.Y
    written = Program(rows, (0, 0))
    verdict, findings = judge(written, odd, stepping=T, count="textbook")
    assert verdict.ok, findings
    assert verdict.closure_um == 0
    assert verdict.stepped_closure_um > 0
    assert [f.code for f in findings] == ["stepped-differs"]
    assert not judge(written, odd, stepping=T)[0].ok


def test_certificate_is_plain_and_the_same_every_time():
    plan = part_with_hole()
    program = lower(plan)

    def make():
        verdict, findings = judge(program, plan, stepping=T)
        return json.dumps(
            certificate(
                verdict,
                findings,
                CertifiedSource("part.dxf", b"abc", "mm", join_um=0.4),
                CertifiedProgram("part.3b", b"", "3b"),
                options={"side": "part", "offset": "0.1mm"},
            ),
            indent=1,
        )

    text = make()
    assert text == make()
    data = json.loads(text)
    shared = "input output format units origin_um contours blocks steps closure_um "
    shared += "max_deviation_um gouge_um offset_um side diagnostics ok"
    assert list(data)[: len(shared.split())] == shared.split()
    assert data["ok"] is True
    assert data["origin_um"] == [5000, 5000]
    assert data["sha256"]["input"].startswith("ba7816bf")
    assert data["contours"] == len(data["cuts"]) == 2
    assert data["options"] == {"offset": "0.1mm", "side": "part"}
    assert "-0.0" not in text
    assert "NaN" not in text
    assert "stepped_closure_um" not in data


def test_certificate_of_a_refused_program_is_plain_too():
    plan = square_plan()
    program = edited(lower(plan), lambda b: np.delete(b, 3))
    verdict, findings = judge(program, plan, stepping=T, count="textbook")
    data = certificate(
        verdict,
        findings,
        CertifiedSource("a", b"", "mm"),
        CertifiedProgram("b", b"", "3b"),
    )
    text = json.dumps(data, allow_nan=False)
    assert json.loads(text)["ok"] is False
    assert data["closure_um"] is None
    assert "stepped_gouge_um" in data
    assert data["diagnostics"][0]["severity"] == "error"

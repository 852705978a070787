"""Punch and die as they are written: by two compiles to ``.zd``, and from one ``.zdc`` by two gaps.

What fits are the wires of both. The plans do to 0.3 um (test_paper_corners.py); here are the blocks
that were written, whole um and all, from both sides, each place of the two paths.
"""

import math

import numpy as np
import pytest

import wedmcam
from wedmcam import machines
from wedmcam.diag import Severity
from wedmcam.frontends.zd065.compensation import decode
from wedmcam.ir.program import Kind
from written import off_clearance, path_of

M = machines.builtin("zd065-compensation")
F_UM, REACH_MM = 100, 12.0
#: So much the clearance may be off [R], and so near to the corner it is looked at, um.
OFF_UM, NEAR_UM = 1.6, 9_000.0


def figure(degrees, turned, curved):
    """Return a part program of one contour with a corner of so many degrees at (0, 0).

    A line and a line, or a line and an arc of 40 mm; the first leg is turned by some degrees.
    """
    a, b = math.radians(turned), math.radians(turned + degrees)
    b += math.asin(REACH_MM / 2 / 40.0) if curved else 0.0
    (x, y), (u, v) = ((REACH_MM * math.cos(t), REACH_MM * math.sin(t)) for t in (a, b))
    back = "arc cw to (0, 0) radius 40" if curved else "close"
    return (
        f"units mm\ncontour c {{ from (0, 0) line to ({x:.9f}, {y:.9f}) "
        f"arc ccw to ({u:.9f}, {v:.9f}) center (0, 0) {back} }}\n"
    )


def made(text, side, offset_um, corner_mm, to):
    corner = f" corner {corner_mm}" if corner_mm else ""
    cut = f"cut c {side} offset {offset_um / 1000} corners paper{corner}\n"
    result = wedmcam.compile((text + cut).encode(), name="pair.wed", to=to)
    assert result.ok, [str(d) for d in result.findings]
    return result


def contour_of(program):
    """Return places on the path of a program without its leads, from its start."""
    kind = program.blocks["kind"]
    cutting = np.flatnonzero((kind == Kind.LINE) | (kind == Kind.ARC))
    which = np.zeros(len(kind), bool)
    which[cutting[1:-1]] = True
    return path_of(program.blocks, which)


def in_drawing(result):
    return contour_of(result.program) + np.array(result.program.origin)


def by_gap(result, gap, outwards):
    program, found = decode(result.data, M, "pair.zdc", gap, outwards, float(F_UM))
    assert not [d for d in found if d.severity is Severity.ERROR]
    return contour_of(program)


CASES = [
    (20, 0, 0), (20, 7.3, 20), (35, 23.7, 5), (60, 61, 20), (90, 0, 5), (120, 33, 20),
    (178, 12, 5), (200, 23.7, 20), (270, 0, 0), (300, 61, 5), (340, 11, 20),
]  # fmt: skip


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("degrees", "turned", "z"), CASES)
def test_two_compiles_with_one_r_have_the_clearance_that_is_meant(degrees, turned, z, curved):
    text = figure(degrees, turned, curved)
    punch, die = (
        in_drawing(made(text, side, um, F_UM / 1000, "compact"))
        for side, um in (("outside", F_UM), ("inside", F_UM - z))
    )
    assert off_clearance(punch, die, 2 * F_UM - z, np.zeros(2), NEAR_UM) <= OFF_UM


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize(("degrees", "turned"), [case[:2] for case in CASES])
def test_two_gaps_of_one_file_have_it_too(degrees, turned, curved):
    of_punch = made(figure(degrees, turned, curved), "outside", F_UM, F_UM / 1000, "compensation")
    punch, corner = by_gap(of_punch, F_UM, True), -np.array(of_punch.program.origin)
    for z in (0, 5, 20):
        die = by_gap(of_punch, F_UM - z, False)
        assert off_clearance(punch, die, 2 * F_UM - z, corner, NEAR_UM) <= OFF_UM


@pytest.mark.parametrize(("degrees", "turned"), [(60, 7.3), (90, 23.7), (150, 0), (300, 11)])
def test_with_radii_of_their_own_the_clearance_follows_the_formula(degrees, turned):
    """Offsets f and f - z, each its own radius: from z down to z (2 - 1 / sin(beta / 2)).

    That is 0 at 60 degrees, where punch and die touch, and all of z with z = 0.
    """
    text, half = figure(degrees, turned, False), math.radians(min(degrees, 360 - degrees) / 2)
    punch = in_drawing(made(text, "outside", F_UM, None, "compact"))
    for z in (0, 5, 20):
        die = in_drawing(made(text, "inside", F_UM - z, None, "compact"))
        less = z * (1 / math.sin(half) - 1)
        assert less <= z + 1e-9
        off = off_clearance(punch, die, 2 * F_UM - z, np.zeros(2), NEAR_UM)
        assert off <= less + OFF_UM


def warned(found):
    return [d.message for d in found if d.code == "acute-corner"]


@pytest.mark.parametrize(("degrees", "warns"), [(20, 1), (59, 1), (61, 0), (299, 0), (301, 1)])
def test_a_corner_below_60_degrees_is_warned_of_where_r_is_the_gap(degrees, warns):
    text = figure(degrees, 7.3, False)
    of_default = made(text, "outside", F_UM, None, "compact")
    assert len(warned(of_default.findings)) == warns
    assert not warned(made(text, "outside", F_UM, 0.12, "compact").findings)
    file = made(text, "outside", F_UM, F_UM / 1000, "compensation")
    for gap, outwards in ((F_UM, True), (80, False)):
        _, found = decode(file.data, M, "pair.zdc", gap, outwards)
        assert len(warned(found)) == warns
        _, found = decode(file.data, M, "pair.zdc", gap, outwards, 120.0)
        assert not warned(found)

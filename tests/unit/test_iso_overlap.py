"""Outlines in G41 and G42 that run on over their start, and what one block of look-ahead sees."""

import pytest

from drawings import drawing
from wedmcam import api
from wedmcam.api import positions
from wedmcam.machines import builtin
from wedmcam.targets import Entries, g41

MM = builtin("iso-mm")
#: The inside of a square of 20 mm, counter-clockwise from the middle of its right side.
ROUND = ["Y10.", "X-10.", "Y-10.", "X10."]
INSIDE = ["G90 G21", "G92 X8. Y0.", "G01 G41 D1 X10."]
OUT = ["G40 X8. Y0.", "M02"]
#: The wire's path once round, from where the lead-in ends.
PATH = [(9860, 9860), (-9860, 9860), (-9860, -9860), (9860, -9860)]


def text(*lines):
    return "\n".join(line for part in lines for line in ([part] if isinstance(part, str) else part))


def read(program, um=140.0):
    return g41.decode(program.encode(), MM, "x.nc", Entries(d=((1, um),)).offset_of())


def path(program, start=(8000, 0), um=140.0):
    """Return where the blocks of a program end, um, in its own coordinates."""
    made, found = read(program, um)
    assert not found, found
    return [(x + start[0], y + start[1]) for x, y in positions(made, MM)[1].tolist()]


def lost(program, um=140.0):
    _, found = read(program, um)
    errors = [d for d in found if d.severity.name == "ERROR"]
    assert [d.code for d in errors] == ["compensation-lost"]
    return errors[0]


def test_field_g41_overlap():
    assert path(text(INSIDE, ROUND, "Y0.5", "G40 X8.", "M02")) == [
        (9860, 0), *PATH, (9860, 500), (8000, 500), (8000, 500)
    ]  # fmt: skip


def test_an_overlap_of_nothing_closes():
    assert path(text(INSIDE, ROUND, "Y0.", OUT)) == [
        (9860, 0), *PATH, (9860, 0), (8000, 0), (8000, 0)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("more", "ends"),
    [
        (["Y10.", "X9."], [PATH[0], (9000, 9860)]),
        (["Y10.", "X-10.", "Y-10.", "X0."], [*PATH[:3], (0, -9860)]),
        (["Y10.", "X-10.", "Y-10.", "X10.", "Y0."], [*PATH, (9860, 0)]),
        (["Y0.", *ROUND, "Y0."], [(9860, 0), *PATH, (9860, 0)]),
        (["Y-4.", "Y0.", *ROUND, "Y0.3"], [(9860, -4000), (9860, 0), *PATH, (9860, 300)]),
        ([*ROUND, *ROUND, "Y0.3"], [*PATH, *PATH, (9860, 300)]),
    ],
)
def test_an_overlap_passes_corners_and_goes_round_again(more, ends):
    made = path(text(INSIDE, ROUND, more, "G40 X0. Y0.", "M02"))
    assert made == [(9860, 0), *PATH, *ends, (0, 0), (0, 0)]


def test_outside_it_goes_round_outer_corners_and_may_end_at_one():
    outside = [line.replace("G41", "G42").replace("X8.", "X12.") for line in INSIDE]
    once = path(text(outside, ROUND, "Y10.", "G40 X12. Y12.", "M02"), (12000, 0))
    assert once[1:3] == [(10140, 10000), (10000, 10140)]
    assert once[-4:-2] == [(10140, -10000), (10140, 10000)]
    past = path(text(outside, ROUND, "Y10.", "X9.", "G40 Y12.", "M02"), (12000, 0))
    assert past[-5:-2] == [(10140, 10000), (10000, 10140), (9000, 10140)]


def test_clockwise():
    other = [line.replace("Y1", "Y-1").replace("Y--", "Y") for line in ROUND]
    there = ["Y-10.", "X-10.", "Y10.", "X10."]
    assert other != there
    made = path(text([INSIDE[0], INSIDE[1], "G01 G42 D1 X10."], there, "Y-0.5", OUT))
    assert made[:-2] == [(9860, 0), *((x, -y) for x, y in PATH), (9860, -500)]


def test_an_overlap_on_an_arc():
    start, end = ["G90 G21", "G92 X8. Y0.", "G01 G41 D1 X10."], ["G40 G01 X8. Y0.", "M02"]
    round_ = ["G03 X0. Y10. I-10.", "X0. Y-10. J-10.", "X6. Y8. J10."]
    made = path(text(start, round_, end))
    # 9.86 of 10 mm: the place at 6, 8 lies at 5.916, 7.888.
    ends = [(9860, 0), (0, 9860), (0, -9860)]
    assert [p for p in made if p in ends] == ends
    assert min(abs(x - 5916) + abs(y - 7888) for x, y in made) <= 2


def test_a_lead_out_may_be_askew():
    made = path(text(INSIDE, ROUND, "Y0.5", "G40 X8. Y1.3", "M02"))
    assert made[-3:-1] == [(9860, 500), (8000, 1300)]


def test_ways_in_and_out_in_compensation_are_no_walls():
    start = ["G90 G21", "G92 X5. Y0.", "G01 G41 D1 X7.", "X10."]
    made = path(text(start, ROUND, "Y0.5", "X7.", "G40 X5. Y0.", "M02"), (5000, 0))
    assert made[:3] == [(7000, 140), (9860, 140), (9860, 9860)]
    assert made[-4:-2] == [(9860, 360), (7000, 360)]


def test_several_contours():
    second = ["M00", "G00 X38. Y0.", "M00", "G41 D1 G01 X40.", "Y10.", "X20.", "Y-10.", "X40."]
    made = path(text(INSIDE, ROUND, "Y0.5", OUT[0], second, "Y0.4", "G40 X38. Y0.", "M02"))
    assert (9860, 500) in made
    assert made[-3:-1] == [(39860, 400), (38000, 0)]


@pytest.mark.parametrize(
    ("more", "line", "said"),
    [
        (["Y0.5", "Y0."], 9, "runs back on the block of line 4"),
        (["Y0.", "Y-10.", "X-10.", "Y10.", "X10.", "Y0."], 13, "runs back on the block of line 4"),
        # At an inner corner the wire would stand in the next side.
        (["Y10."], 8, "0.000 mm near to the block of line 5"),
        (["Y9.95"], 8, "0.050 mm near to the block of line 5"),
        (["Y0.5", "X3.", "Y30."], 9, "0.000 mm near to the block of line 4"),
    ],
)
def test_what_is_no_overlap_is_refused(more, line, said):
    found = lost(text(INSIDE, ROUND, more, OUT))
    assert found.span.line == line
    assert said in found.message
    assert found.hint


def test_the_other_side_takes_g40():
    second = ["G42 D1 X10.", "Y-10.", "X-10.", "Y10.", "X10.", "Y-0.5"]
    made = path(text(INSIDE, ROUND, "Y0.5", OUT[0], second, OUT))
    assert made[-7:-2] == [*PATH[::-1], (9860, -500)]


def test_walls_that_the_controller_does_not_see_are_found():
    # A bulb behind a mouth of 0.2 mm: neighbours leave room, the two sides of the mouth do not.
    bulb = ["Y-0.1", "X12.", "Y-3.", "X18.", "Y3.", "X12.", "Y0.1", "X10."]
    start = ["G90 G21", "G92 X8. Y-5.", "G01 G41 D1 X10."]
    rest = ["Y10.", "X-10.", "Y-10.", "X10.", "Y-5.", "G40 X8.", "M02"]
    assert "near to the block" in lost(text(start, bulb, rest)).message
    assert path(text(start, bulb, rest), (8000, -5000), 90.0)


SQUARE = drawing(
    lambda doc, space: space.add_lwpolyline(
        [(10, -10), (10, 10), (-10, 10), (-10, -10)], close=True
    )
)
#: The same, turned: no side lies along an axis.
TURNED = [(9, -7), (7, 9), (-9, 7), (-7, -9)]


def verified(program, source=SQUARE, **more):
    return api.verify(
        program.encode(), against=source, against_name="s.dxf", name="x.nc", offset=0.14,
        side="die", profile="iso-mm", d=((1, 140.0),), **more,
    )  # fmt: skip


@pytest.mark.parametrize(
    "more",
    [
        ["Y0.5", *OUT],
        ["Y10.", "X9.", *OUT],
        ["Y0.5", "X9.", *OUT],
        ["Y0.5", OUT[0], "G41 D1 X10.", *ROUND, "Y0.5", *OUT],
        ["Y0.5", OUT[0], "G42 D1 X10.", "Y-10.", "X-10.", "Y10.", "X10.", "Y-0.5", *OUT],
        ["Y0.", *ROUND, "Y0.5", *OUT],
    ],
)
def test_an_overlap_is_proven_against_the_drawing(more):
    proof = verified(text(INSIDE, ROUND, more))
    assert proof.ok, [d.message for d in proof.findings]
    assert proof.verdict.closure_um == 0


def test_an_overlap_of_a_slanting_line_closes_within_the_limit():
    (ax, ay), *rest = TURNED
    mx, my = (TURNED[0][0] + TURNED[1][0]) / 2, (TURNED[0][1] + TURNED[1][1]) / 2
    lines = ["G90 G21", "G92 X6. Y0.", f"G01 G41 D1 X{mx:.3f} Y{my:.3f}"]
    lines += [f"X{x:.3f} Y{y:.3f}" for x, y in [*rest, (ax, ay)]]
    dx, dy = rest[0][0] - ax, rest[0][1] - ay
    lines += [f"X{mx + 0.05 * dx:.3f} Y{my + 0.05 * dy:.3f}", "G40 X6. Y0.", "M02"]
    source = drawing(lambda doc, space: space.add_lwpolyline(TURNED, close=True))
    proof = verified(text(lines), source)
    assert proof.ok, [d.message for d in proof.findings]
    assert proof.verdict.closure_um <= 2.0


@pytest.mark.parametrize("x", ["X10.02", "X9.98"])
def test_an_overlap_beside_the_first_pass_is_refused(x):
    assert "line 4" in lost(text(INSIDE, ROUND[:-1], x, "Y0.5", OUT)).message


def test_a_path_that_runs_on_beside_itself_is_refused():
    lines = ["X9.86", "Y9.86", "X-9.86", "Y-9.86", "X9.86", "X9.87 Y0.5"]
    proof = verified(text(INSIDE[:2], "G01", lines, "X8. Y0.", "M02"))
    assert not proof.ok
    assert {"path-deviation"} <= {d.code for d in proof.findings}
    assert verified(text(INSIDE[:2], "G01", lines[:-1], "Y0.5", "X8. Y0.", "M02")).ok


def test_an_outline_that_ends_before_its_start_is_refused():
    proof = verified(text(INSIDE, ROUND, "Y-0.5", OUT))
    assert not proof.ok

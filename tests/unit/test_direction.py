"""The way the wire runs a closed contour of a part program: counter-clockwise, or as stated."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wedmcam import api
from wedmcam.ir.program import Kind
from wedmcam.options import Options

PLATE = "contour plate { from (0, 0) line to (30, 0) line to (30, 20) line to (0, 20) close }\n"
CLOCKWISE = "contour plate { from (0, 0) line to (0, 20) line to (30, 20) line to (30, 0) close }\n"
HOLE = "contour hole { circle center (40, 10) radius 1.5 }\n"
HOLE_CW = "contour hole { circle cw center (40, 10) radius 1.5 }\n"
TOOTH = (
    "contour tooth { from polar(10, 85) line to polar(12, 86) line to polar(12, 94) "
    "line to polar(10, 95) }\n"
)


def compiled(text: str, to: str = "3b", **options: object) -> api.Compilation:
    made = api.compile(text.encode(), to=to, name="x.wed", options=Options.of(**options))  # type: ignore[arg-type]
    assert made.ok, made.findings
    return made


def ways(made: api.Compilation) -> str:
    """Return + for each contour that is stepped counter-clockwise, - for the others."""
    assert made.program is not None
    blocks = made.program.blocks
    at, first = made.machine.stepping.trace(blocks)
    ends = [*first.tolist(), len(at) - 1]
    moves = np.flatnonzero(blocks["kind"] == Kind.MOVE).tolist()
    out = ""
    for low, high in zip([0, *(k + 1 for k in moves)], [*moves, len(blocks)], strict=True):
        x, y = at[ends[low] : ends[high] + 1].T
        # The leads run the same way there and back: they enclose nothing.
        out += "+" if (x[:-1] * np.diff(y) - y[:-1] * np.diff(x)).sum() > 0 else "-"
    return out


def test_field_reverse_outside():
    made = compiled(
        "units mm\n" + PLATE + "let back = plate | reverse\n"
        "cut back outside offset 0.1 start (15, -3)\n"
    )
    assert ways(made) == "-"
    # The very path of --reverse without the word.
    plain = compiled(PLATE + "cut plate outside offset 0.1 start (15, -3)", reverse=True)
    assert made.data == plain.data


@pytest.mark.parametrize(
    ("text", "way"),
    [
        (PLATE + "cut plate outside offset 0.1", "+"),
        # Points in another order, and mirrors, draw the shape and state no way (ruling 4).
        (CLOCKWISE + "cut plate outside offset 0.1", "+"),
        (PLATE + "cut plate | mirror 45 outside offset 0.1", "+"),
        (CLOCKWISE + "cut plate | reverse outside offset 0.1", "-"),
        (PLATE + "cut plate | reverse | mirror 45 outside offset 0.1", "-"),
        (PLATE + "cut plate | symmetry x | reverse outside offset 0.1", "-"),
        (PLATE + "let a = plate | reverse cut a | reverse outside offset 0.1", "+"),
        (PLATE + "cut plate | reverse inside offset 0.1", "-"),
        (PLATE + "cut plate | reverse | translate (50, 0) copies 2 outside offset 0.1", "---"),
        (PLATE + "cut plate | with translate (50, 0) | reverse outside offset 0.1", "--"),
        (PLATE + "cut plate | reverse outside offset 0.1 corner 1 stop 2 overcut 1", "-"),
        (HOLE + "cut hole inside offset 0.1", "+"),
        (HOLE_CW + "cut hole inside offset 0.1", "-"),
        (HOLE_CW + "cut hole outside offset 0.1", "-"),
        (HOLE_CW + "cut hole | reverse inside offset 0.1", "+"),
        (HOLE + "cut hole | mirror 45 inside offset 0.1", "+"),
        (HOLE_CW + "cut hole | mirror 45 inside offset 0.1", "-"),
        (HOLE_CW + "cut hole | with symmetry x inside offset 0.1", "--"),
        (HOLE_CW + "cut hole | rotate 90 copies 3 inside offset 0.1", "----"),
        (TOOTH + "cut tooth | rotate 10 copies 35 inside offset 0.1", "+"),
        (TOOTH + "cut tooth | rotate 10 copies 35 | reverse inside offset 0.1", "-"),
        (TOOTH + "cut tooth | reverse | rotate 10 copies 35 inside offset 0.1", "-"),
        (HOLE_CW + PLATE + "cut hole inside offset 0.1 cut plate outside offset 0.2", "-+"),
        (
            "contour ring { circle cw center (0, 0) radius 2 circle center (0, 0) radius 9 }"
            "cut ring outside offset 0.1",
            "-+",
        ),
        # The drawn sense is run where the side follows it.
        (CLOCKWISE + "cut plate left offset 0.1", "-"),
        (CLOCKWISE + "cut plate on", "-"),
        (PLATE + "cut plate | reverse on", "-"),
        (PLATE + "cut plate | mirror 45 right offset 0.1", "-"),
    ],
)
def test_a_contour_is_run_as_it_is_stated_and_the_other_way_with_reverse(text, way):
    assert ways(compiled(text)) == way
    other = compiled(text, reverse=True)
    assert ways(other) == way.translate(str.maketrans("+-", "-+"))
    # It is the same part: either program proves against the other's.
    proof = api.verify(
        other.data, against=text.encode(), against_name="x.wed", name="x.3b", options=Options()
    )
    assert proof.ok, proof.findings


@pytest.mark.parametrize("to", ["compact", "rotation", "iso", "4b", "compensation"])
def test_reverse_holds_in_every_format(to):
    text = "contour hole { circle cw center (4, 10) radius 1.5 } cut hole inside offset 0.1"
    assert ways(compiled(text, to)) == "-"
    assert ways(compiled(text, to, reverse=True)) == "+"


def test_transform_reverse_of_the_command_line_is_a_statement_too():
    made = compiled(PLATE + "cut plate outside offset 0.1", transforms=("reverse",))
    assert ways(made) == "-"


@given(st.lists(st.sampled_from(["reverse", "mirror 45", "symmetry x", "rotate 30"]), max_size=5))
def test_every_reverse_turns_the_wire_and_no_reflection_does(stages):
    pipes = "".join(f" | {stage}" for stage in stages)
    turned = "-" if stages.count("reverse") % 2 else "+"
    assert ways(compiled(PLATE + f"cut plate{pipes} outside offset 0.1")) == turned
    assert ways(compiled(HOLE + f"cut hole{pipes} inside offset 0.1")) == turned


def test_a_program_that_runs_clockwise_comes_back_as_it_is():
    from wedmcam.operations.convert import convert

    made = compiled(PLATE + "cut plate | reverse outside offset 0.1 start (15, -3)")
    back = convert(made.data, to="wed", name="x.3b")
    assert back.data is not None, back.findings
    again = compiled(back.data.decode())
    assert again.data == made.data

"""A program by itself: where it fails to close, and what would close it."""

from __future__ import annotations

import re

import lead_forgeries as lf
import numpy as np
import pytest

from wedmcam import api, machines
from wedmcam.diag import Severity

SQUARE = (
    "B0B1000B1000GYL2 B5000B0B5000GXL1 B0B10000B10000GYL2 B10000B0B10000GXL3 B0B10000B10000GYL4 "
)
SQUARE += "B5000B0B5000GXL1 B0B1000B1000GYL4 DD"
HOLE = "B2900B0B2900GXL1 B2900B0B11600GYNR1 B2900B0B2900GXL3 DD"


def told(text, **more):
    """Return (message, hint) of what does not close in a program in text."""
    proof = api.verify("\n".join(text.split()).encode(), name="a.3b", **more)
    assert proof.status == 0
    found = [d for d in proof.findings if d.code == "not-closed"]
    assert all(d.severity is Severity.WARNING for d in found)
    return [(d.message, d.hint) for d in found]


@pytest.mark.parametrize("text", [SQUARE, HOLE, HOLE.replace("DD", "D DD")])
def test_what_closes_is_not_told(text):
    assert told(text) == []


def test_the_block_is_named_and_the_count_length_that_closes_it():
    ((said, hint),) = told(SQUARE.replace("B10000B10000GYL2", "B10000B10010GYL2"))
    assert said == (
        "block 6 should close the contour that begins with block 2, and ends 0.010 mm from its "
        "start (+0.000, +0.010)"
    )
    first = hint.split("; or ")[0]
    assert first == "J 10000 instead of 10010 at block 3"
    assert "J 10010 instead of 10000 at block 5" in hint


@pytest.mark.parametrize(
    ("block", "wrong", "closes"),
    [
        ("B2900B0B11600GYNR1", "B2900B0B11610GYNR1", "J 11600 instead of 11610 at block 2"),
        ("B2900B0B11600GYNR1", "B2900B0B11600GXNR1", "G Y instead of X at block 2"),
        ("B2900B0B11600GYNR1", "B2910B0B11600GYNR1", "X 2900 instead of 2910 at block 2"),
    ],
)
def test_one_value_of_an_arc_closes_it(block, wrong, closes):
    ((said, hint),) = told(HOLE.replace(block, wrong))
    assert said.startswith("block 2 should close the contour that begins with block 2, and ends ")
    assert closes in hint


@pytest.mark.parametrize(("wrong", "gap"), [(1010, "0.010"), (1001, "0.001"), (9000, "8.000")])
@pytest.mark.parametrize("out", [False, True])
def test_a_wrong_lead_displaces_what_follows(wrong, gap, out):
    lines = SQUARE.split()
    k, right = (6, "B0B1000B1000GYL4") if out else (0, "B0B1000B1000GYL2")
    assert lines[k] == right
    lines[k] = right.replace("B1000G", f"B{wrong}G")
    ((said, hint),) = told(" ".join(lines))
    assert said.startswith(
        f"block 7 should lead back to where the wire is threaded for block 1, and ends {gap} mm"
    )
    assert f"J 1000 instead of {wrong} at block {k + 1}" in hint


def test_the_direction_of_counting_of_a_line():
    sloping = SQUARE.replace("B5000B0B5000GXL1", "B5000B100B5000GXL1", 1)
    sloping = sloping.replace("B0B10000B10000GYL2", "B0B9900B9900GYL2", 1)
    assert told(sloping) == []
    ((_, hint),) = told(sloping.replace("B5000B100B5000GXL1", "B5000B100B5000GYL1", 1))
    assert "G X instead of Y at block 2" in hint


def test_a_wrong_quadrant_is_told_as_an_instruction():
    ((_, hint),) = told(SQUARE.replace("B10000B0B10000GXL3", "B10000B0B10000GXL1"))
    assert hint.startswith("L3 instead of L1 at block 4")


def test_every_contour_is_told_and_they_are_capped():
    wrong = HOLE.replace("11600", "11610").replace(" DD", "")
    every = told(" D B9000B0B9000GXL1 D ".join([wrong] * 8) + " DD")
    assert len(every) == 6
    assert every[-1][0] == "and 3 more contours do not close"


def test_what_may_be_open_on_purpose_is_not_told():
    for text in (
        "B5000B0B5000GXL1 B0B3000B3000GYL2 B4000B0B4000GXL1 DD",
        "B5000B0B5000GXL1 B0B3000B3000GYL2 B5000B0B5000GXL3 DD",  # a U: not a way in and out
        "B5000B0B5000GXL1 DD",
    ):
        assert told(text) == []


def test_nothing_closes_what_is_wrong_twice():
    wrong = SQUARE.replace("B10000B10000GYL2", "B10000B10010GYL2")
    ((_, hint),) = told(wrong.replace("B10000B0B10000GXL3", "B10000B0B10007GXL3"))
    assert hint is not None


def test_with_exchanged_axes_the_words_are_those_of_the_file():
    made, found = machines.parse(
        'title = "x"\nformat = "3b"\nline_table = "rotate"\n[axes]\nexchange = true\n'
        "[limits]\ncount_um = 999999\nline_um = 999999\narc_um = 999999\n",
        "x.toml",
    )
    assert made is not None, found
    ((said, hint),) = told(HOLE.replace("11600", "11610"), profile=made)
    assert "block 2" in said
    assert "J 11600 instead of 11610 at block 2" in hint


def test_of_iso_the_block_is_named_and_no_value_is_looked_for():
    text = b"G91\nG01 X1000 Y0\nG01 X0 Y1000\nG01 X-1000 Y0\nG01 X0 Y-990\nM02\n"
    proof = api.verify(text, profile="iso-um", name="a.nc")
    (d,) = [d for d in proof.findings if d.code == "not-closed"]
    assert "block 4 should close" in d.message
    assert d.hint is None


@pytest.mark.parametrize("to", ["3b", "compact"])
def test_any_wrong_count_is_found_again(to):
    """Each J of a program is made longer: the right one is among the answers."""
    made = api.compile(lf.plate(), offset=0.05, lead=0.15, to=to)
    from wedmcam.formats.quadrants import quadrant
    from wedmcam.judge.closing import closing_changes, open_contours
    from wedmcam.judge.walk import walk

    program, stepping = made.program, made.machine.own_stepping
    rng = np.random.default_rng(1)
    cutting = np.flatnonzero(program.blocks["kind"] <= 1)
    found = 0
    for row in cutting.tolist():
        blocks = program.blocks.copy()
        blocks["count"][row] += int(rng.choice([1, 7, 100]))
        way = walk(type(program)(blocks, program.origin), stepping)
        if (way.steps < 0).any():
            continue
        ones = list(open_contours(way))
        if len(ones) != 1:
            continue  # a lead
        texts = [c.text for c in closing_changes(way, ones[0], quadrant)]
        right = rf"J {program.blocks['count'][row]} instead of \d+ at block {row + 1}"
        assert any(re.fullmatch(right, text) for text in texts), (row, texts)
        found += 1
    assert found >= 8

"""A path that becomes an outline and a gap: nested contours alternate, as in a drawing."""

from types import SimpleNamespace

import numpy as np
import pytest

import parts
from wedmcam import api
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.difference import difference
from wedmcam.operations import convert
from wedmcam.options import WrongUse
from wedmcam.targets import Entries

# Paths of the wire: a hole of R 1.9 within a rounded square, and within nothing.
HOLE = "B900B0B900GXL1\nB1900B0B7600GYNR1\nB900B0B900GXL3\n"
SQUARE = """B0B1000B1000GYL2
B3000B0B3000GXL1
B0B2000B2000GYNR4
B0B6000B6000GYL2
B2000B0B2000GXNR1
B6000B0B6000GXL3
B0B2000B2000GYNR2
B0B6000B6000GYL4
B2000B0B2000GXNR3
B3000B0B3000GXL1
B0B1000B1000GYL4
"""

#: Scaling rounds every arc and J; a compile to these formats is as far off (4.5 um).
WITHIN_UM = 5.0


def outlined(path, to="4b", gap=50, outwards=True):
    entered = Entries(gap_um=gap, outwards=outwards)
    return convert.convert(path.encode(), to=to, name="a.3b", entered=entered)


def arcs(made):
    return [r.split("G")[0].split("B")[-1] for r in made.data.decode().split() if "R" in r]


@pytest.mark.parametrize(
    ("outwards", "hole", "corner"), [(True, "1950DD", "1950D"), (False, "1850DD", "2050D")]
)
def test_a_hole_in_an_outline(outwards, hole, corner):
    made = outlined(f"{HOLE}D\nB0B6000B6000GYL4\nD\n{SQUARE}DD\n", outwards=outwards)
    assert made.ok, [d.message for d in made.findings]
    assert arcs(made) == [hole] + [corner] * 4


def test_a_contour_alone_is_an_outer_one():
    assert arcs(outlined(HOLE + "DD\n")) == ["1850D"]
    assert arcs(outlined(HOLE + "DD\n", outwards=False)) == ["1950D"]


def drawn(seed):
    """A rounded outline with a rounded slot and a round hole, um."""
    rng = np.random.default_rng(seed)
    w, h = rng.uniform(20_000, 40_000, 2)
    box = np.array([(0, 0), (w, 0), (w, h), (0, h)])
    outer = parts.contour_of_bulges(*parts.rounded(box, rng.uniform(600, 3000, 4)))
    hole = parts.circle(0.25 * w, 0.5 * h, rng.uniform(1000, 3000))
    slot = parts.slot(0.7 * w, 0.5 * h, rng.uniform(1000, 4000), rng.uniform(1500, 3000), 0.5)
    return parts.dxf_bytes((outer, hole, slot))


def contours(program):
    """The blocks of each cut without its leads, as programs."""
    blocks = program.blocks
    cut = blocks["kind"] < Kind.MOVE
    first = np.flatnonzero(cut & ~np.concatenate([[False], cut[:-1]]))
    last = np.flatnonzero(cut & ~np.concatenate([cut[1:], [False]]))
    return [Program(blocks[a + 1 : b].copy()) for a, b in zip(first, last, strict=True)]


@pytest.mark.parametrize("to", ["4b"])
@pytest.mark.parametrize("side", ["part", "die"])
def test_the_outline_is_right_for_any_gap(to, side):
    """With the gap the path comes back; with another it is what a compile at that offset makes.

    Leads are lines, which a gap does not change: contours are compared each from its start.
    """
    for seed in range(4):
        drawing = drawn(seed)
        path = api.compile(drawing, to="3b", offset=0.1, side=side)
        at = Entries(gap_um=100, outwards=side == "part")
        made = convert.convert(path.data, to=to, name="a.3b", entered=at)
        assert made.ok, [d.message for d in made.findings]
        back = convert.convert(made.data, to="3b", format=to, entered=at)
        assert back.ok
        for other in (60, 140):
            entered = Entries(gap_um=other, outwards=at.outwards)
            read, machine, _ = api.read_program(made.data, format=to, entered=entered)
            right = api.compile(drawing, to="3b", offset=other / 1000, side=side)
            tables = machine.stepping, right.machine.stepping
            pairs = list(zip(contours(read), contours(right.program), strict=True))
            assert len(pairs) == 3
            apart = [difference(a, b, *tables, 100.0).largest_um for a, b in pairs]
            assert max(apart) <= WITHIN_UM, apart


def test_compile_and_convert_state_the_same():
    drawing = drawn(7)
    for side in ("part", "die"):
        path = api.compile(drawing, to="3b", offset=0.1, side=side)
        made = outlined(path.data.decode(), gap=100, outwards=side == "part")
        direct = api.compile(drawing, to="4b", offset=0.1, side=side)
        assert arcs(made) == arcs(direct)


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("B0B2000B2000GYNR4\n", "does not close"),
        # Two squares, one across the other.
        (f"{SQUARE}D\nB2100B2000B2100GXL1\nD\n{SQUARE}", "cross"),
        # The same hole once more, and 60 um larger.
        (f"{HOLE}D\n{HOLE}", "on top"),
        (f"{HOLE}D\nB960B0B960GXL1\nB1960B0B7840GYNR1\nB960B0B960GXL3\n", "two gaps"),
        ("B900B0B900GXL1\nB1900B0B7600GYNR1\nB1900B0B7600GYNR1\nB900B0B900GXL3\n", "once more"),
    ],
)
def test_where_it_cannot_be_told_it_is_refused(path, why):
    made = outlined(f"{path}DD\n")
    assert made.data is None
    assert made.status == 1
    assert any(why in d.message for d in made.findings), [d.message for d in made.findings]
    assert not made.findings[-1].hint or "compile the drawing" in made.findings[-1].hint
    assert outlined(f"{path}DD\n", gap=0).ok


def test_an_outline_stays_the_outline_it_was():
    """4B to compensation data and back: D and DD stay, also where no path would tell them."""
    rings = "B4000B0B16000B4000DDGYNR1\nD\nB9000B0B9000GXL1\nD\nB4000B0B16000B4000DGYNR1\nDD\n"
    for text in (rings, rings.replace("DDG", "DXG").replace("DG", "DDG").replace("DXG", "DG")):
        made = convert.convert(text.encode(), to="compensation", name="a.4b")
        assert made.ok, [d.message for d in made.findings]
        assert not made.findings
        back = convert.convert(made.data, to="4b", name="a.zdc")
        assert back.ok
        assert arcs(back) == arcs(SimpleNamespace(data=text.encode()))


def test_without_a_gap_a_hole_is_a_hole_all_the_same():
    made = convert.convert(
        f"{HOLE}D\nB0B6000B6000GYL4\nD\n{SQUARE}DD\n".encode(), to="4b", name="a.3b"
    )
    assert arcs(made) == ["1900DD"] + ["2000D"] * 4
    assert [d.code for d in made.findings] == ["no-gap"]


RING = b"B9900B0B39600B9900DGYNR1\nDD\n"


@pytest.mark.parametrize("to", ["3b", "compact", "iso", "dxf", "wed", "rotation"])
def test_an_outline_without_its_gap_is_no_path(to):
    made = convert.convert(RING, to=to, name="a.4b")
    assert made.data is None
    assert [d.code for d in made.findings] == ["no-gap"]
    assert "--gap" in made.findings[0].hint
    meant = convert.convert(RING, to=to, name="a.4b", entered=Entries(gap_um=0))
    assert meant.ok
    assert "no-gap" not in [d.code for d in meant.findings]


def test_an_outline_that_is_only_looked_at_is_named_one():
    for data, name in ((RING, "a.4b"), (convert.convert(RING, to="compensation").data, "a.zdc")):
        assert convert.convert(data, to="svg", name=name).ok
        assert [d.code for d in api.read_program(data, name=name)[2]] == ["no-gap"]
        assert [d.code for d in api.verify(data, name=name).findings] == ["no-gap"]
    assert not api.read_program(b"B9B0B9B0GXL1\nDD\n", name="a.4b")[2]


def test_verify_asks_for_the_gap():
    drawing = drawn(1)
    made = api.compile(drawing, to="4b", offset=0.1)
    proof = api.verify(made.data, against=drawing, name="a.4b", against_name="a.dxf")
    assert not proof.ok
    assert "no-gap" in [d.code for d in proof.findings]
    asked = {"against": drawing, "name": "a.4b", "against_name": "a.dxf"}
    assert api.verify(made.data, offset=0.1, **asked).ok
    outline = api.compile(drawing, to="4b", side="on")
    assert api.verify(outline.data, side="on", **asked).ok


PART = b"""contour plate { from (0, 0) line to (30, 0) fillet 3 line to (30, 20) fillet 3
  line to (0, 20) fillet 3 close fillet 3 }
contour hole { circle center (15, 10) radius 4 }
contour hook { from (40, 0) line to (50, 0) arc ccw to (50, 10) center (50, 5) line to (40, 10) }
cut hole inside%s start (15, 12)
cut plate outside%s start (-2, 10)
"""


@pytest.mark.parametrize("to", ["4b", "compensation"])
def test_a_part_program_whose_cuts_have_one_offset(to):
    own = api.compile(PART % (b" offset 0.1", b" offset 0.1"), to=to, name="a.wed")
    assert own.ok, [d.message for d in own.findings]
    asked = api.compile(PART % (b"", b""), to=to, name="a.wed", offset=0.1)
    assert own.data == asked.data
    name = {"4b": "x.4b", "compensation": "x.zdc"}[to]
    against = PART % (b" offset 0.1", b" offset 0.1")
    assert api.verify(own.data, against=against, name=name, against_name="a.wed").ok
    other = PART % (b" offset 0.11", b" offset 0.11")
    # An outline with its corners is right for any gap; 4B states arcs that are scaled for one.
    assert api.verify(own.data, against=other, name=name, against_name="a.wed").ok == (to != "4b")


def test_cuts_with_different_offsets_are_refused_with_both():
    with pytest.raises(WrongUse, match=r"0.1 mm at .*, 0.12 mm at "):
        api.compile(PART % (b" offset 0.12", b" offset 0.1"), to="4b", name="a.wed")
    with pytest.raises(WrongUse, match=r"0 mm at .*, 0.1 mm at "):
        api.compile(
            PART % (b" offset 0.1", b" offset 0.1") + b"cut hook on\n", to="4b", name="a.wed"
        )


def test_open_cuts_on_either_side_state_their_own_sense():
    for side, letter in (("left", "DD"), ("right", "D")):
        text = PART % (b" offset 0.1", b" offset 0.1")
        text += f"cut hook {side} offset 0.1\n".encode()
        made = api.compile(text, to="4b", name="a.wed")
        assert made.ok, [d.message for d in made.findings]
        assert arcs(made)[-1] == f"5000{letter}"

"""4B: what is read of it, what a controller makes of it, and that forgeries are refused."""

import re
from pathlib import Path

import numpy as np
import pytest

from wedmcam import api, machines
from wedmcam.backends import encoder
from wedmcam.diag import Severity
from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.ir.program import Axis, Kind
from wedmcam.operations import convert
from wedmcam.targets import Entries

M = machines.builtin("b4-compact")
SAMPLES = Path(__file__).parents[2] / "samples"
# A rounded square: lines of 6 mm, corners of 2 mm; it starts on its lower side, counter-clockwise.
ROUND = """B3000B0B3000B0GXL1
B0B2000B2000B2000DGYNR4
B0B6000B6000B0GYL2
B2000B0B2000B2000DGXNR1
B6000B0B6000B0GXL3
B0B2000B2000B2000DGYNR2
B0B6000B6000B0GYL4
B2000B0B2000B2000DGXNR3
B3000B0B3000B0GXL1
DD
"""


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


def read(text, gap=0, outwards=True, machine=M):
    return decoder("4b")(text.encode(), machine, "a.4b", gap_um=gap, outwards=outwards)


def test_records():
    program, found = read(ROUND)
    assert not found
    assert program.blocks["kind"].tolist()[-1] == Kind.STOP
    seen = identify(ROUND.encode())
    assert (seen.format, seen.blocks, seen.certain) == ("4b", 9, True)
    assert seen.reason == "4B text: 9 records; the controller offsets arcs by a gap"
    assert [span.line for span in program.spans] == list(range(1, 11))


@pytest.mark.parametrize(
    ("gap", "outwards", "radius"), [(0, True, 2000), (100, True, 2100), (100, False, 1900)]
)
def test_arcs_are_scaled_and_counted_on_their_axis(gap, outwards, radius):
    program, found = read(ROUND, gap, outwards)
    assert not found
    arcs = program.blocks[program.blocks["kind"] == Kind.ARC]
    assert (arcs["count"] == radius).all()
    assert arcs["axis"].tolist() == [Axis.Y, Axis.X] * 2
    ends = api.positions(program, M)[1]
    assert ends[-1].tolist() == [0, 0]
    if gap:  # lines stay, so the start of the outline moves by the gap and nothing else does
        lines = program.blocks[program.blocks["kind"] == Kind.LINE]
        assert lines["count"].tolist() == [3000, 6000, 6000, 6000, 3000]


@pytest.mark.parametrize(
    "text",
    [
        ROUND.replace("\n", ""),
        ROUND.replace("B", " B "),
        ROUND.replace("DG", " D G ").replace("GXL", "G X L "),
        "".join(f"N{n}: {row}\r\n" for n, row in enumerate(ROUND.splitlines(), 1)),
        ROUND.replace("B0G", "BG"),
        re.sub("B0(G[XY]L)", r"\1", ROUND),  # lines as 3B
        ROUND.lower(),
        "; a part\n" + ROUND,
    ],
)
def test_any_layout(text):
    program, found = read(text)
    assert not errors(found)
    assert (program.blocks == read(ROUND)[0].blocks).all()
    assert identify(text.encode()).format in ("4b", "3b")


@pytest.mark.parametrize(
    ("text", "gap", "code", "line"),
    [
        (ROUND.replace("B2000DGXNR1", "B2000GXNR1"), 100, "bad-type", 4),
        (ROUND.replace("B2000DGXNR1", "BDGXNR1"), 100, "bad-type", 4),
        (ROUND.replace("B2000DGXNR1", "GXNR1"), 100, "bad-type", 4),
        (ROUND.replace("B2000DGXNR1", "B50DDGXNR1"), 100, "gap-value", 4),
        (ROUND, 0.5, "gap-value", 1),
        (ROUND, -1, "gap-value", 1),
        (ROUND, 100_000, "gap-value", 1),
        (ROUND.replace("B0B6000B6000B0GYL2", "B6000B0B6000B0GXL1"), 100, "not-tangent", 2),
        ("B5B0B0B0GXL1\nDD\n", 0, "zero-count", 1),
        ("B1B2B3B4B5GXL1\nDD\n", 0, "bad-record", 1),
    ],
)
def test_what_is_refused(text, gap, code, line):
    _, found = read(text, gap)
    assert code in errors(found)
    assert next(d for d in found if d.code == code).span.line == line


def test_a_radius_that_contradicts_is_told():
    _, found = read(ROUND.replace("B2000DGXNR1", "B2500DGXNR1"))
    assert [d.code for d in found] == ["radius-contradicts"]


def test_3b_points_to_4b():
    _, found = decoder("3b")(ROUND.encode(), machines.default("3b"), "a.3b")
    bad = next(d for d in found if d.code == "unsupported-4b")
    assert "--format 4b" in bad.hint


def test_round_trip():
    """What is written is read as it was, whatever the gap: the law of formats."""
    for name, options in (("plate", {}), ("cam", {"side": "die"}), ("bracket-inch", {})):
        made = api.compile(
            SAMPLES / f"{name}.dxf", to="3b", offset=0.1, corner=0.3, ignore_layers=["START"],
            **options,
        )  # fmt: skip
        entered = Entries(gap_um=100, outwards=options.get("side") != "die")
        outline = convert.convert(made.data, to="4b", name="a.3b", entered=entered)
        assert outline.ok, [d.message for d in outline.findings]
        back = convert.convert(outline.data, to="3b", name="a.4b", entered=entered)
        assert back.ok
        assert back.difference.largest_um <= 1.0
        plain, _ = decoder("4b")(outline.data, M, "a.4b")
        again, found = encoder("4b")(plain, M)
        assert not errors(found)
        assert (decoder("4b")(again, M, "a.4b")[0].blocks == plain.blocks).all()


def test_arcs_come_out_as_those_that_were_proven():
    made = api.compile(SAMPLES / "plate.dxf", to="4b", offset=0.1, ignore_layers=["START"])
    assert made.ok
    low, program = made.lowered.blocks, made.program.blocks
    arcs = low["kind"] == Kind.ARC
    same = np.ones(len(low), bool)
    for key in ("x", "y", "count", "axis"):
        same &= low[key] == program[key]
    assert same[arcs].mean() > 0.9


def test_corners_are_refused_in_the_drawing():
    made = api.compile(SAMPLES / "stator-36.dxf", to="4b", offset=0.1)
    assert "not-tangent" in {d.code for d in made.findings}
    assert "--to 3b" in next(d.hint for d in made.findings if d.code == "not-tangent")


def verified(data, **more):
    more = {"offset": 0.1, "corner": 0.3, "ignore_layers": ["START"], **more}
    return api.verify(data, against=SAMPLES / "plate.dxf", name="x.4b", **more)


def test_forgeries():
    made = api.compile(
        SAMPLES / "plate.dxf", to="4b", offset=0.1, corner=0.3, ignore_layers=["START"]
    )
    text = made.data.decode()
    assert verified(made.data).ok
    swapped = re.sub(r"(D+)G", lambda m: {"D": "DD", "DD": "D"}[m[1]] + "G", text)
    first = re.search(r"B(\d+)B(\d+)B(\d+)B(\d+)(DD?)G", text)
    x, y, j, r, d = first.groups()
    forged = {
        "types": swapped,
        "one type": text.replace(first[0], f"B{x}B{y}B{j}B{r}{'D' if d == 'DD' else 'DD'}G", 1),
        "no type": text.replace(first[0], f"B{x}B{y}B{j}B{r}G", 1),
        "no radius": text.replace(first[0], f"B{x}B{y}B{j}B{d}G", 1),
        "radius": text.replace(first[0], f"B{x}B{y}B{j}B{int(r) // 2}{d}G", 1),
        "J": text.replace(first[0], f"B{x}B{y}B{int(j) + 10}B{r}{d}G", 1),
        "X": text.replace(first[0], f"B{int(x) + 10}B{y}B{j}B{r}{d}G", 1),
        "as 3B": re.sub(r"B\d+D*G", "G", text),
    }
    for name, data in forged.items():
        assert data != text
        assert not verified(data.encode()).ok, name
    assert not verified(made.data, offset=0.11).ok
    assert not verified(made.data, side="die").ok


def test_what_arcs_state_is_dumped():
    from wedmcam.frontends import describe_blocks

    assert describe_blocks(ROUND.encode(), M)["2:1"] == "R 2.000 mm, grows outwards"

"""The map from blocks to what was drawn, held against the entities of the drawing themselves."""

import hashlib
import io
import json
import math
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from drawings import drawing
from wedmcam import api, machines
from wedmcam.cli import outputs
from wedmcam.diag import EntityRef, TextSpan
from wedmcam.ir.program import Kind
from wedmcam.options import Options
from wedmcam.reports.source_map import source_map, span_data
from wedmcam.transforms.figures.motion import numbered

SAMPLES = Path(__file__).parents[2] / "samples"


def mapped(data, to="3b", **options):
    made = api.compile(data, to=to, name="part.dxf", output_name="part.out", **options)
    assert made.ok, [str(f) for f in made.findings]
    return made, api.source_map(made)


def entity(data, source):
    """Return the world-coordinate entity that a handle with its chain names, by ezdxf alone."""
    doc = ezdxf.read(io.StringIO(data.decode()))
    chain = [*source["via"], source["handle"]]
    here = doc.entitydb[chain[0]]
    assert here.dxf.owner == doc.modelspace().layout_key
    matrices = []
    for handle in chain[1:]:
        matrices.append(here.matrix44())
        block = doc.blocks.get(here.dxf.name)
        here = next(e for e in block if e.dxf.handle == handle)
    copy = here.copy()
    for m in reversed(matrices):
        copy.transform(m)
    assert here.dxf.layer == source["layer"]
    assert here.dxftype() == source["type"]
    return copy


def distance_mm(e, x, y):
    """Return how far a point is from a LINE, ARC or CIRCLE."""
    if e.dxftype() == "LINE":
        a, b = np.array(e.dxf.start)[:2], np.array(e.dxf.end)[:2]
        t = np.clip(np.dot((x, y) - a, b - a) / np.dot(b - a, b - a), 0, 1)
        return math.dist((x, y), a + t * (b - a))
    centre = np.array(e.ocs().to_wcs(e.dxf.center))[:2]  # mirrored: seen from below
    return abs(math.dist((x, y), centre) - e.dxf.radius)


def nested(doc, msp):
    """A plate whose holes come from a block in a block: turned, mirrored, in an array."""
    hole = doc.blocks.new("HOLE")
    hole.add_circle((0, 0), 2, dxfattribs={"layer": "HOLES"})
    slot = doc.blocks.new("SLOT")
    slot.add_line((-3, -1), (3, -1))
    slot.add_arc((3, 0), 1, -90, 90)
    slot.add_line((3, 1), (-3, 1))
    slot.add_arc((-3, 0), 1, 90, -90)
    pair = doc.blocks.new("PAIR")
    pair.add_blockref("HOLE", (0, 0))
    pair.add_blockref("SLOT", (8, 3), dxfattribs={"rotation": 30})
    corners = [(0, 0), (80, 0), (80, 50), (0, 50)]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        msp.add_line(a, b)
    msp.add_blockref("PAIR", (15, 15))
    msp.add_blockref("PAIR", (60, 15), dxfattribs={"rotation": 100})
    msp.add_blockref("PAIR", (30, 35), dxfattribs={"xscale": -1})
    msp.add_blockref(
        "HOLE", (45, 36), dxfattribs={"column_count": 2, "column_spacing": 10, "row_count": 1}
    )


@pytest.mark.parametrize("to", ["3b", "compact", "rotation"])
@pytest.mark.parametrize("offset", [0.1, None])
def test_blocks_lead_to_the_entities_they_run_along(to, offset):
    data = drawing(nested)
    _, told = mapped(data, to, offset=offset, overcut=0.5)
    seen = set()
    for row in told["blocks"]:
        source = row["source"]
        if row["role"] in ("contour", "overcut"):
            seen.add((*source["via"], source["handle"]))
            e = entity(data, source)
            array = len(source["via"]) == 1 and source["type"] == "CIRCLE"
            for x, y in (row["start_um"], row["end_um"]):
                x -= 10_000 * (array and x > 50_000)  # both places of the array are one INSERT
                # On a transition arc too: its block runs about the end of the segment before it.
                assert distance_mm(e, x / 1000, y / 1000) <= (offset or 0) + 0.0021, row
            assert source["copies"] == []
        elif row["role"] in ("lead-in", "lead-out"):
            assert source is not None
        else:
            assert source is None
    assert len(seen) == 4 + 3 * 5 + 1  # the array is one INSERT
    assert {len(chain) for chain in seen} == {1, 2, 3}


def test_the_map_is_of_the_file_and_goes_from_end_to_end():
    made, told = mapped(SAMPLES.joinpath("plate.dxf").read_bytes(), offset=0.1, stop=1, overcut=0.2)
    assert told["sha256"]["output"] == hashlib.sha256(made.data).hexdigest()
    assert told["sha256"]["input"] == made.summary["sha256"]["input"]
    assert [r["block"] for r in told["blocks"]] == list(range(1, len(made.program.blocks) + 1))
    for a, b in zip(told["blocks"], told["blocks"][1:], strict=False):
        assert a["end_um"] == b["start_um"]
    assert told["blocks"][0]["start_um"] == told["origin_um"] == list(made.program.origin)
    assert {r["role"] for r in told["blocks"]} == {
        *("lead-in", "lead-out", "contour", "overcut", "move", "control")
    }
    lines = made.data.decode().splitlines()
    for row in told["blocks"]:
        line, column = map(int, row["where"].split(":"))
        assert column == 1
        assert lines[line - 1].startswith("B") == (row["role"] != "control")
    assert json.loads(outputs.map_bytes(told)) == told


def test_copies_are_numbered():
    """A segment of 10 degrees about the middle, 35 more times: the whole outline."""

    def tooth(_, msp):
        def at(r, degrees):
            a = math.radians(degrees)
            return (r * math.cos(a), r * math.sin(a))

        msp.add_line(at(20, 0), at(22, 3))
        msp.add_line(at(22, 3), at(22, 6))
        msp.add_line(at(22, 6), at(20, 10))

    data = drawing(tooth)
    _, told = mapped(data, offset=0.05, transforms=["rotate 10 copies 35"])
    handles = [r["source"]["handle"] for r in told["blocks"] if r["role"] == "contour"]
    assert len(set(handles)) == 3
    by_copy = {}
    for row in told["blocks"]:
        if row["role"] != "contour":
            continue
        (copy,) = row["source"]["copies"] or (0,)
        by_copy.setdefault(copy, []).append(row)
        e = entity(data, {**row["source"], "copies": []})
        e.rotate_z(math.radians(10 * copy))
        for x, y in (row["start_um"], row["end_um"]):
            assert distance_mm(e, x / 1000, y / 1000) <= 0.0521
    assert set(by_copy) == set(range(36))


def test_a_controller_that_makes_its_own_blocks_is_followed_by_geometry():
    def rounded(_, msp):
        msp.add_line((0, 2), (0, 18))
        msp.add_arc((2, 18), 2, 90, 180)
        msp.add_line((2, 20), (28, 20))
        msp.add_arc((28, 18), 2, 0, 90)
        msp.add_line((30, 18), (30, 2))
        msp.add_arc((28, 2), 2, 270, 360)
        msp.add_line((28, 0), (2, 0))
        msp.add_arc((2, 2), 2, 180, 270)

    data = drawing(rounded)
    _, told = mapped(data, "compensation", offset=0.1)
    rows = [r for r in told["blocks"] if r["role"] in ("contour", "overcut")]
    assert len({r["source"]["handle"] for r in rows}) == 8
    for row in rows:
        e = entity(data, row["source"])
        assert (row["kind"] == "arc") == (e.dxftype() == "ARC")
    assert next(r["role"] for r in told["blocks"] if r["kind"] == "line") == "lead-in"


def test_merged_and_split_blocks_are_found_by_geometry():
    """The judge of the fallback: where every block is known, it finds the same."""
    made, told = mapped(SAMPLES.joinpath("stator-36.dxf").read_bytes(), offset=0.1, overcut=0.3)
    blocks = made.lowered.blocks.copy()
    arcs = np.flatnonzero(blocks["kind"] == Kind.ARC)
    lines = np.flatnonzero((blocks["kind"] == Kind.LINE) & (abs(blocks["x"]) > 3000))
    assert len(arcs)
    assert len(lines)
    # Halve a line in the file: counts differ, so blocks are matched by where they run.
    k = int(lines[0])
    half = blocks[[k, k]].copy()
    half["x"] = [blocks["x"][k] // 2, blocks["x"][k] - blocks["x"][k] // 2]
    half["y"] = [blocks["y"][k] // 2, blocks["y"][k] - blocks["y"][k] // 2]
    for n in range(2):
        half["count"][n] = max(abs(half["x"][n]), abs(half["y"][n]))
    cut = np.concatenate([blocks[:k], half, blocks[k + 1 :]])
    other = type(made.program)(cut, made.program.origin)
    again = source_map(made.lowered, other, machines.builtin("b3-compact"), summary=made.summary)[
        "blocks"
    ]
    want = [(r["role"], r["source"]) for r in told["blocks"]]
    got = [(r["role"], r["source"]) for r in again]
    assert got == [*want[: k + 1], *want[k:]]


def test_copies_of_text_and_entities():
    text = TextSpan("a.wed", 3, 5)
    twice = numbered(numbered((text,), 2), 7)
    assert span_data(twice[0]) == {
        "file": "a.wed",
        "line": 3,
        "column": 5,
        "length": 1,
        "copies": [7, 2],
    }
    ref = EntityRef("a.dxf", "2F", "ARC", "CUT", ("1A",))
    data = span_data(numbered(numbered((ref,), 2), 7)[0])
    assert (data["copies"], data["via"]) == ([7, 2], ["1A"])


def test_a_map_needs_a_proof():
    with pytest.raises(Exception, match="proven"):
        api.source_map(api.compile(b"no drawing", options=Options()))

"""Published programs come out of the compiler byte for byte, from drawings of what they cut."""

import pytest

import parts
import wedmcam
from wedmcam import api, machines
from wedmcam.controllers.pointwise import LineTable, run
from wedmcam.frontends.b3.reader import decode


@pytest.mark.parametrize("count", ["exact", "textbook"])
def test_hole_program(count):
    """2-3b.md: a hole of radius 10 mm, offset 0.1 mm inside, from and back to the centre."""
    drawing = parts.dxf_bytes((parts.circle(0, 0, 10_000),))
    made = wedmcam.compile(drawing, offset=0.1, side="die", count=count)
    assert made.ok
    assert made.data == b"B9900B0B9900GXL1\nB9900B0B39600GYNR1\nB9900B0B9900GXL3\nDD\n"
    assert made.verdict.closure_um == 0


@pytest.mark.parametrize(
    ("text", "end"),
    [
        ("BBB50000GYL2", (0, 50_000)),
        ("B17000B5000B17000GXL1", (17_000, 5_000)),
        ("B17B5B17000GXL1", (17_000, 5_000)),
        ("B2000B9000B25440GYNR2", (9_000 + 2_000, -2_000 - 9_000)),
        ("B9000B2000B25440GXSR4", (-2_000 - 9_000, 9_000 + 2_000)),
    ],
)
def test_known_records_end_where_published(text, end):
    program, found = decode(text.encode(), machines.default("3b"), "known.3b")
    motion = run(program.blocks, LineTable.ROTATE)
    assert (int(motion.dx.sum()), int(motion.dy.sum())) == end
    assert not [d for d in found if d.severity == 2]


def test_circle_drawn_as_two_halves_is_one_block():
    halves = parts.contour_of_bulges(
        __import__("numpy").array([[10_000.0, 0.0], [-10_000.0, 0.0]]),
        __import__("numpy").array([1.0, 1.0]),
    )
    made = wedmcam.compile(parts.dxf_bytes((halves,)), offset=0.1, side="die")
    assert made.ok
    assert made.data.splitlines()[1] == b"B9900B0B39600GYNR1"


def test_compact_of_the_hole():
    drawing = parts.dxf_bytes((parts.circle(0, 0, 10_000),))
    made = wedmcam.compile(drawing, to="compact", offset=0.1, side="die")
    assert made.ok
    # L1 9900, NR1 about the centre with J on the inscribed square, L3 9900, end.
    line_in, arc, line_out, end = made.data[:7], made.data[7:19], made.data[19:26], made.data[26:]
    assert line_in.hex() == "01009900000000"
    assert arc.hex()[:18] == "210000990000000000"
    assert line_out.hex() == "03009900000000"
    assert end == b"\x00"
    assert abs(int(arc.hex()[18:]) - 4 * 2**0.5 * 9900) < 4


def test_summary_has_the_shared_fields():
    made = wedmcam.compile(parts.dxf_bytes((parts.circle(0, 0, 10_000),)), offset=0.1)
    fields = (
        "input output format units origin_um contours blocks steps closure_um max_deviation_um "
        "gouge_um offset_um side diagnostics ok"
    )
    assert set(fields.split()) <= set(made.summary)
    refused = wedmcam.compile(b"nonsense", offset=0.1)
    assert not refused.ok
    assert refused.status == 1
    assert set(fields.split()) <= set(refused.summary)


def test_api_is_what_the_package_offers():
    assert wedmcam.compile is api.compile
    assert wedmcam.verify is api.verify

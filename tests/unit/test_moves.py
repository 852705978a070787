"""Moves between cuts: what helps where one is longer than a block."""

import pytest

import parts
import wedmcam
from wedmcam.diag import Severity

FRAME = parts.rectangle(1_220_000, 60_000)
HOLES = parts.circle(15_000, 30_000, 5000), parts.circle(1_205_000, 30_000, 5000)


@pytest.mark.parametrize("profile", [None, "iso-um"])
def test_field_long_move(profile):
    """The holes come before the outline, so no order leads over its thread point."""
    made = wedmcam.compile(parts.dxf_bytes((FRAME, *HOLES)), profile=profile, offset=0.05)
    (error,) = [d for d in made.findings if d.severity is Severity.ERROR]
    assert error.code == "move-too-long"
    assert error.hint.startswith("no --order helps")


def test_a_rapid_move_has_no_limit():
    assert wedmcam.compile(parts.dxf_bytes((FRAME, *HOLES)), profile="iso-mm", offset=0.05).ok


def test_another_order_may_help_where_contours_are_in_reach():
    row = [parts.circle(x, 0, 5000) for x in (0, 1_600_000, 800_000)]
    made = wedmcam.compile(parts.dxf_bytes(row), offset=0.05, order="given")
    hints = [d.hint for d in made.findings if d.code == "move-too-long"]
    assert made.ok or all(h.startswith("another --order may help") for h in hints)


def test_field_square_tie():
    """The tie of two start points falls otherwise in the other arithmetic; the path is the same."""
    square = parts.contour_of_bulges(
        [(0, 5566.013), (5566.013, 0), (11132.026, 5566.013), (5566.013, 11132.026)], [0] * 4
    )
    drawing = parts.dxf_bytes((square,))
    made = wedmcam.compile(drawing, offset=0.05)
    assert wedmcam.arithmetic_difference(made, drawing) < 0.01

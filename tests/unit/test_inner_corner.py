"""What counts as one sharp inner corner (cut with the wire's radius) and what as interference."""

import numpy as np
import pytest

import parts
from wedmcam.transforms.compensate import compensate


def kinds(points, offset=100.0):
    contour = parts.contour_of_bulges(np.array(points, float), np.zeros(len(points)))
    made, found = compensate([contour], [-offset])  # counter-clockwise, wire outside
    assert not found
    return [i.kind for i in made.interference]


BASE = [(0, 0), (10_000, 0), (10_000, 5_000)]
TOP = [(0, 5_000)]


@pytest.mark.parametrize(
    ("notch", "expected"),
    [
        ([(6_000, 5_000), (6_000, 4_000), (5_000, 4_000), (5_000, 5_000)], []),  # wide groove
        ([(6_000, 4_960), (3_000, 4_960), (3_000, 5_000)], []),  # a leg of 40 um: one corner
        ([(6_000, 5_000), (5_950, 4_800), (5_900, 5_000)], ["passage"]),  # V notch, 100 um wide
        ([(6_000, 5_000), (6_000, 4_000), (5_850, 4_000), (5_850, 5_000)], ["passage"]),  # slot
        (
            [(6_000, 5_000), (6_000, 4_050), (5_970, 4_000), (4_000, 4_000), (4_000, 5_000)],
            ["passage"],
        ),
    ],
    ids=["groove", "short leg", "notch", "slot", "chamfer"],
)
def test_corner_or_interference(notch, expected):
    assert kinds([*BASE, *notch, *TOP]) == expected

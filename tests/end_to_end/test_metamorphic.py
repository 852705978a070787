"""Images of a part: all agree, and a fault of one quadrant does not hide."""

from __future__ import annotations

from pathlib import Path

import pytest

import wedmcam.transforms.lower as lowering
from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.operations.images import ISOMETRIES, metamorphic

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.parametrize("to", ["3b", "compact"])
@pytest.mark.parametrize("name", ["key-punch", "bracket-inch"])
def test_images_of_samples_agree(name, to):
    images, found = metamorphic(
        (SAMPLES / f"{name}.dxf").read_bytes(),
        name,
        api.machine_for(to, None),
        api.options_in_mm(offset=0.1),
    )
    assert not found
    assert len(images) == len(ISOMETRIES) + 2
    assert all(i.ok and i.deviation_um <= 2.0 and not i.why for i in images)


def test_a_fault_of_one_quadrant_shows(monkeypatch):
    """A back end that mirrors steep lines to the upper left: the first part has none."""
    right = lowering.lower

    def lower(plan, rules):
        program, found = right(plan, rules)
        blocks = program.blocks.copy()
        wrong = (blocks["kind"] == 0) & (blocks["x"] < 0) & (blocks["y"] == 0)
        blocks["x"][wrong] *= -1
        return type(program)(blocks, program.origin, program.sources, (), program.words), found

    monkeypatch.setattr(lowering, "lower", lower)
    images, found = metamorphic(
        (SAMPLES / "key-punch.dxf").read_bytes(),
        "key-punch",
        api.machine_for("3b", None),
        api.options_in_mm(offset=0.1),
    )
    assert not all(i.ok for i in images)
    assert {d.code for d in found} == {"not-an-image"}
    assert all(d.severity is Severity.ERROR for d in found)


def test_a_drawing_that_is_refused_has_no_image():
    images, found = metamorphic(
        b"no drawing", "x", api.machine_for("3b", None), api.options_in_mm(offset=0.1)
    )
    assert not images
    assert found

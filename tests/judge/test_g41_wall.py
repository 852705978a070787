"""The path that a G41 program is held to is not made by what makes programs.

Arcs about corners are broken in the compiler's own kernel. What was made by it must be refused,
and what the controller makes of a program must not change.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wedmcam import api
from wedmcam.geom.segments import make
from wedmcam.machines import builtin
from wedmcam.targets import Entries
from wedmcam.targets.g41 import decode
from wedmcam.transforms import compensate

SAMPLES = Path(__file__).parents[2] / "samples"
#: A plate with three corners that the wire goes round, and a hole.
PART = b"""contour a { from (0, 0) line to (20, 0) line to (20, 10) line to (5, 14) close }
contour h { from (8, 4) line to (11, 4) line to (11, 7) line to (8, 7) close }
cut h inside offset 0.1 start (9.5, 5.5)
cut a outside offset 0.1 start (10, -2)
"""
RAW = compensate.raw_offset


def prolonged(source, sharp):
    """Sides prolonged to where they meet: no arc at all."""
    return RAW(source, True)


def bulging(source, sharp):
    """Half a circle over the ends of every arc about a corner: farther out than the offset."""
    raw = RAW(source, sharp)
    e, k = raw.elements, raw.transition
    cx, cy = np.where(k, 0.5 * (e.x0 + e.x1), e.cx), np.where(k, 0.5 * (e.y0 + e.y1), e.cy)
    radius = np.where(k, 0.5 * np.hypot(e.x1 - e.x0, e.y1 - e.y0), e.radius)
    sweep = np.where(k, np.pi, e.sweep)
    return replace(raw, elements=make(e.x0, e.y0, e.x1, e.y1, cx, cy, e.turn, radius, sweep))


def errors(made):
    return {d.code for d in made.findings if str(d.severity) == "error"}


@pytest.mark.parametrize("profile", ["iso-g41", "iso-g41-mm"])
@pytest.mark.parametrize("broken", [prolonged, bulging])
def test_a_broken_arc_about_a_corner_is_refused(monkeypatch, broken, profile):
    assert api.compile(PART, name="a.wed", profile=profile).ok
    monkeypatch.setattr(compensate, "raw_offset", broken)
    made = api.compile(PART, name="a.wed", profile=profile)
    assert not made.ok
    assert errors(made) & {"path-deviation", "not-reachable"}, errors(made)


def test_prolonged_sides_are_seen_by_the_model_alone(monkeypatch):
    """They cut the same part, and a profile that states the path runs them as planned."""
    monkeypatch.setattr(compensate, "raw_offset", prolonged)
    assert api.compile(PART, name="a.wed", profile="iso-mm").ok
    made = api.compile(PART, name="a.wed", profile="iso-g41-mm")
    assert errors(made) == {"not-reachable"}


@pytest.mark.parametrize("broken", [prolonged, bulging])
def test_what_the_controller_makes_of_a_program_does_not_change(monkeypatch, broken):
    machine = builtin("iso-g41-mm")
    made = api.compile((SAMPLES / "plate.dxf").read_bytes(), name="plate.dxf", offset=0.1,
                       profile="iso-g41-mm")  # fmt: skip
    table = Entries(d=made.entries.d).offset_of()
    before, _ = decode(made.data, machine, "x.nc", table)
    monkeypatch.setattr(compensate, "raw_offset", broken)
    after, _ = decode(made.data, machine, "x.nc", table)
    assert before.blocks.tolist() == after.blocks.tolist()

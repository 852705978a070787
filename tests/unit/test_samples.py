"""The sample drawings: committed as drawn, closed to 1 um, and cuttable with 0.1 mm of offset."""

from __future__ import annotations

import runpy
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.disassemble import recursive_decompose

import oracle
import parts
from wedmcam import api
from wedmcam.ir.contour import VERTEX, Contour

FOLDER = Path(__file__).parents[2] / "samples"
SCRIPT = runpy.run_path(str(FOLDER / "draw_samples.py"))
#: Drawn with curves, or damaged: ezdxf alone gives no contours of them.
CURVED = ("cam", "cover", "damaged")
NAMES = [n for n in SCRIPT["SAMPLES"] if n not in CURVED]
UM = {0: 1e3, 1: 25400.0, 4: 1e3}

Row = tuple[float, float, float, float, int]


def contours_of(path: Path) -> tuple[list[Contour], list[tuple[float, float]]]:
    """Closed contours (um) on layer CUT and thread points, by ezdxf and a greedy chain."""
    doc = ezdxf.readfile(path)
    um = UM[doc.header.get("$INSUNITS", 0)]
    loose: list[tuple[np.ndarray, np.ndarray, np.ndarray, int]] = []
    done, threads = [], []
    for e in recursive_decompose(doc.modelspace()):
        pieces = e.virtual_entities() if "POLYLINE" in e.dxftype() else [e]
        if e.dxf.layer == "START":
            at = e.dxf.location if e.dxftype() == "POINT" else e.dxf.center
            threads.append((at.x * um, at.y * um))
            continue
        for p in pieces if e.dxf.layer == "CUT" else ():
            if p.dxftype() == "CIRCLE":
                at = p.ocs().to_wcs(p.dxf.center) * um
                done.append(parts.circle(at.x, at.y, p.dxf.radius * um))
                continue
            arc = p.dxftype() == "ARC"
            a, b = (p.start_point, p.end_point) if arc else (p.dxf.start, p.dxf.end)
            c = p.ocs().to_wcs(p.dxf.center) if arc else a
            turn = (1 if p.dxf.extrusion.z > 0 else -1) if arc else 0
            loose.append((*(np.array(q)[:2] * um for q in (a, b, c)), turn))
    while loose:
        chain = [loose.pop()]
        while np.hypot(*(chain[-1][1] - chain[0][0])) > 1:
            for i, (a, b, c, turn) in enumerate(loose):
                if np.hypot(*(a - chain[-1][1])) <= 1:
                    chain.append((a, b, c, turn))
                elif np.hypot(*(b - chain[-1][1])) <= 1:
                    chain.append((b, a, c, -turn))
                else:
                    continue
                del loose[i]
                break
            else:
                raise AssertionError(f"open at {chain[-1][1]}")
        rows = [(*a, *c, turn, -1) for a, _, c, turn in chain]
        done.append(Contour(np.array(rows, VERTEX), True))
    return done, threads


def test_drawing_twice_gives_the_same_text() -> None:
    for draw in SCRIPT["SAMPLES"].values():
        assert SCRIPT["text_of"](draw()) == SCRIPT["text_of"](draw())


def entities(text: str) -> str:
    """From the blocks on, without comments: what a newer ezdxf has no reason to change."""
    if "\nBLOCKS\n" not in text:
        return text
    return text[text.index("\nBLOCKS\n") : text.index("\nOBJECTS\n") if "OBJECTS" in text else None]


@pytest.mark.parametrize("name", list(SCRIPT["SAMPLES"]))
def test_committed_drawings_are_what_the_script_draws(name: str) -> None:
    committed = (FOLDER / f"{name}.dxf").read_bytes().decode("utf-8")
    assert entities(committed) == entities(SCRIPT["text_of"](SCRIPT["SAMPLES"][name]()))


# name: contours, segments of the longest, width and height in mm, thread points
EXPECTED = {
    "key-punch": (1, 56, 40.0, 8.5, 1),
    "stator-36": (2, 360, 84.0, 84.0, 2),
    "gear-24": (2, 192, 52.0, 52.0, 1),
    "plate": (10, 16, 80.0, 50.0, 3),
    "bracket-inch": (4, 12, 76.2, 50.8, 1),
}


@pytest.mark.parametrize("name", NAMES)
def test_sample_is_closed_and_cuttable(name: str) -> None:
    made, threads = contours_of(FOLDER / f"{name}.dxf")
    made.sort(key=lambda c: -abs(oracle.signed_area(c)))
    rings = [oracle.chords(c, 0.5) for c in made]
    width, height = np.ptp(rings[0], axis=0) / 1e3
    found = (len(made), max(map(len, made)), round(width, 2), round(height, 2), len(threads))
    assert found == EXPECTED[name]
    for i, contour in enumerate(made):
        ccw = contour if oracle.signed_area(contour) > 0 else contour.reversed()
        assert parts.is_simple(ccw)
        # The wire runs outside the outer contour and inside the holes, with 1.3 times the offset.
        assert parts.takes_disc(ccw, 130, inside=i > 0), i
        area, loops = oracle.clipper_offset_area(ccw, -130 if i else 130)
        assert len(loops) == 1
        assert area > 0


@pytest.mark.parametrize(
    ("name", "contours", "codes", "options"),
    [
        ("cam", 2, ["approximated"], {}),
        ("cover", 8, ["approximated", "spline-circle"], {}),
        ("damaged", 3, [*["repaired-drawing"] * 4, "approximated"], {"units": "mm"}),
    ],
)
@pytest.mark.parametrize("to", ["3b", "compact"])
def test_curves_are_cut_within_their_tolerance(name, contours, codes, options, to) -> None:
    made = api.compile(FOLDER / f"{name}.dxf", to=to, offset=0.1, **options)
    assert made.ok, [d.message for d in made.findings]
    assert made.summary["contours"] == contours
    assert made.verdict.max_deviation_um <= 2.0
    assert 0.5 < made.drawn.sketch.info.extra["spline_um"] <= 1.0
    assert [d.code for d in made.findings] == codes


def test_both_sides_of_the_stators_slots_have_their_radii() -> None:
    made, _ = contours_of(FOLDER / "stator-36.dxf")
    bore = min(made, key=lambda c: abs(oracle.signed_area(c)))
    radius = oracle.radii(bore)
    assert radius[radius > 0].min() >= 250
    assert parts.takes_disc(bore, 240, inside=True)

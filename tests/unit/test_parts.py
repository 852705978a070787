"""The generators keep their promises: simple, repeatable, and as hard as they say."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pytest
import shapely

import oracle
import parts
from wedmcam.ir.contour import Contour

SEEDS = range(12)


def mismatch(contour: Contour) -> float:
    """Largest distance of an arc's end from its circle, um."""
    a, b = contour.starts, contour.ends
    off = np.abs(np.hypot(b["x"] - a["cx"], b["y"] - a["cy"]) - oracle.radii(contour))
    return float(np.where(a["turn"] == 0, 0, off).max())


def joint_angles(contour: Contour) -> np.ndarray:
    start, end = parts._headings(contour.vertices, np.roll(contour.vertices, -1))
    return np.angle(np.exp(1j * (start - np.roll(end, 1))))


@pytest.mark.parametrize("name", parts.FAMILIES)
def test_family_cases_are_simple_counter_clockwise_and_repeatable(name: str) -> None:
    for seed in SEEDS:
        contour, offset, outward = parts.family_case(name, seed)
        again = parts.family_case(name, seed)
        assert (contour.vertices == again[0].vertices).all()
        assert (offset, outward) == again[1:]
        assert oracle.signed_area(contour) > 0
        assert parts.is_simple(contour)
        assert mismatch(contour) < 1e-6
        assert oracle.lengths(contour).min() > 0


@pytest.mark.parametrize("name", [n for n in parts.FAMILIES if n.endswith("-grid")])
def test_grid_families_lie_on_the_grid(name: str) -> None:
    for seed in SEEDS:
        v = parts.family_case(name, seed)[0].vertices
        assert (v["x"] == np.round(v["x"])).all()
        assert (v["y"] == np.round(v["y"])).all()


def test_families_are_as_hard_as_they_say() -> None:
    def cases(name: str):  # type: ignore[no-untyped-def]
        return [parts.family_case(name, seed) for seed in range(30)]

    for contour, offset, _ in cases("fillet-equal"):
        assert oracle.radii(contour)[contour.vertices["turn"] != 0] == pytest.approx(offset)
    near = np.concatenate(
        [np.abs(oracle.radii(c)[c.vertices["turn"] != 0] - d) for c, d, _ in cases("fillet-near")]
    )
    assert near.max() <= 1.0
    assert near.min() < 1e-4
    for contour, offset, _ in cases("fillet-small"):
        r = oracle.radii(contour)[contour.vertices["turn"] != 0]
        assert (r <= offset * 1.000001).all()
        assert (r >= offset / 8.000001).all()
    tangency = np.concatenate([np.abs(joint_angles(c)) for c, *_ in cases("tangent-grid")])
    assert 1e-6 < np.median(tangency) < 0.05
    assert min(oracle.lengths(c).min() for c, *_ in cases("tiny")) < 1e-3
    for contour, offset, outward in cases("biarc"):
        shrinks = contour.vertices["turn"] == (-1 if outward else 1)
        assert oracle.radii(contour)[shrinks].min() < offset


def test_slots_are_two_offsets_wide() -> None:
    exact = 0
    for seed in range(40):
        contour, offset, outward = parts.family_case("slot", seed)
        assert not parts.takes_disc(contour, offset * 1.01, not outward)
        assert parts.takes_disc(contour, offset * 0.97, not outward)
        x, y = contour.vertices["x"], contour.vertices["y"]
        gaps = np.hypot(x[:, None] - x, y[:, None] - y) - 2 * offset
        exact += bool((np.abs(gaps) < 1e-9).any())
    assert 2 <= exact <= 25


def test_random_parts_are_cuttable() -> None:
    kinds = set()
    for seed in range(25):
        outer, *holes = parts.random_part(seed)
        shape = parts.polygon(outer, 1.0)
        assert parts.is_simple(outer)
        assert parts.takes_disc(outer, 150, True)
        assert parts.takes_disc(outer, 150, False)
        voids = [parts.polygon(hole, 1.0) for hole in holes]
        for i, void in enumerate(voids):
            assert parts.takes_disc(holes[i], 150, True)
            assert shape.buffer(-400).contains(void)
            assert all(void.distance(other) > 400 for other in voids[:i])
        assert 4e3 < shapely.length(shape) / np.pi < 2e5
        fillets = oracle.radii(outer)[outer.vertices["turn"] != 0]
        assert (fillets > 199).all()
        kinds |= {len(hole) for hole in holes}
        kinds |= {"sharp" if (np.abs(joint_angles(outer)) > 0.1).any() else "smooth"}
        kinds |= {"concave" if (joint_angles(outer) < -0.1).any() else "convex"}
    assert {1, 4, "sharp", "smooth", "concave", "convex"} <= kinds


@pytest.mark.parametrize("segments", [96, 1000])
def test_workloads_have_their_size(segments: int) -> None:
    gear = parts.gear(segments)
    stator = parts.stator(segments)
    assert len(gear) == len(stator) == len(parts.pinch(segments)) == segments
    assert len(parts.biarc(segments)) == segments
    for contour in (gear, stator, parts.pinch(segments), parts.biarc(segments)):
        assert parts.is_simple(contour)
        assert mismatch(contour) < 1e-6
    assert np.abs(joint_angles(gear)).max() < 1e-9
    assert np.abs(joint_angles(parts.biarc(segments))).max() < 1e-9


def test_gear1000_has_the_published_radii() -> None:
    v = parts.gear(1000).vertices
    r = np.hypot(v["x"], v["y"])
    assert r.min() == pytest.approx(99.47e3, abs=10)  # "99.5 mm"
    assert r.max() == pytest.approx(103.47e3, abs=10)


@pytest.mark.parametrize("polylines", [False, True], ids=["segments", "polylines"])
@pytest.mark.parametrize("units", [0, 1, 4, 13])
def test_dxf_bytes_reads_back(polylines: bool, units: int) -> None:
    part = parts.random_part(5)
    text = parts.dxf_bytes(
        part, thread_points=[(1e3, -2e3)], polylines=polylines, units=units, shuffle=3
    ).decode("ascii")
    doc = ezdxf.read(io.StringIO(text))
    msp = doc.modelspace()
    count = len(part) if polylines else sum(map(len, part))
    assert len(msp.query("LINE ARC CIRCLE POLYLINE")) == count
    assert len(msp.query("POINT[layer=='START']")) == 1
    assert doc.header.get("$INSUNITS", 0) == units
    um = {0: 1e3, 4: 1e3, 1: 25400, 13: 1}[units]
    point = msp.query("POINT").first
    assert point is not None
    assert point.dxf.location.x * um == pytest.approx(1e3)
    for arc in msp.query("ARC"):
        ends = np.array([arc.start_point, arc.end_point])[:, :2] * um
        assert min(oracle.distance_to_contour(ends, c).max() for c in part) < 1e-6
    for line in msp.query("LINE"):
        ends = np.array([line.dxf.start, line.dxf.end])[:, :2] * um
        middle = ends.mean(axis=0, keepdims=True)
        assert min(oracle.distance_to_contour(middle, c).max() for c in part) < 1e-6

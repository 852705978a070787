"""The made drawings of the benchmarks are drawings, and the tables of benchmarks are tables."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from wedmcam import api

BENCHMARKS = str(Path(__file__).parents[2] / "benchmarks")


@pytest.fixture
def benchmarks(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    yield
    for name in ("stage_drawings", "bench_offsets", "bench_stages"):
        sys.modules.pop(name, None)


def test_a_made_plate_compiles(benchmarks):
    from stage_drawings import PER_HOLE, drawing

    data, holes = drawing(4 * PER_HOLE)
    made = api.compile(data, offset=0.1)
    assert made.ok, made.findings
    assert made.verdict.contours == holes == 4


def test_the_polygon_route_is_near_and_has_more_blocks(benchmarks):
    import bench_offsets
    from stage_drawings import drawing

    data, _ = drawing(48)
    made = api.compile(data, offset=0.1)
    fine = bench_offsets.polygon_route(data, 0.5)
    coarse = bench_offsets.polygon_route(data, 5.0)
    assert sum(len(b) for _, b in fine) > 3 * made.verdict.blocks
    assert bench_offsets.route_error(fine, made.plan) < bench_offsets.route_error(coarse, made.plan)
    lines = list(bench_offsets.route_table([]))
    assert all(line.startswith("|") for line in lines)

"""The made drawings of the benchmarks are drawings, and the tables of benchmarks are tables."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from wedmcam import api
from wedmcam.controllers.pointwise import run, trace
from wedmcam.ir.program import Kind

BENCHMARKS = str(Path(__file__).parents[2] / "benchmarks")


@pytest.fixture
def benchmarks(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    yield
    for name in ("stage_drawings", "bench_offsets", "bench_stages", "bench_controller"):
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


def test_stages_are_measured_in_both_arithmetics(benchmarks, tmp_path):
    import bench_stages
    from stage_drawings import drawing

    name = tmp_path / "plate.dxf"
    name.write_bytes(drawing(96)[0])
    alone = bench_stages.of_its_own("read_alone", str(name))
    assert alone["s"] > 0
    row = {"entities": 96, "read_alone": alone}
    for arithmetic in bench_stages.ARITHMETICS:
        made = bench_stages.of_its_own("compiled", str(name), arithmetic)
        assert made["deviation_um"] <= 2
        assert 0 < sum(made[s] for s in bench_stages.STAGES) <= made["s"]
        row[arithmetic] = {**made, "ratio": 1.0, "judge_adds": 0.1}
    assert len(list(bench_stages.table([row]))) == 4


def test_the_c_loop_of_the_benchmark_steps_as_the_closed_form(benchmarks):
    import bench_controller

    loop = bench_controller.c_loop()
    if loop is None:
        pytest.skip("no cc")
    for blocks in (
        bench_controller.lines(50, 300),
        bench_controller.arcs(50, 300, False),
        bench_controller.arcs(50, 300, True),
    ):
        want, first = trace(blocks)
        steps = run(blocks).steps
        got = np.empty((len(want) - 1, 2), np.int64)
        bench_controller.stored(loop, blocks, got)
        is_arc = blocks["kind"] == Kind.ARC
        for axis, name in enumerate("xy"):
            begin = want[first, axis] - np.where(is_arc, blocks[name], 0)
            assert np.array_equal(got[:, axis] + np.repeat(begin, steps), want[1:, axis])

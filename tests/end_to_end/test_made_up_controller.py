"""A new controller is one class and its files: nothing else knows of it."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import made_up_controller as made_up
from wedmcam import api, backends, controllers, frontends, targets
from wedmcam.judge.judge import judge

SAMPLES = Path(__file__).parents[2] / "samples"
REGISTRIES = (
    (frontends.DECODERS, "made_up_controller"),
    (backends.ENCODERS, "made_up_controller"),
    (controllers.STEPPINGS, "made_up_controller:stepping"),
    (targets.KINDS, "made_up_controller:MadeUp"),
)


@pytest.fixture(autouse=True)
def _registered(monkeypatch):
    for registry, entry in REGISTRIES:
        monkeypatch.setitem(registry, "made-up", entry)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("key-punch.dxf", {"offset": 0.1}),
        ("bracket-inch.dxf", {"offset": 0.1, "stop": 0.5, "overcut": 0.2}),
        ("washer.wed", {}),
    ],
)
def test_a_part_is_compiled_proven_and_verified(name, options):
    compilation = api.compile(SAMPLES / name, profile=made_up.MACHINE, **options)
    assert compilation.ok, [d.message for d in compilation.findings]
    verdict = compilation.verdict
    assert verdict.max_deviation_um <= 2.0
    assert verdict.closure_um == 0
    at, _ = made_up.Rounding().trace(compilation.program.blocks)
    steps = np.diff(at, axis=0)
    assert np.abs(steps).max() == 1
    assert (np.abs(steps).sum(axis=1) == 2).any()  # no point-by-point interpolator steps so
    proof = api.verify(
        compilation.data, against=SAMPLES / name, profile=made_up.MACHINE, name="a.txt", **options
    )
    assert proof.ok, [d.message for d in proof.findings]


def test_its_own_interpolator_is_what_is_judged():
    compilation = api.compile(SAMPLES / "key-punch.dxf", profile=made_up.MACHINE, offset=0.1)
    machine = compilation.machine
    blocks = compilation.program.blocks.copy()
    arc = int(np.flatnonzero(blocks["turn"])[0])
    blocks["count"][arc] -= 5 * made_up.PARTS
    forged = dataclasses.replace(compilation.program, blocks=blocks)
    verdict, _ = judge(forged, compilation.plan, stepping=machine.stepping, limits=machine.limits)
    assert not verdict.ok
    as_3b = api.machine_for("3b", None).stepping  # J means something else there
    verdict, _ = judge(compilation.program, compilation.plan, stepping=as_3b)
    assert not verdict.ok


def test_a_program_of_it_becomes_3b_and_is_told():
    from wedmcam.operations import convert
    from wedmcam.programs.rows import dump

    compilation = api.compile(SAMPLES / "key-punch.dxf", profile=made_up.MACHINE, offset=0.1)
    rows = list(dump(compilation.program, made_up.MACHINE))
    assert len(rows) == len(compilation.program.blocks)
    figures = api.figures(compilation.program, made_up.MACHINE)
    assert figures["closure_um"] == 0
    there = convert.convert(compilation.data, to="3b", profile_in=made_up.MACHINE, name="a.txt")
    assert there.program is not None
    rest = api.compile(SAMPLES / "key-punch.dxf", profile=made_up.MACHINE, offset=0.1, from_block=4)
    assert rest.ok, [d.message for d in rest.findings]

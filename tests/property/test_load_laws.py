"""Loads of a program are the program: the same blocks, each proven, and all of them together."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from test_certificate_laws import PROFILES, holds, machine

import parts
from wedmcam import api, machines
from wedmcam.ir.program import Kind
from wedmcam.machines import Machine
from wedmcam.operations.split import compile_loads, moves, proven_together
from wedmcam.options import WrongUse, options_in_mm
from wedmcam.targets import target_of

OPTIONS = st.fixed_dictionaries(
    {},
    optional={
        "side": st.sampled_from(["part", "die"]),
        "stop": st.sampled_from([0.4, 1.0]),
        "overcut": st.sampled_from([0.05, 0.3]),
        "reverse": st.booleans(),
        "order": st.sampled_from(["given", "nearest"]),
    },
)


def with_memory(name: str, records: int) -> Machine:
    known = machine(name)
    known = machines.builtin(known) if isinstance(known, str) else known
    if known.limits.memory_bytes:
        return replace(known, limits=replace(known.limits, memory_bytes=9 * records))
    return replace(known, limits=replace(known.limits, blocks=records))


@settings(max_examples=8)
@given(st.integers(0, 400), st.sampled_from(PROFILES), st.integers(6, 40), OPTIONS)
def test_loads_are_the_program(seed, profile, records, more):
    drawing = parts.dxf_bytes(parts.random_part(seed), shuffle=seed)
    small = with_memory(profile, records)
    options = options_in_mm(offset=0.1, **more)
    try:
        whole = api.compile(drawing, profile=small, options=options)
    except WrongUse:  # G41 has no overcut
        return
    made = compile_loads(drawing, profile=small, options=options, output_name="a.x")
    if not whole.ok:
        return
    for load in made:
        assert load.ok, [d.message for d in load.findings]
        large = [d for d in load.findings if d.code == "over-memory"]
        # What stays too large is one contour that no load can begin within, or that has no room.
        assert not large or len(load.plan.cuts) == 1
        assert not large or target_of(small).whole_contours or records < 12
        holds(drawing, load, "input")
    cutting = [int((load.program.blocks["kind"] < Kind.MOVE).sum()) for load in made]
    steps = [load.summary["steps"] for load in made]
    assert sum(cutting) == int((whole.program.blocks["kind"] < Kind.MOVE).sum())
    assert sum(steps) == whole.summary["steps"]
    for move in moves(made):
        assert not move["kerf"] or move["move_um"] == [0, 0]
    for together in proven_together(made):
        assert not [d for d in together.findings if d.severity > 0]
        assert together.verdict.closure_um == 0

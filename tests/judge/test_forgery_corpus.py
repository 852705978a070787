"""A slice of the forgeries of golden programs; `benchmarks/bench_forgeries.py` runs them all."""

from __future__ import annotations

from functools import cache

import forgeries as fg
import numpy as np
import pytest

from wedmcam.ir.program import Axis, Kind

#: Program -> blocks (0-based) that are forged: leads, lines, arcs, arcs beside smooth lines.
SLICES = {
    "key-punch.3b": [0, 1, 2, 3, 10, 30, 58],
    "key-punch.zd": [0, 2, 5, 40],
    "key-punch.die.3b": [1, 4, 9],
    "gear-24.3b": [1, 2, 57],
    "bracket-inch.3b": [9, 13],
}

golden = cache(fg.golden)


@pytest.mark.parametrize("name", SLICES)
def test_every_forgery_beyond_two_microns_is_refused_by_its_block(name):
    g = golden(name)
    sorts = set()
    for mutant in fg.mutants(g, np.array(SLICES[name])):
        o = fg.judged(g, mutant)
        sorts.add(mutant.sort)
        where = f"{name}: {mutant.sort}, block {mutant.row + 1}, {o.apart_um} um, {o.codes}"
        if o.apart_um > fg.FAR:
            assert o.refused, where
            assert o.named, where
        if o.same:
            assert o.apart_um == 0, where
            assert not o.refused, where
        if mutant.sort in ("line in two", "ratio doubled"):
            assert o.same, where
    assert {"J +1", "J -5", "block dropped", "block doubled"} <= sorts


@pytest.mark.parametrize("name", ["key-punch.3b", "bracket-inch.zd"])
def test_forgeries_of_the_whole_are_refused(name):
    g = golden(name)
    sorts = set()
    for mutant in fg.of_the_whole(g):
        o = fg.judged(g, mutant)
        sorts.add(mutant.sort)
        assert o.apart_um > fg.FAR, mutant.sort
        assert o.refused, mutant.sort
    assert "wire diameter for radius" in sorts
    assert ("contour not cut" in sorts) == (name == "bracket-inch.zd")


def test_one_step_too_many_is_refused_although_nothing_is_two_microns_off():
    g = golden("key-punch.3b")
    for mutant in fg.mutants(g, np.array([5])):
        if mutant.sort in ("J +1", "J -1"):
            o = fg.judged(g, mutant)
            assert 0 < o.apart_um <= fg.FAR
            assert o.refused


def test_the_block_that_ran_on_along_a_smooth_path_is_named():
    g = golden("key-punch.3b")
    arcs = np.flatnonzero(g.program.blocks["kind"] == Kind.ARC)
    said = 0
    for mutant in fg.mutants(g, arcs[:6]):
        if mutant.sort == "J +5":
            _, found = fg.judge(mutant.program, g.plan, stepping=g.stepping, limits=g.limits)
            said += any(
                f"block {mutant.row + 1} already ends 0.005 mm past" in d.message for d in found
            )
    assert said


def test_golden_programs_themselves_pass():
    for name in ("key-punch.3b", "bracket-inch.zd"):
        g = golden(name)
        verdict, found = fg.judge(g.program, g.plan, stepping=g.stepping, limits=g.limits)
        assert verdict.ok, found
        assert (g.program.blocks["axis"] == Axis.SQUARE).any() == name.endswith(".zd")

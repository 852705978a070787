"""Axis exchange and mirrors: the machine goes where the drawing says, whatever its axes do.

What each orientation means stands here once more, spelled out: `EXPECTED`. Everything is held
against it, and not against the maps of the writer and the reader.
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_programs import programs

from wedmcam.backends import encoder
from wedmcam.controllers.pointwise import LineTable, trace
from wedmcam.controllers.pointwise.nominal import nominal_end
from wedmcam.diag import has_errors
from wedmcam.frontends import decoder
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.machines import Axes, builtin

#: (exchange, mirror_x, mirror_y) -> where a place (x, y) of the drawing lies for the controller.
EXPECTED = {
    (False, False, False): lambda x, y: (x, y),
    (False, True, False): lambda x, y: (-x, y),
    (False, False, True): lambda x, y: (x, -y),
    (False, True, True): lambda x, y: (-x, -y),
    (True, False, False): lambda x, y: (y, x),
    (True, True, False): lambda x, y: (y, -x),
    (True, False, True): lambda x, y: (-y, x),
    (True, True, True): lambda x, y: (-y, -x),
}
#: Those that turn the sense of arcs around.
REFLECTIONS = {(0, 1, 0), (0, 0, 1), (1, 0, 0), (1, 1, 1)}
NAMES = ["b3-compact", "b3-numbered", "iso-um", "iso-mm", "zd065"]
ways = st.sampled_from(list(EXPECTED))


def oriented(name, way, line_table=None):
    machine = builtin(name)
    table = line_table or machine.line_table
    return replace(machine, axes=Axes(*way), line_table=table)


def mixed_blocks(seed, n, r=60):
    rng = np.random.default_rng(seed)
    b = np.zeros(n, BLOCK)
    b["kind"] = rng.choice([Kind.LINE, Kind.ARC, Kind.MOVE], n, p=[0.4, 0.5, 0.1])
    arc = b["kind"] == Kind.ARC
    b["turn"] = np.where(arc, rng.choice([-1, 1], n), 0)
    b["axis"] = rng.integers(0, len(Axis), n)
    b["x"], b["y"] = rng.integers(-r, r + 1, (2, n))
    special = rng.random(n)
    b["x"][special < 0.15] = 0
    b["y"][(special > 0.15) & (special < 0.3)] = 0
    tie = (special > 0.3) & (special < 0.5)
    b["y"][tie] = b["x"][tie] * rng.choice([-1, 1], int(tie.sum()))
    b["count"] = rng.integers(0, 4 * r, n)
    return b


@pytest.mark.parametrize("line_table", ["mirror", "rotate"])
@pytest.mark.parametrize("way", EXPECTED)
def test_the_controller_steps_the_image_of_the_path(way, line_table):
    """Every step: the controller's own table on its own blocks against the drawing's view."""
    from wedmcam.backends.axes import to_controller

    machine = oriented("b3-compact", way, line_table)
    b = mixed_blocks(5, 3000)
    b = b[machine.stepping.run(b).steps > 0]
    there = to_controller(Program(b), machine.axes).blocks
    drawn, first = machine.stepping.trace(b)
    stepped, first_there = trace(there, LineTable(line_table))
    assert np.array_equal(first, first_there)
    x, y = EXPECTED[way](drawn[:, 0], drawn[:, 1])
    assert np.array_equal(stepped, np.stack([x, y], axis=1))
    arcs = b["kind"] == Kind.ARC
    same = way not in REFLECTIONS
    assert ((there["turn"] == b["turn"])[arcs] == same).all()


@pytest.mark.parametrize("way", EXPECTED)
def test_recomputed_ends_are_images_too(way):
    """Controllers that recompute the ends of arcs see the same symmetry."""
    from wedmcam.backends.axes import to_controller

    b = mixed_blocks(6, 2000, 3000)
    b = b[(b["kind"] == Kind.ARC) & (b["axis"] < Axis.SQUARE) & (b["x"] ** 2 + b["y"] ** 2 > 2)]
    there = to_controller(Program(b), Axes(*way)).blocks
    ends = [nominal_end(*(p[k] for k in ("x", "y", "turn", "axis", "count"))) for p in (b, there)]
    live = b["count"] > 0
    wanted = EXPECTED[way](*ends[0])
    assert all(np.array_equal(g[live], w[live]) for g, w in zip(ends[1], wanted, strict=True))


@settings(deadline=None, max_examples=60)
@given(program=programs("3b"), way=ways, line_table=st.sampled_from(["mirror", "rotate"]))
def test_3b_round_trip(program, way, line_table):
    machine = oriented("b3-compact", way, line_table)
    check_round_trip(program, machine, builtin("b3-compact"))


@settings(deadline=None, max_examples=40)
@given(program=programs("compact"), way=ways)
def test_compact_round_trip(program, way):
    machine = oriented("zd065", way)
    blocks = program.blocks.copy()
    if way[0]:  # what a drawing's program has for such a controller: its square with x at a tie
        blocks["axis"][blocks["axis"] == Axis.SQUARE] = Axis.SQUARE_X
    check_round_trip(replace(program, blocks=blocks), machine, builtin("zd065"))


def check_round_trip(program, machine, plain):
    data, said = encoder(machine.format)(program, machine)
    if has_errors(said):  # a line whose ratio the image's count axis does not make whole
        return
    again, found = decoder(machine.format)(data, machine, "k")
    assert not has_errors(found)
    assert encoder(machine.format)(again, machine)[0] == data
    # Read by who knows nothing of axes: the image of what was read, step by step.
    raw, found = decoder(machine.format)(data, replace(plain, line_table=machine.line_table), "k")
    assert not has_errors(found)
    drawn, _ = machine.stepping.trace(again.blocks[: len(raw.blocks)])
    stepped, _ = machine.own_stepping.trace(raw.blocks)
    way = (machine.axes.exchange, machine.axes.mirror_x, machine.axes.mirror_y)
    assert np.array_equal(stepped, np.stack(EXPECTED[way](*drawn.T), axis=1))
    if not said:  # no 45 degree line was counted for another table
        fields = ["kind", "turn", "axis", "x", "y", "count"]
        n = len(program.blocks)
        assert again.blocks[:n][fields].tolist() == program.blocks[fields].tolist()


def test_the_expected_maps_are_all_eight():
    assert set(EXPECTED) == set(product((False, True), repeat=3))
    images = {f(1, 2) for f in EXPECTED.values()}
    assert len(images) == 8

"""The machine code of the ZD-065 and `controllers.pointwise`, equal step by step.

Both were written from the paper. Compared are the patterns on the motors' port, and F, J and the
number of the block in zero page at each step.
"""

import itertools
from pathlib import Path

import numpy as np
import pytest
from blocks import arc, cut, line
from expected import (
    assert_same,
    blocks_of,
    closed,
    counting,
    deviation,
    program,
    stepped,
    walked,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st
from machine import Machine

from wedmcam.controllers.pointwise import arc_quadrant, run
from wedmcam.formats.compact import CCW, CW, LINE, MOVE, to_bcd
from wedmcam.ir.program import Kind

GOLDEN = Path(__file__).parents[1] / "golden"
#: Programs of more steps are left out: the emulator makes some 50,000 a second.
MOST_STEPS = 300_000
MEMORY = 4096


def golden():
    """Return the golden programs that are run here."""

    def is_run(path):
        steps = run(blocks_of(path.read_bytes())).steps.sum()
        return steps <= MOST_STEPS and path.stat().st_size <= MEMORY

    return [path.name for path in sorted(GOLDEN.glob("*.zd")) if is_run(path)]


def test_there_are_golden_programs():
    assert len(golden()) >= 3


@pytest.mark.parametrize("name", golden())
def test_golden_programs(machine, name):
    data = (GOLDEN / name).read_bytes()
    assert_same(cut(machine, data), program(blocks_of(data)))
    assert machine["state"] == machine.names["ended"]


@pytest.mark.parametrize("group", [CW, CCW])
def test_every_small_arc_in_every_quadrant(image, group):
    """Three turns and more, so that every start meets every axis and every tie."""
    arcs = [
        arc(group, quadrant, x, y, 9 * (x + y))
        for quadrant, x, y in itertools.product(range(1, 5), range(7), range(7))
        if x * x + y * y >= 2
    ]
    for at in range(0, len(arcs), 300):
        data = b"".join(arcs[at : at + 300])
        assert_same(cut(Machine(image), data), program(blocks_of(data), stepped))


def test_every_small_line_in_every_quadrant(machine):
    lines = [
        line(group, quadrant, x, y)
        for group, quadrant, x, y in itertools.product(
            [LINE, MOVE], range(1, 5), [0, 1, 2, 3, 5, 8], [0, 1, 2, 3, 5, 8]
        )
        if x or y
    ]
    data = b"".join(lines)
    assert_same(cut(machine, data), program(blocks_of(data), stepped))


lengths = st.one_of(st.integers(0, 20), st.integers(0, 1000), st.sampled_from([127, 128, 255, 256]))
radii = st.one_of(lengths, st.integers(0, 7_000_000))
quadrants = st.integers(1, 4)
some_lines = st.builds(line, st.sampled_from([LINE, MOVE]), quadrants, lengths, lengths).filter(
    lambda data: any(data[1:])
)
some_arcs = st.builds(
    arc, st.sampled_from([CW, CCW]), quadrants, radii, radii, st.integers(1, 950)
).filter(lambda data: int(data[1:5].hex()) + int(data[5:9].hex()) > 1)


@given(st.lists(some_lines | some_arcs, min_size=1, max_size=4))
@example([arc(CCW, 1, 1, 1, 900), arc(CW, 2, 1, 1, 900)])  # u = 0 before |x| = |y|
@example([arc(CCW, 1, 128, 0, 950), arc(CW, 1, 0, 32768, 900)])  # 2u - 1 borrows at once
@example([arc(CCW, 1, 5_000_000, 8_388_600, 50), arc(CCW, 1, 8_388_612, 5_000_000, 50)])
@example([arc(CW, 2, 30_000, 32_760, 50), arc(CW, 2, 32_772, 30_000, 50)])
@example([arc(CCW, 3, 8_388_608, 0, 100), arc(CW, 2, 5_000_000, 5_000_000, 100)])
@settings(max_examples=60)
def test_random_blocks_of_up_to_2000_steps(image, blocks):
    data = b"".join(blocks)
    stated = blocks_of(data)
    assert run(stated).steps.max() <= 2000
    assert_same(cut(Machine(image), data), program(stated, stepped))


# --- at the limits ------------------------------------------------------------------------------

WINDOW = 1000
PARTS, OF_PART = 8, 25


def at_the_limits():
    """Return 200 blocks: radii up to 10 m, J and lines up to 999,999 um."""
    rng = np.random.default_rng(65)
    most = 999_999
    blocks = [
        arc(CCW, 1, 10_000_000, 0, most),
        arc(CW, 3, 0, 10_000_000, most),
        arc(CCW, 2, 6_000_000, 8_000_000, most),
        arc(CW, 4, 8_000_000, 6_000_000, most),
        arc(CCW, 4, 7_071_067, 7_071_067, most),
        arc(CW, 1, 176_776, 0, most),
        arc(CCW, 3, 1, 1, most),
        arc(CCW, 1, 4_194_304, 1, most),
        line(LINE, 1, most, most),
        line(LINE, 2, most, most - 1),
        line(MOVE, 3, most - 1, most),
        line(LINE, 4, most, 0),
        line(LINE, 2, 0, most),
        line(LINE, 3, 1, most),
    ]
    while len(blocks) < PARTS * OF_PART:
        quadrant = int(rng.integers(1, 5))
        if len(blocks) % 4 == 0:
            x, y = (int(v) for v in (most, rng.integers(0, most + 1)))
            x, y = (x, y) if rng.random() < 0.5 else (y, x)
            blocks.append(line(int(rng.choice([LINE, MOVE])), quadrant, x, y))
            continue
        # Half the radii next to the limit, half of any size; angles anywhere, or next to an axis.
        radius = 10_000_000 - rng.random() * 10 if rng.random() < 0.5 else 10 ** rng.uniform(1, 7)
        angle = rng.random() * np.pi / 2 if rng.random() < 0.7 else 1e-7 * rng.random()
        x, y = int(radius * np.cos(angle)), int(radius * np.sin(angle))
        count = most if rng.random() < 0.5 else int(rng.integers(2000, most))
        blocks.append(arc(int(rng.choice([CW, CCW])), quadrant, x, y, count))
    return blocks


def put_interpolator(machine, block, at):
    """Set zero page to where the closed form stands after ``at`` steps, and go on from there."""
    xs, ys = walked(block, at)
    x, y = int(xs[0]), int(ys[0])
    machine.put("f", int(deviation(block, x, y)), 4)
    j = machine.names["j"]
    machine.memory[j : j + 3] = list(to_bcd(int(counting(block, xs, ys).sum()), 3))
    if block["kind"] != Kind.ARC:
        on_v = abs(block["y"]) >= abs(block["x"]) > 0
        machine.jump("line_v" if on_v else "line_u")
        return
    x, y, turn = x + int(block["x"]), y + int(block["y"]), int(block["turn"])
    quadrant = arc_quadrant(x, y, turn)
    machine["sector"] = quadrant - 1 + 4 * (turn < 0)
    u_is_x = (quadrant % 2 == 1) == (turn > 0)
    u, v = (abs(x), abs(y)) if u_is_x else (abs(y), abs(x))
    machine.put("less", 2 * u - 1, 4)
    machine.put("more", 2 * v + 1, 4)
    machine.jump("arc_resumed")


@pytest.mark.parametrize("part", range(PARTS))
def test_first_and_last_steps_of_blocks_at_the_limits(image, part):
    for data in at_the_limits()[part * OF_PART : (part + 1) * OF_PART]:
        block = blocks_of(data + b"\0")[0]
        machine = Machine(image)
        steps = int(run(blocks_of(data + b"\0")).steps[0])
        assert steps > 2 * WINDOW
        assert_same(cut(machine, data, WINDOW), closed(block, last=WINDOW))
        machine.forget()
        put_interpolator(machine, block, steps - WINDOW)
        assert machine.run()
        assert_same(machine.record(), closed(block, first=steps - WINDOW))
        assert machine["state"] == machine.names["ended"]

"""What the machine code of the ZD-065 does around the steps: repair, errors, feed, key, play."""

import itertools

import numpy as np
import pytest
from blocks import arc, cut, line
from expected import assert_same, blocks_of, program
from hypothesis import example, given, settings
from hypothesis import strategies as st
from machine import RING, ROM, Machine

from wedmcam.formats.compact import CCW, CW, LENGTH, LINE, MOVE, PAUSE, THREAD
from wedmcam.frontends.zd065.compact import decode
from wedmcam.machines import builtin

GOOD = line(LINE, 1, 5, 3)
GOOD_STEPS = 8


def findings_of(data):
    return decode(data, builtin("zd065"), "x.zd")[1]


# --- instruction repair -------------------------------------------------------------------------


def on_the_axes():
    for group, quadrant in itertools.product([LINE, MOVE], range(1, 5)):
        yield from (line(group, quadrant, 7, 0), line(group, quadrant, 0, 7))
    for group, quadrant in itertools.product([CW, CCW], range(1, 5)):
        yield from (arc(group, quadrant, 7, 0, 9), arc(group, quadrant, 0, 7, 9))


@pytest.mark.parametrize("data", list(on_the_axes()), ids=lambda data: data.hex())
def test_a_wrong_neighbour_is_repaired(machine, data):
    record = cut(machine, data)
    assert_same(record, program(blocks_of(data + b"\0")))
    repaired = [d for d in findings_of(data + b"\0") if d.code == "quadrant-repaired"]
    assert machine["repaired"] == len(repaired)
    instruction = repaired[0].values["repaired"] if repaired else data[0]
    assert machine["code"] == instruction


def test_no_quadrant_is_repaired_beside_an_axis(machine):
    data = b"".join(line(LINE, q, 7, 1) + arc(CCW, q, 7, 1, 9) for q in range(1, 5))
    assert_same(cut(machine, data), program(blocks_of(data + b"\0")))
    assert machine["repaired"] == 0


# --- errors -------------------------------------------------------------------------------------

ERRORS = [
    *(("no_instruction", bytes([code]) + bytes(11)) for code in (0x05, 0x10, 0x15, 0x20, 0x2F)),
    *(("no_instruction", bytes([code]) + bytes(11)) for code in (0x32, 0x40, 0x45, 0x50, 0xFF)),
    ("bad_digit", bytes.fromhex("01 00 00 0A 00 00 01")),
    ("bad_digit", bytes.fromhex("41 00 00 01 A0 00 01")),
    ("bad_digit", bytes.fromhex("21 00 00 00 09 00 00 00 00 00 00 F1")),
    ("bad_digit", bytes.fromhex("11 1F 00 00 09 00 00 00 00 00 00 01")),
    ("no_step", line(LINE, 1, 0, 0)),
    ("no_step", line(MOVE, 3, 0, 0)),
    ("no_step", arc(CCW, 1, 5, 0, 0)),
    ("too_small", arc(CCW, 1, 0, 0, 5)),
    ("too_small", arc(CW, 2, 1, 0, 5)),
    ("too_small", arc(CW, 3, 0, 1, 5)),
    ("too_large", arc(CW, 1, 10_000_001, 0, 5)),
    ("too_large", arc(CW, 1, 0, 10_000_001, 5)),
    ("too_large", arc(CCW, 2, 1, 10_000_000, 5)),
    ("too_large", arc(CCW, 3, 8_000_000, 6_000_001, 5)),
    ("too_large", arc(CCW, 4, 7_071_068, 7_071_068, 5)),
    ("too_large", arc(CCW, 1, 7_999_999, 6_999_999, 5)),
    ("too_large", arc(CCW, 1, 6_999_999, 7_999_999, 5)),
    ("too_large", arc(CCW, 1, 0x980000, 1_000_000, 5)),
    ("too_large", arc(CCW, 1, 10_999_999, 0, 5)),
    ("too_large", arc(CW, 1, 0, 16_777_217, 5)),
    ("too_large", arc(CCW, 4, 99_999_999, 99_999_999, 5)),
]


@pytest.mark.parametrize(("name", "data"), ERRORS, ids=lambda v: v if isinstance(v, str) else "")
def test_an_error_stops_before_a_step_of_its_block(machine, name, data):
    record = cut(machine, GOOD + data + GOOD)
    assert len(record.dx) == GOOD_STEPS
    assert machine["error"] == machine.names[name]
    assert machine["state"] == machine.names["stopped"]
    assert machine["generator"] == 0
    assert shown(machine) == f"E{machine.names[name]:X}0002"
    assert any(d.severity.name == "ERROR" for d in findings_of(GOOD + data + GOOD))


def test_the_largest_radius_is_no_error(machine):
    data = arc(CW, 1, 10_000_000, 0, 5) + arc(CCW, 3, 8_000_000, 6_000_000, 5)
    cut(machine, data)
    assert machine["error"] == 0


digits = st.sampled_from([0x00, 0x00, 0x00, 0x01, 0x07, 0x10, 0x70, 0x71, 0x99]) | st.builds(
    lambda tens, ones: tens << 4 | ones, st.integers(0, 9), st.integers(0, 9)
)


@given(
    st.sampled_from([0x01, 0x12, 0x23, 0x44]) | st.integers(1, 255),
    st.lists(digits, min_size=11, max_size=11),
    st.none() | st.tuples(st.integers(0, 10), st.integers(0, 255)),
)
@example(0x21, [0x07, 0x07, 0x10, 0x67, 0x07, 0x07, 0x10, 0x67, 0, 0, 1], None)
@example(0x21, [0x07, 0x07, 0x10, 0x68, 0x07, 0x07, 0x10, 0x67, 0, 0, 1], None)
@settings(max_examples=400)
def test_machine_code_and_reader_refuse_the_same_blocks(image, instruction, rest, damage):
    """Without feed a block that is accepted waits for its first step."""
    if damage is not None:
        rest[damage[0]] = damage[1]
    data = bytes([instruction, *rest])
    size = LENGTH[instruction] or 1
    machine = Machine(image)
    machine.load(data[:size] + b"\0")
    machine.feed(0)
    machine.run(instructions=6000)
    refused = [d for d in findings_of(data[:size] + b"\0") if d.severity.name == "ERROR"]
    assert (machine["error"] != 0) == bool(refused), refused
    assert len(machine.record().dx) == 0


def test_without_play_entered_it_refuses_to_cut(machine):
    machine.load(GOOD)
    machine["entered"] = 0
    assert machine.run()
    assert machine["error"] == machine.names["no_play"]
    assert len(machine.record().dx) == 0
    assert shown(machine) == f"E{machine.names['no_play']:X}0000"


# --- the end ------------------------------------------------------------------------------------


def test_bytes_behind_the_end_are_never_run(machine):
    record = cut(machine, GOOD + b"\0" + arc(CCW, 1, 9, 0, 50) + b"\xff")
    assert len(record.dx) == GOOD_STEPS
    assert machine["state"] == machine.names["ended"]
    assert machine["error"] == 0


def test_585_lines_fill_the_memory(machine):
    data = line(LINE, 1, 1, 0) * 585
    record = cut(machine, data)
    assert len(data) == 4095
    assert len(record.dx) == record.number[-1] == 585
    assert machine["state"] == machine.names["ended"]


@pytest.mark.parametrize("rest", [b"\1", line(LINE, 1, 1, 0)[:6], b"\x30" * 5])
def test_data_that_run_over_the_memory_are_an_error(machine, rest):
    data = bytes([PAUSE]) * (4096 - len(rest)) + rest
    machine.load(data)
    machine.memory[0x3000:0x3010] = [1] * 16
    assert machine.run()
    assert machine["error"] == machine.names["no_end"]
    assert len(machine.record().dx) == 0


# --- feed, key, generator -----------------------------------------------------------------------


def test_without_feed_nothing_steps(machine):
    data = GOOD + arc(CW, 1, 40, 30, 60) + b"\0"
    machine.load(data)
    machine.feed(0)
    machine.run(instructions=20_000)
    assert len(machine.record().dx) == 0
    wanted = program(blocks_of(data))
    for made in (1, 5, GOOD_STEPS, GOOD_STEPS + 1, 60):
        machine.feed(made - len(machine.record().dx))
        machine.run(instructions=20_000)
        record = machine.record()
        assert len(record.dx) == made
        assert machine.number("f", 4, signed=True) == record.f[-1]  # nothing is half done
        assert (record.dx == wanted.dx[:made]).all()
    machine.feed()
    machine.run()
    assert_same(machine.record(), wanted)


@pytest.mark.parametrize("code", [THREAD, PAUSE])
def test_a_thread_point_and_a_pause_wait_for_the_key(machine, code):
    machine.load(GOOD + bytes([code, code]) + GOOD + b"\0")
    machine.press(1)
    for _ in range(2):
        machine.run(instructions=20_000)
        assert len(machine.record().dx) == GOOD_STEPS
        assert machine["state"] == machine.names["waiting"]
        assert machine["generator"] == 0
        machine.press(1)
    machine.run()
    assert len(machine.record().dx) == 2 * GOOD_STEPS


def test_a_feed_from_before_a_pause_makes_no_step(machine):
    machine.load(GOOD + bytes([PAUSE]) + GOOD + b"\0")
    machine.press(1)
    machine.feed(1 + GOOD_STEPS + 1)  # the first one comes before the start
    machine.run(instructions=20_000)
    assert machine["flags"] & machine.names["feed"]
    machine.press(1)
    machine.run(instructions=20_000)
    assert len(machine.record().dx) == GOOD_STEPS
    assert machine["state"] == machine.names["cutting"]
    machine.feed(1)
    machine.run(instructions=20_000)
    assert len(machine.record().dx) == GOOD_STEPS + 1


def test_the_generator_cuts_lines_and_arcs_alone(machine):
    move, pause = line(MOVE, 2, 4, 6), bytes([PAUSE])
    cut(machine, GOOD + pause + move + pause + arc(CCW, 1, 9, 0, 4))
    generator = machine.names["generator"]
    written = [(step, value) for step, at, value in machine.writes if at == generator]
    ends = np.cumsum([GOOD_STEPS, 10])
    total = len(machine.record().dx)
    assert written == [
        *((0, 1), (ends[0], 0), (ends[0], 0), (ends[1], 0), (ends[1], 1), (total, 0)),
    ]


# --- rings and play -----------------------------------------------------------------------------


def test_the_rings_are_those_of_the_motors(image):
    """A, AB, B, BC, C, CA forwards, beside any pattern of the other motor."""
    order = [0b001, 0b011, 0b010, 0b110, 0b100, 0b101]
    tables = np.frombuffer(image.rom, np.uint8)[image.names["rings"] - ROM :][:256]
    for place, other in itertools.product(range(6), range(6)):
        x = order[place] | order[other] << 3
        y = order[place] << 3 | order[other]
        after, before = order[(place + 1) % 6], order[place - 1]
        assert tables[x] == after | order[other] << 3
        assert tables[64 + x] == before | order[other] << 3
        assert tables[128 + y] == after << 3 | order[other]
        assert tables[192 + y] == before << 3 | order[other]
    # A pattern that no ring has leads back to one.
    assert (RING[tables[:128] & 7] >= 0).all()
    assert (RING[tables[128:] >> 3] >= 0).all()


def with_play(steps, play):
    """Return the pulses on x and y, and J at each: the play of an axis before it turns back."""
    last, pulses = [1, 1], []
    for dx, dy, left in zip(steps.dx, steps.dy, steps.j, strict=True):
        axis = 0 if dx else 1
        sign = int(dx + dy)
        times = 1 + play[axis] * (sign != last[axis])
        last[axis] = sign
        pulses += [(int(dx), int(dy), int(left))] * times
    return [list(column) for column in zip(*pulses, strict=True)]


@given(
    st.lists(
        st.builds(
            arc,
            st.sampled_from([CW, CCW]),
            st.integers(1, 4),
            st.integers(2, 30),
            st.integers(0, 30),
            st.integers(1, 150),
        )
        | st.builds(
            line,
            st.sampled_from([LINE, MOVE]),
            st.integers(1, 4),
            st.integers(1, 30),
            st.integers(0, 9),
        ),
        min_size=1,
        max_size=5,
    ),
    st.tuples(st.integers(0, 25), st.integers(0, 255)),
)
@settings(max_examples=30)
def test_play_is_taken_up_where_an_axis_turns_back(image, blocks, play):
    data = b"".join(blocks) + b"\0"
    machine = Machine(image)
    machine.load(data, play)
    machine["pace"] = 0
    machine.run()
    record = machine.record()
    wanted = with_play(program(blocks_of(data)), play)
    assert [record.dx.tolist(), record.dy.tolist(), record.j.tolist()] == wanted


def test_play_is_taken_up_at_its_own_pace(image):
    machine = Machine(image, timed=True)
    machine.load(line(LINE, 2, 3, 0) + b"\0", (4, 0))
    machine.run()
    assert np.diff(machine.record().cycles)[:4] == pytest.approx(1000, abs=10)


# --- display ------------------------------------------------------------------------------------


def shown(machine):
    """Return the six digits that six interrupts of the timer light."""
    names, rom = machine.names, machine.memory
    shapes = {rom[names["shapes"] + v]: f"{v:X}" for v in range(16)}
    before, digits = len(machine.writes), {}
    for _ in range(6):
        machine.mpu.irq()
        machine.run(instructions=60)
    for (_, a, lit), (_, b, place) in itertools.pairwise(machine.writes[before:]):
        if a == names["segments"] and b == names["digits"]:
            digits[place] = shapes[lit]
    del machine.writes[before:]
    return "".join(digits[1 << place] for place in range(6))


def test_the_display_shows_j_then_the_number_of_the_next_block(machine):
    machine.load(line(LINE, 1, 120, 7) + arc(CCW, 1, 900, 0, 345) + b"\0")
    machine.feed(0)
    machine.run(instructions=5000)
    assert shown(machine) == "000001"
    machine.feed(1)
    machine.run(instructions=5000)
    assert shown(machine) == "000119"
    machine.feed(125)
    machine.run(instructions=20_000)
    assert shown(machine) == "000001"  # J = 1
    machine.feed(1)
    machine.run(instructions=5000)
    assert shown(machine) == "000002"
    machine.feed(2)
    machine.run(instructions=5000)
    assert shown(machine) == f"{machine.record().j[-1]:06d}"


def test_the_display_disturbs_no_step(machine):
    """Interrupts anywhere, in decimal mode too."""
    data = GOOD + arc(CW, 2, 300, 40, 500) + line(LINE, 3, 250, 249) + b"\0"
    machine.load(data)
    for count in itertools.cycle([7, 31, 52, 97]):
        if machine.run(instructions=count):
            break
        machine.mpu.irq()
    assert_same(machine.record(), program(blocks_of(data)))

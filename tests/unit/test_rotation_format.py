"""The rotation format: its bytes, what the controller makes of them, and that they are lossless."""

from itertools import groupby

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam import machines
from wedmcam.backends.zd065.rotation import encode
from wedmcam.controllers.zd065.data import POLAR
from wedmcam.controllers.zd065.rotation import rotate, square_count
from wedmcam.diag import Severity
from wedmcam.frontends.identify import identify
from wedmcam.frontends.zd065.compact import decode as decode_compact
from wedmcam.frontends.zd065.rotation import decode, read
from wedmcam.ir.program import BLOCK, Axis, Kind, Program

M = machines.builtin("zd065-rotation")
LINE = bytes.fromhex("01 02 30000000 020000")  # heading 30 degrees, 20 mm
ARC = bytes.fromhex(
    "21 00 00000000 00010000 02 90000000"
)  # NR1 from 0 degrees, R 10 mm, 90 degrees


def errors(found):
    return [d.code for d in found if d.severity is Severity.ERROR]


def program(*rows):
    blocks = np.zeros(len(rows), BLOCK)
    for k, (kind, turn, x, y, count) in enumerate(rows):
        axis = Axis.Y if kind == Kind.LINE and abs(x) <= abs(y) else Axis.X
        axis = Axis.SQUARE if turn else axis
        blocks[k] = (kind, turn, axis, 0, x, y, count, -1, 0)
    return Program(blocks)


def test_bytes_are_what_the_widths_say():
    assert (len(LINE), len(ARC)) == (9, 15)
    figure, found = read(LINE + ARC + b"\0", M, "a.zdr")
    assert not found
    assert figure["start"].tolist() == [30.0, 0.0]
    assert figure["size"].tolist() == [20_000, 10_000]
    assert figure["sweep"].tolist() == [0.0, 90.0]


def test_what_the_controller_makes_of_it_literally():
    made, found = decode(LINE + ARC + b"\0", M, "a.zdr", open_loop=True)
    assert not found
    b = made.blocks
    assert b["x"].tolist() == [17_321, 10_000, 0]  # 20 mm cos 30
    assert b["y"].tolist() == [10_000, 0, 0]
    assert b["count"].tolist() == [17_321, 14_142, 0]  # R sqrt 2 along two half sides
    assert str(made.spans[1]) == "a.zdr@0x0009"


@pytest.mark.parametrize("step", [90.0, 10.0, 360 / 7])
def test_copies_are_turned_from_the_original(step):
    figure, _ = read(LINE + ARC + b"\0", M, "a.zdr")
    n = 7
    blocks = rotate(figure, n, step)
    for k in range(n + 1):
        a = np.radians([30 + k * step, k * step])
        true = np.stack([[20_000, 10_000] * np.cos(a), [20_000, 10_000] * np.sin(a)])
        part = blocks[2 * k : 2 * k + 2]
        assert np.abs(np.stack([part["x"], part["y"]]) - true).max() <= 0.51


def test_36_copies_of_ten_degrees_come_back():
    f = np.zeros(1, POLAR)
    f[0] = (Kind.LINE, 0, 5.0, 8_716, 0)  # a side of a 36-gon
    b = rotate(f, 35, 10.0)
    assert (b["x"].sum(), b["y"].sum()) == (0, 0)
    data = bytes.fromhex("01 01 50000000 008716 00")
    turned, _ = decode(data, M, "a", copies=35, step=10.0, open_loop=True)
    assert turned.blocks["x"][:36].tolist() == b["x"].tolist()
    assert turned.blocks["kind"][36] == Kind.STOP


@pytest.mark.parametrize(
    ("start", "end", "radius", "count"),
    [
        (0, 360, 10_000, 56_569),  # 4 sqrt 2 R
        (0, 90, 10_000, 14_142),
        (45, 135, 10_000, 14_142),
        (-45, 0, 10_000, 7_071),
        (30, 60, 10_000, 4_142),
        (60, 30, 10_000, 4_142),
    ],
)
def test_count_along_the_inscribed_square(start, end, radius, count):
    got = square_count(np.array([float(start)]), np.array([float(end)]), np.array([radius]))
    assert got.tolist() == [count]


um = st.integers(-200_000, 200_000)


def ends(p):
    """Where blocks end as stepped, complex um."""
    motion = M.own_stepping.run(p.blocks)
    return np.cumsum(motion.dx + 1j * motion.dy)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.one_of(
            st.tuples(st.just(int(Kind.LINE)), st.just(0), um, um, st.just(0)),
            st.tuples(st.just(int(Kind.ARC)), st.sampled_from([-1, 1]), um, um,
                      st.integers(1, 300_000)),
        ),
        min_size=1,
        max_size=30,
    )
)  # fmt: skip
def test_any_program_of_the_cutting_format_goes_through(rows):
    """Law: its vertices stay where they are, but for the um that whole lengths and radii leave."""
    rows = [
        (k, t, x, y, min(j, int(5 * np.hypot(x, y))) if t else max(abs(x), abs(y)))
        for k, t, x, y, j in rows
        if np.hypot(x, y) > 50
    ]
    if not rows:
        return
    p = program(*rows, (Kind.STOP, 0, 0, 0, 0))
    data, found = encode(p, M)
    assert not errors(found), found
    back, found = decode(data, M, "a.zdr")
    assert not errors(found)
    there = ends(back)
    for end in ends(p):
        assert abs(there - end).min() <= 2.5
    assert abs(there[-1] - ends(p)[-1]) <= 2.5
    assert identify(data).format == "rotation"
    assert identify(data).last_address == len(data) - 1


def test_moves_and_controls_go_through():
    zd, machine = machines.builtin("zd065"), M
    raw = bytes.fromhex("30 21 00005000 00000000 028284 31 01 000500 000000 41 002000 001000 30 "
                        "03 000500 000000 00")  # fmt: skip
    p, found = decode_compact(raw, zd, "a.zd")
    assert not errors(found)
    data, found = encode(p, machine)
    assert not errors(found)
    back, _ = decode(data, machine, "a.zdr")
    # The arc ends some steps behind a full turn: it is two blocks.
    kinds = [[k for k, _ in groupby(which.blocks["kind"].tolist())] for which in (back, p)]
    assert kinds[0] == kinds[1]
    assert set(ends(back).tolist()) >= set(ends(p).tolist())


@pytest.mark.parametrize(
    ("data", "code"),
    [
        ("01 03 36000000 020000 00", "bad-angle"),
        ("01 99 10000000 020000 00", "bad-angle"),
        ("21 00 00000000 00010000 00 00000000 00", "bad-angle"),
        ("21 00 00000000 00010000 03 40000000 00", "bad-angle"),
        ("01 02 3000000A 020000 00", "bad-digit"),
        ("01 02 30000000 000000 00", "zero-count"),
        ("03 02 30000000 020000 00", "quadrant-contradicts"),
        ("21 00 00000000 00000001 02 90000000 00", "arc-too-small"),
        ("21 00 00000000 10000001 02 00000001 00", "over-limit"),
        ("01 02 30000000 02", "truncated"),
        ("77", "bad-instruction"),
    ],
)
def test_what_is_refused(data, code):
    _, found = decode(bytes.fromhex(data), M, "a.zdr")
    assert code in errors(found), found


def test_a_neighbouring_quadrant_is_repaired():
    made, found = decode(bytes.fromhex("02 02 30000000 020000 00"), M, "a.zdr")
    assert [d.code for d in found] == ["quadrant-repaired"]
    assert made.blocks["x"][0] == 17_321


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=80))
def test_any_bytes_are_taken(data):
    made, _ = decode(data, M, "a.zdr")
    read(data, M, "a.zdr")
    assert len(made.blocks) == len(made.spans)


def test_memory_holds_455_lines():
    assert (4096 - 1) // 9 == 455
    for n, over in ((455, False), (456, True)):
        p = program(*[(Kind.LINE, 0, 100, 50, 100)] * n, (Kind.STOP, 0, 0, 0, 0))
        data, found = encode(p, M)
        assert ("over-memory" in [d.code for d in found]) is over
        _, found = decode(data, M, "a")
        assert ("over-memory" in [d.code for d in found]) is over


def test_what_a_block_states():
    from wedmcam.frontends import describe_blocks

    assert describe_blocks(LINE + ARC + b"\0", M) == {
        "0x0000": "heading 30 deg, length 20.000 mm",
        "0x0009": "start 0 deg, R 10.000 mm, sweep 90 deg",
    }

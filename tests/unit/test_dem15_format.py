"""Job records of the DEM-15: what is written is read again, and nothing else is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.backends import encoder
from wedmcam.diag import FileSpan, has_errors
from wedmcam.formats import dem15
from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.machines import builtin, parse

UM, STEPS = builtin("dem15"), builtin("dem15-steps")


def read(text, machine=UM):
    return decoder("dem15")(text.encode() if isinstance(text, str) else text, machine, "x.d15")


def codes(text, machine=UM):
    return [(d.code, getattr(d.span, "line", None)) for d in read(text, machine)[1]]


PLACES = st.tuples(st.integers(0, 30_000), st.integers(0, 30_000))
ROWS = st.lists(
    st.tuples(PLACES, st.integers(1, 127), st.sampled_from([Kind.LINE, Kind.MOVE, Kind.PAUSE])),
    min_size=1,
    max_size=12,
)


def program_of(start, rows):
    blocks = np.zeros(len(rows) + 1, BLOCK)
    blocks["source"], at = -1, start
    for b, (place, speed, kind) in zip(blocks, rows, strict=False):
        if kind == Kind.PAUSE or place == at:
            b["kind"] = Kind.PAUSE
            continue
        b["kind"], b["x"], b["y"], b["count"] = kind, place[0] - at[0], place[1] - at[1], speed
        at = place
    blocks["kind"][-1] = Kind.STOP
    return Program(blocks, start, step_um=2.0)


@settings(max_examples=150, deadline=None)
@given(PLACES, ROWS, st.sampled_from(["", "exchange", "mirror_x", "mirror_y"]), st.booleans())
def test_what_is_written_is_read_again(start, rows, turned, in_steps):
    machine = STEPS if in_steps else UM
    if turned:
        machine = replace(machine, axes=replace(machine.axes, **{turned: True}))
    program = program_of(start, rows)
    data, found = encoder("dem15")(program, machine)
    assert not has_errors(found)
    assert max(map(len, data.decode().splitlines())) <= dem15.LINE
    again, found = read(data, machine)
    assert not found
    for name in ("kind", "x", "y", "count"):
        assert (again.blocks[name] == program.blocks[name]).all()
    assert again.step_um == 2.0


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=80) | st.text("0123456789 UMSTEP\n-.", max_size=80))
def test_no_bytes_raise(data):
    program, found = read(data)
    assert has_errors(found) or len(program.blocks)
    identify(data if isinstance(data, bytes) else data.encode())


def test_the_record_is_place_new_place_generator_and_speed():
    program, found = read("um\r\n\r\n0 10 40 20 100 200 64\r\np\r\n40 20 0 0 0 0 127\r\ne\r\n")
    assert not found
    assert program.blocks["kind"].tolist() == [Kind.LINE, Kind.PAUSE, Kind.MOVE, Kind.STOP]
    assert program.blocks["x"].tolist() == [20, 0, -20, 0]
    assert program.blocks["count"].tolist() == [64, 0, 127, 0]
    assert program.spans[2].line == 5
    halves, _ = read("STEPS\n0 10 40 20 100 200 64\nE\n", STEPS)
    assert halves.blocks["x"].tolist() == [40, 0]


REFUSED = {
    "": ["positions-unit"],
    "0 0 4 0 100 200 64\nE\n": ["positions-unit"],
    "STEPS\n0 0 4 0 100 200 64\nE\n": ["positions-unit"],
    "UM\n0 0 4 0 100 200 64\n": ["no-end"],
    "UM\nE\n0 0 4 0 100 200 64\n": ["after-end"],
    "UM\n0 0 4 0 100 200\nE\n": ["bad-job-record"],
    "UM\n0 0 -4 0 100 200 64\nE\n": ["bad-job-record"],
    "UM\nM0\nE\n": ["bad-job-record"],
    "UM\n0 0 65536 0 100 200 64\nE\n": ["over-limit"],
    "UM\n0 0 4 0 256 200 64\nE\n": ["over-limit"],
    "UM\n0 0 4 0 100 200 0\nE\n": ["speed-range"],
    "UM\n0 0 4 0 100 200 128\nE\n": ["speed-range"],
    "UM\n0 0 4 0 100 118 64\nE\n": ["generator-words"],
    "UM\n0 0 4 0 179 119 64\nE\n": ["generator-words"],
    "UM\n0 0 4 0 0 200 64\nE\n": ["generator-words"],
    "UM\n0 0 4 0 100 0 64\nE\n": ["generator-words"],
    "UM\n0 0 5 0 100 200 64\nE\n": ["place-step"],
    "UM\n4 0 4 0 100 200 64\nE\n": ["zero-count"],
    "UM\n0 0 4 0 100 200 64\n6 0 8 0 100 200 64\nE\n": ["place-jump"],
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_the_controller_could_not_run_is_refused_with_its_line(text):
    found = read(text)[1]
    assert {d.code for d in found} == set(REFUSED[text])
    assert len(read(text)[0].blocks) == 0
    for d in found:
        assert isinstance(d.span, FileSpan) or d.span.line == (
            3 if "jump" in d.code else 3 if d.code == "after-end" else 2
        )


#: Record behind "0 0 4 0 100 200 64" -> the column of what is wrong in it, and its length.
PLACES = {
    "4 0 65536 0 100 200 64": (5, 5),
    "4 0 8 0 100 200 128": (17, 3),
    "4 0 8 0 100 118 64": (13, 3),
    "4 0 8 0 179 119 64": (9, 3),
    "4 0 8 0 0 200 64": (9, 1),
    "4 0 8 5 100 200 64": (7, 1),
    "4 1 8 0 100 200 64": (3, 1),
    "4 0 4 0 100 200 64": (5, 1),
    "4 2 8 2 100 200 64": (3, 1),
    "6 0 8 0 100 200 64": (1, 1),
    "4 0 8 0 100 200": (1, 15),
}


@pytest.mark.parametrize("record", PLACES)
def test_a_finding_points_to_the_number_that_is_wrong(record):
    found = read(f"UM\n0 0 4 0 100 200 64\n  {record}\nE\n")[1]
    column, length = PLACES[record]
    assert (found[0].span.line, found[0].span.column) == (3, column + 2)
    assert found[0].span.length == length


def test_control_words_at_their_limits_are_taken():
    for t_i, t_p in ((1, 119), (178, 119), (255, 170), (255, 255), (0, 0)):
        assert not codes(f"UM\n0 0 4 0 {t_i} {t_p} 64\nE\n")
    assert dem15.current(255, 170) == pytest.approx(2.0)
    assert pytest.approx(7.0) == dem15.LEAST_T_P * dem15.VOLTS_T_P / dem15.CONTROL
    w = np.arange(1, 256)
    exact = dem15.current(w[:, None], w) > 2.0 + 1e-9
    assert (exact == dem15.too_much(w[:, None], w)).all()


def test_feeds_become_speeds_that_are_not_above_them():
    assert [dem15.speed_of(v * 15.75) for v in range(1, 128)] == list(range(1, 128))
    assert dem15.speed_of(2 * 15.75 - 0.01) == 1


def test_a_profile_with_a_generator_that_would_be_overloaded_writes_nothing():
    program = program_of((0, 0), [((50, 0), 64, Kind.LINE)])
    for more in ({"t_p": 118}, {"t_i": 255, "t_p": 120}):
        machine = replace(UM, vectors=replace(UM.vectors, **more))
        data, found = encoder("dem15")(program, machine)
        assert (data, [d.code for d in found]) == (b"", ["generator-words"])


def test_blocks_that_no_record_states_are_refused():
    program = program_of((0, 0), [((50, 0), 64, Kind.LINE), ((0, 50), 64, Kind.LINE)])
    blocks = program.blocks.copy()
    blocks["kind"][0], blocks["count"][1] = Kind.ARC, 200
    data, found = encoder("dem15")(replace(program, blocks=blocks), UM)
    assert data == b""
    assert {d.code for d in found} == {"not-in-format", "speed-range"}


def shifted(start, place, machine=UM):
    program = program_of(start, [(place, 64, Kind.LINE)])
    data, found = encoder("dem15")(program, machine)
    return data.decode().split("\n")[1:2], [d.code for d in found]


def test_drawings_beside_the_table_are_moved_by_whole_millimetres():
    assert shifted((0, 0), (32_500, 0)) == (["0 0 65000 0 100 200 64"], [])
    assert shifted((-1, 0), (700, 0)) == (["998 0 2400 0 100 200 64"], ["origin-moved"])
    assert shifted((-700, 0), (500, 5)) == (["600 0 3000 10 100 200 64"], ["origin-moved"])
    assert shifted((40_100, 0), (40_600, 0)) == (["200 0 1200 0 100 200 64"], ["origin-moved"])
    assert shifted((-1, 0), (32_499, 0)) == (["0 0 65000 0 100 200 64"], ["origin-moved"])
    assert shifted((-1, 0), (32_500, 0)) == ([], ["over-travel"])
    assert shifted((-1, 0), (32_500, 0), STEPS)[1] == ["origin-moved"]


def test_what_is_too_far_is_told_with_place_and_figure():
    program = program_of((0, -7), [((0, 40_000), 64, Kind.LINE)])
    (d,) = encoder("dem15")(program, UM)[1]
    assert "80.014 mm along Y, farthest at (0.000, 80.000) mm" in d.message
    assert "65.000 mm" in d.message
    unlimited = replace(UM, limits=replace(UM.limits, travel_um=None))
    (d,) = encoder("dem15")(program, unlimited)[1]
    assert "65.534 mm" in d.message  # 16 bits


def test_files_are_known_by_their_content():
    seen = identify(b"UM\n0 0 4 0 100 200 64\nE\n")
    assert (seen.format, seen.blocks, seen.certain) == ("dem15", 1, True)
    assert "positions in um" in seen.reason
    seen = identify(b"0 0 4 0 100 200 64\n")
    assert (seen.format, seen.certain) == ("dem15", False)
    assert identify(b"UM\n").format != "dem15"


def test_a_step_is_2_um():
    text = (
        'title = "t"\nformat = "dem15"\n[limits]\ncount_um = 9999\nline_um = 9999\narc_um = 9999\n'
    )
    for more in ("", "[axes]\nstep_um = 1\n"):
        assert [d.code for d in parse(text + more, "x")[1]] == ["profile-value"]
    assert parse(text + "[axes]\nstep_um = 2\n", "x")[0].vectors == UM.vectors
    wrong = text + '[axes]\nstep_um = 2\n[vectors]\nspeed = 128\nline_table = "mirror"\n'
    assert {d.code for d in parse(wrong, "x")[1]} == {"profile-value", "profile-key"}

"""ISO G-code in every spelling: the same path; and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from wedmcam import api
from wedmcam.controllers.pointwise import LineTable, run
from wedmcam.diag import Severity
from wedmcam.frontends import decoder
from wedmcam.ir.program import Kind
from wedmcam.machines import Iso, builtin

UM, MM = builtin("iso-um"), builtin("iso-mm")


def read(text, machine=UM):
    return decoder("iso")(text.encode(), machine, "a.nc")


def ends(program):
    motion = run(program.blocks, LineTable.ROTATE)
    return list(zip(np.cumsum(motion.dx).tolist(), np.cumsum(motion.dy).tolist(), strict=True))


def codes(found):
    return {d.code for d in found}


SAME = [
    "G91\nG01 X1000 Y2000\nG03 X-1000 Y-1000 I-1000 J0\nM02\n",
    "g91\ng1x1000y2000\ng3x-1000y-1000i-1000j0\nm2\n",
    "N1 G91 G01 X+1.000 Y2.\r\nN2 G3 X-1 Y-1. I-1. J0\r\nN3 M30\r\n".replace("X-1 ", "X-1.0 "),
    "%\n(PART ONE) ;by hand\nG90 G92 X500 Y700\nG1 X1500 Y2700\nG3 X500 Y1700 I-1000 J0\nM02\n%\n",
    "G91G01X1000Y2000\nG03X-1000Y-1000R-1000\nM02",
    "G91 G01 X1000\nX0 Y0\nM02",
    "G70 G91 G01 X.03937007874 Y.07874015748\nG71 G03 X-1.0 Y-1.0 I-1.0 J0\nM02",
]


@pytest.mark.parametrize("text", [*SAME[:5], SAME[6]])
def test_every_spelling_is_the_same_path(text):
    program, found = read(text)
    assert not [d for d in found if d.severity > Severity.NOTE], found
    assert ends(program)[-2:] == [(0, 1000), (0, 1000)] or ends(program)[-1] == (0, 1000)
    assert program.blocks["kind"][-1] == Kind.STOP


def test_modes_and_words_stay_until_changed():
    program, found = read("G90 G92 X0 Y0\nG01 X1000\nY500\nG91\nX10 Y10\nG90 X0 Y0\nM02\n")
    assert not found
    assert ends(program)[:-1] == [(1000, 0), (1000, 500), (1010, 510), (0, 0)]


def test_small_increments_add_up():
    # peers Q-02: 4000 moves of 0.1 um are 0.4 mm.
    program, _ = read("G91\n" + "G01 X0.0001\n" * 4000 + "M02\n")
    assert ends(program)[-1] == (400, 0)


@pytest.mark.parametrize(
    "text",
    [
        "G92 X0 Y0\nG90 G02 X0 Y0 I0.2 J10.\nM02",
        "G92 X0 Y0\nG90 G03 X0 Y0 I0.2 J10.\nM02",
        "G92 X-1965.409 Y127.282\nG90 G03 X-1965.409 Y127.282 I-9.091 J-6.282\nM02",
        "G92 X30. Y30.\nG90 G03 X30. Y30. I-4.24264 J-4.24264\nM02",
    ],
)
def test_an_end_that_is_the_start_is_a_full_circle(text):
    # Programs that field controllers turned into nothing, or into a full circle at some angles.
    program, found = read(text)
    assert not [d for d in found if d.severity is Severity.ERROR]
    b = program.blocks[0]
    motion = run(program.blocks, LineTable.ROTATE)
    assert (motion.dx[0], motion.dy[0]) == (0, 0)
    assert motion.steps[0] >= 8 * int(np.hypot(b["x"], b["y"]))


@pytest.mark.parametrize(
    ("text", "off"),
    [
        ("G92 X214.1053 Y15.4479\nG90 G3 X215.5 Y14.5 I1.3901 J0.5626\nM02", "11"),
        ("G92 X41.85 Y0.03\nG90 G3 X49.97 Y8.15 I0 J8.11\nM02", "10"),
        ("G92 X0 Y0\nG90 G2 X0 Y10. I0 J10.\nM02", "10000"),
        ("G92 X0 Y0\nG90 G3 X0 Y30. I0 J10.\nM02", "10000"),
    ],
)
def test_an_end_beside_the_circle_is_refused(text, off):
    program, found = read(text)
    wrong = [d for d in found if d.code == "iso-arc"]
    assert wrong
    assert f"{off}." in wrong[0].message
    assert not len(program.blocks[program.blocks["kind"] == Kind.ARC])


def test_the_rest_of_an_arc_is_gone_straight():
    program, found = read("G91\nG03 X-103 Y97 I-100 J0\nM02")
    assert codes(found) == {"iso-end"}
    assert ends(program)[-1] == (-103, 97)


@pytest.mark.parametrize(("radius", "turned"), [("1000", 0.25), ("-1000", 0.75)])
def test_radius_below_and_above_half_a_turn(radius, turned):
    program, found = read(f"G91\nG03 X-1000 Y1000 R{radius}\nM02")
    assert not found
    motion = run(program.blocks, LineTable.ROTATE)
    assert motion.steps[0] == pytest.approx(8000 * turned, abs=4)


@pytest.mark.parametrize(
    "text",
    [
        "G91 G03 X0 Y0 R1000",
        "G91 G03 X5000 Y0 R1000",
        "G91 G03 X10 Y0",
        "G91 G03 X10 Y0 R10 I5 J0",
        "G91 G01 X10 I5",
        "X10 Y10",
        "G91 G01 X10 X20",
        "G91 G01 G02 X10 Y5",
        "G91 G01 X--10",
        "G91 G01 X1.2.3",
        "12 G91 G01 X5",
        "G91 G01 X5 Z10",
        "G91 G41 D1 G01 X5",
        "G20 G91 G01 X5",
        "G01.5 X5",
        "",
        "HELLO",
    ],
)
def test_what_is_in_doubt_is_an_error(text):
    _, found = read(text + "\nM02\n")
    assert any(d.severity is Severity.ERROR for d in found), found


def test_whole_numbers_are_what_the_profile_says():
    text = "G91\nG01 X10 Y5\nM02"
    assert ends(read(text, UM)[0])[0] == (10, 5)
    assert ends(read(text, MM)[0])[0] == (10000, 5000)


def test_pauses_moves_and_words():
    program, found = read(
        "G91\nG01 X10\nM00\nG00 X5 Y5\nM00\nM50\nG01 X10\nM00\nG01 X7\n"
        "M01\nG01 X10 Y1\nM02\nG01 X9\n"
    )
    assert codes(found) == {"unknown-word", "after-end", "iso-skip"}
    kinds = [Kind(k).name for k in program.blocks["kind"]]
    assert kinds == ("LINE PAUSE MOVE PAUSE WORD LINE PAUSE MOVE PAUSE LINE STOP".split())
    assert program.words == ((4, "M50"),)


def test_spans_name_the_line():
    program, _ = read("G91\n\n(X)\n  G01 X10 Y1\nM02\n")
    assert program.spans[0].line == 4


def test_compile_writes_what_verify_proves(tmp_path):
    from pathlib import Path

    drawing = Path(__file__).parents[2] / "samples" / "key-punch.dxf"
    made = api.compile(drawing, to="iso", offset=0.1)
    assert made.ok
    assert api.verify(made.data, profile="iso-um", against=drawing, offset=0.1).ok
    assert b"-0\n" not in made.data.replace(b" ", b"\n")
    forgeries = [
        (b"G02", b"G03"),
        (b"G91", b"G90"),
        (b"I-", b"I"),
    ]
    text = made.data
    done = 0
    for old, new in forgeries:
        if old in text:
            done += 1
            assert not api.verify(
                text.replace(old, new, 1), profile="iso-um", against=drawing, offset=0.1
            ).ok
    rows = text.split(b"\n")
    middle = len(rows) // 2
    gone = b"\n".join(rows[:middle] + rows[middle + 1 :])
    assert not api.verify(gone, profile="iso-um", against=drawing, offset=0.1).ok
    assert done >= 2


LAYOUTS = [
    Iso(),
    Iso(coordinates="absolute"),
    Iso(unit="mm", integers="mm"),
    Iso(unit="mm", coordinates="absolute", rapid=True, code_digits=1, between=""),
    Iso(sign="always", width=8),
]


@pytest.mark.parametrize("iso", LAYOUTS, ids=str)
def test_every_layout_is_the_same_program(iso):
    from pathlib import Path

    text = (Path(__file__).parents[1] / "golden" / "plate.um.nc").read_bytes()
    program, _ = decoder("iso")(text, UM, "plate.nc")
    from wedmcam.backends import encoder

    machine = replace(UM, iso=iso)
    data, found = encoder("iso")(replace(program, origin=(-300, 20)), machine)
    assert not found
    assert b"-0 " not in data
    assert b"-0.000" not in data
    again, found = decoder("iso")(data, machine, "b.nc")
    assert not found
    assert np.array_equal(again.blocks, program.blocks)


@pytest.mark.parametrize("word", ["X1.5E-3", "X1.e1", "Y2E+1"])
def test_an_exponent_is_no_number(word):
    from wedmcam.operations import convert

    text = f"G90 G21\nG92 X0 Y0\nG01 {word} I0\nX5. Y0.\nM02\n".encode()
    there = convert.convert(text, to="3b", name="a.nc", whole_in="mm")
    assert not there.ok
    assert any(d.code == "iso-word" and word in d.message for d in there.findings)

import pytest

from wedmcam.diag import Severity
from wedmcam.frontends.zd065 import compact
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

M = builtin("zd065")
L, A, MOVE, D, DD, T = (
    Kind.LINE, Kind.ARC, Kind.MOVE, Kind.PAUSE, Kind.STOP, Kind.THREAD,
)  # fmt: skip


def read(text):
    program, found = compact.decode(bytes.fromhex(text), M, "k.zd")
    assert len(program.spans) == len(program.blocks)
    return program, found


def rows(program):
    return [
        tuple(int(b[k]) for k in ("kind", "turn", "axis", "x", "y", "count"))
        for b in program.blocks
    ]


def codes(found):
    return [d.code for d in found]


LINE = "01 017000 005000 "
ARC = "21 00009900 00000000 056003 "


def test_blocks():
    program, found = read(
        LINE
        + ARC
        + "13 00000003 00000004 000009 41 000000 000000".replace(
            "41 000000 000000", "42 000000 000007"
        )
        + "30 31 00"
    )
    assert rows(program) == [
        (L, 0, 0, 17000, 5000, 17000),
        (A, 1, 2, 9900, 0, 56003),
        (A, -1, 2, -3, -4, 9),
        (MOVE, 0, 1, 0, 7, 7),
        (D, 0, 0, 0, 0, 0),
        (D, 0, 0, 0, 0, 0),
        (DD, 0, 0, 0, 0, 0),
    ]
    assert found == []
    assert [str(s) for s in program.spans[:3]] == ["k.zd@0x0000", "k.zd@0x0007", "k.zd@0x0013"]


def test_thread_points():
    # behind a move 0x30 is the pause of the move; elsewhere it is a thread point of its own
    program, found = read("30" + LINE + "31 41 000005 000000 31 30 00")
    assert program.blocks["kind"].tolist() == [T, L, D, MOVE, D, T, DD]
    assert codes(found) == ["thread-mark"]


def test_ties_count_y():
    program, _ = read("02 000003 000003 00")
    assert rows(program)[0] == (L, 0, 1, -3, 3, 3)


def test_trailing_zeros():
    assert read(LINE + "00" * 50)[1] == []
    program, found = read(LINE + "00 00 17 00 18 00")
    assert len(program.blocks) == 2
    assert codes(found) == ["after-end"]
    assert (found[0].span.start, found[0].span.end) == (9, 12)


@pytest.mark.parametrize(
    ("text", "xy", "severity"),
    [
        ("04 000005 000000", (5, 0), Severity.WARNING),
        ("02 000005 000000", (-5, 0), Severity.WARNING),
        ("43 000000 000005", (0, -5), Severity.WARNING),
        ("24 00000005 00000000 000009", (5, 0), Severity.NOTE),
        ("11 00000005 00000000 000009", (5, 0), Severity.NOTE),
    ],
)
def test_repairs(text, xy, severity):
    program, found = read(text + "00")
    assert rows(program)[0][3:5] == xy
    assert [(d.code, d.severity) for d in found] == [("quadrant-repaired", severity)]


@pytest.mark.parametrize(
    ("text", "code", "at"),
    [
        ("01 01A000 005000 00", "bad-digit", 0),
        ("21 00009900 00000000 05600F 00", "bad-digit", 0),
        ("01 000000 000000 00", "zero-count", 0),
        ("21 00000005 00000000 000000 00", "zero-count", 0),
        ("21 00000001 00000000 000005 00", "arc-too-small", 0),
        ("21 10000001 00000000 000005 00", "over-limit", 0),
        ("21 08000000 08000000 000005 00", "over-limit", 0),
        (LINE + "05 000001 000001 00", "bad-instruction", 7),
        (LINE + "21 0000", "truncated", 7),
        ("", "no-blocks", None),
        ("00 00", "no-blocks", None),
    ],
)
def test_errors(text, code, at):
    program, found = read(text)
    errors = [d for d in found if d.severity is Severity.ERROR]
    assert codes(errors) == [code]
    if at is not None:
        assert errors[0].span.start == at
    assert all(b["kind"] in (L, DD) for b in program.blocks)


def test_several_errors():
    _, found = read("01 0A0000 000001" + LINE + "01 000000 0000FF 00")
    assert codes(found) == ["bad-digit", "bad-digit"]
    assert [d.span.start for d in found] == [0, 14]
    assert "0xff at 0x0014" in found[1].message


def test_warnings():
    assert codes(read(LINE)[1]) == ["no-end"]
    assert codes(read("21 00000100 00000000 000600 00")[1]) == ["more-than-a-turn"]
    assert read("21 00176776 00000000 999999 00")[1] == []


def test_memory():
    # 585 lines are 4,095 bytes and an end byte
    assert read(LINE * 585 + "00")[1] == []
    _, found = read(LINE * 586 + "00")
    assert codes(found) == ["over-memory"]
    assert found[0].message == "4103 bytes; the memory holds 4096: 2 loads"

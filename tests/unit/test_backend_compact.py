from dataclasses import replace

import pytest
from test_backend_b3 import MOVE, A, D, E, L, T, W, arc, line, program  # noqa: F401

from wedmcam.backends.zd065 import compact
from wedmcam.diag import Severity
from wedmcam.ir.program import Axis, Kind
from wedmcam.machines import Limits, builtin

M = builtin("zd065")
DD = Kind.STOP
SQ = Axis.SQUARE


def write(p, machine=M):
    data, found = compact.encode(p, machine)
    return data.hex(), found


def codes(found):
    return [d.code for d in found]


def test_one_contour():
    p = program(line(9900, 0), arc(9900, 0, 1, SQ, 56003), line(-9900, 0), DD)
    assert write(p) == (
        "01009900000000" + "210000990000000000056003" + "03009900000000" + "00",
        [],
    )


def test_controls():
    p = program(T, line(5, 0), D, line(0, -7, kind=MOVE), D, D, line(5, 0), DD, E)
    want = "30" + "01000005000000" + "31" + "44000000000007" + "30" + "31" + "01000005000000" + "00"
    assert write(p) == (want, [])


@pytest.mark.parametrize(
    ("row", "want"),
    [
        (arc(-3, -4, -1, SQ, 9), "130000000300000004000009"),
        (arc(10_000_000, 0, -1, SQ, 9), "141000000000000000000009"),
        (line(-3, 3), "02000003000003"),
        (line(17, 5, 0, 17000), "01017000005000"),
        (line(17, -5, SQ), "04000017000005"),
    ],
)
def test_blocks(row, want):
    assert write(program(row)) == (want + "00", [])


def test_count_axis():
    data, found = write(program(line(17, 5, 1, 5)))
    assert data == "0100001700000500"
    assert [(d.code, d.severity) for d in found] == [("count-axis", Severity.WARNING)]
    assert [d.severity for d in write(program(line(-3, 3, 0)))[1]] == [Severity.NOTE]


@pytest.mark.parametrize(
    ("row", "code"),
    [
        (line(1_000_000, 0), "over-limit"),
        (line(1, 0, 0, 2_000_000), "over-limit"),
        (line(1, 999_999, 0, 2), "over-limit"),
        (arc(10_000_001, 0, 1, SQ, 5), "over-limit"),
        (arc(8_000_000, 8_000_000, 1, SQ, 5), "over-limit"),
        (arc(5, 0, 1, SQ, 1_000_000), "over-limit"),
        (arc(2**62, 5, 1, SQ, 2**62), "over-limit"),
        (arc(5, 0, 1, 0, 20), "not-in-format"),
        (arc(0, 1, 1, SQ, 1), "arc-too-small"),
        (arc(5, 0, 1, SQ, 0), "zero-count"),
        (line(0, 0, 1, 0), "zero-count"),
        (line(5, 0, 1, 7), "endless-block"),
        (line(17, 5, 0, 100), "not-in-format"),
    ],
)
def test_refusals(row, code):
    data, found = write(program(line(5, 0), row, DD))
    assert data == ""
    assert codes(found) == [code]
    assert "block 2" in found[0].message


def test_nothing_after_the_stop():
    data, found = write(program(line(5, 0), DD, line(5, 0)))
    assert (data, codes(found)) == ("", ["not-in-format"])
    data, found = write(program(W, line(5, 0), words=((0, "M02"),)))
    assert (data, codes(found)) == ("", ["not-in-format"])


def test_memory():
    assert write(program(*[line(5, 0)] * 585))[1] == []
    _, found = write(program(*[line(5, 0)] * 586))
    assert codes(found) == ["over-memory"]
    assert "2 loads" in found[0].message


def test_travel():
    p = program(line(9900, 0), arc(9900, 0, 1, SQ, 56004))
    for size, want in ((19_800, []), (19_798, ["over-travel"] * 2)):
        machine = replace(M, limits=Limits(999_999, 999_999, 10_000_000, 4096, 0, (size, size)))
        assert codes(write(p, machine)[1]) == want

from dataclasses import replace

import numpy as np
import pytest

from wedmcam.backends import b3
from wedmcam.diag import EntityRef, Severity
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.machines import Layout, Limits, builtin

M = builtin("b3-compact")
L, A, MOVE, D, DD, E, W, T = (
    Kind.LINE, Kind.ARC, Kind.MOVE, Kind.PAUSE, Kind.STOP, Kind.END, Kind.WORD, Kind.THREAD,
)  # fmt: skip


def line(x, y, axis=None, count=None, kind=L):
    longer = 0 if abs(x) > abs(y) else 1
    axis = longer if axis is None else axis
    return (kind, 0, axis, x, y, max(abs(x), abs(y)) if count is None else count)


def arc(x, y, turn, axis, count):
    return (A, turn, axis, x, y, count)


def program(*rows, **more):
    blocks = np.zeros(len(rows), dtype=BLOCK)
    for i, row in enumerate(rows):
        row = row if isinstance(row, tuple) else (row, 0, 0, 0, 0, 0)
        for name, value in zip(("kind", "turn", "axis", "x", "y", "count"), row, strict=True):
            blocks[name][i] = value
    blocks["source"] = range(len(rows)) if more.get("sources") else -1
    return Program(blocks, **more)


HOLE = program(line(9900, 0), arc(9900, 0, 1, 1, 39600), line(-9900, 0), DD)


def write(p, machine=M, positions=None):
    data, found = b3.encode(p, machine, positions)
    return data.decode(machine.layout.encoding), found


def codes(found):
    return [d.code for d in found]


def test_published_hole():
    text, found = write(HOLE)
    assert found == []
    assert text == "B9900B0B9900GXL1\nB9900B0B39600GYNR1\nB9900B0B9900GXL3\nDD\n"


def test_columns():
    text, _ = write(HOLE, builtin("b3-columns"))
    assert text == (
        "B   9900 B      0 B 009900 GX L1\r\n"
        "B   9900 B      0 B 039600 GY NR1\r\n"
        "B   9900 B      0 B 009900 GX L3\r\n"
        "DD\r\n"
    )


def test_numbered():
    text, _ = write(replace(HOLE, origin=(-10, 20)), builtin("b3-numbered"))
    lines = text.split("\r\n")
    assert lines[0].startswith(";")
    assert lines[1:] == [
        "N   1: B   9900 B      0 B   9900 GX L1 ; 9.890 , 0.020",
        "N   2: B   9900 B      0 B  39600 GY NR1 ; 9.890 , 0.020",
        "N   3: B   9900 B      0 B   9900 GX L3 ; -0.010 , 0.020",
        "N   4: DD",
        "",
    ]


def test_positions_are_taken():
    positions = np.array([[1, 2], [-1, 0], [0, 0], [0, 0]])
    text, _ = write(HOLE, builtin("b3-numbered"), positions)
    ends = [t.split(";")[1].strip() for t in text.split("\r\n")[1:4]]
    assert ends == ["0.001 , 0.002", "-0.001 , 0.000", "0.000 , 0.000"]


@pytest.mark.parametrize(
    ("row", "text"),
    [
        (arc(-2000, 9000, 1, 1, 25440), "B2000B9000B25440GYNR2"),
        (arc(9000, -2000, -1, 0, 25440), "B9000B2000B25440GXSR4"),
        (arc(0, 9, -1, 0, 5), "B0B9B5GXSR1"),
        (arc(-9, 0, 1, 0, 5), "B9B0B5GXNR3"),
        (line(17000, 5000), "B17000B5000B17000GXL1"),
        (line(17, 5, 0, 17000), "B17000B5000B17000GXL1"),
        (line(0, 1, 1, 50000), "B0B50000B50000GYL2"),
        (line(-3, 3, 0), "B3B3B3GXL2"),
        (line(-3, -3, 1), "B3B3B3GYL3"),
        (line(-17, 5, Axis.SQUARE), "B17B5B17GXL2"),
    ],
)
def test_records(row, text):
    data, found = write(program(row))
    assert found == []
    assert data == text + "\nDD\n"


def test_ratio_that_is_not_whole():
    data, found = write(program(line(17, 5, 0, 100)))
    assert data == "B17B5B100GXL1\nDD\n"
    assert codes(found) == ["ratio-line"]


def test_count_axis_by_rule():
    data, found = write(program(line(17, 5, 1, 5)))
    assert data == "B17B5B17GXL1\nDD\n"
    assert [(d.code, d.severity) for d in found] == [("count-axis", Severity.WARNING)]
    data, found = write(program(line(-3, 3, 1)))
    assert data == "B3B3B3GXL2\nDD\n"
    assert [(d.code, d.severity) for d in found] == [("count-axis", Severity.NOTE)]
    mirrored = replace(M, line_table="mirror")
    assert write(program(line(-3, 3, 1)), mirrored) == ("B3B3B3GYL2\nDD\n", [])


def test_moves_and_stops():
    cut = [line(5, 0), arc(5, 0, 1, 1, 20), line(-5, 0)]
    p = program(*cut, D, line(7, 0, kind=MOVE), D, *cut, DD, E)
    text, found = write(p)
    assert found == []
    assert text.split() == [
        "B5B0B5GXL1", "B5B0B20GYNR1", "B5B0B5GXL3", "D", "B7B0B7GXL1", "D",
        "B5B0B5GXL1", "B5B0B20GYNR1", "B5B0B5GXL3", "DD", "E",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("rows", "words", "added"),
    [
        ([line(5, 0), line(7, 0, kind=MOVE), arc(5, 0, 1, 1, 20)], ["L", "D", "L", "D", "NR"], 1),
        ([line(7, 0, kind=MOVE)], ["D", "L", "D"], 1),
        ([line(7, 0, kind=MOVE), line(8, 0, kind=MOVE)], ["D", "L", "D", "L", "D"], 2),
        ([T, line(7, 0, kind=MOVE), T], ["D", "L", "D"], 0),
        ([D, line(7, 0, kind=MOVE), line(8, 0), line(8, 0)], ["D", "L", "D", "L", "L"], 1),
    ],
)
def test_pauses_are_added(rows, words, added):
    text, found = write(program(*rows, DD))
    got = [t if t[0] == "D" else "NR" if "NR" in t else "L" for t in text.split()]
    assert got == [*words, "DD"]
    assert sum(d.count for d in found) == added
    assert codes(found) == ["pause-added"] * bool(added)


def test_stop_is_added_once():
    assert write(program(line(5, 0)))[0].endswith("L1\nDD\n")
    assert write(program(line(5, 0), E))[0].endswith("L1\nE\n")
    assert write(program(DD, line(5, 0), line(5, 0)))[0].endswith("L1\nDD\n")
    assert write(program())[0] == "DD\n"


def test_lone_line_is_refused():
    data, found = write(program(line(5, 0), D, line(5, 0), D, line(5, 0), DD))
    assert data == ""
    assert codes(found) == ["lone-line"]
    assert "block 3" in found[0].message


@pytest.mark.parametrize(
    ("row", "code", "says"),
    [
        (line(1_000_000, 0), "over-limit", "1000.000 mm"),
        (line(1, 0, 0, 1_000_000), "over-limit", "1000.000 mm"),
        (line(0, -1_000_000, kind=MOVE), "over-limit", "1000.000 mm"),
        (line(10, 999_999, 0, 20), "over-limit", ""),
        (arc(5, 1_000_000, 1, 0, 5), "over-limit", ""),
        (arc(5, 0, 1, 0, 1_000_000), "over-limit", ""),
        (arc(2**62, -(2**62), 1, 0, 2**62), "over-limit", ""),
        (arc(5, 0, 1, Axis.SQUARE, 20), "not-in-format", "square"),
        (arc(1, 0, 1, 0, 1), "arc-too-small", "0.001 mm"),
        (arc(5, 0, 1, 0, 0), "zero-count", ""),
        (line(5, 0, 0, 0), "zero-count", ""),
        (line(5, 0, 1, 7), "endless-block", ""),
        (line(0, 0, 0, 7), "endless-block", ""),
    ],
)
def test_refusals(row, code, says):
    source = EntityRef("k.dxf", "2F", "LINE", "CUT")
    more = {"sources": (source,) * 3}
    data, found = write(program(line(5, 0), row, DD, **more))
    assert data == ""
    assert code in codes(found)
    assert found[0].severity is Severity.ERROR
    assert says in found[0].message
    assert "block 2" in found[0].message
    assert found[0].span == source


def test_words():
    p = program(W, line(5, 0), W, DD, words=((0, "M02"), (2, "T84")))
    assert write(p) == ("M02\nB5B0B5GXL1\nT84\nDD\n", [])
    for word in ("D", "N5", "B5", "two words", "; D"):
        data, found = write(program(W, line(5, 0), words=((0, word),)))
        assert (data, codes(found)) == ("", ["not-in-format"])


def test_limits_of_a_profile():
    small = replace(M, limits=Limits(999_999, 999_999, 999_999, blocks=3))
    assert codes(write(HOLE, small)[1]) == ["over-memory"]
    assert "2 loads" in write(HOLE, small)[1][0].message
    # the hole is 19.8 mm wide; it goes 9.9 mm to the right, then round
    for size, want in ((19_800, []), (19_799, ["over-travel"] * 2)):
        table = replace(M, limits=Limits(999_999, 999_999, 999_999, travel_um=(size, size)))
        assert codes(write(HOLE, table)[1]) == want


def test_travel_of_an_arc():
    # a quarter circle over the top: its apex at (0, 10 mm) counts, the other three do not
    quarter = program(arc(6000, 8000, 1, 0, 12_000))
    for width, height, want in (
        (12_000, 2000, []),
        (12_000, 1999, ["over-travel"]),
        (11_999, 2000, ["over-travel"]),
    ):
        limits = Limits(999_999, 999_999, 999_999, travel_um=(width, height))
        assert codes(write(quarter, replace(M, limits=limits))[1]) == want


def test_header_and_footer():
    layout = Layout(header=("; 键",), footer=("%",), encoding="gbk", eol="\r\n")
    data, _ = b3.encode(HOLE, replace(M, layout=layout))
    assert data.startswith("; 键\r\nB".encode("gbk"))
    assert data.endswith(b"DD\r\n%\r\n")

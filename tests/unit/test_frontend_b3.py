import numpy as np
import pytest

from wedmcam.diag import Severity
from wedmcam.frontends.b3 import reader as b3
from wedmcam.frontends.b3 import records
from wedmcam.frontends.text import plain
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin

M = builtin("b3-compact")
L, A, MOVE, D, DD, E, W = Kind.LINE, Kind.ARC, Kind.MOVE, Kind.PAUSE, Kind.STOP, Kind.END, Kind.WORD


def read(text, machine=M):
    data = text if isinstance(text, bytes) else text.encode()
    program, found = b3.decode(data, machine, "k.3b")
    assert len(program.spans) == len(program.blocks)
    return program, found


def rows(program):
    return [
        tuple(int(b[k]) for k in ("kind", "turn", "axis", "x", "y", "count"))
        for b in program.blocks
    ]


def codes(found):
    return [d.code for d in found]


PUBLISHED = [
    ("B9900B0B9900GXL1", (L, 0, 0, 9900, 0, 9900)),
    ("B9900B0B39600GYNR1", (A, 1, 1, 9900, 0, 39600)),
    ("B9900B0B9900GXL3", (L, 0, 0, -9900, 0, 9900)),
    ("BBB50000GYL2", (L, 0, 1, 0, 50000, 50000)),
    ("B17000B5000B17000GXL1", (L, 0, 0, 17000, 5000, 17000)),
    ("B17B5B17000GXL1", (L, 0, 0, 17, 5, 17000)),
    ("B2000B9000B25440GYNR2", (A, 1, 1, -2000, 9000, 25440)),
    ("B9000B2000B25440GXSR4", (A, -1, 0, 9000, -2000, 25440)),
]


@pytest.mark.parametrize(("text", "row"), PUBLISHED)
def test_published(text, row):
    program, found = read(text)
    assert found == []
    assert rows(program) == [row]


SPELLINGS = [
    "{x}\n{y}\n",
    "{x}\r\n{y}\r\n",
    "{x}\r{y}\r",
    "{x}{y}",
    "{x} {y}",
    "\ufeff{x}\n{y}",
    "N1{x}\nN2{y}",
    "N 1: {x}\n N 2: {y}\n",
    "  1\n".replace("1", "") + "\t{x}\t\n\n\n{y}\x1a",
    "{x};\n{y};\n",
    "{x} ; {y}",
    "N1 {x} N2 {y}",
]


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize(
    "pair",
    [
        ("B9900B0B39600GYNR1", "B9900B0B9900GXL3"),
        ("B 9900 B 0 B 39600 GY NR1", "B 9900 B 0 B 9900 G X L 3"),
        ("b9900b0b39600gynr1", "b9900bb9900gxl3"),
        ("B009900B000000B039600GYNR1", "B  9900B     0B009900 GX  L3"),
        ("B\t9900B  B39600\tGY N R 1", "B9900B0B9900GXL3"),
        ("Ｂ９９００Ｂ０Ｂ３９６００ＧＹＮＲ１", "Ｂ９９００Ｂ０Ｂ９９００ＧＸＬ３"),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "gb18030", "utf-16"])
def test_spellings(spelling, pair, encoding):
    text = spelling.format(x=pair[0], y=pair[1])
    if encoding == "utf-16":
        text = text.lstrip("\ufeff")
    if encoding == "gb18030" and "\ufeff" in text:
        return  # a mark that nobody writes
    program, found = read(text.encode(encoding))
    assert found == []
    assert rows(program) == [(A, 1, 1, 9900, 0, 39600), (L, 0, 0, -9900, 0, 9900)]


def test_latin_1():
    program, found = read("B1B2B2GYL1 ; L\xe4nge\n".encode("latin-1"))
    assert len(program.blocks) == 1
    assert codes(found) == ["text-skipped"]


def test_caxa_listing():
    text = """\
************************************
CAXAWEDM -Version 2.0 , Name : 键.3B
Conner R= 0.00000 , Offset F= 0.10000 ,Length= 82.204 mm
************************************
N   1: B   9900 B      0 B   9900 GX   L1  ;    9.900 ,    0.000
N   2: B   9900 B      0 B  39600 GY  NR1  ;    9.900 ,    0.000
N   3: B   9900 B      0 B   9900 GX   L3  ;    0.000 ,    0.000
N   4: DD
"""
    program, found = read(text.encode("gbk"))
    assert program.blocks["kind"].tolist() == [L, A, L, DD]
    assert codes(found) == ["text-skipped", "text-skipped"]
    assert [d.count for d in found] == [4, 3]
    assert "end coordinates" in found[1].message
    assert str(program.spans[1]) == "k.3b:6:8"
    assert codes(read(text.encode("gbk"), builtin("b3-numbered"))[1]) == ["text-skipped"]


def test_moves_and_control_words():
    text = "B5B0B5GXL1\nB5B0B5GXL3\nD\nB7B0B7GXL1\nD\nB5B0B20GYNR1\nD\nB5B0B20GYNR1\nDD\nE\n"
    program, found = read(text)
    assert found == []
    assert program.blocks["kind"].tolist() == [L, L, D, MOVE, D, A, D, A, DD, E]


@pytest.mark.parametrize(
    "text",
    [
        "DB5B0B5GXL1D\nDD",
        "D B5B0B5GXL1 D DD",
        "d\nN3 b5bb5gxl1\nN4 d\nN5 dd",
        "D 暂停\nB5B0B5GXL1D DD",
    ],
)
def test_control_words_anywhere(text):
    program, found = read(text)
    assert program.blocks["kind"].tolist() == [D, MOVE, D, DD]
    assert set(codes(found)) <= {"text-skipped"}


def test_profile_words():
    from dataclasses import replace

    from wedmcam.machines import Words

    machine = replace(M, words=Words("A", "T", "END"))
    program, found = read("A\nB5B0B5GXL1\nA\nT\nEND\nD\n", machine)
    assert program.blocks["kind"].tolist() == [D, MOVE, D, DD, E, W]
    assert program.words == ((5, "D"),)
    assert codes(found) == ["unknown-word"]


def test_unknown_word_is_kept():
    program, found = read("M02\nB5B0B5GXL1\nt84\n")
    assert program.words == ((0, "M02"), (2, "T84"))
    assert program.blocks["kind"].tolist() == [W, L, W]
    assert codes(found) == ["unknown-word"]
    assert found[0].count == 2
    assert found[0].severity is Severity.WARNING


@pytest.mark.parametrize(
    ("text", "row", "severity"),
    [
        ("B5B0B20GYNR4", (A, 1, 1, 5, 0, 20), Severity.NOTE),
        ("B5B0B20GYNR2", (A, 1, 1, -5, 0, 20), Severity.NOTE),
        ("B0B5B20GXNR1", (A, 1, 0, 0, 5, 20), Severity.NOTE),
        ("B0B5B20GXNR3", (A, 1, 0, 0, -5, 20), Severity.NOTE),
        ("B5B0B20GYSR1", (A, -1, 1, 5, 0, 20), Severity.NOTE),
        ("B0B5B20GXSR2", (A, -1, 0, 0, 5, 20), Severity.NOTE),
        ("B5B0B5GXL4", (L, 0, 0, 5, 0, 5), Severity.WARNING),
        ("B0B5B5GYL1", (L, 0, 1, 0, 5, 5), Severity.WARNING),
        ("B5B0B5GXL2", (L, 0, 0, -5, 0, 5), Severity.WARNING),
        ("B0B5B5GYL3", (L, 0, 1, 0, -5, 5), Severity.WARNING),
        ("BBB5GYL1", (L, 0, 1, 0, 5, 5), Severity.WARNING),
    ],
)
def test_repairs(text, row, severity):
    program, found = read(text)
    assert rows(program) == [row]
    assert [(d.code, d.severity) for d in found] == [("quadrant-repaired", severity)]


@pytest.mark.parametrize("turn", ["NR", "SR"])
def test_right_quadrant_on_axes_is_silent(turn):
    right = {"NR": "1234", "SR": "4123"}[turn]
    for (x, y), q in zip([(5, 0), (0, 5), (5, 0), (0, 5)], right, strict=True):
        assert read(f"B{x}B{y}B20GX{turn}{q}")[1] == []


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("B1000000B0B1GXL1", "over-limit", "1000.000 mm"),
        ("B1B0B1000000GXL1", "over-limit", "J is 1000.000 mm"),
        ("B0B12345678901234567890B5GYNR2", "over-limit", ""),
        ("B5B0B0GXL1", "zero-count", ""),
        ("BBBGXL1", "zero-count", ""),
        ("B0B0B5GXNR1", "arc-too-small", "own centre"),
        ("B1B0B5GXNR1", "arc-too-small", "0.001 mm"),
        ("B5B0B5GYL1", "endless-block", ""),
        ("B1B2B3B4GXL1", "unsupported-4b", "4B"),
        ("B1B2B3B4DGXNR1", "unsupported-4b", "4B"),
        ("B 1 B 2 B 3 B 4 DD GX NR1", "unsupported-4b", "4B"),
        ("B1B2BGXL1B3", "bad-record", ""),
        ("B-1B2B3GXL1", "bad-record", "sign"),
        ("B1.5B2B3GXL1", "bad-record", "point"),
        ("B1B2GXL1", "bad-record", "2 of the three B"),
        ("B1 2B3B4GXL1", "bad-record", "blank inside"),
        ("B1B2B3GZL1", "bad-record", "GX or GY"),
        ("B1B2B3GXL5", "bad-record", "quadrant"),
        ("B1B2B3GXL12", "bad-record", "quadrant"),
        ("B1B2B3GXXR1", "bad-record", ""),
        ("B1B2\nB3GXL1", "bad-record", ""),
        ("B100", "bad-record", ""),
        ("", "no-blocks", ""),
        ("hello\nD\n", "no-blocks", ""),
        ("; B1B1B1GYL1\n", "no-blocks", ""),
    ],
)
def test_errors(text, code, says):
    good = "B9B0B9GXL1\n"
    for whole in (text, good + text + "\n" + good) if code != "no-blocks" else (text,):
        program, found = read(whole)
        errors = [d for d in found if d.severity is Severity.ERROR]
        assert code in codes(errors)
        assert any(says in d.message for d in errors)
        if whole != text:
            assert rows(program).count((L, 0, 0, 9, 0, 9)) == 2
            assert str(errors[0].span).startswith("k.3b:2:")


def test_errors_are_listed_then_counted():
    _, found = read("B5B0B0GXL1\n" * 50)
    assert len(found) == 20
    assert sum(d.count for d in found) == 50
    assert str(found[3].span) == "k.3b:4:1"


def test_warnings():
    assert codes(read("B17B5B5GYL1")[1]) == ["count-axis"]
    assert codes(read("B5B5B5GXL1")[1]) == ["count-axis"]
    assert read("B5B5B5GYL1\nB5B5B5GXL2\nB5B5B5GYL3\nB5B5B5GXL4")[1] == []
    assert codes(read("B100B0B404GYNR1")[1]) == ["more-than-a-turn"]
    assert read("B9900B0B39600GYNR1")[1] == []
    assert codes(read("B5B0B5GXL1\nDD\nB5B0B5GXL1")[1]) == ["after-end"]
    assert codes(read("B5B0B5GXL1\nT = D\nB5B0B5GXL1")[1]) == [
        "text-skipped",
        "hidden-control-word",
    ]


def test_comments():
    program, found = read(
        "; B1B0B1GXL1 B2B0B2GXL1\nB3B0B3GXL1\n(B4B0B4GXL1)\n(ok) B5B0B5GXL1 ; D\n"
    )
    assert [r[3] for r in rows(program)] == [3, 5]
    assert {d.code: d.count for d in found} == {"commented-record": 3, "text-skipped": 3}


def test_spans_are_lazy_and_right():
    program, _ = read("B1B0B1GXL1 B2B0B2GXL1\r\n\r\n  B3B0B3GXL1\rD")
    assert [str(s) for s in program.spans] == ["k.3b:1:1", "k.3b:1:12", "k.3b:3:3", "k.3b:4:1"]
    assert program.spans[0].length == 10
    assert program.spans[-1] == program.spans[3]
    assert program.spans[1:3] == (program.spans[1], program.spans[2])


@pytest.mark.parametrize("eol", ["\n", " ", "\r\n", " ; 1.000 , -2.000\n"])
def test_windows(monkeypatch, eol):
    """Windows of any length find the same records as one."""
    text = eol.join(f"B{i}B{7 * i}B{i % 9 + 1}GXNR{i % 4 + 1}" for i in range(60)).encode()
    codes_ = plain(text).codes
    whole = records.find_records(codes_)
    assert len(whole.start) == 60
    for window in (40, 64, 200):
        monkeypatch.setattr(records, "WINDOW", window)
        part = records.find_records(codes_)
        for name in ("start", "end", "x", "y", "count", "axis", "code", "inked"):
            assert np.array_equal(getattr(part, name), getattr(whole, name)), (name, window)

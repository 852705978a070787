"""Laws of the program formats: round trips, error injection, and no exception on any bytes."""

import re
from dataclasses import replace
from itertools import chain

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from wedmcam.backends import encoder
from wedmcam.controllers.pointwise import LineTable
from wedmcam.diag import has_errors
from wedmcam.formats import compact as compact_rules
from wedmcam.frontends import decoder
from wedmcam.frontends.b3 import records
from wedmcam.frontends.identify import identify
from wedmcam.frontends.text import plain
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.machines import Layout, Words, builtin, names

B3 = [n for n in names() if builtin(n).format == "3b"]
FIELDS = ("kind", "turn", "axis", "x", "y", "count")

six = st.one_of(st.integers(0, 9), st.integers(0, 999_999))
sign = st.sampled_from([-1, 1])


@st.composite
def line(draw, format_, kind=Kind.LINE):
    x, y = draw(st.tuples(six, six).filter(any))
    x, y = draw(sign) * x, draw(sign) * y
    if format_ == "3b":
        axis = int(LineTable.ROTATE.line_count(np.array([x]), np.array([y]))[0][0])
    else:
        axis = int(compact_rules.line_count(np.array([x]), np.array([y]))[0][0])
    return [(kind, 0, axis, x, y, max(abs(x), abs(y)))]


@st.composite
def arc(draw, format_):
    large = six if format_ == "3b" else st.one_of(six, st.integers(0, 7_000_000))
    x, y = draw(st.tuples(large, large).filter(lambda p: p[0] ** 2 + p[1] ** 2 >= 2))
    r = int((x * x + y * y) ** 0.5)
    count = draw(st.integers(1, min(4 * r, 999_999)))
    axis = draw(st.sampled_from([0, 1])) if format_ == "3b" else int(Axis.SQUARE)
    return [(Kind.ARC, draw(sign), axis, draw(sign) * x, draw(sign) * y, count)]


def control(kind):
    return [(kind, 0, 0, 0, 0, 0)]


@st.composite
def programs(draw, format_):
    """Canonical programs: what a decoder of the format can give."""
    cut = st.lists(st.one_of(line(format_), arc(format_)), min_size=2, max_size=5)
    move = line(format_, Kind.MOVE)
    pause, thread = control(Kind.PAUSE), control(Kind.THREAD)
    rows = list(chain(*draw(cut)))
    if format_ == "compact" and draw(st.booleans()):
        rows = thread + rows
    for _ in range(draw(st.integers(0, 3))):
        between = draw(st.sampled_from(["move", "pause", "bare"]))
        if between == "pause":
            rows += pause
        elif between == "move" or format_ == "3b":
            rows += pause + draw(move) + pause
        else:
            rows += draw(move)
        rows += chain(*draw(cut))
    rows += control(Kind.STOP)
    if format_ == "3b":
        rows += control(Kind.END) * draw(st.integers(0, 1))
    blocks = np.zeros(len(rows), dtype=BLOCK)
    blocks["source"] = -1
    for i, row in enumerate(rows):
        for name, value in zip(FIELDS, row, strict=True):
            blocks[name][i] = value
    return Program(blocks)


def rows(program):
    return [tuple(int(b[k]) for k in FIELDS) for b in program.blocks]


layouts = st.builds(
    Layout,
    after_b=st.sampled_from(["", " ", "  ", "\t"]),
    between=st.sampled_from(["", " ", "   "]),
    width=st.integers(1, 9),
    count_digits=st.integers(1, 6),
    number_width=st.integers(0, 5),
    after_number=st.sampled_from(["", " ", ":", ": "]),
    header=st.sampled_from([(), ("; B X B Y",), ("****", "; D")]),
    footer=st.sampled_from([(), ("%",)]),
    end_coordinates=st.booleans(),
    eol=st.sampled_from(["\n", "\r\n", "\r"]),
)
words = st.sampled_from([Words(), Words("A", "T", "END"), Words("P", "STOP", "X")])


@settings(deadline=None)
@given(program=programs("3b"), layout=layouts, control_words=words)
def test_b3_round_trip(program, layout, control_words):
    machine = replace(builtin("b3-compact"), layout=layout, words=control_words)
    data, found = encoder("3b")(program, machine)
    assert found == []
    again, found = decoder("3b")(data, machine, "k.3b")
    assert found == []
    assert rows(again) == rows(program)
    assert encoder("3b")(again, machine) == (data, [])


@settings(deadline=None)
@given(program=programs("compact"))
def test_compact_round_trip(program):
    machine = builtin("zd065")
    data, found = encoder("compact")(program, machine)
    assert found == []
    again, found = decoder("compact")(data, machine, "k.zd")
    assert found == []
    assert rows(again) == rows(program)
    assert encoder("compact")(again, machine) == (data, [])
    assert identify(data).format == "compact"
    assert identify(data).last_address == len(data) - 1


@settings(deadline=None)
@given(program=programs("3b"), one=st.sampled_from(B3), other=st.sampled_from(B3))
def test_layouts_say_the_same(program, one, other):
    data, _ = encoder("3b")(program, builtin(one))
    again, found = decoder("3b")(data, builtin(other), "k.3b")
    assert not has_errors(found)
    assert rows(again) == rows(program)
    assert identify(data).blocks == sum(r[0] <= Kind.MOVE for r in rows(program))


@settings(deadline=None)
@given(program=programs("3b"), data=st.data())
def test_damaged_b3_is_noticed(program, data):
    """A character lost or changed gives other blocks or a finding, never silence."""
    machine = builtin("b3-compact")
    text, _ = encoder("3b")(program, machine)
    at = data.draw(st.integers(0, len(text) - 1))
    new = data.draw(st.sampled_from([b"", b"B", b"7", b"G", b"-", b"?", b"L"]))
    damaged = text[:at] + new + text[at + 1 :]
    again, found = decoder("3b")(damaged, machine, "k.3b")
    same = re.sub(rb"\s", b"", damaged) == re.sub(rb"\s", b"", text)
    zeros = re.sub(rb"B0+(?=B)", b"B", damaged) == re.sub(rb"B0+(?=B)", b"B", text)
    blank = re.search(rb"B0*B0*B", damaged)  # X = Y = 0: the length is J, which may be the same
    assert same or zeros or blank or found or rows(again) != rows(program)


@settings(deadline=None)
@given(program=programs("compact"), data=st.data())
def test_damaged_compact_is_noticed(program, data):
    machine = builtin("zd065")
    good, _ = encoder("compact")(program, machine)
    at = data.draw(st.integers(0, len(good) - 1))
    value = data.draw(st.integers(0, 255).filter(lambda b: b != good[at]))
    damaged = good[:at] + bytes([value]) + good[at + 1 :]
    again, found = decoder("compact")(damaged, machine, "k.zd")
    assert found or rows(again) != rows(program)


pieces = st.one_of(
    st.sampled_from(
        ["B", "G", "X", "Y", "L", "N", "R", "S", "D", "DD", "E", "1", "4", "0", "99999999999999",
         " ",
         "\n", "\r", ";", "(", ")", "N1", "//", "#", ",", ".", "-", "GXL1", "GYNR2", "B1B2B3GXL1",
         "B5B5B5GYL3", " ; 1.0 , 2.0", "键", "Ｂ", "\x00", "\x1a", "\ufeff", "B1B2B3B4DGXNR1"]
    ),
    st.text(max_size=3),
)  # fmt: skip


@settings(deadline=None)
@given(text=st.lists(pieces, max_size=40).map("".join), name=st.sampled_from(B3))
def test_any_text(text, name):
    for encoding in ("utf-8", "gb18030", "utf-16"):
        data = text.encode(encoding, "replace")
        program, found = decoder("3b")(data, builtin(name), "k.3b")
        assert len(program.spans) == len(program.blocks)
        assert [s.line >= 1 and s.column >= 1 for s in program.spans] == [True] * len(program.spans)
        assert len(program.blocks) or found or not text.strip()
        identify(data)
        again, _ = encoder("3b")(program, builtin(name))
        if again and not has_errors(found):
            assert not has_errors(decoder("3b")(again, builtin(name), "k.3b")[1])


@settings(deadline=None)
@given(data=st.binary(max_size=60))
def test_any_bytes(data):
    for name in ("b3-compact", "zd065"):
        machine = builtin(name)
        program, found = decoder(machine.format)(data, machine, "k")
        assert len(program.blocks) or found
        list(program.spans)
    identify(data)


instructions = st.sampled_from([0x01, 0x04, 0x11, 0x24, 0x30, 0x31, 0x41, 0x00])


@settings(deadline=None)
@given(data=st.lists(st.tuples(instructions, st.binary(max_size=12)), max_size=6))
def test_nearly_compact_bytes(data):
    raw = b"".join(bytes([code]) + bytes(b & 0x77 for b in rest) for code, rest in data)
    machine = builtin("zd065")
    program, found = decoder("compact")(raw, machine, "k")
    if not has_errors(found):
        again, more = encoder("compact")(program, machine)
        assert not has_errors(more)
        assert rows(decoder("compact")(again, machine, "k")[0])[: len(program.blocks)] == rows(
            program
        )
    identify(raw)


SLOW = re.compile(
    rb"B *([0-9]*) *B *([0-9]*) *B *([0-9]*) *G *([XY]) *(L|N *R|S *R) *([1-4])(?![0-9])"
)


@settings(deadline=None)
@given(text=st.lists(pieces, max_size=40).map("".join))
@example(text="B\nB1B2B3GXL1")  # a B on the line before makes no 4B
def test_records_against_a_slow_search(text):
    """The array search finds what one regular expression finds."""
    codes = plain(text.encode("utf-8", "replace")).codes
    slow = [
        (m.start(), m.end(), int(m[1] or 0), int(m[2] or 0), int(m[3] or 0))
        for m in SLOW.finditer(codes)
        if not re.search(rb"B *([0-9][0-9 ]*)?\Z", codes[: m.start()])
    ]
    fast = records.find_records(codes)
    got = list(
        zip(*(getattr(fast, k).tolist() for k in ("start", "end", "x", "y", "count")), strict=True)
    )
    assert [(a, b) for a, b, *_ in got] == [(a, b) for a, b, *_ in slow]
    for one, two in zip(got, slow, strict=True):
        assert all(p == q or q >= 10**12 for p, q in zip(one[2:], two[2:], strict=True))

"""The routines of the command line of Eindhoven's terminal, as laws over whatever is typed."""

from hypothesis import given
from hypothesis import strategies as st

from wedmcam.controllers.eindhoven.terminal import (
    BACKSPACE,
    BEL,
    CANCEL,
    CORRECTIONS,
    DELETE,
    LONGEST,
    RETYPE,
    TERMINATORS,
    Buffer,
    Line,
    Lost,
    getnum,
    gnumci,
    gnumhx,
    normal,
    screen,
    skip,
    take,
)

PRINTING = st.integers(0x20, 0x7E)
#: What may be typed before a line is ended: mostly characters, some corrections, some rubbish.
TYPED = st.lists(
    st.one_of(
        PRINTING, PRINTING, st.sampled_from(CORRECTIONS), st.sampled_from((BACKSPACE, DELETE)),
        st.integers(0, 255).filter(lambda code: code not in TERMINATORS),
    ),
    max_size=150,
)  # fmt: skip
DATA = st.binary(max_size=LONGEST).map(lambda data: data.replace(b"\0", b" "))


def typed(codes, line=None):
    """Return a line, and all that was sent back."""
    line, echo = line or Line(), b""
    for code in codes:
        line, sent = take(line, code)
        echo += sent
    return line, echo


def corrected(codes, before=b""):
    """Return the line as a person counts it: the independent model."""
    held = []
    for code in codes:
        if code in (BACKSPACE, DELETE):
            held = held[:-1]
        elif code == CANCEL:
            held = []
        elif code == RETYPE:
            held = held or list(before)
        elif 0x20 <= code <= 0x7E and len(held) < 64:
            held = [*held, code]
    return bytes(held)


def test_four_characters_correct_and_two_end_a_line_of_64():
    assert LONGEST == 64
    assert len(set(CORRECTIONS)) == 4
    assert len(set(TERMINATORS)) == 2
    for end in TERMINATORS:
        line, echo = typed([*b"G", end])
        assert (line.data, line.closed, echo) == (b"G", True, b"G\r\n")


@given(TYPED, st.binary(max_size=20).map(lambda data: bytes(0x20 + b % 0x5F for b in data)))
def test_typing_with_corrections_is_typing_the_corrected_line(codes, before):
    line, echo = typed(codes, Line(before=before))
    assert line.data == corrected(codes, before)
    again, plain = typed(line.data)
    assert again.data == line.data == plain
    assert again.lost is Lost.NONE
    assert not line.closed
    # What stands on the last line of the screen is what the buffer holds.
    assert screen(echo)[-1].replace("<BEL>", "").endswith(line.data.decode("ascii"))
    assert len(line.data) <= LONGEST


@given(TYPED)
def test_a_character_that_is_not_taken_rings_and_is_remembered_until_a_correction(codes):
    line, _ = typed(codes)
    since = max((i for i, code in enumerate(codes) if code in CORRECTIONS), default=-1)
    held = len(typed(codes[: since + 1])[0].data)
    strange = [i for i, code in enumerate(codes[since + 1 :]) if not 0x20 <= code <= 0x7E]
    fits = held + len(codes) - since - 1 - len(strange) <= LONGEST
    assert (line.lost is Lost.NONE) == (fits and not strange)
    for code in (0, BEL, 0x1B, 0x80, 0xFF):
        assert take(Line(b"1"), code)[1] == bytes((BEL,))


def test_the_65th_character_and_a_correction_at_the_beginning_only_ring():
    full, _ = typed(b"1" * 64)
    more, sent = take(full, ord("2"))
    assert (more.data, sent) == (full.data, b"\a")
    assert (more.lost, more.lost_at) == (Lost.LENGTH, 64)
    assert take(more, BACKSPACE)[0] == Line(b"1" * 63)
    for code in (BACKSPACE, DELETE, CANCEL):
        assert take(Line(), code) == (Line(), b"\a")
    assert take(Line(before=b"G"), RETYPE) == (Line(b"G", b"G"), b"^R\r\nG")


@given(st.binary(max_size=80))
def test_normal_makes_capitals_and_nothing_else(data):
    assert normal(data) == data.upper()
    assert normal(normal(data)) == normal(data)


@given(DATA, st.integers(0, LONGEST))
def test_gnumci_gives_all_characters_and_then_blanks(data, at):
    at = min(at, len(data))
    buffer, codes = Buffer(data, at), []
    for _ in range(len(data) - at + 2):
        code, buffer = gnumci(buffer)
        codes.append(code)
    assert bytes(codes) == data[at:] + b"  "
    assert buffer.pointer == len(data)


@given(DATA, st.integers(0, LONGEST))
def test_skip_stops_at_the_first_character_that_is_none(data, at):
    at = min(at, len(data))
    carry, buffer = skip(Buffer(data, at))
    rest = data[at:].lstrip(b" ,")
    assert buffer.data[buffer.pointer :] == rest
    assert carry == bool(rest)


@given(st.integers(0, 10**12), st.text("0", max_size=3), st.sampled_from([b"", b" ", b",", b"X"]))
def test_getnum_and_gnumhx_read_a_number_and_stop_behind_it(value, zeros, behind):
    for read, text in ((getnum, f"{zeros}{value}"), (gnumhx, f"{zeros}{value:X}")):
        data = text.encode() + behind
        number, buffer = read(Buffer(data))
        assert number.value == value % 0x10000
        assert number.overflows == (value > 0xFFFF)
        assert number.digits == len(text)
        assert data[buffer.pointer :] == behind


def test_what_begins_with_no_digit_is_no_number():
    for data in (b"", b" 1", b"-1", b"X"):
        for read in (getnum, gnumhx):
            number, buffer = read(Buffer(data))
            assert (number.digits, buffer.pointer) == (0, 0)
    assert gnumhx(Buffer(b"ffff"))[0].digits == 0  # NORMAL comes first

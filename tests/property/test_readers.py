"""Readers take any bytes: they return findings and never raise."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.machines import default
from wedmcam.offsets import decode

ISO = st.text("GXYIJRMNDF0123456789+-. \n();/%", max_size=120).map(str.encode)
B3 = st.text("BGXYLSNRDE0123456789 \n;", max_size=120).map(str.encode)
ANY = st.one_of(st.binary(max_size=120), ISO, B3)


@pytest.mark.parametrize("format_", ["3b", "iso", "compact", "rotation", "compensation"])
@settings(max_examples=60, deadline=None)
@given(data=ANY)
def test_no_reader_raises(format_, data):
    program, found = decoder(format_)(data, default(format_), "any")
    assert len(program.spans) == len(program.blocks)
    assert all(d.message for d in found)
    identify(data)


MOTION = st.builds(
    lambda code, x, y, i, j: f"G0{code} X{x} Y{y}" + (f" I{i} J{j}" if code > 1 else ""),
    *(st.integers(1, 3), *(st.integers(-3000, 3000) for _ in range(4))),
)
LINES = st.lists(st.one_of(MOTION, st.sampled_from(["M00", "G40", "G41", "D2", "G42 D1", "M50"])))


@settings(max_examples=150, deadline=None)
@given(lines=LINES, offset=st.floats(0, 2000))
def test_outlines_are_offset_or_refused(lines, offset):
    text = "\n".join(["G91", "G41 D1 G01 X3000 Y0", *lines, "G40 G01 X0 Y5000", "M02"])
    program, found = decode(text.encode(), default("iso"), "any", {1: offset}.get)
    assert len(program.spans) == len(program.blocks)
    assert all(d.message for d in found)


@settings(max_examples=100, deadline=None)
@given(data=ISO)
def test_iso_words_in_any_order_are_read_or_refused(data):
    program, found = decoder("iso")(b"G91G01X10Y5\n" + data, default("iso"), "any.nc")
    assert len(program.blocks) or found

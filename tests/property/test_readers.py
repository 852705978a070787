"""Readers take any bytes: they return findings and never raise."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.machines import default
from wedmcam.targets.g41 import decode

ISO = st.text("GXYIJRMNDF0123456789+-. \n();/%", max_size=120).map(str.encode)
B3 = st.text("BGXYLSNRDE0123456789 \n;", max_size=120).map(str.encode)
ANY = st.one_of(st.binary(max_size=120), ISO, B3)


@pytest.mark.parametrize("format_", ["3b", "iso", "compact", "rotation", "compensation", "4b"])
@settings(max_examples=60, deadline=None)
@given(data=ANY)
def test_no_reader_raises(format_, data):
    program, found = decoder(format_)(data, default(format_), "any")
    assert len(program.spans) == len(program.blocks)
    assert all(d.message for d in found)
    identify(data)


B4 = st.lists(
    st.builds(
        lambda x, y, j, r, d, g, z: f"B{x}B{y}B{j}B{r}{d}{g}{z}",
        *(st.integers(0, 9000), st.integers(0, 9000), st.integers(0, 30000)),
        *(st.one_of(st.just(""), st.integers(0, 9000)), st.sampled_from(["", "D", " D D", "DD "])),
        *(st.sampled_from(["GX", "G Y"]), st.sampled_from(["L1", "L3", "NR1", "SR4", "NR3", "L9"])),
    )
)


@settings(max_examples=150, deadline=None)
@given(lines=B4, gap=st.integers(0, 5000), outwards=st.booleans(), run=st.booleans())
def test_4b_records_are_offset_or_refused(lines, gap, outwards, run):
    text = ("" if run else "\n").join([*lines, "DD"]).encode()
    program, found = decoder("4b")(text, default("4b"), "any", gap_um=gap, outwards=outwards)
    assert len(program.spans) == len(program.blocks)
    assert len(program.blocks) or found
    assert identify(text).format in ("4b", "unknown", "3b")


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

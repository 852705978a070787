"""Readers take any bytes: they return findings and never raise."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.machines import default

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


@settings(max_examples=100, deadline=None)
@given(data=ISO)
def test_iso_words_in_any_order_are_read_or_refused(data):
    program, found = decoder("iso")(b"G91G01X10Y5\n" + data, default("iso"), "any.nc")
    assert len(program.blocks) or found

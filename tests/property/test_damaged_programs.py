"""Damaged programs of every format: findings, never an exception, and never a path made up."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam import api
from wedmcam.diag import Severity, has_errors
from wedmcam.frontends import DECODERS, decoder
from wedmcam.frontends.identify import identify
from wedmcam.machines import default
from wedmcam.programs.rows import dump

GOLDEN = Path(__file__).parents[1] / "golden"


def whole(format_):
    """A program of each format: the golden one as `convert` writes it, or the golden one itself."""
    own = {"dem15": "key-punch.d15", "nby15": "key-punch.n15"}  # arcs are not converted to them
    if format_ in own:
        return (GOLDEN / own[format_]).read_bytes()
    made = api_convert(GOLDEN / "key-punch.3b", format_)
    assert made.ok, made.findings
    return made.data


def api_convert(path, format_):
    from wedmcam.operations import convert

    return convert.convert(path, to=format_)


PROGRAMS = {format_: whole(format_) for format_ in DECODERS}


@st.composite
def damaged(draw, data):
    """Bytes with a few places cut out, changed, repeated or filled with anything."""
    for _ in range(draw(st.integers(1, 4))):
        low = draw(st.integers(0, len(data)))
        high = min(len(data), low + draw(st.integers(0, 12)))
        put = draw(
            st.one_of(
                st.binary(max_size=6),
                st.sampled_from([b"", data[low:high] * 2, b"-", b".", b"\n", b" ", b"9" * 30]),
            )
        )
        data = data[:low] + put + data[high:]
    return data


def looked_at(data, format_):
    """Read, and use everything that a reader gives."""
    machine = default(format_)
    program, found = decoder(format_)(data, machine, "k")
    assert len(program.blocks) or found or not data.strip()
    assert len(list(program.spans)) in (0, len(program.blocks))
    for d in found:
        assert d.message
        assert str(d.span)
    if not has_errors(found):
        steps = [row.steps for row in dump(program, machine)]
        assert min(steps, default=0) >= 0  # what is read without an error can be run
        api.figures(program, machine)
    return found


@pytest.mark.parametrize("format_", sorted(DECODERS))
def test_the_programs_are_good(format_):
    assert not [d for d in looked_at(PROGRAMS[format_], format_) if d.severity > Severity.NOTE]


@pytest.mark.parametrize("format_", sorted(DECODERS))
@settings(deadline=None)
@given(data=st.data())
def test_damaged_programs(format_, data):
    raw = data.draw(damaged(PROGRAMS[format_]))
    looked_at(raw, format_)
    identify(raw)


@pytest.mark.parametrize("format_", sorted(DECODERS))
@settings(deadline=None)
@given(data=st.one_of(st.binary(max_size=80), st.text(max_size=40).map(str.encode)))
def test_anything(format_, data):
    looked_at(data, format_)


@pytest.mark.parametrize("format_", sorted(DECODERS))
@settings(deadline=None, max_examples=20)
@given(data=st.data())
def test_what_was_damaged_is_converted_or_refused(format_, data):
    """`convert` of anything ends in a proven program or in an error."""
    raw = data.draw(damaged(PROGRAMS[format_]))
    from wedmcam.operations import convert

    to = data.draw(st.sampled_from(["3b", "compact"]))
    made = convert.convert(raw, to=to, format=format_)
    assert made.ok or has_errors(made.findings)
    if made.ok:
        assert made.difference.equal

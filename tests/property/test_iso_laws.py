"""Laws of ISO programs: what is written is read as the same steps, in every profile."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_programs import programs

from wedmcam import api
from wedmcam.backends import encoder
from wedmcam.controllers.pointwise import of_table
from wedmcam.diag import has_errors
from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.judge.difference import difference
from wedmcam.machines import builtin, names
from wedmcam.operations import convert

ISO = [n for n in names() if builtin(n).format == "iso"]
SAMPLES = Path(__file__).parents[2] / "samples"
ROTATE = of_table("rotate")


def as_iso(program, name):
    """A program of 3B blocks as the ISO text of a profile; None where a block is too large."""
    _, made, _, found = convert.between(program, builtin("b3-compact"), builtin(name))
    if made is None or has_errors(found):
        return None
    data, found = encoder("iso")(made, builtin(name))
    assert not has_errors(found)
    return data


@settings(deadline=None, max_examples=25)
@given(program=programs("3b"), name=st.sampled_from(ISO))
def test_iso_round_trip(program, name):
    data = as_iso(program, name)
    if data is None:
        return
    machine = builtin(name)
    again, found = decoder("iso")(data, machine, "k.nc")
    assert not has_errors(found)
    assert difference(program, again, ROTATE, machine.own_stepping).equal
    # What was written is the normal form: it stays as it is, to the byte.
    assert encoder("iso")(again, machine)[0].replace(b"\r", b"") == data.replace(b"\r", b"")
    assert identify(data).format == "iso"
    assert not re.search(rb"-0+(?:\.0*)?(?![.\d])", data)  # never -0


@settings(deadline=None, max_examples=25)
@given(program=programs("3b"), name=st.sampled_from(ISO), data=st.data())
def test_spelling_changes_nothing(program, name, data):
    """Lower case, blanks, N numbers, comments, CRLF, words run together: the same steps."""
    text = as_iso(program, name)
    if text is None:
        return
    machine = builtin(name)
    spelled = text.decode()
    wanted = data.draw(st.sets(st.sampled_from(sorted(SPELLINGS))))
    for change in (c for c in SPELLINGS if c in wanted):
        spelled = SPELLINGS[change](spelled)
    one, _ = decoder("iso")(text, machine, "k.nc")
    two, found = decoder("iso")(spelled.encode(), machine, "k.nc")
    assert not has_errors(found)
    fields = ["kind", "turn", "axis", "x", "y", "count"]
    assert one.blocks[fields].tolist() == two.blocks[fields].tolist()


SPELLINGS = {
    "lower": str.lower,
    "blanks": lambda t: re.sub(r"(?<=[\dA-Za-z])(?=[XYIJxyij])", "  ", t),
    "together": lambda t: t.replace(" ", ""),
    "comments": lambda t: t.replace("\n", " (a) ; b\n"),
    "numbers": lambda t: "".join(
        f"N{k} {line}\n" for k, line in enumerate(re.sub("(?m)^N[0-9]+ *", "", t).splitlines())
    ),
    "crlf": lambda t: t.replace("\r\n", "\n").replace("\n", "\r\n"),
    "tape": lambda t: f"%\n{t}%\n",
    "lines": lambda t: t.replace("\n", "\n\n"),
}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r"G03(?=X-?[1-9])", "G02"),
        (r"(G03X-?[1-9][^\n]*\nG01X)-?\d+", r"\g<1>77"),
        (r"\nG01X[^\n]*(?=\nG01)", ""),
        (r"I(-?\d)", r"I9\1"),
        (r"\nM00", ""),
        (r"G91", "G90"),
    ],
    ids=["sense", "end", "block", "centre", "pause", "mode"],
)
def test_forged_programs_are_refused(old, new):
    """The judge reads what stands there: it is not the part that was drawn."""
    made = api.compile(SAMPLES / "plate.dxf", profile="iso-um", offset=0.1)
    text = made.data.decode().replace(" ", "")
    forged = re.sub(old, new, text, count=1)
    assert forged != text
    for data, status in ((text, 0), (forged, 1)):
        proof = api.verify(
            data.encode(), against=SAMPLES / "plate.dxf", name="a.nc", profile="iso-um", offset=0.1
        )
        assert bool(proof.status) == bool(status)


def test_turns_are_parted():
    """ISO states where an arc ends, once; two turns in halves and a half are five blocks."""
    made = convert.convert(b"B2100B0B21000GYNR1 DD", to="iso", format="3b")
    assert made.ok, made.findings
    assert made.difference.largest_um == 0
    assert int((made.program_out.blocks["turn"] == 1).sum()) == 5


@pytest.mark.parametrize("sense", ["NR", "SR"])
@pytest.mark.parametrize("start", [(1, 0), (0, 1), (-1, 0), (0, -1), (3, 4), (-4, 3), (-3, -4)])
@pytest.mark.parametrize("size", [2, 1_003])
@pytest.mark.parametrize("name", ["iso-um", "iso-mm"])
def test_full_circles_are_two_halves_of_the_same_steps(sense, start, size, name):
    x, y = (size * v for v in start)
    quarter = {(1, 0): 1, (0, 1): 2, (-1, 0): 3, (0, -1): 4, (3, 4): 1, (-4, 3): 2, (-3, -4): 3}
    digit = quarter[start]
    if sense == "SR" and 0 in start:
        digit = {1: 4, 2: 1, 3: 2, 4: 3}[digit]
    turn = 4 * round(float(np.hypot(x, y)))
    circle = f"B{abs(x)}B{abs(y)}B{turn}GY{sense}{digit} DD".encode()
    if abs(x) <= abs(y):  # counted on the axis of the last step
        circle = circle.replace(b"GY", b"GX")
    halves = convert.convert(circle, to="iso", format="3b", profile=name)
    assert halves.ok, halves.findings
    assert halves.difference.largest_um == 0
    assert halves.data.count(b"I") == 2
    whole = replace(builtin(name), iso=replace(builtin(name).iso, full_circle="one"))
    one = convert.convert(circle, to="iso", format="3b", profile=whole)
    assert one.ok
    assert one.data.count(b"I") == 1
    told, _ = api.diff(halves.data, one.data, names=("a.nc", "b.nc"), profiles=(name, name))
    assert told.largest_um == 0

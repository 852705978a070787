"""An honest certificate holds: whatever was compiled, `verify` derives the same figures again."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import parts
from wedmcam import api, machines
from wedmcam.operations.together import compile_several
from wedmcam.options import WrongUse

AXES = {
    "swapped.toml": "[axes]\nexchange = true\n",
    "mirrored.toml": "[axes]\nmirror_x = true\n",
    "coarse.toml": "[axes]\nstep_um = 5\n",
    "fine.toml": "[axes]\nstep_um = 0.5\nexchange = true\nmirror_y = true\n",
}
TABLE = (
    'title = "x"\nformat = "3b"\nline_table = "rotate"\n'
    "[limits]\ncount_um = 999999\nline_um = 999999\narc_um = 999999\n"
)

WED = """
let bore = 5
contour ring { circle center (0, 0) radius 8 }
contour hole { from (-2, -1) line to (2, -1) arc ccw to (2, 1) center (2, 0) line to (-2, 1) close }
cut hole inside offset 0.1 start (0, 0)
cut ring outside offset 0.1 lead 2
"""


def machine(name):
    if name not in AXES:
        return name
    made, found = machines.parse(TABLE + AXES[name], name)
    assert made is not None, found
    return made


PROFILES = [
    *(
        "b3-compact",
        "b3-columns",
        "zd065",
        "zd065-compensation",
        "zd065-rotation",
        "iso-um",
        "iso-mm",
        "iso-g41-mm",
        "b4-compact",
    ),
    *AXES,
]

OPTIONS = st.fixed_dictionaries(
    {},
    optional={
        "side": st.sampled_from(["part", "die"]),
        "offset": st.sampled_from([0.05, 0.1, 0.127]),
        "corner": st.sampled_from([0.2, 0.3]),
        "lead": st.sampled_from([0.5, 1.5]),
        "stop": st.sampled_from([0.4, 1.0]),
        "overcut": st.sampled_from([0.05, 0.3]),
        "order": st.sampled_from(["given", "nearest", "inner-first"]),
        "reverse": st.booleans(),
        "sharp": st.booleans(),
        "paper": st.booleans(),
        "count": st.sampled_from(["exact", "textbook"]),
        "transforms": st.sampled_from([("rotate 17",), ("mirror x",), ("scale 1.5", "shift 3 1")]),
        "arithmetic": st.sampled_from(["decimal8", "float64"]),
        "cuts": st.sampled_from([(1, 1), (1, 2)]),
        "blocks": st.sampled_from([(1, 3), (2, 6), (4, 9)]),
        "from_block": st.sampled_from([2, 5]),
    },
)


def holds(source, made, name):
    """Prove a program again with its certificate; nothing may be said against that."""
    stated = json.loads(json.dumps(made.summary))
    proof = api.verify(made.data, against=source, against_name=name, name="a", certificate=stated)
    against = [d.message for d in proof.findings if d.code == "certificate-differs"]
    assert not against
    assert proof.status == 0, [d.message for d in proof.findings]


@settings(max_examples=40)
@given(st.integers(0, 400), st.sampled_from(PROFILES), OPTIONS)
def test_an_honest_certificate_of_a_drawing_holds(seed, profile, options):
    drawing = parts.dxf_bytes(parts.random_part(seed), shuffle=seed, polylines=bool(seed % 2))
    try:
        made = api.compile(drawing, profile=machine(profile), **{"offset": 0.1, **options})
    except WrongUse:
        return
    if made.ok:
        holds(drawing, made, "input")


@settings(max_examples=12)
@given(st.sampled_from(PROFILES), OPTIONS)
def test_an_honest_certificate_of_a_part_program_holds(profile, options):
    options = {k: v for k, v in options.items() if k not in ("side", "offset", "corner")}
    try:
        made = api.compile(WED.encode(), name="a.wed", profile=machine(profile), **options)
    except WrongUse:
        return
    if made.ok:
        holds(WED.encode(), made, "a.wed")


@pytest.mark.parametrize(
    "formats", [("3b", "iso"), ("compact", "iso-g41-mm", "3b"), ("iso-mm", "4b")]
)
def test_of_several_formats_at_once_each_holds(formats):
    drawing = parts.dxf_bytes(parts.random_part(3))
    every = [
        machines.default(f) if f in machines.DEFAULTS else machines.builtin(f) for f in formats
    ]
    made = compile_several(drawing, every, options=api.options_in_mm(offset=0.1, corner=0.2))
    assert made.compilations[0].ok
    for one in made.compilations:
        if one.ok:
            holds(drawing, one, "input")


def test_every_contour_by_itself_holds():
    drawing = parts.dxf_bytes(parts.random_part(5))
    whole = api.compile(drawing, offset=0.1)
    for k in range(1, whole.verdict.contours + 1):
        holds(drawing, api.compile(drawing, offset=0.1, cuts=(k, k)), "input")

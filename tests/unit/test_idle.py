"""An option that was asked for and has no effect is said; a default of the shop is passed over."""

from __future__ import annotations

import pytest

import parts
from wedmcam import api
from wedmcam.options import Options

PLATE = "contour plate { from (0, 0) line to (30, 0) line to (30, 20) line to (0, 20) close }\n"
HOLE = "contour hole { circle center (4, 10) radius 1.5 }\n"
OPEN = "contour slit { from (0, 0) line to (30, 0) line to (30, 20) }\n"
FULL = "cut plate outside offset 0.1 corner 0.2 start (15, -3) stop 1 overcut 0.5\n"
SQUARE = parts.dxf_bytes((parts.rectangle(20_000, 10_000),))
ROUND = parts.dxf_bytes((parts.circle(0, 0, 5_000),))
SLIT = parts.dxf_bytes((parts.contour_of_bulges([(0, 0), (9_000, 0)], [0, 0], closed=False),))


def said(source: str | bytes, **options: object) -> list[str]:
    """Return the options that are said to have no effect, in the words of the findings."""
    data = source.encode() if isinstance(source, str) else source
    name = "x.wed" if isinstance(source, str) else "x.dxf"
    made = api.compile(data, name=name, options=Options.of(**options))  # type: ignore[arg-type]
    assert made.ok, made.findings
    told = [d for d in made.findings if d.code in ("wed-option", "idle-option")]
    assert all(d.severity.name == "WARNING" for d in told)
    return [d.message.split(" has no effect")[0].split(" have no effect")[0] for d in told]


@pytest.mark.parametrize(
    ("source", "options", "words"),
    [
        (PLATE + FULL, {"offset_um": 200.0}, ["--offset"]),
        (PLATE + "cut plate on", {"offset_um": 200.0}, ["--offset"]),
        (PLATE + "cut plate outside", {"offset_um": 200.0}, []),
        # One cut that takes it up is enough.
        (PLATE + HOLE + "cut hole inside cut plate outside offset 0.2", {"offset_um": 100.0}, []),
        (PLATE + FULL, {"corner_um": 300.0}, ["--corner"]),
        (PLATE + FULL, {"stop_um": 2000.0}, ["--stop"]),
        (PLATE + FULL, {"overcut_um": 2000.0}, ["--overcut"]),
        (PLATE + FULL, {"lead_um": 2000.0}, ["--lead"]),
        (HOLE + "cut hole inside offset 0.1", {"lead_um": 2000.0}, ["--lead"]),
        (PLATE + "cut plate outside offset 0.1", {"lead_um": 2000.0}, []),
        (PLATE + "cut plate outside offset 0.1 lead 3", {"lead_um": 2000.0}, ["--lead"]),
        (OPEN + "cut slit on", {"stop_um": 2000.0, "overcut_um": 1000.0}, ["--stop", "--overcut"]),
        (PLATE + "cut plate on", {"sharp": True}, ["--convex"]),
        (PLATE + FULL, {"sharp": True, "trim": True}, []),
        (PLATE + "cut plate outside offset 0.1 lead 2 start (15, -3)", {}, ["'lead'"]),
        (HOLE + "cut hole inside offset 0.1 lead 2", {}, ["'lead'"]),
        (OPEN + "cut slit on start (-1, 0)", {"reverse": True}, ["--reverse"]),
        (OPEN + "cut slit | reverse on start (-1, 0)", {}, ["'reverse'"]),
        (OPEN + "cut slit | reverse on start (30, 21)", {}, []),
        (OPEN + "cut slit | reverse on", {}, []),
        (SQUARE, {"offset_um": 100.0, "starts_um": ((-5e3, 5e3),), "lead_um": 2e3}, ["--lead"]),
        (SQUARE, {"offset_um": 100.0, "lead_um": 2e3}, []),
        (ROUND, {"offset_um": 100.0, "side": "die", "lead_um": 2e3}, ["--lead"]),
        (SQUARE, {"sharp": True}, ["--convex"]),
        (SQUARE, {"trim": True}, ["--on-interference"]),
        (SLIT, {"side": "on", "stop_um": 1e3}, ["--stop"]),
        (SLIT, {"side": "on", "overcut_um": 1e3}, ["--overcut"]),
        (SLIT, {"side": "on", "reverse": True}, []),
        (SLIT, {"side": "on", "reverse": True, "starts_um": ((-1e3, 0.0),)}, ["--reverse"]),
    ],
)
def test_an_option_without_effect_is_said(source, options, words):
    if "side" in options:
        from wedmcam.ir.plan import Side

        options = {**options, "side": Side(options["side"])}
    assert said(source, **options) == words


def test_what_was_not_typed_is_no_wish():
    asked = {"offset_um": 200.0, "lead_um": 2000.0, "layers": ("CUT*",), "join_um": 20.0}
    assert said(PLATE + FULL, **asked, wishes=frozenset()) == []
    assert said(PLATE + FULL, **asked, wishes=frozenset({"join_um"})) == ["--join"]
    assert said(PLATE + FULL, **asked, wishes=frozenset({"offset_um", "wire_um", "gap_um"})) == [
        "--wire and --gap"
    ]
    # What is typed counts, even where it is the usual value.
    assert said(PLATE + FULL, wishes=frozenset({"lead_um"})) == ["--lead"]


def test_wishes_are_no_part_of_the_certificate():
    assert Options.of(offset_um=100.0, wishes=frozenset({"offset_um"})).as_data() == {
        "offset_um": 100.0
    }

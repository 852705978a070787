"""The part language: what its forms mean, and what is said of mistakes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wedmcam
from wedmcam.diag import has_errors
from wedmcam.frontends.wed import read
from wedmcam.frontends.wed.grammar import grammar_text
from wedmcam.options import Options, WrongUse

KEY = b"""part "key"
units mm
let w = 8.5
let A = (w/2, 20)
contour blade {
  from (0, 0)
  line to (w, 0) fillet 0.5
  line by (0, 20)
  line polar 5, 90
  arc ccw to (0, 25) center (w/2, 25)
  line to (0, 22)
  close
}
contour hole { circle center (4, 10) radius 1.5 }
cut hole inside offset 0.1 start (4, 10)
cut blade outside offset 0.1 start (-3, 0) corner 0.2 stop 1
"""


def part_of(text, **more):
    part, found = read(text.encode(), "a.wed", **more)
    assert part is not None, found
    return part


def blocks(body):
    """Rows (x, y, turn, cx, cy) in um of a contour."""
    part = part_of(f"contour a {{ {body} }} cut a on")
    (chain,) = part.cuts[0].shape.chains
    return [
        (*(float(v[k]) for k in ("x", "y")), int(v["turn"]), float(v["cx"]), float(v["cy"]))
        for v in chain.vertices
    ]


def codes(text, **more):
    _, found = read(text.encode(), "a.wed", **more)
    return [d.code for d in found if d.severity.name == "ERROR"]


def let(expression):
    part = part_of(f"let v = {expression} contour a {{ from (0, 0) line to (v, 1) }} cut a on")
    return float(part.cuts[0].shape.chains[0].vertices["x"][1]) / 1000


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("2 + 3 * 4", 14),
        ("-2 ^ 2", -4),
        ("2 ^ 3 ^ 2 / 64", 8),
        ("(2 + 3) * 4 - 1", 19),
        ("sqrt(16) + sin(30) + cos(60)", 5),
        ("tan(45) + asin(1) / 90 + acos(0) / 90 + atan(1) / 45", 4),
        ("atan2(1, 0)", 90),
        ("min(3, 1, 2) + max(3, 1, 2) + abs(-2)", 6),
        ("360 / 36", 10),
        ("2 * pi", 6.2831854),
        ("1 / 3", 0.33333333),
    ],
)
def test_expressions(expression, value):
    assert let(expression) == pytest.approx(value, abs=1e-9)


def test_float64_has_more_digits():
    text = "contour a { from (0, 0) line to (1/3, 1) } cut a on"
    part = part_of(text, arithmetic="float64")
    assert float(part.cuts[0].shape.chains[0].vertices["x"][1]) == 1000 / 3


def test_points():
    text = """let A = (4, 6) let B = polar(10, 90, A) let C = (A + B - (1, 1)) / 2 * 3
    contour a { from C line to (A.x, B.y) } cut a on"""
    v = part_of(text).cuts[0].shape.chains[0].vertices
    assert v["x"].tolist() == [10500.0, 4000.0]
    assert v["y"].tolist() == [31500.0, 16000.0]


def test_lines():
    assert [
        b[:2] for b in blocks("from (1, 1) line to (4, 1) line by (0, 2) line polar 3, 180")
    ] == [
        (1000, 1000),
        (4000, 1000),
        (4000, 3000),
        (1000, 3000),
    ]


def test_arcs():
    (_, _, turn, cx, cy), end = blocks("from (2, 0) arc ccw to (-2, 0) center (0, 0)")
    assert (turn, cx, cy, end[:2]) == (1, 0, 0, (-2000, 0))
    shorter = blocks("from (0, 0) arc ccw to (2, 0) radius 2")[0]
    longer = blocks("from (0, 0) arc ccw to (2, 0) radius -2")[0]
    assert shorter[4] == pytest.approx(1000 * 3**0.5, abs=1e-3)
    assert longer[4] == pytest.approx(-1000 * 3**0.5, abs=1e-3)
    swept = blocks("from (2, 0) arc cw center (0, 0) sweep 90")
    assert swept[0][2] == -1
    assert swept[1][:2] == pytest.approx((0, -2000), abs=1e-6)
    tangent = blocks("from (-5, 0) line to (0, 0) arc tangent to (2, 2)")
    assert tangent[1][2:] == pytest.approx((1, 0, 2000))


def test_circle_and_close():
    assert blocks("circle center (1, 2) radius 3") == [(4000, 2000, 1, 1000, 2000)]
    assert blocks("circle cw center (1, 2) radius 3")[0][2] == -1
    part = part_of(
        "contour a { from (0, 0) line to (2, 0) line to (2, 2) line to (0, 0) close } cut a on"
    )
    (chain,) = part.cuts[0].shape.chains
    assert chain.closed
    assert len(chain) == 3


def test_fillet_and_chamfer():
    rows = blocks("from (0, 0) line to (10, 0) fillet 2 line to (10, 10) chamfer 1 line to (0, 10)")
    assert rows[1] == pytest.approx((8000, 0, 1, 8000, 2000))
    assert rows[2][:2] == pytest.approx((10000, 2000))
    assert [r[:2] for r in rows[3:5]] == [(10000, 9000), (9000, 10000)]


def test_units():
    assert (
        part_of("units um contour a { circle center (0, 0) radius 3 } cut a on")
        .cuts[0]
        .shape.chains[0]
        .vertices["x"][0]
        == 3
    )
    inch = part_of(
        "units inch contour a { circle center (0, 0) radius 1 } cut a inside offset 0.004"
    )
    assert inch.cuts[0].offset == pytest.approx(101.6)


def test_define():
    text = "let w = 8 let v = w * 2 contour a { circle center (0, 0) radius v } cut a on"
    v = part_of(text, defines=("w=1/2",)).cuts[0].shape.chains[0].vertices
    assert v["x"][0] == 1000
    _, found = read(text.encode(), "a.wed", defines=("vv=3",))
    assert [d.code for d in found] == ["unknown-name"]
    assert found[0].hint == "did you mean 'v'?"


def test_compiles_and_is_proven():
    made = wedmcam.compile(KEY, name="key.wed")
    assert made.ok, made.findings
    assert made.verdict.contours == 2
    assert made.program.origin == (4000, 10000)
    proof = wedmcam.verify(made.data, against=KEY, against_name="key.wed")
    assert proof.ok
    other = KEY.replace(b"radius 1.5", b"radius 1.6")
    assert not wedmcam.verify(made.data, against=other, against_name="key.wed").ok


def test_wrong_side_is_refuted():
    made = wedmcam.compile(KEY, name="key.wed")
    other = KEY.replace(b"blade outside", b"blade inside").replace(
        b"start (-3, 0)", b"start (1, 1)"
    )
    assert not wedmcam.verify(made.data, against=other, against_name="key.wed").ok


def test_36_open_slots_are_one_closed_contour():
    text = b"""contour slot { from polar(30, 85) line to polar(32, 86) line to polar(32, 94)
    line to polar(30, 95) } let rotor = slot | rotate 10 copies 35 cut rotor left offset 0.1"""
    made = wedmcam.compile(text)
    assert made.ok
    assert made.verdict.contours == 1
    assert made.verdict.closure_um == 0
    assert made.verdict.gouge_um is None


def test_punch_and_die_of_one_outline():
    text = b"""contour o { from (0, 0) line to (20, 0) fillet 2 line to (20, 10) line to (0, 10)
    close }
    cut o inside offset 0.1 corner 0.2 cut o outside offset 0.12 corner 0.2"""
    made = wedmcam.compile(text)
    assert made.ok, made.findings
    assert [c.keeps_left for c in made.plan.cuts] == [False, True]
    assert made.verdict.gouge_um is not None


def test_cuts_in_their_order():
    text = b"""contour a { circle center (0, 0) radius 20 }
    contour b { circle center (0, 0) radius 2 }
    cut b inside offset 0.1 cut a outside offset 0.1"""
    made = wedmcam.compile(text)
    radii = [round(float(c.outline.vertices["x"][0])) for c in made.plan.cuts]
    assert radii == [2000, 20000]


def test_map_points_to_lines_and_copies():
    text = (
        b"contour a { circle center (0, 0) radius 2 }\n"
        b"let r = a | translate (9, 0) copies 2\ncut r on"
    )
    made = wedmcam.compile(text, name="r.wed")
    sources = [
        b["source"] for b in wedmcam.api.source_map(made)["blocks"] if b["role"] == "contour"
    ]
    assert {s["line"] for s in sources} == {1}
    assert {tuple(s["copies"]) for s in sources} == {(), (1,), (2,)}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("let a = a", "unknown-name"),
        ("let a = 1 / 0", "wed-value"),
        ("let a = sqrt(-1)", "wed-value"),
        ("let a = (1, 2) + 3", "wed-kind"),
        ("let a = 10 ^ 10 ^ 10", "wed-value"),
        ("let a = " + "(" * 5000 + "1" + ")" * 5000, "wed-syntax"),
        ("let a = 1" + "0" * 5000, "wed-value"),
        ("units furlong", "wed-value"),
        ("contour a { line to (1, 1) }", "wed-contour"),
        ("contour a { from (0, 0) line too (1, 1) }", "wed-syntax"),
        ("contour a { from (0, 0) line to (1, 1)", "wed-syntax"),
        ("contour a { circle center (0, 0) radius 0 }", "wed-contour"),
        (
            "contour a { circle center (0, 0) radius 2 } let b = a | rotate 1 copies 10^9",
            "wed-value",
        ),
        ("contour a { circle center (0, 0) radius 2 } let a = 3", "name-taken"),
        ("let line = 3", "name-taken"),
        ("", "no-cut"),
    ],
)
def test_mistakes(text, code):
    assert codes(text)[0] == code


def test_all_mistakes_of_a_text():
    text = """let w = q
contour a { from (0, 0) line too (1, 0) line to (1, z) close }
contour b { from (0, 0) line to (10, 0) arc cw to (20, 0) center (13, 0) }
cut aa inside offset 0.1"""
    _, found = read(text.encode(), "a.wed")
    assert [(d.span.line, d.span.column) for d in found] == [
        (1, 9),
        (2, 30),
        (2, 53),
        (3, 41),
        (4, 5),
    ]


def test_a_gap_is_measured():
    text = b"""contour a { from (0, 0) line to (10, 0) line to (10, 10) line to (0, 0.137) }
    cut a outside offset 0.1"""
    made = wedmcam.compile(text)
    (error,) = (d for d in made.findings if d.code == "open-contour")
    assert "0.137 mm" in error.message
    assert error.span.line == 1


TOKENS = st.sampled_from(
    [w for w in re.findall(r'"([^"\n]+)"', grammar_text()) if w.strip()]
    + [
        "1",
        "0.5",
        "1e9",
        "a",
        "b",
        "(",
        ")",
        "\n",
        "#",
        '"',
        "contour a {",
        "from (0, 0)",
        "\x00",
        "é",
    ]
)


@given(st.one_of(st.text(max_size=200), st.lists(TOKENS, max_size=60).map(" ".join)))
@settings(max_examples=150, deadline=None)
def test_any_text_is_read_or_refused(text):
    part, found = read(text.encode("utf-8", "replace"), "a.wed")
    assert (part is None) == has_errors(found)


@given(st.data())
@settings(max_examples=40, deadline=None)
def test_a_changed_program_never_raises(data):
    text = KEY.decode()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text)))
        gone = data.draw(st.integers(0, 12))
        text = text[:at] + data.draw(TOKENS) + text[at + gone :]
    made = wedmcam.compile(text.encode("utf-8", "replace"), name="a.wed")
    assert made.ok or has_errors(made.findings)


@given(st.binary(max_size=100))
@settings(max_examples=50, deadline=None)
def test_any_bytes(data):
    part, found = read(data, "a.wed")
    assert (part is None) == has_errors(found)


def test_a_hole_that_crosses_its_outline_is_refused():
    text = """
    contour c { from (0, 0) line to (20, 0) line to (20, 10) line to (0, 10) close }
    contour h { circle center (20, 5) radius 2 }
    cut h inside offset 0.1
    cut c outside offset 0.1"""
    made = wedmcam.compile(text.encode(), name="a.wed")
    assert not made.ok
    assert {d.span.line for d in made.findings if d.severity == 2} & {2, 3}


@pytest.mark.parametrize("arithmetic", ["decimal8", "float64"])
def test_the_corner_of_a_reversal_is_rounded_where_the_way_back_lies(arithmetic):
    """Of two places as near only one touches both; once the digits decided which was taken."""
    text = """
    contour c { from (0, 0) line to (8, 0) line to (8, 30) line to (-3, 30) line to (-3, 20)
                arc tangent to (0, 20) close }
    cut c outside offset 0.1 corner 0.2"""
    made = wedmcam.compile(text.encode(), name="a.wed", arithmetic=arithmetic)
    assert made.ok, made.findings


DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = [
    pytest.param(text, id=f"{name}-{k}")
    for name in ("language", "tutorial")
    for k, text in enumerate(
        re.findall(r"```wed\n(.*?)```", (DOCS / f"{name}.md").read_text("utf-8"), re.DOTALL)
    )
]


@pytest.mark.parametrize("text", EXAMPLES)
def test_examples_of_the_documentation_compile(text):
    made = wedmcam.compile(text.encode(), name="example.wed")
    assert made.ok, [d.message for d in made.findings]


def test_the_reference_has_every_word_of_the_grammar():
    reference = (DOCS / "language.md").read_text("utf-8")
    grammar = re.sub(r"//[^\n]*", "", grammar_text())
    words = set(re.findall(r'"([a-z]+)"', grammar))
    assert len(words) > 35
    assert not [w for w in words if not re.search(rf"\b{w}\b", reference)]


BOX = """contour box { from (0, 0) line to (20, 0) line to (20, 10) line to (0, 10) close }
"""


def planned(text):
    made = wedmcam.compile((BOX + text).encode(), name="box.wed")
    assert made.ok, [d.message for d in made.findings]
    return made


@pytest.mark.parametrize("start", ["start (-3, 2)", "lead 3", "start (-1, 9) lead 7"])
def test_enter_says_where_the_lead_arrives(start):
    cut = planned(f"cut box outside offset 0.1 {start} enter (0, 7)").plan.cuts[0]
    first = cut.path.vertices[0]
    assert (first["x"], first["y"]) == pytest.approx((-100, 7000))
    if "start" not in start:
        assert cut.thread == (-3100, 7000)


def test_enter_and_overcut_say_their_mistakes():
    both = "cut box | translate (40, 0) copies 1 outside offset 0.1 enter (0, 7)"
    made = wedmcam.compile((BOX + both).encode(), name="box.wed")
    assert [d.message for d in made.findings if d.code == "wed-value"] == [
        "'enter' is for one contour; this figure has 2"
    ]
    line = "contour l { from (0, 0) line to (5, 0) } cut l on start (0, 0) overcut 1"
    made = wedmcam.compile(line.encode(), name="l.wed")
    assert "an overcut is for closed contours" in made.findings[0].message


@pytest.mark.parametrize("clause", ["overcut 0.0004", "stop 0.0009"])
def test_what_is_shorter_than_a_step_is_no_length(clause):
    """It failed only when it was verified: the wire ran no such way."""
    made = wedmcam.compile((BOX + f"cut box outside offset 0.1 {clause}").encode(), name="b.wed")
    assert [d.code for d in made.findings] == ["wed-value"]
    assert "no step is shorter" in made.findings[0].message
    with pytest.raises(WrongUse, match=r"takes a length, 0, or 0\.001 mm to"):
        Options.of(overcut_um=0.4)


def test_overcut_of_a_cut_wins_over_the_option():
    cut = "cut box outside offset 0.1 overcut 0.5"
    made = wedmcam.compile((BOX + cut).encode(), name="box.wed", overcut=2)
    assert made.ok
    assert made.plan.cuts[0].overcut_um == 500


def test_a_decimal_comma_is_named():
    made = wedmcam.compile(b"contour a { circle center (0, 0) radius 9,5 } cut a on", name="a.wed")
    assert made.findings[0].hint == "numbers have a decimal point: 9.5"

"""Header and footer of an ISO profile: proven with the program, or refused; never silent."""

from dataclasses import replace
from pathlib import Path

import pytest

import wedmcam
from wedmcam import api, machines
from wedmcam.diag import Severity

PUNCH = str(Path(__file__).parents[2] / "samples" / "key-punch.dxf")
PROFILES = ["iso-mm", "linuxcnc", "iso-um", "sodick"]


def profile(name, **lines):
    """Return a profile whose modes stand in its header, and what is wrong with it."""
    text = machines.text(name)
    own = machines.builtin(name)
    kept = [t for t in text.splitlines() if not t.startswith(("header", "footer", "modes"))]
    if "[layout]" not in kept:
        kept.append("[layout]")
    at = kept.index("[layout]") + 1
    header = [*([own.iso.modes] if own.iso.modes else ()), *own.layout.header]
    more = {"header": [*header, *lines.get("header", ())], "footer": lines.get("footer", [])}
    kept[at:at] = [f"{key} = {value}".replace("'", '"') for key, value in more.items()]
    return machines.parse("\n".join(kept), "p")


def made(name, **lines):
    machine, found = profile(name, **lines)
    assert found == [], found
    return wedmcam.compile(PUNCH, profile=machine, offset=0.1, feed=2.0)


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize(
    "line",
    [
        *("G20", "g20", "G 2 0", "G70", "G68 R45", "G51 P2", "G52 X5", "G54 X5", "G10 L2 P1 X5"),
        *("G01 X5.0 Y5.0", "G00 X5.0 Y5.0", "G91 G01 X5", "X5.0", "Z5", "U5 V5", "A5", "I5"),
        *("G18", "G16", "G28", "G31", "G38.2", "G50 X5", "G83 X5", "G90.1", "G92.1", "G92.3"),
        *("G7", "M02", "M30", "M60", "M70", "M98 P1", "G41 D1", "G42 H1"),
        *("#1=5", "PLATE 7", "A)"),
    ],
)
def test_a_header_that_changes_the_path_is_refused(name, line):
    machine, found = profile(name, header=[line])
    if found:
        assert [d.code for d in found] == ["profile-value"]
        return
    one = wedmcam.compile(PUNCH, profile=machine, offset=0.1, feed=2.0)
    assert not one.ok, (name, line)
    assert one.data is None


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("line", ["G91", "G90", "G54", "G40", "G00", "G91.1", "G61", "M00", "(A)"])
def test_a_header_that_the_program_overrules_is_proven(name, line):
    one = made(name, header=[line])
    assert one.ok
    proof = api.verify(one.data, profile=one.machine, name="a.nc", against=PUNCH, offset=0.1)
    assert proof.ok, [d.message for d in proof.findings]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("G64", ["G64"]),
        ("G 064 P0.5", ["G64"]),
        ("G93", ["G93"]),
        ("G64 G95", ["G64", "G95"]),
        ("G64 G61", []),
        ("G61.1 G93 G94", []),
        ("(G64)", []),
    ],
)
def test_a_mode_that_no_step_of_the_proof_sees_is_said(line, said):
    found = made("linuxcnc", header=[line]).findings
    warned = [d.message.split()[0] for d in found if d.code == "header-mode"]
    assert warned == said
    of_um = [d for d in made("iso-um", header=[line]).findings if d.code == "header-mode"]
    assert len(of_um) == ("G64" in said)  # no F there


@pytest.mark.parametrize("header", [[], ["%", "(PLATE 7)", "M52"], ["G20 G64"], ["G95", "G90.1"]])
def test_the_modes_of_a_program_stand_behind_a_header_of_ones_own(header):
    own = machines.builtin("linuxcnc")
    machine = replace(own, layout=replace(own.layout, header=tuple(header)))
    one = wedmcam.compile(PUNCH, profile=machine, offset=0.1, feed=2.0)
    assert one.ok
    assert not [d for d in one.findings if d.code == "header-mode"]
    lines = one.data.decode().splitlines()
    assert lines[: len(header)] == header
    assert lines[len(header)] == own.iso.modes
    assert api.verify(one.data, name="a.nc", against=PUNCH, offset=0.1, profile="linuxcnc").ok


def test_a_g92_of_a_header_counts_only_where_the_program_says_its_own():
    assert made("iso-mm", header=["G92 X5 Y5"]).ok  # its own G92 follows
    assert not made("linuxcnc", header=["G92 X5 Y5"]).ok


@pytest.mark.parametrize(
    "line",
    [
        *("G91", "g 00 x0 y0", "G92 X0 Y0", "X5", "N9 G01 X100", "G40", "M98 P1", "M99", "M60"),
        *("(BACK) G00 X0", "U5", "L2", "M30 G00 X5"),
    ],
)
def test_nothing_that_moves_stands_behind_the_end(line):
    machine, found = profile("linuxcnc", footer=[line, "%"])
    assert machine is None
    assert [d.code for d in found] == ["profile-value"]
    assert "behind M02" in found[0].message
    assert found[0].span.line > 1


@pytest.mark.parametrize("footer", [["M30"], ["%"], ["M02", "%"], ["(END X5)", "; G00 X5", "N5"]])
def test_a_footer_of_text_and_ends_says_nothing(footer):
    one = made("linuxcnc", footer=footer)
    assert one.ok
    assert not [d for d in one.findings if d.severity > Severity.NOTE and d.code != "not-cut"]
    assert one.data.decode().splitlines()[-len(footer) :] == footer


def test_other_words_of_a_footer_are_named():
    one = made("iso-mm", footer=["M81 T85", "M81", "M30"])
    said = [d for d in one.findings if d.code == "after-end"]
    assert one.ok
    assert [(d.count, d.message.split(" of ")[0]) for d in said] == [(3, "M81, T85")]


@pytest.mark.parametrize(
    ("lines", "good"),
    [
        ({"header": ["%", "(PLATE 7)"], "footer": ["%"]}, True),
        ({"header": ["(PLATE 7)", "%"]}, False),
        ({"header": ["%", "%"]}, False),
        ({"footer": ["%", "M30"]}, False),
        ({"header": ["(PLATE 7"]}, False),
        ({"header": ["(PLATE (7)"]}, False),
        ({"header": ["; PLATE (7"]}, True),
        ({"footer": ["(END"]}, False),
    ],
)
def test_parentheses_are_closed_and_percent_stands_outside(lines, good):
    machine, found = profile("iso-um", **lines)
    assert (machine is not None) is good
    assert not good or wedmcam.compile(PUNCH, profile=machine, offset=0.1).ok
    assert good or found[0].code == "profile-value"


@pytest.mark.parametrize(
    "line", ["M02;G00 X5.0 Y5.0;", "; G00 X5.0", "M02 ; M98 P1", "(END); g91", "M30;(A;B)X5"]
)
def test_a_semicolon_that_ends_a_block_hides_no_motion_behind_the_end(line):
    machine, found = profile("sodick", footer=[line])
    assert machine is None
    assert [d.code for d in found] == ["profile-value"]
    assert "behind M02" in found[0].message
    assert profile("linuxcnc", footer=[line.replace("(A;B)X5", "X5")])[1] == []


def test_a_semicolon_that_ends_a_block_is_followed_by_words():
    def said(name, code, **lines):
        return [d for d in made(name, **lines).findings if d.code == code]

    for name, many in (("sodick", 1), ("iso-mm", 0)):
        assert len(said(name, "header-mode", header=["G40;G64"])) == many
        assert len(said(name, "after-end", footer=["M30;T85;"])) == many
    assert profile("sodick", footer=["M02;", "%;"])[1] == []
    assert profile("sodick", header=["G40; (A"])[0] is None


def test_the_words_behind_a_semicolon_that_ends_a_block_count_for_a_line():
    words = ";".join(f"M{n}" for n in range(31, 55))
    for name, many in (("sodick", 1), ("iso-mm", 0)):
        machine, found = profile(name, footer=[f"M30;{words}"])
        assert found == []
        tight = replace(machine, limits=replace(machine.limits, line_chars=60))
        one = wedmcam.compile(PUNCH, profile=tight, offset=0.1)
        assert len([d for d in one.findings if d.code == "over-line"]) == many

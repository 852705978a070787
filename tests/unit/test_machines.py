from dataclasses import replace

import pytest

from wedmcam import machines
from wedmcam.machines.write import as_toml, fingerprint

GOOD = """\
title = "T"
format = "3b"
line_table = "rotate"
[limits]
count_um = 999999
line_um = 999999
arc_um = 999999
"""


def codes(text):
    machine, found = machines.parse(text, "t.toml")
    assert (machine is None) == bool(found)
    return [d.code for d in found]


@pytest.mark.parametrize("name", machines.names())
def test_builtin(name):
    machine = machines.builtin(name)
    assert machine.name == name
    if machine.is_of("dem15"):
        assert machine.own_stepping.direction == machine.vectors.direction
        assert machine.limits.line_um * 2 in (65_534, 131_070)  # 16 bits of um, of steps
        return
    assert machine.own_stepping.table == machine.own_table == machine.line_table
    assert machine.limits.count_um == 999_999


def test_builtins_differ():
    b3 = [machines.builtin(n) for n in machines.names() if n.startswith("b3-")]
    assert len({m.layout for m in b3}) == len(b3) == 3
    assert {m.line_table for m in b3} == {"rotate"}
    zd = machines.builtin("zd065")
    assert (zd.line_table, zd.limits.arc_um, zd.limits.memory_bytes) == ("mirror", 10_000_000, 4096)


def test_defaults():
    assert machines.default("3b").name == "b3-compact"
    assert machines.default("compact").name == "zd065"


def test_find_suggests():
    machine, found = machines.find("b3-colums")
    assert machine is None
    assert found[0].hint == "did you mean 'b3-columns'?"
    assert machines.find("zd065")[1] == []


def test_good():
    machine, found = machines.parse(GOOD, "t.toml")
    assert found == []
    assert machine.layout == machines.Layout()
    assert machine.count == "exact"


def test_layout_is_taken():
    text = GOOD + 'travel_um = [400000, 300000]\nblocks = 100\n[layout]\neol = "crlf"\nwidth = 6\n'
    machine, found = machines.parse(text, "t.toml")
    assert found == []
    assert (machine.layout.eol, machine.layout.width) == ("\r\n", 6)
    assert (machine.limits.travel_um, machine.limits.blocks) == ((400_000, 300_000), 100)


@pytest.mark.parametrize(
    ("text", "want"),
    [
        ("x = ", ["profile-syntax"]),
        (GOOD.replace("title", "titel"), ["profile-key", "profile-missing"]),
        (GOOD.replace('"3b"', '"4x"'), ["profile-value"]),
        (GOOD.replace("count_um", "cuont_um"), ["profile-key", "profile-missing"]),
        (GOOD.replace("count_um = 999999", "count_um = 1000000"), ["profile-value"]),
        (GOOD.replace("count_um = 999999", "count_um = true"), ["profile-value"]),
        (GOOD.replace("arc_um = 999999", "arc_um = 10000000"), ["profile-value"]),
        (GOOD + "memory_bytes = 4096\n", ["profile-key"]),
        (GOOD + "travel_um = [4, 5, 6]\n", ["profile-value"]),
        (GOOD + '[words]\npause = "DD"\n', ["profile-value"]),
        (GOOD + '[words]\npause = "B"\n', ["profile-value"]),
        (GOOD + '[layout]\nheader = ["B1B1B1GXL1"]\n', ["profile-value"]),
        (GOOD + '[layout]\nheader = ["; 慢走丝"]\n', ["profile-value"]),
        (GOOD.replace("[limits]", "limits = 3\n[x]"), None),
        (GOOD + "[layuot]\nwidth = 3\n", ["profile-key"]),
        (GOOD.replace('"3b"', '"compact"') + "[layout]\nwidth = 3\n", ["profile-key"]),
    ],
)
def test_wrong(text, want):
    got = codes(text)
    assert got
    if want is not None:
        assert got == want


def test_suggestion_and_place():
    _, found = machines.parse(GOOD.replace("line_um", "lien_um"), "t.toml")
    assert found[0].hint == "did you mean 'line_um'?"
    assert str(found[0].span) == "t.toml:6:1"


def test_header_in_its_encoding():
    text = GOOD + '[layout]\nheader = ["; 慢走丝", "****"]\nencoding = "gbk"\n'
    machine, found = machines.parse(text, "t.toml")
    assert found == []
    assert machine.layout.header == ("; 慢走丝", "****")


def test_axes_are_checked():
    machine, found = machines.parse(GOOD + "[axes]\nexchange = true\nmirror_y = true\n", "t.toml")
    assert found == []
    assert machine.axes == machines.Axes(exchange=True, mirror_y=True)
    assert machine.table == "rotate"
    assert codes(GOOD + "[axes]\nmirror_z = true\n") == ["profile-key"]
    assert codes(GOOD + '[axes]\nexchange = "yes"\n') == ["profile-value"]
    steps = GOOD.replace('"3b"', '"iso"') + "[axes]\nstep_um = 2\n"
    assert codes(steps) == []
    assert codes(steps + '[iso]\ncompensation = "controller"\n') == ["profile-value"]
    assert codes(GOOD + "axes = true\n") == ["profile-key"]  # it stands in [limits]


def test_the_fingerprint_of_a_profile_is_of_its_values_alone():
    builtin = machines.builtin("b3-compact")
    again, _ = machines.of_file(as_toml(builtin), "other.toml")
    assert fingerprint(again) == fingerprint(builtin)
    slower = replace(builtin, limits=replace(builtin.limits, line_um=9_999))
    assert fingerprint(slower) != fingerprint(builtin)
    assert len({fingerprint(machines.builtin(n)) for n in machines.names()}) == len(
        machines.names()
    )


# --- words of ISO ---------------------------------------------------------------------------------

ISO = GOOD.replace('"3b"', '"iso"') + "[iso]\n"
WORDS = (
    ISO + 'subprograms = "N-label"\nsemicolon = "block"\nij = "to-start"\npoints = "inch"\n'
    'integers = "0.0001in"\noffsets = "diameter"\noffset_word = "H"\n'
    '[iso.words.harmless]\nM20 = "threads the wire"\nT = "pumps"\nM80-M85 = "feeds"\n'
    '"G61.1" = "exact stop"\nC000-C999 = "conditions"\n'
    '[iso.words.refused]\nM60 = "turns the part"\nM84 = "unknown"\n'
    '[iso.words.path]\nM98 = "calls"\nG00-G03 = "motion"\n"G91.1" = "centres"\n'
)


def test_words_of_a_dialect():
    machine, found = machines.parse(WORDS, "t.toml")
    assert found == []
    words = machine.iso.words
    assert words.harmless[0] == ("M20", "threads the wire")
    told = {
        ("M", 200): "HARMLESS",
        ("M", 80): "NOT",
        ("T", 840): "HARMLESS",
        ("T", 15): "HARMLESS",
        ("T", -1): "HARMLESS",
        ("M", 840): "REFUSED",
        ("M", 850): "HARMLESS",
        ("M", 855): "NOT",
        ("M", 600): "REFUSED",
        ("G", 911): "PATH",
        ("G", 611): "HARMLESS",
        ("G", 610): "NOT",
        ("G", 20): "PATH",
        ("C", 10): "HARMLESS",
        ("C", 10_000): "NOT",
        ("X", 10): "NOT",
    }
    assert {k: words.class_of(*k).name for k in told} == told
    assert words.lists_codes
    again, found = machines.parse(as_toml(machine), "t.toml")
    assert (again, found) == (machine, [])
    other, _ = machines.parse(WORDS.replace("M60 =", "M61 ="), "t.toml")
    assert fingerprint(other) != fingerprint(machine)
    assert not machines.builtin("iso-um").iso.words


@pytest.mark.parametrize(
    ("table", "line", "said"),
    [
        ("harmless", 'MOVE = "x"', "is no key"),
        ("harmless", 'm20 = "x"', "is no key"),
        ("harmless", 'M85-M80 = "x"', "backwards"),
        ("harmless", 'M = "x"', "one by one"),
        ("refused", 'G = "x"', "one by one"),
        ("harmless", "M20 = 5", "plain words"),
        ("harmless", 'M20 = ""', "plain words"),
        ("harmless", 'M2 = "x"', "known to every controller"),
        ("refused", 'M00 = "x"', "known to every controller"),
        ("refused", 'M25-M35 = "x"', "known to every controller"),
        ("harmless", 'X = "x"', "is a place"),
        ("harmless", 'U = "x"', "is a place"),
        ("harmless", 'G00-G09 = "x"', "holds G0, which the reader runs"),
        ("harmless", 'M98 = "x"', "holds M98, which the reader runs"),
        ("path", 'M20 = "x"', "cannot run"),
        ("path", 'G05 = "x"', "cannot run"),
        ("path", 'G00-G05 = "x"', "holds G5, which the reader cannot run"),
        ("path", 'Q = "x"', "cannot run"),
        ("path", 'M98 = "x"', "takes 'iso.subprograms'"),
    ],
)
def test_wrong_words(table, line, said):
    text = ISO + f"[iso.words.{table}]\n{line}\n"
    machine, found = machines.parse(text, "t.toml")
    assert machine is None
    assert [d.code for d in found] == ["profile-value"]
    assert said in found[0].message
    assert str(found[0].span) == f"t.toml:{len(text.splitlines())}:1"


@pytest.mark.parametrize(
    ("one", "two", "wrong"),
    [
        ('M20 = "a"', 'M20 = "b"', True),
        ('M8 = "a"', 'M08 = "b"', True),
        ('T = "a"', 'T = "b"', True),
        ('M80-M85 = "a"', 'M83-M88 = "b"', True),
        ('M80-M85 = "a"', 'M83 = "b"', False),
        ('T = "a"', 'T84 = "b"', False),
        ('C000-C999 = "a"', 'C100-C200 = "b"', False),
    ],
)
def test_no_word_is_of_two_classes(one, two, wrong):
    text = ISO + f"[iso.words.harmless]\n{one}\n[iso.words.refused]\n{two}\n"
    assert codes(text) == ["profile-value"] * wrong
    assert codes(ISO + '[iso.words.harmless]\nM8 = "a"\nM08 = "b"\n') == ["profile-value"]


def test_wrong_tables_of_words():
    assert codes(ISO + "words = 3\n") == ["profile-value"]
    assert codes(ISO + "[iso.words]\nharmless = 3\n") == ["profile-value"]
    assert codes(ISO + '[iso.words.harmles]\nM20 = "a"\n') == ["profile-key"]
    assert codes(GOOD + '[iso.words.harmless]\nM20 = "a"\n') == ["profile-key"]


@pytest.mark.parametrize("key", ["M98-M99", "M098", "M99", "M97-M99"])
def test_a_word_that_calls_takes_a_style_of_subprograms(key):
    text = ISO + f'[iso.words.path]\n{key} = "calls"\n'
    assert codes(text) == ["profile-value"]
    styled = text.replace("[iso]\n", '[iso]\nsubprograms = "O-number"\n', 1)
    assert styled != text
    assert codes(styled) == []


@pytest.mark.parametrize(
    ("header", "writes", "good"),
    [
        ([], True, False),
        (["G40"], True, False),
        (["G21", "G20"], True, False),
        (["(G21)"], True, False),
        (["; G21"], True, False),
        (["G40 G21"], True, True),
        (["g 071"], True, True),
        ([], False, True),
    ],
)
def test_points_in_inches_are_not_written_in_mm(header, writes, good):
    text = ISO + 'unit = "mm"\npoints = "inch"\n'
    text = text.replace("[limits]", f"writes = {str(writes).lower()}\n[limits]")
    text += f"[layout]\nheader = {header}\n".replace("'", '"')
    assert codes(text) == ([] if good else ["profile-value"])

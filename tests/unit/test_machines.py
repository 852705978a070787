from dataclasses import replace

import pytest

from wedmcam import machines
from wedmcam.machines.printed import as_toml, fingerprint

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
    assert machine.own_stepping.table == machine.line_table
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

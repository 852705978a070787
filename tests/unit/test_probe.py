"""The probe: every kind of controller gives readings of its own, and they lead back to it."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fork_server
from wedmcam import machines, probe
from wedmcam.controllers.pointwise import LineTable, block_steps
from wedmcam.diag import Severity
from wedmcam.frontends import decoder
from wedmcam.ir.program import Kind
from wedmcam.machines import Axes
from wedmcam.probe import PARTS, Behaviour, Record, behaviours, stops
from wedmcam.probe.answers import ROOM, Readings, _kinds
from wedmcam.probe.page import page
from wedmcam.probe.records import blocks

B3 = [n for n in machines.names() if machines.builtin(n).format == "3b"]
EVERY = [*behaviours(), *behaviours(pauses=False)]


def as_sheet(controller, parts=tuple(PARTS), noise=lambda: 0.0):
    """What a shop would write down, mm."""
    return "\n".join(
        f"{part} {s.x / 1000 + noise():.3f} {s.y / 1000 + noise():.3f}{' alarm' * s.alarm}"
        for part in parts
        for s in stops(part, controller)
    )


def told(text):
    readings, wrong = probe.read_sheet(text, "s.txt")
    answers, found = probe.answers(readings, "s.txt")
    assert not wrong
    return {a.field: a.values for a in answers}, found


def test_there_are_hundreds_and_no_two_read_alike():
    read = {tuple(stops(part, b) for part in PARTS): b for b in EVERY}
    assert len(read) == len(EVERY) > 600


@pytest.mark.parametrize("part", PARTS)
def test_what_a_program_asks_differs_by_more_than_a_dial_misreads(part):
    for a, b in itertools.combinations(_kinds(part), 2):
        one, two = stops(part, a), stops(part, b)
        if one == two:  # of the one, the other is not asked: a deleted record is never X = Y = 0
            assert part == "blanks"
            continue
        if len(one) != len(two) or any(p.alarm != q.alarm for p, q in zip(one, two, strict=True)):
            continue
        ways = [np.diff([(0, 0), *((s.x, s.y) for s in some)], axis=0) for some in (one, two)]
        assert np.abs(ways[0] - ways[1]).max() > 2 * ROOM, (a, b)


def test_every_controller_is_found_again_from_readings_to_a_hundredth():
    rng = np.random.default_rng(3)
    for b in EVERY:
        got, found = told(as_sheet(b, noise=lambda: rng.uniform(-0.005, 0.005)))
        assert not found
        if b.pause != "waits":
            assert got["pause"] == (b.pause,)
            assert "table" not in got
            continue
        for field in ("table", "arcs", "pause", "stop", "end", "zeros", "blanks"):
            assert got[field] == (getattr(b, field),), (field, b)


def test_lines_and_arcs_are_those_of_the_step_loop():
    for table in ("rotate", "mirror"):
        wanted = [(0, 0)]
        for section in PARTS["main"][:7]:
            x, y = wanted[-1]
            for step in section.steps:
                if isinstance(step, Record):
                    *_, last = block_steps(step.block, LineTable(table))
                    x, y = x + last.x, y + last.y
            wanted.append((x, y))
        assert [(s.x, s.y) for s in stops("main", Behaviour(table=table))] == wanted[1:]


@pytest.mark.parametrize("name", B3)
@pytest.mark.parametrize("part", PARTS)
def test_the_text_says_what_is_simulated(name, part):
    machine = machines.builtin(name)
    data = probe.text(part, machine)
    program, found = decoder("3b")(data, machine, "probe.3b")
    assert not [d for d in found if d.severity is Severity.ERROR]
    wanted = blocks(part)
    got = program.blocks[program.blocks["kind"] <= Kind.MOVE]
    fields = ["turn", "axis", "x", "y", "count"]
    assert got[fields].tolist() == wanted[fields].tolist()
    assert data.endswith(machine.layout.eol.encode())
    kinds = {Kind.PAUSE: "pause", Kind.STOP: "stop", Kind.END: "end"}
    words = [kinds[k] for k in program.blocks["kind"].tolist() if k in kinds]
    assert words == [s for sec in PARTS[part] for s in sec.steps if isinstance(s, str)]


def test_blanks_are_written_blank_and_words_are_the_profiles():
    ours = replace(machines.builtin("b3-compact"), words=machines.Words("M00", "M02", "M30"))
    assert b"B1000BB1000GXL1\nM00\nBBB500GYL2\nM00\nM02\n" in probe.text("blanks", ours)
    columns = probe.text("blanks", machines.builtin("b3-columns")).decode()
    assert columns.splitlines()[0] == "B   1000 B        B 001000 GX L1"


def test_nobody_leaves_the_box_that_is_told():
    for part in PARTS:
        x0, y0, x1, y1 = probe.extents(part)
        assert x1 - x0 < 6000
        assert y1 - y0 < 6000
        for b in EVERY:
            for s in stops(part, b):
                assert x0 <= s.x <= x1
                assert y0 <= s.y <= y1


def test_the_page_has_the_numbers_of_the_models():
    text = page()
    assert (Path(__file__).parents[2] / "docs" / "probe.md").read_text("utf-8") == text
    ways = [s.split("|")[1:4] for s in text.splitlines() if s.startswith("| quadrant")]
    got = {(stop.strip(), means.strip()[:60]): way.strip() for stop, way, means in ways}
    turned = "lines are stepped by the table that is turned"
    mirrored = "lines are stepped by the table that is mirrored"
    assert next(w for (s, m), w in got.items() if (s, m[:45]) == ("quadrant 4", turned)) == (
        "+0.950 -1.000"
    )
    assert next(w for (s, m), w in got.items() if (s, m[:47]) == ("quadrant 2", mirrored)) == (
        "-1.000 +0.950"
    )


@pytest.mark.parametrize("step_um", [0.5, 1.0, 2.0, 5.0, 10.0])
@pytest.mark.parametrize("way", list(itertools.product((False, True), repeat=3)))
def test_where_the_wire_went_gives_the_axes(way, step_um):
    """The probe's own second section, read with a profile of these axes: it goes as measured."""
    axes = Axes(*way, step_um)
    machine = replace(machines.builtin("b3-compact"), axes=axes)
    program, _ = decoder("3b")(b"B2000B0B2000GXL1 B0B1000B1000GYL2", machine, "k")
    x, y = (int(program.blocks[k].sum()) * step_um for k in ("x", "y"))
    assert probe.axes_of((x * 1.01, y * 0.99)) == axes
    text = probe.toml([], (x, y))
    made, found = machines.parse(GOOD + text, "t.toml")
    assert not found
    assert made.axes == axes


GOOD = """title = "T"
format = "3b"
line_table = "rotate"
[limits]
count_um = 999999
line_um = 999999
arc_um = 999999
"""


def test_a_measurement_that_fits_nothing_is_told():
    assert probe.axes_of((1000, 1000)) is None
    assert probe.axes_of((0, 0)) is None
    assert "measure again" in probe.toml([], (1000, 1000))


def test_what_fits_no_controller_is_refused_at_its_stop():
    text = as_sheet(Behaviour(), ("main",)).splitlines()
    text[3] = "main 2.000 2.300"
    _, found = told("\n".join(text))
    assert [d.code for d in found] == ["probe-reading"]
    assert "stop 4 of main" in found[0].message
    _, found = told("\n".join(text[:3]))
    assert "controllers stop elsewhere too" in found[0].message
    # Told to go on once more where the program had ended: the same place again is no reading.
    again = as_sheet(Behaviour(), ("main",))
    got, found = told(again + "\n" + again.splitlines()[-1])
    assert not found
    assert got["table"] == ("rotate",)


@settings(deadline=None, max_examples=200)
@given(text=st.text(st.sampled_from("main zeros blanks end moved alarm 0123456789.-+,_#\n \x00é")))
def test_any_sheet_gives_answers_or_findings(text):
    readings, wrong = probe.read_sheet(text, "s.txt")
    answers, found = probe.answers(readings, "s.txt")
    assert {d.code for d in (*wrong, *found)} <= {"probe-reading"}
    assert probe.toml(answers, readings.moved)


def test_an_empty_sheet_says_nothing():
    readings, wrong = probe.read_sheet(probe.sheet({}), "s.txt")
    assert readings == Readings({}, {})
    assert not wrong


def run(*arguments, cwd):
    return fork_server.wedmcam("profile", "probe", *arguments, cwd=cwd)


def test_readings_are_not_written_over(tmp_path):
    assert run("-o", "p.3b", cwd=tmp_path).returncode == 0
    assert run("-o", "p.3b", cwd=tmp_path).returncode == 0  # an empty sheet may be
    (tmp_path / "p.txt").write_text("moved -2.0 1.0\n", "utf-8")
    done = run("-o", "p.3b", cwd=tmp_path)
    assert done.returncode == 2
    assert b"no empty sheet" in done.stderr
    assert (tmp_path / "p.txt").read_text("utf-8") == "moved -2.0 1.0\n"


def test_the_command(tmp_path):
    done = run("-o", "p.3b", "--profile", "b3-columns", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    names = sorted(p.name for p in tmp_path.iterdir())
    assert names == ["p-blanks.3b", "p-end.3b", "p-zeros.3b", "p.3b", "p.txt"]
    assert b"needs x -1 to 4.506, y -1 to 3 mm" in done.stdout
    sheet = (tmp_path / "p.txt").read_text("utf-8")
    filled = as_sheet(Behaviour(table="mirror", arcs="recomputed", blanks="refused"))
    (tmp_path / "p.txt").write_text(sheet + filled + "\nmoved -2.0 1.0\n", "utf-8")
    done = run("--read", "p.txt", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    keys = done.stdout.decode()
    assert 'line_table = "mirror"\ncount = "textbook"\n[axes]\n' in keys
    assert "mirror_x = true" in keys
    for wrong, said in (
        (["-o", "p.nc", "--profile", "iso-um"], b"states where it ends"),
        (["-o", "p.zd", "--profile", "zd065"], b"are published"),
        (["-o", "-"], b"several files"),
        (["-o", "q.nc"], b"the name of another format"),
        ([], b"give -o FILE.3b, or --read SHEET"),
    ):
        done = run(*wrong, cwd=tmp_path)
        assert done.returncode == 2
        assert said in done.stderr
    (tmp_path / "bad.txt").write_text("main one two\n")
    done = run("--read", "bad.txt", cwd=tmp_path)
    assert done.returncode == 1
    assert b"error[probe-reading]" in done.stderr

"""The terminal of Eindhoven's microcomputer: transcripts, refusals, priorities, and any line."""

import copy
import json
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fork_server import wedmcam
from wedmcam.diag import Diagnostic
from wedmcam.operations.simulate import simulate_program
from wedmcam.panel.script import lines_of, play_script
from wedmcam.panel.terminal import COMMANDS, SCREEN, WHILE, Mode, Terminal

ROOT = Path(__file__).parents[2]
PANEL = ROOT / "tests" / "golden" / "panel"
#: Two vectors, a pause, a vector with the generator off, and one back.
RECORDS = """\
UM
0 0 400 0 100 200 64
400 0 400 300 100 200 32
P
400 300 0 300 0 0 127
0 300 0 0 100 200 64
E
"""
#: Mode -> lines that lead to it.
WAYS = {
    Mode.STANDBY: [],
    Mode.RUNNING: ["G", "run 120"],
    Mode.HALTED: ["G", "run"],
    Mode.EMERGENCY: ["G", "run 120", "stop"],
}


def terminal(*lines, records=RECORDS):
    terminal = Terminal()
    for line in [*records.splitlines(), *lines]:
        terminal.play(line)
    return terminal


def terminal_in(mode):
    there = terminal(*WAYS[mode])
    assert there.mode is mode
    return there


def said(terminal, line):
    return [one.text for one in terminal.play(line).shown]


def snapshot(terminal):
    machine = terminal.machine
    fields = ("unit", "records", "place", "tape", "setup", "state", "origin", "paused", "time_s")
    held = [copy.copy(getattr(machine, name)) for name in fields]
    return held, terminal.mode, terminal._waiting, terminal._one_vector


# --- transcripts ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["dem15-part", "dem15-refused", "dem15-priorities"])
def test_transcripts(name, update_golden):
    keys = (PANEL / f"{name}.keys").read_text("utf-8")
    text = ""
    for line in play_script(Terminal(), keys, f"{name}.keys"):
        assert not isinstance(line, Diagnostic)
        text += "".join(f"{one}\n" for one in lines_of(line))
    golden = PANEL / f"{name}.txt"
    if update_golden:
        golden.write_text(text, "utf-8")
    assert golden.read_text("utf-8") == text


# --- entering -------------------------------------------------------------------------------------


def test_a_file_typed_in_is_the_program_of_the_file():
    for data in (RECORDS, "STEPS\n0 7 65535 7 255 170 127\nE\n"):
        there = terminal(records=data)
        assert there.saved() == (data.encode(), [])
        other = Terminal()
        assert other.load(data.encode(), "a.d15") == []
        assert other.machine.records == there.machine.records
        assert other.machine.unit == there.machine.unit


def test_corrections_enter_the_corrected_line():
    there = terminal(records="")
    line = "0 0 40<BS><BS><DEL>x<^U>0,0, 500<BS><BS><BS>400 0 100 200 64"
    assert said(there, line)[-1].endswith("0.67 A")
    assert there.machine.records == ["0 0 400 0 100 200 64"]


def test_a_terminator_within_what_is_typed_ends_a_line():
    there = terminal(records="")
    assert len(said(there, "0 0 400 0 100 200 64\r400 0 0 0 0 5\b0 127\nE")) == 4
    assert there.saved()[0] == b"UM\n0 0 400 0 100 200 64\n400 0 0 0 0 0 127\nE\n"


#: Line -> where the mark stands, how long it is, and what is said; typed behind RECORDS up to P.
REFUSED = {
    "400 300 65536 300 0 0 127": (8, 5, "new x has more than 16 bits"),
    "400 300 99999999999 300 0 0 127": (8, 11, "new x has more than 16 bits"),
    "400 300 401 300 0 0 127": (8, 3, "is odd"),
    "400 300 400 301 0 0 127": (12, 3, "is odd"),
    "400 302 400 400 0 0 127": (4, 3, "and the record before ends at (400, 300)"),
    " 402 300 400 400 0 0 127": (1, 3, "and the record before ends at (400, 300)"),
    "400 300 400 300 0 0 127": (8, 3, "a vector without a step"),
    "400 300 0 300 100 118 64": (18, 3, "below 7 V"),
    "400 300 0 300 256 200 64": (14, 3, "t(i) is 256; it goes to 255"),
    "400 300 0 300 255 150 64": (14, 3, "would draw 2.27 A"),
    "400 300 0 300 0 200 64": (14, 1, "t(i) is 0"),
    "400 300 0 300 100 200 0": (22, 1, "the controller takes 1 to 127"),
    "400 300 0 300 100 200 128": (22, 3, "the controller takes 1 to 127"),
    "400 300 0 300 100 200": (21, 1, "speed is missing"),
    "400 300 0 300 100 200 64 1": (25, 1, "nothing more is expected"),
    "400 300 0 300 100 200 64x": (24, 1, "this is no digit"),
    "400 300 -4 300 100 200 64": (8, 1, "this is no digit"),
    "STEPS": (0, 5, "positions count um already"),
    "go": (0, 2, "no such command"),
    " d 7x": (4, 1, "this is no digit"),
    "D 9": (0, 1, "there is no record 9"),
    "A 1": (3, 1, "y is missing"),
    "A 1 2": (0, 1, "(1, 2) is odd"),
    "O 40F0": (0, 1, "the outputs are 4020"),
    "O 14020": (2, 5, "more than 16 bits"),
    "S": (0, 1, "has no end"),
    "G": (0, 1, "has no end"),
    "L": (0, 1, "no tape"),
    "C": (0, 1, "not done while nothing is run"),
    "0 " * 32 + "12": (64, 1, "a line has 64 characters"),
    "400 300 0 3\N{MICRO SIGN}00 0 0 127": (11, 1, "none of the terminal's"),
    "400 300 0 3\x1b00 0 0 127": (11, 1, "none of the terminal's"),
}


@pytest.mark.parametrize("line", REFUSED)
def test_a_refused_line_changes_nothing_and_is_marked(line):
    there = terminal(records="\n".join(RECORDS.splitlines()[:4]))
    before = snapshot(there)
    answers = said(there, line)
    if answers[-1].startswith("hint: "):
        answers.pop()
    *_, shown, mark, why = answers
    at, length, text = REFUSED[line]
    assert why.startswith("refused: ")
    assert text in why
    assert mark == " " * at + "^" + "~" * (length - 1), (mark, shown)
    assert snapshot(there) == before


def test_the_refused_line_comes_back_to_be_corrected():
    there = terminal(records="")
    assert "is odd" in said(there, "0 0 401 0 100 200 64")[-1]
    assert "is odd" in said(there, "<^R>")[-1]
    assert said(there, f"<^R>{'<BS>' * 14}0 0 100 200 64")[-1].startswith("record 1")
    assert there.machine.records == ["0 0 400 0 100 200 64"]
    # 64 characters and what did not fit: nothing is entered unless the line is corrected.
    long = "0 0 400 0" + " " * 47 + "100 200 64"
    assert len(long) == 66
    there = terminal(records="")
    assert said(there, long)[-1].startswith("hint: control R")
    assert there.machine.records == []
    assert said(there, "<^R>" + "<BS>" * 10 + "0 200 64")[-2].startswith("refused")  # t(i) is 0
    assert said(there, "<^R>" + "<BS>" * 10 + "10 200 64")[-1].startswith("record 1")


@pytest.mark.parametrize("mode", Mode)
def test_a_command_out_of_its_mode_changes_nothing(mode):
    for word, command in COMMANDS.items():
        if mode in command.modes:
            continue
        there = terminal_in(mode)
        before = snapshot(there)
        if mode is Mode.RUNNING:
            there._main(word.encode())  # it waits, and is read at the end of the vector
        else:
            assert WHILE[mode] in said(there, word)[-1]
        assert snapshot(there) == before


# --- running --------------------------------------------------------------------------------------


def test_the_machine_is_the_simulated_one():
    there = terminal("G", "run", "C", "run")
    record = simulate_program(RECORDS.encode(), controller="eindhoven", name="a.d15").record
    assert there.machine.place == record.final_um
    assert there.machine.time_s == pytest.approx(record.state.time_s)
    assert there.mode is Mode.STANDBY


@settings(max_examples=60)
@given(st.data())
def test_a_run_in_pieces_is_a_run(data):
    there = terminal("G")
    for _ in range(data.draw(st.integers(0, 8))):
        there.play(data.draw(st.sampled_from(["run 7", "run 333", "V", "H", "W", "run"])))
        there.play(data.draw(st.sampled_from(["stop", "limit", "break", "short 50", "short 999"])))
        there.play(data.draw(st.sampled_from(["C", "V", "W"])))
    for _ in range(8):
        if there.mode is Mode.STANDBY:
            break
        there.play("C")
        there.play("run")
    assert there.mode is Mode.STANDBY
    assert there.machine.place == (0, 0)


def test_a_line_waits_for_the_end_of_the_vector_and_an_emergency_does_not():
    there = terminal("G", "run 150")
    assert said(there, "h") == []
    assert there.mode is Mode.RUNNING
    other = copy.deepcopy(there)
    assert there.play("run 500").mode == Mode.HALTED
    assert there.machine.here == 200  # the end of the first vector
    assert there.machine.place == (400, 0)
    # An emergency comes before the line that was typed earlier, which is not read any more.
    shown = said(other, "stop")
    assert shown[0].startswith("EMERGENCY")
    assert shown[-1] == "not read: h"
    assert other.machine.place == (300, 0)
    assert other.mode is Mode.EMERGENCY


@pytest.mark.parametrize("happens", ["stop", "limit", "break", "short 9999", "run"])
def test_a_line_typed_before_never_starts_a_machine_that_stopped(happens):
    for line in ("c", "v", "g"):
        there = terminal("G", "run 300", line)
        there.play(happens)
        assert there.mode is (Mode.HALTED if happens == "run" else Mode.EMERGENCY)


@pytest.mark.parametrize("happens", ["stop", "limit", "break", "short 9999"])
def test_after_an_emergency_places_are_kept_and_outputs_are_safe(happens):
    there = terminal("G", "run 150")
    assert there.play(happens).mode == Mode.EMERGENCY
    assert there.machine.place == ((0, 0) if happens == "short 9999" else (300, 0))
    safe = [
        "4020 V(t(i)) 00H, 0.00 V",
        "4021 V(t(p)) 00H, 0.00 V",
        "4022 OEV 1, the generator is off",
    ]
    assert said(there, "o") == safe
    assert said(Terminal(), "O") == safe


def test_ports_show_the_words_of_the_record_that_is_run():
    there = terminal("G", "run 150", "O")
    assert said(there, "run 50")[1:4] == [
        "4020 V(t(i)) 64H, 1.96 V",
        "4021 V(t(p)) C8H, 11.76 V",
        "4022 OEV 0, the generator is on",
    ]


def test_a_wire_neither_breaks_nor_shorts_where_the_generator_is_off():
    there = terminal("G", "run", "C", "run 60")
    before = snapshot(there)
    for happens in ("break", "short 40"):
        assert "generator is off" in said(there, happens)[0]
        assert snapshot(there) == before
    for happens in ("break", "short 40", "run", "run 3", "run to record 1"):
        assert said(Terminal(), happens) == ["nothing happens: nothing is run"]


def test_every_pause_waits_even_before_the_first_step():
    there = terminal("G", records="UM\nP\nP\n0 0 40 0 100 200 64\nP\nE\n")
    waits = 0
    for _ in range(9):
        waits += there.play("run").mode == Mode.HALTED
        there.play("C")
    assert waits == 3
    assert there.machine.place == (40, 0)


def test_a_program_that_begins_where_the_wire_is_not_is_refused():
    there = terminal("G", "run 100", "stop", "K")
    assert there.machine.place == (200, 0)
    assert said(there, "G")[-1] == "hint: A X Y states where the wire stands"
    there.play("A 0 0")
    assert there.play("G").mode == Mode.RUNNING


def test_a_tape_keeps_the_program():
    there = terminal("S", "N")
    assert there.machine.records == []
    assert there.saved()[0] is None
    there.play("L")
    assert there.saved()[0] == RECORDS.encode()


def test_a_long_program_is_listed_by_screens():
    records = "UM\n" + "".join(f"{2 * i} 0 {2 * i + 2} 0 0 0 127\n" for i in range(20)) + "E\n"
    there = terminal(records=records)
    assert said(there, "D")[-1] == f"D {SCREEN + 1} goes on"
    assert len(said(there, "D 17")) == 5


# --- whatever is typed ----------------------------------------------------------------------------

WORDS = st.sampled_from([*COMMANDS, *RECORDS.split("\n"), "D 3", "A 0 0", "O 4021", "<^R>"])
HAPPENS = st.sampled_from(
    "run;run 9;run 200;run to record 3;stop;limit;break;short 30;short 900;wait 3s".split(";")
)
BYTES = st.binary(max_size=80).map(lambda data: data.decode("latin-1"))
LINES = st.one_of(WORDS, WORDS, HAPPENS, st.text(max_size=80), BYTES)


@settings(max_examples=200)
@given(st.booleans(), st.lists(LINES, max_size=14))
def test_whatever_is_typed_the_terminal_answers(entered, lines):
    there = terminal() if entered else Terminal()
    for text in lines:
        line = there.play(text)
        assert line.mode in set(Mode)
    data, findings = there.saved()
    assert data is not None or findings
    # What was taken in can be run as far as it goes.
    there.machine.records = [r for r in there.machine.records if r != "E"] + ["E"]
    assert there.saved()[0] is not None


@given(st.binary(max_size=300))
def test_any_file_is_loaded_or_refused(data):
    there = Terminal()
    findings = there.load(data, "a.d15")
    assert findings or there.saved()[0] is not None


# --- the command ----------------------------------------------------------------------------------


def test_the_command(tmp_path):
    (tmp_path / "a.d15").write_text(RECORDS)
    (tmp_path / "a.keys").write_text("G\nrun 100\nstop\n")
    done = wedmcam("panel", "dem15", "a.d15", "--script", "a.keys", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert facts["controller"] == "eindhoven"
    assert facts["ok"]
    assert facts["lines"][-1]["mode"] == "emergency"
    assert facts["lines"][-1]["place"] == [200, 0]
    # Entered by hand, and written; the file runs.
    command = ["panel", "eindhoven", "--script", "-", "-o", "b.d15"]
    done = wedmcam(*command, stdin=RECORDS.encode(), cwd=tmp_path)
    assert (tmp_path / "b.d15").read_text() == RECORDS
    # A program without its end is no file.
    done = wedmcam("panel", "dem15", "-o", "c.d15", stdin=RECORDS.encode()[:-2], cwd=tmp_path)
    assert done.returncode == 1
    assert b"error[no-end]" in done.stderr
    assert not (tmp_path / "c.d15").exists()
    (tmp_path / "odd.d15").write_text("UM\n0 0 401 0 100 200 64\nE\n")
    done = wedmcam("panel", "dem15", "odd.d15", stdin=b"", cwd=tmp_path)
    assert done.returncode == 1
    assert b"odd.d15:2:5: error[place-step]" in done.stderr


def test_the_page_names_every_command_with_its_modes():
    page = (ROOT / "docs" / "dem15.md").read_text("utf-8")
    for word, command in COMMANDS.items():
        numbers = " ".join(f"[{n}]" if not command.least else n for n in command.numbers)
        when = "always" if set(command.modes) == set(Mode) else ", ".join(sorted(command.modes))
        row = f"| {' '.join(filter(None, (word, numbers)))} | {command.name} | {when} |"
        assert re.search(re.escape(row), page), row

"""The panel of the ZD-065: transcripts, the interlock, and whatever keys somebody presses."""

import copy
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fork_server import wedmcam
from wedmcam.diag import Diagnostic
from wedmcam.panel.keys import DIGITS, KEYS
from wedmcam.panel.script import lines_of, play_script
from wedmcam.panel.zd065 import FUNCTIONS, Mode, Panel, unlocked

PANEL = Path(__file__).parents[1] / "golden" / "panel"
#: Data of three blocks with a thread point, recognised, with backlash, begun to cut.
BEGUN = "U0 0 0000 01 001900 000400 30 02 000500 000700 00 U0 U0 1 U5 0 0012 0015 U6 1"
#: Mode -> lines that lead to it.
WAYS = {
    Mode.READY: [],
    Mode.RUNNING: [BEGUN],
    Mode.HALTED: [BEGUN, "run"],
    Mode.ALARM: [BEGUN, "run 500", "short 900"],
    Mode.BROKEN: [BEGUN, "run 500", "break"],
    Mode.OFF: [BEGUN, "run 500", "power off"],
    Mode.SAVED: [BEGUN, "run 500", "power off", "power on"],
}


def play(panel, text):
    return panel.play(text)


def panel_in(mode):
    panel = Panel()
    for line in WAYS[mode]:
        assert play(panel, line) is not None
    assert panel.mode is mode
    return panel


def snapshot(panel):
    """Return everything but the digits."""
    machine = panel.machine
    rest = {k: v for k, v in vars(panel).items() if k not in ("machine", "digits")}
    fields = ("image", "recognised", "conditions", "setup", "state", "tape", "time_s")
    return rest, [getattr(machine, name) for name in fields]


@pytest.mark.parametrize("name", ["paper", "locked", "memory"])
def test_transcripts(name, update_golden):
    keys = (PANEL / f"{name}.keys").read_text("utf-8")
    text = ""
    for line in play_script(Panel(), keys, f"{name}.keys"):
        assert not isinstance(line, Diagnostic)
        text += "".join(f"{one}\n" for one in lines_of(line))
    golden = PANEL / f"{name}.txt"
    if update_golden:
        golden.write_text(text, "utf-8")
    assert golden.read_text("utf-8") == text


def test_the_paper_ends_where_its_programs_end():
    panel, ends = Panel(), []
    for line in play_script(panel, (PANEL / "paper.keys").read_text("utf-8"), "paper.keys"):
        ends += [one.text for one in line.shown if one.text.endswith("end of the program")]
    assert len(ends) == 3  # drawn dry, cut with everything, the outline
    assert all("table (0.000, 0.000) mm" in text for text in ends)


@pytest.mark.parametrize("mode", Mode)
def test_a_locked_key_changes_nothing(mode):
    """All functions of all keys, digits without a function, and digits alone."""
    panel = panel_in(mode)
    open_ = set(unlocked(mode))
    for key in FUNCTIONS:
        for digit in DIGITS:
            if f"{key} {digit}" in open_:
                continue
            before = snapshot(panel)
            shown = panel.press(key)
            if not shown:  # another function of this key is open
                shown = panel.press(digit)
            assert shown[-1].digits.startswith("E   0"), (key, digit)
            assert snapshot(panel) == before
    for digit in DIGITS:
        before = snapshot(panel)
        assert panel.press(digit)[-1].digits == "E   01"
        assert snapshot(panel) == before


def test_every_mode_lets_somebody_out():
    """But for the one without power, and the one in which the machine runs by itself."""
    for mode in set(Mode) - {Mode.OFF, Mode.RUNNING}:
        assert unlocked(mode)
    assert not unlocked(Mode.OFF)
    assert not unlocked(Mode.RUNNING)


def test_cutting_needs_recognised_data_and_backlash():
    panel = Panel()
    assert panel.press("U6") == []
    assert panel.press("1")[-1].digits == "E   05"
    play(panel, "U0 0 0000 01 001900 000400 00 U0")
    play(panel, "U0 1")
    assert play(panel, "U6 1").shown[-1].digits == "E   04"
    play(panel, "U5 0 0000 0000")  # no play counts as entered
    assert play(panel, "U6 1").mode == "running"


def test_data_that_are_changed_have_to_be_recognised_again():
    panel = Panel()
    play(panel, "U0 0 0000 01 001900 000400 00 U0 U0 1")
    play(panel, "U0 0 0001 00 U0")
    assert play(panel, "U6 0 0001").shown[-1].digits == "E   05"


HAPPENS = """run; run 40; run to block 3; short 30; short 300; break; power off; power on; wait 3s;
U7 0; U7 2; U7 1 0003; U6 0 0001; U2 1; U3 0 01 0215"""
HAPPENS = [BEGUN, *(" ".join(line.split()) for line in HAPPENS.split(";"))]
LINES = st.one_of(
    st.lists(st.sampled_from(KEYS), min_size=1, max_size=12).map(" ".join),
    st.sampled_from(HAPPENS),
)


@settings(max_examples=150)
@given(st.lists(LINES, max_size=12))
def test_whatever_is_pressed_the_panel_answers(lines):
    panel = Panel()
    for text in lines:
        line = play(panel, text)
        assert line is not None
        for one in line.shown:
            assert len(one.digits) == 6, one
            assert one.text
        assert line.mode in set(Mode)


@settings(max_examples=100)
@given(st.data())
def test_a_run_in_pieces_is_a_run(data):
    """However often it is stopped, shorted, broken or cut off, it ends in the same place."""
    panel = panel_in(Mode.RUNNING)
    for _ in range(data.draw(st.integers(0, 6))):
        play(panel, f"run {data.draw(st.integers(1, 400))}")
        happens = data.draw(st.sampled_from(["short 50", "break", "power off", "run 3"]))
        play(panel, happens)
        for line in ("power on", "U7 0", "U7 2"):
            play(panel, line)
    last = ""
    for _ in range(10):
        play(panel, "U7 0")
        play(panel, "U7 2")
        shown = play(panel, "run").shown
        last = shown[-1].text if shown else last
        if panel.mode is Mode.READY:
            break
    assert last.endswith("table (1.400, 1.100) mm: end of the program")


def test_the_command(tmp_path):
    (tmp_path / "a.keys").write_text(f"{BEGUN}\nrun 100\n")
    done = wedmcam("panel", "zd065", "--script", "a.keys", "--json", cwd=tmp_path)
    assert done.returncode == 0
    facts = json.loads(done.stdout)
    assert facts["controller"] == "zd065"
    assert facts["lines"][-1]["mode"] == "running"
    assert facts["lines"][-1]["time_s"] == pytest.approx(100 / 40, rel=0.3)
    done = wedmcam("panel", "zd065", "--script", "a.keys", "-o", "m.img", cwd=tmp_path)
    image = (tmp_path / "m.img").read_bytes()
    assert len(image) == 4096
    assert image.startswith(bytes.fromhex("01001900000400"))
    done = wedmcam("panel", "zd065", "m.img", "--script", "-", stdin=b"U0 1\n", cwd=tmp_path)
    assert b"[C    3]" in done.stdout
    (tmp_path / "b.keys").write_text("# a comment\nU0 1\nU9 1\nU0 1\n")
    done = wedmcam("panel", "zd065", "--script", "b.keys", "-o", "n.img", cwd=tmp_path)
    assert done.returncode == 1
    assert b"b.keys:3:1: error[bad-script]" in done.stderr
    assert not (tmp_path / "n.img").exists()


def test_a_copy_of_a_panel_is_one_of_its_own():
    panel = panel_in(Mode.BROKEN)
    other = copy.deepcopy(panel)
    play(other, "U7 0")
    assert panel.mode is Mode.BROKEN
    assert other.mode is Mode.HALTED

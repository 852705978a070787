"""wedmcam simulate: what a user types, and what comes of it."""

import csv
import functools
import io
import json
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_cli import wedmcam

import wedmcam as library
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.simulate.read import read_scenario
from wedmcam.simulate.ring import PATTERNS
from wedmcam.simulate.route import lay
from wedmcam.simulate.scenario import Fault, Trouble
from wedmcam.simulate.state import check_state, read_state

GOLDEN = Path(__file__).parents[1] / "golden"
KEY = str(GOLDEN / "key-punch.zd")
PLAY = ("--backlash", "12,15")


def run(*line, cwd=None):
    """Run simulate with --json; return its status, its JSON, and what it told people."""
    done = wedmcam("simulate", *line, "--json", cwd=cwd)
    return done.returncode, json.loads(done.stdout), done.stderr.decode()


def test_the_json_has_what_a_program_needs():
    status, facts, told = run(KEY, *PLAY, "--fault", "short@500:60", "--fault", "power@700")
    assert status == 0
    assert told == ""
    assert facts["ok"]
    assert facts["controller"] == "zd065"
    assert facts["steps"] == 112_600
    assert facts["final_um"] == [0, 0]
    assert facts["time_s"] == pytest.approx(112_660 / 40 + 60 * 0.005, rel=0.01)
    kinds = [event["event"] for event in facts["events"]]
    assert kinds == ["short", "clear", "power-cut", "resume", "end"]
    assert (
        facts["events"][0] | {"length": 60, "step": 500, "block": 1, "j": 2400}
        == (facts["events"][0])
    )
    assert facts["diagnostics"] == []


def test_without_backlash_the_machine_refuses_to_cut():
    status, facts, told = run(KEY)
    assert status == 1
    assert not facts["ok"]
    assert "error[no-backlash]" in told
    assert run(KEY, "--backlash", "0,0")[0] == 0
    assert run(KEY, "--dry-run", "5")[1]["time_s"] == pytest.approx(112_600 * 0.005)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (("--fault", "short@5"), "is no fault: write short@STEP:LENGTH_UM"),
        (("--fault", "wire@5:1"), "is no fault"),
        (("--backlash", "1"), "write whole um of x and y"),
        (("--backlash", "-1,2"), "write whole um of x and y"),
        (("--approach", "+"), "write the directions"),
        (("--seed", "3"), "give --random N"),
        (("--dry-run", "0"), "1<=x<=9999"),
        (("--controller", "agie"), "is not"),
        (("--plot", "x.txt"), "a picture ends in"),
        (("--pulses", KEY), "input"),
        (("--pulses", "-"), "takes standard output"),
        (("--scenario", "-", "--resume", "-"), "only one input"),
    ],
)
def test_wrong_use(line, said):
    done = wedmcam("simulate", KEY, *PLAY, *line, "--json")
    assert done.returncode == 2, done.stderr
    assert said in done.stderr.decode()


def test_a_fault_that_cannot_happen_is_an_error_of_the_input():
    status, facts, told = run(KEY, *PLAY, "--fault", "short@999999:60")
    assert status == 1
    assert "short@999999:60: the program makes 112600 steps" in told
    assert facts["diagnostics"][0]["code"] == "bad-fault"


def test_a_state_goes_on_the_next_day(tmp_path):
    whole = run(KEY, *PLAY)[1]
    status, first, _ = run(KEY, *PLAY, "--fault", "power@50000", "--state", "a.state", cwd=tmp_path)
    assert (status, first["ok"], first["finished"]) == (0, True, False)
    assert first["stopped_at"] == 50_000
    again = ("--resume", "a.state", "--state", "a.state", "--fault", "power@60000")
    status, second, _ = run(KEY, *again, cwd=tmp_path)
    assert second["stopped_at"] == 60_000
    status, third, _ = run(KEY, "--resume", "a.state", cwd=tmp_path)
    assert status == 0
    assert third["final_um"] == whole["final_um"]
    assert third["motor_um"] == whole["motor_um"]
    assert first["pulses"] + second["pulses"] + third["pulses"] == whole["pulses"]
    other = wedmcam("simulate", KEY, "--resume", "a.state", "--backlash", "3,3", cwd=tmp_path)
    assert other.returncode == 2
    assert "backlash is 3,3 here and 12,15 in the state" in other.stderr.decode()
    early = run(KEY, "--resume", "a.state", "--fault", "power@5", cwd=tmp_path)
    assert "the run begins at step 60000" in early[2]


#: Block 2 turns y back first behind this step of the key: its 15 um are taken up there.
TURN = 2900


def test_play_is_taken_up_once_however_often_the_power_fails():
    cuts = (f"power@{TURN}+5", f"power@{TURN}+10")
    whole = library.simulate_program(KEY, backlash=(12, 15))
    run = library.simulate_program(KEY, backlash=(12, 15), faults=cuts)
    assert run.ok
    assert run.record.pulses == whole.record.pulses
    more = library.simulate_program(KEY, backlash=(12, 15), faults=(cuts[0], f"power@{TURN}+11"))
    assert [d.code for d in more.findings] == ["bad-fault"]
    assert "+11: 10 steps of play are taken up there" in more.findings[0].message
    first = library.simulate_program(KEY, backlash=(12, 15), faults=cuts[:1], stop_at_power=True)
    for left, codes in ((10, []), (11, ["bad-fault"])):
        rest = library.simulate_program(KEY, resume=first.state, faults=[f"power@{TURN}+{left}"])
        assert [d.code for d in rest.findings] == codes


@pytest.mark.parametrize("made", [0, 1, 4999, 5000])
def test_the_commanded_place_of_a_straight_way_back_is_on_it(made):
    """With backlash = play the table is where the controller has it, on that way too."""
    fault = Fault(Trouble.BREAK, 40_000, cut_after=made)
    run = library.simulate_program(KEY, backlash=(12, 15), faults=[fault], stop_at_power=True)
    facts = run.summary
    assert facts["commanded_um"] == facts["final_um"]
    assert sum(map(abs, facts["commanded_um"])) == sum((35_650, 4_350)) - made


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_faults_happen_once_in_a_run_in_parts(seed):
    """Day after day with the same seed, from one power cut to the next: the run of one go."""
    whole = library.simulate_program(KEY, backlash=(12, 15), random=(6, seed))
    kinds, state, passed = [], None, []
    while True:
        day = library.simulate_program(
            KEY, backlash=(12, 15), random=(6, seed), resume=state, stop_at_power=True
        )
        assert day.ok
        kinds += [event.kind for event in day.record.events]
        passed += [d.values["passed"] for d in day.findings]
        if (state := day.state) is None:
            break
    assert kinds == [event.kind for event in whole.record.events]
    assert passed == sorted(passed)
    assert day.record.state == whole.record.state


def test_random_faults_need_a_step_that_is_cut():
    line = bytes.fromhex("41 00 10 00 00 00 00 00")  # a positioning move of 1 mm
    run = library.simulate_program(line, name="move.zd", backlash=(0, 0), random=(3, 0))
    assert [d.code for d in run.findings] == ["bad-fault"]
    assert "nothing of this program is cut" in run.findings[0].message


def test_a_shop_has_a_feed_and_a_scenario_wins(tmp_path):
    (tmp_path / "key.zd").write_bytes(Path(KEY).read_bytes())
    (tmp_path / "wedmcam.toml").write_text('feed = "1.2mm"\n')
    (tmp_path / "fast.toml").write_text("feed = 80\n")
    for more, rate in (
        ((), 20),
        (("--scenario", "fast.toml"), 80),
        (("--scenario", "fast.toml", "--feed", "2.4"), 40),
    ):
        facts = run("key.zd", "--backlash", "0,0", *more, cwd=tmp_path)[1]
        assert facts["time_s"] == pytest.approx(112_600 / rate)


def test_the_report_says_how_far_it_went_back_and_how_long():
    faults = ("short@500:60", "break@2000", "break@3000:1", "short@5000:160")
    line = [word for fault in faults for word in ("--fault", fault)]
    done = wedmcam("simulate", KEY, *PLAY, *line)
    told = done.stderr.decode()
    assert "60 um back the feed signal is there: cut on" in told
    assert "returned to the thread point, 2000 steps the shortest way: cut on" in told
    assert "returned to the thread point, 3000 steps along the path: cut on" in told
    assert "ALARM: still shorted 100 um back; the machine stops" in told
    facts = run(KEY, *PLAY, *line)[1]
    spent = facts["seconds"]
    back = 60 + 2000 + 3000 + 100
    assert back * 0.005 <= spent["back"] <= (back + 100) * 0.005
    assert sum(spent.values()) == pytest.approx(facts["time_s"])


def test_a_state_that_is_not_written_is_said(tmp_path):
    done = wedmcam("simulate", KEY, *PLAY, "--state", "a.state", cwd=tmp_path)
    assert "a.state was not written: the program is at its end" in done.stderr.decode()
    (tmp_path / "a.state").write_text("of yesterday")
    done = wedmcam("simulate", KEY, *PLAY, "--state", "a.state", cwd=tmp_path)
    assert "a.state is as it was, of another run" in done.stderr.decode()
    assert (tmp_path / "a.state").read_text() == "of yesterday"


def test_a_scenario_that_is_no_text_says_its_line():
    data = b"backlash = [1, 2]\n# \xff\n"
    found = library.simulate_program(KEY, scenario=("bad.toml", data)).findings[0]
    assert (found.code, str(found.span)) == ("bad-scenario", "bad.toml:2:3")


def test_a_way_back_from_a_state_may_end_in_an_alarm():
    short = Fault(Trouble.SHORT, 5000, length=160, cut_after=30)
    first = library.simulate_program(KEY, backlash=(12, 15), faults=[short], stop_at_power=True)
    assert first.record.state.stand.step == 4970
    rest = library.simulate_program(KEY, resume=first.state)
    assert [d.code for d in rest.findings] == ["alarm"]
    assert rest.record.state.stand.step == 4900
    assert "still there" in rest.findings[0].message
    assert library.simulate_program(KEY, resume=rest.state).record.final_um == (0, 0)


def test_after_an_alarm_the_operator_goes_on(tmp_path):
    line = (*PLAY, "--fault", "short@5000:101", "--state", "a.state")
    status, facts, told = run(KEY, *line, cwd=tmp_path)
    assert status == 1
    assert "stopped with an alarm at step 4900" in told
    status, facts, _ = run(KEY, "--resume", "a.state", cwd=tmp_path)
    assert (status, facts["ok"], facts["final_um"]) == (0, True, [0, 0])


SCENARIO = """
# A day at the machine.
backlash = [12, 15]
play = [12, 15]
approach = ["+", "-"]
feed = 50
return_ms = 4

[[feed_change]]
step = 1000
feed = 20.5

[[fault]]
kind = "short"
step = 2000
length = 70
power_after = 30

[[fault]]
kind = "break"
step = 30000
block = 2

[[fault]]
kind = "short"
step = 40000
length = 200
operator = "continue"

[random]
faults = 3
seed = 7
"""


def test_a_scenario_file(tmp_path):
    (tmp_path / "day.toml").write_text(SCENARIO)
    status, facts, told = run(KEY, "--scenario", "day.toml", cwd=tmp_path)
    assert status == 0, told
    kinds = [event["event"] for event in facts["events"]]
    assert kinds[:3] == ["short", "power-cut", "resume"]
    assert kinds.count("break") >= 1
    assert "clear-alarm" in kinds
    assert facts["approach"] == [1, -1]
    assert facts["final_um"] == [0, 0]
    # What is typed wins.
    facts = run(KEY, "--scenario", "day.toml", "--backlash", "9,9", cwd=tmp_path)[1]
    assert facts["backlash_um"] == [9, 9]
    assert (
        run(KEY, "--scenario", "day.toml", cwd=tmp_path)[1]
        == run(KEY, "--scenario", "day.toml", cwd=tmp_path)[1]
    )


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("backlash = [1", 1, "not TOML"),
        ("\nbacklsh = [1, 2]", 2, "no entry is called backlsh"),
        ("backlash = [1.5, 2]", 1, "takes two whole numbers"),
        ("[[fault]]\nkind = 'short'\nstep = 5", 1, "a short circuit has a length"),
        ("[[fault]]\nkind = 'short'\nlength = 5", 1, "step missing"),
        ("[[fault]]\nkind = 'power'\nstep = 1\n[[fault]]\nkind = 'powr'\nstep = 1", 5, "takes"),
        ("[[fault]]\nkind = 'break'\nstep = 5\npulses = 3", 4, "means nothing"),
        ("[fault]\nkind = 'break'\nstep = 5", 1, "is written as [[fault]]"),
        ("fault = 3", 1, "is written as [[fault]]"),
        ("[[fault]]\nkind = 'short'\nstep = 5000000\nlength = 9", 3, "makes 112600 steps"),
        ("[random]\nfaults = 3", 1, "seed missing"),
        ("feed = true", 1, "takes steps a second"),
    ],
)
def test_a_wrong_scenario_says_its_line(text, line, said):
    scenario = ("bad.toml", text.encode())
    run = library.simulate_program(KEY, backlash=(12, 15), scenario=scenario)
    assert run.status == 1
    assert f"bad.toml:{line}:" in str(run.findings[0].span)
    assert said in run.findings[0].message


@settings(max_examples=200)
@given(st.data())
def test_a_damaged_scenario_is_a_finding_or_another_scenario(data):
    text = SCENARIO
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text) - 1))
        new = data.draw(st.sampled_from(["", "\x00", '"', "[", "=", "9" * 30, "\n", "é"]))
        text = text[:at] + new + text[at + data.draw(st.integers(0, 3)) :]
    conditions, findings = read_scenario(text, "a.toml")
    assert (conditions is None) == bool(findings)
    for d in findings:
        assert d.code == "bad-scenario"
        assert d.span is not None
        assert d.message


@functools.cache
def saved():
    """Return the file of a state."""
    run = library.simulate_program(KEY, backlash=(12, 15), faults=["power@777"], stop_at_power=True)
    return run.state


def test_a_state_with_a_byte_that_is_no_character_is_damaged():
    state, findings = read_state(saved().replace(b'"zd065"', b'"zd0\x805"'), "a.state")
    assert state is None
    assert re.search("the state is damaged|cannot be", findings[0].message)


@settings(max_examples=150)
@given(st.data())
def test_a_damaged_state_is_a_finding_with_its_place(data):
    program, *_ = library.read_program(KEY)
    good = library.simulate_program(
        KEY, backlash=(12, 15), faults=["power@777"], stop_at_power=True
    ).state
    damaged = bytearray(good)
    at = data.draw(st.integers(0, len(good) - 1))
    kind = data.draw(st.sampled_from(["change", "cut", "take", "add"]))
    if kind == "change":
        damaged[at] ^= data.draw(st.integers(1, 255))
    elif kind == "cut":
        del damaged[at:]
    elif kind == "take":
        del damaged[at]
    else:
        damaged[at:at] = data.draw(st.binary(min_size=1, max_size=3))
    state, findings = read_state(bytes(damaged), "a.state")
    if state is None:
        assert [d.code for d in findings] == ["bad-state"]
        assert findings[0].span is not None
    else:  # white space between fields, say
        assert state == read_state(good, "a.state")[0]
        text, program = damaged.decode(), library.read_program(KEY)[0]
        assert not check_state(state, "zd065", lay(program, MIRROR), text, "a.state")


def test_pulses_are_the_motors_and_take_ups_come_before_reversals(tmp_path):
    faults = ("--fault", "short@3000:50", "--fault", "power@6500", "--fault", "break@9000")
    done = wedmcam("simulate", KEY, *PLAY, *faults, "--pulses", "-", "-q")
    rows = list(csv.DictReader(io.StringIO(done.stdout.decode())))
    facts = run(KEY, *PLAY, *faults)[1]
    assert len(rows) == facts["pulses"]
    assert [int(row["pulse"]) for row in rows[:3]] == [1, 2, 3]
    motors, last, ups = {"x": 0, "y": 0}, {"x": "+", "y": "+"}, 0
    before = 0
    for row in rows:
        axis, sign = row["axis"], row["direction"]
        motors[axis] += 1 if sign == "+" else -1
        assert row["x"] == PATTERNS[motors["x"] % 6]
        assert row["y"] == PATTERNS[motors["y"] % 6]
        assert int(row["time_us"]) >= before
        before = int(row["time_us"])
        if row["kind"] == "take-up":
            ups += 1
        else:
            assert ups == ({"x": 12, "y": 15}[axis] if sign != last[axis] else 0)
            last[axis], ups = sign, 0
    assert [motors["x"], motors["y"]] == facts["motor_um"]
    assert before == round(facts["time_s"] * 1e6)


def test_a_power_cut_within_a_take_up_keeps_its_pulses(tmp_path):
    """Block 2 turns y back first at step 6811 of the key: some of its 15 steps are made."""
    program, machine, _ = library.read_program(KEY)
    route = lay(program, machine.stepping)
    down = next(k for k in range(route.steps) if route.axis[k] == 1 and route.sign[k] < 0)
    cut = ("--fault", f"power@{down}+6", "--state", "a.state", "--pulses", "a.csv")
    status, first, told = run(KEY, *PLAY, *cut, cwd=tmp_path)
    assert status == 0, told
    rest = run(KEY, "--resume", "a.state", "--pulses", "b.csv", cwd=tmp_path)[1]
    whole = run(KEY, *PLAY, "--pulses", "c.csv", cwd=tmp_path)[1]
    assert first["pulses"] + rest["pulses"] == whole["pulses"]
    a, b, c = ((tmp_path / f"{n}.csv").read_text().splitlines()[1:] for n in "abc")
    phases = [line.split(",")[2:] for line in (*a, *b)]
    assert phases == [line.split(",")[2:] for line in c]


@pytest.mark.parametrize("suffix", ["svg", "png", "html"])
def test_pictures(tmp_path, suffix):
    faults = ("--fault", "short@3000:50", "--fault", "break@9000")
    done = wedmcam("simulate", KEY, *PLAY, *faults, "--plot", f"a.{suffix}", "-q", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    data = (tmp_path / f"a.{suffix}").read_bytes()
    assert 5_000 < len(data) < 600_000
    if suffix == "svg":
        text = data.decode()
        assert text.count("<circle") == 3  # two marks and the one of the legend
        assert "back from a short circuit" in text
        assert "the shortest way back" in text


def test_other_formats_say_how_to_convert_them(tmp_path):
    status, _, told = run(str(GOLDEN / "plate.3b"), *PLAY)
    assert status == 1
    assert "error[other-format]" in told
    assert "wedmcam convert" in told


def test_the_report_for_people():
    done = wedmcam("simulate", KEY, *PLAY, "--random", "40", "--seed", "1")
    told = done.stderr.decode()
    assert done.returncode == 0
    assert "enter      backlash X 12 Y 15 um" in told
    assert "more; -v lists all" in told
    assert "exact at every step" in told
    every = wedmcam("simulate", KEY, *PLAY, "--random", "40", "--seed", "1", "-v").stderr.decode()
    assert len(every.splitlines()) > len(told.splitlines()) + 10
    assert wedmcam("simulate", KEY, *PLAY, "-q").stderr == b""


def test_the_library_simulates():
    result = library.simulate_program(KEY, backlash=(12, 15), faults=["break@5000"])
    assert result.ok
    assert result.record.final_um == (0, 0)
    with pytest.raises(library.WrongUse, match="no controller"):
        library.simulate_program(KEY, controller="agie", backlash=(0, 0))


@pytest.mark.parametrize("servo", ["patent", "eindhoven", "feed"])
def test_a_servo_feeds_the_wire(servo, tmp_path):
    state = tmp_path / "a.state"
    line = (KEY, *PLAY, "--servo", servo, "--fault", "power@1000", "--state", str(state))
    status, facts, told = run(*line)
    assert (status, told) == (0, "")
    assert facts["servo"]["servo"] == servo
    assert facts["servo"]["pulses"] > 1_000_000
    assert facts["servo"]["alarms"] == 0
    assert facts["off_um"] == [0, 0]
    assert facts["stopped_at"] == 1000
    assert facts["time_s"] > facts["servo"]["seconds"]
    again = run(*line)[1]
    assert again == facts
    assert run(*line, "--seed", "5")[1]["servo"] != facts["servo"]


@pytest.mark.parametrize("more", [("--feed", "2"), ("--dry-run", "5")])
def test_a_servo_needs_a_gap_and_no_other_feed(more):
    done = wedmcam("simulate", KEY, *PLAY, "--servo", "feed", *more)
    assert done.returncode == 2
    assert b"--servo" in done.stderr

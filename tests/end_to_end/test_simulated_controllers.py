"""wedmcam simulate on all controllers: scenario files, days, and files that are damaged."""

import functools
import json
import re
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_cli import wedmcam

import wedmcam as library
from fault_runs import PART, route_of
from wedmcam.diag import has_errors
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.read import read_scenario
from wedmcam.simulate.ring import pattern
from wedmcam.simulate.scenario import Fault, Trouble
from wedmcam.simulate.state import read_state

PLAY = {"zd065": {"backlash": (12, 15)}, "nby15": {}, "eindhoven": {}}


@functools.cache
def program_of(name):
    """Return the bytes of a small program of a controller."""
    return library.compile(PART.encode(), name="a.wed", to=CONTROLLERS[name].format).data


def simulate(name, **how):
    stated = {} if how.get("resume") is not None else PLAY[name]
    return library.simulate_program(
        program_of(name), controller=name, name=f"a{CONTROLLERS[name].suffix}", **stated, **how
    )


#: What stands in a scenario by mistake.
LINES = """
step = 0|step = 999999|length = 1|kind = 'tape'|block = 1|pulses = 3|power_after = 0|[[fault]]|
[random]|feed = 9|é = 1|operator = 'stop'|kind = 'limit'|dry_ms = 3|play = [3, 2]|
""".replace("\n", "").split("|")
#: A day with a fault of each kind.
DAY = """
[[fault]]
kind = "short"
step = 300
length = 50
power_after = 9

[[fault]]
kind = "short"
step = 320
length = 900
operator = "continue"

[[fault]]
kind = "break"
step = 330

[[fault]]
kind = "power"
step = 340

[random]
faults = 5
seed = 3
"""
STOP = """
[[fault]]
kind = "stop"
step = 350

[[fault]]
kind = "limit"
step = 360
operator = "continue"
"""
TAPE = """
[[fault]]
kind = "tape"
step = 20
"""
DAYS = {"zd065": DAY, "nby15": DAY + STOP + TAPE, "eindhoven": DAY + STOP}
KINDS = {
    "zd065": ["short", "power-cut", "resume", "clear", "alarm", "clear-alarm", "break", "back"],
    "nby15": ["tape", "no-tape", "front", "start", "stop", "limit", "clear-alarm", "alarm"],
    "eindhoven": ["short", "start", "stop", "limit", "clear-alarm", "alarm", "power-cut"],
}


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_scenario_file_with_every_kind_of_fault(name, tmp_path):
    suffix = CONTROLLERS[name].suffix
    (tmp_path / f"a{suffix}").write_bytes(program_of(name))
    (tmp_path / "day.toml").write_text(DAYS[name])
    line = ["simulate", f"a{suffix}", "--controller", name, "--scenario", "day.toml", "--json"]
    line += ["--backlash", "12,15"] if name == "zd065" else []
    done = wedmcam(*line, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert (facts["ok"], facts["controller"], facts["off_um"]) == (True, name, [0, 0])
    assert facts["final_um"] == simulate(name).summary["final_um"]
    assert set(KINDS[name]) <= {event["event"] for event in facts["events"]}
    assert json.loads(wedmcam(*line, cwd=tmp_path).stdout) == facts


@pytest.mark.parametrize("kind", ["stop", "limit", "tape"])
@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_fault_that_a_controller_does_not_know_is_an_error_at_its_line(name, kind):
    text = f"\n[[fault]]\nkind = '{kind}'\nstep = 30\n"
    run = simulate(name, scenario=("a.toml", text.encode()))
    if kind in CONTROLLERS[name].answers.troubles:
        # A limit switch stops the machine for good, where no operator goes on.
        assert (run.status, run.record.finished) == ((1, False) if kind == "limit" else (0, True))
        return
    assert [d.code for d in run.findings] == ["bad-fault"]
    assert str(run.findings[0].span) == "a.toml:4:1"
    assert "knows no such fault" in run.findings[0].message


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("[[fault]]\nkind = 'stop'\nstep = 5\noperator = 'continue'", 4, "means nothing"),
        ("[[fault]]\nkind = 'tape'\nstep = 5\nlength = 5", 4, "means nothing"),
        ("[[fault]]\nkind = 'limit'\nstep = 5\npower_after = 5", 4, "means nothing"),
        ("[[fault]]\nkind = 'limit'\nstep = 5\noperator = 'go'", 4, 'takes "stop" or "continue"'),
        ("[[fault]]\nkind = 'lamp'\nstep = 5", 2, 'or "limit" or "tape"'),
    ],
)
def test_a_wrong_scenario_says_its_line(text, line, said):
    run = simulate("nby15", scenario=("bad.toml", text.encode()))
    assert run.status == 1
    assert f"bad.toml:{line}:" in str(run.findings[0].span)
    assert said in run.findings[0].message


@pytest.mark.parametrize("name", CONTROLLERS)
def test_random_faults_happen_once_in_a_run_in_parts(name):
    """Day after day with the same seed, also where the power fails on a way back."""
    how = {"random": (8, 5), "scenario": ("day.toml", DAYS[name].split("[random]")[0].encode())}
    whole = simulate(name, **how)
    assert whole.record.finished
    kinds, state, text = [], None, how["scenario"][1].decode()
    for _ in range(40):
        how["scenario"] = ("day.toml", text.encode())
        day = simulate(name, **how, resume=state, stop_at_power=True)
        kinds += [event.kind for event in day.record.events]
        state = day.state
        if state is None:
            break
        front = read_state(state, "a")[0].stand.front
        text = "".join(
            f"[[fault]]{one}"
            for one in text.split("[[fault]]")[1:]
            if int(re.search(r"step = (\d+)", one)[1]) > front
        )
    assert kinds == [event.kind for event in whole.record.events]
    assert day.record.state.axes == whole.record.state.axes


@pytest.mark.parametrize("name", CONTROLLERS)
@settings(max_examples=120, deadline=None)
@given(st.data())
def test_a_damaged_scenario_never_raises(name, data):
    text = DAYS[name]
    for _ in range(data.draw(st.integers(1, 5))):
        lines = text.splitlines()
        at = data.draw(st.integers(0, len(lines) - 1))
        new = data.draw(st.sampled_from(LINES))
        text = "\n".join([*lines[:at], new, *lines[at + data.draw(st.integers(0, 1)) :]])
    conditions, findings = read_scenario(text, "a.toml")
    assert (conditions is None) == bool(findings)
    try:
        run = simulate(name, scenario=("a.toml", text.encode()))
    except library.WrongUse:
        return
    assert run.status == 0 or has_errors(run.findings)
    assert run.summary


def with_its_sum(fields):
    """Return a state of any fields whose sum is right, and whose phases are those of its motors."""
    if isinstance(fields.get("motor"), list):
        fields["phase"] = [pattern(v) if type(v) is int else "A" for v in fields["motor"]]
    lines = [f'"{name}": {json.dumps(v)}' for name, v in fields.items() if name != "sum"]
    lines.append(f'"sum": "{zlib.crc32(chr(10).join(lines).encode()):08x}"')
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


@functools.cache
def states_of(name):
    """Return fields of states: going forward, going back, with an alarm, at the start."""
    back = Fault(Trouble.SHORT, 300, length=60, cut_after=20)
    return [
        json.loads(simulate(name, faults=[fault], stop_at_power=True).state)
        for fault in ("power@300", back, "short@400:990", "power@0")
    ]


NUMBERS = [0, 1, -1, 299, 300, 301, 400, 10**6, 10**12, 10**30, 0.5, 1e300]
PAIRS = [[0, 0], [1, -1], [12, 15], [0, 9999], [1], [None, 1], [1.0, 1]]
WORDS = [None, True, "x", "", "é", "forward", "end", "retreat", "return", "shortest", "alarm"]
VALUES = st.sampled_from([*NUMBERS, *PAIRS, *WORDS])


@pytest.mark.parametrize("name", CONTROLLERS)
@settings(max_examples=250, deadline=None)
@given(st.data())
def test_a_state_that_somebody_changed_never_raises(name, data):
    """Fields of other values under a right sum: refused with a place, or a machine that goes on."""
    fields = dict(data.draw(st.sampled_from(states_of(name))))
    for _ in range(data.draw(st.integers(0, 3))):
        field = data.draw(st.sampled_from(sorted(fields)))
        if data.draw(st.booleans()):
            fields[field] = data.draw(VALUES)
        elif data.draw(st.booleans()):
            fields.pop(field)
        elif type(fields[field]) is int:
            fields[field] += data.draw(st.integers(-200, 200))
    written = with_its_sum(fields)
    try:
        run = simulate(name, resume=("a.state", written))
    except library.WrongUse:
        return
    assert run.status == 0 or run.findings
    if run.record is None:
        assert run.findings[0].code in ("bad-state", "other-program")
        assert run.findings[0].span is not None
    else:
        assert run.record.finished or run.status == 1
        assert run.record.commanded_um == tuple(
            (route_of(name).place[-1] * route_of(name).step_um).tolist()
        )


@pytest.mark.parametrize("name", CONTROLLERS)
def test_bytes_that_are_no_state_never_raise(name):
    rng = np.random.default_rng(2)
    good = simulate(name, faults=["power@300"], stop_at_power=True).state
    for _ in range(300):
        bad = bytearray(good)
        for at in rng.integers(0, len(bad), int(rng.integers(1, 4))):
            bad[at] = int(rng.integers(0, 256))
        run = simulate(name, resume=("a.state", bytes(bad)))
        assert run.status in (0, 1)
        assert run.status == 0 or run.findings[0].code in ("bad-state", "other-program")

"""``simulate --controller nby15``: what the panel shows, switches, limits, a torn tape."""

from dataclasses import replace

import pytest

from wedmcam.api import simulate_program
from wedmcam.controllers.nby15.data import Switches
from wedmcam.formats.tape import punched
from wedmcam.simulate.nby15 import GOES, STANDS, Lamp
from wedmcam.simulate.scenario import Fault, Trouble
from wedmcam.simulate.state import read_state, state_bytes

START, STOP = "PROGRAMME START", "PROGRAMME STOP"
#: Two paths, the second one behind a thread point; 3 pauses the first one.
TAPE = punched(
    "N1G01X+1000Y+0\nN2G03A270B90R500\nN3M00\nN4G01X+0Y+400\nN5G00X+300Y+100\nN6M00\n"
    "N7G01X+800Y+0\nN8G02A90B90R400\nN9G01X-5Y-60\nN10M02\n"
)


def ran(data=TAPE, **more):
    return simulate_program(data, controller="nby15", name="a.n15", **more)


def events(result):
    return [(event["event"], event["step"]) for event in result.summary["events"]]


def codes(result):
    return [f"{d.severity}[{d.code}]" for d in result.findings]


def entered(correct=0, scale=1, run_off=False, mirror=""):
    switches = Switches(correct, scale, "x" in mirror, "y" in mirror)
    return {"switches": switches, "run_off": run_off}


# --- what people see ----------------------------------------------------------------------------


def test_blocks_are_those_of_the_tape_and_j_the_steps_of_the_line_in_work():
    result = ran(faults=["stop@500", "stop@1100", "stop@3000"])
    facts = result.summary
    assert facts["blocks"] == 9
    seen = [(e["event"], e["block"], e.get("halt_block")) for e in facts["events"]]
    assert seen[0] == ("stop", 1, None)
    assert seen[2] == ("stop", 2, None)
    assert ("pause", 2, 3) in seen
    assert ("thread-point", 5, 6) in seen
    assert seen[-1] == ("end", 9, None)
    j = [e["j"] for e in facts["events"] if e["event"] == "stop"]
    assert j[0] == 500
    assert j[1] < 10  # a degree of R 0.5 mm is 9 um
    damaged = ran(faults=["short@1100:300"])
    assert "block 1: the short circuit is still there" in damaged.findings[0].message


WALK = [
    Fault(Trouble.SHORT, 300, length=60),
    Fault(Trouble.BREAK, 400),
    Fault(Trouble.STOP, 500),
    Fault(Trouble.SHORT, 600, length=300, goes_on=True),
    Fault(Trouble.POWER, 700),
    Fault(Trouble.TAPE, 800),
    Fault(Trouble.POWER, 900),
    Fault(Trouble.LIMIT, 1300, goes_on=True),
]
#: What is lit behind each event of that run: typed here, from the text.
LIT = [
    ("short", [START, "RETURN"]),
    ("clear", [START, "SERVO-FEED"]),
    ("front", [START, "FORWARD"]),
    ("break", [STOP]),
    ("start", [START, "FORWARD"]),
    ("stop", ["OFF"]),
    ("start", [START, "FORWARD"]),
    ("short", [START, "RETURN"]),
    ("alarm", [STOP, "MEMORY BLACKOUT"]),
    ("clear-alarm", [START, "SERVO-FEED"]),
    ("front", [START, "FORWARD"]),
    ("power-cut", []),
    ("resume", [START, "FORWARD"]),
    ("tape", [START, "FORWARD", "TAPE"]),
    ("power-cut", []),
    ("resume", [START, "FORWARD", "TAPE"]),
    ("limit", ["OFF", "TAPE"]),
    ("clear-alarm", [START, "FORWARD", "TAPE"]),
    ("pause", ["READY", STOP, "TAPE"]),
    ("no-tape", [STOP, "TAPE"]),
    ("start", [START, "FORWARD"]),
    ("thread-point", ["READY", STOP]),
    ("end", ["OFF"]),
]


def test_the_lamps_of_a_run_through_all_that_can_happen():
    result = ran(faults=WALK)
    seen = [(event["event"], event["lamps"]) for event in result.summary["events"]]
    assert seen == LIT
    lit = {lamp for _, lamps in seen for lamp in lamps}
    assert lit == {str(lamp) for lamp in Lamp}
    assert set(STANDS) <= {kind for kind, _ in seen}
    assert set(GOES.values()) <= {tuple(lamps[:2]) for _, lamps in seen}


def test_who_goes_on_from_an_alarm_sees_what_was_lit():
    alarm = ran(faults=["short@600:300"])
    again = ran(resume=("a.state", alarm.state)).summary["events"]
    assert [event["lamps"] for event in again[:3]] == [
        [STOP, "MEMORY BLACKOUT"],
        [START, "SERVO-FEED"],
        [START, "FORWARD"],
    ]
    limit = ran(faults=["limit@600"])
    assert limit.status == 1
    assert "step 600, block 1, at (0.600, 0.000) mm from the start" in limit.findings[0].message
    again = ran(resume=("a.state", limit.state)).summary["events"]
    assert [event["lamps"] for event in again[:2]] == [["OFF"], [START, "FORWARD"]]


@pytest.mark.parametrize("servo", ["patent", "eindhoven", "feed"])
def test_with_a_servo_it_feeds_over_what_is_cut(servo):
    facts = ran(servo=(servo, 4)).summary
    assert facts["ok"]
    assert facts["final_um"] == ran().summary["final_um"]
    shown = {(event["event"], *event["lamps"]) for event in facts["events"]}
    assert {
        ("short", START, "RETURN"),
        ("clear", START, "SERVO-FEED"),
        ("front", START, "FORWARD"),
    } <= shown
    assert facts["seconds"]["servo-feed"] > 0


# --- a torn tape --------------------------------------------------------------------------------


def test_what_is_not_read_is_saved_with_the_state():
    torn = ran(faults=["tape@300", "power@400"], stop_at_power=True)
    state, _ = read_state(torn.state, "a.state")
    assert state.stand.unread == 5
    rest = ran(resume=("a.state", torn.state))
    until = rest.record.route.start_of(5)
    assert events(rest)[:4] == [
        ("resume", 400),
        ("pause", 1000 + 1000),
        ("no-tape", until),
        ("start", until),
    ]


@pytest.mark.parametrize(
    ("unread", "good"),
    [(0, True), (2, True), (5, True), (10, True), (1, False), (11, False)],
)
def test_a_state_whose_tape_ends_where_no_block_begins_is_refused(unread, good):
    torn = ran(faults=["power@400"], stop_at_power=True)
    state, _ = read_state(torn.state, "a.state")
    changed = replace(state, stand=replace(state.stand, unread=unread))
    result = ran(resume=("a.state", state_bytes(changed)))
    assert result.ok is good
    if not good:
        assert codes(result) == ["error[bad-state]"]
        assert f"unread is {unread}" in result.findings[0].message


def test_a_tape_with_a_bad_row_says_how_far_the_machine_would_come():
    for row in range(100, len(TAPE)):
        damaged = bytearray(TAPE)
        damaged[row] ^= 1
        result = ran(bytes(damaged))
        assert result.record is None
        assert "error[tape-parity]" in codes(result)
        said = [d for d in result.findings if str(d.severity) == "note"]
        if b"\n" not in TAPE[:row]:  # the one behind the %
            assert not said
            continue
        # The blocks in front of the row, as they run alone.
        whole = TAPE[:row].count(b"\n") - 1
        assert said[-1].values["blocks"] == min(whole, 9), row
        steps = ran().record.route.start_of(min(whole, 9) + 1)
        assert said[-1].values["step"] == steps, row


# --- switches and limits ------------------------------------------------------------------------


def test_beyond_what_is_safe_nothing_runs_unless_it_shall_run_off():
    circle = punched("N1G03A0B360R400\nN2M02\n")
    assert codes(ran(circle, **entered(-401))) == ["error[radius-corrector]"]
    assert ran(circle, **entered(-401)).record is None
    result = ran(circle, **entered(-401, run_off=True))
    assert codes(result) == [
        "warning[radius-corrector]",
        "error[limit-switch]",
        "error[alarm]",
    ]
    assert result.status == 1
    event = result.summary["events"][0]
    assert event["event"] == "limit"
    assert event["switch"] in ("+Y", "-X")
    assert max(abs(um) for um in event["table_um"]) in (150_000, 200_000)
    opens = result.findings[1]
    assert opens.values["steps"] == event["step"] == result.record.walked
    assert str(opens.values["place"]) in result.findings[2].message
    # The same switch as that of verify, which steps nothing.
    assert opens.message.startswith("block 1, turned about R 999.999 mm, runs off")
    # What lies behind is never run.
    assert result.summary["steps"] - event["step"] < 20_000
    again = ran(circle, **entered(-401, run_off=True), resume=("a.state", result.state))
    assert events(again) == [(kind, event["step"]) for kind in ("resume", "clear-alarm", "limit")]


def test_an_alarm_before_the_limit_switch_is_what_is_said():
    circle = punched("N1G03A0B360R400\nN2M02\n")
    result = ran(circle, **entered(-401, run_off=True), faults=["short@500:300"])
    assert codes(result) == ["warning[radius-corrector]", "error[alarm]"]
    assert "short circuit is still there" in result.findings[1].message


@pytest.mark.parametrize(
    ("text", "scale", "code", "said"),
    [
        ("N1G01X+150000\nN2G01X-50000\nN3G01X+250000\n", 1, None, ""),
        ("N1G01X+150000\nN2G01X-50000\nN3G01X+350000\n", 1, "over-travel", "block 3: the program"),
        ("N1G01X+30000\nN2G01Y-31000\nN3G01X+5000\n", 10, "over-travel", "310.000 mm along Y"),
        ("N1G03A0B1R31000\n", 10, "over-limit", "310.000 mm at scale 10"),
        ("N1G03A0B1R31000\n", 5, None, ""),
    ],
)
def test_what_leads_out_of_the_machine(text, scale, code, said):
    data = punched(f"{text}M02\n")
    result = ran(data, **entered(scale=scale))
    assert codes(result) == ([f"error[{code}]"] if code else [])
    assert result.ok is (code is None)
    if code:
        assert said in result.findings[0].message
        assert result.findings[0].hint == "--run-off shows what the machine does then"
        assert result.findings[0].span is not None
    off = ran(data, **entered(scale=scale, run_off=True))
    if code == "over-travel":  # from the middle of the travel
        assert codes(off) == ["error[limit-switch]", "error[alarm]"]
        assert max(abs(um) for um in off.summary["events"][0]["table_um"]) in (150_000, 200_000)
        assert off.findings[0].message.startswith("block ")
        assert "turned about" not in off.findings[0].message
    else:
        assert off.ok
        assert codes(off) == (["warning[over-limit]"] if code else [])


def test_scale_and_directions():
    plain = ran().summary
    turned = ran(**entered(scale=2, mirror="y")).summary
    x, y = plain["final_um"]
    assert turned["final_um"] == pytest.approx([2 * x, -2 * y], abs=2)
    assert turned["steps"] == pytest.approx(2 * plain["steps"], abs=10)


def test_speeds_are_potentiometers_and_the_dry_run_has_one_of_its_own():
    fault = ["short@600:100"]
    seconds = ran(faults=fault, feed=50.0, return_ms=10).summary["seconds"]
    assert seconds["back"] == pytest.approx(1.0)
    assert seconds["servo-feed"] == pytest.approx(2.0)  # forward, as fast as it cuts
    dry = ran(dry_ms=2)
    assert dry.summary["time_s"] == pytest.approx(0.002 * dry.summary["steps"])
    assert codes(ran(dry_ms=2, faults=fault)) == ["error[bad-fault]"]
    stopped = ran(dry_ms=2, faults=["stop@600", "tape@700"])
    assert [e["event"] for e in stopped.summary["events"]][:3] == ["stop", "start", "tape"]

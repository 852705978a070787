"""``wedmcam simulate --controller nby15``: what a user types, and what comes of it."""

import csv
import io
import json
from pathlib import Path

import pytest
from test_cli import wedmcam

SAMPLES = Path(__file__).parents[2] / "samples"
NBY = ("--controller", "nby15")


@pytest.fixture(scope="module")
def key(tmp_path_factory):
    name = str(tmp_path_factory.mktemp("nby15") / "key.n15")
    sample = str(SAMPLES / "key-punch.dxf")
    assert wedmcam("compile", sample, "-o", name, "--offset", "0.1").returncode == 0
    return name


def told(*line, status=0):
    done = wedmcam("simulate", *line, *NBY)
    assert done.returncode == status, done.stderr
    return done.stderr.decode()


def test_the_report_for_people(key):
    faults = ("short@500:60", "tape@6000", "power@7000", "stop@9000", "break@20000")
    text = told(key, *(f"--fault={fault}" for fault in faults))
    for line in (
        "runs       62 blocks, 112604 steps on the NBY-15: cut",
        "short circuit: RETURN along the memory; 60 um back it is free [PROGRAMME START + RETURN]",
        "60 um back the short circuit is gone: SERVO-FEED [PROGRAMME START + SERVO-FEED]",
        "where the short circuit was: FORWARD [PROGRAMME START + FORWARD]",
        "no more of the tape is read; what is read ahead goes on to step 49026 "
        "[PROGRAMME START + FORWARD + TAPE]",
        "resume from the saved state [PROGRAMME START + FORWARD + TAPE]",
        "emergency stop [OFF + TAPE]",
        "the wire is broken: the machine stands, and it is threaded there [PROGRAMME STOP + TAPE]",
        "nothing is left of what was read ahead: it stops, and the tape is put in "
        "[PROGRAMME STOP + TAPE]",
        "the operator has seen to it, and starts the machine [PROGRAMME START + FORWARD]",
        "end of the program [OFF]",
        "servo-feed 0:00:02",
    ):
        assert line in text
    assert "all of it was read [PROGRAMME START + FORWARD]" in told(key, "--fault=tape@112500")


def test_at_the_end_of_the_memory_it_stops(key):
    text = told(key, "--fault", "short@5000:257", status=1)
    assert (
        "MEMORY BLACKOUT: still shorted 256 um back, nothing is left of the memory; it stops "
        "[PROGRAMME STOP + MEMORY BLACKOUT]"
    ) in text
    assert "ALARM" not in text


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (("--fault", "break@500:2"), "the NBY-15 returns to no block"),
        (("--fault", "power@500+3"), "0 steps of play"),
        (("--backlash", "10,10"), "takes up no play"),
        (("--correct", "1000"), "three digits"),
        (("--fault", "short@500:30", "--dry-run", "1"), "in a dry run the generator is off"),
    ],
)
def test_what_it_does_not_take(key, line, said):
    done = wedmcam("simulate", key, *NBY, *line)
    assert done.returncode in (1, 2)
    assert said in done.stderr.decode()


def test_the_stream_and_the_pictures(key, tmp_path):
    line = (key, *NBY, "--fault", "short@4000:200", "--fault", "tape@6000")
    pulses = tmp_path / "a.csv"
    done = wedmcam("simulate", *line, "--pulses", str(pulses), "--json")
    facts = json.loads(done.stdout)
    rows = list(csv.DictReader(io.StringIO(pulses.read_text())))
    assert len(rows) == facts["pulses"] == 112_604 + 400
    for axis in "xy":
        assert sum(1 if r["direction"] == "+" else -1 for r in rows if r["axis"] == axis) == 0
    # What the motors make back they make forward again, the last step first.
    back, again = rows[4000:4200], rows[4200:4400]
    assert [(r["axis"], r["direction"]) for r in reversed(back)] == [
        (r["axis"], "-" if r["direction"] == "+" else "+") for r in again
    ]
    for suffix in ("svg", "png", "html"):
        picture = tmp_path / f"a.{suffix}"
        assert wedmcam("simulate", *line, "-q", "--plot", str(picture)).returncode == 0
        assert picture.stat().st_size > 10_000
    svg = (tmp_path / "a.svg").read_text()
    assert "forward with a reference current" in svg
    assert "SERVO-FEED" in (tmp_path / "a.html").read_text()


def test_it_runs_off_and_the_picture_shows_how_far(key, tmp_path):
    picture = tmp_path / "off.svg"
    text = told(key, "--correct", "-300", "--run-off", "--plot", str(picture), status=1)
    assert "key.n15:14:1: error[limit-switch]: block 13" in text
    assert "error[alarm]: a limit switch stopped the machine at step 324414, block 13" in text
    assert "a limit switch opens: -X [OFF]" in text
    assert "stopped at step 324414" in picture.read_text()

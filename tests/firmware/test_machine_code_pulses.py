"""The simulated controller and the machine code make the same pulses, play and all."""

import csv
from pathlib import Path

import numpy as np
from machine import Machine

from wedmcam import simulate_program
from wedmcam.reports.pulses import pulse_lines

GOLDEN = Path(__file__).parents[1] / "golden"
SIGNS = {"+": 1, "-": -1}
FIRST = 40_000


def test_a_program_with_play_pulse_by_pulse(image):
    """Of the key the first 40,000 pulses, with play: two programs of the same paper."""
    name = GOLDEN / "key-punch.zd"
    run = simulate_program(name, backlash=(12, 15))
    text = "".join(pulse_lines(run.record)).split("\n", FIRST + 1)
    rows = list(csv.DictReader(text[: FIRST + 1]))
    dx = [SIGNS[row["direction"]] if row["axis"] == "x" else 0 for row in rows]
    dy = [SIGNS[row["direction"]] if row["axis"] == "y" else 0 for row in rows]
    machine = Machine(image)
    machine.load(name.read_bytes(), (12, 15))
    machine["pace"] = 0
    machine.run(FIRST)
    record = machine.record()
    assert len(record.dx) >= FIRST
    assert np.array_equal(record.dx[:FIRST], dx)
    assert np.array_equal(record.dy[:FIRST], dy)
    assert len({row["kind"] for row in rows}) == 2

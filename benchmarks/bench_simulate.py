"""How fast the simulated ZD-065 runs, with and without faults, beside the plain path.

Run: python benchmarks/bench_simulate.py. One core, processor time, the best of three rounds. A
round of square and round holes of a million steps; `trace` is its path alone, `run` the motors with
play, the state machine and the events.
"""

import time

import numpy as np

from wedmcam.controllers.pointwise import MIRROR, trace
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.route import lay
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of
from wedmcam.simulate.zd065 import ZD065

STEPS = 1_000_000
SETUP = Setup(backlash=(12, 15), play=(12, 15))


def blocks():
    """Return full circles of R 5 mm and lines between them, of about a million steps."""
    out = np.zeros(48, BLOCK)
    circle = int(MIRROR.arc_end(5000, 0, 1, 5000, 0).count_square)
    for k, block in enumerate(out):
        if k % 2:
            block["kind"], block["turn"], block["axis"] = Kind.ARC, 1, Axis.SQUARE
            block["x"], block["count"] = 5000, circle
        else:
            block["x"], block["axis"], block["count"] = 1700, Axis.X, 1700
    return out


def seconds(work):
    """Return the least processor time of three rounds."""
    times = []
    for _ in range(3):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def measure():
    """Yield what was run, its steps, and seconds."""
    program = Program(blocks())
    route = lay(program, MIRROR)
    rng = np.random.default_rng(1)
    places = np.sort(rng.choice(np.arange(200, route.steps), 1000, replace=False)).tolist()
    shorts = scenario_of(Fault(Trouble.SHORT, k, length=60) for k in places)
    power = scenario_of(Fault(Trouble.POWER, k) for k in places)
    yield "trace", route.steps, seconds(lambda: trace(program.blocks))
    for name, scenario in (
        ("run, no fault", scenario_of([])),
        ("run, 1,000 short circuits", shorts),
        ("run, 1,000 power cuts", power),
    ):
        record, _ = run(ZD065, lay(program, MIRROR), scenario, SETUP)
        work = lambda s=scenario: run(ZD065, lay(program, MIRROR), s, SETUP)  # noqa: E731
        yield name, record.walked, seconds(work)


def main():
    for name, steps, time_s in measure():
        per = 1e9 * time_s / steps
        print(f"{name:28} {steps:>10,} steps {time_s:7.3f} s {per:8.1f} ns a step")


if __name__ == "__main__":
    main()

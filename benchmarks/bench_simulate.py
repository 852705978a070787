"""How fast the simulated controllers run, with and without faults, beside the plain path.

Run: python benchmarks/bench_simulate.py. One core, processor time, the best of three rounds. Round
holes of a million steps: full circles for the ZD-065, a tape of whole degrees for the NBY-15,
vectors for the Eindhoven controller. `trace` is the path alone, `run` the motors with play, the
state machine and the events; the program is laid anew in each.
"""

import sys
import time
from dataclasses import replace

import numpy as np

from wedmcam.controllers.eindhoven.vectors import Vectors
from wedmcam.controllers.nby15.data import TAPE, program_of
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, drawn, scenario_of

STEPS = 1_000_000
FAULTS = 1000


def circles():
    """Return full circles of R 0.5 mm and lines between them, of about a million steps."""
    out = np.zeros(480, BLOCK)
    circle = int(MIRROR.arc_end(500, 0, 1, 500, 0).count_square)
    lines, arcs = out[::2], out[1::2]
    lines["x"], lines["axis"], lines["count"] = 170, Axis.X, 170
    arcs["kind"], arcs["turn"], arcs["axis"] = Kind.ARC, 1, Axis.SQUARE
    arcs["x"], arcs["count"] = 500, circle
    return Program(out)


def tape():
    """Return the same circles by degrees, as a tape has them."""
    rows = np.zeros(480, TAPE)
    rows["kind"][::2], rows["x"][::2] = Kind.LINE, 170
    rows["kind"][1::2], rows["turn"][1::2] = Kind.ARC, 1
    rows["radius"][1::2], rows["degrees"][1::2] = 500, 360
    return program_of(rows)


def vectors():
    """Return circles of R 10 mm in chords of 5 degrees, a little over 0.8 mm; steps are 2 um."""
    turn = np.radians(np.arange(0, 361, 5))
    places = np.round(5000 * np.column_stack([np.cos(turn), np.sin(turn)])).astype(np.int64)
    chords = np.diff(places, axis=0)
    out = np.zeros(25 * len(chords), BLOCK)
    out["x"], out["y"] = np.tile(chords, (25, 1)).T
    out["count"] = 64
    return Program(out, step_um=2)


#: Controller -> its program, and how its path is made.
PROGRAMS = {
    "zd065": (circles, MIRROR),
    "nby15": (tape, MIRROR),
    "eindhoven": (vectors, Vectors()),
}


def seconds(work, rounds=3):
    """Return the least processor time of some rounds."""
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def scenarios(controller, route):
    """Yield a name and a scenario: nothing, many of one kind, and of every kind by chance."""
    rng = np.random.default_rng(1)
    places = np.sort(rng.choice(np.arange(300, route.steps), FAULTS, replace=False)).tolist()
    yield "no fault", scenario_of([])
    yield "1,000 short circuits", scenario_of(Fault(Trouble.SHORT, k, length=60) for k in places)
    yield "1,000 power cuts", scenario_of(Fault(Trouble.POWER, k) for k in places)
    every = drawn(1, FAULTS, route, controller.answers.troubles)
    if controller.answers.returns:
        # To the start of the block: to that of the program it is half a million steps each time.
        every = [
            replace(fault, block=route.reading(fault.step).block)
            if fault.trouble is Trouble.BREAK
            else fault
            for fault in every
        ]
    yield "1,000 of every kind", scenario_of(every)


def measure(names=tuple(PROGRAMS), rounds=3):
    """Yield controller, what was run, its steps, and seconds."""
    for name in names:
        controller, (program_of_it, stepping) = CONTROLLERS[name], PROGRAMS[name]
        program = program_of_it()
        play = (12, 15) if controller.takes_up_play else (0, 0)
        setup = Setup(backlash=play, play=play)
        route = controller.lay(program, stepping)
        assert route.steps >= STEPS
        yield name, "trace", route.steps, seconds(lambda p=program, s=stepping: s.trace(p.blocks))
        for what, scenario in scenarios(controller, route):

            def work(
                controller=controller,
                program=program,
                stepping=stepping,
                scenario=scenario,
                setup=setup,
            ):
                record, wrong = run(controller, controller.lay(program, stepping), scenario, setup)
                assert not wrong
                return record

            yield name, f"run, {what}", work().walked, seconds(work, rounds)


def line(name, what, steps, time_s):
    """Return a row as text."""
    per = 1e9 * time_s / steps
    return f"{name:9} {what:26} {steps:>10,} steps {time_s:7.3f} s {per:8.1f} ns a step"


def main():
    for row in measure(sys.argv[1:] or tuple(PROGRAMS)):
        print(line(*row))


if __name__ == "__main__":
    main()

"""Three laws of a gap servo side by side, and how many pulses a second are simulated.

Run: python benchmarks/bench_servo.py [PROGRAM.zd] [--steps N] [--seeds N] [--json]. One core,
processor time. The table is of the gap model, not of a machine. Then pulses a second: of the gap
alone, and of whole runs, each servo at each controller on the first steps of a sample.
"""

import argparse
import json
import time
from pathlib import Path

from wedmcam import api
from wedmcam.operations.servo import compare_servos
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.feeding import feeding_of
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.route import lay
from wedmcam.simulate.run import run
from wedmcam.simulate.runs import AtOnce, OneByOne
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of

GOLDEN = Path(__file__).parents[1] / "tests" / "golden"
CAM = GOLDEN / "cam.zd"
#: A sample that all three controllers cut, without its suffix, and so many steps of it.
SAMPLE, SAMPLE_STEPS = "key-punch", 2000


def pulses_a_second(servo, draw, steps):
    """Return how many pulses are drawn in a second of processor time."""
    feeding = feeding_of(servo, 1, draw=draw)
    begin = time.process_time()
    feeding.forward(0, steps, 0, 100)
    return feeding.gap.pulses / (time.process_time() - begin)


def runs(steps=SAMPLE_STEPS):
    """Yield controller, servo, steps cut, pulses, steps back and seconds of whole runs."""
    for controller in CONTROLLERS.values():
        program, machine, _ = api.read_program(GOLDEN / f"{SAMPLE}{controller.suffix}")
        route = controller.lay(program, machine.stepping)
        play = (12, 15) if controller.takes_up_play else (0, 0)
        for servo in LAWS:
            feeding = feeding_of(servo, 1, step_um=route.step_um)
            stop = scenario_of([Fault(Trouble.POWER, steps)])
            begin = time.process_time()
            record, wrong = run(
                controller, route, stop, Setup(play, play), stop_at_power=True, feeder=feeding
            )
            spent = time.process_time() - begin
            assert not wrong
            assert record.state.stand.step == steps
            yield controller.name, servo, steps, feeding.gap.pulses, feeding.tally.back, spent


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", nargs="?", type=Path, default=CAM)
    parser.add_argument("--steps", type=int, default=20_000)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    program, machine, _ = api.read_program(options.program)
    route = lay(program, machine.stepping)
    begin = time.process_time()
    result = compare_servos(
        route, options.program.name, seeds=range(options.seeds), steps=options.steps
    )
    seconds = time.process_time() - begin
    if options.json:
        print(json.dumps(result.summary, indent=1))
        return
    print(f"{result.input}, the first {result.trials[0].steps:,} steps, {options.seeds} seeds")
    print(result.table, end="")
    print(f"exact: {result.summary['exact']}; {seconds:.1f} s")
    for servo in LAWS:
        fast = pulses_a_second(servo, AtOnce(), 5000) / 1e6
        slow = pulses_a_second(servo, OneByOne(), 100) / 1e6
        print(f"{servo:9} {fast:5.1f} million pulses a second at once, {slow:.2f} one by one")
    print(f"whole runs, {SAMPLE}:")
    for controller, servo, steps, pulses, back, spent in runs(min(options.steps, SAMPLE_STEPS)):
        print(
            f"{controller:9} {servo:9} {steps:,} steps, {back:>5,} back, "
            f"{pulses / 1e6:6.2f} million pulses in {spent:.2f} s: "
            f"{pulses / spent / 1e6:5.1f} million a second"
        )


if __name__ == "__main__":
    main()

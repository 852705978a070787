"""Random faults on every simulated controller: is the path cut that without faults, step by step?

Run: python benchmarks/measure_faults.py [N] [--seed S]. N scenarios of up to six faults on each
controller, of every kind that it knows, several at a step, at the start, the end, thread points and
borders of blocks among them; a power cut takes the state through its file. The law is the one of
`tests/fault_runs.py`. One core, processor time; exit status 1 where a scenario breaks the law.
"""

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import scenario_of

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from fault_runs import assert_cut_as_without_faults, random_faults, route_of, setup_of


def measure(name, count, seed):
    """Return how many scenarios broke the law, events, steps walked, and ms a scenario."""
    controller, route, setup = CONTROLLERS[name], route_of(name), setup_of(name)
    rng = np.random.default_rng([seed, len(name)])
    broken, walked, events, spent = [], 0, Counter(), 0.0
    for _ in range(count):
        faults = random_faults(name, rng)
        begin = time.process_time()
        record, wrong = run(controller, route, scenario_of(faults), setup)
        spent += time.process_time() - begin
        try:
            assert not wrong
            assert_cut_as_without_faults(name, record, faults)
        except AssertionError:
            broken.append(" ".join(map(str, faults)))
            continue
        walked += record.walked
        events.update(event.kind for event in record.events)
    return broken, events, walked, 1000 * spent / count


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    failed = 0
    for name in CONTROLLERS:
        broken, events, walked, each = measure(name, options.count, options.seed)
        failed += len(broken)
        shown = ", ".join(f"{count} {kind}" for kind, count in sorted(events.items()))
        print(
            f"{name:9} {options.count:,} scenarios on {route_of(name).steps:,} steps: "
            f"{len(broken)} broken; {walked:,} steps walked, {each:.1f} ms a run; {shown}"
        )
        for faults in broken[:10]:
            print(f"  broken: {faults}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()

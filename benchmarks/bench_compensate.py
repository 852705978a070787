"""How fast compensation is: ns a segment on made gears, stators and splines of known size.

Run: python benchmarks/bench_compensate.py [--json] [--most 10000]. One core, float64, best of
several rounds; "ratio" is to a fixed reference loop of numpy (1 million square roots), which moves
with the machine as the offset does.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import parts
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.largest import largest_offset

OFFSET_UM = 130.0
MAKE = {"gear": parts.gear, "stator": parts.stator, "pinch": parts.pinch, "biarc": parts.biarc}


def best(function, rounds):
    """Return the least processor time of some runs of a function, s."""
    times = []
    for _ in range(rounds):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--json", action="store_true")
    asked.add_argument("--most", type=int, default=10_000)
    asked.add_argument("--work", action="append", choices=MAKE)
    options = asked.parse_args()
    values = np.random.default_rng(1).uniform(1, 2, 1_000_000)
    reference = best(lambda: np.sqrt(values), 20)
    rows = []
    for name in options.work or MAKE:
        for size in (96, 1000, 10_000, 100_000):
            if size > options.most:
                continue
            contour = MAKE[name](size)
            for shift in (-OFFSET_UM, OFFSET_UM):
                spent = best(
                    lambda c=contour, s=shift: compensate([c], [s]), 15 if size <= 1000 else 3
                )
                result, problems = compensate([contour], [shift])
                rows.append(
                    {
                        "work": f"{name}{size}",
                        "shift_um": shift,
                        "loops": len(result.paths),
                        "ns_a_segment": round(1e9 * spent / size),
                        "ms": round(1e3 * spent, 3),
                        "ratio": round(spent / reference, 2),
                        "resolved": not problems,
                    }
                )
    for name in options.work or MAKE:
        contour = MAKE[name](1000)
        start = time.process_time()
        largest = largest_offset([contour], [1.0])
        spent = time.process_time() - start
        rows.append(
            {
                "work": f"largest, {name}1000",
                "offset_um": round(largest.offset_um, 2),
                "limit": largest.limit.kind if largest.limit else None,
                "ms": round(1e3 * spent, 1),
                "ratio": round(spent / reference, 1),
            }
        )
    if options.json:
        print(json.dumps({"reference_ms": round(1e3 * reference, 3), "rows": rows}, indent=1))
        return
    print(f"reference loop {1e3 * reference:.3f} ms")
    for row in rows:
        print("  ".join(f"{k} {v}" for k, v in row.items()))


if __name__ == "__main__":
    main()

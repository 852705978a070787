"""How fast arrays of 8-digit decimals are, against Python's `decimal` and numpy's float64.

Run: python benchmarks/bench_decimal8.py [--count N] [--json]. One core; the parties alternate,
best of several rounds. `decimal` (8 digits, ROUND_HALF_UP) runs in a list comprehension on a
tenth of the operands; everything is given in nanoseconds an element.
"""

import argparse
import decimal
import json
import operator
import time

import numpy as np

from wedmcam.decimal8 import Decimal8Array, hypot

EIGHT = decimal.Context(prec=8, rounding=decimal.ROUND_HALF_UP)


def best(functions, rounds):
    """Best time of each function; they take turns, so that a busy machine is busy for all."""
    times = [[] for _ in functions]
    for _ in range(rounds):
        for function, taken in zip(functions, times, strict=True):
            start = time.perf_counter()
            function()
            taken.append(time.perf_counter() - start)
    return [min(taken) for taken in times]


def measure(count, rounds):
    rng = np.random.default_rng(1)

    def numbers():
        m = rng.integers(10**7, 10**8, count) * rng.choice([-1, 1], count)
        return Decimal8Array.from_parts(m, rng.integers(-3, 5, count))

    a, b = numbers(), numbers()
    positive, angle = abs(a), Decimal8Array(rng.uniform(-7, 7, count))
    turn = Decimal8Array(rng.uniform(-360, 360, count))
    few = max(count // 10, 1)
    x, y, root = a[:few].tolist(), b[:few].tolist(), positive[:few].tolist()
    fx, fy, fangle = a.to_float(), b.to_float(), angle.to_float()

    def loop(function):
        def run():
            for p, q in zip(x, y, strict=True):
                function(p, q)

        return run

    def roots():
        for p in root:
            EIGHT.sqrt(p)

    cases = {
        "add": (lambda: a + b, loop(operator.add), lambda: fx + fy),
        "sub": (lambda: a - b, loop(operator.sub), lambda: fx - fy),
        "mul": (lambda: a * b, loop(operator.mul), lambda: fx * fy),
        "div": (lambda: a / b, loop(operator.truediv), lambda: fx / fy),
        "sqrt": (lambda: np.sqrt(positive), roots, lambda: np.sqrt(np.abs(fx))),
        "sin": (lambda: np.sin(angle), None, lambda: np.sin(fangle)),
        "cos": (lambda: np.cos(angle), None, lambda: np.cos(fangle)),
        "tan": (lambda: np.tan(angle), None, lambda: np.tan(fangle)),
        "sin degrees": (lambda: turn.sin(True), None, lambda: np.sin(fangle)),
        "atan2": (lambda: np.arctan2(a, b), None, lambda: np.arctan2(fx, fy)),
        "hypot": (lambda: hypot(a, b), None, lambda: np.hypot(fx, fy)),
        "less": (lambda: a < b, loop(operator.lt), lambda: fx < fy),
        "from float": (lambda: Decimal8Array(fx), None, lambda: fx.copy()),
        "to float": (lambda: a.to_float(), None, lambda: fx.copy()),
    }
    out = {}
    with decimal.localcontext(EIGHT):
        for name, (ours, python, floats) in cases.items():
            times = best([ours, floats, *([python] if python else [])], rounds)
            row = {"ns": times[0] / count * 1e9, "float64": times[1] / count * 1e9}
            if python:
                row["decimal"] = times[2] / few * 1e9
            out[name] = row
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    table = measure(arguments.count, arguments.rounds)
    if arguments.json:
        print(json.dumps(table, indent=1))
        return
    print(f"{'':12} {'ns':>8} {'decimal':>9} {'faster':>8} {'float64':>9} {'slower':>8}")
    for name, row in table.items():
        python = row.get("decimal")
        against = f"{python:9.1f} {python / row['ns']:7.1f}x" if python else " " * 18
        print(
            f"{name:12} {row['ns']:8.2f} {against} {row['float64']:9.2f}"
            f" {row['ns'] / row['float64']:7.1f}x"
        )


if __name__ == "__main__":
    main()

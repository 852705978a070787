"""How fast arrays of 8-digit decimals are, against Python's `decimal` and numpy's float64.

Run: python benchmarks/bench_decimal8.py [--count N] [--json]. One core; the parties alternate,
best of several rounds. `decimal` (8 digits, ROUND_HALF_UP) runs in a loop over a tenth of the
operands. Large arrays in nanoseconds an element; then short ones, where calls count and not
elements, in microseconds an operation.
"""

import argparse
import decimal
import json
import operator
import time

import numpy as np

from wedmcam.decimal8 import DECIMAL8, Decimal8Array, hypot

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


SIZES = (1, 10, 100, 1000, 5000)


def short_cases(rng, n):
    """Operations by name on n coordinates of a part, in um to a hundredth; and on float64.

    About one sum in ten of such is a tie, and every other half.
    """
    fx, fy = np.round(rng.uniform(-2e5, 2e5, (2, n)), 2)
    ft, fp, truth = rng.uniform(-3, 3, n), np.abs(fy), fx > 0
    a, b, t, p = map(DECIMAL8.array, (fx, fy, ft, fp))
    return {
        "a + b": (lambda: a + b, lambda: fx + fy),
        "a * b": (lambda: a * b, lambda: fx * fy),
        "a / b": (lambda: a / b, lambda: fx / fy),
        "a / 2": (lambda: a / 2, lambda: fx / 2),
        "sqrt": (lambda: DECIMAL8.sqrt(p), lambda: np.sqrt(fp)),
        "sin": (lambda: DECIMAL8.sin(t), lambda: np.sin(ft)),
        "a > 0": (lambda: a > 0, lambda: fx > 0),
        "-a": (lambda: -a, lambda: -fx),
        "where": (lambda: DECIMAL8.where(truth, a, b), lambda: np.where(truth, fx, fy)),
        "from float": (lambda: DECIMAL8.array(fx), lambda: fx.copy()),
        "to float": (lambda: DECIMAL8.to_float(a), lambda: fx.copy()),
    }


def short(rounds, sizes=SIZES):
    """Microseconds an operation by name and size: 8-digit decimals, and float64."""
    rng = np.random.default_rng(2)
    out = {}
    for n in sizes:
        many = max(20_000 // (n + 100), 5)
        for name, both in short_cases(rng, n).items():
            ours, floats = (t / many * 1e6 for t in best([repeat(f, many) for f in both], rounds))
            out.setdefault(name, {})[n] = {"us": ours, "float64": floats}
    return out


def repeat(function, many):
    def run():
        for _ in range(many):
            function()

    return run


def large_table(rows):
    """The figures of `measure` as Markdown."""
    yield "| | ns | `decimal` | faster | float64 | slower |"
    yield "|---|---|---|---|---|---|"
    for name, row in rows.items():
        python = row.get("decimal")
        against = f"{python:.0f} | {python / row['ns']:.1f}" if python else "|"
        yield (
            f"| {name} | {row['ns']:.1f} | {against} | {row['float64']:.1f} | "
            f"{row['ns'] / row['float64']:.1f} |"
        )


def short_table(rows):
    """The figures of `short` as Markdown."""
    sizes = list(next(iter(rows.values())))
    yield f"| | {' | '.join(map(str, sizes))} |"
    yield "|---" * (len(sizes) + 1) + "|"
    for name, row in rows.items():
        cells = (f"{cell['us']:.1f} ({cell['float64']:.1f})" for cell in row.values())
        yield f"| {name} | {' | '.join(cells)} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    large, few = measure(arguments.count, arguments.rounds), short(arguments.rounds)
    if arguments.json:
        print(json.dumps({"large": large, "short": few}, indent=1))
        return
    print("\n".join([*large_table(large), "", *short_table(few)]))


if __name__ == "__main__":
    main()

"""How fast the controller's closed forms are, against the step loop in Python and in C.

Run: python benchmarks/bench_controller.py [--json]. One core, processor time, best of several
rounds. The C loop is built with `cc` on the spot and left out where there is none.
"""

import argparse
import ctypes
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from wedmcam.controllers.pointwise import (
    LineTable,
    arc_end,
    block_steps,
    deviation,
    position,
    run,
    trace,
)
from wedmcam.ir.program import BLOCK, Axis, Kind

C_LOOP = r"""
#include <stdint.h>
/* End of a counter-clockwise or clockwise arc by the step loop; returns the number of steps. */
int64_t arc(int64_t x, int64_t y, int turn, int axis, int64_t count, int64_t *out) {
    int64_t f = 0, n = 0;
    y *= turn; /* mirrored, every arc runs counter-clockwise */
    while (count > 0) {
        int shrinks_x = (x > 0 && y >= 0) || (x < 0 && y <= 0);
        int on_x = shrinks_x == (f >= 0);
        int64_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
        int counted = axis == 2 ? on_x == (ax < ay) : on_x == (axis == 0);
        if (on_x) {
            int s = y > 0 ? -1 : y < 0 ? 1 : x > 0 ? -1 : 1;
            f += 2 * s * x + 1; x += s;
        } else {
            int s = x > 0 ? 1 : x < 0 ? -1 : y > 0 ? -1 : 1;
            f += 2 * s * y + 1; y += s;
        }
        count -= counted; n++;
        if (out) { *out++ = x; *out++ = y * turn; }
    }
    return n;
}
int64_t line(int64_t x, int64_t y, int on_x, int64_t count, int64_t *out) {
    int64_t f = 0, n = 0, ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, px = 0, py = 0;
    int sx = x < 0 ? -1 : 1, sy = y < 0 ? -1 : 1;
    while (count > 0) {
        if (ay == 0 || (ax != 0 && f >= 0)) { f -= ay; px += sx; count -= on_x; }
        else { f += ax; py += sy; count -= !on_x; }
        n++;
        if (out) { *out++ = px; *out++ = py; }
    }
    return n;
}
"""


def best(function, rounds=7):
    times = []
    for _ in range(rounds):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def c_loop():
    cc = shutil.which("cc")
    if cc is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder, "loop.c"), Path(folder, "loop.so")
        source.write_text(C_LOOP)
        command = [cc, "-O3", "-march=native", "-shared", "-fPIC", source, "-o", library]
        subprocess.run(command, check=True)
        loop = ctypes.CDLL(str(library))
    i64, i32 = ctypes.c_int64, ctypes.c_int
    loop.arc.argtypes = [i64, i64, i32, i32, i64, ctypes.c_void_p]
    loop.line.argtypes = [i64, i64, i32, i64, ctypes.c_void_p]
    loop.arc.restype = loop.line.restype = i64
    return loop


def lines(n, size):
    rng = np.random.default_rng(1)
    b = np.zeros(n, BLOCK)
    b["x"], b["y"] = rng.integers(1, size, (2, n)) * rng.choice([-1, 1], (2, n))
    b["axis"] = np.where(np.abs(b["x"]) > np.abs(b["y"]), Axis.X, Axis.Y)
    b["count"] = np.maximum(np.abs(b["x"]), np.abs(b["y"]))
    return b


def arcs(n, size, square):
    rng = np.random.default_rng(2)
    b = np.zeros(n, BLOCK)
    b["kind"], b["turn"] = Kind.ARC, rng.choice([-1, 1], n)
    b["x"], b["y"] = rng.integers(1, size, (2, n)) * rng.choice([-1, 1], (2, n))
    b["axis"] = Axis.SQUARE if square else rng.integers(0, 2, n)
    b["count"] = rng.integers(1, size, n)
    return b


def one(kind, x, y, axis, count, n=1):
    b = np.zeros(n, BLOCK)
    b["kind"], b["turn"] = kind, kind == Kind.ARC
    b["x"], b["y"], b["axis"], b["count"] = x, y, axis, count
    return b


def blocks_a_second(n):
    some_lines, xy, square = lines(n, 50_000), arcs(n, 50_000, False), arcs(n, 50_000, True)
    mixed = np.concatenate([some_lines, xy, square])
    np.random.default_rng(3).shuffle(mixed)
    out = {}
    for table in LineTable:
        out[f"run, lines, {table}"] = n / best(lambda table=table: run(some_lines, table))
    out["run, arcs counted on x or y"] = n / best(lambda: run(xy))
    out["run, arcs counted on the square"] = n / best(lambda: run(square))
    out["run, all three shuffled"] = 3 * n / best(lambda: run(mixed))
    x, y, turn = (np.ascontiguousarray(xy[k]) for k in ("x", "y", "turn"))
    moves = run(xy)
    ex, ey = x + moves.dx, y + moves.dy
    out["arc_end"] = n / best(lambda: arc_end(x, y, turn, ex, ey))
    half = np.maximum(run(mixed).steps // 2, 0)
    out["position, all three shuffled"] = 3 * n / best(lambda: position(mixed, half))
    return out


WORK = {
    "line 14 mm": one(Kind.LINE, 10_000, 4_000, Axis.X, 10_000),
    "line 1.4 m": one(Kind.LINE, 999_999, 400_000, Axis.X, 999_999),
    "circle R 10 mm": one(Kind.ARC, 10_000, 0, Axis.Y, 40_000),
    "quadrant R 1 m": one(Kind.ARC, 999_999, 0, Axis.Y, 999_999),
    "700 um lines": one(Kind.LINE, 700, 300, Axis.X, 700, 1000),
    "70 um lines": one(Kind.LINE, 70, 30, Axis.X, 70, 10_000),
    "quadrants R 0.2 mm": one(Kind.ARC, 200, 0, Axis.Y, 200, 3000),
    "quadrants R 2 mm": one(Kind.ARC, 2_000, 0, Axis.Y, 2_000, 300),
}


def stored(loop, blocks, out):
    """Fill ``out`` with where the C loop stands after each step, from the start of each block.

    Lines from their start, arcs from their centre, lines by the table of mirror images.
    """
    at = out.ctypes.data
    for kind, turn, axis, _, x, y, count, *_ in blocks.tolist():
        if kind == Kind.ARC:
            at += 16 * loop.arc(x, y, turn, axis, count, at)
        else:
            at += 16 * loop.line(x, y, axis == Axis.X, count, at)


def nanoseconds_a_step(loop):
    rows = {}
    for name, b in WORK.items():
        total = int(run(b).steps.sum())
        row = {
            "steps": total,
            "trace": best(lambda b=b: trace(b)) / total * 1e9,
            "deviation": best(lambda b=b: deviation(b)) / total * 1e9,
        }
        few = b[: max(1, 50_000 * len(b) // total)]
        stepped = int(run(few).steps.sum())
        if stepped < 300_000:
            python = best(lambda few=few: [sum(1 for _ in block_steps(r)) for r in few], 2)
            row["Python loop"] = python / stepped * 1e9
        if loop is not None:
            out = np.empty((total, 2), np.int64)

            row["C loop, stored"] = best(lambda b=b, out=out: stored(loop, b, out)) / total * 1e9
        rows[name] = row
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--blocks", type=int, default=400_000)
    args = parser.parse_args()
    speed, steps = blocks_a_second(args.blocks), nanoseconds_a_step(c_loop())
    if args.json:
        print(json.dumps({"blocks_per_second": speed, "ns_per_step": steps}, indent=1))
        return
    print("million blocks a second")
    for name, value in speed.items():
        print(f"  {name:34}{value / 1e6:8.1f}")
    print("\nns a step")
    columns = ("steps", "trace", "deviation", "Python loop", "C loop, stored")
    print(f"  {'':20}" + "".join(f"{c:>16}" for c in columns))
    for name, row in steps.items():
        cells = [row.get(c) for c in columns]
        texts = [f"{cells[0]}"] + ["-" if c is None else f"{c:.2f}" for c in cells[1:]]
        print(f"  {name:20}" + "".join(f"{t:>16}" for t in texts))


if __name__ == "__main__":
    main()

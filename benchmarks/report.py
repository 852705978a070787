"""All benchmarks in one run, side by side, as one page.

Run: python benchmarks/report.py [docs/benchmarks.md] [--quick]. Everything is measured anew on this
machine; what compares is measured in turn within seconds, so ratios mean something where
milliseconds do not. Without a name the page goes to standard output.
"""

import argparse
import os
import platform
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path

import bench_arithmetic
import bench_controller
import bench_decimal8
import bench_forgeries
import bench_offsets
import bench_read
import bench_simulate
import bench_stages
import bench_verify

HERE = Path(__file__).parent


def output_of(script, *arguments):
    """Return what a benchmark prints, as a block of code."""
    command = [sys.executable, str(HERE / script), *arguments]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return ["```", *told.rstrip().splitlines(), "```"]


def controller_lines(speed, steps):
    """Yield the controller's figures as Markdown."""
    yield "Closed forms, million blocks a second, one core:"
    yield ""
    yield "| what | million blocks a second |"
    yield "|---|---|"
    for name, value in speed.items():
        yield f"| {name} | {value / 1e6:.1f} |"
    yield ""
    yield (
        "All places of a path (`trace`) and its exact extreme deviation (`deviation`), ns a step, "
        "against a C step loop (cc -O3) that stores every place, and the Python loop of the book:"
    )
    yield ""
    yield "| work | steps | trace | deviation | C loop | Python loop | C / trace |"
    yield "|---|---|---|---|---|---|---|"
    for name, row in steps.items():
        c = row.get("C loop, stored")
        python = row.get("Python loop")
        trace = row["trace"]
        cells = (
            "-" if c is None else f"{c:.2f}",
            "-" if python is None else f"{python:.0f}",
            "-" if c is None else f"{c / trace:.2f}",
        )
        yield (
            f"| {name} | {row['steps']} | {trace:.2f} | {row['deviation']:.3f} | "
            f"{' | '.join(cells)} |"
        )


def summary(speed, steps, stages, long, reading, part, counts, arithmetic, decimals, machines):
    """Yield a table of what was to be reached, what was measured, and whether it was reached."""
    rows = []

    def row(what, bound, value, good, unit=""):
        rows.append((what, bound, f"{value}{unit}", "yes" if good else "**no**"))

    lines = min(v for k, v in speed.items() if k.startswith("run, lines"))
    arcs = min(v for k, v in speed.items() if k.startswith("run, arcs"))
    row("end points of lines a second", "10, target 20 million", f"{lines / 1e6:.1f}",
        lines >= 10e6, " million")  # fmt: skip
    row("end points of arcs a second", "2, target 5 million", f"{arcs / 1e6:.1f}",
        arcs >= 2e6, " million")  # fmt: skip
    ends = speed["arc_end"]
    row("J for a wanted end of arcs a second", "2, target 5 million", f"{ends / 1e6:.1f}",
        ends >= 2e6, " million")  # fmt: skip
    for what in ("trace", "deviation"):
        for title, some in (
            ("long blocks", [steps["line 1.4 m"], steps["quadrant R 1 m"]]),
            (
                "many blocks of 0.07 to 2 mm",
                [r for k, r in steps.items() if k.endswith(" lines") or k.startswith("quadrants")],
            ),
        ):
            worst = max(r[what] for r in some)
            row(f"{what}, {title}", "8 ns a step", f"{worst:.1f}", worst <= 8, " ns")
    row(f"`verify` of {long['blocks']} blocks of 3B, reading included", "10 s, 1 GB",
        f"{long['s']} s, {long['mb']} MB", long["s"] < 10 and long["mb"] < 1000)  # fmt: skip
    for name, rate in reading.items():
        least, target = bench_read.WANTED[name]
        row(f"reading {name}, blocks a second", f"{least}, target {target}", f"{rate:.0f}",
            rate >= least)  # fmt: skip
    row("a part program of 2,000 lines, over one of one contour", "1 s", f"{part:.2f}", part < 1,
        " s")  # fmt: skip
    for r in stages:
        for figures in bench_stages.ARITHMETICS:
            adds = r[figures]["judge_adds"]
            row(f"judge on top of a compile in {figures}, {r['entities']} entities",
                "25 %, target 10 %", f"{100 * adds:.0f}", adds < 0.25, " %")  # fmt: skip
    for a, b in pairwise(stages):
        for stage in bench_stages.STAGES:
            times = b["decimal8"][stage] / a["decimal8"][stage]
            row(f"{stage}, {a['entities']} to {b['entities']} entities", "13 times",
                f"{times:.1f}", times <= 13, " times")  # fmt: skip
    total = sum(counts.values(), Counter())
    rate = 100 * total["far refused"] / max(total["far"], 1)
    row("forgeries beyond 2 um refused", "100 %", f"{rate:.2f} % of {total['far']}", rate == 100)
    for r in arithmetic:
        row(f"compile in decimal8, {r['part']}", "1.3 x float64", f"{r['ratio']:.2f}",
            r["ratio"] <= 1.3, " x")  # fmt: skip
    for name, least, target in (("add", 2, 10), ("mul", 6, 20), ("div", 6, 20), ("sqrt", 6, 20)):
        if "decimal" in decimals.get(name, {}):
            times = decimals[name]["decimal"] / decimals[name]["ns"]
            row(f"decimal8 {name} against `decimal` in a loop", f"{least} x, target {target} x",
                f"{times:.1f}", times >= least, " x")  # fmt: skip
    for name in ("sin", "cos"):
        times = decimals[name]["ns"] / decimals[name]["float64"]
        row(f"decimal8 {name} against float64", "at most 8 x", f"{times:.1f}", times <= 8, " x")
    for name in bench_simulate.PROGRAMS:
        slowest = max(s for of, what, _, s in machines if of == name and what.startswith("run"))
        row(f"{name} simulated, 1,000,000 steps, 1,000 faults", "5 s", f"{slowest:.1f}",
            slowest < 5, " s")  # fmt: skip
    yield "| demand | to reach | measured | reached |"
    yield "|---|---|---|---|"
    for r in rows:
        yield f"| {' | '.join(r)} |"


def page(quick):
    """Yield the lines of the page."""
    speed = bench_controller.blocks_a_second(20_000 if quick else 400_000)
    steps = bench_controller.nanoseconds_a_step(bench_controller.c_loop())
    decimals = bench_decimal8.measure(20_000 if quick else 1_000_000, 2 if quick else 9)
    arithmetic = bench_arithmetic.rows(200 if quick else 1000)
    stages = bench_stages.rows(1000 if quick else 100_000)
    long = bench_verify.measured(10_000 if quick else 1_000_000)
    reading = bench_read.rates(20_000 if quick else 200_000)
    part = bench_read.part_seconds(200 if quick else 2000)
    programs = list(bench_forgeries.forgeries.PROGRAMS)[: 1 if quick else None]
    machines = list(bench_simulate.measure(rounds=1 if quick else 3))
    counts, missed = bench_forgeries.rates(programs, 20)
    yield "# Benchmarks"
    yield ""
    cores = os.cpu_count()
    yield (
        f"`make bench` writes this page. Python {platform.python_version()} on "
        f"{platform.system()} {platform.machine()}, {cores} cores; everything uses one. "
        "Times move with the machine; ratios are of runs side by side."
    )
    yield ""
    yield "## What was to be reached"
    yield ""
    yield from summary(
        speed, steps, stages, long, reading, part, counts, arithmetic, decimals, machines
    )
    yield ""
    yield "## Start, and small parts"
    yield ""
    yield from output_of("bench_compile.py")
    yield ""
    yield "## Compile time by stage"
    yield ""
    yield (
        "A plate of toothed contours, 48 loose lines and arcs each, in any order; processor time. "
        "`prove` decodes the bytes and judges them; what it adds is a part of the rest of the "
        "compile. Imports are left out of both."
    )
    yield ""
    yield from bench_stages.table(stages)
    yield ""
    yield "## Controller"
    yield ""
    yield from controller_lines(speed, steps)
    yield ""
    yield "## Simulated machines"
    yield ""
    yield (
        "Round holes of a million steps: the ZD-065 with backlash, the NBY-15 by a tape of "
        "degrees, Eindhoven's by vectors; processor time. `every kind` has returns to the start "
        "of the block at the ZD-065:"
    )
    yield ""
    yield from ["```", *(bench_simulate.line(*row) for row in machines), "```"]
    yield ""
    yield (
        "With the gap model, three servos: what they do on the same part, and how many power "
        "pulses are simulated a second, of the gap alone and in whole runs:"
    )
    yield ""
    yield from output_of("bench_servo.py", *(("--steps", "300", "--seeds", "1") if quick else ()))
    yield ""
    yield "## Offsets"
    yield ""
    yield (
        f"{bench_offsets.OFFSET_UM / 1000} mm outwards. Ours keeps arcs; the polygons of the "
        f"others have chords of {bench_offsets.SAGITTA} um sagitta, in and out. CavalierContours, "
        "which keeps arcs too, was measured once on another machine: gear1000 373 ns a segment in "
        "C++ and 185 in Rust, stator1000 598 and 390 (outwards 0.13 mm)."
    )
    yield ""
    yield from bench_offsets.offset_table(bench_offsets.offsets(96 if quick else 10_000))
    yield ""
    yield "The route by polygons (ezdxf flattening, shapely buffer, chords as 3B lines):"
    yield ""
    yield from bench_offsets.route_table(bench_offsets.routes(1000 if quick else 10_000))
    yield ""
    if not quick:
        yield "Made parts, both sides, and the largest offset that fits:"
        yield ""
        yield from output_of("bench_compensate.py", "--most", "1000")
        yield ""
    yield "## 8-digit decimal arithmetic"
    yield ""
    yield "Arrays of a million, ns an element:"
    yield ""
    yield from bench_decimal8.large_table(decimals)
    yield ""
    yield "Short arrays, microseconds an operation:"
    yield ""
    yield from bench_decimal8.short_table(bench_decimal8.short(2 if quick else 9))
    yield ""
    yield "What it costs a compile, against float64:"
    yield ""
    yield from bench_arithmetic.table(arithmetic)
    yield ""
    yield "## Forgeries"
    yield ""
    yield from bench_forgeries.table(counts)
    for one in missed:
        yield f"* got through: {one}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", nargs="?")
    parser.add_argument("--quick", action="store_true", help="small sizes: does it run at all")
    asked = parser.parse_args()
    text = "\n".join(page(asked.quick)) + "\n"
    if asked.output is None:
        sys.stdout.write(text)
        return
    Path(asked.output).parent.mkdir(exist_ok=True)
    Path(asked.output).write_text(text, "utf-8")


if __name__ == "__main__":
    main()

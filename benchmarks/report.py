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
from pathlib import Path

import bench_controller
import bench_decimal8
import bench_forgeries
import bench_offsets
import bench_stages

HERE = Path(__file__).parent


def output_of(script, *arguments):
    """Return what a benchmark prints, as a block of code."""
    command = [sys.executable, str(HERE / script), *arguments]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return ["```", *told.rstrip().splitlines(), "```"]


def controller_lines(blocks):
    """Yield the controller's figures as Markdown."""
    speed = bench_controller.blocks_a_second(blocks)
    steps = bench_controller.nanoseconds_a_step(bench_controller.c_loop())
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


def page(quick):
    """Yield the lines of the page."""
    yield "# Benchmarks"
    yield ""
    cores = os.cpu_count()
    yield (
        f"`make bench` writes this page. Python {platform.python_version()} on "
        f"{platform.system()} {platform.machine()}, {cores} cores; everything uses one. "
        "Times move with the machine; ratios are of runs side by side."
    )
    yield ""
    yield "## Start, and small parts"
    yield ""
    yield from output_of("bench_compile.py")
    yield ""
    yield "## Compile time by stage"
    yield ""
    yield (
        "A plate of toothed contours, 48 loose lines and arcs each, in any order. `prove` decodes "
        "the bytes and judges them; its share is of the whole compile. Imports are left out of "
        "both."
    )
    yield ""
    yield from bench_stages.table(bench_stages.rows(1000 if quick else 100_000))
    yield ""
    yield "## Controller"
    yield ""
    yield from controller_lines(20_000 if quick else 400_000)
    yield ""
    yield "## Offsets"
    yield ""
    yield (
        f"{bench_offsets.OFFSET_UM / 1000} mm outwards. Ours keeps arcs; the polygons of the "
        f"others have chords of {bench_offsets.SAGITTA} um sagitta, in and out."
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
        yield "An element of a large array, ns:"
        yield ""
        yield from bench_decimal8.large_table(bench_decimal8.measure(1_000_000, 9))
        yield ""
        yield "An operation on a short one, us, by number of elements; in brackets float64:"
        yield ""
        yield from bench_decimal8.short_table(bench_decimal8.short(9))
        yield ""
    yield "## Forgeries"
    yield ""
    programs = list(bench_forgeries.forgeries.PROGRAMS)[: 1 if quick else None]
    counts, missed = bench_forgeries.rates(programs, 20)
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

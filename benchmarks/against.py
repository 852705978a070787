"""This tree against another revision of it, row by row, in one run: ``make bench-against REV``.

Every row is a command of its own that both trees run in turn, the other one first every second
time; measured is the processor time of the process, imports included, and the figure of a row is
the median of the ratios of neighbours in time. A row that comes out over 5 % slower is measured
again, with twice the rounds, and only if it is slower again it counts.

Run: python benchmarks/against.py REV [--rounds 9] [--only WORD]
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import bench_read
import stage_drawings

from snapshot import source_of, worktree

ROOT = Path(__file__).parents[1]
#: A row that takes more than so many times as long is slower.
SLOWER = 1.05


def inputs(folder):
    """Write the inputs of all rows into a folder."""
    for size in (1_000, 10_000):
        Path(folder, f"{size}.dxf").write_bytes(stage_drawings.drawing(size)[0])
    for (_, text), name in zip(bench_read.texts(100_000).values(), "abcd", strict=True):
        Path(folder, f"{name}{'.nc' if name == 'd' else '.3b'}").write_text(text)
    Path(folder, "part.wed").write_text(bench_read.part_program(500))


def rows(folder):
    """Return name -> arguments of a command; paths that do not exist yet are written by it."""
    samples = ROOT / "samples"
    offset = ("--offset", "0.1")
    plate, out = f"{samples}/plate.dxf", f"{folder}/out"
    return {
        "--help": ["--help"],
        "compile key-punch": ["compile", f"{samples}/key-punch.dxf", *offset, "-o", f"{out}.3b"],
        "compile plate": ["compile", plate, *offset, "-o", f"{out}.3b"],
        "compile plate, iso-g41": [
            *("compile", plate, *offset, "-o", f"{out}.nc", "--profile", "iso-g41"),
        ],
        "compile plate, 3b,iso,compact": [
            *("compile", plate, *offset, "-o", out, "--to", "3b,iso,compact"),
        ],
        "compile 1,000 entities": ["compile", f"{folder}/1000.dxf", *offset, "-o", f"{out}.3b"],
        "compile 1,000 entities, float64": [
            *("compile", f"{folder}/1000.dxf", *offset, "-o", f"{out}.3b"),
            *("--arithmetic", "float64"),
        ],
        "compile 10,000 entities": ["compile", f"{folder}/10000.dxf", *offset, "-o", f"{out}.zd"],
        "compile a .wed of 500 lines": ["compile", f"{folder}/part.wed", "-o", f"{out}.3b"],
        "inspect plate": ["inspect", plate],
        "verify plate": [
            *("verify", f"{folder}/plate.3b", "--against", plate, *offset),
        ],
        "verify 100,000 records of 3B": ["verify", f"{folder}/a.3b"],
        "verify 100,000 lines of G-code": ["verify", f"{folder}/d.nc", "--profile", "iso-um"],
        "convert 100,000 records": ["convert", f"{folder}/a.3b", "-o", f"{out}.nc"],
        "plot plate": ["plot", f"{folder}/plate.3b", "-o", f"{out}.svg"],
    }


def seconds(tree, arguments):
    """Return the processor time of a command in a tree, with its status."""
    command = [sys.executable, "-m", "wedmcam", *arguments]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, env=source_of(tree), **quiet)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime, process.returncode


def compared(before, arguments, rounds):
    """Return ms before and now, and the ratio: medians of alternating runs."""
    pairs = []
    for k in range(rounds + 1):  # the first pair warms caches
        trees = (before, ROOT) if k % 2 else (ROOT, before)
        times = {tree: seconds(tree, arguments) for tree in trees}
        status = {times[before][1], times[ROOT][1]}
        if len(status) > 1:
            return None, None, status
        pairs.append((times[before][0], times[ROOT][0]))
    pairs = pairs[1:]
    one, two = (1000 * statistics.median(column) for column in zip(*pairs, strict=True))
    return one, two, statistics.median(now / then for then, now in pairs)


def main():
    """Print a table; exit with 1 where a row is slower."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("revision")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    slower = []
    with tempfile.TemporaryDirectory() as folder, worktree(options.revision) as before:
        inputs(folder)
        seconds(before, ["compile", f"{ROOT}/samples/plate.dxf", "--offset", "0.1", "-o",
                         f"{folder}/plate.3b"])  # fmt: skip
        print(f"processor time, {options.revision} and this tree, medians of {options.rounds}")
        print("| row | before, ms | now, ms | ratio |\n|---|---|---|---|")
        for name, arguments in rows(folder).items():
            if options.only not in name:
                continue
            one, two, ratio = compared(before, arguments, options.rounds)
            if one is None:
                print(f"| {name} | exit status differs: {sorted(ratio)} | | - |", flush=True)
                slower.append(name)
                continue
            again = ""
            if ratio > SLOWER:
                again = f" (at first {ratio:.3f})"
                one, two, ratio = compared(before, arguments, 2 * options.rounds)
            if ratio > SLOWER:
                slower.append(name)
            print(f"| {name} | {one:.0f} | {two:.0f} | {ratio:.3f}{again} |", flush=True)
    print(f"slower by more than 5 %: {', '.join(slower) or 'none'}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())

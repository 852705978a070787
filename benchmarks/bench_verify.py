"""`wedmcam verify` of a long 3B program, reading included: time, memory, and what it tells.

The blocks are those of a golden program over and over. Run: python benchmarks/bench_verify.py
[--blocks 1000000] [--json]
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GOLDEN = Path(__file__).parents[1] / "tests" / "golden" / "gear-24.3b"


def measured(blocks):
    """Return seconds, megabytes and totals of one run in a process of its own."""
    records = [line for line in GOLDEN.read_text().splitlines() if line.startswith("B")]
    whole = (records * (blocks // len(records) + 1))[:blocks]
    with tempfile.TemporaryDirectory() as folder:
        name = Path(folder, "long.3b")
        name.write_text("\n".join(whole) + "\nDD\n")
        command = [sys.executable, "-m", "wedmcam", "verify", str(name), "--json", "--quiet"]
        start = time.perf_counter()
        told = subprocess.run(command, check=True, capture_output=True).stdout
        spent = time.perf_counter() - start
        size = name.stat().st_size
    total = json.loads(told)
    return {
        "blocks": total["blocks"],
        "steps": total["steps"],
        "file_mb": round(size / 1e6, 1),
        "s": round(spent, 2),
        "mb": round(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=1_000_000)
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    row = measured(asked.blocks)
    if asked.json:
        print(json.dumps(row))
    else:
        print("{blocks} blocks, {steps} steps, {file_mb} MB: {s} s, {mb} MB".format(**row))


if __name__ == "__main__":
    main()

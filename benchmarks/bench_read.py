"""Reading speed of program texts: 3B with a record a line and run together, and ISO G-code.

The blocks are those of a golden program over and over; the whole reader is measured, findings and
places included, in time of the processor. Run: python benchmarks/bench_read.py [--blocks 200000]
[--json]
"""

import argparse
import json
import time
from pathlib import Path

from wedmcam import conversion
from wedmcam.frontends import decoder
from wedmcam.machines import default

GOLDEN = Path(__file__).parents[1] / "tests" / "golden" / "gear-24.3b"
#: What is read, and how many records or lines a second are wanted of it: at least, target.
WANTED = {
    "3B, a record a line": (200_000, 500_000),
    "3B, records run together": (200_000, 500_000),
    "3B, blanks and N numbers": (200_000, 500_000),
    "G-code, increments in um": (100_000, 100_000),
}


def texts(blocks):
    """Return name -> (format, text) of so many blocks."""
    records = [line for line in GOLDEN.read_text().splitlines() if line.startswith("B")]
    whole = (records * (blocks // len(records) + 1))[:blocks]
    spaced = (f"N{k}: {r.replace('B', ' B ').replace('G', ' G')}" for k, r in enumerate(whole, 1))
    made = conversion.convert(GOLDEN, to="iso")
    assert made.ok
    moves = [line for line in made.data.decode().splitlines() if line.startswith("G0")]
    code = (moves * (blocks // len(moves) + 1))[:blocks]
    return dict(
        zip(
            WANTED,
            (
                ("3b", "\n".join(whole) + "\nDD\n"),
                ("3b", "".join(whole) + "\nDD\n"),
                ("3b", "\n".join(spaced) + "\nDD\n"),
                ("iso", "G92X0Y0\nG91\n" + "\n".join(code) + "\nM02\n"),
            ),
            strict=True,
        )
    )


def rates(blocks, rounds=3):
    """Return name -> blocks a second, the best of some rounds."""
    found = {}
    for name, (format_, text) in texts(blocks).items():
        data, best = text.encode("ascii"), float("inf")
        for _ in range(rounds):
            start = time.process_time()
            program, said = decoder(format_)(data, default(format_), "long")
            best = min(best, time.process_time() - start)
        assert len(program.blocks) >= blocks, (name, len(program.blocks), said[:3])
        found[name] = blocks / best
    return found


def table(found):
    """Yield the lines of a table."""
    yield "| text | thousand blocks a second |"
    yield "|---|---|"
    for name, rate in found.items():
        yield f"| {name} | {rate / 1e3:.0f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=200_000)
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    found = rates(asked.blocks)
    print(json.dumps(found) if asked.json else "\n".join(table(found)))


if __name__ == "__main__":
    main()

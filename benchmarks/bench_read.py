"""Reading speed of program texts: 3B with a record a line and run together, and ISO G-code.

The blocks are those of a golden program over and over; the whole reader is measured, findings and
places included, in time of the processor. Run: python benchmarks/bench_read.py [--blocks 200000]
[--json]
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from wedmcam.frontends import decoder
from wedmcam.machines import builtin, default
from wedmcam.operations import convert as conversion
from wedmcam.targets.g41 import decode

GOLDEN = Path(__file__).parents[1] / "tests" / "golden" / "gear-24.3b"
#: What the G-code is written and read in: increments, whole um.
UM = builtin("iso-um")
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
    made = conversion.convert(GOLDEN, profile="iso-um")
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
            program, said = decoder(format_)(
                data, default(format_) if format_ != "iso" else UM, "long"
            )
            best = min(best, time.process_time() - start)
        assert len(program.blocks) >= blocks, (name, len(program.blocks), said[:3])
        found[name] = blocks / best
    return found


def part_program(lines):
    """Return a part program of so many lines: plates of lines, arcs and fillets, and their cuts."""
    text, each = [], 16
    plates = lines // (each + 1)
    for k in range(plates):
        x, y = 40 * (k % 12), 40 * (k // 12)
        text += [f"contour c{k} {{", f"  from ({x}, {y})"]
        for j in range(5):
            corner = "" if j % 2 else " fillet 0.3"
            text.append(f"  line to ({x} + {5 * j} + 2.5, {y} + {j % 2} / 10){corner}")
            text.append(f"  line by (2.125, 0.1 * {j} + 0.3)")
        text.append(f"  arc ccw to ({x + 24}, {y} + 10) radius 12")
        text.append(f"  arc tangent to ({x}, {y} + 12)")
        text += ["  close", "}"]
    return "\n".join(text + [f"cut c{k} outside offset 0.1" for k in range(plates)]) + "\n"


def part_seconds(lines=2000, rounds=3):
    """Return what the command takes of the processor for a part program over one contour, in s.

    Each run is a process of its own, as at the shop: start-up is in both.
    """
    one = "contour a { circle center (0, 0) radius 9 } cut a inside offset 0.1"
    best = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("one", one), ("many", part_program(lines))):
            Path(folder, f"{name}.wed").write_text(text, "utf-8")
        for _ in range(rounds):
            for name in ("one", "many"):
                command = [sys.executable, "-m", "wedmcam", "compile", f"{name}.wed", "-q"]
                start = _children()
                subprocess.run([*command, "-o", f"{name}.3b"], cwd=folder, check=True)
                best[name] = min(best.get(name, 1e9), _children() - start)
    return best["many"] - best["one"]


def chords(count=20_000):
    """Return a G-code program of so many chords for a controller that offsets them by 0.1 mm."""
    angle = np.linspace(0.0, 2.0 * np.pi, count + 1)
    radius = 100_000 * (1.0 + 0.2 * np.sin(9 * angle) + 0.02 * np.sin(70 * angle))
    places = np.rint(radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
    places[-1] = places[0]
    steps = np.diff(places, axis=0).astype(int).tolist()
    lines = [f"G01 X{x} Y{y}" for x, y in steps]
    return "\n".join(["G91", "G41 D1 G01 X-2000 Y0", *lines, "G40 G01 X2000 Y0", "M02"])


def offset_seconds(rounds=3):
    """Return what reading such a program takes, with the path that the controller makes, in s."""
    data, best = chords().encode("ascii"), float("inf")
    for _ in range(rounds):
        start = time.process_time()
        program, findings = decode(data, UM, "long", lambda number: 100.0)
        best = min(best, time.process_time() - start)
        assert len(program.blocks) > 20_000, findings[:3]
    return best


def _children():
    """Return the seconds that finished processes of ours have had of the processor."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


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
    part, offset = part_seconds(), offset_seconds()
    if asked.json:
        more = {"part program of 2,000 lines, s": part, "G41 of 20,000 chords, s": offset}
        print(json.dumps({**found, **more}))
        return
    print("\n".join(table(found)))
    print(f"\npart program of 2,000 lines: {part:.2f} s over one of one contour")
    print(f"G41 of 20,000 chords, with the controller's path: {offset:.2f} s")


if __name__ == "__main__":
    main()

"""How many cycles the machine code takes for a step, as rows of the table in docs/zd065.md.

``python tests/firmware/speed.py`` prints them.
"""

import itertools
import tempfile
from pathlib import Path

import numpy as np
from blocks import arc, line
from expected import blocks_of
from machine import Machine, assemble

from wedmcam.formats.compact import CCW, CW, LINE
from wedmcam.ir.program import Kind

GOLDEN = Path(__file__).parents[1] / "golden"
#: Programs, and how many steps of each are timed.
PROGRAMS, STEPS = ("damaged.zd", "gear.wed.zd", "key-punch.zd"), 20_000
#: At 1 MHz [R] a cycle is 1 us, and a step 1 um.
CLOCK = 1_000_000


def small_blocks():
    """Return data of small arcs and short lines: every rare event comes soon."""
    arcs = [arc(g, q, 3, k, 99) for g, q, k in itertools.product([CW, CCW], range(1, 5), range(8))]
    large = [arc(g, q, 300, 40, 999) for g, q in itertools.product([CW, CCW], range(1, 5))]
    lines = [
        line(LINE, q, *end) for q, end in enumerate([(400, 290), (290, 400), (0, 300), (300, 0)], 1)
    ]
    return b"".join(arcs + large + lines) + b"\0"


def near_the_limit():
    """Return data of arcs whose radius has to be squared."""
    starts = [(9_999_999, 1), (7_071_067, 7_071_067), (5_999_999, 7_999_999), (0, 10_000_000)]
    return b"".join(arc(CW, 1, x, y, 9) for x, y in starts) + b"\0"


def timed(image, data, most=None):
    """Return cycles of steps, their blocks' number, whether one is the first, whether of an arc."""
    machine = Machine(image, timed=True)
    machine.load(data)
    machine.run(most)
    record = machine.record()
    is_arc = blocks_of(data)["kind"][record.number - 1] == Kind.ARC
    cycles, first = np.diff(record.cycles), np.diff(record.number) != 0
    return cycles, first, is_arc[1:]


def figures(image):
    """Return a dictionary of what is measured: name -> cycles of all such steps."""
    programs = [timed(image, (GOLDEN / name).read_bytes(), STEPS) for name in PROGRAMS]
    parts = [*programs, timed(image, small_blocks())]
    cycles, first, is_arc = (np.concatenate(column) for column in zip(*parts, strict=True))
    largest, begins, _ = timed(image, near_the_limit())
    of_programs = sum(len(part[0]) for part in programs)
    ordinary = np.arange(len(cycles)) < of_programs
    return {
        "step of a line": (cycles[~first & ~is_arc], cycles[~first & ~is_arc & ordinary]),
        "step of an arc": (cycles[~first & is_arc], cycles[~first & is_arc & ordinary]),
        "first step of a line": (cycles[first & ~is_arc],) * 2,
        "first step of an arc": (cycles[first & is_arc],) * 2,
        "first step of an arc with x or y from 7 m on": (largest[begins],) * 2,
    }


def display_cycles(image):
    """Return the cycles of one interrupt of the display, its return included."""
    machine = Machine(image, timed=True)
    back, before = machine.mpu.pc, machine.mpu.processorCycles
    machine.mpu.irq()
    while machine.mpu.pc != back:
        machine.run(instructions=1)
    return machine.mpu.processorCycles - before


def rows(image):
    """Return the rows of the table: cycles, and steps a second beside the display."""
    free = CLOCK * (1 - display_cycles(image) / (image.names["scan_time"] + 2))
    for name, (every, ordinary) in figures(image).items():
        mean = round(float(ordinary.mean()), 1)
        rate = free / mean
        speed = f"{rate:,.0f} | {rate * 60 / 1000:,.0f}" if "first" not in name else "|"
        yield f"| {name} | {every.min():,} | {mean:,} | {every.max():,} | {speed} |"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        image = assemble(folder)
    print(f"{image.size:,} bytes; a digit of the display: {display_cycles(image)} cycles")
    print("\n".join(rows(image)))

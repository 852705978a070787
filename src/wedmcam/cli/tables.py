"""Tables on standard output: what ``dump`` and ``identify`` print of programs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

from wedmcam import machines
from wedmcam.frontends.identify import Identification
from wedmcam.ir.program import Program
from wedmcam.machines import Machine
from wedmcam.programs.rows import dump


def identification(seen: Identification) -> dict[str, Any]:
    """Return an identification as plain data."""
    return asdict(seen)


def memory_of(seen: Identification) -> str:
    """Return where the data of a binary program end, and how much of the memory they take."""
    if seen.last_address is None or seen.format not in ("compact", "rotation", "compensation"):
        return ""
    used, memory = seen.last_address + 1, machines.default(seen.format).limits.memory_bytes
    return f"; last address {seen.last_address:#06x}, {used} of {memory} bytes"


def dump_rows(program: Program, machine: Machine) -> list[dict[str, Any]]:
    """Return the blocks of a program as plain data."""
    return [asdict(row) for row in dump(program, machine)]


def dump_lines(program: Program, machine: Machine) -> Iterator[str]:
    """Yield the blocks of a program as a table."""
    axes = machine.axes
    if not axes.plain:
        turned = replace(axes, step_um=1.0).text
        yield f"axes: {turned}; Z, X, Y, G and ends are in the axes of the drawing"
    if axes.step_um != 1:
        lengths = "X and Y" if machine.counts_speed else "X, Y and J"
        speed = ", J is the speed" if machine.counts_speed else ""
        yield f"{lengths} are steps of {axes.step_um:g} um{speed}, ends are um"
    yield "block  where    kind   Z          X          Y  G            J      end x      end y"
    for r in dump(program, machine):
        if r.count is None:
            yield f"{r.number:5d}  {r.where:8} {r.kind}"
        else:
            end = f"{r.end[0]:10} {r.end[1]:10}" if r.steps >= 0 else "    never ends"
            yield (
                f"{r.number:5d}  {r.where:8} {r.kind:6} {r.instruction:3} {r.x:10d} {r.y:10d}  "
                f"{r.axis:6} {r.count:7d} {end}"
            )

"""Write the gap-compensation format of the ZD-065."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks
from wedmcam.backends.scaled import outline_of
from wedmcam.backends.zd065.compact import encode as encode_compact
from wedmcam.backends.zd065.memory import Memory
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.formats import compensation
from wedmcam.ir.program import Program
from wedmcam.machines import Machine


def encode(
    program: Program,
    machine: Machine,
    positions: NDArray[np.int64] | None = None,
    *,
    gap_um: int = 0,
    outwards: bool = True,
    grown: NDArray[np.integer[Any]] | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the compensation data that the controller makes this program of.

    Args:
        program: the offset path, blocks as for the cutting format.
        machine: a compensation profile.
        positions: not needed; writers are called alike.
        gap_um: that the operator will enter, whole um.
        outwards: that the operator will choose: True for a punch, False for a die.
        grown: for each block +1 where the offset made the arc's radius larger, -1 smaller; None for
            a gap of 0.

    Returns:
        The bytes, empty when there is an error.
    """
    _, findings = encode_compact(program, machine)
    findings = [d for d in findings if d.code != "over-memory"]
    if has_errors(findings):
        return b"", findings
    checks = Checks(program)
    figure = outline_of(
        program, machine, checks, gap_um, outwards, grown, compensation.MOST_GAP_UM, "compact"
    )
    findings += checks.findings
    if figure is None:
        return b"", findings
    memory = _memory_of(figure)
    return memory.data.tobytes(), [*findings, *memory.too_large(machine)]


def _memory_of(figure: NDArray[np.void]) -> Memory:
    """Return the data of a figure."""
    memory = Memory(figure["kind"], figure["turn"], figure["x"], figure["y"], compensation.LENGTH)
    arc, straight = memory.arc, memory.straight
    types = np.where(figure["grows"] > 0, compensation.GROWS, compensation.SHRINKS).astype(np.uint8)
    memory.data[memory.at[arc] + 1] = types[arc]
    memory.put(arc, 2, 4, figure["radius"])
    memory.put(arc, 6, 4, figure["x"])
    memory.put(arc, 10, 4, figure["y"])
    memory.put(arc, 14, 3, figure["count"])
    memory.put(straight, 1, 3, figure["x"])
    memory.put(straight, 4, 3, figure["y"])
    return memory

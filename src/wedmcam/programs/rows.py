"""The blocks of a program as rows for people: where they stand, what they say, where they end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from wedmcam.diag import ByteSpan, TextSpan
from wedmcam.formats import quadrants
from wedmcam.ir.program import Axis, Kind, Program, in_um
from wedmcam.machines import Machine


@dataclass(frozen=True, slots=True)
class Row:
    """One block.

    Attributes:
        number: 1-based.
        where: address (``0x0012``) or ``line:column`` in the file it was read from; empty for a
            program that was not read.
        kind: `Kind` in lower case, or the word itself for an unknown control word.
        instruction: L1 .. L4, NR1 .. NR4, SR1 .. SR4; empty for control records.
        x: um (steps, as in the file, where a step is not 1 um), signed: direction of a line, start
            of an arc from its centre; None for controls.
        y: likewise.
        axis: X, Y or SQUARE (SQUARE_X with exchanged axes); empty for controls.
        count: J, likewise; None for controls.
        end: where the machine stands after the block, um, from where the program starts.
        steps: how many steps it makes; -1 for a block that no controller can run.
    """

    number: int
    where: str
    kind: str
    instruction: str
    x: int | None
    y: int | None
    axis: str
    count: int | None
    end: tuple[float, float]
    steps: int


def dump(program: Program, machine: Machine) -> Iterator[Row]:
    """Yield a row for each block; ends are what the machine's interpolator makes of them."""
    blocks = program.blocks
    motion = machine.stepping.run(blocks)
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)]) + np.array(program.origin)
    ends = in_um(ends, program.step_um)
    quadrant = quadrants.quadrant(blocks["x"], blocks["y"], blocks["turn"])
    words = dict(program.words)
    for i, block in enumerate(blocks):
        kind, turn = Kind(block["kind"]), int(block["turn"])
        cutting = kind <= Kind.MOVE
        yield Row(
            number=i + 1,
            where=where_of(program, i),
            kind=words.get(i, kind.name.lower()),
            instruction=("L", "NR", "SR")[turn] + str(quadrant[i]) if cutting else "",
            x=int(block["x"]) if cutting else None,
            y=int(block["y"]) if cutting else None,
            axis=Axis(block["axis"]).name if cutting else "",
            count=int(block["count"]) if cutting else None,
            end=(ends[i, 0].item(), ends[i, 1].item()),
            steps=int(motion.steps[i]),
        )


def where_of(program: Program, i: int) -> str:
    """Return where block ``i`` stands in its file: line:column, or an address; empty if nowhere."""
    if i >= len(program.spans):
        return ""
    span = program.spans[i]
    if isinstance(span, TextSpan):
        return f"{span.line}:{span.column}"
    return f"{span.start:#06x}" if isinstance(span, ByteSpan) else str(span)

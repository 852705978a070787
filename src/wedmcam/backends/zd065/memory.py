"""Data in the memory of the ZD-065 while they are written: an instruction and its numbers a block.

The three formats share their instructions and differ in length and numbers (`formats`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, warning
from wedmcam.formats import compact, quadrants
from wedmcam.ir.program import Kind
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Memory:
    """Bytes of a program, all instructions in their places, and the end byte 0x00.

    Attributes:
        arc, straight: which blocks are arcs; which are lines and moves.
        sizes: bytes of each block.
        at: address of each block.
        data: the bytes.
    """

    def __init__(
        self, kind: NDArray[np.uint8], turn: NDArray[np.int8], x: Ints, y: Ints, length: bytes
    ) -> None:
        """Write the instructions.

        Args:
            kind, turn: of the blocks.
            x, y: direction of a line, start of an arc from its centre: they give the quadrant.
            length: bytes of the block that each instruction opens.
        """
        move = kind == Kind.MOVE
        self.arc: Bools = kind == Kind.ARC
        self.straight: Bools = move | (kind == Kind.LINE)
        after_move = np.zeros(len(kind), dtype=bool)
        after_move[1:] = move[:-1]
        thread = (kind == Kind.THREAD) | ((kind == Kind.PAUSE) & after_move)
        base = np.select(
            [self.arc & (turn > 0), self.arc, move, self.straight, thread],
            [compact.CCW, compact.CW, compact.MOVE, compact.LINE, compact.THREAD],
            compact.PAUSE,
        )
        quadrant = quadrants.quadrant(x, y, turn)
        code = (base + np.where(self.arc | self.straight, quadrant, 0)).astype(np.uint8)
        end = (kind == Kind.STOP) | (kind == Kind.END)
        self.sizes: Ints = np.frombuffer(length, dtype=np.uint8)[code].astype(np.int64)
        self.sizes[end] = 0
        self.at: Ints = np.cumsum(self.sizes) - self.sizes
        self.data = np.zeros(int(self.sizes.sum()) + 1, dtype=np.uint8)
        self.data[self.at[~end]] = code[~end]

    def put(self, which: Bools, offset: int, size: int, values: Ints) -> None:
        """Write a number of some blocks as packed BCD, without its sign.

        Args:
            which: the blocks.
            offset: from the instruction of each, bytes.
            size: bytes of the number.
            values: of all blocks.
        """
        place = self.at[which][:, None] + offset + np.arange(size)
        self.data[place] = compact.column_to_bcd(np.abs(values[which]).astype(np.int64), size)

    def too_large(self, machine: Machine) -> list[Diagnostic]:
        """Return a warning where the memory of a machine does not hold the data."""
        most = machine.limits.memory_bytes
        if not most or len(self.data) <= most:
            return []
        return [
            warning(
                "over-memory",
                "{bytes} bytes; the memory of {machine} holds {most}: {loads} loads",
                hint="compile --split cuts it at thread points, a longer contour in the kerf",
                bytes=len(self.data),
                machine=machine.name,
                most=most,
                loads=compact.loads(self.sizes, most),
            )
        ]

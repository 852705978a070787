"""Blocks of a ZD-065 memory image as columns: what the readers of its formats share.

The length of a block follows from its instruction; which lengths, the format says. Bad digits are
collected by address; what they mean is for the reader to say.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity
from wedmcam.formats import compact, quadrants
from wedmcam.formats.listing import in_order, listed
from wedmcam.frontends.zd065.compact import ByteSpans, addresses, after
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def mm(um: float) -> str:
    """Return a length for people.

    >>> mm(1500)
    '1.500 mm'
    """
    return f"{um / 1000:.3f} mm"


class Stream:
    """The complete blocks of a memory image, and what was found about them.

    Attributes:
        starts: address of each block.
        end: address behind the last one.
        codes: instructions.
        named: quadrant in the instruction.
        arc, straight: which blocks are arcs, and which are lines or moves.
        turn: +1 counter-clockwise arc, -1 clockwise, 0 not an arc.
        kind: `Kind` of each block.
        good: blocks without an error so far.
    """

    def __init__(self, data: bytes, lengths: bytes, file: str) -> None:
        self.data, self.lengths, self.file = data, lengths, file
        self.starts, self.end = addresses(data, lengths)
        self._raw = np.frombuffer(data, dtype=np.uint8)
        self.codes = self._raw[self.starts].astype(np.int64)
        self.group, self.named = self.codes & 0xF0, self.codes & 0x0F
        self.arc: Bools = (self.group == compact.CW) | (self.group == compact.CCW)
        move = self.group == compact.MOVE
        self.straight: Bools = move | (self.group == compact.LINE)
        self.turn = np.select([self.group == compact.CCW, self.group == compact.CW], [1, -1], 0)
        after_move = np.zeros(len(self.starts), dtype=bool)
        after_move[1:] = move[:-1]
        thread = self.codes == compact.THREAD
        pause = (self.codes == compact.PAUSE) | (thread & after_move)
        self.kind = np.select(
            [self.arc, move, self.straight, pause],
            [Kind.ARC, Kind.MOVE, Kind.LINE, Kind.PAUSE],
            Kind.THREAD,
        )
        table = np.frombuffer(lengths, dtype=np.uint8)
        self.sizes: Ints = table[self.codes].astype(np.int64)
        self.spans = ByteSpans(file, self.starts, self.starts + self.sizes)
        self.good: Bools = np.ones(len(self.starts), dtype=bool)
        self.bad_at: Ints = np.full(len(self.starts), -1, dtype=np.int64)
        self.found: list[tuple[int, Diagnostic]] = []

    def column(self, which: Bools, at: int, size: int) -> Ints:
        """Return the number at byte ``at`` of the chosen blocks, 0 for the others."""
        out: Ints = np.zeros(len(self.starts), dtype=np.int64)
        begin = self.starts[which] + at
        out[which], bad = compact.column_from_bcd(self._raw[begin[:, None] + np.arange(size)])
        seen = self.bad_at[which]
        self.bad_at[which] = np.where((bad >= 0) & (seen < 0), begin + bad, seen)
        return out

    def bytes_at(self, which: Bools, at: int) -> Ints:
        """Return the byte ``at`` of the chosen blocks, 0 for the others."""
        out: Ints = np.zeros(len(self.starts), dtype=np.int64)
        out[which] = self._raw[self.starts[which] + at]
        return out

    def tell(
        self,
        severity: Severity,
        code: str,
        mask: Bools,
        message: Callable[[int], str],
        hint: str | None = None,
    ) -> None:
        """Report blocks that have no error yet."""
        where = np.flatnonzero(mask & self.good)
        for i, d in listed(
            severity,
            code,
            where,
            self.spans.__getitem__,
            lambda i: f"block {i + 1}: {message(i)}",
            hint,
        ):
            self.found.append((int(self.starts[i]), d))
        if severity is Severity.ERROR:
            self.good[where] = False

    def tell_digits(self) -> None:
        """Report bytes that are no packed BCD."""
        self.tell(
            Severity.ERROR,
            "bad-digit",
            self.bad_at >= 0,
            lambda i: (
                f"byte {self._raw[self.bad_at[i]]:#04x} at {self.bad_at[i]:#06x} is no packed BCD"
            ),
        )

    def tell_quadrants(self, x: Ints, y: Ints) -> None:
        """Compare the quadrants named with those of (x, y); repair neighbours, report opposites."""
        moving = self.arc | self.straight
        right = quadrants.quadrant(x, y, self.turn)
        off = (right - self.named) % 4
        self.tell(
            Severity.ERROR,
            "quadrant-contradicts",
            moving & (off == 2),
            lambda i: (
                f"instruction {self.codes[i]:#04x}, but the angle lies in quadrant {right[i]}"
            ),
        )
        self.tell(
            Severity.WARNING,
            "quadrant-repaired",
            moving & (off % 2 == 1),
            lambda i: (
                f"instruction {self.codes[i]:#04x} read as {self.group[i] + right[i]:#04x}, "
                "the quadrant that it enters"
            ),
        )

    def tell_blocks(self, x: Ints, y: Ints, count: Ints, machine: Machine) -> None:
        """Report cutting blocks that no controller runs: over a limit, without a step, endless."""
        limits = machine.limits
        r2 = x * x + y * y
        longer = np.maximum(abs(x), abs(y))
        err = Severity.ERROR
        self.tell(
            err,
            "over-limit",
            self.arc & (r2 > limits.arc_um**2),
            lambda i: (
                f"the radius is {mm(float(np.sqrt(r2[i])))}, the largest is {mm(limits.arc_um)}"
            ),
        )
        most = np.where(self.arc, limits.count_um, limits.line_um)
        value = np.where(self.arc, count, longer)
        self.tell(
            err,
            "over-limit",
            (self.arc | self.straight) & (value > most),
            lambda i: f"J is {mm(int(value[i]))}, the largest is {mm(int(most[i]))}",
        )
        self.tell(
            err, "zero-count", (self.arc | self.straight) & (value == 0), lambda i: "it has no step"
        )
        self.tell(
            err,
            "arc-too-small",
            self.arc & (r2 < 2),
            lambda i: "the arc starts next to its centre and never ends",
        )
        self.tell(
            Severity.WARNING,
            "more-than-a-turn",
            self.arc & (count > compact.largest_turn(x, y)),
            lambda i: f"J is {mm(int(count[i]))}, more than a full circle has",
        )

    def finish(
        self, blocks: NDArray[np.void], machine: Machine
    ) -> tuple[Program, list[Diagnostic]]:
        """Return the program of the good blocks, the end byte as a stop, and all findings."""
        data, end = self.data, self.end
        starts, sizes, good = self.starts, self.sizes, self.good
        if end < len(data) and data[end] == compact.END:
            stop = np.zeros(1, dtype=blocks.dtype)
            stop["kind"], stop["source"] = Kind.STOP, -1
            blocks = np.concatenate([blocks, stop])
            good = np.append(good, True)
            starts, sizes = np.append(starts, end), np.append(sizes, 1)
        ending = after(data, end, len(self.starts), machine, self.file, self.sizes, self.lengths)
        found = [*self.found, *((end, d) for d in ending)]
        spans = ByteSpans(self.file, starts[good], (starts + sizes)[good])
        return Program(blocks[good], spans=spans), in_order(found)

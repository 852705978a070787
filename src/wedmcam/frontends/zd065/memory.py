"""Blocks of a ZD-065 memory image as columns: what the readers of its formats share.

The length of a block follows from its instruction, so a byte that is none ends the reading: what
comes after cannot be told apart. Which lengths, the format says. Bad digits are collected by
address; what they mean is for the reader to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import ByteSpan, Diagnostic, FileSpan, Severity, Span, error, warning
from wedmcam.formats import compact, quadrants
from wedmcam.formats.lengths import to_mm
from wedmcam.formats.listing import Values, in_order, listed
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class ByteSpans(Sequence[Span]):
    """Where each block stands in a binary program: a `ByteSpan` when asked for."""

    def __init__(self, file: str, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> None:
        self._file = file
        self._starts = starts
        self._ends = ends

    def __len__(self) -> int:
        return len(self._starts)

    @overload
    def __getitem__(self, index: int) -> Span: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Span, ...]: ...
    def __getitem__(self, index: int | slice) -> Span | tuple[Span, ...]:
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        return ByteSpan(self._file, int(self._starts[index]), int(self._ends[index]))


def addresses(data: bytes, length: bytes = compact.LENGTH) -> tuple[NDArray[np.int64], int]:
    """Return where each complete block starts, and the address behind the last one.

    ``length`` gives the bytes of the block that each instruction opens, 0 for none.

    The search stops at the end byte, at a byte that is no instruction, in front of a block that
    the data cut short, or at the end of the data.

    >>> starts, end = addresses(bytes.fromhex("01017000005000") + bytes.fromhex("30 00 00"))
    >>> starts.tolist(), end
    ([0, 7], 8)
    """
    starts: list[int] = []
    at, size = 0, len(data)
    while at < size and (step := length[data[at]]):
        if at + step > size:
            break
        starts.append(at)
        at += step
    return np.array(starts, dtype=np.int64), at


class Stream:
    """The complete blocks of a memory image, and findings about them.

    Attributes:
        starts: address of each block.
        end: address behind the last one.
        codes: instructions.
        named: quadrant in the instruction.
        arc, straight: which blocks are arcs, and which are lines or moves.
        turn: +1 counter-clockwise arc, -1 clockwise, 0 not an arc.
        kind: `Kind` of each block. after_move: which stand behind a move.
        good: blocks without an error so far.
        mm: gives a length in steps of the machine in mm.
    """

    def __init__(self, data: bytes, lengths: bytes, file: str, machine: Machine) -> None:
        self.machine, self.mm = machine, to_mm(machine.axes.step_um)
        self.data, self.lengths, self.file = data, lengths, file
        self.starts, self.end = addresses(data, lengths)
        self._raw = np.frombuffer(data, dtype=np.uint8)
        self.codes = self._raw[self.starts].astype(np.int64)
        self.group, self.named = self.codes & 0xF0, self.codes & 0x0F
        self.arc: Bools = (self.group == compact.CW) | (self.group == compact.CCW)
        move = self.group == compact.MOVE
        self.straight: Bools = move | (self.group == compact.LINE)
        self.turn = np.select([self.group == compact.CCW, self.group == compact.CW], [1, -1], 0)
        self.after_move: Bools = np.zeros(len(self.starts), dtype=bool)
        self.after_move[1:] = move[:-1]
        thread = self.codes == compact.THREAD
        pause = (self.codes == compact.PAUSE) | (thread & self.after_move)
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
        self.findings: list[tuple[int, Diagnostic]] = []

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
        template: str,
        values: Values | None = None,
        hint: str | None = None,
    ) -> None:
        """Report blocks that have no error yet; ``{block}`` is the number of the block, from 1."""
        where = np.flatnonzero(mask & self.good)

        def of_block(i: int) -> dict[str, object]:
            return {"block": i + 1, **(values(i) if values is not None else {})}

        for i, d in listed(severity, code, where, self.spans.__getitem__, template, of_block, hint):
            self.findings.append((int(self.starts[i]), d))
        if severity is Severity.ERROR:
            self.good[where] = False

    def tell_digits(self) -> None:
        """Report bytes that are no packed BCD."""
        self.tell(
            Severity.ERROR,
            "bad-digit",
            self.bad_at >= 0,
            "block {block}: byte {byte:#04x} at {address:#06x} is no packed BCD",
            lambda i: {"byte": int(self._raw[self.bad_at[i]]), "address": int(self.bad_at[i])},
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
            "block {block}: instruction {instruction:#04x}, but the angle lies in quadrant "
            "{quadrant}",
            lambda i: {"instruction": int(self.codes[i]), "quadrant": int(right[i])},
        )
        self.tell_repaired(Severity.WARNING, moving & (off % 2 == 1), right)

    def tell_repaired(self, severity: Severity, mask: Bools, right: Ints) -> None:
        """Report instructions that are read as the one of the quadrant ``right``."""
        self.tell(
            severity,
            "quadrant-repaired",
            mask,
            "block {block}: instruction {instruction:#04x} read as {repaired:#04x}, the quadrant "
            "that it enters",
            lambda i: {
                "instruction": int(self.codes[i]),
                "repaired": int(self.group[i] + right[i]),
            },
        )

    def tell_radius(self, x: Ints, y: Ints) -> None:
        """Report arcs over the largest radius of the controller."""
        most_um, mm = self.machine.limits.arc_um, self.mm
        r2 = x * x + y * y
        self.tell(
            Severity.ERROR,
            "over-limit",
            self.arc & (r2 > most_um**2),
            "block {block}: the radius is {radius_mm:.3f} mm, the largest is {most_mm:.3f} mm",
            lambda i: {"radius_mm": mm(float(np.sqrt(r2[i]))), "most_mm": mm(most_um)},
        )

    def tell_blocks(self, x: Ints, y: Ints, count: Ints) -> None:
        """Report cutting blocks that no controller runs: over a limit, without a step, endless."""
        limits, mm = self.machine.limits, self.mm
        cutting = self.arc | self.straight
        self.tell_radius(x, y)
        most = np.where(self.arc, limits.count_um, limits.line_um)
        value = np.where(self.arc, count, np.maximum(abs(x), abs(y)))
        self.tell(
            Severity.ERROR,
            "over-limit",
            cutting & (value > most),
            "block {block}: J is {count_mm:.3f} mm, the largest is {most_mm:.3f} mm",
            lambda i: {"count_mm": mm(value[i]), "most_mm": mm(most[i])},
        )
        self.tell(
            Severity.ERROR,
            "zero-count",
            cutting & (value == 0),
            "block {block}: it has no step",
        )
        self.tell(
            Severity.ERROR,
            "arc-too-small",
            self.arc & (x * x + y * y < 2),
            "block {block}: the arc starts next to its centre and never ends",
        )
        self.tell(
            Severity.WARNING,
            "more-than-a-turn",
            self.arc & (count > compact.largest_turn(x, y)),
            "block {block}: J is {count_mm:.3f} mm, more than a full circle has",
            lambda i: {"count_mm": mm(count[i])},
        )

    def finish(self, blocks: NDArray[np.void]) -> tuple[Program, list[Diagnostic]]:
        """Return the program of the good blocks, the end byte as a stop, and all findings."""
        starts, sizes, good = self.starts, self.sizes, self.good
        if self._ended:
            stop = np.zeros(1, dtype=blocks.dtype)
            stop["kind"], stop["source"] = Kind.STOP, -1
            blocks = np.concatenate([blocks, stop])
            good = np.append(good, True)
            starts, sizes = np.append(starts, self.end), np.append(sizes, 1)
        findings = [*self.findings, *((self.end, d) for d in self._check_end())]
        # A sequence that makes spans when asked for: a tuple of a million would cost seconds.
        spans = ByteSpans(self.file, starts[good], (starts + sizes)[good])
        return Program(blocks[good], spans=spans), in_order(findings)

    @property
    def _ended(self) -> bool:
        """Whether the end byte stands behind the last block."""
        return self.end < len(self.data) and self.data[self.end] == compact.END

    def _check_end(self) -> list[Diagnostic]:
        """Return findings about the end of the data, and about a file without blocks."""
        data, end, blocks = self.data, self.end, len(self.starts)
        findings = [self._check_rest()] if blocks or end < len(data) else []
        if not blocks and (end >= len(data) or self._ended):
            findings.append(error("no-blocks", "no block in this file", FileSpan(self.file)))
        memory = self.machine.limits.memory_bytes
        if memory and end + 1 > memory:
            findings.append(
                warning(
                    "over-memory",
                    "{bytes} bytes; the memory holds {most}: {loads} loads",
                    FileSpan(self.file),
                    bytes=end + 1,
                    most=memory,
                    loads=compact.loads(self.sizes, memory),
                )
            )
        return [d for d in findings if d is not None]

    def _check_rest(self) -> Diagnostic | None:
        """Return a finding about what stands behind the last block, where it is no end byte."""
        data, end, blocks = self.data, self.end, len(self.starts)
        if end >= len(data):
            return warning(
                "no-end",
                "the data stop behind block {block} without an end byte 0x00",
                ByteSpan(self.file, max(end - 1, 0), end),
                block=blocks,
            )
        if data[end] == compact.END:
            rest = data[end + 1 :].rstrip(b"\0")
            if not rest:
                return None
            first = end + 1 + len(rest) - len(rest.lstrip(b"\0"))
            return warning(
                "after-end",
                "{bytes} bytes stand after the end byte at {address:#06x}; they are not read",
                ByteSpan(self.file, first, end + 1 + len(rest)),
                bytes=len(data[first:].rstrip(bytes(1))),
                address=end,
            )
        if length := self.lengths[data[end]]:
            return error(
                "truncated",
                "the data end in block {block}, after {present} of {length} bytes",
                ByteSpan(self.file, end, len(data)),
                block=blocks + 1,
                present=len(data) - end,
                length=length,
            )
        return error(
            "bad-instruction",
            "byte {byte:#04x} at {address:#06x} is no instruction; {bytes} bytes from there on are "
            "not read",
            ByteSpan(self.file, end, end + 1),
            hint="`wedmcam identify` tells the formats apart",
            byte=data[end],
            address=end,
            bytes=len(data) - end,
        )

"""Read the compact cutting format of the ZD-065.

The length of a block follows from its instruction, so a byte that is none ends the reading: what
comes after cannot be told apart. Bad digits do not: all of them are reported. The controller's own
repair (编程错误处理) is done and reported: on an axis the neighbouring quadrant becomes the one
that the block enters.

The neutral program has a pause before and after each move, as 3B needs. Here the pause behind a
move is its thread point, 0x30, where the return after a wire break ends; a 0x30 elsewhere is a
`Kind.THREAD` of its own. The end byte becomes a final `Kind.STOP`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import ByteSpan, Diagnostic, FileSpan, Severity, Span, error, warning
from wedmcam.formats import compact, quadrants
from wedmcam.formats.lengths import mm_of
from wedmcam.formats.listing import in_order, listed
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.machines import Machine


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


def decode(data: bytes, machine: Machine, file: str) -> tuple[Program, list[Diagnostic]]:
    """Return the program that compact data state, and what was found on the way.

    Args:
        data: any bytes; never raises.
        machine: a compact profile: its limits.
        file: name for the spans.

    Returns:
        One block each, arcs counted on `Axis.SQUARE`, lines on the axis and with the J that the
        controller derives. Blocks in error are left out. ``spans[i]`` is a `ByteSpan`.
    """
    starts, end = addresses(data)
    mm = mm_of(machine.axes.step_um)
    raw = np.frombuffer(data, dtype=np.uint8)
    codes = raw[starts].astype(np.int64)
    group, named = codes & 0xF0, codes & 0x0F
    arc = (group == compact.CW) | (group == compact.CCW)
    move = group == compact.MOVE
    straight = move | (group == compact.LINE)
    sizes = np.frombuffer(compact.LENGTH, dtype=np.uint8)[codes].astype(np.int64)
    spans = ByteSpans(file, starts, starts + sizes)

    xs, ys, count = (np.zeros(len(starts), dtype=np.int64) for _ in range(3))
    bad_at = np.full(len(starts), -1)  # address of the first byte that is no BCD

    def column(which: NDArray[np.bool_], at: int, size: int, into: NDArray[np.int64]) -> None:
        begin = starts[which] + at
        into[which], bad = compact.column_from_bcd(raw[begin[:, None] + np.arange(size)])
        bad_at[which] = np.where((bad >= 0) & (bad_at[which] < 0), begin + bad, bad_at[which])

    column(arc, 1, 4, xs)
    column(arc, 5, 4, ys)
    column(arc, 9, 3, count)
    column(straight, 1, 3, xs)
    column(straight, 4, 3, ys)
    x, y = quadrants.signed(xs, ys, np.where(arc | straight, named, 0))
    axis, longer = compact.line_count(xs, ys)
    turn = np.select([group == compact.CCW, group == compact.CW], [1, -1])

    found: list[tuple[int, Diagnostic]] = []
    good = np.ones(len(starts), dtype=bool)

    def tell(
        severity: Severity, code: str, mask: NDArray[np.bool_], message: Callable[[int], str]
    ) -> None:
        # Each block is told once what is wrong with it, and no more after an error.
        where = np.flatnonzero(mask & good)
        for i, d in listed(severity, code, where, spans.__getitem__, message):
            found.append((int(starts[i]), d))
        if severity is Severity.ERROR:
            good[where] = False

    limits = machine.limits
    radius = np.hypot(xs, ys)
    err = Severity.ERROR
    tell(
        err,
        "bad-digit",
        bad_at >= 0,
        lambda i: f"block {i + 1}: byte {raw[bad_at[i]]:#04x} at {bad_at[i]:#06x} is no packed BCD",
    )
    tell(
        err,
        "over-limit",
        arc & (xs * xs + ys * ys > limits.arc_um**2),
        lambda i: (
            f"block {i + 1}: the radius is {mm(radius[i])}, the largest is {mm(limits.arc_um)}"
        ),
    )
    tell(
        err,
        "over-limit",
        np.where(arc, count > limits.count_um, longer > limits.line_um),
        lambda i: (
            f"block {i + 1}: "
            + (
                f"J is {mm(int(count[i]))}, the largest is {mm(limits.count_um)}"
                if arc[i]
                else f"a line of {mm(int(longer[i]))}, the largest is {mm(limits.line_um)}"
            )
        ),
    )
    tell(err, "zero-count", arc & (count == 0), lambda i: f"block {i + 1}: J of the arc is 0")
    tell(
        err,
        "zero-count",
        straight & (longer == 0),
        lambda i: f"block {i + 1}: a line of length 0",
    )
    tell(
        err,
        "arc-too-small",
        arc & (xs * xs + ys * ys < 2),
        lambda i: (
            f"block {i + 1}: the arc starts {mm(int(xs[i] + ys[i]))} from its centre and never ends"
        ),
    )
    checked = good & (arc | straight)
    right = quadrants.quadrant(x, y, turn)
    for which, severity in ((straight, Severity.WARNING), (arc, Severity.NOTE)):
        tell(
            severity,
            "quadrant-repaired",
            checked & which & (right != named),
            lambda i: (
                f"block {i + 1}: instruction {codes[i]:#04x} read as "
                f"{group[i] + right[i]:#04x}, the quadrant that it enters"
            ),
        )
    tell(
        Severity.WARNING,
        "more-than-a-turn",
        arc & (count > compact.largest_turn(xs, ys)),
        lambda i: (
            f"block {i + 1}: J is {mm(int(count[i]))}; a full circle counts about "
            f"{mm(round(4 * 2**0.5 * float(radius[i])))}"
        ),
    )
    after_move = np.zeros(len(starts), dtype=bool)
    after_move[1:] = move[:-1]
    pause = codes == compact.PAUSE
    tell(
        Severity.NOTE,
        "thread-mark",
        pause & after_move,
        lambda i: f"block {i + 1}: the pause behind a move is read as its thread point",
    )

    has_end = end < len(data) and data[end] == compact.END
    blocks = np.zeros(len(starts) + has_end, dtype=BLOCK)
    blocks["source"] = -1
    body = blocks[: len(starts)]
    thread = codes == compact.THREAD
    body["kind"] = np.select(
        [arc, move, straight, pause | (thread & after_move)],
        [Kind.ARC, Kind.MOVE, Kind.LINE, Kind.PAUSE],
        Kind.THREAD,
    )
    body["turn"] = turn
    body["axis"] = np.where(arc, Axis.SQUARE, np.where(straight, axis, 0))
    body["x"], body["y"] = x, y
    body["count"] = np.where(arc, count, longer)
    if has_end:
        blocks["kind"][-1] = Kind.STOP
        good = np.append(good, True)
        starts = np.append(starts, end)
        sizes = np.append(sizes, 1)

    found += [(end, d) for d in after(data, end, len(body), machine, file, sizes)]
    starts, sizes = starts[good], sizes[good]
    kept = ByteSpans(file, starts, starts + sizes)
    # A sequence that makes spans when asked for: a tuple of a million would cost seconds.
    return Program(blocks[good], spans=kept), in_order(found)


def after(
    data: bytes,
    end: int,
    blocks: int,
    machine: Machine,
    file: str,
    sizes: NDArray[np.int64],
    lengths: bytes = compact.LENGTH,
) -> list[Diagnostic]:
    """Return what is to be said about the end of the data, ``end`` behind the last block."""
    found: list[Diagnostic] = []
    rest = data[end + 1 :].rstrip(b"\0")
    if end >= len(data):
        if blocks:
            text = f"the data stop behind block {blocks} without an end byte 0x00"
            found.append(warning("no-end", text, ByteSpan(file, max(end - 1, 0), end)))
    elif data[end] == compact.END:
        if rest:
            first = end + 1 + len(rest) - len(rest.lstrip(b"\0"))
            text = (
                f"{len(data[first:].rstrip(bytes(1)))} bytes stand after the end byte at "
                f"{end:#06x}; they are not read"
            )
            found.append(warning("after-end", text, ByteSpan(file, first, end + 1 + len(rest))))
    elif length := lengths[data[end]]:
        text = f"the data end in block {blocks + 1}, after {len(data) - end} of {length} bytes"
        found.append(error("truncated", text, ByteSpan(file, end, len(data))))
    else:
        text = (
            f"byte {data[end]:#04x} at {end:#06x} is no instruction; "
            f"{len(data) - end} bytes from there on are not read"
        )
        hint = "`wedmcam identify` tells the formats apart"
        found.append(error("bad-instruction", text, ByteSpan(file, end, end + 1), hint=hint))
    if not blocks and (end >= len(data) or data[end] == compact.END):
        found.append(error("no-blocks", "no block in this file", FileSpan(file)))
    memory = machine.limits.memory_bytes
    if memory and end + 1 > memory:
        found.append(
            warning(
                "over-memory",
                f"{end + 1} bytes; the memory holds {memory}: "
                f"{compact.loads(sizes[:blocks], memory)} loads",
                FileSpan(file),
            )
        )
    return found

"""Read the compact cutting format of the ZD-065.

Bad digits do not end the reading: all of them are reported. The controller's own repair
(编程错误处理) is done and reported: on an axis the neighbouring quadrant becomes the one that the
block enters.

The neutral program has a pause before and after each move, as 3B needs. Here the pause behind a
move is its thread point, 0x30, where the return after a wire break ends; a 0x30 elsewhere is a
`Kind.THREAD` of its own. The end byte becomes a final `Kind.STOP`.
"""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic, Severity
from wedmcam.formats import compact, quadrants
from wedmcam.frontends.zd065.memory import Bools, Ints, Stream
from wedmcam.ir.program import BLOCK, Axis, Program
from wedmcam.machines import Machine


def decode(data: bytes, machine: Machine, file: str) -> tuple[Program, list[Diagnostic]]:
    """Return the program that compact data state, and findings.

    Args:
        data: any bytes; never raises.
        machine: a compact profile: its limits.
        file: name for the spans.

    Returns:
        One block each, arcs counted on `Axis.SQUARE`, lines on the axis and with the J that the
        controller derives. Blocks in error are left out. ``spans[i]`` is a `ByteSpan`.
    """
    s = Stream(data, compact.LENGTH, file, machine)
    xs = s.column(s.arc, 1, 4) + s.column(s.straight, 1, 3)
    ys = s.column(s.arc, 5, 4) + s.column(s.straight, 4, 3)
    count = s.column(s.arc, 9, 3)
    axis, longer = compact.line_count(xs, ys)
    x, y = quadrants.signed(xs, ys, np.where(s.arc | s.straight, s.named, 0))

    s.tell_digits()
    _tell_limits(s, xs, ys, count, longer)
    right, checked = quadrants.quadrant(x, y, s.turn), s.good.copy()
    s.tell_repaired(Severity.WARNING, checked & s.straight & (right != s.named), right)
    s.tell_repaired(Severity.NOTE, checked & s.arc & (right != s.named), right)
    _tell_turns(s, xs, ys, count)
    s.tell(
        Severity.NOTE,
        "thread-mark",
        (s.codes == compact.PAUSE) & s.after_move,
        "block {block}: the pause behind a move is read as its thread point",
    )

    blocks = np.zeros(len(s.starts), dtype=BLOCK)
    blocks["source"] = -1
    blocks["kind"], blocks["turn"] = s.kind, s.turn
    blocks["axis"] = np.where(s.arc, Axis.SQUARE, np.where(s.straight, axis, 0))
    blocks["x"], blocks["y"] = x, y
    blocks["count"] = np.where(s.arc, count, longer)
    return s.finish(blocks)


def _tell_limits(s: Stream, xs: Ints, ys: Ints, count: Ints, longer: Ints) -> None:
    """Refuse blocks over the limits of the controller, without a step, and without an end."""
    limits, mm = s.machine.limits, s.mm
    s.tell_radius(xs, ys)
    s.tell(
        Severity.ERROR,
        "over-limit",
        s.arc & (count > limits.count_um),
        "block {block}: J is {count_mm:.3f} mm, the largest is {most_mm:.3f} mm",
        lambda i: {"count_mm": mm(count[i]), "most_mm": mm(limits.count_um)},
    )
    s.tell(
        Severity.ERROR,
        "over-limit",
        ~s.arc & (longer > limits.line_um),
        "block {block}: a line of {length_mm:.3f} mm, the largest is {most_mm:.3f} mm",
        lambda i: {"length_mm": mm(longer[i]), "most_mm": mm(limits.line_um)},
    )
    s.tell(Severity.ERROR, "zero-count", s.arc & (count == 0), "block {block}: J of the arc is 0")
    s.tell(
        Severity.ERROR,
        "zero-count",
        s.straight & (longer == 0),
        "block {block}: a line of length 0",
    )
    s.tell(
        Severity.ERROR,
        "arc-too-small",
        s.arc & (xs * xs + ys * ys < 2),
        "block {block}: the arc starts {start_mm:.3f} mm from its centre and never ends",
        lambda i: {"start_mm": mm(xs[i] + ys[i])},
    )


def _tell_turns(s: Stream, xs: Ints, ys: Ints, count: Ints) -> None:
    """Warn of arcs of more than a turn: a full circle counts about 4 sqrt(2) R."""
    over: Bools = s.arc & (count > compact.largest_turn(xs, ys))
    s.tell(
        Severity.WARNING,
        "more-than-a-turn",
        over,
        "block {block}: J is {count_mm:.3f} mm; a full circle counts about {turn_mm:.3f} mm",
        lambda i: {
            "count_mm": s.mm(count[i]),
            "turn_mm": s.mm(round(4 * 2**0.5 * float(np.hypot(xs[i], ys[i])))),
        },
    )

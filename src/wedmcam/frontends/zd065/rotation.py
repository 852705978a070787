"""Read the rotation format of the ZD-065.

`read` returns the polar blocks as they stand there, `decode` the cutting program that the
controller's data processing makes of them with a number of copies: that is what would be cut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import POLAR, cutting_blocks, displacements
from wedmcam.controllers.zd065.rotation import rotate, rotate_closed
from wedmcam.diag import Diagnostic, FileSpan, Severity, note, warning
from wedmcam.formats import compact, rotation
from wedmcam.formats.lengths import mm_of
from wedmcam.frontends.zd065.memory import Stream
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

#: Arcs of a larger radius are refused, um.
MOST_RADIUS_UM = 10_000_000
#: Largest J of a block, um [S].
MOST_COUNT = 999_999
#: Copies that come this near to a whole number of turns are meant to come round, degrees.
ROUND_DEG = 0.5
#: And then end within this of where they began, um: the rest is rounding.
CLOSES_UM = 0.3


def read(data: bytes, machine: Machine, file: str) -> tuple[NDArray[np.void], list[Diagnostic]]:
    """Return the polar blocks of rotation data (dtype `POLAR`), and findings.

    Blocks in error are left out. Never raises.
    """
    stream, figure = _fields(data, file, machine)
    stream.tell_digits()
    _check(stream, figure)
    _, findings = stream.finish(rotate(_safe(figure, stream)))
    return figure[stream.good], findings


def decode(
    data: bytes,
    machine: Machine,
    file: str,
    copies: int = 0,
    step: float = 0.0,
    lead_in: tuple[int, int] | None = None,
    lead_out: tuple[int, int] | None = None,
    open_loop: bool = False,
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that the controller makes of rotation data.

    Args:
        data: any bytes; never raises.
        machine: its limits.
        file: name for the spans.
        copies: of the figure, 0 to 99 [S].
        step: degrees between copies.
        lead_in: line that the operator enters before the figure, um; None for none.
        lead_out: likewise, behind the last copy.
        open_loop: each block by itself, literally.
    """
    stream, figure = _fields(data, file, machine)
    stream.tell_digits()
    _check(stream, figure)
    stated = rotate(_safe(figure, stream))
    x, y, count = stated["x"], stated["y"], stated["count"]
    # An arc over the limit of J is one that the closed loop cuts in pieces.
    stream.tell_blocks(x, y, count if open_loop else np.minimum(count, MOST_COUNT))
    stream.tell_quadrants(x, y)
    literal, findings = stream.finish(stated)
    kept = figure[stream.good]
    blocks, split = _process(kept, copies, step, open_loop)
    findings += _split(split % max(len(kept), 1), literal, np.flatnonzero(stream.good))
    # Each block where its figure states it; the end byte, the leads, where there is none.
    at = blocks["source"] % max(len(kept), 1)
    blocks["source"] = -1
    spans = [*(literal.spans[i] for i in at.tolist()), *literal.spans[len(kept) :]]
    program = Program(np.concatenate([blocks, literal.blocks[len(kept) :]]), spans=spans)
    program = with_leads(program, lead_in, lead_out)
    if copies:
        findings += [*_drift(kept, copies, step, file), *_too_large(program, machine, file)]
    return program, findings


def _too_large(program: Program, machine: Machine, file: str) -> list[Diagnostic]:
    """Return a warning where the memory does not hold what the processing makes of a figure."""
    kind, most = program.blocks["kind"], machine.limits.memory_bytes
    sizes = np.select(
        [kind == Kind.ARC, kind <= Kind.MOVE, kind == Kind.STOP],
        [compact.ARC_BYTES, compact.LINE_BYTES, 0],
        1,
    )
    made = int(sizes.sum()) + 1
    if not most or made <= most:
        return []
    return [
        warning(
            "over-memory",
            "the figure and its copies are {bytes} bytes of cutting data; the memory of {machine} "
            "holds {most}: {loads} loads",
            FileSpan(file),
            hint="fewer copies at a time, each load from where the one before ended",
            bytes=made,
            machine=machine.name,
            most=most,
            loads=compact.loads(sizes, most),
        )
    ]


def _process(
    figure: NDArray[np.void], copies: int, step: float, open_loop: bool
) -> tuple[NDArray[np.void], NDArray[np.int64]]:
    """Return the cutting blocks of a figure and its copies, and rows that are several blocks.

    ``source`` counts through all rows.
    """
    if open_loop:
        blocks = rotate(figure, copies, step)
        blocks["source"] = np.arange(len(blocks))
        return blocks, np.zeros(0, dtype=np.int64)
    made = rotate_closed(figure, copies, step)
    return made.blocks.copy(), made.split


def _split(
    rows: NDArray[np.int64], literal: Program, numbers: NDArray[np.int64]
) -> list[Diagnostic]:
    """Return notes at the blocks of a figure that are cut in several, somewhere in the copies."""
    blocks, times = np.unique(rows, return_counts=True)
    return [
        note(
            "blocks-split",
            "block {block}: no one arc with a whole centre ends where it is stated to end: it is "
            "cut in several",
            literal.spans[row],
            block=int(numbers[row]) + 1,
            times=many,
        ).extended(", in {times} of the figures" if many > 1 else "")
        for row, many in zip(blocks.tolist(), times.tolist(), strict=True)
    ]


def _drift(figure: NDArray[np.void], copies: int, step: float, file: str) -> list[Diagnostic]:
    """Return a warning where copies come round, and do not come back to where they began.

    The machine makes each copy as stated; what one figure is off grows to that by 1 / sin(pi / N).
    """
    figures = copies + 1
    over = (figures * step + 180.0) % 360.0 - 180.0
    if abs(over) > ROUND_DEG:
        return []
    way = displacements(figure).sum()
    turns = np.exp(1j * np.radians(step * np.arange(figures)))
    drift = float(abs(way * turns.sum()))
    if drift <= CLOSES_UM:
        return []
    return [
        warning(
            "figure-drift",
            "{figures} figures of {angle_deg:.8g} degrees come round, and end {drift_um:.2f} um "
            "from where they begin",
            FileSpan(file),
            hint="enter 360 degrees / {figures} in full",
            figures=figures,
            angle_deg=step,
            drift_um=drift,
        )
    ]


def with_leads(
    program: Program, lead_in: tuple[int, int] | None, lead_out: tuple[int, int] | None
) -> Program:
    """Return a program with the lines that the operator enters before and behind it."""
    if (lead_in is None and lead_out is None) or not len(program.spans):
        return program
    blocks = program.blocks
    ended = len(blocks) if not len(blocks) or blocks["kind"][-1] != Kind.STOP else len(blocks) - 1
    parts = [_lead(lead_in), blocks[:ended], _lead(lead_out), blocks[ended:]]
    first, last = program.spans[0], program.spans[-1]
    spans = [
        *[first] * len(parts[0]),
        *program.spans[:ended],
        *[last] * len(parts[2]),
        *program.spans[ended:],
    ]
    return Program(np.concatenate(parts), program.origin, program.sources, spans)


def _lead(way: tuple[int, int] | None) -> NDArray[np.void]:
    """Return a cutting block of a line; none where it has no length."""
    rows = [way] if way is not None and way != (0, 0) else []
    xy = np.array(rows, dtype=np.int64).reshape(-1, 2)
    kind = np.full(len(xy), Kind.LINE, dtype=np.uint8)
    none = np.zeros(len(xy), dtype=np.int64)
    return np.asarray(cutting_blocks(kind, none, xy[:, 0], xy[:, 1], none))


def describe_blocks(data: bytes, machine: Machine) -> dict[str, str]:
    """Return what each polar block states, for people, by its address.

    >>> from wedmcam.machines import default
    >>> describe_blocks(bytes.fromhex("01 02 30000000 020000 00"), default("rotation"))
    {'0x0000': 'heading 30 deg, length 20.000 mm'}
    """
    s, figure = _fields(data, "", machine)
    mm = mm_of(machine.axes.step_um)
    text = {}
    for at, arc, straight, row in zip(
        s.starts.tolist(), s.arc.tolist(), s.straight.tolist(), figure, strict=True
    ):
        start, size = f"{float(row['start']):.8g} deg", mm(int(row["size"]))
        if arc:
            text[f"{at:#06x}"] = f"start {start}, R {size}, sweep {float(row['sweep']):.8g} deg"
        elif straight:
            text[f"{at:#06x}"] = f"heading {start}, length {size}"
    return text


def _fields(data: bytes, file: str, machine: Machine) -> tuple[Stream, NDArray[np.void]]:
    s = Stream(data, rotation.LENGTH, file, machine)
    both = s.arc | s.straight
    figure = np.zeros(len(s.starts), dtype=POLAR)
    figure["kind"], figure["turn"] = s.kind, s.turn
    exponent = s.column(both, 1, 1)
    significand = s.column(both, 2, 4)
    figure["start"] = rotation.angle_value(exponent, significand)
    figure["size"] = s.column(s.arc, 6, 4) + s.column(s.straight, 6, 3)
    figure["sweep"] = rotation.angle_value(s.column(s.arc, 10, 1), s.column(s.arc, 11, 4))
    return s, figure


def _check(s: Stream, figure: NDArray[np.void]) -> None:
    start, sweep = figure["start"], figure["sweep"]
    s.tell(
        Severity.ERROR,
        "bad-angle",
        (s.arc | s.straight) & (start >= 360),
        "block {block}: the angle {angle_deg:.6g} degrees is not below 360",
        lambda i: {"angle_deg": float(start[i])},
    )
    # A few steps more than a turn close a small circle.
    room = 360 + 360 / np.maximum(figure["size"], 1)
    s.tell(
        Severity.ERROR,
        "bad-angle",
        s.arc & ((sweep <= 0) | (sweep > room + 1)),
        "block {block}: the arc covers {sweep_deg:.6g} degrees; it must be above 0 and up to 360",
        lambda i: {"sweep_deg": float(sweep[i])},
    )
    s.tell(
        Severity.ERROR,
        "over-limit",
        s.arc & (figure["size"] > MOST_RADIUS_UM),
        "block {block}: the radius is {radius_mm:.3f} mm, the largest is {most_mm:.3f} mm",
        lambda i: {
            "radius_mm": s.mm(figure["size"][i]),
            "most_mm": s.mm(MOST_RADIUS_UM),
        },
    )


def _safe(figure: NDArray[np.void], s: Stream) -> NDArray[np.void]:
    """Return the figure with blocks in error made harmless; they are left out in the end."""
    out = figure.copy()
    bad = ~s.good & (s.arc | s.straight)
    out["kind"][bad] = Kind.LINE
    for name, value in (("turn", 0), ("start", 0.0), ("size", 1), ("sweep", 0.0)):
        out[name][bad] = value
    return out

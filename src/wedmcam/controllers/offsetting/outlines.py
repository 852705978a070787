"""From outlines in a program, with G41 and G42, to the program that the controller runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.offsetting.clearance import comes_near, runs_back
from wedmcam.controllers.offsetting.microns import (
    BlockLimits,
    NoSteps,
    line_blocks,
    on_grid,
    stepped,
)
from wedmcam.controllers.offsetting.path import Lost, path_beside
from wedmcam.controllers.offsetting.segment import Point, Segment, arc, line
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.ir.programmed import Programmed

Ints = NDArray[np.int64]
Blocks = NDArray[np.void]

#: A lead-in that is this much shorter than the offset is as long; um.
LEAD_UM = 1e-6
#: Blocks shorter than this are noise of the units that they were written in; um.
SPECK_UM = 5e-3


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why the controller stops at an outline, or makes no path of it.

    Attributes:
        kind: "lead" (the lead-in is shorter than the offset), "steps" (an arc has no steps within
            what is allowed), or one of `path.Lost`.
        motion: row of `Programmed.motions` at fault.
        at: where, um.
        offset_um: by how much the wire is to run beside it.
        other: the motion before it that it runs back on or comes too near to; -1 for none.
        gap_um: how near the wire comes to that one; of "lead", how long it is.
        radius_um: of "radius".
        last: whether it is the last motion of its outline.
    """

    kind: str
    motion: int
    at: Point
    offset_um: float
    other: int = -1
    gap_um: float = 0.0
    radius_um: float = 0.0
    last: bool = False


def offset_outlines(read: Programmed, limits: BlockLimits) -> tuple[Program | None, list[Refusal]]:
    """Return the program that the controller makes of outlines and offsets.

    Args:
        read: as the reader of the format gives it, um.
        limits: of a block, and the interpolator.

    Returns:
        Every run as the stepped path beside its outline; spans stay those of the file. None and
        refusals where the model does not hold, one for each run.
    """
    if not len(read.motions):
        return read.program, []
    refusals: list[Refusal] = []
    blocks: list[Blocks] = []
    motions: list[Ints] = []
    number = read.motions["run"]
    for run in range(int(number.max()) + 1):
        rows = np.flatnonzero(number == run)
        result = _offset_run(read.motions, rows, limits)
        if isinstance(result, Refusal):
            refusals.append(result)
        else:
            blocks.append(result[0])
            motions.append(result[1])
    if refusals:
        return None, refusals
    return _woven(read, np.concatenate(blocks), np.concatenate(motions)), []


def _offset_run(motions: Blocks, rows: Ints, limits: BlockLimits) -> tuple[Blocks, Ints] | Refusal:
    """Return the blocks of one run, and the motion that each is of."""
    lead, final = motions[rows[0]], motions[rows[-1]]
    shift = float(lead["shift"])
    length = hypot(lead["x1"] - lead["x0"], lead["y1"] - lead["y0"])
    start = float(lead["x0"]), float(lead["y0"])
    if length < abs(shift) - LEAD_UM:
        return Refusal("lead", int(rows[0]), start, abs(shift), gap_um=length)
    outline, of = outline_segments(motions, rows[motions["role"][rows] == Role.CONTOUR])
    shifts = [float(v) for v in motions["shift"][of]]
    lost = runs_back(outline)
    if lost is not None:
        return _refusal(lost, outline, of, shifts)
    result = path_beside(outline, shifts, shift)
    if isinstance(result, Lost):
        return _refusal(result, outline, of, shifts)
    path, closed = result
    lost = comes_near(path, outline, shifts, shift)
    if lost is not None:
        return _refusal(lost, outline, of, shifts)
    x, y = (int(v) for v in on_grid(start))
    steps = stepped(path, closed, (x, y), shift < 0, limits)
    if isinstance(steps, NoSteps):
        return Refusal("steps", int(rows[0]), steps.at, abs(shift))
    blocks, block_of = steps
    motion = np.where(block_of < 0, rows[0], np.array(of)[block_of])
    if final["role"] == Role.LEAD_OUT:
        last = path[0].segment.start if closed else path[-1].segment.end
        (ax, ay), (bx, by) = on_grid(last), on_grid([final["x1"], final["y1"]])
        out = line_blocks(int(bx - ax), int(by - ay), limits)
        blocks = np.concatenate([blocks, out])
        motion = np.concatenate([motion, np.full(len(out), rows[-1])])
    return blocks, motion


def _refusal(
    lost: Lost, outline: Sequence[Segment], of: Sequence[int], shifts: Sequence[float]
) -> Refusal:
    return Refusal(
        lost.kind,
        of[lost.block],
        lost.at,
        abs(shifts[lost.block]),
        of[lost.other] if lost.other >= 0 else -1,
        lost.gap_um,
        outline[lost.block].radius,
        of[lost.block] == of[-1],
    )


def outline_segments(motions: Blocks, rows: Ints) -> tuple[list[Segment], list[int]]:
    """Return the motions of an outline as segments, and the motion that each is of.

    A centre moves to where it is as far from the end as from the start, nearest to where it is
    stated. A full circle among other motions is two halves: start and end of a path may not be one.
    A speck of a motion is none; the one before it ends where the next begins.
    """
    segments: list[Segment] = []
    of: list[int] = []
    for k in rows.tolist():
        m = motions[k]
        start, end = (float(m["x0"]), float(m["y0"])), (float(m["x1"]), float(m["y1"]))
        turn = int(m["turn"])
        if not turn:
            segment = line(start, end)
        else:
            centre = _centre(start, end, (float(m["cx"]), float(m["cy"])))
            segment = arc(start, end, centre, turn)
            if start == end and len(rows) > 1:
                far = 2 * centre[0] - start[0], 2 * centre[1] - start[1]
                segments.append(arc(start, far, centre, turn))
                of.append(k)
                segment = arc(far, end, centre, turn)
        segments.append(segment)
        of.append(k)
    kept = [k for k, s in enumerate(segments) if s.length >= SPECK_UM]
    if not kept or len(kept) == len(segments):
        return segments, of
    whole = []
    for k, following in zip(kept, [*kept[1:], -1], strict=True):
        s = segments[k]
        end = segments[following].start if following >= 0 else segments[-1].end
        whole.append(s if s.end == end else _ending(s, end))
    return whole, [of[k] for k in kept]


def _ending(s: Segment, end: Point) -> Segment:
    """Return a segment with another end."""
    return arc(s.start, end, (s.cx, s.cy), s.turn) if s.turn else line(s.start, end)


def _centre(start: Point, end: Point, stated: Point) -> Point:
    """Return the centre nearest to a stated one that is as far from the end as from the start."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    chord = dx * dx + dy * dy
    if not chord:
        return stated
    mx, my = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
    along = ((stated[0] - mx) * dx + (stated[1] - my) * dy) / chord
    return stated[0] - along * dx, stated[1] - along * dy


def _woven(read: Programmed, blocks: Blocks, motions: Ints) -> Program:
    """Return the program with every motion of a run replaced by its blocks."""
    program = read.program
    marked = np.flatnonzero(read.mark >= 0)
    block_of = np.zeros(len(read.motions), np.int64)
    block_of[read.mark[marked]] = marked
    plain = np.flatnonzero(read.mark < 0)
    place = np.concatenate([plain, block_of[motions]])
    order = np.argsort(place, kind="stable")
    every = np.concatenate([program.blocks[plain], blocks])[order]
    place = place[order]
    # A lead-out that is a move (wire cut) stays one.
    kinds = program.blocks["kind"][place]
    every["kind"][(kinds == Kind.MOVE) & (every["kind"] == Kind.LINE)] = Kind.MOVE
    every["source"], every["cut"], every["role"] = -1, 0, 0
    texts = dict(program.words)
    words = tuple((k, texts[int(i)]) for k, i in enumerate(place) if int(i) in texts)
    spans = [program.spans[int(i)] for i in place]
    return Program(every, program.origin, program.sources, spans, words)

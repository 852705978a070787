"""On which side of its path the outline lies, where a decoded program becomes an outline and a gap.

A program knows no outlines. But contours that lie in each other alternate, as in a drawing: what is
inside the outer one is kept (punch) or what is around it (die), and for a hole it is the reverse.
So the closed paths between the moves of a program are nested like those of a drawing. Where that
tells nothing (an open path, a path that crosses another, a second cut beside the first) the place
is named and no outline is made: the path would be right with the gap it is made for and wrong with
every other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place, Severity, Span, error
from wedmcam.geom import measure
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.program import Kind, Program
from wedmcam.judge import segments as exact
from wedmcam.machines import Machine
from wedmcam.programs.stretches import Stretch, stretches
from wedmcam.transforms.meetings import contour_meetings
from wedmcam.transforms.nest import nest

Ints = NDArray[np.int64]

#: A path that ends this near to its start is closed: programs with J by geometry miss it by some
#: um. Steps.
CLOSED = 10
CURE = "compile the drawing to this format, or convert to one that takes any path"


class _Ring(NamedTuple):
    """A closed path: its blocks, the same as a contour, and all blocks of its cut that are arcs."""

    rows: Ints
    contour: Contour
    arcs: Ints


def arc_growth(
    program: Program, machine: Machine, gap_um: float, outwards: bool
) -> tuple[NDArray[np.int8] | None, list[Diagnostic]]:
    """Return for each block +1 where the gap made its arc larger than that of the outline, else -1.

    Args:
        program: the path of the wire, in blocks of the machine that it is to be written for.
        machine: whose controller steps it.
        gap_um: from the outline to the path.
        outwards: True for a punch: what lies in the outer contours is kept; False for a die.

    Returns:
        A value a block (+1 where there is nothing to tell); None, and errors, where it cannot be
        told for an arc.
    """
    blocks = program.blocks
    motion = machine.stepping.run(blocks)
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)])
    starts = ends - np.column_stack([motion.dx, motion.dy])
    rings, findings = [], []
    for one in stretches(blocks, starts, ends):
        ring, problem = _ring(program, one, starts, ends)
        rings += [] if ring is None else [ring]
        findings += [] if problem is None else [problem]
    contours = [ring.contour for ring in rings]
    findings += [
        d.with_hint(CURE) for d in contour_meetings(contours) if d.severity is Severity.ERROR
    ]
    if findings:
        return None, findings
    nesting = nest(contours)
    sense = np.ones(len(blocks), np.int8)
    for k, ring in enumerate(rings):
        parent = nesting.parents[k]
        if parent >= 0:
            findings += _too_near(program, ring, rings[parent], gap_um, starts)
        counter_clockwise = measure.area(ring.contour.vertices) > 0
        kept_inside = outwards == (nesting.depths[k] % 2 == 0)
        turn = blocks["turn"][ring.arcs]
        sense[ring.arcs] = turn * (1 if counter_clockwise else -1) * (1 if kept_inside else -1)
    return (None if findings else sense), findings


def _ring(
    program: Program, one: Stretch, starts: Ints, ends: Ints
) -> tuple[_Ring | None, Diagnostic | None]:
    """Return the closed path of a cut; None where there are no arcs, or with why there is none."""
    blocks = program.blocks
    rows = np.concatenate([one.lead_in, one.path, one.overcut, one.lead_out])
    is_arc = blocks["kind"][rows] == Kind.ARC
    arcs = rows[is_arc]
    if len(one.overcut):
        unknown = _unknown(program, one.overcut[0], starts)
        return None, unknown.extended(": it runs back in its own cut")
    path = one.path if len(one.lead_in) and one.closed else _closed(rows, is_arc, starts, ends)
    if path is None:
        if not len(arcs):
            return None, None
        unknown = _unknown(program, arcs[0], starts)
        return None, unknown.extended(": it belongs to a path that does not close")
    again = (ends[path[:-1]] == starts[path[0]]).all(axis=1)
    if again.any():
        where = path[int(np.argmax(again)) + 1]
        unknown = _unknown(program, where, starts)
        return None, unknown.extended(": it goes round the same contour once more")
    return _Ring(path, _contour(blocks, path, starts), arcs), None


def _closed(rows: Ints, is_arc: NDArray[np.bool_], starts: Ints, ends: Ints) -> Ints | None:
    """Return the blocks between leads that are no mirror of each other; None if they do not close.

    Only lines may come before and after the closed path; where there are no arcs, nothing.
    """
    bends = np.flatnonzero(is_arc)
    first, last = (int(bends[0]), int(bends[-1])) if len(bends) else (0, len(rows) - 1)
    for i in range(first, -1, -1):
        near = np.abs(ends[rows[last:]] - starts[rows[i]]).max(axis=1) <= CLOSED
        if near.any() and (len(bends) or len(rows) > 2):
            return rows[i : last + int(np.argmax(near)) + 1]
    return None


def _contour(blocks: NDArray[np.void], path: Ints, starts: Ints) -> Contour:
    """Return a closed path; ``source`` is nothing that was drawn."""
    v = np.zeros(len(path), VERTEX)
    v["x"], v["y"] = starts[path].T
    v["turn"], v["source"] = blocks["turn"][path], -1
    arc = v["turn"] != 0
    v["cx"] = np.where(arc, v["x"] - blocks["x"][path], 0.0)
    v["cy"] = np.where(arc, v["y"] - blocks["y"][path], 0.0)
    return Contour(v, True)


def _too_near(
    program: Program, inner: _Ring, outer: _Ring, gap_um: float, starts: Ints
) -> list[Diagnostic]:
    """Return an error where two paths in each other are too near for an outline between them."""
    a, b = exact.of_contour(inner.contour), exact.of_contour(outer.contour)
    i, j = exact.near_pairs(exact.boxes(a, 2.0 * gap_um), exact.boxes(b))
    if not len(i):
        return []
    apart = exact.segment_distance(a.take(i), b.take(j))
    k = int(np.argmin(apart))
    if apart[k] >= 2.0 * gap_um:
        return []
    return [
        _unknown(program, inner.rows[i[k]], starts).extended(
            ": the path around it is {apart_mm:.3f} mm away, less than two gaps: both may be cuts "
            "of one contour",
            apart_mm=float(apart[k]) / 1000,
        )
    ]


def _unknown(program: Program, row: np.int64, starts: Ints) -> Diagnostic:
    """Return the error about an arc whose outline may be on either side; the reason is added."""
    return error(
        "outline-side",
        "on which side of the path at {place} from the start the outline lies is not known",
        _span(program, int(row)),
        hint=CURE,
        place=Place.of_um(*starts[row].tolist()),
    )


def _span(program: Program, row: int) -> Span | None:
    if row < len(program.spans):
        return program.spans[row]
    source = int(program.blocks["source"][row])
    return program.sources[source] if 0 <= source < len(program.sources) else None

"""Compensation: from the outline of the part to the path of the wire's centre, arcs kept.

The wire runs beside the outline at the offset (wire radius + gap). At corners that it goes round a
transition arc about the corner joins the shifted neighbours (过渡圆, ZD-065); at inner corners they
are cut at their crossing. Where the wire does not fit (an inside radius below the offset, a neck or
a slot narrower than the wire) the outline cannot be cut as drawn: that is *interference*.

Three steps, a module each: ``raw`` shifts, ``resolve`` cuts, judges and stitches, and
``coordinates`` computes the vertices in the chosen arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, error
from wedmcam.geom.segments import Ints
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.compensate.coordinates import node_points
from wedmcam.transforms.compensate.interference import Interference, find_interference
from wedmcam.transforms.compensate.raw import SPECK_UM, Raw, Source, gather, raw_offset
from wedmcam.transforms.compensate.resolve import Limits, Loops, resolve
from wedmcam.transforms.compensate.untangle import untangled

__all__ = ["Compensated", "Interference", "WirePath", "compensate", "largest_offset"]



@dataclass(frozen=True, slots=True)
class _Attempt:
    """How one attempt takes the drawing.

    Attributes:
        limits: see there.
        nudge_um: added to the offset. Where walls coincide or many things meet in one point, a few
            nanometres decide what is what, and cost no accuracy that anything can show.
        speck_um: segments shorter than this are left out: curls of less than a micron at a corner
            can cross themselves at a scale that nothing else shows.
        untangle: cut off loops of less than a few microns at their crossing.
    """

    limits: Limits
    nudge_um: float = 0.0
    speck_um: float = SPECK_UM
    untangle: bool = False


#: Tried in this order until every piece of the path has found its neighbours.
ATTEMPTS = (
    _Attempt(Limits()),
    _Attempt(Limits(), untangle=True),
    _Attempt(Limits(near=1e-4, touch=0.01)),
    _Attempt(Limits(), 0.002),
    _Attempt(Limits(), -0.002),
    _Attempt(Limits(near=1e-4, touch=0.01), 0.002, untangle=True),
    _Attempt(Limits(near=1e-4, touch=0.01), -0.002, untangle=True),
    _Attempt(Limits(near=2e-3, touch=0.01), 0.004, untangle=True),
    _Attempt(Limits(near=2e-3, touch=0.01), -0.004, untangle=True),
    _Attempt(Limits(near=0.01, touch=0.06), untangle=True),
    _Attempt(Limits(near=0.01, touch=0.06), speck_um=0.05, untangle=True),
    _Attempt(Limits(near=0.01, touch=0.06), speck_um=0.3, untangle=True),
    _Attempt(Limits(near=0.01, touch=0.06), speck_um=1.5, untangle=True),
)


@dataclass(frozen=True, slots=True, eq=False)
class WirePath:
    """One piece of the wire path.

    Attributes:
        path: the contour that the wire's centre follows, in the direction of the outline.
        outline: index of the outline that it belongs to (the first, where it runs along several).
        outlines: all outlines that it runs along.
    """

    path: Contour
    outline: int
    outlines: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Compensated:
    """The wire paths of some outlines, and where the wire does not fit."""

    paths: tuple[WirePath, ...]
    interference: tuple[Interference, ...]
    inner_corners: int


def compensate(
    outlines: Sequence[Contour],
    shifts: Sequence[float],
    *,
    arithmetic: Arithmetic = FLOAT64,
    sharp: bool = False,
) -> tuple[Compensated, list[Diagnostic]]:
    """Return the paths at distance |shift| beside the outlines, arcs kept as arcs.

    Args:
        outlines: contours, um; closed ones, or open ones with squared ends.
        shifts: for each outline how far the wire runs to the left of it (negative: right), um.
            Outlines of one call keep the wire away from each other too.
        arithmetic: in which the vertices are computed.
        sharp: prolong the neighbours of an outer corner to their crossing, up to four offsets.

    Returns:
        The paths, in the direction of their outlines, and the interference found. A finding of code
        ``offset-unresolved`` when the crossings did not form loops at any tolerance: nothing may be
        cut then.

    Error bound: float64 rounding (below 1e-6 um at 1 m), but 0.02 um sideways where neighbours
    turn by so little that they meet in the middle.

    Source: the transition arcs are the ZD-065 paper's; shifting, cutting and judging by distance
    follows Liu, Yong, Zheng and Sun, Computers in Industry 58 (2007), stitching by node is ours.
    """
    for attempt in ATTEMPTS:
        nudged = [s + float(np.sign(s)) * attempt.nudge_um for s in shifts]
        source = gather(outlines, nudged, attempt.speck_um)
        if attempt.untangle:
            source = untangled(source) or source
        raw = raw_offset(source, sharp)
        found = resolve(source, raw, attempt.limits)
        if not len(found.lost):
            break
    else:
        at = found.lost_at + np.array(source.origin)
        where = tuple((float(x) / 1000, float(y) / 1000) for x, y in at[:3])
        number = int(raw.contour[found.element[found.lost[0]]])
        row = int(source.row[raw.source[found.element[found.lost[0]]]])
        return Compensated((), (), 0), [
            error(
                "offset-unresolved",
                f"the offset of this contour could not be resolved near "
                f"({where[0][0]:.3f}, {where[0][1]:.3f}) mm",
                outlines[number].source_of(row),
                points_mm=where,
                hint="this is a weakness of the compiler: please report the drawing; another "
                "offset or a cleaner drawing may help meanwhile",
            )
        ]
    corners = int(np.sum(~raw.joined & (raw.following >= 0)))
    merged, paths = _paths(outlines, arithmetic, source, raw, found)
    interference = find_interference(outlines, source, raw, found, merged)
    return Compensated(tuple(paths), interference, corners), []


def _paths(
    outlines: Sequence[Contour], ar: Arithmetic, source: Source, raw: Raw, found: Loops
) -> tuple[list[Ints], list[WirePath]]:
    """Return the loops as contours, pieces of one element merged where a loop runs through."""
    runs: list[Ints] = []
    for loop, closed in zip(found.loops, found.closed, strict=True):
        k = np.array(loop)
        element = found.element[k]
        # A node in the middle of one element is no vertex.
        through = (element == np.roll(element, 1)) & (
            np.abs(found.at0[k] - np.roll(found.at1[k], 1)) < 1e-9
        )
        if not closed or through.all():
            through[0] = False
        runs.append(k[~through])
    if not runs:
        return runs, []
    every = np.concatenate(
        [
            np.append(found.node0[k], [] if closed else found.node1[loop[-1]]).astype(np.int64)
            for k, loop, closed in zip(runs, found.loops, found.closed, strict=True)
        ]
    )
    nodes = np.unique(every)
    x, y = node_points(ar, source, raw, found, nodes)
    x, y = x + source.origin[0], y + source.origin[1]
    s = source.segments
    paths = []
    for k, loop, closed in zip(runs, found.loops, found.closed, strict=True):
        element = found.element[k]
        of = raw.source[element]
        rows = np.zeros(len(k) + (0 if closed else 1), VERTEX)
        ids = found.node0[k] if closed else np.append(found.node0[k], found.node1[loop[-1]])
        at = np.searchsorted(nodes, ids)
        rows["x"], rows["y"] = x[at], y[at]
        m = slice(0, len(k))
        corner = raw.transition[element]
        rows["cx"][m] = np.where(corner, s.x1[of], s.cx[of]) + source.origin[0]
        rows["cy"][m] = np.where(corner, s.y1[of], s.cy[of]) + source.origin[1]
        rows["turn"][m] = raw.elements.turn[element]
        numbers = np.unique(raw.contour[element])
        first = int(raw.contour[element[0]])
        rows["source"] = -1
        for number in numbers.tolist():
            mine = np.flatnonzero(raw.contour[element] == number)
            drawn = outlines[number].vertices["source"][source.row[of[mine]]]
            rows["source"][mine] = drawn if number == first else -1
        paths.append(
            WirePath(
                Contour(rows, closed, outlines[first].sources), first, tuple(numbers.tolist())
            )
        )
    return runs, paths


def largest_offset(
    outlines: Sequence[Contour], signs: Sequence[float], limit_um: float = 8000.0
) -> tuple[float, Interference | None]:
    """Return the largest offset (um) without interference, and what limits it.

    Looks at fillets, necks and slots, not at sharp corners. The result is within 0.05 um below the
    true limit; ``limit_um`` with None when nothing limits the offset up to there.

    Args:
        outlines: closed contours.
        signs: +1 where the wire runs to the left of the outline, -1 to the right.
        limit_um: where to stop looking.
    """

    def trouble(offset: float) -> Interference | None:
        result, problems = compensate(outlines, [offset * s for s in signs])
        if problems:
            return Interference("unresolved", (0.0, 0.0), 0, 0, (), 0.0)
        return result.interference[0] if result.interference else None

    worst = trouble(limit_um)
    if worst is None:
        return limit_um, None
    low, high = 0.0, limit_um
    while high - low > 0.05:
        middle = 0.5 * (low + high)
        found = trouble(middle)
        if found is None:
            low = middle
        else:
            high, worst = middle, found
    return low, worst

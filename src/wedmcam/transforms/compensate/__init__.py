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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, Place, Span, error
from wedmcam.geom.segments import Ints
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.compensate.coordinates import node_points, rounded
from wedmcam.transforms.compensate.interference import (
    Interference,
    find_interference,
)
from wedmcam.transforms.compensate.raw import SPECK_UM, Raw, Source, gather, raw_offset
from wedmcam.transforms.compensate.regular import regular_paths
from wedmcam.transforms.compensate.resolve import Limits, Loops, resolve
from wedmcam.transforms.compensate.untangle import untangle

__all__ = ["Compensated", "Interference", "WirePath", "compensate"]


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
    """The wire paths of some outlines, and where the wire does not fit.

    Attributes:
        paths: what is cut. A hole that falls into several rooms has a path for each.
        interference: where the wire does not fit, in order of the outlines.
        inner_corners: how many sharp inner corners keep the radius of the wire.
        pockets: closed paths that run against their outline: beside the outside of a punch, a
            pocket behind a mouth too narrow for the wire. What they enclose is scrap that leaves
            with the scrap around, and no wire gets there from outside; so they are not cut, and
            the segments that only they reach count as left out.
    """

    paths: tuple[WirePath, ...]
    interference: tuple[Interference, ...]
    inner_corners: int
    pockets: tuple[WirePath, ...] = ()


def compensate(
    outlines: Sequence[Contour],
    shifts: Sequence[float],
    *,
    arithmetic: Arithmetic = FLOAT64,
    sharp: bool | Sequence[bool] = False,
) -> tuple[Compensated, list[Diagnostic]]:
    """Return the paths at distance |shift| beside the outlines, arcs kept as arcs.

    Args:
        outlines: contours, um; closed ones, or open ones with squared ends.
        shifts: for each outline how far the wire runs to the left of it (negative: right), um.
            Outlines of one call keep the wire away from each other too. 0 follows the outline.
        arithmetic: in which the vertices are computed.
        sharp: prolong the neighbours of an outer corner to their crossing, up to four offsets; of
            all outlines, or of each.

    Returns:
        The paths, in the direction of their outlines, and the interference found. A finding of code
        ``offset-unresolved`` when the crossings did not form loops at any tolerance: nothing may be
        cut then.

    Error bound: what the arithmetic keeps of a coordinate: in float64 below 1e-6 um at 1 m, in
    8 decimal digits a unit of the eighth of the largest coordinate, counted from the middle of the
    outlines (0.01 um for a part of 1 m, 0.1 um for one of 10 m), three times that at crossings of
    30 degrees and more; besides up to 0.002 um sideways where neighbours
    turn by so little that they meet in the middle, and up to 0.01 um where the drawing crosses
    itself within a micron or more things than two meet in one point.

    Source: the transition arcs are the ZD-065 paper's; shifting, cutting and judging by distance
    follows Liu, Yong, Zheng and Sun, Computers in Industry 58 (2007), stitching by node is ours.
    """
    if not outlines:
        return Compensated((), (), 0), []
    smooth = regular_paths(outlines, shifts, arithmetic)
    if smooth is not None:
        paths = tuple(WirePath(path, k, (k,)) for k, path in enumerate(smooth))
        return Compensated(paths, (), 0), []
    for attempt in ATTEMPTS:
        nudged = [s + float(np.sign(s)) * attempt.nudge_um for s in shifts]
        source = gather(outlines, nudged, attempt.speck_um)
        if attempt.untangle:
            source = untangle(source) or source
        raw = raw_offset(source, sharp)
        if raw.tangled and not attempt.untangle:
            continue
        loops = resolve(source, raw, attempt.limits)
        if not len(loops.lost):
            break
    else:
        if len(outlines) > 1:
            return _without_conflicts(outlines, shifts, arithmetic, sharp)
        return Compensated((), (), 0), [_unresolved(outlines, source, raw, loops)]
    runs = _runs(loops)
    every = _paths(outlines, arithmetic, source, raw, loops, runs)
    backwards = _backwards(source, raw, loops)
    kept = np.flatnonzero(~backwards).tolist()
    interference = find_interference(
        outlines, source, raw, loops, [runs[k] for k in kept], [loops.closed[k] for k in kept]
    )
    paths = tuple(every[k] for k in kept)
    pockets = tuple(every[k] for k in np.flatnonzero(backwards).tolist())
    return Compensated(paths, interference, _inner_corners(source, raw, loops), pockets), []


def _without_conflicts(
    outlines: Sequence[Contour],
    shifts: Sequence[float],
    arithmetic: Arithmetic,
    sharp: bool | Sequence[bool],
) -> tuple[Compensated, list[Diagnostic]]:
    """Leave out contours whose wire would run into what another one keeps.

    Where the wire of a contour comes nearer than the offset to an outline whose own wire runs on
    the far side (the outside of a punch beside a hole in it), no path leads round: the contour has
    none, and that is interference.
    """
    source = gather(outlines, shifts)
    raw = raw_offset(source, sharp)
    loops = resolve(source, raw, Limits())
    lost = raw.contour[loops.element[loops.lost]]
    is_bad = np.bincount(lost, minlength=len(outlines)) > 0
    bad, good = np.flatnonzero(is_bad), np.flatnonzero(~is_bad).tolist()
    if not len(bad):  # lost only in a later attempt, or the contours cross
        return Compensated((), (), 0), [_crossing(outlines)]
    own = [sharp] * len(outlines) if isinstance(sharp, bool) else sharp
    alone = [compensate([outlines[k]], [shifts[k]], sharp=own[k])[1] for k in bad.tolist()]
    problems = [p for found in alone for p in found]
    rest, more = compensate(
        [outlines[k] for k in good],
        [shifts[k] for k in good],
        arithmetic=arithmetic,
        sharp=[own[k] for k in good],
    )
    if problems or more:
        return Compensated((), (), 0), problems + more
    interference = [replace(i, outline=good[i.outline]) for i in rest.interference]
    for number in bad.tolist():
        k = int(np.flatnonzero(lost == number)[0])
        x, y = loops.lost_at[k] + np.array(source.origin)
        row = int(source.row[raw.source[loops.element[loops.lost[k]]]])
        rows = tuple(range(len(outlines[number])))
        length = float(source.segments.length[source.contour == number].sum())
        interference.append(
            Interference("neighbour", (float(x), float(y)), number, row, rows, length)
        )
    interference.sort(key=lambda i: (i.outline, i.row, i.kind, i.at))
    paths, pockets = (
        tuple(WirePath(p.path, good[p.outline], tuple(good[k] for k in p.outlines)) for p in group)
        for group in (rest.paths, rest.pockets)
    )
    return Compensated(paths, tuple(interference), rest.inner_corners, pockets), []


def _crossing(outlines: Sequence[Contour]) -> Diagnostic:
    first = Place.of_um(*(outlines[0].vertices[name][0] for name in ("x", "y")))
    return error(
        "offset-unresolved",
        "the offsets of {contours} contours, the first at {first}, could not be resolved together",
        outlines[0].source_of(0),
        points_mm=(first,),
        hint="do these contours cross each other?",
        contours=len(outlines),
        first=first,
    )


def _unresolved(outlines: Sequence[Contour], source: Source, raw: Raw, loops: Loops) -> Diagnostic:
    at = loops.lost_at + np.array(source.origin)
    where = tuple(Place.of_um(x, y) for x, y in at[:3])
    element = int(loops.element[loops.lost[0]])
    return error(
        "offset-unresolved",
        "the offset of this contour could not be resolved near {place}",
        outlines[int(raw.contour[element])].source_of(int(source.row[raw.source[element]])),
        points_mm=where,
        hint="this is a weakness of the compiler: please report the drawing; another "
        "offset or a cleaner drawing may help meanwhile",
        place=where[0],
    )


def _inner_corners(source: Source, raw: Raw, loops: Loops) -> int:
    """Return how many neighbours in the drawing overlap once they are shifted.

    Those before and behind what no piece of the path runs along (a chamfer) are one corner.
    """
    e = np.flatnonzero(~raw.joined & (raw.following >= 0))
    f = raw.following[e]
    drawn = source.following[raw.source[e]] == raw.source[f]
    e, f = e[drawn], f[drawn]
    used = np.zeros(len(raw.source), bool)
    for loop in loops.loops:
        used[loops.element[loop]] = True
    if used[e].all():
        return len(e)
    before = np.full(len(used), -1)
    has = raw.following >= 0
    before[raw.following[has]] = np.flatnonzero(has)
    enters = set(f.tolist())
    count = len(e)
    for k in e[~used[e]].tolist():
        while k >= 0 and not used[k] and k not in enters:
            k = int(before[k])
        count -= k in enters and not used[k]
    return count


def _backwards(source: Source, raw: Raw, loops: Loops) -> NDArray[np.bool_]:
    """Return which loops run against the outline that they belong to."""
    s = source.segments
    lune = s.radius**2 * (s.sweep - np.sin(s.sweep)) * s.turn
    area = np.bincount(source.contour, s.x0 * s.y1 - s.x1 * s.y0 + lune)
    first = np.array([int(raw.contour[loops.element[k[0]]]) for k in loops.loops], np.int64)
    return np.array(loops.areas) * area[first] < 0


def _runs(loops: Loops) -> list[Ints]:
    """Return the loops without pieces that only continue the one before on the same element."""
    if loops.whole or not loops.loops:
        return loops.loops
    k = np.concatenate(loops.loops)
    size = np.array([len(loop) for loop in loops.loops], np.int64)
    begin = np.cumsum(size) - size
    closed = np.array(loops.closed, bool)
    before = np.arange(-1, len(k) - 1)
    before[begin] = begin + size - 1
    element = loops.element[k]
    through = element == element[before]
    through &= np.abs(loops.at0[k] - loops.at1[k[before]]) < 1e-9
    through[begin[~closed]] = False
    # A loop of one element keeps its first vertex.
    through[begin[np.add.reduceat(~through, begin) == 0]] = False
    count = np.add.reduceat(~through, begin)
    return np.split(k[~through], np.cumsum(count)[:-1])


def _paths(
    outlines: Sequence[Contour],
    ar: Arithmetic,
    source: Source,
    raw: Raw,
    loops: Loops,
    runs: list[Ints],
) -> list[WirePath]:
    """Return the loops as contours."""
    if not runs:
        return []
    k = np.concatenate(runs)
    element = loops.element[k]
    node = loops.node0[k]
    x, y = loops.node_x, loops.node_y
    if ar is not FLOAT64:  # float64 is what the nodes were computed in
        used = np.concatenate([node, [loops.node1[loop[-1]] for loop in loops.loops]]).astype(
            np.int64
        )
        used = np.flatnonzero(np.bincount(used))  # np.unique fetches numpy.ma
        x, y = x.copy(), y.copy()
        x[used], y[used] = node_points(ar, source, raw, loops, used)
    e = raw.elements
    of = raw.source[element]
    rows = np.zeros(len(k), VERTEX)
    rows["x"], rows["y"] = x[node] + source.origin[0], y[node] + source.origin[1]
    rows["cx"], rows["cy"] = (
        rounded(ar, c[element]) + o for c, o in zip((e.cx, e.cy), source.origin, strict=True)
    )
    rows["turn"] = e.turn[element]
    number = raw.contour[element]
    drawn = np.concatenate([c.vertices["source"] for c in outlines])
    base = np.cumsum([0, *(len(c.vertices) for c in outlines)])
    rows["source"] = drawn[base[number] + source.row[of]]
    paths = []
    begin = 0
    for run, loop, closed in zip(runs, loops.loops, loops.closed, strict=True):
        part = rows[begin : begin + len(run)]
        mine = number[begin : begin + len(run)]
        begin += len(run)
        first = int(mine[0])
        along = (first,)
        sources = outlines[first].sources
        if len(outlines) > 1 and (mine != first).any():
            along = tuple(np.unique(mine).tolist())
            sources = _of_several(outlines, along, part, mine)
        if not closed:
            last = np.zeros(1, VERTEX)
            end = int(loops.node1[loop[-1]])
            last["x"], last["y"] = x[end] + source.origin[0], y[end] + source.origin[1]
            last["source"] = -1
            part = np.concatenate([part, last])
        paths.append(WirePath(Contour(part, closed, sources), first, along))
    return paths


def _of_several(
    outlines: Sequence[Contour], along: Sequence[int], part: NDArray[np.void], mine: Ints
) -> tuple[Span, ...]:
    """Return the sources of a path along several outlines, and number those of ``part`` anew."""
    lists = {id(outlines[k].sources) for k in along}
    if len(lists) == 1:
        return outlines[along[0]].sources
    sources: list[Span] = []
    for k in along:
        rows = (mine == k) & (part["source"] >= 0)
        part["source"][rows] += len(sources)
        sources += outlines[k].sources
    return tuple(sources)

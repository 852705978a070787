"""Where the wire does not fit: segments that no piece of the wire path reaches.

A sharp inner corner is no interference: the shifted neighbours are cut at their crossing and the
corner keeps the radius of the wire. It is interference when the path leaves out a drawn segment
(a fillet or a step smaller than the wire, everything beyond a neck), when a contour falls apart
into several paths, or when it has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.geom.segments import Ints
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate.raw import Raw, Source
from wedmcam.transforms.compensate.resolve import Loops

#: Left-out segments up to this length are no loss: half the deviation budget each way; um.
NEGLIGIBLE_UM = 2.0


@dataclass(frozen=True, slots=True)
class Interference:
    """One place where the wire does not fit.

    Attributes:
        kind: "radius" (inside radius below the offset), "passage" (neck, slot, step), "neighbour"
            (another contour is too near), "vanished" (the contour has no path at all).
        at: (x, y) um, drawing coordinates.
        outline: index of the outline.
        row: the row of the outline whose segment is left out or met first.
        rows: all rows of the outline that are left out.
        size: the radius (kind "radius") or the drawn length left out, um.
    """

    kind: str
    at: tuple[float, float]
    outline: int
    row: int
    rows: tuple[int, ...]
    size: float


def find_interference(
    outlines: Sequence[Contour], source: Source, raw: Raw, found: Loops, runs: list[Ints]
) -> tuple[Interference, ...]:
    """Return the places where the path leaves out what was drawn, in order of the outlines."""
    result: list[Interference] = []
    reached = np.zeros(len(source.contour), bool)
    for k in runs:
        element = found.element[k]
        reached[raw.source[element[~raw.transition[element]]]] = True
    _forgive_points(raw, source, reached)
    paths_of: dict[int, int] = {}
    for k, closed in zip(runs, found.closed, strict=True):
        element = found.element[k]
        numbers = np.unique(raw.contour[element])
        for number in numbers.tolist():
            paths_of[number] = paths_of.get(number, 0) + 1
        nxt = np.roll(element, -1) if closed else np.append(element[1:], -1)
        jump = np.flatnonzero((nxt >= 0) & (raw.following[element] != nxt) & (element != nxt))
        for m in jump.tolist():
            finding = _skipped(source, raw, found, reached, k, element, nxt, m)
            if finding is not None:
                result.append(finding)
    for number in range(len(outlines)):
        if number not in paths_of:
            result.append(_vanished(source, number))
    covered = {(i.outline, r) for i in result for r in i.rows}
    result += _unreported(source, raw, reached, covered, paths_of)
    for number, count in paths_of.items():
        if count > 1 and not any(i.outline == number for i in result):
            rows = np.flatnonzero(source.contour == number)
            result.append(_passage(source, rows[:1]))
    return tuple(sorted(result, key=lambda i: (i.outline, i.row, i.kind, i.at)))


def _forgive_points(raw: Raw, source: Source, reached: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> None:
    """Count as reached: arcs that shrank to a point of the path, and negligible segments."""
    reached |= source.segments.length <= NEGLIGIBLE_UM
    v = raw.vanished
    if len(v):
        s = source.segments
        radius = s.radius[v] - source.shift[v] * s.turn[v]
        chord = 2 * np.abs(radius) * np.sin(np.minimum(s.sweep[v], np.pi) / 2)
        # Half a micron of radius is half a step: the corner is exact on the machine's grid.
        reached[v[(np.abs(radius) <= 0.5) | (chord <= 0.5)]] = True


def _between(raw: Raw, source: Source, e: int, f: int) -> Ints:
    """Return the drawn segments strictly between those of elements e and f, along the outline."""
    if raw.contour[e] != raw.contour[f]:
        return np.empty(0, np.int64)
    a, b = int(raw.source[e]), int(raw.source[f])
    if raw.transition[f] and not raw.transition[e] and a == b:
        return np.empty(0, np.int64)
    rows = []
    here = int(source.following[a])
    limit = len(source.contour)
    while here >= 0 and here != b and limit:
        rows.append(here)
        here = int(source.following[here])
        limit -= 1
    return np.array(rows, np.int64)


def _skipped(
    source: Source,
    raw: Raw,
    found: Loops,
    reached: np.ndarray[tuple[int], np.dtype[np.bool_]],
    k: Ints,
    element: Ints,
    nxt: Ints,
    m: int,
) -> Interference | None:
    """Return the interference at the jump after piece m of a path, None if nothing is lost."""
    e, f = int(element[m]), int(nxt[m])
    node = int(found.node0[k[(m + 1) % len(k)]])
    at = (
        float(found.node_x[node] + source.origin[0]),
        float(found.node_y[node] + source.origin[1]),
    )
    number = int(raw.contour[e])
    row = int(source.row[raw.source[e]])
    if raw.contour[f] != number:
        return Interference("neighbour", at, number, row, (), 0.0)
    between = _between(raw, source, e, f)
    left_out = between[~reached[between]]
    if not len(left_out):
        # Nothing drawn is left out: an inner corner, or specks. But a jump to what lies behind
        # (over reached segments) is a pinched passage.
        if len(between) and np.any(source.segments.length[between] > NEGLIGIBLE_UM):
            return Interference("passage", at, number, row, (), 0.0)
        return None
    lengths = source.segments.length[left_out]
    rows = tuple(source.row[left_out].tolist())
    s = source.segments
    inside = (s.turn[left_out] * source.shift[left_out] > 0) & (
        s.radius[left_out] < np.abs(source.shift[left_out])
    )
    if inside.all():
        worst = left_out[np.argmin(s.radius[left_out])]
        return Interference("radius", at, number, int(source.row[worst]), rows, float(s.radius[worst]))
    return Interference("passage", at, number, rows[0], rows, float(lengths.sum()))


def _vanished(source: Source, number: int) -> Interference:
    rows = np.flatnonzero(source.contour == number)
    s = source.segments
    at = (
        float(s.x0[rows].mean() + source.origin[0]),
        float(s.y0[rows].mean() + source.origin[1]),
    )
    if len(rows) == 1 and s.turn[rows[0]] != 0:
        at = (float(s.cx[rows[0]] + source.origin[0]), float(s.cy[rows[0]] + source.origin[1]))
    return Interference(
        "vanished",
        at,
        number,
        int(source.row[rows[0]]),
        tuple(source.row[rows].tolist()),
        float(s.length[rows].sum()),
    )


def _unreported(
    source: Source,
    raw: Raw,
    reached: np.ndarray[tuple[int], np.dtype[np.bool_]],
    covered: set[tuple[int, int]],
    paths_of: dict[int, int],
) -> list[Interference]:
    """Return left-out segments that no jump explains (they lie beyond another contour's path)."""
    result = []
    for k in np.flatnonzero(~reached).tolist():
        number, row = int(source.contour[k]), int(source.row[k])
        if number in paths_of and (number, row) not in covered:
            result.append(_passage(source, np.array([k])))
    return result


def _passage(source: Source, rows: Ints) -> Interference:
    s = source.segments
    k = int(rows[0])
    at = (
        float(0.5 * (s.x0[k] + s.x1[k]) + source.origin[0]),
        float(0.5 * (s.y0[k] + s.y1[k]) + source.origin[1]),
    )
    return Interference(
        "passage",
        at,
        int(source.contour[k]),
        int(source.row[k]),
        tuple(source.row[rows].tolist()),
        float(s.length[rows].sum()),
    )

"""Where the wire does not fit: segments that no piece of the wire path reaches.

An inner corner is no interference (`corner` says what is one): the shifted neighbours are cut at
their crossing and the corner keeps the radius of the wire. It is interference when the path leaves
out a drawn segment (a fillet or a step smaller than the wire, everything beyond a neck), when a
contour falls apart into several paths, or when it has none.

The path jumps over what it leaves out. A neck is jumped over twice, once from each side, so jumps
that share a crossing or a left-out stretch of the outline are one finding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate.corner import is_inner_corner
from wedmcam.transforms.compensate.raw import Raw, Source
from wedmcam.transforms.compensate.resolve import Loops

Bools = NDArray[np.bool_]

#: Left-out segments up to this length are no loss: half the deviation budget each way; um.
NEGLIGIBLE_UM = 2.0
#: A shifted radius up to this is a corner: half a step of the machine; um.
CORNER_UM = 0.5
#: So many left-out segments are looked at one by one: of more some are lost for certain.
MANY = 2000


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


class _Reach:
    """Which drawn segments the path reaches, and stretches of those that it does not."""

    def __init__(self, source: Source, raw: Raw, loops: Loops, pieces: Ints) -> None:
        element = loops.element[pieces]
        s, n = source.segments, len(source.contour)
        self.source = source
        self.offset = np.abs(source.shift)
        self.inside = (s.turn * source.shift > 0) & (s.radius < self.offset)
        reached = np.zeros(n, bool)
        reached[raw.source[element[~raw.transition[element]]]] = True
        self.reached = reached
        lost = ~reached & (s.length > NEGLIGIBLE_UM)
        v = raw.vanished
        radius = np.abs(s.radius[v] - source.shift[v] * s.turn[v])
        chord = 2 * radius * np.sin(np.minimum(s.sweep[v], np.pi) / 2)
        v = v[lost[v] & ((radius <= CORNER_UM) | (chord <= CORNER_UM))]
        node = loops.node0[pieces]
        lost[v[_met(s.cx[v], s.cy[v], loops.node_x[node], loops.node_y[node])]] = False
        beside = np.flatnonzero(lost & ~self.inside)
        if 0 < len(beside) <= MANY:
            lost[beside[_beside(source, raw, loops, pieces, beside)]] = False
        #: Left out, and not negligibly.
        self.lost = lost
        #: First row of each contour and how many there are, for walks round it.
        self.first = np.searchsorted(source.contour, source.contour)
        self.count = np.searchsorted(source.contour, source.contour, "right") - self.first
        self.before = np.full(n, -1)
        has = source.following >= 0
        self.before[source.following[has]] = np.flatnonzero(has)
        self.stretch = self._stretches()
        passed = lost | (reached & (s.length > NEGLIGIBLE_UM))
        self._passed = np.append(0, np.cumsum(passed))
        self._seen = np.append(0, np.cumsum(passed & reached))

    def _stretches(self) -> Ints:
        """Return the number of the left-out stretch of each segment, -1 where it is reached."""
        n = len(self.reached)
        begins = ~self.reached & ((self.before < 0) | self.reached[self.before])
        number = np.cumsum(begins) - 1
        stretch = np.where(self.reached, -1, number)
        # Segments left out at the beginning of a closed contour continue those at its end.
        for k in np.flatnonzero((self.first == np.arange(n)) & ~self.reached & ~begins).tolist():
            last = k + int(self.count[k]) - 1
            end = k
            while end <= last and not self.reached[end]:
                end += 1
            stretch[k:end] = stretch[last] if end <= last else n + k
        return stretch

    def between(self, a: Ints, b: Ints) -> tuple[Ints, Ints]:
        """Return how many segments strictly between a and b matter, and how many are reached.

        Where a == b that is once round the contour.
        """
        first, count = self.first[a], self.count[a]
        steps = np.mod(b - a - 1, count)
        start = first + np.mod(a - first + 1, count)
        end = start + steps
        over = np.maximum(end - first - count, 0)
        end = np.minimum(end, first + count)
        result = []
        for total in (self._passed, self._seen):
            result.append(total[end] - total[start] + total[first + over] - total[first])
        return result[0], result[1]


def _met(cx: Floats, cy: Floats, x: Floats, y: Floats) -> Bools:
    """Return which centres a path with these vertices meets.

    In a corner the path passes the centre of an arc that shrank to nothing. Where it does not, it
    never came there: an arc of more than half a turn lies behind a mouth narrower than the wire.
    """
    met = np.zeros(len(cx), bool)
    near = pairs.grow((x, y, x, y), NEGLIGIBLE_UM)
    i, j = pairs.overlapping((cx, cy, cx, cy), near)
    met[i[np.hypot(cx[i] - x[j], cy[i] - y[j]) <= NEGLIGIBLE_UM]] = True
    return met


def _beside(source: Source, raw: Raw, loops: Loops, pieces: Ints, rows: Ints) -> Bools:
    """Return which segments the wire passes as near as if it reached them.

    Of a round hole drawn as a polygon many sides are left out near its radius, because neighbours
    are some nanometres nearer to the centre; nothing is lost there.
    """
    s = source.segments.take(rows)
    x, y = seg.points_at(s, 0.5 * s.length)
    wanted = np.abs(source.shift[rows]) + CORNER_UM
    path = raw.elements.take(loops.element[pieces])
    at0, at1 = loops.at0[pieces], loops.at1[pieces]
    i, j = pairs.overlapping(
        (x - wanted, y - wanted, x + wanted, y + wanted), pairs.grow(seg.boxes(path), 0.0)
    )
    e = path.take(j)
    px, py = seg.points_at(e, np.clip(seg.position_of(e, x[i], y[i]), at0[j], at1[j]))
    result = np.zeros(len(rows), bool)
    result[i[np.hypot(px - x[i], py - y[i]) <= wanted[i]]] = True
    return result


def find_interference(
    outlines: Sequence[Contour],
    source: Source,
    raw: Raw,
    loops: Loops,
    runs: list[Ints],
    closed: list[bool],
) -> tuple[Interference, ...]:
    """Return the places where the path leaves out what was drawn, in order of the outlines.

    Args:
        runs: the paths that are cut, as indices into the columns of ``loops``.
        closed: for each of them.
    """
    pieces = np.concatenate([*runs, np.empty(0, np.int64)])
    element = loops.element[pieces]
    n = len(source.contour)
    if loops.whole and len(runs) == len(outlines):
        return ()
    reach = _Reach(source, raw, loops, pieces)
    size = np.array([len(k) for k in runs], np.int64)
    last = np.cumsum(size) - 1
    nxt: Ints = np.append(element[1:], -1)
    after = np.append(pieces[1:], -1)
    for_closed = np.array(closed, bool)
    nxt[last] = np.where(for_closed, element[last - size + 1], -1)
    after[last] = pieces[last - size + 1]
    skips = source.following[raw.source] != np.roll(raw.source, -1)
    apart = (raw.following[element] != nxt) | (skips[element] & ~raw.transition[element])
    jump = np.flatnonzero((nxt >= 0) & apart & (element != nxt))
    e, f = element[jump], nxt[jump]
    node = loops.node0[after[jump]]
    a, b = raw.source[e], _entered(source, raw, f)
    same = raw.contour[e] == raw.contour[f]
    matter, seen = reach.between(a, np.where(same, b, a))
    wanted = np.flatnonzero(~same | (matter > 0))
    result = _findings(source, raw, loops, reach, e[wanted], f[wanted], node[wanted], seen[wanted])
    loop_counts = np.zeros(len(outlines), np.int64)
    for run in runs:
        loop_counts[np.flatnonzero(np.bincount(raw.contour[loops.element[run]]))] += 1
    result += [_vanished(source, number) for number in np.flatnonzero(loop_counts == 0).tolist()]
    covered = np.zeros(n, bool)
    index = (
        {
            (int(c), int(r)): k
            for k, (c, r) in enumerate(zip(source.contour, source.row, strict=True))
        }
        if result
        else {}
    )
    for item in result:
        covered[[index[item.outline, row] for row in item.rows if (item.outline, row) in index]] = (
            True
        )
    for k in np.flatnonzero(reach.lost & ~covered & (loop_counts[source.contour] > 0)).tolist():
        if not covered[k]:
            group = np.flatnonzero((reach.stretch == reach.stretch[k]) & reach.lost)
            covered[group] = True
            result.append(_passage(source, reach, group, None))
    opened = {
        int(raw.contour[loops.element[k[0]]]) for k, c in zip(runs, closed, strict=True) if not c
    }
    for number, contour in enumerate(outlines):
        if not contour.closed and loop_counts[number] and number not in opened:
            result.append(_cut_off(source, number))
    named = {item.outline for item in result}
    for number in np.flatnonzero(loop_counts > 1).tolist():
        if number not in named:
            result.append(
                _passage(source, reach, np.flatnonzero(source.contour == number)[:1], None)
            )
    return tuple(sorted(result, key=lambda i: (i.outline, i.row, i.kind, i.at)))


def _entered(source: Source, raw: Raw, f: Ints) -> Ints:
    """Return the drawn segment that a path has before it when it enters elements f.

    A transition arc belongs to the segment before its corner, which the path does not reach then.
    """
    return np.where(raw.transition[f], source.following[raw.source[f]], raw.source[f])


def _findings(
    source: Source, raw: Raw, loops: Loops, reach: _Reach, e: Ints, f: Ints, node: Ints, seen: Ints
) -> list[Interference]:
    """Return one finding for each set of jumps that share a crossing or a left-out stretch."""
    a, b = raw.source[e], _entered(source, raw, f)
    follow = source.following[a]
    ahead = np.where(follow >= 0, reach.stretch[follow], -1)
    behind = np.where(reach.before[b] >= 0, reach.stretch[reach.before[b]], -1)
    top: dict[int, int] = {}

    def root(k: int) -> int:
        while top.setdefault(k, k) != k:
            top[k] = top[top[k]]
            k = top[k]
        return k

    stretches = 2 * len(source.contour) + 1
    for m, n0, s0, s1 in zip(
        range(len(e)), node.tolist(), ahead.tolist(), behind.tolist(), strict=True
    ):
        here = root(-1 - m)
        top[here] = root(stretches + n0)
        for stretch in (s0, s1):
            if stretch >= 0:
                top[root(-1 - m)] = root(stretch)
    sets: dict[int, list[int]] = {}
    for m in range(len(e)):
        sets.setdefault(root(-1 - m), []).append(m)
    lost_rows = np.flatnonzero(reach.lost)
    by_stretch = lost_rows[np.argsort(reach.stretch[lost_rows], kind="stable")]
    keys = reach.stretch[by_stretch]
    result = []
    for jumps in sets.values():
        m = min(jumps, key=lambda k: (int(raw.contour[e[k]]), int(a[k]), int(node[k])))
        at = (
            float(loops.node_x[node[m]] + source.origin[0]),
            float(loops.node_y[node[m]] + source.origin[1]),
        )
        number = int(raw.contour[e[m]])
        ids = sorted({int(s) for k in jumps for s in (ahead[k], behind[k]) if s >= 0})
        rows = [by_stretch[slice(*np.searchsorted(keys, (s, s + 1)))] for s in ids]
        lost = np.sort(np.concatenate([*rows, np.empty(0, np.int64)]))
        if any(raw.contour[e[k]] != raw.contour[f[k]] for k in jumps):
            for number in np.unique(raw.contour[np.concatenate([e[jumps], f[jumps]])]).tolist():
                mine = lost[source.contour[lost] == number]
                met = [k for k in jumps if raw.contour[e[k]] == number]
                first = mine[0] if len(mine) else a[met[0]] if met else b[jumps[0]]
                left_out = tuple(source.row[mine].tolist())
                length = float(source.segments.length[mine].sum())
                row = int(source.row[first])
                result.append(Interference("neighbour", at, number, row, left_out, length))
        elif len(jumps) == 1 and not seen[m] and is_inner_corner(source, int(a[m]), int(b[m])):
            reach.lost[lost] = False
        elif len(lost) and reach.inside[lost].all() and not seen[jumps].any():
            radius = source.segments.radius[lost]
            row = int(source.row[lost[np.argmin(radius)]])
            rows_left = tuple(source.row[lost].tolist())
            result.append(Interference("radius", at, number, row, rows_left, float(radius.min())))
        elif len(lost):
            result.append(_passage(source, reach, lost, at))
        elif seen[jumps].any():
            result.append(Interference("passage", at, number, int(source.row[a[m]]), (), 0.0))
    return result


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


def _cut_off(source: Source, number: int) -> Interference:
    """Return the finding that the wire cannot begin beside the start of an open contour."""
    k = int(np.flatnonzero(source.contour == number)[0])
    s = source.segments
    at = (float(s.x0[k] + source.origin[0]), float(s.y0[k] + source.origin[1]))
    return Interference("passage", at, number, int(source.row[k]), (), 0.0)


def _passage(
    source: Source, reach: _Reach, rows: Ints, at: tuple[float, float] | None
) -> Interference:
    """Return a finding about left-out segments, by default at the first one's middle."""
    s = source.segments
    k = int(rows[0])
    middle = (
        float(0.5 * (s.x0[k] + s.x1[k]) + source.origin[0]),
        float(0.5 * (s.y0[k] + s.y1[k]) + source.origin[1]),
    )
    left_out: Floats = s.length[rows[reach.lost[rows]]]
    return Interference(
        "passage",
        at or middle,
        int(source.contour[k]),
        int(source.row[k]),
        tuple(source.row[rows].tolist()),
        float(left_out.sum()),
    )

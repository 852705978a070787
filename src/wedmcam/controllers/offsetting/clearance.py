"""What a controller of one block of look-ahead does not see, and runs into.

A block that runs back on an earlier one has the wire on its other side there; a path that comes
nearer to any block than the offset cuts into what that block bounds. Every element of the path is
held against every block that could be near, by distance. Which ones could be is a matter of boxes
(`_near_boxes`), and skips none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.offsetting.path import Element, Lost
from wedmcam.controllers.offsetting.segment import Segment

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
#: Left, low, right, high, um.
Boxes = tuple[Floats, Floats, Floats, Floats]

#: The wire may come this much nearer to a block than the offset: two roundings, and less than what
#: the proof lets pass as a gouge; um.
NEARER_UM = 1.5
#: Blocks this near to each other run on one line; um.
ONE_LINE_UM = 1.0
#: So far from the opposite direction a block still runs back on another, radians.
BACK = 0.01
#: Places of a block that are looked at for that, as shares of its length.
SHARES = (0.25, 0.5, 0.75)
#: A place this near to a segment is on it; um.
ON_UM = 1e-5
#: So many pairs are measured at once: some 100 MB.
MOST_PAIRS = 500_000


@dataclass(frozen=True, slots=True, eq=False)
class Many:
    """Segments as columns, as in `Segment`; ``a0`` is the angle of an arc's start, radians."""

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    turn: Ints
    radius: Floats
    sweep: Floats
    a0: Floats
    ux: Floats
    uy: Floats
    length: Floats

    def take(self, index: Ints) -> Many:
        """Return the chosen ones."""
        return Many(*(getattr(self, name)[index] for name in self.__slots__))

    def at(self, share: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the place at a share of each length, and the heading there."""
        angle = self.a0 + self.turn * share * self.sweep
        arc = self.turn != 0
        far = share * self.length
        return (
            np.where(arc, self.cx + self.radius * np.cos(angle), self.x0 + far * self.ux),
            np.where(arc, self.cy + self.radius * np.sin(angle), self.y0 + far * self.uy),
            np.where(arc, -self.turn * np.sin(angle), self.ux),
            np.where(arc, self.turn * np.cos(angle), self.uy),
        )

    def nearest(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return the place of segment i that is nearest to place i."""
        along = np.clip((x - self.x0) * self.ux + (y - self.y0) * self.uy, 0.0, self.length)
        on_line = self.x0 + along * self.ux, self.y0 + along * self.uy
        if not self.turn.any():
            return on_line
        angle = np.arctan2(y - self.cy, x - self.cx)
        within = np.mod((angle - self.a0) * self.turn, 2 * np.pi) <= self.sweep
        nearer_start = np.hypot(x - self.x0, y - self.y0) <= np.hypot(x - self.x1, y - self.y1)
        result = []
        for line, centre, way, start, end in (
            (on_line[0], self.cx, np.cos(angle), self.x0, self.x1),
            (on_line[1], self.cy, np.sin(angle), self.y0, self.y1),
        ):
            arc = np.where(within, centre + self.radius * way, np.where(nearer_start, start, end))
            result.append(np.where(self.turn != 0, arc, line))
        return result[0], result[1]

    def distance(self, x: Floats, y: Floats) -> Floats:
        """Return how far segment i is from place i, um."""
        u, v = self.nearest(x, y)
        result: Floats = np.hypot(x - u, y - v)
        return result

    def boxes(self) -> Boxes:
        """Return the boxes around them."""
        left, right = np.minimum(self.x0, self.x1), np.maximum(self.x0, self.x1)
        low, high = np.minimum(self.y0, self.y1), np.maximum(self.y0, self.y1)
        for quarter, (dx, dy) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
            passed = np.mod((quarter * np.pi / 2 - self.a0) * self.turn, 2 * np.pi) <= self.sweep
            passed &= self.turn != 0
            x, y = self.cx + dx * self.radius, self.cy + dy * self.radius
            left, right = (
                np.where(passed, np.minimum(left, x), left),
                np.where(passed, np.maximum(right, x), right),
            )
            low, high = (
                np.where(passed, np.minimum(low, y), low),
                np.where(passed, np.maximum(high, y), high),
            )
        return left, low, right, high


def columns(segments: Sequence[Segment]) -> Many:
    """Return segments as columns."""
    names = ("x0", "y0", "x1", "y1", "cx", "cy", "radius", "sweep")
    c = {name: np.array([getattr(s, name) for s in segments], np.float64) for name in names}
    turn = np.array([s.turn for s in segments], np.int64)
    chord = np.hypot(c["x1"] - c["x0"], c["y1"] - c["y0"])
    size = np.where(chord > 0, chord, 1.0)
    return Many(
        **c,
        turn=turn,
        a0=np.arctan2(c["y0"] - c["cy"], c["x0"] - c["cx"]),
        ux=(c["x1"] - c["x0"]) / size,
        uy=(c["y1"] - c["y0"]) / size,
        length=np.where(turn != 0, c["radius"] * c["sweep"], chord),
    )


def runs_back(outline: Sequence[Segment]) -> Lost | None:
    """Return which block runs back on the first one that another runs back on."""
    blocks = columns(outline)
    least: tuple[int, int, float, float] | None = None
    for share in SHARES:
        x, y, tx, ty = blocks.at(share)
        for i, j in _near_boxes((x, y, x, y), blocks.boxes(), ONE_LINE_UM):
            one, other = i[i != j], j[i != j]
            there = blocks.take(other)
            u, v = there.nearest(x[one], y[one])
            ux, uy = _heading_at(there, u, v)
            near = np.hypot(u - x[one], v - y[one]) <= ONE_LINE_UM
            near &= tx[one] * ux + ty[one] * uy < 0
            near &= np.abs(tx[one] * uy - ty[one] * ux) < BACK
            for k in np.flatnonzero(near).tolist():
                a, b = int(one[k]), int(other[k])
                if least is None or (a, b) < least[:2]:
                    least = a, b, float(x[a]), float(y[a])
    if least is None:
        return None
    return Lost("back", max(least[:2]), least[2:], min(least[:2]))


def _heading_at(s: Many, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return the heading of segment i at a place of it."""
    dx, dy = x - s.cx, y - s.cy
    size = np.hypot(dx, dy)
    size = np.where(size > 0, size, 1.0)
    arc = s.turn != 0
    return np.where(arc, -s.turn * dy / size, s.ux), np.where(arc, s.turn * dx / size, s.uy)


def comes_near(
    path: Sequence[Element], outline: Sequence[Segment], shifts: Sequence[float], before: float
) -> Lost | None:
    """Return the first block to which the wire comes nearer than the offset.

    Args:
        path: of the wire.
        outline: its blocks, um.
        shifts: of each block, um.
        before: the shift with which the first begins, um.
    """
    blocks, wire = columns(outline), columns([element.segment for element in path])
    own = np.array([element.block for element in path])
    size = np.abs(np.array(shifts, np.float64))
    least = np.minimum(size, np.concatenate([[abs(before)], size[:-1]]))
    limit = np.maximum(least[own] - NEARER_UM, 0.0)
    is_way = ways(blocks)
    # Of the first element that comes too near to blocks, the nearest of them.
    best: tuple[int, float, int, tuple[float, float]] | None = None
    for i, j in _near_boxes(wire.boxes(), blocks.boxes(), limit):
        bounds = (own[i] != j) & ~is_way[j] & (limit[i] > 0)
        i, j = i[bounds], j[bounds]
        gap, x, y = gaps(wire.take(i), blocks.take(j))
        for k in np.flatnonzero(gap < limit[i]).tolist():
            candidate = int(i[k]), float(gap[k]), int(j[k]), (float(x[k]), float(y[k]))
            if best is None or candidate < best:
                best = candidate
    if best is None:
        return None
    element, gap_um, other, at = best
    block = int(own[element])
    return Lost("near", max(block, other), at, min(block, other), gap_um)


def ways(blocks: Many) -> Bools:
    """Return which blocks are a way to the outline or away from it, and bound nothing.

    The first block where the outline comes by its end again, the last where it came by its start:
    the wire crosses it there for certain. Where the outline overlaps itself past a corner, its
    first and last block lie on blocks that it has already, and are such ways too.
    """
    n = len(blocks.x0)
    is_way = np.zeros(n, bool)
    if n < 4:
        return is_way
    for block, others, x, y in (
        (0, np.arange(2, n), blocks.x1[0], blocks.y1[0]),
        (n - 1, np.arange(n - 2), blocks.x0[-1], blocks.y0[-1]),
    ):
        far = blocks.take(others).distance(np.full(n - 2, x), np.full(n - 2, y))
        is_way[block] = bool((far <= ONE_LINE_UM).any())
    return is_way


def gaps(a: Many, b: Many) -> tuple[Floats, Floats, Floats]:
    """Return how near segment a[i] comes to b[i], um, and the middle between the two places.

    0 where they cross. Else one of the two places is an end; or, of an arc, where the line from
    the other's centre, or at right angles to the other line, passes through its centre.
    """
    n = len(a.x0)
    gap, x, y = np.full(n, np.inf), np.zeros(n), np.zeros(n)
    for one, other in ((a, b), (b, a)):
        for px, py in _places(one, other):
            qx, qy = other.nearest(px, py)
            size = np.hypot(px - qx, py - qy)
            better = size < gap
            gap = np.where(better, size, gap)
            x = np.where(better, 0.5 * (px + qx), x)
            y = np.where(better, 0.5 * (py + qy), y)
    for px, py in _meetings(a, b):
        cross = (a.distance(px, py) <= ON_UM) & (b.distance(px, py) <= ON_UM)
        gap, x, y = (np.where(cross, v, w) for v, w in ((0.0, gap), (px, x), (py, y)))
    return gap, x, y


def _places(s: Many, other: Many) -> Iterator[tuple[Floats, Floats]]:
    """Yield the places of segments that may be nearest to the others."""
    yield s.x0, s.y0
    yield s.x1, s.y1
    if not s.turn.any():
        return
    dx = np.where(other.turn != 0, other.cx - s.cx, -other.uy)
    dy = np.where(other.turn != 0, other.cy - s.cy, other.ux)
    far = np.hypot(dx, dy)
    far = np.where(far > 0, far, 1.0)
    for way in (1.0, -1.0):
        x, y = s.cx + way * s.radius * dx / far, s.cy + way * s.radius * dy / far
        on = (s.turn != 0) & (s.distance(x, y) <= ON_UM)
        yield np.where(on, x, s.x0), np.where(on, y, s.y0)


def _meetings(a: Many, b: Many) -> Iterator[tuple[Floats, Floats]]:
    """Yield the places at which the lines and circles of pairs meet, and others where they do not.

    Whoever takes them looks whether they are on both segments.
    """
    a_arc, b_arc = a.turn != 0, b.turn != 0
    with np.errstate(divide="ignore", invalid="ignore"):
        if (~a_arc & ~b_arc).any():
            sine = a.ux * b.uy - a.uy * b.ux
            far = ((b.x0 - a.x0) * b.uy - (b.y0 - a.y0) * b.ux) / sine
            yield _finite(a.x0 + far * a.ux, a.y0 + far * a.uy, ~a_arc & ~b_arc)
        for line, arc in ((a, b), (b, a)):
            mixed = (line.turn == 0) & (arc.turn != 0)
            if mixed.any():
                along = (arc.cx - line.x0) * line.ux + (arc.cy - line.y0) * line.uy
                x, y = line.x0 + along * line.ux, line.y0 + along * line.uy
                away = np.hypot(x - arc.cx, y - arc.cy)
                half = np.sqrt(np.maximum(arc.radius * arc.radius - away * away, 0.0))
                for way in (half, -half):
                    yield _finite(x + way * line.ux, y + way * line.uy, mixed)
        both = a_arc & b_arc
        if both.any():
            dx, dy = b.cx - a.cx, b.cy - a.cy
            apart = np.hypot(dx, dy)
            far = (apart * apart + a.radius * a.radius - b.radius * b.radius) / (2 * apart)
            half = np.sqrt(np.maximum(a.radius * a.radius - far * far, 0.0))
            for way in (half, -half):
                x = a.cx + (far * dx - way * dy) / apart
                y = a.cy + (far * dy + way * dx) / apart
                yield _finite(x, y, both)


def _finite(x: Floats, y: Floats, rows: Bools) -> tuple[Floats, Floats]:
    """Return places; of other than these rows, or where there is none, one far outside."""
    there = rows & np.isfinite(x) & np.isfinite(y)
    return np.where(there, x, 1e18), np.where(there, y, 1e18)


def _near_boxes(a: Boxes, b: Boxes, within: Floats | float) -> Iterator[tuple[Ints, Ints]]:
    """Yield (i, j) of boxes a[i] that come as near to b[j] as ``within``, many at a time.

    At most about `MOST_PAIRS`. Boxes of ``b`` of about one size lie on shelves as high as that, by
    their lower edge, from left to right on each. Whoever reaches a shelf, or the one above it,
    looks along it from so far left.
    """
    left, low = a[0] - within, a[1] - within
    right, high = a[2] + within, a[3] + within
    size = np.maximum(np.maximum(b[2] - b[0], b[3] - b[1]), 1.0)
    group = np.ceil(np.log2(size)).astype(np.int64)
    group = np.maximum(group, np.ceil(np.log2(np.median(size))).astype(np.int64))
    for power in np.unique(group).tolist():
        step = 2.0**power
        of_b = np.flatnonzero(group == power)
        bottom, side = float(b[1].min()), float(min(b[0].min(), left.min()))
        shelf = np.floor((b[1][of_b] - bottom) / step)
        # One key for shelf and left edge: shelves lie one behind the other.
        width = 2.0 * (float(max(b[2].max(), right.max())) - side) + 4.0 * step
        key = shelf * width + (b[0][of_b] - side)
        order = np.argsort(key)
        key, of_b = key[order], of_b[order]
        first = np.floor((low - bottom) / step) - 1
        last = np.floor((high - bottom) / step)
        first, last = np.maximum(first, 0), np.minimum(last, shelf.max())
        of_a, k = _counted(np.maximum(last - first + 1, 0).astype(np.int64))
        at = (first[of_a] + k) * width
        blur = 1e-15 * float(key[-1]) + 1e-6
        begin = np.searchsorted(key, at + np.maximum(left[of_a] - side - step, 0.0) - blur)
        end = np.searchsorted(key, at + (right[of_a] - side) + blur, "right")
        total = np.cumsum(end - begin)
        done = 0
        while done < len(of_a):
            before = int(total[done - 1]) if done else 0
            stop = max(done + 1, int(np.searchsorted(total, before + MOST_PAIRS, "right")))
            row, m = _counted((end - begin)[done:stop])
            i, j = of_a[done + row], of_b[begin[done + row] + m]
            near = (left[i] <= b[2][j]) & (b[0][j] <= right[i])
            near &= (low[i] <= b[3][j]) & (b[1][j] <= high[i])
            yield i[near], j[near]
            done = stop


def _counted(count: Ints) -> tuple[Ints, Ints]:
    """Return (row, k) for each k from 0 to before count[row]."""
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)

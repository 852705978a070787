"""Contours in compensation data: what is outline, what is lead, and where outwards is.

The data are blocks in a row. Between two moves the wire cuts one chain of them: a contour, closed
or open, with a lead line before and behind it or without. Nothing in the format says which it is
[R]: a first or last line is a lead where the contour closes without it. On which side the outline
grows outwards, arcs say by their type; contours of lines alone do not: an outer contour grows away
from its inside, one that lies in another is a hole and grows into it [R].
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.scaling import scale
from wedmcam.ir.program import Kind

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

#: A contour is closed where it ends within this and a um for each of its arcs from its start: what
#: stepping leaves open in data that close on paper.
OPEN_UM = 2.0


@dataclass(frozen=True, slots=True)
class Places:
    """Where stated blocks start and end as stepped, whole um, and their arcs.

    Attributes:
        start, end: shape (n, 2); controls stay where they are.
        centre: of arcs, shape (n, 2).
        sweep: of arcs, degrees, above 0.
    """

    start: Ints
    end: Ints
    centre: Ints
    sweep: Floats


@dataclass(frozen=True, slots=True)
class Chain:
    """Blocks that are cut in one go.

    Attributes:
        body: numbers of the blocks of the outline, in order.
        closed: how many of them make a closed contour, 0 where it is open; more are cut twice.
        lead_in, lead_out: numbers of the lead lines, -1 without one.
        off_um: how far from its start the contour ends.
    """

    body: Ints
    closed: int = 0
    lead_in: int = -1
    lead_out: int = -1
    off_um: float = 0.0


@dataclass(slots=True)
class Sides:
    """Where outwards is: a number a chain, +1 to the left of the path, -1 to the right, 0 unknown.

    Attributes:
        outwards: the numbers.
        by_nesting: chains of lines alone, with whether they are holes.
        contradicting: a block of each chain whose arcs do not agree, and one that differs.
        doubtful: chains of lines alone, where arcs of another contour contradict how that lies.
    """

    outwards: list[int] = field(default_factory=list)
    by_nesting: dict[int, bool] = field(default_factory=dict)
    contradicting: list[tuple[int, int]] = field(default_factory=list)
    doubtful: list[int] = field(default_factory=list)


def places_of(figure: NDArray[np.void]) -> Places:
    """Return where the blocks of an outline (dtype `OUTLINE`) start and end with a gap of 0.

    The first starts at (0, 0).

    >>> from wedmcam.controllers.zd065.data import OUTLINE
    >>> f = np.zeros(2, OUTLINE)
    >>> f[0] = (Kind.LINE, 0, 0, 0, 0, 100, 0, 0)
    >>> f[1] = (Kind.ARC, 1, 1, 2, 50, 0, -50, 71)
    >>> p = places_of(f)
    >>> p.end.tolist(), p.centre[1].tolist(), round(float(p.sweep[1]), 2)
    ([[100, 0], [149, 51]], [100, 50], 91.17)
    """
    blocks = scale(figure, 0)
    motion = MIRROR.run(blocks)
    moved = np.stack([motion.dx, motion.dy], axis=1)
    end = np.cumsum(moved, axis=0)
    start = end - moved
    arc = figure["kind"] == Kind.ARC
    radial = np.stack([figure["x"], figure["y"]], axis=1).astype(np.int64)
    centre = np.where(arc[:, None], start - radial, 0)
    late = end - centre
    turn = np.where(arc, figure["turn"], 1)
    angle = np.arctan2(late[:, 1], late[:, 0]) - np.arctan2(radial[:, 1], radial[:, 0])
    sweep = np.degrees(turn * angle) % 360.0
    whole = MIRROR.turn_steps(np.hypot(radial[:, 0], radial[:, 1]))
    turns = np.floor(motion.steps / np.maximum(whole, 1.0) - sweep / 360.0 + 0.5)
    return Places(start, end, centre, np.where(arc, sweep + 360.0 * np.maximum(turns, 0), 0.0))


def chains_of(figure: NDArray[np.void], places: Places) -> list[Chain]:
    """Return the chains of an outline, in the order of cutting."""
    kind = figure["kind"]
    cutting = (kind == Kind.LINE) | (kind == Kind.ARC)
    rows = np.flatnonzero(cutting)
    if not len(rows):
        return []
    moves = np.cumsum(kind == Kind.MOVE)[rows]
    controls = np.cumsum(~cutting)[rows]
    out: list[Chain] = []
    for run in np.split(rows, np.flatnonzero(np.diff(moves)) + 1):
        parts = np.split(run, np.flatnonzero(np.diff(controls[np.isin(rows, run)])) + 1)
        several = [_chain(part, kind, places) for part in parts]
        # A pause in a contour parts nothing; one between two contours has a lead on either side.
        if all(c.closed and c.lead_in >= 0 and c.lead_out >= 0 for c in several):
            out += several
        else:
            out.append(_chain(run, kind, places))
    return out


def _chain(rows: Ints, kind: NDArray[np.uint8], places: Places) -> Chain:
    """Return the chain that some cutting blocks make."""
    n = len(rows)
    at = np.concatenate([places.start[rows[:1]], places.end[rows]]).astype(float)
    arcs = kind[rows] == Kind.ARC
    line_first, line_last = not arcs[0], not arcs[-1]
    room = OPEN_UM + np.count_nonzero(arcs)

    def off(i: int, j: int) -> float:
        return float(np.hypot(*(at[i] - at[j])))

    first, last = int(rows[0]), int(rows[-1])
    if n >= 3 and line_first and line_last and off(1, n - 1) <= room:
        return Chain(rows[1:-1], n - 2, first, last, off(1, n - 1))
    if off(0, n) <= room:
        return Chain(rows, n, off_um=off(0, n))
    if n >= 2 and line_first and off(1, n) <= room:
        return Chain(rows[1:], n - 1, first, -1, off(1, n))
    if n >= 2 and line_last and off(0, n - 1) <= room:
        return Chain(rows[:-1], n - 1, -1, last, off(0, n - 1))
    if n >= 4 and line_first and line_last:
        # A contour that is cut on past its start, along its first blocks, before the wire leaves.
        again = np.flatnonzero(np.hypot(*(at[2 : n - 1] - at[1]).T) <= room)
        if len(again):
            closed = int(again[0]) + 1
            return Chain(rows[1:-1], closed, first, last, off(1, closed + 1))
    return Chain(rows)


def sides_of(figure: NDArray[np.void], places: Places, chains: list[Chain]) -> Sides:
    """Return on which side of its path each chain has its outwards."""
    sides = Sides()
    rings = [_ring(figure, places, c) if c.closed else None for c in chains]
    by_place = [0] * len(chains)
    holes = [False] * len(chains)
    for k, ring in enumerate(rings):
        if ring is None:
            continue
        x, y = ring.T
        area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        around = sum(
            inside(ring[0], other) for m, other in enumerate(rings) if m != k and other is not None
        )
        holes[k] = around % 2 == 1
        by_place[k] = (-1 if area > 0 else 1) * (-1 if holes[k] else 1)
    typed = False
    for k, chain in enumerate(chains):
        arcs = chain.body[figure["kind"][chain.body] == Kind.ARC]
        said = -(figure["turn"][arcs].astype(int) * figure["grows"][arcs])
        if len(arcs):
            sides.outwards.append(int(said[0]))
            other = np.flatnonzero(said != said[0])
            if len(other):
                sides.contradicting.append((int(arcs[0]), int(arcs[other[0]])))
            typed |= bool(by_place[k] and by_place[k] != said[0])
        else:
            sides.outwards.append(by_place[k])
            sides.by_nesting[k] = holes[k]
    if typed:
        sides.doubtful = list(sides.by_nesting)
    return sides


def _ring(figure: NDArray[np.void], places: Places, chain: Chain) -> Floats:
    """Return a closed contour as a polygon: vertices, and three places on each arc, um."""
    points: list[Floats] = []
    for row in chain.body[: chain.closed].tolist():
        points.append(places.start[row].astype(float)[None])
        if figure["kind"][row] == Kind.ARC:
            centre = places.centre[row].astype(float)
            rx, ry = places.start[row] - centre
            angle = np.radians(places.sweep[row]) * int(figure["turn"][row]) * np.arange(1, 8) / 8
            c, s = np.cos(angle), np.sin(angle)
            points.append(centre + np.stack([c * rx - s * ry, s * rx + c * ry], axis=1))
    return np.concatenate(points)


def inside(point: Floats, ring: Floats) -> bool:
    """Return whether a place lies in a polygon."""
    (px, py), (x, y) = point, ring.T
    nx, ny = np.roll(x, -1), np.roll(y, -1)
    spans = (y > py) != (ny > py)
    at = x + (py - y) / np.where(spans, ny - y, 1.0) * (nx - x)
    return bool(np.count_nonzero(spans & (at > px)) % 2)

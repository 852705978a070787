"""From the raw offset to loops: cut at crossings, keep what is far enough, stitch by identity.

The path of the wire is exactly the part of the raw elements that is at least the offset away from
every drawn segment (a point of an element whose nearest drawn point is not its own foot is nearer).
So elements are cut at all their crossings, each piece is kept or dropped by the distance of its
middle, and the kept pieces are stitched at the crossing, a *node*, at which both were cut. Nothing
is stitched by nearness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import crossings, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints
from wedmcam.transforms.compensate.raw import Raw, Source

#: Crossings and ends this near are one node; um. Far above float64 noise, far below the grid.
NODE_UM = 2e-3
#: How much nearer than the offset a kept piece may be; um. Joints that met in the middle need it.
NEAR_UM = 0.01
#: A loose end this near to another element touches it: nearly tangent, they need not cross; um.
TOUCH_UM = 0.06
#: Loops thinner than this (area over length) are no cut; um.
SLIVER_UM = 0.02
#: Crossings this near to the point at which two neighbours are joined anyway are that point; um.
JOINT_UM = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """Pieces stitched into loops (or one open run per open contour).

    Attributes:
        loops: for each loop the pieces in order of travel, indices into the columns below.
        closed: for each loop.
        element, at0, at1: piece k runs on element[k] from arc length at0[k] to at1[k].
        node0, node1: the nodes it runs between.
        node_x, node_y: where nodes are, um relative to the origin.
        node_i, node_j: the two elements that a crossing node lies on, -1 for an end or joint.
        lost: pieces that should have found a partner and did not; not empty means 'do not trust'.
        lost_at: where they are, shape (n, 2).
    """

    loops: list[list[int]]
    closed: list[bool]
    element: Ints
    at0: Floats
    at1: Floats
    node0: Ints
    node1: Ints
    node_x: Floats
    node_y: Floats
    node_i: Ints
    node_j: Ints
    lost: Ints
    lost_at: NDArray[np.float64]


def resolve(source: Source, raw: Raw, near_um: float = NEAR_UM, node_um: float = NODE_UM) -> Loops:
    """Return the loops of the wire path, exact up to float64, as pieces of raw elements."""
    e = raw.elements
    n = len(e)
    # Nodes 0..n-1: the end of element i, shared with the start of the following where joined.
    # Nodes n..2n-1: the start of element i where it is not.
    ends = np.arange(n)
    starts = np.arange(n, 2 * n)
    joined = np.flatnonzero(raw.joined)
    starts[raw.following[joined]] = joined
    x = np.concatenate([e.x1, e.x0])
    y = np.concatenate([e.y1, e.y0])

    c = _crossings(raw)
    if len(c.i) == 0 and len(joined) == n and not len(raw.vanished):
        return _whole(raw, starts, ends, x, y)

    m = len(c.i)
    node_x, node_y = np.concatenate([x, c.x]), np.concatenate([y, c.y])
    used = np.ones(2 * n, bool)
    used[n:] = starts == np.arange(n, 2 * n)
    label = _merged(node_x, node_y, np.concatenate([used, np.ones(m, bool)]), node_um)
    crossing = np.arange(2 * n, 2 * n + m)

    touched, touched_at, touching = _touches(raw, starts, ends, x, y)

    # Cut: one row per (element, position, node), sorted; neighbours in it bound a piece.
    of = np.concatenate([ends, ends, c.i, c.j, touched])
    at = np.concatenate([np.zeros(n), e.length, c.at_i, c.at_j, touched_at])
    node = label[np.concatenate([starts, ends, crossing, crossing, touching])]
    rank = np.concatenate([np.zeros(n), np.full(n, 2), np.ones(2 * m + len(touched))])
    order = np.lexsort((rank, at, of))
    of, at, node = of[order], at[order], node[order]
    same = of[1:] == of[:-1]
    element, at0, at1 = of[:-1][same], at[:-1][same], at[1:][same]
    node0, node1 = node[:-1][same], node[1:][same]
    real = (node0 != node1) | (at1 - at0 > JOINT_UM)
    element, at0, at1, node0, node1 = (a[real] for a in (element, at0, at1, node0, node1))

    clear = _clearance(source, raw, element, 0.5 * (at0 + at1))
    keep = np.flatnonzero(clear >= -near_um)
    element, at0, at1, node0, node1, clear = (
        a[keep] for a in (element, at0, at1, node0, node1, clear)
    )
    terminal_starts = label[starts[_run_starts(raw)]]
    terminal_ends = label[ends[raw.following < 0]]
    alive = _without_doubles(raw, element, at0, at1, node0, node1, clear)
    alive, lost = _without_dead_ends(
        node0, node1, clear, at1 - at0, alive, terminal_starts, terminal_ends, len(node_x)
    )
    loops, closed, stray = _stitch(
        raw, element, at0, at1, node0, node1, alive, terminal_starts, source
    )
    stray = stray[(clear[stray] > -1e-6) & (at1[stray] - at0[stray] > 0.1)]
    lost = np.concatenate([lost, stray])
    mid = seg.points_at(e.take(element[lost]), 0.5 * (at0[lost] + at1[lost]))
    node_i = np.full(len(node_x), -1)
    node_j = np.full(len(node_x), -1)
    node_i[label[crossing]], node_j[label[crossing]] = c.i, c.j
    # A crossing merged with the end of an element is that joint.
    plain = label[np.concatenate([starts[used[n:]], ends])]
    node_i[plain] = node_j[plain] = -1
    found = Loops(
        loops,
        closed,
        element,
        at0,
        at1,
        node0,
        node1,
        node_x,
        node_y,
        node_i,
        node_j,
        lost,
        np.column_stack(mid),
    )
    return _without_slivers(raw, found)


def _run_starts(raw: Raw) -> Ints:
    """Return the first element of each open run (they follow none)."""
    follows = np.zeros(len(raw.following), bool)
    follows[raw.following[raw.following >= 0]] = True
    return np.flatnonzero(~follows)


def _whole(raw: Raw, starts: Ints, ends: Ints, x: Floats, y: Floats) -> Loops:
    """Return the raw offset as it is: nothing vanished and nothing crosses."""
    n = len(ends)
    first = np.flatnonzero(np.append(True, raw.contour[1:] != raw.contour[:-1])) if n else []
    loops = [list(range(a, b)) for a, b in zip(first, [*first[1:], n], strict=True)]
    none = np.full(2 * n, -1)
    found = Loops(
        loops,
        [True] * len(loops),
        np.arange(n),
        np.zeros(n),
        raw.elements.length,
        starts,
        ends,
        x,
        y,
        none,
        none,
        np.empty(0, np.int64),
        np.empty((0, 2)),
    )
    return _without_slivers(raw, found)


def _crossings(raw: Raw) -> crossings.Crossings:
    """Return all crossings of elements, but for the joints of neighbours with themselves."""
    e = raw.elements
    i, j = pairs.self_overlapping(pairs.grown(seg.boxes(e), crossings.REACH))
    after = raw.joined[i] & (raw.following[i] == j)
    before = raw.joined[j] & (raw.following[j] == i)
    neighbours = after | before
    # Joined neighbours can meet again only when they turn by half a circle between them.
    far = ~neighbours | (e.sweep[i] + e.sweep[j] > 3.0)
    i, j = i[far], j[far]
    c = crossings.between(e, i, j)
    after = raw.joined[c.i] & (raw.following[c.i] == c.j)
    before = raw.joined[c.j] & (raw.following[c.j] == c.i)
    if not (after.any() or before.any()):
        return c
    length = e.length
    trivial = after & (length[c.i] - c.at_i < JOINT_UM) & (c.at_j < JOINT_UM)
    trivial |= before & (length[c.j] - c.at_j < JOINT_UM) & (c.at_i < JOINT_UM)
    k = ~trivial
    return crossings.Crossings(c.i[k], c.j[k], c.at_i[k], c.at_j[k], c.x[k], c.y[k])


def _touches(
    raw: Raw, starts: Ints, ends: Ints, x: Floats, y: Floats
) -> tuple[Ints, Floats, Ints]:
    """Return (element, position, node): loose ends that lie on another element, nearly."""
    n = len(ends)
    loose = np.concatenate([ends[~raw.joined], starts[starts >= n]])
    px, py = x[loose], y[loose]
    boxes = pairs.grown(seg.boxes(raw.elements), TOUCH_UM)
    i, j = pairs.overlapping((px, py, px, py), boxes)
    e = raw.elements.take(j)
    at = seg.position_of(e, px[i], py[i])
    near = (seg.distances(e, px[i], py[i]) <= TOUCH_UM) & (at > TOUCH_UM)
    near &= at < e.length - TOUCH_UM
    return j[near], at[near], loose[i[near]]


def _merged(x: Floats, y: Floats, used: NDArray[np.bool_], node_um: float) -> Ints:
    """Return for each node the representative of the cluster of nodes that it coincides with."""
    label = np.arange(len(x))
    rows = np.flatnonzero(used)
    px, py = x[rows], y[rows]
    i, j = pairs.self_overlapping(pairs.grown((px, py, px, py), 0.5 * node_um))
    near = np.hypot(px[i] - px[j], py[i] - py[j]) <= node_um
    i, j = rows[i[near]], rows[j[near]]
    while True:  # labels flow to the smallest; clusters are tiny, so this takes a pass or two
        low = np.minimum(label[i], label[j])
        before = label.copy()
        np.minimum.at(label, i, low)
        np.minimum.at(label, j, low)
        label = label[label]
        if (label == before).all():
            return label


def _clearance(source: Source, raw: Raw, element: Ints, at: Floats) -> Floats:
    """Return by how much a point of each piece is farther than the offset from all segments."""
    x, y = seg.points_at(raw.elements.take(element), at)
    offset = np.abs(source.shift[raw.source[element]])
    reach = float(offset.max()) if len(offset) else 0.0
    drawn = pairs.grown(seg.boxes(source.segments), reach)
    result = np.full(len(x), np.inf)
    step = max(1, 2_000_000 // max(1, len(drawn[0]) // 50 + 16))
    for a in range(0, len(x), step):
        b = slice(a, a + step)
        i, j = pairs.overlapping((x[b], y[b], x[b], y[b]), drawn)
        d = seg.distances(source.segments.take(j), x[b][i], y[b][i])
        np.minimum.at(result[b], i, d)
    return result - offset


def _without_doubles(
    raw: Raw,
    element: Ints,
    at0: Floats,
    at1: Floats,
    node0: Ints,
    node1: Ints,
    clear: Floats,
) -> NDArray[np.bool_]:
    """Return which pieces stay when of pieces that run beside each other only one does."""
    alive = np.ones(len(element), bool)
    order = np.lexsort((-clear, node1, node0))
    same = (node0[order][1:] == node0[order][:-1]) & (node1[order][1:] == node1[order][:-1])
    rows = np.flatnonzero(same)
    if len(rows):
        a, b = order[rows], order[rows + 1]
        e = raw.elements
        ax, ay = seg.points_at(e.take(element[a]), 0.5 * (at0[a] + at1[a]))
        bx, by = seg.points_at(e.take(element[b]), 0.5 * (at0[b] + at1[b]))
        beside = np.hypot(ax - bx, ay - by) < 5 * NEAR_UM
        alive[b[beside]] = False
    return alive


def _without_dead_ends(
    node0: Ints,
    node1: Ints,
    clear: Floats,
    length: Floats,
    alive: NDArray[np.bool_],
    terminal_starts: Ints,
    terminal_ends: Ints,
    nodes: int,
) -> tuple[NDArray[np.bool_], Ints]:
    """Drop pieces that lead nowhere; return the rest, and those dropped that were clear of all.

    Pieces that dip into the forbidden zone by less than the tolerance were kept and lead nowhere:
    that is expected. A piece that does not dip and leads nowhere is a crossing that was missed.
    """
    alive = alive.copy()
    lost = np.zeros(len(alive), bool)
    while True:
        entered = np.bincount(node1[alive], minlength=nodes)
        left = np.bincount(node0[alive], minlength=nodes)
        entered[terminal_starts] += 1
        left[terminal_ends] += 1
        dead = alive & ((entered[node0] == 0) | (left[node1] == 0))
        if not dead.any():
            return alive, np.flatnonzero(lost)
        lost |= dead & (clear > -1e-6) & (length > 0.1)
        alive &= ~dead


def _stitch(
    raw: Raw,
    element: Ints,
    at0: Floats,
    at1: Floats,
    node0: Ints,
    node1: Ints,
    alive: NDArray[np.bool_],
    terminal_starts: Ints,
    source: Source,
) -> tuple[list[list[int]], list[bool], Ints]:
    """Follow the pieces from node to node; return loops, which are closed, and strays."""
    rows = np.flatnonzero(alive)
    out: dict[int, list[int]] = {}
    for k, node in zip(rows.tolist(), node0[rows].tolist(), strict=True):
        out.setdefault(node, []).append(k)
    end = node1.tolist()
    tx0 = ty0 = tx1 = ty1 = np.empty(0)
    if any(len(v) > 1 for v in out.values()):
        e = raw.elements.take(element)
        tx0, ty0 = seg.tangents_at(e, at0)
        tx1, ty1 = seg.tangents_at(e, at1)
    shift = source.shift[raw.source[element]]

    def leave(k: int, node: int) -> int | None:
        """Return the piece that goes on from piece k: where several do, the sharpest turn.

        The free side is the side the wire was shifted to; turning sharpest to it stays at the
        border of one free region, so loops that touch are split.
        """
        choices = out.get(node)
        if not choices:
            return None
        if len(choices) == 1:
            return choices.pop()
        sign = 1.0 if shift[k] >= 0 else -1.0

        def turn(c: int) -> float:
            cross = tx1[k] * ty0[c] - ty1[k] * tx0[c]
            dot = tx1[k] * tx0[c] + ty1[k] * ty0[c]
            angle = float(np.arctan2(cross, dot)) * sign
            # Straight back counts as the least, not the most, turn to the free side.
            return angle if angle < np.pi - 1e-6 else -angle

        best = max(choices, key=lambda c: (turn(c), -c))
        choices.remove(best)
        return best

    loops: list[list[int]] = []
    closed: list[bool] = []
    stray: list[int] = []
    heads = [k for node in terminal_starts.tolist() for k in out.get(node, [])]
    head_set = set(heads)
    taken = np.zeros(len(element), bool)
    for first in [*heads, *rows.tolist()]:
        if taken[first]:
            continue
        begin = int(node0[first])
        out[begin].remove(first)
        run = [first]
        here = end[first]
        while here != begin or first in head_set:
            nxt = leave(run[-1], here)
            if nxt is None:
                break
            run.append(nxt)
            here = end[nxt]
        taken[run] = True
        if first in head_set:
            loops.append(run)
            closed.append(False)
        elif here == begin:
            loops.append(run)
            closed.append(True)
        else:
            stray += run
    return loops, closed, np.array(stray, np.int64)


def _without_slivers(raw: Raw, found: Loops) -> Loops:
    """Drop loops without a width: coincident walls run along once in each direction."""
    keep, closed = [], []
    for loop, is_closed in zip(found.loops, found.closed, strict=True):
        if is_closed:
            area, length = _area_and_length(raw, found, np.array(loop))
            if abs(area) < SLIVER_UM * length:
                continue
        keep.append(loop)
        closed.append(is_closed)
    found.loops[:] = keep
    found.closed[:] = closed
    return found


def _area_and_length(raw: Raw, found: Loops, loop: Ints) -> tuple[float, float]:
    """Return the signed area (um^2) and the length (um) of one closed loop."""
    e = raw.elements.take(found.element[loop])
    at0, at1 = found.at0[loop], found.at1[loop]
    x0, y0 = seg.points_at(e, at0)
    x1, y1 = seg.points_at(e, at1)
    r = np.where(e.radius > 0, e.radius, 1.0)
    sweep = np.where(e.turn != 0, e.turn * (at1 - at0) / r, 0.0)
    lune = 0.5 * e.radius**2 * (sweep - np.sin(sweep))
    return float(np.sum(0.5 * (x0 * y1 - x1 * y0) + lune)), float(np.sum(at1 - at0))

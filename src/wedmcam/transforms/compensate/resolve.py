"""From the raw offset to loops: cut at crossings, keep what is far enough, stitch by identity.

The path of the wire is exactly the part of the raw elements that is at least the offset away from
every drawn segment (a point of an element whose nearest drawn point is not its own foot is nearer).
So elements are cut at all their crossings, each piece is kept or dropped by the distance of its
middle, and the kept pieces are stitched at the crossing, a *node*, at which both were cut. Nothing
is stitched by nearness.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import crossings, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints
from wedmcam.transforms.compensate import overrun
from wedmcam.transforms.compensate.raw import Raw, Source
from wedmcam.transforms.compensate.untangle import on_free_side

#: Crossings and ends this near are one node; um. Far above float64 noise, far below the grid.
NODE_UM = 2e-3
#: Loops thinner than this (area over length) are no cut; um.
SLIVER_UM = 0.01
#: A loop that is nowhere wider than this is no cut: on the grid of the machine little more than
#: one place would be left of it; um.
NO_CUT_UM = 1.5
#: Longer loops are wider; um.
SHORT_UM = 8.0 * NO_CUT_UM
#: Pieces of opposite direction this near to each other are the two walls of one slot; um.
SLOT_WALLS_UM = 0.02
#: Crossings this near to the point at which two neighbours are joined anyway are that point; um.
JOINT_UM = 1.0
#: A piece that is clear of everything and longer than this must not get lost; um.
LOST_UM = 0.1
#: So many pieces to an element are many: most of them are too near to the drawing.
CROWDED = 4
#: How many pairs of a point and a segment are looked at at once: some 100 MB.
POINT_PAIRS = 500_000


@dataclass(frozen=True, slots=True)
class Limits:
    """How exactly things are taken to be equal, um.

    Attributes:
        near: how much nearer than the offset a kept piece may be, besides the slack of its element.
        touch: a loose end this near to another element touches it: nearly tangent, they need not
            cross.
    """

    near: float = 1e-6
    touch: float = 2e-3


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
        walls: elements that run along each other in opposite directions: a slot or neck as wide as
            the wire. Both were dropped there.
        whole: nothing crosses and nothing vanished: each contour has one loop of all its elements.
        areas: signed area of each loop, um^2; 0 for an open one.
    """

    loops: list[Ints]
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
    walls: Ints
    whole: bool = False
    areas: list[float] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Elements cut at all their nodes; columns as in `Loops`, and how far clear of the drawing."""

    element: Ints
    at0: Floats
    at1: Floats
    node0: Ints
    node1: Ints
    clear: Floats

    def take(self, index: Ints | NDArray[np.bool_]) -> _Pieces:
        return _Pieces(*(getattr(self, name)[index] for name in self.__slots__))


def resolve(source: Source, raw: Raw, limits: Limits) -> Loops:
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

    certain = limits.near + 2.0 * NODE_UM
    left_low, left_high = overrun.left_over(source, raw, certain)
    c = _crossings(raw, left_low, left_high)
    if len(c.i) == 0 and len(joined) == n and not len(raw.vanished):
        return _whole(source, raw, starts, ends, x, y)

    m = len(c.i)
    node_x, node_y = np.concatenate([x, c.x]), np.concatenate([y, c.y])
    used = np.ones(2 * n + m, bool)
    used[n : 2 * n] = starts >= n
    label = _merged(node_x, node_y, used)
    crossing = np.arange(2 * n, 2 * n + m)
    touched, touched_at, touching = _touches(raw, starts, ends, x, y, limits.touch)

    # Cut: one row per (element, position, node), sorted; neighbours in it bound a piece.
    of = np.concatenate([ends, ends, c.i, c.j, touched])
    at = np.concatenate([np.zeros(n), e.length, c.at_i, c.at_j, touched_at])
    node = label[np.concatenate([starts, ends, crossing, crossing, touching])]
    rank = np.concatenate([np.zeros(n), np.full(n, 2), np.ones(2 * m + len(touched))])
    order = np.lexsort((rank, at, of))
    of, at, node = of[order], at[order], node[order]
    real = of[1:] == of[:-1]
    real &= (node[:-1] != node[1:]) | (at[1:] - at[:-1] > JOINT_UM)
    k = np.flatnonzero(real)
    element, at0, at1, node0, node1 = of[k], at[k], at[k + 1], node[k], node[k + 1]
    middle = 0.5 * (at0 + at1)
    clear = np.full(len(element), -2.0 * certain - 4.0 * float(raw.slack.max(initial=0.0)))
    free = np.flatnonzero((middle >= left_low[element]) & (middle <= left_high[element]))
    if len(free) > CROWDED * n:
        of = raw.source[element[free]]
        near = overrun.near_family(source, of, *seg.points_at(e.take(element[free]), middle[free]))
        slack = limits.near + 2.0 * raw.slack[element[free]]
        free = free[near >= np.abs(source.shift[of]) - slack]
    clear[free] = _clearance(source, raw, element[free], middle[free])
    kept = clear >= -limits.near - 2.0 * raw.slack[element]
    p = _Pieces(element, at0, at1, node0, node1, clear).take(kept)

    p, walls = _without_doubles(raw, p)
    terminal_starts = label[starts[_run_starts(raw)]]
    terminal_ends = label[ends[raw.following < 0]]
    alive, lost = _without_dead_ends(p, terminal_starts, terminal_ends, len(node_x))
    loops, closed, stray = _stitch(raw, source, p, alive, terminal_starts)
    stray = stray[(p.clear[stray] > -1e-6) & (p.at1[stray] - p.at0[stray] > LOST_UM)]
    lost = np.concatenate([lost, stray])
    lost = lost[~_beside_open(raw, p.element[lost])]
    lost = lost[_free(source, raw, p, lost)]
    mid = seg.points_at(e.take(p.element[lost]), 0.5 * (p.at0[lost] + p.at1[lost]))
    node_i = np.full(len(node_x), -1)
    node_j = np.full(len(node_x), -1)
    node_i[label[crossing]], node_j[label[crossing]] = c.i, c.j
    # A crossing merged with the end of an element is that joint.
    plain = label[np.concatenate([starts[starts >= n], ends])]
    node_i[plain] = node_j[plain] = -1
    found = Loops(
        loops,
        closed,
        p.element,
        p.at0,
        p.at1,
        p.node0,
        p.node1,
        node_x,
        node_y,
        node_i,
        node_j,
        lost,
        np.column_stack(mid),
        walls,
    )
    return _judge_loops(raw, _without_slivers(source, raw, found))


def _judge_loops(raw: Raw, loops: Loops) -> Loops:
    """Return the loops, the first pieces of those that do not turn once round marked as lost.

    A loop that crosses itself is wrong, however well its pieces fit together.
    """
    if len(loops.lost) or not loops.loops:
        return loops
    k = np.concatenate(loops.loops)
    size = np.array([len(loop) for loop in loops.loops], np.int64)
    begin = np.cumsum(size) - size
    after = np.arange(1, len(k) + 1)
    after[begin + size - 1] = begin
    e = raw.elements.take(loops.element[k])
    at0, at1 = loops.at0[k], loops.at1[k]
    t0x, t0y = seg.tangents_at(e, at0)
    t1x, t1y = seg.tangents_at(e, at1)
    n0x, n0y = t0x[after], t0y[after]
    turn = np.arctan2(t1x * n0y - t1y * n0x, t1x * n0x + t1y * n0y)
    arc = np.where(e.turn != 0, (at1 - at0) * e.turn / np.where(e.turn != 0, e.radius, 1.0), 0.0)
    total = np.abs(np.add.reduceat(arc + turn, begin))
    # Straight back may be to the left or to the right.
    back = np.maximum.reduceat(np.abs(turn), begin) > np.pi - 1e-3
    wrong = np.array(loops.closed, bool) & ~back & (np.abs(total - seg.TAU) > 0.1)
    if not wrong.any():
        return loops
    lost = k[begin[wrong]]
    where = np.column_stack([loops.node_x[loops.node0[lost]], loops.node_y[loops.node0[lost]]])
    return replace(loops, lost=lost, lost_at=where)


def _free(source: Source, raw: Raw, p: _Pieces, which: Ints) -> NDArray[np.bool_]:
    """Return which pieces lie on the side of their contour that the wire was shifted to.

    Where a drawing crosses itself within a micron, arcs about a corner reach to the other side.
    """
    free = np.ones(len(which), bool)
    # The first lost piece decides whether there is a next attempt, so few are enough.
    contour = raw.contour[p.element[which]]
    for k in np.flatnonzero(raw.transition[p.element[which]])[:20].tolist():
        one = which[k : k + 1]
        x, y = seg.points_at(raw.elements.take(p.element[one]), 0.5 * (p.at0[one] + p.at1[one]))
        free[k] = on_free_side(source, int(contour[k]), x, y)[0]
    return free


def _beside_open(raw: Raw, element: Ints) -> NDArray[np.bool_]:
    """Return which elements belong to open contours, whose ends may lie where no wire fits."""
    is_open = np.zeros(int(raw.contour.max(initial=0)) + 1, bool)
    is_open[raw.contour[raw.following < 0]] = True
    result: NDArray[np.bool_] = is_open[raw.contour[element]]
    return result


def _run_starts(raw: Raw) -> Ints:
    """Return the first element of each open run (they follow none)."""
    follows = np.zeros(len(raw.following), bool)
    follows[raw.following[raw.following >= 0]] = True
    return np.flatnonzero(~follows)


def _whole(source: Source, raw: Raw, starts: Ints, ends: Ints, x: Floats, y: Floats) -> Loops:
    """Return the raw offset as it is: nothing vanished and nothing crosses."""
    n = len(ends)
    first = np.flatnonzero(np.append(True, raw.contour[1:] != raw.contour[:-1])[:n])
    loops = [np.arange(a, b) for a, b in zip(first, [*first[1:], n], strict=True)]
    every = len(loops)
    if len(loops) > 1:
        # Without a crossing each loop is clear of the other contours in whole or not at all.
        clear = _clearance(source, raw, first, 0.5 * raw.elements.length[first])
        kept = clear >= -1e-6 - 2.0 * raw.slack[first]
        loops = [loop for loop, k in zip(loops, kept.tolist(), strict=True) if k]
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
        np.empty(0, np.int64),
        len(loops) == every,
    )
    return _without_slivers(source, raw, found)


_CROSSING = ("i", "j", "at_i", "at_j", "x", "y")


def _crossings(raw: Raw, low: Floats, high: Floats) -> crossings.Crossings:
    """Return the crossings of elements between low and high.

    The joints of neighbours with themselves are none.
    """
    e = raw.elements
    kept, boxes = overrun.boxes(e, low, high)
    i, j = (kept[k] for k in pairs.self_overlapping(pairs.grow(boxes, crossings.REACH)))
    after = raw.joined[i] & (raw.following[i] == j)
    before = raw.joined[j] & (raw.following[j] == i)
    neighbours = after | before
    # Joined neighbours can meet again only when they turn by half a circle between them.
    bend = np.where(after, raw.bend[i], raw.bend[j])
    far = ~neighbours | (e.sweep[i] + e.sweep[j] + 2.0 * bend > 3.0)
    i, j = i[far], j[far]
    c = crossings.between(e, i, j)
    inside = (c.at_i >= low[c.i]) & (c.at_i <= high[c.i])
    inside &= (c.at_j >= low[c.j]) & (c.at_j <= high[c.j])
    c = crossings.Crossings(*(getattr(c, name)[inside] for name in _CROSSING))
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
    raw: Raw, starts: Ints, ends: Ints, x: Floats, y: Floats, touch: float
) -> tuple[Ints, Floats, Ints]:
    """Return (element, position, node): loose ends that lie on another element, nearly."""
    n = len(ends)
    loose = np.concatenate([ends[~raw.joined], starts[starts >= n]])
    px, py = x[loose], y[loose]
    boxes = pairs.grow(seg.boxes(raw.elements), touch)
    i, j = pairs.overlapping((px, py, px, py), boxes)
    e = raw.elements.take(j)
    at = seg.position_of(e, px[i], py[i])
    near = (seg.distances(e, px[i], py[i]) <= touch) & (at > touch) & (at < e.length - touch)
    return j[near], at[near], loose[i[near]]


def _merged(x: Floats, y: Floats, used: NDArray[np.bool_]) -> Ints:
    """Return for each node the representative of the cluster of nodes that it coincides with."""
    label = np.arange(len(x))
    rows = np.flatnonzero(used)
    rows = _one_a_cell(rows, x, y, label)
    px, py = x[rows], y[rows]
    i, j = pairs.self_overlapping(pairs.grow((px, py, px, py), 0.5 * NODE_UM))
    near = np.hypot(px[i] - px[j], py[i] - py[j]) <= NODE_UM
    i, j = rows[i[near]], rows[j[near]]
    while True:  # labels flow to the smallest; clusters are tiny, so this takes a pass or two
        low = np.minimum(label[i], label[j])
        before = label.copy()
        np.minimum.at(label, i, low)
        np.minimum.at(label, j, low)
        label = label[label]
        if (label == before).all():
            return label


def _one_a_cell(rows: Ints, x: Floats, y: Floats, label: Ints) -> Ints:
    """Return one of the nodes of each cell much smaller than a node; ``label`` of the others is it.

    Of a polygon about a circle all sides may cross in one place: as many pairs as the square of
    their crossings would have to be looked at.
    """
    cell = 0.25 * NODE_UM
    column, line = np.floor(x[rows] / cell), np.floor(y[rows] / cell)
    order = np.lexsort((rows, line, column))
    new = np.ones(len(rows), bool)
    new[1:] = (np.diff(column[order]) != 0) | (np.diff(line[order]) != 0)
    if new.all():
        return rows
    first = rows[order[np.flatnonzero(new)[np.cumsum(new) - 1]]]
    label[rows[order]] = first
    return np.sort(rows[order[new]])


def _clearance(source: Source, raw: Raw, element: Ints, at: Floats) -> Floats:
    """Return by how much a point of each piece is farther than the offset from all segments."""
    x, y = seg.points_at(raw.elements.take(element), at)
    offset = np.abs(source.shift[raw.source[element]])
    reach = float(offset.max()) if len(offset) else 0.0
    drawn = pairs.grow(seg.boxes(source.segments), reach)
    result = np.full(len(x), np.inf)
    # So many points at once that the pairs fit the memory: about POINT_PAIRS of them, by the last.
    step = 50_000
    a = 0
    while a < len(x):
        b = slice(a, a + step)
        i, j = pairs.overlapping((x[b], y[b], x[b], y[b]), drawn)
        d = seg.distances(source.segments.take(j), x[b][i], y[b][i])
        result[b] = pairs.least(d, i, len(x[b]))
        a += step
        step = max(100, min(50_000, int(step * POINT_PAIRS / max(1, len(i)))))
    return result - offset


def _without_doubles(raw: Raw, p: _Pieces) -> tuple[_Pieces, Ints]:
    """Return the pieces that stay when some run along each other, and the elements of walls.

    Of pieces in one direction one stays, of two in opposite directions (the walls of a slot as wide
    as the wire) none: the free space between them has no width.
    """
    low, high = np.minimum(p.node0, p.node1), np.maximum(p.node0, p.node1)
    order = np.lexsort((-p.clear, p.node0, high, low))
    same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    rows = np.flatnonzero(same)
    alive = np.ones(len(p.element), bool)
    if not len(rows):
        return p, np.empty(0, np.int64)
    mx, my = seg.points_at(raw.elements.take(p.element), 0.5 * (p.at0 + p.at1))
    walls: list[int] = []
    groups = order[np.unique(np.append(rows, rows + 1))]
    changes = np.flatnonzero(
        (low[groups][1:] != low[groups][:-1]) | (high[groups][1:] != high[groups][:-1])
    )
    for group in np.split(groups, changes + 1):
        members = group.tolist()
        for m, a in enumerate(members):
            for b in members[m + 1 :]:
                if not (alive[a] and alive[b]):
                    continue
                if np.hypot(mx[a] - mx[b], my[a] - my[b]) > SLOT_WALLS_UM:
                    continue
                alive[b] = False
                if p.node0[a] != p.node0[b]:
                    alive[a] = False
                    walls += [int(p.element[a]), int(p.element[b])]
    return p.take(alive), np.array(walls, np.int64)


def _without_dead_ends(
    p: _Pieces, terminal_starts: Ints, terminal_ends: Ints, nodes: int
) -> tuple[NDArray[np.bool_], Ints]:
    """Drop pieces that lead nowhere; return the rest, and those dropped that were clear of all.

    Pieces that dip into the forbidden zone by less than the tolerance were kept and lead nowhere:
    that is expected. A piece that does not dip and leads nowhere is a crossing that was missed.
    """
    alive = np.ones(len(p.element), bool)
    lost = np.zeros(len(alive), bool)
    length = p.at1 - p.at0
    while True:
        entered = np.bincount(p.node1[alive], minlength=nodes)
        left = np.bincount(p.node0[alive], minlength=nodes)
        entered[terminal_starts] += 1
        left[terminal_ends] += 1
        dead = alive & ((entered[p.node0] == 0) | (left[p.node1] == 0))
        if not dead.any():
            return alive, np.flatnonzero(lost)
        lost |= dead & (p.clear > -1e-6) & (length > LOST_UM)
        alive &= ~dead


def _stitch(
    raw: Raw, source: Source, p: _Pieces, alive: NDArray[np.bool_], terminal_starts: Ints
) -> tuple[list[Ints], list[bool], Ints]:
    """Follow the pieces from node to node; return loops, which are closed, and strays."""
    rows = np.flatnonzero(alive)
    order = rows[np.argsort(p.node0[rows], kind="stable")]
    begins = p.node0[order]
    first = np.searchsorted(begins, p.node1)
    count = np.searchsorted(begins, p.node1, "right") - first
    follower = np.full(len(p.element), -1)
    one = count == 1
    follower[one] = order[first[one]]
    several = rows[count[rows] > 1]
    if len(several):
        _choose(raw, source, p, several, order, first, count, follower)
    # Where a piece has two before it, one of those is a stray.
    following = follower.tolist()
    heads = np.isin(p.node0, terminal_starts) & alive
    taken = bytearray(len(following))
    loops: list[Ints] = []
    closed: list[bool] = []
    stray: list[int] = []
    is_head = heads.tolist()
    for begin in [*np.flatnonzero(heads).tolist(), *rows.tolist()]:
        if taken[begin]:
            continue
        run = []
        here = begin
        while here >= 0 and not taken[here]:
            taken[here] = 1
            run.append(here)
            here = following[here]
        if is_head[begin] or here == begin:
            loops.append(np.array(run))
            closed.append(here == begin and not is_head[begin])
        else:
            stray += run
    return loops, closed, np.array(stray, np.int64)


def _choose(
    raw: Raw,
    source: Source,
    p: _Pieces,
    several: Ints,
    order: Ints,
    first: Ints,
    count: Ints,
    follower: Ints,
) -> None:
    """Fill in ``follower`` where several pieces leave a node: the sharpest turn to the free side.

    The free side is the side the wire was shifted to; turning sharpest to it stays at the border of
    one free region, so loops that touch are split. Each piece follows one other.
    """
    k, at = pairs.expand(first[several], first[several] + count[several])
    a, b = several[k], order[at]
    e = raw.elements
    t1x, t1y = seg.tangents_at(e.take(p.element[a]), p.at1[a])
    t0x, t0y = seg.tangents_at(e.take(p.element[b]), p.at0[b])
    sign = np.where(source.shift[raw.source[p.element[a]]] >= 0, 1.0, -1.0)
    turn = np.arctan2(t1x * t0y - t1y * t0x, t1x * t0x + t1y * t0y) * sign
    # Straight back counts as the least, not the most, turn to the free side.
    turn = np.where(turn < np.pi - 1e-6, turn, -turn)
    gone: set[int] = set()
    for m in np.lexsort((b, a, -turn)).tolist():
        before, after = int(a[m]), int(b[m])
        if follower[before] < 0 and after not in gone:
            follower[before] = after
            gone.add(after)


def _without_slivers(source: Source, raw: Raw, loops: Loops) -> Loops:
    """Drop loops without a width.

    Coincident walls run along once in each direction; a hole a hair wider than the wire leaves its
    centre a loop of less than a step.
    """
    keep: list[Ints] = []
    closed: list[bool] = []
    areas, lengths = _areas_and_lengths(raw, loops)
    short = [k for k, length in enumerate(lengths) if length < SHORT_UM]
    small = _too_small(raw, loops, short)
    for k, (loop, is_closed, area, length) in enumerate(
        zip(loops.loops, loops.closed, areas, lengths, strict=True)
    ):
        if is_closed:
            if abs(area) < SLIVER_UM * length or k in small:
                continue
            element = loops.element[loop]
            if not loops.whole and raw.transition[element].all():
                x, y = seg.points_at(raw.elements.take(element[:1]), loops.at0[loop[:1]])
                if not on_free_side(source, int(raw.contour[element[0]]), x, y).all():
                    continue
        keep.append(loop)
        closed.append(is_closed)
        loops.areas.append(area if is_closed else 0.0)
    whole = loops.whole and len(keep) == len(loops.loops)
    return replace(loops, loops=keep, closed=closed, whole=whole)


def _too_small(raw: Raw, loops: Loops, which: list[int]) -> set[int]:
    """Return which loops are nowhere wider than a step, by the boxes of a few of their places."""
    small: set[int] = set()
    for number in which:
        loop = loops.loops[number]
        e, at0, at1 = raw.elements.take(loops.element[loop]), loops.at0[loop], loops.at1[loop]
        places = [seg.points_at(e, at0 + share * (at1 - at0)) for share in (0.0, 0.25, 0.5, 0.75)]
        if (
            max(float(np.ptp(each)) for each in map(np.concatenate, zip(*places, strict=True)))
            < NO_CUT_UM
        ):
            small.add(number)
    return small


def _areas_and_lengths(raw: Raw, loops: Loops) -> tuple[list[float], list[float]]:
    """Return the signed area (um^2) and the length (um) of each loop."""
    if not loops.loops:
        return [], []
    loop = np.concatenate(loops.loops)
    begin = np.cumsum([0, *(len(k) for k in loops.loops[:-1])])
    element = loops.element[loop]
    e = raw.elements
    if len(element) != len(e) or not loops.whole:
        e = e.take(element)
    at0, at1 = loops.at0[loop], loops.at1[loop]
    n0, n1 = loops.node0[loop], loops.node1[loop]
    x0, y0, x1, y1 = loops.node_x[n0], loops.node_y[n0], loops.node_x[n1], loops.node_y[n1]
    long = at1 - at0
    sweep = np.where(e.radius > 0, long / np.where(e.radius > 0, e.radius, 1.0), 0.0)
    lune = e.radius**2 * (sweep - np.sin(sweep)) * e.turn
    area = 0.5 * np.add.reduceat(x0 * y1 - x1 * y0 + lune, begin)
    return area.tolist(), np.add.reduceat(long, begin).tolist()

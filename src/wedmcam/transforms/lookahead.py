"""The path beside an outline as a controller makes it that looks one block ahead.

Every block is offset by itself and meets the next one: an arc about the corner joins them outside,
inside both end where they cross. The controller knows nothing else. So an outline may run on over
its own start (an overlap), or several times round: the path is the same again. What one block of
look-ahead cannot make is refused: a block that the offset leaves nothing of, one that runs back on
an earlier one (there the wire would be on the other side), and a path that comes nearer to any
block than the offset, for there it cuts into what that block bounds.

This is no part of ``compensate``, which knows the whole outline, keeps what is far enough from all
of it, and would have to tell a second pass from a wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import crossings, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.gaps import gaps
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.transforms.compensate.raw import gather, raw_offset

Bools = NDArray[np.bool_]

#: A path that ends this near to its start, where the outline is closed, closes: the rounding of a
#: joint that is tangent but for the last digit; um.
CLOSED_UM = 0.5
#: An inside radius this near to the offset becomes a point of the path; um.
POINT_UM = 1.0
#: Shifted ends this near to each other meet in the middle where they do not cross: blocks are
#: rounded, and a joint that was tangent is so no more; um.
MEET_UM = 1.0
#: The wire may come this much nearer to a block than the offset: two roundings, and less than what
#: the proof lets pass as a gouge; um.
NEARER_UM = 1.5
#: Blocks this near to each other run on one line; um.
SAME_UM = 1.0
#: So far from the opposite direction a block still runs back on another, radians.
BACK = 0.01
#: Places of a block that are looked at for that, as shares of its length.
SHARES = (0.25, 0.5, 0.75)
#: So many pairs of an element of the path and a block are measured at once: some 100 MB.
MOST_PAIRS = 500_000


@dataclass(frozen=True, slots=True)
class Lost:
    """Why the controller cannot follow an outline.

    Attributes:
        kind: "radius" (an inside radius below the offset), "nothing" (nothing is left of the
            block), "back" (it runs back on another), "near" (the wire comes too near to another).
        row: of the outline.
        at: where, um.
        other: the row before it that it runs back on or comes too near to; -1 for none.
        gap_um: how near the wire comes to that one, um.
    """

    kind: str
    row: int
    at: tuple[float, float]
    other: int = -1
    gap_um: float = 0.0


def beside(
    outline: Contour, shifts: Floats, before: float | None = None
) -> tuple[Contour | None, Lost | None]:
    """Return the path of the wire beside an open outline, or why the controller cannot make it.

    Args:
        outline: open, um; ``source`` numbers its blocks.
        shifts: for each row how far the wire runs to the left of it (negative: right), um. One
            side, and not 0. A straight row of another shift than the row before leads from the one
            to the other: it begins where the row before meets it with the old shift, and ends where
            it meets the next row with its own.
        before: the shift at the start of the first row; None for its own.

    Returns:
        The path, from the normal of the first row to the normal of the last; closed where the
        outline ends at its start and the path does.
    """
    s = seg.of_rows(outline.starts, outline.ends)
    lost = _turned_back(s)
    if lost is not None:
        return None, lost
    old = np.concatenate([[shifts[0] if before is None else before], shifts[:-1]])
    change = np.flatnonzero(old != shifts)
    closed = not len(change) and _closes(outline, s, float(shifts[0]))
    begins, ends = [0, *change.tolist()], [*change.tolist(), len(s) - 1]
    path: _Path | None = None
    for first, last, shift in zip(begins, ends, [*old[change], shifts[-1]], strict=True):
        made = _joined(outline.vertices[first : last + 2], float(shift), first, closed)
        if isinstance(made, Lost):
            return None, made
        path = made if path is None else path.then(made)
    assert path is not None
    e, row = path.elements, path.row
    along = (e.x1 - e.x0) * s.ux[row] + (e.y1 - e.y0) * s.uy[row]
    wrong = np.flatnonzero(np.isin(row, change) & (along <= 0) & ~path.transition)
    if len(wrong):
        return None, _nothing(s, int(row[wrong[0]]))
    lost = _too_near(path, s, np.minimum(np.abs(old), np.abs(shifts)))
    if lost is not None:
        return None, lost
    return path.contour(outline, closed), None


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """Elements of a path in their order, each from where the one before ends.

    Attributes:
        elements: um.
        row: of the outline that each was shifted from; of an arc about a corner, the one before it.
        transition: whether it is an arc about a corner.
    """

    elements: Segments
    row: Ints
    transition: Bools

    def then(self, other: _Path) -> _Path:
        """Return this path and one that goes on with another shift: they share a straight row."""
        a, b = self.elements, other.elements
        columns = {k: np.concatenate([getattr(a, k)[:-1], getattr(b, k)]) for k in a.__slots__}
        at = len(a) - 1
        columns["x0"][at], columns["y0"][at] = a.x0[-1], a.y0[-1]
        names = ("x0", "y0", "x1", "y1", "cx", "cy", "turn", "radius", "sweep")
        elements = seg.make(*(columns[k] for k in names))
        row = np.concatenate([self.row[:-1], other.row])
        return _Path(elements, row, np.concatenate([self.transition[:-1], other.transition]))

    def contour(self, outline: Contour, closed: bool) -> Contour:
        """Return it as a contour; ``source`` is that of the rows."""
        e = self.elements
        rows = np.zeros(len(e) + 1, VERTEX)
        for name in ("x", "y"):
            rows[name] = np.append(getattr(e, f"{name}0"), getattr(e, f"{name}1")[-1])
            rows[f"c{name}"][:-1] = getattr(e, f"c{name}")
        rows["turn"][:-1] = e.turn
        rows["source"] = np.append(outline.vertices["source"][self.row], -1)
        return Contour(rows[:-1].copy() if closed else rows, closed, outline.sources)


def _closes(outline: Contour, s: Segments, shift: float) -> bool:
    """Return whether an outline ends at its start, and its path does but for rounding."""
    v = outline.vertices
    if v["x"][0] != v["x"][-1] or v["y"][0] != v["y"][-1]:
        return False
    (ax, ay), (bx, by) = seg.end_tangents(s), seg.start_tangents(s)
    angle = np.arctan2(ax[-1] * by[0] - ay[-1] * bx[0], ax[-1] * bx[0] + ay[-1] * by[0])
    return bool(abs(angle * shift) <= CLOSED_UM)


def _joined(rows: NDArray[np.void], shift: float, first: int, closed: bool) -> _Path | Lost:
    """Return the path beside rows of one shift, every block joined to the next.

    Args:
        rows: vertices of the outline, the end of the last row included, um.
        first: number of the first row.
        closed: the last row is joined to the first.
    """
    rows = rows[:-1].copy() if closed else rows.copy()
    if not closed:
        rows["turn"][-1] = 0
    source = gather([Contour(rows, closed)], [shift])
    s = source.segments
    inside = s.turn * shift > 0
    point = inside & (np.abs(s.radius - abs(shift)) <= POINT_UM)
    small = np.flatnonzero(inside & ~point & (s.radius < abs(shift)))
    dx, dy = source.origin
    if len(small):
        k = int(small[0])
        x, y = seg.points_at(s.take(small[:1]), 0.5 * s.length[small[:1]])
        return Lost("radius", first + int(source.row[k]), (float(x[0]) + dx, float(y[0]) + dy))
    raw = raw_offset(source, False)
    kept = np.arange(len(raw.elements))
    while True:
        e, of = raw.elements.take(kept), raw.source[kept]
        at0, at1, x, y, apart = _met(e, closed)
        gone = at1 - at0 <= 0
        # An inside radius as large as the offset is a point, and may be nothing.
        points = gone & point[of] & ~raw.transition[kept]
        points |= apart & point[of]
        if not points.any() or points.all():
            break
        kept = kept[~points]
    bad = np.flatnonzero(gone | apart)
    if len(bad):
        # Of two blocks that do not meet, the shorter one is lost.
        k = int(bad[0])
        pair = of[[k, (k + 1) % len(of)]] if apart[k] and not gone[k] else of[[k, k]]
        k = int(pair[np.argmin(s.length[pair])])
        return Lost("nothing", first + int(source.row[k]), _middle(s, k, source.origin))
    # An element begins where the one before it ends.
    x0, y0 = (np.concatenate([c[-1:], c[:-1]]) for c in (x, y))
    if not closed:
        x0[0], y0[0] = e.x0[0], e.y0[0]
    sweep = np.where(e.turn != 0, (at1 - at0) / np.where(e.radius > 0, e.radius, 1.0), 0.0)
    made = seg.make(x0 + dx, y0 + dy, x + dx, y + dy, e.cx + dx, e.cy + dy, e.turn, e.radius, sweep)
    return _Path(made, first + source.row[of], raw.transition[kept])


def _met(e: Segments, closed: bool) -> tuple[Floats, Floats, Floats, Floats, Bools]:
    """Return how the elements of a path meet the next ones.

    Returns:
        From where to where each runs, as arc lengths; where it ends, um; and whether it does not
        meet the next one.
    """
    n = len(e)
    at0, at1, x, y = np.zeros(n), e.length.copy(), e.x1.copy(), e.y1.copy()
    apart = np.zeros(n, bool)
    i = np.arange(n if closed else n - 1)
    j = (i + 1) % n
    loose = (e.x1[i] != e.x0[j]) | (e.y1[i] != e.y0[j])
    i, j = i[loose], j[loose]
    if not len(i):
        return at0, at1, x, y, apart
    apart[i] = True
    c = crossings.between(e, i, j)
    # Of two crossings that nearest to the corner, along both.
    order = np.argsort(e.length[c.i] - c.at_i + c.at_j, kind="stable")[::-1]
    for values, of, found in ((at1, c.i, c.at_i), (at0, c.j, c.at_j), (x, c.i, c.x), (y, c.i, c.y)):
        values[of[order]] = found[order]
    apart[c.i] = False
    near = apart[i] & (np.hypot(e.x1[i] - e.x0[j], e.y1[i] - e.y0[j]) <= MEET_UM)
    i, j = i[near], j[near]
    x[i], y[i] = 0.5 * (e.x1[i] + e.x0[j]), 0.5 * (e.y1[i] + e.y0[j])
    apart[i] = False
    return at0, at1, x, y, apart


def _middle(s: Segments, k: int, origin: tuple[float, float] = (0.0, 0.0)) -> tuple[float, float]:
    x, y = seg.points_at(s.take(np.array([k])), 0.5 * s.length[k : k + 1])
    return float(x[0]) + origin[0], float(y[0]) + origin[1]


def _nothing(s: Segments, k: int) -> Lost:
    return Lost("nothing", k, _middle(s, k))


def _turned_back(s: Segments) -> Lost | None:
    """Return the first block that runs back on another one."""
    best: tuple[int, int, float, float] | None = None
    boxes = pairs.grow(seg.boxes(s), SAME_UM)
    for share in SHARES:
        x, y = seg.points_at(s, share * s.length)
        tx, ty = seg.tangents_at(s, share * s.length)
        i, j = pairs.overlapping((x, y, x, y), boxes)
        i, j = i[i != j], j[i != j]
        other = s.take(j)
        near = seg.distances(other, x[i], y[i]) <= SAME_UM
        at = np.clip(seg.position_of(other, x[i], y[i]), 0.0, other.length)
        ux, uy = seg.tangents_at(other, at)
        against = (tx[i] * ux + ty[i] * uy < 0) & (np.abs(tx[i] * uy - ty[i] * ux) < BACK)
        for k in np.flatnonzero(near & against)[:1].tolist():
            a, b = int(i[k]), int(j[k])
            if best is None or max(a, b) < best[0]:
                best = max(a, b), min(a, b), float(x[a]), float(y[a])
    return None if best is None else Lost("back", best[0], best[2:], best[1])


def _too_near(path: _Path, s: Segments, least: Floats) -> Lost | None:
    """Return the first block to which the wire comes nearer than the offset.

    Args:
        path: the path of the wire.
        s: rows of the outline.
        least: for each row how near the wire may come, um.
    """
    e, limit = path.elements, np.maximum(least[path.row] - NEARER_UM, 0.0)
    left, low, right, high = seg.boxes(e)
    grow = (left - limit, low - limit, right + limit, high + limit)
    through = _ways(s)
    worst: tuple[int, int, float, tuple[float, float]] | None = None
    for i, j in pairs.overlapping_parts(grow, seg.boxes(s), MOST_PAIRS):
        k = (path.row[i] != j) & ~through[j] & (limit[i] > 0)
        i, j = i[k], j[k]
        if not len(i):
            continue
        a, b = e.take(i), s.take(j)
        found = gaps(a, b)
        size, x, y = found.size.copy(), found.x.copy(), found.y.copy()
        both = Segments(
            *(np.concatenate([getattr(a, name), getattr(b, name)]) for name in a.__slots__)
        )
        index = np.arange(len(i))
        c = crossings.between(both, index, index + len(i))
        size[c.i], x[c.i], y[c.i] = 0.0, c.x, c.y
        near = np.flatnonzero(size < limit[i])
        if len(near):
            k = near[np.argmin(i[near])]
            one = int(i[k]), int(j[k]), float(size[k]), (float(x[k]), float(y[k]))
            if worst is None or one[0] < worst[0]:
                worst = one
    if worst is None:
        return None
    element, other, gap, at = worst
    row = int(path.row[element])
    return Lost("near", max(row, other), at, min(row, other), gap)


def _ways(s: Segments) -> Bools:
    """Return which rows are a way to the outline or away from it, and bound nothing.

    The first row where the outline comes by its end again, the last where it came by its start: the
    wire crosses it there for certain. Where the outline overlaps itself past a corner, its
    first and last row lie on rows that it has already, and are such ways too.
    """
    n = len(s)
    found = np.zeros(n, bool)
    if n < 4:
        return found
    for row, others, x, y in (
        (0, np.arange(2, n), s.x1[0], s.y1[0]),
        (n - 1, np.arange(n - 2), s.x0[-1], s.y0[-1]),
    ):
        far = seg.distances(s.take(others), np.full(len(others), x), np.full(len(others), y))
        found[row] = bool((far <= SAME_UM).any())
    return found

"""Where contours cross, run along each other, or touch.

A wire path is computed from contours that bound material: a contour that crosses itself or another
bounds nothing. Lines and arcs are intersected exactly, pairs found by a sweep over their boxes.
Meeting in a common vertex is no crossing: two loops that share one place cannot cross there without
crossing elsewhere as well.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import LISTED, Diagnostic, Place, Span, error, warning
from wedmcam.geom import crossings
from wedmcam.geom.gaps import beside
from wedmcam.geom.pairs import grow, self_overlapping_parts
from wedmcam.geom.segments import (
    TAU,
    Floats,
    Ints,
    Segments,
    boxes,
    points_at,
    tangents_at,
)
from wedmcam.ir.contour import Contour
from wedmcam.ir.sketch import SEGMENT
from wedmcam.transforms.doubles import NOISE_UM, columns, span_of, steady
from wedmcam.transforms.walls import MOST, TOUCH_UM, TWICE_UM

Rows = NDArray[np.void]
Bools = NDArray[np.bool_]

#: Lines, or arcs of one circle, this near to each other run on top of each other, um ...
ON_TOP_UM = 1.0
#: ... where they do so for more than this length, um.
ALONG_UM = 1.0
#: How far from a vertex to look at which side a contour leaves it, um.
STEP_AWAY_UM = 50.0
#: Contours that meet at fewer places than this are not one that is drawn twice, if they do not
#: cross at two at least.
SEVERAL = 4
#: So many pairs of contours at most are held against each other for that, those that meet most.
COMPARED = 1000
#: Pairs of segments are looked at so many at a time ...
PART = 500_000
#: ... until so many errors are found, and no more pairs or touches than these.
ENOUGH, MOST_PAIRS, MOST_TOUCHES = 20_000, 20_000_000, 1_000_000
#: More segments that branch than this are refused for that alone.
MANY_BRANCHING = 2_000


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Segments and the contours that they ended up in.

    Attributes:
        rows: `SEGMENT` rows, first all that have ends, then full circles.
        owner: index of each one's contour, -1 for none (it branches).
        nodes: node of the start and of the end of each row that has ends, shape (n, 2).
    """

    rows: Rows
    owner: Ints
    nodes: Ints


def contour_meetings(contours: Sequence[Contour]) -> tuple[Diagnostic, ...]:
    """Return the findings of `meetings` for contours that did not come from `chain`."""
    parts: list[Rows] = []
    owner: list[Ints] = []
    spans: list[Span] = []
    rings: list[Rows] = []
    ring_owner: list[int] = []
    for k, c in enumerate(contours):
        a, b = c.starts, c.ends
        rows = np.zeros(len(a), SEGMENT)
        rows["x0"], rows["y0"], rows["x1"], rows["y1"] = a["x"], a["y"], b["x"], b["y"]
        for name in ("cx", "cy", "turn"):
            rows[name] = a[name]
        rows["source"] = np.where(a["source"] >= 0, a["source"] + len(spans), -1)
        spans += c.sources
        if len(c) == 1 and c.closed:
            rings.append(rows)
            ring_owner.append(k)
            continue
        parts.append(rows)
        owner.append(np.full(len(a), k))
    with_ends = np.concatenate([np.zeros(0, SEGMENT), *parts])
    owners = [np.zeros(0, np.int64), *owner, np.array(ring_owner, np.int64)]
    placed = Placed(np.concatenate([with_ends, *rings]), np.concatenate(owners), _nodes(with_ends))
    return meetings(placed, tuple(spans))


def _nodes(rows: Rows) -> Ints:
    """Return the node of both ends of each row: ends at one place, to the last bit, are one."""
    x = np.stack([rows["x0"], rows["x1"]], axis=1).ravel()
    y = np.stack([rows["y0"], rows["y1"]], axis=1).ravel()
    order = np.lexsort((y, x))
    new = np.diff(x[order], prepend=np.nan) != 0
    new |= np.diff(y[order], prepend=np.nan) != 0
    out = np.empty(len(x), np.int64)
    out[order] = np.cumsum(new)
    return out.reshape(-1, 2)


def meetings(placed: Placed, sources: tuple[Span, ...]) -> tuple[Diagnostic, ...]:
    """Return errors for overlaps and crossings, and warnings for touches.

    Codes: ``overlap``, ``self-crossing``, ``crossing-contours``, ``contours-touch``. One finding
    for each pair of contours, or of segments on top of each other, in order of place.
    """
    if len(placed.rows) < 2:
        return ()
    s = columns(placed.rows)
    met, complete = _met(placed, s)
    findings: list[Diagnostic] = []
    if not complete and not met.many:
        findings.append(
            error(
                "too-large",
                "more than {most:,} pairs of segments lie over each other: the drawing is too "
                "dense to be looked through",
                hint="put what is not to be cut on another layer",
                most=MOST_PAIRS,
            )
        )
    hits, cross, on_top = met.hits, met.cross, met.on_top
    pairs = placed.owner[hits.i], placed.owner[hits.j]
    owners = [placed.owner[k] for k in on_top[:2]]
    over_pairs, pairs_of_hits = _sorted_pairs(*owners), _sorted_pairs(*pairs)
    crossing = [pairs_of_hits[k] for k in np.flatnonzero(cross).tolist()]
    twice, errors = _twice(placed, sources, s, over_pairs, crossing)
    findings += errors
    once = np.array([p not in twice for p in over_pairs], bool)
    i, j, x, y, along = (v[once] for v in on_top)
    findings += _overlaps(placed, sources, i, j, x, y, along, complete=complete)
    of_twice = np.array([p in twice for p in pairs_of_hits], bool)
    findings += _crossings(placed, sources, hits, cross & ~of_twice, pairs, complete)
    crossed = set(zip(*(np.sort(np.stack(pairs), axis=0)[:, cross]).tolist(), strict=True))
    findings += _touches(placed, sources, s, hits, ~cross, pairs, crossed)
    return tuple(findings)


class _Met(NamedTuple):
    """Where segments run on top of each other (i, j, x, y, length), and where they meet.

    ``cross``: which of the ``hits`` are crossings; the others are touches.
    """

    on_top: tuple[Ints, Ints, Floats, Floats, Floats]
    hits: crossings.Crossings
    cross: Bools

    @property
    def many(self) -> bool:
        """Whether there are enough errors to refuse the drawing without looking further."""
        return len(self.on_top[0]) + int(self.cross.sum()) >= ENOUGH


def _met(placed: Placed, s: Segments) -> tuple[_Met, bool]:
    """Return where segments meet, and whether all pairs were looked at.

    Pairs are looked at part by part: ten thousand circles over each other are fifty million.
    """
    looked = np.arange(len(s))
    branching = placed.owner < 0
    if int(branching.sum()) > MANY_BRANCHING:  # a star of so many lines is refused as it is
        looked = np.flatnonzero(~branching)
    box = tuple(side[looked] for side in grow(boxes(s), TOUCH_UM))
    met = _Met(*_of_pairs(placed, s, looked[:0], looked[:0]))
    seen = 0
    for i, j in self_overlapping_parts((box[0], box[1], box[2], box[3]), PART):
        if met.many or seen > MOST_PAIRS or len(met.hits.i) > MOST_TOUCHES:
            return met, False
        seen += len(i)
        more = _of_pairs(placed, s, looked[i], looked[j])
        met = _Met(*more) if seen == len(i) else _together(met, _Met(*more))
    return met, True


def _together(a: _Met, b: _Met) -> _Met:
    one, two, three, four, five = (
        np.concatenate(both) for both in zip(a.on_top, b.on_top, strict=True)
    )
    hits = crossings.Crossings(
        *(
            np.concatenate([getattr(a.hits, name), getattr(b.hits, name)])
            for name in crossings.Crossings.__slots__
        )
    )
    return _Met((one, two, three, four, five), hits, np.concatenate([a.cross, b.cross]))


def _of_pairs(
    placed: Placed, s: Segments, i: Ints, j: Ints
) -> tuple[tuple[Ints, Ints, Floats, Floats, Floats], crossings.Crossings, Bools]:
    """Return the fields of `_Met` for pairs of segments."""
    lines = (s.turn[i] == 0) & (s.turn[j] == 0)
    common = _shares_end(s, i, j)
    # Most pairs are lines that follow each other round a corner: nothing to find there.
    plain = lines & common
    bend = s.ux[i] * s.uy[j] - s.uy[i] * s.ux[j]
    plain &= np.abs(bend) * np.minimum(s.length[i], s.length[j]) > ON_TOP_UM
    i, j = i[~plain], j[~plain]
    over, at_x, at_y, along = _on_top(s, i, j)
    on_top = i[over], j[over], at_x[over], at_y[over], along[over]
    i, j = i[~over], j[~over]
    hits = crossings.between(s, i, j)
    owned = (placed.owner[hits.i] >= 0) & (placed.owner[hits.j] >= 0)
    away = owned & ~_at_common_end(s, hits)
    hits = crossings.Crossings(
        *(getattr(hits, name)[away] for name in crossings.Crossings.__slots__)
    )
    inner_i = _interior(s, hits.i, hits.at_i)
    inner_j = _interior(s, hits.j, hits.at_j)
    cross = inner_i & inner_j & (_depth(s, hits) > TOUCH_UM)
    cross[_through(placed, s, hits, np.flatnonzero(inner_i != inner_j), inner_i)] = True
    return on_top, hits, cross


def _sorted_pairs(a: Ints, b: Ints) -> list[tuple[int, int]]:
    return list(zip(np.minimum(a, b).tolist(), np.maximum(a, b).tolist(), strict=True))


def _twice(
    placed: Placed,
    sources: tuple[Span, ...],
    s: Segments,
    over: Sequence[tuple[int, int]],
    crossing: Sequence[tuple[int, int]],
) -> tuple[set[tuple[int, int]], list[Diagnostic]]:
    """Return the pairs of contours that are one drawn twice, with an error for each.

    They cross, or run on top of each other, several times, and lie beside each other for most of
    their length.
    """
    crosses, meets = Counter(crossing), Counter([*over, *crossing])
    twice, findings = set(), []
    likely = [
        (-times, pair)
        for pair, times in meets.items()
        if 0 <= pair[0] < pair[1] and (times >= SEVERAL or crosses[pair] >= 2)
    ]
    for times, (a, b) in sorted(sorted(likely)[:COMPARED], key=lambda one: one[1]):
        one, other = np.flatnonzero(placed.owner == a), np.flatnonzero(placed.owner == b)
        share, far = beside(s.take(one), s.take(other), TWICE_UM)
        if share < MOST or not all(_closes(placed, rows) for rows in (one, other)):
            continue
        twice.add((a, b))
        first, second = _two(placed, sources, int(one[0]), int(other[0]))
        outline = Place.of_um(s.x0[one[0]], s.y0[one[0]])
        findings.append(
            error(
                "drawn-twice",
                "two contours run beside each other, up to {apart_mm:.3f} mm apart, and meet "
                "{times} times: the outline at {outline} seems drawn twice",
                first,
                notes=(("the other one", second),),
                hint="remove one of the two",
                points_mm=(outline,),
                apart_mm=far / 1e3,
                times=-times,
                outline=outline,
            )
        )
    if len(findings) > LISTED:
        more = error(
            "drawn-twice",
            "{count} further pairs of contours seem to be one that is drawn twice",
            count=len(findings) - LISTED,
        )
        findings = [*findings[:LISTED], more]
    return twice, findings


def _closes(placed: Placed, rows: Ints) -> bool:
    """Return whether the rows of a contour go round: it has an inside, so it may be an outline."""
    ends = placed.nodes[rows[rows < len(placed.nodes)]]
    return bool((np.unique(ends, return_counts=True)[1] % 2 == 0).all())


def _shares_end(s: Segments, i: Ints, j: Ints) -> Bools:
    """Return which pairs have an end in common, to the last bit (joining made them so)."""
    shared = np.zeros(len(i), np.bool_)
    for ax, ay in ((s.x0, s.y0), (s.x1, s.y1)):
        for bx, by in ((s.x0, s.y0), (s.x1, s.y1)):
            shared |= (ax[i] == bx[j]) & (ay[i] == by[j])
    return shared


def _interior(s: Segments, k: Ints, at: Floats) -> Bools:
    """Return which positions lie away from the ends of their segment; circles have no ends."""
    inside = (at > TOUCH_UM) & (at < s.length[k] - TOUCH_UM)
    return np.asarray(inside | (s.sweep[k] == TAU), np.bool_)


def _at_common_end(s: Segments, hits: crossings.Crossings) -> Bools:
    """Return which hits are nothing but the vertex that both segments share.

    The end of an arc may miss its circle by the noise of joining, e; a tangent line then meets the
    circle up to sqrt(2 R e) away from the vertex. Where a full circle begins is no vertex.
    """
    i, j = hits.i, hits.j
    reach = np.full(len(i), ON_TOP_UM)
    for k in (i, j):
        miss = np.abs(np.hypot(s.x1[k] - s.cx[k], s.y1[k] - s.cy[k]) - s.radius[k])
        far = 3.0 * np.sqrt(2.0 * s.radius[k] * (miss + NOISE_UM))
        reach = np.where(s.turn[k] != 0, np.maximum(reach, far), reach)
    reach = np.minimum(reach, 0.25 * np.minimum(s.length[i], s.length[j]))
    at = np.zeros(len(i), np.bool_)
    for ax, ay in ((s.x0, s.y0), (s.x1, s.y1)):
        near = np.hypot(hits.x - ax[i], hits.y - ay[i]) <= reach
        for bx, by in ((s.x0, s.y0), (s.x1, s.y1)):
            at |= near & (ax[i] == bx[j]) & (ay[i] == by[j])
    return np.asarray(at & (s.sweep[i] != TAU) & (s.sweep[j] != TAU), np.bool_)


def _depth(s: Segments, hits: crossings.Crossings) -> Floats:
    """Return how deep the two segments of each hit reach past each other, um.

    Where directions differ by an angle a and curvatures by k, the one leaves the other again after
    a chord that is a^2 / 2k deep. Two lines never do: infinite.
    """
    si, sj = s.take(hits.i), s.take(hits.j)
    ui, vi = tangents_at(si, hits.at_i)
    uj, vj = tangents_at(sj, hits.at_j)
    sine = ui * vj - vi * uj
    same = np.where(ui * uj + vi * vj < 0, -1.0, 1.0)
    bend_i = si.turn / np.where(si.radius > 0, si.radius, 1.0)
    bend_j = same * sj.turn / np.where(sj.radius > 0, sj.radius, 1.0)
    bend = np.abs(bend_i - bend_j)
    deep = 0.5 * sine * sine / np.where(bend > 0, bend, 1.0)
    return np.where(bend > 0, deep, np.inf)


def _on_top(s: Segments, i: Ints, j: Ints) -> tuple[Bools, Floats, Floats, Floats]:
    """Return which pairs run on top of each other, the middle of that stretch, and its length."""
    x, y, along = np.zeros(len(i)), np.zeros(len(i)), np.zeros(len(i))
    over = np.zeros(len(i), np.bool_)
    # Which of two the place is measured along does not depend on their order.
    rows = np.unique(np.concatenate([i, j]))
    t = s.take(rows)
    keys = (t.length, t.radius, np.minimum(t.x0, t.x1), t.x0 + t.x1, t.y0 + t.y1)
    rank = np.zeros(len(s), np.int64)
    rank[rows[np.lexsort([steady(key) for key in keys])]] = np.arange(len(rows))
    i, j = np.where(rank[i] > rank[j], (j, i), (i, j))
    k = np.flatnonzero((s.turn[i] == 0) & (s.turn[j] == 0))
    if len(k):
        a, b = s.take(i[k]), s.take(j[k])
        t0 = (b.x0 - a.x0) * a.ux + (b.y0 - a.y0) * a.uy
        t1 = (b.x1 - a.x0) * a.ux + (b.y1 - a.y0) * a.uy
        low, high = (
            np.maximum(0.0, np.minimum(t0, t1)),
            np.minimum(a.length, np.maximum(t0, t1)),
        )
        off0 = (b.y0 - a.y0) * a.ux - (b.x0 - a.x0) * a.uy
        off1 = (b.y1 - a.y0) * a.ux - (b.x1 - a.x0) * a.uy
        span = np.where(t1 != t0, t1 - t0, 1.0)
        off_low = off0 + (off1 - off0) * (low - t0) / span
        off_high = off0 + (off1 - off0) * (high - t0) / span
        near = np.maximum(np.abs(off_low), np.abs(off_high)) < ON_TOP_UM
        over[k] = near & (high - low > ALONG_UM) & (t1 != t0)
        along[k] = high - low
        x[k], y[k] = points_at(a, 0.5 * (low + high))
    k = np.flatnonzero((s.turn[i] != 0) & (s.turn[j] != 0))
    if len(k):
        a, b = s.take(i[k]), s.take(j[k])
        near = np.hypot(a.cx - b.cx, a.cy - b.cy) < ON_TOP_UM
        near &= np.abs(a.radius - b.radius) < ON_TOP_UM
        # Where b starts and how far it goes, measured along a.
        start = np.where(b.turn == a.turn, b.a0, b.a0 + b.turn * b.sweep)
        begin = np.mod((start - a.a0) * a.turn, TAU)
        first = np.minimum(a.sweep, begin + b.sweep) - begin
        second = np.minimum(a.sweep, begin + b.sweep - TAU)
        longest = np.maximum(first, second)
        over[k] = near & (longest * a.radius > ALONG_UM)
        along[k] = longest * a.radius
        middle = np.where(first >= second, begin + 0.5 * first, 0.5 * second)
        x[k], y[k] = points_at(a, np.maximum(middle, 0.0) * a.radius)
    return over, x, y, along


def _overlaps(
    placed: Placed,
    sources: tuple[Span, ...],
    i: Ints,
    j: Ints,
    x: Floats,
    y: Floats,
    along: Floats,
    *,
    complete: bool,
) -> list[Diagnostic]:
    """Return one error for each pair of segments on top of each other.

    ``complete``: there are no more of them than these.
    """
    findings = []
    order = np.lexsort((steady(along), steady(x), steady(y)))
    for k in order[:LISTED].tolist():
        middle = Place.of_um(x[k], y[k])
        first, second = _two(placed, sources, int(i[k]), int(j[k]))
        findings.append(
            error(
                "overlap",
                "two segments run on top of each other for {length_mm:.3f} mm at {place}",
                first,
                notes=(("the other one", second),),
                hint="remove one of them, or what both have in common",
                points_mm=(middle,),
                length_mm=float(along[k]) / 1e3,
                place=middle,
            )
        )
    if len(order) > LISTED:
        findings.append(
            error(
                "overlap",
                "{count} further pairs of segments run on top of each other"
                if complete
                else "at least {count} further pairs of segments run on top of each other",
                count=len(order) - LISTED,
            )
        )
    return findings


def _two(
    placed: Placed, sources: tuple[Span, ...], i: int, j: int
) -> tuple[Span | None, Span | None]:
    """Return the spans of two rows, in an order that does not depend on theirs."""
    a, b = span_of(placed.rows[i], sources), span_of(placed.rows[j], sources)
    return (b, a) if str(b) < str(a) else (a, b)


def _through(
    placed: Placed, s: Segments, hits: crossings.Crossings, which: Ints, inner_i: Bools
) -> list[int]:
    """Return those of the hits ``which`` where a contour passes through another at a vertex.

    The vertex of the one lies on the inside of a segment of the other; the one crosses if it leaves
    the vertex on the other side than it came from.
    """
    if not len(which):
        return []
    out = []
    at_node: dict[int, list[int]] = {}
    near = {int(hits.j[k] if inner_i[k] else hits.i[k]) for k in which}
    wanted = set(placed.nodes[[e for e in near if e < len(placed.nodes)]].ravel().tolist())
    for e in np.flatnonzero(np.isin(placed.nodes, list(wanted)).any(axis=1)).tolist():
        for n in placed.nodes[e].tolist():
            if n in wanted:
                at_node.setdefault(n, []).append(e)
    for k in which.tolist():
        on, edge = int(hits.i[k]), int(hits.j[k])
        at = float(hits.at_j[k])
        if not inner_i[k]:
            on, edge, at = edge, on, float(hits.at_i[k])
        if edge >= len(placed.nodes):
            continue
        node = int(placed.nodes[edge][0 if at < 0.5 * s.length[edge] else 1])
        arms = [e for e in at_node[node] if placed.owner[e] == placed.owner[edge]]
        sides = {_side(s, on, _arm(placed, s, e, node)) for e in arms}
        if {-1, 1} <= sides:
            out.append(k)
    return out


def _arm(placed: Placed, s: Segments, edge: int, node: int) -> tuple[float, float]:
    """Return a point on segment ``edge`` a little away from its end at ``node``."""
    length = float(s.length[edge])
    step = min(STEP_AWAY_UM, 0.5 * length)
    at = step if placed.nodes[edge][0] == node else length - step
    x, y = points_at(s.take(np.array([edge])), np.array([at]))
    return float(x[0]), float(y[0])


def _side(s: Segments, on: int, point: tuple[float, float]) -> int:
    """Return +1 or -1 for the side of segment ``on`` that a point lies on, 0 for on it."""
    x, y = point
    if s.turn[on]:
        off = float(np.hypot(x - s.cx[on], y - s.cy[on]) - s.radius[on])
    else:
        off = float((y - s.y0[on]) * s.ux[on] - (x - s.x0[on]) * s.uy[on])
    return 0 if abs(off) <= TOUCH_UM else (1 if off > 0 else -1)


def _group_hits(
    hits: crossings.Crossings, which: Bools, pairs: tuple[Ints, Ints]
) -> list[tuple[tuple[int, int], list[int]]]:
    """Return hits by pair of contours, each from the lowest place on, pairs in that order too."""
    k = np.flatnonzero(which)
    low, high = np.minimum(*pairs)[k], np.maximum(*pairs)[k]
    k = k[np.lexsort((high, low, steady(hits.x[k]), steady(hits.y[k])))]
    groups: dict[tuple[int, int], list[int]] = {}
    for h in k.tolist():
        a, b = int(pairs[0][h]), int(pairs[1][h])
        groups.setdefault((min(a, b), max(a, b)), []).append(h)
    return list(groups.items())


def _crossings(
    placed: Placed,
    sources: tuple[Span, ...],
    hits: crossings.Crossings,
    which: Bools,
    pairs: tuple[Ints, Ints],
    complete: bool = True,
) -> list[Diagnostic]:
    """Return one error for each contour that crosses itself and each pair that crosses.

    ``complete``: there are no more of them than these.
    """
    findings = []
    groups = _group_hits(hits, which, pairs)
    for (a, b), group in groups[:LISTED]:
        places = _places(hits, group)
        first, second = _two(placed, sources, int(hits.i[group[0]]), int(hits.j[group[0]]))
        crossing = error(
            "self-crossing" if a == b else "crossing-contours",
            "a contour crosses itself at {place}" if a == b else "two contours cross at {place}",
            first,
            notes=(("it meets this", second),),
            hint="redraw it there"
            if a == b
            else "trim them, or put what is not to be cut on a layer of its own",
            points_mm=places,
            place=places[0],
        )
        if len(places) > 1:
            crossing = crossing.extended(
                ", and at {further} further places", further=len(places) - 1
            )
        findings.append(crossing)
    if len(groups) > LISTED:
        findings.append(
            error(
                "crossing-contours",
                "{count} further pairs cross"
                if complete
                else "at least {count} further pairs cross",
                count=len(groups) - LISTED,
            )
        )
    return findings


def _touches(
    placed: Placed,
    sources: tuple[Span, ...],
    s: Segments,
    hits: crossings.Crossings,
    which: Bools,
    pairs: tuple[Ints, Ints],
    crossed: set[tuple[int, int]],
) -> list[Diagnostic]:
    """Return one warning for each pair of contours that touch and do not cross."""
    findings = []
    touching: dict[tuple[int, int], tuple[Place, int, int]] = {}
    for pair, group in _group_hits(hits, which, pairs):
        touching[pair] = _places(hits, group)[0], int(hits.i[group[0]]), int(hits.j[group[0]])
    for pair, spot, i, j in _common_nodes(placed, s):
        touching.setdefault(pair, (spot, i, j))
    rest = sorted(
        (round(spot[1], 6), round(spot[0], 6), pair, i, j)
        for pair, (spot, i, j) in touching.items()
        if pair not in crossed
    )
    for y, x, (a, b), i, j in rest[:LISTED]:
        first, second = _two(placed, sources, i, j)
        findings.append(
            warning(
                "contours-touch",
                "a contour touches itself at {place}; nothing is left of the material there"
                if a == b
                else "two contours touch at {place}; nothing is left of the material there",
                first,
                notes=(("it touches this", second),),
                points_mm=((x, y),),
                place=Place(x, y),
            )
        )
    if len(rest) > LISTED:
        more = len(rest) - LISTED
        findings.append(warning("contours-touch", "contours touch at {count} more", count=more))
    return findings


def _common_nodes(placed: Placed, s: Segments) -> list[tuple[tuple[int, int], Place, int, int]]:
    """Return pairs of contours that share a vertex, where, and a segment of each."""
    n = len(placed.nodes)
    node = placed.nodes.reshape(-1)
    owner = np.repeat(placed.owner[:n], 2)
    order = np.lexsort((owner, node))
    order = order[owner[order] >= 0]
    next_to = node[order][1:] == node[order][:-1]
    other = owner[order][1:] != owner[order][:-1]
    out = []
    for k in np.flatnonzero(next_to & other).tolist():
        a, b = int(order[k]), int(order[k + 1])
        i, j = a // 2, b // 2
        x, y = (s.x1[i], s.y1[i]) if a % 2 else (s.x0[i], s.y0[i])
        pair = sorted((int(owner[a]), int(owner[b])))
        out.append(((pair[0], pair[1]), Place.of_um(x, y), i, j))
    return out


def _places(hits: crossings.Crossings, group: list[int]) -> tuple[Place, ...]:
    """Return the different places of some hits."""
    places: list[Place] = []
    seen = set()
    for k in group:
        spot = Place.of_um(hits.x[k], hits.y[k])
        key = (round(spot[0], 4), round(spot[1], 4))
        if key not in seen:
            seen.add(key)
            places.append(spot)
    return tuple(places)

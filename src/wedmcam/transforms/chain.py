"""Loose segments become contours.

CAD users draw outlines as loose lines and arcs, in any order and direction, whose ends almost meet.
A contour is what a wire can follow: a closed loop, or an open chain. The result depends on the
geometry alone: shuffled or reversed entities give the same contours, bit by bit.

In here, as in graph theory: a *node* is a place where ends meet, its *degree* how many; a node of
degree 1 is a *loose* end; one of odd degree from 3 on is a *branch*, where it is open how the
contour goes on. At a node of degree 4, 6, ... loops touch: they are told apart where there is
only one way to do so, which is where every segment belongs to at most one loop (a *cactus*).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import LISTED, Diagnostic, EntityRef, Place, Span, error
from wedmcam.geom.measure import segment_areas
from wedmcam.geom.segments import Floats, Ints, boxes, make
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.sketch import Sketch
from wedmcam.transforms.doubles import (
    columns,
    drop_copies,
    drop_zero_length,
    forward,
    is_circle,
    steady,
    zero_length,
)
from wedmcam.transforms.hints import with_linetypes
from wedmcam.transforms.joints import Joints, join
from wedmcam.transforms.meetings import Placed, meetings

Rows = NDArray[np.void]

#: Gaps above this are no drawing inaccuracy, um: no ``--join`` is proposed for them.
PROPOSED_UM = 1000.0


@dataclass(frozen=True, slots=True)
class ChainReport:
    """What chaining did.

    Attributes:
        closed: closed contours found.
        open: open ones.
        branches: places at which segments branch; those segments are in no contour.
        joins: pairs of ends that were more than float noise apart and were joined.
        max_shift_um: how far an end or the belly of an arc moved at most.
        duplicates: segments left out because another one repeats them.
        zero_length: pieces without length that were dropped.
    """

    closed: int = 0
    open: int = 0
    branches: int = 0
    joins: int = 0
    max_shift_um: float = 0.0
    duplicates: int = 0
    zero_length: int = 0

    def with_(self, other: ChainReport) -> ChainReport:
        """Return what both did."""
        mine, theirs = astuple(self), astuple(other)
        both = {f.name: a + b for f, a, b in zip(fields(self), mine, theirs, strict=True)}
        return ChainReport(**both | {"max_shift_um": max(self.max_shift_um, other.max_shift_um)})


Chained = tuple[tuple[Contour, ...], ChainReport, tuple[Diagnostic, ...]]


def chain(sketch: Sketch, join_um: float = 10.0) -> Chained:
    """Return the contours of a drawing.

    Args:
        sketch: loose segments.
        join_um: the largest gap between two ends that is closed, um; absolute.

    Returns:
        Contours, closed ones first, sorted by place (lowest, then left-most); a report; and
        findings: notes on repairs, errors on branches, overlaps and crossings. Closed contours run
        counter-clockwise from their lowest (then left-most) vertex, a circle from its right-most
        point; open ones from their smaller end (x, then y). Open contours are no error here: see
        `open_contour_findings`.
    """
    sources = sketch.sources
    rows, dropped, found_dropped = drop_zero_length(sketch.segments, sources)
    rows, copies, found_copies = drop_copies(rows, sources)
    ring = is_circle(rows)
    rings, rows = forward(rows[ring]), rows[~ring]
    joints, found_joins = join(rows, sources, join_um)
    # Noise may have pulled both ends of a piece together, and a join those of an almost full arc.
    shut = joints.nodes[:, 0] == joints.nodes[:, 1]
    found_shut: tuple[Diagnostic, ...] = ()
    if shut.any():
        full = shut & (columns(rows).sweep > math.pi)
        rings = np.concatenate([rings, forward(_full(rows[full]))])
        lost = shut & ~full
        if lost.any():
            dropped += int(lost.sum())
            found_shut = (zero_length(rows[lost], sources),)
        joints = Joints(
            joints.rows[~shut],
            joints.nodes[~shut],
            joints.x,
            joints.y,
            joints.joins,
            joints.max_shift_um,
        )
    closed, opened, found_branches, branches = _walk(joints, sources)
    contours, placed = _contours(joints, closed, opened, rings, sources)
    findings = (*found_dropped, *found_shut, *found_copies, *found_joins, *found_branches)
    report = ChainReport(
        closed=sum(c.closed for c in contours),
        open=sum(not c.closed for c in contours),
        branches=branches,
        joins=joints.joins,
        max_shift_um=joints.max_shift_um,
        duplicates=copies,
        zero_length=dropped,
    )
    return contours, report, with_linetypes((*findings, *meetings(placed, sources)))


def _full(rows: Rows) -> Rows:
    """Return full circles on the circles of ``rows``."""
    out = rows.copy()
    out["x1"], out["y1"] = out["x0"], out["y0"]
    return out


# --- from segments to runs ------------------------------------------------------------------
# A *half-edge* is a segment with a direction: 2 e leaves segment e at its start, 2 e + 1 at
# its end.

Chain = list[int]


def _walk(
    joints: Joints, sources: tuple[Span, ...]
) -> tuple[list[Chain], list[Chain], tuple[Diagnostic, ...], int]:
    """Return closed and open runs of half-edges, and errors where there is no one way to go on."""
    node = joints.nodes.reshape(-1)  # of half-edge h: where it leaves from
    m = len(node)
    degree = np.bincount(node, minlength=len(joints.x))
    at = np.argsort(node, kind="stable")
    first = np.cumsum(degree) - degree
    follow = np.full(m, -1, np.int64)  # the half-edge that goes on where h arrives, before h ^ 1
    pairs = np.flatnonzero(degree == 2)
    a, b = at[first[pairs]], at[first[pairs] + 1]
    follow[a], follow[b] = b, a
    go_on = follow.tolist()
    used = bytearray(m // 2)

    def run_from(h: int) -> Chain:
        start, path = h, []
        while True:
            path.append(h)
            used[h >> 1] = 1
            h = go_on[h ^ 1]
            if h < 0 or h == start:
                return path

    runs = [run_from(h) for h in np.flatnonzero(follow < 0).tolist() if not used[h >> 1]]
    closed = [run_from(2 * e) for e in range(m // 2) if not used[e]]
    if not (degree > 2).any():
        return closed, runs, (), 0
    more, opened, bad = _untangle(runs, node.tolist(), degree)
    findings = _branch_findings(bad, joints, at, first, degree, sources)
    return closed + more, opened, findings, len(bad)


def _untangle(
    runs: list[Chain], node: list[int], degree: Ints
) -> tuple[list[Chain], list[Chain], Ints]:
    """Split runs that end at branches or touching points into loops and chains.

    Returns:
        Loops, open chains, and the nodes at which there is no one way to go on.
    """
    parent: dict[int, int] = {}

    def root(v: int) -> int:
        while parent.setdefault(v, v) != v:
            parent[v] = v = parent[parent[v]]
        return v

    ends = [(node[r[0]], node[r[-1] ^ 1]) for r in runs]
    for u, v in ends:
        parent[root(u)] = root(v)
    groups: dict[int, list[int]] = {}
    for k, (u, _) in enumerate(ends):
        groups.setdefault(root(u), []).append(k)
    loops: list[Chain] = []
    chains: list[Chain] = []
    bad: list[int] = []
    for group in groups.values():
        here = sorted({v for k in group for v in ends[k]})
        odd = [v for v in here if degree[v] % 2]
        if any(degree[v] > 2 for v in odd):
            bad += [v for v in odd if degree[v] > 2]
            continue
        got, rest = _loops(group, runs, ends, odd or here)
        if len(odd) > 2 or len(got) != len(group) - len(here) + 1:
            bad += [v for v in here if degree[v] > 2]
            continue
        loops += got
        chains += rest
    return loops, chains, np.array(sorted(bad), np.int64)


def _loops(
    group: list[int], runs: list[Chain], ends: list[tuple[int, int]], starts: list[int]
) -> tuple[list[Chain], list[Chain]]:
    """Walk all runs of a connected group, cutting a loop off whenever the walk meets itself."""
    leaving: dict[int, list[int]] = {}
    for k in group:
        u, v = ends[k]
        leaving.setdefault(u, []).append(2 * k)
        leaving.setdefault(v, []).append(2 * k + 1)
    used: set[int] = set()
    loops: list[Chain] = []
    chains: list[Chain] = []
    waiting = list(starts)
    while waiting:
        v = waiting.pop()
        path: list[int] = []
        visited = {v: 0}
        while True:
            out = leaving[v]
            while out and out[-1] >> 1 in used:
                out.pop()
            if not out:
                break
            step = out.pop()
            used.add(step >> 1)
            path.append(step)
            v = ends[step >> 1][1 - (step & 1)]
            if v in visited:
                loop = path[visited[v] :]
                loops.append(_flatten(loop, runs))
                for s in loop[1:]:
                    gone = ends[s >> 1][s & 1]
                    del visited[gone]
                    waiting.append(gone)
                del path[visited[v] :]
            else:
                visited[v] = len(path)
        if path:
            chains.append(_flatten(path, runs))
            waiting += list(visited)
    return loops, chains


def _flatten(steps: list[int], runs: list[Chain]) -> Chain:
    """Return the half-edges of whole runs, each forward (2 k) or backward (2 k + 1)."""
    out: Chain = []
    for step in steps:
        run = runs[step >> 1]
        out += [h ^ 1 for h in reversed(run)] if step & 1 else run
    return out


def _branch_findings(
    bad: Ints,
    joints: Joints,
    at: Ints,
    first: Ints,
    degree: Ints,
    sources: tuple[Span, ...],
) -> tuple[Diagnostic, ...]:
    """Return one error for each place in ``bad``, up to `LISTED`."""
    findings = []
    for v in bad[:LISTED].tolist():
        where = Place.of_um(joints.x[v], joints.y[v])
        rows = at[first[v] : first[v] + degree[v]] // 2
        meet = Counter(joints.rows["source"][rows].tolist())
        known = [k for k in sorted(meet) if 0 <= k < len(sources)]
        closing = [k for k in known if _closing(joints, sources, k) in rows]
        notes = []
        for k in known:
            what = f"{meet[k]} segments of this meet there" if meet[k] > 1 else "this meets there"
            notes.append((what + (", one of them closes it" if k in closing else ""), sources[k]))
        branch = error(
            "branch",
            "{segments} segments meet at {place}, so the contour branches"
            if degree[v] % 2
            else "{segments} segments meet at {place}, in more than one way",
            sources[known[0]] if known else None,
            notes=tuple(notes),
            hint="clear the closed flag of {polylines} if it is to end there; else remove what is "
            "not to be cut, or put it on a layer of its own"
            if closing
            else "remove what is not to be cut, or put it on a layer of its own",
            points_mm=(where,),
            segments=int(degree[v]),
            place=where,
            polylines=[_name(sources[k]) for k in closing],
        )
        if closing:
            branch = branch.extended(
                "; one of them is the closing segment of {polylines}, whose closed flag is set"
            )
        findings.append(branch)
    if len(bad) > LISTED:
        more = len(bad) - LISTED
        findings.append(error("branch", "segments branch at {count} further places", count=more))
    return tuple(findings)


def _name(span: Span) -> str:
    return f"{span.dxftype} #{span.handle}" if isinstance(span, EntityRef) else str(span)


def _closing(joints: Joints, sources: tuple[Span, ...], k: int) -> int:
    """Return the row that closes a polyline of several segments; -1 where none does."""
    span = sources[k]
    if not isinstance(span, EntityRef) or span.dxftype not in ("LWPOLYLINE", "POLYLINE"):
        return -1
    rows = np.flatnonzero(joints.rows["source"] == k)
    if len(rows) < 2 or joints.nodes[rows[-1], 1] != joints.nodes[rows[0], 0]:
        return -1
    return int(rows[-1])


# --- from runs to contours ------------------------------------------------------------------


def _contours(
    joints: Joints,
    closed: list[Chain],
    opened: list[Chain],
    rings: Rows,
    sources: tuple[Span, ...],
) -> tuple[tuple[Contour, ...], Placed]:
    """Return the contours, canonical in direction, start and order, and where each row went."""
    rows, n = joints.rows, len(closed)
    runs = closed + opened
    half = np.array([h for run in runs for h in run], np.int64)
    sizes = np.array([len(run) for run in runs], np.int64)
    half = _orient(rows, half, sizes, n)
    edge, back = half // 2, half % 2 == 1
    x = np.where(back, rows["x1"][edge], rows["x0"][edge])
    y = np.where(back, rows["y1"][edge], rows["y0"][edge])
    total, offsets = len(half), np.cumsum(sizes) - sizes
    start = offsets.copy()
    if n:
        # Closed runs start at their lowest, then left-most vertex.
        inside = int(sizes[:n].sum())
        owner = np.repeat(np.arange(n), sizes[:n])
        order = np.lexsort((x[:inside], y[:inside], owner))
        start[:n] = order[offsets[:n]]
    turned = np.arange(total) - np.repeat(offsets, sizes) + np.repeat(start - offsets, sizes)
    turned = np.repeat(offsets, sizes) + turned % np.repeat(np.maximum(sizes, 1), sizes)
    half, edge, back = half[turned], edge[turned], back[turned]
    out = np.zeros(total, VERTEX)
    out["x"], out["y"] = x[turned], y[turned]
    out["turn"] = np.where(back, -rows["turn"][edge], rows["turn"][edge])
    arc = out["turn"] != 0
    out["cx"] = np.where(arc, rows["cx"][edge], 0.0)
    out["cy"] = np.where(arc, rows["cy"][edge], 0.0)
    out["source"] = rows["source"][edge]

    contours: list[Contour] = []
    for k, (a, size) in enumerate(zip(offsets.tolist(), sizes.tolist(), strict=True)):
        piece = out[a : a + size]
        if k >= n:
            last = np.zeros(1, VERTEX)
            e, end = edge[a + size - 1], 0 if back[a + size - 1] else 1
            last["x"], last["y"] = rows[f"x{end}"][e], rows[f"y{end}"][e]
            last["source"] = -1
            piece = np.concatenate([piece, last])
        contours.append(Contour(piece, k < n, sources))
    for ring in rings:
        contours.append(_ring(ring, sources))
    order = _sort(rows, edge, offsets, rings, contours)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    owner = np.full(len(rows) + len(rings), -1, np.int64)
    owner[edge] = rank[np.repeat(np.arange(len(runs)), sizes)]
    owner[len(rows) :] = rank[len(runs) :]
    placed = Placed(np.concatenate([rows, rings]), owner, joints.nodes)
    return tuple(contours[k] for k in order.tolist()), placed


def _ring(row: np.void, sources: tuple[Span, ...]) -> Contour:
    """Return the closed contour of one full circle."""
    out = np.zeros(1, VERTEX)
    for name, of in (("x", "x0"), ("y", "y0"), ("cx", "cx"), ("cy", "cy")):
        out[name] = row[of]
    out["turn"], out["source"] = 1, row["source"]
    return Contour(out, True, sources)


def _orient(rows: Rows, half: Ints, sizes: Ints, n: int) -> Ints:
    """Return the half-edges with every run in its canonical direction; the first n are closed."""
    if not len(half):
        return half
    edge, back = half // 2, half % 2 == 1
    s = columns(rows[edge])
    first = np.cumsum(sizes) - sizes
    x0, y0 = np.where(back, s.x1, s.x0), np.where(back, s.y1, s.y0)
    origin = np.repeat(x0[first], sizes), np.repeat(y0[first], sizes)
    part = segment_areas(s, origin)
    wrong = np.add.reduceat(np.where(back, -part, part), first) < 0
    last = first + sizes - 1
    x1, y1 = np.where(back, s.x0, s.x1)[last], np.where(back, s.y0, s.y1)[last]
    x0, y0 = x0[first], y0[first]
    wrong[n:] = ((x1 < x0) | ((x1 == x0) & (y1 < y0)))[n:]
    flip = np.repeat(wrong, sizes)
    place = np.arange(len(half))
    place = np.where(flip, np.repeat(first + last, sizes) - place, place)
    half = half[place]
    return np.where(flip, half ^ 1, half)


def _sort(rows: Rows, edge: Ints, first: Ints, rings: Rows, contours: list[Contour]) -> Ints:
    """Return the canonical order: closed before open, then by extents, lowest and left-most first.

    Extents are taken without their last digits, which differ with the direction in which an arc
    was drawn; contours of equal extents go by their first two vertices, which do not.
    """
    if not contours:
        return np.empty(0, np.int64)
    box = np.empty((4, len(contours)))
    if len(first):
        around = boxes(columns(rows[edge]))
        for k, least in enumerate((np.minimum, np.minimum, np.maximum, np.maximum)):
            box[k, : len(first)] = least.reduceat(around[k], first)
    box[:, len(first) :] = boxes(columns(rings))
    box = steady(box)
    opened = np.array([not c.closed for c in contours])
    start = np.array([c.vertices[0].item()[:5] for c in contours])
    second = np.array([c.vertices[min(1, len(c.vertices) - 1)].item()[:2] for c in contours])
    x, y, cx, cy, turn = start.T
    ties = (turn, cx, cy, second[:, 0], second[:, 1], x, y)
    return np.lexsort((*ties, box[2], box[3], box[0], box[1], opened))


# --- open contours --------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _End:
    x: float
    y: float
    contour: int
    span: Span | None

    @property
    def place(self) -> Place:
        return Place.of_um(self.x, self.y)


def open_contour_findings(
    contours: Sequence[Contour], join_um: float = 10.0
) -> tuple[Diagnostic, ...]:
    """Return an error for every open contour: where its ends are, and what would close it.

    Args:
        contours: of a drawing; closed ones are passed over.
        join_um: the tolerance that was in force, for the message.
    """
    ends: list[tuple[_End, _End]] = []
    pieces: list[_Piece | None] = []
    for k, c in enumerate(contours):
        if not c.closed:
            v = c.vertices
            first = _End(float(v["x"][0]), float(v["y"][0]), k, c.source_of(0))
            last = _End(float(v["x"][-1]), float(v["y"][-1]), k, c.source_of(len(v) - 2))
            ends.append((first, last))
            pieces.append(_piece(c))
    loose = [e for pair in ends for e in pair]
    xy = np.array([(e.x, e.y) for e in loose]).reshape(-1, 2)
    findings = []
    for at, ((first, last), piece) in enumerate(zip(ends[:LISTED], pieces, strict=False)):
        gap = math.hypot(last.x - first.x, last.y - first.y)
        nearest = [_nearest(xy, 2 * at + side, piece is not None) for side in (0, 1)]
        needed = max(d for _, d in nearest)
        if piece is not None and min(d for _, d in nearest) > PROPOSED_UM:
            findings.append(_loose_piece(piece, first, last))
            continue
        notes = []
        for end, (other, d) in zip((first, last), nearest, strict=True):
            if d < math.inf and loose[other].contour != end.contour:
                near = loose[other]
                text = f"the loose end nearest to {end.place:xy} is at {near.place}, "
                notes.append((f"{text}{d / 1e3:.3f} mm away", near.span))
        notes.append((f"the other end is at {last.place}", last.span))
        findings.append(
            error(
                "open-contour",
                "open contour: its ends {first:xy} and {last} are {gap_mm:.3f} mm apart; "
                "gaps up to {join_mm:.3f} mm are closed",
                first.span,
                notes=tuple(notes),
                hint="--join {needed_mm:.3f} would close the gap"
                if join_um < needed <= PROPOSED_UM
                else "the ends lie within --join, but the segment between them is shorter than that"
                if needed <= join_um
                else None,
                points_mm=(first.place, last.place),
                first=first.place,
                last=last.place,
                gap_mm=gap / 1e3,
                join_mm=join_um / 1e3,
                needed_mm=_up(needed) if needed < math.inf else None,
            )
        )
    if len(ends) > LISTED:
        more = len(ends) - LISTED
        findings.append(error("open-contour", "{count} further contours are open", count=more))
    return with_linetypes(findings)


@dataclass(frozen=True, slots=True)
class _Piece:
    """An open contour whose ends no join can bring together: what it is, and its length, um."""

    what: str
    length: float


def _piece(c: Contour) -> _Piece | None:
    """Return a contour as a piece, if it is one: a line, two lines, or an arc of half a turn.

    What is left of these when their ends meet encloses nothing.
    """
    a, b = c.starts, c.ends
    if len(a) > 2 or (len(a) == 2 and (a["turn"] != 0).any()):
        return None
    s = make(a["x"], a["y"], b["x"], b["y"], a["cx"], a["cy"], a["turn"])
    if s.sweep.max() > math.pi:
        return None
    what = "line" if len(a) == 1 and not a["turn"][0] else "arc" if len(a) == 1 else "piece"
    return _Piece(what, float(s.length.sum()))


def _loose_piece(piece: _Piece, first: _End, last: _End) -> Diagnostic:
    """Return the error about a piece that is far from every other loose end."""
    return error(
        "open-contour",
        "a loose {piece} of {length_mm:.3f} mm from {first:xy} to {last}: it belongs to no "
        "contour, and no --join can close it"
        if piece.length > PROPOSED_UM
        else "a loose {piece} of {length_mm:.3f} mm at {first}: it belongs to no contour, and "
        "no --join can close it",
        first.span,
        hint="delete it, or leave it out by its layer, type, line type or colour",
        points_mm=(first.place, last.place),
        piece=piece.what,
        length_mm=piece.length / 1e3,
        first=first.place,
        last=last.place,
    )


def _nearest(xy: Floats, end: int, others: bool = False) -> tuple[int, float]:
    """Return which other loose end is nearest to one, and how far away it is, um.

    ``others``: its own contour's other end does not count.
    """
    d = np.hypot(xy[:, 0] - xy[end, 0], xy[:, 1] - xy[end, 1])
    d[end] = np.inf
    if others:
        d[end ^ 1] = np.inf
    other = int(np.argmin(d))
    return other, float(d[other])


def _up(um: float) -> float:
    """Return a length in mm, rounded up to whole um."""
    return math.ceil(um - 1e-6) / 1e3

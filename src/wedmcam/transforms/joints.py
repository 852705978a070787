"""Which ends meet: exactly, but for float noise, or but for a gap that may be closed.

Ends meet by distance, never by rounding: a rounded coordinate splits two ends that lie on either
side of a half. Only ends that meet no other exactly look for a neighbour, nearest pair first, and
each gets one: a row of ends, each within the tolerance of the next, does not collapse into a point.
The tolerance is a length in um and knows nothing of the size of the drawing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place, Span, error, note
from wedmcam.geom.pairs import self_overlapping
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.transforms.doubles import NOISE_UM, columns, span_of

Rows = NDArray[np.void]

#: Joins below this are counted and not listed, um.
LISTED_UM = 1.0
#: A join may move the belly of an arc by this many times the join tolerance, not more: an arc that
#: almost closes would otherwise swing about its ends.
BELLY = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """Segments whose ends coincide exactly where they are joined.

    Attributes:
        rows: the segments, moved where they were joined.
        nodes: for each row the node of its start and of its end, shape (n, 2).
        x, y: where the nodes are, um.
        joins: how many pairs of ends more than float noise apart were joined.
        max_shift_um: how far an end, or the belly of an arc, moved at most.
    """

    rows: Rows
    nodes: Ints
    x: Floats
    y: Floats
    joins: int
    max_shift_um: float


def near_pairs(x: Floats, y: Floats, within: float) -> tuple[Ints, Ints, Floats]:
    """Return index pairs i < j of points at most ``within`` um apart, and their distances."""
    half = 0.5 * within
    i, j = self_overlapping((x - half, y - half, x + half, y + half))
    d = np.hypot(x[i] - x[j], y[i] - y[j])
    keep = d <= within
    return i[keep], j[keep], d[keep]


def join(
    rows: Rows, sources: tuple[Span, ...], join_um: float
) -> tuple[Joints, tuple[Diagnostic, ...]]:
    """Return ``rows`` joined where ends lie within ``join_um`` of each other.

    Where ends coincide exactly nothing changes. Within float noise (`NOISE_UM`) all take the place
    of one of them: of a line's end before an arc's (it was stated, not computed), then of the
    smallest (x, y). Otherwise both ends move to the middle; an arc keeps its radius and gets a new
    centre. The two ends of one short segment never join.
    """
    m = len(rows)
    x = np.concatenate([rows["x0"], rows["x1"]])
    y = np.concatenate([rows["y0"], rows["y1"]])
    order = np.lexsort((y, x))
    new = np.ones(2 * m, np.bool_)
    new[1:] = (np.diff(x[order]) != 0) | (np.diff(y[order]) != 0)
    node = np.empty(2 * m, np.int64)
    node[order] = np.cumsum(new) - 1
    px, py = x[order[new]], y[order[new]]  # nodes in order of (x, y)
    target = np.arange(len(px))
    by_line = np.zeros(len(px), np.bool_)
    by_line[node[np.tile(rows["turn"] == 0, 2)]] = True

    # All nodes, not only loose ends: loops that touch but for noise have to touch.
    i, j, _ = near_pairs(px, py, NOISE_UM)
    if len(i):
        _cluster(target, i, j, by_line)
    node = target[node]
    gaps, target = _gaps(rows, node, px, py, join_um)
    for gap in gaps:
        a, b = gap.kept, gap.other
        px[a], py[a] = 0.5 * (px[a] + px[b]), 0.5 * (py[a] + py[b])
    node = target[node]
    # Places that a join moved are no node of before: they follow from target via px, py.
    ends = node.reshape(2, m).T
    moved, belly, findings = _move_ends(rows, sources, ends, px, py, join_um)
    shift = max([gap.um / 2 for gap in gaps], default=0.0)
    if gaps:
        findings = (_gaps_closed(rows, sources, px, py, gaps), *findings)
    return Joints(moved, ends, px, py, len(gaps), max(shift, belly)), findings


def _cluster(target: Ints, i: Ints, j: Ints, by_line: NDArray[np.bool_]) -> None:
    """Give all nodes that the pairs connect one target: the best of them."""
    n = len(by_line)
    rank = np.where(by_line, 0, n) + np.arange(n)
    while True:
        low = np.minimum(rank[i], rank[j])
        if (low == rank[i]).all() and (low == rank[j]).all():
            break
        np.minimum.at(rank, i, low)
        np.minimum.at(rank, j, low)
    target[:] = rank % n


class _Gap(NamedTuple):
    """Two nodes that are joined in the middle, ``um`` apart; ``kept`` is the node of both then.

    ``row``: a segment that ends there.
    """

    um: float
    kept: int
    other: int
    row: int


def _gaps(
    rows: Rows, node: Ints, px: Floats, py: Floats, join_um: float
) -> tuple[list[_Gap], Ints]:
    """Return the gaps between loose ends and their nearest, and what becomes of each node.

    ``node``: of all starts, then of all ends.
    """
    degree = np.bincount(node, minlength=len(px))
    target = np.arange(len(px))
    odd = np.flatnonzero(degree % 2)
    i, j, d = near_pairs(px[odd], py[odd], join_um)
    i, j = odd[i], odd[j]
    keep = (degree[i] == 1) | (degree[j] == 1)
    i, j, d = i[keep], j[keep], d[keep]
    if not len(i):
        return [], target
    swing = columns(rows).sweep > np.pi
    # Nodes are numbered by (x, y), so i < j breaks ties by place and not by order of drawing.
    order = np.lexsort((j, i, d))
    m = len(rows)
    edge = np.full(len(px), -1, np.int64)
    edge[node] = np.tile(np.arange(m), 2)  # of a loose end: its one segment
    other = np.full(len(px), -1, np.int64)
    other[node] = np.roll(node, m)  # and of a loose end: the other end of that segment
    taken: set[int] = set()
    gaps: list[_Gap] = []
    for a, b, gap in zip(i[order].tolist(), j[order].tolist(), d[order].tolist(), strict=True):
        if a in taken or b in taken:
            continue
        loose = a if degree[a] == 1 else b
        if other[loose] == (b if loose == a else a) and not swing[edge[loose]]:
            continue  # a short segment would vanish
        taken.update((a, b))
        gaps.append(_Gap(gap, a, b, int(edge[a])))
        target[b] = a
    return gaps, target


def _gaps_closed(
    rows: Rows, sources: tuple[Span, ...], px: Floats, py: Floats, gaps: list[_Gap]
) -> Diagnostic:
    """Return the note on gaps that were closed, with the places of those that can be seen."""
    large = [gap for gap in gaps if gap.um >= LISTED_UM]
    few = len(gaps) - len(large)
    places = sorted((Place.of_um(px[gap.kept], py[gap.kept]), gap) for gap in large)
    finding = note(
        "join",
        "1 gap between ends closed" if len(gaps) == 1 else "{count} gaps between ends closed",
        notes=tuple(
            (f"{gap.um / 1e3:.3f} mm at {at}", span_of(rows[gap.row], sources))
            for at, gap in places
        ),
        points_mm=tuple(at for at, _ in places),
        count=len(gaps),
    )
    if large:
        largest = max(gap.um for gap in gaps)
        finding = finding.extended(", the largest {largest_mm:.3f} mm", largest_mm=largest / 1e3)
    if few:
        finding = finding.extended(
            "; {few} of them under {least_mm:.3f} mm", few=few, least_mm=LISTED_UM / 1e3
        )
    return finding


def _move_ends(
    rows: Rows, sources: tuple[Span, ...], ends: Ints, px: Floats, py: Floats, join_um: float
) -> tuple[Rows, float, tuple[Diagnostic, ...]]:
    """Return the rows with their ends on their nodes, and how far arcs moved at most."""
    out = rows.copy()
    for k in (0, 1):
        out[f"x{k}"], out[f"y{k}"] = px[ends[:, k]], py[ends[:, k]]
    shift = np.maximum(
        np.hypot(out["x0"] - rows["x0"], out["y0"] - rows["y0"]),
        np.hypot(out["x1"] - rows["x1"], out["y1"] - rows["y1"]),
    )
    # An arc that closed upon itself is a circle about its own centre; noise moves no centre.
    arc = np.flatnonzero((rows["turn"] != 0) & (shift > NOISE_UM) & (ends[:, 0] != ends[:, 1]))
    if not len(arc):
        return out, 0.0, ()
    # Counter-clockwise, whatever way it was drawn: direction must not change a digit.
    cx, cy, belly = _refit(columns(_ccw(rows[arc])), _ccw(out[arc]), shift[arc])
    out["cx"][arc], out["cy"][arc] = cx, cy
    findings = []
    for k in np.flatnonzero(belly > BELLY * join_um).tolist():
        start = Place.of_um(out["x0"][arc[k]], out["y0"][arc[k]])
        findings.append(
            error(
                "join-moves-arc",
                "closing a gap of {gap_mm:.3f} mm at the arc that starts at {start} would move "
                "the arc by {moved_mm:.3f} mm",
                span_of(rows[arc[k]], sources),
                hint="draw the arc to its end, or join less with --join",
                points_mm=(start,),
                gap_mm=2 * float(shift[arc[k]]) / 1e3,
                start=start,
                moved_mm=float(belly[k]) / 1e3,
            )
        )
    return out, float(belly.max()), tuple(findings)


def _ccw(rows: Rows) -> Rows:
    """Return arcs run counter-clockwise."""
    out = rows.copy()
    back = rows["turn"] < 0
    for a, b in (("x0", "x1"), ("y0", "y1")):
        out[a], out[b] = np.where(back, rows[b], rows[a]), np.where(back, rows[a], rows[b])
    out["turn"] = np.abs(rows["turn"])
    return out


def _refit(old: Segments, new: Rows, shift: Floats) -> tuple[Floats, Floats, Floats]:
    """Return centres of counter-clockwise arcs between new ends, and how far each belly moved.

    The radius is kept where that keeps the arc in place. Near a half circle it cannot: shortening
    the chord of a half circle of radius 1 mm by 5 um would lift its centre by 70 um. There the
    centre moves to the nearest place that is equally far from both ends instead, which changes the
    radius by no more than the ends moved.
    """
    ax, ay, bx, by = new["x0"], new["y0"], new["x1"], new["y1"]
    dx, dy = bx - ax, by - ay
    chord = np.hypot(dx, dy)
    chord = np.where(chord > 0, chord, 1.0)
    mx, my = 0.5 * (ax + bx), 0.5 * (ay + by)
    nx, ny = -dy / chord, dx / chord  # to the left of the chord
    high = np.sqrt(np.maximum(old.radius**2 - 0.25 * chord**2, 0.0))
    high = np.where(old.sweep <= np.pi, high, -high)
    near = (old.cx - mx) * nx + (old.cy - my) * ny
    choices = []
    for h in (high, near):
        cx, cy = mx + h * nx, my + h * ny
        r = np.hypot(ax - cx, ay - cy)
        belly = np.abs(r - old.radius)
        for share in (0.25, 0.5, 0.75):
            angle = old.a0 + share * old.sweep
            qx = old.cx + old.radius * np.cos(angle)
            qy = old.cy + old.radius * np.sin(angle)
            belly = np.maximum(belly, np.abs(np.hypot(qx - cx, qy - cy) - r))
        choices.append((cx, cy, belly))
    (kx, ky, kept), (fx, fy, fitted) = choices
    keep = (kept <= 2.0 * shift) | (kept <= fitted)
    return np.where(keep, kx, fx), np.where(keep, ky, fy), np.where(keep, kept, fitted)

"""The raw offset: every segment shifted by itself, and how the shifted neighbours meet.

A line shifts along its normal; an arc keeps its centre and changes its radius. Where two shifted
neighbours no longer meet, one of four things is true of the joint between them:

- snapped: they miss by so little that they meet in the middle (tangent joints, and arcs that shrank
  to a point). Crossing two nearly tangent curves would be ill-conditioned, so it is not done.
- transition: the wire goes round the corner on an arc about it, an *element* of its own.
- mitre: the shifted lines are prolonged to their crossing (``--convex sharp``).
- free: they overlap (inner corner), or an arc between them vanished; a crossing found later joins
  them, or other elements.

An *element* is a shifted segment or a transition arc. Elements of all contours stand in one array,
in the order of travel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import Contour

#: Segments shorter than this are noise of the drawing, not geometry; um.
SPECK_UM = 5e-3
#: Ends this near meet without further question; um.
SAME_END_UM = 2e-3
#: An arc with less radius than this is a point; um. Its ends are at most SAME_END_UM apart.
LEAST_RADIUS_UM = 1e-3
#: Ends nearer than this may meet in the middle, if that moves the path sideways by less than
#: SIDEWAYS_UM: half a step of the machine; um.
SNAP_UM = 0.5
SIDEWAYS_UM = 0.002
#: ``--convex sharp`` reaches at most this many offsets from the corner (spec, command line).
MITRE_LIMIT = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """The segments of all contours in one array, specks removed.

    Attributes:
        segments: as drawn, um relative to ``origin``.
        contour: which contour a segment belongs to.
        row: which row of that contour opened it.
        following: the next segment of the contour, -1 after the last of an open one.
        shift: how far the wire runs to the left of the segment (negative: right), um.
        origin: whole-um point that all coordinates are relative to.
    """

    segments: Segments
    contour: Ints
    row: Ints
    following: Ints
    shift: Floats
    origin: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Raw:
    """Elements, their order, and their joints.

    Attributes:
        elements: shifted segments and transition arcs, um relative to the origin.
        source: the segment (index into ``Source``) an element was shifted from; for a transition
            arc the segment before the corner.
        transition: whether the element is a transition arc.
        contour: which contour it belongs to.
        following: the next element of the contour, -1 at the end of an open one.
        joined: whether the element's end and the start of the following are one point.
        vanished: segments (indices into ``Source``) whose arc has no offset.
        slack: by how much the ends of an element were moved off its line or circle, um.
        bend: by how much the path turns where the element is joined to the following one, radians
            >= 0; 0 where a transition arc stands.
        prolonged: whether element and following one end where they cross beyond their ends.
        tangled: a closed contour does not turn once round in all: it crosses itself.
    """

    elements: Segments
    source: Ints
    transition: NDArray[np.bool_]
    contour: Ints
    following: Ints
    joined: NDArray[np.bool_]
    vanished: Ints
    slack: Floats
    bend: Floats
    prolonged: NDArray[np.bool_]
    tangled: bool


def gather(
    contours: Sequence[Contour], shifts: Sequence[float], speck_um: float = SPECK_UM
) -> Source:
    """Return the segments of all contours in one array, relative to a whole-um origin near them.

    Segments shorter than ``speck_um`` are left out; the chain stays connected.
    """
    columns: list[list[NDArray[Any]]] = [[] for _ in range(7)]
    contour_of, row_of, following, shift_of = [], [], [], []
    xs = np.concatenate([c.vertices["x"] for c in contours])
    ys = np.concatenate([c.vertices["y"] for c in contours])
    ox = float(np.round(0.5 * (xs.min() + xs.max())))
    oy = float(np.round(0.5 * (ys.min() + ys.max())))
    base = 0
    radii = []
    for number, (contour, shift) in enumerate(zip(contours, shifts, strict=True)):
        a, b = contour.starts, contour.ends
        x0, y0 = a["x"] - ox, a["y"] - oy
        x1, y1 = b["x"] - ox, b["y"] - oy
        cx, cy = a["cx"] - ox, a["cy"] - oy
        turn = a["turn"].astype(np.int8)
        rows = np.arange(len(a))
        radius = np.hypot(x0 - cx, y0 - cy)
        chord = np.hypot(x1 - x0, y1 - y0)
        speck = (chord < speck_um) & ~((turn != 0) & (chord == 0))
        # A nearly closed arc has a short chord too; its middle is a diameter away.
        if (speck & (turn != 0)).any():
            s = seg.make(x0, y0, x1, y1, cx, cy, turn)
            speck &= s.length < speck_um
        if speck.any() and not speck.all():
            keep = np.flatnonzero(~speck)
            # The segment after a speck starts where the speck did: the chain stays connected.
            nx1 = np.append(x0[keep[1:]], x0[keep[0]] if contour.closed else x1[-1])
            ny1 = np.append(y0[keep[1:]], y0[keep[0]] if contour.closed else y1[-1])
            x0, y0, cx, cy, turn = x0[keep], y0[keep], cx[keep], cy[keep], turn[keep]
            radius, rows, x1, y1 = radius[keep], rows[keep], nx1, ny1
        n = len(rows)
        for column, values in zip(columns, (x0, y0, x1, y1, cx, cy, turn), strict=True):
            column.append(np.asarray(values))
        radii.append(radius)
        nxt = np.arange(base + 1, base + n + 1)
        nxt[-1] = base if contour.closed else -1
        following.append(nxt)
        contour_of.append(np.full(n, number))
        row_of.append(rows)
        shift_of.append(np.full(n, shift))
        base += n
    x0, y0, x1, y1, cx, cy, turn = (np.concatenate(c) for c in columns)
    segments = seg.make(x0, y0, x1, y1, cx, cy, turn.astype(np.int8), np.concatenate(radii))
    return Source(
        segments,
        np.concatenate(contour_of),
        np.concatenate(row_of),
        np.concatenate(following),
        np.concatenate(shift_of),
        (ox, oy),
    )


def raw_offset(source: Source, sharp: bool | Sequence[bool]) -> Raw:
    """Return every segment shifted, with transition arcs (or mitres) at outer corners.

    ``sharp``: mitres, for all contours or for each.
    """
    s, shift = source.segments, source.shift
    arc = s.turn != 0
    radius = np.where(arc, s.radius - shift * s.turn, 0.0)
    vanished = arc & (radius <= LEAST_RADIUS_UM)
    t0x, t0y = seg.start_tangents(s)
    t1x, t1y = seg.end_tangents(s)
    x0, y0 = s.x0 - shift * t0y, s.y0 + shift * t0x
    x1, y1 = s.x1 - shift * t1y, s.y1 + shift * t1x

    nxt = source.following
    has = nxt >= 0
    k = np.where(has, nxt, 0)
    dot = t1x * t0x[k] + t1y * t0y[k]
    cross = t1x * t0y[k] - t1y * t0x[k]
    turn = np.where(has, np.arctan2(cross, dot), 0.0)
    turning = np.abs(turn)
    gx, gy = x0[k] - x1, y0[k] - y1
    gap = np.hypot(gx, gy)
    bow = np.where(arc, 0.125 / np.maximum(radius, LEAST_RADIUS_UM), 0.0)
    sideways = np.maximum(
        0.5 * np.abs(gx * t1y - gy * t1x) + gap * gap * bow,
        0.5 * np.abs(gx * t0y[k] - gy * t0x[k]) + gap * gap * bow[k],
    )
    # The wire goes round a corner that turns away from it; a full reversal it always goes round.
    outer = has & ((cross * shift < 0) | ((dot < 0) & (np.abs(cross) < 1e-12)))
    shifted_length = np.where(arc, np.maximum(radius, 0.0) * s.sweep, s.length)
    short = np.minimum(shifted_length, shifted_length[k])
    meets = has & ~vanished & ~vanished[k] & _snaps(gap, sideways, turning, short)
    # Without a gap there is nothing to go round (next to an arc that vanishes).
    corner = outer & ~meets & (shift != 0) & (gap > 0.05 * SAME_END_UM)

    prolonged = np.zeros(len(s), bool)
    prolongs = np.broadcast_to(sharp, source.contour.max(initial=0) + 1)[source.contour] & corner
    if prolongs.any():
        sideways = sideways.copy()
        moved = _mitre(s, shift, radius, prolongs & ~vanished & ~vanished[k], k, x1, y1)
        rows, mx, my = moved
        x1[rows], y1[rows] = mx, my
        x0[k[rows]], y0[k[rows]] = mx, my
        corner[rows] = False
        meets[rows] = prolonged[rows] = True
        sideways[rows] = 0.0

    # Snapped ends meet in the middle; both elements end there.
    rows = np.flatnonzero(meets)
    slack = np.abs(np.hypot(s.x1 - s.cx, s.y1 - s.cy) - s.radius) * arc
    slack[rows] = np.maximum(slack[rows], sideways[rows])
    slack[k[rows]] = np.maximum(slack[k[rows]], sideways[rows])
    mx, my = 0.5 * (x1[rows] + x0[k[rows]]), 0.5 * (y1[rows] + y0[k[rows]])
    x1[rows], y1[rows] = mx, my
    x0[k[rows]], y0[k[rows]] = mx, my

    # Elements in order of travel: segment i at key 2 i, the transition after it at 2 i + 1.
    alive = np.flatnonzero(~vanished)
    corners = np.flatnonzero(corner)
    ck = k[corners]
    elements = seg.make(
        np.concatenate([x0[alive], x1[corners]]),
        np.concatenate([y0[alive], y1[corners]]),
        np.concatenate([x1[alive], x0[ck]]),
        np.concatenate([y1[alive], y0[ck]]),
        np.concatenate([s.cx[alive], s.x1[corners]]),
        np.concatenate([s.cy[alive], s.y1[corners]]),
        np.concatenate([s.turn[alive], -np.sign(shift[corners])]).astype(np.int8),
        np.concatenate([radius[alive], np.abs(shift[corners])]),
        np.concatenate([s.sweep[alive], turning[corners]]),
    )
    key = np.concatenate([2 * alive, 2 * corners + 1])
    order = np.argsort(key, kind="stable")
    elements = elements.take(order)
    of = np.concatenate([alive, corners])[order]
    transition = np.concatenate([np.zeros(len(alive), bool), np.ones(len(corners), bool)])[order]
    contour = source.contour[of]

    # The following element: the next in the array, round the contour where it is closed.
    count = len(of)
    following = np.arange(1, count + 1)
    if count:
        last = np.flatnonzero(np.append(contour[1:] != contour[:-1], True))
        first = np.append(0, last[:-1] + 1)
        open_ends = source.following[_last_of_contour(source)] < 0
        closed = ~open_ends[contour[last]]
        following[last] = np.where(closed, first, -1)
    none = np.zeros(len(corners))
    slack = np.concatenate([slack[alive], none])[order]
    bend = np.concatenate([np.where(meets, turning, 0.0)[alive], none])[order]
    joined, elements = _joints(elements, following, slack, bend)
    return Raw(
        elements,
        of,
        transition,
        contour,
        following,
        joined,
        np.flatnonzero(vanished),
        slack,
        bend,
        np.concatenate([prolonged[alive], none > 0])[order],
        _tangled(source, turn),
    )


def _tangled(source: Source, turn: Floats) -> bool:
    """Return whether a closed contour's heading does not turn by one whole turn."""
    s = source.segments
    total = np.bincount(source.contour, s.sweep * s.turn + turn)
    is_open = source.following[_last_of_contour(source)] < 0
    # A contour of no segments does not occur: one is always left.
    return bool((~is_open & (np.abs(np.abs(total) - seg.TAU) > 0.1)).any())


def _last_of_contour(source: Source) -> Ints:
    last = np.flatnonzero(np.append(source.contour[1:] != source.contour[:-1], True))
    return last.astype(np.int64)


def _snaps(gap: Floats, sideways: Floats, turning: Floats, short: Floats) -> NDArray[np.bool_]:
    """Return where ends ``gap`` apart may meet in the middle, which moves them ``sideways``.

    An element shorter than four gaps is not moved: it could turn round. Nor is a turn back.
    """
    near = (gap < SAME_END_UM) | ((gap < SNAP_UM) & (sideways < SIDEWAYS_UM) & (turning < 1.5))
    result: NDArray[np.bool_] = near & (gap <= 0.25 * short)
    return result


def _joints(
    e: Segments, following: Ints, slack: Floats, bend: Floats
) -> tuple[NDArray[np.bool_], Segments]:
    """Return which elements are joined to the following one, snapping over vanished arcs.

    Elements that stand next to each other because an arc between them shrank to (nearly) a point
    are snapped here, and ``slack`` and ``bend`` filled in; neighbours in the drawing were snapped
    before.
    """
    count = len(following)
    has = following >= 0
    k = np.where(has, following, 0)
    joined = has & (e.x0[k] == e.x1) & (e.y0[k] == e.y1)
    loose = np.flatnonzero(has & ~joined)
    if not len(loose) or count < 2:
        return joined, e
    f = k[loose]
    gx, gy = e.x0[f] - e.x1[loose], e.y0[f] - e.y1[loose]
    t1x, t1y = seg.end_tangents(e.take(loose))
    t0x, t0y = seg.start_tangents(e.take(f))
    turning = np.abs(np.arctan2(t1x * t0y - t1y * t0x, t1x * t0x + t1y * t0y))
    gap = np.hypot(gx, gy)
    bow = np.where(e.turn != 0, 0.125 / np.maximum(e.radius, LEAST_RADIUS_UM), 0.0)
    sideways = np.maximum(
        0.5 * np.abs(gx * t1y - gy * t1x) + gap * gap * bow[loose],
        0.5 * np.abs(gx * t0y - gy * t0x) + gap * gap * bow[f],
    )
    short = np.minimum(e.length[loose], e.length[f])
    snapped = _snaps(gap, sideways, turning, short)
    rows = loose[snapped]
    if len(rows):
        x0, y0, x1, y1 = e.x0.copy(), e.y0.copy(), e.x1.copy(), e.y1.copy()
        f = k[rows]
        mx, my = 0.5 * (x1[rows] + x0[f]), 0.5 * (y1[rows] + y0[f])
        x1[rows], y1[rows], x0[f], y0[f] = mx, my, mx, my
        bend[rows] = turning[snapped]
        slack[rows] = np.maximum(slack[rows], sideways[snapped])
        slack[f] = np.maximum(slack[f], sideways[snapped])
        e = seg.make(x0, y0, x1, y1, e.cx, e.cy, e.turn, e.radius, e.sweep)
        joined[rows] = True
    return joined, e


def _mitre(
    s: Segments,
    shift: Floats,
    radius: Floats,
    corner: NDArray[np.bool_],
    k: Ints,
    x1: Floats,
    y1: Floats,
) -> tuple[Ints, Floats, Floats]:
    """Return (rows, x, y): outer corners whose prolonged neighbours cross within the limit.

    Prolonged arcs are whole circles; of two crossings the one nearest to the corner counts, and it
    must lie ahead of the segment before and behind the one after.
    """
    from wedmcam.arithmetic import FLOAT64
    from wedmcam.geom import formulas

    rows_out, xs_out, ys_out = [], [], []
    rows = np.flatnonzero(corner)
    t1x, t1y = seg.end_tangents(s)
    t0x, t0y = seg.start_tangents(s)
    for i in rows.tolist():
        j = int(k[i])
        d = shift[i]
        vx, vy = s.x1[i], s.y1[i]
        p = (vx - d * t1y[i], vy + d * t1x[i])
        q = (vx - d * t0y[j], vy + d * t0x[j])
        ti, tj = s.turn[i] != 0, s.turn[j] != 0
        candidates: list[tuple[float, float]] = []
        if not ti and not tj:
            if abs(s.ux[i] * s.uy[j] - s.uy[i] * s.ux[j]) > 1e-9:
                candidates.append(
                    formulas.line_line(FLOAT64, p, (s.ux[i], s.uy[i]), q, (s.ux[j], s.uy[j]))
                )
        elif ti != tj:
            line, arc, at = (i, j, p) if tj else (j, i, q)
            u = (s.ux[line], s.uy[line])
            c = (s.cx[arc], s.cy[arc])
            if abs((c[0] - at[0]) * u[1] - (c[1] - at[1]) * u[0]) < radius[arc]:
                candidates += [
                    formulas.line_circle(FLOAT64, at, u, c, radius[arc], root) for root in (1, -1)
                ]
        else:
            c, e = (s.cx[i], s.cy[i]), (s.cx[j], s.cy[j])
            apart = float(np.hypot(e[0] - c[0], e[1] - c[1]))
            if abs(radius[i] - radius[j]) < apart < radius[i] + radius[j]:
                candidates += [
                    formulas.circle_circle(FLOAT64, c, radius[i], e, radius[j], root)
                    for root in (1, -1)
                ]
        best = None
        for x, y in candidates:
            reach = float(np.hypot(x - vx, y - vy))
            ahead = (x - p[0]) * t1x[i] + (y - p[1]) * t1y[i]
            behind = (q[0] - x) * t0x[j] + (q[1] - y) * t0y[j]
            within = reach <= MITRE_LIMIT * abs(d) and ahead >= 0 and behind >= 0
            if within and (best is None or reach < best[0]):
                best = (reach, float(x), float(y))
        if best is not None:
            rows_out.append(i)
            xs_out.append(best[1])
            ys_out.append(best[2])
    return np.array(rows_out, np.int64), np.array(xs_out), np.array(ys_out)

"""The extremes of blocks whose run along the route is proven already: less to do a place.

``bounds`` has told that such a block lies beside one segment and never turns back, so its progress
need not be measured place by place, only how far its places lie from the segment. Places beyond the
ends of the stretch can be only the first and last few.
"""

from __future__ import annotations

import numpy as np

from wedmcam.judge.deviation import Measured, Pieces, chunks, gouge_of
from wedmcam.judge.material import Kept
from wedmcam.judge.route import Route
from wedmcam.judge.segments import Floats, Ints, Segments, point_distance
from wedmcam.judge.walk import Walk

#: How many places at either end of a block may lie beyond its stretch. Blocks overrun by less than
#: 2.5 um (half of ``SLOP``), and eight steps move on by 5.6 um at least.
ENDS = 12


def extremes(
    walk: Walk, index: Ints, low: Floats, high: Floats, route: Route, kept: Kept | None
) -> Measured:
    """Measure deviation and gouge of blocks ``index``, each beside one segment of the route.

    Progress, and so ``stray`` and ``extents``, are not measured.
    """
    out = Measured(len(index))
    segment = np.searchsorted(route.at, low, "right") - 1
    for rows in chunks(walk.steps[index]):
        x, y, steps = walk.points(index[rows])
        held = segment[rows]
        s = route.segments.take(held)
        v = _beside(x, y, s, steps)
        first = np.cumsum(steps) - steps
        # The first places of each block, and then the last from the end on.
        ramp = np.minimum(np.arange(ENDS), steps[:, None] - 1)
        head, tail = first[:, None] + ramp, (first + steps - 1)[:, None] - ramp
        ends = np.concatenate([head, tail], axis=1)
        _beyond(x, y, v, ends, s, held, low[rows], high[rows], route)
        out.low[rows] = np.minimum(np.minimum.reduceat(v, first), 0.0)
        out.high[rows] = np.maximum(np.maximum.reduceat(v, first), 0.0)
        at_vertex = np.flatnonzero(route.to[held] == high[rows])
        last = tail[at_vertex, :5]
        dx = x[last] - s.bx[at_vertex][:, None]
        dy = y[last] - s.by[at_vertex][:, None]
        out.gap[rows][at_vertex] = np.sqrt((dx * dx + dy * dy).min(axis=1))
        if kept is not None:
            n = len(steps)
            pieces = Pieces(held, np.arange(n), steps, low[rows], high[rows])
            gouge_of(out, kept, x, y, v, pieces, rows.start)
    return out


def _beside(x: Floats, y: Floats, s: Segments, steps: Ints) -> Floats:
    """Return the signed distance (left > 0) of places from the carrier of their block's segment."""
    arc = s.turn != 0
    if arc.all():
        qx, qy = x - np.repeat(s.cx, steps), y - np.repeat(s.cy, steps)
        qx *= qx
        qy *= qy
        qx += qy
        np.sqrt(qx, out=qx)
        np.subtract(np.repeat(s.radius, steps), qx, out=qx)
        qx *= np.repeat(s.turn, steps)
        return qx
    if not arc.any():
        v = np.repeat(s.mx, steps)
        v *= y - np.repeat(s.ay, steps)
        across = x - np.repeat(s.ax, steps)
        across *= np.repeat(s.my, steps)
        v -= across
        return v
    v = np.empty(len(x))
    on_arc = np.repeat(arc, steps)
    for places, blocks in ((np.flatnonzero(on_arc), arc), (np.flatnonzero(~on_arc), ~arc)):
        v[places] = _beside(x[places], y[places], s.take(blocks), steps[blocks])
    return v


def _beyond(
    x: Floats,
    y: Floats,
    v: Floats,
    ends: Ints,
    s: Segments,
    segment: Ints,
    low: Floats,
    high: Floats,
    route: Route,
) -> None:
    """Correct ``v`` of places beyond the ends of their stretch: the nearest segment counts."""
    at = route.at[segment][:, None]
    px, py = x[ends], y[ends]
    t = (px - s.ax[:, None]) * s.mx[:, None] + (py - s.ay[:, None]) * s.my[:, None]
    arc = np.flatnonzero(s.turn != 0)
    if len(arc):
        qx, qy = px[arc] - s.cx[arc, None], py[arc] - s.cy[arc, None]
        mx, my, radius = s.mx[arc, None], s.my[arc, None], s.radius[arc, None]
        angle = np.arctan2(mx * qy - my * qx, mx * qx + my * qy) * s.turn[arc, None]
        angle += s.half[arc, None]
        # In the turn in which the stretch has this end.
        meant = np.repeat(np.stack([low[arc], high[arc]], axis=1) - at[arc], ENDS, axis=1) / radius
        angle += 2.0 * np.pi * np.round((meant - angle) / (2.0 * np.pi))
        t[arc] = angle * radius
    t += at
    beyond = (t < low[:, None]) | (t > high[:, None])
    rows = ends[beyond]
    if not len(rows):
        return
    held = np.broadcast_to(segment[:, None], ends.shape)[beyond][:, None]
    cut = route.cut[held]
    near = np.clip(held + np.arange(-2, 3), route.first[cut], route.first[cut + 1] - 1)
    d = point_distance(route.segments.take(near), x[rows, None], y[rows, None]).min(axis=1)
    v[rows] = np.where(v[rows] < 0, -d, d)

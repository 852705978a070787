"""What can be told of a block without looking at its places, so that few have to be looked at.

A block that was made for its stretch of the route is one line beside one line, or one arc beside
one arc of the same sense. Then closed forms bound everything ``deviation`` measures:

- the controller knows the extremes w of the block's own path about its own line or circle, exactly;
  that line or circle differs from the route's by what the block's start, direction, centre and
  radius tell; the sum bounds the distance of every place from the route;
- a stepped line never steps back on an axis, and a stepped arc never turns back about its centre,
  so progress along the route is the progress of the ends, and falls back by no more than the
  difference of the two directions or centres makes.

Bounds are never below what measuring would find, and mostly within some tenths of a um of it. What
they leave open is measured: blocks with other duties (several segments, tiny radii, chords of an
arc), whatever might be over a limit, and the blocks that might hold a figure's extreme.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wedmcam.ir.program import Kind
from wedmcam.judge.route import Route
from wedmcam.judge.segments import Bools, Floats, Ints
from wedmcam.judge.track import progress
from wedmcam.judge.walk import Walk

#: Arcs below this radius are measured, um: the series for a moved centre need it large against the
#: few um by which centres differ.
SMALL = 60.0

#: Centres and radii of a block and its segment differ by less than this, um, or it is measured.
APART = 6.0

#: Room for the rounding of float64 in sums of a few numbers below 10^7, um.
FUZZ = 1e-7


class Bounds(NamedTuple):
    """One entry a block; um.

    Attributes:
        known: the bounds hold; other blocks have to be measured.
        low: no place lies farther to the right of the route, <= 0.
        high: nor to the left, >= 0.
        least: some place lies at least so far from the route; 0 where that is not known.
        gap: no vertex at which the block ends is farther from the wire.
        back: progress falls back by no more than this within the block.
        over: and passes the end of the stretch by no more.
        under: and begins before the start of the stretch by no more.
        short: the ends miss those of the stretch inwards by no more.
    """

    known: Bools
    low: Floats
    high: Floats
    least: Floats
    gap: Floats
    back: Floats
    over: Floats
    under: Floats
    short: Floats

    @property
    def deviation(self) -> Floats:
        """What the deviation of each block, both ways, is not above."""
        return np.maximum(np.maximum(-self.low, self.high), self.gap)


def bound(way: Walk, index: Ints, low: Floats, high: Floats, route: Route) -> Bounds:
    """Bound blocks ``index`` of the walk on their stretches of progress from low to high.

    Every block makes at least one step, and steps are counted (not ``textbook``).
    """
    n = len(index)
    blocks = way.blocks[index]
    first = np.searchsorted(route.at, low, "right") - 1
    last = np.maximum(np.searchsorted(route.at, high, "left") - 1, first)
    known = (first == last) & (high > low)
    first = np.maximum(first, 0)
    start, end = way.start[index].astype(np.float64), way.end[index].astype(np.float64)
    is_arc = blocks["kind"] == Kind.ARC
    turn = np.where(is_arc, blocks["turn"], 0)
    known &= turn == route.segments.turn[first]
    out = Bounds(known, *(np.zeros(n) for _ in range(8)))
    for mask, work in ((~is_arc, _lines), (is_arc, _arcs)):
        rows = np.flatnonzero(known & mask)
        if len(rows):
            work(out, rows, way, index[rows], start[rows], end[rows], first[rows], low, high, route)
    at_vertex = route.to[first] == high
    s = route.segments
    missed = np.hypot(end[:, 0] - s.bx[first], end[:, 1] - s.by[first])
    out.gap[:] = np.where(at_vertex, missed, 0.0)
    # Places beyond the ends of the stretch are measured to its end, not to the carrier's foot.
    beyond = np.maximum(out.over, out.under)
    out.low[:] = -np.hypot(out.low, beyond)
    out.high[:] = np.hypot(out.high, beyond)
    return out


def _lines(
    out: Bounds,
    rows: Ints,
    way: Walk,
    index: Ints,
    start: Floats,
    end: Floats,
    first: Ints,
    low: Floats,
    high: Floats,
    route: Route,
) -> None:
    """Bound lines beside lines."""
    blocks = way.blocks[index]
    s = route.segments.take(first)
    at = route.at[first]
    dx, dy = blocks["x"].astype(np.float64), blocks["y"].astype(np.float64)
    length = np.hypot(dx, dy)
    dx, dy = dx / length, dy / length
    own_low, own_high = way.stepping.deviation(blocks)
    # Places: start + s (dx, dy) + w (-dy, dx), own_low <= w <= own_high, 0 <= s <= their reach.
    mx, my = end[:, 0] - start[:, 0], end[:, 1] - start[:, 1]
    reach = mx * dx + my * dy
    cos, sin = dx * s.mx + dy * s.my, s.mx * dy - s.my * dx
    begin = s.mx * (start[:, 1] - s.ay) - s.my * (start[:, 0] - s.ax)
    drift = reach * sin
    least_off, most_off = begin + np.minimum(drift, 0.0), begin + np.maximum(drift, 0.0)
    out.known[rows] &= cos > 0.5
    out.low[rows] = np.minimum(least_off + own_low, 0.0) - FUZZ
    out.high[rows] = np.maximum(most_off + own_high, 0.0) + FUZZ
    inner = np.maximum(-(most_off + own_low * cos), least_off + own_high * cos)
    # A step against the route's direction: an axis on which the two differ in sign.
    back = np.maximum(-mx * s.mx, 0.0) + np.maximum(-my * s.my, 0.0)
    t0 = at + (start[:, 0] - s.ax) * s.mx + (start[:, 1] - s.ay) * s.my
    t1 = at + (end[:, 0] - s.ax) * s.mx + (end[:, 1] - s.ay) * s.my
    _progress(out, rows, t0, t1, back, low, high, inner)


def _arcs(
    out: Bounds,
    rows: Ints,
    way: Walk,
    index: Ints,
    start: Floats,
    end: Floats,
    first: Ints,
    low: Floats,
    high: Floats,
    route: Route,
) -> None:
    """Bound arcs beside arcs of their sense."""
    blocks = way.blocks[index]
    s = route.segments.take(first)
    at = route.at[first]
    x, y = blocks["x"].astype(np.float64), blocks["y"].astype(np.float64)
    own = np.hypot(x, y)
    own_low, own_high = way.stepping.deviation(blocks)
    ox, oy = start[:, 0] - x - s.cx, start[:, 1] - y - s.cy  # own centre from the segment's
    apart = np.hypot(ox, oy)
    # |own centre + (own + w) u| = own + w + o.u + at most o^2 / 2 (own + w), u the direction.
    sweep = way.lengths()[index] / own
    middle = np.arctan2(y, x) + s.turn * sweep / 2.0
    o_angle = np.arctan2(oy, ox)
    half = np.minimum(sweep / 2.0 + 4.0 / own, np.pi)
    most = _largest_cosine(o_angle - middle, half) * apart
    least = -_largest_cosine(o_angle + np.pi - middle, half) * apart
    thick = apart * apart / (2.0 * np.maximum(own + own_low - apart, 1.0))
    radius = s.radius - own  # the place is (radius - w - o.u - ...) inside the segment's circle
    inside_most = radius - own_low - least
    inside_least = radius - own_high - most - thick
    ccw = s.turn > 0
    out.low[rows] = np.minimum(np.where(ccw, inside_least, -inside_most), 0.0) - FUZZ
    out.high[rows] = np.maximum(np.where(ccw, inside_most, -inside_least), 0.0) + FUZZ
    inner = np.maximum(radius - own_low - most - thick, -(radius - own_high - least))
    ok = (own >= SMALL) & (s.radius >= SMALL) & (apart <= APART) & (np.abs(radius) <= APART)
    out.known[rows] &= ok & np.isfinite(sweep)
    if not ok.all():
        own = np.where(ok, own, SMALL)
    # Angles about the two centres differ by o x u / |place|: along the arc that never turns
    # progress back, only the path's own width can.
    ratio = s.radius / (own + own_low)
    back = 1.1 * ratio * apart * (own_high - own_low + 1.0) / (own + own_low)
    turn_um = 2.0 * np.pi * np.maximum(s.radius, 1.0)
    t0 = at + progress(s, start[:, 0], start[:, 1])
    t0 += turn_um * np.round((low[rows] - t0) / turn_um)
    # The whole way run, from the block's own sweep; its end exactly, in the turn that this tells.
    t1 = at + progress(s, end[:, 0], end[:, 1])
    t1 += turn_um * np.round((t0 + s.radius * sweep - t1) / turn_um)
    _progress(out, rows, t0, t1, back, low, high, inner)


def _largest_cosine(angle: Floats, half: Floats) -> Floats:
    """Return the largest cosine of ``angle`` minus anything from -half to half."""
    off = np.abs(np.mod(angle + np.pi, 2.0 * np.pi) - np.pi)
    return np.asarray(np.cos(np.maximum(off - half, 0.0)))


def _progress(
    out: Bounds,
    rows: Ints,
    t0: Floats,
    t1: Floats,
    back: Floats,
    low: Floats,
    high: Floats,
    inner: Floats,
) -> None:
    """Fill what bounds progress, and the least deviation of blocks that stay on their stretch."""
    back = back + FUZZ
    out.back[rows] = back
    out.over[rows] = np.maximum(t1 + back - high[rows], 0.0)
    out.under[rows] = np.maximum(low[rows] - (t0 - back), 0.0)
    out.short[rows] = np.maximum(np.maximum(t0 - low[rows], high[rows] - t1), 0.0)
    stays = (t1 + back <= high[rows] + FUZZ) & (t0 - back >= low[rows] - FUZZ)
    out.least[rows] = np.where(stays, np.maximum(inner - FUZZ, 0.0), 0.0)

"""By how much arcs leave the curves that they stand for, measured on its own.

The fit looks at few places and at circles; here both ways are measured, at many places, between
the curve and the arcs as they are, ends included. What may happen between two places is added: an
eighth of the second difference there, which is what a parabola rises over its chord.
"""

from __future__ import annotations

import numpy as np

from wedmcam.geom.biarc import Arcs, fit
from wedmcam.geom.curves import Floats, Ints, Sections

#: Places on each piece, and on each of its arcs for the way back.
PLACES, BACK = 65, 17
#: Sections whose fit turns out too coarse are fitted anew, this often at most.
AGAIN = 5
#: From this many tolerances on a fit has failed, and is not tried again.
HOPELESS = 100.0
#: Pieces measured at a time: it bounds the memory.
CHUNK = 1000


def departure(sections: Sections, arcs: Arcs) -> Floats:
    """Return the largest distance between each piece and its arcs, both ways, um: upper bounds."""
    out = np.zeros(len(arcs.lo))
    first = np.searchsorted(arcs.piece, np.arange(len(arcs.lo)))
    last = np.searchsorted(arcs.piece, np.arange(len(arcs.lo)), side="right") - 1
    share = np.linspace(0.0, 1.0, PLACES)
    for at in range(0, len(out), CHUNK):
        part = np.arange(at, min(at + CHUNK, len(out)))
        lo, hi = arcs.lo[part], arcs.hi[part]
        x, y, _, _ = sections.points(
            arcs.of[part], lo[:, None] + (hi - lo)[:, None] * share[None, :]
        )
        one, two = first[part], last[part]
        there = np.minimum(_distances(arcs, one, x, y), _distances(arcs, two, x, y))
        back = np.maximum(_back(arcs, one, x, y), _back(arcs, two, x, y))
        out[part] = np.maximum(_peak(there), back)
    return out


def certify(sections: Sections, tolerance: Floats) -> tuple[Arcs, Floats]:
    """Return arcs that are within the tolerance of each section as measured, and their departure.

    Where the fit has overlooked something between its places, it is asked for better. What then
    still is over the tolerance is for the caller to say.
    """
    aim = tolerance.copy()
    arcs = fit(sections, aim)
    off = departure(sections, arcs)
    for _ in range(AGAIN):
        worst = np.zeros(len(aim))
        np.maximum.at(worst, arcs.of, off)
        over = np.flatnonzero((worst > tolerance) & (worst < HOPELESS * tolerance))
        if not len(over):
            break
        aim[over] *= np.clip(0.98 * tolerance[over] / worst[over], 0.25, 0.98)
        better = fit(sections, aim, over)
        arcs, off = _replace_pieces(arcs, off, better, departure(sections, better), over)
    return arcs, off


def _replace_pieces(
    arcs: Arcs, off: Floats, better: Arcs, better_off: Floats, over: Ints
) -> tuple[Arcs, Floats]:
    """Return arcs in which those of the sections ``over`` are replaced."""
    keep, keep_piece = ~np.isin(arcs.section, over), ~np.isin(arcs.of, over)
    of = np.concatenate([arcs.of[keep_piece], better.of])
    order = np.argsort(of, kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    number = np.cumsum(keep_piece) - 1
    piece = np.concatenate([number[arcs.piece[keep]], better.piece + keep_piece.sum()])
    piece = rank[piece]
    by_piece = np.argsort(piece, kind="stable")

    def both(name: str) -> Floats:
        out: Floats = np.concatenate([getattr(arcs, name)[keep], getattr(better, name)])[by_piece]
        return out

    arcs = Arcs(
        both("section").astype(np.int64),
        both("x0"),
        both("y0"),
        both("x1"),
        both("y1"),
        both("cx"),
        both("cy"),
        both("turn").astype(np.int64),
        piece[by_piece],
        np.concatenate([arcs.lo[keep_piece], better.lo])[order],
        np.concatenate([arcs.hi[keep_piece], better.hi])[order],
        of[order],
    )
    return arcs, np.concatenate([off[keep_piece], better_off])[order]


def _peak(d: Floats) -> Floats:
    """Return the largest value of each row, and what may lie between two of its places."""
    top = d.max(axis=1)
    between = np.abs(d[:, 2:] - 2.0 * d[:, 1:-1] + d[:, :-2])
    near = d[:, 1:-1] >= 0.7 * top[:, None]
    out: Floats = top + np.where(near, between, 0.0).max(axis=1) / 8.0
    return out


def _angles(arcs: Arcs, k: Ints) -> tuple[Floats, Floats, Floats]:
    """Return radius, start angle and sweep (> 0, in the arc's own sense)."""
    radius = np.hypot(arcs.x0[k] - arcs.cx[k], arcs.y0[k] - arcs.cy[k])
    a = np.arctan2(arcs.y0[k] - arcs.cy[k], arcs.x0[k] - arcs.cx[k])
    b = np.arctan2(arcs.y1[k] - arcs.cy[k], arcs.x1[k] - arcs.cx[k])
    return radius, a, np.mod((b - a) * arcs.turn[k], 2.0 * np.pi)


def _distances(arcs: Arcs, k: Ints, x: Floats, y: Floats) -> Floats:
    """Return distances of rows of places from one segment each, ends included."""
    x0, y0, x1, y1 = (v[k][:, None] for v in (arcs.x0, arcs.y0, arcs.x1, arcs.y1))
    ends = np.minimum(np.hypot(x - x0, y - y0), np.hypot(x - x1, y - y1))
    wx, wy = x1 - x0, y1 - y0
    square = wx * wx + wy * wy
    along = ((x - x0) * wx + (y - y0) * wy) / np.where(square > 0, square, 1.0)
    foot = np.clip(along, 0.0, 1.0)
    line = np.hypot(x - x0 - foot * wx, y - y0 - foot * wy)
    radius, a, sweep = _angles(arcs, k)
    cx, cy = arcs.cx[k][:, None], arcs.cy[k][:, None]
    turn = arcs.turn[k][:, None]
    at = np.mod((np.arctan2(y - cy, x - cx) - a[:, None]) * turn, 2.0 * np.pi)
    on = np.abs(np.hypot(x - cx, y - cy) - radius[:, None])
    round_ = np.where(at <= sweep[:, None], on, ends)
    return np.where(turn != 0, round_, line)


def _back(arcs: Arcs, k: Ints, x: Floats, y: Floats) -> Floats:
    """Return how far one segment each leaves the chords through rows of places, at most."""
    share = np.linspace(0.0, 1.0, BACK)
    radius, a, sweep = _angles(arcs, k)
    angle = a[:, None] + (sweep * arcs.turn[k])[:, None] * share
    line = (arcs.turn[k] == 0)[:, None]
    px = np.where(
        line,
        arcs.x0[k][:, None] + (arcs.x1[k] - arcs.x0[k])[:, None] * share,
        arcs.cx[k][:, None] + radius[:, None] * np.cos(angle),
    )
    py = np.where(
        line,
        arcs.y0[k][:, None] + (arcs.y1[k] - arcs.y0[k])[:, None] * share,
        arcs.cy[k][:, None] + radius[:, None] * np.sin(angle),
    )
    worst = np.zeros(len(k))
    wx, wy = np.diff(x, axis=1), np.diff(y, axis=1)
    square = wx * wx + wy * wy
    safe = np.where(square > 0, square, 1.0)
    for j in range(BACK):
        dx, dy = px[:, j : j + 1] - x[:, :-1], py[:, j : j + 1] - y[:, :-1]
        foot = np.clip((dx * wx + dy * wy) / safe, 0.0, 1.0)
        worst = np.maximum(worst, np.hypot(dx - foot * wx, dy - foot * wy).min(axis=1))
    return worst

"""Curves become arcs: Hermite biarcs, each piece as long as the tolerance allows.

A biarc joins two places with given tangents by two arcs that touch. Along a curve it leaves it by
k' h^3 / 324, with h the piece's length and k' the slope of its curvature; so the next length is
guessed by the cube root of the last error, and found in three to six tries. All sections of all
curves of a drawing are searched at once: what is a loop here is over tries, not over curves.

The joint is the one with equal tangent lengths, after Bolton, Biarc curves, Computer-Aided Design 7
(1975).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wedmcam.geom.curves import Floats, Ints, Points, Sections

#: Places on a piece at which its error is looked at in the search.
SAMPLES = 25
#: The search aims at this share of the tolerance; a piece that reaches `ENOUGH` of it is taken.
AIM, ENOUGH, MOST = 0.95, 0.90, 0.98
#: Tries for one piece at most, and for all pieces of one section: over 1500 of them.
TRIES, ROUNDS = 24, 6_000
#: An arc that rises less than this over its chord is a line, um.
STRAIGHT_UM = 0.005
#: A piece shorter than this, um, is taken as it is: there is a cusp.
SHORTEST_UM = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """Lines and arcs in order of section, shape (n,) each, um.

    Attributes:
        section: which section each belongs to.
        x0, y0, x1, y1, cx, cy, turn: as in a sketch.
        piece: which biarc each belongs to; two each, or one.
        lo, hi: parameters between which each piece replaces the curve, shape (pieces,).
        of: the section of each piece.
    """

    section: Ints
    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    turn: Ints
    piece: Ints
    lo: Floats
    hi: Floats
    of: Ints


def joint(
    x0: Floats, y0: Floats, ux: Floats, uy: Floats, x1: Floats, y1: Floats, vx: Floats, vy: Floats
) -> tuple[Floats, Floats]:
    """Return where the two arcs of each biarc meet; (ux, uy), (vx, vy) unit tangents at the ends.

    >>> one = np.ones(1)
    >>> x, y = joint(0 * one, 0 * one, 0 * one, one, 2 * one, 0 * one, 0 * one, -one)
    >>> float(x[0]), float(y[0])  # the top of a half circle
    (1.0, 1.0)
    """
    wx, wy = x1 - x0, y1 - y0
    square = wx * wx + wy * wy
    along = wx * (ux + vx) + wy * (uy + vy)
    spread = (ux - vx) ** 2 + (uy - vy) ** 2  # 2 (1 - cos)
    root = np.sqrt(along * along + spread * square)
    below = along + root
    d = square / np.where(below > 0, below, 1.0)
    d = np.where(below > 0, d, 0.0)
    return 0.5 * (x0 + x1 + d * (ux - vx)), 0.5 * (y0 + y1 + d * (uy - vy))


def centre(
    x0: Floats, y0: Floats, ux: Floats, uy: Floats, x1: Floats, y1: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return centre and signed height over the chord of arcs that leave (x0, y0) along (ux, uy).

    The height is > 0 for counter-clockwise arcs; about 0 there is no centre (0, 0 is returned).
    """
    wx, wy = x1 - x0, y1 - y0
    square = wx * wx + wy * wy
    left = ux * wy - uy * wx  # of the chord's end, from the tangent
    chord = np.sqrt(square)
    ahead = ux * wx + uy * wy
    # Height = chord / 2 * tan(sweep / 4), with tan(sweep / 2) = left / ahead.
    height = 0.5 * chord * left / np.where(chord + ahead > 0, chord + ahead, 1e-300)
    arc = np.abs(height) > STRAIGHT_UM
    r = square / (2.0 * np.where(arc, left, 1.0))
    return np.where(arc, x0 - uy * r, 0.0), np.where(arc, y0 + ux * r, 0.0), height


def _unit(p: Points) -> Points:
    x, y, dx, dy = p
    size = np.hypot(dx, dy)
    safe = np.where(size > 0, size, 1.0)
    return x, y, dx / safe, dy / safe


def _off(
    x: Floats, y: Floats, x0: Floats, y0: Floats, ux: Floats, uy: Floats, qx: Floats, qy: Floats
) -> Floats:
    """Return distances of places from the circles (or lines) of arcs, shape (k, n)."""
    cx, cy, height = centre(x0, y0, ux, uy, qx, qy)
    arc = np.abs(height) > STRAIGHT_UM
    round_ = np.abs(
        np.hypot(x - cx[:, None], y - cy[:, None]) - np.hypot(x0 - cx, y0 - cy)[:, None]
    )
    wx, wy = qx - x0, qy - y0
    chord = np.hypot(wx, wy)
    safe = np.where(chord > 0, chord, 1.0)
    straight = np.abs(
        (y - y0[:, None]) * (wx / safe)[:, None] - (x - x0[:, None]) * (wy / safe)[:, None]
    )
    return np.where(arc[:, None], round_, straight)


def _errors(p: Points) -> Floats:
    """Return by how much biarcs over rows of places leave them, um; inf where there is none."""
    x, y, ux, uy = p
    x0, y0, u0, v0 = x[:, 0], y[:, 0], ux[:, 0], uy[:, 0]
    x1, y1, u1, v1 = x[:, -1], y[:, -1], ux[:, -1], uy[:, -1]
    qx, qy = joint(x0, y0, u0, v0, x1, y1, u1, v1)
    one = _off(x, y, x0, y0, u0, v0, qx, qy)
    two = _off(x, y, x1, y1, -u1, -v1, qx, qy)
    wx, wy = x1 - x0, y1 - y0
    # Where the arcs meet, both have the direction of the chord mirrored by the ends': a place
    # before the normal there belongs to the first arc.
    mx, my = 2.0 * (qx - x0), 2.0 * (qy - y0)
    sx, sy = x1 - qx, y1 - qy
    a, b = np.hypot(mx, my), np.hypot(sx, sy)
    tx = mx / np.where(a > 0, a, 1.0) + sx / np.where(b > 0, b, 1.0)
    ty = my / np.where(a > 0, a, 1.0) + sy / np.where(b > 0, b, 1.0)
    before = (x - qx[:, None]) * tx[:, None] + (y - qy[:, None]) * ty[:, None] < 0
    error = np.where(before, one, two).max(axis=1)
    # Turned by more than a right angle, or back on itself: too long, whatever the distance.
    turned = (ux * u0[:, None] + uy * v0[:, None]).min(axis=1) < 0.0
    turned |= (u0 * wx + v0 * wy < 0) | (u1 * wx + v1 * wy < 0)
    return np.where(turned, np.inf, error)


def fit(sections: Sections, tolerance: Floats, chosen: Ints | None = None) -> Arcs:
    """Return arcs within a tolerance of each section, um, tangent to each other in a section.

    Args:
        sections: of curves; in each the curvature keeps its sign, about.
        tolerance: of each section, um; pieces reach 0.98 of it at most at the `SAMPLES` places
            that are looked at.
        chosen: which sections; None for all.
    """
    n = len(sections.lo)
    assert len(tolerance) == n
    place = np.linspace(0.0, 1.0, SAMPLES)
    lo, end = sections.lo.copy(), sections.hi
    good, bad = lo.copy(), np.full(n, np.inf)
    guess = end.copy()
    tries = np.zeros(n, np.int64)
    best = np.zeros(n)
    active = np.arange(n) if chosen is None else chosen
    starts: list[Floats] = []
    stops: list[Floats] = []
    owners: list[Ints] = []
    for _ in range(ROUNDS):
        if not len(active):
            break
        a, b, tol = lo[active], guess[active], tolerance[active]
        p = _unit(sections.points(active, a[:, None] + (b - a)[:, None] * place[None, :]))
        error = _errors(p)
        size = np.hypot(p[0][:, -1] - p[0][:, 0], p[1][:, -1] - p[1][:, 0])
        ok = (error <= MOST * tol) | (size < SHORTEST_UM) & (tries[active] > 3)
        good[active] = np.where(ok, b, good[active])
        best[active] = np.where(ok, error, best[active])
        bad[active] = np.where(ok, bad[active], b)
        tries[active] += 1
        h = b - a
        with np.errstate(all="ignore"):
            factor = np.cbrt(AIM * tol / np.maximum(error, 1e-12 * tol))
        factor = np.clip(np.where(np.isfinite(error), factor, 0.4), 0.2, 4.0)
        guess[active] = a + h * factor
        g, w = good[active], bad[active]
        # Between what is known to be good and bad; else in their middle.
        middle = 0.5 * (g + np.minimum(w, end[active]))
        next_ = np.minimum(guess[active], end[active])
        next_ = np.where((next_ <= g) | (next_ >= w), middle, next_)
        guess[active] = next_
        done = (g > a) & (
            (g >= end[active])
            | (best[active] >= ENOUGH * tol)
            | (w - g <= 0.01 * (g - a))
            | (tries[active] >= TRIES)
        )
        if done.any():
            ended = active[done]
            starts.append(lo[ended].copy())
            stops.append(good[ended].copy())
            owners.append(ended)
            step = good[ended] - lo[ended]
            lo[ended] = good[ended]
            guess[ended] = np.minimum(lo[ended] + step, end[ended])
            bad[ended] = np.inf
            tries[ended] = 0
            best[ended] = 0.0
            active = active[lo[active] < end[active]]
    if len(active):  # too long for a part: its last piece is what is left, and will be measured
        starts.append(lo[active].copy())
        stops.append(end[active].copy())
        owners.append(active)
    return _arcs(sections, starts, stops, owners)


def _arcs(
    sections: Sections, starts: list[Floats], stops: list[Floats], owners: list[Ints]
) -> Arcs:
    """Return the two arcs of each piece, in order."""
    lo = np.concatenate([np.zeros(0), *starts])
    hi = np.concatenate([np.zeros(0), *stops])
    of = np.concatenate([np.zeros(0, np.int64), *owners])
    order = np.lexsort((lo, of))
    lo, hi, of = lo[order], hi[order], of[order]
    x, y, ux, uy = _unit(sections.points(of, np.stack([lo, hi], axis=1)))
    x0, y0, x1, y1 = x[:, 0], y[:, 0], x[:, 1], y[:, 1]
    qx, qy = joint(x0, y0, ux[:, 0], uy[:, 0], x1, y1, ux[:, 1], uy[:, 1])
    ax, ay, rise = centre(x0, y0, ux[:, 0], uy[:, 0], qx, qy)
    bx, by, fall = centre(x1, y1, -ux[:, 1], -uy[:, 1], qx, qy)
    one = np.where(np.abs(rise) > STRAIGHT_UM, np.sign(rise), 0).astype(np.int64)
    two = np.where(np.abs(fall) > STRAIGHT_UM, -np.sign(fall), 0).astype(np.int64)
    # Two lines would make a corner of nothing: one line does.
    both = (one == 0) & (two == 0)
    qx, qy = np.where(both, x1, qx), np.where(both, y1, qy)

    def pair(a: Floats, b: Floats) -> Floats:
        out: Floats = np.stack([a, b], axis=1).ravel()
        return out

    keep = np.stack([np.ones(len(lo), np.bool_), ~both], axis=1).ravel()
    piece = np.repeat(np.arange(len(lo)), 2)
    return Arcs(
        of[piece][keep],
        pair(x0, qx)[keep],
        pair(y0, qy)[keep],
        pair(qx, x1)[keep],
        pair(qy, y1)[keep],
        pair(ax, bx)[keep],
        pair(ay, by)[keep],
        np.stack([one, two], axis=1).ravel()[keep],
        piece[keep],
        lo,
        hi,
        of,
    )

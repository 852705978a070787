"""Splines and ellipses as numbers that can be evaluated at many places at once.

A B-spline is taken apart into its Bezier pieces by blossoms (Ramshaw 1989; Farin, Curves and
Surfaces for CAGD, 2002, chapter 8): that works for clamped and unclamped, periodic and rational
ones of any degree alike, and a polynomial is evaluated far faster than a spline. Ellipses keep
their angle as parameter. Both know their *sections*: stretches without a corner in which the
curvature keeps its sign, which is what arcs can be fitted to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
#: x, y and the direction of travel, which is not normalised.
Points = tuple[Floats, Floats, Floats, Floats]

#: A piece bends by less than this over its length, um: it is straight. Far below any tolerance.
STRAIGHT_UM = 0.01
#: Places in a piece at which the sign of its curvature is looked at.
LOOKS = 9
#: Bends below this height over a piece, um, have no sign: it would be that of rounding errors.
FLAT_UM = 1e-3
#: Tangents that differ by more than this, radians, make a corner: 1 um over 1 m.
CORNER_RAD = 1e-6


class Sections(Protocol):
    """Stretches of curves, each from parameter ``lo`` to ``hi`` (arrays of one length)."""

    @property
    def lo(self) -> Floats:
        """Where each section starts."""

    @property
    def hi(self) -> Floats:
        """Where each section ends."""

    def points(self, section: Ints, t: Floats) -> Points:
        """Return places and directions; ``t`` has shape (len(section), n)."""


def bezier_pieces(degree: int, knots: Floats, points: Floats) -> tuple[Floats, Bools]:
    """Return the Bezier pieces of a B-spline over its domain knots[degree] to knots[-degree - 1].

    Args:
        degree: p >= 1.
        knots: ascending, shape (n + p + 1,).
        points: control points in homogeneous coordinates (w x, w y, w), shape (n, 3).

    Returns:
        Control points of each piece, shape (pieces, p + 1, 3); and for each piece whether the knot
        before it has a multiplicity of at least p, so that there may be a corner.

    >>> line = np.array([[0.0, 0, 1], [1, 0, 1], [1, 1, 1]])
    >>> bezier_pieces(2, np.array([0.0, 0, 0, 1, 1, 1]), line)[0].tolist() == [line.tolist()]
    True
    """
    p, n = degree, len(points)
    span = np.flatnonzero(knots[p:n] < knots[p + 1 : n + 1]) + p  # knots[span] < knots[span + 1]
    low, high = knots[span], knots[span + 1]
    out = np.empty((len(span), p + 1, 3))
    local = points[span[:, None] + np.arange(-p, 1)]
    for k in range(p + 1):
        d = local.copy()
        for r in range(1, p + 1):
            at = high if r <= k else low
            for j in range(p, r - 1, -1):
                left, right = knots[span + j - p], knots[span + 1 + j - r]
                alpha = ((at - left) / (right - left))[:, None]
                d[:, j] = (1.0 - alpha) * d[:, j - 1] + alpha * d[:, j]
        out[:, k] = d[:, p]
    corner = np.array([np.count_nonzero(knots == u) >= p for u in low.tolist()], np.bool_)
    return out, corner


def _power(pieces: Floats) -> Floats:
    """Return the coefficients of 1, s, s^2, ... of Bezier pieces."""
    p = pieces.shape[1] - 1
    basis = np.zeros((p + 1, p + 1))
    for j in range(p + 1):
        for i in range(j + 1):
            basis[j, i] = comb(p, j) * comb(j, i) * (-1) ** (j - i)
    out: Floats = np.einsum("ji,mik->jmk", basis, pieces)
    return out


class Beziers:
    """Rational Bezier pieces of one degree, of any number of curves, one after the other.

    Attributes:
        pieces: control points, shape (m, p + 1, 3), homogeneous, um.
        curve: which curve each piece belongs to, ascending.
        joint: whether a piece goes on smoothly where the one before it ends.
        straight: whether a piece is a line.
        lo, hi, first, last: sections: parameters, and the pieces [first, last) of each. Parameter
            t is place t - k in piece k = floor(t). Straight pieces are in no section.
    """

    def __init__(self, pieces: Floats, curve: Ints, corner: Bools) -> None:
        self.pieces, self.curve = pieces, curve
        self._power = _power(pieces)
        m, self.degree = len(pieces), pieces.shape[1] - 1
        xy = pieces[:, :, :2] / pieces[:, :, 2:]
        chord = xy[:, -1] - xy[:, 0]
        size = np.hypot(chord[:, 0], chord[:, 1])
        safe = np.where(size > 0, size, 1.0)
        ux, uy = chord[:, 0] / safe, chord[:, 1] / safe
        arm = xy - xy[:, :1]
        across = arm[:, :, 1] * ux[:, None] - arm[:, :, 0] * uy[:, None]
        along = arm[:, :, 0] * ux[:, None] + arm[:, :, 1] * uy[:, None]
        forward = (np.diff(along, axis=1) >= -1e-9 * safe[:, None]).all(axis=1)
        self.length = np.hypot(*np.moveaxis(np.diff(xy, axis=1), 2, 0)).sum(axis=1)
        self.empty = self.length == 0
        self.straight = (np.abs(across).max(axis=1) <= STRAIGHT_UM) & forward & (size > 0)
        self.x0, self.y0, self.x1, self.y1 = xy[:, 0, 0], xy[:, 0, 1], xy[:, -1, 0], xy[:, -1, 1]
        self.joint = self._smooth(corner)
        self.lo = self.hi = np.zeros(0)
        self.first = self.last = np.zeros(0, np.int64)
        if m:
            self._cut()

    def _smooth(self, corner: Bools) -> Bools:
        """Return which pieces go on smoothly where the one before them ends."""
        m = len(self.pieces)
        joint = np.zeros(m, np.bool_)
        if m < 2:
            return joint
        every = np.arange(m)
        _, _, dx, dy = self._at(every[:, None] + np.array([[0.0, 1.0]]), every[:, None])
        turn = np.arctan2(
            dx[:-1, 1] * dy[1:, 0] - dy[:-1, 1] * dx[1:, 0],
            dx[:-1, 1] * dx[1:, 0] + dy[:-1, 1] * dy[1:, 0],
        )
        gap = np.hypot(self.x1[:-1] - self.x0[1:], self.y1[:-1] - self.y0[1:])
        joint[1:] = (self.curve[1:] == self.curve[:-1]) & (np.abs(turn) <= CORNER_RAD)
        joint[1:] &= (gap <= FLAT_UM) & ~corner[1:] & ~self.empty[1:] & ~self.empty[:-1]
        return joint

    def _at(self, t: Floats, piece: Ints) -> Points:
        """Return places and directions at t, each in its piece."""
        s = t - piece
        c = self._power
        h = np.broadcast_to(c[-1][piece], (*s.shape, 3))
        d = np.zeros((*s.shape, 3))
        z = s[..., None]
        for j in range(len(c) - 2, -1, -1):
            d = d * z + h
            h = h * z + c[j][piece]
        w = h[..., 2]
        x, y = h[..., 0] / w, h[..., 1] / w
        dx, dy = (d[..., 0] - x * d[..., 2]) / w, (d[..., 1] - y * d[..., 2]) / w
        still = np.hypot(dx, dy) <= 1e-9 * np.broadcast_to(self.length[piece], s.shape)
        if still.any():
            # The polygon's first or last leg has no length: the curve leaves along the next.
            k = np.broadcast_to(piece, s.shape)[still]
            inside = np.where(s[still] < 0.5, 1e-4, -1e-4)
            ax, ay, _, _ = self._at_plain(s[still] + inside, k)
            dx[still] = (ax - x[still]) * np.sign(inside)
            dy[still] = (ay - y[still]) * np.sign(inside)
        return x, y, dx, dy

    def _at_plain(self, s: Floats, piece: Ints) -> Points:
        c = self._power
        h = c[-1][piece]
        for j in range(len(c) - 2, -1, -1):
            h = h * s[:, None] + c[j][piece]
        return h[:, 0] / h[:, 2], h[:, 1] / h[:, 2], s, s

    def _bend(self, t: Floats, piece: Ints) -> Floats:
        """Return the height of the bend over the whole piece, um, as the curvature at t has it."""
        s = t - piece
        c = self._power
        zero = np.zeros((*s.shape, 3))
        h, d, e = np.broadcast_to(c[-1][piece], zero.shape), zero, zero
        z = s[..., None]
        for j in range(len(c) - 2, -1, -1):
            e = e * z + 2.0 * d
            d = d * z + h
            h = h * z + c[j][piece]
        w, dw, ddw = h[..., 2], d[..., 2], e[..., 2]
        x, y = h[..., 0] / w, h[..., 1] / w
        dx, dy = (d[..., 0] - x * dw) / w, (d[..., 1] - y * dw) / w
        ddx = (e[..., 0] - 2.0 * dx * dw - x * ddw) / w
        ddy = (e[..., 1] - 2.0 * dy * dw - y * ddw) / w
        speed = np.hypot(dx, dy)
        size = np.broadcast_to(self.length[piece], s.shape)
        safe = np.maximum(speed, 1e-6 * np.maximum(size, 1e-9))
        out: Floats = (dx * ddy - dy * ddx) / safe**3 * size**2 / 8.0
        return out

    def points(self, section: Ints, t: Floats) -> Points:
        """Return places and directions; see `Sections`."""
        piece = np.floor(t).astype(np.int64)
        low, high = self.first[section], self.last[section] - 1
        return self._at(t, np.clip(piece, low[:, None], high[:, None]))

    def sample(self, n: int) -> tuple[Floats, Floats]:
        """Return n + 1 places on each piece, ends included, shape (m, n + 1)."""
        piece = np.arange(len(self.pieces))[:, None]
        x, y, _, _ = self._at(piece + np.linspace(0.0, 1.0, n + 1)[None, :], piece)
        return x, y

    def _cut(self) -> None:
        """Find the sections: smooth runs of pieces that are not straight, cut at inflections."""
        m = len(self.pieces)
        part = np.flatnonzero(~self.straight & ~self.empty)
        if not len(part):
            return
        follows = self.joint[part] & np.r_[False, np.diff(part) == 1]
        run = np.cumsum(~follows) - 1
        looks = np.linspace(0.0, 1.0, LOOKS)
        t = part[:, None] + looks[None, :]
        bend = self._bend(t, part[:, None])
        flat_t, flat_run = t.ravel(), np.repeat(run, LOOKS)
        flat_piece = np.repeat(part, LOOKS)
        some = np.abs(bend.ravel()) > FLAT_UM
        t1, r1, b1 = flat_t[some], flat_run[some], bend.ravel()[some]
        p1 = flat_piece[some]
        change = np.flatnonzero((r1[1:] == r1[:-1]) & ((b1[1:] > 0) != (b1[:-1] > 0)))
        a, b = t1[change], t1[change + 1]
        first, last = p1[change], p1[change + 1]
        sign = b1[change] > 0
        for _ in range(45):
            mid = 0.5 * (a + b)
            piece = np.clip(np.floor(mid).astype(np.int64), first, last)
            same = (self._bend(mid, piece) > 0) == sign
            a, b = np.where(same, mid, a), np.where(same, b, mid)
        starts = part[~follows].astype(float)
        ends = np.r_[part[np.flatnonzero(~follows)[1:] - 1], part[-1]] + 1.0
        inside = np.sort(b)
        # A root at the very end of a run (or one found twice) would leave a section of no length.
        owner = np.searchsorted(starts, inside, side="right") - 1
        keep = (inside - starts[owner] > 1e-9) & (ends[owner] - inside > 1e-9)
        keep &= np.r_[True, np.diff(inside) > 1e-9][: len(inside)]
        inside = inside[keep]
        self.lo = np.sort(np.r_[starts, inside])
        self.hi = np.sort(np.r_[ends, inside])
        self.first = np.minimum(np.floor(self.lo + 1e-12).astype(np.int64), m - 1)
        self.last = np.maximum(np.ceil(self.hi - 1e-12).astype(np.int64), self.first + 1)


@dataclass(frozen=True, slots=True)
class Ellipse:
    """An arc of an ellipse: (cx, cy) + (ux, uy) cos t + (vx, vy) sin t for t from ``start`` on.

    (ux, uy) and (vx, vy) need not be square to each other: affine images of circles are taken as
    they come. ``sweep`` > 0, radians, a whole turn at most. um.
    """

    cx: float
    cy: float
    ux: float
    uy: float
    vx: float
    vy: float
    start: float = 0.0
    sweep: float = 2.0 * np.pi

    def principal(self) -> Ellipse:
        """Return the same arc with its axes: (ux, uy) the longer, square to (vx, vy)."""
        u, v = np.array([self.ux, self.uy]), np.array([self.vx, self.vy])
        turn = 0.5 * float(np.arctan2(2.0 * (u @ v), u @ u - v @ v))
        c, s = np.cos(turn), np.sin(turn)
        (ux, uy), (vx, vy) = (u * c + v * s).tolist(), (v * c - u * s).tolist()
        return Ellipse(self.cx, self.cy, ux, uy, vx, vy, self.start - turn, self.sweep)

    @property
    def axes(self) -> tuple[float, float]:
        """Lengths of the two half axes; right for a principal ellipse."""
        return float(np.hypot(self.ux, self.uy)), float(np.hypot(self.vx, self.vy))

    @property
    def turn(self) -> int:
        """+1 when it is run counter-clockwise, -1 clockwise."""
        return 1 if self.ux * self.vy - self.uy * self.vx > 0 else -1

    @property
    def whole(self) -> bool:
        """Whether it is a closed ellipse."""
        return self.sweep >= 2.0 * np.pi

    def at(self, t: float) -> tuple[float, float]:
        """Return the place at t."""
        c, s = np.cos(t), np.sin(t)
        x, y = self.cx + self.ux * c + self.vx * s, self.cy + self.uy * c + self.vy * s
        return float(x), float(y)


class Ellipses:
    """Ellipses cut at their quadrant points, where the curvature has its extremes.

    Attributes:
        curve: which ellipse each section belongs to, ascending.
        lo, hi: angles.
    """

    def __init__(self, ellipses: Sequence[Ellipse]) -> None:
        given = [(e.cx, e.cy, e.ux, e.uy, e.vx, e.vy) for e in ellipses]
        self._numbers = np.array(given, float).reshape(-1, 6)
        owner, lo, hi = [], [], []
        quarter = 0.5 * np.pi
        for k, e in enumerate(ellipses):
            begin = np.floor(e.start / quarter) * quarter if e.whole else e.start
            end = begin + e.sweep
            inner = np.arange(np.floor(begin / quarter) + 1, np.ceil(end / quarter)) * quarter
            inner = inner[(inner > begin + 1e-9) & (inner < end - 1e-9)]
            cuts = [begin, *inner.tolist(), end]
            owner += [k] * (len(cuts) - 1)
            lo += cuts[:-1]
            hi += cuts[1:]
        self.curve = np.array(owner, np.int64)
        self.lo, self.hi = np.array(lo, float), np.array(hi, float)

    def points(self, section: Ints, t: Floats) -> Points:
        """Return places and directions; see `Sections`."""
        cx, cy, ux, uy, vx, vy = self._numbers[self.curve[section]].T[:, :, None]
        c, s = np.cos(t), np.sin(t)
        return cx + ux * c + vx * s, cy + uy * c + vy * s, vx * c - ux * s, vy * c - uy * s

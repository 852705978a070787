"""The figure that a path repeats: what a controller that turns copies needs to be told.

A part made by ``rotate copies``, and any drawing like it, is one figure and a number. The ZD-065
holds 4,096 bytes: a stator of 36 slots fits as one slot. What counts is the path of the wire, not
how it was drawn: joints within one line or one circle are none, and the copies are averaged, so
that the rounding of a drawing does not matter. Frames: drawing, um; angles: degrees,
counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import WAY
from wedmcam.geom.measure import segments_of
from wedmcam.geom.segments import TAU, Floats, Ints, Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.program import Kind

#: The copies of a path lie this near to their mean, um. The rest of the 2 um that a program may be
#: off belongs to the controller.
SAME_UM = 0.3
#: Up to here a path that does not repeat was probably meant to, um.
NEAR_UM = 5.0
#: A joint this near to the line or the circle of both its segments is none, um.
SMOOTH_UM = 0.05
#: A turn by less is a translation (radians).
LEAST_TURN = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Repeat:
    """A path that is one figure and its copies.

    Attributes:
        order: how many figures there are.
        turn: degrees from one to the next.
        centre: about which they are turned.
        off_um: how far the path lies from the mean of its copies.
        closed: the last figure ends where the first begins.
        per: segments of a figure.
        vertices: of the mean path, um, as complex numbers; copies of each other.
        centres, radius, way: of the segment that each vertex opens.
        begin: number of the segment on which the path begins.
        at_joint: the path begins where that segment does, and not within it.
    """

    order: int
    turn: float
    centre: tuple[float, float]
    off_um: float
    closed: bool
    per: int
    vertices: NDArray[np.complex128]
    centres: NDArray[np.complex128]
    radius: Floats
    way: Ints
    begin: int
    at_joint: bool

    @property
    def repeats(self) -> bool:
        """Whether the copies are near enough to be told as one figure."""
        return self.off_um <= SAME_UM

    def orders(self, most: int) -> list[int]:
        """Return the numbers of figures that the path can be cut into, the largest first."""
        return [n for n in range(min(self.order, most), 1, -1) if self.order % n == 0]

    def figure(
        self, order: int, start: complex, turn: float, right_um: float = 0.0
    ) -> NDArray[np.void]:
        """Return one figure, dtype `WAY`, from ``start`` on.

        Args:
            order: one of `orders`.
            start: where the path begins, on the grid of the machine.
            turn: degrees from figure to figure, as they are entered.
            right_um: how far to the right of the path the figure lies; below 0 to the left.
        """
        count = self.per * (self.order // order)
        c = complex(*self.centre)
        end = c + (start - c) * np.exp(1j * np.radians(turn))
        on = np.arange(self.begin, self.begin + count)
        if not self.at_joint:
            on = np.append(on, self.begin + count)
        k = on % len(self.radius)
        vertices = self.vertices + right_um * self._to_the_right()
        inner = vertices[on[1:] % len(vertices)]
        points = np.concatenate([[start], inner, [end]])
        radius = self.radius[k] + right_um * self.way[k]
        return rows_between(points, self.centres[k], radius, self.way[k])

    def _to_the_right(self) -> NDArray[np.complex128]:
        """Return for each vertex by what it moves where both its segments move by 1 um."""
        return _right(self.vertices, self.centres, self.radius, self.way, self.closed)


def beside(path: Contour, right_um: float) -> Contour:
    """Return a path that runs a few tenths of a um to the right of another, segment by segment."""
    rows = path.vertices
    s = segments_of(rows, True)
    way = s.turn.astype(np.int64)
    shift = _right(s.x0 + 1j * s.y0, s.cx + 1j * s.cy, s.radius, way, path.closed)
    if not path.closed:  # the last vertex opens no segment
        shift[-1] = shift[-2]
    out = rows.copy()
    out["x"] += right_um * shift.real
    out["y"] += right_um * shift.imag
    return Contour(out, path.closed)


def _right(
    v: NDArray[np.complex128],
    centres: NDArray[np.complex128],
    radius: Floats,
    way: Ints,
    closed: bool,
) -> NDArray[np.complex128]:
    """Return for each vertex by what it moves where both its segments move by 1 um to the right."""
    w = np.roll(v, -1)
    begin, end = (
        np.where(
            way == 0,
            (w - v) / np.maximum(abs(w - v), 1e-9),
            1j * way * (at - centres) / np.maximum(radius, 1e-9),
        )
        for at in (v, w)
    )
    before = np.roll(end, 1) if closed else np.append(begin[:1], end[:-1])
    both = -1j * (before + begin)
    shift = both / np.maximum(1 + (before * begin.conj()).real, 0.5)
    return np.asarray(shift)


def rows_between(
    points: NDArray[np.complex128], centres: NDArray[np.complex128], radius: Floats, way: Ints
) -> NDArray[np.void]:
    """Return the rows (dtype `WAY`) of segments between points, from the first point on."""
    rows = np.zeros(len(radius), dtype=WAY)
    arc = way != 0
    rows["kind"] = np.where(arc, Kind.ARC, Kind.LINE)
    rows["turn"] = way
    ends = points[1:] - points[0]
    rows["x"], rows["y"] = ends.real, ends.imag
    rows["radius"] = np.where(arc, radius, 0.0)
    a = np.angle(points[:-1] - centres)
    b = np.angle(points[1:] - centres)
    sweep = np.mod((b - a) * way, TAU)
    sweep = np.where(abs(points[1:] - points[:-1]) < SMOOTH_UM, TAU, sweep)
    rows["sweep"] = np.where(arc, np.degrees(sweep), 0.0)
    rows["start"] = np.where(rows["sweep"] >= 360.0, np.degrees(a) % 360.0, 0.0)
    return rows


def find_repeat(path: Contour) -> Repeat | None:
    """Return what a path repeats about a centre; None where it does not at all.

    The result may be off by up to `NEAR_UM`: see `Repeat.repeats`.
    """
    s = segments_of(path.vertices, path.closed)
    return _closed(s) if path.closed else _open(s)


def _closed(s: Segments) -> Repeat | None:
    keep = ~_smooth(s)
    m = int(keep.sum())
    if m < 2:
        return None  # a circle repeats itself at every angle: there is nothing to be saved
    v = (s.x0 + 1j * s.y0)[keep]
    centres = (s.cx + 1j * s.cy)[keep]
    radius, way = s.radius[keep], s.turn[keep].astype(np.int64)
    groups = np.cumsum(keep) - 1  # -1: still on the last segment
    sweep = np.zeros(m)
    np.add.at(sweep, groups % m, s.sweep)
    begin = int(groups[0]) % m
    c = v.mean()
    best: Repeat | None = None
    for order in range(m, 1, -1):
        if m % order:
            continue
        per = m // order
        if not _alike(way, radius, sweep, per):
            continue
        turned = np.vdot(v - c, np.roll(v, -per) - c)
        steps = round(float(np.angle(turned)) / TAU * order)
        if steps == 0:
            continue
        turn = 360.0 * steps / order
        mean, off = _mean(v, c, per, order, turn)
        if off > (NEAR_UM if best is None else SAME_UM):
            continue
        centre_mean, _ = _mean(np.where(way != 0, centres, c), c, per, order, turn)
        radii = np.tile(radius.reshape(order, per).mean(axis=0), order)
        best = Repeat(order, turn, (c.real, c.imag), off, True, per, mean, centre_mean, radii,
                      way, begin, bool(keep[0]))  # fmt: skip
        if best.repeats:
            return best
    return best


def _open(s: Segments) -> Repeat | None:
    m = len(s)
    v = np.append(s.x0 + 1j * s.y0, complex(s.x1[-1], s.y1[-1]))
    way = s.turn.astype(np.int64)
    centres = s.cx + 1j * s.cy
    best: Repeat | None = None
    for order in range(m, 1, -1):
        if m % order:
            continue
        per = m // order
        if not _alike(way, s.radius, s.sweep, per, closed=False):
            continue
        one, two = v[: m + 1 - per], v[per:]
        a, b = one - one.mean(), two - two.mean()
        turn = float(np.angle(np.vdot(a, b)))
        if abs(turn) < LEAST_TURN:
            continue
        z = np.exp(1j * turn)
        c = (two.mean() - z * one.mean()) / (1 - z)
        # Each figure back onto the first, and their mean.
        back = np.exp(-1j * turn * np.arange(order))[:, None]
        images = np.stack([v[k * per : (k + 1) * per + 1] - c for k in range(order)]) * back
        mean = images.mean(axis=0)
        off = float(abs(images - mean).max())
        if off > (NEAR_UM if best is None else SAME_UM):
            continue
        arcs = np.stack([centres[k * per : (k + 1) * per] - c for k in range(order)]) * back
        best = Repeat(order, float(np.degrees(turn)), (c.real, c.imag), off, False, per,
                      np.tile(mean[:-1], order) * np.repeat(1 / back[:, 0], per) + c,
                      np.tile(arcs.mean(axis=0), order) * np.repeat(1 / back[:, 0], per) + c,
                      np.tile(s.radius.reshape(order, per).mean(axis=0), order), way, 0,
                      True)  # fmt: skip
        if best.repeats:
            return best
    return best


def _mean(
    v: NDArray[np.complex128], c: complex, per: int, order: int, turn: float
) -> tuple[NDArray[np.complex128], float]:
    """Return points whose copies are the same, the mean of all, and how far off the farthest is."""
    ways = np.exp(1j * np.radians(turn * np.arange(order)))[:, None]
    images = (v.reshape(order, per) - c) / ways
    mean = images.mean(axis=0)
    return (mean * ways + c).ravel(), float(abs(images - mean).max())


def _alike(way: Ints, radius: Floats, sweep: Floats, per: int, *, closed: bool = True) -> bool:
    """Return whether each segment is of the kind and size of the one a figure later."""
    last = len(way) if closed else len(way) - per

    def apart(values: Floats) -> Floats:
        return abs(np.roll(values, -per) - values)[:last]

    return bool(
        (np.roll(way, -per) == way)[:last].all()
        and (apart(radius) <= NEAR_UM).all()
        and (apart(sweep) * np.maximum(radius, 1.0)[:last] <= 4 * NEAR_UM).all()
    )


def _smooth(s: Segments) -> NDArray[np.bool_]:
    """Return which segments only go on with the line or the circle of the one before."""
    before = np.roll(np.arange(len(s)), 1)
    b = s.take(before)
    line = (s.turn == 0) & (b.turn == 0)
    along = s.ux * b.ux + s.uy * b.uy
    # How far the joint lies off the chord of both.
    dx, dy = s.x1 - b.x0, s.y1 - b.y0
    long = np.maximum(np.hypot(dx, dy), 1e-9)
    off = abs(dx * (s.y0 - b.y0) - dy * (s.x0 - b.x0)) / long
    straight = line & (along > 0) & (off <= SMOOTH_UM)
    same = (s.turn == b.turn) & (s.turn != 0)
    apart = np.hypot(s.cx - b.cx, s.cy - b.cy)
    round_ = same & (apart <= SMOOTH_UM) & (abs(s.radius - b.radius) <= SMOOTH_UM)
    return np.asarray(straight | round_)

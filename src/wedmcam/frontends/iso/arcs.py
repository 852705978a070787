"""Arcs of ISO records: their centres, and the blocks that a controller steps them in."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso.reading import ArcTeller, Reading
from wedmcam.ir.program import BLOCK, Axis, Kind

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


def grid(nm: Ints) -> Ints:
    """Return lengths in whole um, of nm."""
    return (nm + 500) // 1000


def fits(ends: list[tuple[Floats, Floats]], centre: list[Floats]) -> Bools:
    """Return which arcs, from the first of ``ends`` to the second, a centre fits; um."""
    (sx, ex), (sy, ey) = ends
    start, end = (np.hypot(x - centre[0], y - centre[1]) for x, y in ((sx, sy), (ex, ey)))
    fit: Bools = (np.abs(start - end) <= iso.END_UM) & (start >= 1.5)
    return fit


def nearest(values: Floats) -> Ints:
    """Return the nearest whole numbers, halves upwards."""
    return np.floor(values + 0.5).astype(np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """Arcs as they are programmed, a row each.

    Attributes:
        lines: of each.
        turn: +1 counter-clockwise, -1 clockwise.
        sx, sy, ex, ey: start and end, whole um.
        closed: the end is the start, to the nm.
        by_radius: R stands there. by_centre: I or J does.
    """

    lines: Ints
    turn: Ints
    sx: Ints
    sy: Ints
    ex: Ints
    ey: Ints
    closed: Bools
    by_radius: Bools
    by_centre: Bools

    def of(self, rows: Bools) -> Arcs:
        """Return some of the arcs."""
        return Arcs(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})


@dataclass(frozen=True, slots=True, eq=False)
class Radii:
    """From the centre of each arc to its start (x, y) and to its end (fx, fy), whole um."""

    x: Ints
    y: Ints
    fx: Ints
    fy: Ints

    def of(self, rows: Bools | Ints) -> Radii:
        """Return those of some arcs."""
        return Radii(self.x[rows], self.y[rows], self.fx[rows], self.fy[rows])


def centres_of(
    teller: ArcTeller, which: Bools, arcs: Arcs, radius_nm: Ints
) -> tuple[Floats, Floats]:
    """Return the centres from R: positive below half a turn, else above; report ``which`` alone."""
    sx, sy = arcs.sx, arcs.sy
    radius = np.abs(radius_nm) / 1000.0
    dx, dy = (arcs.ex - sx).astype(float), (arcs.ey - sy).astype(float)
    chord = np.hypot(dx, dy)
    teller.tell(
        which & (chord / 2 > radius + 1.0),
        "R is {radius_mm:.3f} mm, half the chord {half_mm:.3f} mm",
        lambda i: {"radius_mm": float(radius[i] / 1000), "half_mm": float(chord[i] / 2000)},
    )
    high = np.sqrt(np.maximum(radius**2 - chord**2 / 4, 0.0))
    side = arcs.turn * np.where(radius_nm > 0, 1, -1)
    safe = np.where(chord > 0, chord, 1.0)
    mx = sx + dx / 2 - side * high * dy / safe
    my = sy + dy / 2 + side * high * dx / safe
    return mx, my


def stepped_arcs(r: Reading, arcs: Arcs, radii: Radii) -> tuple[NDArray[np.void], Ints, Ints]:
    """Return an arc a row (count 0 for none), and the straight rest to its stated end."""
    turn, x, y, fx, fy = arcs.turn, radii.x, radii.y, radii.fx, radii.fy
    blocks = np.zeros(len(x), BLOCK)
    blocks["kind"], blocks["turn"], blocks["x"], blocks["y"] = Kind.ARC, turn, x, y
    sweep = turn * (np.arctan2(fy, fx) - np.arctan2(y, x)) % (2 * np.pi)
    tiny = sweep * np.hypot(x, y) < 4.0
    here = (x == fx) & (y == fy)
    # Start and end on one micron: a full circle if they were stated so, else next to nothing.
    tiny = np.where(here, ~arcs.closed & (sweep < np.pi), tiny)
    arc_end = r.machine.own_stepping.arc_end
    end = arc_end(x, y, turn, fx, fy)
    px, py = fx.copy(), fy.copy()
    beside = np.flatnonzero(~end.landed & ~tiny & ~here)
    if len(beside):
        px[beside], py[beside], far = _nearest_ends(
            r.machine.own_stepping, turn[beside], radii.of(beside), sweep[beside]
        )
        end = arc_end(x, y, turn, px, py)
        worst = float(far.max())
        if np.isfinite(worst):
            r.tell_lines(
                Severity.NOTE,
                "iso-end",
                arcs.lines[beside],
                "the stepped circle passes {beside_um:.1f} um beside the stated end (at most "
                "{most_um:.1f} um in this file); the controller goes the rest straight",
                lambda i: {"beside_um": float(far[i]), "most_um": worst},
            )
    ok = end.landed & ~tiny
    blocks["axis"] = np.where(ok, end.last_axis, int(Axis.X))
    blocks["count"] = np.where(ok, np.where(end.last_axis == Axis.X, end.count_x, end.count_y), 0)
    rest_x = fx - np.where(ok, px, x)
    rest_y = fy - np.where(ok, py, y)
    lost = np.flatnonzero(~ok & ~tiny)
    r.tell_lines(
        Severity.ERROR,
        "iso-arc",
        arcs.lines[lost],
        "no controller steps this arc: its radius is too small or over 23 m",
    )
    rest_x[lost], rest_y[lost] = 0, 0
    return blocks, rest_x, rest_y


def _nearest_ends(
    stepping: Stepping, turn: Ints, radii: Radii, sweep: Floats
) -> tuple[Ints, Ints, Floats]:
    """Return the points of stepped circles nearest to the stated ends, and how far they lie, um.

    They are looked for about the end as it would be on the circle; where there is none the stated
    end stays, and is infinitely far.
    """
    x, y, fx, fy = radii.x, radii.y, radii.fx, radii.fy
    scale = np.hypot(x, y) / np.maximum(np.hypot(fx, fy), 1e-9)
    nx = np.floor(fx * scale + 0.5).astype(np.int64)
    ny = np.floor(fy * scale + 0.5).astype(np.int64)
    px, py, best = fx, fy, np.full(len(x), np.inf)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            qx, qy = nx + i, ny + j
            end = stepping.arc_end(x, y, turn, qx, qy)
            angle = turn * (np.arctan2(qy, qx) - np.arctan2(y, x)) % (2 * np.pi)
            far = np.hypot(qx - fx, qy - fy)
            far = np.where(end.landed & (np.abs(angle - sweep) < np.pi), far, np.inf)
            better = far < best
            best = np.where(better, far, best)
            px, py = np.where(better, qx, px), np.where(better, qy, py)
    return px, py, best

"""Arcs of ISO records: their centres, and the blocks that a controller steps them in."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso.reading import Reading
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


def centres_of(
    tell: Callable[..., None],
    which: Bools,
    sx: Ints,
    sy: Ints,
    ex: Ints,
    ey: Ints,
    turn: Ints,
    radius_nm: Ints,
) -> tuple[Floats, Floats]:
    """Return the centres from R: positive below half a turn, else above. Told of ``which``."""
    radius = np.abs(radius_nm) / 1000.0
    dx, dy = (ex - sx).astype(float), (ey - sy).astype(float)
    chord = np.hypot(dx, dy)
    tell(
        which & (chord / 2 > radius + 1.0),
        "R is {radius_mm:.3f} mm, half the chord {half_mm:.3f} mm",
        lambda i: {"radius_mm": float(radius[i] / 1000), "half_mm": float(chord[i] / 2000)},
    )
    high = np.sqrt(np.maximum(radius**2 - chord**2 / 4, 0.0))
    side = turn * np.where(radius_nm > 0, 1, -1)
    safe = np.where(chord > 0, chord, 1.0)
    mx = sx + dx / 2 - side * high * dy / safe
    my = sy + dy / 2 + side * high * dx / safe
    return mx, my


def stepped_arcs(
    r: Reading,
    lines: Ints,
    turn: Ints,
    x: Ints,
    y: Ints,
    fx: Ints,
    fy: Ints,
    same_nm: Bools,
) -> tuple[NDArray[np.void], Ints, Ints]:
    """Return an arc a row (count 0 for none), and the straight rest to its stated end."""
    made = np.zeros(len(x), BLOCK)
    made["kind"], made["turn"], made["x"], made["y"] = Kind.ARC, turn, x, y
    radius = np.hypot(x, y)
    sweep = turn * (np.arctan2(fy, fx) - np.arctan2(y, x)) % (2 * np.pi)
    tiny = sweep * radius < 4.0
    here = (x == fx) & (y == fy)
    # Start and end on one micron: a full circle if they were stated so, else next to nothing.
    tiny = np.where(here, ~same_nm & (sweep < np.pi), tiny)
    whole = here & ~tiny
    arc_end = r.machine.own_stepping.arc_end
    end = arc_end(x, y, turn, fx, fy)
    px, py = fx.copy(), fy.copy()
    beside = np.flatnonzero(~end.landed & ~tiny & ~whole)
    if len(beside):
        scale = radius[beside] / np.maximum(np.hypot(fx[beside], fy[beside]), 1e-9)
        nx = np.floor(fx[beside] * scale + 0.5).astype(np.int64)
        ny = np.floor(fy[beside] * scale + 0.5).astype(np.int64)
        best = np.full(len(beside), np.inf)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                qx, qy = nx + i, ny + j
                got = arc_end(x[beside], y[beside], turn[beside], qx, qy)
                angle = (
                    turn[beside]
                    * (np.arctan2(qy, qx) - np.arctan2(y[beside], x[beside]))
                    % (2 * np.pi)
                )
                far = np.hypot(qx - fx[beside], qy - fy[beside])
                far = np.where(got.landed & (np.abs(angle - sweep[beside]) < np.pi), far, np.inf)
                better = far < best
                best = np.where(better, far, best)
                px[beside] = np.where(better, qx, px[beside])
                py[beside] = np.where(better, qy, py[beside])
        end = arc_end(x, y, turn, px, py)
        worst = float(best.max())
        if np.isfinite(worst):
            r.tell_lines(
                Severity.NOTE,
                "iso-end",
                lines[beside],
                "the stepped circle passes {beside_um:.1f} um beside the stated end (at most "
                "{most_um:.1f} um in this file); the controller goes the rest straight",
                lambda i: {"beside_um": float(best[i]), "most_um": worst},
            )
    ok = end.landed & ~tiny
    made["axis"] = np.where(ok, end.last_axis, int(Axis.X))
    made["count"] = np.where(ok, np.where(end.last_axis == Axis.X, end.count_x, end.count_y), 0)
    rest_x = fx - np.where(ok, px, x)
    rest_y = fy - np.where(ok, py, y)
    lost = np.flatnonzero(~ok & ~tiny)
    r.tell_lines(
        Severity.ERROR,
        "iso-arc",
        lines[lost],
        "no controller steps this arc: its radius is too small or over 23 m",
    )
    rest_x[lost], rest_y[lost] = 0, 0
    return made, rest_x, rest_y

"""Many segments as columns: the form in which the kernels of this package take lines and arcs.

A position on a segment is its arc length from the start, in um: it means the same on a line and on
an arc, so tolerances do too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
TAU = 2.0 * np.pi
#: A joint that turns by less is tangent (radians): 1 um over 1 mm.
TANGENT = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Segments:
    """Lines and arcs, shape (n,) each, um.

    Attributes:
        x0, y0, x1, y1: start and end.
        cx, cy: centre of an arc; anything finite for a line.
        turn: +1 counter-clockwise arc, -1 clockwise, 0 line.
        radius: of an arc (0 for a line).
        a0: polar angle of an arc's start about its centre, radians.
        sweep: > 0, the angle an arc covers; a full circle where start == end. 0 for a line.
        ux, uy: unit direction of a line (0 for an arc and for a line without length).
        length: arc length.
    """

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    turn: NDArray[np.int8]
    radius: Floats
    a0: Floats
    sweep: Floats
    ux: Floats
    uy: Floats
    length: Floats

    def __len__(self) -> int:
        return len(self.x0)

    def take(self, index: NDArray[np.int64] | NDArray[np.bool_]) -> Segments:
        """Return the chosen segments, in the order of ``index``."""
        return Segments(*(getattr(self, name)[index] for name in self.__slots__))


def make(
    x0: Floats,
    y0: Floats,
    x1: Floats,
    y1: Floats,
    cx: Floats,
    cy: Floats,
    turn: NDArray[np.int8],
    radius: Floats | None = None,
    sweep_near: Floats | None = None,
) -> Segments:
    """Return `Segments` with the derived columns filled in.

    Start and end are taken as they are; the radius is |start - centre| unless given. start == end
    with a turn is the full circle, unless ``sweep_near`` says about how far each arc sweeps: ends
    that were moved a little must not turn a speck of an arc into a full circle.
    """
    arc = turn != 0
    dx, dy = x1 - x0, y1 - y0
    chord = np.hypot(dx, dy)
    safe = np.where(chord > 0, chord, 1.0)
    line = ~arc
    ux = np.where(line, dx / safe, 0.0)
    uy = np.where(line, dy / safe, 0.0)
    sx, sy = x0 - cx, y0 - cy
    r = np.hypot(sx, sy) if radius is None else radius
    r = np.where(arc, r, 0.0)
    a0 = np.where(arc, np.arctan2(sy, sx), 0.0)
    a1 = np.arctan2(y1 - cy, x1 - cx)
    sweep = np.mod((a1 - a0) * turn, TAU)
    if sweep_near is None:
        sweep = np.where((dx == 0) & (dy == 0), TAU, sweep)
    else:
        off = np.mod(sweep - sweep_near + np.pi, TAU) - np.pi
        sweep = np.clip(sweep_near + off, 0.0, TAU)
    sweep = np.where(arc, sweep, 0.0)
    length = np.where(arc, r * sweep, chord)
    return Segments(x0, y0, x1, y1, cx, cy, turn, r, a0, sweep, ux, uy, length)


def of_rows(starts: NDArray[np.void], ends: NDArray[np.void]) -> Segments:
    """Return the segments between rows of a contour's vertex array (``starts``, ``ends``)."""
    return make(
        starts["x"].astype(float),
        starts["y"].astype(float),
        ends["x"].astype(float),
        ends["y"].astype(float),
        starts["cx"].astype(float),
        starts["cy"].astype(float),
        starts["turn"].copy(),
    )


def following(rows: NDArray[np.void]) -> NDArray[np.void]:
    """Return the row after each one, round and round (np.roll takes 20 times as long)."""
    out = np.empty_like(rows)
    out[:-1], out[-1] = rows[1:], rows[0]
    return out


def start_tangents(s: Segments) -> tuple[Floats, Floats]:
    """Return the unit direction of travel at the start of each segment."""
    arc = s.turn != 0
    r = np.where(s.radius > 0, s.radius, 1.0)
    return (
        np.where(arc, -s.turn * (s.y0 - s.cy) / r, s.ux),
        np.where(arc, s.turn * (s.x0 - s.cx) / r, s.uy),
    )


def end_tangents(s: Segments) -> tuple[Floats, Floats]:
    """Return the unit direction of travel at the end of each segment."""
    arc = s.turn != 0
    ex, ey = s.x1 - s.cx, s.y1 - s.cy
    r = np.hypot(ex, ey)
    r = np.where(r > 0, r, 1.0)
    return np.where(arc, -s.turn * ey / r, s.ux), np.where(arc, s.turn * ex / r, s.uy)


def points_at(s: Segments, at: Floats) -> tuple[Floats, Floats]:
    """Return the point of segment i at arc length ``at[i]`` from its start."""
    arc = s.turn != 0
    r = np.where(s.radius > 0, s.radius, 1.0)
    a = s.a0 + s.turn * at / r
    return (
        np.where(arc, s.cx + s.radius * np.cos(a), s.x0 + s.ux * at),
        np.where(arc, s.cy + s.radius * np.sin(a), s.y0 + s.uy * at),
    )


def tangents_at(s: Segments, at: Floats) -> tuple[Floats, Floats]:
    """Return the unit direction of travel of segment i at arc length ``at[i]``."""
    arc = s.turn != 0
    r = np.where(s.radius > 0, s.radius, 1.0)
    a = s.a0 + s.turn * at / r
    return (
        np.where(arc, -s.turn * np.sin(a), s.ux),
        np.where(arc, s.turn * np.cos(a), s.uy),
    )


def position_of(s: Segments, x: Floats, y: Floats) -> Floats:
    """Return the arc length from the start at which segment i passes nearest to (x[i], y[i]).

    For a line: the foot of the perpendicular, which may lie outside 0..length. For an arc: the
    polar angle, in -half the rest of the circle .. sweep + half the rest, as an arc length.
    """
    arc = s.turn != 0
    along = (x - s.x0) * s.ux + (y - s.y0) * s.uy
    a = np.mod((np.arctan2(y - s.cy, x - s.cx) - s.a0) * s.turn, TAU)
    rest = TAU - s.sweep
    a = np.where(a > s.sweep + 0.5 * rest, a - TAU, a)
    return np.where(arc, a * s.radius, along)


def boxes(s: Segments) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the exact bounding boxes (xmin, ymin, xmax, ymax) of the segments."""
    xmin, xmax = np.minimum(s.x0, s.x1), np.maximum(s.x0, s.x1)
    ymin, ymax = np.minimum(s.y0, s.y1), np.maximum(s.y0, s.y1)
    arcs = np.flatnonzero(s.turn)
    if len(arcs):
        a = s.take(arcs)
        for quarter, (low, high, sign) in enumerate(
            ((None, xmax, 1.0), (None, ymax, 1.0), (xmin, None, -1.0), (ymin, None, -1.0))
        ):
            passed = np.mod((quarter * 0.5 * np.pi - a.a0) * a.turn, TAU) <= a.sweep
            rows = arcs[passed]
            centre = (a.cx if quarter % 2 == 0 else a.cy)[passed]
            reach = centre + sign * a.radius[passed]
            if high is not None:
                high[rows] = np.maximum(high[rows], reach)
            if low is not None:
                low[rows] = np.minimum(low[rows], reach)
    return xmin, ymin, xmax, ymax


def distances(s: Segments, x: Floats, y: Floats) -> Floats:
    """Return the exact distance from point i to segment i, um."""
    arc = s.turn != 0
    to_start = np.hypot(x - s.x0, y - s.y0)
    to_end = np.hypot(x - s.x1, y - s.y1)
    ends = np.minimum(to_start, to_end)
    along = (x - s.x0) * s.ux + (y - s.y0) * s.uy
    across = np.abs((y - s.y0) * s.ux - (x - s.x0) * s.uy)
    on_line = np.where((along > 0) & (along < s.length), across, ends)
    if not arc.any():
        return on_line
    px, py = x - s.cx, y - s.cy
    a = np.mod((np.arctan2(py, px) - s.a0) * s.turn, TAU)
    radial = np.abs(np.hypot(px, py) - s.radius)
    on_arc = np.where(a <= s.sweep, radial, ends)
    return np.where(arc, on_arc, on_line)

"""Where an arc ends on a controller that recomputes it from J and G, instead of counting steps.

Such a controller takes R from the start, unwinds J along the projections of the arc on the G axis
to find the end's coordinate on that axis, and the other coordinate from R. A program written for it
(``--count textbook``) is judged by these ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Axis, Kind
from wedmcam.judge.segments import Floats, Ints


class Recomputed(NamedTuple):
    """Ends of arcs, one entry a block.

    Attributes:
        dx: end minus start, whole um.
        dy: likewise.
        sweep: radians turned by an arc, >= 0; 0 for anything else.
    """

    dx: Ints
    dy: Ints
    sweep: Floats


def _half_up(value: Floats) -> Ints:
    """Round half away from zero."""
    return np.asarray(np.sign(value) * np.floor(np.abs(value) + 0.5)).astype(np.int64)


def recomputed_ends(blocks: NDArray[np.void]) -> Recomputed:
    """Return where arcs end by geometry.

    The G coordinate is unwound with R = |start| rounded to um, as J was made; the other one is
    sqrt(|start|^2 - g^2) rounded to um: the end lies on the circle of the start (ours: no source
    says how such a controller rounds). An arc counted on the inscribed square has
    no such end (a machine that counts so does not recompute): dx = dy = 0 and its sweep is NaN.
    Lines and control blocks: zeros.

    Sources:
        spec 3B: J is the sum of the projections; the published hole of radius 10 mm closes:

    >>> from wedmcam.ir.program import BLOCK
    >>> b = np.zeros(2, BLOCK)
    >>> b[0] = (Kind.ARC, 1, Axis.Y, 0, 9900, 0, 39600, -1, 0)
    >>> b[1] = (Kind.ARC, 1, Axis.X, 0, 0, 40100, 80100, -1, 0)
    >>> r = recomputed_ends(b)
    >>> r.dx.tolist(), r.dy.tolist()
    ([0, -100], [0, -80200])
    """
    kind, count = blocks["kind"], blocks["count"].astype(np.float64)
    x, y = blocks["x"].astype(np.float64), blocks["y"].astype(np.float64)
    turn, axis = blocks["turn"].astype(np.float64), blocks["axis"]
    dx, dy = np.zeros(len(blocks), np.int64), np.zeros(len(blocks), np.int64)
    sweep = np.zeros(len(blocks))

    arc = np.flatnonzero((kind == Kind.ARC) & (axis < Axis.SQUARE))
    sweep[(kind == Kind.ARC) & (axis >= Axis.SQUARE)] = np.nan
    if len(arc):
        ex, ey, turned = _arc_ends(x[arc], y[arc], turn[arc], axis[arc] == Axis.X, count[arc])
        dx[arc] = ex - blocks["x"][arc]
        dy[arc] = ey - blocks["y"][arc]
        sweep[arc] = turned
    return Recomputed(dx, dy, sweep)


def _arc_ends(
    x: Floats, y: Floats, turn: Floats, on_x: NDArray[np.bool_], count: Floats
) -> tuple[Ints, Ints, Floats]:
    """Return ends relative to the centre, and the angle turned."""
    radius = np.floor(np.hypot(x, y) + 0.5)
    g = np.where(on_x, x, y)
    other = np.where(on_x, y, x)
    # Counter-clockwise x falls where y > 0 and y grows where x > 0. ``hand`` carries the sense and
    # the axis: the heading on G is hand * sign(other), and the other way round.
    hand = np.where(on_x, -turn, turn)
    heading = np.where(other != 0, hand * np.sign(other), -np.sign(g))
    leg = radius - heading * g  # to the turning point ahead
    beyond = count - leg
    past = beyond > 0
    legs = np.where(past, np.floor(np.maximum(beyond, 0.0) / np.maximum(2.0 * radius, 1.0)), 0.0)
    rest = beyond - legs * 2.0 * radius
    flips = np.where(past, 1.0 + legs, 0.0)
    last = heading * np.where(flips % 2 == 1, -1.0, 1.0)
    g_end = np.where(past, -last * radius + last * rest, g + heading * count)
    other_end = hand * last * np.sqrt(np.maximum(x**2 + y**2 - g_end**2, 0.0))
    ge, oe = _half_up(g_end), _half_up(other_end)
    ex, ey = np.where(on_x, ge, oe), np.where(on_x, oe, ge)
    # Whole half turns between turning points, and the parts before the first and after the last.
    a0 = np.arccos(np.clip(heading * g / np.maximum(radius, 1.0), -1.0, 1.0))
    a1 = np.arccos(np.clip(last * g_end / np.maximum(radius, 1.0), -1.0, 1.0))
    rough = np.where(past, a0 + legs * np.pi + (np.pi - a1), a0 - a1)
    # Exactly: the angle between the two points, in the turn that this tells.
    angle = np.mod((np.arctan2(ey, ex) - np.arctan2(y, x)) * turn, 2.0 * np.pi)
    sweep = angle + 2.0 * np.pi * np.round((rough - angle) / (2.0 * np.pi))
    return ex, ey, np.maximum(sweep, 0.0)

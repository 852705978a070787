"""Lines and arcs as vectors, for a controller that runs nothing else.

The direction of a vector comes from whole numbers, and the coarser the lower the speed: a vector
leads beside its line, by more the longer it is. So segments are parted until each vector leads no
more than a step beside its own line, and its steps stay within the budget beside the true segment.
Points between two vectors are chosen for where the stair of their steps will lie.
"""

from __future__ import annotations

import numpy as np

from wedmcam.controllers.eindhoven.vectors import Vectors
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.program import BLOCK
from wedmcam.transforms.lower.fit import Budget, Ideal, cost_of

#: How far steps may lie beside the true segment, steps: what the stair (0.7) and a point of the
#: grid (0.35) need on most vectors, and a little for their directions. Less would take twice as
#: many vectors, and more save a few.
BUDGET = Budget(1.1, 1.1)
#: How far a vector may lead beside its own line, steps (2 um).
SIDEWAYS = 1.0
#: What is aimed at where a segment is parted: the ends of vectors lie beside it too.
AIMED = 0.7
#: Sagitta of arcs that is left to a vector, steps.
SAGITTA = 0.3
#: An arc is parted at least into pieces of this sweep, radians.
SWEEP = 1.0
#: From this speed on vectors are long enough to have a stair of steps.
STAIRS = 3
#: Vectors of so many steps are not parted.
LEAST = 2.3
#: How much nearer to what falls away points are chosen, steps.
AWAY = 0.1
#: A point lies at most this far from the true one, steps; the second where vectors are so short
#: that the next point could come to lie behind it.
MOVED, NEAREST = 1.0, 0.75
#: Places of the grid about one.
NEAR = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])


def pieces(
    t: Ideal,
    sweep: Floats,
    ends: tuple[Ints, Ints, Ints, Ints],
    stepping: Vectors,
) -> Ints:
    """Return into how many vectors true segments are to be parted next; 1 where one will do.

    Args:
        t: the segments, steps.
        sweep: of arcs, radians.
        ends: x and y of the places of the grid where the vector would start, and where it ends.
        stepping: the controller, at its cutting speed.
    """
    ax, ay, bx, by = ends
    dx, dy = bx - ax, by - ay
    blocks = np.zeros(len(dx), BLOCK)
    blocks["x"], blocks["y"], blocks["count"] = dx, dy, stepping.speed
    chord = np.hypot(dx, dy)
    arc = t.turn != 0
    radius = np.where(arc, np.maximum(t.radius, 1e-9), 1.0)
    by_sag = np.ceil(radius * sweep / np.sqrt(8.0 * radius * SAGITTA))
    out = np.where(arc, np.maximum(by_sag, np.ceil(sweep / SWEEP)), 1.0)
    out = np.where(arc & (radius * sweep <= LEAST), 1.0, out)
    rows = np.flatnonzero((out == 1.0) & (chord > LEAST))
    held = t.take(rows)
    lead = stepping.sideways(blocks[rows])
    needed = np.where(lead > SIDEWAYS, np.ceil(lead / AIMED), 1.0)
    near = np.flatnonzero(needed == 1.0)  # only of these the stair is looked at
    low, high = stepping.deviation(blocks[rows[near]])
    one = held.take(near)
    start = beside(one, ax[rows[near]], ay[rows[near]])
    end = beside(one, bx[rows[near]], by[rows[near]])
    sag = np.where(one.turn != 0, chord[rows[near]] ** 2 / (8.0 * np.maximum(one.radius, 1.0)), 0.0)
    low = low + np.minimum(start, end) - sag * (one.turn < 0)
    high = high + np.maximum(start, end) + sag * (one.turn > 0)
    needed[near] = np.where(cost_of(low, high, one.keeps, BUDGET) > 1.0, 2.0, 1.0)
    out[rows] = needed
    return out.astype(np.int64)


def beside(t: Ideal, x: Ints, y: Ints) -> Floats:
    """Return how far places lie to the left of true segments, steps."""
    ux, uy = t.x1 - t.x0, t.y1 - t.y0
    length = np.maximum(np.hypot(ux, uy), 1e-9)
    of_line = ((y - t.y0) * ux - (x - t.x0) * uy) / length
    of_arc = t.turn * (t.radius - np.hypot(x - t.cx, y - t.cy))
    return np.where(t.turn == 0, of_line, of_arc)


def points(
    t: Ideal, at_start: tuple[Ints, Ints], at_end: tuple[Ints, Ints], x: Floats, y: Floats,
    nearest: tuple[Ints, Ints], stepping: Vectors,
) -> tuple[Ints, Ints]:  # fmt: skip
    """Return places of the grid for vertices: the stairs of the vectors are to lie about the path.

    A vertex has a cost a segment that it ends; the worse one counts.

    Args:
        t: true segments, steps.
        at_start: rows of segments, and the vertex that each starts at.
        at_end: likewise, where each ends.
        x, y: the true vertices.
        nearest: the places of the grid nearest to them.
        stepping: the controller, at its cutting speed.
    """
    gx, gy = nearest[0][:, None] + NEAR[:, 0], nearest[1][:, None] + NEAR[:, 1]
    cost = np.zeros(gx.shape)
    for (rows, vertex), which in ((at_start, 0), (at_end, 1)):
        one = t.take(rows)
        ux, uy = _heading(one, which)
        want = _centre(ux, uy, stepping) - AWAY * one.keeps
        for k in range(len(NEAR)):
            off = beside(one, gx[vertex, k], gy[vertex, k])
            np.maximum.at(cost[:, k], vertex, np.abs(off - want))
    away = np.hypot(gx - x[:, None], gy - y[:, None])
    far = NEAREST if _short(stepping) else MOVED
    cost += np.where(away > far, 10.0, 0.02 * away)
    best = np.argmin(cost, axis=1)
    row = np.arange(len(best))
    return gx[row, best], gy[row, best]


def _heading(t: Ideal, which: int) -> tuple[Floats, Floats]:
    """Return the unit vectors along segments at their starts (0) or ends (1)."""
    x, y = (t.x1, t.y1) if which else (t.x0, t.y0)
    arc = t.turn != 0
    ux = np.where(arc, -t.turn * (y - t.cy), t.x1 - t.x0)
    uy = np.where(arc, t.turn * (x - t.cx), t.y1 - t.y0)
    length = np.maximum(np.hypot(ux, uy), 1e-9)
    return ux / length, uy / length


def _short(stepping: Vectors) -> bool:
    """Return whether directions are so coarse that vectors are of a step or two."""
    return stepping.direction == "root" and stepping.speed < STAIRS


def _centre(ux: Floats, uy: Floats, stepping: Vectors) -> Floats:
    """Return where places have to lie beside a line for its stair to lie about it.

    With x first the stair lies from |ux| to the right to |uy| to the left where both go one way. At
    the lowest speeds vectors are of a step or two, and there is none.
    """
    if _short(stepping):
        return np.zeros(len(ux))
    a, b = np.abs(ux), np.abs(uy)
    out: Floats = (a - b) / 2.0 * np.sign(np.round(ux, 6) * np.round(uy, 6))
    straight = (a < 1e-3) | (b < 1e-3)  # along an axis there is no stair
    out = np.where(straight, 0.0, out)
    return -out if stepping.y_first else out

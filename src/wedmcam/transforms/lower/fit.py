"""Which integers describe a line or an arc: candidate centres, where they land, how far they stray.

A controller's arc is its start relative to a whole-um centre; where it ends is what its
interpolator makes of that. So centres near the true one are tried, those that land exactly on the
wanted micron with a step that counts are kept, and the one that strays least is taken.

How far the stepped path strays is bounded in closed form. The step rule keeps F = |p|^2 - R0^2
between -2 * (shrinking magnitude) and +2 * (growing magnitude), so the stair lies between
-cos t and +sin t of its own circle, t being the angle since the axis last crossed; for a line
between -|dy| / L and |dx| / L of its chord (quadrants 1 and 3; the other way round in 2 and 4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.geom.segments import TAU, Floats, Ints
from wedmcam.ir.program import Axis

Bools = NDArray[np.bool_]

#: Angles at which a candidate arc is compared with the true one.
SAMPLES = 33
#: Candidates that are compared at all, those with the best radius and place.
SHORTLIST = 6
#: Below this sweep the centre is also sought along the bisector of the chord (radians).
STRIP_SWEEP = np.radians(100.0)
STRIP = np.array([-12, -9, -7, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 7, 9, 12])
NEAR = np.array([(i, j) for i in (0, -1, 1) for j in (0, -1, 1)])


@dataclass(frozen=True, slots=True)
class Budget:
    """How far the stepped path may stray from the exact one, um.

    Attributes:
        gouge: towards the kept material.
        other: away from it.
    """

    gouge: float = 1.59
    other: float = 1.6


@dataclass(frozen=True, slots=True, eq=False)
class Ideal:
    """True segments, one a row, um: what the stepped ones are compared with.

    keeps: +1 kept material to the left, -1 to the right, 0 on neither side.
    """

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    radius: Floats
    turn: Ints
    keeps: Ints

    def take(self, rows: NDArray[np.int64] | Bools) -> Ideal:
        """Return the chosen rows."""
        return Ideal(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """The arc found for each row; only where ``ok``.

    Attributes:
        ok: whether a centre lands on the end within the budget and the limits.
        cost: the stray in parts of the budget, 1 at the limit; inf where nothing lands.
        cx, cy: the centre, whole um.
        axis: `Axis` of the arriving step (X or Y).
        count: steps on that axis.
        square: steps that count on the inscribed square.
        steps: all steps.
    """

    ok: Bools
    cost: Floats
    cx: Ints
    cy: Ints
    axis: Ints
    count: Ints
    square: Ints
    steps: Ints


def cost_of(low: Floats, high: Floats, keeps: Ints, budget: Budget) -> Floats:
    """Return the stray (left positive, between low and high) in parts of the budget."""
    left = np.where(keeps > 0, budget.gouge, budget.other)
    right = np.where(keeps < 0, budget.gouge, budget.other)
    cost: Floats = np.maximum(high / left, -low / right)
    return cost


def line_cost(t: Ideal, sx: Ints, sy: Ints, ex: Ints, ey: Ints, budget: Budget) -> Floats:
    """Return the cost of stepping from (sx, sy) to (ex, ey) instead of the true line t."""
    dx, dy = t.x1 - t.x0, t.y1 - t.y0
    length = np.hypot(dx, dy)
    safe = np.where(length > 0, length, 1.0)
    nx, ny = -dy / safe, dx / safe
    at_start = (sx - t.x0) * nx + (sy - t.y0) * ny
    at_end = (ex - t.x0) * nx + (ey - t.y0) * ny
    ax, ay = (ex - sx).astype(float), (ey - sy).astype(float)
    stair = np.hypot(ax, ay)
    stair = np.where(stair > 0, stair, 1.0)
    a, b = np.abs(ax) / stair, np.abs(ay) / stair
    straight = (ax == 0) | (ay == 0)
    odd = (ax > 0) == (ay > 0)
    up = np.where(straight, 0.0, np.where(odd, a, b))
    down = np.where(straight, 0.0, np.where(odd, b, a))
    # Along the line the ends may not fall short by more than the budget either.
    ux, uy = dx / safe, dy / safe
    short = np.maximum(
        np.abs((sx - t.x0) * ux + (sy - t.y0) * uy), np.abs((ex - t.x1) * ux + (ey - t.y1) * uy)
    )
    cost = cost_of(
        np.minimum(at_start, at_end) - down, np.maximum(at_start, at_end) + up, t.keeps, budget
    )
    return np.maximum(cost, short / budget.other)


def chord_cost(t: Ideal, sx: Ints, sy: Ints, ex: Ints, ey: Ints, budget: Budget) -> Floats:
    """Return the cost of stepping a straight line instead of the true arc t."""
    chord = np.hypot(t.x1 - t.x0, t.y1 - t.y0)
    half = np.minimum(0.5 * chord / np.maximum(t.radius, 1e-9), 1.0)
    sag = t.radius * (1.0 - np.sqrt(1.0 - half * half))
    a0 = np.arctan2(t.y0 - t.cy, t.x0 - t.cx)
    a1 = np.arctan2(t.y1 - t.cy, t.x1 - t.cx)
    wide = np.mod((a1 - a0) * t.turn, TAU) > np.pi
    sag = np.where(wide, 2 * t.radius - sag, sag)
    return line_cost(t, sx, sy, ex, ey, budget) + sag / min(budget.gouge, budget.other)


def _centres(t: Ideal, sx: Ints, sy: Ints, ex: Ints, ey: Ints) -> tuple[Ints, Ints]:
    """Return candidate centres, shape (n, k): neighbours of the true one, and along the bisector.

    On the bisector of the chord start and end have (nearly) one radius, which is what landing
    takes; moving the centre along it changes a short arc by almost nothing.
    """
    bx, by = np.rint(t.cx).astype(np.int64), np.rint(t.cy).astype(np.int64)
    near_x = bx[:, None] + NEAR[None, :, 0]
    near_y = by[:, None] + NEAR[None, :, 1]
    dx, dy = (ex - sx).astype(float), (ey - sy).astype(float)
    chord = np.hypot(dx, dy)
    safe = np.where(chord > 0, chord, 1.0)
    nx, ny = -dy / safe, dx / safe
    mx, my = 0.5 * (sx + ex), 0.5 * (sy + ey)
    height = (t.cx - mx) * nx + (t.cy - my) * ny
    strip = height[:, None] + STRIP[None, :]
    strip_x = np.rint(mx[:, None] + strip * nx[:, None]).astype(np.int64)
    strip_y = np.rint(my[:, None] + strip * ny[:, None]).astype(np.int64)
    return np.hstack([near_x, strip_x]), np.hstack([near_y, strip_y])


def fit_arcs(
    t: Ideal,
    sx: Ints,
    sy: Ints,
    ex: Ints,
    ey: Ints,
    budget: Budget,
    arc_limit: int,
    count_limit: int,
    stepping: Stepping,
    *,
    textbook: bool = False,
    square: Axis = Axis.SQUARE,
) -> Arcs:
    """Return for each true arc t the best stepped arc from (sx, sy) to (ex, ey), whole um.

    start == end is a full turn. ``textbook``: J by geometry, for controllers that recompute the end
    from it; the end must come out of that computation. ``square``: its rule at a tie.
    """
    n = len(sx)
    best = Arcs(
        np.zeros(n, bool),
        np.full(n, np.inf),
        *(np.zeros(n, np.int64) for _ in range(6)),
    )
    for first in range(0, n, 4096):  # cache-sized pieces, and bounded memory
        rows = slice(first, first + 4096)
        part = Ideal(*(getattr(t, name)[rows] for name in Ideal.__slots__))
        found = _fit_piece(
            part,
            sx[rows],
            sy[rows],
            ex[rows],
            ey[rows],
            budget,
            arc_limit,
            count_limit,
            stepping,
            textbook,
            square,
        )
        for name in Arcs.__slots__:
            getattr(best, name)[rows] = getattr(found, name)
    return best


def _fit_piece(
    t: Ideal,
    sx: Ints,
    sy: Ints,
    ex: Ints,
    ey: Ints,
    budget: Budget,
    arc_limit: int,
    count_limit: int,
    stepping: Stepping,
    textbook: bool,
    square_axis: Axis,
) -> Arcs:
    n = len(sx)
    cx, cy = _centres(t, sx, sy, ex, ey)
    k = cx.shape[1]
    strip_ok = _sweep(t) <= STRIP_SWEEP
    usable = np.ones((n, k), bool)
    usable[:, len(NEAR) :] = strip_ok[:, None]
    x, y = sx[:, None] - cx, sy[:, None] - cy
    fx, fy = ex[:, None] - cx, ey[:, None] - cy
    usable &= (np.abs(x) <= arc_limit) & (np.abs(y) <= arc_limit) & (x * x + y * y >= 2)
    turn = np.broadcast_to(t.turn[:, None], (n, k))
    x, y = np.where(usable, x, 2), np.where(usable, y, 0)
    if textbook:
        landed, axis, count = _textbook(x, y, turn, fx, fy)
        square, steps = np.zeros_like(count), np.zeros_like(count)
        usable &= landed & (count <= count_limit)
    else:
        end = stepping.arc_end(x, y, turn, fx, fy, square_axis)
        axis = end.last_axis
        count = np.where(axis == Axis.X, end.count_x, end.count_y)
        square, steps = end.count_square, end.steps
        usable &= end.landed & end.square_counts
        usable &= (count <= count_limit) & (square <= count_limit)
    cost = np.full((n, k), np.inf)
    rows, columns = np.nonzero(usable)
    if len(rows):
        # A shortlist by mismatch of place and radius, then the full comparison.
        rough = np.hypot(cx[rows, columns] - t.cx[rows], cy[rows, columns] - t.cy[rows])
        order = np.lexsort((rough, rows))
        rank = np.arange(len(rows)) - np.searchsorted(rows[order], rows[order])
        pick = order[rank < SHORTLIST]
        rows, columns = rows[pick], columns[pick]
        low, high = _stray(
            t.take(rows),
            x[rows, columns],
            y[rows, columns],
            fx[rows, columns],
            fy[rows, columns],
            cx[rows, columns],
            cy[rows, columns],
        )
        cost[rows, columns] = cost_of(low, high, t.keeps[rows], budget)
        # Of equals the centre nearest to the true one.
        shift = np.hypot(cx[rows, columns] - t.cx[rows], cy[rows, columns] - t.cy[rows])
        prefer = np.full((n, k), np.inf)
        prefer[rows, columns] = cost[rows, columns] + 1e-3 * shift
    else:
        prefer = cost
    column = np.argmin(prefer, axis=1)
    at = np.arange(n), column
    return Arcs(
        cost[at] <= 1.0, cost[at], cx[at], cy[at], axis[at], count[at], square[at], steps[at]
    )


def _sweep(t: Ideal) -> Floats:
    a0 = np.arctan2(t.y0 - t.cy, t.x0 - t.cx)
    a1 = np.arctan2(t.y1 - t.cy, t.x1 - t.cx)
    sweep = np.mod((a1 - a0) * t.turn, TAU)
    full = (t.x0 == t.x1) & (t.y0 == t.y1)
    return np.where(full, TAU, sweep)


def _stray(
    t: Ideal, x: Ints, y: Ints, fx: Ints, fy: Ints, cx: Ints, cy: Ints
) -> tuple[Floats, Floats]:
    """Return bounds (low, high), left positive, of the stepped arc from the true one."""
    radius = np.hypot(x, y)
    a0 = np.arctan2(y, x)
    a1 = np.arctan2(fy, fx)
    sweep = np.mod((a1 - a0) * t.turn, TAU)
    sweep = np.where((x == fx) & (y == fy), TAU, sweep)
    part = np.linspace(0.0, 1.0, SAMPLES)
    angle = a0[:, None] + (t.turn * sweep)[:, None] * part[None, :]
    px = (cx - t.cx)[:, None] + radius[:, None] * np.cos(angle)
    py = (cy - t.cy)[:, None] + radius[:, None] * np.sin(angle)
    radial = np.hypot(px, py) - t.radius[:, None]
    since = np.mod(angle * t.turn[:, None], np.pi / 2)
    # Between two samples the stair may be at its worst: look half a sample on and back.
    half = np.minimum(0.5 * sweep / (SAMPLES - 1), np.pi / 4)[:, None]
    out = radial + np.sin(np.minimum(since + half, np.pi / 2))
    into = radial - np.cos(np.maximum(since - half, 0.0))
    # Half a sample before an axis the sine is nearly 1, just past it the cosine is.
    into = np.where(since + half >= np.pi / 2, np.minimum(into, radial - 1.0), into)
    out = np.where(since - half <= 0.0, np.maximum(out, radial + 1.0), out)
    # At the very ends only the side that belongs to the arc counts: the stair starts on its circle.
    outward, inward = out.max(axis=1), into.min(axis=1)
    left_is_in = t.turn > 0
    low = np.where(left_is_in, -outward, inward)
    high = np.where(left_is_in, -inward, outward)
    return low, high


def _textbook(x: Ints, y: Ints, turn: Ints, fx: Ints, fy: Ints) -> tuple[Bools, Ints, Ints]:
    """Return (comes out, axis, J) of arcs with J by geometry, R rounded to whole um."""
    from wedmcam.controllers.pointwise.nominal import nominal_count, nominal_end

    axis = np.where(np.abs(fx) >= np.abs(fy), int(Axis.Y), int(Axis.X))
    count = nominal_count(x, y, turn, fx, fy, axis)
    gx, gy = nominal_end(x, y, turn, axis, count)
    return (gx == fx) & (gy == fy), axis, count

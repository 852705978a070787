"""How far the stepped path strays from the line or arc it stands for: exact, and not by stepping.

F itself is the deviation, scaled: of a line F / length, of an arc sqrt(R^2 + F) - R. So what is
wanted are the extremes of F in integers.

- Line: F after k steps is a k (mod a + b) shifted. Its least value comes at step 1, its greatest is
  found by Euclid's algorithm, as in the three-distance theorem.
- Arc: F has its extremes where a row of equal steps ends, so one row per octant step is looked at,
  and of these only those whose bound still beats the best seen: about sqrt(R) of R.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise.circle import Bools, Floats, Ints, apex, frame, place, tie
from wedmcam.controllers.pointwise.closed import PIECE, line_frame, run
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.ir.program import Kind

#: Rows that a search looks at in its first round; each round doubles it. Few, for many short arcs.
_FIRST_ROWS = 4


def deviation(
    blocks: NDArray[np.void], table: LineTable = LineTable.MIRROR
) -> tuple[Floats, Floats]:
    """Return (low, high): the extreme signed deviations of each block's path from its ideal, um.

    Taken over all stepped positions and the start, so low <= 0 <= high. The ideal of a line is the
    line through its start along (x, y), deviation positive to its left; of an arc the circle
    through its start about its centre, deviation |p - c| - R0, positive outwards. Exact: the
    extremes are found in integers and turned into um at the end, in float64. Blocks that make no
    step, invalid ones among them, have 0, 0.

    >>> from wedmcam.ir.program import BLOCK, Axis
    >>> b = np.zeros(1, BLOCK)
    >>> b["x"], b["y"], b["axis"], b["count"] = 6, 4, Axis.X, 6  # F from -4 to 4
    >>> [round(float(d[0]) * 52**0.5, 9) for d in deviation(b)]
    [-4.0, 4.0]
    """
    low, high = np.zeros(len(blocks)), np.zeros(len(blocks))
    steps = run(blocks, table).steps
    for first in range(0, len(blocks), PIECE):
        rows = slice(first, first + PIECE)
        part, n = blocks[rows], steps[rows]
        is_arc = part["kind"] == Kind.ARC
        pick = np.flatnonzero((n > 0) & ~is_arc)
        if len(pick):
            low[rows][pick], high[rows][pick] = _lines(part[pick], n[pick], table)
        pick = np.flatnonzero((n > 0) & is_arc)
        if len(pick):
            low[rows][pick], high[rows][pick] = _arcs(part[pick], n[pick].astype(np.float64))
    return low, high


# --- lines ------------------------------------------------------------------------------------


def greatest_residue(a: Ints, m: Ints, n: Ints) -> Ints:
    """Return the greatest of a j mod m over 0 <= j <= n, for arrays with 0 < a < m, n >= 0.

    The least and the greatest residue so far, ``least`` (at j = i) and m - ``gap`` (at j = k),
    improve each other by turns: each step of the loop is a whole run of improvements.

    >>> greatest_residue(np.array([4, 4]), np.array([10, 11]), np.array([9, 3]))
    array([8, 8])
    """
    gap, k = m.copy(), np.zeros_like(m)
    out = m - gap
    live = np.arange(len(m))
    least, i = a.copy(), np.ones_like(m)
    n = n.copy()
    while len(live):
        times = np.minimum((gap - 1) // least, (n - k) // i)
        gap -= times * least
        k += times * i
        out[live] = m[live] - gap
        times = (least - 1) // gap
        least -= times * gap
        i += times * k
        go = (i + k <= n) & (least < gap)
        live, gap, k, least, i, n = live[go], gap[go], k[go], least[go], i[go], n[go]
    return out


def _lines(part: NDArray[np.void], n: Ints, table: LineTable) -> tuple[Floats, Floats]:
    """Do lines of n > 0 steps."""
    x, y = np.ascontiguousarray(part["x"]), np.ascontiguousarray(part["y"])
    p, q, p_is_x = line_frame(x, y, table)
    sloping = (p > 0) & (q > 0)
    # F + q after k >= 1 steps is p (k - 1) mod (p + q), and the start has F = 0.
    low = np.where(sloping, -q, 0)
    high = np.zeros_like(p)
    rows = np.flatnonzero(sloping)
    best = greatest_residue(p[rows], (p + q)[rows], n[rows] - 1)
    high[rows] = np.maximum(best - q[rows], 0)
    left = (np.sign(x) * np.sign(y) < 0) != p_is_x  # does F > 0 lie to the left?
    length = np.sqrt(x.astype(np.float64) ** 2 + y.astype(np.float64) ** 2)
    return np.where(left, low, -high) / length, np.where(left, high, -low) / length


# --- arcs -------------------------------------------------------------------------------------


class _Search(NamedTuple):
    """Which extreme of F a search looks for, row by row.

    Row z has s = isqrt(R^2 - 1 - z^2). Before the tie (h, h) a u step leaves column z at
    (z, s + 1), a greatest F, for (z - 1, s + 1), a least one. After it a v step leaves row z at
    (s, z), a least F, for (s, z + 1), a greatest. F there is F of (z + dz, s + ds).

    |F| <= 2 sqrt(R^2 - z^2) + extra where ``from_low``, so it falls with z; else <= 2 z + extra.
    """

    sign: float
    dz: float
    ds: float
    from_low: bool
    extra: float


_BEFORE_TIE = (_Search(+1.0, 0.0, 1.0, True, 0.0), _Search(-1.0, -1.0, 1.0, False, -1.0))
_AFTER_TIE = (_Search(-1.0, 0.0, 0.0, True, 1.0), _Search(+1.0, 1.0, 0.0, False, 0.0))


def _search(how: _Search, best: Floats, arc: Ints, r2: Floats, lo: Floats, hi: Floats) -> None:
    """Raise ``best[arc]`` to the greatest of sign F over the rows lo <= z < hi, one search a row.

    Rows are taken from the promising end, until the bound of the rest is below the best.
    """
    width = _FIRST_ROWS
    go = lo < hi
    while go.any():
        arc, r2, lo, hi = arc[go], r2[go], lo[go], hi[go]
        if how.from_low:
            hi = np.minimum(hi, np.floor(_reach(r2, best[arc], how.extra)) + 2.0)
        else:
            lo = np.maximum(lo, np.floor(0.5 * (best[arc] - how.extra)))
        at_once = max(1, PIECE // width)
        ramp = np.arange(float(width))
        for first in range(0, len(arc), at_once):
            some = slice(first, first + at_once)
            if how.from_low:
                z = np.minimum(lo[some, None] + ramp, hi[some, None] - 1.0)
            else:
                z = np.maximum(hi[some, None] - 1.0 - ramp, lo[some, None])
            r = r2[some, None]
            s = np.floor(np.sqrt(np.maximum(r - 1.0 - z * z, 0.0)))
            s[r - 1.0 < z * z] = -1.0
            z += how.dz
            s += how.ds
            f = (how.sign * (z * z + s * s - r)).max(axis=1)
            np.maximum.at(best, arc[some], f)
        if how.from_low:
            lo = lo + width
        else:
            hi = hi - width
        width *= 2
        go = lo < hi


def _reach(r2: Floats, best: Floats, extra: float) -> Floats:
    """Return the z from which on 2 sqrt(R^2 - z^2) + extra <= best."""
    half: Floats = np.maximum(0.5 * (best - extra), 0.0)
    z: Floats = np.sqrt(np.maximum(r2 - half * half, 0.0))
    return z


def _place(r2: Floats, a: Floats, m: Floats) -> tuple[Floats, Floats]:
    """Return `place`, with the apex at m = 0."""
    u, v = place(r2, a, np.maximum(m, 1.0))
    return np.where(m == 0, a, u), np.where(m == 0, 0.0, v)


def _arcs(part: NDArray[np.void], n: Floats) -> tuple[Floats, Floats]:
    """Do arcs of n > 0 steps.

    All quadrants have the same F, so what is looked at are at most two stretches [lo, hi] of the
    2 A steps of one quadrant.
    """
    x, y = part["x"].astype(np.float64), part["y"].astype(np.float64)
    r2 = x * x + y * y
    a = apex(r2)
    f = frame(x, y, part["turn"].astype(np.float64))
    begin = a - f.u + f.v
    end = begin + n
    over = end - 2.0 * a
    whole = over >= begin
    wraps = (over > 0) & ~whole
    h, _ = tie(r2)
    greatest, least = np.zeros(len(n)), np.zeros(len(n))  # of F and of -F
    everyone = np.arange(len(n))
    for arc, lo, hi in (
        (everyone, np.where(whole, 0.0, begin), np.where(over > 0, 2.0 * a, end)),
        (everyone[wraps], np.zeros(int(wraps.sum())), over[wraps]),
    ):
        if not len(arc):
            continue
        r, reach, corner = r2[arc], a[arc], h[arc]
        u0, v0 = _place(r, reach, lo)
        u1, v1 = _place(r, reach, hi)
        before: Bools = lo < reach
        after: Bools = hi > reach
        # Before the tie, after it, and the ends of both; the tie is an end only of a path that
        # passes it.
        passes = before & after
        u2, v2 = np.where(passes, corner, u0), np.where(passes, corner, v0)
        for u, v in ((u0, v0), (u1, v1), (u2, v2)):
            ends = u * u + v * v - r
            greatest[arc] = np.maximum(greatest[arc], ends)
            least[arc] = np.maximum(least[arc], -ends)
        u1 = np.where(after, corner, u1)
        v0 = np.where(before, corner, v0)
        for searches, rows, z0, z1 in (
            (_BEFORE_TIE, before, u1 + 1.0, u0 + 1.0),
            (_AFTER_TIE, after, v0, v1),
        ):
            for how in searches:
                best = greatest if how.sign > 0 else least
                _search(how, best, arc[rows], r[rows], z0[rows], z1[rows])
    root = np.sqrt(r2)
    return (
        -least / (np.sqrt(r2 - least) + root),
        greatest / (np.sqrt(r2 + greatest) + root),
    )

"""Every position of a program, for the judge, pictures and the simulated machine.

Still without stepping: positions come from the closed forms over a ramp of step numbers, one run a
line and one run a quadrant of an arc.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controller.circle import Floats, Ints, apex, frame, quadrant
from wedmcam.controller.closed import EXACT, Motion, line_frame, run
from wedmcam.ir.program import Kind, LineTable

#: Steps computed at a time: their temporaries fit the second-level cache.
PIECE = 32768

#: Runs from this length on are computed each on its own, with scalar constants; the calls cost some
#: 8 us a piece. Shorter ones go together, at about 5 ns a step for repeating the constants.
LONG = 1500

#: Steps under one formula. Step i = 1, 2, ... of a run has e = i - shift. Arc: u = floor((sqrt(c -
#: e^2) - e) / 2), where c = 2 R^2 - 1; line: u = ceil(e c / d), the steps along q. The place is
#: (x0 + xu u + xe e, y0 + yu u + ye e), um from the start of the path; xu, xe, yu, ye are +-1 or 0.
#: Sorted by ``block``, the runs are in the order of the path.
_RUN = np.dtype(
    [("block", "i8"), ("length", "i8"), ("is_arc", "?")]
    + [(name, "f8") for name in ("shift", "c", "d", "x0", "xu", "xe", "y0", "yu", "ye")]
)


def _line_runs(
    blocks: NDArray[np.void], rows: Ints, moves: Motion, table: LineTable
) -> NDArray[np.void]:
    """Return one run for each of the lines ``rows``; x0, y0 from the start of the line."""
    runs = np.zeros(len(rows), _RUN)
    x, y = blocks["x"][rows], blocks["y"][rows]
    p, q, p_is_x = line_frame(x, y, table)
    # A line with a length on q alone steps there at every step: let that be p.
    swap = p == 0
    p, q, p_is_x = np.where(swap, q, p), np.where(swap, 0, q), p_is_x ^ swap
    # u = ceil(q (n-1) / (p+q)) steps along q, e = n - 1, so p takes e + 1 - u.
    runs["block"], runs["length"] = rows, moves.steps[rows]
    runs["shift"], runs["c"], runs["d"] = 1.0, q, p + q
    sx, sy = np.sign(x), np.sign(y)
    runs["xu"], runs["yu"] = np.where(p_is_x, -sx, sx), np.where(p_is_x, sy, -sy)
    runs["xe"] = runs["x0"] = np.where(p_is_x, sx, 0)
    runs["ye"] = runs["y0"] = np.where(p_is_x, 0, sy)
    return runs


def _arc_runs(blocks: NDArray[np.void], rows: Ints, moves: Motion) -> NDArray[np.void]:
    """Return one run for each quadrant of the arcs ``rows``; x0, y0 from the start of the arc."""
    x, y, turn = (blocks[name][rows].astype(np.float64) for name in ("x", "y", "turn"))
    r2 = x * x + y * y
    a = apex(r2)
    f = frame(x, y, turn)
    begin = a - f.u + f.v  # steps from the apex of the first quadrant
    end = begin + moves.steps[rows]
    last = np.floor((end - 1.0) / (2.0 * a)).astype(np.int64)
    arc = np.repeat(np.arange(len(rows)), last + 1)
    nth = np.arange(len(arc)) - np.repeat(np.cumsum(last + 1) - (last + 1), last + 1)
    runs = np.zeros(len(arc), _RUN)
    a, turn = a[arc], turn[arc]
    m0 = np.where(nth == 0, begin[arc], 0.0)
    m1 = np.where(nth == last[arc], end[arc] - 2.0 * a * nth, 2.0 * a)
    runs["block"], runs["length"], runs["is_arc"] = rows[arc], m1 - m0, True
    runs["shift"], runs["c"], runs["d"] = a + 1.0 - m0, 2.0 * r2[arc] - 1.0, 1.0
    # (x, y) from the centre: even quadrants (s u, t s v), odd ones (-s v, t s u); v = u + e + 1.
    q = (quadrant(f)[arc].astype(np.int64) + nth) & 3
    odd, sign = (q & 1).astype(bool), np.where(q >= 2, -1.0, 1.0)
    runs["xu"], runs["yu"] = np.where(odd, -sign, sign), sign * turn
    runs["xe"] = np.where(odd, -sign, 0.0)
    runs["ye"] = np.where(odd, 0.0, sign * turn)
    runs["x0"], runs["y0"] = runs["xe"] - x[arc], runs["ye"] - y[arc]
    return runs


Columns = tuple[NDArray[Any], NDArray[Any]]


def _many(runs: NDArray[np.void], ramp: Floats, out: Columns) -> None:
    """Fill x and y with the steps of short runs, side by side; ``ramp`` is 1, 2, ..."""
    length = runs["length"]

    def spread(values: Floats) -> Floats:
        return np.repeat(values, length)

    e = spread(-(np.cumsum(length) - length + runs["shift"]))
    e += ramp[: len(e)]
    is_arc = runs["is_arc"]
    u = np.zeros_like(e)
    if is_arc.any():
        u += e
        u *= u
        np.subtract(spread(runs["c"]), u, out=u)
        if not is_arc.all():
            np.abs(u, out=u)  # lines are wiped out below
        np.sqrt(u, out=u)
        u -= e
        u *= 0.5 if is_arc.all() else spread(np.where(is_arc, 0.5, 0.0))
        np.floor(u, out=u)
    if not is_arc.all():
        along_q = spread(np.where(is_arc, 0.0, runs["c"]))
        along_q *= e
        along_q /= spread(runs["d"])
        u += np.ceil(along_q, out=along_q)
    for target, name in zip(out, "xy", strict=True):
        value = spread(runs[name + "u"])
        value *= u
        by_e = spread(runs[name + "e"])
        by_e *= e
        value += by_e
        value += spread(runs[name + "0"])
        target[:] = value


def _one(one: tuple[Any, ...], ramp: Floats, scratch: Floats, out: Columns) -> None:
    """Fill x and y with the steps of one long run, piece by piece; ``ramp`` is 1, 2, ..."""
    _, length, is_arc, shift, c, d, x0, xu, xe, y0, yu, ye = one
    for first in range(0, length, PIECE):
        n = min(PIECE, length - first)
        e, u, value = scratch[:, :n]
        np.add(ramp[:n], first - shift, out=e)
        if is_arc:
            np.multiply(e, e, out=u)
            np.subtract(c, u, out=u)
            np.sqrt(u, out=u)
            u -= e
            u *= 0.5
            np.floor(u, out=u)
        elif length * c < EXACT:
            np.multiply(e, c, out=u)
            u /= d
            np.ceil(u, out=u)
        else:  # millions of steps along a ratio of large numbers
            u[:] = -((e.astype(np.int64) * -int(c)) // int(d))
        for column, by_u, by_e, zero in ((out[0], xu, xe, x0), (out[1], yu, ye, y0)):
            sign, walked = by_e or by_u, u
            if by_e:
                walked = (np.add if by_u == by_e else np.subtract)(e, u, out=value)
            target = column[first : first + n]
            result = target if target.dtype == np.float64 else value
            if sign > 0:
                np.add(walked, zero, out=result)
            else:
                np.subtract(zero, walked, out=result)
            if result is value:
                target[:] = value


def _fill(runs: NDArray[np.void], x: NDArray[Any], y: NDArray[Any]) -> None:
    """Fill x and y, int64 or float64, with the places after every step of the runs."""
    ramp = np.arange(1.0, PIECE + LONG + 1.0)
    scratch = np.empty((3, PIECE))
    ends = np.cumsum(runs["length"])
    long_rows = np.flatnonzero(runs["length"] >= LONG)
    long_runs = iter(runs[long_rows].tolist())
    long_at = iter([*long_rows.tolist(), len(runs)])
    i = done = 0
    next_long = next(long_at)
    while i < len(runs):
        if i == next_long:
            _one(next(long_runs), ramp, scratch, (x[done : ends[i]], y[done : ends[i]]))
            j, next_long = i + 1, next(long_at)
        else:
            # As many short runs as fill a piece, up to the next long one.
            j = min(int(np.searchsorted(ends, done + PIECE)) + 1, next_long)
            _many(runs[i:j], ramp, (x[done : ends[j - 1]], y[done : ends[j - 1]]))
        i, done = j, int(ends[j - 1])


def _runs_of(blocks: NDArray[np.void], moves: Motion, table: LineTable) -> NDArray[np.void]:
    """Return the runs of blocks in the order of the path, from the start of the first block."""
    steps = moves.steps
    is_arc = blocks["kind"] == Kind.ARC
    lines, arcs = np.flatnonzero((steps > 0) & ~is_arc), np.flatnonzero((steps > 0) & is_arc)
    runs = _line_runs(blocks, lines, moves, table)
    if len(arcs):
        runs = np.concatenate([runs, _arc_runs(blocks, arcs, moves)])
        runs = runs[np.argsort(runs["block"], kind="stable")]
    return runs


def places(
    blocks: NDArray[np.void], moves: Motion, x: Floats, y: Floats, table: LineTable
) -> tuple[Floats, Floats]:
    """Return where the machine stands after every step of blocks that stand anywhere, float64.

    Args:
        blocks: dtype ``BLOCK``, any choice of those of a program.
        moves: of ``run``, for these blocks.
        x: where each block starts, um.
        y: likewise.
        table: of the lines.

    Returns:
        x and y after each step, one block after the other; whole um.
    """
    runs = _runs_of(blocks, moves, table)
    runs["x0"] += x[runs["block"]]
    runs["y0"] += y[runs["block"]]
    total = int(runs["length"].sum())
    out_x, out_y = np.empty(total), np.empty(total)
    _fill(runs, out_x, out_y)
    return out_x, out_y


def trace(
    blocks: NDArray[np.void], table: LineTable = LineTable.MIRROR
) -> tuple[NDArray[np.int64], Ints]:
    """Return every position of the path, and the index at which each block starts.

    Args:
        blocks: dtype ``BLOCK``; control blocks and invalid ones (`run` says -1) make no step.
        table: of the lines.

    Returns:
        positions: int64, shape (steps + 1, 2), um from the start of the first block, which is row
            0; row ``first[i] + n`` is where block i stands after n of its steps.
        first: int64, shape (blocks,).

    >>> from wedmcam.ir.program import BLOCK, Axis
    >>> b = np.zeros(1, BLOCK)
    >>> b["x"], b["y"], b["axis"], b["count"] = 2, 1, Axis.X, 2
    >>> trace(b)[0].tolist()
    [[0, 0], [1, 0], [1, 1], [2, 1]]
    """
    moves = run(blocks, table)
    steps = np.maximum(moves.steps, 0)
    first = np.cumsum(steps) - steps
    out = np.empty((int(steps.sum()) + 1, 2), np.int64)
    out[0] = 0
    runs = _runs_of(blocks, moves, table)
    runs["x0"] += (np.cumsum(moves.dx) - moves.dx)[runs["block"]]
    runs["y0"] += (np.cumsum(moves.dy) - moves.dy)[runs["block"]]
    _fill(runs, out[1:, 0], out[1:, 1])
    return out, first

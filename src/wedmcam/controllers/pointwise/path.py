"""Every position of a program, for the judge, pictures and the simulated machine.

Still without stepping: positions come from the closed forms over a ramp of step numbers, one run a
line and one run a quadrant of an arc.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise.circle import Bools, Floats, Ints, apex, frame, quadrant
from wedmcam.controllers.pointwise.closed import EXACT, line_frame, run
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.controllers.stepping import Motion
from wedmcam.ir.program import Kind

#: Steps computed at a time: few enough for the cache, so many that the calls do not count.
PIECE = 65536

#: Runs from this length on are computed each on its own, with scalar constants; the calls cost some
#: 8 us a piece. Shorter ones go together, at about 5 ns a step for repeating the constants.
LONG = 1500


class _Runs(NamedTuple):
    """Steps under one formula, one entry a run; sorted by ``block`` they are the path.

    After step i = 1, 2, ... of a run the machine has made T steps along x, up to a constant, and
    stands at (x0 + sx T, y0 + sy (i - T)), um from the start of the path. With e = i - shift:

    - line: T = floor((e c + b) / d);
    - arc: T = sign floor((sqrt(c - e^2) + sign e) / 2), where c = 2 R^2 - 1.

    ``sx``, ``sy`` and ``sign`` are +1 or -1; a line on the x axis has T = i, one on the y axis 0.
    """

    block: Ints
    length: Ints
    is_arc: Bools
    shift: Floats
    c: Floats
    b: Floats
    d: Floats
    sign: Floats
    x0: Floats
    sx: Floats
    y0: Floats
    sy: Floats

    def take(self, rows: Ints | slice) -> _Runs:
        """Return some of the runs."""
        columns: Any = (column[rows] for column in self)
        return _Runs(*columns)


def _line_runs(blocks: NDArray[np.void], rows: Ints, moves: Motion, table: LineTable) -> _Runs:
    """Return one run for each of the lines ``rows``; x0, y0 from the start of the line."""
    x, y = blocks["x"][rows], blocks["y"][rows]
    p, q, p_is_x = line_frame(x, y, table)
    # A line with a length on q alone steps there at every step: let that be p.
    p_is_x = p_is_x ^ (p == 0)
    # With n - 1 = e, q takes ceil(e q / (p + q)) of the first n steps and p the others, that is
    # floor(e p / (p + q)) + 1.
    d = (p + q).astype(np.float64)
    one = np.ones(len(rows))
    return _Runs(
        block=rows,
        length=moves.steps[rows],
        is_arc=np.zeros(len(rows), bool),
        shift=one,
        c=np.abs(x).astype(np.float64),
        b=np.where(p_is_x, d, d - 1.0),
        d=d,
        sign=one,
        x0=np.zeros(len(rows)),
        sx=np.where(x < 0, -1.0, 1.0),
        y0=np.zeros(len(rows)),
        sy=np.where(y < 0, -1.0, 1.0),
    )


def _arc_runs(blocks: NDArray[np.void], rows: Ints, moves: Motion) -> _Runs:
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
    a, turn = a[arc], turn[arc]
    m0 = np.where(nth == 0, begin[arc], 0.0)
    m1 = np.where(nth == last[arc], end[arc] - 2.0 * a * nth, 2.0 * a)
    shift = a + 1.0 - m0
    # (x, y) from the centre: even quadrants (s u, t s v), odd ones (-s v, t s u), where
    # u = floor((root - e) / 2) shrinks and v = u + e + 1 = floor((root + e) / 2) + 1 grows.
    q = (quadrant(f)[arc].astype(np.int64) + nth) & 3
    odd, s = (q & 1).astype(bool), np.where(q >= 2, -1.0, 1.0)
    return _Runs(
        block=rows[arc],
        length=(m1 - m0).astype(np.int64),
        is_arc=np.ones(len(arc), bool),
        shift=shift,
        c=2.0 * r2[arc] - 1.0,
        b=np.zeros(len(arc)),
        d=np.ones(len(arc)),
        sign=np.where(odd, 1.0, -1.0),
        x0=np.where(odd, -s, 0.0) - x[arc],
        sx=-s,
        y0=turn * s * np.where(odd, shift, 1.0 - shift) - y[arc],
        sy=turn * np.where(odd, -s, s),
    )


Columns = tuple[NDArray[Any], NDArray[Any]]


def _many(runs: _Runs, ramp: Floats, out: Columns) -> None:
    """Fill x and y with the steps of short runs, side by side; ``ramp`` is 1, 2, ...

    What goes into the floor is w = r ramp + g. For arcs that is sign e / 2, exactly, and half the
    root comes on top. For lines half a step in d keeps w 1 / (2 d) >= 2^-32 from whole numbers, and
    with ramp < 2^17 and r <= 1 it is less than 2^-34 wrong.
    """
    length, is_arc = runs.length, runs.is_arc
    before = (np.cumsum(length) - length).astype(np.float64)
    shift = before + runs.shift
    r = np.where(is_arc, 0.5 * runs.sign, runs.c / runs.d)
    g = np.where(is_arc, -r * shift, (runs.b + 0.5 - shift * runs.c) / runs.d)
    arcs, lines = bool(is_arc.any()), not is_arc.all()

    def spread(values: Floats) -> Floats:
        return np.repeat(values, length)

    w = spread(r)
    i = ramp[: len(w)]
    w *= i
    w += spread(g)
    if arcs:
        # Of lines any root will do (their w is at most their length): it counts nothing.
        root = spread(np.where(is_arc, 0.25 * runs.c, LONG * LONG) if lines else 0.25 * runs.c)
        root -= w * w
        np.sqrt(root, out=root)
        if lines:
            root *= spread(is_arc.astype(np.float64))
        w += root
    np.floor(w, out=w)
    if arcs:
        w *= spread(runs.sign)
    x = spread(runs.sx)
    x *= w
    x += spread(runs.x0)
    out[0][:] = x
    np.subtract(i, w, out=w)
    w *= spread(runs.sy)
    w += spread(runs.y0 - runs.sy * before)
    out[1][:] = w


def _put(value: Floats, sign: float, zero: float, target: NDArray[Any]) -> None:
    """Fill the target with zero + value, or zero - value at sign -1; uses value up."""
    result = target if target.dtype == np.float64 else value
    if sign < 0:
        np.subtract(zero, value, out=result)
    else:
        np.add(value, zero, out=result)
    if result is value:
        target[:] = value


def _one(one: tuple[Any, ...], ramp: Floats, half: Floats, scratch: Floats, out: Columns) -> None:
    """Fill x and y with the steps of one long run, piece by piece.

    ``ramp`` is 1, 2, ..., and ``half`` half of it.
    """
    _, length, is_arc, shift, c, b, d, sign, x0, sx, y0, sy = one
    for first in range(0, length, PIECE):
        n = min(PIECE, length - first)
        e, w = scratch[:, :n]
        if is_arc:
            np.add(half[:n], 0.5 * (first - shift), out=e)  # e / 2
            np.multiply(e, e, out=w)
            np.subtract(0.25 * c, w, out=w)
            np.sqrt(w, out=w)
            (np.add if sign > 0 else np.subtract)(w, e, out=w)
            np.floor(w, out=w)
        else:
            np.add(ramp[:n], first - shift, out=e)
            if (length - shift) * c + d < EXACT:
                np.multiply(e, c, out=w)
                w += b
                w /= d
                np.floor(w, out=w)
            else:  # millions of steps along a ratio of large numbers
                w[:] = (e.astype(np.int64) * int(c) + int(b)) // int(d)
        # T = sign w, and i - T = first + ramp - T.
        (np.subtract if sign > 0 else np.add)(ramp[:n], w, out=e)
        _put(w, sx * sign, x0, out[0][first : first + n])
        _put(e, sy, y0 + sy * first, out[1][first : first + n])


def _fill(runs: _Runs, x: NDArray[Any], y: NDArray[Any]) -> None:
    """Fill x and y, int64 or float64, with the places after every step of the runs."""
    total = len(runs.length)
    ends = np.cumsum(runs.length)
    most = min(PIECE + LONG, int(ends[-1])) if total else 0
    ramp = np.arange(1.0, most + 1.0)
    half = 0.5 * ramp[:PIECE]
    scratch = np.empty((2, min(PIECE, most)))
    # A line counts as long as up to its last step (a whole one has shift 1): of a piece at the end
    # of a long line w is not that of a short run.
    up_to = np.where(runs.is_arc, runs.length, runs.length - runs.shift + 1.0)
    long_rows = np.flatnonzero(up_to >= LONG)
    long_runs = zip(*(column.tolist() for column in runs.take(long_rows)), strict=True)
    long_at = iter([*long_rows.tolist(), total])
    i = done = 0
    next_long = next(long_at)
    while i < total:
        if i == next_long:
            _one(next(long_runs), ramp, half, scratch, (x[done : ends[i]], y[done : ends[i]]))
            j, next_long = i + 1, next(long_at)
        else:
            # As many short runs as fill a piece, up to the next long one.
            j = min(int(np.searchsorted(ends, done + PIECE)) + 1, next_long)
            _many(runs.take(slice(i, j)), ramp, (x[done : ends[j - 1]], y[done : ends[j - 1]]))
        i, done = j, int(ends[j - 1])


def _runs_of(blocks: NDArray[np.void], moves: Motion, table: LineTable) -> _Runs:
    """Return the runs of blocks in the order of the path, from the start of the first block."""
    steps = moves.steps
    is_arc = blocks["kind"] == Kind.ARC
    lines, arcs = np.flatnonzero((steps > 0) & ~is_arc), np.flatnonzero((steps > 0) & is_arc)
    runs = _line_runs(blocks, lines, moves, table)
    if len(arcs):
        both = zip(runs, _arc_runs(blocks, arcs, moves), strict=True)
        runs = _Runs(*(np.concatenate(columns) for columns in both))
        runs = runs.take(np.argsort(runs.block, kind="stable"))
    return runs


def _within(runs: _Runs, first: int, last: int) -> _Runs:
    """Return the part of runs, one after the other, that makes the steps first to last - 1."""
    ends = np.cumsum(runs.length)
    begins = ends - runs.length
    cut = np.clip(first - begins, 0, runs.length)
    length = np.clip(last - begins, 0, runs.length) - cut
    # Behind m steps of a run i - shift is what it was with shift - m, and i - T misses m.
    part = runs._replace(length=length, shift=runs.shift - cut, y0=runs.y0 + runs.sy * cut)
    return part.take(np.flatnonzero(length > 0))


def places(
    blocks: NDArray[np.void],
    moves: Motion,
    x: Floats,
    y: Floats,
    table: LineTable,
    window: tuple[int, int] | None = None,
) -> tuple[Floats, Floats]:
    """Return where the machine stands after every step of blocks that stand anywhere, float64.

    Args:
        blocks: dtype ``BLOCK``, any choice of those of a program.
        moves: of ``run``, for these blocks.
        x: where each block starts, um.
        y: likewise.
        table: of the lines.
        window: only the places from the first of these numbers up to before the second, counted
            from 0; None for all. What lies outside costs nothing.

    Returns:
        x and y after each step, one block after the other; whole um.
    """
    runs = _runs_of(blocks, moves, table)
    runs.x0[:] += x[runs.block]
    runs.y0[:] += y[runs.block]
    if window is not None:
        runs = _within(runs, *window)
    total = int(runs.length.sum())
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
    runs.x0[:] += (np.cumsum(moves.dx) - moves.dx)[runs.block]
    runs.y0[:] += (np.cumsum(moves.dy) - moves.dy)[runs.block]
    _fill(runs, out[1:, 0], out[1:, 1])
    return out, first

"""Where the blocks of a program lie, and which block of one program is which of another.

Lowering knows what each block was drawn by; a file that was decoded again knows places. Mostly it
holds the very blocks that were lowered; of a controller that makes its own (compensation) they are
found by where they lie.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import measure
from wedmcam.geom import segments as seg
from wedmcam.ir.program import Kind, Program, in_um
from wedmcam.machines import Machine

Ints = NDArray[np.int64]

#: Nearer than this two blocks are as good, and the one in its turn is taken, um: leads go back the
#: way they came, and an overcut repeats the start.
AS_NEAR_UM = 5.0
#: How many blocks before and after its turn a block is looked for among.
WINDOW = 64


def block_ends(program: Program, machine: Machine) -> tuple[Ints, Ints]:
    """Return where each block starts and ends, shape (blocks, 2), um, drawing coordinates."""
    motion = machine.stepping.run(program.blocks)
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)]) + np.array(program.origin)
    starts = ends - np.column_stack([motion.dx, motion.dy])
    return in_um(starts, program.step_um), in_um(ends, program.step_um)


def match_blocks(lowered: Program, program: Program, machine: Machine) -> Ints:
    """Return the lowered block of each block of the file; -1 for control records."""
    low = np.flatnonzero(lowered.blocks["kind"] <= Kind.MOVE)
    here = np.flatnonzero(program.blocks["kind"] <= Kind.MOVE)
    out = np.full(len(program.blocks), -1, np.int64)
    one, two = lowered.blocks[low], program.blocks[here]
    same = len(one) == len(two) and all(
        (one[f] == two[f]).all() for f in ("kind", "turn", "x", "y", "count")
    )
    out[here] = (
        low
        if same
        else low[_nearest(_rows_of(lowered, machine, low), _rows_of(program, machine, here))]
    )
    return out


def _rows_of(program: Program, machine: Machine, rows: Ints) -> seg.Segments:
    """Return the stepped blocks as segments, drawing um."""
    starts, ends = (p[rows].astype(float) for p in block_ends(program, machine))
    b = program.blocks[rows]
    turn = b["turn"].astype(np.int8)
    cx = starts[:, 0] - b["x"] * program.step_um
    cy = starts[:, 1] - b["y"] * program.step_um
    return seg.make(
        *(starts[:, 0].copy(), starts[:, 1].copy(), ends[:, 0].copy(), ends[:, 1].copy()),
        *(np.where(turn != 0, cx, 0.0), np.where(turn != 0, cy, 0.0), turn),
    )


def _nearest(low: seg.Segments, here: seg.Segments) -> Ints:
    """Return, for each segment of ``here``, the one of ``low`` that runs where its middle is."""
    x, y = measure.middles(here)
    # In its turn: the same share of the whole way, which differs by little.
    begin = np.cumsum(low.length) - low.length
    middle = np.cumsum(here.length) - here.length / 2
    middle *= low.length.sum() / max(float(here.length.sum()), 1.0)
    turn = np.clip(np.searchsorted(begin, middle, "right") - 1, 0, len(low) - 1)
    tried = np.clip(turn[:, None] + np.arange(-WINDOW, WINDOW + 1), 0, len(low) - 1)
    flat = tried.ravel()
    times = tried.shape[1]
    off = seg.distances(low.take(flat), np.repeat(x, times), np.repeat(y, times))
    away = np.abs(begin[flat] + low.length[flat] / 2 - np.repeat(middle, times))
    rank = np.floor(off / AS_NEAR_UM) * 1e9 + away
    best = np.argmin(rank.reshape(tried.shape), axis=1)
    chosen: Ints = tried[np.arange(len(x)), best]
    return chosen


def minutes(path_mm: float, feed_um: float) -> float:
    """Return the cutting time of a path at ``feed_um`` a minute, without moves and threading.

    >>> minutes(120.0, 2500.0)
    48.0
    """
    return round(1000.0 * path_mm / feed_um, 2)


def with_time(summary: dict[str, Any], feed_um: float | None) -> dict[str, Any]:
    """Return a summary with its path's cutting time in minutes, where a feed is given."""
    path = summary.get("path_mm")
    if feed_um is None or path is None:
        return summary
    return {**summary, "feed_mm_per_min": feed_um / 1000, "minutes": minutes(path, feed_um)}

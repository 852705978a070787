"""Whether two programs make the same machine do the same: what a forgery must not."""

from __future__ import annotations

import hashlib

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.walk import walk


def same_steps(a: Program, b: Program, stepping: Stepping = MIRROR) -> bool:
    """Return whether two programs make the same machine do the same.

    The same steps in the same order with the generator on or off, and the control records at the
    same places; how the steps are parted into blocks, and the origin, do not matter. Words that
    the machine does not know and the thread marks of the compact format count as records.

    >>> from wedmcam.ir.program import BLOCK, Axis
    >>> one, two = np.zeros(1, BLOCK), np.zeros(2, BLOCK)
    >>> one["x"], one["count"], one["axis"] = 10, 10, Axis.X
    >>> two["x"], two["count"], two["axis"] = [4, 6], [4, 6], Axis.X
    >>> same_steps(Program(one), Program(two))
    True
    """
    return _digest(a, stepping) == _digest(b, stepping)


def _digest(program: Program, stepping: Stepping) -> list[tuple[int, int, bytes]]:
    """Return runs of one kind: (kind, steps, hash of the steps)."""
    w = walk(program, stepping)
    kind = w.blocks["kind"].astype(np.int64)
    kind[w.cutting] = Kind.LINE
    runs: list[tuple[int, int, bytes]] = []
    state = hashlib.sha256()
    steps = 0
    moving = (kind == Kind.LINE) | (kind == Kind.MOVE)
    edges = np.flatnonzero(np.diff(kind) != 0) + 1
    for low, high in zip([0, *edges.tolist()], [*edges.tolist(), len(kind)], strict=True):
        if low == high:
            continue
        if not moving[low]:
            runs.extend((int(kind[low]), 0, b"") for _ in range(high - low))
            continue
        state, steps, i = hashlib.sha256(), 0, low
        while i < high:
            total = np.cumsum(np.maximum(w.steps[i:high], 0))
            j = i + max(1, int(np.searchsorted(total, 1 << 20)))
            at, _ = stepping.trace(w.blocks[i:j])
            state.update(np.diff(at, axis=0).astype(np.int8).tobytes())
            steps += len(at) - 1
            i = j
        runs.append((int(kind[low]), steps, state.digest()))
    return [r for r in runs if r[1] or r[0] not in (Kind.LINE, Kind.MOVE)]

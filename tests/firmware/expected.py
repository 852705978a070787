"""What `controllers.pointwise` says of every step: axis, sign, F, J left, number of the block."""

from typing import NamedTuple

import numpy as np

from wedmcam.controllers.pointwise import MIRROR, block_steps
from wedmcam.frontends.zd065.compact import decode
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin


class Steps(NamedTuple):
    """One entry a step; ``number`` is that of the block, from 1."""

    dx: np.ndarray
    dy: np.ndarray
    f: np.ndarray
    j: np.ndarray
    number: np.ndarray
    is_arc: np.ndarray


def blocks_of(data):
    """Return the blocks of data without an error, as dtype BLOCK."""
    program, findings = decode(data, builtin("zd065"), "x.zd")
    assert not [d for d in findings if d.severity.name == "ERROR"], findings
    return program.blocks


def stepped(block, number=1):
    """Return the steps of one block by the loop as the paper prints it."""
    rows = [(s.x, s.y, s.f) for s in block_steps(block)]
    x, y, f = np.array(rows, np.int64).reshape(-1, 3).T
    return _steps(block, number, (np.append(0, x), np.append(0, y)), f, block["count"])


def closed(block, number=1, first=0, last=None):
    """Return steps of one block, by the closed forms of the path: all, the first, or the last.

    ``first`` is how many are left out before them; ``last`` how many are made behind them.
    """
    assert first == 0 or last is None
    x, y = walked(block, first, last)
    before = block["count"] if first == 0 else counting(block, x, y).sum()
    return _steps(block, number, (x, y), deviation(block, x, y)[1:], before)


def walked(block, first=0, last=None):
    """Return where a block stands after ``first`` steps and after each one up to ``last``."""
    one, zero = np.array([block]), np.zeros(1)
    moves = MIRROR.run(one)
    window = (first, int(moves.steps[0]) if last is None else last)
    start = MIRROR.position(one, np.array([first]))
    ends = MIRROR.places(one, moves, zero, zero, window)
    x, y = (np.append(s, e.astype(np.int64)) for s, e in zip(start, ends, strict=True))
    return x, y


def deviation(block, x, y):
    """Return F of a block at places (x, y) from its start: it follows from the place alone."""
    bx, by = int(block["x"]), int(block["y"])
    if block["kind"] == Kind.ARC:
        return (bx + x) ** 2 + (by + y) ** 2 - (bx**2 + by**2)
    return np.abs(y) * abs(bx) - np.abs(x) * abs(by)


def counting(block, x, y):
    """Return which steps of a walk through places (x, y) count in J: 1, others 0."""
    if block["kind"] == Kind.ARC:  # the sides of the inscribed square, y at a tie
        on_x = np.abs(block["x"] + x[:-1]) < np.abs(block["y"] + y[:-1])
    else:
        on_x = np.full(len(x) - 1, abs(block["x"]) > abs(block["y"]))
    return np.where(on_x, np.diff(x) != 0, np.diff(y) != 0).astype(np.int64)


def _steps(block, number, walk, f, before):
    """Return the record of a walk, places and F, on which ``before`` are left to count."""
    x, y = walk
    left = before - np.cumsum(counting(block, x, y))
    same = np.full(len(f), number)
    is_arc = np.full(len(f), block["kind"] == Kind.ARC)
    return Steps(np.diff(x), np.diff(y), f, left, same, is_arc)


def program(blocks, of_block=closed):
    """Return the steps of all blocks; controls make none."""
    moving = [i for i, b in enumerate(blocks) if b["kind"] in (Kind.ARC, Kind.LINE, Kind.MOVE)]
    parts = [of_block(blocks[i], i + 1) for i in moving]
    return Steps(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def assert_same(record, steps):
    """Assert that the machine made these steps, and showed F, J and number at each."""
    assert len(record.dx) == len(steps.dx)
    f = np.where(steps.is_arc, record.f, record.f3)
    shown = (record.dx, record.dy, f, record.j, record.number)
    for name, got, wanted in zip(Steps._fields, shown, steps, strict=False):
        wrong = np.flatnonzero(got != wanted)
        assert not len(wrong), f"{name} at step {wrong[0]}: {got[wrong[0]]}, not {wanted[wrong[0]]}"

"""Moves between two cuts, and what helps where one does not fit a block.

A move is one block of 3B and of what is like it: two in a row would be cut. Contours may be cut in
any order but for one rule, so whether another order can help is a question of reach: a contour
comes after all that it encloses, and leads from none of those to another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, error
from wedmcam.geom import measure
from wedmcam.geom.quantize import to_grid
from wedmcam.ir.plan import Cut, Plan

if TYPE_CHECKING:
    from wedmcam.transforms.lower import Rules


def end_of(cut: Cut) -> tuple[int, int]:
    """Return where the wire is after a cut, whole steps."""
    if cut.path.closed:
        return cut.thread
    v = cut.path.vertices
    x, y = to_grid([v["x"][-1], v["y"][-1]]).tolist()
    return x, y


def too_long(plan: Plan, index: int, rules: Rules) -> list[Diagnostic]:
    """Return an error where the move to cut ``index`` is longer than one block."""
    cut, most, per = plan.cuts[index], rules.move_um, rules.per_mm
    here = end_of(plan.cuts[index - 1])
    if most is None or max(abs(a - b) for a, b in zip(cut.thread, here, strict=True)) <= most:
        return []
    return [
        error(
            "move-too-long",
            "the move from {here:xy} to the thread point {thread} is longer than one "
            "block of {most_mm:.3f} mm",
            cut.path.source_of(0),
            hint="another --order may help; --to iso --profile iso-mm moves with G00, of any length"
            if order_may_help(plan, most)
            else "no --order helps: some contours are farther than a block from all "
            "that may be cut before and after them; --to iso --profile iso-mm moves "
            "with G00, of any length, or a program for each group (--cuts)",
            here=rules.place(*here),
            thread=rules.place(*cut.thread),
            most_mm=most / per,
        )
    ]


def order_may_help(plan: Plan, most: int) -> bool:
    """Return whether an order may have no move that is longer than ``most`` steps on an axis."""
    starts = np.array([cut.thread for cut in plan.cuts], float).reshape(-1, 2)
    ends = np.array([end_of(cut) for cut in plan.cuts], float).reshape(-1, 2)
    reach = np.abs(ends[:, None, :] - starts[None, :, :]).max(axis=2) <= most
    reach |= reach.T
    return _connected(reach, plan)


def _connected(reach: NDArray[np.bool_], plan: Plan) -> bool:
    """Return whether an order may lead from each contour to all others.

    Not through a contour to what it encloses.
    """
    boxes = measure.extents_of_all([(cut.path.vertices, cut.path.closed) for cut in plan.cuts])
    low = np.asarray((boxes[:, None, :2] <= boxes[None, :, :2]).all(axis=2))
    high = np.asarray((boxes[:, None, 2:] >= boxes[None, :, 2:]).all(axis=2))
    encloses: NDArray[np.bool_] = np.logical_and(low, high)
    np.fill_diagonal(encloses, False)
    closed = np.array([cut.path.closed for cut in plan.cuts])
    encloses &= closed[:, None]
    if len(set(_parts(reach, np.ones(len(reach), bool)).tolist())) > 1:
        return False
    for inner in encloses:
        if inner.sum() > 1:
            through: NDArray[np.bool_] = np.logical_not(encloses[:, inner].any(axis=1))
            parts = _parts(reach, through)
            if len(set(parts[inner].tolist())) > 1:
                return False
    return True


def _parts(reach: NDArray[np.bool_], through: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return for each cut a number that it shares with all that are in reach over ``through``."""
    part = np.where(through, np.arange(len(reach)), -1)
    near = reach & through[:, None] & through[None, :]
    np.fill_diagonal(near, through)
    while True:
        least = np.where(near, part[None, :], len(reach)).min(axis=1)
        new = np.where(through, np.minimum(part, least), -1)
        if (new == part).all():
            return part
        part = new

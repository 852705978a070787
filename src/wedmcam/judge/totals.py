"""What a program does by itself, without a drawing: counts, lengths, closure, limits with margin.

Everything comes from closed forms, a piece of the program at a time: a million blocks take a
second and little memory.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic
from wedmcam.ir.program import Kind, Program, in_um
from wedmcam.judge.checks import Limits, check_blocks
from wedmcam.judge.segments import Ints
from wedmcam.judge.walk import Walk, walk

#: Blocks at a time.
PIECE = 1 << 17

#: A cut that ends so near to where it began was meant to be closed, um (ours).
MEANT_CLOSED = 100.0


def figures(
    program: Program, stepping: Stepping, limits: Limits
) -> tuple[dict[str, Any], list[Diagnostic]]:
    """Return the figures of a program as plain data, and findings for blocks that cannot run.

    ``contours`` are stretches of cutting between moves; ``closure_um`` is the largest distance
    between the ends of those that end within 0.1 mm of their start (leads cannot be told from
    contours here), None when none does. ``reversals`` counts, for each axis, steps against the
    last one: where backlash is taken up. Lengths are true um, also where a step is not.
    """
    way = walk(program, stepping)
    findings = check_blocks(program, limits, way.steps)
    blocks = program.blocks
    kind = blocks["kind"]
    cutting = way.cutting
    path, box = 0.0, np.array([np.inf, np.inf, -np.inf, -np.inf])
    back_x, back_y = stepping.reversals(blocks)
    for low in range(0, len(blocks), PIECE):
        part = _part(way, low, low + PIECE)
        path += float(part.lengths()[part.cutting].sum())
        e = part.stepping.extents(part.blocks, part.steps, part.start, part.end)
        box = np.concatenate([np.minimum(box[:2], e[:2]), np.maximum(box[2:], e[2:])])
    step = program.step_um
    end = way.end[-1] - np.array(program.origin) if len(blocks) else np.zeros(2, np.int64)
    box = np.array([int(v) for v in box]) if len(blocks) else np.zeros(4, np.int64)
    counted = np.where(kind <= Kind.MOVE, blocks["count"], 0)
    size = np.maximum(np.abs(blocks["x"]), np.abs(blocks["y"]))
    arc = kind == Kind.ARC
    return {
        "contours": len(_cuts(way)),
        "blocks": int(cutting.sum()),
        "steps": int(np.maximum(way.steps[cutting], 0).sum()),
        "closure_um": _closure(way, step),
        "end_um": in_um(end, step).tolist(),
        "extents_um": in_um(box, step).tolist(),
        "moves": int((kind == Kind.MOVE).sum()),
        "controls": int((kind >= Kind.PAUSE).sum()),
        "path_mm": round(path * step / 1000.0, 3),
        "reversals": {"x": int(back_x.sum()), "y": int(back_y.sum())},
        "limits": {
            "count_um": _limit(counted, limits.count_um, step),
            "line_um": _limit(np.where((kind <= Kind.MOVE) & ~arc, size, 0), limits.line_um, step),
            "arc_um": _limit(np.where(arc, size, 0), limits.arc_um, step),
        },
    }, findings


def _part(way: Walk, low: int, high: int) -> Walk:
    rows = slice(low, high)
    return way._replace(
        blocks=way.blocks[rows],
        start=way.start[rows],
        end=way.end[rows],
        steps=way.steps[rows],
        sweep=way.sweep[rows],
    )


def _cuts(way: Walk) -> list[Ints]:
    """Return the cutting blocks between moves."""
    rows = np.flatnonzero(way.cutting & (way.steps > 0))
    if not len(rows):
        return []
    moved = np.cumsum(way.blocks["kind"] == Kind.MOVE)[rows]
    return np.split(rows, np.flatnonzero(np.diff(moved)) + 1)


def _closure(way: Walk, step_um: float) -> float | None:
    closures_um = []
    for rows in _cuts(way):
        dx, dy = way.end[rows[-1]] - way.start[rows[0]]
        closures_um.append(float(np.hypot(dx, dy)) * step_um)
    closed = [f for f in closures_um if f <= MEANT_CLOSED]
    return max(closed) if closed else None


def _limit(values: Ints, most: int, step_um: float) -> dict[str, float]:
    """Return the largest value, the limit and what is left of it, and the block that has it."""
    row = int(np.argmax(values)) if len(values) and values.any() else -1
    largest = int(values[row]) if row >= 0 else 0
    lengths = in_um(np.array([largest, most, most - largest]), step_um).tolist()
    return dict(zip(("largest", "limit", "margin"), lengths, strict=True)) | {"block": row + 1}

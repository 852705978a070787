"""Where a program starts in the drawing, when it is not stated: a whole-um translation is fitted.

A program states only increments. Its contours have the planned contours' sizes and places relative
to each other, so the boxes give the translation to a micron or two, and the least sum of squared
distances from the planned wire paths gives the micron. No rotation is tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic, error, note
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.judge.in_steps import in_steps
from wedmcam.judge.match import lies_on, path_box
from wedmcam.judge.pieces import Piece, pieces
from wedmcam.judge.route import of_contours
from wedmcam.judge.segments import Floats, nearest
from wedmcam.judge.stretches import per_mm, place
from wedmcam.judge.track import LOST
from wedmcam.judge.walk import Walk, walk

#: Places of the program that are compared with the plan.
SAMPLES = 2000

#: So many contours of a program are looked at to tell where it may start.
SOME = 20


def fit(
    program: Program, plan: Plan, *, stepping: Stepping
) -> tuple[Program | None, list[Diagnostic]]:
    """Return the program with the origin at which it lies on the plan.

    Its own origin is forgotten; the new one is a whole number of steps. Where several places fit
    as well (contours that are alike), one at which the program starts at the plan's first thread
    point wins, then the least squares, then the lowest and leftmost.

    Returns:
        The program with a new origin, and a note that tells it; None and an error where no place
        lets any contour lie on a planned one.
    """
    per = per_mm(program)
    plan = in_steps(plan, program.step_um)
    way = walk(replace(program, origin=(0, 0)), stepping)
    held = pieces(way)
    boxes = [path_box(c) for c in plan.cuts]
    if not held or not boxes:
        return None, [error("no-fit", "there is nothing to fit: no contour is cut")]
    candidates = _candidates(held, boxes)
    first = plan.cuts[0].thread
    if way.cutting.any():
        start = way.start[int(held[0].index[0])]
        candidates.append((first[0] - int(start[0]), first[1] - int(start[1])))
    scored = sorted({(-_hits(held, boxes, c), c != candidates[-1], c[1], c[0]) for c in candidates})
    best = scored[0]
    if not best[0]:
        return None, [
            error(
                "no-fit",
                "the program's contours measure {sizes} mm, the planned wire paths {planned} mm",
                hint="check the offset, the units and the transforms, or state --origin",
                sizes=_sizes([p.box for p in held], per),
                planned=_sizes(boxes, per),
            )
        ]
    top = [s for s in scored if s[:2] == best[:2]][:8]
    results = []
    for _, _, y, x in top:
        results.append(_refine(way, held, plan, boxes, (x, y)))
    squares, (ox, oy) = min(results, key=lambda r: (round(r[0], 6), r[1][1], r[1][0]))
    return replace(program, origin=(ox, oy)), [
        note(
            "origin-fitted",
            "the program was fitted into the drawing: it starts at {start}, its places lie "
            "{off_mm:.4f} mm from the wire path (root mean square)",
            points_mm=(place(ox, oy, per),),
            start=place(ox, oy, per),
            off_mm=np.sqrt(squares) / per,
        )
    ]


def _sizes(boxes: Sequence[Floats], per: float) -> str:
    """Return the widths and heights of the first boxes, mm."""
    return ", ".join(f"{(b[2] - b[0]) / per:.3f} x {(b[3] - b[1]) / per:.3f}" for b in boxes[:5])


def may_start(
    program: Program, plan: Plan, places: Sequence[tuple[int, int]], *, stepping: Stepping
) -> list[tuple[int, int]]:
    """Return those of some places at which most contours have boxes of planned wire paths.

    They are in their order, and in steps.
    """
    way = walk(replace(program, origin=(0, 0)), stepping)
    held = pieces(way)
    boxes = np.array([path_box(c) for c in in_steps(plan, program.step_um).cuts]).reshape(-1, 4)
    if not held or not len(places):
        return []
    every = np.array(places, float).reshape(-1, 2)
    hits = np.zeros(len(every), np.int64)
    for piece in held[:SOME]:
        box = piece.box + np.concatenate([every, every], axis=1)
        fits = np.zeros(len(every), bool)
        for one in boxes:
            fits |= np.abs(box - one).max(axis=1) <= LOST
        hits += fits
    may = (hits == hits.max()) & (hits > 0)
    return [place for place, yes in zip(places, may.tolist(), strict=True) if yes]


def _candidates(held: list[Piece], boxes: list[Floats]) -> list[tuple[int, int]]:
    """Return translations that lay the largest contour on a planned one of its size."""
    out = []
    by_size = sorted(held, key=lambda p: -float((p.box[2:] - p.box[:2]).sum()))
    for piece in by_size[:3]:
        size = piece.box[2:] - piece.box[:2]
        for box in boxes:
            if np.abs((box[2:] - box[:2]) - size).max() <= LOST:
                shift = (box[:2] + box[2:] - piece.box[:2] - piece.box[2:]) / 2.0
                out.append((round(float(shift[0])), round(float(shift[1]))))
    return out


def _hits(held: list[Piece], boxes: list[Floats], shift: tuple[int, int]) -> int:
    """Return how many contours lie on planned ones of their own."""
    free = np.array(boxes)
    hits = 0
    for piece in held:
        if not len(free):
            break
        off = np.abs(free - (piece.box + np.array([*shift, *shift]))).max(axis=1)
        k = int(np.argmin(off))
        if off[k] <= LOST:
            hits += 1
            free = np.delete(free, k, axis=0)
    return hits


def _refine(
    way: Walk, held: list[Piece], plan: Plan, boxes: list[Floats], shift: tuple[int, int]
) -> tuple[float, tuple[int, int]]:
    """Return the mean square distance and the whole-um translation at which it is least."""
    paths, _ = of_contours([c.path for c in plan.cuts])
    xs, ys = [], []
    shifted, every_cut = np.array(boxes) - np.array([*shift, *shift]), np.arange(len(boxes))
    length = way.lengths()
    for piece in held:
        lying, k = lies_on(way, piece, plan.cuts, shifted, every_cut, length)
        if k < 0:
            continue
        x, y, _ = way.points(lying.index[lying.first : lying.last])
        every = max(1, len(x) * len(held) // SAMPLES)
        xs.append(x[::every])
        ys.append(y[::every])
    x, y = np.concatenate(xs), np.concatenate(ys)
    tried: dict[tuple[int, int], float] = {}

    def squares(at: tuple[int, int]) -> float:
        if at not in tried:
            d, _ = nearest(paths, x + at[0], y + at[1], 4.0 * LOST)
            tried[at] = float(np.mean(np.minimum(d, 4.0 * LOST) ** 2))
        return tried[at]

    here = shift
    for _ in range(16):
        around = [(here[0] + i, here[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        best = min(around, key=lambda a: (round(squares(a), 6), a != here, a[1], a[0]))
        if best == here:
            break
        here = best
    return squares(here), here

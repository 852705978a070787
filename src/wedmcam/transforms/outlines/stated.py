"""A plan whose wire runs on the outlines: what a controller is given that makes the path itself.

The ZD-065's compensation format states the outline with its corners, in blocks of the cutting
format. So an outline is lowered like a path: from the thread point straight to the place beside
which the wire's path starts, once round, and back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.diag import Diagnostic
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.outlines.grid import Grid
from wedmcam.transforms.outlines.refusals import refusal
from wedmcam.transforms.outlines.starts import Foot, foot_of, start_beside
from wedmcam.transforms.plan import leads


def start_off_corners(plan: Plan, grid: Grid) -> tuple[Plan | None, list[Diagnostic]]:
    """Return the plan with every closed path starting beside a segment, not beside an arc added.

    Where corners of an outline have their arcs, the path starts beside what was drawn.
    """
    drawn = [replace(c, outline=c.cornered or c.outline) for c in plan.cuts]
    moved, findings = start_beside(replace(plan, cuts=tuple(drawn)), grid)
    if moved is None:
        return None, findings
    cuts = [
        replace(c, outline=as_it_was.outline)
        for c, as_it_was in zip(moved.cuts, plan.cuts, strict=True)
    ]
    return replace(plan, cuts=tuple(cuts)), findings


def on_outlines(
    plan: Plan, shifts: Sequence[tuple[float, float, float]]
) -> tuple[Plan | None, list[Diagnostic]]:
    """Return the plan with each path on its outline, corners and all; errors where none is whole.

    Args:
        plan: whose paths start where `start_off_corners` put them.
        shifts: by how much each outline is moved along x and y, and towards what falls away, um.
    """
    cuts, findings = [], []
    for cut, shift in zip(plan.cuts, shifts, strict=True):
        if not cut.offset_um:
            cuts.append(cut)
            continue
        *by, out = shift
        stated = _on_outline(_grown(cut, out))
        if isinstance(stated, Diagnostic):
            findings.append(stated)
        else:
            cuts.append(replace(stated, path=_moved(stated.path, *by)))
    return (None if findings else replace(plan, cuts=tuple(cuts))), findings


def _grown(cut: Cut, out: float) -> Cut:
    """Return a cut whose outline lies so much nearer to its path, um."""
    outline = cut.cornered or cut.outline
    if not out or outline is None or not outline.closed or cut.keeps_left is None:
        return cut
    grown, findings = compensate([outline], [-out if cut.keeps_left else out], sharp=True)
    if findings or grown.interference or len(grown.paths) != 1:
        return cut
    path = grown.paths[0].path
    nearer = cut.offset_um - out
    return replace(cut, outline=path, cornered=cut.cornered and path, offset_um=nearer)


def _moved(path: Contour, dx: float, dy: float) -> Contour:
    v = path.vertices.copy()
    for name, by in (("x", dx), ("cx", dx), ("y", dy), ("cy", dy)):
        v[name] += by
    return Contour(v, path.closed, path.sources)


def _on_outline(cut: Cut) -> Cut | Diagnostic:
    outline = cut.cornered or cut.outline
    if outline is None or not (outline.closed and cut.path.closed):
        return refusal(cut, "compensation-lost", "--to compact: it states the path").extended(
            "it is open, or its wire path is only a part of its outline: the controller would "
            "offset something else"
        )
    s = seg.of_rows(outline.starts, outline.ends)
    v = cut.path.vertices
    foot = foot_of(s, float(v["x"][0]), float(v["y"][0]), abs(cut.offset_um), True)
    if foot is None:
        return refusal(
            cut,
            "compensation-lead",
            "another thread point (--start), beside a line or an arc of the outline",
        ).extended(
            "the wire path starts at a corner of the outline, and the controller starts beside a "
            "segment"
        )
    path = leads.start_at(outline, s, foot.row, foot.at, 0.0)
    p, q = (seg.of_rows(c.starts, c.ends) for c in (cut.path, path))
    total = float(q.length.sum())
    stop, overcut = cut.stop_um, cut.overcut_um
    if stop:
        at = _beside(cut, p, q, float(p.length.sum()) - stop)
        if at is None:
            return refusal(cut, "compensation-place", "another length of --stop").extended(
                "its pause (--stop) is at a corner of the outline, and the controller has no block "
                "inside the arc there"
            )
        stop = total - at
    if overcut:
        at = _beside(cut, p, q, overcut)
        if at is None:
            return refusal(cut, "compensation-place", "another length of --overcut").extended(
                "its overcut ends at a corner of the outline, and the controller has no block "
                "inside the arc there"
            )
        overcut = at
    return replace(cut, path=path, stop_um=stop, overcut_um=overcut)


def _beside(cut: Cut, path: Segments, outline: Segments, at: float) -> float | None:
    """Return how far along the outline the place is beside which a path is at ``at`` um."""
    ends = np.cumsum(path.length)
    k = min(int(np.searchsorted(ends, at, "right")), len(path) - 1)
    where = np.array([at - ends[k] + path.length[k]])
    x, y = (float(c[0]) for c in seg.points_at(path.take(np.array([k])), where))
    foot: Foot | None = foot_of(outline, x, y, abs(cut.offset_um), False)
    if foot is None:
        return None
    return float(outline.length[: foot.row].sum()) + foot.at

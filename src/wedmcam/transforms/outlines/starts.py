"""Where to start an outline that the controller offsets: beside a segment, on a place of the grid.

A controller puts the wire on the normal of the first block and takes it off on that of the last:
both are one place only inside a segment, or where two are tangent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wedmcam.diag import Diagnostic
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.transforms.outlines.grid import Grid
from wedmcam.transforms.plan import leads
from wedmcam.transforms.plan.leads import Threaded
from wedmcam.transforms.plan.paths import PlannedPath

#: A foot this near to a vertex is the vertex; um.
VERTEX_UM = 0.5
#: A start may lie at a joint that tears by less than this when its segments are offset, um.
TANGENT_START_UM = 0.25
#: How far the start of a path may be from the offset of its outline; um.
BESIDE_UM = 0.05
#: An outline starts at least this far from a corner, or in the middle of what is shorter; um.
FROM_CORNER_UM = 300.0
#: A start may move so far along its segment to a place that is nearly on the grid, um.
SLIDE_UM = 60
#: A start is near enough to the grid when its segment passes it by this, um.
ON_GRID_UM = 0.02
#: A circle is written so much too far from the part, in steps of the grid: its centre may be off on
#: all sides, and 2.0 um are allowed beside the part, 1.6 in it.
CIRCLE_UM = 0.2


def start_beside(plan: Plan, grid: Grid) -> tuple[Plan | None, list[Diagnostic]]:
    """Return the plan with every closed path starting beside a segment, not round a corner.

    A controller puts the wire on the normal of the first block, and takes it off on that of the
    last: both are one place only inside a segment, or where two are tangent. They are one micron
    only where the segment passes a place of the grid, so the start moves along to such a place.
    """
    moved = [_restart(cut, grid) for cut in plan.cuts]
    if all(a is b for a, b in zip(moved, plan.cuts, strict=True)):
        return plan, []
    paths = [
        PlannedPath(c.path, c.outline or c.path, None, c.offset_um, k) for k, c in enumerate(moved)
    ]
    threaded = [Threaded(c.path, c.thread) for c in moved]
    errors = [
        d.extended(
            hint="such a controller starts beside a corner, not in it: put the thread point (or "
            "'enter') {apart_mm:g} mm from it, or give another one",
            apart_mm=FROM_CORNER_UM / 1000,
        )
        for d in leads.collisions(paths, threaded)
    ]
    return (None if errors else replace(plan, cuts=tuple(moved))), errors


def _restart(cut: Cut, grid: Grid) -> Cut:
    offset = cut.offset_um
    if not offset or cut.outline is None or not cut.path.closed or not cut.outline.closed:
        return cut
    drawn = seg.of_rows(cut.outline.starts, cut.outline.ends)
    v = cut.path.vertices
    s = seg.of_rows(cut.path.starts, cut.path.ends)
    n = len(s)
    foot = foot_of(drawn, float(v["x"][0]), float(v["y"][0]), offset, True)
    if foot is not None:
        return _slide(cut, s, drawn, foot, offset, grid)
    x, y = (np.full(n, float(c)) for c in cut.thread)
    margin = np.minimum(0.5 * s.length, FROM_CORNER_UM)
    at = np.clip(seg.position_of(s, x, y), margin, s.length - margin)
    px, py = seg.points_at(s, at)
    for k in np.lexsort((px, py, np.round(np.hypot(px - x, py - y), 3))).tolist():
        foot = foot_of(drawn, float(px[k]), float(py[k]), offset, True)
        if foot is not None:
            path = leads.start_at(cut.path, s, k, float(at[k]))
            again = seg.of_rows(path.starts, path.ends)
            return _slide(replace(cut, path=path), again, drawn, foot, offset, grid)
    return cut


def _slide(cut: Cut, s: Segments, drawn: Segments, foot: Foot, offset: float, grid: Grid) -> Cut:
    """Return a cut whose outline starts on, or nearly on, a place of the grid, far from corners."""
    one = drawn.take(np.array([foot.row]))
    length = float(one.length[0])
    round_ = len(drawn) == 1 and one.turn[0] != 0
    margin = 0.0 if round_ else min(FROM_CORNER_UM, 0.5 * length)
    base = float(np.clip(foot.at, margin, length - margin))
    away = np.arange(int(min(SLIDE_UM, 0.25 * length) / grid.step_um) + 1) * grid.step_um
    at = base + np.stack([away, -away], axis=1).ravel()
    at = np.mod(at, length) if round_ else at[(at > VERTEX_UM) & (at < length - VERTEX_UM)]
    if not len(at):
        return cut
    many = drawn.take(np.full(len(at), foot.row))
    x, y = seg.points_at(many, at)
    off = seg.distances(many, grid.put(x), grid.put(y))
    # On which side the wire runs is seen at the place beside which the path starts now.
    ox, oy = seg.tangents_at(one, np.array([foot.at]))
    v = cut.path.vertices
    side = np.sign(ox[0] * (v["y"][0] - foot.y) - oy[0] * (v["x"][0] - foot.x))
    if round_:  # of a circle the radius counts, from where its centre comes to lie
        centre = grid.put(np.array([one.cx[0], one.cy[0]]))
        sx, sy = grid.put(x) - centre[0], grid.put(y) - centre[1]
        reach = np.hypot(sx, sy)
        away = -float(one.turn[0]) * side  # a wire to the left of a left turn is inside
        # What counts is how far the wire is from it, on the micron on which the path starts.
        wire = (reach + away * offset) / reach
        gx, gy = to_grid(centre[0] + sx * wire), to_grid(centre[1] + sy * wire)
        wanted = one.radius[0] + away * (offset + CIRCLE_UM * grid.step_um)
        off = np.abs(np.hypot(gx - centre[0], gy - centre[1]) - wanted)
        off += 0.3 * np.maximum(np.abs(reach - one.radius[0]) - 0.3, 0.0)
    good = np.flatnonzero(off <= (0.1 if round_ else ON_GRID_UM))
    best = int(good[0]) if len(good) else int(np.argmin(off))
    if at[best] == foot.at:
        return cut
    tx, ty = (float(c[best]) for c in seg.tangents_at(many, at))
    wx, wy = float(x[best] - side * offset * ty), float(y[best] + side * offset * tx)
    n = len(s)
    px, py = np.full(n, wx), np.full(n, wy)
    there = seg.position_of(s, px, py)
    if n == 1:
        there %= s.length
    ux, uy = seg.tangents_at(s, there)
    fits = (seg.distances(s, px, py) <= BESIDE_UM) & (there > 0) & (there < s.length)
    rows = np.flatnonzero(fits & (ux * tx + uy * ty > 0.9))
    if not len(rows):
        return cut
    return replace(cut, path=leads.start_at(cut.path, s, int(rows[0]), float(there[rows[0]]), 0.0))


@dataclass(frozen=True, slots=True)
class Foot:
    """A place of the outline: row, arc length on it, and the point, um."""

    row: int
    at: float
    x: float
    y: float


def foot_of(s: Segments, x: float, y: float, offset: float, closed: bool) -> Foot | None:
    """Return the place of an outline that a path at (x, y) runs beside; None at a corner."""
    n = len(s)
    px, py = np.full(n, x), np.full(n, y)
    d = seg.distances(s, px, py)
    row = int(np.argmin(d))
    if abs(float(d[row]) - offset) > BESIDE_UM:
        return None
    at = float(np.clip(seg.position_of(s, px, py)[row], 0.0, s.length[row]))
    length = float(s.length[row])
    if n > 1 and min(at, length - at) <= min(VERTEX_UM, 0.25 * length):
        row = row if at <= 0.5 * length else (row + 1) % n
        at = 0.0
        if not closed and row == 0:
            return None
        before = (row - 1) % n
        ax, ay = (float(c[before]) for c in seg.end_tangents(s))
        bx, by = (float(c[row]) for c in seg.start_tangents(s))
        if abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by)) * offset > TANGENT_START_UM:
            return None
    qx, qy = seg.points_at(s.take(np.array([row])), np.array([at]))
    return Foot(row, at, float(qx[0]), float(qy[0]))


def open_at(outline: Contour, s: Segments, foot: Foot) -> Contour:
    """Return a closed outline as an open one that starts and ends at a place of it."""
    v = outline.vertices
    rows = np.roll(v, -foot.row)
    if foot.at > 0 and len(v) > 1:
        rows = np.concatenate([rows, rows[:1]])  # the first segment is parted
    rows = np.concatenate([rows, rows[:1]])
    rows["x"][[0, -1]], rows["y"][[0, -1]] = foot.x, foot.y
    rows["turn"][-1] = 0
    return Contour(rows, False, outline.sources)

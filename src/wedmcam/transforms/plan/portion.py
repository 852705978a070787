"""Part of a plan: some of its cuts, or what is left of it after a broken wire.

A program that does not fit the memory is loaded in parts, and a wire that broke leaves the rest of
a contour to be cut: on from where it broke, or backwards from the thread point, where threading is
easy. Both are plans like any other, lowered and judged like any other; the plan only says that the
rest of the drawing is not asked for.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.plan import Plan
from wedmcam.ir.sketch import ThreadPoint

#: How far a stepped block may start from the exact path, steps of the machine.
NEAR_STEPS = 4.0
#: Less than this is not worth a segment of its own, um.
WORTH_A_SEGMENT_UM = 1.0


def only_cuts(plan: Plan, first: int, last: int) -> Plan:
    """Return the plan of cuts ``first`` to ``last``, 1-based and both inclusive."""
    return replace(plan, cuts=plan.cuts[first - 1 : last], partial=True)


def remaining(
    plan: Plan,
    index: int,
    at: tuple[int, int],
    along_um: float,
    backwards: bool,
    step_um: float = 1.0,
) -> Plan | None:
    """Return what is left of a plan when the wire broke within a cut.

    Args:
        plan: of the whole program.
        index: of the cut, 0-based.
        at: where the block starts from which on it is to be cut, um.
        along_um: about how far along the path that is: the path may pass the place twice.
        backwards: cut from the end of the path back to ``at``, threaded where the whole contour
            was; else on from ``at``, threaded there, in the kerf.
        step_um: of the machine.

    Returns:
        The cut's rest and all later cuts; None where ``at`` does not lie on the path.
    """
    cut = plan.cuts[index]
    rest = _behind(cut.path, at, along_um, NEAR_STEPS * step_um)
    if rest is None:
        return None
    left = plan.cuts[index + 1 :]
    if rest.closed:  # nothing was cut yet
        return replace(plan, cuts=(cut, *left), partial=True)
    keeps, thread, path = cut.keeps_left, at, rest
    if backwards:
        path = rest.reversed()
        keeps = None if keeps is None else not keeps
        v = path.vertices
        x, y = to_grid([v["x"][0], v["y"][0]]).tolist()
        thread = cut.thread if cut.path.closed else (x, y)
    stated = cut.stated if thread == cut.thread else ThreadPoint(*thread, option="--from-block")
    part = replace(cut, path=path, thread=thread, keeps_left=keeps, overcut_um=0.0, stated=stated)
    return replace(plan, cuts=(part, *left), partial=True)


def _behind(path: Contour, at: tuple[int, int], along_um: float, near_um: float) -> Contour | None:
    """Return the path behind the point nearest to ``at``, open; whole where that is its start."""
    s = seg.of_rows(path.starts, path.ends)
    begin = np.cumsum(s.length) - s.length
    n = len(s)
    off = seg.distances(s, np.full(n, float(at[0])), np.full(n, float(at[1])))
    near = np.flatnonzero(off <= near_um)
    if not len(near):
        return None
    places = np.array([_progress(s, int(k), at) + begin[k] for k in near.tolist()])
    best = int(np.argmin(np.abs(places - along_um)))
    k, place = int(near[best]), float(places[best])
    if place < WORTH_A_SEGMENT_UM:
        return path
    rows = path.vertices[k:].copy()
    if path.closed:
        last = np.zeros(1, VERTEX)
        last["x"], last["y"], last["source"] = path.vertices["x"][0], path.vertices["y"][0], -1
        rows = np.concatenate([rows, last])
    if begin[k] + s.length[k] - place < WORTH_A_SEGMENT_UM:
        rows = rows[1:]
    elif place - begin[k] > WORTH_A_SEGMENT_UM:
        x, y = seg.points_at(s.take(np.array([k])), np.array([place - begin[k]]))
        rows["x"][0], rows["y"][0] = x[0], y[0]
    return Contour(rows, False, path.sources) if len(rows) > 1 else None


def _progress(s: seg.Segments, k: int, at: tuple[int, int]) -> float:
    """Return how far along segment k the point nearest to ``at`` lies, um."""
    dx, dy = at[0] - s.x0[k], at[1] - s.y0[k]
    if s.turn[k] == 0:
        return float(np.clip(dx * s.ux[k] + dy * s.uy[k], 0.0, s.length[k]))
    angle = np.arctan2(at[1] - s.cy[k], at[0] - s.cx[k])
    along = float(np.mod((angle - s.a0[k]) * s.turn[k], seg.TAU) * s.radius[k])
    whole = float(seg.TAU * s.radius[k])
    # Just before the start of the arc is nearly a turn after it.
    along = along - whole if along > (whole + s.length[k]) / 2 else along
    return float(np.clip(along, 0.0, s.length[k]))

"""Wire paths against what is kept of other scenes of their plate (`Scene.beside`).

The kept material of a cut's own scene is measured with the wire's own places (`material`). That of
the others lies beside: how near the planned route comes to it tells, and the wire lies within the
limit of the path from there, which is proven.
"""

from __future__ import annotations

import numpy as np

from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import Role
from wedmcam.judge.route import Route, of_contours
from wedmcam.judge.segments import Ints, boxes, near_pairs, points_at, segment_distance


def entered(
    plan: Plan, route: Route, cuts: list[Cut], numbers: Ints
) -> list[tuple[int, float, float, float]]:
    """Return where routes enter what is kept of other scenes of their plate.

    Args:
        plan: with its scenes.
        route: as the wire runs.
        cuts: of the route.
        numbers: of the cut of the plan, from 0, that each cut of the route is.

    Returns:
        (cut of the plan, x, y, depth), the deepest place of each.
    """
    path = np.flatnonzero((route.role == Role.CONTOUR) | (route.role == Role.OVERCUT))
    segments, of = route.segments.take(path), route.cut[path]
    wire = np.array([c.offset_um + c.clearance_um for c in cuts])
    plates = np.array([plan.scenes[c.scene].plate for c in cuts])
    sided = np.array([plan.scenes[c.scene].keeps is not None for c in cuts])
    scene_of = np.array([c.scene for c in cuts])
    worst: dict[int, tuple[float, float, float]] = {}
    for number, scene in enumerate(plan.scenes):
        if not scene.beside or scene.keeps is None:
            continue
        closed = [k for k, c in enumerate(scene.outlines) if c.closed]
        kept, owner = of_contours([scene.outlines[k] for k in closed])
        behind = np.array([scene.behind[k] for k in closed])
        others = sided & (scene_of != number) & (plates == scene.plate)
        rows = np.flatnonzero(others[of])
        if not len(rows):
            continue
        beside = segments.take(rows)
        i, j = near_pairs(boxes(beside, float(wire.max())), boxes(kept))
        deep = wire[of[rows[i]]] - behind[owner[j]] - segment_distance(beside.take(i), kept.take(j))
        for k in np.argsort(-deep, kind="stable").tolist():
            cut = int(numbers[of[rows[i[k]]]])
            if deep[k] <= 0:
                break
            if cut not in worst or deep[k] > worst[cut][2]:
                one = beside.take(i[k : k + 1])
                x, y = points_at(one, 0.5 * one.length)
                worst[cut] = (float(x[0]), float(y[0]), float(deep[k]))
    return [(cut, *place) for cut, place in sorted(worst.items())]

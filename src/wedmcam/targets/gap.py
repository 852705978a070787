"""What the ZD-065's gap compensation needs to know of a plan, and whether it can do it at all.

The controller offsets an outline by scaling its arcs and leaving its lines. That is right only
where every joint is tangent, so a plan is refused whose outlines have corners.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.geom.measure import segments_of
from wedmcam.geom.segments import (
    distances,
    end_tangents,
    points_at,
    position_of,
    start_tangents,
    tangents_at,
)
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import Program

#: A joint may tear by this much when its segments are offset, um.
TORN_JOINT_UM = 1.0
#: Joints that are listed one by one.
LISTED_CORNERS = 10


def corners(plan: Plan, instead: str = "compact") -> list[Diagnostic]:
    """Return an error for each joint of a cut outline that is not tangent.

    A joint at an angle a tears by offset times a; up to `TORN_JOINT_UM` is taken for tangent.
    """
    findings: list[Diagnostic] = []
    more = 0
    for cut in plan.cuts:
        if cut.outline is None or not cut.offset_um or cut.cornered is not None:
            continue  # the controller puts arcs on corners as the plan does
        c = cut.outline
        s = segments_of(c.vertices, c.closed)
        ex, ey = end_tangents(s)
        sx, sy = start_tangents(s)
        bx, by = np.roll(sx, -1), np.roll(sy, -1)
        angle = np.abs(np.arctan2(ex * by - ey * bx, ex * bx + ey * by))
        if not c.closed:
            angle = angle[:-1]
        for k in np.flatnonzero(angle * cut.offset_um > TORN_JOINT_UM).tolist():
            if len(findings) >= LISTED_CORNERS:
                more += 1
                continue
            corner = Place.of_um(s.x1[k], s.y1[k])
            findings.append(
                error(
                    "not-tangent",
                    "the outline has a corner of {angle_deg:.3f} degrees at {corner}; the "
                    "controller's compensation takes tangent joints only",
                    c.source_of(k),
                    points_mm=(corner,),
                    hint="arcs on the corners (--corners paper), round them (--corner), or --to "
                    "{instead}"
                    if instead == "compact"
                    else "round the corners (--corner), or --to {instead}",
                    angle_deg=float(np.degrees(angle[k])),
                    corner=corner,
                    instead=instead,
                )
            )
    if more:
        findings.append(error("not-tangent", "{count} further corners", count=more))
    return findings


def gaps(plan: Plan) -> list[tuple[float, Place]]:
    """Return the offsets of the cuts, um, each with a place where one has it."""
    places: dict[float, Place] = {}
    for cut in plan.cuts:
        v = cut.path.vertices
        places.setdefault(cut.offset_um, Place.of_um(v["x"][0], v["y"][0]))
    return sorted(places.items())


def arc_growth(plan: Plan, program: Program) -> NDArray[np.int8]:
    """Return for each block whether the offset made an arc larger (+1) or smaller (-1).

    The outline lies on the side of what is kept; an arc whose centre is on that side grew.
    """
    left = {}
    for number, cut in enumerate(plan.cuts, 1):  # as blocks count them: in cutting order
        keeps = cut.keeps_left
        left[number] = _outline_left(cut) if keeps is None else keeps
    side = np.array([1 if left.get(n, True) else -1 for n in program.blocks["cut"].tolist()])
    turn = program.blocks["turn"]
    return np.asarray(np.where(turn == 0, 1, turn * side), dtype=np.int8)


def _outline_left(cut: Cut) -> bool:
    """Return whether the outline of an open cut lies to the left of its path."""
    if cut.outline is None:
        return True
    s = segments_of(cut.outline.vertices, cut.outline.closed)
    path = cut.path.vertices
    x, y = float(path["x"][0]), float(path["y"][0])
    k = int(np.argmin(distances(s, np.full(len(s), x), np.full(len(s), y))))
    at = position_of(s.take(np.array([k])), np.array([x]), np.array([y]))
    (ux,), (uy,) = tangents_at(s.take(np.array([k])), at)
    (px,), (py,) = points_at(s.take(np.array([k])), at)
    return bool(ux * (y - py) - uy * (x - px) < 0)

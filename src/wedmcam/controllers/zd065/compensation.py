"""Gap compensation (间隙补偿) by transition arcs (过渡圆): the wire's path beside a stated outline.

The data state the outline with its corners, and the operator enters the gap and its side. Wherever
a line meets a line or an arc, an arc is added, none where arcs meet [S]: there the offset arcs are
intersected [R]. Punch and die must round the same corners, or they do not fit; so the arc of radius
r belongs to the *outline*, r is one number for both, and the wire's arc has the radius r + gap
where it goes round the corner and r - gap where it runs inside [R].

The outline is taken as the machine steps it with a gap of 0: its vertices are those places, its
arcs are normal to the ways to their stated centres [R]. Vertices of the wire's path are those whole
numbers and a rest in 8-digit decimals; `loop.follow` steps from one to the next, so that each
vertex as stepped is within 1 um of the exact one. No ZD-065 did the latter [R]; the literal way,
open loop and for tangent joints only, is `controllers.scaling`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.scaling import scale
from wedmcam.controllers.stepping import Stepping
from wedmcam.controllers.zd065.chains import chains_of, places_of, sides_of
from wedmcam.controllers.zd065.leads import leads_astray
from wedmcam.controllers.zd065.loop import EXACT, follow
from wedmcam.controllers.zd065.wire import Problem, Wire

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Problems with which there is a path all the same.
HARMLESS = frozenset({"open", "nesting", "lead", "acute"})


@dataclass(frozen=True, slots=True)
class Compensated:
    """The cutting data of an outline and a gap.

    Attributes:
        blocks: dtype `BLOCK`; controls stay.
        stated: for each of them the number of the stated block that it comes of.
        path: the exact path that they follow, dtype `EXACT`; ``source`` numbers stated blocks. It
            starts within 1 um of (0, 0), which is where the wire starts; empty open loop.
        miss: of each row of it, how far from its exact end the machine stands, um.
        split: rows of it that are cut in several arcs.
    """

    blocks: NDArray[np.void]
    stated: Ints
    path: NDArray[np.void]
    miss: Floats
    split: Ints


def compensate(
    figure: NDArray[np.void],
    gap_um: int,
    outwards: bool = True,
    corner_um: float | None = None,
    *,
    stepping: Stepping = MIRROR,
    open_loop: bool = False,
) -> tuple[Compensated, list[Problem]]:
    """Return the cutting data of an outline that is offset by a gap, and what is to say of it.

    Args:
        figure: dtype `OUTLINE`: contours with their lead lines, from thread point to thread point.
        gap_um: whole um, 0 to 7999 [S].
        outwards: True for a punch (凸模), False for a die (凹模).
        corner_um: radius of the transition arcs of the outline, um, at least the gap; None for the
            gap.
        stepping: of the machine.
        open_loop: only scale arcs, as 4B does: for outlines whose joints are all tangent.

    Where a problem is an error the data are the outline as stated.
    """
    stated = np.arange(len(figure), dtype=np.int64)
    literal = Compensated(
        scale(figure, gap_um if open_loop else 0, outwards),
        stated,
        np.zeros(0, EXACT),
        np.zeros(0),
        np.zeros(0, np.int64),
    )
    corner = float(gap_um) if corner_um is None else float(corner_um)
    if open_loop or not (gap_um or corner):
        return literal, []
    path, problems = wire_path(figure, gap_um, outwards, corner)
    if corner_um is not None:
        problems = [p for p in problems if p.what != "acute"]
    if any(p.what not in HARMLESS for p in problems):
        return literal, problems
    made = follow(path, stepping)
    rows = made.blocks["source"].astype(np.int64)
    return (
        Compensated(made.blocks, path["source"][rows], path, made.miss, made.split),
        problems,
    )


def wire_path(
    figure: NDArray[np.void], gap_um: int, outwards: bool, corner_um: float
) -> tuple[NDArray[np.void], list[Problem]]:
    """Return the exact path of the wire, dtype `EXACT`, and problems.

    Args:
        figure: see `compensate`.
        gap_um: see `compensate`.
        outwards: see `compensate`.
        corner_um: radius of the transition arcs.
    """
    places = places_of(figure)
    chains = chains_of(figure, places)
    sides = sides_of(figure, places, chains)
    problems = [
        Problem("turn", int(k), {"sweep_deg": float(places.sweep[k])})
        for k in np.flatnonzero(places.sweep > 360.0 + 1e-9)
    ]
    if corner_um < gap_um:
        problems.append(Problem("below", 0, {"corner_um": corner_um, "gap_um": gap_um}))
    problems += [Problem("sides", b, {"other": a + 1}) for a, b in sides.contradicting]
    if gap_um:
        for k in sides.doubtful:
            problems.append(Problem("doubtful", int(chains[k].body[0]), {}))
        for k, chain in enumerate(chains):
            if not sides.outwards[k]:
                problems.append(Problem("unknown", int(chain.body[0]), {}))
            elif k in sides.by_nesting:
                hole = sides.by_nesting[k]
                problems.append(
                    Problem(
                        "nesting", int(chain.body[0]), {"hole": hole, "inside": hole == outwards}
                    )
                )
    problems += [
        Problem("open", int(c.body[c.closed - 1]), {"off_um": c.off_um}) for c in chains if c.off_um
    ]
    if any(p.what not in HARMLESS for p in problems):
        return np.zeros(0, EXACT), problems
    sign = 1 if outwards else -1
    shift = np.array([side * sign * gap_um for side in sides.outwards], dtype=np.int64)
    wire = Wire(figure, places, chains, shift, corner_um)
    problems += wire.problems
    if wire.problems:
        return np.zeros(0, EXACT), problems
    path = wire.rows()
    for astray in leads_astray(path, chains, shift):
        x, y = places.start[astray.begins].tolist()
        values = {"depth_um": astray.depth_um, "inside": astray.kept_inside, "x_um": x, "y_um": y}
        problems.append(Problem("lead", astray.row, values))
    problems += wire.acute() if gap_um else []
    return path, problems

"""A plan as one figure and its copies, for a controller that turns figures.

Whole lengths and radii leave some freedom, and not every figure that closes gives a path within
2 um of the plan's: where the path starts on the grid, and by how much it runs outside of the exact
one, are tried until the program of one proves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom.measure import segments_of
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, end_tangents, start_tangents
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.machines import Machine
from wedmcam.targets.entries import MOST_COPIES, Entries
from wedmcam.transforms.repeat import Repeat, find_repeat

if TYPE_CHECKING:
    from wedmcam.backends.zd065.figure import Stated

#: The copies of a path end where they should within this, um, wherever its figures come round.
CLOSES_UM = 0.3
#: How far the vertices of the stated figure may be from those of the path, um: 2 um is what a
#: program may be off, and the controller takes one of them.
OFF_UM = 1.0
#: Largest radius that the format states, um [S].
MOST_RADIUS_UM = 10_000_000
#: By how much the figure lies away from what is kept, um: towards it a program may be off by 1.6 um
#: only, and the other way by 2 um. The first is best, the others have other radii to be rounded.
AWAY_UM = (0.15, 0.25, 0.05, 0.35, 0.45, -0.05)
#: The path may start so far from the end of its lead, um.
START_UM = 1.0
#: So many figures are proven, the nearest first; of those that lie equally far away from what is
#: kept so many.
PROVEN, EACH = 12, 2


@dataclass(frozen=True, slots=True, eq=False)
class Turned:
    """A plan as one figure, in the frame of the controller.

    Attributes:
        stated: its polar blocks.
        start: where they begin, in the drawing.
        off_um: how far its vertices, and the middles of its arcs, are from the path.
        entries: what makes the plan's program of them.
        repeat: what was found in the path.
        order: how many figures there are.
        limit_um: within which the figure had to close.
    """

    stated: Stated
    start: complex
    off_um: float
    entries: Entries
    repeat: Repeat
    order: int
    limit_um: float


@lru_cache(maxsize=2)
def turned_of(plan: Plan, machine: Machine) -> Turned | None:
    """Return a plan as one figure and its copies; None where it is not one."""
    if len(plan.cuts) != 1 or plan.cuts[0].stop_um or plan.cuts[0].overcut_um:
        return None
    repeat = find_repeat(plan.cuts[0].path)
    if repeat is None or not repeat.repeats:
        return None
    every = (
        turned
        for order in repeat.orders(MOST_COPIES + 1)
        for turned in _figures(plan, machine, repeat, order)
    )
    return next((t for t in islice(every, PROVEN) if _proves(t, plan, machine)), None)


def _figures(plan: Plan, machine: Machine, repeat: Repeat, order: int) -> Iterator[Turned]:
    """Yield so many figures as a plan can be stated as, the nearest first; some of those."""
    from wedmcam.backends.zd065.figure import eight, nearness

    exact = repeat.turn * (repeat.order // order)
    exact = (exact + 180.0) % 360.0 - 180.0 or 180.0
    angle = float(np.sign(exact) * eight(np.array([abs(exact)]))[0])
    cut = plan.cuts[0]
    side = keeps_sign(cut)
    starts = _starts_near(cut.path)
    tried = []
    for away in AWAY_UM if side else AWAY_UM[1:2]:
        beside = _beside(cut.path, starts, away * side)
        alike = []
        for start, off in zip(starts.tolist(), beside.tolist(), strict=True):
            path = repeat.figure(order, start, angle, away * side)
            alike.append((nearness(path) + off + abs(away - AWAY_UM[0]), start, path))
        alike.sort(key=lambda row: row[0])
        tried += alike[:EACH]
    tried.sort(key=lambda row: row[0])
    for cost, start, path in tried:
        if np.isfinite(cost) and (path["radius"] <= MOST_RADIUS_UM + 0.5).all():
            meant = repeat.figure(order, start, angle)
            turned = _turned(plan, machine, path, meant, start, angle, order, repeat)
            if turned is not None:
                yield turned


def _turned(
    plan: Plan,
    machine: Machine,
    path: NDArray[np.void],
    meant: NDArray[np.void],
    start: complex,
    angle: float,
    order: int,
    repeat: Repeat,
) -> Turned | None:
    """Return a figure of a plan, stated; None where it does not close or lies too far off."""
    from wedmcam.backends.zd065.figure import state
    from wedmcam.controllers.zd065.data import displacements

    stated = state(_for_controller(path, machine))
    off_um = stated.off_from(_for_controller(meant, machine))
    limit = CLOSES_UM * abs(float(np.sin(np.radians(angle) / 2)))
    if not stated.closes or stated.drift_um > limit or off_um > OFF_UM:
        return None
    cut = plan.cuts[0]
    angle *= _sense(machine)
    turns = np.exp(1j * np.radians(angle * np.arange(order)))
    end = complex(displacements(stated.figure).sum() * turns.sum())
    lead = _places(np.array([start - complex(*cut.thread)]), machine)[0]
    back = -lead - end
    entries = Entries(
        order - 1,
        angle,
        lead_in=(round(lead.real), round(lead.imag)),
        lead_out=(round(back.real), round(back.imag)) if cut.path.closed else None,
    )
    return Turned(stated, start, off_um, entries, repeat, order, limit)


def _proves(turned: Turned, plan: Plan, machine: Machine) -> bool:
    """Return whether the program of a figure is one of the plan."""
    from wedmcam.backends.zd065.rotation import memory_of

    data = memory_of(turned.stated.figure).data.tobytes()
    return proves(data, turned.entries, plan, machine)


def proves(data: bytes, e: Entries, plan: Plan, machine: Machine) -> bool:
    """Return whether the program that a controller makes of data is one of the plan."""
    from wedmcam.diag import has_errors
    from wedmcam.frontends import decoder
    from wedmcam.judge.judge import judge

    program, findings = decoder(machine.format)(
        data, machine, "figure", copies=e.copies, step=e.angle, lead_in=e.lead_in,
        lead_out=e.lead_out,
    )  # fmt: skip
    if has_errors(findings):
        return False
    program = replace(program, origin=plan.cuts[0].thread)
    _, findings = judge(program, plan, stepping=machine.stepping, limits=machine.limits)
    return not has_errors(findings)


def keeps_sign(cut: Cut) -> int:
    """Return +1 where what is kept lies to the left of the path, -1 to the right, else 0."""
    return 0 if cut.keeps_left is None else 1 if cut.keeps_left else -1


def _beside(path: Contour, places: NDArray[np.complex128], right_um: float) -> Floats:
    """Return how far places near the start of a path lie beside it, shifted to the right, um."""
    s = segments_of(path.vertices, path.closed)
    (ux, *_), (uy, *_) = start_tangents(s)
    headings = [complex(ux, uy)]
    if path.closed:
        (*_, ux), (*_, uy) = end_tangents(s)
        headings.append(complex(ux, uy))
    way = places - complex(s.x0[0], s.y0[0])
    off = [abs((way * np.conj(-1j * u)).real - right_um) for u in headings]
    return np.asarray(np.max(off, axis=0))


def _starts_near(path: Contour) -> NDArray[np.complex128]:
    """Return the places of the grid on which a path may start: the lead goes to its very start."""
    v = path.vertices
    exact = complex(v["x"][0], v["y"][0])
    x, y = to_grid([exact.real, exact.imag]).tolist()
    near = np.array([complex(x + i, y + j) for i in (0, 1, -1) for j in (0, 1, -1)])
    within = abs(near - exact) <= START_UM
    within[0] = True
    return near[within]


def _sense(machine: Machine) -> int:
    """Return +1 where a turn of the drawing is one of the controller, -1 where it is mirrored."""
    axes = machine.axes
    return -1 if (axes.exchange + axes.mirror_x + axes.mirror_y) % 2 else 1


def _places(ways: NDArray[np.complex128], machine: Machine) -> NDArray[np.complex128]:
    """Return ways of the drawing as the controller has them."""
    from wedmcam.backends.axes import places

    xy = places(np.column_stack([ways.real, ways.imag]), machine.axes)
    return np.asarray(xy[:, 0] + 1j * xy[:, 1])


def _for_controller(path: NDArray[np.void], machine: Machine) -> NDArray[np.void]:
    """Return a path (dtype `WAY`) in the frame of the controller."""
    ends = _places(path["x"] + 1j * path["y"], machine)
    out = path.copy()
    out["x"], out["y"] = ends.real, ends.imag
    out["turn"] *= _sense(machine)
    return out

"""The ZD-065's rotation format: one figure that the controller turns, and a number of copies.

A plan of one cut whose path repeats about a centre is written as its figure; the operator enters
the copies, the angle and the two leads, which the format has no room for outside the figure.
Everything else is one figure with no copies, leads and all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from wedmcam.diag import Diagnostic, Place, note
from wedmcam.geom.measure import segments_of
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, end_tangents, start_tangents
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import MOST_COPIES, Entries
from wedmcam.targets.stated import Memory
from wedmcam.transforms.repeat import SAME_UM, Repeat, find_repeat

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wedmcam.backends.zd065.figure import Stated as StatedFigure
    from wedmcam.transforms.lower import Rules

#: The copies of a path end where they should within this, um, wherever its figures come round.
CLOSES_UM = 0.3
#: How far the vertices of the stated figure may be from those of the path, um: 2 um is what a
#: program may be off, and the controller takes one of them.
OFF_UM = 1.0
#: The figure lies so far away from what is kept, um: towards it a program may be off by 1.6 um
#: only, and the other way by 2 um.
AWAY_UM = 0.15
#: The path may start so far from the end of its lead, um.
START_UM = 0.8
#: Largest radius that the format states, um [S].
MOST_RADIUS_UM = 10_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Turned:
    """A plan as one figure, in the frame of the controller.

    Attributes:
        stated: its polar blocks.
        start: where they begin, in the drawing.
        entries: what makes the plan's program of them.
        repeat: what was found in the path.
        order: how many figures there are.
        limit_um: within which the figure had to close.
    """

    stated: StatedFigure
    start: complex
    entries: Entries
    repeat: Repeat
    order: int
    limit_um: float


class Rotation(Memory):
    """The ZD-065's rotation format."""

    #: An angle of more than a turn is none.
    turns: ClassVar[bool] = False

    @property
    def block_bytes(self) -> tuple[int, int]:
        """See `formats.rotation`."""
        from wedmcam.formats import rotation

        return rotation.LINE_BYTES, rotation.ARC_BYTES

    @property
    def own_path(self) -> Machine:
        """The ZD-065's cutting format."""
        from wedmcam.machines import default

        return default("compact")

    def rules(self, count: str | None) -> Rules:
        """See `Target`; a radius of 10 m itself is one that the format holds."""
        rules = super().rules(count)
        return replace(rules, arc_um=rules.arc_um + 2)

    def entries(self, plan: Plan) -> Entries:
        """Copies, angle and leads of a plan that repeats."""
        turned = turned_of(plan, self.machine)
        return Entries() if turned is None else turned.entries

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """Copies, angle and leads as they are stated."""
        return Entries(
            entries.copies, entries.angle, lead_in=entries.lead_in, lead_out=entries.lead_out
        )

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`."""
        from wedmcam.backends.zd065.rotation import memory_of

        turned = turned_of(plan, self.machine) if entries.copies else None
        if turned is None:
            data, findings = self._encoded(program)
            return data, [*findings, *_alone(plan)]
        memory = memory_of(turned.stated.figure)
        findings = [_figure_note(turned, plan), *memory.too_large(self.machine)]
        return memory.data.tobytes(), findings

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._decoded(
            data,
            file,
            copies=entries.copies,
            step=entries.angle,
            lead_in=entries.lead_in,
            lead_out=entries.lead_out,
        )

    def on_contour(self, plan: Plan, entries: Entries) -> tuple[Plan, list[Diagnostic]]:
        """See `Target`; without a lead-in the program starts on the contour."""
        if not entries.copies or entries.lead_in is not None or len(plan.cuts) != 1:
            return plan, []
        cut = plan.cuts[0]
        start = self._start_of(plan)
        told = note(
            "no-leads",
            "no leads are entered: the program starts on the contour at {start}, and its leads are "
            "not proven",
            points_mm=(Place.of_um(*start),),
            hint="--lead-in X,Y --lead-out X,Y as they are entered at the controller",
            start=Place.of_um(*start),
        )
        return replace(plan, cuts=(replace(cut, thread=start, stated=None),)), [told]

    def _start_of(self, plan: Plan) -> tuple[int, int]:
        """Return where a program of a plan starts without its lead-in."""
        turned = turned_of(plan, self.machine)
        v = plan.cuts[0].path.vertices
        if turned is None:
            x, y = to_grid([v["x"][0], v["y"][0]]).tolist()
            return x, y
        return round(turned.start.real), round(turned.start.imag)


def turned_of(plan: Plan, machine: Machine) -> Turned | None:
    """Return a plan as one figure and its copies; None where it is not one."""
    if len(plan.cuts) != 1 or plan.cuts[0].stop_um or plan.cuts[0].overcut_um:
        return None
    repeat = find_repeat(plan.cuts[0].path)
    if repeat is None or not repeat.repeats:
        return None
    for order in repeat.orders(MOST_COPIES + 1):
        turned = _turned(plan, machine, repeat, order)
        if turned is not None:
            return turned
    return None


def _turned(plan: Plan, machine: Machine, repeat: Repeat, order: int) -> Turned | None:
    """Return a plan as so many figures; None where whole lengths do not let one close."""
    from wedmcam.backends.zd065.figure import eight, nearness, state
    from wedmcam.controllers.zd065.data import displacements

    exact = repeat.turn * (repeat.order // order)
    exact = (exact + 180.0) % 360.0 - 180.0 or 180.0
    angle = float(np.sign(exact) * eight(np.array([abs(exact)]))[0])
    cut = plan.cuts[0]
    right_um = AWAY_UM * (0 if cut.keeps_left is None else 1 if cut.keeps_left else -1)
    starts = _starts_near(cut.path)
    paths = [repeat.figure(order, start, angle, right_um) for start in starts.tolist()]
    near = np.array([nearness(path) for path in paths]) + _beside(cut.path, starts, right_um)
    best = int(near.argmin())
    start, path = complex(starts[best]), paths[best]
    if (path["radius"] > MOST_RADIUS_UM + 0.5).any():
        return None
    stated = state(_for_controller(path, machine))
    limit = CLOSES_UM * abs(float(np.sin(np.radians(angle) / 2)))
    if not stated.closes or stated.drift_um > limit or stated.off_um > OFF_UM:
        return None
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
    return Turned(stated, start, entries, repeat, order, limit)


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


def _figure_note(turned: Turned, plan: Plan) -> Diagnostic:
    """Say what was found to repeat, and how near to the drawing the stated figure is."""
    repeat, order = turned.repeat, turned.order
    centre = Place.of_um(*repeat.centre)
    text = (
        "the path repeats {times} times about {centre}: one figure of {blocks} blocks is written, "
        "{angle_deg:.8g} degrees from copy to copy; its vertices lie within {off_um:.2f} um of "
        "the drawing's, and it closes within {drift_um:.4f} um (limit {limit_um:.4f} um)"
    )
    told = note(
        "figure-repeated",
        text,
        plan.cuts[0].path.source_of(0),
        points_mm=(centre,),
        hint="enter {copies} copies, {angle_deg:.8g} degrees and the two leads at the controller",
        times=repeat.order,
        centre=centre,
        blocks=len(turned.stated.figure),
        angle_deg=turned.entries.angle,
        off_um=turned.stated.off_um,
        drift_um=turned.stated.drift_um,
        limit_um=turned.limit_um,
        copies=turned.entries.copies,
    )
    if order == repeat.order:
        return told
    return told.extended(
        "; a figure is {times_in} of them: the controller makes {most} copies"
        if repeat.order > MOST_COPIES + 1
        else "; a figure is {times_in} of them: a smaller one does not close with whole lengths",
        times_in=repeat.order // order,
        most=MOST_COPIES,
    )


def _alone(plan: Plan) -> list[Diagnostic]:
    """Say why a path that repeats, or nearly so, is written as one figure without copies.

    Of several cuts, of the one that would save most.
    """
    found = [(repeat.repeats, repeat.order, -number, repeat)
             for number, cut in enumerate(plan.cuts, 1)
             if (repeat := find_repeat(cut.path)) is not None]  # fmt: skip
    if not found:
        return []
    _, _, less, repeat = max(found, key=lambda row: row[:3])
    why, hint = _why_alone(plan, repeat, -less)
    centre = Place.of_um(*repeat.centre)
    told = note(
        "not-repeated",
        "cut {cut} repeats {times} times about {centre}, and is written without copies: ",
        plan.cuts[-less - 1].path.source_of(0),
        points_mm=(centre,),
        hint=hint,
        cut=-less,
        times=repeat.order,
        centre=centre,
    )
    values = {"off_um": repeat.off_um, "same_um": SAME_UM, "most": MOST_COPIES}
    return [told.extended(why, **values, cuts=len(plan.cuts))]


def _why_alone(plan: Plan, repeat: Repeat, number: int) -> tuple[str, str]:
    cut = plan.cuts[number - 1]
    if not repeat.repeats:
        return (
            "its copies lie up to {off_um:.2f} um from their mean (limit {same_um:g} um)",
            "draw one figure and copy it",
        )
    if len(plan.cuts) > 1:
        return (
            "one figure and its copies hold one cut, and the program has {cuts}",
            "--cuts {cut} makes a file of this cut alone",
        )
    if cut.stop_um or cut.overcut_um:
        return (
            "a stop or an overcut stands in the last copy alone",
            "--stop 0 --overcut 0 gives them up",
        )
    if not repeat.orders(MOST_COPIES + 1):
        return (
            "the controller makes up to {most} copies, and no part of them is a figure of several",
            "--split writes several loads where the memory is too small",
        )
    return "no figure of it closes with whole lengths and angles of 8 digits", "--to compact"

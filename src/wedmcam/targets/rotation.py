"""The ZD-065's rotation format: one figure that the controller turns, and a number of copies.

A plan of one cut whose path repeats about a centre is written as its figure; the operator enters
the copies, the angle and the two leads, which the format has no room for outside the figure.
Everything else is one figure with no copies, leads and all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from wedmcam.diag import Diagnostic, Place, note
from wedmcam.formats import rotation
from wedmcam.geom.measure import segments_of_all
from wedmcam.geom.quantize import to_grid
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import MOST_COPIES, Entries
from wedmcam.targets.stated import Memory
from wedmcam.targets.turned import AWAY_UM, Turned, keeps_sign, proves, turned_of
from wedmcam.transforms.repeat import SAME_UM, beside, find_repeat

if TYPE_CHECKING:
    from wedmcam.backends.zd065.landing import Exact
    from wedmcam.ir.contour import Contour
    from wedmcam.transforms.lower import Rules


class Rotation(Memory):
    """The ZD-065's rotation format."""

    #: It goes to the vertices of the figure by arcs that it finds itself.
    makes_path: ClassVar[bool] = True
    #: An angle of more than a turn is none.
    turns: ClassVar[bool] = False

    @property
    def whole_contours(self) -> str:
        """See `Target`."""
        return "the controller turns a figure as a whole"

    @property
    def block_bytes(self) -> tuple[int, int]:
        """See `formats.rotation`."""
        return rotation.LINE_BYTES, rotation.ARC_BYTES

    @property
    def own_path(self) -> Machine:
        """The ZD-065's cutting format."""
        from wedmcam.machines import default

        return default("compact")

    def rules(self, count: str | None, feed_um: float | None = None) -> Rules:
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
            entries.copies,
            entries.angle,
            lead_in=entries.lead_in,
            lead_out=entries.lead_out,
            open_loop=entries.open_loop,
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
            data, findings = self._write_alone(program, plan)
            return data, [*findings, *_alone(plan)]
        memory = memory_of(turned.stated.figure)
        findings = [_figure_note(turned, plan), *memory.too_large(self.machine)]
        return memory.data.tobytes(), findings

    def _write_alone(self, program: Program, plan: Plan) -> tuple[bytes, Sequence[Diagnostic]]:
        """Return the data of a program without copies, and findings.

        Of data that aim at the path and a little beside it, the first that prove; else the first.
        """
        first = None
        for away in AWAY_UM if plan.cuts else AWAY_UM[:1]:
            paths = [beside(cut.path, away * keeps_sign(cut)) for cut in plan.cuts]
            made = self._encoded(program, exact=_exact(paths))
            first = first or made
            if not made[0] or proves(made[0], Entries(), plan, self.machine):
                return made
        assert first is not None
        return first

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
            open_loop=entries.open_loop,
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


def _exact(paths: Sequence[Contour]) -> Exact | None:
    """Return the segments of paths."""
    from wedmcam.backends.zd065.landing import Exact

    if not paths:
        return None
    s, _ = segments_of_all([(c.vertices, c.closed) for c in paths])
    return Exact(
        s.x0 + 1j * s.y0, s.x1 + 1j * s.y1, s.cx + 1j * s.cy, s.radius, s.turn.astype(np.int64)
    )


def _figure_note(turned: Turned, plan: Plan) -> Diagnostic:
    """Say what was found to repeat, and how near to the drawing the stated figure is."""
    repeat, order = turned.repeat, turned.order
    centre = Place.of_um(*repeat.centre)
    told = note(
        "figure-repeated",
        "the path repeats {times} times about {centre}: one figure of {blocks} blocks is written, "
        "{angle_deg:.8g} degrees from copy to copy; its vertices lie within {off_um:.2f} um of "
        "the drawing's, and it closes within {drift_um:.4f} um (limit {limit_um:.4f} um)",
        plan.cuts[0].path.source_of(0),
        points_mm=(centre,),
        hint="enter {copies} copies, {angle_deg:.8g} degrees and the two leads at the controller",
        times=repeat.order,
        centre=centre,
        blocks=len(turned.stated.figure),
        angle_deg=turned.entries.angle,
        off_um=turned.off_um,
        drift_um=turned.stated.drift_um,
        limit_um=turned.limit_um,
        copies=turned.entries.copies,
    )
    if order == repeat.order:
        return told
    return told.extended(
        "; a figure is {times_in} of them: the controller makes {most} copies"
        if repeat.order > MOST_COPIES + 1
        else "; a figure is {times_in} of them: none of fewer closes with whole lengths and proves",
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
    centre = Place.of_um(*repeat.centre)
    told = note(
        "not-repeated",
        "cut {cut} repeats {times} times about {centre}, and is written without copies: ",
        plan.cuts[-less - 1].path.source_of(0),
        points_mm=(centre,),
        cut=-less,
        times=repeat.order,
        centre=centre,
    )
    cut = plan.cuts[-less - 1]
    if not repeat.repeats:
        told = told.extended(
            "its copies lie up to {off_um:.2f} um from their mean (limit {same_um:g} um)",
            off_um=repeat.off_um,
            same_um=SAME_UM,
        ).with_hint("draw one figure and copy it")
    elif len(plan.cuts) > 1:
        told = told.extended(
            "one figure and its copies hold one cut, and the program has {cuts}",
            cuts=len(plan.cuts),
        ).with_hint("--cuts {cut} makes a file of this cut alone")
    elif cut.stop_um or cut.overcut_um:
        told = told.extended("a stop or an overcut stands in the last copy alone").with_hint(
            "--stop 0 --overcut 0 gives them up"
        )
    elif not repeat.orders(MOST_COPIES + 1):
        told = told.extended(
            "the controller makes up to {most} copies, and no part of them is a figure of several",
            most=MOST_COPIES,
        ).with_hint("--split writes several loads where the memory is too small")
    else:
        told = told.extended("no figure of it closes with whole lengths and proves").with_hint(
            "--to compact"
        )
    return [told]

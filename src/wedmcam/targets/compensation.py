"""The ZD-065's compensation format: outlines with their corners, offset by the machine itself.

The machine adds the transition arcs (``controllers.zd065.compensation``), so what is written are
the outlines as drawn, once for punch and die; the operator enters the gap, its side, and the radius
of the arcs where that is not the gap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wedmcam.diag import Diagnostic, Severity, error, has_errors, note
from wedmcam.diag.run import WrongUse
from wedmcam.formats import compact
from wedmcam.formats import compensation as rows
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.targets import gap
from wedmcam.targets.entries import Entries
from wedmcam.targets.scaled import Scaled
from wedmcam.targets.stated import Memory

if TYPE_CHECKING:
    from numpy.typing import NDArray

Shift = tuple[float, float, float]

#: What the judge says where two roundings are too much.
FAR = frozenset({"path-deviation", "gouge", "not-closed"})
#: By how much an outline is moved before it is put on whole um, um, and by how much towards what
#: falls away: its vertices then come to lie on other ones, and 2.0 um are allowed beside the part,
#: 1.6 in it.
SHIFTS: tuple[Shift, ...] = tuple(
    (0.3 * x, 0.3 * y, out)
    for out in (0.0, 0.2, 0.35)
    for x, y in ((0, 0), (1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))
)


class Compensation(Scaled, Memory):
    """The machine's data processing makes the path of a stated outline."""

    instead = "compact"
    moves_starts = True
    needs_lead = "the gap is taken up on a lead, and there is none in the kerf"

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """See `Target`."""
        return (
            note(
                "not-reachable",
                "the outline is whole um, and so is the path that the controller makes beside it: "
                "some places come out farther from the path than is allowed",
                hint="another thread point or --corner, or --to {instead}",
                instead=self.instead,
            ),
        )

    @property
    def block_bytes(self) -> tuple[int, int]:
        """See `formats.compensation`."""
        return compact.LINE_BYTES, rows.ARC_BYTES

    @property
    def own_path(self) -> Machine:
        """The ZD-065's cutting format."""
        from wedmcam.machines import default

        return default("compact")

    def place_starts(self, plan: Plan) -> tuple[Plan | None, Sequence[Diagnostic]]:
        """Beside a segment of the outline, not beside the arc of a corner."""
        from wedmcam.transforms.outlines.grid import Grid
        from wedmcam.transforms.outlines.stated import start_off_corners

        limits = self.machine.limits
        return start_off_corners(plan, Grid(1.0, limits.line_um, limits.arc_um))

    def moves(self, program: Program) -> bool:
        """See `Scaled`; lines are offset too, and have arcs at their corners."""
        return bool(np.isin(program.blocks["kind"], (Kind.LINE, Kind.ARC)).any())

    def entries(self, plan: Plan) -> Entries:
        """The gap of all cuts, its side, and the radius of the arcs at corners."""
        entries = super().entries(plan)
        radii = sorted({cut.corner_um for cut in plan.cuts if cut.cornered is not None})
        if len(radii) > 1:
            several = ", ".join(f"{um / 1000:.4g} mm" for um in radii)
            raise WrongUse(
                f"{self.machine.format} has one radius for the arcs at all corners, and the cuts "
                f"have {several}: the same corner for all, or --to {self.instead}"
            )
        return Entries(
            gap_um=entries.gap_um,
            outwards=entries.outwards,
            corner_um=max(radii, default=None),
        )

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """See `Scaled`; radius of the arcs of corners, and leads, as they are stated."""
        made = (
            replace(
                self._entries(entries.every_um or 0.0, entries.outwards),
                corner_um=entries.corner_um,
            )
            if plan is None
            else self.entries(plan)
        )
        return replace(made, lead_in=entries.lead_in, lead_out=entries.lead_out)

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
        findings = gap.corners(plan, self.instead)
        findings += _too_wide(plan, entries)
        if has_errors(findings):
            return None, findings
        usual: list[Shift] = [SHIFTS[0]] * len(plan.cuts)
        data, more = self._outlines(plan, entries, usual)
        if data and not has_errors(more) and self._strays(data, plan, entries):
            shifts = [self._settled(plan, k, entries) for k in range(len(plan.cuts))]
            if shifts != usual:
                data, more = self._outlines(plan, entries, shifts)
        if data and not has_errors(more):
            more = [*more, *self._torn(data, plan, entries)]
        return data, [*findings, *more]

    def _outlines(
        self, plan: Plan, entries: Entries, shifts: Sequence[Shift]
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """Return the outlines of a plan as bytes, each moved before it is put on whole um."""
        from wedmcam.transforms.lower import lower
        from wedmcam.transforms.outlines.stated import on_outlines

        stated, findings = on_outlines(plan, shifts)
        if stated is None:
            return None, findings
        outline, _ = lower(stated, self.rules(None))  # what it drops was said of the path
        if outline is None:
            return None, findings
        data, more = self._encoded(
            outline, outwards=entries.outwards, grown=gap.arc_growth(stated, outline)
        )
        return data, [*findings, *more]

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """See `Target`; an outline stays one, and a path is one with a gap of 0 alone.

        A path has lost the corners of its outline, and on the whole um of a path no outline lies
        for which the machine makes that path again within 1 um.
        """
        if entries.gap_um and senses is None:
            refusal = error(
                "not-in-format",
                "the compensation format holds outlines, and the program has only the path of the "
                "wire, {gap_mm:.3f} mm beside one",
                hint="compile the drawing to .zdc; --gap 0 states the path itself, --to compact "
                "too",
                gap_mm=entries.gap_um / 1000,
            )
            return None, [refusal]
        return super().write_carried(program, entries, senses, feed_um)

    def _settled(self, plan: Plan, number: int, entries: Entries) -> Shift:
        """Return by how much an outline is moved so that the wire beside it strays nowhere.

        Outline and path are both rounded: together that may be too much where each is not.
        """
        cut = plan.cuts[number]
        if cut.offset_um:
            alone = replace(plan, cuts=(cut,), partial=True)
            for shift in SHIFTS:
                data, findings = self._outlines(alone, entries, [shift])
                if data and not has_errors(findings) and not self._strays(data, alone, entries):
                    return shift
        return SHIFTS[0]

    def _strays(self, data: bytes, plan: Plan, entries: Entries) -> bool:
        """Return whether the judge would find the wire too far from its path."""
        from wedmcam.judge.judge import judge

        program, findings = self.read(data, "program", entries)
        if has_errors(findings):
            return False  # other places of the grid are no cure for that
        machine = self.machine
        _, findings = judge(
            replace(program, origin=plan.cuts[0].thread),
            plan,
            stepping=machine.stepping,
            limits=machine.limits,
            free_moves=machine.move_um is None,
        )
        return any(d.code in FAR and d.severity is Severity.ERROR for d in findings)

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        entered: dict[str, Any] = {
            "gap_um": entries.gap_um or 0,
            "outwards": entries.outwards,
            "leads": (entries.lead_in, entries.lead_out),
        }
        if entries.gap_um:
            entered["corner_um"] = entries.corner_um
        return self._decoded(data, file, **entered)


def _too_wide(plan: Plan, entries: Entries) -> list[Diagnostic]:
    """Return an error where the gap is more than the machine takes."""
    um = entries.gap_um or 0.0
    if um <= rows.MOST_GAP_UM:
        return []
    return [
        error(
            "gap-value",
            "a gap of {gap_mm:.3f} mm; the controller takes up to {most_mm:.3f} mm",
            plan.cuts[0].path.source_of(0),
            hint="--to compact: it states the path",
            gap_mm=um / 1000,
            most_mm=rows.MOST_GAP_UM / 1000,
        )
    ]

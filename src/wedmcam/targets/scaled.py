"""Controllers that offset an outline by scaling its arcs: 4B.

A program is the outline, and the operator enters the gap and its side. What is stated of each arc
is whether the gap makes it larger or smaller.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from wedmcam.diag import Diagnostic, Place, Severity, has_errors, note
from wedmcam.diag.run import WrongUse
from wedmcam.ir.plan import Plan, Side
from wedmcam.ir.program import Kind, Program
from wedmcam.targets import gap
from wedmcam.targets.entries import Entries
from wedmcam.targets.stated import KIN_3B, Stated

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Scaled(Stated):
    """What such formats share; ``instead``: what states the path to the same controller."""

    makes_path = True
    takes_gap = True
    instead: ClassVar[str] = "3b"

    @property
    def whole_contours(self) -> str:
        """See `Target`."""
        return "the controller moves the outline of a whole contour by the gap"

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """See `Target`."""
        return (
            note(
                "not-reachable",
                "the controller scales and rounds the arcs of this format: some gaps come out "
                "farther from the path than is allowed",
                hint="another gap by some um, or --to {instead}",
                instead=self.instead,
            ),
        )

    def moves(self, program: Program) -> bool:
        """Return whether a gap changes the path of a program: only arcs are scaled."""
        return bool((program.blocks["kind"] == Kind.ARC).any())

    def entries(self, plan: Plan) -> Entries:
        """The gap of all cuts, and its side."""
        gaps = gap.gaps(plan)
        if len(gaps) > 1:
            several = ", ".join(f"{um / 1000:.4g} mm at {place}" for um, place in gaps)
            raise WrongUse(
                f"{self.machine.format} has one gap for all cuts, and they have different offsets: "
                f"{several}"
            )
        behind = [um for um, _ in gaps if um < 0]
        if behind:
            raise WrongUse(
                f"{self.machine.format} has no gap below 0, and the clearance puts the wire "
                f"{-behind[0] / 1000:.3f} mm behind the line: --to {self.instead}"
            )
        return self._entries(gaps[0][0] if gaps else 0.0, plan.side is not Side.DIE)

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """The gap of the plan; without one the offset that is stated."""
        if plan is not None:
            return self.entries(plan)
        return self._entries(entries.every_um or 0.0, entries.outwards)

    def _entries(self, gap_um: float, outwards: bool) -> Entries:
        if abs(gap_um - round(gap_um)) > 1e-6:
            raise WrongUse(f"the gap of {self.machine.format} is whole um, not {gap_um:g}")
        return Entries(gap_um=round(gap_um), outwards=outwards)

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
        if has_errors(findings):
            return None, findings
        grows = gap.arc_growth(plan, program)
        data, more = self._encoded(program, grown=grows, **_stated(entries))
        if data and not has_errors(more):
            more = [*more, *self._torn(data, plan, entries)]
        return data, [*findings, *more]

    def _torn(self, data: bytes, plan: Plan, entries: Entries) -> list[Diagnostic]:
        """Return errors where the written outline is not tangent enough for the controller.

        Exact joints are (`gap.corners`); rounded to the grid, blocks of a few um are not.
        """
        _, findings = self.read(data, "program", entries)
        x, y = plan.cuts[0].thread
        return [
            replace(d, span=None)
            .extended(
                ", in the program that starts at {program_start}",
                program_start=Place.of_um(x, y),
            )
            .with_hint("another --corner or gap, or --to {instead}", instead=self.instead)
            for d in findings
            if d.severity is Severity.ERROR
        ]

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._decoded(data, file, **_stated(entries))

    def unstated(self, program: Program) -> list[Diagnostic]:
        """See `Target`."""
        if not self.moves(program):
            return []
        return [
            note(
                "no-gap",
                "no gap is given: what is shown is the outline; the wire runs beside it by the gap",
                hint="wedmcam convert FILE -o path.3b --gap 0.1mm makes the path of it",
            )
        ]

    def senses(self, data: bytes) -> NDArray[np.int64] | None:
        """See `Target`."""
        from wedmcam.frontends import senses

        result: NDArray[np.int64] = senses(data, self.machine)
        return result

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """See `Target`."""
        if senses is not None:
            of = senses[program.blocks["source"]]
            stated: dict[str, Any] = {"gap_um": 0, "outwards": True}
            return self._encoded(program, grown=np.where(of == 0, 1, of), **stated)
        from wedmcam.targets.outline_side import arc_growth

        notes: list[Diagnostic] = []
        if entries.gap_um is None and self.moves(program):
            notes = [
                note(
                    "no-gap",
                    "no gap is given: the program states the path of the wire as its outline",
                    hint="enter a gap of 0 at the controller; --gap 0 says that it is meant",
                )
            ]
        stated = _stated(entries)
        grows, findings = arc_growth(program, self.machine, stated["gap_um"], entries.outwards)
        if grows is not None:
            stated["grown"] = grows
            notes += findings
        elif entries.gap_um:
            return None, findings
        else:  # with a gap of 0 the path is right all the same
            notes += [replace(d, severity=Severity.WARNING) for d in findings]
        data, more = self._encoded(program, **stated)
        return data, [*notes, *more]


class B4(Scaled):
    """4B: text."""

    end = True
    kin = KIN_3B


def _stated(entries: Entries) -> dict[str, Any]:
    return {"gap_um": round(entries.gap_um or 0.0), "outwards": entries.outwards}

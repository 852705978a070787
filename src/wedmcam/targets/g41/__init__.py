"""Programs whose path depends on the controller's table of offsets: G41 and G42 D.

`write` makes outlines of a plan, with what makes all programs; `read` says what the controller
makes of them, and shares nothing with it. Here the two meet, with the table that the operator
enters.
"""

from __future__ import annotations

from collections.abc import Sequence

from wedmcam.diag import Diagnostic, error, note
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import Entries
from wedmcam.targets.g41.read import decode
from wedmcam.targets.stated import Iso


class Offsetting(Iso):
    """A controller that offsets outlines by itself: G41, G42 and D numbers."""

    makes_path = True
    moves_starts = True
    needs_lead = "G41 and G42 are taken up on a lead, and there is none in the kerf"

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """See `Target`."""
        return (
            note(
                "not-reachable",
                "the outline and the path of the controller are both rounded to its grid: some "
                "places come out farther from the path than is allowed",
                hint="a profile with more digits (iso-g41-mm), or one that does not leave the "
                "offset to the controller",
            ),
        )

    def place_starts(self, plan: Plan) -> tuple[Plan | None, Sequence[Diagnostic]]:
        """Beside a segment: it is particular about where paths start."""
        from wedmcam.targets.g41.write import grid_of
        from wedmcam.transforms import outlines

        behind = [cut for cut in plan.cuts if cut.offset_um < 0]
        if behind:
            refusal = error(
                "not-reachable",
                "the clearance puts the wire {behind_mm:.3f} mm behind the line: no D number is "
                "below 0",
                behind[0].path.source_of(0),
                hint="a profile that does not leave the offset to the controller",
                behind_mm=-behind[0].offset_um / 1000,
            )
            return None, [refusal]
        return outlines.start_beside(plan, grid_of(self.machine))

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """See `Iso.entered`; of a plan with several offsets the D numbers that a compile states."""
        entries = super().entered(entries, plan)
        if entries.d or entries.every_um is not None or plan is None:
            return entries
        return self.entries(plan) if all(cut.offset_um for cut in plan.cuts) else entries

    def entries(self, plan: Plan) -> Entries:
        """A number for each offset."""
        from wedmcam.transforms import outlines

        twice = float(self.machine.iso.entry_factor)
        offsets = outlines.numbers(plan, self.machine.iso.d)
        return self._of_table(Entries(d=tuple((n, twice * um) for n, um in offsets.items())))

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
        from wedmcam.targets.g41.write import encode

        return encode(plan, program, self.machine, entries, feed_um, sharp)

    @property
    def refuses_carried(self) -> Diagnostic | None:
        """A program from elsewhere has no outline to write."""
        return self.refuses_written or error(
            "not-in-format",
            "the profile '{profile}' wants outlines that the controller offsets, and a program has "
            "only the path of the wire",
            hint="compile the drawing with this profile, or convert with a profile that takes the "
            "path (iso-um, iso-mm)",
            profile=self.machine.name,
        )


def iso_target(machine: Machine) -> Iso:
    """Return the target of an ISO profile: of a path, or of outlines."""
    return (Offsetting if machine.iso.compensation == "controller" else Iso)(machine)


__all__ = ["Offsetting", "decode", "iso_target"]

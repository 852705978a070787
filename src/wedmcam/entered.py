"""What the operator enters beside a file: copies and an angle, a gap and its side, a table of D.

A file in the ZD-065's rotation or compensation format is a figure; the cutting program is what the
controller makes of it with these numbers (``controller.processing``). An ISO file with G41 or G42
holds outlines, and the table of D numbers says how far beside them the wire runs (``offsets``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from wedmcam.diag import Diagnostic, Severity, note
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.options import WrongUse

if TYPE_CHECKING:
    from wedmcam.frontends.dialect import Dialect

#: Formats of outlines whose arcs the controller scales by a gap.
GAPPED = ("compensation", "4b")


@dataclass(frozen=True, slots=True)
class Entered:
    """Numbers that belong to a rotation or a compensation file, or to ISO with G41 or G42.

    Attributes:
        copies: of a figure in rotation format, 0 to 99 [S].
        angle: degrees from copy to copy, counter-clockwise.
        gap_um: of a compensation or 4B file, whole um; None where nobody said it: what is read
            then is the outline, and `unstated` says so.
        outwards: True for a part (punch), False for a die.
        d: numbers and offsets of an ISO program that the controller offsets, um.
    """

    copies: int = 0
    angle: float = 0.0
    gap_um: float | None = None
    outwards: bool = True
    d: tuple[tuple[int, float], ...] = ()

    def __post_init__(self) -> None:
        if bool(self.copies) != bool(self.angle):
            raise WrongUse("--copies and --angle go together")
        if not 0 <= self.copies <= 99:
            raise WrongUse(f"--copies {self.copies}: the controller makes 1 to 99")

    def check(self, source: str, target: str) -> None:
        """Refuse what neither format takes.

        Args:
            source: format of the program that is read.
            target: format that is written.

        Raises:
            WrongUse: with what would take it.
        """
        if (self.copies or self.angle) and source != "rotation":
            raise WrongUse(f"--copies and --angle turn a figure in rotation format, not {source}")
        if self.d and source != "iso":
            raise WrongUse(f"--d is for ISO programs with G41 or G42, not for {source}")
        if not self.gap_um:
            return
        if not {source, target} & {*GAPPED}:
            raise WrongUse(
                f"--gap is for the compensation format and 4B, not for {source} to {target}"
            )
        if {source, target} <= {*GAPPED}:
            raise WrongUse(f"--gap would be applied to {source} data that stay an outline")
        if self.gap_um != round(self.gap_um) or self.gap_um < 0:
            raise WrongUse(f"--gap is a whole number of um from 0 on, not {self.gap_um:g} um")

    def decode(
        self, data: bytes, machine: Machine, file: str, dialect: Dialect | None = None
    ) -> tuple[Program, list[Diagnostic]]:
        """Return the cutting program that a file means with these numbers.

        ``dialect``: what is said of a foreign ISO program; None: its machine is known.
        """
        from wedmcam import offsets
        from wedmcam.frontends import decoder

        if machine.format == "iso":
            return offsets.decode(data, machine, file, offsets.table_of(self.d), dialect)
        made: tuple[Program, list[Diagnostic]] = decoder(machine.format)(
            data, machine, file, **self.read(machine.format)
        )
        return made

    def read(self, format_: str) -> dict[str, Any]:
        """Return what the reader of a format takes of it."""
        if format_ == "rotation":
            return {"copies": self.copies, "step": self.angle}
        if format_ in GAPPED:
            return {"gap_um": round(self.gap_um or 0.0), "outwards": self.outwards}
        return {}

    def write(
        self, program: Program, machine: Machine
    ) -> tuple[dict[str, Any] | None, list[Diagnostic]]:
        """Return what the writer of a format takes of it; None where that cannot be known."""
        if not machine.gapped:
            return {}, []
        from wedmcam.sides import grown

        gap = round(self.gap_um or 0.0)
        said: list[Diagnostic] = []
        more: dict[str, Any] = {"gap_um": gap, "outwards": self.outwards}
        if self.gap_um is None:
            what = "no gap is given: the program states the path of the wire as its outline"
            hint = "enter a gap of 0 at the controller; --gap 0 says that it is meant"
            said = [note("no-gap", what, hint=hint)] if _arcs(program) else []
        made, found = grown(program, machine, gap, self.outwards)
        if made is not None:
            return more | {"grown": made}, [*said, *found]
        if gap:
            return None, found
        # With a gap of 0 the path is right all the same.
        return more, [*said, *(replace(d, severity=Severity.WARNING) for d in found)]


def unstated(program: Program, machine: Machine) -> list[Diagnostic]:
    """Return a note that a program was read without its gap, where that makes a difference."""
    if machine.format not in GAPPED or not _arcs(program):
        return []
    what = "no gap is given: what is shown is the outline; the wire runs beside it by the gap"
    hint = "wedmcam convert FILE -o path.3b --gap 0.1mm makes the path of it"
    return [note("no-gap", what, hint=hint)]


def _arcs(program: Program) -> bool:
    return bool((program.blocks["kind"] == Kind.ARC).any())

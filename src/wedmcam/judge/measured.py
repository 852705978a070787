"""What one measure of the judge says of a program: findings, and the figures that it knows."""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.diag import Diagnostic


@dataclass(frozen=True, slots=True)
class Measured:
    """What one measure says.

    Attributes:
        findings: in the order in which they are shown.
        closures: of the measure that measures it, how far each cut ends from its start, steps; None
            for an open or a lost one.
        gouge: likewise, how deep the wire enters what is kept, steps.
        uncut: likewise, how far inner corners stay uncut, steps.
    """

    findings: list[Diagnostic]
    closures: tuple[float | None, ...] = ()
    gouge: float | None = None
    uncut: float | None = None

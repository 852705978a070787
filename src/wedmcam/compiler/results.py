"""What comes of a compile, a proof and an inspection, as values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from wedmcam.compiler.sources import Drawn, Seen, SeenWithoutUnits
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.ir.understanding import Understanding
from wedmcam.judge.verdict import Verdict
from wedmcam.machines import Machine
from wedmcam.options import Options
from wedmcam.targets import Entries


@dataclass(frozen=True, slots=True, eq=False)
class Compilation:
    """What came of a compile.

    Attributes:
        ok: a program was made and proven.
        data: its bytes; None unless ``ok``.
        program: decoded from these bytes; None unless it came so far.
        plan: what it was compared with.
        drawn: what was read.
        machine: the profile.
        verdict: the judge's figures.
        summary: the fields of the certificate, also when it failed.
        options: as asked for.
        findings: everything that was found, in order.
        stage: where it stopped; empty when ``ok``.
        lowered: the program as it was encoded: with roles and with what each block was drawn by.
        entries: what the operator enters beside the program.
        understood: what is cut and how, a row a contour; None where no plan was made.
        seen: what was read, also where it was refused; for a picture.
    """

    ok: bool
    data: bytes | None
    program: Program | None
    plan: Plan | None
    drawn: Drawn | None
    machine: Machine
    verdict: Verdict | None
    summary: dict[str, Any]
    options: Options
    findings: tuple[Diagnostic, ...]
    stage: str = ""
    lowered: Program | None = None
    entries: Entries | None = None
    understood: Understanding | None = None
    seen: Seen | SeenWithoutUnits | None = None

    @property
    def status(self) -> int:
        """The exit status: 0 done, 1 the input has errors, 3 the proof failed."""
        if self.ok:
            return 0
        return 3 if self.stage in ("decode", "verify") else 1


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What the judge found out about a program that exists.

    Attributes:
        ok: no error was found.
        program: as decoded, with its origin in the drawing.
        verdict: the figures; None when nothing could be compared.
        plan: what it was compared with; None without a drawing.
        machine: the profile it was read with.
        summary: the certificate.
        findings: everything that was found.
        status: the exit status.
        understood: what the drawing is to be, a row a contour; None without one.
    """

    ok: bool
    program: Program | None
    verdict: Verdict | None
    plan: Plan | None
    machine: Machine
    summary: dict[str, Any]
    findings: tuple[Diagnostic, ...]
    status: int
    understood: Understanding | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """What the reader saw.

    Attributes:
        drawn: segments, contours, nesting; None where the drawing was refused.
        facts: plain data for a table or for JSON.
        findings: everything that was found.
        seen: what was read, also where it was refused; for a picture.
    """

    drawn: Drawn | None
    facts: dict[str, Any]
    findings: tuple[Diagnostic, ...] = field(default=())
    seen: Seen | SeenWithoutUnits | None = None

    @property
    def status(self) -> int:
        """The exit status."""
        return 1 if has_errors(self.findings) else 0

"""The summary of a compile or a proof as plain data: the fields of the certificate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from wedmcam import __version__, machines
from wedmcam.compiler.sources import Drawn
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.diag.run import Run
from wedmcam.ir.plan import Plan
from wedmcam.ir.understanding import Understanding
from wedmcam.judge.certificate import (
    CertifiedProgram,
    CertifiedSource,
    certificate,
    finding_data,
    fingerprint,
)
from wedmcam.judge.verdict import Verdict
from wedmcam.machines import Machine
from wedmcam.machines.write import as_toml
from wedmcam.machines.write import fingerprint as profile_fingerprint
from wedmcam.options import Options
from wedmcam.programs.understanding import understood
from wedmcam.targets.entries import Entries


def understood_of(plan: Plan | None) -> Understanding | None:
    """Return what was understood; None where nothing was planned."""
    return None if plan is None else understood(plan)


@dataclass(frozen=True, slots=True, eq=False)
class Files:
    """The files that a summary is of.

    Attributes:
        source_name: of the drawing or part program; empty for none.
        source: its bytes.
        program_name: empty where none is written.
        program: its bytes; None where there is none.
        entered: what the operator enters beside it.
    """

    source_name: str
    source: bytes
    program_name: str
    program: bytes | None
    entered: Entries | None = None


def summary_of(
    findings: list[Diagnostic],
    machine: Machine,
    options: Options,
    files: Files,
    drawn: Drawn | None,
    verdict: Verdict | None,
    understood: Understanding | None,
) -> dict[str, Any]:
    """Return the certificate, or what is known of it when there is no verdict."""
    rows = None if understood is None else understood.as_data()
    units = drawn.sketch.info.units if drawn else None
    if verdict is None:
        return {
            "input": files.source_name,
            "output": None,
            "format": machine.format,
            "units": units,
            "origin_um": None,
            "contours": None,
            "blocks": None,
            "steps": None,
            "closure_um": None,
            "max_deviation_um": None,
            "gouge_um": None,
            "offset_um": options.cutting.offset_um or 0.0,
            "side": str(options.cutting.effective_side),
            "diagnostics": [finding_data(d) for d in findings],
            "ok": False,
            "understood": rows,
            "arithmetic": options.arithmetic,
            "sha256": {"input": fingerprint(files.source)},
        }

    result = certificate(
        verdict,
        findings,
        CertifiedSource(
            files.source_name,
            files.source,
            units or "",
            join_um=drawn.report.max_shift_um if drawn else 0.0,
            spline_um=drawn.sketch.info.extra.get("spline_um", 0.0) if drawn else 0.0,
        ),
        CertifiedProgram(
            files.program_name,
            files.program or b"",
            machine.format,
            profile=machine.name,
            profile_sha256=profile_fingerprint(machine),
        ),
        options=options.as_data(),
        version=__version__,
    )
    result["understood"] = rows
    result["arithmetic"] = options.arithmetic
    step = machine.axes.step_um
    result["step_um"] = int(step) if step == int(step) else step
    if not machines.is_builtin(machine):
        # The file may be gone or changed when the program is proven again.
        result["profile_toml"] = as_toml(machine)
    if options.operator.d:  # what is entered at the controller belongs to the program
        result["d_um"] = {str(number): um for number, um in options.operator.d}
        if machine.iso.entry_factor == 2:
            result["d_is"] = "diameter"
    if files.entered is not None and files.entered.turns:
        result["entered"] = files.entered.as_data()
    if files.program is None or not files.program_name:
        result["output"] = None
    result["ok"] = files.program is not None
    return result


def proof_summary(
    run: Run,
    machine: Machine,
    options: Options,
    files: Files,
    drawn: Drawn | None,
    figures: dict[str, Any],
    verdict: Verdict | None,
    understood: Understanding | None,
) -> dict[str, Any]:
    """Return the summary of a proof: the certificate, or the figures of the program alone.

    ``figures``: of the program where there is no drawing; other arguments as `summary_of`.
    """
    if verdict is not None:
        summary = summary_of(run.findings, machine, options, files, drawn, verdict, understood)
        summary["ok"] = not has_errors(run.findings)
        return summary
    unproven = replace(files, program=None)
    summary = summary_of(run.findings, machine, options, unproven, drawn, None, understood)
    summary |= {
        "input": files.source_name or None,
        "output": files.program_name,
        "side": None,
        "offset_um": None,
    }
    summary |= figures
    if files.entered is not None and files.entered.turns:
        summary["entered"] = files.entered.as_data()
    if not files.source:
        del summary["sha256"], summary["arithmetic"]  # nothing was computed
        summary["ok"] = not has_errors(run.findings)
    return summary

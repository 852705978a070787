"""Prove a program that exists: run it on its controller, and compare it with its drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from wedmcam.backends.axes import to_controller
from wedmcam.compiler import pipeline, proof, sources
from wedmcam.compiler.portion import portion
from wedmcam.compiler.results import Proof
from wedmcam.compiler.sources import Drawn
from wedmcam.compiler.summary import proof_summary, summary_of, understood_of
from wedmcam.diag import Diagnostic, error, has_errors, note, warning
from wedmcam.diag.run import Refused, Run
from wedmcam.files import Source, bytes_of
from wedmcam.formats.quadrants import quadrant
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.certificate import finding_data
from wedmcam.judge.claims import fault
from wedmcam.judge.closing import not_closed
from wedmcam.judge.totals import figures as figures_of
from wedmcam.judge.verdict import Verdict
from wedmcam.machines import Machine
from wedmcam.operations.images import metamorphic
from wedmcam.operations.profiles import (
    machine_issued,
    reader_machine,
    targets_of,
)
from wedmcam.operations.read import NO_GAP, dialect_of
from wedmcam.options import Options, WrongUse, options_in_mm
from wedmcam.targets import Entries, Target


def verify(
    program: Source,
    *,
    against: Source | None = None,
    profile: Machine | str | None = None,
    format: str | None = None,
    name: str | None = None,
    against_name: str | None = None,
    origin_mm: tuple[float, float] | None = None,
    fit_origin: bool = False,
    certificate: dict[str, Any] | None = None,
    options: Options | None = None,
    shown: bool = False,
    **mm: Any,
) -> Proof:
    """Decode a program, run it on its controller, and compare it with a drawing.

    Args:
        program: a path or bytes.
        against: the drawing; None only decodes, runs and tells the figures.
        profile: of the program; None for that of the certificate, else the default of its format.
            An ISO program then has to say itself what its numbers mean, or the options
            ``units_in``, ``whole_in``, ``coordinates_in``, ``centres_in``, ``semicolon_in``,
            ``subprograms_in`` do.
        format: of the program; None to tell by its name and its content.
        name: of the program in findings.
        against_name: of the drawing.
        origin_mm: where the program starts in the drawing. None: where the same options start it,
            else on one of the thread points that are given. Only where none is given, a translation
            is fitted.
        fit_origin: a translation is fitted also where thread points are given.
        certificate: of an earlier compile; gives options and origin. All that it says is derived
            again and compared.
        options: how the drawing is cut; None for those of ``mm``, else of the certificate.
        shown: the program is only to be drawn: what it leaves open is assumed, with a warning.
        **mm: instead of ``options``, its fields in mm.

    What is proven is the part: another order, other leads, are notes. A program with a certificate
    of a compile is one of ours: order and leads are to be the plan's.

    Raises:
        WrongUse: options that do not fit together, or a certificate that is none.
    """
    data, name = bytes_of(program, name)
    if certificate is not None:
        options = _options_issued(certificate, options, mm)
        if profile is None:
            profile = machine_issued(certificate)
    if fit_origin and origin_mm is not None:
        raise WrongUse("--origin says where the program starts: there is nothing to fit")
    machine = reader_machine(data, name, format, profile)
    if options is None:
        options = options_in_mm(**mm)
    dialect = dialect_of(options.reading, profile is not None, shown)
    run = Run(options.strict)
    planning = Run(options.strict)
    targets = targets_of(machine, certificate)
    target = targets[0]
    decoded: Program | None = None
    plan: Plan | None = None
    verdict: Verdict | None = None
    drawn: Drawn | None = None
    told: dict[str, Any] = {}
    drawing, drawing_name = (b"", "") if against is None else bytes_of(against, against_name)
    stage = ""
    try:
        # An outline's program does not say how far beside it the wire runs; the plan does.
        if against is not None and (target.takes_gap or target.makes_path):
            drawn, plan = _asked_plan(drawing, drawing_name, options, targets, planning, run)
        entries = replace(target.entered(options, plan), dialect=dialect)
        run.add("decode", _offsets_of_plan(entries, target, options))
        decoded, read = target.read(data, name, entries)
        decoded = run("decode", (decoded, read))
        kind = sources.source_format(drawing, drawing_name, options) if drawn else None
        run.add("decode", _no_gap(decoded, target, options, kind))
        run.add("decode", _unended(decoded, target))
        if against is not None:
            if drawn is None or plan is None:
                drawn, plan = _asked_plan(drawing, drawing_name, options, targets, planning, run)
            ours = certificate is not None and proof.is_ours(certificate)
            if certificate is not None:
                run.add("certificate", proof.issued_for_others(certificate, data, drawing))
                # Where a program of ours starts follows from its plan, and is compared.
                if origin_mm is None and not ours and proof.is_of(certificate, "output", data):
                    x, y = certificate["origin_um"]
                    origin_mm = (x / 1000, y / 1000)
            how = proof.Placing(
                None if origin_mm is None else (1000 * origin_mm[0], 1000 * origin_mm[1]),
                proof.given_points(drawn, options),
                fit_origin,
                ours,
            )
            before = len(run.found)
            decoded, verdict = proof.placed(decoded, plan, target, options, how, run)
            if certificate is not None:
                now = summary_of(
                    run.found,
                    machine,
                    options,
                    drawing_name,
                    drawing,
                    name,
                    data,
                    drawn,
                    verdict,
                    understood_of(plan),
                )
                run.add(
                    "certificate",
                    proof.held_to(
                        certificate,
                        now,
                        proof.Proven(decoded, data, drawing, plan, target, options),
                        planning.found,
                        read,
                        run.found[before:],
                        run.found,
                    ),
                )
        else:
            told, found = figures_of(decoded, machine.stepping, machine.limits)
            run.add("verify", found)
            run.add("verify", _not_closed(decoded, target, options))
            if certificate is not None:
                run.add("certificate", proof.held_to_alone(certificate, told, data))
    except Refused as why:
        stage = why.stage
    errors = has_errors(run.found)
    status = 0 if not errors else (3 if stage in ("verify", "certificate") else 1)
    known = understood_of(plan)
    summary = proof_summary(
        run, machine, options, name, data, drawing_name, drawing, drawn, told, verdict, known
    )
    if verdict is not None and certificate is None:
        summary["leads"] = "own"  # so order and leads are not held to the plan's next time either
    said = tuple(run.found)
    return Proof(not errors, decoded, verdict, plan, machine, summary, said, status, known)


def with_images(proven: Proof, drawing: bytes, name: str, options: Options) -> Proof:
    """Return a proof with that of the images of the drawing; see ``wedmcam.operations.images``."""
    if sources.source_format(drawing, name, options) == "wed":
        raise WrongUse("--metamorphic compiles images of drawings; a .wed says sides by name")

    images, found = metamorphic(drawing, name, proven.machine, options)
    said = {(d.code, d.message) for d in proven.findings}
    new = [d for d in found if (d.code, d.message) not in said]
    bad = has_errors(new)
    summary = {
        **proven.summary,
        "metamorphic": [image._asdict() for image in images],
        "diagnostics": [*proven.summary["diagnostics"], *(finding_data(d) for d in new)],
        "ok": proven.ok and not bad,
    }
    return replace(
        proven,
        ok=proven.ok and not bad,
        summary=summary,
        findings=(*proven.findings, *new),
        status=proven.status or (3 if bad else 0),
    )


def _asked_plan(
    drawing: bytes,
    name: str,
    options: Options,
    targets: Sequence[Target],
    planning: Run,
    run: Run,
) -> tuple[Drawn, Plan]:
    """Return what was drawn, and the part of its plan that is asked for of the first target.

    What is found goes into both runs; ``planning`` has nothing else.
    """
    try:
        drawn, plan = pipeline.planned(drawing, name, options, targets, planning)
        plan = portion(plan, targets[0], options, planning)
    finally:
        run.found += planning.found
    return drawn, plan


def _offsets_of_plan(entries: Entries, target: Target, options: Options) -> list[Diagnostic]:
    """Return a note of the offsets that are assumed of a controller, where none are stated."""
    if not target.makes_path or options.d or options.offset_um is not None:
        return []
    table = [f"{number} = {length}" for number, length in entries.lines()]
    if entries.every_um is not None:
        entry = f"{(1 + entries.diameter) * entries.every_um / 1000:.4f} mm"
        table.append(f"every {entries.letter} = {entry}{' (diameter)' * entries.diameter}")
    if not table:
        return []
    text = f"{', '.join(table)} is taken to be entered at the controller: the offsets of the source"
    return [note("iso-compensation", text, hint="--d N=LENGTH states what is entered")]


def _no_gap(
    decoded: Program, target: Target, options: Options, against: str | None
) -> list[Diagnostic]:
    """Return the findings for a program that was read without its gap.

    ``against``: format of the source that it is compared with, if any: a part program says its
    offsets itself.
    """
    stated = options.offset_um is not None or options.side is not None or against == "wed"
    found = [] if stated else target.unstated(decoded)
    if against is None or not found:
        return found
    hint = "--offset 0.1mm, the gap that is entered at the controller; --side on for none"
    return [error("no-gap", NO_GAP, hint=hint)]


def _options_issued(
    certificate: dict[str, Any], options: Options | None, mm: Mapping[str, Any]
) -> Options:
    """Return the options of a proof: as stated, else those of the certificate.

    Raises:
        WrongUse: the certificate is none, or has options that this version does not know.
    """
    if why := fault(certificate):
        raise WrongUse(f"this is no certificate: {why}")
    issued = Options.from_data(certificate["options"])
    if options is not None:
        return options
    return options_in_mm(**mm) if mm else issued


def _unended(program: Program, target: Target) -> list[Diagnostic]:
    """Return a warning when a text program does not say where it ends."""
    kinds = program.blocks["kind"]
    stop = target.stop_word
    if not stop or ((kinds == Kind.STOP) | (kinds == Kind.END)).any():
        return []
    return [
        warning(
            "no-end",
            f"the program has no stop ({stop}): some controllers run on into what "
            "their memory still holds",
            program.spans[-1] if len(program.spans) else None,
            hint=f"end it with {stop}",
        )
    ]


def _not_closed(program: Program, target: Target, options: Options) -> list[Diagnostic]:
    """Return warnings for the contours of a program that do not close, in the words of its file."""
    machine = target.machine
    own = to_controller(program, machine.axes)
    textbook = (options.count or machine.count) == "textbook"
    return not_closed(
        own, machine.own_stepping, quadrant if target.states_counts else None, textbook
    )

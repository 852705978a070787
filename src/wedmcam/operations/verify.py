"""Prove a program that exists: run it on its controller, and compare it with its drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

from wedmcam.backends.axes import to_controller
from wedmcam.compiler import pipeline, proof, sources
from wedmcam.compiler.portion import portion
from wedmcam.compiler.results import Proof
from wedmcam.compiler.sources import Drawn
from wedmcam.compiler.summary import Files, proof_summary, summary_of, understood_of
from wedmcam.diag import Diagnostic, error, has_errors, note, warning
from wedmcam.diag.run import Refused, Run, WrongUse
from wedmcam.files import Source, bytes_of
from wedmcam.formats.quadrants import quadrant
from wedmcam.frontends.iso.dialect import Dialect
from wedmcam.ir.plan import Plan, Side
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
from wedmcam.options import Options, take_options
from wedmcam.targets import Entries, Target


def verify(
    program: Source,
    *,
    against: Source | None = None,
    profile: Machine | str | None = None,
    format: str | None = None,
    name: str | None = None,
    against_name: str | None = None,
    certificate: dict[str, Any] | None = None,
    options: Options | None = None,
    **more: Any,
) -> Proof:
    """Decode a program, run it on its controller, and compare it with a drawing.

    Args:
        program: a path or bytes.
        against: the drawing; None only decodes, runs and returns the figures.
        profile: of the program; None for that of the certificate, else the default of its format.
            An ISO program then has to say itself what its numbers mean, or the options
            ``units_in``, ``whole_in``, ``coordinates_in``, ``centres_in``, ``semicolon_in``,
            ``subprograms_in`` do.
        format: of the program; None to tell by its name and its content.
        name: of the program in findings.
        against_name: of the drawing.
        certificate: of an earlier compile; gives options and origin. All that it says is derived
            again and compared.
        options: how the drawing is cut; None for those of ``more``, else of the certificate.
        **more: ``origin_mm``, ``fit_origin``, ``entered`` and ``shown``, the fields of
            `Circumstances`; all others are fields of the options in mm, instead of ``options``.

    What is proven is the part: another order, other leads, are notes. A program with a certificate
    of a compile is one of ours: order and leads are to be the plan's.

    Raises:
        WrongUse: options that do not fit together, or a certificate that is none.
    """
    data, name = bytes_of(program, name)
    here, mm = Circumstances.taken_from(more)
    if mm or options is not None:
        options = take_options(options, mm)
    if certificate is not None:
        options = _options_issued(certificate, options)
        if profile is None:
            profile = machine_issued(certificate)
    if here.fit_origin and here.origin_mm is not None:
        raise WrongUse("--origin says where the program starts: there is nothing to fit")
    machine = reader_machine(data, name, format, profile)
    entered = here.entered or Entries.from_data((certificate or {}).get("entered", {}))
    entered.check(machine.format, machine.format)
    if options is None:
        options = Options()
    drawing, drawing_name = (None, "") if against is None else bytes_of(against, against_name)
    case = _Case(
        data,
        name,
        dialect_of(options.program.answers, profile is not None, here.shown),
        targets_of(machine, certificate),
        options,
        drawing,
        drawing_name,
        certificate,
        here,
        entered,
    )
    return _proof_of(case)


@dataclass(frozen=True, slots=True)
class Circumstances:
    """What is known of a program beside its text and its options.

    Attributes:
        origin_mm: where the program starts in the drawing. None: where the same options start it,
            else on one of the thread points that are given. Only where none is given, a translation
            is fitted.
        fit_origin: a translation is fitted also where thread points are given.
        entered: what the operator enters for a figure in rotation format; None for what the
            certificate says.
        shown: the program is only to be drawn: what it leaves open is assumed, with a warning.
    """

    origin_mm: tuple[float, float] | None = None
    fit_origin: bool = False
    entered: Entries | None = None
    shown: bool = False

    @classmethod
    def taken_from(cls, keywords: Mapping[str, Any]) -> tuple[Circumstances, dict[str, Any]]:
        """Return the circumstances among some keywords, and the other keywords."""
        own = {f.name for f in fields(cls)}
        return (
            cls(**{k: v for k, v in keywords.items() if k in own}),
            {k: v for k, v in keywords.items() if k not in own},
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Case:
    """A program to be proven, and what it is proven with.

    Attributes:
        data, name: the program.
        dialect: what the options state of an ISO program beside its text.
        targets: that of the program, and that whose starts the plan has.
        options: how the drawing is cut.
        drawing, drawing_name: what it is compared with; None for nothing.
        certificate: of an earlier compile.
        here: where it starts, and what for it is read.
        entered: what the operator enters for a figure in rotation format.
    """

    data: bytes
    name: str
    dialect: Dialect
    targets: Sequence[Target]
    options: Options
    drawing: bytes | None
    drawing_name: str
    certificate: dict[str, Any] | None
    here: Circumstances
    entered: Entries

    @property
    def target(self) -> Target:
        """The target of the program."""
        return self.targets[0]

    @property
    def files(self) -> Files:
        """Both files and what is entered, for a summary."""
        drawing = self.drawing or b""
        return Files(self.drawing_name, drawing, self.name, self.data, self.entered)


@dataclass(slots=True, eq=False)
class _Evidence:
    """What is known of a case so far: it stays so where a stage refuses.

    Attributes:
        program: as decoded; at its place in the drawing once that is known.
        entries: what the operator enters for it.
        read: findings of the reader.
        drawn, plan: of the drawing.
        verdict: on the program along its plan.
        figures: of the program by itself, where there is no drawing.
    """

    program: Program | None = None
    entries: Entries | None = None
    read: Sequence[Diagnostic] = ()
    drawn: Drawn | None = None
    plan: Plan | None = None
    verdict: Verdict | None = None
    figures: dict[str, Any] = field(default_factory=dict)


def _proof_of(case: _Case) -> Proof:
    """Return the proof of a case: whatever came of it until a stage refused."""
    run, planning = Run(case.options.judging.strict), Run(case.options.judging.strict)
    known, stage = _Evidence(), ""
    try:
        program = _decode(case, known, planning, run)
        if case.drawing is None:
            _measure_alone(case, known, program, run)
        else:
            _compare(case, known, program, planning, run)
    except Refused as why:
        stage = why.stage
    errors = has_errors(run.findings)
    machine, understood = case.target.machine, understood_of(known.plan)
    summary = proof_summary(
        run,
        machine,
        case.options,
        case.files,
        known.drawn,
        known.figures,
        known.verdict,
        understood,
    )
    if known.verdict is not None and case.certificate is None:
        summary["leads"] = "own"  # so order and leads are not held to the plan's next time either
    return Proof(
        not errors,
        known.program,
        known.verdict,
        known.plan,
        machine,
        summary,
        tuple(run.findings),
        0 if not errors else 3 if stage in ("verify", "certificate") else 1,
        understood,
    )


def _decode(case: _Case, known: _Evidence, planning: Run, run: Run) -> Program:
    """Read the program as its operator would enter it, and report what it leaves open."""
    target, options = case.target, case.options
    # An outline's program does not say how far beside it the wire runs; the plan does.
    if case.drawing is not None and (target.takes_gap or target.makes_path):
        _plan(case, known, planning, run)
    stated = _stated_entries(options, case.entered)
    entries = replace(target.entered(stated, known.plan), dialect=case.dialect)
    known.entries = entries
    run.add("decode", _offsets_of_plan(entries, target, options))
    # What is refused is known too: a picture shows what was read.
    known.program, known.read = target.read(case.data, case.name, entries)
    program = run("decode", (known.program, known.read))
    drawing = case.drawing if known.drawn else None
    kind = None
    if drawing is not None:
        kind = sources.source_format(drawing, case.drawing_name, options.drawing.source)
    run.add("decode", _no_gap(program, target, options, kind))
    run.add("decode", _unended(program, target))
    return program


def _plan(case: _Case, known: _Evidence, planning: Run, run: Run) -> tuple[Drawn, Plan]:
    """Plan the drawing, and the part of it that the options want of the first target.

    Findings go into both runs; ``planning`` has no others.
    """
    try:
        drawn, plan = pipeline.plan_source(
            case.drawing or b"", case.drawing_name, case.options, case.targets, planning
        )
        plan = portion(plan, case.target, case.options, planning)
    finally:
        run.findings += planning.findings
    known.drawn, known.plan = drawn, plan
    return drawn, plan


def _compare(case: _Case, known: _Evidence, program: Program, planning: Run, run: Run) -> None:
    """Judge the program against the plan of its drawing, and hold it to its certificate."""
    target, options, certificate = case.target, case.options, case.certificate
    drawing = case.drawing or b""
    if known.drawn is None or known.plan is None:
        drawn, plan = _plan(case, known, planning, run)
    else:
        drawn, plan = known.drawn, known.plan
    followed = plan
    if known.entries is not None:
        followed = run("verify", target.on_contour(plan, known.entries))
    origin_mm = case.here.origin_mm
    ours = certificate is not None and proof.is_ours(certificate)
    if certificate is not None:
        run.add("certificate", proof.issued_for_others(certificate, case.data, drawing))
        # Where a program of ours starts follows from its plan, and is compared.
        if origin_mm is None and not ours and proof.is_of(certificate, "output", case.data):
            x, y = certificate["origin_um"]
            origin_mm = (x / 1000, y / 1000)
    placing = proof.Placing(
        None if origin_mm is None else (1000 * origin_mm[0], 1000 * origin_mm[1]),
        proof.given_points(drawn, options),
        case.here.fit_origin,
        ours or plan.others is not None,  # a load is of the program that is compiled
    )
    before = len(run.findings)
    program, verdict = proof.place_program(program, followed, target, options, placing, run)
    known.program, known.verdict = program, verdict
    if certificate is None:
        return
    now = summary_of(
        run.findings,
        target.machine,
        options,
        case.files,
        drawn,
        verdict,
        understood_of(plan),
    )
    run.add(
        "certificate",
        proof.check_certificate(
            certificate,
            now,
            proof.Proven(program, case.data, drawing, plan, target, options),
            planning.findings,
            known.read,
            run.findings[before:],
            run.findings,
        ),
    )


def _measure_alone(case: _Case, known: _Evidence, program: Program, run: Run) -> None:
    """Measure what the program does by itself, and hold its certificate to that."""
    machine = case.target.machine
    known.figures, findings = figures_of(program, machine.stepping, machine.limits)
    if machine.counts_speed:
        del known.figures["limits"]["count_um"]
    run.add("verify", findings)
    run.add("verify", _not_closed(program, case.target, case.options))
    if case.certificate is not None:
        run.add(
            "certificate", proof.check_certificate_alone(case.certificate, known.figures, case.data)
        )


def with_images(proven: Proof, drawing: bytes, name: str, options: Options) -> Proof:
    """Return a proof with that of the images of the drawing; see ``wedmcam.operations.images``."""
    if sources.source_format(drawing, name, options.drawing.source) == "wed":
        raise WrongUse("--metamorphic compiles images of drawings; a .wed says sides by name")

    images, findings = metamorphic(drawing, name, proven.machine, options)
    before = {(d.code, d.message) for d in proven.findings}
    new = [d for d in findings if (d.code, d.message) not in before]
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


def _stated_entries(options: Options, entered: Entries) -> Entries:
    """Return what the operator enters, as far as options and ``entered`` state it."""
    cutting = options.cutting
    outwards = cutting.effective_side is not Side.DIE
    return replace(
        entered,
        d=options.operator.d,
        every_um=cutting.offset_um,
        outwards=outwards,
        corner_um=cutting.corner_um or None,
    )


def _offsets_of_plan(entries: Entries, target: Target, options: Options) -> list[Diagnostic]:
    """Return a note of the offsets that are assumed of a controller, where none are stated."""
    if not target.makes_path or options.operator.d or options.cutting.offset_um is not None:
        return []
    table = [f"{number} = {length}" for number, length in entries.lines()]
    if entries.every_um is not None:
        entry = f"{(1 + entries.diameter) * entries.every_um / 1000:.4f} mm"
        table.append(f"every {entries.letter} = {entry}{' (diameter)' * entries.diameter}")
    if not table:
        return []
    return [
        note(
            "iso-compensation",
            "{offsets} is taken to be entered at the controller: the offsets of the source",
            hint="--d N=LENGTH states what is entered",
            offsets=", ".join(table),
        )
    ]


def _no_gap(
    decoded: Program, target: Target, options: Options, against: str | None
) -> list[Diagnostic]:
    """Return the findings for a program that was read without its gap.

    ``against``: format of the source that it is compared with, if any: a part program says its
    offsets itself.
    """
    cutting = options.cutting
    stated = cutting.offset_um is not None or cutting.side is not None or against == "wed"
    findings = [] if stated else target.unstated(decoded)
    if against is None or not findings:
        return findings
    hint = "--offset 0.1mm, the gap that is entered at the controller; --side on for none"
    return [error("no-gap", NO_GAP, hint=hint)]


def _options_issued(certificate: dict[str, Any], options: Options | None) -> Options:
    """Return the options of a proof: as stated, else those of the certificate.

    Raises:
        WrongUse: the certificate is none, or has options that this version does not know.
    """
    if why := fault(certificate):
        raise WrongUse(f"this is no certificate: {why}")
    issued = Options.from_data(certificate["options"])
    if options is None:
        options = issued
    if options.operator.d:
        return options
    # What is entered belongs to the program: where nothing is stated, as it was issued.
    return options.with_values(d=issued.operator.d)


def _unended(program: Program, target: Target) -> list[Diagnostic]:
    """Return a warning when a text program does not say where it ends."""
    kinds = program.blocks["kind"]
    stop = target.stop_word
    if not stop or ((kinds == Kind.STOP) | (kinds == Kind.END)).any():
        return []
    return [
        warning(
            "no-end",
            "the program has no stop ({stop}): some controllers run on into what their memory "
            "still holds",
            program.spans[-1] if len(program.spans) else None,
            hint="end it with {stop}",
            stop=stop,
        )
    ]


def _not_closed(program: Program, target: Target, options: Options) -> list[Diagnostic]:
    """Return warnings for the contours of a program that do not close, in the words of its file."""
    machine = target.machine
    own = to_controller(program, machine.axes)
    textbook = (options.judging.count or machine.count) == "textbook"
    return not_closed(
        own, machine.own_stepping, quadrant if target.states_counts else None, textbook
    )

"""The library: what the command line calls, and what anybody may call.

These functions take bytes or a path, and return values; they print nothing and write nothing. A
path is read here and nowhere deeper.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wedmcam import __version__, machines
from wedmcam.compiler import pipeline, proof, sources
from wedmcam.compiler.portion import portion
from wedmcam.compiler.sources import Drawn, Seen, SeenWithoutUnits
from wedmcam.diag import Diagnostic, EntityRef, Severity, has_errors
from wedmcam.diag.run import Refused, Run
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.ir.understanding import Understanding
from wedmcam.machines import Machine
from wedmcam.options import READING, Options, WrongUse, check_reading, nm_of
from wedmcam.targets import Entries, Target, target_of

if TYPE_CHECKING:
    from wedmcam.frontends.iso.dialect import Dialect
    from wedmcam.judge.difference import Difference
    from wedmcam.judge.verdict import Verdict

Source = str | Path | bytes


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


def compile(
    source: Source,
    *,
    to: str | None = None,
    profile: Machine | str | None = None,
    name: str | None = None,
    output_name: str = "",
    options: Options | None = None,
    observe: Callable[[str, Any], None] | None = None,
    **mm: Any,
) -> Compilation:
    """Compile a drawing and prove the program.

    Args:
        source: a path, or the bytes of a DXF drawing.
        to: "3b" (default) or "compact".
        profile: a machine, or the name of a built-in one; None for the format's default. Where that
            was another one release ago, a note says so.
        name: of the source in findings and certificate; the path by default.
        output_name: of the program in the certificate.
        options: everything else, in um.
        observe: is called with the name and the value of each stage that came through.
        **mm: instead of ``options``, its fields in mm: offset=0.1, side="die", starts=[(0, 0)].

    Raises:
        WrongUse: options that do not fit together.
        OSError: the path cannot be read.

    Example::

        made = wedmcam.compile("bracket.dxf", offset=0.1)
        if made.ok:
            Path("bracket.3b").write_bytes(made.data)
    """
    data, name = bytes_of(source, name)
    machine = machine_for(to, profile)
    options = options if options is not None else options_in_mm(**mm)
    if options.reading:
        raise WrongUse(
            f"{', '.join(options.reading)}: said of a program that is read, not compiled"
        )
    run = Run(options.strict, observe=observe)
    refused = planned_for(data, name, options, [machine], run)
    named = profile is not None
    return compile_plan(data, name, machine, options, run, output_name, refused, named=named)


def planned_for(
    data: bytes, name: str, options: Options, machines: Sequence[Machine], run: Run
) -> str:
    """Read and plan a source for machines; ``run`` keeps both. Return where it was refused, if."""
    try:
        pipeline.planned(data, name, options, [target_of(m) for m in machines], run)
    except Refused as why:
        return why.stage
    return ""


def compile_plan(
    data: bytes,
    name: str,
    machine: Machine,
    options: Options,
    run: Run,
    output_name: str = "",
    refused: str = "",
    *,
    named: bool = True,
) -> Compilation:
    """Compile what is asked for of a plan for one machine, and prove the program.

    Args:
        data: the source, for its fingerprint.
        name: of the source.
        machine: one of those that the plan was made for.
        options: as it was planned with; ``cuts`` and ``from_block`` may be others.
        run: in which `planned_for` left what was drawn and the plan.
        output_name: of the program.
        refused: where planning stopped; then nothing is compiled.
        named: the machine was named, and is not just the default of its format.
    """
    target, stage, made = target_of(machine), refused, run.values
    if not stage:
        try:
            part = run("plan", (portion(made["plan"], target, options, run), ()))
            pipeline.compiled(part, target, options, run, output_name)
            run.add("verify", [] if named else machines.unnamed(machine))
        except Refused as why:
            stage = why.stage
    entries, verdict = made.get("enter"), made.get("verify")
    if entries is not None and entries.d:  # belongs to the program
        options = replace(options, d=entries.d)
    ok, drawn = not stage, made.get("drawn")
    known = _understood(made.get("plan"))
    out = made["encode"] if ok else None
    return Compilation(
        ok,
        out,
        made.get("decode") if ok else None,
        made.get("plan"),
        drawn,
        machine,
        verdict if ok else None,
        _summary(
            run.found,
            machine,
            options,
            name,
            data,
            output_name,
            out,
            drawn,
            verdict if ok else None,
            known,
        ),
        options,
        tuple(run.found),
        stage,
        made.get("lower"),
        entries,
        known,
        made.get("seen"),
    )


def _understood(plan: Plan | None) -> Understanding | None:
    """Return what was understood; None where nothing was planned."""
    from wedmcam.programs.understanding import understood

    return None if plan is None else understood(plan)


def source_map(made: Compilation) -> dict[str, Any]:
    """Return which block was drawn by what, as plain data (docs/map.md)."""
    from wedmcam.reports.source_map import source_map as map_of

    if not made.ok or made.lowered is None or made.program is None:
        raise WrongUse("a map is of a proven program")
    return map_of(made.lowered, made.program, made.machine, summary=made.summary)


def arithmetic_difference(made: Compilation, source: Source) -> float | None:
    """Return by how much the wire path would differ in the other arithmetic, um.

    Args:
        made: a compile; `compile` tells in ``summary["arithmetic"]`` in what it was computed.
        source: what was compiled, a path or bytes.

    Returns:
        The largest distance between the exact paths; None where one of them does not exist.

    >>> made = compile(path := "samples/cover.dxf", offset=0.1)  # doctest: +SKIP
    >>> arithmetic_difference(made, path)  # doctest: +SKIP
    0.0027
    """
    from wedmcam.operations.arithmetics import difference_um

    if made.drawn is None or made.plan is None:
        return None
    data, name = bytes_of(source, made.summary["input"])
    apart = difference_um(data, name, made.drawn, made.plan, made.options)
    return None if apart is None else round(apart, 4)


def options_in_mm(**mm: Any) -> Options:
    """Return `Options` from keywords in mm: a length ``x`` stands for the field ``x_um``.

    >>> options_in_mm(offset=0.1, side="die", starts=[(1, 2)]).starts_um
    ((1000.0, 2000.0),)

    Raises:
        WrongUse: an unknown keyword or value.
    """
    values: dict[str, Any] = {}
    known = set(Options.__dataclass_fields__)
    for key, value in mm.items():
        if key == "starts":
            values["starts_um"] = [(1000.0 * x, 1000.0 * y) for x, y in value]
        elif key == "layer_offsets":
            pairs = value.items() if isinstance(value, Mapping) else value
            values[key] = [(layer, 1000.0 * mm) for layer, mm in pairs]
        elif f"{key}_um" in known:
            if value is not None and not isinstance(value, int | float):
                raise WrongUse(f"{key}={value!r} is no length in mm")
            values[f"{key}_um"] = None if value is None else 1000.0 * value
        else:
            values[key] = value
    return Options.from_data(values)


def machine_for(to: str | None, profile: Machine | str | None) -> Machine:
    """Return the machine of a format and a profile.

    Raises:
        WrongUse: an unknown one, or a profile of another format.
    """
    if isinstance(profile, str):
        machine, found = machines.find(profile)
        if machine is None:
            hint = f" ({found[0].hint})" if found[0].hint else ""
            raise WrongUse(found[0].message + hint)
        profile = machine
    if profile is None:
        try:
            return machines.default(to or "3b")
        except KeyError:
            raise WrongUse(f"no program format is called '{to}'") from None
    if to is not None and not profile.is_of(to):
        raise WrongUse(f"the profile '{profile.name}' is for {profile.format}, not for {to}")
    return profile


def machine_issued(certificate: dict[str, Any]) -> Machine:
    """Return the machine that a certificate was issued for; it holds what is not built in.

    Raises:
        WrongUse: it names a profile that is not there.
    """
    name, text = str(certificate["profile"]), certificate.get("profile_toml")
    if text is None:
        return machine_for(None, name)
    machine, found = machines.parse(str(text), name)
    if machine is None:
        raise WrongUse(f"the certificate's profile '{name}' cannot be used: {found[0].message}")
    return machine


def starts_of(machine: Machine) -> dict[str, Any]:
    """Return what a certificate says of a machine beside its own, where starts are placed."""
    found: dict[str, Any] = {"starts_of": machine.name}
    if not _is_builtin(machine):
        from wedmcam.machines.write import as_toml

        found["starts_of_toml"] = as_toml(machine)
    return found


def _targets(machine: Machine, certificate: dict[str, Any] | None) -> list[Target]:
    """Return the targets that a plan was made for: the machine's, and one whose starts it has."""
    targets = [target_of(machine)]
    name = (certificate or {}).get("starts_of")
    if name is not None and not targets[0].moves_starts:
        other = {"profile": name, "profile_toml": (certificate or {}).get("starts_of_toml")}
        targets.append(target_of(machine_issued(other)))
    return targets


def _is_builtin(machine: Machine) -> bool:
    return machine.name in machines.names() and machine == machines.builtin(machine.name)


def _dialect(said: Mapping[str, str | None], named: bool, shown: bool = False) -> Dialect:
    """Return what is said of a program beside its text; keywords as in `options.READING`.

    Args:
        said: the answers.
        named: its profile was named, and says the rest.
        shown: nothing is written or proven: what is not said is assumed.

    Raises:
        WrongUse: no such keyword or answer.
    """
    from wedmcam.frontends.iso.dialect import Dialect

    check_reading(said)
    units, whole = (
        None if (unit := said.get(name)) is None else nm_of(unit)
        for name in ("units_in", "whole_in")
    )
    return Dialect(
        coordinates=said.get("coordinates_in"),
        units_nm=units,
        whole_nm=whole,
        centres=said.get("centres_in"),
        semicolon=said.get("semicolon_in"),
        subprograms=said.get("subprograms_in"),
        named=named,
        shown=shown,
        asks=True,
    )


def bytes_of(source: Source, name: str | None) -> tuple[bytes, str]:
    """Return a source and its name: the path by default."""
    if isinstance(source, bytes):
        return source, name or "input"
    return Path(source).read_bytes(), name or str(source)


def _summary(
    found: list[Diagnostic],
    machine: Machine,
    options: Options,
    name: str,
    data: bytes,
    output_name: str,
    out: bytes | None,
    drawn: Drawn | None,
    verdict: Verdict | None,
    understood: Understanding | None,
) -> dict[str, Any]:
    """Return the certificate, or what is known of it when there is no verdict."""
    rows = None if understood is None else understood.as_data()
    units = drawn.sketch.info.units if drawn else None
    if verdict is None:
        from wedmcam.judge.certificate import finding_data, fingerprint

        return {
            "input": name,
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
            "offset_um": options.offset_um or 0.0,
            "side": str(options.effective_side),
            "diagnostics": [finding_data(d) for d in found],
            "ok": False,
            "understood": rows,
            "arithmetic": options.arithmetic,
            "sha256": {"input": fingerprint(data)},
        }
    from wedmcam.judge.certificate import certificate
    from wedmcam.machines.write import fingerprint as profile_fingerprint

    result = certificate(
        verdict,
        found,
        input_name=name,
        output_name=output_name,
        format_name=machine.format,
        units=units or "",
        input_bytes=data,
        output_bytes=out or b"",
        profile_name=machine.name,
        profile_sha256=profile_fingerprint(machine),
        join_um=drawn.report.max_shift_um if drawn else 0.0,
        spline_um=drawn.sketch.info.extra.get("spline_um", 0.0) if drawn else 0.0,
        options=options.as_data(),
        version=__version__,
    )
    result["understood"] = rows
    result["arithmetic"] = options.arithmetic
    step = machine.axes.step_um
    result["step_um"] = int(step) if step == int(step) else step
    if not _is_builtin(machine):
        from wedmcam.machines.write import as_toml

        # The file may be gone or changed when the program is proven again.
        result["profile_toml"] = as_toml(machine)
    if options.d:  # what is entered at the controller belongs to the program
        result["d_um"] = {str(number): um for number, um in options.d}
        if machine.iso.entry_factor == 2:
            result["d_is"] = "diameter"
    if out is None or not output_name:
        result["output"] = None
    result["ok"] = out is not None
    return result


# --- verify --------------------------------------------------------------------------------------


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
    machine = _reader_machine(data, name, format, profile)
    if options is None:
        options = options_in_mm(**mm)
    dialect = _dialect(options.reading, profile is not None, shown)
    run = Run(options.strict)
    planning = Run(options.strict)
    targets = _targets(machine, certificate)
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
                now = _summary(
                    run.found,
                    machine,
                    options,
                    drawing_name,
                    drawing,
                    name,
                    data,
                    drawn,
                    verdict,
                    _understood(plan),
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
            from wedmcam.judge.totals import figures as figures_of

            told, found = figures_of(decoded, machine.stepping, machine.limits)
            run.add("verify", found)
            run.add("verify", _not_closed(decoded, target, options))
            if certificate is not None:
                run.add("certificate", proof.held_to_alone(certificate, told, data))
    except Refused as why:
        stage = why.stage
    errors = has_errors(run.found)
    status = 0 if not errors else (3 if stage in ("verify", "certificate") else 1)
    known = _understood(plan)
    summary = _proof_summary(
        run, machine, options, name, data, drawing_name, drawing, drawn, told, verdict, known
    )
    if verdict is not None and certificate is None:
        summary["leads"] = "own"  # so order and leads are not held to the plan's next time either
    said = tuple(run.found)
    return Proof(not errors, decoded, verdict, plan, machine, summary, said, status, known)


def read_program(
    source: Source,
    *,
    profile: Machine | str | None = None,
    format: str | None = None,
    name: str | None = None,
    entered: Entries | None = None,
    shown: bool = False,
    **said: str | None,
) -> tuple[Program | None, Machine, tuple[Diagnostic, ...]]:
    """Return a program as decoded, the machine it was read with, and the findings.

    Args:
        source: a path or bytes.
        profile: of the program; None for the default of its format, which says nothing of what an
            ISO program leaves open.
        format: None to tell by name and content.
        name: in findings.
        entered: what the operator enters beside a rotation or compensation file, or for G41, G42.
        shown: the program is only shown: what it leaves open is assumed, and said first. Else it is
            refused.
        **said: of an ISO program: ``units_in``, ``whole_in``, ``coordinates_in``, ``centres_in``,
            ``semicolon_in``, ``subprograms_in``, as in `Options`.

    Raises:
        WrongUse: an unknown format or profile, or something else said.
    """
    data, name = bytes_of(source, name)
    machine = _reader_machine(data, name, format, profile)
    target, dialect = target_of(machine), _dialect(said, profile is not None, shown)
    run = Run()
    try:
        entries = replace(entered or Entries(), dialect=dialect)
        decoded = run("decode", target.read(data, name, entries))
    except Refused:
        return None, machine, tuple(run.found)
    if entered is None or entered.gap_um is None:
        run.add("decode", target.unstated(decoded))
    return decoded, machine, tuple(run.found)


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
    from wedmcam.diag import note

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
    from wedmcam.diag import error

    stated = options.offset_um is not None or options.side is not None or against == "wed"
    found = [] if stated else target.unstated(decoded)
    if against is None or not found:
        return found
    what = "no gap is given: by how much the wire runs beside the outline is nowhere said"
    hint = "--offset 0.1mm, the gap that is entered at the controller; --side on for none"
    return [error("no-gap", what, hint=hint)]


def _reader_machine(
    data: bytes, name: str, format_: str | None, profile: Machine | str | None
) -> Machine:
    from wedmcam.options import FORMAT_OF_SUFFIX

    if format_ is None and profile is None:
        format_ = FORMAT_OF_SUFFIX.get(Path(name).suffix.lower())
        if format_ is None:
            from wedmcam.frontends.identify import identify

            seen = identify(data).format
            format_ = seen if seen in machines.DEFAULTS else "3b"
    if profile is None and format_ in machines.DEFAULTS:
        return machines.reading(format_)
    return machine_for(format_, profile)


def _options_issued(
    certificate: dict[str, Any], options: Options | None, mm: Mapping[str, Any]
) -> Options:
    """Return the options of a proof: as stated, else those of the certificate.

    Raises:
        WrongUse: the certificate is none, or has options that this version does not know.
    """
    from wedmcam.judge.claims import fault

    if why := fault(certificate):
        raise WrongUse(f"this is no certificate: {why}")
    issued = Options.from_data(certificate["options"])
    if options is not None:
        return options
    return options_in_mm(**mm) if mm else issued


def _unended(program: Program, target: Target) -> list[Diagnostic]:
    """Return a warning when a text program does not say where it ends."""
    from wedmcam.diag import warning
    from wedmcam.ir.program import Kind

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
    from wedmcam.backends.axes import to_controller
    from wedmcam.formats.quadrants import quadrant
    from wedmcam.judge.closing import not_closed

    machine = target.machine
    own = to_controller(program, machine.axes)
    textbook = (options.count or machine.count) == "textbook"
    return not_closed(
        own, machine.own_stepping, quadrant if target.states_counts else None, textbook
    )


def _proof_summary(
    run: Run,
    machine: Machine,
    options: Options,
    name: str,
    data: bytes,
    drawing_name: str,
    drawing: bytes,
    drawn: Drawn | None,
    told: dict[str, Any],
    verdict: Verdict | None,
    known: Understanding | None,
) -> dict[str, Any]:
    if verdict is not None:
        summary = _summary(
            run.found, machine, options, drawing_name, drawing, name, data, drawn, verdict, known
        )
        summary["ok"] = not has_errors(run.found)
        return summary
    summary = _summary(
        run.found, machine, options, drawing_name, drawing, name, None, drawn, None, known
    )
    summary |= {"input": drawing_name or None, "output": name, "side": None, "offset_um": None}
    summary |= told
    if not drawing:
        del summary["sha256"], summary["arithmetic"]  # nothing was computed
        summary["ok"] = not has_errors(run.found)
    return summary


def figures(program: Program, machine: Machine) -> dict[str, Any]:
    """Return what a program does by itself: blocks, steps, closure, extents, limits, reversals."""
    from wedmcam.judge.totals import figures as figures_of

    return figures_of(program, machine.stepping, machine.limits)[0]


def minutes(path_mm: float, feed_um: float) -> float:
    """Return the cutting time of a path at ``feed_um`` a minute, without moves and threading.

    >>> minutes(120.0, 2500.0)
    48.0
    """
    return round(1000.0 * path_mm / feed_um, 2)


def diff(
    a: Source,
    b: Source,
    *,
    within_mm: float = 0.001,
    names: tuple[str | None, str | None] = (None, None),
    profiles: tuple[Machine | str | None, Machine | str | None] = (None, None),
    d: tuple[tuple[int, float], ...] = (),
    **said: str | None,
) -> tuple[Difference | None, tuple[Diagnostic, ...]]:
    """Compare two programs of any formats as step paths; see ``judge.difference``.

    Args:
        a: a path or bytes.
        b: likewise.
        within_mm: as far apart is equal.
        names: of both in findings.
        profiles: of both.
        d: numbers and offsets (um) of ISO programs with G41 or G42.
        **said: of ISO programs, as for `read_program`; ``whole_in_b`` and others are of the second
            where it is read otherwise.

    Returns:
        The difference; None where one cannot be read. And the findings of both readers.
    """
    from wedmcam.judge.difference import difference

    first: dict[str, Any] = {name: v for name, v in said.items() if not name.endswith("_b")}
    other = {n: v for n in READING if (v := said.get(f"{n}_b")) is not None}
    check_reading({name.removesuffix("_b"): v for name, v in said.items()})
    read = [
        read_program(source, profile=profile, name=name, entered=Entries(d=d), **of)
        for source, name, profile, of in zip(
            (a, b), names, profiles, (first, {**first, **other}), strict=True
        )
    ]
    found = tuple(d for _, _, some in read for d in some)
    (one, machine_a, _), (two, machine_b, _) = read
    if one is None or two is None:
        return None, found
    steppings = machine_a.stepping, machine_b.stepping
    return difference(one, two, *steppings, 1000.0 * within_mm), found


def difference_data(d: Difference, a: str = "a", b: str = "b") -> dict[str, Any]:
    """Return a difference as plain data."""
    apart = d.distance_um if d.distance_um < float("inf") else None
    return {
        "a": a,
        "b": b,
        "equal": d.equal,
        "largest_um": round(d.largest_um, 3) if d.largest_um < float("inf") else None,
        "block_a": d.block_a or None,
        "block_b": d.block_b or None,
        "at_um": None if d.equal else list(d.at),
        "distance_um": None if d.equal or apart is None else round(apart, 3),
        "what": d.what,
    }


def with_images(proven: Proof, drawing: bytes, name: str, options: Options) -> Proof:
    """Return a proof with that of the images of the drawing; see ``wedmcam.operations.images``."""
    from wedmcam.judge.certificate import finding_data
    from wedmcam.operations.images import metamorphic

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


# --- inspect and plot ----------------------------------------------------------------------------


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


def inspect(
    source: Source, *, name: str | None = None, options: Options | None = None, **mm: Any
) -> Inspection:
    """Return what the reader sees in a drawing, and the largest offset that fits it."""
    from wedmcam.operations.inspect import facts_of

    data, name = bytes_of(source, name)
    options = options if options is not None else options_in_mm(**mm)
    run = Run(options.strict)
    drawn = None
    try:
        drawn = sources.read(data, name, options, run)
    except Refused:
        seen = run.values.get("seen")
        return Inspection(None, {"input": name}, tuple(run.found), seen)
    facts, more = facts_of(name, drawn, options)
    run.found += (*drawn.doubts, *more)
    return Inspection(drawn, facts, tuple(run.found))


def plot(made: Compilation | Proof | Inspection, title: str = "") -> str:
    """Return an SVG picture: of the verified program where there is one, else of what was read.

    A drawing that is refused is drawn with the places of its findings numbered.

    Raises:
        WrongUse: nothing was read that could be drawn.
    """
    from wedmcam.reports.picture.program import plot as plot_program
    from wedmcam.reports.picture.program import plot_contours

    marks = [d for d in made.findings if d.points_mm and d.severity is not Severity.NOTE]
    if isinstance(made, Inspection) or made.program is None:
        drawn = None if isinstance(made, Proof) else made.drawn
        if drawn is None or has_errors(made.findings):
            refused = None if isinstance(made, Proof) else _refused_picture(made, title)
            if refused is None:
                raise WrongUse("nothing that could be drawn was read")
            return refused
        return plot_contours(
            drawn.contours,
            thread_points=drawn.sketch.thread_points,
            title=title,
            marks=marks,
        )
    starts, ends = positions(made.program, made.machine)
    return plot_program(
        _with_cuts(made.program, made.verdict),
        starts,
        ends,
        plan=made.plan,
        known=made.understood,
        title=title,
        facts=_plot_facts(made),
        marks=marks,
    )


def _refused_picture(made: Compilation | Inspection, title: str) -> str | None:
    """Return a picture of what was read of a source that is refused; None where nothing was."""
    from wedmcam.compiler.sources import rows_of
    from wedmcam.reports.picture.refused import plot_refused

    seen = None if made.seen is None else made.seen.whole()
    if seen is None and made.drawn is not None and len(made.drawn.contours):
        seen = Seen(rows_of(made.drawn.contours), made.drawn.sketch)
    if seen is None:
        return None
    marks = [d for d in made.findings if d.severity is not Severity.NOTE]
    facts = {"units": seen.units} if seen.units else {}
    return plot_refused(
        seen.rows,
        [_placed(d, seen) for d in marks],
        unread=seen.sketch.unread.segments if seen.rows is seen.sketch.segments else None,
        thread_points=seen.sketch.thread_points,
        title=title,
        facts={"refused": "no program", **facts},
    )


def _placed(found: Diagnostic, seen: Seen) -> Diagnostic:
    """Return a finding with the place of the entity that it is about, where it has none."""
    if found.points_mm or not isinstance(found.span, EntityRef):
        return found
    sources = seen.sketch.sources
    at = sources.index(found.span) if found.span in sources else -1
    rows = seen.rows[seen.rows["source"] == at] if at >= 0 else seen.rows[:0]
    if not len(rows):
        return found
    row = rows[0]
    ring = row["turn"] != 0 and row["x0"] == row["x1"] and row["y0"] == row["y1"]
    x, y = ((row[f"{c}0"] + (0 if ring else row[f"{c}1"])) / (1000 if ring else 2000) for c in "xy")
    return replace(found, points_mm=((float(x), float(y)),))


def _with_cuts(program: Program, verdict: Verdict | None) -> Program:
    """Return a program whose blocks have the numbers of the cuts that the verdict tells."""
    from wedmcam.ir.program import Kind

    blocks = program.blocks.copy()
    blocks["cut"] = 0
    for cut in verdict.cuts if verdict is not None else ():
        blocks["cut"][cut.first_block - 1 : cut.last_block] = cut.number
    if (blocks["cut"][blocks["kind"] < Kind.MOVE] == 0).any():  # some blocks are of no cut
        return program
    return replace(program, blocks=blocks)


def plot_html(made: Compilation | Proof | Inspection, title: str = "") -> str:
    """Return a page with the picture of `plot` and a table of the blocks, to click in."""
    from wedmcam.diag.render import merged, render
    from wedmcam.programs.rows import dump
    from wedmcam.reports.picture.page import page

    said = "\n".join(render(d, title) for d in merged(made.findings))
    program = None if isinstance(made, Inspection) else made.program
    if isinstance(made, Inspection) or program is None:
        return page(plot(made, title), title=title, said=said)
    rows = [
        (
            str(row.number),
            row.where,
            f"{row.kind} {row.instruction}".rstrip(),
            "" if row.count is None else str(row.count),
            f"{row.end[0] / 1000 + 0.0:.3f}",
            f"{row.end[1] / 1000 + 0.0:.3f}",
        )
        for row in dump(program, made.machine)
    ]
    head = ("block", "at", "what", "J", "end x", "end y")
    known = made.understood if not isinstance(made, Inspection) else None
    return page(plot(made, title), title=title, head=head, rows=rows, said=said, known=known)


def path_drawing(program: Program, machine: Machine) -> bytes:
    """Return the stepped wire path as a DXF: lines and arcs by layer; see ``backends.dxf``."""
    from wedmcam.backends.dxf import encode

    return encode(program, machine)


def positions(program: Program, machine: Machine) -> tuple[Any, Any]:
    """Return where each block starts and ends, shape (blocks, 2), um, drawing coordinates."""
    from wedmcam.programs.places import block_ends

    return block_ends(program, machine)


def _plot_facts(made: Compilation | Proof) -> dict[str, str]:
    facts = {"profile": made.machine.name}
    if made.understood is not None:
        facts["cuts"] = made.understood.counts
    v = made.verdict
    if v is not None:
        assert made.plan is not None
        facts |= {"side": v.side, "offset": made.plan.offsets_text}
        facts |= {"blocks": str(v.blocks), "steps": str(v.steps)}
        facts["deviation"] = f"{v.max_deviation_um:.2f} um"
        if v.closure_um is not None:
            facts["closure"] = f"{v.closure_um:.0f} um"
        if v.gouge_um is not None:
            facts["gouge"] = f"{v.gouge_um:.2f} um"
        facts["proof"] = "passed" if made.ok else "FAILED"
    return facts

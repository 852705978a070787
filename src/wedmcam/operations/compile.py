"""Compile a source for one machine, and prove the program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from wedmcam import machines
from wedmcam.compiler import pipeline
from wedmcam.compiler.portion import portion
from wedmcam.compiler.results import Compilation
from wedmcam.compiler.summary import Files, summary_of, understood_of
from wedmcam.diag.run import Refused, Run, WrongUse
from wedmcam.files import Source, bytes_of
from wedmcam.machines import Machine
from wedmcam.operations.arithmetics import difference_um
from wedmcam.operations.profiles import machine_for
from wedmcam.options import Options, take_options
from wedmcam.reports.source_map import source_map as map_of
from wedmcam.targets import target_of


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

        compilation = wedmcam.compile("bracket.dxf", offset=0.1)
        if compilation.ok:
            Path("bracket.3b").write_bytes(compilation.data)
    """
    data, name = bytes_of(source, name)
    machine = machine_for(to, profile)
    options = take_options(options, mm)
    if options.program.answers:
        raise WrongUse(
            f"{', '.join(options.program.answers)}: said of a program that is read, not compiled"
        )
    run = Run(options.judging.strict, observe=observe)
    refused = planned_for(data, name, options, [machine], run)
    named = profile is not None
    return compile_plan(data, name, machine, options, run, output_name, refused, named=named)


def planned_for(
    data: bytes, name: str, options: Options, machines: Sequence[Machine], run: Run
) -> str:
    """Read and plan a source for machines; ``run`` keeps both. Return where it was refused, if."""
    try:
        pipeline.plan_source(data, name, options, [target_of(m) for m in machines], run)
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
        options: as it was planned with; their ``portion`` may be another.
        run: in which `planned_for` left what was drawn and the plan.
        output_name: of the program.
        refused: where planning stopped; then nothing is compiled.
        named: the machine was named, and is not just the default of its format.
    """
    target, stage, values = target_of(machine), refused, run.values
    if not stage:
        try:
            part = run("plan", (portion(values["plan"], target, options, run), ()))
            pipeline.write_and_prove(part, target, options, run, output_name)
            run.add("verify", [] if named else machines.unnamed(machine))
        except Refused as why:
            stage = why.stage
    entries, verdict = values.get("enter"), values.get("verify")
    issued = options
    if entries is not None and entries.d:  # belongs to the program: who proves it enters it
        issued = options.with_values(d=entries.d)
    ok, drawn = not stage, values.get("drawn")
    known = understood_of(values.get("plan"))
    out = values["encode"] if ok else None
    return Compilation(
        ok,
        out,
        values.get("decode") if ok else None,
        values.get("plan"),
        drawn,
        machine,
        verdict if ok else None,
        summary_of(
            run.findings,
            machine,
            issued,
            Files(name, data, output_name, out, entries),
            drawn,
            verdict if ok else None,
            known,
        ),
        options,
        tuple(run.findings),
        stage,
        values.get("lower"),
        entries,
        known,
        values.get("seen"),
    )


def source_map(compilation: Compilation) -> dict[str, Any]:
    """Return which block was drawn by what, as plain data (docs/map.md)."""
    if not compilation.ok or compilation.lowered is None or compilation.program is None:
        raise WrongUse("a map is of a proven program")
    return map_of(
        compilation.lowered, compilation.program, compilation.machine, summary=compilation.summary
    )


def arithmetic_difference(compilation: Compilation, source: Source) -> float | None:
    """Return by how much the wire path would differ in the other arithmetic, um.

    Args:
        compilation: its ``summary["arithmetic"]`` tells in what it was computed.
        source: what was compiled, a path or bytes.

    Returns:
        The largest distance between the exact paths; None where one of them does not exist.

    >>> compilation = compile(path := "samples/cover.dxf", offset=0.1)  # doctest: +SKIP
    >>> arithmetic_difference(compilation, path)  # doctest: +SKIP
    0.0027
    """
    if compilation.drawn is None or compilation.plan is None:
        return None
    data, name = bytes_of(source, compilation.summary["input"])
    apart = difference_um(data, name, compilation.drawn, compilation.plan, compilation.options)
    return None if apart is None else round(apart, 4)

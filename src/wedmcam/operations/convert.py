"""One program format into another, from the path that the first controller steps.

Nothing is translated word by word. The program is decoded, its blocks are made anew for the other
controller (`programs.reblock`), written, decoded again and compared as a step path with the first
program. What is farther off than 1 um is not written. With transforms it is the program of the
images of the first one that is written (`operations.moved`).

`OUTPUTS` holds what is no program for a controller and can still be made of one (a picture, a
drawing, source text). To add one: a line there, its ending in `SUFFIXES`, and a function
``f(program, machine, name) -> (bytes, findings)`` of the decoded program and the machine that it
was read for. Such a function proves what it claims by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wedmcam import machines
from wedmcam.controllers.nby15.data import Switches
from wedmcam.diag import Diagnostic, Severity, error, has_errors
from wedmcam.files import bytes_of
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.operations.compile import compile as compile_source
from wedmcam.operations.profiles import machine_for
from wedmcam.operations.read import NO_GAP, read_program
from wedmcam.programs.places import block_ends
from wedmcam.targets import Entries, target_of

if TYPE_CHECKING:
    from wedmcam.judge.difference import Difference
    from wedmcam.operations.moved import Images

#: How far the two step paths may be apart, um; a step where that is more.
WITHIN_UM = 1.0
#: And where the controller makes the path between the vertices that a program states (rotation).
MADE_WITHIN_UM = 2.0

#: In how many parts an arc is written in the part language, at most.
MOST_PIECES = 16
#: How many times a part program is written anew because of an arc.
TRIES = 40

#: Outputs that are no program format -> "module:function"; named and not imported.
OUTPUTS: dict[str, str] = {
    "svg": "wedmcam.operations.convert:as_svg",
    "dxf": "wedmcam.backends.dxf:convert",
    "wed": "wedmcam.operations.convert:as_wed",
}
#: Endings of their names.
SUFFIXES: dict[str, str] = {".svg": "svg", ".dxf": "dxf", ".wed": "wed"}

#: Findings with which an output is no input error, but fails its proof.
_NOT_PROVEN = frozenset({"conversion-differs", "transform-differs"})

Writer = Callable[[Program, Machine, str], tuple[bytes, list[Diagnostic]]]


@dataclass(frozen=True, slots=True, eq=False)
class Conversion:
    """What came of a conversion.

    Attributes:
        data: the bytes of the other program; None when it was not written or not proven.
        program: as it was read from the first file; None when that was not possible.
        program_out: decoded from ``data``; None for an output that is no program.
        machine_in: the profile that the first file was read with.
        machine: the profile of the other; None for an output that is no program.
        difference: of the two step paths; None when it did not come so far.
        findings: everything that was found.
        images: what transforms made of the first program; None where there are none.
    """

    data: bytes | None
    program: Program | None
    program_out: Program | None
    machine_in: Machine
    machine: Machine | None
    difference: Difference | None
    findings: tuple[Diagnostic, ...]
    images: Images | None = None

    @property
    def ok(self) -> bool:
        """Whether a program was made and proven equal."""
        return self.data is not None

    @property
    def status(self) -> int:
        """The exit status: 0 done, 1 the input has errors, 3 the two paths differ."""
        if self.ok:
            return 0
        differs = self.difference is not None and not self.difference.equal
        return 3 if differs or any(d.code in _NOT_PROVEN for d in self.findings) else 1


def output_of(name: str) -> str | None:
    """Return the output that the ending of a name tells; None for program formats.

    >>> output_of("a.SVG"), output_of("a.3b")
    ('svg', None)
    """
    return SUFFIXES.get(Path(name).suffix.lower())


def convert(
    source: str | Path | bytes,
    *,
    to: str | None = None,
    profile: Machine | str | None = None,
    profile_in: Machine | str | None = None,
    name: str | None = None,
    format: str | None = None,
    strict: bool = False,
    entered: Entries | None = None,
    **more: Any,
) -> Conversion:
    """Return a program of one format as one of another, proven to step the same path.

    Args:
        source: a path or bytes.
        to: a program format, or a key of `OUTPUTS`.
        profile: of the other program; None for the default of its format.
        profile_in: of the program that is read; None for the default of the format that name and
            content tell: what an ISO program leaves open is then refused.
        name: of the source in findings.
        format: of the source; None to tell by name and content.
        strict: warnings are errors.
        entered: copies and angle of a rotation file, gap and side of a compensation file, read or
            written.
        **more: ``feed_um``, the cutting speed, um a minute, for a profile that writes F (the
            profile's where it is left out); ``transforms``, texts in the part language, one after
            the other (lengths in mm, the program starts at (0, 0)): the images are written, with
            every vertex as stepped within 1 um of the exact one; and of an
            ISO program, as for `wedmcam.read_program`, ``units_in``, ``whole_in``, ...

    Raises:
        WrongUse: an unknown format or profile.
        OSError: the path cannot be read.

    >>> conversion = convert(b"B17000B5000B17000GXL1 DD", to="compact")
    >>> conversion.data.hex(" ")
    '01 01 70 00 00 50 00 00'
    """
    entries = entered or Entries()
    feed_um, transforms = more.pop("feed_um", None), more.pop("transforms", ())
    program, machine_in, read_findings = read_program(
        source, profile=profile_in, format=format, name=name, entered=entries, **more
    )
    output = OUTPUTS.get(to or "")
    machine = None if output else machine_for(to, profile)
    entries.check(machine_in.format, machine.format if machine else to or "")
    stays = machine is not None and target_of(machine).takes_gap
    findings = list(read_findings) if to == "svg" else _of_reader(read_findings, stays)
    data = other = apart = images = None
    first = program
    if program is not None and transforms and not has_errors(findings):
        from wedmcam.operations.moved import images_of

        images, problems = images_of(program, machine_in, transforms, machine)
        program = images.program if images else None
        findings += problems
    if program is None or has_errors(findings):
        pass  # the reader says why
    elif output:
        data, problems = _writer(output)(program, machine_in, name or str(source)[:200])
        findings += problems
    elif machine is not None:
        outline = stays and not entries.gap_um
        senses = target_of(machine_in).senses(bytes_of(source, name)[0]) if outline else None
        if images is not None and senses is not None:
            from wedmcam.operations.moved import senses_of

            senses = senses_of(images, senses)
        data, other, apart, problems = between(
            program, machine_in, machine, entries, senses, feed_um
        )
        findings += problems
        if data is not None and profile is None:
            findings += machines.unnamed(machine)
    if images is not None and program is not None and data is not None:
        from wedmcam.operations.moved import measured

        written = (other or program, (machine or machine_in) if other else machine_in)
        images, problems = measured(images, written[0], written[1].stepping)
        findings += problems
    stopped = has_errors(findings) or (strict and _has_warnings(findings))
    data = None if stopped else data
    return Conversion(data, first, other, machine_in, machine, apart, tuple(findings), images)


def _of_reader(read_findings: Sequence[Diagnostic], stays: bool) -> list[Diagnostic]:
    """Return the findings of the reader as they are for a conversion.

    A path needs its gap; and a word that a reader leaves out without harm is a loss.

    Args:
        read_findings: by the reader.
        stays: the outline stays one, and needs no gap.
    """
    findings = []
    for d in read_findings:
        if d.code == "iso-harmless":
            findings.append(
                replace(d, code="not-carried", severity=Severity.WARNING).with_hint(
                    "see to it at the machine"
                )
            )
        elif d.code != "no-gap":
            findings.append(d)
        elif not stays:
            findings.append(
                error(
                    "no-gap",
                    NO_GAP,
                    d.span,
                    hint="--gap 0.1mm --side part, as entered at the controller; --gap 0 for the "
                    "outline itself",
                )
            )
    return findings


def _has_warnings(findings: list[Diagnostic]) -> bool:
    return any(d.severity >= Severity.WARNING for d in findings)


def _writer(output: str) -> Writer:
    """Return the function that ``module:function`` names."""
    module, _, function = output.partition(":")
    writer: Writer = getattr(import_module(module), function)
    return writer


def between(
    program: Program,
    machine_in: Machine,
    machine: Machine,
    entered: Entries | None = None,
    senses: NDArray[np.int64] | None = None,
    feed_um: float | None = None,
) -> tuple[bytes | None, Program | None, Difference | None, list[Diagnostic]]:
    """Return a decoded program as bytes for another machine, proven equal as a step path.

    Args:
        program: as decoded.
        machine_in: the profile that it was read with.
        machine: the profile of the other program.
        entered: what the operator enters beside the other program.
        senses: of an outline that stays one: for each block whether its arc grows (+1) or shrinks
            (-1) where it is offset outwards, 0 where the file does not say.
        feed_um: as for `convert`.

    Returns:
        The bytes (None where it failed), the program decoded from them, the difference, and what
        was found on the way.
    """
    from wedmcam.judge.difference import difference
    from wedmcam.programs.reblock import carry

    target, entries = target_of(machine), entered or Entries()
    if target.refuses_carried is not None:
        return None, None, None, [target.refuses_carried]
    stepping = machine_in.stepping
    carried, findings = carry(program, stepping, target.carry_rules(machine_in.format))
    if carried is None:
        return None, None, None, findings
    arcs = program.blocks["kind"] == Kind.ARC
    known = senses is not None and bool(senses[arcs].all())
    data, more = target.write_carried(carried, entries, senses if known else None, feed_um)
    findings += more
    if data is None or has_errors(more):
        return None, None, None, findings
    # Copies and leads were those of the first program, and are in its path.
    rest = replace(entries, copies=0, angle=0.0, lead_in=None, lead_out=None, switches=Switches())
    other, problems = target.read(data, f"the {machine.format} program", rest)
    findings += [d for d in problems if d.severity is Severity.ERROR]
    if has_errors(findings):
        return None, other, None, findings
    within = (MADE_WITHIN_UM if target.makes_path and not target.takes_gap else WITHIN_UM) * max(
        1.0, program.step_um
    )
    apart = difference(program, other, stepping, machine.stepping, within)
    if not apart.equal:
        findings.append(_differs(machine.format, program, apart))
    return (data if apart.equal else None), other, apart, findings


def _differs(format_: str, program: Program, apart: Difference) -> Diagnostic:
    return error(
        "conversion-differs",
        "the {format} program would not step the path of the first: {distance_um:.2f} um apart "
        "in block {block} of the first and {other_block} of the other"
        if apart.distance_um < 1e9
        else "the {format} program would not step the path of the first: {difference} in block "
        "{block} of the first and {other_block} of the other",
        _span_of(program, apart.block_a),
        hint="write another format; wedmcam dump shows the block",
        format=format_,
        distance_um=apart.distance_um if apart.distance_um < 1e9 else None,
        difference=apart.what,
        block=apart.block_a,
        other_block=apart.block_b,
    )


def _span_of(program: Program, block: int) -> Any:
    return program.spans[block - 1] if 0 < block <= len(program.spans) else None


def as_svg(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return a picture of a program."""
    from wedmcam.reports.picture.program import plot as plot_program
    from wedmcam.reports.picture.sheet import Caption

    starts, ends = block_ends(program, machine)
    caption = Caption(Path(name).name, {"profile": machine.name})
    picture = plot_program(program, starts, ends, caption=caption)
    return picture.encode("utf-8"), []


def as_wed(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return source text in the part language, proven to compile to the same step path.

    It is compiled for the machine that the program was read for; for a format that is no cutting
    program (rotation, compensation) for the ZD-065's own. An arc that comes out too far from what
    the first program steps is written in more parts.
    """
    from wedmcam.backends.wed import ANY_PATH, hindrance, source, trim
    from wedmcam.judge.difference import difference

    own = target_of(machine).own_path
    steppings = machine.stepping, own.stepping
    program, left_out = trim(program)
    pieces = np.ones(len(program.blocks), np.int64)
    for attempt in range(TRIES + 1):
        last = attempt == TRIES
        data, findings = source(program, machine, name, pieces)
        findings = [*left_out, *findings]
        if has_errors(findings):
            return b"", findings
        compilation = compile_source(data, profile=own, name=f"{Path(name).name}.wed")
        reason = hindrance(program, machine)
        if not compilation.ok or compilation.program is None:
            if reason is not None:
                return b"", [*findings, reason]
            why = next(d for d in compilation.findings if d.severity is Severity.ERROR)
            failed = error(
                "conversion-differs",
                "the part program made of this program does not compile: {why}",
                hint=ANY_PATH,
                why=why.message,
            )
            return b"", [*findings, failed]
        within = WITHIN_UM * max(1.0, program.step_um)
        apart = difference(program, compilation.program, *steppings, within)
        if apart.equal:
            return data, findings
        i = apart.block_a - 1
        if last or not program.blocks["turn"][i] or pieces[i] >= MOST_PIECES:
            if reason is not None:
                return b"", [*findings, reason]
            return b"", [*findings, _differs("part", program, apart)]
        pieces[i] *= 2
    raise AssertionError  # the last try returns

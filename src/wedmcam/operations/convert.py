"""One program format into another, from the path that the first controller steps.

Nothing is translated word by word. The program is decoded, its blocks are made anew for the other
controller (``transforms.carry``), written, decoded again and compared as a step path with the first
program. What is farther off than 1 um is not written.

`TARGETS` holds what is no program for a controller and can still be made of one (a picture, a
drawing, source text). To add one: a line there, its ending in `SUFFIXES`, and a function
``f(program, machine, name) -> (bytes, findings)`` of the decoded program and the machine that it
was read for. Such a target proves what it claims by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wedmcam import machines
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

#: How far the two step paths may be apart, um; a step where that is more.
WITHIN_UM = 1.0

#: In how many parts an arc is written in the part language, at most.
MOST_PIECES = 16
#: How many times a part program is written anew because of an arc.
TRIES = 40

#: Targets that are no program format -> "module:function"; named and not imported.
TARGETS: dict[str, str] = {
    "svg": "wedmcam.operations.convert:as_svg",
    "dxf": "wedmcam.backends.dxf:converted",
    "wed": "wedmcam.operations.convert:as_wed",
}
#: Endings of their names.
SUFFIXES: dict[str, str] = {".svg": "svg", ".dxf": "dxf", ".wed": "wed"}

Target = Callable[[Program, Machine, str], tuple[bytes, list[Diagnostic]]]


@dataclass(frozen=True, slots=True, eq=False)
class Conversion:
    """What came of a conversion.

    Attributes:
        data: the bytes of the other program; None when it was not made or not proven.
        program: as it was read from the first file; None when that was not possible.
        made: decoded from ``data``; None for a target that is no program.
        machine_in: the profile that the first file was read with.
        machine: the profile of the other; None for a target that is no program.
        difference: of the two step paths; None when it did not come so far.
        findings: everything that was found.
    """

    data: bytes | None
    program: Program | None
    made: Program | None
    machine_in: Machine
    machine: Machine | None
    difference: Difference | None
    findings: tuple[Diagnostic, ...]

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
        return 3 if differs or any(d.code == "conversion-differs" for d in self.findings) else 1


def output_of(name: str) -> str | None:
    """Return the target that the ending of a name tells; None for program formats.

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
    feed_um: float | None = None,
    **said: Any,
) -> Conversion:
    """Return a program of one format as one of another, proven to step the same path.

    Args:
        source: a path or bytes.
        to: a program format, or a key of `TARGETS`.
        profile: of the other program; None for the default of its format.
        profile_in: of the program that is read; None for the default of the format that name and
            content tell: what an ISO program leaves open is then refused.
        name: of the source in findings.
        format: of the source; None to tell by name and content.
        strict: warnings are errors.
        entered: copies and angle of a rotation file, gap and side of a compensation file, read or
            written.
        feed_um: cutting speed, um a minute, for a profile that writes F; None for the profile's.
        **said: of an ISO program, as for `wedmcam.read_program`: ``units_in``, ``whole_in``, ...

    Raises:
        WrongUse: an unknown format or profile.
        OSError: the path cannot be read.

    >>> made = convert(b"B17000B5000B17000GXL1 DD", to="compact")
    >>> made.data.hex(" ")
    '01 01 70 00 00 50 00 00'
    """
    entered = entered or Entries()
    read, machine_in, found_in = read_program(
        source, profile=profile_in, format=format, name=name, entered=entered, **said
    )
    written = to if to in TARGETS else machine_for(to, profile).format
    entered.check(machine_in.format, written or "")
    stays = to not in TARGETS and target_of(machine_for(to, profile)).takes_gap
    found = [d for d in (_gap_asked(d, to == "svg", stays) for d in found_in) if d is not None]
    found = [d if to == "svg" else _lost(d) for d in found]

    def ended(data: bytes | None = None, **more: Any) -> Conversion:
        values = {"made": None, "machine": None, "difference": None} | more
        stopped = has_errors(found) or (strict and _warned(found))
        kept = None if stopped else data
        return Conversion(kept, read, machine_in=machine_in, findings=tuple(found), **values)

    if to in TARGETS:
        if read is None or has_errors(found):
            return ended()
        other, more = _target(to)(read, machine_in, name or str(source)[:200])
        found += more
        return ended(other)
    machine = machine_for(to, profile)
    if read is None or has_errors(found):
        return ended(machine=machine)
    senses = None
    if stays and not entered.gap_um:
        senses = target_of(machine_in).senses(bytes_of(source, name)[0])
    data, made, apart, more = between(read, machine_in, machine, entered, senses, feed_um)
    found += more
    if data is not None and profile is None:
        found += machines.unnamed(machine)
    return ended(data, machine=machine, made=made, difference=apart)


def _gap_asked(d: Diagnostic, shown: bool, stays: bool) -> Diagnostic | None:
    """Return a finding of the reader as it is for a conversion: a path needs its gap.

    Args:
        d: the finding.
        shown: what is made is a picture.
        stays: the outline stays one.
    """
    if d.code != "no-gap" or shown:
        return d
    if stays:
        return None
    hint = "--gap 0.1mm --side part, as entered at the controller; --gap 0 for the outline itself"
    return error("no-gap", NO_GAP, d.span, hint=hint)


def _lost(d: Diagnostic) -> Diagnostic:
    """Return a note on words that a reader leaves out as what it is for a conversion: a loss."""
    if d.code != "iso-harmless":
        return d
    hint = "see to it at the machine"
    return replace(d, code="not-carried", severity=Severity.WARNING, hint_template=hint)


def _warned(found: list[Diagnostic]) -> bool:
    return any(d.severity >= Severity.WARNING for d in found)


def _target(to: str) -> Target:
    module, _, function = TARGETS[to].partition(":")
    made: Target = getattr(import_module(module), function)
    return made


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
    carried, found = carry(program, stepping, target.carry_rules(machine_in.format))
    if carried is None:
        return None, None, None, found
    arcs = program.blocks["kind"] == Kind.ARC
    known = senses is not None and bool(senses[arcs].all())
    data, more = target.write_carried(carried, entries, senses if known else None, feed_um)
    found += more
    if data is None or has_errors(more):
        return None, None, None, found
    made, problems = target.read(data, f"the {machine.format} program", entries)
    found += [d for d in problems if d.severity is Severity.ERROR]
    if has_errors(found):
        return None, made, None, found
    within = WITHIN_UM * max(1.0, program.step_um)
    apart = difference(program, made, stepping, machine.stepping, within)
    if not apart.equal:
        found.append(_differs(machine.format, program, apart))
    return (data if apart.equal else None), made, apart, found


def _differs(what: str, program: Program, apart: Difference) -> Diagnostic:
    far = f"{apart.distance_um:.2f} um apart" if apart.distance_um < 1e9 else apart.what
    return error(
        "conversion-differs",
        f"the {what} program would not step the path of the first: {far} in "
        f"block {apart.block_a} of the first and {apart.block_b} of the other",
        _span_of(program, apart.block_a),
        hint="write another format; wedmcam dump shows the block",
    )


def _span_of(program: Program, block: int) -> Any:
    return program.spans[block - 1] if 0 < block <= len(program.spans) else None


def _no_words(what: str, span: Any) -> Diagnostic:
    return error("not-in-format", what, span, hint="convert to .dxf, which takes any path")


def as_svg(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return a picture of a program."""
    from wedmcam.reports.picture.program import plot as plot_program

    starts, ends = block_ends(program, machine)
    picture = plot_program(
        program, starts, ends, title=Path(name).name, facts={"profile": machine.name}
    )
    return picture.encode("utf-8"), []


def as_wed(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return source text in the part language, proven to compile to the same step path.

    It is compiled for the machine that the program was read for; for a format that is no cutting
    program (rotation, compensation) for the ZD-065's own. An arc that comes out too far from what
    the first program steps is written in more parts.
    """
    from wedmcam.backends.wed import hindrance, source, trimmed
    from wedmcam.judge.difference import difference

    own = target_of(machine).own_path
    steppings = machine.stepping, own.stepping
    program, left_out = trimmed(program)
    pieces = np.ones(len(program.blocks), np.int64)
    for attempt in range(TRIES + 1):
        last = attempt == TRIES
        data, found = source(program, machine, name, pieces)
        found = [*left_out, *found]
        if has_errors(found):
            return b"", found
        made = compile_source(data, profile=own, name=f"{Path(name).name}.wed")
        reason = hindrance(program, machine)
        if not made.ok or made.program is None:
            if reason is not None:
                return b"", [*found, _no_words(*reason)]
            why = next(d for d in made.findings if d.severity is Severity.ERROR)
            text = f"the part program made of this program does not compile: {why.message}"
            hint = "convert to .dxf, which takes any path"
            return b"", [*found, error("conversion-differs", text, hint=hint)]
        apart = difference(program, made.program, *steppings, WITHIN_UM * max(1.0, program.step_um))
        if apart.equal:
            return data, found
        i = apart.block_a - 1
        if last or not program.blocks["turn"][i] or pieces[i] >= MOST_PIECES:
            if reason is not None:
                return b"", [*found, _no_words(*reason)]
            return b"", [*found, _differs("part", program, apart)]
        pieces[i] *= 2
    raise AssertionError  # the last try returns

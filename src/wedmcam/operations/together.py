"""One source, programs in several formats: each proven, and all of them the same path.

One plan serves all, with starts where every controller can start. Each format is compiled as if it
were alone, but with limits that all of them share, so that arcs and long lines are parted at the
same places. What was decoded from each is then stepped beside the
first: either all of them are good or none is.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.diag.run import Run, WrongUse
from wedmcam.files import bytes_of
from wedmcam.formats.names import FORMAT_OF_SUFFIX, SUFFIX_OF_FORMAT
from wedmcam.machines import Machine
from wedmcam.operations.compile import compile_plan, planned_for
from wedmcam.operations.convert import WITHIN_UM
from wedmcam.operations.profiles import starts_of
from wedmcam.options import Options
from wedmcam.targets import target_of

if TYPE_CHECKING:
    from wedmcam.compiler.results import Compilation
    from wedmcam.files import Source


@dataclass(frozen=True, slots=True, eq=False)
class Several:
    """What came of it.

    Attributes:
        compilations: one for each format, in their order; the last one is where it stopped, if not
            all are there.
        apart_um: how far each path is from the first at most; empty unless all are there.
        differs: an error for each that differs by more than 1 um.
    """

    compilations: tuple[Compilation, ...]
    apart_um: tuple[float, ...]
    differs: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether all were made and proven, and are the same path."""
        return bool(self.apart_um) and not self.differs

    @property
    def status(self) -> int:
        """The exit status: 0 done, 1 the input has errors, 3 a proof failed."""
        return 0 if self.ok else 3 if self.differs else self.compilations[-1].status

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """What was found, once for all formats."""
        every = [d for c in self.compilations for d in c.findings]
        kept = {(d.code, d.message, str(d.span)): d for d in reversed(every)}
        return (*reversed(kept.values()), *self.differs)


def compile_several(
    source: Source,
    machines: Sequence[Machine],
    *,
    name: str | None = None,
    output_names: Sequence[str] = (),
    options: Options | None = None,
    named: Collection[str] | None = None,
) -> Several:
    """Compile a drawing for several machines.

    Args:
        source: a path, or the bytes of a drawing.
        machines: one for each program.
        name: of the source.
        output_names: of the programs, for their certificates.
        options: the same for all.
        named: formats whose machine was named, and is not just the default; None for all.

    Example::

        from wedmcam.machines import default
        both = compile_several("bracket.dxf", [default("3b"), default("compact")])
    """
    compilations: list[Compilation] = []
    names = list(output_names) or [""] * len(machines)
    options = options or Options()
    data, name = bytes_of(source, name)
    run = Run(options.judging.strict)
    refused = planned_for(data, name, options, machines, run)
    for machine, output in zip(shared(machines), names, strict=True):
        by_name = named is None or any(machine.is_of(format_) for format_ in named)
        one = compile_plan(
            data, name, machine, options, run.forked(), output, refused, named=by_name
        )
        for other in machines:  # whose starts the plan has: whoever verifies plans with them again
            if not machine.is_of(other.format) and target_of(other).moves_starts:
                one.summary.update(starts_of(other))
        compilations.append(one)
        if not one.ok:
            return Several(tuple(compilations), (), ())
    return _compared(compilations)


def shared(machines: Sequence[Machine]) -> list[Machine]:
    """Return the machines with the smallest of their limits on a block; those count steps."""
    names = ("count_um", "line_um", "arc_um")
    least = {k: min(getattr(m.limits, k) * m.axes.step_um for m in machines) for k in names}

    def limited(machine: Machine) -> Machine:
        steps: dict[str, Any] = {k: int(um / machine.axes.step_um) for k, um in least.items()}
        return replace(machine, limits=replace(machine.limits, **steps))

    return list(map(limited, machines))


def _compared(compilations: list[Compilation]) -> Several:
    from wedmcam.judge.difference import difference

    apart, wrong = [], []
    first = compilations[0]
    assert first.program is not None
    for other in compilations:
        assert other.program is not None
        steppings = first.machine.stepping, other.machine.stepping
        within = _within(first, other)
        comparison = difference(first.program, other.program, *steppings, within)
        apart.append(comparison.largest_um)
        if not comparison.equal:
            wrong.append(
                error(
                    "conversion-differs",
                    "the {format} program is not the path of the {first_format} program at "
                    "{place} from the start: {difference}",
                    hint="compile the formats one by one",
                    format=other.machine.format,
                    first_format=first.machine.format,
                    place=Place.of_um(*comparison.at),
                    difference=comparison.what,
                )
            )
    return Several(tuple(compilations), tuple(apart), tuple(wrong))


def _within(one: Compilation, other: Compilation) -> float:
    """Return how far two programs of one plan may be apart, um.

    Formats that state the path are one to a step. A controller that makes the path itself (G41,
    4B), or whose path is coarse, is held to the plan: two such paths are apart by what each was
    found to be off at most.
    """
    assert one.verdict is not None
    assert other.verdict is not None
    assert one.program is not None
    stated = WITHIN_UM * max(1.0, one.program.step_um)
    targets = (target_of(c.machine) for c in (one, other))
    if not any(target.makes_path or target.coarse for target in targets):
        return stated
    return max(stated, one.verdict.max_deviation_um + other.verdict.max_deviation_um)


def formats_of(to: str) -> list[str]:
    """Return the formats of ``3b,compact``.

    Raises:
        WrongUse: an unknown one, or the same twice.
    """
    formats = [part.strip() for part in to.split(",")]
    for format_ in formats:
        if format_ not in SUFFIX_OF_FORMAT:
            known = ", ".join(SUFFIX_OF_FORMAT)
            raise WrongUse(f"no program format is called '{format_}': {known}")
    if len(set(formats)) < len(formats):
        raise WrongUse(f"--to {to} names a format twice")
    return formats


def names_of(output: str, formats: Sequence[str]) -> list[str]:
    """Return the name of each program: ``output`` with the ending of its format.

    An ending of a program format that is there already stays for its own, and is replaced for
    others.

    >>> names_of("plate", ["3b", "compact"]), names_of("out/plate.ngc", ["3b", "iso"])
    (['plate.3b', 'plate.zd'], ['out/plate.3b', 'out/plate.ngc'])
    """
    suffix = Path(output).suffix
    own = FORMAT_OF_SUFFIX.get(suffix.lower())
    stem = output if own is None else output[: -len(suffix)]
    return [stem + (suffix if format_ == own else SUFFIX_OF_FORMAT[format_]) for format_ in formats]

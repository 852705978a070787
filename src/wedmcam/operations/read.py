"""Read a program: bytes become blocks, as its machine means them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from wedmcam.diag import Diagnostic
from wedmcam.diag.run import Refused, Run
from wedmcam.files import Source, bytes_of
from wedmcam.frontends.answers import check_answers, nm_of
from wedmcam.frontends.iso.dialect import Dialect
from wedmcam.ir.program import Program
from wedmcam.judge.totals import figures as figures_of
from wedmcam.machines import Machine
from wedmcam.operations.profiles import reader_machine
from wedmcam.targets import Entries, target_of

#: Why a program whose controller makes the path is neither proven nor converted without its gap.
NO_GAP = "no gap is given: the program does not state how far the wire runs beside its outline"


def dialect_of(answers: Mapping[str, str | None], named: bool, shown: bool = False) -> Dialect:
    """Return the dialect that the answers give; keywords as in `frontends.answers.ANSWERS`.

    Args:
        answers: by keyword.
        named: its profile was named, and says the rest.
        shown: nothing is written or proven: what no answer tells is assumed.

    Raises:
        WrongUse: no such keyword or answer.
    """
    check_answers(answers)
    units, whole = (
        None if (unit := answers.get(name)) is None else nm_of(unit)
        for name in ("units_in", "whole_in")
    )
    return Dialect(
        coordinates=answers.get("coordinates_in"),
        units_nm=units,
        whole_nm=whole,
        centres=answers.get("centres_in"),
        semicolon=answers.get("semicolon_in"),
        subprograms=answers.get("subprograms_in"),
        named=named,
        shown=shown,
        asks=True,
    )


def read_program(
    source: Source,
    *,
    profile: Machine | str | None = None,
    format: str | None = None,
    name: str | None = None,
    entered: Entries | None = None,
    shown: bool = False,
    **answers: str | None,
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
        **answers: of an ISO program: ``units_in``, ``whole_in``, ``coordinates_in``,
            ``centres_in``, ``semicolon_in``, ``subprograms_in``, as in `ProgramReading`.

    Raises:
        WrongUse: an unknown format or profile, or another keyword.
    """
    data, name = bytes_of(source, name)
    machine = reader_machine(data, name, format, profile)
    target, dialect = target_of(machine), dialect_of(answers, profile is not None, shown)
    run = Run()
    try:
        entries = replace(entered or Entries(), dialect=dialect)
        decoded = run("decode", target.read(data, name, entries))
    except Refused:
        return None, machine, tuple(run.findings)
    if entered is None or entered.gap_um is None:
        run.add("decode", target.unstated(decoded))
    return decoded, machine, tuple(run.findings)


def figures(program: Program, machine: Machine) -> dict[str, Any]:
    """Return what a program does by itself: blocks, steps, closure, extents, limits, reversals."""
    return figures_of(program, machine.stepping, machine.limits)[0]

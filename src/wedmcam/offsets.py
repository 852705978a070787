"""Programs of which the path depends on the controller's table of offsets: G41 and G42 D.

The reader gives outlines, `transforms.controlled` says what the controller makes of them; here the
two meet, with the table that the operator enters.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from wedmcam.diag import Diagnostic, has_errors
from wedmcam.ir.program import LineTable, Program
from wedmcam.machines import Machine
from wedmcam.options import WrongUse

if TYPE_CHECKING:
    from wedmcam.frontends.compensation import Table
    from wedmcam.transforms.lower import Target

#: Pairs of a D number and its offset, um.
Given = Iterable[tuple[int, float]]


def decode(
    data: bytes, machine: Machine, file: str, table: Table | None = None
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that an ISO file means to a controller with these offsets.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile.
        file: name for the spans.
        table: D number -> offset, um; None to refuse G41 and G42.
    """
    from wedmcam.frontends.axes import to_drawing
    from wedmcam.frontends.iso import read

    made, found = read(data, machine, file, table)
    program = made.program
    if len(made.motions) and not has_errors(found):
        from wedmcam.transforms.controlled import applied

        # The controller offsets in its own frame: a mirror turns left and right around.
        done, more = applied(made, target_of(machine))
        program, found = (program if done is None else done), [*found, *more]
    return to_drawing(program, machine.axes), found


def table_of(given: Given, every: float | None = None) -> Table | None:
    """Return the table of an operator; None where nothing was entered.

    Args:
        given: D numbers and offsets, um.
        every: um, for all D numbers, where ``given`` is empty.

    Raises:
        WrongUse: an offset below 0, or two for one number.

    >>> table = table_of([(1, 100.0)])
    >>> table(1), table(2), table_of([], 90.0)(7)
    (100.0, None, 90.0)
    """
    entered: dict[int, float] = {}
    for number, offset in given:
        if offset < 0:
            raise WrongUse(f"--d {number}: an offset is not negative; G41 and G42 tell the side")
        if entered.setdefault(number, offset) != offset:
            raise WrongUse(f"--d {number} is given twice")
    if entered:
        return entered.get
    return None if every is None else lambda number: every


def target_of(machine: Machine) -> Target:
    """Return what lowering must know of a text machine, in the controller's own frame."""
    from wedmcam.transforms.lower import Target

    return Target(
        table=LineTable(machine.line_table),
        count_um=machine.limits.count_um,
        line_um=machine.limits.line_um,
        arc_um=machine.limits.arc_um,
    )

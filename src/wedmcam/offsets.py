"""Programs of which the path depends on the controller's table of offsets: G41 and G42 D.

The reader gives outlines, `transforms.controlled` says what the controller makes of them; here the
two meet, with the table that the operator enters.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wedmcam.diag import Diagnostic, TextSpan, has_errors
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.machines import Machine
from wedmcam.options import Options, WrongUse

if TYPE_CHECKING:
    from wedmcam.frontends.compensation import Table
    from wedmcam.frontends.dialect import Dialect
    from wedmcam.transforms.lower import Target
    from wedmcam.transforms.outlines import Grid, Written

#: How often other places of the grid are tried where the path would stray too far.
ROUNDS = 12

#: What was chosen for a motion: a row of `transforms.outlines.Written.chosen`.
Choice = tuple[int, int, int, int]
#: Pairs of a D number and its offset, um.
Given = Iterable[tuple[int, float]]


def decode(
    data: bytes,
    machine: Machine,
    file: str,
    table: Table | None = None,
    dialect: Dialect | None = None,
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that an ISO file means to a controller with these offsets.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile.
        file: name for the spans.
        table: D number -> offset, um; None to refuse G41 and G42.
        dialect: what is said beside the file; None: it is of this machine.
    """
    from wedmcam.frontends.axes import to_drawing
    from wedmcam.frontends.iso import read

    step = machine.axes.step_um  # what follows is in steps of the machine
    steps = table if table is None or step == 1 else _in_steps(table, step)
    made, found = read(data, machine, file, steps, dialect)
    program = made.program
    if len(made.motions) and not has_errors(found):
        from wedmcam.transforms.controlled import applied

        # The controller offsets in its own frame: a mirror turns left and right around.
        done, more = applied(made, target_of(machine))
        program, found = (program if done is None else done), [*found, *more]
    return to_drawing(program, machine.axes), found


def _in_steps(table: Table, step_um: float) -> Table:
    def steps(number: int) -> float | None:
        um = table(number)
        return None if um is None else um / step_um

    return steps


def started(plan: Plan, machine: Machine) -> tuple[Plan | None, list[Diagnostic]]:
    """Return a plan whose paths start where a controller that offsets them can start."""
    from wedmcam.transforms import outlines

    return outlines.started(plan, grid_of(machine)) if machine.offsets else (plan, [])


def numbers(plan: Plan, machine: Machine) -> dict[int, float]:
    """Return what is to be entered at the controller: D number -> um; none for others."""
    from wedmcam.transforms import outlines

    return outlines.numbers(plan, machine.iso.d) if machine.offsets else {}


def of_cuts(plan: Plan) -> list[float]:
    """Return the offset of each cut, um: cuts of a part program have their own."""
    return [cut.offset_um for cut in plan.cuts]


def said(plan: Plan) -> str:
    """Return the offsets of all cuts for people: one, or each that occurs."""
    return ", ".join(f"{um / 1000:.3f}" for um in sorted(set(of_cuts(plan)))) + " mm"


def entered(plan: Plan, machine: Machine, options: Options) -> Options:
    """Return the options with what is to be entered at the controller."""
    return replace(options, d=tuple(numbers(plan, machine).items())) if machine.offsets else options


def told(d: Given) -> list[tuple[str, str]]:
    """Return what is to be entered at the controller, for people.

    >>> told([(1, 101.6)])
    [('D1', '0.1016 mm')]
    """
    return [(f"D{number}", f"{um / 1000:.4f} mm") for number, um in d]


def encode(
    plan: Plan, lowered: Program, machine: Machine, options: Options
) -> tuple[bytes, list[Diagnostic]]:
    """Return the ISO file in which the outlines of a plan stand with G41 or G42.

    Args:
        plan: whose paths start where `started` put them.
        lowered: the same plan in blocks.
        machine: an ISO profile of a controller that offsets.
        options: as asked for.

    Raises:
        WrongUse: for what such a controller has no words.
    """
    from wedmcam.backends.axes import to_controller
    from wedmcam.backends.fit import travel

    if machine.axes.step_um != 1:
        raise WrongUse(
            f"the profile '{machine.name}' has step_um and compensation = \"controller\": outlines "
            "are written in um"
        )
    if options.sharp:
        raise WrongUse("--convex sharp is not what the controller makes of corners: leave it out")
    if any(cut.overcut_um for cut in plan.cuts):
        raise WrongUse("--overcut runs back in the kerf, where G41 and G42 change sides")
    found = travel(to_controller(lowered, machine.axes), machine)
    if has_errors(found):
        return b"", found
    table = numbers(plan, machine)
    writer = _Writer(lowered, machine, table)
    data, more, strays = writer.tried(plan, [])
    if strays:
        kept: list[Choice] = []
        for n in sorted({choice[0] for choice in strays}):
            kept += writer.settled(plan, n, [c for c in strays if c[0] == n])
        data, more, _ = writer.tried(plan, kept)
    return data, [*found, *more]


class _Writer:
    """Outlines as bytes, and along which of their motions the wire would stray too far.

    Rounding twice, of the outline and of the path, may be too much where each alone is not. So a
    program is looked at as it will be judged, and other places of the grid are tried where it
    strays, contour by contour. It is judged again all the same.
    """

    def __init__(self, lowered: Program, machine: Machine, table: dict[int, float]) -> None:
        from wedmcam.source_map import block_ends

        self.lowered, self.machine, self.table = lowered, machine, table
        self.ends = block_ends(lowered, machine)[1]
        self.grid = grid_of(machine)

    def tried(
        self, plan: Plan, not_again: list[Choice]
    ) -> tuple[bytes, list[Diagnostic], list[Choice]]:
        """Return the bytes (empty where there are errors), findings, and what strays."""
        from wedmcam.backends.axes import outlines_to_controller
        from wedmcam.backends.iso import encode_outlines
        from wedmcam.transforms import outlines

        made, found = outlines.written(
            plan, self.lowered, self.ends, self.grid, self.table, not_again
        )
        if made is None:
            return b"", found, []
        written, ends = outlines_to_controller(made.programmed, made.ends, self.machine.axes)
        data, found = encode_outlines(written, ends, self.machine)
        return data, found, _strays(data, made, plan, self.machine, self.table)

    def settled(self, plan: Plan, number: int, strays: list[Choice]) -> list[Choice]:
        """Return what must not be chosen for one contour, that it strays nowhere or least."""
        alone = replace(plan, cuts=(plan.cuts[number],), partial=True)
        bad = [(0, *choice[1:]) for choice in strays]
        best, least = bad, len(strays) + 1
        for _ in range(ROUNDS):
            _, _, again = self.tried(alone, bad)
            if len(again) < least:
                best, least = list(bad), len(again)
            new = [choice for choice in again if choice not in bad]
            if not new:
                break
            bad = [*bad, *new]
        return [(number, *choice[1:]) for choice in best]


def _strays(
    data: bytes, made: Written, plan: Plan, machine: Machine, table: dict[int, float]
) -> list[Choice]:
    """Return what was chosen for the motions along which the wire would stray too far."""
    from wedmcam.frontends.iso import read
    from wedmcam.judge.judge import judge

    program, found = decode(data, machine, "program", table.get)
    if has_errors(found):
        return []  # another place of the grid is no cure for that
    outline, _ = read(data, machine, "program", table.get)
    rows = {
        span.line: mark
        for span, mark in zip(outline.program.spans, outline.mark.tolist(), strict=True)
        if mark >= 0 and isinstance(span, TextSpan)
    }
    placed = replace(program, origin=plan.cuts[0].thread)
    verdict, found = judge(placed, plan, stepping=machine.stepping, limits=machine.limits)
    if not has_errors(found):
        return []
    t = verdict.table
    keeps = {k + 1: cut.keeps_left for k, cut in enumerate(plan.cuts)}
    left = np.array([keeps.get(int(n)) is True for n in t.cut])
    right = np.array([keeps.get(int(n)) is False for n in t.cut])
    limit, gouge = verdict.path_limit_um, verdict.gouge_limit_um
    off = (np.maximum(np.abs(t.low), np.abs(t.high)) > limit) | (left & (t.high > gouge))
    off |= right & (t.low < -gouge)
    lines = {getattr(program.spans[int(n) - 1], "line", 0) for n in t.block[off]}
    marks = {rows[line] for line in lines if line in rows}
    chosen = {tuple(made.chosen[m].tolist()) for m in marks if m < len(made.chosen)}
    return [c for c in sorted(chosen) if c[0] >= 0]


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


def grid_of(machine: Machine) -> Grid:
    """Return what the numbers of an ISO profile can state."""
    from wedmcam.transforms.outlines import Grid

    how = machine.iso
    step = 1.0 if how.unit == "um" else 10.0 ** (3 - how.decimals)
    return Grid(step, machine.limits.line_um, machine.limits.arc_um)


def target_of(machine: Machine) -> Target:
    """Return what lowering must know of a text machine, in the controller's own frame."""
    from wedmcam.transforms.lower import Target

    return Target(
        stepping=machine.own_stepping,
        count_um=machine.limits.count_um,
        line_um=machine.limits.line_um,
        arc_um=machine.limits.arc_um,
    )

"""Programs whose path depends on the controller's table of offsets: G41 and G42 D.

The reader gives outlines, `transforms.controlled` says what the controller makes of them; here the
two meet, with the table that the operator enters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity, TextSpan, error, has_errors, note
from wedmcam.diag.run import WrongUse
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import Entries
from wedmcam.targets.stated import Iso

if TYPE_CHECKING:
    from wedmcam.frontends.iso.dialect import Dialect
    from wedmcam.frontends.iso.modes import Table
    from wedmcam.transforms.lower import Rules
    from wedmcam.transforms.outlines import Grid, Written

#: How often other places of the grid are tried where the path would stray too far.
ROUNDS = 12

#: What the judge says where two roundings are too much.
FAR = frozenset({"path-deviation", "gouge", "not-closed"})

#: What helps where the controller cannot offset an outline.
OTHER = "a profile that states the path itself (iso-um, iso-mm), or another offset"

#: What was chosen for a motion: a row of `transforms.outlines.Written.chosen`.
Choice = tuple[int, int, int, int]


def decode(
    data: bytes,
    machine: Machine,
    file: str,
    table: Table | None = None,
    dialect: Dialect | None = None,
    assumed: bool = False,
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that an ISO file means to a controller with these offsets.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile.
        file: name for the spans.
        table: D number -> offset, um; None to refuse G41 and G42.
        dialect: what is said beside the file; None: it is of this machine.
        assumed: the table is that of a drawing: one in the file wins.
    """
    from wedmcam.frontends.axes import to_drawing
    from wedmcam.frontends.iso import read

    step = machine.axes.step_um  # what follows is in steps of the machine
    steps = table if table is None or step == 1 else _in_steps(table, step)
    made, found = read(data, machine, file, steps, dialect, assumed)
    program = made.program
    if len(made.motions) and not has_errors(found):
        from wedmcam.transforms.controlled import applied

        # The controller offsets in its own frame: a mirror turns left and right around.
        done, more = applied(made, rules_of(machine))
        program, found = (program if done is None else done), [*found, *more]
    return to_drawing(program, machine.axes), found


def _in_steps(table: Table, step_um: float) -> Table:
    def steps(number: int) -> float | None:
        um = table(number)
        return None if um is None else um / step_um

    return steps


class Offsetting(Iso):
    """A controller that offsets outlines by itself: G41, G42 and D numbers."""

    makes_path = True
    moves_starts = True
    needs_lead = "G41 and G42 are taken up on a lead, and there is none in the kerf"

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """See `Target`."""
        return (
            note(
                "not-reachable",
                "the outline and the path of the controller are both rounded to its grid: some "
                "places come out farther from the path than is allowed",
                hint="a profile with more digits (iso-g41-mm), or one that does not leave the "
                "offset to the controller",
            ),
        )

    def place_starts(self, plan: Plan) -> tuple[Plan | None, Sequence[Diagnostic]]:
        """Beside a segment: it is particular about where paths start."""
        from wedmcam.transforms import outlines

        behind = [cut for cut in plan.cuts if cut.offset_um < 0]
        if behind:
            um = -behind[0].offset_um / 1000
            what = (
                f"the clearance puts the wire {um:.3f} mm behind the line: no D number is below 0"
            )
            hint = "a profile that does not leave the offset to the controller"
            return None, [error("not-reachable", what, behind[0].path.source_of(0), hint=hint)]
        return outlines.started(plan, grid_of(self.machine))

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """See `Iso.entered`; of a plan with several offsets the D numbers that a compile states."""
        said = super().entered(entries, plan)
        if said.d or said.every_um is not None or plan is None:
            return said
        return self.entries(plan) if all(cut.offset_um for cut in plan.cuts) else said

    def entries(self, plan: Plan) -> Entries:
        """A number for each offset."""
        from wedmcam.transforms import outlines

        twice = float(self.machine.iso.entry_factor)
        offsets = outlines.numbers(plan, self.machine.iso.d)
        return self._of_table(Entries(d=tuple((n, twice * um) for n, um in offsets.items())))

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`."""
        return encode(plan, program, self.machine, entries, feed_um, sharp)

    @property
    def refuses_carried(self) -> Diagnostic | None:
        """A program from elsewhere has no outline to write."""
        return self.refuses_written or error(
            "not-in-format",
            f"the profile '{self.machine.name}' wants outlines that the controller offsets, and a "
            "program has only the path of the wire",
            hint="compile the drawing with this profile, or convert with a profile that takes the "
            "path (iso-um, iso-mm)",
        )


def iso_target(machine: Machine) -> Iso:
    """Return the target of an ISO profile: of a path, or of outlines."""
    return (Offsetting if machine.iso.compensation == "controller" else Iso)(machine)


def encode(
    plan: Plan,
    lowered: Program,
    machine: Machine,
    entries: Entries,
    feed_um: float | None = None,
    sharp: bool = False,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the ISO file in which the outlines of a plan stand with G41 or G42.

    Args:
        plan: whose paths start where `Offsetting.place_starts` put them.
        lowered: the same plan in blocks.
        machine: an ISO profile of a controller that offsets.
        entries: its D numbers.
        feed_um: cutting speed, um a minute, for a profile that writes F.
        sharp: the corners of the plan were prolonged.

    Raises:
        WrongUse: for what such a controller has no words.
    """
    from wedmcam.backends.axes import to_controller
    from wedmcam.backends.checks import travel

    if machine.axes.step_um != 1:
        raise WrongUse(
            f"the profile '{machine.name}' has step_um and compensation = \"controller\": outlines "
            "are written in um"
        )
    if sharp:
        raise WrongUse("--convex sharp is not what the controller makes of corners: leave it out")
    if any(cut.overcut_um for cut in plan.cuts):
        raise WrongUse("--overcut runs back in the kerf, where G41 and G42 change sides")
    found = travel(to_controller(lowered, machine.axes), machine)
    if has_errors(found):
        return b"", found
    offset_of = entries.offset_of()
    table = {n: offset_of(n) or 0.0 for n, _ in entries.d} if offset_of is not None else {}
    writer = _Writer(lowered, machine, table, feed_um)
    tried = writer.tried(plan, [])
    if tried.strays:
        kept: list[Choice] = []
        for n in sorted({choice[0] for choice in tried.strays}):
            kept += writer.settled(plan, n, [c for c in tried.strays if c[0] == n])
        tried = writer.tried(plan, kept)
    more = tried.found
    if tried.data and not has_errors(more):
        more = [*more, *(_lost(tried.data, plan, machine, table) or tried.far)]
    return tried.data, [*found, *more]


def _lost(data: bytes, plan: Plan, machine: Machine, table: dict[int, float]) -> list[Diagnostic]:
    """Return errors where the controller makes no path of its outlines.

    An arc of the radius of the offset, a wall as long as a corner is deep: the shifted blocks of
    the written outline do not meet, whatever the exact ones do.
    """
    program, found = decode(data, machine, "program", table.get)
    if not has_errors(found):
        return _torn(program, plan, machine)
    x, y = plan.cuts[0].thread
    place = f"({x / 1000:.3f}, {y / 1000:.3f}) mm"
    return [
        replace(d.extended(f"; the program starts at {place}"), span=None, hint_template=OTHER)
        for d in found
        if d.severity is Severity.ERROR
    ]


class _Tried(NamedTuple):
    """An outline as it was written.

    Attributes:
        data: its bytes, empty where there are errors.
        found: findings of writing it.
        strays: what was chosen for the motions along which the wire would stray too far.
        far: an error where it would, whatever was chosen; else empty.
    """

    data: bytes
    found: list[Diagnostic]
    strays: list[Choice]
    far: list[Diagnostic]


class _Writer:
    """Outlines as bytes, and along which of their motions the wire would stray too far.

    Rounding twice, of the outline and of the path, may be too much where each alone is not. So a
    program is looked at as it will be judged, and other places of the grid are tried where it
    strays, contour by contour. It is judged again all the same.
    """

    def __init__(
        self,
        lowered: Program,
        machine: Machine,
        table: dict[int, float],
        feed_um: float | None,
    ) -> None:
        from wedmcam.programs.places import block_ends

        self.feed_um = feed_um
        self.lowered, self.machine, self.table = lowered, machine, table
        self.ends = block_ends(lowered, machine)[1]
        self.grid = grid_of(machine)

    def tried(self, plan: Plan, not_again: list[Choice]) -> _Tried:
        """Write a plan without some choices, and see how far the wire would stray."""
        from wedmcam.backends.axes import outlines_to_controller
        from wedmcam.backends.iso import encode_outlines
        from wedmcam.transforms import outlines

        made, found = outlines.written(
            plan, self.lowered, self.ends, self.grid, self.table, not_again
        )
        if made is None:
            return _Tried(b"", found, [], [])
        written, ends = outlines_to_controller(made.programmed, made.ends, self.machine.axes)
        data, found = encode_outlines(written, ends, self.machine, self.feed_um)
        return _Tried(data, found, *_strays(data, made, plan, self.machine, self.table))

    def settled(self, plan: Plan, number: int, strays: list[Choice]) -> list[Choice]:
        """Return what must not be chosen for one contour, that it strays nowhere or least."""
        alone = replace(plan, cuts=(plan.cuts[number],), partial=True)
        bad = [(0, *choice[1:]) for choice in strays]
        best, least = bad, len(strays) + 1
        for _ in range(ROUNDS):
            again = self.tried(alone, bad).strays
            if len(again) < least:
                best, least = list(bad), len(again)
            new = [choice for choice in again if choice not in bad]
            if not new:
                break
            bad = [*bad, *new]
        return [(number, *choice[1:]) for choice in best]


def _torn(program: Program, plan: Plan, machine: Machine) -> list[Diagnostic]:
    """Return errors for cuts that end beside their start.

    Where a path starts, and where it pauses, one segment of the outline is written as two. On the
    grid these have two directions; of a short one the offset turns that into a step or more.
    """
    from wedmcam.programs.places import block_ends

    starts, ends = block_ends(replace(program, origin=plan.cuts[0].thread), machine)
    kind = program.blocks["kind"]
    cutting = kind < Kind.MOVE
    group = np.cumsum(kind == Kind.MOVE)
    of = [np.flatnonzero(cutting & (group == g)) for g in np.unique(group[cutting])]
    if len(of) != len(plan.cuts):
        return []  # a cut begins where the one before it was threaded
    found = []
    for rows, cut in zip(of, plan.cuts, strict=True):
        here = np.array([float(cut.path.vertices[k][0]) for k in ("x", "y")])
        first = _nearer(ends[rows[0]], starts[rows[0]], here)
        last = _nearer(starts[rows[-1]], ends[rows[-1]], here)
        apart = np.hypot(*(last - first)) if cut.path.closed else 0.0
        if apart > 0:
            x, y = (here / 1000).tolist()
            text = (
                f"the controller's path from ({x:.3f}, {y:.3f}) mm ends {apart / 1000:.4f} mm "
                "beside its start: both are rounded to its grid"
            )
            hint = f"another thread point or --stop, or {OTHER}"
            found.append(
                error("not-reachable", text, cut.path.source_of(0), points_mm=((x, y),), hint=hint)
            )
    return found


def _nearer(
    inner: NDArray[np.float64], outer: NDArray[np.float64], here: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the end of a first or last block where the path starts: its outer one without a lead.

    Of a wire threaded on its path the lead runs in the outline alone: the path has no block of it.
    """
    return outer if np.hypot(*(outer - here)) < np.hypot(*(inner - here)) else inner


def _far(why: Diagnostic) -> Diagnostic:
    """Return the error of a writer whose outline no choice of the grid makes good."""
    text = f"the outline and the controller's path are both rounded to its grid: {why.message}"
    return replace(why, code="not-reachable", template=text, span=None, hint_template=OTHER)


def _strays(
    data: bytes, made: Written, plan: Plan, machine: Machine, table: dict[int, float]
) -> tuple[list[Choice], list[Diagnostic]]:
    """Return what was chosen for the motions along which the wire strays too far, and an error."""
    from wedmcam.frontends.iso import read
    from wedmcam.judge.judge import judge

    program, found = decode(data, machine, "program", table.get)
    if has_errors(found):
        return [], []  # another place of the grid is no cure for that
    outline, _ = read(data, machine, "program", table.get)
    rows = {
        span.line: mark
        for span, mark in zip(outline.program.spans, outline.mark.tolist(), strict=True)
        if mark >= 0 and isinstance(span, TextSpan)
    }
    placed = replace(program, origin=plan.cuts[0].thread)
    verdict, found = judge(
        placed,
        plan,
        stepping=machine.stepping,
        limits=machine.limits,
        free_moves=machine.move_um is None,
    )
    if not has_errors(found):
        return [], []
    far = [_far(d) for d in found if d.code in FAR and d.severity is Severity.ERROR][:1]
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
    return [c for c in sorted(chosen) if c[0] >= 0], far


def grid_of(machine: Machine) -> Grid:
    """Return what the numbers of an ISO profile can state."""
    from wedmcam.transforms.outlines import Grid

    how = machine.iso
    step = 1.0 if how.unit == "um" else 10.0 ** (3 - how.decimals)
    return Grid(step, machine.limits.line_um, machine.limits.arc_um)


def rules_of(machine: Machine) -> Rules:
    """Return what lowering must know of a text machine, in the controller's own frame."""
    from wedmcam.transforms.lower import Rules

    return Rules(
        stepping=machine.own_stepping,
        count_um=machine.limits.count_um,
        line_um=machine.limits.line_um,
        arc_um=machine.limits.arc_um,
    )

"""Outlines of a plan as an ISO program with G41 and G42, on the places of the grid that hold.

Outline and path are both rounded. So a program is read back as the judge will read it, and where
the controller's path strays, other places of the grid are tried (`transforms.outlines`): a search
by the judge, and the bytes that are found are judged again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place, Severity, TextSpan, error, has_errors
from wedmcam.diag.run import WrongUse
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import Entries
from wedmcam.targets.g41.read import decode

if TYPE_CHECKING:
    from wedmcam.transforms.outlines import Grid, Outlines

#: How often other places of the grid are tried where the path would stray too far.
ROUNDS = 12

#: What the judge says where two roundings are too much.
FAR = frozenset({"path-deviation", "gouge", "not-closed"})

#: What helps where the controller cannot offset an outline.
OTHER = "a profile that states the path itself (iso-um, iso-mm), or another offset"

#: What was chosen for a motion: a row of `transforms.outlines.Outlines.chosen`.
Choice = tuple[int, int, int, int]


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
    findings = travel(to_controller(lowered, machine.axes), machine)
    if has_errors(findings):
        return b"", findings
    offset_of = entries.offset_of()
    table = {n: offset_of(n) or 0.0 for n, _ in entries.d} if offset_of is not None else {}
    writer = _Writer(lowered, machine, table, feed_um)
    attempt = writer.attempt(plan, [])
    if attempt.strays:
        bans: list[Choice] = []
        for n in sorted({choice[0] for choice in attempt.strays}):
            bans += writer.settle_contour(plan, n, [c for c in attempt.strays if c[0] == n])
        attempt = writer.attempt(plan, bans)
    more = attempt.findings
    if attempt.decoded is not None and not has_errors(more):
        more = [*more, *(_path_errors(*attempt.decoded, plan, machine) or attempt.far)]
    return attempt.data, [*findings, *more]


def _path_errors(
    program: Program, findings: list[Diagnostic], plan: Plan, machine: Machine
) -> list[Diagnostic]:
    """Return errors where the controller makes no path of its outlines, as ``decode`` found.

    An arc of the radius of the offset, a wall as long as a corner is deep: the shifted blocks of
    the written outline do not meet, whatever the exact ones do.
    """
    if not has_errors(findings):
        return _closing_errors(program, plan, machine)
    start = Place.of_um(*plan.cuts[0].thread)
    return [
        replace(d, span=None)
        .extended("; the program starts at {start}", start=start)
        .with_hint(OTHER)
        for d in findings
        if d.severity is Severity.ERROR
    ]


class _Attempt(NamedTuple):
    """An outline as it was written.

    Attributes:
        data: its bytes, empty where there are errors.
        findings: of writing it.
        strays: what was chosen for the motions along which the wire would stray too far.
        far: an error where it would, whatever was chosen; else empty.
        decoded: what the controller makes of the bytes, and its findings; None without bytes.
    """

    data: bytes
    findings: list[Diagnostic]
    strays: list[Choice]
    far: list[Diagnostic]
    decoded: tuple[Program, list[Diagnostic]] | None = None


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

    def attempt(self, plan: Plan, bans: list[Choice]) -> _Attempt:
        """Write a plan without some choices, and see how far the wire would stray."""
        from wedmcam.backends.axes import outlines_to_controller
        from wedmcam.backends.iso import encode_outlines
        from wedmcam.transforms import outlines

        drawn, findings = outlines.write_outlines(
            plan, self.lowered, self.ends, self.grid, self.table, bans
        )
        if drawn is None:
            return _Attempt(b"", findings, [], [])
        own, ends = outlines_to_controller(drawn.programmed, drawn.ends, self.machine.axes)
        data, findings = encode_outlines(own, ends, self.machine, self.feed_um)
        decoded = decode(data, self.machine, "program", self.table.get)
        if has_errors(decoded[1]):  # another place of the grid is no cure
            return _Attempt(data, findings, [], [], decoded)
        strays, far = _strays(data, decoded[0], drawn, plan, self.machine, self.table)
        return _Attempt(data, findings, strays, far, decoded)

    def settle_contour(self, plan: Plan, number: int, strays: list[Choice]) -> list[Choice]:
        """Return what must not be chosen for one contour, that it strays nowhere or least."""
        alone = replace(plan, cuts=(plan.cuts[number],), partial=True)
        bad = [(0, *choice[1:]) for choice in strays]
        best, least = bad, len(strays) + 1
        for _ in range(ROUNDS):
            again = self.attempt(alone, bad).strays
            if len(again) < least:
                best, least = list(bad), len(again)
            new = [choice for choice in again if choice not in bad]
            if not new:
                break
            bad = [*bad, *new]
        return [(number, *choice[1:]) for choice in best]


def _closing_errors(program: Program, plan: Plan, machine: Machine) -> list[Diagnostic]:
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
    errors = []
    for rows, cut in zip(of, plan.cuts, strict=True):
        here = np.array([float(cut.path.vertices[k][0]) for k in ("x", "y")])
        first = _nearer(ends[rows[0]], starts[rows[0]], here)
        last = _nearer(starts[rows[-1]], ends[rows[-1]], here)
        apart = np.hypot(*(last - first)) if cut.path.closed else 0.0
        if apart > 0:
            x, y = (here / 1000).tolist()
            errors.append(
                error(
                    "not-reachable",
                    "the controller's path from {start} ends {gap_mm:.4f} mm beside its start: "
                    "both are rounded to its grid",
                    cut.path.source_of(0),
                    points_mm=((x, y),),
                    hint="another thread point or --stop, or a profile that states the path itself "
                    "(iso-um, iso-mm), or another offset",
                    start=Place.of_um(*here.tolist()),
                    gap_mm=float(apart) / 1000,
                )
            )
    return errors


def _nearer(
    inner: NDArray[np.float64], outer: NDArray[np.float64], here: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the end of a first or last block where the path starts: its outer one without a lead.

    Of a wire threaded on its path the lead runs in the outline alone: the path has no block of it.
    """
    return outer if np.hypot(*(outer - here)) < np.hypot(*(inner - here)) else inner


def _far(why: Diagnostic) -> Diagnostic:
    """Return the error of a writer whose outline no choice of the grid makes good."""
    return error(
        "not-reachable",
        "the outline and the controller's path are both rounded to its grid: {reason}",
        points_mm=why.points_mm,
        count=why.count,
        notes=why.notes,
        hint=OTHER,
        reason=why.message,
    )


def _strays(
    data: bytes,
    program: Program,
    outlines: Outlines,
    plan: Plan,
    machine: Machine,
    table: dict[int, float],
) -> tuple[list[Choice], list[Diagnostic]]:
    """Return what was chosen for the motions along which the wire strays too far, and an error.

    ``program`` is what the controller makes of the bytes of the outlines.
    """
    from wedmcam.frontends.iso import read
    from wedmcam.judge.judge import judge

    placed = replace(program, origin=plan.cuts[0].thread)
    verdict, findings = judge(
        placed,
        plan,
        stepping=machine.stepping,
        limits=machine.limits,
        free_moves=machine.move_um is None,
    )
    if not has_errors(findings):
        return [], []
    outline, _ = read(data, machine, "program", table.get)
    rows = {
        span.line: mark
        for span, mark in zip(outline.program.spans, outline.mark.tolist(), strict=True)
        if mark >= 0 and isinstance(span, TextSpan)
    }
    far = [_far(d) for d in findings if d.code in FAR and d.severity is Severity.ERROR][:1]
    t = verdict.table
    keeps = {k + 1: cut.keeps_left for k, cut in enumerate(plan.cuts)}
    left = np.array([keeps.get(int(n)) is True for n in t.cut])
    right = np.array([keeps.get(int(n)) is False for n in t.cut])
    limit, gouge = verdict.path_limit_um, verdict.gouge_limit_um
    off = (np.maximum(np.abs(t.low), np.abs(t.high)) > limit) | (left & (t.high > gouge))
    off |= right & (t.low < -gouge)
    lines = {getattr(program.spans[int(n) - 1], "line", 0) for n in t.block[off]}
    marks = {rows[line] for line in lines if line in rows}
    chosen = {tuple(outlines.chosen[m].tolist()) for m in marks if m < len(outlines.chosen)}
    return [c for c in sorted(chosen) if c[0] >= 0], far


def grid_of(machine: Machine) -> Grid:
    """Return what the numbers of an ISO profile can state."""
    from wedmcam.transforms.outlines import Grid

    how = machine.iso
    step = 1.0 if how.unit == "um" else 10.0 ** (3 - how.decimals)
    return Grid(step, machine.limits.line_um, machine.limits.arc_um)

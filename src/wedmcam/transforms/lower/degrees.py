"""Lowering for a controller that turns whole degrees: arcs of its base circle, short lines between.

An arc begins where a whole degree is and ends where one is; what lies before and behind is a line
shorter than a degree. The machine keeps the fraction of a um that a degree leaves, across blocks; so
a tape is made in order, every arc is tried with the residues that the machine will have, and begins
at that um near its true place, and with that whole radius, from which its vertices stray least.
Where they would stray too far all the same, the arc is parted and goes on from a better um.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.nby15.base_circle import (
    HALF,
    RADIUS,
    SHIFT,
    along,
    arc_limit_um,
    sagitta_um,
)
from wedmcam.controllers.nby15.data import TAPE, TapeProgram, program_of
from wedmcam.diag import Diagnostic, warning
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind
from wedmcam.transforms.lower import moves
from wedmcam.transforms.lower.layout import Layout, lay_out
from wedmcam.transforms.lower.marks import short_marks

if TYPE_CHECKING:
    from wedmcam.transforms.lower import Rules

#: An end of an arc this near to a whole degree is on it, um along the arc.
ON_DEGREE_UM = 0.3
#: A vertex this near to where the machine stands, um, needs no line of its own.
THERE_UM = 0.8
#: Vertices of an arc stray by at most this from its circle, um; else it is parted.
STRAY_UM = 0.95
#: What an extra line of a um costs, and a um off the true start, in um of stray.
LINE_COST, OFF_COST = 0.45, 0.02
#: Sagitta of the chords of an arc whose radius the format does not hold, um.
CHORD_SAG_UM = 0.3
_NEAR = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], np.int64)


@dataclass(slots=True)
class _Tape:
    """The tape so far, and where the machine stands behind it.

    Attributes:
        rows: of dtype `TAPE`.
        at: where the machine stands, whole um.
        sums: residues of x and y, `HALF` at the start.
        goal: a place that is to be reached by a line which is not written yet, and what it is of;
            None where there is none.
    """

    at: Ints
    rows: list[tuple[int, ...]] = field(default_factory=list)
    sums: Ints = field(default_factory=lambda: np.array([HALF, HALF], np.int64))
    goal: tuple[Ints, tuple[int, int, int]] | None = None

    def line(self, to: Ints, of: tuple[int, int, int], kind: Kind = Kind.LINE) -> None:
        """Go straight to a whole um; no block where the machine stands there."""
        way = to - self.at
        if way.any():
            role, source, cut = of
            self.rows.append((kind, 0, role, int(way[0]), int(way[1]), 0, 0, 0, source, cut))
            self.at = to

    def control(self, kind: Kind) -> None:
        """Write a control."""
        self.rows.append((kind, 0, 0, 0, 0, 0, 0, 0, -1, 0))

    def flush(self) -> None:
        """Write the line to the goal."""
        if self.goal is not None:
            to, of = self.goal
            self.goal = None
            self.line(to, of)

    def turn(self, turn: int, start: int, radius: int, way: Ints, of: tuple[int, int, int]) -> None:
        """Turn over the degrees whose places on the base circle are ``way``."""
        role, source, cut = of
        self.rows.append(
            (Kind.ARC, turn, role, 0, 0, radius, start % 360, len(way) - 1, source, cut)
        )
        sums = self.sums + radius * way[-1]
        self.at = self.at + (sums >> SHIFT)
        self.sums = sums & (RADIUS - 1)


def lower_to_degrees(plan: Plan, rules: Rules) -> tuple[TapeProgram | None, list[Diagnostic]]:
    """Return the program of a plan as a tape of whole degrees, and what had to be done to make it.

    Findings: ``move-too-long``, ``stop-too-short``, ``overcut-too-short`` (errors) and
    ``radius-over-limit`` (warning: chords).
    """
    layout = lay_out(plan)
    findings = short_marks(to_grid(layout.x), to_grid(layout.y), layout, plan, rules)
    findings += [d for i in range(1, len(plan.cuts)) for d in moves.too_long(plan, i, rules)]
    if findings:
        return None, findings
    tape = _Tape(np.array(plan.cuts[0].thread, np.int64))
    groups = np.array(layout.group)
    for index, cut in enumerate(plan.cuts):
        thread = np.array(cut.thread, np.int64)
        if index:
            tape.control(Kind.PAUSE)
            if (tape.at != thread).any():
                tape.line(thread, (0, -1, 0), Kind.MOVE)
                tape.control(Kind.PAUSE)
        for n, group in enumerate(layout.cut_groups[index]):
            if n:
                tape.control(Kind.PAUSE)
            first, last = np.searchsorted(groups, [group, group + 1]).tolist()
            for k in range(first, last):
                findings += _segment(tape, layout, k, rules)
                if k + 1 == last or layout.role[k + 1] != layout.role[k]:
                    # Leads, contours, overcuts and pauses end on the very um.
                    tape.flush()
                    tape.line(_vertex(layout, layout.v1[k]), _of(layout, k))
    tape.control(Kind.STOP)
    table = np.array(tape.rows, TAPE)
    return program_of(table, plan.cuts[0].thread, tuple(layout.sources)), findings


def _of(layout: Layout, k: int) -> tuple[int, int, int]:
    return layout.role[k], layout.source[k], layout.cut[k]


def _vertex(layout: Layout, v: int) -> Ints:
    """Return the whole um nearest to a vertex."""
    return np.asarray(to_grid([layout.x[v], layout.y[v]]))


def _segment(tape: _Tape, layout: Layout, k: int, rules: Rules) -> list[Diagnostic]:
    """Run one segment; a line that ends it may stay a goal, which an arc behind it moves by a um."""
    v0, v1, of, turn = layout.v0[k], layout.v1[k], _of(layout, k), layout.turn[k]
    goal = _vertex(layout, v1)
    if turn == 0:
        tape.flush()
        tape.goal = (goal, of)
        return []
    radius, centre = layout.radius[k], np.array([layout.cx[k], layout.cy[k]])
    (bx, by), (ex, ey) = (
        np.array([layout.x[v], layout.y[v]]) - centre for v in (v0, v1)
    )
    # Angles along the sense of the arc: whole degrees are whole there too.
    begin = turn * float(np.degrees(np.arctan2(by, bx)))
    sweep = (turn * float(np.degrees(np.arctan2(ey, ex))) - begin) % 360.0
    sweep = 360.0 if v0 == v1 else sweep
    if radius > rules.arc_um:
        return [_chords(tape, layout, k, begin, sweep, rules)]
    room = min(np.degrees(ON_DEGREE_UM / max(radius, 1e-3)), 0.49)
    low, high = int(np.ceil(begin - room)), int(np.floor(begin + sweep + room))
    high = min(high, low + 360)
    if high < low or round(radius) < 1:
        tape.flush()
        tape.goal = (goal, of)
        return []
    before, behind = (np.radians(a) * radius for a in (low - begin, begin + sweep - high))
    if before > THERE_UM:
        tape.flush()
    if high > low:
        _arc(tape, centre, radius, turn, low, high, of)
    elif before > THERE_UM:
        tape.line(_place(centre, radius, turn * low), of)
    if behind > THERE_UM:
        tape.flush()
        tape.goal = (goal, of)
    return []


def _place(centre: Floats, radius: float, degree: int) -> Ints:
    """Return the whole um nearest to a degree of a circle."""
    angle = np.radians(degree)
    return np.asarray(to_grid(centre + radius * np.array([np.cos(angle), np.sin(angle)])))


def _arc(
    tape: _Tape,
    centre: Floats,
    radius: float,
    turn: int,
    low: int,
    high: int,
    of: tuple[int, int, int],
) -> None:
    """Turn from a whole degree to another, from the best um, with the best whole radius."""
    entry = _place(centre, radius, turn * low)
    # A line that is still to be written may end at any um; one more line costs.
    line = tape.goal is not None
    starts = entry + _NEAR
    cost = np.where(line, 0.0, LINE_COST) + OFF_COST * np.abs(_NEAR).sum(axis=1)
    stands = tape.goal[0] if tape.goal is not None else tape.at
    if np.hypot(*(stands - entry)) <= 1.5:
        starts = np.vstack([starts, stands])
        cost = np.append(cost, 0.0)
    way = along(turn * low, turn, high - low)
    radii = np.unique([max(1, int(np.floor(radius))), max(1, int(np.ceil(radius)))])
    sums = tape.sums + radii[:, None, None] * way
    offsets = sums >> SHIFT  # (radii, degrees + 1, 2)
    at = starts[:, None, None, :] + offsets[None]
    off = at - centre
    stray = np.abs(np.hypot(off[..., 0], off[..., 1]) - radius).max(axis=2)
    # The end counts along the circle too: what follows goes on from there.
    end = at[:, :, -1] - centre - radius * _unit(turn * high)
    total = stray + 0.1 * np.hypot(end[..., 0], end[..., 1]) + cost[:, None]
    i, j = np.unravel_index(np.argmin(total), total.shape)
    room = STRAY_UM + max(0.0, float(arc_limit_um(radius) - sagitta_um(radius)) - 1.5) * 2
    if stray[i, j] > room and high - low > 1:
        middle = (low + high) // 2
        _arc(tape, centre, radius, turn, low, middle, of)
        _arc(tape, centre, radius, turn, middle, high, of)
        return
    if tape.goal is not None:
        tape.goal = (starts[i], tape.goal[1])
        tape.flush()
    else:
        tape.line(starts[i], of)
    tape.turn(turn, turn * low, int(radii[j]), way, of)


def _unit(degree: int) -> Floats:
    angle = np.radians(degree)
    return np.array([np.cos(angle), np.sin(angle)])


def _chords(
    tape: _Tape, layout: Layout, k: int, begin: float, sweep: float, rules: Rules
) -> Diagnostic:
    """Run an arc whose radius the format does not hold as short lines."""
    radius, turn, of = layout.radius[k], layout.turn[k], _of(layout, k)
    centre = np.array([layout.cx[k], layout.cy[k]])
    each = 2 * np.degrees(np.arccos(1 - CHORD_SAG_UM / radius))
    pieces = max(1, int(np.ceil(sweep / each)))
    angle = np.radians(turn * (begin + sweep * np.arange(1, pieces) / pieces))
    inner = to_grid(centre + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    tape.flush()
    for place in inner:
        tape.line(place, of)
    tape.goal = (_vertex(layout, layout.v1[k]), of)
    return warning(
        "radius-over-limit",
        "an arc of radius {radius_mm:.3f} mm is over the format's limit of {most_mm:.3f} "
        "mm: cut as {chords} chords within {within_um:g} um",
        layout.sources[of[1]] if of[1] >= 0 else None,
        radius_mm=radius / rules.per_mm,
        most_mm=rules.arc_um / rules.per_mm,
        chords=pieces,
        within_um=CHORD_SAG_UM * rules.step_um,
    )

"""Lowering for a controller that turns whole degrees: arcs of its base circle, short lines between.

An arc begins and ends where a whole degree is; what lies before and behind is a line shorter than
a degree. The machine keeps the fraction of a um that a degree leaves, across blocks; so a tape is
made in order, every arc is tried with the residues that the machine will have, and begins at that
um near its true place, and with that whole radius, from which its steps stray little. Where no um
will do, the fraction is brought to one that does, by a degree of a circle of some um that hardly
moves the machine; else the arc is parted and goes on from a better um.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wedmcam.controllers.nby15.base_circle import (
    HALF,
    RADIUS,
    SHIFT,
    along,
    arc_limit_um,
    sagitta_um,
)
from wedmcam.controllers.nby15.data import TAPE, TapeProgram, program_of
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.diag import Diagnostic, warning
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import BLOCK, Kind
from wedmcam.transforms.lower import moves
from wedmcam.transforms.lower.layout import Layout, lay_out
from wedmcam.transforms.lower.marks import short_marks

if TYPE_CHECKING:
    from wedmcam.transforms.lower import Rules

#: An end of an arc this near to a whole degree is on it, um along the arc.
ON_DEGREE_UM = 0.3
#: A vertex this near to where the machine stands, um, needs no line of its own.
THERE_UM = 0.8
#: An arc that ends farther from its vertex, um, goes on to it: it may be a corner.
CORNER_UM = 1.2
#: What steps may stray beyond the sagitta of a degree stays this far below its limit, um.
ROOM_UM = 0.03
#: So many arcs are run step by step before a fraction is changed.
LOOKED_AT = 4
#: What an extra line of a um costs, what a um off the true place, and a um of stray within bounds.
LINE_COST, OFF_COST, STRAY_COST = 0.45, 0.02, 0.15
#: What a um that the end of an arc is off along it costs: what follows goes on from there.
END_COST = 0.1
#: Sagitta of the chords of an arc whose radius the format does not hold, um.
CHORD_SAG_UM = 0.3
_NEAR = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)], np.int64)
#: Fractions of a um beside the true place from which an arc is tried, when no whole um will do.
_FRACTIONS = np.array([(i, j) for i in (-2, -1, 0, 1, 2) for j in (-2, -1, 0, 1, 2)]) * 0.2
#: Where along a side of the polygon its distance from the circle is taken.
_ALONG = np.array([0.0, 0.25, 0.5, 0.75, 1.0])


class Circle(NamedTuple):
    """A true arc that is approached: centre and radius, um; turn +1 or -1."""

    centre: Floats
    radius: float
    turn: int

    def at(self, degree: int) -> Floats:
        """Return its place at a degree, counted along its sense."""
        angle = np.radians(self.turn * degree)
        return self.centre + self.radius * np.array([np.cos(angle), np.sin(angle)])

    def off(self, places: Floats | Ints) -> Floats:
        """Return how far outside it places are, um."""
        away = places - self.centre
        return np.asarray(np.hypot(away[..., 0], away[..., 1]) - self.radius)

    def over(self, begin: Ints, end: Ints) -> Floats:
        """Return by how much more than the sagitta of a degree the steps of lines stray, um.

        ``begin``, ``end``: whole um, shape (..., n, 2).
        """
        inwards, outwards = self._steps(end - begin)
        share = _ALONG[:, None]
        off = self.off(begin[..., None, :] + share * (end - begin)[..., None, :])
        most = np.maximum(off.max(axis=-1) + outwards, inwards - off.min(axis=-1))
        return np.asarray(most - sagitta_um(self.radius))

    def _steps(self, way: Ints) -> tuple[Floats, Floats]:
        """Return how far the steps of lines go inside and outside of them, um."""
        blocks = np.zeros(way.shape[:-1], BLOCK).ravel()
        blocks["x"], blocks["y"] = way[..., 0].ravel(), way[..., 1].ravel()
        moving = (blocks["x"] != 0) | (blocks["y"] != 0)
        blocks["axis"], blocks["count"] = MIRROR.line_count(blocks["x"], blocks["y"])
        right, left = np.zeros(len(blocks)), np.zeros(len(blocks))
        if moving.any():
            low, high = MIRROR.deviation(blocks[moving])
            right[moving], left[moving] = -low, high
        sides = (left, right) if self.turn > 0 else (right, left)
        return sides[0].reshape(way.shape[:-1]), sides[1].reshape(way.shape[:-1])

    def traced(self, start: Ints, offsets: Ints) -> float:
        """Return the same of lines one after the other, step by step."""
        way = np.diff(offsets, axis=0)
        way = way[(way != 0).any(axis=1)]
        blocks = np.zeros(len(way), BLOCK)
        blocks["x"], blocks["y"] = way[:, 0], way[:, 1]
        blocks["axis"], blocks["count"] = MIRROR.line_count(blocks["x"], blocks["y"])
        places, _ = MIRROR.trace(blocks)
        off = self.off(start + places)
        return float(np.abs(off).max() - sagitta_um(self.radius))

    @property
    def room(self) -> float:
        """How far steps may stray beyond the sagitta, um."""
        return float(arc_limit_um(self.radius) - sagitta_um(self.radius)) - ROOM_UM


#: What a block is of: role, source, cut.
_Of = tuple[int, int, int]


@dataclass(slots=True)
class _Tape:
    """The tape so far, and where the machine stands behind it.

    Attributes:
        rows: of dtype `TAPE`.
        at: where the machine stands, whole um.
        sums: residues of x and y, `HALF` at the start.
        goal: a place that is to be reached by a line which is not written yet, what it is of, and
            the arc that the line is a fraction of a degree of; None where there is none.
    """

    at: Ints
    rows: list[tuple[int, ...]] = field(default_factory=list)
    sums: Ints = field(default_factory=lambda: np.array([HALF, HALF], np.int64))
    goal: tuple[Ints, _Of, Circle | None] | None = None

    def line(self, to: Ints, of: _Of, kind: Kind = Kind.LINE) -> None:
        """Go straight to a whole um; no block where the machine stands there."""
        way = to - self.at
        if way.any():
            role, source, cut = of
            self.rows.append((kind, 0, role, int(way[0]), int(way[1]), 0, 0, 0, source, cut))
            self.at = to

    def control(self, kind: Kind) -> None:
        """Write a control."""
        self.rows.append((kind, 0, 0, 0, 0, 0, 0, 0, -1, 0))

    def flush(self, pinned: bool = False) -> None:
        """Write the line to the goal; a fraction of a degree ends on the um that is best for it."""
        if self.goal is None:
            return
        to, of, circle = self.goal
        self.goal = None
        if circle is not None and not pinned:
            to = best_end(self.at, to, circle)
        self.line(to, of)

    def turn(self, turn: int, start: int, radius: int, way: Ints, of: _Of) -> None:
        """Turn over the degrees whose places on the base circle are ``way``."""
        role, source, cut = of
        self.rows.append(
            (Kind.ARC, turn, role, 0, 0, radius, start % 360, len(way) - 1, source, cut)
        )
        sums = self.sums + radius * way[-1]
        self.at = self.at + (sums >> SHIFT)
        self.sums = sums & (RADIUS - 1)

    def set_fraction(self, sums: Ints, near: Ints, of: _Of) -> None:
        """Bring the residues to about ``sums``: turn one degree of a circle of some um.

        That moves the machine by a um at most, of those ways that there are to about ``near``; a
        line goes on from there.
        """
        want = (sums - self.sums) / RADIUS
        want -= np.rint(want)
        ways = want - np.sign(want) * np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
        there = self.at + ((self.sums + np.rint(ways * RADIUS).astype(np.int64)) >> SHIFT)
        way = ways[np.argmin(np.hypot(*(there - near).T) + 0.01 * np.hypot(*ways.T))]
        radius = round(float(np.hypot(*way)) / float(np.radians(1.0)))
        if radius:
            start = round(float(np.degrees(np.arctan2(way[1], way[0]))) - 90.5)
            self.turn(1, start, radius, along(start, 1, 1), of)


def best_end(begin: Ints, end: Ints, circle: Circle) -> Ints:
    """Return the um near ``end`` to which a line along an arc strays least."""
    ends = end + _NEAR
    over = circle.over(np.broadcast_to(begin, ends.shape), ends)
    cost = _cost(over, circle) + END_COST * np.hypot(*(_NEAR.T))
    return np.asarray(ends[np.argmin(cost)])


def _cost(over: Floats, circle: Circle) -> Floats:
    """Return what stray costs: little within bounds, and more than all else beyond."""
    return np.where(over <= circle.room, 0.0, 10.0 + over) + STRAY_COST * over


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
                    tape.flush(pinned=True)
                    tape.line(_vertex(layout, layout.v1[k]), _of(layout, k))
    tape.control(Kind.STOP)
    table = np.array(tape.rows, TAPE)
    return program_of(table, plan.cuts[0].thread, tuple(layout.sources)), findings


def _of(layout: Layout, k: int) -> _Of:
    return layout.role[k], layout.source[k], layout.cut[k]


def _vertex(layout: Layout, v: int) -> Ints:
    """Return the whole um nearest to a vertex."""
    return np.asarray(to_grid([layout.x[v], layout.y[v]]))


def _segment(tape: _Tape, layout: Layout, k: int, rules: Rules) -> list[Diagnostic]:
    """Run one segment; a line that ends it may stay a goal, which the next arc moves by a um."""
    v0, v1, of, turn = layout.v0[k], layout.v1[k], _of(layout, k), layout.turn[k]
    goal = _vertex(layout, v1)
    if turn == 0:
        tape.flush()
        tape.goal = (goal, of, None)
        return []
    radius = layout.radius[k]
    circle = Circle(np.array([layout.cx[k], layout.cy[k]]), radius, turn)
    (bx, by), (ex, ey) = (np.array([layout.x[v], layout.y[v]]) - circle.centre for v in (v0, v1))
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
        tape.goal = (goal, of, circle)
        return []
    before, behind = (np.radians(a) * radius for a in (low - begin, begin + sweep - high))
    if before > THERE_UM:
        tape.flush()
    if high > low:
        _arc(tape, circle, low, high, of)
    elif before > THERE_UM:
        tape.line(best_end(tape.at, to_grid(circle.at(low)), circle), of)
    missed = float(np.hypot(*(tape.at - np.array([layout.x[v1], layout.y[v1]]))))
    if behind > THERE_UM or (tape.goal is None and missed > CORNER_UM):
        tape.flush()
        tape.goal = (goal, of, circle)
    return []


def _arc(tape: _Tape, circle: Circle, low: int, high: int, of: _Of) -> None:
    """Turn from a whole degree to another, from the best um, with the best whole radius."""
    turn, radius = circle.turn, circle.radius
    way = along(turn * low, turn, high - low)
    # Figures of a drawing are as good as whole within some digits.
    near = [int(np.floor(radius + 0.02)), int(np.ceil(radius - 0.02))]
    radii = np.unique(np.maximum(near, 1))
    entry = to_grid(circle.at(low))
    starts, cost = entry + _NEAR, OFF_COST * np.abs(_NEAR).sum(axis=1)
    # A line that is still to be written may end at any um; one more costs.
    goal = tape.goal
    stands = tape.at if goal is None else goal[0]
    cost = cost + (LINE_COST if goal is None else 0.0)
    if np.hypot(*(stands - entry)) <= 1.5:
        starts, cost = np.vstack([starts, stands]), np.append(cost, 0.0)
    if goal is None or goal[2] is not None:
        # What leads there is a fraction of a degree, of this arc or of the one before.
        led = circle if goal is None else goal[2]
        assert led is not None
        far = np.hypot(*(starts - tape.at).T) > 2.0
        leads = led.over(np.broadcast_to(tape.at, starts.shape), starts)
        cost = cost + np.where(far, _cost(leads, led), 0.0)
    over, ends = _tried(circle, starts[:, None], tape.sums, radii, way)
    miss = np.hypot(*np.moveaxis(ends - circle.at(high), -1, 0))
    total = _cost(over, circle) + END_COST * miss + cost[:, None]
    i, j = np.unravel_index(np.argmin(total), total.shape)
    start, r = starts[i], int(radii[j])
    if over[i, j] > circle.room:
        # Bounds are too wide at times: what needs no block more is looked at step by step.
        plain = np.where(total < 40.0, STRAY_COST * over + END_COST * miss + cost[:, None], np.inf)
        for k in np.argsort(plain, axis=None)[:LOOKED_AT].tolist():
            i, j = np.unravel_index(k, total.shape)
            start, r = starts[i], int(radii[j])
            if circle.traced(start, (tape.sums + r * way) >> SHIFT) <= circle.room + ROOM_UM:
                break
        else:
            start = None
    if start is None:
        places = circle.at(low) + _FRACTIONS
        whole = to_grid(places)
        sums = np.rint((places - whole) * RADIUS).astype(np.int64) + HALF
        sums = np.clip(sums, 0, RADIUS - 1)
        over, ends = _tried(circle, whole[:, None], sums[:, None, None], radii, way)
        i, j = np.unravel_index(np.argmin(over), over.shape)
        if over[i, j] > circle.room and high - low > 1:
            middle = (low + high) // 2
            _arc(tape, circle, low, middle, of)
            _arc(tape, circle, middle, high, of)
            return
        start, r = whole[i], int(radii[j])
        short = goal is None and np.hypot(*(start - tape.at)) <= 2.0
        tape.set_fraction(sums[i], start if short else tape.at, of)
    if goal is not None:
        tape.goal = (start, goal[1], None)
        tape.flush()
    else:
        tape.line(start, of)
    tape.turn(turn, turn * low, r, way, of)


def _tried(
    circle: Circle, starts: Ints, sums: Ints, radii: Ints, way: Ints
) -> tuple[Floats, Floats]:
    """Return by how much arcs would stray, and where they would end, for each start and radius.

    Args:
        circle: the true arc.
        starts: where the machine stands, shape (n, 1, 2).
        sums: residues, shape (2,) or (n, 1, 1, 2).
        radii: whole radii.
        way: places on the base circle.
    """
    offsets = (sums + radii[:, None, None] * way) >> SHIFT
    at = starts[:, :, None, :] + offsets
    over = circle.over(at[..., :-1, :], at[..., 1:, :]).max(axis=-1)
    return over, at[..., -1, :].astype(np.float64)


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
    tape.goal = (_vertex(layout, layout.v1[k]), of, None)
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

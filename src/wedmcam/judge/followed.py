"""A program laid along the plan's routes, once: the record that all measures of the judge read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wedmcam.diag import Diagnostic, Place
from wedmcam.ir.plan import Cut, Material, Plan
from wedmcam.ir.program import Program, Role
from wedmcam.judge.clearance import as_left
from wedmcam.judge.material import Kept, kept_material
from wedmcam.judge.route import Route, plan_route
from wedmcam.judge.segments import Bools, Floats, Ints, points_at
from wedmcam.judge.stretches import Assigned, assign, per_mm, place, span_of, stretches
from wedmcam.judge.survey import Survey, survey
from wedmcam.judge.track import Track, track
from wedmcam.judge.verdict import Count
from wedmcam.judge.walk import Walk


@dataclass(frozen=True, slots=True)
class Terms:
    """What a program is held to.

    Attributes:
        path_limit_um: largest deviation between the wire's way and the exact route, either way,
            for steps of 1 um; it grows and shrinks with them.
        gouge_limit_um: largest depth of the wire in the kept material, likewise.
        trimmed: the plan leaves out places narrower than the wire on purpose; pieces that are
            missing are warnings then.
        strict_order: False proves the part only: order, sense, start and leads may differ from the
            plan's and are notes.
        fitted: where the program starts is not known, but was fitted.
        arc_limit_um: of a machine whose arcs are coarser or finer than ``path_limit_um`` by design:
            the limit along an arc of the route by its radius, um, on steps of 1 um; None for the
            same limit everywhere. The wire may enter the kept material by 0.1 um more than that.
    """

    path_limit_um: float = 2.0
    gouge_limit_um: float = 1.6
    trimmed: bool = False
    strict_order: bool = True
    fitted: bool = False
    arc_limit_um: Callable[[Floats], Floats] | None = None


#: How much deeper than the path may be off the wire may be in the kept material, um.
GOUGE_MORE_UM = 0.1

#: What a program is held to that was compiled here.
OURS = Terms()


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """One piece of material, and the cuts whose wire is held against it.

    Attributes:
        material: as the wire is to leave it (`clearance`).
        own: for each cut of the route, whether it is one of them.
        kept: what of it is to stay.
    """

    material: Material
    own: Bools
    kept: Kept


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """One program, as one machine steps it, along the routes of one plan.

    Attributes:
        program, plan, terms, way, count: what is judged; lengths in steps.
        assigned: the blocks of each cut of the route.
        cuts: of the plan, one an entry of ``assigned``.
        backwards: whether the program runs each against the plan's sense.
        route: the planned way through all of them.
        index: rows of the program that cut, in order.
        cut_of: for each, the entry of ``assigned``.
        first: where in ``index`` each entry begins, and one past the last.
        track: where on the route each row begins and ends.
        done: rows that were not lost.
        lead: rows on a lead.
        held: the material.
        survey: the extremes of all rows, the first material being kept.
        deviation: of each row from the route; NaN where it was lost.
        limit: for each row, how far it may be.
    """

    program: Program
    plan: Plan
    terms: Terms
    way: Walk
    count: Count
    assigned: list[Assigned]
    cuts: list[Cut]
    backwards: list[bool]
    route: Route
    index: Ints
    cut_of: Ints
    first: Ints
    track: Track
    done: Bools
    lead: Bools
    held: list[Held]
    survey: Survey
    deviation: Floats
    limit: Floats

    @property
    def widest(self) -> float:
        """The largest limit of a row, steps."""
        return float(self.limit.max(initial=self.terms.path_limit_um))

    @property
    def per(self) -> float:
        """How many steps go to a mm."""
        return per_mm(self.program)

    def of_block(self, row: int) -> dict[str, Any]:
        """Return what a finding holds of a block: its span, its number, and where it ends."""
        end = self.place(*self.way.end[row])
        return {
            "span": span_of(self.program, row),
            "points_mm": (end,),
            "block": row + 1,
            "end": end,
        }

    def place(self, x: float, y: float) -> Place:
        """Return a place for a finding, from coordinates in steps."""
        return place(x, y, self.per)

    def survey_with(self, kept: Kept | None) -> Survey:
        """Return the extremes of all rows with a piece of material being kept."""
        return _survey(
            self.way,
            self.index,
            self.track,
            self.done,
            self.lead,
            self.route,
            kept,
            self.limit,
            self.terms,
        )


def follow(
    program: Program, plan: Plan, terms: Terms, way: Walk, count: Count
) -> tuple[Followed | None, list[Diagnostic]]:
    """Return a program along its plan, or None where nothing of it belongs to the plan.

    Args:
        program, plan: in steps of the machine.
        terms: what it is held to.
        way: what the machine does.
        count: see `judge.judge`.
    """
    if terms.strict_order:
        assigned, findings = assign(program, stretches(way), plan.cuts)
        if not assigned:
            return None, findings
        cuts = [plan.cuts[a.cut] for a in assigned]
        backwards = [False] * len(cuts)
        route = plan_route(cuts)
    else:
        from wedmcam.judge.match import match

        matched, findings = match(way, program, plan)
        if matched is None:
            return None, findings
        assigned, cuts, route = matched.assigned, matched.cuts, matched.route
        backwards = matched.backwards
    index = np.concatenate([a.index for a in assigned])
    cut_of = np.repeat(np.arange(len(assigned)), [len(a.index) for a in assigned])
    t = track_cuts(way, route, assigned)
    done = ~np.isnan(t.high)
    closed = np.array([not (c.outline is not None and not c.outline.closed) for c in cuts])
    held = []
    for material in plan.materials:
        own = closed & np.array([material.holds(c) for c in cuts], bool)
        left = as_left(material)
        held.append(Held(left, own, kept_material(left, route, own)))
    role = _roles(route, t)
    lead = np.zeros(len(index), bool)
    lead[done] = (role[done] == Role.LEAD_IN) | (role[done] == Role.LEAD_OUT)
    limit = _limits(route, t, done, terms)
    if terms.arc_limit_um is not None:
        deep = max(terms.gouge_limit_um, float(limit.max(initial=0.0)) + GOUGE_MORE_UM)
        terms = replace(terms, gouge_limit_um=deep)
    m = _survey(way, index, t, done, lead, route, held[0].kept if held else None, limit, terms)
    deviation = np.full(len(index), np.nan)
    deviation[done] = m.deviation
    first = np.searchsorted(cut_of, np.arange(len(assigned) + 1))
    return (
        Followed(
            program=program,
            plan=plan,
            terms=terms,
            way=way,
            count=count,
            assigned=assigned,
            cuts=cuts,
            backwards=backwards,
            route=route,
            index=index,
            cut_of=cut_of,
            first=first,
            track=t,
            done=done,
            lead=lead,
            held=held,
            survey=m,
            deviation=deviation,
            limit=limit,
        ),
        findings,
    )


def _survey(
    way: Walk,
    index: Ints,
    t: Track,
    done: Bools,
    lead: Bools,
    route: Route,
    kept: Kept | None,
    limit: Floats,
    terms: Terms,
) -> Survey:
    return survey(
        way,
        index[done],
        t.low[done],
        t.high[done],
        lead[done],
        route,
        kept,
        limit[done],
        terms.gouge_limit_um,
    )


def _limits(route: Route, t: Track, done: Bools, terms: Terms) -> Floats:
    """Return for each row how far it may be from the route: the most of what it runs along."""
    limit = np.full(len(t.high), terms.path_limit_um)
    if terms.arc_limit_um is None:
        return limit
    s = route.segments
    of = np.where(s.turn != 0, terms.arc_limit_um(s.radius), terms.path_limit_um)
    ends = (np.searchsorted(route.at, t.low[done], "right") - 1,
            np.searchsorted(route.at, t.high[done], "left") - 1)  # fmt: skip
    first, last = (np.clip(k, 0, len(of) - 1) for k in ends)
    limit[done] = np.maximum(of[first], of[last])
    return limit


def track_cuts(way: Walk, route: Route, assigned: Sequence[Assigned]) -> Track:
    """Return where on the route all blocks of all cuts begin and end."""
    count = np.array([len(a.index) for a in assigned])
    index = np.concatenate([a.index for a in assigned])
    head = np.cumsum(count + 1) - (count + 1)
    is_start = np.zeros(len(index) + len(assigned), bool)
    is_start[head] = True
    places = np.empty((len(is_start), 2))
    places[is_start] = way.start[[int(a.index[0]) for a in assigned]]
    places[~is_start] = way.end[index]
    length = np.zeros(len(is_start))
    length[~is_start] = way.lengths()[index]
    cut = np.repeat(np.arange(len(assigned)), count + 1)
    return track(route, places[:, 0].copy(), places[:, 1].copy(), length, cut)


def _roles(route: Route, t: Track) -> Ints:
    """Return the role of each block: that of the segment under the middle of its stretch."""
    middle = np.nan_to_num((t.low + t.high) / 2.0)
    segment = np.clip(np.searchsorted(route.at, middle, "right") - 1, 0, len(route.at) - 1)
    return np.asarray(route.role[segment])


def places(route: Route, at: Floats) -> Floats:
    """Return points of the route at a progress, shape (n, 2)."""
    segment = np.clip(np.searchsorted(route.at, at, "left") - 1, 0, len(route.at) - 1)
    held = route.segments.take(segment)
    x, y = points_at(held, at - route.at[segment])
    return np.column_stack([x, y])


def last_row(way: Walk) -> int:
    """Return the row of the last block that cuts."""
    return int(np.flatnonzero(way.cutting & (way.steps > 0))[-1])

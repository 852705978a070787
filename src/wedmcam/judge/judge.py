"""The judge: decoded blocks against the plan and, on its own, against the part's outlines.

It did not make the program and shares no geometry with what made it. What is proven is in
``deviation`` (the wire's way is the planned route, run once, in order, in its sense) and in
``material`` (the wire stays out of what is kept and reaches all of the outline it can reach).

What is proven of leads. In strict order (what was compiled here, and what has a certificate): each
is the plan's within the limit of the path, starts or ends exactly at the plan's thread point, goes
back over an overcut in its kerf, and the program ends where the plan does. Otherwise (a program
from elsewhere) leads are its own, and

- they enter no kept material and meet no other cut (``material``, ``leads``);
- each closed cut returns to where it was threaded, to the step; an open one ends with its path, or
  does likewise. Where it is known at which place the program starts, the plan's thread point will
  do as well. Where that was fitted it will not, and an open cut, which returns nowhere, has to be
  threaded where the plan says: else a wrong first lead-in would go unseen, because the fit lays the
  contour in its place and the error on the start.

A contour of a program from elsewhere may run on over its start (an overlap): it closes where it
comes by, within the limit of the path.

Where a cut is run twice the second pass is proven like the first; that is a warning, and in strict
order an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic, Severity, error, has_errors, note, warning
from wedmcam.ir.plan import Cut, Material, Plan, outline_numbers
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.judge.beside import entered
from wedmcam.judge.checks import Limits, check_blocks
from wedmcam.judge.clearance import as_left
from wedmcam.judge.deviation import SLOP, measure
from wedmcam.judge.leads import hits
from wedmcam.judge.material import Kept, coverage, kept_material, wrong_side
from wedmcam.judge.route import Route, plan_route
from wedmcam.judge.runs import Assigned, assign, mm, per_mm, runs, span_of
from wedmcam.judge.segments import Bools, Floats, Ints, points_at
from wedmcam.judge.survey import Survey, survey
from wedmcam.judge.track import LOST, Track, track
from wedmcam.judge.unit import in_steps, told_in_um
from wedmcam.judge.verdict import BlockTable, Count, CutVerdict, Verdict
from wedmcam.judge.walk import Walk, walk

#: How far from the asked length of the stop the pause may be, um: it is rounded to the micron, and
#: a vertex next to it may be taken for it.
STOP_ROOM = 5.0

#: A recomputed end may miss by the rounding of its own formula: what closes a contour of a
#: controller that recomputes arc ends, um (ours: no source has it).
TEXTBOOK_CLOSURE = 2.0


def judge(
    program: Program,
    plan: Plan,
    *,
    stepping: Stepping,
    limits: Limits | None = None,
    count: Count = "exact",
    path_limit_um: float = 2.0,
    gouge_limit_um: float = 1.6,
    strict_order: bool = True,
    trimmed: bool = False,
    fitted: bool = False,
    free_moves: bool = False,
) -> tuple[Verdict, list[Diagnostic]]:
    """Judge a decoded program.

    Args:
        program: as decoded from the bytes; ``origin`` is where its first block starts. Its steps
            are the unit of all that is measured; what is told is in um.
        plan: the exact routes, the outlines of the part, the side and the offset.
        stepping: the controller's interpolator.
        limits: of the machine; None for none.
        count: "exact" for a controller that counts steps; "textbook" for one that recomputes arc
            ends: then the verdict is for that one, and what a step-counting controller would do
            is told beside it.
        path_limit_um: largest deviation between the wire's way and the exact route, either way,
            for steps of 1 um; it grows and shrinks with them.
        gouge_limit_um: largest depth of the wire in the kept material, likewise.
        strict_order: False proves the part only: order, sense, start and leads may differ from the
            plan's and are notes.
        fitted: where the program starts is not known, but was fitted.
        free_moves: moves between cuts have no limit (G00).
        trimmed: the plan leaves out places narrower than the wire on purpose; pieces that are
            missing are warnings then.

    Returns:
        The verdict, and findings; ``ok`` is that none of them is an error.
    """
    way = walk(program, stepping, textbook=count == "textbook")
    findings = check_blocks(program, limits, way.steps, free_moves)
    plan = in_steps(plan, program.step_um)
    case = _Case(program, plan, path_limit_um, gouge_limit_um, trimmed, strict_order, fitted)
    verdict, found = case.judge(way, count)
    verdict = told_in_um(verdict, program.step_um)
    findings.extend(found)
    if count == "textbook":
        stepped, _ = case.judge(walk(program, stepping), "exact")
        stepped = told_in_um(stepped, program.step_um)
        verdict = verdict._replace(
            stepped_closure_um=stepped.closure_um,
            stepped_max_deviation_um=stepped.max_deviation_um,
            stepped_gouge_um=stepped.gouge_um,
        )
        if not stepped.ok:
            closure = stepped.closure_um
            findings.append(
                warning(
                    "stepped-differs",
                    "a controller that counts steps would leave the wire path by "
                    f"{stepped.max_deviation_um / 1000.0:.3f} mm and close the contours within "
                    f"{'no' if closure is None else f'{closure / 1000.0:.3f}'} mm",
                    hint="compile with --count exact for such a controller",
                )
            )
    return verdict._replace(ok=not has_errors(findings)), findings


#: How far an open cut may end from the end of its path, um: that is rounded, and an arc may end one
#: off.
OPEN_END = 1.5

#: A block ends on a vertex up to the first, um along the route; up to the second it was meant for
#: it, if no other block ends there.
SLIP, SLIPPED = 1.5, 1000.0


class _Case(NamedTuple):
    """One program and plan, judged once a machine."""

    program: Program
    plan: Plan
    path_limit_um: float
    gouge_limit_um: float
    trimmed: bool
    strict_order: bool
    fitted: bool

    @property
    def per(self) -> float:
        """How many steps go to a mm."""
        return per_mm(self.program)

    def judge(self, way: Walk, count: Count) -> tuple[Verdict, list[Diagnostic]]:
        """Judge what one machine does."""
        findings: list[Diagnostic] = []
        if self.strict_order:
            assigned, found = assign(self.program, runs(way), self.plan.cuts)
            cuts = [self.plan.cuts[a.cut] for a in assigned]
            backwards = [False] * len(cuts)
            route = None
            if cuts:
                route = plan_route(cuts)
        else:
            from wedmcam.judge.match import match

            assigned, cuts, route, backwards, found = match(way, self.program, self.plan)
        findings.extend(found)
        if route is None:
            return self._nothing(way, count, findings), findings

        index = np.concatenate([a.index for a in assigned])
        cut_of = np.repeat(np.arange(len(assigned)), [len(a.index) for a in assigned])
        t = _follow(way, route, assigned)
        done = ~np.isnan(t.high)
        judged = np.array([not (c.outline is not None and not c.outline.closed) for c in cuts])
        held = [
            (as_left(material), judged & np.array([material.holds(c) for c in cuts], bool))
            for material in self.plan.materials
        ]
        materials = [kept_material(material, route, own) for material, own in held]
        kept = materials[0] if materials else None
        role = _roles(route, t)
        lead = np.zeros(len(index), bool)
        lead[done] = (role[done] == Role.LEAD_IN) | (role[done] == Role.LEAD_OUT)
        m = survey(
            way,
            index[done],
            t.low[done],
            t.high[done],
            lead[done],
            route,
            kept,
            self.path_limit_um,
            self.gouge_limit_um,
        )
        deviation = np.full(len(index), np.nan)
        deviation[done] = m.deviation
        lost = dict(t.lost)
        findings.extend(
            self._path_findings(way, index, cut_of, assigned, route, t, m, done, deviation)
        )
        first = np.searchsorted(cut_of, np.arange(len(assigned) + 1))
        closures = []
        for k, a in enumerate(assigned):
            mine = slice(int(first[k]), int(first[k + 1]))
            closure, found = self._ends(way, a, cuts[k], route, t, mine, k, count)
            closures.append(closure)
            findings.extend(found)
        findings.extend(self._leads(route, [a.cut for a in assigned]))
        end = self._end(way, cuts[-1])
        findings.extend(end if self.strict_order else as_notes(end))
        if self.strict_order and has_errors(findings):
            from wedmcam.judge.match import repeated

            findings.extend(repeated(way, self.program, self.plan))

        gouge, uncut = None, None
        for (material, own), beside in zip(held, materials, strict=True):
            of = m
            if beside is not kept:
                of = survey(
                    *(way, index[done], t.low[done], t.high[done], lead[done], route, beside),
                    *(self.path_limit_um, self.gouge_limit_um),
                )
            deep = self._gouge(findings, beside, route, own, of, index[done])
            gouge = max(deep, gouge or 0.0)
            left = self._coverage(findings, material, route)
            uncut = left if uncut is None or left is None else max(left, uncut)
        if self.plan.side in ("left", "right", "on"):
            gouge = None
        for c, x, y, um in entered(self.plan, route, cuts, np.array([a.cut for a in assigned])):
            if um > self.gouge_limit_um:
                findings.append(
                    error(
                        "gouge",
                        f"the wire of cut {c + 1} enters what is kept of another part of the plate "
                        f"by {um / self.per:.3f} mm, near {mm(x, y, self.per)} mm",
                        points_mm=((x / self.per, y / self.per),),
                    )
                )
                gouge = max(um, gouge or 0.0)

        lengths = way.lengths()
        steps = way.steps[index]
        on_path = np.where(lead | ~done, 0.0, deviation)
        on_lead = np.where(lead & done, deviation, 0.0)
        on_path[list(lost)] = list(lost.values())
        sums = [np.add.reduceat(v, first[:-1]) for v in (steps, lengths[index])]
        most = [np.maximum.reduceat(v, first[:-1]) for v in (on_path, on_lead)]
        rows = tuple(
            CutVerdict(
                number=a.cut + 1,
                first_block=int(a.index[0]) + 1,
                last_block=int(a.index[-1]) + 1,
                blocks=len(a.index),
                steps=int(sums[0][k]),
                closed=bool(route.closed[k]),
                closure_um=closures[k],
                max_deviation_um=float(most[0][k]),
                lead_deviation_um=float(most[1][k]),
                length_mm=float(sums[1][k]) / self.per,
                backwards=backwards[k],
            )
            for k, a in enumerate(assigned)
        )

        def table() -> BlockTable:
            low, high = np.full(len(index), np.nan), np.full(len(index), np.nan)
            every = measure(way, index[done], t.low[done], t.high[done], route, None)
            low[done], high[done] = every.low, every.high
            nominal = np.full((len(index), 2), np.nan)
            nominal[done] = _places(route, t.high[done])
            stepped = way.end[index]
            error_um = np.hypot(stepped[:, 0] - nominal[:, 0], stepped[:, 1] - nominal[:, 1])
            cut = np.array([a.cut + 1 for a in assigned])[cut_of]
            return BlockTable(index + 1, cut, nominal, stepped, error_um, low, high)

        closed = [c for c in closures if c is not None]
        return (
            Verdict(
                ok=not has_errors(findings),
                count=count,
                closure_um=max(closed) if closed else None,
                max_deviation_um=max((r.max_deviation_um for r in rows), default=0.0),
                lead_deviation_um=max((r.lead_deviation_um for r in rows), default=0.0),
                gouge_um=gouge,
                uncut_um=uncut,
                contours=len({a.cut for a in assigned}),
                extents_um=_extents(m.extents, way.end[index]),
                cuts=rows,
                make_table=cache(table),
                **self._totals(way),
            ),
            findings,
        )

    def _totals(self, way: Walk) -> dict[str, Any]:
        """Return the figures that need no route."""
        kind = way.blocks["kind"]
        kept = {s.keeps for s in self.plan.scenes} - {None}
        return {
            "blocks": int(way.cutting.sum()),
            "steps": int(np.maximum(way.steps[way.cutting], 0).sum()),
            "moves": int((kind == Kind.MOVE).sum()),
            "controls": int((kind >= Kind.PAUSE).sum()),
            "path_mm": float(way.lengths()[way.cutting].sum()) / self.per,
            "origin_um": self.program.origin,
            "offset_um": self.plan.offset_um,
            "side": str(self.plan.side) if len(kept) < 2 else "mixed",
            "path_limit_um": self.path_limit_um,
            "gouge_limit_um": self.gouge_limit_um,
        }

    def _nothing(self, way: Walk, count: Count, findings: list[Diagnostic]) -> Verdict:
        """Return the verdict on a program in which nothing belongs to the plan."""
        if not self.plan.cuts and not way.cutting.any():
            findings.append(error("missing-cut", "the plan has no cut and the program no block"))
        x, y = self.program.origin
        return Verdict(
            ok=not has_errors(findings),
            count=count,
            closure_um=None,
            max_deviation_um=0.0,
            lead_deviation_um=0.0,
            gouge_um=None,
            uncut_um=None,
            contours=0,
            extents_um=(x, y, x, y),
            cuts=(),
            make_table=_no_table,
            **self._totals(way),
        )

    def _path_findings(
        self,
        way: Walk,
        index: Ints,
        cut_of: Ints,
        assigned: list[Assigned],
        route: Route,
        t: Track,
        m: Survey,
        done: Bools,
        deviation: Floats,
    ) -> list[Diagnostic]:
        """Report, for each cut, the first block that leaves its route or its turn."""
        findings = []
        stray = np.zeros(len(index))
        stray[done] = m.stray
        off = np.flatnonzero(np.nan_to_num(deviation) > self.path_limit_um)
        wild = np.flatnonzero(stray > SLOP)
        lost = dict(t.lost)
        wrong = np.concatenate([off, wild, np.array(list(lost), np.int64)])
        first = np.searchsorted(cut_of, np.arange(len(assigned)))
        for k in np.flatnonzero(np.bincount(cut_of[wrong])).tolist():
            name = f"cut {assigned[k].cut + 1}"
            mine = off[cut_of[off] == k]
            strays = wild[cut_of[wild] == k]
            gone = [b for b in lost if cut_of[b] == k]
            if len(strays) and (not len(mine) or strays[0] <= mine[0]):
                b = int(strays[0])
                findings.append(
                    self._block_error(
                        "wrong-order",
                        way,
                        int(index[b]),
                        f"does not run {name} once and in its sense: it is "
                        f"{stray[b] / self.per:.3f} mm along the wire path from its turn",
                    )
                )
            if len(mine):
                b = int(mine[0])
                more = f"; {len(mine) - 1} more blocks of the cut do" if len(mine) > 1 else ""
                more += _slip(route, t, int(first[k]), b, index, self.per)
                findings.append(
                    self._block_error(
                        "path-deviation",
                        way,
                        int(index[b]),
                        f"leaves the wire path of {name} by {deviation[b] / self.per:.5f} mm "
                        f"(limit {self.path_limit_um / self.per:.5f} mm){more}",
                    )
                )
            for b in gone:
                on_path = lost[b] <= self.path_limit_um
                text = (
                    f"is on the wire path of {name} out of its turn"
                    if on_path
                    else f"ends {lost[b] / self.per:.3f} mm beside the wire path of {name}"
                ) + _slip(route, t, int(first[k]), b, index, self.per)
                code = "wrong-order" if on_path else "path-deviation"
                findings.append(self._block_error(code, way, int(index[b]), text))
        return findings

    def _block_error(self, code: str, way: Walk, row: int, text: str) -> Diagnostic:
        x, y = (int(v) for v in way.end[row])
        return error(
            code,
            f"block {row + 1} {text}; it ends at {mm(x, y, self.per)} mm",
            span_of(self.program, row),
            points_mm=((x / self.per, y / self.per),),
        )

    def _ends(
        self,
        way: Walk,
        a: Assigned,
        cut: Cut,
        route: Route,
        t: Track,
        rows: slice,
        k: int,
        count: Count,
    ) -> tuple[float | None, list[Diagnostic]]:
        """Return the closure of one cut, and report its ends and its pauses."""
        findings: list[Diagnostic] = []
        high = t.high[rows]
        if np.isnan(high).any():
            return None, findings  # lost: reported
        last = int(a.index[-1])
        end = way.end[last]
        limit = TEXTBOOK_CLOSURE if count == "textbook" else 0.0
        if high[-1] < route.high[k] - LOST:
            left = float(route.high[k] - high[-1]) / self.per
            findings.append(
                self._block_error(
                    "missing-piece",
                    way,
                    last,
                    f"is the last of cut {a.cut + 1}, {left:.3f} mm before its end"
                    + _nowhere(way, last),
                )
            )
        elif wrong := self._wrong_end(way, a, cut, end, limit):
            if tuple(end.tolist()) != cut.thread:
                wrong += _nowhere(way, last)
            findings.append(self._block_error("thread-point", way, last, wrong))
        if self.fitted and not cut.path.closed:
            findings.extend(self._loose_start(way, a, cut))
        pauses = self._pauses(way, a, cut, route, high, k)
        findings.extend(pauses if self.strict_order else as_notes(pauses))
        if not route.closed[k]:
            return None, findings
        places = np.concatenate([way.start[a.index[:1]], way.end[a.index]])
        at = np.concatenate([t.low[rows][:1], high])
        p0, p1 = _meeting(
            places, at, float(route.path_low[k]), float(route.path_high[k]), self.path_limit_um
        )
        off = abs(at[p0] - route.path_low[k])
        if a.closing < 0:
            off = max(off, abs(at[p1] - route.path_high[k]))
        block = int(a.index[max(p1 - 1, 0)])
        if off > LOST:
            findings.append(
                self._block_error(
                    "not-closed",
                    way,
                    block,
                    f"is the last before the end of cut {a.cut + 1}, but no block ends where the "
                    f"contour closes ({off / self.per:.3f} mm off)",
                )
            )
            return None, findings
        closure = float(np.hypot(*(places[p1] - places[p0])))
        if a.closing >= 0:
            block = int(a.index[a.closing])
            closure, limit = _passed(way, block, places[p0]), self.path_limit_um
        if closure > limit:
            x, y = places[p0]
            findings.append(
                self._block_error(
                    "not-closed",
                    way,
                    block,
                    f"ends cut {a.cut + 1} {closure / self.per:.4f} mm from where it started "
                    f"({mm(x, y, self.per)} mm)",
                )
            )
        elif closure > 0 and a.closing < 0:
            findings.append(
                note(
                    "not-closed",
                    f"cut {a.cut + 1} closes within {closure / self.per:.4f} mm on a controller "
                    "that recomputes arc ends",
                )
            )
        return closure, findings

    def _wrong_end(self, way: Walk, a: Assigned, cut: Cut, end: Ints, limit: float) -> str:
        """Return what is wrong with the place at which a cut ends; empty where nothing is."""

        def off(x: float, y: float) -> float:
            return float(np.hypot(end[0] - x, end[1] - y))

        threaded = way.start[int(a.index[0])]
        place = cut.thread if self.strict_order else threaded
        where = mm(float(place[0]), float(place[1]), self.per)
        back = f"does not return to the thread point {where} mm of cut {a.cut + 1}"
        if cut.path.closed:
            there = off(*cut.thread) <= limit
            if not self.strict_order:
                there = off(*threaded) <= limit or (there and not self.fitted)
            return "" if there else back
        v = cut.path.vertices[[-1]] if self.strict_order else cut.path.vertices[[0, -1]]
        apart = min(off(x, y) for x, y in zip(v["x"].tolist(), v["y"].tolist(), strict=True))
        if apart <= OPEN_END or (not self.strict_order and off(*threaded) <= limit):
            return ""
        return f"ends {apart / self.per:.3f} mm from the end of the path of cut {a.cut + 1}"

    def _loose_start(self, way: Walk, a: Assigned, cut: Cut) -> list[Diagnostic]:
        """Report an open cut that is threaded elsewhere, where nothing else ties its start."""
        (x, y), (tx, ty) = way.start[int(a.index[0])].tolist(), cut.thread
        if (x, y) == (tx, ty):
            return []
        return [
            error(
                "thread-point",
                f"cut {a.cut + 1} is open and threaded at {mm(x, y, self.per)} mm, not at "
                f"{mm(tx, ty, self.per)} mm, and it is not known where the program starts",
                span_of(self.program, int(a.index[0])),
                hint="state --origin",
                points_mm=((x / self.per, y / self.per),),
            )
        ]

    def _leads(self, route: Route, numbers: Sequence[int]) -> list[Diagnostic]:
        """Report the first place at which leads of a cut meet another cut."""
        return [
            error(
                "lead-hits",
                f"a lead of cut {a + 1} meets cut {b + 1} at {mm(x, y, self.per)} mm",
                points_mm=((x / self.per, y / self.per),),
                hint="a lead may run in scrap only, and meet no other cut",
            )
            for a, b, x, y in hits(
                route,
                np.array(numbers),
                np.array(outline_numbers(self.plan.cuts)),
                np.array(self.plan.plates),
            )
        ]

    def _end(self, way: Walk, cut: Cut) -> list[Diagnostic]:
        """Report a last move that leads away from where the plan ends."""
        moves = np.flatnonzero(way.blocks["kind"] == Kind.MOVE)
        if not len(moves) or moves[-1] < _last(way):
            return []
        row = int(moves[-1])
        if (way.end[row] == way.end[_last(way)]).all():
            return []
        return [
            self._block_error(
                "thread-point",
                way,
                row,
                "moves on behind the last cut: the program does not end where the plan ends",
            )
        ]

    def _pauses(
        self, way: Walk, a: Assigned, cut: Cut, route: Route, high: Floats, k: int
    ) -> list[Diagnostic]:
        """Report a pause that is missing, too many, or elsewhere."""
        at = [float(high[p - 1]) for p in a.pauses]
        wanted = float(route.path_high[k]) - cut.stop_um
        if cut.stop_um <= 0 or cut.stop_um >= route.path_high[k] - route.path_low[k]:
            wanted = float("nan")
        findings = []
        hits = [abs(one - wanted) <= STOP_ROOM for one in at]
        for p, hit in zip(a.pauses, hits, strict=True):
            if not hit:
                findings.append(
                    self._block_error(
                        "stop-point",
                        way,
                        int(a.index[p - 1]),
                        f"is followed by a pause in the middle of cut {a.cut + 1}, where none is "
                        "asked for",
                    )
                )
        if not np.isnan(wanted) and sum(hits) != 1:
            x, y = _places(route, np.array([wanted]))[0]
            findings.append(
                error(
                    "stop-point",
                    f"cut {a.cut + 1} has {sum(hits)} pauses {cut.stop_um / self.per:.3f} mm "
                    f"before its end, at {mm(x, y, self.per)} mm; one is asked for",
                    span_of(self.program, int(a.index[-1])),
                    points_mm=((float(x) / self.per, float(y) / self.per),),
                )
            )
        return findings

    def _gouge(
        self,
        findings: list[Diagnostic],
        kept: Kept,
        route: Route,
        judged: Bools,
        m: Survey,
        index: Ints,
    ) -> float:
        """Return gouge_um, and report it where it is over the limit."""
        depth = max(0.0, m.gouge)
        for c, x, y, um in wrong_side(kept, route, judged):
            findings.append(
                error(
                    "gouge",
                    f"the wire path of cut {c + 1} runs inside the material that is to be kept at "
                    f"{mm(x, y, self.per)} mm; the wire is {um / self.per:.3f} mm deep in it",
                    points_mm=((x / self.per, y / self.per),),
                    hint="check --side part or die, and the sense of the contour",
                )
            )
            depth = max(depth, um)
        if m.gouge > self.gouge_limit_um:
            x, y = m.gouge_at
            row = int(index[m.gouge_block])
            findings.append(
                error(
                    "gouge",
                    f"block {row + 1}: the wire enters the kept material by "
                    f"{m.gouge / self.per:.5f} mm at {mm(x, y, self.per)} mm (limit "
                    f"{self.gouge_limit_um / self.per:.5f} mm)",
                    span_of(self.program, row),
                    points_mm=((x / self.per, y / self.per),),
                )
            )
        return depth

    def _coverage(
        self, findings: list[Diagnostic], material: Material, route: Route
    ) -> float | None:
        """Return uncut_um, and report pieces that are missing.

        Of a part of a program only the outlines that it cuts whole are asked for, and there is no
        uncut_um; that every path of it is run is proven all the same (`deviation`).
        """
        c = coverage(material, route)
        say = warning if self.trimmed else error
        whole = {c.number - 1 - material.first for c in self.plan.cuts if c.path.closed}
        cut_of = {c.number - 1 - material.first: k for k, c in enumerate(self.plan.cuts, 1)}
        for outline, share, x, y, um in c.missing:
            if self.plan.partial and outline not in whole:
                continue
            how = f"the wire stays {um / self.per:.3f} mm off it" if np.isfinite(um) else "no cut"
            name = f"the outline of cut {cut_of[outline]}" if outline in cut_of else "an outline"
            what = "is not cut" if share == 1 else f"is not cut on {share:.0%} of its segments"
            findings.append(
                say(
                    "missing-piece",
                    f"{name} {what}, first at {mm(x, y, self.per)} mm: {how}",
                    points_mm=((x / self.per, y / self.per),),
                )
            )
        if self.plan.partial:
            return None
        if c.uncut_um > self.path_limit_um:
            x, y = c.uncut_at
            findings.append(
                note(
                    "uncut-corner",
                    f"the round wire leaves up to {c.uncut_um / self.per:.3f} mm in inner corners, "
                    f"most at {mm(x, y, self.per)} mm",
                    points_mm=((x / self.per, y / self.per),),
                )
            )
        return c.uncut_um


def as_notes(findings: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return findings as notes: of a program from elsewhere, whose order and leads are its own."""
    return [replace(d, severity=Severity.NOTE) for d in findings]


def _last(way: Walk) -> int:
    """Return the row of the last block that cuts."""
    return int(np.flatnonzero(way.cutting & (way.steps > 0))[-1])


def _meeting(places: Ints, at: Floats, low: float, high: float, room: float) -> tuple[int, int]:
    """Return at which of the places of a cut its contour begins, and at which it closes.

    Where blocks are no longer than what rounding moves their ends (a stop or an overcut of a step
    or two) the nearest along the path may be a neighbour: of those within ``room`` of both ends of
    the path, one place that was passed twice, a whole contour apart, is where it closes.

    Args:
        places: where blocks begin and end, steps, shape (n, 2).
        at: how far along the route these are.
        low, high: where on it the contour begins and ends.
        room: how far along the route a place may be from where it was to be.
    """
    starts, ends = np.abs(at - low), np.abs(at - high)
    # The last of several that stand there.
    first, last = int(np.argmin(starts)), len(at) - 1 - int(np.argmin(ends[::-1]))
    if high - low > 4.0 * room and (places[first] != places[last]).any():
        a, b = np.flatnonzero(starts <= room), np.flatnonzero(ends <= room)
        i, j = np.nonzero((places[a][:, None] == places[b][None]).all(axis=2))
        if len(i):
            best = int(np.argmin(starts[a[i]] + ends[b[j]]))
            return int(a[i[best]]), int(b[j[best]])
    return first, last


def _passed(way: Walk, row: int, place: Ints) -> float:
    """Return how near a block comes to a place that it passes, um."""
    x, y, _ = way.points(np.array([row]))
    return float(np.hypot(x - place[0], y - place[1]).min())


def _nowhere(way: Walk, row: int) -> str:
    """Return what it means that a block ends at a wrong place, if it is the last."""
    return ": the program does not end where the plan ends" if row == _last(way) else ""


def _slip(route: Route, t: Track, low: int, high: int, index: Ints, per: float) -> str:
    """Return words on the first of blocks low to high - 1 that ends beside the vertex it is for.

    Along a smooth path a block may run on, or fall short, and be found out by a later one.
    """
    at = t.high[low:high]
    at = at[~np.isnan(at)]
    if not len(at):
        return ""
    after = np.searchsorted(route.to, at)
    near = np.stack([np.clip(after + d, 0, len(route.to) - 1) for d in (-1, 0)])
    nearest = np.abs(at - route.to[near]).argmin(axis=0)
    vertex = near[nearest, np.arange(len(at))]
    missed = at - route.to[vertex]
    # A block may end anywhere on a segment, if another one ends on its vertex.
    met = np.zeros(len(route.to), bool)
    met[vertex[np.abs(missed) <= SLIP]] = True
    slips = np.flatnonzero(~met[vertex] & (np.abs(missed) < SLIPPED))
    if not len(slips):
        return ""
    how = "past" if missed[slips[0]] > 0 else "short of"
    far = abs(float(missed[slips[0]])) / per
    return f"; block {int(index[low + slips[0]]) + 1} already ends {far:.3f} mm {how} its vertex"


def _follow(way: Walk, route: Route, assigned: Sequence[Assigned]) -> Track:
    """Track all blocks of all cuts."""
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


def _places(route: Route, at: Floats) -> Floats:
    """Return points of the route at a progress, shape (n, 2)."""
    segment = np.clip(np.searchsorted(route.at, at, "left") - 1, 0, len(route.at) - 1)
    held = route.segments.take(segment)
    x, y = points_at(held, at - route.at[segment])
    return np.column_stack([x, y])


def _no_table() -> BlockTable:
    """Return the table of no block."""
    none, count, places = np.zeros(0), np.zeros(0, np.int64), np.zeros((0, 2))
    return BlockTable(count, count, places, places.astype(np.int64), none, none, none)


def _extents(e: Floats, stepped: Ints) -> tuple[float, float, float, float]:
    """Return the box of all places, block ends that were not measured included."""
    return (
        float(min(e[0], stepped[:, 0].min())),
        float(min(e[1], stepped[:, 1].min())),
        float(max(e[2], stepped[:, 0].max())),
        float(max(e[3], stepped[:, 1].max())),
    )

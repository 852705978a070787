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

from collections.abc import Callable
from dataclasses import replace

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic, error, has_errors, warning
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.judge.checks import Limits, check_blocks
from wedmcam.judge.conclusion import verdict_of, verdict_of_nothing
from wedmcam.judge.ends import closes, moves_on
from wedmcam.judge.followed import OURS, Followed, Terms, follow
from wedmcam.judge.in_steps import in_steps, verdict_in_um
from wedmcam.judge.keeping import keeps_the_part
from wedmcam.judge.leads import meet_no_cut
from wedmcam.judge.measured import Measured
from wedmcam.judge.paths import runs_the_paths
from wedmcam.judge.verdict import Count, Verdict
from wedmcam.judge.walk import Walk, walk

#: What is measured of the way of the wire, in the order in which it is reported; the material
#: (`keeps_the_part`) is measured behind it.
WAY: tuple[Callable[[Followed], Measured], ...] = (runs_the_paths, closes, meet_no_cut, moves_on)


def judge(
    program: Program,
    plan: Plan,
    *,
    stepping: Stepping,
    limits: Limits | None = None,
    count: Count = "exact",
    free_moves: bool = False,
    terms: Terms = OURS,
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
        free_moves: moves between cuts have no limit (G00).
        terms: what the program is held to.

    Returns:
        The verdict, and findings; ``ok`` is that none of them is an error.
    """
    way = walk(program, stepping, textbook=count == "textbook")
    findings = check_blocks(program, limits, way.steps, free_moves)
    plan = in_steps(plan, program.step_um)
    verdict, problems = _judge(program, plan, terms, way, count)
    verdict = verdict_in_um(verdict, program.step_um)
    findings.extend(problems)
    if count == "textbook":
        stepped, _ = _judge(program, plan, terms, walk(program, stepping), "exact")
        stepped = verdict_in_um(stepped, program.step_um)
        verdict = replace(
            verdict,
            stepped_closure_um=stepped.closure_um,
            stepped_max_deviation_um=stepped.max_deviation_um,
            stepped_gouge_um=stepped.gouge_um,
        )
        if not stepped.ok:
            findings.append(_stepped_differs(stepped))
    return replace(verdict, ok=not has_errors(findings)), findings


def _stepped_differs(stepped: Verdict) -> Diagnostic:
    """Return what a controller that counts steps would do; the verdict on it is in um."""
    closure = stepped.closure_um
    return warning(
        "stepped-differs",
        "a controller that counts steps would leave the wire path by {deviation_mm:.3f} mm and "
        "close no contour"
        if closure is None
        else "a controller that counts steps would leave the wire path by {deviation_mm:.3f} mm "
        "and close the contours within {closure_mm:.3f} mm",
        hint="compile with --count exact for such a controller",
        deviation_mm=stepped.max_deviation_um / 1000.0,
        closure_mm=None if closure is None else closure / 1000.0,
    )


def _judge(
    program: Program, plan: Plan, terms: Terms, way: Walk, count: Count
) -> tuple[Verdict, list[Diagnostic]]:
    """Judge what one machine does; all lengths in its steps."""
    followed, problems = follow(program, plan, terms, way, count)
    findings = list(problems)
    if followed is None:
        if not plan.cuts and not way.cutting.any():
            findings.append(error("missing-cut", "the plan has no cut and the program no block"))
        ok = not has_errors(findings)
        return verdict_of_nothing(program, plan, terms, way, count, ok), findings
    measured = [measure(followed) for measure in WAY]
    findings += [d for m in measured for d in m.findings]
    if terms.strict_order and has_errors(findings):
        from wedmcam.judge.match import repeated_cuts

        findings += repeated_cuts(way, program, plan)
    material = keeps_the_part(followed)
    findings += material.findings
    closures = [c for m in measured for c in m.closures]
    ok = not has_errors(findings)
    return verdict_of(followed, closures, material.gouge, material.uncut, ok), findings

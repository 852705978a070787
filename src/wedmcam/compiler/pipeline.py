"""The compiler on one screen: every stage in its order, and where it stops.

A source becomes a plan, a plan becomes bytes for one machine, and they are proven. Compiles for
several machines, loads, the rest after a broken wire, ``verify`` and images are callers of these
two. Nothing here opens a file or prints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wedmcam.compiler.sources import Drawn, read, where_the_wire_goes
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.diag.run import Run
from wedmcam.ir.plan import Others, Plan
from wedmcam.ir.program import Program
from wedmcam.options import Options
from wedmcam.programs.loads import joined, stretch
from wedmcam.targets import Entries, Target

if TYPE_CHECKING:
    from wedmcam.judge.verdict import Verdict


@dataclass(frozen=True, slots=True, eq=False)
class Compiled:
    """A plan as bytes for one machine.

    Attributes:
        plan: what they were compared with.
        entries: what the operator enters beside them.
        lowered: the program as it was encoded, with roles and sources.
        data: the bytes.
        program: decoded from them, with its origin.
        verdict: the figures of the judge.
    """

    plan: Plan
    entries: Entries
    lowered: Program
    data: bytes
    program: Program
    verdict: Verdict


def plan_source(
    source: bytes, name: str, options: Options, targets: Sequence[Target], run: Run
) -> tuple[Drawn, Plan]:
    """Plan a source: where the wire goes, with starts where all targets can start."""
    drawn = run("drawn", (read(source, name, options, run), ()))
    return drawn, plan_of(drawn, options, targets, run)


def plan_of(drawn: Drawn, options: Options, targets: Sequence[Target], run: Run) -> Plan:
    """Plan what was drawn."""
    plan = where_the_wire_goes(drawn, options, run)
    for target in targets:
        plan = run("leads", target.place_starts(plan))
    return run("plan", (plan, ()))


def write_and_prove(
    plan: Plan, target: Target, options: Options, run: Run, name: str = ""
) -> Compiled:
    """Write the program of a plan for one machine, and prove it."""
    entries, lowered, data = write_program(plan, target, options, run)
    program, verdict = prove_program(data, name, plan, lowered, target, entries, options, run)
    return Compiled(plan, entries, lowered, data, program, verdict)


def write_program(
    plan: Plan, target: Target, options: Options, run: Run
) -> tuple[Entries, Program, bytes]:
    """Write the program of a plan: what the operator enters, the lowered program, its bytes."""
    refused = target.refuses_written
    entries = run("enter", (target.entries(plan), () if refused is None else (refused,)))
    lowered = run("lower", target.lower(plan, options.judging.count, options.operator.feed_um))
    if plan.others is not None:
        load = stretch(lowered, *plan.others.rows, plan.others.start)
        lowered = run("lower", (load, ()))
    feed_um, sharp = options.operator.feed_um, options.cutting.sharp
    data = run("encode", target.write(lowered, plan, entries, feed_um=feed_um, sharp=sharp))
    return entries, lowered, data


def prove_program(
    data: bytes,
    name: str,
    plan: Plan,
    lowered: Program,
    target: Target,
    entries: Entries,
    options: Options,
    run: Run,
) -> tuple[Program, Verdict]:
    """Decode the bytes, run the program, and compare it with the plan and the part."""
    program, findings = target.read(data, name or "program", entries)
    run.add("decode", new_in_reading(run.findings, findings))
    program = run("decode", (replace(program, origin=lowered.origin), ()))
    verdict, findings = judge_program(program, plan, target, options)
    if has_errors(findings):
        findings = [*findings, *target.advice]
    return program, run("verify", (verdict, findings))


def new_in_reading(known: Sequence[Diagnostic], findings: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return the findings of the reader of a program of ours that are new.

    Its notes say how it understood a foreign file; and what the writer warned of (the file needs
    two loads, say) is not repeated.
    """
    codes = {d.code for d in known}
    return [
        d
        for d in findings
        if d.severity is Severity.ERROR or (d.severity > Severity.NOTE and d.code not in codes)
    ]


def judge_program(
    program: Program,
    plan: Plan,
    target: Target,
    options: Options,
    *,
    strict_order: bool = True,
    fitted: bool = False,
) -> tuple[Verdict, list[Diagnostic]]:
    """Run a program on its controller and measure it; see `judge.judge`.

    A load that begins or ends in the kerf is measured between what the others run.
    """
    from wedmcam.judge.followed import Terms
    from wedmcam.judge.judge import judge
    from wedmcam.judge.load import verdict_of_load

    machine, others = target.machine, plan.others
    textbook = (options.judging.count or machine.count) == "textbook"
    whole = program if others is None else _between(program, others)
    verdict, findings = judge(
        whole,
        plan,
        stepping=machine.stepping,
        limits=machine.limits,
        free_moves=machine.move_um is None,
        count="textbook" if textbook else "exact",
        terms=Terms(
            strict_order=strict_order,
            trimmed=options.cutting.trim,
            fitted=fitted,
            arc_limit_um=target.arc_limit_um,
        ),
    )
    if others is None:
        return verdict, findings
    return verdict_of_load(
        verdict, findings, program, whole, len(others.before.blocks), machine.stepping
    )


def _between(program: Program, others: Others) -> Program:
    """Return a load with what the others run before and behind it, where it starts as it does."""
    x, y = (
        whole + here - there
        for whole, here, there in zip(
            others.before.origin, program.origin, others.start, strict=True
        )
    )
    return replace(joined([others.before, program, others.behind]), origin=(x, y))

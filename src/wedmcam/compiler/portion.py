"""The part of a plan that is asked for: some cuts, some blocks, or the rest from a block on.

Blocks are those of the whole program, so it is compiled first, without its proof.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.compiler.pipeline import write_program
from wedmcam.diag.run import Refused, Run, WrongUse
from wedmcam.ir.plan import Others, Plan
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.options import Options
from wedmcam.programs import loads
from wedmcam.programs.places import block_ends, match_blocks
from wedmcam.targets import Target
from wedmcam.transforms.plan.portion import only_cuts, remaining


def portion(plan: Plan, target: Target, options: Options, run: Run) -> Plan:
    """Return the part of a plan that was asked for: some cuts, the rest from a block on, or all.

    Args:
        plan: of the whole source, with starts that suit the target.
        target: whose program has the blocks.
        options: their ``portion`` says what is asked for.
        run: takes the findings of a whole program that cannot be made.

    Raises:
        WrongUse: there is no such cut or block, or nothing is left to cut behind it.
    """
    if options.portion.cuts is not None:
        if options.portion.cuts[1] > len(plan.cuts):
            raise WrongUse(
                f"the program has {len(plan.cuts)} contours, there is no --cuts "
                f"{options.portion.cuts[0]}-{options.portion.cuts[1]}"
            )
        plan = only_cuts(plan, *options.portion.cuts)
    if options.portion.blocks is not None:
        return _load(plan, *options.portion.blocks, target, options, run)
    return _rest(plan, target, options, run) if options.portion.from_block else plan


def _load(plan: Plan, first: int, last: int, target: Target, options: Options, run: Run) -> Plan:
    """Return the plan of a load: some blocks of its program, with what other loads run of it.

    Args:
        plan: whose program has the blocks.
        first, last: of the blocks as decoded, 1-based and both inclusive.
        target, options, run: as of `portion`.

    Raises:
        WrongUse: there are no such blocks, or no load can begin or end between them.
    """
    if target.whole_contours:
        raise WrongUse(f"--blocks is a load that is cut in the kerf: {target.whole_contours}")
    lowered, program = _whole(plan, target, options, run)
    n = len(program.blocks)
    if last > n:
        raise WrongUse(f"the program has {n} blocks, there is no --blocks {first}-{last}")
    kinds = program.blocks["kind"]
    for block in [*([first] if first > 1 else []), *([last + 1] if last < n else [])]:
        if not (kinds[block - 2 : block] < Kind.MOVE).all():
            raise WrongUse(
                f"between blocks {block - 1} and {block} no load can end: one of them does not cut "
                "(between two contours, --cuts parts a program)"
            )
    like = match_blocks(lowered, program, target.machine)
    rows = (
        int(like[first - 1]) if first > 1 else 0,
        int(like[last - 1]) if last < n else len(lowered.blocks) - 1,
    )
    motion = target.machine.stepping.run(program.blocks[: first - 1])
    x, y = program.origin
    start = (x + int(motion.dx.sum()), y + int(motion.dy.sum()))
    before = loads.part(program, 1, first - 1, program.origin)
    return replace(
        plan, others=Others(before, loads.part(program, last + 1, n, start), start, rows)
    )


def _whole(plan: Plan, target: Target, options: Options, run: Run) -> tuple[Program, Program]:
    """Return the program of a plan as it is lowered, and as it is decoded; it is not proven.

    ``run`` takes the findings where it cannot be made.
    """
    trial = Run()  # findings on the whole program are not of its part
    try:
        entries, lowered, data = write_program(plan, target, options, trial)
    except Refused:
        run.findings += trial.findings
        raise
    program, _ = target.read(data, "another load", entries)
    return lowered, replace(program, origin=lowered.origin)


def _rest(plan: Plan, target: Target, options: Options, run: Run) -> Plan:
    """Return what is left of a plan from a block of its program on."""
    machine = target.machine
    lowered, program = _whole(plan, target, options, run)
    n = options.portion.from_block
    if n > len(program.blocks):
        raise WrongUse(f"the program has {len(program.blocks)} blocks, there is no block {n}")
    like = match_blocks(lowered, program, machine)
    cutting = np.flatnonzero((program.blocks["kind"] < Kind.MOVE) & (like >= 0))
    cutting = cutting[cutting >= n - 1]
    roles, cuts = lowered.blocks["role"], lowered.blocks["cut"]
    left = cutting[(roles[like[cutting]] == Role.CONTOUR) | (roles[like[cutting]] == Role.LEAD_IN)]
    if not len(left):
        raise WrongUse(f"from block {n} on nothing is left to cut")
    block = int(left[0])
    cut = int(cuts[like[block]])
    starts, _ = block_ends(program, machine)
    at = (round(starts[block][0]), round(starts[block][1]))
    if roles[like[block]] == Role.LEAD_IN or cut != int(cuts[like[cutting[0]]]):
        # Nothing of this contour was cut.
        if options.portion.backwards:
            raise WrongUse(f"block {n} begins a contour: leave --backwards out")
        return replace(plan, cuts=plan.cuts[cut - 1 :], partial=True)
    if target.needs_lead:
        first = cut + (options.portion.cuts[0] - 1 if options.portion.cuts else 0)
        last = first - cut + len(plan.cuts)
        raise WrongUse(
            f"block {n} lies within contour {first}: {target.needs_lead}. "
            f"--cuts {first}-{last} cuts that contour as a whole; its rest "
            "needs a profile without compensation (iso-um), where blocks have other numbers"
        )
    before = (lowered.blocks["cut"] == cut) & (roles == Role.CONTOUR)
    before[int(like[block]) :] = False
    motion = machine.stepping.run(lowered.blocks)
    # Chords: good enough to tell two passes apart.
    share = np.hypot(motion.dx, motion.dy) * lowered.step_um
    arc = lowered.blocks["kind"] == Kind.ARC
    share[arc] = motion.steps[arc] * (np.pi / 4) * lowered.step_um  # a turn takes 8 R steps
    along = float(share[before].sum())
    findings = remaining(plan, cut - 1, at, along, options.portion.backwards, lowered.step_um)
    if findings is None:
        raise WrongUse(f"block {n} of the program lies on no contour")
    return findings

"""The part of a plan that is asked for: some cuts, or the rest from a block of its program on.

Blocks are those of the whole program, so it is compiled first, without its proof.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.compiler.pipeline import write_program
from wedmcam.diag.run import Refused, Run, WrongUse
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Role
from wedmcam.options import Options
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
    return _rest(plan, target, options, run) if options.portion.from_block else plan


def _rest(plan: Plan, target: Target, options: Options, run: Run) -> Plan:
    """Return what is left of a plan from a block of its program on."""
    machine = target.machine
    trial = Run()  # findings on the whole program are not of its rest
    try:
        entries, lowered, data = write_program(plan, target, options, trial)
    except Refused:
        run.findings += trial.findings
        raise
    program, _ = target.read(data, "program", entries)
    program = replace(program, origin=lowered.origin)
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

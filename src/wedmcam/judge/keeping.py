"""Measure: the wire stays out of what is kept, and reaches all of the outline that it can reach."""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic, error, note, warning
from wedmcam.ir.plan import Material
from wedmcam.judge.beside import entered
from wedmcam.judge.followed import Followed, Held
from wedmcam.judge.material import coverage, wrong_side
from wedmcam.judge.measured import Measured
from wedmcam.judge.runs import mm, span_of
from wedmcam.judge.survey import Survey


def keeps_the_part(f: Followed) -> Measured:
    """Report where the wire enters what is kept, and what of the outlines is not cut."""
    findings: list[Diagnostic] = []
    gouge, uncut = None, None
    for held in f.held:
        m = f.survey if held is f.held[0] else f.surveyed(held.kept)
        deep = _gouge(findings, f, held, m)
        gouge = max(deep, gouge or 0.0)
        left = _coverage(findings, f, held.material)
        uncut = left if uncut is None or left is None else max(left, uncut)
    if f.plan.side in ("left", "right", "on"):
        gouge = None
    for c, x, y, um in entered(f.plan, f.route, f.cuts, np.array([a.cut for a in f.assigned])):
        if um > f.terms.gouge_limit_um:
            findings.append(
                error(
                    "gouge",
                    f"the wire of cut {c + 1} enters what is kept of another part of the plate "
                    f"by {um / f.per:.3f} mm, near {mm(x, y, f.per)} mm",
                    points_mm=((x / f.per, y / f.per),),
                )
            )
            gouge = max(um, gouge or 0.0)
    return Measured(findings, gouge=gouge, uncut=uncut)


def _gouge(findings: list[Diagnostic], f: Followed, held: Held, m: Survey) -> float:
    """Return gouge_um, and report it where it is over the limit."""
    depth = max(0.0, m.gouge)
    for c, x, y, um in wrong_side(held.kept, f.route, held.own):
        findings.append(
            error(
                "gouge",
                f"the wire path of cut {c + 1} runs inside the material that is to be kept at "
                f"{mm(x, y, f.per)} mm; the wire is {um / f.per:.3f} mm deep in it",
                points_mm=((x / f.per, y / f.per),),
                hint="check --side part or die, and the sense of the contour",
            )
        )
        depth = max(depth, um)
    if m.gouge > f.terms.gouge_limit_um:
        x, y = m.gouge_at
        row = int(f.index[f.done][m.gouge_block])
        findings.append(
            error(
                "gouge",
                f"block {row + 1}: the wire enters the kept material by "
                f"{m.gouge / f.per:.5f} mm at {mm(x, y, f.per)} mm (limit "
                f"{f.terms.gouge_limit_um / f.per:.5f} mm)",
                span_of(f.program, row),
                points_mm=((x / f.per, y / f.per),),
            )
        )
    return depth


def _coverage(findings: list[Diagnostic], f: Followed, material: Material) -> float | None:
    """Return uncut_um, and report pieces that are missing.

    Of a part of a program only the outlines that it cuts whole are asked for, and there is no
    uncut_um; that every path of it is run is proven all the same (`deviation`).
    """
    c = coverage(material, f.route)
    say = warning if f.terms.trimmed else error
    whole = {c.number - 1 - material.first for c in f.plan.cuts if c.path.closed}
    cut_of = {c.number - 1 - material.first: k for k, c in enumerate(f.plan.cuts, 1)}
    for outline, share, x, y, um in c.missing:
        if f.plan.partial and outline not in whole:
            continue
        how = f"the wire stays {um / f.per:.3f} mm off it" if np.isfinite(um) else "no cut"
        name = f"the outline of cut {cut_of[outline]}" if outline in cut_of else "an outline"
        what = "is not cut" if share == 1 else f"is not cut on {share:.0%} of its segments"
        findings.append(
            say(
                "missing-piece",
                f"{name} {what}, first at {mm(x, y, f.per)} mm: {how}",
                points_mm=((x / f.per, y / f.per),),
            )
        )
    if f.plan.partial:
        return None
    if c.uncut_um > f.terms.path_limit_um:
        x, y = c.uncut_at
        findings.append(
            note(
                "uncut-corner",
                f"the round wire leaves up to {c.uncut_um / f.per:.3f} mm in inner corners, "
                f"most at {mm(x, y, f.per)} mm",
                points_mm=((x / f.per, y / f.per),),
            )
        )
    return c.uncut_um

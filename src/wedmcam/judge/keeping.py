"""Measure: the wire stays out of what is kept, and reaches all of the outline that it can reach."""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic, error, note, warning
from wedmcam.ir.plan import Material
from wedmcam.judge.beside import entered
from wedmcam.judge.followed import Followed, Held
from wedmcam.judge.material import coverage, wrong_side
from wedmcam.judge.measured import Measured
from wedmcam.judge.stretches import span_of
from wedmcam.judge.survey import Survey


def keeps_the_part(f: Followed) -> Measured:
    """Report where the wire enters what is kept, and what of the outlines is not cut."""
    findings: list[Diagnostic] = []
    gouge, uncut = None, None
    for held in f.held:
        m = f.survey if held is f.held[0] else f.survey_with(held.kept)
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
                    "the wire of cut {cut} enters what is kept of another part of the plate by "
                    "{depth_mm:.3f} mm, near {place}",
                    points_mm=(f.place(x, y),),
                    cut=c + 1,
                    depth_mm=um / f.per,
                    place=f.place(x, y),
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
                "the wire path of cut {cut} runs inside the material that is to be kept at "
                "{place}; the wire is {depth_mm:.3f} mm deep in it",
                points_mm=(f.place(x, y),),
                hint="check --side part or die, and the sense of the contour",
                cut=c + 1,
                place=f.place(x, y),
                depth_mm=um / f.per,
            )
        )
        depth = max(depth, um)
    if m.gouge > f.terms.gouge_limit_um:
        row = int(f.index[f.done][m.gouge_block])
        findings.append(
            error(
                "gouge",
                "block {block}: the wire enters the kept material by {depth_mm:.5f} mm at {place} "
                "(limit {limit_mm:.5f} mm)",
                span_of(f.program, row),
                points_mm=(f.place(*m.gouge_at),),
                block=row + 1,
                depth_mm=m.gouge / f.per,
                place=f.place(*m.gouge_at),
                limit_mm=f.terms.gouge_limit_um / f.per,
            )
        )
    return depth


def _coverage(findings: list[Diagnostic], f: Followed, material: Material) -> float | None:
    """Return uncut_um, and report pieces that are missing.

    Of a part of a program only the outlines that it cuts whole are asked for, and there is no
    uncut_um; that every path of it is run is proven all the same (`deviation`).
    """
    c = coverage(material, f.route)
    finding = warning if f.terms.trimmed else error
    whole = {c.number - 1 - material.first for c in f.plan.cuts if c.path.closed}
    cut_of = {c.number - 1 - material.first: k for k, c in enumerate(f.plan.cuts, 1)}
    for outline, share, x, y, um in c.missing:
        if f.plan.partial and outline not in whole:
            continue
        at = f.place(x, y)
        if outline in cut_of:
            missing = finding(
                "missing-piece",
                "the outline of cut {cut} is not cut",
                points_mm=(at,),
                cut=cut_of[outline],
            )
        else:
            missing = finding("missing-piece", "an outline is not cut", points_mm=(at,))
        if share != 1:
            missing = missing.extended(" on {share:.0%} of its segments", share=share)
        missing = missing.extended(", first at {place}", place=at)
        if np.isfinite(um):
            missing = missing.extended(": the wire stays {off_mm:.3f} mm off it", off_mm=um / f.per)
        else:
            missing = missing.extended(": no cut")
        findings.append(missing)
    if f.plan.partial:
        return None
    if c.uncut_um > f.widest:
        findings.append(
            note(
                "uncut-corner",
                "the round wire leaves up to {uncut_mm:.3f} mm in inner corners, most at {place}",
                points_mm=(f.place(*c.uncut_at),),
                uncut_mm=c.uncut_um / f.per,
                place=f.place(*c.uncut_at),
            )
        )
    return c.uncut_um

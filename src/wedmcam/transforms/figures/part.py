"""The cuts of a part program as shapes: each figure built once and taken through its transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Sequence as Stages
from wedmcam.ir.figure import Transform
from wedmcam.ir.part import CutItem, Part
from wedmcam.ir.sketch import SEGMENT, Sketch, SketchInfo, ThreadPoint
from wedmcam.transforms import direction, figures
from wedmcam.transforms.plan.shaped import ShapedCut


def shape_cuts(
    part: Part, more: Sequence[Transform], ar: Arithmetic
) -> tuple[tuple[ShapedCut, ...] | None, list[Diagnostic]]:
    """Return the cuts with their figures made.

    Args:
        part: as written.
        more: transforms of ``--transform``, after those of the program; thread points follow them.
        ar: the arithmetic of the formulas.
    """
    shaped: list[ShapedCut] = []
    findings: list[Diagnostic] = []
    built: dict[int, tuple[Contour, ...] | None] = {}
    for item in part.cuts:
        key = id(item.shape)
        if key not in built:
            built[key], problems = _figure(item, ar)
            findings += problems
        figure = built[key]
        if figure is None:
            continue
        spots = tuple(ThreadPoint(*p) for p in (item.start, item.enter) if p is not None)
        if more:
            moved, problems = figures.transformed(figure, Stages(tuple(more)), ar, spots)
            findings += problems
            if moved is None:
                continue
            figure, spots = moved
        starts = () if item.start is None else spots[:1]
        enter = None if item.enter is None else spots[-1]
        stages = [*(stage for stage, _ in item.shape.stages), *more]
        shaped.append(ShapedCut(item, figure, starts, enter, direction.clockwise(figure, stages)))
    return (None if has_errors(findings) else tuple(shaped)), findings


def _figure(item: CutItem, ar: Arithmetic) -> tuple[tuple[Contour, ...] | None, list[Diagnostic]]:
    figure, findings = figures.join_chains(item.shape.chains)
    out = [d for d in findings if d.severity > Severity.NOTE]
    for stage, span in item.shape.stages:
        moved, problems = figures.transformed(figure, stage, ar)
        out += [d if d.span is not None else replace(d, span=span) for d in problems]
        if moved is None:
            return None, out
        figure = moved[0]
    return figure, out


def sketch_of(part: Part, cuts: Sequence[ShapedCut]) -> tuple[Sketch, tuple[Contour, ...]]:
    """Return the facts of a part program: its unit, names and thread points, its contours."""
    contours: list[Contour] = []
    for w in cuts:
        contours += [c for c in w.figure if not any(c is known for known in contours)]
    info = SketchInfo(
        units=part.units,
        units_from="the part program",
        entities={"contour": dict(part.blocks)},
        extra={"part": part.name} if part.name else {},
    )
    threads = tuple(start for w in cuts for start in w.starts)
    return Sketch(np.zeros(0, SEGMENT), (), threads, info), tuple(contours)

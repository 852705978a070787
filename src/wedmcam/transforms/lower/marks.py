"""Stops and overcuts that the grid of the machine would swallow."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wedmcam.diag import Diagnostic, error
from wedmcam.geom.segments import Ints
from wedmcam.ir.plan import Plan
from wedmcam.transforms.lower.layout import Layout

if TYPE_CHECKING:
    from wedmcam.transforms.lower import Rules


def short_marks(gx: Ints, gy: Ints, layout: Layout, plan: Plan, rules: Rules) -> list[Diagnostic]:
    """Return errors where a stop or an overcut begins and ends on one step: it would be none.

    ``gx``, ``gy``: the step that each vertex is on.
    A pause on the step of the thread point is the end of the cut, to the machine as to the judge.
    """
    findings = []
    for name, index, vertex, others in layout.marks:
        x, y = int(gx[vertex]), int(gy[vertex])
        if all((x, y) != (int(gx[v]), int(gy[v])) for v in others):
            continue
        cut, per = plan.cuts[index], rules.per_mm
        length = cut.stop_um if name == "stop" else cut.overcut_um
        end = rules.place(x, y)
        findings.append(
            error(
                f"{name}-too-short",
                "the stop of {length_mm:.3f} mm of cut {cut} is lost on the grid of the machine's "
                "steps: {end}, where it ends, is also where the cut does, or its thread point"
                if name == "stop"
                else "the overcut of {length_mm:.3f} mm of cut {cut} is lost on the grid of the "
                "machine's steps: {end}, where it ends, is also where the cut closes",
                cut.path.source_of(0),
                hint="a longer --{option}, or none",
                points_mm=(end,),
                option=name,
                length_mm=length / per,
                cut=index + 1,
                end=end,
            )
        )
    return findings

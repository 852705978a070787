"""A plan on the grid of a machine whose step is not 1 um: all of it in steps.

Lowering then goes on as if a step were a um; its bounds are so many steps.
"""

from __future__ import annotations

from dataclasses import replace

from wedmcam.geom.quantize import to_grid
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan


def in_steps(plan: Plan, step_um: float) -> Plan:
    """Return a plan with all that lowering looks at in steps; thread points on whole ones."""
    if step_um == 1:
        return plan
    return replace(plan, cuts=tuple(_cut(c, 1.0 / step_um) for c in plan.cuts), scenes=())


def _cut(c: Cut, scale: float) -> Cut:
    x, y = to_grid([c.thread[0] * scale, c.thread[1] * scale]).tolist()
    return replace(
        c,
        outline=None,
        path=_contour(c.path, scale),
        thread=(x, y),
        stop_um=c.stop_um * scale,
        overcut_um=c.overcut_um * scale,
        offset_um=c.offset_um * scale,
        clearance_um=c.clearance_um * scale,
    )


def _contour(c: Contour, scale: float) -> Contour:
    v = c.vertices.copy()
    v["x"], v["y"], v["cx"], v["cy"] = (v[name] * scale for name in ("x", "y", "cx", "cy"))
    return Contour(v, c.closed, c.sources)

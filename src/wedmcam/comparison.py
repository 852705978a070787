"""By how much 8-digit decimals and float64 part: the same part planned in the other arithmetic.

The ZD-065's arithmetic decides every micron that is cut; whoever asks for the other wants to know
what it changes, and whoever uses 8 digits what they cost. Measured is the exact wire path, before
the grid of the machine hides most of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.compiler import sources
from wedmcam.compiler.sources import Drawn
from wedmcam.diag.run import Refused, Run
from wedmcam.geom import segments as seg
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan
from wedmcam.options import ARITHMETICS, Options

#: Pairs of a vertex and a segment that are looked at at once: some 30 MB.
PAIRS = 500_000


def difference_um(
    data: bytes, name: str, drawn: Drawn, plan: Plan, options: Options
) -> float | None:
    """Return how far the wire path of the other arithmetic is from that of a plan, um.

    Args:
        data: the source that was compiled.
        name: of the source.
        drawn: what was read from it.
        plan: where the wire goes, in the arithmetic of ``options``.
        options: as compiled.

    Returns:
        The largest distance of a vertex from the vertex of the same number; from the nearest
        segment where the paths have not the same segments. None where the other arithmetic refuses
        the part.
    """
    (other,) = (name for name in ARITHMETICS if name != options.arithmetic)
    options = replace(options, arithmetic=other, strict=False)
    run = Run()
    try:
        if drawn.computed:
            drawn = sources.read(data, name, options, run)
        there = sources.where_the_wire_goes(drawn, options, run)
    except Refused:
        return None
    return _apart([c.path for c in plan.cuts], [c.path for c in there.cuts])


def _apart(one: Sequence[Contour], two: Sequence[Contour]) -> float:
    same = len(one) == len(two) and all(
        a.closed == b.closed and np.array_equal(a.vertices["turn"], b.vertices["turn"])
        for a, b in zip(one, two, strict=True)
    )
    if same:
        return max(
            float(np.hypot(*(a.vertices[k] - b.vertices[k] for k in ("x", "y"))).max())
            for a, b in zip(one, two, strict=True)
        )
    return max(_from_segments(one, two), _from_segments(two, one))


def _from_segments(one: Sequence[Contour], two: Sequence[Contour]) -> float:
    """Return the largest distance of a vertex of ``one`` from ``two``."""
    x, y = (np.concatenate([c.vertices[k] for c in one]) for k in ("x", "y"))
    s = seg.of_rows(np.concatenate([c.starts for c in two]), np.concatenate([c.ends for c in two]))
    worst = 0.0
    step = max(1, PAIRS // len(s))
    for k in range(0, len(x), step):
        px, py = x[k : k + step], y[k : k + step]
        every = s.take(np.tile(np.arange(len(s)), len(px)))
        d = seg.distances(every, np.repeat(px, len(s)), np.repeat(py, len(s)))
        worst = max(worst, float(d.reshape(len(px), len(s)).min(axis=1).max()))
    return worst

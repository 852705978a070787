"""By how much 8-digit decimals and float64 part: the same part planned in the other arithmetic.

The ZD-065's arithmetic decides every micron that is cut; whoever asks for the other wants to know
what it changes, and whoever uses 8 digits what they cost. Measured is the exact wire path, before
the grid of the machine hides most of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.compiler import sources
from wedmcam.compiler.sources import Drawn
from wedmcam.diag.run import Refused, Run
from wedmcam.geom import pairs
from wedmcam.geom import segments as seg
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan
from wedmcam.options import ARITHMETICS, Options

#: Pairs of a vertex and a segment that are looked at at once: some 30 MB.
PAIRS = 500_000
#: The arithmetics are hardly ever farther apart than this, um.
NEAR_UM = 1.0


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
        The largest distance of a place of either path from the other path. The paths are compared
        as sets of places: where a tie is decided otherwise, they start elsewhere and are the same.
        None where the other arithmetic refuses the part.
    """
    (other,) = (name for name in ARITHMETICS if name != options.arithmetic)
    options = options.with_values(arithmetic=other, strict=False)
    run = Run()
    try:
        if drawn.computed:
            drawn = sources.read(data, name, options, run)
        there = sources.where_the_wire_goes(drawn, options, run)
    except Refused:
        return None
    return _apart([c.path for c in plan.cuts], [c.path for c in there.cuts])


def _apart(one: Sequence[Contour], two: Sequence[Contour]) -> float:
    """Return how far two sets of paths are from each other, wherever they start, um."""
    return max(_from_paths(one, two), _from_paths(two, one))


def _from_paths(one: Sequence[Contour], two: Sequence[Contour]) -> float:
    """Return the largest distance of ``one``, its vertices and middles, from ``two``."""
    ours, s = _segments(one), _segments(two)
    middle_x, middle_y = seg.points_at(ours, 0.5 * ours.length)
    x, y = (np.concatenate(c) for c in ((ours.x0, ours.x1, middle_x), (ours.y0, ours.y1, middle_y)))
    boxes = seg.boxes(s)
    apart = np.full(len(x), np.inf)
    reach = NEAR_UM
    while len(rest := np.flatnonzero(np.isinf(apart))):
        # All segments may be near to all points in the end: a few points at a time then.
        step = len(rest) if reach == NEAR_UM else max(1, PAIRS // len(s))
        for k in range(0, len(rest), step):
            px, py = x[rest[k : k + step]], y[rest[k : k + step]]
            i, j = pairs.overlapping((px, py, px, py), pairs.grow(boxes, reach))
            d = pairs.least(seg.distances(s.take(j), px[i], py[i]), i, len(px))
            apart[rest[k : k + step]] = np.where(d <= reach, d, np.inf)
        reach *= 100.0
    return float(apart.max())


def _segments(paths: Sequence[Contour]) -> seg.Segments:
    return seg.of_rows(
        np.concatenate([c.starts for c in paths]), np.concatenate([c.ends for c in paths])
    )

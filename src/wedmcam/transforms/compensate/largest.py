"""The largest offset of outlines: the limit between a wire path and interference.

It is found by asking ``compensate`` itself, as a compile does, so that the two agree whatever
limits an offset: a fillet, a neck, the mouth of an arc of more than half a turn, the size of a
hole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.geom import measure
from wedmcam.geom import segments as seg
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.interference import (
    CORNER_UM,
    NEGLIGIBLE_UM,
    Interference,
)

#: The first offset that is tried, um, and how much larger the next one is: small offsets cross
#: little, so they are fast.
FIRST_UM, FACTOR = 60.0, 4.0
#: Holes and slots are limited by half their size, but for up to this, um: a path has a width,
#: and at the very half all sides of a polygon about a circle meet in one place.
BELOW_UM = 2.0
#: A wire so little larger than a limit of whole um is still told to be at it, um.
SEARCH_UM = 0.05


@dataclass(frozen=True, slots=True)
class Largest:
    """What limits the offset of outlines.

    Attributes:
        offset_um: a wire at this offset fits; the limit is above it, within the same whole um.
        limit: what is in the way of larger ones; None where that was not looked for any farther.
    """

    offset_um: float
    limit: Interference | None

    @property
    def nearest_um(self) -> int:
        """The limit in whole um: 1 um less fits, 1 um more does not."""
        return _whole(self.offset_um)


def _whole(offset_um: float) -> int:
    """Return the whole um above an offset that fits; it may be over the limit by `SEARCH_UM`."""
    return int(np.floor(offset_um - SEARCH_UM + 1e-9)) + 1


def largest_offset(
    outlines: Sequence[Contour], signs: Sequence[float], limit_um: float = 8000.0
) -> Largest:
    """Return the largest offset without interference, and what limits it.

    Looks at fillets, necks and slots, not at sharp corners. The result is at most 1 um below the
    true limit, and in the same whole um; ``limit_um`` with None when nothing limits the offset up
    to there.

    Args:
        outlines: contours of one part, um, that cross neither themselves nor another one.
        signs: +1 where the wire runs to the left of the outline, -1 to the right.
        limit_um: where to stop looking.
    """
    if not outlines:
        return Largest(limit_um, None)

    def trouble(offset: float) -> Interference | None:
        result, problems = compensate(outlines, [offset * s for s in signs])
        if problems:
            return Interference("unresolved", (0.0, 0.0), 0, 0, (), 0.0)
        return result.interference[0] if result.interference else None

    radius = _least_inside_radius(outlines, signs)
    size = _half_least_size(outlines, signs)
    # Where the limit often lies: tried on the way up, so that little is left to be searched.
    likely = [size - BELOW_UM + SEARCH_UM, size + BELOW_UM]
    if radius is not None:
        likely += [radius.size, radius.size + CORNER_UM + SEARCH_UM]
    low, high, worst = 0.0, limit_um, None
    while worst is None and low < limit_um:
        step = min([max(FIRST_UM, FACTOR * low), limit_um, *(one for one in likely if one > low)])
        worst = trouble(step)
        if worst is None:
            low = step
        else:
            high = step
    # Only whole um are told, and trials near the limit are slow: no more of them than needed.
    least, most = _whole(low), int(np.ceil(high - SEARCH_UM - 1e-9))
    while worst is not None and least < most:
        middle = (least + most) // 2
        problem = trouble(middle + SEARCH_UM)
        if problem is None:
            low, least = middle + SEARCH_UM, middle + 1
        else:
            most, worst = middle, problem
    if worst is not None and radius is not None and 0 <= low - radius.size <= CORNER_UM:
        return Largest(radius.size, radius)  # a fillet up to half a step smaller is a corner
    return Largest(low, worst)


def _least_inside_radius(
    outlines: Sequence[Contour], signs: Sequence[float]
) -> Interference | None:
    best: Interference | None = None
    for number, (contour, sign) in enumerate(zip(outlines, signs, strict=True)):
        s = seg.of_rows(contour.starts, contour.ends)
        # Only what is long enough to count when it is left out.
        inside = np.flatnonzero((s.turn * sign > 0) & (s.length > NEGLIGIBLE_UM))
        if not len(inside):
            continue
        k = int(inside[np.argmin(s.radius[inside])])
        if best is None or s.radius[k] < best.size:
            x, y = seg.points_at(s.take(inside[:1] * 0 + k), 0.5 * s.length[k : k + 1])
            best = Interference(
                "radius", (float(x[0]), float(y[0])), number, k, (k,), float(s.radius[k])
            )
    return best


def _half_least_size(outlines: Sequence[Contour], signs: Sequence[float]) -> float:
    """Return half of the smaller side of the smallest contour that the wire runs inside of, um."""
    best = np.inf
    for contour, sign in zip(outlines, signs, strict=True):
        if contour.closed and (measure.area(contour.vertices) > 0) == (sign > 0):
            x0, y0, x1, y1 = measure.extents(contour.vertices, True)
            best = min(best, 0.5 * float(min(x1 - x0, y1 - y0)))
    return best

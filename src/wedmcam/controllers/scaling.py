"""Gap compensation that only scales arcs: what controllers do with 4B.

In 8-digit decimals, as on the ZD-065, whose own compensation does the same where all joints
are tangent.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import cutting_blocks, decimals, whole
from wedmcam.ir.program import Kind


def scale(figure: NDArray[np.void], gap_um: int, outwards: bool = True) -> NDArray[np.void]:
    """Return the cutting blocks of a figure in compensation format, offset by the gap.

    Lines stay as they are; x, y and J of an arc are scaled by (R + gap) / R or (R - gap) / R. That
    is the offset path where all joints are tangent.

    Args:
        figure: dtype `OUTLINE`; R - gap > 0 for every arc that shrinks.
        gap_um: whole um, 0 to 7999 on the machine [S].
        outwards: True for a punch (凸模), False for a die (凹模).

    Returns:
        dtype `BLOCK`.

    >>> from wedmcam.controllers.zd065.data import OUTLINE
    >>> f = np.zeros(1, OUTLINE)
    >>> f[0] = (Kind.ARC, 1, 1, 2, 5_000, 3_000, 4_000, 7_071)
    >>> [scale(f, 100)[k].tolist() for k in ("x", "y", "count")]
    [[3060], [4080], [7212]]
    """
    x, y, count = (figure[k].astype(np.int64).copy() for k in ("x", "y", "count"))
    arc = np.flatnonzero(figure["kind"] == Kind.ARC)
    if len(arc) and gap_um:
        sign = figure["grows"][arc].astype(np.int64) * (1 if outwards else -1)
        radius = figure["radius"][arc]
        assert (radius + sign * gap_um > 0).all()
        factor = decimals(radius + sign * gap_um) / decimals(radius)
        for column in (x, y, count):
            column[arc] = whole(decimals(column[arc]) * factor)
    blocks = np.asarray(cutting_blocks(figure["kind"], figure["turn"], x, y, count))
    blocks["axis"][arc] = figure["axis"][arc]
    return blocks

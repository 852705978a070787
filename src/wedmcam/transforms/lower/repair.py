"""Moving vertices by a micron where an arc does not land.

About one short arc in a few has no centre from which the interpolator ends on the wanted micron.
Then its ends may go to neighbouring microns, and so may those of the arcs next to it: a chain of
choices, where each pair has a cost, solved exactly by dynamic programming (Viterbi).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def best_chain(costs: Sequence[Floats], extra: Sequence[Floats]) -> list[int] | None:
    """Return the choice for each vertex of a chain that costs least, or None if none is possible.

    Args:
        costs: costs[k][a, b] of segment k from choice a of vertex k to choice b of vertex k + 1;
            inf where impossible.
        extra: extra[k][a], the cost of choice a of vertex k by itself.

    The worst segment counts most: costs enter with their fourth power.
    """
    best = extra[0].copy()
    back: list[NDArray[np.int64]] = []
    for cost, own in zip(costs, extra[1:], strict=True):
        total = best[:, None] + cost**4 + own[None, :]
        back.append(np.argmin(total, axis=0))
        best = total[back[-1], np.arange(total.shape[1])]
    last = int(np.argmin(best))
    if not np.isfinite(best[last]):
        return None
    chain = [last]
    for step in reversed(back):
        chain.append(int(step[chain[-1]]))
    return chain[::-1]

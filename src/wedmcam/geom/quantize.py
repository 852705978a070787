"""The one border between floats and the machine's integers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A value this near below a half is taken as the half: float64 noise of coordinates up to 10 m
#: (2e-9 um) must not decide which way a drawn half-micron goes.
HALF_NOISE_UM = 1e-7


def to_grid(values: ArrayLike) -> NDArray[np.int64]:
    """Return the nearest whole um, halves away from zero (四舍五入, as the ZD-065 rounds).

    Symmetric about 0, so that mirrored parts give mirrored programs.

    >>> to_grid([0.5, -0.5, 2.4, -2.6, 1.4999999999]).tolist()
    [1, -1, 2, -3, 2]
    """
    v = np.asarray(values, dtype=np.float64)
    return (np.sign(v) * np.floor(np.abs(v) + 0.5 + HALF_NOISE_UM)).astype(np.int64)

"""The one rounding that all results of arrays go through.

An operation is done in float64, on the floats that name its operands, and is wrong by less than
`NEAR` of an eighth digit. The nearest 8-digit decimal is then known unless the value lies that
near to a tie, or beyond the powers of ten that float64 holds exactly. Those few elements are
`settled` by exact means. So each result is the exact one, rounded once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.form import DIGITS, ZERO
from wedmcam.decimal8.held import (
    EXACT_TEN,
    Floats,
    Ints,
    cells,
    checked,
    decades,
    ten,
)

#: Elements computed at a time: temporaries stay in a level 2 cache.
PIECE = 16384

#: How near to the middle, in units of the last digit, a float64 value may come and still be
#: believed. Each rounding of a number below 1e8 is 1.1e-8: an operand, a product, the scaling.
#: numpy's functions are good to 8 of those (`functions.LIBRARY`).
NEAR = 2e-7
_SURE = 0.5 - NEAR
#: From here on a mantissa may be that of a power of ten from which digits were lost.
_LAST = 99999996.0
#: A tie moved away from zero by this much rounds that way.
_NEAR = np.array(NEAR)

#: By cell, for values from 1e-14 to 1e30: what brings them to 8 digits before the point. The
#: first 22 powers of ten are exact, so the way back, one division or multiplication, rounds once.
#: NaN elsewhere, which makes an element doubtful.
_ALL = np.arange(4096)
_PLACES = decades(_ALL)
_SCALE = np.where(
    (_PLACES >= DIGITS - EXACT_TEN) & (_PLACES <= DIGITS + EXACT_TEN),
    ten(DIGITS - _PLACES),
    np.where(_PLACES == ZERO, 1.0, np.nan),
)
_UP = np.where(_SCALE < 1, ten(_PLACES - DIGITS), 1.0)
_DOWN = np.where(_SCALE < 1, 1.0, _SCALE)

#: Exact results of chosen elements: floats that name the operands in, mantissas and exponents out.
Settle = Callable[..., tuple[NDArray[Any], NDArray[Any]]]


def rounded(
    y: Floats,
    operands: tuple[Floats, ...],
    settle: Settle,
    start: int = 0,
    slack: Floats | None = None,
    ties: Callable[..., bool] | None = None,
    cancels: bool = False,
) -> Floats:
    """Return the results nearest to y, as the floats that name them.

    Args:
        y: results, each wrong by less than `NEAR` of a last digit, and by the slack.
        operands: what they were computed from, broadcast like y.
        settle: exact results of the doubtful elements.
        start: number of the first element, for messages.
        slack: further absolute error of each y.
        ties: whether, of these operands, a result that near to a tie is one.
        cancels: whether digits may have been lost against each other, so that a value just below
            a power of ten may be that power.

    Raises:
        OverflowError: a result has an exponent above 99.
    """
    if not y.size:
        return y
    cell = cells(y)
    scale = _SCALE[cell]
    s = np.multiply(y, scale)
    whole = np.rint(s)
    np.subtract(s, whole, s)
    np.abs(s, s)
    if slack is not None:
        np.add(s, np.multiply(slack, scale), s)
    # argmax takes NaN for the largest, and a quarter of the time of max().
    worst = s.item(s.argmax())
    lost = False
    if cancels:
        size = np.abs(whole)
        lost = not size.item(size.argmax()) < _LAST
    if worst < _SURE and not lost:
        return _restored(whole, scale, cell)
    if ties is not None and worst >= _SURE and not lost:
        at = (s >= _SURE).ravel().nonzero()[0]
        if ties(*(a if a.size == 1 else _pick(a, at, y.shape) for a in operands)):
            np.multiply(y, scale, s)
            np.add(s, np.copysign(_NEAR, s), s)
            return _restored(np.rint(s, whole), scale, cell)
    hard = ~(s < _SURE)
    if lost:
        hard |= ~(size < _LAST)
    at = np.flatnonzero(hard)
    out = _restored(whole, scale, cell)
    out.flat[at] = checked(*settle(*(_pick(a, at, y.shape) for a in operands)), at + start)
    return out


def _restored(whole: Floats, scale: Floats, cell: Ints) -> Floats:
    """Return the numbers of scaled mantissas, which are overwritten."""
    least = scale.item(scale.argmin())
    if least >= 1.0:
        return np.divide(whole, scale, whole)
    np.multiply(whole, _UP[cell], whole)
    return np.divide(whole, _DOWN[cell], whole)


def _pick(a: Floats, at: NDArray[np.intp], shape: tuple[int, ...]) -> Floats:
    if a.size == 1:
        return np.full(at.size, a.item())
    return (a if a.shape == shape else np.broadcast_to(a, shape)).ravel()[at]


def piecewise(function: Callable[..., Floats], *operands: Floats, piece: int = PIECE) -> Floats:
    """Return ``function(start, *operands)``, of large arrays piece by piece.

    Args:
        function: computes one piece, of at least one axis; start is the number of its first
            element.
        operands: of any shapes that broadcast.
        piece: elements at a time.
    """
    largest = operands[0] if len(operands) == 1 or operands[0].size > 1 else operands[1]
    if largest.size <= piece:
        if largest.ndim:
            return function(0, *operands)
        if all(a.ndim == 0 for a in operands):
            return function(0, *(a.reshape(1) for a in operands)).reshape(())
    shape = np.broadcast_shapes(*(a.shape for a in operands))
    flat = [a if a.size == 1 else np.broadcast_to(a, shape).reshape(-1) for a in operands]
    flat = [a.reshape(1) if a.size == 1 else a for a in flat]
    out = np.empty(int(np.prod(shape)))
    for start in range(0, out.size, piece):
        stop = start + piece
        out[start:stop] = function(start, *(a if a.size == 1 else a[start:stop] for a in flat))
    return out.reshape(shape)

"""The one rounding that all results of arrays go through.

An operation is done in float64, on the floats that name its operands, and is wrong by less than
`NEAR` of an eighth digit. The nearest 8-digit decimal is then known unless the value lies that
near to a tie, or beyond the powers of ten that float64 holds exactly. Those few elements are
settled by exact means (`Settle`). So each result is the exact one, rounded once.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.encoding import EXACT_TEN, Floats, Ints, cells, checked, decades, ten
from wedmcam.decimal8.number_format import DIGITS, ZERO

#: Elements computed at a time: so many that calls do not count, so few that buffers stay in cache.
PIECE = 32768

#: How near to the middle, in units of the last digit, a float64 value may come and still be
#: believed. Each rounding of a number below 1e8 is 1.1e-8: an operand, a product, the scaling.
#: numpy's functions are good to 8 of those (the bound in `functions`).
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


class Work(NamedTuple):
    """Where to compute: buffers of one piece of a large array, or None for new ones.

    Attributes:
        start: number of the piece's first element, for messages.
        y: for results before they are rounded.
        cell: for integers, two rows.
        scale: for powers of ten.
        whole: for mantissas.
        out: for results.
    """

    start: int = 0
    y: Floats | None = None
    cell: Ints | None = None
    scale: Floats | None = None
    whole: Floats | None = None
    out: Floats | None = None


_NEW = Work()


def rounded(
    work: Work,
    y: Floats,
    operands: tuple[Floats, ...],
    settle: Settle,
    ties: Callable[..., bool] | bool = False,
    cancels: bool = False,
    slack: Floats | None = None,
    spare: Floats | None = None,
) -> Floats:
    """Return the results nearest to y, as the floats that name them.

    Args:
        work: buffers.
        y: results, each wrong by less than `NEAR` of a last digit, and by the slack.
        operands: what they were computed from, broadcast like y.
        settle: exact results of the doubtful elements.
        ties: whether a result that near to a tie is one; or a function of the operands of those
            results that tells it.
        cancels: whether digits may have been lost against each other, so that a value just below
            a power of ten may be that power.
        slack: further absolute error of each y.
        spare: a buffer, y itself if that is no longer needed.

    Raises:
        OverflowError: a result has an exponent above 99.
    """
    if y.size <= 1:
        one = _one(y.item(), operands, ties, cancels, slack) if y.size else 0.0
        if one is not None:
            if spare is not y:
                return np.full(y.shape, one)
            y.fill(one)
            return y
    cell = cells(y, work.cell)
    scale = _looked_up(_SCALE, cell, work)
    s = np.multiply(y, scale, spare)
    whole = np.rint(s, work.whole)
    off = np.subtract(s, whole, s)
    if slack is not None:
        np.abs(off, off)
        np.add(off, np.multiply(slack, scale), off)
    # argmax and argmin find NaN first, and take a quarter of the time of max and min.
    sure = off.item(off.argmax()) < _SURE and off.item(off.argmin()) > -_SURE
    kept = not cancels or (
        whole.item(whole.argmax()) < _LAST and whole.item(whole.argmin()) > -_LAST
    )
    if sure and kept:
        return _restored(whole, scale, cell, work)
    size = np.abs(off)
    if ties and kept and size.item(size.argmax()) < 1.0:
        if ties is True:
            np.add(whole, off, s)
            np.add(s, np.copysign(_NEAR, s), s)
            return _restored(np.rint(s, whole), scale, cell, work)
        at = (size >= _SURE).ravel().nonzero()[0]
        if ties(*(a if a.size == 1 else _pick(a, at, y.shape) for a in operands)):
            few = whole.ravel()[at]
            few += off.ravel()[at]
            few += np.copysign(_NEAR, few)
            whole.flat[at] = np.rint(few)
            return _restored(whole, scale, cell, work)
    hard = ~(size < _SURE)
    if not kept:
        hard |= ~(np.abs(whole) < _LAST)
    at = np.flatnonzero(hard)
    out = _restored(whole, scale, cell, work)
    out.flat[at] = checked(*settle(*(_pick(a, at, y.shape) for a in operands)), at + work.start)
    return out


#: 1e-15 to 1e30; the n-th decade ends at the n-th of them.
_ENDS = [float(f"1e{k}") for k in range(DIGITS - EXACT_TEN - 1, DIGITS + EXACT_TEN + 1)]
_SCALES = [float(f"1e{DIGITS - k}") for k in range(DIGITS - EXACT_TEN - 1, DIGITS + EXACT_TEN + 1)]
_UPS = [float(f"1e{k - DIGITS}") for k in range(DIGITS - EXACT_TEN - 1, DIGITS + EXACT_TEN + 1)]


def _one(
    y: float,
    operands: tuple[Floats, ...],
    ties: Callable[..., bool] | bool,
    cancels: bool,
    slack: Floats | None,
) -> float | None:
    """Do what `rounded` does for one number, without arrays; None if it is doubtful."""
    size = abs(y)
    if size == 0.0:
        return 0.0 if slack is None or slack.item() < _SURE else None
    decade = bisect_right(_ENDS, size)
    if not 0 < decade < len(_ENDS):
        return None
    scale = _SCALES[decade]
    s = size * scale
    whole = int(s + 0.5)
    if cancels and whole >= _LAST:
        return None
    near = NEAR if slack is None else NEAR + slack.item() * scale
    if not abs(s - int(s) - 0.5) > near:
        if ties is not True and not (ties and ties(*operands)):
            return None
        whole = int(s) + 1
    return math.copysign(whole / scale if scale >= 1.0 else whole * _UPS[decade], y)


def _restored(whole: Floats, scale: Floats, cell: Ints, work: Work) -> Floats:
    """Return the numbers of scaled mantissas; these and the scale are overwritten."""
    out = whole if work.out is None else work.out
    if scale.item(scale.argmin()) >= 1.0:
        return np.divide(whole, scale, out)
    np.multiply(whole, _looked_up(_UP, cell, work), whole)
    return np.divide(whole, _looked_up(_DOWN, cell, work), out)


def _looked_up(table: Floats, cell: Ints, work: Work) -> Floats:
    return table[cell] if work.scale is None else table.take(cell, None, work.scale, "clip")


def _flat(a: Floats, shape: tuple[int, ...]) -> Floats:
    if a.size == 1:
        return a.reshape(1)
    return (a if a.shape == shape else np.broadcast_to(a, shape)).ravel()


def _pick(a: Floats, at: NDArray[np.intp], shape: tuple[int, ...]) -> Floats:
    if a.size == 1:
        return np.full(at.size, a.item())
    return _flat(a, shape)[at]


def piecewise(function: Callable[..., Floats], *operands: Floats, piece: int = PIECE) -> Floats:
    """Return ``function(work, *operands)``, of large arrays piece by piece.

    Args:
        function: computes one piece, of at least one axis.
        operands: of any shapes that broadcast.
        piece: elements at a time.
    """
    first, last = operands[0], operands[-1]
    if first.size <= piece and last.size <= piece:
        if first.ndim or last.ndim:
            return function(_NEW, *operands)
        return function(_NEW, *(a.reshape(1) for a in operands)).reshape(())
    shape = np.broadcast_shapes(*(a.shape for a in operands))
    flat = [_flat(a, shape) for a in operands]
    out = np.empty(int(np.prod(shape)))
    y, scale, whole, cell = *np.empty((3, piece)), np.empty((2, piece), np.int64)
    for start in range(0, out.size, piece):
        to = out[start : start + piece]
        n = to.size
        work = Work(start, y[:n], cell[:, :n], scale[:n], whole[:n], to)
        result = function(work, *(a if a.size == 1 else a[start : start + n] for a in flat))
        if result is not to:
            to[:] = result
    return out.reshape(shape)

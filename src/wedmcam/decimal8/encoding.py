"""How arrays hold 8-digit decimals: each as the float64 nearest to it.

53 bits keep apart all decimals of up to 15 digits, so the float names its decimal, and whatever
needs no rounding (order, sign, choice, moving of elements, the way to float64) is numpy's own at
numpy's speed. Here are the two ways between such floats and mantissas with exponents, and the
powers of ten and exact products that they and the rounding are made of.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.number_format import DIGITS, EXPONENT_MAX, HIGH, ZERO, flag_underflow

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: 10^k for k from -TEN_MAX to TEN_MAX as the nearest float64.
TEN_MAX = 300
_TEN = np.array([float(f"1e{k}") for k in range(-TEN_MAX, TEN_MAX + 1)])
#: 10^22 is the last power of ten that float64 holds exactly.
EXACT_TEN = 22


def ten(k: NDArray[Any]) -> Floats:
    """Return the float64 nearest to 10^k; k from -300 to 300, clipped beyond."""
    return _TEN.take(k + TEN_MAX, mode="clip")


# --- decades --------------------------------------------------------------------------------
#
# The sign and the 11 bits of the exponent of a float64 are the index of a table of 4096 cells. A
# cell, [2^i, 2^(i+1)), holds one power of ten at most. _CARRY is what to add to the bits of a
# float so that those from that power on carry over into the next cell, which holds none and lies
# in the same decade. So two shifts, a look-up and an addition give a cell that knows the decade.

_CELL_BITS = np.array(52)
_UNSIGNED_CELL_BITS = np.array(52, np.uint64)
_INT64, _UINT64 = np.dtype(np.int64), np.dtype(np.uint64)
_LOWEST = np.ldexp(1.0, np.arange(2046) - 1023)
_DECADE = np.empty(2048, np.int64)
_DECADE[:2046] = np.searchsorted(_TEN, _LOWEST, side="right") - TEN_MAX
_DECADE[2046:] = TEN_MAX
_DECADE[0] = ZERO
_DECADE = np.concatenate((_DECADE, _DECADE))
_CARRY = np.zeros(2048, np.int64)
_BITS = _TEN.view(_INT64)
_CARRY[_BITS >> 52] = (1 << 52) - (_BITS & ((1 << 52) - 1))
_CARRY = np.concatenate((_CARRY, _CARRY))
#: By cell: what brings a number to 8 digits before the point; 1 for zero.
_TO_MANTISSA = np.where(_DECADE == ZERO, 1.0, ten(DIGITS - _DECADE))


def cells(values: Floats, spare: Ints | None = None) -> Ints:
    """Return an index by cell for each value; `decades` tells its decade.

    Args:
        values: numbers.
        spare: two rows to compute in, for large arrays. There the indices are from 0 to 4095,
            which `numpy.take` is quicker to look up; else from -2048 to 2047.
    """
    if spare is None:
        bits = values.view(_INT64)
        cell: Ints = _CARRY[np.right_shift(bits, _CELL_BITS)]
        np.add(cell, bits, cell)
        np.right_shift(cell, _CELL_BITS, cell)
        return cell
    bits, first, second = values.view(_UINT64), spare[0].view(_UINT64), spare[1].view(_UINT64)
    np.right_shift(bits, _UNSIGNED_CELL_BITS, first)
    _CARRY.take(spare[0], None, spare[1], "clip")
    np.add(second, bits, second)
    np.right_shift(second, _UNSIGNED_CELL_BITS, second)
    unsigned: Ints = spare[1]
    return unsigned


def decades(cell: Ints) -> Ints:
    """Return e with 10^(e-1) <= size < 10^e; `ZERO` for zero.

    Next to a power of ten that float64 does not hold exactly, either neighbour may be given: both
    round to the same 8 digits.
    """
    decade: Ints = _DECADE[cell]
    return decade


def parts(values: Floats) -> tuple[Ints, Ints]:
    """Return mantissas and exponents of held numbers; the exponent of zero is `ZERO`."""
    if not values.ndim:
        m, e = parts(values.reshape(1))
        return m.reshape(()), e.reshape(())
    cell = cells(values)
    return np.rint(values * _TO_MANTISSA[cell]).astype(np.int64), _DECADE[cell]


# --- exact products -------------------------------------------------------------------------


def split(a: Floats) -> tuple[Floats, Floats]:
    """Return a as the sum of two float64 of at most 26 bits each (Veltkamp).

    Products of such halves are exact. For |a| up to 1e292.
    """
    carried = a * 134217729.0  # 2^27 + 1
    high = carried - (carried - a)
    return high, a - high


def product(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return a * b as the sum of its float64 value and the exact rest (Dekker)."""
    p = a * b
    a1, a2 = split(a)
    b1, b2 = split(b)
    return p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2


@cache
def _pairs() -> tuple[Floats, Floats]:
    """Return 10^k for k from -120 to 120 as sums of two float64."""
    high = _TEN[TEN_MAX - 120 : TEN_MAX + 121]
    low = [
        float(Fraction(10) ** k - Fraction(h))
        for k, h in zip(range(-120, 121), high.tolist(), strict=True)
    ]
    return high, np.array(low)


def pair(m: NDArray[Any], e: NDArray[Any]) -> tuple[Floats, Floats]:
    """Return ``m * 10**(e - 8)`` as an unevaluated sum of two float64, good to 2^-100."""
    k = e.astype(np.int64) - DIGITS
    high, low = (table.take(k + 120, mode="clip") for table in _pairs())
    mantissa = m.astype(np.float64)
    p, rest = product(mantissa, high)
    rest += mantissa * low
    total = p + rest
    return total, rest - (total - p)


def beside(values: Floats) -> Ints:
    """Return the signs of what is left of floats when the numbers that they name are taken away."""
    m, e = parts(values)
    k = np.where(m == 0, 0, e) - DIGITS
    with np.errstate(all="ignore"):
        # value 10^-k - m, or value - m 10^k: each product in two exact parts.
        p, p_rest = product(values, ten(np.maximum(-k, 0)))
        t, t_rest = product(m.astype(np.float64), ten(np.maximum(k, 0)))
        signs = np.nan_to_num(np.sign((p - t) + (p_rest - t_rest))).astype(np.int64)
    for i in np.flatnonzero(np.abs(k) > EXACT_TEN):
        rest = Fraction(float(values[i])) - int(m[i]) * Fraction(10) ** int(k[i])
        signs[i] = (rest > 0) - (rest < 0)
    return signs


# --- from mantissas and exponents -------------------------------------------------------------


def floats(m: NDArray[Any], e: NDArray[Any]) -> Floats:
    """Return the float64 nearest to each ``m * 10**(e - 8)``, e from -100 to 100."""
    k = e.astype(np.int64) - DIGITS
    k[m == 0] = 0
    up, down = ten(np.maximum(k, 0)), ten(np.maximum(-k, 0))
    # Mantissa and power of ten are exact up to 10^22, so the one operation rounds once.
    out: Floats = m * up / down
    far = np.flatnonzero(np.abs(k) > EXACT_TEN)
    if far.size:
        high, low = pair(m[far], e[far])
        out[far] = high
        # The sum of the pair is wrong by 2^-100, which decides unless the rest is as near to half
        # a unit; below a power of two the spacing is half as large.
        size = np.abs(high)
        doubtful = np.abs(np.abs(low) - np.spacing(size) / 2) < size * 2.0**-95
        doubtful |= np.abs(np.abs(low) - np.spacing(size) / 4) < size * 2.0**-95
        for i in far[doubtful]:
            out[i] = float(f"{m[i]}e{k[i]}")
    return out


def checked(m: NDArray[Any], e: NDArray[Any], index: NDArray[Any] | None = None) -> Floats:
    """Return the float64 nearest to each rounded result, once its range is checked.

    Args:
        m: mantissas, 0 or of 8 digits, or 1e8 after rounding up.
        e: exponents.
        index: numbers of the elements, for the message.

    Raises:
        OverflowError: a result has an exponent above 99.
    """
    e = np.where(np.abs(m) == HIGH, e + 1, e)
    zero = m == 0
    over = np.flatnonzero((e > EXPONENT_MAX) & ~zero)
    if over.size:
        i = int(over[0])
        raise OverflowError(
            f"element {i if index is None else int(index[i])} has the exponent {int(e[i])}; "
            "8-digit numbers end at 10^99"
        )
    under = (e < -EXPONENT_MAX) & ~zero
    if under.any():
        flag_underflow(int(np.count_nonzero(under)))
        m = np.where(under, 0, m)
    # 1e8 with the exponent not raised is the same number as 1e7 with it raised.
    return floats(np.where(np.abs(m) == HIGH, m // 10, m), np.where(m == 0, 0, e))

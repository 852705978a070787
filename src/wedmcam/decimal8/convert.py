"""Whole arrays into and out of the format: float64, integers, BCD bytes.

Conversions round once, ties away from zero, and a float is taken at its exact value: 0.1 the
float is 0.1000000000000000055..., which rounds to 0.10000000.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.encoding import (
    EXACT_TEN,
    Floats,
    Ints,
    cells,
    checked,
    decades,
    floats,
    product,
    ten,
)
from wedmcam.decimal8.kernel import Parts, exact_integer
from wedmcam.decimal8.number_format import DIGITS, EXPONENT_MAX, LOW, flag_underflow, round_integer
from wedmcam.decimal8.rounding import Work, piecewise, rounded

_INTEGER_TENS = 10 ** np.arange(19, dtype=np.int64)
#: Integers below this are exact float64.
_EXACT_INTEGER = 2**53


def from_floats(values: Floats) -> Floats:
    """Return float64 values, each rounded once.

    Raises:
        OverflowError: a value is infinite or above the format's range.
        ValueError: a value is no number.
    """
    return piecewise(_from_floats, values)


def _from_floats(work: Work, values: Floats) -> Floats:
    out = rounded(work, values, (values,), _exact_floats, spare=work.y)
    # Numbers below 2^-1022 pass for zero.
    lost = int(np.count_nonzero(values)) - int(np.count_nonzero(out))
    if lost:
        flag_underflow(int(np.count_nonzero((values != 0) & (np.abs(values) < 2.0**-1022))))
    return out


def _exact_floats(values: Floats) -> Parts:
    """Return mantissas and exponents of values next to a tie, or of any outside 1e-14 to 1e30."""
    size = np.abs(values)
    if not size.max() < np.inf:
        if np.isnan(size).any():
            raise ValueError("a float that is no number")
        raise OverflowError("an infinite float")
    e = decades(cells(size))
    k = DIGITS - e
    up, down = ten(np.maximum(k, 0)), ten(np.maximum(-k, 0))
    with np.errstate(all="ignore"):
        n = np.floor(size * up / down)
        # size 10^k - (n + 1/2), or size - (n + 1/2) 10^-k, in two exact parts.
        p, p_rest = product(size, up)
        t, t_rest = product(n + 0.5, down)
        above = (p - t) + (p_rest - t_rest) >= 0
        m = np.copysign(n + above, values).astype(np.int64)
    # Elsewhere the powers of ten are no exact float64.
    for i in np.flatnonzero(np.abs(k) > EXACT_TEN):
        numerator, denominator = float(values[i]).as_integer_ratio()
        # A binary fraction n / 2^t is n 5^t / 10^t.
        places = denominator.bit_length() - 1
        m[i], e[i] = round_integer(numerator * 5**places, -places)
    return m, e


def from_integers(values: NDArray[np.int64]) -> Floats:
    """Return int64 values, each rounded once."""
    if not values.size or -_EXACT_INTEGER < values.min() <= values.max() < _EXACT_INTEGER:
        return from_floats(values.astype(np.float64))
    flat = values.reshape(-1)
    # The last two digits of so many do not matter, but whether there is anything behind a tie.
    large = np.abs(flat // 100) >= _EXACT_INTEGER // 100
    n = np.where(large, flat // 100 * 10 + (flat % 100 != 0), flat)
    return checked(*exact_integer(n, np.where(large, 1, 0))).reshape(values.shape)


def to_bcd(m: Ints, e: Ints) -> NDArray[np.uint8]:
    """Return the 6 bytes of each mantissa and exponent, as rows.

    Layout (ZD-065, 1983): sign of the number and sign of the exponent, half a byte each, 0 plus, 1
    minus; exponent; four bytes of significand; all packed BCD, most significant digit first.
    """
    out = np.zeros((m.size, 6), np.uint8)
    e = np.where(m == 0, 0, e)
    out[:, 0] = 16 * (m < 0) + (e < 0)
    out[:, 1] = _packed(np.abs(e))
    rest = np.abs(m).astype(np.int64)
    for column in (5, 4, 3, 2):
        rest, two = np.divmod(rest, 100)
        out[:, column] = _packed(two)
    return out


def _packed(two: NDArray[Any]) -> Any:
    return 16 * (two // 10) + two % 10


def from_bcd(rows: NDArray[np.uint8]) -> Floats:
    """Return the values of 6-byte rows; see `to_bcd`.

    Only what `to_bcd` writes is accepted, so reading and writing give the same bytes.

    Raises:
        ValueError: a half byte is no digit or sign, a significand does not begin with a digit
            from 1 to 9, or a zero is not all zeros.
    """
    halves = np.empty((len(rows), 12), np.int64)
    halves[:, 0::2], halves[:, 1::2] = rows >> 4, rows & 15
    m = halves[:, 4:] @ _INTEGER_TENS[:DIGITS][::-1]
    e = 10 * halves[:, 2] + halves[:, 3]
    bad = (halves[:, :2] > 1).any(axis=1) | (halves[:, 2:] > 9).any(axis=1)
    bad |= (m < LOW) & (halves != 0).any(axis=1)
    bad |= (halves[:, 1] == 1) & (e == 0)
    if bad.any():
        i = int(np.flatnonzero(bad)[0])
        raise ValueError(f"number {i}: {rows[i].tobytes().hex(' ')} is no 8-digit BCD float")
    assert EXPONENT_MAX == 99  # two BCD digits hold every exponent
    return floats(np.where(halves[:, 0] == 1, -m, m), np.where(halves[:, 1] == 1, -e, e))

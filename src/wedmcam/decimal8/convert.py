"""Whole arrays into and out of the format: float64, integers, BCD bytes.

Conversions round once, ties away from zero, and a float is taken at its exact value: 0.1 the
float is 0.1000000000000000055..., which rounds to 0.10000000.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.form import (
    DIGITS,
    EXPONENT_MAX,
    HIGH,
    LOW,
    ZERO,
    flag_underflow,
    round_integer,
)
from wedmcam.decimal8.kernel import PIECE, Exponents, Floats, Mantissas, Parts, in_range

#: 10^k for k from -TEN_MAX to TEN_MAX as the nearest float64, and what that leaves.
TEN_MAX = 300
_TEN = np.array([float(f"1e{k}") for k in range(-TEN_MAX, TEN_MAX + 1)])
_INTEGER_TENS = 10 ** np.arange(19, dtype=np.int64)
#: 10^22 is the last power of ten that float64 holds exactly.
EXACT_TEN = 22


def ten(k: NDArray[Any]) -> Floats:
    """Return the float64 nearest to 10^k; k from -300 to 300, clipped beyond."""
    return _TEN.take(k + TEN_MAX, mode="clip")


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


def decade(size: Floats) -> NDArray[np.int64]:
    """Return e with 10^(e-1) <= size < 10^e, for positive numbers.

    Next to a power of ten that float64 does not hold exactly, either neighbour may be given:
    both round to the same 8 digits.
    """
    e = np.floor(np.log10(size)).astype(np.int64) + 1
    e += size >= ten(e)
    e -= size < ten(e - 1)
    return e


def from_floats(values: Floats) -> Parts:
    """Return one-dimensional float64 values, each rounded once.

    Raises:
        OverflowError: a value is infinite or above the format's range.
        ValueError: a value is no number.
    """
    mantissas, exponents = np.empty(values.size, np.int32), np.empty(values.size, np.int16)
    for start in range(0, values.size, PIECE):
        piece = slice(start, start + PIECE)
        _from_floats(values[piece], mantissas[piece], exponents[piece])
        in_range(mantissas[piece], exponents[piece], start)
    return mantissas, exponents


def _from_floats(values: Floats, m: Mantissas, e: Exponents) -> None:
    size = np.abs(values)
    largest = size.max()
    if not largest < np.inf:
        if np.isnan(largest):
            raise ValueError("a float that is no number")
        raise OverflowError("an infinite float")
    zero = size < 1e-290  # far below the range; keeps every intermediate value a normal number
    lost = values[zero & (size > 0)].size
    size[zero] = 1.0
    places = decade(size)
    k = DIGITS - places
    # Powers of ten down to 10^-22 divide exactly, those up to 10^22 multiply exactly.
    up, down = ten(np.maximum(k, 0)), ten(np.maximum(-k, 0))
    scaled = size * up / down
    whole = np.floor(scaled)
    part = scaled - whole
    whole += part >= 0.5
    np.copyto(m, np.copysign(whole, values), casting="unsafe")
    np.copyto(e, places, casting="unsafe")
    # Three roundings are 5e-8 of a last digit, and the decade may have been a rounding off.
    for i in np.flatnonzero(np.abs(part - 0.5) < 1e-7):
        n, d = float(values[i]).as_integer_ratio()
        # A binary fraction n / 2^t is n 5^t / 10^t.
        t = d.bit_length() - 1
        m[i], e[i] = round_integer(n * 5**t, -t)
    if lost:
        flag_underflow(lost)
    m[zero] = 0
    e[zero] = ZERO


def from_integers(values: NDArray[np.int64]) -> Parts:
    """Return one-dimensional int64 values, each rounded once."""
    small = values.size == 0 or (values.max() < HIGH and values.min() > -HIGH)
    # The absolute value of -2^63 wraps to itself, which as uint64 is 2^63.
    size = np.abs(values).view(np.uint64)
    digits = np.searchsorted(_INTEGER_TENS.view(np.uint64), size, side="right")
    tens = _INTEGER_TENS.view(np.uint64)
    m = size * tens[np.maximum(DIGITS - digits, 0)]
    if not small:
        divisor = tens[np.maximum(digits - DIGITS, 0)]
        m = np.where(digits > DIGITS, (size + divisor // np.uint64(2)) // divisor, m)
    mantissas = m.astype(np.int32)
    np.negative(mantissas, out=mantissas, where=values < 0)
    exponents = digits.astype(np.int16)
    exponents[values == 0] = ZERO
    in_range(mantissas, exponents)
    return mantissas, exponents


def to_floats(m: Mantissas, e: Exponents) -> Floats:
    """Return the float64 nearest to each value."""
    k = e.astype(np.int64) - DIGITS
    k[m == 0] = 0
    if k.size == 0 or (k.min() >= -EXACT_TEN and k.max() <= EXACT_TEN):
        # Mantissa and power of ten are exact, so the one operation rounds once.
        return m * ten(np.maximum(k, 0)) / ten(np.maximum(-k, 0))
    out = m.astype(np.float64)
    near = np.abs(k) <= EXACT_TEN
    up, down = ten(np.maximum(k, 0)), ten(np.maximum(-k, 0))
    out[near] = (out * up / down)[near]
    far = np.flatnonzero(~near)
    high, low = pair(m[far], e[far])
    # The sum of the pair is wrong by 2^-100: it decides unless the rest is as near to half a unit.
    out[far] = high
    doubtful = np.abs(np.abs(low) - np.spacing(np.abs(high)) / 2) < np.abs(high) * 2.0**-95
    # Below a power of two the spacing is half as large.
    doubtful |= np.abs(np.abs(low) - np.spacing(np.abs(high)) / 4) < np.abs(high) * 2.0**-95
    for i in far[doubtful]:
        out[i] = float(f"{m[i]}e{k[i]}")
    return out


@cache
def _pairs() -> tuple[Floats, Floats]:
    """Return 10^k for k from -120 to 120 as sums of two float64."""
    high = _TEN[TEN_MAX - 120 : TEN_MAX + 121]
    low = [
        float(Fraction(10) ** k - Fraction(h))
        for k, h in zip(range(-120, 121), high.tolist(), strict=True)
    ]
    return high, np.array(low)


def pair(m: Mantissas, e: Exponents) -> tuple[Floats, Floats]:
    """Return each value as an unevaluated sum of two float64, good to 2^-100."""
    k = e.astype(np.int64) - DIGITS
    high, low = (table.take(k + 120, mode="clip") for table in _pairs())
    mantissa = m.astype(np.float64)
    p, rest = product(mantissa, high)
    rest += mantissa * low
    total = p + rest
    return total, rest - (total - p)


def to_bcd(m: Mantissas, e: Exponents) -> NDArray[np.uint8]:
    """Return the 6 bytes of each value, as rows.

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


def from_bcd(rows: NDArray[np.uint8]) -> Parts:
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
    mantissas = np.where(halves[:, 0] == 1, -m, m).astype(np.int32)
    exponents = np.where(m == 0, ZERO, np.where(halves[:, 1] == 1, -e, e)).astype(np.int16)
    return mantissas, exponents

"""``+ - * /`` and square root on arrays: a float64 operation, rounded; and the same in integers.

The integers decide where float64 is in doubt. They are plain int64: products below 1e16,
dividends below 1e16, aligned sums below 1e18.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.encoding import Floats, Ints, parts
from wedmcam.decimal8.number_format import DIGITS, ZERO
from wedmcam.decimal8.rounding import PIECE, Settle, Work, piecewise, rounded

_TENS = 10 ** np.arange(19, dtype=np.int64)
#: A number more than ten powers of ten below another changes the rounding of their sum by its
#: sign alone.
_FAR = 10

Parts = tuple[Ints, Ints]


# --- in float64 -----------------------------------------------------------------------------


def add(a: Floats, b: Floats) -> Floats:
    """Return a + b."""
    return piecewise(_add, a, b)


def subtract(a: Floats, b: Floats) -> Floats:
    """Return a - b."""
    return piecewise(_subtract, a, b)


def _add(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.add(a, b, work.y)
    return rounded(work, y, (a, b), _settle_sum, _alike, True, None, y)


def _subtract(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.subtract(a, b, work.y)
    return rounded(work, y, (a, b), _settle_difference, _alike, True, None, y)


def _alike(a: Floats, b: Floats) -> bool:
    """Whether a sum next to a tie is one, because no exponents differ by more than 5.

    Sums are whole multiples of 1e-6 of their last digit then. Where digits cancel, a sum has no
    more than 8 and is wrong by less than 0.3 of a last digit: no tie.
    """
    ratio = np.abs(a / b)  # beside zero no sum is near to a tie
    return bool(ratio.item(ratio.argmin()) >= 1e-5 and ratio.item(ratio.argmax()) <= 1e5)


def multiply(a: Floats, b: Floats) -> Floats:
    """Return a * b."""
    return piecewise(_multiply, a, b)


def multiply_short(a: Floats, b: Floats) -> Floats:
    """Return a * b, b numbers of at most 5 digits.

    The product is a whole multiple of 1e-5 of its last digit: that near to a tie it is one.
    """
    return piecewise(_multiply_short, a, b)


def _multiply(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.multiply(a, b, work.y)
    return rounded(work, y, (a, b), _settle_product, False, False, None, y)


def _multiply_short(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.multiply(a, b, work.y)
    return rounded(work, y, (a, b), _settle_product, True, False, None, y)


def divide(a: Floats, b: Floats) -> Floats:
    """Return a / b.

    Raises:
        ZeroDivisionError: a divisor is 0.
    """
    return _divided(_divide, a, b)


def divide_short(a: Floats, b: Floats) -> Floats:
    """Return a / b, b numbers of at most 5 digits.

    The quotient is away from a tie by 5e-6 of its last digit, or is one.
    """
    return _divided(_divide_short, a, b)


def _divided(function: Callable[..., Floats], a: Floats, b: Floats) -> Floats:
    if b.size > PIECE:
        # Quotients by zero are no numbers, so they are settled, which finds them.
        with np.errstate(divide="ignore", invalid="ignore"):
            return piecewise(function, a, b)
    if np.count_nonzero(b) != b.size:
        raise ZeroDivisionError("division by zero")
    return piecewise(function, a, b)


def _divide(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.divide(a, b, work.y)
    return rounded(work, y, (a, b), _settle_quotient, False, False, None, y)


def _divide_short(work: Work, a: Floats, b: Floats) -> Floats:
    y = np.divide(a, b, work.y)
    return rounded(work, y, (a, b), _settle_quotient, True, False, None, y)


def square_root(a: Floats) -> Floats:
    """Return the square root of a.

    Raises:
        ValueError: a number is negative.
    """
    if a.size and a.item(a.argmin()) < 0:
        raise ValueError("square root of a negative number")
    return piecewise(_square_root, a)


def _square_root(work: Work, a: Floats) -> Floats:
    y = np.sqrt(a, work.y)
    return rounded(work, y, (a,), _settle_root, False, False, None, y)


# --- in integers ----------------------------------------------------------------------------


def _half_away(dividend: Ints, divisor: NDArray[np.int64]) -> Ints:
    """Return dividend / divisor > 0 in integers, ties away from zero."""
    quotient: Ints = np.sign(dividend) * ((np.abs(dividend) + divisor // 2) // divisor)
    return quotient


def exact_integer(n: Ints, power: NDArray[np.int64]) -> Parts:
    """Return mantissas and exponents of ``n * 10**power``, |n| < 2^63; 1e8 is left as it is."""
    digits = np.searchsorted(_TENS, np.abs(n), side="right")
    lost = digits - DIGITS
    m = np.where(
        lost > 0, _half_away(n, _TENS[np.maximum(lost, 0)]), n * _TENS[np.maximum(-lost, 0)]
    )
    return m, np.where(n == 0, ZERO, digits + power)


def exact_sum(am: Ints, ae: Ints, bm: Ints, be: Ints) -> Parts:
    """Return a + b."""
    swap = ae < be
    hm, he = np.where(swap, bm, am), np.where(swap, be, ae)
    lm, le = np.where(swap, am, bm), np.where(swap, ae, be)
    apart = np.minimum(he - le, _FAR)
    low = np.where(he - le > _FAR, np.sign(lm), lm)
    return exact_integer(hm * _TENS[apart] + low, he - DIGITS - apart)


def exact_difference(am: Ints, ae: Ints, bm: Ints, be: Ints) -> Parts:
    """Return a - b."""
    return exact_sum(am, ae, -bm, be)


def exact_product(am: Ints, ae: Ints, bm: Ints, be: Ints) -> Parts:
    """Return a * b."""
    return exact_integer(am * bm, ae + be - 2 * DIGITS)


def exact_quotient(am: Ints, ae: Ints, bm: Ints, be: Ints) -> Parts:
    """Return a / b.

    Raises:
        ZeroDivisionError: a divisor is 0.
    """
    if not bm.all():
        raise ZeroDivisionError("division by zero")
    whole = np.abs(am) >= np.abs(bm)
    dividend = am * np.sign(bm) * _TENS[DIGITS - whole]
    return _half_away(dividend, np.abs(bm)), np.where(am == 0, ZERO, ae - be + whole)


def exact_root(am: Ints, ae: Ints) -> Parts:
    """Return the square root of a."""
    odd = ae & 1
    square = am * _TENS[DIGITS - odd]
    r = np.sqrt(square.astype(np.float64)).astype(np.int64)
    r -= r * r > square
    # (r + 1/2)^2 = r^2 + r + 1/4 is no integer, so there are no ties.
    return r + (square > r * r + r), np.where(am == 0, ZERO, (ae + odd) >> 1)


def settle(exact: Callable[..., Parts]) -> Settle:
    """Return what settles elements by a function of mantissas and exponents."""

    def settle_elements(*operands: Floats) -> Parts:
        return exact(*(part for a in operands for part in parts(a)))

    return settle_elements


_settle_sum, _settle_difference = settle(exact_sum), settle(exact_difference)
_settle_product, _settle_quotient = settle(exact_product), settle(exact_quotient)
_settle_root = settle(exact_root)

"""Decides the roundings that float64 cannot: with as many digits as it takes.

About one result in ten million of a sine lies so near to the middle between two 8-digit numbers
that its float64 value does not say which is nearer. Those, and only those, are computed here, one
by one, with mpmath, at growing precision until the digits decide. A value that lies in the middle
exactly would never be decided: for sines and the like of 8-digit numbers there is none (they are
irrational but for multiples of 30 and 45 degrees, which are no ties), and for powers and
hypotenuses it is recognised in integers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

from wedmcam.decimal8.number_format import DIGITS, HIGH, LOW, ZERO, round_integer

#: An expression at a given mpmath context, whose precision the caller has set.
Evaluate = Callable[[Any], Any]

#: Working precisions, in digits. The last is beyond what two 8-digit numbers 199 powers of ten
#: apart can need; reaching it means an unforeseen tie.
PRECISIONS = (30, 60, 120, 240, 480, 960)
#: Digits that cancellation may cost, apart from those of a large exponent: an 8-digit number comes
#: no nearer to a multiple of pi/2 than about 1e-11 of its last digit.
GUARD = 40


@cache
def _context() -> Any:
    return import_module("mpmath").mp.clone()  # slow to load and rarely needed


def number(ctx: Any, m: int, e: int) -> Any:
    """Return ``m * 10**(e - 8)`` at the precision of the mpmath context."""
    k = e - DIGITS
    return ctx.mpf(m * 10**k) if k >= 0 else ctx.mpf(m) / 10**-k


def decide(
    evaluate: Evaluate,
    magnitude: int = 0,
    tie: Callable[[int, int], bool] | None = None,
) -> tuple[int, int]:
    """Return the value of an expression as mantissa and exponent, correctly rounded.

    Args:
        evaluate: computes the value at the precision of the context that it is given.
        magnitude: digits before the point that a reduction of the operand loses.
        tie: asked with (n, power) when the value cannot be told from ``n * 10**power``, an odd
            multiple of half a last digit: whether it is exactly that.

    Returns:
        Mantissa and exponent; the range is not checked.
    """
    ctx = _context()
    for digits in PRECISIONS:
        ctx.dps = digits + magnitude + GUARD
        value = evaluate(ctx)
        if value == 0:
            return 0, ZERO
        size = abs(value)
        # floor(log10) may be one off next to a power of ten: then the next line corrects it.
        e = int(ctx.floor(ctx.log10(size))) + 1
        scaled = size * ctx.mpf(10) ** (DIGITS - e)
        if scaled >= HIGH:
            e, scaled = e + 1, scaled / 10
        elif scaled < LOW:
            e, scaled = e - 1, scaled * 10
        whole = int(ctx.floor(scaled))
        from_middle = scaled - whole - ctx.mpf(1) / 2
        sign = 1 if value > 0 else -1
        if abs(from_middle) > ctx.mpf(10) ** (DIGITS - digits):
            return round_integer(sign * (whole + (from_middle > 0)), e - DIGITS)
        if tie is not None and tie(sign * (10 * whole + 5), e - DIGITS - 1):
            return round_integer(sign * (10 * whole + 5), e - DIGITS - 1)
    raise AssertionError("a tie among irrational numbers")


def hypotenuse(am: int, ae: int, bm: int, be: int) -> tuple[int, int]:
    """Return sqrt(a^2 + b^2), correctly rounded, in integers alone.

    >>> hypotenuse(60000003, 8, 80000004, 8)  # 100000005, a tie
    (10000001, 9)
    """
    low = min(ae, be)
    square = (am * 10 ** (ae - low)) ** 2 + (bm * 10 ** (be - low)) ** 2
    # The root in units 10^9 times finer than the operands: at least 16 digits, so an inexact last
    # one, marked by a further digit 1, decides every rounding.
    root = math.isqrt(square * 10**18)
    inexact = root * root != square * 10**18
    return round_integer(10 * root + inexact, low - DIGITS - 10)


def power(xm: int, xe: int, ym: int, ye: int) -> tuple[int, int]:
    """Return x ** y for x > 0, correctly rounded; the range is not checked.

    Ties exist (1.0001 ** 2.5 has exact digits, and some powers end in a 5 at the ninth), but only
    for roots and powers small enough to verify in integers: a 9-digit n-th power of an integer
    that is no power of ten has n <= 30, and an n-th root of m * 10^k needs n <= 400.
    """
    k = ye - DIGITS
    p, q = (ym * 10**k, 1) if k >= 0 else (ym, 10**-k)
    shared = math.gcd(p, q)
    p, q = p // shared, q // shared

    def tie(n: int, tenth: int) -> bool:
        """Whether x ** (p/q) is n * 10**tenth: whether x ** p is (n * 10**tenth) ** q."""
        if max(abs(p), q) > 400:
            return False
        left, left_power = xm ** abs(p), (xe - DIGITS) * abs(p)
        right, right_power = n**q, tenth * q
        if p < 0:  # 1 / left == right
            return _equal(1, 0, left * right, left_power + right_power)
        return _equal(left, left_power, right, right_power)

    return decide(lambda ctx: number(ctx, xm, xe) ** (ctx.mpf(p) / q), max(0, ye), tie)


def _equal(a: int, ka: int, b: int, kb: int) -> bool:
    low = min(ka, kb)
    left: int = a * 10 ** (ka - low)
    right: int = b * 10 ** (kb - low)
    return left == right

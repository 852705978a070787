"""Sines, their inverses, powers and hypotenuses on arrays, each correctly rounded to 8 digits.

Every function is computed in float64 first, with a bound of its error, and rounded. Where the
error reaches over the middle between two 8-digit numbers, a finer float64 formula is asked if there
is one, and what is still open (about one in ten million) goes to `exact`.

The bounds assume that numpy's float64 functions are good to `LIBRARY`: 4 units in the last place,
which is what numpy promises of its vectorised functions; most are better than 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8 import exact
from wedmcam.decimal8.convert import decade, pair, product, ten
from wedmcam.decimal8.form import DIGITS, HIGH, LOW, ZERO
from wedmcam.decimal8.kernel import Exponents, Floats, Mantissas, Parts, in_range

#: Relative error of one float64 operation, and of one numpy function.
UNIT = 2.0**-53
LIBRARY = 8 * UNIT
#: Elements computed at a time; the formulas below use more temporaries than the kernel's.
PIECE = 8192
#: Radians of 1e19 and more are no exact float64, and are reduced with mpmath.
_LARGEST_EXPONENT = 11 + DIGITS

#: Value and bound of its relative error.
Approximation = tuple[Floats, Floats | float]
Operand = tuple[Mantissas, Exponents]


@dataclass(frozen=True, slots=True)
class Function:
    """One function: how it is approximated, and how it is decided.

    Attributes:
        name: for messages.
        approximations: from coarse to fine; each takes mantissas and exponents of the operands.
        decide: mantissa and exponent of the result, from one element's integers.
    """

    name: str
    approximations: tuple[Callable[..., Approximation], ...]
    decide: Callable[..., tuple[int, int]]

    def __call__(self, *operands: Parts) -> Parts:
        """Return the function of one-dimensional operands, of one length or of length 1."""
        n = 1
        for m, _ in operands:
            n = n if m.size == 1 else m.size
        mantissas, exponents = np.empty(n, np.int32), np.empty(n, np.int16)
        for start in range(0, n, PIECE):
            stop = min(start + PIECE, n)
            arguments: list[NDArray[Any]] = []
            for operand in operands:
                for part in operand:
                    whole = np.broadcast_to(part, n) if part.size == 1 else part
                    arguments.append(whole[start:stop])
            m, e = self._piece(arguments)
            in_range(m, e, start)
            mantissas[start:stop], exponents[start:stop] = m, e
        return mantissas, exponents

    def _piece(self, arguments: list[NDArray[Any]]) -> tuple[Mantissas, NDArray[np.int64]]:
        with np.errstate(all="ignore"):
            m, e, hard = rounded(*self.approximations[0](*arguments))
            for finer in self.approximations[1:]:
                if hard.size == 0:
                    break
                few, places, open_ = rounded(*finer(*(a[hard] for a in arguments)))
                m[hard], e[hard] = few, places
                hard = hard[open_]
        for i in hard:
            m[i], e[i] = self.decide(*(int(a[i]) for a in arguments))
        return m, e


def rounded(
    value: Floats, error: Floats | float
) -> tuple[Mantissas, NDArray[np.int64], NDArray[np.intp]]:
    """Round float64 values to 8 digits; also return the indices that their error leaves open."""
    size = np.abs(value)
    zero = size == 0
    size[zero] = 1.0
    e = decade(size)
    scaled = size * ten(DIGITS - e)
    whole = np.floor(scaled)
    part = scaled - whole
    part -= 0.5
    m = np.copysign(whole + (part >= 0), value).astype(np.int32)
    m[zero] = 0
    e[zero] = ZERO
    # The power of ten and the product by it add two roundings.
    close = np.abs(part) <= scaled * (error + 3 * UNIT)
    close &= ~zero
    return m, e, np.flatnonzero(close)


def plain(m: Mantissas, e: Exponents) -> Floats:
    """Return the values as float64, wrong by two roundings at most."""
    k = np.where(m == 0, 0, e) - np.int64(DIGITS)
    return m * ten(k)


# --- radians --------------------------------------------------------------------------------
#
# The operand has 8 digits and is no float64: rounding it moves it by up to 2 UNIT |x|, which
# moves the result by so much times the derivative. The fine formulas take the operand as the sum
# of two float64, x + r, and add r times the derivative.


def _remainder(m: Mantissas, e: Exponents) -> tuple[Floats, Floats]:
    """Return float64 x and r whose sum is the operand, |r| <= UNIT |x|; r is NaN if unknown."""
    k = e.astype(np.int64) - DIGITS
    down = ten(np.clip(-k, 0, 22))
    x = m * ten(np.clip(k, 0, 11)) / down
    high, low = product(x, down)
    r = np.where(k < 0, ((m - high) - low) / down, 0.0)
    # Powers below 10^-22 are no exact float64; such operands never need this.
    usable = (k >= -22) & (k <= 11)
    return x, np.where(usable, r, np.nan)


def _coarse(value: Floats, x: Floats, slope: Floats) -> Approximation:
    return value, LIBRARY + 2 * UNIT * np.abs(x * slope / value)


def _fine(value: Floats, slope: Floats, curve: Floats, r: Floats) -> Approximation:
    """Taylor: the next term is below curve r^2, the one after below (1 + curve^2) |r|^3."""
    y = value + slope * r
    error = LIBRARY * np.abs(value) + 2 * LIBRARY * np.abs(slope * r)
    error += np.abs(curve) * r * r + (1 + curve * curve) * np.abs(r) ** 3
    relative = error / np.abs(y) + UNIT
    known = np.isfinite(relative)
    return np.where(known, y, 1.0), np.where(known, relative, 1.0)


def _sin(m: Mantissas, e: Exponents) -> Approximation:
    x = plain(m, e)
    y = np.sin(x)
    value, error = _coarse(y, x, np.ones_like(x))
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _sin_fine(m: Mantissas, e: Exponents) -> Approximation:
    x, r = _remainder(m, e)
    y = np.sin(x)
    return _fine(y, np.cos(x), y, r)


def _cos(m: Mantissas, e: Exponents) -> Approximation:
    x = plain(m, e)
    value, error = _coarse(np.cos(x), x, np.minimum(np.abs(x), 1.0))
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _cos_fine(m: Mantissas, e: Exponents) -> Approximation:
    x, r = _remainder(m, e)
    y = np.cos(x)
    return _fine(y, -np.sin(x), y, r)


def _tan(m: Mantissas, e: Exponents) -> Approximation:
    x = plain(m, e)
    y = np.tan(x)
    value, error = _coarse(y, x, 1 + y * y)
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _tan_fine(m: Mantissas, e: Exponents) -> Approximation:
    x, r = _remainder(m, e)
    y = np.tan(x)
    slope = 1 + y * y
    # tan'' = 2 tan (1 + tan^2); the third derivative is below 6 (1 + tan^2)^2 <= 6 (1 + curve^2).
    value, error = _fine(y, slope, 2 * np.abs(y) * slope + slope, r)
    return value, 2 * error


def _trigonometric(name: str) -> Callable[[int, int], tuple[int, int]]:
    def decided(m: int, e: int) -> tuple[int, int]:
        return exact.decide(lambda ctx: getattr(ctx, name)(exact.number(ctx, m, e)), 2 * max(e, 0))

    return decided


sin = Function("sin", (_sin, _sin_fine), _trigonometric("sin"))
cos = Function("cos", (_cos, _cos_fine), _trigonometric("cos"))
tan = Function("tan", (_tan, _tan_fine), _trigonometric("tan"))


# --- degrees --------------------------------------------------------------------------------

_DEGREE = np.pi / 180
#: 10^k modulo 360 is 280 from k = 3 on.
_TURN_TENS = np.array([1.0, 10.0, 100.0, 280.0])


def _quarters(m: Mantissas, e: Exponents) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Reduce degrees exactly: n / p degrees within a half of a right angle, and right angles.

    Integers in float64 throughout: with k powers of ten before the point m 10^k is taken modulo
    360, with k behind it the unit is 10^-k degrees. Beyond 7 places nothing needs reduction.
    """
    k = np.where(m == 0, 0, e) - np.int64(DIGITS)
    n = np.where(k >= 0, m * _TURN_TENS.take(k, mode="clip"), m)
    p = ten(np.maximum(-k, 0))
    quarter = 90.0 * p
    turns = np.rint(n / quarter)
    return n - turns * quarter, p, turns.astype(np.int64) & 3


def _wave(m: Mantissas, e: Exponents, ahead: int) -> Approximation:
    n, p, quadrant = _quarters(m, e)
    quadrant = (quadrant + ahead) & 3
    # sin, cos, -sin, -cos of the rest; cos of t is the sine of 90 - |t|.
    n = np.where(quadrant & 1, 90.0 * p - np.abs(n), n)
    y = np.sin(n * _DEGREE / p)
    # The angle is wrong by four roundings, the sine relatively by no more.
    return np.where(quadrant & 2, -y, y), LIBRARY + 5 * UNIT


def _sin_degrees(m: Mantissas, e: Exponents) -> Approximation:
    return _wave(m, e, 0)


def _cos_degrees(m: Mantissas, e: Exponents) -> Approximation:
    return _wave(m, e, 1)


def _tan_degrees(m: Mantissas, e: Exponents) -> Approximation:
    n, p, quadrant = _quarters(m, e)
    odd = (quadrant & 1) == 1
    if (odd & (n == 0)).any():
        raise ValueError("tangent of an odd multiple of 90 degrees")
    y = np.tan(n * _DEGREE / p)
    # Up to 45 degrees the condition x tan'(x) / tan(x) is below pi/2.
    return np.where(odd, -1 / y, y), LIBRARY + 9 * UNIT


def _in_degrees(name: str) -> Callable[[int, int], tuple[int, int]]:
    def decided(m: int, e: int) -> tuple[int, int]:
        k = e - DIGITS
        n, p = (m * 10**k % 360, 1) if k >= 0 else (m, 10**-k)
        return exact.decide(lambda ctx: getattr(ctx, name)(ctx.pi * n / (180 * p)))

    return decided


sin_degrees = Function("sin", (_sin_degrees,), _in_degrees("sin"))
cos_degrees = Function("cos", (_cos_degrees,), _in_degrees("cos"))
tan_degrees = Function("tan", (_tan_degrees,), _in_degrees("tan"))


# --- inverses -------------------------------------------------------------------------------
#
# All through the arc tangent of two numbers, because that is well conditioned everywhere: a
# relative error of an operand moves the result relatively by no more.


def _angle(y: Floats, x: Floats, unit: float) -> Approximation:
    return np.arctan2(y, x) * unit, LIBRARY + 12 * UNIT


def _leg(m: Mantissas, e: Exponents) -> Floats:
    """Return sqrt(1 - x^2) with a relative error of a few UNIT, also for |x| next to 1."""
    if ((np.abs(m) > LOW) & (e == 1) | (e > 1)).any():
        raise ValueError("arc sine or arc cosine of a number beyond 1")
    # In units of 1e-8: exact where x >= 0.1, and there alone 1 - |x| could lose digits.
    x = np.abs(m) * ten(np.where(m == 0, 0, e).astype(np.int64))
    return np.asarray(np.sqrt((1e8 - x) * (1e8 + x)) * 1e-8)


def _inverse(
    name: str, approximate: Callable[[Mantissas, Exponents, float], Approximation]
) -> tuple[Function, Function]:
    """Return the function in radians and in degrees."""

    def make(unit: float, degrees: bool) -> Function:
        def decided(m: int, e: int) -> tuple[int, int]:
            def evaluate(ctx: Any) -> Any:
                angle = getattr(ctx, name)(exact.number(ctx, m, e))
                return angle * 180 / ctx.pi if degrees else angle

            return exact.decide(evaluate)

        return Function(name, (lambda m, e: approximate(m, e, unit),), decided)

    return make(1.0, False), make(1 / _DEGREE, True)


asin, asin_degrees = _inverse("asin", lambda m, e, unit: _angle(plain(m, e), _leg(m, e), unit))
acos, acos_degrees = _inverse("acos", lambda m, e, unit: _angle(_leg(m, e), plain(m, e), unit))
atan, atan_degrees = _inverse(
    "atan", lambda m, e, unit: (np.arctan(plain(m, e)) * unit, LIBRARY + 8 * UNIT)
)


def _atan2(unit: float, degrees: bool) -> Function:
    def approximate(ym: Mantissas, ye: Exponents, xm: Mantissas, xe: Exponents) -> Approximation:
        return _angle(plain(ym, ye), plain(xm, xe), unit)

    def decided(ym: int, ye: int, xm: int, xe: int) -> tuple[int, int]:
        def evaluate(ctx: Any) -> Any:
            angle = ctx.atan2(exact.number(ctx, ym, ye), exact.number(ctx, xm, xe))
            return angle * 180 / ctx.pi if degrees else angle

        return exact.decide(evaluate)

    return Function("atan2", (approximate,), decided)


atan2, atan2_degrees = _atan2(1.0, False), _atan2(1 / _DEGREE, True)


def _scaled_angle(factor: float, degrees: bool) -> Function:
    def approximate(m: Mantissas, e: Exponents) -> Approximation:
        return plain(m, e) * factor, 6 * UNIT

    def decided(m: int, e: int) -> tuple[int, int]:
        def evaluate(ctx: Any) -> Any:
            x = exact.number(ctx, m, e)
            return x * 180 / ctx.pi if degrees else x * ctx.pi / 180

        return exact.decide(evaluate)

    return Function("degrees" if degrees else "radians", (approximate,), decided)


to_radians, to_degrees = _scaled_angle(_DEGREE, False), _scaled_angle(1 / _DEGREE, True)


# --- hypotenuse and power -------------------------------------------------------------------


def _hypot(am: Mantissas, ae: Exponents, bm: Mantissas, be: Exponents) -> Approximation:
    a, b = plain(am, ae), plain(bm, be)
    return np.sqrt(a * a + b * b), 8 * UNIT


def _decide_hypot(am: int, ae: int, bm: int, be: int) -> tuple[int, int]:
    if am == 0 or bm == 0:
        return (abs(am), ae) if bm == 0 else (abs(bm), be)
    return exact.hypotenuse(am, ae, bm, be)


hypot = Function("hypot", (_hypot,), _decide_hypot)


def _power(xm: Mantissas, xe: Exponents, ym: Mantissas, ye: Exponents) -> Approximation:
    """Compute |x| ** y with the sign of an odd power; both operands as pairs of float64."""
    k = np.where(ym == 0, 0, ye) - np.int64(DIGITS)
    unit = 10 ** np.clip(-k, 0, DIGITS)  # beyond 8 places no 8-digit number is an integer
    whole = (k >= 0) | (ym % unit == 0)
    odd = whole & (k <= 0) & ((ym // unit) % 2 == 1)
    if ((xm < 0) & ~whole).any():
        raise ValueError("a fractional power of a negative number")
    if ((xm == 0) & (ym < 0)).any():
        raise ZeroDivisionError("zero to a negative power")
    one = np.where(xm == 0, LOW, np.abs(xm)).astype(np.int32)
    x, rx = pair(one, np.where(xm == 0, 1, xe))
    y, ry = pair(ym, np.where(ym == 0, 1, ye))
    log = np.log(x)
    # What is beyond the range of the format by far need not be known any better.
    tens = y * log / np.log(10.0)
    settled = np.abs(tens) > 150
    shift = np.where(settled, 0.0, y * (rx / x) + ry * log)
    value = np.power(x, np.where(settled, np.sign(tens) * 150 / np.log10(x), y)) * (1 + shift)
    error = LIBRARY + np.abs(shift) * LIBRARY + shift * shift
    error = np.where(settled, 0.0, np.where(np.isfinite(value), error, 1.0))
    value = np.where(odd & (xm < 0), -value, value)
    value = np.where((xm == 0) & (ym != 0), 0.0, value)
    return value, error


def _decide_power(xm: int, xe: int, ym: int, ye: int) -> tuple[int, int]:
    if ym == 0:
        return LOW, 1
    m, e = exact.power(abs(xm), xe, ym, ye)
    k = ye - DIGITS
    odd = k <= 0 and k >= -DIGITS and ym // 10**-k % 2 == 1
    return (-m if xm < 0 and odd else m), e


power = Function("power", (_power,), _decide_power)


# --- to integers ----------------------------------------------------------------------------


def _whole(m: Mantissas, e: Exponents, how: str) -> Parts:
    """Round to an integer: 'away' (ties away from zero), 'floor', 'ceil' or 'trunc'."""
    k = e.astype(np.int64) - DIGITS
    fraction = k < 0
    # Exact for up to 8 places; beyond, the quotient is only known to be below 0.1.
    q = m / ten(np.clip(-k, 0, 9))
    if how == "away":
        q = np.trunc(q + q) - np.trunc(q)
    else:
        q = {"floor": np.floor, "ceil": np.ceil, "trunc": np.trunc}[how](q)
    size = np.abs(q)
    digits = np.where(size == 0, ZERO, decade(np.maximum(size, 1.0)))
    whole = (q * ten(np.clip(DIGITS - digits, 0, DIGITS))).astype(np.int32)
    # 99999999.5 is no 8-digit number, so rounding never gives 1e8.
    assert not whole.size or np.abs(whole).max() < HIGH
    out_m = np.where(fraction, whole, m).astype(np.int32)
    out_e = np.where(fraction, digits, e).astype(np.int16)
    return out_m, out_e


def whole(a: Parts, how: str) -> Parts:
    """Return a rounded to integers: 'away' (ties away from zero), 'floor', 'ceil' or 'trunc'."""
    return _whole(a[0], a[1], how)

"""Sines, their inverses, powers and hypotenuses on arrays, each correctly rounded to 8 digits.

Every function is computed in float64 of the floats that name its operands, and rounded. Such a
float is not its operand: it is off by up to half of its last bit, which moves the result by so
much times the derivative. Where that could matter (a large angle, a sine next to 0) or the result
lies next to a tie, finer formulas take over, which know the digits of the operand; and what they
leave open (about one in ten million) goes to `exact`.

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
from wedmcam.decimal8.encoding import (
    Floats,
    Ints,
    cells,
    checked,
    decades,
    pair,
    parts,
    product,
    ten,
)
from wedmcam.decimal8.kernel import Parts
from wedmcam.decimal8.number_format import DIGITS, LOW, ZERO
from wedmcam.decimal8.rounding import Work, piecewise, rounded

#: Relative error of one float64 operation, and of one numpy function.
UNIT = 2.0**-53
LIBRARY = 8 * UNIT
#: Elements computed at a time; the formulas below use more temporaries than the kernel's.
PIECE = 16384
#: Radians of 1e19 and more are no exact float64, and are reduced with mpmath.
_LARGEST_EXPONENT = 11 + DIGITS

#: Value and bound of its relative error.
Approximation = tuple[Floats, Floats | float]
#: Value, and what the error of the floats that name the operands may add to its own.
Front = tuple[Floats, Floats | None]


@dataclass(frozen=True, slots=True)
class Function:
    """One function: how it is computed, approximated, and decided.

    Attributes:
        name: for messages.
        approximations: from coarse to fine; each takes mantissas and exponents of the operands.
        decide: mantissa and exponent of the result, from one element's integers.
        front: the function of the floats that name the operands, wrong by less than 14 `UNIT` and
            the slack. Without it every element is approximated.
    """

    name: str
    approximations: tuple[Callable[..., Approximation], ...]
    decide: Callable[..., tuple[int, int]]
    front: Callable[..., Front] | None = None

    def __call__(self, *operands: Floats) -> Floats:
        """Return the function of operands that broadcast."""
        return piecewise(self._piece, *operands, piece=PIECE)

    def _piece(self, work: Work, *operands: Floats) -> Floats:
        if self.front is None:
            all_ = [a.reshape(-1) for a in np.broadcast_arrays(*operands)]
            settled = self.settle(*all_)
            out = checked(*settled, np.arange(work.start, work.start + all_[0].size))
            return out.reshape(np.broadcast_shapes(*(a.shape for a in operands)))
        y, slack = self.front(*operands)
        return rounded(work, y, operands, self.settle, slack=slack, spare=y)

    def settle(self, *operands: Floats) -> Parts:
        """Return mantissas and exponents, rounded, of the function of some elements."""
        arguments = [part for a in operands for part in parts(a)]
        with np.errstate(all="ignore"):
            m, e, hard = digits(*self.approximations[0](*arguments))
            for finer in self.approximations[1:]:
                if hard.size == 0:
                    break
                few, places, open_ = digits(*finer(*(a[hard] for a in arguments)))
                m[hard], e[hard] = few, places
                hard = hard[open_]
        for i in hard:
            m[i], e[i] = self.decide(*(int(a[i]) for a in arguments))
        return m, e


def digits(value: Floats, error: Floats | float) -> tuple[Ints, Ints, NDArray[np.intp]]:
    """Round float64 values to 8 digits; also return the indices that their error leaves open."""
    size = np.abs(value)
    zero = size == 0
    size[zero] = 1.0
    e = decades(cells(size))
    scaled = size * ten(DIGITS - e)
    whole = np.floor(scaled)
    part = scaled - whole
    part -= 0.5
    m = np.copysign(whole + (part >= 0), value).astype(np.int64)
    m[zero] = 0
    e[zero] = ZERO
    # The power of ten and the product by it add two roundings.
    close = np.abs(part) <= scaled * (error + 3 * UNIT)
    close &= ~zero
    return m, e, np.flatnonzero(close)


def plain(m: Ints, e: Ints) -> Floats:
    """Return the values as float64, wrong by two roundings at most."""
    k = np.where(m == 0, 0, e) - np.int64(DIGITS)
    return m * ten(k)


def _turning(v: Floats) -> Floats:
    """Return how far the float64 next to an angle moves a function of slope 1."""
    return np.abs(v) * UNIT


# --- radians --------------------------------------------------------------------------------
#
# The operand has 8 digits and is no float64: rounding it moves it by up to 2 UNIT |x|, which
# moves the result by so much times the derivative. The fine formulas take the operand as the sum
# of two float64, x + r, and add r times the derivative.


def _remainder(m: Ints, e: Ints) -> tuple[Floats, Floats]:
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


def _sin(m: Ints, e: Ints) -> Approximation:
    x = plain(m, e)
    y = np.sin(x)
    value, error = _coarse(y, x, np.ones_like(x))
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _sin_fine(m: Ints, e: Ints) -> Approximation:
    x, r = _remainder(m, e)
    y = np.sin(x)
    return _fine(y, np.cos(x), y, r)


def _cos(m: Ints, e: Ints) -> Approximation:
    x = plain(m, e)
    value, error = _coarse(np.cos(x), x, np.minimum(np.abs(x), 1.0))
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _cos_fine(m: Ints, e: Ints) -> Approximation:
    x, r = _remainder(m, e)
    y = np.cos(x)
    return _fine(y, -np.sin(x), y, r)


def _tan(m: Ints, e: Ints) -> Approximation:
    x = plain(m, e)
    y = np.tan(x)
    value, error = _coarse(y, x, 1 + y * y)
    return value, np.where(e <= _LARGEST_EXPONENT, error, 1.0)


def _tan_fine(m: Ints, e: Ints) -> Approximation:
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


def _front_sin(v: Floats) -> Front:
    return np.sin(v), _turning(v)


def _front_cos(v: Floats) -> Front:
    return np.cos(v), _turning(v)


def _front_tan(v: Floats) -> Front:
    y = np.tan(v)
    return y, (1 + y * y) * _turning(v)


sin = Function("sin", (_sin, _sin_fine), _trigonometric("sin"), _front_sin)
cos = Function("cos", (_cos, _cos_fine), _trigonometric("cos"), _front_cos)
tan = Function("tan", (_tan, _tan_fine), _trigonometric("tan"), _front_tan)


# --- degrees --------------------------------------------------------------------------------

_DEGREE = np.pi / 180
#: 10^k modulo 360 is 280 from k = 3 on.
_TURN_TENS = np.array([1.0, 10.0, 100.0, 280.0])


def _quarters(m: Ints, e: Ints) -> tuple[Floats, Floats, NDArray[np.int64]]:
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


def _wave(m: Ints, e: Ints, ahead: int) -> Approximation:
    n, p, quadrant = _quarters(m, e)
    quadrant = (quadrant + ahead) & 3
    # sin, cos, -sin, -cos of the rest; cos of t is the sine of 90 - |t|.
    n = np.where(quadrant & 1, 90.0 * p - np.abs(n), n)
    y = np.sin(n * _DEGREE / p)
    # The angle is wrong by four roundings, the sine relatively by no more.
    return np.where(quadrant & 2, -y, y), LIBRARY + 5 * UNIT


def _sin_degrees(m: Ints, e: Ints) -> Approximation:
    return _wave(m, e, 0)


def _cos_degrees(m: Ints, e: Ints) -> Approximation:
    return _wave(m, e, 1)


def _tan_degrees(m: Ints, e: Ints) -> Approximation:
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


#: By right angles modulo 4: whether the rest counts from the next one, and the sign.
_ODD = np.array([False, True, False, True])
_SIGN = np.array([1.0, 1.0, -1.0, -1.0])


def _turning_degrees(v: Floats) -> Floats:
    """Return how far the float next to an angle moves a sine; from 2^53 on nothing is known.

    Below, a float that is a multiple of 90 is the angle itself, and a zero is none by chance.
    """
    size = np.abs(v)
    return np.where(size < 2.0**53, size * (UNIT * _DEGREE), np.inf)


def _front_wave(v: Floats, ahead: int) -> Front:
    """Of multiples of 30 and 45 degrees the rest is exact, and the sine next to its value."""
    turns = np.rint(v / 90.0)
    rest = v - turns * 90.0
    quadrant = (turns % 4.0).astype(np.int64) + ahead & 3
    rest = np.where(_ODD[quadrant], 90.0 - np.abs(rest), rest)
    return np.sin(rest * _DEGREE) * _SIGN[quadrant], _turning_degrees(v)


def _front_tan_degrees(v: Floats) -> Front:
    turns = np.rint(v / 90.0)
    rest = v - turns * 90.0
    odd = turns % 2.0 == 1.0
    y = np.tan(np.where(odd & (rest == 0), np.nan, rest) * _DEGREE)  # a pole, or too large to tell
    np.divide(-1.0, y, y, where=odd)
    return y, (1 + y * y) * _turning_degrees(v)


sin_degrees = Function("sin", (_sin_degrees,), _in_degrees("sin"), lambda v: _front_wave(v, 0))
cos_degrees = Function("cos", (_cos_degrees,), _in_degrees("cos"), lambda v: _front_wave(v, 1))
tan_degrees = Function("tan", (_tan_degrees,), _in_degrees("tan"), _front_tan_degrees)


# --- inverses -------------------------------------------------------------------------------
#
# All through the arc tangent of two numbers, because that is well conditioned everywhere: a
# relative error of an operand moves the result relatively by no more.


def _angle(y: Floats, x: Floats, unit: float) -> Approximation:
    return np.arctan2(y, x) * unit, LIBRARY + 12 * UNIT


def _leg(m: Ints, e: Ints) -> Floats:
    """Return sqrt(1 - x^2) with a relative error of a few UNIT, also for |x| next to 1."""
    if ((np.abs(m) > LOW) & (e == 1) | (e > 1)).any():
        raise ValueError("arc sine or arc cosine of a number beyond 1")
    # In units of 1e-8: exact where x >= 0.1, and there alone 1 - |x| could lose digits.
    x = np.abs(m) * ten(np.where(m == 0, 0, e).astype(np.int64))
    return np.asarray(np.sqrt((1e8 - x) * (1e8 + x)) * 1e-8)


def _front_asin(v: Floats, unit: float) -> Front:
    return _bounded(v, np.arcsin, unit)


def _front_acos(v: Floats, unit: float) -> Front:
    return _bounded(v, np.arccos, unit)


def _bounded(v: Floats, function: Callable[[Floats], Floats], unit: float) -> Front:
    """The slope is 1 / sqrt(1 - x^2); next to 1 it makes everything doubtful."""
    size = np.abs(v)
    if size.size and size.item(size.argmax()) > 1.0:
        raise ValueError("arc sine or arc cosine of a number beyond 1")
    leg = np.sqrt(np.maximum((1.0 - size) * (1.0 + size), 1e-17))
    return function(v) * unit, size * (UNIT * unit) / leg


def _inverse(
    name: str,
    approximate: Callable[[Ints, Ints, float], Approximation],
    front: Callable[[Floats, float], Front],
) -> tuple[Function, Function]:
    """Return the function in radians and in degrees."""

    def make(unit: float, degrees: bool) -> Function:
        def decided(m: int, e: int) -> tuple[int, int]:
            def evaluate(ctx: Any) -> Any:
                angle = getattr(ctx, name)(exact.number(ctx, m, e))
                return angle * 180 / ctx.pi if degrees else angle

            return exact.decide(evaluate)

        return Function(
            name, (lambda m, e: approximate(m, e, unit),), decided, lambda v: front(v, unit)
        )

    return make(1.0, False), make(1 / _DEGREE, True)


asin, asin_degrees = _inverse(
    "asin", lambda m, e, unit: _angle(plain(m, e), _leg(m, e), unit), _front_asin
)
acos, acos_degrees = _inverse(
    "acos", lambda m, e, unit: _angle(_leg(m, e), plain(m, e), unit), _front_acos
)
atan, atan_degrees = _inverse(
    "atan",
    lambda m, e, unit: (np.arctan(plain(m, e)) * unit, LIBRARY + 8 * UNIT),
    lambda v, unit: (np.arctan(v) * unit, None),
)


def _atan2(unit: float, degrees: bool) -> Function:
    def approximate(ym: Ints, ye: Ints, xm: Ints, xe: Ints) -> Approximation:
        return _angle(plain(ym, ye), plain(xm, xe), unit)

    def front(y: Floats, x: Floats) -> Front:
        # Of the two zeros of float64 the one without a sign, or else the angle may be pi.
        return np.arctan2(y + 0.0, x + 0.0) * unit, None

    def decided(ym: int, ye: int, xm: int, xe: int) -> tuple[int, int]:
        def evaluate(ctx: Any) -> Any:
            angle = ctx.atan2(exact.number(ctx, ym, ye), exact.number(ctx, xm, xe))
            return angle * 180 / ctx.pi if degrees else angle

        return exact.decide(evaluate)

    return Function("atan2", (approximate,), decided, front)


atan2, atan2_degrees = _atan2(1.0, False), _atan2(1 / _DEGREE, True)


def _scaled_angle(factor: float, degrees: bool) -> Function:
    def approximate(m: Ints, e: Ints) -> Approximation:
        return plain(m, e) * factor, 6 * UNIT

    def decided(m: int, e: int) -> tuple[int, int]:
        def evaluate(ctx: Any) -> Any:
            x = exact.number(ctx, m, e)
            return x * 180 / ctx.pi if degrees else x * ctx.pi / 180

        return exact.decide(evaluate)

    return Function(
        "degrees" if degrees else "radians",
        (approximate,),
        decided,
        lambda v: (v * factor, None),
    )


to_radians, to_degrees = _scaled_angle(_DEGREE, False), _scaled_angle(1 / _DEGREE, True)


# --- hypotenuse and power -------------------------------------------------------------------


def _hypot(am: Ints, ae: Ints, bm: Ints, be: Ints) -> Approximation:
    a, b = plain(am, ae), plain(bm, be)
    return np.sqrt(a * a + b * b), 8 * UNIT


def _decide_hypot(am: int, ae: int, bm: int, be: int) -> tuple[int, int]:
    if am == 0 or bm == 0:
        return (abs(am), ae) if bm == 0 else (abs(bm), be)
    return exact.hypotenuse(am, ae, bm, be)


hypot = Function("hypot", (_hypot,), _decide_hypot, lambda a, b: (np.sqrt(a * a + b * b), None))


def _power(xm: Ints, xe: Ints, ym: Ints, ye: Ints) -> Approximation:
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


def whole(values: Floats, how: str) -> Floats:
    """Return values rounded to integers: 'away' (ties away from zero), 'floor', 'ceil', 'trunc'.

    A half is an exact float64, and so are integers of 8 digits; other numbers are further from a
    half or an integer than the floats that name them are from them. Larger ones are even integers
    already where float64 ends, so that adding a half does not move them.
    """
    if how == "away":
        return np.asarray(np.trunc(values + np.copysign(0.5, values)))
    result: Floats = {"floor": np.floor, "ceil": np.ceil, "trunc": np.trunc}[how](values)
    return result

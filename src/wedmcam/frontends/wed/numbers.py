"""Numbers of the part language: 8-digit decimals or float64, and the exact value if there is one.

Every result is rounded to 8 digits as the ZD-065 rounds it. Beside it the exact fraction is kept as
long as there is one: an angle of 360/7 is a seventh of a turn to the digit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from wedmcam.diag import Diagnostic, Span, error

#: An exact value with more bits than this is let go.
MOST_BITS = 256
#: Numbers beyond this are typing errors; they have no place on a machine.
LARGEST = 1e15


class Wrong(Exception):  # noqa: N818 - a way out of one expression
    """There is no such number, or no such block; made by `wrong`.

    ``finding``: what is wrong, of a code, at a place.
    """

    def __init__(self, text: str, finding: Callable[[str, Span], Diagnostic]) -> None:
        super().__init__(text)
        self.finding = finding


def wrong(template: str, **values: Any) -> Wrong:
    """Return the exception that says why there is no such number, with values of its template."""
    return Wrong(template, lambda code, span: error(code, template, span, **values))


@dataclass(frozen=True, slots=True)
class Number:
    """A number: as rounded in the arithmetic, and exact where it is known."""

    value: Any
    exact: Fraction | None = None

    @property
    def fraction(self) -> Fraction:
        """The exact value, else that of the rounded one."""
        return self.exact if self.exact is not None else Fraction(self.value_decimal)

    @property
    def value_decimal(self) -> Any:
        """The rounded value as something that Fraction takes."""
        return self.value if isinstance(self.value, float) else self.value.decimal

    def __float__(self) -> float:
        return float(self.value)

    def __str__(self) -> str:
        return f"{float(self.value):.10g}"


@dataclass(frozen=True, slots=True)
class Point:
    """A point or a vector, in the unit of the program."""

    x: Number
    y: Number


class Numbers:
    """What an expression can do with numbers, in one arithmetic.

    >>> n = Numbers("decimal8")
    >>> str(n.divide(n.literal("360"), n.literal("7"))), n.sin(n.literal("30")).value
    ('51.428571', Decimal8('0.5'))
    """

    def __init__(self, arithmetic: str) -> None:
        self.name = arithmetic
        self.literals: dict[str, Number] = {}  # half of a long program's numbers stand there twice
        self.make: Callable[[Any], Any] = float
        if arithmetic != "float64":
            from wedmcam.decimal8 import Decimal8

            self.make = Decimal8

    def literal(self, text: str) -> Number:
        """Return the number that a text says."""
        if text in self.literals:
            return self.literals[text]
        size = abs(float(text))
        if len(text) > 60 or not size <= LARGEST:
            raise wrong("this number is beyond 10^15, or has more digits than anybody can use")
        if size < 1e-30 and any(c in "123456789" for c in text.lower().split("e")[0]):
            raise wrong("this number is too small to work with")
        self.literals[text] = Number(self.make(text), _kept(_exact(text)))
        return self.literals[text]

    def of(self, value: Fraction | int | float) -> Number:
        """Return a number of ours."""
        exact = Fraction(value)
        return Number(self.make(float(value)), exact)

    def _made(self, work: Callable[[], Any], exact: Fraction | None) -> Number:
        try:
            value = work()
        except (ArithmeticError, ValueError, TypeError) as why:
            if not str(why):
                raise wrong("there is no such number") from None
            raise wrong("{reason}", reason=str(why)) from None
        if isinstance(value, complex) or not abs(float(value)) <= LARGEST:
            raise wrong("the result is beyond 10^15")
        return Number(value, _kept(exact))

    def add(self, a: Number, b: Number) -> Number:
        """Return a + b."""
        exact = None if a.exact is None or b.exact is None else a.exact + b.exact
        return self._made(lambda: a.value + b.value, exact)

    def negate(self, a: Number) -> Number:
        """Return -a."""
        return Number(-a.value if a.value else a.value, None if a.exact is None else -a.exact)

    def subtract(self, a: Number, b: Number) -> Number:
        """Return a - b."""
        return self.add(a, self.negate(b))

    def multiply(self, a: Number, b: Number) -> Number:
        """Return a times b."""
        exact = None if a.exact is None or b.exact is None else a.exact * b.exact
        return self._made(lambda: a.value * b.value, exact)

    def divide(self, a: Number, b: Number) -> Number:
        """Return a / b."""
        if not b.value:
            raise wrong("division by zero")
        exact = None if a.exact is None or not b.exact else a.exact / b.exact
        return self._made(lambda: a.value / b.value, exact)

    def power(self, a: Number, b: Number) -> Number:
        """Return a to the power of b."""
        exact = None
        if a.exact is not None and b.exact is not None and b.exact.denominator == 1:
            k = int(b.exact)
            if abs(k) <= 64 and (a.exact or k >= 0):
                exact = a.exact**k
        return self._made(lambda: a.value**b.value, exact)

    def sqrt(self, a: Number) -> Number:
        """Return the square root."""
        if a.value < 0:
            raise wrong("the square root of {number:.10g} is no number", number=float(a))
        return self._made(lambda: _call(a.value, "sqrt"), None)

    def sin(self, a: Number) -> Number:
        """Return the sine of an angle in degrees."""
        return self._made(lambda: self._turn(a, "sin"), None)

    def cos(self, a: Number) -> Number:
        """Return the cosine of an angle in degrees."""
        return self._made(lambda: self._turn(a, "cos"), None)

    def tan(self, a: Number) -> Number:
        """Return the tangent of an angle in degrees."""
        if a.fraction % 180 == 90:
            raise wrong("the tangent of {angle_deg:.10g} degrees is no number", angle_deg=float(a))
        return self._made(lambda: self._turn(a, "tan"), None)

    def asin(self, a: Number) -> Number:
        """Return the angle in degrees whose sine this is."""
        return self._made(lambda: self._angle(a.value, "asin"), None)

    def acos(self, a: Number) -> Number:
        """Return the angle in degrees whose cosine this is."""
        return self._made(lambda: self._angle(a.value, "acos"), None)

    def atan(self, a: Number) -> Number:
        """Return the angle in degrees whose tangent this is."""
        return self._made(lambda: self._angle(a.value, "atan"), None)

    def atan2(self, y: Number, x: Number) -> Number:
        """Return the angle in degrees of the point (x, y)."""
        if isinstance(y.value, float):
            return self._made(lambda: math.degrees(math.atan2(y.value, x.value)), None)
        return self._made(lambda: y.value.atan2(x.value, True), None)

    def absolute(self, a: Number) -> Number:
        """Return the magnitude."""
        return self.negate(a) if a.value < 0 else a

    def _turn(self, a: Number, name: str) -> Any:
        """Return sin, cos or tan; whole turns leave before anything is rounded."""
        turn = a.fraction % 360
        if self.name == "float64":
            quarter = {"sin": {0: 0.0, 90: 1.0, 180: 0.0, 270: -1.0},
                       "cos": {0: 1.0, 90: 0.0, 180: -1.0, 270: 0.0}}.get(name, {})  # fmt: skip
            if turn.denominator == 1 and int(turn) in quarter:
                return quarter[int(turn)]
            return float(getattr(math, name)(math.radians(turn)))
        return getattr(self.make(float(turn)), name)(True)

    def _angle(self, value: Any, name: str) -> Any:
        if isinstance(value, float):
            return math.degrees(getattr(math, name)(value))
        return getattr(value, name)(True)

    def um(self, a: Number, factor: int) -> float:
        """Return a length in um: the nearest float."""
        if isinstance(a.value, float):
            return a.value * factor
        return float(a.value.scaled(factor))


def _exact(text: str) -> Fraction:
    whole, _, part = text.partition(".")
    if (whole + part).isdecimal():  # three times as fast as Fraction(text)
        return Fraction(int(whole + part), 10 ** len(part))
    return Fraction(text if float(text) != 0 else 0)


def _call(value: Any, name: str) -> Any:
    return getattr(math, name)(value) if isinstance(value, float) else getattr(value, name)()


def _kept(exact: Fraction | None) -> Fraction | None:
    if exact is None:
        return None
    bits = exact.numerator.bit_length() + exact.denominator.bit_length()
    return exact if bits <= MOST_BITS else None

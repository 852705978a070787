"""One 8-digit decimal number, in Python integers.

Written apart from the arrays, and so the plainer of two ways to the same result for ``+ - * /``,
comparison and square root. The other functions are those of arrays, of one element.
"""

from __future__ import annotations

import decimal
import math
import operator
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np

from wedmcam.decimal8.exact import hypotenuse
from wedmcam.decimal8.methods import Methods
from wedmcam.decimal8.number_format import DIGITS, ZERO, in_range, round_integer

_EXACT = decimal.Context(prec=decimal.MAX_PREC, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN)


def parts_of(value: Any) -> tuple[int, int]:
    """Return mantissa and exponent of a Python number or text, rounded once.

    Raises:
        TypeError: it is neither number nor text.
        ValueError: the text is no number, or the number is NaN.
        OverflowError: it is infinite or beyond the format.
    """
    if isinstance(value, Decimal8):
        return value._m, value._e
    if isinstance(value, (int, np.integer)):
        if int(value).bit_length() > 400:
            raise OverflowError("an integer beyond 10^99")
        return in_range(*round_integer(int(value), 0))
    if isinstance(value, (float, np.floating)):
        n, d = float(value).as_integer_ratio()  # raises on NaN and infinity
        t = d.bit_length() - 1  # n / 2^t = n 5^t / 10^t
        return in_range(*round_integer(n * 5**t, -t))
    if isinstance(value, str):
        try:
            value = Decimal(value)
        except decimal.InvalidOperation:
            raise ValueError(f"{value!r} is no number") from None
    if isinstance(value, Decimal):
        if value.is_nan():
            raise ValueError("NaN is no number")
        if value.is_infinite():
            raise OverflowError("an infinite number")
        sign, digits, power = value.as_tuple()
        assert isinstance(power, int)
        # 25 digits and a mark whether more follow decide the rounding, however many there are.
        kept, more = digits[:25], any(digits[25:])
        n = int("".join(map(str, kept)) or "0") * 10 + more
        return in_range(*round_integer(-n if sign else n, power + len(digits) - len(kept) - 1))
    raise TypeError(f"{type(value).__name__} is no number that an 8-digit decimal can be made of")


class Decimal8(Methods):
    """An 8-digit decimal floating-point number; immutable.

    Every operation returns the exact result rounded once to 8 digits, ties away from zero. A
    Python number on either side of an operator is first rounded to 8 digits itself (the machine
    holds no others); comparisons take it as it is. There is no negative zero, infinity or NaN.

    Args:
        value: int, float (at its exact value), `decimal.Decimal` or text.

    Raises:
        OverflowError: the number is 10^99 or more.
        ValueError: it is no number.

    The paper's example, in the six bytes of the ZD-065:

    >>> Decimal8("-13.625e-9").to_bytes().hex(" ")
    '11 07 13 62 50 00'
    >>> Decimal8(2) / 3 + 1
    Decimal8('1.6666667')
    """

    __slots__ = ("_e", "_m")
    _m: int
    _e: int

    def __init__(self, value: Decimal8 | int | float | Decimal | str = 0) -> None:
        self._m, self._e = parts_of(value)

    @classmethod
    def _of(cls, m: int, e: int) -> Decimal8:
        """Return the number of a rounded mantissa and its exponent; checks the range."""
        self = cls.__new__(cls)
        self._m, self._e = in_range(m, e)
        return self

    @classmethod
    def _named(cls, value: float) -> Decimal8:
        """Return the number that a float is the nearest float64 to."""
        digits, _, power = f"{value:.7e}".partition("e")
        m = int(digits.replace(".", ""))
        return cls._of(m, int(power) + 1 if m else ZERO)

    @classmethod
    def _rounded(cls, n: int, power: int) -> Decimal8:
        return cls._of(*round_integer(n, power))

    @classmethod
    def from_bytes(cls, data: bytes) -> Decimal8:
        """Return the number that 6 bytes of BCD hold.

        Raises:
            ValueError: they are not 6 bytes as `to_bytes` writes them.
        """
        from wedmcam.decimal8.convert import from_bcd

        if len(data) != 6:
            raise ValueError(f"an 8-digit decimal is 6 bytes, not {len(data)}")
        return cls._named(from_bcd(np.frombuffer(data, np.uint8).reshape(1, 6)).item())

    def to_bytes(self) -> bytes:
        """Return the 6 bytes of BCD: signs, exponent, significand."""
        if self._m == 0:
            return bytes(6)
        signs = 16 * (self._m < 0) + (self._e < 0)
        return bytes([signs]) + bytes.fromhex(f"{abs(self._e):02d}{abs(self._m):08d}")

    @property
    def mantissa(self) -> int:
        """The signed significand as an integer of 8 digits; 0 for zero."""
        return self._m

    @property
    def exponent(self) -> int:
        """The exponent of 0.dddddddd x 10^e; 0 for zero."""
        return self._e if self._m else 0

    @property
    def decimal(self) -> Decimal:
        """The exact value as a `decimal.Decimal`, without trailing zeros behind the point."""
        m, k = self._m, self._e - DIGITS
        if m == 0:
            return Decimal(0)
        while k < 0 and m % 10 == 0:
            m, k = m // 10, k + 1
        return Decimal(m).scaleb(k, _EXACT)

    # --- arithmetic -------------------------------------------------------------------------

    def __add__(self, other: Any) -> Any:
        return _binary(self, other, _add)

    def __radd__(self, other: Any) -> Any:
        return _binary(other, self, _add)

    def __sub__(self, other: Any) -> Any:
        return _binary(self, other, _subtract)

    def __rsub__(self, other: Any) -> Any:
        return _binary(other, self, _subtract)

    def __mul__(self, other: Any) -> Any:
        return _binary(self, other, _multiply)

    def __rmul__(self, other: Any) -> Any:
        return _binary(other, self, _multiply)

    def __truediv__(self, other: Any) -> Any:
        return _binary(self, other, _divide)

    def __rtruediv__(self, other: Any) -> Any:
        return _binary(other, self, _divide)

    def __pow__(self, other: Any) -> Any:
        return _binary(self, other, _power)

    def __rpow__(self, other: Any) -> Any:
        return _binary(other, self, _power)

    def __neg__(self) -> Decimal8:
        return Decimal8._of(-self._m, self._e)

    def __pos__(self) -> Decimal8:
        return self

    def __abs__(self) -> Decimal8:
        return Decimal8._of(abs(self._m), self._e)

    def sqrt(self) -> Decimal8:
        """Return the square root.

        Raises:
            ValueError: the number is negative.

        >>> Decimal8(2).sqrt()
        Decimal8('1.4142136')
        """
        if self._m < 0:
            raise ValueError("square root of a negative number")
        if self._m == 0:
            return self
        k = self._e - DIGITS
        n = self._m * 10 ** (20 + k % 2)
        root = math.isqrt(n)
        return Decimal8._rounded(10 * root + (root * root != n), (k - k % 2 - 20) // 2 - 1)

    def hypot(self, other: Any) -> Decimal8:
        """Return the square root of the sum of both squares, rounded once.

        >>> Decimal8(3).hypot(4)
        Decimal8('5')
        """
        m, e = parts_of(other)
        if not (self._m and m):
            return abs(Decimal8._of(self._m, self._e) if self._m else Decimal8._of(m, e))
        return Decimal8._of(*hypotenuse(self._m, self._e, m, e))

    def _call(self, name: str, *others: Any) -> Decimal8:
        from wedmcam.decimal8 import functions

        function = getattr(functions, name)
        return Decimal8._named(function(*(_array(Decimal8(x)) for x in (self, *others))).item())

    def _whole(self, how: str) -> Decimal8:
        from wedmcam.decimal8 import functions

        return Decimal8._named(functions.whole(_array(self), how).item())

    # --- comparison -------------------------------------------------------------------------

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Decimal8):
            return self._m == other._m and self._e == other._e
        exact = _comparable(other)
        return NotImplemented if exact is None else self.decimal == exact

    def __lt__(self, other: Any) -> Any:
        return self._ordered(other, operator.lt)

    def __le__(self, other: Any) -> Any:
        return self._ordered(other, operator.le)

    def __gt__(self, other: Any) -> Any:
        return self._ordered(other, operator.gt)

    def __ge__(self, other: Any) -> Any:
        return self._ordered(other, operator.ge)

    def _ordered(self, other: Any, holds: Callable[[Any, Any], bool]) -> Any:
        if type(other) is int and other == 0:
            return holds(self._m, 0)
        exact = _comparable(other)
        if exact is None:
            return NotImplemented
        return exact == exact and holds(self.decimal, exact)  # NaN is in no order

    def __hash__(self) -> int:
        return hash(self.decimal)

    def __bool__(self) -> bool:
        return self._m != 0

    # --- conversion -------------------------------------------------------------------------

    def __float__(self) -> float:
        return self.scaled(1)

    def scaled(self, factor: int) -> float:
        """Return the float64 nearest to ``factor`` times this number, rounded once.

        >>> Decimal8("0.1").scaled(25_400)
        2540.0
        """
        m, k = self._m * factor, self._e - DIGITS
        if m == 0:
            return 0.0
        # A quotient of integers is rounded once, and quick where both fit a float.
        return m / 10**-k if k < 0 else float(m * 10**k)

    def __int__(self) -> int:
        return int(self.decimal)

    def __round__(self, ndigits: int | None = None) -> Any:
        """Round to an int, or to ``ndigits`` places behind the point; ties away from zero."""
        if ndigits is None:
            return int(self._whole("away"))
        last = self.exponent - DIGITS
        if self._m == 0 or last >= -ndigits:
            return self
        unit = 10 ** (-ndigits - last)
        n = (abs(self._m) + unit // 2) // unit
        return Decimal8._rounded(n if self._m > 0 else -n, -ndigits)

    def __floor__(self) -> int:
        return int(self._whole("floor"))

    def __ceil__(self) -> int:
        return int(self._whole("ceil"))

    def __trunc__(self) -> int:
        return int(self)

    def __str__(self) -> str:
        return str(self.decimal)

    def __repr__(self) -> str:
        return f"Decimal8('{self.decimal}')"

    def __format__(self, spec: str) -> str:
        return format(self.decimal, spec)

    def __reduce__(self) -> tuple[Any, ...]:
        return Decimal8, (str(self),)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        from wedmcam.decimal8.protocol import ufunc_call

        return ufunc_call(ufunc, method, inputs, kwargs)


def _array(x: Decimal8) -> Any:
    return np.array([float(x)])


def _comparable(other: Any) -> Decimal | float | int | None:
    """Return the exact value of a number for comparison; None if it is none."""
    if isinstance(other, Decimal8):
        return other.decimal
    if isinstance(other, (int, float, Decimal)):
        return other
    if isinstance(other, np.integer):
        return int(other)
    if isinstance(other, np.floating):
        return float(other)
    return None


def _binary(a: Any, b: Any, operation: Any) -> Any:
    if type(a) is Decimal8 and type(b) is Decimal8:
        return operation(a._m, a._e, b._m, b._e)
    if _comparable(a) is None or _comparable(b) is None:
        return NotImplemented
    return operation(*parts_of(a), *parts_of(b))


def _add(am: int, ae: int, bm: int, be: int) -> Decimal8:
    if ae < be:
        am, ae, bm, be = bm, be, am, ae
    if ae - be > 11:  # too small to be seen even beside 1.0000000
        return Decimal8._of(am, ae)
    return Decimal8._rounded(am * 10 ** (ae - be) + bm, be - DIGITS)


def _subtract(am: int, ae: int, bm: int, be: int) -> Decimal8:
    return _add(am, ae, -bm, be)


def _multiply(am: int, ae: int, bm: int, be: int) -> Decimal8:
    return Decimal8._rounded(am * bm, ae + be - 2 * DIGITS)


def _divide(am: int, ae: int, bm: int, be: int) -> Decimal8:
    if bm == 0:
        raise ZeroDivisionError("division by zero")
    quotient, rest = divmod(abs(am) * 10**17, abs(bm))
    n = 10 * quotient + (rest != 0)  # a further digit stands for all that follow
    return Decimal8._rounded(n if (am < 0) == (bm < 0) else -n, ae - be - 18)


def _power(am: int, ae: int, bm: int, be: int) -> Decimal8:
    return Decimal8._of(am, ae)._call("power", Decimal8._of(bm, be))

"""The ZD-065's arithmetic: decimal floating point of 8 digits, correctly rounded, on arrays.

The controller computes in ``+/- 0.dddddddd x 10^(+/-ee)``, six bytes of BCD a number (Sun Yat-sen
University, 1983), and that decides every micron of a rotated or compensated figure. Here each
result of ``+ - * / **``, square root, sine and so on is the exact one rounded once to 8 digits,
ties away from zero; the paper gives the precision and not the algorithms. `Decimal8` is one number,
`Decimal8Array` many; `DECIMAL8` is the arithmetic that formulas are written over.

Beyond exponent +99: OverflowError. Below -99: zero, counted by `watch`. Division by zero:
ZeroDivisionError. Root of a negative number, arc sine beyond 1 and the like: ValueError.

>>> Decimal8("-13.625e-9").to_bytes().hex(" ")
'11 07 13 62 50 00'
>>> sin(30, degrees=True), atan2(1, -1, degrees=True)
(Decimal8('0.5'), Decimal8('135'))

A floor layer: imports nothing else of ours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.decimal8.array import Decimal8Array
from wedmcam.decimal8.convert import from_floats
from wedmcam.decimal8.number_format import Flags, watch
from wedmcam.decimal8.protocol import where
from wedmcam.decimal8.scalar import Decimal8

__all__ = [
    "DECIMAL8",
    "Decimal8",
    "Decimal8Array",
    "Flags",
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "hypot",
    "sin",
    "sqrt",
    "tan",
    "watch",
    "where",
]


def _number(value: Any) -> Any:
    if isinstance(value, (Decimal8, Decimal8Array)):
        return value
    return Decimal8Array(value) if isinstance(value, (np.ndarray, list, tuple)) else Decimal8(value)


def _pair(a: Any, b: Any) -> tuple[Any, Any]:
    a, b = _number(a), _number(b)
    if isinstance(b, Decimal8Array) and isinstance(a, Decimal8):
        a = Decimal8Array.from_values(a)
    return a, b


def sqrt(a: Any) -> Any:
    """Return the square root of a number or an array; negative numbers raise ValueError."""
    return _number(a).sqrt()


def sin(a: Any, degrees: bool = False) -> Any:
    """Return the sine of an angle in radians, or in degrees."""
    return _number(a).sin(degrees)


def cos(a: Any, degrees: bool = False) -> Any:
    """Return the cosine of an angle in radians, or in degrees."""
    return _number(a).cos(degrees)


def tan(a: Any, degrees: bool = False) -> Any:
    """Return the tangent; 90 degrees and its odd multiples raise ValueError."""
    return _number(a).tan(degrees)


def asin(a: Any, degrees: bool = False) -> Any:
    """Return the arc sine, from -pi/2 to pi/2; beyond 1 raises ValueError."""
    return _number(a).asin(degrees)


def acos(a: Any, degrees: bool = False) -> Any:
    """Return the arc cosine, from 0 to pi; beyond 1 raises ValueError."""
    return _number(a).acos(degrees)


def atan(a: Any, degrees: bool = False) -> Any:
    """Return the arc tangent, from -pi/2 to pi/2."""
    return _number(a).atan(degrees)


def atan2(y: Any, x: Any, degrees: bool = False) -> Any:
    """Return the angle of the point (x, y), above -pi to pi; 0 for (0, 0)."""
    y, x = _pair(y, x)
    return y.atan2(x, degrees)


def hypot(a: Any, b: Any) -> Any:
    """Return the square root of a^2 + b^2, rounded once.

    >>> hypot(60000003, 80000004)  # 100000005: a tie
    Decimal8('1.0000001E+8')
    """
    a, b = _pair(a, b)
    return a.hypot(b)


class Decimal8Arithmetic:
    """8-digit decimals as an arithmetic that formulas are written over; angles in radians.

    >>> a = DECIMAL8.array([3.0]) * 3 + 16
    >>> DECIMAL8.sqrt(a).tolist()
    [Decimal('5')]
    """

    name = "decimal8"

    def array(self, values: ArrayLike | Decimal8Array) -> Decimal8Array:
        """Return ``values`` with each rounded once; an array of this kind is returned as it is."""
        if isinstance(values, Decimal8Array):
            return values
        return Decimal8Array._of(from_floats(np.asarray(values, dtype=np.float64)))

    def to_float(self, a: Decimal8Array) -> NDArray[np.float64]:
        """Return the float64 nearest to each value."""
        return a.to_float()

    def sqrt(self, a: Decimal8Array) -> Decimal8Array:
        """Return the square root."""
        return a.sqrt()

    def sin(self, a: Decimal8Array) -> Decimal8Array:
        """Return the sine."""
        return a.sin()

    def cos(self, a: Decimal8Array) -> Decimal8Array:
        """Return the cosine."""
        return a.cos()

    def where(self, condition: NDArray[np.bool_], a: Any, b: Any) -> Decimal8Array:
        """Return a where the condition holds, else b."""
        return where(condition, a, b)


DECIMAL8 = Decimal8Arithmetic()

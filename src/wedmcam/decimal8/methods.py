"""The functions that a number and an array of numbers have in common, as methods.

One list, so that `Decimal8` and `Decimal8Array` cannot differ in what they can do.
"""

from __future__ import annotations

from typing import Any, Self


class Methods:
    """Functions in terms of ``_call(name, *others)``, which a class provides."""

    __slots__ = ()

    def _call(self, name: str, *others: Any) -> Self:
        raise NotImplementedError

    def _whole(self, how: str) -> Self:
        raise NotImplementedError

    def sin(self, degrees: bool = False) -> Self:
        """Return the sine of an angle in radians, or in degrees."""
        return self._call("sin_degrees" if degrees else "sin")

    def cos(self, degrees: bool = False) -> Self:
        """Return the cosine of an angle in radians, or in degrees."""
        return self._call("cos_degrees" if degrees else "cos")

    def tan(self, degrees: bool = False) -> Self:
        """Return the tangent; 90 degrees and its odd multiples raise ValueError."""
        return self._call("tan_degrees" if degrees else "tan")

    def asin(self, degrees: bool = False) -> Self:
        """Return the arc sine, from -pi/2 to pi/2; beyond 1 raises ValueError."""
        return self._call("asin_degrees" if degrees else "asin")

    def acos(self, degrees: bool = False) -> Self:
        """Return the arc cosine, from 0 to pi; beyond 1 raises ValueError."""
        return self._call("acos_degrees" if degrees else "acos")

    def atan(self, degrees: bool = False) -> Self:
        """Return the arc tangent, from -pi/2 to pi/2."""
        return self._call("atan_degrees" if degrees else "atan")

    def atan2(self, x: Any, degrees: bool = False) -> Self:
        """Return the angle of the point (x, self), above -pi to pi; 0 for (0, 0)."""
        return self._call("atan2_degrees" if degrees else "atan2", x)

    def hypot(self, other: Any) -> Self:
        """Return the square root of the sum of both squares, rounded once."""
        return self._call("hypot", other)

    def to_radians(self) -> Self:
        """Return an angle in degrees in radians."""
        return self._call("to_radians")

    def to_degrees(self) -> Self:
        """Return an angle in radians in degrees."""
        return self._call("to_degrees")

    def rint(self) -> Self:
        """Return the nearest integer, ties away from zero (unlike `numpy.rint` of floats)."""
        return self._whole("away")

    def floor(self) -> Self:
        """Return the largest integer not above."""
        return self._whole("floor")

    def ceil(self) -> Self:
        """Return the smallest integer not below."""
        return self._whole("ceil")

    def trunc(self) -> Self:
        """Return the integer part."""
        return self._whole("trunc")

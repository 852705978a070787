"""The arithmetic that formulas are written over.

The ZD-065 computes in 8-digit decimal floating point, and that decides every micron it cuts; tests
want the truth from mpmath; comparisons want float64. So a formula (an offset, a crossing, a
rotation) is written once, as a function of an `Arithmetic`, with ``+ - * /`` and comparisons on
arrays of it, and the few functions named here. A floor layer: it imports nothing of ours.

Figures enter relative to a whole-um origin near the part: 8 digits are 0.01 um at 100 mm, but 1 um
at 10 m. What is a question of topology (does it cross, is it inside) is decided in float64.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Arithmetic(Protocol):
    """What a formula needs besides the operators of its arrays.

    Arrays are one-dimensional and support ``+ - * /``, unary minus and comparison with each other
    and with Python numbers. Angles are radians.
    """

    name: str

    def array(self, values: ArrayLike) -> Any:
        """Return ``values`` (float64) as an array of this arithmetic, each rounded once."""
        ...

    def to_float(self, a: Any) -> NDArray[np.float64]:
        """Return the float64 nearest to each value."""
        ...

    def sqrt(self, a: Any) -> Any:
        """Return the square root; values below zero are the caller's bug."""
        ...

    def sin(self, a: Any) -> Any:
        """Return the sine of an angle in radians."""
        ...

    def cos(self, a: Any) -> Any:
        """Return the cosine of an angle in radians."""
        ...

    def where(self, condition: NDArray[np.bool_], a: Any, b: Any) -> Any:
        """Return a where the condition holds, else b."""
        ...


class Float64:
    """IEEE double precision: numpy as it is.

    >>> a = FLOAT64.array([3.0]) * 3 + 16
    >>> FLOAT64.sqrt(a).tolist()
    [5.0]
    """

    name = "float64"

    def array(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return ``values`` as float64."""
        return np.asarray(values, dtype=np.float64)

    def to_float(self, a: Any) -> NDArray[np.float64]:
        """Return ``a`` itself."""
        return np.asarray(a, dtype=np.float64)

    def sqrt(self, a: Any) -> Any:
        """Return the square root."""
        return np.sqrt(a)

    def sin(self, a: Any) -> Any:
        """Return the sine."""
        return np.sin(a)

    def cos(self, a: Any) -> Any:
        """Return the cosine."""
        return np.cos(a)

    def where(self, condition: NDArray[np.bool_], a: Any, b: Any) -> Any:
        """Return a where the condition holds, else b."""
        return np.where(condition, a, b)


FLOAT64 = Float64()

"""Formulas over 50 digits: the same code as the compiler's, on arrays of mpmath numbers."""

import mpmath
import numpy as np

DIGITS = 50


def _each(function):
    made = np.frompyfunc(function, 1, 1)

    def on_arrays(a):
        with mpmath.workdps(DIGITS):
            return made(a)

    return on_arrays


class Exact:
    """An `Arithmetic`; set ``mpmath.workdps(DIGITS)`` around the whole of a computation."""

    name = "mpmath"

    def array(self, values):
        return np.array([mpmath.mpf(float(v)) for v in np.asarray(values)], dtype=object)

    def to_float(self, a):
        return np.array([float(v) for v in a])

    sqrt = staticmethod(_each(mpmath.sqrt))
    sin = staticmethod(_each(mpmath.sin))
    cos = staticmethod(_each(mpmath.cos))

    def where(self, condition, a, b):
        return np.where(condition, a, b)


EXACT = Exact()

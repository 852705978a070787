"""Values of findings as plain data, for JSON and certificates, bounded as messages are.

A value may come out of any file: a text of a megabyte, a list of every layer, a number that is
none. Whoever reads a certificate gets valid JSON of a size that does not depend on that.
"""

from __future__ import annotations

import math
from enum import Enum
from numbers import Integral, Real
from typing import Any

from wedmcam.diag.capped import KEPT
from wedmcam.diag.shown import shortened


def as_data(value: Any) -> Any:
    """Return a value of a finding as plain data: numbers to six decimals, a `Place` as a list.

    A text is of `shown.LONGEST` characters at most. A list that names not all of its things, or
    has more than `KEPT`, is an object: the first of them and how many more there are. A number
    that is not finite is None.

    >>> as_data(1 / 3), as_data(float("nan")), as_data(["a", True])
    (0.333333, None, ['a', True])
    >>> from wedmcam.diag.lists import first_of
    >>> as_data(first_of(["a", "b", "c"], 2))
    {'first': ['a', 'b'], 'more': 1}
    """
    if hasattr(value, "tolist"):  # a number or an array of numpy
        value = value.tolist()
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, Real) and not isinstance(value, Enum):
        return _number(value)
    if isinstance(value, list | tuple):
        first = [as_data(one) for one in value[:KEPT]]
        more = getattr(value, "unnamed", 0) + len(value) - len(first)
        return {"first": first, "more": more} if more else first
    return shortened(str(value))


def _number(value: Real) -> int | float | None:
    try:
        number = float(value)
    except OverflowError:
        return None
    if not math.isfinite(number):
        return None
    return int(value) if isinstance(value, Integral) else round(number, 6) + 0.0

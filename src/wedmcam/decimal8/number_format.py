"""The number format: what an 8-digit decimal float can hold, and what happens at its limits.

A value is ``m * 10**(e - 8)``: a signed mantissa m of exactly 8 digits (10,000,000 to 99,999,999)
and the exponent e of ``0.dddddddd x 10^e``, -99 to +99, as the ZD-065 stores it. Zero has m = 0
and, inside, an exponent far below every other (`ZERO`), so that aligning two numbers for an
addition needs no special case; outside it shows as 0. Arrays hold floats instead (`held`).

Overflow raises, underflow gives zero and is flagged: `watch` tells whether and how often.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

DIGITS = 8
#: Smallest and first too large magnitude of a mantissa.
LOW, HIGH = 10**7, 10**8
#: Largest exponent, and the negative of the smallest.
EXPONENT_MAX = 99
#: Exponent of zero, inside: below all others by more than any sum of them.
ZERO = -9999


@dataclass(slots=True)
class Flags:
    """What happened inside a `watch`.

    Attributes:
        underflows: number of results that were not zero but became zero, being below 1e-100.
    """

    underflows: int = 0

    @property
    def underflow(self) -> bool:
        """Whether any result underflowed."""
        return self.underflows > 0


_watching: ContextVar[tuple[Flags, ...]] = ContextVar("_watching", default=())


@contextmanager
def watch() -> Iterator[Flags]:
    """Collect the flags of everything computed inside the ``with`` block, nested blocks included.

    >>> from wedmcam.decimal8 import Decimal8
    >>> with watch() as flags:
    ...     product = Decimal8("1e-60") * Decimal8("1e-60")
    >>> product, flags.underflow
    (Decimal8('0'), True)
    """
    flags = Flags()
    token = _watching.set((*_watching.get(), flags))
    try:
        yield flags
    finally:
        _watching.reset(token)


@contextmanager
def unwatched() -> Iterator[None]:
    """Keep what is computed inside the ``with`` block from every `watch`: a comparison, say."""
    token = _watching.set(())
    try:
        yield
    finally:
        _watching.reset(token)


def flag_underflow(count: int = 1) -> None:
    """Tell every open `watch` that ``count`` results underflowed."""
    for flags in _watching.get():
        flags.underflows += count


def in_range(m: int, e: int) -> tuple[int, int]:
    """Return (m, e) if the format holds it; flag underflow and return zero; raise on overflow.

    Args:
        m: rounded mantissa, 0 or of 8 digits.
        e: its exponent.

    Raises:
        OverflowError: e is above 99.
    """
    if m == 0:
        return 0, ZERO
    if e > EXPONENT_MAX:
        raise OverflowError(f"the result has the exponent {e}; 8-digit numbers end at 10^99")
    if e < -EXPONENT_MAX:
        flag_underflow()
        return 0, ZERO
    return m, e


def round_integer(n: int, power: int) -> tuple[int, int]:
    """Return mantissa and exponent of ``n * 10**power``, rounded to 8 digits, ties away from zero.

    The range is not checked.

    >>> round_integer(123456785, 0), round_integer(-999999995, -9)
    ((12345679, 9), (-10000000, 1))
    """
    size = abs(n)
    if size == 0:
        return 0, ZERO
    extra = len(str(size)) - DIGITS
    if extra <= 0:
        m = size * 10**-extra
    else:
        scale: int = 10**extra
        m = (size + scale // 2) // scale
        if m == HIGH:
            m, extra = LOW, extra + 1
    return (m if n > 0 else -m), extra + power + DIGITS

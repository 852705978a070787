"""The arithmetic itself, ``+ - * /`` and square root, on arrays of mantissas and exponents.

Everything is float64 on integers and in pieces that stay in the processor's cache. float64 has 53
bits, an 8-digit mantissa 27; so sums are exact where it matters, and products and quotients are
wrong by less than `DOUBT` of a last digit. Results nearer to a tie than that are picked out and
rounded again in int64. No result is rounded twice.

Operands are one-dimensional, of one length or of length 1; ``(mantissas int32, exponents int16)``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.decimal8.form import DIGITS, EXPONENT_MAX, HIGH, LOW, ZERO, flag_underflow

Mantissas = NDArray[np.int32]
Exponents = NDArray[np.int16]
Parts = tuple[Mantissas, Exponents]
Floats = NDArray[np.float64]

#: Elements computed at a time: a mebibyte of scratch, which fits a level 2 cache.
PIECE = 32768

#: How near to the middle, in units of the last digit, a float64 quotient or product may come and
#: still be believed: four roundings of a number below 1e8 are 5e-8.
DOUBT = 1e-7

#: A number eleven powers of ten below another cannot change the rounding of their sum.
FAR = 11
#: What the first and the second of two numbers are divided by, by the difference of their
#: exponents from -FAR to FAR: the one with the smaller exponent by 10^|difference|.
_ALIGN_SECOND = np.array([1.0] * FAR + [10.0**k for k in range(FAR + 1)])
_ALIGN_FIRST = _ALIGN_SECOND[::-1].copy()
_HUNDREDS = np.array([1.0, 10.0, 100.0])
_EIGHT_SEVEN = np.array([1e8, 1e7])
_TENS = 10 ** np.arange(19, dtype=np.int64)


def piecewise(function: Callable[..., None], *operands: Parts) -> Parts:
    """Run ``function(*operand pieces, mantissas out, exponents out, work)`` over all pieces.

    Args:
        function: writes the rounded results of one piece into its output arrays, the range not
            yet checked. ``work`` is a float64 scratch array of four rows.
        operands: one-dimensional, of one length or of length 1.

    Raises:
        OverflowError: a result has an exponent above 99.
    """
    n = 1
    for m, _ in operands:
        n = n if m.size == 1 else m.size
    mantissas, exponents = np.empty(n, np.int32), np.empty(n, np.int16)
    work = np.empty((4, min(n, PIECE)))
    for start in range(0, n, PIECE):
        stop = min(start + PIECE, n)
        arguments = []
        for m, e in operands:
            arguments += [m, e] if m.size == 1 else [m[start:stop], e[start:stop]]
        m, e = mantissas[start:stop], exponents[start:stop]
        function(*arguments, m, e, work[:, : stop - start])
        in_range(m, e, start)
    return mantissas, exponents


def in_range(m: Mantissas, e: NDArray[Any], start: int = 0) -> None:
    """Bring one piece into the format: rounding up to 1e8, zero, underflow, overflow.

    Args:
        m: mantissas, corrected in place.
        e: exponents, corrected in place.
        start: index of the first element, for the message.
    """
    if m.size == 0:
        return
    if m.max() == HIGH or m.min() == -HIGH:
        up = np.flatnonzero(np.abs(m) == HIGH)
        m[up] = np.sign(m[up]) * LOW
        e[up] += 1
    if e.min() < -EXPONENT_MAX or e.max() > EXPONENT_MAX:
        zero = m == 0
        over = np.flatnonzero((e > EXPONENT_MAX) & ~zero)
        if over.size:
            i = int(over[0])
            raise OverflowError(
                f"element {start + i} has the exponent {int(e[i])}; 8-digit numbers end at 10^99"
            )
        under = (e < -EXPONENT_MAX) & ~zero
        if under.any():
            flag_underflow(int(np.count_nonzero(under)))
            m[under] = 0
        e[zero | under] = ZERO


def nearest(
    q: Floats, m: Mantissas, spare: Floats, exact: Callable[[NDArray[np.intp]], Any]
) -> None:
    """Round quotients to integers; those next to a tie are left to ``exact(indices)``.

    Args:
        q: magnitude below 1e8, wrong by less than `DOUBT`.
        m: receives the integers.
        spare: scratch; q is overwritten as well.
        exact: returns the right integers of the elements asked for.
    """
    np.rint(q, out=spare)
    np.copyto(m, spare, casting="unsafe")
    np.subtract(q, spare, out=q)
    if q.max() > 0.5 - DOUBT or q.min() < DOUBT - 0.5:
        hard = np.flatnonzero(np.abs(q) > 0.5 - DOUBT)
        m[hard] = exact(hard)


def _half_away(dividend: NDArray[np.int64], divisor: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return dividend / divisor > 0 in integers, ties away from zero."""
    size = np.abs(dividend)
    quotient: NDArray[np.int64] = np.sign(dividend) * ((size + divisor // 2) // divisor)
    return quotient


def _pick(a: NDArray[Any], i: NDArray[np.intp]) -> NDArray[np.int64]:
    return (np.broadcast_to(a, i.shape) if a.size == 1 else a[i]).astype(np.int64)


def multiply(a: Parts, b: Parts) -> Parts:
    """Return a * b."""
    return piecewise(_multiply, a, b)


def _multiply(
    am: Mantissas, ae: Exponents, bm: Mantissas, be: Exponents,
    m: Mantissas, e: Exponents, work: Floats,
) -> None:  # fmt: skip
    product, scaled, scale = work[0], work[1], work[2]
    np.copyto(product, am)
    np.copyto(scaled, bm)
    np.multiply(product, scaled, out=product)
    # 1e15 < 2^53: the comparison is exact though the larger products are not.
    np.abs(product, out=scaled)
    short = np.less(scaled, 1e15).view(np.int8)
    np.copyto(scale, short)
    np.multiply(scale, 9e-8, out=scale)
    np.add(scale, 1e-8, out=scale)
    np.multiply(product, scale, out=product)

    def exact(i: NDArray[np.intp]) -> Any:
        whole = _pick(am, i) * _pick(bm, i)
        return _half_away(whole, np.where(np.abs(whole) < 10**15, _TENS[7], _TENS[8]))

    nearest(product, m, scaled, exact)
    np.add(ae, be, out=e)
    np.subtract(e, short, out=e)


def divide(a: Parts, b: Parts) -> Parts:
    """Return a / b.

    Raises:
        ZeroDivisionError: a divisor is 0.
    """
    return piecewise(_divide, a, b)


def _divide(
    am: Mantissas, ae: Exponents, bm: Mantissas, be: Exponents,
    m: Mantissas, e: Exponents, work: Floats,
) -> None:  # fmt: skip
    if be.min() == ZERO:
        raise ZeroDivisionError("division by zero")
    quotient, scaled = work[0], work[1]
    np.copyto(quotient, am)
    np.copyto(scaled, bm)
    np.divide(quotient, scaled, out=quotient)
    np.abs(quotient, out=scaled)
    whole = np.greater_equal(scaled, 1.0).view(np.int8)
    np.copyto(scaled, whole)
    np.multiply(scaled, -9e7, out=scaled)
    np.add(scaled, 1e8, out=scaled)
    np.multiply(quotient, scaled, out=quotient)

    def exact(i: NDArray[np.intp]) -> Any:
        x, y = _pick(am, i), _pick(bm, i)
        scale = np.where(np.abs(x) >= np.abs(y), _TENS[7], _TENS[8])
        return _half_away(x * np.sign(y) * scale, np.abs(y))

    nearest(quotient, m, scaled, exact)
    np.subtract(ae, be, out=e)
    np.add(e, whole, out=e)


def square_root(a: Parts) -> Parts:
    """Return the square root of a.

    Raises:
        ValueError: a number is negative.
    """
    return piecewise(_square_root, a)


def _square_root(am: Mantissas, ae: Exponents, m: Mantissas, e: Exponents, work: Floats) -> None:
    if am.min() < 0:
        raise ValueError("square root of a negative number")
    root, scaled = work[0], work[1]
    odd = np.bitwise_and(ae, 1)
    _EIGHT_SEVEN.take(odd, out=scaled, mode="clip")
    np.multiply(am, scaled, out=root)  # below 1e16 and divisible by 2^7: exact
    np.sqrt(root, out=root)

    def exact(i: NDArray[np.intp]) -> Any:
        # (r + 1/2)^2 = r^2 + r + 1/4: no integer, so there are no ties.
        square = _pick(am, i) * _TENS[DIGITS - _pick(odd, i)]
        r = np.floor(np.sqrt(square.astype(np.float64))).astype(np.int64)
        r -= r * r > square
        return r + (square > r * r + r)

    nearest(root, m, scaled, exact)
    np.add(ae, odd, out=e)
    np.right_shift(e, 1, out=e)


def subtract(a: Parts, b: Parts) -> Parts:
    """Return a - b."""
    return piecewise(_add, a, (np.negative(b[0]), b[1]))


def add(a: Parts, b: Parts) -> Parts:
    """Return a + b."""
    return piecewise(_add, a, b)


def _add(
    am: Mantissas, ae: Exponents, bm: Mantissas, be: Exponents,
    m: Mantissas, e: Exponents, work: Floats,
) -> None:  # fmt: skip
    """Add in units of a tenth of the last digit of the operand with the larger exponent.

    There S = 10 hi + 10 lo / 10^d, one rounding in the quotient and one in the sum. It is rounded
    to 8 digits at 100, 10 or 1 of these units, where a tie is an integer or a half. If S is a tie,
    it is computed exactly. If not, it differs from one by at least 10^(1-d); against that the
    spacing of float64 is small enough for every d that comes near to a tie there (d <= 8 at tens,
    with |S| < 1.074e9 and spacing 1.2e-7; d = 9 only where |S| < 1e8, spacing 1.5e-8; from 10 on
    lo is below 0.1 units and decides nothing). So S is on its side of every tie, and the division
    by 10 or 100, rounded correctly, leaves it there. Below 1e7 there was cancellation, which
    needs d <= 1, and S is an exact integer of at most 8 digits.
    """
    s, t, other, d = work[0], work[1], work[2], work[3].view(np.int64)
    # Indices are brought into range first: `take` mispredicts the branch where it clips itself.
    np.subtract(ae, be, out=e)
    np.maximum(e, -FAR, out=e)
    np.minimum(e, FAR, out=e)
    np.add(e, FAR, out=d)
    np.multiply(am, 10.0, out=s)
    _ALIGN_FIRST.take(d, out=t, mode="clip")
    np.divide(s, t, out=s)
    np.multiply(bm, 10.0, out=other)
    _ALIGN_SECOND.take(d, out=t, mode="clip")
    np.divide(other, t, out=other)
    np.add(s, other, out=s)
    np.maximum(ae, be, out=e)

    np.abs(s, out=t)
    cancelled = np.less(t, 1e7)
    shift = np.add(np.greater_equal(t, 1e8).view(np.int8), np.greater_equal(t, 1e9).view(np.int8))
    if cancelled.any():
        few = np.flatnonzero(cancelled)
        exact = s[few].astype(np.int64)
        digits = np.searchsorted(_TENS[:DIGITS], np.abs(exact), side="right")
    _HUNDREDS.take(shift, out=t, mode="clip")
    np.divide(s, t, out=s)
    # trunc(2 s) - trunc(s) rounds ties away from zero.
    np.add(s, s, out=t)
    np.trunc(t, out=t)
    np.trunc(s, out=s)
    np.subtract(t, s, out=s)
    np.copyto(m, s, casting="unsafe")
    np.add(e, shift, out=e)
    np.subtract(e, 1, out=e)
    if cancelled.any():
        m[few] = exact * _TENS[DIGITS - digits]
        e[few] -= DIGITS - digits
        e[few[exact == 0]] = ZERO

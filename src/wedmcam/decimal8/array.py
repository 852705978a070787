"""Arrays of 8-digit decimal numbers, behind the face of a numpy array."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from decimal import Decimal
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.decimal8 import convert, functions, kernel
from wedmcam.decimal8.encoding import Floats, beside, floats, parts
from wedmcam.decimal8.methods import Methods
from wedmcam.decimal8.number_format import DIGITS, EXPONENT_MAX, HIGH, LOW, ZERO, unwatched
from wedmcam.decimal8.scalar import Decimal8, parts_of

#: Added to a copy: of the two zeros of float64 it leaves the one without a sign.
_PLUS_ZERO = np.array(0.0)


class Decimal8Array(Methods):
    """An array of 8-digit decimal floating-point numbers.

    Operators work element by element and broadcast as in numpy; each result is the exact one
    rounded once to 8 digits, ties away from zero. Python numbers, `Decimal8` and numpy arrays may
    stand on either side; they are rounded to 8 digits first, but compared as they are. Slices are
    views. numpy's functions work too: ``np.sqrt(a)``, ``np.where(c, a, b)``, ``np.concatenate``.

    Args:
        values: anything that `from_values` takes.

    >>> a = Decimal8Array([3, "0.1", 2.5])
    >>> (a * a + 16).tolist()
    [Decimal('25'), Decimal('16.01'), Decimal('22.25')]
    >>> np.sqrt(a)
    Decimal8Array(['1.7320508', '0.31622777', '1.5811388'])
    """

    __slots__ = ("_v",)
    #: The float64 nearest to each number; of zeros either.
    _v: Floats

    def __init__(self, values: Any = ()) -> None:
        self._v = self.from_values(values)._v

    # --- construction -----------------------------------------------------------------------

    @classmethod
    def _of(cls, values: Floats) -> Decimal8Array:
        self = cls.__new__(cls)
        self._v = values
        return self

    @classmethod
    def from_values(cls, values: Any) -> Decimal8Array:
        """Return an array of numbers or texts, each rounded once; floats at their exact value.

        Args:
            values: a numpy array of floats or integers, which is converted as a whole; a
                sequence, nested or not, of int, float, Decimal, str and Decimal8; or one of them.

        Raises:
            OverflowError: a number is 10^99 or more.
            ValueError: something is no number.
        """
        if isinstance(values, Decimal8Array):
            return values.copy()
        if isinstance(values, (Decimal8, int, float)):
            return cls._of(np.array(float(Decimal8(values))))
        if isinstance(values, (list, tuple)):
            kinds = set(map(type, values))
            if kinds == {float}:
                values = np.array(values)
            elif kinds == {int} and min(values) >= -(2**63) and max(values) < 2**63:
                values = np.array(values, np.int64)
        if isinstance(values, (np.ndarray, np.generic)):
            if values.dtype.kind == "f" and values.dtype.itemsize <= 8:
                return cls._of(convert.from_floats(np.asarray(values, np.float64)))
            if values.dtype.kind in "ib" or (values.dtype.kind == "u" and values.itemsize < 8):
                return cls._of(convert.from_integers(np.asarray(values, np.int64)))
        elif not isinstance(values, (Sequence, Decimal8)) and isinstance(values, Iterable):
            values = list(values)
        things = np.asarray(values, dtype=object)
        both = [parts_of(thing) for thing in things.reshape(-1).tolist()]
        m = np.array([part[0] for part in both], np.int64)
        e = np.array([part[1] for part in both], np.int64)
        return cls._of(floats(m, e).reshape(things.shape))

    @classmethod
    def from_parts(cls, mantissas: ArrayLike, exponents: ArrayLike) -> Decimal8Array:
        """Return the numbers ``mantissa * 10**(exponent - 8)``.

        Args:
            mantissas: signed integers of exactly 8 digits, or 0.
            exponents: -99 to 99; of zeros they do not matter.

        Raises:
            ValueError: a mantissa has not 8 digits, or an exponent is out of range.
        """
        m, e = np.broadcast_arrays(np.asarray(mantissas), np.asarray(exponents))
        size = np.abs(m)
        if ((m != 0) & ((size < LOW) | (size >= HIGH) | (np.abs(e) > EXPONENT_MAX))).any():
            raise ValueError("a mantissa has not 8 digits, or an exponent is beyond 99")
        return cls._of(floats(m.reshape(-1), e.reshape(-1)).reshape(m.shape))

    @classmethod
    def from_bytes(cls, data: bytes) -> Decimal8Array:
        """Return the numbers that BCD bytes hold, 6 each.

        Raises:
            ValueError: they are not as `to_bytes` writes them.
        """
        if len(data) % 6:
            raise ValueError(f"8-digit decimals are 6 bytes each; {len(data)} is no multiple")
        return cls._of(convert.from_bcd(np.frombuffer(data, np.uint8).reshape(-1, 6)))

    # --- conversion -------------------------------------------------------------------------

    def to_bytes(self) -> bytes:
        """Return 6 bytes of BCD a number, one after the other."""
        return convert.to_bcd(*parts(self._v.reshape(-1))).tobytes()

    def to_float(self) -> NDArray[np.float64]:
        """Return the float64 nearest to each value, as an array of its own."""
        return np.asarray(np.add(self._v, _PLUS_ZERO))

    def to_int(self) -> NDArray[np.int64]:
        """Return the nearest integers, ties away from zero.

        Raises:
            OverflowError: one is 10^18 or more.
        """
        whole = functions.whole(self._v, "away")
        if (np.abs(whole) >= 1e18).any():
            raise OverflowError("an integer of more than 18 digits")
        # An integer of 8 digits and up to ten zeros has 51 bits and ten zeros: an exact float64.
        return whole.astype(np.int64)

    def tolist(self) -> Any:
        """Return the exact values as (nested lists of) `decimal.Decimal`."""
        if self.ndim == 0:
            return self.item().decimal
        if self.ndim > 1:
            return [line.tolist() for line in self]
        m, e = parts(self._v)
        k = e - DIGITS
        for step in (4, 2, 1):  # zeros behind the point
            strip = (m % 10**step == 0) & (k <= -step)
            m, k = np.where(strip, m // 10**step, m), np.where(strip, k + step, k)
        k[m == 0] = 0
        return [Decimal(f"{n}E{power}") for n, power in zip(m.tolist(), k.tolist(), strict=True)]

    def item(self, *index: int) -> Decimal8:
        """Return one element; without an index, the only one."""
        return Decimal8._named(self._v.item(*index))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return float64; with ``dtype=object``, `Decimal8` numbers."""
        if dtype == np.dtype(object):
            out = np.empty(self.size, object)
            out[:] = list(self.ravel())
            return out.reshape(self.shape)
        return self.to_float().astype(np.float64 if dtype is None else dtype, copy=False)

    @property
    def mantissa(self) -> NDArray[np.int64]:
        """The signed significands as 8-digit integers."""
        return parts(self._v)[0]

    @property
    def exponent(self) -> NDArray[np.int64]:
        """The exponents of 0.dddddddd x 10^e, 0 for zero."""
        e = parts(self._v)[1]
        return np.where(e == ZERO, 0, e)

    # --- shape and elements -----------------------------------------------------------------

    @property
    def shape(self) -> tuple[int, ...]:
        """Length along each axis."""
        return self._v.shape

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self._v.ndim

    @property
    def size(self) -> int:
        """Number of elements."""
        return self._v.size

    @property
    def T(self) -> Decimal8Array:  # noqa: N802 (numpy's name)
        """The transposed array (a view)."""
        return self._of(self._v.T)

    def reshape(self, *shape: Any) -> Decimal8Array:
        """Return the elements in another shape."""
        return self._of(self._v.reshape(*shape))

    def ravel(self) -> Decimal8Array:
        """Return all elements along one axis."""
        return self.reshape(-1)

    def copy(self) -> Decimal8Array:
        """Return an array of its own."""
        return self._of(self._v.copy())

    def __len__(self) -> int:
        return len(self._v)

    def __iter__(self) -> Iterator[Any]:
        if self.ndim == 1:
            m, e = parts(self._v)
            for one, place in zip(m.tolist(), e.tolist(), strict=True):
                yield Decimal8._of(one, place)
        else:
            for i in range(len(self)):
                yield self[i]

    def __getitem__(self, index: Any) -> Any:
        values = self._v[index]
        if isinstance(values, np.ndarray):
            return self._of(values)
        return Decimal8._named(float(values))

    def __setitem__(self, index: Any, value: Any) -> None:
        self._v[index] = as_array(value)._v

    # --- arithmetic -------------------------------------------------------------------------

    def __add__(self, other: Any) -> Any:
        return binary(kernel.add, self, other)

    def __radd__(self, other: Any) -> Any:
        return binary(kernel.add, other, self)

    def __sub__(self, other: Any) -> Any:
        return binary(kernel.subtract, self, other)

    def __rsub__(self, other: Any) -> Any:
        return binary(kernel.subtract, other, self)

    def __mul__(self, other: Any) -> Any:
        return binary(kernel.multiply, self, other, kernel.multiply_short)

    def __rmul__(self, other: Any) -> Any:
        return binary(kernel.multiply, self, other, kernel.multiply_short)

    def __truediv__(self, other: Any) -> Any:
        return binary(kernel.divide, self, other, kernel.divide_short)

    def __rtruediv__(self, other: Any) -> Any:
        return binary(kernel.divide, other, self)

    def __pow__(self, other: Any) -> Any:
        if isinstance(other, int) and other == 2:
            return self * self
        return binary(functions.power, self, other)

    def __rpow__(self, other: Any) -> Any:
        return binary(functions.power, other, self)

    def __neg__(self) -> Decimal8Array:
        return self._of(np.negative(self._v))

    def __pos__(self) -> Decimal8Array:
        return self.copy()

    def __abs__(self) -> Decimal8Array:
        return self._of(np.abs(self._v))

    def __round__(self, ndigits: int | None = None) -> Any:
        """Round to whole numbers, or to ``ndigits`` places behind the point; ties away from 0."""
        return self.rint() if ndigits is None else np.round(self, ndigits)

    def sqrt(self) -> Decimal8Array:
        """Return the square root.

        Raises:
            ValueError: a number is negative.
        """
        return self._of(kernel.square_root(self._v))

    def _call(self, name: str, *others: Any) -> Decimal8Array:
        function = getattr(functions, name)
        if others:
            result: Decimal8Array = binary(function, self, *others)
            return result
        return self._of(function(self._v))

    def _whole(self, how: str) -> Decimal8Array:
        return self._of(functions.whole(self._v, how))

    def sum(self) -> Decimal8:
        """Return the sum of all elements, added one after the other from the left.

        Each addition rounds to 8 digits, as on the machine: the order matters, and long sums
        lose digits.

        >>> Decimal8Array([99999999, 0.4, 0.4]).sum(), Decimal8Array([0.4, 0.4, 99999999]).sum()
        (Decimal8('99999999'), Decimal8('1.0000000E+8'))
        """
        total = Decimal8(0)
        for x in self.reshape(-1):
            total = total + x
        return total

    def max(self) -> Decimal8:
        """Return the largest element."""
        return self.item(int(self._v.argmax()))

    def min(self) -> Decimal8:
        """Return the smallest element."""
        return self.item(int(self._v.argmin()))

    # --- comparison -------------------------------------------------------------------------

    def __eq__(self, other: object) -> Any:
        return compare(np.equal, self, other)

    def __ne__(self, other: object) -> Any:
        return compare(np.not_equal, self, other)

    def __lt__(self, other: Any) -> Any:
        return compare(np.less, self, other)

    def __le__(self, other: Any) -> Any:
        return compare(np.less_equal, self, other)

    def __gt__(self, other: Any) -> Any:
        return compare(np.greater, self, other)

    def __ge__(self, other: Any) -> Any:
        return compare(np.greater_equal, self, other)

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return bool(self._v != 0)

    def __repr__(self) -> str:
        texts = np.array(self.tolist(), object).astype(str)
        return f"Decimal8Array({texts.tolist()})"

    # --- numpy ------------------------------------------------------------------------------

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        from wedmcam.decimal8.protocol import ufunc_call

        return ufunc_call(ufunc, method, inputs, kwargs)

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        from wedmcam.decimal8.protocol import function_call

        return function_call(func, args, kwargs)


def as_array(value: Any) -> Decimal8Array:
    """Return an operand as an array; an array itself, not a copy."""
    return value if isinstance(value, Decimal8Array) else Decimal8Array.from_values(value)


def _operand(value: Any) -> bool:
    return isinstance(
        value, (Decimal8Array, Decimal8, int, float, Decimal, np.ndarray, np.number, list, tuple)
    )


def _constant(value: float) -> tuple[Floats, bool]:
    """Return a Python number as an operand, and whether it has at most 5 digits."""
    if -1e-99 < value < 1e-99 and value:
        return _remembered.__wrapped__(value)  # an underflow is flagged each time
    return _remembered(value)


@lru_cache(maxsize=256)
def _remembered(value: float) -> tuple[Floats, bool]:
    rounded = Decimal8(value)
    return np.array(float(rounded)), rounded.mantissa % 1000 == 0


def binary(function: Any, a: Any, b: Any, short: Any = None) -> Any:
    """Return function(a, b), broadcast; at least one of them is a `Decimal8Array`.

    Args:
        function: of floats that name numbers.
        a: an operand.
        b: another.
        short: the function to take where b is a Python number of at most 5 digits.
    """
    if type(b) is Decimal8Array:
        y = b._v
    elif type(b) is int or type(b) is float:
        y, few = _constant(b)
        if few and short is not None:
            function = short
    elif _operand(b):
        y = as_array(b)._v
    else:
        return NotImplemented
    if type(a) is Decimal8Array:
        x = a._v
    elif type(a) is int or type(a) is float:
        x = _constant(a)[0]
    elif _operand(a):
        x = as_array(a)._v
    else:
        return NotImplemented
    return Decimal8Array._of(function(x, y))


# --- comparison -----------------------------------------------------------------------------


def compare(relation: Any, a: Decimal8Array, other: Any) -> Any:
    """Return where the relation holds; floats and long integers count at their exact value.

    A number that is no 8-digit one lies between two of them: it is compared as the 8-digit number
    that it rounds to, and where that is equal, by what the rounding lost.
    """
    if type(other) is Decimal8Array:
        return relation(a._v, other._v)
    if type(other) is int or type(other) is float or isinstance(other, Decimal8):
        near, rest = _apart(other)
        if rest == 0:
            return relation(a._v, near)
        return _relations(relation, rest)(a._v, near)
    if not _operand(other):
        return NotImplemented
    if isinstance(other, (np.ndarray, np.generic)) and other.dtype.kind in "fib":
        things, rests = _all_apart(np.asarray(other))
    else:
        objects = np.asarray(other, dtype=object)
        pairs = [_apart(x) for x in objects.reshape(-1).tolist()]
        things = np.array([x.item() for x, _ in pairs]).reshape(objects.shape)
        rests = np.array([rest for _, rest in pairs]).reshape(objects.shape)
    if not rests.any():
        return relation(a._v, things)
    below, above = _relations(relation, -1), _relations(relation, 1)
    return np.where(
        rests == 0,
        relation(a._v, things),
        np.where(rests < 0, below(a._v, things), above(a._v, things)),
    )


#: What a relation to x is as one to the 8-digit number next to x: next below, next above it.
_STRICTER: dict[Any, tuple[Any, Any]] = {
    np.less: (np.less, np.less_equal),
    np.less_equal: (np.less, np.less_equal),
    np.greater: (np.greater_equal, np.greater),
    np.greater_equal: (np.greater_equal, np.greater),
}


def _relations(relation: Any, rest: int) -> Callable[[Floats, Any], Any]:
    """Return the relation to a number that lies on the side ``rest`` of an 8-digit one."""
    if relation in _STRICTER:
        return _STRICTER[relation][rest > 0]  # type: ignore[no-any-return]
    return lambda values, near: np.full(
        np.broadcast_shapes(values.shape, near.shape), relation is np.not_equal
    )


@lru_cache(maxsize=256)
def _apart(x: Any) -> tuple[Floats, int]:
    """Return the 8-digit number that x rounds to, and on which side of it x lies.

    What has no 8-digit number near it is infinite here, and NaN is NaN.
    """
    if isinstance(x, Decimal8):
        return np.array(float(x)), 0
    if x != x:
        return np.array(np.nan), 0
    try:
        with unwatched():
            rounded = Decimal8(x)
    except OverflowError:
        return np.array(np.inf if x > 0 else -np.inf), 0
    return np.array(float(rounded)), int(rounded < x) - int(rounded > x)


def _all_apart(x: NDArray[Any]) -> tuple[Floats, NDArray[Any]]:
    """Return `_apart` of a numpy array of floats or integers."""
    if x.dtype.kind != "f":
        wide = x.astype(np.int64)
        named = convert.from_integers(wide)
        # Rounded, integers below 2^63 stay below it, and have 53 bits and zeros behind them.
        return named, np.sign(wide - named.astype(np.int64))
    values = x.astype(np.float64)
    usual = np.abs(values) < 9e98  # others, NaN among them, one by one
    with unwatched():
        named = convert.from_floats(np.where(usual, values, 0.0))
    rests = np.sign(np.where(usual, values - named, 0.0)).astype(np.int64)
    # The float that names a number need not be equal to it.
    same = np.flatnonzero((values == named) & (named != 0))
    rests.flat[same] = beside(named.ravel()[same])
    for i in np.flatnonzero(~usual):
        near, rests.flat[i] = _apart(float(values.flat[i]))
        named.flat[i] = near.item()
    return named, rests

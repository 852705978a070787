"""Arrays of 8-digit decimal numbers: a mantissa array and an exponent array behind one face."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.decimal8 import convert, functions, kernel
from wedmcam.decimal8.form import DIGITS, EXPONENT_MAX, HIGH, LOW, ZERO
from wedmcam.decimal8.kernel import Exponents, Mantissas, Parts
from wedmcam.decimal8.methods import Methods
from wedmcam.decimal8.scalar import Decimal8, parts_of


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

    __slots__ = ("_e", "_m")
    _m: Mantissas
    _e: Exponents

    def __init__(self, values: Any = ()) -> None:
        other = self.from_values(values)
        self._m, self._e = other._m, other._e

    # --- construction -----------------------------------------------------------------------

    @classmethod
    def _of(cls, parts: Parts, shape: tuple[int, ...] | None = None) -> Decimal8Array:
        self = cls.__new__(cls)
        self._m, self._e = parts
        if shape is not None and self._m.shape != shape:
            self._m, self._e = self._m.reshape(shape), self._e.reshape(shape)
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
            one, place = parts_of(values)
            return cls._of((np.array(one, np.int32), np.array(place, np.int16)))
        if isinstance(values, (list, tuple)):
            kinds = set(map(type, values))
            if kinds == {float}:
                values = np.array(values)
            elif kinds == {int} and min(values) >= -(2**63) and max(values) < 2**63:
                values = np.array(values, np.int64)
        if isinstance(values, (np.ndarray, np.generic)):
            if values.dtype.kind == "f" and values.dtype.itemsize <= 8:
                flat = np.ascontiguousarray(values, np.float64).reshape(-1)
                return cls._of(convert.from_floats(flat), values.shape)
            if values.dtype.kind in "ib" or (values.dtype.kind == "u" and values.itemsize < 8):
                flat_i = np.ascontiguousarray(values, np.int64).reshape(-1)
                return cls._of(convert.from_integers(flat_i), values.shape)
        elif not isinstance(values, (Sequence, Decimal8)) and isinstance(values, Iterable):
            values = list(values)
        things = np.asarray(values, dtype=object)
        parts = [parts_of(thing) for thing in things.reshape(-1).tolist()]
        m = np.array([part[0] for part in parts], np.int32)
        e = np.array([part[1] for part in parts], np.int16)
        return cls._of((m, e), things.shape)

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
        return cls._of((m.astype(np.int32), np.where(m == 0, ZERO, e).astype(np.int16)))

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
        return convert.to_bcd(*self._flat()).tobytes()

    def to_float(self) -> NDArray[np.float64]:
        """Return the float64 nearest to each value."""
        return convert.to_floats(*self._flat()).reshape(self.shape)

    def to_int(self) -> NDArray[np.int64]:
        """Return the nearest integers, ties away from zero.

        Raises:
            OverflowError: one is 10^18 or more.
        """
        whole = self.rint()
        if (whole._e > 18).any():
            raise OverflowError("an integer of more than 18 digits")
        k = np.where(whole._m == 0, 0, whole._e).astype(np.int64) - DIGITS
        tens = 10 ** np.abs(k)
        integers: NDArray[np.int64] = np.where(k >= 0, whole._m * tens, whole._m // tens)
        return integers

    def tolist(self) -> Any:
        """Return the exact values as (nested lists of) `decimal.Decimal`."""
        if self.ndim == 0:
            return self.item().decimal
        return [x.tolist() if isinstance(x, Decimal8Array) else x.decimal for x in self]

    def item(self, *index: int) -> Decimal8:
        """Return one element; without an index, the only one."""
        return Decimal8._of(int(self._m.item(*index)), int(self._e.item(*index)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return float64; with ``dtype=object``, `Decimal8` numbers."""
        if dtype == np.dtype(object):
            out = np.empty(self.size, object)
            out[:] = [self.reshape(-1).item(i) for i in range(self.size)]
            return out.reshape(self.shape)
        return self.to_float().astype(np.float64 if dtype is None else dtype, copy=False)

    @property
    def mantissa(self) -> Mantissas:
        """The signed significands as 8-digit integers (a copy)."""
        return self._m.copy()

    @property
    def exponent(self) -> Exponents:
        """The exponents of 0.dddddddd x 10^e, 0 for zero (a copy)."""
        return np.where(self._m == 0, np.int16(0), self._e)

    # --- shape and elements -----------------------------------------------------------------

    @property
    def shape(self) -> tuple[int, ...]:
        """Length along each axis."""
        return self._m.shape

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self._m.ndim

    @property
    def size(self) -> int:
        """Number of elements."""
        return self._m.size

    @property
    def T(self) -> Decimal8Array:  # noqa: N802 (numpy's name)
        """The transposed array (a view)."""
        return self._of((self._m.T, self._e.T))

    def reshape(self, *shape: Any) -> Decimal8Array:
        """Return the elements in another shape."""
        return self._of((self._m.reshape(*shape), self._e.reshape(*shape)))

    def ravel(self) -> Decimal8Array:
        """Return all elements along one axis."""
        return self.reshape(-1)

    def copy(self) -> Decimal8Array:
        """Return an array of its own."""
        return self._of((self._m.copy(), self._e.copy()))

    def __len__(self) -> int:
        return len(self._m)

    def __iter__(self) -> Iterator[Any]:
        if self.ndim == 1:
            for m, e in zip(self._m.tolist(), self._e.tolist(), strict=True):
                yield Decimal8._of(m, e)
        else:
            for i in range(len(self)):
                yield self[i]

    def __getitem__(self, index: Any) -> Any:
        m, e = self._m[index], self._e[index]
        if isinstance(m, np.ndarray):
            return self._of((m, e))
        return Decimal8._of(int(m), int(e))

    def __setitem__(self, index: Any, value: Any) -> None:
        new = as_array(value)
        self._m[index], self._e[index] = new._m, new._e

    # --- arithmetic -------------------------------------------------------------------------

    def _flat(self) -> Parts:
        return self._m.reshape(-1), self._e.reshape(-1)

    def __add__(self, other: Any) -> Any:
        return binary(kernel.add, self, other)

    def __radd__(self, other: Any) -> Any:
        return binary(kernel.add, other, self)

    def __sub__(self, other: Any) -> Any:
        return binary(kernel.subtract, self, other)

    def __rsub__(self, other: Any) -> Any:
        return binary(kernel.subtract, other, self)

    def __mul__(self, other: Any) -> Any:
        return binary(kernel.multiply, self, other)

    def __rmul__(self, other: Any) -> Any:
        return binary(kernel.multiply, other, self)

    def __truediv__(self, other: Any) -> Any:
        return binary(kernel.divide, self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return binary(kernel.divide, other, self)

    def __pow__(self, other: Any) -> Any:
        if isinstance(other, int) and other == 2:
            return self * self
        return binary(functions.power, self, other)

    def __rpow__(self, other: Any) -> Any:
        return binary(functions.power, other, self)

    def __neg__(self) -> Decimal8Array:
        return self._of((-self._m, self._e.copy()))

    def __pos__(self) -> Decimal8Array:
        return self.copy()

    def __abs__(self) -> Decimal8Array:
        return self._of((np.abs(self._m), self._e.copy()))

    def sqrt(self) -> Decimal8Array:
        """Return the square root.

        Raises:
            ValueError: a number is negative.
        """
        return self._of(kernel.square_root(self._flat()), self.shape)

    def _call(self, name: str, *others: Any) -> Decimal8Array:
        function = getattr(functions, name)
        if others:
            result: Decimal8Array = binary(function, self, *others)
            return result
        return self._of(function(self._flat()), self.shape)

    def _whole(self, how: str) -> Decimal8Array:
        return self._of(functions.whole(self._flat(), how), self.shape)

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
        return self.reshape(-1).item(int(self.key().argmax()))

    def min(self) -> Decimal8:
        """Return the smallest element."""
        return self.reshape(-1).item(int(self.key().argmin()))

    # --- comparison -------------------------------------------------------------------------

    def key(self) -> NDArray[np.int64]:
        """Return integers in the same order as the values, equal where these are equal."""
        place = (self._e.astype(np.int64) + 2 * EXPONENT_MAX) * HIGH
        return self._m + np.sign(self._m).astype(np.int64) * place

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
        return bool(self._m != 0)

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


def binary(function: Any, a: Any, b: Any) -> Any:
    """Return function(a, b), broadcast; at least one of them is a `Decimal8Array`."""
    if not (_operand(a) and _operand(b)):
        return NotImplemented
    a, b = as_array(a), as_array(b)
    # One number beside an array stays one: the kernels broadcast it piece by piece.
    if a.shape == b.shape or (b.size == 1 and b.ndim <= a.ndim):
        shape = a.shape
    elif a.size == 1 and a.ndim <= b.ndim:
        shape = b.shape
    else:
        shape = np.broadcast_shapes(a.shape, b.shape)
        a, b = (
            x
            if x.size == 1
            else Decimal8Array._of((np.broadcast_to(x._m, shape), np.broadcast_to(x._e, shape)))
            for x in (a, b)
        )
    return Decimal8Array._of(function(a._flat(), b._flat()), shape)


def compare(relation: Any, a: Decimal8Array, other: Any) -> Any:
    """Return where the relation holds; floats and long integers count at their exact value."""
    if isinstance(other, Decimal8Array):
        return relation(a.key(), other.key())
    if isinstance(other, Decimal8):
        return relation(a.key(), as_array(other).key())
    if not _operand(other):
        return NotImplemented
    if isinstance(other, (np.ndarray, np.generic)) and other.dtype.kind in "fiub":
        keys, nan = _doubled_keys(np.asarray(other))
    else:
        things = np.asarray(other, dtype=object)
        flat = things.reshape(-1).tolist()
        keys = np.array([_doubled_key(x) for x in flat], np.int64).reshape(things.shape)
        nan = np.array([x != x for x in flat], bool).reshape(things.shape)
    return relation(2 * a.key(), keys) & ~nan | nan & (relation is np.not_equal)


def _doubled_key(x: Any) -> int:
    """Return twice the `Decimal8Array.key` of a number, plus or minus 1 for what is lost.

    Rounding a number leaves its order to every 8-digit number but the one that it is rounded to;
    there what was lost decides, and doubled keys leave room for it.
    """
    if x != x:
        return 0
    try:
        rounded = Decimal8(x)
    except OverflowError:
        return 2**62 if x > 0 else -(2**62)
    rest = int(rounded < x) - int(rounded > x)
    return 2 * int(as_array(rounded).key()) + rest


def _doubled_keys(x: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return `_doubled_key` of a numpy array, and where it is NaN."""
    if x.dtype.kind != "f":
        rounded = as_array(x)
        rest = np.sign(x.astype(np.int64) - rounded.to_int()) if x.dtype.kind != "b" else 0
        return 2 * rounded.key() + rest, np.zeros(x.shape, bool)
    flat = x.astype(np.float64).reshape(-1)
    nan = np.isnan(flat)
    large = np.abs(flat) >= 9e98
    near = np.where(nan | large, 0.0, flat)
    rounded = as_array(near)
    back = rounded.to_float()
    keys = 2 * rounded.key() + np.sign(near - back).astype(np.int64)
    # A float next to an 8-digit number need not be equal to it: it is if the number is a binary
    # fraction, and at most 10^11 times its mantissa. The few others are looked at exactly.
    k = np.where(rounded._m == 0, 0, rounded._e).astype(np.int64) - DIGITS
    fraction = (k < -11) | (rounded._m % 5 ** np.clip(-k, 0, 11) != 0)
    doubtful = (near == back) & (rounded._m != 0) & (fraction | (k > 11)) | large
    for i in np.flatnonzero(doubtful & ~nan):
        keys[i] = _doubled_key(float(flat[i]))
    return keys.reshape(x.shape), nan.reshape(x.shape)

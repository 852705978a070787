"""numpy's own functions on 8-digit numbers: ``np.sqrt(a)``, ``np.where(c, a, b)``, ...

What numpy calls by another name is in two tables. A function that is in neither raises TypeError:
better than a silent change to float64.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from wedmcam.decimal8.array import Decimal8Array, as_array, compare
from wedmcam.decimal8.scalar import Decimal8

_UNARY: dict[Any, Callable[[Decimal8Array], Any]] = {
    np.negative: operator.neg,
    np.positive: operator.pos,
    np.absolute: abs,
    np.fabs: abs,
    np.sqrt: Decimal8Array.sqrt,
    np.square: lambda a: a * a,
    np.reciprocal: lambda a: 1 / a,
    np.sin: Decimal8Array.sin,
    np.cos: Decimal8Array.cos,
    np.tan: Decimal8Array.tan,
    np.arcsin: Decimal8Array.asin,
    np.arccos: Decimal8Array.acos,
    np.arctan: Decimal8Array.atan,
    np.radians: Decimal8Array.to_radians,
    np.deg2rad: Decimal8Array.to_radians,
    np.degrees: Decimal8Array.to_degrees,
    np.rad2deg: Decimal8Array.to_degrees,
    np.rint: Decimal8Array.rint,
    np.floor: Decimal8Array.floor,
    np.ceil: Decimal8Array.ceil,
    np.trunc: Decimal8Array.trunc,
    np.sign: lambda a: Decimal8Array._of(np.sign(a._v)),
    np.signbit: lambda a: a._v < 0,
    np.isfinite: lambda a: np.ones(a.shape, bool),
    np.isnan: lambda a: np.zeros(a.shape, bool),
    np.isinf: lambda a: np.zeros(a.shape, bool),
}
_BINARY: dict[Any, Callable[[Decimal8Array, Decimal8Array], Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.true_divide: operator.truediv,
    np.power: operator.pow,
    np.float_power: operator.pow,
    np.hypot: Decimal8Array.hypot,
    np.arctan2: Decimal8Array.atan2,
    np.maximum: lambda a, b: where(a >= b, a, b),
    np.minimum: lambda a, b: where(a <= b, a, b),
    np.fmax: lambda a, b: where(a >= b, a, b),
    np.fmin: lambda a, b: where(a <= b, a, b),
}
_MIRRORED = {
    np.equal: np.equal,
    np.not_equal: np.not_equal,
    np.less: np.greater,
    np.less_equal: np.greater_equal,
    np.greater: np.less,
    np.greater_equal: np.less_equal,
}


def ufunc_call(ufunc: Any, method: str, inputs: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    """Do what ``__array_ufunc__`` is asked for; results of scalars are scalars."""
    if method == "reduce" and ufunc is np.add and set(kwargs) <= {"axis"}:
        return sum_(inputs[0], **kwargs)
    out = kwargs.pop("out", None)
    if method != "__call__" or kwargs:
        return NotImplemented
    if ufunc in _UNARY:
        result = _UNARY[ufunc](as_array(inputs[0]))
    elif ufunc in _BINARY:
        result = _BINARY[ufunc](as_array(inputs[0]), as_array(inputs[1]))
    elif ufunc in _MIRRORED:
        a, b = inputs
        if isinstance(a, (Decimal8Array, Decimal8)):
            result = compare(ufunc, as_array(a), b)
        else:
            result = compare(_MIRRORED[ufunc], as_array(b), a)
    else:
        return NotImplemented
    if out is not None:
        out[0][...] = result
        return out[0]
    if isinstance(result, Decimal8Array) and result.ndim == 0:
        return result.item()
    return result


def where(condition: Any, a: Any, b: Any) -> Decimal8Array:
    """Return a where the condition holds, else b.

    >>> where([True, False], Decimal8Array([1, 2]), 0)
    Decimal8Array(['1', '0'])
    """
    a, b = as_array(a), as_array(b)
    return Decimal8Array._of(np.where(condition, a._v, b._v))


def sum_(a: Any, axis: Any = None) -> Any:
    """Return `Decimal8Array.sum`; along an axis the same for each line."""
    a = as_array(a)
    if axis is None or a.ndim == 1:
        return a.sum()
    lines = np.moveaxis(a._v, axis, 0)
    total = as_array(np.zeros(lines.shape[1:]))
    for line in lines:
        total = total + Decimal8Array._of(line)
    return total


def _array_equal(a: Any, b: Any) -> bool:
    a, b = as_array(a), as_array(b)
    return a.shape == b.shape and bool((a._v == b._v).all())


def _filled(value: int) -> Callable[..., Decimal8Array]:
    def like(a: Decimal8Array) -> Decimal8Array:
        return as_array(np.full(a.shape, value))

    return like


def _where(condition: Any, *both: Any) -> Any:
    if isinstance(condition, Decimal8Array):
        condition = condition._v != 0
    return where(condition, *both) if both else np.where(condition)


def _round(a: Decimal8Array, decimals: int = 0) -> Decimal8Array:
    if decimals == 0:
        return a.rint()
    return as_array([round(x, decimals) for x in a.ravel()]).reshape(a.shape)


_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.sum: sum_,
    np.max: lambda a: a.max(),
    np.min: lambda a: a.min(),
    np.array_equal: _array_equal,
    np.round: _round,
    np.around: _round,
    np.zeros_like: _filled(0),
    np.ones_like: _filled(1),
    np.full_like: lambda a, value: Decimal8Array._of(np.full(a.shape, as_array(value)._v)),
    np.shape: lambda a: a.shape,
    np.ndim: lambda a: a.ndim,
    np.size: lambda a: a.size,
    np.argsort: lambda a, **how: np.argsort(a._v, **how),
    np.argmax: lambda a, **how: np.argmax(a._v, **how),
    np.argmin: lambda a, **how: np.argmin(a._v, **how),
    np.sort: lambda a: a[np.argsort(a._v, kind="stable")],
    np.clip: lambda a, low, high: np.minimum(np.maximum(a, low), high),
    np.count_nonzero: lambda a: np.count_nonzero(a._v),
    np.flatnonzero: lambda a: np.flatnonzero(a._v),
    np.diff: lambda a: a[1:] - a[:-1],
}
#: Functions that only move elements.
_MOVING = {
    np.concatenate, np.stack, np.hstack, np.vstack, np.column_stack, np.append, np.insert,
    np.delete, np.reshape, np.ravel, np.transpose, np.squeeze, np.expand_dims,
    np.moveaxis, np.swapaxes, np.atleast_1d, np.atleast_2d, np.broadcast_to,
    np.flip, np.roll, np.rot90, np.repeat, np.tile, np.take, np.copy, np.compress, np.choose,
}  # fmt: skip


def function_call(function: Any, args: Any, kwargs: Any) -> Any:
    """Do what ``__array_function__`` is asked for."""
    if function in _FUNCTIONS:
        return _FUNCTIONS[function](*args, **kwargs)
    if function in _MOVING:
        plain = {np.concatenate, np.stack, np.hstack, np.vstack, np.column_stack}
        if function in plain:
            args = ([as_array(x) for x in args[0]], *args[1:])
        elif function is np.append:
            args = (as_array(args[0]), as_array(args[1]), *args[2:])
        elif function is np.insert:
            args = (*args[:2], as_array(args[2]), *args[3:])
        return Decimal8Array._of(function(*_plain(args), **kwargs))
    return NotImplemented


def _plain(args: Any) -> Any:
    if isinstance(args, Decimal8Array):
        return args._v
    if isinstance(args, (tuple, list)):
        return type(args)(_plain(x) for x in args)
    return args

"""Every operation against `decimal` and mpmath on 20,000 operands; the scalar against the array.

The operands and references are those of benchmarks/prove_decimal8.py, which runs the million.
mpmath sees a sample of some hundred; the rest of a sine is held against 64-bit long doubles.
"""

import importlib.util
import operator
from decimal import ROUND_HALF_UP, Context, Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam.decimal8 import Decimal8, Decimal8Array, functions, kernel, rounding

_PATH = Path(__file__).parents[2] / "benchmarks" / "prove_decimal8.py"
_SPEC = importlib.util.spec_from_file_location("prove_decimal8", _PATH)
prove = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(prove)

EIGHT = Context(prec=8, rounding=ROUND_HALF_UP)


@pytest.mark.parametrize("name", prove.OPERATIONS)
def test_identical_to_the_reference(name):
    count = 5_000 if name.startswith("ones_") else 20_000  # arrays of one element, one by one
    assert prove.differences(name, count, seed=83) == []


def test_a_rounding_that_knows_no_doubt_is_found_out(monkeypatch):
    """What the references are for: each of these is wrong in one result of some thousand."""
    monkeypatch.setattr(rounding, "_SURE", 0.6)
    for name in ("add_parts", "mul", "div", "div_short", "sqrt", "acos", "from_float"):
        assert prove.differences(name, 20_000, seed=83), name


def test_ties_rounded_to_even_are_found_out(monkeypatch):
    monkeypatch.setattr(rounding, "_NEAR", np.array(0.0))
    for name in ("add_parts", "sub_parts", "mul_short", "div_short"):
        assert prove.differences(name, 60_000, seed=83), name


def test_sums_next_to_a_tie_that_are_none_are_found_out(monkeypatch):
    monkeypatch.setattr(kernel, "_alike", lambda *_: True)
    assert prove.differences("add_parts", 20_000, seed=83)


def test_digits_lost_next_to_a_power_of_ten_are_found_out(monkeypatch):
    monkeypatch.setattr(rounding, "_LAST", 1e9)
    assert prove.differences("add", 20_000, seed=83)
    assert prove.differences("sub", 20_000, seed=83)


def test_angles_taken_for_their_floats_are_found_out(monkeypatch):
    monkeypatch.setattr(functions, "_turning", np.zeros_like)
    monkeypatch.setattr(functions, "_turning_degrees", np.zeros_like)
    for name in ("sin", "cos", "tan", "sin_degrees"):
        assert prove.differences(name, 20_000, seed=83), name


@st.composite
def numbers(draw, span=40):
    m = draw(
        st.one_of(
            st.integers(10**7, 10**8 - 1),
            st.integers(1, 999).map(lambda n: n * 10 ** (8 - len(str(n)))),
            st.sampled_from([10**7, 10**7 + 1, 10**8 - 1, 5 * 10**7]),
        )
    )
    e = draw(st.integers(-span, span))
    sign = draw(st.sampled_from([1, 1, -1, -1, 0]))
    return Decimal8(Decimal(sign * m).scaleb(e - 8))


@pytest.mark.parametrize("name", ["add", "subtract", "multiply", "divide"])
@given(a=numbers(), b=numbers())
@settings(max_examples=150, deadline=None)
def test_scalar_equals_array_equals_decimal(name, a, b):
    operation = getattr(operator, {"multiply": "mul", "divide": "truediv"}.get(name, name[:3]))
    if name == "divide" and b == 0:
        b = Decimal8(3)
    one = operation(a, b)
    assert operation(Decimal8Array([a]), Decimal8Array([b]))[0] == one
    assert getattr(EIGHT, name)(a.decimal, b.decimal) == one.decimal


@given(a=numbers(span=99))
@settings(max_examples=300, deadline=None)
def test_round_trips(a):
    assert Decimal8.from_bytes(a.to_bytes()) == a
    assert Decimal8(str(a)) == a
    assert Decimal8(a.decimal) == a
    assert Decimal8(float(a)) == a
    array = Decimal8Array([a, a])
    assert array.to_bytes() == 2 * a.to_bytes()
    assert np.array_equal(Decimal8Array.from_bytes(array.to_bytes()), array)
    assert np.array_equal(Decimal8Array(array.to_float()), array)
    assert array.to_float()[1] == float(a)


@given(a=numbers(), x=st.one_of(st.floats(allow_nan=False), st.integers(-(10**20), 10**20)))
@settings(max_examples=300, deadline=None)
def test_comparison_with_numbers_is_exact(a, x):
    for relation in (operator.lt, operator.le, operator.eq, operator.ne, operator.gt, operator.ge):
        expected = relation(a.decimal, Decimal(x))
        assert relation(a, x) == expected
        assert relation(Decimal8Array([a]), x).tolist() == [expected]
        if isinstance(x, float):
            assert relation(Decimal8Array([a]), np.array([x])).tolist() == [expected]
            # The float next to a is nearly, and mostly not quite, a itself.
            near = float(a)
            expected = relation(a.decimal, Decimal(near))
            assert relation(Decimal8Array([a]), np.array([near])).tolist() == [expected]


@given(x=st.floats(allow_nan=False, allow_infinity=False, max_value=1e98, min_value=-1e98))
@settings(max_examples=300, deadline=None)
def test_floats_count_at_their_exact_value(x):
    expected = EIGHT.plus(Decimal(x))
    if abs(expected) < Decimal("1e-100"):
        expected = Decimal(0)
    assert Decimal8(x).decimal == expected
    assert Decimal8Array(np.array([x, x])).tolist() == [expected] * 2


@given(n=st.integers(-(2**63), 2**63 - 1))
@settings(max_examples=300, deadline=None)
def test_integers_round_once(n):
    expected = EIGHT.plus(Decimal(n))
    assert Decimal8(n).decimal == expected
    assert Decimal8Array(np.array([n, n])).tolist() == [expected] * 2


def test_square_roots_of_scalars():
    rng = np.random.default_rng(4)
    a = abs(prove.operands(rng, 2000, -99, 99))
    assert [x.sqrt() for x in a] == list(np.sqrt(a))

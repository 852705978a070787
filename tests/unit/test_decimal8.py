"""The format, its limits, and the faces of `Decimal8` and `Decimal8Array`."""

import copy
import pickle
from decimal import ROUND_HALF_UP, Context, Decimal

import numpy as np
import pytest

from wedmcam.decimal8 import (
    DECIMAL8,
    Decimal8,
    Decimal8Array,
    atan2,
    hypot,
    sin,
    sqrt,
    watch,
    where,
)

EIGHT = Context(prec=8, rounding=ROUND_HALF_UP)
PAPER = bytes.fromhex("110713625000")  # -13.625e-9, Sun Yat-sen University 1983


def text(a):
    return [str(x) for x in a]


# --- bytes ------------------------------------------------------------------------------------


def test_the_papers_example():
    assert Decimal8("-13.625e-9").to_bytes() == PAPER
    assert Decimal8.from_bytes(PAPER).decimal == Decimal("-13.625e-9")
    assert (Decimal8("-13.625e-9").mantissa, Decimal8("-13.625e-9").exponent) == (-13625000, -7)


@pytest.mark.parametrize(
    ("value", "data"),
    [
        ("0", "00 00 00 00 00 00"),
        ("1", "00 01 10 00 00 00"),
        ("-0.5", "10 00 50 00 00 00"),
        ("99999999e91", "00 99 99 99 99 99"),
        ("-1e-100", "11 99 10 00 00 00"),
        ("12345678", "00 08 12 34 56 78"),
    ],
)
def test_bytes_both_ways(value, data):
    data = bytes.fromhex(data)
    assert Decimal8(value).to_bytes() == data
    assert Decimal8.from_bytes(data) == Decimal8(value)
    assert Decimal8Array([value, 1, value]).to_bytes() == data + Decimal8(1).to_bytes() + data
    assert Decimal8Array.from_bytes(2 * data).tolist() == [Decimal(value)] * 2


@pytest.mark.parametrize(
    "data",
    [
        "00 01 10 00 00 0A",  # a half byte that is no digit
        "20 01 10 00 00 00",  # a sign that is none
        "02 01 10 00 00 00",
        "00 A1 10 00 00 00",
        "00 01 01 00 00 00",  # not normalised
        "10 00 00 00 00 00",  # minus zero
        "00 05 00 00 00 00",  # zero with an exponent
        "01 00 10 00 00 00",  # exponent minus zero
        "00 01 10 00 00",
        "00 01 10 00 00 00 00",
    ],
)
def test_bytes_that_are_no_number(data):
    with pytest.raises(ValueError, match=r"8-digit"):
        Decimal8.from_bytes(bytes.fromhex(data))
    with pytest.raises(ValueError, match=r"8-digit"):
        Decimal8Array.from_bytes(bytes.fromhex(data))


# --- construction -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0, "0"),
        (-7, "-7"),
        (123456785, "123456790"),  # ties go away from zero
        (-123456785, "-123456790"),
        (123456784, "123456780"),
        (999999995, "1e9"),
        (2**63 - 1, "9.2233720e18"),
        (-(2**63), "-9.2233720e18"),
        (0.1, "0.1"),
        (-0.0, "0"),
        (12345678.5, "12345679"),
        (-12345678.5, "-12345679"),
        (1.00000005, "1"),  # the float is 1.0000000499999999...
        (1.0000000500000001, "1.0000001"),
        (123456785.0, "123456790"),
        (5e-324, "0"),
        (9.9999999e98, "9.9999999e98"),
        (1e22, "1e22"),
        (1e23, "1e23"),
        ("1.23456785", "1.2345679"),
        ("1.23456784999999999999999999999999999999", "1.2345678"),
        ("1.23456785000000000000000000000000000001", "1.2345679"),
        ("  -2.5E+3 ", "-2500"),
        (Decimal("99999999.4999"), "99999999"),
        (Decimal("99999999.5"), "1e8"),
        (True, "1"),
        (np.float32(0.1), "0.1"),
        (np.int16(-300), "-300"),
        (Decimal8("2.5"), "2.5"),
    ],
)
def test_construction(value, expected):
    assert Decimal8(value).decimal == Decimal(expected)
    assert Decimal8Array([value]).tolist() == [Decimal(expected)]
    if isinstance(value, (int, float, np.generic)):
        assert Decimal8Array(np.array([value])).tolist() == [Decimal(expected)]


@pytest.mark.parametrize(
    "value",
    ["1e99", 1e99, 10**99, 2**20000, Decimal("1e400"), "-1e99"],
    ids=lambda v: type(v).__name__,
)
def test_too_large(value):
    with pytest.raises(OverflowError):
        Decimal8(value)
    with pytest.raises(OverflowError):
        Decimal8Array([1, value])


@pytest.mark.parametrize(
    ("value", "error"),
    [
        ("one", ValueError),
        ("nan", ValueError),
        (float("nan"), ValueError),
        (Decimal("NaN"), ValueError),
        (float("inf"), OverflowError),
        ("-Infinity", OverflowError),
        (None, TypeError),
        (1j, TypeError),
    ],
)
def test_no_number(value, error):
    with pytest.raises(error):
        Decimal8(value)
    with pytest.raises(error):
        Decimal8Array([value])
    if isinstance(value, float):
        with pytest.raises(error):
            Decimal8Array(np.array([1.0, value]))


def test_edges_of_the_range():
    largest, smallest = Decimal8("99999999e91"), Decimal8("1e-100")
    assert largest + 0 == largest
    assert largest.exponent == 99
    assert smallest.exponent == -99
    # 0.5 of the last digit rounds up, and only then is too large.
    with pytest.raises(OverflowError):
        largest + Decimal8("5e90")
    assert largest + Decimal8("4.9999999e90") == largest
    # What rounds up to the smallest number does not underflow.
    with watch() as flags:
        assert Decimal8("0.9999999") * Decimal8("1.0000001e-100") == smallest
        assert not flags.underflow
        assert Decimal8("0.9") * smallest == 0
    assert flags.underflows == 1


def test_underflow_is_flagged_in_every_open_watch():
    tiny = Decimal8Array(["1e-60", "1", "-1e-60", "0"])
    with watch() as outer:
        with watch() as inner:
            assert (tiny * tiny).tolist() == [0, 1, 0, 0]
        assert inner.underflows == 2
        Decimal8("1e-101")
        Decimal8Array(np.array([1e-200, 1e-300, 0.0]))
    assert outer.underflows == 5
    assert inner.underflows == 2
    for _ in range(2):
        with watch() as constant:
            assert (tiny * 1e-200).tolist() == [0, 0, 0, 0]
        assert constant.underflows == 1
    with watch() as quiet:
        assert (tiny > 1e-200).tolist() == [True, True, False, False]
        assert (tiny < np.full(4, -1e-200)).tolist() == [False, False, True, False]
        assert (tiny * 0).tolist() == [0, 0, 0, 0]
        assert (tiny - tiny).tolist() == [0, 0, 0, 0]
    assert not quiet.underflow


# --- arithmetic -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "total"),
    [
        ("12345678", "0.5", "12345679"),  # a tie
        ("12345678", "0.49999999", "12345678"),
        ("-12345678", "-0.5", "-12345679"),
        ("99999999", "0.5", "1e8"),
        ("99999999", "99999999", "2e8"),  # 199999998 -> 200000000
        ("10000000", "-0.049999999", "1e7"),
        ("10000000", "-0.05", "1e7"),  # 9999999.95, a tie to 10000000.0
        ("10000000", "-0.050000001", "9999999.9"),
        ("10000000", "-0.15", "9999999.9"),  # 9999999.85, a tie
        ("1", "-0.99999999", "1e-8"),
        ("1", "-1", "0"),
        ("1", "1e-99", "1"),
        ("1", "-1e-9", "1"),
        ("1.0000000", "-0.4e-8", "1"),
        ("1.0000000", "-0.6e-8", "0.99999999"),
        ("0", "-5e-90", "-5e-90"),
        # The floats nearest to these differ by 0.99999999392e-7 and the like.
        ("1.2345679", "-1.2345678", "1e-7"),
        ("77777.778", "-77777.777", "0.001"),
        ("9.9999999", "-9.9999989", "1e-6"),
        ("1.0000005", "-0.99999955", "9.5e-7"),
        ("99999997", "0", "99999997"),
        ("1e8", "-3", "99999997"),
        ("1e8", "-3.5", "99999997"),  # 99999996.5, a tie
        ("-1e8", "4.5", "-99999996"),  # 99999995.5, a tie
    ],
)
def test_addition(a, b, total):
    expected = Decimal(total)
    assert (Decimal8(a) + Decimal8(b)).decimal == expected
    assert (Decimal8(b) + Decimal8(a)).decimal == expected
    assert (Decimal8Array([a]) + Decimal8Array([b])).tolist() == [expected]
    assert (Decimal8Array([b]) - Decimal8Array([a]) * -1).tolist() == [expected]


@pytest.mark.parametrize(
    ("a", "b", "product"),
    [
        ("1.0000001", "1.5", "1.5000002"),  # 1.50000015, a tie
        ("-1.0000001", "1.5", "-1.5000002"),
        ("99999999", "99999999", "9.9999998e15"),
        ("31622777", "31622777", "1e15"),
        ("0", "-3", "0"),
    ],
)
def test_multiplication(a, b, product):
    assert (Decimal8(a) * Decimal8(b)).decimal == Decimal(product)
    assert (Decimal8Array([a]) * Decimal8Array([b])).tolist() == [Decimal(product)]


@pytest.mark.parametrize(
    ("a", "b", "quotient"),
    [
        ("2", "3", "0.66666667"),
        ("1.0000001", "4", "0.25000003"),  # 0.250000025, a tie
        ("-1.0000001", "4", "-0.25000003"),
        ("0", "-7", "0"),
        ("99999999", "1e8", "0.99999999"),
    ],
)
def test_division(a, b, quotient):
    assert (Decimal8(a) / Decimal8(b)).decimal == Decimal(quotient)
    assert (Decimal8Array([a]) / Decimal8Array([b])).tolist() == [Decimal(quotient)]


@pytest.mark.parametrize("factor", [2, 4, 0.5, 8, 5, 16, 99999, 100001, Decimal8("0.5"), -2])
def test_short_factors_and_divisors(factor):
    """Ties abound; numbers of few digits take a way of their own."""
    exact = Decimal8(factor).decimal
    m = np.array([10000001, 32345679, 99999999, 99999998, 50000005, 12345675, 33333333])
    for e in (-60, 0, 3, 8, 9, 30, 60):
        a = Decimal8Array.from_parts(np.append(m, -m), e)
        for result, operation in ((a * factor, "multiply"), (a / factor, "divide")):
            expected = [getattr(EIGHT, operation)(x, exact) for x in a.tolist()]
            assert result.tolist() == expected


def test_zero_has_no_sign():
    a = -Decimal8Array([0, 1]) * 0
    assert np.signbit(a.to_float()).tolist() == [False, False]
    assert np.signbit(a).tolist() == [False, False]
    assert atan2(a, Decimal8Array([1, 1])).tolist() == [0, 0]
    assert atan2(Decimal8Array([1, 0]), a).tolist() == [Decimal("1.5707963"), 0]
    assert text(a) == ["0", "0"]
    assert a.to_bytes() == bytes(12)
    assert (a == 0).all()
    assert (a.rint() == 0).all()


def test_errors_of_operations():
    a = Decimal8Array([1, 0, 4])
    for one, two in ((a, a), (1, a), (a, 0), (Decimal8(1), 0), (0, Decimal8(0))):
        with pytest.raises(ZeroDivisionError):
            one / two
    many = np.ones(100_000)
    many[70_000] = 0
    for one in (1, Decimal8Array(np.ones(100_000)), Decimal8Array(many)):
        with pytest.raises(ZeroDivisionError):
            one / Decimal8Array(many)
    for negative in (Decimal8(-1), -a):
        with pytest.raises(ValueError, match="negative"):
            sqrt(negative)
    with pytest.raises(OverflowError, match="element 1"):
        Decimal8Array([1, "1e60"]) * Decimal8("1e60")
    with pytest.raises(TypeError):
        a + "1"
    with pytest.raises(TypeError):
        Decimal8(1) + None
    with pytest.raises(TypeError):
        np.arctanh(a)
    with pytest.raises(TypeError):
        np.linalg.norm(a)


def test_mixed_with_everything_on_either_side():
    a = Decimal8Array([1, "2.5", -4])
    for two in (2, 2.0, Decimal8(2), Decimal(2), np.float64(2), np.int32(2), np.array([2.0, 2, 2])):
        assert text(a * two) == ["2", "5", "-8"], two
        assert text(two * a) == ["2", "5", "-8"], two
        assert text(two - a) == ["1", "-0.5", "6"], two
        assert text(a - two) == ["-1", "0.5", "-6"], two
        assert text(two / a) == ["2", "0.8", "-0.5"], two
        assert (two > a).tolist() == [True, False, True], two
        assert (a >= two).tolist() == [False, True, False], two
    one = Decimal8("0.1")
    assert (str(one + 1), str(1 - one), str(2 * one), str(1 / one), str(one / 0.5)) == (
        "1.1", "0.9", "0.2", "10", "0.2",
    )  # fmt: skip
    assert text(np.array([1.0, 2.0]) + one) == ["1.1", "2.1"]
    assert text([1, 2] * Decimal8Array([3, 4])) == ["3", "8"]


def test_comparisons_take_numbers_as_they_are():
    assert Decimal8("0.5") == 0.5
    assert Decimal8("0.1") != 0.1  # the float is larger
    assert Decimal8("0.1") < 0.1
    assert Decimal8(123456780) < 123456781
    assert Decimal8(1) < float("inf")
    assert Decimal8(1) != float("nan")
    assert not Decimal8(1) < float("nan")
    a = Decimal8Array(["0.1", "0.5", 123456780, 0, -3, "1e30"])
    b = np.array([0.1, 0.5, 123456781, 0.0, -np.inf, 1e30])
    assert (a == b).tolist() == [False, True, False, True, False, int(1e30) == 10**30]
    assert (a < b).tolist() == [True, False, True, False, False, int(1e30) > 10**30]
    assert (a < float("nan")).tolist() == [False] * 6
    assert (a != np.full(6, np.nan)).all()
    assert (a == 10**300).tolist() == [False] * 6
    assert (Decimal8Array([3, 4]) == np.array([3, 5])).tolist() == [True, False]
    n = np.array([2**63 - 1, -(2**63), 123456785, 7])
    assert (Decimal8Array(n) == n).tolist() == [False, False, False, True]
    assert (Decimal8Array(n) > n).tolist() == [False, True, True, False]


def test_order_and_hash():
    values = ["-2e5", "-1", "-1e-9", "0", "1e-100", "1e-9", "0.99999999", "1", "1.0000001", "3e50"]
    a = Decimal8Array(values)
    for i, x in enumerate(a):
        assert (a < x).tolist() == [j < i for j in range(len(values))]
        assert (a <= x).tolist() == [j <= i for j in range(len(values))]
        assert [y > x for y in a] == [j > i for j in range(len(values))]
        assert hash(x) == hash(Decimal(values[i]))
    assert hash(Decimal8(5)) == hash(5)
    assert str(a.max()) == "3.0000000E+50"
    assert a.min() == Decimal8("-2e5")
    assert text(np.sort(a[::-1])) == text(a)


@pytest.mark.parametrize(
    ("value", "ndigits", "expected"),
    [("2.5", None, 3), ("-2.5", None, -3), ("0.49999999", None, 0), ("0.5", None, 1),
     ("1e30", None, 10**30), ("1e-50", None, 0), ("0.05", None, 0), ("99999.5", None, 100000),
     ("1.25", 1, "1.3"), ("-1.25", 1, "-1.3"), ("1234567", -3, "1235000"), ("4", -1, "0"),
     ("12.5", 7, "12.5")],
)  # fmt: skip
def test_rounding_to_integers_and_places(value, ndigits, expected):
    assert round(Decimal8(value), ndigits) == Decimal8(expected)
    if ndigits is None:
        assert isinstance(round(Decimal8(value)), int)
        assert Decimal8Array([value]).rint().tolist() == [expected]
        assert round(Decimal8Array([value])).tolist() == [expected]
    else:
        assert text(np.round(Decimal8Array([value]), ndigits)) == [str(Decimal8(expected))]
        assert text(round(Decimal8Array([value]), ndigits)) == [str(Decimal8(expected))]


def test_to_int():
    a = Decimal8Array(["2.5", "-2.5", "1e17", "0", "1e-90", "12345678"])
    assert a.to_int().tolist() == [3, -3, 10**17, 0, 0, 12345678]
    assert text(np.floor(a)) == ["2", "-3", "1.0000000E+17", "0", "0", "12345678"]
    assert text(np.ceil(a)) == ["3", "-2", "1.0000000E+17", "0", "1", "12345678"]
    assert text(np.trunc(a)) == ["2", "-2", "1.0000000E+17", "0", "0", "12345678"]
    with pytest.raises(OverflowError):
        Decimal8Array(["1e18"]).to_int()


def test_to_float_is_the_nearest_over_the_whole_range():
    rng = np.random.default_rng(7)
    m, e = rng.integers(10**7, 10**8, 5000), rng.integers(-99, 100, 5000)
    expected = [float(f"{x}e{k - 8}") for x, k in zip(m, e, strict=True)]
    assert Decimal8Array.from_parts(m, e).to_float().tolist() == expected
    assert float(Decimal8("-1e-100")) == -1e-100


# --- arrays -----------------------------------------------------------------------------------


def test_indexing_and_setting():
    a = Decimal8Array([1, 2, 3, 4])
    assert len(a) == 4
    assert a[1] == 2
    assert isinstance(a[1], Decimal8)
    assert text(a[1:3]) == ["2", "3"]
    assert text(a[[0, -1]]) == ["1", "4"]
    assert text(a[a > 2]) == ["3", "4"]
    a[0] = 0.5
    a[a > 2] = [30, "1e-3"]
    assert text(a) == ["0.5", "2", "30", "0.001"]
    a[1:][0] = 7  # slices are views
    assert a[1] == 7
    assert [x + 1 for x in a][1] == 8
    with pytest.raises(IndexError):
        a[4]


def test_two_axes():
    a = Decimal8Array([[1, 2, 3], [4, 5, 6]])
    assert (a.shape, a.ndim, a.size, len(a)) == ((2, 3), 2, 6, 2)
    assert (a * Decimal8Array([1, 10, 100])).tolist() == [[1, 20, 300], [4, 50, 600]]
    assert (a + Decimal8Array([[10], [20]])).tolist() == [[11, 12, 13], [24, 25, 26]]
    assert a.T[2].tolist() == [3, 6]
    assert np.sum(a, axis=0).tolist() == [5, 7, 9]
    assert a.sum() == 21
    assert np.sqrt(a * a).tolist() == a.tolist()
    assert a.reshape(3, 2)[1].tolist() == [3, 4]


def test_empty():
    a = Decimal8Array([])
    assert len(a + a) == len(a * 2) == len(np.sin(a)) == len(np.sqrt(a)) == len(a.to_float()) == 0
    assert len(Decimal8Array(np.zeros(0)) / 3) == len(Decimal8Array(np.zeros(0, int))) == 0
    assert a.sum() == 0
    assert a.to_bytes() == b""


def test_numpys_functions():
    a, b = Decimal8Array([3, "-0.5"]), Decimal8Array([4, 2])
    assert text(np.hypot(a, b)) == ["5", "2.0615528"]
    assert text(np.arctan2(b, a)) == ["0.92729522", "1.815775"]
    assert text(np.where([True, False], a, b)) == ["3", "2"]
    assert text(np.where(a > 0, a, 0)) == ["3", "0"]
    assert text(where(np.array([True, False]), 1, a)) == ["1", "-0.5"]
    assert text(np.concatenate([a, b, [1.5]])) == ["3", "-0.5", "4", "2", "1.5"]
    assert np.stack([a, b]).shape == (2, 2)
    assert text(np.roll(a, 1)) == ["-0.5", "3"]
    assert text(np.append(a, 7)) == ["3", "-0.5", "7"]
    assert text(np.maximum(a, b)) == ["4", "2"]
    assert text(np.clip(a, 0, 1)) == ["1", "0"]
    assert text(np.abs(a)) == ["3", "0.5"]
    assert text(np.sign(a)) == ["1", "-1"]
    assert text(np.square(a)) == ["9", "0.25"]
    assert text(np.diff(b)) == ["-2"]
    assert text(np.zeros_like(a)) == ["0", "0"]
    assert np.array_equal(a, a.copy())
    assert not np.array_equal(a, b)
    assert np.sum(a) == Decimal8("2.5")
    assert np.asarray(a).tolist() == [3.0, -0.5]
    assert np.asarray(a, object).tolist() == [Decimal8(3), Decimal8("-0.5")]
    assert isinstance(np.sqrt(Decimal8(4)), Decimal8)
    out = Decimal8Array([0, 0])
    assert np.add(a, b, out=out) is out
    assert text(out) == ["7", "1.5"]


def test_sums_run_from_the_left():
    assert Decimal8Array([99999999, "0.4", "0.4"]).sum() == Decimal8(99999999)
    assert Decimal8Array(["0.4", "0.4", 99999999]).sum() == Decimal8(10**8)


def test_pieces_join_seamlessly():
    n = 40_000
    a = Decimal8Array(np.arange(1, n + 1))
    assert ((a + a) == 2 * np.arange(1, n + 1)).all()
    assert np.array_equal(a * 3 / 3, a)
    assert np.array_equal(sqrt(a * a)[:9999], a[:9999])  # 4-digit roots are exact
    assert np.array_equal(sin(a), Decimal8Array(np.sin(np.arange(1.0, n + 1))))


def test_copies():
    a, x = Decimal8Array([1, 2]), Decimal8("1.5")
    for twin in (copy.deepcopy(a), pickle.loads(pickle.dumps(a)), a.copy()):
        twin[0] = 9
        assert a[0] == 1
    assert pickle.loads(pickle.dumps(x)) == copy.copy(x) == x
    assert f"{x:.3f}" == "1.500"
    assert repr(a) == "Decimal8Array(['1', '2'])"


def test_parts():
    a = Decimal8Array.from_parts([12345678, 0, -10000000], [1, 50, -99])
    assert a.mantissa.tolist() == [12345678, 0, -10000000]
    assert a.exponent.tolist() == [1, 0, -99]
    for m, e in ((1, 0), (10**8, 0), (10**7, 100), (-(10**7), -100)):
        with pytest.raises(ValueError, match="8 digits"):
            Decimal8Array.from_parts([m], [e])


def test_the_arithmetic_of_formulas():
    ar = DECIMAL8
    a = ar.array([3.0, 4.0])
    assert ar.name == "decimal8"
    assert ar.to_float(ar.sqrt(a * a)).tolist() == [3.0, 4.0]
    assert ar.to_float(ar.sin(a) * ar.sin(a) + ar.cos(a) * ar.cos(a)).tolist() == [1.0, 1.0]
    assert ar.to_float(ar.where(a > 3, a, -a)).tolist() == [-3.0, 4.0]
    assert ar.array(a) is a


def test_functions_take_plain_numbers():
    assert sin(30, degrees=True) == Decimal8("0.5")
    assert atan2(1, [1, -1], degrees=True).tolist() == [45, 135]
    assert hypot(3, [4, 0]).tolist() == [5, 3]

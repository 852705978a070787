"""Sines, inverses, powers: exact values, ties, hard cases, domains."""

from decimal import Decimal

import numpy as np
import pytest

from wedmcam.decimal8 import Decimal8, Decimal8Array, acos, asin, atan, atan2, cos, hypot, sin, tan

# Whole multiples of 15 degrees; '' where the value is no 8-digit number.
SINES = ["0", "", "0.5", "", "", "", "1", "", "", "", "0.5", ""]


@pytest.mark.parametrize("turns", [0, 1, -3, 1000, 277777, 10**17])
def test_sine_and_cosine_are_exact_at_multiples_of_30_degrees(turns):
    for i, value in enumerate(SINES):
        angle = 360 * turns + 15 * i
        if value and Decimal8(angle) == angle:
            assert sin(angle, degrees=True) == Decimal8(value)
            assert sin(-angle, degrees=True) == -Decimal8(value)
            assert cos(angle - 90, degrees=True) == Decimal8(value) or Decimal8(angle - 90) != (
                angle - 90
            )


def test_tangent_is_exact_at_multiples_of_45_degrees():
    a = Decimal8Array([0, 45, 135, 180, 225, 315, -45, 405, 3600045])
    assert tan(a, degrees=True).tolist() == [0, 1, -1, 0, 1, -1, -1, 1, 1]
    for pole in (90, -90, 270, 450, 36000090):
        with pytest.raises(ValueError, match="90 degrees"):
            tan(pole, degrees=True)


def test_angles_too_large_for_float64_are_reduced_in_integers():
    degrees = ["-2.2564342e17", "1.7801972e17", "1.6903585e17", "-1.5625e17"]
    a = Decimal8Array(degrees)
    assert [int(x) % 360 for x in a.tolist()] == [80, 80, 280, 80]
    assert cos(a, degrees=True).tolist() == [Decimal("0.17364818")] * 4
    assert [cos(x, degrees=True) for x in a] == [Decimal8("0.17364818")] * 4
    a = Decimal8Array([90 * 10**k for k in range(3, 20)])  # whole turns, all of them
    assert sin(a, degrees=True).tolist() == tan(a, degrees=True).tolist() == [0] * 17
    assert cos(a, degrees=True).tolist() == [1] * 17
    # 10^k is 280 modulo 360.
    a = Decimal8Array([f"1e{k}" for k in range(3, 99)])
    assert cos(a, degrees=True).tolist() == [Decimal("0.17364818")] * 96
    assert sin(a, degrees=True).tolist() == [Decimal("-0.98480775")] * 96
    assert tan(a, degrees=True).tolist() == [Decimal("-5.6712818")] * 96


def test_inverses_are_exact_in_degrees():
    a = Decimal8Array([-1, "-0.5", 0, "0.5", 1])
    assert asin(a, degrees=True).tolist() == [-90, -30, 0, 30, 90]
    assert acos(a, degrees=True).tolist() == [180, 120, 90, 60, 0]
    assert atan(Decimal8Array([-1, 0, 1]), degrees=True).tolist() == [-45, 0, 45]
    y, x = [0, 1, 1, 1, 0, -1, -1, -1, 0], [1, 1, 0, -1, -1, -1, 0, 1, 0]
    assert atan2(y, x, degrees=True).tolist() == [0, 45, 90, 135, 180, -135, -90, -45, 0]


# Digits from tables of these constants.
@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (sin(1), "0.84147098"),
        (cos(1), "0.54030231"),
        (tan(1), "1.5574077"),
        (atan(1) * 4, "3.1415926"),  # 4 x 0.78539816 = 3.14159264
        (acos(-1), "3.1415927"),
        (asin(1), "1.5707963"),
        (atan2(-1, -1), "-2.3561945"),
        (Decimal8(2).sqrt(), "1.4142136"),
        (Decimal8(2) ** 0.5, "1.4142136"),
        (Decimal8(10) ** -3, "0.001"),
        (Decimal8(180).to_radians(), "3.1415927"),
        (Decimal8(1).to_degrees(), "57.295780"),
    ],
)
def test_known_values(value, expected):
    assert value.decimal == Decimal(expected)


def test_powers_that_end_in_a_tie():
    # 10001^3 = 1000300030001; 2^-12 = 0.000244140625; 1.5^2.. of roots: 2.25^1.5 = 3.375
    cases = [
        (20000000, -12, "2.4414063e-88"),  # 244140625: a tie
        ("2.25", "1.5", "3.375"),
        ("1.0001", 2, "1.0002"),  # 1.00020001
        ("1.00015", 2, "1.0003"),  # 1.0003000225
        ("12345", 2, "152399025"),
        (-2, 3, "-8"),
        (-2, -3, "-0.125"),
        (0, 0, "1"),
        (0, 2.5, "0"),
        (5, 0, "1"),
        (1, "1e90", "1"),
        ("0.99999999", "1e8", "0.36787944"),
        (45, 5, "184528130"),  # 184528125: a tie
        ("2025", "2.5", "184528130"),  # the same through a root
        (4, "-6.5", "0.00012207031"),  # 2^-13 = 0.0001220703125
    ]
    for x, y, expected in cases:
        assert Decimal8(x) ** Decimal8(y) == Decimal8(expected), (x, y)
        assert (Decimal8Array([x]) ** Decimal8Array([y])).tolist() == [Decimal8(expected).decimal]


def test_errors_of_powers():
    with pytest.raises(ZeroDivisionError):
        Decimal8(0) ** -1
    with pytest.raises(ValueError, match="fractional"):
        Decimal8(-2) ** 0.5
    with pytest.raises(OverflowError):
        Decimal8(10) ** 99
    with pytest.raises(OverflowError):
        Decimal8("1e90") ** Decimal8("1e90")
    assert Decimal8("1e90") ** Decimal8("-1e90") == 0
    assert Decimal8("-1.5") ** 3 == Decimal8("-3.375")


def test_hypotenuse_that_is_a_tie():
    assert hypot(60000003, 80000004) == Decimal8(100000010)  # 100000005
    assert hypot(60000003, Decimal8(-80000004)) == Decimal8(100000010)
    assert hypot(0, 0) == 0
    assert hypot(0, "-1e-90") == Decimal8("1e-90")
    assert hypot("1e98", "1e-98") == Decimal8("1e98")
    with pytest.raises(OverflowError):
        hypot("9e98", "9e98")


def test_arc_tangents_closer_to_a_tie_than_fifty_digits_tell():
    # y / x = 2.50000025e-31 is a tie; the arc tangent is smaller by 5e-93.
    assert atan2("1.0000001e-30", 4) == Decimal8("2.5000002e-31")
    assert Decimal8("1.0000001e-30") / 4 == Decimal8("2.5000003e-31")
    # sqrt(1 - 1e-8) and the like: the cosine of 1e-4 is 0.999999995 + 4e-18, above the tie.
    assert cos("1e-4") == 1
    assert cos("1.0000001e-4") == Decimal8("0.99999999")


def test_small_angles_are_their_own_sine():
    a = Decimal8Array(["1e-5", "-1.2345678e-5", "1e-100", "-9.9999999e-60", 0])
    for function in (sin, tan, asin, atan):
        assert function(a).tolist() == a.tolist()
    assert cos(a).tolist() == [1] * 5


@pytest.mark.parametrize(
    ("angle", "sine"),
    [
        # Reduced with 200 digits of pi.
        ("1e22", "-0.85220085"),
        ("3.1415927", "-4.6410207e-8"),
        ("314159265", None),
        ("1e40", "-0.56963340"),
    ],
)
def test_large_angles(angle, sine):
    import mpmath

    with mpmath.workdps(200):
        reference = Decimal8(mpmath.nstr(mpmath.sin(mpmath.mpf(str(Decimal8(angle)))), 60))
    assert sin(angle) == reference
    if sine is not None:
        assert sin(angle) == Decimal8(sine)


@pytest.mark.parametrize("value", ["1.0000001", -2, "1e50"])
@pytest.mark.parametrize("function", [asin, acos])
def test_beyond_one(function, value):
    with pytest.raises(ValueError, match="beyond 1"):
        function(value)
    with pytest.raises(ValueError, match="beyond 1"):
        function(Decimal8Array([0, value]))


def test_what_float64_leaves_open_is_decided():
    """Operands chosen because their results lie within 1e-9 of a last digit of a tie."""
    import mpmath

    rng = np.random.default_rng(20)
    m = rng.integers(10**7, 10**8, 1_500_000)
    y = np.sin(m * 1e-8) * 1e8
    near = np.flatnonzero(np.abs(y - np.floor(y) - 0.5) < 3e-6)
    assert near.size > 3
    a = Decimal8Array.from_parts(m[near], np.zeros(near.size, int))
    with mpmath.workdps(60):
        expected = [
            Decimal8(mpmath.nstr(mpmath.sin(mpmath.mpf(int(x)) / 10**8), 50)).decimal
            for x in m[near]
        ]
    assert sin(a).tolist() == expected

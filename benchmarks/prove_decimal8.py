"""Hold the 8-digit arithmetic against references that share nothing with it, digit by digit.

Run: python benchmarks/prove_decimal8.py [--count N] [--seed S] [--sample N] [--record FILE]
[operation ...]. For each operation N operands, random and edge cases mixed. Every result must be
identical. A result is compared with one of these:

* exact: Python's `decimal`, 8 digits and ROUND_HALF_UP, of the exact value of the result, or of as
  many digits as its rounding can need.
* 64 bits: the C library's functions of x87 long doubles (numpy's longdouble), which the
  arithmetic never calls, with a bound of their error 64 times what they promise. Where that
  interval rounds to one 8-digit number, it is the reference.
* mpmath: 50 digits, or more where an operand's exponent eats them or 50 do not decide. All results
  that the 64 bits leave open, and a sample of the others, to hold the bound itself to account.

Where long double is no more than double, everything goes to mpmath, which takes hours.
"""

import argparse
import decimal
import operator
import platform
import sys
import time
from decimal import Decimal
from pathlib import Path

import mpmath
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import bench_decimal8

from wedmcam.decimal8 import Decimal8Array, hypot
from wedmcam.decimal8.number_format import HIGH, LOW

EIGHT = decimal.Context(prec=8, rounding=decimal.ROUND_HALF_UP, Emax=10**6, Emin=-(10**6))
EXACT = decimal.Context(prec=3000, Emax=10**9, Emin=-(10**9))
LONG = decimal.Context(prec=400, Emax=10**9, Emin=-(10**9))
#: 0.dddddddd x 10^99 and 0.1 x 10^-99.
TOO_LARGE, SMALLEST = Decimal("1e99"), Decimal("1e-100")
#: Operands of one array: few enough for the sizes to change, many enough for every way of rounding.
CHUNK = 5_000


# --- operands -------------------------------------------------------------------------------


def mantissas(rng, n):
    """8-digit mantissas: uniform, of few digits, next to powers of ten, ending in 5, zero."""
    m = rng.integers(LOW, HIGH, n)
    kind = rng.integers(0, 10, n)
    few = 10 ** rng.integers(1, 8, n)
    m = np.where(kind <= 2, m // few * few, m)
    m = np.where(kind == 3, LOW + rng.integers(0, 12, n), m)
    m = np.where(kind == 4, HIGH - 1 - rng.integers(0, 12, n), m)
    m = np.where(kind == 5, m // 10 * 10 + 5, m)
    # Twos and fives: quotients and products of them end, some in a tie.
    smooth = 2.0 ** rng.integers(0, 27, n) * 5.0 ** rng.integers(0, 12, n)
    smooth = np.floor(smooth * 10.0 ** (7 - np.floor(np.log10(smooth))) + 0.5).astype(np.int64)
    m = np.where(kind == 6, np.clip(smooth, LOW, HIGH - 1), m)
    m = np.where((kind == 7) & (rng.random(n) < 0.1), 0, m)
    return m * rng.choice([-1, 1], n)


def operands(rng, n, low, high):
    """Of all sizes; in every other array only those that float64 alone can do."""
    if rng.random() < 0.5:
        low, high = max(low, -6), min(high, 12)
    return Decimal8Array.from_parts(mantissas(rng, n), rng.integers(low, high + 1, n))


def pairs(rng, n, span=99, near=12):
    """Two operands: exponents near each other mostly, cancellation and equality among them."""
    if rng.random() < 0.5:
        span, near = 7, 9
    a = Decimal8Array.from_parts(mantissas(rng, n), rng.integers(-span, span + 1, n))
    e = np.clip(a.exponent + rng.integers(-near, near + 1, n), -span, span)
    m = mantissas(rng, n)
    close = rng.random(n) < 0.15
    near_m = np.clip(np.abs(a.mantissa) + rng.integers(-3, 4, n), LOW, HIGH - 1)
    m = np.where(close, -np.sign(a.mantissa) * near_m, m)
    e = np.where(close, np.clip(a.exponent + rng.integers(-1, 2, n), -span, span), e)
    # Half a last digit of the other, and a hair more or less.
    half = rng.random(n) < 0.05
    m = np.where(half, (HIGH // 2 + rng.integers(-5, 6, n)) * rng.choice([-1, 1], n), m)
    e = np.where(half, np.maximum(a.exponent - rng.integers(7, 10, n), -99), e)
    return a, Decimal8Array.from_parts(m, e)


def coordinates(rng, n):
    """Pairs as parts have them: um of 3 places at most.

    None of them or of their sums is next to a power of ten, which is a way of its own. In every
    other array some are next to half a digit of the other, and so next to a tie without being one.
    """
    unit = 10.0 ** rng.integers(0, 4, (2, n))
    a, b = map(Decimal8Array, np.round(rng.uniform(-3e5, 3e5, (2, n)) * unit) / unit)
    half = rng.random(n) < rng.choice([0, 0.05])
    k = int(half.sum())
    m = (HIGH // 2 + rng.integers(-5, 6, k)) * rng.choice([-1, 1], k)
    b[half] = Decimal8Array.from_parts(m, a.exponent[half] - rng.integers(7, 10, k))
    return a, b


def differing(rng, n):
    """The same for differences."""
    a, b = pairs(rng, n)
    return a, -b


def legs(rng, n):
    """Pairs, and legs of right triangles whose hypotenuse has 9 digits, some ending in 5."""
    a, b = pairs(rng, n, 60, 5)
    p, q = rng.integers(6000, 10000, (2, n))
    p, q = np.maximum(p, q) + 1, np.minimum(p, q)
    x, y = p * p - q * q, 2 * p * q
    fits = (y < HIGH) & (x > 0)
    t = fits & (rng.random(n) < 0.2)
    a[t], b[t] = Decimal8Array(x[t]), Decimal8Array(y[t])
    return a, b


def angles(rng, n, high):
    """Angles of all sizes, most below 10^3; and those nearest to multiples of pi / 12."""
    a = operands(rng, n, -7, 3)
    far = rng.random(n) < 0.1
    a[far] = operands(rng, int(far.sum()), -99, high)
    turns = rng.random(n) < 0.2
    k = rng.integers(-(10**6), 10**6, int(turns.sum()))
    a[turns] = Decimal8Array(k * (np.pi / 12))
    return a


def degrees(rng, n):
    a = operands(rng, n, -7, 5)
    far = rng.random(n) < 0.1
    a[far] = operands(rng, int(far.sum()), -99, 99)
    turns = rng.random(n) < 0.03
    k = rng.integers(-(10**5), 10**5, int(turns.sum()))
    a[turns] = Decimal8Array(k * 15)
    return a


def no_pole(a):
    odd = np.array([EXACT.remainder(x, Decimal(180)).copy_abs() == 90 for x in a.tolist()])
    a[odd] = 45
    return a


def sines(rng, n):
    """Numbers up to 1: small ones, and next to 1."""
    a = operands(rng, n, -7, 0)
    a[rng.random(n) < 0.02] = 1
    a[rng.random(n) < 0.02] = -1
    half = rng.random(n) < 0.05
    a[half] = Decimal8Array(rng.choice([-0.5, 0.5], int(half.sum())))
    return a


def points(rng, n):
    y, x = pairs(rng, n, 99, 8)
    diagonal = rng.random(n) < 0.05
    y[diagonal] = x[diagonal]
    far = rng.random(n) < 0.01
    y[far] = operands(rng, int(far.sum()), -99, 99)
    return y, x


def bases(rng, n):
    """x > 0 and y for x ** y inside the range mostly; small rational exponents among them."""
    x = abs(operands(rng, n, -8, 9))
    x[x == 0] = 1
    short = rng.random(n) < 0.3
    x[short] = Decimal8Array(rng.integers(1, 20000, int(short.sum()))) / 100
    most = np.minimum(220 / np.maximum(np.abs(np.log(x.to_float())), 1e-9), 1e12)
    y = Decimal8Array(rng.uniform(-1, 1, n) * most)
    simple = rng.random(n) < 0.5
    k = int(simple.sum())
    y[simple] = Decimal8Array(rng.integers(-12, 30, k) / rng.choice([1, 1, 2, 4, 8], k))
    return x, y


# --- references -----------------------------------------------------------------------------


def rounded(x):
    """A Decimal rounded to 8 digits; with the format's range: None is overflow."""
    x = EIGHT.plus(x)
    if abs(x) >= TOO_LARGE:
        return None
    return x if abs(x) >= SMALLEST else Decimal(0)


def from_mp(function, tens, *xs):
    """function(mp operands) to 8 digits: 50 digits, doubled while they do not decide."""
    digits = 50
    while True:
        with mpmath.workdps(digits + 10 + 2 * tens):
            value = function(*(mpmath.mpf(x) for x in map(str, xs)))
            if value == 0:
                return Decimal(0)
            mantissa, power = int(value.man), int(value.exp)
        # The binary number to a digit more than asked for, then the question whether all agree.
        if power >= 0:
            exact = Decimal(mantissa * 2**power)
        else:
            exact = decimal.Context(prec=digits).divide(Decimal(mantissa), Decimal(2**-power))
        if value < 0 < exact:
            exact = exact.copy_negate()  # unary minus would round
        doubt = decimal.Context(prec=digits).multiply(exact.copy_abs(), Decimal(f"1e{3 - digits}"))
        low = rounded(decimal.Context(prec=digits).subtract(exact, doubt))
        high = rounded(decimal.Context(prec=digits).add(exact, doubt))
        if low == high:
            return low
        digits *= 2
        if digits > 2000:
            raise AssertionError(f"undecided: {xs}")


def mp_case(function, factor=1):
    def reference(*xs):
        tens = factor * max(0, *(x.adjusted() for x in xs if x), 0)
        return from_mp(function, tens, *xs)

    return reference


def in_degrees(name):
    exact = {
        "sin": {0: 0, 30: "0.5", 90: 1, 150: "0.5", 180: 0, 210: "-0.5", 270: -1, 330: "-0.5"},
        "cos": {0: 1, 60: "0.5", 90: 0, 120: "-0.5", 180: -1, 240: "-0.5", 270: 0, 300: "0.5"},
        "tan": {0: 0, 45: 1, 135: -1, 180: 0, 225: 1, 315: -1},
    }[name]

    def reference(x):
        turn = EXACT.remainder(x, Decimal(360))
        whole = int(turn) % 360 if turn == int(turn) else None
        if whole in exact:
            return Decimal(exact[whole])
        return from_mp(lambda t: getattr(mpmath, name)(t * mpmath.pi / 180), 0, turn)

    return reference


def power(x, y):
    """Whole powers, and powers of exact roots, in exact decimals: only they can be ties."""
    whole = EXACT.multiply(y, 8)
    if abs(y) <= 40 and whole == int(whole):
        root, whole = x, int(whole)
        for steps in (8, 4, 2, 1):  # root is x ** (steps / 8)
            if whole % steps == 0:
                result = EXACT.power(root, abs(whole) // steps)
                return rounded(result if whole >= 0 else LONG.divide(1, result))
            root = LONG.sqrt(root)
            if len(root.as_tuple().digits) > 50:
                break
    return from_mp(lambda a, b: a**b, 8, x, y)


def hypotenuse(a, b):
    """The square root of the exact square, of 30 digits at most here; so 80 show ties exactly."""
    square = EXACT.add(EXACT.multiply(a, a), EXACT.multiply(b, b))
    return rounded(decimal.Context(prec=80).sqrt(square))


def angle_of(function):
    def reference(*xs):
        return from_mp(lambda *t: function(*t) * 180 / mpmath.pi, 0, *xs)

    return reference


def integer(x):
    return x.quantize(Decimal(1), decimal.ROUND_HALF_UP, EXACT)


# --- references of 64 bits ------------------------------------------------------------------

LD = np.longdouble
HAS_64_BITS = np.finfo(LD).nmant >= 63
PI = LD("3.14159265358979323846264338327950288")
#: 10^k; from 10^28 on not exactly.
LONG_TENS = np.array([LD(f"1e{k}") for k in range(230)])
#: Relative error of a function: 64 of its last digits, where it promises to be good to a few. And
#: of an operand, which is rounded once or twice.
FUNCTION, OPERAND = LD(2) ** -57, LD(2) ** -61


def scaled(x, k):
    """x * 10^k."""
    up, down = LONG_TENS[np.clip(k, 0, 229)], LONG_TENS[np.clip(-k, 0, 229)]
    return x * up / down


def long(a):
    return scaled(a.mantissa.astype(LD), a.exponent - 8)


def nearest(value, error):
    """Mantissas and exponents of values, and which the error leaves open."""
    size = np.abs(value)
    zero = (value == 0) & (error == 0)  # else it might be something else
    usual = np.isfinite(size) & (size > LD("1e-98")) & (size < LD("1e98")) & (error < size)
    size, error = np.where(usual, size, LD(1)), np.where(usual, error, LD(0))
    e = np.floor(np.log10(size)).astype(int) + 1
    s = scaled(size, 8 - e)
    e += (s >= HIGH).astype(int) - (s < LOW).astype(int)
    s = scaled(size, 8 - e)
    n = np.floor(s + LD(0.5))
    far = np.abs(s - np.floor(s) - LD(0.5)) > s * (error / size + LD(2) ** -60)
    m = np.where(value < 0, -n, n).astype(np.int64)
    carried = np.abs(m) == HIGH
    m, e = np.where(carried, m // 10, m), e + carried
    return np.where(zero, 0, m), np.where(zero, 0, e), ~(usual & far | zero)


def of_slope(function, slope):
    """A function whose operands are wrong: slope(x, y) times as much is its own error."""

    def quick(x):
        y = function(x)
        return y, np.abs(y) * FUNCTION + np.abs(x) * slope(x, y) * OPERAND

    return quick


def one(x, y):
    return LD(1)


def steep(x, y):
    return 1 + y * y


def leg(x, y):
    return 1 / np.sqrt((1 - np.abs(x)) * (1 + np.abs(x)))


def turned(a):
    """Degrees reduced to -180..180 in integers, in long double; multiples of 15 are NaN."""
    m, k = a.mantissa, a.exponent - 8
    powers = np.array([pow(10, j, 360) for j in range(100)])
    whole = m % 360 * powers[np.clip(k, 0, 99)] % 360
    unit = 10 ** np.clip(-k, 0, 15)
    part = m % (360 * unit)
    n, unit = np.where(k >= 0, whole, part), np.where(k >= 0, 1, unit)
    n = np.where(n > 180 * unit, n - 360 * unit, n)
    x = np.where(k < -15, long(a), n.astype(LD) / unit)
    exact = (n % (15 * unit) == 0) & (k >= -15)
    return np.where(exact, LD(np.nan), x) * PI / 180


def angle(function):
    def quick(*xs):
        y = function(*xs)
        return y, np.abs(y) * FUNCTION

    return quick


def quick_power(x, y):
    value = x**y
    return value, np.abs(value) * (4 * FUNCTION + (np.abs(y) + np.abs(y * np.log(x))) * OPERAND)


def times(factor):
    return lambda x: (x * factor, np.abs(x * factor) * FUNCTION)


def in_turns(quick):
    """A function of `turned` degrees."""

    def of_degrees(x):
        return quick(x)

    of_degrees.operand = turned
    return of_degrees


# --- operations -----------------------------------------------------------------------------


def full(rng, n):
    """A number and one of at most 5 digits, the same for all of a chunk."""
    short = rng.choice([2, 3, 4, 5, 8, 16, 0.5, 0.25, 1.5, -2, 7, 125, 99999, 12345, 0.0625])
    return operands(rng, n, -60, 60), Decimal8Array(np.full(n, short))


def near_floats(rng, n):
    """Numbers, and floats that are equal, next to them, or anything."""
    a = operands(rng, n, -60, 60)
    f = a.to_float()
    kind = rng.integers(0, 4, n)
    f = np.where(kind == 1, np.nextafter(f, np.inf), f)
    f = np.where(kind == 2, np.round(f), f)
    return a, np.where(kind == 3, f * (1 + rng.uniform(-1e-7, 1e-7, n)), f)


def any_floats(rng, n):
    """Floats of all sizes, decimals of 9 digits that end in 5, integers and halves."""
    f = operands(rng, n, -99, 98).to_float()
    kind = rng.integers(0, 5, n)
    f = np.where(kind == 1, f * (1 + rng.uniform(-1, 1, n)), f)
    ties = (10 * np.abs(mantissas(rng, n)) + 5) / 10.0 ** rng.integers(0, 12, n)
    f = np.where(kind == 2, ties, f)
    return (
        np.where(kind == 3, (rng.integers(0, 10**9, n) + 0.5) * 10.0 ** rng.integers(0, 3, n), f),
    )


RELATIONS = (operator.lt, operator.le, operator.eq, operator.ne, operator.gt, operator.ge)


def compared(a, b):
    """The truths of all six relations as one integer."""
    return sum(np.asarray(relation(a, b)).astype(int) << i for i, relation in enumerate(RELATIONS))


def compared_one(a, b):
    return sum(bool(relation(a, b)) << i for i, relation in enumerate(RELATIONS))


def bcd(x):
    """The six bytes of the ZD-065, written from the text of the number."""
    if not x:
        return bytes(6)
    sign, figures, power = x.as_tuple()
    e = len(figures) + power
    text = "".join(map(str, figures)).ljust(8, "0")
    return bytes.fromhex(f"{sign}{int(e < 0)}{abs(e):02d}{text}")


def one_by_one(operation):
    """The operation on `Decimal8` instead of arrays."""
    return lambda *xs: [x.decimal for x in map(operation, *xs)]


def in_ones(operation):
    """The operation on arrays of one element, which are rounded by a way of their own."""

    def run(*xs):
        ones = (operation(*(x[i : i + 1] for x in xs)) for i in range(len(xs[0])))
        return [one.item().decimal for one in ones]

    return run


def roots(rng, n):
    return (abs(operands(rng, n, -99, 99)),)


def divisors(rng, n):
    a, b = pairs(rng, n)
    b[b == 0] = 1
    return a, b


def root(a):
    return rounded(decimal.Context(prec=50).sqrt(a))


def added(a, b):
    return rounded(EXACT.add(a, b))


def product(a, b):
    return rounded(EXACT.multiply(a, b))


def quotient(a, b):
    return rounded(EIGHT.divide(a, b))


def radian(name, function, slope=None, high=40):
    make = lambda rng, n: (angles(rng, n, high),)  # noqa: E731
    return make, function, mp_case(getattr(mpmath, name)), of_slope(getattr(np, name), slope or one)


def degree(name, make):
    quick = of_slope(getattr(np, name), steep if name == "tan" else one)
    return make, lambda a: getattr(a, name)(True), in_degrees(name), in_turns(quick)


def inverse(name, make, slope, factor=1):
    """Arc functions in radians and in degrees."""
    ours, long_name = getattr(Decimal8Array, name), name.replace("a", "arc", 1)
    function = getattr(mpmath, name)
    plain = angle(getattr(np, long_name))
    if slope:
        plain = of_slope(getattr(np, long_name), slope)

    def quick_degrees(*xs):
        return tuple(part * 180 / PI for part in plain(*xs))

    return (
        (make, ours, mp_case(function, factor), plain),
        (make, lambda *xs: ours(*xs, True), angle_of(function), quick_degrees),
    )


#: What makes operands, what is proven, its reference one by one, and one of 64 bits.
OPERATIONS = {
    "add": (pairs, lambda a, b: a + b, added, None),
    "sub": (differing, lambda a, b: a - b, lambda a, b: rounded(EXACT.subtract(a, b)), None),
    "add_parts": (coordinates, lambda a, b: a + b, added, None),
    "sub_parts": (
        coordinates,
        lambda a, b: a - b,
        lambda a, b: rounded(EXACT.subtract(a, b)),
        None,
    ),
    "mul": (pairs, lambda a, b: a * b, product, None),
    "div": (divisors, lambda a, b: a / b, quotient, None),
    "mul_short": (full, lambda a, b: a * float(b[0]), product, None),
    "div_short": (full, lambda a, b: a / float(b[0]), quotient, None),
    "sqrt": (roots, np.sqrt, root, None),
    "hypot": (legs, hypot, hypotenuse, None),
    "rint": (lambda rng, n: (operands(rng, n, -12, 20),), np.rint, integer, None),
    "compare": (pairs, compared, compared_one, None),
    "compare_float": (near_floats, compared, compared_one, None),
    "from_float": (any_floats, Decimal8Array, lambda x: rounded(Decimal(x)), None),
    "to_float": (lambda r, n: (operands(r, n, -99, 99),), Decimal8Array.to_float, float, None),
    "to_bytes": (
        lambda rng, n: (operands(rng, n, -99, 99),),
        lambda a: np.frombuffer(a.to_bytes(), "V6"),
        bcd,
        None,
    ),
    "from_bytes": (
        lambda rng, n: (operands(rng, n, -99, 99),),
        lambda a: Decimal8Array.from_bytes(b"".join(map(bcd, a.tolist()))),
        lambda x: x,
        None,
    ),
    "one_add": (pairs, one_by_one(operator.add), added, None),
    "one_mul": (pairs, one_by_one(operator.mul), product, None),
    "one_div": (divisors, one_by_one(operator.truediv), quotient, None),
    "one_sqrt": (roots, one_by_one(lambda x: x.sqrt()), root, None),
    "ones_add": (pairs, in_ones(operator.add), added, None),
    "ones_mul": (pairs, in_ones(operator.mul), product, None),
    "ones_div": (divisors, in_ones(operator.truediv), quotient, None),
    "ones_short": (full, in_ones(lambda a, b: a / float(b[0])), quotient, None),
    "ones_sqrt": (roots, in_ones(np.sqrt), root, None),
    "ones_from_float": (any_floats, in_ones(Decimal8Array), lambda x: rounded(Decimal(x)), None),
    "ones_cos_degrees": (
        lambda rng, n: (degrees(rng, n),),
        in_ones(lambda a: a.cos(True)),
        in_degrees("cos"),
        lambda x: (x, LD(np.inf)),  # leaves everything to mpmath
    ),
    "sin": radian("sin", np.sin),
    "cos": radian("cos", np.cos),
    "tan": radian("tan", np.tan, steep),
    "sin_degrees": degree("sin", lambda rng, n: (degrees(rng, n),)),
    "cos_degrees": degree("cos", lambda rng, n: (degrees(rng, n),)),
    "tan_degrees": degree("tan", lambda rng, n: (no_pole(degrees(rng, n)),)),
    "pow": (bases, lambda a, b: a**b, power, quick_power),
    "radians": (
        lambda rng, n: (operands(rng, n, -98, 99),),
        np.radians,
        lambda x: from_mp(lambda t: t * mpmath.pi / 180, 0, x),
        times(PI / 180),
    ),
    "degrees": (
        lambda rng, n: (operands(rng, n, -98, 97),),
        np.degrees,
        lambda x: from_mp(lambda t: t * 180 / mpmath.pi, 0, x),
        times(180 / PI),
    ),
}
for _name, _make, _slope, _factor in (
    ("asin", lambda rng, n: (sines(rng, n),), leg, 1),
    ("acos", lambda rng, n: (sines(rng, n),), leg, 1),
    ("atan", lambda rng, n: (operands(rng, n, -9, 20),), None, 1),
    ("atan2", points, None, 0),
):
    OPERATIONS[_name], OPERATIONS[_name + "_degrees"] = inverse(_name, _make, _slope, _factor)


# --- proof ----------------------------------------------------------------------------------


def prove(name, count, seed, sample=20_000):
    """Return differences, and how many results were compared with each kind of reference.

    Overflow must be agreed on as well.
    """
    make, ours, reference, quick = OPERATIONS[name]
    rng = np.random.default_rng([seed, *name.encode()])
    tally = {"exact": 0, "64 bits": 0, "mpmath": 0, "overflows": 0}
    wrong = []
    for start in range(0, count, CHUNK):
        n = min(CHUNK, count - start)
        xs = make(rng, n)
        slow = np.ones(n, bool)
        if quick and HAS_64_BITS:
            with np.errstate(all="ignore"):
                operand = getattr(quick, "operand", long)
                m, e, slow = nearest(*quick(*map(operand, xs)))
            slow |= rng.random(n) < sample / count
        at = np.flatnonzero(slow)
        right = list(map(reference, *(x[at].tolist() for x in xs)))
        over = at[[r is None for r in right]]
        for i in over[:20]:
            try:
                result = ours(*(x[i : i + 1] for x in xs))
            except OverflowError:
                continue
            wrong.append((*(x[i] for x in xs), result, "overflow"))
        kept = np.ones(n, bool)
        kept[over] = False
        results = ours(*(x[kept] for x in xs))
        if isinstance(results, Decimal8Array):
            # That these are the nearest floats is proven by to_float.
            named = Decimal8Array.from_parts(results.mantissa, results.exponent).to_float()
            for i in np.flatnonzero(results.to_float() != named)[:20]:
                wrong.append((*(x[kept][i] for x in xs), results[i], "not the nearest float"))
        if not slow.all():
            fast = ~slow[kept]
            unlike = (results.mantissa != m[kept]) | (results.exponent != e[kept])
            for i in np.flatnonzero(unlike & fast):
                case = (str(x[kept][i]) for x in xs)
                wrong.append((*case, str(results[i]), f"{m[kept][i]} e {e[kept][i]}"))
            results = results[slow[kept]]
        right = [r for r in right if r is not None]
        operands_ = [x[kept & slow].tolist() for x in xs]
        results = results if isinstance(results, list) else results.tolist()
        wrong += [
            (*(str(x[i]) for x in operands_), str(a), str(b))
            for i, (a, b) in enumerate(zip(results, right, strict=True))
            if a != b
        ]
        tally["mpmath" if quick else "exact"] += len(at)
        tally["64 bits"] += n - len(at)
        tally["overflows"] += len(over)
    return wrong, tally


def differences(name, count, seed, sample=300):
    """Operands, result and reference where the two differ."""
    return prove(name, count, seed, sample)[0]


TITLES = {
    "add": "a + b",
    "sub": "a - b",
    "mul": "a * b",
    "div": "a / b",
    "add_parts": "a + b, coordinates",
    "sub_parts": "a - b, coordinates",
    "mul_short": "a * 2, 0.5, 12345 ...",
    "div_short": "a / 2, 0.5, 12345 ...",
    "rint": "round to integer",
    "compare": "< <= == != > >= of two",
    "compare_float": "the same with a float",
    "from_float": "from float",
    "to_float": "to float",
    "to_bytes": "to BCD bytes",
    "from_bytes": "from BCD bytes",
    "one_add": "a + b, `Decimal8`",
    "one_mul": "a * b, `Decimal8`",
    "one_div": "a / b, `Decimal8`",
    "one_sqrt": "sqrt, `Decimal8`",
    "ones_add": "a + b, arrays of one",
    "ones_mul": "a * b, arrays of one",
    "ones_div": "a / b, arrays of one",
    "ones_short": "a / 2, arrays of one",
    "ones_sqrt": "sqrt, arrays of one",
    "ones_from_float": "from float, arrays of one",
    "ones_cos_degrees": "cos, degrees, arrays of one",
    "pow": "a ** b",
}


def page(tallies, seed):
    """Yield a page of what was proven, and of what the arithmetic costs on this machine."""
    yield "# 8-digit decimal arithmetic: proof and cost"
    yield ""
    yield "`python benchmarks/prove_decimal8.py --record docs/decimal8.md` writes this page."
    yield ""
    yield "## Proof"
    yield ""
    yield from (
        "Every result of the operations below was compared with a reference that shares nothing",
        "with the arithmetic, digit by digit. Operands are random and edge cases mixed (few",
        "digits, next to powers of ten, ties, cancellation, zero, multiples of 15 degrees and of",
        "pi / 12, next to 1, Pythagorean triples), in arrays of 5,000: in every other one all",
        "exponents are those of parts, in the rest of the whole range. The references:",
        "",
        "* *exact*: Python's `decimal` with 8 digits and ROUND_HALF_UP.",
        "* *64 bits*: functions of the C library in x87 long doubles. The interval of their",
        "  value and 64 times the error that they promise rounds to one 8-digit number.",
        "* *mpmath*: 50 digits or more: all that the 64 bits leave open, and a random sample.",
        "",
        "*Overflows*: results beyond 10^99 by the reference; of each 5,000 operands 20 of them",
        "are tried, and must raise OverflowError.",
    )
    yield ""
    yield f"Seed {seed}. Operands by reference:"
    yield ""
    yield "| operation | operands | different | exact | 64 bits | mpmath | overflows |"
    yield "|---|---|---|---|---|---|---|"
    for name, (different, tally) in tallies.items():
        exact, quick, mp, over = tally.values()
        title = TITLES.get(name, name.replace("_", ", "))
        yield (
            f"| {title} | {exact + quick + mp:,} | {different} | "
            + " | ".join(f"{n:,}" if n else "" for n in (exact, quick, mp, over))
            + " |"
        )
    yield ""
    yield "## Cost"
    yield ""
    yield from (
        f"One core of {platform.machine()}, Python {platform.python_version()}, numpy "
        f"{np.__version__}; side by side in one",
        "run. An element of an array of 1,000,000, ns, against Python's `decimal` in a loop and",
        "numpy's float64:",
    )
    yield ""
    yield from bench_decimal8.large_table(bench_decimal8.measure(1_000_000, 15))
    yield ""
    yield "An operation on a short array, us, by number of elements; in brackets float64:"
    yield ""
    yield from bench_decimal8.short_table(bench_decimal8.short(15))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("operation", nargs="*", default=list(OPERATIONS))
    parser.add_argument(
        "--count",
        type=int,
        default=1_000_000,
        help="operands per operation; a tenth where arrays of one element are done one by one",
    )
    parser.add_argument("--sample", type=int, default=20_000, help="at least so many by mpmath")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", type=Path, help="write a page, with what everything costs")
    arguments = parser.parse_args()
    tallies = {}
    for name in arguments.operation:
        start = time.perf_counter()
        count = arguments.count // 10 if name.startswith("ones_") else arguments.count
        wrong, tally = prove(name, count, arguments.seed, arguments.sample)
        tallies[name] = len(wrong), tally
        told = ", ".join(f"{n} {kind}" for kind, n in tally.items() if n)
        took = time.perf_counter() - start
        print(f"{name:14} {len(wrong)} different of {told}  {took:7.1f} s", flush=True)
        for case in wrong[:5]:
            print("   ", *case)
    if arguments.record:
        arguments.record.write_text("\n".join(page(tallies, arguments.seed)) + "\n", "utf-8")
    sys.exit(any(different for different, _ in tallies.values()))


if __name__ == "__main__":
    main()

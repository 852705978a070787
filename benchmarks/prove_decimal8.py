"""Hold the 8-digit arithmetic against Python's `decimal` and against mpmath, operand by operand.

Run: python benchmarks/prove_decimal8.py [--count N] [--seed S] [operation ...]. For each operation
N operands, random and edge cases mixed; every result must be identical, digit by digit. The
reference for + - * / is `decimal` with 8 digits and ROUND_HALF_UP, for the other functions mpmath
with 50 digits (more where an operand's exponent eats them, or where 50 do not decide), for powers
by integers `decimal` with as many digits as the exact value has. A million takes some seconds for
sums and a minute or more for a sine.
"""

import argparse
import decimal
import sys
import time
from decimal import Decimal

import mpmath
import numpy as np

from wedmcam.decimal8 import Decimal8Array, hypot
from wedmcam.decimal8.form import HIGH, LOW

EIGHT = decimal.Context(prec=8, rounding=decimal.ROUND_HALF_UP, Emax=10**6, Emin=-(10**6))
EXACT = decimal.Context(prec=3000, Emax=10**9, Emin=-(10**9))
LONG = decimal.Context(prec=400, Emax=10**9, Emin=-(10**9))
#: 0.dddddddd x 10^99 and 0.1 x 10^-99.
TOO_LARGE, SMALLEST = Decimal("1e99"), Decimal("1e-100")


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
    return Decimal8Array.from_parts(mantissas(rng, n), rng.integers(low, high + 1, n))


def pairs(rng, n, span=99, near=12):
    """Two operands: exponents near each other mostly, cancellation and equality among them."""
    a = operands(rng, n, -span, span)
    e = np.clip(a.exponent + rng.integers(-near, near + 1, n), -span, span)
    m = mantissas(rng, n)
    close = rng.random(n) < 0.15
    near_m = np.clip(np.abs(a.mantissa) + rng.integers(-3, 4, n), LOW, HIGH - 1)
    m = np.where(close, -np.sign(a.mantissa) * near_m, m)
    e = np.where(close, np.clip(a.exponent + rng.integers(-1, 2, n), -span, span), e)
    return a, Decimal8Array.from_parts(m, e)


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
    turns = rng.random(n) < 0.2
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


OPERATIONS = {
    "add": (pairs, lambda a, b: a + b, lambda a, b: rounded(EXACT.add(a, b))),
    "sub": (pairs, lambda a, b: a - b, lambda a, b: rounded(EXACT.subtract(a, b))),
    "mul": (pairs, lambda a, b: a * b, lambda a, b: rounded(EXACT.multiply(a, b))),
    "div": (pairs, lambda a, b: a / b, lambda a, b: rounded(EIGHT.divide(a, b))),
    "sqrt": (
        lambda rng, n: (abs(operands(rng, n, -99, 99)),),
        np.sqrt,
        lambda a: rounded(decimal.Context(prec=50).sqrt(a)),
    ),
    "sin": (lambda rng, n: (angles(rng, n, 40),), np.sin, mp_case(mpmath.sin)),
    "cos": (lambda rng, n: (angles(rng, n, 40),), np.cos, mp_case(mpmath.cos)),
    "tan": (lambda rng, n: (angles(rng, n, 40),), np.tan, mp_case(mpmath.tan)),
    "asin": (lambda rng, n: (sines(rng, n),), np.arcsin, mp_case(mpmath.asin)),
    "acos": (lambda rng, n: (sines(rng, n),), np.arccos, mp_case(mpmath.acos)),
    "atan": (lambda rng, n: (operands(rng, n, -9, 20),), np.arctan, mp_case(mpmath.atan)),
    "atan2": (points, np.arctan2, mp_case(mpmath.atan2, 0)),
    "sin_degrees": (lambda r, n: (degrees(r, n),), lambda a: a.sin(True), in_degrees("sin")),
    "cos_degrees": (lambda r, n: (degrees(r, n),), lambda a: a.cos(True), in_degrees("cos")),
    "tan_degrees": (
        lambda r, n: (no_pole(degrees(r, n)),),
        lambda a: a.tan(True),
        in_degrees("tan"),
    ),
    "asin_degrees": (lambda r, n: (sines(r, n),), lambda a: a.asin(True), angle_of(mpmath.asin)),
    "acos_degrees": (lambda r, n: (sines(r, n),), lambda a: a.acos(True), angle_of(mpmath.acos)),
    "atan_degrees": (
        lambda r, n: (operands(r, n, -9, 20),),
        lambda a: a.atan(True),
        angle_of(mpmath.atan),
    ),
    "atan2_degrees": (points, lambda a, b: a.atan2(b, True), angle_of(mpmath.atan2)),
    "hypot": (legs, hypot, hypotenuse),
    "pow": (bases, lambda a, b: a**b, power),
    "rint": (lambda rng, n: (operands(rng, n, -12, 20),), np.rint, integer),
    "radians": (
        lambda rng, n: (operands(rng, n, -98, 99),),
        np.radians,
        lambda x: from_mp(lambda t: t * mpmath.pi / 180, 0, x),
    ),
    "degrees": (
        lambda rng, n: (operands(rng, n, -98, 97),),
        np.degrees,
        lambda x: from_mp(lambda t: t * 180 / mpmath.pi, 0, x),
    ),
}


def differences(name, count, seed):
    """Operands, result and reference where the two differ; overflow must be agreed on as well."""
    make, ours, reference = OPERATIONS[name]
    rng = np.random.default_rng([seed, *name.encode()])
    wrong = []
    for start in range(0, count, 10_000):
        n = min(10_000, count - start)
        xs = make(rng, n)
        if name == "div":
            xs[1][xs[1] == 0] = 1
        right = list(map(reference, *(x.tolist() for x in xs)))
        over = np.array([r is None for r in right])
        for i in np.flatnonzero(over)[:20]:
            try:
                result = ours(*(x[i : i + 1] for x in xs))
            except OverflowError:
                continue
            wrong.append((*(x[i] for x in xs), result, "overflow"))
        results = ours(*(x[~over] for x in xs)).tolist()
        expected = [r for r in right if r is not None]
        kept = [x[~over] for x in xs]
        wrong += [
            (*(str(x[i]) for x in kept), str(a), str(b))
            for i, (a, b) in enumerate(zip(results, expected, strict=True))
            if a != b
        ]
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("operation", nargs="*", default=list(OPERATIONS))
    parser.add_argument("--count", type=int, default=1_000_000, help="operands per operation")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    failed = False
    for name in arguments.operation:
        start = time.perf_counter()
        wrong = differences(name, arguments.count, arguments.seed)
        failed |= bool(wrong)
        print(
            f"{name:14} {arguments.count:9} operands  {len(wrong)} different"
            f"  {time.perf_counter() - start:7.1f} s",
            flush=True,
        )
        for case in wrong[:5]:
            print("   ", *case)
    sys.exit(failed)


if __name__ == "__main__":
    main()

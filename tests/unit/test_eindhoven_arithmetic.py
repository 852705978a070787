"""The arithmetic of the 8085 against a second transcription of the report: shifts and additions.

Nothing here divides or multiplies where the report says how it is done: VERM adds shifted numbers,
DIVIDE doubles, halves and subtracts. Laws are exhaustive: all roots, all shifts, all reduced pairs
at all speeds.
"""

import numpy as np
import pytest

from wedmcam.controllers.eindhoven import arithmetic as fast

WORD = 65535


def verm(a, b):
    """8 x 8 -> 16 bits: ``a`` is added, doubled each time, where a bit of ``b`` is set."""
    total = np.zeros(np.broadcast_shapes(np.shape(a), np.shape(b)), np.int32)
    for bit in range(8):
        total += np.where((b >> bit) & 1, a << bit, 0).astype(np.int32)
    return total


def divide(a, b):
    """Whole division: the divisor is doubled until it is greater, then halved, and subtracted."""
    a, b = (np.ascontiguousarray(v, np.int32) for v in np.broadcast_arrays(a, b))
    rest, quotient, d = a.copy(), np.zeros_like(a), b.copy()
    doubled = 0
    while (d <= a).any() and doubled < 17:
        d, doubled = d << 1, doubled + 1
    for _ in range(doubled):
        d >>= 1
        fits = rest >= d
        rest -= np.where(fits, d, 0)
        quotient = (quotient << 1) + fits
    quotient[a < b] = 1
    quotient[(a == 0) | (b == 0)] = 0
    return quotient


def root_by_hand(n):
    """As printed, with the integers of Python."""
    x, new = n, (n + 1) // 2
    while x != new:
        x, new = new, (n // new + new + 1) // 2
    return x


def reduc_by_hand(a, b):
    while a * a + b * b > WORD:
        a, b = a // 2, b // 2
    return a, b


def test_all_roots_end_as_printed():
    every = np.arange(WORD + 1)
    roots = fast.root(every)
    assert roots.tolist() == [root_by_hand(n) for n in range(WORD + 1)]
    assert np.abs(roots - np.sqrt(every)).max() < 0.5858
    assert roots[:9].tolist() == [0, 1, 2, 2, 2, 2, 3, 3, 3]
    assert roots.max() == 256  # no byte
    squares = np.arange(256)
    assert (fast.root(squares * squares) == squares).all()


def test_in_literal_16_bits_one_root_alone_is_another():
    """n + 1 overflows for 65535: xnew is 0. It is no sum of two squares."""
    a = np.arange(256)
    sums = np.unique(a[:, None] ** 2 + a**2)
    assert WORD not in sums
    wrapped = (np.arange(WORD + 1, dtype=np.uint16) + np.uint16(1)) // 2
    assert np.flatnonzero(wrapped != (np.arange(WORD + 1) + 1) // 2).tolist() == [WORD]


def test_subsgn_for_every_value():
    every = np.arange(WORD + 1)
    for other in (0, 1, 2, 255, 256, 32767, 32768, 65534, 65535):
        for a, b in ((every, np.full_like(every, other)), (np.full_like(every, other), every)):
            size, sign = fast.subsgn(a, b)
            borrow = a < b  # the carry of an 8085 behind A - B
            assert (size == np.where(borrow, (b - a) & WORD, (a - b) & WORD)).all()
            assert (sign == np.where(borrow, -1, 1)).all()
    rng = np.random.default_rng(15)
    a, b = rng.integers(0, WORD + 1, (2, 200_000))
    size, sign = fast.subsgn(a, b)
    assert (b + sign * size == a).all()


def test_reduc_for_every_value_at_every_shift():
    every = np.arange(WORD + 1)
    for shift in range(10):
        # The other number forces so many halvings, or more where ``every`` asks for them.
        other = np.full_like(every, (255 << shift) & WORD)
        a, b = fast.reduc(every, other)
        x, y = every.copy(), other.copy()
        for _ in range(9):
            over = (
                x.astype(object) ** 2 + y.astype(object) ** 2 > WORD
                if shift < 1
                else (x * x + y * y > WORD)
            )
            over = np.asarray(over, bool)
            x, y = np.where(over, x // 2, x), np.where(over, y // 2, y)
        assert (a == x).all()
        assert (b == y).all()
        assert (a * a + b * b <= WORD).all()
        assert max(a.max(), b.max()) <= 255
    for x, y in np.random.default_rng(3).integers(0, WORD + 1, (2000, 2)).tolist():
        a, b = fast.reduc(np.array([x]), np.array([y]))
        assert (int(a[0]), int(b[0])) == reduc_by_hand(x, y)


def test_reduc_drops_no_more_than_it_has_to():
    a, b = np.random.default_rng(4).integers(0, WORD + 1, (2, 100_000))
    x, y = fast.reduc(a, b)
    halved = (x != a) | (y != b)
    before = np.maximum(2 * x, 2 * y)[halved]
    assert ((before + 2) ** 2 * 2 > WORD).all()
    assert fast.reduc(np.array([65535]), np.array([255])) == (np.array([255]), np.array([0]))


def test_verm_and_divide_are_what_the_transcription_makes():
    a = np.arange(256, dtype=np.int32)
    assert (verm(a[:, None], a) == a[:, None] * a).all()
    n, d = np.arange(0, 32400, 7)[:, None], np.arange(0, 257)
    assert (divide(n, d) == fast.divide(n, d)).all()


def test_all_reduced_pairs_at_all_speeds():
    """51,720 pairs times 127 speeds."""
    side = np.arange(256, dtype=np.int32)
    square = np.array([int(verm(np.int32(v), np.int32(v))) for v in side], np.int32)
    a, b = (v.ravel() for v in np.meshgrid(side, side, indexing="ij"))
    fits = square[a] + square[b] <= WORD
    a, b = a[fits], b[fits]
    assert len(a) == 51_720
    by_hand = {int(n): root_by_hand(int(n)) for n in np.unique(square[a] + square[b])}
    length = np.array([by_hand[int(n)] for n in (square[a] + square[b])], np.int32)
    speed = np.arange(1, 128, dtype=np.int32)
    product = verm(side[:, None], speed)  # VELOCM multiplies first
    quotient = divide(np.arange(255 * 127 + 1, dtype=np.int32)[:, None], np.arange(257))
    for low in range(0, len(a), 8192):
        rows = slice(low, low + 8192)
        got = fast.poscal(a[rows, None], b[rows, None], speed)
        for mine, component in ((got.x, a[rows]), (got.y, b[rows])):
            assert (mine == quotient[product[component], length[rows, None]]).all()
            assert mine.max() <= 127  # seven bits


def test_a_component_that_divide_sees_is_never_lost():
    a, b = np.random.default_rng(5).integers(0, WORD + 1, (2, 50_000))
    got = fast.poscal(a, b, np.full(len(a), 1))
    x, y = fast.reduc(a, b)
    assert ((got.x > 0) == (x > 0)).all()
    assert ((got.y > 0) == (y > 0)).all()


@pytest.mark.parametrize(("speed", "degrees"), [(1, 44.8), (10, 5.5), (127, 0.45)])
def test_directions_are_as_coarse_as_the_speed_is_low(speed, degrees):
    a, b = (v.ravel() for v in np.meshgrid(np.arange(256), np.arange(256)))
    fits = (a * a + b * b <= WORD) & (a + b > 0)
    a, b = a[fits], b[fits]
    got = fast.poscal(a, b, np.full(len(a), speed))
    off = np.degrees(np.abs(np.arctan2(got.y, got.x) - np.arctan2(b, a)))
    assert degrees - 0.06 < off.max() <= degrees
    rate = np.hypot(got.x, got.y) / speed
    assert rate.min() >= 0.70
    assert rate.max() < 1.415


def test_the_table_of_sines_is_within_half_a_degree_at_every_speed():
    """255 values of 8 bits; the author says 0.5 degree."""
    table = fast.sines()
    assert (len(table), table.min(), table.max()) == (255, 0, 255)
    assert (np.diff(table) >= 0).all()
    angle = np.radians(np.linspace(0.0, 90.0, 90_001))
    a, b = np.rint(60_000 * np.cos(angle)).astype(int), np.rint(60_000 * np.sin(angle)).astype(int)
    for speed in (1, 10, 127):
        got = fast.sine_speeds(a, b, np.full(len(a), speed))
        off = np.degrees(np.abs(np.arctan2(got.y, got.x) - np.arctan2(b, a)))
        assert 0.2 < off.max() < 0.26
        rate = np.hypot(got.x, got.y) / (speed * got.scale)
        assert rate.min() > 0.996
        assert rate.max() < 1.003


def test_an_entry_of_the_table_is_the_nearest_one():
    a, b = np.random.default_rng(6).integers(0, WORD + 1, (2, 3000))
    s = fast.sines()
    ways = np.arctan2(s, s[::-1])
    near = np.abs(np.arctan2(b, a)[:, None] - ways).argmin(axis=1)
    got = fast.entry(a, b)
    off = np.abs(np.arctan2(b, a) - ways[got]) - np.abs(np.arctan2(b, a) - ways[near])
    assert (off < 1e-5).all()  # the sum of two entries halves their angle

"""Where the images of a figure lie, in 8-digit decimals: what the words of a transform mean.

An image is the figure turned over or not, turned, moved, and run forwards or backwards. Its angle
is exact and its place is whole um and a rest below one, so that no digits are lost: copy 9,999 of a
translation is as near as copy 1. Every image is computed from the figure itself and never from the
image before. Frame: the program starts at (0, 0); lengths are um (steps of the machine).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wedmcam.controllers.zd065.data import Floats, Ints, decimals, whole
from wedmcam.ir.figure import Mirror, Reverse, Rotate, Symmetry, Transform, Translate, With
from wedmcam.ir.figure import Sequence as Stages

#: Images nearer to each other than this, in the same turn, are one, um.
SAME_UM = 1.0


class Points(NamedTuple):
    """Places as whole um and a rest in -1/2 .. 1/2 um of at most 8 digits."""

    x: Ints
    y: Ints
    rest_x: Floats
    rest_y: Floats

    @property
    def nearest(self) -> Ints:
        """The nearest whole places, shape (n, 2): each is rounded once."""
        x, y = np.floor(self.rest_x + 0.5), np.floor(self.rest_y + 0.5)
        return np.column_stack([self.x + x.astype(np.int64), self.y + y.astype(np.int64)])

    @property
    def exact(self) -> Floats:
        """The places, shape (n, 2); float64 holds them to 1e-6 um up to 1 km."""
        return np.column_stack([self.x + self.rest_x, self.y + self.rest_y])


def points(x: Ints, y: Ints, rest_x: Floats | float = 0.0, rest_y: Floats | float = 0.0) -> Points:
    """Return places with their rests below half a um."""
    zero = np.zeros(len(x))
    columns = []
    for n, rest in ((x, rest_x + zero), (y, rest_y + zero)):
        more = np.rint(rest)
        columns.append((n + more.astype(np.int64), rest - more + 0.0))
    (a, u), (b, v) = columns
    return Points(a, b, u, v)


@dataclass(frozen=True, slots=True)
class Image:
    """One image of a figure.

    Attributes:
        over: reflected in the x axis before it is turned.
        degrees: counter-clockwise, exact, 0 <= degrees < 360.
        place: where the middle of the figure lies, one of `Points`.
        back: its blocks are run in reverse order, each from its end to its start.
        copy: numbers of the copies that made it, one for each transform with copies; 0 is the
            figure itself.
    """

    over: bool
    degrees: Fraction
    place: tuple[int, int, float, float]
    back: bool = False
    copy: tuple[int, ...] = ()

    @property
    def is_even(self) -> bool:
        """Whether whole numbers stay whole: turned by whole quarters."""
        return self.degrees % 90 == 0

    def of(self, x: Ints, y: Ints) -> Points:
        """Return the images of places of the figure, seen from its middle, um."""
        u, v, rest_x, rest_y = turned(x, -y if self.over else y, self.degrees)
        px, py, sx, sy = self.place
        return points(u + px, v + py, rest_x + sx, rest_y + sy)


def turned(x: Ints, y: Ints, degrees: Fraction) -> Points:
    """Return vectors turned counter-clockwise, within 2e-8 of their length.

    Whole quarters are exact. The rest, at most 45 degrees, moves the end of the vector along a
    chord, 2 sin(t / 2) times its length at right angles to its middle: what is small is computed
    with all 8 digits, and added to what is whole.

    >>> turned(np.array([10_000]), np.array([0]), Fraction(30)).exact.round(3).tolist()
    [[8660.254, 5000.0]]
    """
    quarter = math.ceil(degrees / 90 - Fraction(1, 2))
    rest = degrees - 90 * quarter
    x, y = ((x, y), (-y, x), (-x, -y), (y, -x))[quarter % 4]
    if not rest:
        return points(x, y)
    half = decimals([float(rest / 2)])
    sine, cosine = half.sin(degrees=True), half.cos(degrees=True)
    chord = sine + sine
    dx, dy = decimals(x), decimals(y)
    along, across = -chord * (dy * cosine + dx * sine), chord * (dx * cosine - dy * sine)
    wx, wy = whole(along), whole(across)
    # The difference of a number and the nearest whole one is exact.
    return points(x + wx, y + wy, along.to_float() - wx, across.to_float() - wy)


def images(transforms: Iterable[Transform]) -> tuple[list[Image], list[Image]]:
    """Return the images that a figure becomes, in the order of the path, and those left out.

    Args:
        transforms: one after the other. Symmetries and mirrors are about (0, 0), lengths um.

    Returns:
        Images whose ``place`` is that of the point (0, 0); and those that a transform would have
        laid on an image that is there.

    >>> [i.place[:2] for i in images([Translate(10_000, 0, 2)])[0]]
    [(0, 0), (10000, 0), (20000, 0)]
    """
    out, left = [Image(False, Fraction(0), (0, 0, 0.0, 0.0))], []
    for transform in transforms:
        out, gone = _after(out, transform)
        left += gone
    return out, left


def _after(figure: list[Image], t: Transform) -> tuple[list[Image], list[Image]]:
    """Return what a transform makes of a figure of images, and the images left out."""
    if isinstance(t, Stages):
        left: list[Image] = []
        for part in t.transforms:
            figure, gone = _after(figure, part)
            left += gone
        return figure, left
    if isinstance(t, Reverse):
        return backwards(figure), []
    if isinstance(t, With):
        inner = t.transform
        if isinstance(inner, With) or (isinstance(inner, Translate | Rotate) and inner.copies):
            return _after(figure, inner)
        image, left = _after(figure, inner)
        if _turns_over(inner):
            image = backwards(image)
        made = [replace(i, copy=(*i.copy, 1)) for i in image]
        kept, gone = _distinct([replace(i, copy=(*i.copy, 0)) for i in figure], made)
        return kept, left + gone
    if isinstance(t, Symmetry | Mirror):
        angle = {"x": 0, "y": 180, 45: 90, 135: 270}[
            t.axis if isinstance(t, Symmetry) else t.degrees
        ]
        return [_reflected(i, Fraction(angle)) for i in figure], []
    if not t.copies:
        return [_copied(i, t, 1) for i in figure], []
    made = [
        replace(_copied(i, t, k), copy=(*i.copy, k)) for k in range(1, t.copies + 1) for i in figure
    ]
    return _distinct([replace(i, copy=(*i.copy, 0)) for i in figure], made)


def backwards(figure: Sequence[Image]) -> list[Image]:
    """Return images run the other way, the last one first."""
    return [replace(i, back=not i.back) for i in reversed(figure)]


def _turns_over(t: Transform) -> bool:
    if isinstance(t, Stages):
        return sum(_turns_over(part) for part in t.transforms) % 2 == 1
    return isinstance(t, Symmetry | Mirror)


def _distinct(figure: list[Image], made: list[Image]) -> tuple[list[Image], list[Image]]:
    """Return figure and new images without those that lie on an earlier one, and these."""
    out: list[Image] = list(figure)
    left: list[Image] = []
    known: dict[tuple[bool, Fraction, int, int], list[Image]] = {}
    for image in figure:
        known.setdefault(_cell(image), []).append(image)
    for image in made:
        over, degrees, x, y = cell = _cell(image)
        near = [(over, degrees, x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        if any(_apart(image, other) <= SAME_UM for key in near for other in known.get(key, ())):
            left.append(image)
        else:
            out.append(image)
            known.setdefault(cell, []).append(image)
    return out, left


def _cell(image: Image) -> tuple[bool, Fraction, int, int]:
    """Return a key that images of the same turn share, or have a neighbour of, if they are near."""
    x, y, u, v = image.place
    return image.over, image.degrees, x + math.floor(u), y + math.floor(v)


def _apart(a: Image, b: Image) -> float:
    (ax, ay, au, av), (bx, by, bu, bv) = a.place, b.place
    return math.hypot(ax - bx + au - bu, ay - by + av - bv)


def _reflected(image: Image, degrees: Fraction) -> Image:
    """Reflect in the x axis, then turn by whole quarters: exact."""
    x, y, u, v = image.place
    y, v = -y, -v
    for _ in range(int(degrees) // 90):
        x, y, u, v = -y, x, -v, u
    return _placed(image, not image.over, degrees - image.degrees, (x, y, u, v))


def _copied(image: Image, t: Translate | Rotate, k: int) -> Image:
    """Return copy k of an image."""
    return _translated(image, t, k) if isinstance(t, Translate) else _rotated(image, t, k)


def _translated(image: Image, t: Translate, k: int) -> Image:
    x, y, u, v = image.place
    (dx, du), (dy, dv) = (_parted(k * Fraction(d)) for d in (t.x, t.y))
    return _placed(image, image.over, image.degrees, (x + dx, y + dy, u + du, v + dv))


def _rotated(image: Image, t: Rotate, k: int) -> Image:
    """Turn the place about a point, whole um and rest each by itself."""
    turn = Fraction(t.degrees) * k % 360
    x, y, u, v = image.place
    (ax, au), (ay, av) = (_parted(Fraction(a)) for a in t.about)
    far = turned(np.array([x - ax]), np.array([y - ay]), turn)
    near_x, near_y = _rest_turned(u - au, v - av, turn)
    place = (
        int(far.x[0]) + ax,
        int(far.y[0]) + ay,
        float(far.rest_x[0]) + near_x + au,
        float(far.rest_y[0]) + near_y + av,
    )
    return _placed(image, image.over, image.degrees + turn, place)


def _rest_turned(u: float, v: float, degrees: Fraction) -> tuple[float, float]:
    """Return a vector below a um turned: in units of 1e-8 um it is whole."""
    if not (u or v):
        return 0.0, 0.0
    fine = turned(np.array([round(u * 1e8)]), np.array([round(v * 1e8)]), degrees)
    return float(fine.exact[0, 0]) / 1e8, float(fine.exact[0, 1]) / 1e8


def _placed(
    image: Image, over: bool, degrees: Fraction, place: tuple[int, int, float, float]
) -> Image:
    x, y, u, v = place
    p = points(np.array([x]), np.array([y]), u, v)
    at = (int(p.x[0]), int(p.y[0]), float(p.rest_x[0]), float(p.rest_y[0]))
    return replace(image, over=over, degrees=degrees % 360, place=at)


def _parted(value: Fraction) -> tuple[int, float]:
    """Return the nearest whole number and the rest."""
    n = round(value)
    return n, float(value - n)

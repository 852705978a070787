"""One rigid motion of contours: turned over or not, turned about a point, moved.

Every figure transform is this one formula, so there is one place in which a sign can be wrong. What
needs no arithmetic is done without: about the zero point, a symmetry, a mirror and a quarter turn
are changes of sign and of place, exact to the digit. Everything else is computed over an
`Arithmetic`, relative to a whole-um origin near the part: 8 digits are 0.01 um there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import EntityRef, Span, TextSpan
from wedmcam.geom.segments import Floats
from wedmcam.ir.contour import Contour


@dataclass(frozen=True, slots=True)
class Motion:
    """Reflect in a line parallel to x (or not), turn, both about one point; then move.

    Attributes:
        degrees: counter-clockwise, any value; exact, so that 7 times 360/7 is a full turn.
        turned_over: y becomes -y before the turn.
        about: the fixed point, um.
        shift: um, added at the end.
    """

    degrees: Fraction = Fraction(0)
    turned_over: bool = False
    about: tuple[float, float] = (0.0, 0.0)
    shift: tuple[float, float] = (0.0, 0.0)

    @property
    def is_identity(self) -> bool:
        """Whether nothing moves."""
        return not (self.degrees % 360 or self.turned_over or any(self.shift))


#: (x, y) -> (x, -y) and (-x, y) [D]: symmetry about the x axis and about the y axis.
SYMMETRY_X = Motion(turned_over=True)
SYMMETRY_Y = Motion(Fraction(180), turned_over=True)
#: (x, y) -> (y, x) and (-y, -x): reflection in the line through 0 at 45 and at 135 degrees.
MIRROR_45 = Motion(Fraction(90), turned_over=True)
MIRROR_135 = Motion(Fraction(270), turned_over=True)


def quarters(degrees: Fraction) -> tuple[int, Fraction]:
    """Return quarter turns 0..3 and the rest in -45 < rest <= 45 degrees.

    >>> quarters(Fraction(350)), quarters(Fraction(-90)), quarters(Fraction(45))
    ((0, Fraction(-10, 1)), (3, Fraction(0, 1)), (0, Fraction(45, 1)))
    """
    n = math.ceil(degrees / 90 - Fraction(1, 2))
    return n % 4, degrees - 90 * n


def _quarter_turned(n: int, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    x, y = ((x, y), (-y, x), (-x, -y), (y, -x))[n]
    return x + 0.0, y + 0.0  # never -0


def whole_origin(contours: Sequence[Contour]) -> tuple[float, float]:
    """Return the whole-um point next to the middle of all vertices and centres' box."""
    if not contours:
        return 0.0, 0.0
    low = [min(float(c.vertices[k].min()) for c in contours) for k in ("x", "y")]
    high = [max(float(c.vertices[k].max()) for c in contours) for k in ("x", "y")]
    return (
        float(round((low[0] + high[0]) / 2)),
        float(round((low[1] + high[1]) / 2)),
    )


def moved_points(
    motion: Motion, x: Floats, y: Floats, origin: tuple[float, float], ar: Arithmetic
) -> tuple[Floats, Floats]:
    """Return the images of points.

    Args:
        motion: what is done.
        x: um.
        y: likewise.
        origin: whole um, near the points; distances from it are what the arithmetic sees.
        ar: the arithmetic.

    Returns:
        um. In float64 within 1e-9 um for parts up to 1 m; exact for whole um and whole quarters.

    >>> from wedmcam.arithmetic import FLOAT64
    >>> x, y = moved_points(MIRROR_45, np.array([3.0]), np.array([7.5]), (0.0, 0.0), FLOAT64)
    >>> x.tolist(), y.tolist()
    ([7.5], [3.0])
    """
    if motion.is_identity or not len(x):
        return x, y
    quarter, rest = quarters(motion.degrees)
    flip = -1.0 if motion.turned_over else 1.0
    if not rest and not any(motion.shift) and not any(motion.about):
        return _quarter_turned(quarter, x, flip * y)
    u, v = _quarter_turned(quarter, x - origin[0], flip * (y - origin[1]))
    # The origin itself, seen from the fixed point.
    px, py = _quarter_turned(
        quarter,
        np.array([origin[0] - motion.about[0]]),
        flip * np.array([origin[1] - motion.about[1]]),
    )
    fixed = (motion.about[0] + motion.shift[0], motion.about[1] + motion.shift[1])
    au, av = ar.array(u), ar.array(v)
    if rest:
        angle = ar.array(np.array([math.radians(rest)]))
        c, s = ar.cos(angle), ar.sin(angle)
        au, av = au * c - av * s, au * s + av * c
        qx, qy = ar.array(px), ar.array(py)
        px, py = ar.to_float(qx * c - qy * s), ar.to_float(qx * s + qy * c)
    out = []
    for image, p, f in ((au, float(px[0]), fixed[0]), (av, float(py[0]), fixed[1])):
        # The image has a whole-um origin near it again; the rest of it is added in the arithmetic.
        whole, part = round(p) + round(f), (p - round(p)) + (f - round(f))
        if part:
            image = image + ar.array(np.array([part]))
        out.append(np.asarray(ar.to_float(image) + float(whole)))
    return out[0], out[1]


def moved(
    contours: Sequence[Contour],
    motion: Motion,
    ar: Arithmetic,
    copy: int = 0,
    origin: tuple[float, float] | None = None,
) -> tuple[Contour, ...]:
    """Return the images of contours, run as the originals are; reflected arcs turn over.

    Args:
        contours: um.
        motion: what is done; the identity returns the contours themselves.
        ar: the arithmetic of the formulas.
        copy: number that the sources of the images carry; 0 for none.
        origin: whole um near the part; `whole_origin` by default.
    """
    if motion.is_identity and not copy:
        return tuple(contours)
    origin = whole_origin(contours) if origin is None else origin
    rows = np.concatenate([c.vertices for c in contours]).copy() if contours else None
    if rows is None:
        return ()
    rows["x"], rows["y"] = moved_points(motion, rows["x"].copy(), rows["y"].copy(), origin, ar)
    arc = rows["turn"] != 0
    cx, cy = moved_points(motion, rows["cx"][arc], rows["cy"][arc], origin, ar)
    rows["cx"][arc], rows["cy"][arc] = cx, cy
    if motion.turned_over:
        rows["turn"] = -rows["turn"]
    out = []
    at = 0
    for c in contours:
        n = len(c.vertices)
        out.append(Contour(rows[at : at + n].copy(), c.closed, numbered(c.sources, copy)))
        at += n
    return tuple(out)


def numbered(sources: tuple[Span, ...], copy: int) -> tuple[Span, ...]:
    """Return the sources of copy number ``copy``: an entity is reached by way of its copy.

    >>> str(numbered((EntityRef("a.dxf", "2F", "ARC", "CUT"),), 3)[0])
    'a.dxf:#copy 3/2F layer CUT'
    """
    if not copy:
        return sources
    return tuple(_numbered(s, copy) for s in sources)


def _numbered(s: Span, copy: int) -> Span:
    if isinstance(s, EntityRef):
        return replace(s, via=(f"copy {copy}", *s.via))
    return replace(s, copies=(copy, *s.copies)) if isinstance(s, TextSpan) else s

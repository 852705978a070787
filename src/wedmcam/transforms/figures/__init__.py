"""Figures: translation, symmetry, mirror, rotation, with copies (平移, 对称, 镜象对称, 旋转).

The ZD-065's data processing on contours, before compensation: a figure is a tuple of contours, and
a transform makes a new one. Copies are computed from the original; chains that meet are joined.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, error, warning
from wedmcam.geom.measure import area
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import (
    MOST_COPIES,
    MOST_TURNS,
    Mirror,
    Reverse,
    Rotate,
    Sequence,
    Symmetry,
    Transform,
    Translate,
    With,
)
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.doubles import COPY_UM
from wedmcam.transforms.figures.join import drop_repeats, join_chains
from wedmcam.transforms.figures.motion import (
    MIRROR_45,
    MIRROR_135,
    SYMMETRY_X,
    SYMMETRY_Y,
    Motion,
    moved,
    moved_points,
    numbered,
    whole_origin,
)
from wedmcam.transforms.joints import near_pairs

#: More segments than this are a typing error and not a part.
MOST_SEGMENTS = 2_000_000
Figure = tuple[Contour, ...]
Threads = tuple[ThreadPoint, ...]


def transformed(
    contours: Iterable[Contour],
    transform: Transform,
    ar: Arithmetic,
    threads: Iterable[ThreadPoint] = (),
) -> tuple[tuple[Figure, Threads] | None, list[Diagnostic]]:
    """Return what a transform makes of a figure.

    Args:
        contours: the figure, um.
        transform: see `ir.figure`.
        ar: the arithmetic of the formulas.
        threads: thread points that belong to the figure; they follow it.

    Returns:
        The new figure, originals before copies, and its thread points; None after an error.
        Closed contours keep their sense but for reflection, which turns it over.
    """
    figure, points = tuple(contours), tuple(threads)
    findings: list[Diagnostic] = []
    if isinstance(transform, Sequence):
        for part in transform.transforms:
            image, more = transformed(figure, part, ar, points)
            findings += more
            if image is None:
                return None, findings
            figure, points = image
        return (figure, points), findings
    if isinstance(transform, Reverse):
        return (tuple(c.reversed() for c in reversed(figure)), points), findings
    if isinstance(transform, With):
        return _with(figure, points, transform, ar)
    if isinstance(transform, Symmetry):
        motions = [SYMMETRY_X if transform.axis == "x" else SYMMETRY_Y]
    elif isinstance(transform, Mirror):
        motions = [MIRROR_45 if transform.degrees == 45 else MIRROR_135]
    elif isinstance(transform, Translate):
        most, copies = MOST_COPIES, transform.copies
        by = (transform.x, transform.y)
        motions = [Motion(shift=(k * by[0], k * by[1])) for k in _numbers(copies)]
        findings += _limits(figure, copies, most)
    else:
        most, copies = MOST_TURNS, transform.copies
        turn = Fraction(transform.degrees)
        motions = [Motion(turn * k % 360, about=transform.about) for k in _numbers(copies)]
        findings += _limits(figure, copies, most)
    if findings:
        return None, findings
    keeps = getattr(transform, "copies", 0) > 0
    origin = whole_origin(figure)
    images = list(figure) if keeps else []
    spots = list(points) if keeps else []
    for number, motion in enumerate(motions, 1):
        copy = number if keeps else 0
        images += moved(figure, motion, ar, copy, origin)
        spots += _moved_threads(points, motion, ar)
    if not keeps:
        return (tuple(images), tuple(spots)), findings
    return _together(images, len(figure), spots, len(points), "copies")


def _numbers(copies: int) -> range:
    return range(1, max(copies, 1) + 1)


def _limits(figure: Figure, copies: int, most: int) -> list[Diagnostic]:
    """Return an error for too many copies (the parser has said it with its place)."""
    if not (isinstance(copies, int) and 0 <= copies <= most):
        return [
            error(
                "wed-value",
                "copies are a whole number up to {most}, not {copies}",
                most=most,
                copies=copies,
            )
        ]
    total = (copies + 1) * sum(len(c) for c in figure)
    if total > MOST_SEGMENTS:
        return [
            error(
                "too-large",
                "{copies} copies make {segments} segments; {most} are taken for a typing error",
                copies=copies,
                segments=total,
                most=MOST_SEGMENTS,
            )
        ]
    return []


def _with(
    figure: Figure, points: Threads, transform: With, ar: Arithmetic
) -> tuple[tuple[Figure, Threads] | None, list[Diagnostic]]:
    """Return the figure and its image; a reflected image runs in reverse."""
    keeps = isinstance(transform.transform, With)
    if keeps or (
        isinstance(transform.transform, Translate | Rotate) and transform.transform.copies
    ):
        return transformed(figure, transform.transform, ar, points)  # keeps the figure by itself
    result, findings = transformed(figure, transform.transform, ar, points)
    if result is None:
        return None, findings
    image, spots = result
    if _turns_over(transform.transform):
        image = tuple(c.reversed() for c in reversed(image))
    image = tuple(Contour(c.vertices, c.closed, numbered(c.sources, 1)) for c in image)
    result, more = _together([*figure, *image], len(figure), [*points, *spots], len(points), "with")
    return result, findings + more


def _turns_over(t: Transform) -> bool:
    """Whether a transform is a reflection."""
    if isinstance(t, Sequence):
        return sum(_turns_over(part) for part in t.transforms) % 2 == 1
    if isinstance(t, With):
        return False
    return isinstance(t, Symmetry | Mirror)


def _together(
    contours: list[Contour], own: int, threads: list[ThreadPoint], own_threads: int, what: str
) -> tuple[tuple[Figure, Threads], list[Diagnostic]]:
    """Return figure and images without repeats, chains joined."""
    figure, repeats = drop_repeats(contours, own, what)
    figure, joins = join_chains(figure)
    x, y = np.array([p.x for p in threads]), np.array([p.y for p in threads])
    i, j, _ = near_pairs(x, y, COPY_UM)
    gone: set[int] = set()
    for a, b in zip(i.tolist(), j.tolist(), strict=True):
        if a not in gone and b >= own_threads:
            gone.add(b)
    kept = [p for k, p in enumerate(threads) if k not in gone]
    return (figure, tuple(kept)), [*repeats, *joins]


def _moved_threads(points: Threads, motion: Motion, ar: Arithmetic) -> list[ThreadPoint]:
    x = np.array([p.x for p in points], dtype=float)
    y = np.array([p.y for p in points], dtype=float)
    origin = (float(np.round(x.mean())), float(np.round(y.mean()))) if points else (0.0, 0.0)
    mx, my = moved_points(motion, x, y, origin, ar)
    return [replace(p, x=u, y=v) for p, u, v in zip(points, mx.tolist(), my.tolist(), strict=True)]


def idle_reverse(contours: Iterable[Contour], transform: Transform) -> list[Diagnostic]:
    """Return a warning where ``reverse`` meets closed contours of a drawing, which it leaves."""
    parts = transform.transforms if isinstance(transform, Sequence) else (transform,)
    flat = [q for p in parts for q in (p.transforms if isinstance(p, Sequence) else (p,))]
    if not (any(isinstance(p, Reverse) for p in flat) and any(c.closed for c in contours)):
        return []
    return [
        warning(
            "reverse-closed",
            "closed contours of a drawing are cut counter-clockwise; 'reverse' does not change it",
            hint="--reverse cuts clockwise",
        )
    ]


def counter_clockwise(contours: Iterable[Contour]) -> Figure:
    """Return the contours with closed ones run counter-clockwise, as the later stages expect."""
    return tuple(c.reversed() if c.closed and area(c.vertices) < 0 else c for c in contours)


__all__ = [
    "Figure",
    "Mirror",
    "Motion",
    "Reverse",
    "Rotate",
    "Sequence",
    "Symmetry",
    "Transform",
    "Translate",
    "With",
    "counter_clockwise",
    "idle_reverse",
    "join_chains",
    "moved",
    "transformed",
]

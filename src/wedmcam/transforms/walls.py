"""Walls that no wire leaves standing: two contours some um apart, mostly one drawn twice.

An outline that was traced, or exported in two versions, lies beside itself by some um. Where the
two do not cross the inner one is read as a hole of the outer one, and the part would be the frame
between them. The wire's path is proven within 2 um on either side of such a wall (`judge`), so of
less than twice that nothing can be said to be left.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from wedmcam.diag import LISTED, Diagnostic, Place, Severity, error, warning
from wedmcam.geom import measure, pairs
from wedmcam.geom.gaps import Gaps, beside, gaps
from wedmcam.geom.segments import Floats, Ints, Segments, boxes
from wedmcam.ir.contour import Contour
from wedmcam.transforms.doubles import steady

#: Kept material thinner than this is no wall, um: the path is proven within 2 um on either side.
WALL_UM = 4.0
#: Up to this, um, contours touch, and up to this depth one does not cross the other: that is found
#: where contours are made (`meetings`).
TOUCH_UM = 0.01
#: Nearer than this contours do touch, um: the noise of float64.
NO_GAP_UM = 1e-6
#: Contours that run beside each other, up to `TWICE_UM` apart, for at least this share of either
#: one are one that is drawn twice.
MOST = 0.5
#: What was traced or exported twice is seldom farther apart, um (ours: no source has it).
TWICE_UM = 20.0


def thin(
    contours: Sequence[Contour],
    keeps: Sequence[bool | None],
    parts: Sequence[int] | None = None,
) -> tuple[list[Diagnostic], set[tuple[int, int]]]:
    """Return a finding for each pair of contours with next to nothing between them, and the pairs.

    Less than `WALL_UM` of kept material is an error. Contours that run beside each other, at most
    `TWICE_UM` apart, for most of their length are a warning: seldom is that meant, be it a frame
    as thin as that, or the same place cut twice (on the line, or as a slot).

    Args:
        contours: lines and arcs, um.
        keeps: for each, whether the material inside of it is kept (True) or that around it; None
            for a contour on the line and for an open one.
        parts: numbers of the parts that they belong to; None where all make one. Contours of two
            parts have no material between them.

    Equal contours are meant: only a part program has them, and cuts them in two passes or as punch
    and die.
    """
    if len(contours) < 2:
        return [], set()
    s, first = measure.segments_of_all([(c.vertices, c.closed) for c in contours])
    owner = np.repeat(np.arange(len(contours)), np.diff(first, append=len(s)))
    findings: list[tuple[float, float, Diagnostic]] = []
    close_pairs: set[tuple[int, int]] = set()
    for (a, b), i, j in _pairs(s, owner, first):
        g = gaps(s.take(i), s.take(j))
        near = np.flatnonzero((g.size > TOUCH_UM) & (g.size < TWICE_UM))
        one = parts is None or parts[a] == parts[b]
        least = int(np.argmin(g.size))
        if one and NO_GAP_UM < g.size[least] <= TOUCH_UM:
            findings.append(_touching(contours[a], contours[b], g, least))
        if not len(near):
            # Equal, or not near at all; or a polygon whose corners lie on the other outline.
            share, far = beside(s.take(owner == a), s.take(owner == b), TWICE_UM)
            if share >= MOST and far > TOUCH_UM:
                close_pairs.add((a, b))
                wall = one and keeps[a] is not None and keeps[b] is not None
                at = float(g.x[least]), float(g.y[least])
                findings.append(
                    (at[1], at[0], _finding(contours[a], contours[b], wall, share, far, at))
                )
            continue
        k = near[np.lexsort((steady(g.x[near]), steady(g.y[near]), steady(g.size[near])))[0]]
        x, y, size = (float(v[k]) for v in (g.x, g.y, g.size))
        touch = bool((g.size <= TOUCH_UM).any())
        wall = one and size < WALL_UM and all(_keeps(contours[c], keeps[c], x, y) for c in (a, b))
        within = WALL_UM if wall and not touch else TWICE_UM
        share = beside(s.take(owner == a), s.take(owner == b), within)[0]
        if share >= MOST or (wall and not touch):
            close_pairs.add((a, b))
            findings.append((y, x, _finding(contours[a], contours[b], wall, share, size, (x, y))))
    findings.sort(key=lambda f: (round(f[0], 3), round(f[1], 3)))
    shown = [f[2] for f in findings[:LISTED]]
    if len(findings) > LISTED:
        more = len(findings) - LISTED
        make = error if any(f[2].severity is Severity.ERROR for f in findings[LISTED:]) else warning
        shown.append(make("thin-wall", "{count} further pairs of contours like these", count=more))
    return shown, close_pairs


def _pairs(s: Segments, owner: Ints, first: Ints) -> Iterator[tuple[tuple[int, int], Ints, Ints]]:
    """Yield pairs of contours that may be drawn twice or have a thin wall, and their segments.

    A thin wall may be anywhere: all segments are asked. What is drawn twice has one box.
    """
    around = boxes(s)
    extents = [np.minimum.reduceat(v, first) for v in around[:2]]
    extents += [np.maximum.reduceat(v, first) for v in around[2:]]
    last = np.append(first[1:], len(owner))
    done = set()
    for a, b in _alike(extents):
        one, two = np.arange(first[a], last[a]), np.arange(first[b], last[b])
        i, j = pairs.overlapping(pairs.grow(boxes(s.take(one)), TWICE_UM), boxes(s.take(two)))
        done.add((a, b))
        yield (a, b), one[i], two[j]
    i, j = pairs.self_overlapping(pairs.grow(around, 0.5 * WALL_UM))
    other = owner[i] != owner[j]
    i, j = i[other], j[other]
    low, high = np.minimum(owner[i], owner[j]), np.maximum(owner[i], owner[j])
    order = np.lexsort((high, low))
    new = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    for group in np.split(order, np.flatnonzero(new)[1:]) if len(order) else ():
        pair = int(low[group[0]]), int(high[group[0]])
        if pair not in done:
            yield pair, i[group], j[group]


def _alike(extents: Sequence[Floats]) -> list[tuple[int, int]]:
    """Return the pairs a < b of boxes that differ by at most `TWICE_UM` on each side."""
    half = 0.5 * TWICE_UM
    x, y = extents[0], extents[1]
    a, b = pairs.self_overlapping((x - half, y - half, x + half, y + half))
    for high in extents[2:]:
        same = np.abs(high[a] - high[b]) <= TWICE_UM
        a, b = a[same], b[same]
    return list(zip(a.tolist(), b.tolist(), strict=True))


def _finding(
    a: Contour, b: Contour, wall: bool, share: float, size: float, at: tuple[float, float]
) -> Diagnostic:
    """Return the finding about two contours with a gap of ``size`` um at a place, um."""
    place = Place.of_um(*at)
    spans = sorted((a.source_of(0), b.source_of(0)), key=str)
    twice = share >= MOST
    make = error if wall else warning
    finding = make(
        "drawn-twice" if twice else "thin-wall",
        "the contours with low corners at {one:xy} and {other} run {size_mm:.4f} mm "
        "({size_um:.1f} um) apart, nearest at {place}: the outline seems drawn twice"
        if twice
        else "the wall between the contours with low corners at {one:xy} and {other} is "
        "{size_mm:.4f} mm ({size_um:.1f} um) thick at {place}",
        spans[0],
        notes=(("the other one", spans[1]),),
        hint="remove one of the two"
        if twice
        else "below {least_mm:.3f} mm it cannot be proven that a wall is left: draw it thicker",
        points_mm=(place,),
        one=_corner(a),
        other=_corner(b),
        size_mm=size / 1000,
        size_um=size,
        place=place,
        least_mm=WALL_UM / 1000,
    )
    if twice and wall:
        finding = finding.extended(" (a wall below {least_mm:.3f} mm cannot be proven)")
    return finding


def _touching(a: Contour, b: Contour, g: Gaps, k: int) -> tuple[float, float, Diagnostic]:
    """Return (y, x, warning) for contours that come as near as rounding makes those that touch."""
    x, y = float(g.x[k]), float(g.y[k])
    place = Place.of_um(x, y)
    spans = sorted((a.source_of(0), b.source_of(0)), key=str)
    finding = warning(
        "contours-touch",
        "two contours touch at {place} but for {apart_um:.2g} um; nothing is left of the material "
        "there",
        spans[0],
        notes=(("it touches this", spans[1]),),
        points_mm=(place,),
        place=place,
        apart_um=float(g.size[k]),
    )
    return y, x, finding


def _keeps(contour: Contour, inside: bool | None, x: float, y: float) -> bool:
    """Return whether a contour keeps the material at a place."""
    if inside is None or not contour.closed:
        return False
    return bool(measure.contains(contour.vertices, np.array([x]), np.array([y]))[0]) == inside


def _corner(contour: Contour) -> Place:
    """Return the low corner of a contour, which names it in a message before cuts have numbers."""
    return Place.of_um(*measure.extents(contour.vertices, contour.closed)[:2])

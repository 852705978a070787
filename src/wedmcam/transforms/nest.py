"""Which contour lies in which: outer contours, holes, islands in holes.

The side on which the wire runs follows from it, and the order of cutting. Containment is decided by
geometry (a point of the one against the other, arcs exact), never by size or order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.geom import measure
from wedmcam.geom.pairs import overlapping_parts
from wedmcam.geom.segments import Floats, distances, points_at
from wedmcam.ir.contour import Contour

#: A probe this near to the other contour, um, does not say on which side it is.
SAME_EXTENT_UM = 0.01
#: How many points of a contour are asked before any doubt arises.
PROBES = 3
#: How many at most after that.
MOST_PROBES = 64
#: More closed contours, each with a thread point, are no part: at a minute each two weeks.
MOST_CLOSED = 20_000
#: Loose lines that are cut by name are engraved one after the other; of more nothing was joined.
MOST_OPEN = 50_000
#: Contours that lie in each other, more than these, are a pattern: with circles of 0.5 mm between
#: them a disc of 200 mm.
DEEPEST = 200
#: Pairs of boxes are looked at so many at a time.
PART = 500_000


@dataclass(frozen=True, slots=True, eq=False)
class Nesting:
    """Contours and how they lie in each other; the three tuples run in parallel.

    Attributes:
        contours: as given.
        depths: how many closed contours enclose each one. Even: outer; odd: a hole.
        parents: index of the innermost closed contour around each one, -1 where there is none.
    """

    contours: tuple[Contour, ...]
    depths: tuple[int, ...]
    parents: tuple[int, ...]

    @property
    def outer(self) -> tuple[int, ...]:
        """Indices of the closed contours that bound material from outside."""
        return self._closed(0)

    @property
    def holes(self) -> tuple[int, ...]:
        """Indices of the closed contours that bound material from inside."""
        return self._closed(1)

    def _closed(self, parity: int) -> tuple[int, ...]:
        both = zip(self.contours, self.depths, strict=True)
        return tuple(i for i, (c, d) in enumerate(both) if c.closed and d % 2 == parity)


def nest(contours: Sequence[Contour]) -> Nesting:
    """Return how ``contours``, which must not cross each other, lie in each other.

    Contours may touch: then points away from the touch decide. Equal outlines (one drawn twice)
    are no business of this stage; they come out as one inside the other or not at all.
    """
    n = len(contours)
    if n < 2:
        return Nesting(tuple(contours), (0,) * n, (-1,) * n)
    extents = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    closed = np.array([c.closed for c in contours])
    box = (extents[:, 0], extents[:, 1], extents[:, 2], extents[:, 3])
    outer = np.flatnonzero(closed)
    some = [(np.empty(0, np.int64), np.empty(0, np.int64))]
    rings = box[0][outer], box[1][outer], box[2][outer], box[3][outer]
    for inner, k in overlapping_parts(box, rings, PART):
        around = outer[k]
        fits = inner != around
        for low in (0, 1):
            fits &= extents[inner, low] >= extents[around, low] - SAME_EXTENT_UM
            fits &= extents[inner, low + 2] <= extents[around, low + 2] + SAME_EXTENT_UM
        some.append((inner[fits], around[fits]))
    inner, around = (np.concatenate(both) for both in zip(*some, strict=True))
    probes = _probes(contours)
    sure = np.zeros(len(inner), np.bool_)
    order = np.argsort(around, kind="stable")
    starts = np.flatnonzero(np.diff(around[order], prepend=-1))
    for group in np.split(order, starts[1:]) if len(order) else ():
        ring = contours[int(around[group[0]])]
        points = probes[inner[group]].reshape(-1, 2)
        answers = measure.contains(ring.vertices, points[:, 0], points[:, 1])
        votes = answers.reshape(len(group), PROBES).sum(axis=1)
        sure[group] = votes == PROBES
        for doubtful in group[(votes != 0) & (votes != PROBES)]:
            sure[doubtful] = _inside(contours[int(inner[doubtful])], ring)
    inner, around = inner[sure], around[sure]
    depths = np.bincount(inner, minlength=n)
    # The innermost of those around is the one that itself lies deepest; ties (which only crossing
    # contours could give) fall to the lower index.
    parents = np.full(n, -1, np.int64)
    by_depth = np.lexsort((-around, depths[around]))
    parents[inner[by_depth]] = around[by_depth]
    return Nesting(tuple(contours), tuple(depths.tolist()), tuple(parents.tolist()))


def too_many(contours: Sequence[Contour]) -> tuple[Diagnostic, ...]:
    """Return an error where there are more contours than any machine threads."""
    closed = sum(c.closed for c in contours)
    for kind, count, most in (
        ("closed", closed, MOST_CLOSED),
        ("open", len(contours) - closed, MOST_OPEN),
    ):
        if count > most:
            return (
                error(
                    "too-large",
                    "the drawing has {count:,} {kind} contours; no more than {most:,} are compiled",
                    contours[0].source_of(0),
                    hint="leave out what is not to be cut: --layer, --ignore-layer",
                    count=count,
                    kind=kind,
                    most=most,
                ),
            )
    return ()


def too_deep(nesting: Nesting) -> tuple[Diagnostic, ...]:
    """Return an error where contours lie deeper in each other than in any part."""
    depth = max(nesting.depths, default=0)
    if depth <= DEEPEST:
        return ()
    inner = nesting.contours[nesting.depths.index(depth)]
    return (
        error(
            "too-large",
            "{contours:,} contours lie in each other; no more than {most} are compiled",
            inner.source_of(0),
            hint="a cut needs its contours once: a hatching or a pattern is to be left out",
            points_mm=(Place.of_um(inner.vertices["x"][0], inner.vertices["y"][0]),),
            contours=depth,
            most=DEEPEST,
        ),
    )


def _probes(contours: Sequence[Contour]) -> Floats:
    """Return `PROBES` points of each contour, half-way along segments spread over it."""
    segments, starts = measure.segments_of_all([(c.vertices, c.closed) for c in contours])
    counts = np.diff(starts, append=len(segments))[:, None]
    probe = np.arange(PROBES)
    rows = starts[:, None] + probe * counts // PROBES
    # A contour of one segment is asked at three places of that segment all the same.
    share = np.where(counts >= PROBES, 0.5, (probe + 0.5) / PROBES)
    chosen = segments.take(rows.ravel())
    x, y = points_at(chosen, share.ravel() * chosen.length)
    return np.stack([x, y], axis=-1).reshape(len(contours), PROBES, 2)


def _inside(contour: Contour, ring: Contour) -> bool:
    """Return whether ``contour``, which touches ``ring``, lies inside it: its farthest point says.

    The farther a point is from the ring, the surer is its side.
    """
    s = measure.segments_of(contour.vertices, contour.closed)
    x, y = measure.middles(s)
    x, y = np.concatenate([s.x0, x]), np.concatenate([s.y0, y])
    other = measure.segments_of(ring.vertices, True)
    best, far = 0, -1.0
    for i in range(0, len(x), max(1, len(x) // MOST_PROBES)):
        n = len(other)
        here = float(np.min(distances(other, np.full(n, x[i]), np.full(n, y[i]))))
        if here > far + SAME_EXTENT_UM:
            best, far = i, here
    return bool(measure.contains(ring.vertices, x[best : best + 1], y[best : best + 1])[0])

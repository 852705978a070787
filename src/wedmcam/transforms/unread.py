"""Is the outline of the part held by something that is not read?

A plate whose outer contour is a HATCH, a SOLID or an MLINE reads as its holes alone, and they would
be cut as loose discs. So the boundaries of what was not read are compared with what was: a boundary
that lines draw, too, is decoration. One that nothing draws is refused where it could bound
material: around a contour, in one as a hole, or where no contour is closed. Boundaries that touch
are looked at as one, as their hull: four wide lines make a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, EntityRef, Place, error
from wedmcam.geom import crossings, measure
from wedmcam.geom import segments as seg
from wedmcam.geom.pairs import grow, overlapping, self_overlapping
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.sketch import Sketch
from wedmcam.transforms.hints import quote

Bools = NDArray[np.bool_]

#: Boundaries are compared at places at most this far apart, um, but no more than so many a segment.
SPACING_UM, LEAST_PLACES, MOST_PLACES = 1000.0, 5, 256
#: Float noise of coordinates of a part, um.
FLOAT_UM = 0.01
#: How many places of a contour or a boundary are asked on which side of another they lie.
MOST_PROBES = 64
#: Directions in which a hull is looked for.
DIRECTIONS = 180
#: How many points and segments are compared at once: some 40 MB.
AT_ONCE = 500_000
#: How many are counted to estimate how many there are.
SOME_PAIRS = 200_000
#: After so many of one type refused for one reason the rest is not looked at.
MOST_LISTED = 100
#: How many handles a finding names.
NAMED_HANDLES = 5


def unread_outlines(
    sketch: Sketch, contours: Sequence[Contour], join_um: float, offset_um: float
) -> tuple[Diagnostic, ...]:
    """Return an error for each kind of unread boundary that could be an outline.

    Args:
        sketch: what was read, and the boundaries of what was not; um, drawing coordinates.
        contours: what became of the sketch, before any transform.
        join_um: how far a boundary may be from the segments that draw it.
        offset_um: from the outline to the wire's centre; a hole is wider than twice that.
    """
    unread = sketch.unread
    if not len(unread.segments):
        return ()
    within = join_um + unread.within_um + sketch.info.extra.get("spline_um", 0.0) + FLOAT_UM
    bounds = _segments_of(unread.segments)
    source = unread.segments["source"].astype(np.int64)
    places = _places(bounds)
    drawn = _near(places.x, places.y, _segments_of(sketch.segments), within)
    of = source[places.row]
    bare = np.bincount(of, weights=~drawn, minlength=len(unread.sources)) > 0
    loose = np.flatnonzero(bare[source])
    if not len(loose):
        return ()
    group = np.full(len(source), -1)
    group[loose] = _groups(bounds.take(loose), source[loose], within)
    read = _Contours(contours, within)
    groups: dict[tuple[str, str], list[_Outline]] = {}
    for mine, there in zip(_each(group), _each(group[places.row]), strict=True):
        if any(len(outlines) >= MOST_LISTED for outlines in groups.values()):
            break
        one = _Group(bounds.take(mine), source[mine], places.x[there], places.y[there])
        why = read.why(one, 2.0 * offset_um)
        if why is not None:
            kind, contour = why
            far = ~drawn[there]
            k = int(there[np.argmax(far)])
            at = Place.of_um(places.x[k], places.y[k])
            named = unread.sources[int(of[k])]
            more = len(set(source[mine].tolist())) - 1
            groups.setdefault((named.dxftype, kind), []).append(
                _Outline(named, one.box, more, kind, contour, at, not far.all())
            )
    return tuple(_finding(outlines) for outlines in groups.values())


@dataclass(frozen=True, slots=True)
class _Outline:
    """An unread boundary that could be an outline, and why.

    ``kind`` and ``contour``: see `_Contours.why`; ``at``: where nothing draws it.
    """

    ref: EntityRef
    box: tuple[float, float, float, float]
    more: int
    kind: str
    contour: Place | None
    at: Place
    partly: bool


def _finding(outlines: list[_Outline]) -> Diagnostic:
    """Return one finding about boundaries of one type that are refused for one reason."""
    first = outlines[0]
    ref, (x0, y0, x1, y1) = first.ref, first.box
    finding = error(
        "unsupported-entity",
        "{type} {handle} on layer {layer} (with {touching} more that touch it)"
        if first.more
        else "{type} {handle} on layer {layer}",
        ref,
        hint="draw it as lines or a polyline; if it bounds nothing, leave it out with "
        "--ignore-type {quoted_type}, or its layer with --ignore-layer",
        points_mm=tuple(h.at for h in outlines[:100]),
        count=len(outlines),
        type=ref.dxftype,
        quoted_type=quote(ref.dxftype),
        handle=_handle(ref),
        layer=ref.layer,
        touching=first.more,
        width_mm=(x1 - x0) / 1000,
        height_mm=(y1 - y0) / 1000,
        place=Place.of_um(x0, y0),
        contour=first.contour,
    )
    finding = finding.extended(", {width_mm:.3f} x {height_mm:.3f} mm at {place}: its boundary ")
    if first.partly:
        finding = finding.extended("is not drawn by what is read at {bare}", bare=first.at)
    else:
        finding = finding.extended("is drawn by nothing that is read")
    if first.kind == "alone":
        finding = finding.extended(", and no contour is closed")
    else:
        finding = finding.extended(
            ", and it lies around the contour at {contour}"
            if first.kind == "around"
            else ", and it lies across the contour at {contour}"
            if first.kind == "across"
            else ", and it lies in the contour at {contour}"
        )
    more = len(outlines) - 1
    if not more:
        return finding
    named = [_handle(h.ref) for h in outlines[1 : NAMED_HANDLES + 1]]
    finding = finding.extended(
        "; likewise at least {likewise} more ({named}"
        if len(outlines) >= MOST_LISTED
        else "; likewise {likewise} more ({named}",
        likewise=more,
        named=named,
    )
    if more > NAMED_HANDLES:
        return finding.extended(" and {unnamed} more)", unnamed=more - NAMED_HANDLES)
    return finding.extended(")")


def _handle(ref: EntityRef) -> str:
    return "#" + "/".join((*ref.via, ref.handle))


# --- which boundaries are drawn -----------------------------------------------------------------


def _segments_of(rows: NDArray[np.void]) -> Segments:
    x0, y0, x1, y1, cx, cy = (
        rows[name].astype(float) for name in ("x0", "y0", "x1", "y1", "cx", "cy")
    )
    return seg.make(x0, y0, x1, y1, cx, cy, rows["turn"].copy())


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """Places along segments, um: both ends and in between; ``row``: the segment of each."""

    x: Floats
    y: Floats
    row: Ints


def _places(s: Segments) -> _Places:
    count = np.clip(np.ceil(s.length / SPACING_UM).astype(np.int64) + 1, LEAST_PLACES, MOST_PLACES)
    row = np.repeat(np.arange(len(s)), count)
    number = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    x, y = seg.points_at(s.take(row), s.length[row] * number / (count[row] - 1))
    return _Places(x, y, row)


def _near(x: Floats, y: Floats, s: Segments, within: float) -> Bools:
    """Return for each point whether a segment is at most ``within`` away."""
    near = np.zeros(len(x), np.bool_)
    if not len(s):
        return near
    if len(x) * len(s) <= SOME_PAIRS // 10:
        i, j = np.divmod(np.arange(len(x) * len(s)), len(s))
        far = seg.distances(s.take(j), x[i], y[i])
        return np.asarray((far <= within).reshape(len(x), len(s)).any(axis=1))
    boxes = grow(seg.boxes(s), within)
    # As many points at once as their pairs allow, by the mean of some of them.
    sample = np.linspace(0, len(x) - 1, min(len(x), 1 + SOME_PAIRS // len(s))).astype(np.int64)
    sx, sy = x[sample, None], y[sample, None]
    met = (boxes[0] <= sx) & (sx <= boxes[2]) & (boxes[1] <= sy) & (sy <= boxes[3])
    step = 1 + int(AT_ONCE / (1.0 + met.sum(axis=1).mean()))
    for k in range(0, len(x), step):
        px, py = x[k : k + step], y[k : k + step]
        i, j = overlapping((px, py, px, py), boxes)
        far = seg.distances(s.take(j), px[i], py[i])
        near[k + i[far <= within]] = True
    return near


# --- boundaries that touch ----------------------------------------------------------------------


def _groups(s: Segments, source: Ints, within: float) -> Ints:
    """Return for each segment the least source that its own is connected with."""
    i, j = self_overlapping(grow(seg.boxes(s), 0.5 * within))
    other = source[i] != source[j]
    i, j = i[other], j[other]
    meet = np.zeros(len(i), np.bool_)
    for a, b in ((i, j), (j, i)):
        for x, y in ((s.x0, s.y0), (s.x1, s.y1)):
            meet |= seg.distances(s.take(b), x[a], y[a]) <= within
    crossed = crossings.between(s, i[~meet], j[~meet])
    one, two = np.concatenate([i[meet], crossed.i]), np.concatenate([j[meet], crossed.j])
    return _connected(int(source.max()) + 1, source[one], source[two])[source]


def _connected(count: int, i: Ints, j: Ints) -> Ints:
    """Return for each of ``count`` items the least one that pairs (i, j) connect it with."""
    root = list(range(count))

    def top(k: int) -> int:
        while root[k] != k:
            root[k] = root[root[k]]
            k = root[k]
        return k

    for a, b in set(zip(i.tolist(), j.tolist(), strict=True)):
        low, high = sorted((top(a), top(b)))
        root[high] = low
    return np.array([top(k) for k in range(count)], np.int64)


def _each(group: Ints) -> list[Ints]:
    """Return the indices of each group, in order of group; those of group -1 are left out."""
    order = np.argsort(group, kind="stable")
    order = order[np.searchsorted(group[order], 0) :]
    return np.split(order, np.flatnonzero(np.diff(group[order])) + 1)


class _Group:
    """Boundaries that touch: their outline is their hull, unless it is one closed loop."""

    def __init__(self, s: Segments, source: Ints, x: Floats, y: Floats) -> None:
        self.x, self.y = x, y
        self._segments, self._alone = s, bool((source == source[0]).all())
        x0, y0, x1, y1 = seg.boxes(s)
        self.box = float(x0.min()), float(y0.min()), float(x1.max()), float(y1.max())

    @cached_property
    def _hull(self) -> Floats:
        return _hull(self.x, self.y)

    def is_wider(self, than: float) -> bool:
        """Return whether it is wider than ``than``, um, in every direction."""
        x0, y0, x1, y1 = self.box
        return min(x1 - x0, y1 - y0) > than and _width(self._hull) > than

    @cached_property
    def side(self) -> _Side:
        """Tells which points are in the outline."""
        loop = self._alone and _is_loop(self._segments)
        return _Side(self._segments if loop else _polygon(self._hull))


def _is_loop(s: Segments) -> bool:
    """Return whether segments make one closed loop: every end meets another, and all connect."""
    x, y = np.concatenate([s.x0, s.x1]), np.concatenate([s.y0, s.y1])
    if len(x) <= MOST_PROBES:
        i, j = np.nonzero(np.triu(np.hypot(x - x[:, None], y - y[:, None]) <= FLOAT_UM, 1))
    else:
        i, j = self_overlapping(grow((x, y, x, y), FLOAT_UM))
    if len(set(i.tolist()) | set(j.tolist())) < len(x):
        return False
    return not _connected(len(s), i % len(s), j % len(s)).any()


def _hull(x: Floats, y: Floats) -> Floats:
    """Return the convex hull of points, counter-clockwise, shape (n, 2); thin ones may have 2."""
    angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
    towards = np.stack([np.cos(angle), np.sin(angle)])
    about = np.array([x[0], y[0]])  # near to the points, for the digits
    xy = np.stack([x, y], axis=1) - about
    step = AT_ONCE // DIRECTIONS
    parts = [xy[k : k + step] for k in range(0, len(xy), step)]
    xy = np.concatenate([p[np.argmax(p @ towards, axis=0)] for p in parts])
    corners = xy[np.argmax(xy @ towards, axis=0)]
    corners = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]
    out: Floats = (corners if len(corners) else xy[:1]) + about
    return out


def _width(hull: Floats) -> float:
    """Return the least width of a convex polygon, um: that across one of its sides."""
    if len(hull) < 3:
        return 0.0
    side = np.roll(hull, -1, axis=0) - hull
    normal = np.stack([-side[:, 1], side[:, 0]]) / np.hypot(side[:, 0], side[:, 1])
    across = (hull - hull[0]) @ normal
    return float(np.ptp(across, axis=0).min())


def _polygon(corners: Floats) -> Segments:
    after = np.roll(corners, -1, axis=0)
    none = np.zeros(len(corners))
    turn = np.zeros(len(corners), np.int8)
    return seg.make(corners[:, 0], corners[:, 1], after[:, 0], after[:, 1], none, none, turn)


# --- what they could bound ----------------------------------------------------------------------


class _Side:
    """Says on which side of closed contours points lie."""

    def __init__(self, s: Segments) -> None:
        self._segments, self._inside = s, measure.Inside(s)

    def __call__(self, x: Floats, y: Floats, within: float) -> tuple[bool, bool]:
        """Return whether any point lies inside and any outside, by more than ``within``, um."""
        clear = ~_near(x, y, self._segments, within)
        there = self._inside(x, y)
        return bool((clear & there).any()), bool((clear & ~there).any())


class _Contours:
    """Says of a boundary whether it could be an outline beside the contours that were read."""

    def __init__(self, contours: Sequence[Contour], within: float) -> None:
        self._contours, self._within = contours, within
        self._boxes = np.zeros((0, 4))
        if contours:
            self._boxes = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
        self._none_closed = not any(c.closed for c in contours)
        self._known: dict[int, tuple[_Side | None, Floats, Floats]] = {}

    def why(self, one: _Group, wide: float) -> tuple[str, Place | None] | None:
        """Return why a boundary could be an outline; None where it is none.

        It lies "around", "across" or "in" the contour at a place, or "alone": none is closed.

        ``wide``: what is in a contour and no wider, um, is no hole that could be cut.
        """
        reason: tuple[str, Place | None] | None = None
        x0, y0, x1, y1 = one.box
        b, near = self._boxes, self._within
        met = (b[:, 0] <= x1) & (b[:, 2] >= x0) & (b[:, 1] <= y1) & (b[:, 3] >= y0)
        around = met & (b[:, 0] >= x0 - near) & (b[:, 2] <= x1 + near)
        around &= (b[:, 1] >= y0 - near) & (b[:, 3] <= y1 + near)
        if not one.is_wider(wide + FLOAT_UM):
            met = around
        for k in np.flatnonzero(met).tolist():
            side, x, y = self._contour(k)
            lies_in, lies_out = one.side(x, y, near)
            if lies_in and not lies_out:
                return "around", self._corner(k)
            if side is None or reason is not None or not one.is_wider(wide + FLOAT_UM):
                continue
            if not lies_in:
                lies_in, lies_out = side(*_thin(one.x, one.y), near)
            if lies_in:
                reason = "across" if lies_out else "in", self._corner(k)
        if reason is None and self._none_closed:
            reason = "alone", None
        return reason

    def _contour(self, k: int) -> tuple[_Side | None, Floats, Floats]:
        """Return the sides of a contour, if it is closed, and points on it."""
        if k not in self._known:
            contour = self._contours[k]
            s = measure.segments_of(contour.vertices, contour.closed)
            mx, my = measure.middles(s)
            x, y = np.concatenate([s.x0, mx, s.x1[-1:]]), np.concatenate([s.y0, my, s.y1[-1:]])
            self._known[k] = (_Side(s) if contour.closed else None, *_thin(x, y))
        return self._known[k]

    def _corner(self, k: int) -> Place:
        return Place.of_um(self._boxes[k, 0], self._boxes[k, 1])


def _thin(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    every = max(1, -(-len(x) // MOST_PROBES))
    return x[::every], y[::every]

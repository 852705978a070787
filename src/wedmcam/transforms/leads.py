"""Thread points and leads: where the wire is threaded and how it gets to the path.

A lead runs in scrap, from the thread point to the nearest point of the wire path, and the wire
leaves by the same way. Where the drawing states no thread point one is chosen: beside the midpoint
of the longest segment, or the centre of a round hole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.diag import Diagnostic, Span, error
from wedmcam.geom import crossings, measure, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.sketch import ThreadPoint

#: A lead that arrives this near to a vertex arrives at it: no leftovers of a few steps; um.
VERTEX_UM = 5.0
#: How much nearer than the offset to its outline a thread point may be: its own rounding; um.
ROUNDED_UM = 1.0
#: Ties of length within this are ties; um.
TIE_UM = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Lane:
    """A wire path that wants a lead.

    Attributes:
        path: the wire path, in cutting direction.
        outline: what it was made from; None for ``on`` open paths.
        scrap_left: scrap to the left (True) or right of the path; None where there is none (on).
        offset_um: distance between the two.
    """

    path: Contour
    outline: Contour
    scrap_left: bool | None
    offset_um: float


@dataclass(frozen=True, slots=True, eq=False)
class Led:
    """A path that starts where its lead arrives, and the whole-um thread point."""

    path: Contour
    thread: tuple[int, int]


def lead(
    lanes: Sequence[Lane], threads: Sequence[ThreadPoint], lead_um: float
) -> tuple[list[Led] | None, list[Diagnostic]]:
    """Return every path with its lead.

    Each thread point serves the nearest path whose scrap side holds it. One that serves none, a
    second one for the same path, one nearer to the part than the offset, and a lead that crosses a
    path on its way are errors, all of them reported.

    Args:
        lanes: closed or open paths, um.
        threads: thread points, um; the nearest whole um is used.
        lead_um: length of a lead that nobody stated.
    """
    found: list[Diagnostic] = []
    served: dict[int, tuple[int, int]] = {}
    spans: dict[int, Span | None] = {}
    near = _Nearest(lanes)
    for point in threads:
        x, y = (int(v) for v in to_grid([point.x, point.y]))
        place = f"({x / 1000:.3f}, {y / 1000:.3f}) mm"
        number, problem = near.serves(x, y)
        if number is None:
            found.append(
                error(
                    "thread-point-unused",
                    f"the thread point at {place} serves no contour: {problem}",
                    point.span,
                    hint="put it on the scrap side of the contour that it is for, or remove it",
                    points_mm=((x / 1000, y / 1000),),
                )
            )
        elif number in served:
            ox, oy = served[number]
            found.append(
                error(
                    "thread-point-twice",
                    f"the thread point at {place} is a second one for the contour already served "
                    f"from ({ox / 1000:.3f}, {oy / 1000:.3f}) mm",
                    point.span,
                    hint="remove one of the two",
                    points_mm=((x / 1000, y / 1000),),
                )
            )
        else:
            served[number] = (x, y)
            spans[number] = point.span
    if found:
        return None, found
    result = []
    for number, lane in enumerate(lanes):
        if number in served:
            led = Led(_started(lane.path, served[number]), served[number])
        else:
            led = _chosen(lane, lanes, lead_um)
        result.append(led)
    found += _collisions(lanes, result, spans)
    return result, found


# --- which path a thread point serves ------------------------------------------------------------


class _Nearest:
    """Which path a point serves: the nearest of those that bound the scrap it lies in.

    Scrap lies inside one contour (the innermost around the point) and outside those directly in
    it; on the far side of any other contour there is material in between.
    """

    def __init__(self, lanes: Sequence[Lane]) -> None:
        self.lanes = lanes
        self.paths = [seg.of_rows(p.path.starts, p.path.ends) for p in lanes]
        self.areas = [abs(measure.area(p.outline.vertices)) for p in lanes]

    def serves(self, x: int, y: int) -> tuple[int | None, str]:
        """Return the number of the path that (x, y) serves, or None and why."""
        numbers = range(len(self.lanes))
        sided = [k for k in numbers if self.lanes[k].scrap_left is not None]
        px, py = np.array([float(x)]), np.array([float(y)])
        around = {
            k for k in sided if bool(measure.contains(self.lanes[k].outline.vertices, px, py)[0])
        }
        candidates = [k for k in numbers if k not in sided]
        if sided:
            # The innermost contour around the point: the smallest (contours do not cross).
            home = min(around, key=lambda k: self.areas[k], default=None)
            for k in sided:
                scrap_inside = self._scrap_inside(k)
                if k in around:
                    if home is not None and self.lanes[k].outline is self.lanes[home].outline:
                        candidates += [k] if scrap_inside else []
                elif not scrap_inside and self._directly_in(k, home, around):
                    candidates.append(k)
            if home is not None and not self._scrap_inside(home):
                candidates = [k for k in candidates if k not in sided]
        if not candidates:
            return None, "it lies in kept material"
        distance, best = min((self._distance(self.paths[k], x, y), k) for k in candidates)
        lane = self.lanes[best]
        if lane.scrap_left is not None and distance > ROUNDED_UM:
            s = seg.of_rows(lane.outline.starts, lane.outline.ends)
            drawn = self._distance(s, x, y)
            if drawn < lane.offset_um - ROUNDED_UM:
                return None, f"it is only {drawn / 1000:.3f} mm from the contour, within the offset"
        return best, ""

    def _scrap_inside(self, k: int) -> bool:
        """Return whether the scrap of path k lies inside its outline."""
        lane = self.lanes[k]
        return lane.scrap_left == (measure.area(lane.outline.vertices) > 0)

    def _directly_in(self, k: int, home: int | None, around: set[int]) -> bool:
        """Return whether contour k lies in ``home`` (None: in nothing) with none in between."""
        v = self.lanes[k].outline.vertices
        px, py = v["x"][:1].astype(float), v["y"][:1].astype(float)
        outer = {
            m
            for m in range(len(self.lanes))
            if self.lanes[m].scrap_left is not None
            and self.lanes[m].outline is not self.lanes[k].outline
            and self.areas[m] > self.areas[k]
            and bool(measure.contains(self.lanes[m].outline.vertices, px, py)[0])
        }
        return outer == around

    @staticmethod
    def _distance(s: Segments, x: int, y: int) -> float:
        return float(seg.distances(s, np.full(len(s), float(x)), np.full(len(s), float(y))).min())


# --- the start of a path -------------------------------------------------------------------------


def _started(path: Contour, thread: tuple[int, int]) -> Contour:
    """Return the path starting at its point nearest to ``thread``; an open one at its nearer end.

    Ties: the lowest, then the leftmost point.
    """
    v = path.vertices
    x, y = float(thread[0]), float(thread[1])
    if not path.closed:
        ends = np.hypot(v["x"][[0, -1]] - x, v["y"][[0, -1]] - y)
        return path if ends[0] <= ends[1] else path.reversed()
    s = seg.of_rows(path.starts, path.ends)
    n = len(s)
    px, py = np.full(n, x), np.full(n, y)
    distance = seg.distances(s, px, py)
    at = np.clip(seg.position_of(s, px, py), 0.0, s.length)
    # From the centre of an arc every point is nearest: take the one towards +x, else its start.
    centred = (s.turn != 0) & (np.hypot(s.cx - x, s.cy - y) < 0.5)
    if centred.any():
        east = np.mod(-s.a0 * s.turn, seg.TAU)
        at = np.where(centred, np.where(east <= s.sweep, east * s.radius, 0.0), at)
    qx, qy = seg.points_at(s, at)
    tied = np.flatnonzero(distance <= distance.min() + TIE_UM)
    best = int(tied[np.lexsort((qx[tied], qy[tied]))[0]])
    return _rotated(path, s, best, float(at[best]))


def _rotated(path: Contour, s: Segments, row: int, at: float) -> Contour:
    """Return a closed path that starts on segment ``row`` at ``at`` um, split there if need be."""
    v = path.vertices
    n = len(v)
    length = float(s.length[row])
    if n == 1:  # a full circle: its start moves
        x, y = seg.points_at(s, np.array([at]))
        rows = v.copy()
        if min(at, length - at) > 1e-6:
            rows["x"], rows["y"] = x, y
        return Contour(rows, True, path.sources)
    snap = min(VERTEX_UM, 0.25 * length)
    if at <= snap or at >= length - snap:
        first = row if at <= snap else (row + 1) % n
        return Contour(np.roll(v, -first), True, path.sources)
    px, py = seg.points_at(s.take(np.array([row])), np.array([at]))
    rows = np.empty(n + 1, VERTEX)
    rows[0] = v[row]
    rows["x"][0], rows["y"][0] = px[0], py[0]
    rows[1:] = np.roll(v, -(row + 1))
    return Contour(rows, True, path.sources)


def _chosen(lane: Lane, lanes: Sequence[Lane], lead_um: float) -> Led:
    """Return a path with a lead that nobody stated (ruling 3)."""
    path = lane.path
    v = path.vertices
    if not path.closed:
        return _before_open(path, lead_um)
    s = seg.of_rows(path.starts, path.ends)
    circle = len(v) == 1
    inward = measure.area(v) > 0
    if circle:
        centre_is_scrap = lane.scrap_left is not None and lane.scrap_left == inward
        row, at = 0, float(np.mod(-s.a0[0] * s.turn[0], seg.TAU) * s.radius[0])
        if centre_is_scrap:
            centre = tuple(int(c) for c in to_grid([s.cx[0], s.cy[0]]))
            other = [p for p in lanes if p is not lane]
            led = Led(_rotated(path, s, 0, at), (centre[0], centre[1]))
            if not _crosses(led, other):
                return led
    else:
        middle_x, middle_y = seg.points_at(s, 0.5 * s.length)
        tied = np.flatnonzero(s.length >= s.length.max() - TIE_UM)
        # Rounded so that float noise does not decide between left and right.
        order = np.lexsort((np.round(middle_x[tied], 3), np.round(middle_y[tied], 3)))
        row = int(tied[order[0]])
        at = 0.5 * float(s.length[row])
    started = _rotated(path, s, row, at)
    one = s.take(np.array([row]))
    px, py = (float(c[0]) for c in seg.points_at(one, np.array([at])))
    tx, ty = (float(c[0]) for c in seg.tangents_at(one, np.array([at])))
    left = lane.scrap_left if lane.scrap_left is not None else not inward
    nx, ny = (-ty, tx) if left else (ty, -tx)
    free = _free(px, py, nx, ny, 2.0 * lead_um, lanes)
    length = min(lead_um, 0.5 * free)
    tx_, ty_ = (int(c) for c in to_grid([px + nx * length, py + ny * length]))
    return Led(started, (tx_, ty_))


def _before_open(path: Contour, lead_um: float) -> Led:
    """Return an open path with a lead along its own direction, from before its first end."""
    v = path.vertices
    one = seg.of_rows(path.starts[:1], path.ends[:1])
    tx, ty = (float(c[0]) for c in seg.start_tangents(one))
    x, y = to_grid([v["x"][0] - tx * lead_um, v["y"][0] - ty * lead_um]).tolist()
    return Led(path, (x, y))


def _free(x: float, y: float, nx: float, ny: float, reach: float, lanes: Sequence[Lane]) -> float:
    """Return how far a ray from a point of a path runs until it meets a path, at most ``reach``."""
    start = min(1.0, 0.01 * reach)  # the path that the ray leaves is not met
    ray = _line(x + nx * start, y + ny * start, x + nx * reach, y + ny * reach)
    best = reach
    for lane in lanes:
        for distance in _hits(ray, lane.path):
            best = min(best, distance + start)
    return best


def _line(x0: float, y0: float, x1: float, y1: float) -> Segments:
    z = np.zeros(1)
    return seg.make(
        np.array([x0]), np.array([y0]), np.array([x1]), np.array([y1]), z, z, np.zeros(1, np.int8)
    )


def _hits(line: Segments, path: Contour) -> list[float]:
    """Return at which distances along ``line`` it meets the path."""
    s = seg.of_rows(path.starts, path.ends)
    _, j = pairs.overlapping(pairs.grown(seg.boxes(line), 1e-3), seg.boxes(s))
    if not len(j):
        return []
    both = Segments(
        *(np.concatenate([getattr(line, name), getattr(s, name)[j]]) for name in Segments.__slots__)
    )
    k = np.arange(1, len(j) + 1)
    return [float(a) for a in crossings.between(both, np.zeros(len(j), np.int64), k).at_i]


def _crosses(led: Led, lanes: Sequence[Lane]) -> bool:
    v = led.path.vertices
    line = _line(led.thread[0], led.thread[1], float(v["x"][0]), float(v["y"][0]))
    return any(_hits(line, lane.path) for lane in lanes)


def _collisions(
    lanes: Sequence[Lane], led: Sequence[Led], spans: dict[int, Span | None]
) -> list[Diagnostic]:
    """Return an error for each lead that meets a path before it arrives."""
    found = []
    paths = [p.path for p in lanes]
    boxes = np.array([measure.extents(p.vertices, p.closed) for p in paths])
    for number, item in enumerate(led):
        v = item.path.vertices
        x0, y0 = (float(c) for c in item.thread)
        x1, y1 = float(v["x"][0]), float(v["y"][0])
        length = float(np.hypot(x1 - x0, y1 - y0))
        if length < 2.0:
            continue
        line = _line(x0, y0, x1, y1)
        near = (boxes[:, 0] <= max(x0, x1) + 1) & (boxes[:, 2] >= min(x0, x1) - 1)
        near &= (boxes[:, 1] <= max(y0, y1) + 1) & (boxes[:, 3] >= min(y0, y1) - 1)
        for other in np.flatnonzero(near).tolist():
            # Its own path it meets where it arrives.
            margin = 2.0 if other == number else -1.0
            for at in _hits(line, paths[other]):
                if at < length - margin:
                    hx, hy = x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length
                    what = "its own path before it arrives" if other == number else "another cut"
                    found.append(
                        error(
                            "lead-hits",
                            f"the lead from ({x0 / 1000:.3f}, {y0 / 1000:.3f}) to "
                            f"({x1 / 1000:.3f}, {y1 / 1000:.3f}) mm meets {what} at "
                            f"({hx / 1000:.3f}, {hy / 1000:.3f}) mm",
                            spans.get(number) or item.path.source_of(0),
                            points_mm=((hx / 1000, hy / 1000),),
                            hint="move the thread point, or give one (--start X,Y; a POINT on "
                            "layer START)"
                            if number in spans
                            else "give a thread point (--start X,Y; a POINT on layer START)",
                        )
                    )
                    break
    return found

"""Thread points and leads: where the wire is threaded and how it gets to the path.

A lead runs in scrap, from the thread point to the nearest point of the wire path, and the wire
leaves by the same way. Where the drawing states no thread point one is chosen: beside the midpoint
of the longest segment, or the centre of a round hole. Such a lead leaves the path at a right angle,
at a corner along its bisector, and its thread point keeps clear of all walls.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Span, error
from wedmcam.geom import crossings, measure, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.sketch import ThreadPoint

#: A lead that arrives this near to a vertex arrives at it: no leftovers of a few steps; um.
VERTEX_UM = 5.0
#: How much nearer than the offset to its outline a thread point may be: its own rounding; um.
ROUNDED_UM = 1.0
#: Ties of length within this are ties; um.
TIE_UM = 1e-3
#: A thread point that nobody stated is at least this share of its lead away from every path: the
#: lead lies along no wall. In a corner its lead halves the angle: one below 29 degrees is refused.
CLEAR = 0.25
#: A lead that is so near to its own path has arrived, um: what it meets there lies in one kerf.
ARRIVES_UM = 10.0
#: How often a lead is halved that would end too near to another wall.
HALVED = 8
#: How a thread point is given for a drawing, and in a part program.
_WORDS = ("--start X,Y; a POINT on layer START", "'start' of the cut")


@dataclass(frozen=True, slots=True, eq=False)
class Lane:
    """A wire path that wants a lead.

    Attributes:
        path: the wire path, in cutting direction.
        outline: what it was made from; None for ``on`` open paths.
        scrap_left: scrap to the left (True) or right of the path; None where there is none (on).
        offset_um: distance between the two.
        contour: number of the outline; several paths may share one.
        parent: number of the outline directly around it, -1 for none.
        lead_um: length of a lead that nobody stated; None for the usual one.
        enter: where the lead arrives: at the point of the path nearest to this, um, and where
            that was stated; None for the point nearest to the thread point.
    """

    path: Contour
    outline: Contour
    scrap_left: bool | None
    offset_um: float
    contour: int = 0
    parent: int = -1
    lead_um: float | None = None
    enter: ThreadPoint | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Led:
    """A path that starts where its lead arrives, and the whole-um thread point."""

    path: Contour
    thread: tuple[int, int]


def lead(
    lanes: Sequence[Lane],
    threads: Sequence[ThreadPoint],
    lead_um: float,
    only: Sequence[Collection[int]] | None = None,
) -> tuple[list[Led] | None, list[Diagnostic]]:
    """Return every path with its lead.

    Each thread point serves the nearest path whose scrap side holds it. One that serves none, a
    second one for the same path, one nearer to the part than the offset, a lead that crosses a
    path on its way, and one that can only lie along a wall are errors, all of them reported.

    Args:
        lanes: closed or open paths, um.
        threads: thread points, um; the nearest whole um is used.
        lead_um: length of a lead that nobody stated.
        only: for each thread point the numbers of the paths that it may serve; None for all.
    """
    found: list[Diagnostic] = []
    served: dict[int, tuple[int, int]] = {}
    spans: dict[int, Span | None] = {}
    scene = _Scene(lanes)
    for k, point in enumerate(threads):
        x, y = (int(v) for v in to_grid([point.x, point.y]))
        place = f"({x / 1000:.3f}, {y / 1000:.3f}) mm"
        number, problem = _serves(scene, x, y, None if only is None else only[k])
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
    # Where thread points serve paths by their number, a part program states them.
    words = _WORDS[only is not None]
    free = [k for k in range(len(lanes)) if k not in served]
    result, along = _chosen(scene, free, lead_um)
    cures = [_cure(lane, words, k in served) for k, lane in enumerate(lanes)]
    found += [_along_wall(lanes[k], result[k], cures[k]) for k in along]
    for number, thread in served.items():
        lane = lanes[number]
        arrives = thread if lane.enter is None else (lane.enter.x, lane.enter.y)
        result[number] = Led(_started(lane.path, arrives), thread)
    ordered = [result[k] for k in range(len(lanes))]
    return ordered, found + _collisions(scene, ordered, spans, cures)


class _Scene:
    """All paths as one array of segments, so that a lead is held against all at once."""

    def __init__(self, lanes: Sequence[Lane]) -> None:
        self.lanes = lanes
        starts = np.concatenate([p.path.starts for p in lanes])
        ends = np.concatenate([p.path.ends for p in lanes])
        self.segments = seg.of_rows(starts, ends)
        self.boxes = seg.boxes(self.segments)
        sizes = np.array([len(p.path) for p in lanes])
        self.lane = np.repeat(np.arange(len(lanes)), sizes)
        self.first = np.cumsum(sizes) - sizes

    def of(self, lane: int) -> Segments:
        """Return the segments of one path."""
        first = int(self.first[lane])
        return self.segments.take(np.arange(first, first + len(self.lanes[lane].path)))

    def distances(self, x: float, y: float) -> Floats:
        """Return the distance from a point to each path."""
        n = len(self.segments)
        d = seg.distances(self.segments, np.full(n, x), np.full(n, y))
        return np.minimum.reduceat(d, self.first)

    def hits(self, lines: Segments) -> tuple[Ints, Ints, Floats]:
        """Return (line, path, distance along the line) of all crossings of lines with paths."""
        i, j = pairs.overlapping(pairs.grown(seg.boxes(lines), 1e-3), self.boxes)
        both = Segments(
            *(
                np.concatenate([getattr(lines, name), getattr(self.segments, name)])
                for name in Segments.__slots__
            )
        )
        c = crossings.between(both, i, j + len(lines))
        return c.i, self.lane[c.j - len(lines)], c.at_i


# --- which path a thread point serves ------------------------------------------------------------


def _serves(
    scene: _Scene, x: int, y: int, only: Collection[int] | None = None
) -> tuple[int | None, str]:
    """Return the number of the path that (x, y) serves, or None and why.

    Scrap lies inside one contour (the innermost around the point) and outside those directly in
    it; on the far side of any other contour there is material in between. Of the paths that bound
    this scrap the nearest is served.
    """
    lanes = scene.lanes
    px, py = np.array([float(x)]), np.array([float(y)])
    outlines = {p.contour: p for p in lanes if p.scrap_left is not None}
    around = {c for c, p in outlines.items() if _encloses(p.outline, px, py)}
    # The innermost around the point is the one that is no parent of another one around it.
    inner = around - {outlines[c].parent for c in around}
    home = min(inner, default=-1)
    candidates = []
    for k, lane in enumerate(lanes):
        if lane.scrap_left is None:
            candidates.append(k)
            continue
        scrap_inside = _scrap_inside(lane)
        inside_home = home < 0 or _scrap_inside(outlines[home])
        if (lane.contour == home and scrap_inside) or (
            lane.contour not in around and lane.parent == home and not scrap_inside and inside_home
        ):
            candidates.append(k)
    if only is not None and candidates:
        candidates = [k for k in candidates if k in only]
        if not candidates:
            return None, "it is not on the scrap side of its own contour"
    if not candidates:
        return None, "it lies in kept material"
    distances = scene.distances(float(x), float(y))
    best = min(candidates, key=lambda k: (float(distances[k]), k))
    lane = lanes[best]
    if lane.scrap_left is not None and distances[best] > ROUNDED_UM:
        s = seg.of_rows(lane.outline.starts, lane.outline.ends)
        n = len(s)
        drawn = float(seg.distances(s, np.full(n, float(x)), np.full(n, float(y))).min())
        if drawn < lane.offset_um - ROUNDED_UM:
            return None, f"it is only {drawn / 1000:.3f} mm from the contour, within the offset"
    return best, ""


def _scrap_inside(lane: Lane) -> bool:
    # A counter-clockwise outline has its inside to the left.
    return lane.scrap_left == (measure.area(lane.outline.vertices) > 0)


def _encloses(outline: Contour, x: Floats, y: Floats) -> bool:
    v = outline.vertices
    reach = float(np.hypot(v["x"] - v["cx"], v["y"] - v["cy"]).max()) if v["turn"].any() else 0.0
    if not v["x"].min() - 2 * reach <= x[0] <= v["x"].max() + 2 * reach:
        return False
    return bool(measure.contains(v, x, y)[0])


# --- the start of a path -------------------------------------------------------------------------


def _started(path: Contour, at: tuple[float, float]) -> Contour:
    """Return the path starting at its point nearest to ``at``; an open one at its nearer end."""
    v = path.vertices
    if not path.closed:
        ends = np.hypot(v["x"][[0, -1]] - at[0], v["y"][[0, -1]] - at[1])
        return path if ends[0] <= ends[1] else path.reversed()
    s = seg.of_rows(path.starts, path.ends)
    return rotated(path, s, *_nearest(s, *at))


def _nearest(s: Segments, x: float, y: float) -> tuple[int, float]:
    """Return the segment nearest to (x, y), and how far along it the nearest point lies, um.

    Ties: the lowest, then the leftmost point, then the first segment.
    """
    n = len(s)
    px, py = np.full(n, float(x)), np.full(n, float(y))
    distance = seg.distances(s, px, py)
    at = np.clip(seg.position_of(s, px, py), 0.0, s.length)
    # From the centre of an arc every point is nearest: take the one towards +x, else its start.
    centred = (s.turn != 0) & (np.hypot(s.cx - x, s.cy - y) < 0.5)
    if centred.any():
        east = np.mod(-s.a0 * s.turn, seg.TAU)
        at = np.where(centred, np.where(east <= s.sweep, east * s.radius, 0.0), at)
    qx, qy = seg.points_at(s, at)
    tied = np.flatnonzero(distance <= distance.min() + TIE_UM)
    # Rounded so that float noise does not decide between two segments that meet there.
    best = int(tied[np.lexsort((np.round(qx[tied], 3), np.round(qy[tied], 3)))[0]])
    return best, float(at[best])


def rotated(path: Contour, s: Segments, row: int, at: float, snap_um: float = VERTEX_UM) -> Contour:
    """Return a closed path that starts on segment ``row`` at ``at`` um, split there if need be.

    Within ``snap_um`` of a vertex it starts there.
    """
    v = path.vertices
    n = len(v)
    length = float(s.length[row])
    if n == 1:  # a full circle: its start moves
        x, y = seg.points_at(s, np.array([at]))
        rows = v.copy()
        if min(at, length - at) > 1e-6:
            rows["x"], rows["y"] = x, y
        return Contour(rows, True, path.sources)
    snap = min(snap_um, 0.25 * length)
    if at <= snap or at >= length - snap:
        first = row if at <= snap else (row + 1) % n
        return Contour(np.roll(v, -first), True, path.sources)
    px, py = seg.points_at(s.take(np.array([row])), np.array([at]))
    rows = np.empty(n + 1, VERTEX)
    rows[0] = v[row]
    rows["x"][0], rows["y"][0] = px[0], py[0]
    rows[1:] = np.roll(v, -(row + 1))
    return Contour(rows, True, path.sources)


@dataclass(frozen=True, slots=True, eq=False)
class _Ray:
    """A path, and the direction in which a lead leaves its start."""

    number: int
    path: Contour
    x: float
    y: float
    nx: float
    ny: float


def _chosen(
    scene: _Scene, numbers: Sequence[int], lead_um: float
) -> tuple[dict[int, Led], list[int]]:
    """Return leads that nobody stated (ruling 3), and of which paths they lie along a wall."""
    result: dict[int, Led] = {}
    rays: list[_Ray] = []
    centred: dict[int, Led] = {}
    for number in numbers:
        lane = scene.lanes[number]
        path = lane.path
        if not path.closed:
            path = path if lane.enter is None else _started(path, (lane.enter.x, lane.enter.y))
            result[number] = _before_open(path, _length(lane, lead_um))
            continue
        s = scene.of(number)
        inward = measure.area(path.vertices) > 0
        if lane.enter is not None:
            row, at = _nearest(s, lane.enter.x, lane.enter.y)
        elif len(path.vertices) == 1:
            row, at = 0, float(np.mod(-s.a0[0] * s.turn[0], seg.TAU) * s.radius[0])
            if lane.scrap_left is not None and lane.scrap_left == inward:
                cx, cy = to_grid([s.cx[0], s.cy[0]]).tolist()
                centred[number] = Led(rotated(path, s, 0, at), (cx, cy))
        else:
            middle_x, middle_y = seg.points_at(s, 0.5 * s.length)
            tied = np.flatnonzero(s.length >= s.length.max() - TIE_UM)
            # Rounded so that float noise does not decide between left and right.
            order = np.lexsort((np.round(middle_x[tied], 3), np.round(middle_y[tied], 3)))
            row = int(tied[order[0]])
            at = 0.5 * float(s.length[row])
        left = lane.scrap_left if lane.scrap_left is not None else not inward
        rays.append(_ray(number, rotated(path, s, row, at), left))
    if centred:
        blocked = _blocked(scene, centred)
        result |= {k: led for k, led in centred.items() if k not in blocked}
    rays = [ray for ray in rays if ray.number not in result]
    own = np.array([_length(scene.lanes[ray.number], lead_um) for ray in rays])
    lengths, clear = _cleared(scene, rays, np.minimum(own, 0.5 * _free(scene, rays, 2.0 * own)))
    for ray, length in zip(rays, lengths.tolist(), strict=True):
        x, y = to_grid([ray.x + ray.nx * length, ray.y + ray.ny * length]).tolist()
        result[ray.number] = Led(ray.path, (x, y))
    return result, [ray.number for ray, ok in zip(rays, clear.tolist(), strict=True) if not ok]


def _ray(number: int, path: Contour, left: bool) -> _Ray:
    """Return the direction that halves the angle of scrap at the start of a closed path."""
    s = seg.of_rows(path.starts, path.ends)
    ix, iy = (float(c[-1]) for c in seg.end_tangents(s))
    ox, oy = (float(c[0]) for c in seg.start_tangents(s))
    # From the first segment's normal by half the turn of the corner; exact where there is none.
    back = -0.5 * float(np.arctan2(ix * oy - iy * ox, ix * ox + iy * oy))
    back = 0.0 if abs(back) < 1e-9 else back
    c, d = float(np.cos(back)), float(np.sin(back))
    nx, ny = (-oy, ox) if left else (oy, -ox)
    v = path.vertices
    return _Ray(number, path, float(v["x"][0]), float(v["y"][0]), c * nx - d * ny, d * nx + c * ny)


def _cleared(
    scene: _Scene, rays: Sequence[_Ray], lengths: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return lengths at which thread points keep clear of all paths, and where there is one."""
    lengths = lengths.copy()
    x, y, nx, ny = (np.array([getattr(ray, k) for ray in rays], float) for k in _RAY)
    near = np.ones(len(rays), bool)
    for _ in range(HALVED):
        k = np.flatnonzero(near)
        px, py = x[k] + nx[k] * lengths[k], y[k] + ny[k] * lengths[k]
        room = CLEAR * lengths[k]
        i, j = pairs.overlapping((px - room, py - room, px + room, py + room), scene.boxes)
        distance = seg.distances(scene.segments.take(j), px[i], py[i])
        near[k] = pairs.least(distance, i, len(k)) < room - TIE_UM
        if not near.any():
            break
        lengths[near] *= 0.5
    return lengths, ~near


def _along_wall(lane: Lane, led: Led, cure: str) -> Diagnostic:
    x, y = (float(led.path.vertices[k][0]) / 1000 for k in ("x", "y"))
    return error(
        "lead-along-wall",
        f"a lead that ends at ({x:.3f}, {y:.3f}) mm can only lie along a wall, which it would "
        "damage: the corner is too acute to be entered from inside",
        led.path.source_of(0) if lane.enter is None else lane.enter.span,
        points_mm=((x, y),),
        hint=cure,
    )


def _cure(lane: Lane, words: str, threaded: bool) -> str:
    """Return what helps a lead: to move what was stated of it, or to state where it is threaded."""
    if threaded and lane.enter is not None:
        return "move the thread point, or 'enter'"
    first = "move the thread point, or " if threaded else ""
    first = first if lane.enter is None else "move 'enter', or "
    return f"{first}give a thread point ({words})"


def _length(lane: Lane, usual: float) -> float:
    return usual if lane.lead_um is None else lane.lead_um


def _blocked(scene: _Scene, leads: dict[int, Led]) -> set[int]:
    """Return the paths whose lead crosses another path."""
    numbers = list(leads)
    lines = _leads_as_lines([leads[k] for k in numbers])
    i, other, _ = scene.hits(lines)
    return {numbers[a] for a, b in zip(i.tolist(), other.tolist(), strict=True) if numbers[a] != b}


def _leads_as_lines(leads: Sequence[Led]) -> Segments:
    x1 = np.array([float(item.path.vertices["x"][0]) for item in leads])
    y1 = np.array([float(item.path.vertices["y"][0]) for item in leads])
    thread = np.array([item.thread for item in leads], float).reshape(-1, 2)
    return _lines(thread[:, 0], thread[:, 1], x1, y1)


def _before_open(path: Contour, lead_um: float) -> Led:
    """Return an open path with a lead along its own direction, from before its first end."""
    v = path.vertices
    one = seg.of_rows(path.starts[:1], path.ends[:1])
    tx, ty = (float(c[0]) for c in seg.start_tangents(one))
    x, y = to_grid([v["x"][0] - tx * lead_um, v["y"][0] - ty * lead_um]).tolist()
    return Led(path, (x, y))


#: Where a ray starts, and its direction.
_RAY = ("x", "y", "nx", "ny")


def _free(scene: _Scene, rays: Sequence[_Ray], reach: Floats) -> Floats:
    """Return how far each ray runs until it meets a path, at most its ``reach``."""
    start = np.minimum(1.0, 0.01 * reach)  # the path that a ray leaves is not met
    x, y, nx, ny = (np.array([getattr(ray, k) for ray in rays], float) for k in _RAY)
    free = reach.copy()
    if len(rays) and (reach > 0).any():
        lines = _lines(x + nx * start, y + ny * start, x + nx * reach, y + ny * reach)
        i, _, at = scene.hits(lines)
        np.minimum.at(free, i, at + start[i])
    return free


def _lines(x0: Floats, y0: Floats, x1: Floats, y1: Floats) -> Segments:
    zero = np.zeros(len(x0))
    return seg.make(x0, y0, x1, y1, zero, zero, np.zeros(len(x0), np.int8))


def collisions(lanes: Sequence[Lane], led: Sequence[Led], cure: str) -> list[Diagnostic]:
    """Return an error for each lead that meets a path before it arrives; paths are those led to."""
    return _collisions(_Scene(lanes), led, {}, [cure] * len(led))


def across(led: Sequence[Led], cure: str) -> list[Diagnostic]:
    """Return an error for each lead that meets the path of another cut, of whatever part.

    Two cuts may run along one path (a second pass), so where a lead arrives it meets both.
    """
    return _collisions(
        _Scene([Lane(k.path, k.path, None, 0.0) for k in led]), led, {}, [cure] * len(led), True
    )


def _collisions(
    scene: _Scene,
    led: Sequence[Led],
    spans: dict[int, Span | None],
    cures: Sequence[str],
    shared: bool = False,
) -> list[Diagnostic]:
    """Return an error, with its cure, for each lead that meets a path before it arrives.

    ``shared``: others may have the path that it arrives at.
    """
    lines = _leads_as_lines(led)
    line, path, at = scene.hits(lines)
    # Its own path it meets where it arrives.
    margin = np.where(line == path, 2.0, ARRIVES_UM if shared else -1.0)
    early = (at < lines.length[line] - margin) & (lines.length[line] >= 2.0)
    order = np.lexsort((at[early], line[early]))
    found: list[tuple[int, Diagnostic]] = []
    for k in np.flatnonzero(early)[order].tolist():
        number = int(line[k])
        if found and found[-1][0] == number:
            continue  # the first hit of a lead says it
        share = float(at[k] / lines.length[number])
        x0, y0, x1, y1 = (float(getattr(lines, n)[number]) for n in ("x0", "y0", "x1", "y1"))
        hx, hy = x0 + (x1 - x0) * share, y0 + (y1 - y0) * share
        what = "its own path before it arrives" if path[k] == number else "another cut"
        enter = scene.lanes[number].enter
        stated = spans.get(number) or (None if enter is None else enter.span)
        finding = error(
            "lead-hits",
            f"the lead from ({x0 / 1000:.3f}, {y0 / 1000:.3f}) to ({x1 / 1000:.3f}, "
            f"{y1 / 1000:.3f}) mm meets {what} at ({hx / 1000:.3f}, {hy / 1000:.3f}) mm",
            stated or led[number].path.source_of(0),
            points_mm=((hx / 1000, hy / 1000),),
            hint=cures[number],
        )
        found.append((number, finding))
    return [finding for _, finding in found]

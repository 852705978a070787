"""Thread points and leads: where the wire is threaded and how it gets to the path.

A lead runs in scrap, from the thread point to the nearest point of the wire path, and the wire
leaves by the same way. Where the drawing states no thread point one is chosen: beside the midpoint
of the longest segment, or the centre of a round hole. Such a lead leaves the path at a right angle,
at a corner along its bisector, and its thread point keeps clear of all walls.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import LISTED, Diagnostic, Place, error
from wedmcam.geom import crossings, measure, pairs
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.plan.paths import PlannedPath

#: A lead that arrives this near to a vertex arrives at it: no leftovers of a few steps; um.
SNAP_TO_VERTEX_UM = 5.0
#: How much nearer than the offset to its outline a thread point may be: its own rounding; um.
ROUNDED_UM = 1.0
#: Ties of length within this are ties; um.
TIE_UM = 1e-3
#: A thread point that we choose is at least this share of its lead away from every path: the
#: lead lies along no wall. In a corner its lead halves the angle: one below 29 degrees is refused.
CLEAR = 0.25
#: A lead that is so near to its own path has arrived, um: what it meets there lies in one kerf.
ARRIVES_UM = 10.0
#: A lead has left the segments that meet where it starts, um.
LEAVES_UM = 1.0
#: What is nearer than this touches, um.
LEAST_UM = 1e-3
#: Ends of segments are known to some nanometres: shorter ones may run anywhere, um.
AIMLESS_UM = 0.05
#: How often a lead is halved that would end too near to another wall.
HALVED = 8


@dataclass(frozen=True, slots=True, eq=False)
class Threaded:
    """A path that starts where its lead arrives, and the whole-um thread point.

    ``measured``: a length was asked of the lead; else a thread point or a centre says where it is.
    ``stated``: the thread point as it was stated; None where it was chosen here.
    """

    path: Contour
    thread: tuple[int, int]
    measured: bool = False
    stated: ThreadPoint | None = None


def lead(
    paths: Sequence[PlannedPath],
    threads: Sequence[ThreadPoint],
    lead_um: float,
    only: Sequence[Collection[int]],
    words: str,
) -> tuple[list[Threaded] | None, list[Diagnostic]]:
    """Return every path with its lead.

    Each thread point serves the nearest path whose scrap side holds it. One that serves none, a
    second one for the same path, one nearer to the part than the offset, a lead that crosses a
    path on its way, and one that can only lie along a wall are errors, all of them reported.

    Args:
        paths: closed or open paths, um.
        threads: thread points, um; the nearest whole um is used.
        lead_um: length of a lead whose thread point is chosen here.
        only: for each thread point the numbers of the paths that it may serve.
        words: how a thread point is given, for hints.
    """
    findings: list[Diagnostic] = []
    served: dict[int, tuple[int, int]] = {}
    stated: dict[int, ThreadPoint] = {}
    scene = _Scene(paths)
    for k, point in enumerate(threads):
        if len(findings) >= LISTED:
            more = len(threads) - k
            findings.append(
                error(
                    "thread-point-unused",
                    "{count:,} further thread points were not looked at",
                    count=more,
                )
            )
            break
        x, y = (int(v) for v in to_grid([point.x, point.y]))
        place = Place.of_um(x, y)
        number, problem = _serves(scene, x, y, only[k])
        if number is None:
            findings.append(
                error(
                    "thread-point-unused",
                    "the thread point at {thread} serves no contour: {reason}",
                    point.span,
                    hint="put it on the scrap side of the contour that it is for, or remove it",
                    points_mm=(place,),
                    thread=place,
                    reason=problem,
                )
            )
        elif number in served:
            findings.append(
                error(
                    "thread-point-twice",
                    "the thread point at {thread} is a second one for the contour already served "
                    "from {first}",
                    point.span,
                    hint="remove one of the two",
                    points_mm=(place,),
                    thread=place,
                    first=Place.of_um(*served[number]),
                )
            )
        else:
            served[number] = (x, y)
            stated[number] = point
    if findings:
        return None, findings
    free = [k for k in range(len(paths)) if k not in served]
    result, along = _choose_leads(scene, free, lead_um)
    problems = [(k, _along_wall(paths[k], result[k])) for k in along]
    for number, thread in served.items():
        planned = paths[number]
        arrives = thread if planned.enter is None else (planned.enter.x, planned.enter.y)
        result[number] = Threaded(_start_near(planned.path, arrives), thread, stated=stated[number])
    ordered = [result[k] for k in range(len(paths))]
    problems += _collisions(scene, ordered)
    return ordered, [_with_cure(d, paths[k], words, k in served) for k, d in problems]


class _Scene:
    """All paths as one array of segments, so that a lead is held against all at once."""

    def __init__(self, paths: Sequence[PlannedPath]) -> None:
        self.paths = paths
        starts = np.concatenate([p.path.starts for p in paths])
        ends = np.concatenate([p.path.ends for p in paths])
        self.segments = seg.of_rows(starts, ends)
        self.boxes = seg.boxes(self.segments)
        sizes = np.array([len(p.path) for p in paths])
        self.owner = np.repeat(np.arange(len(paths)), sizes)
        self.first = np.cumsum(sizes) - sizes

    @cached_property
    def scrap_inside(self) -> list[bool | None]:
        """For each path whether scrap is inside of its outline; None where none falls away."""
        return [None if p.scrap_left is None else _scrap_inside(p) for p in self.paths]

    @cached_property
    def outlines(self) -> dict[int, tuple[PlannedPath, bool]]:
        """Outlines by number: one of their paths, and whether scrap is inside."""
        both = zip(self.paths, self.scrap_inside, strict=True)
        return {p.contour: (p, inside) for p, inside in both if inside is not None}

    @cached_property
    def outline_boxes(self) -> Floats:
        """The extents of `outlines`, um, shape (outlines, 4)."""
        held = [(p.outline.vertices, p.outline.closed) for p, _ in self.outlines.values()]
        return measure.extents_of_all(held)

    def around(self, x: float, y: float) -> set[int]:
        """Return the numbers of the outlines that enclose a point."""
        b = self.outline_boxes
        near = (b[:, 0] <= x) & (x <= b[:, 2]) & (b[:, 1] <= y) & (y <= b[:, 3])
        numbers = list(self.outlines)
        px, py = np.array([x]), np.array([y])
        return {
            numbers[k]
            for k in np.flatnonzero(near).tolist()
            if measure.contains(self.outlines[numbers[k]][0].outline.vertices, px, py)[0]
        }

    def of(self, number: int) -> Segments:
        """Return the segments of one path."""
        first = int(self.first[number])
        return self.segments.take(np.arange(first, first + len(self.paths[number].path)))

    def distances(self, x: float, y: float) -> Floats:
        """Return the distance from a point to each path."""
        n = len(self.segments)
        d = seg.distances(self.segments, np.full(n, x), np.full(n, y))
        return np.minimum.reduceat(d, self.first)

    def hits(self, lines: Segments) -> tuple[Ints, Ints, Floats]:
        """Return (line, path, distance along the line) of all crossings of lines with paths."""
        i, segment, at = self.met(lines)
        return i, self.owner[segment], at

    def met(self, lines: Segments) -> tuple[Ints, Ints, Floats]:
        """Return (line, segment of a path, distance along the line) of all crossings."""
        i, j = pairs.overlapping(pairs.grow(seg.boxes(lines), 1e-3), self.boxes)
        both = Segments(
            *(
                np.concatenate([getattr(lines, name), getattr(self.segments, name)])
                for name in Segments.__slots__
            )
        )
        c = crossings.between(both, i, j + len(lines))
        return c.i, c.j - len(lines), c.at_i


# --- which path a thread point serves ------------------------------------------------------------


def _serves(scene: _Scene, x: int, y: int, only: Collection[int]) -> tuple[int | None, str]:
    """Return the number of the path that (x, y) serves, or None and why.

    Scrap lies inside one contour (the innermost around the point) and outside those directly in
    it; on the far side of any other contour there is material in between. Of the paths that bound
    this scrap the nearest is served.
    """
    paths, outlines = scene.paths, scene.outlines
    around = scene.around(float(x), float(y)) if outlines else set()
    # The innermost around the point is the one that is no parent of another one around it.
    inner = around - {outlines[c][0].parent for c in around}
    home = min(inner, default=-1)
    inside_home = home < 0 or outlines[home][1]
    candidates = []
    for k, (planned, scrap_inside) in enumerate(zip(paths, scene.scrap_inside, strict=True)):
        if scrap_inside is None:
            candidates.append(k)
            continue
        if (planned.contour == home and scrap_inside) or (
            planned.contour not in around
            and planned.parent == home
            and not scrap_inside
            and inside_home
        ):
            candidates.append(k)
    if candidates:
        candidates = [k for k in candidates if k in only]
        if not candidates:
            return None, "it is not on the scrap side of its own contour"
    if not candidates:
        return None, "it lies in kept material"
    distances = scene.distances(float(x), float(y))
    best = min(candidates, key=lambda k: (float(distances[k]), k))
    planned = paths[best]
    if planned.scrap_left is not None and distances[best] > ROUNDED_UM:
        s = seg.of_rows(planned.outline.starts, planned.outline.ends)
        n = len(s)
        drawn = float(seg.distances(s, np.full(n, float(x)), np.full(n, float(y))).min())
        if drawn < planned.offset_um - ROUNDED_UM:
            return None, f"it is only {drawn / 1000:.3f} mm from the contour, within the offset"
    return best, ""


def _scrap_inside(planned: PlannedPath) -> bool:
    # A counter-clockwise outline has its inside to the left.
    return planned.scrap_left == (measure.area(planned.outline.vertices) > 0)


# --- the start of a path -------------------------------------------------------------------------


def _start_near(path: Contour, at: tuple[float, float]) -> Contour:
    """Return the path starting at its point nearest to ``at``; an open one at its nearer end."""
    v = path.vertices
    if not path.closed:
        ends = np.hypot(v["x"][[0, -1]] - at[0], v["y"][[0, -1]] - at[1])
        return path if ends[0] <= ends[1] else path.reversed()
    s = seg.of_rows(path.starts, path.ends)
    return start_at(path, s, *_nearest(s, *at))


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


def start_at(
    path: Contour, s: Segments, row: int, at: float, snap_um: float = SNAP_TO_VERTEX_UM
) -> Contour:
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
    if min(at, length - at) <= snap_um:
        first = row if at <= 0.5 * length else (row + 1) % n
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


def _choose_leads(
    scene: _Scene, numbers: Sequence[int], lead_um: float
) -> tuple[dict[int, Threaded], list[int]]:
    """Return leads whose thread points we choose (ruling 3), and those that lie along a wall."""
    result: dict[int, Threaded] = {}
    rays: list[_Ray] = []
    centred: dict[int, Threaded] = {}
    for number in numbers:
        planned = scene.paths[number]
        path = planned.path
        if not path.closed:
            path = (
                path
                if planned.enter is None
                else _start_near(path, (planned.enter.x, planned.enter.y))
            )
            result[number] = _lead_before(path, _length(planned, lead_um))
            continue
        s = scene.of(number)
        inward = measure.area(path.vertices) > 0
        if planned.enter is not None:
            row, at = _nearest(s, planned.enter.x, planned.enter.y)
        elif len(path.vertices) == 1:
            row, at = 0, float(np.mod(-s.a0[0] * s.turn[0], seg.TAU) * s.radius[0])
            if planned.scrap_left is not None and planned.scrap_left == inward:
                cx, cy = to_grid([s.cx[0], s.cy[0]]).tolist()
                centred[number] = Threaded(start_at(path, s, 0, at), (cx, cy))
        else:
            middle_x, middle_y = seg.points_at(s, 0.5 * s.length)
            tied = np.flatnonzero(s.length >= s.length.max() - TIE_UM)
            # Rounded so that float noise does not decide between left and right.
            order = np.lexsort((np.round(middle_x[tied], 3), np.round(middle_y[tied], 3)))
            row = int(tied[order[0]])
            at = 0.5 * float(s.length[row])
        left = planned.scrap_left if planned.scrap_left is not None else not inward
        rays.append(_ray(number, start_at(path, s, row, at), left))
    if centred:
        blocked = _blocked_paths(scene, centred)
        result |= {k: threaded for k, threaded in centred.items() if k not in blocked}
    rays = [ray for ray in rays if ray.number not in result]
    own = np.array([_length(scene.paths[ray.number], lead_um) for ray in rays])
    lengths, clear = _keep_clear(
        scene, rays, np.minimum(own, 0.5 * _free_lengths(scene, rays, 2.0 * own))
    )
    for ray, length in zip(rays, lengths.tolist(), strict=True):
        x, y = to_grid([ray.x + ray.nx * length, ray.y + ray.ny * length]).tolist()
        result[ray.number] = Threaded(ray.path, (x, y), True)
    return result, [ray.number for ray, ok in zip(rays, clear.tolist(), strict=True) if not ok]


def _ray(number: int, path: Contour, left: bool) -> _Ray:
    """Return the direction that halves the angle of scrap at the start of a closed path."""
    s = seg.of_rows(path.starts, path.ends)
    ix, iy = (float(c[-1]) for c in seg.end_tangents(s))
    ox, oy = (float(c[0]) for c in seg.start_tangents(s))
    if min(s.length[0], s.length[-1]) < AIMLESS_UM:
        (ix, iy), (ox, oy) = _headings(s)
    # From the first segment's normal by half the turn of the corner; exact where there is none.
    back = -0.5 * float(np.arctan2(ix * oy - iy * ox, ix * ox + iy * oy))
    back = 0.0 if abs(back) < 1e-9 else back
    c, d = float(np.cos(back)), float(np.sin(back))
    nx, ny = (-oy, ox) if left else (oy, -ox)
    v = path.vertices
    return _Ray(number, path, float(v["x"][0]), float(v["y"][0]), c * nx - d * ny, d * nx + c * ny)


def _headings(s: Segments) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the directions in which a path comes to its start and leaves it, over some steps.

    What is shorter than the noise of its ends has no direction of its own.
    """
    ends_at = np.cumsum(s.length)
    total = float(ends_at[-1])
    ahead = min(0.25, 0.125 * total)
    at = np.array([ahead, total - ahead])
    row = np.minimum(np.searchsorted(ends_at, at), len(s) - 1)
    x, y = seg.points_at(s.take(row), at - ends_at[row] + s.length[row])
    dx, dy = x - s.x0[0], y - s.y0[0]
    size = np.maximum(np.hypot(dx, dy), 1e-12)
    out, back = ((float(dx[k] / size[k]), float(dy[k] / size[k])) for k in (0, 1))
    return (-back[0], -back[1]), out


def _keep_clear(
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


def _along_wall(planned: PlannedPath, threaded: Threaded) -> Diagnostic:
    end = Place.of_um(*(threaded.path.vertices[k][0] for k in ("x", "y")))
    return error(
        "lead-along-wall",
        "a lead that ends at {end} can only lie along a wall, which it would damage: the corner is "
        "too acute to be entered from inside",
        threaded.path.source_of(0) if planned.enter is None else planned.enter.span,
        points_mm=(end,),
        end=end,
    )


def _with_cure(finding: Diagnostic, planned: PlannedPath, words: str, threaded: bool) -> Diagnostic:
    """Return a finding about a lead with what helps.

    That is to move what was stated of it, or to state where it is threaded.
    """
    if threaded and planned.enter is not None:
        return finding.extended(hint="move the thread point, or 'enter'")
    return finding.extended(
        hint="move 'enter', or give a thread point ({way})"
        if planned.enter is not None
        else "move the thread point, or give a thread point ({way})"
        if threaded
        else "give a thread point ({way})",
        way=words,
    )


def _length(planned: PlannedPath, usual: float) -> float:
    return usual if planned.lead_um is None else planned.lead_um


def _blocked_paths(scene: _Scene, leads: dict[int, Threaded]) -> set[int]:
    """Return the paths whose lead crosses another path."""
    numbers = list(leads)
    lines = _leads_as_lines([leads[k] for k in numbers])
    i, other, _ = scene.hits(lines)
    return {numbers[a] for a, b in zip(i.tolist(), other.tolist(), strict=True) if numbers[a] != b}


def _leads_as_lines(leads: Sequence[Threaded]) -> Segments:
    x1 = np.array([float(item.path.vertices["x"][0]) for item in leads])
    y1 = np.array([float(item.path.vertices["y"][0]) for item in leads])
    thread = np.array([item.thread for item in leads], float).reshape(-1, 2)
    return _lines(thread[:, 0], thread[:, 1], x1, y1)


def _lead_before(path: Contour, lead_um: float) -> Threaded:
    """Return an open path with a lead along its own direction, from before its first end."""
    v = path.vertices
    one = seg.of_rows(path.starts[:1], path.ends[:1])
    tx, ty = (float(c[0]) for c in seg.start_tangents(one))
    x, y = to_grid([v["x"][0] - tx * lead_um, v["y"][0] - ty * lead_um]).tolist()
    return Threaded(path, (x, y), True)


#: Where a ray starts, and its direction.
_RAY = ("x", "y", "nx", "ny")


def _free_lengths(scene: _Scene, rays: Sequence[_Ray], reach: Floats) -> Floats:
    """Return how far each ray runs until it meets a path, at most its ``reach``.

    What meets at its own start is not met: the segments next to it, within `LEAVES_UM`.
    """
    start = np.minimum(LEAST_UM, 0.01 * reach)
    x, y, nx, ny = (np.array([getattr(ray, k) for ray in rays], float) for k in _RAY)
    free = reach.copy()
    if len(rays) and (reach > 0).any():
        lines = _lines(x + nx * start, y + ny * start, x + nx * reach, y + ny * reach)
        i, segment, at = scene.met(lines)
        own = scene.owner[segment] == np.array([ray.number for ray in rays])[i]
        beside = seg.distances(scene.segments.take(segment), x[i], y[i]) < LEAST_UM
        met = ~(own & beside & (at < LEAVES_UM))
        np.minimum.at(free, i[met], (at + start[i])[met])
    return free


def _lines(x0: Floats, y0: Floats, x1: Floats, y1: Floats) -> Segments:
    zero = np.zeros(len(x0))
    return seg.make(x0, y0, x1, y1, zero, zero, np.zeros(len(x0), np.int8))


def collisions(paths: Sequence[PlannedPath], threaded: Sequence[Threaded]) -> list[Diagnostic]:
    """Return an error for each lead that meets a path before it arrives; paths are those led to.

    Who asks adds the hint: what helps depends on who put the leads there.
    """
    return [finding for _, finding in _collisions(_Scene(paths), threaded)]


def across(
    threaded: Sequence[Threaded], outlines: Sequence[int], plates: Sequence[int], words: str
) -> list[Diagnostic]:
    """Return an error for each lead that meets the path of another cut, of whatever part.

    Two cuts may run along one path (a second pass), so where a lead arrives it meets both; passes
    of one outline at two offsets may cross each other's, and cuts of two plates do not meet.

    Args:
        threaded: paths with their leads.
        outlines: a number for each, shared by the cuts of one outline.
        plates: the plate of each.
        words: how a thread point is given, for hints.
    """
    paths = [PlannedPath(one.path, one.path, None, 0.0) for one in threaded]
    findings: list[Diagnostic] = []
    for plate in sorted(set(plates)):
        mine = [k for k, p in enumerate(plates) if p == plate]
        numbers = np.array([outlines[k] for k in mine])
        scene = _Scene([paths[k] for k in mine])
        findings += [
            d.extended(hint="give a thread point ({way})", way=words)
            for _, d in _collisions(scene, [threaded[k] for k in mine], numbers)
        ]
    return findings


def _collisions(
    scene: _Scene,
    threaded: Sequence[Threaded],
    outlines: Ints | None = None,
) -> list[tuple[int, Diagnostic]]:
    """Return an error for each lead that meets a path before it arrives, with the number of both.

    ``outlines``: a number for each, shared by the cuts of one outline, that others may have too.
    """
    lines = _leads_as_lines(threaded)
    line, path, at = scene.hits(lines)
    # Its own path it meets where it arrives.
    margin = np.where(line == path, 2.0, -1.0 if outlines is None else ARRIVES_UM)
    early = (at < lines.length[line] - margin) & (lines.length[line] >= 2.0)
    if outlines is not None:
        early &= (line == path) | (outlines[line] != outlines[path])
    order = np.lexsort((at[early], line[early]))
    findings: list[tuple[int, Diagnostic]] = []
    for k in np.flatnonzero(early)[order].tolist():
        number = int(line[k])
        if findings and findings[-1][0] == number:
            continue  # the first hit of a lead says it
        share = float(at[k] / lines.length[number])
        x0, y0, x1, y1 = (float(getattr(lines, n)[number]) for n in ("x0", "y0", "x1", "y1"))
        hx, hy = x0 + (x1 - x0) * share, y0 + (y1 - y0) * share
        met = Place.of_um(hx, hy)
        enter = scene.paths[number].enter
        own = threaded[number].stated
        stated = (own and own.span) or (None if enter is None else enter.span)
        finding = error(
            "lead-hits",
            "the lead from {thread:xy} to {end} meets its own path before it arrives at {place}"
            if path[k] == number
            else "the lead from {thread:xy} to {end} meets another cut at {place}",
            stated or threaded[number].path.source_of(0),
            points_mm=(met,),
            thread=Place.of_um(x0, y0),
            end=Place.of_um(x1, y1),
            place=met,
        )
        findings.append((number, finding))
    return findings

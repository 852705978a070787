"""One line or arc in plain floats: where it runs, beside what it runs, where it crosses another.

School geometry, a segment at a time. It is slow, and it is here so that whoever doubts a path can
follow it by hand. It shares no line with the geometry that makes paths.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin, sqrt

#: A crossing this far past an end still counts, um: far above the noise of float64 for coordinates
#: of 10 m (2e-9 um), far below a step.
REACH_UM = 1e-5
#: Lines with a smaller sine between them are parallel.
PARALLEL = 1e-10

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Segment:
    """A line or an arc, um.

    Attributes:
        x0, y0: start. x1, y1: end.
        cx, cy: centre of an arc.
        turn: +1 a counter-clockwise arc, -1 a clockwise one, 0 a line.
        radius: of an arc; 0 of a line.
        sweep: > 0, the angle that an arc covers, radians; 0 of a line.
    """

    x0: float
    y0: float
    x1: float
    y1: float
    cx: float = 0.0
    cy: float = 0.0
    turn: int = 0
    radius: float = 0.0
    sweep: float = 0.0

    @property
    def start(self) -> Point:
        """Where it begins."""
        return self.x0, self.y0

    @property
    def end(self) -> Point:
        """Where it ends."""
        return self.x1, self.y1

    @property
    def length(self) -> float:
        """Along it, um."""
        if self.turn:
            return self.radius * self.sweep
        return hypot(self.x1 - self.x0, self.y1 - self.y0)

    def start_heading(self) -> Point:
        """Return the unit vector in which it sets out."""
        if self.turn:
            return _across(self.x0 - self.cx, self.y0 - self.cy, self.turn)
        return _unit(self.x1 - self.x0, self.y1 - self.y0)

    def end_heading(self) -> Point:
        """Return the unit vector in which it arrives."""
        if self.turn:
            return _across(self.x1 - self.cx, self.y1 - self.cy, self.turn)
        return _unit(self.x1 - self.x0, self.y1 - self.y0)

    def point(self, at: float) -> Point:
        """Return the place at arc length ``at`` from the start, um."""
        if self.turn:
            angle = atan2(self.y0 - self.cy, self.x0 - self.cx) + self.turn * at / self.radius
            return self.cx + self.radius * cos(angle), self.cy + self.radius * sin(angle)
        ux, uy = self.start_heading()
        return self.x0 + at * ux, self.y0 + at * uy

    def position(self, x: float, y: float) -> float:
        """Return the arc length at which its line or circle passes nearest to a place, um.

        Behind the start it is below 0, past the end above the length.
        """
        if not self.turn:
            ux, uy = self.start_heading()
            return (x - self.x0) * ux + (y - self.y0) * uy
        start = atan2(self.y0 - self.cy, self.x0 - self.cx)
        angle = (atan2(y - self.cy, x - self.cx) - start) * self.turn % (2 * pi)
        outside = 2 * pi - self.sweep
        if angle > self.sweep + 0.5 * outside:
            angle -= 2 * pi
        return angle * self.radius

    def off(self, x: float, y: float) -> float:
        """Return how far a place is from its line or circle, um."""
        if self.turn:
            return abs(hypot(x - self.cx, y - self.cy) - self.radius)
        ux, uy = self.start_heading()
        return abs((y - self.y0) * ux - (x - self.x0) * uy)

    def shifted(self, left_um: float) -> Segment:
        """Return it shifted to the left (negative: right).

        A line moves along its normal, an arc by its radius. What is left of an arc may have a
        radius of 0 or below: it is none then.
        """
        (sx, sy), (ex, ey) = self.start_heading(), self.end_heading()
        return Segment(
            self.x0 - left_um * sy,
            self.y0 + left_um * sx,
            self.x1 - left_um * ey,
            self.y1 + left_um * ex,
            self.cx,
            self.cy,
            self.turn,
            self.radius - left_um * self.turn if self.turn else 0.0,
            self.sweep,
        )

    def between(self, start: Point, end: Point, length: float) -> Segment:
        """Return the part of it from ``start`` to ``end``, which is ``length`` long, um."""
        sweep = length / self.radius if self.turn and self.radius > 0 else 0.0
        return Segment(*start, *end, self.cx, self.cy, self.turn, self.radius, sweep)


def line(start: Point, end: Point) -> Segment:
    """Return a line."""
    return Segment(*start, *end)


def arc(start: Point, end: Point, centre: Point, turn: int) -> Segment:
    """Return an arc about a centre; where it ends at its start it is a full circle."""
    (x0, y0), (x1, y1), (cx, cy) = start, end, centre
    sweep = (atan2(y1 - cy, x1 - cx) - atan2(y0 - cy, x0 - cx)) * turn % (2 * pi)
    if start == end:
        sweep = 2 * pi
    return Segment(x0, y0, x1, y1, cx, cy, turn, hypot(x0 - cx, y0 - cy), sweep)


def crossings(a: Segment, b: Segment) -> list[tuple[Point, float, float]]:
    """Return where two segments cross: the place, and its arc length on ``a`` and on ``b``, um.

    What runs along one line or circle does not cross.
    """
    if a.turn and b.turn:
        places = _circles(a, b)
    elif a.turn or b.turn:
        places = _line_and_circle(b, a) if a.turn else _line_and_circle(a, b)
    else:
        places = _lines(a, b)
    results = []
    for x, y in places:
        on_a, on_b = a.position(x, y), b.position(x, y)
        if _within(on_a, a.length) and _within(on_b, b.length):
            results.append(((x, y), min(max(on_a, 0.0), a.length), min(max(on_b, 0.0), b.length)))
    return results


def _within(at: float, length: float) -> bool:
    return -REACH_UM <= at <= length + REACH_UM


def _lines(a: Segment, b: Segment) -> list[Point]:
    (ax, ay), (bx, by) = a.start_heading(), b.start_heading()
    sine = ax * by - ay * bx
    if abs(sine) <= PARALLEL:
        return []
    along = ((b.x0 - a.x0) * by - (b.y0 - a.y0) * bx) / sine
    return [(a.x0 + along * ax, a.y0 + along * ay)]


def _line_and_circle(straight: Segment, round_: Segment) -> list[Point]:
    ux, uy = straight.start_heading()
    along = (round_.cx - straight.x0) * ux + (round_.cy - straight.y0) * uy
    foot = straight.x0 + along * ux, straight.y0 + along * uy
    return _two(foot, (ux, uy), round_.radius, hypot(foot[0] - round_.cx, foot[1] - round_.cy))


def _circles(a: Segment, b: Segment) -> list[Point]:
    dx, dy = b.cx - a.cx, b.cy - a.cy
    apart = hypot(dx, dy)
    if apart <= REACH_UM or not abs(a.radius - b.radius) - REACH_UM <= apart:
        return []
    # The chord that both have stands so far from the first centre, at right angles to the line
    # through both.
    far = (apart * apart + a.radius * a.radius - b.radius * b.radius) / (2 * apart)
    ux, uy = dx / apart, dy / apart
    foot = a.cx + far * ux, a.cy + far * uy
    if apart > a.radius + b.radius + REACH_UM:
        return []
    return _two(foot, (-uy, ux), a.radius, min(abs(far), a.radius))


def _two(foot: Point, heading: Point, radius: float, away: float) -> list[Point]:
    """Return the ends of a chord of a circle whose middle is ``away`` from the centre; or one."""
    if away > radius + REACH_UM:
        return []
    if away >= radius:
        return [foot]
    half = sqrt(radius * radius - away * away)
    return [
        (foot[0] - half * heading[0], foot[1] - half * heading[1]),
        (foot[0] + half * heading[0], foot[1] + half * heading[1]),
    ]


def _unit(x: float, y: float) -> Point:
    size = hypot(x, y) or 1.0
    return x / size, y / size


def _across(x: float, y: float, turn: int) -> Point:
    """Return the heading of an arc at a place (x, y) from its centre."""
    size = hypot(x, y) or 1.0
    return -turn * y / size, turn * x / size

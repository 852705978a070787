"""Blocks of a contour: from what a drawing states to segments with ends and centres.

Formulas run in the arithmetic of the program, on the unit of the program and relative to the point
that the block starts from. A chain is finished by corner: fillets and chamfers need the block after
them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wedmcam.diag import TextSpan
from wedmcam.frontends.wed.numbers import Number, Numbers, Wrong, wrong
from wedmcam.ir.contour import VERTEX, Contour

XY = tuple[Any, Any]

#: Nearer than this is the same place, um (chains join within it).
SAME_PLACE_UM = 1.0
#: The radius at both ends of an arc may differ by this, um: ends and centre are rounded.
ROUND_UM = 2.0


@dataclass(slots=True)
class Block:
    """A line or an arc from the end of the one before."""

    end: XY
    span: TextSpan
    center: XY = (0, 0)
    turn: int = 0
    corner: tuple[str, Number, TextSpan] | None = None


@dataclass(slots=True)
class Chain:
    """Blocks from a point on."""

    start: XY
    span: TextSpan
    blocks: list[Block] = field(default_factory=list)
    closed: bool = False

    @property
    def here(self) -> XY:
        """Where the next block starts."""
        return self.blocks[-1].end if self.blocks else self.start


def size(x: Any, y: Any) -> Any:
    """Return the length of a vector."""
    return math.hypot(x, y) if isinstance(x, float) else x.hypot(y)


def far(x: Any, y: Any) -> float:
    """Return the length of a vector, in float64: for questions of whether there is one at all."""
    return math.hypot(float(x), float(y))


def root(a: Any) -> Any:
    """Return the square root; what rounding made negative is 0."""
    if a <= 0:
        return a - a
    return math.sqrt(a) if isinstance(a, float) else a.sqrt()


def minus(a: XY, b: XY) -> XY:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1]


def plus(a: XY, b: XY) -> XY:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1]


def cross(a: XY, b: XY) -> Any:
    """Return the cross product, positive where b lies to the left of a."""
    return a[0] * b[1] - a[1] * b[0]


def unit(a: XY) -> XY:
    """Return the vector of length 1."""
    n = size(*a)
    return a[0] / n, a[1] / n


def heading(start: XY, block: Block, at_end: bool) -> XY:
    """Return the direction of a block at one of its ends."""
    if not block.turn:
        return unit(minus(block.end, start))
    rx, ry = minus(block.end if at_end else start, block.center)
    return unit((-ry, rx) if block.turn > 0 else (ry, -rx))


class Builder:
    """Adds blocks to a chain; what cannot be is `Wrong`.

    Args:
        numbers: the arithmetic.
        factor: um in a unit of the program.
    """

    def __init__(self, numbers: Numbers, factor: int) -> None:
        self.numbers = numbers
        self.factor = factor

    def um(self, a: Any) -> float:
        """Return a length in um."""
        return float(a) * self.factor

    def text_of(self, p: XY) -> str:
        """Return a point for people, in the unit of the program."""
        return f"({float(p[0]):.6g}, {float(p[1]):.6g})"

    def line(self, chain: Chain, end: XY, span: TextSpan) -> Block | None:
        """Add a line; None where it has no length."""
        if self.um(far(*minus(end, chain.here))) < 1e-3:
            return None
        chain.blocks.append(Block(end, span))
        return chain.blocks[-1]

    def arc_center(self, chain: Chain, turn: int, end: XY, center: XY, span: TextSpan) -> Block:
        """Add an arc to a point about a centre."""
        one, two = size(*minus(chain.here, center)), size(*minus(end, center))
        if abs(self.um(one) - self.um(two)) > ROUND_UM:
            raise wrong(
                "the centre is {from_start:.8g} from the start {start} of the arc and "
                "{from_end:.8g} from its end {end}",
                from_start=float(one),
                start=self.text_of(chain.here),
                from_end=float(two),
                end=self.text_of(end),
            )
        return self._arc(chain, turn, end, center, span)

    def arc_radius(self, chain: Chain, turn: int, end: XY, radius: Any, span: TextSpan) -> Block:
        """Add an arc to a point: the shorter one for a positive radius."""
        d = minus(end, chain.here)
        half = size(*d) / 2
        r = -radius if radius < 0 else radius
        if self.um(half) < 1e-3:
            raise wrong("an arc with a radius ends elsewhere than it starts")
        if self.um(half) - self.um(r) > SAME_PLACE_UM:
            raise wrong(
                "the ends of this arc are {apart:.8g} apart, more than twice the radius "
                "{radius:.8g}",
                apart=float(half * 2),
                radius=float(r),
            )
        away = root((r - half) * (r + half))
        left = (turn > 0) == (radius > 0)
        u = unit(d)
        n = (-u[1], u[0]) if left else (u[1], -u[0])
        middle = (d[0] / 2 + n[0] * away, d[1] / 2 + n[1] * away)
        return self._arc(chain, turn, end, plus(chain.here, middle), span)

    def arc_sweep(
        self, chain: Chain, turn: int, center: XY, sweep: Number, span: TextSpan
    ) -> Block:
        """Add an arc about a centre by an angle."""
        if not 0 < float(sweep) < 360:
            raise wrong(
                "an arc sweeps more than 0 and less than 360 degrees, not {sweep_deg:.10g}",
                sweep_deg=float(sweep),
            )
        n = self.numbers
        c, s = n.cos(sweep).value, n.sin(sweep).value
        if turn < 0:
            s = -s
        rx, ry = minus(chain.here, center)
        end = plus(center, (rx * c - ry * s, rx * s + ry * c))
        return self._arc(chain, turn, end, center, span)

    def arc_tangent(self, chain: Chain, end: XY, span: TextSpan) -> Block:
        """Add an arc that leaves in the direction in which the block before ends."""
        if not chain.blocks:
            raise wrong("a tangent arc needs a block before it")
        before = chain.blocks[-2].end if len(chain.blocks) > 1 else chain.start
        t = heading(before, chain.blocks[-1], True)
        d = minus(end, chain.here)
        side = cross(t, d)
        if self.um(far(*d)) < 1e-3 or abs(float(side)) < 1e-6 * float(size(*d)):
            raise wrong("the end lies straight ahead or behind: no arc is tangent there")
        r = (d[0] * d[0] + d[1] * d[1]) / (side * 2)
        center = plus(chain.here, (-t[1] * r, t[0] * r))
        return self._arc(chain, 1 if side > 0 else -1, end, center, span)

    def _arc(self, chain: Chain, turn: int, end: XY, center: XY, span: TextSpan) -> Block:
        if self.um(far(*minus(end, chain.here))) < 1e-3:
            raise wrong("this arc ends where it starts: a full circle is 'circle center ...'")
        if self.um(far(*minus(end, center))) < 1e-3:
            raise wrong("this arc has no radius: its centre is one of its ends")
        chain.blocks.append(Block(end, span, center, turn))
        return chain.blocks[-1]

    def circle(self, turn: int, center: XY, radius: Any, span: TextSpan) -> Chain:
        """Return a full circle, which starts at its right-most point."""
        if self.um(radius) < 1.0:
            raise wrong(
                "a circle has a radius of 1 um or more, not {radius:.6g}", radius=float(radius)
            )
        start = plus(center, (radius, radius - radius))
        return Chain(start, span, [Block(start, span, center, turn)], True)

    def finished(self, chain: Chain) -> tuple[Chain, list[tuple[Exception, TextSpan]]]:
        """Return a chain with its corners made, and why some cannot be made."""
        failures: list[tuple[Exception, TextSpan]] = []
        blocks = chain.blocks
        starts = [chain.start, *(b.end for b in blocks[:-1])]
        ends = [b.end for b in blocks]
        between: list[Block | None] = [None] * len(blocks)
        for k, b in enumerate(blocks):
            if b.corner is None:
                continue
            kind, value, span = b.corner
            j = (k + 1) % len(blocks)
            if j == 0 and not chain.closed:
                last = wrong("no block follows this {corner}: nothing can be rounded", corner=kind)
                failures.append((last, span))
                continue
            try:
                make = self._fillet if kind == "fillet" else self._chamfer
                # The original blocks tell directions; what is left of them is checked below.
                one, two, piece = make(b, blocks[j], self._start(chain, k), value, span)
                self._fits(starts[k], ends[k], b, one, True)
                self._fits(starts[j], ends[j], blocks[j], two, False)
            except (Wrong, ArithmeticError, ValueError) as why:
                failures.append((why if str(why) else wrong("this corner cannot be made"), span))
                continue
            ends[k], starts[j], between[k] = one, two, piece
        out = Chain(starts[0] if blocks else chain.start, chain.span, [], chain.closed)
        for k, b in enumerate(blocks):
            if self.um(far(*minus(ends[k], starts[k]))) > 1e-3 or len(blocks) == 1:
                out.blocks.append(Block(ends[k], b.span, b.center, b.turn))
            if (added := between[k]) is not None:
                out.blocks.append(added)
        return out, failures

    def _start(self, chain: Chain, k: int) -> XY:
        return chain.blocks[k - 1].end if k else chain.start

    def _fits(self, start: XY, end: XY, block: Block, at: XY, keep_start: bool) -> None:
        """Raise where a corner takes more of a block than there is."""
        if not block.turn:
            (ux, uy), d = minus(end, start), minus(at, start) if keep_start else minus(end, at)
            length, dx, dy = far(ux, uy), float(d[0]), float(d[1])
            if float(ux) * dx + float(uy) * dy < -1e-9 * length * max(1.0, math.hypot(dx, dy)):
                raise wrong(
                    "the corner does not fit: its neighbour, {length:.6g} long, is too short",
                    length=length,
                )
            return
        a, b, p = (
            math.atan2(float(q[1]) - float(block.center[1]), float(q[0]) - float(block.center[0]))
            for q in (start, end, at)
        )
        sweep, part = ((q - a) * block.turn % (2 * math.pi) for q in (b, p))
        if part > sweep + 1e-9 and part < 2 * math.pi - 1e-9:
            raise wrong("the corner does not fit: the arc beside it is too short")

    def _chamfer(
        self, b: Block, c: Block, start: XY, value: Number, span: TextSpan
    ) -> tuple[XY, XY, Block]:
        if b.turn or c.turn:
            raise wrong("a chamfer stands between two lines")
        d = value.value
        if not d > 0:
            raise wrong("a chamfer is longer than 0, not {chamfer:.10g}", chamfer=float(value))
        t, u = heading(start, b, True), heading(b.end, c, False)
        one = minus(b.end, (t[0] * d, t[1] * d))
        two = plus(b.end, (u[0] * d, u[1] * d))
        return one, two, Block(two, span)

    def _fillet(
        self, b: Block, c: Block, start: XY, value: Number, span: TextSpan
    ) -> tuple[XY, XY, Block]:
        r = value.value
        if not r > 0:
            raise wrong("a fillet has a radius above 0, not {radius:.10g}", radius=float(value))
        corner = b.end
        t, u = heading(start, b, True), heading(corner, c, False)
        turn = cross(t, u)
        if abs(float(turn)) < 1e-6:
            raise wrong("there is no corner here: the blocks go on straight, or turn back")
        side = 1 if turn > 0 else -1
        center = self._between(b, c, corner, t, u, r * side)
        one = self._foot(b, corner, t, r * side, center)
        two = self._foot(c, corner, u, r * side, center)
        place = plus(corner, center)
        return plus(corner, one), plus(corner, two), Block(plus(corner, two), span, place, side)

    def _foot(self, b: Block, corner: XY, t: XY, by: Any, center: XY) -> XY:
        """Return where a fillet touches a block; points relative to the corner."""
        if not b.turn:
            return minus(center, (-t[1] * by, t[0] * by))
        c = minus(b.center, corner)
        v = unit(minus(center, c))
        radius = size(*c)
        return plus(c, (v[0] * radius, v[1] * radius))

    def _between(self, b: Block, c: Block, corner: XY, t: XY, u: XY, by: Any) -> XY:
        """Return where two blocks, shifted to the left by ``by``, cross: the crossing nearest 0."""
        if not b.turn and not c.turn:
            p, q = (-t[1] * by, t[0] * by), (-u[1] * by, u[0] * by)
            along = cross(minus(q, p), u) / cross(t, u)
            return plus(p, (t[0] * along, t[1] * along))
        circles = []
        for block in (b, c):
            if block.turn:
                centre = minus(block.center, corner)
                radius = size(*centre) - by * block.turn
                if not radius > 0:
                    raise wrong("the fillet is larger than the arc that it rounds into")
                circles.append((centre, radius))
        if len(circles) == 1:
            w = u if b.turn else t
            p = (-w[1] * by, w[0] * by)
            (centre, radius), d = circles[0], minus(circles[0][0], p)
            along, off = d[0] * w[0] + d[1] * w[1], cross(w, d)
            square = (radius - off) * (radius + off)
            if square < 0:
                raise wrong("no fillet of this radius touches both blocks")
            both = [along - root(square), along + root(square)]
            found = [plus(p, (w[0] * a, w[1] * a)) for a in both]
        else:
            (c1, r1), (c2, r2) = circles
            d = minus(c2, c1)
            apart = size(*d)
            if not apart > 0:
                raise wrong("both arcs have one centre: there is no corner between them")
            along = (apart + (r1 - r2) * (r1 + r2) / apart) / 2
            square = (r1 - along) * (r1 + along)
            if square < 0:
                raise wrong("no fillet of this radius touches both blocks")
            v, h = (d[0] / apart, d[1] / apart), root(square)
            foot = plus(c1, (v[0] * along, v[1] * along))
            found = [plus(foot, (-v[1] * h, v[0] * h)), plus(foot, (v[1] * h, -v[0] * h))]
        return min(found, key=lambda p: float(size(*p)))

    def contour(self, chain: Chain) -> Contour:
        """Return a chain as a contour, um."""
        n = len(chain.blocks)
        rows = np.zeros(n if chain.closed else n + 1, VERTEX)
        points = [chain.start, *(b.end for b in chain.blocks)]
        um = self.numbers.um
        for k in range(len(rows)):
            rows["x"][k], rows["y"][k] = (um(Number(v), self.factor) for v in points[k])
        for k, b in enumerate(chain.blocks):
            rows["turn"][k] = b.turn
            if b.turn:
                rows["cx"][k], rows["cy"][k] = (um(Number(v), self.factor) for v in b.center)
        rows["source"] = np.arange(len(rows))
        if not chain.closed:
            rows["source"][-1] = -1
        return Contour(rows, chain.closed, tuple(b.span for b in chain.blocks))

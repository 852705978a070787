"""Small plans and programs, made by hand: nothing here comes from the compiler."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from plans import one_scene
from wedmcam.controllers import pointwise as controller
from wedmcam.controllers.pointwise import LineTable
from wedmcam.ir.contour import Contour, vertices
from wedmcam.ir.plan import Cut, Side
from wedmcam.ir.program import BLOCK, Axis, Kind, Program

OFFSET = 100.0


def circle(x, y, r, turn=1):
    return Contour(vertices([(x + r, y, x, y, turn, -1)]), True)


def polygon(*points):
    return Contour(vertices([(x, y, 0, 0, 0, -1) for x, y in points]), True)


def square(size):
    """Corner at the origin, counter-clockwise, starting at (0, 0)."""
    return polygon((0, 0), (size, 0), (size, size), (0, size))


def square_outside(size, d):
    """The wire path round the square with transition arcs, from the middle of the lower side."""
    s, h = float(size), size / 2
    return Contour(
        vertices(
            [
                (h, -d, 0, 0, 0, -1),
                (s, -d, s, 0, 1, -1),
                (s + d, 0, 0, 0, 0, -1),
                (s + d, s, s, s, 1, -1),
                (s, s + d, 0, 0, 0, -1),
                (0, s + d, 0, s, 1, -1),
                (-d, s, 0, 0, 0, -1),
                (-d, 0, 0, 0, 1, -1),
                (0, -d, 0, 0, 0, -1),
            ]
        ),
        True,
    )


def square_inside(size, d):
    s, h = float(size), size / 2
    return polygon((h, d), (s - d, d), (s - d, s - d), (d, s - d), (d, d))


def line(x, y, table=LineTable.ROTATE):
    """A line block as the tie rule wants it."""
    b = np.zeros(1, BLOCK)
    axis = Axis.X if abs(x) > abs(y) else Axis.Y
    if abs(x) == abs(y) and table == LineTable.ROTATE and x * y < 0:
        axis = Axis.X
    b[0] = (Kind.LINE, 0, axis, 0, x, y, max(abs(x), abs(y)), -1, 0)
    return b


def arc(x, y, turn, axis, count):
    b = np.zeros(1, BLOCK)
    b[0] = (Kind.ARC, turn, axis, 0, x, y, count, -1, 0)
    return b


def control(kind):
    b = np.zeros(1, BLOCK)
    b["kind"], b["source"] = kind, -1
    return b


def move(x, y, table=LineTable.ROTATE):
    b = line(x, y, table)
    b["kind"] = Kind.MOVE
    return b


def arc_to(start, end, centre, turn):
    """An arc block that lands exactly; the centre may be moved by a micron."""
    for ox, oy in sorted(
        ((i, j) for i in range(-2, 3) for j in range(-2, 3)), key=lambda o: abs(o[0]) + abs(o[1])
    ):
        cx, cy = centre[0] + ox, centre[1] + oy
        x, y = start[0] - cx, start[1] - cy
        e = controller.arc_end(x, y, turn, end[0] - cx, end[1] - cy)
        if bool(e.landed):
            axis = Axis(int(e.last_axis))
            return arc(x, y, turn, axis, int(e.count_x if axis == Axis.X else e.count_y))
    raise AssertionError((start, end, centre, turn))


def lower(plan, table=LineTable.ROTATE):
    """The simplest lowering: a block a segment, every vertex rounded, every arc landing."""
    out = []
    at = origin = plan.cuts[0].thread

    def to(x, y):
        return (int(np.floor(x + 0.5)), int(np.floor(y + 0.5)))

    for k, cut in enumerate(plan.cuts):
        if k:
            out.append(control(Kind.PAUSE))
            if cut.thread != at:
                out.append(move(cut.thread[0] - at[0], cut.thread[1] - at[1], table))
                out.append(control(Kind.PAUSE))
            at = cut.thread
        v = cut.path.starts
        first = to(v["x"][0], v["y"][0])
        if first != at:
            out.append(line(first[0] - at[0], first[1] - at[1], table))
        at = first
        for a, b in zip(v, cut.path.ends, strict=True):
            end = to(b["x"], b["y"])
            if a["turn"]:
                out.append(arc_to(at, end, to(a["cx"], a["cy"]), int(a["turn"])))
            else:
                out.append(line(end[0] - at[0], end[1] - at[1], table))
            at = end
        if cut.path.closed and at != cut.thread:
            out.append(line(cut.thread[0] - at[0], cut.thread[1] - at[1], table))
            at = cut.thread
    out.append(control(Kind.STOP))
    return Program(np.concatenate(out), origin)


def hole_plan(side=Side.PART):
    """A hole of radius 10 mm, the published program's: depth 1 of a part that is not cut."""
    return one_scene(
        (Cut(circle(0, 0, 10000), circle(0, 0, 9900), (0, 0), depth=0),),
        (circle(0, 0, 10000),),
        (0,),
        side,
        OFFSET,
    )


def square_plan(size=10000, side=Side.PART):
    d = OFFSET
    if side is Side.PART:
        path, thread = square_outside(size, d), (size // 2, -1000)
    else:
        path, thread = square_inside(size, d), (size // 2, size // 2)
    return one_scene((Cut(square(size), path, thread),), (square(size),), (0,), side, d)


def part_with_hole():
    """A square of 10 mm with a hole of radius 2 mm; the hole first."""
    hole = circle(5000, 5000, 2000)
    return one_scene(
        (
            Cut(hole, circle(5000, 5000, 1900), (5000, 5000), depth=1, number=2),
            Cut(square(10000), square_outside(10000, OFFSET), (5000, -1000)),
        ),
        (square(10000), hole),
        (0, 1),
        Side.PART,
        OFFSET,
    )


def skew_plan(turn=0.3, size=10000.0, d=OFFSET):
    """A square turned by ``turn`` radians, corners rounded by 0.15 of it: nothing on the grid."""
    c, s = np.cos(turn), np.sin(turn)
    r = 0.15 * size

    def ring(grow):
        h, rr = size / 2, r + grow
        rows = []
        for k in range(4):
            a = k * np.pi / 2
            ca, sa = np.cos(a), np.sin(a)
            corner = (h - r, h - r)
            e0, e1 = (corner[0] + rr, corner[1]), (corner[0], corner[1] + rr)
            for point, turning in ((e0, 1), (e1, 0)):
                rows.append(
                    (
                        point[0] * ca - point[1] * sa,
                        point[0] * sa + point[1] * ca,
                        corner[0] * ca - corner[1] * sa,
                        corner[0] * sa + corner[1] * ca,
                        turning,
                    )
                )
        return Contour(
            vertices(
                [
                    (x * c - y * s, x * s + y * c, cx * c - cy * s, cx * s + cy * c, t, -1)
                    for x, y, cx, cy, t in rows
                ]
            ),
            True,
        )

    v = ring(d).vertices
    out = np.array([v["x"][0], v["y"][0]])
    thread = tuple(int(q) for q in np.round(out + 1000 * np.array([c, s])))
    return one_scene((Cut(ring(0.0), ring(d), thread),), (ring(0.0),), (0,), Side.PART, d)


def edited(program, change):
    """Return the program with ``change(blocks)``; the change may return other blocks."""
    blocks = program.blocks.copy()
    other = change(blocks)
    return replace(program, blocks=blocks if other is None else other)

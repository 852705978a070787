"""What was understood, derived from the plan alone: rows of `ir.understanding`.

Whoever has the plan again (`verify`) has the same rows again. Side and direction are measured on
the path and the outline themselves, so that a row says what the wire does and not what was asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from wedmcam.diag import EntityRef, Span, TextSpan
from wedmcam.geom import measure
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan, outline_numbers
from wedmcam.ir.understanding import NAMED, DrawnBy, Role, Row, Thread, Understanding, place


def understood(plan: Plan) -> Understanding:
    """Return a row a cut, in the order of cutting."""
    known = [cut.outline or cut.path for cut in plan.cuts]
    shapes = [(c.vertices, c.closed) for c in known]
    boxes = measure.extents_of_all(shapes)
    lengths, areas = measure.sizes_of_all([(c.path.vertices, c.path.closed) for c in plan.cuts])
    _, drawn = measure.sizes_of_all(shapes)
    freed: set[int] = set()
    rows = []
    for number, (cut, shape, outline, box) in enumerate(
        zip(plan.cuts, known, outline_numbers(plan.cuts), boxes.tolist(), strict=True), 1
    ):
        x, y = (float(cut.path.vertices[k][0]) for k in ("x", "y"))
        lies = _Lies.of(cut, shape, float(areas[number - 1]), float(drawn[number - 1]))
        frees = None
        if shape.closed and outline not in freed:  # a second pass frees nothing
            freed.add(outline)
            frees = {"inside": "part", "outside": "slug", None: "piece"}[lies.kept]
        rows.append(
            Row(
                number,
                Thread(number, cut.thread, cut.stated),
                Role.of(shape.closed, cut.depth),
                cut.depth,
                lies.kept,
                str(cut.side),
                cut.offset_um,
                cut.clearance_um,
                lies.way,
                lies.direction,
                math.hypot(x - cut.thread[0], y - cut.thread[1]),
                (x, y),
                cut.stop_um,
                cut.overcut_um,
                float(lengths[number - 1]),
                tuple(box),
                frees,
                drawn_by(shape),
            )
        )
    return Understanding(tuple(rows))


class _Lies(NamedTuple):
    """How a path lies beside its outline; see `Row`."""

    kept: str | None
    way: str | None
    direction: str

    @classmethod
    def of(cls, cut: Cut, outline: Contour, area: float, drawn: float) -> _Lies:
        """Return it, measured on both, whose signed areas these are."""
        if not outline.closed:
            v = cut.path.vertices
            ends = (place((v["x"][k], v["y"][k])) for k in (0, -1))
            way = (
                ("right" if _beside(cut.path, outline).left else "left") if cut.offset_um else None
            )
            return cls(None, way, "from {} to {}".format(*ends))
        if cut.path.closed:
            ccw = area > 0
            outside = bool(cut.offset_um) and abs(area) > abs(drawn)
        else:  # what is left of it
            beside = _beside(cut.path, outline)
            ccw = beside.along == (drawn > 0)
            outside = not measure.contains(outline.vertices, *beside.at)[0]
        kept = None if cut.keeps_left is None else "inside" if cut.keeps_left == ccw else "outside"
        way = None if not cut.offset_um else "outside" if outside else "inside"
        return cls(kept, way, "ccw" if ccw else "cw")


class _Beside(NamedTuple):
    """Where the outline lies, seen from the middle of the longest segment of a path.

    Attributes:
        left: to the left of the path.
        along: it runs the same way.
        at: the place, um: x and y, an array of one each.
    """

    left: bool
    along: bool
    at: tuple[Floats, Floats]


def _beside(path: Contour, outline: Contour) -> _Beside:
    s = seg.of_rows(path.starts, path.ends)
    own = s.take(np.array([int(np.argmax(s.length))]))
    x, y = measure.middles(own)
    other = seg.of_rows(outline.starts, outline.ends)
    n = len(other)
    off = seg.distances(other, np.full(n, x[0]), np.full(n, y[0]))
    near = other.take(np.array([int(np.argmin(off))]))
    qx, qy = seg.points_at(near, np.clip(seg.position_of(near, x, y), 0.0, near.length))
    ux, uy = _heading(own, x, y)
    vx, vy = _heading(near, qx, qy)
    left = bool(ux * (qy - y)[0] - uy * (qx - x)[0] > 0)
    return _Beside(left, ux * vx + uy * vy > 0, (x, y))


def _heading(s: seg.Segments, x: Floats, y: Floats) -> tuple[float, float]:
    """Return the direction of a lone segment at a place on it; its length says nothing."""
    turn = int(s.turn[0])
    if not turn:
        return float(s.ux[0]), float(s.uy[0])
    return float(-turn * (y - s.cy)[0]), float(turn * (x - s.cx)[0])


def drawn_by(contour: Contour) -> DrawnBy:
    """Return what drew the segments of a contour."""
    used, first = np.unique(contour.starts["source"], return_index=True)
    in_turn = used[np.argsort(first)]
    spans = [contour.sources[k] for k in in_turn.tolist() if 0 <= k < len(contour.sources)]
    entities = [s for s in spans if isinstance(s, EntityRef)]
    layers = list(dict.fromkeys(e.layer for e in entities))
    handles = list(dict.fromkeys("/".join((*e.via, e.handle)) for e in entities))
    lines = _lines(spans)
    more = max(len(handles) - NAMED, 0) + max(len(lines) - NAMED, 0)
    file = next((s.file for s in spans if isinstance(s, TextSpan)), "")
    named = (tuple(layers[:NAMED]), tuple(handles[:NAMED]), tuple(lines[:NAMED]))
    return DrawnBy(*named, more, file)


def _lines(spans: Iterable[Span]) -> list[int]:
    return list(dict.fromkeys(s.line for s in spans if isinstance(s, TextSpan)))

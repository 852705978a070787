"""The course: everything the wire runs along, lead-ins and all, as one chain of true segments.

Vertices are shared by number: a closed path ends at the vertex where it began, the way out uses the
vertices of the way in. So whatever micron a vertex is put on, the path closes exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from wedmcam.diag import Span
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import Role

#: Two neighbouring arcs are one when centre and radius agree this well; um.
SAME_CIRCLE_UM = 1e-6


@dataclass(slots=True)
class Course:
    """Segments in cutting order, and the vertices they run between.

    Columns of segments: v0, v1 (vertex numbers), cx, cy, radius, turn, source, role, cut (number),
    keeps (+1, -1, 0), group (segments between two stops of the machine share one).
    Columns of vertices: x, y (true, um), uses (how many segments begin or end there).
    """

    v0: list[int] = field(default_factory=list)
    v1: list[int] = field(default_factory=list)
    cx: list[float] = field(default_factory=list)
    cy: list[float] = field(default_factory=list)
    radius: list[float] = field(default_factory=list)
    turn: list[int] = field(default_factory=list)
    source: list[int] = field(default_factory=list)
    role: list[int] = field(default_factory=list)
    cut: list[int] = field(default_factory=list)
    keeps: list[int] = field(default_factory=list)
    group: list[int] = field(default_factory=list)
    x: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    pinned: list[bool] = field(default_factory=list)
    sources: list[Span] = field(default_factory=list)
    #: (group, cut index) of each cut's groups, in order: what stands between two D.
    cut_groups: list[list[int]] = field(default_factory=list)

    def vertex(self, x: float, y: float, pinned: bool = False) -> int:
        """Add a vertex and return its number. A pinned one stays on its nearest micron."""
        self.x.append(float(x))
        self.y.append(float(y))
        self.pinned.append(pinned)
        return len(self.x) - 1

    def extend(self, rows: Rows, group: int, cut: int, keeps: int) -> None:
        """Append segments."""
        n = len(rows.v0)
        self.v0 += rows.v0
        self.v1 += rows.v1
        self.cx += rows.cx
        self.cy += rows.cy
        self.radius += rows.radius
        self.turn += rows.turn
        self.source += rows.source
        self.role += [rows.role] * n
        self.cut += [cut] * n
        self.keeps += [keeps] * n
        self.group += [group] * n


@dataclass(slots=True)
class Rows:
    """A run of segments of one role."""

    role: int
    v0: list[int]
    v1: list[int]
    cx: list[float]
    cy: list[float]
    radius: list[float]
    turn: list[int]
    source: list[int]

    def part(self, first: int, last: int, role: int | None = None) -> Rows:
        """Return segments first..last-1."""
        s = slice(first, last)
        return Rows(
            self.role if role is None else role,
            self.v0[s],
            self.v1[s],
            self.cx[s],
            self.cy[s],
            self.radius[s],
            self.turn[s],
            self.source[s],
        )

    def backwards(self) -> Rows:
        """Return the run the other way: arcs turn the other way, vertices stay."""
        return Rows(
            self.role,
            self.v1[::-1],
            self.v0[::-1],
            self.cx[::-1],
            self.cy[::-1],
            self.radius[::-1],
            [-t for t in self.turn[::-1]],
            self.source[::-1],
        )


def lay_out(plan: Plan) -> Course:
    """Return the course of a plan: per cut lead-in, path, overcut and back, lead-out."""
    course = Course()
    for index, cut in enumerate(plan.cuts):
        _lay_cut(course, cut, index)
    return course


def _lay_cut(course: Course, cut: Cut, index: int) -> None:
    base = len(course.sources)
    course.sources += cut.path.sources
    keeps = 0 if cut.keeps_left is None else (1 if cut.keeps_left else -1)
    path, stop_at, over_at = _path_rows(course, cut, base)
    thread = course.vertex(*cut.thread, pinned=True)
    first, last = path.v0[0], path.v1[-1]
    lead_in = Rows(Role.LEAD_IN, [thread], [first], [0.0], [0.0], [0.0], [0], [-1])
    group = course.group[-1] + 1 if course.group else 0
    number = index + 1
    groups = [group]
    course.extend(lead_in, group, number, 0)
    course.extend(path.part(0, stop_at), group, number, keeps)
    if stop_at < len(path.v0):
        group += 1
        groups.append(group)
        course.extend(path.part(stop_at, len(path.v0)), group, number, keeps)
    if over_at:
        over = path.part(0, over_at, Role.OVERCUT)
        course.extend(over, group, number, keeps)
        # Back in the kerf: the only way out that certainly cuts nothing.
        course.extend(over.backwards(), group, number, -keeps)
    if cut.path.closed:
        out = Rows(Role.LEAD_OUT, [last], [thread], [0.0], [0.0], [0.0], [0], [-1])
        course.extend(out, group, number, 0)
    course.cut_groups.append(groups)


def _path_rows(course: Course, cut: Cut, base: int) -> tuple[Rows, int, int]:
    """Return the path as rows, and the rows at which the stop and the end of the overcut lie."""
    contour = cut.path
    merged = _merge_arcs(contour)
    s = seg.of_rows(contour.starts, contour.ends)
    length = s.length
    total = float(length.sum())
    cuts_at: list[float] = []
    stop = total - cut.stop_um if cut.stop_um > 0 else None
    over = cut.overcut_um if cut.overcut_um > 0 and contour.closed else None
    if stop is not None:
        cuts_at.append(max(stop, 0.0))
    if over is not None:
        cuts_at.append(min(over, total))
    starts = merged  # first segment of each merged run
    run_end = np.append(starts[1:], len(length))
    ends_at = np.cumsum(length)
    begin_at = ends_at - length
    rows = Rows(Role.CONTOUR, [], [], [], [], [], [], [])
    vx, vy = contour.vertices["x"], contour.vertices["y"]
    first = course.vertex(vx[0], vy[0], pinned=True)
    here = first
    stop_row = over_row = 0
    n = len(starts)
    source = contour.vertices["source"]
    marks = sorted(cuts_at)
    for k, (a, b) in enumerate(zip(starts.tolist(), run_end.tolist(), strict=True)):
        low, high = float(begin_at[a]), float(ends_at[b - 1])
        for mark in marks:
            if low + 0.5 < mark < high - 0.5:
                px, py = _at(s, begin_at, mark)
                there = course.vertex(px, py)
                _append(rows, here, there, s, a, int(source[a]), base)
                here = there
                low = mark
            if mark == stop and low - 0.5 <= mark <= low + 0.5 and not stop_row:
                stop_row = len(rows.v0)
            if mark == over and low - 0.5 <= mark <= low + 0.5 and not over_row:
                over_row = len(rows.v0)
        if k == n - 1 and contour.closed:
            there = first
        else:
            end = b if contour.closed else min(b, len(vx) - 1)
            there = course.vertex(vx[end], vy[end], pinned=not contour.closed and k == n - 1)
        _append(rows, here, there, s, a, int(source[a]), base)
        here = there
    if stop is None or not stop_row:
        stop_row = len(rows.v0)
    if over is not None and not over_row:
        over_row = len(rows.v0)
    return rows, stop_row, over_row


def _append(rows: Rows, v0: int, v1: int, s: Segments, a: int, source: int, base: int) -> None:
    rows.v0.append(v0)
    rows.v1.append(v1)
    rows.cx.append(float(s.cx[a]))
    rows.cy.append(float(s.cy[a]))
    rows.radius.append(float(s.radius[a]))
    rows.turn.append(int(s.turn[a]))
    rows.source.append(base + source if source >= 0 else -1)


def _at(s: Segments, begin_at: Floats, mark: float) -> tuple[float, float]:
    k = int(np.clip(np.searchsorted(begin_at, mark, side="right") - 1, 0, len(begin_at) - 1))
    x, y = seg.points_at(s.take(np.array([k])), np.array([mark - begin_at[k]]))
    return float(x[0]), float(y[0])


def _merge_arcs(contour: Contour) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return the first segment of each run of segments that lie on one circle, in order.

    A circle drawn as two half circles is one block again. The first vertex stays.
    """
    v = contour.starts
    s = seg.of_rows(contour.starts, contour.ends)
    same = (
        (v["turn"][1:] != 0)
        & (v["turn"][1:] == v["turn"][:-1])
        & (np.abs(s.cx[1:] - s.cx[:-1]) < SAME_CIRCLE_UM)
        & (np.abs(s.cy[1:] - s.cy[:-1]) < SAME_CIRCLE_UM)
        & (np.abs(s.radius[1:] - s.radius[:-1]) < SAME_CIRCLE_UM)
    )
    starts = np.flatnonzero(np.append(True, ~same))
    # Merging must not wrap more than a turn.
    if same.any():
        run_end = np.append(starts[1:], len(v))
        total = np.add.reduceat(s.sweep, starts)
        if (total > seg.TAU + 1e-9).any():
            return np.arange(len(v))
        del run_end
    return starts

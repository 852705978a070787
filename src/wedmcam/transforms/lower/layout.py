"""The course: everything the wire runs along, lead-ins and all, as one chain of true segments.

Vertices are shared by number: a closed path ends at the vertex where it began, the way out uses the
vertices of the way in. So whatever micron a vertex is put on, the path closes exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wedmcam.diag import Span
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Segments
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import Role


class Mark(NamedTuple):
    """Where a stop or an overcut ends, and where it may not: on one step it would be none.

    Attributes:
        name: "stop" or "overcut".
        cut: index of the cut.
        vertex: where it is.
        others: vertices that must lie on other steps.
    """

    name: str
    cut: int
    vertex: int
    others: tuple[int, ...]


@dataclass(slots=True)
class Layout:
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
    #: Where each list of sources begins, by its identity: contours of one drawing share theirs.
    begins: dict[int, int] = field(default_factory=dict)
    #: (group, cut index) of each cut's groups, in order: what stands between two D.
    cut_groups: list[list[int]] = field(default_factory=list)
    #: Places that no step of the machine may make one.
    marks: list[Mark] = field(default_factory=list)

    def vertex(self, x: float, y: float, pinned: bool = False) -> int:
        """Add a vertex and return its number. A pinned one stays on its nearest micron."""
        self.x.append(float(x))
        self.y.append(float(y))
        self.pinned.append(pinned)
        return len(self.x) - 1

    def cite(self, sources: tuple[Span, ...]) -> int:
        """Return where these sources begin in ``sources``; what is there is not added again."""
        if id(sources) not in self.begins:
            self.begins[id(sources)] = len(self.sources)
            self.sources += sources
        return self.begins[id(sources)]

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


def lay_out(plan: Plan) -> Layout:
    """Return the course of a plan: per cut lead-in, path, overcut and back, lead-out."""
    layout = Layout()
    for index, cut in enumerate(plan.cuts):
        _lay_cut(layout, cut, index)
    return layout


def _lay_cut(layout: Layout, cut: Cut, index: int) -> None:
    base = layout.cite(cut.path.sources)
    keeps = 0 if cut.keeps_left is None else (1 if cut.keeps_left else -1)
    path, stop_at, over_at = _path_rows(layout, cut, base)
    thread = layout.vertex(*cut.thread, pinned=True)
    first, last = path.v0[0], path.v1[-1]
    lead_in = Rows(Role.LEAD_IN, [thread], [first], [0.0], [0.0], [0.0], [0], [-1])
    group = layout.group[-1] + 1 if layout.group else 0
    number = index + 1
    groups = [group]
    layout.extend(lead_in, group, number, 0)
    if stop_at is not None:
        there = path.v0[stop_at] if stop_at < len(path.v0) else last
        layout.marks.append(Mark("stop", index, there, (thread, last)))
    if over_at is not None:
        there = path.v1[over_at - 1] if over_at else first
        layout.marks.append(Mark("overcut", index, there, (first,)))
    stop_at = len(path.v0) if stop_at is None else stop_at
    layout.extend(path.part(0, stop_at), group, number, keeps)
    if stop_at < len(path.v0):
        group += 1
        groups.append(group)
        layout.extend(path.part(stop_at, len(path.v0)), group, number, keeps)
    if over_at:
        over = path.part(0, over_at, Role.OVERCUT)
        layout.extend(over, group, number, keeps)
        # Back in the kerf: the only way out that certainly cuts nothing.
        layout.extend(over.backwards(), group, number, -keeps)
    if cut.path.closed:
        out = Rows(Role.LEAD_OUT, [last], [thread], [0.0], [0.0], [0.0], [0], [-1])
        layout.extend(out, group, number, 0)
    layout.cut_groups.append(groups)


def _path_rows(layout: Layout, cut: Cut, base: int) -> tuple[Rows, int | None, int | None]:
    """Return the path as rows, and the rows before which the stop and the end of the overcut lie.

    None where there is none.
    """
    contour = cut.path
    s = seg.of_rows(contour.starts, contour.ends)
    total = float(s.length.sum())
    stop = max(total - cut.stop_um, 0.0) if cut.stop_um > 0 else None
    over = min(cut.overcut_um, total) if cut.overcut_um > 0 and contour.closed else None
    marks = sorted(m for m in (stop, over) if m is not None)
    ends_at = np.cumsum(s.length)
    begin_at = ends_at - s.length
    rows = Rows(Role.CONTOUR, [], [], [], [], [], [], [])
    v = contour.vertices
    vx, vy, source = v["x"], v["y"], v["source"]
    n = len(s)
    first = here = layout.vertex(vx[0], vy[0], pinned=True)
    stop_row: int | None = None
    over_row: int | None = None
    for k in range(n):
        low, high = float(begin_at[k]), float(ends_at[k])
        for mark in marks:
            if low + 0.5 < mark < high - 0.5:
                there = layout.vertex(*_at(s, begin_at, mark))
                _append(rows, here, there, s, k, int(source[k]), base)
                here, low = there, mark
            if abs(low - mark) <= 0.5:
                if mark == stop and stop_row is None:
                    stop_row = len(rows.v0)
                if mark == over and over_row is None:
                    over_row = len(rows.v0)
        if contour.closed and k == n - 1:
            there = first
        else:
            there = layout.vertex(vx[k + 1], vy[k + 1], pinned=k == n - 1)
        _append(rows, here, there, s, k, int(source[k]), base)
        here = there
    if stop is not None and stop_row is None:
        stop_row = len(rows.v0)
    if over is not None and over_row is None:
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

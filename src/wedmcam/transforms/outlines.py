"""From a plan to the outlines that a controller with G41 and G42 is given, on its grid.

The wire path of the plan is what the controller shall make; what is written is the part beside it.
The outline starts at the foot of the path's start; side and offset are those of the path. Whether
the controller's path is the plan's is for the judge; what is checked here is what handbooks ask of
leads, so that the machine does not stop with an alarm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Span, error
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import TAU, Floats, Ints, Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan, Side
from wedmcam.ir.program import BLOCK, Kind, Program, Role
from wedmcam.ir.programmed import PROGRAMMED, Programmed
from wedmcam.transforms import leads
from wedmcam.transforms.leads import Lane, Led
from wedmcam.transforms.lower.repair import best_chain

#: A foot this near to a vertex is the vertex; um.
VERTEX_UM = 0.5
#: Joints that tear by less than this when their segments are offset are tangent; um.
TORN_UM = 0.25
#: How far the start of a path may be from the offset of its outline; um.
BESIDE_UM = 0.05
#: An outline starts at least this far from a corner, or in the middle of what is shorter; um.
FROM_CORNER_UM = 300.0
#: Arcs shorter than so many steps of the grid are lines.
SHORT = 8.0
#: Sagitta of the chords of an arc whose radius does not fit the format; um.
CHORD_SAG_UM = 0.3
#: A start may move so far along its segment to a place that is nearly on the grid, um.
SLIDE_UM = 60
#: A start is near enough to the grid when its segment passes it by this, um.
NEAR_UM = 0.02
#: Candidates of a vertex, the nearest place of the grid first, in steps of it.
NINE = np.array([(0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)])
#: A stray into the part counts so much more than one away from it: 1.6 um and 2.0 are allowed.
INTO_PART = 1.25
#: Arcs whose candidates are looked at together: so much memory.
AT_ONCE = 500
#: A circle is written so much too far from the part, in steps of the grid: its centre may be off on
#: all sides, and 2.0 um are allowed beside the part, 1.6 in it.
CIRCLE_UM = 0.2
#: A pause may stand so far from where it was asked for, um; the judge allows 5.
PAUSE_UM = 3.0
#: What a pair of candidates costs more that turned out badly.
BANNED = 10.0
#: Centres that are tried beside the nearest on the grid.
AROUND = np.array([(i, j) for i in range(-3, 4) for j in range(-3, 4)])

Blocks = NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Grid:
    """What the format can state.

    Attributes:
        step_um: between two numbers.
        line_um: largest component of a line. arc_um: largest radius.
    """

    step_um: float = 1.0
    line_um: int = 999_999
    arc_um: int = 999_999

    def put(self, values: Floats) -> Floats:
        """Return the nearest numbers of the grid, halves away from zero, um.

        >>> Grid(0.1).put(np.array([0.26, -1.25])).tolist()
        [0.3, -1.3]
        """
        v = np.asarray(values, np.float64) / self.step_um
        per = round(1.0 / self.step_um)
        whole = np.sign(v) * np.floor(np.abs(v) + 0.5 + 1e-7)
        return np.asarray(whole / per)


@dataclass(frozen=True, slots=True, eq=False)
class Written:
    """Outlines as a writer takes them.

    Attributes:
        programmed: blocks in order; those of cuts without an offset as they were lowered.
        ends: where each block ends as it is programmed, um, shape (blocks, 2).
        chosen: for each motion what was chosen for it: number of the cut, row of the outline's
            segment, candidates of its start and end; -1 for leads.
    """

    programmed: Programmed
    ends: Floats
    chosen: Ints


def numbers(plan: Plan, first: int) -> dict[int, float]:
    """Return D number -> offset, um: one for each offset of the plan, from ``first`` on."""
    offsets = list(dict.fromkeys(o for o in (offset_of(plan, c) for c in plan.cuts) if o > 0))
    return {first + k: offset for k, offset in enumerate(offsets)}


def offset_of(plan: Plan, cut: Cut) -> float:
    """Return how far a path runs beside its outline, um: every vertex of it does."""
    known = {0.0, *(kind.offset_um for kind in plan.kinds if kind.side is not Side.ON)}
    if cut.outline is None:
        return max(known)
    s = seg.of_rows(cut.outline.starts, cut.outline.ends)
    n = len(s)
    x, y = (np.full(n, float(cut.path.vertices[k][0])) for k in ("x", "y"))
    away = float(seg.distances(s, x, y).min())
    near = min(known, key=lambda k: abs(k - away))
    return near if abs(near - away) <= 2 * BESIDE_UM else round(away, 1)


# --- where outlines start ------------------------------------------------------------------------


def started(plan: Plan, grid: Grid) -> tuple[Plan | None, list[Diagnostic]]:
    """Return the plan with every closed path starting beside a segment, not round a corner.

    A controller puts the wire on the normal of the first block, and takes it off on that of the
    last: both are one place only inside a segment, or where two are tangent. They are one micron
    only where the segment passes a place of the grid, so the start moves along to such a place.
    """
    moved = [_restarted(cut, offset_of(plan, cut), grid) for cut in plan.cuts]
    if all(a is b for a, b in zip(moved, plan.cuts, strict=True)):
        return plan, []
    lanes = [
        Lane(c.path, c.outline or c.path, None, offset_of(plan, c), k) for k, c in enumerate(moved)
    ]
    led = [Led(c.path, c.thread) for c in moved]
    found = leads.collisions(lanes, led)
    new = dict(zip(map(id, plan.cuts), moved, strict=True))
    parts = tuple(replace(p, cuts=tuple(new[id(c)] for c in p.cuts)) for p in plan.parts)
    return (None if found else replace(plan, cuts=tuple(moved), parts=parts)), found


def _restarted(cut: Cut, offset: float, grid: Grid) -> Cut:
    if not offset or cut.outline is None or not cut.path.closed or not cut.outline.closed:
        return cut
    drawn = seg.of_rows(cut.outline.starts, cut.outline.ends)
    v = cut.path.vertices
    s = seg.of_rows(cut.path.starts, cut.path.ends)
    n = len(s)
    foot = _foot(drawn, float(v["x"][0]), float(v["y"][0]), offset, True)
    if foot is not None:
        return _slid(cut, s, drawn, foot, offset, grid)
    x, y = (np.full(n, float(c)) for c in cut.thread)
    margin = np.minimum(0.5 * s.length, FROM_CORNER_UM)
    at = np.clip(seg.position_of(s, x, y), margin, s.length - margin)
    px, py = seg.points_at(s, at)
    for k in np.lexsort((px, py, np.round(np.hypot(px - x, py - y), 3))).tolist():
        foot = _foot(drawn, float(px[k]), float(py[k]), offset, True)
        if foot is not None:
            path = leads.rotated(cut.path, s, k, float(at[k]))
            again = seg.of_rows(path.starts, path.ends)
            return _slid(replace(cut, path=path), again, drawn, foot, offset, grid)
    return cut


def _slid(cut: Cut, s: Segments, drawn: Segments, foot: _Foot, offset: float, grid: Grid) -> Cut:
    """Return a cut whose outline starts on, or nearly on, a place of the grid, far from corners."""
    one = drawn.take(np.array([foot.row]))
    length = float(one.length[0])
    round_ = len(drawn) == 1 and one.turn[0] != 0
    margin = 0.0 if round_ else min(FROM_CORNER_UM, 0.5 * length)
    base = float(np.clip(foot.at, margin, length - margin))
    away = np.arange(int(min(SLIDE_UM, 0.25 * length) / grid.step_um) + 1) * grid.step_um
    at = base + np.stack([away, -away], axis=1).ravel()
    at = np.mod(at, length) if round_ else at[(at > VERTEX_UM) & (at < length - VERTEX_UM)]
    if not len(at):
        return cut
    many = drawn.take(np.full(len(at), foot.row))
    x, y = seg.points_at(many, at)
    off = seg.distances(many, grid.put(x), grid.put(y))
    # On which side the wire runs is seen at the place beside which the path starts now.
    ox, oy = seg.tangents_at(one, np.array([foot.at]))
    v = cut.path.vertices
    side = np.sign(ox[0] * (v["y"][0] - foot.y) - oy[0] * (v["x"][0] - foot.x))
    if round_:  # of a circle the radius counts, from where its centre comes to lie
        centre = grid.put(np.array([one.cx[0], one.cy[0]]))
        sx, sy = grid.put(x) - centre[0], grid.put(y) - centre[1]
        reach = np.hypot(sx, sy)
        away = -float(one.turn[0]) * side  # a wire to the left of a left turn is inside
        # What counts is how far the wire is from it, on the micron on which the path starts.
        wire = (reach + away * offset) / reach
        gx, gy = to_grid(centre[0] + sx * wire), to_grid(centre[1] + sy * wire)
        wanted = one.radius[0] + away * (offset + CIRCLE_UM * grid.step_um)
        off = np.abs(np.hypot(gx - centre[0], gy - centre[1]) - wanted)
        off += 0.3 * np.maximum(np.abs(reach - one.radius[0]) - 0.3, 0.0)
    good = np.flatnonzero(off <= (0.1 if round_ else NEAR_UM))
    best = int(good[0]) if len(good) else int(np.argmin(off))
    if at[best] == foot.at:
        return cut
    tx, ty = (float(c[best]) for c in seg.tangents_at(many, at))
    wx, wy = float(x[best] - side * offset * ty), float(y[best] + side * offset * tx)
    n = len(s)
    px, py = np.full(n, wx), np.full(n, wy)
    there = seg.position_of(s, px, py)
    if n == 1:
        there %= s.length
    ux, uy = seg.tangents_at(s, there)
    fits = (seg.distances(s, px, py) <= BESIDE_UM) & (there > 0) & (there < s.length)
    rows = np.flatnonzero(fits & (ux * tx + uy * ty > 0.9))
    if not len(rows):
        return cut
    return replace(cut, path=_split_at(cut.path, s, int(rows[0]), float(there[rows[0]])))


def _split_at(path: Contour, s: Segments, row: int, at: float) -> Contour:
    """Return a closed path from a place inside of one of its segments on."""
    px, py = seg.points_at(s.take(np.array([row])), np.array([at]))
    v = path.vertices
    n = len(v)
    if n == 1:
        rows = v.copy()
        rows["x"], rows["y"] = px, py
        return Contour(rows, True, path.sources)
    rows = np.roll(v, -row)
    rows = np.concatenate([rows, rows[:1]])
    rows["x"][0], rows["y"][0] = px[0], py[0]
    return Contour(rows, True, path.sources)


@dataclass(frozen=True, slots=True)
class _Foot:
    """A place of the outline: row, arc length on it, and the point, um."""

    row: int
    at: float
    x: float
    y: float


def _foot(s: Segments, x: float, y: float, offset: float, closed: bool) -> _Foot | None:
    """Return the place of an outline that a path at (x, y) runs beside; None at a corner."""
    n = len(s)
    px, py = np.full(n, x), np.full(n, y)
    d = seg.distances(s, px, py)
    row = int(np.argmin(d))
    if abs(float(d[row]) - offset) > BESIDE_UM:
        return None
    at = float(np.clip(seg.position_of(s, px, py)[row], 0.0, s.length[row]))
    length = float(s.length[row])
    if n > 1 and min(at, length - at) <= min(VERTEX_UM, 0.25 * length):
        row = row if at <= 0.5 * length else (row + 1) % n
        at = 0.0
        if not closed and row == 0:
            return None
        before = (row - 1) % n
        ax, ay = (float(c[before]) for c in seg.end_tangents(s))
        bx, by = (float(c[row]) for c in seg.start_tangents(s))
        if abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by)) * offset > TORN_UM:
            return None
    qx, qy = seg.points_at(s.take(np.array([row])), np.array([at]))
    return _Foot(row, at, float(qx[0]), float(qy[0]))


def _from(outline: Contour, s: Segments, foot: _Foot) -> Contour:
    """Return a closed outline as an open one that starts and ends at a place of it."""
    v = outline.vertices
    rows = np.roll(v, -foot.row)
    if foot.at > 0 and len(v) > 1:
        rows = np.concatenate([rows, rows[:1]])  # the first segment is parted
    rows = np.concatenate([rows, rows[:1]])
    rows["x"][[0, -1]], rows["y"][[0, -1]] = foot.x, foot.y
    rows["turn"][-1] = 0
    return Contour(rows, False, outline.sources)


# --- what is written -----------------------------------------------------------------------------


def written(
    plan: Plan,
    lowered: Program,
    places: Ints,
    grid: Grid,
    table: dict[int, float],
    not_again: Sequence[tuple[int, int, int, int]] = (),
) -> tuple[Written | None, list[Diagnostic]]:
    """Return the outlines of a plan on the grid, in cutting order, with the moves between them.

    Args:
        plan: whose paths start where `started` put them.
        lowered: the same as stepped blocks; cuts without an offset are taken from there.
        places: where its blocks end, um, shape (blocks, 2).
        grid: of the format.
        table: D numbers.
        not_again: rows of ``Written.chosen`` that turned out badly.
    """
    number = {offset: d for d, offset in table.items()}
    found: list[Diagnostic] = []
    out = _Out()
    for k, cut in enumerate(plan.cuts):
        if k:
            out.control(Kind.PAUSE)
            before = plan.cuts[k - 1]
            if not before.path.closed or before.thread != cut.thread:
                out.move(*cut.thread)
                out.control(Kind.PAUSE)
        offset = offset_of(plan, cut)
        if not offset:
            mine = np.flatnonzero(lowered.blocks["cut"] == k + 1)
            for i in range(int(mine[0]), int(mine[-1]) + 1):
                out.block(lowered.blocks[i], places[i])
            continue
        bans = [row[1:] for row in not_again if row[0] == k]
        made, more = _outline(cut, offset, number[offset], k, grid, bans)
        found += more
        if made is not None:
            for part, chosen, pause in made:
                out.motions(part, chosen)
                if pause:
                    out.control(Kind.PAUSE)
    out.control(Kind.STOP)
    return (None if found else out.done(plan.cuts[0].thread)), found


class _Out:
    """Blocks in the making."""

    def __init__(self) -> None:
        self.blocks: list[Blocks] = []
        self.mark: list[int] = []
        self.runs: list[Blocks] = []
        self.chosen: list[Ints] = []
        self.ends: list[tuple[float, float]] = []
        self.count = 0

    def _add(self, block: Blocks, end: tuple[float, float], mark: int = -1) -> None:
        self.blocks.append(block)
        self.ends.append(end)
        self.mark.append(mark)

    def control(self, kind: Kind) -> None:
        block = np.zeros(1, BLOCK)
        block["kind"], block["source"] = kind, -1
        self._add(block, self.ends[-1] if self.ends else (0.0, 0.0))

    def move(self, x: int, y: int) -> None:
        block = np.zeros(1, BLOCK)
        block["kind"], block["source"] = Kind.MOVE, -1
        self._add(block, (float(x), float(y)))

    def block(self, row: np.void, end: Ints) -> None:
        self._add(np.array([row], BLOCK), (float(end[0]), float(end[1])))

    def motions(self, rows: Blocks, chosen: Ints) -> None:
        for row in rows:
            block = np.zeros(1, BLOCK)
            block["kind"] = Kind.ARC if row["turn"] else Kind.LINE
            self._add(block, (float(row["x1"]), float(row["y1"])), self.count)
            self.count += 1
        self.runs.append(rows)
        self.chosen.append(chosen)

    def done(self, origin: tuple[int, int]) -> Written:
        motions = np.concatenate(self.runs) if self.runs else np.zeros(0, PROGRAMMED)
        program = Program(np.concatenate(self.blocks), origin)
        mark = np.array(self.mark, np.int64)
        ends = np.array(self.ends).reshape(-1, 2)
        chosen = np.concatenate(self.chosen) if self.chosen else np.zeros((0, 4), np.int64)
        return Written(Programmed(program, mark, motions), ends, chosen)


def _refused(cut: Cut, code: str, what: str, hint: str) -> list[Diagnostic]:
    x, y = cut.thread[0] / 1000, cut.thread[1] / 1000
    text = f"the contour that is threaded at ({x:.3f}, {y:.3f}) mm: {what}"
    return [error(code, text, _span(cut), points_mm=((x, y),), hint=hint)]


def _span(cut: Cut) -> Span | None:
    return cut.path.source_of(0)


def _outline(
    cut: Cut, offset: float, d: int, run: int, grid: Grid, bans: Sequence[tuple[int, ...]]
) -> tuple[list[tuple[Blocks, Ints, bool]] | None, list[Diagnostic]]:
    """Return the motions of a cut as (motions, chosen, pause behind them), with leads."""
    outline = cut.outline
    if outline is None or outline.closed != cut.path.closed:
        return None, _refused(
            cut,
            "compensation-lost",
            "the wire path is only a part of its outline, which the controller cannot offset",
            "a profile that does not leave the offset to the controller",
        )
    v = cut.path.vertices
    wx, wy = float(v["x"][0]), float(v["y"][0])
    if outline.closed:
        s = seg.of_rows(outline.starts, outline.ends)
        foot = _foot(s, wx, wy, offset, True)
        if foot is None:
            return None, _refused(
                cut,
                "compensation-lead",
                "the wire path starts on the arc round a corner, where the first and the last "
                "block of the outline have no common normal",
                "another thread point (--start), beside a line or an arc of the outline",
            )
        outline = _from(outline, s, foot)
    else:
        ends = [np.hypot(outline.vertices[k]["x"] - wx, outline.vertices[k]["y"] - wy)
                for k in (0, -1)]  # fmt: skip
        outline = outline if ends[0] <= ends[1] else outline.reversed()
    s = seg.of_rows(outline.starts, outline.ends)
    tx, ty = (float(c[0]) for c in seg.start_tangents(s))
    side = 1.0 if tx * (wy - s.y0[0]) - ty * (wx - s.x0[0]) > 0 else -1.0
    rows, chosen = _gridded(outline, s, grid, side * offset, cut.path, bans)
    chosen = np.column_stack([np.full(len(rows), run), chosen])
    rows["shift"], rows["d"], rows["run"] = side * offset, d, run
    found = _lead(cut, rows, side * offset)
    if found:
        return None, found
    first, last = np.zeros(1, PROGRAMMED), np.zeros(1, PROGRAMMED)
    for lead, role in ((first, Role.LEAD_IN), (last, Role.LEAD_OUT)):
        lead["role"], lead["d"], lead["run"] = role, d, run
    first["shift"] = side * offset
    first["x0"], first["y0"] = cut.thread
    first["x1"], first["y1"] = rows["x0"][0], rows["y0"][0]
    last["x0"], last["y0"] = rows["x1"][-1], rows["y1"][-1]
    last["x1"], last["y1"] = cut.thread
    pause, more = _paused(cut, s, rows, chosen, offset, grid)
    if pause is None:
        return None, more
    rows, chosen, at = pause
    nobody = np.full((1, 4), -1)
    lead_out = [(last, nobody, False)] if cut.path.closed else []
    return [
        (first, nobody, at == 0),
        (rows[:at], chosen[:at], 0 < at < len(rows)),
        (rows[at:], chosen[at:], False),
        *lead_out,
    ], []


def _lead(cut: Cut, rows: Blocks, shift: float) -> list[Diagnostic]:
    """Return what is wrong with the way from the thread point to the outline."""
    x, y = cut.thread
    sx, sy = float(rows["x0"][0]), float(rows["y0"][0])
    tx, ty = _heading(rows[0])
    length = float(np.hypot(sx - x, sy - y))
    place = f"({sx / 1000:.3f}, {sy / 1000:.3f}) mm"
    if length < abs(shift):
        return _refused(
            cut,
            "compensation-lead",
            f"its lead to the outline at {place} is {length / 1000:.3f} mm long, shorter than the "
            f"offset of {abs(shift) / 1000:.3f} mm",
            "a thread point farther away (--start), or a longer --lead",
        )
    left = tx * (y - sy) - ty * (x - sx)
    # From below the height of the wire the lead would cut into what is kept beside the start.
    if left * np.sign(shift) < abs(shift) - 1.0 and cut.path.closed:
        return _refused(
            cut,
            "compensation-lead",
            f"its lead arrives at {place} from below the wire path: the wire would enter the part "
            "beside the start",
            "a thread point farther away from the contour, over the place where it starts",
        )
    return []


def _heading(row: np.void) -> tuple[float, float]:
    if row["turn"]:
        t = float(row["turn"])
        dx, dy = -t * (row["y0"] - row["cy"]), t * (row["x0"] - row["cx"])
    else:
        dx, dy = row["x1"] - row["x0"], row["y1"] - row["y0"]
    size = float(np.hypot(dx, dy)) or 1.0
    return float(dx) / size, float(dy) / size


def _paused(
    cut: Cut, s: Segments, rows: Blocks, chosen: Ints, offset: float, grid: Grid
) -> tuple[tuple[Blocks, Ints, int] | None, list[Diagnostic]]:
    """Return motions, parted where the machine is to pause (--stop), and how many come before."""
    if not cut.stop_um:
        return (rows, chosen, len(rows)), []
    p = seg.of_rows(cut.path.starts, cut.path.ends)
    at = np.cumsum(p.length)
    where = float(at[-1]) - cut.stop_um
    k = int(np.searchsorted(at, where, "right"))
    x, y = (
        float(c[0])
        for c in seg.points_at(p.take(np.array([k])), np.array([where - at[k] + p.length[k]]))
    )
    foot = _foot(s, x, y, offset, False)
    if foot is None:
        return None, _refused(
            cut,
            "compensation-place",
            f"the pause of --stop at ({x / 1000:.3f}, {y / 1000:.3f}) mm is on the arc round a "
            "corner, inside of which the controller has no block",
            "another length of --stop",
        )
    # Of the places around one that its segment passes as nearly as can be.
    one = s.take(np.array([foot.row]))
    tried = foot.at + np.array(sorted(np.arange(-PAUSE_UM, PAUSE_UM + 0.1), key=abs))
    tried = np.clip(tried, 0.0, float(one.length[0]))
    many = s.take(np.full(len(tried), foot.row))
    gx, gy = (grid.put(c) for c in seg.points_at(many, tried))
    off = seg.distances(many, gx, gy)
    best = int(np.argmin(np.round(off, 2)))
    fx, fy = float(gx[best]), float(gy[best])
    n = _nearest(rows, fx, fy)
    if (fx, fy) == (float(rows["x0"][n]), float(rows["y0"][n])):
        return (rows, chosen, n), []
    if (fx, fy) != (float(rows["x1"][n]), float(rows["y1"][n])):
        rows, chosen = np.insert(rows, n, rows[n]), np.insert(chosen, n, chosen[n], axis=0)
        rows["x1"][n], rows["y1"][n] = fx, fy
        rows["x0"][n + 1], rows["y0"][n + 1] = fx, fy
    return (rows, chosen, n + 1), []


def _nearest(rows: Blocks, x: float, y: float) -> int:
    s = _segments(rows)
    n = len(rows)
    return int(np.argmin(seg.distances(s, np.full(n, x), np.full(n, y))))


def _segments(rows: Blocks) -> Segments:
    x0, y0, x1, y1, cx, cy = (
        rows[k].astype(np.float64) for k in ("x0", "y0", "x1", "y1", "cx", "cy")
    )
    return seg.make(x0, y0, x1, y1, cx, cy, rows["turn"].astype(np.int8))


# --- onto the grid -------------------------------------------------------------------------------


def _gridded(
    outline: Contour,
    s: Segments,
    grid: Grid,
    shift: float,
    path: Contour,
    bans: Sequence[tuple[int, ...]],
) -> tuple[Blocks, Ints]:
    """Return an open outline as motions whose numbers are on the grid, and what was chosen.

    Arcs take the centre of the grid with which start, middle and end are nearest to the true arc,
    start and end being as far from it as each other; arcs of a few steps become lines.

    Returns:
        Motions, and for each the row of its segment and the candidates of start and end.
    """
    pieces = _pieces(s, grid)
    of = np.repeat(np.arange(len(s)), pieces)
    part = np.arange(len(of)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    length = s.length[of]
    x, y = seg.points_at(s.take(of), length * part / pieces[of])
    # Vertices of the drawing as they are, not as an arc computes them.
    first = np.flatnonzero(part == 0)
    x[first], y[first] = s.x0[of[first]], s.y0[of[first]]
    x, y = np.append(x, s.x1[-1]), np.append(y, s.y1[-1])
    gx, gy = grid.put(x), grid.put(y)
    corner = np.append(first, len(of))
    gx[corner], gy[corner], choice = _vertices(x[corner], y[corner], s, grid, shift, path, bans)
    turn = s.turn[of].astype(np.int64)
    turn[s.radius[of] > grid.arc_um - 2] = 0
    still = (gx[1:] == gx[:-1]) & (gy[1:] == gy[:-1])
    whole = still & (turn != 0) & (length / pieces[of] > 4.0 * s.radius[of])
    turn[(length / pieces[of] < SHORT * grid.step_um) & ~whole] = 0
    keep = np.flatnonzero(~still | whole)
    rows = np.zeros(len(keep), PROGRAMMED)
    rows["role"] = Role.CONTOUR
    rows["turn"] = turn[keep]
    rows["x0"], rows["y0"] = gx[keep], gy[keep]
    after = np.append(keep[1:], len(of))
    rows["x1"], rows["y1"] = gx[after], gy[after]
    arc = np.flatnonzero(rows["turn"] != 0)
    if len(arc):
        k = of[keep[arc]]
        rows["cx"][arc], rows["cy"][arc], _, _ = _centres(rows[arc], s, k, grid)
    row = of[keep]
    return rows, np.column_stack([row, choice[row], choice[row + 1]])


def _vertices(
    x: Floats,
    y: Floats,
    s: Segments,
    grid: Grid,
    shift: float,
    path: Contour,
    bans: Sequence[tuple[int, ...]],
) -> tuple[Floats, Floats, Ints]:
    """Return vertices of an open outline on the grid, and which candidate each is.

    Each vertex has nine candidates; of all chains through them the one is taken along which the
    wire, on the microns that the controller puts it, strays least, strays into the part counting
    more (``_strays``). Start and end of a closed outline were chosen before.

    Args:
        x, y: of the segments' starts, and of the last one's end.
        s: the segments.
        grid: of the format.
        shift: of the wire to the left, um.
        path: of the wire.
        bans: (row, candidate of its start, of its end) that are not to be taken.
    """
    (ax, ay), (bx, by) = _beside(x, y, s, shift, path)
    cx = grid.put(grid.put(x)[:, None] + NINE[:, 0] * grid.step_um)
    cy = grid.put(grid.put(y)[:, None] + NINE[:, 1] * grid.step_um)
    away = np.hypot(cx - x[:, None], cy - y[:, None])
    if x[0] == x[-1] and y[0] == y[-1]:
        away[[0, -1], 1:] = np.inf  # the first is the nearest
    dx, dy = cx - x[:, None], cy - y[:, None]
    # Where the controller's path then has its vertices: whole um.
    ends = [
        (to_grid(px[:, None] + dx) - px[:, None], to_grid(py[:, None] + dy) - py[:, None])
        for px, py in ((ax, ay), (bx, by))
    ]
    tables = _strays(s, cx, cy, ends, grid, shift)
    for row, a, b in bans:
        tables[row, a, b] += BANNED
    chain = best_chain(list(tables), [np.where(np.isfinite(a), 0.02 * a, np.inf) for a in away])
    assert chain is not None  # the nearest places are always there
    k, c = np.arange(len(x)), np.array(chain)
    return cx[k, c], cy[k, c], c


def _beside(
    x: Floats, y: Floats, s: Segments, shift: float, path: Contour
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return the path's vertices before and after each vertex of the outline, um.

    On the normal of the segment before, and on that of the one after; at an inner corner both are
    the vertex of the path nearest to these.
    """
    sx, sy = seg.start_tangents(s)
    ex, ey = seg.end_tangents(s)
    ax, ay, bx, by = x.copy(), y.copy(), x.copy(), y.copy()
    ax[1:], ay[1:] = x[1:] - shift * ey, y[1:] + shift * ex
    bx[:-1], by[:-1] = x[:-1] - shift * sy, y[:-1] + shift * sx
    ax[0], ay[0], bx[-1], by[-1] = bx[0], by[0], ax[-1], ay[-1]
    cross = (ex[:-1] * sy[1:] - ey[:-1] * sx[1:]) * np.sign(shift)
    v = path.vertices
    for k in (np.flatnonzero(cross > 1e-3) + 1).tolist():
        d = np.hypot(v["x"] - 0.5 * (ax[k] + bx[k]), v["y"] - 0.5 * (ay[k] + by[k]))
        near = int(np.argmin(d))
        ax[k] = bx[k] = v["x"][near]
        ay[k] = by[k] = v["y"][near]
    return (ax, ay), (bx, by)


def _strays(
    s: Segments,
    cx: Floats,
    cy: Floats,
    ends: list[tuple[Floats, Floats]],
    grid: Grid,
    shift: float,
) -> Floats:
    """Return what each pair of candidates costs each segment, shape (segments, 9, 9).

    Args:
        s: segments of the outline.
        cx, cy: candidates of its vertices, shape (segments + 1, 9), um.
        ends: how far the path's vertices before and after each vertex are off then, x and y.
        grid: of the format.
        shift: of the wire to the left, um.
    """
    side = np.sign(shift)

    def cost(off: Floats) -> Floats:  # off: away from the part
        return np.asarray(np.where(off < 0, INTO_PART * off, off) ** 4)

    (sx, sy), (ex, ey) = seg.start_tangents(s), seg.end_tangents(s)
    start = side * (sx[:, None] * ends[1][1][:-1] - sy[:, None] * ends[1][0][:-1])
    end = side * (ex[:, None] * ends[0][1][1:] - ey[:, None] * ends[0][0][1:])
    total = cost(start)[:, :, None] + cost(end)[:, None, :]
    arc = np.flatnonzero((s.turn != 0) & (s.radius <= grid.arc_um - 2))
    if not len(arc):
        return np.asarray(total**0.25)
    count = len(NINE)
    for low in range(0, len(arc), AT_ONCE):
        some = arc[low : low + AT_ONCE]
        shape = (len(some), count, count)
        rows = np.zeros(len(some) * count * count, PROGRAMMED)
        for name, values in (("x0", cx[some][:, :, None]), ("y0", cy[some][:, :, None])):
            rows[name] = np.broadcast_to(values, shape).ravel()
        for name, values in (("x1", cx[some + 1][:, None, :]), ("y1", cy[some + 1][:, None, :])):
            rows[name] = np.broadcast_to(values, shape).ravel()
        _, _, torn, middle = _centres(rows, s, np.repeat(some, count * count), grid)
        bulge = side * -s.turn[some][:, None, None] * middle.reshape(shape)
        total[some] += 2.0 * cost(bulge) + np.asarray(0.5 * torn.reshape(shape)) ** 4
    return np.asarray(total**0.25)


def _pieces(s: Segments, grid: Grid) -> Ints:
    """Return in how many motions a segment is written: what is too large for one is parted."""
    most = float(grid.line_um - 2)
    reach = np.maximum(np.abs(s.x1 - s.x0), np.abs(s.y1 - s.y0))
    pieces = np.where(s.turn == 0, np.ceil(reach / most), 1.0)
    large = np.flatnonzero((s.turn != 0) & (s.radius > grid.arc_um - 2))
    if len(large):
        step = 2.0 * np.arccos(1.0 - CHORD_SAG_UM / s.radius[large])
        pieces[large] = np.ceil(s.sweep[large] / step)
    return np.maximum(pieces, 1.0).astype(np.int64)


def _centres(
    rows: Blocks, s: Segments, k: Ints, grid: Grid
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return centres on the grid for arcs that were segments ``k``.

    Returns:
        x, y; by how much the end is farther from it than the start or nearer, and how far the
        middle of the arc is outside of the true one, um.
    """
    bx, by = grid.put(s.cx[k]), grid.put(s.cy[k])
    x0, y0, x1, y1 = (rows[n] for n in ("x0", "y0", "x1", "y1"))
    dx, dy = x1 - x0, y1 - y0
    chord = dx * dx + dy * dy
    safe = np.where(chord > 0, chord, 1.0)
    mx, my = seg.points_at(s.take(k), 0.5 * s.length[k])
    sweep, turn = s.sweep[k], s.turn[k]
    best = np.zeros((4, len(k)))
    best[0], best[1] = bx, by
    least = np.full(len(k), np.inf)
    for i, j in AROUND.tolist():
        cx, cy = grid.put(bx + i * grid.step_um), grid.put(by + j * grid.step_um)
        torn = np.abs(np.hypot(x0 - cx, y0 - cy) - np.hypot(x1 - cx, y1 - cy))
        # The controller's centre: as far from the end as from the start.
        along = ((cx - 0.5 * (x0 + x1)) * dx + (cy - 0.5 * (y0 + y1)) * dy) / safe
        qx, qy = np.where(chord > 0, cx - along * dx, cx), np.where(chord > 0, cy - along * dy, cy)
        middle = np.hypot(x0 - qx, y0 - qy) - np.hypot(mx - qx, my - qy)
        off = np.hypot(cx - s.cx[k], cy - s.cy[k])
        cost = 0.5 * torn + np.abs(middle) + 0.05 * off
        reach = np.hypot(x0 - cx, y0 - cy)
        cost = np.where(chord > 0, cost, np.abs(reach - s.radius[k]) + off)
        turned = np.arctan2(y1 - cy, x1 - cx) - np.arctan2(y0 - cy, x0 - cx)
        turned = np.where(chord > 0, np.mod(turn * turned, TAU), TAU)
        cost = np.where(np.abs(turned - sweep) < 1.0, cost, np.inf)
        better = cost < least
        least = np.where(better, cost, least)
        best = np.where(better, np.stack([cx, cy, torn, middle]), best)
    return best[0], best[1], best[2], best[3]


__all__ = ["Grid", "Written", "numbers", "offset_of", "started", "written"]

"""From a plan to the outlines that a controller with G41 and G42 is given, on its grid.

The wire path of the plan is what the controller shall make; what is written is the part beside it.
The outline starts at the foot of the path's start; side and offset are those of the path. Whether
the controller's path is the plan's is for the judge; what is checked here is what handbooks ask of
leads, so that the machine does not stop with an alarm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place
from wedmcam.geom import segments as seg
from wedmcam.geom.segments import Floats, Ints, Segments
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import BLOCK, Kind, Program, Role
from wedmcam.ir.programmed import PROGRAMMED, Programmed
from wedmcam.transforms.outlines.grid import Grid, put_on_grid
from wedmcam.transforms.outlines.refusals import refusal
from wedmcam.transforms.outlines.starts import foot_of, open_at, start_beside

#: A pause may stand so far from where it was asked for, um; the judge allows 5.
PAUSE_UM = 3.0

Blocks = NDArray[np.void]


@dataclass(frozen=True, slots=True, eq=False)
class Outlines:
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
    offsets = list(dict.fromkeys(c.offset_um for c in plan.cuts if c.offset_um > 0))
    return {first + k: offset for k, offset in enumerate(offsets)}


def write_outlines(
    plan: Plan,
    lowered: Program,
    places: Ints,
    grid: Grid,
    table: dict[int, float],
    bans: Sequence[tuple[int, int, int, int]] = (),
) -> tuple[Outlines | None, list[Diagnostic]]:
    """Return the outlines of a plan on the grid, in cutting order, with the moves between them.

    Args:
        plan: whose paths start where `start_beside` put them.
        lowered: the same as stepped blocks; cuts without an offset are taken from there.
        places: where its blocks end, um, shape (blocks, 2).
        grid: of the format.
        table: D numbers.
        bans: rows of ``Outlines.chosen`` that turned out badly.
    """
    number = {offset: d for d, offset in table.items()}
    findings: list[Diagnostic] = []
    out = _Builder()
    for k, cut in enumerate(plan.cuts):
        if k:
            out.control(Kind.PAUSE)
            before = plan.cuts[k - 1]
            if not before.path.closed or before.thread != cut.thread:
                out.move(*cut.thread)
                out.control(Kind.PAUSE)
        offset = cut.offset_um
        if not offset:
            mine = np.flatnonzero(lowered.blocks["cut"] == k + 1)
            for i in range(int(mine[0]), int(mine[-1]) + 1):
                out.block(lowered.blocks[i], places[i])
            continue
        own = [row[1:] for row in bans if row[0] == k]
        parts, more = _outline(cut, offset, number[offset], k, grid, own)
        findings += more
        if parts is not None:
            for part, chosen, pause in parts:
                out.motions(part, chosen)
                if pause:
                    out.control(Kind.PAUSE)
    out.control(Kind.STOP)
    return (None if findings else out.outlines(plan.cuts[0].thread)), findings


class _Builder:
    """Collects blocks, and the motions that they stand for."""

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

    def outlines(self, origin: tuple[int, int]) -> Outlines:
        motions = np.concatenate(self.runs) if self.runs else np.zeros(0, PROGRAMMED)
        program = Program(np.concatenate(self.blocks), origin)
        mark = np.array(self.mark, np.int64)
        ends = np.array(self.ends).reshape(-1, 2)
        chosen = np.concatenate(self.chosen) if self.chosen else np.zeros((0, 4), np.int64)
        return Outlines(Programmed(program, mark, motions), ends, chosen)


def _outline(
    cut: Cut, offset: float, d: int, run: int, grid: Grid, bans: Sequence[tuple[int, ...]]
) -> tuple[list[tuple[Blocks, Ints, bool]] | None, list[Diagnostic]]:
    """Return the motions of a cut as (motions, chosen, pause behind them), with leads."""
    outline = cut.outline
    if outline is None or outline.closed != cut.path.closed:
        fault = refusal(
            cut, "compensation-lost", "a profile that does not leave the offset to the controller"
        ).extended(
            "the wire path is only a part of its outline, which the controller cannot offset"
        )
        return None, [fault]
    v = cut.path.vertices
    wx, wy = float(v["x"][0]), float(v["y"][0])
    if outline.closed:
        s = seg.of_rows(outline.starts, outline.ends)
        foot = foot_of(s, wx, wy, offset, True)
        if foot is None:
            fault = refusal(
                cut,
                "compensation-lead",
                "another thread point (--start), beside a line or an arc of the outline",
            ).extended(
                "the wire path starts on the arc round a corner, where the first and the last "
                "block of the outline have no common normal",
            )
            return None, [fault]
        outline = open_at(outline, s, foot)
    else:
        ends = [np.hypot(outline.vertices[k]["x"] - wx, outline.vertices[k]["y"] - wy)
                for k in (0, -1)]  # fmt: skip
        outline = outline if ends[0] <= ends[1] else outline.reversed()
    s = seg.of_rows(outline.starts, outline.ends)
    tx, ty = (float(c[0]) for c in seg.start_tangents(s))
    side = 1.0 if tx * (wy - s.y0[0]) - ty * (wx - s.x0[0]) > 0 else -1.0
    rows, chosen = put_on_grid(outline, s, grid, side * offset, cut.path, bans)
    chosen = np.column_stack([np.full(len(rows), run), chosen])
    rows["shift"], rows["d"], rows["run"] = side * offset, d, run
    errors = _lead_errors(cut, rows, side * offset)
    if errors:
        return None, errors
    first, last = np.zeros(1, PROGRAMMED), np.zeros(1, PROGRAMMED)
    for lead, role in ((first, Role.LEAD_IN), (last, Role.LEAD_OUT)):
        lead["role"], lead["d"], lead["run"] = role, d, run
    first["shift"] = side * offset
    first["x0"], first["y0"] = cut.thread
    first["x1"], first["y1"] = rows["x0"][0], rows["y0"][0]
    last["x0"], last["y0"] = rows["x1"][-1], rows["y1"][-1]
    last["x1"], last["y1"] = cut.thread
    pause, errors = _part_at_pause(cut, s, rows, chosen, offset, grid)
    if pause is None:
        return None, errors
    rows, chosen, at = pause
    no_choice = np.full((1, 4), -1)
    lead_out = [(last, no_choice, False)] if cut.path.closed else []
    return [
        (first, no_choice, at == 0),
        (rows[:at], chosen[:at], 0 < at < len(rows)),
        (rows[at:], chosen[at:], False),
        *lead_out,
    ], []


def _lead_errors(cut: Cut, rows: Blocks, shift: float) -> list[Diagnostic]:
    """Return what is wrong with the way from the thread point to the outline."""
    x, y = cut.thread
    sx, sy = float(rows["x0"][0]), float(rows["y0"][0])
    tx, ty = _heading(rows[0])
    length = float(np.hypot(sx - x, sy - y))
    if length < abs(shift):
        fault = refusal(
            cut, "compensation-lead", "a thread point farther away (--start), or a longer --lead"
        ).extended(
            "its lead to the outline at {start} is {lead_mm:.3f} mm long, shorter than the offset "
            "of {offset_mm:.3f} mm",
            start=Place.of_um(sx, sy),
            lead_mm=length / 1000,
            offset_mm=abs(shift) / 1000,
        )
        return [fault]
    left = tx * (y - sy) - ty * (x - sx)
    # From below the height of the wire the lead would cut into what is kept beside the start.
    if left * np.sign(shift) < abs(shift) - 1.0 and cut.path.closed:
        fault = refusal(
            cut,
            "compensation-lead",
            "a thread point farther away from the contour, over the place where it starts",
        ).extended(
            "its lead arrives at {start} from below the wire path: the wire would enter the part "
            "beside the start",
            start=Place.of_um(sx, sy),
        )
        return [fault]
    return []


def _heading(row: np.void) -> tuple[float, float]:
    if row["turn"]:
        t = float(row["turn"])
        dx, dy = -t * (row["y0"] - row["cy"]), t * (row["x0"] - row["cx"])
    else:
        dx, dy = row["x1"] - row["x0"], row["y1"] - row["y0"]
    size = float(np.hypot(dx, dy)) or 1.0
    return float(dx) / size, float(dy) / size


def _part_at_pause(
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
    foot = foot_of(s, x, y, offset, False)
    if foot is None:
        fault = refusal(cut, "compensation-place", "another length of --stop").extended(
            "the pause of --stop at {pause} is on the arc round a corner, and the controller has "
            "no block inside that arc",
            pause=Place.of_um(x, y),
        )
        return None, [fault]
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


__all__ = ["Grid", "Outlines", "numbers", "start_beside", "write_outlines"]

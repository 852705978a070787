"""A picture of what the machine will do, to be looked at and hung up beside it.

The wire path is drawn block by block from the program and the places where its blocks really end,
never from the plan: so the picture shows the program, mistakes and all. The plan adds the part.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity, Span
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan, Side
from wedmcam.ir.program import Axis, Kind, Program, Role
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.ir.understanding import Understanding
from wedmcam.programs.stretches import stretches
from wedmcam.reports.picture.sheet import INK, NO_CAPTION, Box, Caption, Sheet, number, union, words
from wedmcam.reports.picture.threads import TICK_EVERY, draw_threads, kept_ticks

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: In um: whole numbers where a step of the machine is.
Places = NDArray[np.int64] | NDArray[np.float64]

#: Up to so many cutting blocks have a path and a tool tip each; above, a cut is one path.
DETAILED = 4000
#: At most so many block numbers are printed.
LABELS = 150
#: The first block of each cut has its number, room or not, where there are no more cuts than this.
FORCED = 10
#: One direction arrow in so many sheet units of path.
ARROW_EVERY = 130.0
#: No arrow and no number on a shorter block, sheet units (unless it is the first of a cut).
SHORT_BLOCK = 9.0
#: Line width of the wire path, sheet units.
WIRE_WIDTH = 1.5

OUTLINE = "#52606d"
WIRE = "#c1121f"
LEAD = "#0b7a55"
OVERCUT = "#7b2cbf"
MOVE = "#2563a8"
KERF = "#f59e0b"
#: Colour of a block's line by its role; the order is that of drawing.
COLOURS = {
    Role.CONTOUR: WIRE,
    Role.OVERCUT: OVERCUT,
    Role.LEAD_IN: LEAD,
    Role.LEAD_OUT: LEAD,
}
MARKS = {Severity.ERROR: "#d00000", Severity.WARNING: "#d97706", Severity.NOTE: "#2563a8"}


# --- segments as SVG ---------------------------------------------------------------------------


class _Segments(NamedTuple):
    """Segments in mm, one entry each: ends, centre, signed sweep (0: a line)."""

    x0: Floats
    y0: Floats
    x1: Floats
    y1: Floats
    cx: Floats
    cy: Floats
    sweep: Floats

    def radius(self) -> Floats:
        """Return the distance of the starts from the centres."""
        return np.hypot(self.x0 - self.cx, self.y0 - self.cy)

    def lengths(self) -> Floats:
        """Return the lengths, mm."""
        straight = np.hypot(self.x1 - self.x0, self.y1 - self.y0)
        return np.where(self.sweep == 0, straight, self.radius() * np.abs(self.sweep))

    def middles(self) -> tuple[Floats, Floats, Floats]:
        """Return x, y and heading (radians) halfway along."""
        angle = np.arctan2(self.y0 - self.cy, self.x0 - self.cx) + self.sweep / 2
        r = self.radius()
        arc = self.sweep != 0
        x = np.where(arc, self.cx + r * np.cos(angle), (self.x0 + self.x1) / 2)
        y = np.where(arc, self.cy + r * np.sin(angle), (self.y0 + self.y1) / 2)
        straight = np.arctan2(self.y1 - self.y0, self.x1 - self.x0)
        heading = np.where(arc, angle + np.sign(self.sweep) * (math.pi / 2), straight)
        return x, y, heading

    def samples(self, spacing: float) -> tuple[Floats, Floats]:
        """Return x, y of points at most ``spacing`` mm apart."""
        count = np.maximum(np.ceil(self.lengths() / spacing), 1).astype(np.int64)
        of = np.repeat(np.arange(len(count)), count)
        part = (np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)) / count[of]
        angle = np.arctan2(self.y0 - self.cy, self.x0 - self.cx)[of] + part * self.sweep[of]
        arc, r = self.sweep[of] != 0, self.radius()[of]
        x = np.where(arc, self.cx[of] + r * np.cos(angle), self.x0[of])
        y = np.where(arc, self.cy[of] + r * np.sin(angle), self.y0[of])
        x += np.where(arc, 0.0, part * (self.x1 - self.x0)[of])
        y += np.where(arc, 0.0, part * (self.y1 - self.y0)[of])
        return x, y

    def box(self) -> Box:
        """Return the extents: exact for lines; arcs by their ends and apexes."""
        x, y = [self.x0, self.x1], [self.y0, self.y1]
        r = self.radius()
        first = np.arctan2(self.y0 - self.cy, self.x0 - self.cx)
        low, high = np.minimum(first, first + self.sweep), np.maximum(first, first + self.sweep)
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            apex = math.atan2(dy, dx)
            # The first one from the start on.
            after = apex + math.tau * np.ceil((low - apex) / math.tau)
            on = (self.sweep != 0) & (after <= high)
            x.append((self.cx + r * dx)[on])
            y.append((self.cy + r * dy)[on])
        xs, ys = np.concatenate(x), np.concatenate(y)
        return float(xs.min()), float(ys.min()), float(xs.max()), float(ys.max())

    def commands(self) -> list[str]:
        """Return for each segment the SVG commands that draw it from its start.

        An arc goes in pieces of at most 90 degrees: SVG finds the centre from the end points, and
        near 180 degrees a micron at the end would move it by a tenth of a mm.
        """
        ends = [f"{number(x)} {number(y)}" for x, y in zip(self.x1, self.y1, strict=True)]
        out = ["L" + end for end in ends]
        first = np.arctan2(self.y0 - self.cy, self.x0 - self.cx)
        radius = self.radius()
        for i in np.flatnonzero(self.sweep):
            r, sweep = float(radius[i]), float(self.sweep[i])
            text = f"A{number(r)} {number(r)} 0 0 {int(sweep > 0)} "
            pieces = max(1, math.ceil(abs(sweep) / (math.pi / 2) - 1e-6))
            path = ""
            for k in range(1, pieces):
                angle = float(first[i]) + sweep * k / pieces
                x = float(self.cx[i]) + r * math.cos(angle)
                y = float(self.cy[i]) + r * math.sin(angle)
                path += f"{text}{number(x)} {number(y)}"
            out[i] = path + text + ends[i]
        return out


def _of_contour(contour: Contour) -> _Segments:
    a, b = contour.starts, contour.ends
    turn = a["turn"].astype(float)
    turned = np.arctan2(b["y"] - a["cy"], b["x"] - a["cx"]) - np.arctan2(
        a["y"] - a["cy"], a["x"] - a["cx"]
    )
    sweep = np.mod(turned * turn, math.tau)
    full = (a["x"] == b["x"]) & (a["y"] == b["y"])
    sweep = np.where(turn == 0, 0.0, np.where(full, math.tau, sweep) * turn)
    x0, y0, x1, y1, cx, cy = (v / 1000 for v in (a["x"], a["y"], b["x"], b["y"], a["cx"], a["cy"]))
    return _Segments(x0, y0, x1, y1, cx, cy, sweep)


def _of_blocks(blocks: NDArray[np.void], starts: Places, ends: Places, step_um: float) -> _Segments:
    """Return blocks as segments; arcs about their own centre, to where they really end."""
    per_mm = 1000 / step_um
    if step_um != 1:
        starts, ends = starts / step_um, ends / step_um
    arc = (blocks["kind"] == Kind.ARC) & (blocks["turn"] != 0)
    turn = blocks["turn"].astype(float)
    centre = starts - np.column_stack([blocks["x"], blocks["y"]])
    to_end = ends - centre
    r = np.hypot(blocks["x"], blocks["y"])
    turned = np.arctan2(to_end[:, 1], to_end[:, 0]) - np.arctan2(blocks["y"], blocks["x"])
    sweep = np.mod(turned * turn, math.tau)
    # The ends tell the angle but for whole turns: an arc may end a little before or behind where
    # it starts, and go round again. A turn counts 4 R on an axis, and on the sides of the inscribed
    # square 4 R sqrt 2; within a turn the count is never half a turn off.
    square = (blocks["axis"] == Axis.SQUARE) | (blocks["axis"] == Axis.SQUARE_X)
    a_turn = np.where(square, math.sqrt(2), 1.0) * 4 * np.maximum(r, 1)
    sweep += math.tau * np.round(blocks["count"] / a_turn - sweep / math.tau)
    sweep = np.where(arc, np.maximum(sweep, 0.0) * turn, 0.0)
    (x0, y0), (x1, y1), (cx, cy) = (p.T / per_mm for p in (starts, ends, centre))
    return _Segments(x0, y0, x1, y1, cx, cy, sweep)


def _outline_path(contour: Contour) -> str:
    segments = _of_contour(contour)
    start = f"M{number(segments.x0[0])} {number(segments.y0[0])}"
    return start + "".join(segments.commands()) + ("Z" if contour.closed else "")


# --- the program -------------------------------------------------------------------------------


def plot(
    program: Program,
    starts: Places,
    ends: Places,
    *,
    plan: Plan | None = None,
    known: Understanding | None = None,
    caption: Caption = NO_CAPTION,
    marks: Sequence[Diagnostic] = (),
    kerf: bool = True,
) -> str:
    """Return an SVG picture of a program, with the part where there is a plan.

    Block numbers are 1-based positions in ``program.blocks``, control blocks counted; thread points
    have the number of their cut: the program's, else counted as they are cut. The frame is the
    drawing's: mm, y up. The same arguments give the same text.

    Args:
        program: as decoded from the emitted bytes.
        starts: where each block starts, shape (blocks, 2), um, drawing coordinates; for a control
            block where the machine stands.
        ends: where each block ends on the interpolator, likewise.
        plan: adds outlines, kept material and kerf.
        known: what was understood of the plan; adds it to the thread points.
        caption: what the title block says; offset and side of the plan are added.
        marks: findings whose ``points_mm`` are ringed.
        kerf: shade what the wire removes, 2 x offset wide.
    """
    blocks = program.blocks
    assert starts.shape == ends.shape == (len(blocks), 2)
    segments = _of_blocks(blocks, starts, ends, program.step_um)
    facts = dict(caption.facts)
    if plan is not None:
        facts.setdefault("offset", plan.offsets_text)
        facts.setdefault("side", str(plan.side))

    cuts = _cut_numbers(program, starts, ends)
    threads = _threads(program, starts, cuts)
    box = _extents(segments, plan, [place for place, _ in threads], marks)
    sheet = Sheet(box, caption.title, len(facts))
    legend: list[tuple[str, str]] = []
    part: Box | None = None
    if plan is not None and plan.outlines:
        part = union(_of_contour(c).box() for c in plan.outlines)
        sides = {s.keeps for s in plan.scenes}
        if sides >= {Side.PART, Side.DIE}:  # around a die all is kept, punches and all: not hatched
            held = [c for s in plan.scenes if s.keeps is Side.PART for c in s.outlines]
            legend += _part(sheet, held, Side.PART, box)
            more = _part(sheet, [c for c in plan.outlines if c not in held], None, box)
            more += _ticks(sheet, plan)
            there = {meaning for _, meaning in legend}
            legend += [entry for entry in more if entry[1] not in there]
        else:
            kept = plan.side if plan.side in (Side.PART, Side.DIE) else None
            legend += _part(sheet, plan.outlines, kept, box)
    wire = _Wire(program, segments, cuts)
    legend += wire.draw(sheet, 2 * plan.wire_um if plan is not None and kerf else 0.0)
    if part is None and len(wire.cutting):
        contour = wire.cutting[wire.role[wire.cutting] == Role.CONTOUR]
        part = _Segments(*(v[contour if len(contour) else wire.cutting] for v in segments)).box()
    if part is not None:
        sheet.dimension(part, box)
    wire.ink(sheet)
    rows = {} if known is None else {row.thread.at: row for row in known.rows}
    crosses = []
    for (x, y), name in threads:
        tip = f"thread point of cut {name} at ({x / 1000:.3f}, {y / 1000:.3f}) mm"
        if (row := rows.get((x, y))) is not None:
            tip += f"; {row.thread.origin}; {row.text.partition(': ')[2]}"
        crosses.append((x / 1000, y / 1000, f"T{name}", tip))
    legend += draw_threads(sheet, crosses, "START")
    legend += wire.pauses(sheet)
    wire.arrows(sheet)
    keeps = {} if plan is None else {c.thread: c.keeps_left for c in plan.cuts}
    wire.labels(sheet, {n: keeps.get(place) for place, n in threads})
    _mark(sheet, marks)
    description = f"Wire path of {len(wire.cutting)} cutting blocks, coordinates in mm"
    return sheet.print(description, facts, legend)


def _cut_numbers(program: Program, starts: Places, ends: Places) -> Ints:
    """Return the cut each block belongs to, in the order of cutting where the program has none.

    0 for a block of no cut.
    """
    blocks = program.blocks
    cut = blocks["cut"].astype(np.int64)
    if not cut.any():
        steps = (np.rint(p / program.step_um).astype(np.int64) for p in (starts, ends))
        for number_, one in enumerate(stretches(blocks, *steps), 1):
            for rows in (one.lead_in, one.path, one.overcut, one.lead_out):
                cut[rows] = number_
    return cut


def _threads(program: Program, starts: Places, cut: Ints) -> list[tuple[tuple[int, int], int]]:
    """Return where each cut starts, um, and its number; in the order of cutting."""
    blocks = program.blocks
    cutting = np.flatnonzero((blocks["kind"] == Kind.LINE) | (blocks["kind"] == Kind.ARC))
    _, first = np.unique(cut[cutting], return_index=True)
    places = [
        (int(cut[i]), round(starts[i, 0]), round(starts[i, 1])) for i in cutting[np.sort(first)]
    ]
    return [((x, y), number_) for number_, x, y in places]


def _extents(
    segments: _Segments,
    plan: Plan | None,
    points: Sequence[tuple[int, int]],
    marks: Sequence[Diagnostic],
) -> Box:
    boxes = [segments.box()] if len(segments.x0) else []
    if plan is not None:
        boxes += [_of_contour(c).box() for c in plan.outlines]
    boxes += [(x / 1000, y / 1000, x / 1000, y / 1000) for x, y in points]
    boxes += [(x, y, x, y) for d in marks for x, y in d.points_mm]
    return union(boxes) if boxes else (0.0, 0.0, 10.0, 10.0)


def _part(
    sheet: Sheet, outlines: Sequence[Contour], kept: Side | None, box: Box
) -> list[tuple[str, str]]:
    """Draw outlines, and the material that is kept, hatched."""
    legend: list[tuple[str, str]] = []
    lines = f'stroke="{OUTLINE}" stroke-width="{sheet.mm(1.0)}"'
    closed = "".join(_outline_path(c) for c in outlines if c.closed)
    opened = "".join(_outline_path(c) for c in outlines if not c.closed)
    if kept is not None:
        step = sheet.mm(7)
        sheet.define(
            f'<pattern id="kept" width="{step}" height="{step}" patternUnits="userSpaceOnUse" '
            f'patternTransform="rotate(45)"><rect width="{step}" height="{step}" fill="#e8eef4"/>'
            f'<path d="M0 0H{step}" stroke="#c5d0dc" stroke-width="{sheet.mm(1.4)}"/></pattern>'
        )
        around = ""
        if kept is Side.DIE:
            air = 22 / sheet.scale
            left, low = number(box[0] - air), number(box[1] - air)
            right, high = number(box[2] + air), number(box[3] + air)
            around = f"M{left} {low}H{right}V{high}H{left}Z"
        # One path is both hatched and outlined, unless the hatching has an edge that was not drawn.
        both = "" if around else f" {lines}"
        sheet.draw(
            f'<path id="kept-material" d="{around}{closed}" fill="url(#kept)" {_EVENODD}{both}/>'
        )
        legend.append(
            ('<rect y="0" width="28" height="12" fill="#dde5ee" stroke="#c5d0dc"/>', "kept")
        )
        closed = closed if around else ""
    if closed or opened:
        sheet.draw(f'<path id="outline" d="{closed}{opened}" {lines}/>')
    return [*legend, (_stroke(OUTLINE, 1.0), "as drawn")]


def _ticks(sheet: Sheet, plan: Plan) -> list[tuple[str, str]]:
    """Draw ticks on the kept side of outlines around which all is kept; return their legend."""
    places = []
    for scene in plan.scenes:
        if scene.keeps is not Side.DIE:
            continue
        for outline, depth in zip(scene.outlines, scene.depths, strict=True):
            if outline.closed:
                x, y = _of_contour(outline).samples(TICK_EVERY / 4 / sheet.scale)
                places.append((x, y, bool(depth % 2)))
    ticks = kept_ticks(places, sheet)
    line = f'stroke="{OUTLINE}" stroke-width="{sheet.mm(1.0)}"'
    sheet.draw(f'<path id="kept-side" d="{ticks}" {line}/>')
    sample = f'<path d="M0 3H28M6 3L1 9M13 3L8 9M20 3L15 9M27 3L22 9" stroke="{OUTLINE}"/>'
    return [(sample, "kept side")]


_EVENODD = 'fill-rule="evenodd"'


def _stroke(colour: str, width: float, dash: str = "") -> str:
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="M0 6H28" stroke="{colour}" stroke-width="{number(width)}"{dashed}/>'


class _Wire:
    """The blocks of a program as lines, arrows and numbers on a sheet."""

    def __init__(self, program: Program, segments: _Segments, cut: Ints) -> None:
        blocks = program.blocks
        self.program, self.segments, self.cut = program, segments, cut
        self.kind, self.role = blocks["kind"], blocks["role"]
        cuts = (self.kind == Kind.LINE) | (self.kind == Kind.ARC)
        self.cutting = np.flatnonzero(cuts)
        self.moves = np.flatnonzero(self.kind == Kind.MOVE)
        self.commands = segments.commands()

    def _path(self, rows: Sequence[int] | NDArray[np.intp]) -> str:
        """Return one path through the given blocks, lifted only where they do not touch."""
        s, out = self.segments, []
        before = (math.nan, math.nan)
        for i in map(int, rows):
            if (s.x0[i], s.y0[i]) != before:
                out.append(f"M{number(s.x0[i])} {number(s.y0[i])}")
            out.append(self.commands[i])
            before = (s.x1[i], s.y1[i])
        return "".join(out)

    def draw(self, sheet: Sheet, kerf_um: float) -> list[tuple[str, str]]:
        """Draw kerf, cuts and moves; return their legend."""
        legend: list[tuple[str, str]] = []
        # Narrower than the line of the wire path it would not be seen.
        if kerf_um / 1000 * sheet.scale > WIRE_WIDTH and len(self.cutting):
            sheet.draw(
                f'<path id="kerf" d="{self._path(self.cutting)}" stroke="{KERF}" '
                f'stroke-width="{number(kerf_um / 1000)}" stroke-opacity="0.45"/>'
            )
            swatch = f'<rect y="2" width="28" height="8" fill="{KERF}" fill-opacity="0.45"/>'
            legend.append((swatch, "kerf"))
        if len(self.moves):
            sheet.draw(
                f'<g id="moves" stroke="{MOVE}" stroke-width="{sheet.mm(1.2)}" '
                f'stroke-dasharray="{sheet.mm(6)} {sheet.mm(4.5)}">',
                *(
                    f'<path d="{self._path([i])}">{self._tip(i)}</path>'
                    for i in self.moves.tolist()
                ),
                "</g>",
            )
        # In the order in which they are cut; a cut's leads stay in its group.
        for cut in dict.fromkeys(self.cut[self.cutting].tolist()):
            mine = self.cutting[self.cut[self.cutting] == cut]
            sheet.draw(f'<g id="cut-{cut}" stroke-width="{sheet.mm(WIRE_WIDTH)}">')
            for role, colour in COLOURS.items():
                rows = mine[self.role[mine] == role]
                if len(rows):
                    sheet.draw(f'<g class="{role.name.lower()}" stroke="{colour}">')
                    sheet.draw(*self._paths(rows))
                    sheet.draw("</g>")
            sheet.draw("</g>")
        roles = set(self.role[self.cutting].tolist())
        legend += [
            (_stroke(COLOURS[role], 1.8), name)
            for role, name in (
                (Role.CONTOUR, "wire path"),
                (Role.LEAD_IN, "lead"),
                (Role.OVERCUT, "overcut"),
            )
            if role in roles or (role is Role.LEAD_IN and Role.LEAD_OUT in roles)
        ]
        if len(self.moves):
            legend.append((_stroke(MOVE, 1.2, "6 4.5"), "move, wire off"))
        return legend

    def _paths(self, rows: NDArray[np.intp]) -> list[str]:
        if len(self.cutting) <= DETAILED:
            return [f'<path d="{self._path([i])}">{self._tip(i)}</path>' for i in rows.tolist()]
        tip = f"blocks {rows[0] + 1} to {rows[-1] + 1}"
        return [f'<path d="{self._path(rows)}"><title>{tip}</title></path>']

    def _tip(self, i: int) -> str:
        """Return the tool tip of a block."""
        b, s = self.program.blocks[i], self.segments
        if b["kind"] == Kind.ARC:
            r = math.hypot(int(b["x"]), int(b["y"])) * self.program.step_um / 1000
            what = f"arc {'ccw' if b['turn'] > 0 else 'cw'} R {r:.3f}"
        else:
            what = "move" if b["kind"] == Kind.MOVE else "line"
        axis = {Axis.X: " on x", Axis.Y: " on y"}.get(b["axis"], "")
        ends = f"({s.x0[i]:.3f}, {s.y0[i]:.3f}) to ({s.x1[i]:.3f}, {s.y1[i]:.3f}) mm"
        text = f"block {i + 1}: {what}, {ends}, J {b['count']}{axis}"
        source = self._source(int(b["source"]))
        if source is not None:
            text += f"; {source}"
        return f"<title>{words(text)}</title>"

    def _source(self, index: int) -> Span | None:
        sources = self.program.sources
        return sources[index] if 0 <= index < len(sources) else None

    def pauses(self, sheet: Sheet) -> list[tuple[str, str]]:
        """Draw a square where the machine waits in the middle of a cut."""
        waits = np.flatnonzero(self.kind == Kind.PAUSE)
        cuts = np.zeros(len(self.kind) + 2, bool)
        cuts[self.cutting + 1] = True
        waits = waits[cuts[waits] & cuts[waits + 2]]
        for i in waits:
            x, y = sheet.at(float(self.segments.x0[i]), float(self.segments.y0[i]))
            sheet.symbol(
                f'<rect x="{number(x - 4, 2)}" y="{number(y - 4, 2)}" width="8" height="8" '
                f'fill="#fff" stroke="{INK}" stroke-width="1.4">'
                f"<title>block {i + 1}: the machine waits</title></rect>"
            )
        sample = f'<rect x="10" y="2" width="8" height="8" fill="#fff" stroke="{INK}"/>'
        return [(sample, "pause")] if len(waits) else []

    def arrows(self, sheet: Sheet) -> None:
        """Draw direction arrows: at least one on a cut's contour, then one in a stretch."""
        x, y, heading = self.segments.middles()
        length = self.segments.lengths() * sheet.scale
        shapes: dict[str, list[str]] = {}
        for group, rows in self._groups():
            if self.role[rows[0]] == Role.LEAD_OUT:
                continue  # the way in, backwards: two arrows would only hide each other
            way = np.cumsum(length[rows])
            slot = np.floor((way + ARROW_EVERY / 2) / ARROW_EVERY)
            take = np.flatnonzero((np.diff(slot, prepend=0) > 0) & (length[rows] > SHORT_BLOCK))
            if not len(take):
                take = np.array([int(np.argmax(length[rows]))])
            for i in rows[take]:
                if length[i] > 4:
                    tip = _arrow(sheet.at(float(x[i]), float(y[i])), float(heading[i]))
                    shapes.setdefault(group, []).append(tip)
        for colour, tips in shapes.items():
            sheet.symbol(f'<path class="arrows" d="{"".join(tips)}" fill="{colour}"/>')

    def _groups(self) -> list[tuple[str, NDArray[np.intp]]]:
        """Return runs of blocks that belong together, with their colour."""
        moves = [(MOVE, np.array([i])) for i in self.moves]
        if not len(self.cutting):
            return moves
        key = np.column_stack([self.cut[self.cutting], self.role[self.cutting]])
        breaks = np.flatnonzero((np.diff(key, axis=0) != 0).any(axis=1)) + 1
        runs = np.split(self.cutting, breaks)
        return [(COLOURS[Role(int(self.role[r[0]]))], r) for r in runs] + moves

    def ink(self, sheet: Sheet) -> None:
        """Let the sheet know where the wire cuts, so that numbers keep off it."""
        cut = _Segments(*(v[self.cutting] for v in self.segments))
        lines = cut.samples(1.5 / sheet.scale)
        sheet.ink(sheet.at(u, v) for u, v in zip(*(w.tolist() for w in lines), strict=True))

    def labels(self, sheet: Sheet, keeps_left: Mapping[int, bool | None]) -> None:
        """Print block numbers beside their blocks: the first of each cut, others where room is.

        ``keeps_left`` tells for each cut on which side the part lies.
        """
        if not len(self.cutting):
            return
        x, y, heading = self.segments.middles()
        length = self.segments.lengths() * sheet.scale
        _, first = np.unique(self.cut[self.cutting], return_index=True)
        always = set(self.cutting[first].tolist())
        rest = np.concatenate([self.cutting, self.moves])
        rest = rest[length[rest] > SHORT_BLOCK]
        # Longest first; then evenly thinned along the program.
        order = sorted(map(int, rest), key=lambda i: (-round(float(length[i])), i))
        taken: list[tuple[int, float, float]] = []
        for i in [*sorted(always), *(j for j in order if j not in always)]:
            # On the scrap side: right of travel if the part lies to the left.
            side = 1.0 if keeps_left.get(int(self.cut[i])) is False else -1.0
            u, v = sheet.at(float(x[i]), float(y[i]))
            nx = -math.sin(float(heading[i])) * side
            ny = -math.cos(float(heading[i])) * side
            away = 8.0 + 2.6 * abs(nx) * (len(str(i + 1)) - 1)
            spots = [(u + sign * away * nx, v + sign * away * ny) for sign in (1.0, -1.0)]
            boxes = [(at, sheet.label_box(*at, str(i + 1), 9)) for at in spots]
            # The first block of a cut rather lies on a line than on the number of its thread point.
            tries = [(at, box, True) for at, box in boxes]
            tries += [(at, box, False) for at, box in boxes if i in always]
            for at, box, clear in tries:
                if sheet.inside(box) and (not clear or sheet.clear(box)) and sheet.claim(box):
                    taken.append((i, *at))
                    break
            else:
                if i in always and len(always) <= FORCED:
                    sheet.claim(boxes[0][1], force=True)
                    taken.append((i, *spots[0]))
        stride = math.ceil(len(taken) / LABELS)
        taken.sort()
        for k, (i, u, v) in enumerate(taken):
            if i in always or k % stride == 0:
                colour = MOVE if self.kind[i] == Kind.MOVE else INK
                sheet.text((u, v), str(i + 1), size=9, colour=colour)


def _arrow(at: tuple[float, float], heading: float) -> str:
    """Return a triangle about a point of the sheet; the heading is the drawing's (y up)."""
    c, s = math.cos(heading), -math.sin(heading)
    corners = [(5.0, 0.0), (-4.0, 3.1), (-4.0, -3.1)]
    places = [(at[0] + c * a - s * b, at[1] + s * a + c * b) for a, b in corners]
    return "M" + "L".join(f"{number(u, 2)} {number(v, 2)}" for u, v in places) + "Z"


def _mark(sheet: Sheet, marks: Sequence[Diagnostic]) -> None:
    for n, d in enumerate((d for d in marks if d.points_mm), 1):
        for x, y in d.points_mm:
            sheet.mark(x, y, str(n), MARKS[d.severity], f"{d.severity}: {d.message}")


# --- contours alone ----------------------------------------------------------------------------


def plot_contours(
    contours: Sequence[Contour],
    *,
    thread_points: Sequence[ThreadPoint] = (),
    side: Side | None = Side.PART,
    title: str = "",
    facts: Mapping[str, str] | None = None,
    marks: Sequence[Diagnostic] = (),
) -> str:
    """Return an SVG picture of contours as read, before anything is compiled.

    Closed contours are filled even-odd, so that holes show; the ends of open ones are ringed.
    Contours are numbered from 1 in the order given, as ``inspect`` lists them; thread points have
    no number before it is known in which order they are cut.

    Args:
        contours: um, drawing coordinates; may be empty.
        thread_points: start holes.
        side: which material is hatched; None for none.
        title: printed large; the file's name.
        facts: printed in the title block in their order, name -> value.
        marks: findings whose ``points_mm`` are ringed.
    """
    entries = dict(facts or {})
    shapes = [_of_contour(c) for c in contours]
    boxes = [s.box() for s in shapes]
    part = union(boxes) if boxes else None
    boxes += [(p.x / 1000, p.y / 1000, p.x / 1000, p.y / 1000) for p in thread_points]
    boxes += [(x, y, x, y) for d in marks for x, y in d.points_mm]
    box = union(boxes) if boxes else (0.0, 0.0, 10.0, 10.0)
    sheet = Sheet(box, title, len(entries))
    hatched = side if side in (Side.PART, Side.DIE) and any(c.closed for c in contours) else None
    legend = _part(sheet, contours, hatched, box) if contours else []
    if part is not None:
        sheet.dimension(part, box)
    if sum(map(len, contours)) <= DETAILED:
        sheet.draw(f'<g stroke="transparent" stroke-width="{sheet.mm(5)}">')
        for n, (contour, shape) in enumerate(zip(contours, shapes, strict=True), 1):
            sheet.draw(*_tips(contour, shape, n))
        sheet.draw("</g>")
        dots = [
            sheet.at(float(u), float(v)) for s in shapes for u, v in zip(s.x0, s.y0, strict=True)
        ]
        d = "".join(f"M{number(u, 2)} {number(v, 2)}h0" for u, v in dots)
        sheet.symbol(f'<path d="{d}" stroke="{OUTLINE}" stroke-width="3" stroke-linecap="round"/>')
    crosses = []
    for point in thread_points:
        x, y = point.x / 1000, point.y / 1000
        where = f"; {point.span}" if point.span else ""
        crosses.append((x, y, "T", f"thread point at ({x:.3f}, {y:.3f}) mm{where}"))
    legend += draw_threads(sheet, crosses)
    ring = f'fill="none" stroke="{WIRE}" stroke-width="1.6"'
    opened = False
    for contour, shape in zip(contours, shapes, strict=True):
        if contour.closed:
            continue
        opened = True
        for u, v in ((shape.x0[0], shape.y0[0]), (shape.x1[-1], shape.y1[-1])):
            x, y = sheet.at(float(u), float(v))
            sheet.symbol(f'<circle cx="{number(x, 2)}" cy="{number(y, 2)}" r="5" {ring}/>')
    if opened:
        legend.append((f'<circle cx="14" cy="6" r="5" {ring}/>', "open end"))
    for n, shape in enumerate(shapes, 1):
        longest = int(np.argmax(shape.lengths()))
        x, y, heading = (float(v[longest]) for v in shape.middles())
        u, v = sheet.at(x, y)
        for sign in (1.0, -1.0):
            at = (u - sign * 10 * math.sin(heading), v - sign * 10 * math.cos(heading))
            label = sheet.label_box(*at, str(n), 11)
            if sheet.inside(label) and sheet.claim(label):
                sheet.text(at, str(n), size=11, bold=True)
                break
    _mark(sheet, marks)
    return sheet.print(f"{len(contours)} contours, coordinates in mm", entries, legend)


def _tips(contour: Contour, shape: _Segments, n: int) -> list[str]:
    """Return invisible wide strokes that carry a tool tip for each segment."""
    out = []
    radius, commands = shape.radius(), shape.commands()
    for i in range(len(contour)):
        what = "line"
        if shape.sweep[i]:
            what = f"arc R {radius[i]:.3f}, {abs(math.degrees(shape.sweep[i])):.2f} degrees"
        ends = f"({shape.x0[i]:.3f}, {shape.y0[i]:.3f}) to ({shape.x1[i]:.3f}, {shape.y1[i]:.3f})"
        source = contour.source_of(i)
        text = f"contour {n}: {what}, {ends} mm" + (f"; {source}" if source else "")
        path = f"M{number(shape.x0[i])} {number(shape.y0[i])}{commands[i]}"
        out.append(f'<path d="{path}"><title>{words(text)}</title></path>')
    return out

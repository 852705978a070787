"""From the cuts of a part program to a plan: each with its own side, offset, corner and lead.

A drawing has one side and one offset; in the part language every ``cut`` says its own. Cuts that
make one part (an outline and the holes in it) must know each other: they form a *scene*, are
compensated together and judged against one kept material. Cuts that cannot belong to one part (the
punch and the die of one outline) are scenes of their own. Within a scene, what lies in an even
number of outlines is one thing and the rest the other, as in a drawing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, Severity, TextSpan, error, has_errors, note, warning
from wedmcam.geom import measure
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Sequence as Stages
from wedmcam.ir.figure import Transform
from wedmcam.ir.part import CutItem, Part
from wedmcam.ir.plan import Cut, Order, Plan, Side
from wedmcam.ir.sketch import SEGMENT, Sketch, SketchInfo, ThreadPoint
from wedmcam.options import Options
from wedmcam.transforms import figures, planning, walls
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.corners import round_corners
from wedmcam.transforms.leads import Lane, Led, across, lead
from wedmcam.transforms.meetings import contour_meetings
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.nest import Nesting, nest
from wedmcam.transforms.order import order

#: Boxes that are as equal as this are the boxes of one outline, um.
EQUAL_UM = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Worked:
    """A cut whose figure has been through its transforms."""

    item: CutItem
    figure: tuple[Contour, ...]
    start: ThreadPoint | None
    enter: ThreadPoint | None = None


def worked(
    part: Part, more: Sequence[Transform], ar: Arithmetic
) -> tuple[tuple[Worked, ...] | None, list[Diagnostic]]:
    """Return the cuts with their figures made.

    Args:
        part: as written.
        more: transforms of ``--transform``, after those of the program; thread points follow them.
        ar: the arithmetic of the formulas.
    """
    out: list[Worked] = []
    found: list[Diagnostic] = []
    made: dict[int, tuple[Contour, ...] | None] = {}
    for item in part.cuts:
        key = id(item.shape)
        if key not in made:
            made[key], problems = _figure(item, ar)
            found += problems
        figure = made[key]
        if figure is None:
            continue
        spots = tuple(ThreadPoint(*p) for p in (item.start, item.enter) if p is not None)
        if more:
            moved, problems = figures.transformed(figure, Stages(tuple(more)), ar, spots)
            found += problems
            if moved is None:
                continue
            figure, spots = moved
        start = None if item.start is None else spots[0]
        out.append(Worked(item, figure, start, None if item.enter is None else spots[-1]))
    return (None if has_errors(found) else tuple(out)), found


def _figure(item: CutItem, ar: Arithmetic) -> tuple[tuple[Contour, ...] | None, list[Diagnostic]]:
    figure, found = figures.join_chains(item.shape.chains)
    out = [d for d in found if d.severity > Severity.NOTE]
    for stage, span in item.shape.stages:
        moved, problems = figures.transformed(figure, stage, ar)
        out += [d if d.span is not None else replace(d, span=span) for d in problems]
        if moved is None:
            return None, out
        figure = moved[0]
    return figure, out


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A contour to cut.

    Attributes:
        cut: number of the cut it belongs to.
        contour: as it is run.
        outside: the wire runs outside of it; None for an open contour or ``on``.
        shift: how far the wire runs to the left, um (negative: right).
    """

    cut: int
    contour: Contour
    outside: bool | None
    shift: float


def plan(
    cuts: Sequence[Worked], options: Options, ar: Arithmetic
) -> tuple[Plan | None, list[Diagnostic]]:
    """Return where the wire goes, cut by cut in the order of the program."""
    found: list[Diagnostic] = []
    pieces: list[_Piece] = []
    for k, w in enumerate(cuts):
        some, problems = _pieces(k, w, options, ar)
        pieces += some
        found += problems
    if has_errors(found):
        return None, found
    scenes, problems = _scenes(pieces)
    found += problems
    if has_errors(found):
        return None, found
    every_piece = [(number, p) for number, scene in enumerate(scenes) for p in scene]
    found += walls.thin(
        [p.contour for _, p in every_piece],
        [p.outside for _, p in every_piece],
        [number for number, _ in every_piece],
    )
    if has_errors(found):
        return None, found
    made: list[tuple[int, Cut]] = []
    parts: list[Plan] = []
    depths: list[int] = []
    base = 0
    for scene in scenes:
        nesting = nest([p.contour for p in scene])
        depths += nesting.depths
        lanes, problems = _lanes(scene, nesting, cuts, options, ar)
        found += problems
        if lanes is None or has_errors(problems):
            continue
        led, problems = _led(scene, lanes, nesting, cuts, options, base)
        found += problems
        made += led
        parts += _kept(scene, nesting, [c for _, c in led], base)
        base += len(scene)
    if len(scenes) > 1 and not has_errors(found):
        found += across([Led(c.path, c.thread) for _, c in made], "'start' of the cut")
    if has_errors(found):
        return None, found
    made.sort(key=lambda m: m[0])
    every = tuple(c for _, c in made)
    if not every:
        return None, [*found, error("nothing-to-cut", "no contour is left to cut")]
    sides = {p.side for p in parts}
    offset = max((abs(p.shift) for p in pieces), default=0.0)
    words = {w.item.side for w in cuts}
    outlines = tuple(p.contour for scene in scenes for p in scene)
    if len(words) == 1 and (word := words.pop()) in ("left", "right", "on"):
        side = Side(word)
    elif parts:
        side = sides.pop() if len(sides) == 1 else Side.PART
    else:
        side = Side.LEFT if all(p.shift >= 0 for p in pieces) else Side.RIGHT
    return Plan(every, outlines, tuple(depths), side, offset, parts=tuple(parts)), found


def _pieces(
    number: int, w: Worked, options: Options, ar: Arithmetic
) -> tuple[list[_Piece], list[Diagnostic]]:
    """Return the contours of a cut with the side on which the wire runs."""
    item, found = w.item, []
    side = item.side
    offset = item.offset if item.offset is not None else options.offset_um
    if side != "on" and not offset:
        found.append(
            error(
                "no-cut-offset",
                f"'{side}' needs an offset: how far the wire's centre runs from the outline",
                item.span,
                hint="offset 0.1, or --offset for all cuts that say none",
            )
        )
        return [], found
    offset = 0.0 if side == "on" else float(offset or 0.0)
    corner = item.corner if item.corner is not None else options.corner_um
    if 0 < corner < offset:
        found.append(
            error(
                "wed-value",
                f"corner {corner / 1000:.3f} mm is below the offset {offset / 1000:.3f} mm: the "
                "wire could not follow it",
                item.span,
            )
        )
        return [], found
    figure = [merge_arcs(c) for c in w.figure]
    if side in ("inside", "outside"):
        found += [_open(c, side, item.span) for c in figure if not c.closed]
        figure = list(figures.counter_clockwise(figure))
    if item.stop and not all(c.closed for c in figure):
        found.append(
            error("wed-value", "a stop is for closed contours; this one is open", item.span)
        )
    if item.overcut and not all(c.closed for c in figure):
        found.append(
            error("wed-value", "an overcut is for closed contours; this one is open", item.span)
        )
    if w.enter is not None and len(figure) > 1:
        text = f"'enter' is for one contour; this figure has {len(figure)}"
        found.append(
            error("wed-value", text, w.enter.span, hint="cut each with an enter of its own")
        )
    if corner:
        figure, problems = round_corners(figure, corner, ar)
        found += problems
    if has_errors(found):
        return [], found
    depths = nest(figure).depths
    pieces = []
    for c, depth in zip(figure, depths, strict=True):
        if side == "on":
            pieces.append(_Piece(number, c, None, 0.0))
            continue
        if side in ("inside", "outside"):
            outside = (side == "outside") == (depth % 2 == 0)
            shift = -offset if outside else offset
        else:
            shift = offset if side == "left" else -offset
            ccw = c.closed and measure.area(c.vertices) > 0
            outside = (shift < 0) == ccw
        pieces.append(_Piece(number, c, outside if c.closed else None, shift))
    return pieces, found


def _open(c: Contour, side: str, span: TextSpan) -> Diagnostic:
    x, y = (c.vertices[k] / 1000 for k in ("x", "y"))
    gap = float(np.hypot(x[-1] - x[0], y[-1] - y[0]))
    last = c.source_of(len(c) - 1) or span
    return error(
        "open-contour",
        f"to be cut {side} a contour must close: it ends at ({x[-1]:.3f}, {y[-1]:.3f}) mm, "
        f"{gap:.3f} mm from its start ({x[0]:.3f}, {y[0]:.3f}) mm",
        last,
        notes=(("it is cut here", span),),
        points_mm=((float(x[0]), float(y[0])), (float(x[-1]), float(y[-1]))),
        hint="'close' draws a line back; 'left', 'right' and 'on' cut along an open contour",
    )


def _scenes(pieces: Sequence[_Piece]) -> tuple[list[list[_Piece]], list[Diagnostic]]:
    """Return the contours in groups that can be one part, and the rest each alone."""
    sided = [p for p in pieces if p.outside is not None]
    alone = [[p] for p in pieces if p.outside is None]
    if not sided:
        return alone, []
    found: list[Diagnostic] = list(contour_meetings(_once(sided)))
    if has_errors(found):
        return [], found
    if _one_part(sided):
        return [sided, *alone], []
    scenes: list[list[_Piece]] = []
    for number in dict.fromkeys(p.cut for p in sided):
        own = [p for p in sided if p.cut == number]
        crossing = list(contour_meetings([p.contour for p in own]))
        if has_errors(crossing):
            found += crossing
            continue
        for scene in scenes:
            if _one_part([*scene, *own]):
                scene += own
                break
        else:
            scenes.append(own)
    return [*scenes, *alone], found


def _once(pieces: Sequence[_Piece]) -> list[Contour]:
    """Return the contours, of equal ones (a punch and its die) the first: others must not cross."""
    contours = [p.contour for p in pieces]
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    return [
        c
        for k, c in enumerate(contours)
        if not k or np.abs(boxes[:k] - boxes[k]).max(axis=1).min() >= EQUAL_UM
    ]


def _one_part(pieces: Sequence[_Piece]) -> bool:
    contours = [p.contour for p in pieces]
    return _side(pieces, nest(contours)) is not None and not has_errors(contour_meetings(contours))


def _side(pieces: Sequence[_Piece], nesting: Nesting) -> Side | None:
    """Return what of nested contours is kept, None where their sides contradict each other."""
    part = {p.outside == (d % 2 == 0) for p, d in zip(pieces, nesting.depths, strict=True)}
    if len(part) != 1:
        return None
    return Side.PART if part.pop() else Side.DIE


def _lanes(
    scene: Sequence[_Piece],
    nesting: Nesting,
    cuts: Sequence[Worked],
    options: Options,
    ar: Arithmetic,
) -> tuple[list[Lane] | None, list[Diagnostic]]:
    """Return the wire paths of a scene, each in the direction of its contour."""
    contours = [p.contour for p in scene]
    lengths = [cuts[p.cut].item.lead for p in scene]
    enters = [cuts[p.cut].enter for p in scene]
    if not any(p.shift for p in scene):
        return [
            Lane(c, c, None, 0.0, k, nesting.parents[k], lengths[k], enters[k])
            for k, c in enumerate(contours)
        ], []
    shifts = [p.shift for p in scene]
    result, found = compensate(contours, shifts, arithmetic=ar, sharp=options.sharp)
    if found:
        return None, found
    most = max(abs(s) for s in shifts)
    asked = replace(options, offset_um=most, side=Side.PART)
    found += planning.interference(contours, shifts, result.interference, asked)
    if has_errors(found):
        return None, found
    sided = scene[0].outside is not None
    if result.inner_corners and sided and not any(cuts[p.cut].item.corner for p in scene):
        found.append(
            note(
                "inner-corners",
                f"{result.inner_corners} sharp inner corners keep the radius of the wire, "
                f"{most / 1000:.3f} mm",
                hint="'corner' rounds the part's own corners, so that punch and die fit",
            )
        )
    lanes = []
    for p in result.paths:
        k = p.outline
        left = scene[k].shift > 0 if sided else None
        lane = Lane(
            p.path, contours[k], left, abs(shifts[k]), k, nesting.parents[k], lengths[k], enters[k]
        )
        if options.reverse and cuts[scene[k].cut].item.side in ("inside", "outside"):
            lane = replace(
                lane,
                path=p.path.reversed(),
                outline=contours[k].reversed(),
                scrap_left=None if left is None else not left,
            )
        lanes.append(lane)
    return lanes, found


def _led(
    scene: Sequence[_Piece],
    lanes: list[Lane],
    nesting: Nesting,
    cuts: Sequence[Worked],
    options: Options,
    base: int,
) -> tuple[list[tuple[int, Cut]], list[Diagnostic]]:
    """Return the cuts of a scene with the numbers of their items, inner contours first."""
    threads, only = [], []
    for number in dict.fromkeys(p.cut for p in scene):
        start = cuts[number].start
        if start is not None:
            threads.append(start)
            only.append({k for k, lane in enumerate(lanes) if scene[lane.contour].cut == number})
    if not lanes:
        return [], []
    led, found = lead(lanes, threads, options.lead_um, only)
    if led is None:
        return [], found
    parents = planning.parents_of([lane.contour for lane in lanes], nesting.parents)
    sequence = order(parents, [i.thread for i in led], list(range(len(led))), Order.INNER_FIRST)
    out = []
    for k in sequence:
        lane, one = lanes[k], led[k]
        item = cuts[scene[lane.contour].cut].item
        closed = one.path.closed
        stop = item.stop if item.stop is not None else options.stop_um
        found += _too_long(one.path, stop if closed else 0.0, "stop", item.span)
        over = item.overcut if item.overcut is not None else options.overcut_um
        found += _too_long(one.path, over if closed else 0.0, "overcut", item.span)
        cut = Cut(
            lane.outline,
            one.path,
            one.thread,
            nesting.depths[lane.contour],
            None if lane.scrap_left is None else not lane.scrap_left,
            stop if closed else 0.0,
            over if closed else 0.0,
            base + lane.contour + 1,
        )
        out.append((scene[lane.contour].cut, cut))
    return out, found


def _too_long(path: Contour, length: float, name: str, span: TextSpan) -> list[Diagnostic]:
    whole = measure.length(path.vertices, path.closed)
    if not length or length < whole - 1.0:
        return []
    return [
        error(
            f"{name}-too-long",
            f"'{name}' of {length / 1000:.3f} mm is longer than the path of {whole / 1000:.3f} mm",
            span,
            hint=f"a shorter {name}",
        )
    ]


def _kept(scene: Sequence[_Piece], nesting: Nesting, made: Sequence[Cut], base: int) -> list[Plan]:
    """Return what a scene keeps: a plan for each offset, over the same outlines."""
    if scene[0].outside is None or not any(p.shift for p in scene):
        return []
    side = _side(scene, nesting)
    assert side is not None
    outlines = tuple(p.contour for p in scene)
    out = []
    for offset in sorted({abs(p.shift) for p in scene}):
        mine = {base + k + 1 for k, p in enumerate(scene) if abs(p.shift) == offset}
        own = tuple(c for c in made if c.number in mine)
        reached = tuple(sorted(n - base - 1 for n in mine))
        out.append(Plan(own, outlines, nesting.depths, side, offset, False, (), reached, base))
    return out


def idle_options(part: Part, options: Options) -> list[Diagnostic]:
    """Return findings on options that are for drawings: a part program says these things itself."""
    usual = Options()
    found = []
    for name, word, instead in (
        ("layers", "--layer", "a part program has no layers"),
        ("ignore_layers", "--ignore-layer", "a part program has no layers"),
        ("join_um", "--join", "chains whose ends meet within 1 um join"),
        ("tolerance_um", "--tolerance", "a part program has no splines"),
        ("side", "--side", "each cut names its side"),
        ("starts_um", "--start", "each cut names its start"),
        ("order", "--order", "cuts are made in the order in which they are written"),
    ):
        if getattr(options, name) != getattr(usual, name):
            found.append(warning("wed-option", f"{word} has no effect: {instead}"))
    if options.units not in (None, part.units):
        text = f"--units {options.units} has no effect: the part program is in {part.units}"
        found.append(warning("wed-option", text, hint="units stand in its first line"))
    return found


def sketch_of(part: Part, cuts: Sequence[Worked]) -> tuple[Sketch, tuple[Contour, ...]]:
    """Return what is told of a part program: its unit, names and thread points, its contours."""
    contours: list[Contour] = []
    for w in cuts:
        contours += [c for c in w.figure if not any(c is known for known in contours)]
    info = SketchInfo(
        units=part.units,
        units_from="the part program",
        entities={"contour": dict(part.blocks)},
        extra={"part": part.name} if part.name else {},
    )
    threads = tuple(w.start for w in cuts if w.start is not None)
    return Sketch(np.zeros(0, SEGMENT), (), threads, info), tuple(contours)

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
from wedmcam.diag import Diagnostic, TextSpan, error, has_errors, note, warning
from wedmcam.geom import measure
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Reverse
from wedmcam.ir.plan import Cut, Order, Plan, Side
from wedmcam.options import Options
from wedmcam.transforms import figures, planning
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.corners import round_corners
from wedmcam.transforms.meetings import contour_meetings
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.nest import Nesting, nest
from wedmcam.transforms.plan.idle import NEARER_END, Used, of_path
from wedmcam.transforms.plan.leads import PlannedPath, Threaded, lead
from wedmcam.transforms.plan.order import order
from wedmcam.transforms.plan.shaped import ShapedCut

#: Boxes that are as equal as this are the boxes of one outline, um.
EQUAL_UM = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A contour to cut.

    Attributes:
        cut: number of the cut it belongs to.
        contour: as it is run.
        outside: the wire runs outside of it; None for an open contour or ``on``.
        shift: how far the wire runs to the left, um (negative: right).
        reverse: the wire runs the contour the other way, on the same path.
    """

    cut: int
    contour: Contour
    outside: bool | None
    shift: float
    reverse: bool


def plan(
    cuts: Sequence[ShapedCut], options: Options, ar: Arithmetic
) -> tuple[Plan | None, list[Diagnostic]]:
    """Return where the wire goes, cut by cut in the order of the program."""
    found: list[Diagnostic] = []
    pieces: list[_Piece] = []
    used = Used()
    for k, w in enumerate(cuts):
        some, problems = _pieces(k, w, options, ar, used)
        pieces += some
        found += problems
    if has_errors(found):
        return None, found
    scenes, problems = _scenes(pieces)
    found += problems
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
        led, problems = _led(scene, lanes, nesting, cuts, options, base, used)
        found += problems
        made += led
        parts += _kept(scene, nesting, [c for _, c in led], base)
        base += len(scene)
    if has_errors(found):
        return None, found
    found += of_path(used.names, options, part=True)
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
    number: int, w: ShapedCut, options: Options, ar: Arithmetic, used: Used
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
    used.add("offset_um", side != "on" and item.offset is None)
    used.add("corner_um", item.corner is None)
    for name in ("sharp", "trim"):
        used.add(name, offset > 0)
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
    for k, (c, depth) in enumerate(zip(figure, depths, strict=True)):
        # The drawn sense is run where the side follows it; else what is stated counts.
        stated = side in ("inside", "outside") and w.clockwise[k]
        reverse = stated != options.reverse
        if side == "on":
            pieces.append(_Piece(number, c, None, 0.0, reverse))
            continue
        if side in ("inside", "outside"):
            outside = (side == "outside") == (depth % 2 == 0)
            shift = -offset if outside else offset
        else:
            shift = offset if side == "left" else -offset
            ccw = c.closed and measure.area(c.vertices) > 0
            outside = (shift < 0) == ccw
        pieces.append(_Piece(number, c, outside if c.closed else None, shift, reverse))
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
    cuts: Sequence[ShapedCut],
    options: Options,
    ar: Arithmetic,
) -> tuple[list[PlannedPath] | None, list[Diagnostic]]:
    """Return the wire paths of a scene, each in the direction of its contour."""
    contours = [p.contour for p in scene]
    lengths = [cuts[p.cut].item.lead for p in scene]
    enters = [cuts[p.cut].enter for p in scene]
    if not any(p.shift for p in scene):
        return [
            _run(
                PlannedPath(
                    p.contour, p.contour, None, 0.0, k, nesting.parents[k], lengths[k], enters[k]
                ),
                p,
            )
            for k, p in enumerate(scene)
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
        lane = PlannedPath(
            p.path, contours[k], left, abs(shifts[k]), k, nesting.parents[k], lengths[k], enters[k]
        )
        lanes.append(_run(lane, scene[k]))
    return lanes, found


def _run(lane: PlannedPath, piece: _Piece) -> PlannedPath:
    """Return the lane in the direction in which the wire runs it."""
    if not piece.reverse:
        return lane
    return replace(
        lane,
        path=lane.path.reversed(),
        outline=lane.outline.reversed(),
        scrap_left=None if lane.scrap_left is None else not lane.scrap_left,
    )


def _led(
    scene: Sequence[_Piece],
    lanes: list[PlannedPath],
    nesting: Nesting,
    cuts: Sequence[ShapedCut],
    options: Options,
    base: int,
    used: Used,
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
        used.add("stop_um", closed and item.stop is None)
        used.add("overcut_um", closed and item.overcut is None)
        used.add("lead_um", one.measured and item.lead is None)
        found += _idle_clauses(scene[lane.contour], lane, one, cuts, options)
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


def _idle_clauses(
    piece: _Piece, lane: PlannedPath, led: Threaded, cuts: Sequence[ShapedCut], options: Options
) -> list[Diagnostic]:
    """Return warnings on what a cut, or --reverse, says and a lead overrules."""
    w = cuts[piece.cut]
    found = []
    if w.item.lead is not None and not led.measured:
        found.append(
            warning(
                "wed-option",
                "'lead' has no effect: the cut is entered from "
                + ("its start" if w.start is not None else "the centre of the circle"),
                w.item.span,
            )
        )
    words = ["--reverse"] if options.reverse and options.wished("reverse") else []
    words += ["'reverse'"] if any(isinstance(t, Reverse) for t, _ in w.item.shape.stages) else []
    if words and planning.overruled(lane, led):
        text = f"{words[0]} has no effect: {NEARER_END}"
        found.append(warning("wed-option", text, w.item.span))
    return found


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

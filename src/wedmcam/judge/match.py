"""Whose contour is it: programs with an order, a sense, a start or leads of their own.

An old program cuts the same part its own way. Each piece of it is matched with a planned wire path
by where it lies; the path is turned and begun as the program has it, and what the program does
before and after is taken as its leads. Their duties (`judge`, `leads`) are to stay out of the kept
material and off other cuts, and to end where they may. A contour that is run again is a second
pass: it has to follow the planned path like the first.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.diag import Diagnostic, error, note, warning
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import Program, Role
from wedmcam.judge.pieces import (
    RECOMPUTED,
    SAME_BOX,
    Piece,
    box_and_area,
    other_pieces,
    outline_of,
    piece_along,
    pieces,
)
from wedmcam.judge.route import Route, assemble, overcut
from wedmcam.judge.segments import (
    Floats,
    Ints,
    Segments,
    boxes,
    join,
    of_contour,
    point_distance,
    reverse,
    sub_segments,
)
from wedmcam.judge.stretches import SOME_CONTOURS, Assigned, per_mm, place, span_of
from wedmcam.judge.track import progress
from wedmcam.judge.walk import Walk

#: Ways in and out are the same within this, um: ends are rounded, and a stair has no length.
SAME_LEAD = 5.0

#: So many ways in and out are listed one by one.
LEADS_LISTED = 10


def path_box(cut: Cut) -> Floats:
    """Return the box of a planned wire path: x low, y low, x high, y high."""
    b = boxes(of_contour(cut.path))
    return np.concatenate([b[:, :2].min(axis=0), b[:, 2:].max(axis=0)])


def path_area(s: Segments) -> float:
    """Return the signed area of a closed chain of segments, um^2."""
    x0, y0 = float(s.ax[0]), float(s.ay[0])
    chords = (s.ax - x0) * (s.by - y0) - (s.bx - x0) * (s.ay - y0)
    caps = s.turn * s.radius**2 * (2.0 * s.half - np.sin(2.0 * s.half))
    return float((chords + caps).sum()) / 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """A program laid on a plan.

    Attributes:
        assigned: the blocks of each cut, in the program's order.
        cuts: of the plan, one an entry of ``assigned``.
        route: as the program takes it.
        backwards: for each whether it runs against the plan's sense.
    """

    assigned: list[Assigned]
    cuts: list[Cut]
    route: Route
    backwards: list[bool]


def match(way: Walk, program: Program, plan: Plan) -> tuple[Match | None, list[Diagnostic]]:
    """Match the pieces of a program with the planned cuts.

    Returns:
        The match, None where no piece is a cut of the plan; and findings: an error for each cut
        that is missing and each piece that is none, a warning for each that is run again, notes for
        what is other than planned.
    """
    held, findings = _pieces_of_cuts(way, program, plan)
    findings += _missing(program, plan, {k for _, k in held})
    if not held:
        return None, findings
    assigned: list[Assigned] = []
    backwards: list[bool] = []
    parts: list[tuple[Segments, Role, int]] = []
    for number, (piece, k) in enumerate(held):
        path, back = _as_run(way, piece, plan.cuts[k])
        parts += [(s, role, number) for s, role in _route_of(way, piece, path)]
        closing = piece.last - 1 if piece.past else -1
        assigned.append(Assigned(k, piece.index, piece.pauses, closing))
        backwards.append(back)
    findings += _other_order(way, program, plan, assigned, backwards)
    findings += _other_leads(way, program, plan, held)
    cuts = [plan.cuts[a.cut] for a in assigned]
    route = assemble(
        join(s for s, _, _ in parts),
        np.concatenate([np.full(len(s), int(role)) for s, role, _ in parts]),
        np.concatenate([np.full(len(s), number) for s, _, number in parts]),
        np.array([c.path.closed for c in cuts]),
        way.start[[int(a.index[0]) for a in assigned]],
    )
    return Match(assigned, cuts, route, backwards), findings


def _pieces_of_cuts(
    way: Walk, program: Program, plan: Plan
) -> tuple[list[tuple[Piece, int]], list[Diagnostic]]:
    """Return the pieces that are cuts of the plan, each with its cut, and report the others."""
    findings: list[Diagnostic] = []
    runs_of: Counter[int] = Counter()
    held = []
    for piece, k in pair_with_cuts(way, plan):
        if k < 0:
            findings.append(_stranger(way, program, piece))
            continue
        more = piece.again + bool(runs_of[k])
        runs_of[k] += piece.again + 1
        if more:
            findings.append(_again(way, program, piece, k, runs_of[k], warning))
        held.append((piece, k))
    return held, findings


def _route_of(way: Walk, piece: Piece, path: Segments) -> Iterator[tuple[Segments, Role]]:
    """Yield the stretches of the route that a piece takes: its own leads about the planned path."""
    yield outline_of(way, piece.index[: piece.first]), Role.LEAD_IN
    yield path, Role.CONTOUR
    if piece.past:
        yield overcut(path, piece.past), Role.OVERCUT
    here = piece.last
    for turn in piece.turns:
        _, area = box_and_area(way, piece.index[here:turn])
        same = (area > 0) == (piece.area > 0)
        yield (path if same else reverse(path)), Role.OVERCUT
        here = turn
    yield outline_of(way, piece.index[piece.out :]), Role.LEAD_OUT


def _missing(program: Program, plan: Plan, there: set[int]) -> list[Diagnostic]:
    """Return an error for each cut of the plan that is not among the numbers ``there``."""
    per = per_mm(program)
    findings = []
    for k in sorted(set(range(len(plan.cuts))) - there):
        x, y = path_box(plan.cuts[k])[:2].tolist()
        findings.append(
            error(
                "missing-cut",
                "cut {cut} (low corner {corner}) is not in the program",
                points_mm=(place(x, y, per),),
                cut=k + 1,
                corner=place(x, y, per),
            )
        )
    return findings


def _other_order(
    way: Walk,
    program: Program,
    plan: Plan,
    assigned: Sequence[Assigned],
    backwards: Sequence[bool],
) -> list[Diagnostic]:
    """Return notes on another order, another sense, and other thread points than the plan's."""
    per = per_mm(program)
    findings: list[Diagnostic] = []
    order = list(dict.fromkeys(a.cut for a in assigned))
    if order != sorted(order):
        findings.append(
            note(
                "other-order",
                "the program cuts the contours in the order {order}",
                order=", ".join(str(k + 1) for k in order),
            )
        )
    for a, back in zip(assigned, backwards, strict=True):
        first = int(a.index[0])
        if back:
            findings.append(
                note(
                    "other-order",
                    "cut {cut} is run against the sense of the plan",
                    span_of(program, first),
                    cut=a.cut + 1,
                )
            )
        x, y = way.start[first].tolist()
        if (x, y) != plan.cuts[a.cut].thread:
            findings.append(
                note(
                    "other-order",
                    "cut {cut} is threaded at {start}, not at {thread}",
                    span_of(program, first),
                    cut=a.cut + 1,
                    start=place(x, y, per),
                    thread=place(*plan.cuts[a.cut].thread, per),
                )
            )
    return findings


def _other_leads(
    way: Walk, program: Program, plan: Plan, held: Sequence[tuple[Piece, int]]
) -> list[Diagnostic]:
    """Return a note for each way in and each way out that is not as the plan has it.

    A way in of its own leads straight from where it is threaded to its contour, and the way out
    back: so far it is the plan's with another start, and that is told already. What is told here
    is another place of arrival, and whatever else is cut on the way.
    """
    per = per_mm(program)
    length = way.lengths()
    notes: list[Diagnostic] = []
    for piece, k in held:
        cut = plan.cuts[k]
        index = piece.index
        if (arrival := _other_way_in(way, program, piece, cut, length, k)) is not None:
            notes.append(arrival)
        start, thread = (way.start[int(index[p])].astype(float) for p in (piece.first, 0))
        straight = float(np.hypot(*(start - thread)))
        way_out = float(length[index[piece.out :]].sum())
        back = straight + 2.0 * cut.overcut_um if cut.path.closed else 0.0
        if abs(way_out - back) > SAME_LEAD:
            notes.append(
                note(
                    "other-leads",
                    "the way out of cut {cut} is {length_mm:.3f} mm long, the plan's "
                    "{planned_mm:.3f} mm"
                    if way_out
                    else "the way out of cut {cut} is missing, the plan's {planned_mm:.3f} mm",
                    span_of(program, int(index[min(piece.out, len(index) - 1)])),
                    cut=k + 1,
                    length_mm=way_out / per,
                    planned_mm=back / per,
                )
            )
    more = len(notes) - LEADS_LISTED
    if more > 1:
        rest = note(
            "other-leads", "and {count} more ways in and out are not the plan's", count=more
        )
        return [*notes[:LEADS_LISTED], rest]
    return notes


def _other_way_in(
    way: Walk, program: Program, piece: Piece, cut: Cut, length: Floats, k: int
) -> Diagnostic | None:
    """Return a note where a way in arrives elsewhere, or is longer than straight.

    Args:
        way, program: what the machine does.
        piece: the blocks of the cut.
        cut: as it is planned.
        length: of each block of the program, steps.
        k: number of the cut in the plan, from 0.
    """
    per = per_mm(program)
    row = int(piece.index[piece.first])
    start, thread = (way.start[r].astype(float) for r in (row, int(piece.index[0])))
    v = cut.path.vertices[0]
    planned = np.array([float(v["x"]), float(v["y"])])
    straight = float(np.hypot(*(start - thread)))
    way_in = float(length[piece.index[: piece.first]].sum())
    elsewhere = cut.path.closed and float(np.hypot(*(start - planned))) > SAME_LEAD
    longer = way_in - straight > SAME_LEAD
    if not elsewhere and not longer:
        return None
    d = note("other-leads", "the way into cut {cut}", span_of(program, row), cut=k + 1)
    if elsewhere:
        d = d.extended(
            " arrives at {arrival}, the plan's at {planned}",
            arrival=place(start[0], start[1], per),
            planned=place(planned[0], planned[1], per),
        )
    if elsewhere and longer:
        d = d.extended(" and")
    if longer:
        d = d.extended(
            " is {length_mm:.3f} mm long, straight {straight_mm:.3f} mm",
            length_mm=way_in / per,
            straight_mm=straight / per,
        )
    return d


def pair_with_cuts(way: Walk, plan: Plan) -> list[tuple[Piece, int]]:
    """Return the pieces of a program, each with the number (from 0) of its cut; -1 for none.

    A piece that lies where no cut is left, but one was, is that cut once more.
    """
    wanted = np.array([path_box(c) for c in plan.cuts]).reshape(-1, 4)
    free = np.ones(len(wanted), bool)
    length = way.lengths()
    out = []
    for piece in pieces(way):
        for left in (free, ~free):
            held, k = lies_on(way, piece, plan.cuts, wanted, np.flatnonzero(left), length)
            if k >= 0:
                free[k] = False
                break
        out.append((held, k))
    return out


def lies_on(
    way: Walk, piece: Piece, cuts: Sequence[Cut], wanted: Floats, numbers: Ints, length: Floats
) -> tuple[Piece, int]:
    """Return a piece as a run of one of the cuts ``numbers``, and which; -1 for none of them.

    ``wanted`` are the boxes of all cuts, ``length`` is that of each block (`Walk.lengths`).
    """
    for k in numbers.tolist() if not piece.closed else ():
        held = piece_along(way, piece, cuts[k])
        if held is not None and np.abs(wanted[k] - held.box).max() <= SAME_BOX:
            return held, k
    best, least = (piece, -1), (np.inf, np.inf)
    for held in itertools.chain((piece,), other_pieces(way, piece)) if len(numbers) else ():
        off = np.abs(wanted[numbers] - held.box).max(axis=1)
        k = int(numbers[int(off.argmin())])
        if off.min() > SAME_BOX:
            continue
        # Leads within the box of a contour are told from it by what it goes round; where they go
        # round nothing, one in more blocks than the other, by how long it is.
        path = of_contour(cuts[k].path)
        whole = float(path.length.sum())
        apart = max(abs(abs(held.area) - abs(path_area(path))) - RECOMPUTED * whole, 0.0)
        long = float(length[held.index[held.first : held.last]].sum())
        if (apart, long) < least:
            best, least = (held, k), (apart, long)
        if not held.closed or (apart == 0.0 and long <= whole + SAME_LEAD):
            break
    return best


def repeated_cuts(way: Walk, program: Program, plan: Plan) -> list[Diagnostic]:
    """Return an error for each cut of the plan that a program runs again."""
    runs_of: Counter[int] = Counter()
    findings = []
    for piece, k in pair_with_cuts(way, plan):
        more = piece.again + bool(runs_of[k])
        runs_of[k] += piece.again + 1
        if k >= 0 and more:
            findings.append(_again(way, program, piece, k, runs_of[k], error))
    return findings


def _again(
    way: Walk,
    program: Program,
    piece: Piece,
    k: int,
    times: int,
    finding: Callable[..., Diagnostic],
) -> Diagnostic:
    first = int(piece.index[piece.last if piece.again else piece.first])
    last = int(piece.index[piece.out - 1 if piece.turns or not piece.again else -1])
    x, y = way.start[first].tolist()
    again = finding(
        "cut-twice",
        "cut {cut} is run twice" if times == 2 else "cut {cut} is run {times} times",
        span_of(program, first),
        points_mm=(place(x, y, per_mm(program)),),
        cut=k + 1,
        times=times,
        first=first + 1,
        last=last + 1,
    )
    return again.extended(
        ": blocks {first} to {last} run it again"
        if last > first
        else ": block {first} runs it again"
    )


def _stranger(way: Walk, program: Program, piece: Piece) -> Diagnostic:
    per = per_mm(program)
    first = int(piece.index[0])
    x, y = way.start[first].tolist()
    width, height = (piece.box[2:] - piece.box[:2]).tolist()
    return error(
        "extra-cut",
        "blocks {first} to {last} cut a contour of {width_mm:.3f} x {height_mm:.3f} mm that the "
        "plan does not have there",
        span_of(program, first),
        hint=SOME_CONTOURS,
        points_mm=(place(x, y, per),),
        first=first + 1,
        last=int(piece.index[-1]) + 1,
        width_mm=width / per,
        height_mm=height / per,
    )


def _as_run(way: Walk, piece: Piece, cut: Cut) -> tuple[Segments, bool]:
    """Return the planned path in the sense, and from the start, that the program has."""
    path = of_contour(cut.path)
    begin = way.start[int(piece.index[piece.first])].astype(float)
    if not cut.path.closed:
        to_start = np.hypot(path.ax[0] - begin[0], path.ay[0] - begin[1])
        back = bool(np.hypot(path.bx[-1] - begin[0], path.by[-1] - begin[1]) < to_start)
        return (reverse(path) if back else path), back
    back = (path_area(path) > 0) != (piece.area > 0)
    return begin_at(reverse(path) if back else path, begin[0], begin[1]), back


def begin_at(path: Segments, x: float, y: float) -> Segments:
    """Return a closed path begun at its point nearest to (x, y)."""
    px, py = np.full(len(path), x), np.full(len(path), y)
    k = int(np.argmin(point_distance(path, px, py)))
    one = path.take(slice(k, k + 1))
    t = float(np.clip(progress(one, px[:1], py[:1])[0], 0.0, one.length[0]))
    if t < 1.0 or t > one.length[0] - 1.0:
        if one.half[0] >= np.pi:
            return path
        k += t > one.length[0] / 2.0
        return path.take(np.roll(np.arange(len(path)), -k))
    head = sub_segments(one, np.array([t]), one.length)
    tail = sub_segments(one, np.zeros(1), np.array([t]))
    rest = path.take(np.roll(np.arange(len(path)), -k)[1:])
    return join([head, rest, tail])


def sizes(held: Sequence[Piece]) -> Floats:
    """Return widths and heights of the contours, shape (n, 2)."""
    return np.array([p.box[2:] - p.box[:2] for p in held]).reshape(-1, 2)

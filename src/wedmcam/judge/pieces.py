"""The pieces of a program that may be contours: what is cut between two threads, without its leads.

Where a piece closes is where it comes by its own start again; what it does before is its way in,
what it does behind is its way out or an overcut. Which planned path a piece is, says `match`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from wedmcam.ir.plan import Cut
from wedmcam.ir.program import Kind
from wedmcam.judge.segments import (
    Floats,
    Ints,
    Segments,
    point_distance,
    points_at,
    segments,
)
from wedmcam.judge.stretches import stretches
from wedmcam.judge.track import LOST, progress
from wedmcam.judge.walk import Walk

#: A loop of the program and a planned path whose boxes differ by more are not the same, um.
SAME_BOX = LOST

#: A contour begins within so many blocks of a piece, and ends at one of so many returns.
EARLY = 6

#: Ends on a machine that recomputes them miss each other by up to this, um.
RECOMPUTED = 2.0

#: A contour comes by its start so near, um: both are rounded.
BY = 2.0

#: The middles of a block and of the way back on it lie within this, um: each deviates by up to 2
#: from the route, and their numbers of steps may differ by a few.
MIDDLES = 6.0


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Blocks between two threadings, and the contour among them.

    Attributes:
        index: rows of the program.
        pauses: positions in ``index`` after which the machine pauses.
        first: position of the first block of the contour.
        last: one past the last.
        turns: one past the last of each further whole turn, directly behind the contour.
        again: how often the contour is run once more, these turns included.
        closed: the contour ends where it starts, within `LOST`.
        box: of the contour's places, x low, y low, x high, y high.
        area: signed, um^2; > 0 counter-clockwise.
        past: how far the last block of the contour runs on over its start, um; 0 where it ends
            there.
    """

    index: Ints
    pauses: tuple[int, ...]
    first: int
    last: int
    turns: tuple[int, ...]
    again: int
    closed: bool
    box: Floats
    area: float
    past: float = 0.0

    @property
    def out(self) -> int:
        """Position of the first block of the way out."""
        return (self.last, *self.turns)[-1]


def pieces(way: Walk) -> list[Piece]:
    """Part a program at moves, and at pauses where the wire is back where it was threaded."""
    out = []
    held: list[Ints] = []
    pauses: list[int] = []
    start = end = (0, 0)
    for run in stretches(way):
        if held and (not run.joined or end == start):
            out += _passes(way, np.concatenate(held), tuple(pauses))
            held, pauses = [], []
        if held:
            pauses.append(sum(len(h) for h in held))
        else:
            start = run.start
        held.append(run.index)
        end = run.end
    if held:
        out += _passes(way, np.concatenate(held), tuple(pauses))
    return out


def _passes(way: Walk, index: Ints, pauses: tuple[int, ...]) -> list[Piece]:
    """Return blocks as one piece, or as one a pass: in, round and out, and in, round and out again.

    Passes need no pause between them where the wire is back at its thread point.
    """
    ends, start = way.end[index], way.start[index[:1]]
    back = np.flatnonzero((ends[:-1] == start).all(axis=1)) + 1
    if pauses or not len(back):
        return [_piece(way, index, pauses)]
    parts = [_piece(way, part, ()) for part in np.split(index, back)]
    box, area = parts[0].box, abs(parts[0].area)
    alike = all(
        one.first > 0
        and one.last < len(one.index)
        and np.abs(one.box - box).max() <= SAME_BOX
        and abs(one.area) > 0.5 * area > 0
        for one in parts
    )
    return parts if alike else [_piece(way, index, pauses)]


def _piece(way: Walk, index: Ints, pauses: tuple[int, ...]) -> Piece:
    """Find the contour among blocks: leads that are retraced are left out."""
    ends = np.concatenate([way.start[index[:1]], way.end[index]])
    first, last = 0, len(index)
    room = RECOMPUTED if way.textbook else 0.0

    def meet(i: int, j: int) -> bool:
        return float(np.hypot(*(ends[i] - ends[j]).astype(float))) <= room

    if not meet(first, last) and np.hypot(*(ends[0] - ends[-1]).astype(float)) <= LOST:
        room = LOST  # it was to return; that it does not is found later
    if meet(first, last):
        while (
            last - first > 2
            and meet(first + 1, last - 1)
            and _retraced(way, int(index[first]), int(index[last - 1]))
        ):
            first, last = first + 1, last - 1
        # What follows the first return to its start is an overcut and the way back on it.
        off = np.hypot(*(ends[first + 1 : last + 1] - ends[first]).astype(float).T)
        back = off <= room
        if room > 0:  # ends of blocks shorter than the room are no return
            back &= np.cumsum(way.steps[index[first:last]]) > 6.0 * room
        last = first + 1 + int(np.flatnonzero(back)[0]) if back.any() else last
    else:
        # No way back to the thread point: the longest closed stretch that begins early.
        best = (0, 0, len(index))
        for a in range(min(EARLY, len(index))):
            off = np.hypot(*(ends[a + 1 :] - ends[a]).T)
            near = np.flatnonzero(off <= LOST)
            if len(near) and int(near[-1]) + 1 > best[0]:
                best = (int(near[-1]) + 1, a, a + 1 + int(near[-1]))
        first, last = best[1], best[2]
    if (first, last) == (0, len(index)) and (over := _runs_on(way, index, pauses)) is not None:
        return over
    return _cut_out(way, index, pauses, first, last)


def _runs_on(way: Walk, index: Ints, pauses: tuple[int, ...]) -> Piece | None:
    """Return a contour that comes by its start again, in the middle of a block or at its end.

    An overlap: the way out begins where it ends, so it is not the way in.
    """
    n = len(index)
    own, length = outline_of(way, index), way.lengths()[index]
    ends = np.concatenate([way.start[index[:1]], way.end[index]]).astype(float)
    most = abs(box_and_area(way, index)[1])
    for first in range(1, min(EARLY, n - 1)):
        x, y = (np.full(n, v) for v in ends[first])
        at = progress(own, x, y)
        passes = (point_distance(own, x, y) <= BY) & (at > BY) & (np.arange(n) > first)
        for k in np.flatnonzero(passes)[:EARLY].tolist():
            past = max(float(length[k] - at[k]), 0.0)
            if past <= BY:
                if (ends[k + 1] != ends[first]).any():
                    continue
                past = 0.0
            # What runs on does so along the first block.
            along = np.array([min(past, float(length[first])) / 2.0])
            u, v = points_at(own.take(slice(first, first + 1)), along)
            if past and point_distance(own.take(slice(k, k + 1)), u, v)[0] > 2.0 * BY:
                continue
            held = _cut_out(way, index, pauses, first, k + 1)
            if abs(held.area) > 0.5 * most:
                return (
                    held if not past else replace(held, closed=True, again=0, turns=(), past=past)
                )
    return None


def _cut_out(way: Walk, index: Ints, pauses: tuple[int, ...], first: int, last: int) -> Piece:
    """Return blocks whose contour is ``first`` to ``last``."""
    ends = np.concatenate([way.start[index[:1]], way.end[index]])
    room = RECOMPUTED if way.textbook else 0.0

    def meet(i: int, j: int) -> bool:
        return float(np.hypot(*(ends[i] - ends[j]).astype(float))) <= room

    closed = bool(np.hypot(*(ends[last] - ends[first]).astype(float)) <= LOST)
    box, area = box_and_area(way, index[first:last])
    turns: list[int] = []
    again, here = 0, last
    returns = [p for p in range(last + 1, len(index) + 1) if meet(first, p)] if closed else []
    for p in returns:
        other, size = box_and_area(way, index[here:p])
        if np.abs(other - box).max() <= SAME_BOX and abs(size) > 0.5 * abs(area) > 0:
            again += 1
            if here == (last, *turns)[-1]:
                turns.append(p)
        here = p
    return Piece(index, pauses, first, last, tuple(turns), again, closed, box, area)


def other_pieces(way: Walk, piece: Piece) -> Iterator[Piece]:
    """Yield other closed stretches of a piece that begin early: ways in and out may differ."""
    index = piece.index
    ends = np.concatenate([way.start[index[:1]], way.end[index]]).astype(float)
    room = RECOMPUTED if way.textbook else 0.0
    for first in range(min(EARLY, len(index))):
        off = np.hypot(*(ends[first + 1 :] - ends[first]).T)
        for back in np.flatnonzero(off <= room)[:EARLY].tolist():
            if (first, first + 1 + back) != (piece.first, piece.last):
                yield _cut_out(way, index, piece.pauses, first, first + 1 + back)


def box_and_area(way: Walk, index: Ints) -> tuple[Floats, float]:
    """Return the box of the places of blocks, and the signed area that they go round, um^2."""
    x, y, _ = way.points(index)
    u, v = x - x[0], y - y[0]
    area = float((u[:-1] * v[1:] - u[1:] * v[:-1]).sum()) / 2.0  # the first place is (0, 0)
    return np.array([x.min(), y.min(), x.max(), y.max()]), area


def piece_along(way: Walk, piece: Piece, cut: Cut) -> Piece | None:
    """Return an open piece with the blocks of an open path as its contour; None where it has none.

    Such a contour runs from the block end nearest to one end of the path to the one nearest to the
    other.
    """
    if piece.closed or cut.path.closed:
        return None
    ends = np.concatenate([way.start[piece.index[:1]], way.end[piece.index]]).astype(float)
    v = cut.path.vertices[[0, -1]]
    off = np.hypot(ends[:, :1] - v["x"], ends[:, 1:] - v["y"])
    first, last = sorted(int(k) for k in off.argmin(axis=0))
    if first == last or off.min(axis=0).max() > LOST:
        return None
    box, area = box_and_area(way, piece.index[first:last])
    start = ends[first]  # places begin behind the first step
    box = np.concatenate([np.minimum(box[:2], start), np.maximum(box[2:], start)])
    return replace(piece, first=first, last=last, turns=(), box=box, area=area)


def _retraced(way: Walk, there: int, back: int) -> bool:
    """Return whether two blocks, whose ends are known to meet, have one way there and back."""
    x, y, _ = way.points(np.array([there]))
    u, v, _ = way.points(np.array([back]))
    off = np.hypot(x[len(x) // 2] - u[-1 - len(u) // 2], y[len(y) // 2] - v[-1 - len(v) // 2])
    return bool(off <= MIDDLES)


def outline_of(way: Walk, index: Ints) -> Segments:
    """Return blocks as the lines and arcs they are meant to be."""
    b = way.blocks[index]
    a, e = way.start[index].astype(float), way.end[index].astype(float)
    turn = np.where(b["kind"] == Kind.ARC, b["turn"], 0).astype(float)
    return segments(a[:, 0], a[:, 1], e[:, 0], e[:, 1], a[:, 0] - b["x"], a[:, 1] - b["y"], turn)

"""Routes: the plan as one line from thread point to thread point, measured along itself.

A cut is: in from the thread point, once round the wire path, past its start and back where an
overcut is asked for, and out again. Every place on all routes has one number, its progress in um;
cuts are `GAP` um apart, so that progress grows through the whole program and never belongs to two
cuts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut
from wedmcam.ir.program import Role
from wedmcam.judge.segments import (
    Bools,
    Floats,
    Ints,
    Segments,
    join,
    of_contour,
    reverse,
    segments,
    sub_segments,
)

#: Progress between the end of one cut and the start of the next, um.
GAP = 1000.0

#: Segments shorter than this are dropped, um: far below what the machine or the plan can mean.
NOTHING = 1e-6


class Route(NamedTuple):
    """All cuts one after the other.

    Attributes:
        segments: of all cuts, in order.
        role: `Role` of each segment.
        cut: 0-based number of the cut of each segment.
        at: progress of each segment's start, um; strictly growing.
        to: progress of its end, equal to the next one's start within a cut.
        first: index of the first segment of each cut, and the total at the end.
        path_low: for each cut, progress at which the wire path starts.
        path_high: at which it has been run once.
        closed: whether the wire path is closed.
        thread: where the route starts, whole um, shape (cuts, 2).
    """

    segments: Segments
    role: Ints
    cut: Ints
    at: Floats
    to: Floats
    first: Ints
    path_low: Floats
    path_high: Floats
    closed: Bools
    thread: Ints

    @property
    def low(self) -> Floats:
        """Progress at which each cut starts."""
        return self.at[self.first[:-1]]

    @property
    def high(self) -> Floats:
        """Progress at which each cut ends."""
        return self.to[self.first[1:] - 1]


def of_contours(contours: Sequence[Contour]) -> tuple[Segments, Ints]:
    """Return the segments of all contours, and which contour each belongs to."""
    if not contours:
        return join([]), np.zeros(0, np.int64)
    rows = np.concatenate([c.vertices for c in contours])
    count = np.array([len(c.vertices) for c in contours], np.int64)
    first = np.cumsum(count) - count
    following = np.arange(1, len(rows) + 1)
    following[first + count - 1] = first
    which = np.repeat(np.arange(len(contours)), count)
    kept = np.ones(len(rows), bool)
    is_open = np.array([not c.closed for c in contours])
    kept[(first + count - 1)[is_open]] = False
    a, b, which = rows[kept], rows[following[kept]], which[kept]
    columns = (a["x"], a["y"], b["x"], b["y"], a["cx"], a["cy"], a["turn"])
    every = segments(*(np.ascontiguousarray(c, np.float64) for c in columns))
    some = every.length > NOTHING
    return (every, which) if some.all() else (every.take(some), which[some])


def plan_route(cuts: Sequence[Cut]) -> Route:
    """Return the route that the plan asks for.

    An open path has no way out. After an overcut the wire goes back over it and leaves by the way
    in: the only way that certainly cuts nothing.
    """
    path, which = of_contours([c.path for c in cuts])
    thread = np.array([c.thread for c in cuts], np.int64).reshape(len(cuts), 2)
    closed = np.array([c.path.closed for c in cuts], bool)
    begin = np.searchsorted(which, np.arange(len(cuts)))
    x0, y0 = path.ax[begin], path.ay[begin]
    tx, ty = thread[:, 0].astype(float), thread[:, 1].astype(float)
    zero = np.zeros(len(cuts))
    extra, extra_cut, extra_role, extra_order = [], [], [], []
    for c, cut in enumerate(cuts):
        if not (cut.overcut_um > 0 and cut.path.closed):
            continue
        over = overcut(of_contour(cut.path), cut.overcut_um)
        for piece, role, order in ((over, Role.OVERCUT, 2), (reverse(over), Role.LEAD_OUT, 3)):
            extra.append(piece)
            extra_cut.append(np.full(len(piece), c))
            extra_role.append(np.full(len(piece), int(role)))
            extra_order.append(np.full(len(piece), order))
    lead_in = segments(tx, ty, x0, y0, zero, zero, zero)
    lead_out = segments(x0, y0, tx, ty, zero, zero, zero).take(closed)
    number = np.arange(len(cuts))
    held = join([lead_in, path, lead_out, *extra])
    cut_of = np.concatenate([number, which, number[closed], *extra_cut]).astype(np.int64)
    roles = (Role.LEAD_IN, Role.CONTOUR, Role.LEAD_OUT)
    counts = (len(cuts), len(path), len(lead_out))
    role_of = np.concatenate([np.repeat([int(r) for r in roles], counts), *extra_role])
    order_of = np.concatenate([np.repeat([0, 1, 4], counts), *extra_order])
    by_cut = np.lexsort((order_of, cut_of))
    return assemble(held.take(by_cut), role_of[by_cut], cut_of[by_cut], closed, thread)


def assemble(held: Segments, role: Ints, cut: Ints, closed: Bools, thread: Ints) -> Route:
    """Put segments, sorted by cut, on one scale of progress; empty ones are dropped."""
    some = held.length > NOTHING
    if not some.all():
        held, role, cut = held.take(some), role[some], cut[some]
    total = np.cumsum(held.length)
    at = total - held.length + cut * GAP
    first = np.searchsorted(cut, np.arange(len(closed) + 1))
    to = at + held.length
    within = np.ones(len(at), bool)
    within[first[1:] - 1] = False
    inner = np.flatnonzero(within)
    to[inner] = at[inner + 1]
    contour = np.flatnonzero(role == Role.CONTOUR)
    begin = contour[np.searchsorted(cut[contour], np.arange(len(closed)))]
    last = contour[np.searchsorted(cut[contour], np.arange(len(closed)), "right") - 1]
    return Route(
        held, role.astype(np.int64), cut, at, to, first, at[begin], to[last], closed, thread
    )


def overcut(path: Segments, length: float) -> Segments:
    """Return the first ``length`` um of a closed path, at most once round."""
    start = np.cumsum(path.length) - path.length
    held = path.take(start < length)
    ends = np.minimum(length - start[: len(held)], held.length)
    return sub_segments(held, np.zeros(len(held)), ends)

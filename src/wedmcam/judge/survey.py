"""The figures of a program from as few of its places as will do.

Most blocks are proven by their bounds (``bounds``). Measured (``deviation``) are the others, and
those that may hold an extreme (``extremes``): most promising first, until no bound is above the
largest figure found. If anything measured is over a limit, everything is measured, so that findings
name the first block and tell exact numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wedmcam.judge.bounds import Bounds, bound
from wedmcam.judge.deviation import CHUNK, SLOP, Measured, measure
from wedmcam.judge.extremes import extremes
from wedmcam.judge.material import Kept
from wedmcam.judge.route import Route
from wedmcam.judge.segments import Bools, Floats, Ints
from wedmcam.judge.walk import Walk

#: What bounds may leave open of a figure, um: the rounding of float64.
CLOSE = 1e-6

#: Two neighbours share `SLOP`: one may overrun its end and the other begin before it.
SHARE = SLOP / 2.0


class Survey(NamedTuple):
    """What is known of blocks, one entry a block that was tracked.

    Attributes:
        deviation: of each block, both ways, um; exact where ``exact``, else a bound that is at
            most the figure of its group (leads, or all else).
        stray: how far progress fell back, overran or fell short, um; over `SLOP` is no such run.
        exact: which blocks were measured.
        extents: x low, y low, x high, y high of all places.
        gouge: how deep the wire enters the kept material, um, at least 0 if that is never found.
        gouge_at: (x, y) of the deepest place.
        gouge_block: position of its block.
    """

    deviation: Floats
    stray: Floats
    exact: Bools
    extents: Floats
    gouge: float
    gouge_at: tuple[float, float]
    gouge_block: int


def survey(
    way: Walk,
    index: Ints,
    low: Floats,
    high: Floats,
    lead: Bools,
    route: Route,
    kept: Kept | None,
    path_limit_um: Floats,
    gouge_limit_um: float,
) -> Survey:
    """Survey blocks ``index`` of the walk on their stretches of progress from low to high.

    ``path_limit_um``: of each block.
    """
    if way.textbook or not len(index) or not way.stepping.steady:
        return everything(way, index, low, high, route, kept)
    b = bound(way, index, low, high, route)
    runs = b.known & (b.over <= SHARE) & (b.under + b.back <= SHARE) & (b.short <= SHARE)
    known = runs & (b.deviation <= path_limit_um)
    deepest = np.full(len(index), -np.inf)
    if kept is not None:
        segment = np.maximum(np.searchsorted(route.at, low, "right") - 1, 0)
        deepest = kept.bound_piece(segment, b.low, b.high)
        known &= deepest <= gouge_limit_um
    held = _Held(way, index, low, high, route, kept, b, runs)
    held.settle(lead, deepest, ~known)
    if held.failed(path_limit_um, gouge_limit_um):
        return everything(way, index, low, high, route, kept)
    return Survey(
        held.deviation,
        held.stray,
        held.exact,
        way.stepping.extents(way.blocks[index], way.steps[index], way.start[index], way.end[index]),
        held.gouge,
        held.gouge_at,
        held.gouge_block,
    )


def everything(
    way: Walk, index: Ints, low: Floats, high: Floats, route: Route, kept: Kept | None
) -> Survey:
    """Measure every place of every block."""
    m = measure(way, index, low, high, route, kept)
    exact = np.ones(len(index), bool)
    return Survey(m.deviation, m.stray, exact, m.extents, m.gouge, m.gouge_at, m.gouge_block)


class _Held:
    """What is known so far."""

    def __init__(
        self,
        way: Walk,
        index: Ints,
        low: Floats,
        high: Floats,
        route: Route,
        kept: Kept | None,
        bounds: Bounds,
        runs: Bools,
    ) -> None:
        self.way, self.index, self.low, self.high = way, index, low, high
        self.route, self.kept = route, kept
        self.runs = runs  # along one segment and in order, as the bounds prove
        self.deviation = np.where(runs, bounds.deviation, np.inf)
        self.stray = np.zeros(len(index))
        self.exact = np.zeros(len(index), bool)
        # What the block before may have reached: only as far as its bound says.
        reached = np.where(runs, self.high + bounds.over, -np.inf)
        self.before = np.concatenate([[-np.inf], reached[:-1]])
        self.gouge, self.gouge_at, self.gouge_block = -np.inf, (0.0, 0.0), -1

    def measure(self, rows: Ints) -> None:
        """Measure blocks and take over what was found."""
        proven = self.runs[rows]
        for some, how in ((rows[proven], extremes), (rows[~proven], measure)):
            if not len(some):
                continue
            more = () if how is extremes else (self.before[some],)
            m: Measured = how(
                self.way,
                self.index[some],
                self.low[some],
                self.high[some],
                self.route,
                self.kept,
                *more,
            )
            self.deviation[some] = m.deviation
            self.stray[some] = m.stray
            if m.gouge > self.gouge:
                self.gouge, self.gouge_at = m.gouge, m.gouge_at
                self.gouge_block = int(some[m.gouge_block])
        self.exact[rows] = True

    def failed(self, path_limit_um: Floats, gouge_limit_um: float) -> bool:
        """Return whether something measured is over a limit, or may be together with others."""
        done = self.exact
        return bool(
            (self.deviation[done] > path_limit_um[done]).any()
            or (self.stray[done] > SHARE).any()
            or self.gouge > gouge_limit_um
        )

    def settle(self, lead: Bools, deepest: Floats, wanted: Bools) -> None:
        """Measure what may hold the largest deviation of leads, of all else, and of the gouge.

        Blocks ``wanted`` are measured in any case.
        """
        # About a chunk of places at a time for the three searches together: a call costs as much.
        each = float(self.way.steps[self.index].mean())
        take = max(8, int(CHUNK / (4.0 * each)))
        groups = [np.flatnonzero(lead), np.flatnonzero(~lead)]
        while True:
            rows = wanted.copy()
            left = ~self.exact & ~wanted
            for group in groups:
                done = self.exact[group]
                most = float(self.deviation[group][done].max(initial=0.0))
                open_ = group[left[group] & (self.deviation[group] > most + CLOSE)]
                rows[_first(open_, self.deviation[open_], take)] = True
            open_ = np.flatnonzero(left & (deepest > max(self.gouge, 0.0) + CLOSE))
            rows[_first(open_, deepest[open_], take)] = True
            if not rows.any():
                break
            self.measure(np.flatnonzero(rows))
            wanted = np.zeros(len(rows), bool)
            take *= 4
        for group in groups:
            done = self.exact[group]
            if done.any():
                most = float(self.deviation[group][done].max())
                self.deviation[group] = np.minimum(self.deviation[group], most)


def _first(rows: Ints, value: Floats, take: int) -> Ints:
    """Return the ``take`` rows of the largest value."""
    if len(rows) <= take:
        return rows
    return rows[np.argpartition(-value, take)[:take]]

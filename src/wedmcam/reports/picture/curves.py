"""Long curves as few points: what a picture of millions of steps shows is kept, the rest is not.

Curves grow piece by piece, and hold never more points than a picture can show.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.reports.picture.sheet import number

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: Places, shape (n, 2), and of each the number of its run: runs do not hang together.
Points = tuple[Floats, Ints]

#: At most so many points a curve.
MOST = 5000


class Trail:
    """A path of places in mm, thinned to what a sheet shows.

    Args:
        apart: places nearer to each other than this are one, mm.
    """

    def __init__(self, apart: float) -> None:
        self._apart = apart
        self._places: list[Floats] = []
        self._runs: list[Ints] = []
        self._count = 0

    def add(self, places: Floats) -> None:
        """Add an unbroken stretch, shape (n, 2)."""
        if not len(places):
            return
        cell = np.floor(places / self._apart)
        kept = np.ones(len(places), bool)
        kept[1:-1] = (cell[1:-1] != cell[:-2]).any(axis=1)
        self._places.append(places[kept])
        self._runs.append(np.full(int(kept.sum()), self._count))
        self._count += 1

    def places(self) -> Points:
        """Return the places that are needed, and of each the number of its stretch."""
        if not self._places:
            return np.zeros((0, 2)), np.zeros(0, np.int64)
        places, runs = np.concatenate(self._places), np.concatenate(self._runs)
        within = self._apart / 8
        for k in range(40):
            kept = _bends(places, runs, within, k % 2)
            places, runs = places[kept], runs[kept]
            if k >= 12:
                if len(places) <= MOST:
                    break
                within *= 2
        return places, runs


def stretches(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return where a mask holds: the first row of each stretch, and the row behind its last.

    >>> stretches(np.array([True, False, True, True]))
    [(0, 1), (2, 4)]
    """
    edges = np.flatnonzero(np.diff(mask.astype(np.int8), prepend=0, append=0))
    return [(first, last) for first, last in edges.reshape(-1, 2).tolist()]


def _bends(places: Floats, runs: Ints, within: float, odd: int) -> NDArray[np.bool_]:
    """Return which places are needed: every other one that lies on a line with both beside it."""
    kept = np.ones(len(places), bool)
    i = np.arange(1 + odd, len(places) - 1, 2)
    i = i[(runs[i - 1] == runs[i]) & (runs[i + 1] == runs[i])]
    way = places[i + 1] - places[i - 1]
    off = places[i] - places[i - 1]
    length = np.hypot(way[:, 0], way[:, 1])
    along = (way * off).sum(axis=1)
    beside = abs(way[:, 0] * off[:, 1] - way[:, 1] * off[:, 0])
    on = (beside <= within * length) & (along >= 0) & (along <= length * length)
    kept[i[on]] = False
    return kept


def polyline(places: Floats, runs: Ints, decimals: int = 2) -> str:
    """Return places as the commands of an SVG path, lifted where a run ends."""
    out, before = [], None
    for (x, y), run in zip(places.tolist(), runs.tolist(), strict=True):
        at = f"{number(x, decimals)} {number(y, decimals)}"
        out.append(f"L{at}" if run == before else f"M{at}h0")
        before = run
    return "".join(out)


class Samples:
    """A value over time in slots: of each the first, the least, the largest and the last are kept.

    Args:
        first, last: of the time that is shown, s.
    """

    #: Slots, so that four points of each are no more than `MOST`.
    SLOTS = 1200

    def __init__(self, first: float, last: float) -> None:
        self._first, self._last = first, last
        self._slot = max(last - first, 1e-9) / self.SLOTS
        self._points: list[Floats] = []
        self._runs: list[Ints] = []

    def add(self, time: Floats, value: Ints, run: Ints) -> None:
        """Add values in the order of time; values of another run do not hang together."""
        low = int(np.searchsorted(time, self._first, side="left"))
        shown = slice(low, int(np.searchsorted(time, self._last, side="right")))
        time, value, run = time[shown], value[shown], run[shown]
        if not len(time):
            return
        slot = np.minimum(((time - self._first) / self._slot).astype(np.int64), self.SLOTS - 1)
        begin = np.flatnonzero(np.diff(slot, prepend=-1))
        of = np.repeat(np.arange(len(begin)), np.diff(begin, append=len(slot)))
        kept = np.zeros(len(slot), bool)
        kept[begin] = kept[np.append(begin[1:], len(slot)) - 1] = True
        for extreme in (np.minimum, np.maximum):
            at = np.flatnonzero(value == extreme.reduceat(value, begin)[of])
            kept[at[np.diff(of[at], prepend=-1) > 0]] = True
        self._points.append(np.column_stack([time[kept], value[kept]]))
        self._runs.append(run[kept])

    def points(self) -> Points:
        """Return what is kept, (time, value) a row, and the run of each."""
        if not self._points:
            return np.zeros((0, 2)), np.zeros(0, np.int64)
        return np.concatenate(self._points), np.concatenate(self._runs)

"""Two programs compared as what the machines do: step paths, with the generator on or off.

Blocks need not match: a line in two pieces, an arc in quadrants, another format or counting, are
the same path if the places are. Two paths are equal within w if every place of each is at most w um
from a place of the other that is as far along, give or take the few steps that w allows. Where both
programs have the same block at the same place nothing is stepped. Machines may have other steps:
places are true um, and as far along is as many um.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.ir.program import Kind, Program, in_um
from wedmcam.judge.segments import Bools, Floats, Ints
from wedmcam.judge.walk import Walk, walk

#: Places compared at a time.
CHUNK = 1 << 16

#: Blocks that agree, in a row, so that it pays to leave them out.
FEW = 8


class Difference(NamedTuple):
    """How two programs differ.

    Attributes:
        equal: nowhere more than asked for.
        largest_um: largest distance between the paths; up to the first difference if not equal.
        block_a: 1-based block of the first program where they first differ; 0 where it has ended.
        block_b: of the second.
        at: where that is, um from the start of the first program.
        distance_um: how far apart the paths are there; inf where one has ended or does not cut.
        what: in words.
    """

    equal: bool
    largest_um: float
    block_a: int = 0
    block_b: int = 0
    at: tuple[int, int] = (0, 0)
    distance_um: float = 0.0
    what: str = ""


class _Stretch(NamedTuple):
    """Blocks in a row with the generator on, or off."""

    way: Walk
    rows: Ints
    first: Ints  # steps before each block, and in all
    step_um: float

    @property
    def cuts(self) -> bool:
        return bool(self.way.blocks["kind"][self.rows[0]] != Kind.MOVE)

    def part(self, low: int, high: int) -> _Stretch:
        """Return the blocks low to high."""
        return _stretch(self.way, self.rows[low:high], self.step_um)

    def starts(self, low: int = 0, high: int | None = None) -> Ints | Floats:
        """Return where the blocks low to high start, um, shape (n, 2)."""
        return in_um(self.way.start[self.rows[low:high]], self.step_um)

    def block(self, step: int) -> int:
        """Return the 1-based block that makes a step."""
        k = int(np.searchsorted(self.first, step, "right")) - 1
        return int(self.rows[min(max(k, 0), len(self.rows) - 1)]) + 1

    def places(self, low: int, high: int) -> Floats:
        """Return the places after steps low to high - 1, um; 0 is the start. Shape (2, n)."""
        k0 = max(int(np.searchsorted(self.first, low, "left")) - 1, 0)
        k1 = int(np.searchsorted(self.first, high - 1, "left"))
        k1 = max(k1, k0 + 1)
        rows = self.rows[k0:k1]
        first, last = (n - int(self.first[k0]) - 1 for n in (low, high))
        x, y = self.way.places(rows, max(first, 0), last)
        if first < 0:
            start = self.way.start[rows[0]]
            x, y = np.concatenate([[start[0]], x]), np.concatenate([[start[1]], y])
        places = np.stack([x, y])
        return places if self.step_um == 1 else places * self.step_um


def _stretch(way: Walk, rows: Ints, step_um: float) -> _Stretch:
    return _Stretch(way, rows, np.concatenate([[0], np.cumsum(way.steps[rows])]), step_um)


def _stretches(way: Walk, step_um: float) -> list[_Stretch]:
    """Part a program where the generator goes on or off; blocks without a step are left out."""
    rows = np.flatnonzero(way.steps > 0)
    off = way.blocks["kind"][rows] == Kind.MOVE
    edges = np.flatnonzero(np.diff(off)) + 1
    return [_stretch(way, part, step_um) for part in np.split(rows, edges) if len(part)]


def difference(
    a: Program,
    b: Program,
    stepping_a: Stepping,
    stepping_b: Stepping,
    within_um: float = 1.0,
) -> Difference:
    """Compare two programs from their first blocks on; where they start does not matter.

    Args:
        a: one program.
        b: the other.
        stepping_a: the interpolator of ``a``.
        stepping_b: of ``b``.
        within_um: how far apart equal paths may be.

    >>> from wedmcam.ir.program import BLOCK, Axis
    >>> one, two = np.zeros(1, BLOCK), np.zeros(2, BLOCK)
    >>> one["x"], one["count"], one["axis"] = 10, 10, Axis.X
    >>> two["x"], two["count"], two["axis"] = [4, 6], [4, 6], Axis.X
    >>> from wedmcam.controllers import stepping_of
    >>> mirror = stepping_of("3b", "mirror")
    >>> difference(Program(one), Program(two), mirror, mirror).equal
    True
    """
    ways = [walk(replace(p, origin=(0, 0)), t) for p, t in ((a, stepping_a), (b, stepping_b))]
    for nth, way in enumerate(ways):
        endless = np.flatnonzero(way.steps < 0)
        if len(endless):
            row = int(endless[0]) + 1
            blocks = (0, row) if nth else (row, 0)
            return Difference(False, np.inf, *blocks, (0, 0), np.inf, "the block never ends")
    here, there = _stretches(ways[0], a.step_um), _stretches(ways[1], b.step_um)
    largest = 0.0
    for one, two in zip(here, there, strict=False):
        if one.cuts != two.cuts:
            return _ended(one, two, largest, "one cuts, the other moves with the generator off")
        comparison = _compare(one, two, within_um)
        largest = max(largest, comparison.largest_um)
        if not comparison.equal:
            return comparison._replace(largest_um=largest)
    if len(here) != len(there):
        n = min(len(here), len(there))
        more = here[n] if len(here) > n else there[n]
        block = int(more.rows[0]) + 1
        blocks = (block, 0) if len(here) > n else (0, block)
        return Difference(
            False, largest, *blocks, _begin(more), np.inf, "the other program has ended"
        )
    return Difference(True, largest)


def _ended(one: _Stretch, two: _Stretch, largest: float, what: str) -> Difference:
    blocks = int(one.rows[0]) + 1, int(two.rows[0]) + 1
    return Difference(False, largest, *blocks, _begin(one), np.inf, what)


def _begin(stretch: _Stretch) -> tuple[int, int]:
    """Return where a stretch begins, whole um."""
    x, y = stretch.starts(0, 1)[0].tolist()
    return round(x), round(y)


def _compare(one: _Stretch, two: _Stretch, within: float) -> Difference:
    """Compare two stretches; blocks that are the same at the same place are not stepped."""
    largest = 0.0
    for k0, k1, l0, l1, same in _parts(one, two, within):
        if same:
            off = one.starts(k0, k1) - two.starts(l0, l1)
            largest = max(largest, float(np.hypot(off[:, 0], off[:, 1]).max()))
            continue
        p, q = one.part(k0, k1), two.part(l0, l1)
        if not len(p.rows) or not len(q.rows):
            more = p if len(p.rows) else q
            if int(more.first[-1]) * more.step_um <= within:
                continue
            block = int(more.rows[0]) + 1
            blocks = (block, 0) if more is p else (0, block)
            return Difference(False, largest, *blocks, _begin(more), np.inf, "only one cuts on")
        there, off_there, most = _leaves(p, q, within)
        largest = max(largest, most)
        ratio = p.step_um / q.step_um  # steps of q for one of p
        limit = None if there is None else round(there * ratio) + CHUNK
        back, off_back, most = _leaves(q, p, within, limit)
        largest = max(largest, most)
        if there is None and back is None:
            continue
        # Whichever is earlier along the path.
        if there is not None and (back is None or there * ratio <= back):
            x, y = p.places(there, there + 1)[:, 0]
            step, other, away = there, min(round(there * ratio), int(q.first[-1])), off_there
        else:
            assert back is not None
            x, y = q.places(back, back + 1)[:, 0]
            step, other, away = min(round(back / ratio), int(p.first[-1])), back, off_back
        return Difference(
            False,
            largest,
            p.block(step - 1),
            q.block(other - 1),
            (round(x), round(y)),
            away,
            "apart",
        )
    return Difference(True, largest)


def _parts(one: _Stretch, two: _Stretch, within: float) -> list[tuple[int, int, int, int, bool]]:
    """Return stretches of blocks (of one: from, to; of two: from, to), and whether they agree."""
    n, m = len(one.rows), len(two.rows)
    if n == m:
        same = _same(one, two, slice(None), slice(None), within)
        edges = np.concatenate([[0], np.flatnonzero(np.diff(same)) + 1, [n]])
        # A few that agree between others that do not are stepped with them: calls cost more.
        few = np.flatnonzero((np.diff(edges) < FEW) & same[edges[:-1]])
        if not same.all():
            for k in few.tolist():
                same[edges[k] : edges[k + 1]] = False
        edges = np.concatenate([[0], np.flatnonzero(np.diff(same)) + 1, [n]])
        return [(k, e, k, e, bool(same[k])) for k, e in pairwise(edges.tolist())]
    least = min(n, m)
    ahead = _same(one, two, slice(0, least), slice(0, least), within)
    head = int(np.argmin(ahead)) if not ahead.all() else least
    rest = least - head
    behind = _same(one, two, slice(n - rest, n), slice(m - rest, m), within)[::-1]
    tail = (int(np.argmin(behind)) if not behind.all() else rest) if rest else 0
    parts = [
        (0, head, 0, head, True),
        (head, n - tail, head, m - tail, False),
        (n - tail, n, m - tail, m, True),
    ]
    return [p for p in parts if p[1] > p[0] or p[3] > p[2]]


def _same(one: _Stretch, two: _Stretch, k: slice, el: slice, within: float) -> Bools:
    """Return which blocks are the same, at places at most ``within`` apart."""
    a, b = one.way.blocks[one.rows[k]], two.way.blocks[two.rows[el]]
    same = np.full(len(a), one.step_um == two.step_um)
    for name in ("turn", "axis", "x", "y", "count"):
        same &= a[name] == b[name]
    x, y = a["x"], a["y"]
    same &= (a["turn"] != 0) | one.way.stepping.same_lines(two.way.stepping, x, y)
    off = in_um(one.way.start[one.rows[k]], one.step_um)
    off = off - in_um(two.way.start[two.rows[el]], two.step_um)
    return np.asarray(same & (np.hypot(off[:, 0], off[:, 1]) <= within))


def _leaves(
    p: _Stretch, q: _Stretch, within: float, limit: int | None = None
) -> tuple[int | None, float, float]:
    """Return the first step after which p is off q, how far, and the largest distance till then.

    Steps after ``limit`` are not looked at.
    """
    window = int(np.ceil(2.0 * within / q.step_um)) + 3
    total, other = int(p.first[-1]) + 1, int(q.first[-1]) + 1
    total = total if limit is None else min(total, limit)
    largest = 0.0
    at = lag = 0
    while at < total:
        high = min(at + CHUNK, total)
        off, best = _nearest(p, q, at, high, lag, window, other)
        bad = np.flatnonzero(off > within)
        if not len(bad):
            largest = max(largest, float(off.max()))
            lag += int(best[-1])
            at = high
            continue
        k = int(bad[0])
        # The one may have drifted from the other by more steps than the window has.
        drift = int(best[k - 1]) if k else 0
        if drift:
            largest = max(largest, float(off[:k].max()))
            at, lag = at + k, lag + drift
            continue
        return at + k, float(off[k]), max(largest, float(off[:k].max(initial=0.0)))
    return None, 0.0, largest


def _nearest(
    p: _Stretch, q: _Stretch, low: int, high: int, lag: int, window: int, other: int
) -> tuple[Floats, Ints]:
    """Return the distance of places of p from q about as far along, and how many steps ahead."""
    here = p.places(low, high)
    index = np.arange(low, high) + lag
    if p.step_um != q.step_um:
        index = np.rint(np.arange(low, high) * (p.step_um / q.step_um)).astype(np.int64) + lag
    begin = max(min(int(index[0]) - window, other - 1), 0)
    stop = max(min(int(index[-1]) + 1 + window, other), begin + 1)
    there = q.places(begin, stop)
    best = np.full(high - low, np.inf)
    ahead = np.zeros(high - low, np.int64)
    index -= begin
    for d in sorted(range(-window, window + 1), key=abs):
        k = np.clip(index + d, 0, stop - begin - 1)
        dx, dy = here[0] - there[0][k], here[1] - there[1][k]
        away = dx * dx + dy * dy
        nearer = away < best
        if not nearer.any():
            continue
        best[nearer] = away[nearer]
        ahead[nearer] = d
        if not best.any():
            break
    return np.sqrt(best), ahead

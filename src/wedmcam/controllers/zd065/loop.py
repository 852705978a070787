"""The closed loop: cutting data whose vertices do not drift, however many blocks come before.

Copied literally, data carry the rounding of one block into the next: 18 um in a chain of 99 copies
[M]. Here every vertex is rounded once, a block is written from where the machine stands, and an arc
is tried by stepping until it arrives. So each vertex as stepped is within 1 um of the exact one. No
ZD-065 did this [R]. What the exact vertices are is for the data processing to say, in its 8-digit
arithmetic; the search for whole numbers here is proven by stepping, so float64 will do for it.

Arcs are tried all at once; those that no centre brings to their end are halved and tried again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.stepping import Bools, Floats, Ints, Stepping
from wedmcam.ir.program import BLOCK, Axis, Kind

#: One row per motion or control of an exact path. x, y: where it ends, um, in the frame of the path
#: (controls: where the machine stands). radius: of an arc, um. sweep: of an arc, degrees, above 0
#: up to 360, and consistent with the chord: 2 radius sin(sweep / 2). start: polar angle of the
#: start of an arc about its centre, degrees; read only above `LONG` degrees, where the chord is too
#: short to say where the centre is. source: number of the stated block.
EXACT = np.dtype(
    [
        ("kind", "u1"),
        ("turn", "i1"),
        ("x", "f8"),
        ("y", "f8"),
        ("radius", "f8"),
        ("sweep", "f8"),
        ("start", "f8"),
        ("source", "i8"),
    ]
)

#: Sweep above which the centre comes of the polar angle of the start, degrees.
LONG = 270.0
#: How far the circle of a block may stray from the stated one between its ends, um: with the um of
#: the steps and that of the ends it is to stay within 2 um of the drawing. A full circle in one
#: block has but one end, and strays by what its centre is rounded.
STRAY, RING_STRAY = 0.35, 1.0
#: Where an arc stands less than this from its chord, and no centre fits, a line does, um.
FLAT = 0.25
#: Candidate centres about the ideal one, um: the nearest 9, then the other 16 of 25.
_GRID = np.array([(i, j) for i in range(-2, 3) for j in range(-2, 3)])
_NEAR = np.abs(_GRID).max(axis=1) <= 1
RINGS = (_GRID[_NEAR], _GRID[~_NEAR])
#: Where along an arc its stray is measured, and how many arcs are tried at a time.
_SAMPLES = np.linspace(0.0, 1.0, 9)
_CHUNK = 2048

#: A motion, or a part of one. at, share: where it begins and how long it is, in parts of its row.
#: sx, sy: its exact start.
_PIECE = np.dtype(
    [*EXACT.descr, ("row", "i8"), ("at", "f8"), ("share", "f8"), ("sx", "f8"), ("sy", "f8")]
)


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """Cutting data that follow an exact path.

    Attributes:
        blocks: dtype `BLOCK`; ``source`` is the row of the path that a block comes of.
        ends: where each block ends as stepped, um in the frame of the path, int64, shape (n, 2).
        miss: for each row of the path how far its vertex as stepped is from the exact one, um.
        split: rows that are several blocks: no centre brings them to their end, or they are over a
            limit.
        dropped: motions without a block: they do not leave the um where they start.
    """

    blocks: NDArray[np.void]
    ends: Ints
    miss: Floats
    split: Ints
    dropped: Ints


@dataclass(frozen=True, slots=True)
class Most:
    """What one block holds at most, um; the ZD-065's [S]."""

    arc: int = 10_000_000
    count: int = 999_999
    line: int = 999_999


def follow(
    path: NDArray[np.void],
    stepping: Stepping = MIRROR,
    start: tuple[float, float] = (0.0, 0.0),
    *,
    axes: str = "square",
    most: Most | None = None,
) -> Followed:
    """Return cutting data that arrive within 1 um of every vertex of an exact path.

    Args:
        path: dtype `EXACT`.
        stepping: the interpolator that will run them.
        start: exact, where the path starts, um; the machine stands on the nearest whole um.
        axes: on what J of arcs is counted, ``square`` for the inscribed square, ``ends`` for the
            axis of the last step (3B).
        most: what one block holds; None for the ZD-065.

    >>> quarter = np.zeros(1, EXACT)
    >>> quarter[0] = (Kind.ARC, 1, -10_000.3, 10_000.3, 10_000.3, 90.0, 0.0, 0)
    >>> f = follow(quarter)
    >>> f.ends.tolist(), f.blocks["x"].tolist(), f.blocks["count"].tolist()
    ([[-10000, 10000]], [10000], [14143])
    """
    most = most or Most()
    left, split, parts = _whole_rows(path, start), np.zeros(len(path), np.bool_), []
    while len(left):
        blocks, good = _try(left, stepping, axes, most)
        parts.append((left[good], blocks[good]))
        split[left["row"][~good]] = True
        left = _halves(left[~good])
    pieces = np.concatenate([p for p, _ in parts]) if parts else left
    blocks = np.concatenate([b for _, b in parts]) if parts else np.zeros(0, BLOCK)
    order = np.lexsort((pieces["at"], pieces["row"]))
    pieces, blocks = pieces[order], blocks[order]
    blocks["source"] = pieces["row"]
    motion = pieces["kind"] <= Kind.MOVE
    steps = ~motion | (_from(pieces) != _to(pieces)).any(axis=1) | (blocks["count"] > 0)
    blocks = blocks[steps]
    run = stepping.run(blocks)
    ends = to_whole(np.array([start])) + np.cumsum(np.stack([run.dx, run.dy], axis=1), axis=0)
    # Where the machine stands behind each row: the end of the last block up to it.
    last = np.searchsorted(blocks["source"], np.arange(len(path)), side="right")
    stands = np.concatenate([to_whole(np.array([start])), ends])[last]
    miss = np.hypot(stands[:, 0] - path["x"], stands[:, 1] - path["y"])
    empty = np.bincount(blocks["source"], minlength=len(path)) == 0
    return Followed(blocks, ends, miss, np.flatnonzero(split), np.flatnonzero(empty))


def single_blocks(
    path: NDArray[np.void], starts: Floats, stepping: Stepping = MIRROR
) -> tuple[NDArray[np.void], Bools]:
    """Return for each row the one block that `follow` tries first, and whether it arrives.

    Args:
        path: dtype `EXACT`; each row for itself.
        starts: where each begins, um, shape (n, 2).
        stepping: the interpolator that will run them.
    """
    pieces = _whole_rows(path, (0.0, 0.0))
    pieces["sx"], pieces["sy"] = starts[:, 0], starts[:, 1]
    return _try(pieces, stepping, "square", Most())


def to_whole(um: Floats) -> Ints:
    """Return the nearest whole um, halves away from zero.

    >>> to_whole(np.array([0.5, -0.5, 2.4])).tolist()
    [1, -1, 2]
    """
    return np.trunc(um + np.copysign(0.5, um)).astype(np.int64)


def _whole_rows(path: NDArray[np.void], start: tuple[float, float]) -> NDArray[np.void]:
    """Return each row of a path as one piece."""
    pieces = np.zeros(len(path), _PIECE)
    for name in EXACT.names or ():
        pieces[name] = path[name]
    pieces["row"], pieces["share"] = np.arange(len(path)), 1.0
    for here, end, first in (("sx", "x", start[0]), ("sy", "y", start[1])):
        pieces[here] = np.append(first, path[end][:-1])[: len(path)]
    return pieces


def _from(pieces: NDArray[np.void]) -> Ints:
    return to_whole(np.stack([pieces["sx"], pieces["sy"]], axis=1))


def _to(pieces: NDArray[np.void]) -> Ints:
    return to_whole(np.stack([pieces["x"], pieces["y"]], axis=1))


def _try(
    pieces: NDArray[np.void], stepping: Stepping, axes: str, most: Most
) -> tuple[NDArray[np.void], Bools]:
    """Return a block for each piece, and which of them arrive within the limits."""
    blocks = np.zeros(len(pieces), BLOCK)
    blocks["kind"], blocks["turn"] = pieces["kind"], pieces["turn"]
    way = _to(pieces) - _from(pieces)
    arc = pieces["kind"] == Kind.ARC
    stays = (way == 0).all(axis=1) & ~(pieces["sweep"] > 180.0)
    arc &= ~stays  # without a block in the end
    good = np.ones(len(pieces), np.bool_)
    rows = np.flatnonzero(arc)
    for first in range(0, len(rows), _CHUNK):  # bounded memory
        some = rows[first : first + _CHUNK]
        blocks[some], good[some] = _arcs(pieces[some], stepping, axes, most)
    sag = 2.0 * pieces["radius"] * np.sin(np.radians(pieces["sweep"] / 4.0)) ** 2
    line = (pieces["kind"] == Kind.LINE) | (pieces["kind"] == Kind.MOVE)
    line |= arc & ~good & (sag <= FLAT)
    axis, count = stepping.line_count(way[:, 0], way[:, 1])
    blocks["kind"][line & arc], blocks["turn"][line] = Kind.LINE, 0
    blocks["x"][line], blocks["y"][line] = way[line, 0], way[line, 1]
    blocks["axis"][line], blocks["count"][line] = axis[line], count[line]
    good[line] = count[line] <= most.line
    return blocks, good


def _arcs(
    pieces: NDArray[np.void], stepping: Stepping, axes: str, most: Most
) -> tuple[NDArray[np.void], Bools]:
    """Return for each arc the block that strays least, and whether there is one."""
    n, begin, end = len(pieces), _from(pieces), _to(pieces)
    turn, sweep = pieces["turn"].astype(np.int64), pieces["sweep"]
    # Centres, relative to the start as the machine stands; ideal is the one through both ends.
    ideal = _centre(pieces, begin.astype(float), end.astype(float)) - begin
    blocks, least = np.zeros(n, BLOCK), np.full(n, np.inf)
    left = np.arange(n)
    for ring in RINGS:
        centre = to_whole(ideal[left])[:, None, :] + ring  # (n, candidates, 2)
        x, y = -centre[..., 0], -centre[..., 1]
        way = (end - begin)[left, None, :]
        ex, ey = way[..., 0] + x, way[..., 1] + y
        r2 = x * x + y * y
        usable = (r2 <= most.arc**2) & (r2 >= 2)
        come = stepping.arc_end(x, y, turn[left, None], ex, ey)
        if axes == "square":
            axis, count = np.full(r2.shape, int(Axis.SQUARE)), come.count_square
            usable &= come.square_counts
        else:
            axis = come.last_axis
            count = np.where(axis == Axis.X, come.count_x, come.count_y)
        usable &= come.landed & (count > 0) & (count <= most.count)
        # The long way round, where rounding put the end behind the start, is another arc.
        swept = np.degrees(np.arctan2(ey, ex) - np.arctan2(y, x)) * turn[left, None] % 360.0
        swept[(ex == x) & (ey == y)] = 360.0
        usable &= np.abs(swept - sweep[left, None]) <= 90.0
        stray = _stray(pieces[left], ideal[left], centre)
        most_stray = np.where(sweep[left] >= 360.0, RING_STRAY, STRAY)[:, None]
        cost = np.where(usable & (stray <= most_stray), stray, np.inf)
        best = np.argmin(cost, axis=1)
        at = np.arange(len(left)), best
        least[left] = cost[at]
        for name, value in (("x", x), ("y", y), ("axis", axis), ("count", count)):
            blocks[name][left] = value[at]
        left = left[np.isinf(least[left])]
        if not len(left):
            break
    blocks["kind"], blocks["turn"] = Kind.ARC, turn
    return blocks, np.isfinite(least)


def _centre(pieces: NDArray[np.void], begin: Floats, end: Floats) -> Floats:
    """Return the centres of arcs through ``begin`` and ``end``.

    At R cos(sweep / 2) from the chord: that, and not R about both ends, since near half a turn the
    um of a rounding would move the centre of a large circle by mm.
    """
    chord, middle = end - begin, 0.5 * (begin + end)
    length = np.hypot(chord[:, 0], chord[:, 1])
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.maximum(length, 1e-9)[:, None]
    height = pieces["turn"] * pieces["radius"] * np.cos(np.radians(pieces["sweep"] / 2.0))
    angle = np.radians(pieces["start"])
    exact = np.stack([pieces["sx"], pieces["sy"]], axis=1)
    exact -= pieces["radius"][:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    long = (pieces["sweep"] > LONG)[:, None]
    return np.where(long, exact, middle + height[:, None] * normal)


def _stray(pieces: NDArray[np.void], ideal: Floats, centre: Ints) -> Floats:
    """Return how far circles about ``centre`` stray from the one about ``ideal``, um.

    Both are relative to the start, through which both circles go.
    """
    first = np.arctan2(-ideal[:, 1], -ideal[:, 0])
    sweep = np.radians(pieces["sweep"]) * pieces["turn"]
    angle = first[:, None] + sweep[:, None] * _SAMPLES
    radius = np.hypot(ideal[:, 0], ideal[:, 1])[:, None]
    px = ideal[:, :1] + radius * np.cos(angle)
    py = ideal[:, 1:] + radius * np.sin(angle)
    off = np.hypot(px[:, None, :] - centre[..., :1], py[:, None, :] - centre[..., 1:])
    own = np.hypot(centre[..., 0], centre[..., 1])[..., None]
    return np.asarray(np.abs(off - own).max(axis=2))


def _halves(pieces: NDArray[np.void]) -> NDArray[np.void]:
    """Return the two halves of each piece, in no order."""
    begin = np.stack([pieces["sx"], pieces["sy"]], axis=1)
    end = np.stack([pieces["x"], pieces["y"]], axis=1)
    centre = _centre(pieces, begin, end)
    half = np.radians(pieces["sweep"] / 2.0) * pieces["turn"]
    out = begin - centre
    c, s = np.cos(half)[:, None], np.sin(half)[:, None]
    on_arc = centre + c * out + s * np.stack([-out[:, 1], out[:, 0]], axis=1)
    arc = (pieces["kind"] == Kind.ARC)[:, None]
    middle = np.where(arc, on_arc, 0.5 * (begin + end))
    first, second = pieces.copy(), pieces.copy()
    for part in (first, second):
        part["sweep"] *= 0.5
    second["start"] += np.degrees(half)
    first["x"], first["y"] = middle[:, 0], middle[:, 1]
    second["sx"], second["sy"] = middle[:, 0], middle[:, 1]
    for part in (first, second):
        part["share"] *= 0.5
    second["at"] += second["share"]
    return np.concatenate([first, second])

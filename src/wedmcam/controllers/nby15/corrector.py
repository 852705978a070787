"""The radius corrector: which tapes may be corrected, and by how much.

It changes the radius of every arc and nothing else [S]. The path then moves sideways as a whole
only where every block joins the next tangentially [S]: an arc that ends at degree k shifts the wire
along the normal at k, a line leaves it there, and the next arc has to begin at that very normal. So
fractions of a degree made as short lines break it, and programs of whole degrees alone may be
corrected [R]. The largest value that is safe is the smallest radius of the profile [S].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Kind

#: The corrector has three digits and a sign [S].
MOST_UM = 999
#: A line is tangent if it ends no farther beside the tangent than by the rounding of its ends, um.
BESIDE_UM = 1.5


@dataclass(frozen=True, slots=True)
class Correction:
    """Whether a tape may be corrected.

    Attributes:
        most_um: the largest value, either sign; 0 where it may not be.
        block: row of the tape (from 0) that sets it: the smallest arc, or where it breaks.
        why: "radius", or what is in the way: "corner", "fraction", "no-arc".
    """

    most_um: int
    block: int | None
    why: str


def correction(tape: NDArray[np.void]) -> Correction:
    """Return by how much a tape may be corrected.

    The first and the last line between two moves may be leads, and are not asked; nor are lines
    before the first arc and behind the last one of a path that is left open.

    >>> from wedmcam.controllers.nby15.data import TAPE
    >>> circle = np.zeros(1, TAPE)
    >>> circle[0] = (Kind.ARC, 1, 0, 0, 0, 400, 0, 360, -1, 0)
    >>> correction(circle)
    Correction(most_um=400, block=0, why='radius')
    """
    arcs = np.flatnonzero(tape["kind"] == Kind.ARC)
    if not len(arcs):
        return Correction(0, None, "no-arc")
    # The machine waits in the middle of a path: a pause alone begins no other one.
    rows = np.flatnonzero(tape["kind"] != Kind.PAUSE)
    t = tape[rows]
    edges = np.concatenate([[-1], np.flatnonzero(t["kind"] > Kind.ARC), [len(t)]])
    for low, high in zip((edges[:-1] + 1).tolist(), edges[1:].tolist(), strict=True):
        broken = _broken(t, low, high)
        if broken is not None:
            assert broken.block is not None
            return Correction(0, int(rows[broken.block]), broken.why)
    least = int(arcs[np.argmin(tape["radius"][arcs])])
    return Correction(min(int(tape["radius"][least]), MOST_UM), least, "radius")


def _broken(tape: NDArray[np.void], low: int, high: int) -> Correction | None:
    """Return where the blocks low to high - 1 do not join tangentially, by whole degrees."""
    t = tape[low:high]
    arc = t["kind"] == Kind.ARC
    where = np.flatnonzero(arc)
    if len(t) < 2 and not len(where):
        return None
    begin, end = _headings(t)
    first, last = (0, len(t))
    if len(t) and not arc[0]:
        first = 1
    if len(t) - first and not arc[-1]:
        last -= 1
    at: int | None = None  # heading of the wire, degrees
    opening, back = None, None
    for row in range(first, last):
        if arc[row]:
            if at is not None and (begin[row] - at) % 360:
                return Correction(0, low + row, _why(t, row))
            opening = int(begin[row]) if opening is None else opening
            at = int(end[row])
            continue
        x, y = float(t["x"][row]), float(t["y"][row])
        heading = at if at is not None else _whole(x, y)
        if heading is None or _beside(x, y, heading) > BESIDE_UM:
            return Correction(0, low + row, _why(t, row))
        opening = heading if opening is None else opening
        at = heading
    # Where the wire comes back to where it began it has to come along the same tangent.
    if at is not None and opening is not None and (at - opening) % 360 and _closes(t, first, last):
        back = low + last - 1
        return Correction(0, back, "corner")
    return None


def _headings(t: NDArray[np.void]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the heading of arcs where they begin and where they end, whole degrees."""
    turn = t["turn"].astype(np.int64)
    begin = t["start"] + 90 * turn
    return np.mod(begin, 360), np.mod(begin + turn * t["degrees"], 360)


def _whole(x: float, y: float) -> int | None:
    """Return the whole degree that a line runs along, None where it runs along none."""
    degree = int(np.rint(np.degrees(np.arctan2(y, x)))) % 360
    return degree if _beside(x, y, degree) <= BESIDE_UM else None


def _beside(x: float, y: float, degree: int) -> float:
    """Return how far beside a heading a line ends, um; endless where it runs against it."""
    c, s = np.cos(np.radians(degree)), np.sin(np.radians(degree))
    short = max(abs(x), abs(y)) <= 1  # a um that a rounding asked for
    if x * c + y * s < 0 and not short:
        return float("inf")
    return float(abs(y * c - x * s))


def _why(t: NDArray[np.void], row: int) -> str:
    """Return what is in the way at a joint: a fraction of a degree as a short line, or a corner."""
    lines = [k for k in (row - 1, row) if 0 <= k < len(t) and t["kind"][k] == Kind.LINE]
    radius = int(t["radius"].max())
    for k in lines:
        beside_arc = any(0 <= j < len(t) and t["kind"][j] == Kind.ARC for j in (k - 1, k + 1))
        if beside_arc and np.hypot(t["x"][k], t["y"][k]) <= 0.0182 * radius + 2:
            return "fraction"
    return "corner"


def _closes(t: NDArray[np.void], first: int, last: int) -> bool:
    """Return whether rows first to last - 1 come back to where they began, within some um."""
    from wedmcam.controllers.nby15.data import lines_of

    blocks, _ = lines_of(np.asarray(t[first:last]))
    return bool(max(abs(int(blocks["x"].sum())), abs(int(blocks["y"].sum()))) <= 4)

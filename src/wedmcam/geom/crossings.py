"""Where segments cross: exact line-line, line-circle and circle-circle crossings of many pairs.

Coincident pairs (collinear lines, arcs of one circle) have no crossing here: running along each
other they are no way from one to the other, and callers decide about them by distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wedmcam.arithmetic import FLOAT64
from wedmcam.geom import formulas
from wedmcam.geom.segments import Floats, Ints, Segments, position_of

#: How far past its ends a segment still counts as crossed, um: above the float64 noise of
#: coordinates of 10 m (2e-9 um) by far, below anything that a caller means.
REACH = 1e-5
#: Sine of the angle below which two lines are taken as parallel: 1 um over 10 km.
PARALLEL = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """Crossing k lies at (x, y), at arc length ``at_i`` of segment ``i`` and ``at_j`` of ``j``."""

    i: Ints
    j: Ints
    at_i: Floats
    at_j: Floats
    x: Floats
    y: Floats


def between(s: Segments, i: Ints, j: Ints) -> Crossings:
    """Return every crossing of segment i[k] with segment j[k], ends included."""
    ti, tj = s.turn[i] != 0, s.turn[j] != 0
    roots = []
    for kind, mask in (
        ("ll", ~ti & ~tj),
        ("la", ~ti & tj),
        ("al", ti & ~tj),
        ("aa", ti & tj),
    ):
        if not mask.any():
            continue
        a, b = i[mask], j[mask]
        if kind == "ll":
            roots.append(_line_line(s, a, b))
        elif kind == "la":
            roots.append(_line_arc(s, a, b, False))
        elif kind == "al":
            roots.append(_line_arc(s, b, a, True))
        else:
            roots.append(_arc_arc(s, a, b))
    if not roots:
        none = np.empty(0)
        return Crossings(np.empty(0, np.int64), np.empty(0, np.int64), none, none, none, none)
    columns = [np.concatenate([f[k] for f in roots]) for k in range(4)]
    return _within(s, columns[0], columns[1], columns[2], columns[3])


def _within(s: Segments, i: Ints, j: Ints, x: Floats, y: Floats) -> Crossings:
    """Keep the points that lie on both segments, and clamp their positions onto them."""
    si, sj = s.take(i), s.take(j)
    at_i, at_j = position_of(si, x, y), position_of(sj, x, y)
    keep = (at_i >= -REACH) & (at_i <= si.length + REACH)
    keep &= (at_j >= -REACH) & (at_j <= sj.length + REACH)
    return Crossings(
        i[keep],
        j[keep],
        np.clip(at_i[keep], 0.0, si.length[keep]),
        np.clip(at_j[keep], 0.0, sj.length[keep]),
        x[keep],
        y[keep],
    )


Found = tuple[Ints, Ints, Floats, Floats]


def _line_line(s: Segments, i: Ints, j: Ints) -> Found:
    cross = s.ux[i] * s.uy[j] - s.uy[i] * s.ux[j]
    k = np.abs(cross) > PARALLEL
    i, j = i[k], j[k]
    x, y = formulas.line_line(
        FLOAT64, (s.x0[i], s.y0[i]), (s.ux[i], s.uy[i]), (s.x0[j], s.y0[j]), (s.ux[j], s.uy[j])
    )
    return i, j, x, y


def _line_arc(s: Segments, line: Ints, arc: Ints, arc_first: bool) -> Found:
    """Return both roots; a line within REACH of touching gives its nearest point once."""
    wx, wy = s.cx[arc] - s.x0[line], s.cy[arc] - s.y0[line]
    across = np.abs(wx * s.uy[line] - wy * s.ux[line])
    k = across <= s.radius[arc] + REACH
    line, arc, across = line[k], arc[k], across[k]
    roots = []
    for root in (1.0, -1.0):
        two = across < s.radius[arc] if root < 0 else np.ones(len(arc), bool)
        ln, ac = line[two], arc[two]
        x, y = formulas.line_circle(
            FLOAT64,
            (s.x0[ln], s.y0[ln]),
            (s.ux[ln], s.uy[ln]),
            (s.cx[ac], s.cy[ac]),
            s.radius[ac],
            root,
        )
        roots.append((ac, ln, x, y) if arc_first else (ln, ac, x, y))
    return _joined(roots)


def _arc_arc(s: Segments, i: Ints, j: Ints) -> Found:
    apart = np.hypot(s.cx[j] - s.cx[i], s.cy[j] - s.cy[i])
    k = (apart > REACH) & (apart <= s.radius[i] + s.radius[j] + REACH)
    k &= apart >= np.abs(s.radius[i] - s.radius[j]) - REACH
    i, j, apart = i[k], j[k], apart[k]
    touching = (apart >= s.radius[i] + s.radius[j]) | (apart <= np.abs(s.radius[i] - s.radius[j]))
    roots = []
    for root in (1.0, -1.0):
        two = ~touching if root < 0 else np.ones(len(i), bool)
        a, b = i[two], j[two]
        x, y = formulas.circle_circle(
            FLOAT64, (s.cx[a], s.cy[a]), s.radius[a], (s.cx[b], s.cy[b]), s.radius[b], root
        )
        roots.append((a, b, x, y))
    return _joined(roots)


def _joined(roots: list[Found]) -> Found:
    first, second = roots
    return (
        np.concatenate([first[0], second[0]]),
        np.concatenate([first[1], second[1]]),
        np.concatenate([first[2], second[2]]),
        np.concatenate([first[3], second[3]]),
    )

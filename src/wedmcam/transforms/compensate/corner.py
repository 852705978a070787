"""What of an outline that the wire passes over is one inner corner, and what is too narrow for it.

A sharp inner corner keeps the radius of the wire, and that is a note: it cannot be cut otherwise.
The same corner with its tip cut off by a chamfer keeps less than that: the chamfer lies between the
corner and the wire, so what stays in front of it is within what the sharp corner of the same angle
would leave. It is judged as that corner. What else the wire leaves out is interference.

The boundary, so that a drawing is on one side of it whatever the offset:

- an arc that turns to the wire is a fillet. Whoever draws one means its radius: interference.
- one straight piece, split or not, is a chamfer, as long as it may be; two are one, too.
- more are a corner where each turns by `FACET` at least, or all of them are within `TIP_UM`. Many
  small turns are a fillet in lines.
- walls nearer to parallel than `SLOT` are a slot, its bottom is no chamfer (but within `TIP_UM`).
"""

from __future__ import annotations

import numpy as np

from wedmcam.geom.segments import TANGENT, Ints, end_tangents, start_tangents
from wedmcam.transforms.compensate.raw import Source

#: Facets of a corner turn by this at least (radians, 10 degrees); less approximates a curve: four
#: lines in a quarter circle turn by 11 degrees where they meet the walls.
FACET = np.radians(10.0)
#: Walls that would meet at less than this (radians, 30 degrees) are those of a slot.
SLOT = np.radians(30.0)
#: A tip cut off by no more than this is a tip, um: a wall as thin is no wall either.
TIP_UM = 50.0


def is_inner_corner(source: Source, a: int, b: int) -> bool:
    """Return whether what lies between segments a and b is one inner corner, or one leg of it.

    In a sharp inner corner the wire leaves its radius; where one leg is short, or the corner very
    acute, that takes the whole leg. The other leg (a or b itself) is still cut. A step or a slot
    has a second corner, and an inner corner between two lost legs is a notch: those are
    interference.

    Args:
        source: the segments of all contours; the wire runs beside them as ``shift`` says.
        a: the last segment that the wire reaches.
        b: the next one that it reaches, of the same contour.
    """
    s = source.segments
    chain = [a]
    while chain[-1] != b:
        chain.append(int(source.following[chain[-1]]))
        if chain[-1] < 0 or len(chain) > len(source.contour):
            return False
    rows = np.array(chain)
    side = float(np.sign(source.shift[a]))
    bent = s.turn[rows[1:-1]] * side
    if (bent > 0).any():
        return False
    t1x, t1y = end_tangents(s.take(rows[:-1]))
    t0x, t0y = start_tangents(s.take(rows[1:]))
    turning = np.arctan2(t1x * t0y - t1y * t0x, t1x * t0x + t1y * t0y) * side
    inner = np.flatnonzero(turning > TANGENT)
    if not len(inner):
        return False
    # Turns to the other side: of joints, and of the arcs between them.
    outer = np.concatenate([np.flatnonzero(turning < -TANGENT), np.flatnonzero(bent < 0) + 0.5])
    first, last = int(inner[0]), int(inner[-1])
    within = (outer > first) & (outer < last)
    if within.any() or ((outer < first).any() and (outer > last).any()):
        return False
    return first == last or _is_tip(source, rows[first + 1 : last + 1], turning[inner])


def _is_tip(source: Source, facets: Ints, turning: np.ndarray) -> bool:
    """Return whether straight facets cut off the tip of one corner; ``turning``: at their ends."""
    s = source.segments
    angle = np.pi - float(turning.sum())
    if angle <= 0:
        return False
    i, j = facets[0], facets[-1]
    if np.hypot(s.x1[j] - s.x0[i], s.y1[j] - s.y0[i]) <= TIP_UM:
        return True
    return angle >= SLOT and (len(turning) <= 3 or bool((turning >= FACET).all()))

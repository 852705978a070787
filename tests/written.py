"""Paths of programs as they are written: lines and arcs from where the machine stands, for tests.

The steps of a block lie within a um of it; here are the blocks themselves.
"""

import numpy as np
import shapely

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import Kind


def ends_of(blocks):
    """Return where blocks end as stepped, um from the start of the program."""
    m = MIRROR.run(blocks)
    return np.cumsum(np.stack([m.dx, m.dy], axis=1), axis=0)


def path_of(blocks, which=None, apart_um=20.0):
    """Return places on the path of some blocks (a mask; None for all), in order."""
    ends = ends_of(blocks)
    starts = np.concatenate([[[0, 0]], ends[:-1]])
    keep = np.ones(len(blocks), bool) if which is None else which
    points = []
    for b, (x0, y0), (x1, y1) in zip(
        blocks[keep], starts[keep].tolist(), ends[keep].tolist(), strict=True
    ):
        if b["kind"] == Kind.LINE:
            t = np.linspace(0, 1, 2 + int(np.hypot(x1 - x0, y1 - y0) / apart_um))
            points.append(np.stack([x0 + t * (x1 - x0), y0 + t * (y1 - y0)], axis=1))
        elif b["kind"] == Kind.ARC:
            cx, cy = x0 - int(b["x"]), y0 - int(b["y"])
            a0, a1 = np.arctan2(y0 - cy, x0 - cx), np.arctan2(y1 - cy, x1 - cx)
            turn = int(b["turn"])
            sweep = turn * (a1 - a0) % (2 * np.pi) or 2 * np.pi
            r0, r1 = np.hypot(x0 - cx, y0 - cy), np.hypot(x1 - cx, y1 - cy)
            t = np.linspace(0, 1, 3 + int(sweep * max(r0 / apart_um, 30)))
            r, a = r0 + t * (r1 - r0), a0 + turn * sweep * t
            points.append(np.stack([cx + r * np.cos(a), cy + r * np.sin(a)], axis=1))
    return np.concatenate(points)


def off_clearance(one, other, meant_um, near=None, within_um=np.inf):
    """Return how far the distance of two paths (places) is from what was meant, um, at most.

    Looked at from both sides, within a distance of a place.
    """
    worst = 0.0
    for a, b in ((one, other), (other, one)):
        line = shapely.LineString(b)
        shapely.prepare(line)
        some = a if near is None else a[np.hypot(*(a - near).T) < within_um]
        worst = max(worst, np.abs(shapely.distance(shapely.points(some), line) - meant_um).max())
    return worst

"""Corners between two arcs where the path must have the crossing of the two offset arcs.

``--corners paper`` puts no arc there: the ZD-065 intersects the neighbours. Where these do not meet
within four offsets of the corner the path would be another one than asked for, so that is said.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.geom import segments as seg
from wedmcam.geom.measure import segments_of
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate.raw import MITRE_LIMIT, gather, raw_offset
from wedmcam.transforms.corners import JOINED_UM

#: What a distance that was computed may be too large, um.
NOISE_UM = 0.01


def unmet(outline: Contour, shift: float, paths: Sequence[Contour]) -> list[Diagnostic]:
    """Return an error for each corner between arcs that the path does not have.

    Args:
        outline: whose corners with a line have their arcs.
        shift: how far the wire runs to the left of it, um (negative: right).
        paths: of the wire beside it.
    """
    source = gather([outline], [shift])
    s = source.segments
    k = np.where(source.following >= 0, source.following, 0)
    t1x, t1y = seg.end_tangents(s)
    t0x, t0y = seg.start_tangents(s)
    turn = np.arctan2(t1x * t0y[k] - t1y * t0x[k], t1x * t0x[k] + t1y * t0y[k])
    corner = (source.following >= 0) & (np.abs(turn) * abs(shift) >= JOINED_UM)
    rows = np.flatnonzero(corner & (s.turn != 0) & (s.turn[k] != 0))
    if not len(rows):
        return []
    raw = raw_offset(source, True)
    rounds = set(raw.source[raw.transition].tolist())
    findings = []
    for i in rows.tolist():
        x, y = float(s.x1[i] + source.origin[0]), float(s.y1[i] + source.origin[1])
        far = i in rounds
        if not far and turn[i] * shift > 0:  # an inner corner: how far is it cut off?
            far = _distance(paths, x, y) > MITRE_LIMIT * abs(shift) + NOISE_UM
        if far:
            findings.append(_far(outline, int(source.row[i]), x, y, abs(shift)))
    return findings


def _distance(paths: Sequence[Contour], x: float, y: float) -> float:
    least = np.inf
    for path in paths:
        s = segments_of(path.vertices, path.closed)
        d = seg.distances(s, np.full(len(s), x), np.full(len(s), y))
        least = min(least, float(d.min()))
    return least


def _far(outline: Contour, row: int, x: float, y: float, offset: float) -> Diagnostic:
    corner = Place.of_um(x, y)
    return error(
        "arcs-not-met",
        "at the corner at {corner} two arcs meet, and beside it, at {offset_mm:.3f} mm, they do "
        "not meet within {reach_mm:.3f} mm of it",
        outline.source_of(row),
        points_mm=(corner,),
        hint="--corners outer goes round it, --corner rounds it with --corners outer; or draw an "
        "arc there",
        corner=corner,
        offset_mm=offset / 1000,
        reach_mm=MITRE_LIMIT * offset / 1000,
    )

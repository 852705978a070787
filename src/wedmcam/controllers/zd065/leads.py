"""Leads of compensation data: those in the file, and those that an operator enters instead.

One file serves punch and die, and its leads do not: they come through what falls away on one side,
which on the other side is kept. So the leads are looked at where a gap and its side are known, and
lines of the operator replace them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.chains import Chain, chains_of, inside, places_of
from wedmcam.controllers.zd065.loop import LONG
from wedmcam.ir.program import Kind

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Way = tuple[int, int]
#: Lead-in and lead-out that are entered, um; None for those of the file.
Leads = tuple[Way | None, Way | None]

#: A lead may be so far on the wrong side of its path, um: roundings.
ASTRAY_UM = 2.0
#: How far polygons of the wire's path stand from its arcs, um.
FLAT_UM = 0.25


def entered_leads(
    figure: NDArray[np.void], lead_in: Way | None, lead_out: Way | None
) -> tuple[NDArray[np.void], str]:
    """Return an outline with the lines of the operator for its leads; why not, else empty.

    Args:
        figure: dtype `OUTLINE`: one contour with its lead lines.
        lead_in: from the thread point to where the outline starts, whole um; None for the file's.
            The machine moves its end by the gap, as it does with that of the file.
        lead_out: from there back, or elsewhere, likewise.

    >>> from wedmcam.controllers.zd065.data import OUTLINE
    >>> rows = [(0, -9), (10, 0), (0, 10), (-10, -10), (0, 9)]
    >>> f = np.array([(Kind.LINE, 0, 0, 0, 0, x, y, 0) for x, y in rows], OUTLINE)
    >>> out, why = entered_leads(f, (0, 2), (1, -2))
    >>> out["x"].tolist(), out["y"].tolist(), why
    ([0, 10, 0, -10, 1], [2, 0, 10, -10, -2], '')
    """
    chains = chains_of(figure, places_of(figure))
    if len(chains) != 1:
        return figure, "contours"
    (chain,) = chains
    out = figure.copy()
    for row, way in ((chain.lead_in, lead_in), (chain.lead_out, lead_out)):
        if way is None:
            continue
        if row < 0 or not chain.closed:
            return figure, "leads"
        if way == (0, 0):
            return figure, "length"
        out["x"][row], out["y"][row] = way
    return out, ""


class Astray(NamedTuple):
    """A lead that runs through what is kept.

    Attributes:
        row: of the outline, its line.
        depth_um: how far from the wire's path.
        kept_inside: what is kept is inside the contour.
        begins: number of the block with which the outline starts.
    """

    row: int
    depth_um: float
    kept_inside: bool
    begins: int


def leads_astray(path: NDArray[np.void], chains: Sequence[Chain], shift: Ints) -> list[Astray]:
    """Return the leads of closed contours that run on the side of the wire's path that is kept.

    Args:
        path: of the wire, dtype `EXACT`, ``source`` in ascending order.
        chains: of the outline.
        shift: of the wire to the left of each of them, um; with 0 nothing is kept.
    """
    ends = np.stack([path["x"], path["y"]], axis=1)
    starts = np.concatenate([np.zeros((1, 2)), ends[:-1]])
    source, out = path["source"], []
    for chain, by in zip(chains, shift.tolist(), strict=True):
        if not chain.closed or not by:
            continue
        first, last = chain.body[0], chain.body[chain.closed - 1]
        rows = slice(*np.searchsorted(source, [first, last + 1]))
        ring = _polygon(path[rows], starts[rows], ends[rows])
        x, y = ring.T
        left_inside = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) > 0
        kept_inside = left_inside == (by < 0)
        for lead in (chain.lead_in, chain.lead_out):
            if lead < 0:
                continue
            row = int(np.searchsorted(source, lead))
            depth = _depth(starts[row], ends[row], ring, kept_inside)
            if depth > ASTRAY_UM:
                out.append(Astray(lead, depth, kept_inside, int(first)))
    return out


def _polygon(rows: NDArray[np.void], starts: Floats, ends: Floats) -> Floats:
    """Return the places of a closed path, near enough to be a polygon."""
    moving = (rows["kind"] == Kind.LINE) | (rows["kind"] == Kind.ARC)
    rows, starts, ends = rows[moving], starts[moving], ends[moving]
    arc, turn = rows["kind"] == Kind.ARC, rows["turn"].astype(float)
    sweep, radius = np.radians(rows["sweep"]), np.maximum(rows["radius"], FLAT_UM)
    pieces = np.where(arc, np.ceil(sweep / (2 * np.arccos(1 - FLAT_UM / radius))), 1)
    pieces = np.maximum(pieces, 1).astype(np.int64)
    chord = np.arctan2(*(ends - starts).T[::-1])
    first = np.where(
        rows["sweep"] > LONG, np.radians(rows["start"]), chord - turn * (np.pi + sweep) / 2
    )
    k = np.repeat(np.arange(len(rows)), pieces)
    share = (np.arange(len(k)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[k]
    angle = first[k] + turn[k] * sweep[k] * share
    bow = np.stack([np.cos(angle) - np.cos(first[k]), np.sin(angle) - np.sin(first[k])], axis=1)
    return np.asarray(starts[k] + np.where(arc, rows["radius"], 0.0)[k, None] * bow)


def _depth(start: Floats, end: Floats, ring: Floats, kept_inside: bool) -> float:
    """Return how far from a polygon a line runs on the side that is kept, um."""
    way, edges = end - start, np.roll(ring, -1, axis=0) - ring
    to = ring - start
    across = way[0] * edges[:, 1] - way[1] * edges[:, 0]
    crossing = across != 0
    divisor = np.where(crossing, across, 1.0)
    at = (to[:, 0] * edges[:, 1] - to[:, 1] * edges[:, 0]) / divisor
    on = (to[:, 0] * way[1] - to[:, 1] * way[0]) / divisor
    crossing &= (at > 0) & (at < 1) & (on >= 0) & (on <= 1)
    shares = np.unique(np.concatenate([[0.0, 1.0], at[crossing]])).tolist()
    depth = 0.0
    for one, other in pairwise(shares):
        if inside(start + (one + other) / 2 * way, ring) == kept_inside:
            places = (start + share * way for share in (one, (one + other) / 2, other))
            depth = max(depth, *(_distance(place, ring, edges) for place in places))
    return depth


def _distance(place: Floats, ring: Floats, edges: Floats) -> float:
    """Return how far a place is from a polygon."""
    to = place - ring
    size = np.maximum((edges**2).sum(axis=1), 1e-9)
    along = np.clip((to * edges).sum(axis=1) / size, 0.0, 1.0)
    return float(np.hypot(*(to - along[:, None] * edges).T).min())

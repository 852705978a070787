"""Leads against the cuts that are not their own.

A lead that meets another cut frees what is still held there, or runs into a piece that is loose
already. That it keeps out of the material is measured with all other places (`material`); its own
path it meets where it arrives.
"""

from __future__ import annotations

import numpy as np

from wedmcam.diag import error
from wedmcam.ir.plan import outline_numbers
from wedmcam.ir.program import Role
from wedmcam.judge.followed import Followed
from wedmcam.judge.measured import Measured
from wedmcam.judge.route import Route
from wedmcam.judge.segments import (
    Ints,
    Segments,
    boxes,
    near_pairs,
    nearest,
    point_distance,
    points_at,
    segment_distance,
)

#: A lead and a wire path this near to each other meet, um: the noise of float64 and no more, since
#: a plan may lay a lead beside another cut as near as it likes.
MEETS = 1e-3
#: So near to its own path a lead has arrived, um: what it meets there lies in one kerf.
ARRIVES = 10.0


def meet_no_cut(f: Followed) -> Measured:
    """Report the first place at which leads of a cut meet another cut."""
    findings = [
        error(
            "lead-hits",
            "a lead of cut {cut} meets cut {other} at {place}",
            points_mm=(f.place(x, y),),
            hint="a lead may run in scrap only, and meet no other cut",
            cut=a + 1,
            other=b + 1,
            place=f.place(x, y),
        )
        for a, b, x, y in hits(
            f.route,
            np.array([a.cut for a in f.assigned]),
            np.array(outline_numbers(f.plan.cuts)),
            np.array(f.plan.plates),
        )
    ]
    return Measured(findings)


def hits(
    route: Route, number: Ints, outline: Ints, plate: Ints
) -> list[tuple[int, int, float, float]]:
    """Return where leads of a route meet wire paths of other cuts.

    Args:
        route: as the wire runs.
        number: of the cut of the plan, from 0, that each cut of the route is.
        outline: for each cut of the plan a number, shared by the passes of one outline: their leads
            may cross each other's paths.
        plate: for each cut of the plan, from which piece of material it is cut.

    Returns:
        (cut, other cut, x, y), the first place of each cut's leads; numbers of the plan.
    """
    lead = np.flatnonzero((route.role == Role.LEAD_IN) | (route.role == Role.LEAD_OUT))
    path = np.flatnonzero(route.role == Role.CONTOUR)
    leads, paths = route.segments.take(lead), route.segments.take(path)
    i, j = near_pairs(boxes(leads, 1.0), boxes(paths))
    mine, theirs = number[route.cut[lead[i]]], number[route.cut[path[j]]]
    other = (outline[mine] != outline[theirs]) & (plate[mine] == plate[theirs])
    i, j = i[other], j[other]
    if not len(i):
        return []
    met = segment_distance(leads.take(i), paths.take(j)) <= MEETS
    places: dict[int, tuple[int, int, float, float]] = {}
    for a, b in zip(i[met].tolist(), j[met].tolist(), strict=True):
        cut = int(route.cut[lead[a]])
        if cut in places:
            continue
        own = paths.take(route.cut[path] == cut)
        place = _place(leads.take(np.array([a])), paths.take(np.array([b])), own)
        if place is not None:
            places[cut] = int(number[cut]), int(number[route.cut[path[b]]]), *place
    return list(places.values())


def _place(lead: Segments, path: Segments, own: Segments) -> tuple[float, float] | None:
    """Return where a segment of a lead meets one of another path, away from its own path.

    Two cuts may have one path, or touch where a lead arrives: there the lead is on its own path.
    """
    low, high = 0.0, float(lead.length[0])
    every = np.zeros(257, np.int64)
    a, b = lead.take(every), path.take(every)
    xs, ys = [], []
    for _ in range(4):  # the grid grows finer about the nearest place
        t = np.linspace(low, high, len(every))
        x, y = points_at(a, t)
        d = point_distance(b, x, y)
        k = int(np.argmin(d))
        meets = d <= max(MEETS, float(d[k]))
        xs.append(x[meets])
        ys.append(y[meets])
        low, high = t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)]
    x, y = np.concatenate(xs)[::-1], np.concatenate(ys)[::-1]
    off, _ = nearest(own, x, y, ARRIVES)
    away = np.flatnonzero(off > ARRIVES)
    return (float(x[away[0]]), float(y[away[0]])) if len(away) else None

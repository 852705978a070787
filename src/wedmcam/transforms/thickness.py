"""Kept material that is too thin or too small to be meant: walls, fins, necks, and specks.

What is drawn is what is cut: a fin of 0.03 mm stands for a moment and breaks, and a circle of 2 um
that slipped into a drawing gets a thread point and a cut of its own. Both are warnings, with the
place. Material is measured as drawn; with the wire on the line, where no side is kept, it is what
lies inside of outer contours and not in holes.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import LISTED, Diagnostic, Place, Severity, error, warning
from wedmcam.geom import measure, thickness
from wedmcam.geom.segments import Ints, points_at
from wedmcam.ir.contour import Contour
from wedmcam.transforms.doubles import NOISE_UM, steady
from wedmcam.transforms.walls import TOUCH_UM, WALL_UM

#: No wire cuts what is smaller than this, um: the finest ones, of 0.02 mm, take it with their gap.
SMALL_HOLE_UM = 50.0
#: Points of each segment that say how large a contour is.
SHARES = np.linspace(0.0, 1.0, 9)[:-1]
#: How many points times segments are looked at at once: some 100 MB.
POINT_SEGMENTS = 2_000_000


def specks(
    contours: Sequence[Contour], inside: Sequence[bool], offsets: Sequence[float]
) -> tuple[list[Diagnostic], list[bool]]:
    """Return a warning for each closed contour that no wire makes, and which ones are that.

    A hole is one below `SMALL_HOLE_UM`. So is a piece of kept material, and one that is smaller
    than the cut that frees it: twice the offset.

    Args:
        contours: lines and arcs, um.
        inside: for each, whether the material inside of it is kept.
        offsets: for each, of the wire, um.
    """
    if not contours:
        return [], []
    box = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    kerf = np.where(inside, 2.0 * np.abs(offsets), 0.0)
    limit = np.maximum(kerf, SMALL_HOLE_UM)
    small = np.maximum(box[:, 2] - box[:, 0], box[:, 3] - box[:, 1]) < limit
    small &= np.array([c.closed for c in contours])
    findings = []
    for k in np.flatnonzero(small).tolist():
        size = _across(contours[k])
        small[k] = size < limit[k] - NOISE_UM
        if not small[k]:
            continue
        centre = Place.of_um(0.5 * (box[k, 0] + box[k, 2]), 0.5 * (box[k, 1] + box[k, 3]))
        findings.append(
            warning(
                "speck",
                "the contour at {place} is {size_mm:.4g} mm ({size_um:.4g} um) large, smaller than "
                "anything a wire cuts"
                if size < SMALL_HOLE_UM
                else "the contour at {place} is {size_mm:.4g} mm ({size_um:.4g} um) large, smaller "
                "than its own cut, {cut_mm:.3f} mm wide",
                contours[k].source_of(0),
                hint="delete it, if it is not meant",
                points_mm=(centre,),
                place=centre,
                size_mm=size / 1000,
                size_um=size,
                cut_mm=float(limit[k]) / 1000,
            )
        )
    if len(findings) > LISTED:
        more = len(findings) - LISTED
        summary = warning("speck", "{count} further contours as small as these", count=more)
        findings = [*findings[:LISTED], summary]
    return findings, small.tolist()


def _across(contour: Contour) -> float:
    """Return how far the farthest two points of a contour are apart, um."""
    s = measure.segments_of(contour.vertices, True)
    rows = np.repeat(np.arange(len(s)), len(SHARES))
    x, y = points_at(s.take(rows), np.tile(SHARES, len(s)) * s.length[rows])
    if len(x) > 1000:  # a speck of so many points is one all the same
        x, y = x[:: len(x) // 1000], y[:: len(y) // 1000]
    return float(np.hypot(x[:, None] - x, y[:, None] - y).max())


def thin_walls(
    contours: Sequence[Contour],
    part: bool,
    below_um: float,
    numbers: Sequence[int],
    close_pairs: Set[tuple[int, int]],
    taken: Sequence[float] = (),
) -> list[Diagnostic]:
    """Return a warning for each wall, fin or neck of kept material below a thickness.

    Tips are none, however acute, sharp or cut off by a chamfer or a fillet: two stretches that meet
    at a corner, or would. A wall is an error where a clearance leaves less than `WALL_UM` of it.

    Args:
        contours: closed ones of one part.
        part: what an odd number of them encloses is kept; False: the rest is.
        below_um: no wall is thinner on purpose; 0 for no warnings.
        numbers: of the contours, for ``close_pairs``.
        close_pairs: pairs of numbers, the lower first, that have a finding already.
        taken: for each contour, how far behind it the kept material begins; empty for nowhere.
    """
    behind = np.array(taken) if any(taken) else np.zeros(len(contours))
    most = max(below_um, WALL_UM) + 2.0 * float(behind.max(initial=0.0)) if any(taken) else below_um
    if most <= 0 or not contours:
        return []
    s, first = measure.segments_of_all([(c.vertices, True) for c in contours])
    owner = np.repeat(np.arange(len(contours)), np.diff(first, append=len(s)))
    w = thickness.walls(s, owner, most)
    size = np.asarray(w.size)
    lost = behind[owner[w.i]] + behind[owner[w.j]]
    none = (lost > 0) & (size - lost < WALL_UM)
    keep = (size > TOUCH_UM) & ((size - lost < below_um - NOISE_UM) | none)
    if close_pairs and keep.any():
        pair = np.sort(np.array(numbers)[np.stack([owner[w.i], owner[w.j]])], axis=0)
        keep &= np.array([p not in close_pairs for p in zip(*pair.tolist(), strict=True)], np.bool_)
    rows = np.flatnonzero(keep)
    if not len(rows):
        return []
    rows = _one_each(w, rows, first, owner, most)
    within = measure.Inside(s)
    step = max(1, POINT_SEGMENTS // len(s))
    chunks = [rows[k : k + step] for k in range(0, len(rows), step)]
    inside = np.concatenate([within(w.x[k], w.y[k]) for k in chunks])
    findings = []
    for k in rows[inside == part].tolist():
        a, b = (int(n) for n in (w.i[k], w.j[k]))
        ca, cb = contours[owner[a]], contours[owner[b]]
        spans = ca.source_of(a - int(first[owner[a]])), cb.source_of(b - int(first[owner[b]]))
        spans = tuple(sorted(spans, key=str))
        middle = Place.of_um(w.x[k], w.y[k])
        make = error if none[k] else warning
        wall = make(
            "thin-wall",
            "the wall between two contours is {size_mm:.4g} mm ({size_um:.4g} um) thick at {place}"
            if ca is not cb
            else "the wall between two stretches of one contour is {size_mm:.4g} mm "
            "({size_um:.4g} um) thick at {place}",
            spans[0],
            notes=(("its other side", spans[1]),),
            hint="nothing that can be proven (below {least_mm:.3f} mm) is left of it"
            if none[k]
            else "below --thin-wall ({least_mm:.3f} mm) a wall seldom stands: draw it thicker",
            points_mm=(middle,),
            place=middle,
            size_mm=float(w.size[k]) / 1000,
            size_um=float(w.size[k]),
            least_mm=(WALL_UM if none[k] else below_um) / 1000,
        )
        if lost[k]:
            wall = wall.extended(
                "; the clearance takes {clearance_mm:.3f} mm of it",
                clearance_mm=float(lost[k]) / 1000,
            )
        findings.append(wall)
    if len(findings) <= LISTED:
        return findings
    make = error if any(d.severity is Severity.ERROR for d in findings[LISTED:]) else warning
    more = len(findings) - LISTED
    return [
        *findings[:LISTED],
        make("thin-wall", "{count} further walls as thin as these", count=more),
    ]


def _one_each(w: thickness.Walls, rows: Ints, first: Ints, owner: Ints, near_um: float) -> Ints:
    """Return the thinnest place of each wall, in order of place.

    Places on the same two segments, or on neighbours of them, are of one wall; so are those within
    ``near_um`` of each other.
    """
    n = len(owner)
    order = np.lexsort((steady(w.x[rows]), steady(w.y[rows]), steady(w.size[rows])))
    rows = rows[order]
    low, high = np.minimum(w.i[rows], w.j[rows]), np.maximum(w.i[rows], w.j[rows])
    last = np.append(first[1:], n) - 1
    after, before = np.arange(1, n + 1), np.arange(-1, n - 1)
    after[last], before[first] = first, last
    codes = low * n + high
    by_code = np.argsort(codes, kind="stable")
    keys = codes[by_code]
    links: list[NDArray[np.int64]] = []
    for a in (low, after[low], before[low]):
        for b in (high, after[high], before[high]):
            wanted = np.minimum(a, b) * n + np.maximum(a, b)
            at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
            met = np.flatnonzero(keys[at] == wanted)
            links.append(np.stack([met, by_code[at[met]]]))
    one, other = np.concatenate(links, axis=1)
    label = np.arange(len(rows))
    while True:  # labels flow to the smallest, the thinnest place of each wall
        seen = label.copy()
        least = np.minimum(label[one], label[other])
        np.minimum.at(label, one, least)
        np.minimum.at(label, other, least)
        label = label[label]
        if (label == seen).all():
            break
    best = rows[np.flatnonzero(label == np.arange(len(rows)))]
    far = np.ones(len(best), np.bool_)
    for k in range(1, len(best)):  # the thinnest come first
        of = best[:k][far[:k]]
        far[k] = np.hypot(w.x[of] - w.x[best[k]], w.y[of] - w.y[best[k]]).min() > near_um
    best = best[far]
    return best[np.lexsort((steady(w.x[best]), steady(w.y[best])))]

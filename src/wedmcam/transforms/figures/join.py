"""Copies of open chains that meet become one chain: 36 slots are one closed contour.

A chain keeps its direction and the order in which its copies were made. Where more than two ends
meet it is open how the wire goes on, so nothing is joined there. What is left open when a ring
of copies closes (the closing defect: angles that do not add up to a turn, digits of the arithmetic)
is spread over all joints instead of being left to the last one; closure is exactly 0 then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.diag import Diagnostic, Place, Span, note, warning
from wedmcam.geom.measure import extents, length, middles
from wedmcam.geom.segments import Floats, of_rows
from wedmcam.ir.contour import Contour
from wedmcam.transforms.doubles import COPY_UM, NOISE_UM
from wedmcam.transforms.joints import near_pairs

#: Ends of chains this near to each other join, um (part language: within 1 um).
MEET_UM = 1.0

End = tuple[int, int]  # contour, 0 its start or 1 its end


def join_chains(
    contours: Sequence[Contour],
) -> tuple[tuple[Contour, ...], tuple[Diagnostic, ...]]:
    """Return the contours with open chains joined whose ends lie within `MEET_UM`.

    Returns:
        Closed contours and chains, each in the place of its first member and in that one's
        direction; a note on joins with the largest gap and the closing defect, and a warning where
        more than two ends meet.
    """
    opened = [k for k, c in enumerate(contours) if not c.closed]
    if not opened:
        return tuple(contours), ()
    other, crowded = _partners(contours, opened)
    findings: list[Diagnostic] = []
    if crowded:
        places = tuple(Place.of_um(x, y) for x, y in crowded)
        findings.append(
            warning(
                "figure-branch",
                "more than two ends of chains meet at {places}; nothing is joined there",
                points_mm=places,
                hint="draw what is copied so that each end meets one other end",
                places=places,
            )
        )
    used: set[int] = set()
    out: list[Contour] = []
    joined: list[_Joined] = []
    for k, c in enumerate(contours):
        if k in used:
            continue
        if c.closed:
            out.append(c)
            continue
        chain, ring = _walk(k, other)
        used.update(index for index, _ in chain)
        if len(chain) == 1 and not ring:
            out.append(c)
            continue
        merged = _merge([contours[i] if way else contours[i].reversed() for i, way in chain], ring)
        out.append(merged.contour)
        joined.append(merged)
    if joined:
        findings.append(_joined_note(joined))
    return tuple(out), tuple(findings)


def _partners(
    contours: Sequence[Contour], opened: list[int]
) -> tuple[dict[End, End], list[tuple[float, float]]]:
    """Return which end meets which, and the places at which more than two do."""
    ends: list[End] = [(k, side) for k in opened for side in (0, 1)]
    x = np.array([contours[k].vertices["x"][-side] for k, side in ends])
    y = np.array([contours[k].vertices["y"][-side] for k, side in ends])
    i, j, _ = near_pairs(x, y, MEET_UM)
    near: dict[int, list[int]] = {}
    for a, b in zip(i.tolist(), j.tolist(), strict=True):
        own = ends[a][0] == ends[b][0]
        if own and _short(contours[ends[a][0]]):
            continue  # a speck would vanish
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    other: dict[End, End] = {}
    crowded: list[tuple[float, float]] = []
    seen: set[int] = set()
    for a, met in near.items():
        if len(met) == 1 and len(near[met[0]]) == 1:
            other[ends[a]] = ends[met[0]]
        elif a not in seen:
            seen.update((a, *met))
            crowded.append((float(x[a]), float(y[a])))
    return other, crowded


def _short(c: Contour) -> bool:
    return length(c.vertices, False) <= 4 * MEET_UM


def _walk(first: int, other: dict[End, End]) -> tuple[list[tuple[int, bool]], bool]:
    """Return the members of a chain, each with whether it is run as it is, and if it closes."""

    def onwards(end: End) -> tuple[list[tuple[int, bool]], bool]:
        way: list[tuple[int, bool]] = []
        while (met := other.get(end)) is not None:
            k, side = met
            if k == first:
                return way, True
            way.append((k, side == 0))
            end = (k, 1 - side)
        return way, False

    ahead, ring = onwards((first, 1))
    if ring:
        return [(first, True), *ahead], True
    back, _ = onwards((first, 0))
    return [(k, not way) for k, way in reversed(back)] + [(first, True), *ahead], False


@dataclass(frozen=True, slots=True, eq=False)
class _Joined:
    contour: Contour
    pieces: int
    gap_um: float
    defect_um: float


def _merge(pieces: list[Contour], ring: bool) -> _Joined:
    """Return the pieces as one contour, joints closed to the digit."""
    n = len(pieces)
    rows = [p.vertices.copy() for p in pieces]
    joints = n if ring else n - 1
    start = np.array([(r["x"][0], r["y"][0]) for r in rows])
    end = np.array([(r["x"][-1], r["y"][-1]) for r in rows])
    gap = (np.roll(start, -1, axis=0) - end)[:joints]
    defect = gap.sum(axis=0) if ring else np.zeros(2)
    shift = _spread(gap, defect, ring, n)
    for r, (dx, dy) in zip(rows, shift, strict=True):
        r["x"] += dx
        r["y"] += dy
        arc = r["turn"] != 0
        r["cx"][arc] += dx
        r["cy"][arc] += dy
    for k in range(joints):
        _meet(rows[k], rows[(k + 1) % n])
    sources: list[Span] = []
    parts = []
    for r, p in zip(rows, pieces, strict=True):
        r["source"] = np.where(r["source"] >= 0, r["source"] + len(sources), -1)
        sources += p.sources
        parts.append(r[:-1])
    if not ring:
        parts.append(rows[-1][-1:])
    size = np.hypot(gap[:, 0], gap[:, 1])
    return _Joined(
        Contour(np.concatenate(parts), ring, tuple(sources)),
        n,
        float(size.max()),
        float(np.hypot(*defect)),
    )


def _spread(gap: Floats, defect: Floats, ring: bool, n: int) -> Floats:
    """Return by how much each piece moves as a whole, shape (n, 2), so that joints share alike.

    Piece k + 1 follows piece k but for its share of the defect. That is done only where no piece
    moves farther than the largest gap: gaps that turn with the copies and cancel (a slot drawn a
    little short) are closed better where they are.
    """
    still = np.zeros((n, 2))
    largest = float(np.hypot(gap[:, 0], gap[:, 1]).max())
    if not ring or float(np.hypot(*defect)) <= NOISE_UM * 1e-3:
        return still
    step = -gap + defect / n
    shift = np.concatenate([np.zeros((1, 2)), np.cumsum(step, axis=0)[:-1]])
    shift -= shift.mean(axis=0)
    return shift if float(np.hypot(shift[:, 0], shift[:, 1]).max()) <= largest else still


def _meet(a: np.ndarray, b: np.ndarray) -> None:
    """Move the end of ``a`` and the start of ``b`` to one point; arcs follow by half."""
    for at, c in (("x", "cx"), ("y", "cy")):
        e, s = float(a[at][-1]), float(b[at][0])
        if abs(s - e) <= NOISE_UM * 1e-3:
            b[at][0] = e  # float noise: the earlier piece stays as it is
            continue
        m = 0.5 * (e + s)
        if a["turn"][-2]:
            a[c][-2] += 0.5 * (m - e)
        if b["turn"][0]:
            b[c][0] += 0.5 * (m - s)
        a[at][-1] = b[at][0] = m


def _joined_note(joined: list[_Joined]) -> Diagnostic:
    rings = [j for j in joined if j.contour.closed]
    chains = len(joined) - len(rings)
    finding = note(
        "figure-join",
        "{pieces} chains became ",
        count=len(joined),
        pieces=sum(j.pieces for j in joined),
        closed=len(rings),
        open=chains,
        gap_um=max(j.gap_um for j in joined),
    )
    if rings:
        finding = finding.extended(
            "1 closed contour" if len(rings) == 1 else "{closed} closed contours"
        )
    if rings and chains:
        finding = finding.extended(" and ")
    if chains:
        finding = finding.extended("1 open chain" if chains == 1 else "{open} open chains")
    finding = finding.extended("; the largest gap was {gap_um:.3f} um")
    if not rings:
        return finding
    worst = max(rings, key=lambda j: j.defect_um)
    return finding.extended(
        ", the largest closing defect {defect_um:.3f} um, spread over 1 joint"
        if worst.pieces == 1
        else ", the largest closing defect {defect_um:.3f} um, spread over {joints} joints",
        defect_um=worst.defect_um,
        joints=worst.pieces,
    )


def drop_repeats(
    contours: Sequence[Contour], first_image: int, what: str
) -> tuple[tuple[Contour, ...], tuple[Diagnostic, ...]]:
    """Drop images that lie on an earlier contour within `COPY_UM`, and say so.

    Args:
        contours: originals, then images.
        first_image: index of the first image.
        what: made the images; for the message.
    """
    if len(contours) < 2:
        return tuple(contours), ()
    box = np.array([extents(c.vertices, c.closed) for c in contours])
    i, j, _ = near_pairs(0.5 * (box[:, 0] + box[:, 2]), 0.5 * (box[:, 1] + box[:, 3]), COPY_UM)
    gone: set[int] = set()
    for a, b in zip(i.tolist(), j.tolist(), strict=True):
        here = b >= first_image and a not in gone and b not in gone
        if here and np.abs(box[a] - box[b]).max() <= COPY_UM and _same(contours[a], contours[b]):
            gone.add(b)
    if not gone:
        return tuple(contours), ()
    at = contours[min(gone)].vertices
    first = Place.of_um(at["x"][0], at["y"][0])
    findings = warning(
        "duplicate",
        "{transform}: 1 image lies on what is there already (within {within_mm:.3f} mm) and is "
        "left out, the first at {first}"
        if len(gone) == 1
        else "{transform}: {count} images lie on what is there already (within {within_mm:.3f} mm) "
        "and are left out, the first at {first}",
        contours[min(gone)].source_of(0),
        points_mm=(first,),
        count=len(gone),
        transform=what,
        within_mm=COPY_UM / 1e3,
        first=first,
    )
    return tuple(c for k, c in enumerate(contours) if k not in gone), (findings,)


def _same(a: Contour, b: Contour) -> bool:
    """Whether every segment of the one lies on one of the other, by its middle."""
    if len(a) != len(b) or a.closed != b.closed:
        return False
    (ax, ay), (bx, by) = (middles(of_rows(c.starts, c.ends)) for c in (a, b))
    if len(a) == 1 and a.closed:  # circles: the box has said it, and middles go with the start
        return True
    i, j, _ = near_pairs(np.concatenate([ax, bx]), np.concatenate([ay, by]), COPY_UM)
    across = (i < len(ax)) & (j >= len(ax))
    return len(np.unique(i[across])) == len(ax) and len(np.unique(j[across])) == len(bx)

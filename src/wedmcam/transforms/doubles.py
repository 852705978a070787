"""What is drawn twice, or drawn without length: removed before anything is joined.

CAD users trace lines over lines, and exporters write an outline once per layer. A second copy would
be cut a second time, or turn every corner into a branch. Copies are found by distance, whatever
their direction and order; which one stays depends on the geometry alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Place, Span, note, warning
from wedmcam.geom.measure import middles
from wedmcam.geom.pairs import self_overlapping
from wedmcam.geom.segments import Floats, Segments, make

Rows = NDArray[np.void]

#: Pieces shorter than this have no length, um: a thousandth of the grid. It is also how far apart
#: float noise may put two ends that were drawn as one.
NOISE_UM = 1e-3
#: Two segments are the same where start, middle and end agree within this, um: one grid step ...
COPY_UM = 1.0
#: ... and within this share of their length, so that short neighbours stay two.
COPY_SHARE = 0.1


def steady(um: Floats) -> Floats:
    """Return keys to sort lengths by, without the digits that are float noise.

    In steps of `NOISE_UM`, off the round numbers: what is drawn at a round number, or halfway,
    must not lie on the border of two steps.
    """
    return np.asarray(np.floor(um / NOISE_UM + 0.3719))


def columns(rows: Rows) -> Segments:
    """Return the columns of `SEGMENT` rows with their derived figures."""
    names = ("x0", "y0", "x1", "y1", "cx", "cy")
    x0, y0, x1, y1, cx, cy = (np.ascontiguousarray(rows[k]) for k in names)
    return make(x0, y0, x1, y1, cx, cy, np.ascontiguousarray(rows["turn"]))


def forward(rows: Rows) -> Rows:
    """Return the rows run from their smaller end (x, then y); circles counter-clockwise.

    A circle starts at its right-most point. So equal geometry gives equal rows.
    """
    out = rows.copy()
    back = (rows["x1"] < rows["x0"]) | ((rows["x1"] == rows["x0"]) & (rows["y1"] < rows["y0"]))
    for a, b in (("x0", "x1"), ("y0", "y1")):
        out[a], out[b] = np.where(back, rows[b], rows[a]), np.where(back, rows[a], rows[b])
    out["turn"] = np.where(back, -rows["turn"], rows["turn"])
    ring = is_circle(rows)
    if ring.any():
        r = np.hypot(rows["x0"][ring] - rows["cx"][ring], rows["y0"][ring] - rows["cy"][ring])
        out["x0"][ring] = out["x1"][ring] = rows["cx"][ring] + r
        out["y0"][ring] = out["y1"][ring] = rows["cy"][ring]
        out["turn"][ring] = 1
    return out


def is_circle(rows: Rows) -> NDArray[np.bool_]:
    """Return which rows are full circles: start = end with a turn."""
    full = (rows["turn"] != 0) & (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
    return np.asarray(full, np.bool_)


def drop_zero_length(
    rows: Rows, sources: tuple[Span, ...]
) -> tuple[Rows, int, tuple[Diagnostic, ...]]:
    """Drop rows shorter than `NOISE_UM`; a short segment that has a length stays.

    Returns:
        The other rows, how many were dropped, and a note that says so.
    """
    s = columns(rows)
    gone = ~(s.length >= NOISE_UM)
    if not gone.any():
        return rows, 0, ()
    return rows[~gone], int(gone.sum()), (zero_length(rows[gone], sources),)


def zero_length(rows: Rows, sources: tuple[Span, ...]) -> Diagnostic:
    """Return the note about ``rows``, which were dropped."""
    first = rows[np.lexsort((rows["y0"], rows["x0"]))[0]]
    at = Place.of_um(first["x0"], first["y0"])
    return note(
        "zero-length",
        "a piece without length (under {least_um:.3f} um) dropped, the first at {first}"
        if len(rows) == 1
        else "{count} pieces without length (under {least_um:.3f} um) dropped, the first at "
        "{first}",
        span_of(first, sources),
        points_mm=(at,),
        count=len(rows),
        least_um=NOISE_UM,
        first=at,
    )


def span_of(row: np.void, sources: tuple[Span, ...]) -> Span | None:
    """Return where a row was drawn, or None."""
    at = int(row["source"])
    return sources[at] if 0 <= at < len(sources) else None


def drop_copies(rows: Rows, sources: tuple[Span, ...]) -> tuple[Rows, int, tuple[Diagnostic, ...]]:
    """Drop every segment that another one repeats, in whatever direction.

    Returns:
        The other rows, how many were dropped, and a note that says so. Of several copies the one
        stays whose forward row is smallest (arcs before lines), so order does not matter.
    """
    if len(rows) < 2:
        return rows, 0, ()
    ahead = forward(rows)
    keys = [ahead[k] for k in ("cy", "cx", "y1", "x1", "y0", "x0", "turn")]
    line = ahead["turn"] == 0
    keys[0], keys[1] = np.where(line, 0.0, keys[0]), np.where(line, 0.0, keys[1])
    order = np.lexsort((*keys, line))
    same = np.ones(len(rows), np.bool_)
    same[0] = False
    for k in keys:
        same[1:] &= k[order][1:] == k[order][:-1]
    kept = order[~same]  # one of each exact copy, in order of rank
    original = {}
    if same.any():
        run = np.cumsum(~same) - 1
        original = dict(zip(order[same].tolist(), kept[run[same]].tolist(), strict=True))
    _near_copies(ahead, kept, original)
    if not original:
        return rows, 0, ()
    gone = np.fromiter(original, np.int64, len(original))
    keep = np.ones(len(rows), np.bool_)
    keep[gone] = False
    first = ahead[gone[np.lexsort((ahead["y0"][gone], ahead["x0"][gone]))[0]]]
    at = Place.of_um(first["x0"], first["y0"])
    slits = _slits(rows, gone, original)
    finding = note(
        "duplicate",
        "1 segment is drawn twice (within {within_mm:.3f} mm); the copies are left out, the first "
        "at {first}"
        if len(gone) == 1
        else "{count} segments are drawn twice (within {within_mm:.3f} mm); the copies are left "
        "out, the first at {first}",
        span_of(first, sources),
        points_mm=(at,),
        count=len(gone),
        within_mm=COPY_UM / 1e3,
        first=at,
    )
    return rows[keep], len(gone), (finding, *_slit_findings(ahead, slits, sources))


def _slits(rows: Rows, gone: NDArray[np.int64], original: dict[int, int]) -> list[int]:
    """Return copies that are another side of the same entity, and lie beside it: no trace of it."""
    kept = np.array([original[k] for k in gone.tolist()])
    same = rows["source"][gone] == rows["source"][kept]
    beside = np.zeros(len(gone), np.bool_)
    a, b = forward(rows[gone]), forward(rows[kept])
    for name in ("x0", "y0", "x1", "y1"):
        beside |= np.abs(a[name] - b[name]) > NOISE_UM
    return [int(k) for k in gone[same & beside & (rows["source"][gone] >= 0)]]


def _slit_findings(
    ahead: Rows, slits: list[int], sources: tuple[Span, ...]
) -> tuple[Diagnostic, ...]:
    """Return a warning about pairs of sides of one entity: one of each is left out."""
    if not slits:
        return ()
    first = ahead[slits[0]]
    at = Place.of_um(first["x0"], first["y0"])
    return (
        warning(
            "duplicate",
            "two sides of one entity lie within {within_mm:.3f} mm of each other, at {first}: "
            "a slit; one of the two is left out"
            if len(slits) == 1
            else "{count} pairs of sides of one entity lie within {within_mm:.3f} mm of each "
            "other, at {first}: a slit; one of the two is left out",
            span_of(first, sources),
            hint="draw it as one line, or wider than the wire",
            points_mm=(at,),
            count=len(slits),
            within_mm=COPY_UM / 1e3,
            first=at,
        ),
    )


def _near_copies(ahead: Rows, kept: NDArray[np.int64], original: dict[int, int]) -> None:
    """Add to ``original`` the rows of ``kept`` (by rank) that nearly repeat an earlier one."""
    s = columns(ahead[kept])
    mx, my = middles(s)
    tol = np.minimum(COPY_UM, COPY_SHARE * s.length)
    i, j = self_overlapping((mx - tol / 2, my - tol / 2, mx + tol / 2, my + tol / 2))
    if not len(i):
        return
    t = np.minimum(tol[i], tol[j])

    def near(ax: Floats, ay: Floats, bx: Floats, by: Floats) -> NDArray[np.bool_]:
        return np.asarray(np.hypot(ax[i] - bx[j], ay[i] - by[j]) <= t)

    straight = near(s.x0, s.y0, s.x0, s.y0) & near(s.x1, s.y1, s.x1, s.y1)
    back = near(s.x0, s.y0, s.x1, s.y1) & near(s.x1, s.y1, s.x0, s.y0)
    same = near(mx, my, mx, my) & (straight | back)
    gone: set[int] = set()
    for a, b in zip(i[same].tolist(), j[same].tolist(), strict=True):
        if a not in gone and b not in gone:
            gone.add(b)
            original[int(kept[b])] = int(kept[a])

"""A picture of a drawing that is refused: everything that was read, and a number at each place.

Segments that branch belong to no one contour, so contours cannot be drawn. The segments are drawn
as they were read, and the places of findings are ringed, numbered, and listed in the title block.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.reports.picture.program import OUTLINE, _mark, _Segments, _stroke
from wedmcam.reports.picture.sheet import Box, Sheet, number, union
from wedmcam.reports.picture.threads import draw_threads

#: Above so many segments they are one path, without tool tips.
DETAILED = 4000
#: So many places are listed in the title block.
LISTED = 24
#: Colour of what is drawn and not read.
NOT_READ = "#b45309"
#: Around places that are far smaller than the drawing nothing is enlarged; a lone point gets this.
LEAST_MM = 1.0


def plot_refused(
    rows: NDArray[np.void],
    marks: Sequence[Diagnostic],
    *,
    unread: NDArray[np.void] | None = None,
    thread_points: Sequence[ThreadPoint] = (),
    title: str = "",
    facts: Mapping[str, str] | None = None,
) -> str:
    """Return an SVG picture of segments as they were read, with the places of findings numbered.

    Args:
        rows: `SEGMENT` rows, um, drawing coordinates; at least one.
        unread: likewise the boundaries of what is not read; drawn dashed.
        marks: findings with ``points_mm``: each has a number, in their order.
        thread_points: start holes.
        title: printed large; the file's name.
        facts: printed in the title block before the list of places.
    """
    shape = _of_rows(rows)
    boxes: list[Box] = [shape.box()]
    others = None if unread is None or not len(unread) else _of_rows(unread)
    if others is not None:
        boxes.append(others.box())
    boxes += [(p.x / 1000, p.y / 1000, p.x / 1000, p.y / 1000) for p in thread_points]
    boxes += [(x, y, x, y) for d in marks for x, y in d.points_mm]
    x0, y0, x1, y1 = union(boxes)
    if max(x1 - x0, y1 - y0) < LEAST_MM / 1000:
        x0, y0, x1, y1 = x0 - LEAST_MM, y0 - LEAST_MM, x1 + LEAST_MM, y1 + LEAST_MM
    entries = {**(facts or {}), **number_findings(marks)}
    sheet = Sheet((x0, y0, x1, y1), title, len(entries))
    if others is not None:
        dashes = f'stroke-dasharray="{sheet.mm(6)} {sheet.mm(4.5)}"'
        sheet.draw(
            f'<path id="not-read" d="{"".join(_paths(others))}" stroke="{NOT_READ}" '
            f'stroke-width="{sheet.mm(1.2)}" {dashes}/>'
        )
    paths = _paths(shape)
    sheet.draw(
        f'<path id="read" d="{"".join(paths)}" stroke="{OUTLINE}" stroke-width="{sheet.mm(1.2)}"/>'
    )
    if len(paths) <= DETAILED:
        ends = sorted({*zip(shape.x0.tolist(), shape.y0.tolist(), strict=True)})
        ends += sorted({*zip(shape.x1.tolist(), shape.y1.tolist(), strict=True)})
        dots = (sheet.at(x, y) for x, y in dict.fromkeys(ends))
        d = "".join(f"M{number(u, 2)} {number(v, 2)}h0" for u, v in dots)
        sheet.symbol(f'<path d="{d}" stroke="{OUTLINE}" stroke-width="3" stroke-linecap="round"/>')
    sheet.dimension(shape.box(), (x0, y0, x1, y1))
    places = [(point.x / 1000, point.y / 1000) for point in thread_points]
    crosses = [(x, y, "T", f"thread point at ({x:.3f}, {y:.3f}) mm") for x, y in places]
    _mark(sheet, marks)
    legend = [(_stroke(OUTLINE, 1.2), "as read"), *draw_threads(sheet, crosses)]
    if others is not None:
        legend.append((_stroke(NOT_READ, 1.2, "6 4.5"), "not read"))
    if any(d.points_mm for d in marks):
        ring = '<circle cx="14" cy="6" r="5" fill="none" stroke="#d00000" stroke-width="2"/>'
        legend.append((ring, "what is wrong"))
    text = (
        f"{len(rows)} segments as read, {len(number_findings(marks))} findings; coordinates in mm"
    )
    return sheet.print(text, entries, legend)


def _paths(shape: _Segments) -> list[str]:
    starts = [f"M{number(x)} {number(y)}" for x, y in zip(shape.x0, shape.y0, strict=True)]
    return [start + command for start, command in zip(starts, shape.commands(), strict=True)]


def number_findings(marks: Sequence[Diagnostic]) -> dict[str, str]:
    """Return the numbers of findings with code and first place, for the title block."""
    placed = [d for d in marks if d.points_mm]
    out = {}
    for n, d in enumerate(placed[:LISTED], 1):
        x, y = d.points_mm[0]
        out[f"{n} {d.severity}"] = f"{d.code} ({number(x, 2)}, {number(y, 2)})"
    if len(placed) > LISTED:
        out["and"] = f"{len(placed) - LISTED} more"
    return out


def _of_rows(rows: NDArray[np.void]) -> _Segments:
    """Return `SEGMENT` rows in mm."""
    x0, y0, x1, y1, cx, cy = (
        rows[name].astype(float) / 1000 for name in ("x0", "y0", "x1", "y1", "cx", "cy")
    )
    turn = rows["turn"].astype(float)
    turned = np.arctan2(y1 - cy, x1 - cx) - np.arctan2(y0 - cy, x0 - cx)
    full = (x0 == x1) & (y0 == y1)
    sweep = np.where(full, math.tau, np.mod(turned * turn, math.tau))
    sweep = np.where(turn == 0, 0.0, sweep * turn)
    return _Segments(x0, y0, x1, y1, cx, cy, sweep)

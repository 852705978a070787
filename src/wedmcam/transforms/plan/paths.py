"""The wire paths of a scene, and where the wire does not fit.

All contours of a scene are offset together, so that the wire beside one keeps away from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, error, has_errors, note, warning
from wedmcam.ir.contour import Contour
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.compensate import Interference, compensate
from wedmcam.transforms.plan.options import Cutting
from wedmcam.transforms.plan.pieces import Piece
from wedmcam.transforms.plan.scenes import PieceScene
from wedmcam.transforms.plan.shaped import ShapedCut
from wedmcam.transforms.plan.wording import Wording

#: Places of interference that are listed; a summary stands for the rest.
LISTED = 10


@dataclass(frozen=True, slots=True, eq=False)
class PlannedPath:
    """A wire path that wants a lead.

    Attributes:
        path: the wire path, in cutting direction.
        outline: what it was made from; None for ``on`` open paths.
        scrap_left: scrap to the left (True) or right of the path; None where there is none (on).
        offset_um: how far the path is from the outline towards scrap.
        contour: number of the outline; several paths may share one.
        parent: number of the outline directly around it, -1 for none.
        lead_um: length of a lead that nobody stated; None for the usual one.
        enter: where the lead arrives: at the point of the path nearest to this, um, and where
            that was stated; None for the point nearest to the thread point.
    """

    path: Contour
    outline: Contour
    scrap_left: bool | None
    offset_um: float
    contour: int = 0
    parent: int = -1
    lead_um: float | None = None
    enter: ThreadPoint | None = None


def planned_paths(
    scene: PieceScene,
    cuts: Sequence[ShapedCut],
    cutting: Cutting,
    ar: Arithmetic,
    words: Wording,
) -> tuple[list[PlannedPath] | None, list[Diagnostic]]:
    """Return the wire paths of a scene, each in the direction in which the wire runs it."""
    contours = [p.contour for p in scene.pieces]
    shifts = [p.shift for p in scene.pieces]
    found: list[Diagnostic] = []
    sided = scene.pieces[0].outside is not None
    if any(shifts):
        result, found = compensate(contours, shifts, arithmetic=ar, sharp=cutting.sharp)
        if found:
            return None, found
        found += interference(contours, shifts, result.interference, cutting.trim)
        rounded = any(p.rounded for p in scene.pieces)
        if result.inner_corners and result.paths and sided and not rounded:
            wire = max(p.offset + p.clearance for p in scene.pieces)
            found.append(_inner_corners(result.inner_corners, wire, words))
        paths = [(p.outline, p.path) for p in result.paths]
    else:
        paths = list(enumerate(contours))
    planned = []
    for k, path in paths:
        piece = scene.pieces[k]
        one = PlannedPath(
            path,
            contours[k],
            piece.scrap_left,
            piece.offset,
            k,
            scene.nesting.parents[k],
            cuts[piece.cut].item.lead,
            cuts[piece.cut].enter,
        )
        planned.append(_run(one, piece))
    return (None if has_errors(found) else planned), found


def _run(planned: PlannedPath, piece: Piece) -> PlannedPath:
    """Return the path in the direction in which the wire runs it."""
    if not piece.reverse:
        return planned
    return replace(
        planned,
        path=planned.path.reversed(),
        outline=planned.outline.reversed(),
        scrap_left=None if planned.scrap_left is None else not planned.scrap_left,
    )


def _inner_corners(count: int, wire_um: float, words: Wording) -> Diagnostic:
    return note(
        "inner-corners",
        f"{count} sharp inner corner{' keeps' if count == 1 else 's keep'} the radius of the wire, "
        f"{wire_um / 1000:.3f} mm",
        hint=f"{words.corner} rounds the part's own corners, so that punch and die fit",
    )


def interference(
    contours: Sequence[Contour],
    shifts: Sequence[float],
    places: Sequence[Interference],
    trim: bool,
) -> list[Diagnostic]:
    """Return a finding for each place where the wire does not fit: error, or warning if trimmed."""
    if not places:
        return []
    from wedmcam.transforms.compensate.largest import largest_offset

    make = warning if trim else error
    offset = max(map(abs, shifts)) / 1000
    hints: dict[int, str] = {}
    alone: set[int] = set()  # those that would fit without their neighbours
    found = []
    for item in places[:LISTED]:
        contour = contours[item.outline]
        if item.outline not in hints:
            sign = float(np.sign(shifts[item.outline]))
            most = largest_offset([contour], [sign], 1000.0 * offset).nearest_um
            fits = not compensate([contour], [sign * most])[0].interference
            if fits and most >= 1000.0 * offset:
                alone.add(item.outline)
            hints[item.outline] = (
                f"{'at most' if fits else 'less than'} {most / 1000:.3f} mm fits this contour"
            )
            if not trim and item.kind != "vanished":  # trimmed, nothing is left of that one
                hints[item.outline] += "; --on-interference trim cuts what the wire can reach"
        kind, (x, y) = item.kind, item.at
        if kind == "vanished" and item.outline in alone:
            # Of circles in each other the paths change places and cross nowhere.
            kind, (x, y) = "neighbour", (float(v) for v in contour.vertices[0][["x", "y"]])
        x, y = x / 1000, y / 1000
        place = f"({x:.3f}, {y:.3f}) mm"
        lost = f", {len(item.rows)} segments are not reached" if len(item.rows) > 1 else ""
        if kind == "radius":
            text = (
                f"the inside radius {item.size / 1000:.3f} mm at {place} is smaller than the "
                f"offset {offset:.3f} mm{lost}"
            )
        elif kind == "neighbour":
            text = f"the wire beside this contour meets another contour at {place}"
        elif kind == "vanished":
            text = f"the contour at {place} is too small for the offset {offset:.3f} mm"
            text += ": it is not cut" if trim else ""
        else:
            text = f"a passage at {place} is too narrow for a wire at offset {offset:.3f} mm{lost}"
        found.append(
            make(
                "interference",
                text,
                contour.source_of(item.row),
                points_mm=((x, y),),
                hint=hints[item.outline] if kind != "neighbour" else None,
            )
        )
    if len(places) > LISTED:
        more = len(places) - LISTED
        found.append(make("interference", f"{more} further places like these", count=more))
    return found

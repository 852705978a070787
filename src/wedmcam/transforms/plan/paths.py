"""The wire paths of a scene, and where the wire does not fit.

All contours of a scene are offset together, so that the wire beside one keeps away from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, Place, error, has_errors, note, warning
from wedmcam.ir.contour import Contour
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.compensate import Interference, compensate
from wedmcam.transforms.compensate.between import unmet
from wedmcam.transforms.plan.options import Cutting
from wedmcam.transforms.plan.pieces import Piece
from wedmcam.transforms.plan.scenes import PieceScene
from wedmcam.transforms.plan.shaped import ShapedCut
from wedmcam.transforms.plan.wording import Wording

#: Places of interference that are listed; a summary stands for the rest.
LISTED_PLACES = 10


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
        lead_um: length of the lead, where its thread point is chosen; None for the usual one.
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
    findings: list[Diagnostic] = []
    sided = scene.pieces[0].outside is not None
    if any(shifts):
        sharp = [cutting.sharp or p.paper for p in scene.pieces]
        result, findings = compensate(contours, shifts, arithmetic=ar, sharp=sharp)
        if findings:
            return None, findings
        if not result.interference:
            for k, piece in enumerate(scene.pieces):
                if piece.paper and piece.shift:
                    own = [p.path for p in result.paths if k in p.outlines]
                    findings += unmet(contours[k], piece.shift, own)
        findings += interference(contours, shifts, result.interference, cutting.trim)
        rounded = any(p.rounded for p in scene.pieces)
        if result.inner_corners and result.paths and sided and not rounded:
            wire = max(p.offset + p.clearance for p in scene.pieces)
            findings.append(_inner_corners(result.inner_corners, wire, words))
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
    return (None if has_errors(findings) else planned), findings


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
        "1 sharp inner corner keeps the radius of the wire, {radius_mm:.3f} mm"
        if count == 1
        else "{corners} sharp inner corners keep the radius of the wire, {radius_mm:.3f} mm",
        hint="{option} rounds the part's own corners, so that punch and die fit",
        corners=count,
        radius_mm=wire_um / 1000,
        option=words.corner,
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

    offset = max(map(abs, shifts)) / 1000
    cures: dict[int, _Cure] = {}
    alone: set[int] = set()  # those that would fit without their neighbours
    findings = []
    for item in places[:LISTED_PLACES]:
        contour = contours[item.outline]
        if item.outline not in cures:
            sign = float(np.sign(shifts[item.outline]))
            most = largest_offset([contour], [sign], 1000.0 * offset).nearest_um
            fits = not compensate([contour], [sign * most])[0].interference
            if fits and most >= 1000.0 * offset:
                alone.add(item.outline)
            # Trimmed, nothing is left of a contour that vanishes.
            trims = not trim and item.kind != "vanished"
            cures[item.outline] = _Cure(most / 1000, fits, trims)
        findings.append(
            _interference(item, contour, offset, trim, cures[item.outline], item.outline in alone)
        )
    if len(places) > LISTED_PLACES:
        make = warning if trim else error
        more = len(places) - LISTED_PLACES
        findings.append(make("interference", "{count} further places like these", count=more))
    return findings


@dataclass(frozen=True, slots=True)
class _Cure:
    """What helps a contour in which the wire does not fit.

    ``most_mm``: the offset up to which it does, ``fits`` with it too; ``trims``: to trim it helps.
    """

    most_mm: float
    fits: bool
    trims: bool


def _interference(
    item: Interference, contour: Contour, offset_mm: float, trim: bool, cure: _Cure, alone: bool
) -> Diagnostic:
    """Return the finding about a place where the wire does not fit.

    ``alone``: the contour would fit without its neighbours.
    """
    kind, place = item.kind, Place.of_um(*item.at)
    if kind == "vanished" and alone:
        # Of circles in each other the paths change places and cross nowhere.
        kind, place = "neighbour", Place.of_um(*contour.vertices[0][["x", "y"]])
    make = warning if trim else error
    if kind == "neighbour":
        return make(
            "interference",
            "the wire beside this contour meets another contour at {place}",
            contour.source_of(item.row),
            points_mm=(place,),
            place=place,
        )
    finding = make(
        "interference",
        "the inside radius {radius_mm:.3f} mm at {place} is smaller than the offset "
        "{offset_mm:.3f} mm"
        if kind == "radius"
        else "the contour at {place} is too small for the offset {offset_mm:.3f} mm"
        if kind == "vanished"
        else "a passage at {place} is too narrow for a wire at offset {offset_mm:.3f} mm",
        contour.source_of(item.row),
        points_mm=(place,),
        hint="at most {most_mm:.3f} mm fits this contour"
        if cure.fits
        else "less than {most_mm:.3f} mm fits this contour",
        radius_mm=item.size / 1000 if kind == "radius" else None,
        place=place,
        offset_mm=offset_mm,
        most_mm=cure.most_mm,
    )
    if kind == "vanished" and trim:
        finding = finding.extended(": it is not cut")
    if kind != "vanished" and len(item.rows) > 1:
        finding = finding.extended(", {segments} segments are not reached", segments=len(item.rows))
    if cure.trims:
        finding = finding.extended(hint="; --on-interference trim cuts what the wire can reach")
    return finding

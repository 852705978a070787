"""The contours of a cut, each with the side on which the wire runs, its offset and its direction.

A side is named for the outermost contours of a figure; what lies in an odd number of them is on the
other one, as in a drawing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, Place, TextSpan, error, has_errors
from wedmcam.geom import measure
from wedmcam.ir.contour import Contour
from wedmcam.transforms import figures
from wedmcam.transforms.corners import round_corners, transition_arcs
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.nest import nest
from wedmcam.transforms.plan.idle import Used
from wedmcam.transforms.plan.options import Cutting
from wedmcam.transforms.plan.shaped import ShapedCut


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A contour to cut.

    Attributes:
        cut: number of the cut it belongs to.
        contour: as it is run.
        outside: the wire runs outside of it; None for an open contour or ``on``.
        shift: how far the wire runs to the left, um (negative: right).
        scrap_left: what falls away is to the left of the contour; None where nothing does.
        offset: how far the wire runs from the contour towards what falls away, um; below 0 it runs
            in what is drawn as kept.
        clearance: how far behind the contour the kept material begins, um.
        reverse: the wire runs the contour the other way, on the same path.
        rounded: its sharp corners were rounded.
        cornered: the contour as it was before its corners had arcs; None where that is the contour.
        corner: radius of these arcs, um; 0 for none.
        paper: corners between arcs stay, and their offset arcs are intersected.
    """

    cut: int
    contour: Contour
    outside: bool | None
    shift: float
    scrap_left: bool | None
    offset: float
    clearance: float
    reverse: bool
    rounded: bool
    cornered: Contour | None = None
    corner: float = 0.0
    paper: bool = False

    @property
    def cornered_as_run(self) -> Contour | None:
        """The contour before its corners had arcs, in the direction in which it is run."""
        turned = self.cornered is not None and self.reverse
        return self.cornered.reversed() if turned and self.cornered else self.cornered


def runs_outside(depth: int, outside: bool) -> bool:
    """Return whether the wire runs outside of a contour that so many others enclose.

    ``outside``: it does so of those that none encloses.
    """
    return outside == (depth % 2 == 0)


@dataclass(frozen=True, slots=True)
class Pair:
    """What punch and die share, where the corners of their outline have arcs (``--corners paper``).

    Attributes:
        radius: of arcs that are not stated, um: the largest offset of all, for one radius fits both
            only where it is no smaller than either of their offsets.
        complete: punch and die are both cut here: whatever their offsets, their arcs are the same.
    """

    radius: float
    complete: bool


def pair_of(cuts: Sequence[ShapedCut], cutting: Cutting) -> Pair:
    """Return what all cuts that have arcs on the corners of their outlines share."""
    pairs = [cut.item for cut in cuts if _is_paper(cut, cutting) and cut.item.side != "on"]
    stated = [i.offset if i.offset is not None else cutting.offset_um or 0.0 for i in pairs]
    sides = {item.side for item in pairs}
    # Layers of a drawing are punch and die; cuts of a part program may be a part and its holes.
    complete = cuts[0].of_drawing and {"inside", "outside"} <= sides
    return Pair(max((*stated, 0.0)), complete)


def _is_paper(cut: ShapedCut, cutting: Cutting) -> bool:
    return cutting.paper if cut.item.paper is None else cut.item.paper


def pieces_of(
    number: int,
    cut: ShapedCut,
    cutting: Cutting,
    reverse: bool,
    ar: Arithmetic,
    used: Used,
    pair: Pair,
) -> tuple[list[Piece], list[Diagnostic]]:
    """Return the contours of cut ``number`` with the side on which the wire runs."""
    item, findings = cut.item, []
    side = item.side
    offset = item.offset if item.offset is not None else cutting.offset_um
    if side != "on" and not offset:
        findings.append(
            error(
                "no-cut-offset",
                "'{side}' needs an offset: how far the wire's centre runs from the outline",
                item.span,
                hint="offset 0.1, or --offset for all cuts that say none",
                side=side,
            )
        )
        return [], findings
    offset = 0.0 if side == "on" else float(offset or 0.0) - item.clearance
    used.add("offset_um", side != "on" and item.offset is None)
    used.add("corner_um", item.corner is None)
    for name in ("sharp", "trim"):
        used.add(name, offset != 0)
    corner = item.corner if item.corner is not None else cutting.corner_um
    paper = _is_paper(cut, cutting)
    if paper and side == "on" and not corner:
        paper = False  # without an offset there is nothing that an arc would be for
    used.add("paper", paper and item.paper is None)
    usual = paper and not corner
    if usual:
        corner = pair.radius
    if 0 < corner < offset:
        findings.append(
            error(
                "wed-value",
                "corner {corner_mm:.3f} mm is below the offset {offset_mm:.3f} mm: the wire could "
                "not follow it",
                item.span,
                corner_mm=corner / 1000,
                offset_mm=offset / 1000,
            )
        )
        return [], findings
    figure = [merge_arcs(c) for c in cut.figure]
    if side in ("inside", "outside") and cut.nesting is None:
        findings += [_open(c, side, item.span) for c in figure if not c.closed]
        figure = list(figures.counter_clockwise(figure))
    findings += _for_closed_only(cut, figure)
    drawn = figure
    if paper:
        warns = usual and not pair.complete
        figure, problems = transition_arcs(figure, corner, ar, acute=warns)
        findings += problems
    elif corner:
        figure, problems = round_corners(figure, corner, ar)
        findings += problems
    if has_errors(findings):
        return [], findings
    depths = (nest(figure) if cut.nesting is None else cut.nesting).depths
    pieces = []
    for k, (c, depth) in enumerate(zip(figure, depths, strict=True)):
        if side in ("inside", "outside"):
            outside = runs_outside(depth, side == "outside")
            way = -1 if outside else 1
            # The drawn sense is run where the side follows it; else what is stated counts.
            stated = bool(cut.clockwise) and cut.clockwise[k]
        else:
            way = {"left": 1, "right": -1, "on": 0}[side]
            outside = (way < 0) == (c.closed and measure.area(c.vertices) > 0)
            stated = False
        known = c.closed and side != "on"
        pieces.append(
            Piece(
                number,
                c,
                outside if known else None,
                way * offset,
                way > 0 if known else None,
                offset,
                item.clearance,
                stated != reverse,
                corner > 0,
                drawn[k] if paper else None,
                corner if paper else 0.0,
                paper,
            )
        )
    return pieces, findings


def _for_closed_only(cut: ShapedCut, figure: list[Contour]) -> list[Diagnostic]:
    """Return errors for clauses of a cut that need closed contours, or a single one."""
    item, findings = cut.item, []
    if item.stop and not all(c.closed for c in figure):
        findings.append(
            error("wed-value", "a stop is for closed contours; this one is open", item.span)
        )
    if item.overcut and not all(c.closed for c in figure):
        findings.append(
            error("wed-value", "an overcut is for closed contours; this one is open", item.span)
        )
    if cut.enter is not None and len(figure) > 1:
        findings.append(
            error(
                "wed-value",
                "'enter' is for one contour; this figure has {contours}",
                cut.enter.span,
                hint="cut each with an enter of its own",
                contours=len(figure),
            )
        )
    return findings


def _open(c: Contour, side: str, span: TextSpan | None) -> Diagnostic:
    start, end = (Place.of_um(c.vertices["x"][k], c.vertices["y"][k]) for k in (0, -1))
    return error(
        "open-contour",
        "to be cut {side} a contour must close: it ends at {end}, {gap_mm:.3f} mm from its start "
        "{start}",
        c.source_of(len(c) - 1) or span,
        notes=(("it is cut here", span),),
        points_mm=(start, end),
        hint="'close' draws a line back; 'left', 'right' and 'on' cut along an open contour",
        side=side,
        end=end,
        gap_mm=float(np.hypot(end.x_mm - start.x_mm, end.y_mm - start.y_mm)),
        start=start,
    )

"""A drawing as a part program of one cut, or of one a side, and what such a cut must be.

The side follows from what is kept, and from nothing else: with ``part`` the wire runs outside of
outer contours and inside of holes, with ``die`` the reverse.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.diag import Diagnostic, EntityRef, Place, error, note, warning
from wedmcam.geom import measure
from wedmcam.ir.contour import Contour
from wedmcam.ir.part import CutItem, Shape
from wedmcam.ir.plan import Order, Side
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.chain import open_contour_findings
from wedmcam.transforms.layers import Group, Rule
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.nest import Nesting, nest
from wedmcam.transforms.plan.options import Cutting, Leading
from wedmcam.transforms.plan.scenes import EQUAL_UM
from wedmcam.transforms.plan.shaped import ShapedCut

#: What each side is called in a part program.
_WORDS = {
    Side.PART: "outside",
    Side.DIE: "inside",
    Side.LEFT: "left",
    Side.RIGHT: "right",
    Side.ON: "on",
}


def cuts_of_drawing(
    groups: Sequence[Group],
    nesting: Nesting,
    threads: Sequence[ThreadPoint],
    cutting: Cutting,
    leading: Leading,
    join_um: float,
) -> tuple[tuple[ShapedCut, ...], list[Diagnostic]]:
    """Return the cuts that a drawing is: one, or one for each side and offset of its layers.

    Errors where contours do not fit their side, and warnings.

    Args:
        groups: contours as `chain` or the transforms made them.
        nesting: of all of them.
        threads: thread points of the drawing.
        cutting: states the offset of layers without their own.
        leading: states further thread points and the order.
        join_um: the largest gap that was closed.
    """
    starts = (
        *threads,
        *(
            ThreadPoint(x, y, option=f"--start {k}")
            for k, (x, y) in enumerate(leading.starts_um, 1)
        ),
    )
    order = leading.order or Order.INNER_FIRST
    findings = [d for group in groups for d in _unfit(group, join_um)]
    if len(groups) == 1:
        (group,) = groups
        item = _item(group.rule)
        cut = ShapedCut(item, group.contours, starts, order=order, nesting=nesting)
        return (cut,), [*findings, *_behind(group, cutting)]
    dies = [c for g in groups if g.rule.side is Side.DIE for c in g.contours if c.closed]
    parted: list[tuple[Group, int, tuple[Contour, ...]]] = []
    for group in groups:
        punch = _within(group.contours, dies) if group.rule.side is Side.PART else set()
        for plate in (0, 1):
            mine = tuple(c for k, c in enumerate(group.contours) if (k in punch) == bool(plate))
            if mine:
                parted.append((group, plate, mine))
        findings += _behind(group, cutting)
    cuts = []
    for group, plate, mine in parted:
        others = [
            c
            for g, at, theirs in parted
            if g is not group
            and (g.rule.side is Side.ON or (g.rule.side is group.rule.side and at == plate))
            for c in theirs
        ]
        own = ShapedCut(
            _item(group.rule),
            mine,
            starts,
            order=order,
            nesting=_nested(mine, others),
            plate=plate,
            of_drawing=True,
        )
        cuts.append(own)
    return tuple(cuts), [*findings, *_plates(cuts)]


def _nested(mine: tuple[Contour, ...], others: Sequence[Contour]) -> Nesting:
    """Return how contours lie in each other, those of other layers counted.

    A hole is a hole whatever the offset of its layer: the outline round it, of the same side or on
    the line, may have another. One outline that is drawn twice is no contour round itself.
    """
    others = [c for c in others if c.closed]
    if others:
        boxes = measure.extents_of_all([(c.vertices, c.closed) for c in (*mine, *others)])
        own, theirs = boxes[: len(mine)], boxes[len(mine) :]
        others = [
            c
            for c, box in zip(others, theirs, strict=True)
            if np.abs(own - box).max(axis=1).min() >= EQUAL_UM
        ]
    every = nest((*mine, *others))
    parents = tuple(p if p < len(mine) else -1 for p in every.parents[: len(mine)])
    return Nesting(mine, every.depths[: len(mine)], parents)


def _item(rule: Rule) -> CutItem:
    return CutItem(
        "",
        Shape(()),
        _WORDS[rule.side],
        None,
        offset=rule.offset_um,
        clearance=rule.clearance_um,
    )


def _within(contours: Sequence[Contour], dies: Sequence[Contour]) -> set[int]:
    """Return the numbers of contours that lie in openings of a die, or are one.

    They are the punches for these openings, drawn in their place.
    """
    if not dies or not contours:
        return set()
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in (*contours, *dies)])
    mine, theirs = boxes[: len(contours)], boxes[len(contours) :]
    numbers = set()
    for k, box in enumerate(mine):
        same = np.abs(theirs - box).max(axis=1) < EQUAL_UM
        if same.any() or any(d > 0 for d in nest((contours[k], *dies)).depths[:1]):
            numbers.add(k)
    return numbers


def _plates(cuts: Sequence[ShapedCut]) -> list[Diagnostic]:
    """Return a warning where one program cuts two pieces of material."""
    punches = [c for cut in cuts if cut.plate for c in cut.figure]
    if not punches:
        return []
    v = punches[0].vertices
    first = Place.of_um(v["x"][0], v["y"][0])
    return [
        warning(
            "two-plates",
            "1 contour of punches lies in openings of a die, at {first}: the last to be cut, from "
            "a second plate"
            if len(punches) == 1
            else "{count} contours of punches lie in openings of a die, the first at {first}: the "
            "last to be cut, from a second plate",
            punches[0].source_of(0),
            points_mm=(first,),
            hint="change the plate at the pause before them; or --layer, one program for each",
            count=len(punches),
            first=first,
        )
    ]


def _behind(group: Group, cutting: Cutting) -> list[Diagnostic]:
    """Return a note where the clearance is at least the offset: the wire runs behind the line."""
    wire = group.rule.offset_um or cutting.offset_um or 0.0
    apart = wire - group.rule.clearance_um
    if not group.contours or not group.rule.clearance_um or apart > 0:
        return []
    spans = [c.source_of(k) for c in group.contours for k in range(len(c))]
    names = sorted({s.layer for s in spans if isinstance(s, EntityRef)})
    return [
        note(
            "behind-the-line",
            "the {taker}: the clearance {clearance_mm:.3f} mm is all of the offset {offset_mm:.3f} "
            "mm: the wire runs on the line (layer {layers})"
            if apart == 0
            else "the {taker}: the clearance {clearance_mm:.3f} mm is more than the offset "
            "{offset_mm:.3f} mm: the wire runs {behind_mm:.3f} mm on the other side of the line, "
            "in what is drawn as kept (layer {layers})",
            group.contours[0].source_of(0),
            taker="punch" if group.rule.side is Side.PART else "die",
            clearance_mm=group.rule.clearance_um / 1000,
            offset_mm=wire / 1000,
            behind_mm=-apart / 1000,
            layers=names[:4],
        )
    ]


def _unfit(group: Group, join_um: float) -> list[Diagnostic]:
    """Return errors where contours do not fit the side: open ones to cut round, closed ones left.

    An open contour is followed only where that was asked for by name (left, right, on): a gap in an
    outline must not become a cut with a gap. Closed ones refuse left and right: their direction is
    an accident of the CAD program.
    """
    findings: list[Diagnostic] = []
    contours, side, stated = group.contours, group.rule.side, group.rule.stated
    if side in (Side.PART, Side.DIE) or not stated:
        opened = [merge_arcs(c) for c in contours if not c.closed]
        findings += open_contour_findings(opened, join_um)
    if side in (Side.LEFT, Side.RIGHT):
        for c in (merge_arcs(c) for c in contours if c.closed):
            start = Place.of_um(c.vertices["x"][0], c.vertices["y"][0])
            findings.append(
                error(
                    "closed-left-right",
                    "the closed contour at {start} has an inside and an outside, not a {side} side",
                    c.source_of(0),
                    points_mm=(start,),
                    hint="--side part keeps what is inside, --side die what is outside",
                    start=start,
                    side=str(side),
                )
            )
    if side is Side.ON and not stated and contours:
        findings.append(
            warning(
                "no-offset",
                "no offset is given: the wire runs on the line, and the part will be smaller by "
                "half the kerf on every side",
                hint="--offset, or --wire and --gap; --side on says that it is meant",
            )
        )
    return findings

"""A drawing as a part program of one cut, and what such a cut must be.

The side follows from what is kept, and from nothing else: with ``part`` the wire runs outside of
outer contours and inside of holes, with ``die`` the reverse.
"""

from __future__ import annotations

from collections.abc import Sequence

from wedmcam.diag import Diagnostic, error, warning
from wedmcam.ir.contour import Contour
from wedmcam.ir.part import CutItem, Shape
from wedmcam.ir.plan import Order, Side
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.options import Options
from wedmcam.transforms.chain import open_contour_findings
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.nest import Nesting
from wedmcam.transforms.plan.shaped import ShapedCut

#: What each side is called in a part program.
_WORDS = {
    Side.PART: "outside",
    Side.DIE: "inside",
    Side.LEFT: "left",
    Side.RIGHT: "right",
    Side.ON: "on",
}


def cut_of_drawing(
    contours: Sequence[Contour],
    nesting: Nesting,
    threads: Sequence[ThreadPoint],
    options: Options,
) -> tuple[tuple[ShapedCut, ...], list[Diagnostic]]:
    """Return the one cut that a drawing is; errors where its contours do not fit the side.

    Args:
        contours: as `chain` or the transforms made them.
        nesting: of them.
        threads: thread points of the drawing.
        options: state side, further thread points and order.
    """
    item = CutItem("", Shape(()), _WORDS[options.effective_side], None)
    starts = (
        *threads,
        *(
            ThreadPoint(x, y, option=f"--start {k}")
            for k, (x, y) in enumerate(options.starts_um, 1)
        ),
    )
    order = options.order or Order.INNER_FIRST
    cut = ShapedCut(item, tuple(contours), starts, order=order, nesting=nesting)
    return (cut,), _unfit(contours, options)


def _unfit(contours: Sequence[Contour], options: Options) -> list[Diagnostic]:
    """Return errors where contours do not fit the side: open ones to cut round, closed ones left.

    An open contour is followed only where that was asked for by name (left, right, on): a gap in an
    outline must not become a cut with a gap. Closed ones refuse left and right: their direction is
    an accident of the CAD program.
    """
    found: list[Diagnostic] = []
    side = options.effective_side
    if side in (Side.PART, Side.DIE) or options.side is None:
        opened = [merge_arcs(c) for c in contours if not c.closed]
        found += open_contour_findings(opened, options.join_um)
    if side in (Side.LEFT, Side.RIGHT):
        for c in (merge_arcs(c) for c in contours if c.closed):
            x, y = float(c.vertices["x"][0]) / 1000, float(c.vertices["y"][0]) / 1000
            found.append(
                error(
                    "closed-left-right",
                    f"the closed contour at ({x:.3f}, {y:.3f}) mm has an inside and an "
                    f"outside, not a {side} side",
                    c.source_of(0),
                    points_mm=((x, y),),
                    hint="--side part keeps what is inside, --side die what is outside",
                )
            )
    if side is Side.ON and options.side is None:
        found.append(
            warning(
                "no-offset",
                "no offset is given: the wire runs on the line, and the part will be smaller by "
                "half the kerf on every side",
                hint="--offset, or --wire and --gap; --side on says that it is meant",
            )
        )
    return found

"""Which way the wire runs a closed contour of a part program: what of its text states that.

Counter-clockwise where nothing is said, in whatever order the points of a contour were written and
however a figure was mirrored: that draws a shape. ``circle cw`` and ``reverse`` draw none, so they
are about the way of the wire alone, and each turns it round. Cuts that follow the drawn sense
(left, right, on) need none of this: there the contour itself is run as it stands.
"""

from __future__ import annotations

from collections.abc import Sequence

from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Mirror, Reverse, Symmetry, Transform


def clockwise(figure: Sequence[Contour], stages: Sequence[Transform]) -> tuple[bool, ...]:
    """Return for each contour whether the program states that it is run clockwise.

    Args:
        figure: what the stages made, its contours in the sense that they gave it. A contour of one
            row is a circle of the program: its turn is the stated one, and the stages'.
        stages: the transforms of the figure, in their order; an image of ``with`` keeps the sense
            of its figure, and ``with reverse`` adds nothing.
    """
    reverses = sum(isinstance(t, Reverse) for t in stages) % 2 == 1
    reflects = sum(isinstance(t, Symmetry | Mirror) for t in stages) % 2 == 1
    out = []
    for c in figure:
        if c.closed and len(c) == 1:
            out.append((int(c.vertices["turn"][0]) < 0) != reflects)
        else:
            out.append(c.closed and reverses)
    return tuple(out)

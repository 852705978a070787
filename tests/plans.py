"""Plans made by hand."""

from collections.abc import Sequence
from dataclasses import replace

from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan, Scene, Side


def one_scene(
    cuts: Sequence[Cut],
    outlines: Sequence[Contour],
    depths: Sequence[int],
    side: Side,
    offset_um: float,
) -> Plan:
    """Return a plan like that of a drawing: one scene, one side and one offset."""
    cuts = tuple(replace(cut, side=side, offset_um=offset_um) for cut in cuts)
    many = len(outlines)
    keeps = side if side in (Side.PART, Side.DIE) else None
    each = (offset_um,) * many, (side,) * many
    return Plan(cuts, (Scene(tuple(outlines), tuple(depths), *each, keeps),))

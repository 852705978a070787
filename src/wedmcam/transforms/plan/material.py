"""What is drawn too near to itself, or too small: asked of every scene before the wire is."""

from __future__ import annotations

from collections.abc import Sequence

from wedmcam.diag import Diagnostic
from wedmcam.ir.plan import Side
from wedmcam.transforms.plan.pieces import runs_outside
from wedmcam.transforms.plan.scenes import PieceScene
from wedmcam.transforms.thickness import specks, thin_walls
from wedmcam.transforms.walls import thin


def thin_material(scenes: Sequence[PieceScene], below_um: float) -> list[Diagnostic]:
    """Return findings on outlines drawn twice, walls too thin, and specks.

    Args:
        scenes: contours that make one part each.
        below_um: kept material thinner than this is a warning; 0 for none.
    """
    pieces = [(number, piece) for number, scene in enumerate(scenes) for piece in scene.pieces]
    findings, close_pairs = thin(
        [piece.contour for _, piece in pieces],
        [piece.outside for _, piece in pieces],
        [number for number, _ in pieces],
    )
    first = 0
    for scene in scenes:
        part = scene.keeps is not Side.DIE
        contours = [p.contour for p in scene.pieces]
        inside = [runs_outside(depth, part) for depth in scene.nesting.depths]
        small, are_small = specks(contours, inside, [p.offset + p.clearance for p in scene.pieces])
        findings += small
        rows = [k for k, c in enumerate(contours) if c.closed and not are_small[k]]
        chosen, numbers = [contours[k] for k in rows], [first + k for k in rows]
        taken = [scene.pieces[k].clearance for k in rows]
        findings += thin_walls(chosen, part, below_um, numbers, close_pairs, taken)
        first += len(contours)
    return findings

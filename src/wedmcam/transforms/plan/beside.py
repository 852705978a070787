"""Cuts of one plate that make no part together, such as a punch and a die beside each other.

Each is compensated by itself, so the wire beside one may run into what is kept of the other. Kept
begins at the outline, or its clearance behind: nearer than that the wire with its gap must not
come, on whichever side of the outline it runs.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.geom import crossings, measure, pairs
from wedmcam.geom.gaps import gaps
from wedmcam.geom.segments import Segments, boxes
from wedmcam.ir.plan import Cut, Scene

#: How much nearer than its radius the wire may be, um: roundings of the path, and of the proof.
ROOM_UM = 0.5


def beside(scenes: Sequence[Scene], cuts: Sequence[Cut]) -> list[Diagnostic]:
    """Return an error for each cut whose wire enters what is kept of another scene of its plate."""
    findings: list[Diagnostic] = []
    for number, scene in enumerate(scenes):
        if not scene.beside or scene.keeps is None:
            continue
        closed = [k for k, c in enumerate(scene.outlines) if c.closed]
        held = [(scene.outlines[k].vertices, True) for k in closed]
        kept, first = measure.segments_of_all(held)
        owner = np.repeat(np.arange(len(closed)), np.diff(first, append=len(kept)))
        behind = np.array([scene.behind[k] for k in closed])
        for cut in cuts:
            if cut.scene == number or scenes[cut.scene].plate != scene.plate:
                continue
            if scenes[cut.scene].keeps is None:
                continue
            wire = cut.offset_um + cut.clearance_um
            path = measure.segments_of(cut.path.vertices, cut.path.closed)
            i, j = pairs.overlapping(pairs.grow(boxes(path), wire), boxes(kept))
            if not len(i):
                continue
            near = gaps(path.take(i), kept.take(j))
            deep = wire - behind[owner[j]] - near.size
            k = int(np.argmax(deep))
            x, y, um = float(near.x[k]), float(near.y[k]), float(deep[k])
            met = _crossing(path, kept, i, j)
            if met is not None:
                (x, y), um = met, max(um, wire)
            if um > ROOM_UM:
                findings.append(_enters(cut, scene, closed[int(owner[j[k]])], x, y, um))
    return findings


def _crossing(
    path: Segments, kept: Segments, i: np.ndarray, j: np.ndarray
) -> tuple[float, float] | None:
    """Return a place where a path crosses an outline."""
    both = Segments(
        *(np.concatenate([getattr(path, name), getattr(kept, name)]) for name in Segments.__slots__)
    )
    c = crossings.between(both, i, j + len(path))
    return (float(c.x[0]), float(c.y[0])) if len(c.i) else None


def _enters(cut: Cut, scene: Scene, outline: int, x: float, y: float, um: float) -> Diagnostic:
    other = scene.outlines[outline].source_of(0)
    place = Place.of_um(x, y)
    return error(
        "interference",
        "the wire beside this contour enters what is kept of another one by {depth_mm:.3f} mm at "
        "{place}",
        cut.path.source_of(0),
        notes=(("the other one", other),),
        points_mm=(place,),
        hint="draw them farther apart, or compile each layer by itself (--layer)",
        depth_mm=um / 1e3,
        place=place,
    )

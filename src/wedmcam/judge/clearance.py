"""The kept material of a part that takes a clearance: it begins behind the outlines as drawn.

What is proven stays what is proven of every part, that the wire with its gap keeps out of the kept
material and reaches all of its boundary; only that boundary is another one. It is found by another
library than the path was, so a clearance on the wrong side, or taken twice, shows as a gouge.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.plan import Material, Side
from wedmcam.judge.witness import SAGITTA, ring


def as_left(material: Material) -> Material:
    """Return the same material with the boundary that it has behind its clearance.

    Each outline moves into the kept material by its clearance, rounded at corners, and the offset
    is that of the wire. Outlines but circles become chords within 2 x `SAGITTA` um of their place.
    One that vanishes stays as drawn: then the wire cannot be right either, and that shows.
    """
    if not material.clearance_um:
        return material
    outlines: list[Contour] = []
    depths: list[int] = []
    reached: list[int] = []
    for k, (contour, depth) in enumerate(zip(material.outlines, material.depths, strict=True)):
        moved = [contour]
        if contour.closed and material.clearances[k]:
            inside = (depth % 2 == 0) == (material.side is Side.PART)  # what it encloses is kept
            um = -material.clearances[k] if inside else material.clearances[k]
            moved = _moved(contour, um) or moved
        if k in material.reached:
            reached += range(len(outlines), len(outlines) + len(moved))
        outlines += moved
        depths += [depth] * len(moved)
    return replace(
        material,
        outlines=tuple(outlines),
        depths=tuple(depths),
        reached=tuple(reached),
        offset_um=material.offset_um + material.clearance_um,
    )


def _moved(contour: Contour, um: float) -> list[Contour]:
    """Return a closed contour moved outwards by ``um``, which may be negative: none, or several."""
    import shapely

    v = contour.vertices
    if len(v) == 1:  # a circle stays one
        radius = float(np.hypot(v["x"][0] - v["cx"][0], v["y"][0] - v["cy"][0]))
        if radius + um <= 0:
            return []
        vertices = v.copy()
        for name, centre in (("x", "cx"), ("y", "cy")):
            vertices[name] = v[centre] + (v[name] - v[centre]) * (radius + um) / radius
        return [Contour(vertices, True, contour.sources)]
    quarter = np.arccos(1.0 - min(SAGITTA / abs(um), 1.0))
    grown: Any = shapely.Polygon(ring(contour)).buffer(
        um, quad_segs=max(2, int(np.ceil(0.25 * np.pi / quarter)))
    )
    whole = grown.geoms if hasattr(grown, "geoms") else [grown]
    return [_contour(r) for one in whole for r in (one.exterior, *one.interiors) if not r.is_empty]


def _contour(of: Any) -> Contour:
    """Return a ring of points as a contour."""
    xy = np.asarray(of.coords)[:-1]
    vertices = np.zeros(len(xy), VERTEX)
    vertices["x"], vertices["y"] = xy[:, 0], xy[:, 1]
    vertices["source"] = -1
    return Contour(vertices, True, ())

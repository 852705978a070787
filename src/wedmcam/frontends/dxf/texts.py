"""Where texts stand in a drawing. None is cut; but a rectangle with texts in it is a title block.

Only what a look at the nesting of contours needs is taken: the insertion points of what the drawing
writes, in model space and in the blocks inserted there.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

KINDS = frozenset({"TEXT", "MTEXT", "ATTRIB"})
#: More texts than this say no more.
MOST = 10_000
#: Blocks in blocks are followed so far.
DEEPEST = 4


def texts_of(doc: Any, scale: float) -> NDArray[np.float64]:
    """Return the insertion points of texts, um, shape (texts, 2).

    Args:
        doc: the document.
        scale: um in a drawing unit.
    """
    points: list[tuple[float, float]] = []
    _collect(doc, doc.modelspace(), np.eye(3), points, 0)
    found = np.array(points, float).reshape(-1, 2) * scale
    return found[np.isfinite(found).all(axis=1)]


def _collect(
    doc: Any,
    layout: Any,
    matrix: NDArray[np.float64],
    points: list[tuple[float, float]],
    depth: int,
) -> None:
    for entity in layout:
        if len(points) >= MOST:
            return
        kind = entity.dxftype()
        if kind in KINDS:
            _take(entity, matrix, points)
        elif kind == "INSERT" and depth < DEEPEST:
            for attribute in entity.attribs:
                _take(attribute, matrix, points)
            block = doc.blocks.get(entity.dxf.get("name", ""))
            if block is not None:
                _collect(doc, block, matrix @ _placed(entity, block), points, depth + 1)


def _take(entity: Any, matrix: NDArray[np.float64], points: list[tuple[float, float]]) -> None:
    at = entity.dxf.get("insert") if entity.dxf.is_supported("insert") else None
    if at is not None:
        x, y, _ = (matrix @ (at[0], at[1], 1.0)).tolist()
        points.append((x, y))


def _placed(insert: Any, block: Any) -> NDArray[np.float64]:
    """Return where an INSERT puts its block: scale, rotation, place; its first copy."""
    at = insert.dxf.get("insert", (0.0, 0.0, 0.0))
    base = block.block.dxf.get("base_point", (0.0, 0.0, 0.0)) if block.block else (0.0, 0.0, 0.0)
    angle = np.radians(insert.dxf.get("rotation", 0.0))
    c, s = np.cos(angle), np.sin(angle)
    sx, sy = insert.dxf.get("xscale", 1.0), insert.dxf.get("yscale", 1.0)
    turned = np.array([[c * sx, -s * sy], [s * sx, c * sy]])
    x, y = np.array([at[0], at[1]]) - turned @ (base[0], base[1])
    return np.array([[*turned[0], x], [*turned[1], y], [0.0, 0.0, 1.0]])

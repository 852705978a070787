"""Boundaries of what is drawn and not read: fills, wide lines and faces.

None of them is cut. But an outer contour may be held by one alone, and then its holes would be cut
as loose discs. So what bounds them is put where it is drawn, by the same lines, arcs and curves and
the same placing of blocks as everything else, and `transforms.unread` asks whether something that
is read draws it, too.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.frontends.dxf.curves import Spline, of_spline
from wedmcam.frontends.dxf.filters import Filters
from wedmcam.frontends.dxf.kinds import BOUNDED, MESH, UNREADABLE, is_annotation
from wedmcam.frontends.dxf.place import Layers, Placement, Placer, finite
from wedmcam.frontends.dxf.shapes import (
    CONVERTERS,
    Converter,
    Entity,
    Heap,
    _flip,
    convert_entity,
    is_on_sheet,
    layer_of,
    segments_of,
    type_of,
    unreadable,
)
from wedmcam.geom.curves import Ellipse
from wedmcam.ir.sketch import Unread

Floats = NDArray[np.float64]
Points = list[tuple[float, float]]

#: Boundary paths of a HATCH with this flag leave room for a text (DXF reference, group 92).
TEXT_BOX = 8
#: Edges of a HATCH from this angle on are whole circles and ellipses, degrees.
WHOLE_DEG = 360.0 - 1e-6


def unread(
    doc: Any,
    scale: float,
    layers: Layers,
    file: str,
    filters: Filters,
    tolerance: float = 1.0,
) -> tuple[Unread, Placement]:
    """Return the boundaries of what a drawing shows and is not read, um, drawing coordinates.

    Args:
        doc: the document.
        scale: um in a drawing unit.
        layers: which are cut; what is on others does not count.
        file: name of the drawing.
        filters: what is left out.
        tolerance: how far the arcs that ellipses and splines become may be from them, um.

    Returns:
        The boundaries, and how they were placed: the entities with a problem are those whose
        boundary cannot be had.
    """

    def heap_of(layout: Any, annotation: bool) -> Heap:
        return gather(layout, scale, filters, annotation)

    placer = Placer(doc, scale, layers, file, heap_of, filters, tolerance)
    placer.place(doc.modelspace())
    placed = placer.placed
    rows = finite(placer.rows(), placed)
    return Unread(rows, tuple(placed.sources), placed.curve_um or 0.0), placed


def gather(entities: Any, scale: float, filters: Filters, annotation: bool = False) -> Heap:
    """Return the boundaries of what is not read, and the INSERTs, of a layout or block.

    Each boundary path of a HATCH and each line of a closed MLINE is an entity of the heap by
    itself, of the handle of the HATCH or MLINE.

    Args:
        entities: the layout or block.
        scale: um to a drawing unit.
        filters: what tells which types are left out.
        annotation: whether nothing in it is an outline: the picture of a dimension, an arrow head.
    """
    heap = Heap(scale)
    if annotation:
        return heap
    for entity in entities:
        kind = type_of(entity)
        to = _CONVERTERS.get(kind)
        layer = layer_of(entity)
        if to is None or is_on_sheet(entity) or filters.leaves_out_type(kind, layer):
            continue
        if entity.dxftype() == UNREADABLE:
            to = unreadable
        convert_entity(heap, entity, kind, layer, to)
    heap.segments = segments_of(heap)
    return heap


def _insert(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    if not is_annotation(str(dxf.name)):
        CONVERTERS["INSERT"](heap, at, entity, dxf)


def _ring(heap: Heap, at: int, points: Points, flip: bool = False, closed: bool = True) -> None:
    """Add a polygon."""
    rows = np.array([(x, y, 0.0) for x, y in points], float).reshape(-1, 3)
    heap.polylines.append(rows)
    heap.polyline_of.append((at, closed, flip))


def _flat(points: Any) -> Points:
    return [(float(p[0]), float(p[1])) for p in points]


def _solid(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is not None:
        a, b, c, d = _corners(dxf)
        _ring(heap, at, [a, b, d, c], flip)  # as they are stated: the third is across the second


def _face(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    _ring(heap, at, _corners(dxf))


def _corners(dxf: Entity) -> Points:
    """Return four corners; a triangle has its third one twice, stated or not."""
    points = [dxf.vtx0, dxf.vtx1, dxf.vtx2]
    points.append(dxf.vtx3 if dxf.hasattr("vtx3") else dxf.vtx2)
    return _flat(points)


def _wipeout(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    _ring(heap, at, _flat(entity.boundary_path_wcs()))


def _mesh(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    points = np.array([tuple(p) for p in entity.vertices], float).reshape(-1, 3)
    _faces(heap, at, points[:, :2], [list(f) for f in entity.faces])


def _polymesh(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    if entity.is_poly_face_mesh:
        vertices, faces = entity.indexed_faces()
        points = np.array([tuple(v.dxf.location) for v in vertices], float).reshape(-1, 3)
        _faces(heap, at, points[:, :2], [list(face.indices) for face in faces])
        return
    m, n = dxf.m_count, dxf.n_count
    points = np.array([tuple(v.dxf.location) for v in entity.vertices], float).reshape(-1, 3)
    number = np.arange(m * n).reshape(m, n)
    if entity.is_m_closed:
        number = np.concatenate([number, number[:1]])
    if entity.is_n_closed:
        number = np.concatenate([number, number[:, :1]], axis=1)
    corners = (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    _faces(heap, at, points[:, :2], np.stack(corners, axis=-1).reshape(-1, 4).tolist())


def _faces(heap: Heap, at: int, points: Floats, faces: list[list[int]]) -> None:
    """Add the rim of a net of faces as seen from above: edges with a face on one side only."""
    same: dict[tuple[float, float], int] = {}
    number = [same.setdefault((float(x), float(y)), k) for k, (x, y) in enumerate(points)]
    edges: dict[tuple[int, int], None] = {}
    for face in faces:
        corners = [number[k] for k in face]
        x, y = points[corners].T
        area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        if area < 0:
            corners.reverse()
        if area:
            edges.update(dict.fromkeys(zip(corners, corners[1:] + corners[:1], strict=True)))
    for a, b in edges:
        if (b, a) not in edges and a != b:
            heap.lines.append((*points[a].tolist(), *points[b].tolist()))
            heap.line_of.append(at)


def _mline(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    """Add the lines that an MLINE draws; only with its style it is known where they are."""
    offsets = [[line[0] for line in v.line_params if len(line)] for v in entity.vertices]
    counts = {len(o) for o in offsets}
    if len(counts) != 1 or not max(counts):
        raise ValueError("its style is not in the drawing")
    closed = bool(entity.is_closed)
    for element in range(max(counts)):
        points = []
        for vertex, own in zip(entity.vertices, offsets, strict=True):
            points.append(vertex.location + vertex.miter_direction * own[element])
        if element and closed:
            at = heap.add(entity, *heap.entities[at][::2])
        _ring(heap, at, _flat(points), closed=closed)


# --- HATCH ----------------------------------------------------------------------------------


def _hatch(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is None:
        return
    mine: int | None = at
    for path in entity.paths:  # without one it draws nothing
        if path.path_type_flags & TEXT_BOX:
            continue
        if mine is None:
            mine = heap.add(entity, *heap.entities[at][::2])
        if hasattr(path, "vertices"):
            heap.polylines.append(np.array(path.vertices, float).reshape(-1, 3))
            heap.polyline_of.append((mine, True, flip))
        else:
            for edge in path.edges:
                _EDGES[edge.EDGE_TYPE](heap, mine, edge, flip)
        mine = None


def _line_edge(heap: Heap, at: int, edge: Any, flip: bool) -> None:
    side = -1.0 if flip else 1.0
    heap.lines.append((side * edge.start.x, edge.start.y, side * edge.end.x, edge.end.y))
    heap.line_of.append(at)


def _arc_edge(heap: Heap, at: int, edge: Any, flip: bool) -> None:
    x, y, start, end = edge.center.x, edge.center.y, edge.start_angle, edge.end_angle
    if abs(end - start) >= WHOLE_DEG or start == end:
        heap.circles.append((x, y, edge.radius, flip))
        heap.circle_of.append(at)
    else:
        heap.arcs.append((x, y, edge.radius, start, end, flip))
        heap.arc_of.append(at)


def _ellipse_edge(heap: Heap, at: int, edge: Any, flip: bool) -> None:
    k, side = heap.scale, -1.0 if flip else 1.0
    cx, cy, ux, uy = (k * v for v in (*edge.center, *edge.major_axis))
    ratio = edge.ratio
    turn = edge.end_angle - edge.start_angle
    start, end = edge.start_param, edge.end_param
    whole = abs(turn) >= WHOLE_DEG or not turn
    sweep = 2.0 * np.pi if whole else float(np.mod(end - start, 2.0 * np.pi))
    curve = Ellipse(side * cx, cy, side * ux, uy, side * -uy * ratio, ux * ratio, start, sweep)
    heap.curves.append((at, curve))


def _spline_edge(heap: Heap, at: int, edge: Any, flip: bool) -> None:
    curve = spline_of(edge, heap.scale, flip)
    if curve is not None:
        heap.curves.append((at, curve))


def spline_of(edge: Any, scale: float, flip: bool) -> Spline | None:
    """Return an edge of a HATCH as the SPLINE that it was; None where it has no length."""
    from ezdxf.entities.spline import Spline as SplineEntity

    side = -1.0 if flip else 1.0
    entity = SplineEntity.new(dxfattribs={"degree": edge.degree})
    if edge.control_points:
        entity.control_points = [(side * p.x, p.y, 0.0) for p in edge.control_points]
        entity.knots = edge.knot_values
        entity.weights = edge.weights
    else:
        entity.fit_points = [(side * p.x, p.y, 0.0) for p in edge.fit_points]
        for name in ("start_tangent", "end_tangent"):
            tangent = getattr(edge, name)
            if tangent is not None:
                entity.dxf.set(name, (side * tangent.x, tangent.y, 0.0))
    return of_spline(entity, scale)[0]


_EDGES = {
    "LineEdge": _line_edge,
    "ArcEdge": _arc_edge,
    "EllipseEdge": _ellipse_edge,
    "SplineEdge": _spline_edge,
}
_CONVERTERS: dict[str, Converter] = {
    "INSERT": _insert,
    "SOLID": _solid,
    "TRACE": _solid,
    "3DFACE": _face,
    "MESH": _mesh,
    MESH: _polymesh,
    "HATCH": _hatch,
    "MPOLYGON": _hatch,
    "WIPEOUT": _wipeout,
    "MLINE": _mline,
}
assert set(_CONVERTERS) - {"INSERT"} == BOUNDED

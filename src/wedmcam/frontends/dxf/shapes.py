"""What each kind of entity is as lines and arcs: a table of small converters.

A model space or a block becomes a `Heap` once, in its own frame: raw figures are gathered into
lists entity by entity, then turned into segments by array operations. A later stage adds an entity
type by adding a converter to `CONVERTERS`.

Frames: LINE and POINT state world coordinates. ARC, CIRCLE, LWPOLYLINE and 2D POLYLINE state them
in a frame of their own (OCS) that the extrusion vector sets. For (0, 0, -1), which mirroring in a
CAD program leaves behind, that frame has its x axis reversed, so x changes its sign and
counter-clockwise becomes clockwise. Any other tilt is refused.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.frontends.dxf.curves import FARTHEST_UM, Curve, CurveError, of_ellipse, of_spline
from wedmcam.frontends.dxf.filters import Filters, Look, look_of
from wedmcam.frontends.dxf.kinds import ANNOTATION, BOUNDED, MESH, UNREADABLE
from wedmcam.frontends.dxf.turns import TELLING, Turn, turn_of
from wedmcam.ir.sketch import SEGMENT

Floats = NDArray[np.float64]
Rows = NDArray[np.void]
#: Any ezdxf entity. ezdxf is imported when a drawing is read and not before, and its attributes
#: are dynamic, so there is no better type.
Entity = Any

#: Largest sine of the tilt of an extrusion vector that still counts as none: 1 nm over 1 m.
UPRIGHT = 1e-9
#: Largest change of height along a line, um: below the grid of the machine.
LEVEL_UM = 1.0
#: Angles this near to a full turn, degrees, are one: 0.2 nm at a radius of 10 m.
FULL_DEG = 1e-9
#: A polyline arc is a line below this bulge, or below this height over its chord, um.
FLAT_BULGE, FLAT_UM = 1e-8, 1e-4
#: From this bulge on (all but 0.002 degrees of a circle) rounding decides where the centre is.
ABSURD_BULGE = 1e5


#: Values of a finding: names and what they are.
Values = tuple[tuple[str, str | int], ...]


@dataclass(frozen=True, slots=True)
class Problem:
    """What is wrong with one entity of a heap. ``entity`` -1: with something about the heap."""

    code: str
    entity: int
    values: Values


@dataclass(slots=True)
class Insert:
    """An INSERT as it stands in a heap: block, transform of each copy, and what it inherits.

    ``matrices``: (a, b, c, d, e, f) each, x' = a x + c y + e, y' = b x + d y + f, drawing units,
    the block's base point not yet taken off.
    """

    entity: int
    name: str
    matrix: tuple[float, float, float, float, float, float]
    columns: int
    rows: int
    step: tuple[float, float, float, float]
    attributes: int


@dataclass(slots=True)
class Heap:
    """All entities of one layout or block, in its own frame.

    Attributes:
        scale: um in a drawing unit.
        entities: (type, handle, layer) of each geometric entity.
        looks: line type and colour of those that state one.
        invisible: which of them are.
        others: (type, layer) -> count of what is never cut.
        ignored: (type, layer) -> count of what is of a type left out.
        inserts: block references.
        points: (entity, x, y) of POINT entities, um.
        problems: what is wrong.
        segments: lines and arcs; ``source`` indexes ``entities``.
        curves: (entity, curve) of splines and ellipses, um; they become segments where it is known
            how large they are.
        heights: z of each entity that lies flat, um.
        dropped: entities without length that were dropped.
        widths: polylines with a width, and how wide they are at most, um.
    """

    scale: float
    entities: list[tuple[str, str, str]] = field(default_factory=list)
    looks: dict[int, Look] = field(default_factory=dict)
    invisible: set[int] = field(default_factory=set)
    others: Counter[tuple[str, str]] = field(default_factory=Counter)
    ignored: Counter[tuple[str, str]] = field(default_factory=Counter)
    inserts: list[Insert] = field(default_factory=list)
    points: list[tuple[int, float, float]] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    segments: Rows = field(default_factory=lambda: np.zeros(0, SEGMENT))
    curves: list[tuple[int, Curve]] = field(default_factory=list)
    heights: dict[int, float] = field(default_factory=dict)
    dropped: list[int] = field(default_factory=list)
    widths: dict[int, float] = field(default_factory=dict)
    lines: list[tuple[float, ...]] = field(default_factory=list)
    line_of: list[int] = field(default_factory=list)
    arcs: list[tuple[float, ...]] = field(default_factory=list)
    arc_of: list[int] = field(default_factory=list)
    circles: list[tuple[float, ...]] = field(default_factory=list)
    circle_of: list[int] = field(default_factory=list)
    polylines: list[Floats] = field(default_factory=list)
    polyline_of: list[tuple[int, bool, bool]] = field(default_factory=list)

    def problem(self, code: str, entity: int, **values: str | int) -> None:
        """Note that something is wrong with an entity; ``values``: of the finding."""
        self.problems.append(Problem(code, entity, tuple(values.items())))

    def add(self, entity: Entity, kind: str, layer: str) -> int:
        """Enter an entity and return its number."""
        at = len(self.entities)
        self.entities.append((kind, str(entity.dxf.handle), layer))
        dxf = entity.dxf
        look = look_of(entity, value_of_group)
        if look is not None:
            self.looks[at] = look
        if dxf.invisible if dxf.hasattr("invisible") else value_of_group(entity, 60, 0):
            self.invisible.add(at)
        return at


#: Adds the figures of the entity of that number to a heap.
Converter = Callable[[Heap, int, Entity, Entity], None]


def gather(
    entities: Any, scale: float, filters: Filters | None = None, annotation: bool = False
) -> Heap:
    """Return the heap of a layout's or block's entities.

    Args:
        entities: the layout or block.
        scale: um to a drawing unit.
        filters: what tells which types are left out; None for none.
        annotation: whether what cannot be read in it is no outline: the picture of a dimension.
    """
    heap = Heap(scale)
    convert = CONVERTERS.get
    for entity in entities:
        kind = entity.DXFTYPE
        layer = layer_of(entity)
        if is_on_sheet(entity):
            continue
        to = convert(kind)
        if to is None or kind == "POLYLINE":
            unread = kind == UNREADABLE
            kind = type_of(entity)
            to = unreadable if unread else convert(kind)
        if filters is not None and filters.leaves_out_type(kind, layer):
            heap.ignored[kind, layer] += 1
            continue
        if to is None or to is unreadable:
            if annotation or kind in ANNOTATION or kind in BOUNDED:
                heap.others[kind, layer] += 1
                continue
            to = to or _unsupported
        convert_entity(heap, entity, kind, layer, to)
    heap.segments = segments_of(heap)
    return heap


def layer_of(entity: Entity) -> str:
    """Return the layer of an entity, also of one of an unknown type."""
    if hasattr(entity, "xtags"):  # ezdxf keeps the tags of such a type, and no more
        return str(value_of_group(entity, 8, "0"))
    return str(entity.dxf.layer)


def is_on_sheet(entity: Entity) -> bool:
    """Return whether an entity of an unknown type is in paper space; of others ezdxf knows it."""
    return hasattr(entity, "xtags") and bool(value_of_group(entity, 67, 0))


def value_of_group(entity: Entity, code: int, default: object) -> object:
    """Return the first value of a group code of an entity of an unknown type."""
    if not hasattr(entity, "xtags"):
        return default
    for tags in entity.xtags.subclasses[:2]:  # by itself, or under AcDbEntity
        if tags.has_tag(code):
            return tags.get_first_value(code)
    return default


def type_of(entity: Entity) -> str:
    """Return the DXF type of an entity; a POLYLINE that is a net of faces is `kinds.MESH`.

    What could not be read has a mark in its place (`salvage`), which tells the type.
    """
    kind = str(entity.dxftype())
    if kind == UNREADABLE:
        return str(entity.xtags.subclasses[-1].get_first_value(1))
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return MESH
    return kind


def convert_entity(heap: Heap, entity: Entity, kind: str, layer: str, to: Converter) -> None:
    """Add an entity to a heap; what is wrong with it becomes a problem there."""
    from ezdxf.lldxf.const import DXFError

    at = heap.add(entity, kind, layer)
    try:
        with np.errstate(all="ignore"):  # what overflows is refused as a bad number
            to(heap, at, entity, entity.dxf)
    except CurveError as why:
        heap.problem(why.code, at, **({"reason": str(why)} if str(why) else {}))
    except (
        DXFError,
        ArithmeticError,
        LookupError,
        AttributeError,
        ValueError,
        TypeError,
    ) as why:
        # ezdxf raises these for attributes that an entity must have and has not.
        reason = str(why) if isinstance(why, DXFError | ValueError) else ""
        heap.problem("damaged-drawing", at, reason=reason or "a value is missing in it")


# --- one converter for each type ------------------------------------------------------------


def _flip(heap: Heap, at: int, dxf: Entity) -> bool | None:
    """Return whether an entity's frame is mirrored; None, and a problem, where it is tilted."""
    if not dxf.hasattr("extrusion"):
        return False
    x, y, z = dxf.extrusion
    if max(abs(x), abs(y)) > UPRIGHT * abs(z) or not z:
        heap.problem("tilted", at)
        return None
    return bool(z < 0)


def _unsupported(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    heap.problem("unsupported-entity", at)


def unreadable(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    """Note which of the entities that ezdxf could not read this one stands for."""
    heap.problem("unreadable", at, number=int(entity.xtags.subclasses[-1].get_first_value(90)))


def _line(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    x0, y0, z0 = dxf.start
    x1, y1, z1 = dxf.end
    if abs(z1 - z0) * heap.scale > LEVEL_UM:
        heap.problem("not-flat", at)
        return
    heap.heights[at] = z0 * heap.scale
    heap.lines.append((x0, y0, x1, y1))
    heap.line_of.append(at)


def _arc(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is None:
        return
    x, y, z = dxf.center
    heap.heights[at] = (-z if flip else z) * heap.scale
    start, end, radius = dxf.start_angle, dxf.end_angle, _radius(heap, at, dxf)
    angles = math.radians(start), math.radians(end)
    turn = turn_of(*angles, radius * heap.scale, math.radians(FULL_DEG))
    if turn in TELLING:
        heap.problem(TELLING[turn], at)
    if turn in (Turn.FULL, Turn.ROUNDED, Turn.EQUAL):
        heap.circles.append((x, y, radius, flip))
        heap.circle_of.append(at)
        return
    heap.arcs.append((x, y, radius, start, end, flip))
    heap.arc_of.append(at)


def _circle(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is not None:
        x, y, z = dxf.center
        heap.heights[at] = (-z if flip else z) * heap.scale
        heap.circles.append((x, y, _radius(heap, at, dxf), flip))
        heap.circle_of.append(at)


def _radius(heap: Heap, at: int, dxf: Entity) -> float:
    """Return a radius; a negative one is read as positive, and that is a problem."""
    radius = float(dxf.radius)
    if radius < 0.0:
        heap.problem("negative-radius", at)
    return abs(radius)


def _lwpolyline(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is None:
        return
    if dxf.hasattr("elevation"):
        heap.heights[at] = (-dxf.elevation if flip else dxf.elevation) * heap.scale
    else:
        heap.heights[at] = 0.0
    rows = np.array(entity.lwpoints.values, float).reshape(-1, 5)  # x, y, two widths, bulge
    wide = np.abs(rows[:, 2:4]).max(initial=0.0)
    if not wide and dxf.hasattr("const_width"):
        wide = abs(dxf.const_width)
    if wide:
        heap.widths[at] = float(wide) * heap.scale
    heap.polylines.append(rows[:, (0, 1, 4)])
    heap.polyline_of.append((at, bool(entity.closed), flip))


def _stated_width(dxf: Entity, name: str) -> float:
    return abs(float(dxf.get(name))) if dxf.hasattr(name) else 0.0


def _polyline(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flat = entity.is_2d_polyline
    flip = _flip(heap, at, dxf) if flat else False
    if flip is None:
        return
    rows, heights = [], []
    wide = max(_stated_width(dxf, "default_start_width"), _stated_width(dxf, "default_end_width"))
    for vertex in entity.vertices:
        v = vertex.dxf
        if v.flags & 16 and dxf.flags & 4:  # of a spline's frame: the curve's own points follow
            continue
        x, y, z = v.location
        rows.append((x, y, v.bulge if flat and v.hasattr("bulge") else 0.0))
        heights.append(z)
        wide = max(wide, _stated_width(v, "start_width"), _stated_width(v, "end_width"))
    if wide:
        heap.widths[at] = wide * heap.scale
    if not flat and heights and (max(heights) - min(heights)) * heap.scale > LEVEL_UM:
        heap.problem("not-flat", at)
        return
    heap.polylines.append(np.array(rows, float).reshape(-1, 3))
    heap.polyline_of.append((at, bool(entity.is_closed), flip))


def _ellipse(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is None:
        return
    if abs(dxf.major_axis[2]) * heap.scale > LEVEL_UM:
        heap.problem("tilted", at)
        return
    heap.heights[at] = dxf.center[2] * heap.scale
    curve, turn = of_ellipse(dxf, heap.scale, flip)
    if turn in TELLING:
        heap.problem(TELLING[turn], at)
    heap.curves.append((at, curve))


def _spline(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    curve, odd = of_spline(entity, heap.scale)
    for code in odd:
        heap.problem(code, at)
    if curve is None:
        heap.dropped.append(at)
    else:
        heap.curves.append((at, curve))


def _point(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    x, y, _ = dxf.location
    heap.points.append((at, x * heap.scale, y * heap.scale))


def _insert(heap: Heap, at: int, entity: Entity, dxf: Entity) -> None:
    flip = _flip(heap, at, dxf)
    if flip is None:
        return
    x, y, _ = dxf.insert if dxf.hasattr("insert") else (0.0, 0.0, 0.0)
    cos, sin = cos_sin(np.array([dxf.rotation]))
    c, s = float(cos[0]), float(sin[0])
    sx, sy = dxf.xscale, dxf.yscale
    mirror = -1.0 if flip else 1.0
    matrix = (mirror * c * sx, s * sx, mirror * -s * sy, c * sy, mirror * x, y)
    # The grid turns with the INSERT and is not scaled.
    across, up = dxf.column_spacing, dxf.row_spacing
    step = (mirror * c * across, s * across, mirror * -s * up, c * up)
    # A count of 0 is 1: exporters write it where there is no grid, and CAD programs show the block.
    columns, rows = dxf.column_count or 1, dxf.row_count or 1
    if columns > 0 and rows > 0:  # otherwise a problem of whatever shows the block
        columns, rows = columns if across else 1, rows if up else 1
    attributes = len(entity.attribs)
    heap.inserts.append(Insert(at, str(dxf.name), matrix, columns, rows, step, attributes))
    if entity.has_extension_dict and "ACAD_FILTER" in entity.get_extension_dict():
        heap.problem("clipped-block", at)


CONVERTERS: dict[str, Converter] = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "SPLINE": _spline,
    "ELLIPSE": _ellipse,
    "POINT": _point,
    "INSERT": _insert,
}


# --- from figures to segments ---------------------------------------------------------------


def cos_sin(degrees: Floats) -> tuple[Floats, Floats]:
    """Return cosine and sine of angles in degrees, exact at multiples of 90.

    >>> [float(v[0]) for v in cos_sin(np.array([270.0]))]
    [0.0, -1.0]
    """
    turns = np.round(degrees / 90.0)
    rest = np.radians(degrees - 90.0 * turns)
    c, s = np.cos(rest), np.sin(rest)
    quarter = np.mod(turns, 4).astype(np.int64)
    cos = np.choose(quarter, (c, -s, -c, s)) + 0.0  # + 0.0: no negative zero
    sin = np.choose(quarter, (s, c, -s, -c)) + 0.0
    return cos, sin


def segments_of(heap: Heap) -> Rows:
    """Return the segments of all that was gathered, um, in order of entity."""
    with np.errstate(all="ignore"):  # what overflows is refused right after
        parts = [_of_lines(heap), _of_arcs(heap), _of_circles(heap), _of_polylines(heap)]
        rows = np.concatenate(parts)
        size = np.zeros(len(rows))
        for name in ("x0", "y0", "x1", "y1", "cx", "cy"):
            size = np.maximum(size, np.abs(rows[name]))
        good = size <= FARTHEST_UM  # False for NaN, too
    for at in sorted(set(rows["source"][~good].tolist())):
        heap.problem("bad-number", at)
    nothing = good & (rows["turn"] == 0)
    nothing &= (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
    nothing |= good & (rows["turn"] == 2)
    heap.dropped += rows["source"][nothing].tolist()
    rows = rows[good & ~nothing]
    ordered: Rows = rows[np.argsort(rows["source"], kind="stable")]
    return ordered


def _of_lines(heap: Heap) -> Rows:
    xy = np.array(heap.lines, float).reshape(-1, 4) * heap.scale
    out = np.zeros(len(xy), SEGMENT)
    for k, name in enumerate(("x0", "y0", "x1", "y1")):
        out[name] = xy[:, k]
    out["source"] = heap.line_of
    return out


def _of_arcs(heap: Heap) -> Rows:
    raw = np.array(heap.arcs, float).reshape(-1, 6)
    out = np.zeros(len(raw), SEGMENT)
    flip = raw[:, 5] != 0
    side = np.where(flip, -1.0, 1.0)
    cx, cy = side * raw[:, 0] * heap.scale, raw[:, 1] * heap.scale
    r = raw[:, 2] * heap.scale
    for end, angle in ((0, raw[:, 3]), (1, raw[:, 4])):
        c, s = cos_sin(np.where(np.isfinite(angle), angle, 0.0))
        out[f"x{end}"] = np.where(np.isfinite(angle), cx + side * r * c, np.nan)
        out[f"y{end}"] = cy + r * s
    out["cx"], out["cy"] = cx, cy
    out["turn"] = np.where(r == 0, 2, np.where(flip, -1, 1))  # 2: nothing, dropped below
    out["source"] = heap.arc_of
    return out


def _of_circles(heap: Heap) -> Rows:
    raw = np.array(heap.circles, float).reshape(-1, 4)
    out = np.zeros(len(raw), SEGMENT)
    out["cx"] = np.where(raw[:, 3] != 0, -1.0, 1.0) * raw[:, 0] * heap.scale
    out["cy"] = raw[:, 1] * heap.scale
    r = raw[:, 2] * heap.scale
    out["x0"] = out["x1"] = out["cx"] + r
    out["y0"] = out["y1"] = out["cy"]
    out["turn"] = np.where(r == 0, 2, 1)
    out["source"] = heap.circle_of
    return out


def _of_polylines(heap: Heap) -> Rows:
    """Return the segments between vertices; bulge = tan(sweep / 4), > 0 counter-clockwise.

    With the chord c and bulge b the centre lies c (1 - b^2) / 4b to the left of its middle.
    Repeated vertices give segments without length, which are dropped: the bulges of their
    neighbours stay where they are.
    """
    if not heap.polylines:
        return np.zeros(0, SEGMENT)
    size = np.array([len(p) for p in heap.polylines])
    of = np.array([p[0] for p in heap.polyline_of])
    heap.dropped += of[size < 2].tolist()
    closed = np.array([p[1] for p in heap.polyline_of])
    flip = np.repeat([p[2] for p in heap.polyline_of], size)
    raw = np.concatenate(heap.polylines)
    first = np.cumsum(size) - size
    after = np.arange(len(raw)) + 1
    last = (first + size - 1)[size > 0]
    after[last] = first[size > 0]
    keep = np.ones(len(raw), np.bool_)
    keep[last] = closed[size > 0]
    keep &= np.repeat(size > 1, size)
    source = np.repeat(of, size)
    x = np.where(flip, -raw[:, 0], raw[:, 0]) * heap.scale
    y = raw[:, 1] * heap.scale
    bulge = np.where(flip, -raw[:, 2], raw[:, 2])
    k = np.flatnonzero(keep)
    n = after[k]
    out = np.zeros(len(k), SEGMENT)
    out["x0"], out["y0"], out["x1"], out["y1"] = x[k], y[k], x[n], y[n]
    b = bulge[k]
    dx, dy = x[n] - x[k], y[n] - y[k]
    chord = np.hypot(dx, dy)
    length = chord > 0
    absurd = length & ~(np.abs(b) < ABSURD_BULGE)
    for entity in sorted(set(source[k][absurd & np.isfinite(b)].tolist())):
        heap.problem("bad-bulge", entity)
    for entity in sorted(set(source[k][absurd & ~np.isfinite(b)].tolist())):
        heap.problem("bad-number", entity)
    flat = ~length | absurd | (np.abs(b) < FLAT_BULGE) | (np.abs(b) * chord < 2 * FLAT_UM)
    arc = ~flat
    safe = np.where(arc, b, 1.0)
    left = (1.0 - safe * safe) / (4.0 * safe)
    out["cx"] = np.where(arc, 0.5 * (x[k] + x[n]) - dy * left, 0.0)
    out["cy"] = np.where(arc, 0.5 * (y[k] + y[n]) + dx * left, 0.0)
    out["turn"] = np.where(arc, np.sign(b), 0)
    out["source"] = source[k]
    return out

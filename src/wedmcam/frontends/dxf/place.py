"""Blocks are put where they are inserted, and layers decide what is cut.

A block becomes a heap once, however often it is inserted; each copy is an affine transform of that
heap's arrays. Transforms are our own and not ezdxf's ``virtual_entities``: those divide by a z
scale of 0, and their children have lost their handles.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import EntityRef
from wedmcam.frontends.dxf.curves import FARTHEST_UM, Curve, Linear, ellipses_of, image, segments
from wedmcam.frontends.dxf.filters import START, TOP, Both, Filters, LayerLooks, Look
from wedmcam.frontends.dxf.kinds import is_annotation
from wedmcam.frontends.dxf.shapes import Heap, Insert, Values
from wedmcam.ir.sketch import SEGMENT, ThreadPoint

Rows = NDArray[np.void]
Matrix = tuple[float, float, float, float, float, float]
IDENTITY: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)

#: A circle on layer START up to this radius is a thread point, um.
START_RADIUS_UM = 1500.0
#: Two axes are equally scaled and square to each other within this share.
SIMILAR = 1e-9
#: Problems of an entity that is read all the same.
READ = (
    "full-arc",
    "rounded-turn",
    "no-arc",
    "over-turn",
    "negative-radius",
    "clipped-block",
    "fit-points",
    "open-spline",
)
#: A block scaled by less, in x or y, has no content: 1 m of it would be 0.1 um.
NO_SCALE = 1e-7
#: More copies of blocks, or segments, than this are no part.
MOST_COPIES, MOST_SEGMENTS = 200_000, 300_000


class Fate(Enum):
    """What becomes of entities on a layer."""

    CUT = "cut"
    HIDDEN = "hidden"
    LEFT_OUT = "left out"
    LOOK_LEFT_OUT = "left out by its line type or colour"
    START = "start"


#: What is cut, or says where a cut starts.
_TAKEN = frozenset({Fate.CUT, Fate.START})


class Layers:
    """What becomes of each layer: by its state in the drawing and by the user's filters."""

    def __init__(self, table: Any, filters: Both) -> None:
        self._off: set[str] = set()
        self._frozen: set[str] = set()
        for layer in table:
            name = str(layer.dxf.get("name", "")).casefold()
            if layer.dxf.get("color", 7) < 0:
                self._off.add(name)
            if layer.dxf.get("flags", 0) & 1:
                self._frozen.add(name)
        self._filters = filters
        self._fates: dict[str, Fate] = {}

    def frozen(self, layer: str) -> bool:
        """Return whether a layer is frozen: then whole blocks on it are not shown."""
        return layer.casefold() in self._frozen

    def fate(self, layer: str) -> Fate:
        """Return what becomes of entities on a layer."""
        if layer not in self._fates:
            self._fates[layer] = self._decide(layer.casefold())
        return self._fates[layer]

    def _decide(self, name: str) -> Fate:
        if name in self._off or name in self._frozen or name == "defpoints":
            return Fate.HIDDEN
        if self._filters and self._filters.leaves_out(name, name == START):
            return Fate.LEFT_OUT
        return Fate.START if name == START else Fate.CUT


Census = Counter[tuple[str, str]]


@dataclass(slots=True)
class Placement:
    """What a drawing comes to.

    Attributes:
        sources: where each entity with segments came from; some may be filtered out.
        points: thread points.
        cut: (type, layer) -> how many entities were read as geometry.
        others: likewise what is never cut: text and the like.
        hidden: likewise what the drawing does not show.
        left_out: likewise what is on layers that the user leaves out.
        looks_left_out: likewise what is of a line type or colour that the user leaves out.
        types_left_out: likewise what is of a type that the user leaves out.
        no_points: likewise what is on layer START and is no thread point.
        problems: (code, values of the finding) -> the entities that have it, each once.
        heights: height, whole um -> the first entity drawn at it; of the layout, not of blocks.
        approximated: curves that became arcs, by type; `arcs` and `lines` counts them.
        circles: curves that are circles but for nothing.
        curve_um: how far a curve is from its arcs at most, um; None where there is no curve.
        too_large: whether copying stopped at a limit.
        blocks: names, in lower case, of the blocks that hold what is cut, or a thread point.
    """

    sources: list[EntityRef] = field(default_factory=list)
    points: list[ThreadPoint] = field(default_factory=list)
    cut: Census = field(default_factory=Counter)
    others: Census = field(default_factory=Counter)
    hidden: Census = field(default_factory=Counter)
    left_out: Census = field(default_factory=Counter)
    looks_left_out: Census = field(default_factory=Counter)
    types_left_out: Census = field(default_factory=Counter)
    no_points: Census = field(default_factory=Counter)
    problems: dict[tuple[str, Values], dict[EntityRef, None]] = field(default_factory=dict)
    dropped: dict[EntityRef, None] = field(default_factory=dict)
    widths: dict[EntityRef, float] = field(default_factory=dict)
    heights: dict[int, EntityRef] = field(default_factory=dict)
    approximated: Counter[str] = field(default_factory=Counter)
    arcs: int = 0
    lines: int = 0
    stretched: dict[EntityRef, None] = field(default_factory=dict)
    circles: dict[EntityRef, None] = field(default_factory=dict)
    curve_um: float | None = None
    too_large: EntityRef | None = None
    blocks: set[str] = field(default_factory=set)

    def problem(self, code: str, ref: EntityRef, **values: str | int) -> None:
        """Note that something is wrong with an entity; ``values``: of the finding."""
        self.problems.setdefault((code, tuple(values.items())), {}).setdefault(ref)


@dataclass(frozen=True, slots=True)
class _Copy:
    """A heap somewhere: how it is transformed, by which INSERTs, and what layer 0 means in it.

    ``look``: what BYBLOCK means in it.
    """

    heap: Heap
    matrix: Matrix
    via: tuple[str, ...]
    names: tuple[str, ...]
    layer: str
    hidden: bool
    look: Look = TOP

    @property
    def flat(self) -> bool:
        """Whether nothing is left of it, by a scale of 0."""
        a, b, c, d, _, _ = self.matrix
        return bool(min(np.hypot(a, b), np.hypot(c, d)) < NO_SCALE)


@dataclass(slots=True, eq=False)
class _Variant:
    """The segments of a heap for copies of one size: its curves are arcs here.

    Attributes:
        segments: ``source`` indexes the heap's entities.
        used: the entities that have segments.
        rank: for each segment the index of its entity in ``used``.
        curves: the entities that were curves: error in um of the part, and whether the entity is
            arcs or lines but for nothing.
        stretched: the entities that were arcs and are ellipses here.
        circles: the entities that are circles, or make one together.
        problems: (code, entity).
    """

    segments: Rows
    used: NDArray[np.int64]
    rank: NDArray[np.int64]
    curves: dict[int, tuple[float, bool]]
    stretched: set[int]
    circles: list[int]
    problems: list[tuple[str, int]]


@dataclass(frozen=True, slots=True, eq=False)
class _Wanted:
    """A heap whose copies are ``size`` times as large, or its image under an unequal scale.

    With ``linear`` the image is made before the curves become arcs, and is only moved afterwards.
    """

    heap: Heap
    size: float
    linear: Linear | None


@dataclass(slots=True)
class _Batch:
    """The copies of one variant: all are transformed at once."""

    variant: _Variant
    matrices: list[Matrix] = field(default_factory=list)
    first: list[int] = field(default_factory=list)
    keep: list[NDArray[np.bool_] | None] = field(default_factory=list)

    def rows(self, scale: float) -> Rows:
        """Return the segments of all copies."""
        segments = self.variant.segments
        if self.matrices == [IDENTITY]:
            out = segments.copy()
        else:
            out = _transformed(segments, np.array(self.matrices), scale)
        out["source"] = (np.array(self.first)[:, None] + self.variant.rank).ravel()
        if all(k is None for k in self.keep):
            return out
        whole = np.ones(len(segments), np.bool_)
        kept: Rows = out[np.concatenate([whole if k is None else k for k in self.keep])]
        return kept


#: Returns the heap of a layout or block; the second argument says whether it is annotation.
Gather = Callable[[Any, bool], Heap]


class Placer:
    """Puts heaps where they belong; `placed` holds the result."""

    def __init__(
        self,
        doc: Any,
        scale: float,
        layers: Layers,
        file: str,
        gather: Gather,
        filters: Filters,
        tolerance: float = 1.0,
    ) -> None:
        self._doc, self._scale, self._layers, self._file = doc, scale, layers, file
        self._gather, self._filters = gather, filters
        self._looks = LayerLooks(doc.layers)
        self._tolerance = tolerance
        self._wanted: dict[tuple[int, Any], _Wanted] = {}
        self._copied: list[tuple[_Copy, list[Fate], tuple[int, Any], Matrix]] = []
        self._blocks: dict[str, tuple[Heap, float, float] | None] = {}
        self._batches: dict[int, _Batch] = {}
        self._copies = 0
        self._segments = 0
        self.placed = Placement()

    def place(self, layout: Any) -> None:
        """Put a layout, and every block inserted in it, in depth first order."""
        stack = [_Copy(self._gather(layout, False), IDENTITY, (), (), "0", False)]
        while stack and self.placed.too_large is None:
            copy = stack.pop()
            self._put(copy)
            stack += reversed(list(self._inserted(copy)))
        with np.errstate(all="ignore"):  # what overflows is refused as a bad number
            curves = _fitted(self._wanted, self._tolerance)
        for copy, fates, key, matrix in self._copied:
            if self.placed.too_large is None:
                self._take(copy, fates, curves[key], matrix)

    def _ref(self, copy: _Copy, at: int) -> EntityRef:
        kind, handle, layer = copy.heap.entities[at]
        layer = copy.layer if layer == "0" else layer
        linetype = self._look(copy, at, layer).linetype or ""
        return EntityRef(self._file, handle, kind, layer, copy.via, linetype)

    def _look(self, copy: _Copy, at: int, layer: str) -> Look:
        """Return how an entity of a copy is seen."""
        return self._looks.seen(copy.heap.looks.get(at), layer, copy.look)

    def _fates(self, copy: _Copy) -> list[Fate]:
        """Return what becomes of each entity of a copy."""
        fates = []
        inserts = {i.entity for i in copy.heap.inserts} if self._filters.by_look else set()
        for at, (_, _, layer) in enumerate(copy.heap.entities):
            layer = copy.layer if layer == "0" else layer
            fate = self._layers.fate(layer)
            hidden = copy.hidden or at in copy.heap.invisible
            asked = self._filters.by_look and fate in _TAKEN and at not in inserts
            if hidden:
                fate = Fate.HIDDEN
            elif asked and self._filters.leaves_out_look(self._look(copy, at, layer), layer):
                fate = Fate.LOOK_LEFT_OUT
            fates.append(fate)
        return fates

    def _shown(self, copy: _Copy) -> bool:
        """Return whether something of a copy would be cut, or be a thread point."""
        return not _TAKEN.isdisjoint(self._fates(copy))

    def _put(self, copy: _Copy) -> None:
        out, heap = self.placed, copy.heap
        fates = self._fates(copy)
        if copy.names and not _TAKEN.isdisjoint(fates):
            out.blocks.add(copy.names[-1])
        blocks = {i.entity for i in heap.inserts}
        bad = {p.entity for p in heap.problems if p.code not in READ}
        books = {
            Fate.CUT: out.cut,
            Fate.HIDDEN: out.hidden,
            Fate.LEFT_OUT: out.left_out,
            Fate.LOOK_LEFT_OUT: out.looks_left_out,
        }
        points = {p[0] for p in heap.points}
        for at, (kind, _, layer) in enumerate(heap.entities):
            fate = fates[at]
            if at in blocks or fate is Fate.START:
                continue
            book = books[fate]
            if fate is Fate.CUT and (at in points or at in bad):
                if at in bad:
                    continue
                book = out.others
            book[kind, copy.layer if layer == "0" else layer] += 1
        for (kind, layer), count in heap.others.items():
            layer = copy.layer if layer == "0" else layer
            fate = Fate.HIDDEN if copy.hidden else self._layers.fate(layer)
            book = books.get(fate, out.no_points)
            (out.others if fate is Fate.CUT else book)[kind, layer] += count
        for (kind, layer), count in heap.ignored.items():
            layer = copy.layer if layer == "0" else layer
            fate = Fate.HIDDEN if copy.hidden else self._layers.fate(layer)
            book = out.types_left_out if fate in (Fate.CUT, Fate.START) else books[fate]
            book[kind, layer] += count
        for problem in heap.problems:
            if fates[problem.entity] is Fate.CUT:
                out.problem(problem.code, self._ref(copy, problem.entity), **dict(problem.values))
        if not copy.via:
            for at, z in heap.heights.items():
                if fates[at] is Fate.CUT and abs(z) <= FARTHEST_UM and round(z) not in out.heights:
                    out.heights[round(z)] = self._ref(copy, at)
        for at in heap.dropped:
            if fates[at] is Fate.CUT:
                out.dropped.setdefault(self._ref(copy, at))
        size = float(np.hypot(copy.matrix[0], copy.matrix[1]))
        for at, width in heap.widths.items():
            if fates[at] is Fate.CUT:
                out.widths.setdefault(self._ref(copy, at), width * size)
        if Fate.START in fates:
            self._thread_points(copy, fates)
        if not len(heap.segments) and not heap.curves:
            return
        if not any(f is Fate.CUT for f in fates):
            return
        m: Matrix = copy.matrix
        key: Any = None
        linear: Linear | None = None
        curved = bool(heap.curves) or bool((heap.segments["turn"] != 0).any())
        if curved and not _similar(m):
            linear = key = m[:4]
            m = (1.0, 0.0, 0.0, 1.0, m[4], m[5])
        elif heap.curves:
            key = _finer(float(np.hypot(m[0], m[1])))
        where = id(heap), key
        if where not in self._wanted:
            self._wanted[where] = _Wanted(heap, 1.0 if linear else key or 1.0, linear)
        self._copied.append((copy, fates, where, m))

    def _take(self, copy: _Copy, fates: list[Fate], variant: _Variant, matrix: Matrix) -> None:
        """Put the segments of a copy where they belong."""
        out = self.placed
        self._report(copy, variant, fates)
        keep = None
        if any(f is not Fate.CUT for f in fates):
            keep = np.array([f is Fate.CUT for f in fates])[variant.segments["source"]]
            if not keep.any():
                return
        if not len(variant.segments):
            return
        batch = self._batches.setdefault(id(variant), _Batch(variant))
        batch.matrices.append(matrix)
        batch.first.append(len(out.sources))
        batch.keep.append(keep)
        out.sources += [self._ref(copy, at) for at in variant.used.tolist()]
        self._segments += len(variant.segments)
        if self._segments > MOST_SEGMENTS:
            out.too_large = self._ref(copy, int(variant.used[0]))

    def _report(self, copy: _Copy, variant: _Variant, fates: list[Fate]) -> None:
        """Take over what was found in making a copy's curves arcs."""
        out = self.placed
        for code, at in variant.problems:
            if fates[at] is Fate.CUT:
                ref = self._ref(copy, at)
                if code == "zero-length":
                    out.dropped.setdefault(ref)
                else:
                    out.problem(code, ref)
        for at in variant.circles:
            if fates[at] is Fate.CUT:
                out.circles.setdefault(self._ref(copy, at))
        rows = variant.segments
        for at, (error, exact) in variant.curves.items():
            if fates[at] is not Fate.CUT:
                continue
            out.curve_um = max(out.curve_um or 0.0, error)
            if exact:
                continue
            if at in variant.stretched:
                out.stretched.setdefault(self._ref(copy, at))
            out.approximated[copy.heap.entities[at][0]] += 1
            mine = rows["turn"][rows["source"] == at] != 0
            out.arcs += int(mine.sum())
            out.lines += int((~mine).sum())

    def rows(self) -> Rows:
        """Return all segments, um, copies of a block together; ``source`` as in `placed`."""
        parts = [np.zeros(0, SEGMENT)]
        parts += [b.rows(self._scale) for b in self._batches.values()]
        return np.concatenate(parts)

    def _thread_points(self, copy: _Copy, fates: list[Fate]) -> None:
        """Take points and small circles on layer START."""
        out, heap = self.placed, copy.heap
        taken = set()
        rows = _transformed(heap.segments, np.array([copy.matrix]), self._scale)
        a, b, c, d, e, f = copy.matrix
        for at, x, y in heap.points:
            if fates[at] is Fate.START:
                taken.add(at)
                px, py = a * x + c * y + e * self._scale, b * x + d * y + f * self._scale
                self._thread(px, py, self._ref(copy, at))
        whole = (rows["turn"] != 0) & (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
        for row in rows[whole]:
            at = int(row["source"])
            if fates[at] is Fate.START and row["x0"] - row["cx"] <= START_RADIUS_UM:
                taken.add(at)
                self._thread(float(row["cx"]), float(row["cy"]), self._ref(copy, at))
        blocks = {i.entity for i in heap.inserts}
        for at, (kind, _, layer) in enumerate(heap.entities):
            if fates[at] is Fate.START and at not in taken and at not in blocks:
                out.no_points[kind, copy.layer if layer == "0" else layer] += 1

    def _thread(self, x: float, y: float, ref: EntityRef) -> None:
        if np.isfinite(x) and np.isfinite(y):
            self.placed.points.append(ThreadPoint(x, y, ref))
        else:
            self.placed.problem("bad-number", ref)

    def _inserted(self, copy: _Copy) -> Iterator[_Copy]:
        """Yield the copies that the INSERTs of a copy ask for."""
        out = self.placed
        for insert in copy.heap.inserts:
            ref = self._ref(copy, insert.entity)
            invisible = insert.entity in copy.heap.invisible
            hidden = copy.hidden or invisible or self._layers.frozen(ref.layer)
            if insert.attributes:
                shown = not hidden and self._layers.fate(ref.layer) is Fate.CUT
                (out.others if shown else out.hidden)["ATTRIB", ref.layer] += insert.attributes
            key = insert.name.lower()
            if key in copy.names:
                chain = " in ".join((insert.name, *reversed(copy.names[copy.names.index(key) :])))
                out.problem("block-cycle", ref, chain=chain)
                continue
            block = self._block(insert.name)
            if block is None:
                if not hidden:
                    out.problem("missing-block", ref, block=insert.name)
                continue
            heap, bx, by = block
            via, names = (*copy.via, ref.handle), (*copy.names, key)
            matrix = _times(copy.matrix, _local(insert, 0, 0, bx, by))
            look = self._look(copy, insert.entity, ref.layer)
            first = _Copy(heap, matrix, via, names, ref.layer, hidden, look)
            if min(insert.columns, insert.rows) < 0:
                if self._shown(first):
                    grid = {"columns": insert.columns, "rows": insert.rows}
                    out.problem("insert-count", ref, block=insert.name, **grid)
                continue
            if first.flat and self._shown(first):
                out.problem("scale-zero", ref, block=insert.name)
                continue
            copies = insert.columns * insert.rows
            self._copies += copies
            if self._copies > MOST_COPIES:
                out.too_large = ref
                return
            for column, row in _grid(insert):
                m = _local(insert, column, row, bx, by)
                yield replace(first, matrix=_times(copy.matrix, m))

    def _block(self, name: str) -> tuple[Heap, float, float] | None:
        """Return the heap of a block and its base point; None where the drawing has no such."""
        key = name.lower()  # as ezdxf: case makes no difference
        if key not in self._blocks:
            layout = self._doc.blocks.get(name)
            if layout is None or layout.block is None or layout.block.is_xref:
                self._blocks[key] = None
            else:
                x, y, _ = layout.block.dxf.get("base_point", (0.0, 0.0, 0.0))
                self._blocks[key] = self._gather(layout, is_annotation(name)), x, y
        return self._blocks[key]


def finite(rows: Rows, placed: Placement) -> Rows:
    """Drop rows that a block's scale has thrown out of any range, and say so."""
    size = np.zeros(len(rows))
    for name in ("x0", "y0", "x1", "y1", "cx", "cy"):
        size = np.maximum(size, np.abs(rows[name]))
    good = size <= FARTHEST_UM
    for at in sorted(set(rows["source"][~good].tolist())):
        placed.problem("bad-number", placed.sources[at])
    return rows if good.all() else rows[good]


def _finer(size: float) -> float:
    """Return a scale, rounded up so that copies of many sizes share few fits.

    >>> _finer(1.0), _finer(0.5), 3.0 <= _finer(3.0) < 3.6
    (1.0, 0.5, True)
    """
    if not 0 < size < 1e12:
        return 1.0
    return float(2.0 ** (np.ceil(4.0 * np.log2(size) - 1e-9) / 4.0))


def _fitted(
    wanted: dict[tuple[int, Any], _Wanted], tolerance: float
) -> dict[tuple[int, Any], _Variant]:
    """Return the segments of every variant that is wanted; ``tolerance`` in the part, um.

    All curves of a drawing are fitted in one go.
    """
    curves: list[tuple[int, Curve]] = []
    tolerances: list[float] = []
    frames: list[int] = []
    parts: list[tuple[Rows, set[int]]] = []
    for frame, want in enumerate(wanted.values()):
        rows = want.heap.segments
        mine: list[tuple[int, Curve]] = list(want.heap.curves)
        stretched: set[int] = set()
        if want.linear is not None:
            linear = want.linear
            arc = rows["turn"] != 0
            stretched = set(rows["source"][arc].tolist())
            arcs = zip(rows["source"][arc].tolist(), ellipses_of(rows[arc]), strict=True)
            mine = sorted(((at, image(c, linear)) for at, c in [*mine, *arcs]), key=lambda p: p[0])
            rows = _transformed(rows[~arc], np.array([[*linear, 0.0, 0.0]]), 1.0)
        curves += mine
        tolerances += [tolerance / want.size] * len(mine)
        frames += [frame] * len(mine)
        parts.append((rows, stretched))
    got = segments([c for _, c in curves], tolerances, frames) if curves else None
    frame_of = np.array(frames, np.int64)
    entity = np.array([at for at, _ in curves], np.int64)
    out: dict[tuple[int, Any], _Variant] = {}
    for frame, (key, want) in enumerate(wanted.items()):
        rows, stretched = parts[frame]
        first, last = np.searchsorted(frame_of, [frame, frame + 1]).tolist()
        if got is None or first == last:
            out[key] = _variant_of(rows, stretched)
            continue
        a, b = np.searchsorted(got.rows["source"], [first, last]).tolist()
        more = got.rows[a:b].copy()
        more["source"] = entity[more["source"]]
        rows = np.concatenate([rows, more])
        rows = rows[np.argsort(rows["source"], kind="stable")]
        variant = out[key] = _variant_of(rows, stretched)
        for k in range(first, last):
            at = int(entity[k])
            error, exact = variant.curves.get(at, (0.0, True))
            error = max(error, float(got.error[k]) * want.size)
            variant.curves[at] = error, exact and k in got.exact
    if got is not None:
        variants = list(out.values())
        for code, which in (
            ("bad-number", got.absurd),
            ("flat-ellipse", got.flat),
            ("coarse-spline", got.missed),
            ("zero-length", got.nothing),
        ):
            for k in which:
                variants[frames[k]].problems.append((code, int(entity[k])))
        for k in got.circles:
            variants[frames[k]].circles.append(int(entity[k]))
    return out


def _variant_of(rows: Rows, stretched: set[int]) -> _Variant:
    # Not np.unique: it imports numpy.ma, which every start would pay for.
    there = np.bincount(rows["source"]) > 0
    rank = (np.cumsum(there) - 1)[rows["source"]]
    return _Variant(rows, np.flatnonzero(there), rank, {}, stretched, [], [])


def _grid(insert: Insert) -> Iterator[tuple[int, int]]:
    for row in range(insert.rows):
        for column in range(insert.columns):
            yield column, row


def _local(insert: Insert, column: int, row: int, bx: float, by: float) -> Matrix:
    """Return the transform from a block's frame into that of its INSERT's heap."""
    a, b, c, d, e, f = insert.matrix
    ax, ay, ux, uy = insert.step
    e += column * ax + row * ux - (a * bx + c * by)
    f += column * ay + row * uy - (b * bx + d * by)
    return (a, b, c, d, e, f)


def _times(outer: Matrix, inner: Matrix) -> Matrix:
    """Return the transform that does ``inner`` first."""
    a, b, c, d, e, f = outer
    p, q, r, s, t, u = inner
    return (
        a * p + c * q,
        b * p + d * q,
        a * r + c * s,
        b * r + d * s,
        a * t + c * u + e,
        b * t + d * u + f,
    )


def _similar(m: Matrix) -> bool:
    """Return whether a transform keeps circles circles."""
    a, b, c, d, _, _ = m
    size = a * a + b * b
    return abs(size - (c * c + d * d)) <= SIMILAR * size and abs(a * c + b * d) <= SIMILAR * size


def _transformed(rows: Rows, matrices: NDArray[np.float64], scale: float) -> Rows:
    """Return the segments under each transform; circles start at their right-most point again."""
    out = np.tile(rows, len(matrices))
    a, b, c, d, e, f = (matrices[:, k : k + 1] for k in range(6))
    with np.errstate(all="ignore"):
        for x, y in (("x0", "y0"), ("x1", "y1"), ("cx", "cy")):
            out[x] = (a * rows[x] + c * rows[y] + e * scale).ravel()
            out[y] = (b * rows[x] + d * rows[y] + f * scale).ravel()
        mirrored = (a * d - b * c < 0) & (rows["turn"] != 0)
        size = np.hypot(a, b) * (rows["x0"] - rows["cx"])
    line = np.tile(rows["turn"] == 0, len(matrices))
    out["cx"] = np.where(line, 0.0, out["cx"])
    out["cy"] = np.where(line, 0.0, out["cy"])
    out["turn"] = np.where(mirrored.ravel(), -out["turn"], out["turn"])
    whole = (rows["turn"] != 0) & (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
    if whole.any():
        ring = np.tile(whole, len(matrices))
        out["x0"][ring] = out["x1"][ring] = out["cx"][ring] + size.ravel()[ring]
        out["y0"][ring] = out["y1"][ring] = out["cy"][ring]
        out["turn"][ring] = 1
    return out

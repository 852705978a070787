"""The whole of reading a DXF drawing: bytes in, a sketch and what was found on the way out.

Nothing is dropped in silence: what is not cut is counted by type and layer, what would be cut wrong
is an error with its handle, and what was put right is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Set
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, EntityRef, FileSpan, error, has_errors, note, warning
from wedmcam.frontends.dxf import units
from wedmcam.frontends.dxf.contradictions import Reading, contradictions
from wedmcam.frontends.dxf.filters import TOP, Filters, LayerLooks, Look, filters_of
from wedmcam.frontends.dxf.kinds import BOUNDED, GEOMETRY, is_annotation
from wedmcam.frontends.dxf.load import Loaded, load
from wedmcam.frontends.dxf.place import (
    MOST_COPIES,
    MOST_SEGMENTS,
    Census,
    Fate,
    Layers,
    Placement,
    Placer,
    finite,
)
from wedmcam.frontends.dxf.salvage import Unreadable
from wedmcam.frontends.dxf.shapes import Heap, gather, type_of
from wedmcam.frontends.dxf.tags import Tags
from wedmcam.frontends.dxf.texts import texts_of
from wedmcam.frontends.dxf.unread import unread
from wedmcam.frontends.options import DrawingReading
from wedmcam.ir.colours import of_rgb
from wedmcam.ir.sketch import Sketch, SketchInfo, Unread

Rows = NDArray[np.void]

#: Heights that differ by more are meant, um: a taper has its upper and its lower outline.
TAPER_UM = 100.0
#: How many handles a finding about many entities names.
NAMED = 5
#: Sides that differ by less are those of a circle, mm.
ROUND_MM = 1e-3
#: Of entities that cannot be read this many are listed.
MOST_UNREADABLE = 20


def read(
    data: bytes,
    file: str,
    options: DrawingReading | None = None,
    wished: Set[str] | None = None,
) -> tuple[Sketch | None, tuple[Diagnostic, ...]]:
    """Return the lines and arcs of a DXF drawing, in um, drawing coordinates.

    Args:
        data: the file, text or binary DXF of any version that ezdxf reads.
        file: its name, for the findings.
        options: units and layers.
        wished: names of filters that are of this drawing alone: one that matches nothing is said;
            None: all.

    Returns:
        The sketch, and findings. The sketch is None where the file cannot be read or nobody says
        its units; with any other error it holds what could be read, for a look at it. A sketch
        that comes with errors must not be cut. Segments are in order of entity, blocks after the
        layout or block that inserts them. Never raises, whatever the bytes.
    """
    options = options or DrawingReading()
    loaded, found_loading = load(data, file)
    if loaded is None:
        return None, found_loading
    found = list(found_loading)
    header = loaded.header
    unit, said = units.choose(
        header.insunits, header.measurement, options.units, options.fill_in_units, file
    )
    found += said
    filters, said = filters_of(loaded.doc, options, file, type_of, wished)
    found += said
    layers = Layers(loaded.doc.layers, filters.layers)
    # Without units the size is still wanted, in drawing units: 1000 um each, printed as mm.
    scale = unit.scale or 1000.0

    def heap_of(layout: Any, annotation: bool) -> Heap:
        return gather(layout, scale, filters, annotation)

    placer = Placer(loaded.doc, scale, layers, file, heap_of, filters, options.tolerance_um)
    placer.place(loaded.doc.modelspace())
    placed = placer.placed
    rows = finite(placer.rows(), placed)
    bounds = Unread()
    if any(kind in BOUNDED for kind, _ in placed.others):
        bounds, there = unread(loaded.doc, scale, layers, file, filters, options.tolerance_um)
        _boundless(there, placed, loaded.unreadable)
    found += contradictions(
        loaded.tags,
        Reading(
            placed.blocks,
            lambda layer: layers.fate(layer) in (Fate.CUT, Fate.START),
            filters.leaves_out_type,
            options.units is None or options.fill_in_units,
            _looks(loaded, filters),
        ),
    )
    found += _unreadable(placed, loaded.unreadable)
    found += _problems(placed, loaded.tags)
    found += _curves(placed, options, file)
    found += _said(placed, _paper_space(loaded.doc), file, rows)
    if not len(rows) and not has_errors(found):
        found.append(_empty(placed, loaded.doc, options, file))
    width, height = _size(rows)
    if not unit.scale:
        found.append(units.missing(width / 1000.0, height / 1000.0, header.insunits, file))
        return None, tuple(found)
    doubt = units.doubt(unit, width, height, file) if len(rows) else None
    if doubt is not None:
        found.append(doubt)
    info = _info(loaded, placed, unit)
    written = texts_of(loaded.doc, scale) if placed.others or placed.blocks else np.zeros((0, 2))
    sketch = Sketch(rows, tuple(placed.sources), tuple(placed.points), info, bounds, written)
    return sketch, tuple(found)


def _looks(loaded: Loaded, filters: Filters) -> Callable[..., bool] | None:
    """Return what tells whether a look is left out, by what the tags of an entity say of it."""
    if not filters.by_look:
        return None
    layers = LayerLooks(loaded.doc.layers)

    def left_out(
        layer: str, linetype: str | None, index: str | None, rgb: str | None, top: bool
    ) -> bool:
        if not top and ((linetype or "").lower() == "byblock" or (rgb is None and index == "0")):
            return False  # that of each INSERT
        by_layer = linetype is None or linetype.lower() == "bylayer"
        colour = None if index in (None, "256") else index
        try:
            colour = of_rgb(int(rgb)) if rgb is not None else colour
            colour = str(abs(int(colour))) if colour and colour[0] != "#" else colour
        except ValueError:
            return False
        look = layers.seen(Look(None if by_layer else linetype, colour), layer, TOP)
        return filters.leaves_out_look(look, layer)

    return left_out


def _boundless(there: Placement, placed: Placement, unreadable: tuple[Unreadable, ...]) -> None:
    """Note what is not read and has no boundary that can be had."""
    for (code, text), refs in there.problems.items():
        if code == "unreadable":
            text = f"{unreadable[int(text)].place}: {unreadable[int(text)].why}"
        for ref in refs:
            if ref.dxftype in BOUNDED:
                why = f", and its boundary is not known{': ' + text if text else ''}"
                placed.problem("unsupported-entity", why, ref)
    placed.too_large = placed.too_large or there.too_large


def _size(rows: Rows) -> tuple[float, float]:
    """Return width and height of the drawing, um, arcs exact."""
    if not len(rows):
        return 0.0, 0.0
    sides = []
    start = np.arctan2(rows["y0"] - rows["cy"], rows["x0"] - rows["cx"])
    end = np.arctan2(rows["y1"] - rows["cy"], rows["x1"] - rows["cx"])
    full = (rows["x0"] == rows["x1"]) & (rows["y0"] == rows["y1"])
    sweep = np.where(full, 2 * np.pi, np.mod((end - start) * rows["turn"], 2 * np.pi))
    radius = np.hypot(rows["x0"] - rows["cx"], rows["y0"] - rows["cy"])
    for axis, quarter in (("x", 0.0), ("y", 0.5 * np.pi)):
        low = np.minimum(rows[f"{axis}0"], rows[f"{axis}1"])
        high = np.maximum(rows[f"{axis}0"], rows[f"{axis}1"])
        for angle, sign in ((quarter, 1.0), (quarter + np.pi, -1.0)):
            passed = (rows["turn"] != 0) & (
                np.mod((angle - start) * rows["turn"], 2 * np.pi) <= sweep
            )
            apex = rows[f"c{axis}"] + sign * radius
            low = np.where(passed, np.minimum(low, apex), low)
            high = np.where(passed, np.maximum(high, apex), high)
        sides.append(float(high.max() - low.min()))
    return sides[0], sides[1]


# --- what was found -------------------------------------------------------------------------

#: For each code: how to say it of n entities of a type, and a hint. {n} {what} {text}.
_SAYING: Mapping[str, tuple[Callable[..., Diagnostic], str, str | None]] = {
    "unsupported-entity": (
        error,
        "{n} cannot be read yet{text}",
        "convert into lines and arcs, or leave it out with --ignore-layer or --ignore-type",
    ),
    "tilted": (error, "{n} tilted out of the drawing plane (extrusion vector)", "lay it flat"),
    "not-flat": (error, "{n} not parallel to the drawing plane: the height changes", "lay it flat"),
    "bad-bulge": (error, "{n} with a bulge that is a full circle but for nothing", None),
    "bad-number": (error, "{n} with a coordinate that is no number, or beyond 1000 km", None),
    "damaged-drawing": (error, "{n} that cannot be understood: {text}", None),
    "missing-block": (
        error,
        "{n} of block {text}, which is not in the drawing",
        "bind external references before exporting",
    ),
    "block-cycle": (error, "block inserts itself: {text}", None),
    "flat-ellipse": (
        error,
        "{n} so flat that it is a line there and back",
        "draw a LINE, if that is meant",
    ),
    "coarse-spline": (
        error,
        "{n} that arcs cannot follow within the tolerance",
        "a larger --tolerance, or look for loops and cusps in it",
    ),
    "fit-points": (
        warning,
        "{n} with fit points only: the curve between them is not in the file, and was computed "
        "as the cubic that CAD programs draw",
        "save it with control points",
    ),
    "open-spline": (
        warning,
        "{n} marked as closed whose ends do not meet: taken as open",
        "close it in the CAD program",
    ),
    "clipped-block": (
        warning,
        "{n} with a clipping boundary, which is not applied: the whole block is taken",
        None,
    ),
    "insert-count": (
        error,
        "{n} of block {text}: how often it is to be cut cannot be told",
        "insert it as often as it is meant, or explode it",
    ),
    "scale-zero": (
        warning,
        "{n} of block {text} with a scale of 0: what is in the block is not cut",
        "give it the scale that is meant, or delete the INSERT",
    ),
    "negative-radius": (
        warning,
        "{n} with a negative radius: taken as positive",
        "look at the size, and at the side on which an arc lies",
    ),
    "rounded-turn": (
        note,
        "{n} a full turn but for the rounding of its angles: taken as whole",
        "draw a CIRCLE, or a whole ELLIPSE",
    ),
    "no-arc": (
        warning,
        "{n} whose end angle is a hair over its start angle: an arc of no length, and no circle",
        "delete it, or draw a CIRCLE if one is meant",
    ),
    "over-turn": (
        warning,
        "{n} of more than a full turn: taken without the full turns, as CAD programs do",
        "draw a CIRCLE, if one is meant",
    ),
    "full-arc": (
        warning,
        "{n} whose start and end angle are equal: taken as a full circle",
        "draw a CIRCLE",
    ),
}


def _unreadable(placed: Placement, unreadable: tuple[Unreadable, ...]) -> list[Diagnostic]:
    """Return an error for each entity that would be cut and cannot be read."""
    found = []
    hint = "correct the line named, or draw it again; --ignore-layer leaves its layer out"
    there = [(text, refs) for (code, text), refs in placed.problems.items() if code == "unreadable"]
    for text, refs in there[:MOST_UNREADABLE]:
        one, ref = unreadable[int(text)], next(iter(refs))
        many = f", there {len(refs)} times by its INSERTs" if len(refs) > 1 else ""
        what = f"{one.kind} on layer {ref.layer}{_handles([ref])}{many} cannot be read: {one.why}"
        found.append(error("damaged-drawing", what, one.span, hint=hint))
    if len(there) > MOST_UNREADABLE:
        more = len(there) - MOST_UNREADABLE
        found.append(error("damaged-drawing", f"{more} further entities cannot be read"))
    return found


def _line(tags: Tags, ref: EntityRef) -> str:
    """Return where in the file an entity stands; nothing where it has no handle there."""
    for at in np.flatnonzero(tags.codes == 5).tolist():
        if tags.value(at).strip().upper() == ref.handle.upper():
            mark = int(np.searchsorted(tags.marks, at, side="right")) - 1
            if mark >= 0 and tags.value(int(tags.marks[mark])).strip() == ref.dxftype:
                return f", {tags.place(int(tags.marks[mark]))}"
    return ""


def _problems(placed: Placement, tags: Tags) -> list[Diagnostic]:
    """Return one finding for each kind of problem and type of entity."""
    found = []
    groups: dict[tuple[str, str, str], list[EntityRef]] = {}
    for (code, text), refs in placed.problems.items():
        if code == "unreadable":
            continue
        for ref in refs:
            groups.setdefault((code, text, ref.dxftype), []).append(ref)
    for (code, text, kind), spans in groups.items():
        make, saying, hint = _SAYING[code]
        message = saying.format(n=f"{len(spans)} {kind}", text=text) + _handles(spans)
        if code == "damaged-drawing":
            message += _line(tags, spans[0])
        found.append(make(code, message, spans[0], hint=hint, count=len(spans)))
    low, high = min(placed.heights, default=0), max(placed.heights, default=0)
    if high - low > TAPER_UM:
        one, two = placed.heights[low], placed.heights[high]
        text = (
            f"geometry at heights from {low / 1e3:.3f} to {high / 1e3:.3f} mm: "
            f"a taper or a body, which is not cut as drawn by a straight wire (#{one.handle} and "
            f"#{two.handle})"
        )
        hint = "lay it flat, or take the layer of one plane with --layer"
        notes = (("this lies highest", two),)
        found.append(error("taper", text, one, notes=notes, hint=hint, count=len(placed.heights)))
    if placed.too_large is not None:
        text = (
            f"the drawing comes to more than {MOST_SEGMENTS:,} segments, or {MOST_COPIES:,} copies "
            "of blocks: reading stopped here"
        )
        found.append(error("too-large", text, placed.too_large))
    return found


def _curves(placed: Placement, options: DrawingReading, file: str) -> list[Diagnostic]:
    """Return the notes about curves that are arcs now."""
    where = FileSpan(file)
    found = []
    total = placed.approximated.total()
    if total:
        named = ", ".join(f"{n} {kind}" for kind, n in sorted(placed.approximated.items()))
        lines = f" and {placed.lines} lines" if placed.lines else ""
        text = (
            f"{named} became {placed.arcs} arcs{lines}, at most {placed.curve_um or 0.0:.2f} um "
            f"from them (tolerance {options.tolerance_um:.2f} um)"
        )
        if placed.stretched:
            text += f"; {len(placed.stretched)} by different scales in x and y of a block"
        hint = "--tolerance sets how far they may be"
        found.append(note("approximated", text, where, hint=hint, count=total))
    if placed.circles:
        spans = list(placed.circles)
        text = f"{len(spans)} SPLINE within 0.001 mm of circles: taken as circles"
        found.append(note("spline-circle", text + _handles(spans), spans[0], count=len(spans)))
    return found


def _handles(spans: Iterable[EntityRef]) -> str:
    """Return the handles of the first entities, for the end of a sentence."""
    names = ["#" + "/".join((*s.via, s.handle)) for s in spans]
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return f" ({', '.join(names[:NAMED])}{more})"


def _said(placed: Placement, paper: int, file: str, rows: Rows) -> list[Diagnostic]:
    """Return the findings about what was left out or simplified, each kind once."""
    where = FileSpan(file)
    found = []
    for make, code, census, words in (
        (warning, "not-cut", placed.others, "not cut"),
        (warning, "hidden-not-cut", placed.hidden, "hidden in the drawing and not cut"),
        (note, "layer-left-out", placed.left_out, "on layers left out"),
        (note, "type-left-out", placed.types_left_out, "of types left out"),
        (note, "look-left-out", placed.looks_left_out, "of line types or colours left out"),
        (warning, "start-layer", placed.no_points, "on layer START that are no thread points"),
    ):
        if census:
            found.append(make(code, _counted(census, words), where, count=census.total()))
    if paper:
        found.append(
            note("not-cut", f"{paper} entities in paper space not cut", where, count=paper)
        )
    if placed.dropped:
        spans = list(placed.dropped)
        many = f"{len(spans)} {'entity' if len(spans) == 1 else 'entities'} with pieces without "
        text = f"{many}length, dropped{_handles(spans)}"
        found.append(note("zero-length", text, spans[0], count=len(spans)))
    if placed.widths:
        found.append(_wide(placed, rows))
    return found


def _wide(placed: Placement, rows: Rows) -> Diagnostic:
    """Return the warning about wide polylines: what is seen of them is not what is cut."""
    spans = list(placed.widths)
    first = spans[0]
    width = placed.widths[first] / 1000.0
    mine = rows[rows["source"] == placed.sources.index(first)] if first in placed.sources else rows
    w, h = (side / 1000.0 for side in _size(mine))
    arcs = len(mine) > 0 and bool((mine["turn"] != 0).all())
    if arcs and abs(w - h) < ROUND_MM and bool((mine["cx"] == mine["cx"][0]).all()):
        shape = "disc" if width >= w - ROUND_MM else "ring"
        seen, cut = f"a {shape} of {w + width:.3f} mm", f"its centre line of {w:.3f} mm"
    else:
        seen = f"a band {width:.3f} mm wide, {w + width:.3f} x {h + width:.3f} mm"
        cut = f"its centre line, {w:.3f} x {h:.3f} mm"
    one = "1 polyline has" if len(spans) == 1 else f"{len(spans)} polylines have"
    of = "" if len(spans) == 1 else "of the first, "
    text = f"{one} a width: {of}what is seen is {seen}, what is cut is {cut}{_handles(spans)}"
    hint = "draw the edge as an outline if it is meant; set the width to 0 if the centre line is"
    return warning("polyline-width", text, first, hint=hint, count=len(spans))


def _counted(census: Census, words: str) -> str:
    """Return e.g. '7 entities not cut: 4 DIMENSION, 2 HATCH, 1 TEXT (layers 0, DIM)'.

    >>> _counted(Counter({("HATCH", "0"): 2, ("TEXT", "DIM"): 1}), "not cut")
    '3 entities not cut: 2 HATCH, 1 TEXT (layers 0, DIM)'
    """
    kinds: Counter[str] = Counter()
    for (kind, _), count in census.items():
        kinds[kind] += count
    layers = sorted({layer for _, layer in census})
    by_kind = ", ".join(f"{n} {k}" for k, n in sorted(kinds.items(), key=lambda i: (-i[1], i[0])))
    named = ", ".join(layers[:8]) + (f" and {len(layers) - 8} more" if len(layers) > 8 else "")
    total = census.total()
    return (
        f"{total} {'entity' if total == 1 else 'entities'} {words}: {by_kind} "
        f"(layer{'s' if len(layers) > 1 else ''} {named})"
    )


def _paper_space(doc: Any) -> int:
    """Return how many geometric entities the sheets hold."""
    return sum(
        entity.dxftype() in GEOMETRY
        for layout in doc.layouts
        if layout.name != "Model"
        for entity in layout
    )


def _empty(placed: Placement, doc: Any, options: DrawingReading, file: str) -> Diagnostic:
    """Return the error about a drawing with nothing to cut, with the likeliest reason."""
    paper = _paper_space(doc)
    hint = None
    if placed.left_out:
        layers = ", ".join(sorted({layer for _, layer in placed.left_out}))
        why = f"all geometry is on layers left out ({layers})"
        hint = "check --layer and --ignore-layer"
    elif placed.types_left_out:
        kinds = sorted({kind for kind, _ in placed.types_left_out})
        why = f"all geometry is of types left out ({', '.join(kinds)})"
        hint = "check --type and --ignore-type"
    elif placed.looks_left_out:
        why = "all geometry is of line types or colours left out"
        hint = "check --linetype, --ignore-linetype, --colour and --ignore-colour"
    elif placed.hidden:
        why, hint = "what it holds is hidden", "switch the layers on"
    elif paper:
        why = f"model space is empty; all {paper} entities are in paper space"
        hint = "copy the geometry into model space"
    elif placed.others:
        kinds = sorted({kind for kind, _ in placed.others})
        why = f"it holds no lines, arcs or polylines, but {', '.join(kinds[:8])}"
    elif blocks := [text for code, text in placed.problems if code == "scale-zero"]:
        why, hint = f"block {', '.join(blocks[:NAMED])} is inserted with a scale of 0", None
    else:
        why = "model space is empty"
    if nowhere := _inserted_nowhere(doc):
        why += f"; {nowhere}"
        hint = hint or "insert it where it is to be cut, or explode it"
    return error(
        "empty-drawing", f"nothing to cut in the drawing: {why}", FileSpan(file), hint=hint
    )


def _inserted_nowhere(doc: Any) -> str:
    """Return which blocks hold geometry and are inserted nowhere, or nothing."""
    inserted = {
        str(entity.dxf.name).lower()
        for block in doc.blocks
        for entity in block
        if entity.dxftype() == "INSERT" and entity.dxf.hasattr("name")
    }
    left = [
        (str(block.name), len(block))
        for block in doc.blocks
        if not block.is_any_layout
        and not is_annotation(str(block.name))
        and str(block.name).lower() not in inserted
        and any(entity.dxftype() in GEOMETRY for entity in block)
    ]
    if not left:
        return ""
    names = ", ".join(
        f"{name} ({many} {'entity' if many == 1 else 'entities'})" for name, many in left[:NAMED]
    )
    more = f" and {len(left) - NAMED} more" if len(left) > NAMED else ""
    return f"block {names}{more} {'is' if len(left) == 1 else 'are'} inserted nowhere"


def _info(loaded: Loaded, placed: Placement, unit: units.Unit) -> SketchInfo:
    """Return what was seen, for ``inspect``."""
    ignored: Census = Counter()
    for census in (
        placed.others,
        placed.hidden,
        placed.left_out,
        placed.types_left_out,
        placed.looks_left_out,
        placed.no_points,
    ):
        ignored += census
    extra: dict[str, Any] = {"binary": True} if loaded.binary else {}
    if loaded.header.insunits is not None:
        extra["$INSUNITS"] = loaded.header.insunits
    if loaded.header.measurement is not None:
        extra["$MEASUREMENT"] = loaded.header.measurement
    if placed.curve_um is not None:
        extra["spline_um"] = round(placed.curve_um + 5e-4, 3)
    return SketchInfo(
        units=unit.name,
        units_from=unit.stated_by,
        entities=_by_type(placed.cut),
        ignored=_by_type(ignored),
        version=loaded.header.version or "",
        extra=extra,
    )


def _by_type(census: Census) -> dict[str, dict[str, int]]:
    out: dict[str, dict[str, int]] = {}
    for (kind, layer), count in sorted(census.items()):
        out.setdefault(kind, {})[layer] = count
    return out

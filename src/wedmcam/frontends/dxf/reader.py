"""The whole of reading a DXF drawing: bytes in, a sketch and findings out.

The steps in their order; what they find about entities is formed in `entities`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Set
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, has_errors
from wedmcam.frontends.dxf import units
from wedmcam.frontends.dxf.contradictions import Reading, contradictions
from wedmcam.frontends.dxf.entities import findings_of, nothing_to_cut, size_of
from wedmcam.frontends.dxf.filters import TOP, Filters, LayerLooks, Look, filters_of
from wedmcam.frontends.dxf.kinds import BOUNDED
from wedmcam.frontends.dxf.load import Loaded, load
from wedmcam.frontends.dxf.place import (
    Census,
    Fate,
    Layers,
    Placement,
    Placer,
    finite,
)
from wedmcam.frontends.dxf.salvage import Unreadable
from wedmcam.frontends.dxf.shapes import Heap, gather, type_of
from wedmcam.frontends.dxf.texts import texts_of
from wedmcam.frontends.dxf.unread import unread
from wedmcam.frontends.options import DrawingReading
from wedmcam.ir.colours import of_rgb
from wedmcam.ir.sketch import Sketch, SketchInfo, Unread

Rows = NDArray[np.void]


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
        The sketch, and findings. The sketch is None where the file cannot be read or its
        units are unknown; with any other error it holds what could be read, for a look at it. A
        sketch that comes with errors must not be cut. Segments are in order of entity, blocks after
        the layout or block that inserts them. Never raises, whatever the bytes.
    """
    options = options or DrawingReading()
    loaded, found_loading = load(data, file)
    if loaded is None:
        return None, found_loading
    findings = list(found_loading)
    header = loaded.header
    unit, more = units.choose(
        header.insunits, header.measurement, options.units, options.fill_in_units, file
    )
    findings += more
    filters, more = filters_of(loaded.doc, options, file, type_of, wished)
    findings += more
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
    findings += contradictions(
        loaded.tags,
        Reading(
            placed.blocks,
            lambda layer: layers.fate(layer) in (Fate.CUT, Fate.START),
            filters.leaves_out_type,
            options.units is None or options.fill_in_units,
            _looks(loaded, filters),
        ),
    )
    findings += findings_of(placed, loaded, options, file, rows)
    if not len(rows) and not has_errors(findings):
        findings.append(nothing_to_cut(placed, loaded.doc, options, file))
    width, height = size_of(rows)
    if not unit.scale:
        findings.append(units.missing(width / 1000.0, height / 1000.0, header.insunits, file))
        return None, tuple(findings)
    doubt = units.doubt(unit, width, height, file) if len(rows) else None
    if doubt is not None:
        findings.append(doubt)
    info = _info(loaded, placed, unit)
    texts = texts_of(loaded.doc, scale) if placed.others or placed.blocks else np.zeros((0, 2))
    sketch = Sketch(rows, tuple(placed.sources), tuple(placed.points), info, bounds, texts)
    return sketch, tuple(findings)


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
    for (code, values), refs in there.problems.items():
        reason = str(dict(values).get("reason", ""))
        if code == "unreadable":
            one = unreadable[int(dict(values)["number"])]
            reason = f"{one.place}: {one.why}"
        for ref in refs:
            if ref.dxftype in BOUNDED:
                placed.problem("unsupported-entity", ref, reason=reason)
    placed.too_large = placed.too_large or there.too_large


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

"""What is found about the entities of a drawing once they are placed.

Nothing is dropped in silence: what is not cut is counted by type and layer, what would be cut wrong
is an error with its handle, and what was put right is a note.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, EntityRef, FileSpan, error, note, warning
from wedmcam.diag.lists import Listing, first_of
from wedmcam.frontends.dxf.kinds import GEOMETRY, is_annotation
from wedmcam.frontends.dxf.load import Loaded
from wedmcam.frontends.dxf.place import (
    MOST_COPIES,
    MOST_SEGMENTS,
    Census,
    Placement,
)
from wedmcam.frontends.dxf.salvage import Unreadable
from wedmcam.frontends.dxf.shapes import Values
from wedmcam.frontends.dxf.tags import Tags
from wedmcam.frontends.options import DrawingReading

Rows = NDArray[np.void]

#: Heights that differ by more are meant, um: a taper has its upper and its lower outline.
TAPER_UM = 100.0
#: How many handles a finding about many entities names.
NAMED = 5
#: How many layers, and how many types of entity, a finding about a whole drawing names.
MOST_LAYERS, MOST_TYPES = 8, 8
#: Sides that differ by less are those of a circle, mm.
ROUND_MM = 1e-3
#: Of entities that cannot be read this many are listed.
MOST_UNREADABLE = 20


#: For each code: how bad it is, the template of a finding about entities of a type, and the hint.
_PROBLEMS: Mapping[str, tuple[Callable[..., Diagnostic], str, str | None]] = {
    "unsupported-entity": (
        error,
        "{count} {entity} cannot be read yet",
        "convert into lines and arcs, or leave it out with --ignore-layer or --ignore-type",
    ),
    "tilted": (
        error,
        "{count} {entity} tilted out of the drawing plane (extrusion vector)",
        "lay it flat",
    ),
    "not-flat": (
        error,
        "{count} {entity} not parallel to the drawing plane: the height changes",
        "lay it flat",
    ),
    "bad-bulge": (
        error,
        "{count} {entity} with a bulge that is a full circle but for nothing",
        None,
    ),
    "bad-number": (
        error,
        "{count} {entity} with a coordinate that is no number, or beyond 1000 km",
        None,
    ),
    "damaged-drawing": (error, "{count} {entity} that cannot be understood: {reason}", None),
    "missing-block": (
        error,
        "{count} {entity} of block {block}, which is not in the drawing",
        "bind external references before exporting",
    ),
    "block-cycle": (error, "block inserts itself: {chain}", None),
    "flat-ellipse": (
        error,
        "{count} {entity} so flat that it is a line there and back",
        "draw a LINE, if that is meant",
    ),
    "coarse-spline": (
        error,
        "{count} {entity} that arcs cannot follow within the tolerance",
        "a larger --tolerance, or look for loops and cusps in it",
    ),
    "fit-points": (
        warning,
        "{count} {entity} with fit points only: the curve between them is not in the file, and was "
        "computed as the cubic that CAD programs draw",
        "save it with control points",
    ),
    "open-spline": (
        warning,
        "{count} {entity} marked as closed whose ends do not meet: taken as open",
        "close it in the CAD program",
    ),
    "clipped-block": (
        warning,
        "{count} {entity} with a clipping boundary, which is not applied: the whole block is taken",
        None,
    ),
    "insert-count": (
        error,
        "{count} {entity} of block {block} with {columns} columns and {rows} rows: how often to "
        "cut it is not known",
        "insert it as often as it is meant, or explode it",
    ),
    "scale-zero": (
        warning,
        "{count} {entity} of block {block} with a scale of 0: what is in the block is not cut",
        "give it the scale that is meant, or delete the INSERT",
    ),
    "negative-radius": (
        warning,
        "{count} {entity} with a negative radius: taken as positive",
        "look at the size, and at the side on which an arc lies",
    ),
    "rounded-turn": (
        note,
        "{count} {entity} a full turn but for the rounding of its angles: taken as whole",
        "draw a CIRCLE, or a whole ELLIPSE",
    ),
    "no-arc": (
        warning,
        "{count} {entity} whose end angle is a hair over its start angle: an arc of no length, and "
        "no circle",
        "delete it, or draw a CIRCLE if one is meant",
    ),
    "over-turn": (
        warning,
        "{count} {entity} of more than a full turn: taken without the full turns, as CAD programs "
        "do",
        "draw a CIRCLE, if one is meant",
    ),
    "full-arc": (
        warning,
        "{count} {entity} whose start and end angle are equal: taken as a full circle",
        "draw a CIRCLE",
    ),
}


def findings_of(
    placed: Placement, loaded: Loaded, options: DrawingReading, file: str, rows: Rows
) -> list[Diagnostic]:
    """Return what is to be known of the entities that were placed, and of those that were not.

    ``rows``: the segments that will be cut.
    """
    return [
        *_unreadable(placed, loaded.unreadable),
        *_problems(placed, loaded.tags),
        *_curves(placed, options, file),
        *_left_out(placed, _paper_space(loaded.doc), file, rows),
    ]


def _unreadable(placed: Placement, unreadable: tuple[Unreadable, ...]) -> list[Diagnostic]:
    """Return an error for each entity that would be cut and cannot be read."""
    findings = []
    there = [
        (dict(values), refs)
        for (code, values), refs in placed.problems.items()
        if code == "unreadable"
    ]
    for values, refs in there[:MOST_UNREADABLE]:
        one, ref = unreadable[int(values["number"])], next(iter(refs))
        findings.append(
            error(
                "damaged-drawing",
                "{entity} on layer {layer} ({handle}), there {often} times by its INSERTs cannot "
                "be read: {reason}"
                if len(refs) > 1
                else "{entity} on layer {layer} ({handle}) cannot be read: {reason}",
                one.span,
                hint="correct the line named, or draw it again; --ignore-layer leaves its layer "
                "out",
                entity=one.kind,
                layer=ref.layer,
                handle=_handles([ref]),
                often=len(refs),
                reason=one.why,
            )
        )
    if len(there) > MOST_UNREADABLE:
        findings.append(
            error(
                "damaged-drawing",
                "{further} further entities cannot be read",
                further=len(there) - MOST_UNREADABLE,
            )
        )
    return findings


def _line(tags: Tags, ref: EntityRef) -> str | None:
    """Return where in the file an entity stands; None where it has no handle there."""
    for at in np.flatnonzero(tags.codes == 5).tolist():
        if tags.value(at).strip().upper() == ref.handle.upper():
            mark = int(np.searchsorted(tags.marks, at, side="right")) - 1
            if mark >= 0 and tags.value(int(tags.marks[mark])).strip() == ref.dxftype:
                return tags.place(int(tags.marks[mark]))
    return None


def _problems(placed: Placement, tags: Tags) -> list[Diagnostic]:
    """Return one finding for each kind of problem and type of entity."""
    findings = []
    groups: dict[tuple[str, Values, str], list[EntityRef]] = {}
    for (code, values), refs in placed.problems.items():
        if code == "unreadable":
            continue
        for ref in refs:
            groups.setdefault((code, values, ref.dxftype), []).append(ref)
    for (code, values, kind), spans in groups.items():
        make, template, hint = _PROBLEMS[code]
        finding = make(
            code, template, spans[0], hint=hint, count=len(spans), entity=kind, **dict(values)
        )
        if code == "unsupported-entity" and values:
            finding = finding.extended(
                ", and its boundary is not known: {reason}"
                if dict(values)["reason"]
                else ", and its boundary is not known"
            )
        finding = finding.extended(" ({handles})", handles=_handles(spans))
        if code == "damaged-drawing" and (line := _line(tags, spans[0])):
            finding = finding.extended(", {line}", line=line)
        findings.append(finding)
    low, high = min(placed.heights, default=0), max(placed.heights, default=0)
    if high - low > TAPER_UM:
        one, two = placed.heights[low], placed.heights[high]
        findings.append(
            error(
                "taper",
                "geometry at heights from {lowest_mm:.3f} to {highest_mm:.3f} mm: a taper or a "
                "body, which is not cut as drawn by a straight wire (#{lowest} and #{highest})",
                one,
                notes=(("this lies highest", two),),
                hint="lay it flat, or take the layer of one plane with --layer",
                count=len(placed.heights),
                lowest_mm=low / 1e3,
                highest_mm=high / 1e3,
                lowest=one.handle,
                highest=two.handle,
            )
        )
    if placed.too_large is not None:
        findings.append(
            error(
                "too-large",
                "the drawing comes to more than {most_segments:,} segments, or {most_copies:,} "
                "copies of blocks: reading stopped here",
                placed.too_large,
                most_segments=MOST_SEGMENTS,
                most_copies=MOST_COPIES,
            )
        )
    return findings


def _curves(placed: Placement, options: DrawingReading, file: str) -> list[Diagnostic]:
    """Return the notes about curves that are arcs now."""
    where = FileSpan(file)
    findings = []
    total = placed.approximated.total()
    if total:
        finding = note(
            "approximated",
            "{curves} became {arcs} arcs and {lines} lines, at most {apart_um:.2f} um from them "
            "(tolerance {tolerance_um:.2f} um)"
            if placed.lines
            else "{curves} became {arcs} arcs, at most {apart_um:.2f} um from them (tolerance "
            "{tolerance_um:.2f} um)",
            where,
            hint="--tolerance sets how far they may be",
            count=total,
            curves=[f"{n} {kind}" for kind, n in sorted(placed.approximated.items())],
            arcs=placed.arcs,
            lines=placed.lines,
            apart_um=placed.curve_um or 0.0,
            tolerance_um=options.tolerance_um,
        )
        if placed.stretched:
            finding = finding.extended(
                "; {stretched} by different scales in x and y of a block",
                stretched=len(placed.stretched),
            )
        findings.append(finding)
    if placed.circles:
        spans = list(placed.circles)
        findings.append(
            note(
                "spline-circle",
                "{count} SPLINE within 0.001 mm of circles: taken as circles ({handles})",
                spans[0],
                count=len(spans),
                handles=_handles(spans),
            )
        )
    return findings


def _handles(spans: Iterable[EntityRef]) -> Listing:
    """Return the handles of entities."""
    return first_of(["#" + "/".join((*s.via, s.handle)) for s in spans], NAMED)


def _left_out(placed: Placement, paper: int, file: str, rows: Rows) -> list[Diagnostic]:
    """Return the findings about what was left out or simplified, each kind once."""
    where = FileSpan(file)
    findings = []
    for make, code, census, one, many in (
        (
            warning,
            "not-cut",
            placed.others,
            "{count} entity not cut: {kinds}",
            "{count} entities not cut: {kinds}",
        ),
        (
            warning,
            "hidden-not-cut",
            placed.hidden,
            "{count} entity hidden in the drawing and not cut: {kinds}",
            "{count} entities hidden in the drawing and not cut: {kinds}",
        ),
        (
            note,
            "layer-left-out",
            placed.left_out,
            "{count} entity on layers left out: {kinds}",
            "{count} entities on layers left out: {kinds}",
        ),
        (
            note,
            "type-left-out",
            placed.types_left_out,
            "{count} entity of types left out: {kinds}",
            "{count} entities of types left out: {kinds}",
        ),
        (
            note,
            "look-left-out",
            placed.looks_left_out,
            "{count} entity of line types or colours left out: {kinds}",
            "{count} entities of line types or colours left out: {kinds}",
        ),
        (
            warning,
            "start-layer",
            placed.no_points,
            "{count} entity on layer START that are no thread points: {kinds}",
            "{count} entities on layer START that are no thread points: {kinds}",
        ),
    ):
        if not census:
            continue
        total = census.total()
        layers = sorted({layer for _, layer in census})
        left_out = make(code, one if total == 1 else many, where, count=total, kinds=_kinds(census))
        findings.append(
            left_out.extended(
                " (layers {layers})" if len(layers) > 1 else " (layer {layers})",
                layers=first_of(layers, MOST_LAYERS),
            )
        )
    if paper:
        findings.append(
            note("not-cut", "{count} entities in paper space not cut", where, count=paper)
        )
    if placed.dropped:
        spans = list(placed.dropped)
        findings.append(
            note(
                "zero-length",
                "{count} entity with pieces without length, dropped ({handles})"
                if len(spans) == 1
                else "{count} entities with pieces without length, dropped ({handles})",
                spans[0],
                count=len(spans),
                handles=_handles(spans),
            )
        )
    if placed.widths:
        findings.append(_wide(placed, rows))
    return findings


def _wide(placed: Placement, rows: Rows) -> Diagnostic:
    """Return the warning about wide polylines: what is seen of them is not what is cut."""
    spans = list(placed.widths)
    first = spans[0]
    width = placed.widths[first] / 1000.0
    mine = rows[rows["source"] == placed.sources.index(first)] if first in placed.sources else rows
    w, h = (side / 1000.0 for side in size_of(mine))
    finding = warning(
        "polyline-width",
        "1 polyline has a width: what is seen is "
        if len(spans) == 1
        else "{count} polylines have a width: of the first, what is seen is ",
        first,
        hint="draw the edge as an outline if it is meant; set the width to 0 if the centre line is",
        count=len(spans),
    )
    arcs = len(mine) > 0 and bool((mine["turn"] != 0).all())
    if arcs and abs(w - h) < ROUND_MM and bool((mine["cx"] == mine["cx"][0]).all()):
        finding = finding.extended(
            "a disc of {seen_mm:.3f} mm, what is cut is its centre line of {cut_mm:.3f} mm"
            if width >= w - ROUND_MM
            else "a ring of {seen_mm:.3f} mm, what is cut is its centre line of {cut_mm:.3f} mm",
            seen_mm=w + width,
            cut_mm=w,
        )
    else:
        finding = finding.extended(
            "a band {width_mm:.3f} mm wide, {seen_x_mm:.3f} x {seen_y_mm:.3f} mm, what is cut is "
            "its centre line, {cut_x_mm:.3f} x {cut_y_mm:.3f} mm",
            width_mm=width,
            seen_x_mm=w + width,
            seen_y_mm=h + width,
            cut_x_mm=w,
            cut_y_mm=h,
        )
    return finding.extended(" ({handles})", handles=_handles(spans))


def _kinds(census: Census) -> list[str]:
    """Return how many entities there are of each type, most first.

    >>> _kinds(Counter({("HATCH", "0"): 2, ("TEXT", "DIM"): 1}))
    ['2 HATCH', '1 TEXT']
    """
    kinds: Counter[str] = Counter()
    for (kind, _), count in census.items():
        kinds[kind] += count
    return [f"{n} {k}" for k, n in sorted(kinds.items(), key=lambda i: (-i[1], i[0]))]


def _paper_space(doc: Any) -> int:
    """Return how many geometric entities the sheets hold."""
    return sum(
        entity.dxftype() in GEOMETRY
        for layout in doc.layouts
        if layout.name != "Model"
        for entity in layout
    )


def nothing_to_cut(placed: Placement, doc: Any, options: DrawingReading, file: str) -> Diagnostic:
    """Return the error about a drawing with nothing to cut, with the likeliest reason."""
    paper = _paper_space(doc)
    finding = error("empty-drawing", "nothing to cut in the drawing: ", FileSpan(file))
    if placed.left_out:
        finding = finding.extended(
            "all geometry is on layers left out ({layers})",
            hint="check --layer and --ignore-layer",
            layers=first_of(sorted({layer for _, layer in placed.left_out}), MOST_LAYERS),
        )
    elif placed.types_left_out:
        finding = finding.extended(
            "all geometry is of types left out ({types})",
            hint="check --type and --ignore-type",
            types=first_of(sorted({kind for kind, _ in placed.types_left_out}), MOST_TYPES),
        )
    elif placed.looks_left_out:
        finding = finding.extended(
            "all geometry is of line types or colours left out",
            hint="check --linetype, --ignore-linetype, --colour and --ignore-colour",
        )
    elif placed.hidden:
        finding = finding.extended("what it holds is hidden", hint="switch the layers on")
    elif paper:
        finding = finding.extended(
            "model space is empty; all {paper} entities are in paper space",
            hint="copy the geometry into model space",
            paper=paper,
        )
    elif placed.others:
        finding = finding.extended(
            "it holds no lines, arcs or polylines, but {types}",
            types=first_of(sorted({kind for kind, _ in placed.others}), MOST_TYPES),
        )
    elif blocks := [
        str(dict(values)["block"]) for code, values in placed.problems if code == "scale-zero"
    ]:
        finding = finding.extended(
            "block {blocks} is inserted with a scale of 0", blocks=first_of(blocks, NAMED)
        )
    else:
        finding = finding.extended("model space is empty")
    if nowhere := _inserted_nowhere(doc):
        finding = finding.extended(
            "; block {uninserted} is inserted nowhere"
            if len(nowhere) == 1
            else "; block {uninserted} are inserted nowhere",
            hint="" if finding.hint else "insert it where it is to be cut, or explode it",
            uninserted=first_of(nowhere, NAMED),
        )
    return finding


def _inserted_nowhere(doc: Any) -> list[str]:
    """Return the blocks that hold geometry and are inserted nowhere: "CAM (2 entities)"."""
    inserted = {
        str(entity.dxf.name).lower()
        for block in doc.blocks
        for entity in block
        if entity.dxftype() == "INSERT" and entity.dxf.hasattr("name")
    }
    return [
        f"{block.name} ({len(block)} {'entity' if len(block) == 1 else 'entities'})"
        for block in doc.blocks
        if not block.is_any_layout
        and not is_annotation(str(block.name))
        and str(block.name).lower() not in inserted
        and any(entity.dxftype() in GEOMETRY for entity in block)
    ]


def size_of(rows: Rows) -> tuple[float, float]:
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

"""What a drawing holds, as plain facts: for ``inspect``, a table or JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from wedmcam.compiler import sources
from wedmcam.compiler.results import Inspection
from wedmcam.compiler.sources import Drawn, DrawnPart
from wedmcam.diag import Diagnostic
from wedmcam.diag.run import Refused, Run
from wedmcam.files import Source, bytes_of
from wedmcam.geom import measure
from wedmcam.geom import segments as seg
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Side
from wedmcam.ir.understanding import Role, counted
from wedmcam.options import Options, take_options
from wedmcam.programs.understanding import drawn_by
from wedmcam.transforms.chain import open_contour_findings
from wedmcam.transforms.compensate.largest import Largest, largest_offset
from wedmcam.transforms.merge import merge_arcs
from wedmcam.transforms.plan.scenes import PieceScene

#: Offsets above this are not looked for, um: the ZD-065's largest, rounded up.
LARGEST_UM = 8000.0
#: Stands for the offset that is looked for, um: none is smaller.
SOME_UM = 1.0

#: Outlines of one part, and +1 for each where the wire runs to its left, -1 to its right.
_Sides = tuple[list[Contour], list[float]]


def inspect(
    source: Source, *, name: str | None = None, options: Options | None = None, **mm: Any
) -> Inspection:
    """Return what the reader sees in a drawing, and the largest offset that fits it."""
    data, name = bytes_of(source, name)
    options = take_options(options, mm)
    run = Run(options.judging.strict)
    drawn = None
    try:
        drawn = sources.read(data, name, options, run)
    except Refused:
        seen = run.values.get("seen")
        return Inspection(None, {"input": name}, tuple(run.findings), seen)
    facts, more = facts_of(name, drawn, options)
    run.findings += (*drawn.doubts, *more)
    return Inspection(drawn, facts, tuple(run.findings))


def facts_of(name: str, drawn: Drawn, options: Options) -> tuple[dict[str, Any], list[Diagnostic]]:
    """Return the facts of a drawing in mm, and findings on open contours and what cannot be cut.

    The largest permissible offset is that of the side asked for (``part`` by default), over all
    contours together, with the place that limits it.
    """
    info = drawn.sketch.info
    contours = drawn.contours
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    closed = [c for c in contours if c.closed]
    roles = Counter(Role.of(c.closed, depth) for c, depth, _ in _contours_of(drawn))
    facts: dict[str, Any] = {
        "input": name,
        "units": info.units,
        "units_from": info.units_from,
        "version": info.version,
        "size_mm": _mm(high - low),
        "size_inch": [round(float(v) / 25400, 4) for v in high - low],
        "extents_mm": _mm([*low, *high]),
        "entities": info.entities,
        "ignored": info.ignored,
        "contours": len(contours),
        "closed": len(closed),
        "open": len(contours) - len(closed),
        "outer": roles[Role.OUTER],
        "holes": roles[Role.HOLE],
        "islands": roles[Role.ISLAND],
        "understood": counted(roles.elements()),
        "thread_points_mm": [_mm([p.x, p.y]) for p in drawn.sketch.thread_points],
        "joins": drawn.report.joins,
        "largest_join_um": round(drawn.report.max_shift_um, 3),
        "duplicates": drawn.report.duplicates,
        "zero_length": drawn.report.zero_length,
        "length_mm": round(sum(measure.length(c.vertices, c.closed) for c in contours) / 1000, 3),
        "smallest_radius": _smallest_radius(contours),
        "list": [_one(k, c, d, p) for k, (c, d, p) in enumerate(_contours_of(drawn))],
    }
    facts.update(info.extra)
    scenes, unsound = _scenes_to_cut(drawn, options)
    facts["largest_offset"] = _largest(drawn, scenes, options) if closed else None
    return facts, [*open_contour_findings(contours, options.drawing.join_um), *unsound]


def _scenes_to_cut(
    drawn: Drawn, options: Options
) -> tuple[list[PieceScene] | None, list[Diagnostic]]:
    """Return what makes one part each, as it would be cut; None where that is refused.

    No offset need be stated here. Some is needed for a side.
    """
    from wedmcam.transforms.plan.idle import Used
    from wedmcam.transforms.plan.planner import scenes_to_cut

    side = None if isinstance(drawn, DrawnPart) else _side(options)
    some = options.cutting.offset_um or SOME_UM
    options = options.with_values(side=side, offset_um=some, corner_um=0.0, clearance_um=0.0)
    ar = sources.arithmetic(options.arithmetic)
    cuts, _ = drawn.cuts(options)
    return scenes_to_cut(cuts, options.cutting, options.leading.reverse, ar, Used())


def _side(options: Options) -> Side:
    return Side.DIE if options.cutting.side is Side.DIE else Side.PART


def _mm(values: Any) -> list[float]:
    return [round(float(v) / 1000, 3) + 0.0 for v in values]


def _contours_of(drawn: Drawn) -> list[tuple[Contour, int, int]]:
    return list(zip(drawn.contours, drawn.nesting.depths, drawn.nesting.parents, strict=True))


def _one(number: int, c: Contour, depth: int, parent: int) -> dict[str, Any]:
    box = measure.extents(c.vertices, c.closed)
    turn = c.starts["turn"]
    return {
        "number": number + 1,
        "closed": c.closed,
        "role": str(Role.of(c.closed, depth)),
        "depth": depth,
        "inside": parent + 1 if parent >= 0 else None,
        "lines": int(np.sum(turn == 0)),
        "arcs": int(np.sum(turn != 0)),
        "length_mm": round(measure.length(c.vertices, c.closed) / 1000, 3),
        "area_mm2": round(abs(measure.area(c.vertices)) / 1e6, 3) if c.closed else None,
        "extents_mm": _mm(box),
        "first": str(c.source_of(0)) if c.source_of(0) else None,
        "drawn_by": drawn_by(c).as_data(),
    }


def _smallest_radius(contours: tuple[Contour, ...]) -> dict[str, Any] | None:
    best: tuple[float, float, float, str] | None = None
    for c in contours:
        s = seg.of_rows(c.starts, c.ends)
        arcs = np.flatnonzero(s.turn != 0)
        if len(arcs):
            k = int(arcs[np.argmin(s.radius[arcs])])
            if best is None or s.radius[k] < best[0]:
                best = (float(s.radius[k]), float(s.cx[k]), float(s.cy[k]), str(c.source_of(k)))
    if best is None:
        return None
    return {"radius_mm": _mm([best[0]])[0], "center_mm": _mm(best[1:3]), "where": best[3]}


def _sides(drawn: Drawn, scenes: Sequence[PieceScene] | None, side: Side) -> list[_Sides]:
    """Return what makes one part each: its outlines as they are cut, and the side of the wire.

    Nothing where a part program, or one with sides of layers, is refused: what crosses itself has
    no side.
    """
    from wedmcam.transforms.plan.pieces import runs_outside

    if not isinstance(drawn, DrawnPart) and len(drawn.groups) < 2:
        chosen = [
            (merge_arcs(c), -1.0 if runs_outside(depth, side is Side.PART) else 1.0)
            for c, depth in zip(drawn.contours, drawn.nesting.depths, strict=True)
            if c.closed
        ]
        return [([c for c, _ in chosen], [s for _, s in chosen])]
    sided = [[p for p in scene.pieces if p.shift] for scene in scenes or ()]
    return [
        ([p.contour for p in pieces], [float(np.sign(p.shift)) for p in pieces])
        for pieces in sided
        if pieces
    ]


def _largest(
    drawn: Drawn, scenes: Sequence[PieceScene] | None, options: Options
) -> dict[str, Any] | None:
    """Return the largest offset without interference, and what limits it."""
    side = _side(options)
    sides = _sides(drawn, scenes, side)
    if not sides:
        return None
    outlines: list[Contour] = []
    largest = Largest(LARGEST_UM, None)
    for contours, signs in sides:
        own = largest_offset(contours, signs, largest.offset_um)
        if own.limit is not None:
            outlines, largest = contours, own
    limit = largest.limit
    result: dict[str, Any] = {"side": str(side), "offset_mm": largest.nearest_um / 1000}
    if limit is None:
        result["limited_by"] = None
        return result
    where = outlines[limit.outline].source_of(limit.row)
    result["limited_by"] = limit.kind
    result["at_mm"] = _mm(limit.at)
    result["where"] = str(where) if where else None
    return result

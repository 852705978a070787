"""From the bytes of a source to contours, and to a plan: a drawing or a part program.

Nothing here knows for which machine it is: that begins in ``pipeline``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic
from wedmcam.diag.run import Run, WrongUse
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan
from wedmcam.ir.sketch import SEGMENT, Sketch
from wedmcam.options import Options

if TYPE_CHECKING:
    from wedmcam.frontends.options import DrawingReading
    from wedmcam.transforms.chain import ChainReport
    from wedmcam.transforms.layers import Group
    from wedmcam.transforms.nest import Nesting
    from wedmcam.transforms.plan.shaped import ShapedCut
    from wedmcam.transforms.plan.wording import Wording


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """What was drawn: loose segments, and the contours they make.

    ``computed``: formulas made the contours: in another arithmetic they are others.
    ``doubts``: findings about outlines that are held by what is not read (errors, which stop the
    plan) and about frames.
    ``groups``: the same contours, by the side and the offset of their layers.
    """

    sketch: Sketch
    contours: tuple[Contour, ...]
    report: ChainReport
    nesting: Nesting
    computed: bool
    doubts: tuple[Diagnostic, ...] = ()
    groups: tuple[Group, ...] = ()

    @property
    def words(self) -> Wording:
        """What its user calls what is planned."""
        from wedmcam.transforms.plan.wording import OF_DRAWING

        return OF_DRAWING

    def cuts(self, options: Options) -> tuple[tuple[ShapedCut, ...], list[Diagnostic]]:
        """Return what is to be cut: a drawing is one cut for each side and offset."""
        from wedmcam.transforms.plan.drawing import cuts_of_drawing

        return cuts_of_drawing(
            self.groups,
            self.nesting,
            self.sketch.thread_points,
            options.cutting,
            options.leading,
            options.drawing.join_um,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What was read of a drawing, for a picture of it where it is refused.

    ``rows``: its segments, um, as the findings place them; ``sketch``: where they came from.
    """

    rows: NDArray[np.void]
    sketch: Sketch
    units: str = ""

    def whole(self) -> Seen | None:
        """Return what can be drawn; None where there is nothing."""
        return self if len(self.rows) else None


@dataclass(frozen=True, slots=True, eq=False)
class SeenWithoutUnits:
    """What was read of a drawing without units: one drawing unit is shown as 1 mm."""

    data: bytes
    file: str
    reading: DrawingReading

    def whole(self) -> Seen | None:
        """Return what can be drawn; None where there is nothing."""
        from wedmcam.frontends.dxf import read as read_dxf

        sketch, _ = read_dxf(self.data, self.file, replace(self.reading, units="mm"))
        if sketch is None or not len(sketch.segments):
            return None
        return Seen(sketch.segments, sketch, "unknown: 1 unit shown as 1 mm")


def rows_of(contours: Sequence[Contour]) -> NDArray[np.void]:
    """Return the segments of contours as `SEGMENT` rows; sources are of no one sketch."""
    parts = [np.zeros(0, SEGMENT)]
    for contour in contours:
        a, b = contour.starts, contour.ends
        rows = np.zeros(len(a), SEGMENT)
        for name, of in (("x0", a["x"]), ("y0", a["y"]), ("x1", b["x"]), ("y1", b["y"])):
            rows[name] = of
        for name in ("cx", "cy", "turn"):
            rows[name] = a[name]
        rows["source"] = -1
        parts.append(rows)
    return np.concatenate(parts)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DrawnPart(Drawn):
    """What a part program cuts; it says of each cut how."""

    shaped: tuple[ShapedCut, ...]

    @property
    def words(self) -> Wording:
        """What its user calls what is planned."""
        from wedmcam.transforms.plan.wording import OF_PART

        return OF_PART

    def cuts(self, options: Options) -> tuple[tuple[ShapedCut, ...], list[Diagnostic]]:
        """Return what is to be cut."""
        return self.shaped, []


def read(data: bytes, file: str, options: Options, run: Run) -> Drawn:
    """Return the contours of a drawing, or of a part program."""
    reading = options.drawing
    if source_format(data, file, reading.source) == "wed":
        return _read_part(data, file, options, run)
    if reading.defines:
        raise WrongUse("-D sets a let of a .wed program; this is a drawing")
    from wedmcam.frontends.dxf import read as read_dxf
    from wedmcam.transforms.chain import ChainReport, chain
    from wedmcam.transforms.frames import doubtful
    from wedmcam.transforms.layers import Group, split
    from wedmcam.transforms.unread import unread_outlines

    sketch, findings = read_dxf(data, file, reading, options.wishes)
    if sketch is not None:
        run.values["seen"] = Seen(sketch.segments, sketch)
    elif any(d.code == "no-units" for d in findings):
        run.values["seen"] = SeenWithoutUnits(data, file, reading)
    sketch = run("read", (sketch, findings))
    groups, report, drawn = [], ChainReport(), sketch
    every: tuple[Contour, ...] = ()
    for rule, part in run("chain", split(sketch, options.cutting, options.wished)):
        contours, own, findings = chain(part, reading.join_um)
        run.add("chain", findings)
        every, report = every + contours, report.with_(own)
        if reading.transforms:
            drawn, contours = _transform(sketch, contours, options, run)
        groups.append(Group(rule, contours))
    about = unread_outlines(sketch, every, reading.join_um, options.cutting.offset_um or 0.0)
    every = tuple(c for group in groups for c in group.contours)
    nesting = _nested(every, run)
    if len(groups) == 1:
        about += doubtful(nesting, drawn.texts)
    computed = bool(reading.transforms)
    return Drawn(drawn, every, report, nesting, computed, about, tuple(groups))


def source_format(data: bytes, file: str, stated: str | None = None) -> str:
    """Return the format of a source: as stated, else by its name, else by its content."""
    if stated is not None:
        return stated
    name = file.lower()
    if name.endswith((".wed", ".dxf")):
        return name[-3:]
    from wedmcam.frontends.identify import is_part

    return "wed" if is_part(data) else "dxf"


def _read_part(data: bytes, file: str, options: Options, run: Run) -> Drawn:
    """Return the figures that a part program cuts, each with what is asked of it."""
    from wedmcam.frontends.wed import read as read_wed
    from wedmcam.transforms.chain import ChainReport
    from wedmcam.transforms.figures.part import shape_cuts, sketch_of
    from wedmcam.transforms.plan import idle

    part = run(
        "read",
        read_wed(data, file, arithmetic=options.arithmetic, defines=options.drawing.defines),
    )
    run.add("read", idle.of_source(part, options.drawing.units, options.wished))
    more = _transforms(options.drawing.transforms, run)
    shaped = run("transform", shape_cuts(part, more, arithmetic(options.arithmetic)))
    sketch, contours = sketch_of(part, shaped)
    closed = sum(c.closed for c in contours)
    report = ChainReport(closed, len(contours) - closed)
    return DrawnPart(sketch, contours, report, _nested(contours, run), True, shaped=shaped)


def _nested(contours: tuple[Contour, ...], run: Run) -> Nesting:
    """Return how contours lie in each other, where they can be a part by their number."""
    from wedmcam.transforms.nest import nest, too_deep, too_many

    run.add("nest", too_many(contours))
    nesting = nest(contours)
    run.add("nest", too_deep(nesting))
    return nesting


def _transforms(transforms: Sequence[str], run: Run) -> list[Any]:
    """Return what ``--transform`` says, parsed."""
    if not transforms:
        return []
    from wedmcam.frontends.wed import parse_transforms

    parsed, findings = parse_transforms(transforms)
    run.add("transform", findings)
    return list(parsed)


def _transform(
    sketch: Sketch, contours: tuple[Contour, ...], options: Options, run: Run
) -> tuple[Sketch, tuple[Contour, ...]]:
    """Return contours and thread points after ``--transform``; --start points stay (ruling 5)."""
    from wedmcam.transforms import figures
    from wedmcam.transforms.meetings import contour_meetings

    whole = figures.Sequence(tuple(_transforms(options.drawing.transforms, run)))
    result = run(
        "transform",
        figures.transformed(contours, whole, arithmetic(options.arithmetic), sketch.thread_points),
    )
    run.add("transform", figures.idle_reverse(contours, whole))
    contours = figures.counter_clockwise(result[0])
    moved = replace(sketch, thread_points=result[1])
    run.values["seen"] = Seen(rows_of(contours), moved)
    run.add("transform", contour_meetings(contours))
    return moved, contours


def arithmetic(name: str) -> Arithmetic:
    """Return the arithmetic in which formulas run."""
    if name == FLOAT64.name:
        return FLOAT64
    from wedmcam.decimal8 import DECIMAL8

    return DECIMAL8


def where_the_wire_goes(drawn: Drawn, options: Options, run: Run) -> Plan:
    """Return the plan: sides, compensation, leads, order."""
    from wedmcam.transforms.plan.planner import plan_cuts

    run.add("nest", drawn.doubts)
    cuts = run("open", drawn.cuts(options))
    ar = arithmetic(options.arithmetic)
    return run(
        "plan",
        plan_cuts(cuts, options.cutting, options.leading, ar, drawn.words, options.wished),
    )

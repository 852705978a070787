"""What a compile holds between its stages, as text that a person reads and a test compares.

Lengths are um with three decimals, in the frame of the drawing; places of blocks are whole um (or
true um of longer steps). Lines name where each segment, contour and cut was drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.diag import Span
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Axis, Kind, Program, Role, in_um
from wedmcam.ir.sketch import Sketch

#: Stage that can be shown -> the stage of `diag.run.Run` whose value holds it.
STAGES = {"sketch": "drawn", "contours": "drawn", "plan": "plan", "program": "decode"}
_TURN = {0: "line", 1: "ccw", -1: "cw"}


def stage_text(stage: str, value: Any, stepping: Stepping) -> str:
    """Return the text of a stage.

    Args:
        stage: a key of `STAGES`.
        value: of the stage of a run that it names.
        stepping: of the machine that is compiled for.
    """
    write: dict[str, Callable[[], str]] = {
        "sketch": lambda: sketch_text(value.sketch),
        "contours": lambda: contours_text(value.contours),
        "plan": lambda: plan_text(value),
        "program": lambda: program_text(value, stepping),
    }
    return write[stage]()


def sketch_text(sketch: Sketch) -> str:
    """Return loose segments, in the order in which they were read."""
    s = sketch.segments
    lines = [f"sketch: {len(s)} segments, {len(sketch.thread_points)} thread points"]
    lines += [f"  thread point {_place(p.x, p.y)}" for p in sketch.thread_points]
    for k, row in enumerate(s.tolist(), 1):
        x0, y0, x1, y1, cx, cy, turn, source = row
        centre = f" about {_place(cx, cy)}" if turn else ""
        lines.append(
            f"  {k:4} {_TURN[turn]:4} {_place(x0, y0)} to {_place(x1, y1)}{centre}"
            + _source(sketch.sources, source)
        )
    return _text(lines)


def contours_text(contours: Sequence[Contour]) -> str:
    """Return contours with their vertices, in the order in which they were found."""
    lines = [f"contours: {len(contours)}"]
    for k, contour in enumerate(contours, 1):
        lines.append(f"  contour {k}: {_kind(contour)}")
        lines += _vertices(contour)
    return _text(lines)


def plan_text(plan: Plan) -> str:
    """Return the cuts of a plan, in the order in which they are cut."""
    lines = [f"plan: {len(plan.cuts)} cuts, {len(plan.scenes)} parts"]
    for k, cut in enumerate(plan.cuts, 1):
        keeps = {True: "left", False: "right", None: "neither side"}[cut.keeps_left]
        lines.append(
            f"  cut {k}: {cut.side}, offset {_um(cut.offset_um)}, thread point "
            f"{_place(*cut.thread)}, keeps {keeps}, {_kind(cut.path)}"
            + (f", stop {_um(cut.stop_um)}" if cut.stop_um else "")
            + (f", overcut {_um(cut.overcut_um)}" if cut.overcut_um else "")
        )
        lines += _vertices(cut.path)
    return _text(lines)


def program_text(program: Program, stepping: Stepping) -> str:
    """Return the blocks of a program, and where its controller stands after each."""
    blocks = program.blocks
    motion = stepping.run(blocks)
    steps = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)])
    ends = in_um(steps + np.array(program.origin), program.step_um)
    words = dict(program.words)
    lines = [f"program: {len(blocks)} blocks, starts at {_place(*program.origin)}"]
    for k, block in enumerate(blocks):
        kind = Kind(block["kind"])
        if kind > Kind.MOVE:
            lines.append(f"  {k + 1:4} {words.get(k, kind.name.lower())}")
            continue
        name = _TURN[int(block["turn"])] if kind == Kind.ARC else kind.name.lower()
        role = Role(block["role"]).name.lower().replace("_", "-")
        lines.append(
            f"  {k + 1:4} {name:4} x {block['x']} y {block['y']} J {block['count']} on "
            f"{Axis(block['axis']).name} ends {_place(*ends[k].tolist())}"
            + (f" cut {block['cut']} {role}" if block["cut"] else "")
        )
    return _text(lines)


def _vertices(contour: Contour) -> Iterator[str]:
    for x, y, cx, cy, turn, source in contour.vertices.tolist():
        centre = f" about {_place(cx, cy)}" if turn else ""
        yield f"    {_TURN[turn]:4} from {_place(x, y)}{centre}" + _source(contour.sources, source)


def _kind(contour: Contour) -> str:
    many = len(contour.starts)
    return f"{'closed' if contour.closed else 'open'}, {many} segment{'s' if many != 1 else ''}"


def _source(sources: Sequence[Span], source: int) -> str:
    return f"  [{sources[source]}]" if 0 <= source < len(sources) else ""


def _place(x: float, y: float) -> str:
    return f"({_um(x)}, {_um(y)})"


def _um(value: float | NDArray[np.float64]) -> str:
    text = f"{value:.3f}"
    return "0.000" if text == "-0.000" else text


def _text(lines: Sequence[str]) -> str:
    return "\n".join(lines) + "\n"

"""The simulated wire path as a drawing: what a program cuts, to lay over the part in any CAD.

Old programs are often all that is left of a part. Each block becomes the LINE, ARC or CIRCLE that
the controller makes of it, from the micron where it starts to the micron where its last step ends.
An ARC holds no end points; its circle is moved by about a micron so that it passes both, and
neighbours meet. Layers tell what the wire does: CUT, LEAD (out from the thread point and back the
same way), OVERCUT, MOVE (wire off), and POINTs on START (thread points) and STOP. The reader takes
START for thread points, so that ``compile --layer CUT --layer START`` makes the program again.
"""

from __future__ import annotations

import io
import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.programs.stretches import Stretch, beside, stretches, words_left_out

Ints = NDArray[np.int64]

#: Layer -> AutoCAD colour index.
LAYERS = {"CUT": 1, "LEAD": 3, "OVERCUT": 6, "MOVE": 8, "START": 5, "STOP": 2}
#: An arc of more than half a turn whose centre would move farther than this is drawn as two; steps.
MOVED_STEPS = 1.5


def encode(program: Program, machine: Machine) -> bytes:
    """Return the DXF (R2000, mm) of the stepped path, drawing coordinates; no date is in it.

    Args:
        program: decoded; ``origin`` is where its first block starts.
        machine: whose controller steps it.
    """
    from ezdxf._options import options

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True  # else a date and two GUIDs are written
    try:
        return _drawing_of(program, machine)
    finally:
        options.write_fixed_meta_data_for_testing = before


def convert(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return the drawing of a decoded program called ``name``: an output of ``convert``."""
    words = [i for i, _ in program.words]
    return encode(program, machine), words_left_out(program, words, "a drawing")


def _drawing_of(program: Program, machine: Machine) -> bytes:
    from ezdxf import units
    from ezdxf.filemanagement import new

    drawing = new("R2000", units=units.MM)
    for name, colour in LAYERS.items():
        drawing.layers.add(name, color=colour)
    space = drawing.modelspace()
    motion = machine.stepping.run(program.blocks)
    per_mm = 1000 / program.step_um
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)]) + np.array(program.origin)
    starts = ends - np.column_stack([motion.dx, motion.dy])
    pieces = stretches(program.blocks, starts, ends)
    layers = _layers_of(program.blocks, pieces)
    threads, stops = _points(pieces, starts, ends)
    stops += [(int(ends[i][0]), int(ends[i][1])) for i in beside(program.blocks["kind"], pieces)]
    for layer, places in (("START", threads), ("STOP", stops)):
        for x, y in places:
            space.add_point((x / per_mm, y / per_mm), dxfattribs={"layer": layer})
    for i in np.flatnonzero(program.blocks["kind"] <= Kind.MOVE).tolist():
        attributes = {"layer": layers[i]}
        (x0, y0), (x1, y1) = starts[i].tolist(), ends[i].tolist()
        b = program.blocks[i]
        if b["kind"] == Kind.ARC:
            _add_arc(space, b, (x0, y0), (x1, y1), int(motion.steps[i]), per_mm, attributes)
        elif (x0, y0) != (x1, y1):
            place = (x0 / per_mm, y0 / per_mm)
            space.add_line(place, (x1 / per_mm, y1 / per_mm), dxfattribs=attributes)
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue().encode("cp1252")


def _add_arc(
    space: Any,
    b: np.void,
    start: tuple[int, int],
    end: tuple[int, int],
    steps: int,
    per_mm: float,
    attributes: dict[str, str],
) -> None:
    """Add the arc of a block; a whole turn is a circle, and what it runs beyond an arc.

    ``start`` and ``end`` are in steps.
    """
    turn, ax, ay = int(b["turn"]), float(b["x"]), float(b["y"])
    radius = float(np.hypot(ax, ay))
    cx, cy = float(start[0] - ax), float(start[1] - ay)
    first = np.arctan2(ay, ax)
    last = np.arctan2(end[1] - cy, end[0] - cx)
    sweep = float((last - first) * turn % math.tau)
    # A turn takes 8 R steps: that tells an arc that just passes its start from a short one.
    sweep += math.tau * round((steps / (8.0 * radius) * math.tau - sweep) / math.tau)
    if sweep > math.tau - 1e-12:
        centre = (cx / per_mm, cy / per_mm)
        space.add_circle(centre, radius / per_mm, dxfattribs=attributes)
    if start == end:
        return
    rest = sweep % math.tau
    # Where both ends lie near each other and no circle about the centre passes both, one through
    # both would be another circle: two arcs then, that meet on the far side.
    ends: list[tuple[float, float]] = [start, end]
    if rest > math.tau / 2 and abs(_along((cx, cy), start, end)) > MOVED_STEPS:
        half = first + turn * rest / 2
        ends.insert(1, (cx + radius * float(np.cos(half)), cy + radius * float(np.sin(half))))
    for one, two in pairwise(ends):
        _add_piece(space, turn, (cx, cy), one, two, per_mm, attributes)


def _along(centre: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """Return how far along the way from a to b a centre moves to lie as far from both."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    off = ((a[0] + b[0]) / 2 - centre[0]) * dx + ((a[1] + b[1]) / 2 - centre[1]) * dy
    return off / float(np.hypot(dx, dy))


def _add_piece(
    space: Any,
    turn: int,
    centre: tuple[float, float],
    start: tuple[float, float],
    end: tuple[float, float],
    per_mm: float,
    attributes: dict[str, str],
) -> None:
    """Add an arc of less than a turn that passes both ends, steps."""
    # The centre on the middle line of both ends, as near as may be: that moves it along the chord.
    length = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    along = _along(centre, start, end) / length
    cx = centre[0] + along * (end[0] - start[0])
    cy = centre[1] + along * (end[1] - start[1])
    a = np.degrees(np.arctan2(start[1] - cy, start[0] - cx))
    z = np.degrees(np.arctan2(end[1] - cy, end[0] - cx))
    if turn < 0:
        a, z = z, a
    r = float(np.hypot(start[0] - cx, start[1] - cy))
    space.add_arc(
        (cx / per_mm, cy / per_mm),
        r / per_mm,
        float(a % 360),
        float(z % 360),
        dxfattribs=attributes,
    )


def _points(
    pieces: list[Stretch], starts: Ints, ends: Ints
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Return thread points (where a stretch begins) and stops (pauses within it)."""
    threads, stops = [], []
    for one in pieces:
        first = one.lead_in[0] if len(one.lead_in) else one.path[0]
        threads.append((int(starts[first][0]), int(starts[first][1])))
        stops += [(int(ends[i][0]), int(ends[i][1])) for i in one.pauses]
    return threads, stops


def _layers_of(blocks: NDArray[np.void], pieces: list[Stretch]) -> list[str]:
    """Return the layer of each block."""
    layers = ["MOVE" if k == Kind.MOVE else "CUT" for k in blocks["kind"].tolist()]
    for one in pieces:
        for name, rows in (("LEAD", one.lead_in), ("LEAD", one.lead_out), ("OVERCUT", one.overcut)):
            for i in rows.tolist():
                layers[i] = name
    return layers

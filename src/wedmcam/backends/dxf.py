"""The simulated wire path as a drawing: what a program cuts, to lay over the part in any CAD.

Old programs are often all that is left of a part. Each block becomes the LINE, ARC or CIRCLE that
the controller makes of it, from the micron where it starts to the micron where its last step ends.
An ARC holds no end points; its circle is moved by less than a micron so that it passes both, and
neighbours meet. Layers tell what the wire does: CUT, LEAD (out from the thread point and back the
same way), OVERCUT, MOVE (wire off), and POINTs on START (thread points) and STOP. The reader takes
START for thread points, so that ``compile --layer CUT --layer START`` makes the program again.
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controller import run
from wedmcam.diag import Diagnostic
from wedmcam.ir.program import Kind, LineTable, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]

#: Layer -> AutoCAD colour index.
LAYERS = {"CUT": 1, "LEAD": 3, "OVERCUT": 6, "MOVE": 8, "START": 5, "STOP": 2}
TAU = 2.0 * np.pi


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
        return _written(program, machine)
    finally:
        options.write_fixed_meta_data_for_testing = before


def converted(program: Program, machine: Machine, name: str) -> tuple[bytes, list[Diagnostic]]:
    """Return the drawing of a decoded program called ``name``: a target of ``convert``."""
    return encode(program, machine), []


def _written(program: Program, machine: Machine) -> bytes:
    from ezdxf import units
    from ezdxf.filemanagement import new

    drawing = new("R2000", units=units.MM)
    for name, colour in LAYERS.items():
        drawing.layers.add(name, color=colour)
    space = drawing.modelspace()
    motion = run(program.blocks, LineTable(machine.table))
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)]) + np.array(program.origin)
    starts = ends - np.column_stack([motion.dx, motion.dy])
    layers = layers_of(program.blocks, starts, ends)
    threads, stops = _points(program, starts, ends)
    for layer, places in (("START", threads), ("STOP", stops)):
        for x, y in places:
            space.add_point((x / 1000, y / 1000), dxfattribs={"layer": layer})
    for i in np.flatnonzero(program.blocks["kind"] <= Kind.MOVE).tolist():
        attributes = {"layer": layers[i]}
        (x0, y0), (x1, y1) = starts[i].tolist(), ends[i].tolist()
        b = program.blocks[i]
        if b["kind"] == Kind.ARC:
            _add_arc(space, b, (x0, y0), (x1, y1), int(motion.steps[i]), attributes)
        elif (x0, y0) != (x1, y1):
            space.add_line((x0 / 1000, y0 / 1000), (x1 / 1000, y1 / 1000), dxfattribs=attributes)
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue().encode("cp1252")


def _add_arc(
    space: Any,
    b: np.void,
    start: tuple[int, int],
    end: tuple[int, int],
    steps: int,
    attributes: dict[str, str],
) -> None:
    """Add the arc of a block; a whole turn is a circle, and what it runs beyond an arc."""
    turn, ax, ay = int(b["turn"]), float(b["x"]), float(b["y"])
    radius = float(np.hypot(ax, ay))
    cx, cy = float(start[0] - ax), float(start[1] - ay)
    first = np.arctan2(ay, ax)
    last = np.arctan2(end[1] - cy, end[0] - cx)
    sweep = float((last - first) * turn % TAU)
    # A turn takes 8 R steps: that tells an arc that just passes its start from a short one.
    sweep += TAU * round((steps / (8.0 * radius) * TAU - sweep) / TAU)
    if sweep > TAU - 1e-12:
        centre = (cx / 1000, cy / 1000)
        space.add_circle(centre, radius / 1000, dxfattribs=attributes)
    if start == end:
        return
    # The centre on the middle line of both ends, as near as may be: that moves it along the chord.
    length = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    along = ((start[0] + end[0]) / 2 - cx) * ux + ((start[1] + end[1]) / 2 - cy) * uy
    cx, cy = cx + along * ux, cy + along * uy
    a = np.degrees(np.arctan2(start[1] - cy, start[0] - cx))
    z = np.degrees(np.arctan2(end[1] - cy, end[0] - cx))
    if turn < 0:
        a, z = z, a
    r = float(np.hypot(start[0] - cx, start[1] - cy))
    space.add_arc(
        (cx / 1000, cy / 1000), r / 1000, float(a % 360), float(z % 360), dxfattribs=attributes
    )


def _cuts(blocks: NDArray[np.void]) -> list[Ints]:
    """Return the cutting blocks of each contour: what lies between two moves."""
    kinds = blocks["kind"]
    cut = np.flatnonzero(kinds < Kind.MOVE)
    number = np.cumsum(kinds == Kind.MOVE)[cut]
    return [cut[number == n] for n in np.unique(number)]


def _points(
    program: Program, starts: Ints, ends: Ints
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Return thread points (where a contour begins) and stops (pauses within a contour)."""
    threads, stops = [], []
    kinds = program.blocks["kind"]
    for rows in _cuts(program.blocks):
        threads.append((int(starts[rows[0]][0]), int(starts[rows[0]][1])))
        within = np.arange(rows[0], rows[-1])
        for i in within[kinds[within] == Kind.PAUSE].tolist():
            stops.append((int(ends[i][0]), int(ends[i][1])))
    return threads, stops


def layers_of(blocks: NDArray[np.void], starts: Ints, ends: Ints) -> list[str]:
    """Return the layer of each block, told from the path alone: a decoded program knows no roles.

    A lead is straight, and run back the same way at the end of the contour. Past the point where
    the contour closed, what is run there and back is overcut.
    """
    layers = ["MOVE" if k == Kind.MOVE else "CUT" for k in blocks["kind"].tolist()]
    for rows in _cuts(blocks):
        leads = _leads(blocks, rows, starts, ends)
        for k in range(leads):
            layers[rows[k]] = layers[rows[-1 - k]] = "LEAD"
        path = rows[leads : len(rows) - leads]
        if not leads or len(path) < 2:
            continue
        home = (ends[path] == starts[path[0]]).all(axis=1)
        closed = int(np.argmax(home)) + 1
        over = path[closed:]
        half = len(over) // 2
        back = over[half:][::-1]
        there_and_back = len(over) % 2 == 0 and (ends[over[:half]] == starts[back]).all()
        if home.any() and half and there_and_back:
            for i in over.tolist():
                layers[i] = "OVERCUT"
    return layers


def _leads(blocks: NDArray[np.void], rows: Ints, starts: Ints, ends: Ints) -> int:
    """Return how many blocks at the start of a contour are a lead; as many at its end go back."""
    way = ends[rows[0]] - starts[rows[0]]
    count = 0
    while 2 * count + 1 < len(rows):
        i, j = rows[count], rows[-1 - count]
        there, back = ends[i] - starts[i], ends[j] - starts[j]
        straight = blocks["kind"][i] == Kind.LINE and blocks["kind"][j] == Kind.LINE
        same = (ends[i] == starts[j]).all() and (starts[i] == ends[j]).all()
        # Pieces of one line agree within the micron that each end is rounded to.
        bend = abs(int(way[0]) * int(there[1]) - int(way[1]) * int(there[0]))
        room = 2.0 * (np.hypot(*way) + np.hypot(*there))
        if not (straight and same and (there == -back).all() and bend <= room):
            break
        if int(way @ there) <= 0:
            break
        count += 1
    return count

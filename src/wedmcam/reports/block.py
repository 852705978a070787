"""One block at length: its record, what it draws, why it is counted so, its first steps.

A short block is shown whole: all its steps, and the stair that they make.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING, Any

from wedmcam.controllers.eindhoven.arithmetic import SPEED_UM_PER_S
from wedmcam.reports.stair import MOST_STEPS, fits, stair

if TYPE_CHECKING:
    from wedmcam.controllers import Stepping
    from wedmcam.controllers.eindhoven.vectors import Vectors
    from wedmcam.ir.program import Program
    from wedmcam.machines import Machine

#: Steps that are shown.
SHOWN = 12

#: The instruction of an arc by its sense.
ARCS = {1: "NR", -1: "SR"}


def _mm(um: float) -> str:
    return f"{um / 1000 + 0.0:.3f}"


def _at(x: float, y: float) -> str:
    return f"({_mm(x)}, {_mm(y)})"


def explain_block(program: Program, machine: Machine, data: bytes, number: int) -> Iterator[str]:
    """Yield lines about block ``number`` (1-based) of a program read from ``data``."""
    from wedmcam.controllers.eindhoven.vectors import Vectors
    from wedmcam.ir.program import Axis, Kind
    from wedmcam.programs.places import block_ends

    row = number - 1
    block = program.blocks[row]
    kind = Kind(int(block["kind"]))
    words = dict(program.words)
    yield f"block {number} of {len(program.blocks)}, read for {machine.name} ({machine.title})"
    yield f"record     {_record(program, row, data)}"
    if machine.axes.text:
        yield f"axes       {machine.axes.text}; what follows is in the axes of the drawing"
    starts, ends = block_ends(program, machine)
    start, end = (p[row].tolist() for p in (starts, ends))
    if kind > Kind.MOVE:
        yield f"kind       {words.get(row, kind.name.lower())}; nothing moves, at {_at(*start)} mm"
        return
    x, y, turn = int(block["x"]), int(block["y"]), int(block["turn"])
    axis, count = Axis(int(block["axis"])), int(block["count"])
    stepping = machine.stepping
    if isinstance(stepping, Vectors):
        yield from _vector(block, kind == Kind.MOVE, stepping, program.step_um)
    elif kind == Kind.ARC:
        yield from _arc(x, y, turn, axis, count, start, end, program.step_um)
    else:
        yield from _line(x, y, axis, count, kind == Kind.MOVE, machine, program.step_um)
    yield from _ending(block, stepping, start, end, program.step_um)


def _record(program: Program, row: int, data: bytes) -> str:
    """Return the record as it stands in the file, with its place."""
    from wedmcam.controllers.nby15.data import TapeProgram
    from wedmcam.diag import ByteSpan, TextSpan
    from wedmcam.formats.tape import readable

    span = program.spans[row] if row < len(program.spans) else None
    if isinstance(span, TextSpan):
        if isinstance(program, TapeProgram):
            data = readable(data)
        lines = data.decode("utf-8", "replace").splitlines()
        line = lines[span.line - 1] if span.line <= len(lines) else ""
        text = line[span.column - 1 : span.column - 1 + (span.length or len(line))]
        return f"{text.strip()}  (line {span.line}, column {span.column})"
    if isinstance(span, ByteSpan):
        return f"{data[span.start : span.end].hex(' ')}  (bytes {span.start:#06x} on)"
    return "?"


def _vector(block: Any, move: bool, stepping: Vectors, step_um: float) -> Iterator[str]:
    """Tell what a controller of vectors computes for one: the speeds of its axes."""
    import numpy as np

    one = np.array([block])
    x, y, speed = int(block["x"]), int(block["y"]), int(block["count"])
    what = "move, generator off," if move else "vector"
    heading = math.degrees(math.atan2(y, x)) % 360
    way, length = _at(x * step_um, y * step_um), _mm(math.hypot(x, y) * step_um)
    yield f"geometry   {what} along {way} mm, {length} mm at {heading:.3f} deg"
    speeds = stepping.speeds(one)
    vx, vy = int(speeds.x[0]) * (1 if x >= 0 else -1), int(speeds.y[0]) * (1 if y >= 0 else -1)
    of = f" / {speeds.scale}" if speeds.scale > 1 else ""
    run = math.degrees(math.atan2(vy, vx)) % 360
    per_min = SPEED_UM_PER_S * 60 / 1000
    yield (
        f"speed      {speed} = {speed * per_min:.3f} mm a minute; POSCAL: x {vx}{of}, y {vy}{of}, "
        f"{math.hypot(vx, vy) * per_min / speeds.scale:.3f} mm a minute at {run:.3f} deg"
    )
    beside = float(stepping.sideways(one)[0]) * step_um
    yield f"sideways   {beside:.3f} um beside its line where the first axis arrives"
    yield f"time       {float(stepping.seconds(one)[0]):.1f} s"


def _line(
    x: int, y: int, axis: Any, count: int, move: bool, machine: Machine, step_um: float
) -> Iterator[str]:
    import numpy as np

    from wedmcam.controllers.pointwise import line_axis
    from wedmcam.formats.quadrants import quadrant
    from wedmcam.ir.program import Axis

    what = "move, generator off," if move else "line"
    heading = math.degrees(math.atan2(y, x)) % 360
    way, length = _at(x * step_um, y * step_um), _mm(math.hypot(x, y) * step_um)
    yield f"geometry   {what} along {way} mm, {length} mm at {heading:.3f} deg"
    q = _quadrant(quadrant, x, y, 0)
    where = "on an axis: the quadrant it enters by rule" if 0 in (x, y) else "where the end lies"
    yield f"quadrant   L{q}: {where}"
    used = line_axis(x, y, axis) if axis >= Axis.SQUARE else axis
    if abs(x) == abs(y):
        exact = Axis(int(machine.stepping.line_count(np.array(x), np.array(y))[0])).name.lower()
        why = f"45 degrees: with the {machine.table} line table only {exact} ends it exactly"
    else:
        longer = "x" if abs(x) > abs(y) else "y"
        why = f"{longer} is the longer way, so the end is exact"
        if used.name.lower() != longer:
            why = f"but {longer} is the longer way: the end is inexact"
    yield f"counted on {used.name.lower()}: {why}"
    along = abs(x) if used == Axis.X else abs(y)
    whole = "the whole way" if along == count else f"X, Y are a ratio; their own count is {along}"
    yield f"J          {_mm(count * step_um)} mm = {count} steps on {used.name.lower()}: {whole}"


def _arc(
    x: int,
    y: int,
    turn: int,
    axis: Any,
    count: int,
    start: list[float],
    end: list[float],
    step_um: float,
) -> Iterator[str]:
    from wedmcam.controllers.pointwise import arc_quadrant
    from wedmcam.ir.program import Axis

    cx, cy = start[0] - x * step_um, start[1] - y * step_um
    ex, ey = round((end[0] - cx) / step_um), round((end[1] - cy) / step_um)
    sense = "counter-clockwise" if turn > 0 else "clockwise"
    radius = math.hypot(x, y)
    yield (
        f"geometry   {sense} arc, radius {radius * step_um / 1000:.6f} mm about {_at(cx, cy)} mm, "
        f"starts {_at(x * step_um, y * step_um)} from it"
    )
    if x * x + y * y < 2:
        yield "           it never ends: the path would step onto its centre"
        return
    q = arc_quadrant(x, y, turn)
    where = "on an axis: the quadrant it enters" if 0 in (x, y) else "where the start lies"
    yield f"quadrant   {ARCS[turn]}{q}: {where}"
    near = "x" if abs(ex) > abs(ey) else "y"
    if axis >= Axis.SQUARE:
        why = "y where |x| > |y|, x where |x| < |y|: always across the radius, so ends are sharp"
        yield f"counted on the inscribed square: {why}"
    else:
        across = "y" if near == "x" else "x"
        name = axis.name.lower()
        if abs(ex) == abs(ey):
            why = "the end is at 45 degrees: either will do"
        elif name == across:
            why = f"the end is nearer the {near} axis, where steps on {name} run across the radius"
        else:
            why = (
                f"but the end is nearer the {near} axis, where steps on {name} run along the "
                "radius: the end is unsharp"
            )
        yield f"counted on {name}: {why}"
    compared = _nominal(x, y, turn, axis, ex, ey, count)
    yield f"J          {_mm(count * step_um)} mm = {count} steps counted{compared}"


def _nominal(x: int, y: int, turn: int, axis: Any, ex: int, ey: int, count: int) -> str:
    """Return how J compares with that of the text books."""
    from wedmcam.controllers.pointwise.nominal import nominal_count
    from wedmcam.ir.program import Axis

    if axis >= Axis.SQUARE:
        return ""
    by_book = int(nominal_count([x], [y], [turn], [ex], [ey], [int(axis)])[0])
    if by_book == count:
        return "; the sum of projections is the same"
    return f"; the sum of projections (text books) would be {by_book}"


def _quadrant(quadrant: Any, x: int, y: int, turn: int) -> int:
    import numpy as np

    return int(quadrant(np.array([x]), np.array([y]), np.array([turn]))[0])


def _ending(
    block: Any, stepping: Stepping, start: list[float], end: list[float], step_um: float
) -> Iterator[str]:
    """Tell the first steps and where the block ends."""
    import numpy as np

    from wedmcam.ir.program import Axis

    one = np.array([block])
    total = int(stepping.run(one).steps[0])
    if total < 0:
        yield "steps      it never ends: no controller can run this block"
        return
    steps = list(islice(stepping.steps(one[0]), MOST_STEPS))
    places = [(0, 0), *((s.x, s.y) for s in steps)]
    drawn = total <= MOST_STEPS and fits(places)
    shown = total if drawn else min(SHOWN, total)
    yield f"steps      {total}; the first {shown}, from the start, with F and J behind each"
    yield "             n  step         x         y              F         J"
    left = int(one["count"][0])
    for n, s in enumerate(steps[:shown], 1):
        left -= _counts(one[0], s.axis, places[n - 1])
        step = f"{'+' if s.sign > 0 else '-'}{'x' if s.axis == Axis.X else 'y'}"
        yield f"         {n:5d}  {step:4} {s.x:9d} {s.y:9d} {s.f:14d} {left:9d}"
    if drawn:
        yield "stair      each place with the number of its step; from the start"
        yield from (f"      {text}".rstrip() for text in stair(places))
    low, high = (float(d[0]) for d in stepping.deviation(one))
    yield f"path       within {max(high, -low) * step_um:.3f} um of its own line or circle"
    yield f"ends at    {_at(*end)} mm, started at {_at(*start)} mm (from the program's start)"


def _counts(block: Any, along: Any, place: tuple[int, int]) -> bool:
    """Return whether a step along an axis, from a place seen from the start, counts in J."""
    from wedmcam.controllers.pointwise import counts, line_axis
    from wedmcam.ir.program import Axis, Kind

    axis, x, y = Axis(int(block["axis"])), int(block["x"]), int(block["y"])
    if block["kind"] == Kind.ARC:
        return counts(axis, along, x + place[0], y + place[1])
    return counts(line_axis(x, y, axis) if axis >= Axis.SQUARE else axis, along, *place)
